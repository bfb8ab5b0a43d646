//! Cameras.

use straal_math::DVec3;

use crate::desc::check;
use crate::describe::describe;
use crate::limit::Limit;

describe! {
    /// Who looks.
    pub enum Camera {
        /// A pinhole: what is far is small.
        "perspective" => Perspective(Perspective),
        /// Parallel rays: size does not depend on distance.
        "orthographic" => Orthographic(Orthographic),
    }
}

describe! {
    /// A pinhole camera.
    pub struct Perspective [check::perspective] {
        /// Where the camera stands.
        eye: DVec3,
        /// The point in the middle of the picture.
        look_at: DVec3,
        /// The direction that is up in the picture, as far as the view allows.
        up: DVec3 = DVec3::Y,
        /// Field of view in degrees, from edge to edge along `fov_axis`.
        fov: f64 [Limit::between(0.0, 180.0)] = 40.0,
        /// Which extent of the picture `fov` spans.
        fov_axis: FovAxis = FovAxis::X,
    }
}

describe! {
    /// A camera with parallel rays.
    pub struct Orthographic [check::orthographic] {
        /// Where the middle of the film is.
        eye: DVec3,
        /// The point in the middle of the picture.
        look_at: DVec3,
        /// The direction that is up in the picture, as far as the view allows.
        up: DVec3 = DVec3::Y,
        /// Full width of the picture in world units; the height follows from the film's size.
        width: f64 [Limit::POSITIVE] = 2.0,
    }
}

describe! {
    /// Which extent of the picture an angle spans.
    pub enum FovAxis {
        /// The width.
        "x" => X,
        /// The height.
        "y" => Y,
        /// The smaller of width and height.
        "smaller" => Smaller,
        /// The larger of width and height.
        "larger" => Larger,
        /// From corner to corner.
        "diagonal" => Diagonal,
    }
}
