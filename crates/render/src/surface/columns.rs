//! Columns: what many vertices have, number by number, so that whole vectors are read and written.

use straal_math::Vec3;
use straal_math::simd::{self, Float};

/// Vertices that are worked on together: what is known of them stays in the first-level cache between the paragraphs of a
/// step.
pub const BLOCK: usize = 2 * simd::BLOCK;

/// Room for a block, and for what a vector writes that begins in it and ends beyond.
pub(super) const ROOM: usize = BLOCK + simd::BLOCK;

/// A number of each vertex.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Column([f32; ROOM]);

impl Default for Column {
    fn default() -> Self {
        Self([0.0; ROOM])
    }
}

impl Column {
    /// That of vertex `i`.
    #[inline(always)]
    pub fn at(&self, i: usize) -> f32 {
        self.0[i]
    }

    /// Sets that of vertex `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, x: f32) {
        self.0[i] = x;
    }

    /// Those from vertex `first` on.
    #[inline(always)]
    pub fn load<F: Float>(&self, first: usize) -> F {
        F::load(&self.0[first..])
    }

    /// Sets those from vertex `first` on.
    #[inline(always)]
    pub fn store<F: Float>(&mut self, first: usize, x: F) {
        x.store(&mut self.0[first..]);
    }
}

/// A vector of each vertex.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vectors([Column; 3]);

impl Vectors {
    /// That of vertex `i`.
    #[inline(always)]
    pub fn at(&self, i: usize) -> Vec3 {
        let [x, y, z] = &self.0;
        Vec3::new(x.at(i), y.at(i), z.at(i))
    }

    /// Sets that of vertex `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, v: Vec3) {
        let [x, y, z] = &mut self.0;
        x.set(i, v.x);
        y.set(i, v.y);
        z.set(i, v.z);
    }

    /// Those from vertex `first` on.
    #[inline(always)]
    pub fn load<F: Float>(&self, first: usize) -> Vec3<F> {
        let [x, y, z] = &self.0;
        Vec3::new(x.load(first), y.load(first), z.load(first))
    }

    /// Sets those from vertex `first` on.
    #[inline(always)]
    pub fn store<F: Float>(&mut self, first: usize, v: Vec3<F>) {
        let [x, y, z] = &mut self.0;
        x.store(first, v.x);
        y.store(first, v.y);
        z.store(first, v.z);
    }
}
