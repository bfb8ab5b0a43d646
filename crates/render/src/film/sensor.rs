//! What a film sees of light: from a path's four lanes to the numbers that are summed.

use straal_color::spectrum::{Bands, COUNT, Observer, uplift};
use straal_color::{Adaptation, Light, Matrix3, RgbSpace, Space};

use super::{BandSample, Recording};
use crate::lanes::{Lanes, SpectralTables};

/// The film's sensitivities.
#[derive(Clone, Debug, Default)]
pub struct Sensor {
    /// By nanometre: what one lane of 1 adds to R, G and B, or to X, Y and Z. Empty where lanes are RGB.
    response: Vec<[f32; 3]>,
    /// By nanometre: a band of the film, what one lane of 1 adds to it, and to the next. Empty where there are none.
    bands: Vec<(u16, [f32; 2])>,
    /// From the work space to what the film takes, where that is another and lanes are RGB.
    from_work: Option<Matrix3>,
    /// In which numbers the film takes light.
    recording: Recording,
}

impl Sensor {
    /// One that takes light of a work space in these numbers.
    pub fn new(recording: Recording, space: Space, tables: &SpectralTables) -> Self {
        let is_spectral = tables.is_spectral();
        let mut sensor = Self { recording, ..Self::default() };
        if is_spectral {
            let matrix = match recording {
                Recording::Xyz => Matrix3::IDENTITY,
                Recording::Rgb | Recording::Spectral(_) => uplift::rgb_from_xyz(space),
            };
            sensor.response = response(&matrix, tables);
        } else if recording == Recording::Xyz {
            sensor.from_work = Some(space.rgb().to(&RgbSpace::XYZ, Adaptation::Bradford));
        }
        if let Recording::Spectral(bands) = recording {
            let weighed = |i: usize| {
                let (first, shares) = bands.shares(i);
                let weight = |share: f64| (share / (4.0 * bands.width() * tables.probability(i))) as f32;
                (first as u16, shares.map(weight))
            };
            sensor.bands = (0..COUNT).map(weighed).collect();
        }
        sensor
    }

    /// In which numbers the film takes light.
    pub fn recording(&self) -> Recording {
        self.recording
    }

    /// Whether it takes red, green and blue as paths carry them.
    pub fn takes_as_is(&self) -> bool {
        self.response.is_empty() && self.from_work.is_none()
    }

    /// The first of the three bands of a group of lights, which come after those of wavelengths.
    pub fn first_band_of_group(&self, group: u16) -> usize {
        self.recording.bands().map_or(0, Bands::count) + 3 * usize::from(group)
    }

    /// Light as the film takes it: in the work space, or as X, Y and Z.
    #[inline(always)]
    pub fn take<L: Lanes>(&self, lanes: L, light: Light) -> [f32; 3] {
        let Some(bins) = lanes.bins() else {
            return match &self.from_work {
                None => light.to_rgb(),
                Some(matrix) => matrix.apply_f32(light.to_rgb()),
            };
        };
        let mut sum = [0.0; 3];
        for (&bin, v) in bins.iter().zip(light.0) {
            let weight = &self.response[bin as usize];
            for c in 0..3 {
                sum[c] += weight[c] * v;
            }
        }
        sum
    }

    /// What light adds to the film's bands of wavelengths, if it has any.
    #[inline(always)]
    pub fn bands<L: Lanes>(&self, lanes: L, light: Light, out: &mut Vec<BandSample>) {
        let Some(bins) = lanes.bins().filter(|_| !self.bands.is_empty()) else { return };
        for (&bin, v) in bins.iter().zip(light.0) {
            let (first, weights) = self.bands[bin as usize];
            let samples = [(first, weights[0]), (first + 1, weights[1])];
            let seen = samples.into_iter().filter(|(_, weight)| *weight > 0.0);
            out.extend(seen.map(|(band, weight)| BandSample { band, value: weight * v }));
        }
    }
}

/// By nanometre: what one lane of 1 adds to a matrix times X, Y and Z.
fn response(matrix: &Matrix3, tables: &SpectralTables) -> Vec<[f32; 3]> {
    let functions = Observer::Cie1931.functions();
    let unit: f64 = functions.iter().map(|xyz| xyz[1]).sum();
    let of = |i: usize| matrix.apply(functions[i]).map(|v| (v / (4.0 * unit * tables.probability(i))) as f32);
    (0..COUNT).map(of).collect()
}
