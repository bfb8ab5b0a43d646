//! What a layer of USD says: prims by their paths, with properties and with what is to be composed into them.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::crate_file::{File, Rep};

/// Prims are within one another so deep at most.
pub(super) const DEEPEST: usize = 128;

/// The longest path, in bytes.
pub(super) const LONGEST: usize = 4096;

/// A value, as far as anything here asks for values of its kind.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// One or more numbers, vectors, matrices or quaternions.
    Numbers(Numbers),
    /// A string, a token, a path or the name of an asset.
    Text(String),
    /// A list of these.
    Texts(Vec<String>),
    /// What stands in a binary file, and is read where it is asked for.
    Packed(Rep),
    /// No value, whatever weaker layers say.
    Blocked,
    /// Dictionaries, splines and the like.
    Other,
}

/// Numbers, so many of each thing.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Numbers {
    pub width: usize,
    pub values: Rc<[f64]>,
    pub kind: Kind,
}

/// What lies between the numbers of two times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A straight line.
    Real,
    /// Nothing: the first holds.
    Whole,
    /// A turn: the quaternion x, y, z, w.
    Turn,
}

impl Value {
    /// One number, or a list of them.
    pub fn numbers(width: usize, values: Vec<f64>, kind: Kind) -> Self {
        Self::Numbers(Numbers { width, values: values.into(), kind })
    }
}

/// What a layer does to a list of weaker ones.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Edits<T> {
    /// All of it, in place of what there was.
    pub explicit: Option<Vec<T>>,
    pub prepended: Vec<T>,
    pub appended: Vec<T>,
    pub deleted: Vec<T>,
}

impl<T> Default for Edits<T> {
    fn default() -> Self {
        Self { explicit: None, prepended: Vec::new(), appended: Vec::new(), deleted: Vec::new() }
    }
}

/// How a list is edited, by the word before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edit {
    Set,
    Prepend,
    Append,
    Delete,
    Reorder,
}

impl<T: Clone + PartialEq> Edits<T> {
    /// Takes note of an edit.
    pub fn add(&mut self, edit: Edit, items: Vec<T>) {
        match edit {
            Edit::Set => self.explicit = Some(items),
            Edit::Prepend => self.prepended.extend(items),
            Edit::Append => self.appended.extend(items),
            Edit::Delete => self.deleted.extend(items),
            // In which order they come changes no picture that the rest doesn't decide.
            Edit::Reorder => {}
        }
    }

    /// The list after the edits.
    pub fn apply(&self, weaker: Vec<T>) -> Vec<T> {
        if let Some(all) = &self.explicit {
            return all.clone();
        }
        let edited = |item: &T| {
            self.prepended.contains(item) || self.appended.contains(item) || self.deleted.contains(item)
        };
        let rest = weaker.into_iter().filter(|item| !edited(item));
        self.prepended.iter().cloned().chain(rest).chain(self.appended.iter().cloned()).collect()
    }
}

/// From the time of a stronger layer to that of a weaker one: `scale` * t + `offset` is the stronger one's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Offset {
    pub offset: f64,
    pub scale: f64,
}

impl Default for Offset {
    fn default() -> Self {
        Self { offset: 0.0, scale: 1.0 }
    }
}

impl Offset {
    /// The weaker one's time.
    pub fn inside(&self, time: f64) -> f64 {
        let t = (time - self.offset) / self.scale;
        if t.is_finite() { t } else { time }
    }

    /// This one, around another.
    pub fn around(&self, inner: &Self) -> Self {
        Self { offset: self.scale * inner.offset + self.offset, scale: self.scale * inner.scale }
    }
}

/// Another prim whose opinions are taken over.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Reference {
    /// The file; empty for the same one.
    pub asset: String,
    /// The prim; empty for the file's default.
    pub path: String,
    pub offset: Offset,
}

/// How firmly a prim is there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Specifier {
    /// It is.
    Def,
    /// Only if another layer says so.
    #[default]
    Over,
    /// For others to inherit.
    Class,
}

/// An attribute or a relationship.
#[derive(Clone, Debug, Default)]
pub(super) struct Property {
    /// At all times, where there are no samples.
    pub value: Option<Value>,
    /// By rising time.
    pub samples: Vec<(f64, Value)>,
    /// What a relationship leads to, or an attribute is connected with.
    pub targets: Edits<String>,
    /// What of a mesh has one of its values each.
    pub interpolation: Option<String>,
    /// How the colours of a picture are meant.
    pub color_space: Option<String>,
    /// Of a shape between a blend shape and none, at which weight it stands.
    pub weight: Option<f64>,
    /// Whether a binding of a material counts rather than those of prims in the one that has it.
    pub is_strong: bool,
}

/// What one layer says of one prim.
#[derive(Clone, Debug, Default)]
pub(super) struct Spec {
    pub specifier: Specifier,
    pub type_name: String,
    pub active: Option<bool>,
    pub instanceable: Option<bool>,
    pub properties: BTreeMap<String, Property>,
    /// The names of the prims in it.
    pub children: Vec<String>,
    pub references: Edits<Reference>,
    pub payloads: Edits<Reference>,
    pub inherits: Edits<String>,
    pub specializes: Edits<String>,
    pub variant_sets: Edits<String>,
    pub selections: BTreeMap<String, String>,
    pub schemas: Edits<String>,
    /// Whether values come of files for each time.
    pub has_clips: bool,
}

/// A file of prims. Those of variants have paths such as `/Chair{colour=red}Seat`.
#[derive(Debug, Default)]
pub(super) struct Layer {
    pub prims: BTreeMap<String, Spec>,
    pub sub_layers: Vec<(String, Offset)>,
    pub about: About,
    /// Where its values are, if it is binary.
    pub file: Option<File>,
}

/// What a layer says of itself.
#[derive(Clone, Debug, Default)]
pub(super) struct About {
    pub default_prim: String,
    pub up_axis: Option<String>,
    pub meters_per_unit: Option<f64>,
    pub times_per_second: Option<f64>,
    pub start: Option<f64>,
    pub end: Option<f64>,
    pub settings: Option<String>,
}

impl Layer {
    /// Takes a value that the layer says of itself.
    pub fn say(&mut self, key: &str, value: &Value) {
        let number = || match value {
            Value::Numbers(Numbers { values, .. }) => values.first().copied().filter(|v| v.is_finite()),
            _ => None,
        };
        let text = || if let Value::Text(text) = value { Some(text.clone()) } else { None };
        match key {
            "defaultPrim" => self.about.default_prim = text().unwrap_or_default(),
            "upAxis" => self.about.up_axis = text(),
            "metersPerUnit" => self.about.meters_per_unit = number().filter(|v| *v > 0.0),
            "timeCodesPerSecond" => self.about.times_per_second = number().filter(|v| *v > 0.0),
            "framesPerSecond" if self.about.times_per_second.is_none() => {
                self.about.times_per_second = number().filter(|v| *v > 0.0);
            }
            "startTimeCode" => self.about.start = number(),
            "endTimeCode" => self.about.end = number(),
            "renderSettingsPrimPath" => self.about.settings = text(),
            _ => {}
        }
    }
}

impl Spec {
    /// Takes a value that is said of the prim.
    pub fn say(&mut self, key: &str, value: &Value) {
        let flag = || match value {
            Value::Numbers(Numbers { values, .. }) => values.first().map(|v| *v != 0.0),
            _ => None,
        };
        match key {
            "active" => self.active = flag(),
            "instanceable" => self.instanceable = flag(),
            "clips" => self.has_clips = true,
            _ => {}
        }
    }
}

/// The path of a prim in another: after a variant there is no slash.
pub(super) fn join(parent: &str, name: &str) -> String {
    if parent == "/" || parent.ends_with('}') {
        format!("{parent}{name}")
    } else {
        format!("{parent}/{name}")
    }
}

/// A path without the variants that it leads through.
pub(super) fn plain(path: &str) -> String {
    let mut out = String::with_capacity(path.len());
    let mut rest = path;
    while let Some((before, behind)) = rest.split_once('{') {
        out.push_str(before);
        rest = behind.split_once('}').map_or("", |(_, behind)| behind);
        if !rest.is_empty() && !rest.starts_with(['/', '.', '{']) {
            out.push('/');
        }
    }
    out + rest
}

/// Where a path leads that is written at a prim: it may begin with `..`, and may name a property.
pub(super) fn absolute(at: &str, path: &str) -> String {
    if path.starts_with('/') {
        return plain(path);
    }
    let mut here = plain(at);
    let mut rest = path;
    loop {
        if let Some(behind) = rest.strip_prefix("..") {
            let cut = here.rfind('/').unwrap_or(0);
            here.truncate(cut);
            rest = behind.strip_prefix('/').unwrap_or(behind);
        } else if let Some(behind) = rest.strip_prefix("./") {
            rest = behind;
        } else {
            break;
        }
    }
    let here = if here.is_empty() { "/" } else { &here };
    match rest {
        "" | "." => here.to_owned(),
        property if property.starts_with('.') => format!("{here}{property}"),
        name => plain(&join(here, name)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_edited_by_stronger_layers() {
        let names = |list: &[&str]| list.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>();
        let mut edits = Edits::default();
        edits.add(Edit::Prepend, names(&["a"]));
        edits.add(Edit::Append, names(&["z"]));
        edits.add(Edit::Delete, names(&["m"]));
        assert_eq!(edits.apply(names(&["m", "n", "a"])), names(&["a", "n", "z"]));
        edits.add(Edit::Set, names(&["q"]));
        assert_eq!(edits.apply(names(&["m"])), names(&["q"]));
    }

    #[test]
    fn paths_lead_on_from_prims_and_forget_variants() {
        assert_eq!(plain("/A{v=x}B/C{w=y}"), "/A/B/C");
        assert_eq!(plain("/A{v=x}.p"), "/A.p");
        assert_eq!(absolute("/A/B", "../C.x"), "/A/C.x");
        assert_eq!(absolute("/A/B", "../../C"), "/C");
        assert_eq!(absolute("/A/B", ".x"), "/A/B.x");
        assert_eq!(absolute("/A{v=x}B", "C"), "/A/B/C");
        assert_eq!(join("/A{v=x}", "B"), "/A{v=x}B");
    }

    #[test]
    fn times_go_through_offsets() {
        let outer = Offset { offset: 10.0, scale: 2.0 };
        let inner = Offset { offset: 1.0, scale: 0.5 };
        let both = outer.around(&inner);
        assert_eq!(both.inside(20.0), inner.inside(outer.inside(20.0)));
    }
}
