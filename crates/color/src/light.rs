//! Light is four numbers: the type of radiance, reflectance and throughput.

use std::ops::{Add, AddAssign, Div, Index, IndexMut, Mul, MulAssign, Sub};
use straal_math::simd::Float;

/// Radiance, reflectance or throughput at four wavelengths; in RGB mode red, green, blue and a fourth lane that
/// is 0 everywhere. Only the edges of a renderer (where a scene's colour is evaluated, where the film takes a
/// sample) know which.
///
/// Or many of them side by side ([`straal_math::simd`]): the first number of each, then the second of each, and so on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct Light<F = f32>(pub [F; 4]);

impl Light {
    /// Darkness.
    pub const ZERO: Self = Self([0.0; 4]);
    /// Full reflectance or throughput in every lane, dead ones included: harmless, since a dead lane's light is 0.
    pub const ONE: Self = Self([1.0; 4]);

    /// Red, green, blue; the fourth lane 0.
    #[inline(always)]
    pub const fn rgb(c: [f32; 3]) -> Self {
        Self([c[0], c[1], c[2], 0.0])
    }

    /// The first three lanes.
    #[inline(always)]
    pub const fn to_rgb(self) -> [f32; 3] {
        [self.0[0], self.0[1], self.0[2]]
    }
}

impl<F: Float> Light<F> {
    /// The same number in every lane. As a *colour of the scene* use [`Light::rgb`], which keeps lane 3 at 0.
    #[inline(always)]
    pub const fn splat(v: F) -> Self {
        Self([v; 4])
    }

    /// The same light many times side by side.
    #[inline(always)]
    pub fn uniform(light: Light) -> Self {
        let [a, b, c, d] = light.0;
        Self([F::splat(a), F::splat(b), F::splat(c), F::splat(d)])
    }

    /// What `f` gives for each of many side by side.
    #[inline(always)]
    pub fn from_fn(mut f: impl FnMut(usize) -> Light) -> Self {
        Self(F::from_rows(
            #[inline(always)]
            |i| f(i).0,
        ))
    }

    /// Hands each of many side by side to `f`.
    #[inline(always)]
    pub fn for_each(self, mut f: impl FnMut(usize, Light)) {
        F::to_rows(
            self.0,
            #[inline(always)]
            |i, light| f(i, Light(light)),
        );
    }

    /// `yes` where the mask says so, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        yes.zip(
            no,
            #[inline(always)]
            |yes, no| F::select(mask, yes, no),
        )
    }

    /// Itself where the mask says so, nothing elsewhere.
    #[inline(always)]
    pub fn only(self, mask: F::Mask) -> Self {
        Self::select(mask, self, Self::splat(F::ZERO))
    }

    /// From itself to another, by a part from 0 to 1.
    #[inline(always)]
    pub fn mix(self, to: Self, by: F) -> Self {
        self * (F::ONE - by) + to * by
    }

    /// What is beyond 0 and 1 is taken for the nearer.
    #[inline(always)]
    pub fn as_shares(self) -> Self {
        self.map(
            #[inline(always)]
            |v| v.max(F::ZERO).min(F::ONE),
        )
    }

    /// The largest lane: what roulette and the choice of lobes go by.
    #[inline(always)]
    pub fn max_lane(self) -> F {
        let [a, b, c, d] = self.0;
        a.max(b).max(c.max(d))
    }

    /// Whether every lane is 0.
    #[inline(always)]
    pub fn is_black(self) -> F::Mask {
        let [a, b, c, d] = self.0;
        a.eq(F::ZERO) & b.eq(F::ZERO) & c.eq(F::ZERO) & d.eq(F::ZERO)
    }

    /// Whether no lane is infinite or NaN.
    #[inline(always)]
    pub fn is_finite(self) -> F::Mask {
        let [a, b, c, d] = self.0;
        a.is_finite() & b.is_finite() & c.is_finite() & d.is_finite()
    }

    /// Each lane through `f`.
    #[inline(always)]
    pub fn map(self, f: impl Fn(F) -> F) -> Self {
        let [a, b, c, d] = self.0;
        Self([f(a), f(b), f(c), f(d)])
    }

    /// Lanes of both through `f`.
    #[inline(always)]
    pub fn zip(self, o: Self, f: impl Fn(F, F) -> F) -> Self {
        let (a, b) = (self.0, o.0);
        Self([f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2]), f(a[3], b[3])])
    }

    /// Square root of each lane.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        let [a, b, c, d] = self.0;
        Self([a.sqrt(), b.sqrt(), c.sqrt(), d.sqrt()])
    }
}

impl<F: Float> Add for Light<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        let (a, b) = (self.0, o.0);
        Self([a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]])
    }
}
impl<F: Float> Sub for Light<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        let (a, b) = (self.0, o.0);
        Self([a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]])
    }
}
impl<F: Float> Mul for Light<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        let (a, b) = (self.0, o.0);
        Self([a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]])
    }
}
impl<F: Float> Div for Light<F> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let (a, b) = (self.0, o.0);
        Self([a[0] / b[0], a[1] / b[1], a[2] / b[2], a[3] / b[3]])
    }
}
impl<F: Float> Mul<F> for Light<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: F) -> Self {
        let [a, b, c, d] = self.0;
        Self([a * s, b * s, c * s, d * s])
    }
}
impl<F: Float> Div<F> for Light<F> {
    type Output = Self;
    #[inline(always)]
    fn div(self, s: F) -> Self {
        let [a, b, c, d] = self.0;
        Self([a / s, b / s, c / s, d / s])
    }
}
impl<F: Float> AddAssign for Light<F> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<F: Float> MulAssign for Light<F> {
    #[inline(always)]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}
impl<F: Float> MulAssign<F> for Light<F> {
    #[inline(always)]
    fn mul_assign(&mut self, s: F) {
        *self = *self * s;
    }
}
impl<F> Index<usize> for Light<F> {
    type Output = F;
    #[inline(always)]
    fn index(&self, i: usize) -> &F {
        &self.0[i]
    }
}
impl<F> IndexMut<usize> for Light<F> {
    #[inline(always)]
    fn index_mut(&mut self, i: usize) -> &mut F {
        &mut self.0[i]
    }
}
