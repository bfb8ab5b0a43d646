//! # Principled
//!
//! Disney's BSDF (Burley 2012, "Physically Based Shading at Disney", and 2015, "Extending the Disney BRDF to a BSDF with Integrated Subsurface
//! Scattering") in the form that Mitsuba 3 has it, exactly: what a scene of Mitsuba calls `principled` comes out the same.
//!
//! A part `metallic` is metal in the base's colour (Schlick); of the rest a part `spec_trans` is rough glass, tinted by the root of the base's
//! colour at each crossing; the rest is diffuse after Burley, with retro-reflection by roughness and, by `flatness`, flattened as if light
//! scattered beneath (after Hanrahan and Krueger 1993). All have one GGX lobe, of alpha = roughness², stretched by `anisotropic`. `clearcoat` adds a lobe of
//! Berry's distribution (GTR1) and `sheen` one at grazing angles.
//!
//! It is reciprocal. Energy isn't conserved: what bounces between facets is lost, and sheen and retro-reflection are added without anything being taken away
//! for them.

use std::f32::consts::{FRAC_1_PI, PI, TAU};

use straal_color::Light;
use straal_math::simd::{Float, Mask};
use straal_math::{Vec3, ops, warp};
use straal_scene::desc;

use super::many::{self, These};
use super::microfacet::Facets;
use super::open_pbr::{ggx, interface};
use super::relative::RANGE;
use super::{Bsdf, BsdfSample, Recipe, Scatter, Transport, Wants};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// Disney's parameters, by Mitsuba's names.
#[derive(Clone, Debug, PartialEq)]
pub struct PrincipledMaterial {
    /// The colour of what is diffuse and of metal.
    pub base_color: Value<Colour>,
    /// The root of GGX's alpha.
    pub roughness: Value<f32>,
    /// How much smoother it is across the texture's u than along it.
    pub anisotropic: Value<f32>,
    /// Which part is metal.
    pub metallic: Value<f32>,
    /// Which part of the rest is glass.
    pub spec_trans: Value<f32>,
    /// Index of refraction inside over that outside.
    pub eta: Value<f32>,
    /// What is reflected straight on, in 8 hundredths, which tells the index where it is a texture.
    pub specular: Option<Value<f32>>,
    /// How much of the base's colour the glossy reflection has.
    pub spec_tint: Value<f32>,
    /// How much sheen.
    pub sheen: Value<f32>,
    /// How much of the base's colour the sheen has.
    pub sheen_tint: Value<f32>,
    /// How much of the diffuse part is flattened.
    pub flatness: Value<f32>,
    /// How much of the clearcoat.
    pub clearcoat: Value<f32>,
    /// How smooth it is.
    pub clearcoat_gloss: Value<f32>,
    /// Whether the back of what is opaque looks like the front; else it is black.
    pub two_sided: bool,
}

impl Recipe for PrincipledMaterial {
    type Described = desc::Principled;

    fn of(d: &desc::Principled, paint: &mut Paint<'_>) -> Self {
        let spec_trans = paint.number(&d.spec_trans);
        let bends = spec_trans.most() > 0.0;
        let told = d.specular.clone().unwrap_or(0.5.into());
        let by_specular = |v: &f64| (bending(index_of(*v, bends), bends) as f32).into();
        let (eta, specular) = match (&d.eta, told.constant()) {
            (Some(desc::Varying::Constant(eta)), _) => ((bending(*eta, bends) as f32).into(), None),
            (Some(eta), _) => (paint.number_within(eta, RANGE), None),
            (None, Some(specular)) => (by_specular(specular), None),
            (None, None) => (1.5.into(), Some(paint.number_within(&told, [0.0, 1.0]))),
        };
        Self {
            base_color: paint.reflectance(&d.base_color),
            roughness: paint.number(&d.roughness),
            anisotropic: paint.number(&d.anisotropic),
            metallic: paint.number(&d.metallic),
            spec_trans,
            eta,
            specular,
            spec_tint: paint.number(&d.spec_tint),
            sheen: paint.number(&d.sheen),
            sheen_tint: paint.number(&d.sheen_tint),
            flatness: paint.number(&d.flatness),
            clearcoat: paint.number(&d.clearcoat),
            clearcoat_gloss: paint.number(&d.clearcoat_gloss),
            two_sided: d.two_sided,
        }
    }

    fn wants(&self) -> Wants {
        let numbers = [
            &self.roughness,
            &self.anisotropic,
            &self.metallic,
            &self.spec_trans,
            &self.spec_tint,
            &self.sheen,
            &self.sheen_tint,
            &self.flatness,
            &self.clearcoat,
            &self.clearcoat_gloss,
            &self.eta,
        ];
        let tangent = self.anisotropic.most() > 0.0;
        let varies =
            self.base_color.varies() || self.specular.is_some() || numbers.iter().any(|v| v.varies());
        Wants { point: varies || tangent, tangent }
    }

    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let number = |v: &Value<f32>| reading.eval(v, at);
        let base = reading.eval(&self.base_color, at);
        // The colour is told from its strength by its luminance; of four wavelengths by their mean.
        let [a, b, c, d] = base.0;
        let luminance = match reading.lanes.bins() {
            None => 0.212_671 * a + 0.715_16 * b + 0.072_169 * c,
            Some(_) => 0.25 * (a + b + c + d),
        };
        Bsdf::Principled(Principled {
            base,
            luminance,
            roughness: number(&self.roughness),
            anisotropic: number(&self.anisotropic),
            metallic: number(&self.metallic),
            spec_trans: number(&self.spec_trans),
            eta: self.eta_at(at, reading),
            spec_tint: number(&self.spec_tint),
            sheen: number(&self.sheen),
            sheen_tint: number(&self.sheen_tint),
            flatness: number(&self.flatness),
            clearcoat: number(&self.clearcoat),
            clearcoat_gloss: number(&self.clearcoat_gloss),
            two_sided: self.two_sided,
            rgb: reading.lanes.bins().is_none(),
        })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let half = || Value::from(0.5);
        vec![(
            Self {
                base_color: Light::rgb([0.5; 3]).into(),
                roughness: half(),
                anisotropic: Value::from(0.0),
                metallic: half(),
                spec_trans: half(),
                eta: 1.5.into(),
                specular: None,
                spec_tint: half(),
                sheen: half(),
                sheen_tint: half(),
                flatness: half(),
                clearcoat: half(),
                clearcoat_gloss: half(),
                two_sided: true,
            },
            super::BsdfKind::Principled,
        )]
    }
}

impl PrincipledMaterial {
    /// The index at a point.
    #[inline]
    fn eta_at<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        if let (Value::Constant(eta), None) = (self.eta, &self.specular) {
            return eta;
        }
        let bends = self.spec_trans.most() > 0.0;
        let eta = match &self.specular {
            Some(specular) => index_of(f64::from(reading.eval(specular, at)), bends),
            None => f64::from(reading.eval(&self.eta, at)),
        };
        bending(eta, bends) as f32
    }
}

/// The index that reflects so many 8 hundredths straight on.
fn index_of(specular: f64, bends: bool) -> f64 {
    let specular = if bends && specular == 0.0 { 1e-3 } else { specular };
    2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0
}

/// Glass must bend light.
fn bending(eta: f64, bends: bool) -> f64 {
    if bends && eta == 1.0 { 1.001 } else { eta }
}

/// [`PrincipledMaterial`] at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // as those of the material
pub struct Principled {
    pub base: Light,
    /// Of the base, by which its colour is told from its strength.
    pub luminance: f32,
    pub roughness: f32,
    pub anisotropic: f32,
    pub metallic: f32,
    pub spec_trans: f32,
    pub eta: f32,
    pub spec_tint: f32,
    pub sheen: f32,
    pub sheen_tint: f32,
    pub flatness: f32,
    pub clearcoat: f32,
    pub clearcoat_gloss: f32,
    pub two_sided: bool,
    /// The fourth lane is dead.
    pub rgb: bool,
}

/// The lobes side by side, seen from one direction.
struct Lobes<F: Float> {
    wo: Vec3<F>,
    side: F,
    seen: F::Mask,
    /// Whether that is from outside.
    front: F::Mask,
    live: Light<F>,
    base: Light<F>,
    /// The base's colour, of luminance 1.
    hue: Light<F>,
    roughness: F,
    metallic: F,
    eta_inside: F,
    /// Index of refraction beyond over before.
    eta: F,
    spec_tint: F,
    sheen: Light<F>,
    flatness: F,
    clearcoat: F,
    coat_alpha: F,
    /// Weights of what is diffuse and of glass.
    diffuse: F,
    glass: F,
    facets: Facets<F>,
    bound: F,
    /// Chances of what is diffuse and of the clearcoat; the rest is the facets'.
    chance_diffuse: F,
    chance_coat: F,
}

/// Schlick's power of a cosine.
#[inline(always)]
fn fifth<F: Float>(cos: F) -> F {
    let m = (F::ONE - cos).max(F::ZERO).min(F::ONE);
    let square = m * m;
    square * square * m
}

#[inline(always)]
fn lerp<F: Float>(a: F, b: F, by: F) -> F {
    a + (b - a) * by
}

impl<F: Float> Lobes<F> {
    #[inline(always)]
    fn new(these: impl These<Principled>, wo: Vec3<F>) -> Self {
        let (zero, one) = (F::ZERO, F::ONE);
        macro_rules! column {
            ($field:ident) => {
                many::each::<Principled, F>(
                    these,
                    #[inline(always)]
                    |p: &Principled| p.$field,
                )
            };
        }
        macro_rules! mask {
            ($field:ident) => {
                many::which::<Principled, F>(
                    these,
                    #[inline(always)]
                    |p: &Principled| p.$field,
                )
            };
        }
        let base = many::light::<Principled, F>(
            these,
            #[inline(always)]
            |p: &Principled| p.base,
        );
        let (metallic, spec_trans) = (column!(metallic), column!(spec_trans));
        let glass = (one - metallic) * spec_trans;
        let diffuse = (one - metallic) * (one - spec_trans);
        let behind = wo.z.lt(zero);
        // What is opaque may look the same from behind.
        let turned = behind & glass.le(zero) & mask!(two_sided);
        let front = !behind | turned;
        let seen = wo.z.gt(zero) | behind & (glass.gt(zero) | turned);
        let side = F::select(behind, -one, one);
        let wo = Vec3::new(wo.x, wo.y, wo.z * side);
        let eta_inside = column!(eta);
        let luminance = column!(luminance);
        let by = one / F::select(luminance.gt(zero), luminance, one);
        let hue = Light::select(luminance.gt(zero), base * by, Light::splat(F::ONE));
        let roughness = column!(roughness);
        let alpha = roughness * roughness;
        let aspect = (one - column!(anisotropic) * 0.9).sqrt();
        let least = F::splat(0.001);
        let facets = ggx([(alpha / aspect).max(least), (alpha * aspect).max(least)]);
        let has_sheen = diffuse.gt(zero);
        let sheen_weight = F::select(has_sheen, column!(sheen) * (one - metallic), zero);
        let dead = F::select(mask!(rgb), zero, one);
        let mut lobes = Self {
            wo,
            side,
            seen,
            front,
            live: Light([one, one, one, dead]),
            base,
            hue,
            roughness,
            metallic,
            eta_inside,
            eta: F::select(front, eta_inside, one / eta_inside),
            spec_tint: column!(spec_tint),
            sheen: Light::splat(F::ONE).mix(hue, column!(sheen_tint)) * sheen_weight,
            flatness: column!(flatness),
            clearcoat: F::select(front, column!(clearcoat), zero),
            coat_alpha: lerp(F::splat(0.1), F::splat(0.001), column!(clearcoat_gloss)),
            diffuse: F::select(front, diffuse, zero),
            glass,
            facets,
            bound: F::select(glass.gt(zero), one, facets.bound(wo)),
            chance_diffuse: zero,
            chance_coat: zero,
        };
        // Estimates of what each lobe scatters.
        let (back, through) = lobes.share(wo.z);
        let even =
            (lobes.base * lobes.diffuse + lobes.sheen * F::select(front, F::splat(0.1), zero)).max_lane();
        let coat = lobes.clearcoat * lerp(F::splat(0.04), one, fifth(wo.z)) * 0.25;
        let sum = even + coat + (back + through).max_lane();
        let by = F::select(sum.gt(zero), one / sum, zero);
        lobes.chance_diffuse = even * by;
        lobes.chance_coat = coat * by;
        lobes
    }

    /// What a facet reflects and lets pass.
    #[inline(always)]
    fn share(&self, cos: F) -> (Light<F>, Light<F>) {
        let one = F::ONE;
        let f = interface::dielectric(cos, self.eta);
        // Towards what is thinner, Schlick's curve goes by the refracted direction.
        let slope = F::select(
            self.eta_inside.gt(one),
            fifth(cos),
            fifth(interface::refracted_cos(cos, self.eta_inside)),
        );
        let facing = interface::facing(self.eta_inside);
        let metal = self.base.mix(Light::splat(F::ONE), slope) * self.metallic;
        let tinted =
            (self.hue * facing).mix(Light::splat(F::ONE), slope) * ((one - self.metallic) * self.spec_tint);
        let clear = Light::splat((one - self.metallic) * (one - self.spec_tint) * f);
        let back = Light::select(self.front, metal + tinted + clear, Light::splat(self.glass * f));
        let root = self.base.map(
            #[inline(always)]
            |v| v.max(F::ZERO).sqrt(),
        );
        // Where nothing is reflected by Fresnel's equations Mitsuba has no facets at all.
        (back.only(f.gt(F::ZERO)) * self.live, root * (self.glass * (one - f)) * self.live)
    }

    #[inline(always)]
    fn part(back: Light<F>, through: Light<F>) -> F {
        let (back, through) = (back.max_lane(), through.max_lane());
        F::select((back + through).gt(F::ZERO), back / (back + through), F::ONE)
    }

    /// Berry's distribution of facets.
    #[inline(always)]
    fn coat_density(&self, cos: F) -> F {
        let a2 = self.coat_alpha * self.coat_alpha;
        (a2 - F::ONE) / (ops::ln(a2) * (F::ONE + (a2 - F::ONE) * cos * cos) * PI)
    }

    /// f |cos| of radiance and the density.
    #[inline(always)]
    fn eval(&self, wi: Vec3<F>) -> (Light<F>, F) {
        let (zero, one) = (F::ZERO, F::ONE);
        let wi = Vec3::new(wi.x, wi.y, wi.z * self.side);
        let (up, down) = (wi.z.gt(zero) & self.seen, wi.z.lt(zero) & self.seen);
        let chance_facets = one - self.chance_diffuse - self.chance_coat;
        let h = self.wo + wi;
        let square = h.length_squared();
        let up = up & square.gt(F::splat(f32::MIN_POSITIVE));
        let by = one / square.sqrt();
        let cos = (self.wo.dot(h) * by).max(zero).min(one);

        let density = self.facets.density(h);
        let shape = density * self.facets.reflects_within(self.wo, one) * self.facets.seen(wi);
        let (back, through) = self.share(cos);
        let mut value = (back * shape).only(up);
        let drawn = density * self.facets.reflects_within(self.wo, self.bound) * Self::part(back, through);
        let mut pdf = F::select(up, chance_facets * drawn, zero);

        let bent = down & self.glass.gt(zero);
        if bent.any() {
            let m = self.wo + wi * self.eta;
            let square = m.length_squared();
            let is_right = m.z.lt(zero) ^ self.eta.lt(one);
            let (before, beyond) = (self.wo.dot(m), wi.dot(m));
            let on = bent & is_right & (before * beyond).lt(zero) & square.gt(F::splat(1e-10));
            let cos = (before.abs() / square.sqrt()).min(one);
            let shape = self.facets.density(m)
                * self.facets.reflects_within(self.wo, one)
                * 4.0
                * (before * beyond).abs()
                / (square * square);
            let (back, through) = self.share(cos);
            let seen = self.facets.seen(Vec3::new(wi.x, wi.y, -wi.z));
            value += (through * (shape * seen)).only(on);
            let drawn = shape * self.eta * self.eta * (one - Self::part(back, through));
            pdf += F::select(on, chance_facets * drawn, zero);
        }

        let outside = up & self.front;
        if (outside & self.clearcoat.gt(zero)).any() {
            let along = h.z * by;
            let density = self.coat_density(along);
            let share = lerp(
                F::splat(0.04),
                one,
                fifth(F::select(
                    self.eta_inside.gt(one),
                    cos,
                    interface::refracted_cos(cos, self.eta_inside),
                )),
            );
            // The shadowing is always that of a roughness of 1/4.
            let quarter = ggx([F::splat(0.25); 2]);
            let shadow = quarter.seen(self.wo) * quarter.seen(wi);
            let f = self.clearcoat * 0.25 * share * density * shadow * wi.z;
            value += (self.live * f).only(outside);
            pdf += F::select(outside, self.chance_coat * density * along / (cos * 4.0), zero);
        }
        let even = outside & self.diffuse.gt(zero);
        if even.any() {
            let (fo, fi) = (fifth(wi.z), fifth(self.wo.z));
            let retro = self.roughness * cos * cos * 2.0;
            let plain = (one - fi * 0.5) * (one - fo * 0.5) + retro * (fo + fi + fo * fi * (retro - one));
            let grazing = retro * 0.5;
            let flat = lerp(one, grazing, fo) * lerp(one, grazing, fi);
            let flat = (flat * (one / (wi.z + self.wo.z) - F::splat(0.5)) + F::splat(0.5)) * 1.25;
            let f = lerp(plain, flat, self.flatness) * FRAC_1_PI;
            let all = self.base * (self.diffuse * f) + self.sheen * fifth(cos);
            value += (all * wi.z).only(even) * self.live;
        }
        pdf += F::select(outside, self.chance_diffuse * wi.z * FRAC_1_PI, zero);
        (value, pdf)
    }

    /// A direction, and where there is one.
    #[inline(always)]
    fn draw(&self, u_lobe: F, u: [F; 2]) -> (Vec3<F>, F::Mask) {
        let (zero, one) = (F::ZERO, F::ONE);
        let even = u_lobe.lt(self.chance_diffuse);
        let both = self.chance_diffuse + self.chance_coat;
        let coat = !even & u_lobe.lt(both);
        let rest = ((u_lobe - both) / (one - both).max(F::splat(1e-9))).min(one);
        let m = self.facets.sample_within(self.wo, u, self.bound);
        let cos = self.wo.dot(m);
        let (back, through) = self.share(cos.max(zero).min(one));
        let bends = !even & !coat & rest.ge(Self::part(back, through));
        let reflected = m * (cos * 2.0) - self.wo;
        let mut wi = reflected;
        let mut any = reflected.z.gt(zero) & !bends;
        if bends.any() {
            let refracted = interface::refracted_cos(cos, self.eta);
            let bent = m * (cos / self.eta - refracted) - self.wo * (one / self.eta);
            wi = Vec3::select(bends, bent, wi);
            any = any | bends & bent.z.lt(zero) & refracted.gt(zero);
        }
        if even.any() {
            let d = warp::cosine_hemisphere(u);
            wi = Vec3::select(even, d, wi);
            any = F::select(even, d.z, F::select(any, one, zero)).gt(zero);
        }
        if coat.any() {
            let a2 = self.coat_alpha * self.coat_alpha;
            let cos2 = (one - ops::pow(a2, one - u[1])) / (one - a2);
            let (cos, sin) = (cos2.max(zero).min(one).sqrt(), (one - cos2).max(zero).sqrt());
            let (s, c) = ops::sin_cos(u[0] * TAU);
            let m = Vec3::new(c * sin, s * sin, cos);
            let along = self.wo.dot(m);
            let reflected = m * (along * 2.0) - self.wo;
            wi = Vec3::select(coat, reflected, wi);
            let here = F::select(along.gt(zero), reflected.z, zero);
            any = F::select(coat, here, F::select(any, one, zero)).gt(zero);
        }
        (Vec3::new(wi.x, wi.y, wi.z * self.side), any & self.seen)
    }
}

impl<F: Float> Lobes<F> {
    /// Of a transport, and nothing where there are no numbers.
    #[inline(always)]
    fn value(&self, wi: Vec3<F>, transport: Transport) -> (Light<F>, F) {
        let (mut value, pdf) = self.eval(wi);
        if transport == Transport::Importance {
            // Importance isn't compressed where it passes.
            let passes = (wi.z * self.side).lt(F::ZERO);
            value *= F::select(passes, self.eta * self.eta, F::ONE);
        }
        let is_fine = value.is_finite() & pdf.ge(F::ZERO) & pdf.is_finite();
        (value.only(is_fine), F::select(is_fine, pdf, F::ZERO))
    }

    #[inline(always)]
    fn sample(&self, [u_lobe, u, v]: [F; 3], transport: Transport) -> (BsdfSample<F>, F::Mask) {
        let (wi, any) = self.draw(u_lobe, [u, v]);
        let (value, pdf) = self.value(wi, transport);
        let weight = value * (F::ONE / pdf);
        let transmitted = (wi.z * self.side).lt(F::ZERO);
        let sample = BsdfSample {
            transmitted,
            eta: F::select(transmitted, self.eta, F::ONE),
            ..BsdfSample::reflected(wi, weight, pdf)
        };
        (sample, any & pdf.gt(F::ZERO) & weight.is_finite())
    }
}

impl Scatter for Principled {
    const CHOOSES_LOBE: bool = true;

    const SIDE_BY_SIDE: bool = true;

    fn is_delta(&self) -> bool {
        false
    }

    fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Light, f32) {
        Lobes::new(self, wo).value(wi, transport)
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, [u, v]: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        let (sample, there) = Lobes::new(self, wo).sample([u_lobe, u, v], transport);
        there.then_some(sample)
    }

    #[inline(always)]
    fn eval_pdf_many<F: Float>(
        these: impl These<Self>,
        [wo, wi]: [Vec3<F>; 2],
        transport: Transport,
    ) -> (Light<F>, F) {
        // In a function of its own, as it is asked in several places.
        F::vectorize(
            #[inline(always)]
            || Lobes::new(these, wo).value(wi, transport),
        )
    }

    #[inline(always)]
    fn sample_many<F: Float>(
        these: impl These<Self>,
        wo: Vec3<F>,
        u: [F; 3],
        transport: Transport,
    ) -> (BsdfSample<F>, F::Mask) {
        F::vectorize(
            #[inline(always)]
            || Lobes::new(these, wo).sample(u, transport),
        )
    }

    fn albedo(&self) -> Light {
        self.base
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::Example;
        let plain = Self {
            base: Light::rgb([0.8, 0.5, 0.3]),
            luminance: 0.55,
            roughness: 0.5,
            anisotropic: 0.0,
            metallic: 0.0,
            spec_trans: 0.0,
            eta: 1.5,
            spec_tint: 0.0,
            sheen: 0.0,
            sheen_tint: 0.0,
            flatness: 0.0,
            clearcoat: 0.0,
            clearcoat_gloss: 0.0,
            two_sided: true,
            rgb: true,
        };
        // Sheen and retro-reflection come on top.
        let one = |name, p| Example::new(name, Bsdf::Principled(p)).focus(2).gives_energy();
        vec![
            one("principled, plastic", Self { spec_tint: 0.5, flatness: 0.4, ..plain }),
            one("principled, brushed", Self { metallic: 0.9, anisotropic: 0.8, ..plain }),
            one("principled, lacquer", Self { clearcoat: 1.0, ..plain }).focus(4),
            one("principled, cloth", Self { sheen: 1.0, sheen_tint: 0.5, roughness: 0.9, ..plain }),
            one("principled, glass", Self { spec_trans: 0.9, roughness: 0.6, ..plain }).passes(),
        ]
    }
}
