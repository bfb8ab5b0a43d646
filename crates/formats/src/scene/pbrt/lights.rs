//! Lights, and shapes that are lights.

use std::rc::Rc;

use straal_math::{Affine, DVec3, ops};
use straal_scene::desc::{
    Decay, DirectionalLight, Environment, EnvironmentLayout, Falloff, Goniometric, ImageTexture, Lamp, Light,
    Mapping, PointLight, Portal, Projector, Spectrum, SpotLight, Texture, TextureChannel, TextureFilter,
    TextureOf, TextureSpace, UvMapping, Varying, Wrap, Wraps,
};
use straal_scene::photometry::{Photometry, Planes};
use straal_scene::{Bitmap, Image, Span, Spanned};

use super::params::{Params, Type};
use super::spectra::{Role, times};
use super::state::as_transform;
use super::textures::{inline, scaled};
use super::{Reader, Thing};
use crate::image;

/// What shapes shine with from here on.
pub(super) struct AreaLight {
    /// Radiance of the front, without what a power asks for.
    pub radiance: Varying<Spectrum>,
    pub two_sided: bool,
    /// Power in all that each shape gives, if it is told by that.
    pub power: Option<f64>,
    pub span: Span,
}

/// pbrt's lights.
const KINDS: [&str; 6] = ["distant", "goniometric", "infinite", "point", "projection", "spot"];

impl Reader<'_, '_> {
    /// A light that is no shape.
    pub(super) fn light(&mut self, thing: Thing) {
        let Thing { kind, params } = thing;
        let params = params.within(&self.state.attributes.light);
        let Some(map) = self.still(params.span) else { return };
        match kind.as_str() {
            "point" => self.point(&params, &map),
            "spot" => self.spot(&params, &map),
            "distant" => self.distant(&params, &map),
            "infinite" => self.infinite(&params, &map),
            "goniometric" => self.goniometric(&params, &map),
            "projection" => self.projection(&kind, &params, &map),
            "exinfinite" => {
                self.warn(kind.span, "`exinfinite` of pbrt-v3 is taken for `infinite`");
                self.infinite(&params, &map);
            }
            _ => return self.unknown("light", &kind, &KINDS),
        }
        params.complain(&format!("the light `{}`", kind.value), self.means.d);
    }

    /// A light's own colour times its scale and what the film makes of it.
    fn strength(&mut self, params: &Params, name: &'static str) -> Spectrum {
        let own = self.spectrum(params, name, Role::Illuminant).unwrap_or(Self::white());
        let scale = self.scale(params);
        times(&own, scale * self.light_scale)
    }

    /// The factor of a light; in version 3 a colour.
    fn scale(&mut self, params: &Params) -> f64 {
        if let Some(rgb) = params.find("scale", |t| t == Type::Rgb).and_then(|p| p.numbers()) {
            let mean = rgb.iter().sum::<f64>() / rgb.len() as f64;
            self.warn_once(
                params.span,
                "the `scale` of a light is a number in pbrt-v4: the mean of the colour is taken",
            );
            return positive(mean);
        }
        let scale = params.float("scale", 1.0);
        if scale < 0.0 {
            self.warn(params.span, "the `scale` of a light must not be below 0: 0 is taken");
        }
        positive(scale)
    }

    fn point(&mut self, params: &Params, map: &Affine) {
        let from = params.vector("from").unwrap_or(DVec3::ZERO);
        let mut intensity = self.strength(params, "I");
        if let Some(power) = params.maybe_float("power").filter(|v| *v > 0.0) {
            intensity = times(&intensity, power / (4.0 * std::f64::consts::PI));
        }
        self.scene.lights.push(Light::Point(PointLight {
            position: map.point(from),
            intensity,
            decay: Decay::InverseSquare,
            lamp: Lamp::default(),
            name: None,
        }));
    }

    fn spot(&mut self, params: &Params, map: &Affine) {
        let from = params.vector("from").unwrap_or(DVec3::ZERO);
        let to = params.vector("to").unwrap_or(DVec3::Z);
        let cutoff = params.float("coneangle", 30.0);
        let beam = cutoff - params.float("conedeltaangle", 5.0);
        let mut intensity = self.strength(params, "I");
        if let Some(power) = params.maybe_float("power").filter(|v| *v > 0.0) {
            let cos = |degrees: f64| ops::sin_cos_degrees(degrees).1;
            let (end, start) = (cos(cutoff), cos(beam));
            let all = 2.0 * std::f64::consts::PI * ((1.0 - start) + (start - end) / 2.0);
            if all > 0.0 {
                intensity = times(&intensity, power / all);
            }
        }
        let direction = map.vector(to - from);
        if !(0.001..=180.0).contains(&cutoff) || direction.try_normalize().is_none() {
            return self.error(
                params.span,
                "this spot has no cone: `coneangle` must be above 0, and `to` not `from`",
            );
        }
        let beam = if beam > 0.0 { if beam < cutoff { beam } else { cutoff } } else { 0.0 };
        self.scene.lights.push(Light::Spot(SpotLight {
            texture: None,
            up: DVec3::Y,
            position: map.point(from),
            direction: Some(direction),
            look_at: None,
            intensity,
            cutoff,
            beam: Some(beam),
            falloff: Falloff::Smooth,
            lamp: Lamp::default(),
            name: None,
        }));
    }

    fn distant(&mut self, params: &Params, map: &Affine) {
        let from = params.vector("from").unwrap_or(DVec3::ZERO);
        let to = params.vector("to").unwrap_or(DVec3::Z);
        let mut irradiance = self.strength(params, "L");
        if let Some(illuminance) = params.maybe_float("illuminance").filter(|v| *v > 0.0) {
            irradiance = times(&irradiance, illuminance);
        }
        let direction = map.vector(to - from);
        if direction.try_normalize().is_none() {
            return self.error(params.span, "this light comes from nowhere: `from` is `to`");
        }
        self.scene.lights.push(Light::Directional(DirectionalLight {
            angle: 0.0,
            direction: Some(direction),
            from: None,
            look_at: None,
            irradiance,
            lamp: Lamp::default(),
            name: None,
        }));
    }

    fn infinite(&mut self, params: &Params, map: &Affine) {
        let illuminance = params.maybe_float("illuminance").filter(|v| *v > 0.0);
        params.pass_over(&["samples", "nsamples"]);
        let portals = self.portals(params);
        let older = params.string("mapname").cloned();
        let file = params.string("filename").cloned().or_else(|| older.clone());
        let Some(file) = file else {
            let mut radiance = self.strength(params, "L");
            if let Some(illuminance) = illuminance {
                radiance = times(&radiance, illuminance / std::f64::consts::PI);
            }
            return self.surroundings(Environment {
                radiance: Some(radiance),
                portals,
                ..self.around(map, params.span)
            });
        };
        let mut scale = self.scale(params) * self.light_scale;
        if params.has("L") {
            // Version 3 multiplies the picture by it.
            let tint = self.spectrum(params, "L", Role::Illuminant);
            match tint.as_ref().and_then(Spectrum::rgb) {
                Some(rgb) => scale *= rgb.0.iter().sum::<f64>() / 3.0,
                None => self.warn(params.span, "`L` beside a picture is passed over"),
            }
        }
        let size = self.picture_size(&file);
        let is_square = size.is_none_or(|[w, h]| w == h);
        let mut layout = EnvironmentLayout::EqualArea;
        let mut transform = *map;
        if older.is_some() || !is_square {
            let why = if older.is_some() { "as pbrt-v3 has it" } else { "since it isn't square" };
            self.warn(file.span, format!("this picture is taken to be in latitude and longitude, {why}"));
            layout = EnvironmentLayout::LatitudeLongitude;
            // Version 3: up is +z, and the left edge +x, from which it goes on to +y.
            let upright =
                Affine { rows: [[0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]] };
            transform = upright.then(map);
        }
        if let Some(wanted) = illuminance {
            match self.illuminance(&file) {
                Some(found) if found > 0.0 => scale *= wanted / found,
                Some(_) => self.warn(file.span, "this picture is black: `illuminance` is passed over"),
                None => return,
            }
        }
        if !(scale as f32).is_finite() {
            return self.error(params.span, "this light is brighter than numbers go");
        }
        let asset = self.made.in_file::<Image>(file);
        let around = self.around(&transform, params.span);
        self.surroundings(Environment { file: Some(asset), layout, scale, portals, ..around });
    }

    /// The opening that light comes in through, told by its four corners: seen from the room they run clockwise.
    fn portals(&mut self, params: &Params) -> Vec<Portal> {
        if !params.has("portal") {
            return Vec::new();
        }
        let corners =
            params.singles("portal", &[Type::Point3]).and_then(|(v, _)| v.first_chunk::<12>().copied());
        let Some(corners) = corners else {
            self.warn(params.span, "a `portal` has four corners: light comes from all around");
            return Vec::new();
        };
        let place = *self.state.transform();
        let [a, b, _, d] = [0, 1, 2, 3].map(|i| {
            let [x, y, z] = [0, 1, 2].map(|k| f64::from(corners[3 * i + k]));
            place.point(DVec3::new(x, y, z))
        });
        vec![Portal { corner: a, edges: [b - a, d - a] }]
    }

    fn surroundings(&mut self, light: Environment) {
        self.scene.lights.push(Light::Environment(light));
    }

    /// Surroundings of which nothing but the axes is said.
    fn around(&self, map: &Affine, span: Span) -> Environment {
        // Only how they are turned counts.
        let mut turned = *map;
        (0..3).for_each(|row| turned.rows[row][3] = 0.0);
        Environment { transform: as_transform(&turned, span), ..Environment::default() }
    }

    /// Width and height of a picture, if it can be found.
    fn picture_size(&mut self, file: &Spanned<String>) -> Option<[usize; 2]> {
        // What is wrong with it is told when it is read.
        let found = self.means.finder.find(self.means.base, file).ok()?;
        let header = image::Header::open(&found.path, self.means.limits).ok()?;
        Some([header.width, header.height])
    }

    /// What falls on a surface that faces +z of an equal-area picture of all around.
    fn illuminance(&mut self, file: &Spanned<String>) -> Option<f64> {
        let image = self.read_picture(file)?;
        let (w, h) = (image.width as f64, image.height as f64);
        let mut sum = 0.0;
        for (i, pixel) in image.pixels.iter().enumerate() {
            let (x, y) = ((i % image.width) as f64 + 0.5, (i / image.width) as f64 + 0.5);
            let z = height_of([x / w, y / h]);
            if z > 0.0 {
                sum += z * f64::from(straal_color::luminance(*pixel));
            }
        }
        Some(sum * 2.0 * std::f64::consts::PI / (w * h))
    }

    /// The pixels of a picture of light.
    fn read_picture(&mut self, file: &Spanned<String>) -> Option<Image> {
        let path = match self.found(file) {
            Ok(path) => path,
            Err(refusal) => {
                self.refuse(file, refusal);
                return None;
            }
        };
        let read = image::bytes(&path, self.means.limits)
            .map_err(|refusal| refusal.problem)
            .and_then(|bytes| image::surroundings(&bytes, self.means.limits).map_err(|e| e.to_string()));
        match read {
            Ok((image, _)) => Some(image),
            Err(problem) => {
                self.refuse(file, crate::files::Refusal::new(problem));
                None
            }
        }
    }

    /// A lamp with a picture of its directions: evenly by its mean.
    fn goniometric(&mut self, params: &Params, map: &Affine) {
        let Some(file) = params.string("filename").or(params.string("mapname")).cloned() else {
            // As bright in all directions.
            return self.point(params, map);
        };
        let Some(image) = self.read_picture(&file) else { return };
        if image.width != image.height {
            self.warn(
                file.span,
                "a picture of a `goniometric` light is square: this one is taken as if it were",
            );
        }
        let grey = |p: &[f32; 3]| p.iter().map(|v| f64::from(*v)).sum::<f64>() / 3.0;
        let mean = image.pixels.iter().map(grey).sum::<f64>() / image.pixels.len() as f64;
        let mut scale = self.scale(params) * self.light_scale;
        if let Some(power) = params.maybe_float("power").filter(|v| *v > 0.0) {
            scale *= if mean > 0.0 { power / (4.0 * std::f64::consts::PI * mean) } else { 0.0 };
        }
        // The colour is told by itself; that of spectra counts as 1, as in pbrt.
        let own = self.spectrum(params, "I", Role::Illuminant).unwrap_or(Self::white());
        if let Some(rgb) = own.rgb() {
            scale *= f64::from(straal_color::luminance(rgb.0.map(|v| v as f32)));
        }
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| map.vector(axis));
        let is_mirrored = x.cross(y).dot(z) < 0.0;
        if !(mean > 0.0 && scale > 0.0 && (scale as f32).is_finite()) || z.try_normalize().is_none() {
            return self.warn(params.span, "this light sends out nothing: it is left out");
        }
        let lamp = lamp_of(&image, is_mirrored, grey);
        let name = format!("{}#lamp {}", file.value, self.scene.lights.len());
        let file = self.made.photometry(Spanned::new(name, file.span), std::sync::Arc::new(lamp));
        self.scene.lights.push(Light::Goniometric(Goniometric {
            position: map.point(DVec3::ZERO),
            file,
            direction: Some(z),
            look_at: None,
            zero: x,
            color: own,
            efficacy: CANDELA,
            scale,
            lamp: Lamp::default(),
            name: None,
        }));
    }

    /// A projector. pbrt's sends as much light in all directions where its picture is the same, so that a screen gets less towards the edges.
    fn projection(&mut self, kind: &Spanned<String>, params: &Params, map: &Affine) {
        let Some(file) = params.string("filename").or(params.string("mapname")).cloned() else {
            return self.error(params.span, "a light `projection` needs a `filename`");
        };
        let fov = params.float("fov", 90.0);
        let [width, height] = self.picture_size(&file).unwrap_or([1, 1]).map(|n| n as f64);
        let aspect = if height > 0.0 { width / height } else { 1.0 };
        // The angle spans the shorter side.
        let (sin, cos) = ops::sin_cos_degrees(0.5 * fov);
        let tan = sin / cos * if aspect > 1.0 { aspect } else { 1.0 };
        let across = 2.0 * ops::atan2_d(tan, 1.0).to_degrees();
        let [right, up, forward] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| map.vector(axis));
        let fits = fov > 0.0 && (0.1..=179.0).contains(&across) && (0.01..=100.0).contains(&aspect);
        if !fits || forward.cross(up).try_normalize().is_none() {
            return self.error(params.span, "this projector throws no picture: its `fov` is out of range");
        }
        self.warn_once(
            kind.span,
            "a projector's picture is even on a screen here; pbrt's falls off towards the edges",
        );
        let mut intensity = self.scale(params) * self.light_scale;
        if let Some(power) = params.maybe_float("power").filter(|v| *v > 0.0) {
            let Some(image) = self.read_picture(&file) else { return };
            let sum: f64 = image.pixels.iter().map(|p| f64::from(straal_color::luminance(*p))).sum();
            let mean = sum / image.pixels.len() as f64;
            // On the plane at distance 1, where a picture is even, as much falls on each part.
            let area = 4.0 * tan * tan / aspect;
            intensity = if mean > 0.0 { intensity * power / (area * mean) } else { 0.0 };
        }
        if !(intensity as f32).is_finite() {
            return self.error(params.span, "this light is brighter than numbers go");
        }
        // With x to the right as pbrt sees it.
        let is_mirrored = right.dot(forward.cross(up)) < 0.0;
        let uv = match is_mirrored {
            true => UvMapping { scale: [-1.0, 1.0], rotate: 0.0, translate: [1.0, 0.0] },
            false => UvMapping::default(),
        };
        let picture = TextureOf::Inline(Texture::Image(ImageTexture {
            file: self.made.in_file::<Bitmap>(file),
            color_space: TextureSpace::Auto,
            channel: TextureChannel::Luminance,
            filter: TextureFilter::Bilinear,
            anisotropy: 16.0,
            wrap: Wraps([Wrap::Clamp, Wrap::Clamp]),
            mapping: Mapping::Uv(uv),
        }));
        self.scene.lights.push(Light::Projector(Projector {
            position: map.point(DVec3::ZERO),
            direction: Some(forward),
            look_at: None,
            up,
            picture,
            intensity,
            fov: across,
            aspect: Some(aspect),
            lamp: Lamp::default(),
            name: None,
        }));
    }

    /// What the shapes that follow shine with.
    pub(super) fn area_light(&mut self, thing: Thing) {
        let Thing { kind, params } = thing;
        let params = params.within(&self.state.attributes.light);
        if !matches!(kind.as_str(), "diffuse" | "area") {
            return self.unknown("area light", &kind, &["diffuse"]);
        }
        params.pass_over(&["samples", "nsamples"]);
        let own = self.strength(&params, "L");
        let mut radiance = Varying::Constant(own.clone());
        if let Some(file) = params.string("filename").cloned() {
            let texture = Texture::Image(ImageTexture {
                file: self.made.in_file::<Bitmap>(file),
                color_space: TextureSpace::Auto,
                channel: TextureChannel::Luminance,
                filter: TextureFilter::Bilinear,
                anisotropy: 16.0,
                wrap: Wraps([Wrap::Clamp, Wrap::Clamp]),
                mapping: Mapping::default(),
            });
            radiance = scaled(inline(texture), Varying::Constant(own));
        }
        let power = params.maybe_float("power").filter(|v| *v > 0.0);
        let two_sided = params.bool("twosided", false);
        params.complain(&format!("the area light `{}`", kind.value), self.means.d);
        self.state.area_light = Some(Rc::new(AreaLight { radiance, two_sided, power, span: params.span }));
    }

    /// What a shape of some area shines with, in so many parts that are a light each.
    pub(super) fn shine(&mut self, area: f64, parts: usize, span: Span) -> Option<(Varying<Spectrum>, bool)> {
        let light = self.state.area_light.clone()?;
        if self.object.is_some() {
            self.warn_once(span, "what is in an object doesn't shine in pbrt: its light is left out");
            return None;
        }
        let mut radiance = light.radiance.clone();
        if let Some(power) = light.power {
            // Each triangle of a mesh gives all of it.
            let sides = if light.two_sided { 2.0 } else { 1.0 };
            let factor = power * parts as f64 / (std::f64::consts::PI * area * sides);
            if !((factor as f32) > 0.0 && (factor as f32).is_finite()) {
                self.warn(light.span, "this has no area for its `power` to come from: it doesn't shine");
                return None;
            }
            radiance = scaled(radiance, Varying::Constant(Spectrum::grey(factor)));
        }
        Some((radiance, light.two_sided))
    }
}

/// Candela that stand for 1 of a picture's numbers, and lumens for a watt.
const CANDELA: f64 = 683.0;

/// What a picture of all directions in equal areas says of a lamp whose axis is its z.
fn lamp_of(image: &Image, is_mirrored: bool, grey: impl Fn(&[f32; 3]) -> f64) -> Photometry {
    let planes: Vec<f64> = (0..=180).map(|i| 2.0 * f64::from(i)).collect();
    let angles: Vec<f64> = (0..=180).map(f64::from).collect();
    let mut candela = Vec::with_capacity(planes.len() * angles.len());
    for plane in &planes {
        let (s, c) = ops::sin_cos_degrees(if is_mirrored { -*plane } else { *plane });
        for angle in &angles {
            let (sin, cos) = ops::sin_cos_degrees(*angle);
            let [u, v] = place_of(DVec3::new(sin * c, sin * s, cos));
            let at = |share: f64, size: usize| ((share * size as f64) as usize).min(size - 1);
            let pixel = image.pixels[at(v, image.height) * image.width + at(u, image.width)];
            candela.push((grey(&pixel) * CANDELA) as f32);
        }
    }
    candela.iter_mut().for_each(|v| *v = if v.is_finite() && *v > 0.0 { *v } else { 0.0 });
    Photometry { system: Planes::C, planes, angles, candela }
}

/// Where a picture of equal areas shows a unit vector (Clarberg 2008, as pbrt-v4 has it).
fn place_of(d: DVec3) -> [f64; 2] {
    let [x, y, z] = [d.x.abs(), d.y.abs(), d.z.abs()];
    let r = if z < 1.0 { (1.0 - z).sqrt() } else { 0.0 };
    let part = if x == 0.0 && y == 0.0 { 0.0 } else { ops::atan2_d(y, x) * std::f64::consts::FRAC_2_PI };
    let mut v = part * r;
    let mut u = r - v;
    if d.z < 0.0 {
        (u, v) = (1.0 - v, 1.0 - u);
    }
    let sign = |part: f64, of: f64| if of < 0.0 { -part } else { part };
    [0.5 * (sign(u, d.x) + 1.0), 0.5 * (sign(v, d.y) + 1.0)]
}

/// What of a number is above 0.
fn positive(v: f64) -> f64 {
    if v > 0.0 { v } else { 0.0 }
}

/// The z of the direction that a place of the unit square shows (Clarberg 2008, as pbrt-v4 has it).
fn height_of([u, v]: [f64; 2]) -> f64 {
    let far = 1.0 - ((2.0 * u - 1.0).abs() + (2.0 * v - 1.0).abs());
    let r = 1.0 - far.abs();
    let z = 1.0 - r * r;
    if far < 0.0 { -z } else { z }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture that is bright where +x is lights +x, whichever way the axes are turned.
    #[test]
    fn a_picture_becomes_a_lamps_directions() {
        let side = 64;
        let mut image = Image { width: side, height: side, pixels: vec![[0.25; 3]; side * side] };
        // The right middle of the square is +x, the lower middle +y.
        for j in 24..40 {
            (52..64).for_each(|i| image.pixels[j * side + i] = [2.0; 3]);
        }
        let grey = |p: &[f32; 3]| f64::from(p[0]);
        for is_mirrored in [false, true] {
            let lamp = lamp_of(&image, is_mirrored, grey);
            assert!(lamp.is_whole());
            assert_eq!((lamp.at(0.0, 90.0), lamp.at(180.0, 90.0)), (2.0 * CANDELA, 0.25 * CANDELA));
            assert_eq!((lamp.at(90.0, 90.0), lamp.at(0.0, 0.0)), (0.25 * CANDELA, 0.25 * CANDELA));
        }
        image.pixels = vec![[0.25; 3]; side * side];
        for j in 52..64 {
            (24..40).for_each(|i| image.pixels[j * side + i] = [2.0; 3]);
        }
        let bright = |is_mirrored| {
            let lamp = lamp_of(&image, is_mirrored, grey);
            [90.0, 270.0].map(|plane| lamp.at(plane, 90.0) / CANDELA)
        };
        assert_eq!((bright(false), bright(true)), ([2.0, 0.25], [0.25, 2.0]));
    }
}
