//! The rectangle, and any parallelogram.

use straal_math::simd::{Float, Mask};
use straal_math::{Bounds, DVec3, Ray, Vec3};

use super::drawn::Nearby;
use super::exact::{outward, size};
use super::offset::End;
use super::patch::{Level, Patch};
use super::spherical::{Corners, SphericalRectangle};
use super::{
    Analytic, AreaSample, DirSample, DirSamples, Drawn, Form, ShapeHit, SurfacePoint, Tangents,
    by_solid_angle, solid_angle_pdf,
};

/// A rectangle, or any parallelogram: corner + x a + y b for x and y in [0, 1]. Its normal is a × b.
///
/// Hit and texture coordinates: x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallelogram {
    patch: Patch,
    pdf_area: f32,
    by_cosine: bool,
    nearby: Nearby,
}

impl Parallelogram {
    /// By a corner and two edges that aren't parallel (nothing hits it if they are).
    pub fn new(corner: Vec3, a: Vec3, b: Vec3) -> Self {
        let patch = Patch::new(corner, a, b);
        let nearby = nearby(&patch, Drawn::ByArea);
        Self { patch, pdf_area: (1.0 / patch.area()) as f32, by_cosine: false, nearby }
    }

    /// The same, whose points are drawn in another way where it is seen large, if it is a rectangle.
    pub fn drawn(self, drawn: Drawn) -> Self {
        let Patch { a, b, .. } = self.patch;
        let is_rectangle = a.dot(b).abs() <= 1e-6 * a.length() * b.length() && self.pdf_area.is_finite();
        let drawn = if is_rectangle { drawn } else { Drawn::ByArea };
        let by_cosine = drawn == Drawn::ByProjectedSolidAngle;
        Self { by_cosine, nearby: nearby(&self.patch, drawn), ..self }
    }

    /// What a surface of this normal at `p` sees of it, and how it is drawn there if not evenly.
    #[inline(always)]
    fn seen<F: Float>(&self, (p, n): (Vec3<F>, Vec3<F>)) -> (SphericalRectangle<F>, Option<Corners<F>>) {
        (SphericalRectangle::new(&self.patch, p), self.by_cosine.then(|| Corners::new(&self.patch, (p, n))))
    }

    /// What it shares with other flat shapes.
    #[inline(always)]
    pub(crate) const fn patch(&self) -> &Patch {
        &self.patch
    }

    /// See [`super::Geometry::bounds`].
    pub fn bounds(&self) -> Bounds {
        let Patch { origin: c, a, b, .. } = self.patch;
        let (zero, both) = (DVec3::ZERO, a + b);
        let min = zero.min(a).min(b).min(both);
        let max = zero.max(a).max(b).max(both);
        outward(c + min, c + max, size(c) + size(a) + size(b))
    }

    /// See [`super::Geometry::analytic`].
    #[inline]
    pub fn analytic(&self) -> Analytic {
        Analytic::parallelogram(&self.patch.formula())
    }

    /// See [`super::Geometry::surface`].
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.patch.surface(ray, hit)
    }

    /// See [`super::Geometry::tangents`].
    pub fn tangents(&self) -> Tangents {
        self.patch.tangents()
    }

    /// See [`super::Geometry::area`].
    pub fn area(&self) -> f32 {
        self.patch.area() as f32
    }

    /// See [`super::Geometry::sample_area`].
    #[inline]
    pub fn sample_area(&self, u: [f32; 2]) -> AreaSample {
        AreaSample { point: self.patch.point_at(u), pdf_area: self.pdf_area }
    }

    /// The density of [`Self::sample_area`].
    #[inline]
    pub fn pdf_area(&self) -> f32 {
        self.pdf_area
    }
}

/// From where a rectangle is drawn as it is seen.
fn nearby(patch: &Patch, drawn: Drawn) -> Nearby {
    let Patch { origin, a, b, n, .. } = *patch;
    let radius_squared = 0.25 * (a.length_squared() + b.length_squared());
    drawn.nearby((origin + (a + b) * 0.5).as_vec3(), radius_squared as f32, n.as_vec3())
}

impl Form for Parallelogram {
    fn bounds(&self) -> Option<Bounds> {
        Some(Parallelogram::bounds(self))
    }

    #[inline]
    fn analytic(&self) -> Option<Analytic> {
        Some(Parallelogram::analytic(self))
    }

    #[inline]
    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        Parallelogram::surface(self, ray, hit)
    }

    #[inline(always)]
    fn end<F: Float>(&self, near: DVec3<F::Double>) -> Option<End<F>> {
        Some(Level::uniform(&self.patch).nearest(near))
    }

    fn tangents(&self, _: &SurfacePoint) -> Tangents {
        Parallelogram::tangents(self)
    }

    fn area(&self) -> Option<f32> {
        Some(Parallelogram::area(self))
    }

    #[inline]
    fn sample_area(&self, u: [f32; 2]) -> Option<AreaSample> {
        Some(Parallelogram::sample_area(self, u))
    }

    #[inline]
    fn sample_from(&self, p: Vec3, u: [f32; 2]) -> Option<DirSample> {
        self.sample_lit((p, Vec3::ZERO), u)
    }

    #[inline(always)]
    fn sample_from_many<F: Float>(&self, p: Vec3<F>, u: [F; 2]) -> DirSamples<F> {
        self.sample_lit_many((p, Vec3::splat(F::ZERO)), u)
    }

    #[inline]
    fn pdf_from(&self, p: Vec3, hit: &SurfacePoint) -> f32 {
        self.pdf_lit((p, Vec3::ZERO), hit)
    }

    #[inline(always)]
    fn sample_lit_many<F: Float>(&self, at: (Vec3<F>, Vec3<F>), u: [F; 2]) -> DirSamples<F> {
        let p = at.0;
        let by_area = DirSamples::by_area(p, self.patch.end_at(u), F::splat(self.pdf_area));
        let near = self.nearby.uniform().has(p);
        if !near.any() {
            return by_area;
        }
        let (seen, corners) = self.seen(at);
        let (u, part) = match corners {
            Some(corners) => {
                let u = corners.sample(u);
                (u, corners.pdf(u))
            }
            None => (u, F::ONE),
        };
        let end = self.patch.end_at(seen.sample(u));
        let (wi, there) = (end.p - p).normalize_checked();
        let pdf = F::select(there, part / seen.solid_angle, F::ZERO);
        DirSamples::select(near & seen.is_large(), DirSamples { end, wi, pdf }, by_area)
    }

    #[inline]
    fn sample_lit(&self, at: (Vec3, Vec3), u: [f32; 2]) -> Option<DirSample> {
        if self.nearby.has(at.0) {
            let (seen, corners) = self.seen(at);
            if seen.is_large() {
                let (u, part) = corners.map_or((u, 1.0), |corners| {
                    let u = corners.sample(u);
                    (u, corners.pdf(u))
                });
                let point = self.patch.point_at(seen.sample(u));
                let wi = (point.p - at.0).try_normalize()?;
                return Some(DirSample { point, wi, pdf: part / seen.solid_angle });
            }
        }
        by_solid_angle(at.0, Parallelogram::sample_area(self, u))
    }

    #[inline]
    fn pdf_lit(&self, at: (Vec3, Vec3), hit: &SurfacePoint) -> f32 {
        if self.nearby.has(at.0) {
            let (seen, corners) = self.seen(at);
            if seen.is_large() {
                let part = corners.map_or(1.0, |corners| {
                    let place = self.patch.coordinates(hit.p);
                    corners.pdf(seen.numbers(place))
                });
                return part / seen.solid_angle;
            }
        }
        solid_angle_pdf(at.0, hit, self.pdf_area)
    }

    #[inline]
    fn pdf_area(&self, _: &SurfacePoint) -> f32 {
        Parallelogram::pdf_area(self)
    }

    #[cfg(test)]
    fn examples(stand: &super::tests::Setting) -> Vec<super::tests::Example> {
        use super::tests::Example;
        let super::tests::Setting { center, a, b, .. } = *stand;
        let n = a.as_dvec3().cross(b.as_dvec3());
        let shape = |corner, a, b| super::Shape::Parallelogram(Box::new(Self::new(corner, a, b)));
        let corner = center - a * 0.5 - b * 0.5;
        let level = shape(center, Vec3::Z * stand.scale, Vec3::X * stand.scale);
        let c = n.cross(a.as_dvec3()).normalize().as_vec3() * (0.7 * stand.scale);
        let drawn = |drawn| super::Shape::Parallelogram(Box::new(Self::new(corner, a, c).drawn(drawn)));
        let across = a.as_dvec3().cross(c.as_dvec3());
        vec![
            Example::flat("parallelogram", shape(corner, a, b), corner, n),
            Example::flat("level", level, center, DVec3::Y),
            Example::flat("rectangle by solid angle", drawn(Drawn::BySolidAngle), corner, across),
            Example::flat("rectangle, auto", drawn(Drawn::Auto { both_sides: true }), corner, across),
            Example::flat("rectangle, auto, front", drawn(Drawn::Auto { both_sides: false }), corner, across),
            Example::flat("rectangle by projected", drawn(Drawn::ByProjectedSolidAngle), corner, across),
        ]
    }
}
