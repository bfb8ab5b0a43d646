//! From the codes of a PNG to light: which of its chunks says how they were encoded, and what it says.
//!
//! After *Portable Network Graphics*, third edition (W3C 2025), 4.3: the first of `cICP`, `iCCP`, `sRGB` that is there and
//! understood counts, else `gAMA` and `cHRM`; without any of them it is sRGB. Curves and primaries of `cICP` are those of
//! ITU-T H.273 (2021), tables 2 and 3.

use straal_color::{Chromaticity, RgbSpace, Space, White, srgb};
use straal_math::ops::{exp_d, ln_d, pow_d};

use super::icc::{Profile, Response};
use super::{Curve, Encoding};

/// How codes become light.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Light {
    /// Of red, green and blue; one for all where they are the same.
    responses: Vec<Response>,
    /// Whether codes from 16/255 to 235/255 are black to white, as in video.
    is_narrow: bool,
    /// The primaries, where the file says them.
    pub space: Option<RgbSpace>,
    pub encoding: Encoding,
    /// What couldn't be honoured.
    pub notes: Vec<String>,
}

/// Light that shows as white on paper, in cd/m² (ITU-R BT.2408): what 1 is in pictures of absolute luminance.
const REFERENCE_WHITE: f64 = 203.0;

impl Light {
    /// What a PNG's chunks say. `has_profile` tells whether there is an `iCCP`, readable or not.
    pub fn of(info: &png::Info<'_>, has_profile: bool) -> Self {
        let mut notes = Vec::new();
        let bits = if info.bit_depth == png::BitDepth::Sixteen { 16 } else { 8 };
        let encoding = |told: &str, curve| Encoding { bits, curve, told: told.to_owned() };
        if let Some(points) = info.coding_independent_code_points {
            match of_points(&points) {
                Ok((response, told, space)) => {
                    let curve = (response == Response::Srgb).then_some(Curve::Srgb);
                    return Self {
                        responses: vec![response],
                        is_narrow: !points.is_video_full_range_image,
                        space: Some(space),
                        encoding: encoding(told, curve),
                        notes,
                    };
                }
                Err(problem) => notes.push(format!("its cICP is not honoured: {problem}")),
            }
        }
        let plain =
            |responses, space, encoding, notes| Self { responses, is_narrow: false, space, encoding, notes };
        if has_profile {
            let bytes = info.icc_profile.as_deref();
            match bytes.ok_or("it is damaged").and_then(Profile::read) {
                Ok(Profile { responses, space }) => {
                    let told = encoding("the curve of its ICC profile", None);
                    return plain(responses, space, told, notes);
                }
                Err(problem) => notes.push(format!("its ICC profile is not honoured: {problem}")),
            }
        }
        if info.srgb.is_some() {
            let told = encoding("the curve of sRGB", Some(Curve::Srgb));
            return plain(vec![Response::Srgb], Some(Space::Srgb.rgb()), told, notes);
        }
        let space = info.chrm_chunk.and_then(|c| {
            let at = |(x, y): (png::ScaledFloat, png::ScaledFloat)| {
                let number = |v: png::ScaledFloat| f64::from(v.into_scaled()) / 1e5;
                Chromaticity { x: number(x), y: number(y) }
            };
            let space = RgbSpace { primaries: [c.red, c.green, c.blue].map(at), white: at(c.white) };
            let space = Some(space.recognised()).filter(RgbSpace::is_sound);
            if space.is_none() {
                notes.push("its cHRM makes no sense: the primaries of sRGB are taken".into());
            }
            space
        });
        let told = info.gama_chunk.map(|gama| 1e5 / f64::from(gama.into_scaled().max(1)));
        let sound = told.filter(|gamma| (0.05..=20.0).contains(gamma));
        if let (Some(gamma), None) = (told, sound) {
            notes
                .push(format!("its gAMA makes no sense (a gamma of {gamma:.4}): the curve of sRGB is taken"));
        }
        match sound {
            Some(gamma) => {
                let curve = Some(Curve::Gamma(gamma as f32));
                let told = encoding(&format!("a gamma of {}", (gamma * 1e4 + 0.5).floor() / 1e4), curve);
                plain(vec![Response::Power(gamma)], space, told, notes)
            }
            None => {
                let told =
                    if space.is_none() { "sRGB, as nothing else is said" } else { "the curve of sRGB" };
                plain(vec![Response::Srgb], space, encoding(told, Some(Curve::Srgb)), notes)
            }
        }
    }

    /// The light of every code, for red, green and blue; `codes` are 256 or 65,536.
    pub fn tables(&self, codes: usize) -> [Vec<f32>; 3] {
        let most = (codes - 1) as f64;
        let table = |response: &Response| -> Vec<f32> {
            let signal = |code: usize| {
                let v = code as f64 / most;
                // 16 and 235 of 255, or 4096 and 60160 of 65,535.
                let narrow = (v * most / (codes / 256) as f64 - 16.0) / 219.0;
                match narrow {
                    _ if !self.is_narrow => v,
                    narrow if narrow > 1.0 => 1.0,
                    narrow if narrow > 0.0 => narrow,
                    _ => 0.0,
                }
            };
            (0..codes).map(|code| response.light(signal(code)) as f32).collect()
        };
        match self.responses.as_slice() {
            [r, g, b] => [table(r), table(g), table(b)],
            [one, ..] => {
                let table = table(one);
                [table.clone(), table.clone(), table]
            }
            [] => [const { Vec::new() }; 3],
        }
    }
}

/// Curve, its name, and primaries of `cICP`.
fn of_points(
    points: &png::CodingIndependentCodePoints,
) -> Result<(Response, &'static str, RgbSpace), String> {
    if points.matrix_coefficients != 0 {
        return Err(format!("colours by matrix {} are no RGB", points.matrix_coefficients));
    }
    let (response, told) = match points.transfer_function {
        // The rounded constants of the older standards meet less well than these.
        1 | 6 | 11 | 12 | 14 | 15 => {
            (Response::Video { a: 1.099_296_826_809_442, slope: 4.5 }, "the curve of BT.709")
        }
        4 => (Response::Power(2.2), "a gamma of 2.2"),
        5 => (Response::Power(2.8), "a gamma of 2.8"),
        7 => (Response::Video { a: 1.111_572_195_921_731, slope: 4.0 }, "the curve of SMPTE 240M"),
        8 => (Response::Power(1.0), "no curve: codes are light"),
        9 => (Response::Log(2.0), "a logarithm of two decades"),
        10 => (Response::Log(2.5), "a logarithm of two and a half decades"),
        13 => (Response::Srgb, "the curve of sRGB"),
        16 => (Response::Pq, "PQ (SMPTE ST 2084), of which 203 cd/m2 are 1"),
        17 => (Response::Cinema, "the curve of SMPTE ST 428-1"),
        18 => (Response::Hlg, "HLG (ITU-R BT.2100), of which three quarters of the signal are 1"),
        other => return Err(format!("the curve {other} is none that straal knows")),
    };
    let at = |x: f64, y: f64| Chromaticity { x, y };
    let d65 = White::D65.chromaticity();
    let c = at(0.31, 0.316);
    let (primaries, white) = match points.color_primaries {
        1 => return Ok((response, told, Space::Srgb.rgb())),
        4 => ([at(0.67, 0.33), at(0.21, 0.71), at(0.14, 0.08)], c),
        5 => ([at(0.64, 0.33), at(0.29, 0.6), at(0.15, 0.06)], d65),
        6 | 7 => ([at(0.63, 0.34), at(0.31, 0.595), at(0.155, 0.07)], d65),
        8 => ([at(0.681, 0.319), at(0.243, 0.692), at(0.145, 0.049)], c),
        9 => return Ok((response, told, Space::Rec2020.rgb())),
        10 => return Ok((response, told, RgbSpace::XYZ)),
        11 => ([at(0.68, 0.32), at(0.265, 0.69), at(0.15, 0.06)], at(0.314, 0.351)),
        12 => return Ok((response, told, Space::DisplayP3.rgb())),
        22 => ([at(0.63, 0.34), at(0.295, 0.605), at(0.155, 0.077)], d65),
        other => return Err(format!("the primaries {other} are none that straal knows")),
    };
    Ok((response, told, RgbSpace { primaries, white }))
}

impl Response {
    /// The light of a signal from 0 to 1.
    fn light(&self, v: f64) -> f64 {
        let pow = |x: f64, y: f64| if x > 0.0 { pow_d(x, y) } else { 0.0 };
        match *self {
            Self::Srgb => f64::from(srgb::decode(v as f32)),
            Self::Power(gamma) => {
                if gamma == 1.0 {
                    v
                } else {
                    pow(v, gamma)
                }
            }
            Self::Video { a, slope } => {
                // The power's end, where the line meets it.
                let line = v / slope;
                let curve = pow((v + a - 1.0) / a, 1.0 / 0.45);
                if line < video_edge(a, slope) { line } else { curve }
            }
            Self::Log(decades) => {
                if v > 0.0 {
                    exp_d((v - 1.0) * decades * std::f64::consts::LN_10)
                } else {
                    0.0
                }
            }
            Self::Pq => {
                let (m1, m2) = (2610.0 / 16384.0, 2523.0 / 32.0);
                let (c1, c2, c3) = (3424.0 / 4096.0, 2413.0 / 128.0, 2392.0 / 128.0);
                let root = pow(v, 1.0 / m2);
                10_000.0 / REFERENCE_WHITE * pow((root - c1) / (c2 - c3 * root), 1.0 / m1)
            }
            Self::Hlg => hlg(v) / hlg(0.75),
            Self::Cinema => pow(v, 2.6) * 52.37 / 48.0,
            Self::Table(ref table) => {
                let place = v * (table.len() - 1) as f64;
                let low = place as usize;
                let at = |i: usize| f64::from(table[i.min(table.len() - 1)]) / 65_535.0;
                at(low) + (at(low + 1) - at(low)) * (place - low as f64)
            }
            Self::Parametric([g, a, b, c, d, e, f]) => {
                if v >= d {
                    pow(a * v + b, g) + e
                } else {
                    c * v + f
                }
            }
        }
    }
}

/// The light at which the line of a camera's curve meets its power.
fn video_edge(a: f64, slope: f64) -> f64 {
    // Both have the same slope there: slope = 0.45 a L^-0.55.
    exp_d(ln_d(0.45 * a / slope) / 0.55)
}

/// Light of the scene from 0 to 1 (ITU-R BT.2100, table 5).
fn hlg(v: f64) -> f64 {
    let a = 0.178_832_77;
    let (b, c) = (1.0 - 4.0 * a, 0.5 - a * ln_d(4.0 * a));
    if v <= 0.5 { v * v / 3.0 } else { (exp_d((v - c) / a) + b) / 12.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_have_the_values_that_the_standards_print() {
        for (response, signal, light) in [
            (Response::Pq, 0.508_078, 100.0 / 203.0),
            (Response::Pq, 1.0, 10_000.0 / 203.0),
            (Response::Pq, 0.0, 0.0),
            (Response::Hlg, 0.5, 1.0 / 12.0 / 0.264_962_56),
            (Response::Hlg, 0.75, 1.0),
            (Response::Video { a: 1.099_296_826_809_442, slope: 4.5 }, 0.408_849, 0.18),
            (Response::Video { a: 1.099_296_826_809_442, slope: 4.5 }, 0.045, 0.01),
            (Response::Log(2.0), 0.5, 0.1),
            (Response::Cinema, 1.0, 52.37 / 48.0),
            (Response::Power(2.2), 0.5, 0.217_637_6),
            (Response::Table(vec![0, 65_535, 0]), 0.75, 0.5),
            (Response::Parametric([2.0, 0.5, 0.5, 0.1, 0.5, 0.25, 0.0]), 1.0, 1.25),
            (Response::Parametric([2.0, 0.5, 0.5, 0.1, 0.5, 0.25, 0.0]), 0.25, 0.025),
        ] {
            let got = response.light(signal);
            assert!((got - light).abs() < 2e-5 * (1.0 + light), "{response:?} {signal}: {got}, not {light}");
        }
        // Line and power meet without a step.
        for (a, slope) in [(1.099_296_826_809_442, 4.5), (1.111_572_195_921_731, 4.0)] {
            let edge = slope * video_edge(a, slope);
            let curve = Response::Video { a, slope };
            assert!((curve.light(edge + 1e-9) - curve.light(edge - 1e-9)).abs() < 1e-7);
        }
    }

    #[test]
    fn points_are_those_of_the_standard() {
        let points =
            |color_primaries, transfer_function, matrix_coefficients| png::CodingIndependentCodePoints {
                color_primaries,
                transfer_function,
                matrix_coefficients,
                is_video_full_range_image: true,
            };
        let (response, _, space) = of_points(&points(12, 13, 0)).unwrap();
        assert_eq!((response, space), (Response::Srgb, Space::DisplayP3.rgb()));
        for known in (0..=255).filter(|p| of_points(&points(*p, 8, 0)).is_ok()) {
            let (_, _, space) = of_points(&points(known, 8, 0)).unwrap();
            assert!(space.is_sound() && matches!(known, 1 | 4..=12 | 22), "{known}");
        }
        for wrong in [points(2, 13, 0), points(1, 2, 0), points(1, 13, 1)] {
            assert!(of_points(&wrong).is_err());
        }
    }
}
