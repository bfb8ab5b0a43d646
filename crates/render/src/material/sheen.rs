//! # Sheen
//!
//! Cloth: fibres that stand off a ground light up at grazing angles. The sheen is that of Estevez and Kulla (2017, "Production Friendly Microfacet Sheen BRDF"): facets
//! spread as a power of the sine, D = (2 + 1/r) sin^(1/r) / 2 pi, with their fit of the shadowing, G = 1 / (1 + L(o) + L(i)), so that f_s = D G / (4 cos cos). What
//! it sends back, E, is taken from the evenly scattering ground:
//!
//! f = s f_s + rho / pi (1 - m E(o)) (1 - m E(i)) / (1 - m E), with s the sheen's colour, m its strongest lane and the last E the mean of E over even light.
//!
//! Energy is conserved, all of it where both are white (within 1 %, by the table of E); reciprocity holds.

use std::f32::consts::{FRAC_1_PI, TAU};
use std::sync::LazyLock;

use straal_color::Light;
use straal_math::{Vec3, ops, warp};
use straal_scene::desc;

use super::energy::{self, Shares};
use super::{Bsdf, BsdfSample, Recipe, Scatter, Transport, Wants, facing};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// Cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheenMaterial {
    /// Share of light that the ground reflects.
    pub reflectance: Value<Colour>,
    /// Colour of the sheen.
    pub color: Value<Colour>,
    /// How far it reaches from the rim.
    pub roughness: Value<f32>,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Recipe for SheenMaterial {
    type Described = desc::Sheen;

    fn of(d: &desc::Sheen, paint: &mut Paint<'_>) -> Self {
        Self {
            reflectance: paint.reflectance(&d.reflectance),
            color: paint.reflectance(&d.color),
            roughness: paint.number(&d.roughness),
            two_sided: d.two_sided,
        }
    }

    fn wants(&self) -> Wants {
        Wants::point(self.reflectance.varies() || self.color.varies() || self.roughness.varies())
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        Bsdf::Sheen(Sheen {
            ground: reading.eval(&self.reflectance, at),
            color: reading.eval(&self.color, at),
            roughness: ops::clamp(reading.eval(&self.roughness, at), LEAST, 1.0),
            two_sided: self.two_sided,
        })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let white: Value<Colour> = super::testing::WHITE.into();
        let velvet = Self { reflectance: white, color: white, roughness: 0.4.into(), two_sided: true };
        vec![(velvet, super::BsdfKind::Sheen)]
    }
}

/// Below it a sheen is a line at the rim.
const LEAST: f32 = 0.05;

/// Cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    /// Share of light that the ground reflects.
    pub ground: Light,
    /// Colour of the sheen.
    pub color: Light,
    /// How far it reaches from the rim, from 0.05 to 1.
    pub roughness: f32,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

/// What a white sheen sends back.
fn sent_back() -> &'static Shares {
    static TABLE: LazyLock<Shares> = LazyLock::new(|| {
        energy::table(|roughness, cos| {
            const SIDE: u32 = 24;
            let r = ops::max(roughness, LEAST);
            let wo = Vec3::new(ops::max(1.0 - cos * cos, 0.0).sqrt(), 0.0, cos);
            let mut sum = 0.0;
            for i in 0..SIDE * SIDE {
                let u = [i % SIDE, i / SIDE].map(|k| (k as f32 + 0.5) / SIDE as f32);
                let wi = warp::uniform_hemisphere(u);
                sum += lobe(r, wo, wi) * TAU;
            }
            ops::clamp(sum / (SIDE * SIDE) as f32, 0.0, 1.0)
        })
    });
    &TABLE
}

/// f |cos| of the sheen, for directions above the surface.
fn lobe(roughness: f32, wo: Vec3, wi: Vec3) -> f32 {
    let h = wo + wi;
    let hh = h.length_squared();
    if wi.z <= 0.0 || wo.z <= 0.0 || hh <= f32::MIN_POSITIVE {
        return 0.0;
    }
    let inverse = 1.0 / roughness;
    // Sine of the half-way direction; a power of its square.
    let sine2 = ops::clamp((h.x * h.x + h.y * h.y) / hh, 0.0, 1.0);
    let density = (2.0 + inverse) / TAU * ops::pow(ops::max(sine2, 1e-12), 0.5 * inverse);
    let shadow = 1.0 / (1.0 + hidden(roughness, wo.z) + hidden(roughness, wi.z));
    density * shadow / (4.0 * wo.z)
}

/// The fit of Smith's Lambda (Estevez and Kulla, section 3, table 1).
fn hidden(roughness: f32, cos: f32) -> f32 {
    const ROUGH: [f32; 5] = [21.5473, 3.829_87, 0.198_23, -1.977_6, -4.320_54];
    const SMOOTH: [f32; 5] = [25.3245, 3.324_35, 0.168_01, -1.273_93, -4.859_67];
    let t = (1.0 - roughness) * (1.0 - roughness);
    let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|i: usize| t * SMOOTH[i] + (1.0 - t) * ROUGH[i]);
    let curve = |x: f32| a / (1.0 + b * ops::pow(x, c)) + d * x + e;
    if cos < 0.5 {
        ops::exp(curve(ops::max(cos, 1e-6)))
    } else {
        ops::exp(2.0 * curve(0.5) - curve(ops::max(1.0 - cos, 1e-6)))
    }
}

impl Sheen {
    /// What the ground gets of light at a cosine.
    fn rest(&self, cos: f32) -> f32 {
        1.0 - self.color.max_lane() * sent_back().at(self.roughness, cos)
    }

    /// The chance of the sheen's lobe.
    fn chance(&self, cos: f32) -> f32 {
        let sheen = 1.0 - self.rest(cos);
        let ground = self.ground.max_lane() * (1.0 - sheen);
        if sheen > 0.0 { sheen / (sheen + ground) } else { 0.0 }
    }

    fn on_front(&self, wo: Vec3, wi: Vec3) -> (Light, f32) {
        if wi.z <= 0.0 {
            return (Light::ZERO, 0.0);
        }
        let mean = 1.0 - self.color.max_lane() * sent_back().of_all_directions(self.roughness);
        let below = self.rest(wo.z) * self.rest(wi.z) / ops::max(mean, 1e-3);
        let even = wi.z * FRAC_1_PI;
        let value = self.color * lobe(self.roughness, wo, wi) + self.ground * (below * even);
        let chance = self.chance(wo.z);
        (value, chance / TAU + (1.0 - chance) * even)
    }
}

impl Scatter for Sheen {
    const CHOOSES_LOBE: bool = true;

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Light, f32) {
        let Some(side) = facing(wo, self.two_sided) else { return (Light::ZERO, 0.0) };
        let [wo, wi] = [wo, wi].map(|w| Vec3::new(w.x, w.y, side * w.z));
        self.on_front(wo, wi)
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        let side = facing(wo, self.two_sided)?;
        let d = if u_lobe < self.chance(wo.z.abs()) {
            warp::uniform_hemisphere(u)
        } else {
            warp::cosine_hemisphere(u)
        };
        let wi = Vec3::new(d.x, d.y, side * d.z);
        let (value, pdf) = self.eval_pdf(wo, wi, transport);
        let weight = value * (1.0 / pdf);
        (pdf > 0.0 && weight.is_finite()).then_some(BsdfSample { wi, weight, pdf, ..BsdfSample::REFLECTED })
    }

    fn albedo(&self) -> Light {
        let sheen = sent_back().at(self.roughness, 1.0);
        self.color * sheen + self.ground * self.rest(1.0)
    }

    fn ambient(&self) -> Light {
        self.ground
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE};
        let of = |name, ground, color, roughness| {
            Example::new(name, Bsdf::Sheen(Self { ground, color, roughness, two_sided: true }))
        };
        let velvet = of("velvet", Light::rgb([0.2, 0.02, 0.05]), Light::rgb([0.8, 0.3, 0.4]), 0.3);
        vec![velvet, of("white cloth", WHITE, WHITE, 0.6).nearly_energy(0.02)]
    }
}
