//! Tail probabilities of Student's t and the binomial distribution, in double precision.
//!
//! Both are the regularised incomplete beta function I_x(a, b) (Abramowitz and Stegun 1964, 26.7.1 and 26.5.24),
//! computed by its continued fraction (26.5.8 there) with Lentz's method.

use straal_math::ops::{exp_d, ln_d};

/// The chance that Student's t with `dof` degrees of freedom is beyond `t` on either side. `dof` > 0.
pub(super) fn two_sided(t: f64, dof: f64) -> f64 {
    if t.is_nan() {
        return 1.0;
    }
    let square = t * t;
    if !square.is_finite() {
        return 0.0;
    }
    incomplete_beta(dof / (dof + square), 0.5 * dof, 0.5)
}

/// The chance of `count` or more among `n` trials of probability `p` each.
pub(super) fn binomial_at_least(count: usize, n: usize, p: f64) -> f64 {
    if count == 0 {
        return 1.0;
    }
    if count > n {
        return 0.0;
    }
    incomplete_beta(p, count as f64, (n - count + 1) as f64)
}

/// I_x(a, b) for x in [0, 1] and a, b > 0.
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    // The fraction converges fast below the mean of the beta distribution; beyond it the mirrored one does.
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta_below(1.0 - x, b, a);
    }
    incomplete_beta_below(x, a, b)
}

fn incomplete_beta_below(x: f64, a: f64, b: f64) -> f64 {
    let front = a * ln_d(x) + b * ln_d(1.0 - x) + ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b);
    let away_from_zero = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let mut c = 1.0;
    let mut d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut fraction = d;
    // The number of steps grows with the root of the larger parameter; a million trials take some thousand.
    for m in 1..20_000 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut step = 1.0;
        for term in [even, odd] {
            d = 1.0 / away_from_zero(1.0 + term * d);
            c = away_from_zero(1.0 + term / c);
            step = c * d;
            fraction *= step;
        }
        if (step - 1.0).abs() < 1e-15 {
            break;
        }
    }
    exp_d(front) * fraction / a
}

/// ln Γ(x) for x > 0: Stirling's series (Abramowitz and Stegun 6.1.41) after moving x to 10 or more.
fn ln_gamma(x: f64) -> f64 {
    let mut x = x;
    let mut moved = 1.0;
    while x < 10.0 {
        moved *= x;
        x += 1.0;
    }
    let inverse = 1.0 / x;
    let square = inverse * inverse;
    let series = inverse
        * (1.0 / 12.0
            - square * (1.0 / 360.0 - square * (1.0 / 1260.0 - square * (1.0 / 1680.0 - square / 1188.0))));
    const HALF_LN_TWO_PI: f64 = 0.918_938_533_204_672_7;
    (x - 0.5) * ln_d(x) - x + HALF_LN_TWO_PI + series - ln_d(moved)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() <= 1e-9 * expected, "{found} instead of {expected}");
    }

    #[test]
    fn gamma() {
        assert!(ln_gamma(1.0).abs() < 1e-13);
        close(ln_gamma(0.5), 0.5 * ln_d(std::f64::consts::PI));
        close(ln_gamma(11.0), ln_d(3_628_800.0));
    }

    #[test]
    fn students_t_in_closed_form() {
        // With 1 degree of freedom it is Cauchy's distribution, with 2 and 4 the integrals are elementary.
        for t in [0.1, 1.0, 3.0, 50.0] {
            close(two_sided(t, 1.0), 2.0 / std::f64::consts::PI * straal_math::ops::atan2_d(1.0, t));
            let root = (2.0 + t * t).sqrt();
            close(two_sided(t, 2.0), 2.0 / (root * (root + t)));
        }
        // A t of 2.947 is the table's 99 % bound for 15 degrees; far out it is the normal distribution.
        assert!((two_sided(2.946_71, 15.0) - 0.01).abs() < 1e-6);
        assert!((two_sided(2.575_829_3, 1e9) - 0.01).abs() < 1e-6);
        assert_eq!(two_sided(0.0, 15.0), 1.0);
        assert_eq!(two_sided(f64::INFINITY, 15.0), 0.0);
    }

    #[test]
    fn binomial_by_summing() {
        // P(X >= k) for n = 20, p = 0.3 by adding the terms.
        let term = |k: usize| {
            let choose = (0..k).fold(1.0, |c, i| c * (20 - i) as f64 / (i + 1) as f64);
            choose * (0..k).fold(1.0, |v, _| v * 0.3) * (k..20).fold(1.0, |v, _| v * 0.7)
        };
        for count in 0..=20 {
            close(binomial_at_least(count, 20, 0.3), (count..=20).map(term).sum());
        }
        assert_eq!(binomial_at_least(21, 20, 0.3), 0.0);
        // 200,000 pixels: near the mean one half, and the normal approximation four deviations out (its skewness
        // is 0.022, which raises 3.2e-5 by some 30 %).
        assert!((binomial_at_least(2000, 200_000, 0.01) - 0.5).abs() < 0.01);
        let far = binomial_at_least(2178, 200_000, 0.01);
        assert!((3.2e-5..5.5e-5).contains(&far), "{far}");
    }
}
