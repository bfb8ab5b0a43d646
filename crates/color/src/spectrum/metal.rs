//! Metals in red, green and blue.
//!
//! A metal's index of refraction n + ik differs so much over the wavelengths that its mean reflects otherwise than the metal:
//! gold by mean indices is 4.5 CIEDE2000 off. So red, green and blue each get the index of a metal that reflects, at every
//! angle, about as much of it as the real one does.

use straal_math::ops;

use super::{Bins, Observer, illuminant, uplift};
use crate::{Lab, Matrix3, Space, Xyz};

/// Angles at which the fit and the metal are compared: cosines (i + 1/2) / 16.
const ANGLES: usize = 16;

/// The most that a channel reflects when looked at straight. A metal of 1 has no index, and more than 1 would let light grow
/// between two of them.
const MOST: f64 = 0.999;

/// Real parts that are tried, in equal ratios from the first to the last.
const TRIED: usize = 240;
const FROM: f64 = 0.01;
const TO: f64 = 12.0;

/// Three indices of refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbIndex {
    /// The real parts.
    pub eta: [f64; 3],
    /// The imaginary parts.
    pub k: [f64; 3],
    /// What the metal reflects when looked at straight, before it was brought into what red, green and blue can be.
    pub facing: [f64; 3],
}

/// Share of unpolarised light that a metal of index `eta` + i `k` reflects where the cosine to its normal is `cos` (Born and
/// Wolf, Principles of Optics, 14.2).
pub fn reflected(cos: f64, eta: f64, k: f64) -> f64 {
    let (cos2, sin2) = (cos * cos, 1.0 - cos * cos);
    let real = eta * eta - k * k - sin2;
    let modulus = (real * real + 4.0 * eta * eta * k * k).sqrt();
    let a = (0.5 * (modulus + real)).abs().sqrt();
    let (sum, cross) = (modulus + cos2, 2.0 * a * cos);
    let s = (sum - cross) / (sum + cross);
    let (sum, cross) = (modulus * cos2 + sin2 * sin2, cross * sin2);
    let p_over_s = if sum + cross > 0.0 { (sum - cross) / (sum + cross) } else { 1.0 };
    0.5 * s * (1.0 + p_over_s)
}

/// The index in a space of RGB of a metal whose index is known by wavelength. Looked at straight it has the metal's colour
/// under D65 to three digits, where the space holds it and no channel is above 0.999; else the nearest by CIEDE2000 of those
/// that are darker as a whole. At other angles it is near by.
pub fn in_rgb(eta: &Bins, k: &Bins, space: Space) -> RgbIndex {
    let (light, to_rgb) = (illuminant::d65(), uplift::rgb_from_xyz(space));
    let colour = |cos: f64| {
        let bins = std::array::from_fn(|i| reflected(cos, eta[i], k[i]));
        to_rgb.apply(Observer::Cie1931.surface(&bins, &light))
    };
    let seen: [(f64, [f64; 3]); ANGLES] = std::array::from_fn(|i| {
        let cos = (i as f64 + 0.5) / ANGLES as f64;
        (cos, colour(cos))
    });
    let facing = colour(1.0);
    let wanted = possible(facing, &to_rgb);
    let mut out = RgbIndex { eta: [0.0; 3], k: [0.0; 3], facing };
    for c in 0..3 {
        (out.eta[c], out.k[c]) = fitted(wanted[c], &seen.map(|(cos, rgb)| (cos, rgb[c])));
    }
    out
}

/// The nearest colour that a metal of red, green and blue can have.
fn possible(rgb: [f64; 3], to_rgb: &Matrix3) -> [f64; 3] {
    let held = |v: f64| if v > 0.0 { if v < MOST { v } else { MOST } } else { 0.0 };
    let most = rgb.into_iter().fold(0.0, |a: f64, b| if b > a { b } else { a });
    let Some(back) = to_rgb.inverse().filter(|_| most > MOST) else { return rgb.map(held) };
    let white = Xyz::new(Observer::Cie1931.light(&illuminant::d65()));
    let lab = |rgb: [f64; 3]| Lab::from_xyz(Xyz::new(back.apply(rgb)), white);
    let wanted = lab(rgb);
    let darker = |step: u32| rgb.map(|v| held(v * (1.0 - (1.0 - MOST / most) * f64::from(step) / 32.0)));
    let mut best = (f64::INFINITY, rgb.map(held));
    for colour in (0..=32).map(darker) {
        let off = lab(colour).delta_e_2000(wanted);
        if off < best.0 {
            best = (off, colour);
        }
    }
    best.1
}

/// The index that reflects `facing` when looked at straight, and elsewhere, by cosine, most nearly what was `seen`.
fn fitted(facing: f64, seen: &[(f64, f64); ANGLES]) -> (f64, f64) {
    let mut best = (f64::INFINITY, 1.0, 0.0);
    for i in 0..=TRIED {
        let eta = FROM * ops::pow_d(TO / FROM, i as f64 / TRIED as f64);
        // Fresnel's equation at normal incidence, solved for k.
        let k2 = (facing * (eta + 1.0) * (eta + 1.0) - (eta - 1.0) * (eta - 1.0)) / (1.0 - facing);
        if k2 < 0.0 {
            continue;
        }
        let k = k2.sqrt();
        let off = |&(cos, want): &(f64, f64)| {
            let off = reflected(cos, eta, k) - want;
            off * off
        };
        let sum = seen.iter().map(off).sum();
        if sum < best.0 {
            best = (sum, eta, k);
        }
    }
    (best.1, best.2)
}

#[cfg(test)]
mod tests {
    use super::super::{Quantity, refraction::Metal};
    use super::*;

    fn delta_e(a: [f64; 3], b: [f64; 3], space: Space) -> f64 {
        let back = uplift::rgb_from_xyz(space).inverse().unwrap();
        let white = Xyz::new(Observer::Cie1931.light(&illuminant::d65()));
        let lab = |rgb| Lab::from_xyz(Xyz::new(back.apply(rgb)), white);
        lab(a).delta_e_2000(lab(b))
    }

    #[test]
    fn metals_have_their_colour_at_every_angle() {
        for space in [Space::Srgb, Space::AcesCg] {
            for metal in Metal::all() {
                let name = metal.name();
                let [eta, k] = metal.index().map(|s| s.bins(Quantity::Index));
                let fit = in_rgb(&eta, &k, space);
                let to_rgb = uplift::rgb_from_xyz(space);
                for cos in [1.0, 0.9, 0.7, 0.5, 0.3, 0.2, 0.1, 0.05] {
                    let bins = std::array::from_fn(|i| reflected(cos, eta[i], k[i]));
                    let want = to_rgb.apply(Observer::Cie1931.surface(&bins, &illuminant::d65()));
                    let got = std::array::from_fn(|c| reflected(cos, fit.eta[c], fit.k[c]));
                    let off = delta_e(got, want, space);
                    let lost = want.iter().any(|v| *v > MOST);
                    let allowed = if lost {
                        0.85
                    } else if cos == 1.0 {
                        0.01
                    } else {
                        0.6
                    };
                    assert!(off < allowed, "{name}, cosine {cos}: {got:.3?} for {want:.3?}, {off} CIEDE2000");
                }
            }
        }
    }

    #[test]
    fn gold_and_copper_are_those_of_the_wavelengths() {
        for (name, want) in [("gold", [1.038, 0.728, 0.365]), ("copper", [0.932, 0.623, 0.522])] {
            let [eta, k] = Metal::named(name).unwrap().index().map(|s| s.bins(Quantity::Index));
            let fit = in_rgb(&eta, &k, Space::Srgb);
            for (c, want) in want.into_iter().enumerate() {
                assert!((fit.facing[c] - want).abs() < 2e-3, "{name}: {:.4?}", fit.facing);
            }
            let got = std::array::from_fn(|c| reflected(1.0, fit.eta[c], fit.k[c]));
            assert!(got.iter().all(|v| *v < 1.0) && delta_e(got, want, Space::Srgb) < 1.0, "{got:?}");
        }
    }

    #[test]
    fn what_no_metal_is_still_has_an_index() {
        // A green beyond sRGB, black, and a perfect mirror.
        let green = std::array::from_fn(|i| if (140..190).contains(&i) { 9.0 } else { 0.0 });
        for (eta, k) in [([1.0; 471], green), ([1.0; 471], [0.0; 471]), ([0.0; 471], [1.0; 471])] {
            let fit = in_rgb(&eta, &k, Space::Srgb);
            let all = fit.eta.iter().chain(&fit.k).chain(&fit.facing);
            assert!(all.into_iter().all(|v| v.is_finite()), "{fit:?}");
            assert!(fit.eta.iter().all(|v| *v > 0.0), "{fit:?}");
        }
    }
}
