//! A hit as shading sees it.

use crate::shape::SurfacePoint;
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
    /// Index of the material in the world.
    pub material: u32,
    /// Index of the emitter in the world, if the surface glows.
    pub emitter: Option<u32>,
}
