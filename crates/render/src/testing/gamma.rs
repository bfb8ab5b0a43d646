//! The incomplete gamma function, for the probability of a chi-square statistic.

use straal_math::ops::{exp_d, ln_d};

/// Natural logarithm of the gamma function for x > 0 (Lanczos 1964, g = 7 with nine coefficients after Godfrey).
pub fn ln_gamma(x: f64) -> f64 {
    const G: f64 = 7.0;
    const C: [f64; 9] = [
        0.999_999_999_999_809_9,
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let x = x - 1.0;
    let series = (1..9).fold(C[0], |sum, i| sum + C[i] / (x + i as f64));
    let t = x + G + 0.5;
    0.5 * ln_d(2.0 * std::f64::consts::PI) + (x + 0.5) * ln_d(t) - t + ln_d(series)
}

/// The regularised upper incomplete gamma function Q(a, x) for a > 0: by its series below a + 1, by Lentz's continued
/// fraction above (Abramowitz and Stegun 6.5.29, 6.5.31). 1 for x <= 0.
pub fn gamma_q(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let front = exp_d(a * ln_d(x) - x - ln_gamma(a));
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > sum * 1e-17 {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        return 1.0 - front * sum;
    }
    const TINY: f64 = 1e-300;
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / TINY;
    let mut d = 1.0 / b;
    let mut h = d;
    for i in 1..100_000 {
        let i = f64::from(i);
        let an = -i * (i - a);
        b += 2.0;
        d = an * d + b;
        d = if d.abs() < TINY { TINY } else { d };
        c = b + an / c;
        c = if c.abs() < TINY { TINY } else { c };
        d = 1.0 / d;
        let step = d * c;
        h *= step;
        if (step - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * h
}

/// The probability that chance gives a chi-square statistic at least this large; 0 for infinity and NaN.
pub fn chi_square_p(statistic: f64, degrees: usize) -> f64 {
    if statistic < f64::INFINITY { gamma_q(degrees as f64 / 2.0, statistic / 2.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gamma_of_whole_numbers_is_the_factorial() {
        let mut factorial = 1.0;
        for n in 1..20 {
            assert!((exp_d(ln_gamma(f64::from(n))) / factorial - 1.0).abs() < 1e-12, "{n}");
            factorial *= f64::from(n);
        }
        assert!((2.0 * ln_gamma(0.5) - ln_d(std::f64::consts::PI)).abs() < 1e-13);
    }

    #[test]
    fn probabilities_are_those_of_the_tables() {
        // Two degrees of freedom: exp(-x/2). The others from the tables of any textbook.
        for x in [0.1, 1.0, 3.0, 10.0, 40.0] {
            assert!((chi_square_p(x, 2) / exp_d(-x / 2.0) - 1.0).abs() < 1e-12);
        }
        for (x, degrees, p) in
            [(3.841, 1, 0.05), (18.307, 10, 0.05), (23.209, 10, 0.01), (124.342, 100, 0.05)]
        {
            assert!((chi_square_p(x, degrees) / p - 1.0).abs() < 1e-3, "{x}, {degrees}");
        }
        assert_eq!(chi_square_p(f64::INFINITY, 5), 0.0);
        assert_eq!(chi_square_p(f64::NAN, 5), 0.0);
        assert_eq!(chi_square_p(0.0, 5), 1.0);
    }

    #[test]
    fn many_tests_share_the_level() {
        let each = super::super::sidak(0.01, 100);
        assert!((0.99 - straal_math::ops::pow_d(1.0 - each, 100.0)).abs() < 1e-12);
    }
}
