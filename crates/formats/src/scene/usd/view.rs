//! Cameras, frames, and the view of a stage that has no camera.

use straal_color::Exposure;
use straal_math::{Affine, DVec3, ops};
use straal_scene::desc::{
    Animation, Camera, FovAxis, Keyframe, Keyframes, Lens, Observer, Orthographic, Perspective,
};
use straal_scene::{Diagnostic, Span, Spanned, suggest};

use super::{Translation, within, xform};
use crate::studio::{self, Side};

/// Pixels of a picture, whatever its shape.
const AREA: f64 = 360_000.0;

impl Translation<'_, '_> {
    /// Which time is shown, and how many frames there are.
    pub fn frames(&mut self) {
        let about = &self.stage.library.layers[0].layer.about;
        let start = about.start.unwrap_or(0.0);
        let fps = within(about.times_per_second.unwrap_or(24.0), 0.001, 1000.0);
        let count = about.end.map_or(0.0, |end| (end - start).floor());
        self.stage.time = start + self.stage.library.means.frame;
        self.shutter();
        if count >= 1.0 {
            let frames = within(count, 1.0, 999_999.0) as u32 + 1;
            self.scene.animation = Animation { frames, fps, ..Animation::default() };
        }
    }

    /// While what the picture is taken: as `-D shutter=N` says, or the camera, whose shutter opens and closes so many time codes after the frame's.
    fn shutter(&mut self) {
        let said = self.stage.library.means.define.get("shutter").cloned();
        let [open, close] = match said {
            Some(said) => match said.parse::<f64>().ok().filter(|v| (0.0..=1.0).contains(v)) {
                Some(v) => [0.0, v],
                None => {
                    let message =
                        "`-D shutter=N` says for how many frames the shutter is open: a number from 0 to 1";
                    self.fail(message.to_owned());
                    return;
                }
            },
            None => {
                let wanted = self.stage.library.means.define.get("camera");
                let cameras = self.cameras();
                let named = wanted.and_then(|wanted| {
                    let is_it = |c: &&usize| {
                        [&self.stage.prims[**c].name, &self.stage.prims[**c].path].contains(&wanted)
                    };
                    cameras.iter().find(is_it).copied()
                });
                let Some(camera) = named.or_else(|| self.preferred(&cameras)) else { return };
                ["shutter:open", "shutter:close"].map(|name| self.stage.number(camera, name).unwrap_or(0.0))
            }
        };
        if close > open && close - open <= 1000.0 {
            self.stage.time += open;
            self.open = close - open;
        }
    }

    /// The cameras of the stage.
    fn cameras(&self) -> Vec<usize> {
        (0..self.stage.prims.len())
            .filter(|&prim| self.stage.prims[prim].type_name == "Camera" && self.stage.prims[prim].is_defined)
            .collect()
    }

    /// The camera of the render settings, or the first.
    fn preferred(&self, cameras: &[usize]) -> Option<usize> {
        let named = self.render_settings().and_then(|s| self.stage.targets(s, "camera").into_iter().next());
        let named = named.and_then(|path| self.stage.places.get(&path).copied());
        named.filter(|p| cameras.contains(p)).or_else(|| cameras.first().copied())
    }

    /// The camera of the stage: that of its render settings, the first, or the one that is asked for; where there is none, one that
    /// shows all.
    pub fn view(&mut self, corners: &[DVec3]) {
        let (min, max) =
            corners.iter().fold((corners[0], corners[0]), |(min, max), p| (min.min(*p), max.max(*p)));
        let centre = (min + max) * 0.5;
        let mut size = self.settings();
        let cameras = self.cameras();
        let mut chosen = self.preferred(&cameras);
        let names =
            || cameras.iter().map(|c| self.stage.prims[*c].path.as_str()).collect::<Vec<_>>().join(", ");
        if let Some(wanted) = self.stage.library.means.define.get("camera").cloned() {
            let is_it = |c: &&usize| {
                let prim = &self.stage.prims[**c];
                prim.name == wanted || prim.path == wanted
            };
            let found = cameras.iter().find(is_it).copied();
            let found = found.or_else(|| wanted.parse().ok().and_then(|i: usize| cameras.get(i).copied()));
            if found.is_none() {
                let has =
                    if cameras.is_empty() { "it has none".to_owned() } else { format!("it has {}", names()) };
                let message = format!("`{}` has no camera `{}`: {has}", self.name, suggest::brief(&wanted));
                self.fail(message);
                return;
            }
            chosen = found;
        } else if cameras.len() > 1 {
            let seen = chosen.map_or("", |c| self.stage.prims[c].path.as_str());
            let message = format!(
                "`{}` has {} cameras: {}; it is seen through {seen}",
                self.name,
                cameras.len(),
                names()
            );
            let note = Diagnostic::note(Span::NONE, message).help("`-D camera=NAME` says another");
            self.stage.library.means.d.push(note);
        }
        if let Some(prim) = chosen {
            let place = self.global(prim);
            if let Some(mut observer) = stand(place, centre) {
                observer.moving_to = self.moving_camera(prim, centre);
                self.camera(prim, observer, &mut size);
                self.scene.film.size = size.unwrap_or(studio::SIZE);
                return;
            }
            self.warn(prim, "the camera is left out: its transform leaves no direction");
        }
        let size = size.or(self.stage.library.means.size).unwrap_or(studio::SIZE);
        self.scene.film.size = size;
        let [x, y, z] = (max - min).to_array();
        let side = if z < 0.25 * if x > y { x } else { y } { Side::Front } else { Side::ThreeQuarter };
        self.scene.camera = studio::fitting(corners, side, size);
    }

    /// The settings that the stage names, or the first that there are.
    fn render_settings(&self) -> Option<usize> {
        let named = self.stage.library.layers[0].layer.about.settings.as_ref();
        let named = named.and_then(|path| self.stage.places.get(path).copied());
        named.or_else(|| {
            (0..self.stage.prims.len()).find(|&p| self.stage.prims[p].type_name == "RenderSettings")
        })
    }

    /// The size of the picture, where settings say it.
    fn settings(&self) -> Option<[u32; 2]> {
        let [w, h] = self.stage.vector::<2>(self.render_settings()?, "resolution")?;
        let fits = |v: f64| (1.0..=65_536.0).contains(&v);
        (fits(w) && fits(h)).then_some([w as u32, h as u32])
    }

    /// Where a prim stands in the scene.
    pub fn global(&self, prim: usize) -> Affine {
        let (mut place, mut above) = (Affine::IDENTITY, Some(prim));
        while let Some(here) = above {
            let local = xform::local(&self.stage, here);
            place = place.then(&local.affine().unwrap_or(Affine::IDENTITY));
            above = if local.is_reset { None } else { self.stage.prims[here].parent };
        }
        place.then(&self.root)
    }

    /// Where a camera goes while the shutter is open.
    fn moving_camera(&mut self, prim: usize, centre: DVec3) -> Option<Keyframes> {
        let (first, mut places) = (self.stage.time, vec![self.global(prim)]);
        for time in self.times() {
            self.stage.time = time;
            places.push(self.global(prim));
        }
        self.stage.time = first;
        if places.iter().all(|place| *place == places[0]) {
            return None;
        }
        let keyframes = places[1..].iter().filter_map(|place| stand(*place, centre)).map(|o| {
            let (eye, look_at, up) = (Some(o.eye), Some(o.look_at), Some(o.up));
            Spanned::new(Keyframe { eye, look_at, up, ..Keyframe::default() }, Span::NONE)
        });
        Some(Keyframes { keyframes: keyframes.collect() })
    }

    fn camera(&mut self, prim: usize, observer: Observer, size: &mut Option<[u32; 2]>) {
        let positive = |t: &Self, name: &str, otherwise: f64| {
            t.stage.number(prim, name).filter(|v| *v > 0.0).unwrap_or(otherwise)
        };
        let [width, height] = [("horizontalAperture", 20.955), ("verticalAperture", 15.2908)]
            .map(|(n, v)| positive(self, n, v));
        let aspect = within(width / height, 1.0 / 64.0, 64.0);
        let high = (AREA / aspect).sqrt().round();
        let size = *size.get_or_insert([(high * aspect).round() as u32, high as u32]);
        let offset = ["horizontalApertureOffset", "verticalApertureOffset"]
            .map(|name| self.stage.number(prim, name).unwrap_or(0.0));
        let shift = [within(offset[0] / width, -100.0, 100.0), within(offset[1] / height, -100.0, 100.0)];
        self.exposure(prim);
        if !self.stage.numbers(prim, "clippingPlanes", 4).unwrap_or_default().is_empty() {
            self.warn(prim, "clipping planes cut nothing off");
        }
        // Apertures and focal lengths are told in tenths of a unit.
        let tenth = 0.1 * self.unit;
        if self.stage.text(prim, "projection").as_deref() == Some("orthographic") {
            // Where the picture has another shape than the film, all of the film's width is in it.
            self.scene.camera = Camera::Orthographic(Orthographic { width: width * tenth, observer });
            if shift != [0.0; 2] {
                self.warn(prim, "the offset of a camera without perspective is left out");
            }
            return;
        }
        let focal_length = positive(self, "focalLength", 50.0);
        let f_stop = self.stage.number(prim, "fStop").unwrap_or(0.0);
        let focus = self.stage.number(prim, "focusDistance").unwrap_or(0.0) * self.unit;
        let lens = (f_stop > 0.0).then(|| Lens {
            radius: Some(0.5 * focal_length * tenth / f_stop).filter(|r| *r > 0.0 && r.is_finite()),
            focus_distance: Some(focus).filter(|v| *v > 0.0),
            ..Lens::default()
        });
        let lens = lens.filter(|lens| lens.radius.is_some());
        let fov = 2.0 * ops::atan2_d(0.5 * width, focal_length) * (180.0 / std::f64::consts::PI);
        let camera = Perspective {
            fov: Some(within(fov, 1e-6, 179.999_999)),
            fov_axis: FovAxis::X,
            shift,
            lens,
            observer,
            ..Perspective::default()
        };
        let [w, h] = size.map(f64::from);
        if (w / h / aspect - 1.0).abs() > 0.01 {
            self.warn(prim, "the picture has another shape than the camera's film: its width counts");
        }
        self.scene.camera = Camera::Perspective(camera);
    }

    /// How much brighter the camera shows light: by its stops, and by its shutter, film and aperture where these are told.
    fn exposure(&mut self, prim: usize) {
        let number = |name: &str, otherwise: f64| {
            self.stage.number(prim, name).filter(|v| *v > 0.0).unwrap_or(otherwise)
        };
        let f_stop = number("exposure:fStop", 1.0);
        let ratio = number("exposure:time", 1.0) * number("exposure:iso", 100.0) / 100.0
            * number("exposure:responsivity", 1.0)
            / (f_stop * f_stop);
        let stops =
            self.stage.number(prim, "exposure").unwrap_or(0.0) + ops::ln_d(ratio) / std::f64::consts::LN_2;
        if stops != 0.0 && stops.is_finite() {
            self.scene.film.exposure = Exposure::stops(within(stops, -64.0, 64.0) as f32);
        }
    }
}

/// Where a camera stands, looking along its -z with its y up, at what is as far as the scene's middle.
fn stand(place: Affine, centre: DVec3) -> Option<Observer> {
    let eye = place.point(DVec3::ZERO);
    let (view, up) = (place.vector(-DVec3::Z).try_normalize()?, place.vector(DVec3::Y).try_normalize()?);
    let far = (centre - eye).dot(view);
    let far = if far > 1e-3 { far } else { 1.0 };
    let look_at = eye + view * far;
    Affine::look_at(eye, look_at, up)?;
    Some(Observer { eye, look_at, up, ..Observer::default() })
}
