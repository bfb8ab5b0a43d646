//! The description: what a scene can say, with spans, defaults, units and validation.
#![forbid(unsafe_code)]

pub mod image;
pub mod mesh;

pub use image::Image;
pub use mesh::{Mesh, Part};
