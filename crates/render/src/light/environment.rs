//! Light from all around: one radiance, a gradient, or a picture.

use crate::lanes::{Colour, Lanes};
use crate::texture::{Reading, Readings, ShadingPoint, Value};
use straal_color::Light;
use straal_math::simd::{Float, Mask, Uint};
use straal_math::table::Table1;
use straal_math::{Affine, DVec3, Frame, Vec3, ops, warp};
use straal_scene::{Image, desc, value};

use super::cells::{Cells, Drawn, Grid, Place};
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

/// The part of what even surroundings bring for which they are picked beside other lights. The rays that a surface scatters find their light by themselves, as well as
/// points drawn on them would; the picks are wanted for what these don't find. Beside a sun (`ortho`, 64 samples) a tenth and a twentieth give the same error, a half gives a half more.
const LEFT_TO_SEEK: f64 = 0.1;

impl ConstantEnvironment {
    /// Of what a scene says of surroundings: this, or a picture.
    pub(super) fn of(l: &desc::Environment, paint: &mut Paint<'_>, _: DVec3) -> Emitter {
        if let Some(file) = &l.file {
            return ImageEnvironment::of(l, file, paint);
        }
        if !l.gradient.is_empty() {
            return ImageEnvironment::of_gradient(l, paint);
        }
        let black = desc::Spectrum::grey(0.0);
        let radiance = l.radiance.as_ref().unwrap_or(&black);
        let radiance = paint.emission_times(radiance, l.factor()).into();
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
        at: &Receiver<F>,
        wi: Vec3<F>,
        readings: &Readings<'_, L>,
    ) -> (Light<F>, F) {
        (readings.eval(&self.radiance, &ShadingPoint::NOWHERE), self.pdfs(at.n, wi))
    }

    #[inline]
    fn pdf_from(&self, at: &Receiver, wi: Vec3) -> f32 {
        self.pdfs(at.n, wi)
    }

    /// What falls on the scene's disc from all sides.
    fn power(&self, _: &Geometry, disc: f64) -> f64 {
        4.0 * std::f64::consts::PI * disc * strength(&self.radiance)
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        let irradiance = std::f64::consts::PI * strength(&self.radiance);
        Some(Reach::Around([(irradiance * LEFT_TO_SEEK) as f32; 6]))
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
    /// Row by row from the top; at least two rows.
    pixels: Vec<[f32; 3]>,
    /// Between four pixels each.
    cells: Cells,
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
        at: &Receiver<F>,
        wi: Vec3<F>,
        readings: &Readings<'_, L>,
    ) -> (Light<F>, F) {
        let place = self.cells.place(wi);
        (readings.radiance_of_rgb(self.interpolate(&place)), self.cells.pdf(&place, at.n))
    }

    #[inline(always)]
    fn radiance_from_many<F: Float, L: Lanes>(&self, wi: Vec3<F>, readings: &Readings<'_, L>) -> Light<F> {
        readings.radiance_of_rgb(self.interpolate(&self.cells.place(wi)))
    }

    #[inline]
    fn pdf_from(&self, at: &Receiver, wi: Vec3) -> f32 {
        self.pdf(at.n, wi)
    }

    fn power(&self, _: &Geometry, disc: f64) -> f64 {
        ImageEnvironment::power(self, disc)
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        Some(Reach::Around(self.cells.irradiance))
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

impl ImageEnvironment {
    /// Bytes that a pixel takes: its colour, and its places in the tables that it is chosen by.
    pub const BYTES_A_PIXEL: usize = size_of::<[f32; 3]>() + Table1::BYTES;

    /// Bytes of tables that don't grow with the picture, once it has a few hundred pixels.
    pub const BYTES: usize = Facing::BYTES;

    /// Bytes that it takes besides while the tables are made: a weight in double precision and one in single.
    pub const MAKING_BYTES_A_PIXEL: usize = size_of::<f64>() + size_of::<f32>();

    /// A picture times `scale` in each channel, turned and mirrored as `to_world` does it (its scaling and translation don't matter). NaN counts as 0, what is
    /// infinite as the most that a sum of it can hold, and a pixel without any channel above 0 is black. Single channels below 0 are of colours that the
    /// picture's space doesn't hold: for wavelengths only. `None` when the picture has no pixels, or not as many as it says, or
    /// the map is singular.
    pub fn new(image: &Image, scale: f32, to_world: &Affine) -> Option<Self> {
        Self::with(image, ([scale; 3], false), to_world)
    }

    /// The same times a factor for each channel; whether directions are drawn with MIS compensation.
    fn with(image: &Image, (scale, is_compensated): ([f32; 3], bool), to_world: &Affine) -> Option<Self> {
        let (width, mut height) = (image.width, image.height);
        if width == 0 || height == 0 || width.checked_mul(height)? != image.pixels.len() {
            return None;
        }
        let axes = turned(to_world)?;
        let lit = |p: &[f32; 3]| {
            let p = [0, 1, 2].map(|c| match p[c] * scale[c] {
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
        // Columns up to the first again.
        let lane = |x: usize, y: usize| {
            f64::from(Light::rgb(pixels[y * width + if x < width { x } else { 0 }]).max_lane())
        };
        let mean =
            |i: usize, j: usize| 0.25 * (lane(i, j) + lane(i + 1, j) + lane(i, j + 1) + lane(i + 1, j + 1));
        let grid = Grid { columns: width, rows: height - 1, half_turn: height - 1, axes, is_compensated };
        let cells = Cells::new(grid, mean);
        Some(Self { width, pixels, cells })
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
        Self::placed(l, &paint.surroundings(file, image), paint.tint(&l.tint).map(|t| t * l.factor()))
    }

    /// From one colour to the next, from straight above to straight below: a picture with a row for each of some steps.
    fn of_gradient(l: &desc::Environment, paint: &mut Paint<'_>) -> Emitter {
        /// Rows between two colours, and columns: as fine as directions are drawn.
        const STEPS: usize = 16;
        const COLUMNS: usize = 32;
        let colours: Vec<[f32; 3]> = l.gradient.iter().map(|s| paint.as_pixel(s)).collect();
        let last = colours.len() - 1;
        let height = last * STEPS + 1;
        let row = |j: usize| {
            let (above, part) = (j / STEPS, (j % STEPS) as f32 / STEPS as f32);
            let below = (above + 1).min(last);
            [0, 1, 2].map(|c| colours[above][c] + (colours[below][c] - colours[above][c]) * part)
        };
        let pixels = (0..height * COLUMNS).map(|i| row(i / COLUMNS)).collect();
        let image = Image { width: COLUMNS, height, pixels };
        Self::placed(l, &image, [l.factor(); 3])
    }

    /// As a scene places it, times a factor for each channel; black if it has no pixels.
    fn placed(l: &desc::Environment, image: &Image, factor: [f64; 3]) -> Emitter {
        // The scene language has the middle column along -z, the emitter its left edge: half a turn.
        let placed = Affine::rotate(DVec3::Y, 180.0 + l.rotate)
            .zip(l.transform.affine())
            .map_or(Affine::IDENTITY, |(turn, own)| turn.then(&own));
        let map = Self::with(image, (factor.map(|v| v as f32), l.compensate), &placed);
        let black = || Emitter::Constant(ConstantEnvironment { radiance: Colour::default().into() });
        map.map_or_else(black, |map| Emitter::Image(Box::new(map)))
    }

    /// See [`super::Emitter::radiance_from`].
    pub fn radiance<L: Lanes>(&self, wi: Vec3, reading: &Reading<'_, L>) -> Light {
        reading.radiance_of_rgb(self.interpolate(&self.cells.place(wi)))
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
        let Some(Drawn { wi, is_direction, place, pdf }) = self.cells.draw(u, n) else {
            return LightSample::none();
        };
        let radiance = readings.radiance_of_rgb(self.interpolate(&place));
        let sound = is_direction & !radiance.is_black() & pdf.gt(F::ZERO) & pdf.is_finite();
        LightSample::from_afar(wi, radiance, pdf).only(sound)
    }

    /// See [`super::Emitter::pdf_from`].
    pub fn pdf(&self, n: Vec3, wi: Vec3) -> f32 {
        self.cells.pdf(&self.cells.place(wi), n)
    }

    /// What falls on the scene's disc from all sides.
    pub fn power(&self, disc: f64) -> f64 {
        disc * self.cells.total
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

/// The axes of what is turned by the rotation in a map; `None` when that is singular.
pub(super) fn turned(to_world: &Affine) -> Option<[DVec3; 3]> {
    let x = to_world.vector(DVec3::X).try_normalize()?;
    let y = to_world.vector(DVec3::Y);
    let y = (y - x * x.dot(y)).try_normalize()?;
    // A mirror image stays one.
    let z = if to_world.determinant() < 0.0 { y.cross(x) } else { x.cross(y) };
    Some([x, y, z])
}
