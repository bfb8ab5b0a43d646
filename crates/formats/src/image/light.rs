//! From the codes of a picture to light.

use std::sync::Arc;

use straal_color::{RgbSpace, Space, srgb};
use straal_math::ops::{exp_d, ln_d, pow_d};
use straal_scene::bitmap;

use super::icc::{Profile, Response};
use super::png::{Curve, Encoding};

/// How codes become light.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Light {
    /// Of red, green and blue; one for all where they are the same.
    pub responses: Vec<Response>,
    /// Whether codes from 16/255 to 235/255 are black to white, as in video.
    pub is_narrow: bool,
    /// The primaries, where the file says them.
    pub space: Option<RgbSpace>,
    pub encoding: Encoding,
    /// What couldn't be honoured.
    pub notes: Vec<String>,
}

/// Light that shows as white on paper, in cd/m² (ITU-R BT.2408): what 1 is in pictures of absolute luminance.
const REFERENCE_WHITE: f64 = 203.0;

impl Light {
    /// Of pictures of 8 bits: by an ICC profile, if there is one and it is understood, else sRGB.
    pub fn of_profile(profile: Option<&[u8]>) -> Self {
        let encoding = |told: &str, curve| Encoding { bits: 8, curve, told: told.to_owned() };
        let mut light = Self {
            responses: vec![Response::Srgb],
            is_narrow: false,
            space: None,
            encoding: encoding("sRGB, as nothing else is said", Some(Curve::Srgb)),
            notes: Vec::new(),
        };
        match profile.map(Profile::read) {
            Some(Ok(Profile { responses, space })) => {
                let encoding = encoding("the curve of its ICC profile", None);
                light = Self { responses, space, encoding, ..light };
            }
            Some(Err(problem)) => light.notes.push(format!("its ICC profile is not honoured: {problem}")),
            None => {}
        }
        light
    }

    /// How a texture takes codes: tables of their light. The space is left out where it is sRGB.
    pub fn of_codes(&self, codes: usize) -> (bitmap::Response, Option<RgbSpace>) {
        let space = self.space.filter(|space| *space != Space::Srgb.rgb());
        let [r, g, b] = self.tables(codes);
        let is_light = [&r, &g, &b]
            .iter()
            .all(|t| t.iter().enumerate().all(|(code, v)| *v == (code as f64 / (codes - 1) as f64) as f32));
        if is_light {
            return (bitmap::Response::Linear, space);
        }
        let red: Arc<[f32]> = r.into();
        let other = |table: Vec<f32>| if *table == *red { red.clone() } else { table.into() };
        let (green, blue) = (other(g), other(b));
        (bitmap::Response::Table([red, green, blue]), space)
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
}
