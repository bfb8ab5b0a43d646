//! `KHR_animation_pointer`: animations of any number of the file, told by where it stands in its JSON.
//!
//! A frame is a file of its own: before anything else is read, the numbers that move get the values that they have at the frame. So whatever is
//! read can move.

use std::collections::BTreeMap;
use std::path::PathBuf;

use straal_scene::{Diagnostics, FileId};

use super::animation::{frames_a_second, is_called, sampled};
use super::document::{Document, Result, in_list, required, text};
use super::json::{Json, Value};
use crate::scene::Means;

pub(super) const NAME: &str = "KHR_animation_pointer";

/// Numbers of a value: as many as a mesh may have morph targets.
const WIDEST: usize = 4096;

/// Gives the numbers of a file the values that they have at the frame that is shown. What is wrong with an animation is told where all are read.
pub(super) fn settle(root: &mut Json, file: FileId, binary: Option<&[u8]>, means: &mut Means<'_>) {
    let pointed = |animation: &Json| {
        let channels = animation.get("channels").map_or(&[][..], Json::items);
        channels.iter().any(|c| c.get("target").is_some_and(|t| t.extension(NAME).is_some()))
    };
    let all = root.get("animations").map_or(&[][..], Json::items);
    if !all.iter().any(pointed) {
        return;
    }
    let (mut d, mut ledger) = (Diagnostics::default(), *means.ledger);
    let (define, frame) = (means.define, means.frame);
    let mut scratch = means.beside(frame, &mut ledger, &mut d);
    let mut files: Vec<(PathBuf, String, [u8; 32])> = Vec::new();
    let mut document = Document::open(root, file, binary, &mut scratch, &mut files);
    let found = values(&mut document, define, frame).unwrap_or_default();
    for (path, value) in found {
        put(root, &path, &value);
    }
}

/// The numbers that move, by the ways to them, of which the first that moves the same counts.
fn values(
    document: &mut Document<'_>,
    define: &BTreeMap<String, String>,
    frame: f64,
) -> Result<BTreeMap<String, Vec<f64>>> {
    let Some(fps) = frames_a_second(define) else { return Ok(BTreeMap::new()) };
    let (time, wanted) = (frame / fps, define.get("animation"));
    let mut found = BTreeMap::new();
    for (i, animation) in document.list("animations").iter().enumerate() {
        if !wanted.is_none_or(|wanted| is_called(i, animation, wanted)) {
            continue;
        }
        let samplers = required(animation, "samplers")?.items();
        for channel in required(animation, "channels")?.items() {
            let Some(said) = required(channel, "target")?.extension(NAME) else { continue };
            let path = text(required(said, "pointer")?)?;
            if found.contains_key(path) {
                continue;
            }
            let (_, sampler) = in_list("samplers", samplers, required(channel, "sampler")?)?;
            let is_turn = path.starts_with("/nodes/") && path.ends_with("/rotation");
            let value = sampled(document, sampler, (time, is_turn))?;
            if value.len() <= WIDEST {
                found.insert(path.to_owned(), value);
            }
        }
    }
    Ok(found)
}

/// Puts numbers where a pointer (RFC 6901) leads; nowhere where that isn't. Keys that aren't there are made.
fn put(root: &mut Json, path: &str, numbers: &[f64]) {
    /// Pointers are as long as this at most.
    const LONGEST: usize = 32;
    let steps: Vec<String> =
        path.split('/').skip(1).map(|step| step.replace("~1", "/").replace("~0", "~")).collect();
    let Some(last) = steps.last().filter(|_| steps.len() <= LONGEST) else { return };
    let mut here = root;
    for step in &steps {
        let (start, end) = (here.start, here.end);
        here = match &mut here.value {
            Value::List(items) => match step.parse::<usize>().ok().and_then(|i| items.get_mut(i)) {
                Some(item) => item,
                None => return,
            },
            Value::Object(entries) => {
                let i = match entries.binary_search_by(|(key, _)| (**key).cmp(step.as_str())) {
                    Ok(i) => i,
                    Err(i) => {
                        let empty = Json { value: Value::Object(Vec::new()), start, end };
                        entries.insert(i, (step.as_str().into(), empty));
                        i
                    }
                };
                &mut entries[i].1
            }
            _ => return,
        };
    }
    let (start, end) = (here.start, here.end);
    let number = |v: f64| Json { value: Value::Number(v), start, end };
    here.value = match numbers {
        // Flags are told by whole numbers.
        [v] if matches!(here.value, Value::Bool(_)) || last == "visible" => Value::Bool(*v != 0.0),
        [v] if last != "weights" => Value::Number(*v),
        all => Value::List(all.iter().copied().map(number).collect()),
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_go_where_pointers_lead() {
        let mut root = Json::parse(r#"{"a": [{"b": 1, "visible": true}], "weights": [0]}"#).unwrap();
        put(&mut root, "/a/0/b", &[2.5]);
        put(&mut root, "/a/0/visible", &[0.0]);
        put(&mut root, "/a/0/c~1d/e", &[1.0, 2.0, 3.0]);
        put(&mut root, "/a/7/b", &[9.0]);
        put(&mut root, "/weights", &[0.5]);
        let a = &root.get("a").unwrap().items()[0];
        assert_eq!(a.get("b").unwrap().number(), Some(2.5));
        assert_eq!(a.get("visible").unwrap().value, Value::Bool(false));
        assert_eq!(a.get("c/d").and_then(|c| c.get("e")).unwrap().items().len(), 3);
        assert_eq!(root.get("weights").unwrap().items()[0].number(), Some(0.5));
        assert_eq!(root.get("a").unwrap().items().len(), 1);
    }
}
