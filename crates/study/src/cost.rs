//! Where the searches of a render were expensive: what they cost at each pixel, in false colours with a legend.

use crate::false_colour::{Chart, SaveError, Scale};
use std::path::Path;
use straal::Picture;
use straal_render::film::channel;

/// What a picture of the searches' costs shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// Nodes opened, or cells entered, a sample.
    #[default]
    Nodes,
    /// Primitives tested a sample.
    Primitives,
    /// Time spent in search a sample.
    Time,
}

impl Measure {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Nodes, Self::Primitives, Self::Time];

    /// The name as it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nodes => "nodes",
            Self::Primitives => "primitives",
            Self::Time => "time",
        }
    }

    /// What a legend says.
    const fn caption(self) -> &'static str {
        match self {
            Self::Nodes => "nodes a sample",
            Self::Primitives => "primitives a sample",
            Self::Time => "nanoseconds a sample",
        }
    }
}

/// Writes what the searches of a picture cost as a PNG in false colours with a legend.
pub fn save(picture: &Picture, path: &Path, of: Measure) -> Result<(), SaveError> {
    let channel = match of {
        Measure::Nodes => &channel::NODES,
        Measure::Primitives => &channel::PRIMITIVES,
        Measure::Time => &channel::TIME,
    };
    let values = picture.layers.channel(channel).map(|layer| &layer.values);
    let values = values.ok_or(SaveError::NotCounted(of.name()))?;
    let scale = Scale::of(values);
    let chart = Chart::of(values, picture.layers.width, scale).with_legend(scale, of.caption());
    chart.save(path, &picture.metadata)
}
