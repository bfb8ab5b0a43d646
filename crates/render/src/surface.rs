//! A hit as shading sees it.

use crate::shape::SurfacePoint;
use straal_math::Frame;

/// The surface where a ray arrived, in world space.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Where, with its error bound, its normals and texture coordinates.
    pub point: SurfacePoint,
    /// Frame about the shading normal.
    pub frame: Frame,
    /// Index of the material in the world.
    pub material: u32,
    /// Index of the emitter in the world, if the surface glows.
    pub emitter: Option<u32>,
}
