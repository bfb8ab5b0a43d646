//! Surfaces where many rays arrived, side by side.
//!
//! Hits of one form (triangles, flat shapes, spheres) that follow one another are computed 8 or 16 at a time. All else is done
//! one by one, by [`World::surface`], and stands in the same columns: rarer shapes, what is seen through instances, and what is
//! read off textures.

use super::Surface;
use super::columns::{BLOCK, Vectors};
use crate::footprint::PackedFootprint;
use crate::material::shaded::shading_normals;
use crate::shape::offset::End;
use crate::shape::patch::{Level, Patch};
use crate::shape::{Shape, SurfacePoint, TriangleMesh, exact, mesh, sphere};
use crate::texture::ShadingPoint;
use crate::world::{Kind, GeometryRecord, World};
use straal_accel::Hit;
use straal_math::simd::{self, Float, Kernel, Mask, Simd};
use straal_math::{DVec3, Frame, Ray, Vec3};

/// Rays and what they hit, out of many.
#[derive(Clone, Copy, Debug)]
pub struct Met<'a> {
    /// Which of them.
    pub order: &'a [u32],
    /// All rays.
    pub rays: &'a [Ray],
    /// What each hit.
    pub hits: &'a [Hit],
}

impl<'a> Met<'a> {
    #[inline(always)]
    fn at(&self, i: usize) -> (&'a Ray, &'a Hit) {
        let k = self.order[i] as usize;
        (&self.rays[k], &self.hits[k])
    }
}

/// What hits that are computed together have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// A triangle of a mesh.
    Triangle {
        smooth: bool,
    },
    /// A part of a plane.
    Flat,
    Sphere,
    /// Anything, by itself.
    Other,
}

/// The surfaces of a block of hits, at most [`BLOCK`]: a [`Surface`] of each in columns.
#[derive(Debug)]
pub struct Surfaces {
    /// Where.
    pub p: Vectors,
    /// Bound of the error of its coordinates.
    pub p_err: Vectors,
    /// Geometric normals.
    pub ng: Vectors,
    /// Frames about the shading normals: their tangents and normals.
    pub frame: [Vectors; 3],
    /// The geometric normals in those frames, on the shading normals' side; zero where they are the shading normals.
    pub leaning: Vectors,
    /// In those frames, where the rays came from.
    pub wo: Vectors,
    /// Indices of materials in the world.
    pub material: [u32; BLOCK],
    /// Indices of emitters in the world, where the surface glows.
    pub emitter: [Option<u32>; BLOCK],
    /// What was done one by one, and for whom: texture coordinates, and what materials read.
    apart: Vec<(u32, [f32; 2], Option<ShadingPoint>)>,
}

impl Default for Surfaces {
    fn default() -> Self {
        Self {
            p: Vectors::default(),
            p_err: Vectors::default(),
            ng: Vectors::default(),
            frame: [Vectors::default(); 3],
            leaning: Vectors::default(),
            wo: Vectors::default(),
            material: [0; BLOCK],
            emitter: [None; BLOCK],
            apart: Vec::new(),
        }
    }
}

impl Surfaces {
    /// Computes those where the given rays arrived; `footprint` is that of a ray, by its number.
    pub fn meet(
        &mut self,
        world: &World,
        simd: Simd,
        met: &Met<'_>,
        footprint: impl Fn(u32) -> PackedFootprint,
    ) {
        self.apart.clear();
        let mut forms = [Form::Other; BLOCK];
        let count = met.order.len().min(BLOCK);
        for (i, form) in forms[..count].iter_mut().enumerate() {
            let (_, hit) = met.at(i);
            let geometry = world.geometry(hit);
            self.material[i] = world.material_of(hit);
            self.emitter[i] = geometry.emitter;
            *form = world.form(geometry, hit, self.material[i]);
        }
        // What the last vector of a run writes beyond its end is overwritten by the next run.
        let mut start = 0;
        for run in forms[..count].chunk_by(|a, b| a == b) {
            let end = start + run.len();
            if run[0] == Form::Other {
                for i in start..end {
                    let (ray, hit) = met.at(i);
                    self.set(i, ray, world.surface(ray, hit, &footprint(met.order[i])));
                }
            } else {
                let met = Met { order: &met.order[start..end], ..*met };
                simd.run(Run { world, form: run[0], met, start, out: self });
            }
            start = end;
        }
    }

    fn set(&mut self, i: usize, ray: &Ray, Surface { point, frame, ng, at, .. }: Surface) {
        let seen = Seen {
            end: End::from(&point),
            frame,
            leaning: ng.unwrap_or(Vec3::ZERO),
            wo: frame.to_local(-ray.d),
        };
        self.store::<f32>(i, &seen);
        self.apart.push((i as u32, point.uv, at));
    }

    #[inline(always)]
    fn store<F: Float>(&mut self, first: usize, seen: &Seen<F>) {
        self.p.store(first, seen.end.p);
        self.p_err.store(first, seen.end.p_err);
        self.ng.store(first, seen.end.ng);
        let Frame { s, t, n } = seen.frame;
        for (column, axis) in self.frame.iter_mut().zip([s, t, n]) {
            column.store(first, axis);
        }
        self.leaning.store(first, seen.leaning);
        self.wo.store(first, seen.wo);
    }

    /// The point of surface `i`, its error and geometric normal.
    #[inline(always)]
    pub fn end(&self, i: usize) -> End {
        End { p: self.p.at(i), p_err: self.p_err.at(i), ng: self.ng.at(i) }
    }

    /// The frame of surface `i`.
    #[inline(always)]
    pub fn frame(&self, i: usize) -> Frame {
        let [s, t, n] = &self.frame;
        Frame { s: s.at(i), t: t.at(i), n: n.at(i) }
    }

    /// The geometric normal of surface `i` in its frame; `None` where it is the shading normal.
    #[inline(always)]
    pub fn ng(&self, i: usize) -> Option<Vec3> {
        let ng = self.leaning.at(i);
        (ng != Vec3::ZERO).then_some(ng)
    }

    /// What of surface `i` its material reads, if that differs from point to point.
    #[inline]
    pub fn at(&self, i: usize) -> Option<&ShadingPoint> {
        self.apart(i).and_then(|(_, _, at)| at.as_ref())
    }

    /// The point of surface `i`. Its texture coordinates are 0 where neither its material nor its emitter wants them.
    pub fn point(&self, i: usize) -> SurfacePoint {
        let End { p, p_err, ng } = self.end(i);
        let uv = self.apart(i).map_or([0.0; 2], |(_, uv, _)| *uv);
        SurfacePoint { p, p_err, ng, n: self.frame[2].at(i), uv }
    }

    #[inline]
    fn apart(&self, i: usize) -> Option<&(u32, [f32; 2], Option<ShadingPoint>)> {
        if self.apart.is_empty() {
            return None;
        }
        self.apart.iter().find(|(k, ..)| *k as usize == i)
    }
}

/// What a block holds of one surface, or of many.
struct Seen<F> {
    end: End<F>,
    frame: Frame<F>,
    leaning: Vec3<F>,
    wo: Vec3<F>,
}

impl World {
    /// How the surface at a hit may be computed.
    #[inline]
    fn form(&self, geometry: &GeometryRecord, hit: &Hit, material: u32) -> Form {
        if !hit.chain.is_empty() || geometry.emission_varies || self.materials.wants(material).point {
            return Form::Other;
        }
        match geometry.kind {
            Kind::Mesh(mesh) => {
                Form::Triangle { smooth: !self.geometry.meshes[mesh as usize].normals.is_empty() }
            }
            Kind::Shapes(first) => match &self.geometry.shapes[(first + hit.primitive) as usize] {
                Shape::Sphere(_) => Form::Sphere,
                shape if shape.patch().is_some() => Form::Flat,
                _ => Form::Other,
            },
        }
    }
}

/// Hits of one form, not [`Form::Other`].
struct Run<'a> {
    world: &'a World,
    form: Form,
    met: Met<'a>,
    /// Where their surfaces stand.
    start: usize,
    out: &'a mut Surfaces,
}

impl Kernel for Run<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { world, form, met, start, out } = self;
        for first in (0..met.order.len()).step_by(F::WIDTH) {
            let lanes = Lanes { world, met, first };
            let d = lanes.directions::<F>();
            let (end, n) = match form {
                Form::Triangle { smooth } => lanes.triangles::<F>(smooth),
                Form::Flat => lanes.flat::<F>(d),
                Form::Sphere | Form::Other => lanes.spheres::<F>(d),
            };
            // The geometric normal stays: lights are sampled by it, and their lit side was chosen by it.
            let n = Vec3::select(lanes.flipped::<F>(), -n, n);
            let (n, leaning) = shading_normals(n, end.ng, -d);
            let frame = Frame::from_normal(n);
            let (leaning, wo) = (frame.to_local(leaning), frame.to_local(-d));
            out.store(start + first, &Seen { end, frame, leaning, wo });
        }
    }
}

/// Hits in the lanes of vectors: those of a run from one on. What is left of lanes beyond does what the last hit does.
struct Lanes<'a> {
    world: &'a World,
    met: Met<'a>,
    first: usize,
}

impl<'a> Lanes<'a> {
    #[inline(always)]
    fn at(&self, lane: usize) -> (&'a Ray, &'a Hit) {
        let (i, last) = (self.first + lane, self.met.order.len() - 1);
        self.met.at(if i < last { i } else { last })
    }

    #[inline(always)]
    fn hit(&self, lane: usize) -> &'a Hit {
        self.at(lane).1
    }

    #[inline(always)]
    fn directions<F: Float>(&self) -> Vec3<F> {
        let [x, y, z, _] = F::from_rows(
            #[inline(always)]
            |i| {
                let d = self.at(i).0.d;
                [d.x, d.y, d.z, 0.0]
            },
        );
        Vec3::new(x, y, z)
    }

    /// The points at the hits' distances along the rays.
    #[inline(always)]
    fn arrived<F: Float>(&self, d: Vec3<F>) -> DVec3<F::Double> {
        let [x, y, z, t] = F::from_rows(
            #[inline(always)]
            |i| {
                let (ray, hit) = self.at(i);
                [ray.o.x, ray.o.y, ray.o.z, hit.t]
            },
        );
        exact::along([Vec3::new(x, y, z), d], t)
    }

    #[inline(always)]
    fn flipped<F: Float>(&self) -> F::Mask {
        let mut bits = 0;
        for i in 0..F::WIDTH {
            bits |= u32::from(self.world.geometry(self.hit(i)).flip) << i;
        }
        F::Mask::from_bits(bits)
    }

    /// The mesh of a lane.
    #[inline(always)]
    fn mesh(&self, lane: usize) -> &'a TriangleMesh {
        let meshes = &self.world.geometry.meshes;
        match self.world.geometry(self.hit(lane)).kind {
            Kind::Mesh(mesh) | Kind::Shapes(mesh) => &meshes[mesh as usize],
        }
    }

    /// The shape of a lane.
    #[inline(always)]
    fn shape(&self, lane: usize) -> &'a Shape {
        let hit = self.hit(lane);
        let shapes = &self.world.geometry.shapes;
        match self.world.geometry(hit).kind {
            Kind::Mesh(first) | Kind::Shapes(first) => &shapes[(first + hit.primitive) as usize],
        }
    }

    #[inline(always)]
    fn triangles<F: Float>(&self, smooth: bool) -> (End<F>, Vec3<F>) {
        let mut corners = [[[0.0; 4]; 3]; simd::BLOCK];
        let mut flip = 0;
        for (i, rows) in corners[..F::WIDTH].iter_mut().enumerate() {
            let (mesh, hit) = (self.mesh(i), self.hit(i));
            let [a, b, c] = mesh.corners(hit.primitive);
            *rows = [[a.x, a.y, a.z, hit.u], [b.x, b.y, b.z, hit.v], [c.x, c.y, c.z, 0.0]];
            flip |= u32::from(mesh.flip) << i;
        }
        let ([p0, p1, p2], uv) = three(&corners);
        let end = mesh::end::<F>([p0, p1, p2], uv, F::Mask::from_bits(flip));
        if !smooth {
            return (end, end.ng);
        }
        for (i, rows) in corners[..F::WIDTH].iter_mut().enumerate() {
            let normals = self.mesh(i).corner_normals(self.hit(i).primitive);
            let [a, b, c] = normals.unwrap_or([Vec3::ZERO; 3]);
            *rows = [[a.x, a.y, a.z, 0.0], [b.x, b.y, b.z, 0.0], [c.x, c.y, c.z, 0.0]];
        }
        let (normals, _) = three(&corners);
        (end, mesh::shading_normal(normals, uv, end.ng))
    }

    #[inline(always)]
    fn flat<F: Float>(&self, d: Vec3<F>) -> (End<F>, Vec3<F>) {
        let level = Level::from_fn(
            #[inline(always)]
            |i| self.shape(i).patch().unwrap_or(&Patch::NOWHERE),
        );
        let end = level.nearest::<F>(self.arrived(d));
        (end, end.ng)
    }

    #[inline(always)]
    fn spheres<F: Float>(&self, d: Vec3<F>) -> (End<F>, Vec3<F>) {
        let [x, y, z, radius] = F::from_rows(
            #[inline(always)]
            |i| match self.shape(i) {
                Shape::Sphere(s) => [s.center.x, s.center.y, s.center.z, s.radius],
                _ => [0.0; 4],
            },
        );
        let center = Vec3::new(x, y, z);
        let end = sphere::end::<F>((center, radius), self.arrived(d) - center.to_double());
        (end, end.ng)
    }
}

/// Three vectors in each lane, and the first two of the numbers that stand beside them.
#[inline(always)]
fn three<F: Float>(rows: &[[[f32; 4]; 3]; simd::BLOCK]) -> ([Vec3<F>; 3], [F; 2]) {
    let [ax, ay, az, u] = columns(rows, 0);
    let [bx, by, bz, v] = columns(rows, 1);
    let [cx, cy, cz, _] = columns(rows, 2);
    ([Vec3::new(ax, ay, az), Vec3::new(bx, by, bz), Vec3::new(cx, cy, cz)], [u, v])
}

#[inline(always)]
fn columns<F: Float>(rows: &[[[f32; 4]; 3]; simd::BLOCK], k: usize) -> [F; 4] {
    F::from_rows(
        #[inline(always)]
        |i| rows[i][k],
    )
}
