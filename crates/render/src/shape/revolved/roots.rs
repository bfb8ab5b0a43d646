//! Roots of polynomials of low degree, all of them, in order.

/// Where a line meets something, in ascending order.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Roots {
    at: [f64; 8],
    count: usize,
}

impl Roots {
    /// Adds one, in its place; not if it is NaN, or if there are eight.
    pub fn add(&mut self, s: f64) {
        if s.is_nan() || self.count == self.at.len() {
            return;
        }
        let mut i = self.count;
        while i > 0 && self.at[i - 1] > s {
            self.at[i] = self.at[i - 1];
            i -= 1;
        }
        self.at[i] = s;
        self.count += 1;
    }

    pub fn iter(&self) -> impl Iterator<Item = f64> + use<> {
        let Self { at, count } = *self;
        at.into_iter().take(count)
    }
}

/// The roots of a s² + 2 b s + c; none where a line only touches. c / q keeps a small root exact where b would cancel.
pub(crate) fn quadratic(a: f64, b: f64, c: f64) -> impl Iterator<Item = f64> {
    let discriminant = b * b - a * c;
    let q = -(b + discriminant.sqrt().copysign(b));
    let is_met = discriminant > 0.0;
    [q / a, c / q].into_iter().filter(move |s| is_met && s.is_finite())
}

/// The roots of a polynomial between `low` and `high`, in ascending order, given its coefficients from the constant on, of which there
/// are five at most. Between the roots of its derivative it rises or falls, so that each such part has one root or none: all that
/// cross 0 are found, however close together.
pub(crate) fn between(coefficients: &[f64], low: f64, high: f64, out: &mut Roots) {
    let n = coefficients.len();
    if !(2..=5).contains(&n) || low >= high || (high - low).is_nan() {
        return;
    }
    let mut edges = Roots::default();
    edges.add(low);
    if n > 2 {
        let mut derivative = [0.0; 4];
        for (i, d) in derivative.iter_mut().enumerate().take(n - 1) {
            *d = coefficients[i + 1] * (i + 1) as f64;
        }
        between(&derivative[..n - 1], low, high, &mut edges);
    }
    edges.add(high);
    let value = |x: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c);
    let slope = |x: f64| (1..n).rev().fold(0.0, |sum, i| sum * x + coefficients[i] * i as f64);
    let mut before: Option<(f64, f64)> = None;
    for x in edges.iter() {
        let f = value(x);
        if let Some((start, at_start)) = before
            && (at_start < 0.0) != (f < 0.0)
        {
            out.add(crossing(value, slope, [start, x], at_start < 0.0));
        }
        before = Some((x, f));
    }
}

/// Where a function that rises, or falls, between two places crosses 0: Newton's step where it stays between them, else half.
fn crossing(
    f: impl Fn(f64) -> f64,
    slope: impl Fn(f64) -> f64,
    [mut low, mut high]: [f64; 2],
    rises: bool,
) -> f64 {
    let mut x = 0.5 * (low + high);
    // Halving alone ends after some sixty steps.
    for _ in 0..80 {
        let y = f(x);
        if (y < 0.0) == rises {
            low = x;
        } else {
            high = x;
        }
        let newton = x - y / slope(x);
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - x).abs() <= 1e-16 * x.abs() || next <= low && next >= high {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(coefficients: &[f64], low: f64, high: f64) -> Vec<f64> {
        let mut out = Roots::default();
        between(coefficients, low, high, &mut out);
        out.iter().collect()
    }

    #[test]
    fn all_roots_are_found_however_close() {
        // (x - 1)(x - 1.000001)(x + 2)(x - 3)
        let [a, b, c, d] = [1.0, 1.000_001, -2.0, 3.0];
        let by = |p: &[f64], r: f64| -> Vec<f64> {
            let mut q = vec![0.0; p.len() + 1];
            for (i, c) in p.iter().enumerate() {
                q[i + 1] += c;
                q[i] -= c * r;
            }
            q
        };
        let p = [b, c, d].iter().fold(vec![-a, 1.0], |p, r| by(&p, *r));
        let roots = found(&p, -10.0, 10.0);
        assert_eq!(roots.len(), 4, "{roots:?}");
        for (got, want) in roots.iter().zip([c, a, b, d]) {
            assert!((got - want).abs() < 1e-8, "{got} {want}");
        }
        assert_eq!(found(&p, 0.0, 2.0).len(), 2);
        assert!(found(&[1.0, 0.0, 1.0], -5.0, 5.0).is_empty());
        assert!(found(&[f64::NAN; 5], -5.0, 5.0).len() <= 5);
    }

    #[test]
    fn quadratics_keep_their_small_root() {
        let mut roots: Vec<_> = quadratic(1.0, -0.5e8, 1.0).collect();
        roots.sort_by(f64::total_cmp);
        assert!((roots[0] / 1e-8 - 1.0).abs() < 1e-12, "{roots:?}");
        // A line: one root.
        assert_eq!(quadratic(0.0, 1.0, -4.0).collect::<Vec<_>>(), [2.0]);
        assert_eq!(quadratic(1.0, 0.0, 1.0).count(), 0);
    }
}
