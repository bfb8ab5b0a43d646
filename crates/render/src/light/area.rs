//! Surfaces that shine.

use crate::lanes::{Colour, Lanes};
use crate::texture::{Reading, Readings, ShadingPoint, Value, own_normal};
use straal_color::Light;
use straal_math::simd::{Float, Mask, Uint};
use straal_math::{Frame, Transform, Vec3, ops, table::Table1, warp};

use super::copies::Stand;
use super::reach::Lamp;
use super::{Ball, Emitted, Extent, LightSample, Reach, Receiver, Shine, Shows, strength};
use crate::material::Material;
use crate::shape::{AreaSample, DirSample, Geometry, Shape, SurfacePoint};

/// A surface that sends the same radiance in every direction on its lit side, or less towards its horizon.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// What shines.
    pub surface: LitSurface,
    /// Radiance in W/(m² sr).
    pub radiance: Value<Colour>,
    /// The share of the surface that is there, where it has a mask: rays that pass through it don't see it shine.
    pub opacity: Option<Value<f32>>,
    /// The material that shines, where light gets out through layers above it.
    pub below: Option<Box<Material>>,
    /// From which sides.
    pub sides: Sides,
    /// How it falls towards the horizon of the surface.
    pub spread: Spread,
    /// Where its own coordinates lie in the world, if its radiance is read off a texture and they are others.
    pub placement: Option<Box<Transform>>,
}

/// The cone around the normal that light stays in, as behind a deep grid of black walls: of the light at an angle θ they let 1 - tan θ / tan (spread / 2) through,
/// which is that of long slits across it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// One over the tangent of its half: 0 where nothing is in the way.
    per_tangent: f32,
}

impl Spread {
    /// So many degrees from rim to rim, up to 180: all of it.
    pub fn degrees(degrees: f64) -> Self {
        let (sin, cos) = ops::sin_cos_degrees(0.5 * degrees);
        Self { per_tangent: if degrees < 180.0 { (cos / sin) as f32 } else { 0.0 } }
    }

    /// The share that gets through in a direction of a cosine to the normal, either side.
    #[inline(always)]
    fn share<F: Float>(self, cos: F) -> F {
        let cos = cos.abs();
        let sin = (F::ONE - cos * cos).max(F::ZERO).sqrt();
        F::select(cos.gt(F::ZERO), (F::ONE - sin / cos * self.per_tangent).max(F::ZERO), F::ZERO)
    }

    /// Of the power of an even surface, what gets through: with t = tan of half the cone a, the integral of 2 (1 - tan θ / t) sin θ cos θ up to a.
    fn of_power(self) -> f64 {
        let k = f64::from(self.per_tangent);
        if k == 0.0 {
            return 1.0;
        }
        let half = ops::atan2_d(1.0, k);
        let (sin, cos) = ops::sin_cos_degrees(half.to_degrees());
        sin * sin - k * (half - sin * cos)
    }

    /// Whether nothing is in the way.
    #[inline(always)]
    fn is_open(self) -> bool {
        self.per_tangent == 0.0
    }
}

/// What shines.
#[derive(Clone, Debug)]
pub enum LitSurface {
    /// A shape of [`Geometry::shapes`]. Planes and custom shapes shine on those who see them, but aren't sampled.
    Shape(u32),
    /// A mesh of [`Geometry::meshes`]: make it with [`LitSurface::mesh`].
    Mesh {
        /// Its id.
        mesh: u32,
        /// Chooses a triangle by its area; `None` when the mesh has no area.
        triangles: Option<Table1>,
        /// Total area in m².
        area: f64,
    },
}

/// The sides of a surface that shine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// The one that the geometric normal points away from the surface on.
    Front,
    /// The other.
    Back,
    /// Both.
    Both,
}

impl LitSurface {
    /// The whole of a mesh.
    pub fn mesh(geometry: &Geometry, mesh: u32) -> Self {
        let m = &geometry.meshes[mesh as usize];
        let areas: Vec<f64> = (0..m.indices.len() as u32).map(|i| m.triangle_area(i)).collect();
        let most = areas.iter().copied().fold(0.0, |a: f64, b| if b > a { b } else { a });
        // Relative to the largest, so that single precision holds them.
        let weights: Vec<f32> = areas.iter().map(|&a| (a / most) as f32).collect();
        Self::Mesh { mesh, triangles: Table1::new(&weights), area: areas.iter().sum() }
    }
}

impl Sides {
    /// Whether the side on which `wo` leaves a surface with normal `ng` shines.
    #[inline(always)]
    fn lit<F: Float>(self, ng: Vec3<F>, wo: Vec3<F>) -> F::Mask {
        let cos = ng.dot(wo);
        match self {
            Self::Front => cos.gt(F::ZERO),
            Self::Back => cos.lt(F::ZERO),
            Self::Both => cos.ne(F::ZERO),
        }
    }
}

impl AreaLight {
    /// See [`super::Emitter::has_size`].
    pub(super) fn has_size(&self, geometry: &Geometry) -> bool {
        match &self.surface {
            LitSurface::Shape(shape) => geometry.area(*shape).is_some(),
            LitSurface::Mesh { triangles, .. } => triangles.is_some(),
        }
    }

    /// See [`super::Emitter::has_rim`]: of balls it is the rim of the cone that they fill.
    pub(super) fn has_rim(&self, geometry: &Geometry) -> bool {
        let LitSurface::Shape(shape) = self.surface else { return false };
        let shape = geometry.shapes.get(shape as usize);
        shape.is_some_and(|shape| {
            use Shape::{Disc, Ellipsoid, Parallelogram, Sphere};
            matches!(shape, Sphere(_) | Ellipsoid(_) | Disc(_) | Parallelogram(_))
        })
    }

    /// [`Emitter::sample_many`](super::Emitter::sample_many), of the triangles with these numbers where they were picked already.
    #[inline(always)]
    pub(super) fn sample_parts<F: Float, L: Lanes>(
        &self,
        geometry: &Geometry,
        (at, u): (&Receiver<F>, [F; 2]),
        part: Option<F::Uint>,
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        let (Value::Constant(radiance), None, None) = (&self.radiance, &self.opacity, &self.below) else {
            // Lanes that picked another lamp have numbers of that.
            let last = match &self.surface {
                LitSurface::Mesh { mesh, .. } => {
                    geometry.meshes[*mesh as usize].indices.len().saturating_sub(1) as u32
                }
                LitSurface::Shape(_) => 0,
            };
            return LightSample::one_by_one(
                #[inline(always)]
                |i| {
                    let u = [u[0].lane(i), u[1].lane(i)];
                    let part = part.map(|part| Ord::min(part.lane(i), last));
                    let at = Receiver { p: at.p.lane(i), n: at.n.lane(i) };
                    self.sample_textured(geometry, (&at, u), part, &readings.of(i))
                },
            );
        };
        let s = match &self.surface {
            LitSurface::Shape(shape) => geometry.sample_lit_many(*shape, (at.p, at.n), u),
            LitSurface::Mesh { mesh, triangles: Some(triangles), .. } => {
                let mesh = &geometry.meshes[*mesh as usize];
                match part {
                    Some(part) => {
                        // Lanes that picked another lamp have numbers of that.
                        let last = F::Uint::splat(mesh.indices.len() as u32 - 1);
                        mesh.sample_triangles_from((part.min(last), F::ONE), at.p, u)
                    }
                    None => {
                        let choice = triangles.samples(u[0]);
                        mesh.sample_triangles_from((choice.index, choice.pmf), at.p, [choice.rest, u[1]])
                    }
                }
            }
            LitSurface::Mesh { triangles: None, .. } => return LightSample::none(),
        };
        let lit = self.sides.lit(s.end.ng, -s.wi) & F::Mask::splat(!radiance.is_black());
        let far = F::Mask::splat(false);
        let mut radiance = readings.light(radiance);
        if !self.spread.is_open() {
            radiance *= self.spread.share(s.end.ng.dot(s.wi));
        }
        let sample = LightSample::from_afar(s.wi, radiance, s.pdf);
        LightSample { far, to: s.end, ..sample }.only(lit)
    }

    /// The density by solid angle at `p` of a point of the surface, of whose triangle is known that it was picked.
    pub(super) fn pdf_of_part(
        &self,
        geometry: &Geometry,
        p: Vec3,
        (primitive, hit): (u32, &SurfacePoint),
    ) -> f32 {
        let LitSurface::Mesh { mesh, .. } = &self.surface else { return 0.0 };
        if self.radiance.most() == 0.0 || !self.sides.lit(hit.ng, p - hit.p) {
            return 0.0;
        }
        geometry.meshes[*mesh as usize].pdf_triangle_from((primitive, 1.0), p, hit)
    }

    /// A point of the surface for a point of its own space, of the triangle with this number where one was picked already.
    fn sample_own(
        &self,
        geometry: &Geometry,
        (at, u): (&Receiver, [f32; 2]),
        part: Option<u32>,
    ) -> Option<DirSample> {
        match &self.surface {
            LitSurface::Shape(shape) => geometry.sample_lit(*shape, (at.p, at.n), u),
            LitSurface::Mesh { mesh, triangles, .. } => {
                let mesh = &geometry.meshes[*mesh as usize];
                if let Some(part) = part {
                    return mesh.sample_triangle_from((part, 1.0), at.p, u);
                }
                let choice = triangles.as_ref()?.sample(u[0]);
                mesh.sample_triangle_from((choice.index as u32, choice.pmf), at.p, [choice.rest, u[1]])
            }
        }
    }

    /// The same by area.
    fn sample_area(&self, geometry: &Geometry, u: [f32; 2], part: Option<u32>) -> Option<AreaSample> {
        match &self.surface {
            LitSurface::Shape(shape) => geometry.sample_area(*shape, u),
            LitSurface::Mesh { mesh, triangles, .. } => {
                let mesh = &geometry.meshes[*mesh as usize];
                if let Some(part) = part {
                    return Some(mesh.sample_triangle(part, u));
                }
                let choice = triangles.as_ref()?.sample(u[0]);
                let mut s = mesh.sample_triangle(choice.index as u32, [choice.rest, u[1]]);
                s.pdf_area *= choice.pmf;
                Some(s)
            }
        }
    }

    /// A sample of radiance that is read at its point.
    #[cold]
    fn sample_textured<L: Lanes>(
        &self,
        geometry: &Geometry,
        from: (&Receiver, [f32; 2]),
        part: Option<u32>,
        reading: &Reading<'_, L>,
    ) -> Option<LightSample> {
        if self.radiance.most() == 0.0 {
            return None;
        }
        let s = self.sample_own(geometry, from, part)?;
        self.arriving(&s, &s.point, reading)
    }

    /// [`super::Emitter::sample_copy`].
    pub(super) fn sample_copy<L: Lanes>(
        &self,
        geometry: &Geometry,
        stand: &Stand<'_>,
        (at, u): (&Receiver, [f32; 2]),
        part: Option<u32>,
        reading: &Reading<'_, L>,
    ) -> Option<LightSample> {
        if self.radiance.most() == 0.0 {
            return None;
        }
        let own = self.sample_own(geometry, (&stand.receiver(at), u), part)?;
        let point = stand.outwards(&own.point);
        let wi = (point.p - at.p).try_normalize()?;
        let pdf = own.pdf * stand.widening(wi);
        let sound = pdf > 0.0 && pdf.is_finite() && point.p.is_finite();
        self.arriving(&DirSample { point, wi, pdf }, &own.point, reading).filter(|_| sound)
    }

    /// What comes from a point that was found, which its own space has elsewhere.
    fn arriving<L: Lanes>(
        &self,
        s: &DirSample,
        own: &SurfacePoint,
        reading: &Reading<'_, L>,
    ) -> Option<LightSample> {
        if !self.sides.lit(s.point.ng, -s.wi) {
            return None;
        }
        let at = self.at(&s.point, own);
        let mut radiance = reading.eval(&self.radiance, &at);
        if let Some(opacity) = &self.opacity {
            radiance *= ops::clamp(reading.eval(opacity, &at), 0.0, 1.0);
        }
        radiance *= self.lets_out(s.point.ng.dot(s.wi), &at, reading);
        if !self.spread.is_open() {
            radiance *= self.spread.share(s.point.ng.dot(s.wi));
        }
        let sample = LightSample::from_afar(s.wi, radiance, s.pdf);
        Some(LightSample { far: false, to: (&s.point).into(), ..sample })
    }

    /// The radiance that a point sends out, which its own space has elsewhere.
    #[inline]
    pub(super) fn radiance_of<L: Lanes>(
        &self,
        hit: &SurfacePoint,
        wo: Vec3,
        own: impl FnOnce() -> SurfacePoint,
        reading: &Reading<'_, L>,
    ) -> Light {
        if !self.sides.lit(hit.ng, wo) {
            return Light::ZERO;
        }
        let at = self.at(hit, &own());
        let mut radiance = reading.eval(&self.radiance, &at);
        if self.below.is_some() {
            radiance *= self.lets_out(hit.ng.dot(wo), &at, reading);
        }
        if !self.spread.is_open() {
            radiance *= self.spread.share(hit.ng.dot(wo));
        }
        radiance
    }

    /// [`super::Emitter::emit_copy`].
    pub(super) fn emit_copy<L: Lanes>(
        &self,
        geometry: &Geometry,
        stand: &Stand<'_>,
        u: [f32; 4],
        reading: &Reading<'_, L>,
    ) -> Option<Emitted> {
        let own = self.sample_area(geometry, [u[0], u[1]], None)?;
        let point = stand.outwards(&own.point);
        let pdf_area = own.pdf_area / stand.stretch(own.point.ng);
        self.leaving(&AreaSample { point, pdf_area }, &own.point, [u[2], u[3]], reading)
    }

    /// A ray that leaves a point of the surface, which its own space has elsewhere.
    fn leaving<L: Lanes>(
        &self,
        &AreaSample { point, pdf_area }: &AreaSample,
        own: &SurfacePoint,
        [u, v]: [f32; 2],
        reading: &Reading<'_, L>,
    ) -> Option<Emitted> {
        let (side, of_side, u) = match self.sides {
            Sides::Front => (point.ng, 1.0, u),
            Sides::Back => (-point.ng, 1.0, u),
            Sides::Both if u < 0.5 => (point.ng, 0.5, 2.0 * u),
            Sides::Both => (-point.ng, 0.5, 2.0 * u - 1.0),
        };
        let local = warp::cosine_hemisphere([u, v]);
        let d = Frame::from_normal(side).to_world(local).try_normalize()?;
        let opacity = self
            .opacity
            .as_ref()
            .map_or(1.0, |o| ops::clamp(reading.eval(o, &self.at(&point, own)), 0.0, 1.0));
        let sound = pdf_area > 0.0 && pdf_area.is_finite() && local.z > 0.0 && opacity > 0.0;
        sound.then(|| Emitted {
            from: (&point).into(),
            d,
            light: self.radiance_of(&point, d, || *own, reading) * opacity,
            cos: local.z,
            pdf_place: pdf_area,
            pdf_direction: warp::cosine_hemisphere_pdf(local.z) * of_side,
            shows: Shows::Surface { point, opacity },
        })
    }

    /// What layers above leave of its light, for a direction at a cosine to the surface.
    fn lets_out<L: Lanes>(&self, cos: f32, at: &ShadingPoint, reading: &Reading<'_, L>) -> Light {
        self.below.as_ref().map_or(Light::ONE, |m| m.lets_out(ops::min(cos.abs(), 1.0), at, reading))
    }

    /// Where the radiance of a point is looked up, which its own space has elsewhere. Without a footprint, which a point that is sampled has not: both
    /// ways to find light must find the same.
    fn at(&self, point: &SurfacePoint, own: &SurfacePoint) -> ShadingPoint {
        let mut at = ShadingPoint::of(point.uv, point.p);
        (at.frame.n, at.object.p, at.object_n) = (point.n, own.p, own.n);
        if let Some(m) = &self.placement {
            at.object.p = m.inverse_point(own.p);
            at.object_n = own_normal(m, own.n);
        }
        at
    }
}

impl Lamp {
    /// What is known of a surface; `None` of one that has no bounds or area.
    pub fn of(light: &AreaLight, geometry: &Geometry) -> Option<Self> {
        let bounds;
        let (mut facing, area);
        match &light.surface {
            LitSurface::Shape(shape) => {
                bounds = geometry.bounds(*shape)?;
                area = geometry.area(*shape)?;
                facing = match &geometry.shapes[*shape as usize] {
                    Shape::Disc(_) | Shape::Parallelogram(_) => {
                        geometry.sample_area(*shape, [0.5; 2]).map_or(Vec3::ZERO, |s| s.point.ng)
                    }
                    _ => Vec3::ZERO,
                };
            }
            LitSurface::Mesh { mesh, area: total, .. } => {
                let m = &geometry.meshes[*mesh as usize];
                bounds = straal_math::Bounds::of_points(m.positions.iter().copied());
                area = *total as f32;
                let sum = (0..m.indices.len() as u32).fold(straal_math::DVec3::ZERO, |sum, i| {
                    let [a, b, c] = m.corners(i).map(Vec3::as_dvec3);
                    let cross = (b - a).cross(c - a) * 0.5;
                    if cross.is_finite() { sum + cross } else { sum }
                });
                let mean = (sum * (1.0 / *total)).as_vec3();
                facing = if m.flip { -mean } else { mean };
            }
        }
        if light.sides == Sides::Back {
            facing = -facing;
        }
        // Rounding must not make a flat lamp curved.
        let length = facing.length();
        let flatness = if length > 0.999_99 {
            1.0
        } else if length.is_finite() {
            length
        } else {
            0.0
        };
        let facing = facing.try_normalize().unwrap_or(Vec3::ZERO);
        let lamp = Self {
            center: bounds.center(),
            radius: 0.5 * bounds.extent().length(),
            facing,
            flatness,
            both_sides: light.sides == Sides::Both,
            flux: strength(&light.radiance) as f32 * area,
            spread: area * std::f32::consts::FRAC_1_PI,
        };
        lamp.flux.is_finite().then_some(lamp)
    }
}

impl Shine for AreaLight {
    const EXTENT: Extent = Extent::Surface;

    #[inline(always)]
    fn sample_many<F: Float, L: Lanes>(
        &self,
        geometry: &Geometry,
        (at, u): (&Receiver<F>, [F; 2]),
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        self.sample_parts(geometry, (at, u), None, readings)
    }

    #[inline]
    fn radiance_at<L: Lanes>(&self, hit: &SurfacePoint, wo: Vec3, reading: &Reading<'_, L>) -> Light {
        self.radiance_of(hit, wo, || *hit, reading)
    }

    fn pdf_at(&self, geometry: &Geometry, at: &Receiver, (primitive, hit): (u32, &SurfacePoint)) -> f32 {
        if self.radiance.most() == 0.0 || !self.sides.lit(hit.ng, at.p - hit.p) {
            return 0.0;
        }
        match &self.surface {
            LitSurface::Shape(shape) => geometry.pdf_lit(*shape, (at.p, at.n), hit),
            LitSurface::Mesh { mesh, triangles, .. } => {
                let chosen = triangles.as_ref().map_or(0.0, |t| t.pmf(primitive as usize));
                geometry.meshes[*mesh as usize].pdf_triangle_from((primitive, chosen), at.p, hit)
            }
        }
    }

    fn emit<L: Lanes>(
        &self,
        geometry: &Geometry,
        _: &Ball,
        u: [f32; 4],
        reading: &Reading<'_, L>,
    ) -> Option<Emitted> {
        let s = self.sample_area(geometry, [u[0], u[1]], None)?;
        self.leaving(&s, &s.point, [u[2], u[3]], reading)
    }

    /// pi A L for each lit side, and of that what gets through.
    fn power(&self, geometry: &Geometry, _: f64) -> f64 {
        let area = match &self.surface {
            LitSurface::Shape(shape) => f64::from(geometry.area(*shape).unwrap_or(0.0)),
            LitSurface::Mesh { area, .. } => *area,
        };
        let sides = if self.sides == Sides::Both { 2.0 } else { 1.0 };
        let most = self.below.as_ref().and_then(|m| m.emission()).map_or(1.0, |e| f64::from(e.most));
        sides * std::f64::consts::PI * area * strength(&self.radiance) * most * self.spread.of_power()
    }

    fn reach(&self, geometry: &Geometry) -> Option<Reach> {
        Lamp::of(self, geometry).map(Reach::Surface)
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        use super::tests::{mesh, narrowed, shape, turned};
        use crate::shape::{Cylinder, Disc, Drawn, Ellipsoid, Parallelogram, Shape, Sphere, TriangleMesh};
        use straal_math::{Affine, DVec3};
        let squash = Affine::scale(DVec3::new(1.0, 0.3, 0.6)).then(&turned());
        let sphere = Sphere { center: Vec3::new(0.1, 0.2, 0.3), radius: 0.7 };
        let (a, b) = (Vec3::new(1.5, 0.2, 0.0), Vec3::new(0.3, 0.1, -1.2));
        let flat = Parallelogram::new(Vec3::new(-0.7, -0.6, 0.5), a, b);
        // At right angles.
        let upright = Vec3::new(-0.12, 0.9, 0.7);
        let rectangle = Parallelogram::new(Vec3::new(-0.7, -0.6, -0.3), a, upright);
        let rectangle = |drawn| Shape::Parallelogram(Box::new(rectangle.drawn(drawn)));
        let middle = Vec3::new(0.2, 0.1, 0.0);
        let disc = Disc::new(middle, a, b);
        let across = a.cross(upright).normalize();
        let across = across.cross(a.normalize()) * a.length();
        let round = Shape::Disc(Box::new(Disc::new(middle, a, across).drawn(Drawn::BySolidAngle)));
        let auto = Drawn::Auto { both_sides: false };
        let as_seen = |mesh: TriangleMesh| TriangleMesh { drawn: Drawn::BySolidAngle, ..mesh };
        let triangle = as_seen(TriangleMesh {
            positions: [[-0.9, 0.1, -0.6], [1.1, 0.1, -0.5], [0.2, 0.0, 1.2]].map(Vec3::from_array).into(),
            indices: [[0, 1, 2]].into(),
            ..TriangleMesh::default()
        });
        let tube = Cylinder::between(DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.9, 0.4, 0.2), 0.3).unwrap();
        let cuboid = TriangleMesh::cuboid(Vec3::new(-0.5, -0.2, -0.8), Vec3::new(0.6, 0.3, 0.7));
        vec![
            shape("sphere", Shape::Sphere(sphere), Sides::Front),
            shape("sphere, inside", Shape::Sphere(sphere), Sides::Back),
            shape("ellipsoid", Shape::Ellipsoid(Box::new(Ellipsoid::new(squash).unwrap())), Sides::Both),
            shape("disc", Shape::Disc(Box::new(disc)), Sides::Front),
            shape("parallelogram", Shape::Parallelogram(Box::new(flat)), Sides::Both),
            shape("rectangle by solid angle", rectangle(Drawn::BySolidAngle), Sides::Both),
            shape("rectangle, auto", rectangle(auto), Sides::Front),
            shape("rectangle by projected", rectangle(Drawn::ByProjectedSolidAngle), Sides::Both),
            shape("disc by solid angle", round, Sides::Both),
            mesh("triangle by solid angle", triangle, Sides::Both),
            mesh("cuboid by solid angle", as_seen(cuboid.clone()), Sides::Front),
            mesh("cuboid, auto", TriangleMesh { drawn: auto, ..cuboid.clone() }, Sides::Front),
            shape("parallelogram, back", Shape::Parallelogram(Box::new(flat)), Sides::Back),
            shape("cylinder", Shape::Cylinder(Box::new(tube)), Sides::Front),
            narrowed("disc, narrow", shape("", Shape::Disc(Box::new(disc)), Sides::Both), 80.0),
            mesh("cuboid", cuboid.clone(), Sides::Front),
            mesh("cuboid, both", cuboid.transformed(&squash).unwrap(), Sides::Both),
        ]
    }
}
