//! The search structures: which there are, and one of any kind.

use crate::{
    brute::Brute,
    bsp::{BspParams, BspTree},
    bvh::{Bvh, params::BvhParams},
    bvh2::{Bvh2, Bvh2Params},
    grid::{Grid, GridParams},
    kd::{KdParams, KdTree},
    name::UnknownName,
    octree::{Octree, OctreeParams},
    volumes::{Volumes, VolumesParams},
};
use std::{fmt, str::FromStr};

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

/// The same with whichever structure of the textbook it is; nothing, and no hit, with the wide tree.
macro_rules! textbook {
    ($searcher:expr, $s:ident => $body:expr) => {
        match $searcher {
            $crate::structure::Searcher::Brute($s) => $body,
            $crate::structure::Searcher::Bvh(_) => Default::default(),
            $crate::structure::Searcher::Bvh2($s) => $body,
            $crate::structure::Searcher::Grid($s) => $body,
            $crate::structure::Searcher::Kd($s) => $body,
            $crate::structure::Searcher::Octree($s) => $body,
            $crate::structure::Searcher::Bsp($s) => $body,
            $crate::structure::Searcher::Volumes($s) => $body,
        }
    };
}
pub(crate) use textbook;
