//! MTL, the material libraries of OBJ.

use super::lines::{Lines, Statement, Warnings};
use crate::{Limits, ReadError};

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
    /// `d`, or 1 less `Tr`: 1 is opaque. Where a file has both, the later one counts.
    pub opacity: Option<f32>,
    /// `illum`: the number of an illumination model, 0 to 10.
    pub illumination: Option<u32>,
    /// `Pr`: the roughness of the physically based extension.
    pub roughness: Option<f32>,
    /// `Pm`: its metalness.
    pub metallic: Option<f32>,
}

/// The materials of a library in the order of the file, with their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MtlFile {
    /// Names and materials.
    pub materials: Vec<(String, MtlMaterial)>,
    /// What was passed over.
    pub warnings: Vec<String>,
}

/// Reads a material library.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<MtlFile, ReadError> {
    limits.check_bytes(bytes)?;
    let mut warnings = Warnings::default();
    let mut materials: Vec<(String, MtlMaterial)> = Vec::new();
    for statement in Lines::new(bytes) {
        if statement.keyword() == "newmtl" {
            materials.push((statement.name().to_string(), MtlMaterial::default()));
            continue;
        }
        let Some((name, material)) = materials.last_mut() else {
            let keyword = statement.keyword();
            return Err(ReadError::line(
                statement.line,
                format!("'{keyword}' comes before the first 'newmtl'"),
            ));
        };
        set(material, name, &statement, &mut warnings)?;
    }
    Ok(MtlFile { materials, warnings: warnings.finish() })
}

fn set(
    material: &mut MtlMaterial,
    name: &str,
    statement: &Statement,
    warnings: &mut Warnings,
) -> Result<(), ReadError> {
    let number = || statement.numbers::<1>().map(|[number]| Some(number));
    let line = statement.line;
    let keyword = statement.keyword();
    match keyword {
        "Kd" => material.diffuse = colour(statement, warnings)?,
        "Ks" => material.specular = colour(statement, warnings)?,
        "Ke" => material.emission = colour(statement, warnings)?,
        "Tf" => material.transmission = colour(statement, warnings)?,
        "Ns" => material.shininess = number()?,
        "Ni" => material.ior = number()?,
        "Pr" => material.roughness = number()?,
        "Pm" => material.metallic = number()?,
        // `d -halo f` fades towards the silhouette: its number is taken as it is.
        "d" => {
            let word = statement.words().find(|word| *word != "-halo");
            let word = word.ok_or_else(|| ReadError::line(line, "'d' needs a number"))?;
            material.opacity = Some(statement.number(word)?);
        }
        "Tr" => material.opacity = number()?.map(|transparency| 1.0 - transparency),
        "illum" => material.illumination = number()?.map(|model| model as u32),
        // Ambient light is no part of light transport; Kt is an old name that nobody defines.
        "Ka" | "Kt" | "sharpness" => {}
        "bump" | "norm" | "disp" | "decal" | "refl" => map_warning(keyword, name, line, warnings),
        map if map.starts_with("map_") => map_warning(keyword, name, line, warnings),
        unknown => warnings
            .once(unknown, || format!("line {line}: '{unknown}' is not known and has no effect ('{name}')")),
    }
    Ok(())
}

fn map_warning(map: &str, name: &str, line: usize, warnings: &mut Warnings) {
    warnings.once(map, || {
        format!("line {line}: texture maps are not supported yet: '{map}' has no effect ('{name}')")
    });
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
        _ if statement.words().count() == 1 => Ok(Some([statement.numbers::<1>()?[0]; 3])),
        _ => statement.numbers().map(Some),
    }
}
