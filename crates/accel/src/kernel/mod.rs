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
    hit::{Cost, Hit},
    input::Shapes,
    local::LocalRay,
    query::Query,
    scene::Scene,
    structure::{Place, Search, each},
};
use straal_math::Ray;

/// Which of a node's children a ray enters.
pub(crate) struct Children {
    /// One bit for each.
    pub mask: u32,
    /// By slot, where the mask has it: bits of the entry (not below 0), the lowest three replaced by the slot.
    pub keys: [u32; 8],
}

impl Children {
    const NONE: Self = Self { mask: 0, keys: [0; 8] };
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

    /// Starts to load what will be needed soon, where the instruction set can.
    fn prefetch<T>(self, what: &T);

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

/// [`Kernel::prefetch`] of all x86 kernels.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn prefetch<T>(what: &T) {
    use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    let start = (&raw const *what).cast::<i8>();
    let mut offset = 0;
    while offset < size_of::<T>() {
        // SAFETY: the address is inside `what`, and a prefetch changes nothing. SSE is part of x86-64.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(offset)) };
        offset += 64;
    }
}

/// Does the same with whichever kernel the instruction set has.
macro_rules! with_kernel {
    ($isa:expr, $k:ident => $body:expr) => {{
        #[cfg(target_arch = "x86_64")]
        {
            use crate::isa::Isa;
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
        // Whoever has none of these.
        let _: crate::isa::Isa = $isa;
        let $k = scalar::Scalar;
        $body
    }};
}

pub(crate) fn closest<S: Shapes>(scene: &Scene, shapes: &S, rays: &[Ray], hits: &mut [Hit]) {
    fn few<K: Kernel, S: Shapes>(kernel: K, scene: &Scene, shapes: &S, rays: &[Ray], hits: &mut [Hit]) {
        let mut q = Query::<K, S, false> { kernel, scene, shapes, cost: Cost::default() };
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = q.closest(&scene.groups[0], ray);
        }
    }
    let n = if rays.len() < hits.len() { rays.len() } else { hits.len() };
    let (rays, hits) = (&rays[..n], &mut hits[..n]);
    if n < MANY || !scene.many() {
        with_kernel!(scene.isa(), k => few(k, scene, shapes, rays, hits));
        return;
    }
    with_kernel!(scene.isa(), k => k.closest_slice(scene, shapes, rays, hits))
}

pub(crate) fn occluded<S: Shapes>(scene: &Scene, shapes: &S, rays: &[Ray], blocked: &mut [bool]) {
    fn few<K: Kernel, S: Shapes>(kernel: K, scene: &Scene, shapes: &S, rays: &[Ray], blocked: &mut [bool]) {
        let mut q = Query::<K, S, false> { kernel, scene, shapes, cost: Cost::default() };
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = q.occluded(&scene.groups[0], ray);
        }
    }
    let n = if rays.len() < blocked.len() { rays.len() } else { blocked.len() };
    let (rays, blocked) = (&rays[..n], &mut blocked[..n]);
    if n < MANY || !scene.many() {
        with_kernel!(scene.isa(), k => few(k, scene, shapes, rays, blocked));
        return;
    }
    with_kernel!(scene.isa(), k => k.occluded_slice(scene, shapes, rays, blocked))
}

pub(crate) fn closest_counted<S: Shapes>(scene: &Scene, shapes: &S, ray: &Ray) -> (Hit, Cost) {
    fn counted<K: Kernel, S: Shapes>(kernel: K, scene: &Scene, shapes: &S, ray: &Ray) -> (Hit, Cost) {
        let mut q = Query::<K, S, true> { kernel, scene, shapes, cost: Cost::default() };
        (q.closest(&scene.groups[0], ray), q.cost)
    }
    with_kernel!(scene.isa(), k => counted(k, scene, shapes, ray))
}

pub(crate) fn occluded_counted<S: Shapes>(scene: &Scene, shapes: &S, ray: &Ray) -> (bool, Cost) {
    fn counted<K: Kernel, S: Shapes>(kernel: K, scene: &Scene, shapes: &S, ray: &Ray) -> (bool, Cost) {
        let mut q = Query::<K, S, true> { kernel, scene, shapes, cost: Cost::default() };
        (q.occluded(&scene.groups[0], ray), q.cost)
    }
    with_kernel!(scene.isa(), k => counted(k, scene, shapes, ray))
}

/// Slices shorter than this go one ray at a time: setting up many in flight wouldn't pay. They also stay out of the
/// functions that make room for many, since touching so much stack takes longer than a search.
const MANY: usize = 8;

/// `Kernel::closest_slice` without the change of instruction set.
#[inline(always)]
fn closest_rays<K: Kernel, S: Shapes>(kernel: K, scene: &Scene, shapes: &S, rays: &[Ray], hits: &mut [Hit]) {
    let group = &scene.groups[0];
    let mut q = Query::<K, S, false> { kernel, scene, shapes, cost: Cost::default() };
    each!(&group.searcher, s => s.closest_many(&mut q, group, rays, hits));
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
    let group = &scene.groups[0];
    let mut q = Query::<K, S, false> { kernel, scene, shapes, cost: Cost::default() };
    each!(&group.searcher, s => s.occluded_many(&mut q, group, rays, blocked));
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests;
