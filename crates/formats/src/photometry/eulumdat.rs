//! EULUMDAT: one thing on each line, in an order that never changes (Stockmar 1990).

use straal_scene::photometry::Photometry;

use super::{MOST_NUMBERS, all_around, count, finite, rising};
use crate::ReadError;

/// Lines as they come.
struct Lines<'a> {
    lines: &'a [&'a str],
    at: usize,
}

impl Lines<'_> {
    fn skip(&mut self, count: usize) {
        self.at = self.at.saturating_add(count);
    }

    fn number(&mut self, what: &str) -> Result<f64, ReadError> {
        let Some(line) = self.lines.get(self.at) else {
            return Err(ReadError::file(format!(
                "it ends at line {}, where {what} should stand",
                self.lines.len()
            )));
        };
        self.at += 1;
        let message = || {
            let text: String = line.trim().chars().filter(|c| !c.is_control()).take(24).collect();
            format!("line {} should be {what}, found `{text}`", self.at)
        };
        finite(line).ok_or_else(|| ReadError::file(message()))
    }

    fn list(&mut self, count: usize, what: &str) -> Result<Vec<f64>, ReadError> {
        let mut list = Vec::new();
        for _ in 0..count {
            list.push(self.number(what)?);
        }
        Ok(list)
    }
}

pub(super) fn read(lines: &[&str]) -> Result<Photometry, ReadError> {
    let mut lines = Lines { lines, at: 2 };
    let symmetry = lines.number("the kind of symmetry, 0 to 4").unwrap_or(f64::NAN);
    if ![0.0, 1.0, 2.0, 3.0, 4.0].contains(&symmetry) {
        let message = "this is neither an IES file, which has a line with `TILT=`, nor EULUMDAT, whose third line says a symmetry from 0 to 4";
        return Err(ReadError::file(message));
    }
    let planes = count(lines.number("the number of C-planes")?, "C-planes")?;
    lines.skip(1);
    let angles = count(lines.number("the number of angles in a C-plane")?, "angles in a C-plane")?;
    // Past the step of angles, names, measurements of the luminaire and shares of its light.
    lines.at = 23;
    let factor = lines.number("the factor of the intensities")?;
    lines.skip(1);
    let sets = count(lines.number("the number of sets of lamps")?, "sets of lamps")?;
    let lamps = lines.list(sets, "the number of lamps in a set")?;
    lines.skip(sets);
    let lumens = lines.list(sets, "the luminous flux of a set of lamps")?;
    lines.skip(3 * sets + 10);
    let around = lines.list(planes, "the angle of a C-plane")?;
    let angles = lines.list(angles, "an angle in the C-planes")?;
    rising(&around, "C-planes")?;
    rising(&angles, "angles in the C-planes")?;
    if let Some(bad) = angles.iter().find(|a| !(0.0..=180.0).contains(*a)) {
        return Err(ReadError::file(format!("an angle is {bad} degrees: from 0 to 180 may be")));
    }
    // Which of the planes are there.
    let half = planes / 2;
    let there: Vec<usize> = match symmetry as u32 {
        0 => (0..planes).collect(),
        1 => vec![0],
        2 => (0..=half).collect(),
        3 => (0..=half).map(|i| (3 * planes / 4 + i) % planes).collect(),
        _ => (0..=planes / 4).collect(),
    };
    if there.len().saturating_mul(angles.len()) > MOST_NUMBERS {
        return Err(ReadError::file(format!("it has more than {MOST_NUMBERS} intensities")));
    }
    if symmetry > 1.0 && (planes < 2 || planes % if symmetry > 2.0 { 4 } else { 2 } != 0) {
        let message = format!("{planes} C-planes have no symmetry of kind {symmetry}");
        return Err(ReadError::file(message));
    }
    // For each 1000 lm of its lamps; a number of lamps below 0 says that intensities stand as they are.
    let is_absolute = lamps.first().is_some_and(|n| *n < 0.0);
    let per = if is_absolute { 1.0 } else { lumens.first().copied().unwrap_or_default() / 1000.0 };
    let factor = per * if factor > 0.0 { factor } else { 1.0 };
    if factor.is_nan() || factor <= 0.0 {
        return Err(ReadError::file("its lamps have no luminous flux: nothing would shine"));
    }
    let numbers = lines.list(there.len() * angles.len(), "an intensity")?;
    let candela: Vec<f32> =
        numbers.into_iter().map(|v| if v > 0.0 { (v * factor) as f32 } else { 0.0 }).collect();
    if candela.iter().any(|v| !v.is_finite()) {
        return Err(ReadError::file("an intensity is beyond the range of numbers"));
    }
    let n = angles.len();
    // In rising order; planes of symmetry 3 begin at C270 and go on through C0.
    let mut rows: Vec<(f64, &[f32])> =
        there.iter().map(|i| around[*i]).zip(candela.chunks_exact(n)).collect();
    if symmetry == 3.0 {
        rows.iter_mut().for_each(|(plane, _)| *plane = (*plane + 90.0).rem_euclid(360.0));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    if symmetry == 0.0 && rows.len() > 1 {
        let first = rows[0].1;
        rows.push((360.0, first));
    } else if symmetry == 2.0 && rows.len() == 2 && planes == 2 {
        rows[1].0 = 180.0;
    }
    let own: Vec<f64> = rows.iter().map(|(plane, _)| *plane).collect();
    let candela: Vec<f32> = rows.iter().flat_map(|(_, row)| row.iter().copied()).collect();
    rising(&own, "C-planes")?;
    let table = (own.as_slice(), angles, candela.as_slice());
    Ok(match symmetry as u32 {
        2 => all_around(table, |p| 180.0 - (p - 180.0).abs()),
        // A quarter turn on, so that the planes from C270 to C90 are 0 to 180.
        3 => turned_back(all_around(table, |p| 180.0 - (p - 180.0).abs())),
        4 => all_around(table, |p| 90.0 - ((p.rem_euclid(360.0) % 180.0) - 90.0).abs()),
        _ => all_around(table, |p| p),
    })
}

/// Planes that were counted from C270 on.
fn turned_back(lamp: Photometry) -> Photometry {
    if lamp.planes.len() == 1 {
        return lamp;
    }
    let planes = lamp.planes.clone();
    let value = |p: f64, a: f64| lamp.at((p + 90.0).rem_euclid(360.0), a) as f32;
    let candela = planes.iter().flat_map(|p| lamp.angles.iter().map(|a| value(*p, *a))).collect();
    Photometry { planes: planes.clone(), candela, ..lamp }
}
