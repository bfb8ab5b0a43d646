//! Files of spectra: a wavelength in nanometres and a value on each line.
//!
//! The two are parted by spaces, a comma, a colon or a semicolon; `#` begins a comment, empty lines count for nothing, and the first line
//! may name the columns. This takes pbrt's and Mitsuba's `.spd` and tables of two columns as spreadsheets write them.

use straal_color::spectrum::TabulatedSpectrum;

use crate::{ReadError, number};

/// The largest file, in bytes: that of [`read`]'s most lines, generously written.
pub const MOST_BYTES: u64 = 1 << 26;

/// The most lines of a file: a table finer than 0.001 nm is no measurement.
const MOST: usize = 1_000_000;

/// Reads a spectrum.
pub fn read(bytes: &[u8]) -> Result<TabulatedSpectrum, ReadError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text =
        std::str::from_utf8(bytes).map_err(|_| ReadError::file("this is not a text: it must be UTF-8"))?;
    let (mut wavelengths, mut values) = (Vec::new(), Vec::new());
    let mut may_be_heading = true;
    // A line ends in a line feed, a carriage return or both.
    let mut number_of_line = 0;
    let mut rest = text;
    while !rest.is_empty() {
        let (line, more) = rest.split_once(['\n', '\r']).unwrap_or((rest, ""));
        let is_pair = rest.as_bytes().get(line.len()) == Some(&b'\r');
        rest = more.strip_prefix('\n').filter(|_| is_pair).unwrap_or(more);
        number_of_line += 1;
        let line = &line[..number::comment(line.as_bytes())];
        let words = line.split(|c: char| c.is_whitespace() || ",:;".contains(c)).filter(|w| !w.is_empty());
        let words: Vec<&str> = words.take(3).collect();
        if words.is_empty() {
            continue;
        }
        let number = |i: usize| words.get(i).and_then(|w| number::double(w));
        let is_heading = std::mem::take(&mut may_be_heading) && number(0).is_none();
        let (nm, value) = match (words.len(), number(0), number(1)) {
            (2, Some(nm), Some(value)) => (nm, value),
            _ if is_heading => continue,
            (n, ..) => {
                let more = if n > 2 { ": it has more than two columns" } else { "" };
                let message = format!("line {number_of_line} is not a wavelength and a value{more}");
                return Err(ReadError::file(message));
            }
        };
        if wavelengths.len() == MOST {
            return Err(ReadError::file(format!("it has more than {MOST} lines")));
        }
        wavelengths.push(nm);
        values.push(value);
    }
    TabulatedSpectrum::new(wavelengths, values).map_err(|fault| ReadError::file(fault.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_in_many_forms() {
        let want = TabulatedSpectrum::new(vec![400.0, 500.0], vec![0.25, 1.0]).unwrap();
        for text in [
            "400 0.25\n500 1\n",
            "# a\n400,0.25 # b\r\n\r\n500,1",
            "400: .25\n500: 1e0",
            "400 .25\r500 1\r",
            "# a\r400 .25# b\r\n\r500 1",
            "\u{feff}400;0.25\n500;1",
            "# of a lamp\n\nwavelength (nm),power\n400,0.25\n500,1",
        ] {
            assert_eq!(read(text.as_bytes()).unwrap(), want, "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_told() {
        let fault = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
        assert!(fault(b"400 1\n500").contains("line 2"));
        assert!(fault(b"400 1 2").contains("line 1 is not a wavelength and a value: it has more"));
        assert!(fault(b"wavelength value\nnm 1\n400 1").contains("line 2"));
        assert!(fault(b"400 1\nwavelength value").contains("line 2"));
        assert!(fault(b"wavelength value").contains("at least one"));
        assert!(fault(b"500 1\n400 1").contains("must rise"));
        assert!(fault(b"400 -1").contains("negative"));
        for no_number in ["nan", "-nan(ind)", "1.#QNAN0", "1.#INF", "-1.#IND # x", "Infinity"] {
            assert!(fault(format!("400 {no_number}").as_bytes()).contains("not finite"), "{no_number}");
        }
        assert!(fault(b"400 1\r500 1\r\n500").contains("line 3"));
        assert!(fault(b"").contains("at least one"));
        assert!(fault(b"\xff").contains("UTF-8"));
    }
}
