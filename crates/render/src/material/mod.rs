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

use std::fmt;
use std::sync::Arc;

use straal_color::Light;
use straal_math::Vec3;
use straal_math::ops;
use straal_math::simd::{Float, Mask};
use straal_scene::desc;

use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::relief::Relief;
use crate::texture::{ReadRgb, Reading, ShadingPoint, Value};
use many::{OfKind, These, WithKind};

mod black;
mod coated;
mod conductor;
mod dielectric;
mod diffuse;
mod diffuse_transmission;
mod dispersive;
pub mod energy;
mod facet_conductor;
pub mod fresnel;
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
mod transparent;
mod two_faces;

pub use black::Black;
pub use coated::{Coat, Coated, CoatedConductorMaterial, CoatedDiffuseMaterial};
pub use conductor::{Conductor, ConductorMaterial, Metal};
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
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use rough_diffuse::RoughDiffuse;
pub use schlick_mirror::SchlickMirror;
pub use shaded::Shaded;
pub use sheen::{Sheen, SheenMaterial};
pub use thin_dielectric::{ThinDielectric, ThinDielectricMaterial};
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
    FacetConductor(FacetConductor),
    /// As rough glass.
    RoughDielectric(RoughDielectric<'w>),
    /// As a pane without an inside.
    ThinDielectric(ThinDielectric),
    /// Evenly on both sides.
    DiffuseTransmission(DiffuseTransmission),
    /// As an even ground below a clear boundary.
    Plastic(Plastic<'w>),
    /// As cloth.
    Sheen(Sheen),
    /// As what is below a coat.
    Coated(Coated<'w>),
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
    const CLEAR: bool = false;

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

    const CLEAR: bool = R::CLEAR;

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

/// Most materials inside one another.
pub const DEEPEST: usize = straal_scene::materials::DEEPEST;

/// All materials of a world.
#[derive(Clone, Debug, Default)]
pub struct Materials {
    /// What surfaces refer to by index.
    list: Vec<Material>,
    /// What each wants to know of a point.
    wants: Vec<Wants>,
    /// What each seems to be besides.
    reliefs: Vec<Option<Relief>>,
    /// Whether any wants anything.
    vary: bool,
    /// Whether each is made of others.
    made_of: Vec<bool>,
    /// Whether light may pass through each as if nothing were there.
    may_pass: Vec<bool>,
    /// Whether any is made of others.
    any_made_of: bool,
    /// Whether light may pass through any.
    any_may_pass: bool,
    /// What they are filled with.
    interiors: Interiors,
    /// What [`Material::Custom`] refers to.
    custom: Vec<Arc<dyn CustomMaterial>>,
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

impl Materials {
    /// Adds a material; gives its index.
    pub fn push(&mut self, material: Material) -> u32 {
        self.list.push(material);
        self.wants.push(Wants::default());
        self.reliefs.push(None);
        let index = (self.list.len() - 1) as u32;
        self.note(index);
        index
    }

    /// Adds a user's material; gives its index.
    pub fn push_custom(&mut self, material: Arc<dyn CustomMaterial>) -> u32 {
        self.custom.push(material);
        self.push(Material::Custom((self.custom.len() - 1) as u32))
    }

    /// Puts another material in the place of one that is there.
    pub fn replace(&mut self, index: u32, material: Material) {
        self.list[index as usize] = material;
        self.note(index);
    }

    /// Gives a material a relief.
    pub fn pretend(&mut self, index: u32, relief: Relief) {
        self.reliefs[index as usize] = Some(relief);
        self.note(index);
    }

    /// The relief of material `index`.
    pub fn relief(&self, index: u32) -> Option<&Relief> {
        self.reliefs.get(index as usize)?.as_ref()
    }

    fn note(&mut self, index: u32) {
        let mut wants = match &self.list[index as usize] {
            Material::Custom(i) => self.custom.get(*i as usize).map_or(Wants::default(), |m| m.wants()),
            material => material.wants(),
        };
        wants.point |= self.reliefs[index as usize].is_some();
        self.wants[index as usize] = wants;
        self.vary = self.wants.iter().any(|w| w.point);
        let material = &self.list[index as usize];
        self.interiors.note(index, material.interior().copied());
        self.made_of.resize(self.list.len(), false);
        self.may_pass.resize(self.list.len(), false);
        self.made_of[index as usize] = !material.parts().is_empty();
        self.may_pass[index as usize] = material.opacity().is_some();
        self.any_made_of |= self.made_of[index as usize];
        self.any_may_pass |= self.may_pass[index as usize];
    }

    /// When all are there, hands on what is known of parts to what is made of them, up to [`DEEPEST`].
    pub fn settle(&mut self) {
        for round in 0..=DEEPEST {
            let mut settled = true;
            for i in 0..self.list.len() {
                for &part in self.list[i].parts() {
                    let Some(&theirs) = self.wants.get(part as usize) else { continue };
                    let mine = self.wants[i];
                    let both =
                        Wants { point: mine.point | theirs.point, tangent: mine.tangent | theirs.tangent };
                    // One that has none pretends what the first of its parts does that has one.
                    let relief = self.reliefs[i].or(self.reliefs[part as usize]);
                    settled &= relief.is_some() == self.reliefs[i].is_some();
                    self.reliefs[i] = relief;
                    let pass = self.may_pass[i] | self.may_pass[part as usize];
                    settled &= both == mine && pass == self.may_pass[i];
                    (self.wants[i], self.may_pass[i]) = (both, pass);
                }
            }
            if settled && round > 0 {
                break;
            }
        }
        self.vary = self.wants.iter().any(|w| w.point);
        self.any_may_pass = self.may_pass.contains(&true);
    }

    /// Whether material `index` is made of others, one of which it is by chance or by side.
    #[inline]
    pub fn is_made_of_others(&self, index: u32) -> bool {
        self.made_of.get(index as usize).copied().unwrap_or(false)
    }

    /// Whether any is.
    #[inline(always)]
    pub fn choose(&self) -> bool {
        self.any_made_of
    }

    /// Whether light may pass through material `index` as if nothing were there.
    #[inline]
    pub fn may_pass(&self, index: u32) -> bool {
        self.may_pass.get(index as usize).copied().unwrap_or(false)
    }

    /// Whether it may through any.
    #[inline(always)]
    pub fn any_may_pass(&self) -> bool {
        self.any_may_pass
    }

    /// The opacity of a material that is a mask over one that isn't; `None` where all light meets it. Validation has seen that no mask
    /// is a part of something else where this is asked.
    pub(crate) fn plain_opacity(&self, index: u32) -> Option<Value<f32>> {
        match self.list.get(index as usize) {
            Some(Material::Mask(mask)) => mask.opacity(),
            _ => None,
        }
    }

    /// The share of light that meets material `index`.
    pub fn opacity<L: Lanes>(
        &self,
        index: u32,
        at: &ShadingPoint,
        reading: &Reading<'_, L>,
        in_front: bool,
    ) -> f32 {
        self.opacity_within(index, (at, in_front), reading, DEEPEST)
    }

    fn opacity_within<L: Lanes>(
        &self,
        index: u32,
        (at, in_front): (&ShadingPoint, bool),
        reading: &Reading<'_, L>,
        levels: usize,
    ) -> f32 {
        let Some(material) = self.list.get(index as usize).filter(|_| self.may_pass(index) && levels > 0)
        else {
            return 1.0;
        };
        let own = material.opacity().map_or(1.0, |o| ops::clamp(reading.eval(&o, at), 0.0, 1.0));
        let of = |part| self.opacity_within(part, (at, in_front), reading, levels - 1);
        match material.choice(at, reading, in_front) {
            Choice::Itself => own,
            Choice::One(part) => own * of(part),
            Choice::Two([a, b], weight) => {
                let (a, b) = (of(a), of(b));
                own * (a + ops::clamp(weight, 0.0, 1.0) * (b - a))
            }
        }
    }

    /// The material that `index` is at a point for what meets it: itself, or one of those that it is made of, by a number in [0, 1).
    pub fn chosen<L: Lanes>(
        &self,
        mut index: u32,
        (at, in_front): (&ShadingPoint, bool),
        reading: &Reading<'_, L>,
        mut u: f32,
    ) -> u32 {
        for _ in 0..=DEEPEST {
            let Some(material) = self.list.get(index as usize) else { return index };
            index = match material.choice(at, reading, in_front) {
                Choice::Itself => return index,
                Choice::One(part) => part,
                Choice::Two([a, b], weight) => {
                    let mut second = ops::clamp(weight, 0.0, 1.0);
                    if self.may_pass(index) {
                        // Given that it is met at all.
                        let [of_a, of_b] = [a, b].map(|part| self.opacity(part, at, reading, in_front));
                        let met = second * of_b;
                        let all = met + (1.0 - second) * of_a;
                        second = if all > 0.0 { met / all } else { second };
                    }
                    // What is left of the number is even again.
                    let (part, rest) =
                        if u < second { (b, u / second) } else { (a, (u - second) / (1.0 - second)) };
                    u = ops::clamp(rest, 0.0, 1.0 - f32::EPSILON / 2.0);
                    part
                }
            };
        }
        index
    }

    /// The colour of material `index` at a point, as [`Bsdf::albedo`], of what meets it.
    pub fn albedo<L: Lanes>(
        &self,
        index: u32,
        (at, in_front): (&ShadingPoint, bool),
        reading: &Reading<'_, L>,
    ) -> Light {
        self.albedo_within(index, (at, in_front), reading, DEEPEST)
    }

    fn albedo_within<L: Lanes>(
        &self,
        index: u32,
        (at, in_front): (&ShadingPoint, bool),
        reading: &Reading<'_, L>,
        levels: usize,
    ) -> Light {
        let choice = self.list.get(index as usize).map(|m| m.choice(at, reading, in_front));
        let of = |part| self.albedo_within(part, (at, in_front), reading, levels - 1);
        match choice.filter(|_| levels > 0) {
            Some(Choice::One(part)) => of(part),
            Some(Choice::Two([a, b], weight)) => of(a) * (1.0 - weight) + of(b) * weight,
            Some(Choice::Itself) | None => self.bsdf(index, at, reading).albedo(),
        }
    }

    /// What they are filled with.
    #[inline(always)]
    pub fn interiors(&self) -> &Interiors {
        &self.interiors
    }

    /// How many.
    #[inline]
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Those in the list.
    pub fn iter(&self) -> std::slice::Iter<'_, Material> {
        self.list.iter()
    }

    /// Material `index`.
    pub fn get(&self, index: usize) -> Option<&Material> {
        self.list.get(index)
    }

    /// Whether any differs from point to point.
    #[inline(always)]
    pub fn vary(&self) -> bool {
        self.vary
    }

    /// What material `index` must know of a point.
    pub fn wants(&self, index: u32) -> Wants {
        self.wants.get(index as usize).copied().unwrap_or_default()
    }

    /// How material `index` scatters at a point. Black when there is no such material.
    #[inline]
    pub fn bsdf<'w, L: Lanes>(&'w self, index: u32, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let found = match self.list.get(index as usize) {
            Some(Material::Custom(i)) => self.custom.get(*i as usize).map(|m| m.bsdf(at, reading)),
            Some(material) => material.bsdf(at, reading),
            None => None,
        };
        found.unwrap_or(Bsdf::Black(Black))
    }
}

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
