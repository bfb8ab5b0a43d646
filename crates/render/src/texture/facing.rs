//! # Facing
//!
//! One of two colours where a surface lies across a direction, as snow lies on a roof, the other where it lies along it; between them by the cosine of the normal.

use straal_color::Light;
use straal_math::{Vec3, ops};
use straal_scene::desc;

use super::solid::Solid;
use super::{Maker, Pattern, Reading, ShadingPoint, Use, Value, between};
use crate::lanes::{Colour, Lanes};

/// Two colours by the way that a surface faces.
#[derive(Clone, Debug, PartialEq)]
pub struct Facing {
    /// Where the normal is along the direction, and where it is across.
    pub colours: [Value<Colour>; 2],
    /// A unit vector.
    pub direction: Vec3,
    /// Whose directions these are.
    pub solid: Solid,
}

impl Facing {
    pub(super) fn of(d: &desc::FacingTexture, make: &mut dyn Maker) -> Self {
        let direction = d.direction.try_normalize().map_or(Vec3::Y, |d| d.as_vec3());
        let solid = make.solid(&d.space, &desc::Transform::default());
        Self { colours: [make.part(&d.first), make.part(&d.second)], direction, solid }
    }

    fn share(&self, at: &ShadingPoint) -> f32 {
        let n = if self.solid.of_world { at.frame.n } else { at.object_n };
        ops::min(n.dot(self.direction).abs(), 1.0)
    }
}

impl Pattern for Facing {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, _: Use) -> Light {
        between::light([&self.colours[1], &self.colours[0]], self.share(at), at, reading)
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        between::number([&self.colours[1], &self.colours[0]], self.share(at), at, reading)
    }

    fn most(&self) -> f32 {
        between::most(&self.colours)
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        use straal_math::Transform;
        let colours = [Light::rgb([0.9, 0.5, 0.1]), Light::rgb([0.2, 0.4, 0.3])].map(Value::from);
        let solid = Solid { of_world: false, transform: Transform::IDENTITY };
        vec![Self { colours, direction: Vec3::new(0.6, 0.0, 0.8), solid }]
    }
}
