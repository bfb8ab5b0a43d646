//! Materials.

use crate::desc::check;
use crate::desc::spectrum::{Index, Spectrum};
use crate::desc::texture::Varying;
use crate::describe::describe;
use crate::limit::Limit;
use crate::value::{Color, Link, Name};

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
        /// The uber material of the OpenPBR specification (1.1), with its names: a base of metal, glass and what is diffuse under a
        /// glossy surface; on it a thin film, a coat and fuzz.
        "open_pbr" => OpenPbr(struct OpenPbr {
            /// Factor to `base_color`.
            base_weight: Varying<f64> [Limit::UNIT] = Varying::Constant(1.0),
            /// Colour of what is diffuse, and of metal seen straight on.
            base_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.8)),
            /// Roughness of what is diffuse (EON): 0 is Lambert.
            base_diffuse_roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Which part of the base is metal.
            base_metalness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Factor to what the surface of glass and of what is diffuse reflects straight on, and to all that metal reflects.
            specular_weight: Varying<f64> [Limit::NON_NEGATIVE] = Varying::Constant(1.0),
            /// Tint of the glossy reflection; of metal, at 82 degrees.
            specular_color: Varying<Spectrum> [Limit::within(0.0, 3.9)] = Varying::Constant(Spectrum::grey(1.0)),
            /// Roughness of the surface, the root of GGX's alpha; 0 is polished.
            specular_roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.3),
            /// How much smoother it is across the texture's u than along it.
            specular_roughness_anisotropy: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Index of refraction of the base.
            specular_ior: Varying<f64> [Limit::within(0.1, 5.0)] = Varying::Constant(1.5),
            /// Which part of what isn't metal is clear.
            transmission_weight: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// What is left of light at each crossing of the surface or, with a depth, after that way.
            transmission_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// The way after which light has `transmission_color`: kept for media, which are to come; until then light beyond 0 isn't coloured.
            transmission_depth: Varying<f64> [Limit::NON_NEGATIVE] = Varying::Constant(0.0),
            /// Scattering within `transmission_depth`: kept for media.
            transmission_scatter: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.0)),
            /// Mean cosine of that scattering: kept for media.
            transmission_scatter_anisotropy: Varying<f64> [Limit::within(-1.0, 1.0)] = Varying::Constant(0.0),
            /// How much of the dispersion of `transmission_dispersion_abbe_number` there is.
            transmission_dispersion_scale: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Abbe's number: the less, the more colours part.
            transmission_dispersion_abbe_number: Varying<f64> [Limit::within(6.2, 1e6)] = Varying::Constant(20.0),
            /// Which part of what is neither metal nor clear scatters beneath its surface: diffuse in `subsurface_color`, until there are media.
            subsurface_weight: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Colour that what scatters beneath the surface has as a whole.
            subsurface_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.8)),
            /// Mean way between two scatterings, in metres: kept for media.
            subsurface_radius: Varying<f64> [Limit::NON_NEGATIVE] = Varying::Constant(1.0),
            /// Factor to `subsurface_radius` by colour: kept for media.
            subsurface_radius_scale: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::Rgb(Color([1.0, 0.5, 0.25]))),
            /// Of a thin wall: which part passes, from -1 for none to 1 for all.
            subsurface_scatter_anisotropy: Varying<f64> [Limit::within(-1.0, 1.0)] = Varying::Constant(0.0),
            /// How much of the coat there is.
            coat_weight: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// What the coat leaves of light that crosses it twice, straight.
            coat_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// Roughness of the coat; what lies below looks rougher as well.
            coat_roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// As that of the base.
            coat_roughness_anisotropy: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Index of refraction of the coat.
            coat_ior: Varying<f64> [Limit::within(0.1, 5.0)] = Varying::Constant(1.6),
            /// How much darker what lies below is by light that the coat reflects back to it.
            coat_darkening: Varying<f64> [Limit::UNIT] = Varying::Constant(1.0),
            /// How much fuzz there is.
            fuzz_weight: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Tint of what the fuzz reflects.
            fuzz_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// How much the fibres stand in all directions; 0 is none.
            fuzz_roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.5),
            /// How much of a thin film there is on the base.
            thin_film_weight: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Thickness of the film in micrometres.
            thin_film_thickness: Varying<f64> [Limit::within(0.0, 6.5)] = Varying::Constant(0.5),
            /// Index of refraction of the film.
            thin_film_ior: Varying<f64> [Limit::within(0.1, 5.0)] = Varying::Constant(1.4),
            /// Whether the surface is a wall without thickness, such as a pane or a leaf: light goes straight on.
            geometry_thin_walled: bool = false,
            /// Whether coat and fuzz take what they reflect from the light on its way in *and* out: the same from both ends, and darker.
            reciprocal: bool = false,
            /// Whether the back of what is opaque looks like the front; else it is black.
            two_sided: bool = true,
        }),
        /// Disney's BSDF as Mitsuba 3 has it, exactly.
        "principled" => Principled(struct Principled [check::principled] {
            /// Colour of what is diffuse and of metal; its root is the tint of glass.
            base_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.5)),
            /// Roughness: the root of GGX's alpha.
            roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.5),
            /// How much smoother it is across the texture's u than along it.
            anisotropic: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Which part is metal.
            metallic: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Which part of the rest is glass.
            spec_trans: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Index of refraction inside over that outside; give this or `specular`.
            eta: Option<f64> [Limit::within(0.1, 10.0)] = None,
            /// What is reflected straight on, in 8 hundredths: another way to tell the index; 0.5 where neither is given.
            specular: Option<f64> [Limit::UNIT] = None,
            /// How much of the base's colour the glossy reflection has.
            spec_tint: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// How much sheen.
            sheen: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// How much of the base's colour the sheen has.
            sheen_tint: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// How much of the diffuse part is flattened, as if light scattered beneath.
            flatness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// How much of a clear coat.
            clearcoat: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// How smooth the clear coat is.
            clearcoat_gloss: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Whether the back of what is opaque looks like the front; else it is black, as in Mitsuba.
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
    Inline(Box<Material>),
}
