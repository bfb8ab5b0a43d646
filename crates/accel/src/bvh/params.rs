//! What the builder of the wide tree can be told.

use crate::analytic::block::Member;
use straal_math::Vec3;

/// How the wide tree is built and kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct BvhParams {
    /// How much work goes into the tree.
    pub build: Build,
    /// Whether leaves hold numbers of triangles instead of their vertices: a third of the memory, at the cost of speed.
    pub compact: bool,
}

impl BvhParams {
    /// A balanced build for speed.
    pub const DEFAULT: Self = Self { build: Build::Default, compact: false };
}

/// How much work goes into a tree. It changes the speed only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Build {
    /// Cuts are looked for along the longest axis alone: for a preview.
    Fast,
    /// Cuts are looked for between 32 bins along each axis. In a scene crowded with the boxes of long thin triangles, these are
    /// cut in parts (spatial splits), so that the tree has up to a sixteenth more references than triangles.
    #[default]
    Default,
    /// Triangles are cut wherever their boxes overlap much. The tree has up to a quarter more references than triangles.
    Best,
}

impl Build {
    /// All of them, the cheapest first.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Default, Self::Best];

    /// The name as it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Default => "default",
            Self::Best => "best",
        }
    }
}

/// Where the corners of a triangle are, by its number.
pub(super) type Vertices<'a> = dyn Fn(u32) -> [Vec3; 3] + Sync + 'a;

/// What a build goes by.
#[derive(Clone, Copy)]
pub(super) struct Plan<'a> {
    pub shapes: &'a [Member],
    pub vertices: &'a Vertices<'a>,
    pub build: Build,
    pub compact: bool,
    /// Half the area of an overlap below which no triangle is cut.
    pub least_overlap: f32,
}
