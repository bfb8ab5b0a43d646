//! # Coated diffuse, coated conductor
//!
//! A clear coat over a diffuse ground or over metal, as pbrt's `coateddiffuse` and `coatedconductor`: varnish, car paint, tarnish. Between the coat's boundary, smooth or
//! rough, and the ground lies a layer of some `thickness` that absorbs (sigma = 1 / m, so that `thickness` is an optical depth) and may scatter (`albedo`, by Henyey and
//! Greenstein's phase function of mean cosine `g`).
//!
//! No formula tells what comes out of it. As in pbrt (Guo, Hašan and Zhao 2018, "Position-Free Monte Carlo Simulation for Arbitrary Layered BSDFs") light is
//! followed from boundary to ground and back, by random numbers that are made of the two directions: the same pair gives the same value, which is right on average. Unlike
//! there directions are drawn by a density that is known: the coat's reflection, a lobe as wide as that of the ground seen through the coat, and an even one.
//!
//! Energy is conserved, but for facets, at which light is lost that would bounce more than once, and for paths longer than `max_depth`. Reciprocity holds on
//! average.

use std::f32::consts::{FRAC_1_PI, TAU};

use straal_color::Light;
use straal_math::{Frame, Vec3, ops, warp};
use straal_scene::desc;

use super::microfacet::Facets;
use super::mirror::reflected;
use super::{Bsdf, BsdfSample, Metal, Recipe, Scatter, Transport, Wants, facing, fresnel};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// What a coat is, wherever it is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// Index of refraction of the coat over that outside.
    pub eta: f32,
    /// Optical depth of the layer below its boundary.
    pub thickness: f32,
    /// Mean cosine of what scatters in it.
    pub g: f32,
    /// Most boundaries and events in the layer that light is followed to.
    pub max_depth: u32,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
    /// Whether it lies over metal.
    pub over_metal: bool,
}

/// A coat, its roughness and what it scatters, as a scene says them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatMaterial {
    /// What of it is the same everywhere.
    coat: Coat,
    eta: Value<f32>,
    thickness: Value<f32>,
    g: Value<f32>,
    roughness: Value<f32>,
    albedo: Value<Colour>,
}

impl CoatMaterial {
    fn of(d: &desc::Coat, over_metal: bool, paint: &mut Paint<'_>) -> Self {
        let eta = paint.number_within(&d.coat_eta, [1.0001, 10.0]);
        let thickness = paint.number_within(&d.thickness, [1e-6, 1e3]);
        let g = paint.number_within(&d.g, [-0.99, 0.99]);
        let same = |v: &Value<f32>| if let Value::Constant(v) = v { *v } else { 1.0 };
        let coat = Coat {
            eta: same(&eta),
            thickness: same(&thickness),
            g: same(&g),
            max_depth: d.max_depth,
            two_sided: d.two_sided,
            over_metal,
        };
        let (roughness, albedo) = (paint.number(&d.coat_roughness), paint.reflectance(&d.albedo));
        Self { coat, eta, thickness, g, roughness, albedo }
    }

    /// What it is at a point.
    #[inline]
    fn at<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> Coat {
        let [eta, thickness, g] = [&self.eta, &self.thickness, &self.g].map(|v| reading.eval(v, at));
        Coat { eta, thickness, g, ..self.coat }
    }

    #[cfg(test)]
    fn plain(coat: Coat) -> Self {
        let [eta, thickness, g] = [coat.eta, coat.thickness, coat.g].map(Value::Constant);
        Self { coat, eta, thickness, g, roughness: 0.0.into(), albedo: Light::ZERO.into() }
    }

    fn varies(&self) -> bool {
        let numbers = [&self.roughness, &self.eta, &self.thickness, &self.g];
        self.albedo.varies() || numbers.iter().any(|v| v.varies())
    }

    fn over<'w, L: Lanes>(
        &self,
        (coat, base, roughness): (Coat, [Light; 2], f32),
        at: &ShadingPoint,
        reading: &Reading<'w, L>,
    ) -> Bsdf<'w> {
        let albedo = reading.eval(&self.albedo, at);
        let alpha = [reading.eval(&self.roughness, at), roughness];
        Bsdf::Coated(Coated { coat, base, albedo, alpha })
    }
}

/// A coat over a ground that scatters evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatedDiffuseMaterial {
    /// Share of light that the ground reflects.
    pub reflectance: Value<Colour>,
    coat: CoatMaterial,
}

impl Recipe for CoatedDiffuseMaterial {
    type Described = desc::CoatedDiffuse;

    fn of(d: &desc::CoatedDiffuse, paint: &mut Paint<'_>) -> Self {
        let coat = CoatMaterial::of(&d.coat, false, paint);
        Self { reflectance: paint.reflectance(&d.reflectance), coat }
    }

    fn wants(&self) -> Wants {
        Wants::point(self.reflectance.varies() || self.coat.varies())
    }

    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let ground = reading.eval(&self.reflectance, at);
        self.coat.over((self.coat.at(at, reading), [ground, reading.lanes.full()], 0.0), at, reading)
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let coat = CoatMaterial::plain(LACQUER);
        vec![(Self { reflectance: super::testing::WHITE.into(), coat }, super::BsdfKind::Coated)]
    }
}

/// A coat over metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatedConductorMaterial {
    /// Real part of the metal's index of refraction, relative to the outside.
    pub eta: Value<Colour>,
    /// Imaginary part.
    pub k: Value<Colour>,
    /// Alpha of its facets; 0 is polished.
    pub roughness: Value<f32>,
    coat: CoatMaterial,
}

impl Recipe for CoatedConductorMaterial {
    type Described = desc::CoatedConductor;

    fn of(d: &desc::CoatedConductor, paint: &mut Paint<'_>) -> Self {
        let desc::CoatedConductor { metal, eta, k, .. } = d.clone();
        let [eta, k] = paint.metal(&desc::Conductor { metal, eta, k, ..desc::Conductor::default() });
        let coat = CoatMaterial::of(&d.coat, true, paint);
        Self { eta, k, roughness: paint.number(&d.roughness), coat }
    }

    fn wants(&self) -> Wants {
        let metal = self.eta.varies() || self.k.varies() || self.roughness.varies();
        Wants::point(metal || self.coat.varies())
    }

    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        // Against the coat, not against air.
        let coat = self.coat.at(at, reading);
        let base = [&self.eta, &self.k].map(|c| reading.eval(c, at) * (1.0 / coat.eta));
        self.coat.over((coat, base, reading.eval(&self.roughness, at)), at, reading)
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let Metal { eta, k, .. } = super::testing::gold();
        let coat = Coat { over_metal: true, ..LACQUER };
        let coat = CoatMaterial::plain(coat);
        vec![(Self { eta: eta.into(), k: k.into(), roughness: 0.2.into(), coat }, super::BsdfKind::Coated)]
    }
}

#[cfg(test)]
const LACQUER: Coat =
    Coat { eta: 1.5, thickness: 0.01, g: 0.0, max_depth: 10, two_sided: true, over_metal: false };

/// A coat over a diffuse ground or metal.
#[derive(Clone, Copy, Debug)]
pub struct Coated {
    /// What the coat is.
    pub coat: Coat,
    /// The ground's reflectance, and 1 in all lanes that carry light; or the metal's index of refraction against the coat, real and imaginary.
    pub base: [Light; 2],
    /// Share of light that the layer scatters of what it stops.
    pub albedo: Light,
    /// Roughness of the coat's boundary and of the metal.
    pub alpha: [f32; 2],
}

/// Random numbers made of a pair of directions.
struct Random(u32);

impl Random {
    fn of(wo: Vec3, wi: Vec3) -> Self {
        let mut all = 0x9e37_79b9_u32;
        for v in [wo.x, wo.y, wo.z, wi.x, wi.y, wi.z] {
            all = mixed(all ^ v.to_bits());
        }
        Self(all)
    }

    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9);
        (mixed(self.0) >> 8) as f32 / 16_777_216.0
    }

    fn pair(&mut self) -> [f32; 2] {
        [self.next(), self.next()]
    }
}

/// A permutation in which each bit flips half of the others (constants: Wellons 2018, "lowbias32").
fn mixed(x: u32) -> u32 {
    let x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Chances of the lobes by which directions are drawn.
struct Chances {
    top: f32,
    metal: f32,
}

impl Coated {
    fn top(&self) -> Option<Facets> {
        (self.alpha[0] > 0.0).then(|| Facets::new([self.alpha[0]; 2], desc::Distribution::Ggx))
    }

    fn ground(&self) -> Option<Facets> {
        (self.alpha[1] > 0.0).then(|| Facets::new([self.alpha[1]; 2], desc::Distribution::Ggx))
    }

    fn metal(&self) -> Metal {
        Metal { eta: self.base[0], k: self.base[1], reflectance: Light::ONE }
    }

    /// Whether the ground is a mirror.
    fn is_polished(&self) -> bool {
        self.coat.over_metal && self.alpha[1] <= 0.0
    }

    /// About as wide as the ground's highlight looks through the coat at a cosine: tilts are widened by refraction, the more the flatter it is
    /// seen.
    fn wide(&self, cos: f32) -> Facets {
        let (eta, [top, ground]) = (self.coat.eta, self.alpha);
        let through = (eta - 1.0) * top;
        let flat = fresnel::dielectric(cos, eta).cos_refracted / ops::max(cos, 0.1);
        let alpha = (eta * eta * ground * ground * flat + 0.5 * through * through).sqrt();
        Facets::new([ops::max(alpha, 0.02); 2], desc::Distribution::Ggx)
    }

    fn chances(&self, cos: f32) -> Chances {
        let share = fresnel::dielectric(cos, self.coat.eta).reflected;
        let metal = match (self.coat.over_metal, self.is_polished() && self.alpha[0] <= 0.0) {
            (true, false) if self.albedo.is_black() => 0.7,
            (true, false) => 0.5,
            _ => 0.0,
        };
        Chances { top: share, metal: (1.0 - share) * metal }
    }

    /// What is left of light after a way through the layer, from height to height, at a cosine.
    fn left(way: f32, cos: f32) -> f32 {
        ops::exp(-(way / ops::max(cos.abs(), 1e-6)))
    }

    /// The mirror image of a lamp: off the coat, and where the ground is polished as well, off that and all that bounces between.
    fn mirrored(&self, cos: f32) -> Light {
        let split = fresnel::dielectric(cos, self.coat.eta);
        let top = Light::splat(split.reflected);
        if !self.is_polished() || self.alpha[0] > 0.0 {
            return top;
        }
        // On the way down and up again.
        let a = Self::left(2.0 * self.coat.thickness, split.cos_refracted);
        let ground = self.metal().reflected(split.cos_refracted);
        let passed = (1.0 - split.reflected) * (1.0 - split.reflected) * a;
        top + ground.map(|f| passed * f / (1.0 - split.reflected * a * f))
    }

    /// Through the boundary: a direction below for one above, with what it weighs.
    fn enter(&self, w: Vec3, random: &mut Random, transport: Transport) -> Option<(Vec3, f32)> {
        let eta = self.coat.eta;
        let (m, seen) = match self.top() {
            None => (Vec3::Z, None),
            Some(facets) => (facets.sample(w, random.pair()), Some(facets)),
        };
        let towards = w.dot(m);
        if towards <= 0.0 {
            return None;
        }
        let split = fresnel::dielectric(towards, eta);
        let inverse = 1.0 / eta;
        let inside = w * -inverse + m * (inverse * towards - split.cos_refracted);
        let compression = match transport {
            Transport::Radiance => inverse * inverse,
            Transport::Importance => 1.0,
        };
        let shadowed = seen.map_or(1.0, |facets| facets.seen(inside));
        (inside.z < -1e-6).then_some((inside, (1.0 - split.reflected) * shadowed * compression))
    }

    /// Reflection at the boundary from within, of a direction upwards.
    fn turn_back(&self, w: Vec3, random: &mut Random) -> Option<(Vec3, f32)> {
        let inverse = 1.0 / self.coat.eta;
        let Some(facets) = self.top() else {
            return Some((Vec3::new(w.x, w.y, -w.z), fresnel::dielectric(w.z, inverse).reflected));
        };
        // Seen from below: as from above with z turned round.
        let v = Vec3::new(-w.x, -w.y, w.z);
        let m = facets.sample(v, random.pair());
        let towards = v.dot(m);
        let out = m * (2.0 * towards) - v;
        let weight = fresnel::dielectric(ops::max(towards, 0.0), inverse).reflected * facets.seen(out);
        (towards > 0.0 && out.z > 1e-6).then_some((Vec3::new(out.x, out.y, -out.z), weight))
    }

    /// f |cos| of the rough boundary for light that leaves it from within along `w` in the direction `wi`.
    fn leave(&self, w: Vec3, wi: Vec3) -> f32 {
        let Some(facets) = self.top() else { return 0.0 };
        let inverse = 1.0 / self.coat.eta;
        // `wo` within is -w; half-way between it and `wi` by their indices.
        let h = -w + wi * inverse;
        let h = if h.z < 0.0 { -h } else { h };
        let Some(m) = h.try_normalize() else { return 0.0 };
        let (towards_o, towards_i) = (-w.dot(m), wi.dot(m));
        if towards_o >= 0.0 || towards_i <= 0.0 {
            return 0.0;
        }
        let share = fresnel::dielectric(-towards_o, inverse).reflected;
        let sum = towards_o + inverse * towards_i;
        let stretch = towards_i / (sum * sum);
        let value =
            (1.0 - share) * facets.density(m) * facets.seen(w) * facets.seen(wi) * -towards_o * stretch / w.z;
        if value.is_finite() { value } else { 0.0 }
    }

    /// f of the ground for directions above it.
    fn ground_value(&self, wo: Vec3, wi: Vec3) -> Light {
        if !self.coat.over_metal {
            return self.base[0] * FRAC_1_PI;
        }
        let Some(facets) = self.ground() else { return Light::ZERO };
        let h = wo + wi;
        let hh = h.length_squared();
        if hh <= f32::MIN_POSITIVE {
            return Light::ZERO;
        }
        let seen = facets.density(h) * facets.seen(wo) * facets.seen(wi) / (4.0 * wo.z * wi.z);
        self.metal().reflected(wo.dot(h) / hh.sqrt()) * seen
    }

    /// A direction off the ground, and what it weighs.
    fn bounce(&self, wo: Vec3, random: &mut Random) -> Option<(Vec3, Light)> {
        if !self.coat.over_metal {
            return Some((warp::cosine_hemisphere(random.pair()), self.base[0]));
        }
        let Some(facets) = self.ground() else {
            return Some((Vec3::new(-wo.x, -wo.y, wo.z), self.metal().reflected(wo.z)));
        };
        let m = facets.sample(wo, random.pair());
        let towards = wo.dot(m);
        let out = m * (2.0 * towards) - wo;
        (towards > 0.0 && out.z > 1e-6).then(|| (out, self.metal().reflected(towards) * facets.seen(out)))
    }

    /// Henyey and Greenstein's phase function (1941) of the cosine between the ways before and after.
    fn phase(&self, cos: f32) -> f32 {
        let g = self.coat.g;
        let d = 1.0 + g * g - 2.0 * g * cos;
        0.25 * FRAC_1_PI * (1.0 - g * g) / (d * d.sqrt())
    }

    fn scattered(&self, w: Vec3, [u, v]: [f32; 2]) -> Vec3 {
        let g = self.coat.g;
        let cos = if g.abs() < 1e-3 {
            1.0 - 2.0 * u
        } else {
            let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
            (1.0 + g * g - s * s) / (2.0 * g)
        };
        let sin = ops::max(1.0 - cos * cos, 0.0).sqrt();
        let (s, c) = ops::sin_cos(TAU * v);
        Frame::from_normal(w).to_world(Vec3::new(sin * c, sin * s, cos))
    }

    /// f |cos| of all light that goes below the boundary and comes out at `wi` again, on average; but for what is mirrored all the way.
    fn below(&self, wo: Vec3, wi: Vec3) -> Light {
        let mut random = Random::of(wo, wi);
        let Some((mut w, weight)) = self.enter(wo, &mut random, Transport::Radiance) else {
            return Light::ZERO;
        };
        let Some((last, out)) = self.enter(wi, &mut random, Transport::Importance) else {
            return Light::ZERO;
        };
        // Where light must go below to come out at `wi`; or, where the boundary is rougher than the metal, it is asked there.
        let v = -last;
        let asks_boundary = self.coat.over_metal && self.alpha[0] > self.alpha[1];
        let (thickness, out) = (self.coat.thickness, out * wi.z);
        let scatters = !self.albedo.is_black();
        let (mut beta, mut sum, mut z) = (Light::splat(weight), Light::ZERO, thickness);
        for depth in 0..self.coat.max_depth {
            if depth > 3 {
                let strength = beta.max_lane();
                if strength < 0.25 {
                    if random.next() >= strength {
                        break;
                    }
                    beta *= 1.0 / strength;
                }
            }
            let end = if w.z < 0.0 { 0.0 } else { thickness };
            if scatters {
                let way = -ops::ln(ops::max(1.0 - random.next(), 1e-7)) * w.z;
                if (w.z < 0.0 && z + way > 0.0) || (w.z > 0.0 && z + way < thickness) {
                    z += way;
                    beta *= self.albedo;
                    if !asks_boundary {
                        let up = self.phase(w.dot(v)) * Self::left(thickness - z, v.z);
                        sum += beta * (up * out / v.z);
                        if self.is_polished() {
                            let down = Vec3::new(v.x, v.y, -v.z);
                            let way = self.phase(w.dot(down)) * Self::left(z + thickness, v.z);
                            sum += beta * self.metal().reflected(v.z) * (way * out / v.z);
                        }
                    }
                    w = self.scattered(w, random.pair());
                    if w.z.abs() < 1e-6 {
                        break;
                    }
                    continue;
                }
            } else {
                beta *= Self::left((z - end).abs(), w.z);
            }
            z = end;
            let next = if w.z < 0.0 {
                if !asks_boundary {
                    sum += beta * self.ground_value(-w, v) * (out * Self::left(thickness, v.z));
                }
                self.bounce(-w, &mut random)
            } else {
                if asks_boundary {
                    sum += beta * self.leave(w, wi);
                }
                self.turn_back(w, &mut random).map(|(w, share)| (w, Light::splat(share)))
            };
            let Some((onward, weight)) = next else { break };
            w = onward;
            beta *= weight;
            if beta.is_black() {
                break;
            }
        }
        if sum.is_finite() { sum } else { Light::ZERO }
    }

    /// Value and density for directions above, without what is mirrored.
    fn on_front(&self, wo: Vec3, wi: Vec3) -> (Light, f32) {
        if wi.z <= 1e-6 {
            return (Light::ZERO, 0.0);
        }
        let Chances { top, metal } = self.chances(wo.z);
        let even = wi.z * FRAC_1_PI;
        let h = wo + wi;
        let mut pdf = (1.0 - top - metal) * even;
        if metal > 0.0 {
            pdf += metal * self.wide(wo.z).pdf_reflecting(wo, h);
        }
        let mut value = self.below(wo, wi);
        if let Some(facets) = self.top() {
            pdf += top * facets.pdf_reflecting(wo, h);
            let share = fresnel::dielectric(wo.dot(h) / h.length(), self.coat.eta).reflected;
            let seen = facets.density(h) * facets.seen(wo) * facets.seen(wi) / (4.0 * wo.z);
            value += Light::splat(share * seen);
        }
        (self.alive(value), pdf)
    }

    /// Lanes without light stay so: what the boundary reflects has all.
    fn alive(&self, value: Light) -> Light {
        // Of red, green and blue the fourth number is 0 in every colour of the scene; no metal has an index of 0 at a wavelength.
        let fourth = if self.coat.over_metal { self.base[0][3] + self.base[1][3] } else { self.base[1][3] };
        if fourth > 0.0 { value } else { value * Light([1.0, 1.0, 1.0, 0.0]) }
    }
}

impl Scatter for Coated {
    const CHOOSES_LOBE: bool = true;

    #[inline]
    fn is_delta(&self) -> bool {
        self.is_polished() && self.alpha[0] <= 0.0 && self.albedo.is_black()
    }

    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Light, f32) {
        if self.is_delta() {
            return (Light::ZERO, 0.0);
        }
        let Some(side) = facing(wo, self.coat.two_sided) else { return (Light::ZERO, 0.0) };
        let [wo, wi] = [wo, wi].map(|w| Vec3::new(w.x, w.y, side * w.z));
        if wo.z <= 1e-6 {
            return (Light::ZERO, 0.0);
        }
        self.on_front(wo, wi)
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        let side = facing(wo, self.coat.two_sided)?;
        let up = Vec3::new(wo.x, wo.y, side * wo.z);
        if up.z <= 1e-6 {
            return None;
        }
        let Chances { top, metal } = self.chances(up.z);
        let top = if self.is_delta() { 1.0 } else { top };
        let facets = match self.top() {
            None if u_lobe < top => {
                return Some(reflected(wo, self.alive(self.mirrored(up.z)) * (1.0 / top), top));
            }
            Some(facets) if u_lobe < top => Some(facets),
            _ if u_lobe < top + metal => Some(self.wide(up.z)),
            _ => None,
        };
        let wi = match facets {
            Some(facets) => {
                let m = facets.sample_reflecting(up, u);
                m * (2.0 * up.dot(m)) - up
            }
            None => warp::cosine_hemisphere(u),
        };
        let wi = Vec3::new(wi.x, wi.y, side * wi.z);
        let (value, pdf) = self.eval_pdf(wo, wi, transport);
        let weight = value * (1.0 / pdf);
        (pdf > 0.0 && weight.is_finite()).then_some(BsdfSample { wi, weight, pdf, ..BsdfSample::REFLECTED })
    }

    fn albedo(&self) -> Light {
        let through = 1.0 - fresnel::dielectric(1.0, self.coat.eta).reflected;
        let ground = if self.coat.over_metal { self.metal().albedo() } else { self.base[0] };
        self.alive(ground * (through * through) + Light::splat(1.0 - through))
    }

    fn ambient(&self) -> Light {
        if self.coat.over_metal { Light::ZERO } else { self.base[0] }
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE, gold};
        const PAINT: Coat = Coat { thickness: 0.3, g: 0.4, ..LACQUER };
        const OVER_METAL: Coat = Coat { over_metal: true, ..LACQUER };
        let of = |name, coat, base, albedo, alpha| {
            Example::new(name, Bsdf::Coated(Coated { coat, base, albedo, alpha })).noisy()
        };
        let grey = |v: f32| Light::rgb([v; 3]);
        let Metal { eta, k, .. } = gold();
        let inside = [eta, k].map(|c| c * (1.0 / 1.5));
        vec![
            of("lacquered wood", LACQUER, [grey(0.6), WHITE], Light::ZERO, [0.0, 0.0]),
            of("roughly lacquered wood", LACQUER, [WHITE, WHITE], Light::ZERO, [0.3, 0.0]).focus(3),
            of("milky paint", PAINT, [grey(0.2), WHITE], grey(0.9), [0.0, 0.0]),
            of("lacquered gold", OVER_METAL, inside, Light::ZERO, [0.0, 0.2]).focus(3),
            of("dull lacquer over gold", OVER_METAL, inside, Light::ZERO, [0.3, 0.1]).focus(3),
            of("polished gold below lacquer", OVER_METAL, inside, Light::ZERO, [0.0, 0.0]),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::super::Plastic;
    use super::*;
    use straal_math::lowdisc::{Pattern, Purpose, SampleName};

    /// The mean weight of what is drawn: what comes back of even light.
    fn mean(bsdf: &Bsdf<'_>, wo: Vec3) -> f64 {
        const N: u32 = 20_000;
        let weight = |i| {
            let u = Pattern::Sobol.d3(&SampleName::new(3, [0, 0], i), Purpose::Direction);
            bsdf.sample(wo, u[2], [u[0], u[1]], Transport::Radiance).map_or(0.0, |s| f64::from(s.weight[0]))
        };
        (0..N).map(weight).sum::<f64>() / f64::from(N)
    }

    fn views() -> [Vec3; 3] {
        [0.999, 0.6, 0.2].map(|z: f32| Vec3::new((1.0 - z * z).sqrt(), 0.0, z))
    }

    /// Without a layer that absorbs, a smooth coat over a diffuse ground is `plastic`, which has a formula.
    #[test]
    fn a_thin_smooth_coat_is_plastic() {
        let coat = Coat { thickness: 1e-6, max_depth: 200, ..LACQUER };
        for rho in [0.3_f32, 0.8] {
            let base = [Light::rgb([rho; 3]), Light::rgb([1.0; 3])];
            let coated = Bsdf::Coated(Coated { coat, base, albedo: Light::ZERO, alpha: [0.0; 2] });
            let within = 0.596_345_7;
            let diffuse = Light::rgb([rho / (1.0 - rho * within) / 2.25; 3]);
            let specular = Light::rgb([1.0; 3]);
            let plastic =
                Bsdf::Plastic(Plastic { diffuse, specular, eta: 1.5, rough: None, two_sided: true });
            for wo in views() {
                let (a, b) = (mean(&coated, wo), mean(&plastic, wo));
                assert!((a / b - 1.0).abs() < 0.02, "{rho} {wo:?}: {a} {b}");
            }
        }
    }

    /// Metal that absorbs nothing below a coat that absorbs nothing: polished all comes back, by a formula. Rough, what facets lose at each
    /// bounce: so much is left when light is followed without any of the lobes by which directions are drawn (in double precision, 400,000 paths).
    #[test]
    fn a_coat_over_lossless_metal_loses_what_its_facets_do() {
        let coat = Coat { thickness: 1e-6, max_depth: 200, over_metal: true, ..LACQUER };
        let base = [Light::ZERO, Light::rgb([2.0; 3])];
        for (alpha, left) in [([0.0, 0.0], [1.0; 3]), ([0.0, 0.1], [0.9753, 0.9433, 0.9255])] {
            let coated = Bsdf::Coated(Coated { coat, base, albedo: Light::ZERO, alpha });
            for (wo, left) in views().into_iter().zip(left) {
                let all = mean(&coated, wo);
                assert!((all / left - 1.0).abs() < 0.03, "{alpha:?} {wo:?}: {all} {left}");
            }
        }
    }
}
