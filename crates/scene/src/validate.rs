//! What the parts of a whole scene must be to each other: names that lead somewhere, and trees that end.

use straal_color::spectrum::TabulatedSpectrum;
use straal_math::{Affine, Transform as Rounded};

use crate::alias::{self, Here};
use crate::css;
use crate::decode::Describe;
use crate::desc::{
    Environment, Group, Light, MOST_LIGHT_GROUPS, MOST_LINKED, Material, MaterialRef, Measured, Node, Scene,
    Spectrum, Transform,
};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::handle::Handle;
use crate::limit::Limit;
use crate::link::Places;
use crate::span::Span;
use crate::suggest;
use crate::value::{Asset, LinearRgb, Link, Name};
use crate::{Image, Mesh, Photometry, materials, textures};

/// Most instances inside one another.
pub const DEEPEST: usize = 8;

/// Complains of names that lead nowhere, objects that contain themselves or nest too deep, and placements that have no
/// inverse together.
pub fn validate(scene: &Scene, d: &mut Diagnostics) {
    let mut walk = Walk { scene, d };
    for node in scene.objects.iter().map(|(_, object)| object).chain(&scene.world) {
        walk.names(node);
        walk.placement(node, &Affine::IDENTITY);
    }
    for part in scene.materials.iter().flat_map(|(_, material)| material.parts()) {
        part.names(&mut |link, _| walk.material(link));
    }
    materials::validate(scene, walk.d);
    walk.nesting();
    walk.focus();
    walk.light_groups();
    walk.linked();
    textures::validate(scene, d);
}

impl Node {
    /// Where the node is placed.
    pub fn transform(&self) -> &Transform {
        static NOWHERE: Transform = Transform { steps: Vec::new(), later: Vec::new(), span: Span::NONE };
        match self {
            Self::Group(g) => &g.transform,
            Self::Instance(i) => &i.transform,
            Self::Instances(i) => &i.transform,
            _ => self.surface().map_or(&NOWHERE, |s| &s.transform),
        }
    }

    /// The node's own material.
    pub fn material(&self) -> Option<&MaterialRef> {
        match self {
            Self::Group(g) => g.material.as_ref(),
            Self::Instance(i) => i.material.as_ref(),
            Self::Instances(i) => i.material.as_ref(),
            _ => self.surface().and_then(|s| s.material.as_ref()),
        }
    }

    /// What a camera may call it.
    pub fn name(&self) -> Option<&Name> {
        match self {
            Self::Group(g) => g.name.as_ref(),
            Self::Instance(i) => i.name.as_ref(),
            Self::Instances(i) => i.name.as_ref(),
            _ => self.surface().and_then(|s| s.name.as_ref()),
        }
    }

    /// Whether a camera that is focused on `name` is focused on this: it goes by its own name, or by its object's.
    pub fn goes_by(&self, name: &str) -> bool {
        let own = self.name().is_some_and(|n| n.value == name);
        own || self.object().is_some_and(|of| of.name.value == name)
    }

    /// The object that it shows, if it is made of instances.
    pub const fn object(&self) -> Option<&Link<Self>> {
        match self {
            Self::Instance(i) => Some(&i.of),
            Self::Instances(i) => Some(&i.of),
            _ => None,
        }
    }

    /// The nodes directly inside.
    pub fn children(&self) -> &[Node] {
        match self {
            Self::Group(Group { children, .. }) => children,
            Self::Union(c) | Self::Intersection(c) | Self::Difference(c) => &c.of,
            _ => &[],
        }
    }

    /// The same, to be changed.
    pub fn children_mut(&mut self) -> &mut [Self] {
        match self {
            Self::Group(Group { children, .. }) => children,
            Self::Union(c) | Self::Intersection(c) | Self::Difference(c) => &mut c.of,
            _ => &mut [],
        }
    }

    /// Calls `f` with this node and all inside it, parents first. Instances are not followed.
    pub fn visit<'a>(&'a self, f: &mut impl FnMut(&'a Node)) {
        f(self);
        for child in self.children() {
            child.visit(f);
        }
    }
}

impl Scene {
    /// What stands at the top of the world: its nodes, or, where all of it is one group, the nodes of that.
    pub fn top_level(&self) -> &[Node] {
        let mut nodes = self.world.as_slice();
        while let [Node::Group(Group { children, transform, .. })] = nodes
            && transform.later.is_empty()
        {
            nodes = children;
        }
        nodes
    }

    /// Finds out where all names of objects, materials and textures lead. Whoever reads a scene has done so; a program that makes or
    /// changes one does it when that is done.
    pub fn link(&mut self) {
        let places = Places::of(self);
        self.lead(&places);
    }

    /// Calls `f` with every node of the world and of the objects, once each.
    pub fn visit<'a>(&'a self, mut f: impl FnMut(&'a Node)) {
        for node in self.objects.iter().map(|(_, node)| node).chain(&self.world) {
            node.visit(&mut f);
        }
    }

    /// The mesh files that are named, with repetitions.
    pub fn mesh_files(&self) -> Vec<&Asset<Mesh>> {
        let mut files = Vec::new();
        self.visit(|node| {
            if let Node::Mesh(m) = node {
                files.extend(&m.file);
            }
        });
        files
    }

    /// The files of spectra that are named, with repetitions.
    pub fn spectrum_files(&self) -> Vec<&Asset<TabulatedSpectrum>> {
        self.spectra_of_files().into_iter().map(|(file, _)| file).collect()
    }

    /// The spectra that are in files, and these.
    pub(crate) fn spectra_of_files(&self) -> Vec<(&Asset<TabulatedSpectrum>, &Measured)> {
        self.spectra().into_iter().filter_map(|(spectrum, _)| spectrum.in_file()).collect()
    }

    /// The colours that are parts of the light that arrives.
    pub(crate) fn reflectances(&self) -> Vec<&Spectrum> {
        self.spectra().into_iter().filter(|(_, limit)| *limit == Limit::UNIT).map(|(s, _)| s).collect()
    }

    /// The files of measured lamps that are named, with repetitions.
    pub fn photometry_files(&self) -> Vec<&Asset<Photometry>> {
        let lamps = self.lights.iter().filter_map(|l| match l {
            Light::Goniometric(lamp) => Some(&lamp.file),
            _ => None,
        });
        lamps.collect()
    }

    /// The picture files that are named, with repetitions.
    pub fn image_files(&self) -> Vec<&Asset<Image>> {
        let environments = self.lights.iter().filter_map(|l| match l {
            Light::Environment(Environment { file, .. }) => file.as_ref(),
            _ => None,
        });
        environments.collect()
    }
}

struct Walk<'a> {
    scene: &'a Scene,
    d: &'a mut Diagnostics,
}

/// An instance inside an object or the world: which object it shows, and where it says so.
#[derive(Clone, Copy)]
struct Edge {
    to: Handle<Node>,
    span: Span,
}

/// How far the walk over an object has come.
#[derive(Clone, Copy, PartialEq)]
enum State {
    Unseen,
    Open,
    /// So many instances inside one another.
    Known(usize),
}

impl<'a> Walk<'a> {
    /// Every material and object that is named must exist.
    fn names(&mut self, node: &Node) {
        node.visit(&mut |n| {
            if let Some(material) = n.material() {
                material.names(&mut |link, _| self.material(link));
            }
            n.object().into_iter().for_each(|of| self.instance(of));
        });
    }

    fn instance(&mut self, link: &Link<Node>) {
        // What couldn't be read has been complained of.
        let (of, objects) = (&link.name, &self.scene.objects);
        if of.is_empty() || objects.is_unreadable() || link.to().is_some() {
            return;
        }
        let names = || self.scene.objects.iter().map(|(n, _)| n.value.as_str());
        let help = self.near(of, names()).unwrap_or_else(|| available("objects", names()));
        let message = format!("there is no object named `{}`", suggest::brief(of));
        self.d.push(Diagnostic::error(of.span, message).help(help));
    }

    fn material(&mut self, link: &Link<Material>) {
        let (name, materials) = (&link.name, &self.scene.materials);
        if name.is_empty() || materials.is_unreadable() || link.to().is_some() {
            return;
        }
        let names = || self.scene.materials.iter().map(|(n, _)| n.value.as_str());
        let help = self.near(name, names()).unwrap_or_else(|| {
            if Material::KINDS.contains(&name.value.as_str()) {
                format!("to use a material without naming it, write `material: {{ {}: {{}} }}`", name.value)
            } else if let Some(code) = css::code(name) {
                format!(
                    "for one of that colour write `material: {{ diffuse: {{ reflectance: '#{code:06x}' }} }}`"
                )
            } else if LinearRgb::from_hex(name).is_some() {
                format!(
                    "for one of that colour write `material: {{ diffuse: {{ reflectance: '{}' }} }}`",
                    name.value
                )
            } else if let Some(here) = alias::of_kind(name, Material::KINDS) {
                match here {
                    Here::Called(kind) => format!(
                        "`{name}` is called `{kind}` here: write `material: {{ {kind}: {{}} }}`",
                        name = name.value
                    ),
                    Here::Write(what) if what.starts_with('`') => {
                        format!("write `material: {{ ... }}` with {what}")
                    }
                    Here::Write(what) => what.to_owned(),
                    Here::NotYet(what) => format!("not supported yet: {what}"),
                }
            } else {
                available("materials", names())
            }
        });
        let message = format!("there is no material named `{}`", suggest::brief(name));
        self.d.push(Diagnostic::error(name.span, message).help(help));
    }

    /// Looks for a near name, though not among so many that it would take long.
    fn near<'n>(&self, name: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
        const MOST: usize = 1000;
        if self.d.is_full() { None } else { suggest::did_you_mean(name, names.take(MOST)) }
    }

    /// There may be so many groups of lights that nobody could hold their pictures.
    fn light_groups(&mut self) {
        let count = self.scene.light_groups().len();
        if count > MOST_LIGHT_GROUPS {
            let message = format!("{count} groups of lights: there may be {MOST_LIGHT_GROUPS}");
            self.d.push(Diagnostic::error(Span::NONE, message));
        }
    }

    /// What lamps light and what casts shadows of them, or doesn't, must be there.
    fn linked(&mut self) {
        let links = self.scene.links();
        if links.is_empty() {
            return;
        }
        let count = self.scene.linked_names().len();
        if count > MOST_LINKED {
            let message = format!(
                "lamps name {count} things, which they light or which cast shadows of them, or don't: there may be {MOST_LINKED}"
            );
            self.d
                .push(Diagnostic::error(links[0].span, message).help("put things into a group with a name"));
        }
        let names =
            self.names_of(self.scene.objects.iter().map(|(_, object)| object).chain(&self.scene.world));
        let mut lamps: Vec<&str> =
            self.scene.lights.iter().filter_map(Light::name).map(|n| &*n.value).collect();
        lamps.sort_unstable();
        let zones = self.scene.lamp_of_zones();
        for name in links {
            // Of lights in the list only shadows can be asked for: nothing falls on them, nor behind them.
            let is_light = lamps.binary_search(&name.value.as_str()).is_ok();
            let asks_light = zones.is_some_and(|zones| std::ptr::eq(zones, name));
            if names.binary_search(&name.value.as_str()).is_ok() || is_light && asks_light {
                continue;
            }
            let diagnostic = if is_light {
                let message = format!(
                    "`{}` is a light: there is no surface that goes by that name",
                    suggest::brief(name)
                );
                Diagnostic::error(name.span, message).help(
                    "lamps say what they light, and what casts shadows of them: things, or groups of them",
                )
            } else {
                let message = format!("nothing is named `{}`", suggest::brief(name));
                let mut all = names.clone();
                all.extend(lamps.iter().filter(|_| asks_light));
                Diagnostic::error(name.span, message).help(self.near_or_all(name, &all))
            };
            self.d.push(diagnostic);
        }
    }

    /// What nodes go by, and all that is in them.
    fn names_of(&self, nodes: impl Iterator<Item = &'a Node>) -> Vec<&'a str> {
        let mut names: Vec<&str> = Vec::new();
        for node in nodes {
            node.visit(&mut |n| {
                names.extend(n.name().map(|n| n.value.as_str()));
                names.extend(n.object().map(|of| of.name.value.as_str()));
            });
        }
        names.sort_unstable();
        names.dedup();
        names
    }

    /// The name that was meant, or those that there are.
    fn near_or_all(&self, name: &str, names: &[&str]) -> String {
        let all = names.iter().copied();
        self.near(name, all.clone()).unwrap_or_else(|| match names.len() {
            0 => "give it a name: `- sphere: { name: ball }`".to_owned(),
            _ => format!("the names in the world are {}", suggest::list(all.take(12))),
        })
    }

    /// What the camera is focused on must be in the world, outside of objects: there it could be in many places.
    fn focus(&mut self) {
        let Some(name) = self.scene.camera.focus_on().filter(|n| !n.is_empty()) else { return };
        let names = self.names_of(self.scene.world.iter());
        if names.contains(&name.value.as_str()) {
            return;
        }
        let message = format!("nothing in the world is named `{}`", suggest::brief(name));
        let help = if self.scene.objects.get(name).is_some() {
            "there is such an object, but no instance of it in the world".to_owned()
        } else {
            self.near_or_all(name, &names)
        };
        self.d.push(Diagnostic::error(name.span, message).help(help));
    }

    fn edges(&self, node: &Node) -> Vec<Edge> {
        let mut edges = Vec::new();
        node.visit(&mut |n| {
            if let Some(of) = n.object()
                && let Some(to) = of.to()
            {
                edges.push(Edge { to, span: of.name.span });
            }
        });
        edges
    }

    /// Objects must not contain themselves, nor nest too deep. Kept on a stack of its own: a scene may chain as many
    /// objects as it likes.
    fn nesting(&mut self) {
        let edges: Vec<Vec<Edge>> = self.scene.objects.iter().map(|(_, object)| self.edges(object)).collect();
        let mut states = vec![State::Unseen; edges.len()];
        for root in 0..edges.len() {
            if states[root] != State::Unseen {
                continue;
            }
            states[root] = State::Open;
            // Objects that are open, each with how many of its edges are done and how deep those were.
            let mut open = vec![(root, 0, 0)];
            while let Some((object, done, depth)) = open.last_mut() {
                let Some(edge) = edges[*object].get(*done) else {
                    states[*object] = State::Known(*depth);
                    open.pop();
                    continue;
                };
                let to = edge.to.index();
                match states[to] {
                    State::Unseen => {
                        states[to] = State::Open;
                        open.push((to, 0, 0));
                    }
                    State::Open => {
                        *done += 1;
                        self.cycle(*edge);
                    }
                    State::Known(inner) => {
                        *done += 1;
                        self.deep(inner + 1, edge.span);
                        *depth = (*depth).max(inner + 1);
                    }
                }
            }
        }
        for node in &self.scene.world {
            for edge in self.edges(node) {
                if let State::Known(inner) = states[edge.to.index()] {
                    self.deep(inner + 1, edge.span);
                }
            }
        }
    }

    fn cycle(&mut self, edge: Edge) {
        let Some((name, _)) = self.scene.objects.at(edge.to) else { return };
        let message = format!("object `{}` contains itself", suggest::brief(name));
        let label = format!("`{}` is defined here", suggest::brief(name));
        self.d.push(Diagnostic::error(edge.span, message).related(name.span, label));
    }

    /// Complains where the limit is first passed, not again at every level above.
    fn deep(&mut self, depth: usize, span: Span) {
        if depth == DEEPEST + 1 {
            let message = format!("instances nest deeper than {DEEPEST} levels");
            let help = "put some of the levels into `group`s, which cost no level";
            self.d.push(Diagnostic::error(span, message).help(help));
        }
    }

    /// Placements must have an inverse together with all the groups around them.
    fn placement(&mut self, node: &Node, outer: &Affine) {
        let moves = !node.transform().later.is_empty();
        if moves && node.motion().len() <= node.transform().later.len() {
            let message =
                "this is singular at some time: it flattens everything, or leaves the range of numbers";
            self.d.push(Diagnostic::error(node.transform().span, message));
        }
        // What is wrong by itself has been complained of.
        let Some(local) = node.transform().affine() else { return };
        let Some(own) = node.placement() else {
            if let (Some(_), Some(target)) = (Rounded::new(&local), node.look_at()) {
                let message = "`look_at` is where this stands, so there is no direction to look in";
                self.d.push(Diagnostic::error(target.span, message));
            }
            return;
        };
        let all = own.then(outer);
        if Rounded::new(&all).is_none() {
            let message = "together with the groups around it, this transform is singular or leaves the range of numbers";
            let span = node.transform().span;
            if Rounded::new(&own).is_some() {
                self.d.push(Diagnostic::error(span, message));
            }
            return;
        }
        for child in node.children() {
            self.placement(child, &all);
        }
        if let Node::Instances(i) = node
            && let Some(bad) = i.transforms.iter().position(|m| Rounded::new(&m.0.then(&all)).is_none())
        {
            let message =
                format!("transform {bad}, counted from 0, is singular or leaves the range of numbers");
            self.d.push(Diagnostic::error(i.of.name.span, message));
        }
    }
}

/// What names there are, for help.
fn available<'a>(key: &str, names: impl Iterator<Item = &'a str>) -> String {
    const MOST: usize = 12;
    let mut names = names;
    let first: Vec<_> = names.by_ref().take(MOST).collect();
    match (first.len(), names.count()) {
        (0, _) => format!("`{key}` has no entries"),
        (_, 0) => format!("`{key}` has {}", suggest::list(first)),
        (_, more) => format!("`{key}` has {} and {more} more", suggest::list(first)),
    }
}
