//! Three-vectors of `f32` (what rays are made of) and `f64` (what set-up computes in).
//!
//! Plain scalar structs: the order of every operation is written here and is the same on every processor.

use std::ops::{Add, AddAssign, Div, Index, IndexMut, Mul, MulAssign, Neg, Sub, SubAssign};

macro_rules! vec3 {
    ($(#[$doc:meta])* $name:ident, $t:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[repr(C)]
        pub struct $name {
            /// First coordinate.
            pub x: $t,
            /// Second coordinate.
            pub y: $t,
            /// Third coordinate.
            pub z: $t,
        }

        impl $name {
            /// All coordinates 0.
            pub const ZERO: Self = Self::new(0.0, 0.0, 0.0);
            /// All coordinates 1.
            pub const ONE: Self = Self::new(1.0, 1.0, 1.0);
            /// The first axis.
            pub const X: Self = Self::new(1.0, 0.0, 0.0);
            /// The second axis.
            pub const Y: Self = Self::new(0.0, 1.0, 0.0);
            /// The third axis.
            pub const Z: Self = Self::new(0.0, 0.0, 1.0);

            /// The vector (x, y, z).
            #[inline(always)]
            pub const fn new(x: $t, y: $t, z: $t) -> Self {
                Self { x, y, z }
            }

            /// The same number three times.
            #[inline(always)]
            pub const fn splat(v: $t) -> Self {
                Self::new(v, v, v)
            }

            /// From an array.
            #[inline(always)]
            pub const fn from_array(a: [$t; 3]) -> Self {
                Self::new(a[0], a[1], a[2])
            }

            /// To an array.
            #[inline(always)]
            pub const fn to_array(self) -> [$t; 3] {
                [self.x, self.y, self.z]
            }

            /// Scalar product, summed in the order x, y, z.
            #[inline(always)]
            pub fn dot(self, o: Self) -> $t {
                self.x * o.x + self.y * o.y + self.z * o.z
            }

            /// Vector product.
            #[inline(always)]
            pub fn cross(self, o: Self) -> Self {
                Self::new(
                    self.y * o.z - self.z * o.y,
                    self.z * o.x - self.x * o.z,
                    self.x * o.y - self.y * o.x,
                )
            }

            /// Squared Euclidean length.
            #[inline(always)]
            pub fn length_squared(self) -> $t {
                self.dot(self)
            }

            /// Euclidean length.
            #[inline(always)]
            pub fn length(self) -> $t {
                self.dot(self).sqrt()
            }

            /// The vector divided by its length. Not finite when the length is 0.
            #[inline(always)]
            pub fn normalize(self) -> Self {
                self * (1.0 / self.length())
            }

            /// The vector divided by its length, or `None` when that is 0 or not finite.
            #[inline]
            pub fn try_normalize(self) -> Option<Self> {
                // Above this what a square loses to underflow is below the sum's rounding.
                const LEAST: $t = <$t>::MIN_POSITIVE / <$t>::EPSILON;
                let square = self.length_squared();
                if square > LEAST && square < 1.0 / LEAST {
                    return Some(self * (1.0 / square.sqrt()));
                }
                self.try_normalize_scaled()
            }

            /// Scaled first, so that neither tiny nor huge vectors lose their direction to the square.
            #[cold]
            fn try_normalize_scaled(self) -> Option<Self> {
                let m = self.abs().max_element();
                if !(m > 0.0 && m < <$t>::INFINITY) {
                    return None;
                }
                let v = self / m;
                let n = v / v.length();
                n.is_finite().then_some(n)
            }

            /// Componentwise minimum; `o`'s coordinate where the comparison fails (NaN).
            #[inline(always)]
            pub fn min(self, o: Self) -> Self {
                Self::new(
                    if self.x < o.x { self.x } else { o.x },
                    if self.y < o.y { self.y } else { o.y },
                    if self.z < o.z { self.z } else { o.z },
                )
            }

            /// Componentwise maximum; `o`'s coordinate where the comparison fails (NaN).
            #[inline(always)]
            pub fn max(self, o: Self) -> Self {
                Self::new(
                    if self.x > o.x { self.x } else { o.x },
                    if self.y > o.y { self.y } else { o.y },
                    if self.z > o.z { self.z } else { o.z },
                )
            }

            /// Componentwise absolute value.
            #[inline(always)]
            pub fn abs(self) -> Self {
                Self::new(self.x.abs(), self.y.abs(), self.z.abs())
            }

            /// The largest coordinate.
            #[inline(always)]
            pub fn max_element(self) -> $t {
                let m = if self.x > self.y { self.x } else { self.y };
                if m > self.z { m } else { self.z }
            }

            /// The smallest coordinate.
            #[inline(always)]
            pub fn min_element(self) -> $t {
                let m = if self.x < self.y { self.x } else { self.y };
                if m < self.z { m } else { self.z }
            }

            /// The axis (0, 1, 2) of the coordinate with the largest absolute value; the first on ties.
            #[inline(always)]
            pub fn max_axis(self) -> usize {
                let a = self.abs();
                if a.x >= a.y && a.x >= a.z {
                    0
                } else if a.y >= a.z {
                    1
                } else {
                    2
                }
            }

            /// Whether no coordinate is infinite or NaN.
            #[inline(always)]
            pub fn is_finite(self) -> bool {
                self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
            }
        }

        impl Add for $name {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
            }
        }
        impl Sub for $name {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
            }
        }
        impl Mul<$t> for $name {
            type Output = Self;
            #[inline(always)]
            fn mul(self, s: $t) -> Self {
                Self::new(self.x * s, self.y * s, self.z * s)
            }
        }
        impl Mul<$name> for $t {
            type Output = $name;
            #[inline(always)]
            fn mul(self, v: $name) -> $name {
                v * self
            }
        }
        impl Div<$t> for $name {
            type Output = Self;
            #[inline(always)]
            fn div(self, s: $t) -> Self {
                Self::new(self.x / s, self.y / s, self.z / s)
            }
        }
        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::new(-self.x, -self.y, -self.z)
            }
        }
        impl AddAssign for $name {
            #[inline(always)]
            fn add_assign(&mut self, o: Self) {
                *self = *self + o;
            }
        }
        impl SubAssign for $name {
            #[inline(always)]
            fn sub_assign(&mut self, o: Self) {
                *self = *self - o;
            }
        }
        impl MulAssign<$t> for $name {
            #[inline(always)]
            fn mul_assign(&mut self, s: $t) {
                *self = *self * s;
            }
        }
        impl Index<usize> for $name {
            type Output = $t;
            #[inline(always)]
            fn index(&self, i: usize) -> &$t {
                match i {
                    0 => &self.x,
                    1 => &self.y,
                    _ => &self.z,
                }
            }
        }
        impl IndexMut<usize> for $name {
            #[inline(always)]
            fn index_mut(&mut self, i: usize) -> &mut $t {
                match i {
                    0 => &mut self.x,
                    1 => &mut self.y,
                    _ => &mut self.z,
                }
            }
        }
    };
}

vec3!(
    /// A point, direction or normal in single precision.
    Vec3,
    f32
);
vec3!(
    /// A point, direction or normal in double precision: set-up computes in these and rounds once.
    DVec3,
    f64
);

impl Vec3 {
    /// The same vector in double precision (exact).
    #[inline]
    pub const fn as_dvec3(self) -> DVec3 {
        DVec3::new(self.x as f64, self.y as f64, self.z as f64)
    }
}

impl DVec3 {
    /// Rounded to single precision.
    #[inline]
    pub const fn as_vec3(self) -> Vec3 {
        Vec3::new(self.x as f32, self.y as f32, self.z as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cross_is_orthogonal_and_right_handed() {
        assert_eq!(Vec3::X.cross(Vec3::Y), Vec3::Z);
        let (a, b) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(-2.0, 0.5, 4.0));
        assert_eq!(a.cross(b).dot(a), 0.0);
        assert_eq!(a.cross(b).dot(b), 0.0);
    }

    #[test]
    fn try_normalize_survives_extremes() {
        for s in [1e-38_f32, 1e-20, 1.0, 1e20, 3e38] {
            let n = Vec3::new(s, 0.0, -s).try_normalize().unwrap();
            assert!((n.length() - 1.0).abs() < 1e-6, "scale {s}");
        }
        assert_eq!(Vec3::ZERO.try_normalize(), None);
        assert_eq!(Vec3::new(f32::NAN, 0.0, 0.0).try_normalize(), None);
        assert_eq!(Vec3::new(f32::INFINITY, 0.0, 0.0).try_normalize(), None);
    }
}
