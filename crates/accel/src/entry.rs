//! The functions through which a search enters code compiled for an instruction set.
//!
//! Here meets what must not know of each other: the kernels, and the structures of all kinds.

use crate::{
    hit::{Chain, Cost, Hit},
    input::Shapes,
    kernel::{Chosen, Kernel, Task},
    local::LocalRay,
    query::{Descend, DescendMany, Place, Query, Search},
    stage::{GroupData, Stage},
    structure::{Searcher, textbook},
};
use straal_math::Ray;

/// Every kernel searches whatever structures there are.
impl<K: Kernel> Descend for K {
    type Searcher = Searcher;

    #[inline]
    fn closest_in<const COUNT: bool>(self, q: &mut Query<'_, Self, COUNT>, at: &Place<'_>, best: &mut Hit) {
        self.run(ClosestIn(q, at, best));
    }

    #[inline]
    fn occluded_in<const COUNT: bool>(self, q: &mut Query<'_, Self, COUNT>, at: &Place<'_>) -> bool {
        self.run(OccludedIn(q, at))
    }
}

impl<K: Kernel> DescendMany for K {
    fn closest_slice(
        self,
        q: &mut Query<'_, Self, false>,
        group: &GroupData,
        rays: &[Ray],
        hits: &mut [Hit],
    ) {
        self.run(ClosestSlice(q, group, rays, hits));
    }

    fn occluded_slice(
        self,
        q: &mut Query<'_, Self, false>,
        group: &GroupData,
        rays: &[Ray],
        blocked: &mut [bool],
    ) {
        self.run(OccludedSlice(q, group, rays, blocked));
    }
}

/// A task for each way to search, since closures can't be made to be inlined.
struct ClosestIn<'a, 'q, K: Descend, const COUNT: bool>(
    &'a mut Query<'q, K, COUNT>,
    &'a Place<'a>,
    &'a mut Hit,
);

impl<K: Kernel, const COUNT: bool> Task for ClosestIn<'_, '_, K, COUNT> {
    type Answer = ();

    #[inline(always)]
    fn run(self) {
        closest_in(self.0, self.1, self.2);
    }
}

struct OccludedIn<'a, 'q, K: Descend, const COUNT: bool>(&'a mut Query<'q, K, COUNT>, &'a Place<'a>);

impl<K: Kernel, const COUNT: bool> Task for OccludedIn<'_, '_, K, COUNT> {
    type Answer = bool;

    #[inline(always)]
    fn run(self) -> bool {
        occluded_in(self.0, self.1)
    }
}

struct ClosestSlice<'a, 'q, K: Descend>(&'a mut Query<'q, K, false>, &'a GroupData, &'a [Ray], &'a mut [Hit]);

impl<K: Kernel> Task for ClosestSlice<'_, '_, K> {
    type Answer = ();

    #[inline(always)]
    fn run(self) {
        closest_slice(self.0, self.1, self.2, self.3);
    }
}

struct OccludedSlice<'a, 'q, K: Descend>(
    &'a mut Query<'q, K, false>,
    &'a GroupData,
    &'a [Ray],
    &'a mut [bool],
);

impl<K: Kernel> Task for OccludedSlice<'_, '_, K> {
    type Answer = ();

    #[inline(always)]
    fn run(self) {
        occluded_slice(self.0, self.1, self.2, self.3);
    }
}

struct ClosestEach<'a, 'q, K: Descend>(&'a mut Query<'q, K, false>, &'a [Ray], &'a mut [Hit]);

impl<K: Kernel> Task for ClosestEach<'_, '_, K> {
    type Answer = ();

    #[inline(always)]
    fn run(self) {
        closest_each(self.0, self.1, self.2);
    }
}

struct OccludedEach<'a, 'q, K: Descend>(&'a mut Query<'q, K, false>, &'a [Ray], &'a mut [bool]);

impl<K: Kernel> Task for OccludedEach<'_, '_, K> {
    type Answer = ();

    #[inline(always)]
    fn run(self) {
        occluded_each(self.0, self.1, self.2);
    }
}

/// Does the same with whichever kernel was chosen.
macro_rules! with_kernel {
    ($chosen:expr, $k:ident => $body:expr) => {
        match $chosen {
            Chosen::Scalar($k) => $body,
            #[cfg(target_arch = "aarch64")]
            Chosen::Neon($k) => $body,
            #[cfg(target_arch = "x86_64")]
            Chosen::Sse($k) => $body,
            #[cfg(target_arch = "x86_64")]
            Chosen::Avx2($k) => $body,
            #[cfg(target_arch = "x86_64")]
            Chosen::Avx512($k) => $body,
        }
    };
}

/// What is asked, and by which kernel.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub stage: &'a Stage<Searcher>,
    pub kernel: Chosen,
    /// Whether the rays of a slice are searched together.
    pub many: bool,
    pub shapes: &'a dyn Shapes,
}

/// Slices shorter than this go one ray at a time: setting up many in flight wouldn't pay. They also stay out of the
/// functions that make room for many, since touching so much stack takes longer than a search.
const MANY: usize = 8;

impl Asked<'_> {
    /// The first hit of each ray; looks at as many rays as there are hits, and the other way round.
    pub fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        let stage = self.stage;
        let n = if rays.len() < hits.len() { rays.len() } else { hits.len() };
        let (rays, hits) = (&rays[..n], &mut hits[..n]);
        let together = n >= MANY && self.many && matches!(stage.searchers[0], Searcher::Bvh(_));
        match together {
            true => {
                with_kernel!(self.kernel, k => k.closest_slice(&mut query(k, self), &stage.groups[0], rays, hits))
            }
            false => with_kernel!(self.kernel, k => k.run(ClosestEach(&mut query(k, self), rays, hits))),
        }
    }

    /// Whether each ray hits anything; looks at as many rays as there are answers, and the other way round.
    pub fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        let stage = self.stage;
        let n = if rays.len() < blocked.len() { rays.len() } else { blocked.len() };
        let (rays, blocked) = (&rays[..n], &mut blocked[..n]);
        let together = n >= MANY && self.many && matches!(stage.searchers[0], Searcher::Bvh(_));
        match together {
            true => {
                with_kernel!(self.kernel, k => k.occluded_slice(&mut query(k, self), &stage.groups[0], rays, blocked))
            }
            false => with_kernel!(self.kernel, k => k.run(OccludedEach(&mut query(k, self), rays, blocked))),
        }
    }

    /// The first hit of a ray, with the number of tests it took.
    pub fn closest_counted(&self, ray: &Ray) -> (Hit, Cost) {
        fn counted<K: Kernel>(kernel: K, asked: &Asked<'_>, ray: &LocalRay) -> (Hit, Cost) {
            let mut q = query::<K, true>(kernel, asked);
            let mut best = Hit::limit(ray.ray.t_max);
            let at = Place { group: &asked.stage.groups[0], ray, chain: &Chain::EMPTY };
            kernel.closest_in(&mut q, &at, &mut best);
            (best.finished(), q.cost)
        }
        match LocalRay::new(ray) {
            Some(ray) => with_kernel!(self.kernel, k => counted(k, self, &ray)),
            None => (Hit::MISS, Cost::default()),
        }
    }

    /// Whether a ray hits anything, with the number of tests it took.
    pub fn occluded_counted(&self, ray: &Ray) -> (bool, Cost) {
        fn counted<K: Kernel>(kernel: K, asked: &Asked<'_>, ray: &LocalRay) -> (bool, Cost) {
            let mut q = query::<K, true>(kernel, asked);
            let at = Place { group: &asked.stage.groups[0], ray, chain: &Chain::EMPTY };
            (kernel.occluded_in(&mut q, &at), q.cost)
        }
        match LocalRay::new(ray) {
            Some(ray) => with_kernel!(self.kernel, k => counted(k, self, &ray)),
            None => (false, Cost::default()),
        }
    }
}

#[inline(always)]
fn query<'a, K: Kernel, const COUNT: bool>(kernel: K, asked: &Asked<'a>) -> Query<'a, K, COUNT> {
    Query { kernel, scene: asked.stage, shapes: asked.shapes, cost: Cost::default() }
}

/// The first hit in the world of each ray, one after the other.
#[inline(always)]
fn closest_each<K: Kernel>(q: &mut Query<'_, K, false>, rays: &[Ray], hits: &mut [Hit]) {
    let group = &q.scene.groups[0];
    for (ray, hit) in rays.iter().zip(hits) {
        // Written where it stays: copying what was just written piece by piece would wait for the pieces.
        let mut local = LocalRay::IDLE;
        if !q.kernel.prepare(ray, &mut local) {
            *hit = Hit::MISS;
            continue;
        }
        *hit = Hit::limit(local.ray.t_max);
        closest_in(q, &Place { group, ray: &local, chain: &Chain::EMPTY }, hit);
        if !hit.is_hit() {
            *hit = Hit::MISS;
        }
    }
}

/// Whether each ray hits anything in the world, one after the other.
#[inline(always)]
fn occluded_each<K: Kernel>(q: &mut Query<'_, K, false>, rays: &[Ray], blocked: &mut [bool]) {
    let group = &q.scene.groups[0];
    for (ray, blocked) in rays.iter().zip(blocked) {
        let mut local = LocalRay::IDLE;
        *blocked = q.kernel.prepare(ray, &mut local)
            && occluded_in(q, &Place { group, ray: &local, chain: &Chain::EMPTY });
    }
}

/// `Descend::closest_in` in code that may use the instruction set.
#[inline(always)]
fn closest_in<K: Kernel, const COUNT: bool>(q: &mut Query<'_, K, COUNT>, at: &Place<'_>, best: &mut Hit) {
    for &object in &at.group.unbounded {
        q.object_closest(at, object, best);
    }
    let stage = q.scene;
    match &stage.searchers[at.group.index] {
        Searcher::Bvh(s) => s.closest(q, at, best),
        searcher => q.by(Plainly(q.kernel.chosen()), |q| closest_by(q, searcher, at, best)),
    }
}

/// `Descend::occluded_in` in code that may use the instruction set.
#[inline(always)]
fn occluded_in<K: Kernel, const COUNT: bool>(q: &mut Query<'_, K, COUNT>, at: &Place<'_>) -> bool {
    let stage = q.scene;
    at.group.unbounded.iter().any(|&object| q.object_occluded(at, object))
        || match &stage.searchers[at.group.index] {
            Searcher::Bvh(s) => s.occluded(q, at),
            searcher => q.by(Plainly(q.kernel.chosen()), |q| occluded_by(q, searcher, at)),
        }
}

/// Who searches the structures of the textbook. They gain nothing by an instruction set, so that they are compiled once and not for every
/// kernel; this one is asked again where an instance has the wide tree.
#[derive(Clone, Copy)]
struct Plainly(Chosen);

impl Descend for Plainly {
    type Searcher = Searcher;

    fn closest_in<const COUNT: bool>(self, q: &mut Query<'_, Self, COUNT>, at: &Place<'_>, best: &mut Hit) {
        match &q.scene.searchers[at.group.index] {
            Searcher::Bvh(_) => with_kernel!(self.0, k => q.by(k, |q| k.closest_in(q, at, best))),
            searcher => {
                for &object in &at.group.unbounded {
                    q.object_closest(at, object, best);
                }
                closest_by(q, searcher, at, best);
            }
        }
    }

    fn occluded_in<const COUNT: bool>(self, q: &mut Query<'_, Self, COUNT>, at: &Place<'_>) -> bool {
        match &q.scene.searchers[at.group.index] {
            Searcher::Bvh(_) => with_kernel!(self.0, k => q.by(k, |q| k.occluded_in(q, at))),
            searcher => {
                at.group.unbounded.iter().any(|&object| q.object_occluded(at, object))
                    || occluded_by(q, searcher, at)
            }
        }
    }
}

/// Searches with a structure of the textbook.
#[inline(never)]
fn closest_by<const COUNT: bool>(
    q: &mut Query<'_, Plainly, COUNT>,
    searcher: &Searcher,
    at: &Place<'_>,
    best: &mut Hit,
) {
    textbook!(searcher, s => s.closest(q, at, best));
}

/// The same for any hit.
#[inline(never)]
fn occluded_by<const COUNT: bool>(
    q: &mut Query<'_, Plainly, COUNT>,
    searcher: &Searcher,
    at: &Place<'_>,
) -> bool {
    textbook!(searcher, s => s.occluded(q, at))
}

/// `Descend::closest_slice` in code that may use the instruction set. Only the wide tree searches slices.
#[inline(always)]
fn closest_slice<K: Kernel>(q: &mut Query<'_, K, false>, group: &GroupData, rays: &[Ray], hits: &mut [Hit]) {
    let stage = q.scene;
    match &stage.searchers[group.index] {
        Searcher::Bvh(bvh) => bvh.closest_many(q, group, rays, hits),
        _ => hits.fill(Hit::MISS),
    }
}

/// `Descend::occluded_slice` in code that may use the instruction set.
#[inline(always)]
fn occluded_slice<K: Kernel>(
    q: &mut Query<'_, K, false>,
    group: &GroupData,
    rays: &[Ray],
    blocked: &mut [bool],
) {
    let stage = q.scene;
    match &stage.searchers[group.index] {
        Searcher::Bvh(bvh) => bvh.occluded_many(q, group, rays, blocked),
        _ => blocked.fill(false),
    }
}
