//! What the materials of MTL files mean as surfaces.

use straal_scene::desc::{
    Bump, Dielectric, Diffuse, Highlight, Index, Mask, Material, MaterialRef, Mirror, OpenPbr, Phong, Relief,
    Spectrum, TextureOf, Varying,
};
use straal_scene::value::LinearRgb;

use super::pictures::Maps;
use crate::mesh::mtl::{MtlMaterial, MtlUse};
use crate::read_error::quoted;

/// The material that comes nearest to what an MTL file means; what is lost by it is told.
///
/// The illumination models are those of the MTL specification (Wavefront, 1995). 6 and 7 refract: glass. 4 and 9 have 'glass
/// on', which is no more than reflections on a surface that light passes straight on, but where a file gives an index of
/// refraction as well, glass is what it means; Maya writes 4 for everything, with an index of 1. 3 and 5 reflect like a mirror. From 2 on `Ks`
/// and `Ns` are Blinn's highlight, here normalised. `d` and `Tr` let light pass straight on, without bending it: a mask.
///
/// The physically based extension (`Pr`, `Pm`, `Ps`, `Pc`, `Pcr`, `aniso`) becomes layers of OpenPBR, in which roughness means the same.
///
/// Pictures multiply what they are pictures of. How high a bump map is MTL doesn't say: a height of 1 is taken for a hundredth of the mesh's
/// `extent`, times `-bm`.
pub(super) fn nearest(
    m: &MtlMaterial,
    (maps, extent): (&Maps, f64),
    tell: &mut dyn FnMut(&'static str),
) -> Material {
    let illumination = m.illumination.unwrap_or(0);
    let opacity = opacity(m, tell);
    let is_cut = maps.has(MtlUse::Dissolve);
    // 1 is the format's way to leave the index out: such glass could not be seen.
    let eta = m.ior.map(f64::from).filter(|n| (1.001..=10.0).contains(n));
    let is_clear = m.transmission.is_some_and(|c| c.iter().any(|v| *v > 0.0));
    let is_glass = match illumination {
        6 | 7 => true,
        // Blender writes 9 for all that is partly see-through, with whatever index its material has.
        4 | 9 => eta.is_some() && (opacity == 1.0 || is_clear) && !is_cut,
        _ => false,
    };
    if is_glass {
        if !maps.are_none() {
            tell("it is clear glass, for which pictures have no effect");
        }
        if opacity < 1.0 {
            tell(
                "'d' or 'Tr' says that light passes straight on, but 'illum' that it is refracted: it is shown as clear glass",
            );
        }
        let tint = m.transmission.map(|c| c.map(share)).filter(|c| *c != [0.0; 3]).unwrap_or([1.0; 3]);
        let transmittance = Varying::Constant(LinearRgb(tint).into());
        let eta = eta.unwrap_or(1.5);
        return Material::Dielectric(Dielectric {
            eta: Index::Constant(eta).into(),
            transmittance,
            ..Dielectric::default()
        });
    }
    if opacity == 1.0 && !is_cut && matches!(illumination, 4 | 9) {
        tell("'illum' asks for glass, but no index of refraction ('Ni') above 1 does: it is shown as opaque");
    }
    let opaque = opaque(m, (maps, relief(maps, extent)), illumination);
    if opacity == 1.0 && !is_cut {
        return opaque;
    }
    let material = Box::new(MaterialRef::Inline(Box::new(opaque)));
    let opacity = maps.number(MtlUse::Dissolve, Some(opacity), 1.0);
    Material::Mask(Mask { material, opacity, relief: Relief::default() })
}

/// The light that it sends out, if any.
pub(super) fn emission(m: &MtlMaterial, maps: &Maps) -> Option<Varying<Spectrum>> {
    let constant = m.emission.map_or([0.0; 3], |e| e.map(positive));
    let is_lit = constant != [0.0; 3] || maps.has(MtlUse::Emission);
    is_lit.then(|| maps.colour(MtlUse::Emission, constant))
}

fn relief(maps: &Maps, extent: f64) -> Relief {
    let bump = maps.heights.clone().map(|(texture, by)| {
        let height = by * 0.01 * extent;
        let height = if height.is_finite() && height.abs() <= 1e6 { height } else { 0.0 };
        Bump { texture: TextureOf::Inline(texture), height }
    });
    Relief { normal_map: maps.normals.clone(), bump }
}

/// What there is where light doesn't pass.
fn opaque(m: &MtlMaterial, (maps, relief): (&Maps, Relief), illumination: u32) -> Material {
    let absent = if maps.has(MtlUse::Diffuse) { 1.0 } else { 0.5 };
    let diffuse = m.diffuse.map_or([absent; 3], |c| c.map(share));
    let specular = m.specular.map_or([0.0; 3], |c| c.map(share));
    let base = maps.colour(MtlUse::Diffuse, diffuse);
    let physical = [m.roughness, m.metallic, m.sheen, m.clearcoat];
    let of_pictures = [MtlUse::Roughness, MtlUse::Metallic, MtlUse::Sheen, MtlUse::Clearcoat];
    if physical.iter().any(Option::is_some) || of_pictures.iter().any(|of| maps.has(*of)) {
        let number = |v: Option<f32>, absent: f64| Varying::Constant(v.map_or(absent, share));
        let read = |of: MtlUse, v: Option<f32>, absent: f64| maps.number(of, v.map(share), absent);
        return Material::OpenPbr(OpenPbr {
            base_color: base,
            base_metalness: read(MtlUse::Metallic, m.metallic, 0.0),
            specular_roughness: read(MtlUse::Roughness, m.roughness, 0.5),
            specular_roughness_anisotropy: number(m.anisotropy, 0.0),
            specular_ior: Varying::Constant(
                m.ior.map(f64::from).filter(|n| (1.001..=5.0).contains(n)).unwrap_or(1.5),
            ),
            fuzz_weight: read(MtlUse::Sheen, m.sheen, 0.0),
            coat_weight: read(MtlUse::Clearcoat, m.clearcoat, 0.0),
            coat_roughness: read(MtlUse::ClearcoatRoughness, m.clearcoat_roughness, 0.0),
            coat_ior: Varying::Constant(1.5),
            coat_darkening: Varying::Constant(0.0),
            relief,
            ..OpenPbr::default()
        });
    }
    let sum = |c: [f64; 3]| c[0] + c[1] + c[2];
    let shines = sum(specular) > 0.0 || maps.has(MtlUse::Specular);
    if matches!(illumination, 3 | 5) && sum(specular) > sum(diffuse) {
        let reflectance = maps.colour(MtlUse::Specular, specular);
        return Material::Mirror(Mirror { reflectance, relief, ..Mirror::default() });
    }
    if illumination >= 2 && shines {
        let exponent = positive(straal_math::ops::clamp(m.shininess.unwrap_or(10.0), 0.0, 1e4));
        return Material::Phong(Phong {
            reflectance: base,
            specular: maps.colour(MtlUse::Specular, specular),
            exponent: maps.number(MtlUse::Shininess, Some(exponent), 10.0),
            highlight: Highlight::Blinn,
            relief,
            ..Phong::default()
        });
    }
    Material::Diffuse(Diffuse { reflectance: base, relief, ..Diffuse::default() })
}

/// The share of light that doesn't pass straight on, by `d` and `Tr`. Where they contradict each other `d` counts, whose meaning nobody doubts.
fn opacity(m: &MtlMaterial, tell: &mut dyn FnMut(&'static str)) -> f64 {
    let is_share = |v: Option<f32>| v.is_none_or(|v| (0.0..=1.0).contains(&v));
    if !is_share(m.dissolve) || !is_share(m.transparency) {
        tell("'d' and 'Tr' go from 0 to 1: what is beyond is taken for the nearest");
    }
    match (m.dissolve.map(share), m.transparency.map(share)) {
        (Some(d), Some(tr)) => {
            if (d + tr - 1.0).abs() > 0.02 {
                tell("'d' and 'Tr' contradict each other, for 'Tr' is 1 less 'd': 'd' counts");
            }
            d
        }
        (Some(d), None) => d,
        (None, Some(1.0)) => {
            tell(
                "'Tr 1' alone is invisible by the letter of MTL, but OpenMVS, mvs-texturing and others mean opaque by it: \
                 it is shown as opaque ('d' would leave no doubt)",
            );
            1.0
        }
        (None, Some(tr)) => 1.0 - tr,
        (None, None) => 1.0,
    }
}

/// What is told of materials, each thing once, with the names of those that it is told of.
#[derive(Default)]
pub(super) struct Told {
    /// What is told, the first names, and how many there are in all.
    list: Vec<(&'static str, Vec<String>, usize)>,
}

impl Told {
    const NAMES: usize = 3;

    pub(super) fn add(&mut self, what: &'static str, name: &str) {
        let known = self.list.iter().position(|(said, ..)| *said == what);
        let at = known.unwrap_or_else(|| {
            self.list.push((what, Vec::new(), 0));
            self.list.len() - 1
        });
        let (_, names, count) = &mut self.list[at];
        *count += 1;
        if names.len() < Self::NAMES {
            names.push(quoted(name.as_bytes()));
        }
    }

    pub(super) fn finish(self) -> impl Iterator<Item = String> {
        self.list.into_iter().map(|(what, names, count)| {
            let noun = if count == 1 { "material" } else { "materials" };
            let more = count - names.len();
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            format!("{noun} {}{more}: {what}", names.join(", "))
        })
    }
}

/// A share of light, from 0 to 1; NaN is 0.
fn share(v: f32) -> f64 {
    let v = positive(v);
    if v < 1.0 { v } else { 1.0 }
}

/// A finite number that isn't negative; NaN is 0.
pub(super) fn positive(v: f32) -> f64 {
    if v > 0.0 { f64::from(if v < f32::MAX { v } else { f32::MAX }) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    fn told(m: &MtlMaterial) -> (Material, Vec<&'static str>) {
        let mut list = Vec::new();
        let material = nearest(m, (&Maps::default(), 1.0), &mut |what| list.push(what));
        (material, list)
    }

    #[test]
    fn mtl_means_the_nearest_material() {
        let mirror = MtlMaterial {
            illumination: Some(3),
            diffuse: Some([0.0; 3]),
            specular: Some([0.9; 3]),
            ..MtlMaterial::default()
        };
        assert!(matches!(told(&mirror).0, Material::Mirror(_)));
        let metal = MtlMaterial {
            metallic: Some(1.0),
            roughness: Some(0.5),
            diffuse: Some([1.0, 0.5, 0.25]),
            ..MtlMaterial::default()
        };
        let Material::OpenPbr(p) = told(&metal).0 else { panic!("not a metal") };
        assert_eq!((p.specular_roughness, p.base_metalness), (0.5.into(), 1.0.into()));
        assert_eq!(p.base_color, Spectrum::from(LinearRgb([1.0, 0.5, 0.25])).into());
        let coated = MtlMaterial {
            clearcoat: Some(0.8),
            clearcoat_roughness: Some(0.1),
            sheen: Some(0.3),
            ior: Some(1.4),
            ..MtlMaterial::default()
        };
        let Material::OpenPbr(p) = told(&coated).0 else { panic!("not coated") };
        assert_eq!((p.coat_weight, p.fuzz_weight), (f64::from(0.8_f32).into(), f64::from(0.3_f32).into()));
        assert!(matches!(p.specular_ior, Varying::Constant(n) if (n - 1.4).abs() < 1e-6));
        let plastic =
            MtlMaterial { illumination: Some(2), specular: Some([0.5; 3]), ..MtlMaterial::default() };
        let (material, lost) = told(&plastic);
        let Material::Phong(p) = material else { panic!("no highlight") };
        assert!(
            p.specular == Spectrum::grey(0.5).into() && p.highlight == Highlight::Blinn && lost.is_empty()
        );
        let broken = MtlMaterial { diffuse: Some([f32::NAN, -1.0, 7.0]), ..MtlMaterial::default() };
        let Material::Diffuse(d) = told(&broken).0 else { panic!("not diffuse") };
        assert_eq!(d.reflectance, Spectrum::from(LinearRgb([0.0, 0.0, 1.0])).into());
    }

    #[test]
    fn glass_is_what_refracts_and_not_what_dissolves() {
        let m = |illum: u32, ior: Option<f32>, d: Option<f32>, tf: Option<f32>| MtlMaterial {
            illumination: Some(illum),
            ior,
            dissolve: d,
            transmission: tf.map(|v| [v; 3]),
            ..MtlMaterial::default()
        };
        for (m, eta) in [
            (m(7, Some(1.33), None, None), 1.33),
            (m(6, None, None, None), 1.5),
            (m(7, Some(1.0), Some(0.2), None), 1.5),
            (m(4, Some(1.52), None, None), 1.52),
            (m(9, Some(1.52), Some(0.3), Some(0.9)), 1.52),
        ] {
            let Material::Dielectric(d) = told(&m).0 else { panic!("{m:?}") };
            assert!(
                matches!(d.eta, Varying::Constant(Index::Constant(n)) if (n - eta).abs() < 1e-6),
                "{m:?}"
            );
        }
        // Maya's grey.
        let (material, lost) = told(&m(4, Some(1.0), None, Some(1.0)));
        assert!(matches!(material, Material::Diffuse(_)) && lost.len() == 1, "{lost:?}");
        // Blender's dissolve; dissolve with any other model.
        for m in [
            m(9, Some(1.45), Some(0.25), None),
            m(4, None, Some(0.25), None),
            m(1, Some(1.5), Some(0.25), Some(1.0)),
            m(2, None, Some(0.25), None),
        ] {
            let (material, lost) = told(&m);
            let Material::Mask(mask) = material else { panic!("{m:?}") };
            assert!(mask.opacity == 0.25.into() && lost.is_empty(), "{m:?}: {lost:?}");
        }
    }

    #[test]
    fn what_contradicts_itself_is_told() {
        let m = |d: Option<f32>, tr: Option<f32>| {
            let m = MtlMaterial { dissolve: d, transparency: tr, ..MtlMaterial::default() };
            told(&m).1.join("; ")
        };
        for (d, tr) in [(None, None), (Some(1.0), None), (None, Some(0.0)), (Some(1.0), Some(0.0))] {
            assert_eq!(m(d, tr), "");
        }
        for (d, tr) in [(Some(0.3), None), (None, Some(0.7)), (Some(0.3), Some(0.7))] {
            assert_eq!(m(d, tr), "", "{d:?} {tr:?}");
        }
        for (d, tr) in [(Some(0.3), Some(0.3)), (Some(1.0), Some(1.0))] {
            assert!(m(d, tr).contains("contradict each other"), "{d:?} {tr:?}");
        }
        assert!(m(None, Some(1.0)).contains("OpenMVS"));
        assert!(m(Some(30.0), None).contains("from 0 to 1"));
    }

    #[test]
    fn what_many_materials_lack_is_told_once() {
        let mut told = Told::default();
        for name in ["a", "b", "c", "d", "e"] {
            told.add("it shines", name);
        }
        told.add("it glows", "a");
        let list: Vec<String> = told.finish().collect();
        assert_eq!(list, ["materials 'a', 'b', 'c' and 2 more: it shines", "material 'a': it glows"]);
    }
}
