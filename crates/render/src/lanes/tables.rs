//! Spectra of a world's colours, and the tables by which wavelengths are drawn.

use straal_color::spectrum::{
    COUNT, FIRST, Observer, Quantity, TabulatedSpectrum, illuminant, refraction, uplift,
};
use straal_color::{Light, Matrix3, Space};
use straal_math::{ops, table::Table1};

/// A colour of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Colour {
    /// In the work space.
    pub rgb: Light,
    /// The strongest lane: 0 where it is black at all wavelengths.
    pub strength: f32,
    /// Its table in the [`SpectralTables`]; unused in RGB.
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

/// The spectra of a world's colours, and the tables by which wavelengths are drawn and seen. Empty in RGB, but for what
/// glass with dispersion needs.
#[derive(Clone, Debug, Default)]
pub struct SpectralTables {
    /// By [`Colour::spectrum`].
    pub(super) spectra: Vec<[f32; COUNT]>,
    /// Chooses a wavelength.
    pub(super) draw: Option<Table1>,
    /// From linear sRGB to the work space, where that is another and lanes are RGB.
    to_work: Option<Matrix3>,
    /// D65.
    pub(super) white: Vec<f32>,
    /// Spectra of pixels.
    pub(super) uplift: Option<&'static uplift::UpliftTable>,
    /// By nanometre, how much red, green and blue count there, where a picture has numbers that are no colours.
    pub(super) parts: Option<Vec<[f32; 3]>>,
    dispersion: Option<Dispersion>,
}

/// Wavelengths for RGB: drawn in proportion to how strongly red, green and blue see them.
#[derive(Clone, Debug)]
struct Dispersion {
    draw: Table1,
    /// By nanometre, white on average.
    weights: Vec<[f32; 3]>,
}

impl SpectralTables {
    /// Tables for rendering by wavelengths.
    ///
    /// Wavelengths are drawn half by 1 / cosh²(0.0072 (l - 538 nm)) (Radziszewski et al. 2009) and half by the root of the
    /// sum of the squares of linear sRGB's sensitivities under D65: the first alone leaves blue noisy.
    pub(crate) fn spectral() -> Self {
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
        Self {
            spectra: vec![[0.0; COUNT]],
            draw,
            white: white.iter().map(|&v| v as f32).collect(),
            uplift: Some(uplift::UpliftTable::embedded()),
            ..Self::default()
        }
    }

    /// Tables for rendering in RGB: nothing but the way from linear sRGB to the work space, where that is another.
    pub(crate) fn in_rgb(to_work: Option<Matrix3>) -> Self {
        Self { to_work, ..Self::default() }
    }

    /// Linear sRGB in the work space, where lanes are its red, green and blue; as it is where it becomes a spectrum.
    pub(crate) fn held(&self, rgb: [f32; 3]) -> Light {
        let Some(to_work) = &self.to_work else { return Light::rgb(rgb) };
        Light::rgb(to_work.apply_f32(rgb).map(|v| if v > 0.0 { v } else { 0.0 }))
    }

    /// Of a nanometre to be drawn.
    pub(crate) fn probability(&self, nanometre: usize) -> f64 {
        self.draw.as_ref().map_or(1.0, |t| f64::from(t.pmf(nanometre)))
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

    /// Makes ready for pictures whose numbers are no colours, by how much red, green and blue count at each nanometre.
    pub(crate) fn prepare_coefficients(&mut self, parts: impl FnOnce() -> Vec<[f32; 3]>) {
        self.parts.get_or_insert_with(parts);
    }

    /// Makes ready for dispersion in RGB.
    pub(crate) fn prepare_dispersion(&mut self, space: Space) {
        let parts = uplift::positive_parts(space);
        let sums: Vec<f32> = (0..COUNT).map(|i| parts.iter().map(|p| p[i]).sum::<f64>() as f32).collect();
        self.dispersion = Table1::new(&sums).map(|draw| {
            let weight = |i: usize, part: &[f64; COUNT]| {
                let p = draw.pmf(i);
                if p > 0.0 { (part[i] / f64::from(p)) as f32 } else { 0.0 }
            };
            let weights = (0..COUNT).map(|i| parts.each_ref().map(|part| weight(i, part))).collect();
            Dispersion { draw, weights }
        });
    }

    /// A wavelength in nm by a number in [0, 1), and the RGB by which its light is weighed: white on average.
    pub(crate) fn draw_wavelength(&self, u: f32) -> (f32, Light) {
        let Some(dispersion) = &self.dispersion else {
            return (refraction::MIDDLE as f32, Light::rgb([1.0; 3]));
        };
        let choice = dispersion.draw.sample(u);
        let nm = (FIRST + choice.index) as f32 + (choice.rest - 0.5);
        (nm, Light::rgb(dispersion.weights[choice.index]))
    }
}

/// A relative index of refraction.
#[derive(Clone, Debug, PartialEq)]
pub enum Eta {
    /// The same at all wavelengths.
    Constant(f32),
    /// One for each wavelength.
    Table(EtaTable),
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
pub(crate) fn table_of(spectrum: &TabulatedSpectrum, quantity: Quantity) -> [f32; COUNT] {
    spectrum.means(quantity).map(|v| v as f32)
}
