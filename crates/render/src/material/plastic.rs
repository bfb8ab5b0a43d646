//! # Plastic
//!
//! An evenly scattering ground below a clear boundary: what the boundary doesn't reflect goes in, is scattered, and comes out but for what is
//! reflected back down, time and again. It is the `plastic` and `roughplastic` of Mitsuba (Jakob et al.):
//!
//! f = F / (mirrored direction) + T(wo) T(wi) rho' / (pi eta²),
//!
//! with T = 1 - F, and rho' = rho / (1 - F_in), or rho / (1 - rho F_in) where `nonlinear`; F_in is the share of even light that is reflected from within. Where
//! the boundary is rough the first term is that of microfacets, and T and F_in are what they let through and reflect ([`super::energy`]).
//!
//! (F_in of a rough boundary is Mitsuba's sum over its table, which is 2 % too small: rough plastic of a bright ground is so much darker than it
//! would be. That of a smooth one is the integral; Mitsuba has a fit that is 0.08 % larger.) Energy is conserved; a white ground below a smooth boundary sends back all light. Reciprocity holds.

use std::f32::consts::FRAC_1_PI;

use straal_color::Light;
use straal_math::simd::{Float, Mask};
use straal_math::{Vec3, ops, warp};
use straal_scene::desc;

use super::energy::{self, ByIndex, Shares};
use super::many::{self, These};
use super::microfacet::Facets;
use super::{
    Bsdf, BsdfSample, Recipe, Relative, Scatter, Transport, Wants, facing_or_zero, fresnel, mirror::reflected,
};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// An evenly scattering ground below a clear boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct PlasticMaterial {
    /// Share of light that the ground reflects.
    pub reflectance: Value<Colour>,
    /// Tint of what the boundary reflects.
    pub specular: Value<Colour>,
    /// Index of refraction inside over that outside.
    pub eta: Relative,
    /// Alpha of the boundary's facets.
    pub roughness: Value<f32>,
    /// How they are spread.
    pub distribution: desc::Distribution,
    /// Whether the ground colours light each time.
    pub nonlinear: bool,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
    /// What a rough boundary lets through from outside.
    through: ByIndex<Shares>,
    /// What is reflected from within.
    within: ByIndex<Shares>,
}

impl PlasticMaterial {
    fn tables(
        roughness: Value<f32>,
        distribution: &desc::Distribution,
        eta: Relative,
    ) -> [ByIndex<Shares>; 2] {
        let alpha = match roughness {
            Value::Constant(alpha) => Some(alpha),
            Value::Texture(_) => None,
        };
        let through = ByIndex::new(eta.constant(), |eta| energy::passed(alpha, distribution, eta));
        let within = ByIndex::new(eta.constant(), |eta| energy::sent_back(alpha, distribution, 1.0 / eta));
        [through, within]
    }
}

impl Recipe for PlasticMaterial {
    type Described = desc::Plastic;

    fn of(d: &desc::Plastic, paint: &mut Paint<'_>) -> Self {
        let eta = Relative::of(&d.eta, &d.eta_outside, paint);
        let roughness = paint.number(&d.roughness);
        let [through, within] = Self::tables(roughness, &d.distribution, eta);
        Self {
            reflectance: paint.reflectance(&d.reflectance),
            specular: paint.reflectance(&d.specular),
            eta,
            roughness,
            distribution: d.distribution.clone(),
            nonlinear: d.nonlinear,
            two_sided: d.two_sided,
            through,
            within,
        }
    }

    fn wants(&self) -> Wants {
        Wants::point(
            self.eta.varies()
                || self.reflectance.varies()
                || self.specular.varies()
                || self.roughness.varies(),
        )
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let ground = reading.eval(&self.reflectance, at);
        let alpha = ops::clamp(reading.eval(&self.roughness, at), 0.0, 1.0);
        let eta = self.eta.at(at, reading);
        let within = self.within.between(eta, |shares| match alpha > 0.0 {
            true => shares.of_all_directions_as_mitsuba(alpha),
            false => shares.of_all_directions(0.0),
        });
        let coloured = |rho: f32| rho / (1.0 - if self.nonlinear { rho * within } else { within });
        let diffuse = ground.map(coloured) * (1.0 / (eta * eta));
        let rough =
            (alpha > 0.0).then(|| (Facets::new([alpha; 2], self.distribution.clone()), &self.through));
        Bsdf::Plastic(Plastic {
            diffuse,
            specular: reading.eval(&self.specular, at),
            eta,
            rough,
            two_sided: self.two_sided,
        })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let of = |alpha: f32| {
            let (roughness, distribution) = (alpha.into(), desc::Distribution::Ggx);
            let [through, within] = Self::tables(roughness, &distribution, 1.5.into());
            let white: Value<Colour> = super::testing::WHITE.into();
            Self {
                reflectance: white,
                specular: white,
                eta: 1.5.into(),
                roughness,
                distribution,
                nonlinear: false,
                two_sided: true,
                through,
                within,
            }
        };
        vec![(of(0.0), super::BsdfKind::Plastic), (of(0.2), super::BsdfKind::Plastic)]
    }
}

/// An evenly scattering ground below a clear boundary.
#[derive(Clone, Copy, Debug)]
pub struct Plastic<'w> {
    /// The ground's reflectance with all that bounces below the boundary, over the squared index of refraction.
    pub diffuse: Light,
    /// Tint of what the boundary reflects.
    pub specular: Light,
    /// Index of refraction inside over that outside.
    pub eta: f32,
    /// The boundary's facets and what they let through, where it is rough.
    pub rough: Option<(Facets, &'w ByIndex<Shares>)>,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

/// A ground and its boundary, or many side by side.
#[derive(Clone, Copy)]
struct Covered<F: Float, T> {
    diffuse: Light<F>,
    specular: Light<F>,
    eta: F,
    facets: Facets<F>,
    rough: F::Mask,
    two_sided: F::Mask,
    these: T,
}

impl<'w, F: Float, T: These<Plastic<'w>>> Covered<F, T> {
    #[inline(always)]
    fn gather(these: T) -> Self {
        let alpha =
            |k: usize| many::each(these, |p: &Plastic<'w>| p.rough.map_or(1.0, |(f, _)| f.alphas()[k]));
        let bell =
            many::which::<_, F>(these, |p: &Plastic<'w>| p.rough.is_some_and(|(f, _)| f.are_beckmanns()));
        Self {
            diffuse: many::light(these, |p: &Plastic<'w>| p.diffuse),
            specular: many::light(these, |p: &Plastic<'w>| p.specular),
            eta: many::each(these, |p: &Plastic<'w>| p.eta),
            facets: Facets::of_lanes([alpha(0), alpha(1)], bell),
            rough: many::which::<_, F>(these, |p: &Plastic<'w>| p.rough.is_some()),
            two_sided: many::which::<_, F>(these, |p: &Plastic<'w>| p.two_sided),
            these,
        }
    }

    /// What the boundary lets through at a cosine.
    #[inline(always)]
    fn through(&self, cos: F) -> F {
        let smooth = F::ONE - fresnel::dielectric(cos, self.eta).reflected;
        if !self.rough.any() {
            return smooth;
        }
        // One material's vertices have a table in common.
        let table = |i: usize| self.these.of(i).rough.and_then(|(_, table)| table.only());
        let first = table(0);
        let is_common = |i| table(i).zip(first).is_some_and(|(a, b)| std::ptr::eq(a, b));
        if let (Some(shares), true) = (first, (1..F::WIDTH).all(is_common)) {
            return shares.at(self.facets.mean_alpha(), cos);
        }
        let rough = F::from_fn(
            #[inline(always)]
            |i| self.these.of(i).through(cos.lane(i)),
        );
        F::select(self.rough, rough, smooth)
    }

    /// The chance of the boundary's lobe.
    #[inline(always)]
    fn chance(&self, through: F) -> F {
        let reflected = self.specular.max_lane() * (F::ONE - through);
        let scattered = self.diffuse.max_lane() * through;
        F::select(reflected.gt(F::ZERO), reflected / (reflected + scattered), F::ZERO)
    }

    /// Value and density for directions above the surface, without a delta lobe, by what the boundary lets through of `wo` and the chance of its lobe.
    #[inline(always)]
    fn on_front(&self, wo: Vec3<F>, wi: Vec3<F>, [through, chance]: [F; 2]) -> (Light<F>, F) {
        let there = wi.z.gt(F::ZERO);
        let even = wi.z * FRAC_1_PI;
        let mut value = self.diffuse * (through * self.through(wi.z) * even);
        let mut pdf = (F::ONE - chance) * even;
        let h = wo + wi;
        let hh = h.length_squared();
        let glossy = there & self.rough & hh.gt(F::splat(f32::MIN_POSITIVE));
        if glossy.any() {
            let facets = self.facets;
            let share = fresnel::dielectric(wo.dot(h) / hh.sqrt(), self.eta).reflected;
            let seen = facets.density(h) * facets.seen(wo) * facets.seen(wi) / (wo.z * 4.0);
            value += (self.specular * (share * seen)).only(glossy);
            pdf += F::select(glossy, chance * facets.pdf_reflecting(wo, h), F::ZERO);
        }
        (value.only(there), F::select(there, pdf, F::ZERO))
    }

    #[inline(always)]
    fn eval_pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> (Light<F>, F) {
        let side = facing_or_zero(wo, self.two_sided);
        let seen = side.ne(F::ZERO);
        let [wo, wi] = [wo, wi].map(|w| Vec3::new(w.x, w.y, side * w.z));
        let through = self.through(wo.z);
        let (value, pdf) = self.on_front(wo, wi, [through, self.chance(through)]);
        (value.only(seen), F::select(seen, pdf, F::ZERO))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, u_lobe: F, u: [F; 2]) -> (BsdfSample<F>, F::Mask) {
        let side = facing_or_zero(wo, self.two_sided);
        let up = Vec3::new(wo.x, wo.y, side * wo.z);
        let through = self.through(up.z);
        let chance = self.chance(through);
        let (scatters, mirrors) = (u_lobe.ge(chance), u_lobe.lt(chance) & !self.rough);
        let mut wi = warp::cosine_hemisphere(u);
        if !(scatters | mirrors).all() {
            let m = self.facets.sample_reflecting(up, u);
            wi = Vec3::select(scatters, wi, m * (up.dot(m) * 2.0) - up);
        }
        let (value, pdf) = self.on_front(up, wi, [through, chance]);
        let weight = value * (F::ONE / pdf);
        let there = mirrors | pdf.gt(F::ZERO) & weight.is_finite();
        let drawn = BsdfSample::reflected(Vec3::new(wi.x, wi.y, side * wi.z), weight, pdf);
        let share = fresnel::dielectric(up.z, self.eta).reflected;
        let mirrored = reflected(wo, self.specular * (share / chance), chance);
        (BsdfSample::select(mirrors, mirrored, drawn), side.ne(F::ZERO) & there)
    }
}

impl Plastic<'_> {
    /// What the boundary lets through at a cosine.
    #[inline]
    fn through(&self, cos: f32) -> f32 {
        match &self.rough {
            Some((facets, table)) => table.between(self.eta, |shares| shares.at(facets.mean_alpha(), cos)),
            None => 1.0 - fresnel::dielectric(cos, self.eta).reflected,
        }
    }
}

impl Scatter for Plastic<'_> {
    const CHOOSES_LOBE: bool = true;

    const SIDE_BY_SIDE: bool = true;

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Light, f32) {
        Covered::<f32, _>::gather(self).eval_pdf(wo, wi)
    }

    #[inline]
    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], _: Transport) -> Option<BsdfSample> {
        let (sample, there) = Covered::<f32, _>::gather(self).sample(wo, u_lobe, u);
        there.then_some(sample)
    }

    /// In a function of its own, as it is asked in several places.
    #[inline(always)]
    fn eval_pdf_many<F: Float>(
        these: impl These<Self>,
        [wo, wi]: [Vec3<F>; 2],
        _: Transport,
    ) -> (Light<F>, F) {
        F::vectorize(
            #[inline(always)]
            || Covered::<F, _>::gather(these).eval_pdf(wo, wi),
        )
    }

    #[inline(always)]
    fn sample_many<F: Float>(
        these: impl These<Self>,
        wo: Vec3<F>,
        [u_lobe, u, v]: [F; 3],
        _: Transport,
    ) -> (BsdfSample<F>, F::Mask) {
        F::vectorize(
            #[inline(always)]
            || Covered::<F, _>::gather(these).sample(wo, u_lobe, [u, v]),
        )
    }

    fn albedo(&self) -> Light {
        let through = self.through(1.0);
        // What is scattered comes out with the same share from all directions, near enough.
        let scattered = self.diffuse * (through * through);
        (self.specular * (1.0 - through) + scattered).map(|v| if v < 1.0 { v } else { 1.0 })
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE};
        use std::sync::LazyLock;
        static TABLES: LazyLock<[ByIndex<Shares>; 4]> = LazyLock::new(|| {
            let [a, b] = [0.3, 0.15].map(|alpha| {
                let kind = if alpha == 0.3 { desc::Distribution::Ggx } else { desc::Distribution::Beckmann };
                PlasticMaterial::tables(alpha.into(), &kind, 1.5.into())
            });
            let [(a, b), (c, d)] = [a, b].map(|[through, within]| (through, within));
            [a, b, c, d]
        });
        let [ggx, ggx_within, beckmann, beckmann_within] = &*TABLES;
        let of = |ground: f32, within: f32, rough| Plastic {
            diffuse: Light::rgb([ground / (1.0 - within) / 2.25, ground / 4.5, 0.1]),
            specular: WHITE,
            eta: 1.5,
            rough,
            two_sided: true,
        };
        let smooth_within = 0.596_345_7;
        let mean =
            |within: &ByIndex<Shares>, alpha| within.between(1.5, |shares| shares.of_all_directions(alpha));
        let facets = |alpha, distribution| Facets::new([alpha; 2], distribution);
        let rough = Some((facets(0.3, desc::Distribution::Ggx), ggx));
        let bell = Some((facets(0.15, desc::Distribution::Beckmann), beckmann));
        let bsdf = Bsdf::Plastic;
        vec![
            Example::new("white plastic", bsdf(of(1.0, smooth_within, None))).nearly_energy(1e-2),
            Example::new("grey plastic", bsdf(of(0.4, smooth_within, None))),
            Example::new("rough plastic", bsdf(of(0.8, mean(ggx_within, 0.3), rough))).focus(3),
            Example::new("satin plastic", bsdf(of(0.5, mean(beckmann_within, 0.15), bell))).focus(4),
            Example::new(
                "one-sided plastic",
                bsdf(Plastic { two_sided: false, ..of(0.5, smooth_within, None) }),
            ),
        ]
    }
}
