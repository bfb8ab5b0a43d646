//! Points, directions and transforms.

use serde_json::{Value as Json, json};
use straal_math::{Affine, DVec3};

use crate::decode::{Decoder, Describe};
use crate::desc::{AxisAngle, Coordinate, Rotation, Step, Transform};
use crate::diagnostic::Diagnostic;
use crate::limit::Limit;
use crate::remedy;
use crate::schema;
use crate::schema::Definitions;
use crate::span::Spanned;
use crate::suggest;
use crate::tree::{Datum, Entry, Tree};
use crate::value::{Axis, Factors, Matrix};
use crate::writer::Writer;

impl Describe for DVec3 {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::Sequence(items) if items.len() == 3 => {
                Self::from_array(std::array::from_fn(|i| f64::read(&items[i], limit, d)))
            }
            _ => {
                d.expected_or("three numbers `[x, y, z]`", tree, remedy::vector(tree));
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        Self::ONE
    }
    fn write_to(&self, out: &mut dyn Writer) {
        self.to_array().write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        <[f64; 3]>::schema(limit, defs)
    }
}

/// A point of which it matters where it was said.
impl Describe for Spanned<DVec3> {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        Self::new(DVec3::read(tree, limit, d), tree.span)
    }
    fn blank() -> Self {
        DVec3::blank().into()
    }
    fn write_to(&self, out: &mut dyn Writer) {
        self.value.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        DVec3::schema(limit, defs)
    }
}

impl Describe for Axis {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::String(s) if s == "x" => Self(DVec3::X),
            Datum::String(s) if s == "y" => Self(DVec3::Y),
            Datum::String(s) if s == "z" => Self(DVec3::Z),
            Datum::Sequence(items) if items.len() == 3 => {
                let v = DVec3::read(tree, limit, d);
                if v == DVec3::ZERO {
                    let message = format!("`{}` has no direction: all three numbers are 0", d.key());
                    d.push(Diagnostic::error(tree.span, message));
                }
                Self(v)
            }
            _ => {
                d.expected("`x`, `y`, `z` or three numbers `[x, y, z]`", tree);
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        Self(DVec3::Y)
    }
    fn write_to(&self, out: &mut dyn Writer) {
        match self.0 {
            DVec3::X => out.text("x"),
            DVec3::Y => out.text("y"),
            DVec3::Z => out.text("z"),
            v => v.write_to(out),
        }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "anyOf": [{ "enum": ["x", "y", "z"] }, DVec3::schema(limit, defs)] })
    }
}

impl Describe for Factors {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let factors = match &tree.value {
            Datum::Number(_) => DVec3::splat(f64::read(tree, limit, d)),
            Datum::Sequence(items) if items.len() == 3 => DVec3::read(tree, limit, d),
            _ => {
                d.expected("a number or three numbers `[x, y, z]`", tree);
                DVec3::ONE
            }
        };
        if factors.to_array().contains(&0.0) {
            let message = format!("`{}` by 0 leaves nothing to see", d.key());
            d.push(Diagnostic::error(tree.span, message).help("to flatten, use a small factor such as 1e-3"));
            return Self::blank();
        }
        Self(factors)
    }
    fn blank() -> Self {
        Self(DVec3::ONE)
    }
    fn write_to(&self, out: &mut dyn Writer) {
        let v = self.0;
        if v.x == v.y && v.y == v.z { v.x.write_to(out) } else { v.write_to(out) }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "anyOf": [schema::number("number", limit), DVec3::schema(limit, defs)] })
    }
}

impl Describe for Matrix {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let rows = match &tree.value {
            Datum::Sequence(rows) if rows.len() == 3 || rows.len() == 4 => rows,
            _ => {
                d.expected("three or four rows of four numbers", tree);
                return Self::blank();
            }
        };
        if let Some(last) = rows.get(3)
            && <[f64; 4]>::read(last, limit, d) != [0.0, 0.0, 0.0, 1.0]
        {
            let message = "the fourth row of a matrix must be `[0, 0, 0, 1]`";
            d.push(Diagnostic::error(last.span, message));
        }
        Self(Affine { rows: std::array::from_fn(|i| <[f64; 4]>::read(&rows[i], limit, d)) })
    }
    fn blank() -> Self {
        Self(Affine::IDENTITY)
    }
    fn write_to(&self, out: &mut dyn Writer) {
        self.0.rows.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "type": "array", "items": <[f64; 4]>::schema(limit, defs), "minItems": 3, "maxItems": 4 })
    }
}

/// `{ axis: y, degrees: 30 }`, or `{ y: 30 }` in short.
impl Describe for Rotation {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::Mapping(entries) => {
                if let [Entry { key, value }] = entries.as_slice()
                    && let Some(axis) = Coordinate::KINDS.iter().find(|k| **k == key.value)
                {
                    let degrees = d.under(axis, key.span, |d| f64::read(value, limit, d));
                    return Self { axis: Axis(axis_of(axis)), degrees };
                }
                // Several axes, or axes in other letters.
                if let Some(help) = remedy::turn(tree) {
                    let message = format!("`{}` turns about one axis", d.key());
                    d.push(Diagnostic::error(tree.span, message).help(help));
                    return Self::blank();
                }
                let AxisAngle { axis, degrees } = AxisAngle::read(tree, limit, d);
                Self { axis, degrees }
            }
            _ => {
                d.expected_or("an axis and an angle, such as `{ y: 30 }`", tree, remedy::turn(tree));
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        Self { axis: Axis::blank(), degrees: 0.0 }
    }
    fn write_to(&self, out: &mut dyn Writer) {
        AxisAngle { axis: self.axis, degrees: self.degrees }.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        let long = AxisAngle::schema(limit, defs);
        defs.refer("Rotation", |_| {
            let mut choices = schema::Choices::default();
            for (axis, docs) in [
                ("x", "About the x axis, in degrees."),
                ("y", "About the y axis, in degrees."),
                ("z", "About the z axis, in degrees."),
            ] {
                choices.payload(axis, &[docs], schema::number("number", limit), false);
            }
            choices.or(long, "About any axis.");
            choices.into_schema(&["A turn, counter-clockwise seen from the axis' tip."])
        })
    }
}

fn axis_of(name: &str) -> DVec3 {
    match name {
        "x" => DVec3::X,
        "y" => DVec3::Y,
        _ => DVec3::Z,
    }
}

/// The key under which a transform tells what it is at several times.
pub(crate) const MOTION: &str = "motion";

/// A motion is made of at most so many parts.
const MOST_TIMES: usize = 256;

impl Describe for Transform {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let before = d.diagnostics.errors();
        if let Some(times) = tree.entry(MOTION) {
            let Datum::Sequence(items) = &times.value.value else {
                d.expected("a list of transforms, the first at time 0 and the last at time 1", &times.value);
                return Self::default();
            };
            let is_of_a_node = d.is_within(&["world", "objects"])
                && !d.is_within(&[
                    "material",
                    "emission",
                    "mapping",
                    "moved",
                    "union",
                    "intersection",
                    "difference",
                ]);
            if !is_of_a_node {
                let message = "only what stands in the world moves while the shutter is open";
                let help = "`motion` is for the `transform` of shapes, groups and instances under `world:` and `objects:`";
                d.push(Diagnostic::error(times.key.span, message).help(help));
            }
            let mut all = items.iter().map(|item| Self::read(item, limit, d).steps);
            let (steps, later) = (all.next().unwrap_or_default(), all.collect::<Vec<_>>());
            if later.is_empty() || later.len() > MOST_TIMES {
                let message = format!("a motion has 2 to {} transforms, not {}", MOST_TIMES + 1, items.len());
                d.push(Diagnostic::error(times.value.span, message));
            }
            return Self { steps, later, span: tree.span };
        }
        let steps = match &tree.value {
            Datum::Null => Vec::new(),
            Datum::Sequence(items) => items.iter().map(|item| Step::read(item, limit, d)).collect(),
            // One step needs no list; several keys would leave the order to chance.
            Datum::Mapping(entries) if entries.len() <= 1 => {
                entries.first().map(|_| Step::read(tree, limit, d)).into_iter().collect()
            }
            Datum::Mapping(entries) => {
                if entries.iter().all(|e| !Step::KINDS.iter().any(|k| suggest::is_same(k, &e.key.value))) {
                    Step::read(tree, limit, d);
                    return Self::default();
                }
                let message = "the steps of a transform have an order, so they must be a list";
                d.push(
                    Diagnostic::error(entries[1].key.span, message)
                        .help("write each step as an item: `- translate: [1, 0, 0]`"),
                );
                Vec::new()
            }
            _ => {
                d.expected("a list of steps", tree);
                Vec::new()
            }
        };
        let transform = Self::of(steps, tree.span);
        let sound = || transform.affine().is_some_and(|a| straal_math::Transform::new(&a).is_some());
        if d.diagnostics.errors() == before && !sound() {
            let message =
                "this transform is singular: it flattens everything, or leaves the range of numbers";
            d.push(Diagnostic::error(tree.span, message).label("has no inverse"));
        }
        transform
    }
    fn blank() -> Self {
        Self::default()
    }
    fn write_to(&self, out: &mut dyn Writer) {
        if self.later.is_empty() {
            return self.steps.write_to(out);
        }
        out.begin_map();
        out.key(MOTION);
        out.begin_list();
        self.steps.write_to(out);
        self.later.iter().for_each(|steps| steps.write_to(out));
        out.end_list();
        out.end_map();
    }
    fn schema(_: Limit, defs: &mut Definitions) -> Json {
        let step = Step::schema(Limit::FINITE, defs);
        let steps = json!({ "anyOf": [{ "type": "array", "items": step }, step, { "type": "null" }] });
        let motion = json!({
            "description": "What it is while the shutter is open, at even times from 0 to 1.",
            "type": "object",
            "additionalProperties": false,
            "properties": { MOTION: { "type": "array", "items": steps, "minItems": 2 } },
            "required": [MOTION],
        });
        json!({ "anyOf": [{ "type": "array", "items": step }, step, motion, { "type": "null" }] })
    }
}
