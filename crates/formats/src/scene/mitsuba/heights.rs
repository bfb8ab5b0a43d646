//! Height fields of version 0.6: a picture over the square from -1 to 1 in x and y, its first row at y = -1, brighter is higher along z.
//!
//! Mitsuba resamples pictures to sizes that are one more than a power of two; here each pixel is a vertex.

use std::sync::Arc;

use straal_math::Affine;
use straal_scene::desc::{Node, Shading, TriangleMesh};
use straal_scene::limit::Limit;
use straal_scene::{Image, Mesh, MeshAsset, Spanned};

use super::spectrum::luminance;
use super::translate::Translator;
use super::tree::{Class, Object};
use super::uv::Uv;
use crate::files::Refusal;
use crate::image::{self, Photo};

impl<'o> Translator<'o, '_, '_> {
    /// A height field as a mesh.
    pub fn heights(&mut self, o: &'o Object) -> Option<Node> {
        self.only(
            o,
            &["filename", "shading_normals", "flip_normals", "to_world", "width", "height", "scale", "*"],
        );
        let scale = self.within(o, "scale", 1.0, Limit::FINITE);
        let (of, file) = match self.inside(o, Class::Texture).first() {
            _ if o.has("filename") => (o, self.text(o, "filename")?),
            Some(&texture) => {
                let texture: &'o Object = &self.objects[texture];
                if texture.plugin.as_str() != "bitmap" {
                    self.unsupported(texture, "a height field of it is left out");
                    return None;
                }
                (texture, self.text(texture, "filename")?)
            }
            None => {
                self.fail(o.plugin.span, "a height field needs a `filename` or a texture of type `bitmap`");
                return None;
            }
        };
        let found = self.file(of, &file)?;
        let read = self.picture(&found.path);
        let (picture, hash) = match read {
            Ok(read) => read,
            Err(refusal) => {
                self.refuse(&file, &refusal);
                return None;
            }
        };
        let mesh = grid(&picture, scale);
        self.means.ledger.keep(mesh.heap_bytes());
        self.nodes += 1;
        let name = Spanned::new(format!("height field {} of {}", self.nodes, found.name), file.span);
        self.read.push((found.path, found.name, hash));
        let at = self.placed(o, &Affine::IDENTITY);
        let flip = self.flips(o);
        let surface = self.surface(o, &at, Uv::Same, flip);
        let is_smooth = self.boolean(o, "shading_normals").unwrap_or(true);
        let shading = if is_smooth { self.shading(o) } else { Shading::Flat };
        let file = Some(self.made.mesh(name, MeshAsset { mesh: Arc::new(mesh), ..MeshAsset::default() }));
        Some(Node::Mesh(TriangleMesh { file, shading, surface, ..TriangleMesh::default() }))
    }

    /// A picture's light, and the hash of its bytes.
    fn picture(&mut self, path: &std::path::Path) -> Result<(Image, [u8; 32]), Refusal> {
        let limits = self.means.limits;
        let header = image::Header::open(path, limits).map_err(|e| Refusal::new(e.to_string()))?;
        // As it is decoded, as light, and as vertices and triangles.
        let needs = header.decoded_bytes.saturating_add(header.bitmap_bytes().saturating_mul(64));
        let what = || format!("reading `{}`", path.display());
        if let Some(shortage) = self.means.ledger.refuse(needs, what, "a smaller picture takes less") {
            return Err(Refusal::new(shortage.to_string()));
        }
        let bytes = image::bytes(path, limits)?;
        let picture = Photo::read(&bytes, limits).map_err(|e| Refusal::new(e.to_string()))?.whole();
        let [width, height] = [picture.width, picture.height];
        let count = (width as u64).saturating_mul(height as u64);
        if width < 2 || height < 2 || count > limits.max_vertices.min(u64::from(u32::MAX)) {
            return Err(Refusal::new(format!(
                "a height field has from 2 x 2 to {} points, and this picture {width} x {height}",
                limits.max_vertices
            )));
        }
        Ok((picture, blake3::hash(&bytes).into()))
    }
}

/// Two triangles between each four pixels, which face +z.
fn grid(picture: &Image, scale: f64) -> Mesh {
    let [width, height] = [picture.width as u32, picture.height as u32];
    let mut mesh = Mesh::default();
    for (y, row) in picture.pixels.chunks(picture.width).enumerate() {
        for (x, pixel) in row.iter().enumerate() {
            let u = x as f32 / (width - 1) as f32;
            let v = y as f32 / (height - 1) as f32;
            let z = scale * luminance(pixel.map(f64::from));
            mesh.positions.push([2.0 * u - 1.0, 2.0 * v - 1.0, z as f32]);
            mesh.uvs.push([u, v]);
        }
    }
    for y in 0..height - 1 {
        for x in 0..width - 1 {
            let at = |x: u32, y: u32| x + y * width;
            mesh.triangles.push([at(x, y), at(x + 1, y), at(x + 1, y + 1)]);
            mesh.triangles.push([at(x, y), at(x + 1, y + 1), at(x, y + 1)]);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_row_lies_in_front_and_light_is_high() {
        let mut pixels = vec![[0.0; 3]; 6];
        pixels[1] = [0.5; 3];
        let mesh = grid(&Image { width: 3, height: 2, pixels }, 2.0);
        assert_eq!(mesh.positions[1], [0.0, -1.0, 1.0]);
        assert_eq!((mesh.positions[5], mesh.uvs[5]), ([1.0, 1.0, 0.0], [1.0, 1.0]));
        assert_eq!(mesh.triangles.len(), 4);
        assert!(mesh.is_whole());
    }
}
