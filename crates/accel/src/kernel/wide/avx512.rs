//! Eight lanes of AVX-512.
//!
//! Safety: only a kernel makes the first vector, and only where the processor has AVX-512 F, DQ and VL; that there is a vector is the proof
//! from then on. What is read or written lies inside rows of eight, for places are cut to multiples of the lanes below eight.

use crate::{
    kernel::avx512::Avx512,
    lanes::{Double, Doubles, Mask, ROW, Single, Singles, Wide},
};
use std::{
    arch::x86_64::*,
    ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub},
};

/// Single precision.
#[derive(Clone, Copy)]
pub(crate) struct Singles8(__m256);

/// Double precision.
#[derive(Clone, Copy)]
pub(crate) struct Doubles8(__m512d);

/// Yes or no, a bit for each lane.
#[derive(Clone, Copy)]
pub(crate) struct Mask8(__mmask8);

impl Mask for Mask8 {
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self.0)
    }
}

impl BitAnd for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        Self(self.0 & o.0)
    }
}

impl BitOr for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        Self(self.0 | o.0)
    }
}

impl Sub for Singles8 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_sub_ps(self.0, o.0) })
    }
}

impl Mul for Singles8 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_mul_ps(self.0, o.0) })
    }
}

impl Div for Singles8 {
    type Output = Self;

    #[inline(always)]
    fn div(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_div_ps(self.0, o.0) })
    }
}

impl Add for Doubles8 {
    type Output = Self;

    #[inline(always)]
    fn add(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm512_add_pd(self.0, o.0) })
    }
}

impl Sub for Doubles8 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm512_sub_pd(self.0, o.0) })
    }
}

impl Mul for Doubles8 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm512_mul_pd(self.0, o.0) })
    }
}

impl Div for Doubles8 {
    type Output = Self;

    #[inline(always)]
    fn div(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm512_div_pd(self.0, o.0) })
    }
}

impl Neg for Doubles8 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

impl Single for Singles8 {
    type Mask = Mask8;

    #[inline(always)]
    fn least(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_min_ps(self.0, o.0) })
    }

    #[inline(always)]
    fn most(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_max_ps(self.0, o.0) })
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> Mask8 {
        // SAFETY: see the head of the file.
        Mask8(unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(self.0, o.0) })
    }

    #[inline(always)]
    fn size(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn with_sign(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        unsafe {
            let sign = _mm256_set1_ps(-0.0);
            Self(_mm256_or_ps(_mm256_andnot_ps(sign, self.0), _mm256_and_ps(sign, o.0)))
        }
    }

    #[inline(always)]
    fn or(self, mask: Mask8, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_mask_blend_ps(mask.0, o.0, self.0) })
    }
}

impl Double for Doubles8 {
    type Mask = Mask8;

    #[inline(always)]
    fn splat(self, x: f64) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm512_set1_pd(x) })
    }

    #[inline(always)]
    fn root(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn with_sign(self, o: Self) -> Self {
        // SAFETY: see the head of the file.
        unsafe {
            let sign = _mm512_set1_pd(-0.0);
            Self(_mm512_or_pd(_mm512_andnot_pd(sign, self.0), _mm512_and_pd(sign, o.0)))
        }
    }

    #[inline(always)]
    fn below(self, o: Self) -> Mask8 {
        // SAFETY: see the head of the file.
        Mask8(unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, o.0) })
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> Mask8 {
        // SAFETY: see the head of the file.
        Mask8(unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, o.0) })
    }

    #[inline(always)]
    fn equals(self, o: Self) -> Mask8 {
        // SAFETY: see the head of the file.
        Mask8(unsafe { _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(self.0, o.0) })
    }

    #[inline(always)]
    fn or(self, mask: Mask8, o: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm512_mask_blend_pd(mask.0, o.0, self.0) })
    }

    #[inline(always)]
    fn rounded(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm512_cvtps_pd(_mm512_cvtpd_ps(self.0)) })
    }
}

impl Wide for Avx512 {
    const LANES: usize = 8;

    type Single = Singles8;
    type Double = Doubles8;

    #[inline(always)]
    fn single(self, x: f32) -> Singles8 {
        // SAFETY: see the head of the file.
        Singles8(unsafe { _mm256_set1_ps(x) })
    }

    #[inline(always)]
    fn double(self, x: f64) -> Doubles8 {
        // SAFETY: see the head of the file.
        Doubles8(unsafe { _mm512_set1_pd(x) })
    }

    #[inline(always)]
    fn singles(self, from: &Singles, _at: usize) -> Singles8 {
        // SAFETY: see the head of the file.
        Singles8(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn doubles(self, from: &Doubles, _at: usize) -> Doubles8 {
        // SAFETY: see the head of the file.
        Doubles8(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }

    #[inline(always)]
    fn put_singles(self, x: Singles8, to: &mut Singles, _at: usize) {
        // SAFETY: see the head of the file.
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), x.0) }
    }

    #[inline(always)]
    fn put_doubles(self, x: Doubles8, to: &mut Doubles, _at: usize) {
        // SAFETY: see the head of the file.
        unsafe { _mm512_storeu_pd(to.as_mut_ptr(), x.0) }
    }

    #[inline(always)]
    fn widened(self, x: Singles8) -> Doubles8 {
        // SAFETY: see the head of the file.
        Doubles8(unsafe { _mm512_cvtps_pd(x.0) })
    }

    #[inline(always)]
    fn wide_mask(self, mask: Mask8) -> Mask8 {
        mask
    }
}

const _: () = assert!(ROW == 8);
