//! Numbers side by side: code that is written once and runs one, eight or sixteen lanes at a time.
//!
//! A processor can add eight or sixteen pairs of numbers by one instruction, if they stand side by side in a wide register. To have
//! that without writing everything again for each processor, a function is generic over a [`Float`]: a handful of `f32`s, whose
//! number is the processor's to say. Plain `f32` is a [`Float`] of one lane, so that the same function serves a single number as well:
//!
//! ```
//! use straal_math::{Vec3, simd::Float};
//!
//! /// Light that a Lambertian surface sends on, in proportion to the cosine; none from behind.
//! fn lambert<F: Float>(n: Vec3<F>, wi: Vec3<F>) -> F {
//!     let cosine = n.dot(wi);
//!     F::select(cosine.gt(F::ZERO), cosine * std::f32::consts::FRAC_1_PI, F::ZERO)
//! }
//!
//! assert_eq!(lambert(Vec3::Z, -Vec3::Z), 0.0); // one lane: plain numbers
//! ```
//!
//! What runs on many lanes differs in three ways from plain code:
//! - **A comparison gives a [`Mask`]**, one bit for each lane, and a branch becomes a choice: both sides are computed, and
//!   [`Float::select`] takes one of them in each lane. Where one side is rare and costly, ask [`Mask::any`] first.
//! - **A constant is the same in all lanes**: [`Float::splat`], [`Float::ONE`], or any plain number on the right of an operator
//!   (`x * 0.5`).
//! - **Lanes never meet.** There is no sum over lanes, and nothing depends on how many there are. So a lane gives the same bits
//!   whatever stands beside it, and a program the same picture at every width: additions, multiplications, divisions, square
//!   roots and the fused [`Float::mul_add`] are exact by IEEE 754 on every processor; there are no approximate reciprocals here. (Only the
//!   sign and the payload of a NaN differ by processor.)
//!
//! Beside `Float` there are [`Uint`] (`u32`, also taken as `i32` where a method says so), and for the inside of functions that
//! compute in double precision [`Double`] and [`Ulong`]; all of one family have the same number of lanes and the same mask.
//!
//! Which family runs is chosen once, by a [`Kernel`]: a struct that holds what the code reads and writes, and a function generic
//! over the family. [`Simd::run`] enters it compiled for the instruction set, and everything that is `#[inline(always)]` becomes part of it:
//!
//! ```
//! use straal_math::simd::{BLOCK, Block, Float, Kernel, Simd};
//!
//! struct Roots<'a> {
//!     of: &'a Block<f32>,
//!     out: &'a mut Block<f32>,
//! }
//!
//! impl Kernel for Roots<'_> {
//!     type Output = ();
//!     #[inline(always)]
//!     fn run<F: Float>(self) {
//!         for at in (0..BLOCK).step_by(F::WIDTH) {
//!             F::load(&self.of[at..]).sqrt().store(&mut self.out[at..]);
//!         }
//!     }
//! }
//!
//! let mut out = Block::default();
//! Simd::best().run(Roots { of: &Block([9.0; BLOCK]), out: &mut out });
//! assert_eq!(out.0, [3.0; BLOCK]);
//! ```
//!
//! A function that isn't inlined is compiled without the instruction set and slow, not wrong: hence `#[inline(always)]` all
//! the way down. A closure that works on lanes needs it as well, where it is an argument (`f(#[inline(always)] |x| x * x)`), and can't have it
//! where it is a variable; `array::map` and iterators aren't inlined for sure: write such steps out. Nothing was left out if the
//! program has no function of that kind: `nm -C target/release/straal | grep core_arch::x86::avx` finds none. Where
//! a kernel becomes too long, [`Float::vectorize`] puts a part of it into a function of its own.
//!
//! Data lie in memory as structures of arrays in a [`Block`] each, whose [`BLOCK`] lanes every width divides.

mod arch;
mod isa;
mod plain;

#[cfg(test)]
pub(crate) mod tests;

pub use isa::{Isa, UnknownIsa};
use std::fmt::Debug;
use std::ops::{
    Add, AddAssign, BitAnd, BitOr, BitXor, Div, Mul, MulAssign, Neg, Not, Shl, Shr, Sub, SubAssign,
};

/// Lanes of a block in memory: every [`Float::WIDTH`] divides it.
pub const BLOCK: usize = 16;

/// What the lanes of a block have in memory, in one line of the cache if it has 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(64))]
pub struct Block<T>(pub [T; BLOCK]);

impl<T: Default> Default for Block<T> {
    fn default() -> Self {
        Self(std::array::from_fn(|_| T::default()))
    }
}

impl<T> std::ops::Deref for Block<T> {
    type Target = [T; BLOCK];
    #[inline(always)]
    fn deref(&self) -> &[T; BLOCK] {
        &self.0
    }
}

impl<T> std::ops::DerefMut for Block<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T; BLOCK] {
        &mut self.0
    }
}

/// Arithmetic between lanes, and of lanes with a number that is the same for all.
pub trait Arithmetic<S>:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<S, Output = Self>
    + Sub<S, Output = Self>
    + Mul<S, Output = Self>
    + Div<S, Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
}

/// Operations on the bits of lanes. Shifts are by less than the bits of a lane.
pub trait Bits<S>:
    Copy
    + Debug
    + Not<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + BitAnd<S, Output = Self>
    + BitOr<S, Output = Self>
    + BitXor<S, Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
{
}

/// Numbers in single precision side by side: `f32`, or what an instruction set holds in a register.
pub trait Float: Arithmetic<f32> + sealed::Sealed + 'static {
    /// How many.
    const WIDTH: usize;
    /// 0 in every lane.
    const ZERO: Self;
    /// 1 in every lane.
    const ONE: Self;
    /// What a comparison gives.
    type Mask: Mask;
    /// As many `u32`.
    type Uint: Uint<Mask = Self::Mask, Ulong = Self::Ulong>;
    /// As many `u64`.
    type Ulong: Ulong<Mask = Self::Mask, Uint = Self::Uint>;
    /// As many `f64`.
    type Double: Double<Mask = Self::Mask, Ulong = Self::Ulong>;
    /// `[f32; WIDTH]`.
    type Array: Copy + AsRef<[f32]> + AsMut<[f32]>;

    /// The same number in every lane.
    fn splat(x: f32) -> Self;
    /// Lane by lane.
    fn from_array(lanes: Self::Array) -> Self;
    /// Lane by lane.
    fn to_array(self) -> Self::Array;

    /// What `f` gives for each lane's number.
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> f32) -> Self {
        let mut lanes = Self::ZERO.to_array();
        for (i, lane) in lanes.as_mut().iter_mut().enumerate() {
            *lane = f(i);
        }
        Self::from_array(lanes)
    }

    /// One lane.
    #[inline(always)]
    fn lane(self, i: usize) -> f32 {
        self.to_array().as_ref()[i]
    }

    /// `f` of each lane, one by one: for what can't be had side by side.
    #[inline(always)]
    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        let mut lanes = self.to_array();
        for lane in lanes.as_mut() {
            *lane = f(*lane);
        }
        Self::from_array(lanes)
    }

    /// The first numbers of a slice, which has at least [`Self::WIDTH`].
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let mut lanes = Self::ZERO.to_array();
        lanes.as_mut().copy_from_slice(&from[..Self::WIDTH]);
        Self::from_array(lanes)
    }

    /// Writes the first numbers of a slice, which has at least [`Self::WIDTH`].
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[..Self::WIDTH].copy_from_slice(self.to_array().as_ref());
    }

    /// For each lane the number of a table that `index` tells: the last one for indices beyond, 0 if the table is empty.
    fn gather(table: &[f32], index: Self::Uint) -> Self;

    /// Four numbers for each lane, as `row` gives them: the way from records in memory to lanes, by exchanges between registers.
    fn from_rows(row: impl FnMut(usize) -> [f32; 4]) -> [Self; 4];
    /// Four numbers of each lane: the way back.
    fn to_rows(columns: [Self; 4], row: impl FnMut(usize, [f32; 4]));

    /// The correctly rounded square root.
    fn sqrt(self) -> Self;
    /// The absolute value.
    fn abs(self) -> Self;
    /// Its absolute value with the sign of another.
    fn copysign(self, sign: Self) -> Self;
    /// self * a + b, rounded once.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// The lesser; `o` where they can't be compared and where they are equal, as [`crate::ops::min`].
    fn min(self, o: Self) -> Self;
    /// The greater; `o` where they can't be compared and where they are equal, as [`crate::ops::max`].
    fn max(self, o: Self) -> Self;
    /// The greatest whole number not above.
    fn floor(self) -> Self;
    /// The whole number next towards 0.
    fn trunc(self) -> Self;

    /// self < o; no if they can't be compared.
    fn lt(self, o: Self) -> Self::Mask;
    /// self <= o; no if they can't be compared.
    fn le(self, o: Self) -> Self::Mask;
    /// self == o; no if they can't be compared.
    fn eq(self, o: Self) -> Self::Mask;

    /// self > o; no if they can't be compared.
    #[inline(always)]
    fn gt(self, o: Self) -> Self::Mask {
        o.lt(self)
    }

    /// self >= o; no if they can't be compared.
    #[inline(always)]
    fn ge(self, o: Self) -> Self::Mask {
        o.le(self)
    }

    /// self != o; yes if they can't be compared.
    #[inline(always)]
    fn ne(self, o: Self) -> Self::Mask {
        !self.eq(o)
    }

    /// Neither infinite nor NaN.
    #[inline(always)]
    fn is_finite(self) -> Self::Mask {
        self.abs().lt(Self::splat(f32::INFINITY))
    }

    /// NaN.
    #[inline(always)]
    fn is_nan(self) -> Self::Mask {
        self.ne(self)
    }

    /// Whether the sign bit is set.
    #[inline(always)]
    fn is_sign_negative(self) -> Self::Mask {
        self.to_bits().lt_signed(Self::Uint::splat(0))
    }

    /// `yes` in the lanes of the mask, `no` in the others.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// The bits as whole numbers.
    fn to_bits(self) -> Self::Uint;
    /// The numbers with these bits.
    fn from_bits(bits: Self::Uint) -> Self;
    /// As `as u32`: towards 0, ends for what is beyond, 0 for NaN.
    fn to_uint(self) -> Self::Uint;
    /// As `as i32 as u32`: towards 0, ends for what is beyond, 0 for NaN.
    fn to_int(self) -> Self::Uint;
    /// As `as f32`: the nearest.
    fn from_uint(x: Self::Uint) -> Self;
    /// As `as i32 as f32`: the nearest.
    fn from_int(x: Self::Uint) -> Self;
    /// In double precision, exactly.
    fn to_double(self) -> Self::Double;
    /// The nearest in single precision.
    fn from_double(x: Self::Double) -> Self;

    /// `f` in a function of its own that is compiled for the same instruction set. Write `#[inline(always)]` before the closure.
    fn vectorize<R>(f: impl FnOnce() -> R) -> R;
}

/// Numbers in double precision side by side, for the inside of functions that need them.
pub trait Double: Arithmetic<f64> + sealed::Sealed + 'static {
    /// How many.
    const WIDTH: usize;
    /// 0 in every lane.
    const ZERO: Self;
    /// 1 in every lane.
    const ONE: Self;
    /// What a comparison gives.
    type Mask: Mask;
    /// As many `u64`.
    type Ulong: Ulong<Mask = Self::Mask>;
    /// `[f64; WIDTH]`.
    type Array: Copy + AsRef<[f64]> + AsMut<[f64]>;

    /// The same number in every lane.
    fn splat(x: f64) -> Self;
    /// Lane by lane.
    fn from_array(lanes: Self::Array) -> Self;
    /// Lane by lane.
    fn to_array(self) -> Self::Array;

    /// What `f` gives for each lane's number.
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
        let mut lanes = Self::ZERO.to_array();
        for (i, lane) in lanes.as_mut().iter_mut().enumerate() {
            *lane = f(i);
        }
        Self::from_array(lanes)
    }

    /// The first numbers of a slice, which has at least [`Self::WIDTH`].
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let mut lanes = Self::ZERO.to_array();
        lanes.as_mut().copy_from_slice(&from[..Self::WIDTH]);
        Self::from_array(lanes)
    }

    /// One lane.
    #[inline(always)]
    fn lane(self, i: usize) -> f64 {
        self.to_array().as_ref()[i]
    }

    /// The correctly rounded square root.
    fn sqrt(self) -> Self;
    /// The absolute value.
    fn abs(self) -> Self;
    /// Its absolute value with the sign of another.
    fn copysign(self, sign: Self) -> Self;
    /// The lesser; `o` where they can't be compared and where they are equal.
    fn min(self, o: Self) -> Self;
    /// The greater; `o` where they can't be compared and where they are equal.
    fn max(self, o: Self) -> Self;

    /// self < o; no if they can't be compared.
    fn lt(self, o: Self) -> Self::Mask;
    /// self <= o; no if they can't be compared.
    fn le(self, o: Self) -> Self::Mask;
    /// self == o; no if they can't be compared.
    fn eq(self, o: Self) -> Self::Mask;

    /// self > o; no if they can't be compared.
    #[inline(always)]
    fn gt(self, o: Self) -> Self::Mask {
        o.lt(self)
    }

    /// self >= o; no if they can't be compared.
    #[inline(always)]
    fn ge(self, o: Self) -> Self::Mask {
        o.le(self)
    }

    /// Neither infinite nor NaN.
    #[inline(always)]
    fn is_finite(self) -> Self::Mask {
        self.abs().lt(Self::splat(f64::INFINITY))
    }

    /// Whether the sign bit is set.
    fn is_sign_negative(self) -> Self::Mask;

    /// `yes` in the lanes of the mask, `no` in the others.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// The bits as whole numbers.
    fn to_bits(self) -> Self::Ulong;
    /// The numbers with these bits.
    fn from_bits(bits: Self::Ulong) -> Self;
}

/// Whole numbers of 32 bits side by side. They are unsigned unless a method says otherwise, and wrap around.
pub trait Uint: Bits<u32> + sealed::Sealed + 'static {
    /// How many.
    const WIDTH: usize;
    /// What a comparison gives.
    type Mask: Mask;
    /// As many `u64`.
    type Ulong: Ulong;
    /// `[u32; WIDTH]`.
    type Array: Copy + AsRef<[u32]> + AsMut<[u32]>;

    /// The same number in every lane.
    fn splat(x: u32) -> Self;
    /// Lane by lane.
    fn from_array(lanes: Self::Array) -> Self;
    /// Lane by lane.
    fn to_array(self) -> Self::Array;

    /// What `f` gives for each lane's number.
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> u32) -> Self {
        let mut lanes = Self::splat(0).to_array();
        for (i, lane) in lanes.as_mut().iter_mut().enumerate() {
            *lane = f(i);
        }
        Self::from_array(lanes)
    }

    /// One lane.
    #[inline(always)]
    fn lane(self, i: usize) -> u32 {
        self.to_array().as_ref()[i]
    }

    /// The first numbers of a slice, which has at least [`Self::WIDTH`].
    #[inline(always)]
    fn load(from: &[u32]) -> Self {
        let mut lanes = Self::splat(0).to_array();
        lanes.as_mut().copy_from_slice(&from[..Self::WIDTH]);
        Self::from_array(lanes)
    }

    /// Writes the first numbers of a slice, which has at least [`Self::WIDTH`].
    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        to[..Self::WIDTH].copy_from_slice(self.to_array().as_ref());
    }

    /// For each lane the number of a table that `index` tells: the last one for indices beyond, 0 if the table is empty.
    fn gather(table: &[u32], index: Self) -> Self;
    /// For each lane the number that the lower three bits of `self` tell.
    fn look_up(self, table: &[u32; 8]) -> Self;

    /// Sum.
    fn wrapping_add(self, o: Self) -> Self;
    /// Difference.
    fn wrapping_sub(self, o: Self) -> Self;
    /// Product.
    fn wrapping_mul(self, o: Self) -> Self;
    /// The lesser.
    fn min(self, o: Self) -> Self;
    /// The greater.
    fn max(self, o: Self) -> Self;
    /// Shifted down as an `i32`: the sign is repeated. By less than 32.
    fn shr_signed(self, by: u32) -> Self;
    /// Each lane shifted up by its own number of bits, less than 32.
    fn shl_each(self, by: Self) -> Self;
    /// Each lane shifted down by its own number of bits, less than 32.
    fn shr_each(self, by: Self) -> Self;
    /// The bits in reverse order.
    fn reverse_bits(self) -> Self;

    /// Both with their bits in reverse order: cheaper than one after the other where the processor has no instruction for it.
    #[inline(always)]
    fn reverse_both(a: Self, b: Self) -> [Self; 2] {
        [a.reverse_bits(), b.reverse_bits()]
    }

    /// self == o.
    fn eq(self, o: Self) -> Self::Mask;
    /// self < o.
    fn lt(self, o: Self) -> Self::Mask;
    /// self < o, both taken as `i32`.
    fn lt_signed(self, o: Self) -> Self::Mask;

    /// self <= o.
    #[inline(always)]
    fn le(self, o: Self) -> Self::Mask {
        !o.lt(self)
    }

    /// `yes` in the lanes of the mask, `no` in the others.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// The same numbers in 64 bits.
    fn to_ulong(self) -> Self::Ulong;
}

/// Whole numbers of 64 bits side by side; they wrap around.
pub trait Ulong: Bits<u64> + sealed::Sealed + 'static {
    /// How many.
    const WIDTH: usize;
    /// What a comparison gives.
    type Mask: Mask;
    /// As many `u32`.
    type Uint: Uint;
    /// `[u64; WIDTH]`.
    type Array: Copy + AsRef<[u64]> + AsMut<[u64]>;

    /// The same number in every lane.
    fn splat(x: u64) -> Self;
    /// Lane by lane.
    fn from_array(lanes: Self::Array) -> Self;
    /// Lane by lane.
    fn to_array(self) -> Self::Array;

    /// What `f` gives for each lane's number.
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> u64) -> Self {
        let mut lanes = Self::splat(0).to_array();
        for (i, lane) in lanes.as_mut().iter_mut().enumerate() {
            *lane = f(i);
        }
        Self::from_array(lanes)
    }

    /// One lane.
    #[inline(always)]
    fn lane(self, i: usize) -> u64 {
        self.to_array().as_ref()[i]
    }

    /// Sum.
    fn wrapping_add(self, o: Self) -> Self;
    /// Difference.
    fn wrapping_sub(self, o: Self) -> Self;
    /// Product.
    fn wrapping_mul(self, o: Self) -> Self;
    /// self == o.
    fn eq(self, o: Self) -> Self::Mask;
    /// `yes` in the lanes of the mask, `no` in the others.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// The lower 32 bits.
    fn low(self) -> Self::Uint;

    /// The upper 32 bits.
    #[inline(always)]
    fn high(self) -> Self::Uint {
        (self >> 32).low()
    }
}

/// Yes or no for each lane.
pub trait Mask:
    Copy
    + Debug
    + Not<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + sealed::Sealed
    + 'static
{
    /// The same in every lane.
    fn splat(yes: bool) -> Self;
    /// The lanes of the bits that are set, the lowest bit being the first lane's.
    fn from_bits(bits: u32) -> Self;
    /// One bit for each lane, the lowest being the first lane's.
    fn to_bits(self) -> u32;
    /// Yes in one lane at least.
    fn any(self) -> bool;
    /// Yes in every lane.
    fn all(self) -> bool;

    /// One lane.
    #[inline(always)]
    fn lane(self, i: usize) -> bool {
        self.to_bits() >> i & 1 == 1
    }
}

/// What is compiled for every instruction set and run with the one that was chosen.
pub trait Kernel {
    /// What it gives.
    type Output;

    /// The work; to be `#[inline(always)]`, as all that it calls.
    fn run<F: Float>(self) -> Self::Output;
}

/// An instruction set that this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Simd(Isa);

impl Simd {
    /// One lane at a time, which every processor has.
    pub const PLAIN: Self = Self(Isa::Scalar);

    /// `None` where the processor hasn't the set.
    pub fn new(isa: Isa) -> Option<Self> {
        isa.is_available().then_some(Self(isa))
    }

    /// The best that the processor has.
    pub fn best() -> Self {
        Self(Isa::detect())
    }

    /// Which it is.
    pub const fn isa(self) -> Isa {
        self.0
    }

    /// Lanes of its [`Float`].
    pub fn width(self) -> usize {
        struct Width;
        impl Kernel for Width {
            type Output = usize;
            #[inline(always)]
            fn run<F: Float>(self) -> usize {
                F::WIDTH
            }
        }
        self.run(Width)
    }

    /// Runs a kernel by this instruction set. Sets without vectors of eight lanes run plain numbers.
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        arch::run(self, kernel)
    }
}

mod sealed {
    /// No families but those in here.
    pub trait Sealed {}
}
