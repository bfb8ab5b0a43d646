//! A mesh file of any kind that straal reads, with the materials that came with it.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use straal_scene::desc::{Conductor, Dielectric, Diffuse, Material, Mirror, Spectrum};
use straal_scene::value::{Color, Value};
use straal_scene::{MeshAsset, PartMaterial};

use crate::load::check_file;
use crate::mesh::mtl::MtlMaterial;
use crate::{Limits, ReadError, mesh};

/// What a mesh file holds.
#[derive(Clone, Debug, Default)]
pub struct MeshFile {
    /// The mesh and its materials.
    pub asset: MeshAsset,
    /// What was passed over.
    pub warnings: Vec<String>,
    /// BLAKE3 of the file and of the material libraries that it names.
    pub hash: [u8; 32],
}

/// Reads the bytes of a mesh file; `path` tells its kind, and where the material libraries are that it names.
pub fn read(path: &Path, bytes: &[u8], limits: &Limits) -> Result<MeshFile, ReadError> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(bytes);
    if bytes.starts_with(b"ply") {
        let mesh = Arc::new(mesh::ply::read(bytes, limits)?);
        let asset = MeshAsset { mesh, ..MeshAsset::default() };
        return Ok(MeshFile { asset, warnings: Vec::new(), hash: hasher.finalize().into() });
    }
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    if extension.as_deref() != Some("obj") {
        let found = extension.map(|e| format!(", found .{e}")).unwrap_or_default();
        return Err(ReadError::file(format!("a mesh must be a .ply or .obj file{found}")));
    }
    let mut library = |name: &str| {
        let path = path.parent()?.join(name);
        check_file(&path, limits.max_bytes).ok()?;
        let bytes = std::fs::read(path).ok()?;
        hasher.update(&bytes);
        Some(bytes)
    };
    let file = mesh::obj::read(bytes, limits, &mut library)?;
    let mut warnings = file.warnings;
    let mut materials = BTreeMap::new();
    for (name, m) in &file.materials {
        let (material, warning) = nearest(m);
        let emission = m.emission.map(|e| e.map(positive)).filter(|e| *e != [0.0; 3]).map(Color);
        warnings.extend(warning.map(|w| format!("material '{name}': {w}")));
        materials.insert(name.clone(), PartMaterial { material, emission });
    }
    let asset = MeshAsset { mesh: Arc::new(file.mesh), materials: Arc::new(materials) };
    Ok(MeshFile { asset, warnings, hash: hasher.finalize().into() })
}

/// The extension of a mesh file that has lost its name, by how it begins; `None` when it is no mesh.
pub fn kind_of(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        return Some("ply");
    }
    const WORDS: [&str; 11] = ["v", "vn", "vt", "f", "o", "g", "s", "l", "mtllib", "usemtl", "vp"];
    const MOST: usize = 4096;
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(MOST)]);
    let said = start.lines().map(str::trim).find(|l| !l.is_empty() && !l.starts_with('#'))?;
    let (word, rest) = said.split_once([' ', '\t'])?;
    (WORDS.contains(&word) && !rest.trim_start().starts_with(':')).then_some("obj")
}

/// The material that comes nearest to what an MTL file means, and what is lost by it.
///
/// The illumination models are those of the MTL specification (Wavefront, 1995): 4, 6, 7 and 9 are transparent, 3 and
/// 5 reflect like a mirror. `Pm` and `Pr` are the metalness and roughness of the physically based extension, where
/// alpha is the roughness squared.
fn nearest(m: &MtlMaterial) -> (Material, Option<&'static str>) {
    let diffuse = m.diffuse.map_or([0.5; 3], |c| c.map(share));
    let specular = m.specular.map_or([0.0; 3], |c| c.map(share));
    let illumination = m.illumination.unwrap_or(0);
    let opacity = m.opacity.map_or(1.0, share);
    if matches!(illumination, 4 | 6 | 7 | 9) || opacity < 0.5 {
        // 1 is the format's way to leave the index out: such glass could not be seen.
        let eta = m.ior.map(f64::from).filter(|n| (1.001..=10.0).contains(n)).unwrap_or(1.5);
        let tint = m.transmission.map(|c| c.map(share)).filter(|c| *c != [0.0; 3]).unwrap_or([1.0; 3]);
        let transmittance = Value::Constant(Color(tint).into());
        return (
            Material::Dielectric(Dielectric { eta: eta.into(), transmittance, ..Dielectric::default() }),
            None,
        );
    }
    if m.metallic.is_some_and(|m| m >= 0.5) {
        let roughness = m.roughness.map_or(0.0, share);
        // An index of 0 + i reflects everything at every angle, so that the tint alone tells the metal's colour.
        let metal = Conductor {
            metal: None,
            eta: Some(Value::Constant(Spectrum::grey(0.0))),
            k: Some(Value::Constant(Spectrum::grey(1.0))),
            roughness: Value::Constant(roughness * roughness),
            reflectance: Value::Constant(Color(diffuse).into()),
            two_sided: true,
        };
        return (Material::Conductor(metal), None);
    }
    let sum = |c: [f64; 3]| c[0] + c[1] + c[2];
    if matches!(illumination, 3 | 5) && sum(specular) > sum(diffuse) {
        let mirror = Mirror { reflectance: Value::Constant(Color(specular).into()), ..Mirror::default() };
        return (Material::Mirror(mirror), None);
    }
    let glossy = illumination >= 2 && sum(specular) > 0.0;
    let lost = if opacity < 1.0 {
        Some("it is partly see-through ('d'), but is shown as opaque")
    } else if glossy {
        Some("its highlights ('Ks') are left out, it is shown as diffuse")
    } else {
        None
    };
    (
        Material::Diffuse(Diffuse {
            reflectance: Value::Constant(Color(diffuse).into()),
            ..Diffuse::default()
        }),
        lost,
    )
}

/// A share of light, from 0 to 1; NaN is 0.
fn share(v: f32) -> f64 {
    let v = positive(v);
    if v < 1.0 { v } else { 1.0 }
}

/// A finite number that isn't negative; NaN is 0.
fn positive(v: f32) -> f64 {
    if v > 0.0 { f64::from(if v < f32::MAX { v } else { f32::MAX }) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mtl_means_the_nearest_material() {
        let glass = MtlMaterial { illumination: Some(7), ior: Some(1.33), ..MtlMaterial::default() };
        assert!(
            matches!(nearest(&glass).0, Material::Dielectric(d) if matches!(d.eta, straal_scene::desc::Index::Constant(n) if (n - 1.33).abs() < 1e-6))
        );
        let mirror = MtlMaterial {
            illumination: Some(3),
            diffuse: Some([0.0; 3]),
            specular: Some([0.9; 3]),
            ..MtlMaterial::default()
        };
        assert!(matches!(nearest(&mirror).0, Material::Mirror(_)));
        let metal = MtlMaterial {
            metallic: Some(1.0),
            roughness: Some(0.5),
            diffuse: Some([1.0, 0.5, 0.25]),
            ..MtlMaterial::default()
        };
        let Material::Conductor(c) = nearest(&metal).0 else { panic!("not a metal") };
        assert_eq!(c.roughness.constant(), 0.25);
        assert_eq!(*c.reflectance.get(), Color([1.0, 0.5, 0.25]).into());
        let plastic =
            MtlMaterial { illumination: Some(2), specular: Some([0.5; 3]), ..MtlMaterial::default() };
        let (material, lost) = nearest(&plastic);
        assert_eq!(material, Material::Diffuse(Diffuse::default()));
        assert!(lost.is_some());
        let broken = MtlMaterial { diffuse: Some([f32::NAN, -1.0, 7.0]), ..MtlMaterial::default() };
        let Material::Diffuse(d) = nearest(&broken).0 else { panic!("not diffuse") };
        assert_eq!(*d.reflectance.get(), Color([0.0, 0.0, 1.0]).into());
    }
}
