//! What range a number of the scene language must be in.

use crate::tree::shown;

/// A range of numbers, and how a message names it. Infinite numbers, NaN and what single precision can't hold are
/// outside every range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Least number.
    pub min: f64,
    /// Greatest number.
    pub max: f64,
    /// Whether `min` and `max` themselves are outside.
    pub open: bool,
}

impl Limit {
    /// Any finite number.
    pub const FINITE: Self = Self { min: f64::NEG_INFINITY, max: f64::INFINITY, open: false };
    /// Above 0.
    pub const POSITIVE: Self = Self { min: 0.0, max: f64::INFINITY, open: true };
    /// 0 or above.
    pub const NON_NEGATIVE: Self = Self { min: 0.0, max: f64::INFINITY, open: false };
    /// From 0 to 1.
    pub const UNIT: Self = Self::within(0.0, 1.0);

    /// From `min` to `max`, both allowed.
    pub const fn within(min: f64, max: f64) -> Self {
        Self { min, max, open: false }
    }

    /// Between `min` and `max`, neither allowed.
    pub const fn between(min: f64, max: f64) -> Self {
        Self { min, max, open: true }
    }

    /// Whether `v` is in range.
    pub fn allows(&self, v: f64) -> bool {
        // Rendering rounds to single precision, where a tiny radius must not become 0.
        let r = f64::from(v as f32);
        let inside = if self.open { r > self.min && r < self.max } else { v >= self.min && v <= self.max };
        r.is_finite() && inside
    }
}

impl Limit {
    /// What is said of a number that is not allowed: of a range that ends where the machine's numbers do, the nearer end.
    pub fn complaint(&self, key: &str, v: f64) -> String {
        let found = shown(v);
        if !v.is_finite() {
            return format!("`{key}` must be a finite number, found {found}");
        }
        if !(v as f32).is_finite() {
            return format!("`{key}` is too large to be computed with: {found}");
        }
        let whole = self.max >= f64::from(u32::MAX) && self.max.is_finite();
        let range = match whole {
            true if v > self.max => format!("at most {}", told(self.max)),
            true => Self { max: f64::INFINITY, ..*self }.to_string(),
            false => self.to_string(),
        };
        format!("`{key}` must be {range}, found {found}")
    }
}

/// A limit as people write it: 16,384.
fn told(v: f64) -> String {
    if v.abs() < 1000.0 || v.floor() != v || v.abs() > 1e15 && v.abs() != 9_007_199_254_740_991.0 {
        return v.to_string();
    }
    let digits = v.abs().to_string();
    let mut out = String::from(if v < 0.0 { "-" } else { "" });
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

impl std::fmt::Display for Limit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.min.is_finite(), self.max.is_finite(), self.open) {
            (true, true, false) => write!(f, "from {} to {}", told(self.min), told(self.max)),
            (true, true, true) => {
                write!(f, "between {} and {}, neither included", told(self.min), told(self.max))
            }
            (true, false, true) => write!(f, "greater than {}", told(self.min)),
            (true, false, false) => write!(f, "{} or greater", told(self.min)),
            (false, true, true) => write!(f, "less than {}", told(self.max)),
            (false, true, false) => write!(f, "{} or less", told(self.max)),
            (false, false, _) => write!(f, "a finite number"),
        }
    }
}
