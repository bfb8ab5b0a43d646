//! Lights.
//!
//! Units are the same: radiance, intensity, irradiance. A picture of surroundings begins at its left edge along Mitsuba's local -z and has +x a quarter further;
//! straal's has its middle there, half a turn apart.

use straal_math::{Affine, DVec3};
use straal_scene::desc::{
    Decay, DirectionalLight, Environment, Falloff, Light, PointLight, Spectrum, SpotLight, Varying,
};
use straal_scene::limit::Limit;
use straal_scene::{Diagnostic, Spanned, suggest};

use super::spectrum::For;
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
                Light::Point(PointLight { position, intensity, decay: Decay::InverseSquare })
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
                })
            }
            "spot" => self.spot(o),
            "constant" => {
                self.known_light(o, &["radiance"]);
                let radiance = Some(self.constant(o, "radiance", 1.0, For::Light));
                Light::Environment(Environment { radiance, ..Environment::default() })
            }
            "envmap" => {
                let Some(light) = self.surroundings(o) else { return };
                light
            }
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

    pub(super) fn known_light(&mut self, o: &'o Object, more: &[&str]) {
        self.only(o, &[&COMMON, more].concat());
    }

    fn spot(&mut self, o: &'o Object) -> Light {
        self.known_light(o, &["intensity", "cutoff_angle", "beam_width", "texture"]);
        let to_world = self.to_world(o);
        let cutoff = self.within(o, "cutoff_angle", 20.0, Limit::within(0.001, 180.0));
        let beam = self.within(o, "beam_width", 0.75 * cutoff, Limit::within(0.0, 180.0));
        let beam = if beam > cutoff {
            self.warn(o.plugin.span, "`beam_width` is wider than `cutoff_angle`: light is full up to that");
            cutoff
        } else {
            beam
        };
        if let Some(property) = self.get(o, "texture").filter(|p| matches!(p.value, Value::Object(_))) {
            self.warn(property.span, "the `texture` of a spot isn't supported: its light is even");
        }
        Light::Spot(SpotLight {
            texture: None,
            up: DVec3::Y,
            position: to_world.point(DVec3::ZERO),
            direction: Some(to_world.vector(DVec3::Z)),
            look_at: None,
            intensity: self.constant(o, "intensity", 1.0, For::Light),
            cutoff,
            beam: Some(beam),
            falloff: Falloff::Linear,
        })
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
        let to_world = self.to_world(o);
        let file = Some(self.made.in_file(Spanned::new(found.name, file.span)));
        Some(Light::Environment(Environment {
            file,
            scale,
            rotate: 180.0,
            transform: placed(&turn_of(&to_world)),
            ..Environment::default()
        }))
    }

    /// Whether a class of objects has one of these, which only lets a warning be said.
    pub(super) fn has_inside(&self, o: &'o Object, class: Class) -> bool {
        !self.inside(o, class).is_empty()
    }
}

/// A transform without its translation.
fn turn_of(m: &Affine) -> Affine {
    Affine { rows: m.rows.map(|[x, y, z, _]| [x, y, z, 0.0]) }
}
