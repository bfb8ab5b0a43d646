//! Cameras: from a sample's numbers to a ray.
//!
//! A camera of a picture of known size turns a [`FilmPoint`], which is a place on the film, two numbers for the lens and a
//! moment, into the ray that light comes back along. What every kind keeps to:
//!
//! - The ray's direction has length 1, its interval is the whole half-line, and its time is the moment that was given.
//! - Every ray weighs 1: places on the lens are drawn with the density with which light passes there. Film and lens come
//!   from one four-dimensional point, so that a pixel's samples are spread over both together.
//! - `None` says that nothing is seen there, as around a fisheye's circle. The sample counts all the same: it brings no
//!   light, and its guides are 0.
//! - The place may be outside of the pixel, where a filter is wider than that. Where a picture is put together from several
//!   (two eyes, six faces), the pixel says which of them it belongs to, so that none bleeds into another.
//! - [`Camera::footprint`] is the ray's derivative by the place on the film: what a pixel sees, to first order.
//! - It is a pure function of what it is given, of plain operations in a fixed order.
//!
//! To add one: its file, which implements `Sees` and gives examples to be tested; its line in the list below; its keys in the
//! description.

mod cube_map;
mod facts;
mod fisheye;
mod iris;
mod list;
mod moving;
mod orthographic;
mod panorama;
mod perspective;
mod stereo;
#[cfg(test)]
mod tests;
mod thin_lens;
mod view;

pub(crate) use cube_map::face_axes;
pub use cube_map::{CubeLayout, CubeMap};
pub use facts::{Facts, Focus};
pub use fisheye::{Fisheye, Projection};
pub use iris::Iris;
pub use moving::{Moving, Stand};
pub use orthographic::Orthographic;
pub use panorama::{Panorama, Rows};
pub use perspective::{Perspective, Window};
pub use stereo::{Eyes, Stereo, StereoLayout};
pub use thin_lens::ThinLens;
pub use view::View;

use crate::error::CompileError;
use crate::footprint::Footprint;
use straal_math::{Ray, Vec3};
use straal_scene::desc;
use straal_scene::value::Name;

/// What a camera ray is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmPoint {
    /// The pixel of the whole picture that the sample belongs to.
    pub pixel: [u32; 2],
    /// Position on the whole picture in pixels, x to the right, y down.
    pub position: [f32; 2],
    /// A point of the unit square, for the place on the lens.
    pub lens: [f32; 2],
    /// Moment, 0 to 1 over the shutter.
    pub time: f32,
}

impl FilmPoint {
    /// A place within its pixel, seen through the middle of the lens when the shutter opens.
    pub fn at(position: [f32; 2]) -> Self {
        Self { pixel: position.map(|v| v as u32), position, lens: [0.5; 2], time: 0.0 }
    }
}

/// How the unit vector along `d` changes from pixel to pixel when `d`, not of unit length, changes by `across` and `down`.
fn turned(d: Vec3, across: Vec3, down: Vec3) -> [Vec3; 2] {
    let square = d.length_squared();
    let length = square.sqrt();
    [across, down].map(|change| (change - d * (d.dot(change) / square)) / length)
}

/// What a camera makes use of, known before the first ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// [`FilmPoint::lens`] makes a difference.
    pub lens: bool,
    /// [`FilmPoint::time`] makes a difference.
    pub time: bool,
    /// [`Camera::taken`] isn't always 1.
    pub taken: bool,
}

list::cameras! {
    /// All rays start at one point.
    Perspective of Perspective,
    /// Rays start on a lens and meet, pixel by pixel, in a plane.
    ThinLens,
    /// All rays are parallel.
    Orthographic of Orthographic,
    /// The angle to the view depends on the distance from the middle.
    Fisheye of Fisheye,
    /// Longitude and latitude.
    Panorama of Panorama,
    /// Six faces.
    CubeMap of CubeMap,
    /// Two eyes.
    Stereo,
    /// One of the others, carried along.
    Moving,
}

/// What a kind of camera does, by [the contract](self).
trait Sees {
    /// See [`Camera::ray`].
    fn ray(&self, at: &FilmPoint) -> Option<Ray>;

    /// See [`Camera::footprint`].
    fn footprint(&self, at: &FilmPoint) -> Footprint;

    /// See [`Camera::facts`].
    fn facts(&self) -> Facts;

    /// See [`Camera::needs`].
    fn needs(&self) -> Needs {
        Needs::default()
    }

    /// See [`Camera::taken`].
    fn taken(&self, _at: &FilmPoint) -> [f32; 3] {
        [1.0; 3]
    }

    /// See [`Camera::focal_pixels`].
    fn focal_pixels(&self) -> Option<f64> {
        None
    }

    /// Some for the tests of the contract, each with a name.
    #[cfg(test)]
    fn examples(view: &View, size: [u32; 2]) -> Vec<(&'static str, Camera)>;
}

/// What a camera is made with, besides its own settings.
pub(crate) struct Setup<'a> {
    /// Where it stands in its own frame: in the world, unless it is carried along.
    pub view: View,
    /// Where it stands in the world when the shutter opens.
    pub at_start: View,
    /// Width and height of the picture that the scene describes, in pixels.
    pub film: [u32; 2],
    /// Those of the picture that is made.
    pub size: [u32; 2],
    /// Distance along a view to what goes by a name.
    pub distance: &'a dyn Fn(&Name, &View) -> Result<f64, CompileError>,
}
