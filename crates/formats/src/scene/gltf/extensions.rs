//! Extensions: which are read, which don't change a picture, and what is said of the rest.

use straal_scene::suggest;

use super::Translation;
use super::document::Fault;

/// What is read.
const READ: [&str; 33] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    // What says things about a file or its parts that no picture shows.
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "EXT_mesh_manifold",
    "FB_geometry_metadata",
    "GODOT_single_root",
    "MSFT_lod",
];

impl Translation<'_, '_> {
    /// Complains of extensions that must be understood and aren't; tells of others that are left out.
    pub fn extensions(&mut self) {
        let root = self.document.root;
        let list = |key: &str| root.get(key).map_or(&[][..], |list| list.items());
        let required = list("extensionsRequired");
        for (at, name) in required.iter().filter_map(|at| Some((at, at.text()?))) {
            if !READ.contains(&name) {
                let message = format!(
                    "the file can't be shown without `{}`, which straal doesn't read",
                    suggest::brief(name)
                );
                let fault = Fault::of(at, message).help("the program that wrote it may write it without");
                self.means.d.push(self.document.error(&fault));
            }
        }
        for (at, name) in list("extensionsUsed").iter().filter_map(|at| Some((at, at.text()?))) {
            let is_told = required.iter().any(|r| r.text() == Some(name));
            if !READ.contains(&name) && !is_told {
                self.warn(at, format!("the extension `{}` is left out", suggest::brief(name)));
            }
        }
    }
}
