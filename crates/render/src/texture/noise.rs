//! # Noise
//!
//! Clouds, wrinkles, wind on water, the veins of marble: sums of Perlin's noise, each finer and lower than the one before. It is a number for each place in space, so that
//! what is made of it looks carved. What is finer than a pixel is left out, as pbrt does it.

use straal_color::Light;
use straal_math::ops;
use straal_scene::desc::{self, NoiseForm};

use super::perlin::Octaves;
use super::solid::Solid;
use super::{Maker, Pattern, Place, Reading, ShadingPoint, Use};
use crate::lanes::Lanes;

/// A sum of noises.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// What is made of them.
    pub form: NoiseForm,
    /// How many.
    pub octaves: u32,
    /// By how much each is lower than the one before.
    pub roughness: f32,
    /// Of marble: how far its layers are bent.
    pub variation: f32,
    /// Where.
    pub solid: Solid,
}

impl Noise {
    pub(super) fn of(d: &desc::NoiseTexture, make: &mut dyn Maker) -> Self {
        Self {
            form: d.form.clone(),
            octaves: d.octaves,
            roughness: d.roughness as f32,
            variation: d.variation as f32,
            solid: make.solid(&d.space, &d.transform),
        }
    }

    fn value(&self, at: &ShadingPoint) -> f32 {
        let Place { p, dpdx, dpdy } = self.solid.place(at);
        let seen = ops::max(dpdx.length_squared(), dpdy.length_squared());
        let octaves = |most, roughness, seen| Octaves { most, roughness, seen };
        let own = octaves(self.octaves, self.roughness, seen);
        match self.form {
            NoiseForm::Fbm => own.sum(p),
            NoiseForm::Wrinkled => own.creased(p),
            NoiseForm::Windy => {
                let wind = octaves(3, 0.5, 0.01 * seen).sum(p * 0.1).abs();
                wind * octaves(6, 0.5, seen).sum(p)
            }
            NoiseForm::Marble => 0.5 + 0.5 * ops::sin(p.y + self.variation * own.sum(p)),
        }
    }

    /// The most that so many octaves may be.
    fn all(octaves: u32, roughness: f32) -> f32 {
        (0..octaves).fold((0.0, 1.0), |(sum, high), _| (sum + high, high * roughness)).0
    }
}

impl Pattern for Noise {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, of: Use) -> Light {
        of.read([ops::max(self.value(at), 0.0); 3], reading)
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, _: &Reading<'_, L>) -> f32 {
        self.value(at)
    }

    fn most(&self) -> f32 {
        match self.form {
            NoiseForm::Fbm | NoiseForm::Wrinkled => Self::all(self.octaves + 1, self.roughness),
            NoiseForm::Windy => Self::all(3, 0.5) * Self::all(6, 0.5),
            NoiseForm::Marble => 1.0,
        }
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        use straal_math::{Affine, DVec3, Transform};
        // So large that a pixel sees next to nothing of it: what it sees of more isn't the exact mean.
        let large = Affine::scale(DVec3::splat(100.0)).then(&Affine::translate(DVec3::new(31.0, 17.0, 44.0)));
        let transform = Transform::new(&large).unwrap_or(Transform::IDENTITY);
        let solid = Solid { of_world: false, transform };
        let of = |form, octaves| Self { form, octaves, roughness: 0.5, variation: 0.2, solid: solid.clone() };
        vec![
            of(NoiseForm::Fbm, 3),
            of(NoiseForm::Wrinkled, 3),
            of(NoiseForm::Windy, 8),
            of(NoiseForm::Marble, 3),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::in_rgb;
    use straal_math::{Transform, Vec3};

    /// Where nothing bends them, the layers of marble are a sine of the height.
    #[test]
    fn marble_is_made_of_layers() {
        let solid = Solid { of_world: true, transform: Transform::IDENTITY };
        let marble = Noise { form: NoiseForm::Marble, octaves: 8, roughness: 0.5, variation: 0.0, solid };
        for y in [-2.0_f32, 0.0, 0.7] {
            let at = ShadingPoint::of([0.0; 2], Vec3::new(3.0, y, -1.0));
            let want = 0.5 + 0.5 * ops::sin(y);
            assert!((marble.number(&at, &in_rgb()) - want).abs() < 1e-6);
        }
    }
}
