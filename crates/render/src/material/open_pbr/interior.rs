//! What fills a body of OpenPBR, as the specification derives it from colours and depths: what a medium needs to know.

use straal_color::Light;
use straal_math::ops;

use super::OpenPbrMaterial;
use crate::lanes::{Colour, Lanes};
use crate::texture::{Reading, ShadingPoint, Value};

/// A medium: of light that is on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interior {
    /// Absorbed or scattered per metre.
    pub extinction: Light,
    /// Which part of that is scattered.
    pub albedo: Light,
    /// Mean cosine of the angle by which light is turned (Henyey and Greenstein's g).
    pub anisotropy: f32,
}

/// Darker colours and shorter ways than these are taken for them: their logarithms and reciprocals have no bound.
const LEAST_COLOUR: f32 = 1e-3;
const LEAST_LENGTH: f32 = 1e-3;
/// Light that is hardly turned at all isn't told from light that goes on.
const MOST_ANISOTROPY: f32 = 0.999;

impl Interior {
    pub(super) fn of<L: Lanes>(m: &OpenPbrMaterial, at: &ShadingPoint, reading: &Reading<'_, L>) -> Self {
        let number = |v: &Value<f32>| reading.eval(v, at);
        let colour = |v: &Value<Colour>| reading.eval(v, at);
        if m.geometry_thin_walled {
            return Self::default();
        }
        let trans = number(&m.transmission_weight);
        let sss = (1.0 - trans) * number(&m.subsurface_weight);
        let mut parts = [(Self::default(), 0.0); 2];
        if sss > 0.0 {
            let radius = colour(&m.subsurface_radius_scale) * number(&m.subsurface_radius);
            let anisotropy = number(&m.subsurface_scatter_anisotropy);
            parts[0] = (Self::beneath(colour(&m.subsurface_color), radius, anisotropy), sss);
        }
        let depth = number(&m.transmission_depth);
        if trans > 0.0 {
            let clear = if depth > 0.0 {
                let scatter = colour(&m.transmission_scatter);
                let anisotropy = number(&m.transmission_scatter_anisotropy);
                Self::tinted(colour(&m.transmission_color), scatter, [depth, anisotropy])
            } else {
                Self::default()
            };
            parts[1] = (clear, trans);
        }
        Self::mixed(parts)
    }

    /// What scatters beneath a surface of a colour: light is turned after `radius` in the mean; the albedo is found from the colour
    /// (van de Hulst 1980, as the specification has it).
    fn beneath(colour: Light, radius: Light, anisotropy: f32) -> Self {
        let g = held(anisotropy);
        let extinction = radius.map(|r| 1.0 / ops::max(r, LEAST_LENGTH));
        let albedo = colour.map(|c| {
            let s = 4.097_12 + 4.208_63 * c - (9.592_17 + 41.680_8 * c + 17.712_6 * c * c).sqrt();
            ops::clamp((1.0 - s * s) / (1.0 - g * s * s), 0.0, 1.0)
        });
        Self { extinction, albedo, anisotropy: g }
    }

    /// What has a colour after a depth, by absorption and scattering.
    fn tinted(colour: Light, scatter: Light, [depth, anisotropy]: [f32; 2]) -> Self {
        let rgb_or_all = colour.0[3] == 0.0;
        let lanes = if rgb_or_all { 3 } else { 4 };
        if (0..lanes).all(|i| colour[i] >= 1.0 && scatter[i] <= 0.0) {
            return Self::default();
        }
        let by = 1.0 / ops::max(depth, LEAST_LENGTH);
        let extinction = colour.map(|c| -ops::ln(ops::max(c, LEAST_COLOUR)) * by);
        let scattering = scatter * by;
        let absorption = extinction - scattering;
        // Less than none can't be absorbed: all is shifted by as much grey.
        let least = (0..lanes).map(|i| absorption[i]).fold(0.0, ops::min::<f32>);
        let absorption = absorption.map(|a| a - least);
        let sum = absorption + scattering;
        let albedo = scattering.zip(sum, |s, all| if all > 0.0 { s / all } else { 0.0 });
        Self { extinction: sum, albedo, anisotropy: held(anisotropy) }
    }

    /// Both at once, each in its part.
    fn mixed(parts: [(Self, f32); 2]) -> Self {
        let sum = parts[0].1 + parts[1].1;
        if sum <= 0.0 {
            return Self::default();
        }
        let (mut absorption, mut scattering, mut anisotropy) = (Light::ZERO, Light::ZERO, 0.0);
        for (of, weight) in parts {
            let weight = weight / sum;
            let scatters = of.extinction * of.albedo * weight;
            absorption += (of.extinction * weight) - scatters;
            scattering += scatters;
            anisotropy += of.anisotropy * weight;
        }
        let extinction = absorption + scattering;
        let albedo = scattering.zip(extinction, |s, all| if all > 0.0 { s / all } else { 0.0 });
        Self { extinction, albedo, anisotropy }
    }
}

fn held(anisotropy: f32) -> f32 {
    ops::clamp(anisotropy, -MOST_ANISOTROPY, MOST_ANISOTROPY)
}
