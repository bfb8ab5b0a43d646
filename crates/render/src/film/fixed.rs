//! Fixed-point sums: a float is rounded once, then integers are added, which is associative.

use std::ops::{AddAssign, Sub};

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
pub struct Fixed(pub(super) i128);

impl Fixed {
    /// Adds a value below 2^32.
    #[inline(always)]
    pub fn add(&mut self, v: f32) {
        self.0 += match usual(v) {
            Some(units) => i128::from(units),
            None => Self::unusual(v),
        };
    }

    #[cold]
    #[inline(never)]
    fn unusual(v: f32) -> i128 {
        round(f64::from(v) * VALUE_SCALE)
    }

    #[inline(always)]
    pub fn to_f64(self) -> f64 {
        // Most sums fit 64 bits, whose conversion is one instruction, and rounds alike.
        let sum = match i64::try_from(self.0) {
            Ok(sum) => sum as f64,
            Err(_) => wide(self.0),
        };
        sum * (1.0 / VALUE_SCALE)
    }
}

/// A number of less than 2 in units of 2^-62, rounded to the nearest, halves away from 0: its 24 digits, shifted. Black and faint numbers
/// come as often as bright ones and in no order, so that there is nothing here that a processor could guess wrong.
#[inline(always)]
fn usual(v: f32) -> Option<i64> {
    const DIGITS: u32 = f32::MANTISSA_DIGITS - 1;
    /// The exponent, as it is stored, of a number whose last digit has the weight of a unit.
    const LEAST: i32 = 127 + DIGITS as i32 - 62;
    let bits = v.to_bits();
    let exponent = bits >> DIGITS & 0xff;
    let shift = exponent as i32 - LEAST;
    let (up, down) = (if shift > 0 { shift } else { 0 }, if shift < 0 { -shift } else { 0 });
    // Numbers without a leading digit are so faint that nothing is left of them. One digit more than units have tells where to round.
    let digits = u64::from(bits & ((1 << DIGITS) - 1) | 1 << DIGITS) << 1;
    let twice = digits << (up & 63) >> (if down < 63 { down } else { 63 });
    let units = ((twice + 1) >> 1) as i64;
    let sign = i64::from(bits as i32 >> 31);
    (exponent < 128).then_some((units ^ sign).wrapping_sub(sign))
}

/// Any sum; out of line, where the compiler makes nothing else of it.
#[cold]
#[inline(never)]
fn wide(sum: i128) -> f64 {
    sum as f64
}

impl From<Fixed> for f64 {
    fn from(v: Fixed) -> Self {
        v.to_f64()
    }
}

impl Sub for Fixed {
    type Output = Self;

    fn sub(self, o: Self) -> Self {
        Self(self.0.wrapping_sub(o.0))
    }
}

impl Sub for Square {
    type Output = Self;

    fn sub(self, o: Self) -> Self {
        Self(self.0.wrapping_sub(o.0))
    }
}

impl AddAssign for Fixed {
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

/// 2^30, of a filter's heights, which lie in [-1, 1].
pub const HEIGHT_SCALE: f64 = (1_u64 << 30) as f64;

/// A filter's height as an integer, in units of 2^-30.
#[inline]
pub fn height(h: f32) -> i64 {
    nearest(f64::from(h) * HEIGHT_SCALE)
}

/// Light of a sample times the height of a row, on its way to the pixels of that row.
///
/// A height has 31 bits and the product must fit 64 with room for the next, so that light above 1 in any channel is held in
/// other units than darker light. Which it is depends on the sample alone.
pub enum Down<const N: usize> {
    /// All channels are below 1, in units of 2^-62.
    Usual(Rowed<Usual, N>),
    /// Up to 2^32, in units of 2^-30.
    Bright(Rowed<Bright, N>),
}

/// The numbers of light times a row's height.
pub struct Rowed<A, const N: usize>([i64; N], std::marker::PhantomData<A>);

/// One of them.
#[derive(Clone, Copy)]
pub struct Row<A> {
    /// In the units of its kind.
    pub light: i64,
    kind: std::marker::PhantomData<A>,
}

/// How light times a row's height becomes a [`Fixed`] with the height of a column.
pub trait Across {
    /// In units of 2^-62 from the product.
    fn value(product: i128) -> i128;
}

/// Light below 1.
#[derive(Clone, Copy)]
pub struct Usual;

/// Light of any brightness.
#[derive(Clone, Copy)]
pub struct Bright;

impl Across for Usual {
    #[inline(always)]
    fn value(product: i128) -> i128 {
        product >> 30
    }
}

impl Across for Bright {
    #[inline(always)]
    fn value(product: i128) -> i128 {
        product << 2
    }
}

impl<const N: usize> Down<N> {
    /// Light below 2^32 times a height.
    #[inline]
    pub fn new(light: &[f32; N], height: i64) -> Self {
        let height = height as f64 / HEIGHT_SCALE;
        let rowed = |scale: f64| light.map(|v| nearest(f64::from(v) * height * scale));
        if light.iter().all(|v| v.abs() < 1.0) {
            Self::Usual(Rowed(rowed(VALUE_SCALE), std::marker::PhantomData))
        } else {
            Self::Bright(Rowed(rowed(HEIGHT_SCALE), std::marker::PhantomData))
        }
    }
}

impl<A, const N: usize> Rowed<A, N> {
    /// That of channel `c`.
    #[inline(always)]
    pub const fn row(&self, c: usize) -> Row<A> {
        Row { light: self.0[c], kind: std::marker::PhantomData }
    }
}

impl<A: Across> Row<A> {
    /// What it brings to the pixel of a column of some height.
    #[inline(always)]
    pub fn at(&self, height: i64) -> Fixed {
        Fixed(A::value(i128::from(height) * i128::from(self.light)))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The short way gives what the long one does, at its ends and beyond, whatever the sign.
    #[test]
    fn numbers_are_rounded_once() {
        let ends = [
            2.0_f32,
            1.0,
            0.5,
            1.0 / (1_u64 << 39) as f32,
            MAX_VALUE * 0.5,
            0.0,
            1e-30,
            0.3,
            1234.567,
            1e-40,
        ];
        // And halves of the units, and what is beside them.
        let units = (58..64).flat_map(|k| [1.0, 3.0, 5.0].map(|n| n / (1_u64 << k) as f32));
        for v in
            ends.into_iter().chain(units).flat_map(|v| [v.next_down(), v, v.next_up()]).flat_map(|v| [v, -v])
        {
            let mut sum = Fixed::default();
            sum.add(v);
            assert_eq!(usual(v).is_some(), v.abs() < 2.0, "{v:e}");
            assert_eq!(sum.0, round(f64::from(v) * VALUE_SCALE), "{v:e}");
            let sums = [sum.0, i128::from(i64::MAX), i128::from(i64::MAX) + 1, i128::from(i64::MIN) - 1];
            for sum in sums {
                assert_eq!(Fixed(sum).to_f64(), sum as f64 / VALUE_SCALE, "{sum}");
            }
        }
    }
}
