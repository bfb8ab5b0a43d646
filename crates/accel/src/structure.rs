//! The search structures, and the contract they share.

use crate::{
    brute::Brute,
    bsp::{BspParams, BspTree},
    bvh::{Bvh, params::BvhParams},
    bvh2::{Bvh2, Bvh2Params},
    grid::{Grid, GridParams},
    hit::{Chain, Hit},
    kd::{KdParams, KdTree},
    kernel::Kernel,
    local::LocalRay,
    octree::{Octree, OctreeParams},
    query::Query,
    scene::GroupData,
    section::Section,
    volumes::{Volumes, VolumesParams},
};
use std::{fmt, str::FromStr};
use straal_math::Bounds;

/// A way to search a group, with its parameters. All give the same hits.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Structure {
    /// Every primitive against every ray: the reference.
    Brute,
    /// A tree of boxes, eight wide, built by the surface area heuristic.
    Bvh(BvhParams),
    /// A binary tree of boxes, built as the textbook builds it.
    Bvh2(Bvh2Params),
    /// A uniform grid.
    Grid(GridParams),
    /// Space cut in two by planes at right angles to the axes, where the surface area heuristic wants it.
    Kd(KdParams),
    /// Space cut in eight, again and again.
    Octree(OctreeParams),
    /// Space cut in two by the planes of the triangles.
    Bsp(BspParams),
    /// A bounding volume around each object.
    Volumes(VolumesParams),
}

impl Default for Structure {
    fn default() -> Self {
        Self::Bvh(BvhParams::DEFAULT)
    }
}

impl Structure {
    /// One of each kind, with its default parameters, in the order of the course.
    pub const ALL: [Self; 8] = [
        Self::Brute,
        Self::Volumes(VolumesParams::DEFAULT),
        Self::Grid(GridParams::DEFAULT),
        Self::Octree(OctreeParams::DEFAULT),
        Self::Kd(KdParams::DEFAULT),
        Self::Bsp(BspParams::DEFAULT),
        Self::Bvh2(Bvh2Params::DEFAULT),
        Self::Bvh(BvhParams::DEFAULT),
    ];

    /// The name of the kind as it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Brute => "brute",
            Self::Bvh(_) => "bvh",
            Self::Bvh2(_) => "bvh2",
            Self::Grid(_) => "grid",
            Self::Kd(_) => "kd",
            Self::Octree(_) => "octree",
            Self::Bsp(_) => "bsp",
            Self::Volumes(_) => "volumes",
        }
    }
}

impl fmt::Display for Structure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The name of a kind stands for it with its default parameters.
impl FromStr for Structure {
    type Err = UnknownName;

    fn from_str(s: &str) -> Result<Self, UnknownName> {
        Self::ALL.into_iter().find(|x| x.name() == s).ok_or_else(|| UnknownName {
            what: "search structure",
            name: s.to_owned(),
            known: Self::ALL.map(Self::name).join(", "),
        })
    }
}

/// A name that stands for nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} '{name}': expected one of {known}")]
pub struct UnknownName {
    /// What kind of thing was named.
    pub what: &'static str,
    /// The name.
    pub name: String,
    /// The names that exist, with commas between.
    pub known: String,
}

/// One bounded primitive as a builder sees it.
#[derive(Clone, Copy, Debug)]
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

/// What every structure over a group's bounded primitives offers.
///
/// `closest` offers to `best` every primitive that could come before it, by the tests of `Query`, which are the same
/// for all; it may leave out only what lies strictly beyond `best.t` or outside the ray's interval.
pub(crate) trait Search: Sized {
    fn closest<K: Kernel, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    );

    /// Whether there is any hit in the ray's interval.
    fn occluded<K: Kernel, const COUNT: bool>(&self, q: &mut Query<'_, K, COUNT>, at: &Place<'_>) -> bool;

    fn memory_bytes(&self) -> usize;

    /// What a report says of the structure; it walks the whole of it.
    fn stats(&self) -> Stats;

    /// What a drawing of the structure shows at a height: cells, or the boxes of a binary tree. Other structures show nothing.
    fn section(&self, _z: f64) -> Vec<Section> {
        Vec::new()
    }
}

/// What a structure is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    /// Inner nodes.
    pub nodes: usize,
    /// Leaves or cells, the empty ones included.
    pub leaves: usize,
    /// Primitives in all leaves; more than there are where a primitive may be in several.
    pub references: usize,
    /// Steps from the root to the deepest leaf.
    pub depth: u32,
    /// What a random line through the root's box costs, in tests of one primitive, by the surface area heuristic with the
    /// structure's own costs (Goldsmith and Salmon 1987; MacDonald and Booth 1990).
    pub sah_cost: f64,
}

/// Where a search stands: a ray in a group's space, and the instances passed on the way.
pub(crate) struct Place<'a> {
    pub group: &'a GroupData,
    pub ray: &'a LocalRay,
    pub chain: &'a Chain,
}

/// A structure of any kind.
pub(crate) enum Searcher {
    Brute(Brute),
    Bvh(Bvh),
    Bvh2(Bvh2),
    Grid(Grid),
    Kd(KdTree),
    Octree(Octree),
    Bsp(BspTree),
    Volumes(Volumes),
}

/// Does the same with whichever structure it is.
macro_rules! each {
    ($searcher:expr, $s:ident => $body:expr) => {
        match $searcher {
            $crate::structure::Searcher::Brute($s) => $body,
            $crate::structure::Searcher::Bvh($s) => $body,
            $crate::structure::Searcher::Bvh2($s) => $body,
            $crate::structure::Searcher::Grid($s) => $body,
            $crate::structure::Searcher::Kd($s) => $body,
            $crate::structure::Searcher::Octree($s) => $body,
            $crate::structure::Searcher::Bsp($s) => $body,
            $crate::structure::Searcher::Volumes($s) => $body,
        }
    };
}
pub(crate) use each;
