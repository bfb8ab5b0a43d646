//! Materials.

use crate::desc::check;
use crate::desc::spectrum::{Index, Spectrum};
use crate::desc::texture::Varying;
use crate::describe::describe;
use crate::limit::Limit;
use crate::value::{Link, Name};

describe! {
    /// What a surface does with light.
    pub enum Material {
        /// Scatters light evenly (Lambert).
        "diffuse" => Diffuse(struct Diffuse {
            /// Share of light that is reflected.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.5)),
            /// Whether the back looks like the front; else it is black.
            two_sided: bool = true,
        }),
        /// A perfect mirror.
        "mirror" => Mirror(struct Mirror {
            /// Share of light that is reflected.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// Whether the back looks like the front; else it is black.
            two_sided: bool = true,
        }),
        /// Smooth glass, water and the like: a boundary between two transparent media; normals point to the outside.
        "dielectric" => Dielectric(struct Dielectric {
            /// Index of refraction inside: a number, the name of a glass such as `BK7`, or a formula.
            eta: Index [Limit::within(0.1, 10.0)] = Index::Constant(1.5),
            /// Index of refraction outside.
            eta_outside: Index [Limit::within(0.1, 10.0)] = Index::Constant(1.0),
            /// Tint of what is reflected; physical is 1.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// Tint of what passes; physical is 1.
            transmittance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
        }),
        /// Metal, polished or rough, by name or by its complex index of refraction `eta` + i `k`, relative to air.
        "conductor" => Conductor(struct Conductor [check::conductor] {
            /// A metal whose index was measured, such as `gold`; give this or `eta` and `k`.
            metal: Option<Name> = None,
            /// Real part of the index of refraction.
            eta: Option<Spectrum> [Limit::NON_NEGATIVE] = None,
            /// Imaginary part of the index of refraction: absorption.
            k: Option<Spectrum> [Limit::NON_NEGATIVE] = None,
            /// GGX alpha of the microfacets: 0 is a polished mirror.
            roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Tint of what is reflected; physical is 1.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// Whether the back looks like the front; else it is black.
            two_sided: bool = true,
        }),
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
