//! Columns of numbers that vertices or faces of a file have besides where they are.

use straal_scene::mesh::{Attribute, Per};

use super::ply::header::{Kind, Property, Scalar};

/// How textures call colours.
pub const COLOUR: &str = "color";

/// Columns of a table while it is read.
pub struct Columns {
    attributes: Vec<Attribute>,
    /// The attribute and the channel of each property that is one's, and what its numbers are divided by.
    places: Vec<Option<(usize, usize, f32)>>,
    /// The numbers of the present record, by attribute.
    record: Vec<[f32; 4]>,
}

/// The names of red, green, blue and alpha of a colour, one way and others.
const COLOURS: [[&str; 4]; 3] = [
    ["red", "green", "blue", "alpha"],
    ["r", "g", "b", "a"],
    ["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"],
];

/// What the names of numbers end in that are an attribute together.
const PLACES: [[&str; 3]; 3] = [["_0", "_1", "_2"], ["_x", "_y", "_z"], ["_1", "_2", "_3"]];

/// The names of a further set of texture coordinates; the set's number comes behind them.
const COORDINATES: [[&str; 2]; 3] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]];

/// So many sets have names: `uv1` to `uv7`.
const SETS: std::ops::RangeInclusive<usize> = 1..=7;

impl Columns {
    /// Of the properties that are wanted, and free.
    pub(super) fn new(
        properties: &[Property],
        per: Per,
        wanted: &dyn Fn(&str) -> bool,
        free: impl Fn(usize) -> bool,
    ) -> Self {
        let mut columns =
            Self { attributes: Vec::new(), places: vec![None; properties.len()], record: Vec::new() };
        let scalar = |i: usize| match properties[i].kind {
            Kind::Scalar(scalar) if free(i) && !matches!(scalar, Scalar::Other(_)) => Some(scalar),
            _ => None,
        };
        let find =
            |name: &str| (0..properties.len()).find(|&i| properties[i].name == name && scalar(i).is_some());
        if wanted(COLOUR)
            && let Some([r, g, b, a]) = COLOURS
                .iter()
                .map(|names| names.map(find))
                .find(|[r, g, b, _]| r.is_some() && g.is_some() && b.is_some())
        {
            let all: Vec<usize> = [r, g, b, a].into_iter().flatten().collect();
            columns.add(COLOUR, per, &all, scalar);
        }
        for set in SETS {
            let name = format!("uv{set}");
            let pair = COORDINATES
                .iter()
                .find_map(|[u, v]| find(&format!("{u}{set}")).zip(find(&format!("{v}{set}"))));
            if let Some((u, v)) = pair.filter(|_| wanted(&name)) {
                columns.add(&name, per, &[u, v], scalar);
            }
        }
        // A further colour by its own name, as Mitsuba has it: `x_r`, `x_g`, `x_b` are `x_color`.
        for property in properties {
            let Some(stem) = property.name.strip_suffix("_r") else { continue };
            let [name, g, b] = ["color", "g", "b"].map(|end| format!("{stem}_{end}"));
            if wanted(&name)
                && let (Some(r), Some(g), Some(b)) = (find(&property.name), find(&g), find(&b))
            {
                columns.add(&name, per, &[r, g, b], scalar);
            }
        }
        // One number or three whose names end in a place, as Mitsuba writes them: `x_0`, `x_1`, `x_2` are `x`.
        for property in properties {
            for [first, second, third] in PLACES {
                let Some(stem) = property.name.strip_suffix(first) else { continue };
                let [at, b, c] = [first, second, third].map(|end| find(&format!("{stem}{end}")));
                // Not where each is wanted by itself.
                let is_taken = find(stem).is_some()
                    || wanted(&property.name)
                    || columns.attributes.iter().any(|a| a.name == stem);
                if let Some(a) = at.filter(|_| !is_taken && wanted(stem)) {
                    let rest = b.zip(c).map_or(Vec::new(), |(b, c)| vec![b, c]);
                    columns.add(stem, per, &[vec![a], rest].concat(), scalar);
                }
            }
        }
        for (i, property) in properties.iter().enumerate() {
            if columns.places[i].is_none()
                && scalar(i).is_some()
                && property.name != COLOUR
                && wanted(&property.name)
            {
                columns.add(&property.name, per, &[i], scalar);
            }
        }
        columns
    }

    fn add(&mut self, name: &str, per: Per, which: &[usize], scalar: impl Fn(usize) -> Option<Scalar>) {
        let most = |i: usize| match scalar(i) {
            Some(Scalar::U8) => 255.0,
            Some(Scalar::U16) => 65_535.0,
            _ => 1.0,
        };
        let is_code = which.iter().all(|&i| most(i) > 1.0);
        for (channel, &i) in which.iter().enumerate() {
            self.places[i] = Some((self.attributes.len(), channel, most(i)));
        }
        let channels = which.len();
        self.attributes.push(Attribute { name: name.to_owned(), per, channels, is_code, values: Vec::new() });
        self.record.push([0.0; 4]);
    }

    /// Whether a property is one of them.
    pub fn has(&self, property: usize) -> bool {
        self.places[property].is_some()
    }

    /// The number of a property in the present record; what is no number is 0.
    pub fn put(&mut self, property: usize, v: f32) {
        if let Some((attribute, channel, most)) = self.places[property] {
            self.record[attribute][channel] = if v.is_finite() { v / most } else { 0.0 };
        }
    }

    /// The record counts for so many vertices or triangles.
    pub fn end_record(&mut self, times: usize) {
        for (attribute, record) in self.attributes.iter_mut().zip(&self.record) {
            (0..times).for_each(|_| attribute.values.extend(&record[..attribute.channels]));
        }
    }

    /// What was read.
    pub fn finish(self) -> Vec<Attribute> {
        self.attributes
    }
}
