//! Kernels: a ray against the eight boxes of a node, and against a block of eight triangles.
//!
//! The traversal in `bvh/traverse.rs` is written once and compiled for each kernel, inside a function that the
//! compiler may use the instruction set for. The set is chosen once per slice of rays.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod entry;
mod scalar;
#[cfg(target_arch = "x86_64")]
mod sse;
pub(crate) mod stack;

use crate::{
    bvh::{Block, Node},
    hit::{Chain, Cost, Hit},
    input::Shapes,
    isa::Isa,
    local::LocalRay,
    query::Query,
    scene::Scene,
    structure::Place,
};
use straal_math::Ray;

/// Which of a node's children a ray enters.
pub(crate) struct Children {
    /// How many.
    pub count: usize,
    /// The first `count`: bits of the entry (not below 0), the lowest three replaced by the child's slot.
    pub keys: [u32; 8],
}

impl Children {
    const NONE: Self = Self { count: 0, keys: [0; 8] };
}

/// Which of a block's triangles are hit, and where.
pub(crate) struct Lanes {
    /// Lanes whose hit is certain.
    pub hit: u32,
    /// Lanes with an edge function of 0, for the scalar routine to decide.
    pub zero: u32,
    /// Ray parameters.
    pub t: [f32; 8],
    /// Sum of the edge functions.
    pub det: [f32; 8],
    /// Edge function opposite to vertex 1.
    pub e1: [f32; 8],
    /// Edge function opposite to vertex 2.
    pub e2: [f32; 8],
}

impl Lanes {
    const NONE: Self = Self { hit: 0, zero: 0, t: [0.0; 8], det: [0.0; 8], e1: [0.0; 8], e2: [0.0; 8] };
}

/// The vector part of the search. Implementations do the operations of `slab.rs` and `triangle.rs` in each lane.
///
/// A value is the proof that the processor has the instruction set: only `with_kernel` makes one, after asking.
pub(crate) trait Kernel: Copy {
    /// The boxes entered no later than `limit`.
    fn node(self, r: &LocalRay, node: &Node, limit: f32) -> Children;

    /// The triangles hit in [`t_min`, `limit`].
    fn block(self, r: &LocalRay, block: &Block, limit: f32) -> Lanes;

    /// `Query::closest_in`, compiled for the instruction set.
    fn closest_in<S: Shapes, const COUNT: bool>(
        self,
        q: &mut Query<'_, Self, S, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    );

    /// `Query::occluded_in`, compiled for the instruction set.
    fn occluded_in<S: Shapes, const COUNT: bool>(
        self,
        q: &mut Query<'_, Self, S, COUNT>,
        at: &Place<'_>,
    ) -> bool;

    /// The first hit of each ray.
    fn closest_slice<S: Shapes>(self, scene: &Scene, shapes: &S, rays: &[Ray], hits: &mut [Hit]);

    /// Whether each ray hits anything.
    fn occluded_slice<S: Shapes>(self, scene: &Scene, shapes: &S, rays: &[Ray], blocked: &mut [bool]);
}

/// Does the same with whichever kernel the instruction set has.
macro_rules! with_kernel {
    ($isa:expr, $k:ident => $body:expr) => {{
        #[cfg(target_arch = "x86_64")]
        {
            if $isa == Isa::Avx512
                && let Some($k) = avx512::Avx512::new()
            {
                return $body;
            }
            if $isa == Isa::Avx2
                && let Some($k) = avx2::Avx2::new()
            {
                return $body;
            }
            if $isa == Isa::Sse
                && let Some($k) = sse::Sse::new()
            {
                return $body;
            }
        }
        let $k = scalar::Scalar;
        $body
    }};
}

pub(crate) fn closest<S: Shapes>(scene: &Scene, shapes: &S, rays: &[Ray], hits: &mut [Hit]) {
    with_kernel!(scene.isa(), k => k.closest_slice(scene, shapes, rays, hits))
}

pub(crate) fn occluded<S: Shapes>(scene: &Scene, shapes: &S, rays: &[Ray], blocked: &mut [bool]) {
    with_kernel!(scene.isa(), k => k.occluded_slice(scene, shapes, rays, blocked))
}

pub(crate) fn closest_counted<S: Shapes>(scene: &Scene, shapes: &S, ray: &Ray) -> (Hit, Cost) {
    with_kernel!(scene.isa(), k => closest_one::<_, S, true>(k, scene, shapes, ray))
}

pub(crate) fn occluded_counted<S: Shapes>(scene: &Scene, shapes: &S, ray: &Ray) -> (bool, Cost) {
    with_kernel!(scene.isa(), k => occluded_one::<_, S, true>(k, scene, shapes, ray))
}

/// `Kernel::closest_slice` without the change of instruction set.
#[inline(always)]
fn closest_rays<K: Kernel, S: Shapes>(kernel: K, scene: &Scene, shapes: &S, rays: &[Ray], hits: &mut [Hit]) {
    for (ray, hit) in rays.iter().zip(hits) {
        *hit = closest_one::<K, S, false>(kernel, scene, shapes, ray).0;
    }
}

/// `Kernel::occluded_slice` without the change of instruction set.
#[inline(always)]
fn occluded_rays<K: Kernel, S: Shapes>(
    kernel: K,
    scene: &Scene,
    shapes: &S,
    rays: &[Ray],
    blocked: &mut [bool],
) {
    for (ray, blocked) in rays.iter().zip(blocked) {
        *blocked = occluded_one::<K, S, false>(kernel, scene, shapes, ray).0;
    }
}

#[inline(always)]
fn closest_one<K: Kernel, S: Shapes, const COUNT: bool>(
    kernel: K,
    scene: &Scene,
    shapes: &S,
    ray: &Ray,
) -> (Hit, Cost) {
    let mut q = Query::<K, S, COUNT> { kernel, scene, shapes, cost: Cost::default() };
    let Some(local) = LocalRay::new(ray) else { return (Hit::MISS, q.cost) };
    let mut best = Hit::limit(local.ray.t_max);
    kernel.closest_in(
        &mut q,
        &Place { group: &scene.groups[0], ray: &local, chain: &Chain::EMPTY },
        &mut best,
    );
    (if best.is_hit() { best } else { Hit::MISS }, q.cost)
}

#[inline(always)]
fn occluded_one<K: Kernel, S: Shapes, const COUNT: bool>(
    kernel: K,
    scene: &Scene,
    shapes: &S,
    ray: &Ray,
) -> (bool, Cost) {
    let mut q = Query::<K, S, COUNT> { kernel, scene, shapes, cost: Cost::default() };
    let Some(local) = LocalRay::new(ray) else { return (false, q.cost) };
    let at = Place { group: &scene.groups[0], ray: &local, chain: &Chain::EMPTY };
    (kernel.occluded_in(&mut q, &at), q.cost)
}
