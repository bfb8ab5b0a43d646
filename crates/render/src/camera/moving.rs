//! A camera that moves while the shutter is open.

use super::{Camera, FilmPoint, View};
use straal_math::{DVec3, Ray};

/// Where a camera stands and looks at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// The place it looks from.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub look_at: DVec3,
    /// Up in the picture, as far as the view allows.
    pub up: DVec3,
    /// Degrees, see [`View::rolled`].
    pub roll: f64,
}

impl Stand {
    /// `None` when it looks nowhere, or `up` is along the view.
    pub fn view(&self) -> Option<View> {
        Some(View::look_at(self.eye, self.look_at, self.up)?.rolled(self.roll))
    }

    /// On the way to another: eye, point looked at, up and roll each go straight there at an even pace.
    fn towards(&self, to: &Self, t: f64) -> Self {
        let between = |a: DVec3, b: DVec3| a + (b - a) * t;
        Self {
            eye: between(self.eye, to.eye),
            look_at: between(self.look_at, to.look_at),
            up: between(self.up, to.up),
            roll: self.roll + (to.roll - self.roll) * t,
        }
    }
}

/// A camera that stands at the origin and looks along -z, carried along: its rays are those of the frame that it has at the
/// ray's moment, computed in double precision.
#[derive(Clone, Debug, PartialEq)]
pub struct Moving {
    still: Camera,
    from: Stand,
    to: Stand,
    /// When the shutter opens and closes; 0 is the moment of `from`, 1 that of `to`.
    shutter: [f64; 2],
}

impl Moving {
    /// `still` has the view [`View::ORIGIN`].
    pub fn new(still: Camera, way: [Stand; 2], shutter: [f64; 2]) -> Self {
        let [from, to] = way;
        Self { still, from, to, shutter }
    }

    /// The camera in its own frame.
    pub fn still(&self) -> &Camera {
        &self.still
    }

    /// The frame at a moment from 0 to 1 over the shutter; `None` if it then looks nowhere.
    pub fn view(&self, time: f32) -> Option<View> {
        let [open, close] = self.shutter;
        self.from.towards(&self.to, open + (close - open) * f64::from(time)).view()
    }

    pub(super) fn ray(&self, at: &FilmPoint) -> Option<Ray> {
        let local = self.still.ray(at)?;
        let view = self.view(at.time)?;
        let carried = |x: DVec3| view.right * x.x + view.up * x.y - view.forward * x.z;
        let o = (view.eye + carried(local.o.as_dvec3())).as_vec3();
        Some(Ray { o, d: carried(local.d.as_dvec3()).as_vec3(), ..local })
    }
}
