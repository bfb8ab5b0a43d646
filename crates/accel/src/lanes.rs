//! Numbers side by side: what is written once for any number of lanes.
//!
//! A kind of vector comes in single and in double precision, with as many lanes in each, and its operations are those of one
//! number in every lane, exact by IEEE: a computation gives the same bits however many lanes it is done in. Plain numbers are
//! vectors of one lane. The wider ones, in `kernel/wide/`, exist only where the processor has them.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};
use straal_math::ops;

/// Numbers of each row that are kept together: a row is as long as the widest vector, and shorter ones go through it in steps.
pub(crate) const ROW: usize = 8;

/// A row of single precision.
pub(crate) type Singles = [f32; ROW];

/// A row of double precision.
pub(crate) type Doubles = [f64; ROW];

/// Yes or no in each lane.
pub(crate) trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> {
    /// Lane i in bit i.
    fn bits(self) -> u32;
}

/// Single precision in each lane.
pub(crate) trait Single: Copy + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    type Mask: Mask;

    /// The lesser of two numbers, neither of which is NaN. Of two zeros, either.
    fn least(self, o: Self) -> Self;

    /// The greater of two numbers, likewise.
    fn most(self, o: Self) -> Self;

    fn at_most(self, o: Self) -> Self::Mask;

    /// Without the sign.
    fn size(self) -> Self;

    /// With another's sign.
    fn with_sign(self, o: Self) -> Self;

    /// This where the mask is set, and the other elsewhere.
    fn or(self, mask: Self::Mask, o: Self) -> Self;
}

/// Double precision in each lane.
pub(crate) trait Double:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    type Mask: Mask;

    /// A number in all lanes; that there is a vector is the proof that there may be another.
    fn splat(self, x: f64) -> Self;

    fn root(self) -> Self;

    fn with_sign(self, o: Self) -> Self;

    fn below(self, o: Self) -> Self::Mask;

    fn at_most(self, o: Self) -> Self::Mask;

    fn equals(self, o: Self) -> Self::Mask;

    /// This where the mask is set, and the other elsewhere.
    fn or(self, mask: Self::Mask, o: Self) -> Self;

    /// Rounded to single precision, and exactly that in double.
    fn rounded(self) -> Self;
}

/// A kind of vector. A value is the proof that the processor has it.
pub(crate) trait Wide: Copy {
    /// How many lanes: a divisor of [`ROW`].
    const LANES: usize;

    type Single: Single;
    type Double: Double;

    /// The same number in all lanes.
    fn single(self, x: f32) -> Self::Single;

    /// The same number in all lanes.
    fn double(self, x: f64) -> Self::Double;

    /// The lanes of a row from `at` on, which is less than [`ROW`] and a multiple of the number of lanes.
    fn singles(self, from: &Singles, at: usize) -> Self::Single;

    /// The same.
    fn doubles(self, from: &Doubles, at: usize) -> Self::Double;

    /// Writes the same lanes of a row.
    fn put_singles(self, x: Self::Single, to: &mut Singles, at: usize);

    /// The same.
    fn put_doubles(self, x: Self::Double, to: &mut Doubles, at: usize);

    fn widened(self, x: Self::Single) -> Self::Double;

    fn wide_mask(self, mask: <Self::Single as Single>::Mask) -> <Self::Double as Double>::Mask;
}

impl Mask for bool {
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
}

impl Single for f32 {
    type Mask = bool;

    #[inline(always)]
    fn least(self, o: Self) -> Self {
        ops::min(self, o)
    }

    #[inline(always)]
    fn most(self, o: Self) -> Self {
        ops::max(self, o)
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> bool {
        self <= o
    }

    #[inline(always)]
    fn size(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn with_sign(self, o: Self) -> Self {
        self.copysign(o)
    }

    #[inline(always)]
    fn or(self, mask: bool, o: Self) -> Self {
        if mask { self } else { o }
    }
}

impl Double for f64 {
    type Mask = bool;

    #[inline(always)]
    fn splat(self, x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn with_sign(self, o: Self) -> Self {
        self.copysign(o)
    }

    #[inline(always)]
    fn below(self, o: Self) -> bool {
        self < o
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> bool {
        self <= o
    }

    #[inline(always)]
    fn equals(self, o: Self) -> bool {
        self == o
    }

    #[inline(always)]
    fn or(self, mask: bool, o: Self) -> Self {
        if mask { self } else { o }
    }

    #[inline(always)]
    fn rounded(self) -> Self {
        f64::from(self as f32)
    }
}
