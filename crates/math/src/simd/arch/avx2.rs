//! AVX2 with FMA: eight lanes in a register, lanes of 64 bits in two.

use super::vectors::*;
use crate::simd::{Arithmetic, Bits, Double, Float, Mask, Uint, Ulong, sealed::Sealed};

vector_types!(8 lanes, 1 registers, 2 double, features "avx2,fma,bmi1,bmi2,lzcnt,popcnt");

/// Registers, and whole vectors where lanes of 32 and 64 bits meet. A mask has lanes of 32 bits, all set or none.
mod raw {
    use std::arch::x86_64::*;
    pub use std::arch::x86_64::{
        _mm256_add_epi32 as add_u32, _mm256_add_epi64 as add_u64, _mm256_add_pd as add_f64,
        _mm256_add_ps as add_f32, _mm256_and_si256 as and_u32, _mm256_and_si256 as and_u64,
        _mm256_and_si256 as and_mask, _mm256_castpd_si256 as bits_f64, _mm256_castps_si256 as bits_f32,
        _mm256_castsi256_pd as f64_of_bits, _mm256_castsi256_ps as f32_of_bits,
        _mm256_cvtepi32_ps as i32_to_f32, _mm256_div_pd as div_f64, _mm256_div_ps as div_f32,
        _mm256_floor_ps as floor_f32, _mm256_fmadd_ps as mul_add_f32, _mm256_max_epu32 as max_u32,
        _mm256_max_pd as max_f64, _mm256_max_ps as max_f32, _mm256_min_epu32 as min_u32,
        _mm256_min_pd as min_f64, _mm256_min_ps as min_f32, _mm256_mul_pd as mul_f64,
        _mm256_mul_ps as mul_f32, _mm256_mullo_epi32 as mul_u32, _mm256_or_si256 as or_u32,
        _mm256_or_si256 as or_u64, _mm256_or_si256 as or_mask, _mm256_set1_pd as splat_f64,
        _mm256_set1_ps as splat_f32, _mm256_sllv_epi32 as shl_each_u32, _mm256_sqrt_pd as sqrt_f64,
        _mm256_sqrt_ps as sqrt_f32, _mm256_srlv_epi32 as shr_each_u32, _mm256_sub_epi32 as sub_u32,
        _mm256_sub_epi64 as sub_u64, _mm256_sub_pd as sub_f64, _mm256_sub_ps as sub_f32,
        _mm256_xor_si256 as xor_u32, _mm256_xor_si256 as xor_u64, _mm256_xor_si256 as xor_mask,
    };

    pub type F32 = __m256;
    pub type U32 = __m256i;
    pub type F64 = __m256d;
    pub type U64 = __m256i;
    pub type M = __m256i;

    /// Functions that are compiled for the set, and become part of those that call them.
    macro_rules! functions {
        ($($(#[$doc:meta])* fn $name:ident($($arg:tt: $t:ty),*) -> $out:ty $body:block)*) => {
            $(
                $(#[$doc])*
                #[target_feature(enable = "avx2,fma")]
                #[inline]
                pub fn $name($($arg: $t),*) -> $out $body
            )*
        };
    }

    functions! {
        fn splat_u32(x: u32) -> U32 { _mm256_set1_epi32(x as i32) }
        fn splat_u64(x: u64) -> U64 { _mm256_set1_epi64x(x as i64) }
        fn trunc_f32(x: F32) -> F32 { _mm256_round_ps::<{ _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC }>(x) }

        fn shl_u32(x: U32, by: u32) -> U32 { _mm256_sll_epi32(x, _mm_cvtsi32_si128(by as i32)) }
        fn shr_u32(x: U32, by: u32) -> U32 { _mm256_srl_epi32(x, _mm_cvtsi32_si128(by as i32)) }
        fn shr_signed_u32(x: U32, by: u32) -> U32 { _mm256_sra_epi32(x, _mm_cvtsi32_si128(by as i32)) }
        fn shl_u64(x: U64, by: u32) -> U64 { _mm256_sll_epi64(x, _mm_cvtsi32_si128(by as i32)) }
        fn shr_u64(x: U64, by: u32) -> U64 { _mm256_srl_epi64(x, _mm_cvtsi32_si128(by as i32)) }

        /// By halves of 32 bits.
        fn mul_u64(a: U64, b: U64) -> U64 {
            let crossed = _mm256_mullo_epi32(a, _mm256_shuffle_epi32::<0xb1>(b));
            let upper = _mm256_add_epi32(crossed, _mm256_srli_epi64::<32>(crossed));
            _mm256_add_epi64(_mm256_mul_epu32(a, b), _mm256_slli_epi64::<32>(upper))
        }

        /// Each half byte reversed by a table, then the bytes.
        fn reverse_bits_u32(x: U32) -> U32 {
            let table = _mm256_setr_epi8(
                0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15,
                0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15,
            );
            let bytes = _mm256_setr_epi8(
                3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12,
                3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12,
            );
            let lower = _mm256_set1_epi8(15);
            let x = _mm256_shuffle_epi8(x, bytes);
            let low = _mm256_shuffle_epi8(table, _mm256_and_si256(x, lower));
            let high = _mm256_shuffle_epi8(table, _mm256_and_si256(_mm256_srli_epi32::<4>(x), lower));
            _mm256_or_si256(_mm256_slli_epi32::<4>(low), high)
        }

        fn f32_to_u32(x: F32) -> U32 {
            // What is below 0 or NaN becomes 0; the processor knows signed numbers only, so that 2^31 is taken off what has it.
            let x = _mm256_max_ps(x, _mm256_setzero_ps());
            let half = _mm256_set1_ps(2_147_483_648.0);
            let large = _mm256_cmp_ps::<_CMP_GE_OQ>(x, half);
            let rest = _mm256_cvttps_epi32(_mm256_sub_ps(x, _mm256_and_ps(large, half)));
            let top = _mm256_slli_epi32::<31>(_mm256_castps_si256(large));
            let beyond = _mm256_cmp_ps::<_CMP_GE_OQ>(x, _mm256_set1_ps(4_294_967_296.0));
            _mm256_or_si256(_mm256_xor_si256(rest, top), _mm256_castps_si256(beyond))
        }
        fn f32_to_i32(x: F32) -> U32 {
            // What is beyond gives i32::MIN, the right end for negative numbers.
            let beyond = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GE_OQ>(x, _mm256_set1_ps(2_147_483_648.0)));
            let number = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_ORD_Q>(x, x));
            _mm256_and_si256(_mm256_xor_si256(_mm256_cvttps_epi32(x), beyond), number)
        }
        fn u32_to_f32(x: U32) -> F32 {
            // Both halves and the product are exact, so that the sum is the only rounding.
            let high = _mm256_cvtepi32_ps(_mm256_srli_epi32::<16>(x));
            let low = _mm256_cvtepi32_ps(_mm256_and_si256(x, _mm256_set1_epi32(0xffff)));
            _mm256_add_ps(_mm256_mul_ps(high, _mm256_set1_ps(65536.0)), low)
        }

        fn widen_f32([x]: [F32; 1]) -> [F64; 2] {
            [_mm256_cvtps_pd(_mm256_castps256_ps128(x)), _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(x))]
        }
        fn narrow_f64([a, b]: [F64; 2]) -> [F32; 1] {
            [_mm256_set_m128(_mm256_cvtpd_ps(b), _mm256_cvtpd_ps(a))]
        }
        fn widen_u32([x]: [U32; 1]) -> [U64; 2] {
            [
                _mm256_cvtepu32_epi64(_mm256_castsi256_si128(x)),
                _mm256_cvtepu32_epi64(_mm256_extracti128_si256::<1>(x)),
            ]
        }
        fn narrow_u64([a, b]: [U64; 2]) -> [U32; 1] {
            let low = _mm256_shuffle_ps::<0x88>(_mm256_castsi256_ps(a), _mm256_castsi256_ps(b));
            [_mm256_permute4x64_epi64::<0xd8>(_mm256_castps_si256(low))]
        }
        fn narrow_mask([a, b]: [F64; 2]) -> M {
            let [m] = narrow_u64([_mm256_castpd_si256(a), _mm256_castpd_si256(b)]);
            m
        }
        fn widen_mask(m: M) -> [F64; 2] {
            [
                _mm256_castsi256_pd(_mm256_cvtepi32_epi64(_mm256_castsi256_si128(m))),
                _mm256_castsi256_pd(_mm256_cvtepi32_epi64(_mm256_extracti128_si256::<1>(m))),
            ]
        }

        fn lt_f32([a]: [F32; 1], [b]: [F32; 1]) -> M { _mm256_castps_si256(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b)) }
        fn le_f32([a]: [F32; 1], [b]: [F32; 1]) -> M { _mm256_castps_si256(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) }
        fn eq_f32([a]: [F32; 1], [b]: [F32; 1]) -> M { _mm256_castps_si256(_mm256_cmp_ps::<_CMP_EQ_OQ>(a, b)) }
        fn lt_f64([a, b]: [F64; 2], [c, d]: [F64; 2]) -> M {
            narrow_mask([_mm256_cmp_pd::<_CMP_LT_OQ>(a, c), _mm256_cmp_pd::<_CMP_LT_OQ>(b, d)])
        }
        fn le_f64([a, b]: [F64; 2], [c, d]: [F64; 2]) -> M {
            narrow_mask([_mm256_cmp_pd::<_CMP_LE_OQ>(a, c), _mm256_cmp_pd::<_CMP_LE_OQ>(b, d)])
        }
        fn eq_f64([a, b]: [F64; 2], [c, d]: [F64; 2]) -> M {
            narrow_mask([_mm256_cmp_pd::<_CMP_EQ_OQ>(a, c), _mm256_cmp_pd::<_CMP_EQ_OQ>(b, d)])
        }
        fn eq_u64([a, b]: [U64; 2], [c, d]: [U64; 2]) -> M {
            let [m] = narrow_u64([_mm256_cmpeq_epi64(a, c), _mm256_cmpeq_epi64(b, d)]);
            m
        }
        fn eq_u32([a]: [U32; 1], [b]: [U32; 1]) -> M { _mm256_cmpeq_epi32(a, b) }
        fn lt_i32([a]: [U32; 1], [b]: [U32; 1]) -> M { _mm256_cmpgt_epi32(b, a) }
        fn lt_u32([a]: [U32; 1], [b]: [U32; 1]) -> M {
            let sign = _mm256_set1_epi32(i32::MIN);
            _mm256_cmpgt_epi32(_mm256_xor_si256(b, sign), _mm256_xor_si256(a, sign))
        }

        fn select_f32(m: M, [a]: [F32; 1], [b]: [F32; 1]) -> [F32; 1] {
            [_mm256_blendv_ps(b, a, _mm256_castsi256_ps(m))]
        }
        fn select_u32(m: M, [a]: [U32; 1], [b]: [U32; 1]) -> [U32; 1] { [_mm256_blendv_epi8(b, a, m)] }
        fn select_f64(m: M, [a, b]: [F64; 2], [c, d]: [F64; 2]) -> [F64; 2] {
            let [m, n] = widen_mask(m);
            [_mm256_blendv_pd(c, a, m), _mm256_blendv_pd(d, b, n)]
        }
        fn select_u64(m: M, [a, b]: [U64; 2], [c, d]: [U64; 2]) -> [U64; 2] {
            let [m, n] = widen_mask(m);
            let (m, n) = (_mm256_castpd_si256(m), _mm256_castpd_si256(n));
            [_mm256_blendv_epi8(c, a, m), _mm256_blendv_epi8(d, b, n)]
        }

        fn mask_of_bits(bits: u32) -> M {
            let own = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(bits as i32), own), own)
        }
        fn bits_of_mask(m: M) -> u32 { _mm256_movemask_ps(_mm256_castsi256_ps(m)) as u32 }

        /// Columns of 4 x 4 blocks that stand in the quarters of registers; done twice, it is undone.
        fn transpose([a, b, c, d]: [F32; 4]) -> [F32; 4] {
            let (p, q) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
            let (r, s) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
            [
                _mm256_shuffle_ps::<0x44>(p, q), _mm256_shuffle_ps::<0xee>(p, q),
                _mm256_shuffle_ps::<0x44>(r, s), _mm256_shuffle_ps::<0xee>(r, s),
            ]
        }
        fn two(low: &[f32; 4], high: &[f32; 4]) -> F32 {
            // SAFETY: four numbers are read from arrays of four.
            unsafe { _mm256_loadu2_m128(high.as_ptr(), low.as_ptr()) }
        }
        fn columns(r: &[[f32; 4]; 8]) -> [[F32; 1]; 4] {
            let [a, b, c, d] =
                transpose([two(&r[0], &r[4]), two(&r[1], &r[5]), two(&r[2], &r[6]), two(&r[3], &r[7])]);
            [[a], [b], [c], [d]]
        }
        fn rows([[a], [b], [c], [d]]: [[F32; 1]; 4]) -> [[f32; 4]; 8] {
            let mut rows = [[0.0; 4]; 8];
            let mut i = 0;
            while i < 4 {
                let two = transpose([a, b, c, d])[i];
                // SAFETY: four numbers are written to arrays of four.
                unsafe {
                    _mm_storeu_ps(rows[i].as_mut_ptr(), _mm256_castps256_ps128(two));
                    _mm_storeu_ps(rows[i + 4].as_mut_ptr(), _mm256_extractf128_ps::<1>(two));
                }
                i += 1;
            }
            rows
        }

        fn look_up([index]: [U32; 1], table: &[u32; 8]) -> [U32; 1] {
            // SAFETY: eight numbers are read from an array of eight.
            let table = unsafe { _mm256_loadu_si256(table.as_ptr().cast()) };
            [_mm256_permutevar8x32_epi32(table, index)]
        }
    }

    /// The entries of a table.
    ///
    /// # Safety
    /// All indices are within the table, and below 2^31.
    #[target_feature(enable = "avx2,fma")]
    #[inline]
    pub unsafe fn gather(table: *const u32, [index]: [U32; 1]) -> [U32; 1] {
        // SAFETY: as the caller says.
        [unsafe { _mm256_i32gather_epi32::<4>(table.cast(), index) }]
    }
}
