//! # Attribute
//!
//! What a mesh's file says of its vertices or faces besides where they are: colours as a scanner saw them, a roughness that a program painted. Between vertices it
//! is mixed by the place in the triangle, as normals are; on a face it is one.

use straal_color::{Light, RgbSpace, Space, luminance};
use straal_scene::desc::{self, AttributePer, TextureSpace};
use straal_scene::mesh::Per;

use super::image::{Channel, Meaning};
use super::{Maker, Pattern, Reading, ShadingPoint, Use};
use crate::lanes::{Colour, Lanes};

/// What a mesh has at its vertices or on its faces.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// Which: see [`MeshAttribute::id`].
    pub id: u32,
    /// What of the mesh has it, if only one will do.
    pub per: Option<Per>,
    /// Codes of sRGB become light; else numbers are taken as they stand.
    pub is_srgb: [bool; 2],
    /// From the primaries of its colours to those of sRGB, where these are others.
    pub to_srgb: Option<[[f32; 3]; 3]>,
    /// Which number is taken where one is wanted.
    pub channel: Channel,
    /// The colour where there is no such thing.
    pub absent: Colour,
}

/// What a mesh has at its vertices or on its faces, as the renderer keeps it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshAttribute {
    /// A number for its name, the same in all meshes.
    pub id: u32,
    /// Whether vertices or faces have it.
    pub per: Per,
    /// Numbers of each: 1 to 4.
    pub channels: usize,
    /// Whether they were codes of bytes.
    pub is_code: bool,
    /// `channels` numbers of each vertex or face.
    pub values: Vec<f32>,
}

impl MeshAttribute {
    /// Of some vertices, or some faces, in another order.
    pub(crate) fn of(&self, which: impl Iterator<Item = usize>) -> Self {
        let values = which.flat_map(|i| self.at(i)).copied().collect();
        Self { values, ..*self }
    }

    fn at(&self, i: usize) -> &[f32] {
        self.values.get(i * self.channels..(i + 1) * self.channels).unwrap_or_default()
    }

    /// In a triangle: grey, colours and alpha, 1 where there is none.
    fn look_up(&self, triangle: u32, corners: [u32; 3], [u, v]: [f32; 2]) -> [f32; 4] {
        let mut out = [0.0; 4];
        match self.per {
            Per::Face => out.iter_mut().zip(self.at(triangle as usize)).for_each(|(o, v)| *o = *v),
            Per::Vertex => {
                for (corner, share) in corners.into_iter().zip([1.0 - u - v, u, v]) {
                    out.iter_mut().zip(self.at(corner as usize)).for_each(|(o, v)| *o += share * v);
                }
            }
        }
        match self.channels {
            1 => [out[0], out[0], out[0], 1.0],
            2 => [out[0], out[0], out[0], out[1]],
            3 => [out[0], out[1], out[2], 1.0],
            _ => out,
        }
    }
}

impl Attribute {
    pub(super) fn of(d: &desc::AttributeTexture, make: &mut dyn Maker) -> Self {
        let of_colours = !make.wants_number();
        // Codes, and other numbers.
        let is_srgb = match d.color_space {
            TextureSpace::Auto => [of_colours, false],
            TextureSpace::Srgb | TextureSpace::DisplayP3 => [true, true],
            _ => [false, false],
        };
        let space: RgbSpace = match d.color_space {
            TextureSpace::DisplayP3 => Space::DisplayP3,
            TextureSpace::Rec2020 => Space::Rec2020,
            TextureSpace::AcesCg => Space::AcesCg,
            TextureSpace::Aces => Space::Aces,
            _ => Space::Srgb,
        }
        .rgb();
        let id = make.attribute(&d.name.0.value);
        Self {
            id,
            per: match d.per {
                AttributePer::Any => None,
                AttributePer::Vertex => Some(Per::Vertex),
                AttributePer::Face => Some(Per::Face),
            },
            is_srgb,
            to_srgb: Meaning::matrix(space),
            channel: Channel::of(&d.channel),
            absent: make.colour(&d.absent),
        }
    }

    fn rgba<L>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> Option<[f32; 4]> {
        let corner = at.on_mesh?;
        let mesh = reading.meshes.get(corner.mesh as usize)?;
        let found =
            mesh.attributes.iter().find(|a| a.id == self.id && self.per.is_none_or(|per| a.per == per))?;
        let corners = *mesh.indices.get(corner.triangle as usize)?;
        let [r, g, b, a] = found.look_up(corner.triangle, corners, corner.place);
        if !self.is_srgb[usize::from(!found.is_code)] && self.to_srgb.is_none() {
            return Some([r, g, b, a]);
        }
        let decode = |v: f32| {
            if self.is_srgb[usize::from(!found.is_code)] { straal_color::srgb::decode(v) } else { v }
        };
        let rgb = [r, g, b].map(decode);
        let [r, g, b] =
            self.to_srgb.map_or(rgb, |m| m.map(|row| row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]));
        Some([r, g, b, a])
    }
}

impl Pattern for Attribute {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, of: Use) -> Light {
        match self.rgba(at, reading) {
            Some([r, g, b, _]) => of.read([r, g, b], reading),
            None => reading.light(&self.absent),
        }
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        let Some(rgba) = self.rgba(at, reading) else { return self.absent.rgb[0] };
        match self.channel {
            Channel::Luminance if rgba[0] == rgba[1] && rgba[1] == rgba[2] => rgba[0],
            Channel::Luminance => luminance([rgba[0], rgba[1], rgba[2]]),
            Channel::Number(channel) => rgba[channel],
        }
    }

    /// Not known before the meshes are.
    fn most(&self) -> f32 {
        1.0
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        let absent = Light::rgb([0.1, 0.2, 0.3]).into();
        vec![Self {
            id: 0,
            per: None,
            is_srgb: [true, false],
            to_srgb: None,
            channel: Channel::Luminance,
            absent,
        }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::TriangleMesh;
    use crate::testing::in_rgb;
    use crate::texture::OnMesh;
    use straal_math::Vec3;

    #[test]
    fn colours_are_mixed_between_vertices_and_even_on_faces() {
        let attribute = |per, is_code, values: &[f32]| MeshAttribute {
            id: 0,
            per,
            channels: 3,
            is_code,
            values: values.to_vec(),
        };
        let mut mesh = TriangleMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].into(),
            indices: vec![[0, 1, 2], [3, 2, 1]].into(),
            ..TriangleMesh::default()
        };
        let on = |meshes: &[TriangleMesh], triangle, place| {
            let at =
                ShadingPoint { on_mesh: Some(OnMesh { mesh: 0, triangle, place }), ..ShadingPoint::NOWHERE };
            let reading = Reading { meshes, ..in_rgb() };
            Attribute::examples()[0].light(&at, &reading, Use::Reflectance).to_rgb()
        };
        mesh.attributes = vec![attribute(
            Per::Vertex,
            false,
            &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.5, 0.5],
        )];
        assert_eq!(on(&[mesh.clone()], 0, [0.25, 0.5]), [0.25, 0.25, 0.5]);
        assert_eq!(on(&[mesh.clone()], 1, [0.0, 0.0]), [0.5; 3]);
        // Codes become light.
        mesh.attributes[0].is_code = true;
        assert!((on(&[mesh.clone()], 1, [0.0, 0.0])[1] - 0.214_041).abs() < 1e-5);
        mesh.attributes = vec![attribute(Per::Face, false, &[1.0, 0.0, 0.0, 0.25, 0.5, 0.75])];
        assert_eq!(on(&[mesh.clone()], 1, [0.3, 0.3]), [0.25, 0.5, 0.75]);
        // Where there is none, the colour that was said.
        mesh.attributes.clear();
        assert_eq!(on(&[mesh], 0, [0.3, 0.3]), [0.1, 0.2, 0.3]);
    }
}
