//! Shapes: what a ray can hit, and what can shine. This page is the contract; each shape has its file.
//!
//! A [`Geometry`] holds every surface of a world in flat arrays. Shapes answer rays by themselves
//! ([`Geometry::intersect`]); the triangles of a [`TriangleMesh`] are searched by `straal_accel`, and only their
//! surface is rebuilt here. A shape
//!
//! - has [`Geometry::bounds`] that hold all of it, rounded outwards, or `None` when it is unbounded;
//! - gives with [`Geometry::intersect`] the *nearest* t in [`t_min`, `t_max`] of a ray whose direction may have any
//!   length. All but custom shapes are formulas that the search knows ([`Geometry::analytic`]), solved in double precision, so
//!   that the answer is right to the last bits of t at any distance and scale. The hit's u and v are the shape's own
//!   coordinates, named in its file (0 where it has none);
//! - rebuilds with [`Geometry::surface`] the point of a hit: *on* the surface (projected back, not o + t d), with
//!   a bound of its rounding error that is a few units in the last place of its coordinates, the unit geometric normal
//!   `ng` and the unit shading normal `n`. `ng` points out of closed shapes, and follows the right hand from the
//!   first edge or axis to the second on open ones;
//! - tells with [`Geometry::tangents`] how such a point, and its shading normal, move with the texture coordinates: the
//!   first tangent is never zero, and both lie in the surface;
//! - says, when it can shine, its [`Geometry::area`], and samples its points ([`Geometry::sample_area`], pdf by area)
//!   and the directions towards it from a point ([`Geometry::sample_from`], [`Geometry::pdf_from`], pdf by solid
//!   angle). `sample_from` covers every point that is visible from the reference point; it may also return points that
//!   the shape itself hides, whose shadow ray then ends early. `None` is a sample of no value (measure zero, or
//!   numerically so), not an error.
//!
//! To add one: its file, which implements `Form` and gives examples to be tested; its line in the list below; its place in the
//! walk over the scene (`compile/place.rs`); its keys in the description.
//!
//! Rays leave a surface from [`offset::offset_origin`]: outside the error bound, so that they can't hit the surface
//! they leave. There is no epsilon.

use std::fmt;
use std::sync::Arc;

use straal_accel::Shapes;
use straal_math::simd::{self, Float, Mask};
use straal_math::{Bounds, DVec3, Ray, Transform, Vec3};

use offset::End;

pub mod bezier;
pub mod bilinear;
pub mod curve;
pub mod cylinder;
pub mod disc;
mod drawn;
pub mod ellipsoid;
pub mod field;
mod list;
pub mod mesh;
pub mod offset;
pub mod parallelogram;
pub mod part;
pub(crate) mod patch;
pub mod plane;
pub mod revolved;
mod sampling;
pub(crate) mod smooth;
pub mod sphere;
mod spherical;
mod spherical_ellipse;
mod spherical_triangle;
pub mod subdivision;
mod tangents;

pub use bilinear::Bilinear;
pub use curve::Curve;
pub use cylinder::Cylinder;
pub use disc::Disc;
pub use drawn::Drawn;
pub use ellipsoid::Ellipsoid;
pub use field::Field;
pub use mesh::TriangleMesh;
pub use offset::{offset_origin, ray_between};
pub use parallelogram::Parallelogram;
pub use part::Part;
pub use plane::Plane;
pub use revolved::Revolved;
pub use smooth::SMOOTHING_BYTES;
pub use sphere::Sphere;
pub use straal_accel::{Analytic, ShapeHit};
pub use tangents::Tangents;

list::shapes! {
    /// Center and radius.
    Sphere(Sphere),
    /// An affine image of the unit sphere.
    Ellipsoid(Box<Ellipsoid>),
    /// Unbounded plane.
    Plane(Plane),
    /// Center and two half-axes: a disc, or any ellipse.
    Disc(Box<Disc>),
    /// Corner and two edges: a rectangle, or any parallelogram.
    Parallelogram(Box<Parallelogram>),
    /// An affine image of the open unit cylinder.
    Cylinder(Box<Cylinder>),
    /// A curve turned about an axis.
    Revolved(Box<Revolved>),
    /// A patch between four corners.
    Bilinear(Box<Bilinear>),
    /// A piece of a curve.
    Curve(Box<Curve>),
    /// A face of a combination of solids.
    Part(Box<Part>),
    /// A solid told by its distance.
    Field(Box<Field>),
}

/// What a kind of shape answers, by [the contract](self). One that says nothing of its area can't be sampled as a light.
trait Form {
    /// See [`Geometry::bounds`].
    fn bounds(&self) -> Option<Bounds>;

    /// See [`Geometry::analytic`].
    #[inline]
    fn analytic(&self) -> Option<Analytic> {
        None
    }

    /// See [`Geometry::intersect`]: by its formula, if it has one.
    #[inline]
    fn intersect(&self, ray: &Ray) -> Option<ShapeHit> {
        self.analytic()?.intersect(ray)
    }

    /// See [`Geometry::surface`].
    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint;

    /// See [`Geometry::end`].
    #[inline(always)]
    fn end<F: Float>(&self, _near: DVec3<F::Double>) -> Option<End<F>> {
        None
    }

    /// See [`Geometry::tangents`].
    fn tangents(&self, at: &SurfacePoint) -> Tangents;

    /// See [`Geometry::area`].
    fn area(&self) -> Option<f32> {
        None
    }

    /// See [`Geometry::sample_area`].
    #[inline]
    fn sample_area(&self, _u: [f32; 2]) -> Option<AreaSample> {
        None
    }

    /// The density of [`Self::sample_area`] at a point.
    #[inline]
    fn pdf_area(&self, _hit: &SurfacePoint) -> f32 {
        0.0
    }

    /// See [`Geometry::sample_from`]: by area, unless it says otherwise.
    #[inline]
    fn sample_from(&self, p: Vec3, u: [f32; 2]) -> Option<DirSample> {
        by_solid_angle(p, self.sample_area(u)?)
    }

    /// [`Self::sample_from`] for many side by side: one by one, unless it says otherwise.
    #[inline(always)]
    fn sample_from_many<F: Float>(&self, p: Vec3<F>, u: [F; 2]) -> DirSamples<F> {
        DirSamples::one_by_one(
            F::Mask::splat(true),
            #[inline(always)]
            |i| self.sample_from(p.lane(i), [u[0].lane(i), u[1].lane(i)]),
        )
    }

    /// See [`Geometry::pdf_from`].
    #[inline]
    fn pdf_from(&self, p: Vec3, hit: &SurfacePoint) -> f32 {
        solid_angle_pdf(p, hit, self.pdf_area(hit))
    }

    /// See [`Geometry::sample_lit`]: [`Self::sample_from`], unless it says otherwise.
    #[inline]
    fn sample_lit(&self, (p, _): (Vec3, Vec3), u: [f32; 2]) -> Option<DirSample> {
        self.sample_from(p, u)
    }

    /// [`Self::sample_lit`] for many side by side.
    #[inline(always)]
    fn sample_lit_many<F: Float>(&self, (p, _): (Vec3<F>, Vec3<F>), u: [F; 2]) -> DirSamples<F> {
        self.sample_from_many(p, u)
    }

    /// See [`Geometry::pdf_lit`].
    #[inline]
    fn pdf_lit(&self, (p, _): (Vec3, Vec3), hit: &SurfacePoint) -> f32 {
        self.pdf_from(p, hit)
    }

    /// Some for the tests of the contract, each with the equation of its surface.
    #[cfg(test)]
    fn examples(stand: &tests::Setting) -> Vec<tests::Example>;
}

/// A shape that a user of the library brings. It is pure: the same input gives the same bits.
///
/// Custom shapes can be seen, and shine when a ray meets them, but are not sampled as lights.
pub trait CustomShape: fmt::Debug + Send + Sync {
    /// See [`Geometry::bounds`].
    fn bounds(&self) -> Option<Bounds>;
    /// See [`Geometry::intersect`].
    fn intersect(&self, ray: &Ray) -> Option<ShapeHit>;
    /// See [`Geometry::surface`].
    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint;
    /// See [`Geometry::tangents`]; those of a flat surface, unless it says otherwise.
    fn tangents(&self, at: &SurfacePoint) -> Tangents {
        Tangents::about(at.n)
    }
    /// A number that differs when the shape does: it goes into the scene's hash.
    fn fingerprint(&self) -> u64;
}

/// A point of a surface and its neighbourhood.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The point.
    pub p: Vec3,
    /// Bound of the absolute error of each coordinate of `p`: the true surface passes through this box.
    pub p_err: Vec3,
    /// Unit geometric normal, outwards.
    pub ng: Vec3,
    /// Unit shading normal; equal to `ng` on flat surfaces, and not necessarily on its side elsewhere.
    pub n: Vec3,
    /// Texture coordinates.
    pub uv: [f32; 2],
}

impl SurfacePoint {
    /// The point of an instance's object, seen from the world. Its error bound also covers the way back: a ray that
    /// starts at the world point and is brought to object space finds the surface within the bound.
    pub fn to_world(&self, m: &Transform) -> Self {
        let ng = m.normal(self.ng).try_normalize().unwrap_or(self.ng);
        Self {
            p: m.point(self.p),
            p_err: offset::error_through(m, self.p, self.p_err),
            ng,
            n: if self.n == self.ng { ng } else { m.normal(self.n).try_normalize().unwrap_or(ng) },
            uv: self.uv,
        }
    }
}

/// A point drawn from a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaSample {
    /// The point.
    pub point: SurfacePoint,
    /// Its density by area.
    pub pdf_area: f32,
}

/// A direction towards a surface, drawn from a reference point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirSample {
    /// The point of the surface.
    pub point: SurfacePoint,
    /// Unit vector from the reference point to it.
    pub wi: Vec3,
    /// Density by solid angle at the reference point; positive and finite.
    pub pdf: f32,
}

/// Directions towards a surface, side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirSamples<F> {
    /// The point of the surface.
    pub end: End<F>,
    /// Unit vector from the reference point to it.
    pub wi: Vec3<F>,
    /// Density by solid angle at the reference point; 0 where there is no sample of value.
    pub pdf: F,
}

impl<F: Float> DirSamples<F> {
    /// Points that were sampled by area as directions, as [`by_solid_angle`].
    #[inline(always)]
    pub fn by_area(p: Vec3<F>, end: End<F>, pdf_area: F) -> Self {
        let (wi, there) = (end.p - p).normalize_checked();
        let pdf = solid_angle_pdfs(p, (end.p, end.ng), pdf_area);
        Self { end, wi, pdf: F::select(there & pdf.gt(F::ZERO), pdf, F::ZERO) }
    }

    /// Those of some lanes one after the other; nothing in the others.
    #[inline(always)]
    pub fn one_by_one(mask: F::Mask, sample: impl Fn(usize) -> Option<DirSample>) -> Self {
        let mut rows = [[[0.0; 4]; 4]; simd::BLOCK];
        let mut left = mask.to_bits();
        while left != 0 {
            let i = left.trailing_zeros() as usize;
            left &= left - 1;
            if let Some(DirSample { point: s, wi, pdf }) = sample(i) {
                rows[i] = [
                    [s.p.x, s.p.y, s.p.z, pdf],
                    [s.p_err.x, s.p_err.y, s.p_err.z, 0.0],
                    [s.ng.x, s.ng.y, s.ng.z, 0.0],
                    [wi.x, wi.y, wi.z, 0.0],
                ];
            }
        }
        let (p, pdf) = column(&rows, 0);
        let (p_err, ng, wi) = (column(&rows, 1).0, column(&rows, 2).0, column(&rows, 3).0);
        Self { end: End { p, p_err, ng }, wi, pdf }
    }

    /// `yes` where the mask says so, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            end: End::select(mask, yes.end, no.end),
            wi: Vec3::select(mask, yes.wi, no.wi),
            pdf: F::select(mask, yes.pdf, no.pdf),
        }
    }
}

/// A vector and a number of each row.
#[inline(always)]
fn column<F: Float, const K: usize>(rows: &[[[f32; 4]; K]; simd::BLOCK], k: usize) -> (Vec3<F>, F) {
    let [x, y, z, w] = F::from_rows(
        #[inline(always)]
        |i| rows[i][k],
    );
    (Vec3::new(x, y, z), w)
}

/// Every surface of a world.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// Shapes, by their id.
    pub shapes: Vec<Shape>,
    /// What [`Shape::Custom`] points into.
    pub custom: Vec<Arc<dyn CustomShape>>,
    /// Triangle meshes, by their id.
    pub meshes: Vec<TriangleMesh>,
}

impl Shape {
    /// What flat shapes have in common, if it is one.
    #[inline(always)]
    pub(crate) fn patch(&self) -> Option<&patch::Patch> {
        match self {
            Self::Disc(disc) => Some(disc.patch()),
            Self::Parallelogram(parallelogram) => Some(parallelogram.patch()),
            _ => None,
        }
    }
}

/// What the search calls.
impl Shapes for Geometry {
    fn bounds(&self, shape: u32) -> Option<Bounds> {
        Geometry::bounds(self, shape)
    }

    fn intersect(&self, shape: u32, ray: &Ray) -> Option<ShapeHit> {
        Geometry::intersect(self, shape, ray)
    }

    fn analytic(&self, shape: u32) -> Option<Analytic> {
        Geometry::analytic(self, shape)
    }
}

/// A point sampled by area as a direction sampled by solid angle.
#[inline]
pub(crate) fn by_solid_angle(p: Vec3, s: AreaSample) -> Option<DirSample> {
    let wi = (s.point.p - p).try_normalize()?;
    let pdf = solid_angle_pdf(p, &s.point, s.pdf_area);
    // Not where the density by area was 0 or infinite, either.
    if pdf > 0.0 { Some(DirSample { point: s.point, wi, pdf }) } else { None }
}

/// A density by area at `q` as density by solid angle seen from `p`: times distance² / |cos|; 0 where the surface is
/// seen edge-on.
#[inline]
pub(crate) fn solid_angle_pdf(p: Vec3, q: &SurfacePoint, pdf_area: f32) -> f32 {
    solid_angle_pdfs(p, (q.p, q.ng), pdf_area)
}

/// [`solid_angle_pdf`] at points with these normals, one or many side by side.
#[inline(always)]
pub(crate) fn solid_angle_pdfs<F: Float>(p: Vec3<F>, (q, ng): (Vec3<F>, Vec3<F>), pdf_area: F) -> F {
    let d = q - p;
    let d2 = d.length_squared();
    let cos_d = d.dot(ng).abs(); // cosine times distance
    let pdf = pdf_area * d2 * d2.sqrt() / cos_d;
    F::select(pdf.is_finite(), pdf, F::ZERO)
}

/// Double-precision constants and helpers that the shapes share.
pub(crate) mod exact {
    use super::*;
    use straal_math::simd::{Double, Mask};

    /// Half a unit in the last place of single precision, relative.
    pub const HALF_ULP: f64 = 1.0 / (1u64 << 24) as f64;
    /// Far more than the relative error of the few dozen double-precision operations behind any point here
    /// (each 2^-53), and far less than [`HALF_ULP`].
    pub const DOUBLE: f64 = 1.0 / (1u64 << 46) as f64;

    /// Covers the rounding of what single precision can't hold to its full length.
    pub const SUBNORMAL: f64 = f32::MIN_POSITIVE as f64;

    /// A point computed in double precision from quantities no larger than `size`, rounded, with its error bound.
    #[inline(always)]
    pub fn rounded<F: Float>(p: DVec3<F::Double>, size: F::Double) -> (Vec3<F>, Vec3<F>) {
        (Vec3::from_double(p), bound(p, padding(size)))
    }

    /// What [`bound`] needs for a point computed in double precision from quantities no larger than `size`.
    #[inline(always)]
    pub fn padding<D: Double>(size: D) -> D {
        size * DOUBLE + SUBNORMAL
    }

    /// Half a unit in the last place of each coordinate plus `pad`; no rounding makes it less.
    #[inline(always)]
    pub fn bound<F: Float>(p: DVec3<F::Double>, pad: F::Double) -> Vec3<F> {
        // The bound's own rounding, relative.
        const SLACK: f64 = 1.0 + 4.0 * HALF_ULP;
        let (size, pad) = (p.abs() * F::Double::splat(HALF_ULP * SLACK), pad * SLACK);
        Vec3::from_double(size + DVec3::splat(pad))
    }

    /// The vector divided by its length, or another where that is 0 or not finite.
    #[inline(always)]
    pub fn unit_or<D: Double>(v: DVec3<D>, other: DVec3) -> DVec3<D> {
        let (unit, there) = v.normalize_checked();
        if there.all() { unit } else { DVec3::select(there, unit, DVec3::uniform(other)) }
    }

    /// The box around points that are off by at most `size` times [`DOUBLE`], rounded outwards.
    pub fn outward(min: DVec3, max: DVec3, size: f64) -> Bounds {
        let pad = size * DOUBLE;
        let down = |x: f64| ((x - pad) as f32).next_down();
        let up = |x: f64| ((x + pad) as f32).next_up();
        Bounds {
            min: Vec3::new(down(min.x), down(min.y), down(min.z)),
            max: Vec3::new(up(max.x), up(max.y), up(max.z)),
        }
    }

    /// The point o + t d of a ray, in double precision.
    #[inline(always)]
    pub fn at(ray: &Ray, t: f32) -> DVec3 {
        along([ray.o, ray.d], t)
    }

    /// The points o + t d, in double precision.
    #[inline(always)]
    pub fn along<F: Float>([o, d]: [Vec3<F>; 2], t: F) -> DVec3<F::Double> {
        o.to_double() + d.to_double() * t.to_double()
    }

    /// The nearest number in a range: its lower end for what isn't a number.
    pub fn clamped(x: f64, low: f64, high: f64) -> f64 {
        if x > high {
            high
        } else if x > low {
            x
        } else {
            low
        }
    }

    /// Absolute values summed.
    #[inline(always)]
    pub fn size<D: Double>(v: DVec3<D>) -> D {
        v.x.abs() + v.y.abs() + v.z.abs()
    }
}

#[cfg(test)]
pub(crate) mod tests;
