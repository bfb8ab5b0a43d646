//! What the four lanes of light are: red, green and blue, or four wavelengths.
//!
//! Transport never asks. [`Lanes`] is what a path carries to read the scene's colours by, off the [`SpectralTables`] of its
//! world; the driver is compiled for each kind, so that RGB pays nothing for wavelengths. What the film sees of them is its
//! sensor's business ([`crate::film::Sensor`]).
//!
//! Wavelengths are drawn with hero wavelength sampling (Wilkie et al. 2014): the first by chance, the other three a quarter
//! of the way round each, in steps of probability. A path's directions are drawn alike for all four, or only the first goes
//! on, so that the balance heuristic gives each a quarter. Spectra are constant within each nanometre.

use std::fmt;

use straal_color::Light;
use straal_color::spectrum::FIRST;
use straal_math::simd::{BLOCK, Float};

mod tables;

pub(crate) use tables::table_of;
pub use tables::{Colour, Eta, EtaTable, SpectralTables};

/// By what a path reads colours.
pub trait Lanes: Copy + PartialEq + fmt::Debug + Send + Sync + 'static {
    /// Whether a number is drawn at the camera.
    const DRAWN: bool;

    /// At the camera, by a number in [0, 1).
    fn drawn(tables: &SpectralTables, u: f32) -> Self;

    /// Throughput at the camera: 1 in the lanes that carry light.
    fn full(self) -> Light;

    /// A colour of the scene.
    fn light(self, tables: &SpectralTables, colour: &Colour) -> Light;

    /// [`Self::light`] for many paths side by side.
    #[inline(always)]
    fn lights<F: Float>(these: &[Self], tables: &SpectralTables, colour: &Colour) -> Light<F> {
        Light::from_fn(
            #[inline(always)]
            |i| these[i].light(tables, colour),
        )
    }

    /// [`Self::radiance_of_rgb`] for many paths side by side.
    #[inline(always)]
    fn radiances_of_rgb<F: Float>(these: &[Self], tables: &SpectralTables, rgb: Light<F>) -> Light<F> {
        let mut rows = [Light::ZERO; BLOCK];
        rgb.for_each(
            #[inline(always)]
            |i, rgb| rows[i] = these[i].radiance_of_rgb(tables, rgb),
        );
        Light::from_fn(
            #[inline(always)]
            |i| rows[i],
        )
    }

    /// Light of linear RGB, lit as D65 is where lanes are wavelengths; there channels below 0 are of colours that sRGB doesn't hold.
    fn radiance_of_rgb(self, tables: &SpectralTables, rgb: Light) -> Light;

    /// Reflectance of linear RGB.
    fn reflectance_of_rgb(self, tables: &SpectralTables, rgb: Light) -> Light;

    /// A number for each wavelength that is no colour, such as an index of refraction, of those for red, green and blue.
    fn coefficient_of_rgb(self, tables: &SpectralTables, rgb: Light) -> Light;

    /// Which wavelengths they are.
    fn carried(self) -> Carried;

    /// What goes on when a refraction has parted the lanes: this wavelength, in the first lane where lanes are wavelengths.
    fn only(self, nm: f32) -> Self;

    /// By nanometre from the first of the tables, where each lane is, if lanes are wavelengths: what the film sees them by.
    fn bins(self) -> Option<[u16; 4]>;
}

/// The wavelengths that a path carries, as a medium with dispersion must know them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carried {
    /// Not told apart: red, green and blue.
    All,
    /// A single wavelength in nm, in all lanes that are alive.
    One(f32),
    /// Four wavelengths in nm.
    Four([f32; 4]),
}

impl Carried {
    /// In four numbers, of which none is a wavelength where it is 0.
    pub const fn packed(self) -> [f32; 4] {
        match self {
            Self::All => [0.0; 4],
            Self::One(nm) => [nm, 0.0, 0.0, 0.0],
            Self::Four(nm) => nm,
        }
    }

    /// What [`Carried::packed`] packed.
    #[inline]
    pub fn unpacked(nm: [f32; 4]) -> Self {
        if nm[0] == 0.0 {
            Self::All
        } else if nm[1] == 0.0 {
            Self::One(nm[0])
        } else {
            Self::Four(nm)
        }
    }
}

/// Red, green, blue and a lane that is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rgb {
    /// The wavelength in nm that a refraction has drawn; 0 before.
    nm: f32,
}

impl Lanes for Rgb {
    const DRAWN: bool = false;

    #[inline(always)]
    fn drawn(_: &SpectralTables, _: f32) -> Self {
        Self { nm: 0.0 }
    }

    #[inline(always)]
    fn full(self) -> Light {
        Light::rgb([1.0; 3])
    }

    #[inline(always)]
    fn light(self, _: &SpectralTables, colour: &Colour) -> Light {
        colour.rgb
    }

    #[inline(always)]
    fn lights<F: Float>(_: &[Self], _: &SpectralTables, colour: &Colour) -> Light<F> {
        Light::uniform(colour.rgb)
    }

    #[inline(always)]
    fn radiances_of_rgb<F: Float>(_: &[Self], _: &SpectralTables, rgb: Light<F>) -> Light<F> {
        rgb
    }

    #[inline(always)]
    fn radiance_of_rgb(self, _: &SpectralTables, rgb: Light) -> Light {
        rgb
    }

    #[inline(always)]
    fn reflectance_of_rgb(self, _: &SpectralTables, rgb: Light) -> Light {
        rgb
    }

    #[inline(always)]
    fn coefficient_of_rgb(self, _: &SpectralTables, rgb: Light) -> Light {
        rgb
    }

    #[inline(always)]
    fn carried(self) -> Carried {
        if self.nm > 0.0 { Carried::One(self.nm) } else { Carried::All }
    }

    #[inline(always)]
    fn only(self, nm: f32) -> Self {
        Self { nm }
    }

    #[inline(always)]
    fn bins(self) -> Option<[u16; 4]> {
        None
    }
}

/// Four wavelengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelengths {
    /// By nanometre from 360.
    bins: [u16; 4],
    /// The first wavelength in nm, with its fraction.
    hero: f32,
    /// Whether only the first is alive.
    alone: bool,
}

impl Wavelengths {
    #[inline(always)]
    fn each(self, f: impl Fn(usize) -> f32) -> Light {
        Light(self.bins.map(|b| f(b as usize)))
    }
}

impl Lanes for Wavelengths {
    const DRAWN: bool = true;

    fn drawn(tables: &SpectralTables, u: f32) -> Self {
        let mut lanes = Self { bins: [0; 4], hero: FIRST as f32, alone: false };
        let Some(table) = &tables.draw else { return lanes };
        for (lane, bin) in lanes.bins.iter_mut().enumerate() {
            let turned = u + 0.25 * lane as f32;
            let choice = table.sample(if turned < 1.0 { turned } else { turned - 1.0 });
            *bin = choice.index as u16;
            if lane == 0 {
                lanes.hero = (FIRST + choice.index) as f32 + (choice.rest - 0.5);
            }
        }
        lanes
    }

    #[inline(always)]
    fn full(self) -> Light {
        Light::ONE
    }

    #[inline(always)]
    fn light(self, tables: &SpectralTables, colour: &Colour) -> Light {
        let table = &tables.spectra[colour.spectrum as usize];
        self.each(|b| table[b])
    }

    #[inline]
    fn radiance_of_rgb(self, tables: &SpectralTables, rgb: Light) -> Light {
        let Some(table) = tables.uplift else { return Light::default() };
        let rgb = rgb.to_rgb();
        if rgb.iter().any(|v| *v < 0.0) {
            let light = table.wide().light(rgb);
            return self.each(|b| light.at(b) * tables.white[b]);
        }
        let light = table.light(rgb);
        self.each(|b| light.at(b) * tables.white[b])
    }

    #[inline]
    fn reflectance_of_rgb(self, tables: &SpectralTables, rgb: Light) -> Light {
        let Some(table) = tables.uplift else { return Light::default() };
        let surface = table.reflectance(rgb.to_rgb());
        self.each(|b| surface.at(b))
    }

    #[inline]
    fn coefficient_of_rgb(self, tables: &SpectralTables, rgb: Light) -> Light {
        let [red, green, blue] = rgb.to_rgb();
        let parts = tables.parts.as_deref();
        self.each(|b| {
            let [r, g, b] = parts.and_then(|parts| parts.get(b)).copied().unwrap_or([1.0 / 3.0; 3]);
            r * red + g * green + b * blue
        })
    }

    #[inline]
    fn carried(self) -> Carried {
        if self.alone {
            return Carried::One(self.hero);
        }
        let mut nm = self.bins.map(|b| (FIRST + b as usize) as f32);
        nm[0] = self.hero;
        Carried::Four(nm)
    }

    #[inline]
    fn only(self, _: f32) -> Self {
        Self { alone: true, ..self }
    }

    #[inline(always)]
    fn bins(self) -> Option<[u16; 4]> {
        Some(self.bins)
    }
}
