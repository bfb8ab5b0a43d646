//! The camera: where it stands, and how it moves. What it is made of is its own file's business.

use super::CompileError;
use super::focus::Seen;
use crate::camera::{Camera, Moving, Setup, Stand, View};
use straal_math::DVec3;
use straal_scene::Scene;
use straal_scene::desc::CameraAt;
use straal_scene::value::Name;

/// The scene's camera for a picture of `size` pixels; `seen` finds what it is focused on, `centre` of the description is the
/// world's origin.
pub(super) fn camera(
    scene: &Scene,
    size: [u32; 2],
    seen: &Seen<'_>,
    centre: DVec3,
) -> Result<Camera, CompileError> {
    let observer = scene.camera.observer();
    let nowhere = || {
        CompileError::new("the camera looks nowhere: `eye` and `look_at` coincide, or `up` is along the view")
    };
    let keyframes = observer.keyframes();
    let way: Vec<(f64, Stand)> = keyframes.iter().map(|m| (m.time, stand(m, centre))).collect();
    let views: Option<Vec<View>> = way.iter().map(|(_, stand)| stand.view()).collect();
    let view = *views.as_deref().and_then(<[View]>::first).ok_or_else(nowhere)?;
    let distance = |name: &Name, view: &View| seen.distance(name, view);
    let still = |own: View| {
        let setup = Setup { view: own, at_start: view, film: scene.film.size, size, distance: &distance };
        Camera::of(&scene.camera, &setup)
    };
    if way.len() == 1 {
        return still(view);
    }
    let own = still(View::ORIGIN)?;
    let moving = Moving::new(own, way, observer.shutter);
    let moving = moving.ok_or_else(|| CompileError::new("the times of the camera's keyframes must rise"))?;
    Ok(Camera::Moving(moving))
}

fn stand(m: &CameraAt, centre: DVec3) -> Stand {
    Stand { eye: m.eye - centre, look_at: m.look_at - centre, up: m.up, roll: m.roll }
}
