//! The sRGB transfer curve (IEC 61966-2-1).

use straal_math::ops;

/// Linear light in [0, 1] to the signal in [0, 1]; what is beyond goes to the nearer end, NaN to 0.
pub fn encode(linear: f32) -> f32 {
    let v = ops::clamp(linear, 0.0, 1.0);
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * ops::pow(v, 1.0 / 2.4) - 0.055 }
}

/// The signal in [0, 1] to linear light.
pub fn decode(signal: f32) -> f32 {
    let v = ops::clamp(signal, 0.0, 1.0);
    if v <= 0.040_45 { v / 12.92 } else { ops::pow((v + 0.055) / 1.055, 2.4) }
}

/// Linear light to an eight-bit signal, rounded to nearest.
pub fn encode_u8(linear: f32) -> u8 {
    (encode(linear) * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_eight_bit_value_survives_the_round_trip() {
        for i in 0..=255_u8 {
            assert_eq!(encode_u8(decode(f32::from(i) / 255.0)), i);
        }
    }

    #[test]
    fn middle_grey_is_where_the_standard_puts_it() {
        assert!((encode(0.18) - 0.461_356).abs() < 1e-5);
        assert_eq!(encode_u8(f32::NAN), 0);
        assert_eq!(encode_u8(f32::INFINITY), 255);
    }
}
