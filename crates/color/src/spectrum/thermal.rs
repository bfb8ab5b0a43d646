//! Light by temperature: black bodies and daylight.

use straal_math::ops;

use super::{FIRST, Interpolation, LAST, TabulatedSpectrum, rows};

/// A black body (Planck 1901) of a temperature in kelvins; relative, largest value 1. The second radiation constant is
/// that of CODATA 2018, 0.01438776877 m K.
pub fn black_body(kelvin: f64) -> TabulatedSpectrum {
    // By its logarithm: a cold body's light leaves the range of numbers.
    let log = |nm: f64| {
        let x = 1.438_776_877e7 / (nm * kelvin);
        let body = if x > 30.0 { x } else { ops::ln_d(ops::exp_d(x) - 1.0) };
        -5.0 * ops::ln_d(nm) - body
    };
    let most = (FIRST..=LAST).map(|nm| log(nm as f64)).fold(f64::MIN, |a: f64, b| if b > a { b } else { a });
    sampled(|nm| ops::exp_d(log(nm) - most))
}

/// Daylight of a correlated colour temperature from 4000 to 25000 K, relative, 100 at 560 nm: the CIE's D series (CIE
/// 15:2018, 4.1.2). `D65` is 6500 by its name and 6504 K by today's second radiation constant; here names count, as in the
/// CIE's tables. `None` beyond that range.
pub fn daylight(kelvin: f64) -> Option<TabulatedSpectrum> {
    if !(4000.0..=25000.0).contains(&kelvin) {
        return None;
    }
    let t = kelvin * (1.4388 / 1.4380);
    let x = if t <= 7000.0 {
        ((-4.6070e9 / t + 2.9678e6) / t + 0.09911e3) / t + 0.244_063
    } else {
        ((-2.0064e9 / t + 1.9018e6) / t + 0.24748e3) / t + 0.237_040
    };
    let y = -3.0 * x * x + 2.870 * x - 0.275;
    let m = 0.0241 + 0.2562 * x - 0.7341 * y;
    // The CIE's tables round the two factors to three places.
    let rounded = |v: f64| (v * 1000.0).round() / 1000.0;
    let m1 = rounded((-1.3515 - 1.7703 * x + 5.9114 * y) / m);
    let m2 = rounded((0.0300 - 31.4424 * x + 30.0717 * y) / m);
    let (mut wavelengths, mut values) = (Vec::new(), Vec::new());
    for row in rows(include_str!("../../data/daylight.txt")) {
        let [Some(nm), Some(s0), Some(s1), Some(s2)] = row[..] else { continue };
        wavelengths.push(nm);
        let value = s0 + m1 * s1 + m2 * s2;
        values.push(if value > 0.0 { value } else { 0.0 });
    }
    // The CIE's daylight lies on straight lines between the rows of this table.
    TabulatedSpectrum::new(wavelengths, values).ok()?.interpolated(Interpolation::Linear).ok()
}

/// A formula at each nanometre.
pub(super) fn sampled(power: impl Fn(f64) -> f64) -> TabulatedSpectrum {
    TabulatedSpectrum::of_bins(&std::array::from_fn(|i| power((FIRST + i) as f64)))
}
