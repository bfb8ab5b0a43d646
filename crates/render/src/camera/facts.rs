//! What follows from a camera's settings, for people.

use super::Window;
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

impl Facts {
    /// No more than a name.
    pub(super) const fn plain(kind: &'static str) -> Self {
        Self { kind, degrees: None, focus: None }
    }
}

/// Angles across a window and up it.
pub(super) fn degrees(window: &Window) -> [f64; 2] {
    let half = [window.tan_x, window.tan_y()];
    std::array::from_fn(|i| {
        let to = |edge: f64| ops::atan2_d(window.middle[i] + edge, 1.0);
        (to(half[i]) - to(-half[i])).to_degrees()
    })
}
