//! Numbers as the world's programs write them.
//!
//! Infinity and NaN have a spelling of their own in every C library: `inf`, `Infinity` and `nan` by the standard, `nan(ind)`,
//! `nan(snan)` and `nan(0x8000000000000)` with what it allows in brackets, `1.#INF`, `1.#IND`, `1.#QNAN` and `1.#SNAN` in
//! Microsoft's before 2015, filled up with zeros to the digits that were asked for, `NaNQ` and `NaNS` on AIX. All are read
//! as what they are.

/// The number that a word is, infinities and NaN included.
#[inline]
pub(crate) fn single(word: &str) -> Option<f32> {
    match word.parse() {
        Ok(number) => Some(number),
        Err(_) => not_finite(word).map(|v| v as f32),
    }
}

/// The same in double precision.
#[inline]
pub(crate) fn double(word: &str) -> Option<f64> {
    match word.parse() {
        Ok(number) => Some(number),
        Err(_) => not_finite(word),
    }
}

/// What Rust's own reader doesn't know.
#[cold]
fn not_finite(word: &str) -> Option<f64> {
    let bare = word.strip_prefix(['+', '-']).unwrap_or(word);
    let sign = if word.starts_with('-') { -1.0 } else { 1.0 };
    let lower = bare.to_ascii_lowercase();
    if let Some(what) = lower.strip_prefix("1.#").or_else(|| lower.strip_prefix("1,#")) {
        // Cut to few digits the names are rounded as if they were numbers: 1.#J, 1.#IO, 1.#QO, 1.#R.
        let letters = what.starts_with(|c: char| c.is_ascii_alphabetic())
            && what.bytes().all(|b| b.is_ascii_alphanumeric() || b"+-".contains(&b));
        let number = if what.starts_with("inf") { f64::INFINITY } else { f64::NAN };
        return letters.then_some(sign * number);
    }
    let what = lower.strip_prefix('.').unwrap_or(&lower);
    if what == "inf" || what == "infinity" {
        return Some(sign * f64::INFINITY);
    }
    let rest = what
        .strip_prefix("nan")
        .or_else(|| what.strip_prefix("qnan"))
        .or_else(|| what.strip_prefix("snan"))?;
    let is_known = matches!(rest, "" | "q" | "s" | "ind" | "(")
        || rest.starts_with('(') && rest.ends_with(')')
        || rest.strip_prefix("0x").is_some_and(|digits| digits.bytes().all(|b| b.is_ascii_hexdigit()));
    is_known.then_some(f64::NAN)
}

/// Where in a line its comment begins, which is its end if it has none. The `#` of `1.#IND` begins none.
#[inline]
pub(crate) fn comment(line: &[u8]) -> usize {
    let mut from = 0;
    while let Some(at) = memchr::memchr(b'#', &line[from..]).map(|i| i + from) {
        let is_number = matches!(line[..at], [.., b'1', b'.' | b',']) && {
            let before = at.checked_sub(3).map(|i| line[i]);
            let after = line.get(at + 1).is_some_and(u8::is_ascii_alphabetic);
            after && before.is_none_or(|b| b.is_ascii_whitespace() || b"+-,;:".contains(&b))
        };
        if !is_number {
            return at;
        }
        from = at + 1;
    }
    line.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_spelling_of_nan_and_infinity_is_read() {
        for word in [
            "nan",
            "NaN",
            "-nan",
            "-nan(ind)",
            "nan(snan)",
            "-NAN(IND)",
            "nan(0x8000000000000)",
            "NaNQ",
            "nans",
            "qnan",
            "-SNaN",
            "1.#QNAN",
            "1.#QNAN0",
            "-1.#IND",
            "-1.#IND00",
            "1.#SNAN",
            "1.#QNANe+000",
            "1,#QNAN0",
            "1.#J",
            ".nan",
        ] {
            assert!(single(word).is_some_and(f32::is_nan), "{word}");
            assert!(double(word).is_some_and(f64::is_nan), "{word}");
        }
        for word in [
            "inf",
            "INF",
            "+inf",
            "Infinity",
            "infinity",
            "1.#INF",
            "+1.#INF00",
            "1.#INFe+000",
            ".inf",
            "1e999",
        ] {
            assert_eq!(single(word), Some(f32::INFINITY), "{word}");
            let minus = format!("-{}", word.trim_start_matches('+'));
            assert_eq!(double(&minus), Some(f64::NEG_INFINITY), "{minus}");
        }
        assert_eq!(single("-1.5e-3"), Some(-0.0015));
        for word in
            ["", "-", "nancy", "1.#", "1.#?", "#IND", "2.#INF", "info", "zero", "1.0.0", "nan)", "(ind)"]
        {
            assert_eq!(single(word), None, "{word}");
        }
    }

    #[test]
    fn comments_begin_at_a_hash_that_is_no_number() {
        for (line, want) in [
            ("v 0 1 2 # a", "v 0 1 2 "),
            ("v 0 1 2# a # b", "v 0 1 2"),
            ("vn -1.#IND00 1.#QNAN 1.#INF # 1.#IND", "vn -1.#IND00 1.#QNAN 1.#INF "),
            ("f 11.#note", "f 11."),
            ("400,1.#INF", "400,1.#INF"),
            ("#", ""),
            ("plain", "plain"),
        ] {
            assert_eq!(&line[..comment(line.as_bytes())], want);
        }
    }
}
