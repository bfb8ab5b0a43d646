//! Primitives packed by Draco (`KHR_draco_mesh_compression`), which the crate `draco-core` unpacks.

use std::collections::BTreeMap;

use draco_core::{DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};

use super::accessor::Numbers;
use super::document::{Document, Fault, Result, flag, required, size};
use super::json::Json;
use crate::Limits;

/// A packed mesh takes at most so many bytes for each of its own, and what a small one may take at any rate. (Draco may tell millions of the same
/// number in a few bytes; no real mesh is like that.)
const MOST_TIMES: u64 = 2048;
const SMALL: u64 = 1 << 26;

/// The attributes of a packed primitive by name, and the vertices of its triangles. What its numbers mean, the accessors in `attributes` tell.
pub(super) fn read(
    document: &mut Document<'_>,
    attributes: &Json,
    draco: &Json,
    limits: &Limits,
) -> Result<(BTreeMap<String, Numbers>, Vec<u32>)> {
    let view = document.view(required(draco, "bufferView")?)?;
    let bytes = view.bytes();
    let most = MOST_TIMES.saturating_mul(bytes.len() as u64);
    let mut ceilings = DecodeLimits::default();
    ceilings.max_points = limits.max_vertices;
    ceilings.max_faces = limits.max_triangles;
    ceilings.max_decoded_bytes = if most > SMALL { most } else { SMALL };
    let mut mesh = Mesh::new();
    MeshDecoder::new()
        .decode(&mut DecoderBuffer::new(bytes).with_limits(ceilings), &mut mesh)
        .map_err(|e| Fault::of(draco, format!("the mesh can't be unpacked: {e}")))?;
    let points = mesh.num_points();
    let mut columns = BTreeMap::new();
    for (name, id) in required(draco, "attributes")?.entries() {
        let packed = u32::try_from(size(id)?).ok().and_then(|unique| mesh.attribute_by_unique_id(unique));
        let packed =
            packed.ok_or_else(|| Fault::of(id, "the packed mesh has no attribute of that number"))?;
        let channels = usize::from(packed.num_components());
        document.spend(id, (points as u64).saturating_mul(channels as u64))?;
        let mut values = packed.read_f32s(points, channels);
        if let Some(at) = attributes.get(name) {
            let (_, accessor) = document.item("accessors", at)?;
            if flag(accessor, "normalized")? {
                let most = match size(required(accessor, "componentType")?)? {
                    5120 => 127.0,
                    5121 => 255.0,
                    5122 => 32_767.0,
                    5123 => 65_535.0,
                    _ => 1.0,
                };
                values.iter_mut().for_each(|v| *v = if *v / most < -1.0 { -1.0 } else { *v / most });
            }
        }
        columns.insert(name.to_string(), Numbers { channels, values });
    }
    let order = mesh.faces().iter().flatten().map(|corner| corner.0).collect();
    Ok((columns, order))
}
