//! The composed stage: what all layers together say of each prim.
//!
//! A prim has sources, strongest first: the layers of its own file, then what it inherits, its variants, references, payloads and what
//! it specializes (LIVRPS), each with the same again. Those of a prim in another are its parent's, a step further.

use std::collections::BTreeMap;
use std::rc::Rc;

use straal_scene::{Diagnostic, Span, suggest};

use super::layer::{
    DEEPEST, Edits, Kind, LONGEST, Numbers, Offset, Property, Reference, Spec, Specifier, Value, absolute,
    join, plain,
};
use super::library::Library;

/// From paths of one file or prim to those of the stage.
#[derive(Debug)]
struct Map {
    from: String,
    to: String,
    /// Whether paths outside of `from` stay as they are, as within one file.
    keeps: bool,
    outer: Option<Rc<Self>>,
}

/// Where opinions on a prim come from: a stack of layers, a path in it, and how that leads to the stage.
#[derive(Clone, Debug)]
struct Node {
    stack: usize,
    path: String,
    map: Option<Rc<Map>>,
    offset: Offset,
    /// Whether the prim itself brings it in, rather than one that it is in.
    is_own: bool,
}

/// What one layer says of a prim.
#[derive(Clone, Debug)]
struct Source {
    layer: usize,
    path: String,
    map: Option<Rc<Map>>,
    offset: Offset,
}

/// A prim of the stage.
#[derive(Debug, Default)]
pub(super) struct Prim {
    pub path: String,
    pub name: String,
    pub type_name: String,
    pub parent: Option<usize>,
    pub children: Vec<usize>,
    /// Of instances that share what is in them, the first.
    pub prototype: Option<usize>,
    /// Whether what is in it is shared.
    pub is_instance: bool,
    /// Whether it is there, rather than for others to inherit.
    pub is_defined: bool,
    pub schemas: Vec<String>,
    sources: Vec<Source>,
}

/// All prims, the root first.
pub(super) struct Stage<'m, 'a> {
    pub library: Library<'m, 'a>,
    pub prims: Vec<Prim>,
    pub places: BTreeMap<String, usize>,
    prototypes: BTreeMap<Vec<(usize, String)>, usize>,
    /// How many more sources may be made: files of a few lines can ask for endless ones.
    room: usize,
    is_full: bool,
    /// The time that is shown.
    pub time: f64,
}

impl<'m, 'a> Stage<'m, 'a> {
    /// Composes all that the first layer of a library leads to; nothing after a complaint.
    pub fn of(mut library: Library<'m, 'a>) -> Self {
        let stack = library.stack(0);
        let specs: usize = library.layers.iter().map(|held| held.layer.prims.len()).sum();
        let room = 200_000 + specs.saturating_mul(1000).min(8_000_000);
        let mut stage = Self {
            library,
            prims: Vec::new(),
            places: BTreeMap::new(),
            prototypes: BTreeMap::new(),
            room,
            is_full: false,
            time: 0.0,
        };
        let root = Node { stack, path: "/".to_owned(), map: None, offset: Offset::default(), is_own: false };
        stage.build(None, "", vec![root], 0);
        if stage.is_full {
            stage.fail("the scene refers to itself too often: it would have too many prims".to_owned());
        }
        stage
    }

    fn fail(&mut self, message: String) {
        self.library.means.d.push(Diagnostic::error(Span::NONE, message));
    }

    fn spec(&self, layer: usize, path: &str) -> Option<&Spec> {
        self.library.layers[layer].layer.prims.get(path)
    }

    /// Makes a prim of its nodes, and all that is in it.
    fn build(&mut self, parent: Option<usize>, name: &str, mut nodes: Vec<Node>, depth: usize) {
        let path = parent.map_or("/".to_owned(), |parent| join(&self.prims[parent].path, name));
        let mut sources = Vec::new();
        for node in &nodes {
            for &(layer, offset) in &self.library.stacks[node.stack] {
                if self.spec(layer, &node.path).is_some() {
                    let offset = node.offset.around(&offset);
                    let (path, map) = (node.path.clone(), node.map.clone());
                    sources.push(Source { layer, path, map, offset });
                }
            }
        }
        let cost = 1 + sources.len() + nodes.len();
        if self.room < cost || depth > DEEPEST || path.len() > LONGEST {
            self.is_full = true;
            return;
        }
        self.room -= cost;
        let (mut prim, mut names) = (Prim { name: name.to_owned(), parent, ..Prim::default() }, Vec::new());
        let (mut specifier, mut active, mut shared, mut has_clips) = (Specifier::Over, None, None, false);
        for source in sources.iter().rev() {
            let Some(spec) = self.spec(source.layer, &source.path) else { continue };
            specifier = if spec.specifier == Specifier::Over { specifier } else { spec.specifier };
            if !spec.type_name.is_empty() {
                prim.type_name.clone_from(&spec.type_name);
            }
            (active, shared) = (spec.active.or(active), spec.instanceable.or(shared));
            has_clips |= spec.has_clips;
            prim.schemas = spec.schemas.apply(std::mem::take(&mut prim.schemas));
        }
        if active == Some(false) {
            return;
        }
        if has_clips {
            let message = format!("`{path}`: values of clips are left out");
            self.library.means.d.push(Diagnostic::warning(Span::NONE, message));
        }
        prim.is_defined = parent.is_none()
            || specifier == Specifier::Def && parent.is_some_and(|parent| self.prims[parent].is_defined);
        prim.sources = sources;
        prim.path.clone_from(&path);
        let index = self.prims.len();
        let is_shared = shared == Some(true) && nodes.iter().any(|node| node.is_own) && prim.is_defined;
        prim.is_instance = is_shared;
        self.prims.push(prim);
        self.places.insert(path, index);
        if let Some(parent) = parent {
            self.prims[parent].children.push(index);
        }
        if is_shared {
            // What is said of the prims in an instance by its own file doesn't count.
            nodes.retain(|node| node.is_own);
            let key = nodes.iter().map(|node| (node.stack, node.path.clone())).collect();
            match self.prototypes.get(&key) {
                Some(first) => {
                    self.prims[index].prototype = Some(*first);
                    return;
                }
                None => drop(self.prototypes.insert(key, index)),
            }
        }
        // Stronger layers add names behind those of weaker ones.
        let mut known = std::collections::BTreeSet::new();
        for node in nodes.iter().rev() {
            for &(layer, _) in self.library.stacks[node.stack].iter().rev() {
                let Some(spec) = self.spec(layer, &node.path) else { continue };
                for child in &spec.children {
                    if known.insert(child.clone()) {
                        names.push(child.clone());
                    }
                }
            }
        }
        for name in names {
            if self.is_full {
                return;
            }
            let steps = nodes.iter().map(|node| Node {
                path: join(&node.path, &name),
                is_own: false,
                ..node.clone()
            });
            let inside = self.with_arcs(steps.collect());
            self.build(Some(index), &name, inside, depth + 1);
        }
    }

    /// Nodes with all that they bring in. Those of which nobody says anything are left out.
    fn with_arcs(&mut self, steps: Vec<Node>) -> Vec<Node> {
        let mut out = Vec::new();
        for node in steps {
            self.expand(node, &mut Vec::new(), &mut out);
        }
        out
    }

    /// A node, and then what it inherits, its variants, references, payloads and what it specializes.
    fn expand(&mut self, node: Node, within: &mut Vec<(usize, String)>, out: &mut Vec<Node>) {
        let stack = self.library.stacks[node.stack].clone();
        let said: Vec<(usize, Offset)> =
            stack.into_iter().filter(|(layer, _)| self.spec(*layer, &node.path).is_some()).collect();
        if said.is_empty() {
            return;
        }
        let here = (node.stack, node.path.clone());
        let cost = 4 + said.len();
        if within.contains(&here) || within.len() > 64 || self.room < cost {
            self.is_full |= self.room < cost;
            return;
        }
        self.room -= cost;
        within.push(here);
        out.push(node.clone());
        let lists = |of: fn(&Spec) -> &Edits<String>, stage: &Self| {
            let specs = said.iter().rev().filter_map(|(layer, _)| stage.spec(*layer, &node.path));
            specs.fold(Vec::new(), |list, spec| of(spec).apply(list))
        };
        for target in lists(|spec| &spec.inherits, self) {
            self.class(&node, target, within, out);
        }
        for set in lists(|spec| &spec.variant_sets, self) {
            let chosen = out.iter().find_map(|node| {
                let layers = &self.library.stacks[node.stack];
                layers.iter().find_map(|(layer, _)| self.spec(*layer, &node.path)?.selections.get(&set))
            });
            let Some(chosen) = chosen else { continue };
            let path = format!("{}{{{set}={chosen}}}", node.path);
            let next = Node { path, is_own: true, ..node.clone() };
            self.expand(next, within, out);
        }
        let lists_of: [fn(&Spec) -> &Edits<Reference>; 2] = [|spec| &spec.references, |spec| &spec.payloads];
        for of in lists_of {
            // Each with the layer that says it, from which its name of a file goes.
            let mut list: Vec<(usize, Offset, Reference)> = Vec::new();
            for &(layer, offset) in said.iter().rev() {
                let Some(spec) = self.spec(layer, &node.path) else { continue };
                let before: Vec<Reference> = list.iter().map(|(_, _, reference)| reference.clone()).collect();
                let after = of(spec).apply(before);
                let known = std::mem::take(&mut list);
                let found = |reference: Reference| {
                    let own = of(spec);
                    let is_own = [own.explicit.as_deref().unwrap_or(&[]), &own.prepended, &own.appended]
                        .iter()
                        .any(|list| list.contains(&reference));
                    let old = known.iter().find(|(_, _, known)| *known == reference);
                    let (layer, offset) = match old {
                        Some((layer, offset, _)) if !is_own => (*layer, *offset),
                        _ => (layer, offset),
                    };
                    (layer, offset, reference)
                };
                list = after.into_iter().map(found).collect();
            }
            for (layer, offset, reference) in list {
                self.reference(&node, (layer, offset), reference, within, out);
            }
        }
        for target in lists(|spec| &spec.specializes, self) {
            self.class(&node, target, within, out);
        }
        within.pop();
    }

    /// What a prim of the same file brings in, as a class.
    fn class(&mut self, node: &Node, target: String, within: &mut Vec<(usize, String)>, out: &mut Vec<Node>) {
        let target = absolute(&node.path, &target);
        let map = Map { from: target.clone(), to: plain(&node.path), keeps: true, outer: node.map.clone() };
        let next = Node { path: target, map: Some(Rc::new(map)), is_own: true, ..node.clone() };
        self.bring(node, next, within, out);
    }

    fn reference(
        &mut self,
        node: &Node,
        (layer, inner): (usize, Offset),
        reference: Reference,
        within: &mut Vec<(usize, String)>,
        out: &mut Vec<Node>,
    ) {
        let Reference { asset, mut path, offset } = reference;
        let is_same = asset.is_empty();
        let stack = if is_same {
            node.stack
        } else {
            let Some(layer) = self.library.layer(layer, &asset) else { return };
            self.library.stack(layer)
        };
        if path.is_empty() {
            let Some(&(root, _)) = self.library.stacks[stack].first() else { return };
            let named = &self.library.layers[root].layer.about.default_prim;
            if named.is_empty() {
                let message = format!(
                    "`{}` refers to `{}`, which has no default prim: it is left out",
                    suggest::brief(&node.path),
                    suggest::brief(&asset)
                );
                self.library.means.d.push(Diagnostic::warning(Span::NONE, message));
                return;
            }
            path = absolute("/", named);
        }
        let map = Map { from: path.clone(), to: plain(&node.path), keeps: is_same, outer: node.map.clone() };
        let offset = node.offset.around(&inner).around(&offset);
        let next = Node { stack, path, map: Some(Rc::new(map)), offset, is_own: true };
        self.bring(node, next, within, out);
    }

    /// Takes in a node that may lie within others, which may bring in more of it.
    fn bring(&mut self, node: &Node, next: Node, within: &mut Vec<(usize, String)>, out: &mut Vec<Node>) {
        let is_around = |outer: &str| {
            outer == "/" || node.path.strip_prefix(outer).is_some_and(|p| p.starts_with(['/', '{']))
        };
        if next.stack == node.stack && is_around(&next.path) {
            let message =
                format!("`{}` refers to what it is in itself: it is left out", suggest::brief(&node.path));
            self.library.means.d.push(Diagnostic::warning(Span::NONE, message));
            return;
        }
        let before = out.len();
        let steps: Vec<&str> = next.path.split('/').filter(|s| !s.is_empty()).collect();
        if let [above @ .., _] = steps.as_slice()
            && !above.is_empty()
        {
            let mut nodes = vec![Node { path: "/".to_owned(), ..next.clone() }];
            for step in &steps {
                let inside = nodes.iter().map(|node| Node { path: join(&node.path, step), ..node.clone() });
                let inside: Vec<Node> = inside.collect();
                nodes = Vec::new();
                for node in inside {
                    self.expand(node, within, &mut nodes);
                }
            }
            out.extend(nodes);
        } else {
            self.expand(next, within, out);
        }
        out[before..].iter_mut().for_each(|node| node.is_own = true);
    }
}

impl Map {
    /// A path of the inner one, in the stage.
    fn out(map: Option<&Rc<Self>>, path: &str) -> Option<String> {
        let Some(map) = map else { return Some(path.to_owned()) };
        let rest = path.strip_prefix(map.from.as_str()).filter(|r| r.is_empty() || r.starts_with(['/', '.']));
        let moved = match rest {
            Some(rest) => format!("{}{rest}", map.to),
            None if map.keeps => path.to_owned(),
            None => return None,
        };
        Self::out(map.outer.as_ref(), &moved).filter(|path| path.len() <= 2 * LONGEST)
    }
}

/// Asking prims for their properties.
impl Stage<'_, '_> {
    /// What each layer says of a property, strongest first.
    fn opinions(&self, prim: usize, name: &str) -> impl Iterator<Item = (&Source, &Property)> {
        let sources = self.prims[prim].sources.iter();
        let name = name.to_owned();
        sources.filter_map(move |source| {
            Some((source, self.spec(source.layer, &source.path)?.properties.get(&name)?))
        })
    }

    /// A value at the time that is shown.
    pub fn value(&self, prim: usize, name: &str) -> Option<Value> {
        self.value_at(prim, name, self.time)
    }

    /// A value at any time.
    pub fn value_at(&self, prim: usize, name: &str, time: f64) -> Option<Value> {
        for (source, property) in self.opinions(prim, name) {
            let layer = &self.library.layers[source.layer].layer;
            let read = |value: &Value| match (value, &layer.file) {
                (Value::Packed(rep), Some(file)) => file.value(*rep).unwrap_or(Value::Other),
                (value, _) => value.clone(),
            };
            let found = if property.samples.is_empty() {
                property.value.as_ref().map(read)
            } else {
                Some(between(&property.samples, source.offset.inside(time), read))
            };
            match found {
                None => {}
                Some(Value::Blocked) => return None,
                found => return found,
            }
        }
        None
    }

    /// Which layer says a value, from which names of files go.
    pub fn layer_of(&self, prim: usize, name: &str) -> usize {
        let says = |p: &Property| p.value.is_some() || !p.samples.is_empty();
        self.opinions(prim, name).find(|(_, property)| says(property)).map_or(0, |(source, _)| source.layer)
    }

    /// The numbers of a value, `width` each; none where there is no such value.
    pub fn numbers(&self, prim: usize, name: &str, width: usize) -> Option<Rc<[f64]>> {
        match self.value(prim, name)? {
            Value::Numbers(Numbers { values, width: has, .. }) if has == width || values.is_empty() => {
                Some(values)
            }
            _ => None,
        }
    }

    /// The one number of a value.
    pub fn number(&self, prim: usize, name: &str) -> Option<f64> {
        self.numbers(prim, name, 1)?.first().copied().filter(|v| v.is_finite())
    }

    /// A vector.
    pub fn vector<const N: usize>(&self, prim: usize, name: &str) -> Option<[f64; N]> {
        let values = self.numbers(prim, name, N)?;
        let first = *values.first_chunk::<N>()?;
        first.iter().all(|v| v.is_finite()).then_some(first)
    }

    /// A word.
    pub fn text(&self, prim: usize, name: &str) -> Option<String> {
        match self.value(prim, name)? {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// A list of words.
    pub fn texts(&self, prim: usize, name: &str) -> Vec<String> {
        match self.value(prim, name) {
            Some(Value::Texts(texts)) => texts,
            _ => Vec::new(),
        }
    }

    /// What of a mesh has one each of a primvar's values.
    pub fn interpolation(&self, prim: usize, name: &str) -> Option<&str> {
        self.opinions(prim, name).find_map(|(_, property)| property.interpolation.as_deref())
    }

    /// How the colours of an asset are meant.
    pub fn color_space(&self, prim: usize, name: &str) -> Option<&str> {
        self.opinions(prim, name).find_map(|(_, property)| property.color_space.as_deref())
    }

    /// At which weight of its blend shape a shape stands that lies between it and none.
    pub fn weight(&self, prim: usize, name: &str) -> Option<f64> {
        self.opinions(prim, name).find_map(|(_, property)| property.weight)
    }

    /// What a relationship or a connection leads to.
    pub fn targets(&self, prim: usize, name: &str) -> Vec<String> {
        let opinions: Vec<_> = self.opinions(prim, name).collect();
        opinions.into_iter().rev().fold(Vec::new(), |list, (source, property)| {
            let mapped = |list: &Vec<String>| {
                list.iter().filter_map(|path| Map::out(source.map.as_ref(), path)).collect::<Vec<_>>()
            };
            let edits = &property.targets;
            Edits {
                explicit: edits.explicit.as_ref().map(mapped),
                prepended: mapped(&edits.prepended),
                appended: mapped(&edits.appended),
                deleted: mapped(&edits.deleted),
            }
            .apply(list)
        })
    }

    /// Whether the strongest layer that says something of a binding has it count rather than those further in.
    pub fn is_strong(&self, prim: usize, name: &str) -> bool {
        self.opinions(prim, name).next().is_some_and(|(_, property)| property.is_strong)
    }

    /// Whether any of a prim's properties has a value, samples or targets.
    pub fn has(&self, prim: usize, name: &str) -> bool {
        self.value(prim, name).is_some()
    }

    /// Names of a prim's properties that begin so.
    pub fn names(&self, prim: usize, prefix: &str) -> Vec<String> {
        let mut found = std::collections::BTreeSet::new();
        for source in &self.prims[prim].sources {
            let Some(spec) = self.spec(source.layer, &source.path) else { continue };
            let from = spec.properties.range(prefix.to_owned()..);
            found.extend(from.map(|(name, _)| name).take_while(|name| name.starts_with(prefix)).cloned());
        }
        found.into_iter().collect()
    }
}

/// The value at a time: before the first sample that of the first, behind the last that of the last.
fn between(samples: &[(f64, Value)], time: f64, read: impl Fn(&Value) -> Value) -> Value {
    let next = samples.partition_point(|(t, _)| *t <= time);
    let Some((from, first)) = samples.get(next.saturating_sub(1)) else { return Value::Blocked };
    let first = read(first);
    let (Some((to, second)), true) = (samples.get(next), next > 0) else { return first };
    let t = (time - from) / (to - from);
    let Value::Numbers(a) = &first else { return first };
    if t == 0.0 || a.kind == Kind::Whole {
        return first;
    }
    match read(second) {
        Value::Numbers(b) if b.width == a.width && b.values.len() == a.values.len() => {
            let values = if a.kind == Kind::Turn && a.width == 4 {
                let pairs = a.values.chunks_exact(4).zip(b.values.chunks_exact(4));
                pairs.flat_map(|(a, b)| super::super::gltf::slerp(a, b, t)).collect()
            } else {
                a.values.iter().zip(b.values.iter()).map(|(a, b)| a + (b - a) * t).collect()
            };
            Value::numbers(a.width, values, a.kind)
        }
        _ => first,
    }
}
