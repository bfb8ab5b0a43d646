//! What lies between the wavelengths of a table.
//!
//! Tables in equal steps are joined as colorimetry does it: by a curve of third order through the four nearest points, or of
//! second order through three in the first and the last gap (Lagrange; ASTM E2022-16, one of the methods of CIE 15:2018, 7.2.1). The colours of
//! surfaces measured every 10 nm come out by it as ASTM E308 has them; straight lines miss them by 0.001.
//!
//! Such a curve rings beside a line or an edge. Where it would go below 0, or above 1 as a reflectance, it knows too little
//! to be trusted: that gap and its neighbours are crossed by straight lines, which add no light to a narrow line.

use super::Quantity;

/// How a spectrum goes from one of its wavelengths to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// By straight lines.
    Linear,
    /// By curves through the four nearest points.
    Smooth,
}

/// The widest steps, in nm, that tables in the sense of ASTM E308 have; wider ones are sketches whose lines are meant straight.
const WIDEST: f64 = 20.0;

/// Fewer points are no table of steps.
pub(super) const FEWEST: usize = 4;

/// How a table is joined of which no more is known: smoothly where its steps are equal and as fine as those of measurements.
pub(super) fn fitting(wavelengths: &[f64]) -> Interpolation {
    let is_fine = wavelengths.len() >= FEWEST && wavelengths[1] - wavelengths[0] <= WIDEST * (1.0 + 1e-6);
    if is_fine && uneven(wavelengths).is_none() { Interpolation::Smooth } else { Interpolation::Linear }
}

/// The first wavelength, by its index, that is not one step after the one before, as the first two tell the step. Files
/// round their wavelengths: a hundredth of a step is allowed.
pub(super) fn uneven(wavelengths: &[f64]) -> Option<usize> {
    let step = wavelengths.get(1)? - wavelengths.first()?;
    let is_off = |p: &[f64]| (p[1] - p[0] - step).abs() > 0.01 * step;
    wavelengths.windows(2).position(is_off).map(|gap| gap + 1)
}

/// The value in a gap between two points of an evenly spaced table, `t` of the way from 0 to 1.
pub(super) fn smooth(values: &[f64], gap: usize, t: f64, quantity: Quantity) -> f64 {
    let trusted = |gap: usize| Cubic::over(values, gap).is_some_and(|c| c.stays_in(quantity));
    let last = values.len() - 2;
    let near = gap.saturating_sub(1)..=if gap < last { gap + 1 } else { last };
    match Cubic::over(values, gap) {
        Some(cubic) if near.into_iter().all(trusted) => quantity.held(cubic.at(t)),
        _ => values[gap] + (values[gap + 1] - values[gap]) * t,
    }
}

/// By how much each of the points about a wavelength counts in the value there, and which they are. The sum is the value without
/// regard to what can be, which is linear in the points.
pub(super) fn weights(wavelengths: &[f64], nm: f64) -> [(usize, f64); 4] {
    let w = wavelengths;
    let next = w.partition_point(|&x| x <= nm);
    let mut out = [(0, 0.0); 4];
    let near = if next == 0 {
        0..1
    } else if next == w.len() {
        next - 1..next
    } else if fitting(w) == Interpolation::Linear {
        next - 1..next + 1
    } else {
        next.saturating_sub(2)..if next + 2 < w.len() { next + 2 } else { w.len() }
    };
    for (slot, a) in out.iter_mut().zip(near.clone()) {
        let others = near.clone().filter(|&b| b != a);
        *slot = (a, others.map(|b| (nm - w[b]) / (w[a] - w[b])).product());
    }
    out
}

/// A polynomial over a gap, from 0 to 1.
struct Cubic {
    /// The points between which the gap is.
    ends: [f64; 2],
    /// From the constant one up.
    coefficients: [f64; 4],
}

impl Cubic {
    /// Through the points about a gap. Beyond the first and last point stands what makes the curve there one of second order.
    /// `None` where numbers are too great for it.
    fn over(values: &[f64], gap: usize) -> Option<Self> {
        let (b, c) = (values[gap], values[gap + 1]);
        let before = gap.checked_sub(1).map(|i| values[i]);
        let after = values.get(gap + 2).copied();
        let (a, d) = match (before, after) {
            (Some(a), Some(d)) => (a, d),
            (Some(a), None) => (a, a - 3.0 * b + 3.0 * c),
            (None, Some(d)) => (3.0 * b - 3.0 * c + d, d),
            (None, None) => return None,
        };
        let of = [b, c - a / 3.0 - 0.5 * b - d / 6.0, 0.5 * (a + c) - b, (d - a) / 6.0 + 0.5 * (b - c)];
        // So that their products are numbers as well.
        of.iter().all(|v| v.abs() < 1e150).then_some(Self { ends: [b, c], coefficients: of })
    }

    fn at(&self, t: f64) -> f64 {
        let [k0, k1, k2, k3] = self.coefficients;
        k0 + t * (k1 + t * (k2 + t * k3))
    }

    /// Whether it is a possible value all over the gap.
    fn stays_in(&self, quantity: Quantity) -> bool {
        let [_, k1, k2, k3] = self.coefficients;
        // Where 3 k3 t^2 + 2 k2 t + k1 = 0, without loss of digits where k3 is small.
        let root = (k2 * k2 - 3.0 * k1 * k3).sqrt();
        let q = -(k2 + if k2 < 0.0 { -root } else { root });
        let turns = [q / (3.0 * k3), k1 / q].into_iter().filter(|t| *t > 0.0 && *t < 1.0);
        self.ends.into_iter().chain(turns.map(|t| self.at(t))).all(|v| v == quantity.held(v))
    }
}
