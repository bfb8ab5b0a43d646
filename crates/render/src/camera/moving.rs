//! A camera that moves while the shutter is open.

use super::{Camera, Facts, FilmPoint, Needs, Sees, View};
use crate::footprint::Footprint;
use straal_math::{DVec3, Ray, Vec3};

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
    still: Box<Camera>,
    /// The poses on its way by their times, which rise; two at least.
    way: Vec<(f64, Stand)>,
    /// When the shutter opens and closes.
    shutter: [f64; 2],
}

impl Moving {
    /// `still` has the view [`View::ORIGIN`]. `None` without at least two poses whose times rise.
    pub fn new(still: Camera, way: Vec<(f64, Stand)>, shutter: [f64; 2]) -> Option<Self> {
        let rises = way.len() >= 2 && way.windows(2).all(|p| p[0].0 < p[1].0);
        rises.then(|| Self { still: Box::new(still), way, shutter })
    }

    /// The frame at a moment from 0 to 1 over the shutter; `None` if it then looks nowhere. Before the first pose and after the
    /// last it rests.
    pub fn view(&self, time: f32) -> Option<View> {
        let [open, close] = self.shutter;
        let t = open + (close - open) * f64::from(time);
        let next = self.way.partition_point(|(at, _)| *at <= t).clamp(1, self.way.len() - 1);
        let ((start, from), (end, to)) = (&self.way[next - 1], &self.way[next]);
        let share = (t - start) / (end - start);
        let held = if share < 1.0 { if share > 0.0 { share } else { 0.0 } } else { 1.0 };
        from.towards(to, held).view()
    }
}

impl Sees for Moving {
    fn ray(&self, at: &FilmPoint) -> Option<Ray> {
        let local = self.still.ray(at)?;
        let view = self.view(at.time)?;
        let o = (view.eye + carried(&view, local.o.as_dvec3())).as_vec3();
        Some(Ray { o, d: carried(&view, local.d.as_dvec3()).as_vec3(), ..local })
    }

    fn footprint(&self, at: &FilmPoint) -> Footprint {
        let local = self.still.footprint(at);
        let Some(view) = self.view(at.time) else { return Footprint::NONE };
        let carried = |v: Vec3| carried(&view, v.as_dvec3()).as_vec3();
        Footprint { o: local.o.map(carried), d: local.d.map(carried) }
    }

    fn needs(&self) -> Needs {
        Needs { time: true, ..self.still.needs() }
    }

    fn glasses(&self, at: &FilmPoint) -> [f32; 3] {
        self.still.glasses(at)
    }

    fn focal_pixels(&self) -> Option<f64> {
        self.still.focal_pixels()
    }

    fn facts(&self) -> Facts {
        self.still.facts()
    }

    #[cfg(test)]
    fn examples(_: &View, size: [u32; 2]) -> Vec<(&'static str, Camera)> {
        let window = super::Window::new(0.5, size).shifted([0.1, -0.2]);
        let own = Camera::Perspective(super::Perspective::new(&View::ORIGIN, &window));
        let stand = |x: f64| Stand {
            eye: DVec3::new(x, 0.0, 4.0),
            look_at: DVec3::ZERO,
            up: DVec3::Y,
            roll: 9.0 * x,
        };
        let moving = Self::new(own, vec![(0.0, stand(-1.0)), (1.0, stand(1.0))], [0.25, 0.75]);
        vec![("moving", Camera::Moving(moving.expect("two poses")))]
    }
}

/// A displacement in the camera's own frame, in the world.
fn carried(view: &View, v: DVec3) -> DVec3 {
    view.right * v.x + view.up * v.y - view.forward * v.z
}
