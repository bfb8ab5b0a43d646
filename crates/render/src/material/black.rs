//! A surface that scatters nothing.

use straal_color::Light;
use straal_math::Vec3;

use super::{BsdfSample, Scatter, Transport};

/// Scatters nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Black;

impl Scatter for Black {
    fn sample(&self, _: Vec3, _: f32, _: [f32; 2], _: Transport) -> Option<BsdfSample> {
        None
    }

    fn albedo(&self) -> Light {
        Light::ZERO
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        vec![super::testing::Example::new("black", super::Bsdf::Black(Self)).albedo(0.0)]
    }
}
