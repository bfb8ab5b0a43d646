//! Against the platform's double precision functions, in units in the last place.

use super::*;

/// Numbers of all sizes and both signs, a prime step apart in their bits, with the special ones.
fn everywhere(step: usize) -> impl Iterator<Item = f32> {
    let special = [0.0, -0.0, 1.0, -1.0, f32::MIN_POSITIVE, 1e-45, -1e-45, f32::MAX, f32::MIN, 0.5, -0.5];
    let beyond = [f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
    (0..=u32::MAX).step_by(step).map(f32::from_bits).chain(special).chain(beyond)
}

/// How far `got` is from `want`, in units of the last place of single precision at `want`.
fn ulps(got: f32, want: f64) -> f64 {
    let rounded = want as f32;
    if rounded.is_nan() || rounded.is_infinite() || rounded == 0.0 {
        let same = got.to_bits() == rounded.to_bits() || (got.is_nan() && rounded.is_nan());
        // A tie at the edge of the range may go either way.
        let edge = rounded.is_infinite() && got == f32::MAX.copysign(rounded)
            || rounded == 0.0 && got.abs() == 1e-45 && want != 0.0;
        return if same {
            0.0
        } else if edge {
            0.5
        } else {
            f64::INFINITY
        };
    }
    let spacing = f64::from(f32::from_bits(rounded.abs().to_bits() + 1)) - f64::from(rounded.abs());
    let spacing = if spacing.is_finite() { spacing } else { 2f64.powi(104) };
    (f64::from(got) - want).abs() / spacing
}

#[track_caller]
fn meets(f: impl Fn(f32) -> f32, reference: impl Fn(f64) -> f64, at: impl Iterator<Item = f32>) {
    for x in at {
        let (got, want) = (f(x), reference(f64::from(x)));
        assert!(ulps(got, want) <= 0.56, "at {x:e}: {got:e}, but {want:e}");
    }
}

#[test]
fn single_precision_is_rounded_almost_correctly_everywhere() {
    meets(sin, f64::sin, everywhere(20_011));
    meets(cos, f64::cos, everywhere(20_011));
    meets(tan, f64::tan, everywhere(20_011));
    meets(asin, f64::asin, everywhere(20_011));
    meets(acos, f64::acos, everywhere(20_011));
    meets(atan, f64::atan, everywhere(20_011));
    meets(exp, f64::exp, everywhere(20_011));
    meets(exp2, f64::exp2, everywhere(20_011));
    meets(ln, f64::ln, everywhere(20_011));
    meets(log2, f64::log2, everywhere(20_011));
    meets(log10, f64::log10, everywhere(20_011));
    meets(cbrt, f64::cbrt, everywhere(20_011));
    meets(sinh, f64::sinh, everywhere(20_011));
    meets(cosh, f64::cosh, everywhere(20_011));
    meets(tanh, f64::tanh, everywhere(20_011));
}

#[test]
fn single_precision_holds_where_renderers_live() {
    let near = |lo: f32, hi: f32| (0..=200_000).map(move |i| lo + (hi - lo) * (i as f32 / 200_000.0));
    meets(sin, f64::sin, near(-7.0, 7.0));
    meets(cos, f64::cos, near(-7.0, 7.0));
    meets(tan, f64::tan, near(-7.0, 7.0));
    meets(asin, f64::asin, near(-1.0, 1.0));
    meets(acos, f64::acos, near(-1.0, 1.0));
    meets(atan, f64::atan, near(-4.0, 4.0));
    meets(exp, f64::exp, near(-20.0, 20.0));
    meets(ln, f64::ln, near(0.5, 2.0));
    meets(log2, f64::log2, near(0.5, 2.0));
    meets(|x| sin_cos_eighth(x).0, f64::sin, near(-0.785, 0.785));
    meets(|x| sin_cos_eighth(x).1, f64::cos, near(-0.785, 0.785));
}

#[test]
fn functions_of_two_hold_on_all_pairs() {
    let few: Vec<f32> = everywhere(9_000_011).chain([2.0, -2.0, 3.0, 0.333, 0.999_999, 1.000_001]).collect();
    for &x in &few {
        for &y in &few {
            let (xd, yd) = (f64::from(x), f64::from(y));
            for (name, got, want) in [
                ("pow", pow(x, y), xd.powf(yd)),
                ("atan2", atan2(x, y), xd.atan2(yd)),
                ("hypot", hypot(x, y), xd.hypot(yd)),
            ] {
                assert!(ulps(got, want) <= 0.56, "{name}({x:e}, {y:e}): {got:e}, but {want:e}");
            }
        }
        for n in [-40, -3, -2, -1, 0, 1, 2, 3, 5, 8, 31, i32::MIN, i32::MAX] {
            let (got, want) = (powi(x, n), f64::from(x).powi(n));
            assert!(ulps(got, want) <= 0.56 || (n.abs() > 99 && got == want as f32), "{x:e}^{n}: {got:e}");
        }
    }
}

/// Relative difference, 0 where both are the same special value.
fn relative(got: f64, want: f64) -> f64 {
    if got.to_bits() == want.to_bits() || (got.is_nan() && want.is_nan()) {
        return 0.0;
    }
    (got - want).abs() / want.abs()
}

#[test]
fn double_precision_meets_the_platforms() {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        state >> 11
    };
    let special =
        [0.0, -0.0, 1.0, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MAX, 5e-324, 1e-310, 0.5];
    let mut numbers = special.to_vec();
    for _ in 0..40_000 {
        // Evenly in the logarithm over the whole range, and evenly in [-4, 4].
        let bits = (next() << 11) ^ next();
        numbers.push(f64::from_bits(bits));
        numbers.push(next() as f64 / 2f64.powi(50) - 4.0);
    }
    for (i, &x) in numbers.iter().enumerate() {
        let y = numbers[(i * 7919 + 13) % numbers.len()];
        for (name, got, want) in [
            ("sin", sin_cos_d(x).0, x.sin()),
            ("cos", sin_cos_d(x).1, x.cos()),
            ("acos", acos_d(x), x.acos()),
            ("exp", exp_d(x), x.exp()),
            ("ln", ln_d(x), x.ln()),
            ("atan2", atan2_d(x, y), x.atan2(y)),
            ("pow", pow_d(x, y), x.powf(y)),
            ("pow of e", pow_d(x.abs(), y % 100.0), x.abs().powf(y % 100.0)),
        ] {
            // Below the normal range only a few bits are left to be right.
            let fine =
                relative(got, want) < 1e-15 || (want.abs() < 1e-300 && (got - want).abs() <= 5e-324 * 2.0);
            assert!(fine, "{name} at {x:e}, {y:e}: {got:e}, but {want:e}");
        }
    }
}

#[test]
fn degrees_are_exact_at_the_quarters() {
    for turn in -8_i32..=8 {
        let at = |quarter: f64| sin_cos_degrees(f64::from(turn) * 360.0 + quarter);
        assert_eq!(at(0.0), (0.0, 1.0));
        assert_eq!(at(90.0), (1.0, 0.0));
        assert_eq!(at(180.0), (0.0, -1.0));
        assert_eq!(at(270.0), (-1.0, 0.0));
        assert!((at(30.0).0 - 0.5).abs() < 1e-15);
        assert!((at(45.0).0 - at(45.0).1).abs() < 1e-15);
    }
    assert_eq!(sin_cos_degrees(90.0 * 1e15), (0.0, 1.0));
    assert!(sin_cos_degrees(f64::INFINITY).0.is_nan());
    for i in 0..7200 {
        let degrees = 0.1 * f64::from(i);
        assert_eq!(sin_cos_two_turns(degrees), sin_cos_degrees(degrees), "{degrees}");
    }
}

#[test]
fn comparisons_say_what_happens_to_nan() {
    assert_eq!((min(f32::NAN, 1.0), max(f32::NAN, 1.0)), (1.0, 1.0));
    assert_eq!(clamp(f32::NAN, -1.0, 1.0), -1.0);
    assert_eq!((clamp(2.0, -1.0, 1.0), clamp(-2.0, -1.0, 1.0), clamp(0.5, -1.0, 1.0)), (1.0, -1.0, 0.5));
}
