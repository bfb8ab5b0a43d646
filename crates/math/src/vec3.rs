//! Three-vectors in single precision (what rays are made of) and in double precision (what set-up computes in): of plain numbers,
//! or of many side by side, see [`crate::simd`].
//!
//! Plain structs: the order of every operation is written here and is the same on every processor.

use crate::simd::{Double, Float, Mask};
use std::ops::{Add, AddAssign, Div, Index, IndexMut, Mul, MulAssign, Neg, Sub, SubAssign};

macro_rules! vec3 {
    ($(#[$doc:meta])* $name:ident, $t:ident, $lanes:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[repr(C)]
        pub struct $name<F = $t> {
            /// First coordinate.
            pub x: F,
            /// Second coordinate.
            pub y: F,
            /// Third coordinate.
            pub z: F,
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

            /// Above this what a square loses to underflow is below the sum's rounding.
            const LEAST_SQUARE: $t = <$t>::MIN_POSITIVE / <$t>::EPSILON;

            /// The vector divided by its length, or `None` when that is 0 or not finite.
            #[inline]
            pub fn try_normalize(self) -> Option<Self> {
                let square = self.length_squared();
                if square > Self::LEAST_SQUARE && square < 1.0 / Self::LEAST_SQUARE {
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
        }

        impl<F: $lanes> $name<F> {
            /// The vector (x, y, z).
            #[inline(always)]
            pub const fn new(x: F, y: F, z: F) -> Self {
                Self { x, y, z }
            }

            /// The same number three times.
            #[inline(always)]
            pub const fn splat(v: F) -> Self {
                Self::new(v, v, v)
            }

            /// From an array.
            #[inline(always)]
            pub const fn from_array(a: [F; 3]) -> Self {
                Self::new(a[0], a[1], a[2])
            }

            /// To an array.
            #[inline(always)]
            pub const fn to_array(self) -> [F; 3] {
                [self.x, self.y, self.z]
            }

            /// The same vector in every lane.
            #[inline(always)]
            pub fn uniform(v: $name) -> Self {
                Self::new(F::splat(v.x), F::splat(v.y), F::splat(v.z))
            }

            /// What `f` gives for each lane's number.
            #[inline(always)]
            pub fn from_fn(mut f: impl FnMut(usize) -> $name) -> Self {
                let mut lanes = [F::ZERO.to_array(); 3];
                for i in 0..F::WIDTH {
                    let v = f(i);
                    lanes[0].as_mut()[i] = v.x;
                    lanes[1].as_mut()[i] = v.y;
                    lanes[2].as_mut()[i] = v.z;
                }
                let [x, y, z] = lanes;
                Self::new(F::from_array(x), F::from_array(y), F::from_array(z))
            }

            /// One lane.
            #[inline(always)]
            pub fn lane(self, i: usize) -> $name {
                $name::new(self.x.lane(i), self.y.lane(i), self.z.lane(i))
            }

            /// `yes` in the lanes of the mask, `no` in the others.
            #[inline(always)]
            pub fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
                Self::new(
                    F::select(mask, yes.x, no.x),
                    F::select(mask, yes.y, no.y),
                    F::select(mask, yes.z, no.z),
                )
            }

            /// Scalar product, summed in the order x, y, z.
            #[inline(always)]
            pub fn dot(self, o: Self) -> F {
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
            pub fn length_squared(self) -> F {
                self.dot(self)
            }

            /// Euclidean length.
            #[inline(always)]
            pub fn length(self) -> F {
                self.dot(self).sqrt()
            }

            /// The vector divided by its length. Not finite when the length is 0.
            #[inline(always)]
            pub fn normalize(self) -> Self {
                self * (F::ONE / self.length())
            }

            /// As [`Self::try_normalize`] of each lane, and in which there is a direction; in the others the vector is 0.
            #[inline(always)]
            pub fn normalize_checked(self) -> (Self, F::Mask) {
                let square = self.length_squared();
                let is_plain = square.gt(F::splat($name::LEAST_SQUARE))
                    & square.lt(F::splat(1.0 / $name::LEAST_SQUARE));
                let unit = self * (F::ONE / square.sqrt());
                if is_plain.all() { (unit, is_plain) } else { Self::normalize_rest(self, unit, is_plain.to_bits()) }
            }

            /// Lanes that have to be scaled, one by one.
            #[cold]
            #[inline(never)]
            fn normalize_rest(of: Self, unit: Self, plain: u32) -> (Self, F::Mask) {
                let mut there = plain;
                let unit = Self::from_fn(|i| {
                    if plain >> i & 1 == 1 {
                        return unit.lane(i);
                    }
                    let scaled = of.lane(i).try_normalize_scaled();
                    there |= u32::from(scaled.is_some()) << i;
                    scaled.unwrap_or($name::ZERO)
                });
                (unit, F::Mask::from_bits(there))
            }

            /// Componentwise minimum; `o`'s coordinate where the comparison fails (NaN).
            #[inline(always)]
            pub fn min(self, o: Self) -> Self {
                Self::new(F::min(self.x, o.x), F::min(self.y, o.y), F::min(self.z, o.z))
            }

            /// Componentwise maximum; `o`'s coordinate where the comparison fails (NaN).
            #[inline(always)]
            pub fn max(self, o: Self) -> Self {
                Self::new(F::max(self.x, o.x), F::max(self.y, o.y), F::max(self.z, o.z))
            }

            /// Componentwise absolute value.
            #[inline(always)]
            pub fn abs(self) -> Self {
                Self::new(self.x.abs(), self.y.abs(), self.z.abs())
            }

            /// The largest coordinate.
            #[inline(always)]
            pub fn max_element(self) -> F {
                F::max(F::max(self.x, self.y), self.z)
            }

            /// The smallest coordinate.
            #[inline(always)]
            pub fn min_element(self) -> F {
                F::min(F::min(self.x, self.y), self.z)
            }

            /// Whether no coordinate is infinite or NaN.
            #[inline(always)]
            pub fn is_finite(self) -> F::Mask {
                self.x.is_finite() & self.y.is_finite() & self.z.is_finite()
            }
        }

        impl<F: $lanes> Add for $name<F> {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
            }
        }
        impl<F: $lanes> Sub for $name<F> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
            }
        }
        impl<F: $lanes> Mul<F> for $name<F> {
            type Output = Self;
            #[inline(always)]
            fn mul(self, s: F) -> Self {
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
        impl<F: $lanes> Div<F> for $name<F> {
            type Output = Self;
            #[inline(always)]
            fn div(self, s: F) -> Self {
                Self::new(self.x / s, self.y / s, self.z / s)
            }
        }
        impl<F: $lanes> Neg for $name<F> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::new(-self.x, -self.y, -self.z)
            }
        }
        impl<F: $lanes> AddAssign for $name<F> {
            #[inline(always)]
            fn add_assign(&mut self, o: Self) {
                *self = *self + o;
            }
        }
        impl<F: $lanes> SubAssign for $name<F> {
            #[inline(always)]
            fn sub_assign(&mut self, o: Self) {
                *self = *self - o;
            }
        }
        impl<F: $lanes> MulAssign<F> for $name<F> {
            #[inline(always)]
            fn mul_assign(&mut self, s: F) {
                *self = *self * s;
            }
        }
        impl<F> Index<usize> for $name<F> {
            type Output = F;
            #[inline(always)]
            fn index(&self, i: usize) -> &F {
                match i {
                    0 => &self.x,
                    1 => &self.y,
                    _ => &self.z,
                }
            }
        }
        impl<F> IndexMut<usize> for $name<F> {
            #[inline(always)]
            fn index_mut(&mut self, i: usize) -> &mut F {
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
    f32,
    Float
);
vec3!(
    /// A point, direction or normal in double precision: set-up computes in these and rounds once.
    DVec3,
    f64,
    Double
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

impl<F: Float> Vec3<F> {
    /// The same vectors in double precision (exact).
    #[inline(always)]
    pub fn to_double(self) -> DVec3<F::Double> {
        DVec3::new(self.x.to_double(), self.y.to_double(), self.z.to_double())
    }

    /// Rounded to single precision.
    #[inline(always)]
    pub fn from_double(v: DVec3<F::Double>) -> Self {
        Self::new(F::from_double(v.x), F::from_double(v.y), F::from_double(v.z))
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
            let v = Vec3::new(s, 0.0, -s);
            let n = v.try_normalize().unwrap();
            assert_eq!(v.normalize_checked(), (n, true));
            assert!((n.length() - 1.0).abs() < 1e-6, "scale {s}");
        }
        assert_eq!(Vec3::ZERO.normalize_checked(), (Vec3::ZERO, false));
        assert_eq!(Vec3::ZERO.try_normalize(), None);
        assert_eq!(Vec3::new(f32::NAN, 0.0, 0.0).try_normalize(), None);
        assert_eq!(Vec3::new(f32::INFINITY, 0.0, 0.0).try_normalize(), None);
    }
}
