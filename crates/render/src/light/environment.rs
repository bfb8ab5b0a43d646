//! Light from all around: one radiance, or a picture.

use crate::lanes::{Colour, Lanes};
use crate::texture::{Reading, Readings, ShadingPoint, Value};
use straal_color::Light;
use straal_math::simd::{Double, Float, Mask, Uint};
use straal_math::table::Table1;
use straal_math::{Affine, DVec3, Frame, Vec3, ops, warp};
use straal_scene::{Image, desc, value};

use super::cube::latitude_longitude;
use super::equal_area;
use super::facing::Facing;
use super::{Emitter, Extent, LightSample, Reach, Receiver, Shine, strength};
use crate::camera::CubeLayout;
use crate::paint::Paint;
use crate::shape::Geometry;

/// The same radiance from everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantEnvironment {
    /// Radiance in W/(m² sr).
    pub radiance: Value<Colour>,
}

impl ConstantEnvironment {
    /// Of what a scene says of surroundings: this, or a picture.
    pub(super) fn of(l: &desc::Environment, paint: &mut Paint<'_>, _: DVec3) -> Emitter {
        if let Some(file) = &l.file {
            return ImageEnvironment::of(l, file, paint);
        }
        let black = desc::Spectrum::grey(0.0);
        let radiance = l.radiance.as_ref().unwrap_or(&black);
        let radiance = paint.emission_times(radiance, l.scale).into();
        Emitter::Constant(Self { radiance })
    }

    /// By the cosine where a normal is known.
    #[inline(always)]
    fn pdfs<F: Float>(&self, n: Vec3<F>, wi: Vec3<F>) -> F {
        if self.radiance.most() == 0.0 {
            return F::ZERO;
        }
        let everywhere = Receiver { p: n, n }.is_anywhere();
        let by_cosine = warp::cosine_hemisphere_pdf(n.dot(wi));
        F::select(everywhere, F::splat(warp::uniform_sphere_pdf()), by_cosine)
    }
}

impl Shine for ConstantEnvironment {
    const EXTENT: Extent = Extent::Around;

    #[inline(always)]
    fn sample_many<F: Float, L: Lanes>(
        &self,
        _: &Geometry,
        (at, u): (&Receiver<F>, [F; 2]),
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        let radiance = readings.eval(&self.radiance, &ShadingPoint::NOWHERE);
        let everywhere = at.is_anywhere();
        let mut wi = Vec3::splat(F::ZERO);
        let mut there = everywhere;
        if everywhere.any() {
            wi = warp::uniform_sphere(u);
        }
        if !everywhere.all() {
            let above = Frame::from_normal(at.n).to_world(warp::cosine_hemisphere(u)).normalize_checked();
            (wi, there) = (Vec3::select(everywhere, wi, above.0), there | above.1);
        }
        let pdf = self.pdfs(at.n, wi);
        LightSample::from_afar(wi, radiance, pdf).only(there & !radiance.is_black() & pdf.gt(F::ZERO))
    }

    #[inline(always)]
    fn radiance_pdf_from_many<F: Float, L: Lanes>(
        &self,
        n: Vec3<F>,
        wi: Vec3<F>,
        readings: &Readings<'_, L>,
    ) -> (Light<F>, F) {
        (readings.eval(&self.radiance, &ShadingPoint::NOWHERE), self.pdfs(n, wi))
    }

    #[inline]
    fn pdf_from(&self, n: Vec3, wi: Vec3) -> f32 {
        self.pdfs(n, wi)
    }

    /// What falls on the scene's disc from all sides.
    fn power(&self, _: &Geometry, disc: f64) -> f64 {
        4.0 * std::f64::consts::PI * disc * strength(&self.radiance)
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        Some(Reach::Around([std::f32::consts::PI * strength(&self.radiance) as f32; 6]))
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        let light = Self { radiance: super::tests::RADIANCE.into() };
        vec![super::tests::Example::alone("constant", Emitter::Constant(light))]
    }
}

/// A picture in latitude and longitude.
///
/// A local direction d has the place u = atan2(d.x, -d.z) / 2 pi, v = acos(d.y) / pi: the top row is +y, the left edge is
/// -z, a quarter of the way to the right is +x. Across, pixels are centered at (i + 1/2) / width and wrap round; down, the
/// first and last rows lie on the poles themselves, at j / (height - 1). Between them radiance is bilinear. This is the
/// `envmap` of Mitsuba 3.
///
/// It is sampled by the cells between four neighbouring pixels: one is chosen in proportion to the mean of its corners'
/// strongest lanes times its solid angle, and roughly to the cosine at the surface (`Facing`); within it directions are uniform. Where
/// the interpolated radiance isn't 0 the density isn't either, but behind the surface.
#[derive(Clone, Debug)]
pub struct ImageEnvironment {
    width: usize,
    /// At least 2.
    height: usize,
    /// Row by row from the top.
    pixels: Vec<[f32; 3]>,
    /// Over `width` x (`height` - 1) cells; `None` when all is black.
    cells: Option<Facing>,
    /// Cosine of the polar angle of each row.
    cosines: Vec<f64>,
    /// Of each row of cells its solid angle, times the number of rows: what densities over the unit square are divided by.
    bands: Vec<f64>,
    /// Local x, y and z in the world: an orthonormal frame.
    axes: [Vec3; 3],
    /// Integral of the strongest lane over all directions.
    total: f64,
    /// Of that lane, roughly what falls on surfaces that face +x, -x, +y, -y, +z and -z of the world; 0 only where all is black.
    irradiance: [f32; 6],
}

impl Shine for Box<ImageEnvironment> {
    const EXTENT: Extent = Extent::Around;

    #[inline(always)]
    fn sample_many<F: Float, L: Lanes>(
        &self,
        _: &Geometry,
        (at, u): (&Receiver<F>, [F; 2]),
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        ImageEnvironment::sample_many(self, at.n, u, readings)
    }

    #[inline(always)]
    fn radiance_pdf_from_many<F: Float, L: Lanes>(
        &self,
        n: Vec3<F>,
        wi: Vec3<F>,
        readings: &Readings<'_, L>,
    ) -> (Light<F>, F) {
        let place = self.place(wi);
        (readings.radiance_of_rgb(self.interpolate(&place)), self.pdf_of(&place, n))
    }

    #[inline(always)]
    fn radiance_from_many<F: Float, L: Lanes>(&self, wi: Vec3<F>, readings: &Readings<'_, L>) -> Light<F> {
        readings.radiance_of_rgb(self.interpolate(&self.place(wi)))
    }

    #[inline]
    fn pdf_from(&self, n: Vec3, wi: Vec3) -> f32 {
        self.pdf(n, wi)
    }

    fn power(&self, _: &Geometry, disc: f64) -> f64 {
        ImageEnvironment::power(self, disc)
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        Some(Reach::Around(self.irradiance))
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        use super::tests::{image, surroundings, turned};
        // Mostly dark, with a lamp of one pixel, one on the wrap, and poles of their own.
        let studio = image(16, 9, |x, y| match (x, y) {
            (3, 4) => [100.0, 80.0, 60.0],
            (15, 5) => [0.0, 0.0, 50.0],
            (_, 0) => [1.0; 3],
            (_, 8) => [0.0; 3],
            (x, y) if (x + y) % 3 == 0 => [0.2, 0.1, 0.3],
            _ => [0.0; 3],
        });
        vec![
            surroundings("image", &studio, &Affine::IDENTITY),
            surroundings("image, turned", &studio, &turned()),
            surroundings("image, smallest", &image(1, 1, |_, _| [1.0, 2.0, 3.0]), &Affine::IDENTITY),
            surroundings("image, rows", &image(2, 3, |_, y| [y as f32; 3]), &turned()),
        ]
    }
}

/// No pixel is brighter, so that sums of pixels are finite.
const MOST: f32 = 1e30;

/// A place between four pixels, or many side by side.
struct Place<F: Float> {
    column: F::Uint,
    row: F::Uint,
    /// Weights of the next column and row.
    x: F,
    y: F,
}

impl ImageEnvironment {
    /// Bytes that a pixel takes: its colour, and its places in the tables that it is chosen by.
    pub const BYTES_A_PIXEL: usize = size_of::<[f32; 3]>() + Table1::BYTES;

    /// Bytes of tables that don't grow with the picture, once it has a few hundred pixels.
    pub const BYTES: usize = Facing::BYTES;

    /// Bytes that it takes besides while the tables are made: a weight in double precision and one in single.
    pub const MAKING_BYTES_A_PIXEL: usize = size_of::<f64>() + size_of::<f32>();

    /// A picture times `scale`, turned and mirrored as `to_world` does it (its scaling and translation don't matter). NaN counts as 0, what is
    /// infinite as the most that a sum of it can hold, and a pixel without any channel above 0 is black. Single channels below 0 are of colours that the
    /// picture's space doesn't hold: for wavelengths only. `None` when the picture has no pixels, or not as many as it says, or
    /// the map is singular.
    pub fn new(image: &Image, scale: f32, to_world: &Affine) -> Option<Self> {
        let (width, mut height) = (image.width, image.height);
        if width == 0 || height == 0 || width.checked_mul(height)? != image.pixels.len() {
            return None;
        }
        let x = to_world.vector(DVec3::X).try_normalize()?;
        let y = to_world.vector(DVec3::Y);
        let y = (y - x * x.dot(y)).try_normalize()?;
        // A mirror image stays one.
        let z = if to_world.determinant() < 0.0 { y.cross(x) } else { x.cross(y) };
        let axes = [x, y, z].map(DVec3::as_vec3);

        let lit = |p: &[f32; 3]| {
            let p = p.map(|v| match v * scale {
                scaled if scaled.is_nan() || scaled < -MOST => 0.0,
                scaled => ops::min(scaled, MOST),
            });
            if p.iter().any(|v| *v > 0.0) { p } else { [0.0; 3] }
        };
        let mut pixels: Vec<[f32; 3]> = image.pixels.iter().map(lit).collect();
        if height == 1 {
            pixels.extend_from_within(..);
            height = 2;
        }

        let cosines: Vec<f64> =
            (0..height).map(|j| ops::sin_cos_degrees(180.0 * j as f64 / (height - 1) as f64).1).collect();
        let lane = |x: usize, y: usize| f64::from(Light::rgb(pixels[y * width + x % width]).max_lane());
        let mut weights = Vec::with_capacity(width * (height - 1));
        let mut irradiance = [0.0; 6];
        // Across: where the middle of a cell lies.
        let around: Vec<DVec3> = (0..width)
            .map(|i| {
                let (s, c) = ops::sin_cos_degrees(360.0 * (i + 1) as f64 / width as f64);
                x * s - z * c
            })
            .collect();
        for j in 0..height - 1 {
            let band = cosines[j] - cosines[j + 1];
            let up = 0.5 * (cosines[j] + cosines[j + 1]);
            let out = (1.0 - up * up).sqrt();
            for (i, around) in around.iter().enumerate() {
                let sum = lane(i, j) + lane(i + 1, j) + lane(i, j + 1) + lane(i + 1, j + 1);
                let weight = 0.25 * sum * band * (2.0 * std::f64::consts::PI / width as f64);
                weights.push(weight);
                let d = (*around * out + y * up) * weight;
                for (axis, v) in [d.x, d.y, d.z].into_iter().enumerate() {
                    irradiance[2 * axis + usize::from(v < 0.0)] += v.abs();
                }
            }
        }
        let total: f64 = weights.iter().sum();
        // A quarter of the mean over all sides: between six directions a small sun must not be forgotten.
        let irradiance = irradiance.map(|v: f64| (0.75 * v + 0.0625 * total) as f32);
        let most = weights.iter().copied().fold(0.0, |a: f64, b| if b > a { b } else { a });
        let relative: Vec<f32> = weights.iter().map(|w| (w / most) as f32).collect();
        // As rows of cells are bands between two rows of pixels, and columns lie between the middles of two.
        let direction = |across: f64, down: f64| {
            let rows = down * (height - 1) as f64;
            let row = (rows as usize).min(height - 2);
            let up = cosines[row] + (cosines[row + 1] - cosines[row]) * (rows - row as f64);
            let (s, c) = ops::sin_cos_degrees(360.0 * (across + 0.5 / width as f64));
            (x * s - z * c) * (1.0 - up * up).abs().sqrt() + y * up
        };
        let cells = Facing::new([width, height - 1], &relative, direction);
        let band = |c: &[f64]| 2.0 * std::f64::consts::PI * (c[0] - c[1]) * (height - 1) as f64;
        let bands = cosines.windows(2).map(band).collect();
        Some(Self { width, height, pixels, cells, cosines, bands, axes, total, irradiance })
    }

    /// Of what a scene says of a picture; black if it has no pixels.
    fn of(l: &desc::Environment, asset: &value::Asset<Image>, paint: &mut Paint<'_>) -> Emitter {
        let (file, image) = (&asset.file, paint.assets().image(asset.handle));
        let cube = match l.layout {
            desc::EnvironmentLayout::LatitudeLongitude | desc::EnvironmentLayout::EqualArea => None,
            desc::EnvironmentLayout::Cross => Some(CubeLayout::Cross),
            desc::EnvironmentLayout::Row => Some(CubeLayout::Row),
        };
        let side = l.layout.side(image);
        let unfolded = match (l.layout == desc::EnvironmentLayout::EqualArea, cube, side) {
            (true, _, Some(_)) => Some(equal_area::latitude_longitude(image)),
            (_, Some(layout), Some(side)) => Some(latitude_longitude(image, layout, side)),
            _ => None,
        };
        let image = unfolded.as_ref().unwrap_or(image);
        // The scene language has the middle column along -z, the emitter its left edge: half a turn.
        let placed = Affine::rotate(DVec3::Y, 180.0 + l.rotate)
            .zip(l.transform.affine())
            .map_or(Affine::IDENTITY, |(turn, own)| turn.then(&own));
        let map = Self::new(&paint.surroundings(file, image), l.scale as f32, &placed);
        let black = || Emitter::Constant(ConstantEnvironment { radiance: Colour::default().into() });
        map.map_or_else(black, |map| Emitter::Image(Box::new(map)))
    }

    /// See [`super::Emitter::radiance_from`].
    pub fn radiance<L: Lanes>(&self, wi: Vec3, reading: &Reading<'_, L>) -> Light {
        reading.radiance_of_rgb(self.interpolate(&self.place(wi)))
    }

    /// See [`super::Emitter::sample`].
    pub fn sample<L: Lanes>(&self, n: Vec3, u: [f32; 2], reading: &Reading<'_, L>) -> Option<LightSample> {
        self.sample_many(n, u, &Readings::one(reading)).of_value()
    }

    #[inline(always)]
    fn sample_many<F: Float, L: Lanes>(
        &self,
        n: Vec3<F>,
        u: [F; 2],
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        let Some(cells) = &self.cells else { return LightSample::none() };
        let cell = cells.samples(u, n);
        let (column, row) = (cell.column, cell.row);
        let next = row.wrapping_add(F::Uint::splat(1));
        let (above, below) = (entries::<F>(&self.cosines, row), entries::<F>(&self.cosines, next));
        let cos = above + (below - above) * cell.down;
        let rows = std::f64::consts::FRAC_1_PI * (self.height - 1) as f64;
        let y = ops::acos_d(cos) * rows - F::from_uint(row).to_double();
        let turned = (F::from_uint(column).to_double() + 0.5 + cell.across) * 360.0 / self.width as f64;
        let (s, c) = ops::sin_cos_two_turns(turned);
        let sin = (F::Double::ONE - cos * cos).abs().sqrt();
        let [ax, ay, az] = &self.axes;
        let (ax, ay, az) =
            (DVec3::uniform(ax.as_dvec3()), DVec3::uniform(ay.as_dvec3()), DVec3::uniform(az.as_dvec3()));
        let (wi, there) = (ax * (sin * s) + ay * cos - az * (sin * c)).normalize_checked();
        let y = ops::clamp(F::from_double(y), F::ZERO, F::ONE);
        let place = Place { column, row, x: F::from_double(cell.across), y };
        let radiance = readings.radiance_of_rgb(self.interpolate(&place));
        let pdf = self.density(cell.pdf, row);
        let sound = there & !radiance.is_black() & pdf.gt(F::ZERO) & pdf.is_finite();
        LightSample::from_afar(Vec3::from_double(wi), radiance, pdf).only(sound)
    }

    /// See [`super::Emitter::pdf_from`].
    pub fn pdf(&self, n: Vec3, wi: Vec3) -> f32 {
        self.pdf_of(&self.place(wi), n)
    }

    #[inline(always)]
    fn pdf_of<F: Float>(&self, place: &Place<F>, n: Vec3<F>) -> F {
        let Some(cells) = &self.cells else { return F::ZERO };
        self.density(cells.pdfs([place.column, place.row], n), place.row)
    }

    /// What falls on the scene's disc from all sides.
    pub fn power(&self, disc: f64) -> f64 {
        disc * self.total
    }

    /// A density over the unit square, in a row of cells, as density by solid angle: the square's (height - 1) equal
    /// rows are bands of solid angle 2 pi times a difference of cosines.
    #[inline(always)]
    fn density<F: Float>(&self, over_square: F, row: F::Uint) -> F {
        F::from_double(over_square.to_double() / entries::<F>(&self.bands, row))
    }

    #[inline(always)]
    fn place<F: Float>(&self, wi: Vec3<F>) -> Place<F> {
        use std::f32::consts::FRAC_1_PI;
        let [x, y, z] = &self.axes;
        let (x, y, z) = (Vec3::uniform(*x).dot(wi), Vec3::uniform(*y).dot(wi), Vec3::uniform(*z).dot(wi));
        // In pixels. The polar angle by its tangent: near the poles the cosine has lost it.
        let across = ops::atan2(x, -z) * (0.5 * FRAC_1_PI) * self.width as f32 - 0.5;
        let down = ops::atan2((x * x + z * z).sqrt(), y) * FRAC_1_PI * (self.height - 1) as f32;
        let left = across.floor();
        let row = down.to_uint().min(F::Uint::splat(self.height as u32 - 2));
        // From half a turn to the left of the middle: once around for what lies there.
        let column = left.to_int();
        let around = column.wrapping_add(F::Uint::splat(self.width as u32));
        Place {
            column: F::Uint::select(column.lt_signed(F::Uint::splat(0)), around, column),
            row,
            x: across - left,
            y: ops::clamp(down - F::from_uint(row), F::ZERO, F::ONE),
        }
    }

    #[inline(always)]
    fn interpolate<F: Float>(&self, at: &Place<F>) -> Light<F> {
        let (zero, one) = (F::Uint::splat(0), F::Uint::splat(1));
        let width = F::Uint::splat(self.width as u32);
        let next = at.column.wrapping_add(one);
        let next = F::Uint::select(next.eq(width), zero, next);
        let first = at.row.wrapping_mul(width);
        let columns = [at.column, next];
        let [upper, lower] =
            [self.row(first, columns, at.x), self.row(first.wrapping_add(width), columns, at.x)];
        upper * (F::ONE - at.y) + lower * at.y
    }

    /// Between two pixels of a row.
    #[inline(always)]
    fn row<F: Float>(&self, first: F::Uint, [left, right]: [F::Uint; 2], x: F) -> Light<F> {
        self.pixels_at::<F>(first.wrapping_add(left)) * (F::ONE - x)
            + self.pixels_at::<F>(first.wrapping_add(right)) * x
    }

    #[inline(always)]
    fn pixels_at<F: Float>(&self, index: F::Uint) -> Light<F> {
        let index = index.to_array();
        Light::from_fn(
            #[inline(always)]
            |i| Light::rgb(self.pixels[index.as_ref()[i] as usize]),
        )
    }
}

/// Those of a list with these numbers.
#[inline(always)]
fn entries<F: Float>(list: &[f64], index: F::Uint) -> F::Double {
    let index = index.to_array();
    F::Double::from_fn(
        #[inline(always)]
        |i| list[index.as_ref()[i] as usize],
    )
}
