//! What a film can hold of each pixel besides light: one list.
//!
//! A channel is one entry of [`CHANNELS`]. From there follow its sums in the film, in files of sums and in films made of parts, the
//! [`super::Layers`], the mean over replicates, and the layer of an EXR.

use super::CostSample;
use super::fixed::{Fixed, Guide, MAX_VALUE};
use straal_math::{Vec3, ops};

/// Numbers of each pixel that samples have a mean of.
#[derive(Debug)]
pub struct Channel {
    /// The EXR's layer.
    pub layer: &'static str,
    /// Names of its numbers in that layer, three at most.
    pub components: &'static [&'static str],
    /// Name in files of sums.
    pub name: &'static str,
    /// What its numbers are summed as.
    pub scale: Scale,
    /// Where they come from.
    pub source: Source,
}

impl PartialEq for Channel {
    fn eq(&self, o: &Self) -> bool {
        self.name == o.name
    }
}

/// What numbers are summed as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Numbers of [-4, 4], in units of 2^-40.
    Unit,
    /// Numbers from 0 to 2^32, in units of 2^-62.
    Length,
    /// Integers.
    Count,
}

/// Where a channel's numbers come from.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// The surface that the camera's ray met first; 0 where it met nothing. Held by films that keep layers.
    FirstHit(fn(&FirstHit) -> [f32; 3]),
    /// The searches of all rays of a sample. Held by films that count costs.
    Search(fn(&CostSample) -> u64),
}

/// What a camera's ray met first.
pub struct FirstHit {
    /// Share of light that the surface reflects or passes on, linear RGB.
    pub albedo: [f32; 3],
    /// Unit shading normal in world space.
    pub normal: Vec3,
    /// Distance from the camera in metres.
    pub distance: f32,
}

/// Share of light that the first surface reflects or passes on, linear RGB; the radiance of what emits is no part.
pub static ALBEDO: Channel = Channel {
    layer: "albedo",
    components: &["R", "G", "B"],
    name: "albedo",
    scale: Scale::Unit,
    source: Source::FirstHit(|hit| hit.albedo),
};

/// Unit shading normal of the first surface in world space.
pub static NORMAL: Channel = Channel {
    layer: "normal",
    components: &["X", "Y", "Z"],
    name: "normal",
    scale: Scale::Unit,
    source: Source::FirstHit(|hit| hit.normal.to_array()),
};

/// Distance from the camera to the first surface in metres.
pub static DEPTH: Channel = Channel {
    layer: "depth",
    components: &["Z"],
    name: "depth",
    scale: Scale::Length,
    source: Source::FirstHit(|hit| [hit.distance, 0.0, 0.0]),
};

/// Nodes opened, or cells entered.
pub static NODES: Channel = Channel {
    layer: "cost",
    components: &["nodes"],
    name: "nodes",
    scale: Scale::Count,
    source: Source::Search(|cost| cost.nodes),
};

/// Primitives tested.
pub static PRIMITIVES: Channel = Channel {
    layer: "cost",
    components: &["primitives"],
    name: "primitives",
    scale: Scale::Count,
    source: Source::Search(|cost| cost.primitives),
};

/// Nanoseconds spent in search; a layer where a clock was lent.
pub static TIME: Channel = Channel {
    layer: "cost",
    components: &["time"],
    name: "nanoseconds",
    scale: Scale::Count,
    source: Source::Search(|cost| cost.nanoseconds),
};

/// All channels.
pub static CHANNELS: [&Channel; 6] = [&ALBEDO, &NORMAL, &DEPTH, &NODES, &PRIMITIVES, &TIME];

/// What a sample has for each channel, in the order of [`CHANNELS`]; of those from the first hit.
pub type Seen = [[f32; 3]; CHANNELS.len()];

/// What the channels have of a first hit.
pub(crate) fn see(hit: &FirstHit) -> Seen {
    CHANNELS.map(|channel| match channel.source {
        Source::FirstHit(of) => of(hit),
        Source::Search(_) => [0.0; 3],
    })
}

impl Channel {
    /// Whether a film holds it, that keeps layers and that counts costs, or doesn't.
    pub(super) fn is_held(&self, layers: bool, costs: bool) -> bool {
        match self.source {
            Source::FirstHit(_) => layers,
            Source::Search(_) => costs,
        }
    }

    /// Bytes of its sums for one pixel.
    pub(super) fn bytes(&self) -> usize {
        let each = match self.scale {
            Scale::Unit => size_of::<Guide>(),
            Scale::Length => size_of::<Fixed>(),
            Scale::Count => size_of::<u64>(),
        };
        each * self.components.len()
    }
}

/// Channels that a film holds, with their places in [`CHANNELS`].
pub fn held(layers: bool, costs: bool) -> impl Iterator<Item = (usize, &'static Channel)> {
    CHANNELS.into_iter().enumerate().filter(move |(_, channel)| channel.is_held(layers, costs))
}

/// The sums of one channel over a tile.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    pub channel: &'static Channel,
    /// Its place in [`CHANNELS`].
    place: usize,
    /// By pixel and component.
    sums: Sums,
}

#[derive(Clone, Debug)]
enum Sums {
    Unit(Vec<Guide>),
    Length(Vec<Fixed>),
    Count(Vec<u64>),
}

/// One sum of a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sum {
    Unit(i64),
    Length(i128),
    Count(u64),
}

impl Plane {
    /// Nothing, for so many pixels.
    pub fn new(place: usize, channel: &'static Channel, pixels: usize) -> Self {
        let n = pixels * channel.components.len();
        let sums = match channel.scale {
            Scale::Unit => Sums::Unit(vec![Guide::default(); n]),
            Scale::Length => Sums::Length(vec![Fixed::default(); n]),
            Scale::Count => Sums::Count(vec![0; n]),
        };
        Self { channel, place, sums }
    }

    /// Adds what a sample of pixel `k` has seen.
    pub fn add_seen(&mut self, k: usize, seen: &Seen) {
        let each = self.channel.components.len();
        let (range, new) = (k * each..(k + 1) * each, &seen[self.place]);
        match &mut self.sums {
            Sums::Unit(sums) => sums[range].iter_mut().zip(new).for_each(|(sum, v)| sum.add(*v)),
            // A plane's horizon may be farther than the film can hold: it says as far as it can.
            Sums::Length(sums) => {
                { sums[range].iter_mut().zip(new) }
                    .for_each(|(sum, v)| sum.add(ops::clamp(*v, 0.0, MAX_VALUE)));
            }
            Sums::Count(_) => {}
        }
    }

    /// Adds what the searches of a sample of pixel `k` have cost.
    pub fn add_cost(&mut self, k: usize, cost: &CostSample) {
        if let (Sums::Count(sums), Source::Search(of)) = (&mut self.sums, self.channel.source) {
            sums[k] += of(cost);
        }
    }

    /// A component's sum of pixel `k`.
    pub fn sum(&self, k: usize, component: usize) -> f64 {
        let i = k * self.channel.components.len() + component;
        match &self.sums {
            Sums::Unit(sums) => sums[i].to_f64(),
            Sums::Length(sums) => sums[i].to_f64(),
            Sums::Count(sums) => sums[i] as f64,
        }
    }

    /// The sums of pixel `k` as integers.
    pub fn record(&self, k: usize) -> impl Iterator<Item = Sum> {
        let each = self.channel.components.len();
        (k * each..(k + 1) * each).map(|i| match &self.sums {
            Sums::Unit(sums) => Sum::Unit(sums[i].0),
            Sums::Length(sums) => Sum::Length(sums[i].0),
            Sums::Count(sums) => Sum::Count(sums[i]),
        })
    }

    /// Takes the sums of pixel `k` from such a record, in place of its own.
    pub fn put(&mut self, k: usize, record: &mut impl Iterator<Item = Sum>) {
        let each = self.channel.components.len();
        for (i, sum) in (k * each..(k + 1) * each).zip(record) {
            match (&mut self.sums, sum) {
                (Sums::Unit(sums), Sum::Unit(v)) => sums[i] = Guide(v),
                (Sums::Length(sums), Sum::Length(v)) => sums[i] = Fixed(v),
                (Sums::Count(sums), Sum::Count(v)) => sums[i] = v,
                _ => {}
            }
        }
    }
}

/// A record of nothing, of a film that keeps layers and that counts costs, or doesn't.
pub(super) fn empty_record(layers: bool, costs: bool) -> Vec<Sum> {
    let nothing = |channel: &Channel| match channel.scale {
        Scale::Unit => Sum::Unit(0),
        Scale::Length => Sum::Length(0),
        Scale::Count => Sum::Count(0),
    };
    held(layers, costs).flat_map(|(_, c)| std::iter::repeat_n(nothing(c), c.components.len())).collect()
}

/// The mean of a channel's numbers over the samples of each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelLayer {
    /// Which channel.
    pub channel: &'static Channel,
    /// By pixel, then by component.
    pub values: Vec<f32>,
}

impl ChannelLayer {
    /// One component by pixel.
    pub fn component(&self, component: usize) -> impl Iterator<Item = f32> {
        self.values.iter().copied().skip(component).step_by(self.channel.components.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whoever reads an EXR or a file of sums knows a channel by its name alone.
    #[test]
    fn names_are_unique_and_components_few() {
        for (i, a) in CHANNELS.iter().enumerate() {
            assert!((1..=3).contains(&a.components.len()), "{}", a.name);
            assert!(matches!(a.source, Source::Search(_)) == (a.scale == Scale::Count), "{}", a.name);
            for b in &CHANNELS[..i] {
                assert_ne!(a.name, b.name);
                assert!(a.layer != b.layer || a.components[0] != b.components[0], "{}", a.name);
            }
        }
    }
}
