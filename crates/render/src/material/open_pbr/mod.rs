//! # OpenPBR
//!
//! The uber material of the Academy Software Foundation's specification (OpenPBR Surface 1.1): plastic, glass, metal, lacquer, cloth and what lies between,
//! by one set of parameters under the specification's names.
//!
//! From the outside in there are a *fuzz* of fibres, a *coat* of clear lacquer that may absorb, and a *base*: a part `base_metalness` of it is metal, of the
//! rest a part `transmission_weight` is glass, and what is left diffuse under a glossy surface, in the colour of the base or, in part, of
//! what lies beneath the surface. A *thin film* may lie on the base. Where the specification leaves things open, and where it is vague, this is
//! Adobe's OpenPBR BSDF (github adobe/openpbr-bsdf, commit a29da969), whose values are met: within 1 % with the tables that are worked out here.
//!
//! | lobe | energy | reciprocity |
//! |---|---|---|
//! | diffuse (EON under a glossy surface) | white keeps all, within the error of a polynomial (0.1 %); under a black base what bounces between facets is lost | holds |
//! | metal | what bounces between facets is given back, coloured twice | holds |
//! | glass, reflected and refracted | kept, within 0.4 % (3 % along the surface where indices match) | holds, but for the part that bounces between facets and passes, which ignores the square of the index |
//! | thin wall | kept | reflected: by the facet's angle, and where light passes by that of the viewer: doesn't hold |
//! | coat | white keeps all for each direction to the viewer | doesn't hold: what the coat reflects is taken from the base on the viewer's side alone |
//! | fuzz | as the coat | doesn't hold: its fit depends on the direction to the viewer |
//!
//! Coat and fuzz can't have both: with `reciprocal: true` both sides are taken into account, which is reciprocal (but for the fuzz itself), and
//! makes a white base up to 15 % darker. A light path sees the adjoint, f with the directions exchanged, so that a picture is the same from either end.
//!
//! Approximated, until there are media: what is beneath the surface (`subsurface_*`) is diffuse in `subsurface_color`; in a body with a `transmission_depth` what
//! would be scattered is absorbed as well, so that light has `transmission_color` after that way; [`Interior`] is what a medium will be told. Facets smoother
//! than alpha 10^-4 are mirrors (delta lobes), not narrow lobes.

use straal_color::Light;
use straal_math::simd::{Float, Mask};
use straal_math::{Vec3, ops};
use straal_scene::desc;

use super::film;
use super::interior::Absorption;
use super::many::{self, These};
use super::microfacet::Facets;
use super::{Bsdf, BsdfSample, Emission, Recipe, Scatter, Transport, Wants};
use crate::lanes::{Carried, Colour, Lanes};
use crate::paint::Paint;
use crate::relief::{Brushing, CoatNormals};
use crate::texture::{Reading, ShadingPoint, Value};

pub mod energy;
mod fuzz;
pub(super) mod interface;
mod interior;
mod layers;
mod params;
mod record;
mod scatter;
#[cfg(test)]
mod tests;

pub use interior::Interior;
use layers::Layers;
use params::LINES;
pub(super) use params::Params;
use record::Record;
use scatter::Drawn;

/// GGX facets of alpha along the tangent and across it.
#[inline(always)]
pub(super) fn ggx<F: Float>([along, across]: [F; 2]) -> Facets<F> {
    let least = F::splat(params::SMOOTH);
    Facets::of_lanes([along.max(least), across.max(least)], F::Mask::splat(false))
}

/// The wavelengths of a path's lanes in nm, and whether a refraction has parted them.
pub(super) fn nanometres<L: Lanes>(lanes: L) -> (Light, bool) {
    match lanes.carried() {
        Carried::All => (Light(LINES), false),
        Carried::One(nm) => (Light([nm; 4]), true),
        Carried::Four(nm) => (Light(nm), false),
    }
}

/// How much of a film of some nm there is.
pub(super) fn film_presence(weight: f32, thickness: f32) -> f32 {
    weight * film::fades(thickness)
}

/// Whether any number of any lane is above 0.
#[inline(always)]
fn is_any<F: Float>(light: Light<F>) -> bool {
    light.max_lane().gt(F::ZERO).any()
}

/// Between which indices of refraction are kept that are textures, whatever these have: as the scene language has it.
const INDICES: [f32; 2] = [0.1, 5.0];

/// The parameters of OpenPBR, by the specification's names.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // the specification's names tell what they are
pub struct OpenPbrMaterial {
    pub base_weight: Value<f32>,
    pub base_color: Value<Colour>,
    pub base_diffuse_roughness: Value<f32>,
    pub base_metalness: Value<f32>,
    pub specular_weight: Value<f32>,
    pub specular_color: Value<Colour>,
    pub specular_roughness: Value<f32>,
    pub specular_roughness_anisotropy: Value<f32>,
    pub specular_ior: Value<f32>,
    pub transmission_weight: Value<f32>,
    pub transmission_color: Value<Colour>,
    pub transmission_depth: Value<f32>,
    pub transmission_scatter: Value<Colour>,
    pub transmission_scatter_anisotropy: Value<f32>,
    pub transmission_dispersion_scale: Value<f32>,
    pub transmission_dispersion_abbe_number: Value<f32>,
    pub subsurface_weight: Value<f32>,
    pub subsurface_color: Value<Colour>,
    pub subsurface_radius: Value<f32>,
    pub subsurface_radius_scale: Value<Colour>,
    pub subsurface_scatter_anisotropy: Value<f32>,
    pub coat_weight: Value<f32>,
    pub coat_color: Value<Colour>,
    pub coat_roughness: Value<f32>,
    pub coat_roughness_anisotropy: Value<f32>,
    pub coat_ior: Value<f32>,
    pub coat_darkening: Value<f32>,
    pub fuzz_weight: Value<f32>,
    pub fuzz_color: Value<Colour>,
    pub fuzz_roughness: Value<f32>,
    pub thin_film_weight: Value<f32>,
    /// In micrometres.
    pub thin_film_thickness: Value<f32>,
    pub thin_film_ior: Value<f32>,
    /// What it sends out, and what that is to be multiplied by.
    pub emission_color: Value<Colour>,
    pub emission_luminance: Value<f32>,
    pub geometry_opacity: Value<f32>,
    pub geometry_thin_walled: bool,
    pub geometry_coat_normal: CoatNormals,
    /// Along which base and coat are rougher.
    pub brushing: Brushing,
    /// What dims light on its way through a body of it.
    pub filling: Option<super::Interior>,
    /// Coat and fuzz take away what they reflect on both sides: reciprocal, and darker.
    pub reciprocal: bool,
    /// Whether the back of what is opaque looks like the front; else it is black.
    pub two_sided: bool,
}

impl OpenPbrMaterial {
    fn numbers(&self) -> [&Value<f32>; 24] {
        [
            &self.base_weight,
            &self.base_diffuse_roughness,
            &self.base_metalness,
            &self.specular_weight,
            &self.specular_roughness,
            &self.specular_roughness_anisotropy,
            &self.specular_ior,
            &self.transmission_weight,
            &self.transmission_depth,
            &self.transmission_dispersion_scale,
            &self.transmission_dispersion_abbe_number,
            &self.subsurface_weight,
            &self.subsurface_scatter_anisotropy,
            &self.coat_weight,
            &self.coat_roughness,
            &self.coat_roughness_anisotropy,
            &self.coat_ior,
            &self.coat_darkening,
            &self.fuzz_weight,
            &self.fuzz_roughness,
            &self.thin_film_weight,
            &self.thin_film_thickness,
            &self.thin_film_ior,
            &self.transmission_scatter_anisotropy,
        ]
    }

    /// Whether the coat has a normal of its own.
    fn leans(&self) -> bool {
        self.coat_weight.most() > 0.0 && self.geometry_coat_normal != CoatNormals::Base
    }

    /// Whether it asks the point for directions other than the tangent and the normal.
    fn is_turned(&self) -> bool {
        self.leans() || self.brushing != Brushing::STRAIGHT
    }

    fn colours(&self) -> [&Value<Colour>; 6] {
        [
            &self.base_color,
            &self.specular_color,
            &self.transmission_color,
            &self.subsurface_color,
            &self.coat_color,
            &self.fuzz_color,
        ]
    }

    /// The numbers at a point.
    fn params<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> Params<f32> {
        let number = |v: &Value<f32>| reading.eval(v, at);
        let tint = |v: &Value<Colour>| reading.eval(v, at);
        let thin = self.geometry_thin_walled;
        // Beyond a depth light is coloured on its way, not where it enters.
        let is_tinted = thin || number(&self.transmission_depth) <= 0.0;
        let abbe = number(&self.transmission_dispersion_abbe_number);
        let scale = number(&self.transmission_dispersion_scale);
        let thickness = number(&self.thin_film_thickness) * 1000.0;
        let (nm, parted) = nanometres(reading.lanes);
        let params = Params {
            along: [1.0, 0.0],
            coat_normal: Vec3::Z,
            turned: false,
            leans: false,
            base: reading.eval(&self.base_color, at) * number(&self.base_weight),
            specular: tint(&self.specular_color),
            transmission: if is_tinted { tint(&self.transmission_color) } else { Light::ONE },
            subsurface: tint(&self.subsurface_color),
            coat: tint(&self.coat_color),
            fuzz: tint(&self.fuzz_color),
            nm,
            metalness: number(&self.base_metalness),
            specular_weight: number(&self.specular_weight),
            transmission_weight: number(&self.transmission_weight),
            subsurface_weight: number(&self.subsurface_weight),
            coat_weight: number(&self.coat_weight),
            fuzz_weight: number(&self.fuzz_weight),
            film_presence: film_presence(number(&self.thin_film_weight), thickness),
            diffuse_roughness: number(&self.base_diffuse_roughness),
            roughness: number(&self.specular_roughness),
            coat_roughness: number(&self.coat_roughness),
            fuzz_roughness: number(&self.fuzz_roughness),
            ior: number(&self.specular_ior),
            coat_ior: number(&self.coat_ior),
            film_ior: number(&self.thin_film_ior),
            film_thickness: thickness,
            dispersion: if abbe > 0.0 { 20.0 * scale / abbe } else { 0.0 },
            anisotropy: number(&self.specular_roughness_anisotropy),
            coat_anisotropy: number(&self.coat_roughness_anisotropy),
            coat_darkening: number(&self.coat_darkening),
            subsurface_anisotropy: number(&self.subsurface_scatter_anisotropy),
            thin,
            one_sided: !self.two_sided,
            rgb: reading.lanes.bins().is_none(),
            parted,
            reciprocal: self.reciprocal,
        };
        if !self.is_turned() {
            return params;
        }
        params.turned_to(self.brushing.at(at, reading), self.geometry_coat_normal.at(at, reading))
    }

    /// What dims light in a body of it, whose colour and depth are the same everywhere. What would be scattered is absorbed as well.
    fn filled(&self) -> Option<super::Interior> {
        let (Value::Constant(colour), &Value::Constant(depth)) =
            (&self.transmission_color, &self.transmission_depth)
        else {
            return None;
        };
        let eta = if let Value::Constant(eta) = self.specular_ior { Some(eta) } else { None };
        if self.geometry_thin_walled || self.transmission_weight.most() <= 0.0 {
            return None;
        }
        let absorption = if depth > 0.0 { Absorption::Colour(*colour, depth) } else { Absorption::None };
        Some(super::Interior { absorption, priority: 0, eta, outside: Some(1.0) })
    }

    /// What fills a body of it, for a medium.
    pub fn interior<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> Interior {
        Interior::of(self, at, reading)
    }
}

impl Recipe for OpenPbrMaterial {
    type Described = desc::OpenPbr;

    fn of(d: &desc::OpenPbr, paint: &mut Paint<'_>) -> Self {
        // What is the same everywhere is multiplied once.
        let (emission_color, emission_luminance) = match (&d.emission_color, &d.emission_luminance) {
            (desc::Varying::Constant(colour), desc::Varying::Constant(luminance)) => {
                (paint.emission_times(colour, *luminance).into(), 1.0.into())
            }
            (colour, luminance) => (paint.emission(colour), paint.number(luminance)),
        };
        let mut made = Self {
            emission_color,
            emission_luminance,
            base_weight: paint.number(&d.base_weight),
            base_color: paint.reflectance(&d.base_color),
            base_diffuse_roughness: paint.number(&d.base_diffuse_roughness),
            base_metalness: paint.number(&d.base_metalness),
            specular_weight: paint.number(&d.specular_weight),
            specular_color: paint.reflectance(&d.specular_color),
            specular_roughness: paint.number(&d.specular_roughness),
            specular_roughness_anisotropy: paint.number(&d.specular_roughness_anisotropy),
            specular_ior: paint.number_within(&d.specular_ior, INDICES),
            transmission_weight: paint.number(&d.transmission_weight),
            transmission_color: paint.reflectance(&d.transmission_color),
            transmission_depth: paint.number(&d.transmission_depth),
            transmission_scatter: paint.reflectance(&d.transmission_scatter),
            transmission_scatter_anisotropy: paint.number(&d.transmission_scatter_anisotropy),
            transmission_dispersion_scale: paint.number(&d.transmission_dispersion_scale),
            transmission_dispersion_abbe_number: paint.number(&d.transmission_dispersion_abbe_number),
            subsurface_weight: paint.number(&d.subsurface_weight),
            subsurface_color: paint.reflectance(&d.subsurface_color),
            subsurface_radius: paint.number(&d.subsurface_radius),
            subsurface_radius_scale: paint.reflectance(&d.subsurface_radius_scale),
            subsurface_scatter_anisotropy: paint.number(&d.subsurface_scatter_anisotropy),
            coat_weight: paint.number(&d.coat_weight),
            coat_color: paint.reflectance(&d.coat_color),
            coat_roughness: paint.number(&d.coat_roughness),
            coat_roughness_anisotropy: paint.number(&d.coat_roughness_anisotropy),
            coat_ior: paint.number_within(&d.coat_ior, INDICES),
            coat_darkening: paint.number(&d.coat_darkening),
            fuzz_weight: paint.number(&d.fuzz_weight),
            fuzz_color: paint.reflectance(&d.fuzz_color),
            fuzz_roughness: paint.number(&d.fuzz_roughness),
            thin_film_weight: paint.number(&d.thin_film_weight),
            thin_film_thickness: paint.number(&d.thin_film_thickness),
            thin_film_ior: paint.number_within(&d.thin_film_ior, INDICES),
            geometry_opacity: paint.number(&d.geometry_opacity),
            geometry_thin_walled: d.geometry_thin_walled,
            geometry_coat_normal: CoatNormals::of(&d.geometry_coat_normal, paint),
            brushing: Brushing::of(d.geometry_tangent.as_ref(), &d.geometry_tangent_rotation, paint),
            filling: None,
            reciprocal: d.reciprocal,
            two_sided: d.two_sided,
        };
        made.filling = made.filled();
        made
    }

    fn interior(&self) -> Option<&super::Interior> {
        self.filling.as_ref()
    }

    fn opacity(&self) -> Option<Value<f32>> {
        (self.geometry_opacity != Value::Constant(1.0)).then_some(self.geometry_opacity)
    }

    fn emission(&self) -> Option<Emission> {
        let most = self.emission_luminance.most();
        (most > 0.0 && self.emission_color.most() > 0.0).then_some(Emission {
            radiance: self.emission_color,
            most,
            both_sides: self.geometry_thin_walled,
        })
    }

    fn lets_out<L: Lanes>(&self, cos: f32, at: &ShadingPoint, reading: &Reading<'_, L>) -> Light {
        let luminance = reading.eval(&self.emission_luminance, at);
        OpenPbr::new(&self.params(at, reading)).lets_out(cos) * luminance
    }

    fn wants(&self) -> Wants {
        let varies = self.numbers().iter().any(|v| v.varies())
            || self.colours().iter().any(|v| v.varies())
            || self.geometry_opacity.varies();
        let tangent = self.specular_roughness_anisotropy.most() > 0.0
            || (self.coat_weight.most() > 0.0 && self.coat_roughness_anisotropy.most() > 0.0)
            || self.leans();
        Wants { point: varies || tangent, tangent }
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        Bsdf::OpenPbr(OpenPbr::new(&self.params(at, reading)))
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        vec![(tests::material(), super::BsdfKind::OpenPbr)]
    }
}

/// The layers of [`OpenPbrMaterial`] at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenPbr(Record);

impl OpenPbr {
    pub(super) fn new(params: &Params<f32>) -> Self {
        Self(Record::pack(params))
    }

    /// What coat and fuzz leave of light that is sent out below them, at a cosine.
    pub(super) fn lets_out(&self, cos: f32) -> Light {
        let sin = ops::max((1.0 - cos) * (1.0 + cos), 0.0).sqrt();
        self.layers(Vec3::new(sin, 0.0, cos)).lets_out()
    }

    fn layers(&self, wo: Vec3) -> Layers<f32> {
        Layers::new(self.0.one(), wo)
    }

    /// The adjoint: f with the directions exchanged, which is what light paths see.
    fn adjoint(&self, wo: Vec3, wi: Vec3) -> Light {
        let (back, _) = self.layers(wi).eval(wo);
        back * (wi.z / wo.z).abs()
    }
}

/// Those of many side by side, by their numbers.
#[inline(always)]
fn gathered<F: Float>(these: impl These<OpenPbr>) -> Params<F> {
    Record::unpack(
        #[inline(always)]
        |i| &these.of(i).0,
    )
}

/// The value of radiance and the density, nothing where there are no numbers.
#[inline(always)]
fn value<F: Float>(layers: &Layers<F>, wi: Vec3<F>) -> (Light<F>, F) {
    let (value, pdf) = layers.eval(wi);
    let is_fine = value.is_finite() & pdf.ge(F::ZERO) & pdf.is_finite();
    (value.only(is_fine), F::select(is_fine, pdf, F::ZERO))
}

/// A draw as a sample, and whether it is one of value.
#[inline(always)]
fn sample<F: Float>(layers: &Layers<F>, u: [F; 3]) -> (BsdfSample<F>, F::Mask) {
    let drawn: Drawn<F> = layers.draw(u[0], [u[1], u[2]]);
    let (value, pdf) = value(layers, drawn.wi);
    let pdf = F::select(drawn.delta, drawn.chance, pdf);
    let weight = Light::select(drawn.delta, drawn.weight, value * (F::ONE / pdf));
    let there = drawn.any & drawn.wi.z.ne(F::ZERO) & pdf.gt(F::ZERO) & weight.is_finite();
    let sample = BsdfSample {
        wi: drawn.wi,
        weight,
        pdf,
        delta: drawn.delta,
        transmitted: drawn.transmitted,
        eta: F::select(drawn.transmitted, layers.bends(), F::ONE),
        wavelength: drawn.nm,
    };
    (sample, there)
}

impl Scatter for OpenPbr {
    const CHOOSES_LOBE: bool = true;

    const SIDE_BY_SIDE: bool = true;

    const TRANSMITS: bool = true;

    fn is_delta(&self) -> bool {
        self.0.one().is_delta()
    }

    #[inline]
    fn transmits(&self) -> bool {
        self.0.transmits()
    }

    fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Light, f32) {
        let (radiance, pdf) = value(&self.layers(wo), wi);
        match transport {
            Transport::Radiance => (radiance, pdf),
            Transport::Importance if pdf > 0.0 => (self.adjoint(wo, wi), pdf),
            Transport::Importance => (Light::ZERO, 0.0),
        }
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, [u, v]: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        let layers = self.layers(wo);
        let (mut sample, there) = sample(&layers, [u_lobe, u, v]);
        if transport == Transport::Importance && there {
            if !sample.delta {
                sample.weight = self.adjoint(wo, sample.wi) * (1.0 / sample.pdf);
            } else if !sample.transmitted {
                // A coat that leans is a mirror about another normal.
                sample.weight *= (sample.wi.z / wo.z).abs();
            } else {
                // The way back of the radiance that comes from there; lanes that have ended stay so.
                let back = self
                    .layers(sample.wi)
                    .passes()
                    .zip(layers.passes(), |back, here| if here > 0.0 { back / here } else { 0.0 });
                sample.weight = sample.weight * back * (sample.eta * sample.eta);
            }
        }
        (there && sample.weight.is_finite()).then_some(sample)
    }

    #[inline(always)]
    fn eval_pdf_many<F: Float>(
        these: impl These<Self>,
        pair: [Vec3<F>; 2],
        transport: Transport,
    ) -> (Light<F>, F) {
        if transport == Transport::Importance {
            return many::eval_pdf_one_by_one(these, pair, transport);
        }
        value(&Layers::new(gathered(these), pair[0]), pair[1])
    }

    #[inline(always)]
    fn sample_many<F: Float>(
        these: impl These<Self>,
        wo: Vec3<F>,
        u: [F; 3],
        transport: Transport,
    ) -> (BsdfSample<F>, F::Mask) {
        if transport == Transport::Importance {
            return many::sample_one_by_one(these, wo, u, transport);
        }
        sample(&Layers::new(gathered(these), wo), u)
    }

    fn albedo(&self) -> Light {
        self.0.one().colour()
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        tests::examples()
    }
}
