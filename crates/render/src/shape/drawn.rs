//! How points of a lamp are drawn for a surface that it lights.

use straal_math::Vec3;
use straal_math::simd::Float;

/// How points of a surface that shines are drawn for one that it lights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drawn {
    /// Evenly by area.
    #[default]
    ByArea,
    /// Evenly by solid angle near to its lit side, by area elsewhere.
    Auto {
        /// Whether both sides are lit, or only the one that its normal points away from.
        both_sides: bool,
    },
    /// Evenly by solid angle, where it is seen large.
    BySolidAngle,
    /// By solid angle and, nearly, the cosine to the normal of the surface that is lit.
    ByProjectedSolidAngle,
}

/// From where a flat lamp may be drawn as it is seen: from within a ball around its middle, and above its plane.
///
/// Of points drawn evenly by area, those count more that are nearer and less slanted: the middle of a square lamp straight above 1.6 times as much as its corners, where it is as far
/// away as its corners are from one another, and 1.1 times where it is twice as far. Hardly any noise comes of that, and solid angles cost time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearby<F = f32> {
    middle: Vec3<F>,
    /// The ball's radius, squared.
    within: F,
    /// Towards the lit side; zero if both are.
    front: Vec3<F>,
}

/// The square of the ball's radius, relative to that of the lamp's: by error times time over scenes with lamps near and far 2 to 8 are about as good.
const REACH: f32 = 4.0;

impl Drawn {
    /// For a lamp of this middle, square of the distance from there to its rim, and normal of any length.
    #[inline(always)]
    pub(super) fn nearby<F: Float>(self, middle: Vec3<F>, radius_squared: F, normal: Vec3<F>) -> Nearby<F> {
        let anywhere = Vec3::splat(F::ZERO);
        let (within, front) = match self {
            Self::ByArea => (F::ZERO, anywhere),
            Self::Auto { both_sides } => (radius_squared * REACH, if both_sides { anywhere } else { normal }),
            Self::BySolidAngle | Self::ByProjectedSolidAngle => (F::splat(f32::INFINITY), anywhere),
        };
        Nearby { middle, within, front }
    }
}

impl Nearby {
    /// The same in every lane.
    #[inline(always)]
    pub fn uniform<F: Float>(&self) -> Nearby<F> {
        Nearby {
            middle: Vec3::uniform(self.middle),
            within: F::splat(self.within),
            front: Vec3::uniform(self.front),
        }
    }
}

impl<F: Float> Nearby<F> {
    /// Whether a point lies there.
    #[inline(always)]
    pub fn has(&self, p: Vec3<F>) -> F::Mask {
        let away = p - self.middle;
        away.length_squared().lt(self.within) & away.dot(self.front).ge(F::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is near to the lit side of a lamp of radius 1 in the plane of x and y.
    #[test]
    fn a_lamp_is_near_in_front_of_it() {
        let near = |drawn: Drawn, p| drawn.nearby(Vec3::ZERO, 1.0, Vec3::Z * 3.0).has(p);
        let (front, back) = (Vec3::new(0.5, 0.0, 1.8), Vec3::new(0.5, 0.0, -1.8));
        let far = Vec3::new(1.0, 0.0, 1.8);
        let auto = |both_sides| Drawn::Auto { both_sides };
        assert!(near(auto(false), front) && !near(auto(false), back) && !near(auto(false), far));
        assert!(near(auto(true), front) && near(auto(true), back) && !near(auto(true), far));
        for p in [front, back, far] {
            assert!(near(Drawn::BySolidAngle, p) && !near(Drawn::ByArea, p));
        }
        assert!(!near(auto(true), Vec3::splat(f32::NAN)));
    }
}
