//! Names that lead somewhere: to things of the scene, and to what straal knows by itself.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use straal_color::spectrum::Illuminant;
use straal_color::spectrum::illuminant;
use straal_color::spectrum::refraction::{Glass, Metal};

use crate::desc::shape::Patches;
use crate::desc::{Material, Node, Texture};
use crate::handle::Handle;
use crate::value::Name;

/// Places of things in their lists, by name.
type Index = Arc<BTreeMap<String, usize>>;

/// Where the things of a scene are that names lead to.
#[derive(Clone, Debug)]
pub struct Places {
    objects: Index,
    materials: Index,
    textures: Index,
}

impl Places {
    /// Those of a scene.
    pub(crate) fn of(scene: &crate::desc::Scene) -> Self {
        Self {
            objects: scene.objects.index.clone(),
            materials: scene.materials.index.clone(),
            textures: scene.textures.index.clone(),
        }
    }
}

/// What names of a scene lead to.
pub trait Linked: Sized {
    /// Where those of this kind are.
    fn index(places: &Places) -> &BTreeMap<String, usize>;
}

impl Linked for Node {
    fn index(places: &Places) -> &BTreeMap<String, usize> {
        &places.objects
    }
}

impl Linked for Material {
    fn index(places: &Places) -> &BTreeMap<String, usize> {
        &places.materials
    }
}

impl Linked for Texture {
    fn index(places: &Places) -> &BTreeMap<String, usize> {
        &places.textures
    }
}

/// A name that leads to one of the scene's objects, materials or textures.
pub struct Link<T> {
    /// As the scene says it.
    pub name: Name,
    to: Option<Handle<T>>,
}

impl<T> Link<T> {
    /// A name; where it leads is known when the scene is linked ([`crate::Scene::link`]).
    pub fn new(name: impl Into<Name>) -> Self {
        Self { name: name.into(), to: None }
    }

    /// Where it leads. In a scene that is linked and without errors, each leads somewhere.
    pub const fn to(&self) -> Option<Handle<T>> {
        self.to
    }
}

impl<T: Linked> Link<T> {
    /// Leads it to what goes by its name.
    pub(crate) fn find(&mut self, places: &Places) {
        self.to = T::index(places).get(&self.name.value).map(|&i| Handle::new(i as u32));
    }
}

impl<T> Clone for Link<T> {
    fn clone(&self) -> Self {
        Self { name: self.name.clone(), to: self.to }
    }
}

/// Equal when the names are.
impl<T> PartialEq for Link<T> {
    fn eq(&self, o: &Self) -> bool {
        self.name == o.name
    }
}

impl<T> fmt::Debug for Link<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} {:?}", self.to, self.name.value)
    }
}

/// Things by name, in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<T> {
    entries: Vec<(Name, T)>,
    index: Index,
    unreadable: bool,
}

impl<T> Default for Named<T> {
    fn default() -> Self {
        Self { entries: Vec::new(), index: Index::default(), unreadable: false }
    }
}

impl<T> Named<T> {
    /// What stands in for things that were complained of as a whole: that one isn't there is no complaint of its own.
    pub(crate) fn unreadable() -> Self {
        Self { unreadable: true, ..Self::default() }
    }

    /// Whether it stands in for things that couldn't be read.
    pub(crate) fn is_unreadable(&self) -> bool {
        self.unreadable
    }

    /// Adds a thing; one of the same name is replaced.
    pub fn insert(&mut self, name: Name, thing: T) {
        if let Some(&i) = self.index.get(&name.value) {
            self.entries[i] = (name, thing);
        } else {
            Arc::make_mut(&mut self.index).insert(name.value.clone(), self.entries.len());
            self.entries.push((name, thing));
        }
    }

    /// The thing of that name.
    pub fn get(&self, name: &str) -> Option<&T> {
        self.index.get(name).map(|&i| &self.entries[i].1)
    }

    /// The handle of the thing of that name: its place in the order of the file.
    pub fn handle(&self, name: &str) -> Option<Handle<T>> {
        self.index.get(name).map(|&i| Handle::new(i as u32))
    }

    /// A thing and its name.
    pub fn at(&self, handle: Handle<T>) -> Option<(&Name, &T)> {
        self.entries.get(handle.index()).map(|(n, t)| (n, t))
    }

    /// What a name leads to.
    pub fn of(&self, link: &Link<T>) -> Option<&T> {
        self.at(link.to()?).map(|(_, thing)| thing)
    }

    /// All, in the order of the file.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&Name, &T)> {
        self.entries.iter().map(|(n, t)| (n, t))
    }

    /// The things themselves, to be changed.
    pub(crate) fn things_mut(&mut self) -> impl Iterator<Item = &mut T> {
        self.entries.iter_mut().map(|(_, thing)| thing)
    }

    /// The same with their names.
    pub(crate) fn entries_mut(&mut self) -> impl Iterator<Item = (&Name, &mut T)> {
        self.entries.iter_mut().map(|(name, thing)| (&*name, thing))
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }
}

/// A name of something that straal knows by itself, such as a metal.
#[derive(Clone, Debug)]
pub struct Known<T> {
    /// As the scene says it.
    pub name: Name,
    /// What it leads to.
    pub what: T,
}

/// Equal when the names are.
impl<T> PartialEq for Known<T> {
    fn eq(&self, o: &Self) -> bool {
        self.name == o.name
    }
}

impl<T: Familiar> Known<T> {
    /// What goes by a name, if anything does.
    pub fn new(name: impl Into<Name>) -> Option<Self> {
        let name = name.into();
        Some(Self { what: T::named(&name)?, name })
    }
}

/// A kind of things that straal knows by name.
pub trait Familiar: Sized {
    /// What one is called, in messages.
    const KIND: &'static str;

    /// The one that goes by a name.
    fn named(name: &str) -> Option<Self>;

    /// The names of all.
    fn names() -> Vec<&'static str>;

    /// What stands in for one that nobody knows, of which whoever reads complains.
    fn stand_in() -> Self;
}

impl Familiar for Metal {
    const KIND: &'static str = "metal";

    fn named(name: &str) -> Option<Self> {
        Self::named(name)
    }

    fn names() -> Vec<&'static str> {
        Self::all().map(Self::name).collect()
    }

    fn stand_in() -> Self {
        Self::default()
    }
}

impl Familiar for Glass {
    const KIND: &'static str = "glass";

    fn named(name: &str) -> Option<Self> {
        Self::named(name)
    }

    fn names() -> Vec<&'static str> {
        Self::all().map(Self::name).collect()
    }

    fn stand_in() -> Self {
        Self::default()
    }
}

impl Familiar for Illuminant {
    const KIND: &'static str = "illuminant";

    fn named(name: &str) -> Option<Self> {
        Self::named(name)
    }

    fn names() -> Vec<&'static str> {
        illuminant::NAMES.to_vec()
    }

    /// No reflectance is complained of beside it.
    fn stand_in() -> Self {
        Self::E
    }
}

impl Familiar for Patches {
    const KIND: &'static str = "built-in surface";

    fn named(name: &str) -> Option<Self> {
        (name == "teapot").then_some(Self::Teapot)
    }

    fn names() -> Vec<&'static str> {
        vec!["teapot"]
    }

    fn stand_in() -> Self {
        Self::Teapot
    }
}
