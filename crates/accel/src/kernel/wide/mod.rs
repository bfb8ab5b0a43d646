//! The vectors of `lanes.rs`, for each instruction set.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "aarch64")]
mod neon;
mod one;
#[cfg(target_arch = "x86_64")]
mod sse;

#[cfg(test)]
mod tests;
