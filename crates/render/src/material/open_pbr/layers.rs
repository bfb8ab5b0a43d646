//! The layers of OpenPBR at a point, from the outside in: fuzz, coat, and a base that is part metal, part glass and part diffuse under a
//! glossy surface. Written once for one vertex or many side by side; lobes that no vertex has are skipped.
//!
//! Directions are local, about the shading normal; what is seen from behind is turned over.

use straal_math::simd::{Float, Mask};
use straal_math::{Vec3, ops, warp};

use super::energy::Rough;
use super::film::{self, Film};
use super::fuzz::{self, Fibres};
use super::tint::Tint;
use super::{eon, interface};
use crate::material::microfacet::{Facets, SMOOTH};

/// The parameters of the material at a point, for each of the vertices side by side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Params<F: Float> {
    /// `base_color` times `base_weight`.
    pub base: Tint<F>,
    pub specular: Tint<F>,
    /// What is left of light that passes the surface.
    pub transmission: Tint<F>,
    pub subsurface: Tint<F>,
    pub coat: Tint<F>,
    pub fuzz: Tint<F>,
    /// The wavelength of each lane in nm.
    pub nm: Tint<F>,
    pub metalness: F,
    pub specular_weight: F,
    pub transmission_weight: F,
    pub subsurface_weight: F,
    pub coat_weight: F,
    pub fuzz_weight: F,
    /// How much of a film is there, thin ones faded.
    pub film_presence: F,
    pub diffuse_roughness: F,
    pub roughness: F,
    pub coat_roughness: F,
    pub fuzz_roughness: F,
    pub ior: F,
    pub coat_ior: F,
    pub film_ior: F,
    /// In nm.
    pub film_thickness: F,
    /// 20 over Abbe's number; 0 for none.
    pub dispersion: F,
    pub anisotropy: F,
    pub coat_anisotropy: F,
    pub coat_darkening: F,
    pub subsurface_anisotropy: F,
    /// A wall without thickness.
    pub thin: F::Mask,
    /// Whether the back of what is opaque is black; else it looks like the front.
    pub one_sided: F::Mask,
    /// Lanes are red, green and blue, and a dead one.
    pub rgb: F::Mask,
    /// A refraction has parted lanes: a single one is alive.
    pub parted: F::Mask,
    /// Coat and fuzz take away what they reflect on the way in and on the way out.
    pub reciprocal: F::Mask,
}

#[cfg(test)]
impl Params<f32> {
    /// The defaults of the specification, in RGB, black.
    pub const BLANK: Self = Self {
        base: Tint([0.0; 4]),
        specular: Tint([1.0, 1.0, 1.0, 0.0]),
        transmission: Tint([1.0, 1.0, 1.0, 0.0]),
        subsurface: Tint([0.8, 0.8, 0.8, 0.0]),
        coat: Tint([1.0, 1.0, 1.0, 0.0]),
        fuzz: Tint([1.0, 1.0, 1.0, 0.0]),
        nm: Tint(LINES),
        metalness: 0.0,
        specular_weight: 1.0,
        transmission_weight: 0.0,
        subsurface_weight: 0.0,
        coat_weight: 0.0,
        fuzz_weight: 0.0,
        film_presence: 0.0,
        diffuse_roughness: 0.0,
        roughness: 0.3,
        coat_roughness: 0.0,
        fuzz_roughness: 0.5,
        ior: 1.5,
        coat_ior: 1.6,
        film_ior: 1.4,
        film_thickness: 500.0,
        dispersion: 0.0,
        anisotropy: 0.0,
        coat_anisotropy: 0.0,
        coat_darkening: 1.0,
        subsurface_anisotropy: 0.0,
        thin: false,
        one_sided: false,
        rgb: true,
        parted: false,
        reciprocal: false,
    };
}

impl Params<f32> {
    /// Whether there is nothing but delta lobes, whatever the direction.
    pub fn is_delta(&self) -> bool {
        let dielectric = 1.0 - self.metalness;
        let even = dielectric * (1.0 - self.transmission_weight);
        let is_even = even * (1.0 - self.subsurface_weight) * self.base.greatest() > 0.0
            || even * self.subsurface_weight * self.subsurface.greatest() > 0.0;
        let [alpha, coat_alpha] = self.alphas(self.coat_weight > 0.0, self.coat_ior);
        !is_even
            && self.fuzz_weight <= 0.0
            && alpha < SMOOTH
            && (self.coat_weight <= 0.0 || coat_alpha < SMOOTH)
    }

    /// The colour of the surface, for people and denoisers: what its parts have straight on.
    pub fn colour(&self) -> Tint<f32> {
        let dielectric = 1.0 - self.metalness;
        let rest = dielectric * (1.0 - self.transmission_weight);
        let below = self.base
            * (self.metalness * self.specular_weight + rest * (1.0 - self.subsurface_weight))
            + self.subsurface * (rest * self.subsurface_weight)
            + self.transmission * (dielectric * self.transmission_weight);
        let coated = below * Tint::ONE.mix(self.coat, self.coat_weight);
        let live = Tint([1.0, 1.0, 1.0, if self.rgb { 0.0 } else { 1.0 }]);
        coated.mix(self.fuzz, self.fuzz_weight * fuzz::reflects(self.fuzz_roughness, 1.0)) * live
    }
}

impl<F: Float> Params<F> {
    /// GGX's alpha of the base and of the coat: each layer makes those below it rougher.
    #[inline(always)]
    fn alphas(&self, coated: F::Mask, eta_coat: F) -> [F; 2] {
        let dead = F::select(self.rgb, F::ZERO, self.fuzz.0[3]);
        let [a, b, c, _] = self.fuzz.0;
        let mean = (a + b + c + dead) * F::select(self.rgb, F::splat(1.0 / 3.0), F::splat(0.25));
        let by_fuzz = mean * self.fuzz_roughness * 0.005 * fourth_power(self.fuzz_roughness);
        let coat = lerp(self.coat_roughness, roughened(self.coat_roughness, by_fuzz), self.fuzz_weight);
        // A coat bends light the more the higher its index, and so scatters what lies below it.
        let bends = F::ONE - F::select(eta_coat.ge(F::ONE), F::ONE / eta_coat, eta_coat);
        let by_coat = F::select(coated, bends * fourth_power(coat), F::ZERO);
        let base = lerp(self.roughness, roughened(self.roughness, by_coat), self.coat_weight);
        [base * base, coat * coat]
    }
}

/// The wavelengths in nm by which red, green and blue are parted and interfere; of the dead lane any.
pub(super) const LINES: [f32; 4] = [620.0, 540.0, 450.0, 540.0];

/// Facets as smooth as this lose no light to speak of between them.
const LOSSLESS: f32 = 0.04 * 0.04;

/// An index of refraction is kept at least by this factor from 1, where light would go straight on whatever the facet.
pub(super) const LEAST_INDEX: f32 = 1.000_1;

/// What of a vertex's light comes from where, seen from one direction.
pub(super) struct Layers<F: Float> {
    p: Params<F>,
    /// 1 in lanes that are alive.
    live: Tint<F>,
    wo: Vec3<F>,
    /// What z is to be multiplied by for `wo` to lie above.
    side: F,
    /// In the medium of what is clear.
    inside: F::Mask,
    /// Whether anything is seen.
    seen: F::Mask,
    base: Base<F>,
    coat: Coat<F>,
    fibres: Fibres<F>,
    /// What the fuzz lets through on the way in.
    under: F,
    chances: Chances<F>,
    /// Coefficients of the delta lobes: what is reflected as by a mirror, and what passes.
    mirrored: Tint<F>,
    through: Tint<F>,
}

/// Below the coat.
#[derive(Clone, Copy)]
struct Base<F: Float> {
    facets: Facets<F>,
    /// See [`Facets::bound`].
    bound: F,
    /// Reflects in delta lobes.
    smooth: F::Mask,
    /// Light that passes does so in a delta lobe.
    straight: F::Mask,
    /// Light passes and is bent.
    clear: F::Mask,
    /// Index of refraction beyond over before, by lane; differs among them where they part.
    eta: Tint<F>,
    parts: F::Mask,
    boundary: Boundary<F>,
    /// What a thin wall lets through.
    thin_passes: Tint<F>,
    /// What is scattered evenly, and by the back of a thin wall.
    diffuse: Tint<F>,
    thin_diffuse: Tint<F>,
    /// For what is opaque, for light that passes, and that seen from the other side.
    opaque: Rough<F>,
    glass: Rough<F>,
    back: Rough<F>,
    /// What the glossy surface leaves of light to scatter evenly, over the mean of it.
    opaque_left: F,
    /// What is given back of what is lost: shares for this direction, and colours.
    glass_lost: F,
    glass_reflects: F,
    mirror_lost: F,
    glass_back: Tint<F>,
    glass_passes: Tint<F>,
    metal_back: Tint<F>,
}

/// What facets reflect, and what they let pass.
#[derive(Clone, Copy)]
struct Boundary<F: Float> {
    eta: Tint<F>,
    eta_opaque: Tint<F>,
    reflects: Tint<F>,
    reflects_opaque: Tint<F>,
    passes: Tint<F>,
    metal: F,
    f0: Tint<F>,
    edge: Tint<F>,
    film: Film<F>,
    /// Index below the film.
    below: Tint<F>,
    nm: Tint<F>,
    /// Besides, whatever the facet.
    window: Tint<F>,
    inside: F::Mask,
}

#[derive(Clone, Copy)]
struct Coat<F: Float> {
    facets: Facets<F>,
    bound: F,
    smooth: F::Mask,
    /// How much of it is there, and how much for what is seen from outside.
    presence: F,
    weight: F,
    eta: F,
    rough: Rough<F>,
    tint: Tint<F>,
    /// What it lets through on the way in, darkened.
    lets_in: Tint<F>,
}

/// With which probability each lobe is drawn from.
#[derive(Clone, Copy)]
struct Chances<F> {
    through: F,
    mirrored: F,
    facets: F,
    thin: F,
    even_up: F,
    even_down: F,
    coat: F,
    fuzz: F,
}

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
    pub weight: Tint<F>,
    pub chance: F,
    /// Above 0 where lanes have been parted: the wavelength that goes on.
    pub nm: F,
}

#[inline(always)]
fn fourth_power<F: Float>(x: F) -> F {
    let square = x * x;
    square * square
}

#[inline(always)]
fn lerp<F: Float>(a: F, b: F, by: F) -> F {
    a * (F::ONE - by) + b * by
}

/// GGX's alpha along and across of a roughness.
#[inline(always)]
fn alphas<F: Float>(alpha: F, anisotropy: F) -> [F; 2] {
    let less = F::ONE - anisotropy;
    let along = alpha * (F::splat(2.0) / (F::ONE + less * less)).sqrt();
    [along, along * less]
}

/// A roughness, made rougher by another.
#[inline(always)]
fn roughened<F: Float>(roughness: F, by: F) -> F {
    (fourth_power(roughness) + by).min(F::ONE).sqrt().sqrt()
}

/// An index of refraction at a wavelength, by Cauchy's formula for an Abbe number of 20 / `dispersion`: exact at the lines of
/// hydrogen (656.3 and 486.1 nm) and helium (587.6 nm) of which that is made.
#[inline(always)]
fn dispersed<F: Float>(eta: F, dispersion: F, nm: F) -> F {
    const D: f32 = 1.0 / (587.6 * 587.6);
    const SPREAD: f32 = 1.0 / (486.1 * 486.1) - 1.0 / (656.3 * 656.3);
    let below = eta.lt(F::ONE);
    let n = F::select(below, F::ONE / eta, eta);
    let n = n + (n - F::ONE) * dispersion * (F::ONE / (nm * nm) - F::splat(D)) * (1.0 / (20.0 * SPREAD));
    F::select(below, F::ONE / n, n)
}

/// Away from 1, on its side of it.
#[inline(always)]
fn away_from_one<F: Float>(eta: F) -> F {
    F::select(eta.ge(F::ONE), eta.max(F::splat(LEAST_INDEX)), eta.min(F::splat(1.0 / LEAST_INDEX)))
}

impl<F: Float> Layers<F> {
    #[inline(always)]
    pub fn new(p: Params<F>, wo: Vec3<F>) -> Self {
        let zero = F::ZERO;
        let one = F::ONE;
        let ior_air = one;
        let behind = wo.z.lt(zero);
        let side = F::select(behind, -one, one);
        let wo = Vec3::new(wo.x, wo.y, wo.z * side);
        let live = Tint([one, one, one, F::select(p.rgb, zero, one)]);

        // How much there is of each part of the base.
        let dielectric = one - p.metalness;
        let trans = dielectric * p.transmission_weight;
        let rest = dielectric * (one - p.transmission_weight);
        // Light that passes into what scatters beneath the surface comes out of it diffuse.
        let sss = rest * p.subsurface_weight;
        let opaque = rest - sss;
        let is_clear = trans.gt(zero) & !p.thin;
        let inside = behind & is_clear;
        let seen = wo.z.gt(zero) & !(behind & p.one_sided & !is_clear & !p.thin);

        // Indices of refraction, from layer to layer.
        let coated = p.coat_weight.gt(zero) & !inside;
        let above = F::select(coated, lerp(ior_air, p.coat_ior, p.coat_weight), ior_air);
        let ior = above * interface::weighted(p.ior / above, p.specular_weight);
        let eta_refract = F::select(inside, ior_air / ior, ior / ior_air);
        // The coat doesn't bend rays here, so that it must not make the base reflect totally.
        let turned_over = coated & above.gt(ior) & ior.ge(ior_air);
        let eta_glass = F::select(coated, F::select(turned_over, above / ior, ior / above), eta_refract);
        let eta_opaque = F::select(inside, ior / ior_air, eta_glass);
        let eta_coat = F::select(coated, p.coat_ior / ior_air, one);
        let eta_refract = away_from_one(eta_refract);

        let [alpha, coat_alpha] = p.alphas(coated, eta_coat);
        let roughness = alpha.sqrt();

        // Colours.
        let metal = p.metalness * p.specular_weight;
        let has_metal = metal.gt(zero).any();
        let mut metal_mean = Tint::ONE;
        if has_metal {
            metal_mean = interface::metal_mean(p.base, p.specular);
        }
        let is_thin = p.thin;
        let thin_trans = F::select(is_thin, trans, zero);
        let bent_trans = F::select(is_thin, zero, trans);
        let thin_sss = F::select(is_thin, sss, zero);
        let specular_in = Tint::select(inside, Tint::ONE, p.specular);

        // Light that goes straight through a thin wall, and what its two faces reflect with all that goes back and forth.
        let mut passes_tint = p.transmission;
        let (mut window, mut thin_passes) = (Tint::ZERO, Tint::ZERO);
        if thin_trans.gt(zero).any() {
            let refracted = interface::refracted_cos(wo.z, eta_refract);
            let longer = one / refracted.max(F::splat(1e-6));
            let tint = passes_tint.map(
                #[inline(always)]
                |t| F::select(t.gt(F::ZERO), ops::pow(t, longer), F::ZERO),
            );
            passes_tint = Tint::select(is_thin, tint.only(refracted.gt(zero)), passes_tint);
            let both = interface::dielectric(wo.z, eta_glass);
            window = p.specular * (thin_trans * both * 2.0 / (one + both));
            let both = interface::dielectric(wo.z, eta_refract);
            thin_passes = passes_tint * (thin_trans * (one - both) / (one + both));
        }

        let disperses = p.dispersion.gt(zero) & dielectric.gt(zero);
        let mut boundary = Boundary {
            eta: Tint::splat(eta_glass),
            eta_opaque: Tint::splat(eta_opaque),
            reflects: specular_in * bent_trans,
            reflects_opaque: p.specular * (opaque + sss),
            passes: passes_tint * bent_trans,
            metal,
            f0: p.base,
            edge: p.specular,
            film: Film {
                presence: p.film_presence,
                thickness: p.film_thickness,
                ior: p.film_ior,
                above: F::select(inside, ior, above),
            },
            below: Tint::splat(F::select(inside, above, ior)),
            nm: p.nm,
            window,
            inside,
        };
        let mut eta = Tint::splat(eta_refract);
        let mut parts = disperses;
        if disperses.any() {
            let apart = F::select(disperses, p.dispersion, zero);
            eta = p.nm.map(
                #[inline(always)]
                |nm| dispersed(eta_refract, apart, nm),
            );
            boundary.eta = p.nm.map(
                #[inline(always)]
                |nm| dispersed(eta_glass, apart, nm),
            );
            boundary.eta_opaque = p.nm.map(
                #[inline(always)]
                |nm| dispersed(eta_opaque, apart, nm),
            );
            let below = p.nm.zip(
                boundary.below,
                #[inline(always)]
                |nm, n| dispersed(n, apart, nm),
            );
            boundary.below = Tint::select(inside, boundary.below, below);
            parts = parts & !p.parted & eta.0[0].ne(eta.0[2]);
        }

        let [along, across] = alphas(alpha, p.anisotropy);
        let facets = Facets::new(along, across);
        let smooth = alpha.lt(F::splat(SMOOTH));
        // Where the index hardly changes light is hardly bent, however rough the surface.
        let straight = smooth | (alpha * (eta_refract - one).abs()).lt(F::splat(SMOOTH)) & !disperses;

        let opaque_rough = Rough::new(eta_opaque, alpha);
        let (diffuse, thin_diffuse);
        {
            let through = thin_sss * (p.subsurface_anisotropy + one) * 0.5;
            let back = sss - through;
            diffuse = p.base * opaque + p.subsurface * back;
            thin_diffuse = p.subsurface * through;
        }
        let has_even = diffuse.is_any() || thin_diffuse.is_any();
        let mut opaque_left = zero;
        let mut opaque_share = zero;
        if has_even {
            opaque_share = opaque_rough.opaque(wo.z);
            opaque_left = opaque_share / opaque_rough.opaque_mean().max(F::splat(1e-12));
        }

        let loses = alpha.ge(F::splat(LOSSLESS));
        let glass = Rough::new(eta_refract, alpha);
        let mut base = Base {
            facets,
            bound: F::select(bent_trans.gt(zero), one, facets.bound(wo)),
            smooth,
            straight,
            clear: is_clear,
            eta,
            parts,
            boundary,
            thin_passes,
            diffuse,
            thin_diffuse,
            opaque: opaque_rough,
            glass,
            back: glass,
            opaque_left,
            glass_lost: zero,
            glass_reflects: one,
            mirror_lost: zero,
            glass_back: specular_in * (trans + thin_sss),
            glass_passes: passes_tint * trans + Tint::splat(thin_sss),
            metal_back: metal_mean * metal_mean * metal,
        };
        if (loses & (trans + thin_sss).gt(zero)).any() {
            base.glass_lost = F::select(loses & (trans + thin_sss).gt(zero), glass.glass(wo.z), zero);
            base.glass_reflects = glass.glass_reflects();
            base.back = Rough::new(one / eta_refract, alpha);
        }
        if (loses & metal.gt(zero)).any() {
            base.mirror_lost = F::select(loses & metal.gt(zero), glass.mirror(wo.z), zero);
        }

        // The coat: what it reflects, what it absorbs of light that passes, and what it makes darker by reflecting back what comes from below.
        let [along, across] = alphas(coat_alpha, p.coat_anisotropy);
        let coat_facets = Facets::new(along, across);
        let coat_weight = F::select(coated, p.coat_weight, zero);
        let mut coat = Coat {
            facets: coat_facets,
            bound: coat_facets.bound(wo),
            smooth: coat_alpha.lt(F::splat(SMOOTH)),
            presence: p.coat_weight,
            weight: coat_weight,
            eta: eta_coat,
            rough: Rough::new(eta_coat, coat_alpha),
            tint: p.coat,
            lets_in: Tint::ONE,
        };
        let mut coat_back = zero;
        if coated.any() {
            coat_back = coat.weight * coat.reflects(wo.z);
            let mean = interface::mean(eta_coat);
            let within = one - (one - mean) / (eta_coat * eta_coat);
            let share_opaque = interface::mean(eta_opaque);
            let share_glass = interface::mean(eta_glass);
            let specularity = opaque * share_opaque + (sss + trans) * share_glass + p.metalness;
            let k = lerp(mean, within, lerp(one, roughness, specularity));
            let albedo = metal_mean * metal
                + p.base.mix(Tint::ONE, share_opaque) * opaque
                + p.subsurface * sss
                + Tint::splat(trans);
            let darkening = p.coat_weight * p.coat_darkening;
            let dark = albedo.map(
                #[inline(always)]
                |e| lerp(F::ONE, (F::ONE - k) / (F::ONE - e * k), darkening),
            );
            let lets_in = coat.passage(wo.z) * dark * (one - coat_back);
            coat.lets_in = Tint::select(coated, lets_in, Tint::ONE);
        }

        let fuzz_weight = F::select(inside, zero, p.fuzz_weight);
        let mut fibres = Fibres::NONE;
        if fuzz_weight.gt(zero).any() {
            fibres = Fibres::new(p.fuzz_roughness, wo);
        }
        let fuzz_back = fuzz_weight * fibres.reflects;
        let under = one - fuzz_back;
        let p = Params { fuzz_weight, ..p };
        let mut layers = Self {
            p,
            live,
            wo,
            side,
            inside,
            seen,
            base,
            coat,
            fibres,
            under,
            chances: Chances {
                through: zero,
                mirrored: zero,
                facets: zero,
                thin: zero,
                even_up: zero,
                even_down: zero,
                coat: zero,
                fuzz: zero,
            },
            mirrored: Tint::ZERO,
            through: Tint::ZERO,
        };
        layers.choose(coat_back, fuzz_back, opaque_share);
        layers
    }

    /// The delta lobes, and the chances of all lobes by estimates of what they scatter.
    #[inline(always)]
    fn choose(&mut self, coat_back: F, fuzz_back: F, opaque_share: F) {
        let zero = F::ZERO;
        let (base, coat, live) = (&self.base, &self.coat, self.live);
        let (back, through) = base.boundary.share(self.wo.z);
        let (back, through) = (back * live, through * live);

        let mut mirrored = Tint::ZERO;
        let both_ways = F::select(self.p.reciprocal, self.under, F::ONE);
        let is_smooth_coat = coat.smooth & coat.weight.gt(zero);
        if is_smooth_coat.any() {
            let share = coat.weight * interface::dielectric(self.wo.z, coat.eta);
            mirrored = (live * (share * self.under * both_ways)).only(is_smooth_coat);
        }
        if base.smooth.any() {
            let way_out = self.way_out(self.wo.z, F::Mask::splat(true));
            mirrored =
                mirrored + (back * coat.lets_in * way_out * (self.under * both_ways)).only(base.smooth);
        }
        let mut passes = Tint::ZERO;
        if base.straight.any() {
            let narrow = F::select(base.smooth, F::ONE, base.facets.seen(self.wo));
            let bent = (through * narrow).only(base.clear & base.straight);
            let on_way =
                self.way_out(interface::refracted_cos(self.wo.z, base.eta.0[0]), F::Mask::splat(false));
            let flat = (base.thin_passes * live).only(base.smooth & self.p.thin);
            passes = (bent * on_way + flat) * coat.lets_in * self.under;
        }
        self.mirrored = mirrored;
        self.through = passes;

        let let_in = self.under * (coat.lets_in * live).greatest();
        let rough = !base.smooth;
        let rough_through = F::select(base.straight, zero, through.greatest());
        let even = |colour: Tint<F>| (colour * live).greatest();
        let lost_back = even(base.glass_back) * base.glass_lost * base.glass_reflects
            + even(base.metal_back) * base.mirror_lost;
        let lost_through = even(base.glass_passes) * base.glass_lost * (F::ONE - base.glass_reflects);
        let c = Chances {
            through: passes.greatest(),
            mirrored: mirrored.greatest(),
            facets: F::select(rough, let_in * (back.greatest() + rough_through), zero),
            thin: F::select(rough & self.p.thin, let_in * even(base.thin_passes), zero),
            even_up: let_in * (even(base.diffuse) * opaque_share + lost_back),
            even_down: let_in * (even(base.thin_diffuse) * opaque_share + lost_through),
            coat: F::select(coat.smooth, zero, self.under * coat_back),
            fuzz: fuzz_back * even(self.p.fuzz),
        };
        let sum = c.through + c.mirrored + c.facets + c.thin + c.even_up + c.even_down + c.coat + c.fuzz;
        let by = F::select(sum.gt(zero) & self.seen, F::ONE / sum, zero);
        self.chances = Chances {
            through: c.through * by,
            mirrored: c.mirrored * by,
            facets: c.facets * by,
            thin: c.thin * by,
            even_up: c.even_up * by,
            even_down: c.even_down * by,
            coat: c.coat * by,
            fuzz: c.fuzz * by,
        };
    }

    /// What the coat leaves of light that comes from the base at a cosine: on its way up, or down through what is clear.
    #[inline(always)]
    fn way_out(&self, cos: F, up: F::Mask) -> Tint<F> {
        let crosses = up ^ self.inside;
        if !(crosses & self.coat.presence.gt(F::ZERO)).any() {
            return Tint::ONE;
        }
        let passage = self.coat.passage(cos);
        let twice = self.p.reciprocal & up & !self.inside;
        let mut rest = F::ONE;
        if twice.any() {
            rest = F::select(twice, F::ONE - self.coat.weight * self.coat.reflects(cos), F::ONE);
        }
        Tint::select(crosses, passage * rest, Tint::ONE)
    }

    /// f |cos| of radiance without delta lobes, and the density of [`Self::draw`].
    #[inline(always)]
    pub fn eval(&self, wi: Vec3<F>) -> (Tint<F>, F) {
        let (base, coat, chances) = (&self.base, &self.coat, &self.chances);
        let wi = Vec3::new(wi.x, wi.y, wi.z * self.side);
        let up = wi.z.gt(F::ZERO) & self.seen;
        let down = wi.z.lt(F::ZERO) & self.seen;
        // What goes through a thin wall is a mirror image of what is reflected.
        let mirrored = Vec3::new(wi.x, wi.y, wi.z.abs());
        let cos = mirrored.z;
        let h = self.wo + mirrored;
        let square = h.length_squared();
        let has_half = square.gt(F::splat(f32::MIN_POSITIVE));
        let cos_half = (self.wo.dot(h) / square.sqrt()).max(F::ZERO).min(F::ONE);

        let mut value = Tint::ZERO;
        let mut pdf = F::ZERO;
        let glossy = !base.smooth & has_half & (up | down & self.p.thin);
        if glossy.any() {
            let density = base.facets.density(h);
            // D G1(wo) G1(wi) / (4 wo.z), of which 2 wo.z is in Smith's share.
            let shape = density * base.facets.reflects(self.wo, F::ONE) * base.facets.seen(mirrored);
            let drawn = density * base.facets.reflects(self.wo, base.bound);
            let (back, through) = base.boundary.share(cos_half);
            let part = self.part(back, through);
            value = (back * shape).only(up & glossy);
            pdf = F::select(up & glossy, chances.facets * part * drawn, F::ZERO);
            let thin = down & glossy;
            if thin.any() {
                value = value + (base.thin_passes * shape).only(thin);
                pdf += F::select(thin, chances.thin * drawn, F::ZERO);
            }
        }
        let bent = down & base.clear & !base.straight;
        if bent.any() {
            let (passed, drawn) = self.refracted(wi);
            value = value + passed.only(bent);
            pdf += F::select(bent, drawn * chances.facets, F::ZERO);
        }
        let (even, drawn) = self.even(mirrored, up);
        value = value + even.only(up | down);
        pdf += F::select(up | down, drawn, F::ZERO);

        // Up through the layers.
        value = value * coat.lets_in * self.way_out(cos, up);
        if (up & coat.weight.gt(F::ZERO) & !coat.smooth).any() {
            let on = up & has_half & !coat.smooth;
            let density = coat.facets.density(h);
            let shape = density * coat.facets.reflects(self.wo, F::ONE) * coat.facets.seen(mirrored);
            let share = coat.weight * interface::dielectric(cos_half, coat.eta);
            value = value + Tint::splat(F::select(on, shape * share, F::ZERO));
            let drawn = density * coat.facets.reflects(self.wo, coat.bound);
            pdf += F::select(on, chances.coat * drawn, F::ZERO);
        }
        if self.p.fuzz_weight.gt(F::ZERO).any() {
            let mut rest = self.under;
            let twice = up & self.p.reciprocal;
            if twice.any() {
                let back = self.p.fuzz_weight * fuzz::reflects(self.p.fuzz_roughness, cos);
                rest = F::select(twice, rest * (F::ONE - back), rest);
            }
            value = value * rest;
            let drawn = F::select(up, self.fibres.pdf(mirrored), F::ZERO);
            value = value + self.p.fuzz * (self.p.fuzz_weight * self.fibres.reflects * drawn);
            pdf += chances.fuzz * drawn;
        }
        (value * self.live, pdf)
    }

    /// The part of the facets' light that is reflected.
    #[inline(always)]
    fn part(&self, back: Tint<F>, through: Tint<F>) -> F {
        let back = (back * self.live).greatest();
        let through = F::select(self.base.straight, F::ZERO, (through * self.live).greatest());
        let sum = back + through;
        F::select(sum.gt(F::ZERO), back / sum, F::ONE)
    }

    /// f |cos| of light that passes rough facets, and the density of drawing it from them: where lanes part, the mean over them.
    #[inline(always)]
    fn refracted(&self, wi: Vec3<F>) -> (Tint<F>, F) {
        let base = &self.base;
        let seen = base.facets.seen(Vec3::new(wi.x, wi.y, -wi.z));
        let one = |eta: F, lane: Option<usize>| {
            let m = self.wo + wi * eta;
            let square = m.length_squared();
            // The half-way vector points into the thinner medium.
            let is_right = m.z.lt(F::ZERO) ^ eta.lt(F::ONE);
            let (before, beyond) = (self.wo.dot(m), wi.dot(m));
            let on = is_right & (before * beyond).lt(F::ZERO) & square.gt(F::splat(1e-10));
            let cos = (before.abs() / square.sqrt()).min(F::ONE);
            // D G1(wo) / wo.z |wo.m| |wi.m| eta² / (wo.m + eta wi.m)², for m of unit length (Walter et al. 2007, eq. 21).
            let shape = base.facets.density(m)
                * base.facets.reflects(self.wo, F::ONE)
                * 4.0
                * (before * beyond).abs()
                / (square * square);
            let shape = F::select(on, shape, F::ZERO);
            let (back, through) = base.boundary.share(cos);
            let part = F::ONE - self.part(back, through);
            // Radiance is compressed by eta², which cancels that of the density.
            let passed = match lane {
                Some(lane) => Tint::splat(through.0[lane] * shape),
                None => through * shape,
            };
            (passed * seen, shape * eta * eta * part)
        };
        if !base.parts.any() {
            return one(base.eta.0[0], None);
        }
        let (a, pa) = one(base.eta.0[0], Some(0));
        let (b, pb) = one(base.eta.0[1], Some(1));
        let (c, pc) = one(base.eta.0[2], Some(2));
        let (d, pd) = one(base.eta.0[3], Some(3));
        let last = self.live.0[3];
        let pdf = (pa + pb + pc + pd * last) / (last + F::splat(3.0));
        (Tint([a.0[0], b.0[1], c.0[2], d.0[3]]), pdf)
    }

    /// f |cos| of what is scattered evenly, and of the light that bounces between facets, above or below; with the density.
    #[inline(always)]
    fn even(&self, wi: Vec3<F>, up: F::Mask) -> (Tint<F>, F) {
        let (base, chances) = (&self.base, &self.chances);
        let cosine = warp::cosine_hemisphere_pdf(wi.z);
        let chance = F::select(up, chances.even_up, chances.even_down);
        let mut f = Tint::ZERO;
        let colour = Tint::select(up, base.diffuse, base.thin_diffuse);
        if colour.is_any() {
            let left = base.opaque_left * base.opaque.opaque(wi.z);
            f = eon::value(colour, self.p.diffuse_roughness, self.wo, wi) * left;
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
            let colour = Tint::select(up, base.glass_back, base.glass_passes) * compressed;
            f = f + colour * (share * std::f32::consts::FRAC_1_PI);
        }
        if base.mirror_lost.gt(F::ZERO).any() {
            let lost = base.glass.mirror(wi.z) / base.glass.mirror_mean().max(F::splat(1e-12));
            let share = F::select(up, (base.mirror_lost * lost).min(most), F::ZERO);
            f = f + base.metal_back * (share * std::f32::consts::FRAC_1_PI);
        }
        (f * wi.z, chance * cosine)
    }

    /// Draws a direction by a number that chooses the lobe and two for where in it.
    #[inline(always)]
    pub fn draw(&self, u_lobe: F, u: [F; 2]) -> Drawn<F> {
        let (base, c) = (&self.base, &self.chances);
        let mut rest = u_lobe;
        let mut open = self.seen;
        // In turn, the number that is left is put back to [0, 1).
        let mut choose = |chance: F, last: bool| {
            let mut here = open & chance.gt(F::ZERO);
            if !last {
                here = here & rest.lt(chance);
            }
            rest = F::select(
                here,
                (rest / chance).min(F::splat(1.0 - f32::EPSILON / 2.0)),
                F::select(open, rest - chance, rest),
            );
            open = open & !here;
            here
        };
        let through = choose(c.through, false);
        let mirrored = choose(c.mirrored, false);
        let facets = choose(c.facets, false);
        let thin = choose(c.thin, false);
        let even_up = choose(c.even_up, false);
        let even_down = choose(c.even_down, false);
        let coat = choose(c.coat, false);
        let fuzz = choose(c.fuzz, true);

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
            let weights = Tint::select(parts, self.through * lane.only, self.through) * by;
            weight = Tint::select(through, weights, weight);
            chance = F::select(through, c.through, chance);
            nm = F::select(parts, lane.nm, nm);
        }
        if (facets | thin).any() {
            let m = base.facets.draw(self.wo, base.bound, u);
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
            let m = self.coat.facets.draw(self.wo, self.coat.bound, u);
            let reflected = m * (self.wo.dot(m) * 2.0) - self.wo;
            wi = Vec3::select(coat, reflected, wi);
            any = any | coat & reflected.z.gt(F::ZERO);
        }
        if fuzz.any() {
            let d = self.fibres.draw(u);
            wi = Vec3::select(fuzz, d, wi);
            any = any | fuzz & d.z.gt(F::ZERO);
        }
        let transmitted = wi.z.lt(F::ZERO);
        Drawn { wi: Vec3::new(wi.x, wi.y, wi.z * self.side), any, delta, transmitted, weight, chance, nm }
    }

    /// One of the lanes, where they part: any of red, green and blue; of four wavelengths the first.
    #[inline(always)]
    fn lane(&self, u: F) -> Lane<F> {
        let third = F::splat(1.0 / 3.0);
        let first = u.lt(third) | !self.p.rgb;
        let second = u.lt(third + third);
        let pick = |of: Tint<F>| F::select(first, of.0[0], F::select(second, of.0[1], of.0[2]));
        let count = F::select(self.p.rgb, F::splat(3.0), F::splat(4.0));
        let zero = F::ZERO;
        let only = Tint([
            F::select(first, count, zero),
            F::select(!first & second, count, zero),
            F::select(!first & !second, count, zero),
            zero,
        ]);
        Lane { eta: pick(self.base.eta), nm: pick(self.p.nm), only }
    }

    /// What passes in the delta lobe, at its full share.
    pub fn passes(&self) -> Tint<F> {
        self.through
    }

    /// Whether light goes through, and the index of refraction beyond over before.
    pub fn bends(&self) -> F {
        F::select(self.p.thin, F::ONE, self.base.eta.0[0])
    }
}

/// What goes on where lanes part.
#[derive(Clone, Copy)]
struct Lane<F> {
    eta: F,
    nm: F,
    /// The lane, times the number of lanes.
    only: Tint<F>,
}

impl<F: Float> Coat<F> {
    /// What it reflects of light at a cosine.
    #[inline(always)]
    fn reflects(&self, cos: F) -> F {
        F::select(self.smooth, interface::dielectric(cos, self.eta), F::ONE - self.rough.opaque(cos))
    }

    /// What is left of light that crosses it at a cosine: the colour is that of crossing it twice straight.
    #[inline(always)]
    fn passage(&self, cos: F) -> Tint<F> {
        if !(Tint::ONE - self.tint).is_any() {
            return Tint::ONE;
        }
        let longer = F::splat(0.5) / interface::refracted_cos(cos, self.eta);
        let along = self.tint.map(
            #[inline(always)]
            |t| F::select(t.gt(F::ZERO), ops::pow(t, longer), F::ZERO),
        );
        Tint::ONE.mix(along, self.presence)
    }
}

impl<F: Float> Boundary<F> {
    /// What a facet seen at a cosine reflects, and what it lets pass.
    #[inline(always)]
    fn share(&self, cos: F) -> (Tint<F>, Tint<F>) {
        let share = reflected(self.eta, cos);
        let mut share_opaque = share;
        if (self.inside & self.reflects_opaque.greatest().gt(F::ZERO)).any() {
            share_opaque = reflected(self.eta_opaque, cos);
        }
        let mut back = self.reflects * share + self.reflects_opaque * share_opaque;
        let mut through = self.passes * (Tint::ONE - share);
        let has_metal = self.metal.gt(F::ZERO).any();
        if has_metal {
            back = back + interface::metal(cos, self.f0, self.edge) * self.metal;
        }
        if film::is_any(self.film.presence) {
            let share = self.film.reflects(cos, self.below, Tint::ZERO, self.nm);
            let mut filmed = (self.reflects + self.reflects_opaque) * share;
            if has_metal {
                let [n, k] = film::metal(self.f0, self.edge);
                filmed = filmed + self.film.reflects(cos, n, k, self.nm) * self.metal;
            }
            back = back.mix(filmed, self.film.presence);
            through = through.mix(self.passes * (Tint::ONE - share), self.film.presence);
        }
        (back + self.window, through)
    }
}

/// [`interface::dielectric`] of each lane; of one where all are the same.
#[inline(always)]
fn reflected<F: Float>(eta: Tint<F>, cos: F) -> Tint<F> {
    let [a, b, c, d] = eta.0;
    let first = interface::dielectric(cos, a);
    if (a.eq(b) & a.eq(c) & a.eq(d)).all() {
        return Tint::splat(first);
    }
    Tint([first, interface::dielectric(cos, b), interface::dielectric(cos, c), interface::dielectric(cos, d)])
}
