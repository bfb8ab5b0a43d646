//! Readers of triangle meshes.

pub mod ply;
mod polygon;
