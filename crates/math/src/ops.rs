//! The only door to functions beyond + - * / and the square root.

/// The lesser of two; `b` when they can't be compared.
#[inline(always)]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two; `b` when they can't be compared.
#[inline(always)]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `x` brought into [lo, hi]; NaN gives `lo`.
#[inline(always)]
pub fn clamp(x: f32, lo: f32, hi: f32) -> f32 {
    if x > lo { if x < hi { x } else { hi } } else { lo }
}

/// Sine and cosine of an angle in degrees.
pub fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    degrees.to_radians().sin_cos()
}
