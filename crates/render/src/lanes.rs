//! What the four lanes of light are: red, green and blue, or four wavelengths.
//!
//! Transport never asks. [`Lanes`] is what a path carries to read the scene's colours by and what the film takes its light
//! by; the driver is compiled for each kind, so that RGB pays nothing for wavelengths.
//!
//! Wavelengths are drawn with hero wavelength sampling (Wilkie et al. 2014): the first by chance, the other three a quarter
//! of the way round each, in steps of probability. A path's directions are drawn alike for all four, or only the first goes
//! on, so that the balance heuristic gives each a quarter. Spectra are constant within each nanometre.

use std::fmt;

use straal_color::spectrum::{COUNT, FIRST, Observer, Quantity, Spectrum, illuminant, refraction, uplift};
use straal_color::{Adaptation, Light, Matrix3, RgbSpace, Space};
use straal_math::{ops, table::Table1};

use crate::film::{BandSample, Recording};
use crate::texture::Texture;

/// A colour of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    /// In the work space.
    pub rgb: Light,
    /// The strongest lane: 0 where it is black at all wavelengths.
    pub strength: f32,
    /// Its table in the [`Palette`]; unused in RGB.
    pub(crate) spectrum: u32,
}

impl Colour {
    /// Whether it is black at all wavelengths.
    #[inline]
    pub fn is_black(&self) -> bool {
        self.strength == 0.0
    }
}

/// A colour in RGB alone.
impl From<Light> for Colour {
    fn from(rgb: Light) -> Self {
        Self { rgb, strength: rgb.max_lane(), spectrum: 0 }
    }
}

/// By what a path reads colours.
pub trait Lanes: Copy + fmt::Debug + Send + Sync + 'static {
    /// Whether a number is drawn at the camera.
    const DRAWN: bool;

    /// At the camera, by a number in [0, 1).
    fn drawn(palette: &Palette, u: f32) -> Self;

    /// Throughput at the camera: 1 in the lanes that carry light.
    fn full(self) -> Light;

    /// A colour of the scene.
    fn light(self, palette: &Palette, colour: &Colour) -> Light;

    /// Light of linear RGB, lit as D65 is where lanes are wavelengths; there channels below 0 are of colours that sRGB doesn't hold.
    fn radiance_of_rgb(self, palette: &Palette, rgb: Light) -> Light;

    /// Reflectance of linear RGB.
    fn reflectance_of_rgb(self, palette: &Palette, rgb: Light) -> Light;

    /// Which wavelengths they are.
    fn hue(self) -> Hue;

    /// What goes on when a refraction has parted the lanes: this wavelength, in the first lane where lanes are wavelengths.
    fn only(self, nm: f32) -> Self;

    /// Light as the film takes it: in the work space, or as X, Y and Z.
    fn film(self, palette: &Palette, light: Light) -> [f32; 3];

    /// What light adds to the film's bands of wavelengths, if it has any.
    fn bands(self, palette: &Palette, light: Light, out: &mut Vec<BandSample>);
}

/// Wavelengths, as a medium with dispersion must know them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hue {
    /// Not told apart: red, green and blue.
    All,
    /// A single wavelength in nm, in all lanes that are alive.
    One(f32),
    /// Four wavelengths in nm.
    Four([f32; 4]),
}

impl Hue {
    /// In four numbers, of which none is a wavelength where it is 0.
    pub const fn packed(self) -> [f32; 4] {
        match self {
            Self::All => [0.0; 4],
            Self::One(nm) => [nm, 0.0, 0.0, 0.0],
            Self::Four(nm) => nm,
        }
    }

    /// What [`Hue::packed`] packed.
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
    fn drawn(_: &Palette, _: f32) -> Self {
        Self { nm: 0.0 }
    }

    #[inline(always)]
    fn full(self) -> Light {
        Light::rgb([1.0; 3])
    }

    #[inline(always)]
    fn light(self, _: &Palette, colour: &Colour) -> Light {
        colour.rgb
    }

    #[inline(always)]
    fn radiance_of_rgb(self, _: &Palette, rgb: Light) -> Light {
        rgb
    }

    #[inline(always)]
    fn reflectance_of_rgb(self, _: &Palette, rgb: Light) -> Light {
        rgb
    }

    #[inline(always)]
    fn hue(self) -> Hue {
        if self.nm > 0.0 { Hue::One(self.nm) } else { Hue::All }
    }

    #[inline(always)]
    fn only(self, nm: f32) -> Self {
        Self { nm }
    }

    #[inline(always)]
    fn film(self, palette: &Palette, light: Light) -> [f32; 3] {
        match &palette.to_film {
            None => light.to_rgb(),
            Some(matrix) => matrix.apply_f32(light.to_rgb()),
        }
    }

    #[inline(always)]
    fn bands(self, _: &Palette, _: Light, _: &mut Vec<BandSample>) {}
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

    fn drawn(palette: &Palette, u: f32) -> Self {
        let mut lanes = Self { bins: [0; 4], hero: FIRST as f32, alone: false };
        let Some(table) = &palette.draw else { return lanes };
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
    fn light(self, palette: &Palette, colour: &Colour) -> Light {
        let table = &palette.spectra[colour.spectrum as usize];
        self.each(|b| table[b])
    }

    #[inline]
    fn radiance_of_rgb(self, palette: &Palette, rgb: Light) -> Light {
        let Some(table) = palette.uplift else { return Light::default() };
        let rgb = rgb.to_rgb();
        if rgb.iter().any(|v| *v < 0.0) {
            let light = table.wide().light(rgb);
            return self.each(|b| light.at(b) * palette.white[b]);
        }
        let light = table.light(rgb);
        self.each(|b| light.at(b) * palette.white[b])
    }

    #[inline]
    fn reflectance_of_rgb(self, palette: &Palette, rgb: Light) -> Light {
        let Some(table) = palette.uplift else { return Light::default() };
        let surface = table.reflectance(rgb.to_rgb());
        self.each(|b| surface.at(b))
    }

    #[inline]
    fn hue(self) -> Hue {
        if self.alone {
            return Hue::One(self.hero);
        }
        let mut nm = self.bins.map(|b| (FIRST + b as usize) as f32);
        nm[0] = self.hero;
        Hue::Four(nm)
    }

    #[inline]
    fn only(self, _: f32) -> Self {
        Self { alone: true, ..self }
    }

    #[inline]
    fn film(self, palette: &Palette, light: Light) -> [f32; 3] {
        let mut rgb = [0.0; 3];
        for (&bin, v) in self.bins.iter().zip(light.0) {
            let weight = &palette.film[bin as usize];
            for c in 0..3 {
                rgb[c] += weight[c] * v;
            }
        }
        rgb
    }

    #[inline]
    fn bands(self, palette: &Palette, light: Light, out: &mut Vec<BandSample>) {
        if palette.bands.is_empty() {
            return;
        }
        for (&bin, v) in self.bins.iter().zip(light.0) {
            let (first, weights) = palette.bands[bin as usize];
            let samples = [(first, weights[0]), (first + 1, weights[1])];
            let seen = samples.into_iter().filter(|(_, weight)| *weight > 0.0);
            out.extend(seen.map(|(band, weight)| BandSample { band, value: weight * v }));
        }
    }
}

/// Lanes and the tables they read by.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'w, L> {
    /// The tables.
    pub palette: &'w Palette,
    /// The lanes.
    pub lanes: L,
    /// What values that differ from point to point are read off.
    pub textures: &'w [Texture],
}

impl<L: Lanes> Reading<'_, L> {
    /// A colour of the scene.
    #[inline(always)]
    pub fn light(&self, colour: &Colour) -> Light {
        self.lanes.light(self.palette, colour)
    }

    /// A pixel of a picture of radiance.
    #[inline(always)]
    pub fn radiance_of_rgb(&self, rgb: Light) -> Light {
        self.lanes.radiance_of_rgb(self.palette, rgb)
    }

    /// Shares of light of linear sRGB. What the work space doesn't hold is cut off.
    pub fn reflectance_of_srgb(&self, rgb: [f32; 3]) -> Light {
        self.lanes.reflectance_of_rgb(self.palette, self.edge(rgb))
    }

    /// Light of linear sRGB. What the work space doesn't hold is cut off.
    pub fn emission_of_srgb(&self, rgb: [f32; 3]) -> Light {
        self.lanes.radiance_of_rgb(self.palette, self.edge(rgb))
    }

    /// In the work space where lanes are its red, green and blue; as it is where it becomes a spectrum.
    fn edge(&self, rgb: [f32; 3]) -> Light {
        let Some(to_work) = &self.palette.to_work else { return Light::rgb(rgb) };
        Light::rgb(to_work.apply_f32(rgb).map(|v| if v > 0.0 { v } else { 0.0 }))
    }
}

/// What a material of the library's user reads its colours by.
pub trait ReadRgb {
    /// The reflectance of linear sRGB, from 0 to 1, as light.
    fn reflectance(&self, rgb: [f32; 3]) -> Light;
}

impl<L: Lanes> ReadRgb for Reading<'_, L> {
    fn reflectance(&self, rgb: [f32; 3]) -> Light {
        self.reflectance_of_srgb(rgb)
    }
}

/// The spectra of a world's colours, and the tables by which wavelengths are drawn and seen. Empty in RGB, but for what
/// glass with dispersion needs.
#[derive(Clone, Debug, Default)]
pub struct Palette {
    /// By [`Colour::spectrum`].
    spectra: Vec<[f32; COUNT]>,
    /// Chooses a wavelength.
    draw: Option<Table1>,
    /// By nanometre: what one lane of 1 adds to R, G and B, or to X, Y and Z.
    film: Vec<[f32; 3]>,
    /// By nanometre: a band of the film, what one lane of 1 adds to it, and to the next. Empty where there are none.
    bands: Vec<(u16, [f32; 2])>,
    /// From the work space to what the film takes, where that is another and lanes are RGB.
    to_film: Option<Matrix3>,
    /// In which numbers the film takes light.
    recording: Recording,
    /// From linear sRGB to the work space, where that is another and lanes are RGB.
    to_work: Option<Matrix3>,
    /// D65.
    white: Vec<f32>,
    /// Spectra of pixels.
    uplift: Option<&'static uplift::UpliftTable>,
    rainbow: Option<Rainbow>,
}

/// Wavelengths for RGB: drawn in proportion to how strongly red, green and blue see them.
#[derive(Clone, Debug)]
struct Rainbow {
    draw: Table1,
    /// By nanometre, white on average.
    weights: Vec<[f32; 3]>,
}

impl Palette {
    /// Tables for rendering by wavelengths, for a film of this space.
    ///
    /// Wavelengths are drawn half by 1 / cosh²(0.0072 (l - 538 nm)) (Radziszewski et al. 2009) and half by the root of the
    /// sum of the squares of linear sRGB's sensitivities under D65: the first alone leaves blue noisy.
    pub(crate) fn spectral(space: Space) -> Self {
        let white = illuminant::d65();
        let functions = Observer::Cie1931.functions();
        let srgb = uplift::rgb_from_xyz(Space::Srgb);
        let bell = |i: usize| {
            let x = 0.0072 * ((FIRST + i) as f64 - 538.0);
            let twice = ops::exp_d(x) + ops::exp_d(-x);
            4.0 / (twice * twice)
        };
        let seen = |i: usize| {
            let squares: f64 = srgb.apply(functions[i]).iter().map(|v| v * v).sum();
            squares.sqrt() * white[i]
        };
        let total = |f: &dyn Fn(usize) -> f64| (0..COUNT).map(f).sum::<f64>();
        let (bells, all_seen) = (total(&bell), total(&seen));
        let weights: Vec<f32> = (0..COUNT).map(|i| (bell(i) / bells + seen(i) / all_seen) as f32).collect();
        let draw = Table1::new(&weights);
        let mut palette = Self {
            spectra: vec![[0.0; COUNT]],
            draw,
            white: white.iter().map(|&v| v as f32).collect(),
            uplift: Some(uplift::UpliftTable::embedded()),
            ..Self::default()
        };
        palette.film = palette.response(&uplift::rgb_from_xyz(space));
        palette
    }

    /// Tables for rendering in RGB: nothing but the way from linear sRGB to the work space, where that is another.
    pub(crate) fn in_rgb(to_work: Option<Matrix3>) -> Self {
        Self { to_work, ..Self::default() }
    }

    /// By nanometre: what one lane of 1 adds to a matrix times X, Y and Z.
    fn response(&self, matrix: &Matrix3) -> Vec<[f32; 3]> {
        let functions = Observer::Cie1931.functions();
        let unit: f64 = functions.iter().map(|xyz| xyz[1]).sum();
        let of =
            |i: usize| matrix.apply(functions[i]).map(|v| (v / (4.0 * unit * self.probability(i))) as f32);
        (0..COUNT).map(of).collect()
    }

    /// Of a nanometre to be drawn.
    fn probability(&self, nanometre: usize) -> f64 {
        self.draw.as_ref().map_or(1.0, |t| f64::from(t.pmf(nanometre)))
    }

    /// Says in which numbers the film takes light of a work space.
    pub(crate) fn record(&mut self, recording: Recording, space: Space) {
        self.recording = recording;
        match recording {
            Recording::Rgb => {}
            Recording::Xyz if self.is_spectral() => self.film = self.response(&Matrix3::IDENTITY),
            Recording::Xyz => self.to_film = Some(space.rgb().to(&RgbSpace::XYZ, Adaptation::Bradford)),
            Recording::Spectral(bands) => {
                let weighed = |i: usize| {
                    let (first, shares) = bands.shares(i);
                    let weight = |share: f64| (share / (4.0 * bands.width() * self.probability(i))) as f32;
                    (first as u16, shares.map(weight))
                };
                self.bands = (0..COUNT).map(weighed).collect();
            }
        }
    }

    /// In which numbers the film takes light.
    pub fn recording(&self) -> Recording {
        self.recording
    }

    /// Whether lanes are wavelengths.
    pub fn is_spectral(&self) -> bool {
        self.draw.is_some()
    }

    /// The linear sRGB of the spectrum that a pixel of radiance gets, where lanes are wavelengths.
    pub(crate) fn colour_of_pixel(&self, rgb: [f32; 3]) -> Option<[f64; 3]> {
        let table = self.uplift?;
        let mut bins = [0.0; COUNT];
        if rgb.iter().any(|v| *v < 0.0) {
            let light = table.wide().light(rgb);
            bins.iter_mut().enumerate().for_each(|(b, v)| *v = f64::from(light.at(b) * self.white[b]));
        } else {
            let light = table.light(rgb);
            bins.iter_mut().enumerate().for_each(|(b, v)| *v = f64::from(light.at(b) * self.white[b]));
        }
        Some(uplift::rgb_from_xyz(Space::Srgb).apply(Observer::Cie1931.light(&bins)))
    }

    /// Adds a table.
    pub(crate) fn add(&mut self, table: [f32; COUNT]) -> u32 {
        self.spectra.push(table);
        (self.spectra.len() - 1) as u32
    }

    /// Adds a table that is another times a factor.
    pub(crate) fn add_scaled(&mut self, of: u32, by: f32) -> u32 {
        self.add(self.spectra[of as usize].map(|v| v * by))
    }

    /// Makes ready for dispersion in RGB.
    pub(crate) fn see_rainbows(&mut self, space: Space) {
        let parts = uplift::positive_parts(space);
        let sums: Vec<f32> = (0..COUNT).map(|i| parts.iter().map(|p| p[i]).sum::<f64>() as f32).collect();
        self.rainbow = Table1::new(&sums).map(|draw| {
            let weight = |i: usize, part: &[f64; COUNT]| {
                let p = draw.pmf(i);
                if p > 0.0 { (part[i] / f64::from(p)) as f32 } else { 0.0 }
            };
            let weights = (0..COUNT).map(|i| parts.each_ref().map(|part| weight(i, part))).collect();
            Rainbow { draw, weights }
        });
    }

    /// A wavelength in nm by a number in [0, 1), and the RGB by which its light is weighed: white on average.
    pub(crate) fn draw_hue(&self, u: f32) -> (f32, Light) {
        let Some(rainbow) = &self.rainbow else { return (refraction::MIDDLE as f32, Light::rgb([1.0; 3])) };
        let choice = rainbow.draw.sample(u);
        let nm = (FIRST + choice.index) as f32 + (choice.rest - 0.5);
        (nm, Light::rgb(rainbow.weights[choice.index]))
    }
}

/// A relative index of refraction, each nanometre.
#[derive(Clone, Debug, PartialEq)]
pub struct EtaTable {
    by_nm: Vec<f32>,
    /// Of yellow light, 587.56 nm.
    pub middle: f32,
}

impl EtaTable {
    /// The index inside over that outside.
    pub fn new(inside: &refraction::Index, outside: &refraction::Index) -> Self {
        let at = |nm: f64| (inside.at(nm) / outside.at(nm)) as f32;
        Self { by_nm: (0..COUNT).map(|i| at((FIRST + i) as f64)).collect(), middle: at(refraction::MIDDLE) }
    }

    /// Whether it differs by wavelength.
    pub fn disperses(&self) -> bool {
        self.by_nm.iter().any(|&n| n != self.middle)
    }

    /// At a wavelength in nm.
    #[inline]
    pub fn at(&self, nm: f32) -> f32 {
        let place = ops::clamp(nm - FIRST as f32, 0.0, (COUNT - 1) as f32);
        let i = (place as usize).min(COUNT - 2);
        let (a, b) = (self.by_nm[i], self.by_nm[i + 1]);
        a + (b - a) * (place - i as f32)
    }
}

/// The mean over each nanometre in single precision.
pub(crate) fn table_of(spectrum: &Spectrum, quantity: Quantity) -> [f32; COUNT] {
    spectrum.means(quantity).map(|v| v as f32)
}
