//! Surfaces where many rays arrived, side by side.
//!
//! Hits that are [alike](Alike) and follow one another are computed 8 or 16 at a time. All else is done one by one, by
//! [`World::surface`], and stands in the same columns: what is seen through instances or read off textures, and custom shapes.

use super::Surface;
use super::columns::{BLOCK, ROOM, Vectors};
use crate::footprint::PackedFootprint;
use crate::material::Materials;
use crate::material::shaded::shading_normals;
use crate::shape::mesh::Between;
use crate::shape::offset::End;
use crate::shape::patch::{Level, Patch};
use crate::shape::{Geometry, Shape, SurfacePoint, TriangleMesh, exact, mesh, sphere};
use crate::texture::ShadingPoint;
use crate::world::{GeometryRecord, INHERIT, Kind, World};
use std::ops::Range;
use straal_accel::Hit;
use straal_math::simd::{Double, Float, Kernel, Mask, Simd};
use straal_math::{DVec3, Frame, Ray, Vec3};

/// Rays and what they hit, out of many.
#[derive(Clone, Copy)]
pub struct Met<'a> {
    /// Which of them.
    pub order: &'a [u32],
    /// All rays.
    pub rays: &'a [Ray],
    /// What each hit.
    pub hits: &'a [Hit],
    /// A number in [0, 1) for a ray, by its number: which corner of a triangle lends its colour.
    pub corner: &'a dyn Fn(u32) -> f32,
}

impl<'a> Met<'a> {
    #[inline(always)]
    fn at(&self, i: usize) -> (&'a Ray, &'a Hit) {
        let k = self.order[i] as usize;
        (&self.rays[k], &self.hits[k])
    }
}

/// What hits that are computed together have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Alike {
    /// Triangles of meshes.
    Triangles,
    /// They lie on discs and parallelograms.
    Flat,
    /// They lie on spheres.
    Round,
    /// They lie on one shape, of any kind.
    Shape(u32),
    /// Nothing: each is computed by itself.
    Apart,
}

/// Fewer than this are quicker done one lane at a time.
const FEW: usize = 3;

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
    /// A bit for each that lies below the surface that shading normals tell of.
    pub raised: u64,
    /// How far, where it does.
    pub bulge: Vectors,
    /// In the frames, the normals of that surface; zero where they are the shading normals.
    pub smooth: Vectors,
    /// In those frames, where the rays came from.
    pub wo: Vectors,
    gathered: Gathered,
    /// Indices of materials in the world.
    pub material: [u32; BLOCK],
    /// Indices of emitters in the world, where the surface glows.
    pub emitter: [Option<u32>; BLOCK],
    /// A bit for each that does.
    pub glowing: u64,
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
            raised: 0,
            bulge: Vectors::default(),
            smooth: Vectors::default(),
            wo: Vectors::default(),
            gathered: Gathered::default(),
            material: [0; BLOCK],
            emitter: [None; BLOCK],
            glowing: 0,
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
        let count = met.order.len().min(BLOCK);
        // Rays and hits lie here and there in memory: a loop that does little else asks for many of them at once.
        let mut geometries = [0; BLOCK];
        for (i, geometry) in geometries[..count].iter_mut().enumerate() {
            let (ray, hit) = met.at(i);
            self.gathered.d[i] = beside(ray.d, ray.t_max);
            self.gathered.o[i] = beside(ray.o, hit.t);
            *geometry = hit.geometry;
        }
        let mut likes = [Alike::Apart; BLOCK];
        self.glowing = 0;
        for (i, alike) in likes[..count].iter_mut().enumerate() {
            let (_, hit) = met.at(i);
            let geometry = &world.geometries[geometries[i] as usize];
            self.material[i] = world.material_of(hit);
            self.emitter[i] = geometry.emitter;
            self.glowing |= u64::from(geometry.emitter.is_some()) << i;
            if hit.chain.is_empty() {
                *alike = geometry.alike;
            }
        }
        // What the last vector of a run writes beyond its end is overwritten by the next run.
        let mut start = 0;
        for run in likes[..count].chunk_by(|a, b| a == b) {
            let end = start + run.len();
            let alike = run[0];
            self.raised &= (1 << start) - 1;
            if alike == Alike::Apart {
                for i in start..end {
                    let (ray, hit) = met.at(i);
                    let (k, mut d) = (met.order[i], ray.d);
                    let surface = if world.geometries[hit.geometry as usize].colours_at_corners {
                        let (surface, towards) =
                            world.surface_at_corner(ray, hit, &footprint(k), (met.corner)(k));
                        d = towards;
                        surface
                    } else {
                        world.surface(ray, hit, &footprint(k))
                    };
                    self.set(i, d, surface);
                }
            } else {
                self.gathered.take(world, (met, start..end), (alike, &geometries));
                let simd = if run.len() < FEW { Simd::PLAIN } else { simd };
                simd.run(Run { world, alike, range: start..end, out: self });
            }
            start = end;
        }
        self.raised &= (1 << count) - 1;
    }

    /// Takes one that is seen in the direction `d`.
    fn set(&mut self, i: usize, d: Vec3, surface: Surface) {
        let Surface { point, frame, ng, bulge, smooth, at, .. } = surface;
        let seen =
            Seen { end: End::from(&point), frame, leaning: ng.unwrap_or(Vec3::ZERO), wo: frame.to_local(-d) };
        self.store::<f32>(i, &seen);
        if bulge != Vec3::ZERO {
            self.raised |= 1 << i;
            self.bulge.set(i, bulge);
            self.smooth.set(i, smooth.unwrap_or(Vec3::ZERO));
        }
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

    /// Says how far the surfaces from `first` on lie below those that shading normals tell of.
    #[inline(always)]
    fn raise<F: Float>(&mut self, first: usize, bulge: Vec3<F>) {
        let zero = F::ZERO;
        let raised = bulge.x.ne(zero) | bulge.y.ne(zero) | bulge.z.ne(zero);
        if raised.any() {
            self.raised |= u64::from(raised.to_bits()) << first;
            self.bulge.store(first, bulge);
            self.smooth.store(first, Vec3::splat(zero));
        }
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

    /// How far above surface `i` the one lies that shading normals tell of.
    pub fn bulge(&self, i: usize) -> Vec3 {
        if self.raised >> i & 1 == 1 { self.bulge.at(i) } else { Vec3::ZERO }
    }

    /// What of surface `i` its material reads, if that differs from point to point.
    #[inline]
    pub fn at(&self, i: usize) -> Option<&ShadingPoint> {
        self.apart(i).and_then(|(_, _, at)| at.as_ref())
    }

    /// Whether there is a surface of which its material reads anything.
    #[inline]
    pub fn any_at(&self) -> bool {
        self.apart.iter().any(|(_, _, at)| at.is_some())
    }

    /// Gives textures of surface `i` numbers by which they may draw texels.
    pub fn draw_lots(&mut self, i: usize, lot: impl FnOnce() -> [f32; 2]) {
        let apart = self.apart.iter_mut().find(|(k, ..)| *k as usize == i);
        if let Some((_, _, Some(at))) = apart {
            at.lot = Some(lot());
        }
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

impl Alike {
    /// Tells it of all geometries, whose materials are known.
    pub(crate) fn tell(records: &mut [GeometryRecord], geometry: &Geometry, materials: &Materials) {
        for record in records {
            // Outside of instances, what has no material of its own has the first.
            let material = if record.material == INHERIT { 0 } else { record.material };
            record.alike = Self::of(record, geometry, materials.wants(material).point);
        }
    }

    /// With which others surfaces of a geometry may be computed; `wants_point` says whether its material asks for more.
    fn of(record: &GeometryRecord, geometry: &Geometry, wants_point: bool) -> Self {
        match record.kind {
            _ if record.emission_varies || record.colours_at_corners || wants_point => Self::Apart,
            Kind::Mesh(_) => Self::Triangles,
            Kind::Shapes(first) => match &geometry.shapes[first as usize] {
                Shape::Sphere(_) => Self::Round,
                Shape::Plane(_) | Shape::Ellipsoid(_) | Shape::Cylinder(_) => Self::Shape(first),
                shape if shape.patch().is_some() => Self::Flat,
                _ => Self::Apart,
            },
        }
    }
}

/// Four numbers of each hit, as they lie in memory.
type Rows = [[f32; 4]; ROOM];

/// What surfaces are made from, gathered hit by hit. Lanes for which nothing was gathered are left over from another block.
#[derive(Debug)]
struct Gathered {
    /// The rays' directions; what stands beside them is of no use.
    d: Rows,
    /// Their origins, and how far off the hits are.
    o: Rows,
    /// Corners of triangles; beside the first two, the weights of corners 1 and 2.
    corners: [Rows; 3],
    /// The corners' shading normals.
    normals: [Rows; 3],
    /// Planes of flat shapes, number by number.
    levels: [[f64; ROOM]; Level::NUMBERS],
    /// Centers and radii.
    sphere: Rows,
    /// A bit for each triangle that has shading normals.
    smooth: u64,
    /// A bit for each of them above which rays leave from the surface that these tell of.
    bulges: u64,
    /// A bit for each triangle whose geometric normal is turned round.
    turned: u64,
    /// A bit for each surface whose shading normal is.
    flipped: u64,
}

impl Default for Gathered {
    /// Something that is there, since a vector with nothing in a lane takes the long way.
    fn default() -> Self {
        let all = |v: Vec3, w: f32| [[v.x, v.y, v.z, w]; ROOM];
        Self {
            d: all(Vec3::Z, 0.0),
            o: all(Vec3::ZERO, 1.0),
            corners: [Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| all(v, 0.0)),
            normals: [all(Vec3::Z, 0.0); 3],
            levels: Level::EXAMPLE.to_array().map(|x| [x; ROOM]),
            sphere: all(Vec3::ZERO, 1.0),
            smooth: 0,
            bulges: 0,
            turned: 0,
            flipped: 0,
        }
    }
}

impl Gathered {
    /// Takes what surfaces are made from that are alike, besides rays.
    #[inline]
    fn take(
        &mut self,
        world: &World,
        (met, range): (&Met<'_>, Range<usize>),
        (alike, geometries): (Alike, &[u32; BLOCK]),
    ) {
        for i in range {
            let geometry = &world.geometries[geometries[i] as usize];
            set(&mut self.flipped, i, geometry.flip);
            match (alike, geometry.kind) {
                (_, Kind::Mesh(mesh)) => {
                    self.take_triangle(i, &world.geometry.meshes[mesh as usize], met.at(i).1);
                }
                (Alike::Round, Kind::Shapes(first)) => {
                    if let Shape::Sphere(s) = &world.geometry.shapes[first as usize] {
                        self.sphere[i] = beside(s.center, s.radius);
                    }
                }
                (Alike::Flat, Kind::Shapes(first)) => {
                    let level = world.geometry.shapes[first as usize].patch().map(Patch::level);
                    for (column, x) in
                        self.levels.iter_mut().zip(level.map(Level::to_array).into_iter().flatten())
                    {
                        column[i] = x;
                    }
                }
                _ => {}
            }
        }
    }

    #[inline]
    fn take_triangle(&mut self, i: usize, mesh: &TriangleMesh, hit: &Hit) {
        let ([a, b, c], [a_rows, b_rows, c_rows]) = (mesh.corners(hit.primitive), &mut self.corners);
        (a_rows[i], b_rows[i], c_rows[i]) = (beside(a, hit.u), beside(b, hit.v), beside(c, 0.0));
        let normals = mesh.corner_normals(hit.primitive);
        set(&mut self.turned, i, mesh.flip);
        set(&mut self.smooth, i, normals.is_some());
        set(&mut self.bulges, i, normals.is_some() && mesh.between == Between::Surface);
        for (rows, n) in self.normals.iter_mut().zip(normals.into_iter().flatten()) {
            rows[i] = beside(n, 0.0);
        }
    }

    /// The points, their shading normals, and how far the surface bulges that these tell of.
    #[inline(always)]
    fn triangles<F: Float>(&self, first: usize) -> (End<F>, Vec3<F>, Vec3<F>) {
        let [(a, u), (b, v), (c, _)] = vectors(&self.corners, first);
        let corners = [a, b, c];
        let end = mesh::end(corners, [u, v], mask::<F>(self.turned, first));
        let smooth = mask::<F>(self.smooth, first);
        let none = Vec3::splat(F::ZERO);
        if !smooth.any() {
            return (end, end.ng, none);
        }
        let [(a, _), (b, _), (c, _)] = vectors(&self.normals, first);
        let n = mesh::shading_normal([a, b, c], [u, v], end.ng);
        let n = Vec3::select(smooth, n, end.ng);
        let bulges = mask::<F>(self.bulges, first) & smooth;
        if !bulges.any() {
            return (end, n, none);
        }
        let (d, _) = vector::<F>(&self.d, first);
        let out = Vec3::select(d.dot(end.ng).gt(F::ZERO), -end.ng, end.ng);
        let bulge = mesh::bulge(corners, [a, b, c], [u, v], out);
        (end, n, Vec3::select(bulges, bulge, none))
    }

    #[inline(always)]
    fn flat<F: Float>(&self, first: usize) -> End<F> {
        let mut numbers = [F::Double::ZERO; Level::NUMBERS];
        let mut k = 0;
        while k < numbers.len() {
            numbers[k] = F::Double::load(&self.levels[k][first..]);
            k += 1;
        }
        Level::from_array(numbers).nearest(self.arrived::<F>(first))
    }

    #[inline(always)]
    fn round<F: Float>(&self, first: usize) -> End<F> {
        let (center, radius) = vector(&self.sphere, first);
        sphere::end((center, radius), self.arrived::<F>(first) - center.to_double())
    }

    /// The points of the rays where they hit something.
    #[inline(always)]
    fn arrived<F: Float>(&self, first: usize) -> DVec3<F::Double> {
        let ((o, t), (d, _)) = (vector::<F>(&self.o, first), vector::<F>(&self.d, first));
        exact::along([o, d], t)
    }
}

#[inline(always)]
fn beside(v: Vec3, w: f32) -> [f32; 4] {
    [v.x, v.y, v.z, w]
}

#[inline(always)]
fn set(bits: &mut u64, i: usize, is: bool) {
    *bits = *bits & !(1 << i) | u64::from(is) << i;
}

/// Bits from `first` on.
#[inline(always)]
fn mask<F: Float>(bits: u64, first: usize) -> F::Mask {
    F::Mask::from_bits((bits >> first) as u32)
}

/// Vectors from `first` on, and what stands beside them.
#[inline(always)]
fn vector<F: Float>(rows: &Rows, first: usize) -> (Vec3<F>, F) {
    let rows = &rows[first..first + F::WIDTH];
    let [x, y, z, w] = F::from_rows(
        #[inline(always)]
        |i| rows[i],
    );
    (Vec3::new(x, y, z), w)
}

#[inline(always)]
fn vectors<F: Float>([a, b, c]: &[Rows; 3], first: usize) -> [(Vec3<F>, F); 3] {
    [vector(a, first), vector(b, first), vector(c, first)]
}

/// Hits that follow one another, not [`Alike::Apart`].
struct Run<'a> {
    world: &'a World,
    alike: Alike,
    range: Range<usize>,
    out: &'a mut Surfaces,
}

impl Kernel for Run<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { world, alike, range, out } = self;
        for first in range.step_by(F::WIDTH) {
            let from = &out.gathered;
            let mut bulge = Vec3::splat(F::ZERO);
            let (end, n) = match alike {
                Alike::Triangles => {
                    let (end, n, above) = from.triangles::<F>(first);
                    bulge = above;
                    (end, n)
                }
                Alike::Flat => flat(from.flat::<F>(first)),
                Alike::Round => flat(from.round::<F>(first)),
                Alike::Shape(shape) => {
                    let Some(end) = world.geometry.end(shape, from.arrived::<F>(first)) else { return };
                    flat(end)
                }
                Alike::Apart => return,
            };
            let (d, _) = vector(&from.d, first);
            // The geometric normal stays: lights are sampled by it, and their lit side was chosen by it.
            let n = Vec3::select(mask::<F>(from.flipped, first), -n, n);
            let (n, leaning) = shading_normals(n, end.ng, -d);
            let frame = Frame::from_normal(n);
            let (leaning, wo) = (frame.to_local(leaning), frame.to_local(-d));
            out.store(first, &Seen { end, frame, leaning, wo });
            out.raise(first, bulge);
        }
    }
}

/// A surface whose shading normal is the geometric one.
#[inline(always)]
fn flat<F: Float>(end: End<F>) -> (End<F>, Vec3<F>) {
    (end, end.ng)
}
