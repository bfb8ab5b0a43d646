//! The keyframes of a camera that moves.

use serde_json::{Value as Json, json};
use straal_math::DVec3;

use crate::decode::{Decoder, Describe, write_list};
use crate::describe::describe;
use crate::diagnostic::Diagnostic;
use crate::limit::Limit;
use crate::schema::Definitions;
use crate::span::{Span, Spanned};
use crate::tree::{Datum, Tree};
use crate::writer::Writer;

/// Where a camera goes from where it is at time 0: one keyframe, or several one after the other. After the last it stays there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Keyframes {
    /// The keyframes by rising time.
    pub keyframes: Vec<Spanned<Keyframe>>,
}

describe! {
    /// What of a camera's place and view changes while it moves; the rest stays as it was.
    pub struct Keyframe {
        /// When it is there, after 0 and at most 1. Keyframes without times are evenly apart, the last at 1.
        time: Option<f64> [Limit::UNIT] = None,
        /// Where the camera stands.
        eye: Option<DVec3> = None,
        /// The point in the middle of the picture.
        look_at: Option<DVec3> = None,
        /// The direction that is up in the picture.
        up: Option<DVec3> = None,
        /// Turn about the view in degrees.
        roll: Option<f64> = None,
    }
}

/// Where a camera stands and looks at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraAt {
    /// From 0 to 1.
    pub time: f64,
    /// Where it stands.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub look_at: DVec3,
    /// Up in the picture.
    pub up: DVec3,
    /// Turn about the view in degrees.
    pub roll: f64,
    /// Where it was said.
    pub span: Span,
}

impl Keyframes {
    /// The time of each keyframe.
    pub fn times(&self) -> Vec<f64> {
        let n = self.keyframes.len() as f64;
        let evenly = |i: usize| (i + 1) as f64 / n;
        self.keyframes
            .iter()
            .enumerate()
            .map(|(i, keyframe)| keyframe.time.unwrap_or_else(|| evenly(i)))
            .collect()
    }

    /// The first keyframe, by its index, that is not later than the one before, or than time 0.
    pub fn disorder(&self) -> Option<usize> {
        let times = self.times();
        (0..times.len()).find(|&i| times[i] <= if i > 0 { times[i - 1] } else { 0.0 })
    }

    /// Complains of times that make no keyframes.
    fn check(&self, d: &mut Decoder) {
        let first = |is_told: bool| self.keyframes.iter().find(|p| p.time.is_some() == is_told);
        if let (Some(with), Some(without)) = (first(true), first(false)) {
            let message = "this keyframe has no `time`, and another has one";
            let complaint = Diagnostic::error(without.span, message).related(with.span, "this one");
            d.push(complaint.help("tell it of all keyframes, or of none to have them evenly apart"));
            return;
        }
        let Some(i) = self.disorder() else { return };
        let times = self.times();
        let message = match i {
            0 => "at time 0 the camera is where its other keys say: a keyframe must be later".to_owned(),
            _ => format!("the times of keyframes must rise, but {} comes after {}", times[i], times[i - 1]),
        };
        d.push(Diagnostic::error(self.keyframes[i].span, message));
    }
}

impl Describe for Keyframes {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let before = d.diagnostics.errors();
        let keyframe = |item: &Tree, d: &mut Decoder| Spanned::new(Keyframe::read(item, limit, d), item.span);
        let keyframes = match &tree.value {
            Datum::Mapping(_) => vec![keyframe(tree, d)],
            Datum::Sequence(items) if !items.is_empty() => {
                items.iter().map(|item| keyframe(item, d)).collect()
            }
            _ => {
                d.expected("a keyframe or a list of keyframes", tree);
                Vec::new()
            }
        };
        let keyframes = Self { keyframes };
        if d.diagnostics.errors() == before {
            keyframes.check(d);
        }
        keyframes
    }
    fn blank() -> Self {
        Self::default()
    }
    fn write_to(&self, out: &mut dyn Writer) {
        match self.keyframes.as_slice() {
            [one] => one.value.write_to(out),
            keyframes => write_list(keyframes.iter().map(|keyframe| &keyframe.value), out),
        }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        let keyframe = Keyframe::schema(limit, defs);
        json!({ "anyOf": [keyframe, { "type": "array", "items": keyframe, "minItems": 1 }] })
    }
}
