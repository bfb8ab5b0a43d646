//! The buffer that all numbers and pictures lie in, and the chunks of a .glb.

use serde_json::{Value as Json, json};

/// Bytes, what parts of them are views, and what views are as numbers.
#[derive(Default)]
pub(super) struct Buffer {
    pub bytes: Vec<u8>,
    pub views: Vec<Json>,
    pub accessors: Vec<Json>,
}

/// `ARRAY_BUFFER`, for what vertices have.
const VERTICES: u32 = 34962;
/// `ELEMENT_ARRAY_BUFFER`, for indices.
const INDICES: u32 = 34963;
// Types of components.
const FLOAT: u32 = 5126;
const UNSIGNED: u32 = 5125;

impl Buffer {
    /// Adds bytes, which begin at a multiple of four; gives their view.
    pub fn view(&mut self, bytes: impl IntoIterator<Item = u8>, target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let mut view = json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.views.push(view);
        self.views.len() - 1
    }

    /// Adds lists of 2 to 4 numbers each, of vertices; gives their accessor. Of positions the box around them is told.
    pub fn floats<const N: usize>(&mut self, lists: &[[f32; N]], has_bounds: bool) -> usize {
        self.numbers(lists, Some(VERTICES), has_bounds)
    }

    /// Adds numbers, or lists of them.
    pub fn numbers<const N: usize>(
        &mut self,
        lists: &[[f32; N]],
        target: Option<u32>,
        has_bounds: bool,
    ) -> usize {
        let bytes = lists.iter().flatten().flat_map(|v| v.to_le_bytes());
        let view = self.view(bytes, target);
        let kind = if N == 1 { "SCALAR".to_owned() } else { format!("VEC{N}") };
        let mut accessor = json!({
            "bufferView": view, "componentType": FLOAT, "count": lists.len(), "type": kind,
        });
        if let Some(first) = lists.first().filter(|_| has_bounds) {
            let (mut min, mut max) = (*first, *first);
            for (i, v) in lists.iter().flat_map(|list| list.iter().enumerate()) {
                if *v < min[i] {
                    min[i] = *v;
                }
                if *v > max[i] {
                    max[i] = *v;
                }
            }
            // They must be the numbers themselves, which double precision holds.
            accessor["min"] = json!(min.map(f64::from).to_vec());
            accessor["max"] = json!(max.map(f64::from).to_vec());
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Adds the corners of triangles; gives their accessor.
    pub fn triangles(&mut self, triangles: &[[u32; 3]]) -> usize {
        let view = self.view(triangles.iter().flatten().flat_map(|i| i.to_le_bytes()), Some(INDICES));
        self.accessors.push(json!({
            "bufferView": view, "componentType": UNSIGNED, "count": 3 * triangles.len(), "type": "SCALAR",
        }));
        self.accessors.len() - 1
    }
}

/// A .glb of a text and a buffer: a header of 12 bytes and a chunk for each, padded to multiples of four.
pub(super) fn packed(text: &str, buffer: &[u8]) -> Result<Vec<u8>, String> {
    let chunks = [(b"JSON", text.as_bytes(), b' '), (b"BIN\0", buffer, 0)];
    let chunks = chunks.iter().filter(|(_, bytes, _)| !bytes.is_empty());
    let length: usize = 12 + chunks.clone().map(|(_, b, _)| 8 + b.len().next_multiple_of(4)).sum::<usize>();
    let length = u32::try_from(length)
        .map_err(|_| format!("a .glb holds at most 4 GiB, and this has {length} bytes: .gltf holds more"))?;
    let mut out = [b"glTF".as_slice(), &2_u32.to_le_bytes(), &length.to_le_bytes()].concat();
    for (kind, bytes, padding) in chunks {
        // As long as all together at most, which was asked for.
        out.extend((bytes.len().next_multiple_of(4) as u32).to_le_bytes());
        out.extend(*kind);
        out.extend(*bytes);
        out.resize(out.len().next_multiple_of(4), *padding);
    }
    Ok(out)
}
