//! The parameters of OpenPBR at a point, for one vertex or many side by side.

use straal_color::Light;
use straal_math::Vec3;
use straal_math::simd::Float;

use super::fuzz;

/// The parameters of the material at a point, for each of the vertices side by side.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Params<F: Float> {
    /// `base_color` times `base_weight`.
    pub base: Light<F>,
    pub specular: Light<F>,
    /// What is left of light that passes the surface.
    pub transmission: Light<F>,
    pub subsurface: Light<F>,
    pub coat: Light<F>,
    pub fuzz: Light<F>,
    /// The wavelength of each lane in nm.
    pub nm: Light<F>,
    pub metalness: F,
    pub specular_weight: F,
    pub transmission_weight: F,
    pub subsurface_weight: F,
    pub coat_weight: F,
    pub fuzz_weight: F,
    /// How much of a film is there, thin ones faded.
    pub film_presence: F,
    pub diffuse_roughness: F,
    pub roughness: F,
    pub coat_roughness: F,
    pub fuzz_roughness: F,
    pub ior: F,
    pub coat_ior: F,
    pub film_ior: F,
    /// In nm.
    pub film_thickness: F,
    /// 20 over Abbe's number; 0 for none.
    pub dispersion: F,
    pub anisotropy: F,
    pub coat_anisotropy: F,
    pub coat_darkening: F,
    pub subsurface_anisotropy: F,
    /// Where brushed facets are rougher: a unit vector along the tangent and across it.
    pub along: [F; 2],
    /// The coat's unit normal.
    pub coat_normal: Vec3<F>,
    /// Whether `along` isn't the tangent.
    pub turned: F::Mask,
    /// Whether the coat's normal isn't that of the base.
    pub leans: F::Mask,
    /// A wall without thickness.
    pub thin: F::Mask,
    /// Whether the back of what is opaque is black; else it looks like the front.
    pub one_sided: F::Mask,
    /// Lanes are red, green and blue, and a dead one.
    pub rgb: F::Mask,
    /// A refraction has parted lanes: a single one is alive.
    pub parted: F::Mask,
    /// Coat and fuzz take away what they reflect on the way in and on the way out.
    pub reciprocal: F::Mask,
}

#[cfg(test)]
impl Params<f32> {
    /// The defaults of the specification, in RGB, black.
    pub const BLANK: Self = Self {
        base: Light([0.0; 4]),
        specular: Light([1.0, 1.0, 1.0, 0.0]),
        transmission: Light([1.0, 1.0, 1.0, 0.0]),
        subsurface: Light([0.8, 0.8, 0.8, 0.0]),
        coat: Light([1.0, 1.0, 1.0, 0.0]),
        fuzz: Light([1.0, 1.0, 1.0, 0.0]),
        nm: Light(LINES),
        metalness: 0.0,
        specular_weight: 1.0,
        transmission_weight: 0.0,
        subsurface_weight: 0.0,
        coat_weight: 0.0,
        fuzz_weight: 0.0,
        film_presence: 0.0,
        diffuse_roughness: 0.0,
        roughness: 0.3,
        coat_roughness: 0.0,
        fuzz_roughness: 0.5,
        ior: 1.5,
        coat_ior: 1.6,
        film_ior: 1.4,
        film_thickness: 500.0,
        dispersion: 0.0,
        anisotropy: 0.0,
        coat_anisotropy: 0.0,
        coat_darkening: 1.0,
        subsurface_anisotropy: 0.0,
        along: [1.0, 0.0],
        coat_normal: Vec3::Z,
        turned: false,
        leans: false,
        thin: false,
        one_sided: false,
        rgb: true,
        parted: false,
        reciprocal: false,
    };
}

impl Params<f32> {
    /// Brushed in a direction of the frame, with a coat that has a normal of its own, if it has.
    pub fn turned_to(self, along: [f32; 2], coat_normal: Option<Vec3>) -> Self {
        let coat_normal = coat_normal.filter(|_| self.coat_weight > 0.0);
        Self {
            along,
            turned: along != [1.0, 0.0],
            coat_normal: coat_normal.unwrap_or(Vec3::Z),
            leans: coat_normal.is_some(),
            ..self
        }
    }

    /// Whether there is nothing but delta lobes, whatever the direction.
    pub fn is_delta(&self) -> bool {
        let dielectric = 1.0 - self.metalness;
        let even = dielectric * (1.0 - self.transmission_weight);
        let is_even = even * (1.0 - self.subsurface_weight) * self.base.max_lane() > 0.0
            || even * self.subsurface_weight * self.subsurface.max_lane() > 0.0;
        let [alpha, coat_alpha] = self.alphas(self.coat_weight > 0.0, self.coat_ior);
        !is_even
            && self.fuzz_weight <= 0.0
            && alpha < SMOOTH
            && (self.coat_weight <= 0.0 || coat_alpha < SMOOTH)
    }

    /// The colour of the surface, for people and denoisers: what its parts have straight on.
    pub fn colour(&self) -> Light {
        let dielectric = 1.0 - self.metalness;
        let rest = dielectric * (1.0 - self.transmission_weight);
        let below = self.base
            * (self.metalness * self.specular_weight + rest * (1.0 - self.subsurface_weight))
            + self.subsurface * (rest * self.subsurface_weight)
            + self.transmission * (dielectric * self.transmission_weight);
        let coated = below * Light::ONE.mix(self.coat, self.coat_weight);
        let live = Light([1.0, 1.0, 1.0, if self.rgb { 0.0 } else { 1.0 }]);
        coated.mix(self.fuzz, self.fuzz_weight * fuzz::reflects(self.fuzz_roughness, 1.0)) * live
    }
}

impl<F: Float> Params<F> {
    /// GGX's alpha of the base and of the coat: each layer makes those below it rougher.
    #[inline(always)]
    pub fn alphas(&self, coated: F::Mask, eta_coat: F) -> [F; 2] {
        let dead = F::select(self.rgb, F::ZERO, self.fuzz.0[3]);
        let [a, b, c, _] = self.fuzz.0;
        let mean = (a + b + c + dead) * F::select(self.rgb, F::splat(1.0 / 3.0), F::splat(0.25));
        let by_fuzz = mean * self.fuzz_roughness * 0.005 * fourth_power(self.fuzz_roughness);
        let coat = lerp(self.coat_roughness, roughened(self.coat_roughness, by_fuzz), self.fuzz_weight);
        // A coat bends light the more the higher its index, and so scatters what lies below it.
        let bends = F::ONE - F::select(eta_coat.ge(F::ONE), F::ONE / eta_coat, eta_coat);
        let by_coat = F::select(coated, bends * fourth_power(coat), F::ZERO);
        let base = lerp(self.roughness, roughened(self.roughness, by_coat), self.coat_weight);
        [base * base, coat * coat]
    }
}

/// Facets of alpha below this are a mirror: their lobe is narrower than single precision can tell directions apart.
pub(super) const SMOOTH: f32 = 1e-4;

/// The wavelengths in nm by which red, green and blue are parted and interfere; of the dead lane any.
pub(super) const LINES: [f32; 4] = [620.0, 540.0, 450.0, 540.0];

/// An index of refraction is kept at least by this factor from 1, where light would go straight on whatever the facet.
pub(super) const LEAST_INDEX: f32 = 1.000_1;

#[inline(always)]
fn fourth_power<F: Float>(x: F) -> F {
    let square = x * x;
    square * square
}

#[inline(always)]
pub(super) fn lerp<F: Float>(a: F, b: F, by: F) -> F {
    a * (F::ONE - by) + b * by
}

/// A roughness, made rougher by another.
#[inline(always)]
fn roughened<F: Float>(roughness: F, by: F) -> F {
    (fourth_power(roughness) + by).min(F::ONE).sqrt().sqrt()
}
