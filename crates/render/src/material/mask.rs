//! # Mask
//!
//! A material with holes: of the light that comes to it, the share `opacity` meets the material, and the rest passes straight through as if nothing
//! were there. A leaf is a rectangle with a picture of where it is.
//!
//! A ray that meets it goes on with the chance 1 - opacity, in the driver ([`crate::driver`]), so that no integrator knows of it: what a path
//! arrives at is what is there. A shadow ray passes through as many masks as there are, and brings the product of what they let through.

use straal_scene::desc;

use super::{Black, Bsdf, Choice, Recipe, Wants};
use crate::lanes::Lanes;
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// A material that is there in part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaskMaterial {
    /// Index of what is there.
    pub material: u32,
    /// Share of light that meets it.
    pub opacity: Value<f32>,
}

impl Recipe for MaskMaterial {
    type Described = desc::Mask;

    fn of(d: &desc::Mask, paint: &mut Paint<'_>) -> Self {
        Self { material: 0, opacity: paint.number(&d.opacity) }
    }

    fn link(&mut self, parts: &[u32]) {
        if let [material] = *parts {
            self.material = material;
        }
    }

    fn parts(&self) -> &[u32] {
        std::slice::from_ref(&self.material)
    }

    fn choice<L: Lanes>(&self, _: &ShadingPoint, _: &Reading<'_, L>, _: bool) -> Choice {
        Choice::One(self.material)
    }

    fn opacity(&self) -> Option<Value<f32>> {
        (self.opacity != Value::Constant(1.0)).then_some(self.opacity)
    }

    fn wants(&self) -> Wants {
        Wants::point(self.opacity.varies())
    }

    fn bsdf<'w, L: Lanes>(&'w self, _: &ShadingPoint, _: &Reading<'w, L>) -> Bsdf<'w> {
        Bsdf::Black(Black)
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        vec![(Self { material: 0, opacity: 0.3.into() }, super::BsdfKind::Black)]
    }
}
