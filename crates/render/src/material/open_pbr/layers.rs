//! The layers of OpenPBR as they are seen from one direction, from the outside in: fuzz, coat, and a base that is part metal, part glass and
//! part diffuse under a glossy surface. How they scatter is in [`super::scatter`].
//!
//! Written once for one vertex or many side by side; what no vertex has is skipped, which changes no bit of the others. Directions are local,
//! about the shading normal; what is seen from behind is turned over.

use straal_color::Light;
use straal_math::simd::{Float, Mask};
use straal_math::{Frame, Vec3, ops};

use super::energy::Rough;
use super::film::{self, Film};
use super::fuzz::Fibres;
use super::params::{LEAST_INDEX, Params, SMOOTH, lerp};
use super::{ggx, interface, is_any};
use crate::material::microfacet::Facets;
use crate::material::shaded::shading_normals;

/// Facets as smooth as this lose no light to speak of between them.
const LOSSLESS: f32 = 0.04 * 0.04;

/// What of a vertex's light comes from where, seen from one direction.
pub(super) struct Layers<F: Float> {
    pub p: Params<F>,
    /// 1 in lanes that are alive.
    pub live: Light<F>,
    pub wo: Vec3<F>,
    /// What z is to be multiplied by for `wo` to lie above.
    pub side: F,
    /// In the medium of what is clear.
    pub inside: F::Mask,
    /// Whether anything is seen.
    pub seen: F::Mask,
    pub base: Base<F>,
    pub coat: Coat<F>,
    pub fibres: Fibres<F>,
    /// What the fuzz lets through on the way in.
    pub under: F,
    pub chances: Chances<F>,
    /// Coefficients of the delta lobes: what is reflected as by a mirror, and what passes.
    pub mirrored: Light<F>,
    pub through: Light<F>,
}

/// Below the coat.
#[derive(Clone, Copy)]
pub(super) struct Base<F: Float> {
    pub facets: Facets<F>,
    /// See [`Facets::bound`].
    pub bound: F,
    /// Reflects in delta lobes.
    pub smooth: F::Mask,
    /// Light that passes does so in a delta lobe.
    pub straight: F::Mask,
    /// Light passes and is bent.
    pub clear: F::Mask,
    /// Index of refraction beyond over before, by lane; differs among them where they part.
    pub eta: Light<F>,
    pub parts: F::Mask,
    pub boundary: Boundary<F>,
    /// What a thin wall lets through.
    pub thin_passes: Light<F>,
    /// What is scattered evenly, and by the back of a thin wall.
    pub diffuse: Light<F>,
    pub thin_diffuse: Light<F>,
    /// For what is opaque, for light that passes, and that seen from the other side.
    pub opaque: Rough<F>,
    pub glass: Rough<F>,
    pub back: Rough<F>,
    /// What the glossy surface leaves of light to scatter evenly, over the mean of it.
    pub opaque_left: F,
    /// What is given back of what is lost: shares for this direction, and colours.
    pub glass_lost: F,
    pub glass_reflects: F,
    pub mirror_lost: F,
    pub glass_back: Light<F>,
    pub glass_passes: Light<F>,
    pub metal_back: Light<F>,
}

/// What facets reflect, and what they let pass.
#[derive(Clone, Copy)]
pub(super) struct Boundary<F: Float> {
    pub eta: Light<F>,
    pub eta_opaque: Light<F>,
    pub reflects: Light<F>,
    pub reflects_opaque: Light<F>,
    pub passes: Light<F>,
    pub metal: F,
    pub f0: Light<F>,
    pub edge: Light<F>,
    pub film: Film<F>,
    /// Index below the film.
    pub below: Light<F>,
    pub nm: Light<F>,
    /// Besides, whatever the facet.
    pub window: Light<F>,
    pub inside: F::Mask,
}

#[derive(Clone, Copy)]
pub(super) struct Coat<F: Float> {
    pub facets: Facets<F>,
    pub bound: F,
    pub smooth: F::Mask,
    /// How much of it is there, and how much for what is seen from outside.
    pub presence: F,
    pub weight: F,
    pub eta: F,
    pub rough: Rough<F>,
    pub tint: Light<F>,
    /// What it lets through on the way in, darkened.
    pub lets_in: Light<F>,
    /// Where its normal isn't that of the base, and its frame there.
    pub leans: F::Mask,
    pub frame: Frame<F>,
    /// The direction to the viewer in that.
    pub wo: Vec3<F>,
    /// What it reflects as a mirror of its own.
    pub mirrored: Light<F>,
}

/// With which probability each lobe is drawn from.
#[derive(Clone, Copy)]
pub(super) struct Chances<F> {
    pub through: F,
    pub mirrored: F,
    pub facets: F,
    pub thin: F,
    pub even_up: F,
    pub even_down: F,
    pub coat: F,
    pub fuzz: F,
}

impl<F: Float> Layers<F> {
    /// As seen from a direction.
    #[inline(always)]
    pub fn new(p: Params<F>, wo: Vec3<F>) -> Self {
        // In a function of its own, as all that is long here: it would be compiled for each place that it is called from.
        F::vectorize(
            #[inline(always)]
            || Self::seen_from(&p, wo),
        )
    }

    #[inline(always)]
    fn seen_from(p: &Params<F>, wo: Vec3<F>) -> Self {
        let p = *p;
        let zero = F::ZERO;
        let one = F::ONE;
        let ior_air = one;
        let behind = wo.z.lt(zero);
        let side = F::select(behind, -one, one);
        let wo = turned(&p, Vec3::new(wo.x, wo.y, wo.z * side));
        let live = Light([one, one, one, F::select(p.rgb, zero, one)]);

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
        let mut metal_mean = Light::splat(F::ONE);
        if has_metal {
            metal_mean = interface::metal_mean(p.base, p.specular);
        }
        let is_thin = p.thin;
        let thin_trans = F::select(is_thin, trans, zero);
        let bent_trans = F::select(is_thin, zero, trans);
        let thin_sss = F::select(is_thin, sss, zero);
        let specular_in = Light::select(inside, Light::splat(F::ONE), p.specular);

        // Light that goes straight through a thin wall, and what its two faces reflect with all that goes back and forth.
        let mut passes_tint = p.transmission;
        let (mut window, mut thin_passes) = (Light::splat(F::ZERO), Light::splat(F::ZERO));
        if thin_trans.gt(zero).any() {
            let refracted = interface::refracted_cos(wo.z, eta_refract);
            let longer = one / refracted.max(F::splat(1e-6));
            let tint = passes_tint.map(
                #[inline(always)]
                |t| F::select(t.gt(F::ZERO), ops::pow(t, longer), F::ZERO),
            );
            passes_tint = Light::select(is_thin, tint.only(refracted.gt(zero)), passes_tint);
            let both = interface::dielectric(wo.z, eta_glass);
            window = p.specular * (thin_trans * both * 2.0 / (one + both));
            let both = interface::dielectric(wo.z, eta_refract);
            thin_passes = passes_tint * (thin_trans * (one - both) / (one + both));
        }

        let disperses = p.dispersion.gt(zero) & dielectric.gt(zero);
        let mut boundary = Boundary {
            eta: Light::splat(eta_glass),
            eta_opaque: Light::splat(eta_opaque),
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
            below: Light::splat(F::select(inside, above, ior)),
            nm: p.nm,
            window,
            inside,
        };
        let mut eta = Light::splat(eta_refract);
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
            boundary.below = Light::select(inside, boundary.below, below);
            parts = parts & !p.parted & eta.0[0].ne(eta.0[2]);
        }

        let [along, across] = alphas(alpha, p.anisotropy);
        let facets = ggx([along, across]);
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
        let has_even = is_any(diffuse) || is_any(thin_diffuse);
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
            glass_passes: passes_tint * trans + Light::splat(thin_sss),
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
        let coat_facets = ggx([along, across]);
        let coat_weight = F::select(coated, p.coat_weight, zero);
        let leans = p.leans & coated;
        let (mut coat_frame, mut coat_wo) = (Frame::from_normal(Vec3::new(zero, zero, one)), wo);
        if leans.any() {
            coat_frame = leaning(&p, wo);
            coat_wo = Vec3::select(leans, coat_frame.to_local(wo), wo);
        }
        let mut coat = Coat {
            leans,
            frame: coat_frame,
            wo: coat_wo,
            mirrored: Light::splat(F::ZERO),
            facets: coat_facets,
            bound: coat_facets.bound(coat_wo),
            smooth: coat_alpha.lt(F::splat(SMOOTH)),
            presence: p.coat_weight,
            weight: coat_weight,
            eta: eta_coat,
            rough: Rough::new(eta_coat, coat_alpha),
            tint: p.coat,
            lets_in: Light::splat(F::ONE),
        };
        let mut coat_back = zero;
        if coated.any() {
            coat_back = coat.weight * coat.reflects(coat.wo.z);
            let mean = interface::mean(eta_coat);
            let within = one - (one - mean) / (eta_coat * eta_coat);
            let share_opaque = interface::mean(eta_opaque);
            let share_glass = interface::mean(eta_glass);
            let specularity = opaque * share_opaque + (sss + trans) * share_glass + p.metalness;
            let k = lerp(mean, within, lerp(one, roughness, specularity));
            let albedo = metal_mean * metal
                + p.base.mix(Light::splat(F::ONE), share_opaque) * opaque
                + p.subsurface * sss
                + Light::splat(trans);
            let darkening = p.coat_weight * p.coat_darkening;
            let dark = albedo.map(
                #[inline(always)]
                |e| lerp(F::ONE, (F::ONE - k) / (F::ONE - e * k), darkening),
            );
            let lets_in = coat.passage(coat.wo.z) * dark * (one - coat_back);
            coat.lets_in = Light::select(coated, lets_in, Light::splat(F::ONE));
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
            mirrored: Light::splat(F::ZERO),
            through: Light::splat(F::ZERO),
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

        let mut mirrored = Light::splat(F::ZERO);
        let mut own_mirror = mirrored;
        let both_ways = F::select(self.p.reciprocal, self.under, F::ONE);
        let is_smooth_coat = coat.smooth & coat.weight.gt(zero);
        if is_smooth_coat.any() {
            let share = coat.weight * interface::dielectric(coat.wo.z, coat.eta);
            let all = (live * (share * self.under * both_ways)).only(is_smooth_coat);
            mirrored = all.only(!coat.leans);
            own_mirror = all.only(coat.leans);
        }
        if base.smooth.any() {
            let out = coat.cos(Vec3::new(-self.wo.x, -self.wo.y, self.wo.z));
            let way_out = self.way_out(out, F::Mask::splat(true));
            mirrored += (back * coat.lets_in * way_out * (self.under * both_ways)).only(base.smooth);
        }
        let mut passes = Light::splat(F::ZERO);
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

        let let_in = self.under * (coat.lets_in * live).max_lane();
        let rough = !base.smooth;
        let rough_through = F::select(base.straight, zero, through.max_lane());
        let lost_back = (base.glass_back * live).max_lane() * base.glass_lost * base.glass_reflects
            + (base.metal_back * live).max_lane() * base.mirror_lost;
        let lost_through =
            (base.glass_passes * live).max_lane() * base.glass_lost * (F::ONE - base.glass_reflects);
        let c = Chances {
            through: passes.max_lane(),
            mirrored: mirrored.max_lane(),
            facets: F::select(rough, let_in * (back.max_lane() + rough_through), zero),
            thin: F::select(rough & self.p.thin, let_in * (base.thin_passes * live).max_lane(), zero),
            even_up: let_in * ((base.diffuse * live).max_lane() * opaque_share + lost_back),
            even_down: let_in * ((base.thin_diffuse * live).max_lane() * opaque_share + lost_through),
            coat: F::select(coat.smooth, own_mirror.max_lane(), self.under * coat_back),
            fuzz: fuzz_back * (self.p.fuzz * live).max_lane(),
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
        self.coat.mirrored = own_mirror;
    }
}

/// A direction in the frame that is brushed along its first tangent.
#[inline(always)]
pub(super) fn turned<F: Float>(p: &Params<F>, w: Vec3<F>) -> Vec3<F> {
    if !p.turned.any() {
        return w;
    }
    let [c, s] = p.along;
    Vec3::select(p.turned, Vec3::new(w.x * c + w.y * s, w.y * c - w.x * s, w.z), w)
}

/// From that frame.
#[inline(always)]
pub(super) fn turned_back<F: Float>(p: &Params<F>, w: Vec3<F>) -> Vec3<F> {
    if !p.turned.any() {
        return w;
    }
    let [c, s] = p.along;
    Vec3::select(p.turned, Vec3::new(w.x * c - w.y * s, w.y * c + w.x * s, w.z), w)
}

/// The frame of a coat whose normal isn't that of the base; bent where the viewer would see it from behind, as shading normals are.
#[inline(always)]
fn leaning<F: Float>(p: &Params<F>, wo: Vec3<F>) -> Frame<F> {
    let up = Vec3::new(F::ZERO, F::ZERO, F::ONE);
    let (n, _) = shading_normals(turned(p, p.coat_normal), up, wo);
    let (s, there) = (Vec3::new(F::ONE, F::ZERO, F::ZERO) - n * n.x).normalize_checked();
    let any = Frame::from_normal(n);
    let s = Vec3::select(there, s, any.s);
    Frame { s, t: n.cross(s), n }
}

impl<F: Float> Coat<F> {
    /// A direction in its frame.
    #[inline(always)]
    pub fn local(&self, w: Vec3<F>) -> Vec3<F> {
        if !self.leans.any() {
            return w;
        }
        Vec3::select(self.leans, self.frame.to_local(w), w)
    }

    /// From its frame.
    #[inline(always)]
    pub fn above(&self, w: Vec3<F>) -> Vec3<F> {
        if !self.leans.any() {
            return w;
        }
        Vec3::select(self.leans, self.frame.to_world(w), w)
    }

    /// The cosine of a direction to its normal, 0 below it.
    #[inline(always)]
    pub fn cos(&self, w: Vec3<F>) -> F {
        if !self.leans.any() {
            return w.z;
        }
        F::select(self.leans, self.frame.n.dot(w).max(F::ZERO), w.z)
    }

    /// What it reflects of light at a cosine.
    #[inline(always)]
    pub fn reflects(&self, cos: F) -> F {
        F::select(self.smooth, interface::dielectric(cos, self.eta), F::ONE - self.rough.opaque(cos))
    }

    /// What is left of light that crosses it at a cosine: the colour is that of crossing it twice straight.
    #[inline(always)]
    pub fn passage(&self, cos: F) -> Light<F> {
        if !is_any(Light::splat(F::ONE) - self.tint) {
            return Light::splat(F::ONE);
        }
        let longer = F::splat(0.5) / interface::refracted_cos(cos, self.eta);
        let along = self.tint.map(
            #[inline(always)]
            |t| F::select(t.gt(F::ZERO), ops::pow(t, longer), F::ZERO),
        );
        Light::splat(F::ONE).mix(along, self.presence)
    }
}

impl<F: Float> Boundary<F> {
    /// What a facet seen at a cosine reflects, and what it lets pass.
    #[inline(always)]
    pub fn share(&self, cos: F) -> (Light<F>, Light<F>) {
        F::vectorize(
            #[inline(always)]
            || self.share_here(cos),
        )
    }

    #[inline(always)]
    fn share_here(&self, cos: F) -> (Light<F>, Light<F>) {
        let share = reflected(self.eta, cos);
        let mut share_opaque = share;
        if (self.inside & self.reflects_opaque.max_lane().gt(F::ZERO)).any() {
            share_opaque = reflected(self.eta_opaque, cos);
        }
        let mut back = self.reflects * share + self.reflects_opaque * share_opaque;
        let mut through = self.passes * (Light::splat(F::ONE) - share);
        let has_metal = self.metal.gt(F::ZERO).any();
        if has_metal {
            back += interface::metal(cos, self.f0, self.edge) * self.metal;
        }
        if film::is_any(self.film.presence) {
            let share = self.film.reflects(cos, self.below, Light::splat(F::ZERO), self.nm);
            let mut filmed = (self.reflects + self.reflects_opaque) * share;
            if has_metal {
                let [n, k] = film::metal(self.f0, self.edge);
                filmed += self.film.reflects(cos, n, k, self.nm) * self.metal;
            }
            let there = self.film.presence.gt(F::ZERO);
            let passes = self.passes * (Light::splat(F::ONE) - share);
            back = Light::select(there, back.mix(filmed, self.film.presence), back);
            through = Light::select(there, through.mix(passes, self.film.presence), through);
        }
        (back + self.window, through)
    }
}

/// [`interface::dielectric`] of each lane; of one where all are the same.
#[inline(always)]
fn reflected<F: Float>(eta: Light<F>, cos: F) -> Light<F> {
    let [a, b, c, d] = eta.0;
    let first = interface::dielectric(cos, a);
    if (a.eq(b) & a.eq(c) & a.eq(d)).all() {
        return Light::splat(first);
    }
    Light([
        first,
        interface::dielectric(cos, b),
        interface::dielectric(cos, c),
        interface::dielectric(cos, d),
    ])
}

/// GGX's alpha along and across of a roughness.
#[inline(always)]
fn alphas<F: Float>(alpha: F, anisotropy: F) -> [F; 2] {
    let less = F::ONE - anisotropy;
    let along = alpha * (F::splat(2.0) / (F::ONE + less * less)).sqrt();
    [along, along * less]
}

/// An index of refraction at a wavelength, by Cauchy's formula for an Abbe number of 20 / `dispersion`: exact at the lines of
/// hydrogen (656.3 and 486.1 nm) and helium (587.6 nm) of which that is made.
#[inline(always)]
fn dispersed<F: Float>(eta: F, dispersion: F, nm: F) -> F {
    const D: f32 = 1.0 / (587.6 * 587.6);
    const SPREAD: f32 = 1.0 / (486.1 * 486.1) - 1.0 / (656.3 * 656.3);
    let below = eta.lt(F::ONE);
    let n = F::select(below, F::ONE / eta, eta);
    let there = dispersion.gt(F::ZERO);
    let n = n + (n - F::ONE) * dispersion * (F::ONE / (nm * nm) - F::splat(D)) * (1.0 / (20.0 * SPREAD));
    F::select(there, F::select(below, F::ONE / n, n), eta)
}

/// Away from 1, on its side of it.
#[inline(always)]
fn away_from_one<F: Float>(eta: F) -> F {
    F::select(eta.ge(F::ONE), eta.max(F::splat(LEAST_INDEX)), eta.min(F::splat(1.0 / LEAST_INDEX)))
}
