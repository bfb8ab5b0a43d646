//! Between light and what the network sees of it: numbers from 0 to about 1 that eyes would find evenly spaced.

use crate::Signal;
use straal_math::ops;
use straal_math::simd::Float;

/// The greatest number that the scale of light is made for: the greatest half float.
const BRIGHTEST: f32 = 65504.0;

/// From light to the network and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Transfer {
    signal: Signal,
    /// What light is multiplied by before anything else.
    exposure: f32,
    /// What the curve gives for [`BRIGHTEST`].
    most: f32,
}

impl Transfer {
    pub fn new(signal: Signal, exposure: f32) -> Self {
        Self { signal, exposure, most: perceptual(BRIGHTEST) }
    }

    /// What the network sees.
    #[inline(always)]
    pub fn forward<F: Float>(&self, light: F) -> F {
        match self.signal {
            Signal::Light => {
                let light = ops::clamp(light * self.exposure, F::ZERO, F::splat(f32::MAX));
                perceptual(light) * (1.0 / self.most)
            }
            Signal::Albedo => srgb(albedo(light)),
            Signal::Normal => normal(light),
        }
    }

    /// What the network means.
    #[inline(always)]
    pub fn inverse<F: Float>(&self, seen: F) -> F {
        let seen = ops::clamp(seen, F::ZERO, F::splat(f32::MAX));
        match self.signal {
            Signal::Light => {
                let out = if self.exposure != 0.0 { 1.0 / self.exposure } else { 0.0 };
                ops::clamp(inverse_perceptual(seen * self.most) * out, F::ZERO, F::splat(f32::MAX))
            }
            Signal::Albedo => ops::min(inverse_srgb(seen), F::ONE),
            Signal::Normal => ops::clamp(seen * 2.0 - F::ONE, -F::ONE, F::ONE),
        }
    }
}

/// What the network sees of an albedo beside light.
#[inline(always)]
pub(crate) fn albedo<F: Float>(x: F) -> F {
    ops::clamp(x, F::ZERO, F::ONE)
}

/// What the network sees of a coordinate of a normal beside light.
#[inline(always)]
pub(crate) fn normal<F: Float>(x: F) -> F {
    let x = F::select(x.is_nan(), F::ZERO, x);
    ops::clamp(x, -F::ONE, F::ONE) * 0.5 + F::splat(0.5)
}

/// The constants of the curve that Open Image Denoise fits to the perceptually uniform encoding of Aydin, Mantiuk and Seidel 2008: linear, then a power, then a
/// logarithm. They are part of the weights.
mod fit {
    pub const SLOPE: f32 = 1.412_837_6e3;
    pub const POWER: [f32; 3] = [1.645_931_7, 0.431_384_98, -2.941_396e-3];
    pub const LOG: [f32; 3] = [0.192_653_25, 6.260_261e-3, 0.998_620_15];
    /// Light at which one piece gives way to the next, and what the curve gives there.
    pub const LIGHT: [f32; 2] = [1.579_457_6e-6, 3.220_876_3e-2];
    pub const SEEN: [f32; 2] = [2.231_517e-3, 0.370_974_75];
}

#[inline(always)]
fn perceptual<F: Float>(y: F) -> F {
    let [b, c, d] = fit::POWER;
    let [e, f, g] = fit::LOG;
    let linear = y * fit::SLOPE;
    let power = ops::pow(y, F::splat(c)) * b + F::splat(d);
    let log = ops::ln(y + F::splat(f)) * e + F::splat(g);
    let low = F::select(y.le(F::splat(fit::LIGHT[0])), linear, power);
    F::select(y.le(F::splat(fit::LIGHT[1])), low, log)
}

#[inline(always)]
fn inverse_perceptual<F: Float>(x: F) -> F {
    let [b, c, d] = fit::POWER;
    let [e, f, g] = fit::LOG;
    let linear = x / fit::SLOPE;
    let power = ops::pow((x - F::splat(d)) / b, F::splat(1.0 / c));
    let log = ops::exp((x - F::splat(g)) / e) - F::splat(f);
    let low = F::select(x.le(F::splat(fit::SEEN[0])), linear, power);
    F::select(x.le(F::splat(fit::SEEN[1])), low, log)
}

#[inline(always)]
fn srgb<F: Float>(y: F) -> F {
    let curve = ops::pow(y, F::splat(1.0 / 2.4)) * 1.055 - F::splat(0.055);
    F::select(y.le(F::splat(0.003_130_8)), y * 12.92, curve)
}

#[inline(always)]
fn inverse_srgb<F: Float>(x: F) -> F {
    let curve = ops::pow((x + F::splat(0.055)) / 1.055, F::splat(2.4));
    F::select(x.le(F::splat(0.040_45)), x / 12.92, curve)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        for signal in [Signal::Light, Signal::Albedo, Signal::Normal] {
            let transfer = Transfer::new(signal, 0.25);
            for x in [0.0, 1e-6, 1e-5, 0.01, 0.03, 0.5, 1.0, 200.0, 65504.0_f32] {
                if x > 1.0 && signal != Signal::Light {
                    continue;
                }
                let back = transfer.inverse(transfer.forward(x));
                // The logarithm of a bright pixel is known to 2^-24, its light to six times as much and more.
                assert!((back - x).abs() <= 1e-5 * x + 1e-7, "{signal:?} {x} {back}");
            }
        }
    }

    #[test]
    fn what_is_no_light_is_black_or_the_brightest() {
        let transfer = Transfer::new(Signal::Light, 1.0);
        assert_eq!(transfer.forward(f32::NAN), 0.0);
        assert_eq!(transfer.forward(-1.0), 0.0);
        assert!(transfer.forward(f32::INFINITY).is_finite());
        assert_eq!(transfer.inverse(f32::INFINITY), f32::MAX);
        assert_eq!(transfer.inverse(f32::NAN), 0.0);
        assert_eq!(normal(f32::NAN), 0.5);
        assert_eq!(albedo(7.0), 1.0);
    }
}
