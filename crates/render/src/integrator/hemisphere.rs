//! How directions are drawn in which light is looked for.
//!
//! The light that a point sends out is an integral over the directions around it (the *hemisphere form*). Drawn by what the surface scatters, few directions are
//! spent on what counts little. Drawn evenly, or by the cosine alone, they show what that is worth, and what points on lights are (the *area form*).

use crate::material::many::{OfKind, These};
use crate::material::{BsdfSample, Transport, shaded};
use straal_color::Light;
use straal_math::simd::{Float, Mask};
use straal_math::{Vec3, warp};
use straal_scene::desc;

/// By what directions are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Directions {
    /// What the surface scatters.
    #[default]
    Bsdf,
    /// The cosine to its normal.
    Cosine,
    /// Nothing: all of the hemisphere alike.
    Uniform,
}

/// A number that chooses the last of several lobes.
const LAST: f32 = 1.0 - f32::EPSILON / 2.0;

impl Directions {
    pub(super) fn of(said: &desc::Directions) -> Self {
        match said {
            desc::Directions::Bsdf => Self::Bsdf,
            desc::Directions::Cosine => Self::Cosine,
            desc::Directions::Uniform => Self::Uniform,
        }
    }

    /// The name that a scene has for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bsdf => "bsdf",
            Self::Cosine => "cosine",
            Self::Uniform => "uniform",
        }
    }

    /// [`shaded::sample_many`], but for directions that are drawn otherwise.
    #[inline(always)]
    pub(super) fn sample_many<'w, K: OfKind<'w>, F: Float>(
        self,
        these: impl These<K>,
        ng: Vec3<F>,
        (wo, u): (Vec3<F>, [F; 3]),
        is_open: F::Mask,
    ) -> (BsdfSample<F>, F::Mask) {
        let (drawn, there) = shaded::sample_many(these, ng, (wo, u), Transport::Radiance);
        if self == Self::Bsdf {
            return (drawn, there);
        }
        let takes = !is_open & !has_delta(these, ng, wo);
        if !takes.any() {
            return (drawn, there);
        }
        let wi = match self {
            Self::Uniform => warp::uniform_hemisphere([u[1], u[2]]),
            Self::Cosine | Self::Bsdf => warp::cosine_hemisphere([u[1], u[2]]),
        };
        let wi = Vec3::new(wi.x, wi.y, F::select(wo.z.lt(F::ZERO), -wi.z, wi.z));
        let (value, _) = shaded::eval_pdf_many(these, ng, [wo, wi], Transport::Radiance);
        let pdf = self.density([wo, wi]);
        let sound = pdf.gt(F::ZERO) & !value.is_black();
        let sample = BsdfSample {
            wi: Vec3::select(takes, wi, drawn.wi),
            weight: Light::select(takes, value * (F::ONE / pdf), drawn.weight),
            pdf: F::select(takes, pdf, drawn.pdf),
            delta: !takes & drawn.delta,
            transmitted: !takes & drawn.transmitted,
            eta: F::select(takes, F::ONE, drawn.eta),
            wavelength: F::select(takes, F::ZERO, drawn.wavelength),
        };
        (sample, takes & sound | !takes & there)
    }

    /// [`shaded::eval_pdf_many`], with the density of directions as they are drawn.
    #[inline(always)]
    pub(super) fn eval_pdf_many<'w, K: OfKind<'w>, F: Float>(
        self,
        these: impl These<K>,
        ng: Vec3<F>,
        [wo, wi]: [Vec3<F>; 2],
        is_open: F::Mask,
    ) -> (Light<F>, F) {
        let (value, pdf) = shaded::eval_pdf_many(these, ng, [wo, wi], Transport::Radiance);
        if self == Self::Bsdf {
            return (value, pdf);
        }
        let takes = !is_open & !has_delta(these, ng, wo);
        (value, F::select(takes, self.density([wo, wi]), pdf))
    }

    /// By solid angle, on the side of `wo`.
    #[inline(always)]
    fn density<F: Float>(self, [wo, wi]: [Vec3<F>; 2]) -> F {
        let cos = F::select(wo.z.lt(F::ZERO), -wi.z, wi.z);
        match self {
            Self::Uniform => warp::uniform_hemisphere_pdf(cos),
            Self::Cosine | Self::Bsdf => warp::cosine_hemisphere_pdf(cos),
        }
    }
}

/// Whether a part of it is a mirror, which no direction that is drawn otherwise finds. Such lobes come first or last.
#[inline(always)]
fn has_delta<'w, K: OfKind<'w>, F: Float>(these: impl These<K>, ng: Vec3<F>, wo: Vec3<F>) -> F::Mask {
    let half = F::splat(0.5);
    let by = |lobe: f32| {
        let u = [F::splat(lobe), half, half];
        shaded::sample_many(these, ng, (wo, u), Transport::Radiance).0.delta
    };
    by(0.0) | by(LAST)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Bsdf, Diffuse, Metal, Mirror, RoughConductor};
    use crate::shape::tests::monte_carlo;
    use crate::testing::{ChiSquare, SphereGrid};

    const WHITE: Light = Light([1.0, 0.5, 0.25, 0.0]);
    const OTHER: [Directions; 2] = [Directions::Cosine, Directions::Uniform];

    fn draw(by: Directions, bsdf: &Bsdf<'_>, wo: Vec3, u: [f32; 3]) -> Option<BsdfSample> {
        let (s, there) = by.sample_many::<Bsdf<'_>, f32>(bsdf, Vec3::ZERO, (wo, u), false);
        there.then_some(s)
    }

    fn dull() -> [Bsdf<'static>; 2] {
        let metal = Metal { eta: Light::ZERO, k: Light::ZERO, reflectance: WHITE };
        [
            Bsdf::Diffuse(Diffuse { reflectance: WHITE, two_sided: true }),
            Bsdf::RoughConductor(RoughConductor::new(metal, 0.6)),
        ]
    }

    const VIEWS: [Vec3; 2] = [Vec3::new(0.48, 0.36, 0.8), Vec3::new(-0.36, 0.48, -0.8)];

    /// However directions are drawn, they bring the same, with the density that is told.
    #[test]
    fn any_directions_bring_the_same() {
        for (bsdf, wo) in dull().iter().flat_map(|b| VIEWS.map(|wo| (*b, wo))) {
            let mean = |by: Directions, seed| {
                monte_carlo(seed, 20_000, |u| {
                    let drawn = draw(by, &bsdf, wo, [0.3, u[0], u[1]]);
                    drawn.map_or(0.0, |s| f64::from(s.weight[1] * (1.0 + s.wi.x)))
                })
            };
            let usual = mean(Directions::Bsdf, 1);
            for by in OTHER {
                let other = mean(by, 2);
                let error = (usual.1 * usual.1 + other.1 * other.1).sqrt();
                assert!((usual.0 - other.0).abs() < 4.5 * error + 1e-4, "{by:?}: {usual:?} {other:?}");
                let pdf = |wi| by.eval_pdf_many::<Bsdf<'_>, f32>(&bsdf, Vec3::ZERO, [wo, wi], false).1;
                let test = ChiSquare { grid: SphereGrid::default(), seed: 3, tests: 8, samples: 10_000 };
                let outcome = test.run(|u| draw(by, &bsdf, wo, [u[2], u[0], u[1]]).map(|s| s.wi), pdf);
                // What the surface doesn't scatter is drawn as well, and is of no value.
                assert!(outcome.integral < 1.001 && outcome.impossible == 0, "{by:?}: {outcome}");
                let s = draw(by, &bsdf, wo, [0.1, 0.2, 0.7]).unwrap();
                assert!(!s.delta && s.wi.z * wo.z > 0.0 && s.pdf == pdf(s.wi));
            }
        }
    }

    #[test]
    fn mirrors_and_what_is_open_keep_their_own() {
        let mirror = Bsdf::Mirror(Mirror { reflectance: WHITE, two_sided: true });
        for by in OTHER {
            let u = [0.1, 0.2, 0.7];
            assert_eq!(draw(by, &mirror, VIEWS[0], u), draw(Directions::Bsdf, &mirror, VIEWS[0], u));
            let [diffuse, _] = dull();
            let open = by.sample_many::<Bsdf<'_>, f32>(&diffuse, Vec3::ZERO, (VIEWS[0], u), true);
            assert_eq!(Some(open.0), draw(Directions::Bsdf, &diffuse, VIEWS[0], u));
        }
    }
}
