//! A lens of glass.

use straal_math::{DVec3, Ray, ops};
use straal_scene::desc::{self, LensExposure};

#[cfg(test)]
use super::View;
use super::view::Axes;
use super::{Camera, Facts, FilmPoint, Needs, Sees, Setup};
use crate::footprint::Footprint;

/// A surface of glass, or the stop; lengths in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Surface {
    /// Distance from the film along the axis.
    z: f64,
    /// Of curvature, above 0 where it bulges forwards; 0 for the stop.
    radius: f64,
    /// Index of refraction behind it over that in front.
    eta: f64,
    /// Half of its diameter, squared.
    reach: f64,
}

/// A camera whose rays are followed from the film through the surfaces of a lens (Kolb et al. 1995, "A Realistic Camera Model for Computer Graphics").
///
/// Of the last surface only a part leads out, and another one for each place on the film: its *exit pupil*. Rays are drawn towards a rectangle that holds it, which was found
/// beforehand for many distances from the axis (Steinert et al. 2011). What of them doesn't get out is black, and the rest is weighed by cos^4 / z^2 times the rectangle's area: so
/// the film's sum is the light that falls on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Realistic {
    axes: Axes,
    /// From the film on.
    surfaces: Vec<Surface>,
    /// Millimetres of a pixel, and the middle of the picture in pixels.
    pixel: f64,
    middle: [f64; 2],
    /// Rectangles on the plane of the last surface's rim that hold the exit pupil, seen from places on the film's x-axis from its middle to its corner.
    pupils: Vec<[[f64; 2]; 2]>,
    /// Millimetres between these.
    step: f64,
    /// What weights are divided by.
    norm: f64,
    degrees: [f64; 2],
}

/// Distances from the axis at which the exit pupil is known, and places along each side by which it is found.
const PUPILS: usize = 48;
const PLACES: usize = 48;

impl Realistic {
    /// Of what a scene says.
    pub(super) fn of(c: &desc::Realistic, setup: &Setup<'_>) -> Camera {
        Camera::Realistic(Self::new((&setup.view).into(), c, setup.size))
    }

    fn new(axes: Axes, c: &desc::Realistic, size: [u32; 2]) -> Self {
        // Validation has seen that there is one.
        let back = c.back_focus().unwrap_or(50.0);
        let mut surfaces = Vec::with_capacity(c.elements.len());
        let mut z = back;
        for (i, [radius, _, index, diameter]) in c.elements.iter().enumerate().rev() {
            let in_front = c.elements[..i].iter().rev().find(|e| e[0] != 0.0).map_or(1.0, |e| e[2]);
            let index_of = |n: f64| if n > 0.0 { n } else { 1.0 };
            let wide = match c.aperture {
                Some(stop) if *radius == 0.0 && stop < *diameter => stop,
                _ => *diameter,
            };
            surfaces.push(Surface {
                z,
                radius: *radius,
                eta: index_of(*index) / index_of(in_front),
                reach: 0.25 * wide * wide,
            });
            z += if i > 0 { c.elements[i - 1][1] } else { 0.0 };
        }
        let [w, h] = size.map(f64::from);
        let pixel = c.film_diagonal / (w * w + h * h).sqrt();
        let degrees = [w, h].map(|n| 2.0 * ops::atan2_d(0.5 * n * pixel, back).to_degrees());
        let mut made = Self {
            axes,
            surfaces,
            pixel,
            middle: [0.5 * w, 0.5 * h],
            pupils: Vec::new(),
            step: 0.5 * c.film_diagonal / (PUPILS - 1) as f64,
            norm: 1.0,
            degrees,
        };
        let found: Vec<_> = (0..PUPILS).map(|i| made.pupil(i as f64 * made.step)).collect();
        // Between two places there is what either has.
        let joined = |i: usize| {
            let near = [i.saturating_sub(1), i, (i + 1).min(PUPILS - 1)].map(|k| found[k]);
            near.into_iter().reduce(union).unwrap_or(found[i])
        };
        made.pupils = (0..PUPILS).map(joined).collect();
        if c.exposure == LensExposure::Even {
            made.norm = made.middle_weight();
        }
        made
    }

    /// Where the last surface's rim is.
    fn rear(&self) -> (f64, f64) {
        self.surfaces.first().map_or((1.0, 1.0), |s| (s.z, s.reach.sqrt()))
    }

    /// A rectangle that holds the exit pupil as seen from a place on the film's x-axis; all of the last surface where none is found.
    fn pupil(&self, x: f64) -> [[f64; 2]; 2] {
        let (z, reach) = self.rear();
        // Bulging glass is seen beside its rim's plane.
        let wide = 1.5 * reach;
        let cell = 2.0 * wide / PLACES as f64;
        let mut out: Option<[[f64; 2]; 2]> = None;
        for i in 0..PLACES * PLACES {
            let place = [i % PLACES, i / PLACES].map(|k| (k as f64 + 0.5) * cell - wide);
            let from = DVec3::new(x, 0.0, 0.0);
            if self.through(from, DVec3::new(place[0], place[1], z) - from).is_some() {
                let around = [place.map(|v| v - cell), place.map(|v| v + cell)];
                out = Some(out.map_or(around, |out| union(out, around)));
            }
        }
        out.unwrap_or([[-wide; 2], [wide; 2]])
    }

    /// The light that falls on the middle of the film, for a radiance of 1 all around.
    fn middle_weight(&self) -> f64 {
        const SIDE: usize = 128;
        let mut sum = 0.0;
        for i in 0..SIDE * SIDE {
            let u = [i % SIDE, i / SIDE].map(|k| (k as f64 + 0.5) / SIDE as f64);
            let (from, way, weight) = self.drawn([0.0, 0.0], u);
            sum += if self.through(from, way).is_some() { weight } else { 0.0 };
        }
        let mean = sum / (SIDE * SIDE) as f64;
        if mean > 0.0 { mean } else { 1.0 }
    }

    /// From a place on the film towards the exit pupil: the place, the way, and what that weighs.
    fn drawn(&self, [x, y]: [f64; 2], [u, v]: [f64; 2]) -> (DVec3, DVec3, f64) {
        let r = (x * x + y * y).sqrt();
        let at = r / self.step;
        let last = PUPILS - 2;
        let i = if at < last as f64 { at as usize } else { last };
        let share = at - i as f64;
        let share = if share < 1.0 { share } else { 1.0 };
        let [a, b] = [self.pupils[i], self.pupils[i + 1]];
        let corner = |k: usize, axis: usize| a[k][axis] + (b[k][axis] - a[k][axis]) * share;
        let size = [0, 1].map(|axis| corner(1, axis) - corner(0, axis));
        let [px, py] = [corner(0, 0) + u * size[0], corner(0, 1) + v * size[1]];
        // Turned about the axis to where the place is.
        let (cos, sin) = if r > 0.0 { (x / r, y / r) } else { (1.0, 0.0) };
        let (z, _) = self.rear();
        let from = DVec3::new(x, y, 0.0);
        let way = DVec3::new(px * cos - py * sin, px * sin + py * cos, z) - from;
        let square = way.length_squared();
        // cos^4 / z^2, where cos = z / length.
        (from, way, z * z / (square * square) * size[0] * size[1])
    }

    /// The ray in front of the lens of one that leaves the film: where, and which way. `None` where glass ends or reflects all.
    fn through(&self, mut o: DVec3, d: DVec3) -> Option<(DVec3, DVec3)> {
        let mut d = d.try_normalize()?;
        for s in &self.surfaces {
            if s.radius == 0.0 {
                o += d * ((s.z - o.z) / d.z);
            } else {
                // The middle of the ball is behind what bulges forwards.
                let to = DVec3::new(0.0, 0.0, s.z - s.radius) - o;
                let along = to.dot(d);
                let square = along * along - to.length_squared() + s.radius * s.radius;
                if square < 0.0 {
                    return None;
                }
                let root = square.sqrt();
                // The cap about the axis: the far side of a ball that lies behind.
                let t = if (s.radius > 0.0) == (d.z > 0.0) { along + root } else { along - root };
                o += d * t;
            }
            // What is no number is outside as well.
            let within = o.x * o.x + o.y * o.y <= s.reach;
            if !within || d.z <= 0.0 {
                return None;
            }
            if s.radius != 0.0 && s.eta != 1.0 {
                let n = (o - DVec3::new(0.0, 0.0, s.z - s.radius)) / s.radius;
                // Against the ray.
                let n = if n.dot(d) > 0.0 { -n } else { n };
                let cos = -n.dot(d);
                let rest = 1.0 - s.eta * s.eta * (1.0 - cos * cos);
                if rest < 0.0 {
                    return None;
                }
                d = d * s.eta + n * (s.eta * cos - rest.sqrt());
                d = d.try_normalize()?;
            }
        }
        Some((o, d))
    }

    /// Where on the film a place of the picture is, in millimetres: the film's picture stands on its head.
    fn on_film(&self, position: [f32; 2]) -> [f64; 2] {
        let [x, y] = [0, 1].map(|k| (f64::from(position[k]) - self.middle[k]) * self.pixel);
        [-x, y]
    }
}

/// What holds two rectangles.
fn union(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let low = |a: f64, b: f64| if b < a { b } else { a };
    let high = |a: f64, b: f64| if b > a { b } else { a };
    [[0, 1].map(|k| low(a[0][k], b[0][k])), [0, 1].map(|k| high(a[1][k], b[1][k]))]
}

impl Sees for Realistic {
    fn ray(&self, at: &FilmPoint) -> Option<Ray> {
        let (from, way, _) = self.drawn(self.on_film(at.position), at.lens.map(f64::from));
        let (o, d) = self.through(from, way)?;
        // Millimetres from the middle of the first surface, where the camera stands.
        let front = self.surfaces.last().map_or(0.0, |s| s.z);
        let [x, y, z] = [o.x, o.y, o.z - front].map(|v| (1e-3 * v) as f32);
        let o = self.axes.eye + self.axes.direction(x, y, z);
        let d = self.axes.direction(d.x as f32, d.y as f32, d.z as f32).try_normalize()?;
        Some(Ray { time: at.time, ..Ray::new(o, d) })
    }

    /// By rays beside it, through the same place of the exit pupil.
    fn footprint(&self, at: &FilmPoint) -> Footprint {
        const STEP: f32 = 0.25;
        let Some(here) = self.ray(at) else { return Footprint::NONE };
        let mut out = Footprint::NONE;
        for axis in 0..2 {
            let beside = |by: f32| {
                let mut position = at.position;
                position[axis] += by;
                self.ray(&FilmPoint { position, ..*at })
            };
            let (after, before) = (beside(STEP), beside(-STEP));
            // At an edge, from the one side.
            let width = if after.is_some() && before.is_some() { 2.0 * STEP } else { STEP };
            let (after, before) = (after.unwrap_or(here), before.unwrap_or(here));
            out.o[axis] = (after.o - before.o) * (1.0 / width);
            out.d[axis] = (after.d - before.d) * (1.0 / width);
        }
        out
    }

    fn needs(&self) -> Needs {
        Needs { lens: true, glasses: true, patience: true, ..Needs::default() }
    }

    /// What the light on its way weighs, the same in all colours.
    fn glasses(&self, at: &FilmPoint) -> [f32; 3] {
        let (_, _, weight) = self.drawn(self.on_film(at.position), at.lens.map(f64::from));
        [(weight / self.norm) as f32; 3]
    }

    fn facts(&self) -> Facts {
        Facts { kind: "realistic lens", degrees: Some(self.degrees), focus: None }
    }

    #[cfg(test)]
    fn examples(view: &View, size: [u32; 2]) -> Vec<(&'static str, Camera)> {
        let of = |c: &desc::Realistic| Camera::Realistic(Self::new(view.into(), c, size));
        vec![("single lens", of(&tests::single(0.5, 5.0))), ("doublet", of(&tests::doublet()))]
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A thin lens of 50 mm: 1/f = (n - 1) 2/R for two surfaces of radius R.
    pub fn single(thickness: f64, diameter: f64) -> desc::Realistic {
        desc::Realistic {
            elements: vec![[50.0, thickness, 1.5, diameter], [-50.0, 0.0, 1.0, diameter]],
            aperture: None,
            film_diagonal: 10.0,
            focus_distance: 2.0,
            exposure: LensExposure::Even,
            observer: desc::Observer::default(),
        }
    }

    /// Two kinds of glass that touch, and a stop before them.
    pub fn doublet() -> desc::Realistic {
        desc::Realistic {
            elements: vec![
                [0.0, 3.0, 0.0, 10.0],
                [60.0, 6.0, 1.52, 20.0],
                [-45.0, 2.0, 1.62, 20.0],
                [-130.0, 90.0, 1.0, 20.0],
            ],
            focus_distance: 5.0,
            ..single(0.0, 1.0)
        }
    }

    fn origin() -> Axes {
        Axes::from(&View::ORIGIN)
    }

    /// Rays from a place on the film meet where a thin lens has them meet: at the distance of focus, magnified by the distances from the lens.
    #[test]
    fn a_thin_lens_is_the_limit() {
        let said = single(0.01, 2.0);
        let back = said.back_focus().unwrap();
        // 1/a + 1/b = 1/f, a + b = 2 m.
        let (a, b) = (2000.0 - back, back);
        assert!((1.0 / a + 1.0 / b - 1.0 / 50.0).abs() < 1e-5, "{back}");
        let camera = Realistic::new(origin(), &said, [100, 100]);
        for position in [[50.0, 50.0], [70.0, 40.0], [20.0, 55.0]] {
            let [x, y] = camera.on_film(position);
            let want = DVec3::new(-x * a / b, -y * a / b, -a) * 1e-3;
            let mut tried = 0;
            for i in 0..64 {
                let lens = [i % 8, i / 8].map(|k| (k as f32 + 0.5) / 8.0);
                let at = FilmPoint { lens, ..FilmPoint::at(position) };
                let Some(ray) = Sees::ray(&camera, &at) else { continue };
                tried += 1;
                let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
                let there = o + d * ((want.z - o.z) / d.z);
                assert!((there - want).length() < 2e-3, "{position:?} {lens:?}: {there:?}, not {want:?}");
            }
            assert!(tried > 20, "{tried}");
        }
    }

    /// The light that falls on the middle of the film is pi sin^2 of the cone's half angle, and an even picture has 1 there.
    #[test]
    fn the_middle_is_lit_by_the_cone() {
        let said = desc::Realistic { exposure: LensExposure::Film, ..single(0.01, 10.0) };
        let camera = Realistic::new(origin(), &said, [100, 100]);
        let (z, r) = (camera.rear().0, 5.0_f64);
        let want = std::f64::consts::PI * r * r / (r * r + z * z);
        let got = camera.middle_weight();
        // The rim of bulging glass lies beside its middle's plane.
        assert!((got / want - 1.0).abs() < 0.02, "{got}, not {want}");
        let even = Realistic::new(origin(), &single(0.01, 10.0), [100, 100]);
        let (mut sum, mut count) = (0.0, 0.0);
        for i in 0..4096 {
            let lens = [i % 64, i / 64].map(|k| (k as f32 + 0.5) / 64.0);
            let at = FilmPoint { lens, ..FilmPoint::at([50.0, 50.0]) };
            count += 1.0;
            if Sees::ray(&even, &at).is_some() {
                sum += f64::from(even.glasses(&at)[0]);
            }
        }
        assert!((sum / count - 1.0).abs() < 0.01, "{}", sum / count);
    }

    #[test]
    fn a_narrow_stop_lets_less_through() {
        let weight = |aperture| {
            let said = desc::Realistic { aperture, exposure: LensExposure::Film, ..doublet() };
            Realistic::new(origin(), &said, [100, 100]).middle_weight()
        };
        let (wide, narrow) = (weight(None), weight(Some(5.0)));
        assert!((wide / narrow - 4.0).abs() < 0.15, "{wide} {narrow}");
    }
}
