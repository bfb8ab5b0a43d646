//! What follows from a camera's settings, for people.

use super::{Camera, Window};
use straal_math::ops;

/// What follows from a camera's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facts {
    /// The camera's kind.
    pub kind: &'static str,
    /// Angles across the picture's width and height in degrees, of cameras with a view plane.
    pub degrees: Option<[f64; 2]>,
    /// What is sharp, of cameras with a lens.
    pub focus: Option<Focus>,
}

/// What a lens shows sharply; lengths in the scene's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Focus {
    /// The lens's radius.
    pub radius: f64,
    /// Distance of the plane in focus along the view.
    pub distance: f64,
    /// From where to where a point is spread over less than a pixel; the end may be infinite.
    pub sharp: [f64; 2],
}

impl Camera {
    /// What follows from its settings; of two eyes, that of the left.
    pub fn facts(&self) -> Facts {
        let plain = |kind| Facts { kind, degrees: None, focus: None };
        match self {
            Self::Perspective(c) => Facts { degrees: Some(degrees(&c.plane.window)), ..plain("perspective") },
            Self::ThinLens(c) => {
                let (radius, distance) = (f64::from(c.iris().radius()), f64::from(c.focus()));
                let window = &c.plane.window;
                // Half a pixel's width in the plane in focus, over the radius: a point at distance z is spread over
                // 2 r |z - f| / z there.
                let part = window.tan_x * distance / f64::from(window.size[0]) / radius;
                let far = if part < 1.0 { distance / (1.0 - part) } else { f64::INFINITY };
                let focus = Focus { radius, distance, sharp: [distance / (1.0 + part), far] };
                Facts { kind: "thin lens", degrees: Some(degrees(window)), focus: Some(focus) }
            }
            Self::Orthographic(_) => plain("orthographic"),
            Self::Fisheye(_) => plain("fisheye"),
            Self::Panorama(_) => plain("panorama"),
            Self::CubeMap(_) => plain("cube map"),
            Self::Stereo(c) => Facts { kind: "stereo", ..c.left().facts() },
            Self::Moving(c) => c.still().facts(),
        }
    }
}

fn degrees(window: &Window) -> [f64; 2] {
    let half = [window.tan_x, window.tan_y()];
    std::array::from_fn(|i| {
        let to = |edge: f64| ops::atan2_d(window.middle[i] + edge, 1.0);
        (to(half[i]) - to(-half[i])).to_degrees()
    })
}
