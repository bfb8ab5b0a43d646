//! # Plastic
//!
//! An evenly scattering ground below a clear boundary: what the boundary doesn't reflect goes in, is scattered, and comes out but for what is
//! reflected back down, time and again. It is the `plastic` and `roughplastic` of Mitsuba (Jakob et al.):
//!
//! f = F / (mirrored direction) + T(wo) T(wi) rho' / (pi eta²),
//!
//! with T = 1 - F, and rho' = rho / (1 - F_in), or rho / (1 - rho F_in) where `nonlinear`; F_in is the share of even light that is reflected from within. Where
//! the boundary is rough the first term is that of microfacets, and T and F_in are what they let through and reflect ([`super::energy`]).
//!
//! (F_in of a rough boundary is Mitsuba's sum over its table, which is 2 % too small: rough plastic of a bright ground is so much darker than it
//! would be. That of a smooth one is the integral; Mitsuba has a fit that is 0.08 % larger.) Energy is conserved; a white ground below a smooth boundary sends back all light. Reciprocity holds.

use std::f32::consts::FRAC_1_PI;

use straal_color::Light;
use straal_math::{Vec3, ops, warp};
use straal_scene::desc;

use super::energy::{self, Shares};
use super::microfacet::Facets;
use super::{Bsdf, BsdfSample, Recipe, Scatter, Transport, Wants, facing, fresnel, mirror::reflected};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// An evenly scattering ground below a clear boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct PlasticMaterial {
    /// Share of light that the ground reflects.
    pub reflectance: Value<Colour>,
    /// Tint of what the boundary reflects.
    pub specular: Value<Colour>,
    /// Index of refraction inside over that outside.
    pub eta: f32,
    /// Alpha of the boundary's facets.
    pub roughness: Value<f32>,
    /// How they are spread.
    pub distribution: desc::Distribution,
    /// Whether the ground colours light each time.
    pub nonlinear: bool,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
    /// What a rough boundary lets through from outside.
    through: Shares,
    /// What is reflected from within.
    within: Shares,
}

impl PlasticMaterial {
    fn tables(roughness: Value<f32>, distribution: &desc::Distribution, eta: f32) -> [Shares; 2] {
        let alpha = match roughness {
            Value::Constant(alpha) => Some(alpha),
            Value::Texture(_) => None,
        };
        [energy::passed(alpha, distribution, eta), energy::sent_back(alpha, distribution, 1.0 / eta)]
    }
}

impl Recipe for PlasticMaterial {
    type Described = desc::Plastic;

    fn of(d: &desc::Plastic, paint: &mut Paint<'_>) -> Self {
        let eta = d.eta as f32 / d.eta_outside as f32;
        let roughness = paint.number(&d.roughness);
        let [through, within] = Self::tables(roughness, &d.distribution, eta);
        Self {
            reflectance: paint.reflectance(&d.reflectance),
            specular: paint.reflectance(&d.specular),
            eta,
            roughness,
            distribution: d.distribution.clone(),
            nonlinear: d.nonlinear,
            two_sided: d.two_sided,
            through,
            within,
        }
    }

    fn wants(&self) -> Wants {
        Wants::point(self.reflectance.varies() || self.specular.varies() || self.roughness.varies())
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let ground = reading.eval(&self.reflectance, at);
        let alpha = ops::clamp(reading.eval(&self.roughness, at), 0.0, 1.0);
        let within = if alpha > 0.0 {
            self.within.of_all_directions_as_mitsuba(alpha)
        } else {
            self.within.of_all_directions(0.0)
        };
        let coloured = |rho: f32| rho / (1.0 - if self.nonlinear { rho * within } else { within });
        let diffuse = ground.map(coloured) * (1.0 / (self.eta * self.eta));
        let rough =
            (alpha > 0.0).then(|| (Facets::new([alpha; 2], self.distribution.clone()), &self.through));
        Bsdf::Plastic(Plastic {
            diffuse,
            specular: reading.eval(&self.specular, at),
            eta: self.eta,
            rough,
            two_sided: self.two_sided,
        })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let of = |alpha: f32| {
            let (roughness, distribution) = (alpha.into(), desc::Distribution::Ggx);
            let [through, within] = Self::tables(roughness, &distribution, 1.5);
            let white: Value<Colour> = super::testing::WHITE.into();
            Self {
                reflectance: white,
                specular: white,
                eta: 1.5,
                roughness,
                distribution,
                nonlinear: false,
                two_sided: true,
                through,
                within,
            }
        };
        vec![(of(0.0), super::BsdfKind::Plastic), (of(0.2), super::BsdfKind::Plastic)]
    }
}

/// An evenly scattering ground below a clear boundary.
#[derive(Clone, Copy, Debug)]
pub struct Plastic<'w> {
    /// The ground's reflectance with all that bounces below the boundary, over the squared index of refraction.
    pub diffuse: Light,
    /// Tint of what the boundary reflects.
    pub specular: Light,
    /// Index of refraction inside over that outside.
    pub eta: f32,
    /// The boundary's facets and what they let through, where it is rough.
    pub rough: Option<(Facets, &'w Shares)>,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Plastic<'_> {
    /// What the boundary lets through at a cosine.
    #[inline]
    fn through(&self, cos: f32) -> f32 {
        match &self.rough {
            Some((facets, table)) => table.at(facets.mean_alpha(), cos),
            None => 1.0 - fresnel::dielectric(cos, self.eta).reflected,
        }
    }

    /// The chance of the boundary's lobe.
    #[inline]
    fn chance(&self, through: f32) -> f32 {
        let reflected = self.specular.max_lane() * (1.0 - through);
        let scattered = self.diffuse.max_lane() * through;
        if reflected > 0.0 { reflected / (reflected + scattered) } else { 0.0 }
    }

    /// Value and density for directions above the surface, without a delta lobe.
    #[inline]
    fn on_front(&self, wo: Vec3, wi: Vec3) -> (Light, f32) {
        if wi.z <= 0.0 {
            return (Light::ZERO, 0.0);
        }
        let even = wi.z * FRAC_1_PI;
        let through = self.through(wo.z);
        let mut value = self.diffuse * (through * self.through(wi.z) * even);
        let chance = self.chance(through);
        let mut pdf = (1.0 - chance) * even;
        let h = wo + wi;
        let hh = h.length_squared();
        if let Some((facets, _)) = &self.rough
            && hh > f32::MIN_POSITIVE
        {
            let share = fresnel::dielectric(wo.dot(h) / hh.sqrt(), self.eta).reflected;
            let seen = facets.density(h) * facets.seen(wo) * facets.seen(wi) / (4.0 * wo.z);
            value += self.specular * (share * seen);
            pdf += chance * facets.pdf_reflecting(wo, h);
        }
        (value, pdf)
    }
}

impl Scatter for Plastic<'_> {
    const CHOOSES_LOBE: bool = true;

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Light, f32) {
        let Some(side) = facing(wo, self.two_sided) else { return (Light::ZERO, 0.0) };
        self.on_front(Vec3::new(wo.x, wo.y, side * wo.z), Vec3::new(wi.x, wi.y, side * wi.z))
    }

    #[inline]
    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], _: Transport) -> Option<BsdfSample> {
        let side = facing(wo, self.two_sided)?;
        let up = Vec3::new(wo.x, wo.y, side * wo.z);
        let chance = self.chance(self.through(up.z));
        let wi = match &self.rough {
            _ if u_lobe >= chance => warp::cosine_hemisphere(u),
            None => {
                let share = fresnel::dielectric(up.z, self.eta).reflected;
                return Some(reflected(wo, self.specular * (share / chance), chance));
            }
            Some((facets, _)) => {
                let m = facets.sample_reflecting(up, u);
                m * (2.0 * up.dot(m)) - up
            }
        };
        let (value, pdf) = self.on_front(up, wi);
        let weight = value * (1.0 / pdf);
        let wi = Vec3::new(wi.x, wi.y, side * wi.z);
        (pdf > 0.0 && weight.is_finite()).then_some(BsdfSample { wi, weight, pdf, ..BsdfSample::REFLECTED })
    }

    fn albedo(&self) -> Light {
        let through = self.through(1.0);
        // What is scattered comes out with the same share from all directions, near enough.
        let scattered = self.diffuse * (through * through);
        (self.specular * (1.0 - through) + scattered).map(|v| if v < 1.0 { v } else { 1.0 })
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE};
        use std::sync::LazyLock;
        static TABLES: LazyLock<[Shares; 4]> = LazyLock::new(|| {
            let [a, b] = [0.3, 0.15].map(|alpha| {
                let kind = if alpha == 0.3 { desc::Distribution::Ggx } else { desc::Distribution::Beckmann };
                PlasticMaterial::tables(alpha.into(), &kind, 1.5)
            });
            let [(a, b), (c, d)] = [a, b].map(|[through, within]| (through, within));
            [a, b, c, d]
        });
        let [ggx, ggx_within, beckmann, beckmann_within] = &*TABLES;
        let of = |ground: f32, within: f32, rough| Plastic {
            diffuse: Light::rgb([ground / (1.0 - within) / 2.25, ground / 4.5, 0.1]),
            specular: WHITE,
            eta: 1.5,
            rough,
            two_sided: true,
        };
        let smooth_within = 0.596_345_7;
        let facets = |alpha, distribution| Facets::new([alpha; 2], distribution);
        let rough = Some((facets(0.3, desc::Distribution::Ggx), ggx));
        let bell = Some((facets(0.15, desc::Distribution::Beckmann), beckmann));
        let bsdf = Bsdf::Plastic;
        vec![
            Example::new("white plastic", bsdf(of(1.0, smooth_within, None))).nearly_energy(1e-2),
            Example::new("grey plastic", bsdf(of(0.4, smooth_within, None))),
            Example::new("rough plastic", bsdf(of(0.8, ggx_within.of_all_directions(0.3), rough))).focus(3),
            Example::new("satin plastic", bsdf(of(0.5, beckmann_within.of_all_directions(0.15), bell)))
                .focus(4),
            Example::new(
                "one-sided plastic",
                bsdf(Plastic { two_sided: false, ..of(0.5, smooth_within, None) }),
            ),
        ]
    }
}
