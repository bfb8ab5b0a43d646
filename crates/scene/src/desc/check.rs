//! What the parts of one description must be to each other. Each function is named at its definition and is called
//! when the parts by themselves are sound.

use straal_math::{Affine, DVec3, ops};

use straal_color::spectrum::refraction::Metal;
use straal_color::spectrum::{self, Fault, TabulatedSpectrum};

use crate::decode::{Decoder, Keys};
use crate::desc::{
    AmbientOcclusion, Annulus, Bezier, Bilinear, Blend, BoxDistance, CameraAt, CameraMapping, Capsule,
    CoatedConductor, ColorIn, Combination, Conductor, Cone, CubeMap, Cuboid, CurveBasis, CurveForm, Curves,
    Cylinder, CylinderDistance, Dielectric, DiffuseTransmission, DirectionalLight, Disc, DistanceField,
    Environment, EnvironmentLayout, Film, Fisheye, FisheyeProjection, Formula, Fresnel, Gaussian,
    Goniometric, GridDistance, HeightField, Hyperboloid, Index, Interior, Lens, LensProfile, LightSampling,
    LightTracer, Measured, Moved, Node, Observer, OcclusionFalloff, Orthographic, Panorama, Paraboloid,
    Perspective, Plane, Portal, Principled, Projector, RampTexture, Realistic, Rectangle, RemapTexture,
    Roulette, Sky, SpectralChannels, Spectrum, Sphere, SpotLight, Surface, Texture, ThinFilm, Torus,
    Transparent, Triangle, TriangleMesh, Varying, Viewpoint, When,
};
use crate::diagnostic::Diagnostic;
use crate::limit::Limit;
use crate::span::Span;
use crate::tree::shown;
use crate::value::{Known, LinearRgb};

/// Most pixels of a picture: 2^30, beyond which a film of full precision would need tens of gigabytes.
const MOST_PIXELS: u64 = 1 << 30;

fn view(eye: DVec3, target: DVec3, up: DVec3, key: &str, keys: &Keys<'_>, d: &mut Decoder) {
    if eye == target {
        let message = format!("`eye` and `{key}` are the same point, so there is no direction to look in");
        d.push(Diagnostic::error(keys.span(key), message).related(keys.span("eye"), "`eye` is here"));
    } else if up == DVec3::ZERO {
        d.push(Diagnostic::error(keys.span("up"), "`up` has no direction: all three numbers are 0"));
    } else if Affine::look_at(eye, target, up).is_none() {
        let help = "choose another `up`, such as `up: [0, 0, 1]` or `up: [0, 1, 0]`";
        d.push(Diagnostic::error(keys.span("up"), "`up` is along the view").help(help));
    }
}

/// A camera's place and view, at the beginning and at its keyframes.
fn observer(o: &Observer, keys: &Keys<'_>, d: &mut Decoder) {
    view(o.eye, o.look_at, o.up, "look_at", keys, d);
    let [open, close] = o.shutter;
    if open > close {
        let message = format!("the shutter closes at {close}, before it opens at {open}");
        d.push(Diagnostic::error(keys.span("shutter"), message).help("it is `[open, close]`"));
    }
    for CameraAt { time, eye, look_at, up, span, .. } in o.keyframes().into_iter().skip(1) {
        let message = if eye == look_at {
            format!("at time {time} the camera is where it looks, so there is no direction to look in")
        } else if Affine::look_at(eye, look_at, up).is_none() {
            format!("at time {time} the camera's `up` has no direction, or that of the view")
        } else {
            continue;
        };
        d.push(Diagnostic::error(span, message));
    }
}

pub(super) fn perspective(c: &Perspective, keys: &Keys<'_>, d: &mut Decoder) {
    observer(&c.observer, keys, d);
    for (a, has_a, b, has_b) in [
        ("view_distance", c.view_distance.is_some(), "pixel_size", c.pixel_size.is_some()),
        ("pixel_size", c.pixel_size.is_some(), "view_distance", c.view_distance.is_some()),
    ] {
        if has_a && !has_b {
            let message = format!("`{a}` needs `{b}`: together they say how much of the view plane is seen");
            d.push(Diagnostic::error(keys.key_span(a), message));
        }
    }
    // What the angle of view is by each of the ways to tell it.
    let degrees =
        |tan: f64| format!("{:.4}", 2.0 * ops::atan2_d(tan, 1.0).to_degrees()).parse::<f64>().unwrap_or(0.0);
    let mut said = Vec::new();
    if let Some(fov) = c.fov {
        said.push(("fov", format!("`fov` of {fov} degrees")));
    }
    if let Some(f) = c.focal_length {
        let angle = degrees(0.5 * c.sensor / f);
        said.push((
            "focal_length",
            format!("`focal_length` of {f} mm ({angle} degrees with a sensor of {} mm)", c.sensor),
        ));
    }
    if c.view_distance.is_some() {
        said.push(("view_distance", "`view_distance` and `pixel_size`".to_owned()));
    }
    if let [(first, a), .., (last, b)] = said.as_slice() {
        let complaint = Diagnostic::error(
            keys.key_span(last),
            format!("the angle of view is said twice: by {a} and by {b}"),
        );
        let complaint = complaint.related(keys.key_span(first), format!("`{first}` is here"));
        d.push(complaint.help("say it in one way only"));
    }
}

pub(super) fn lens(l: &Lens, keys: &Keys<'_>, d: &mut Decoder) {
    one_of("lens", ("radius", l.radius.is_some()), ("f_number", l.f_number.is_some()), keys, d);
    if l.focus_distance.is_some() && l.focus_on.is_some() {
        let complaint = Diagnostic::error(
            keys.key_span("focus_on"),
            "`lens` takes `focus_distance` or `focus_on`, not both",
        );
        d.push(complaint.related(keys.key_span("focus_distance"), "`focus_distance` is here"));
    }
    if l.blades.is_some() && l.profile != LensProfile::Uniform {
        let message = "a Gaussian opening is round: it has no `blades`";
        let complaint = Diagnostic::error(keys.key_span("blades"), message);
        d.push(complaint.related(keys.key_span("profile"), "`profile` is here"));
    }
}

pub(super) fn orthographic(c: &Orthographic, keys: &Keys<'_>, d: &mut Decoder) {
    observer(&c.observer, keys, d);
}

pub(super) fn realistic(c: &Realistic, keys: &Keys<'_>, d: &mut Decoder) {
    let span = keys.span("elements");
    let is_sound = |[radius, thickness, index, diameter]: &[f64; 4]| {
        let is_stop = *radius == 0.0;
        radius.abs() < 1e6
            && (0.0..1e4).contains(thickness)
            && (is_stop || *index == 0.0 || (1.0..5.0).contains(index))
            && *diameter > 0.0
            && *diameter < 1e4
            && (is_stop || *diameter <= 2.0 * radius.abs())
    };
    if c.elements.len() > 100 {
        d.push(Diagnostic::error(span, "a lens has at most 100 surfaces"));
    } else if let Some(i) = c.elements.iter().position(|e| !is_sound(e)) {
        let message = format!("surface {i} of the lens isn't one: {:?}", c.elements[i]);
        let help = "radius of curvature, way to the next surface, index behind it, diameter; no wider than the ball that it is a part of";
        d.push(Diagnostic::error(span, message).help(help));
    } else if c.back_focus().is_none() {
        let message = format!("this lens makes no picture of what is {} m away", c.focus_distance);
        d.push(Diagnostic::error(span, message));
    }
}

pub(super) fn fisheye(c: &Fisheye, keys: &Keys<'_>, d: &mut Decoder) {
    observer(&c.observer, keys, d);
    let wrong = match c.projection {
        FisheyeProjection::Orthographic if c.fov > 180.0 => {
            "an orthographic fisheye sees at most 180 degrees"
        }
        FisheyeProjection::Stereographic if c.fov > 359.0 => {
            "a stereographic fisheye sees at most 359 degrees"
        }
        _ => return,
    };
    let message = format!("{wrong}, found {}", c.fov);
    let complaint = Diagnostic::error(keys.span("fov"), message);
    d.push(complaint.help("`equidistant` and `equisolid` see up to 360 degrees"));
}

pub(super) fn panorama(c: &Panorama, keys: &Keys<'_>, d: &mut Decoder) {
    observer(&c.observer, keys, d);
    for (key, [from, to], order) in
        [("longitude", c.longitude, "`[left, right]`"), ("latitude", c.latitude, "`[lower, upper]`")]
    {
        if from >= to {
            let message = format!("`{key}` must grow: {from} is not below {to}");
            d.push(Diagnostic::error(keys.span(key), message).help(format!("it is {order}")));
        } else if to - from > 360.0 {
            let message = format!("`{key}` spans {} degrees, more than 360", to - from);
            d.push(Diagnostic::error(keys.span(key), message));
        }
    }
}

pub(super) fn cube_map(c: &CubeMap, keys: &Keys<'_>, d: &mut Decoder) {
    observer(&c.observer, keys, d);
}

pub(super) fn viewpoint(v: &Viewpoint, keys: &Keys<'_>, d: &mut Decoder) {
    view(v.eye, v.target, v.up, "target", keys, d);
}

pub(super) fn film(f: &Film, keys: &Keys<'_>, d: &mut Decoder) {
    let [width, height] = f.size;
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        let message = format!("a picture of {width} x {height} has more than 2^30 pixels");
        d.push(Diagnostic::error(keys.span("size"), message));
    }
    if f.bits != 8 && f.bits != 16 {
        let message = format!("`bits` must be 8 or 16, found {}", f.bits);
        d.push(Diagnostic::error(keys.span("bits"), message));
    }
    let Some([x0, y0, x1, y1]) = f.crop else { return };
    if x0 >= x1 || y0 >= y1 {
        let help = "it is `[x0, y0, x1, y1]` from the top left, the ends exclusive";
        d.push(Diagnostic::error(keys.span("crop"), "this crop is empty").help(help));
    } else if x1 > width || y1 > height {
        let message = format!("this crop ends at {x1}, {y1}, outside the picture of {width} x {height}");
        d.push(Diagnostic::error(keys.span("crop"), message));
    }
}

/// A bell that is narrower than what a filter is told by, or that is even as far as its radius, is no filter.
pub(super) fn ambient_occlusion(a: &AmbientOcclusion, keys: &Keys<'_>, d: &mut Decoder) {
    if a.radius.is_none() && a.falloff != OcclusionFalloff::None {
        let message = "`falloff` needs a `radius`, over which it falls off";
        d.push(Diagnostic::error(keys.key_span("falloff"), message));
    }
}

pub(super) fn gaussian(f: &Gaussian, keys: &Keys<'_>, d: &mut Decoder) {
    let narrow = f.sigma < 1e-3 * f.radius;
    if narrow || f.sigma > 1e6 * f.radius {
        let why = if narrow { "less than a thousandth of" } else { "more than a million times" };
        let message =
            format!("this filter is empty: `sigma` of {} is {why} `radius` of {}", f.sigma, f.radius);
        let help = "`sigma` is about a third of `radius` where it isn't told";
        d.push(Diagnostic::error(keys.span("sigma"), message).help(help));
    }
}

pub(super) fn spectral_channels(c: &SpectralChannels, keys: &Keys<'_>, d: &mut Decoder) {
    if c.from >= c.to {
        let message = format!("bands from {} nm must end beyond that, not at {} nm", c.from, c.to);
        d.push(Diagnostic::error(keys.span("to"), message));
    } else if c.bands().is_none() {
        let message = format!("{} bands from {} to {} nm are narrower than 1 nm each", c.bands, c.from, c.to);
        d.push(Diagnostic::error(keys.span("bands"), message));
    }
}

pub(super) fn color_in(c: &ColorIn, keys: &Keys<'_>, d: &mut Decoder) {
    const FORMS: &str = "`rgb`, `xyz`, `xyy`, `lab` and `lch`";
    match c.forms().as_slice() {
        [] => d.push(Diagnostic::error(keys.owner(), format!("a colour needs one of {FORMS}"))),
        [form] => {
            let (beside, other) =
                if *form == "rgb" { ("white", c.white.is_some()) } else { ("space", c.space.is_some()) };
            if other {
                let message = format!("`{beside}` means nothing beside `{form}`");
                d.push(Diagnostic::error(keys.key_span(beside), message));
            }
            if c.xyy.is_some_and(|[_, y, _]| y <= 0.0) {
                let message = "y of a chromaticity must be greater than 0";
                d.push(Diagnostic::error(keys.span("xyy"), message));
            }
        }
        [first, second, ..] => {
            let message = format!("a colour takes one of {FORMS}, not `{first}` and `{second}`");
            let first = (keys.key_span(first), format!("`{first}` is here"));
            d.push(Diagnostic::error(keys.key_span(second), message).related(first.0, first.1));
        }
    }
}

pub(super) fn measured(m: &Measured, keys: &Keys<'_>, d: &mut Decoder) {
    const FORMS: &str = "`name`, `blackbody`, `daylight`, `file`, and `wavelengths` with `values`";
    let forms = [
        ("name", m.name.is_some()),
        ("blackbody", m.blackbody.is_some()),
        ("daylight", m.daylight.is_some()),
        ("file", m.file.is_some()),
        ("wavelengths", !(m.wavelengths.is_empty() && m.values.is_empty())),
    ];
    let given: Vec<&str> = forms.iter().filter(|f| f.1).map(|f| f.0).collect();
    match given[..] {
        [] => d.push(Diagnostic::error(keys.owner(), format!("a spectrum needs one of {FORMS}"))),
        ["wavelengths"] => {
            let table = TabulatedSpectrum::new(m.wavelengths.clone(), m.values.clone());
            if let Err(fault) = table.and_then(|table| m.of_table(&table)) {
                let key = match fault {
                    Fault::Negative { .. } => "values",
                    Fault::Uneven { .. } | Fault::Few(_) => "interpolation",
                    _ => "wavelengths",
                };
                d.push(Diagnostic::error(keys.span(key), fault.to_string()));
            }
        }
        ["file"] => {}
        [form] => {
            if m.interpolation.is_some() {
                let message = format!("`interpolation` means nothing beside `{form}`");
                let help = "it is for the tables of `file`, and of `wavelengths` with `values`";
                d.push(Diagnostic::error(keys.key_span("interpolation"), message).help(help));
            }
        }
        [first, second, ..] => {
            let message = format!("a spectrum takes one of {FORMS}, not `{first}` and `{second}`");
            let first = (keys.key_span(first), format!("`{first}` is here"));
            d.push(Diagnostic::error(keys.key_span(second), message).related(first.0, first.1));
        }
    }
}

/// Complains of a texture whose colours can't be what it is read for: `limit` says what they must be within, `is_number` that they must be
/// numbers.
pub(crate) fn texture(texture: &Texture, span: Span, (limit, is_number): (Limit, bool), d: &mut Decoder) {
    for colour in texture.colours() {
        match colour {
            Spectrum::Rgb(LinearRgb(rgb)) => {
                if let Some(v) = rgb.iter().find(|v| !limit.allows(**v)) {
                    let message = limit.complaint(d.key(), *v);
                    d.push(Diagnostic::error(span, message));
                } else if is_number && (rgb[0] != rgb[1] || rgb[1] != rgb[2]) {
                    let message = format!("`{}` is a number, and this texture is of colours", d.key());
                    let help = "give it numbers, such as `first: 0.2`, for its colours";
                    d.push(Diagnostic::error(span, message).help(help));
                    return;
                }
            }
            Spectrum::Measured(m) => reflectance(m, span, limit, d),
        }
    }
}

/// A projector must look somewhere.
pub(crate) fn camera_mapping(c: &CameraMapping, keys: &Keys<'_>, d: &mut Decoder) {
    view(c.eye, c.look_at, c.up, "look_at", keys, d);
}

/// A remapping must lead from somewhere to somewhere.
pub(crate) fn remap(r: &RemapTexture, keys: &Keys<'_>, d: &mut Decoder) {
    if r.from[0] == r.from[1] {
        d.push(Diagnostic::error(keys.span("from"), "the two numbers of `from` must differ"));
    }
}

/// A ramp must rise.
pub(crate) fn ramp(r: &RampTexture, keys: &Keys<'_>, d: &mut Decoder) {
    if r.stops.is_empty() {
        d.push(
            Diagnostic::error(keys.span("stops"), "a ramp needs a stop")
                .help("such as `{ at: 0, color: 0.2 }`"),
        );
    }
    if r.stops.iter().zip(r.stops.iter().skip(1)).any(|(a, b)| a.at > b.at) {
        d.push(Diagnostic::error(keys.span("stops"), "the numbers of a ramp's stops must not fall"));
    }
}

/// Complains of a spectrum that is no reflectance where one is wanted, which `limit` says. What a file says is not known
/// here; [`too_bright`] is for who reads it.
pub(crate) fn reflectance(m: &Measured, span: Span, limit: Limit, d: &mut Decoder) {
    let complaint =
        m.said().filter(|_| limit.max == 1.0 && m.file.is_none()).and_then(|s| too_bright(&s, span));
    if let Some(complaint) = complaint {
        d.push(complaint);
    }
}

/// The complaint of a reflectance above 1.
pub(crate) fn too_bright(reflectance: &TabulatedSpectrum, span: Span) -> Option<Diagnostic> {
    let (nm, v) = reflectance.above_one()?;
    let message = format!("this spectrum reflects more light than falls on it: {v:.4} at {nm} nm");
    let help = "`scale` multiplies all its values; a table in percent needs 0.01";
    Some(Diagnostic::error(span, message).help(help))
}

/// Complains of an index that isn't one at all wavelengths.
pub(super) fn formula(f: &Formula, keys: &Keys<'_>, d: &mut Decoder) {
    let forms = (("cauchy", !f.cauchy.is_empty()), ("sellmeier", !f.sellmeier.is_empty()));
    if !one_of("formula", forms.0, forms.1, keys, d) {
        return;
    }
    let index = Index::Formula(f.clone()).index();
    let wrong = (spectrum::FIRST..=spectrum::LAST).find(|&nm| !(0.1..=10.0).contains(&index.at(nm as f64)));
    if let Some(nm) = wrong {
        let key = if forms.0.1 { "cauchy" } else { "sellmeier" };
        let message = format!(
            "this formula gives an index of {} at {nm} nm: it must be from 0.1 to 10",
            index.at(nm as f64)
        );
        let help = "wavelengths in it are in micrometres, and C of Sellmeier's formula in square micrometres";
        d.push(Diagnostic::error(keys.span(key), message).help(help));
    }
}

pub(super) fn conductor(c: &Conductor, keys: &Keys<'_>, d: &mut Decoder) {
    metal("conductor", &c.metal, [("eta", c.eta.is_some()), ("k", c.k.is_some())], keys, d);
}

pub(super) fn coated_conductor(c: &CoatedConductor, keys: &Keys<'_>, d: &mut Decoder) {
    metal("coated_conductor", &c.metal, [("eta", c.eta.is_some()), ("k", c.k.is_some())], keys, d);
}

/// Whatever lies below a film, if anything does.
pub(super) fn thin_film(f: &ThinFilm, keys: &Keys<'_>, d: &mut Decoder) {
    let given = [("base_eta", f.base_eta.is_some()), ("base_k", f.base_k.is_some())];
    if f.metal.is_some() || given.iter().any(|(_, given)| *given) {
        metal("thin_film", &f.metal, given, keys, d);
    }
}

/// A metal is told by its name, or by both parts of its index of refraction.
fn metal(
    owner: &str,
    named: &Option<Known<Metal>>,
    given: [(&str, bool); 2],
    keys: &Keys<'_>,
    d: &mut Decoder,
) {
    if named.is_some() {
        for (key, given) in given {
            if given {
                let message = format!("`{owner}` takes `metal` or `{key}`, not both");
                let help = (keys.key_span("metal"), "`metal` is here");
                d.push(Diagnostic::error(keys.key_span(key), message).related(help.0, help.1));
            }
        }
        return;
    }
    let [(eta, _), (k, _)] = given;
    for (key, given) in given {
        if !given {
            let message = format!("`{owner}` needs `metal`, or `{eta}` and `{k}`: there is no `{key}`");
            d.push(Diagnostic::error(keys.owner(), message));
            return;
        }
    }
}

/// The index of refraction is told in one way.
pub(super) fn principled(p: &Principled, keys: &Keys<'_>, d: &mut Decoder) {
    if p.eta.is_some() && p.specular.is_some() {
        let message = "`principled` takes `eta` or `specular`, not both";
        let other = (keys.key_span("eta"), "`eta` is here");
        d.push(Diagnostic::error(keys.key_span("specular"), message).related(other.0, other.1));
    }
}

/// What fills a clear material is said in one way.
fn interior(i: &Interior, keys: &Keys<'_>, d: &mut Decoder) {
    if i.sigma_a.is_some() && i.attenuation_color.is_some() {
        let message = "absorption is said twice: by `attenuation_color` and by `sigma_a`";
        let other = (keys.key_span("attenuation_color"), "`attenuation_color` is here");
        d.push(Diagnostic::error(keys.key_span("sigma_a"), message).related(other.0, other.1));
    }
}

pub(super) fn dielectric(m: &Dielectric, keys: &Keys<'_>, d: &mut Decoder) {
    interior(&m.interior, keys, d);
    if m.fresnel == Fresnel::Schlick {
        let is_rough = m.roughness_v.is_some() || m.roughness != Varying::Constant(0.0);
        if is_rough {
            let message = "rough glass has Fresnel's shares: `fresnel: schlick` is for smooth glass";
            d.push(Diagnostic::error(keys.key_span("fresnel"), message));
        }
    }
    for (key, index) in [("eta", &m.eta), ("eta_outside", &m.eta_outside)] {
        one_index(index, (key, &m.interior), keys, d);
    }
    let plain =
        |index: &Varying<Index>| matches!(index, Varying::Texture(_) | Varying::Constant(Index::Constant(_)));
    if plain(&m.eta) && plain(&m.eta_outside) {
        return;
    }
    let is_rough = m.roughness_v.is_some() || m.roughness != Varying::Constant(0.0);
    for (key, needs) in [
        ("priority", m.interior.priority > 0),
        ("roughness", is_rough),
        ("fresnel", m.fresnel == Fresnel::Schlick),
    ] {
        if needs {
            let message =
                format!("`{key}` needs an `eta` and `eta_outside` that don't depend on the wavelength");
            let help = "an index of refraction by wavelength is for smooth glass with Fresnel's shares";
            d.push(Diagnostic::error(keys.key_span(key), message).help(help));
        }
    }
}

/// What has a priority is a medium, whose index of refraction is one: other boundaries meet it within, where no texture is read.
fn one_index<T>(index: &Varying<T>, (key, interior): (&str, &Interior), keys: &Keys<'_>, d: &mut Decoder) {
    if interior.priority > 0 && matches!(index, Varying::Texture(_)) {
        let message = format!("`priority` needs an `{key}` that is the same everywhere, not a texture");
        let help = "what has a priority is met by the boundaries of other things within it, where its own surface isn't";
        d.push(Diagnostic::error(keys.key_span("priority"), message).help(help));
    }
}

/// Light is either sent back or goes through.
pub(super) fn diffuse_transmission(m: &DiffuseTransmission, keys: &Keys<'_>, d: &mut Decoder) {
    let most = |v: &Varying<Spectrum>| v.constant().and_then(Spectrum::rgb).map(|c| c.0);
    let (Some(r), Some(t)) = (most(&m.reflectance), most(&m.transmittance)) else { return };
    if let Some(i) = (0..3).find(|&i| r[i] + t[i] > 1.0 + 1e-9) {
        let sum = shown(r[i] + t[i]);
        let message =
            format!("`reflectance` and `transmittance` together are {sum}: more light leaves than arrives");
        d.push(Diagnostic::error(keys.owner(), message).help("together they may be 1"));
    }
}

pub(super) fn transparent(m: &Transparent, keys: &Keys<'_>, d: &mut Decoder) {
    interior(&m.interior, keys, d);
    for (key, index) in [("eta", &m.eta), ("eta_outside", &m.eta_outside)] {
        one_index(index, (key, &m.interior), keys, d);
    }
}

fn direction(v: DVec3, key: &str, keys: &Keys<'_>, d: &mut Decoder) {
    if v == DVec3::ZERO {
        let message = format!("`{key}` has no direction: all three numbers are 0");
        d.push(Diagnostic::error(keys.span(key), message));
    }
}

/// Complains unless exactly one of two ways to say the same is used.
fn one_of(owner: &str, first: (&str, bool), second: (&str, bool), keys: &Keys<'_>, d: &mut Decoder) -> bool {
    let ((a, has_a), (b, has_b)) = (first, second);
    if has_a && has_b {
        let message = format!("`{owner}` takes `{a}` or `{b}`, not both");
        d.push(
            Diagnostic::error(keys.key_span(b), message).related(keys.key_span(a), format!("`{a}` is here")),
        );
    } else if !has_a && !has_b {
        d.push(Diagnostic::error(keys.owner(), format!("`{owner}` needs `{a}` or `{b}`")));
    }
    has_a != has_b
}

pub(super) fn directional(l: &DirectionalLight, keys: &Keys<'_>, d: &mut Decoder) {
    let ways = (("direction", l.direction.is_some()), ("from", l.from.is_some()));
    if !one_of("directional", ways.0, ways.1, keys, d) {
        return;
    }
    if let (Some(v), Some(_)) = (l.direction, l.look_at) {
        let message = "`look_at` means nothing beside `direction`";
        let help = format!("give `from` and `look_at`, or `direction: {}` alone", shown_vector(v));
        d.push(Diagnostic::error(keys.key_span("look_at"), message).help(help));
    } else if l.axis() == DVec3::ZERO {
        let (key, message) = match l.direction {
            Some(_) => ("direction", "`direction` has no direction: all three numbers are 0"),
            None => ("from", "`from` is the point that the light shines on, so there is no direction"),
        };
        d.push(Diagnostic::error(keys.span(key), message));
    }
}

fn shown_vector(v: DVec3) -> String {
    let [x, y, z] = v.to_array().map(shown);
    format!("[{x}, {y}, {z}]")
}

/// The axis of a lamp that has one, and what is up for its picture.
fn aim(owner: &str, (look_at, direction, axis): (bool, bool, DVec3), keys: &Keys<'_>, d: &mut Decoder) {
    if one_of(owner, ("look_at", look_at), ("direction", direction), keys, d) && axis == DVec3::ZERO {
        let (key, message) = if look_at {
            ("look_at", "`look_at` and `position` are the same point")
        } else {
            ("direction", "`direction` has no direction: all three numbers are 0")
        };
        d.push(Diagnostic::error(keys.span(key), message));
    }
}

/// What is up for the picture of a lamp with such an axis.
fn upright(up: DVec3, axis: DVec3, keys: &Keys<'_>, d: &mut Decoder) {
    if up == DVec3::ZERO {
        d.push(Diagnostic::error(keys.span("up"), "`up` has no direction: all three numbers are 0"));
    } else if axis != DVec3::ZERO && Affine::look_at(DVec3::ZERO, axis, up).is_none() {
        let help = "choose another `up`, such as `up: [0, 0, 1]` or `up: [0, 1, 0]`";
        d.push(Diagnostic::error(keys.span("up"), "`up` is along the light's axis").help(help));
    }
}

pub(super) fn spot(l: &SpotLight, keys: &Keys<'_>, d: &mut Decoder) {
    aim("spot", (l.look_at.is_some(), l.direction.is_some(), l.axis()), keys, d);
    if l.full_beam() > l.cutoff {
        let message = format!("`beam` of {} degrees is wider than `cutoff` of {}", l.full_beam(), l.cutoff);
        let help = "light is full up to `beam` and ends at `cutoff`, both measured from the axis";
        d.push(Diagnostic::error(keys.span("beam"), message).help(help));
    }
    if l.texture.is_some() {
        upright(l.up, l.axis(), keys, d);
        if l.cutoff >= 90.0 {
            let message = format!("a `texture` fits no cone with a `cutoff` of {} degrees", shown(l.cutoff));
            let help = "it lies on a square across the axis: `cutoff` must be below 90 degrees";
            d.push(Diagnostic::error(keys.span("cutoff"), message).help(help));
        }
    }
}

pub(super) fn projector(l: &Projector, keys: &Keys<'_>, d: &mut Decoder) {
    aim("projector", (l.look_at.is_some(), l.direction.is_some(), l.axis()), keys, d);
    upright(l.up, l.axis(), keys, d);
}

pub(super) fn goniometric(l: &Goniometric, keys: &Keys<'_>, d: &mut Decoder) {
    if l.direction.is_some() || l.look_at.is_some() {
        aim("goniometric", (l.look_at.is_some(), l.direction.is_some(), l.axis()), keys, d);
    }
    let (axis, zero) = (l.axis(), l.zero);
    if zero == DVec3::ZERO {
        d.push(Diagnostic::error(keys.span("zero"), "`zero` has no direction: all three numbers are 0"));
    } else if axis != DVec3::ZERO && Affine::look_at(DVec3::ZERO, axis, zero).is_none() {
        let help =
            "choose another `zero`, such as `zero: [0, 0, 1]`: it says how the lamp is turned about its axis";
        d.push(Diagnostic::error(keys.span("zero"), "`zero` is along the lamp's axis").help(help));
    }
    if let Spectrum::Rgb(LinearRgb(rgb)) = l.color
        && rgb == [0.0; 3]
    {
        let message = "a lamp whose `color` is black has no colour: how bright it is `scale` says";
        d.push(Diagnostic::error(keys.span("color"), message));
    }
}

pub(super) fn sky(l: &Sky, keys: &Keys<'_>, d: &mut Decoder) {
    let ways = (("sun_direction", l.sun_direction.is_some()), ("when", l.when.is_some()));
    if !one_of("sky", ways.0, ways.1, keys, d) {
        return;
    }
    if l.sun_direction == Some(DVec3::ZERO) {
        let message = "`sun_direction` has no direction: all three numbers are 0";
        d.push(Diagnostic::error(keys.span("sun_direction"), message));
        return;
    }
    let up = l.towards_sun().y;
    if up < 0.0 {
        let below = ops::acos_d(-up);
        let degrees = (90.0 - below.to_degrees()).abs();
        let key = if l.when.is_some() { "when" } else { "sun_direction" };
        let message =
            format!("the sun is {degrees:.1} degrees below the horizon, where there is no model of the sky");
        let help = if l.when.is_some() {
            "choose another hour, and look at `utc_offset`: hours that clocks there are ahead of Universal Time"
        } else {
            "`sun_direction` leads towards the sun, and local +y is up"
        };
        d.push(Diagnostic::error(keys.span(key), message).help(help));
    }
}

pub(super) fn portal(p: &Portal, keys: &Keys<'_>, d: &mut Decoder) {
    let [a, b] = p.edges;
    if flat(a, b) {
        let message = "this portal has no area: its edges are parallel or zero";
        d.push(Diagnostic::error(keys.span("edges"), message));
    } else if a.dot(b).abs() > 1e-3 * a.length() * b.length() {
        d.push(Diagnostic::error(keys.span("edges"), "the edges of a portal must be at right angles"));
    }
}

pub(super) fn when(w: &When, keys: &Keys<'_>, d: &mut Decoder) {
    if !w.is_sound() {
        let [year, month, day] = w.date;
        let message = format!("there is no such date: year {year}, month {month}, day {day}");
        d.push(Diagnostic::error(keys.span("date"), message).help("it is `[year, month, day]`"));
    }
}

pub(super) fn environment(l: &Environment, keys: &Keys<'_>, d: &mut Decoder) {
    let ways = [
        ("radiance", l.radiance.is_some()),
        ("gradient", !l.gradient.is_empty()),
        ("file", l.file.is_some()),
    ];
    let mut given = ways.iter().filter(|(_, is_given)| *is_given);
    match (given.next(), given.next()) {
        (None, _) => {
            let message = "`environment` needs `radiance`, `gradient` or `file`";
            d.push(Diagnostic::error(keys.owner(), message));
        }
        (Some((a, _)), Some((b, _))) => {
            let message = format!("`environment` takes `{a}` or `{b}`, not both");
            let complaint = Diagnostic::error(keys.key_span(b), message);
            d.push(complaint.related(keys.key_span(a), format!("`{a}` is here")));
        }
        _ => {}
    }
    if l.gradient.len() == 1 {
        let message = "a gradient of one colour is none";
        d.push(Diagnostic::error(keys.span("gradient"), message).help("write it as `radiance`"));
    } else if l.gradient.len() > MOST_STEPS {
        let message =
            format!("a gradient has {MOST_STEPS} colours at the most, this has {}", l.gradient.len());
        d.push(Diagnostic::error(keys.span("gradient"), message));
    }
    let unused = [
        ("layout", l.layout != EnvironmentLayout::LatitudeLongitude),
        ("tint", l.tint != Spectrum::grey(1.0)),
    ];
    for (key, _) in unused.iter().filter(|(_, is_given)| *is_given && l.file.is_none()) {
        d.push(Diagnostic::error(keys.key_span(key), format!("`{key}` means nothing without `file`")));
    }
    if l.compensate && l.radiance.is_some() {
        let message = "`compensate` means nothing where the same light comes from everywhere";
        d.push(Diagnostic::error(keys.key_span("compensate"), message));
    }
}

/// The most colours of a gradient.
const MOST_STEPS: usize = 64;

pub(super) fn plane(s: &Plane, keys: &Keys<'_>, d: &mut Decoder) {
    direction(s.normal, "normal", keys, d);
    if s.surface.emission.is_some() {
        let help = "use a large `rectangle` as a light";
        let message = "a plane is infinite and cannot glow";
        d.push(Diagnostic::error(keys.key_span("emission"), message).help(help));
    }
}

pub(super) fn disc(s: &Disc, keys: &Keys<'_>, d: &mut Decoder) {
    direction(s.normal, "normal", keys, d);
    light_sampling("disc", &s.light_sampling, keys, d);
}

/// Complains of what only rectangles can do.
fn light_sampling(what: &str, said: &LightSampling, keys: &Keys<'_>, d: &mut Decoder) {
    if *said == LightSampling::ProjectedSolidAngle {
        let message = format!(
            "points on a {what} can't be drawn by projected solid angle: only those on a rectangle can"
        );
        let help = "`solid_angle` draws them as they are seen";
        d.push(Diagnostic::error(keys.span("light_sampling"), message).help(help));
    }
}

pub(super) fn light_tracer(s: &LightTracer, keys: &Keys<'_>, d: &mut Decoder) {
    if s.roulette == Roulette::Ears {
        let message = "`light` has no roulette by `ears`: that is learnt of paths from the camera";
        let help = "`root` is the usual one; `path` has `ears`";
        d.push(Diagnostic::error(keys.span("roulette"), message).help(help));
    }
}

pub(super) fn rectangle(s: &Rectangle, keys: &Keys<'_>, d: &mut Decoder) {
    let [a, b] = s.edges;
    if flat(a, b) {
        let message = "this rectangle has no area: its edges are parallel or zero";
        d.push(Diagnostic::error(keys.span("edges"), message));
    }
}

/// Whether two edges span no area, as far as double precision can tell.
fn flat(a: DVec3, b: DVec3) -> bool {
    match (a.try_normalize(), b.try_normalize()) {
        (Some(a), Some(b)) => a.cross(b).length() < 1e-12,
        _ => true,
    }
}

pub(super) fn cuboid(s: &Cuboid, keys: &Keys<'_>, d: &mut Decoder) {
    grows(s.min, s.max, keys, d);
}

fn grows(min: DVec3, max: DVec3, keys: &Keys<'_>, d: &mut Decoder) {
    for (axis, (a, b)) in ["x", "y", "z"].iter().zip(min.to_array().into_iter().zip(max.to_array())) {
        if a >= b {
            let message =
                format!("`max` must be greater than `min` on every axis: in {axis}, {b} is not above {a}");
            d.push(Diagnostic::error(keys.span("max"), message));
        }
    }
}

pub(super) fn cylinder(s: &Cylinder, keys: &Keys<'_>, d: &mut Decoder) {
    length("cylinder", s.from, s.to, keys, d);
    turn("phi", s.phi, keys, d);
    whole_when_closed(s.caps, s.phi, keys, d);
}

pub(super) fn sphere(s: &Sphere, keys: &Keys<'_>, d: &mut Decoder) {
    turn("phi", s.phi, keys, d);
    if let Some([from, to]) = s.heights {
        let message = if from >= to {
            format!("`heights` must grow: {from} is not below {to}")
        } else if to <= -s.radius || from >= s.radius {
            format!("`heights` leave nothing of a sphere of radius {}", s.radius)
        } else {
            return;
        };
        d.push(Diagnostic::error(keys.span("heights"), message));
    }
}

pub(super) fn cone(s: &Cone, keys: &Keys<'_>, d: &mut Decoder) {
    length("cone", s.from, s.to, keys, d);
    turn("phi", s.phi, keys, d);
    whole_when_closed(s.caps, s.phi, keys, d);
}

pub(super) fn annulus(s: &Annulus, keys: &Keys<'_>, d: &mut Decoder) {
    direction(s.normal, "normal", keys, d);
    turn("phi", s.phi, keys, d);
    if s.inner_radius >= s.radius {
        let message = format!("`inner_radius` of {} is not below `radius` of {}", s.inner_radius, s.radius);
        d.push(Diagnostic::error(keys.span("inner_radius"), message));
    }
}

pub(super) fn torus(s: &Torus, keys: &Keys<'_>, d: &mut Decoder) {
    direction(s.axis, "axis", keys, d);
    turn("phi", s.phi, keys, d);
    turn("theta", s.theta, keys, d);
    if s.tube_radius >= s.radius {
        let message = format!("`tube_radius` of {} is not below `radius` of {}", s.tube_radius, s.radius);
        let complaint = Diagnostic::error(keys.span("tube_radius"), message);
        d.push(complaint.help("the tube would meet itself in the middle"));
    }
}

pub(super) fn paraboloid(s: &Paraboloid, keys: &Keys<'_>, d: &mut Decoder) {
    length("paraboloid", s.from, s.to, keys, d);
    turn("phi", s.phi, keys, d);
}

pub(super) fn hyperboloid(s: &Hyperboloid, keys: &Keys<'_>, d: &mut Decoder) {
    turn("phi", s.phi, keys, d);
    let [a, b] = s.line;
    let outward = |p: DVec3| DVec3::new(p.x, 0.0, p.z);
    // Along a circle about the axis, or through the axis from one side to the other.
    let area = (b - a).length() * (outward(a).length() + outward(b).length());
    if area <= 0.0 || (a.y == b.y && outward(a).length() == outward(b).length()) {
        let message = "this line sweeps no surface: its ends are one point, or both lie on the axis, or on one circle about it";
        d.push(Diagnostic::error(keys.span("line"), message));
    }
}

pub(super) fn capsule(s: &Capsule, keys: &Keys<'_>, d: &mut Decoder) {
    length("capsule", s.from, s.to, keys, d);
    let (a, b) = (s.radius, s.end_radius.unwrap_or(s.radius));
    if (a - b).abs() >= (s.to - s.from).length() && s.from != s.to {
        let complaint =
            Diagnostic::error(keys.key_span("end_radius"), "the larger ball holds the smaller one");
        d.push(complaint.help("write a `sphere`, or move `from` and `to` further apart"));
    }
}

pub(super) fn bilinear(s: &Bilinear, keys: &Keys<'_>, d: &mut Decoder) {
    let [a, b, c, e] = s.corners;
    if flat(b - a, c - a) && flat(b - e, c - e) {
        let message = "this patch has no area: its corners are on one line";
        d.push(Diagnostic::error(keys.span("corners"), message));
    }
}

pub(super) fn height_field(s: &HeightField, keys: &Keys<'_>, d: &mut Decoder) {
    let inline = !s.heights.is_empty();
    if !one_of("height_field", ("file", s.file.is_some()), ("heights", inline), keys, d) || !inline {
        return;
    }
    let width = s.heights.first().map_or(0, Vec::len);
    if s.heights.len() < 2 || width < 2 {
        let message = "`heights` needs two rows of two numbers at least";
        d.push(Diagnostic::error(keys.span("heights"), message));
    } else if let Some((i, row)) = s.heights.iter().enumerate().find(|(_, row)| row.len() != width) {
        let message = format!("row {i} of `heights` has {} numbers, and the first has {width}", row.len());
        d.push(Diagnostic::error(keys.span("heights"), message).help("all rows are equally long"));
    }
}

pub(super) fn curves(s: &Curves, keys: &Keys<'_>, d: &mut Decoder) {
    let [first, further] = s.basis.points();
    let ends = s.starts.iter().skip(1).copied().chain([s.points.len() as u32]);
    let grows = s.starts.first().is_none_or(|s| *s == 0) && s.starts.iter().zip(ends).all(|(a, b)| *a < b);
    if !grows {
        let message = "`starts` must begin with 0 and grow, each less than the number of `points`";
        d.push(Diagnostic::error(keys.key_span("starts"), message));
        return;
    }
    for (i, run) in s.runs().enumerate() {
        if s.pieces(run.len()).is_none() {
            let message = format!(
                "curve {i} has {} points: `{}` takes {first}, and {further} for each further piece",
                run.len(),
                s.basis.kind()
            );
            d.push(Diagnostic::error(keys.key_span("points"), message));
            return;
        }
    }
    if !(matches!(s.radii.len(), 1 | 2) || s.radii.len() == s.points.len()) {
        let message = format!("`radii` lists {} for the {} of `points`", s.radii.len(), s.points.len());
        let help = "it has one number for all, two for the ends of each curve, or one for each point";
        d.push(Diagnostic::error(keys.span("radii"), message).help(help));
    } else if s.radii.iter().all(|r| *r == 0.0) {
        d.push(Diagnostic::error(keys.span("radii"), "these curves have no thickness"));
    }
    let wanted: usize = s.runs().filter_map(|run| Some(s.pieces(run.len())? + 1)).sum();
    match s.form {
        CurveForm::Ribbon if s.basis == CurveBasis::Linear => {
            let message = "a ribbon along straight pieces is folded at each point";
            d.push(Diagnostic::error(keys.key_span("form"), message).help("give it `basis: bezier`"));
        }
        CurveForm::Ribbon if s.normals.len() != wanted => {
            let message = format!("`ribbon` needs {wanted} `normals`, found {}", s.normals.len());
            let help = "one for the beginning of each curve, and one for the end of each piece";
            d.push(Diagnostic::error(keys.key_span("form"), message).help(help));
        }
        CurveForm::Ribbon if s.normals.contains(&DVec3::ZERO) => {
            let message = "one of `normals` has no direction: all three numbers are 0";
            d.push(Diagnostic::error(keys.span("normals"), message));
        }
        CurveForm::Round | CurveForm::Flat if !s.normals.is_empty() => {
            let message = "`normals` mean something for `form: ribbon` only";
            d.push(Diagnostic::error(keys.key_span("normals"), message));
        }
        _ => {}
    }
}

pub(super) fn combination(s: &Combination, keys: &Keys<'_>, d: &mut Decoder) {
    dark(&s.surface, "a combination of solids", keys, d);
    if s.of.is_empty() {
        d.push(Diagnostic::error(keys.span("of"), "there is nothing to combine"));
    }
    for node in &s.of {
        closed(node, keys, d);
    }
}

/// Complains of what glows and can't.
fn dark(surface: &Surface, what: &str, keys: &Keys<'_>, d: &mut Decoder) {
    if surface.emission.is_some() {
        let message = format!("{what} cannot glow");
        d.push(Diagnostic::error(keys.key_span("emission"), message));
    }
}

/// Complains of what isn't a solid that can be combined.
fn closed(node: &Node, keys: &Keys<'_>, d: &mut Decoder) {
    let is_whole = |[from, to]: [f64; 2]| to - from >= 360.0;
    let (kind, surface) = (node.kind(), node.surface());
    let wrong = match node {
        Node::Group(g) => return g.children.iter().for_each(|child| closed(child, keys, d)),
        Node::Instance(_) | Node::Instances(_) => {
            "an instance can't be combined: write what it shows here".to_owned()
        }
        Node::Sphere(s) if s.heights.is_some() || !is_whole(s.phi) => "a part of a sphere is open".to_owned(),
        Node::Cylinder(s) if !s.caps => "a cylinder without `caps: true` is open".to_owned(),
        Node::Cone(s) if !s.caps => "a cone without `caps: true` is open".to_owned(),
        Node::Torus(s) if !is_whole(s.phi) || !is_whole(s.theta) => "a part of a torus is open".to_owned(),
        Node::Sphere(_)
        | Node::Cylinder(_)
        | Node::Cone(_)
        | Node::Torus(_)
        | Node::Capsule(_)
        | Node::Box(_)
        | Node::Mesh(_)
        | Node::DistanceField(_)
        | Node::Union(_)
        | Node::Intersection(_)
        | Node::Difference(_) => match surface {
            Some(s) if s.emission.is_some() => format!("a `{kind}` that is combined with others cannot glow"),
            Some(s) if s.flip => format!("`flip` turns this `{kind}` inside out"),
            _ => return,
        },
        _ => format!("a `{kind}` is not a solid: it has no inside"),
    };
    let help = "what is combined must be closed, its front outside";
    d.push(Diagnostic::error(keys.span("of"), wrong).help(help));
}

pub(super) fn distance_field(s: &DistanceField, keys: &Keys<'_>, d: &mut Decoder) {
    dark(&s.surface, "a distance field", keys, d);
}

pub(super) fn box_distance(s: &BoxDistance, keys: &Keys<'_>, d: &mut Decoder) {
    grows(s.min, s.max, keys, d);
}

pub(super) fn cylinder_distance(s: &CylinderDistance, keys: &Keys<'_>, d: &mut Decoder) {
    length("cylinder", s.from, s.to, keys, d);
}

pub(super) fn blend(s: &Blend, keys: &Keys<'_>, d: &mut Decoder) {
    if s.of.is_empty() {
        d.push(Diagnostic::error(keys.span("of"), "there is nothing to combine"));
    }
}

pub(super) fn moved(s: &Moved, keys: &Keys<'_>, d: &mut Decoder) {
    if s.transform.affine().is_some_and(|m| even_scale(&m).is_none()) {
        let message = "a distance can be moved, turned, mirrored and scaled evenly, not stretched or sheared";
        let complaint = Diagnostic::error(keys.span("transform"), message);
        d.push(complaint.help("stretch the whole `distance_field` by its own `transform`"));
    }
}

/// By how much a map that keeps angles scales.
pub fn even_scale(m: &Affine) -> Option<f64> {
    let column = |j: usize| DVec3::new(m.rows[0][j], m.rows[1][j], m.rows[2][j]);
    let (a, b, c) = (column(0), column(1), column(2));
    let scale = a.length();
    let near = |x: f64| x.abs() < 1e-9 * scale * scale;
    let even = near(a.dot(b))
        && near(b.dot(c))
        && near(c.dot(a))
        && near(b.length_squared() - scale * scale)
        && near(c.length_squared() - scale * scale);
    even.then_some(scale)
}

pub(super) fn grid_distance(s: &GridDistance, keys: &Keys<'_>, d: &mut Decoder) {
    grows(s.min, s.max, keys, d);
    let wanted: u64 = s.size.iter().map(|n| u64::from(*n)).product();
    if s.values.len() as u64 != wanted {
        let [x, y, z] = s.size;
        let message = format!("`values` lists {} for {x} x {y} x {z} points", s.values.len());
        d.push(Diagnostic::error(keys.key_span("values"), message));
    }
}

fn length(what: &str, from: DVec3, to: DVec3, keys: &Keys<'_>, d: &mut Decoder) {
    if from == to {
        let message = format!("`from` and `to` are the same point: the {what} has no length");
        d.push(Diagnostic::error(keys.span("to"), message));
    }
}

/// A part of a turn must be one.
fn turn(key: &str, [from, to]: [f64; 2], keys: &Keys<'_>, d: &mut Decoder) {
    let message = if from >= to {
        format!("`{key}` must grow: {from} is not below {to}")
    } else if to - from > 360.0 {
        format!("`{key}` spans {} degrees, more than 360", to - from)
    } else {
        return;
    };
    d.push(Diagnostic::error(keys.span(key), message).help("it is `[from, to]` in degrees"));
}

fn whole_when_closed(caps: bool, [from, to]: [f64; 2], keys: &Keys<'_>, d: &mut Decoder) {
    if caps && to - from < 360.0 {
        let message = "`caps` close a whole turn only, and `phi` leaves some of it out";
        d.push(
            Diagnostic::error(keys.key_span("caps"), message).help("its ends can be written as `annulus`"),
        );
    }
}

pub(super) fn triangle(s: &Triangle, keys: &Keys<'_>, d: &mut Decoder) {
    let [a, b, c] = s.vertices;
    if flat(b - a, c - a) {
        let message = "this triangle has no area: its corners are on one line";
        d.push(Diagnostic::error(keys.span("vertices"), message));
    }
    light_sampling("triangle", &s.light_sampling, keys, d);
}

/// Complains of the first index that is out of range.
fn indices(key: &str, all: impl Iterator<Item = u32>, count: usize, keys: &Keys<'_>, d: &mut Decoder) {
    if let Some(bad) = { all }.find(|&i| i as usize >= count) {
        let message = format!("`{key}` names point {bad}, but there are only {count}, counted from 0");
        d.push(Diagnostic::error(keys.key_span(key), message));
    }
}

pub(super) fn mesh(m: &TriangleMesh, keys: &Keys<'_>, d: &mut Decoder) {
    light_sampling("mesh", &m.light_sampling, keys, d);
    let inline = !m.positions.is_empty() || !m.triangles.is_empty();
    if !one_of("mesh", ("file", m.file.is_some()), ("positions", inline), keys, d) || !inline {
        return;
    }
    if m.triangles.is_empty() {
        let help = "`triangles` lists three indices into `positions` for each";
        d.push(Diagnostic::error(keys.owner(), "this mesh is empty: it has no triangles").help(help));
    }
    indices("triangles", m.triangles.iter().flatten().copied(), m.positions.len(), keys, d);
    for (key, count) in [("normals", m.normals.len()), ("uvs", m.uvs.len()), ("tangents", m.tangents.len())] {
        if count != 0 && count != m.positions.len() {
            let message = format!("`{key}` lists {count} for the {} of `positions`", m.positions.len());
            d.push(Diagnostic::error(keys.key_span(key), message));
        }
    }
}

pub(super) fn bezier(b: &Bezier, keys: &Keys<'_>, d: &mut Decoder) {
    let inline = !b.points.is_empty() || !b.patches.is_empty();
    if !one_of("bezier", ("builtin", b.builtin.is_some()), ("points", inline), keys, d) {
        return;
    }
    if b.builtin.is_some() {
        return;
    }
    if b.patches.is_empty() {
        let help = "`patches` lists sixteen indices into `points` for each";
        d.push(Diagnostic::error(keys.owner(), "this surface is empty: it has no patches").help(help));
    }
    indices("patches", b.patches.iter().flatten().copied(), b.points.len(), keys, d);
}
