//! # Mix
//!
//! Two materials at the same place: f = (1 - w) f_1 + w f_2 with the share w of the second, a number or a texture. Energy is conserved and
//! reciprocity holds where they do in both.
//!
//! A path meets one of the two, by chance, so that a mixture costs no more than its parts.

use straal_scene::desc;

use super::{Black, Bsdf, Choice, Recipe, Wants};
use crate::lanes::Lanes;
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// Two materials, each with a share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixMaterial {
    /// Indices of the two.
    pub parts: [u32; 2],
    /// Share of the second.
    pub weight: Value<f32>,
}

impl Recipe for MixMaterial {
    type Described = desc::Mix;

    fn of(d: &desc::Mix, paint: &mut Paint<'_>) -> Self {
        Self { parts: [0; 2], weight: paint.number(&d.weight) }
    }

    fn link(&mut self, parts: &[u32]) {
        if let [first, second] = *parts {
            self.parts = [first, second];
        }
    }

    fn parts(&self) -> &[u32] {
        &self.parts
    }

    fn choice<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, _: bool) -> Choice {
        Choice::Two(self.parts, reading.eval(&self.weight, at))
    }

    fn wants(&self) -> Wants {
        Wants::point(self.weight.varies())
    }

    fn bsdf<'w, L: Lanes>(&'w self, _: &ShadingPoint, _: &Reading<'w, L>) -> Bsdf<'w> {
        Bsdf::Black(Black)
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        vec![(Self { parts: [0; 2], weight: 0.5.into() }, super::BsdfKind::Black)]
    }
}
