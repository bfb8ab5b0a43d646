//! What can never be hit.

/// Primitives of one geometry, or an instance, that were left out of a scene because they can never be hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dropped {
    /// What they belong to.
    pub from: DroppedFrom,
    /// How many have a coordinate that isn't finite.
    pub not_finite: usize,
    /// How many are finite, but without extent: triangles without area, shapes with an empty box.
    pub empty: usize,
}

/// What left-out primitives belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DroppedFrom {
    /// A geometry, by its number in [`crate::Input::geometries`].
    Geometry(u32),
    /// An instance of this group, as a whole.
    Instance {
        /// The number in [`crate::Input::groups`].
        group: u32,
    },
}

impl Dropped {
    /// None of them yet.
    pub(crate) const fn none(from: DroppedFrom) -> Self {
        Self { from, not_finite: 0, empty: 0 }
    }

    /// One more.
    pub(crate) fn add(&mut self, is_finite: bool) {
        *(if is_finite { &mut self.empty } else { &mut self.not_finite }) += 1;
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.not_finite + self.empty
    }
}
