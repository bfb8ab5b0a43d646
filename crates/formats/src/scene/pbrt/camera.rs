//! Cameras.
//!
//! A camera of pbrt looks along its +z, with +x to the right in the picture and +y up, and its transform is that from the world to it.
//! The angle spans the shorter side of the picture.

use straal_math::{Affine, DVec3, ops};
use straal_scene::desc::{
    Camera, FovAxis, Keyframe, Keyframes, Lens, LensExposure, LensProfile, Observer, Orthographic, Panorama,
    PanoramaRows, Perspective, Realistic,
};
use straal_scene::{Span, Spanned};

use super::params::Params;
use super::state::Transforms;
use super::{Reader, Thing};

/// The part of the plane at distance 1 that is seen, in units of the tangent of half the angle.
struct Screen {
    low: [f64; 2],
    high: [f64; 2],
    /// Whether it is what it is when nothing is said.
    is_usual: bool,
}

impl Screen {
    fn size(&self) -> [f64; 2] {
        [0, 1].map(|k| self.high[k] - self.low[k])
    }

    fn middle(&self) -> [f64; 2] {
        [0, 1].map(|k| 0.5 * (self.high[k] + self.low[k]))
    }
}

/// Where a camera stands: its axes as the world has them.
struct Stand {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
}

impl Reader<'_, '_> {
    /// Takes note of where the camera stands.
    pub(super) fn camera_stands(&mut self, from_world: Transforms) {
        let inverse = from_world.map(|map| map.inverse());
        let [Some(start), Some(end)] = inverse else {
            return self.warn(self.tokens.place(), "the camera's transform is singular: it is passed over");
        };
        self.systems.insert("camera".to_owned(), [start, end]);
    }

    /// The camera, once the film is known.
    pub(super) fn camera(&mut self) {
        let shutter = self.shutter();
        let Some(Thing { kind, params }) = self.options.camera.take() else {
            let film = self.scene.film.size;
            let screen = screen_of(None, None, film);
            let stand = stand(&Affine::IDENTITY);
            self.scene.camera = perspective(&stand, 90.0, &screen, false);
            return;
        };
        let span = params.span;
        let [world, end] = self.systems.get("camera").copied().unwrap_or([Affine::IDENTITY; 2]);
        let places = if world == end { Vec::new() } else { self.swept(shutter, [&world, &end]) };
        let world = places.first().copied().unwrap_or(world);
        let stand = stand(&world);
        self.is_even(&stand, span);
        // How long the film is exposed, which the film has asked for.
        params.pass_over(&["shutteropen", "shutterclose"]);
        let film = self.scene.film.size;
        match kind.as_str() {
            "perspective" | "environment" | "spherical" | "orthographic" | "realistic" => {}
            _ => {
                return self.unknown(
                    "camera",
                    &kind,
                    &["perspective", "orthographic", "realistic", "spherical"],
                );
            }
        }
        let window = params.floats("screenwindow").map(<[f64]>::to_vec);
        let window = window.and_then(|w| <[f64; 4]>::try_from(w).ok());
        if params.has("screenwindow") && window.is_none() {
            self.warn(span, "`screenwindow` must have four numbers: it is passed over");
        }
        let aspect = params.maybe_float("frameaspectratio");
        let screen = screen_of(window, aspect, film);
        let [width, height] = screen.size();
        if !(width > 1e-9 && height > 1e-9 && width < 1e9 && height < 1e9) {
            return self.error(span, "the camera's `screenwindow` is empty");
        }
        let [w, h] = film.map(f64::from);
        if (width * h / (height * w) - 1.0).abs() > 2e-3
            && matches!(kind.as_str(), "perspective" | "orthographic")
        {
            self.warn(span, "pixels are not square by `screenwindow` or `frameaspectratio`: the height follows from the width");
        }
        match kind.as_str() {
            "perspective" => self.perspective(&params, &stand, &screen),
            "orthographic" => self.orthographic(&params, &stand, &screen),
            "realistic" => self.realistic(&params, &stand),
            _ => self.spherical(kind.as_str() == "environment", &params, &stand),
        }
        self.camera_moves(&world, &places);
        params.complain(&format!("the camera `{}`", kind.value), self.means.d);
    }

    /// Has the camera go through places, of which it is at the first.
    fn camera_moves(&mut self, first: &Affine, places: &[Affine]) {
        let observer = match &mut self.scene.camera {
            Camera::Perspective(camera) => &mut camera.observer,
            Camera::Orthographic(camera) => &mut camera.observer,
            Camera::Realistic(camera) => &mut camera.observer,
            Camera::Panorama(camera) => &mut camera.observer,
            _ => return,
        };
        // As the camera sees its own eye, which may be off its middle.
        let Some(eye) = first.inverse().map(|back| back.point(observer.eye)) else { return };
        if places.iter().all(|place| place == first) {
            return;
        }
        let keyframe = |place: &Affine| {
            let eye = place.point(eye);
            let look_at = eye + place.vector(DVec3::Z).try_normalize().unwrap_or(DVec3::Z);
            let up = place.vector(DVec3::Y).try_normalize();
            let said = Keyframe { eye: Some(eye), look_at: Some(look_at), up, ..Keyframe::default() };
            Spanned::new(said, Span::NONE)
        };
        observer.moving_to = Some(Keyframes { keyframes: places[1..].iter().map(keyframe).collect() });
    }

    /// A camera whose axes aren't alike sees things stretched.
    fn is_even(&mut self, s: &Stand, span: Span) {
        let [a, b, c] = [s.right, s.up, s.forward].map(DVec3::length);
        let near = |x: f64, y: f64| (x - y).abs() <= 1e-3 * y;
        let square = |x: DVec3, y: DVec3| x.dot(y).abs() <= 1e-3 * x.length() * y.length();
        if !(near(a, b)
            && near(b, c)
            && square(s.right, s.up)
            && square(s.up, s.forward)
            && square(s.right, s.forward))
        {
            self.warn(
                span,
                "the camera's transform stretches or slants it: only its place and turn are taken",
            );
        }
    }

    fn perspective(&mut self, params: &Params, s: &Stand, screen: &Screen) {
        let fov = params.float("fov", 90.0);
        if !(fov > 1e-6 && fov < 179.999) {
            return self.error(params.span, "`fov` must be between 0 and 180 degrees");
        }
        // From version 3: half of the angle.
        let fov = match params.maybe_float("halffov") {
            Some(half) if half > 1e-6 && half < 89.999 => 2.0 * half,
            _ => fov,
        };
        let mut camera = perspective(s, fov, screen, s.is_mirrored());
        if let Camera::Perspective(camera) = &mut camera {
            let scale = s.forward.length();
            camera.lens =
                lens(params.float("lensradius", 0.0) * scale, params.float("focaldistance", 1e6) * scale);
        }
        self.scene.camera = camera;
    }

    fn orthographic(&mut self, params: &Params, s: &Stand, screen: &Screen) {
        if params.float("lensradius", 0.0) > 0.0 {
            self.warn(params.span, "an orthographic camera has no lens: all is sharp");
        }
        params.pass_over(&["focaldistance"]);
        let [x, y] = screen.middle();
        let observer = s.observer(s.eye + s.right * x + s.up * y, s.is_mirrored());
        let width = screen.size()[0] * s.right.length();
        self.scene.camera = Camera::Orthographic(Orthographic { width, observer });
    }

    /// Once around. pbrt begins at +x and goes on to +z.
    fn spherical(&mut self, is_older: bool, params: &Params, s: &Stand) {
        params.pass_over(&["lensradius", "focaldistance"]);
        let mapping = params.string("mapping").map_or("equalarea", |m| m.as_str());
        if mapping != "equirectangular" && !is_older {
            let message =
                "a spherical camera of equal areas is shown in latitude and longitude (`equirectangular`)";
            self.warn(params.span, message);
        }
        self.scene.camera = Camera::Panorama(Panorama {
            longitude: [-90.0, 270.0],
            latitude: [-90.0, 90.0],
            rows: PanoramaRows::Even,
            observer: s.observer(s.eye, !s.is_mirrored()),
        });
    }

    /// A lens system.
    fn realistic(&mut self, params: &Params, s: &Stand) {
        params.pass_over(&["simpleweighting"]);
        if let Some(shape) = params.string("aperture") {
            self.warn(shape.span, "the stop of a lens is round here, whatever shape `aperture` gives it");
        }
        let Some(file) = params.string("lensfile").cloned() else {
            return self.error(params.span, "a realistic camera needs a `lensfile`");
        };
        let (path, bytes) = match self.bytes_of(&file, 1 << 20) {
            Ok(found) => found,
            Err(refusal) => return self.refuse(&file, refusal),
        };
        self.files.push((path, file.value.clone(), blake3::hash(&bytes).into()));
        let text = super::tokens::as_text(&bytes);
        let lines = text.lines().map(|line| line.split('#').next().unwrap_or(""));
        let numbers: Vec<f64> =
            lines.flat_map(str::split_whitespace).filter_map(crate::number::double).collect();
        // What the camera's transform makes larger.
        let scale = s.forward.length();
        let surface = |c: &[f64]| Some([c[0] * scale, c[1] * scale, c[2], c[3] * scale]);
        let mut elements: Vec<[f64; 4]> = numbers.chunks_exact(4).filter_map(surface).collect();
        let stop = params.float("aperturediameter", 1.0) * scale;
        for element in elements.iter_mut().filter(|e| e[0] == 0.0) {
            if stop > element[3] && element[3] > 0.0 {
                self.warn(params.span, "`aperturediameter` is wider than the lens' stop, which is taken");
            } else if stop > 0.0 {
                element[3] = stop;
            }
        }
        let film = self.options.film.as_ref();
        let diagonal = film.map_or(35.0, |film| film.params.float("diagonal", 35.0));
        let camera = Realistic {
            elements,
            aperture: None,
            film_diagonal: diagonal * scale,
            focus_distance: params.float("focusdistance", 10.0) * scale,
            exposure: LensExposure::Film,
            observer: s.observer(s.eye, s.is_mirrored()),
        };
        let is_positive = |v: f64| v > 0.0 && v.is_finite();
        if !is_positive(camera.film_diagonal)
            || !is_positive(camera.focus_distance)
            || camera.back_focus().is_none()
        {
            let message = "this is no lens that makes a picture: rows of curvature, thickness, index and aperture in mm";
            return self.error(file.span, message);
        }
        self.scene.camera = Camera::Realistic(camera);
    }
}

/// A thin lens, where it has a radius.
fn lens(radius: f64, distance: f64) -> Option<Lens> {
    let is_open = (radius as f32) > 0.0 && (distance as f32) > 0.0 && (distance as f32).is_finite();
    is_open.then_some(Lens {
        radius: Some(radius),
        f_number: None,
        focus_distance: Some(distance),
        focus_on: None,
        profile: LensProfile::Uniform,
        blades: None,
        rotation: 0.0,
    })
}

fn with(observer: Observer) -> Perspective {
    Perspective { observer, ..Perspective::default() }
}

fn perspective(s: &Stand, fov: f64, screen: &Screen, mirror: bool) -> Camera {
    let observer = s.observer(s.eye, mirror);
    if screen.is_usual {
        let fov_axis = FovAxis::Smaller;
        return Camera::Perspective(Perspective { fov: Some(fov), fov_axis, ..with(observer) });
    }
    let (sin, cos) = ops::sin_cos_degrees(0.5 * fov);
    let ([width, height], [x, y]) = (screen.size(), screen.middle());
    let fov = 2.0 * ops::atan2_d(0.5 * width * sin, cos).to_degrees();
    let shift = [x / width, y / height];
    Camera::Perspective(Perspective { fov: Some(fov), fov_axis: FovAxis::X, shift, ..with(observer) })
}

/// What is seen: by itself so that the shorter side is from -1 to 1.
fn screen_of(window: Option<[f64; 4]>, aspect: Option<f64>, film: [u32; 2]) -> Screen {
    if let Some([x0, x1, y0, y1]) = window {
        return Screen { low: [x0, y0], high: [x1, y1], is_usual: false };
    }
    let [w, h] = film.map(f64::from);
    let frame = aspect.unwrap_or(w / h);
    let [x, y] = if frame > 1.0 { [frame, 1.0] } else { [1.0, 1.0 / frame] };
    Screen { low: [-x, -y], high: [x, y], is_usual: aspect.is_none() }
}

fn stand(world: &Affine) -> Stand {
    let [right, up, forward] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| world.vector(axis));
    Stand { eye: world.point(DVec3::ZERO), right, up, forward }
}

impl Stand {
    /// Whether the picture has to be mirrored, since what straal takes for right of the view is left.
    fn is_mirrored(&self) -> bool {
        self.right.dot(self.forward.cross(self.up)) < 0.0
    }

    fn observer(&self, eye: DVec3, mirror: bool) -> Observer {
        let forward = self.forward.try_normalize().unwrap_or(DVec3::Z);
        let up = self.up.try_normalize().unwrap_or(DVec3::Y);
        Observer { eye, look_at: eye + forward, up, mirror, ..Observer::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shorter_side_is_from_minus_one_to_one() {
        assert_eq!(screen_of(None, None, [200, 100]).high, [2.0, 1.0]);
        assert_eq!(screen_of(None, None, [100, 200]).high, [1.0, 2.0]);
        let s = screen_of(Some([-1.0, 0.0, 0.0, 1.0]), None, [100, 100]);
        assert_eq!((s.size(), s.middle()), ([1.0, 1.0], [-0.5, 0.5]));
    }
}
