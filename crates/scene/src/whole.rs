//! What a description and its files must be to each other: the last that is looked at before a world is made of them, which can't
//! fail then.

use crate::desc::check::too_bright;
use crate::desc::{EnvironmentLayout, Light, Scene, Spectrum};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::{Assets, glow, suggest};

/// Complains of what is wrong with the files that a scene names, as far as they were read, and with what it makes of them.
pub fn validate(scene: &Scene, assets: &Assets, d: &mut Diagnostics) {
    spectra(scene, assets, d);
    surroundings(scene, assets, d);
    for asset in scene.mesh_files() {
        if assets.meshes.get(asset.handle).is_some_and(|found| !found.mesh.is_whole()) {
            let message = format!(
                "the mesh `{}` has a triangle that names a vertex that isn't there",
                suggest::brief(&asset.file)
            );
            d.push(Diagnostic::error(asset.file.span, message));
        }
    }
    glow::validate(scene, assets, d);
}

fn spectra(scene: &Scene, assets: &Assets, d: &mut Diagnostics) {
    for (file, m) in scene.spectra_of_files() {
        if let Some(Err(fault)) = assets.spectra.get(file.handle).map(|table| m.of_table(table)) {
            d.push(Diagnostic::error(file.file.span, fault.to_string()));
        }
    }
    for (file, m) in scene.reflectances().into_iter().filter_map(Spectrum::in_file) {
        let made = assets.spectra.get(file.handle).and_then(|table| m.of_table(table).ok());
        if let Some(complaint) = made.and_then(|spectrum| too_bright(&spectrum, file.file.span)) {
            d.push(complaint);
        }
    }
}

fn surroundings(scene: &Scene, assets: &Assets, d: &mut Diagnostics) {
    for light in &scene.lights {
        let Light::Environment(l) = light else { continue };
        let Some(asset) = &l.file else { continue };
        let Some(image) = assets.images.get(asset.handle) else { continue };
        let message = if !image.is_whole() {
            format!("the picture `{}` has no pixels", suggest::brief(&asset.file))
        } else if let Some([across, down]) = l.layout.faces().filter(|_| l.layout.side(image).is_none()) {
            let pixels = format!("a picture of {} x {} pixels", image.width, image.height);
            match l.layout {
                EnvironmentLayout::EqualArea => format!("{pixels} is not square, as one of equal areas is"),
                _ => format!(
                    "{pixels} is not made of {across} by {down} squares, as a cube map of this layout is"
                ),
            }
        } else {
            continue;
        };
        d.push(Diagnostic::error(asset.file.span, message));
    }
}
