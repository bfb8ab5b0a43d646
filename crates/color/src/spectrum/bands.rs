//! Bands of wavelengths, as a film of spectra holds light, and what the eye makes of them.

use super::{Bins, COUNT, FIRST, LAST, Observer, interpolation};

/// Bands of equal width, side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bands {
    from: f64,
    to: f64,
    count: u32,
}

impl Bands {
    /// So many bands between two wavelengths in nm, at least two; `None` where these don't lie within what is computed
    /// with, in their order, or where a band were narrower than the nanometre that spectra are told by.
    pub fn new(from: f64, to: f64, count: u32) -> Option<Self> {
        let inside = from >= FIRST as f64 && to <= LAST as f64;
        (inside && count >= 2 && to - from >= f64::from(count)).then_some(Self { from, to, count })
    }

    /// How many.
    pub const fn count(&self) -> usize {
        self.count as usize
    }

    /// Where the first begins and the last ends, in nm.
    pub const fn ends(&self) -> [f64; 2] {
        [self.from, self.to]
    }

    /// Width of each in nm.
    pub fn width(&self) -> f64 {
        (self.to - self.from) / f64::from(self.count)
    }

    /// The middle of a band in nm.
    pub fn center(&self, band: usize) -> f64 {
        self.from + (band as f64 + 0.5) * self.width()
    }

    /// How much of a nanometre (from 0 for [`FIRST`], reaching half of one to both sides) lies in a band and how much in the
    /// next; 0 for what lies in none.
    pub fn shares(&self, nanometre: usize) -> (usize, [f64; 2]) {
        let [low, high] = reach_of(nanometre);
        let place = (low - self.from) / self.width();
        let first = if place > 0.0 { (place as usize).min(self.count() - 1) } else { 0 };
        let border = self.from + first as f64 * self.width();
        let share = |band: usize| {
            let start = border + band as f64 * self.width();
            if first + band < self.count() {
                overlap([low, high], [start, start + self.width()])
            } else {
                0.0
            }
        };
        (first, [share(0), share(1)])
    }
}

/// The wavelengths that a number for each nanometre stands for.
fn reach_of(nanometre: usize) -> [f64; 2] {
    let middle = (FIRST + nanometre) as f64;
    [middle - 0.5, middle + 0.5]
}

fn overlap(a: [f64; 2], b: [f64; 2]) -> f64 {
    let start = if a[0] > b[0] { a[0] } else { b[0] };
    let end = if a[1] < b[1] { a[1] } else { b[1] };
    if end > start { end - start } else { 0.0 }
}

/// What light of 1 at each of some wavelengths adds to X, Y and Z of the observer of 1931, in the units of
/// [`Observer::light`]. The light is taken to be the same as far as the middle between a wavelength and the next, and as
/// far again beyond the first and last: so [`Bands`] are summed exactly. The wavelengths, in nm, rise; there are two at least,
/// or nothing is known of their width and the answer is empty.
pub fn xyz_of_samples(wavelengths: &[f64]) -> Vec<[f64; 3]> {
    let n = wavelengths.len();
    if n < 2 {
        return Vec::new();
    }
    let functions = Observer::Cie1931.functions();
    let unit: f64 = functions.iter().map(|xyz| xyz[1]).sum();
    let half = |k: usize| 0.5 * (wavelengths[k + 1] - wavelengths[k]);
    (0..n)
        .map(|k| {
            let below = half(if k > 0 { k - 1 } else { 0 });
            let above = half(if k + 1 < n { k } else { n - 2 });
            let reach = [wavelengths[k] - below, wavelengths[k] + above];
            let mut xyz = [0.0; 3];
            for (i, function) in functions.iter().enumerate().take(COUNT) {
                let share = overlap(reach_of(i), reach) / unit;
                for c in 0..3 {
                    xyz[c] += function[c] * share;
                }
            }
            xyz
        })
        .collect()
}

/// What a reflectance of 1 at each of some wavelengths adds to X, Y and Z under a light, in the units of
/// [`Observer::surface`]: the weights that ASTM E308 tabulates for wavelengths in equal steps. Between the wavelengths lies what
/// [`TabulatedSpectrum::new`](super::TabulatedSpectrum::new) takes to lie there, but that curves may leave what can be. The wavelengths, in nm, rise.
/// Empty where none of them is seen.
pub fn xyz_of_reflectances(wavelengths: &[f64], light: &Bins) -> Vec<[f64; 3]> {
    if !wavelengths.iter().any(|nm| (FIRST as f64..=LAST as f64).contains(nm)) {
        return Vec::new();
    }
    let functions = Observer::Cie1931.functions();
    let white: f64 = functions.iter().zip(light).map(|(xyz, l)| xyz[1] * l).sum();
    let mut sums = vec![[0.0; 3]; wavelengths.len()];
    for (i, (function, l)) in functions.iter().zip(light).enumerate() {
        for (k, weight) in interpolation::weights(wavelengths, (FIRST + i) as f64) {
            for c in 0..3 {
                sums[k][c] += function[c] * l * weight / white;
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::super::{Quantity, TabulatedSpectrum, illuminant};
    use super::*;

    #[test]
    fn bands_share_out_every_nanometre_within_them() {
        for (from, to, count) in
            [(380.0, 780.0, 16), (360.0, 830.0, 470), (401.3, 699.9, 7), (360.0, 830.0, 2)]
        {
            let bands = Bands::new(from, to, count).unwrap();
            let mut widths = vec![0.0; bands.count()];
            for i in 0..COUNT {
                let (first, [a, b]) = bands.shares(i);
                widths[first] += a;
                if b > 0.0 {
                    widths[first + 1] += b;
                }
            }
            for w in widths {
                assert!((w - bands.width()).abs() < 1e-9, "{from} {to} {count}: {w}");
            }
        }
    }

    #[test]
    fn bands_that_make_no_sense_are_none() {
        for (from, to, count) in
            [(350.0, 780.0, 16), (380.0, 831.0, 16), (500.0, 400.0, 4), (400.0, 410.0, 11)]
        {
            assert_eq!(Bands::new(from, to, count), None);
        }
        assert_eq!(Bands::new(f64::NAN, 780.0, 16), None);
        assert_eq!(Bands::new(380.0, 780.0, 1), None);
    }

    #[test]
    fn samples_at_the_middles_of_bands_are_summed_exactly() {
        let bands = Bands::new(380.0, 780.0, 16).unwrap();
        let middles: Vec<f64> = (0..16).map(|k| bands.center(k)).collect();
        let functions = Observer::Cie1931.functions();
        let unit: f64 = functions.iter().map(|xyz| xyz[1]).sum();
        let mut want = vec![[0.0; 3]; 16];
        for (i, function) in functions.iter().enumerate() {
            let (first, shares) = bands.shares(i);
            for (k, share) in shares.into_iter().enumerate().filter(|(_, s)| *s > 0.0) {
                for c in 0..3 {
                    want[first + k][c] += function[c] * share / unit;
                }
            }
        }
        for (a, b) in xyz_of_samples(&middles).as_flattened().iter().zip(want.as_flattened()) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        assert!(xyz_of_samples(&[555.0]).is_empty());
    }

    #[test]
    fn weights_of_reflectances_are_those_of_the_spectrum() {
        let light = illuminant::d65();
        let ten: Vec<f64> = (38..=73).map(|k| 10.0 * f64::from(k)).collect();
        for wavelengths in [ten, vec![400.0, 470.0, 500.0, 700.0], vec![555.0], vec![300.0, 820.0, 900.0]] {
            // Neither near 0 nor near 1, so that curves stay where they can be.
            let value = |nm: &f64| 0.5 + 0.2 * straal_math::ops::sin_cos_degrees(2.0 * nm).0;
            let values: Vec<f64> = wavelengths.iter().map(value).collect();
            let weights = xyz_of_reflectances(&wavelengths, &light);
            let sum = |c: usize| weights.iter().zip(&values).map(|(w, v)| w[c] * v).sum::<f64>();
            let spectrum = TabulatedSpectrum::new(wavelengths.clone(), values.clone()).unwrap();
            let want = Observer::Cie1931.surface(&spectrum.bins(Quantity::Reflectance), &light);
            for (c, want) in want.into_iter().enumerate() {
                assert!((sum(c) - want).abs() < 1e-12, "{wavelengths:?}: {} {want}", sum(c));
            }
        }
        assert!(xyz_of_reflectances(&[900.0, 1000.0], &light).is_empty());
        assert!(xyz_of_reflectances(&[], &light).is_empty());
    }
}
