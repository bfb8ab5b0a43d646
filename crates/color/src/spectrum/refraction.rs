//! Indices of refraction by wavelength: glasses by formula, metals as they were measured.

use super::{Bins, TabulatedSpectrum};

/// The yellow line of helium, in nm, at which an index without further words is told (n_d).
pub const MIDDLE: f64 = 587.5618;

/// How the index of refraction of a clear medium depends on the wavelength.
#[derive(Clone, Debug, PartialEq)]
pub enum Index {
    /// Not at all.
    Constant(f64),
    /// n² = 1 + sum of B l² / (l² - C), with l in micrometres (Sellmeier 1871): the pairs [B, C], C in square micrometres.
    Sellmeier(Vec<[f64; 2]>),
    /// n = A + B / l² + C / l⁴ + ..., with l in micrometres (Cauchy 1836).
    Cauchy(Vec<f64>),
    /// Measured; beyond the table its ends go on.
    Measured(TabulatedSpectrum),
}

impl Index {
    /// The index at a wavelength in nanometres. It may be no number where a formula doesn't hold.
    pub fn at(&self, nm: f64) -> f64 {
        let l2 = nm * nm * 1e-6;
        match self {
            Self::Constant(n) => *n,
            Self::Sellmeier(terms) => {
                terms.iter().map(|[b, c]| b * l2 / (l2 - c)).fold(1.0, |sum, term| sum + term).sqrt()
            }
            Self::Cauchy(terms) => terms.iter().rev().fold(0.0, |n, term| n / l2 + term),
            Self::Measured(spectrum) => spectrum.at(nm, super::Quantity::Index),
        }
    }

    /// Abbe's number V = (n_d - 1) / (n_F - n_C), by the lines of helium at 587.56 and of hydrogen at 486.13 and 656.27
    /// nm: the smaller, the wider the rainbow. Infinite without dispersion.
    pub fn abbe_number(&self) -> f64 {
        (self.at(MIDDLE) - 1.0) / (self.at(486.1327) - self.at(656.2725))
    }
}

/// The text after `=` or at the start of lines, up to the colon: the names of a data file.
fn names_of(text: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    let lines = text.lines().filter(|l| !l.starts_with('#'));
    lines.filter_map(|l| l.split_once(':')).map(|(name, rest)| (name.trim_start_matches("= "), rest))
}

const GLASSES: &str = include_str!("../../data/glasses.txt");
const METALS: &str = include_str!("../../data/metals.txt");

/// A glass or another clear medium whose index of refraction is known; a vacuum by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Glass {
    name: &'static str,
    /// What the data file says of it.
    told: &'static str,
}

impl Glass {
    /// By its name, in capitals or not; `BK7` does for `N-BK7`.
    pub fn named(name: &str) -> Option<Self> {
        let alike = |known: &str| known.eq_ignore_ascii_case(name);
        let mut exact = Self::all().filter(|glass| alike(glass.name));
        let mut without_n = Self::all().filter(|glass| glass.name.strip_prefix("N-").is_some_and(alike));
        exact.next().or_else(|| without_n.next())
    }

    /// All that there are.
    pub fn all() -> impl Iterator<Item = Self> {
        names_of(GLASSES).map(|(name, told)| Self { name, told })
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        self.name
    }

    /// Its index of refraction.
    pub fn index(self) -> Index {
        let words = self.told.rsplit(';').next().unwrap_or_default().split_whitespace();
        let numbers: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
        Index::Sellmeier(numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect())
    }
}

/// Share of light that a metal reflects when looked at straight, by the parts of its index of refraction (Fresnel).
pub fn facing(eta: &Bins, k: &Bins) -> Bins {
    std::array::from_fn(|i| {
        let (n, k) = (eta[i], k[i] * k[i]);
        ((n - 1.0) * (n - 1.0) + k) / ((n + 1.0) * (n + 1.0) + k)
    })
}

/// A metal whose index of refraction was measured; by default one whose index is 1 + i.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Metal(&'static str);

impl Metal {
    /// By its English name, in capitals or not.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|metal| metal.0.eq_ignore_ascii_case(name))
    }

    /// All that there are.
    pub fn all() -> impl Iterator<Item = Self> {
        names_of(METALS).map(|(name, _)| Self(name))
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        self.0
    }

    /// The real and the imaginary part of its index of refraction.
    pub fn index(self) -> [TabulatedSpectrum; 2] {
        let is_here = |line: &str| line.strip_prefix("= ").is_some_and(|line| line.starts_with(self.0));
        let (mut wavelengths, mut n, mut k) = (Vec::new(), Vec::new(), Vec::new());
        for line in METALS.lines().skip_while(|l| !is_here(l)).skip(1).take_while(|l| !l.starts_with('=')) {
            let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            let [nm, real, imaginary] = numbers[..] else { continue };
            wavelengths.push(nm);
            n.push(real);
            k.push(imaginary);
        }
        // A test reads them all.
        [n, k].map(|part| TabulatedSpectrum::new(wavelengths.clone(), part).unwrap_or_default())
    }
}
