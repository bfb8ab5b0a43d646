//! What the builder of the wide tree can be told.

/// How the wide tree is built and kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct BvhParams {
    /// How much work goes into the tree.
    pub build: Build,
    /// Whether memory is spared at the cost of some speed.
    pub compact: bool,
}

impl BvhParams {
    /// A balanced build for speed.
    pub const DEFAULT: Self = Self { build: Build::Default, compact: false };
}

/// How much work goes into a tree. It changes the speed only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Build {
    /// Little: for a preview.
    Fast,
    /// What pays off for one picture.
    #[default]
    Default,
    /// As much as helps: for many rays.
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
