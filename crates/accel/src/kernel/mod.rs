//! Kernels: a ray against the eight boxes of a node, and against a block of eight triangles.
//!
//! Searches are written once and compiled for each kernel, inside functions that the compiler may use the instruction set
//! for (`entry.rs`). The set is chosen when a scene is built.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
pub(crate) mod avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) mod avx512;
#[cfg(target_arch = "x86_64")]
mod bundle;
pub(crate) mod descent;
mod entry;
#[cfg(target_arch = "x86_64")]
mod leaf;
pub(crate) mod lines;
#[cfg(target_arch = "aarch64")]
pub(crate) mod neon;
pub(crate) mod pages;
pub(crate) mod prefetch;
pub(crate) mod scalar;
#[cfg(target_arch = "x86_64")]
pub(crate) mod sse;
pub(crate) mod stack;
#[cfg(target_arch = "x86_64")]
mod vec3;
mod wide;

use crate::{
    Isa,
    analytic::{
        block::{Block as ShapeBlock, Blocks, Found},
        octet::Octets,
    },
    lanes::Wide,
    local::LocalRay,
    node::{Block, Child, Node, bundle::Bundle},
    slab,
};
use descent::Descent;
use lines::Lines;
use straal_math::{Ray, simd::Simd};

/// What each ray of a slice visits next.
#[repr(C, align(64))]
pub(crate) struct Next<const N: usize>(pub [Child; N]);

/// A triangle's hit.
#[derive(Clone, Copy)]
pub(crate) struct Candidate {
    pub t: f32,
    /// The hit's u and v, times `det`.
    pub uv: [f32; 2],
    pub det: f32,
}

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

/// The greatest key of an entry of `limit`, which is above 0, or less.
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
    /// Hits that lie for certain in the triangle's own box, in the sense of `slab.rs`, no earlier than its entry. For those
    /// that aren't told so, the box is to be tested.
    pub boxed: u32,
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
    const NONE: Self =
        Self { hit: 0, doubtful: 0, boxed: 0, t: [0.0; 8], det: [0.0; 8], e1: [0.0; 8], e2: [0.0; 8] };
}

/// A hit of a block.
#[derive(Clone, Copy)]
pub(crate) struct LaneHit {
    pub lane: u32,
    /// Whether it lies for certain in the triangle's own box.
    pub boxed: bool,
    pub hit: Candidate,
}

impl LaneHit {
    pub const NONE: Self = Self { lane: 0, boxed: false, hit: Candidate { t: 0.0, uv: [0.0; 2], det: 1.0 } };
}

impl Lanes {
    /// The hit of a lane that is certain.
    #[inline(always)]
    pub fn certain(&self, lane: usize) -> LaneHit {
        // Each number apart: the compiler would make one wide load of several, which has to wait until the stores that wrote
        // them have left the processor.
        // SAFETY: a read of an initialised number.
        let number = |of: &[f32; 8]| unsafe { (&raw const of[lane & 7]).read_volatile() };
        LaneHit {
            lane: lane as u32,
            boxed: self.boxed >> (lane & 7) & 1 == 1,
            hit: Candidate {
                t: number(&self.t),
                uv: [number(&self.e1), number(&self.e2)],
                det: number(&self.det),
            },
        }
    }

    /// The first certain hit; of no use where there is none.
    #[inline(always)]
    pub fn first(&self) -> LaneHit {
        self.certain((self.hit.trailing_zeros() & 7) as usize)
    }

    /// 1 if one hit is certain and there is no other, else 0.
    #[inline(always)]
    pub fn is_one(&self) -> u32 {
        u32::from((self.hit != 0) & (self.hit & self.hit.wrapping_sub(1) == 0) & (self.doubtful == 0))
    }

    /// 1 if there may be hits, but not one that is certain alone, else 0.
    #[inline(always)]
    pub fn is_several(&self) -> u32 {
        u32::from((self.hit & self.hit.wrapping_sub(1) != 0) | (self.doubtful != 0))
    }
}

/// Something to be done in code compiled for an instruction set; what [`Task::run`] calls must be inlined to become part of it.
pub(crate) trait Task {
    type Answer;

    fn run(self) -> Self::Answer;
}

/// The vector part of the search. Implementations do the operations of `slab.rs`, `triangle.rs` and `local.rs` in each lane.
///
/// A value is the proof that the processor has the instruction set: only [`Chosen::new`] makes one, after asking.
pub(crate) trait Kernel: Wide {
    /// Whether rays that belong together are searched as a packet.
    const IN_PACKETS: bool = true;

    /// Whether it fetches ahead from large trees.
    const FETCHES: bool = true;

    /// `LocalRay::prepare`, written where the ray stays, since copying what was just written piece by piece would wait for
    /// the pieces. False, and of no use, when the ray isn't valid.
    #[inline(always)]
    fn prepare(self, ray: &Ray, out: &mut LocalRay) -> bool {
        let (local, is_valid) = LocalRay::prepare(ray);
        *out = local;
        is_valid
    }

    /// The boxes entered no later than `limit`.
    fn node(self, r: &LocalRay, node: &Node, limit: f32) -> Children;

    /// The mask alone of the boxes entered no later than `limit`.
    fn entered(self, r: &LocalRay, node: &Node, limit: f32) -> u32;

    /// One step down: pushes the children entered no later than `limit`, in the order of the ray's octant (see
    /// `bvh/slots.rs`), the first on top, and takes what is on top. `None`, with nothing done, where the stack is full.
    #[inline(always)]
    fn step<const N: usize>(
        self,
        r: &LocalRay,
        node: &Node,
        limit: f32,
        stack: &mut Descent<N>,
    ) -> Option<Child> {
        if stack.is_full() {
            return None;
        }
        let found = self.node(r, node, limit);
        for slot in FAR_TO_NEAR[usize::from(r.octant & 7)] {
            if found.mask >> slot & 1 == 1 {
                stack.push(found.keys[slot as usize & 7], node.children[slot as usize & 7]);
            }
        }
        Some(stack.pop())
    }

    /// The same in any order and without keys.
    #[inline(always)]
    fn step_any<const N: usize>(
        self,
        r: &LocalRay,
        node: &Node,
        limit: f32,
        stack: &mut Descent<N>,
    ) -> Option<Child> {
        if stack.is_full() {
            return None;
        }
        let mut mask = self.entered(r, node, limit);
        while mask != 0 {
            stack.push(0, node.children[(mask.trailing_zeros() & 7) as usize]);
            mask &= mask - 1;
        }
        Some(stack.pop())
    }

    /// A child entered no later than `limit`, while the others are pushed, without keys; `None` when there is none. The stack
    /// isn't full.
    #[inline(always)]
    fn any<const N: usize>(
        self,
        r: &LocalRay,
        node: &Node,
        limit: f32,
        stack: &mut Descent<N>,
    ) -> Option<Child> {
        match self.entered(r, node, limit) {
            0 => None,
            _ => self.step_any(r, node, limit, stack),
        }
    }

    /// [`Bundle::entries`].
    #[inline(always)]
    fn entries(self, bundle: &Bundle, node: &Node, limit: f32) -> (u32, [f32; 8]) {
        bundle.entries(node, limit)
    }

    /// [`Bundle::entering`].
    #[inline(always)]
    fn entering(self, bundle: &Bundle, node: &Node, slot: usize) -> u64 {
        bundle.entering(node, slot)
    }

    /// The rays that visit each class of child next.
    #[inline(always)]
    fn classes<const N: usize>(self, next: &Next<N>) -> [u64; 4] {
        let bit = |shift: u32| {
            let of = |(i, c): (usize, &Child)| (c.class() as u64 >> shift & 1) << i;
            next.0.iter().enumerate().map(of).sum::<u64>()
        };
        by_class(bit(1), bit(0))
    }

    /// The nearest child entered no later than `limit`, while the others are pushed, the farthest first or nearly so; `None`
    /// when there is none.
    #[inline(always)]
    fn nearest<const N: usize>(
        self,
        r: &LocalRay,
        node: &Node,
        limit: f32,
        stack: &mut Descent<N>,
    ) -> Option<Child> {
        let found = self.node(r, node, limit);
        if found.mask == 0 {
            return None;
        }
        push_by_insertion(node, &found, stack);
        Some(stack.pop())
    }

    /// The triangles that the ray's line may cross. No other is hit.
    fn inside(self, r: &LocalRay, block: &Block) -> u32;

    /// The triangles hit in [`t_min`, `limit`].
    fn block(self, r: &LocalRay, block: &Block, limit: f32) -> Lanes;

    /// The entry into a triangle's own padded box when the ray crosses it within its interval.
    #[inline(always)]
    fn own_box(self, r: &LocalRay, block: &Block, lane: usize) -> Option<f32> {
        slab::entry(&slab::triangle_bounds(&block.vertices(lane)), r)
    }

    /// Starts to load what a child names, where the instruction set can: to [`prefetch::TO_FIRST`] or [`prefetch::TO_SECOND`].
    #[inline(always)]
    fn prefetch<const HOW: u8>(self, _lines: &Lines, _child: Child) {}

    /// Itself, as one of all.
    fn chosen(self) -> Chosen;

    /// The same instruction set for what is written for any number of lanes; plain where it has none for that.
    #[inline(always)]
    fn simd(self) -> Simd {
        Simd::PLAIN
    }

    /// `ShapeBlock::meet`, compiled for the instruction set.
    fn meet(self, r: &LocalRay, block: ShapeBlock<'_>, limit: f32) -> Found;

    /// `analytic::octet::search`, compiled for the instruction set.
    fn octets<const ANY: bool>(self, few: &Blocks, rays: &[Ray], out: &mut Octets);

    /// Does a task in code compiled for the instruction set, of which all that it inlines becomes part.
    fn run<T: Task>(self, task: T) -> T::Answer;
}

/// Sets of rays by class, from those that have each of its two bits.
#[inline(always)]
fn by_class(high: u64, low: u64) -> [u64; 4] {
    [!high & !low, !high & low, high & !low, high & low]
}

/// The same number, computed before what follows: the compiler would put off until after a branch what is used only there.
/// Where branches are often guessed wrongly, the number is ready when that is found out.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn ahead(mut x: u32) -> u32 {
    // SAFETY: no instruction at all.
    unsafe {
        std::arch::asm!("/* {0:e} */", inout(reg) x, options(nomem, nostack, preserves_flags));
    }
    x
}

/// By a ray's octant, the slots of a node from the farthest to the nearest.
static FAR_TO_NEAR: [[u32; 8]; 8] = {
    let mut out = [[0; 8]; 8];
    let mut i = 0;
    while i < 64 {
        out[i / 8][i % 8] = (7 - i as u32 % 8) ^ (i as u32 / 8);
        i += 1;
    }
    out
};

/// Pushes the children that were found entered, the farthest first.
#[inline(always)]
fn push_by_insertion<const N: usize>(node: &Node, found: &Children, stack: &mut Descent<N>) {
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

/// The kernel of a scene.
#[derive(Clone, Copy)]
pub(crate) enum Chosen {
    Scalar(scalar::Scalar),
    #[cfg(target_arch = "aarch64")]
    Neon(neon::Neon),
    #[cfg(target_arch = "x86_64")]
    Sse(sse::Sse),
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(avx512::Avx512),
}

impl Chosen {
    /// That of an instruction set; where the processor doesn't have it, the scalar one.
    pub fn new(isa: Isa) -> Self {
        let vector = match isa {
            #[cfg(target_arch = "aarch64")]
            Isa::Neon => neon::Neon::new().map(Self::Neon),
            #[cfg(target_arch = "x86_64")]
            Isa::Sse => sse::Sse::new().map(Self::Sse),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => avx2::Avx2::new().map(Self::Avx2),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => avx512::Avx512::new().map(Self::Avx512),
            _ => None,
        };
        vector.unwrap_or(Self::Scalar(scalar::Scalar))
    }
}

#[cfg(all(test, any(target_arch = "x86_64", target_arch = "aarch64")))]
mod tests;
