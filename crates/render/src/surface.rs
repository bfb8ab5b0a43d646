//! A hit as shading sees it: one, or many [side by side](Surfaces).

mod columns;
mod side_by_side;

pub use columns::{BLOCK, Column, Vectors};
pub(crate) use side_by_side::Alike;
pub use side_by_side::{Met, Surfaces};

use crate::shape::SurfacePoint;
use crate::texture::ShadingPoint;
use straal_math::{Frame, Vec3};

/// The surface where a ray arrived, in world space.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Where, with its error bound, its normals and texture coordinates.
    pub point: SurfacePoint,
    /// Frame about the shading normal, as whoever sent the ray sees it ([`crate::material::shaded::shading_normal`]).
    pub frame: Frame,
    /// The geometric normal in that frame, on the shading normal's side; `None` where it is the shading normal.
    pub ng: Option<Vec3>,
    /// How far above the point the surface lies that shading normals tell of, see [`crate::shape::TriangleMesh::bulge`]; zero where it doesn't.
    pub bulge: Vec3,
    /// The unit normal of that surface, in the frame; `None` where it is the shading normal.
    pub smooth: Option<Vec3>,
    /// Whether it is seen from the side that its shading normal points to.
    pub in_front: bool,
    /// Index of the material in the world.
    pub material: u32,
    /// Index of the emitter in the world, if the surface glows.
    pub emitter: Option<u32>,
    /// What of the point its material reads, if that differs from point to point.
    pub at: Option<ShadingPoint>,
}

/// A frame about a unit normal whose first tangent follows another vector: what is left of that across the normal.
pub(crate) fn frame_along(n: Vec3, tangent: Vec3) -> Frame {
    // Along the normal there is none.
    let across = tangent - n * n.dot(tangent);
    if across.length_squared() <= 1e-12 * tangent.length_squared() {
        return Frame::from_normal(n);
    }
    let Some(s) = across.try_normalize() else { return Frame::from_normal(n) };
    Frame { s, t: n.cross(s), n }
}
