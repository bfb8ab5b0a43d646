//! A clear sky.

use straal_color::{Light, Matrix3};
use straal_math::simd::Float;
use straal_math::{Affine, DVec3, Vec3, ops};
use straal_scene::desc;

mod model;

use self::model::Model;
use super::cells::{Cells, Drawn, Grid};
use super::environment::turned;
use super::{Emitter, Extent, LightSample, Reach, Receiver, Shine, SunDisc};
use crate::lanes::Lanes;
use crate::paint::Paint;
use crate::shape::Geometry;
use crate::texture::Readings;

/// The sky without the sun; nothing shines from below the horizon.
///
/// Its radiance is a formula. It is drawn by the cells of a grid over the upper half of all directions, so that no sample is lost below the horizon of level
/// ground.
#[derive(Clone, Debug)]
pub struct Sky(Box<Dome>);

#[derive(Clone, Debug)]
struct Dome {
    model: Model,
    /// Straight up.
    up: Vec3,
    /// Towards the sun.
    sun: Vec3,
    scale: f32,
    /// From linear sRGB to the space of its pixels, where that is another.
    to_work: Option<Matrix3>,
    cells: Cells,
}

/// Columns, and rows from straight up to the horizon: steps of 1.4 degrees.
const GRID: [usize; 2] = [256, 64];

/// Places a side at which a cell's radiance is looked up.
const PLACES: usize = 2;

impl Dome {
    /// About a unit vector that leads straight up, with the sun in another, at or above the horizon: see [`Model::new`].
    fn new((model, scale): (Model, f32), axes: [DVec3; 3], sun: DVec3, to_work: Option<Matrix3>) -> Self {
        let [x, up, z] = axes;
        let grid = |is_compensated| {
            let [columns, rows] = GRID;
            Grid { columns, rows, half_turn: 2 * rows, axes, is_compensated }
        };
        let none = Cells::new(Grid { columns: 1, rows: 1, half_turn: 2, ..grid(false) }, |_, _| 0.0);
        let mut sky = Self { model, up: up.as_vec3(), sun: sun.as_vec3(), scale, to_work, cells: none };
        let part = |i: usize, k: usize| i as f64 + (k as f64 + 0.5) / PLACES as f64;
        let cells = Cells::new(grid(false), |i, j| {
            let each = (0..PLACES * PLACES).map(|k| {
                let (across, down) = (part(i, k % PLACES), part(j, k / PLACES));
                let (s, c) = ops::sin_cos_degrees(360.0 * (across + 0.5) / GRID[0] as f64);
                let (sin, cos) = ops::sin_cos_degrees(90.0 * down / GRID[1] as f64);
                let d = (x * s - z * c) * sin + up * cos;
                f64::from(sky.rgb(d.as_vec3()).max_lane())
            });
            each.sum::<f64>() / (PLACES * PLACES) as f64
        });
        sky.cells = cells;
        sky
    }

    /// Its pixels.
    #[inline(always)]
    fn rgb<F: Float>(&self, wi: Vec3<F>) -> Light<F> {
        let (axis, sun) = (Vec3::uniform(self.up), Vec3::uniform(self.sun));
        let up = axis.dot(wi);
        let (sin, cos) = (sun.cross(wi).length(), sun.dot(wi));
        // By its tangent: near the sun the cosine has lost the angle.
        let angle = ops::atan2(sin, cos);
        let [r, g, b] = self.model.radiance(up.max(F::ZERO), (angle, cos));
        let mut rgb = [r, g, b];
        if let Some(Matrix3(m)) = &self.to_work {
            let row = |k: usize| r * m[k][0] as f32 + g * m[k][1] as f32 + b * m[k][2] as f32;
            rgb = [0, 1, 2].map(
                #[inline(always)]
                |k| row(k).max(F::ZERO),
            );
        }
        let [r, g, b] = rgb.map(
            #[inline(always)]
            |v| v * self.scale,
        );
        Light([r, g, b, F::ZERO]).only(up.ge(F::ZERO))
    }
}

impl Sky {
    /// Of what a scene says, without the sun.
    pub(super) fn of(l: &desc::Sky, paint: &mut Paint<'_>, _: DVec3) -> Emitter {
        let (axes, sun) = placed(l);
        let albedo = paint.albedo(&l.ground_albedo);
        let elevation = std::f64::consts::FRAC_PI_2 - angle(axes[1], sun);
        let model = Model::new(l.turbidity, albedo, elevation);
        let to_work = paint.pixels_to_work();
        Emitter::Sky(Self(Box::new(Dome::new((model, l.sky_scale as f32), axes, sun, to_work))))
    }
}

/// The sky's axes and the sun's direction in the world.
fn placed(l: &desc::Sky) -> ([DVec3; 3], DVec3) {
    let placed = Affine::rotate(DVec3::Y, l.rotate)
        .zip(l.transform.affine())
        .map_or(Affine::IDENTITY, |(turn, own)| turn.then(&own));
    let [x, y, z] = turned(&placed).unwrap_or([DVec3::X, DVec3::Y, DVec3::Z]);
    let sun = l.towards_sun();
    ([x, y, z], (x * sun.x + y * sun.y + z * sun.z).try_normalize().unwrap_or(y))
}

/// The angle between two unit vectors, in radians.
fn angle(a: DVec3, b: DVec3) -> f64 {
    ops::atan2_d(a.cross(b).length(), a.dot(b))
}

impl SunDisc {
    /// The sun in a sky that a scene describes; `None` where it doesn't shine.
    pub(crate) fn of_sky(l: &desc::Sky, paint: &mut Paint<'_>) -> Option<Emitter> {
        let (axes, sun) = placed(l);
        let irradiance = match &l.sun_irradiance {
            Some(said) => paint.emission_times(said, l.sun_scale),
            None => {
                let degrees = 90.0 - angle(axes[1], sun).to_degrees();
                let spectrum = model::sun(l.turbidity, degrees).scaled(l.sun_scale);
                paint.emitted(&spectrum, "the sun")
            }
        };
        let disc = Self::towards(sun.as_vec3(), l.sun_angle, irradiance);
        let disc = if l.limb_darkening { disc.darkened() } else { disc };
        (!irradiance.is_black()).then_some(Emitter::Disc(disc))
    }
}

impl Shine for Sky {
    const EXTENT: Extent = Extent::Around;

    #[inline(always)]
    fn sample_many<F: Float, L: Lanes>(
        &self,
        _: &Geometry,
        (at, u): (&Receiver<F>, [F; 2]),
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        let Some(Drawn { wi, is_direction, pdf, .. }) = self.0.cells.draw(u, at.n) else {
            return LightSample::none();
        };
        let radiance = readings.radiance_of_rgb(self.0.rgb(wi));
        let sound = is_direction & !radiance.is_black() & pdf.gt(F::ZERO) & pdf.is_finite();
        LightSample::from_afar(wi, radiance, pdf).only(sound)
    }

    #[inline(always)]
    fn radiance_pdf_from_many<F: Float, L: Lanes>(
        &self,
        at: &Receiver<F>,
        wi: Vec3<F>,
        readings: &Readings<'_, L>,
    ) -> (Light<F>, F) {
        let rgb = self.0.rgb(wi);
        let pdf = self.0.cells.pdf(&self.0.cells.place(wi), at.n);
        (readings.radiance_of_rgb(rgb), F::select(rgb.is_black(), F::ZERO, pdf))
    }

    #[inline(always)]
    fn radiance_from_many<F: Float, L: Lanes>(&self, wi: Vec3<F>, readings: &Readings<'_, L>) -> Light<F> {
        readings.radiance_of_rgb(self.0.rgb(wi))
    }

    #[inline]
    fn pdf_from(&self, at: &Receiver, wi: Vec3) -> f32 {
        if self.0.rgb(wi).is_black() { 0.0 } else { self.0.cells.pdf(&self.0.cells.place(wi), at.n) }
    }

    /// What falls on the scene's disc from all sides.
    fn power(&self, _: &Geometry, disc: f64) -> f64 {
        disc * self.0.cells.total
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        Some(Reach::Around(self.0.cells.irradiance))
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        let sky = |name, turbidity, degrees: f64, to_world: &Affine| {
            let axes = turned(to_world).expect("a rotation");
            let (sin, cos) = ops::sin_cos_degrees(degrees);
            let sun = axes[0] * (0.6 * cos) + axes[1] * sin + axes[2] * (0.8 * cos);
            let model = Model::new(turbidity, [0.3, 0.2, 0.1], degrees.to_radians());
            let sky = Self(Box::new(Dome::new((model, 2.0), axes, sun, None)));
            super::tests::Example::alone(name, Emitter::Sky(sky))
        };
        vec![
            sky("sky at noon", 3.0, 65.0, &Affine::IDENTITY),
            sky("sky in the evening, turned", 6.0, 4.0, &super::tests::turned()),
        ]
    }
}
