//! # Cubes
//!
//! Cubes of two colours in turn, in space: a checkerboard of which what it covers is cut. Where a pixel sees many it sees their mean, over the box that
//! holds the footprint.

use straal_color::Light;
use straal_scene::desc;

use super::checker::odd;
use super::solid::Solid;
use super::{Maker, Pattern, Place, Reading, ShadingPoint, Use, Value, between};
use crate::lanes::{Colour, Lanes};

/// Cubes of two colours, of side 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Cubes {
    /// That of the cube from 0 to 1 in all directions and of every other, and that of the rest.
    pub colours: [Value<Colour>; 2],
    /// Where.
    pub solid: Solid,
}

impl Cubes {
    pub(super) fn of(d: &desc::CubesTexture, make: &mut dyn Maker) -> Self {
        let colours = [make.part(&d.first), make.part(&d.second)];
        Self { colours, solid: make.solid(&d.space, &d.transform) }
    }

    fn share(&self, at: &ShadingPoint) -> f32 {
        let Place { p, dpdx, dpdy } = self.solid.place(at);
        // The mean of a product of signs, each of one direction.
        let sign = |k: usize| 1.0 - 2.0 * odd(p[k], 0.5 * (dpdx[k].abs() + dpdy[k].abs()));
        0.5 - 0.5 * sign(0) * sign(1) * sign(2)
    }
}

impl Pattern for Cubes {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, _: Use) -> Light {
        between::light(self.colours.each_ref(), self.share(at), at, reading)
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        between::number(self.colours.each_ref(), self.share(at), at, reading)
    }

    fn most(&self) -> f32 {
        between::most(&self.colours)
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        use straal_math::Transform;
        let colours = [Light::rgb([0.9, 0.5, 0.1]), Light::rgb([0.2, 0.4, 0.3])].map(Value::from);
        vec![Self { colours, solid: Solid { of_world: false, transform: Transform::IDENTITY } }]
    }
}
