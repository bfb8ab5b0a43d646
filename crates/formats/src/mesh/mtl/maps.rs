//! The pictures that materials of MTL files are read off: `map_Kd -s 2 2 wood.png` and the like.

use std::iter::Peekable;

use crate::mesh::lines::{Statement, Warnings, bare};
use crate::number;
use crate::read_error::quoted;

/// What of a material is read off a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MtlUse {
    /// `map_Kd`, times `Kd`.
    Diffuse,
    /// `map_Ks`, times `Ks`.
    Specular,
    /// `map_Ke`, times `Ke`.
    Emission,
    /// `map_Ns`, times `Ns`.
    Shininess,
    /// `map_d`, times `d`.
    Dissolve,
    /// `map_Pr`, times `Pr`.
    Roughness,
    /// `map_Pm`, times `Pm`.
    Metallic,
    /// `map_Ps`, times `Ps`.
    Sheen,
    /// `map_Pc`, times `Pc`.
    Clearcoat,
    /// `map_Pcr`, times `Pcr`.
    ClearcoatRoughness,
    /// `bump` or `map_bump`: heights, or normals all the same.
    Bump,
    /// `norm`: normals.
    Normal,
}

/// One number of a picture, by `-imfchan`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MtlChannel {
    /// `r`.
    Red,
    /// `g`.
    Green,
    /// `b`.
    Blue,
    /// `m`, the matte.
    Alpha,
    /// `l`.
    Luminance,
}

/// A picture, and how it lies on the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct MtlMap {
    /// As the file names it.
    pub file: String,
    /// `-s`: what texture coordinates are multiplied by.
    pub scale: [f32; 2],
    /// `-o`: what is added to them then.
    pub offset: [f32; 2],
    /// `-clamp on`: whether it is there once only.
    pub is_clamped: bool,
    /// `-bm`: what heights are multiplied by.
    pub bump: f32,
    /// `-mm`: what is added to its numbers, and what they are multiplied by before.
    pub range: [f32; 2],
    /// `-imfchan`: which of its numbers is taken.
    pub channel: Option<MtlChannel>,
}

impl Default for MtlMap {
    fn default() -> Self {
        Self {
            file: String::new(),
            scale: [1.0; 2],
            offset: [0.0; 2],
            is_clamped: false,
            bump: 1.0,
            range: [0.0, 1.0],
            channel: None,
        }
    }
}

/// The uses of a statement's picture, each with the number that it takes where the statement says no other; `None` if it has no picture that is
/// understood.
pub(super) fn uses(keyword: &str) -> Option<&'static [(MtlUse, Option<MtlChannel>)]> {
    use MtlChannel::{Blue, Green, Red};
    Some(match keyword.to_ascii_lowercase().as_str() {
        "map_kd" => &[(MtlUse::Diffuse, None)],
        "map_ks" => &[(MtlUse::Specular, None)],
        "map_ke" => &[(MtlUse::Emission, None)],
        "map_ns" => &[(MtlUse::Shininess, None)],
        "map_d" => &[(MtlUse::Dissolve, None)],
        "map_pr" => &[(MtlUse::Roughness, None)],
        "map_pm" => &[(MtlUse::Metallic, None)],
        "map_ps" => &[(MtlUse::Sheen, None)],
        "map_pc" => &[(MtlUse::Clearcoat, None)],
        "map_pcr" => &[(MtlUse::ClearcoatRoughness, None)],
        "bump" | "map_bump" => &[(MtlUse::Bump, None)],
        "norm" | "map_norm" | "map_kn" => &[(MtlUse::Normal, None)],
        // Packed: roughness, metalness and ambient occlusion, or the last of them first. Occlusion is no part of light transport.
        "map_rma" => &[(MtlUse::Roughness, Some(Red)), (MtlUse::Metallic, Some(Green))],
        "map_orm" => &[(MtlUse::Roughness, Some(Green)), (MtlUse::Metallic, Some(Blue))],
        _ => return None,
    })
}

/// The picture of a statement and its options, which may stand before and behind its name; `None` after a warning.
pub(super) fn read(statement: &Statement, material: &str, warnings: &mut Warnings) -> Option<MtlMap> {
    let text = bare(statement.name());
    let (line, keyword) = (statement.line, statement.keyword());
    let mut map = MtlMap::default();
    // From the first word of the name to the end of the last.
    let mut name: Option<(usize, usize)> = None;
    let place = |word: &str| word.as_ptr() as usize - text.as_ptr() as usize;
    let mut words = text.split_ascii_whitespace().peekable();
    while let Some(word) = words.next() {
        let mut ignored = |what: &str| {
            warnings.once(&format!("{keyword} {what}"), || {
                let material = quoted(material.as_bytes());
                format!(
                    "line {line}: the option {what} of {} has no effect ({material})",
                    quoted(keyword.as_bytes())
                )
            });
        };
        match word.to_ascii_lowercase().as_str() {
            "-s" => map.scale = pair(&mut words, 1.0),
            "-o" => map.offset = pair(&mut words, 0.0),
            "-mm" => map.range = two(&mut words, [0.0, 1.0]),
            "-bm" => map.bump = numbers::<1>(&mut words)[0].unwrap_or(1.0),
            "-clamp" => map.is_clamped = words.next().is_some_and(|word| word.eq_ignore_ascii_case("on")),
            "-imfchan" => match words.next().unwrap_or_default().to_ascii_lowercase().as_str() {
                "r" => map.channel = Some(MtlChannel::Red),
                "g" => map.channel = Some(MtlChannel::Green),
                "b" => map.channel = Some(MtlChannel::Blue),
                "m" => map.channel = Some(MtlChannel::Alpha),
                "l" => map.channel = Some(MtlChannel::Luminance),
                _ => ignored("-imfchan"),
            },
            // Pictures are read between their pixels, and sharpened never.
            "-blendu" | "-blendv" => {
                if words.next().is_some_and(|word| word.eq_ignore_ascii_case("off")) {
                    ignored("-blendu off");
                }
            }
            "-cc" => {
                if words.next().is_some_and(|word| word.eq_ignore_ascii_case("on")) {
                    ignored("-cc");
                }
            }
            "-t" => {
                if numbers::<3>(&mut words).iter().flatten().any(|v| *v != 0.0) {
                    ignored("-t (turbulence)");
                }
            }
            option @ ("-boost" | "-texres") => {
                words.next();
                ignored(option);
            }
            "-type" => {
                words.next();
            }
            _ => {
                let (start, end) = (place(word), place(word) + word.len());
                name = Some((name.map_or(start, |(first, _)| first), end));
            }
        }
    }
    let file = name.map_or("", |(start, end)| bare(&text[start..end]));
    if file.is_empty() {
        warnings.once(&format!("{keyword} nothing"), || {
            format!("line {line}: {} names no picture", quoted(keyword.as_bytes()))
        });
        return None;
    }
    map.file = file.to_owned();
    Some(map)
}

/// As many numbers as follow, at most `N`; what isn't finite is none.
fn numbers<'a, const N: usize>(words: &mut Peekable<impl Iterator<Item = &'a str>>) -> [Option<f32>; N] {
    let mut out = [None; N];
    for number in &mut out {
        let Some(v) = words.peek().and_then(|word| number::single(word)) else { break };
        words.next();
        *number = Some(v).filter(|v| v.is_finite());
    }
    out
}

/// Those of u and v; that of w is passed over.
fn pair<'a>(words: &mut Peekable<impl Iterator<Item = &'a str>>, absent: f32) -> [f32; 2] {
    let [u, v, _] = numbers::<3>(words);
    [u.unwrap_or(absent), v.unwrap_or(absent)]
}

fn two<'a>(words: &mut Peekable<impl Iterator<Item = &'a str>>, absent: [f32; 2]) -> [f32; 2] {
    let [a, b] = numbers::<2>(words);
    [a.unwrap_or(absent[0]), b.unwrap_or(absent[1])]
}
