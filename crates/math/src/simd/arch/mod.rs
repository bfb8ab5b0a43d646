//! Vectors of an instruction set, and how a kernel is entered. The only unsafe code of this crate.
//!
//! Why it holds: an instruction of a set may run only where the processor has the set. The vector types of a set are in private
//! modules, so that nobody outside can name them. The one way to them is [`run`], which takes a [`Simd`], and a [`Simd`] is made
//! only after the processor was asked; there a kernel is handed the family as a type parameter, which can't leave it but in code that was
//! reached by it. So wherever a vector's operations run, the processor has them. What else is unsafe are casts
//! between a register and an array of the same size, any bits of which are numbers, and gathers, whose indices are clamped.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "aarch64")]
mod neon;
mod vectors;

use super::{Isa, Kernel, Simd};

/// Runs a kernel compiled for the instruction set.
#[inline(always)]
pub(super) fn run<K: Kernel>(simd: Simd, kernel: K) -> K::Output {
    match simd.isa() {
        // SAFETY: a `Simd` is the proof that the processor has the set.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => unsafe { avx2::enter(kernel) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 => unsafe { avx512::enter(kernel) },
        // SAFETY: as above.
        #[cfg(target_arch = "aarch64")]
        Isa::Neon => unsafe { neon::enter(kernel) },
        _ => kernel.run::<f32>(),
    }
}
