//! Lights, as `KHR_lights_punctual` has them. W/sr are written as candela, W/m^2 as lux: the reader takes these numbers as they are.

use serde_json::{Value as Json, json};
use straal_color::spectrum::Quantity;
use straal_math::{Affine, DVec3};
use straal_scene::desc::{Decay, Falloff, Lamp, Light, Spectrum};

use super::{Out, tree};

impl Out<'_> {
    /// The nodes of the lights that glTF has.
    pub fn lights(&mut self) -> Vec<usize> {
        let scene = self.scene;
        scene.lights.iter().filter_map(|light| self.light(light)).collect()
    }

    fn light(&mut self, light: &Light) -> Option<usize> {
        self.links(light.lamp());
        let (said, position, axis) = match light {
            Light::Point(l) => {
                if l.decay != Decay::InverseSquare {
                    self.tell("light falls with the square of the distance");
                }
                (self.bright("point", &l.intensity), l.position, None)
            }
            Light::Directional(l) => {
                if l.angle > 0.0 {
                    self.tell("a directional light's disc is left out: its shadows are sharp");
                }
                (self.bright("directional", &l.irradiance), DVec3::ZERO, Some(l.axis()))
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
                (said, l.position, Some(l.axis()))
            }
            other => {
                let what = other.kind();
                self.tell(format!("lights of the kind `{what}` are left out: glTF has none"));
                return None;
            }
        };
        let place = match axis {
            None => Affine::translate(position),
            Some(axis) => {
                let axis = axis.try_normalize()?;
                let up = if axis.y.abs() < 0.99 { DVec3::Y } else { DVec3::Z };
                Affine::look_at(position, position + axis, up)?
            }
        };
        let light = self.lights.add(said);
        let mut node = tree::placed(&place);
        self.extend(&mut node, "KHR_lights_punctual", json!({ "light": light }));
        Some(self.nodes.add(node.into()))
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
        if lamp.light_group.is_some() {
            self.tell("groups of lights are left out");
        }
    }
}
