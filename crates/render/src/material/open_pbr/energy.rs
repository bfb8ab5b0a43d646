//! What rough surfaces lose where light would bounce between facets more than once, and so how much is to be given back.
//!
//! There are tables over the index of refraction (16 nodes from 1/2.5 to 1, 16 from 1 to 2.5), the root of alpha and the cosine of the
//! direction (32 nodes each): for glass, which reflects and refracts; for an opaque dielectric, which only reflects; for a perfect mirror;
//! each with its mean over directions weighted by their cosine. They are for facets of one roughness, Smith's shadowing of both directions
//! taken as independent. A last table tells which part of what glass has to be given back is reflected.
//!
//! The figures are those of Adobe's OpenPBR BSDF (github adobe/openpbr-bsdf, commit a29da969, the seven `openpbr_*_data.h` of `impl/data`, Apache-2.0), worked out
//! there by Monte Carlo integration, so that a material looks the same there and here to the last digit. `cargo xtask energy-tables check` holds
//! them against the integrals, worked out here; what part of glass's loss is reflected is a choice, of which only that it is the same from both sides can
//! be checked.

use std::sync::LazyLock;

use straal_math::simd::{Float, Uint};
use straal_math::{Vec3, ops};

use super::params::LEAST_INDEX;
use super::{ggx, interface};

/// Nodes by each of index, roughness and cosine.
const SIDE: usize = 32;
/// Nodes of indices below 1, and of those above.
const HALF: usize = SIDE / 2;
/// The largest index of the tables.
const MOST: f32 = 2.5;
/// Bytes of the tables, 16 bits to a number.
const SIZE: usize = 2 * (2 * SIDE * SIDE * SIDE + 4 * SIDE * SIDE + SIDE);

static BYTES: &[u8; SIZE] = include_bytes!("../../../data/energy.bin");

static TABLES: LazyLock<Tables> = LazyLock::new(Tables::read);

/// Shares of light from 0 to 1.
#[derive(Debug)]
struct Tables {
    /// What glass loses, by index, roughness and cosine.
    glass: Vec<f32>,
    /// What an opaque dielectric doesn't reflect, by the same.
    opaque: Vec<f32>,
    glass_mean: Vec<f32>,
    opaque_mean: Vec<f32>,
    /// Which part of what glass loses is given back as reflection.
    glass_reflects: Vec<f32>,
    /// What a perfect mirror loses, by roughness and cosine.
    mirror: Vec<f32>,
    mirror_mean: Vec<f32>,
}

impl Tables {
    fn read() -> Self {
        let mut numbers =
            BYTES.chunks_exact(2).map(|b| f32::from(u16::from_le_bytes([b[0], b[1]])) / 65535.0);
        let mut take = |n: usize| numbers.by_ref().take(n).collect::<Vec<f32>>();
        Self {
            glass: take(SIDE * SIDE * SIDE),
            opaque: take(SIDE * SIDE * SIDE),
            glass_mean: take(SIDE * SIDE),
            opaque_mean: take(SIDE * SIDE),
            mirror: take(SIDE * SIDE),
            mirror_mean: take(SIDE),
            glass_reflects: take(SIDE * SIDE),
        }
    }
}

/// A place between two nodes: the lower, and how far from it to the upper.
#[derive(Clone, Copy)]
struct Between<F: Float> {
    lower: F::Uint,
    part: F,
}

impl<F: Float> Between<F> {
    /// At a number of nodes, which is held within the table.
    #[inline(always)]
    fn nodes(at: F) -> Self {
        let at = at.max(F::ZERO).min(F::splat((SIDE - 1) as f32));
        // The last node is the upper one of a pair, too.
        let lower = at.floor().min(F::splat((SIDE - 2) as f32));
        Self { lower: lower.to_uint(), part: at - lower }
    }

    #[inline(always)]
    fn share(v: F) -> Self {
        Self::nodes(v * (SIDE - 1) as f32)
    }

    #[inline(always)]
    fn index(eta: F) -> Self {
        let below = eta.lt(F::ONE);
        let above_one = F::select(below, F::ONE / eta, eta);
        let steps = (above_one - F::ONE) * ((HALF - 1) as f32 / (MOST - 1.0));
        Self::nodes(F::select(below, F::splat((HALF - 1) as f32) - steps, steps + HALF as f32))
    }
}

#[inline(always)]
fn lerp<F: Float>(a: F, b: F, part: F) -> F {
    a * (F::ONE - part) + b * part
}

#[inline(always)]
fn at<F: Float>(table: &[f32], index: F::Uint) -> F {
    F::gather(table, index)
}

/// Between a number of the table, some steps from the first, and the next.
#[inline(always)]
fn pair<F: Float>(table: &[f32], first: F::Uint, step: usize, part: F) -> F {
    let i = first.wrapping_add(F::Uint::splat(step as u32));
    lerp(at(table, i), at(table, i.wrapping_add(F::Uint::splat(1))), part)
}

/// What has been found of a surface, for any direction.
#[derive(Clone, Copy)]
pub(super) struct Rough<F: Float> {
    index: Between<F>,
    roughness: Between<F>,
    /// What is left of losses beyond the largest index of the tables.
    beyond: F,
}

impl<F: Float> Rough<F> {
    /// A surface of an index and alpha.
    #[inline(always)]
    pub fn new(eta: F, alpha: F) -> Self {
        let at_most = {
            let r = (MOST - 1.0) / (MOST + 1.0);
            r * r
        };
        // Losses are 0 where all is reflected, and between a straight line in the reflectance straight back.
        let left = F::ONE - (interface::facing(eta) - F::splat(at_most)) * (1.0 / (1.0 - at_most));
        let is_beyond = eta.gt(F::splat(MOST)) | eta.lt(F::splat(1.0 / MOST));
        Self {
            index: Between::index(eta),
            roughness: Between::share(alpha.sqrt()),
            beyond: F::select(is_beyond, left, F::ONE),
        }
    }

    #[inline(always)]
    fn two(&self, table: &[f32]) -> F {
        let first = self.node();
        let a = lerp(at(table, first), at(table, first.wrapping_add(F::Uint::splat(1))), self.roughness.part);
        let next = first.wrapping_add(F::Uint::splat(SIDE as u32));
        let b = lerp(at(table, next), at(table, next.wrapping_add(F::Uint::splat(1))), self.roughness.part);
        lerp(a, b, self.index.part)
    }

    #[inline(always)]
    fn three(&self, table: &[f32], cos: F) -> F {
        let cos = Between::<F>::share(cos);
        let first = self.node().wrapping_mul(F::Uint::splat(SIDE as u32)).wrapping_add(cos.lower);
        let a =
            lerp(pair(table, first, 0, cos.part), pair(table, first, SIDE, cos.part), self.roughness.part);
        let next = SIDE * SIDE;
        let b = lerp(
            pair(table, first, next, cos.part),
            pair(table, first, next + SIDE, cos.part),
            self.roughness.part,
        );
        lerp(a, b, self.index.part)
    }

    #[inline(always)]
    fn node(&self) -> F::Uint {
        self.index.lower.wrapping_mul(F::Uint::splat(SIDE as u32)).wrapping_add(self.roughness.lower)
    }

    /// What an opaque dielectric doesn't reflect of light at a cosine.
    #[inline(always)]
    pub fn opaque(&self, cos: F) -> F {
        self.three(&TABLES.opaque, cos) * self.beyond
    }

    /// The mean of [`Self::opaque`].
    #[inline(always)]
    pub fn opaque_mean(&self) -> F {
        self.two(&TABLES.opaque_mean) * self.beyond
    }

    /// What glass loses of light at a cosine.
    #[inline(always)]
    pub fn glass(&self, cos: F) -> F {
        self.three(&TABLES.glass, cos)
    }

    /// The mean of [`Self::glass`].
    #[inline(always)]
    pub fn glass_mean(&self) -> F {
        self.two(&TABLES.glass_mean)
    }

    /// Which part of what glass loses is given back as reflection.
    #[inline(always)]
    pub fn glass_reflects(&self) -> F {
        self.two(&TABLES.glass_reflects)
    }

    /// What a perfect mirror loses of light at a cosine.
    #[inline(always)]
    pub fn mirror(&self, cos: F) -> F {
        let cos = Between::<F>::share(cos);
        let table = &TABLES.mirror;
        let first = self.roughness.lower.wrapping_mul(F::Uint::splat(SIDE as u32)).wrapping_add(cos.lower);
        let next = first.wrapping_add(F::Uint::splat(SIDE as u32));
        let one = F::Uint::splat(1);
        lerp(
            lerp(at(table, first), at(table, first.wrapping_add(one)), cos.part),
            lerp(at(table, next), at(table, next.wrapping_add(one)), cos.part),
            self.roughness.part,
        )
    }

    /// The mean of [`Self::mirror`].
    #[inline(always)]
    pub fn mirror_mean(&self) -> F {
        let i = self.roughness.lower;
        let table = &TABLES.mirror_mean;
        lerp(at(table, i), at(table, i.wrapping_add(F::Uint::splat(1))), self.roughness.part)
    }
}

/// The index of a node; next to 1 that from which light is still bent.
fn index_of(node: usize) -> f32 {
    let steps = if node < HALF { HALF - 1 - node } else { node - HALF };
    let above = ops::max(1.0 + steps as f32 * ((MOST - 1.0) / (HALF - 1) as f32), LEAST_INDEX);
    if node < HALF { 1.0 / above } else { above }
}

/// The cosine of the first node: along the surface there is no limit that holds for all roughnesses.
const LEAST_COS: f32 = 1e-3;

/// Points of an integral over facets; of one over cosines, and of those over facets for each of them.
const FACETS: usize = 2048;
const COSINES: usize = 384;
const FACETS_OF_MEAN: usize = 512;

/// The three losses of one roughness and cosine, glass and opaque by index.
struct Losses {
    glass: [f32; SIDE],
    opaque: [f32; SIDE],
    mirror: f32,
}

/// Integrals over the facets that are seen: what they send above the surface and isn't hidden there, and what below.
fn losses(alpha: f32, cos: f32, count: usize) -> Losses {
    let (mut reflected, mut passed, mut mirrored) = ([0.0_f64; SIDE], [0.0_f64; SIDE], 0.0_f64);
    let facets = ggx([alpha, alpha]);
    let wo = Vec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos);
    // A rank-1 lattice, whose points are even on any line (Cranley and Patterson 1976); the azimuth's half is the other's mirror image.
    let step = 0.618_034_f64;
    for i in 0..count {
        let u = (i as f64 + 0.5) / count as f64;
        let v = (i as f64 * step).fract();
        let m = facets.sample_within(wo, [u as f32, v as f32], 1.0);
        let along = wo.dot(m);
        let wi = m * (2.0 * along) - wo;
        let shown = if wi.z > 0.0 { f64::from(facets.seen(wi)) } else { 0.0 };
        mirrored += shown;
        for node in 0..SIDE {
            let eta = index_of(node);
            let share = f64::from(interface::dielectric(along, eta));
            reflected[node] += share * shown;
            if share < 1.0 {
                let refracted = interface::refracted_cos(along, eta);
                let wt = m * (along / eta - refracted) - wo * (1.0 / eta);
                if wt.z < 0.0 {
                    let seen = f64::from(facets.seen(Vec3::new(wt.x, wt.y, -wt.z)));
                    passed[node] += (1.0 - share) * seen;
                }
            }
        }
    }
    let lost = |sum: f64| {
        let lost = (1.0 - sum / count as f64) as f32;
        ops::clamp(lost, 0.0, 1.0)
    };
    Losses {
        glass: std::array::from_fn(|n| lost(reflected[n] + passed[n])),
        opaque: std::array::from_fn(|n| lost(reflected[n])),
        mirror: lost(mirrored),
    }
}

/// Those of a smooth surface.
fn smooth(cos: f32) -> Losses {
    Losses {
        glass: [0.0; SIDE],
        opaque: std::array::from_fn(|n| 1.0 - interface::dielectric(cos, index_of(n))),
        mirror: 0.0,
    }
}

/// A table of numbers: its name, those that are kept, and the same worked out anew.
pub struct Checked {
    /// What it is of.
    pub name: &'static str,
    /// As they are kept.
    pub kept: Vec<f32>,
    /// As they are worked out.
    pub found: Vec<f32>,
}

/// All tables, each with the integrals. It takes a minute.
pub fn checked() -> Vec<Checked> {
    let share = |i: usize| i as f32 / (SIDE - 1) as f32;
    let mut glass = vec![0.0; SIDE * SIDE * SIDE];
    let mut opaque = glass.clone();
    let mut glass_mean = vec![0.0; SIDE * SIDE];
    let (mut opaque_mean, mut mirror, mut mirror_mean) =
        (glass_mean.clone(), glass_mean.clone(), vec![0.0; SIDE]);
    let place = |index: usize, rough: usize, cos: usize| (index * SIDE + rough) * SIDE + cos;
    for rough in 0..SIDE {
        let alpha = share(rough) * share(rough);
        let of = |cos: f32, count| if rough == 0 { smooth(cos) } else { losses(alpha, cos, count) };
        for cos in 0..SIDE {
            let at = if rough > 0 && cos == 0 { LEAST_COS } else { share(cos) };
            let found = of(at, FACETS);
            for index in 0..SIDE {
                glass[place(index, rough, cos)] = found.glass[index];
                opaque[place(index, rough, cos)] = found.opaque[index];
            }
            mirror[rough * SIDE + cos] = found.mirror;
        }
        // Means by the midpoint rule over the square of the cosine's root, so that what changes along the surface is seen.
        let mut sums = [[0.0_f64; SIDE]; 2];
        let mut sum = 0.0_f64;
        for i in 0..COSINES {
            let t = (i as f32 + 0.5) / COSINES as f32;
            let cos = t * t;
            let weight = f64::from(4.0 * t * cos / COSINES as f32);
            let found = of(cos, FACETS_OF_MEAN);
            for (sums, losses) in sums.iter_mut().zip([&found.glass, &found.opaque]) {
                for (sum, lost) in sums.iter_mut().zip(losses) {
                    *sum += weight * f64::from(*lost);
                }
            }
            sum += weight * f64::from(found.mirror);
        }
        for index in 0..SIDE {
            glass_mean[index * SIDE + rough] = sums[0][index] as f32;
            opaque_mean[index * SIDE + rough] = sums[1][index] as f32;
        }
        mirror_mean[rough] = sum as f32;
    }
    // What passes is the same from both sides: (1 - r) times the mean loss.
    let passes = |index: usize, rough: usize| {
        let at = index * SIDE + rough;
        (1.0 - TABLES.glass_reflects[at]) * TABLES.glass_mean[at]
    };
    let nodes = || (0..HALF).flat_map(|index| (0..SIDE).map(move |rough| (index, rough)));
    let one = |name, kept: &Vec<f32>, found| Checked { name, kept: kept.clone(), found };
    vec![
        one("glass", &TABLES.glass, glass),
        one("opaque", &TABLES.opaque, opaque),
        one("mean of glass", &TABLES.glass_mean, glass_mean),
        one("mean of opaque", &TABLES.opaque_mean, opaque_mean),
        one("mirror", &TABLES.mirror, mirror),
        one("mean of mirror", &TABLES.mirror_mean, mirror_mean),
        Checked {
            name: "what passes of what glass gives back",
            kept: nodes().map(|(index, rough)| passes(index, rough)).collect(),
            found: nodes().map(|(index, rough)| passes(SIDE - 1 - index, rough)).collect(),
        },
    ]
}
