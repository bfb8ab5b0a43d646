//! Where the answers of a slice of rays go, and what is known of them before the tree is walked.

use crate::hit::Hit;

/// An answer for each ray.
pub(crate) trait Answers {
    /// What was found of a ray so far; of no use before [`Self::set`].
    fn get(&self, ray: usize) -> Hit;

    /// Says what a ray hits.
    fn set(&mut self, ray: usize, hit: Hit);
}

/// The first hits.
impl Answers for [Hit] {
    #[inline(always)]
    fn get(&self, ray: usize) -> Hit {
        self[ray]
    }

    #[inline(always)]
    fn set(&mut self, ray: usize, hit: Hit) {
        self[ray] = hit;
    }
}

/// Whether anything is hit; what, isn't known.
impl Answers for [bool] {
    #[inline(always)]
    fn get(&self, ray: usize) -> Hit {
        if self[ray] { Hit { geometry: 0, ..Hit::MISS } } else { Hit::MISS }
    }

    #[inline(always)]
    fn set(&mut self, ray: usize, hit: Hit) {
        self[ray] = hit.is_hit();
    }
}
