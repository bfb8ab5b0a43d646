//! # Dielectric with dispersion
//!
//! Glass whose index of refraction depends on the wavelength: red is bent least, blue most. A refraction that parts the
//! wavelengths ends all lanes but the first, which is scaled by their number. In RGB the first such refraction draws a
//! wavelength, and weighs its light by a colour that is white on average: where wavelengths part there is a rainbow, and
//! where they meet again none.

use straal_color::Light;
use straal_math::{Vec3, ops};

use super::{BsdfSample, Dielectric, Scatter, Transport, fresnel, mirror::reflected};
use crate::lanes::{Carried, EtaTable, SpectralTables};

/// A smooth boundary of a medium with dispersion.
#[derive(Clone, Copy, Debug)]
pub struct DispersiveDielectric<'w> {
    /// Index on the side of -z over that on the side of z.
    pub eta: &'w EtaTable,
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
        self.with(self.eta.middle).albedo()
    }

    /// `u_lobe` chooses the lobe, `u[0]` a wavelength.
    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        // Straight through, all go the same way.
        let parts = wo.x != 0.0 || wo.y != 0.0;
        match Carried::unpacked(self.carried) {
            Carried::One(nm) => self.with(self.eta.at(nm)).sample(wo, u_lobe, u, transport),
            Carried::All if parts => self.part_rgb(wo, [u_lobe, u[0]], transport),
            Carried::All => self.with(self.eta.middle).sample(wo, u_lobe, u, transport),
            Carried::Four(nm) => self.part_lanes(wo, u_lobe, &nm.map(|nm| self.eta.at(nm)), transport),
        }
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        vec![
            super::testing::Example::new("flint, one wavelength", super::testing::flint(Carried::One(450.0)))
                .albedo(1.0),
        ]
    }
}

impl DispersiveDielectric<'_> {
    /// The same for one index.
    fn with(&self, eta: f32) -> Dielectric {
        Dielectric { eta, reflectance: self.reflectance, transmittance: self.transmittance }
    }

    /// The lobe by the index of yellow, so that both together lose nothing; the direction by a wavelength.
    fn part_rgb(&self, wo: Vec3, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        let yellow = self.with(self.eta.middle).sample(wo, u[0], [0.0; 2], transport)?;
        if !yellow.transmitted {
            return Some(yellow);
        }
        let (nm, colour) = self.tables.draw_wavelength(u[1]);
        // A number of 1 is above every share: refracted, where anything is.
        let one = self.with(self.eta.at(nm)).sample(wo, 1.0, [0.0; 2], transport)?;
        if one.pdf == 0.0 {
            // Just beyond the critical angle for this wavelength.
            return Some(BsdfSample { pdf: yellow.pdf, ..reflected(wo, self.reflectance * colour, 1.0) });
        }
        Some(BsdfSample { weight: one.weight * colour, pdf: yellow.pdf, wavelength: nm, ..one })
    }

    /// Reflects with the mean chance of all lanes; what is refracted keeps the first, for all four.
    fn part_lanes(&self, wo: Vec3, u_lobe: f32, etas: &[f32; 4], transport: Transport) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let relative = etas.map(|eta| if wo.z > 0.0 { eta } else { 1.0 / eta });
        let shares = Light(relative.map(|eta| fresnel::dielectric(wo.z.abs(), eta).reflected));
        let chance = 0.25 * (shares[0] + shares[1] + shares[2] + shares[3]);
        if u_lobe < chance {
            return Some(reflected(wo, self.reflectance * shares * (1.0 / chance), chance));
        }
        let passes = 1.0 - chance;
        let refracted = self.with(etas[0]).refracted(wo, transport)?;
        let rest = shares.map(|share| ops::max(1.0 - share, 0.0) / passes);
        if wo.x == 0.0 && wo.y == 0.0 {
            let compression = Light(relative.map(|eta| match transport {
                Transport::Radiance => 1.0 / (eta * eta),
                Transport::Importance => 1.0,
            }));
            let weight = self.transmittance * compression * rest;
            return Some(BsdfSample { weight, pdf: passes, ..refracted });
        }
        let first = Light([4.0, 0.0, 0.0, 0.0]);
        let weight = refracted.weight * rest * first;
        Some(BsdfSample { weight, pdf: passes, wavelength: 1.0, ..refracted })
    }
}
