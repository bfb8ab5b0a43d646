//! Scenes that move: what of a scene's text differs from frame to frame, and the text of one frame.
//!
//! Any value of a scene may be written as keyframes: `{ keyframes: { 0: 1, 24: 2.5 } }`. A frame is a scene of its own: before a text is
//! read as a description, keyframes give way to the value that they have at the frame that is asked for. So whatever can be said
//! can move, with the same keys, checks and messages, and nothing behind this knows of frames.

use serde_json::{Value as Json, json};
use straal_math::ops;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::span::{Span, Spanned};
use crate::suggest;
use crate::tree::{Datum, Entry, Tree};
use crate::value::LinearRgb;

/// How values go from one keyframe to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Interpolation {
    /// They stay until the next.
    Step,
    /// At a constant rate.
    Linear,
    /// They set out and arrive slowly.
    Smooth,
    /// On a curve without corners, by the keyframes before and behind as well.
    Spline,
    /// Rotations, on the shortest way at a constant rate.
    Slerp,
}

const INTERPOLATIONS: [(&str, Interpolation); 5] = [
    ("step", Interpolation::Step),
    ("linear", Interpolation::Linear),
    ("smooth", Interpolation::Smooth),
    ("spline", Interpolation::Spline),
    ("slerp", Interpolation::Slerp),
];

/// The keys of keyframes.
const KEYS: [&str; 3] = ["keyframes", "interpolation", "repeat"];

/// Puts the values of a frame in place of all keyframes of a text; complains of those that are none. Whether there were any.
///
/// Where the text says that its shutter stays open (`animation: { shutter: 0.5 }`), what is in the world and the camera get the places that they go
/// through meanwhile: transforms their `motion`, cameras their `moving_to`.
pub fn settle(tree: &mut Tree, frame: f64, d: &mut Diagnostics) -> bool {
    let shutter = tree.entry("animation").and_then(|e| e.value.entry("shutter")).map(|e| &e.value.value);
    let open = match shutter {
        Some(Datum::Number(open)) if (0.0..=1.0).contains(open) => *open,
        _ => 0.0,
    };
    let entries = match &mut tree.value {
        Datum::Mapping(entries) if entries.iter().all(|e| e.key.value != KEYS[0]) => entries,
        _ => return settle_in(tree, frame, Within::Else, d),
    };
    let mut any = false;
    for Entry { key, value } in entries {
        let within = match key.value.as_str() {
            "world" | "objects" if open > 0.0 => Within::World { open },
            "camera" if open > 0.0 => Within::Camera { open },
            _ => Within::Else,
        };
        any |= settle_in(value, frame, within, d);
    }
    any
}

/// Where in a scene a value stands, as far as it may move while the shutter is open for so many frames.
#[derive(Clone, Copy)]
enum Within {
    World { open: f64 },
    Camera { open: f64 },
    Else,
}

/// While the shutter is open, places are looked up at its beginning and at the ends of so many parts, between which things go straight.
const PARTS: usize = 8;

fn settle_in(tree: &mut Tree, frame: f64, within: Within, d: &mut Diagnostics) -> bool {
    let mut any = false;
    match &mut tree.value {
        Datum::Sequence(items) => {
            for item in items {
                any |= settle_in(item, frame, within, d);
            }
        }
        Datum::Mapping(entries) => {
            if let Within::Camera { open } = within {
                any |= camera(entries, (frame, open), d);
            }
            for Entry { key, value } in entries.iter_mut() {
                any |= match (within, key.value.as_str()) {
                    (Within::World { open }, "transform") => transform(value, (frame, open), d),
                    (Within::World { .. }, "material" | "emission") => {
                        settle_in(value, frame, Within::Else, d)
                    }
                    _ => settle_in(value, frame, within, d),
                };
            }
            if entries.iter().any(|e| e.key.value == KEYS[0]) {
                any = true;
                // What can't be read becomes nothing that anything else is complained of.
                let value = Track::read(tree, d).and_then(|track| track.at(frame, d));
                let span = tree.span;
                *tree = Tree { span, ..value.unwrap_or(Tree { value: Datum::Null, span }) };
            }
        }
        _ => {}
    }
    any
}

/// What a value is from the frame on, at the ends of all parts; only at the frame if it stays. Whether it has keyframes.
fn through(value: &Tree, (frame, open): (f64, f64), d: &mut Diagnostics) -> (Vec<Tree>, bool) {
    let (mut all, mut any) = (Vec::new(), false);
    for part in 0..=PARTS {
        let mut at = value.clone();
        // Complained of once.
        let errors = d.errors();
        any |= settle_in(&mut at, frame + open * part as f64 / PARTS as f64, Within::Else, d);
        let stays = |first: &Tree| part == PARTS && all.iter().all(|other| other == first) && at == *first;
        if all.first().is_some_and(stays) {
            all.truncate(1);
            break;
        }
        all.push(at);
        if !any || d.errors() > errors {
            break;
        }
    }
    (all, any)
}

/// A transform in the world, which may move.
fn transform(tree: &mut Tree, moment: (f64, f64), d: &mut Diagnostics) -> bool {
    let (mut all, any) = through(tree, moment, d);
    if all.len() <= PARTS {
        *tree = all.swap_remove(0);
    } else {
        let span = tree.span;
        let value = Tree { value: Datum::Sequence(all), span };
        let entry = Entry { key: Spanned::new("motion".to_owned(), span), value };
        tree.value = Datum::Mapping(vec![entry]);
    }
    any
}

/// The keys of a camera that say where it is.
const PLACE: [&str; 4] = ["eye", "look_at", "up", "roll"];

/// A camera that may move, unless it says itself how it does.
fn camera(entries: &mut Vec<Entry>, moment: (f64, f64), d: &mut Diagnostics) -> bool {
    let mut any = false;
    if entries.iter().any(|e| e.key.value == "moving_to") {
        return any;
    }
    let mut later: Vec<Vec<Entry>> = vec![Vec::new(); PARTS];
    for Entry { key, value } in entries.iter_mut().filter(|e| PLACE.contains(&e.key.value.as_str())) {
        let (mut all, moves) = through(value, moment, d);
        any |= moves;
        if all.len() > PARTS {
            for (later, value) in later.iter_mut().zip(all.drain(1..)) {
                later.push(Entry { key: key.clone(), value });
            }
        }
        *value = all.swap_remove(0);
    }
    if let Some(first) = later[0].first() {
        let span = first.value.span;
        let at = |entries| Tree { value: Datum::Mapping(entries), span };
        let value = Tree { value: Datum::Sequence(later.into_iter().map(at).collect()), span };
        entries.push(Entry { key: Spanned::new("moving_to".to_owned(), span), value });
    }
    any
}

/// The JSON Schema of keyframes.
pub(crate) fn schema() -> Json {
    json!({
        "description": "What a value is at some frames, and how it goes from one to the next.",
        "type": "object",
        "additionalProperties": false,
        "properties": {
            "keyframes": { "description": "Values by the numbers of frames.", "type": "object" },
            "interpolation": {
                "description": "How it goes from one keyframe to the next.",
                "enum": INTERPOLATIONS.map(|(name, _)| name),
                "default": "linear",
            },
            "repeat": { "description": "Whether it begins anew after the last.", "type": "boolean", "default": false },
        },
        "required": ["keyframes"],
    })
}

/// Values at some frames.
struct Track<'a> {
    span: Span,
    /// By rising frame; at least one.
    keys: Vec<(f64, &'a Tree)>,
    interpolation: Interpolation,
    /// Whether it begins anew after the last.
    repeats: bool,
}

impl<'a> Track<'a> {
    fn read(tree: &'a Tree, d: &mut Diagnostics) -> Option<Self> {
        let Datum::Mapping(entries) = &tree.value else { return None };
        let errors = d.errors();
        let (mut keys, mut interpolation, mut repeats) = (Vec::new(), Interpolation::Linear, false);
        for Entry { key, value } in entries {
            match key.value.as_str() {
                "keyframes" => keys = frames(value, d),
                "interpolation" => {
                    let word = if let Datum::String(word) = &value.value { word.as_str() } else { "" };
                    match INTERPOLATIONS.iter().find(|(name, _)| *name == word) {
                        Some((_, found)) => interpolation = *found,
                        None => {
                            let names = INTERPOLATIONS.iter().map(|(name, _)| *name);
                            let message = format!(
                                "`interpolation` is one of {}, not {}",
                                suggest::list(names.clone()),
                                value.kind()
                            );
                            let help = suggest::did_you_mean(word, names);
                            d.push(Diagnostic::error(value.span, message).maybe_help(help));
                        }
                    }
                }
                "repeat" => match value.value {
                    Datum::Bool(is) => repeats = is,
                    _ => {
                        let message = format!("`repeat` is true or false, not {}", value.kind());
                        d.push(Diagnostic::error(value.span, message));
                    }
                },
                other => {
                    let message = format!("unknown key `{}` beside `keyframes`", suggest::brief(other));
                    let help = suggest::did_you_mean(other, KEYS)
                        .or_else(|| Some(format!("known are {}", suggest::list(KEYS))));
                    d.push(Diagnostic::error(key.span, message).maybe_help(help));
                }
            }
        }
        (d.errors() == errors).then_some(Self { span: tree.span, keys, interpolation, repeats })
    }

    /// The value at a frame.
    fn at(&self, frame: f64, d: &mut Diagnostics) -> Option<Tree> {
        let (first, last) = (self.keys.first()?, self.keys.last()?);
        let length = last.0 - first.0;
        let frame = if self.repeats && length > 0.0 {
            let turns = ((frame - first.0) / length).floor();
            frame - turns * length
        } else {
            frame
        };
        // The last key that isn't later, and the next.
        let next = self.keys.partition_point(|(at, _)| *at <= frame);
        let Some(before) = next.checked_sub(1) else { return Some(first.1.clone()) };
        let (from, value) = self.keys[before];
        let Some(&(to, following)) = self.keys.get(next).filter(|_| frame > from) else {
            return Some(value.clone());
        };
        let t = (frame - from) / (to - from);
        let mixed = match self.interpolation {
            Interpolation::Step => Some(value.clone()),
            Interpolation::Linear => mix(&[(value, 1.0 - t), (following, t)]),
            Interpolation::Smooth => {
                let t = t * t * (3.0 - 2.0 * t);
                mix(&[(value, 1.0 - t), (following, t)])
            }
            Interpolation::Spline => {
                let around = [before.checked_sub(1), Some(before), Some(next), Some(next + 1)];
                let around = around.map(|i| i.and_then(|i| self.keys.get(i)));
                mix(&weights_of_spline(around.map(|k| k.map(|k| k.0)), t)
                    .into_iter()
                    .zip(around)
                    .filter_map(|(weight, key)| Some((key?.1, weight)))
                    .collect::<Vec<_>>())
            }
            Interpolation::Slerp => slerp(value, following, t),
        };
        if mixed.is_none() {
            let (message, help) = if self.interpolation == Interpolation::Slerp {
                (
                    "these keyframes are no rotations",
                    "`slerp` goes between rotations such as { axis: y, degrees: 90 }",
                )
            } else {
                (
                    "nothing lies between these keyframes: they are neither numbers nor alike",
                    "`interpolation: step` keeps each until the next",
                )
            };
            let complaint = Diagnostic::error(self.span, message).help(help);
            d.push(complaint.related(value.span, "from this").related(following.span, "to this"));
        }
        mixed
    }
}

/// Frames and values by rising frame; complains of what is none.
fn frames<'a>(tree: &'a Tree, d: &mut Diagnostics) -> Vec<(f64, &'a Tree)> {
    let Datum::Mapping(entries) = &tree.value else {
        let message = format!("keyframes are a mapping of frames to values, not {}", tree.kind());
        d.push(Diagnostic::error(tree.span, message).help("write `keyframes: { 0: 1, 24: 2 }`"));
        return Vec::new();
    };
    let mut keys = Vec::new();
    for Entry { key, value } in entries {
        match key.value.parse::<f64>() {
            Ok(at) if at.is_finite() => keys.push((at, value)),
            _ => {
                let message = format!("`{}` is not the number of a frame", suggest::brief(&key.value));
                d.push(Diagnostic::error(key.span, message).help("write `keyframes: { 0: 1, 24: 2 }`"));
            }
        }
    }
    keys.sort_by(|a, b| a.0.total_cmp(&b.0));
    if entries.is_empty() {
        d.push(
            Diagnostic::error(tree.span, "there is no keyframe").help("write `keyframes: { 0: 1, 24: 2 }`"),
        );
    }
    if let Some(twice) = keys.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let message = format!("frame {} has two values", twice[0].0);
        d.push(Diagnostic::error(twice[1].1.span, message).related(twice[0].1.span, "the other"));
    }
    keys
}

/// What four keyframes, of which the first and last may be missing, weigh at a place between the two in the middle: a cubic Hermite
/// curve whose slope at a key is that of the line between its neighbours (Catmull and Rom 1974, for uneven times).
fn weights_of_spline(at: [Option<f64>; 4], t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    let ends = [2.0 * t3 - 3.0 * t2 + 1.0, 3.0 * t2 - 2.0 * t3];
    let slopes = [t3 - 2.0 * t2 + t, t3 - t2];
    let mut weights = [0.0, ends[0], ends[1], 0.0];
    let (Some(from), Some(to)) = (at[1], at[2]) else { return weights };
    for (slope, [a, b]) in slopes.into_iter().zip([[0, 2], [1, 3]]) {
        // At the ends of a track there is only the one side.
        let (a, b) = (if at[a].is_some() { a } else { 1 }, if at[b].is_some() { b } else { 2 });
        let apart = at[b].unwrap_or(to) - at[a].unwrap_or(from);
        let weight = slope * (to - from) / apart;
        weights[b] += weight;
        weights[a] -= weight;
    }
    weights
}

/// A colour that is written as a code, as a list of its numbers.
fn as_numbers(tree: &Tree) -> Option<[f64; 3]> {
    match &tree.value {
        Datum::String(text) => LinearRgb::from_hex(text).map(|rgb| rgb.0),
        _ => None,
    }
}

/// The weighed sum of values that are built alike; what isn't a number must be the same in all.
fn mix<'a>(parts: &[(&'a Tree, f64)]) -> Option<Tree> {
    let (first, _) = *parts.first()?;
    let with = |value| Some(Tree { value, span: first.span });
    match &first.value {
        Datum::Number(_) => {
            let mut sum = 0.0;
            for (tree, weight) in parts {
                let Datum::Number(v) = tree.value else { return None };
                sum += weight * v;
            }
            with(Datum::Number(sum))
        }
        Datum::Sequence(items) => {
            let mut mixed = Vec::new();
            for i in 0..items.len() {
                let item = |&(tree, weight): &(&'a Tree, f64)| match &tree.value {
                    Datum::Sequence(others) if others.len() == items.len() => Some((&others[i], weight)),
                    _ => None,
                };
                mixed.push(mix(&parts.iter().map(item).collect::<Option<Vec<_>>>()?)?);
            }
            with(Datum::Sequence(mixed))
        }
        Datum::Mapping(entries) => {
            let mut mixed = Vec::new();
            for Entry { key, .. } in entries {
                let value = |&(tree, weight): &(&'a Tree, f64)| match &tree.value {
                    Datum::Mapping(others) if others.len() == entries.len() => {
                        Some((&tree.entry(key)?.value, weight))
                    }
                    _ => None,
                };
                let value = mix(&parts.iter().map(value).collect::<Option<Vec<_>>>()?)?;
                mixed.push(Entry { key: key.clone(), value });
            }
            with(Datum::Mapping(mixed))
        }
        other if parts.iter().all(|(tree, _)| tree.value == *other) => Some(first.clone()),
        _ => {
            let colours: Vec<_> = parts
                .iter()
                .map(|(tree, weight)| Some((as_numbers(tree)?, *weight)))
                .collect::<Option<_>>()?;
            let channel = |i: usize| colours.iter().map(|(rgb, weight)| rgb[i] * weight).sum::<f64>();
            let number = |i| Tree { value: Datum::Number(channel(i)), span: first.span };
            with(Datum::Sequence((0..3).map(number).collect()))
        }
    }
}

/// The unit quaternion of a rotation, `{ axis: y, degrees: 90 }` or `{ y: 90 }`.
fn quaternion(tree: &Tree) -> Option<[f64; 4]> {
    let Datum::Mapping(entries) = &tree.value else { return None };
    let number = |tree: &Tree| if let Datum::Number(v) = tree.value { Some(v) } else { None };
    let named = |name: &str| match name {
        "x" => Some([1.0, 0.0, 0.0]),
        "y" => Some([0.0, 1.0, 0.0]),
        "z" => Some([0.0, 0.0, 1.0]),
        _ => None,
    };
    let (axis, degrees) = match entries.as_slice() {
        [one] => (named(&one.key)?, number(&one.value)?),
        [_, _] => {
            let degrees = number(&tree.entry("degrees")?.value)?;
            let axis = match &tree.entry("axis")?.value.value {
                Datum::String(name) => named(name)?,
                Datum::Sequence(v) if v.len() == 3 => [number(&v[0])?, number(&v[1])?, number(&v[2])?],
                _ => return None,
            };
            (axis, degrees)
        }
        _ => return None,
    };
    let length = axis.iter().map(|v| v * v).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite() && degrees.is_finite()) {
        return None;
    }
    let (sin, cos) = ops::sin_cos_degrees(degrees * 0.5);
    Some([axis[0] / length * sin, axis[1] / length * sin, axis[2] / length * sin, cos])
}

/// A rotation between two (Shoemake 1985), on the shorter way.
fn slerp(from: &Tree, to: &Tree, t: f64) -> Option<Tree> {
    let (a, mut b) = (quaternion(from)?, quaternion(to)?);
    let mut cos: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
    if cos < 0.0 {
        (cos, b) = (-cos, b.map(|v| -v));
    }
    let (wa, wb) = if cos > 1.0 - 1e-12 {
        (1.0 - t, t)
    } else {
        let angle = ops::acos_d(cos);
        let sin = |x: f64| ops::sin_cos_d(x).0;
        (sin((1.0 - t) * angle) / sin(angle), sin(t * angle) / sin(angle))
    };
    let q: [f64; 4] = std::array::from_fn(|i| wa * a[i] + wb * b[i]);
    let sin = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]).sqrt();
    let (axis, degrees) = if sin > 0.0 {
        ([q[0] / sin, q[1] / sin, q[2] / sin], 2.0 * ops::atan2_d(sin, q[3]).to_degrees())
    } else {
        ([0.0, 1.0, 0.0], 0.0)
    };
    let span = from.span;
    let number = |v: f64| Tree { value: Datum::Number(v), span };
    let entry = |key: &str, value: Datum| Entry {
        key: Spanned::new(key.to_owned(), span),
        value: Tree { value, span },
    };
    let entries = vec![
        entry("axis", Datum::Sequence(axis.map(number).into())),
        entry("degrees", Datum::Number(degrees)),
    ];
    Some(Tree { value: Datum::Mapping(entries), span })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(v: f64) -> Tree {
        Tree { value: Datum::Number(v), span: Span::NONE }
    }

    fn text(v: &str) -> Tree {
        Tree { value: Datum::String(v.to_owned()), span: Span::NONE }
    }

    fn list(v: &[f64]) -> Tree {
        Tree { value: Datum::Sequence(v.iter().map(|v| number(*v)).collect()), span: Span::NONE }
    }

    fn map(entries: Vec<(&str, Tree)>) -> Tree {
        let entry = |(key, value): (&str, Tree)| Entry { key: key.to_owned().into(), value };
        Tree { value: Datum::Mapping(entries.into_iter().map(entry).collect()), span: Span::NONE }
    }

    /// Keyframes with an interpolation, settled at a frame, or the complaints.
    fn settled(keys: Vec<(&str, Tree)>, how: &str, repeats: bool, frame: f64) -> Result<Tree, String> {
        let repeat = Tree { value: Datum::Bool(repeats), span: Span::NONE };
        let mut tree = map(vec![("keyframes", map(keys)), ("interpolation", text(how)), ("repeat", repeat)]);
        let mut d = Diagnostics::default();
        assert!(settle(&mut tree, frame, &mut d));
        if d.has_errors() { Err(d.to_string()) } else { Ok(tree) }
    }

    fn at(how: &str, repeats: bool, frame: f64) -> f64 {
        // Out of order on purpose.
        let keys = vec![("10", number(2.0)), ("0", number(1.0)), ("30", number(8.0)), ("40", number(3.0))];
        match settled(keys, how, repeats, frame).unwrap().value {
            Datum::Number(v) => v,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_keyframe_is_met_exactly_and_held_outside() {
        for how in ["step", "linear", "smooth", "spline"] {
            let met = [-5.0, 0.0, 10.0, 30.0, 40.0, 41.0].map(|frame| at(how, false, frame));
            assert_eq!(met, [1.0, 1.0, 2.0, 8.0, 3.0, 3.0], "{how}");
        }
    }

    #[test]
    fn between_keyframes() {
        assert_eq!(at("step", false, 29.9), 2.0);
        assert_eq!(at("linear", false, 20.0), 5.0);
        assert_eq!(at("smooth", false, 20.0), 5.0);
        assert!((at("smooth", false, 15.0) - (2.0 + 6.0 * 0.15625)).abs() < 1e-12);
        // Repeated after 40 frames, either way.
        assert_eq!([45.0, -35.0, 85.0].map(|frame| at("linear", true, frame)), [1.5; 3]);
    }

    #[test]
    fn a_spline_follows_what_a_parabola_or_a_line_would() {
        // Slopes of a parabola are those between even neighbours, so that the curve is exact between inner keys.
        let keys = |f: fn(f64) -> f64| {
            ["0", "10", "20", "30"].map(|k| (k, number(f(k.parse().unwrap())))).into_iter().collect()
        };
        for frame in [11.0, 15.0, 19.0] {
            let parabola = settled(keys(|x| x * x), "spline", false, frame).unwrap();
            assert!(matches!(parabola.value, Datum::Number(v) if (v - frame * frame).abs() < 1e-9));
        }
        for frame in [3.0, 15.0, 28.0] {
            let line = settled(keys(|x| 2.0 * x + 1.0), "spline", false, frame).unwrap();
            assert!(matches!(line.value, Datum::Number(v) if (v - 2.0 * frame - 1.0).abs() < 1e-9));
        }
    }

    #[test]
    fn lists_mappings_and_colours_are_mixed_part_by_part() {
        let keys = vec![("0", list(&[0.0, 2.0])), ("4", list(&[4.0, 2.0]))];
        assert_eq!(settled(keys, "linear", false, 1.0).unwrap(), list(&[1.0, 2.0]));
        let of = |r: f64, m: &str| map(vec![("radius", number(r)), ("material", text(m))]);
        let keys = vec![("0", of(1.0, "a")), ("2", of(3.0, "a"))];
        assert_eq!(settled(keys, "linear", false, 1.0).unwrap(), of(2.0, "a"));
        let keys = vec![("0", text("#000")), ("2", text("#fff"))];
        assert_eq!(settled(keys, "linear", false, 1.0).unwrap(), list(&[0.5, 0.5, 0.5]));
    }

    #[test]
    fn rotations_take_the_shorter_way_at_a_constant_rate() {
        let turn = |axis: &str, degrees: f64| map(vec![("axis", text(axis)), ("degrees", number(degrees))]);
        let between = |a, b, frame| {
            let tree = settled(vec![("0", a), ("10", b)], "slerp", false, frame).unwrap();
            quaternion(&tree).unwrap()
        };
        let near = |a: [f64; 4], b: [f64; 4]| {
            let cos: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
            cos.abs() > 1.0 - 1e-12
        };
        assert!(near(between(turn("y", 10.0), turn("y", 50.0), 2.5), quaternion(&turn("y", 20.0)).unwrap()));
        // From 350 to 10 degrees by way of 0.
        assert!(near(between(turn("y", 350.0), turn("y", 10.0), 5.0), [0.0, 0.0, 0.0, 1.0]));
        // Halfway between a quarter turn about x and none: an eighth.
        let short = map(vec![("x", number(0.0))]);
        assert!(near(between(turn("x", 90.0), short, 5.0), quaternion(&turn("x", 45.0)).unwrap()));
        let complaint = settled(vec![("0", number(1.0)), ("1", number(2.0))], "slerp", false, 0.5);
        assert!(complaint.unwrap_err().contains("these keyframes are no rotations"));
    }

    #[test]
    fn what_is_wrong_is_told() {
        let wrong = |keys, how| settled(keys, how, false, 0.5).unwrap_err();
        assert!(wrong(vec![("a", number(1.0))], "linear").contains("`a` is not the number of a frame"));
        assert!(wrong(vec![], "linear").contains("there is no keyframe"));
        let twice = vec![("1", number(1.0)), ("1.0", number(2.0))];
        assert!(wrong(twice, "linear").contains("frame 1 has two values"));
        assert!(wrong(vec![("0", number(1.0))], "liner").contains("did you mean `linear`?"));
        let unlike = vec![("0", number(1.0)), ("1", text("a"))];
        assert!(wrong(unlike, "linear").contains("nothing lies between these keyframes"));
    }

    #[test]
    fn while_the_shutter_is_open_the_world_and_the_camera_go_on() {
        let track =
            |from: f64, to: f64| map(vec![("keyframes", map(vec![("0", number(from)), ("2", number(to))]))]);
        let moving = |from, to| {
            map(vec![("transform", map(vec![("scale", track(from, to))])), ("radius", track(1.0, 3.0))])
        };
        let scene = |open: f64| {
            map(vec![
                ("animation", map(vec![("shutter", number(open))])),
                (
                    "camera",
                    map(vec![(
                        "perspective",
                        map(vec![("eye", track(0.0, 4.0)), ("roll", track(7.0, 7.0))]),
                    )]),
                ),
                (
                    "world",
                    Tree {
                        value: Datum::Sequence(vec![moving(1.0, 5.0), moving(2.0, 2.0)]),
                        span: Span::NONE,
                    },
                ),
            ])
        };
        let settled = |open, frame| {
            let (mut tree, mut d) = (scene(open), Diagnostics::default());
            assert!(settle(&mut tree, frame, &mut d) && !d.has_errors());
            tree
        };
        let get = |tree: &Tree, keys: &[&str]| -> Tree {
            keys.iter().fold(tree.clone(), |tree, key| match (&tree.value, key.parse::<usize>()) {
                (Datum::Sequence(items), Ok(i)) => items[i].clone(),
                _ => tree.entry(key).unwrap_or_else(|| panic!("{key}: {tree:?}")).value.clone(),
            })
        };
        let still = settled(0.0, 1.0);
        assert_eq!(get(&still, &["world", "0", "transform", "scale"]), number(3.0));
        let open = settled(0.5, 1.0);
        for (i, at) in [(0, 3.0), (4, 3.5), (8, 4.0)] {
            let scale = get(&open, &["world", "0", "transform", "motion", &i.to_string(), "scale"]);
            assert_eq!(scale, number(at));
        }
        assert_eq!(get(&open, &["world", "0", "radius"]), number(2.0), "only places move");
        assert_eq!(get(&open, &["world", "1", "transform", "scale"]), number(2.0), "it stays");
        assert_eq!(get(&open, &["camera", "perspective", "eye"]), number(2.0));
        assert_eq!(get(&open, &["camera", "perspective", "moving_to", "7", "eye"]), number(3.0));
        assert_eq!(get(&open, &["camera", "perspective", "roll"]), number(7.0));
        assert!(get(&open, &["camera", "perspective", "moving_to", "7"]).entry("roll").is_none());
    }

    #[test]
    fn what_has_no_keyframes_stays() {
        let mut tree = map(vec![("a", list(&[1.0])), ("b", text("keyframes"))]);
        let before = tree.clone();
        assert!(!settle(&mut tree, 7.0, &mut Diagnostics::default()));
        assert_eq!(tree, before);
    }
}
