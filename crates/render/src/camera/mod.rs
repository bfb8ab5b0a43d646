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
//! - Some can be asked the other way round ([`Camera::shows`]): where on the film a point is seen through a place on the lens. It is the very
//!   place whose ray goes through that point.
//! - [`Camera::footprint`] is the ray's derivative by the place on the film: what a pixel sees, to first order.
//! - It is a pure function of what it is given, of plain operations in a fixed order.
//! - Rays are asked for one by one or many side by side ([`Camera::rays`]). The commonest kinds are written once for both; the
//!   others make each ray by itself.
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
mod realistic;
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
pub use realistic::Realistic;
pub use stereo::{Eyes, Stereo, StereoLayout};
pub use thin_lens::ThinLens;
pub use view::View;

use crate::footprint::Footprint;
use straal_math::simd::{Float, Mask, Uint};
use straal_math::{Ray, Vec3};
use straal_scene::value::Name;
use straal_scene::{Span, desc};

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

/// What camera rays are made from, side by side: a [`FilmPoint`] in each lane.
#[derive(Clone, Copy, Debug)]
pub struct FilmPoints<F: Float> {
    /// See [`FilmPoint::pixel`].
    pub pixel: [F::Uint; 2],
    /// See [`FilmPoint::position`].
    pub position: [F; 2],
    /// See [`FilmPoint::lens`].
    pub lens: [F; 2],
    /// See [`FilmPoint::time`].
    pub time: F,
}

impl<F: Float> FilmPoints<F> {
    /// That of one lane.
    #[inline]
    pub fn lane(&self, i: usize) -> FilmPoint {
        let ([px, py], [x, y], [u, v]) = (self.pixel, self.position, self.lens);
        FilmPoint {
            pixel: [px.lane(i), py.lane(i)],
            position: [x.lane(i), y.lane(i)],
            lens: [u.lane(i), v.lane(i)],
            time: self.time.lane(i),
        }
    }
}

impl From<&FilmPoint> for FilmPoints<f32> {
    #[inline]
    fn from(&FilmPoint { pixel, position, lens, time }: &FilmPoint) -> Self {
        Self { pixel, position, lens, time }
    }
}

/// Camera rays side by side, made from [`FilmPoints`], whose moments are theirs.
#[derive(Clone, Copy, Debug)]
pub struct CameraRays<F: Float> {
    /// Where they start.
    pub o: Vec3<F>,
    /// Unit vectors.
    pub d: Vec3<F>,
    /// Whether anything is seen there.
    pub seen: F::Mask,
}

impl<F: Float> CameraRays<F> {
    /// Those that `f` gives, a lane each.
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> Option<Ray>) -> Self {
        let (mut o, mut d) = ([F::ZERO.to_array(); 3], [F::ZERO.to_array(); 3]);
        let mut seen = 0;
        for i in 0..F::WIDTH {
            let Some(ray) = f(i) else { continue };
            seen |= 1 << i;
            for k in 0..3 {
                o[k].as_mut()[i] = ray.o[k];
                d[k].as_mut()[i] = ray.d[k];
            }
        }
        let vector =
            |[x, y, z]: [F::Array; 3]| Vec3::new(F::from_array(x), F::from_array(y), F::from_array(z));
        Self { o: vector(o), d: vector(d), seen: F::Mask::from_bits(seen) }
    }
}

impl CameraRays<f32> {
    #[inline]
    fn at(self, time: f32) -> Option<Ray> {
        self.seen.then(|| Ray { time, ..Ray::new(self.o, self.d) })
    }
}

/// What a camera is asked for by [`Camera::shows`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sought {
    /// A point of the world.
    Point(Vec3),
    /// What is infinitely far away in a direction, a unit vector.
    Direction(Vec3),
}

/// Where a camera shows a thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// Where the camera's ray to it starts.
    pub o: Vec3,
    /// Which way that goes: a unit vector.
    pub d: Vec3,
    /// On the whole picture in pixels, x to the right, y down; it may lie outside.
    pub position: [f32; 2],
    /// Pixels (the area of one is 1) that the film has for each square metre of a small surface at the point that faces the camera; for a direction,
    /// for each steradian. That is what light that is sent from there has to be multiplied by: a camera's importance.
    pub density: f32,
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

/// What a camera makes use of and takes, known before the first ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// [`FilmPoint::lens`] makes a difference.
    pub lens: bool,
    /// [`FilmPoint::time`] makes a difference.
    pub time: bool,
    /// [`Camera::glasses`] isn't always 1.
    pub glasses: bool,
    /// A ray takes several times as long as one of a pinhole, so that none is made that isn't worth it.
    pub patience: bool,
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
    /// Through a lens of glass.
    Realistic of Realistic,
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
///
/// It makes its rays either one by one ([`Self::ray`]) or side by side ([`Self::rays`], which is `#[inline(always)]`), and has the other
/// from that.
trait Sees {
    /// See [`Camera::ray`].
    #[inline]
    fn ray(&self, at: &FilmPoint) -> Option<Ray> {
        self.rays(&FilmPoints::from(at)).at(at.time)
    }

    /// See [`Camera::rays`].
    #[inline(always)]
    fn rays<F: Float>(&self, at: &FilmPoints<F>) -> CameraRays<F> {
        CameraRays::from_fn(
            #[inline(always)]
            |i| self.ray(&at.lane(i)),
        )
    }

    /// Whether it knows [`Self::shows`].
    const SHOWS: bool = false;

    /// See [`Camera::shows`].
    fn shows(&self, _what: Sought, _lens: [f32; 2]) -> Option<Shown> {
        None
    }

    /// See [`Camera::footprint`].
    fn footprint(&self, at: &FilmPoint) -> Footprint;

    /// See [`Camera::facts`].
    fn facts(&self) -> Facts;

    /// See [`Camera::needs`].
    fn needs(&self) -> Needs {
        Needs::default()
    }

    /// See [`Camera::glasses`].
    fn glasses(&self, _at: &FilmPoint) -> [f32; 3] {
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
    pub distance: &'a dyn Fn(&Name, &View) -> f64,
}

/// Why the camera is not focused on what it should be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the camera can't be focused on `{name}`: {}",
    if *unbounded { "it is unbounded and has no middle" } else { "its middle is not in front of it" }
)]
pub struct OutOfFocus {
    /// What the scene calls it.
    pub name: String,
    /// Where.
    pub span: Span,
    /// Whether it has no middle; else that isn't in front of the camera.
    pub unbounded: bool,
}
