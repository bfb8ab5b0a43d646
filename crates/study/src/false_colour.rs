//! Numbers as pictures: a colour for each, and a legend that says which.

use std::io;
use std::path::Path;
use straal_color::heat;
use straal_formats::atomic::{self, WriteError};
use straal_formats::image::png;
use straal_math::ops;

/// Why a chart wasn't written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// No costs were counted, or not this one.
    #[error("the picture doesn't know its {0} cost: it wasn't counted")]
    NotCounted(&'static str),
    /// The name must end in .png.
    #[error("can't write {0}: pictures in false colours are PNG, so that the name must end in .png")]
    NotPng(String),
    /// The disk refused.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// How numbers become colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// From 0 to `most`, evenly.
    Linear {
        /// The number that gets the last colour, as does all beyond it.
        most: f32,
    },
    /// From `least` to `most` by their logarithm, so that each factor is an equal step.
    Logarithmic {
        /// The number that gets the first colour, as does all below it; above 0.
        least: f32,
        /// The number that gets the last colour, as does all beyond it; above `least`.
        most: f32,
    },
}

impl Scale {
    /// Linear, up to the number that all but one in two hundred stay within: a few pixels can be so far beyond the others
    /// that nothing else would be seen.
    pub fn of(values: &[f32]) -> Self {
        let mut sorted: Vec<f32> = values.iter().copied().filter(|v| v.is_finite()).collect();
        sorted.sort_unstable_by(f32::total_cmp);
        let most = sorted.len().checked_sub(1).map_or(0.0, |last| sorted[last - last / 200]);
        Self::Linear { most: if most > 0.0 { most } else { 1.0 } }
    }

    /// Logarithmic, holding all numbers of 1 and more, from the power of ten below the least of them.
    pub fn of_magnitudes<'a>(values: impl IntoIterator<Item = &'a f32>) -> Self {
        let (mut least, mut most) = (f32::INFINITY, 1.0);
        for &v in values.into_iter().filter(|v| v.is_finite() && **v >= 1.0) {
            least = ops::min(least, v);
            most = ops::max(most, v);
        }
        let tens = if least.is_finite() { ops::log10(least * 1.0001).floor() as i32 } else { 0 };
        let least = ops::powi(10.0, tens);
        Self::Logarithmic { least, most: ops::max(most, least * 10.0) }
    }

    /// Where a number lies on the way from the first colour to the last.
    fn place(self, v: f32) -> f32 {
        match self {
            Self::Linear { most } => v / most,
            Self::Logarithmic { least, most } => {
                ops::log2(ops::max(v, least) / least) / ops::log2(most / least)
            }
        }
    }

    /// Numbers worth a mark: a step of 1, 2 or 5 times a power of ten that gives at most six, or the powers of ten (every
    /// so many of them). The last colour's own number is left to the legend.
    fn marks(self) -> Vec<f32> {
        match self {
            Self::Linear { most } => {
                let tens = ops::powi(10.0, ops::log10(most / 5.0).floor() as i32);
                let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * tens).find(|s| most / s <= 6.0);
                let step = step.unwrap_or(most);
                (0..=6).map(|i| i as f32 * step).take_while(|v| *v <= most).collect()
            }
            Self::Logarithmic { least, most } => {
                let (first, last) =
                    (ops::log10(least).ceil() as i32, ops::log10(most * 1.0001).floor() as i32);
                let stride = (last - first) / 6 + 1;
                (first..=last).step_by(stride as usize).map(|e| ops::powi(10.0, e)).collect()
            }
        }
    }
}

/// A picture for the screen: sRGB in eight bits, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chart {
    /// In pixels.
    pub width: usize,
    /// In pixels.
    pub height: usize,
    /// `width * height` of them.
    pub pixels: Vec<[u8; 3]>,
}

const INK: [u8; 3] = [32, 32, 32];
const PAPER: [u8; 3] = [255, 255, 255];

impl Chart {
    /// One pixel for each number. `width` divides their number.
    pub fn of(values: &[f32], width: usize, scale: Scale) -> Self {
        let pixels = values.iter().map(|&v| heat::srgb_u8(scale.place(v))).collect();
        Self { width, height: values.len() / if width > 0 { width } else { 1 }, pixels }
    }

    /// The legend alone: all colours from left to right, and what numbers they stand for. Wide enough for the
    /// caption, and 120 pixels at the least.
    pub fn legend(width: usize, scale: Scale, caption: &str) -> Self {
        // Two lines of text; letters are twice as large in large pictures.
        let needs = |zoom: usize| (font::width(caption) + 2 * 4) * zoom;
        let zoom = if width >= 480 && width >= needs(2) { 2 } else { 1 };
        let width = [120, needs(1)].into_iter().fold(width, Ord::max);
        let line = (font::HEIGHT + 3) * zoom;
        let (margin, ramp) = (4 * zoom, 10 * zoom);
        let mut chart = Self::blank(width, 2 * margin + ramp + 2 * zoom + 2 * line);
        let inner = width - 2 * margin;
        for x in 0..inner {
            let colour = heat::srgb_u8(x as f32 / (inner - 1) as f32);
            for y in margin..margin + ramp {
                chart.pixels[y * width + margin + x] = colour;
            }
        }
        let top = margin + ramp;
        let mut free = 0;
        for v in scale.marks() {
            let at = margin + (scale.place(v) * (inner - 1) as f32 + 0.5) as usize;
            for y in top..top + 2 * zoom {
                chart.ink(at, y);
            }
            let text = short(v);
            let wide = font::width(&text) * zoom;
            let x = at.saturating_sub(wide / 2).clamp(1, width.saturating_sub(wide + 1).max(1));
            if x >= free {
                chart.write(&text, [x, top + 3 * zoom], zoom);
                free = x + wide + 3 * zoom;
            }
        }
        chart.write(caption, [margin, top + 3 * zoom + line], zoom);
        chart
    }

    /// With its legend below.
    pub fn with_legend(self, scale: Scale, caption: &str) -> Self {
        let legend = Self::legend(self.width, scale, caption);
        let mut out = Self::blank(legend.width, self.height + legend.height);
        out.paste(&self, 0);
        out.paste(&legend, self.height);
        out
    }

    pub(crate) fn blank(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![PAPER; width * height] }
    }

    fn paste(&mut self, other: &Self, top: usize) {
        for (y, row) in other.pixels.chunks(other.width.max(1)).enumerate() {
            self.pixels[(top + y) * self.width..][..other.width].copy_from_slice(row);
        }
    }

    pub(crate) fn ink(&mut self, x: usize, y: usize) {
        if x < self.width && y < self.height {
            self.pixels[y * self.width + x] = INK;
        }
    }

    pub(crate) fn write(&mut self, text: &str, [left, top]: [usize; 2], zoom: usize) {
        for (i, letter) in text.chars().enumerate() {
            let x0 = left + i * font::ADVANCE * zoom;
            for (y, row) in font::glyph(letter).into_iter().enumerate() {
                for x in (0..font::WIDTH).filter(|x| row >> (font::WIDTH - 1 - x) & 1 == 1) {
                    for k in 0..zoom * zoom {
                        self.ink(x0 + x * zoom + k % zoom, top + y * zoom + k / zoom);
                    }
                }
            }
        }
    }

    /// As a PNG.
    pub fn write_png(&self, out: impl io::Write, metadata: &[(String, String)]) -> io::Result<()> {
        let (width, height) = (self.width, self.height);
        let pixels = png::Pixels::Eight(&self.pixels);
        png::write(out, &png::Encoded { width, height, pixels, curve: png::Curve::Srgb, metadata })
    }

    /// As a PNG file, whole or not at all; `metadata` goes with it.
    pub fn save(&self, path: &Path, metadata: &[(String, String)]) -> Result<(), SaveError> {
        if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
            return Err(SaveError::NotPng(path.display().to_string()));
        }
        atomic::write(path, |file| self.write_png(file, metadata))?;
        Ok(())
    }
}

/// A number in a few letters: 0.5, 250, 12k, 3M.
fn short(v: f32) -> String {
    let (scaled, unit) = match v {
        _ if v >= 1e9 => (v / 1e9, "G"),
        _ if v >= 1e6 => (v / 1e6, "M"),
        _ if v >= 1e3 => (v / 1e3, "k"),
        _ => (v, ""),
    };
    // Three digits, without the noughts at the end.
    let digits = format!("{:.*}", if scaled >= 100.0 { 0 } else { 2 }, scaled);
    let plain =
        if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { &digits };
    format!("{plain}{unit}")
}

pub(crate) mod font;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_told_in_few_letters() {
        let told: Vec<_> = [0.0, 0.5, 0.25, 20.0, 250.0, 1000.0, 12_500.0, 3e6, 2e9].map(short).into();
        assert_eq!(told, ["0", "0.5", "0.25", "20", "250", "1k", "12.5k", "3M", "2G"]);
    }

    #[test]
    fn marks_are_few_and_round() {
        assert_eq!(Scale::Linear { most: 47.0 }.marks(), [0.0, 10.0, 20.0, 30.0, 40.0]);
        assert_eq!(Scale::Linear { most: 6.0 }.marks(), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(Scale::Logarithmic { least: 1.0, most: 2000.0 }.marks(), [1.0, 10.0, 100.0, 1000.0]);
        for most in [1e-6, 0.3, 1.0, 77.0, 1e12] {
            let n = Scale::Linear { most }.marks().len();
            assert!((2..=7).contains(&n), "{most}: {n}");
        }
        assert!(Scale::Logarithmic { least: 1.0, most: 1e30 }.marks().len() <= 7);
    }

    #[test]
    fn a_scale_leaves_out_what_is_far_beyond() {
        let mut values = vec![3.0; 1000];
        values[7] = 1e9;
        values[8] = f32::NAN;
        assert_eq!(Scale::of(&values), Scale::Linear { most: 3.0 });
        assert_eq!(Scale::of(&[]), Scale::Linear { most: 1.0 });
        let scale = |values: &[f32]| Scale::of_magnitudes(values);
        assert_eq!(scale(&[0.0, 2.0, 300.0]), Scale::Logarithmic { least: 1.0, most: 300.0 });
        assert_eq!(scale(&[20.0, 31.0, 25.0]), Scale::Logarithmic { least: 10.0, most: 100.0 });
        assert_eq!(scale(&[]), Scale::Logarithmic { least: 1.0, most: 10.0 });
    }

    #[test]
    fn the_legend_has_all_colours_and_letters_below() {
        let values: Vec<f32> = (0..200 * 3).map(|i| (i % 200) as f32).collect();
        let scale = Scale::of(&values);
        let chart = Chart::of(&values, 200, scale).with_legend(scale, "nodes a sample");
        assert_eq!(chart.pixels.len(), chart.width * chart.height);
        let (least, most) = (heat::srgb_u8(0.0), heat::srgb_u8(1.0));
        let below = &chart.pixels[3 * 200..];
        assert!(below.contains(&least) && below.contains(&most), "the ramp is there");
        let inked = below.iter().filter(|p| **p == INK).count();
        assert!(inked > 150, "{inked} dots of ink: letters and marks");
        assert_ne!(
            Chart::legend(200, scale, "nodes a sample"),
            Chart::legend(200, Scale::Linear { most: 7e5 }, "nodes a sample"),
            "other numbers, another legend"
        );
    }

    #[test]
    fn narrow_pictures_have_legends_too() {
        let chart = Chart::of(&[1.0], 1, Scale::Linear { most: 1.0 });
        let chart = chart.with_legend(Scale::Linear { most: 1.0 }, "x");
        assert_eq!((chart.width, chart.pixels.len()), (120, chart.width * chart.height));
    }
}
