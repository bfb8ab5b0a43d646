//! # Dielectric with dispersion
//!
//! Glass whose index of refraction depends on the wavelength: red is bent least, blue most. A refraction that parts the
//! wavelengths ends all lanes but the first, which is scaled by their number. In RGB the first such refraction draws a
//! wavelength, and weighs its light by a colour that is white on average: where wavelengths part there is a rainbow, and
//! where they meet again none.

use straal_color::Light;
use straal_math::simd::{BLOCK, Float, Mask};
use straal_math::{Vec3, ops};

use super::many::{self, Lobe, These};
use super::mirror::reflected;
use super::{BsdfSample, Dielectric, Scatter, Transport, fresnel};
use crate::lanes::{Carried, EtaTable, SpectralTables};

/// A smooth boundary of a medium with dispersion.
#[derive(Clone, Copy, Debug)]
pub struct DispersiveDielectric<'w> {
    /// Index on the side of -z over that on the side of z.
    pub eta: &'w EtaTable,
    /// What that is multiplied by.
    pub by: f32,
    /// Draws wavelengths for RGB.
    pub tables: &'w SpectralTables,
    /// The path's wavelengths, see [`Carried::packed`].
    pub carried: [f32; 4],
    /// Tint of what is reflected; physical is 1.
    pub reflectance: Light,
    /// Tint of what passes; physical is 1.
    pub transmittance: Light,
}

impl Scatter for DispersiveDielectric<'_> {
    const CHOOSES_LOBE: bool = true;

    fn albedo(&self) -> Light {
        let yellow = Dielectric {
            eta: self.eta.middle * self.by,
            reflectance: self.reflectance,
            transmittance: self.transmittance,
        };
        yellow.albedo()
    }

    /// `u_lobe` chooses the lobe, `u[0]` a wavelength.
    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        let (sample, there) = Self::sample_many(self, wo, [u_lobe, u[0], u[1]], transport);
        there.then_some(sample)
    }

    #[inline(always)]
    fn sample_many<F: Float>(
        these: impl These<Self>,
        wo: Vec3<F>,
        [u_lobe, u, v]: [F; 3],
        transport: Transport,
    ) -> (BsdfSample<F>, F::Mask) {
        let indices = Indices::<F>::look_up(these, u);
        let glass = Dielectric {
            eta: indices.etas[0],
            reflectance: many::light(these, |d: &Self| d.reflectance),
            transmittance: many::light(these, |d: &Self| d.transmittance),
        };
        let (mut sample, there) = glass.sample(wo, u_lobe, [u, v], transport);
        // Straight through, all go the same way.
        let slants = wo.x.ne(F::ZERO) | wo.y.ne(F::ZERO);
        let parts = slants & indices.rgb & sample.transmitted;
        if parts.any() {
            let parted = indices.part_rgb(&glass, wo, transport);
            sample = BsdfSample::select(parts, BsdfSample { pdf: sample.pdf, ..parted }, sample);
        }
        if indices.four.any() {
            let parted = indices.part_lanes(&glass, (wo, slants), u_lobe, transport);
            sample = BsdfSample::select(indices.four, parted, sample);
        }
        (sample, there)
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        let flint = |carried| super::testing::flint(carried);
        vec![super::testing::Example::new("flint, one wavelength", flint(Carried::One(450.0))).albedo(1.0)]
    }
}

/// What was looked up in tables, vertex by vertex.
struct Indices<F: Float> {
    /// By lane of light; all alike but where wavelengths are told apart.
    etas: [F; 4],
    /// Which carry red, green and blue, of which a refraction draws one wavelength.
    rgb: F::Mask,
    /// Which carry four wavelengths.
    four: F::Mask,
    /// The wavelength drawn in RGB, its index, and the colour by which its light is weighed.
    nm: F,
    eta: F,
    colour: Light<F>,
}

impl<F: Float> Indices<F> {
    #[inline(always)]
    fn look_up<'w>(these: impl These<DispersiveDielectric<'w>>, u: F) -> Self {
        let mut etas = [[0.0; 4]; BLOCK];
        let mut drawn = [(0.0, 0.0, Light::ZERO); BLOCK];
        let (mut rgb, mut four) = (0, 0);
        for i in 0..F::WIDTH {
            let glass = these.of(i);
            etas[i] = match Carried::unpacked(glass.carried) {
                Carried::One(nm) => [glass.eta.at(nm) * glass.by; 4],
                Carried::Four(nm) => {
                    four |= 1 << i;
                    nm.map(|nm| glass.eta.at(nm) * glass.by)
                }
                Carried::All => {
                    rgb |= 1 << i;
                    let (nm, colour) = glass.tables.draw_wavelength(u.lane(i));
                    drawn[i] = (nm, glass.eta.at(nm) * glass.by, colour);
                    [glass.eta.middle * glass.by; 4]
                }
            };
        }
        Self {
            etas: F::from_rows(
                #[inline(always)]
                |i| etas[i],
            ),
            rgb: F::Mask::from_bits(rgb),
            four: F::Mask::from_bits(four),
            nm: F::from_fn(
                #[inline(always)]
                |i| drawn[i].0,
            ),
            eta: F::from_fn(
                #[inline(always)]
                |i| drawn[i].1,
            ),
            colour: Light::from_fn(
                #[inline(always)]
                |i| drawn[i].2,
            ),
        }
    }

    /// What passes in RGB: the lobe was chosen by the index of yellow, so that both together lose nothing; the direction is that of the
    /// wavelength.
    #[inline(always)]
    fn part_rgb(&self, glass: &Dielectric<F>, wo: Vec3<F>, transport: Transport) -> BsdfSample<F> {
        let (_, one) = Dielectric { eta: self.eta, ..*glass }.refracted(wo, transport);
        // Just beyond the critical angle for this wavelength.
        let is_beyond = one.pdf.eq(F::ZERO);
        let reflected = reflected(wo, glass.reflectance * self.colour, F::ONE);
        let refracted = BsdfSample { weight: one.weight * self.colour, wavelength: self.nm, ..one };
        BsdfSample::select(is_beyond, reflected, refracted)
    }

    /// Reflects with the mean chance of all lanes; what is refracted keeps the first, for all four, unless all go straight through.
    #[inline(always)]
    fn part_lanes(
        &self,
        glass: &Dielectric<F>,
        (wo, slants): (Vec3<F>, F::Mask),
        u_lobe: F,
        transport: Transport,
    ) -> BsdfSample<F> {
        let relative = Light(self.etas).map(
            #[inline(always)]
            |eta| F::select(wo.z.gt(F::ZERO), eta, F::ONE / eta),
        );
        let shares = relative.map(
            #[inline(always)]
            |eta| fresnel::dielectric(wo.z.abs(), eta).reflected,
        );
        let chance = (shares[0] + shares[1] + shares[2] + shares[3]) * 0.25;
        let reflected = reflected(wo, glass.reflectance * shares * (F::ONE / chance), chance);
        let passes = F::ONE - chance;
        let (_, refracted) = glass.refracted(wo, transport);
        let rest = shares.map(
            #[inline(always)]
            |share| ops::max(F::ONE - share, F::ZERO) / passes,
        );
        let compression = relative.map(
            #[inline(always)]
            |eta| match transport {
                Transport::Radiance => F::ONE / (eta * eta),
                Transport::Importance => F::ONE,
            },
        );
        let straight = glass.transmittance * compression * rest;
        let first = Light([F::splat(4.0), F::ZERO, F::ZERO, F::ZERO]);
        let weight = Light::select(slants, refracted.weight * rest * first, straight);
        let wavelength = F::select(slants, F::ONE, F::ZERO);
        let refracted = BsdfSample { weight, pdf: passes, wavelength, ..refracted };
        BsdfSample::select(u_lobe.lt(chance), reflected, refracted)
    }
}
