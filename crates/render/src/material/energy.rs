//! How much light rough boundaries send back and let through in the microfacet model, which follows it to one facet only: tables, worked out
//! when a scene is made ready, and always to the same bits.

use straal_math::simd::{Float, Uint};
use straal_math::{Vec3, ops};
use straal_scene::desc::Distribution;

use super::{fresnel, microfacet::Facets};

/// Cosines of a table, evenly from 0 to 1.
const COSINES: usize = 64;

/// Roughnesses of a table that has several.
const ROUGHNESSES: usize = 17;

/// So many facets squared are looked at for each entry.
const SIDE: u32 = 20;

/// And of a boundary from within, where the share jumps to 1 at a direction: so many, not on a grid.
const SCATTERED: u32 = 512;

/// A share of light by the roughness of a boundary and the cosine at it.
#[derive(Clone, Debug, PartialEq)]
pub struct Shares {
    /// By roughness, evenly from 0 to 1; or one row alone.
    rows: Vec<[f32; COSINES]>,
    /// Of each row, twice the sum of share times cosine, by the steps between entries.
    means: Vec<f32>,
}

impl Shares {
    fn new(alphas: &[f32], share: impl Fn(f32, f32) -> f32) -> Self {
        let cosine = |i: usize| if i == 0 { 1e-6 } else { i as f32 / (COSINES - 1) as f32 };
        let row = |&alpha: &f32| std::array::from_fn(|i| share(alpha, cosine(i)));
        let mut made = Self { rows: alphas.iter().map(row).collect(), means: Vec::new() };
        made.means = (0..made.rows.len()).map(|row| mean(&made.rows[row])).collect();
        made
    }

    /// The share of light, both from 0 to 1, between the entries in straight lines; or those of many side by side.
    #[inline(always)]
    pub fn at<F: Float>(&self, alpha: F, cos: F) -> F {
        let table = self.rows.as_flattened();
        let (column, part) = between(cos, COSINES);
        let along = |row: F::Uint| {
            let at = row.wrapping_mul(F::Uint::splat(COSINES as u32)).wrapping_add(column);
            let (low, high) = (F::gather(table, at), F::gather(table, at.wrapping_add(F::Uint::splat(1))));
            low + (high - low) * part
        };
        if self.rows.len() == 1 {
            return along(F::Uint::splat(0));
        }
        let (row, part) = between(alpha, self.rows.len());
        let (low, high) = (along(row), along(row.wrapping_add(F::Uint::splat(1))));
        low + (high - low) * part
    }

    /// Of light from all around, evenly: the integral of 2 share cos over the cosine.
    #[inline(always)]
    pub fn of_all_directions<F: Float>(&self, alpha: F) -> F {
        self.at_nodes(alpha) - self.at(alpha, F::ONE) / F::splat((COSINES - 1) as f32)
    }

    /// The same as Mitsuba 3 has it, where the last entry counts in full and there is one more of them than steps: 2 % less for glass
    /// from within.
    pub fn of_all_directions_as_mitsuba(&self, alpha: f32) -> f32 {
        self.at_nodes(alpha) * ((COSINES - 1) as f32 / COSINES as f32)
    }

    /// Twice the sum of share times cosine over the entries, by the steps between them.
    #[inline(always)]
    fn at_nodes<F: Float>(&self, alpha: F) -> F {
        if let [only] = self.means[..] {
            return F::splat(only);
        }
        let (row, part) = between(alpha, self.means.len());
        let [low, high] = [row, row.wrapping_add(F::Uint::splat(1))].map(|row| F::gather(&self.means, row));
        low + (high - low) * part
    }
}

/// The lower of two neighbours of so many that lie evenly from 0 to 1, and how far something is from it to the upper.
#[inline(always)]
fn between<F: Float>(x: F, count: usize) -> (F::Uint, F) {
    let place = ops::clamp(x, F::ZERO, F::ONE) * (count - 1) as f32;
    let low = place.floor().min(F::splat((count - 2) as f32));
    (low.to_uint(), place - low)
}

/// Between a row's entries in straight lines.
#[inline]
fn along(row: &[f32; COSINES], cos: f32) -> f32 {
    let place = ops::clamp(cos, 0.0, 1.0) * (COSINES - 1) as f32;
    let i = (place as usize).min(COSINES - 2);
    row[i] + (row[i + 1] - row[i]) * (place - i as f32)
}

/// Twice the sum of share times cosine over a row's entries, by the steps between them.
fn mean(row: &[f32; COSINES]) -> f32 {
    let cosines = (0..COSINES).map(|i| i as f32 / (COSINES - 1) as f32);
    2.0 * cosines.map(|cos| along(row, cos) * cos).sum::<f32>() / (COSINES - 1) as f32
}

/// Indices of refraction of a table that has several: evenly by x = (eta - 1) / (eta + 1), whose square is what is reflected straight on, so
/// that 1, where shares have a bend, is one of them.
const INDICES: usize = 33;

/// The x of the last; the first has its opposite. This is an index of 10.
const LAST: f32 = 9.0 / 11.0;

/// Tables by index of refraction, where that isn't the same everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct ByIndex<T>(Vec<T>);

impl<T> ByIndex<T> {
    /// Of a boundary that has this index everywhere, or of any, by the table of one.
    pub fn new(only: Option<f32>, table: impl Fn(f32) -> T) -> Self {
        let x = |i: usize| LAST * (2.0 * i as f32 / (INDICES - 1) as f32 - 1.0);
        Self(match only {
            Some(eta) => vec![table(eta)],
            None => (0..INDICES).map(|i| table((1.0 + x(i)) / (1.0 - x(i)))).collect(),
        })
    }

    /// The table, where there is one alone.
    #[inline(always)]
    pub fn only(&self) -> Option<&T> {
        if let [only] = &self.0[..] { Some(only) } else { None }
    }

    /// What is asked of a table, in straight lines between the tables.
    #[inline]
    pub fn between(&self, eta: f32, of: impl Fn(&T) -> f32) -> f32 {
        if let Some(only) = self.only() {
            return of(only);
        }
        let x = ops::clamp((eta - 1.0) / (eta + 1.0), -LAST, LAST);
        let place = (x * (1.0 / LAST) + 1.0) * (0.5 * (INDICES - 1) as f32);
        let i = (place as usize).min(INDICES - 2);
        let (low, high) = (of(&self.0[i]), of(&self.0[i + 1]));
        low + (high - low) * (place - i as f32)
    }
}

/// The roughnesses of a table: one that is the same everywhere, or all.
fn roughnesses(alpha: Option<f32>) -> Vec<f32> {
    match alpha {
        Some(alpha) => vec![alpha],
        None => (0..ROUGHNESSES).map(|i| i as f32 / (ROUGHNESSES - 1) as f32).collect(),
    }
}

/// A table of shares by all roughnesses and cosines.
pub(super) fn table(share: impl Fn(f32, f32) -> f32) -> Shares {
    Shares::new(&roughnesses(None), share)
}

/// What is kept of light by a boundary that nothing absorbs it at, by which it is to be divided: with entries the closer the smoother it is and the flatter it is looked
/// at, where shares change fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    over: Over,
    /// By the root of the cosine, evenly from 0 to 1.
    rows: Vec<[f32; FLAT_TO_UPRIGHT]>,
}

/// What the rows of [`Kept`] are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Over {
    /// One roughness, the same in all directions.
    One,
    /// The root of alpha, evenly from 0 to 1.
    Roughness,
    /// Where a brushed surface is looked at from: w = y² b / (x² a + y² b), from along the tangent to across it, by [`Over::place`].
    Azimuth,
}

/// Entries of a row, rows over roughness, and rows over directions.
const FLAT_TO_UPRIGHT: usize = 48;
const SMOOTH_TO_ROUGH: usize = 33;
const ALONG_TO_ACROSS: usize = 13;

/// So many facets, not on a grid, are looked at for each entry: a grid of as many is off by 2 %, where a part of the reflections goes into the surface.
const LOOKED_AT: u32 = 1536;

impl Over {
    /// From 0 to 1 where w is: closer at both ends, where shares bend.
    #[inline]
    fn place(w: f32) -> f32 {
        if w < 0.5 { (0.5 * w).sqrt() } else { 1.0 - (0.5 - 0.5 * w).sqrt() }
    }

    /// The w of a place.
    fn across(place: f32) -> f32 {
        if place < 0.5 { 2.0 * place * place } else { 1.0 - 2.0 * (1.0 - place) * (1.0 - place) }
    }
}

impl Kept {
    /// Of facets that have this alpha along the tangent and across it everywhere, or any, by what is kept of the light that meets one.
    fn new(
        alpha: Option<[f32; 2]>,
        distribution: &Distribution,
        share: impl Fn(Facets, Vec3, Vec3) -> f32,
    ) -> Self {
        let even = |i: usize, count: usize| i as f32 / (count - 1) as f32;
        let row = |facets: Facets, [x, y]: [f32; 2]| {
            std::array::from_fn(|i| {
                let root = even(i, FLAT_TO_UPRIGHT);
                let cos = if i == 0 { 1e-6 } else { root * root };
                let sin = ops::max(1.0 - cos * cos, 0.0).sqrt();
                sum_from(Points::Many, facets, Vec3::new(sin * x, sin * y, cos), &share)
            })
        };
        let facets = |alpha| Facets::new(alpha, distribution.clone());
        let (over, rows) = match alpha {
            Some([a, b]) if a == b => (Over::One, vec![row(facets([a; 2]), [1.0, 0.0])]),
            Some(alpha) => {
                let facets = facets(alpha);
                let [a, b] = facets.alphas();
                let towards = |i: usize| {
                    let w = Over::across(even(i, ALONG_TO_ACROSS));
                    let (x, y) = (((1.0 - w) * b).sqrt(), (w * a).sqrt());
                    let length = (x * x + y * y).sqrt();
                    row(facets, [x / length, y / length])
                };
                (Over::Azimuth, (0..ALONG_TO_ACROSS).map(towards).collect())
            }
            None => {
                let root = |i: usize| even(i, SMOOTH_TO_ROUGH);
                let of = |i| row(facets([root(i) * root(i); 2]), [1.0, 0.0]);
                (Over::Roughness, (0..SMOOTH_TO_ROUGH).map(of).collect())
            }
        };
        Self { over, rows }
    }

    /// Of metal.
    pub fn by_metal(alpha: Option<[f32; 2]>, distribution: &Distribution) -> Self {
        Self::new(alpha, distribution, reflected)
    }

    /// Of glass, for light that comes from where the index of refraction is `eta` times less.
    pub fn by_glass(alpha: Option<[f32; 2]>, distribution: &Distribution, eta: f32) -> Self {
        Self::new(alpha, distribution, |facets, v, m| {
            let split = fresnel::dielectric(v.dot(m), eta);
            let through = passes(facets, v, m, (eta, split.cos_refracted));
            split.reflected * reflected(facets, v, m) + (1.0 - split.reflected) * through
        })
    }

    /// What light that went in is to be multiplied by, so that none is lost: of what is kept less than this there are no pictures.
    #[inline]
    pub fn put_back(&self, facets: &Facets, v: Vec3) -> f32 {
        /// Of the roughest glass of nearly the index of what is around it 0.035 are kept where the cosine is 0.02.
        const LEAST: f32 = 0.02;
        1.0 / ops::max(self.at(facets, v), LEAST)
    }

    /// The share of light from a direction above, which facets of a table over roughness have as if they were alike in all directions.
    #[inline]
    pub fn at(&self, facets: &Facets, v: Vec3) -> f32 {
        let (column, part) = between(ops::clamp(v.z, 0.0, 1.0).sqrt(), FLAT_TO_UPRIGHT);
        let along = |row: &[f32; FLAT_TO_UPRIGHT]| {
            let (low, high) = (row[column as usize], row[column as usize + 1]);
            low + (high - low) * part
        };
        let place = match self.over {
            Over::One => return along(&self.rows[0]),
            Over::Roughness => facets.mean_alpha().sqrt(),
            Over::Azimuth => {
                let [a, b] = facets.alphas();
                let (x, y) = (v.x * v.x * a, v.y * v.y * b);
                if x + y > 0.0 { Over::place(y / (x + y)) } else { 0.0 }
            }
        };
        let (row, part) = between(place, self.rows.len());
        let (low, high) = (along(&self.rows[row as usize]), along(&self.rows[row as usize + 1]));
        low + (high - low) * part
    }
}

/// What a rough boundary lets through of light that comes from where the index of refraction is `eta` times less, where that of the material is the same
/// everywhere or by roughness.
pub fn passed(alpha: Option<f32>, distribution: &Distribution, eta: f32) -> Shares {
    of_boundary(alpha, distribution, eta, |facets, v, m, eta| {
        let split = fresnel::dielectric(v.dot(m), eta);
        (1.0 - split.reflected) * passes(facets, v, m, (eta, split.cos_refracted))
    })
}

/// What it reflects.
pub fn sent_back(alpha: Option<f32>, distribution: &Distribution, eta: f32) -> Shares {
    Shares::new(&roughnesses(alpha), |alpha, cos| {
        let points = if eta < 1.0 { Points::Scattered } else { Points::Grid };
        sum_over(points, Facets::new([alpha; 2], distribution.clone()), cos, |facets, v, m| {
            fresnel::dielectric(v.dot(m), eta).reflected * reflected(facets, v, m)
        })
    })
}

fn of_boundary(
    alpha: Option<f32>,
    distribution: &Distribution,
    eta: f32,
    f: impl Fn(Facets, Vec3, Vec3, f32) -> f32,
) -> Shares {
    Shares::new(&roughnesses(alpha), |alpha, cos| {
        sum(Facets::new([alpha; 2], distribution.clone()), cos, |facets, v, m| f(facets, v, m, eta))
    })
}

/// The part of the light that a facet reflects which leaves the surface.
fn reflected(facets: Facets, v: Vec3, m: Vec3) -> f32 {
    let out = m * (2.0 * v.dot(m)) - v;
    if out.z > 0.0 { facets.seen(out) } else { 0.0 }
}

/// The part of the light that passes a facet which leaves on the other side.
fn passes(facets: Facets, v: Vec3, m: Vec3, (eta, cos_refracted): (f32, f32)) -> f32 {
    let inverse = 1.0 / eta;
    let out = v * -inverse + m * (inverse * v.dot(m) - cos_refracted);
    if out.z < 0.0 && cos_refracted > 0.0 { facets.seen(out) } else { 0.0 }
}

/// Which facets are looked at.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Points {
    /// Those of a grid.
    Grid,
    /// Those of Roberts's sequence (2018, "The Unreasonable Effectiveness of Quasirandom Sequences"), from another place for each cosine: a
    /// sum over cosines has them all.
    Scattered,
    /// More of that sequence, the same for all.
    Many,
}

impl Points {
    fn count(self) -> u32 {
        match self {
            Self::Grid => SIDE * SIDE,
            Self::Scattered => SCATTERED,
            Self::Many => LOOKED_AT,
        }
    }

    fn at(self, i: u32, cos: f32) -> [f32; 2] {
        /// The root of x³ = x + 1.
        const PLASTIC: f64 = 1.324_717_957_244_746;
        match self {
            Self::Grid => [i % SIDE, i / SIDE].map(|k| (k as f32 + 0.5) / SIDE as f32),
            Self::Scattered | Self::Many => {
                let row = if self == Self::Many { 0.5 } else { f64::from(cos) * (COSINES - 1) as f64 };
                let place = |first: f64, step: f64| {
                    let x = row * first + f64::from(i) * step;
                    ops::min((x - x.floor()) as f32, 1.0 - f32::EPSILON / 2.0)
                };
                [
                    place(0.618_033_988_749_895, 1.0 / PLASTIC),
                    place(0.754_877_666_246_693, 1.0 / (PLASTIC * PLASTIC)),
                ]
            }
        }
    }
}

/// The mean of a share over the facets that are seen at a cosine.
fn sum(facets: Facets, cos: f32, share: impl Fn(Facets, Vec3, Vec3) -> f32) -> f32 {
    sum_over(Points::Grid, facets, cos, share)
}

fn sum_over(points: Points, facets: Facets, cos: f32, share: impl Fn(Facets, Vec3, Vec3) -> f32) -> f32 {
    sum_from(points, facets, Vec3::new(ops::max(1.0 - cos * cos, 0.0).sqrt(), 0.0, cos), share)
}

fn sum_from(points: Points, facets: Facets, v: Vec3, share: impl Fn(Facets, Vec3, Vec3) -> f32) -> f32 {
    let cos = v.z;
    let mut all = 0.0;
    for i in 0..points.count() {
        let u = points.at(i, cos);
        let m = facets.sample(v, u);
        let towards = v.dot(m);
        if towards <= 0.0 {
            continue;
        }
        // 1 where facets are drawn as they are seen.
        let weight = facets.seen(v) * facets.density(m) * towards / (cos * facets.pdf(v, m));
        if weight.is_finite() {
            all += weight * share(facets, v, m);
        }
    }
    ops::clamp(all / points.count() as f32, 0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_boundaries_have_fresnels_shares() {
        let eta = 1.5;
        let (through, back) =
            (passed(Some(0.0), &Distribution::Ggx, eta), sent_back(Some(0.0), &Distribution::Ggx, eta));
        for i in 1..=10 {
            let cos = (i * 6) as f32 / 63.0;
            let exact = fresnel::dielectric(cos, eta).reflected;
            assert!((back.at(0.0, cos) - exact).abs() < 1e-3, "{cos}: {} {exact}", back.at(0.0, cos));
            assert!((through.at(0.0, cos) + exact - 1.0).abs() < 1e-3);
        }
        // From within, of even light: what Egan and Hilgeman (1973) fit to 0.1 %.
        let within = sent_back(Some(0.0), &Distribution::Ggx, 1.0 / eta).of_all_directions(0.0);
        assert!((within - 0.5963).abs() < 1e-3, "{within}");
        // What Mitsuba 3.9.1 has for a rough one, read off its values; a grid of 20 x 20 facets is 0.003 above it.
        let rough = sent_back(Some(0.05), &Distribution::Ggx, 1.0 / 1.9).of_all_directions_as_mitsuba(0.05);
        assert!((rough - 0.742_82).abs() < 1e-3, "{rough}");
    }

    #[test]
    fn rough_metal_sends_back_what_is_known() {
        // 1 - ln 2 of light along the normal; see `rough_metal_loses_only_what_would_bounce_twice`.
        let metal = Kept::by_metal(None, &Distribution::Ggx);
        let facets = |alpha| Facets::new([alpha; 2], Distribution::Ggx);
        let rough = metal.at(&facets(1.0), Vec3::Z);
        assert!((rough - 0.306_852_8).abs() < 2e-3, "{rough}");
        assert!(metal.at(&facets(0.0), Vec3::new(0.866, 0.0, 0.5)) > 0.999);
        // A table of one row and that of all agree where both have an entry.
        let one = Kept::by_glass(Some([0.25; 2]), &Distribution::Ggx, 1.5);
        let all = Kept::by_glass(None, &Distribution::Ggx, 1.5);
        let v = Vec3::new(0.8, 0.0, 0.6);
        assert_eq!(one.at(&facets(0.25), v), all.at(&facets(0.25), v));
    }

    /// A white furnace: what is kept, worked out more finely, over what tables tell between their entries.
    struct Furnace {
        worst: (f64, String),
    }

    impl Furnace {
        fn hold(&mut self, facets: Facets, v: Vec3, (table, eta): (&Kept, Option<f32>)) {
            const FACETS: u32 = 5000;
            let share = |m: Vec3| match eta {
                None => reflected(facets, v, m),
                Some(eta) => {
                    let split = fresnel::dielectric(v.dot(m), eta);
                    let through = passes(facets, v, m, (eta, split.cos_refracted));
                    split.reflected * reflected(facets, v, m) + (1.0 - split.reflected) * through
                }
            };
            let mut all = 0.0;
            for i in 0..FACETS {
                // From another place than the tables.
                let m = facets.sample(v, Points::Scattered.at(i, 0.123));
                if v.dot(m) > 0.0 {
                    all += f64::from(share(m));
                }
            }
            let off = all / f64::from(FACETS) * f64::from(table.put_back(&facets, v)) - 1.0;
            if off.abs() > self.worst.0.abs() {
                self.worst = (off, format!("{facets:?}, eta {eta:?}, from {v:?}"));
            }
        }
    }

    fn direction(cos: f32, degrees: f64) -> Vec3 {
        let sin = (1.0 - cos * cos).sqrt();
        let (s, c) = ops::sin_cos_degrees(degrees);
        Vec3::new(sin * c as f32, sin * s as f32, cos)
    }

    const COSINES_TRIED: [f32; 7] = [0.02, 0.033, 0.06, 0.12, 0.28, 0.6, 0.97];

    #[test]
    fn furnaces_are_white_between_the_entries() {
        let ggx = |alpha| Facets::new(alpha, Distribution::Ggx);
        let mut told = Vec::new();
        let mut furnace = Furnace { worst: (0.0, String::new()) };
        let any = Kept::by_metal(None, &Distribution::Ggx);
        for i in 0..14 {
            let alpha = (i as f32 + 0.3) / 14.0;
            for cos in COSINES_TRIED {
                furnace.hold(ggx([alpha; 2]), direction(cos, 0.0), (&any, None));
            }
        }
        told.push(("metal of any roughness", std::mem::replace(&mut furnace.worst, (0.0, String::new()))));
        for (a, b) in [(0.9, 0.6), (0.5, 0.2), (0.6, 0.06), (0.1, 1.0)] {
            let table = Kept::by_metal(Some([a, b]), &Distribution::Ggx);
            for cos in COSINES_TRIED {
                for degrees in [0.0, 20.0, 47.0, 71.0, 83.0, 90.0] {
                    furnace.hold(ggx([a, b]), direction(cos, degrees), (&table, None));
                }
            }
        }
        told.push(("brushed metal", std::mem::replace(&mut furnace.worst, (0.0, String::new()))));
        for eta in [1.03, 1.2, 1.5, 2.1, 3.0] {
            for eta in [eta, 1.0 / eta] {
                for alpha in [0.03, 0.11, 0.27, 0.55, 0.95] {
                    let table = Kept::by_glass(Some([alpha; 2]), &Distribution::Ggx, eta);
                    for cos in COSINES_TRIED {
                        furnace.hold(ggx([alpha; 2]), direction(cos, 0.0), (&table, Some(eta)));
                    }
                }
            }
        }
        told.push(("glass", std::mem::replace(&mut furnace.worst, (0.0, String::new()))));
        for eta in [1.5, 1.0 / 1.5] {
            let any = Kept::by_glass(None, &Distribution::Ggx, eta);
            for alpha in [0.02, 0.07, 0.19, 0.42, 0.8] {
                for cos in COSINES_TRIED {
                    furnace.hold(ggx([alpha; 2]), direction(cos, 0.0), (&any, Some(eta)));
                }
            }
            let (a, b) = (0.7, 0.2);
            let table = Kept::by_glass(Some([a, b]), &Distribution::Ggx, eta);
            for cos in COSINES_TRIED {
                for degrees in [0.0, 30.0, 65.0, 90.0] {
                    furnace.hold(ggx([a, b]), direction(cos, degrees), (&table, Some(eta)));
                }
            }
        }
        told.push(("glass of any roughness, brushed glass", furnace.worst));
        for (what, (off, at)) in told {
            assert!(off.abs() < 0.01, "{what}: {off} of {at}");
        }
    }
}
