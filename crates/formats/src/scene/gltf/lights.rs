//! Lights (`KHR_lights_punctual`), how bright a picture they make, and the light that there is where a file has none.

use std::sync::Arc;

use straal_color::Exposure;
use straal_math::{Affine, DVec3, ops};
use straal_scene::desc::{
    Decay, DirectionalLight, Environment, Falloff, Light, Observer, PointLight, Spectrum, SpotLight,
};
use straal_scene::value::{LinearRgb, Name};
use straal_scene::{Diagnostic, Image, Span, desc};

use super::document::{Fault, Result, in_list, number_or, required, text, vector_or};
use super::json::Json;
use super::tree::Tree;
use super::{Translation, Within, degrees};

impl<'a> Translation<'a, '_> {
    /// The lights of the nodes that are shown.
    ///
    /// They are told in candela and lux, and glowing surfaces in candela per square metre. These numbers are taken as they are: what straal has
    /// as a watt stands for a lumen, of which a watt of green light has 683, so that one unit of radiance is one nit.
    pub fn lights(&mut self, tree: &Tree<'a>) -> Result<()> {
        let list = self.document.root.extension("KHR_lights_punctual").and_then(|e| e.get("lights"));
        let list = list.map_or(&[][..], |list| list.items());
        for &node in &tree.shown {
            let Some(said) = tree.nodes[node].extension("KHR_lights_punctual") else { continue };
            let (_, light) = in_list("lights", list, required(said, "light")?)?;
            let place = tree.globals[node].unwrap_or(Affine::IDENTITY);
            let position = place.point(DVec3::ZERO);
            let direction = place.vector(-DVec3::Z).try_normalize();
            let color = vector_or(light, "color", [1.0; 3])?;
            let strength = number_or(light, "intensity", 1.0)?;
            let power = color.map(|v| (v * strength).within(0.0, f64::from(f32::MAX)));
            let power = Spectrum::Rgb(LinearRgb(power));
            let kind = required(light, "type")?;
            // That of the node, as for meshes; lights may be shared.
            let called = |of: &'a Json| of.get("name").map(text).transpose();
            let name = match called(&tree.nodes[node])? {
                Some("") | None => called(light)?,
                own => own,
            };
            let name: Option<Name> = name.filter(|n| !n.is_empty()).map(|n| n.to_owned().into());
            let light = match (text(kind)?, direction) {
                ("point", _) => Light::Point(PointLight {
                    position,
                    intensity: power,
                    decay: Decay::InverseSquare,
                    lamp: desc::Lamp::default(),
                    name: name.clone(),
                }),
                (_, None) => {
                    self.warn(
                        &tree.nodes[node],
                        "the light is left out: its node's scale leaves no direction",
                    );
                    continue;
                }
                ("directional", Some(_)) => Light::Directional(DirectionalLight {
                    direction,
                    from: None,
                    look_at: None,
                    irradiance: power,
                    angle: 0.0,
                    lamp: desc::Lamp::default(),
                    name: name.clone(),
                }),
                ("spot", Some(_)) => {
                    let cone = light.get("spot").unwrap_or(light);
                    let outer = degrees(number_or(cone, "outerConeAngle", std::f64::consts::FRAC_PI_4)?);
                    let inner = degrees(number_or(cone, "innerConeAngle", 0.0)?);
                    let cutoff = outer.within(0.001, 90.0);
                    let beam = Some(inner.within(0.0, cutoff));
                    let falloff = Falloff::Smooth;
                    Light::Spot(SpotLight {
                        position,
                        direction,
                        look_at: None,
                        intensity: power,
                        cutoff,
                        beam,
                        falloff,
                        texture: None,
                        up: DVec3::Y,
                        lamp: desc::Lamp::default(),
                        name: name.clone(),
                    })
                }
                _ => return Err(Fault::of(kind, "a light is `point`, `spot` or `directional`")),
            };
            self.scene.lights.push(light);
        }
        Ok(())
    }

    /// Sets the exposure by what light falls on the middle of the scene, in the mean over all directions that a surface may face.
    pub fn expose(&mut self, centre: DVec3, radius: f64) {
        let luminance =
            |s: &Spectrum| s.rgb().map_or(1.0, |LinearRgb([r, g, b])| 0.2126 * r + 0.7152 * g + 0.0722 * b);
        let near = 0.5 * radius;
        let at = |position: DVec3, intensity: &Spectrum| {
            let distance = (position - centre).length();
            let distance = if distance > near { distance } else { near };
            luminance(intensity) / (distance * distance)
        };
        let all = self.scene.lights.iter().map(|light| match light {
            Light::Point(l) => at(l.position, &l.intensity),
            Light::Spot(l) => at(l.position, &l.intensity),
            Light::Directional(l) => luminance(&l.irradiance),
            _ => 0.0,
        });
        let lux: f64 = all.sum();
        if !(lux > 0.0 && lux.is_finite()) {
            return;
        }
        // So that white paper is about white; a stop more or less is the taste of who made it.
        let stops = -ops::ln_d(lux / std::f64::consts::PI) / std::f64::consts::LN_2;
        if stops.abs() <= 1.0 {
            return;
        }
        let stops = ((stops * 10.0).round() / 10.0).within(-64.0, 64.0);
        self.scene.film.exposure = Exposure::stops(stops as f32);
        let decimals = if lux < 100.0 { 2 } else { 0 };
        let message = format!(
            "`{}`: its lights give about {lux:.decimals$} lux in the middle of the scene: the picture is exposed by {stops} stops",
            self.name,
        );
        self.means.d.push(Diagnostic::note(Span::NONE, message).help("`--exposure` says another"));
    }

    /// Light from all around, as there is in a studio, for a file that has none: a large lamp on the left of the camera and above, a weak
    /// one on its right, one behind.
    pub fn studio(&mut self, observer: &Observer) {
        let message = format!("`{}` has no lights: it is shown in a studio's", self.name);
        self.means.d.push(Diagnostic::warning(Span::NONE, message).help(
            "glTF leaves it to programs what light there is, unless a file has lights of KHR_lights_punctual",
        ));
        let away = observer.eye - observer.look_at;
        let turn = ops::atan2_d(away.x, away.z);
        let name = format!("{}#studio", self.name);
        let image = self.made.image(name, Arc::new(studio()));
        let rotate = if away.x == 0.0 && away.z == 0.0 { 0.0 } else { degrees(turn) };
        self.scene.lights.push(Light::Environment(Environment {
            file: Some(image),
            rotate,
            ..Environment::default()
        }));
    }
}

/// A lamp of a studio.
struct Lamp {
    /// Where it is, as seen from what it shines on.
    towards: DVec3,
    /// Half its width and height, over its distance.
    half: [f64; 2],
    radiance: f64,
}

/// Width and height of the picture of a studio.
const SIZE: [usize; 2] = [256, 128];

/// The light of a studio, for a camera that stands at +z.
pub(in crate::scene) fn studio() -> Image {
    let lamp = |x: f64, y: f64, z: f64, half: [f64; 2], radiance: f64| Lamp {
        towards: DVec3::new(x, y, z),
        half,
        radiance,
    };
    let lamps = [
        lamp(-3.8, 4.4, 3.4, [0.34, 0.34], 5.5),
        lamp(4.8, 1.8, 2.8, [0.25, 0.4], 1.6),
        lamp(2.2, 4.0, -3.4, [0.4, 0.16], 6.0),
    ];
    let [width, height] = SIZE;
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        let (up, level) = ops::sin_cos_degrees(90.0 - 180.0 * (row as f64 + 0.5) / height as f64);
        for column in 0..width {
            let (s, c) = ops::sin_cos_degrees(360.0 * ((column as f64 + 0.5) / width as f64 - 0.5));
            let towards = DVec3::new(level * s, up, -level * c);
            let light: f64 = lamps.iter().map(|lamp| lamp.light(towards)).sum::<f64>() + backdrop(up);
            pixels.push([light as f32; 3]);
        }
    }
    Image { width, height, pixels }
}

/// The walls: brighter above than below.
fn backdrop(up: f64) -> f64 {
    let (from, to) = if up < 0.0 { (0.34, 0.18) } else { (0.34, 0.45) };
    from + (to - from) * up.abs()
}

impl Lamp {
    fn light(&self, towards: DVec3) -> f64 {
        let Some(front) = self.towards.try_normalize() else { return 0.0 };
        let Some(right) = DVec3::Y.cross(front).try_normalize() else { return 0.0 };
        let along = towards.dot(front);
        if along <= 0.0 {
            return 0.0;
        }
        let inside = |axis: DVec3, half: f64| {
            // Soft at the rim.
            let v = (1.1 - (towards.dot(axis) / along).abs() / half) / 0.2;
            let v = v.within(0.0, 1.0);
            v * v * (3.0 - 2.0 * v)
        };
        self.radiance * inside(right, self.half[0]) * inside(front.cross(right), self.half[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_studio_lights_what_faces_the_camera() {
        let Image { width, height, pixels } = studio();
        // Irradiance on a plate that faces +z, where the camera is: the picture's edges.
        let mut sum = 0.0;
        for (i, [v, ..]) in pixels.iter().enumerate() {
            let (up, level) = ops::sin_cos_degrees(90.0 - 180.0 * ((i / width) as f64 + 0.5) / height as f64);
            let (_, c) = ops::sin_cos_degrees(360.0 * (((i % width) as f64 + 0.5) / width as f64 - 0.5));
            let cos = -level * c;
            let _ = up;
            let angle = 2.0 * std::f64::consts::PI * std::f64::consts::PI / (width * height) as f64 * level;
            sum += f64::from(*v) * angle * if cos > 0.0 { cos } else { 0.0 };
        }
        assert!((2.0..2.8).contains(&sum), "{sum}: white is near white");
    }
}
