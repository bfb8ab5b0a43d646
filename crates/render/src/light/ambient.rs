//! Ambient light: the textbook's stand-in for the light that walls send to one another.
//!
//! It comes from nowhere, so that nothing casts a shadow in it and a surface looks equally bright whichever way it is turned: L = k_a c L_a, with the
//! share k_a c that the surface sends back. It isn't sampled, and no ray meets it; it is added where a path meets a surface.

use crate::lanes::{Colour, Lanes};
use crate::texture::{Readings, Value};
use straal_math::DVec3;
use straal_math::simd::Float;
use straal_scene::desc;

use super::{Emitter, Extent, LightSample, Reach, Receiver, Shine};
use crate::paint::Paint;
use crate::shape::Geometry;

/// The same light for every surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AmbientLight {
    /// Radiance of a surface that sends back all of it, in W/(m² sr).
    pub radiance: Value<Colour>,
}

impl AmbientLight {
    /// Of what a scene says.
    pub(super) fn of(l: &desc::AmbientLight, paint: &mut Paint<'_>, _: DVec3) -> Emitter {
        Emitter::Ambient(Self { radiance: paint.light(&l.radiance) })
    }
}

impl Shine for AmbientLight {
    const EXTENT: Extent = Extent::Nowhere;

    #[inline(always)]
    fn sample_many<F: Float, L: Lanes>(
        &self,
        _: &Geometry,
        _: (&Receiver<F>, [F; 2]),
        _: &Readings<'_, L>,
    ) -> LightSample<F> {
        LightSample::none()
    }

    fn power(&self, _: &Geometry, _: f64) -> f64 {
        0.0
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        None
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        let light = Self { radiance: super::tests::RADIANCE.into() };
        vec![super::tests::Example::alone("ambient", Emitter::Ambient(light))]
    }
}
