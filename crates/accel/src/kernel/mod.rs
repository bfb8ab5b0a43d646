//! Kernels: a ray against the eight boxes of a node, and against a block of eight triangles.
//!
//! The traversal in `bvh/traverse.rs` is written once and compiled for each kernel, inside a function that the
//! compiler may use the instruction set for. The set is chosen once per slice of rays.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
pub(crate) mod descent;
mod entry;
mod scalar;
#[cfg(target_arch = "x86_64")]
mod sse;
pub(crate) mod stack;

use crate::{
    bvh::{Block, Child, Node},
    hit::{Cost, Hit},
    input::Shapes,
    local::LocalRay,
    query::Query,
    scene::Scene,
    structure::{Place, Search, each},
};
use descent::Descent;
use straal_math::Ray;

/// Which of a node's children a ray enters.
#[derive(Clone, Copy)]
pub(crate) struct Children {
    /// One bit for each.
    pub mask: u32,
    /// By slot: bits of the entry, the lowest three replaced by the slot, so that keys are ordered as entries are;
    /// [`NOT_ENTERED`] where the mask hasn't it.
    pub keys: [u32; 8],
}

/// After every key that occurs.
const NOT_ENTERED: u32 = i32::MAX as u32;

impl Children {
    pub const NONE: Self = Self { mask: 0, keys: [NOT_ENTERED; 8] };
}

/// The greatest key of an entry of `limit`, which isn't below `LEAST_ENTRY`, or less.
#[inline(always)]
pub(crate) fn key_of_limit(limit: f32) -> u32 {
    limit.to_bits() | 7
}

/// Which of a block's triangles are hit, and where.
pub(crate) struct Lanes {
    /// Lanes whose hit is certain.
    pub hit: u32,
    /// Lanes with an edge function of 0, or too flat for single precision, for the scalar routine to decide.
    pub doubtful: u32,
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
    const NONE: Self = Self { hit: 0, doubtful: 0, t: [0.0; 8], det: [0.0; 8], e1: [0.0; 8], e2: [0.0; 8] };
}

/// The vector part of the search. Implementations do the operations of `slab.rs` and `triangle.rs` in each lane.
///
/// A value is the proof that the processor has the instruction set: only `with_kernel` makes one, after asking.
pub(crate) trait Kernel: Copy {
    /// The boxes entered no later than `limit`.
    fn node(self, r: &LocalRay, node: &Node, limit: f32) -> Children;

    /// The mask alone of the boxes entered in the ray's interval.
    fn entered(self, r: &LocalRay, node: &Node) -> u32;

    /// One step down: the nearest child that was found entered, while the others are pushed; if there is none, what is on
    /// top of the stack.
    fn descend(self, node: &Node, found: &Children, stack: &mut Descent) -> Child;

    /// The same with any child, and without keys.
    fn descend_any(self, node: &Node, mask: u32, stack: &mut Descent) -> Child;

    /// Pushes the children that were found entered, the farthest first.
    fn push_sorted(self, node: &Node, found: &Children, stack: &mut Descent);

    /// The triangles that the ray's line may cross. No other is hit.
    fn inside(self, r: &LocalRay, block: &Block) -> u32;

    /// The triangles hit in [`t_min`, `limit`].
    fn block(self, r: &LocalRay, block: &Block, limit: f32) -> Lanes;

    /// Starts to load what a child names, where the instruction set can.
    fn prefetch(self, nodes: &[Node], blocks: &[Block], child: Child);

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

/// [`Kernel::push_sorted`] of kernels without a sort of their own.
#[inline(always)]
fn push_by_insertion(node: &Node, found: &Children, stack: &mut Descent) {
    let mut mask = found.mask;
    let mut sorted = [0; 8];
    let mut count = 0_usize;
    while mask != 0 {
        let key = found.keys[(mask.trailing_zeros() & 7) as usize];
        mask &= mask - 1;
        let mut i = count & 7;
        while i > 0 && sorted[i - 1] < key {
            sorted[i] = sorted[i - 1];
            i -= 1;
        }
        sorted[i] = key;
        count += 1;
    }
    for &key in &sorted[..count] {
        stack.push(key, node.children[(key & 7) as usize]);
    }
}

/// [`Kernel::descend`] of kernels that gain nothing by doing without branches.
#[inline(always)]
fn descend_sorted(node: &Node, found: &Children, stack: &mut Descent) -> Child {
    push_by_insertion(node, found, stack);
    stack.pop()
}

/// [`Kernel::descend_any`] of the same.
#[inline(always)]
fn descend_by_mask(node: &Node, mut mask: u32, stack: &mut Descent) -> Child {
    while mask != 0 {
        stack.push(0, node.children[(mask.trailing_zeros() & 7) as usize]);
        mask &= mask - 1;
    }
    stack.pop()
}

/// [`Kernel::prefetch`] of all x86 kernels.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn prefetch(nodes: &[Node], blocks: &[Block], child: Child) {
    use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    // Computed, since a branch on the class would be guessed wrongly. For an object or the end, some other place is
    // loaded, which does no harm.
    let leaf = child.leaf();
    let from_nodes = blocks.as_ptr().addr().wrapping_sub(nodes.as_ptr().addr());
    let size = size_of::<Node>() + leaf * (size_of::<Block>() - size_of::<Node>());
    let offset = (from_nodes & 0_usize.wrapping_sub(leaf)).wrapping_add(child.index() * size);
    let start = nodes.as_ptr().cast::<i8>().wrapping_add(offset);
    for line in 0..LINES {
        // SAFETY: a prefetch changes nothing, whatever the address. SSE is part of x86-64.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(line * 64)) };
    }
}

/// Cache lines of the larger of node and block.
#[cfg(target_arch = "x86_64")]
const LINES: usize = size_of::<Block>() / 64;

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
