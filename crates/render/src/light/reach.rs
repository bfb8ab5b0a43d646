//! What a light would bring to a point if nothing were in the way: roughly, and quickly.

use straal_math::Vec3;
use straal_math::simd::{Float, Mask};

use super::{Goniometric, Projector, SpotLight};

/// Where light is to arrive: a place, or many side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver<F = f32> {
    /// The point.
    pub p: Vec3<F>,
    /// Unit normal on the side that is lit; zero where light from all around counts alike.
    pub n: Vec3<F>,
}

impl Receiver {
    /// A point where light from all around counts alike.
    pub const fn anywhere(p: Vec3) -> Self {
        Self { p, n: Vec3::ZERO }
    }
}

impl<F: Float> Receiver<F> {
    /// Whether light from all around counts alike.
    #[inline(always)]
    pub(super) fn is_anywhere(&self) -> F::Mask {
        self.n.x.eq(F::ZERO) & self.n.y.eq(F::ZERO) & self.n.z.eq(F::ZERO)
    }
}

/// What is known of a light for [`Reach::estimate`].
#[derive(Clone, Debug)]
pub(super) enum Reach {
    Point {
        position: Vec3,
        intensity: f32,
        /// Whether it falls with the distance squared.
        falls: bool,
    },
    Spot {
        spot: SpotLight,
        intensity: f32,
    },
    Projector {
        projector: Projector,
        intensity: f32,
    },
    Measured {
        lamp: Goniometric,
        intensity: f32,
    },
    Parallel {
        wi: Vec3,
        irradiance: f32,
        /// Sine of the angle from there to its rim, 0 if it has none.
        sin: f32,
    },
    Surface(Lamp),
    /// Irradiance of surfaces that face +x, -x, +y, -y, +z and -z.
    Around([f32; 6]),
}

/// A surface that shines, as a ball around it and what it shows of itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lamp {
    pub center: Vec3,
    pub radius: f32,
    /// The mean of its lit normals, weighed by area: of length 1 when flat, 0 when closed.
    pub facing: Vec3,
    /// The length of that.
    pub flatness: f32,
    pub both_sides: bool,
    /// Radiance times area.
    pub flux: f32,
    /// Square of the radius of a disc of this area.
    pub spread: f32,
}

impl Reach {
    /// The irradiance, or what goes with it; 0 only where no light arrives.
    #[inline(always)]
    pub fn estimate<F: Float>(&self, at: &Receiver<F>) -> F {
        let everywhere = at.is_anywhere();
        match self {
            Self::Point { position, intensity, falls } => {
                let way = Vec3::uniform(*position) - at.p;
                let d2 = way.length_squared();
                let near = facing(everywhere, way.dot(at.n) / d2.sqrt()) * *intensity;
                if *falls { near / d2 } else { near }
            }
            Self::Spot { spot, intensity } => shared(
                at,
                everywhere,
                (spot.position(), *intensity),
                #[inline(always)]
                |w| spot.share(w),
            ),
            Self::Projector { projector, intensity } => shared(
                at,
                everywhere,
                (projector.position(), *intensity),
                #[inline(always)]
                |w| projector.share(w),
            ),
            Self::Measured { lamp, intensity } => shared(
                at,
                everywhere,
                (lamp.position(), *intensity),
                #[inline(always)]
                |w| lamp.share(w),
            ),
            Self::Parallel { wi, irradiance, sin } => {
                // From 1 where its middle is straight above down to 0 where all of it is below the horizon.
                let above = (Vec3::uniform(*wi).dot(at.n) + *sin) / (1.0 + *sin);
                facing(everywhere, above) * *irradiance
            }
            Self::Surface(lamp) => lamp.estimate(at, everywhere),
            Self::Around(axes) => {
                let [x, y, z] = [0, 2, 4].map(|axis| [axes[axis], axes[axis + 1]]);
                let of_all = F::splat(axes.iter().sum::<f32>() * (2.0 / 3.0));
                let of_some = towards(x, at.n.x) + towards(y, at.n.y) + towards(z, at.n.z);
                F::select(everywhere, of_all, of_some)
            }
        }
    }
}

/// What a point of some intensity brings that sends a share of it in each direction.
#[inline(always)]
fn shared<F: Float>(
    at: &Receiver<F>,
    everywhere: F::Mask,
    (position, intensity): (Vec3, f32),
    share: impl FnOnce(Vec3<F>) -> F,
) -> F {
    let way = Vec3::uniform(position) - at.p;
    let d2 = way.length_squared();
    let cos = facing(everywhere, way.dot(at.n) / d2.sqrt());
    let is_seen = cos.gt(F::ZERO);
    if !is_seen.any() {
        return F::ZERO;
    }
    F::select(is_seen, share(-way) * intensity * cos / d2, F::ZERO)
}

/// The part of the light at an angle that falls on a surface.
#[inline(always)]
fn facing<F: Float>(everywhere: F::Mask, cos: F) -> F {
    F::select(everywhere, F::ONE, F::select(cos.gt(F::ZERO), cos, F::ZERO))
}

/// Of the light from the two ends of an axis, the part that counts for a normal with this cosine to it.
#[inline(always)]
fn towards<F: Float>([positive, negative]: [f32; 2], cos: F) -> F {
    cos * cos * F::select(cos.lt(F::ZERO), F::splat(negative), F::splat(positive))
}

impl Lamp {
    #[inline(always)]
    fn estimate<F: Float>(&self, at: &Receiver<F>, everywhere: F::Mask) -> F {
        let way = Vec3::uniform(self.center) - at.p;
        let d2 = way.length_squared();
        let per_distance = F::ONE / d2.sqrt();
        // Within the ball around it, anything may be in sight.
        let near = d2.le(F::splat(self.radius * self.radius));
        let sin = F::select(near, F::ONE, per_distance * self.radius);
        // From 1 where its middle is straight above down to 0 where all of it is below the horizon.
        let above = (way.dot(at.n) * per_distance + sin) / (F::ONE + sin);
        let above = F::select(everywhere | near, F::ONE, above);
        // What is seen of its area: a quarter of a closed surface.
        let cos = -way.dot(Vec3::uniform(self.facing)) * per_distance;
        let cos = if self.both_sides { cos.abs() } else { F::select(cos.gt(F::ZERO), cos, F::ZERO) };
        let round = if self.both_sides { 0.5 } else { 0.25 };
        let seen = cos * self.flatness + round * (1.0 - self.flatness);
        let estimate = above * self.flux * seen / (d2 + self.flatness * self.spread);
        F::select(above.le(F::ZERO), F::ZERO, estimate)
    }
}
