//! IES LM-63: keywords, a line with `TILT=`, and then nothing but numbers.

use straal_scene::photometry::{Photometry, Planes};

use super::{MOST_NUMBERS, all_around, count, finite, rising};
use crate::ReadError;

/// Numbers as they come.
struct Numbers<'a, I: Iterator<Item = &'a str>> {
    words: I,
    read: usize,
}

impl<'a, I: Iterator<Item = &'a str>> Numbers<'a, I> {
    fn next(&mut self, what: &str) -> Result<f64, ReadError> {
        let Some(word) = self.words.next() else {
            return Err(ReadError::file(format!(
                "it ends after {} numbers, where {what} should stand",
                self.read
            )));
        };
        self.read += 1;
        let message = || format!("number {} should be {what}, found `{}`", self.read, shown(word));
        finite(word).ok_or_else(|| ReadError::file(message()))
    }

    fn list(&mut self, count: usize, what: &str) -> Result<Vec<f64>, ReadError> {
        // Not ahead of the numbers that are there.
        let mut list = Vec::new();
        for _ in 0..count {
            list.push(self.next(what)?);
        }
        Ok(list)
    }
}

fn shown(word: &str) -> String {
    word.chars().filter(|c| !c.is_control()).take(24).collect()
}

pub(super) fn read(lines: &[&str]) -> Result<Photometry, ReadError> {
    let is_tilt = |l: &&str| l.trim_start().to_ascii_uppercase().starts_with("TILT");
    let Some(at) = lines.iter().position(is_tilt) else {
        return Err(ReadError::file("no line says `TILT=`: this is not a whole IES file"));
    };
    let tilt = lines[at].split_once('=').map_or("", |(_, v)| v.trim()).to_ascii_uppercase();
    let words = lines[at + 1..].iter().flat_map(|l| l.split(|c: char| c.is_whitespace() || c == ','));
    let mut numbers = Numbers { words: words.filter(|w| !w.is_empty()), read: 0 };
    if tilt == "INCLUDE" {
        // What lamps lose as the luminaire is tilted: it is taken as it was measured.
        numbers.next("how the lamp sits in the luminaire")?;
        let pairs = count(numbers.next("the number of tilts")?, "tilts")?;
        numbers.list(2 * pairs, "an angle or factor of tilt")?;
    }
    numbers.next("the number of lamps")?;
    numbers.next("lumens for each lamp")?;
    let multiplier = numbers.next("the multiplier of candela")?;
    let verticals = count(numbers.next("the number of vertical angles")?, "vertical angles")?;
    let horizontals = count(numbers.next("the number of horizontal angles")?, "horizontal angles")?;
    let system = match numbers.next("the type of photometry")? {
        1.0 => Planes::C,
        2.0 => Planes::B,
        3.0 => Planes::A,
        other => {
            let message = format!("its type of photometry is {other}: 1, 2 and 3 are types C, B and A");
            return Err(ReadError::file(message));
        }
    };
    for what in ["the type of units", "the width", "the length", "the height"] {
        numbers.next(what)?;
    }
    let ballast = numbers.next("the ballast factor")?;
    // Before 1995 a factor of its own, since then kept for the future and 1.
    let further = numbers.next("the ballast-lamp photometric factor")?;
    numbers.next("the input watts")?;
    let factor = multiplier * ballast * if further > 0.0 { further } else { 1.0 };
    if factor.is_nan() || factor <= 0.0 {
        let message = format!("its intensities are multiplied by {factor}: nothing would shine");
        return Err(ReadError::file(message));
    }
    if verticals.saturating_mul(horizontals) > MOST_NUMBERS {
        return Err(ReadError::file(format!("it has more than {MOST_NUMBERS} intensities")));
    }
    let angles = numbers.list(verticals, "a vertical angle")?;
    let planes = numbers.list(horizontals, "a horizontal angle")?;
    rising(&angles, "vertical angles")?;
    rising(&planes, "horizontal angles")?;
    let candela = numbers.list(verticals * horizontals, "an intensity")?;
    let candela: Vec<f32> =
        candela.into_iter().map(|v| if v > 0.0 { (v * factor) as f32 } else { 0.0 }).collect();
    if candela.iter().any(|v| !v.is_finite()) {
        return Err(ReadError::file("an intensity is beyond the range of numbers"));
    }
    match system {
        Planes::C => about_axis(&planes, angles, &candela),
        Planes::B | Planes::A => Ok(in_front(system, (planes, angles), &candela)),
    }
}

/// Type C: planes of the whole circle, of half of it, of a quarter, or one.
fn about_axis(planes: &[f64], angles: Vec<f64>, candela: &[f32]) -> Result<Photometry, ReadError> {
    if let Some(bad) = angles.iter().find(|a| !(0.0..=180.0).contains(*a)) {
        return Err(ReadError::file(format!("a vertical angle is {bad} degrees: from 0 to 180 may be")));
    }
    let (first, last) = (planes[0], planes[planes.len() - 1]);
    let is = |a: f64, b: f64| (first - a).abs() < 0.01 && (last - b).abs() < 0.01;
    let around = |p: f64| p.rem_euclid(360.0);
    let table = (planes, angles, candela);
    if planes.len() == 1 {
        Ok(all_around(table, |p| p))
    } else if is(0.0, 90.0) {
        Ok(all_around(table, |p| 90.0 - ((around(p) % 180.0) - 90.0).abs()))
    } else if is(0.0, 180.0) {
        Ok(all_around(table, |p| 180.0 - (p - 180.0).abs()))
    } else if is(90.0, 270.0) {
        Ok(all_around(table, |p| {
            if around(p) < 90.0 {
                180.0 - around(p)
            } else if p > 270.0 {
                540.0 - p
            } else {
                p
            }
        }))
    } else if first.abs() < 0.01 && last > 180.0 && last <= 360.01 {
        // Some leave the last plane out, which is the first again.
        let (mut planes, mut candela) = (planes.to_vec(), candela.to_vec());
        if last < 359.99 {
            planes.push(360.0);
            candela.extend_from_within(..table.1.len());
        }
        Ok(all_around((&planes, table.1, &candela), |p| p))
    } else {
        let message = format!(
            "its horizontal angles go from {first} to {last} degrees: they should be 0, or end at 90, 180 or 360, or go from 90 to 270"
        );
        Err(ReadError::file(message))
    }
}

/// Types B and A: what is measured to one side only is the same to the other.
fn in_front(system: Planes, (planes, angles): (Vec<f64>, Vec<f64>), candela: &[f32]) -> Photometry {
    // A plane of type B is a vertical angle, one of type A a horizontal one.
    let n = angles.len();
    let mirrored = |list: &[f64]| {
        let is_half = list[0].abs() < 0.01 && list.len() > 1;
        let mut all: Vec<f64> =
            if is_half { list.iter().skip(1).rev().map(|v| -v).collect() } else { Vec::new() };
        all.extend_from_slice(list);
        all
    };
    let (wide, high) = (mirrored(&planes), mirrored(&angles));
    let place =
        |list: &[f64], v: f64| list.iter().position(|x| *x == v).or(list.iter().position(|x| *x == -v));
    let value = |h: f64, v: f64| {
        let at = place(&planes, h).zip(place(&angles, v)).map(|(i, j)| i * n + j);
        at.and_then(|at| candela.get(at)).copied().unwrap_or_default()
    };
    let candela = match system {
        Planes::B => {
            let of = high.iter().flat_map(|v| wide.iter().map(|h| value(*h, *v))).collect();
            return Photometry { system, planes: high, angles: wide, candela: of };
        }
        _ => wide.iter().flat_map(|h| high.iter().map(|v| value(*h, *v))).collect(),
    };
    Photometry { system, planes: wide, angles: high, candela }
}
