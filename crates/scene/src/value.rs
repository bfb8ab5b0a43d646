//! The small values that descriptions are made of.

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use straal_math::{Affine, DVec3};

use crate::handle::Handle;
use crate::span::Spanned;

/// A name said in the scene; equal to another when the text is.
pub type Name = Spanned<String>;

/// A file as the scene names it: absolute, or relative to the scene's folder.
pub type FileRef = Spanned<String>;

/// A mesh or picture that a description has a handle to, and what it calls it: a file, or what a program made up.
pub struct Asset<T> {
    /// As the scene names it.
    pub file: FileRef,
    /// Which it is.
    pub handle: Handle<T>,
}

impl<T> Asset<T> {
    /// What goes by that handle, called so.
    pub fn new(file: impl Into<FileRef>, handle: Handle<T>) -> Self {
        Self { file: file.into(), handle }
    }
}

impl<T> Clone for Asset<T> {
    fn clone(&self) -> Self {
        Self { file: self.file.clone(), handle: self.handle }
    }
}

impl<T> PartialEq for Asset<T> {
    fn eq(&self, o: &Self) -> bool {
        self.file == o.file && self.handle == o.handle
    }
}

impl<T> fmt::Debug for Asset<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} {:?}", self.handle, self.file.value)
    }
}

/// A name that leads to one of the scene's objects or materials.
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

    /// Leads it to what goes by its name.
    pub(crate) fn find(&mut self, places: Places<'_, T>) {
        self.to = places.get(&self.name);
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

/// A colour in linear RGB (Rec. 709 primaries, D65 white). What these primaries don't hold has components below 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Color(pub [f64; 3]);

impl Color {
    /// The same number in all three channels.
    pub const fn grey(v: f64) -> Self {
        Self([v; 3])
    }

    /// From `#rrggbb` or `#rgb` in sRGB; `None` when it isn't that.
    pub fn from_hex(text: &str) -> Option<Self> {
        let digits = text.strip_prefix('#')?.as_bytes();
        let digit = |i: usize| char::from(digits[i]).to_digit(16);
        let channel = |i: usize| match digits.len() {
            3 => digit(i).map(|v| 17 * v),
            6 => Some(16 * digit(2 * i)? + digit(2 * i + 1)?),
            _ => None,
        };
        Some(Self([linear(channel(0)?), linear(channel(1)?), linear(channel(2)?)]))
    }
}

/// An 8-bit sRGB code as linear light (IEC 61966-2-1).
fn linear(code: u32) -> f64 {
    let c = f64::from(code) / 255.0;
    if c <= 0.04045 {
        return c / 12.92;
    }
    // b^2.4 = b^2 y with y = b^(2/5), the root of y^5 = b^2: Newton's method from above is monotonic, and uses no
    // function that differs between machines.
    let b = (c + 0.055) / 1.055;
    let mut y = 1.0;
    for _ in 0..40 {
        let y4 = y * y * y * y;
        y -= (y4 * y - b * b) / (5.0 * y4);
    }
    b * b * y
}

/// A direction that may be written `x`, `y` or `z`; not zero, not necessarily of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis(pub DVec3);

/// Factors for each axis, which may be written as one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors(pub DVec3);

/// An affine map written as rows of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix(pub Affine);

/// How many edges a path may have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depth {
    /// As many as it likes.
    #[default]
    Unlimited,
    /// At most so many, the camera's edge included: 1 sees emitters, 2 is direct light.
    Edges(u32),
}

/// Things by name, in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<T> {
    entries: Vec<(Name, T)>,
    index: BTreeMap<String, usize>,
    unreadable: bool,
}

/// Where named things are.
pub(crate) struct Places<'a, T> {
    index: &'a BTreeMap<String, usize>,
    of: PhantomData<fn() -> T>,
}

impl<T> Clone for Places<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Places<'_, T> {}

impl<T> Places<'_, T> {
    fn get(self, name: &str) -> Option<Handle<T>> {
        self.index.get(name).map(|&i| Handle::new(i as u32))
    }
}

impl<T> Default for Named<T> {
    fn default() -> Self {
        Self { entries: Vec::new(), index: BTreeMap::new(), unreadable: false }
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
            self.index.insert(name.value.clone(), self.entries.len());
            self.entries.push((name, thing));
        }
    }

    /// The thing of that name.
    pub fn get(&self, name: &str) -> Option<&T> {
        self.index.get(name).map(|&i| &self.entries[i].1)
    }

    /// The handle of the thing of that name: its place in the order of the file.
    pub fn handle(&self, name: &str) -> Option<Handle<T>> {
        Places { index: &self.index, of: PhantomData }.get(name)
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

    /// Where the things are, by name, and the things themselves, to be changed.
    pub(crate) fn parts_mut(&mut self) -> (Places<'_, T>, impl Iterator<Item = &mut T>) {
        let places = Places { index: &self.index, of: PhantomData };
        (places, self.entries.iter_mut().map(|(_, thing)| thing))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_is_srgb() {
        // Reference values of the sRGB transfer function to 7 digits.
        let Color([r, g, b]) = Color::from_hex("#ff8000").unwrap();
        assert_eq!((r, b), (1.0, 0.0));
        assert!((g - 0.2158605).abs() < 1e-7);
        assert!((Color::from_hex("#0b0b0b").unwrap().0[0] - 0.0033465).abs() < 1e-7);
        assert_eq!(Color::from_hex("#f80"), Color::from_hex("#ff8800"));
        for wrong in ["", "#", "ff8000", "#ff80", "#gg8000", "#ff80000", "#+f+f+f", "#é00"] {
            assert_eq!(Color::from_hex(wrong), None, "{wrong}");
        }
    }
}
