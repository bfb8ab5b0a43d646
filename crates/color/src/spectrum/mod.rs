//! Measured spectra and what the eye makes of them.
//!
//! Wavelengths are in nanometres. What is computed of light is computed from 360 to 830 nm, where the CIE's observers
//! see anything, in steps of 1 nm (as CIE 15:2018 asks for): a [`Bins`] holds one number for each.
//!
//! A spectrum of light is in units in which 1 at all wavelengths has the luminance Y = 1, so that the numbers of RGB and of
//! spectra are of one size.

pub mod bands;
pub mod illuminant;
mod interpolation;
pub mod metal;
pub mod metamer;
pub mod observer;
pub mod refraction;
pub mod thermal;
pub mod uplift;

pub use bands::Bands;
pub use illuminant::Illuminant;
pub use interpolation::Interpolation;
pub use observer::Observer;

/// The shortest wavelength that is computed with.
pub const FIRST: usize = 360;

/// The longest wavelength that is computed with.
pub const LAST: usize = 830;

/// How many steps of 1 nm there are from the first to the last, both included.
pub const COUNT: usize = LAST - FIRST + 1;

/// A number for each nanometre from [`FIRST`] to [`LAST`].
pub type Bins = [f64; COUNT];

/// What the numbers of a spectrum are. It says what lies beyond the wavelengths of a table, and what can't lie between.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Light that a lamp sends, of which there is none beyond the table.
    Emission,
    /// The share of light that a surface sends back, from 0 to 1; it goes on beyond the table as it ended.
    Reflectance,
    /// A part of an index of refraction, which goes on as it ended.
    Index,
}

impl Quantity {
    /// The nearest value that can be.
    fn held(self, v: f64) -> f64 {
        match self {
            _ if v < 0.0 => 0.0,
            Self::Reflectance if v > 1.0 => 1.0,
            _ => v,
        }
    }
}

/// A spectrum as it was measured: values at rising wavelengths, and [`Interpolation`] between.
#[derive(Clone, Debug, PartialEq)]
pub struct TabulatedSpectrum {
    wavelengths: Vec<f64>,
    values: Vec<f64>,
    interpolation: Interpolation,
}

/// What is wrong with a table of wavelengths and values.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// There are no values.
    #[error("a spectrum needs at least one wavelength")]
    Empty,
    /// There are not as many values as wavelengths.
    #[error("{wavelengths} wavelengths but {values} values")]
    Lengths {
        /// How many wavelengths.
        wavelengths: usize,
        /// How many values.
        values: usize,
    },
    /// A wavelength or a value isn't a number.
    #[error("number {} of the spectrum is not finite", .0 + 1)]
    NotFinite(usize),
    /// A wavelength isn't greater than the one before.
    #[error("wavelengths must rise, but number {} is {now} nm after {before} nm", .index + 1)]
    Order {
        /// Which, from 0.
        index: usize,
        /// The wavelength.
        now: f64,
        /// The one before.
        before: f64,
    },
    /// A value is below 0.
    #[error("the value at {wavelength} nm is negative: {value}")]
    Negative {
        /// Which, from 0.
        index: usize,
        /// Its wavelength.
        wavelength: f64,
        /// The value.
        value: f64,
    },
    /// A wavelength is 0 or less, or far from all light.
    #[error("{0} nm is no wavelength of light: it must be from 1 to 1000000")]
    NoLight(f64),
    /// No wavelength is in the range that is computed with.
    #[error("the spectrum covers {first} to {last} nm, but what is seen lies from 360 to 830 nm")]
    Unseen {
        /// The first wavelength.
        first: f64,
        /// The last.
        last: f64,
    },
    /// A curve was asked for through wavelengths that are not in equal steps.
    #[error(
        "a smooth curve needs wavelengths in equal steps, but number {} is {step} nm after the one before, and the second is {first} \
         nm after the first", .index + 1
    )]
    Uneven {
        /// The first that is off, from 0.
        index: usize,
        /// Its distance from the one before.
        step: f64,
        /// The first step.
        first: f64,
    },
    /// A curve was asked for through fewer points than it takes.
    #[error("a smooth curve needs at least 4 wavelengths, and there are {0}")]
    Few(usize),
}

/// 1 at all wavelengths.
impl Default for TabulatedSpectrum {
    fn default() -> Self {
        Self { wavelengths: vec![1.0, 1e6], values: vec![1.0; 2], interpolation: Interpolation::Linear }
    }
}

impl TabulatedSpectrum {
    /// A spectrum of values, 0 or greater, at wavelengths that rise and overlap with what can be seen. What lies between is
    /// smooth if these are at least 4 in equal steps of at most 20 nm, and on straight lines else.
    pub fn new(wavelengths: Vec<f64>, values: Vec<f64>) -> Result<Self, Fault> {
        if wavelengths.len() != values.len() {
            return Err(Fault::Lengths { wavelengths: wavelengths.len(), values: values.len() });
        }
        let (Some(&first), Some(&last)) = (wavelengths.first(), wavelengths.last()) else {
            return Err(Fault::Empty);
        };
        for (index, (&wavelength, &value)) in wavelengths.iter().zip(&values).enumerate() {
            if !(wavelength.is_finite() && value.is_finite()) {
                return Err(Fault::NotFinite(index));
            }
            if !(1.0..=1e6).contains(&wavelength) {
                return Err(Fault::NoLight(wavelength));
            }
            if index > 0 && wavelength <= wavelengths[index - 1] {
                return Err(Fault::Order { index, now: wavelength, before: wavelengths[index - 1] });
            }
            if value < 0.0 {
                return Err(Fault::Negative { index, wavelength, value });
            }
        }
        if last < FIRST as f64 || first > LAST as f64 {
            return Err(Fault::Unseen { first, last });
        }
        let interpolation = interpolation::fitting(&wavelengths);
        Ok(Self { wavelengths, values, interpolation })
    }

    /// A spectrum of a number for each nanometre.
    pub fn of_bins(bins: &Bins) -> Self {
        let wavelengths = (FIRST..=LAST).map(|nm| nm as f64).collect();
        Self { wavelengths, values: bins.to_vec(), interpolation: Interpolation::Smooth }
    }

    /// The same table, joined in a way of one's choice; a smooth one must have at least 4 wavelengths in equal steps.
    pub fn interpolated(self, interpolation: Interpolation) -> Result<Self, Fault> {
        if interpolation == Interpolation::Smooth {
            let w = &self.wavelengths;
            if w.len() < interpolation::FEWEST {
                return Err(Fault::Few(w.len()));
            }
            if let Some(index) = interpolation::uneven(w) {
                // Rounded, since distances of decimal fractions are none.
                let step = |i: usize| ((w[i] - w[i - 1]) * 1e6).round() / 1e6;
                return Err(Fault::Uneven { index, step: step(index), first: step(1) });
            }
        }
        Ok(Self { interpolation, ..self })
    }

    /// Its wavelengths and values.
    pub fn points(&self) -> impl ExactSizeIterator<Item = (f64, f64)> {
        self.wavelengths.iter().copied().zip(self.values.iter().copied())
    }

    /// The largest value.
    pub fn peak(&self) -> f64 {
        self.values.iter().copied().fold(0.0, |a: f64, b| if b > a { b } else { a })
    }

    /// The same, each value times `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        Self { values: self.values.iter().map(|v| v * factor).collect(), ..self.clone() }
    }

    /// The value at a wavelength.
    pub fn at(&self, nm: f64, quantity: Quantity) -> f64 {
        let (w, v) = (&self.wavelengths, &self.values);
        let next = w.partition_point(|&x| x <= nm);
        if next == 0 || next == w.len() {
            let end = if next == 0 { 0 } else { next - 1 };
            let is_dark = quantity == Quantity::Emission && nm != w[end];
            return if is_dark { 0.0 } else { v[end] };
        }
        let t = (nm - w[next - 1]) / (w[next] - w[next - 1]);
        match self.interpolation {
            Interpolation::Linear => v[next - 1] + (v[next] - v[next - 1]) * t,
            Interpolation::Smooth => interpolation::smooth(v, next - 1, t, quantity),
        }
    }

    /// The value at each nanometre: what tables of the CIE are computed with.
    pub fn bins(&self, quantity: Quantity) -> Bins {
        std::array::from_fn(|i| self.at((FIRST + i) as f64, quantity))
    }

    /// The mean over each nanometre, half of one to either side, so that lines narrower than 1 nm keep their power.
    pub fn means(&self, quantity: Quantity) -> Bins {
        std::array::from_fn(|i| {
            let middle = (FIRST + i) as f64;
            self.integral(middle - 0.5, middle + 0.5, quantity)
        })
    }

    /// The first nanometre, with the value there, at which a surface of this reflectance would give back more light than
    /// falls on it, rounding aside.
    pub fn above_one(&self) -> Option<(usize, f64)> {
        let bins = self.means(Quantity::Reflectance);
        bins.iter().position(|v| *v > 1.0 + 1e-6).map(|i| (FIRST + i, bins[i]))
    }

    /// The integral over wavelengths from `from` to `to`.
    fn integral(&self, from: f64, to: f64, quantity: Quantity) -> f64 {
        // Gauss's rule of two points, exact for curves of third order. It leaves out the ends of a piece, as it must where
        // the table ends.
        const PLACE: f64 = 0.211_324_865_405_187_13;
        let mut sum = 0.0;
        let mut piece = |a: f64, b: f64| {
            if b > a {
                let inside = |share: f64| self.at(a + (b - a) * share, quantity);
                sum += (b - a) * 0.5 * (inside(PLACE) + inside(1.0 - PLACE));
            }
        };
        let first = self.wavelengths.partition_point(|&w| w <= from);
        let mut a = from;
        for &w in self.wavelengths[first..].iter().take_while(|&&w| w < to) {
            piece(a, w);
            a = w;
        }
        piece(a, to);
        sum
    }
}

/// Rows of numbers of a data file, without comments and empty lines; `-` stands for nothing.
fn rows(text: &'static str) -> impl Iterator<Item = Vec<Option<f64>>> {
    let lines = text.lines().filter(|l| !l.starts_with('#') && !l.trim().is_empty());
    lines.map(|l| l.split_whitespace().map(|word| word.parse().ok()).collect())
}

#[cfg(test)]
mod tests;
