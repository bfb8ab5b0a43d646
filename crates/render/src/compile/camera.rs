//! Cameras: from a photographer's words to numbers.

use super::CompileError;
use super::focus::Seen;
use crate::camera::{
    Camera, CubeLayout, CubeMap, Eyes, Fisheye, Iris, Moving, Orthographic, Panorama, Perspective,
    Projection, Rows, Stand, Stereo, StereoLayout, ThinLens, View, Window,
};
use straal_math::DVec3;
use straal_scene::Scene;
use straal_scene::desc::{self, LensProfile, Moment};

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
    let moments = observer.moments();
    let way: Vec<(f64, Stand)> = moments.iter().map(|m| (m.time, stand(m, centre))).collect();
    let views: Option<Vec<View>> = way.iter().map(|(_, stand)| stand.view()).collect();
    let view = *views.as_deref().and_then(<[View]>::first).ok_or_else(nowhere)?;
    if way.len() == 1 {
        return still(scene, size, Look { at_start: view, view, seen });
    }
    let own = still(scene, size, Look { at_start: view, view: View::ORIGIN, seen })?;
    let moving = Moving::new(own, way, observer.shutter);
    let moving = moving.ok_or_else(|| CompileError::new("the times of the camera's poses must rise"))?;
    Ok(Camera::Moving(Box::new(moving)))
}

fn stand(m: &Moment, centre: DVec3) -> Stand {
    Stand { eye: m.eye - centre, look_at: m.look_at - centre, up: m.up, roll: m.roll }
}

/// The frame in which a camera is made, and that in which it stands in the world at time 0.
#[derive(Clone, Copy)]
struct Look<'a> {
    at_start: View,
    view: View,
    seen: &'a Seen<'a>,
}

fn still(scene: &Scene, size: [u32; 2], look: Look<'_>) -> Result<Camera, CompileError> {
    let view = &look.view;
    Ok(match &scene.camera {
        desc::Camera::Perspective(c) => return perspective(c, scene.film.size, size, look),
        desc::Camera::Orthographic(c) => Camera::Orthographic(Orthographic::new(view, c.width, size)),
        desc::Camera::Fisheye(c) => {
            let projection = match c.projection {
                desc::FisheyeProjection::Equidistant => Projection::Equidistant,
                desc::FisheyeProjection::Equisolid => Projection::Equisolid,
                desc::FisheyeProjection::Orthographic => Projection::Orthographic,
                desc::FisheyeProjection::Stereographic => Projection::Stereographic,
            };
            let diameter = c.fov_axis.extent(size.map(f64::from));
            Camera::Fisheye(Box::new(Fisheye::new(view, (projection, c.fov), diameter, size)))
        }
        desc::Camera::Panorama(c) => {
            let rows = match c.rows {
                desc::PanoramaRows::Even => Rows::Even,
                desc::PanoramaRows::Centered => Rows::Centered,
            };
            Camera::Panorama(Box::new(Panorama::new(view, c.longitude, (c.latitude, rows), size)))
        }
        desc::Camera::CubeMap(c) => {
            let layout = match c.layout {
                desc::CubeLayout::Cross => CubeLayout::Cross,
                desc::CubeLayout::Row => CubeLayout::Row,
            };
            let [columns, rows] = layout.faces();
            let map = CubeMap::new(view, layout, size).ok_or_else(|| {
                let [w, h] = size;
                CompileError::new(format!(
                    "a picture of {w} x {h} pixels has no room for {columns} x {rows} faces"
                ))
            });
            Camera::CubeMap(Box::new(map?))
        }
    })
}

fn perspective(
    c: &desc::Perspective,
    film: [u32; 2],
    size: [u32; 2],
    look: Look<'_>,
) -> Result<Camera, CompileError> {
    let view = &look.view;
    let Some(pair) = &c.stereo else {
        let window = Window::new(c.tan_x(film, size), size).shifted(c.shift);
        let lens = lens(c, (film, size), &look)?;
        return one_eye(view, &window, lens);
    };
    let layout = match pair.layout {
        desc::StereoLayout::Parallel => StereoLayout::Parallel,
        desc::StereoLayout::Crossed => StereoLayout::Crossed,
        // One eye by itself has the whole picture, as each has in an anaglyph.
        desc::StereoLayout::Anaglyph | desc::StereoLayout::Left | desc::StereoLayout::Right => {
            StereoLayout::Anaglyph
        }
    };
    let (film, own) = (Stereo::picture(layout, film), Stereo::picture(layout, size));
    if own[0] == 0 {
        return Err(CompileError::new("a picture one pixel wide has no room for two eyes"));
    }
    let window = Window::new(c.tan_x(film, own), own).shifted(c.shift);
    let lens = lens(c, (film, own), &look)?;
    let convergence = pair.convergence.unwrap_or_else(|| c.observer.distance());
    let eyes = Eyes { separation: pair.separation, convergence };
    let eye = |i: usize| {
        let (view, window) = eyes.eye(i, view, &window);
        one_eye(&view, &window, lens.clone())
    };
    Ok(match pair.layout {
        desc::StereoLayout::Left => eye(0)?,
        desc::StereoLayout::Right => eye(1)?,
        _ => Camera::Stereo(Box::new(Stereo::new([eye(0)?, eye(1)?], layout, own[0]))),
    })
}

/// Beyond these, single precision has no room for rays.
const PLANE: std::ops::Range<f64> = 1e-12..1e12;

fn one_eye(view: &View, window: &Window, lens: Option<(Iris, f64)>) -> Result<Camera, CompileError> {
    let aside = |v: f64| v.abs() < PLANE.end;
    if !(PLANE.contains(&window.tan_x)
        && PLANE.contains(&window.tan_y())
        && window.middle.into_iter().all(aside))
    {
        let message = format!(
            "the camera's angle is beyond the range of numbers: its half has a tangent of {:e}",
            window.tan_x
        );
        return Err(CompileError::new(message));
    }
    Ok(match lens {
        None => Camera::Perspective(Perspective::new(view, window)),
        Some((iris, _)) if !iris.radius().is_finite() => {
            return Err(CompileError::new("the camera's lens is too wide for numbers"));
        }
        Some((iris, focus)) => Camera::ThinLens(Box::new(ThinLens::new(view, window, iris, focus))),
    })
}

/// The opening, and the distance that is in focus.
fn lens(
    c: &desc::Perspective,
    (film, size): ([u32; 2], [u32; 2]),
    look: &Look<'_>,
) -> Result<Option<(Iris, f64)>, CompileError> {
    let Some(lens) = &c.lens else { return Ok(None) };
    let focus = match (&lens.focus_on, lens.focus_distance) {
        (Some(name), _) => look.seen.distance(name, &look.at_start)?,
        (None, Some(distance)) => distance,
        (None, None) => c.observer.distance(),
    };
    let radius = c.lens_radius(lens, film, size);
    let iris = match (lens.blades, &lens.profile) {
        (Some(blades), _) => Iris::polygon(radius, blades, lens.rotation),
        (None, LensProfile::Uniform) => Iris::round(radius),
        (None, LensProfile::Gaussian(g)) => Iris::gaussian(radius, g.sigma),
    };
    Ok(Some((iris, focus)))
}
