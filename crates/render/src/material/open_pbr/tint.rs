//! Light's four lanes, for many vertices side by side.

use std::ops::{Add, Mul, Sub};

use straal_color::Light;
use straal_math::simd::{Float, Mask};

/// A share of light in each of its four lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct Tint<F>(pub [F; 4]);

impl<F: Float> Tint<F> {
    pub const ZERO: Self = Self([F::ZERO; 4]);
    pub const ONE: Self = Self([F::ONE; 4]);

    #[inline(always)]
    pub fn splat(v: F) -> Self {
        Self([v; 4])
    }

    /// Each lane by `f`, which must be inlined.
    #[inline(always)]
    pub fn map(self, f: impl Fn(F) -> F) -> Self {
        let [a, b, c, d] = self.0;
        Self([f(a), f(b), f(c), f(d)])
    }

    /// Lanes of both by `f`, which must be inlined.
    #[inline(always)]
    pub fn zip(self, o: Self, f: impl Fn(F, F) -> F) -> Self {
        let ([a, b, c, d], [e, g, h, i]) = (self.0, o.0);
        Self([f(a, e), f(b, g), f(c, h), f(d, i)])
    }

    /// From `self` to `to`.
    #[inline(always)]
    pub fn mix(self, to: Self, by: F) -> Self {
        self * (F::ONE - by) + to * by
    }

    #[inline(always)]
    pub fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        yes.zip(
            no,
            #[inline(always)]
            |y, n| F::select(mask, y, n),
        )
    }

    /// Itself in the lanes of the mask, 0 elsewhere.
    #[inline(always)]
    pub fn only(self, mask: F::Mask) -> Self {
        Self::select(mask, self, Self::ZERO)
    }

    #[inline(always)]
    pub fn greatest(self) -> F {
        let [a, b, c, d] = self.0;
        a.max(b).max(c.max(d))
    }

    /// What is beyond 0 and 1 is taken for the nearer.
    #[inline(always)]
    pub fn held(self) -> Self {
        self.map(
            #[inline(always)]
            |v| v.max(F::ZERO).min(F::ONE),
        )
    }

    /// Whether any number is above 0.
    #[inline(always)]
    pub fn is_any(self) -> bool {
        self.greatest().gt(F::ZERO).any()
    }
}

impl<F: Float> Add for Tint<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip(
            o,
            #[inline(always)]
            |a, b| a + b,
        )
    }
}
impl<F: Float> Sub for Tint<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.zip(
            o,
            #[inline(always)]
            |a, b| a - b,
        )
    }
}
impl<F: Float> Mul for Tint<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.zip(
            o,
            #[inline(always)]
            |a, b| a * b,
        )
    }
}
impl<F: Float> Mul<F> for Tint<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: F) -> Self {
        self.map(
            #[inline(always)]
            |a| a * s,
        )
    }
}

impl From<Tint<f32>> for Light {
    fn from(t: Tint<f32>) -> Self {
        Self(t.0)
    }
}
impl From<Light> for Tint<f32> {
    fn from(l: Light) -> Self {
        Self(l.0)
    }
}
