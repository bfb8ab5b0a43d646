//! Materials and BSDFs that a user of the library brings.

use std::fmt;

use straal_color::Light;
use straal_math::Vec3;

use super::{Bsdf, BsdfSample, Scatter, Transport, Wants};
#[cfg(test)]
use super::{testing, tests};
use crate::texture::{ReadRgb, ShadingPoint};
/// A material that a user of the library brings. It is pure: the same input gives the same bits.
pub trait CustomMaterial: fmt::Debug + Send + Sync {
    /// How it scatters at a point: one of the built-in BSDFs, or [`Bsdf::Custom`]. Colours become light through `read`.
    fn bsdf(&self, at: &ShadingPoint, read: &dyn ReadRgb) -> Bsdf<'_>;
    /// What it must know of a point: where it is, unless it says otherwise.
    fn wants(&self) -> Wants {
        Wants::point(true)
    }
    /// A number that differs when the material does: it goes into the scene's hash.
    fn fingerprint(&self) -> u64;
}

/// A user's BSDF: a way of scattering and its parameters at a point.
#[derive(Clone, Copy, Debug)]
pub struct CustomBsdf<'w> {
    /// What it does.
    pub scattering: &'w dyn CustomScattering,
    /// With what, for instance a colour, and a roughness.
    pub parameters: [Light; 2],
}

/// The two directions of a BSDF, see [the contract](super).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Where light goes.
    pub wo: Vec3,
    /// Where it comes from.
    pub wi: Vec3,
}

/// What a user's BSDF answers, by the same contract as [`Bsdf`]. It is pure.
pub trait CustomScattering: fmt::Debug + Sync {
    /// See [`Bsdf::eval_pdf`].
    fn eval_pdf(&self, parameters: &[Light; 2], pair: Pair, transport: Transport) -> (Light, f32);
    /// See [`Bsdf::sample`]; the first number is the lobe's.
    fn sample(
        &self,
        parameters: &[Light; 2],
        wo: Vec3,
        u: [f32; 3],
        transport: Transport,
    ) -> Option<BsdfSample>;
    /// See [`Bsdf::is_delta`].
    fn is_delta(&self, parameters: &[Light; 2]) -> bool;
    /// See [`Bsdf::albedo`].
    fn albedo(&self, parameters: &[Light; 2]) -> Light;
}

impl Scatter for CustomBsdf<'_> {
    const CHOOSES_LOBE: bool = true;

    #[inline]
    fn is_delta(&self) -> bool {
        self.scattering.is_delta(&self.parameters)
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Light, f32) {
        self.scattering.eval_pdf(&self.parameters, Pair { wo, wi }, transport)
    }

    #[inline]
    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        self.scattering.sample(&self.parameters, wo, [u_lobe, u[0], u[1]], transport)
    }

    fn albedo(&self) -> Light {
        self.scattering.albedo(&self.parameters)
    }

    #[cfg(test)]
    fn examples() -> Vec<testing::Example> {
        vec![tests::varnish()]
    }
}
