//! # Two faces
//!
//! One material on the side that the normal points to, another on the other: a playing card, a lined coat. Each is to look the same from both
//! sides, or to be black from behind (`two_sided: false`), where it shows nothing on the back.

use straal_scene::desc;

use super::{Black, Bsdf, Choice, Recipe, Wants};
use crate::lanes::Lanes;
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint};

/// A material for each side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoFacesMaterial {
    /// Indices of the one in front and of the one behind.
    pub parts: [u32; 2],
}

impl Recipe for TwoFacesMaterial {
    type Described = desc::TwoFaces;

    fn of(_: &desc::TwoFaces, _: &mut Paint<'_>) -> Self {
        Self { parts: [0; 2] }
    }

    fn link(&mut self, parts: &[u32]) {
        if let [front, back] = *parts {
            self.parts = [front, back];
        }
    }

    fn parts(&self) -> &[u32] {
        &self.parts
    }

    fn choice<L: Lanes>(&self, _: &ShadingPoint, _: &Reading<'_, L>, in_front: bool) -> Choice {
        Choice::One(self.parts[usize::from(!in_front)])
    }

    fn wants(&self) -> Wants {
        Wants::default()
    }

    fn bsdf<'w, L: Lanes>(&'w self, _: &ShadingPoint, _: &Reading<'w, L>) -> Bsdf<'w> {
        Bsdf::Black(Black)
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        vec![(Self { parts: [0; 2] }, super::BsdfKind::Black)]
    }
}
