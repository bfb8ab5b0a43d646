//! Meshes as primitives: triangles of indices, and what vertices have.

use std::ops::Range;
use std::sync::Arc;

use serde_json::{Map, Value as Json, json};
use straal_color::srgb;
use straal_math::DVec3;
use straal_scene::Mesh;
use straal_scene::mesh::{Attribute, Per};

use super::Out;

/// What one primitive is written from: the mesh's place in memory, which triangles, and how.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    mesh: usize,
    triangles: (usize, usize),
    form: Form,
}

/// How a mesh is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Form {
    pub normals: Normals,
    /// Whether front and back are swapped.
    pub flip: bool,
    /// Whether the colours of vertices are seen.
    pub is_painted: bool,
}

/// Which normals a mesh is written with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Normals {
    /// None: glTF has such faces flat.
    None,
    /// Its own, if it has any.
    Own,
    /// Its own, or the mean of the faces around.
    Smooth,
    /// The mean of the faces around.
    Mean,
}

/// So many sets of texture coordinates are written.
const SETS: usize = 8;

impl Out<'_> {
    /// A primitive without its material; none where there is nothing to see.
    pub fn primitive(&mut self, mesh: &Arc<Mesh>, range: &Range<usize>, form: Form) -> Option<Json> {
        let place = Arc::as_ptr(mesh) as usize;
        let key = Key { mesh: place, triangles: (range.start, range.end), form };
        if let Some(known) = self.primitives.get(&key) {
            return Some(known.clone());
        }
        let attributes = self.attributes(mesh, form)?;
        let is_finite = |i: &u32| mesh.positions[*i as usize].iter().all(|v| v.is_finite());
        let triangles = mesh.triangles.get(range.clone()).unwrap_or_default();
        let mut seen: Vec<[u32; 3]> = triangles.iter().filter(|t| t.iter().all(is_finite)).copied().collect();
        if seen.is_empty() {
            return None;
        }
        if form.flip {
            seen.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let indices = self.buffer.triangles(&seen);
        let primitive = json!({ "attributes": attributes, "indices": indices, "mode": 4 });
        self.primitives.insert(key, primitive.clone());
        Some(primitive)
    }

    /// What vertices have, which all parts of a mesh share.
    fn attributes(&mut self, mesh: &Arc<Mesh>, form: Form) -> Option<Json> {
        let whole = Key { mesh: Arc::as_ptr(mesh) as usize, triangles: (usize::MAX, 0), form };
        if let Some(known) = self.primitives.get(&whole) {
            return Some(known.clone());
        }
        if mesh.positions.is_empty() || !mesh.is_whole() {
            return None;
        }
        let mut out = Map::new();
        // What isn't finite belongs to no triangle that is written.
        let finite = |v: f32| if v.is_finite() { v } else { 0.0 };
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.map(finite)).collect();
        out.insert("POSITION".to_owned(), json!(self.buffer.floats(&positions, true)));
        let normals = match form.normals {
            Normals::None => Vec::new(),
            Normals::Own => mesh.normals.clone(),
            Normals::Smooth if !mesh.normals.is_empty() => mesh.normals.clone(),
            Normals::Smooth | Normals::Mean => means(mesh),
        };
        if !normals.is_empty() {
            let sign = if form.flip { -1.0 } else { 1.0 };
            let normals: Vec<[f32; 3]> = normals.into_iter().map(|n| unit(n).map(|v| v * sign)).collect();
            out.insert("NORMAL".to_owned(), json!(self.buffer.floats(&normals, false)));
        }
        // The side across them stays where it is: normals that are turned round turn it as well.
        if form.normals == Normals::Own
            && mesh.normals.len() == mesh.tangents.len()
            && !mesh.tangents.is_empty()
        {
            let sign = if form.flip { -1.0 } else { 1.0 };
            let tangents: Vec<[f32; 4]> = mesh
                .tangents
                .iter()
                .map(|[x, y, z, w]| {
                    let [x, y, z] = unit([*x, *y, *z]);
                    [x, y, z, if *w < 0.0 { -sign } else { sign }]
                })
                .collect();
            out.insert("TANGENT".to_owned(), json!(self.buffer.floats(&tangents, false)));
        }
        for (set, coordinates) in sets(mesh).into_iter().enumerate() {
            // The first row of a picture is at v = 1 here, and at v = 0 in glTF.
            let turned: Vec<[f32; 2]> =
                coordinates.into_iter().map(|[u, v]| [finite(u), finite(1.0 - v)]).collect();
            out.insert(format!("TEXCOORD_{set}"), json!(self.buffer.floats(&turned, false)));
        }
        if let Some(color) = mesh.attributes.iter().find(|a| a.name == "color").filter(|_| form.is_painted) {
            match (color.per, color.channels) {
                (Per::Face, _) => self.tell("colours of faces are left out: glTF has those of vertices"),
                (_, 3) => {
                    let colours = light::<3>(color);
                    out.insert("COLOR_0".to_owned(), json!(self.buffer.floats(&colours, false)));
                }
                (_, 4) => {
                    let colours = light::<4>(color);
                    out.insert("COLOR_0".to_owned(), json!(self.buffer.floats(&colours, false)));
                }
                _ => self.tell("colours of vertices that aren't of three or four numbers are left out"),
            }
        }
        let out = Json::Object(out);
        self.primitives.insert(whole, out.clone());
        Some(out)
    }
}

/// The sets of texture coordinates: its own, and those called `uv1` and so on, without gaps.
fn sets(mesh: &Mesh) -> Vec<Vec<[f32; 2]>> {
    let own = || {
        if mesh.uvs.is_empty() { vec![[0.0; 2]; mesh.positions.len()] } else { mesh.uvs.clone() }
    };
    let named = |set: usize| {
        let name = format!("uv{set}");
        let is_it = |a: &&Attribute| {
            a.name == name
                && a.per == Per::Vertex
                && a.channels == 2
                && a.values.len() == 2 * mesh.positions.len()
        };
        let found = mesh.attributes.iter().find(is_it)?;
        Some(found.values.as_chunks::<2>().0.to_vec())
    };
    let others: Vec<_> = (1..SETS).map(named).collect();
    let last = others.iter().rposition(Option::is_some).map_or(0, |i| i + 1);
    if last == 0 && mesh.uvs.is_empty() {
        return Vec::new();
    }
    let others = others.into_iter().take(last).map(|set| set.unwrap_or_else(own));
    std::iter::once(own()).chain(others).collect()
}

/// Colours as light; codes are those of sRGB.
fn light<const N: usize>(color: &Attribute) -> Vec<[f32; N]> {
    let mut lists = color.values.as_chunks::<N>().0.to_vec();
    let within = |v: f32| if v > 0.0 { if v < 1.0 { v } else { 1.0 } } else { 0.0 };
    for list in &mut lists {
        for (i, v) in list.iter_mut().enumerate() {
            *v = within(if color.is_code && i < 3 { srgb::decode(*v) } else { *v });
        }
    }
    lists
}

/// A normal of length 1, as it was if it is one already; upwards where there is none.
fn unit(n: [f32; 3]) -> [f32; 3] {
    let n64 = DVec3::from_array(n.map(f64::from));
    if (n64.length() - 1.0).abs() < 1e-4 {
        return n;
    }
    n64.try_normalize().unwrap_or(DVec3::Y).to_array().map(|v| v as f32)
}

/// Normals at vertices, the mean of the faces around by their area.
fn means(mesh: &Mesh) -> Vec<[f32; 3]> {
    let place = |i: u32| DVec3::from_array(mesh.positions[i as usize].map(f64::from));
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for t in &mesh.triangles {
        let [a, b, c] = t.map(place);
        let n = (b - a).cross(c - a);
        if n.length().is_finite() {
            t.iter().for_each(|&i| sums[i as usize] += n);
        }
    }
    sums.into_iter().map(|n| n.try_normalize().unwrap_or(DVec3::Y).to_array().map(|v| v as f32)).collect()
}
