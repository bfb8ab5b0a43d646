//! # Scale, mix, add, invert, remap
//!
//! Textures that are made of others: lane by lane where a colour is wanted, with numbers where a number is. What they are made of may be
//! constant or textures again; all are read at the same point, and nothing is kept in between.

use straal_color::Light;
use straal_math::ops;
use straal_scene::desc;

use super::{Maker, Pattern, Reading, ShadingPoint, Use, Value};
use crate::lanes::{Colour, Lanes};

/// A texture times a number and a colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// What is multiplied.
    pub of: Value<Colour>,
    /// By a number.
    pub by: Value<f32>,
    /// And by a share of light.
    pub tint: Value<Colour>,
}

impl Scale {
    pub(super) fn of(d: &desc::ScaleTexture, make: &mut dyn Maker) -> Self {
        Self { of: make.part(&d.of), by: make.number(&d.by), tint: make.share(&d.tint) }
    }
}

impl Pattern for Scale {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, _: Use) -> Light {
        reading.eval(&self.of, at) * reading.eval(&self.tint, at) * reading.eval(&self.by, at)
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        reading.number(&self.of, at) * reading.number(&self.tint, at) * reading.eval(&self.by, at)
    }

    fn most(&self) -> f32 {
        self.of.most() * self.by.most() * self.tint.most()
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        vec![Self { of: grey(0.8), by: 0.5.into(), tint: Light::rgb([1.0, 0.5, 0.25]).into() }]
    }
}

/// Between two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mix {
    /// At 0 and at 1.
    pub parts: [Value<Colour>; 2],
    /// The share of the second.
    pub amount: Value<f32>,
}

impl Mix {
    pub(super) fn of(d: &desc::MixTexture, make: &mut dyn Maker) -> Self {
        Self { parts: [make.part(&d.first), make.part(&d.second)], amount: make.number(&d.amount) }
    }
}

impl Pattern for Mix {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, _: Use) -> Light {
        let amount = ops::clamp(reading.eval(&self.amount, at), 0.0, 1.0);
        let [a, b] = [0, 1].map(|i| reading.eval(&self.parts[i], at));
        a * (1.0 - amount) + b * amount
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        let amount = ops::clamp(reading.eval(&self.amount, at), 0.0, 1.0);
        let [a, b] = [0, 1].map(|i| reading.number(&self.parts[i], at));
        a * (1.0 - amount) + b * amount
    }

    fn most(&self) -> f32 {
        ops::max(self.parts[0].most(), self.parts[1].most())
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        vec![Self { parts: [grey(0.2), grey(0.9)], amount: 0.3.into() }]
    }
}

/// The sum of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Add {
    /// What is added.
    pub parts: [Value<Colour>; 2],
}

impl Add {
    pub(super) fn of(d: &desc::AddTexture, make: &mut dyn Maker) -> Self {
        Self { parts: [make.part(&d.first), make.part(&d.second)] }
    }
}

impl Pattern for Add {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, _: Use) -> Light {
        reading.eval(&self.parts[0], at) + reading.eval(&self.parts[1], at)
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        reading.number(&self.parts[0], at) + reading.number(&self.parts[1], at)
    }

    fn most(&self) -> f32 {
        self.parts[0].most() + self.parts[1].most()
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        vec![Self { parts: [grey(0.2), Light::rgb([0.1, 0.2, 0.3]).into()] }]
    }
}

/// What is missing to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Invert {
    /// Of what.
    pub of: Value<Colour>,
}

impl Invert {
    pub(super) fn of(d: &desc::InvertTexture, make: &mut dyn Maker) -> Self {
        Self { of: make.part(&d.of) }
    }
}

impl Pattern for Invert {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, _: Use) -> Light {
        let of = reading.eval(&self.of, at);
        // The lanes that carry no light stay without.
        let full = reading.lanes.full();
        Light(std::array::from_fn(|i| if full[i] > 0.0 { ops::max(1.0 - of[i], 0.0) } else { 0.0 }))
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        ops::max(1.0 - reading.number(&self.of, at), 0.0)
    }

    fn most(&self) -> f32 {
        1.0
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        vec![Self { of: Light::rgb([0.1, 0.2, 0.3]).into() }]
    }
}

/// From one range to another, by a power in between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remap {
    /// Of what.
    pub of: Value<Colour>,
    /// What becomes the ends of `to`; what lies beyond is cut off.
    pub from: [f32; 2],
    /// The new ends.
    pub to: [f32; 2],
    /// Shares of the way are raised to this power.
    pub power: f32,
}

impl Remap {
    pub(super) fn of(d: &desc::RemapTexture, make: &mut dyn Maker) -> Self {
        let pair = |v: [f64; 2]| v.map(|v| v as f32);
        Self { of: make.part(&d.of), from: pair(d.from), to: pair(d.to), power: d.power as f32 }
    }

    fn remapped(&self, v: f32) -> f32 {
        let [low, high] = self.from;
        let share = ops::clamp((v - low) / (high - low), 0.0, 1.0);
        let share = if self.power == 1.0 || share == 0.0 { share } else { ops::pow(share, self.power) };
        self.to[0] + (self.to[1] - self.to[0]) * share
    }
}

impl Pattern for Remap {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, _: Use) -> Light {
        let of = reading.eval(&self.of, at);
        let full = reading.lanes.full();
        Light(std::array::from_fn(|i| if full[i] > 0.0 { ops::max(self.remapped(of[i]), 0.0) } else { 0.0 }))
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        self.remapped(reading.number(&self.of, at))
    }

    fn most(&self) -> f32 {
        ops::max(ops::max(self.to[0], self.to[1]), 0.0)
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        let of = Light::rgb([0.1, 0.5, 0.9]).into();
        vec![
            Self { of, from: [0.2, 0.8], to: [0.0, 2.0], power: 1.0 },
            Self { of, from: [1.0, 0.0], to: [0.1, 0.4], power: 2.2 },
        ]
    }
}

#[cfg(test)]
fn grey(v: f32) -> Value<Colour> {
    Light::rgb([v; 3]).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::in_rgb;

    const AT: ShadingPoint = ShadingPoint::NOWHERE;

    fn rgb(p: &impl Pattern) -> [f32; 3] {
        p.light(&AT, &in_rgb(), Use::Reflectance).to_rgb()
    }

    fn near(a: [f32; 3], b: [f32; 3]) {
        (0..3).for_each(|c| assert!((a[c] - b[c]).abs() < 1e-6, "{a:?}, not {b:?}"));
    }

    #[test]
    fn parts_are_put_together_as_they_should() {
        let colour: Value<Colour> = Light::rgb([0.2, 0.4, 0.8]).into();
        near(
            rgb(&Scale { of: colour, by: 2.0.into(), tint: Light::rgb([0.5, 1.0, 0.25]).into() }),
            [0.2, 0.8, 0.4],
        );
        near(rgb(&Mix { parts: [colour, grey(1.0)], amount: 0.25.into() }), [0.4, 0.55, 0.85]);
        near(rgb(&Mix { parts: [colour, grey(1.0)], amount: 7.0.into() }), [1.0; 3]);
        near(rgb(&Add { parts: [colour, grey(0.5)] }), [0.7, 0.9, 1.3]);
        near(rgb(&Invert { of: colour }), [0.8, 0.6, 0.2]);
        let remap = Remap { of: colour, from: [0.2, 0.6], to: [1.0, 0.0], power: 2.0 };
        near(rgb(&remap), [1.0, 0.75, 0.0]);
        assert_eq!(remap.number(&AT, &in_rgb()), 1.0);
        // Nothing is in the lane that RGB doesn't use.
        assert_eq!(Invert { of: colour }.light(&AT, &in_rgb(), Use::Reflectance).0[3], 0.0);
    }
}
