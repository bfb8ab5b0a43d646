//! Files of spectra: a wavelength in nanometres and a value on each line.
//!
//! The two are parted by spaces, a comma, a colon or a semicolon; `#` begins a comment, and empty lines count for nothing. This
//! takes pbrt's and Mitsuba's `.spd` and plain tables of two columns.

use straal_color::spectrum::Spectrum;

use crate::ReadError;

/// The most lines of a file: a table finer than 0.001 nm is no measurement.
const MOST: usize = 1_000_000;

/// Reads a spectrum.
pub fn read(bytes: &[u8]) -> Result<Spectrum, ReadError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text =
        std::str::from_utf8(bytes).map_err(|_| ReadError::file("this is not a text: it must be UTF-8"))?;
    let (mut wavelengths, mut values) = (Vec::new(), Vec::new());
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or(line);
        let mut words =
            line.split(|c: char| c.is_whitespace() || ",:;".contains(c)).filter(|w| !w.is_empty());
        let Some(first) = words.next() else { continue };
        let pair =
            (first.parse::<f64>().ok(), words.next().and_then(|w| w.parse::<f64>().ok()), words.next());
        let (Some(nm), Some(value), None) = pair else {
            let message = format!("line {} is not a wavelength and a value", i + 1);
            return Err(ReadError::file(message));
        };
        if wavelengths.len() == MOST {
            return Err(ReadError::file(format!("it has more than {MOST} lines")));
        }
        wavelengths.push(nm);
        values.push(value);
    }
    Spectrum::new(wavelengths, values).map_err(|fault| ReadError::file(fault.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_in_many_forms() {
        let want = Spectrum::new(vec![400.0, 500.0], vec![0.25, 1.0]).unwrap();
        for text in [
            "400 0.25\n500 1\n",
            "# a\n400,0.25 # b\r\n\r\n500,1",
            "400: .25\n500: 1e0",
            "\u{feff}400;0.25\n500;1",
        ] {
            assert_eq!(read(text.as_bytes()).unwrap(), want, "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_told() {
        let fault = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
        assert!(fault(b"400 1\n500").contains("line 2"));
        assert!(fault(b"400 1 2").contains("line 1"));
        assert!(fault(b"500 1\n400 1").contains("must rise"));
        assert!(fault(b"400 -1").contains("negative"));
        assert!(fault(b"400 nan").contains("not finite"));
        assert!(fault(b"").contains("at least one"));
        assert!(fault(b"\xff").contains("UTF-8"));
    }
}
