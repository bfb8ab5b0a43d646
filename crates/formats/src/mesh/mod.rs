//! Readers of triangle meshes.

mod lines;
pub mod mtl;
pub mod obj;
pub mod ply;
mod polygon;
