//! sRGB's transfer function (IEC 61966-2-1) for pictures that are read.

/// Linear light of every code of a picture with `codes` levels (256 or 65,536).
///
/// The power 2.4 is y² times the fifth root of y², and the root is found by Newton's method, so that only exactly
/// rounded operations take part and the table has the same bits on every machine.
pub(crate) fn decode_table(codes: usize) -> Vec<f32> {
    (0..codes).map(|code| decode(code as f64 / (codes - 1) as f64) as f32).collect()
}

fn decode(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        return encoded / 12.92;
    }
    let y = (encoded + 0.055) / 1.055;
    let square = y * y;
    // From above the root the iteration falls until it stands still, within an ulp of the root.
    let mut root = 1.0;
    loop {
        let next = (4.0 * root + square / (root * root * root * root)) / 5.0;
        if next >= root {
            return square * root;
        }
        root = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        // Ends, the grey of half the codes, and the middle of the linear part; to 1e-7 by hand calculation.
        assert_eq!(decode(0.0), 0.0);
        assert_eq!(decode(1.0), 1.0);
        assert!((decode(0.5) - 0.214_041_14).abs() < 1e-8);
        assert!((decode(128.0 / 255.0) - 0.215_860_5).abs() < 1e-7);
        assert!((decode(10.0 / 255.0) - 0.003_035_27).abs() < 1e-8);
        let table = decode_table(65536);
        assert!(table.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
