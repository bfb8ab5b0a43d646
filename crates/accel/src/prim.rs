//! Primitives as builders and structures know them.

use straal_math::Bounds;

/// One bounded primitive as a builder sees it. As large and aligned as what the fast tree is built from, which takes its place in memory.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
pub(crate) struct Prim {
    /// Its own padded box: that of `slab::triangle_bounds` or of the object.
    pub bounds: Bounds,
    pub kind: PrimKind,
}

/// Where a primitive is found in its group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PrimKind {
    /// The group's n-th triangle, counted over its meshes.
    Triangle(u32),
    /// Index into the group's objects: a shape or an instance.
    Object(u32),
}

impl PrimKind {
    /// The same in 32 bits.
    #[inline(always)]
    pub const fn packed(self) -> Packed {
        match self {
            Self::Triangle(id) => Packed(id),
            Self::Object(id) => Packed(id | Packed::OBJECT),
        }
    }
}

/// A [`PrimKind`] in 32 bits: numbers take 30 of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Packed(u32);

impl Packed {
    const OBJECT: u32 = 1 << 31;

    /// No primitive's.
    pub const NONE: Self = Self(u32::MAX);

    #[inline(always)]
    pub const fn kind(self) -> PrimKind {
        match self.0 & Self::OBJECT {
            0 => PrimKind::Triangle(self.0),
            _ => PrimKind::Object(self.0 & !Self::OBJECT),
        }
    }

    /// A number that no other primitive of the group has.
    #[inline(always)]
    pub const fn number(self) -> u32 {
        self.0
    }
}
