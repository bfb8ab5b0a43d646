//! Two lanes of NEON.
//!
//! Safety: only a kernel makes the first vector, and only where the processor has NEON; that there is a vector is the proof
//! from then on. What is read or written lies inside rows of eight, for places are cut to multiples of the lanes below eight.

use crate::{
    kernel::neon::Neon,
    lanes::{Double, Doubles, Mask, ROW, Single, Singles, Wide},
};
use std::{
    arch::aarch64::*,
    ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub},
};

/// Single precision.
#[derive(Clone, Copy)]
pub(crate) struct Singles2(float32x2_t);

/// Double precision.
#[derive(Clone, Copy)]
pub(crate) struct Doubles2(float64x2_t);

/// Yes or no, all bits of a single lane.
#[derive(Clone, Copy)]
pub(crate) struct SingleMask2(uint32x2_t);

impl Mask for SingleMask2 {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: see the head of the file.
        unsafe { vget_lane_u32::<0>(self.0) & 1 | vget_lane_u32::<1>(self.0) & 2 }
    }
}

impl BitAnd for SingleMask2 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vand_u32(self.0, o.0) })
    }
}

impl BitOr for SingleMask2 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vorr_u32(self.0, o.0) })
    }
}

/// Yes or no, all bits of a double lane.
#[derive(Clone, Copy)]
pub(crate) struct DoubleMask2(uint64x2_t);

impl Mask for DoubleMask2 {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: see the head of the file.
        unsafe { (vgetq_lane_u64::<0>(self.0) & 1 | vgetq_lane_u64::<1>(self.0) & 2) as u32 }
    }
}

impl BitAnd for DoubleMask2 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vandq_u64(self.0, o.0) })
    }
}

impl BitOr for DoubleMask2 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vorrq_u64(self.0, o.0) })
    }
}

impl Sub for Singles2 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vsub_f32(self.0, o.0) })
    }
}

impl Mul for Singles2 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vmul_f32(self.0, o.0) })
    }
}

impl Div for Singles2 {
    type Output = Self;

    #[inline(always)]
    fn div(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vdiv_f32(self.0, o.0) })
    }
}

impl Add for Doubles2 {
    type Output = Self;

    #[inline(always)]
    fn add(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vaddq_f64(self.0, o.0) })
    }
}

impl Sub for Doubles2 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vsubq_f64(self.0, o.0) })
    }
}

impl Mul for Doubles2 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vmulq_f64(self.0, o.0) })
    }
}

impl Div for Doubles2 {
    type Output = Self;

    #[inline(always)]
    fn div(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vdivq_f64(self.0, o.0) })
    }
}

impl Neg for Doubles2 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vnegq_f64(self.0) })
    }
}

impl Single for Singles2 {
    type Mask = SingleMask2;

    #[inline(always)]
    fn least(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vmin_f32(self.0, o.0) })
    }

    #[inline(always)]
    fn most(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vmax_f32(self.0, o.0) })
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> SingleMask2 {
        // SAFETY: see the head of the file.
        SingleMask2(unsafe { vcle_f32(self.0, o.0) })
    }

    #[inline(always)]
    fn size(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vabs_f32(self.0) })
    }

    #[inline(always)]
    fn with_sign(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vbsl_f32(vdup_n_u32(1 << 31), o.0, self.0) })
    }

    #[inline(always)]
    fn or(self, mask: SingleMask2, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vbsl_f32(mask.0, self.0, o.0) })
    }
}

impl Double for Doubles2 {
    type Mask = DoubleMask2;

    #[inline(always)]
    fn splat(self, x: f64) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vdupq_n_f64(x) })
    }

    #[inline(always)]
    fn root(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vsqrtq_f64(self.0) })
    }

    #[inline(always)]
    fn with_sign(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vbslq_f64(vdupq_n_u64(1 << 63), o.0, self.0) })
    }

    #[inline(always)]
    fn below(self, o: Self) -> DoubleMask2 {
        // SAFETY: see the head of the file.
        DoubleMask2(unsafe { vcltq_f64(self.0, o.0) })
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> DoubleMask2 {
        // SAFETY: see the head of the file.
        DoubleMask2(unsafe { vcleq_f64(self.0, o.0) })
    }

    #[inline(always)]
    fn equals(self, o: Self) -> DoubleMask2 {
        // SAFETY: see the head of the file.
        DoubleMask2(unsafe { vceqq_f64(self.0, o.0) })
    }

    #[inline(always)]
    fn or(self, mask: DoubleMask2, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vbslq_f64(mask.0, self.0, o.0) })
    }

    #[inline(always)]
    fn rounded(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { vcvt_f64_f32(vcvt_f32_f64(self.0)) })
    }
}

impl Wide for Neon {
    const LANES: usize = 2;

    type Single = Singles2;
    type Double = Doubles2;

    #[inline(always)]
    fn single(self, x: f32) -> Singles2 {
        // SAFETY: see the head of the file.
        Singles2(unsafe { vdup_n_f32(x) })
    }

    #[inline(always)]
    fn double(self, x: f64) -> Doubles2 {
        // SAFETY: see the head of the file.
        Doubles2(unsafe { vdupq_n_f64(x) })
    }

    #[inline(always)]
    fn singles(self, from: &Singles, at: usize) -> Singles2 {
        // SAFETY: see the head of the file.
        Singles2(unsafe { vld1_f32(from.as_ptr().add(at & 6)) })
    }

    #[inline(always)]
    fn doubles(self, from: &Doubles, at: usize) -> Doubles2 {
        // SAFETY: see the head of the file.
        Doubles2(unsafe { vld1q_f64(from.as_ptr().add(at & 6)) })
    }

    #[inline(always)]
    fn put_singles(self, x: Singles2, to: &mut Singles, at: usize) {
        // SAFETY: see the head of the file.
        unsafe { vst1_f32(to.as_mut_ptr().add(at & 6), x.0) }
    }

    #[inline(always)]
    fn put_doubles(self, x: Doubles2, to: &mut Doubles, at: usize) {
        // SAFETY: see the head of the file.
        unsafe { vst1q_f64(to.as_mut_ptr().add(at & 6), x.0) }
    }

    #[inline(always)]
    fn widened(self, x: Singles2) -> Doubles2 {
        // SAFETY: see the head of the file.
        Doubles2(unsafe { vcvt_f64_f32(x.0) })
    }

    #[inline(always)]
    fn wide_mask(self, mask: SingleMask2) -> DoubleMask2 {
        // SAFETY: see the head of the file.
        unsafe { DoubleMask2(vreinterpretq_u64_s64(vmovl_s32(vreinterpret_s32_u32(mask.0)))) }
    }
}

const _: () = assert!(ROW == 8);
