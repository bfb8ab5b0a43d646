//! AVX-512: sixteen lanes in a register, lanes of 64 bits in two, and masks of a bit for each lane.

use super::vectors::*;
use crate::simd::{Arithmetic, Bits, Double, Float, Mask, Uint, Ulong, sealed::Sealed};

vector_types!(16 lanes, 1 registers, 2 double,
    features "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt");

/// Registers, and whole vectors where lanes of 32 and 64 bits meet.
mod raw {
    use std::arch::x86_64::*;
    pub use std::arch::x86_64::{
        _mm512_add_epi32 as add_u32, _mm512_add_epi64 as add_u64, _mm512_add_pd as add_f64,
        _mm512_add_ps as add_f32, _mm512_and_si512 as and_u32, _mm512_and_si512 as and_u64,
        _mm512_castpd_si512 as bits_f64, _mm512_castps_si512 as bits_f32, _mm512_castsi512_pd as f64_of_bits,
        _mm512_castsi512_ps as f32_of_bits, _mm512_cvtepi32_ps as i32_to_f32,
        _mm512_cvtepu32_ps as u32_to_f32, _mm512_div_pd as div_f64, _mm512_div_ps as div_f32,
        _mm512_fmadd_ps as mul_add_f32, _mm512_max_epu32 as max_u32, _mm512_max_pd as max_f64,
        _mm512_max_ps as max_f32, _mm512_min_epu32 as min_u32, _mm512_min_pd as min_f64,
        _mm512_min_ps as min_f32, _mm512_mul_pd as mul_f64, _mm512_mul_ps as mul_f32,
        _mm512_mullo_epi32 as mul_u32, _mm512_mullo_epi64 as mul_u64, _mm512_or_si512 as or_u32,
        _mm512_or_si512 as or_u64, _mm512_set1_pd as splat_f64, _mm512_set1_ps as splat_f32,
        _mm512_sllv_epi32 as shl_each_u32, _mm512_sqrt_pd as sqrt_f64, _mm512_sqrt_ps as sqrt_f32,
        _mm512_srlv_epi32 as shr_each_u32, _mm512_sub_epi32 as sub_u32, _mm512_sub_epi64 as sub_u64,
        _mm512_sub_pd as sub_f64, _mm512_sub_ps as sub_f32, _mm512_xor_si512 as xor_u32,
        _mm512_xor_si512 as xor_u64,
    };

    pub type F32 = __m512;
    pub type U32 = __m512i;
    pub type F64 = __m512d;
    pub type U64 = __m512i;
    pub type M = __mmask16;

    /// Functions that are compiled for the set, and become part of those that call them.
    macro_rules! functions {
        ($($(#[$doc:meta])* fn $name:ident($($arg:tt: $t:ty),*) -> $out:ty $body:block)*) => {
            $(
                $(#[$doc])*
                #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
                #[inline]
                pub fn $name($($arg: $t),*) -> $out $body
            )*
        };
    }

    functions! {
        fn splat_u32(x: u32) -> U32 { _mm512_set1_epi32(x as i32) }
        fn splat_u64(x: u64) -> U64 { _mm512_set1_epi64(x as i64) }
        fn floor_f32(x: F32) -> F32 {
            _mm512_roundscale_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(x)
        }
        fn trunc_f32(x: F32) -> F32 { _mm512_roundscale_ps::<{ _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC }>(x) }

        fn shl_u32(x: U32, by: u32) -> U32 { _mm512_sll_epi32(x, _mm_cvtsi32_si128(by as i32)) }
        fn shr_u32(x: U32, by: u32) -> U32 { _mm512_srl_epi32(x, _mm_cvtsi32_si128(by as i32)) }
        fn shr_signed_u32(x: U32, by: u32) -> U32 { _mm512_sra_epi32(x, _mm_cvtsi32_si128(by as i32)) }
        fn shl_u64(x: U64, by: u32) -> U64 { _mm512_sll_epi64(x, _mm_cvtsi32_si128(by as i32)) }
        fn shr_u64(x: U64, by: u32) -> U64 { _mm512_srl_epi64(x, _mm_cvtsi32_si128(by as i32)) }

        /// Each half byte reversed by a table, then the bytes.
        fn reverse_bits_u32(x: U32) -> U32 {
            let table = _mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15);
            let bytes = _mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12);
            let (table, bytes) = (_mm512_broadcast_i32x4(table), _mm512_broadcast_i32x4(bytes));
            let lower = _mm512_set1_epi8(15);
            let x = _mm512_shuffle_epi8(x, bytes);
            let low = _mm512_shuffle_epi8(table, _mm512_and_si512(x, lower));
            let high = _mm512_shuffle_epi8(table, _mm512_and_si512(_mm512_srli_epi32::<4>(x), lower));
            _mm512_or_si512(_mm512_slli_epi32::<4>(low), high)
        }

        fn f32_to_u32(x: F32) -> U32 {
            // What is below 0 or NaN becomes 0; what is beyond gives u32::MAX.
            _mm512_cvttps_epu32(_mm512_max_ps(x, _mm512_setzero_ps()))
        }
        fn f32_to_i32(x: F32) -> U32 {
            // What is beyond gives i32::MIN, the right end for negative numbers.
            let beyond = _mm512_cmp_ps_mask::<_CMP_GE_OQ>(x, _mm512_set1_ps(2_147_483_648.0));
            let number = _mm512_cmp_ps_mask::<_CMP_ORD_Q>(x, x);
            let whole = _mm512_maskz_cvttps_epi32(number, x);
            _mm512_mask_mov_epi32(whole, beyond, _mm512_set1_epi32(i32::MAX))
        }

        fn widen_f32([x]: [F32; 1]) -> [F64; 2] {
            [_mm512_cvtps_pd(_mm512_castps512_ps256(x)), _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(x))]
        }
        fn narrow_f64([a, b]: [F64; 2]) -> [F32; 1] {
            [_mm512_insertf32x8::<1>(_mm512_castps256_ps512(_mm512_cvtpd_ps(a)), _mm512_cvtpd_ps(b))]
        }
        fn widen_u32([x]: [U32; 1]) -> [U64; 2] {
            [
                _mm512_cvtepu32_epi64(_mm512_castsi512_si256(x)),
                _mm512_cvtepu32_epi64(_mm512_extracti32x8_epi32::<1>(x)),
            ]
        }
        fn narrow_u64([a, b]: [U64; 2]) -> [U32; 1] {
            let low = _mm512_castsi256_si512(_mm512_cvtepi64_epi32(a));
            [_mm512_inserti32x8::<1>(low, _mm512_cvtepi64_epi32(b))]
        }

        fn lt_f32([a]: [F32; 1], [b]: [F32; 1]) -> M { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b) }
        fn le_f32([a]: [F32; 1], [b]: [F32; 1]) -> M { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b) }
        fn eq_f32([a]: [F32; 1], [b]: [F32; 1]) -> M { _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(a, b) }
        fn lt_f64([a, b]: [F64; 2], [c, d]: [F64; 2]) -> M {
            both(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, c), _mm512_cmp_pd_mask::<_CMP_LT_OQ>(b, d))
        }
        fn le_f64([a, b]: [F64; 2], [c, d]: [F64; 2]) -> M {
            both(_mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, c), _mm512_cmp_pd_mask::<_CMP_LE_OQ>(b, d))
        }
        fn eq_f64([a, b]: [F64; 2], [c, d]: [F64; 2]) -> M {
            both(_mm512_cmp_pd_mask::<_CMP_EQ_OQ>(a, c), _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(b, d))
        }
        fn eq_u64([a, b]: [U64; 2], [c, d]: [U64; 2]) -> M {
            both(_mm512_cmpeq_epi64_mask(a, c), _mm512_cmpeq_epi64_mask(b, d))
        }
        fn eq_u32([a]: [U32; 1], [b]: [U32; 1]) -> M { _mm512_cmpeq_epi32_mask(a, b) }
        fn lt_i32([a]: [U32; 1], [b]: [U32; 1]) -> M { _mm512_cmplt_epi32_mask(a, b) }
        fn lt_u32([a]: [U32; 1], [b]: [U32; 1]) -> M { _mm512_cmplt_epu32_mask(a, b) }
        fn both(low: __mmask8, high: __mmask8) -> M { M::from(high) << 8 | M::from(low) }

        fn select_f32(m: M, [a]: [F32; 1], [b]: [F32; 1]) -> [F32; 1] { [_mm512_mask_blend_ps(m, b, a)] }
        fn select_u32(m: M, [a]: [U32; 1], [b]: [U32; 1]) -> [U32; 1] { [_mm512_mask_blend_epi32(m, b, a)] }
        fn select_f64(m: M, [a, b]: [F64; 2], [c, d]: [F64; 2]) -> [F64; 2] {
            [_mm512_mask_blend_pd(m as u8, c, a), _mm512_mask_blend_pd((m >> 8) as u8, d, b)]
        }
        fn select_u64(m: M, [a, b]: [U64; 2], [c, d]: [U64; 2]) -> [U64; 2] {
            [_mm512_mask_blend_epi64(m as u8, c, a), _mm512_mask_blend_epi64((m >> 8) as u8, d, b)]
        }

        fn and_mask(a: M, b: M) -> M { a & b }
        fn or_mask(a: M, b: M) -> M { a | b }
        fn xor_mask(a: M, b: M) -> M { a ^ b }
        fn mask_of_bits(bits: u32) -> M { bits as M }
        fn bits_of_mask(m: M) -> u32 { m.into() }

        /// Columns of 4 x 4 blocks that stand in the quarters of registers; done twice, it is undone.
        fn transpose([a, b, c, d]: [F32; 4]) -> [F32; 4] {
            let (p, q) = (_mm512_unpacklo_ps(a, b), _mm512_unpacklo_ps(c, d));
            let (r, s) = (_mm512_unpackhi_ps(a, b), _mm512_unpackhi_ps(c, d));
            [
                _mm512_shuffle_ps::<0x44>(p, q), _mm512_shuffle_ps::<0xee>(p, q),
                _mm512_shuffle_ps::<0x44>(r, s), _mm512_shuffle_ps::<0xee>(r, s),
            ]
        }
        /// Every fourth row, in the quarters of a register.
        fn four(rows: &[[f32; 4]; 16], first: usize) -> F32 {
            // SAFETY: four numbers are read from arrays of four.
            let quarter = |i: usize| unsafe { _mm_loadu_ps(rows[first + i].as_ptr()) };
            let x = _mm512_castps128_ps512(quarter(0));
            let x = _mm512_insertf32x4::<1>(x, quarter(4));
            let x = _mm512_insertf32x4::<2>(x, quarter(8));
            _mm512_insertf32x4::<3>(x, quarter(12))
        }
        fn columns(rows: &[[f32; 4]; 16]) -> [[F32; 1]; 4] {
            let [a, b, c, d] = transpose([four(rows, 0), four(rows, 1), four(rows, 2), four(rows, 3)]);
            [[a], [b], [c], [d]]
        }
        fn rows([[a], [b], [c], [d]]: [[F32; 1]; 4]) -> [[f32; 4]; 16] {
            let mut rows = [[0.0; 4]; 16];
            let mut i = 0;
            while i < 4 {
                let four = transpose([a, b, c, d])[i];
                // SAFETY: four numbers are written to arrays of four.
                unsafe {
                    _mm_storeu_ps(rows[i].as_mut_ptr(), _mm512_castps512_ps128(four));
                    _mm_storeu_ps(rows[i + 4].as_mut_ptr(), _mm512_extractf32x4_ps::<1>(four));
                    _mm_storeu_ps(rows[i + 8].as_mut_ptr(), _mm512_extractf32x4_ps::<2>(four));
                    _mm_storeu_ps(rows[i + 12].as_mut_ptr(), _mm512_extractf32x4_ps::<3>(four));
                }
                i += 1;
            }
            rows
        }

        fn look_up([index]: [U32; 1], table: &[u32; 8]) -> [U32; 1] {
            // SAFETY: eight numbers are read from an array of eight.
            let table = unsafe { _mm256_loadu_si256(table.as_ptr().cast()) };
            // Twice the table: the fourth bit of an index makes no difference.
            [_mm512_permutexvar_epi32(index, _mm512_broadcast_i64x4(table))]
        }
    }

    /// The entries of a table.
    ///
    /// # Safety
    /// All indices are within the table, and below 2^31.
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    #[inline]
    pub unsafe fn gather(table: *const u32, [index]: [U32; 1]) -> [U32; 1] {
        // SAFETY: as the caller says.
        [unsafe { _mm512_i32gather_epi32::<4>(index, table.cast()) }]
    }
}
