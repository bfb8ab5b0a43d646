//! MTL, the material libraries of OBJ.

use std::collections::BTreeMap;

use super::lines::{Lines, Statement, Warnings};
use crate::read_error::quoted;
use crate::{Limits, ReadError};

mod maps;

pub use maps::{MtlChannel, MtlMap, MtlUse};

/// A material as the file has it: what isn't given is `None`. What it means as a BSDF is for the scene to say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MtlMaterial {
    /// `Kd`: the diffuse reflectance.
    pub diffuse: Option<[f32; 3]>,
    /// `Ks`: the specular reflectance.
    pub specular: Option<[f32; 3]>,
    /// `Ke`: the radiance that it emits.
    pub emission: Option<[f32; 3]>,
    /// `Tf`: the colour of light that goes through.
    pub transmission: Option<[f32; 3]>,
    /// `Ns`: the Phong exponent, 0 to 1000 as a rule.
    pub shininess: Option<f32>,
    /// `Ni`: the index of refraction.
    pub ior: Option<f32>,
    /// `d`, the dissolve: 1 is opaque, and of light on a surface of 0.3 as much as 0.7 passes straight on.
    pub dissolve: Option<f32>,
    /// `Tr`: by the letter 1 less `d`, but many programs write 1 where they mean opaque.
    pub transparency: Option<f32>,
    /// `illum`: the number of an illumination model, 0 to 10.
    pub illumination: Option<u32>,
    /// `Pr`: the roughness of the physically based extension.
    pub roughness: Option<f32>,
    /// `Pm`: its metalness.
    pub metallic: Option<f32>,
    /// `Ps`: its sheen.
    pub sheen: Option<f32>,
    /// `Pc`: how much of its clear coat there is.
    pub clearcoat: Option<f32>,
    /// `Pcr`: the roughness of that.
    pub clearcoat_roughness: Option<f32>,
    /// `aniso`: its anisotropy.
    pub anisotropy: Option<f32>,
    /// What is read off pictures, each at most once.
    pub maps: BTreeMap<MtlUse, MtlMap>,
}

/// The materials of a library in the order of the file, with their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MtlFile {
    /// Names as the file has them, quotes and comments included, and materials.
    pub materials: Vec<(String, MtlMaterial)>,
    /// What was passed over.
    pub warnings: Vec<String>,
}

/// Reads a material library. What comes before its first `newmtl` belongs to no material; a file that has none may be any
/// file, and nothing of it is told but that.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<MtlFile, ReadError> {
    limits.check_bytes(bytes)?;
    let mut warnings = Warnings::default();
    let mut materials: Vec<(String, MtlMaterial)> = Vec::new();
    let mut stray = None;
    let mut lines = Lines::new(bytes);
    while let Some(statement) = lines.next() {
        if statement.keyword() == "newmtl" {
            lines.is_trusted = true;
            materials.push((statement.name().to_string(), MtlMaterial::default()));
            continue;
        }
        match materials.last_mut() {
            Some((name, material)) => set(material, name, &statement, &mut warnings)?,
            None => stray = stray.or(Some(statement.line)),
        }
    }
    match stray {
        _ if materials.is_empty() => {
            warnings.once("newmtl", || "it holds no material: no line begins with 'newmtl'".to_owned());
        }
        Some(line) => warnings.once("newmtl", || {
            format!(
                "line {line}: what comes before the first 'newmtl' belongs to no material and has no effect"
            )
        }),
        None => {}
    }
    Ok(MtlFile { materials, warnings: warnings.finish() })
}

fn set(
    material: &mut MtlMaterial,
    name: &str,
    statement: &Statement,
    warnings: &mut Warnings,
) -> Result<(), ReadError> {
    let line = statement.line;
    let keyword = statement.keyword();
    match keyword {
        "Kd" => keep(&mut material.diffuse, colour(statement, warnings)?),
        "Ks" => keep(&mut material.specular, colour(statement, warnings)?),
        "Ke" => keep(&mut material.emission, colour(statement, warnings)?),
        "Tf" => keep(&mut material.transmission, colour(statement, warnings)?),
        "Ns" => keep(&mut material.shininess, number(statement, warnings)?),
        "Ni" => keep(&mut material.ior, number(statement, warnings)?),
        "Pr" => keep(&mut material.roughness, number(statement, warnings)?),
        "Pm" => keep(&mut material.metallic, number(statement, warnings)?),
        "Ps" => keep(&mut material.sheen, number(statement, warnings)?),
        "Pc" => keep(&mut material.clearcoat, number(statement, warnings)?),
        "Pcr" => keep(&mut material.clearcoat_roughness, number(statement, warnings)?),
        "aniso" => keep(&mut material.anisotropy, number(statement, warnings)?),
        // `d -halo f` fades towards the silhouette: its number is taken as it is.
        "d" => {
            let word = statement.words().find(|word| *word != "-halo");
            let word = word.ok_or_else(|| ReadError::line(line, "'d' needs a number"))?;
            let [dissolve] =
                finite(statement, [statement.number(word)?], warnings).map_or([None], |v| v.map(Some));
            keep(&mut material.dissolve, dissolve);
        }
        "Tr" => keep(&mut material.transparency, number(statement, warnings)?),
        "illum" => keep(&mut material.illumination, number(statement, warnings)?.map(|model| model as u32)),
        // Ambient light is no part of light transport; Kt is an old name that nobody defines; edges are always smoothed.
        "Ka" | "Kt" | "sharpness" | "map_Ka" | "map_aat" => {}
        "disp" | "decal" | "refl" => map_warning(keyword, name, line, warnings),
        map => match maps::uses(map) {
            Some(uses) => {
                if let Some(map) = maps::read(statement, name, warnings) {
                    for (of, channel) in uses {
                        let channel = channel.or(map.channel);
                        material.maps.insert(*of, MtlMap { channel, ..map.clone() });
                    }
                }
            }
            None if map.starts_with("map_") => map_warning(keyword, name, line, warnings),
            None => warnings.once(map, || {
                let (unknown, name) = (quoted(map.as_bytes()), quoted(name.as_bytes()));
                format!("line {line}: {unknown} is not known and has no effect ({name})")
            }),
        },
    }
    Ok(())
}

/// Where a material says something twice, the later one counts; what was no number says nothing.
fn keep<T>(value: &mut Option<T>, said: Option<T>) {
    if said.is_some() {
        *value = said;
    }
}

fn map_warning(map: &str, name: &str, line: usize, warnings: &mut Warnings) {
    warnings.once(map, || {
        let (map, name) = (quoted(map.as_bytes()), quoted(name.as_bytes()));
        format!("line {line}: pictures for {map} are not supported and have no effect ({name})")
    });
}

fn number(statement: &Statement, warnings: &mut Warnings) -> Result<Option<f32>, ReadError> {
    Ok(finite(statement, statement.numbers::<1>()?, warnings).map(|[number]| number))
}

/// Three numbers, or one for grey. Spectral curves and XYZ are passed over with a warning.
fn colour(statement: &Statement, warnings: &mut Warnings) -> Result<Option<[f32; 3]>, ReadError> {
    match statement.words().next() {
        Some(kind @ ("spectral" | "xyz")) => {
            let (line, keyword) = (statement.line, statement.keyword());
            warnings.once(&format!("{keyword} {kind}"), || {
                format!("line {line}: '{keyword} {kind}' is not supported and has no effect")
            });
            Ok(None)
        }
        _ if statement.words().count() == 1 => {
            Ok(finite(statement, statement.numbers::<1>()?, warnings).map(|[grey]| [grey; 3]))
        }
        _ => Ok(finite(statement, statement.numbers::<3>()?, warnings)),
    }
}

/// Numbers that are all finite; what is infinite or NaN is told and left out.
fn finite<const N: usize>(
    statement: &Statement,
    numbers: [f32; N],
    warnings: &mut Warnings,
) -> Option<[f32; N]> {
    if numbers.iter().all(|v| v.is_finite()) {
        return Some(numbers);
    }
    let (line, keyword) = (statement.line, statement.keyword());
    warnings.once(&format!("{keyword} finite"), || {
        format!("line {line}: '{keyword}' is not a finite number and has no effect")
    });
    None
}
