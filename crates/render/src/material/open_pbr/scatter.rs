//! How the layers of OpenPBR scatter: values, densities and draws.

use std::f32::consts::FRAC_1_PI;

use straal_color::Light;
use straal_math::simd::{Float, Mask};
use straal_math::{Vec3, warp};

use super::layers::{Layers, turned, turned_back};
use super::{fuzz, interface, is_any};
use crate::material::RoughDiffuse;

/// Directions that were drawn.
pub(super) struct Drawn<F: Float> {
    /// Of unit length where there is one.
    pub wi: Vec3<F>,
    /// Whether there is one.
    pub any: F::Mask,
    pub delta: F::Mask,
    /// Whether it leads through the surface.
    pub transmitted: F::Mask,
    /// Of a delta lobe: its coefficient over its probability, and that probability.
    pub weight: Light<F>,
    pub chance: F,
    /// Above 0 where lanes have been parted: the wavelength that goes on.
    pub nm: F,
}

impl<F: Float> Layers<F> {
    /// What the coat leaves of light that comes from the base at a cosine: on its way up, or down through what is clear.
    #[inline(always)]
    pub fn way_out(&self, cos: F, up: F::Mask) -> Light<F> {
        let crosses = up ^ self.inside;
        if !(crosses & self.coat.presence.gt(F::ZERO)).any() {
            return Light::splat(F::ONE);
        }
        let passage = self.coat.passage(cos);
        let twice = self.p.reciprocal & up & !self.inside;
        let mut rest = F::ONE;
        if twice.any() {
            rest = F::select(twice, F::ONE - self.coat.weight * self.coat.reflects(cos), F::ONE);
        }
        Light::select(crosses, passage * rest, Light::splat(F::ONE))
    }

    /// f |cos| of radiance without delta lobes, and the density of [`Self::draw`].
    #[inline(always)]
    pub fn eval(&self, wi: Vec3<F>) -> (Light<F>, F) {
        F::vectorize(
            #[inline(always)]
            || self.eval_here(wi),
        )
    }

    #[inline(always)]
    fn eval_here(&self, wi: Vec3<F>) -> (Light<F>, F) {
        let (base, coat, chances) = (&self.base, &self.coat, &self.chances);
        let wi = turned(&self.p, Vec3::new(wi.x, wi.y, wi.z * self.side));
        let up = wi.z.gt(F::ZERO) & self.seen;
        let down = wi.z.lt(F::ZERO) & self.seen;
        // What goes through a thin wall is a mirror image of what is reflected.
        let mirrored = Vec3::new(wi.x, wi.y, wi.z.abs());
        let cos = mirrored.z;
        let h = self.wo + mirrored;
        let square = h.length_squared();
        let has_half = square.gt(F::splat(f32::MIN_POSITIVE));
        let cos_half = (self.wo.dot(h) / square.sqrt()).max(F::ZERO).min(F::ONE);

        let mut value = Light::splat(F::ZERO);
        let mut pdf = F::ZERO;
        let glossy = !base.smooth & has_half & (up | down & self.p.thin);
        if glossy.any() {
            let density = base.facets.density(h);
            // D G1(wo) G1(wi) / (4 wo.z), of which 2 wo.z is in Smith's share.
            let shape = density * base.facets.reflects_within(self.wo, F::ONE) * base.facets.seen(mirrored);
            let drawn = density * base.facets.reflects_within(self.wo, base.bound);
            let (back, through) = base.boundary.share(cos_half);
            let part = self.part(back, through);
            value = (back * shape).only(up & glossy);
            pdf = F::select(up & glossy, chances.facets * part * drawn, F::ZERO);
            let thin = down & glossy;
            if thin.any() {
                value += (base.thin_passes * shape).only(thin);
                pdf += F::select(thin, chances.thin * drawn, F::ZERO);
            }
        }
        let bent = down & base.clear & !base.straight;
        if bent.any() {
            let (passed, drawn) = self.refracted(wi);
            value += passed.only(bent);
            pdf += F::select(bent, drawn * chances.facets, F::ZERO);
        }
        let (even, drawn) = self.even(mirrored, up);
        value += even.only(up | down);
        pdf += F::select(up | down, drawn, F::ZERO);

        // Up through the layers.
        value *= coat.lets_in * self.way_out(coat.cos(mirrored), up);
        if (up & coat.weight.gt(F::ZERO) & !coat.smooth).any() {
            let (own_wi, h) = (coat.local(mirrored), coat.local(h));
            let on = up & has_half & coat.weight.gt(F::ZERO) & !coat.smooth & own_wi.z.gt(F::ZERO);
            let density = coat.facets.density(h);
            let shape = density * coat.facets.reflects_within(coat.wo, F::ONE) * coat.facets.seen(own_wi);
            let share = coat.weight * interface::dielectric(cos_half, coat.eta);
            value += Light::splat(F::select(on, shape * share, F::ZERO));
            let drawn = density * coat.facets.reflects_within(coat.wo, coat.bound);
            pdf += F::select(on, chances.coat * drawn, F::ZERO);
        }
        if self.p.fuzz_weight.gt(F::ZERO).any() {
            let mut rest = self.under;
            let twice = up & self.p.reciprocal;
            if twice.any() {
                let back = self.p.fuzz_weight * fuzz::reflects(self.p.fuzz_roughness, cos);
                rest = F::select(twice, rest * (F::ONE - back), rest);
            }
            value *= rest;
            let drawn = F::select(up & self.p.fuzz_weight.gt(F::ZERO), self.fibres.pdf(mirrored), F::ZERO);
            value += self.p.fuzz * (self.p.fuzz_weight * self.fibres.reflects * drawn);
            pdf += chances.fuzz * drawn;
        }
        (value * self.live, pdf)
    }

    /// The part of the facets' light that is reflected.
    #[inline(always)]
    fn part(&self, back: Light<F>, through: Light<F>) -> F {
        let back = (back * self.live).max_lane();
        let through = F::select(self.base.straight, F::ZERO, (through * self.live).max_lane());
        let sum = back + through;
        F::select(sum.gt(F::ZERO), back / sum, F::ONE)
    }

    /// f |cos| of light that passes rough facets, and the density of drawing it from them: where lanes part, the mean over them.
    #[inline(always)]
    fn refracted(&self, wi: Vec3<F>) -> (Light<F>, F) {
        let base = &self.base;
        let seen = base.facets.seen(Vec3::new(wi.x, wi.y, -wi.z));
        let (first, drawn) = self.refracted_by(base.eta.0[0], wi);
        if !base.parts.any() {
            return (first * seen, drawn);
        }
        let (mut value, mut pdf) = (first, drawn);
        for lane in 1..4 {
            let (passed, drawn) = self.refracted_by(base.eta.0[lane], wi);
            value.0[lane] = passed.0[lane];
            pdf += if lane < 3 { drawn } else { drawn * self.live.0[3] };
        }
        let mean = pdf / (self.live.0[3] + F::splat(3.0));
        let value = Light::select(base.parts, value, first);
        (value * seen, F::select(base.parts, mean, drawn))
    }

    /// The same for an index, but for Smith's share of the facets that are seen from `wi`.
    #[inline(always)]
    fn refracted_by(&self, eta: F, wi: Vec3<F>) -> (Light<F>, F) {
        let base = &self.base;
        let m = self.wo + wi * eta;
        let square = m.length_squared();
        // The half-way vector points into the thinner medium.
        let is_right = m.z.lt(F::ZERO) ^ eta.lt(F::ONE);
        let (before, beyond) = (self.wo.dot(m), wi.dot(m));
        let on = is_right & (before * beyond).lt(F::ZERO) & square.gt(F::splat(1e-10));
        let cos = (before.abs() / square.sqrt()).min(F::ONE);
        // D G1(wo) / wo.z |wo.m| |wi.m| eta² / (wo.m + eta wi.m)², for m of unit length (Walter et al. 2007, eq. 21).
        let facets = base.facets.density(m) * base.facets.reflects_within(self.wo, F::ONE) * 4.0;
        let shape = F::select(on, facets * (before * beyond).abs() / (square * square), F::ZERO);
        let (back, through) = base.boundary.share(cos);
        let part = F::ONE - self.part(back, through);
        // Radiance is compressed by eta², which cancels that of the density.
        (through * shape, shape * eta * eta * part)
    }

    /// f |cos| of what is scattered evenly, and of the light that bounces between facets, above or below; with the density.
    #[inline(always)]
    fn even(&self, wi: Vec3<F>, up: F::Mask) -> (Light<F>, F) {
        let (base, chances) = (&self.base, &self.chances);
        let cosine = warp::cosine_hemisphere_pdf(wi.z);
        let chance = F::select(up, chances.even_up, chances.even_down);
        let mut f = Light::splat(F::ZERO);
        let colour = Light::select(up, base.diffuse, base.thin_diffuse);
        if is_any(colour) {
            let left = base.opaque_left * base.opaque.opaque(wi.z);
            f = eon(colour, self.p.diffuse_roughness, [self.wo, wi]) * left;
        }
        // Not more than would come at once from everywhere, along rather smooth surfaces.
        let most = F::ONE / wi.z;
        if base.glass_lost.gt(F::ZERO).any() {
            let (lost, mean) = (
                F::select(up, base.glass.glass(wi.z), base.back.glass(wi.z)),
                F::select(up, base.glass.glass_mean(), base.back.glass_mean()),
            );
            let part = F::select(up, base.glass_reflects, F::ONE - base.glass_reflects);
            let share = (base.glass_lost * lost / mean.max(F::splat(1e-12)) * part).min(most);
            let flat = up | self.p.thin;
            let compressed = base.eta.map(
                #[inline(always)]
                |eta| F::select(flat, F::ONE, F::ONE / (eta * eta)),
            );
            let colour = Light::select(up, base.glass_back, base.glass_passes) * compressed;
            f += colour * (share * FRAC_1_PI);
        }
        if base.mirror_lost.gt(F::ZERO).any() {
            let lost = base.glass.mirror(wi.z) / base.glass.mirror_mean().max(F::splat(1e-12));
            let share = F::select(up, (base.mirror_lost * lost).min(most), F::ZERO);
            f += base.metal_back * (share * FRAC_1_PI);
        }
        (f * wi.z, chance * cosine)
    }

    /// Draws a direction by a number that chooses the lobe and two for where in it.
    #[inline(always)]
    pub fn draw(&self, u_lobe: F, u: [F; 2]) -> Drawn<F> {
        F::vectorize(
            #[inline(always)]
            || self.draw_here(u_lobe, u),
        )
    }

    #[inline(always)]
    fn draw_here(&self, u_lobe: F, u: [F; 2]) -> Drawn<F> {
        let (base, c) = (&self.base, &self.chances);
        let mut choice = Choice { rest: u_lobe, open: self.seen };
        let through = choice.falls_on(c.through);
        let mirrored = choice.falls_on(c.mirrored);
        let facets = choice.falls_on(c.facets);
        let thin = choice.falls_on(c.thin);
        let even_up = choice.falls_on(c.even_up);
        let even_down = choice.falls_on(c.even_down);
        let coat = choice.falls_on(c.coat);
        // What rounding has left over is the last one's.
        let fuzz = choice.open & c.fuzz.gt(F::ZERO);
        let rest = choice.rest;

        let mut wi = Vec3::new(-self.wo.x, -self.wo.y, self.wo.z);
        let mut any = mirrored;
        let mut delta = mirrored;
        let by = F::ONE / F::select(mirrored, c.mirrored, F::ONE);
        let mut weight = self.mirrored * by;
        let mut chance = c.mirrored;
        let mut nm = F::ZERO;
        if through.any() {
            let lane = self.lane(rest);
            let parts = through & base.parts & base.clear;
            let eta = F::select(parts, lane.eta, base.eta.0[0]);
            let refracted = interface::refracted_cos(self.wo.z, eta);
            let inverse = F::ONE / eta;
            let bent = Vec3::new(-self.wo.x * inverse, -self.wo.y * inverse, -refracted);
            let on = Vec3::new(-self.wo.x, -self.wo.y, -self.wo.z);
            wi = Vec3::select(through, Vec3::select(self.p.thin, on, bent), wi);
            any = any | through & (self.p.thin | refracted.gt(F::ZERO));
            delta = delta | through;
            let compressed = F::select(self.p.thin, F::ONE, inverse * inverse);
            let by = compressed / F::select(through, c.through, F::ONE);
            let weights = Light::select(parts, self.through * lane.only, self.through) * by;
            weight = Light::select(through, weights, weight);
            chance = F::select(through, c.through, chance);
            nm = F::select(parts, lane.nm, nm);
        }
        if (facets | thin).any() {
            let m = base.facets.sample_within(self.wo, u, base.bound);
            let cos = self.wo.dot(m);
            let reflected = m * (cos * 2.0) - self.wo;
            let (back, through) = base.boundary.share(cos.max(F::ZERO).min(F::ONE));
            let part = self.part(back, through);
            let bends = facets & rest.ge(part);
            wi = Vec3::select(facets & !bends, reflected, wi);
            any = any | facets & !bends & reflected.z.gt(F::ZERO);
            if bends.any() {
                let lane = self.lane((rest - part) / (F::ONE - part).max(F::splat(1e-9)));
                let eta = F::select(base.parts, lane.eta, base.eta.0[0]);
                let refracted = interface::refracted_cos(cos, eta);
                let bent = m * (cos / eta - refracted) - self.wo * (F::ONE / eta);
                wi = Vec3::select(bends, bent, wi);
                any = any | bends & bent.z.lt(F::ZERO) & refracted.gt(F::ZERO);
            }
            wi = Vec3::select(thin, Vec3::new(reflected.x, reflected.y, -reflected.z), wi);
            any = any | thin & reflected.z.gt(F::ZERO);
        }
        if (even_up | even_down).any() {
            let d = warp::cosine_hemisphere(u);
            let d = Vec3::new(d.x, d.y, F::select(even_down, -d.z, d.z));
            wi = Vec3::select(even_up | even_down, d, wi);
            any = any | (even_up | even_down) & d.z.ne(F::ZERO);
        }
        if coat.any() {
            let own = &self.coat;
            let mirrors = coat & own.smooth;
            let up = Vec3::new(F::ZERO, F::ZERO, F::ONE);
            let m = Vec3::select(own.smooth, up, own.facets.sample_within(own.wo, u, own.bound));
            let reflected = m * (own.wo.dot(m) * 2.0) - own.wo;
            let out = own.above(reflected);
            wi = Vec3::select(coat, out, wi);
            any = any | coat & reflected.z.gt(F::ZERO) & out.z.gt(F::ZERO);
            delta = delta | mirrors;
            let by = F::ONE / F::select(mirrors, c.coat, F::ONE);
            weight = Light::select(mirrors, own.mirrored * by, weight);
            chance = F::select(mirrors, c.coat, chance);
        }
        if fuzz.any() {
            let d = self.fibres.draw(u);
            wi = Vec3::select(fuzz, d, wi);
            any = any | fuzz & d.z.gt(F::ZERO);
        }
        let transmitted = wi.z.lt(F::ZERO);
        let wi = turned_back(&self.p, wi);
        Drawn { wi: Vec3::new(wi.x, wi.y, wi.z * self.side), any, delta, transmitted, weight, chance, nm }
    }

    /// One of the lanes, where they part: any of red, green and blue; of four wavelengths the first.
    #[inline(always)]
    fn lane(&self, u: F) -> Lane<F> {
        let third = F::splat(1.0 / 3.0);
        let first = u.lt(third) | !self.p.rgb;
        let second = u.lt(third + third);
        let count = F::select(self.p.rgb, F::splat(3.0), F::splat(4.0));
        let zero = F::ZERO;
        let only = Light([
            F::select(first, count, zero),
            F::select(!first & second, count, zero),
            F::select(!first & !second, count, zero),
            zero,
        ]);
        let pick = [first, second];
        Lane { eta: picked(self.base.eta, pick), nm: picked(self.p.nm, pick), only }
    }

    /// What coat and fuzz leave of light that comes from below them.
    pub fn lets_out(&self) -> Light<F> {
        self.coat.lets_in * self.under
    }

    /// What passes in the delta lobe, at its full share.
    pub fn passes(&self) -> Light<F> {
        self.through
    }

    /// Whether light goes through, and the index of refraction beyond over before.
    pub fn bends(&self) -> F {
        F::select(self.p.thin, F::ONE, self.base.eta.0[0])
    }
}

/// A number that chooses one of several things in turn.
struct Choice<F: Float> {
    /// What is left of it, put back to [0, 1) where it has fallen.
    rest: F,
    /// Where it hasn't.
    open: F::Mask,
}

impl<F: Float> Choice<F> {
    /// Whether it falls on a thing of some chance.
    #[inline(always)]
    fn falls_on(&mut self, chance: F) -> F::Mask {
        let here = self.open & self.rest.lt(chance);
        let put_back = (self.rest / chance).min(F::splat(1.0 - f32::EPSILON / 2.0));
        let rest = F::select(self.open, self.rest - chance, self.rest);
        self.rest = F::select(here, put_back, rest);
        self.open = self.open & !here;
        here
    }
}

/// EON's f, of a rough surface of a colour, for directions above it.
#[inline(always)]
fn eon<F: Float>(colour: Light<F>, roughness: F, [wo, wi]: [Vec3<F>; 2]) -> Light<F> {
    let [once, others] = RoughDiffuse::shape(F::Mask::splat(true), roughness, wo, wi);
    let mean = RoughDiffuse::mean(roughness);
    colour.map(
        #[inline(always)]
        |rho| (once + rho * mean / (F::ONE - rho * (F::ONE - mean)) * others) * rho * FRAC_1_PI,
    )
}

/// The first, the second, or the third.
#[inline(always)]
fn picked<F: Float>(of: Light<F>, [first, second]: [F::Mask; 2]) -> F {
    F::select(first, of.0[0], F::select(second, of.0[1], of.0[2]))
}

/// What goes on where lanes part.
#[derive(Clone, Copy)]
struct Lane<F> {
    eta: F,
    nm: F,
    /// The lane, times the number of lanes.
    only: Light<F>,
}
