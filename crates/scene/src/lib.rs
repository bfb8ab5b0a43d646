//! The description: what a scene can say, with spans, defaults, units and validation.
//!
//! Conventions: right-handed, y up, metres, degrees; colours are linear RGB. A [`desc::Scene`] is plain data, read
//! from a tree of spanned values and checked by one piece of code that collects every complaint and goes on.
#![forbid(unsafe_code)]

mod alias;
pub mod assets;
pub mod bitmap;
pub mod count;
mod css;
pub mod decode;
mod decode_values;
pub mod desc;
mod describe;
pub mod diagnostic;
mod document;
pub mod frames;
pub mod glow;
pub mod handle;
pub mod image;
pub mod limit;
pub mod link;
pub mod materials;
pub mod memory;
pub mod mesh;
pub mod photometry;
mod remedy;
pub mod schema;
pub mod span;
pub mod suggest;
mod textures;
pub mod tree;
pub mod validate;
pub mod value;
pub mod visit;
pub mod whole;
pub mod writer;

pub use assets::{Assets, MeshAsset, PartMaterial};
pub use bitmap::Bitmap;
pub use desc::Scene;
pub use diagnostic::{Diagnostic, Diagnostics, Severity};
pub use document::{is_of_a_scene, read_scene, schema};
pub use handle::Handle;
pub use image::Image;
pub use mesh::{Mesh, Part};
pub use photometry::Photometry;
pub use span::{FileId, Sources, Span, Spanned};
