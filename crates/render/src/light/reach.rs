//! What a light would bring to a point if nothing were in the way: roughly, and quickly.

use straal_math::Vec3;

use super::area::Sides;
use super::{AreaLight, LitSurface, SpotLight, strength};
use crate::shape::{Geometry, Shape};

/// Where light is to arrive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// The point.
    pub p: Vec3,
    /// Unit normal on the side that is lit; zero where light from all around counts alike.
    pub n: Vec3,
}

impl Receiver {
    /// A point where light from all around counts alike.
    pub const fn anywhere(p: Vec3) -> Self {
        Self { p, n: Vec3::ZERO }
    }
}

/// What is known of a light for [`Reach::estimate`].
#[derive(Clone, Debug)]
pub(super) enum Reach {
    Point {
        position: Vec3,
        intensity: f32,
    },
    Spot {
        spot: SpotLight,
        intensity: f32,
    },
    Parallel {
        wi: Vec3,
        irradiance: f32,
    },
    Surface(Lamp),
    /// Irradiance of surfaces that face +x, -x, +y, -y, +z and -z.
    Around([f32; 6]),
}

/// A surface that shines, as a ball around it and what it shows of itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lamp {
    center: Vec3,
    radius: f32,
    /// The mean of its lit normals, weighed by area: of length 1 when flat, 0 when closed.
    facing: Vec3,
    /// The length of that.
    flatness: f32,
    both_sides: bool,
    /// Radiance times area.
    flux: f32,
    /// Square of the radius of a disc of this area.
    spread: f32,
}

impl Reach {
    /// The irradiance, or what goes with it; 0 only where no light arrives.
    #[inline]
    pub fn estimate(&self, at: &Receiver) -> f32 {
        let everywhere = at.n == Vec3::ZERO;
        let facing = |cos: f32| {
            if everywhere {
                1.0
            } else if cos > 0.0 {
                cos
            } else {
                0.0
            }
        };
        match self {
            Self::Point { position, intensity } => {
                let way = *position - at.p;
                let d2 = way.length_squared();
                intensity * facing(way.dot(at.n) / d2.sqrt()) / d2
            }
            Self::Spot { spot, intensity } => {
                let way = spot.position() - at.p;
                let d2 = way.length_squared();
                let cos = facing(way.dot(at.n) / d2.sqrt());
                if cos > 0.0 { intensity * spot.share(-way) * cos / d2 } else { 0.0 }
            }
            Self::Parallel { wi, irradiance } => irradiance * facing(wi.dot(at.n)),
            Self::Surface(lamp) => lamp.estimate(at, everywhere),
            Self::Around(axes) => {
                if everywhere {
                    return axes.iter().sum::<f32>() * (2.0 / 3.0);
                }
                let towards = |axis: usize, cos: f32| cos * cos * axes[2 * axis + usize::from(cos < 0.0)];
                towards(0, at.n.x) + towards(1, at.n.y) + towards(2, at.n.z)
            }
        }
    }
}

impl Lamp {
    pub fn of(light: &AreaLight, geometry: &Geometry) -> Option<Self> {
        let bounds;
        let (mut facing, area);
        match &light.surface {
            LitSurface::Shape(shape) => {
                bounds = geometry.bounds(*shape)?;
                area = geometry.area(*shape)?;
                facing = match &geometry.shapes[*shape as usize] {
                    Shape::Disc(_) | Shape::Parallelogram(_) => {
                        geometry.sample_area(*shape, [0.5; 2]).map_or(Vec3::ZERO, |s| s.point.ng)
                    }
                    _ => Vec3::ZERO,
                };
            }
            LitSurface::Mesh { mesh, area: total, .. } => {
                let m = &geometry.meshes[*mesh as usize];
                bounds = straal_math::Bounds::of_points(m.positions.iter().copied());
                area = *total as f32;
                let sum = (0..m.indices.len() as u32).fold(straal_math::DVec3::ZERO, |sum, i| {
                    let [a, b, c] = m.corners(i).map(Vec3::as_dvec3);
                    let cross = (b - a).cross(c - a) * 0.5;
                    if cross.is_finite() { sum + cross } else { sum }
                });
                let mean = (sum * (1.0 / *total)).as_vec3();
                facing = if m.flip { -mean } else { mean };
            }
        }
        if light.sides == Sides::Back {
            facing = -facing;
        }
        // Rounding must not make a flat lamp curved.
        let length = facing.length();
        let flatness = if length > 0.999_99 {
            1.0
        } else if length.is_finite() {
            length
        } else {
            0.0
        };
        let facing = facing.try_normalize().unwrap_or(Vec3::ZERO);
        let lamp = Self {
            center: bounds.center(),
            radius: 0.5 * bounds.extent().length(),
            facing,
            flatness,
            both_sides: light.sides == Sides::Both,
            flux: strength(&light.radiance) as f32 * area,
            spread: area * std::f32::consts::FRAC_1_PI,
        };
        lamp.flux.is_finite().then_some(lamp)
    }

    #[inline]
    fn estimate(&self, at: &Receiver, everywhere: bool) -> f32 {
        let way = self.center - at.p;
        let d2 = way.length_squared();
        let per_distance = 1.0 / d2.sqrt();
        // Within the ball around it, anything may be in sight.
        let near = d2 <= self.radius * self.radius;
        let sin = if near { 1.0 } else { self.radius * per_distance };
        // From 1 where its middle is straight above down to 0 where all of it is below the horizon.
        let above = if everywhere || near { 1.0 } else { (way.dot(at.n) * per_distance + sin) / (1.0 + sin) };
        if above <= 0.0 {
            return 0.0;
        }
        // What is seen of its area: a quarter of a closed surface.
        let cos = -way.dot(self.facing) * per_distance;
        let cos = if self.both_sides {
            cos.abs()
        } else if cos > 0.0 {
            cos
        } else {
            0.0
        };
        let round = if self.both_sides { 0.5 } else { 0.25 };
        let seen = round * (1.0 - self.flatness) + self.flatness * cos;
        self.flux * above * seen / (d2 + self.flatness * self.spread)
    }
}
