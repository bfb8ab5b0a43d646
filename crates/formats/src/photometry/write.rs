//! Luminaires as IES LM-63-2002.

use std::io::{self, Write};

use straal_scene::photometry::{Photometry, Planes};

/// Writes a luminaire, all of its directions in full.
pub fn write<W: Write>(mut out: W, lamp: &Photometry) -> io::Result<()> {
    let kind = match lamp.system {
        Planes::C => 1,
        Planes::B => 2,
        Planes::A => 3,
    };
    let (angles, planes) = (lamp.angles.len(), lamp.planes.len());
    writeln!(out, "IESNA:LM-63-2002\nTILT=NONE")?;
    // One lamp of unknown lumens, in metres, a point.
    writeln!(out, "1 -1 1 {angles} {planes} {kind} 2 0 0 0\n1 1 0")?;
    // Lines are short.
    const MOST: usize = 12;
    let mut list = |numbers: &mut dyn Iterator<Item = String>| -> io::Result<()> {
        let words: Vec<String> = numbers.collect();
        words.chunks(MOST).try_for_each(|line| writeln!(out, "{}", line.join(" ")))
    };
    list(&mut lamp.angles.iter().map(f64::to_string))?;
    list(&mut lamp.planes.iter().map(f64::to_string))?;
    for plane in lamp.candela.chunks(if angles > 0 { angles } else { 1 }) {
        list(&mut plane.iter().map(f32::to_string))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let lamp = Photometry {
            system: Planes::C,
            planes: vec![0.0, 90.0, 180.0, 270.0, 360.0],
            angles: (0..=30).map(|i| 6.0 * f64::from(i)).collect(),
            candela: (0..155_u16).map(|i| f32::from(i % 31) * 0.375).collect(),
        };
        let mut text = Vec::new();
        write(&mut text, &lamp).unwrap();
        assert_eq!(super::super::read(&text).unwrap(), lamp);
        assert!(text.split(|b| *b == b'\n').all(|line| line.len() < 132));
    }
}
