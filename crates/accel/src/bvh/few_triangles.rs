//! A group that is nothing but a few triangles: a slice's rays are tested side by side, a ray in each lane, against one triangle after
//! the other.
//!
//! A room of walls and boxes is less than a hundred triangles. Walking a tree of two levels to them takes longer than testing them:
//! in a tree rays wait for their nodes and part at every step, here they don't. Triangles whose boxes fit together, as those of the two halves
//! of a wall do, are passed over together where no ray crosses the box around them.
//!
//! Every lane does the operations of `local.rs`, `slab.rs` and `triangle.rs`, none of them fused, but that a negative dominant axis
//! doesn't swap the two others: that would change the signs of all edge functions and no quotient of them. What single precision can't
//! decide, `triangle::intersect` does.

use super::answers::Answers;
use crate::{
    hit::{Chain, Hit},
    local::{LEAST, LocalRay},
    prim::{Prim, PrimKind},
    slab::{self, EXIT},
    stage::{GroupData, Stage},
    triangle::{self, FLAT, LEAST_DETERMINANT},
};
use straal_math::simd::{Float, Kernel, Mask, Uint};
use straal_math::{Bounds, Ray, Vec3};

/// Of more triangles than this a group has the tree alone.
const FEW: usize = 64;

/// A triangle, and where it is found.
struct Triangle {
    v: [Vec3; 3],
    bounds: Bounds,
    geometry: u32,
    primitive: u32,
}

/// Triangles that are passed over together.
struct Clump {
    bounds: Bounds,
    /// The number of its first triangle, and one past the last.
    range: [usize; 2],
}

/// The triangles of a group, in the order of their numbers there.
#[derive(Default)]
pub(super) struct FewTriangles {
    triangles: Vec<Triangle>,
    clumps: Vec<Clump>,
}

impl FewTriangles {
    pub const EMPTY: Self = Self { triangles: Vec::new(), clumps: Vec::new() };

    /// None where there are many, or other things in the tree as well.
    pub fn of(
        prims: &[Prim],
        vertices: &impl Fn(u32) -> [Vec3; 3],
        locate: impl Fn(u32) -> (u32, u32),
    ) -> Self {
        let mut out = Self::EMPTY;
        if prims.len() > FEW {
            return out;
        }
        let mut ids = Vec::with_capacity(prims.len());
        for prim in prims {
            let PrimKind::Triangle(id) = prim.kind else { return out };
            ids.push(id);
        }
        ids.sort_unstable();
        for id in ids {
            let (v, (geometry, primitive)) = (vertices(id), locate(id));
            out.push(Triangle { v, bounds: slab::triangle_bounds(&v), geometry, primitive });
        }
        out
    }

    fn push(&mut self, triangle: Triangle) {
        let (bounds, i) = (triangle.bounds, self.triangles.len());
        self.triangles.push(triangle);
        if let Some(last) = self.clumps.last_mut() {
            let both = last.bounds.union(bounds);
            if both.half_area() <= last.bounds.half_area() + bounds.half_area() {
                (last.bounds, last.range[1]) = (both, i + 1);
                return;
            }
        }
        self.clumps.push(Clump { bounds, range: [i, i + 1] });
    }

    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.triangles.as_slice()) + size_of_val(self.clumps.as_slice())
    }
}

/// Searches a slice of rays; when `ANY`, for any hit.
pub(super) struct Among<'a, S, A: ?Sized, const ANY: bool> {
    pub few: &'a FewTriangles,
    pub stage: &'a Stage<S>,
    pub group: &'a GroupData,
    pub rays: &'a [Ray],
    /// Where `after_shapes`, with what was hit among shapes beside the tree.
    pub out: &'a mut A,
    pub after_shapes: bool,
}

impl<S, A: Answers + ?Sized, const ANY: bool> Kernel for Among<'_, S, A, ANY> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { few, stage, group, rays, out, after_shapes } = self;
        for first in (0..rays.len()).step_by(F::WIDTH) {
            // Lanes without a ray do what the last one does.
            let at = |lane: usize| if first + lane < rays.len() { first + lane } else { rays.len() - 1 };
            let beams = Beams::<F>::of(
                #[inline(always)]
                |lane| &rays[at(lane)],
            );
            let mut near = Near { t: beams.t_max, e1: F::ZERO, e2: F::ZERO, det: F::ONE, place: none::<F>() };
            if after_shapes {
                near.t = F::from_fn(
                    #[inline(always)]
                    |lane| match out.get(at(lane)) {
                        hit if !hit.is_hit() => f32::INFINITY,
                        _ if ANY => -1.0,
                        hit => hit.t,
                    },
                )
                .min(near.t);
            }
            let sees_all = rays[first..].iter().take(F::WIDTH).all(|r| r.mask & group.all_masks != 0);
            for clump in &few.clumps {
                let (_, is_crossed) = beams.cross(&clump.bounds, near.t);
                if !is_crossed.any() {
                    continue;
                }
                let [start, end] = clump.range;
                for (place, triangle) in (start..end).zip(&few.triangles[start..end]) {
                    let mut seen = is_crossed;
                    if !sees_all {
                        let mask = stage.geometry_mask(triangle.geometry);
                        let bit = |lane: usize| u32::from(rays[at(lane)].mask & mask != 0) << lane;
                        seen =
                            seen & F::Mask::from_bits((0..F::WIDTH).fold(0, |bits, lane| bits | bit(lane)));
                    }
                    near.meet::<ANY>(
                        &beams,
                        (place as u32, triangle),
                        seen,
                        #[inline(always)]
                        |lane| &rays[at(lane)],
                    );
                }
            }
            near.tell::<A, ANY>(few, (out, first), rays.len(), after_shapes);
        }
    }
}

/// The place of no triangle, after all others.
#[inline(always)]
fn none<F: Float>() -> F::Uint {
    F::Uint::splat(u32::MAX)
}

/// Rays as [`LocalRay`] has one.
#[derive(Clone, Copy)]
struct Beams<F: Float> {
    o: [F; 3],
    inv: [F; 3],
    t_min: F,
    /// Below 0 where the ray isn't valid.
    t_max: F,
    /// Where the dominant axis is z, and where it is y.
    is_z: F::Mask,
    is_y: F::Mask,
    shear: [F; 3],
}

impl<F: Float> Beams<F> {
    #[inline(always)]
    fn of<'a>(ray: impl Fn(usize) -> &'a Ray) -> Self {
        let [ox, oy, oz, start] = F::from_rows(
            #[inline(always)]
            |i| {
                let r = ray(i);
                [r.o.x, r.o.y, r.o.z, r.t_min]
            },
        );
        let [dx, dy, dz, end] = F::from_rows(
            #[inline(always)]
            |i| {
                let r = ray(i);
                [r.d.x, r.d.y, r.d.z, r.t_max]
            },
        );
        let most = F::splat(f32::MAX);
        let t_min = F::select(start.gt(F::ZERO), start, F::ZERO);
        let t_max = F::select(end.gt(most), most, end);
        let zeros = (ox * 0.0 + dx * 0.0) + (oy * 0.0 + dy * 0.0) + (oz * 0.0 + dz * 0.0);
        let is_valid = zeros.eq(F::ZERO)
            & (dx.ne(F::ZERO) | dy.ne(F::ZERO) | dz.ne(F::ZERO))
            & start.le(end)
            & t_min.le(t_max);
        let (ax, ay, az) = (dx.abs(), dy.abs(), dz.abs());
        let is_z = az.gt(ax) & az.gt(ay);
        let is_y = ay.gt(ax) & !is_z;
        let mut beams = Self {
            o: [ox, oy, oz],
            inv: [reciprocal(dx, ax), reciprocal(dy, ay), reciprocal(dz, az)],
            t_min,
            t_max: F::select(is_valid, t_max, F::splat(-1.0)),
            is_z,
            is_y,
            shear: [F::ZERO; 3],
        };
        let [x, y, z] = beams.sheared([dx, dy, dz]);
        let scale = F::ONE / z;
        beams.shear = [x * scale, y * scale, scale];
        beams
    }

    /// Along the axes of the sheared space: the dominant one last.
    #[inline(always)]
    fn sheared(&self, [x, y, z]: [F; 3]) -> [F; 3] {
        [self.pick(x, z, y), self.pick(y, x, z), self.pick(z, y, x)]
    }

    #[inline(always)]
    fn pick(&self, if_z: F, if_y: F, if_x: F) -> F {
        F::select(self.is_z, if_z, F::select(self.is_y, if_y, if_x))
    }

    /// Where each ray enters a box, and whether it does in its interval and no later than `limit`.
    #[inline(always)]
    fn cross(&self, b: &Bounds, limit: F) -> (F, F::Mask) {
        let (x, x_out) = self.slab(0, [b.min.x, b.max.x]);
        let (y, y_out) = self.slab(1, [b.min.y, b.max.y]);
        let (z, z_out) = self.slab(2, [b.min.z, b.max.z]);
        let enter = x.max(y).max(z);
        let exit = x_out.min(y_out).min(z_out) * EXIT;
        (enter, enter.max(self.t_min).le(exit.min(self.t_max).min(limit)))
    }

    #[inline(always)]
    fn slab(&self, axis: usize, planes: [f32; 2]) -> (F, F) {
        let (o, inv) = (self.o[axis], self.inv[axis]);
        let (a, b) = ((F::splat(planes[0]) - o) * inv, (F::splat(planes[1]) - o) * inv);
        (a.min(b), a.max(b))
    }

    /// A vertex in the sheared space.
    #[inline(always)]
    fn vertex(&self, v: Vec3) -> [F; 3] {
        let [ox, oy, oz] = self.o;
        let [x, y, z] = self.sheared([F::splat(v.x) - ox, F::splat(v.y) - oy, F::splat(v.z) - oz]);
        [x - self.shear[0] * z, y - self.shear[1] * z, z]
    }
}

/// The reciprocal of a direction's coordinate, given its size, kept finite.
#[inline(always)]
fn reciprocal<F: Float>(d: F, size: F) -> F {
    let least = F::splat(LEAST);
    F::ONE / F::select(size.gt(least), d, least.copysign(d))
}

/// The first hits so far.
struct Near<F: Float> {
    /// Nothing beyond this counts; when any hit will do, below 0 where there is one.
    t: F,
    /// The hit's u and v, times `det`.
    e1: F,
    e2: F,
    det: F,
    place: F::Uint,
}

impl<F: Float> Near<F> {
    /// Tests a triangle in some lanes.
    #[inline(always)]
    fn meet<'a, const ANY: bool>(
        &mut self,
        beams: &Beams<F>,
        (place, triangle): (u32, &Triangle),
        lanes: F::Mask,
        ray: impl Fn(usize) -> &'a Ray,
    ) {
        let [v0, v1, v2] = triangle.v;
        let (a, b, c) = (beams.vertex(v0), beams.vertex(v1), beams.vertex(v2));
        let e0 = c[0] * b[1] - c[1] * b[0];
        let e1 = a[0] * c[1] - a[1] * c[0];
        let e2 = b[0] * a[1] - b[1] * a[0];
        // Where one is NaN, the determinant is, and the lane is decided below.
        let (least, most) = (e0.min(e1).min(e2), e0.max(e1).max(e2));
        let inside = (least.ge(F::ZERO) | most.le(F::ZERO)) & lanes;
        if !inside.any() {
            return;
        }
        let (entry, is_crossed) = beams.cross(&triangle.bounds, self.t);
        let inside = inside & is_crossed;
        let det = e0 + e1 + e2;
        let numerator = (e0 * a[2] + e1 * b[2] + e2 * c[2]) * beams.shear[2];
        let reach =
            a[0].abs().max(a[1].abs()).max(b[0].abs()).max(b[1].abs()).max(c[0].abs()).max(c[1].abs());
        let enough = (reach * reach * FLAT).max(F::splat(LEAST_DETERMINANT)) + (numerator + det) * 0.0;
        let on_edge = least.eq(F::ZERO) | most.eq(F::ZERO);
        let sure = det.abs().ge(enough) & !on_edge;

        let hit = numerator / det;
        let t = F::select(entry.gt(hit), entry, hit);
        let number = F::Uint::splat(place);
        let is_first = t.lt(self.t) | (t.eq(self.t) & number.lt(self.place));
        let better = inside & sure & hit.ge(beams.t_min) & is_first;
        self.take::<ANY>(better, t, [e1, e2, det], number);

        let doubtful = inside & !sure;
        if doubtful.any() {
            self.decide::<ANY>((place, triangle), (doubtful.to_bits(), entry), ray);
        }
    }

    #[inline(always)]
    fn take<const ANY: bool>(&mut self, better: F::Mask, t: F, [e1, e2, det]: [F; 3], place: F::Uint) {
        self.place = F::Uint::select(better, place, self.place);
        // Nothing is entered before this.
        self.t = F::select(better, if ANY { F::splat(-1.0) } else { t }, self.t);
        if !ANY {
            self.e1 = F::select(better, e1, self.e1);
            self.e2 = F::select(better, e2, self.e2);
            self.det = F::select(better, det, self.det);
        }
    }

    /// Tests a triangle by the canonical routine, lane by lane, where its own box is crossed.
    #[inline(always)]
    fn decide<'a, const ANY: bool>(
        &mut self,
        (place, triangle): (u32, &Triangle),
        (mut lanes, entry): (u32, F),
        ray: impl Fn(usize) -> &'a Ray,
    ) {
        let entries = entry.to_array();
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % F::WIDTH;
            lanes &= lanes - 1;
            if let Some([t, u, v]) = exactly(triangle, ray(lane)) {
                let entry = entries.as_ref()[lane];
                let t = F::splat(if entry > t { entry } else { t });
                let number = F::Uint::splat(place);
                let better =
                    F::Mask::from_bits(1 << lane) & (t.lt(self.t) | (t.eq(self.t) & number.lt(self.place)));
                self.take::<ANY>(better, t, [F::splat(u), F::splat(v), F::ONE], number);
            }
        }
    }

    /// Says what the rays from `first` on hit.
    #[inline(always)]
    fn tell<A: Answers + ?Sized, const ANY: bool>(
        &self,
        few: &FewTriangles,
        (out, first): (&mut A, usize),
        count: usize,
        after_shapes: bool,
    ) {
        let places = self.place.to_array();
        let (u, v) = if ANY { (F::ZERO, F::ZERO) } else { (self.e1 / self.det, self.e2 / self.det) };
        F::to_rows(
            [self.t, u, v, F::ZERO],
            #[inline(always)]
            |lane, [t, u, v, _]| {
                if first + lane >= count {
                    return;
                }
                let Some(triangle) = few.triangles.get(places.as_ref()[lane] as usize) else {
                    if !after_shapes {
                        out.set(first + lane, Hit::MISS);
                    }
                    return;
                };
                let &Triangle { geometry, primitive, .. } = triangle;
                let hit = Hit { t, u, v, geometry, primitive, chain: Chain::EMPTY };
                if !ANY && after_shapes {
                    let mut best = out.get(first + lane);
                    best.offer(&hit);
                    out.set(first + lane, best);
                } else {
                    out.set(first + lane, hit);
                }
            },
        );
    }
}

/// t, u and v by the canonical routine.
#[cold]
#[inline(never)]
fn exactly(triangle: &Triangle, ray: &Ray) -> Option<[f32; 3]> {
    let local = LocalRay::new(ray)?;
    triangle::intersect(&triangle.v, &local, local.ray.t_max)
}
