//! A hit as shading sees it.

use crate::shape::SurfacePoint;
use crate::shape::offset::offset_origin;
use straal_math::{Frame, Vec3};

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

impl Surface {
    /// Where a ray that leaves along `w` starts: off the surface by the error bound of the point, no more.
    #[inline]
    pub fn leave(&self, w: Vec3) -> Vec3 {
        offset_origin(self.point.p, self.point.p_err, self.point.ng, w)
    }
}
