//! Reconstruction filters, by importance sampling (Ernst et al. 2006): a sample's position within the filter is
//! drawn with the filter's own density, so that every sample weighs 1, belongs to one pixel, and a crop or tile
//! never needs its neighbours.

use straal_math::ops;
use straal_math::table::Table1;

/// How a pixel weighs the picture around its centre.
#[derive(Clone, Debug, PartialEq)]
pub enum Filter {
    /// Evenly over the pixel's own square.
    Box,
    /// A Gaussian lowered so that it ends at its radius.
    Gaussian(Gaussian),
}

impl Filter {
    /// Displacement from the pixel's centre, in pixels.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> [f32; 2] {
        match self {
            Self::Box => [u[0] - 0.5, u[1] - 0.5],
            Self::Gaussian(g) => [g.sample(u[0]), g.sample(u[1])],
        }
    }
}

/// Steps of the tabulated bell over its whole width.
const STEPS: usize = 512;

/// The separable filter g(x) g(y) with g(x) = max(0, exp(-x²/2s²) - exp(-r²/2s²)), as 512 steps of equal width.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaussian {
    bell: Table1,
    radius: f32,
}

impl Gaussian {
    /// Both in pixels, finite and above 0; `None` when the bell is nowhere above 0 in single precision.
    pub fn new(radius: f64, sigma: f64) -> Option<Self> {
        let height = |x: f64| ops::exp_d(-x * x / (2.0 * sigma * sigma));
        let weight = |i: usize| {
            let x = ((i as f64 + 0.5) / STEPS as f64 * 2.0 - 1.0) * radius;
            (height(x) - height(radius)) as f32
        };
        let weights: Vec<f32> = (0..STEPS).map(weight).collect();
        Some(Self { bell: Table1::new(&weights)?, radius: radius as f32 })
    }

    /// Signed distance from the centre for a number in [0, 1).
    #[inline]
    fn sample(&self, u: f32) -> f32 {
        let choice = self.bell.sample(u);
        ((choice.index as f32 + choice.rest) * (2.0 / STEPS as f32) - 1.0) * self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaussian_has_its_variance_and_stays_within_its_radius() {
        let (radius, sigma) = (1.5_f64, 0.5_f64);
        let g = Gaussian::new(radius, sigma).unwrap();
        let n = 100_000;
        let (mut sum, mut square) = (0.0_f64, 0.0_f64);
        for i in 0..n {
            let x = f64::from(g.sample((i as f32 + 0.5) / n as f32));
            assert!(x.abs() <= radius);
            sum += x;
            square += x * x;
        }
        // Variance of the lowered Gaussian by direct integration.
        let (mut weight, mut second) = (0.0, 0.0);
        for i in 0..100_000 {
            let x = (i as f64 + 0.5) / 100_000.0 * radius;
            let height = |x: f64| ops::exp_d(-x * x / (2.0 * sigma * sigma));
            let w = height(x) - height(radius);
            weight += w;
            second += w * x * x;
        }
        assert!((sum / n as f64).abs() < 1e-4);
        assert!((square / n as f64 - second / weight).abs() < 1e-3 * second / weight);
    }

    #[test]
    fn box_covers_the_pixel() {
        assert_eq!(Filter::Box.sample([0.0, 0.75]), [-0.5, 0.25]);
    }
}
