//! NEON: eight lanes in two registers, lanes of 64 bits in four.

use super::vectors::*;
use crate::simd::{Arithmetic, Bits, Double, Float, Mask, Uint, Ulong, sealed::Sealed};

vector_types!(8 lanes, 2 registers, 4 double, features "neon");

/// Registers, and whole vectors where lanes of 32 and 64 bits meet. A mask has lanes of 32 bits, all set or none.
mod raw {
    use std::arch::aarch64::*;
    pub use std::arch::aarch64::{
        vaddq_f32 as add_f32, vaddq_f64 as add_f64, vaddq_u32 as add_u32, vaddq_u64 as add_u64,
        vandq_u32 as and_u32, vandq_u64 as and_u64, vcvtq_f32_u32 as u32_to_f32, vcvtq_u32_f32 as f32_to_u32,
        vdivq_f32 as div_f32, vdivq_f64 as div_f64, vdupq_n_f32 as splat_f32, vdupq_n_f64 as splat_f64,
        vdupq_n_u32 as splat_u32, vdupq_n_u64 as splat_u64, veorq_u32 as xor_u32, veorq_u64 as xor_u64,
        vmaxq_u32 as max_u32, vminq_u32 as min_u32, vmulq_f32 as mul_f32, vmulq_f64 as mul_f64,
        vmulq_u32 as mul_u32, vorrq_u32 as or_u32, vorrq_u64 as or_u64, vreinterpretq_f32_u32 as f32_of_bits,
        vreinterpretq_f64_u64 as f64_of_bits, vreinterpretq_u32_f32 as bits_f32,
        vreinterpretq_u64_f64 as bits_f64, vrndmq_f32 as floor_f32, vrndq_f32 as trunc_f32,
        vsqrtq_f32 as sqrt_f32, vsqrtq_f64 as sqrt_f64, vsubq_f32 as sub_f32, vsubq_f64 as sub_f64,
        vsubq_u32 as sub_u32, vsubq_u64 as sub_u64,
    };

    pub type F32 = float32x4_t;
    pub type U32 = uint32x4_t;
    pub type F64 = float64x2_t;
    pub type U64 = uint64x2_t;
    pub type M = [uint32x4_t; 2];

    /// Functions that are compiled for the set, and become part of those that call them.
    macro_rules! functions {
        ($($(#[$doc:meta])* fn $name:ident($($arg:tt: $t:ty),*) -> $out:ty $body:block)*) => {
            $(
                $(#[$doc])*
                #[target_feature(enable = "neon")]
                #[inline]
                pub fn $name($($arg: $t),*) -> $out $body
            )*
        };
    }

    functions! {
        fn mul_add_f32(x: F32, a: F32, b: F32) -> F32 { vfmaq_f32(b, x, a) }
        // The processor's own minimum and maximum treat NaN and zeros in another way.
        fn min_f32(a: F32, b: F32) -> F32 { vbslq_f32(vcltq_f32(a, b), a, b) }
        fn max_f32(a: F32, b: F32) -> F32 { vbslq_f32(vcgtq_f32(a, b), a, b) }
        fn min_f64(a: F64, b: F64) -> F64 { vbslq_f64(vcltq_f64(a, b), a, b) }
        fn max_f64(a: F64, b: F64) -> F64 { vbslq_f64(vcgtq_f64(a, b), a, b) }
        fn f32_to_i32(x: F32) -> U32 { vreinterpretq_u32_s32(vcvtq_s32_f32(x)) }
        fn i32_to_f32(x: U32) -> F32 { vcvtq_f32_s32(vreinterpretq_s32_u32(x)) }

        fn shl_u32(x: U32, by: u32) -> U32 { vshlq_u32(x, vdupq_n_s32(by as i32)) }
        fn shr_u32(x: U32, by: u32) -> U32 { vshlq_u32(x, vdupq_n_s32(-(by as i32))) }
        fn shr_signed_u32(x: U32, by: u32) -> U32 {
            vreinterpretq_u32_s32(vshlq_s32(vreinterpretq_s32_u32(x), vdupq_n_s32(-(by as i32))))
        }
        fn shl_u64(x: U64, by: u32) -> U64 { vshlq_u64(x, vdupq_n_s64(i64::from(by))) }
        fn shr_u64(x: U64, by: u32) -> U64 { vshlq_u64(x, vdupq_n_s64(-i64::from(by))) }
        fn shl_each_u32(x: U32, by: U32) -> U32 { vshlq_u32(x, vreinterpretq_s32_u32(by)) }
        fn shr_each_u32(x: U32, by: U32) -> U32 { vshlq_u32(x, vnegq_s32(vreinterpretq_s32_u32(by))) }

        /// By halves of 32 bits.
        fn mul_u64(a: U64, b: U64) -> U64 {
            let (a_low, b_low) = (vmovn_u64(a), vmovn_u64(b));
            let (a_high, b_high) = (vshrn_n_u64::<32>(a), vshrn_n_u64::<32>(b));
            let upper = vmla_u32(vmul_u32(a_low, b_high), a_high, b_low);
            vaddq_u64(vmull_u32(a_low, b_low), vshlq_n_u64::<32>(vmovl_u32(upper)))
        }
        fn reverse_bits_u32(x: U32) -> U32 {
            vreinterpretq_u32_u8(vrev32q_u8(vrbitq_u8(vreinterpretq_u8_u32(x))))
        }

        fn widen_f32([a, b]: [F32; 2]) -> [F64; 4] {
            [
                vcvt_f64_f32(vget_low_f32(a)), vcvt_high_f64_f32(a),
                vcvt_f64_f32(vget_low_f32(b)), vcvt_high_f64_f32(b),
            ]
        }
        fn narrow_f64([a, b, c, d]: [F64; 4]) -> [F32; 2] {
            [vcvt_high_f32_f64(vcvt_f32_f64(a), b), vcvt_high_f32_f64(vcvt_f32_f64(c), d)]
        }
        fn widen_u32([a, b]: [U32; 2]) -> [U64; 4] {
            [vmovl_u32(vget_low_u32(a)), vmovl_high_u32(a), vmovl_u32(vget_low_u32(b)), vmovl_high_u32(b)]
        }
        fn narrow_u64([a, b, c, d]: [U64; 4]) -> [U32; 2] {
            [vmovn_high_u64(vmovn_u64(a), b), vmovn_high_u64(vmovn_u64(c), d)]
        }
        /// A mask for lanes of 64 bits.
        fn widen_mask([a, b]: M) -> [U64; 4] {
            let (a, b) = (vreinterpretq_s32_u32(a), vreinterpretq_s32_u32(b));
            [
                vreinterpretq_u64_s64(vmovl_s32(vget_low_s32(a))), vreinterpretq_u64_s64(vmovl_high_s32(a)),
                vreinterpretq_u64_s64(vmovl_s32(vget_low_s32(b))), vreinterpretq_u64_s64(vmovl_high_s32(b)),
            ]
        }

        fn lt_f32([a, b]: [F32; 2], [c, d]: [F32; 2]) -> M { [vcltq_f32(a, c), vcltq_f32(b, d)] }
        fn le_f32([a, b]: [F32; 2], [c, d]: [F32; 2]) -> M { [vcleq_f32(a, c), vcleq_f32(b, d)] }
        fn eq_f32([a, b]: [F32; 2], [c, d]: [F32; 2]) -> M { [vceqq_f32(a, c), vceqq_f32(b, d)] }
        fn eq_u32([a, b]: [U32; 2], [c, d]: [U32; 2]) -> M { [vceqq_u32(a, c), vceqq_u32(b, d)] }
        fn lt_u32([a, b]: [U32; 2], [c, d]: [U32; 2]) -> M { [vcltq_u32(a, c), vcltq_u32(b, d)] }
        fn lt_i32([a, b]: [U32; 2], [c, d]: [U32; 2]) -> M {
            [
                vcltq_s32(vreinterpretq_s32_u32(a), vreinterpretq_s32_u32(c)),
                vcltq_s32(vreinterpretq_s32_u32(b), vreinterpretq_s32_u32(d)),
            ]
        }
        fn lt_f64(a: [F64; 4], b: [F64; 4]) -> M {
            narrow_u64([
                vcltq_f64(a[0], b[0]), vcltq_f64(a[1], b[1]), vcltq_f64(a[2], b[2]), vcltq_f64(a[3], b[3]),
            ])
        }
        fn le_f64(a: [F64; 4], b: [F64; 4]) -> M {
            narrow_u64([
                vcleq_f64(a[0], b[0]), vcleq_f64(a[1], b[1]), vcleq_f64(a[2], b[2]), vcleq_f64(a[3], b[3]),
            ])
        }
        fn eq_f64(a: [F64; 4], b: [F64; 4]) -> M {
            narrow_u64([
                vceqq_f64(a[0], b[0]), vceqq_f64(a[1], b[1]), vceqq_f64(a[2], b[2]), vceqq_f64(a[3], b[3]),
            ])
        }
        fn eq_u64(a: [U64; 4], b: [U64; 4]) -> M {
            narrow_u64([
                vceqq_u64(a[0], b[0]), vceqq_u64(a[1], b[1]), vceqq_u64(a[2], b[2]), vceqq_u64(a[3], b[3]),
            ])
        }

        fn select_f32([m, n]: M, [a, b]: [F32; 2], [c, d]: [F32; 2]) -> [F32; 2] {
            [vbslq_f32(m, a, c), vbslq_f32(n, b, d)]
        }
        fn select_u32([m, n]: M, [a, b]: [U32; 2], [c, d]: [U32; 2]) -> [U32; 2] {
            [vbslq_u32(m, a, c), vbslq_u32(n, b, d)]
        }
        fn select_f64(m: M, a: [F64; 4], b: [F64; 4]) -> [F64; 4] {
            let m = widen_mask(m);
            [
                vbslq_f64(m[0], a[0], b[0]), vbslq_f64(m[1], a[1], b[1]),
                vbslq_f64(m[2], a[2], b[2]), vbslq_f64(m[3], a[3], b[3]),
            ]
        }
        fn select_u64(m: M, a: [U64; 4], b: [U64; 4]) -> [U64; 4] {
            let m = widen_mask(m);
            [
                vbslq_u64(m[0], a[0], b[0]), vbslq_u64(m[1], a[1], b[1]),
                vbslq_u64(m[2], a[2], b[2]), vbslq_u64(m[3], a[3], b[3]),
            ]
        }

        fn and_mask([a, b]: M, [c, d]: M) -> M { [vandq_u32(a, c), vandq_u32(b, d)] }
        fn or_mask([a, b]: M, [c, d]: M) -> M { [vorrq_u32(a, c), vorrq_u32(b, d)] }
        fn xor_mask([a, b]: M, [c, d]: M) -> M { [veorq_u32(a, c), veorq_u32(b, d)] }
        fn own_bits() -> M {
            // SAFETY: four numbers are read from arrays of four.
            unsafe { [vld1q_u32([1, 2, 4, 8].as_ptr()), vld1q_u32([16, 32, 64, 128].as_ptr())] }
        }
        fn mask_of_bits(bits: u32) -> M {
            let (bits, [a, b]) = (vdupq_n_u32(bits), own_bits());
            [vtstq_u32(bits, a), vtstq_u32(bits, b)]
        }
        fn bits_of_mask([m, n]: M) -> u32 {
            let [a, b] = own_bits();
            vaddvq_u32(vorrq_u32(vandq_u32(m, a), vandq_u32(n, b)))
        }
    }

    /// The entries of a table.
    ///
    /// # Safety
    /// All indices are within the table.
    #[target_feature(enable = "neon")]
    #[inline]
    pub unsafe fn gather(table: *const u32, index: [U32; 2]) -> [U32; 2] {
        // SAFETY: two registers are as large as eight numbers, any bits of which are numbers. The entries are as the caller says.
        unsafe {
            let index = std::mem::transmute::<[U32; 2], [u32; 8]>(index);
            std::mem::transmute::<[u32; 8], [U32; 2]>(index.map(|i| *table.add(i as usize)))
        }
    }

    functions! {
        fn columns(rows: &[[f32; 4]; 8]) -> [[F32; 2]; 4] {
            // SAFETY: sixteen numbers are read from each half of an array of eight times four.
            let (a, b) = unsafe { {
                let first: *const f32 = rows.as_ptr().cast();
                (vld4q_f32(first), vld4q_f32(first.add(16)))
            } };
            [[a.0, b.0], [a.1, b.1], [a.2, b.2], [a.3, b.3]]
        }
        fn rows([a, b, c, d]: [[F32; 2]; 4]) -> [[f32; 4]; 8] {
            let mut rows = [[0.0; 4]; 8];
            let first: *mut f32 = rows.as_mut_ptr().cast();
            // SAFETY: sixteen numbers are written to each half of an array of eight times four.
            unsafe {
                vst4q_f32(first, float32x4x4_t(a[0], b[0], c[0], d[0]));
                vst4q_f32(first.add(16), float32x4x4_t(a[1], b[1], c[1], d[1]));
            }
            rows
        }

        fn look_up([a, b]: [U32; 2], table: &[u32; 8]) -> [U32; 2] {
            let low = vdupq_n_u32(7);
            // SAFETY: three bits are within a table of eight.
            unsafe { gather(table.as_ptr(), [vandq_u32(a, low), vandq_u32(b, low)]) }
        }
    }
}
