//! Two ways to find the light that falls on a point: by points on lights, and by directions of the BSDF.
//!
//! The light that a point sends out is an integral over the directions from which light comes (the *hemisphere form*), or over the surfaces that
//! shine (the *area form*). Directions drawn from the BSDF are samples of the first, points on lights of the second. Either alone
//! gives the right picture; which is less noisy depends on how sharp the BSDF is and how small the light. Together each is weighed
//! by how likely it was beside the other (Veach 1997, section 9.2).

use straal_math::simd::Float;
use straal_scene::desc;

/// Which of them are used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Technique {
    /// Both, each weighed by the power heuristic.
    #[default]
    Mis,
    /// Points on lights alone, but where only a mirror or glass shows them.
    Lights,
    /// Directions of the BSDF alone, but for lights that no ray can hit.
    Bsdf,
}

impl Technique {
    pub(super) fn of(said: &desc::Technique) -> Self {
        match said {
            desc::Technique::Mis => Self::Mis,
            desc::Technique::Lights => Self::Lights,
            desc::Technique::Bsdf => Self::Bsdf,
        }
    }

    /// The name that a scene has for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mis => "mis",
            Self::Lights => "lights",
            Self::Bsdf => "bsdf",
        }
    }

    /// The weight of light that was found by a point on a light, drawn with the first density (by solid angle), where the BSDF would have drawn the
    /// direction with the second. Not for lights that no ray can hit.
    #[inline(always)]
    pub(super) fn of_light<F: Float>(self, light: F, bsdf: F) -> F {
        match self {
            Self::Mis => power_heuristic(light, bsdf),
            Self::Lights => F::ONE,
            Self::Bsdf => F::ZERO,
        }
    }

    /// The weight of light that a direction of the BSDF found, where a point on the light would have been drawn with the second density: 0 for what can't be
    /// drawn. Not for directions of delta lobes.
    #[inline(always)]
    pub(super) fn of_bsdf<F: Float>(self, bsdf: F, light: F) -> F {
        match self {
            Self::Mis => power_heuristic(bsdf, light),
            Self::Lights => F::select(light.gt(F::ZERO), F::ZERO, F::ONE),
            Self::Bsdf => F::ONE,
        }
    }
}

/// Power heuristic with exponent 2 for a sample drawn with density `a` that another technique would have drawn
/// with density `b` (Veach 1997, section 9.2.4).
#[inline(always)]
fn power_heuristic<F: Float>(a: F, b: F) -> F {
    // By the ratio: squares of densities leave the range of single precision.
    let r = b / a;
    F::ONE / (F::ONE + r * r)
}
