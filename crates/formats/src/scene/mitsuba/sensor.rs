//! Sensors, films, filters and samplers.
//!
//! A sensor looks along its local +z, with +y up and +x to the left.

use straal_math::{Affine, DVec3, ops};
use straal_scene::desc::{
    BlackmanHarris, Camera, Channels, Film, Filter, FovAxis, Gaussian, Keyframe, Keyframes, Lanczos, Lens,
    Mitchell, Observer, Orthographic, Panorama, Perspective, Sampler, SamplerKind, Tent,
};
use straal_scene::limit::Limit;
use straal_scene::{Span, Spanned};

use super::translate::Translator;
use super::tree::{Class, Object, Value};
use super::xml;

/// What every sensor may have. Clip planes don't cut anything off here.
const COMMON: [&str; 10] = [
    "to_world",
    "near_clip",
    "far_clip",
    "focus_distance",
    "shutter_open",
    "shutter_close",
    "srf",
    "medium",
    "*",
    "focal_length",
];

impl<'o> Translator<'o, '_, '_> {
    /// Who looks, and at what picture.
    pub fn sensor(&mut self, i: usize) {
        let o: &'o Object = &self.objects[i];
        let film = self.inside(o, Class::Film).first().copied();
        match film {
            Some(film) => self.film(film),
            None => self.scene.film = Film { size: [768, 576], filter: gaussian(0.5), ..Film::default() },
        }
        match self.inside(o, Class::Sampler).first().copied() {
            Some(sampler) => self.sampler(sampler),
            None => self.scene.sampler = Sampler { kind: SamplerKind::Random, spp: 4, ..Sampler::default() },
        }
        for medium in self.inside(o, Class::Medium) {
            self.medium_is_left_out(medium, "the sensor sees through it");
        }
        if self.float(o, "shutter_open") != self.float(o, "shutter_close") {
            let moves = |o: &Object| matches!(o.get("to_world").map(|p| &p.value), Some(Value::Motion(_)));
            if !self.objects.iter().any(moves) {
                self.warn(o.plugin.span, "nothing moves here: the shutter has no effect");
            }
        }
        if o.has("srf") {
            self.warn(
                o.plugin.span,
                "`srf`, the spectral response of a sensor, isn't supported: it sees red, green and blue",
            );
        }
        let camera = match o.plugin.as_str() {
            "perspective" | "thinlens" | "perspective_rdist" => self.perspective(o),
            "orthographic" | "telecentric" => self.orthographic(o),
            "spherical" => {
                self.only(o, &COMMON);
                let observer = self.observer(o);
                Camera::Panorama(Panorama { observer, ..panorama() })
            }
            "batch" => {
                self.only(o, &COMMON);
                match self.inside(o, Class::Sensor).first().copied() {
                    Some(inner) => {
                        self.warn(o.plugin.span, "of several sensors in a `batch` the first is used");
                        return self.sensor(inner);
                    }
                    None => {
                        self.fail(o.plugin.span, "this `batch` has no sensor in it");
                        return;
                    }
                }
            }
            "radiancemeter" => {
                self.only(o, &[&COMMON[..], &["origin", "direction"]].concat());
                self.unsupported(o, "a camera with an angle of 0.01 degrees stands in for it");
                let mut observer = self.observer(o);
                if let (Some(eye), Some(direction)) = (self.vector(o, "origin"), self.vector(o, "direction"))
                {
                    observer = looking(eye, direction, DVec3::Y).unwrap_or(observer);
                }
                Camera::Perspective(Perspective { fov: Some(0.01), observer, ..Perspective::default() })
            }
            _ => {
                self.unsupported(o, "a camera stands in for it");
                let observer = self.observer(o);
                Camera::Perspective(Perspective { observer, ..Perspective::default() })
            }
        };
        self.scene.camera = camera;
    }

    /// Where a sensor stands and looks.
    fn observer(&mut self, o: &'o Object) -> Observer {
        let m = self.world_of(o);
        let [eye, ahead, up] = [m.point(DVec3::ZERO), m.vector(DVec3::Z), m.vector(DVec3::Y)];
        let found = looking(eye, ahead, up).unwrap_or_else(|| {
            self.fail(o.plugin.span, "this sensor looks nowhere");
            Observer::default()
        });
        let look = |m: &Affine| looking(m.point(DVec3::ZERO), m.vector(DVec3::Z), m.vector(DVec3::Y));
        let later = self.motion(o).iter().skip(1).filter_map(look).collect::<Vec<_>>();
        let keyframe = |o: Observer| Keyframe {
            eye: Some(o.eye),
            look_at: Some(o.look_at),
            up: Some(o.up),
            ..Keyframe::default()
        };
        let keyframes: Vec<_> = later.into_iter().map(|o| Spanned::new(keyframe(o), Span::NONE)).collect();
        let moving_to = (!keyframes.is_empty()).then_some(Keyframes { keyframes });
        Observer { mirror: m.determinant() < 0.0, moving_to, ..found }
    }

    fn perspective(&mut self, o: &'o Object) -> Camera {
        let mut more = vec!["fov", "fov_axis", "principal_point_offset_x", "principal_point_offset_y"];
        match o.plugin.as_str() {
            "thinlens" => more.push("aperture_radius"),
            "perspective_rdist" => {
                more.push("kc");
                self.unsupported(o, "its picture isn't distorted");
            }
            _ => {}
        }
        self.only(o, &[&COMMON[..], &more].concat());
        let (fov, fov_axis) = if o.has("fov") {
            let axis = match self.word(o, "fov_axis", &["x", "y", "diagonal", "smaller", "larger"]) {
                Some("y") => FovAxis::Y,
                Some("diagonal") => FovAxis::Diagonal,
                Some("smaller") => FovAxis::Smaller,
                Some("larger") => FovAxis::Larger,
                _ => FovAxis::X,
            };
            (self.within(o, "fov", 40.0, Limit::between(0.0, 180.0)), axis)
        } else {
            // In millimetres of 35 mm film, from corner to corner.
            let length = match self.get(o, "focal_length").map(|p| (&p.value, p.span)) {
                None => 50.0,
                Some((Value::Text(text), span)) => {
                    let found = xml::number(text.trim().trim_end_matches("mm")).filter(|v| *v > 0.0);
                    found.unwrap_or_else(|| {
                        self.fail(span, "a focal length is a number of millimetres, such as `50mm`");
                        50.0
                    })
                }
                Some(_) => self.within(o, "focal_length", 50.0, Limit::POSITIVE),
            };
            let half = (36.0_f64 * 36.0 + 24.0 * 24.0).sqrt() / (2.0 * length);
            let fov = 2.0 * ops::atan2_d(half, 1.0).to_degrees();
            (self.held(o.plugin.span, "fov", fov, Limit::between(0.0, 180.0)), FovAxis::Diagonal)
        };
        let lens = (o.plugin.as_str() == "thinlens").then(|| {
            let radius = if o.has("aperture_radius") {
                self.within(o, "aperture_radius", 0.1, Limit::POSITIVE)
            } else {
                self.fail(o.plugin.span, "`thinlens` needs an `aperture_radius`");
                0.1
            };
            let far = self.within(o, "far_clip", 1e4, Limit::POSITIVE);
            let focus_distance = Some(self.within(o, "focus_distance", far, Limit::POSITIVE));
            Lens { radius: Some(radius), focus_distance, ..Lens::default() }
        });
        let offset = |t: &mut Self, name: &str| t.within(o, name, 0.0, Limit::within(-100.0, 100.0));
        let [across, down] =
            [offset(self, "principal_point_offset_x"), offset(self, "principal_point_offset_y")];
        let observer = self.observer(o);
        Camera::Perspective(Perspective {
            fov: Some(fov),
            fov_axis,
            shift: [across, if down == 0.0 { 0.0 } else { -down }],
            lens,
            observer,
            ..Perspective::default()
        })
    }

    fn orthographic(&mut self, o: &'o Object) -> Camera {
        self.only(o, &[&COMMON[..], &["aperture_radius"]].concat());
        if o.plugin.as_str() == "telecentric" {
            self.unsupported(o, "it is `orthographic` here, sharp everywhere");
        }
        let m = self.world_of(o);
        let [across, up] = [m.vector(DVec3::X).length(), m.vector(DVec3::Y).length()];
        if (across - up).abs() > 1e-4 * across {
            self.warn(
                o.plugin.span,
                "pixels of this sensor aren't square, which isn't supported: its width counts",
            );
        }
        let observer = self.observer(o);
        let width = self.held(o.plugin.span, "width", 2.0 * across, Limit::POSITIVE);
        Camera::Orthographic(Orthographic { width, observer })
    }

    fn film(&mut self, i: usize) {
        let o: &'o Object = &self.objects[i];
        self.only(
            o,
            &[
                "width",
                "height",
                "crop_width",
                "crop_height",
                "crop_offset_x",
                "crop_offset_y",
                "file_format",
                "pixel_format",
                "component_format",
                "sample_border",
                "compensate",
                "banner",
                "high_quality_edges",
                "attach_log",
                "gamma",
                "exposure",
                "tonemap_method",
                "key",
                "burn",
                "label",
                "size",
                "variable",
                "digits",
                "render_time",
                "*",
            ],
        );
        match o.plugin.as_str() {
            "hdrfilm" | "ldrfilm" | "tiledhdrfilm" => {}
            "specfilm" => self.warn(
                o.plugin.span,
                "`specfilm` is a film of red, green and blue here; `channels: spectral` of straal has bands",
            ),
            _ => self.unsupported(o, "it is `hdrfilm` here"),
        }
        let [width, height] =
            [self.count(o, "width", 768, [1, 65_536]), self.count(o, "height", 576, [1, 65_536])];
        let (width, height) = if u64::from(width) * u64::from(height) > 1 << 30 {
            self.fail(o.plugin.span, format!("a picture of {width} x {height} has more than 2^30 pixels"));
            (768, 576)
        } else {
            (width, height)
        };
        let x0 = self.count(o, "crop_offset_x", 0, [0, width - 1]);
        let y0 = self.count(o, "crop_offset_y", 0, [0, height - 1]);
        let x1 = x0 + self.count(o, "crop_width", width - x0, [1, width - x0]);
        let y1 = y0 + self.count(o, "crop_height", height - y0, [1, height - y0]);
        let crop = ([x0, y0, x1, y1] != [0, 0, width, height]).then_some([x0, y0, x1, y1]);
        let channels = match self.get(o, "pixel_format").map(|p| &p.value) {
            Some(Value::Text(format))
                if format.trim().eq_ignore_ascii_case("xyz")
                    || format.trim().eq_ignore_ascii_case("xyza") =>
            {
                Channels::Xyz
            }
            _ => Channels::Rgb,
        };
        let filter = match self.inside(o, Class::Filter).first().copied() {
            Some(filter) => self.filter(filter),
            None => gaussian(0.5),
        };
        self.scene.film = Film { size: [width, height], crop, channels, filter, ..Film::default() };
        if o.plugin.as_str() == "ldrfilm" {
            let stops = self.within(o, "exposure", 0.0, Limit::within(-64.0, 64.0));
            self.scene.film.exposure = straal_color::Exposure::stops(stops as f32);
        }
    }

    fn filter(&mut self, i: usize) -> Filter {
        let o: &'o Object = &self.objects[i];
        let radius = Limit { min: 0.0, max: 16.0, open: true };
        match o.plugin.as_str() {
            "box" => {
                self.only(o, &["radius"]);
                Filter::Box
            }
            "tent" => {
                self.only(o, &["radius"]);
                Filter::Tent(Tent { radius: self.within(o, "radius", 1.0, radius) })
            }
            "gaussian" => {
                self.only(o, &["stddev"]);
                gaussian(self.within(o, "stddev", 0.5, Limit::within(0.01, 3.99)))
            }
            "mitchell" => {
                self.only(o, &["B", "C", "b", "c"]);
                let (b, c) = (if o.has("B") { "B" } else { "b" }, if o.has("C") { "C" } else { "c" });
                let (b, c) =
                    (self.within(o, b, 1.0 / 3.0, Limit::UNIT), self.within(o, c, 1.0 / 3.0, Limit::UNIT));
                Filter::Mitchell(Mitchell { radius: 2.0, b, c })
            }
            "catmullrom" => {
                self.only(o, &[]);
                Filter::Mitchell(Mitchell { radius: 2.0, b: 0.0, c: 0.5 })
            }
            "lanczos" => {
                self.only(o, &["lobes"]);
                Filter::Lanczos(Lanczos { radius: f64::from(self.count(o, "lobes", 3, [1, 15])) })
            }
            _ => {
                self.unsupported(o, "a filter after Blackman and Harris stands in for it");
                Filter::BlackmanHarris(BlackmanHarris { radius: 1.5 })
            }
        }
    }

    fn sampler(&mut self, i: usize) {
        let o: &'o Object = &self.objects[i];
        self.only(o, &["sample_count", "seed", "jitter", "strength", "scramble", "dimension"]);
        let kind = match o.plugin.as_str() {
            "independent" => SamplerKind::Random,
            "stratified" => SamplerKind::Jittered,
            "multijitter" | "orthogonal" => SamplerKind::MultiJittered,
            "ldsampler" | "sobol" => SamplerKind::Sobol,
            "halton" => SamplerKind::Halton,
            "hammersley" => SamplerKind::Hammersley,
            _ => {
                self.unsupported(o, "points after Sobol stand in for it");
                SamplerKind::Sobol
            }
        };
        let spp = self.count(o, "sample_count", 4, [1, 262_144]);
        let seed = self.integer(o, "seed").and_then(|v| u64::try_from(v).ok()).unwrap_or(0);
        self.scene.sampler = Sampler { kind, spp, seed, noise: None };
    }
}

/// Mitsuba's bell, which ends after four standard deviations.
fn gaussian(sigma: f64) -> Filter {
    Filter::Gaussian(Gaussian { radius: 4.0 * sigma, sigma })
}

/// All around.
fn panorama() -> Panorama {
    Panorama {
        longitude: [-180.0, 180.0],
        latitude: [-90.0, 90.0],
        rows: straal_scene::desc::PanoramaRows::Even,
        observer: Observer::default(),
    }
}

/// Who looks from somewhere in a direction; `None` where there is none, or `up` is along it.
fn looking(eye: DVec3, ahead: DVec3, up: DVec3) -> Option<Observer> {
    let ahead = ahead.try_normalize()?;
    let up = up.try_normalize()?;
    let helper = if ahead.y.abs() < 0.9 { DVec3::Y } else { DVec3::Z };
    let up = if Affine::look_at(eye, eye + ahead, up).is_some() { up } else { helper };
    let is_told_apart = eye + ahead != eye;
    (is_told_apart && Affine::look_at(eye, eye + ahead, up).is_some()).then(|| Observer {
        eye,
        look_at: eye + ahead,
        up,
        ..Observer::default()
    })
}
