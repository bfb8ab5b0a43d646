//! Cube maps: all directions on six square faces.

use super::view::Axes;
use super::{Camera, Facts, FilmPoint, Sees, Setup, View, turned};
use crate::footprint::Footprint;
use straal_math::{DVec3, Ray, Vec3};
use straal_scene::desc;

/// Where in the picture the faces are. Each is what a pinhole of 90 degrees sees from the middle of the cube, those to the
/// sides with the same direction up, the upper one with its lower edge to the front, the lower one with its upper edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CubeLayout {
    /// 4 by 3 faces: left, front, right and back in the middle, up and down above and below the front.
    Cross,
    /// 6 faces: right, left, up, down, back, front.
    Row,
}

impl CubeLayout {
    /// Faces across and down.
    pub const fn faces(self) -> [u32; 2] {
        match self {
            Self::Cross => [4, 3],
            Self::Row => [6, 1],
        }
    }

    /// Which of right, left, up, down, back and front stands in a place.
    pub(crate) const fn face(self, column: u32, row: u32) -> Option<usize> {
        match (self, column, row) {
            (Self::Cross, 2, 1) => Some(0),
            (Self::Cross, 0, 1) => Some(1),
            (Self::Cross, 1, 0) => Some(2),
            (Self::Cross, 1, 2) => Some(3),
            (Self::Cross, 3, 1) => Some(4),
            (Self::Cross, 1, 1) => Some(5),
            (Self::Row, column @ 0..6, 0) => Some(column as usize),
            _ => None,
        }
    }
}

/// Right, up and forward of the right, left, upper, lower, back and front face of a cube, by its own.
pub(crate) fn face_axes(right: DVec3, up: DVec3, forward: DVec3) -> [[DVec3; 3]; 6] {
    [
        [-forward, up, right],
        [forward, up, -right],
        [right, -forward, up],
        [right, forward, -up],
        [-right, up, -forward],
        [right, up, forward],
    ]
}

/// A camera that sees all around, on the faces of a cube.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeMap {
    eye: Vec3,
    /// Views of right, left, up, down, back and front.
    faces: [Axes; 6],
    layout: CubeLayout,
    /// Side of a face in pixels.
    side: u32,
}

impl CubeMap {
    /// Faces as large as whole pixels allow, of a pixel at least; the rest of the picture, to the right and below, stays black.
    pub fn new(view: &View, layout: CubeLayout, size: [u32; 2]) -> Self {
        let [columns, rows] = layout.faces();
        let side = (size[0] / columns).min(size[1] / rows).max(1);
        let View { right, up, forward, .. } = *view;
        let faces = face_axes(right, up, forward)
            .map(|[right, up, forward]| Axes::from(&View { right, up, forward, eye: view.eye }));
        Self { eye: view.eye.as_vec3(), faces, layout, side }
    }

    /// The face that is looked through, and the direction, not of unit length.
    #[inline]
    fn direction(&self, at: &FilmPoint) -> Option<(&Axes, Vec3)> {
        let [column, row] = at.pixel.map(|n| n / self.side);
        let face = &self.faces[self.layout.face(column, row)?];
        // From -1 to 1 over the face; a little more where a filter reaches over its edge.
        let within = |position: f32, first: u32| 2.0 * (position - first as f32) / self.side as f32 - 1.0;
        let x = within(at.position[0], column * self.side);
        let y = -within(at.position[1], row * self.side);
        Some((face, face.direction(x, y, 1.0)))
    }

    /// Of what a scene says.
    pub(super) fn of(c: &desc::CubeMap, setup: &Setup<'_>) -> Camera {
        let layout = match c.layout {
            desc::CubeLayout::Cross => CubeLayout::Cross,
            desc::CubeLayout::Row => CubeLayout::Row,
        };
        Camera::CubeMap(Self::new(&setup.view, layout, setup.size))
    }
}

impl Sees for CubeMap {
    #[inline]
    fn ray(&self, at: &FilmPoint) -> Option<Ray> {
        let (_, d) = self.direction(at)?;
        Some(Ray { time: at.time, ..Ray::new(self.eye, d.normalize()) })
    }

    fn footprint(&self, at: &FilmPoint) -> Footprint {
        let Some((face, d)) = self.direction(at) else { return Footprint::NONE };
        let pixel = 2.0 / self.side as f32;
        Footprint { d: turned(d, face.right * pixel, face.up * -pixel), ..Footprint::NONE }
    }

    fn facts(&self) -> Facts {
        Facts::plain("cube map")
    }

    #[cfg(test)]
    fn examples(view: &View, size: [u32; 2]) -> Vec<(&'static str, Camera)> {
        let cube = |layout| Camera::CubeMap(Self::new(view, layout, size));
        vec![("cross", cube(CubeLayout::Cross)), ("row", cube(CubeLayout::Row))]
    }
}
