//! What a plain word means in the core schema of YAML 1.2 (10.3.2): `yes` is a word, `0x1F` and `.inf` are numbers.

use straal_scene::tree::Datum;

/// The value of a plain scalar.
pub fn resolve(text: String) -> Datum {
    match text.as_str() {
        "" | "~" | "null" | "Null" | "NULL" => Datum::Null,
        "true" | "True" | "TRUE" => Datum::Bool(true),
        "false" | "False" | "FALSE" => Datum::Bool(false),
        word => number(word).map_or(Datum::String(text), Datum::Number),
    }
}

fn number(word: &str) -> Option<f64> {
    let unsigned = word.strip_prefix(['-', '+']).unwrap_or(word);
    let sign = if word.starts_with('-') { -1.0 } else { 1.0 };
    match unsigned {
        ".inf" | ".Inf" | ".INF" => return Some(sign * f64::INFINITY),
        ".nan" | ".NaN" | ".NAN" if unsigned.len() == word.len() => return Some(f64::NAN),
        _ => {}
    }
    if let Some(digits) = word.strip_prefix("0x") {
        return based(digits, 16);
    }
    if let Some(digits) = word.strip_prefix("0o") {
        return based(digits, 8);
    }
    is_decimal(unsigned).then(|| word.parse().ok()).flatten()
}

/// Digits of a base; beyond 2^64 they are no number of a scene.
fn based(digits: &str, base: u32) -> Option<f64> {
    let plain = !digits.is_empty() && digits.chars().all(|c| c.is_digit(base));
    plain.then(|| u64::from_str_radix(digits, base).map_or(f64::INFINITY, |v| v as f64))
}

/// `[0-9]+ (. [0-9]*)?` or `. [0-9]+`, then `([eE] [-+]? [0-9]+)?`.
fn is_decimal(word: &str) -> bool {
    let (mantissa, exponent) = match word.split_once(['e', 'E']) {
        Some((m, e)) => (m, Some(e.strip_prefix(['-', '+']).unwrap_or(e))),
        None => (word, None),
    };
    let digits = |s: &str| s.bytes().all(|b| b.is_ascii_digit());
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    digits(whole)
        && digits(fraction)
        && !(whole.is_empty() && fraction.is_empty())
        && exponent.is_none_or(|e| !e.is_empty() && digits(e))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(word: &str) -> Datum {
        resolve(word.to_owned())
    }

    #[test]
    fn numbers_of_the_core_schema() {
        for (word, value) in [
            ("0", 0.0),
            ("-12", -12.0),
            ("+3", 3.0),
            ("007", 7.0),
            ("0x1F", 31.0),
            ("0o17", 15.0),
            (".5", 0.5),
            ("5.", 5.0),
            ("1e3", 1000.0),
            ("-1.5E-2", -0.015),
            (".inf", f64::INFINITY),
            ("-.INF", f64::NEG_INFINITY),
        ] {
            assert_eq!(of(word), Datum::Number(value), "{word}");
        }
        assert!(matches!(of(".nan"), Datum::Number(v) if v.is_nan()));
    }

    #[test]
    fn words_that_only_look_like_something() {
        for word in [
            "yes", "no", "on", "off", "inf", "nan", "-.nan", "infinity", "1_000", "0b1", "-0x1", "0x", "0xg",
            "1e", "e1", ".", "-", "+", "1.2.3", "--1", "1,5", "0x+1", "nil", "tRUE",
        ] {
            assert_eq!(of(word), Datum::String(word.to_owned()));
        }
    }

    #[test]
    fn nothing_and_truth() {
        assert_eq!(of(""), Datum::Null);
        assert_eq!(of("~"), Datum::Null);
        assert_eq!(of("True"), Datum::Bool(true));
        assert_eq!(of("FALSE"), Datum::Bool(false));
    }
}
