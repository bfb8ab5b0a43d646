//! The projector, and pictures that lamps throw.

use crate::lanes::{Colour, Lanes, Rgb};
use crate::texture::{Reading, Readings, ShadingPoint, Value};
use straal_color::Light;
use straal_math::simd::{Float, Mask};
use straal_math::{DVec3, Frame, Vec3, ops};
use straal_scene::desc;

use super::{Emitter, Extent, LightSample, Reach, Receiver, Shine, point::towards, unit};
use crate::paint::Paint;
use crate::shape::Geometry;

/// A point that throws a picture.
///
/// A screen across its axis receives an irradiance of intensity x picture / distance² along the axis, as even as the picture is. So in a direction at an angle θ to the
/// axis the intensity is that over cos³ θ: by one cosine the screen is lit at a slant, by two it is farther away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projector {
    position: Vec3,
    thrown: Thrown,
    picture: Value<Colour>,
    /// On the axis where the picture is 1, in W/sr.
    intensity: f32,
    /// The picture's mean, in its strongest lane.
    mean: f64,
}

/// Where a picture lies that is thrown from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Thrown {
    /// To the right, up and along the axis.
    frame: Frame,
    /// Tangents of the angles from the axis to the right edge and to the upper one.
    slopes: [f32; 2],
}

/// Places a side by which a picture's mean is known.
const SIDE: usize = 48;

impl Thrown {
    /// Along a unit vector.
    pub fn new(axis: Vec3, up: Vec3, slopes: [f32; 2]) -> Self {
        let right = axis.cross(up).try_normalize();
        let frame =
            right.map_or_else(|| Frame::from_normal(axis), |s| Frame { s, t: s.cross(axis), n: axis });
        Self { frame, slopes }
    }

    /// Where in the picture, from 0 to 1, a direction of any length leads, and the cosine of its angle to the axis; whether it leads there at all.
    #[inline(always)]
    fn place<F: Float>(&self, w: Vec3<F>) -> ([F; 2], F, F::Mask) {
        let Frame { s, t, n } = self.frame;
        let (x, y, z) = (Vec3::uniform(s).dot(w), Vec3::uniform(t).dot(w), Vec3::uniform(n).dot(w));
        let [u, v] = [x / (z * self.slopes[0]), y / (z * self.slopes[1])].map(
            #[inline(always)]
            |v| v * 0.5 + 0.5,
        );
        let inside = |v: F| v.ge(F::ZERO) & v.le(F::ONE);
        ([u, v], z / w.length(), z.gt(F::ZERO) & inside(u) & inside(v))
    }

    /// What a picture has in directions; black beyond it.
    #[inline(always)]
    pub fn look_up<F: Float, L: Lanes>(
        &self,
        (texture, position): (&Value<Colour>, Vec3),
        w: Vec3<F>,
        readings: &Readings<'_, L>,
    ) -> Light<F> {
        let (uv, _, is_inside) = self.place(w);
        let light = match texture {
            Value::Constant(_) => readings.eval(texture, &ShadingPoint::NOWHERE),
            Value::Texture(_) => Light::from_fn(
                #[inline(always)]
                |i| {
                    if is_inside.to_bits() >> i & 1 == 0 {
                        return Light::ZERO;
                    }
                    readings.of(i).eval(texture, &at([uv[0].lane(i), uv[1].lane(i)], position + w.lane(i)))
                },
            ),
        };
        light.only(is_inside)
    }

    /// The integral over the picture's directions of a function of direction and place in the picture, in sr.
    pub fn mean(&self, of: impl Fn(Vec3, [f32; 2]) -> f32) -> f64 {
        let part = |i: usize| (i as f32 + 0.5) / SIDE as f32;
        let area = 4.0 * f64::from(self.slopes[0]) * f64::from(self.slopes[1]) / (SIDE * SIDE) as f64;
        let places = (0..SIDE * SIDE).map(|i| [part(i % SIDE), part(i / SIDE)]);
        let each = places.map(|uv| {
            let [x, y] = [0, 1].map(|k| (2.0 * uv[k] - 1.0) * self.slopes[k]);
            let w = self.frame.to_world(Vec3::new(x, y, 1.0));
            let cos = 1.0 / f64::from(w.length());
            f64::from(of(w, uv)) * cos * cos * cos * area
        });
        each.sum()
    }
}

/// A place in a picture that is thrown.
fn at(uv: [f32; 2], p: Vec3) -> ShadingPoint {
    ShadingPoint::of(uv, p)
}

/// What a texture has there, in its strongest lane of red, green and blue.
pub(super) fn mean_texture(paint: &Paint<'_>, texture: &Value<Colour>, uv: [f32; 2]) -> f32 {
    let reading =
        Reading { tables: &paint.spectra, lanes: Rgb::default(), textures: &paint.textures, meshes: &[] };
    reading.eval(texture, &at(uv, Vec3::ZERO)).max_lane()
}

impl Projector {
    /// Where it is.
    pub const fn position(&self) -> Vec3 {
        self.position
    }

    /// A direction into the picture, evenly over a screen.
    pub fn direction(&self, u: [f32; 2]) -> Vec3 {
        let [x, y] = [0, 1].map(|k| (2.0 * u[k] - 1.0) * self.thrown.slopes[k]);
        self.thrown.frame.to_world(Vec3::new(x, y, 1.0))
    }

    /// Of the intensity on the axis, what a picture of 1 has in a direction of any length.
    #[inline(always)]
    pub(super) fn share<F: Float>(&self, w: Vec3<F>) -> F {
        let (_, cos, is_inside) = self.thrown.place(w);
        F::select(is_inside, F::ONE / (cos * cos * cos), F::ZERO)
    }

    /// Of what a scene says.
    pub(super) fn of(l: &desc::Projector, paint: &mut Paint<'_>, centre: DVec3) -> Emitter {
        let picture = paint.emission(&desc::Varying::Texture(Box::new(l.picture.clone())));
        let own = || paint.size_of(&l.picture).map_or(1.0, |[w, h]| w as f64 / h as f64);
        let aspect = l.aspect.unwrap_or_else(own);
        let slope = ops::tan(0.5 * l.fov.to_radians() as f32);
        let thrown = Thrown::new(unit(l.axis()), l.up.as_vec3(), [slope, slope / aspect as f32]);
        let part = |i: usize| (i as f32 + 0.5) / SIDE as f32;
        let places = (0..SIDE * SIDE).map(|i| [part(i % SIDE), part(i / SIDE)]);
        let sum: f64 = places.map(|uv| f64::from(mean_texture(paint, &picture, uv))).sum();
        let position = (l.position - centre).as_vec3();
        let mean = sum / (SIDE * SIDE) as f64;
        Emitter::Projector(Self { position, thrown, picture, intensity: l.intensity as f32, mean })
    }
}

impl Shine for Projector {
    const EXTENT: Extent = Extent::None;

    #[inline(always)]
    fn sample_many<F: Float, L: Lanes>(
        &self,
        _: &Geometry,
        (at, _): (&Receiver<F>, [F; 2]),
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        towards(
            (self.position, true),
            at.p,
            #[inline(always)]
            |wi| {
                let picture = self.thrown.look_up((&self.picture, self.position), -wi, readings);
                picture * (self.share(-wi) * self.intensity)
            },
        )
    }

    fn starts_at(&self) -> Option<Vec3> {
        Some(self.position)
    }

    /// Evenly over a screen.
    fn starts_towards(&self, u: [f32; 2]) -> (Vec3, f32) {
        let w = self.direction(u);
        let [x, y] = self.thrown.slopes;
        // A piece of the screen at a distance of 1 along the axis is seen under cos³ of its area.
        let length = w.length();
        (w / length, length * length * length / (4.0 * x * y))
    }

    /// A screen at a distance of 1 is as large as the picture.
    fn power(&self, _: &Geometry, _: f64) -> f64 {
        let [x, y] = self.thrown.slopes.map(f64::from);
        4.0 * x * y * f64::from(self.intensity) * self.mean
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        Some(Reach::Projector { projector: *self, intensity: self.intensity * self.picture.most() })
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        let thrown = Thrown::new(Vec3::new(0.1, 1.0, 0.3).normalize(), Vec3::X, [2.0, 1.5]);
        let (position, picture) = (Vec3::new(0.1, 0.2, -0.1), super::tests::RADIANCE.into());
        let light = Self { position, thrown, picture, intensity: 1.5, mean: 3.0 };
        vec![super::tests::Example::alone("projector", Emitter::Projector(light))]
    }
}
