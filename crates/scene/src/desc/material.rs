//! Materials.

use crate::describe::describe;
use crate::limit::Limit;
use crate::value::{Color, Name, Value};

describe! {
    /// What a surface does with light.
    pub enum Material {
        /// Scatters light evenly (Lambert).
        "diffuse" => Diffuse(Diffuse),
        /// A perfect mirror.
        "mirror" => Mirror(Mirror),
        /// Smooth glass, water and the like.
        "dielectric" => Dielectric(Dielectric),
        /// Metal, polished or rough.
        "conductor" => Conductor(Conductor),
    }
}

/// A material given by name or on the spot.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialRef {
    /// One of the scene's `materials`.
    Named(Name),
    /// Written where it is used.
    Inline(Material),
}

describe! {
    /// An evenly scattering surface.
    pub struct Diffuse {
        /// Share of light that is reflected.
        reflectance: Value<Color> [Limit::UNIT] = Value::Constant(Color::grey(0.5)),
        /// Whether the back looks like the front; else it is black.
        two_sided: bool = true,
    }
}

describe! {
    /// A perfect mirror.
    pub struct Mirror {
        /// Share of light that is reflected.
        reflectance: Value<Color> [Limit::UNIT] = Value::Constant(Color::grey(1.0)),
        /// Whether the back looks like the front; else it is black.
        two_sided: bool = true,
    }
}

describe! {
    /// A smooth boundary between two transparent media; normals point to the outside.
    pub struct Dielectric {
        /// Index of refraction inside.
        eta: Value<f64> [Limit::within(0.1, 10.0)] = Value::Constant(1.5),
        /// Index of refraction outside.
        eta_outside: Value<f64> [Limit::within(0.1, 10.0)] = Value::Constant(1.0),
        /// Tint of what is reflected; physical is 1.
        reflectance: Value<Color> [Limit::UNIT] = Value::Constant(Color::grey(1.0)),
        /// Tint of what passes; physical is 1.
        transmittance: Value<Color> [Limit::UNIT] = Value::Constant(Color::grey(1.0)),
    }
}

describe! {
    /// A metal: complex index of refraction `eta` + i `k`, relative to air.
    pub struct Conductor {
        /// Real part of the index of refraction.
        eta: Value<Color> [Limit::NON_NEGATIVE],
        /// Imaginary part of the index of refraction: absorption.
        k: Value<Color> [Limit::NON_NEGATIVE],
        /// GGX alpha of the microfacets: 0 is a polished mirror.
        roughness: Value<f64> [Limit::UNIT] = Value::Constant(0.0),
        /// Tint of what is reflected; physical is 1.
        reflectance: Value<Color> [Limit::UNIT] = Value::Constant(Color::grey(1.0)),
        /// Whether the back looks like the front; else it is black.
        two_sided: bool = true,
    }
}
