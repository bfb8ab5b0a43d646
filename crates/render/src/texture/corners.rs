//! # Corners
//!
//! Four colours at the corners of the texture coordinates' square, and what lies between them. Beyond it the colours of its edges go on.

use straal_color::Light;
use straal_math::ops;
use straal_scene::desc;

use super::{Maker, Mapping, Pattern, Reading, ShadingPoint, Use, Value};
use crate::lanes::{Colour, Lanes};
use crate::shape::TriangleMesh;

/// Between four colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Corners {
    /// At (0, 0), (1, 0), (0, 1) and (1, 1).
    pub colours: [Value<Colour>; 4],
    /// How they lie on the surface.
    pub mapping: Mapping,
}

impl Corners {
    pub(super) fn of(d: &desc::CornersTexture, make: &mut dyn Maker) -> Self {
        let colours = [&d.v00, &d.v10, &d.v01, &d.v11].map(|v| make.part(v));
        Self { colours, mapping: make.mapping(&d.mapping) }
    }

    fn shares(&self, at: &ShadingPoint, meshes: &[TriangleMesh]) -> [f32; 4] {
        self.mapping.over(at, meshes, |spot| {
            let [s, t] = spot.st.map(|v| ops::clamp(v, 0.0, 1.0));
            [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t]
        })
    }
}

impl Pattern for Corners {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, _: Use) -> Light {
        let shares = self.shares(at, reading.meshes);
        let pairs = self.colours.iter().zip(shares);
        pairs.fold(Light::ZERO, |sum, (colour, share)| sum + reading.eval(colour, at) * share)
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        let shares = self.shares(at, reading.meshes);
        self.colours.iter().zip(shares).map(|(colour, share)| reading.number(colour, at) * share).sum()
    }

    fn most(&self) -> f32 {
        self.colours.iter().map(Value::most).fold(0.0, ops::max)
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        let colours = [[0.9, 0.5, 0.1], [0.2, 0.4, 0.3], [0.0, 0.0, 1.0], [0.3, 0.2, 0.1]];
        // Well within the square, of which a pixel sees no edge.
        let mapping = Mapping::Plane([[0.05, 0.0, 0.5], [0.0, 0.05, 0.5]]);
        vec![Self { colours: colours.map(|c| Light::rgb(c).into()), mapping }]
    }
}
