//! Materials: what a surface does with light. This page is the contract; each kind has its file.
//!
//! A [`Material`] is evaluated at a point to a small [`Bsdf`], which answers everything else. Directions are unit
//! vectors in the local frame of the *shading* normal (z), and point away from the surface: `wo` is where light
//! goes (towards the camera on a camera path) and given, `wi` is where it comes from. A BSDF
//!
//! - has values f(wo, wi), told multiplied by |cos| of `wi`: [`Bsdf::eval`] is f |wi.z|. It knows nothing of geometric
//!   normals: [`shaded`] sees to it that no light goes through an opaque surface;
//! - draws directions with [`Bsdf::sample`]: `weight` is f |cos| / pdf, for the density `pdf` that [`Bsdf::pdf`]
//!   tells of the same pair (per solid angle, cosine not divided out). `None` is a draw without value: absorbed,
//!   below the surface, seen from behind;
//! - may have delta lobes (mirrors, smooth glass), which `eval` and `pdf` leave out. A direction drawn from one
//!   says so (`delta`), its `pdf` is the probability of the lobe, and its `weight` is the lobe's coefficient
//!   divided by that probability;
//! - scatters radiance or importance ([`Transport`]). They differ where light passes into another index of
//!   refraction: radiance is compressed with the solid angle, by the squared ratio of the indices (Veach 1997,
//!   5.2). Apart from that f is symmetric (reciprocity), and no more comes out than goes in.
//!
//! Opaque surfaces look the same from both sides, unless they are told to be black from behind (z < 0).
//!
//! To add a material, write its file, add an arm here, in the description, and to the registry in `tests.rs`: its
//! BSDF then has to pass the chi-square, reciprocity and energy tests.

use std::fmt;
use std::sync::Arc;

use crate::integrator::Kind;
use crate::lanes::{Colour, EtaTable, Lanes, ReadRgb, Reading};
use straal_color::Light;
use straal_math::Vec3;

mod conductor;
mod dielectric;
mod diffuse;
pub mod fresnel;
mod ggx;
mod mirror;
mod prism;
pub mod shaded;
#[cfg(test)]
mod tests;
mod value;

pub use conductor::{Conductor, Metal, RoughConductor};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use mirror::Mirror;
pub use prism::Prism;
pub use shaded::Shaded;
pub use value::{TexturePoint, Value};

/// What a path carries from the surface on: radiance is traced from the camera, importance from a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// The path started at the camera; `wi` is where radiance comes from.
    Radiance,
    /// The path started at a light; `wi` is where importance comes from, and light goes.
    Importance,
}

/// A direction drawn from a BSDF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// The direction, of unit length.
    pub wi: Vec3,
    /// f |cos| / pdf, or the coefficient of a delta lobe over its probability.
    pub weight: Light,
    /// Per solid angle; for delta lobes the probability of having been chosen.
    pub pdf: f32,
    /// From a delta lobe: nothing else can draw this direction.
    pub delta: bool,
    /// Passed through to the other side.
    pub transmitted: bool,
    /// Index of refraction on the side of `wi` over that on the side of `wo`: 1 for reflection.
    pub eta: f32,
    /// Above 0 where the direction is that of a single wavelength, which alone goes on ([`crate::lanes::Lanes::only`]).
    pub wavelength: f32,
}

/// How a point of a surface scatters. Where it shines is another's business.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf<'w> {
    /// Scatters nothing.
    Black,
    /// Evenly.
    Diffuse(Diffuse),
    /// As a mirror.
    Mirror(Mirror),
    /// As smooth glass.
    Dielectric(Dielectric),
    /// As smooth glass with dispersion.
    Prism(Prism<'w>),
    /// As polished metal.
    Conductor(Conductor),
    /// As rough metal.
    RoughConductor(RoughConductor),
    /// As a user of the library says.
    Custom(CustomBsdf<'w>),
}

impl Bsdf<'_> {
    /// f(wo, wi) |cos wi| without delta lobes.
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3, transport: Transport) -> Light {
        self.eval_pdf(wo, wi, transport).0
    }

    /// The density with which [`Self::sample`] draws `wi`, per solid angle, without delta lobes.
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> f32 {
        self.eval_pdf(wo, wi, transport).1
    }

    /// [`Self::eval`] and [`Self::pdf`] at once.
    #[inline]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Light, f32) {
        match self {
            Self::Black | Self::Mirror(_) | Self::Dielectric(_) | Self::Prism(_) | Self::Conductor(_) => {
                (Light::ZERO, 0.0)
            }
            Self::Diffuse(b) => b.eval_pdf(wo, wi),
            Self::RoughConductor(b) => b.eval_pdf(wo, wi),
            Self::Custom(b) => b.scattering.eval_pdf(&b.parameters, Pair { wo, wi }, transport),
        }
    }

    /// Draws a direction by numbers in [0, 1): `u_lobe` chooses a lobe, `u` where in it.
    #[inline]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        match self {
            Self::Black => None,
            Self::Diffuse(b) => b.sample(wo, u),
            Self::Mirror(b) => b.sample(wo),
            Self::Dielectric(b) => b.sample(wo, u_lobe, transport),
            Self::Prism(b) => b.sample(wo, [u_lobe, u[0]], transport),
            Self::Conductor(b) => b.sample(wo),
            Self::RoughConductor(b) => b.sample(wo, u),
            Self::Custom(b) => b.scattering.sample(&b.parameters, wo, [u_lobe, u[0], u[1]], transport),
        }
    }

    /// Whether [`Self::sample`] reads the number that chooses a lobe.
    #[inline]
    pub fn chooses_lobe(&self) -> bool {
        matches!(self, Self::Dielectric(_) | Self::Prism(_) | Self::Custom(_))
    }

    /// Whether it has nothing but delta lobes: `eval` and `pdf` are 0 everywhere, asking lights is in vain.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Black | Self::Mirror(_) | Self::Dielectric(_) | Self::Prism(_) | Self::Conductor(_) => true,
            Self::Diffuse(_) | Self::RoughConductor(_) => false,
            Self::Custom(b) => b.scattering.is_delta(&b.parameters),
        }
    }

    /// The colour of the surface, as denoisers and people want it: the share of light that comes back from the
    /// front, 1 for glass.
    pub fn albedo(&self) -> Light {
        match self {
            Self::Black => Light::ZERO,
            Self::Diffuse(b) => b.reflectance,
            Self::Mirror(b) => b.reflectance,
            Self::Dielectric(b) => b.albedo(),
            Self::Prism(b) => b.albedo(),
            Self::Conductor(b) => b.metal.albedo(),
            Self::RoughConductor(b) => b.metal.albedo(),
            Self::Custom(b) => b.scattering.albedo(&b.parameters),
        }
    }
}

/// The factor to z that brings `wo` to the front: -1 for a back that looks like the front. `None` where nothing is
/// seen: a black back, or along the surface.
#[inline(always)]
fn facing(wo: Vec3, two_sided: bool) -> Option<f32> {
    if wo.z > 0.0 {
        Some(1.0)
    } else if wo.z < 0.0 && two_sided {
        Some(-1.0)
    } else {
        None
    }
}

/// What a surface is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// Scatters evenly.
    Diffuse {
        /// Share of light that is reflected.
        reflectance: Value<Colour>,
        /// Whether the back looks like the front; else it is black.
        two_sided: bool,
    },
    /// A perfect mirror.
    Mirror {
        /// Share of light that is reflected.
        reflectance: Value<Colour>,
        /// Whether the back looks like the front; else it is black.
        two_sided: bool,
    },
    /// A smooth boundary between transparent media; the shading normal points outside.
    Dielectric {
        /// Index of refraction inside.
        eta: Value<f32>,
        /// Index of refraction outside.
        eta_outside: Value<f32>,
        /// Tint of what is reflected; physical is 1.
        reflectance: Value<Colour>,
        /// Tint of what passes; physical is 1.
        transmittance: Value<Colour>,
    },
    /// The same with an index that depends on the wavelength.
    Prism {
        /// Index inside over index outside.
        eta: EtaTable,
        /// Tint of what is reflected; physical is 1.
        reflectance: Value<Colour>,
        /// Tint of what passes; physical is 1.
        transmittance: Value<Colour>,
    },
    /// A metal, polished or rough.
    Conductor {
        /// Real part of the index of refraction, relative to the outside.
        eta: Value<Colour>,
        /// Imaginary part: absorption.
        k: Value<Colour>,
        /// GGX alpha; 0 is polished.
        roughness: Value<f32>,
        /// Tint of what is reflected; physical is 1.
        reflectance: Value<Colour>,
        /// Whether the back looks like the front; else it is black.
        two_sided: bool,
    },
    /// A material of the library's user: index into [`Materials::custom`].
    Custom(u32),
}

impl Material {
    /// What must be computed where a ray meets it.
    pub(crate) fn kind(&self) -> Kind {
        match self {
            Self::Diffuse { reflectance: Value::Constant(c), .. } if c.strength == 0.0 => Kind::Dark,
            Self::Diffuse { .. } => Kind::Scattering(0),
            Self::Mirror { .. } => Kind::Scattering(1),
            Self::Dielectric { .. } => Kind::Scattering(2),
            Self::Prism { .. } => Kind::Scattering(3),
            Self::Conductor { .. } => Kind::Scattering(4),
            Self::Custom(_) => Kind::Scattering(5),
        }
    }
}

/// All materials of a world.
#[derive(Clone, Debug, Default)]
pub struct Materials {
    /// What surfaces refer to by index.
    pub list: Vec<Material>,
    /// What [`Material::Custom`] refers to.
    pub custom: Vec<Arc<dyn CustomMaterial>>,
}

impl Materials {
    /// How material `index` scatters at a point. Black when there is no such material.
    #[inline]
    pub fn bsdf<'w, L: Lanes>(&'w self, index: u32, at: &TexturePoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let black = Bsdf::Black;
        let light = |value: &Value<Colour>| reading.light(&value.eval(at));
        match self.list.get(index as usize) {
            None => black,
            Some(Material::Diffuse { reflectance, two_sided }) => {
                let reflectance = light(reflectance);
                if reflectance.is_black() {
                    return black;
                }
                Bsdf::Diffuse(Diffuse { reflectance, two_sided: *two_sided })
            }
            Some(Material::Mirror { reflectance, two_sided }) => {
                Bsdf::Mirror(Mirror { reflectance: light(reflectance), two_sided: *two_sided })
            }
            Some(Material::Dielectric { eta, eta_outside, reflectance, transmittance }) => {
                Bsdf::Dielectric(Dielectric {
                    eta: eta.eval(at) / eta_outside.eval(at),
                    reflectance: light(reflectance),
                    transmittance: light(transmittance),
                })
            }
            Some(Material::Prism { eta, reflectance, transmittance }) => Bsdf::Prism(Prism {
                eta,
                palette: reading.palette,
                hue: reading.lanes.hue().packed(),
                reflectance: light(reflectance),
                transmittance: light(transmittance),
            }),
            Some(Material::Conductor { eta, k, roughness, reflectance, two_sided }) => {
                let metal = Metal { eta: light(eta), k: light(k), reflectance: light(reflectance) };
                let (alpha, two_sided) = (roughness.eval(at), *two_sided);
                if alpha > 0.0 {
                    let rough = RoughConductor::new(metal, alpha);
                    Bsdf::RoughConductor(if two_sided { rough } else { rough.one_sided() })
                } else {
                    Bsdf::Conductor(Conductor { metal, two_sided })
                }
            }
            Some(Material::Custom(i)) => self.custom.get(*i as usize).map_or(black, |m| m.bsdf(at, reading)),
        }
    }
}

/// A material that a user of the library brings. It is pure: the same input gives the same bits.
pub trait CustomMaterial: fmt::Debug + Send + Sync {
    /// How it scatters at a point: one of the built-in BSDFs, or [`Bsdf::Custom`]. Colours become light through `read`.
    fn bsdf(&self, at: &TexturePoint, read: &dyn ReadRgb) -> Bsdf<'_>;
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

/// The two directions of a BSDF, see [the contract](self).
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
