//! A scene as a whole: read and checked, and what can stand in one.

use serde_json::{Map, Value as Json, json};

use crate::decode::{Decoder, Describe, Fields, Strictness};
use crate::desc::{Accel, Animation, Camera, ColorSettings, Film, Integrator, Light, Sampler, Scene};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::frames;
use crate::limit::Limit;
use crate::schema::Definitions;
use crate::span::Span;
use crate::suggest::fold;
use crate::tree::{Datum, Entry, Tree};
use crate::validate;
use crate::value::Named;

/// Reads a scene and checks it as a whole. The scene is only of use when there are no errors among the complaints;
/// it is given all the same, so that the files it names can be looked for too.
pub fn read_scene(tree: &Tree, diagnostics: Diagnostics, strictness: Strictness) -> (Scene, Diagnostics) {
    let mut decoder = Decoder::new(diagnostics, strictness);
    let mut scene = Scene::read(tree, Limit::FINITE, &mut decoder);
    scene.link();
    decoder.check_wide(scene.color.space.space());
    let mut diagnostics = decoder.diagnostics;
    let (at, nothing) = match tree.entry("world") {
        Some(e) => (e.key.span, e.value.value == Datum::Null || e.value.value == Datum::Sequence(Vec::new())),
        None => (
            Span { end: tree.span.start, ..tree.span },
            matches!(tree.value, Datum::Mapping(_) | Datum::Null),
        ),
    };
    let lit_by_all = scene.lights.iter().any(|l| matches!(l, Light::Environment(_) | Light::Sky(_)));
    // A key that is called otherwise here may be what the world was meant to be.
    let mut names = Vec::new();
    Scene::names(&mut names);
    let is_known = |e: &Entry| names.contains(&e.key.value.as_str());
    let all_known = !matches!(&tree.value, Datum::Mapping(entries) if !entries.iter().all(is_known));
    if nothing && all_known && !lit_by_all && scene.integrator.needs_world() {
        let help = "list shapes under `world:`, such as `- sphere: { radius: 1 }`";
        diagnostics.push(Diagnostic::error(at, "the world is empty: there is nothing to see").help(help));
    }
    validate::validate(&scene, &mut diagnostics);
    (scene, diagnostics)
}

impl Scene {
    /// An empty one that someone looks at, in which all else is as it is when a file doesn't say it.
    pub fn seen_by(camera: Camera) -> Self {
        Self {
            camera,
            film: Film::default(),
            color: ColorSettings::default(),
            sampler: Sampler::default(),
            integrator: Integrator::default(),
            accel: Accel::default(),
            spectral: false,
            animation: Animation::default(),
            textures: Named::default(),
            materials: Named::default(),
            objects: Named::default(),
            world: Vec::new(),
            lights: Vec::new(),
        }
    }
}

/// The JSON Schema of a scene file.
pub fn schema() -> Json {
    let mut defs = Definitions::default();
    let root = Scene::schema(Limit::FINITE, &mut defs);
    let mut out = Map::new();
    out.insert("$schema".to_owned(), json!("https://json-schema.org/draft/2020-12/schema"));
    out.insert("title".to_owned(), json!("straal scene"));
    if let Json::Object(root) = root {
        out.extend(root);
    }
    let mut defs = defs.into_map();
    out.iter_mut().chain(defs.iter_mut()).for_each(|(_, schema)| may_move(schema));
    defs.insert(MOVING.to_owned(), frames::schema());
    out.insert("$defs".to_owned(), Json::Object(defs));
    Json::Object(out)
}

/// The schema's name of what stands in place of a value.
const MOVING: &str = "Keyframes of a value";

/// Lets keyframes stand in place of every value that a key may have.
fn may_move(schema: &mut Json) {
    match schema {
        Json::Object(map) => {
            for (key, value) in map.iter_mut() {
                if key == "properties"
                    && let Json::Object(properties) = value
                {
                    for property in properties.values_mut() {
                        may_move(property);
                        let mut own = property.take();
                        let mut either = Map::new();
                        if let Json::Object(own) = &mut own {
                            let told = ["description", "default"].map(|word| (word, own.remove(word)));
                            either.extend(told.into_iter().filter_map(|(k, v)| Some((k.to_owned(), v?))));
                        }
                        either.insert(
                            "anyOf".to_owned(),
                            json!([own, { "$ref": format!("#/$defs/{MOVING}") }]),
                        );
                        *property = Json::Object(either);
                    }
                } else {
                    may_move(value);
                }
            }
        }
        Json::Array(list) => list.iter_mut().for_each(may_move),
        _ => {}
    }
}

/// Whether a word is one of a scene's own, in whatever letters, or one that only another renderer has in its place. Words that stand
/// in files of all kinds are none.
pub fn is_of_a_scene(word: &str) -> bool {
    const OTHERS: [&str; 10] = [
        "sensor",
        "sensors",
        "cameras",
        "shapes",
        "bsdf",
        "bsdfs",
        "emitter",
        "emitters",
        "lookat",
        "lightsources",
    ];
    let mut names = Vec::new();
    <Scene as Fields>::names(&mut names);
    names.iter().chain(&OTHERS).any(|name| fold(name).eq(fold(word)))
}
