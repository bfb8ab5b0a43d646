//! What the builder of the wide tree can be told.

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
    /// Cuts are looked for between 32 bins along each axis.
    #[default]
    Default,
    /// The same, and triangles are cut where their boxes overlap much (spatial splits): for long thin ones. The tree has at
    /// most a quarter more references than triangles.
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
