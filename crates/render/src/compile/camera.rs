//! The camera: where it stands, and how it moves. What it is made of is its own file's business.

use super::focus::Seen;
use crate::camera::{Camera, Moving, OutOfFocus, Setup, Stand, View};
use std::cell::Cell;
use straal_math::DVec3;
use straal_scene::Scene;
use straal_scene::desc::CameraAt;
use straal_scene::value::Name;

/// The scene's camera for a picture of `size` pixels; `seen` finds what it is focused on, `centre` of the description is the
/// world's origin. With why it isn't found, if so: it is focused on what it looks at then.
pub(super) fn camera(
    scene: &Scene,
    size: [u32; 2],
    seen: &Seen<'_>,
    centre: DVec3,
) -> (Camera, Option<OutOfFocus>) {
    let observer = scene.camera.observer();
    let keyframes = observer.keyframes();
    let way: Vec<(f64, Stand)> = keyframes.iter().map(|m| (m.time, stand(m, centre))).collect();
    // A scene without errors looks somewhere.
    let view = way.first().and_then(|(_, stand)| stand.view()).unwrap_or(View::ORIGIN);
    let unfocused = Cell::new(None);
    let distance = |name: &Name, view: &View| {
        seen.distance(name, view).unwrap_or_else(|why| {
            unfocused.set(Some(why));
            observer.distance()
        })
    };
    let still = |own: View| {
        let own = if observer.mirror { own.mirrored() } else { own };
        let setup = Setup { view: own, at_start: view, film: scene.film.size, size, distance: &distance };
        Camera::of(&scene.camera, &setup)
    };
    let camera = if way.len() == 1 {
        still(view)
    } else {
        // Nor do its times fall.
        Moving::new(still(View::ORIGIN), way, observer.shutter).map_or_else(|| still(view), Camera::Moving)
    };
    (camera, unfocused.take())
}

fn stand(m: &CameraAt, centre: DVec3) -> Stand {
    Stand { eye: m.eye - centre, look_at: m.look_at - centre, up: m.up, roll: m.roll }
}
