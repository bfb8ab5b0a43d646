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
use straal_math::simd::Float;
use straal_math::{Vec3, ops, warp};
use straal_scene::desc;

use super::energy::{self, Shares};
use super::many::{self, Lobe, These, is_lobe};
use super::{Bsdf, BsdfSample, Recipe, Scatter, Transport, Wants, facing_or_zero};
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
#[inline(always)]
fn lobe<F: Float>(roughness: F, wo: Vec3<F>, wi: Vec3<F>) -> F {
    let h = wo + wi;
    let hh = h.length_squared();
    let there = wi.z.gt(F::ZERO) & wo.z.gt(F::ZERO) & hh.gt(F::splat(f32::MIN_POSITIVE));
    let inverse = F::ONE / roughness;
    // Sine of the half-way direction; a power of its square.
    let sine2 = ops::clamp((h.x * h.x + h.y * h.y) / hh, F::ZERO, F::ONE);
    let density = (inverse + 2.0) / F::splat(TAU) * ops::pow(ops::max(sine2, F::splat(1e-12)), inverse * 0.5);
    let shadow = F::ONE / (hidden(roughness, wo.z) + 1.0 + hidden(roughness, wi.z));
    F::select(there, density * shadow / (wo.z * 4.0), F::ZERO)
}

/// The fit of Smith's Lambda (Estevez and Kulla, section 3, table 1).
#[inline(always)]
fn hidden<F: Float>(roughness: F, cos: F) -> F {
    const ROUGH: [f32; 5] = [21.5473, 3.829_87, 0.198_23, -1.977_6, -4.320_54];
    const SMOOTH: [f32; 5] = [25.3245, 3.324_35, 0.168_01, -1.273_93, -4.859_67];
    let t = (F::ONE - roughness) * (F::ONE - roughness);
    let fit = [0, 1, 2, 3, 4].map(
        #[inline(always)]
        |i: usize| t * SMOOTH[i] + (F::ONE - t) * ROUGH[i],
    );
    // The fit is for the lower half; the upper is its mirror image.
    let low = cos.lt(F::splat(0.5));
    let least = F::splat(1e-6);
    let at = curve(fit, F::select(low, ops::max(cos, least), ops::max(F::ONE - cos, least)));
    ops::exp(F::select(low, at, curve(fit, F::splat(0.5)) * 2.0 - at))
}

#[inline(always)]
fn curve<F: Float>([a, b, c, d, e]: [F; 5], x: F) -> F {
    a / (b * ops::pow(x, c) + 1.0) + d * x + e
}

/// Cloth, or many side by side.
#[derive(Clone, Copy)]
struct Cloth<F: Float> {
    ground: Light<F>,
    color: Light<F>,
    roughness: F,
    two_sided: F::Mask,
}

impl<F: Float> Cloth<F> {
    /// What the ground gets of light at a cosine.
    #[inline(always)]
    fn rest(&self, cos: F) -> F {
        F::ONE - self.color.max_lane() * sent_back().at(self.roughness, cos)
    }

    /// The chance of the sheen's lobe, by what the ground gets.
    #[inline(always)]
    fn chance(&self, rest: F) -> F {
        let sheen = F::ONE - rest;
        let ground = self.ground.max_lane() * (F::ONE - sheen);
        F::select(sheen.gt(F::ZERO), sheen / (sheen + ground), F::ZERO)
    }

    #[inline(always)]
    fn on_front(&self, wo: Vec3<F>, wi: Vec3<F>) -> (Light<F>, F) {
        let there = wi.z.gt(F::ZERO);
        let mean = F::ONE - self.color.max_lane() * sent_back().of_all_directions(self.roughness);
        let rest = self.rest(wo.z);
        let below = rest * self.rest(wi.z) / ops::max(mean, F::splat(1e-3));
        let even = wi.z * FRAC_1_PI;
        let value = self.color * lobe(self.roughness, wo, wi) + self.ground * (below * even);
        let chance = self.chance(rest);
        let pdf = chance / F::splat(TAU) + (F::ONE - chance) * even;
        (value.only(there), F::select(there, pdf, F::ZERO))
    }
}

impl<F: Float> Lobe<F> for Cloth<F> {
    type One = Sheen;

    #[inline(always)]
    fn gather(these: impl These<Sheen>) -> Self {
        Self {
            ground: many::light(these, |s: &Sheen| s.ground),
            color: many::light(these, |s: &Sheen| s.color),
            roughness: many::each(these, |s: &Sheen| s.roughness),
            two_sided: many::which::<_, F>(these, |s: &Sheen| s.two_sided),
        }
    }

    #[inline(always)]
    fn eval_pdf(&self, wo: Vec3<F>, wi: Vec3<F>, _: Transport) -> (Light<F>, F) {
        // In a function of its own, as it is asked in several places.
        F::vectorize(
            #[inline(always)]
            || {
                let side = facing_or_zero(wo, self.two_sided);
                let seen = side.ne(F::ZERO);
                let [wo, wi] = [wo, wi].map(|w| Vec3::new(w.x, w.y, side * w.z));
                let (value, pdf) = self.on_front(wo, wi);
                (value.only(seen), F::select(seen, pdf, F::ZERO))
            },
        )
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, u_lobe: F, u: [F; 2], transport: Transport) -> (BsdfSample<F>, F::Mask) {
        let side = facing_or_zero(wo, self.two_sided);
        let by_sheen = u_lobe.lt(self.chance(self.rest(wo.z.abs())));
        let d = Vec3::select(by_sheen, warp::uniform_hemisphere(u), warp::cosine_hemisphere(u));
        let wi = Vec3::new(d.x, d.y, side * d.z);
        let (value, pdf) = self.eval_pdf(wo, wi, transport);
        let weight = value * (F::ONE / pdf);
        let there = side.ne(F::ZERO) & pdf.gt(F::ZERO) & weight.is_finite();
        (BsdfSample::reflected(wi, weight, pdf), there)
    }
}

impl Scatter for Sheen {
    const CHOOSES_LOBE: bool = true;

    is_lobe!(Cloth);

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    fn albedo(&self) -> Light {
        let sheen = sent_back().at(self.roughness, 1.0);
        self.color * sheen + self.ground * Cloth::<f32>::gather(self).rest(1.0)
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
