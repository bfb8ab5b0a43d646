//! Queues: paths that wait for the same computation.

use super::Path;
use crate::material::BsdfKind;
use straal_accel::Hit;
use straal_math::Ray;
use straal_math::lowdisc::Pattern;
use straal_math::simd::Simd;

/// What must be computed where a ray arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// It met nothing: the surroundings alone are seen.
    Missed,
    /// The surface scatters nothing, but may shine.
    Dark,
    /// Light is scattered by a BSDF of one kind.
    Scattering(BsdfKind),
    /// Light is scattered by a BSDF whose kind differs from point to point.
    Varying,
}

/// Paths whose rays have arrived where the same must be computed.
#[derive(Clone, Copy, Debug)]
pub struct Queue<'a, S> {
    /// What must be computed.
    pub kind: Kind,
    /// Width and height of the whole picture in pixels.
    pub size: [u32; 2],
    /// Source of random numbers.
    pub pattern: Pattern,
    /// By which instruction set many vertices are worked on at once.
    pub simd: Simd,
    /// Which of the following are in the queue, those of one material one after the other.
    pub order: &'a [u32],
    /// All paths of the driver's turn.
    pub paths: &'a [Path<S>],
    /// Their rays.
    pub rays: &'a [Ray],
    /// What each ray hit.
    pub hits: &'a [Hit],
}

/// A path whose ray has arrived.
#[derive(Clone, Copy, Debug)]
pub struct Arrival<'a, S> {
    /// The path.
    pub path: &'a Path<S>,
    /// Its ray.
    pub ray: &'a Ray,
    /// What the ray hit.
    pub hit: &'a Hit,
}

impl<'a, S> Queue<'a, S> {
    /// One path by its number in the driver's turn.
    #[inline(always)]
    pub fn arrival(&self, index: u32) -> Arrival<'a, S> {
        let i = index as usize;
        Arrival { path: &self.paths[i], ray: &self.rays[i], hit: &self.hits[i] }
    }

    /// All paths of the queue.
    #[inline]
    pub fn arrivals(&self) -> impl Iterator<Item = Arrival<'a, S>> + use<'a, S> {
        let queue = Queue { ..*self };
        self.order.iter().map(move |&i| queue.arrival(i))
    }
}
