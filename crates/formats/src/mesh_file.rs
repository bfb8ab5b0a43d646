//! A mesh file of any kind that straal reads, with the materials that came with it.

use std::path::Path;
use std::sync::Arc;

use straal_scene::MeshAsset;

use crate::{Limits, ReadError, mesh};

/// Reads the bytes of a mesh file; `path` tells its kind and where files it names are. Gives warnings as well.
pub fn read(path: &Path, bytes: &[u8], limits: &Limits) -> Result<(MeshAsset, Vec<String>), ReadError> {
    if bytes.starts_with(b"ply") {
        let mesh = Arc::new(mesh::ply::read(bytes, limits)?);
        return Ok((MeshAsset { mesh, ..MeshAsset::default() }, Vec::new()));
    }
    let name = path.display();
    Err(ReadError::file(format!("`{name}` is not a mesh that straal knows: PLY and OBJ are")))
}
