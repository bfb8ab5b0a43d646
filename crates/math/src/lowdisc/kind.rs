//! The names of the patterns.

/// A pattern by name, without the size of its set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PatternKind {
    /// Owen-scrambled Sobol points, shuffled for each pixel.
    #[default]
    Sobol,
    /// The same points dealt out over neighbouring pixels, so that the error is blue noise.
    BlueSobol,
    /// Scrambled Halton points.
    Halton,
    /// Scrambled Hammersley points.
    Hammersley,
    /// Correlated multi-jittered points.
    MultiJittered,
    /// One point in each row and each column.
    NRooks,
    /// One point in each cell of a grid.
    Jittered,
    /// The middles of a grid's cells: not random at all, so that errors are the same in every pixel.
    Regular,
    /// Independent points.
    Random,
}

impl PatternKind {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Sobol,
        Self::BlueSobol,
        Self::Halton,
        Self::Hammersley,
        Self::MultiJittered,
        Self::NRooks,
        Self::Jittered,
        Self::Regular,
        Self::Random,
    ];

    /// The name in scenes, on the command line and in pictures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sobol => "sobol",
            Self::BlueSobol => "blue_sobol",
            Self::Halton => "halton",
            Self::Hammersley => "hammersley",
            Self::MultiJittered => "multi_jittered",
            Self::NRooks => "n_rooks",
            Self::Jittered => "jittered",
            Self::Regular => "regular",
            Self::Random => "random",
        }
    }

    /// Whether where a point lies depends on how many there will be, so that the number must be known before the first.
    pub const fn needs_count(self) -> bool {
        !matches!(self, Self::Sobol | Self::Halton | Self::Random)
    }

    /// Whether each point by itself is even over the unit square, so that means are right whatever is sampled.
    pub const fn is_unbiased(self) -> bool {
        !matches!(self, Self::Regular)
    }
}

impl std::fmt::Display for PatternKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
