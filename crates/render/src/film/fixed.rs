//! Fixed-point sums: a float is rounded once, then integers are added, which is associative.

use std::ops::AddAssign;

/// A sample of this size or more is dropped and counted, like NaN.
pub const MAX_VALUE: f32 = 4_294_967_296.0; // 2^32

/// The largest number of samples a pixel may take: up to it no sum below can overflow, whatever the samples.
pub const MAX_SAMPLES: u32 = 1 << 18;

/// 2^62, a value's scale: single floats of 2^-39 and more are held exactly, and the sum of 2^18 values below
/// 2^32 stays below 2^112.
const VALUE_SCALE: f64 = (1_u64 << 62) as f64;
/// 2^44: squares below 2^64, sums below 2^126.
const SQUARE_SCALE: f64 = (1_u64 << 44) as f64;
/// 2^40 for numbers of [-4, 4]: sums below 2^60.
const GUIDE_SCALE: f64 = (1_u64 << 40) as f64;
const GUIDE_RANGE: f32 = 4.0;

/// Sum of values below 2^32, in units of 2^-62.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Value(pub(super) i128);

impl Value {
    pub fn add(&mut self, v: f32) {
        self.0 += round(f64::from(v) * VALUE_SCALE);
    }

    /// Adds a product of single-precision numbers: beyond double precision's digits it is rounded twice, always alike.
    pub fn add_exact(&mut self, v: f64) {
        self.0 += round(v * VALUE_SCALE);
    }

    pub fn to_f64(self) -> f64 {
        self.0 as f64 / VALUE_SCALE
    }
}

impl From<Value> for f64 {
    fn from(v: Value) -> Self {
        v.to_f64()
    }
}

impl AddAssign for Value {
    fn add_assign(&mut self, o: Self) {
        self.0 += o.0;
    }
}

/// Sum of squares of values below 2^32, in units of 2^-44.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Square(pub(super) i128);

impl Square {
    /// Adds v².
    pub fn add(&mut self, v: f32) {
        let v = f64::from(v); // its square is exact in double precision
        self.0 += round(v * v * SQUARE_SCALE);
    }

    pub fn to_f64(self) -> f64 {
        self.0 as f64 / SQUARE_SCALE
    }
}

/// 2^34, for splats: up to 2^18 samples of each of 33 x 33 pixels, of squares below 2^64, stay below 2^127.
const WIDE_SCALE: f64 = (1_u64 << 34) as f64;

/// Sum of squares of values below 2^32 over the samples of all pixels that a filter reaches, in units of 2^-34.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WideSquare(pub(super) i128);

impl WideSquare {
    /// Adds v².
    pub fn add(&mut self, v: f64) {
        self.0 += round(v * v * WIDE_SCALE);
    }

    pub fn to_f64(self) -> f64 {
        self.0 as f64 / WIDE_SCALE
    }
}

impl AddAssign for WideSquare {
    fn add_assign(&mut self, o: Self) {
        self.0 += o.0;
    }
}

/// Sum of an albedo or normal, in units of 2^-40; what lies beyond ±4 is taken as that, NaN as 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Guide(pub(super) i64);

impl Guide {
    pub fn add(&mut self, v: f32) {
        let v = match v {
            _ if v.abs() <= GUIDE_RANGE => v,
            _ if v.is_nan() => 0.0,
            _ => GUIDE_RANGE.copysign(v),
        };
        self.0 += nearest(f64::from(v) * GUIDE_SCALE);
    }

    pub fn to_f64(self) -> f64 {
        self.0 as f64 / GUIDE_SCALE
    }
}

/// To the nearest integer. Most numbers fit 64 bits, whose conversion is one instruction; beyond 2^62 a double has
/// no fraction left to round.
#[inline(always)]
fn round(v: f64) -> i128 {
    if v.abs() < (1_u64 << 62) as f64 { i128::from(nearest(v)) } else { v as i128 }
}

/// To the nearest integer, halves away from 0, for numbers below 2^63 of at most 48 significant bits (those of a
/// single-precision number's square): adding a half changes none that is whole already.
#[inline(always)]
fn nearest(v: f64) -> i64 {
    (v + 0.5_f64.copysign(v)) as i64
}
