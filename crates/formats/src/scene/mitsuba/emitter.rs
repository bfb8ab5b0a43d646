//! Lights.
//!
//! Units are the same: radiance, intensity, irradiance. A picture of surroundings begins at its left edge along Mitsuba's local -z and has +x a quarter further;
//! straal's has its middle there, half a turn apart.

use straal_math::{Affine, DVec3};
use straal_scene::desc::{
    Decay, DirectionalLight, Environment, Falloff, Lamp, Light, PointLight, Projector, ScaleTexture, Sky,
    Spectrum, SpotLight, Texture, TextureOf, Varying, When,
};
use straal_scene::limit::Limit;
use straal_scene::value::Name;
use straal_scene::{Diagnostic, Spanned, suggest};

use super::spectrum::For;
use super::texture::Role;
use super::translate::Translator;
use super::tree::{Class, Object, Value};
use super::uv::{Uv, placed};

/// What every light may have.
const COMMON: [&str; 4] = ["to_world", "sampling_weight", "medium", "*"];

impl<'o> Translator<'o, '_, '_> {
    /// What a shape's light sends out.
    pub fn area_light(&mut self, i: usize, uv: Uv) -> Option<Varying<Spectrum>> {
        let o: &'o Object = &self.objects[i];
        if o.plugin.as_str() != "area" {
            if o.plugin.as_str() == "directionalarea" {
                self.unsupported(o, "it shines in all directions here");
            } else {
                self.unsupported(o, "it isn't a shape's");
                return None;
            }
        }
        self.only(o, &["radiance", "sampling_weight", "*"]);
        Some(self.colour(o, "radiance", 1.0, For::Light, uv))
    }

    /// What all that shines has: the camera sees it unless the integrator hides it (`hide_emitters`).
    pub fn lamp(&self) -> Lamp {
        Lamp { seen: !self.hides_emitters, ..Lamp::default() }
    }

    /// What a light is called.
    fn called(o: &Object) -> Option<Name> {
        o.id.clone().map(|id| Spanned::new(id, o.plugin.span))
    }

    /// A light that isn't a surface.
    pub fn emitter(&mut self, i: usize) {
        let o: &'o Object = &self.objects[i];
        let light = match o.plugin.as_str() {
            "point" => {
                self.known_light(o, &["position", "intensity"]);
                let position = self
                    .vector(o, "position")
                    .unwrap_or_else(|| self.transform(o, "to_world").point(DVec3::ZERO));
                let intensity = self.constant(o, "intensity", 1.0, For::Light);
                Light::Point(PointLight {
                    position,
                    intensity,
                    decay: Decay::InverseSquare,
                    lamp: self.lamp(),
                    name: Self::called(o),
                })
            }
            "directional" => {
                self.known_light(o, &["direction", "irradiance"]);
                let said = self.vector(o, "direction");
                let direction = said.unwrap_or_else(|| self.transform(o, "to_world").vector(DVec3::Z));
                if direction.try_normalize().is_none() {
                    self.fail(o.plugin.span, "this light has no direction");
                    return;
                }
                let irradiance = self.constant(o, "irradiance", 1.0, For::Light);
                Light::Directional(DirectionalLight {
                    angle: 0.0,
                    direction: Some(direction),
                    from: None,
                    look_at: None,
                    irradiance,
                    lamp: self.lamp(),
                    name: Self::called(o),
                })
            }
            "spot" => self.spot(o),
            "constant" => {
                self.known_light(o, &["radiance"]);
                let radiance = Some(self.constant(o, "radiance", 1.0, For::Light));
                Light::Environment(Environment {
                    radiance,
                    lamp: self.lamp(),
                    name: Self::called(o),
                    ..Environment::default()
                })
            }
            "envmap" => {
                let Some(light) = self.surroundings(o) else { return };
                light
            }
            "projector" => {
                let Some(light) = self.projector(o) else { return };
                light
            }
            "sunsky" | "sun" | "sky" => self.sky(o),
            // Shapes that name it shine.
            "area" if self.is_shared(i) => return,
            "area" => {
                self.fail(o.plugin.span, "an area light belongs into a shape");
                return;
            }
            _ => {
                self.unsupported(o, "it is left out");
                return;
            }
        };
        self.scene.lights.push(light);
    }

    /// Whether a shape has an object that stands elsewhere.
    fn is_shared(&self, i: usize) -> bool {
        let has_it = |o: &Object| o.class == Class::Shape && o.objects().any(|(_, inner)| inner == i);
        self.objects.iter().any(has_it)
    }

    pub(super) fn known_light(&mut self, o: &'o Object, more: &[&str]) {
        self.only(o, &[&COMMON, more].concat());
    }

    fn spot(&mut self, o: &'o Object) -> Light {
        self.known_light(o, &["intensity", "cutoff_angle", "beam_width", "texture"]);
        let to_world = self.world_of(o);
        let cutoff = self.within(o, "cutoff_angle", 20.0, Limit::within(0.001, 180.0));
        let beam = self.within(o, "beam_width", 0.75 * cutoff, Limit::within(0.0, 180.0));
        let beam = if beam > cutoff {
            self.warn(o.plugin.span, "`beam_width` is wider than `cutoff_angle`: light is full up to that");
            cutoff
        } else {
            beam
        };
        let texture = match self.get(o, "texture").map(|p| &p.value) {
            // From the lower right, as seen from the lamp: upside down here, and its rows the other way.
            Some(Value::Object(i)) => Some(self.texture(*i, Uv::FlipV, Role::Share)),
            _ => None,
        };
        Light::Spot(SpotLight {
            texture,
            up: -to_world.vector(DVec3::Y),
            position: to_world.point(DVec3::ZERO),
            direction: Some(to_world.vector(DVec3::Z)),
            look_at: None,
            intensity: self.constant(o, "intensity", 1.0, For::Light),
            cutoff,
            beam: Some(beam),
            falloff: Falloff::Linear,
            lamp: self.lamp(),
            name: Self::called(o),
        })
    }

    /// A picture that is thrown: upright as seen from the lamp, its first row above.
    fn projector(&mut self, o: &'o Object) -> Option<Light> {
        self.known_light(o, &["irradiance", "scale", "fov", "fov_axis", "focal_length"]);
        let to_world = self.world_of(o);
        let scale = self.within(o, "scale", 1.0, Limit::NON_NEGATIVE);
        let fov = self.within(o, "fov", 40.0, Limit::within(0.1, 179.0));
        let axis = self.word(o, "fov_axis", &["x", "y", "diagonal", "smaller", "larger"]);
        if !o.has("fov") || !matches!(axis, None | Some("x")) {
            self.warn(o.plugin.span, "the angle of a projector is that from left to right here, in `fov`");
        }
        let (picture, aspect) = match self.get(o, "irradiance").map(|p| &p.value) {
            Some(Value::Object(i)) if !super::spectrum::is_spectrum(&self.objects[*i].plugin) => {
                (self.texture(*i, Uv::FlipV, Role::Light), None)
            }
            _ => {
                let of = Varying::Constant(self.constant(o, "irradiance", 1.0, For::Light));
                (TextureOf::Inline(Texture::Scale(ScaleTexture { of, ..ScaleTexture::default() })), Some(1.0))
            }
        };
        let ahead = to_world.vector(DVec3::Z);
        Some(Light::Projector(Projector {
            position: to_world.point(DVec3::ZERO),
            direction: Some(ahead),
            look_at: None,
            up: to_world.vector(DVec3::Y),
            picture,
            // Its picture is an irradiance, of which a screen at distance 1 gets pi times as much.
            intensity: std::f64::consts::PI * scale,
            fov,
            aspect,
            lamp: self.lamp(),
            name: Self::called(o),
        }))
    }

    /// Sun and sky. Up is Mitsuba's local z and north its x; in versions before 2 up was y.
    fn sky(&mut self, o: &'o Object) -> Light {
        self.known_light(
            o,
            &[
                "turbidity",
                "albedo",
                "latitude",
                "longitude",
                "timezone",
                "year",
                "month",
                "day",
                "hour",
                "minute",
                "second",
                "sun_direction",
                "sun_scale",
                "sky_scale",
                "sun_aperture",
                "complex_sun",
                "stretch",
                "resolution",
                "scale",
                "sun_radius_scale",
            ],
        );
        if o.is_old {
            self.alike("sky", o, "this sky is that of version 3 here: alike, not the same".to_owned());
        }
        // Straal's north is -z, and y is up.
        let own = match o.is_old {
            true => Affine::IDENTITY,
            false => Affine { rows: [[0.0, 0.0, -1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]] },
        };
        let all = own.then(&turn_of(&self.world_of(o)));
        let said = self.vector(o, "sun_direction");
        let sun_direction = said.and_then(|world| Some(all.inverse()?.vector(world)));
        let sun_direction = sun_direction.filter(|d| d.try_normalize().is_some());
        let when = if sun_direction.is_some() { None } else { Some(self.when(o)) };
        let scale = self.within(o, "scale", 1.0, Limit::NON_NEGATIVE);
        let sky_scale = scale * self.within(o, "sky_scale", 1.0, Limit::NON_NEGATIVE);
        let sun_scale = scale * self.within(o, "sun_scale", 1.0, Limit::NON_NEGATIVE);
        let wider = self.within(o, "sun_radius_scale", 1.0, Limit::POSITIVE);
        let sun_angle = wider * self.within(o, "sun_aperture", 0.5338, Limit::within(0.01, 90.0));
        let ground_albedo = match self.colour(o, "albedo", 0.3, For::Share, Uv::Same) {
            Varying::Constant(albedo) => albedo,
            Varying::Texture(_) => {
                self.warn(o.plugin.span, "the ground's `albedo` is one colour here: grey is taken");
                Spectrum::grey(0.3)
            }
        };
        Light::Sky(Sky {
            sun_direction,
            when,
            turbidity: self.within(o, "turbidity", 3.0, Limit::within(1.0, 10.0)),
            ground_albedo,
            sky_scale: if o.plugin.as_str() == "sun" { 0.0 } else { sky_scale },
            sun_scale: if o.plugin.as_str() == "sky" { 0.0 } else { sun_scale },
            sun_angle: self.held(o.plugin.span, "sun_aperture", sun_angle, Limit::within(0.01, 90.0)),
            limb_darkening: self.boolean(o, "complex_sun").unwrap_or(false),
            transform: placed(&all),
            lamp: self.lamp(),
            name: Self::called(o),
            ..Sky::default()
        })
    }

    /// A date and place; where nothing is said, those of Mitsuba.
    fn when(&mut self, o: &'o Object) -> When {
        let date = [
            self.count(o, "year", 2010, [1, 9999]),
            self.count(o, "month", 7, [1, 12]),
            self.count(o, "day", 10, [1, 31]),
        ];
        let hour = self.within(o, "hour", 15.0, Limit::within(0.0, 24.0))
            + self.within(o, "minute", 0.0, Limit::within(0.0, 60.0)) / 60.0
            + self.within(o, "second", 0.0, Limit::within(0.0, 60.0)) / 3600.0;
        let when = When {
            latitude: self.within(o, "latitude", 35.6894, Limit::within(-90.0, 90.0)),
            longitude: self.within(o, "longitude", 139.6917, Limit::within(-180.0, 180.0)),
            date,
            hour: if hour > 24.0 { 24.0 } else { hour },
            utc_offset: self.within(o, "timezone", 9.0, Limit::within(-14.0, 14.0)),
        };
        if when.is_sound() {
            return when;
        }
        self.fail(o.plugin.span, format!("there is no day {}-{}-{}", date[0], date[1], date[2]));
        When { date: [2010, 7, 10], ..when }
    }

    fn surroundings(&mut self, o: &'o Object) -> Option<Light> {
        self.known_light(o, &["filename", "scale", "mis_compensation", "gamma", "cache"]);
        let Some(file) = self.text(o, "filename") else {
            let message = format!("`{}` has no `filename`", suggest::brief(&o.plugin));
            self.push(Diagnostic::error(o.plugin.span, message));
            return None;
        };
        let found = self.file(o, &file)?;
        let scale = self.within(o, "scale", 1.0, Limit::NON_NEGATIVE);
        let to_world = self.world_of(o);
        let file = Some(self.made.in_file(Spanned::new(found.name, file.span)));
        Some(Light::Environment(Environment {
            file,
            scale,
            rotate: 180.0,
            transform: placed(&turn_of(&to_world)),
            lamp: self.lamp(),
            name: Self::called(o),
            ..Environment::default()
        }))
    }

    /// Whether a class of objects has one of these, which only lets a warning be said.
    pub(super) fn has_inside(&self, o: &'o Object, class: Class) -> bool {
        !self.inside(o, class).is_empty()
    }
}

/// Whether an integrator has the camera not see what shines.
pub(super) fn are_hidden(objects: &[Object]) -> bool {
    let hides = |o: &Object| match o.get("hide_emitters").map(|property| &property.value) {
        Some(Value::Boolean(hides)) => *hides,
        Some(Value::Text(text)) => text == "true",
        _ => false,
    };
    objects.iter().filter(|o| o.class == Class::Integrator).any(hides)
}

/// A transform without its translation.
fn turn_of(m: &Affine) -> Affine {
    Affine { rows: m.rows.map(|[x, y, z, _]| [x, y, z, 0.0]) }
}
