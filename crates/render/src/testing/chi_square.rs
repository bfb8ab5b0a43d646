//! Pearson's test that drawn directions have the density that is told.

use std::fmt;

use straal_math::{Vec3, lowdisc::Pattern, lowdisc::Purpose, lowdisc::SampleName};

use super::{SphereGrid, chi_square_p, sidak};

/// How a sampler of directions is put to the test.
#[derive(Clone, Copy, Debug)]
pub struct ChiSquare {
    /// Where directions are counted.
    pub grid: SphereGrid,
    /// How many are drawn.
    pub samples: u32,
    /// Which random numbers.
    pub seed: u64,
    /// How many such tests are judged together, for [`Outcome::verdict`].
    pub tests: usize,
}

impl Default for ChiSquare {
    fn default() -> Self {
        Self { grid: SphereGrid::default(), samples: 100_000, seed: 0, tests: 1 }
    }
}

/// What the test found.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// The probability of a statistic at least as bad by chance.
    pub p: f64,
    /// Pearson's statistic.
    pub statistic: f64,
    /// Its degrees of freedom.
    pub degrees: usize,
    /// The integral of the density over the sphere.
    pub integral: f64,
    /// The share of draws that gave a direction.
    pub drawn: f64,
    /// Draws whose own density is 0 or not finite.
    pub impossible: u32,
    samples: u32,
    tests: usize,
}

impl ChiSquare {
    /// Draws directions with `sample`, which is given four independent numbers in [0, 1), and counts them in the
    /// cells of the grid against the integral of `pdf` (per solid angle; unit directions). `None` is a draw without
    /// direction, for which the density leaves out its share: `pdf` integrates to 1 minus the share of `None`.
    /// Draws of delta lobes are to be given as `None`, with `pdf` that of the others.
    pub fn run(
        &self,
        mut sample: impl FnMut([f32; 4]) -> Option<Vec3>,
        pdf: impl Fn(Vec3) -> f32,
    ) -> Outcome {
        let mut counts = vec![0_u32; self.grid.cells()];
        let (mut none, mut impossible) = (0, 0);
        for i in 0..self.samples {
            let u = Pattern::Random.d4(&SampleName::new(self.seed, [0, 0], i), Purpose::Custom);
            let Some(d) = sample(u) else {
                none += 1;
                continue;
            };
            counts[self.grid.cell(d)] += 1;
            let density = pdf(d);
            if !(density > 0.0 && density < f32::INFINITY) {
                impossible += 1;
            }
        }
        let shares = self.grid.integrate(|d| f64::from(pdf(d)), 1e-4);
        let integral: f64 = shares.iter().sum();
        let n = f64::from(self.samples);
        let mut cells: Vec<(f64, u32)> = shares.into_iter().map(|s| s * n).zip(counts).collect();
        cells.push(((1.0 - integral) * n, none));
        let (statistic, degrees) = pearson(cells);
        Outcome {
            p: chi_square_p(statistic, degrees),
            statistic,
            degrees,
            integral,
            drawn: 1.0 - f64::from(none) / n,
            impossible,
            samples: self.samples,
            tests: self.tests,
        }
    }
}

impl Outcome {
    /// `Err` with the figures when the sampler and its density disagree beyond chance (1 % for all tests together),
    /// or more than one draw in ten thousand (rounding at the edge of a density) is impossible.
    pub fn verdict(&self) -> Result<(), String> {
        let chance = sidak(0.01, self.tests);
        let fine = self.p >= chance && self.impossible <= self.samples / 10_000 && self.integral < 1.001;
        if fine { Ok(()) } else { Err(format!("{self} (needed p >= {chance:.2e})")) }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { p, statistic, degrees, integral, drawn, impossible, .. } = self;
        write!(
            f,
            "p = {p:.2e}, chi-square {statistic:.1} with {degrees} degrees of freedom, density integrates to \
             {integral:.5}, {drawn:.5} of the draws gave a direction, {impossible} of them with density 0 or not finite"
        )
    }
}

/// Pearson's statistic and its degrees of freedom of (expected, counted) pairs. Cells that expect fewer than five are
/// pooled.
fn pearson(mut cells: Vec<(f64, u32)>) -> (f64, usize) {
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut statistic, mut used) = (0.0, 0_usize);
    let (mut expected, mut counted) = (0.0, 0);
    for (e, c) in cells {
        expected += e;
        counted += c;
        if expected >= 5.0 {
            let d = f64::from(counted) - expected;
            statistic += d * d / expected;
            used += 1;
            (expected, counted) = (0.0, 0);
        }
    }
    (statistic, used.saturating_sub(1).max(1))
}

#[cfg(test)]
mod tests {
    use straal_math::warp;

    use super::*;

    #[test]
    fn right_samplers_pass() {
        let test = ChiSquare { tests: 3, ..ChiSquare::default() };
        let cosine =
            test.run(|u| Some(warp::cosine_hemisphere([u[0], u[1]])), |d| warp::cosine_hemisphere_pdf(d.z));
        cosine.verdict().unwrap();
        // A sampler that fails on a third of its draws.
        let lossy = test.run(
            |u| (u[2] < 2.0 / 3.0).then(|| warp::uniform_sphere([u[0], u[1]])),
            |_| warp::uniform_sphere_pdf() * 2.0 / 3.0,
        );
        lossy.verdict().unwrap();
        assert!((lossy.drawn - lossy.integral).abs() < 0.01);
        // A narrow cone off the grid's axis.
        let spread = 0.003;
        let cone = test.run(
            |u| Some(warp::uniform_cone([u[0], u[1]], spread)).map(|d| Vec3::new(d.z, d.x, d.y)),
            |d| if 1.0 - d.x <= spread { warp::uniform_cone_pdf(spread) } else { 0.0 },
        );
        cone.verdict().unwrap();
    }

    #[test]
    fn p_is_even_over_seeds() {
        let grid = SphereGrid { rings: 12, sectors: 12, ..SphereGrid::default() };
        let p: Vec<f64> = (0..40)
            .map(|seed| {
                let test = ChiSquare { grid, samples: 20_000, seed, tests: 1 };
                test.run(|u| Some(warp::uniform_sphere([u[2], u[3]])), |_| warp::uniform_sphere_pdf()).p
            })
            .collect();
        // The mean of 40 even numbers has standard deviation 0.046; that all are above 1e-4 has chance 0.996.
        let mean = p.iter().sum::<f64>() / 40.0;
        assert!((mean - 0.5).abs() < 0.15 && p.iter().all(|&p| p > 1e-4), "{p:?}");
    }

    #[test]
    fn wrong_samplers_fail() {
        let test = ChiSquare::default();
        let cosine = |u: [f32; 4]| Some(warp::cosine_hemisphere([u[0], u[1]]));
        let wrong: [(&str, &dyn Fn(Vec3) -> f32); 4] = [
            ("a density of another lobe", &|d| warp::uniform_hemisphere_pdf(d.z)),
            ("three per cent too much", &|d| 1.03 * warp::cosine_hemisphere_pdf(d.z)),
            ("three per cent too little", &|d| 0.97 * warp::cosine_hemisphere_pdf(d.z)),
            ("tilted by ten per cent", &|d| (1.0 + 0.1 * d.x) * warp::cosine_hemisphere_pdf(d.z)),
        ];
        for (name, pdf) in wrong {
            assert!(test.run(cosine, pdf).verdict().is_err(), "{name}");
        }
        let below = test.run(|u| cosine(u).map(|d| -d), |d| warp::cosine_hemisphere_pdf(d.z));
        assert!(below.impossible > 99_000 && below.verdict().is_err());
        let nan = test.run(cosine, |_| f32::NAN);
        assert!(nan.verdict().is_err());
    }
}
