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
//! A material is a `Recipe` that is read as a BSDF, of a kind of its own (`Scatter`) or one that is there. To add one: its file,
//! with both; its line in the list below; its keys in the description. The list makes the rest, and hands what the file gives for
//! examples to the tests: chi-square, reciprocity, energy. A BSDF that is a `many::Lobe` as well is computed for 8 or 16 vertices at once.

use straal_color::Light;
use straal_math::Vec3;
use straal_math::simd::{Float, Mask};
use straal_scene::desc;

use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};
use many::{OfKind, These, WithKind};

mod all;
mod black;
mod coated;
mod conductor;
mod custom;
mod dielectric;
mod diffuse;
mod diffuse_transmission;
mod dispersive;
pub mod energy;
mod facet_conductor;
pub mod film;
mod fresnel;
mod ggx;
mod glossy;
mod gltf;
pub mod interior;
mod list;
pub(crate) mod many;
mod mask;
pub mod microfacet;
mod mirror;
mod mix;
pub mod open_pbr;
mod phong;
mod plastic;
mod principled;
mod relative;
mod rough_conductor;
mod rough_dielectric;
mod rough_diffuse;
mod schlick_mirror;
pub mod shaded;
mod sheen;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod thin_dielectric;
mod thin_film;
mod transparent;
mod two_faces;

pub use all::{DEEPEST, Materials};
pub use black::Black;
pub use coated::{Coat, Coated, CoatedConductorMaterial, CoatedDiffuseMaterial};
pub use conductor::{Conductor, ConductorMaterial, Metal};
pub use custom::{CustomBsdf, CustomMaterial, CustomScattering, Pair};
pub use dielectric::{Dielectric, DielectricMaterial};
pub use diffuse::{Diffuse, DiffuseMaterial};
pub use diffuse_transmission::{DiffuseTransmission, DiffuseTransmissionMaterial};
pub use dispersive::DispersiveDielectric;
pub use facet_conductor::FacetConductor;
pub use glossy::{Glossy, GlossyMaterial};
pub use gltf::GltfMaterial;
pub use interior::{Interior, Interiors};
pub use mask::MaskMaterial;
pub use mirror::{Mirror, MirrorMaterial};
pub use mix::MixMaterial;
pub use open_pbr::{OpenPbr, OpenPbrMaterial};
pub use phong::{Form, Phong, PhongMaterial, Scale};
pub use plastic::{Plastic, PlasticMaterial};
pub use principled::{Principled, PrincipledMaterial};
pub use relative::Relative;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use rough_diffuse::RoughDiffuse;
pub use schlick_mirror::SchlickMirror;
pub use shaded::Shaded;
pub use sheen::{Sheen, SheenMaterial};
pub use thin_dielectric::{ThinDielectric, ThinDielectricMaterial};
pub use thin_film::{Bands, ThinFilm, ThinFilmMaterial};
pub use transparent::{Clear, Share, TransparentMaterial};
pub use two_faces::TwoFacesMaterial;

list::materials! {
    /// Scatters evenly.
    Diffuse(DiffuseMaterial),
    /// A perfect mirror.
    Mirror(MirrorMaterial),
    /// A smooth boundary between transparent media.
    Dielectric(DielectricMaterial),
    /// A metal, polished or rough.
    Conductor(ConductorMaterial),
    /// A highlight over an even ground, as textbooks have it.
    Phong(PhongMaterial),
    /// A blurred mirror.
    Glossy(GlossyMaterial),
    /// A boundary that reflects the same share at every angle.
    Transparent(TransparentMaterial),
    /// A pane without an inside.
    ThinDielectric(ThinDielectricMaterial),
    /// A soap bubble, or what shimmers on metal.
    ThinFilm(ThinFilmMaterial),
    /// Scatters evenly on both sides.
    DiffuseTransmission(DiffuseTransmissionMaterial),
    /// An even ground below a clear boundary.
    Plastic(PlasticMaterial),
    /// A coat over a diffuse ground.
    CoatedDiffuse(CoatedDiffuseMaterial),
    /// A coat over metal.
    CoatedConductor(CoatedConductorMaterial),
    /// Cloth: a ground with fibres that light up at grazing angles.
    Sheen(SheenMaterial),
    /// Two materials, each with a share.
    Mix(MixMaterial),
    /// A material with holes.
    Mask(MaskMaterial),
    /// A material for each side.
    TwoFaces(TwoFacesMaterial),
    /// The layers of OpenPBR.
    OpenPbr(Box<OpenPbrMaterial>),
    /// Disney's, as Mitsuba has it.
    Principled(PrincipledMaterial),
    /// glTF's, by the layers of OpenPBR.
    Gltf(Box<GltfMaterial>),
}

list::bsdfs! {
    /// Scatters nothing.
    Black(Black),
    /// Evenly.
    Diffuse(Diffuse),
    /// As a mirror.
    Mirror(Mirror),
    /// As smooth glass.
    Dielectric(Dielectric),
    /// As smooth glass with dispersion.
    DispersiveDielectric(DispersiveDielectric<'w>),
    /// As polished metal.
    Conductor(Conductor),
    /// As rough metal.
    RoughConductor(RoughConductor),
    /// As a mirror whose share grows towards grazing angles.
    SchlickMirror(SchlickMirror),
    /// As smooth glass with shares of another kind.
    Clear(Clear),
    /// Evenly, with a highlight.
    Phong(Phong),
    /// As a blurred mirror.
    Glossy(Glossy),
    /// As rough metal of any kind.
    FacetConductor(FacetConductor<'w>),
    /// As rough glass.
    RoughDielectric(RoughDielectric<'w>),
    /// As a pane without an inside.
    ThinDielectric(ThinDielectric),
    /// As a thin film.
    ThinFilm(ThinFilm<'w>),
    /// Evenly on both sides.
    DiffuseTransmission(DiffuseTransmission),
    /// As an even ground below a clear boundary.
    Plastic(Plastic<'w>),
    /// As cloth.
    Sheen(Sheen),
    /// As what is below a coat.
    Coated(Coated),
    /// As a rough diffuse surface.
    RoughDiffuse(RoughDiffuse),
    /// By the layers of OpenPBR.
    OpenPbr(OpenPbr),
    /// As Disney's.
    Principled(Principled),
    /// As a user of the library says.
    Custom(CustomBsdf<'w>),
}

/// A material as a recipe: its parameters, how they come of what a scene says, and what they are at a point.
pub(crate) trait Recipe: Sized {
    /// What a scene says of it.
    type Described;

    /// Whether light passes through it.
    fn is_clear(&self) -> bool {
        false
    }

    /// Of what a scene says.
    fn of(described: &Self::Described, paint: &mut Paint<'_>) -> Self;

    /// What it is filled with, if light goes through it into a medium.
    fn interior(&self) -> Option<&Interior> {
        None
    }

    /// Takes the indices of the materials that it is made of, in the order of `desc::Material::parts`.
    fn link(&mut self, _parts: &[u32]) {}

    /// The materials that it is made of.
    fn parts(&self) -> &[u32] {
        &[]
    }

    /// Which of them it is at a point, seen from the side that the normal points to or from the other. Such a material has no BSDF of its own.
    fn choice<L: Lanes>(&self, _at: &ShadingPoint, _reading: &Reading<'_, L>, _in_front: bool) -> Choice {
        Choice::Itself
    }

    /// The share of light that doesn't pass through as if nothing were there, if that isn't all.
    fn opacity(&self) -> Option<Value<f32>> {
        None
    }

    /// What it sends out itself, if it shines.
    fn emission(&self) -> Option<Emission> {
        None
    }

    /// What of that gets out through the layers above it, by the cosine of the direction.
    fn lets_out<L: Lanes>(&self, _cos: f32, _at: &ShadingPoint, _reading: &Reading<'_, L>) -> Light {
        Light::ONE
    }

    /// What it must know of a point: a [`ShadingPoint`], if any of its values [varies](crate::texture::Value::varies).
    fn wants(&self) -> Wants;

    /// How it scatters at a point. Values are read by [`Reading::eval`].
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w>;

    /// Some for the tests, each with the kind of BSDF as which it is read.
    #[cfg(test)]
    fn examples() -> Vec<(Self, BsdfKind)>;
}

/// What a material sends out itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Radiance, before what [`Material::lets_out`].
    pub radiance: Value<Colour>,
    /// The most that that is multiplied by.
    pub most: f32,
    /// From both sides, as a wall without thickness does.
    pub both_sides: bool,
}

/// What a material is at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Choice {
    /// Itself.
    Itself,
    /// Another.
    One(u32),
    /// One of two, the second with this chance.
    Two([u32; 2], f32),
}

/// A large one.
impl<R: Recipe> Recipe for Box<R> {
    type Described = R::Described;

    fn is_clear(&self) -> bool {
        (**self).is_clear()
    }

    fn of(described: &R::Described, paint: &mut Paint<'_>) -> Self {
        Self::new(R::of(described, paint))
    }

    fn interior(&self) -> Option<&Interior> {
        (**self).interior()
    }

    fn link(&mut self, parts: &[u32]) {
        (**self).link(parts);
    }

    fn parts(&self) -> &[u32] {
        (**self).parts()
    }

    fn choice<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, in_front: bool) -> Choice {
        (**self).choice(at, reading, in_front)
    }

    fn opacity(&self) -> Option<Value<f32>> {
        (**self).opacity()
    }

    fn emission(&self) -> Option<Emission> {
        (**self).emission()
    }

    fn lets_out<L: Lanes>(&self, cos: f32, at: &ShadingPoint, reading: &Reading<'_, L>) -> Light {
        (**self).lets_out(cos, at, reading)
    }

    fn wants(&self) -> Wants {
        (**self).wants()
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        (**self).bsdf(at, reading)
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, BsdfKind)> {
        R::examples().into_iter().map(|(recipe, kind)| (Self::new(recipe), kind)).collect()
    }
}

/// What a kind of BSDF does, by [the contract](self). It is small, plain data.
pub(crate) trait Scatter: Copy {
    /// Whether [`Self::sample`] reads the number that chooses a lobe.
    const CHOOSES_LOBE: bool = false;

    /// Whether it is written for any number of lanes ([`many::Lobe`]); else it is asked lane by lane, among all other kinds.
    const SIDE_BY_SIDE: bool = false;

    /// Whether what it would send into the surface is lost; else a mirror on the surface sends it out, see [`shaded`].
    const LOSES_BELOW: bool = false;

    /// Whether light from the other side may come through by a lobe that isn't delta, so that lights behind the surface are asked as well.
    const TRANSMITS: bool = false;

    /// Whether that is so of this very one.
    #[inline(always)]
    fn transmits(&self) -> bool {
        Self::TRANSMITS
    }

    /// See [`Self::LOSES_BELOW`], of this very one.
    #[inline(always)]
    fn loses_below(&self) -> bool {
        Self::LOSES_BELOW
    }

    /// See [`Bsdf::is_delta`].
    #[inline]
    fn is_delta(&self) -> bool {
        true
    }

    /// See [`Bsdf::eval_pdf`].
    #[inline]
    fn eval_pdf(&self, _wo: Vec3, _wi: Vec3, _transport: Transport) -> (Light, f32) {
        (Light::ZERO, 0.0)
    }

    /// See [`Bsdf::sample`].
    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], transport: Transport) -> Option<BsdfSample>;

    /// See [`Bsdf::albedo`].
    fn albedo(&self) -> Light;

    /// See [`Bsdf::ambient`].
    fn ambient(&self) -> Light {
        Light::ZERO
    }

    /// [`Self::eval_pdf`] of many side by side, for directions `wo` and `wi`. Of a kind that is a [`many::Lobe`] the macro `is_lobe`
    /// has this and the next.
    #[inline(always)]
    fn eval_pdf_many<F: Float>(
        these: impl These<Self>,
        pair: [Vec3<F>; 2],
        transport: Transport,
    ) -> (Light<F>, F) {
        many::eval_pdf_one_by_one(these, pair, transport)
    }

    /// [`Self::sample`] of many side by side, by a number for the lobe and two for the direction; and which of them are of value.
    #[inline(always)]
    fn sample_many<F: Float>(
        these: impl These<Self>,
        wo: Vec3<F>,
        u: [F; 3],
        transport: Transport,
    ) -> (BsdfSample<F>, F::Mask) {
        many::sample_one_by_one(these, wo, u, transport)
    }

    /// Some for the tests of the contract.
    #[cfg(test)]
    fn examples() -> Vec<testing::Example>;
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
}

/// What a path carries from the surface on: radiance is traced from the camera, importance from a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// The path started at the camera; `wi` is where radiance comes from.
    Radiance,
    /// The path started at a light; `wi` is where importance comes from, and light goes.
    Importance,
}

/// A direction drawn from a BSDF, or many side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample<F: Float = f32> {
    /// The direction, of unit length.
    pub wi: Vec3<F>,
    /// f |cos| / pdf, or the coefficient of a delta lobe over its probability.
    pub weight: Light<F>,
    /// Per solid angle; for delta lobes the probability of having been chosen.
    pub pdf: F,
    /// From a delta lobe: nothing else can draw this direction.
    pub delta: F::Mask,
    /// Passed through to the other side.
    pub transmitted: F::Mask,
    /// Index of refraction on the side of `wi` over that on the side of `wo`: 1 for reflection.
    pub eta: F,
    /// Above 0 where the direction is that of a single wavelength, which alone goes on ([`crate::lanes::Lanes::only`]).
    pub wavelength: F,
}

impl BsdfSample {
    /// A reflection that is still to be drawn: worth nothing.
    pub(crate) const REFLECTED: Self = Self {
        wi: Vec3::ZERO,
        weight: Light::ZERO,
        pdf: 0.0,
        delta: false,
        transmitted: false,
        eta: 1.0,
        wavelength: 0.0,
    };
}

impl<F: Float> BsdfSample<F> {
    /// Off a lobe with a density.
    #[inline(always)]
    pub(crate) fn reflected(wi: Vec3<F>, weight: Light<F>, pdf: F) -> Self {
        let no = F::Mask::splat(false);
        Self { wi, weight, pdf, delta: no, transmitted: no, eta: F::ONE, wavelength: F::ZERO }
    }

    /// `yes` where the mask says so, `no` elsewhere.
    #[inline(always)]
    pub(crate) fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            wi: Vec3::select(mask, yes.wi, no.wi),
            weight: Light::select(mask, yes.weight, no.weight),
            pdf: F::select(mask, yes.pdf, no.pdf),
            delta: mask & yes.delta | !mask & no.delta,
            transmitted: mask & yes.transmitted | !mask & no.transmitted,
            eta: F::select(mask, yes.eta, no.eta),
            wavelength: F::select(mask, yes.wavelength, no.wavelength),
        }
    }
}

/// The factor to z that brings `wo` to the front: -1 for a back that looks like the front. `None` where nothing is
/// seen: a black back, or along the surface.
#[allow(dead_code, reason = "for kinds that are computed one vertex after the other")]
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

/// As [`facing`], 0 where nothing is seen; for many side by side.
#[inline(always)]
fn facing_or_zero<F: Float>(wo: Vec3<F>, two_sided: F::Mask) -> F {
    let behind = F::select(wo.z.lt(F::ZERO) & two_sided, -F::ONE, F::ZERO);
    F::select(wo.z.gt(F::ZERO), F::ONE, behind)
}

/// What a material must know of a point. What none wants isn't computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wants {
    /// Where it is, and what a pixel sees there: a [`ShadingPoint`].
    pub point: bool,
    /// Besides, that the frame in which it scatters has a tangent that follows the texture's u, as anisotropic
    /// scattering must.
    pub tangent: bool,
}

impl Wants {
    /// A point, or nothing.
    pub const fn point(point: bool) -> Self {
        Self { point, tangent: false }
    }
}
