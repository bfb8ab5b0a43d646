//! Which chunk of a PNG says how its codes were encoded, and what it says.
//!
//! After *Portable Network Graphics*, third edition (W3C 2025), 4.3: the first of `cICP`, `iCCP`, `sRGB` that is there and
//! understood counts, else `gAMA` and `cHRM`; without any of them it is sRGB. Curves and primaries of `cICP` are those of
//! ITU-T H.273 (2021), tables 2 and 3.

use straal_color::{Chromaticity, RgbSpace, Space, White};

use super::{Curve, Encoding};
use crate::image::icc::{Profile, Response};
use crate::image::light::Light;

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

#[cfg(test)]
mod tests {
    use super::*;

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
