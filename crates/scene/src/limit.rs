//! What range a number of the scene language must be in.

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

impl std::fmt::Display for Limit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.min.is_finite(), self.max.is_finite(), self.open) {
            (true, true, false) => write!(f, "from {} to {}", self.min, self.max),
            (true, true, true) => write!(f, "between {} and {}, neither included", self.min, self.max),
            (true, false, true) => write!(f, "greater than {}", self.min),
            (true, false, false) => write!(f, "{} or greater", self.min),
            (false, true, true) => write!(f, "less than {}", self.max),
            (false, true, false) => write!(f, "{} or less", self.max),
            (false, false, _) => write!(f, "within the range of single precision"),
        }
    }
}
