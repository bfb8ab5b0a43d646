//! Smooth spectra for RGB colours.
//!
//! The reflectance of a colour is S(c0 t² + c1 t + c2) with S(x) = 1/2 + x / (2 sqrt(1 + x²)), which lies between 0 and 1
//! and has one gentle rise, fall, hill or valley (Jakob and Hanika 2019, "A Low-Dimensional Function Space for Efficient
//! Spectral Upsampling"). The three coefficients are found by Gauss-Newton steps so that the surface has the wanted linear
//! sRGB under D65. Greys are constant.

mod nodes;
mod table;
mod wide;

pub use table::{Lifted, UpliftTable};
pub use wide::{WideLight, WideTable};

use crate::{Adaptation, Matrix3, Space, White, Xyz};

use super::{Bins, COUNT, Observer, illuminant};

/// What turns a reflectance into linear sRGB under D65, and spectra of light into linear sRGB.
#[derive(Clone, Debug)]
pub struct Uplift {
    /// D65 of luminance 1.
    white: Bins,
    /// By nanometre: the linear sRGB that a reflectance of 1 there alone has under D65.
    weights: [[f64; 3]; COUNT],
}

/// The reflectance of a colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smooth {
    /// The same at all wavelengths.
    Grey(f64),
    /// S of this polynomial, highest power first, of t, which goes from 0 at 360 nm to 1 at 830 nm.
    Sigmoid([f64; 3]),
}

/// How far a linear channel may be off: a tenth of what 0.001 in sRGB is at its steepest.
const CLOSE: f64 = 8e-6;

impl Default for Uplift {
    fn default() -> Self {
        Self::new()
    }
}

/// From XYZ to linear RGB of a space, so that light of the tabulated D65 is R = G = B to the last digit: a space's own white
/// is told to four places only.
pub fn rgb_from_xyz(space: Space) -> Matrix3 {
    let white = Xyz::new(Observer::Cie1931.light(&illuminant::d65()));
    let white = white.chromaticity().unwrap_or(White::D65.chromaticity());
    space.rgb().from_xyz_under(white, Adaptation::Bradford)
}

impl Uplift {
    /// Prepares the tables.
    pub fn new() -> Self {
        let white = illuminant::d65();
        let matrix = rgb_from_xyz(Space::Srgb);
        let unit: f64 = Observer::Cie1931.functions().iter().map(|xyz| xyz[1]).sum();
        let functions = Observer::Cie1931.functions();
        let weights = std::array::from_fn(|i| matrix.apply(functions[i]).map(|v| v * white[i] / unit));
        Self { white, weights }
    }

    /// D65 of luminance 1: the spectrum of a light of RGB 1.
    pub fn white(&self) -> &Bins {
        &self.white
    }

    /// Linear sRGB of a surface under D65.
    pub fn rgb_of_reflectance(&self, reflectance: &Bins) -> [f64; 3] {
        let mut rgb = [0.0; 3];
        for (value, weight) in reflectance.iter().zip(&self.weights) {
            for c in 0..3 {
                rgb[c] += value * weight[c];
            }
        }
        rgb
    }

    /// Linear sRGB of light.
    pub fn rgb_of_light(&self, light: &Bins) -> [f64; 3] {
        let relative =
            std::array::from_fn(|i| if self.white[i] > 0.0 { light[i] / self.white[i] } else { 0.0 });
        self.rgb_of_reflectance(&relative)
    }

    /// The smooth reflectance of a colour in linear sRGB, each channel in [0, 1] (brought there otherwise).
    pub fn fit(&self, rgb: [f64; 3]) -> Smooth {
        let rgb = rgb.map(|v| if v > 0.0 { if v < 1.0 { v } else { 1.0 } } else { 0.0 });
        if rgb[0] == rgb[1] && rgb[1] == rgb[2] {
            return Smooth::Grey(rgb[0]);
        }
        let mut c = [0.0; 3];
        if self.refine(&mut c, rgb) {
            return Smooth::Sigmoid(c);
        }
        // From grey of the same lightness to the colour, a few steps on the way: each begins near its end.
        const STEPS: usize = 24;
        let mean = (rgb[0] + rgb[1] + rgb[2]) / 3.0;
        let mut c = [0.0; 3];
        for step in 1..=STEPS {
            let share = step as f64 / STEPS as f64;
            self.refine(&mut c, rgb.map(|v| mean + (v - mean) * share));
        }
        Smooth::Sigmoid(c)
    }

    /// The smooth reflectance of any colour in linear sRGB, also of one that sRGB doesn't hold but a wider space; `Err` with
    /// the nearest on the way to a grey where no smooth reflectance is so colourful or bright.
    pub fn reach(&self, rgb: [f64; 3]) -> Result<Smooth, Smooth> {
        if rgb.iter().all(|v| (0.0..=1.0).contains(v)) {
            return Ok(self.fit(rgb));
        }
        // From the grey that is as bright, within what a surface can be.
        let luminance: f64 = { Space::Srgb.rgb().luminance() }.iter().zip(rgb).map(|(w, v)| w * v).sum();
        let grey = if luminance > 0.02 { if luminance < 0.98 { luminance } else { 0.98 } } else { 0.02 };
        let at = |share: f64| rgb.map(|v| grey + (v - grey) * share);
        let mut c = [0.0; 3];
        let mut reached = 0.0;
        let mut step = 1.0 / 16.0;
        while reached < 1.0 {
            let share = if reached + step < 1.0 { reached + step } else { 1.0 };
            let mut next = c;
            if self.refine(&mut next, at(share)) {
                (c, reached) = (next, share);
            } else {
                step *= 0.5;
                if step < 1e-3 {
                    return Err(Smooth::Sigmoid(c));
                }
            }
        }
        Ok(Smooth::Sigmoid(c))
    }

    /// The smooth spectrum of light of a colour in linear sRGB: a surface lit by D65, about half as bright as its strongest
    /// channel, or darker where only a dark surface is so colourful; gives the surface and what it is multiplied by. `Err`
    /// with the nearest where light has no such colour.
    pub fn reach_light(&self, rgb: [f64; 3]) -> Result<(Smooth, f64), (Smooth, f64)> {
        let most = rgb.iter().copied().fold(0.0, |a: f64, b| if b > a { b } else { a });
        if most <= 0.0 {
            return Err((Smooth::Grey(0.0), 1.0));
        }
        if rgb[0] == rgb[1] && rgb[1] == rgb[2] {
            return Ok((Smooth::Grey(1.0), most));
        }
        let mut nearest = (Smooth::Grey(0.0), 1.0);
        for strongest in [0.5, 0.25, 0.1, 0.04, 0.016] {
            let scale = most / strongest;
            match self.reach(rgb.map(|v| v / scale)) {
                Ok(smooth) => return Ok((smooth, scale)),
                Err(smooth) => nearest = (smooth, scale),
            }
        }
        Err(nearest)
    }

    /// Gauss-Newton steps, damped after Levenberg and Marquardt; whether the colour was met.
    fn refine(&self, c: &mut [f64; 3], rgb: [f64; 3]) -> bool {
        let squares = |r: [f64; 3]| r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
        let (mut residual, mut jacobian) = self.difference(c, rgb);
        let mut damping = 1e-3;
        for _ in 0..100 {
            if residual.iter().all(|r| r.abs() < CLOSE) {
                return true;
            }
            let mut normal = [[0.0; 3]; 3];
            let mut gradient = [0.0; 3];
            for i in 0..3 {
                for j in 0..3 {
                    normal[i][j] = (0..3).map(|k| jacobian[k][i] * jacobian[k][j]).sum();
                }
                gradient[i] = (0..3).map(|k| jacobian[k][i] * residual[k]).sum();
            }
            for (i, row) in normal.iter_mut().enumerate() {
                row[i] *= 1.0 + damping;
            }
            let Some(Matrix3(inverse)) = Matrix3(normal).inverse() else { return false };
            let next: [f64; 3] =
                std::array::from_fn(|i| c[i] - (0..3).map(|j| inverse[i][j] * gradient[j]).sum::<f64>());
            let (new_residual, new_jacobian) = self.difference(&next, rgb);
            if squares(new_residual) < squares(residual) {
                (*c, residual, jacobian) = (next, new_residual, new_jacobian);
                damping *= 0.2;
            } else {
                damping *= 4.0;
                if damping > 1e12 {
                    return false;
                }
            }
        }
        false
    }

    /// How far the colour of the coefficients is from `rgb`, and its derivatives by them: [channel][coefficient].
    fn difference(&self, c: &[f64; 3], rgb: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
        let mut residual = rgb.map(|v| -v);
        let mut jacobian = [[0.0; 3]; 3];
        for (i, weight) in self.weights.iter().enumerate() {
            let t = place(i);
            let x = (c[0] * t + c[1]) * t + c[2];
            let root = (1.0 + x * x).sqrt();
            let value = 0.5 + 0.5 * x / root;
            let slope = 0.5 / (root * root * root);
            for k in 0..3 {
                residual[k] += weight[k] * value;
                let w = weight[k] * slope;
                jacobian[k][0] += w * t * t;
                jacobian[k][1] += w * t;
                jacobian[k][2] += w;
            }
        }
        (residual, jacobian)
    }
}

impl Smooth {
    /// The reflectance at each nanometre.
    pub fn bins(&self) -> Bins {
        match *self {
            Self::Grey(v) => [v; COUNT],
            Self::Sigmoid(c) => std::array::from_fn(|i| {
                let t = place(i);
                let x = (c[0] * t + c[1]) * t + c[2];
                0.5 + 0.5 * x / (1.0 + x * x).sqrt()
            }),
        }
    }
}

/// Where a nanometre is between the first and the last.
#[inline]
fn place(bin: usize) -> f64 {
    bin as f64 / (COUNT - 1) as f64
}

/// How red, green and blue of a space see wavelengths where they see them positively: each sums to 1. Their means turn
/// what isn't light, such as an index of refraction, into three numbers; and a wavelength drawn in proportion to their
/// sum has a colour that is white on average.
pub fn positive_parts(space: Space) -> [Bins; 3] {
    let matrix = rgb_from_xyz(space);
    let (functions, white) = (Observer::Cie1931.functions(), illuminant::d65());
    let mut parts = [[0.0; COUNT]; 3];
    for i in 0..COUNT {
        for (part, v) in parts.iter_mut().zip(matrix.apply(functions[i])) {
            part[i] = if v > 0.0 { v * white[i] } else { 0.0 };
        }
    }
    parts.map(|part| {
        let sum: f64 = part.iter().sum();
        part.map(|v| v / sum)
    })
}
