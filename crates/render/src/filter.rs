//! Reconstruction filters: how a pixel weighs the picture around its centre.
//!
//! By importance sampling (Ernst et al. 2006) a sample's position is drawn in proportion to the filter's absolute height,
//! so that every sample belongs to one pixel, and a crop or tile never needs its neighbours. Where a filter is negative
//! the sample's weight is; weights are of one size, the integral of |f| over that of f, so that their mean is known to
//! be 1 and nothing is divided by their sum. What they differ from 1 by in a pixel, by chance, the film takes off.

use std::f64::consts::PI;
use straal_math::ops;
use straal_math::simd::Float;
use straal_math::table::Table1;

/// How a pixel weighs the picture around its centre.
#[derive(Clone, Debug, PartialEq)]
pub enum Filter {
    /// Evenly over the pixel's own square.
    Box,
    /// By f(x) f(y).
    Separable(Separable),
}

/// Where a sample lies, and what it weighs; or many, one in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSample<F = f32> {
    /// Displacement from the pixel's centre, in pixels.
    pub offset: [F; 2],
    /// What the sample's light is multiplied by; 1 on average.
    pub weight: F,
}

impl Filter {
    /// A place by two numbers of [0, 1).
    #[inline(always)]
    pub fn sample<F: Float>(&self, [u, v]: [F; 2]) -> FilterSample<F> {
        match self {
            Self::Box => FilterSample { offset: [u - 0.5, v - 0.5], weight: F::ONE },
            Self::Separable(f) => {
                let (x, y) = (f.sample(u), f.sample(v));
                FilterSample { offset: [x.0, y.0], weight: x.1 * y.1 }
            }
        }
    }

    /// The size of the samples' weights where some of them are negative.
    pub fn signed_weight(&self) -> Option<f32> {
        match self {
            Self::Box => None,
            Self::Separable(f) => {
                let size = f.weights.first().map_or(1.0, |w| w.abs());
                f.weights.iter().any(|w| *w < 0.0).then_some(size * size)
            }
        }
    }

    /// The height at `x` pixels from the centre as a part of the greatest there is.
    #[inline]
    pub fn relative_height(&self, x: f32) -> f32 {
        match self {
            Self::Box => self.height(x),
            Self::Separable(f) => f.step_at(x).map_or(0.0, |step| f.relative[step]),
        }
    }

    /// Half the filter's width in pixels.
    pub fn radius(&self) -> f32 {
        match self {
            Self::Box => 0.5,
            Self::Separable(f) => f.radius,
        }
    }

    /// The factor f(x) of the filter at `x` pixels from the centre, its integral being 1.
    #[inline]
    pub fn height(&self, x: f32) -> f32 {
        match self {
            Self::Box => {
                if (-0.5..0.5).contains(&x) {
                    1.0
                } else {
                    0.0
                }
            }
            Self::Separable(f) => f.height(x),
        }
    }
}

/// A filter's profile along one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Profile {
    /// Falls evenly to 0.
    Tent,
    /// max(0, exp(-x²/2s²) - exp(-r²/2s²)).
    Gaussian {
        /// Standard deviation s in pixels.
        sigma: f64,
    },
    /// The cubic of Mitchell and Netravali (1988), as wide as the radius says.
    Mitchell {
        /// How blurred.
        b: f64,
        /// How much it rings.
        c: f64,
    },
    /// The four-term window of Blackman and Harris (Harris 1978).
    BlackmanHarris,
    /// A sinc under the middle lobe of a wider one (Duchon 1979).
    Lanczos,
}

impl Profile {
    /// The height at `x`, up to a factor, for |x| below the radius; both in pixels.
    fn height(self, x: f64, radius: f64) -> f64 {
        let t = x.abs() / radius;
        match self {
            Self::Tent => 1.0 - t,
            Self::Gaussian { sigma } => {
                let bell = |x: f64| ops::exp_d(-x * x / (2.0 * sigma * sigma));
                bell(x) - bell(radius)
            }
            Self::Mitchell { b, c } => {
                let x = 2.0 * t;
                if x < 1.0 {
                    ((12.0 - 9.0 * b - 6.0 * c) * x + (-18.0 + 12.0 * b + 6.0 * c)) * x * x + (6.0 - 2.0 * b)
                } else {
                    (((-b - 6.0 * c) * x + (6.0 * b + 30.0 * c)) * x + (-12.0 * b - 48.0 * c)) * x
                        + (8.0 * b + 24.0 * c)
                }
            }
            Self::BlackmanHarris => {
                let cos = |k: f64| ops::sin_cos_d(k * PI * t).1;
                0.35875 + 0.48829 * cos(1.0) + 0.14128 * cos(2.0) + 0.01168 * cos(3.0)
            }
            Self::Lanczos => sinc(x) * sinc(t),
        }
    }
}

/// sin(πx) / πx.
fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { ops::sin_cos_d(PI * x).0 / (PI * x) }
}

/// Steps of a tabulated profile over its whole width.
const STEPS: usize = 512;

/// The filter f(x) f(y), f being 512 steps of equal width.
#[derive(Clone, Debug, PartialEq)]
pub struct Separable {
    /// |f|.
    steps: Table1,
    /// By step, what a sample there weighs: plus or minus the integral of |f| over that of f.
    weights: Vec<f32>,
    /// f as a part of its greatest height.
    relative: Vec<f32>,
    radius: f32,
}

impl Separable {
    /// The radius in pixels, finite and above 0; `None` when the profile's integral isn't above 0 in single precision.
    pub fn new(profile: Profile, radius: f64) -> Option<Self> {
        let heights: Vec<f32> = (0..STEPS)
            .map(|i| {
                let x = ((i as f64 + 0.5) / STEPS as f64 * 2.0 - 1.0) * radius;
                profile.height(x, radius) as f32
            })
            .collect();
        let absolute: Vec<f32> = heights.iter().map(|h| h.abs()).collect();
        let steps = Table1::new(&absolute)?;
        let sign = |h: &f32| if *h < 0.0 { -1.0 } else { 1.0 };
        let mean: f64 = heights.iter().enumerate().map(|(i, h)| sign(h) * f64::from(steps.pmf(i))).sum();
        // Below that, the samples would be noise and nothing else.
        if mean.is_nan() || mean < 1e-3 {
            return None;
        }
        let weights = heights.iter().map(|h| (sign(h) / mean) as f32).collect();
        let most = absolute.iter().copied().fold(0.0, ops::max);
        let relative = heights.iter().map(|h| h / most).collect();
        Some(Self { steps, weights, relative, radius: radius as f32 })
    }

    /// Signed distance from the centre for a number in [0, 1), and the weight.
    #[inline(always)]
    fn sample<F: Float>(&self, u: F) -> (F, F) {
        let choice = self.steps.samples(u);
        let x = ((F::from_uint(choice.index) + choice.rest) * (2.0 / STEPS as f32) - 1.0) * self.radius;
        (x, F::gather(&self.weights, choice.index))
    }

    /// The step that a place belongs to, in pixels from the centre.
    #[inline]
    fn step_at(&self, x: f32) -> Option<usize> {
        let place = (x / self.radius + 1.0) * (STEPS as f32 / 2.0);
        (0.0..STEPS as f32).contains(&place).then_some(place as usize)
    }

    #[inline]
    fn height(&self, x: f32) -> f32 {
        let Some(step) = self.step_at(x) else { return 0.0 };
        self.steps.pmf(step) * self.weights[step] * (STEPS as f32 / 2.0) / self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> Vec<(Profile, f64)> {
        vec![
            (Profile::Tent, 1.0),
            (Profile::Gaussian { sigma: 0.5 }, 1.5),
            (Profile::Gaussian { sigma: 5.0 }, 0.7),
            (Profile::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }, 2.0),
            (Profile::Mitchell { b: 0.0, c: 0.5 }, 3.0),
            (Profile::BlackmanHarris, 1.5),
            (Profile::Lanczos, 3.0),
            (Profile::Lanczos, 2.0),
        ]
    }

    /// The integral of f g over that of f, by the midpoint rule.
    fn integral(profile: Profile, radius: f64, g: impl Fn(f64) -> f64) -> f64 {
        let n = 200_000;
        let (mut sum, mut weight) = (0.0, 0.0);
        for i in 0..n {
            let x = ((f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0) * radius;
            let f = profile.height(x, radius);
            sum += f * g(x);
            weight += f;
        }
        sum / weight
    }

    #[test]
    fn weighted_samples_have_the_means_of_the_filter() {
        // Moments, and waves as a picture is made of.
        let probes: [fn(f64) -> f64; 4] = [|_| 1.0, |x| x, |x| x * x, |x| ops::sin_cos_d(2.0 * x + 0.3).0];
        for (profile, radius) in all() {
            let filter = Separable::new(profile, radius).unwrap();
            for probe in probes {
                let n = 100_000;
                let (mut sampled, mut tabulated) = (0.0, 0.0);
                for i in 0..n {
                    let u = (i as f32 + 0.5) / n as f32;
                    let (x, weight) = filter.sample(u);
                    assert!(f64::from(x.abs()) <= radius);
                    sampled += f64::from(weight) * probe(f64::from(x)) / f64::from(n);
                    let x = (2.0 * u - 1.0) * radius as f32;
                    tabulated +=
                        f64::from(filter.height(x)) * probe(f64::from(x)) * 2.0 * radius / f64::from(n);
                }
                let want = integral(profile, radius, probe);
                assert!((sampled - want).abs() < 2e-3, "{profile:?} {radius}: {sampled}, not {want}");
                assert!((tabulated - want).abs() < 2e-3, "{profile:?} {radius}: {tabulated}, not {want}");
            }
        }
    }

    #[test]
    fn profiles_are_the_published_ones() {
        // Mitchell and Netravali's recommended cubic: 16/18 in the middle, 1/18 a pixel away, 0 at two; its parts join.
        let m = |x| Profile::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }.height(x, 2.0) / 6.0;
        assert!((m(0.0) - 16.0 / 18.0).abs() < 1e-12 && (m(1.0) - 1.0 / 18.0).abs() < 1e-12);
        assert!((m(1.0 - 1e-9) - m(1.0)).abs() < 1e-8 && m(2.0).abs() < 1e-12 && m(1.5) < 0.0);
        // A sinc is 1 at 0 and 0 at whole numbers.
        let l = |x| Profile::Lanczos.height(x, 3.0);
        assert!((l(0.0) - 1.0).abs() < 1e-12 && l(1.0).abs() < 1e-12 && l(2.0).abs() < 1e-12 && l(1.5) < 0.0);
        let b = |x| Profile::BlackmanHarris.height(x, 1.0);
        assert!((b(0.0) - 1.0).abs() < 1e-12 && (b(1.0) - 6e-5).abs() < 1e-12);
        assert_eq!(Profile::Tent.height(0.25, 0.5), 0.5);
    }

    #[test]
    fn filters_without_negative_lobes_weigh_every_sample_1() {
        for (profile, radius) in all() {
            let filter = Filter::Separable(Separable::new(profile, radius).unwrap());
            let signed = matches!(profile, Profile::Mitchell { .. } | Profile::Lanczos);
            let weights = (0..1000).map(|i| filter.sample([i as f32 / 1000.0, 0.5]).weight);
            assert_eq!(weights.into_iter().all(|w| w == 1.0), !signed, "{profile:?}");
        }
    }

    #[test]
    fn empty_filters_are_none() {
        assert_eq!(Separable::new(Profile::Gaussian { sigma: 1e-30 }, 1.5), None);
        assert_eq!(Separable::new(Profile::Gaussian { sigma: 1e30 }, 1e-3), None);
        assert_eq!(Separable::new(Profile::Tent, f64::NAN), None);
    }

    #[test]
    fn box_covers_the_pixel() {
        let sample = Filter::Box.sample([0.0, 0.75]);
        assert_eq!(sample, FilterSample { offset: [-0.5, 0.25], weight: 1.0 });
    }
}
