//! What a description and its files must be to each other: the last that is looked at before a world is made of them, which can't
//! fail then.

use crate::desc::check::too_bright;
use crate::desc::{EnvironmentLayout, Light, Node, Scene, Spectrum};
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
    solids(scene, d);
    subdivisions(scene, assets, d);
    glow::validate(scene, assets, d);
}

/// Most solids in one combination: a ray knows of each whether it is in it, in a bit.
pub const MOST_SOLIDS: usize = 64;

/// Most triangles that a control cage may become.
const MOST_TRIANGLES: u64 = 1 << 28;

fn solids(scene: &Scene, d: &mut Diagnostics) {
    scene.visit(|node| {
        let (Node::Union(c) | Node::Intersection(c) | Node::Difference(c)) = node else { return };
        let mut count = 0;
        node.visit(&mut |n| count += usize::from(n.children().is_empty()));
        if count > MOST_SOLIDS {
            let message = format!("{count} solids are combined: at most {MOST_SOLIDS} are supported");
            d.push(Diagnostic::error(c.surface.transform.span, message));
        }
    });
}

fn subdivisions(scene: &Scene, assets: &Assets, d: &mut Diagnostics) {
    scene.visit(|node| {
        let Node::Mesh(m) = node else { return };
        let Some(how) = &m.subdivide else { return };
        let (corners, triangles) = match &m.file {
            Some(file) => {
                let mesh = &assets.mesh(file.handle).mesh;
                (mesh.corners(), mesh.triangles.len() as u64)
            }
            None => (3 * m.triangles.len() as u64, m.triangles.len() as u64),
        };
        let after = how.triangles(corners, triangles);
        if after > MOST_TRIANGLES {
            let message = format!("{} levels make {after} triangles, more than {MOST_TRIANGLES}", how.levels);
            let span = m.file.as_ref().map_or(m.surface.transform.span, |file| file.file.span);
            d.push(Diagnostic::error(span, message).help("give it fewer `levels`"));
        }
    });
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
