//! One lane: what every machine has.

use crate::{
    kernel::scalar::Scalar,
    lanes::{Doubles, ROW, Singles, Wide},
};

impl Wide for Scalar {
    const LANES: usize = 1;

    type Single = f32;
    type Double = f64;

    #[inline(always)]
    fn single(self, x: f32) -> f32 {
        x
    }

    #[inline(always)]
    fn double(self, x: f64) -> f64 {
        x
    }

    #[inline(always)]
    fn singles(self, from: &Singles, at: usize) -> f32 {
        from[at % ROW]
    }

    #[inline(always)]
    fn doubles(self, from: &Doubles, at: usize) -> f64 {
        from[at % ROW]
    }

    #[inline(always)]
    fn put_singles(self, x: f32, to: &mut Singles, at: usize) {
        to[at % ROW] = x;
    }

    #[inline(always)]
    fn put_doubles(self, x: f64, to: &mut Doubles, at: usize) {
        to[at % ROW] = x;
    }

    #[inline(always)]
    fn widened(self, x: f32) -> f64 {
        f64::from(x)
    }

    #[inline(always)]
    fn wide_mask(self, mask: bool) -> bool {
        mask
    }
}
