//! Two lanes of SSE4.2: of a vector in single precision, the lower half.
//!
//! Safety: only a kernel makes the first vector, and only where the processor has SSE4.2; that there is a vector is the proof
//! from then on. What is read or written lies inside rows of eight, for places are cut to multiples of the lanes below eight.

use crate::{
    kernel::sse::Sse,
    lanes::{Double, Doubles, Mask, ROW, Single, Singles, Wide},
};
use std::{
    arch::x86_64::*,
    ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub},
};

/// Single precision.
#[derive(Clone, Copy)]
pub(crate) struct Singles2(__m128);

/// Double precision.
#[derive(Clone, Copy)]
pub(crate) struct Doubles2(__m128d);

/// Yes or no, all bits of a single lane.
#[derive(Clone, Copy)]
pub(crate) struct SingleMask2(__m128);

impl Mask for SingleMask2 {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: see the head of the file.
        unsafe { _mm_movemask_ps(self.0) as u32 & 3 }
    }
}

impl BitAnd for SingleMask2 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_and_ps(self.0, o.0) })
    }
}

impl BitOr for SingleMask2 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_or_ps(self.0, o.0) })
    }
}

/// Yes or no, all bits of a double lane.
#[derive(Clone, Copy)]
pub(crate) struct DoubleMask2(__m128d);

impl Mask for DoubleMask2 {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: see the head of the file.
        unsafe { _mm_movemask_pd(self.0) as u32 }
    }
}

impl BitAnd for DoubleMask2 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_and_pd(self.0, o.0) })
    }
}

impl BitOr for DoubleMask2 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_or_pd(self.0, o.0) })
    }
}

impl Sub for Singles2 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_sub_ps(self.0, o.0) })
    }
}

impl Mul for Singles2 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_mul_ps(self.0, o.0) })
    }
}

impl Div for Singles2 {
    type Output = Self;

    #[inline(always)]
    fn div(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_div_ps(self.0, o.0) })
    }
}

impl Add for Doubles2 {
    type Output = Self;

    #[inline(always)]
    fn add(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_add_pd(self.0, o.0) })
    }
}

impl Sub for Doubles2 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_sub_pd(self.0, o.0) })
    }
}

impl Mul for Doubles2 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_mul_pd(self.0, o.0) })
    }
}

impl Div for Doubles2 {
    type Output = Self;

    #[inline(always)]
    fn div(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_div_pd(self.0, o.0) })
    }
}

impl Neg for Doubles2 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_xor_pd(self.0, _mm_set1_pd(-0.0)) })
    }
}

impl Single for Singles2 {
    type Mask = SingleMask2;

    #[inline(always)]
    fn least(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_min_ps(self.0, o.0) })
    }

    #[inline(always)]
    fn most(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_max_ps(self.0, o.0) })
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> SingleMask2 {
        // SAFETY: see the head of the file.
        SingleMask2(unsafe { _mm_cmple_ps(self.0, o.0) })
    }

    #[inline(always)]
    fn size(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_andnot_ps(_mm_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn with_sign(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        unsafe {
            let sign = _mm_set1_ps(-0.0);
            Self(_mm_or_ps(_mm_andnot_ps(sign, self.0), _mm_and_ps(sign, o.0)))
        }
    }

    #[inline(always)]
    fn or(self, mask: SingleMask2, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_blendv_ps(o.0, self.0, mask.0) })
    }
}

impl Double for Doubles2 {
    type Mask = DoubleMask2;

    #[inline(always)]
    fn splat(self, x: f64) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_set1_pd(x) })
    }

    #[inline(always)]
    fn root(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn with_sign(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        unsafe {
            let sign = _mm_set1_pd(-0.0);
            Self(_mm_or_pd(_mm_andnot_pd(sign, self.0), _mm_and_pd(sign, o.0)))
        }
    }

    #[inline(always)]
    fn below(self, o: Self) -> DoubleMask2 {
        // SAFETY: see the head of the file.
        DoubleMask2(unsafe { _mm_cmplt_pd(self.0, o.0) })
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> DoubleMask2 {
        // SAFETY: see the head of the file.
        DoubleMask2(unsafe { _mm_cmple_pd(self.0, o.0) })
    }

    #[inline(always)]
    fn equals(self, o: Self) -> DoubleMask2 {
        // SAFETY: see the head of the file.
        DoubleMask2(unsafe { _mm_cmpeq_pd(self.0, o.0) })
    }

    #[inline(always)]
    fn or(self, mask: DoubleMask2, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_blendv_pd(o.0, self.0, mask.0) })
    }

    #[inline(always)]
    fn rounded(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_cvtps_pd(_mm_cvtpd_ps(self.0)) })
    }
}

impl Wide for Sse {
    const LANES: usize = 2;

    type Single = Singles2;
    type Double = Doubles2;

    #[inline(always)]
    fn single(self, x: f32) -> Singles2 {
        // SAFETY: see the head of the file.
        Singles2(unsafe { _mm_set1_ps(x) })
    }

    #[inline(always)]
    fn double(self, x: f64) -> Doubles2 {
        // SAFETY: see the head of the file.
        Doubles2(unsafe { _mm_set1_pd(x) })
    }

    #[inline(always)]
    fn singles(self, from: &Singles, at: usize) -> Singles2 {
        // SAFETY: see the head of the file.
        Singles2(unsafe { _mm_castpd_ps(_mm_load_sd(from.as_ptr().add(at & 6).cast())) })
    }

    #[inline(always)]
    fn doubles(self, from: &Doubles, at: usize) -> Doubles2 {
        // SAFETY: see the head of the file.
        Doubles2(unsafe { _mm_loadu_pd(from.as_ptr().add(at & 6)) })
    }

    #[inline(always)]
    fn put_singles(self, x: Singles2, to: &mut Singles, at: usize) {
        // SAFETY: see the head of the file.
        unsafe { _mm_store_sd(to.as_mut_ptr().add(at & 6).cast(), _mm_castps_pd(x.0)) }
    }

    #[inline(always)]
    fn put_doubles(self, x: Doubles2, to: &mut Doubles, at: usize) {
        // SAFETY: see the head of the file.
        unsafe { _mm_storeu_pd(to.as_mut_ptr().add(at & 6), x.0) }
    }

    #[inline(always)]
    fn widened(self, x: Singles2) -> Doubles2 {
        // SAFETY: see the head of the file.
        Doubles2(unsafe { _mm_cvtps_pd(x.0) })
    }

    #[inline(always)]
    fn wide_mask(self, mask: SingleMask2) -> DoubleMask2 {
        // SAFETY: see the head of the file.
        unsafe { DoubleMask2(_mm_castps_pd(_mm_unpacklo_ps(mask.0, mask.0))) }
    }
}

const _: () = assert!(ROW == 8);
