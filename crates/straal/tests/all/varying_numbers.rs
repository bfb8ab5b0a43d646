//! A texture that has the same number everywhere stands for that number, in whole renders: of indices of refraction and what else materials have besides colours
//! and roughness.

use std::path::Path;
use straal::{Control, Job, LoadOptions, Overrides};
use straal_math::ops;

/// What pixels show of a ball of a material on a floor.
fn shown(material: &str, spectral: bool) -> Vec<[f32; 3]> {
    // Not averaged: a mean of two alike may be off by its last digit.
    let even = |v: &str| format!("checker: {{ first: {v}, second: {v}, averaged: false }}");
    let [eta, half, gold, much, turned] = ["1.25", "0.5", "[0.25, 0.5, 1.25]", "[3, 2.5, 2]", "30"].map(even);
    let text = format!(
        "camera: {{ perspective: {{ eye: [0, 1, 5], look_at: [0, 0, 0], fov: 30 }} }}
film: {{ size: [12, 12] }}
sampler: {{ spp: 4 }}
spectral: {spectral}
textures:
  eta: {{ {eta} }}
  half: {{ {half} }}
  gold: {{ {gold} }}
  much: {{ {much} }}
  turned: {{ {turned} }}
materials:
  m: {{ {material} }}
  floor: {{ diffuse: {{ }} }}
world:
  - sphere: {{ material: m }}
  - box: {{ min: [-4, -2, -4], max: [4, -1, 4], material: floor }}
lights:
  - environment: {{ radiance: [0.5, 0.6, 0.7] }}
  - directional: {{ direction: [-1, -2, -1], irradiance: 2 }}
"
    );
    let loaded = straal::load_str("test.yaml", &text, Path::new(""), &LoadOptions::default());
    let job = Job::new(loaded.unwrap_or_else(|d| panic!("{text}\n{d}")), Overrides::default());
    let outcome = job.expect("a world").render(&mut Control::to_the_end()).expect("a picture");
    outcome.picture.to_image().pixels
}

#[test]
fn a_texture_of_one_number_is_that_number() {
    // With `@` in place of the value: constant, and texture.
    for (material, value, texture) in [
        ("dielectric: { eta: @ }", "1.25", "eta"),
        ("dielectric: { eta: 1.5, eta_outside: @ }", "1.25", "eta"),
        ("dielectric: { eta: @, roughness: 0.4 }", "1.25", "eta"),
        ("dielectric: { eta: @, fresnel: schlick }", "1.25", "eta"),
        ("transparent: { eta: @ }", "1.25", "eta"),
        ("thin_dielectric: { eta: @ }", "1.25", "eta"),
        ("thin_film: { eta: @, thickness: 300 }", "1.25", "eta"),
        ("thin_film: { eta_outside: @, metal: gold }", "1.25", "eta"),
        ("thin_film: { base_eta: @, base_k: 3 }", "[0.25, 0.5, 1.25]", "gold"),
        ("conductor: { eta: @, k: 3 }", "[0.25, 0.5, 1.25]", "gold"),
        ("conductor: { eta: 0.5, k: @, roughness: 0.3 }", "[3, 2.5, 2]", "much"),
        ("coated_conductor: { eta: @, k: 3, roughness: 0.3 }", "[0.25, 0.5, 1.25]", "gold"),
        ("coated_diffuse: { coat_eta: @ }", "1.25", "eta"),
        ("coated_diffuse: { thickness: @, albedo: 0.5 }", "0.5", "half"),
        ("coated_diffuse: { g: @, thickness: 1, albedo: 0.5 }", "0.5", "half"),
        ("principled: { eta: @, spec_trans: 0.5 }", "1.25", "eta"),
        ("principled: { specular: @ }", "0.5", "half"),
        ("gltf: { metallic: 0, ior: @ }", "1.25", "eta"),
        ("gltf: { metallic: 0, transmission: 1, volume: true, dispersion: @ }", "0.5", "half"),
        ("gltf: { iridescence: 1, iridescence_ior: @ }", "1.25", "eta"),
        ("gltf: { emissive: [1, 2, 3], emissive_strength: @ }", "0.5", "half"),
        ("gltf: { anisotropy: 0.8, anisotropy_rotation: @ }", "30", "turned"),
        (
            "open_pbr: { base_metalness: 1, specular_roughness_anisotropy: 0.8, geometry_tangent_rotation: @ }",
            "30",
            "turned",
        ),
    ] {
        let name = format!("{{ texture: {texture} }}");
        for spectral in [false, true] {
            let [plain, textured] =
                [value, &name].map(|value| shown(&material.replace('@', value), spectral));
            assert_eq!(plain, textured, "{material}, spectral: {spectral}");
        }
    }
}

/// What is read off tables by index as well lies between their entries.
#[test]
fn tables_by_index_are_near_those_of_one() {
    for material in [
        // A table of wavelengths, divided by what is outside before or after it is read.
        "dielectric: { eta: SF11, eta_outside: @ }",
        "plastic: { eta: @, reflectance: 0.8 }",
        "plastic: { eta: @, reflectance: 0.8, roughness: 0.3 }",
        "plastic: { eta: 1.7, eta_outside: @, reflectance: 0.8 }",
        "dielectric: { eta: @, roughness: 0.7, multiple_bounces: true }",
    ] {
        let [plain, textured] =
            ["1.25", "{ texture: eta }"].map(|value| shown(&material.replace('@', value), false));
        for (a, b) in plain.iter().flatten().zip(textured.iter().flatten()) {
            assert!((a - b).abs() <= 0.01 * ops::max(*a, 0.01), "{material}: {a} and {b}");
        }
    }
}

#[test]
fn what_lies_behind_a_surface_is_no_texture() {
    let said = |material: &str| {
        let text = format!(
            "camera: {{ perspective: {{ eye: [0, 0, 5], look_at: [0, 0, 0] }} }}\ntextures: {{ eta: {{ checker: {{ first: 1.2, second: 1.5 }} }} }}\n\
             world: [sphere: {{ material: {{ {material} }} }}]\n"
        );
        let loaded = straal::load_str("test.yaml", &text, Path::new(""), &LoadOptions::default());
        loaded.err().map_or_else(String::new, |d| d.to_string())
    };
    let told = said("dielectric: { eta: { texture: eta }, priority: 1 }");
    assert!(told.contains("`priority` needs an `eta` that is the same everywhere, not a texture"), "{told}");
    assert_eq!(said("dielectric: { eta: { texture: eta } }"), "");
    // What isn't an index is told, wherever it stands.
    let told = said("transparent: { eta: { texture: { checker: { first: 0, second: 1.5 } } } }");
    assert!(told.contains("0.1"), "{told}");
}
