//! Files of luminaires: IES LM-63 (1986, 1991, 1995, 2002) and EULUMDAT.
//!
//! Both are lines of text with intensities by direction. Symmetry, by which they leave most directions out, is written out here, so that what comes of them has all.

use straal_scene::photometry::{Photometry, Planes};

use crate::{ReadError, number};

mod eulumdat;
mod lm63;
mod write;

pub use write::write;

/// The largest file, in bytes.
pub const MOST_BYTES: u64 = 1 << 26;

/// The most planes, and the most angles in each: steps of a twentieth of a degree.
const MOST: usize = 7201;

/// The most intensities.
const MOST_NUMBERS: usize = 1 << 22;

/// Reads a luminaire's intensities, whichever of the two formats it is: LM-63 has a line that begins with `TILT=`.
pub fn read(bytes: &[u8]) -> Result<Photometry, ReadError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    // Names of firms are in any encoding; all that counts is ASCII.
    let text = String::from_utf8_lossy(bytes);
    let lines = lines(&text);
    let is_lm63 = lines.first().is_some_and(|l| l.trim_start().to_ascii_uppercase().starts_with("IESNA"))
        || lines.iter().any(|l| l.trim_start().to_ascii_uppercase().starts_with("TILT"));
    let found = if is_lm63 { lm63::read(&lines) } else { eulumdat::read(&lines) }?;
    if found.candela.iter().all(|v| *v == 0.0) {
        return Err(ReadError::file("the luminaire sends out no light: all its intensities are 0"));
    }
    Ok(found)
}

/// A line ends in a line feed, a carriage return or both.
fn lines(text: &str) -> Vec<&str> {
    let mut lines = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let (line, more) = rest.split_once(['\n', '\r']).unwrap_or((rest, ""));
        let is_pair = rest.as_bytes().get(line.len()) == Some(&b'\r');
        rest = more.strip_prefix('\n').filter(|_| is_pair).unwrap_or(more);
        lines.push(line);
    }
    lines
}

/// A number with a decimal point or a comma, which must be finite.
fn finite(word: &str) -> Option<f64> {
    let word = word.trim();
    let found = number::double(word).or_else(|| number::double(&word.replace(',', ".")));
    found.filter(|v| v.is_finite())
}

/// A count of planes or angles.
fn count(v: f64, what: &str) -> Result<usize, ReadError> {
    if v < 1.0 || v.floor() != v || v > MOST as f64 {
        return Err(ReadError::file(format!("it says that there are {v} {what}: from 1 to {MOST} may be")));
    }
    Ok(v as usize)
}

/// Complains of angles that don't rise.
fn rising(angles: &[f64], what: &str) -> Result<(), ReadError> {
    match angles.windows(2).find(|w| w[0] >= w[1]) {
        Some(w) => Err(ReadError::file(format!("its {what} don't rise: after {} comes {}", w[0], w[1]))),
        None => Ok(()),
    }
}

/// Planes all around, from those of some part of the circle that symmetry tells of: each of these is what it is at `same(plane)`.
fn all_around(
    (planes, angles, candela): (&[f64], Vec<f64>, &[f32]),
    same: impl Fn(f64) -> f64,
) -> Photometry {
    if let [_] = planes {
        return Photometry { system: Planes::C, planes: vec![0.0], angles, candela: candela.to_vec() };
    }
    // Wherever a plane or its mirror image was measured.
    let mut all: Vec<f64> = planes
        .iter()
        .flat_map(|p| [*p, 180.0 - p, 180.0 + p, 360.0 - p])
        .map(|p| p.rem_euclid(360.0))
        .chain([0.0, 360.0])
        .collect();
    all.sort_unstable_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    let measured =
        Photometry { system: Planes::C, planes: planes.to_vec(), angles, candela: candela.to_vec() };
    let (first, last) = (planes[0], planes[planes.len() - 1]);
    let value = |plane: f64, angle: f64| {
        let p = same(plane);
        measured.at(
            if p < first {
                first
            } else if p > last {
                last
            } else {
                p
            },
            angle,
        ) as f32
    };
    let candela = all.iter().flat_map(|p| measured.angles.iter().map(|a| value(*p, *a))).collect();
    Photometry { planes: all, candela, ..measured }
}

#[cfg(test)]
mod tests;
