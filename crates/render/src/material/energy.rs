//! How much light rough boundaries send back and let through in the microfacet model, which follows it to one facet only: tables, worked out
//! when a scene is made ready, and always to the same bits.

use std::sync::LazyLock;

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
}

impl Shares {
    fn new(alphas: &[f32], share: impl Fn(f32, f32) -> f32) -> Self {
        let cosine = |i: usize| if i == 0 { 1e-6 } else { i as f32 / (COSINES - 1) as f32 };
        let row = |&alpha: &f32| std::array::from_fn(|i| share(alpha, cosine(i)));
        Self { rows: alphas.iter().map(row).collect() }
    }

    /// The share of light, both from 0 to 1, between the entries in straight lines.
    #[inline]
    pub fn at(&self, alpha: f32, cos: f32) -> f32 {
        let place = ops::clamp(cos, 0.0, 1.0) * (COSINES - 1) as f32;
        let i = (place as usize).min(COSINES - 2);
        let along = |row: &[f32; COSINES]| row[i] + (row[i + 1] - row[i]) * (place - i as f32);
        if let [only] = &self.rows[..] {
            return along(only);
        }
        let place = ops::clamp(alpha, 0.0, 1.0) * (self.rows.len() - 1) as f32;
        let j = (place as usize).min(self.rows.len() - 2);
        let (low, high) = (along(&self.rows[j]), along(&self.rows[j + 1]));
        low + (high - low) * (place - j as f32)
    }

    /// Of light from all around, evenly: the integral of 2 share cos over the cosine.
    pub fn of_all_directions(&self, alpha: f32) -> f32 {
        self.at_nodes(alpha) - self.at(alpha, 1.0) / (COSINES - 1) as f32
    }

    /// The same as Mitsuba 3 has it, where the last entry counts in full and there is one more of them than steps: 2 % less for glass
    /// from within.
    pub fn of_all_directions_as_mitsuba(&self, alpha: f32) -> f32 {
        self.at_nodes(alpha) * ((COSINES - 1) as f32 / COSINES as f32)
    }

    /// Twice the sum of share times cosine over the entries, by the steps between them.
    fn at_nodes(&self, alpha: f32) -> f32 {
        let cosines = (0..COSINES).map(|i| i as f32 / (COSINES - 1) as f32);
        2.0 * cosines.map(|cos| self.at(alpha, cos) * cos).sum::<f32>() / (COSINES - 1) as f32
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

/// What a metal that absorbs nothing sends back, of GGX facets.
pub fn lossless_metal() -> &'static Shares {
    static TABLE: LazyLock<Shares> = LazyLock::new(|| {
        Shares::new(&roughnesses(None), |alpha, cos| {
            let facets = Facets::new([alpha; 2], Distribution::Ggx);
            sum(facets, cos, reflected)
        })
    });
    &TABLE
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

/// Both together.
pub fn kept(alpha: Option<f32>, distribution: &Distribution, eta: f32) -> Shares {
    of_boundary(alpha, distribution, eta, |facets, v, m, eta| {
        let split = fresnel::dielectric(v.dot(m), eta);
        let through = passes(facets, v, m, (eta, split.cos_refracted));
        split.reflected * reflected(facets, v, m) + (1.0 - split.reflected) * through
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
}

impl Points {
    fn count(self) -> u32 {
        if self == Self::Grid { SIDE * SIDE } else { SCATTERED }
    }

    fn at(self, i: u32, cos: f32) -> [f32; 2] {
        /// The root of x³ = x + 1.
        const PLASTIC: f64 = 1.324_717_957_244_746;
        match self {
            Self::Grid => [i % SIDE, i / SIDE].map(|k| (k as f32 + 0.5) / SIDE as f32),
            Self::Scattered => {
                let row = f64::from(cos) * (COSINES - 1) as f64;
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
    let v = Vec3::new(ops::max(1.0 - cos * cos, 0.0).sqrt(), 0.0, cos);
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
        let metal = lossless_metal();
        assert!((metal.at(1.0, 1.0) - 0.306_852_8).abs() < 2e-3, "{}", metal.at(1.0, 1.0));
        assert!(metal.at(0.0, 0.5) > 0.999);
        // A table of one row and that of all agree where both have an entry.
        let one = kept(Some(0.5), &Distribution::Ggx, 1.5);
        let all = kept(None, &Distribution::Ggx, 1.5);
        assert_eq!(one.at(0.5, 0.3), all.at(0.5, 0.3));
    }
}
