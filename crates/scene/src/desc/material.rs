//! Materials.

use crate::desc::check;
use crate::desc::spectrum::{Index, Spectrum};
use crate::describe::describe;
use crate::limit::Limit;
use crate::value::{Link, Name, Value};

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
    Named(Link<Material>),
    /// Written where it is used.
    Inline(Material),
}

describe! {
    /// An evenly scattering surface.
    pub struct Diffuse {
        /// Share of light that is reflected.
        reflectance: Value<Spectrum> [Limit::UNIT] = Value::Constant(Spectrum::grey(0.5)),
        /// Whether the back looks like the front; else it is black.
        two_sided: bool = true,
    }
}

describe! {
    /// A perfect mirror.
    pub struct Mirror {
        /// Share of light that is reflected.
        reflectance: Value<Spectrum> [Limit::UNIT] = Value::Constant(Spectrum::grey(1.0)),
        /// Whether the back looks like the front; else it is black.
        two_sided: bool = true,
    }
}

describe! {
    /// A smooth boundary between two transparent media; normals point to the outside.
    pub struct Dielectric {
        /// Index of refraction inside: a number, the name of a glass such as `BK7`, or a formula.
        eta: Index [Limit::within(0.1, 10.0)] = Index::Constant(1.5),
        /// Index of refraction outside.
        eta_outside: Index [Limit::within(0.1, 10.0)] = Index::Constant(1.0),
        /// Tint of what is reflected; physical is 1.
        reflectance: Value<Spectrum> [Limit::UNIT] = Value::Constant(Spectrum::grey(1.0)),
        /// Tint of what passes; physical is 1.
        transmittance: Value<Spectrum> [Limit::UNIT] = Value::Constant(Spectrum::grey(1.0)),
    }
}

describe! {
    /// A metal, by name or by its complex index of refraction `eta` + i `k`, relative to air.
    pub struct Conductor [check::conductor] {
        /// A metal whose index was measured, such as `gold`; give this or `eta` and `k`.
        metal: Option<Name> = None,
        /// Real part of the index of refraction.
        eta: Option<Value<Spectrum>> [Limit::NON_NEGATIVE] = None,
        /// Imaginary part of the index of refraction: absorption.
        k: Option<Value<Spectrum>> [Limit::NON_NEGATIVE] = None,
        /// GGX alpha of the microfacets: 0 is a polished mirror.
        roughness: Value<f64> [Limit::UNIT] = Value::Constant(0.0),
        /// Tint of what is reflected; physical is 1.
        reflectance: Value<Spectrum> [Limit::UNIT] = Value::Constant(Spectrum::grey(1.0)),
        /// Whether the back looks like the front; else it is black.
        two_sided: bool = true,
    }
}
