//! The sky of Hošek and Wilkie (2012, "An Analytic Model for Full Spectral Sky-Dome Radiance") in red, green and blue, and the sun in it (2013, "Adding a
//! Solar Radiance Function to the Hošek-Wilkie Skylight Model").
//!
//! Both are fits to what light is scattered in simulated air. Nine parameters say how radiance is distributed over the sky; they are tabulated by turbidity, by the
//! ground's albedo and by the sun's height, between whose control points lies a Bézier curve of fifth degree in the cube root.

use straal_color::spectrum::TabulatedSpectrum;
use straal_math::{ops, simd::Float};

/// See `data/README.md`.
static TABLES: &[u8] = include_bytes!("../../../data/sky.bin");

const TURBIDITIES: usize = 10;
const CONTROLS: usize = 6;
const PARAMETERS: usize = 9;
/// Of the sun: 2, 5 ... 89 degrees above the horizon, and 320, 360 ... 720 nm.
const HEIGHTS: usize = 30;
const WAVELENGTHS: usize = 11;

/// Where the parameters begin, and the sun.
const DISTRIBUTIONS: usize = TURBIDITIES * 2 * CONTROLS * 3;
const SUN: usize = DISTRIBUTIONS * (1 + PARAMETERS);

fn number(i: usize) -> f64 {
    let bytes = TABLES.get(4 * i..4 * i + 4).and_then(|b| b.try_into().ok()).unwrap_or_default();
    f64::from(f32::from_le_bytes(bytes))
}

/// A place between two neighbours of so many: the first of the two, and the share of the second.
fn between(place: f64, count: usize) -> (usize, f64) {
    let last = (count - 1) as f64;
    let place = if place > 0.0 { if place < last { place } else { last } } else { 0.0 };
    let first = (place as usize).min(count - 2);
    (first, place - first as f64)
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// A sky, of air of some turbidity (1 to 10) over a ground of some albedo in linear sRGB, with the sun so many radians above the horizon.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// By channel.
    channels: [Channel; 3],
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Channel {
    /// A to I of the paper's equation 8.
    parameters: [f32; PARAMETERS],
    /// In W/(m² sr nm).
    radiance: f32,
}

impl Model {
    pub fn new(turbidity: f64, albedo: [f64; 3], elevation: f64) -> Self {
        let (hazy, more) = between(turbidity - 1.0, TURBIDITIES);
        // Weights of the control points.
        let high = elevation / std::f64::consts::FRAC_PI_2;
        let x = if high > 0.0 { ops::pow_d(if high < 1.0 { high } else { 1.0 }, 1.0 / 3.0) } else { 0.0 };
        let binomials = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
        let power = |base: f64, n: usize| (0..n).fold(1.0, |p, _| p * base);
        let weights: [f64; CONTROLS] =
            std::array::from_fn(|k| binomials[k] * power(x, k) * power(1.0 - x, CONTROLS - 1 - k));
        let channel = |c: usize| {
            // A number for each turbidity, albedo and control point.
            let of = |index: &dyn Fn(usize) -> usize| {
                let at = |turbidity: usize, albedo: usize| {
                    let of_control =
                        |k: usize| number(index(((turbidity * 2 + albedo) * CONTROLS + k) * 3 + c));
                    weights.iter().enumerate().map(|(k, w)| w * of_control(k)).sum::<f64>()
                };
                let over = |t: usize| mix(at(t, 0), at(t, 1), albedo[c]);
                mix(over(hazy), over(hazy + 1), more)
            };
            Channel {
                parameters: std::array::from_fn(|p| of(&|i| DISTRIBUTIONS + i * PARAMETERS + p) as f32),
                radiance: of(&|i| i) as f32,
            }
        };
        Self { channels: [0, 1, 2].map(channel) }
    }

    /// Radiance in linear sRGB, in W/(m² sr nm), where `up` is the cosine of the angle from straight up, 0 or more, and `gamma` the angle from the sun in
    /// radians, `cos_gamma` its cosine: the paper's equations 8 and 9.
    #[inline(always)]
    pub fn radiance<F: Float>(&self, up: F, (gamma, cos_gamma): (F, F)) -> [F; 3] {
        let squared = cos_gamma * cos_gamma;
        let (level, root) = (F::ONE / (up + 0.01), up.sqrt());
        self.channels.each_ref().map(
            #[inline(always)]
            |Channel { parameters, radiance }| {
                let [a, b, c, d, e, f, g, i, h] = *parameters;
                let towards_horizon = ops::exp(level * b) * a + 1.0;
                let base = F::splat(1.0 + h * h) - cos_gamma * (2.0 * h);
                // The bright ring about the sun; the base is (1 - h)² at the least.
                let ring = (squared + 1.0) / (base * base.max(F::ZERO).sqrt());
                let about_sun = ops::exp(gamma * e) * d + squared * f + ring * g + root * i + c;
                (towards_horizon * about_sun * *radiance).max(F::ZERO)
            },
        )
    }
}

/// The sun's irradiance on a surface that faces it, in W/(m² nm), so many degrees above the horizon; below two as at two.
pub fn sun(turbidity: f64, degrees: f64) -> TabulatedSpectrum {
    let (hazy, more) = between(turbidity - 1.0, TURBIDITIES);
    let (low, higher) = between((degrees - 2.0) / 3.0, HEIGHTS);
    let value = |w: usize| {
        let at = |t: usize, h: usize| number(SUN + (t * HEIGHTS + h) * WAVELENGTHS + w);
        let of = |t: usize| mix(at(t, low), at(t, low + 1), higher);
        let v = mix(of(hazy), of(hazy + 1), more);
        if v > 0.0 { v } else { 0.0 }
    };
    let wavelengths = (0..WAVELENGTHS).map(|w| (320 + 40 * w) as f64).collect();
    TabulatedSpectrum::new(wavelengths, (0..WAVELENGTHS).map(value).collect()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_are_whole() {
        assert_eq!(TABLES.len(), 4 * (SUN + TURBIDITIES * HEIGHTS * WAVELENGTHS));
        assert!((0..TABLES.len() / 4).all(|i| number(i).is_finite()));
    }

    /// Against another program's numbers: turbidity 4, a brown ground, the sun at 28.9 degrees (the shared reference `sunsky`).
    #[test]
    fn it_is_the_published_sky() {
        let sin = 0.483_842_968_940_734_86_f64;
        let elevation = std::f64::consts::FRAC_PI_2 - ops::acos_d(sin);
        let model = Model::new(4.0, [0.25, 0.2, 0.15], elevation);
        let zenith = model.radiance(1.0_f32, (ops::acos_d(sin) as f32, sin as f32));
        let want = [0.049_228_11, 0.082_696_84, 0.147_073_55].map(|v: f32| v / 2.5);
        for c in 0..3 {
            assert!((zenith[c] / want[c] - 1.0).abs() < 1e-4, "{zenith:?}, expected {want:?}");
        }
    }

    /// Hazier air scatters more of the sun's light, and a low sun's is redder.
    #[test]
    fn the_sun_is_weaker_and_redder_through_more_air() {
        use straal_color::spectrum::Quantity;
        let at = |turbidity, degrees, nm| sun(turbidity, degrees).at(nm, Quantity::Emission);
        assert!(at(2.0, 60.0, 560.0) > at(4.0, 60.0, 560.0) && at(4.0, 60.0, 560.0) > at(9.0, 60.0, 560.0));
        assert!(at(3.0, 60.0, 560.0) > 1.0 && at(3.0, 60.0, 560.0) < 1.8);
        assert!(
            at(3.0, 5.0, 440.0) / at(3.0, 5.0, 640.0) < 0.3 * at(3.0, 60.0, 440.0) / at(3.0, 60.0, 640.0)
        );
        // Beyond the table its ends hold.
        assert_eq!((sun(0.0, -10.0), sun(20.0, 90.0)), (sun(1.0, 2.0), sun(10.0, 89.0)));
    }
}
