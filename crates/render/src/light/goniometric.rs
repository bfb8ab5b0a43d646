//! Lamps whose light was measured by direction.

use std::sync::Arc;

use crate::lanes::{Colour, Lanes};
use crate::texture::{Readings, ShadingPoint, Value};
use straal_math::simd::{Float, Uint};
use straal_math::{DVec3, Frame, Vec3, ops, warp};
use straal_scene::desc;
use straal_scene::photometry::{Photometry, Planes};

use super::{Emitter, Extent, LightSample, Reach, Receiver, Shine, point::towards, strength, unit};
use crate::paint::Paint;
use crate::shape::Geometry;

/// A point that shines in each direction as a goniometer measured it.
#[derive(Clone, Debug)]
pub struct Goniometric {
    position: Vec3,
    /// The zero plane's direction, a quarter turn on, and the axis.
    frame: Frame,
    /// In W/sr where the lamp is brightest.
    intensity: Value<Colour>,
    distribution: Arc<Distribution>,
}

/// Steps around the axis, and from it to the opposite way: measured angles are whole or half degrees nearly always.
const COLUMNS: usize = 360;
const ROWS: usize = 361;

/// A lamp's intensity in parts of its greatest, in steps of angles about its axis.
#[derive(Clone, Debug)]
pub struct Distribution {
    /// Column after column, from the zero plane on.
    shares: Vec<f32>,
    /// The greatest, in cd.
    most: f64,
    /// The integral of the shares over all directions, in sr.
    total: f64,
}

impl Distribution {
    /// Of what was measured.
    pub fn new(lamp: &Photometry) -> Self {
        let direction = |i: usize, j: usize| {
            let ((s, c), (sin, cos)) = (
                ops::sin_cos_degrees(360.0 * i as f64 / COLUMNS as f64),
                ops::sin_cos_degrees(180.0 * j as f64 / (ROWS - 1) as f64),
            );
            DVec3::new(sin * c, sin * s, cos)
        };
        let degrees = |y: f64, x: f64| ops::atan2_d(y, x).to_degrees();
        let candela = |i: usize, j: usize| {
            let d = direction(i, j);
            match lamp.system {
                Planes::C => lamp.at(360.0 * i as f64 / COLUMNS as f64, 180.0 * j as f64 / (ROWS - 1) as f64),
                // Right is the zero plane's direction, up a quarter turn on.
                Planes::B => lamp.at(degrees(d.y, d.z), degrees(d.x, (d.y * d.y + d.z * d.z).sqrt())),
                Planes::A => lamp.at(degrees(d.x, d.z), degrees(d.y, (d.x * d.x + d.z * d.z).sqrt())),
            }
        };
        let all: Vec<f64> = (0..COLUMNS * ROWS).map(|k| candela(k / ROWS, k % ROWS)).collect();
        let most = all.iter().copied().fold(0.0, |a: f64, b| if b > a { b } else { a });
        let shares: Vec<f32> = all.iter().map(|v| if most > 0.0 { (v / most) as f32 } else { 0.0 }).collect();
        // Bands about each row, half of one about the poles.
        let edge = |j: f64| ops::sin_cos_degrees(180.0 * j / (ROWS - 1) as f64).1;
        let band = |j: usize| {
            let last = (ROWS - 1) as f64;
            let (above, below) = (j as f64 - 0.5, j as f64 + 0.5);
            edge(if above > 0.0 { above } else { 0.0 }) - edge(if below < last { below } else { last })
        };
        let around = 2.0 * std::f64::consts::PI / COLUMNS as f64;
        let total = (0..COLUMNS * ROWS).map(|k| f64::from(shares[k]) * band(k % ROWS) * around).sum();
        Self { shares, most, total }
    }

    /// Bytes that it takes.
    pub const BYTES: usize = COLUMNS * ROWS * size_of::<f32>();

    /// The share in a local direction of any length, straight between steps.
    #[inline(always)]
    fn share<F: Float>(&self, w: Vec3<F>) -> F {
        use std::f32::consts::FRAC_1_PI;
        let across = ops::atan2(w.y, w.x) * (0.5 * FRAC_1_PI * COLUMNS as f32);
        let across = F::select(across.lt(F::ZERO), across + COLUMNS as f32, across);
        let down = ops::atan2((w.x * w.x + w.y * w.y).sqrt(), w.z) * (FRAC_1_PI * (ROWS - 1) as f32);
        let column = across.to_uint().min(F::Uint::splat(COLUMNS as u32 - 1));
        let row = down.to_uint().min(F::Uint::splat(ROWS as u32 - 2));
        let (s, t) = (across - F::from_uint(column), down - F::from_uint(row));
        let (zero, one, rows) = (F::Uint::splat(0), F::Uint::splat(1), F::Uint::splat(ROWS as u32));
        let next = column.wrapping_add(one);
        let next = F::Uint::select(next.eq(F::Uint::splat(COLUMNS as u32)), zero, next);
        let pair = |column: F::Uint| {
            let first = column.wrapping_mul(rows).wrapping_add(row);
            let (a, b) = (F::gather(&self.shares, first), F::gather(&self.shares, first.wrapping_add(one)));
            a + (b - a) * t
        };
        let (a, b) = (pair(column), pair(next));
        (a + (b - a) * s).max(F::ZERO)
    }
}

impl Goniometric {
    /// Where it is.
    pub const fn position(&self) -> Vec3 {
        self.position
    }

    /// Any direction, evenly.
    pub fn direction(&self, u: [f32; 2]) -> Vec3 {
        warp::uniform_sphere(u)
    }

    /// Of the greatest intensity, what goes in a direction of any length.
    #[inline(always)]
    pub(super) fn share<F: Float>(&self, w: Vec3<F>) -> F {
        let Frame { s, t, n } = self.frame;
        let local = Vec3::new(Vec3::uniform(s).dot(w), Vec3::uniform(t).dot(w), Vec3::uniform(n).dot(w));
        self.distribution.share(local)
    }

    /// Of what a scene says.
    pub(super) fn of(l: &desc::Goniometric, paint: &mut Paint<'_>, centre: DVec3) -> Emitter {
        let distribution = paint.distribution(&l.file);
        let n = unit(l.axis());
        let zero = l.zero.as_vec3();
        let along = (zero - n * n.dot(zero)).try_normalize();
        let frame = along.map_or_else(|| Frame::from_normal(n), |s| Frame { s, t: s.cross(n), n });
        let intensity = paint.of_luminance(&l.color, l.scale * distribution.most / l.efficacy).into();
        let position = (l.position - centre).as_vec3();
        Emitter::Goniometric(Self { position, frame, intensity, distribution })
    }
}

impl Shine for Goniometric {
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
            |wi| readings.eval(&self.intensity, &ShadingPoint::NOWHERE) * self.share(-wi),
        )
    }

    fn starts_at(&self) -> Option<Vec3> {
        Some(self.position)
    }

    fn power(&self, _: &Geometry, _: f64) -> f64 {
        self.distribution.total * strength(&self.intensity)
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        Some(Reach::Measured { lamp: self.clone(), intensity: strength(&self.intensity) as f32 })
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        let light = |name, lamp: &Photometry| {
            let light = Self {
                position: Vec3::new(0.1, 0.2, -0.1),
                frame: Frame::from_normal(Vec3::new(0.1, 1.0, 0.3).normalize()),
                intensity: super::tests::RADIANCE.into(),
                distribution: Arc::new(Distribution::new(lamp)),
            };
            super::tests::Example::alone(name, Emitter::Goniometric(light))
        };
        vec![
            light("measured lamp", &tests::lamp(Planes::C)),
            light("measured floodlight", &tests::lamp(Planes::B)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::tests::{assert_agrees, monte_carlo};

    pub fn lamp(system: Planes) -> Photometry {
        let (planes, angles) = match system {
            Planes::C => (vec![0.0, 90.0, 180.0, 270.0, 360.0], vec![0.0, 40.0, 120.0, 170.0]),
            _ => (vec![-90.0, 0.0, 30.0, 90.0], vec![-90.0, -10.0, 50.0, 90.0]),
        };
        let candela = (0..planes.len() * angles.len()).map(|i| ((i % 4) * 7 % 5 + 1) as f32).collect();
        let mut lamp = Photometry { system, planes, angles, candela };
        if system == Planes::C {
            let n = lamp.angles.len();
            (0..n).for_each(|j| lamp.candela[4 * n + j] = lamp.candela[j]);
        }
        lamp
    }

    /// What was measured comes out where it was measured, and all of it is the power.
    #[test]
    fn it_shines_as_it_was_measured() {
        for system in [Planes::C, Planes::B, Planes::A] {
            let lamp = lamp(system);
            let table = Distribution::new(&lamp);
            let (mut worst, degrees) = (0.0, |y: f64, x: f64| ops::atan2_d(y, x).to_degrees());
            let integral = monte_carlo(3, 20_000, |u| {
                let w = warp::uniform_sphere(u);
                let d = w.as_dvec3();
                let [x, y, z] = [d.x, d.y, d.z];
                let want = match system {
                    Planes::C => lamp.at(degrees(y, x).rem_euclid(360.0), degrees((x * x + y * y).sqrt(), z)),
                    Planes::B => lamp.at(degrees(y, z), degrees(x, (y * y + z * z).sqrt())),
                    Planes::A => lamp.at(degrees(x, z), degrees(y, (x * x + z * z).sqrt())),
                };
                let got = f64::from(table.share(w)) * table.most;
                // Next to where it ends, half a degree more shines.
                let off = (got - want).abs();
                if want > 0.0 && off > worst && d.z > 0.05 {
                    worst = off;
                }
                f64::from(table.share(w)) * 4.0 * std::f64::consts::PI
            });
            assert!(worst < 0.15, "{system:?}: off by {worst} cd");
            assert_agrees("power", integral, table.total);
        }
    }
}
