//! Handles: which of the meshes, pictures or spectra that stand beside a description.

use std::cmp::Ordering;
use std::fmt;
use std::marker::PhantomData;

use crate::value::Asset;
use crate::visit::Visitor;

/// Which mesh, picture or spectrum: its place in the lists of [`crate::Assets`], whether it comes from a file, from a buffer inside of
/// one, or from a program.
pub struct Handle<T> {
    index: u32,
    of: PhantomData<fn() -> T>,
}

impl<T> Handle<T> {
    /// That of the thing at a place.
    pub(crate) const fn new(index: u32) -> Self {
        Self { index, of: PhantomData }
    }

    /// The place.
    pub const fn index(self) -> usize {
        self.index as usize
    }
}

impl<T> Clone for Handle<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Handle<T> {}

impl<T> PartialEq for Handle<T> {
    fn eq(&self, o: &Self) -> bool {
        self.index == o.index
    }
}

impl<T> Eq for Handle<T> {}

impl<T> PartialOrd for Handle<T> {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}

impl<T> Ord for Handle<T> {
    fn cmp(&self, o: &Self) -> Ordering {
        self.index.cmp(&o.index)
    }
}

impl<T> fmt::Debug for Handle<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Handle({})", self.index)
    }
}

/// Things by their handles. A place may be empty: what couldn't be read.
#[derive(Clone, Debug)]
pub struct Store<T, V> {
    list: Vec<Option<V>>,
    of: PhantomData<fn() -> T>,
}

impl<T, V> Default for Store<T, V> {
    fn default() -> Self {
        Self { list: Vec::new(), of: PhantomData }
    }
}

impl<T, V> Store<T, V> {
    /// The thing of a handle; `None` where it was never read.
    pub fn get(&self, handle: Handle<T>) -> Option<&V> {
        self.list.get(handle.index()).and_then(Option::as_ref)
    }

    /// Puts a thing where a handle leads.
    pub fn put(&mut self, handle: Handle<T>, value: V) {
        if self.list.len() <= handle.index() {
            self.list.resize_with(handle.index() + 1, || None);
        }
        self.list[handle.index()] = Some(value);
    }

    /// Adds a thing that no handle leads to, and gives one.
    pub fn add(&mut self, value: V) -> Handle<T> {
        self.list.push(Some(value));
        Handle::new((self.list.len() - 1) as u32)
    }

    /// All that are there.
    pub fn iter(&self) -> impl Iterator<Item = &V> {
        self.list.iter().flatten()
    }
}

/// Handles by the names that a description gives to what they lead to: the same name leads to the same thing.
#[derive(Clone, Debug, Default)]
pub struct Handles {
    known: [std::collections::BTreeMap<String, u32>; 5],
}

impl Handles {
    /// The handle of a name, which is given one when it is met first.
    pub fn of<T: Kind>(&mut self, name: &str) -> Handle<T> {
        let known = &mut self.known[T::KIND];
        if let Some(index) = known.get(name) {
            return Handle::new(*index);
        }
        let index = known.len() as u32;
        known.insert(name.to_owned(), index);
        Handle::new(index)
    }
}

/// What has handles.
pub trait Kind: Sized {
    /// Its place among the kinds.
    const KIND: usize;

    /// Shows one that a description names to whoever looks through it; nothing, unless it says otherwise.
    fn show<'a>(_: &'a Asset<Self>, _: &mut dyn Visitor<'a>) {}
}

impl Kind for crate::Mesh {
    const KIND: usize = 0;
}

impl Kind for crate::Image {
    const KIND: usize = 1;
}

impl Kind for crate::Bitmap {
    const KIND: usize = 2;

    fn show<'a>(asset: &'a Asset<Self>, visitor: &mut dyn Visitor<'a>) {
        visitor.bitmap(asset);
    }
}

impl Kind for straal_color::spectrum::TabulatedSpectrum {
    const KIND: usize = 3;
}

impl Kind for crate::Photometry {
    const KIND: usize = 4;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Image, Mesh};

    #[test]
    fn a_name_leads_to_one_thing_of_a_kind() {
        let mut handles = Handles::default();
        let (a, b, again) =
            (handles.of::<Mesh>("a.ply"), handles.of::<Mesh>("b.ply"), handles.of::<Mesh>("a.ply"));
        assert!(a == again && a != b);
        assert_eq!(handles.of::<Image>("b.ply").index(), 0, "kinds are counted apart");
    }

    #[test]
    fn what_was_never_read_is_not_there() {
        let mut store = Store::<Mesh, char>::default();
        store.put(Handle::new(2), 'c');
        let added = store.add('d');
        let got: Vec<_> = (0..5).map(|i| store.get(Handle::new(i)).copied()).collect();
        assert_eq!(got, [None, None, Some('c'), Some('d'), None]);
        assert_eq!((added.index(), store.iter().count()), (3, 2));
    }
}
