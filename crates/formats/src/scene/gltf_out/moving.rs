//! What moves: where nodes, the camera and lights stand at each frame, as an animation.
//!
//! A frame of straal is a scene of its own, so that a scene that moves is told by all of its frames. What differs between them in where it stands becomes keys of
//! its translation, rotation and scale, of which those are left out that the ones around them tell already. What else differs can't be said.

use std::collections::{BTreeMap, BTreeSet};
use std::ptr;

use serde_json::{Map, Value as Json, json};
use straal_math::{Affine, DVec3};
use straal_scene::decode::write_json;
use straal_scene::desc::{MeshSource, Node};

use super::{Form, Out, Written, camera, lights, tree};
use crate::Loaded;
use crate::scene::{gltf, motion};

/// So many frames are written at most.
pub const MOST_FRAMES: u32 = 10_000;

/// Where something stands at each frame; nowhere where it is scaled to nothing. One place alone if it stays there.
#[derive(Clone, Debug, Default)]
struct Track(Vec<Option<Affine>>);

impl Track {
    /// Takes note of frame `i`.
    fn put(&mut self, i: usize, place: Option<Affine>) {
        match self.0.as_slice() {
            [first] if *first == place => {}
            // It stayed until here.
            [first] => {
                self.0 = vec![*first; i];
                self.0.push(place);
            }
            _ => self.0.push(place),
        }
    }
}

/// The frames of a scene that moves, on their way to a file.
pub struct Frames<'a> {
    base: &'a Loaded,
    /// How many there are.
    count: usize,
    /// By where nodes of the first frame stand in memory.
    nodes: BTreeMap<usize, Track>,
    camera: Track,
    lights: Vec<Track>,
    /// All that the first says but where things stand.
    said: Json,
    told: BTreeSet<&'static str>,
}

impl<'a> Frames<'a> {
    /// The first one.
    pub fn of(base: &'a Loaded) -> Self {
        let lights = vec![Track::default(); base.scene.lights.len()];
        let mut frames = Self {
            base,
            count: 0,
            nodes: BTreeMap::new(),
            camera: Track::default(),
            lights,
            said: Json::Null,
            told: BTreeSet::new(),
        };
        frames.said = said(base);
        frames.add(base);
        frames
    }

    /// The next one.
    pub fn add(&mut self, frame: &Loaded) {
        let base = self.base;
        let both = base.scene.world.iter().zip(&frame.scene.world);
        let objects = base
            .scene
            .objects
            .iter()
            .filter_map(|(name, object)| Some((object, frame.scene.objects.get(name)?)));
        for (first, now) in both.chain(objects) {
            self.node(first, (now, frame));
        }
        let i = self.count;
        self.camera.put(i, camera::stand(frame.scene.camera.observer()));
        for (track, light) in self.lights.iter_mut().zip(&frame.scene.lights) {
            track.put(i, lights::stand(light));
        }
        self.count += 1;
        if i > 0 && said(frame) != self.said {
            self.told.insert("what changes besides places stays as it is at first: materials, sizes, lights' brightness, lenses");
        }
    }

    fn node(&mut self, first: &Node, (now, frame): (&Node, &Loaded)) {
        let key = ptr::from_ref(first) as usize;
        self.nodes.entry(key).or_default().put(self.count, now.placement());
        match (first, now) {
            (Node::Group(a), Node::Group(b)) => {
                for (a, b) in a.children.iter().zip(&b.children) {
                    self.node(a, (b, frame));
                }
            }
            (Node::Mesh(a), Node::Mesh(b)) => {
                let (MeshSource::Asset(a), MeshSource::Asset(b)) = (a.source(), b.source()) else { return };
                let (a, b) = (&self.base.assets.mesh(a.handle).mesh, &frame.assets.mesh(b.handle).mesh);
                if !std::sync::Arc::ptr_eq(a, b) && a.positions != b.positions {
                    self.told.insert("what bends (skins, morph targets) stays as it is at first");
                }
            }
            _ => {}
        }
    }

    /// The scene as glTF; an error says why there is none.
    pub fn write(&self, form: Form<'_>) -> Result<Written, String> {
        super::write_at_most(self.base, Some(self), form, super::MOST)
    }

    /// Where a node of the first frame stands at each frame, if it moves.
    pub(super) fn of_node(&self, node: &Node) -> Option<&[Option<Affine>]> {
        self.nodes.get(&(ptr::from_ref(node) as usize)).and_then(Self::moves)
    }

    pub(super) fn of_camera(&self) -> Option<&[Option<Affine>]> {
        Self::moves(&self.camera)
    }

    pub(super) fn of_light(&self, i: usize) -> Option<&[Option<Affine>]> {
        self.lights.get(i).and_then(Self::moves)
    }

    fn moves(track: &Track) -> Option<&[Option<Affine>]> {
        Some(track.0.as_slice()).filter(|track| track.len() > 1)
    }

    /// What is to be told.
    pub(super) fn told(&self) -> impl Iterator<Item = &'static str> {
        self.told.iter().copied()
    }
}

/// All that a scene says but where things stand.
fn said(loaded: &Loaded) -> Json {
    let mut text = Vec::new();
    let written = write_json(&loaded.scene, &mut text);
    let mut all: Json = written.ok().and_then(|()| serde_json::from_slice(&text).ok()).unwrap_or_default();
    let mut kept = Map::new();
    for key in ["world", "objects", "materials", "textures", "lights", "camera"] {
        let Some(mut part) = all.get_mut(key).map(Json::take) else { continue };
        match (key, &mut part) {
            ("world", Json::Array(nodes)) => nodes.iter_mut().for_each(unplace),
            ("objects", Json::Object(nodes)) => nodes.values_mut().for_each(unplace),
            ("lights", Json::Array(lights)) => lights.iter_mut().for_each(|light| {
                without(light, &["position", "direction", "from", "look_at"]);
            }),
            ("camera", camera) => without(camera, &["eye", "look_at", "up", "roll", "moving_to"]),
            _ => {}
        }
        kept.insert(key.to_owned(), part);
    }
    Json::Object(kept)
}

/// Takes keys out of what stands under the name of a kind.
fn without(kind: &mut Json, keys: &[&str]) {
    let Json::Object(kinds) = kind else { return };
    for body in kinds.values_mut().filter_map(Json::as_object_mut) {
        keys.iter().for_each(|key| {
            body.remove(*key);
        });
    }
}

/// Takes out where a node stands, and those in it.
fn unplace(node: &mut Json) {
    without(node, &["transform", "look_at"]);
    let Json::Object(kinds) = node else { return };
    for body in kinds.values_mut() {
        if let Some(Json::Array(children)) = body.get_mut("children") {
            children.iter_mut().for_each(unplace);
        }
    }
}

/// A place taken apart: scale, then turn, then move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Parts {
    moved: [f64; 3],
    /// A quaternion x, y, z, w.
    turn: [f64; 4],
    scale: [f64; 3],
}

impl Parts {
    /// Those of a place; none where it slants.
    fn of(place: &Affine) -> Option<Self> {
        if tree::is_slanted(place) {
            return None;
        }
        let mut axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| place.vector(axis));
        let mut scale = axes.map(DVec3::length);
        // A mirror image is one along x, turned.
        if place.determinant() < 0.0 {
            scale[0] = -scale[0];
        }
        for (axis, length) in axes.iter_mut().zip(scale) {
            *axis = *axis / length;
        }
        let [x, y, z] = axes.map(DVec3::to_array);
        let turn = Affine { rows: std::array::from_fn(|i| [x[i], y[i], z[i], 0.0]) };
        let moved = place.point(DVec3::ZERO).to_array();
        Some(Self { moved, turn: motion::quaternion(&turn), scale })
    }

    /// Those of all places, turns by the nearer of the two quaternions that tell each.
    fn of_all(places: &[Option<Affine>]) -> Option<Vec<Self>> {
        let mut all: Vec<Self> = Vec::with_capacity(places.len());
        for place in places {
            let before = all.last().copied();
            let mut parts = match (place, before) {
                (Some(place), _) => Self::of(place)?,
                (None, Some(before)) => Self { scale: [0.0; 3], ..before },
                (None, None) => return None,
            };
            if before.is_some_and(|b| b.turn.iter().zip(parts.turn).map(|(a, b)| a * b).sum::<f64>() < 0.0) {
                parts.turn = parts.turn.map(|v| -v);
            }
            all.push(parts);
        }
        Some(all)
    }
}

/// The animation on its way to the file.
#[derive(Default)]
pub(super) struct Moving {
    samplers: Vec<Json>,
    channels: Vec<Json>,
    /// Accessors of times, by the frames that they are of.
    times: BTreeMap<Vec<usize>, usize>,
}

impl Moving {
    /// What is written of it.
    pub fn said(self) -> Option<Json> {
        let Self { samplers, channels, .. } = self;
        (!channels.is_empty()).then(|| json!({ "samplers": samplers, "channels": channels }))
    }
}

impl Out<'_> {
    /// A node that stands at a place, or moves: what is kept of the motion must be given to `moves` with the node's index.
    pub fn standing(
        &mut self,
        place: &Affine,
        track: Option<&[Option<Affine>]>,
    ) -> (Map<String, Json>, Vec<Parts>) {
        let Some(track) = track else { return (tree::placed(place), Vec::new()) };
        let Some(parts) = Parts::of_all(track) else {
            self.tell("what moves with a matrix that slants stands as it is at first");
            return (tree::placed(place), Vec::new());
        };
        let Parts { moved, turn, scale } = parts[0];
        let mut node = Map::new();
        node.insert("translation".to_owned(), json!(moved));
        node.insert("rotation".to_owned(), json!(turn));
        node.insert("scale".to_owned(), json!(scale));
        (node, parts)
    }

    /// Has a node move.
    pub fn moves(&mut self, node: usize, parts: &[Parts]) {
        if parts.is_empty() {
            return;
        }
        let moved: Vec<[f64; 3]> = parts.iter().map(|p| p.moved).collect();
        let turns: Vec<[f64; 4]> = parts.iter().map(|p| p.turn).collect();
        let scales: Vec<[f64; 3]> = parts.iter().map(|p| p.scale).collect();
        self.channel((node, "translation"), &moved);
        self.channel((node, "rotation"), &turns);
        self.channel((node, "scale"), &scales);
    }

    fn channel<const N: usize>(&mut self, (node, path): (usize, &str), values: &[[f64; N]]) {
        let (way, keys) = keys(values);
        if keys.len() < 2 {
            return;
        }
        let fps = self.scene.animation.fps;
        let input = match self.moving.times.get(&keys) {
            Some(known) => *known,
            None => {
                let times: Vec<[f32; 1]> = keys.iter().map(|i| [(*i as f64 / fps) as f32]).collect();
                let input = self.buffer.numbers(&times, None, true);
                self.moving.times.insert(keys.clone(), input);
                input
            }
        };
        let values: Vec<[f32; N]> = keys.iter().map(|i| values[*i].map(|v| v as f32)).collect();
        let output = self.buffer.numbers(&values, None, false);
        let sampler = self.moving.samplers.len();
        self.moving.samplers.push(json!({ "input": input, "output": output, "interpolation": way }));
        self.moving.channels.push(json!({ "sampler": sampler, "target": { "node": node, "path": path } }));
    }
}

/// The frames that tell all others, and how values go between them; one where they are all the same.
fn keys<const N: usize>(values: &[[f64; N]]) -> (&'static str, Vec<usize>) {
    let last = values.len().saturating_sub(1);
    // As near as single precision tells them.
    let most = values.iter().flatten().map(|v| v.abs()).fold(0.0, |most, v| if v > most { v } else { most });
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 2e-7 * most);
    let mut steps = vec![0];
    steps.extend((1..=last).filter(|&i| !near(&values[i - 1], &values[i])));
    if steps.len() == 1 {
        return ("LINEAR", steps);
    }
    let between = |i: usize, from: usize, to: usize| {
        let (a, b, t) = (&values[from], &values[to], (i - from) as f64 / (to - from) as f64);
        if N == 4 { gltf::slerp(a, b, t) } else { a.iter().zip(b).map(|(a, b)| a + (b - a) * t).collect() }
    };
    let fits = |from: usize, to: usize| (from + 1..to).all(|i| near(&between(i, from, to), &values[i]));
    let (mut lines, mut from) = (vec![0], 0);
    while from < last {
        let mut to = from + 1;
        while to < last && fits(from, to + 1) {
            to += 1;
        }
        lines.push(to);
        from = to;
    }
    // The end tells how long it is.
    if steps.last() != Some(&last) {
        steps.push(last);
    }
    if steps.len() < lines.len() { ("STEP", steps) } else { ("LINEAR", lines) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_keys_tell_what_goes_straight_or_jumps() {
        let line: Vec<[f64; 3]> = (0..10).map(|i| [0.1 * f64::from(i), 2.0, 0.0]).collect();
        assert_eq!(keys(&line), ("LINEAR", vec![0, 9]));
        let corner: Vec<[f64; 3]> = (0..10).map(|i| [f64::from((i - 4_i32).abs()), 0.0, 0.0]).collect();
        assert_eq!(keys(&corner), ("LINEAR", vec![0, 4, 9]));
        let jump: Vec<[f64; 3]> = (0..10).map(|i| [f64::from(i / 4), 0.0, 0.0]).collect();
        assert_eq!(keys(&jump), ("STEP", vec![0, 4, 8, 9]));
        assert_eq!(keys(&[[1.0; 3]; 5]), ("LINEAR", vec![0]));
        let turn: Vec<[f64; 4]> = (0..=6)
            .map(|i| {
                let (s, c) = straal_math::ops::sin_cos_degrees(10.0 * f64::from(i));
                [0.0, s, 0.0, c]
            })
            .collect();
        assert_eq!(keys(&turn), ("LINEAR", vec![0, 6]));
    }

    #[test]
    fn places_are_taken_apart_mirrored_ones_as_well() {
        let turn = Affine::rotate(DVec3::new(1.0, 2.0, -1.0), 50.0).unwrap();
        for scale in [DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, -2.0, 3.0)] {
            let place = Affine::scale(scale).then(&turn).then(&Affine::translate(DVec3::new(4.0, 5.0, 6.0)));
            let Parts { moved, turn, scale } = Parts::of(&place).unwrap();
            let again = Affine::scale(DVec3::from_array(scale))
                .then(&gltf::rotation(turn))
                .then(&Affine::translate(DVec3::from_array(moved)));
            for (a, b) in again.rows.as_flattened().iter().zip(place.rows.as_flattened()) {
                assert!((a - b).abs() < 1e-12, "{again:?} {place:?}");
            }
        }
    }
}
