//! The integration tests of this crate, in one program: linking is what costs when there are many.

mod bare_mesh;
mod bitmaps;
mod colours;
mod common;
mod complaints;
mod files;
mod gltf;
mod images;
mod obj;
mod ply;
mod scenes;
mod schema;
mod strips;
mod usd;
mod windows;
