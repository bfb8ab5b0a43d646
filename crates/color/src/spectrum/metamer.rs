//! Metamers: surfaces of one colour under one light that differ under another.

use straal_math::ops;

use super::{Bins, COUNT, FIRST, Illuminant, Observer, Quantity};
use crate::{Lab, Xyz};

/// The colour difference CIEDE2000 of two surfaces under a light, to eyes that have taken the light for white.
pub fn difference(a: &Bins, b: &Bins, light: &Bins, observer: Observer) -> f64 {
    let white = Xyz::new(observer.surface(&[1.0; COUNT], light));
    let lab = |surface: &Bins| Lab::from_xyz(Xyz::new(observer.surface(surface, light)), white);
    lab(a).delta_e_2000(lab(b))
}

/// The part of a spectrum that an observer doesn't see under a light: what is left when its projection on the three
/// colour-matching functions times the light is taken away (Wyszecki 1953, "metameric black"; Cohen and Kappauf 1982).
pub fn black(spectrum: &Bins, light: &Bins, observer: Observer) -> Bins {
    let functions = observer.functions();
    let mut basis: Vec<Bins> = Vec::with_capacity(3);
    let dot = |a: &Bins, b: &Bins| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum() };
    let take = |v: &mut Bins, along: &Bins, share: f64| {
        for (x, b) in v.iter_mut().zip(along) {
            *x -= share * b;
        }
    };
    let seen: [Bins; 3] = std::array::from_fn(|c| std::array::from_fn(|i| functions[i][c] * light[i]));
    for mut v in seen {
        for b in &basis {
            let share = dot(&v, b);
            take(&mut v, b, share);
        }
        let length = dot(&v, &v).sqrt();
        if length > 0.0 {
            basis.push(v.map(|x| x / length));
        }
    }
    let mut out = *spectrum;
    // Twice, since what rounding leaves is small only then.
    for _ in 0..2 {
        for b in &basis {
            let share = dot(&out, b);
            take(&mut out, b, share);
        }
    }
    out
}

/// A surface of the colour of `surface` under a light that differs as much as reflectances from 0 to 1 allow under tungsten
/// (or, where that is the light, under daylight), among metameric blacks made of waves of a few periods and phases. `None`
/// where there is no room: a perfect black or white has no metamer.
pub fn of(surface: &Bins, light: &Bins, observer: Observer) -> Option<Bins> {
    let judges = [Illuminant::A, Illuminant::D65].map(|light| light.spectrum().bins(Quantity::Emission));
    let mut best: Option<(f64, Bins)> = None;
    for (period, phase) in [70.0, 100.0, 140.0, 200.0].into_iter().flat_map(|p| (0..8).map(move |k| (p, k))) {
        let wave: Bins = std::array::from_fn(|i| {
            let nm = (FIRST + i) as f64;
            let (sin, _) = ops::sin_cos_degrees((nm - 400.0) * 360.0 / period + 45.0 * f64::from(phase));
            // Out towards the ends of what is seen, so that changes there, which nobody sees, don't use up the room.
            let x = (nm - 555.0) / 95.0;
            sin * ops::exp_d(-x * x)
        });
        let change = black(&wave, light, observer);
        // How far it may be added before a reflectance leaves [0, 1].
        let mut room = f64::INFINITY;
        for (r, d) in surface.iter().zip(&change) {
            let this = if *d > 0.0 {
                (1.0 - r) / d
            } else if *d < 0.0 {
                -r / d
            } else {
                f64::INFINITY
            };
            if this < room {
                room = this;
            }
        }
        if !room.is_finite() {
            continue;
        }
        let metamer: Bins = std::array::from_fn(|i| {
            let v = surface[i] + room * change[i];
            if v > 0.0 { if v < 1.0 { v } else { 1.0 } } else { 0.0 }
        });
        let apart = judges.iter().map(|judge| difference(surface, &metamer, judge, observer)).sum::<f64>();
        if apart > 0.01 && best.as_ref().is_none_or(|(most, _)| apart > *most) {
            best = Some((apart, metamer));
        }
    }
    best.map(|(_, metamer)| metamer)
}

#[cfg(test)]
mod tests {
    use super::super::{illuminant, uplift::Uplift};
    use super::*;

    #[test]
    fn metamers_match_under_one_light_only() {
        let (d65, a) =
            (illuminant::d65(), Illuminant::named("A").unwrap().spectrum().bins(Quantity::Emission));
        let uplift = Uplift::new();
        for rgb in [[0.4; 3], [0.45, 0.35, 0.25], [0.2, 0.3, 0.4], [0.3, 0.4, 0.2]] {
            let surface = uplift.fit(rgb).bins();
            let metamer = of(&surface, &d65, Observer::Cie1931).unwrap();
            assert!(metamer.iter().all(|v| (0.0..=1.0).contains(v)));
            let under = |light: &Bins| difference(&surface, &metamer, light, Observer::Cie1931);
            assert!(under(&d65) < 1e-6, "{rgb:?}: {}", under(&d65));
            assert!(under(&a) > 2.0, "{rgb:?}: {}", under(&a));
        }
        assert!(of(&[1.0; COUNT], &d65, Observer::Cie1931).is_none());
        assert!(of(&[0.0; COUNT], &d65, Observer::Cie1931).is_none());
    }

    #[test]
    fn blacks_are_black() {
        let light = illuminant::d65();
        let change = black(&std::array::from_fn(|i| f64::from(i as u32 % 7)), &light, Observer::Cie1964);
        let xyz = Observer::Cie1964.surface(&change, &light);
        assert!(xyz.iter().all(|v| v.abs() < 1e-9), "{xyz:?}");
    }
}
