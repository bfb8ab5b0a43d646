//! Lights of UsdLux, and the light that there is where a stage has none.

use std::f64::consts::PI;
use std::sync::Arc;

use straal_color::space::Space;
use straal_color::spectrum::observer::Observer as Eye;
use straal_color::spectrum::{Quantity, illuminant, thermal};
use straal_math::{Affine, DVec3, ops};
use straal_scene::desc::{
    Camera, Cylinder, Decay, Diffuse, DirectionalLight, Disc, Environment, Falloff, ImageTexture, Lamp,
    Light, Material, MaterialRef, Measured, Node, Perspective, PointLight, Rectangle, ScaleTexture, Spectrum,
    Sphere, SpotLight, Step, Surface, Texture, TextureChannel, TextureFilter, TextureSpace, Transform,
    Varying, Wrap, Wraps,
};
use straal_scene::value::{LinearRgb, Matrix, Name};
use straal_scene::{Diagnostic, Span};

use super::material::of_texture;
use super::texture::stops;
use super::world::Within;
use super::{Translation, within};

/// The most that light may be.
const MOST: f64 = 1e30;

/// How bright a light is, and in what colour.
struct Strength {
    /// What colour is multiplied by.
    factor: f64,
    rgb: [f64; 3],
    /// A black body's temperature, where that alone is the colour.
    kelvin: Option<f64>,
}

impl Strength {
    fn times(&self, factor: f64) -> Spectrum {
        let held = |v: f64| within(v, 0.0, MOST);
        let factor = self.factor * factor;
        match self.kelvin {
            Some(kelvin) => Spectrum::Measured(Box::new(Measured {
                blackbody: Some(kelvin),
                scale: held(factor),
                ..Measured::default()
            })),
            None => Spectrum::Rgb(LinearRgb(self.rgb.map(|v| held(v * factor)))),
        }
    }

    /// As red, green and blue in any case.
    fn rgb(&self) -> [f64; 3] {
        let Some(kelvin) = self.kelvin else { return self.rgb };
        let light = illuminant::of_unit_luminance(&thermal::black_body(kelvin));
        let xyz = Eye::Cie1931.light(&light.bins(Quantity::Emission));
        Space::Srgb.rgb().from_xyz().apply(xyz).map(|v| within(v, 0.0, MOST))
    }
}

impl Translation<'_, '_> {
    /// A number of a light; before version 21.02 inputs had no namespace.
    fn of_light(&self, prim: usize, name: &str, otherwise: f64) -> f64 {
        let found =
            self.stage.number(prim, &format!("inputs:{name}")).or_else(|| self.stage.number(prim, name));
        found.unwrap_or(otherwise)
    }

    fn word_of_light(&self, prim: usize, name: &str) -> Option<(String, usize)> {
        let names = [format!("inputs:{name}"), name.to_owned()];
        let found = |name: &String| Some((self.stage.text(prim, name)?, self.stage.layer_of(prim, name)));
        names.iter().find_map(found).filter(|(word, _)| !word.is_empty())
    }

    /// Radiance of a light, before it is told for its size. `intensity` is that which the light's schema has.
    fn strength(&self, prim: usize, intensity: f64) -> Strength {
        let factor =
            self.of_light(prim, "intensity", intensity) * stops(self.of_light(prim, "exposure", 0.0));
        let colour =
            self.stage.vector::<3>(prim, "inputs:color").or_else(|| self.stage.vector(prim, "color"));
        let rgb = colour.unwrap_or([1.0; 3]).map(|v| within(v, 0.0, MOST));
        let factor = within(factor, 0.0, MOST);
        if self.of_light(prim, "enableColorTemperature", 0.0) == 0.0 {
            return Strength { factor, rgb, kelvin: None };
        }
        let kelvin = within(self.of_light(prim, "colorTemperature", 6500.0), 1000.0, 10_000.0);
        let body = Strength { factor, rgb, kelvin: Some(kelvin) };
        if rgb == [1.0; 3] {
            return body;
        }
        let hot = body.rgb();
        Strength { kelvin: None, rgb: std::array::from_fn(|i| rgb[i] * hot[i]), ..body }
    }

    /// What a prim is called.
    fn called(&self, prim: usize) -> Option<Name> {
        Some(self.stage.prims[prim].name.clone().into())
    }

    /// What a light shows, in its own coordinates; those that are nowhere are added to the scene.
    pub fn light(&mut self, prim: usize, kind: &str, around: &Within) -> Vec<Node> {
        let is_alone = matches!(kind, "DistantLight" | "DomeLight" | "DomeLight_1");
        if is_alone && Self::is_in_object(around) {
            return Vec::new();
        }
        if !self.stage.targets(prim, "light:filters").is_empty() {
            self.warn(prim, "filters of lights are left out");
        }
        match kind {
            "DistantLight" => self.distant(prim, around),
            "DomeLight" | "DomeLight_1" => self.dome(prim, kind, around),
            "SphereLight" | "RectLight" | "DiskLight" | "CylinderLight" => {
                return self.lamp(prim, kind, around);
            }
            _ => self.warn(prim, &format!("`{kind}` is left out")),
        }
        Vec::new()
    }

    fn distant(&mut self, prim: usize, around: &Within) {
        let strength = self.strength(prim, 50_000.0);
        let angle = within(self.of_light(prim, "angle", 0.53), 0.0, 179.0);
        let (sin, _) = ops::sin_cos_degrees(0.5 * angle);
        // What it takes of the sky, times the cosine.
        let size = if angle > 0.0 { PI * sin * sin } else { 1.0 };
        let is_normal = self.of_light(prim, "normalize", 0.0) != 0.0;
        let irradiance = strength.times(if is_normal { 1.0 } else { size });
        let Some(direction) = around.global.vector(-DVec3::Z).try_normalize() else { return };
        self.scene.lights.push(Light::Directional(DirectionalLight {
            direction: Some(direction),
            from: None,
            look_at: None,
            irradiance,
            angle,
            lamp: Lamp::default(),
            name: self.called(prim),
        }));
    }

    fn dome(&mut self, prim: usize, kind: &str, around: &Within) {
        let strength = self.strength(prim, 1.0);
        let format = self.word_of_light(prim, "texture:format").map(|(word, _)| word);
        let mut file = None;
        if let Some((name, layer)) = self.word_of_light(prim, "texture:file") {
            if matches!(format.as_deref(), None | Some("automatic" | "latlong")) {
                file = self.surroundings(layer, &name);
            } else {
                self.warn(prim, "a dome's picture is read in latitude and longitude only: it is left out");
            }
        }
        if !self.stage.targets(prim, "portals").is_empty() {
            self.warn(prim, "portals are left out");
        }
        // Of a newer dome the pole is along the stage's own axis, unless it says another.
        let pole = self.stage.text(prim, "poleAxis");
        let is_upright = kind == "DomeLight_1"
            && (pole.as_deref() == Some("Z")
                || pole.as_deref() != Some("Y")
                    && self.stage.library.layers[0].layer.about.up_axis.as_deref() == Some("Z"));
        let mut place = around.global;
        if is_upright {
            let turn = Affine { rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0]] };
            place = turn.then(&place);
        }
        let place = turned(&place);
        let has_picture = file.is_some();
        let steps = if place.is_identity() { Vec::new() } else { vec![Step::Matrix(Matrix(place))] };
        self.scene.lights.push(Light::Environment(Environment {
            radiance: (!has_picture).then(|| strength.times(1.0)),
            file,
            scale: if has_picture { strength.factor } else { 1.0 },
            tint: if has_picture { Spectrum::Rgb(LinearRgb(strength.rgb())) } else { Spectrum::grey(1.0) },
            // The middle of the picture is seen along +z, and is along -z in straal's.
            rotate: 180.0,
            transform: Transform { steps, ..Transform::default() },
            name: self.called(prim),
            ..Environment::default()
        }));
    }

    /// A light with a size.
    fn lamp(&mut self, prim: usize, kind: &str, around: &Within) -> Vec<Node> {
        let strength = self.strength(prim, 1.0);
        let radius = self.of_light(prim, "radius", 0.5);
        let length = self.of_light(prim, "length", 1.0);
        let [width, height] = ["width", "height"].map(|name| self.of_light(prim, name, 1.0));
        // Areas are told in the stage's units, where lights stand.
        let to_stage = around.global.then(&self.root.inverse().unwrap_or(Affine::IDENTITY));
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| to_stage.vector(axis).length());
        let cross = |a: usize, b: usize| axes[a] * axes[b];
        let (area, across) = match kind {
            "SphereLight" => {
                let r = radius * ops::pow_d(axes[0] * axes[1] * axes[2], 1.0 / 3.0);
                (4.0 * PI * r * r, PI * r * r)
            }
            "RectLight" => (width * height * cross(0, 1), width * height * cross(0, 1)),
            "DiskLight" => (PI * radius * radius * cross(0, 1), PI * radius * radius * cross(0, 1)),
            _ => {
                let area = 2.0 * PI * radius * length * axes[0] * 0.5 * (axes[1] + axes[2]);
                (area, area / PI)
            }
        };
        let is_normal = self.of_light(prim, "normalize", 0.0) != 0.0;
        let is_point =
            kind == "SphereLight" && (self.of_light(prim, "treatAsPoint", 0.0) != 0.0 || radius <= 0.0);
        let is_line = kind == "CylinderLight" && self.of_light(prim, "treatAsLine", 0.0) != 0.0;
        if is_line {
            self.warn(prim, "a light that is to be a line is a tube");
        }
        let has_size = area > 0.0 && area.is_finite();
        if !is_point && !has_size {
            self.warn(prim, "it is left out: it has no size");
            return Vec::new();
        }
        let per_area = if is_normal { 1.0 / area } else { 1.0 };
        let cone = self.of_light(prim, "shaping:cone:angle", 180.0);
        let is_shaped = self.stage.has(prim, "inputs:shaping:cone:angle") && cone < 90.0
            || self.of_light(prim, "shaping:focus", 0.0) > 0.0;
        if self.word_of_light(prim, "shaping:ies:file").is_some() {
            self.warn(prim, "what was measured of a lamp is left out");
        }
        if is_point || is_shaped && kind == "SphereLight" {
            // In a unit of the stage, then in metres.
            let intensity = if area > 0.0 {
                across * per_area
            } else if is_normal {
                0.25
            } else {
                1.0
            };
            let intensity = strength.times(intensity * self.unit * self.unit);
            self.point(prim, around, intensity, is_shaped.then_some(cone));
            return Vec::new();
        }
        if is_shaped {
            self.warn(prim, "the shape of its beam is left out");
        }
        let emission = self.picture_of_lamp(prim, kind, &strength, per_area);
        let emission = emission.unwrap_or_else(|| Varying::Constant(strength.times(per_area)));
        let black = Diffuse { reflectance: Varying::Constant(Spectrum::grey(0.0)), ..Diffuse::default() };
        let surface = Surface {
            material: Some(MaterialRef::Inline(Box::new(Material::Diffuse(black)))),
            emission: Some(emission),
            name: self.called(prim),
            ..Surface::default()
        };
        vec![match kind {
            "SphereLight" => Node::Sphere(Sphere { radius, surface, ..Sphere::default() }),
            // Its front is towards -z, where its own right is on the left.
            "RectLight" => Node::Rectangle(Rectangle {
                corner: DVec3::new(0.5 * width, -0.5 * height, 0.0),
                edges: [DVec3::X * -width, DVec3::Y * height],
                surface,
                ..Rectangle::default()
            }),
            "DiskLight" => Node::Disc(Disc { normal: -DVec3::Z, radius, surface, ..Disc::default() }),
            _ => {
                let [from, to] = [DVec3::X * (-0.5 * length), DVec3::X * (0.5 * length)];
                Node::Cylinder(Cylinder { from, to, radius, surface, ..Cylinder::default() })
            }
        }]
    }

    /// A light that is a point, perhaps within a cone.
    fn point(&mut self, prim: usize, around: &Within, intensity: Spectrum, cone: Option<f64>) {
        if Self::is_in_object(around) {
            return;
        }
        let position = around.global.point(DVec3::ZERO);
        let Some(cone) = cone else {
            self.scene.lights.push(Light::Point(PointLight {
                position,
                intensity,
                decay: Decay::InverseSquare,
                lamp: Lamp::default(),
                name: self.called(prim),
            }));
            return;
        };
        self.warn(prim, "a lamp with a beam is a spot without a size");
        let softness = within(self.of_light(prim, "shaping:cone:softness", 0.0), 0.0, 1.0);
        let cutoff = within(cone, 0.001, 180.0);
        let Some(direction) = around.global.vector(-DVec3::Z).try_normalize() else { return };
        self.scene.lights.push(Light::Spot(SpotLight {
            position,
            direction: Some(direction),
            look_at: None,
            intensity,
            cutoff,
            beam: Some(cutoff * (1.0 - softness)),
            falloff: Falloff::Smooth,
            texture: None,
            up: DVec3::Y,
            lamp: Lamp::default(),
            name: self.called(prim),
        }));
    }

    /// The picture that a rectangle shines in.
    fn picture_of_lamp(
        &mut self,
        prim: usize,
        kind: &str,
        strength: &Strength,
        per_area: f64,
    ) -> Option<Varying<Spectrum>> {
        let (name, layer) = self.word_of_light(prim, "texture:file").filter(|_| kind == "RectLight")?;
        let file = self.bitmap(prim, layer, &name)?;
        let image = Texture::Image(ImageTexture {
            file,
            color_space: TextureSpace::Auto,
            channel: TextureChannel::Luminance,
            filter: TextureFilter::Ewa,
            anisotropy: 16.0,
            wrap: Wraps([Wrap::Clamp, Wrap::Clamp]),
            mapping: straal_scene::desc::Mapping::default(),
        });
        let rgb = strength.rgb();
        let most = rgb.into_iter().fold(0.0, |most, v| if v > most { v } else { most });
        if most <= 0.0 {
            return None;
        }
        Some(of_texture(Texture::Scale(ScaleTexture {
            of: of_texture(image),
            by: within(most * strength.factor * per_area, 0.0, MOST).into(),
            tint: Varying::Constant(Spectrum::Rgb(LinearRgb(rgb.map(|v| within(v / most, 0.0, 1.0))))),
        })))
    }

    /// What a mesh shines that is a light as well.
    pub fn mesh_light(&mut self, prim: usize, surface: &mut Surface) {
        if !self.stage.prims[prim].schemas.iter().any(|schema| schema == "MeshLightAPI") {
            return;
        }
        if self.of_light(prim, "normalize", 0.0) != 0.0 {
            self.warn(prim, "the light of a mesh isn't told for its size");
        }
        let emission = self.strength(prim, 1.0).times(1.0);
        surface.emission = Some(Varying::Constant(emission));
    }

    /// Whether anything in the world shines.
    pub fn has_lamps(&self) -> bool {
        let mut found = false;
        let shines = |material: &Material| {
            matches!(material, Material::Gltf(m) if m.emissive != Varying::Constant(Spectrum::grey(0.0))
                && m.emissive != Varying::Constant(Spectrum::Rgb(LinearRgb([0.0; 3]))))
        };
        self.scene.visit(|node| {
            let Some(surface) = node.surface() else { return };
            let named = match &surface.material {
                Some(MaterialRef::Named(link)) => self.scene.materials.get(&link.name.value),
                Some(MaterialRef::Inline(material)) => Some(&**material),
                None => None,
            };
            found |= surface.emission.is_some() || named.is_some_and(shines);
        });
        found
    }

    /// Light from all around, as there is in a studio, for a stage that has none.
    pub fn studio(&mut self) {
        let message = format!("`{}` has no lights: it is shown in a studio's", self.name);
        self.stage.library.means.d.push(Diagnostic::warning(Span::NONE, message));
        let image = self.made.image(format!("{}#studio", self.name), Arc::new(crate::scene::gltf::studio()));
        let mut rotate = 0.0;
        if let Camera::Perspective(Perspective { observer, .. }) = &self.scene.camera {
            let away = observer.eye - observer.look_at;
            if away.x != 0.0 || away.z != 0.0 {
                rotate = ops::atan2_d(away.x, away.z) * (180.0 / PI);
            }
        }
        let file = Some(image);
        self.scene.lights.push(Light::Environment(Environment { file, rotate, ..Environment::default() }));
    }
}

/// The turn of a place, without its scale.
fn turned(place: &Affine) -> Affine {
    let column = |i: usize| DVec3::new(place.rows[0][i], place.rows[1][i], place.rows[2][i]);
    let (Some(x), Some(y)) = (column(0).try_normalize(), column(1).try_normalize()) else {
        return Affine::IDENTITY;
    };
    let Some(z) = x.cross(y).try_normalize() else { return Affine::IDENTITY };
    let y = z.cross(x);
    Affine { rows: [[x.x, y.x, z.x, 0.0], [x.y, y.y, z.y, 0.0], [x.z, y.z, z.z, 0.0]] }
}
