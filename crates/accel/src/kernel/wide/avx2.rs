//! Four lanes of AVX2.
//!
//! Safety: only a kernel makes the first vector, and only where the processor has AVX2; that there is a vector is the proof
//! from then on. What is read or written lies inside rows of eight, for places are cut to multiples of the lanes below eight.

use crate::{
    kernel::avx2::Avx2,
    lanes::{Double, Doubles, Mask, ROW, Single, Singles, Wide},
};
use std::{
    arch::x86_64::*,
    ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub},
};

/// Single precision.
#[derive(Clone, Copy)]
pub(crate) struct Singles4(__m128);

/// Double precision.
#[derive(Clone, Copy)]
pub(crate) struct Doubles4(__m256d);

/// Yes or no, all bits of a single lane.
#[derive(Clone, Copy)]
pub(crate) struct SingleMask4(__m128);

impl Mask for SingleMask4 {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: see the head of the file.
        unsafe { _mm_movemask_ps(self.0) as u32 }
    }
}

impl BitAnd for SingleMask4 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_and_ps(self.0, o.0) })
    }
}

impl BitOr for SingleMask4 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_or_ps(self.0, o.0) })
    }
}

/// Yes or no, all bits of a double lane.
#[derive(Clone, Copy)]
pub(crate) struct DoubleMask4(__m256d);

impl Mask for DoubleMask4 {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: see the head of the file.
        unsafe { _mm256_movemask_pd(self.0) as u32 }
    }
}

impl BitAnd for DoubleMask4 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_and_pd(self.0, o.0) })
    }
}

impl BitOr for DoubleMask4 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_or_pd(self.0, o.0) })
    }
}

impl Sub for Singles4 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_sub_ps(self.0, o.0) })
    }
}

impl Mul for Singles4 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_mul_ps(self.0, o.0) })
    }
}

impl Div for Singles4 {
    type Output = Self;

    #[inline(always)]
    fn div(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_div_ps(self.0, o.0) })
    }
}

impl Add for Doubles4 {
    type Output = Self;

    #[inline(always)]
    fn add(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_add_pd(self.0, o.0) })
    }
}

impl Sub for Doubles4 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_sub_pd(self.0, o.0) })
    }
}

impl Mul for Doubles4 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_mul_pd(self.0, o.0) })
    }
}

impl Div for Doubles4 {
    type Output = Self;

    #[inline(always)]
    fn div(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_div_pd(self.0, o.0) })
    }
}

impl Neg for Doubles4 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

impl Single for Singles4 {
    type Mask = SingleMask4;

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
    fn at_most(self, o: Self) -> SingleMask4 {
        // SAFETY: see the head of the file.
        SingleMask4(unsafe { _mm_cmple_ps(self.0, o.0) })
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
    fn or(self, mask: SingleMask4, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm_blendv_ps(o.0, self.0, mask.0) })
    }
}

impl Double for Doubles4 {
    type Mask = DoubleMask4;

    #[inline(always)]
    fn splat(self, x: f64) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_set1_pd(x) })
    }

    #[inline(always)]
    fn root(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn with_sign(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            Self(_mm256_or_pd(_mm256_andnot_pd(sign, self.0), _mm256_and_pd(sign, o.0)))
        }
    }

    #[inline(always)]
    fn below(self, o: Self) -> DoubleMask4 {
        // SAFETY: see the head of the file.
        DoubleMask4(unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, o.0) })
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> DoubleMask4 {
        // SAFETY: see the head of the file.
        DoubleMask4(unsafe { _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, o.0) })
    }

    #[inline(always)]
    fn equals(self, o: Self) -> DoubleMask4 {
        // SAFETY: see the head of the file.
        DoubleMask4(unsafe { _mm256_cmp_pd::<_CMP_EQ_OQ>(self.0, o.0) })
    }

    #[inline(always)]
    fn or(self, mask: DoubleMask4, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_blendv_pd(o.0, self.0, mask.0) })
    }

    #[inline(always)]
    fn rounded(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_cvtps_pd(_mm256_cvtpd_ps(self.0)) })
    }
}

impl Wide for Avx2 {
    const LANES: usize = 4;

    type Single = Singles4;
    type Double = Doubles4;

    #[inline(always)]
    fn single(self, x: f32) -> Singles4 {
        // SAFETY: see the head of the file.
        Singles4(unsafe { _mm_set1_ps(x) })
    }

    #[inline(always)]
    fn double(self, x: f64) -> Doubles4 {
        // SAFETY: see the head of the file.
        Doubles4(unsafe { _mm256_set1_pd(x) })
    }

    #[inline(always)]
    fn singles(self, from: &Singles, at: usize) -> Singles4 {
        // SAFETY: see the head of the file.
        Singles4(unsafe { _mm_loadu_ps(from.as_ptr().add(at & 4)) })
    }

    #[inline(always)]
    fn doubles(self, from: &Doubles, at: usize) -> Doubles4 {
        // SAFETY: see the head of the file.
        Doubles4(unsafe { _mm256_loadu_pd(from.as_ptr().add(at & 4)) })
    }

    #[inline(always)]
    fn put_singles(self, x: Singles4, to: &mut Singles, at: usize) {
        // SAFETY: see the head of the file.
        unsafe { _mm_storeu_ps(to.as_mut_ptr().add(at & 4), x.0) }
    }

    #[inline(always)]
    fn put_doubles(self, x: Doubles4, to: &mut Doubles, at: usize) {
        // SAFETY: see the head of the file.
        unsafe { _mm256_storeu_pd(to.as_mut_ptr().add(at & 4), x.0) }
    }

    #[inline(always)]
    fn widened(self, x: Singles4) -> Doubles4 {
        // SAFETY: see the head of the file.
        Doubles4(unsafe { _mm256_cvtps_pd(x.0) })
    }

    #[inline(always)]
    fn wide_mask(self, mask: SingleMask4) -> DoubleMask4 {
        // SAFETY: see the head of the file.
        unsafe { DoubleMask4(_mm256_castsi256_pd(_mm256_cvtepi32_epi64(_mm_castps_si128(mask.0)))) }
    }
}

const _: () = assert!(ROW == 8);
