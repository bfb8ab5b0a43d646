//! Lights, as `KHR_lights_punctual` has them. W/sr are written as candela, W/m^2 as lux: the reader takes these numbers as they are.

use serde_json::{Value as Json, json};
use straal_color::spectrum::Quantity;
use straal_math::{Affine, DVec3};
use straal_scene::desc::{Decay, Falloff, Lamp, Light, Spectrum};

use super::Out;

impl Out<'_> {
    /// The nodes of the lights that glTF has.
    pub fn lights(&mut self) -> Vec<usize> {
        let scene = self.scene;
        scene.lights.iter().enumerate().filter_map(|(i, light)| self.light(i, light)).collect()
    }

    fn light(&mut self, i: usize, light: &Light) -> Option<usize> {
        self.links(light.lamp());
        let said = match light {
            Light::Point(l) => {
                if l.decay != Decay::InverseSquare {
                    self.tell("light falls with the square of the distance");
                }
                self.bright("point", &l.intensity)
            }
            Light::Directional(l) => {
                if l.angle > 0.0 {
                    self.tell("a directional light's disc is left out: its shadows are sharp");
                }
                self.bright("directional", &l.irradiance)
            }
            Light::Spot(l) => {
                if l.falloff != Falloff::Smooth {
                    self.tell("a spot's light falls by a smooth step towards its rim");
                }
                if l.texture.is_some() {
                    self.tell("what a spot's light passes through is left out");
                }
                if l.cutoff > 90.0 {
                    self.tell("a spot's cone is half of all directions at most");
                }
                let outer = if l.cutoff < 90.0 { l.cutoff } else { 90.0 };
                let inner = l.full_beam();
                // It must be the smaller one.
                let inner = if inner < outer { inner } else { outer * (1.0 - 1e-9) };
                let mut said = self.bright("spot", &l.intensity);
                said["spot"] = json!({
                    "innerConeAngle": inner.to_radians(), "outerConeAngle": outer.to_radians(),
                });
                said
            }
            other => {
                let what = other.kind();
                self.tell(format!("lights of the kind `{what}` are left out: glTF has none"));
                return None;
            }
        };
        let (place, light_name) = (stand(light)?, light.name());
        let light = self.lights.add(said);
        let track = self.frames.and_then(|frames| frames.of_light(i));
        let (mut node, parts) = self.standing(&place, track);
        if let Some(name) = light_name {
            node.insert("name".to_owned(), json!(name.value));
        }
        self.extend(&mut node, "KHR_lights_punctual", json!({ "light": light }));
        let index = self.nodes.add(node.into());
        self.moves(index, &parts);
        Some(index)
    }

    /// A light of a kind, its colour up to 1.
    fn bright(&mut self, kind: &str, power: &Spectrum) -> Json {
        let rgb = self.rgb(power, Quantity::Emission);
        let most = rgb.iter().fold(0.0, |most, v| if *v > most { *v } else { most });
        let color = if most > 0.0 { rgb.map(|v| v / most) } else { [1.0; 3] };
        json!({ "type": kind, "color": color, "intensity": most })
    }

    /// Tells of lamps that light some things only, or that cast shadows of some only.
    pub fn links(&mut self, lamp: &Lamp) {
        if !lamp.lights_only.is_empty() || !lamp.lights_all_but.is_empty() {
            self.tell("lamps light everything");
        }
        if !lamp.shadows_only.is_empty() || !lamp.shadows_all_but.is_empty() {
            self.tell("everything casts shadows");
        }
        if !lamp.seen {
            self.tell("lamps that the camera doesn't see are seen");
        }
        if lamp.light_group.is_some() {
            self.tell("groups of lights are left out");
        }
    }
}

/// Where a light stands that glTF has, which shines along -z.
pub(super) fn stand(light: &Light) -> Option<Affine> {
    let (position, axis) = match light {
        Light::Point(l) => return Some(Affine::translate(l.position)),
        Light::Directional(l) => (DVec3::ZERO, l.axis()),
        Light::Spot(l) => (l.position, l.axis()),
        _ => return None,
    };
    let axis = axis.try_normalize()?;
    let up = if axis.y.abs() < 0.99 { DVec3::Y } else { DVec3::Z };
    Affine::look_at(position, position + axis, up)
}
