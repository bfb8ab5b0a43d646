//! Light is four numbers: the type of radiance, reflectance and throughput.

use std::ops::{Add, AddAssign, Div, Index, IndexMut, Mul, MulAssign, Sub};

/// Radiance, reflectance or throughput at four wavelengths; in RGB mode red, green, blue and a fourth lane that
/// is 0 everywhere. Only the edges of a renderer (where a scene's colour is evaluated, where the film takes a
/// sample) know which.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct Light(pub [f32; 4]);

impl Light {
    /// Darkness.
    pub const ZERO: Self = Self([0.0; 4]);
    /// Full reflectance or throughput in every lane, dead ones included: harmless, since a dead lane's light is 0.
    pub const ONE: Self = Self([1.0; 4]);

    /// The same number in every lane. As a *colour of the scene* use [`Light::rgb`], which keeps lane 3 at 0.
    #[inline(always)]
    pub const fn splat(v: f32) -> Self {
        Self([v; 4])
    }

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

    /// The largest lane: what roulette and the choice of lobes go by.
    #[inline(always)]
    pub fn max_lane(self) -> f32 {
        let [a, b, c, d] = self.0;
        let x = if a > b { a } else { b };
        let y = if c > d { c } else { d };
        if x > y { x } else { y }
    }

    /// Whether every lane is 0.
    #[inline(always)]
    pub fn is_black(self) -> bool {
        self.0 == [0.0; 4]
    }

    /// Whether no lane is infinite or NaN.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|v| v.is_finite())
    }

    /// Each lane through `f`.
    #[inline(always)]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self(self.0.map(f))
    }

    /// Lanes of both through `f`.
    #[inline(always)]
    pub fn zip(self, o: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let (a, b) = (self.0, o.0);
        Self([f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2]), f(a[3], b[3])])
    }

    /// Square root of each lane.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.map(f32::sqrt)
    }
}

impl Add for Light {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip(o, |a, b| a + b)
    }
}
impl Sub for Light {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.zip(o, |a, b| a - b)
    }
}
impl Mul for Light {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.zip(o, |a, b| a * b)
    }
}
impl Div for Light {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        self.zip(o, |a, b| a / b)
    }
}
impl Mul<f32> for Light {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f32) -> Self {
        self.map(|a| a * s)
    }
}
impl Div<f32> for Light {
    type Output = Self;
    #[inline(always)]
    fn div(self, s: f32) -> Self {
        self.map(|a| a / s)
    }
}
impl AddAssign for Light {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl MulAssign for Light {
    #[inline(always)]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}
impl MulAssign<f32> for Light {
    #[inline(always)]
    fn mul_assign(&mut self, s: f32) {
        *self = *self * s;
    }
}
impl Index<usize> for Light {
    type Output = f32;
    #[inline(always)]
    fn index(&self, i: usize) -> &f32 {
        &self.0[i]
    }
}
impl IndexMut<usize> for Light {
    #[inline(always)]
    fn index_mut(&mut self, i: usize) -> &mut f32 {
        &mut self.0[i]
    }
}
