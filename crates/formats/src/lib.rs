//! Readers and writers: scene files, meshes and images.
//!
//! A reader takes the bytes of a file and gives back plain data or a [`ReadError`] that a person can act on; it
//! never panics, and never allocates for data that a file only promises: no more than its bytes could hold, as
//! they are encoded, and no more than the [`Limits`].
#![forbid(unsafe_code)]

pub mod atomic;
pub mod files;
mod foreign;
pub mod image;
pub mod limits;
pub mod load;
pub mod mesh;
pub mod mesh_file;
mod number;
pub mod photometry;
pub mod read_error;
pub mod scene;
pub mod spd;
pub mod studio;
mod temporary;
pub mod yaml;

pub use limits::Limits;
pub use load::{Loaded, Options, load, load_bytes, load_foreign_bytes, load_str};
pub use read_error::{Place, ReadError};
pub use straal_scene::Diagnostics;
