//! The description: what a scene can say, with spans, defaults, units and validation.
//!
//! Conventions: right-handed, y up, metres, degrees; colours are linear RGB. A [`desc::Scene`] is plain data, read
//! from a tree of spanned values and checked by one piece of code that collects every complaint and goes on.
#![forbid(unsafe_code)]

pub mod assets;
pub mod desc;
mod describe;
pub mod image;
pub mod limit;
pub mod mesh;
pub mod span;
pub mod value;

pub use assets::{Assets, MeshAsset, PartMaterial};
pub use desc::Scene;
pub use image::Image;
pub use mesh::{Mesh, Part};
