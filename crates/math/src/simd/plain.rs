//! One lane: plain numbers.

use super::{Arithmetic, Bits, Double, Float, Mask, Uint, Ulong, sealed::Sealed};

impl Arithmetic<f32> for f32 {}
impl Arithmetic<f64> for f64 {}
impl Bits<u32> for u32 {}
impl Bits<u64> for u64 {}
impl Sealed for f32 {}
impl Sealed for f64 {}
impl Sealed for u32 {}
impl Sealed for u64 {}
impl Sealed for bool {}

/// What every kind of plain number has alike.
macro_rules! one_lane {
    ($t:ty) => {
        const WIDTH: usize = 1;
        type Mask = bool;
        type Array = [$t; 1];

        #[inline(always)]
        fn splat(x: $t) -> $t {
            x
        }
        #[inline(always)]
        fn from_array([x]: [$t; 1]) -> $t {
            x
        }
        #[inline(always)]
        fn to_array(self) -> [$t; 1] {
            [self]
        }
        #[inline(always)]
        fn lane(self, _: usize) -> $t {
            self
        }
        #[inline(always)]
        fn select(mask: bool, yes: $t, no: $t) -> $t {
            if mask { yes } else { no }
        }
        #[inline(always)]
        fn eq(self, o: $t) -> bool {
            self == o
        }
    };
}

/// What `f32` and `f64` have alike.
macro_rules! one_float {
    ($t:ty) => {
        const ZERO: $t = 0.0;
        const ONE: $t = 1.0;

        #[inline(always)]
        fn sqrt(self) -> $t {
            <$t>::sqrt(self)
        }
        #[inline(always)]
        fn abs(self) -> $t {
            <$t>::abs(self)
        }
        #[inline(always)]
        fn copysign(self, sign: $t) -> $t {
            <$t>::copysign(self, sign)
        }
        #[inline(always)]
        fn min(self, o: $t) -> $t {
            if self < o { self } else { o }
        }
        #[inline(always)]
        fn max(self, o: $t) -> $t {
            if self > o { self } else { o }
        }
        #[inline(always)]
        fn lt(self, o: $t) -> bool {
            self < o
        }
        #[inline(always)]
        fn le(self, o: $t) -> bool {
            self <= o
        }
        #[inline(always)]
        fn is_sign_negative(self) -> bool {
            <$t>::is_sign_negative(self)
        }
    };
}

impl Float for f32 {
    type Uint = u32;
    type Ulong = u64;
    type Double = f64;
    one_lane!(f32);
    one_float!(f32);

    #[inline(always)]
    fn gather(table: &[f32], index: u32) -> f32 {
        at(table, index)
    }
    #[inline(always)]
    fn from_rows(mut row: impl FnMut(usize) -> [f32; 4]) -> [f32; 4] {
        row(0)
    }
    #[inline(always)]
    fn to_rows(columns: [f32; 4], mut row: impl FnMut(usize, [f32; 4])) {
        row(0, columns);
    }
    #[inline(always)]
    fn mul_add(self, a: f32, b: f32) -> f32 {
        fused(self, a, b)
    }
    #[inline(always)]
    fn floor(self) -> f32 {
        f32::floor(self)
    }
    #[inline(always)]
    fn trunc(self) -> f32 {
        f32::trunc(self)
    }
    #[inline(always)]
    fn to_bits(self) -> u32 {
        f32::to_bits(self)
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> f32 {
        f32::from_bits(bits)
    }
    #[inline(always)]
    fn to_uint(self) -> u32 {
        self as u32
    }
    #[inline(always)]
    fn to_int(self) -> u32 {
        self as i32 as u32
    }
    #[inline(always)]
    fn from_uint(x: u32) -> f32 {
        x as f32
    }
    #[inline(always)]
    fn from_int(x: u32) -> f32 {
        x as i32 as f32
    }
    #[inline(always)]
    fn to_double(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn from_double(x: f64) -> f32 {
        x as f32
    }
    #[inline(always)]
    fn vectorize<R>(f: impl FnOnce() -> R) -> R {
        f()
    }
}

impl Double for f64 {
    type Ulong = u64;
    one_lane!(f64);
    one_float!(f64);

    #[inline(always)]
    fn to_bits(self) -> u64 {
        f64::to_bits(self)
    }
    #[inline(always)]
    fn from_bits(bits: u64) -> f64 {
        f64::from_bits(bits)
    }
}

/// What `u32` and `u64` have alike.
macro_rules! one_whole {
    ($t:ty) => {
        #[inline(always)]
        fn wrapping_add(self, o: $t) -> $t {
            <$t>::wrapping_add(self, o)
        }
        #[inline(always)]
        fn wrapping_sub(self, o: $t) -> $t {
            <$t>::wrapping_sub(self, o)
        }
        #[inline(always)]
        fn wrapping_mul(self, o: $t) -> $t {
            <$t>::wrapping_mul(self, o)
        }
    };
}

impl Uint for u32 {
    type Ulong = u64;
    one_lane!(u32);
    one_whole!(u32);

    #[inline(always)]
    fn gather(table: &[u32], index: u32) -> u32 {
        at(table, index)
    }
    #[inline(always)]
    fn look_up(self, table: &[u32; 8]) -> u32 {
        table[(self & 7) as usize]
    }
    #[inline(always)]
    fn min(self, o: u32) -> u32 {
        if self < o { self } else { o }
    }
    #[inline(always)]
    fn max(self, o: u32) -> u32 {
        if self > o { self } else { o }
    }
    #[inline(always)]
    fn shr_signed(self, by: u32) -> u32 {
        (self as i32 >> by) as u32
    }
    #[inline(always)]
    fn shl_each(self, by: u32) -> u32 {
        self << by
    }
    #[inline(always)]
    fn shr_each(self, by: u32) -> u32 {
        self >> by
    }
    #[inline(always)]
    fn reverse_bits(self) -> u32 {
        u32::reverse_bits(self)
    }
    #[inline(always)]
    fn reverse_both(a: u32, b: u32) -> [u32; 2] {
        let both = (u64::from(a) << 32 | u64::from(b)).reverse_bits();
        [both as u32, (both >> 32) as u32]
    }
    #[inline(always)]
    fn lt(self, o: u32) -> bool {
        self < o
    }
    #[inline(always)]
    fn lt_signed(self, o: u32) -> bool {
        (self as i32) < o as i32
    }
    #[inline(always)]
    fn to_ulong(self) -> u64 {
        self.into()
    }
}

impl Ulong for u64 {
    type Uint = u32;
    one_lane!(u64);
    one_whole!(u64);

    #[inline(always)]
    fn low(self) -> u32 {
        self as u32
    }
}

impl Mask for bool {
    #[inline(always)]
    fn splat(yes: bool) -> bool {
        yes
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> bool {
        bits & 1 == 1
    }
    #[inline(always)]
    fn to_bits(self) -> u32 {
        self.into()
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
    #[inline(always)]
    fn lane(self, _: usize) -> bool {
        self
    }
}

/// The entry of a table, the last for indices beyond, 0 if there is none.
#[inline(always)]
pub(super) fn at<T: Copy + Default>(table: &[T], index: u32) -> T {
    let last = table.len().wrapping_sub(1);
    let index = index as usize;
    table.get(if index < last { index } else { last }).copied().unwrap_or_default()
}

/// x a + b rounded once, on every processor: the product is exact in double precision, and the sum is rounded to odd there, after
/// which rounding to single precision can't go wrong (Boldo and Melquiond 2008, "Emulation of FMA and Correctly Rounded Sums").
/// A library's `fmaf` is wrong here and there for results below the normal range.
#[inline(always)]
pub(crate) fn fused(x: f32, a: f32, b: f32) -> f32 {
    if cfg!(any(target_feature = "fma", target_arch = "aarch64")) {
        return x.mul_add(a, b);
    }
    let (p, b) = (f64::from(x) * f64::from(a), f64::from(b));
    let s = p + b;
    // What the sum lost, exactly (Knuth).
    let bb = s - p;
    let lost = (p - (s - bb)) + (b - bb);
    let bits = s.to_bits();
    // An even result that isn't exact gives way to its odd neighbour on the side of what was lost.
    let is_inexact = (lost != 0.0) & s.is_finite() & (bits & 1 == 0);
    let step = if (lost > 0.0) == (s > 0.0) { 1 } else { u64::MAX };
    f64::from_bits(if is_inexact { bits.wrapping_add(step) } else { bits }) as f32
}
