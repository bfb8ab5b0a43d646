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

mod cube_map;
mod facts;
mod fisheye;
mod iris;
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

use crate::footprint::Footprint;
use straal_math::{Ray, Vec3};

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

/// A camera of a picture of known size.
#[derive(Clone, Debug, PartialEq)]
pub enum Camera {
    /// All rays start at one point.
    Perspective(Perspective),
    /// Rays start on a lens and meet, pixel by pixel, in a plane.
    ThinLens(Box<ThinLens>),
    /// All rays are parallel.
    Orthographic(Orthographic),
    /// The angle to the view depends on the distance from the middle.
    Fisheye(Box<Fisheye>),
    /// Longitude and latitude.
    Panorama(Box<Panorama>),
    /// Six faces.
    CubeMap(Box<CubeMap>),
    /// Two eyes.
    Stereo(Box<Stereo>),
    /// One of the others, carried along.
    Moving(Box<Moving>),
}

impl Camera {
    /// The ray through a point of the film; `None` where nothing is seen.
    #[inline]
    pub fn ray(&self, at: &FilmPoint) -> Option<Ray> {
        match self {
            Self::Perspective(c) => Some(c.ray(at)),
            Self::ThinLens(c) => Some(c.ray(at)),
            Self::Orthographic(c) => Some(c.ray(at)),
            Self::Fisheye(c) => c.ray(at),
            Self::Panorama(c) => Some(c.ray(at)),
            Self::CubeMap(c) => c.ray(at),
            Self::Stereo(c) => c.ray(at),
            Self::Moving(c) => c.ray(at),
        }
    }

    /// How the ray changes from the pixel to its neighbours, moment and place on the lens staying the same;
    /// [`Footprint::NONE`] where nothing is seen.
    pub fn footprint(&self, at: &FilmPoint) -> Footprint {
        match self {
            Self::Perspective(c) => c.footprint(at),
            Self::ThinLens(c) => c.footprint(at),
            Self::Orthographic(c) => c.footprint(),
            Self::Fisheye(c) => c.footprint(at),
            Self::Panorama(c) => c.footprint(at),
            Self::CubeMap(c) => c.footprint(at),
            Self::Stereo(c) => c.footprint(at),
            Self::Moving(c) => c.footprint(at),
        }
    }

    /// How much of a sample's red, green and blue the film takes. All of it, unless glasses are worn: this is said where
    /// light has become RGB, so that along the ray it stays four numbers of any meaning.
    pub fn taken(&self, at: &FilmPoint) -> [f32; 3] {
        match self {
            Self::Stereo(c) => c.taken(at),
            Self::Moving(c) => c.still().taken(at),
            _ => [1.0; 3],
        }
    }

    /// Pixels to which a length on a plane at distance 1 is magnified, for cameras that magnify by distance alone.
    pub fn focal_pixels(&self) -> Option<f64> {
        match self {
            Self::Perspective(c) => Some(c.plane.window.focal_pixels()),
            Self::ThinLens(c) => Some(c.plane.window.focal_pixels()),
            Self::Moving(c) => c.still().focal_pixels(),
            Self::Orthographic(_)
            | Self::Fisheye(_)
            | Self::Panorama(_)
            | Self::CubeMap(_)
            | Self::Stereo(_) => None,
        }
    }

    /// What of a sample's numbers it makes use of.
    pub fn needs(&self) -> Needs {
        match self {
            Self::ThinLens(_) => Needs { lens: true, ..Needs::default() },
            Self::Stereo(c) => c.needs(),
            Self::Moving(c) => Needs { time: true, ..c.still().needs() },
            _ => Needs::default(),
        }
    }
}
