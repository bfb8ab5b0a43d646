//! Vectors, rays, bounds, transforms, frames, warps, low-discrepancy sequences and exact float helpers.
//!
//! Everything here gives the same bits on every machine: only IEEE 754 additions, subtractions,
//! multiplications, divisions and square roots, in a fixed order and fused only where [`ops::mul_add`] says so. Functions beyond
//! those are written out in [`ops`]. What shading calls is written once for one number or for many side by side, see [`simd`].
#![deny(unsafe_code)] // but for `simd::arch`, which says why it holds
#![allow(clippy::disallowed_methods)] // this crate is what the others are sent to

pub mod affine;
pub mod bounds;
pub mod frame;
pub mod lowdisc;
pub mod motion;
pub mod ops;
pub mod ray;
pub mod simd;
pub mod table;
pub mod vec3;
pub mod warp;

pub use affine::{Affine, Transform};
pub use bounds::Bounds;
pub use frame::Frame;
pub use motion::Motion;
pub use ray::Ray;
pub use vec3::{DVec3, Vec3};
