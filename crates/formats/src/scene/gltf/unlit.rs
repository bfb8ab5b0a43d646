//! Unlit surfaces that are coloured at their vertices: what they show becomes a picture, by which surfaces can shine.
//!
//! A triangle has four pixels of it, a square: three have the colours of its corners, and the fourth what goes on beyond them evenly. So what is read between
//! their middles, between four pixels at a time, is what there is between the corners.

use std::sync::Arc;

use straal_scene::bitmap::{Number, Response, TexelFormat, Texels};
use straal_scene::desc::Mapping;
use straal_scene::desc::{
    ImageTexture, Spectrum, Texture, TextureChannel, TextureFilter, TextureOf, TextureSpace, UvMapping,
    Varying, Wrap, Wraps,
};
use straal_scene::mesh::{Attribute, Per};
use straal_scene::value::LinearRgb;
use straal_scene::{Bitmap, Mesh, MeshAsset};

use super::document::{Fault, Result};
use super::json::Json;
use super::world::Known;
use super::{Translation, Within};

const FORMAT: TexelFormat = TexelFormat { number: Number::Single, channels: 4 };

impl<'a> Translation<'a, '_> {
    /// Whether a material is shown as it is, and has no picture of its own: only then may colours of vertices become one.
    pub fn shows_vertices(&self, material: Option<&'a Json>) -> Result<bool> {
        let Some(at) = material else { return Ok(false) };
        let (_, said) = self.document.item("materials", at)?;
        let is_bare =
            said.get("pbrMetallicRoughness").is_none_or(|pbr| pbr.get("baseColorTexture").is_none());
        Ok(is_bare && said.extension("KHR_materials_unlit").is_some())
    }

    /// Whether a material is shown as it is.
    pub fn is_unlit(&self, material: Option<&'a Json>) -> Result<bool> {
        let Some(at) = material else { return Ok(false) };
        Ok(self.document.item("materials", at)?.1.extension("KHR_materials_unlit").is_some())
    }

    /// A mesh with coordinates in a picture of its vertices' colours, and that picture.
    pub(super) fn painted(&mut self, at: &Json, known: &Known) -> Result<(Known, Varying<Spectrum>)> {
        let mesh = self.made.assets.mesh(known.asset.handle).mesh.clone();
        let bytes = mesh.triangles.len() as u64 * (4 * 16 + 3 * 32);
        if let Some(shortage) = self.means.ledger.refuse(
            self.kept + bytes,
            || "the colours of vertices as a picture".to_owned(),
            "meshes of fewer triangles take less",
        ) {
            self.means.d.lacks_memory = true;
            return Err(Fault::of(at, shortage.to_string()));
        }
        self.kept += bytes;
        let Some((mesh, texels)) = unfolded(&mesh) else {
            return Err(Fault::of(at, "too many triangles for a picture of their vertices' colours"));
        };
        let number = self.meshes;
        self.meshes += 1;
        let bitmap = Bitmap { texels, response: Response::Linear, space: None, has_alpha: false };
        let file = self.made.bitmap(format!("{}#colours {number}", self.name), Arc::new(bitmap));
        let mesh = MeshAsset { mesh: mesh.into(), ..MeshAsset::default() };
        let asset = self.made.mesh(format!("{}#coloured mesh {number}", self.name), mesh);
        let picture = Texture::Image(ImageTexture {
            file,
            color_space: TextureSpace::Linear,
            channel: TextureChannel::Luminance,
            filter: TextureFilter::Bilinear,
            anisotropy: 16.0,
            wrap: Wraps([Wrap::Clamp, Wrap::Clamp]),
            mapping: Mapping::Uv(UvMapping::default()),
        });
        let mut known = Known { asset, ..known.clone() };
        known.has.painted = true;
        Ok((known, Varying::Texture(Box::new(TextureOf::Inline(picture)))))
    }
}

/// The colour of all vertices, where it is the same.
pub(super) fn even(mesh: &Mesh) -> Option<Spectrum> {
    let colours = mesh.attributes.iter().find(|a| a.name == "color" && a.channels >= 3)?;
    let mut all = colours.values.chunks_exact(colours.channels).filter_map(|v| v.first_chunk::<3>());
    let first = all.next()?;
    all.all(|other| other == first).then(|| {
        let share = |v: f32| f64::from(v).within(0.0, 1.0);
        Spectrum::Rgb(LinearRgb(first.map(share)))
    })
}

/// The mesh with three vertices for each triangle, which have their places in a picture for texture coordinates, and that picture.
fn unfolded(mesh: &Mesh) -> Option<(Mesh, Texels)> {
    let colours = mesh.attributes.iter().find(|a| a.name == "color" && a.channels >= 3)?;
    let count = mesh.triangles.len();
    let across = (1..).find(|n| n * n >= count)?;
    let (width, height) = (2 * across, 2 * count.div_ceil(across));
    let mut texels = Texels::new(width, height, FORMAT)?;
    let corners: Vec<usize> = mesh.triangles.as_flattened().iter().map(|i| *i as usize).collect();
    let mut uvs = Vec::with_capacity(corners.len());
    for (t, corner) in corners.chunks_exact(3).enumerate() {
        let of = |i: usize| colours.values.get(i * colours.channels..).and_then(|v| v.first_chunk::<3>());
        let [a, b, c] = [0, 1, 2].map(|k| of(corner[k]).copied().unwrap_or([1.0; 3]));
        let beyond = [0, 1, 2].map(|k| b[k] + c[k] - a[k]);
        let (x, y) = (2 * (t % across), 2 * (t / across));
        for (dx, dy, [r, g, b]) in [(0, 0, a), (1, 0, b), (0, 1, c), (1, 1, beyond)] {
            texels.put_numbers(x + dx, y + dy, [r, g, b, 1.0]);
        }
        let place = |dx: usize, dy: usize| {
            let u = ((x + dx) as f64 + 0.5) / width as f64;
            let v = 1.0 - ((y + dy) as f64 + 0.5) / height as f64;
            [u as f32, v as f32]
        };
        uvs.extend([place(0, 0), place(1, 0), place(0, 1)]);
    }
    let attributes = mesh.attributes.iter().map(|a| match a.per {
        Per::Face => a.clone(),
        Per::Vertex => {
            let values = corners.iter().flat_map(|i| a.values.get(i * a.channels..(i + 1) * a.channels));
            Attribute { values: values.flatten().copied().collect(), ..a.clone() }
        }
    });
    let unfolded = Mesh {
        positions: corners.iter().map(|i| mesh.positions[*i]).collect(),
        normals: corners.iter().filter_map(|i| mesh.normals.get(*i).copied()).collect(),
        tangents: corners.iter().filter_map(|i| mesh.tangents.get(*i).copied()).collect(),
        uvs,
        triangles: (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        attributes: attributes.collect(),
        sides: mesh.sides.clone(),
        parts: mesh.parts.clone(),
    };
    Some((unfolded, texels))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_that_are_all_the_same_are_one() {
        let with = |values: Vec<f32>| Mesh {
            attributes: vec![Attribute {
                name: "color".to_owned(),
                per: Per::Vertex,
                channels: 4,
                is_code: false,
                values,
            }],
            ..Mesh::default()
        };
        let same = vec![0.5, 1.0, 2.0, 1.0, 0.5, 1.0, 2.0, 0.25];
        assert_eq!(even(&with(same)), Some(Spectrum::Rgb(LinearRgb([0.5, 1.0, 1.0]))));
        assert_eq!(even(&with(vec![0.5, 1.0, 2.0, 1.0, 0.25, 1.0, 2.0, 1.0])), None);
    }

    #[test]
    fn a_picture_has_what_lies_between_the_corners() {
        let values = vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.5, 0.5];
        let colours =
            Attribute { name: "color".to_owned(), per: Per::Vertex, channels: 3, is_code: false, values };
        let mesh = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            attributes: vec![colours],
            ..Mesh::default()
        };
        let (out, texels) = unfolded(&mesh).unwrap();
        assert!(out.is_whole());
        assert_eq!((texels.width(), texels.height()), (4, 2));
        for (t, triangle) in out.triangles.iter().enumerate() {
            // A place within the triangle, and what a bilinear filter finds there.
            let (b1, b2) = (0.3, 0.5);
            let at = |k: usize| {
                let [a, b, c] = triangle.map(|i| out.uvs[i as usize][k]);
                a + b1 * (b - a) + b2 * (c - a)
            };
            let (x, y) = (at(0) * 4.0 - 0.5, (1.0 - at(1)) * 2.0 - 0.5);
            let (i, j) = (x as usize, y as usize);
            let (fx, fy) = (x - i as f32, y - j as f32);
            for k in 0..3 {
                let texel = |dx, dy| texels.numbers(i + dx, j + dy)[k];
                let found = (1.0 - fy) * ((1.0 - fx) * texel(0, 0) + fx * texel(1, 0))
                    + fy * ((1.0 - fx) * texel(0, 1) + fx * texel(1, 1));
                let [a, b, c] = mesh.triangles[t].map(|i| mesh.attributes[0].values[3 * i as usize + k]);
                let want = a + b1 * (b - a) + b2 * (c - a);
                assert!((found - want).abs() < 1e-5, "triangle {t}, {k}: {found}, not {want}");
            }
        }
    }
}
