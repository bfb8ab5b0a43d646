//! The disc.

use straal_math::simd::{Float, Mask};
use straal_math::{Bounds, DVec3, Ray, Vec3, warp};

use super::drawn::Nearby;
use super::exact::{outward, size};
use super::offset::End;
use super::patch::{Level, Patch};
use super::spherical_ellipse::SphericalEllipse;
use super::{
    Analytic, AreaSample, DirSample, DirSamples, Drawn, Form, ShapeHit, SurfacePoint, Tangents,
    by_solid_angle, sampling, solid_angle_pdf,
};

/// A disc, or an ellipse: center + x a + y b for x² + y² <= 1. Its normal is a × b.
///
/// Hit coordinates: x and y. Texture coordinates: (x + 1) / 2, (y + 1) / 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    patch: Patch,
    pdf_area: f32,
    nearby: Nearby,
}

impl Disc {
    /// By its center and two half-axes (or any conjugate radii) that aren't parallel (nothing hits it if they are).
    pub fn new(center: Vec3, a: Vec3, b: Vec3) -> Self {
        let patch = Patch::new(center, a, b);
        let nearby = nearby(&patch, Drawn::ByArea);
        Self { patch, pdf_area: (1.0 / (std::f64::consts::PI * patch.area())) as f32, nearby }
    }

    /// The same, whose points are drawn in another way where it is seen large, if it is round.
    pub fn drawn(self, drawn: Drawn) -> Self {
        let Patch { a, b, .. } = self.patch;
        let (aa, bb) = (a.length_squared(), b.length_squared());
        let is_round = a.dot(b).abs() <= 1e-6 * aa && (aa - bb).abs() <= 1e-6 * aa;
        let drawn = if is_round && self.pdf_area.is_finite() { drawn } else { Drawn::ByArea };
        Self { nearby: nearby(&self.patch, drawn), ..self }
    }

    /// The round disc about `center` that faces along `normal`; `None` when that has no direction.
    pub fn facing(center: DVec3, normal: DVec3, radius: f64) -> Option<Self> {
        let (a, b) = sampling::tangents(normal.try_normalize()?);
        Some(Self::new(center.as_vec3(), (a * radius).as_vec3(), (b * radius).as_vec3()))
    }

    /// What it shares with other flat shapes.
    #[inline(always)]
    pub(crate) const fn patch(&self) -> &Patch {
        &self.patch
    }

    /// See [`super::Geometry::bounds`].
    pub fn bounds(&self) -> Bounds {
        let Patch { origin: c, a, b, .. } = self.patch;
        let reach = |a: f64, b: f64| (a * a + b * b).sqrt();
        let r = DVec3::new(reach(a.x, b.x), reach(a.y, b.y), reach(a.z, b.z));
        outward(c - r, c + r, size(c) + size(r))
    }

    /// See [`super::Geometry::analytic`].
    #[inline]
    pub fn analytic(&self) -> Analytic {
        Analytic::disc(&self.patch.formula())
    }

    /// See [`super::Geometry::surface`].
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        with_texture(self.patch.surface(ray, hit))
    }

    /// See [`super::Geometry::tangents`].
    pub fn tangents(&self) -> Tangents {
        let Tangents { dpdu, dpdv, .. } = self.patch.tangents();
        Tangents::flat(dpdu * 2.0, dpdv * 2.0)
    }

    /// See [`super::Geometry::area`].
    pub fn area(&self) -> f32 {
        (std::f64::consts::PI * self.patch.area()) as f32
    }

    /// See [`super::Geometry::sample_area`].
    #[inline]
    pub fn sample_area(&self, u: [f32; 2]) -> AreaSample {
        let point = with_texture(self.patch.point_at(warp::concentric_disc(u)));
        AreaSample { point, pdf_area: self.pdf_area }
    }

    /// The density of [`Self::sample_area`].
    #[inline]
    pub fn pdf_area(&self) -> f32 {
        self.pdf_area
    }
}

/// From where a round disc is drawn as it is seen.
fn nearby(patch: &Patch, drawn: Drawn) -> Nearby {
    let Patch { origin, a, n, .. } = *patch;
    drawn.nearby(origin.as_vec3(), a.length_squared() as f32, n.as_vec3())
}

impl Form for Disc {
    fn bounds(&self) -> Option<Bounds> {
        Some(Disc::bounds(self))
    }

    #[inline]
    fn analytic(&self) -> Option<Analytic> {
        Some(Disc::analytic(self))
    }

    #[inline]
    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        Disc::surface(self, ray, hit)
    }

    #[inline(always)]
    fn end<F: Float>(&self, near: DVec3<F::Double>) -> Option<End<F>> {
        Some(Level::uniform(&self.patch).nearest(near))
    }

    fn tangents(&self, _: &SurfacePoint) -> Tangents {
        Disc::tangents(self)
    }

    fn area(&self) -> Option<f32> {
        Some(Disc::area(self))
    }

    #[inline]
    fn sample_area(&self, u: [f32; 2]) -> Option<AreaSample> {
        Some(Disc::sample_area(self, u))
    }

    #[inline(always)]
    fn sample_from_many<F: Float>(&self, p: Vec3<F>, u: [F; 2]) -> DirSamples<F> {
        let by_area =
            DirSamples::by_area(p, self.patch.end_at(warp::concentric_disc(u)), F::splat(self.pdf_area));
        let near = self.nearby.uniform().has(p);
        if !near.any() {
            return by_area;
        }
        let seen = SphericalEllipse::new(&self.patch, p);
        let (xy, pdf) = seen.sample(&self.patch, u);
        let end = self.patch.end_at(xy);
        let (wi, there) = (end.p - p).normalize_checked();
        let pdf = F::select(there, pdf, F::ZERO);
        DirSamples::select(near & seen.is_large(), DirSamples { end, wi, pdf }, by_area)
    }

    #[inline]
    fn sample_from(&self, p: Vec3, u: [f32; 2]) -> Option<DirSample> {
        if self.nearby.has(p) {
            let seen = SphericalEllipse::new(&self.patch, p);
            if seen.is_large() {
                let (xy, pdf) = seen.sample(&self.patch, u);
                let point = with_texture(self.patch.point_at(xy));
                let wi = (point.p - p).try_normalize()?;
                return Some(DirSample { point, wi, pdf });
            }
        }
        by_solid_angle(p, Disc::sample_area(self, u))
    }

    #[inline]
    fn pdf_from(&self, p: Vec3, hit: &SurfacePoint) -> f32 {
        if self.nearby.has(p) {
            let seen = SphericalEllipse::new(&self.patch, p);
            if seen.is_large() {
                return seen.pdf(hit.p - p);
            }
        }
        solid_angle_pdf(p, hit, self.pdf_area)
    }

    #[inline]
    fn pdf_area(&self, _: &SurfacePoint) -> f32 {
        Disc::pdf_area(self)
    }

    #[cfg(test)]
    fn examples(stand: &super::tests::Setting) -> Vec<super::tests::Example> {
        use super::tests::Example;
        let super::tests::Setting { center, a, b, .. } = *stand;
        let n = a.as_dvec3().cross(b.as_dvec3());
        let c = n.cross(a.as_dvec3()).normalize().as_vec3() * a.length();
        let (round, across) =
            (Self::new(center, a, c).drawn(Drawn::BySolidAngle), a.as_dvec3().cross(c.as_dvec3()));
        vec![
            Example::flat("disc", super::Shape::Disc(Box::new(Self::new(center, a, b))), center, n),
            Example::flat("disc by solid angle", super::Shape::Disc(Box::new(round)), center, across),
        ]
    }
}

/// The square around the disc as texture coordinates, instead of the patch's own.
#[inline(always)]
fn with_texture(point: SurfacePoint) -> SurfacePoint {
    let [x, y] = point.uv;
    SurfacePoint { uv: [0.5 + 0.5 * x, 0.5 + 0.5 * y], ..point }
}
