//! Measured spectra and what the eye makes of them.
//!
//! Wavelengths are in nanometres. What is computed of light is computed from 360 to 830 nm, where the CIE's observers
//! see anything, in steps of 1 nm (as CIE 15:2018 asks for): a [`Bins`] holds one number for each.
//!
//! A spectrum of light is in units in which 1 at all wavelengths has the luminance Y = 1, so that the numbers of RGB and of
//! spectra are of one size.

pub mod bands;
pub mod illuminant;
pub mod metamer;
pub mod observer;
pub mod refraction;
pub mod thermal;
pub mod uplift;

pub use bands::Bands;
pub use observer::Observer;

/// The shortest wavelength that is computed with.
pub const FIRST: usize = 360;

/// The longest wavelength that is computed with.
pub const LAST: usize = 830;

/// How many steps of 1 nm there are from the first to the last, both included.
pub const COUNT: usize = LAST - FIRST + 1;

/// A number for each nanometre from [`FIRST`] to [`LAST`].
pub type Bins = [f64; COUNT];

/// What a spectrum is beyond the wavelengths at which it was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// 0: what a lamp doesn't send.
    Zero,
    /// The first or last value: what a surface or a metal does is alike nearby.
    Same,
}

/// A spectrum as it was measured: values at rising wavelengths, with straight lines between.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    wavelengths: Vec<f64>,
    values: Vec<f64>,
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
}

impl Spectrum {
    /// A spectrum of values, 0 or greater, at wavelengths that rise and overlap with what can be seen.
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
        Ok(Self { wavelengths, values })
    }

    /// A spectrum of a number for each nanometre.
    pub fn of_bins(bins: &Bins) -> Self {
        Self { wavelengths: (FIRST..=LAST).map(|nm| nm as f64).collect(), values: bins.to_vec() }
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
        Self {
            wavelengths: self.wavelengths.clone(),
            values: self.values.iter().map(|v| v * factor).collect(),
        }
    }

    /// The value at a wavelength.
    pub fn at(&self, nm: f64, beyond: Beyond) -> f64 {
        let (w, v) = (&self.wavelengths, &self.values);
        let next = w.partition_point(|&x| x <= nm);
        match (next, beyond) {
            (0, Beyond::Same) => v[0],
            (0, Beyond::Zero) => 0.0,
            _ if next == w.len() => match beyond {
                Beyond::Same => v[next - 1],
                Beyond::Zero if nm == w[next - 1] => v[next - 1],
                Beyond::Zero => 0.0,
            },
            _ => {
                let share = (nm - w[next - 1]) / (w[next] - w[next - 1]);
                v[next - 1] + (v[next] - v[next - 1]) * share
            }
        }
    }

    /// The value at each nanometre: what tables of the CIE are computed with.
    pub fn bins(&self, beyond: Beyond) -> Bins {
        std::array::from_fn(|i| self.at((FIRST + i) as f64, beyond))
    }

    /// The mean over each nanometre, half of one to either side, so that lines narrower than 1 nm keep their power.
    pub fn means(&self, beyond: Beyond) -> Bins {
        std::array::from_fn(|i| {
            let middle = (FIRST + i) as f64;
            self.integral(middle - 0.5, middle + 0.5, beyond)
        })
    }

    /// The integral over wavelengths from `from` to `to`.
    fn integral(&self, from: f64, to: f64, beyond: Beyond) -> f64 {
        let mut sum = 0.0;
        let mut piece = |a: f64, b: f64| {
            if b > a {
                // The ends of what was measured belong to the inside: the middle tells on which side a piece is.
                let inside = self.at(0.5 * (a + b), beyond);
                sum += (b - a) * inside;
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

    /// Where the wavelengths are equally spaced, the same spectrum at each nanometre by curves of third order through four
    /// neighbours (second order in the first and last gap), as ASTM E2022-16 makes colours of tables; else straight lines.
    /// Beyond the table the ends go on.
    pub fn smooth(&self) -> Bins {
        let w = &self.wavelengths;
        let equal = w.len() >= 4 && {
            let step = w[1] - w[0];
            w.windows(2).all(|p| (p[1] - p[0] - step).abs() < 1e-6 * step)
        };
        if !equal {
            return self.bins(Beyond::Same);
        }
        std::array::from_fn(|i| {
            let nm = (FIRST + i) as f64;
            let next = w.partition_point(|&x| x <= nm);
            if next == 0 || next == w.len() {
                return self.at(nm, Beyond::Same);
            }
            let near = if next == 1 {
                0..3
            } else if next == w.len() - 1 {
                w.len() - 3..w.len()
            } else {
                next - 2..next + 2
            };
            let term = |a: usize| {
                let others = near.clone().filter(|&b| b != a);
                self.values[a] * others.map(|b| (nm - w[b]) / (w[a] - w[b])).product::<f64>()
            };
            near.clone().map(term).sum()
        })
    }
}

/// Rows of numbers of a data file, without comments and empty lines; `-` stands for nothing.
fn rows(text: &'static str) -> impl Iterator<Item = Vec<Option<f64>>> {
    let lines = text.lines().filter(|l| !l.starts_with('#') && !l.trim().is_empty());
    lines.map(|l| l.split_whitespace().map(|word| word.parse().ok()).collect())
}

#[cfg(test)]
mod tests;
