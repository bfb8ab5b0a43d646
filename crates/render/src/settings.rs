//! What a render is asked for, apart from the world.

use crate::film::{DISTRICT, ErrorEstimate, Extent, Keep, Recording, Region, reach};
use crate::integrator::Integrator;
use straal_math::lowdisc::Pattern;

/// What the layers of albedo and normals are of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Guides {
    /// The first surface that the camera's ray meets.
    #[default]
    First,
    /// The first that scatters, by way of mirrors and glass; what shines and the surroundings have albedo 1.
    Specular,
}

impl Guides {
    /// Both.
    pub const ALL: [Self; 2] = [Self::First, Self::Specular];

    /// The name as it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::First => "first",
            Self::Specular => "specular",
        }
    }
}

/// How a picture is sampled and on how many threads; none but `size`, `pattern`, `seed` and `splat` changes the value of a
/// sample; `noise` says how many there are.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Width and height of the whole picture in pixels.
    pub size: [u32; 2],
    /// The part to render.
    pub crop: Region,
    /// Where sample positions and all other random numbers come from.
    pub pattern: Pattern,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Ends sampling, block by block, where the relative standard error is at most this (see [`crate::film`]).
    pub noise: Option<f64>,
    /// Tells each pixel's standard error ([`crate::film::Layers::error`]): 48 bytes a pixel more where that takes batches.
    pub error: bool,
    /// Holds what it takes to have the picture as the mean of two of other samples ([`crate::film::Film::halves`]).
    pub halves: bool,
    /// What the layers of albedo and normals are of.
    pub guides: Guides,
    /// Keeps all layers ([`crate::film::Layers`]), or colours alone.
    pub layers: bool,
    /// Whether samples are drawn by a filter that has negative lobes.
    pub signed: bool,
    /// Lets a sample count in all pixels whose filter reaches it, in place of one pixel whose filter it is drawn by.
    pub splat: bool,
    /// Worker threads; 0 for all cores.
    pub threads: usize,
    /// Paths that travel together.
    pub batch: usize,
    /// Renders the tiles in an order shuffled by this seed: for tests, since it must change nothing.
    pub shuffle_tiles: Option<u64>,
    /// How many groups of lights are told apart ([`crate::light::Groups`]), where the integrator knows what light comes from which; 0 for none.
    pub light_groups: usize,
    /// Counts what the searches of each pixel cost ([`crate::film::channel::NODES`] and the like); slower, and the same picture.
    pub cost: bool,
    /// Lets blocks be ended by who asks for the render ([`crate::driver::Render::end_blocks`]).
    pub blocks: bool,
}

impl Settings {
    /// By what noise is told: samples that count in several pixels keep no order to be cut into batches by, and what the weights of
    /// a filter with negative lobes owe to chance is known for all samples together.
    pub const fn error_estimate(&self) -> ErrorEstimate {
        let apart = self.splat || (self.signed && !self.adapts());
        if apart { ErrorEstimate::Spread } else { ErrorEstimate::of(self.pattern.kind()) }
    }

    /// Whether blocks end one by one.
    pub const fn adapts(&self) -> bool {
        self.noise.is_some() || self.blocks
    }

    /// Whether the film holds batches.
    pub fn holds_batches(&self) -> bool {
        let by_batches = self.error_estimate() == ErrorEstimate::Batches;
        (self.error || self.adapts()) && by_batches || self.halves && !self.splat && !self.adapts()
    }

    /// How many groups of lights an integrator's film tells apart.
    pub(crate) const fn light_groups_of<I: Integrator>(&self) -> usize {
        if I::LIGHT_GROUPS { self.light_groups } else { 0 }
    }

    /// The part of the picture that is rendered, which the crop lies in; `filter_radius` in pixels.
    pub fn rendered(&self, filter_radius: f64) -> Region {
        match self.noise {
            // Blocks end by what their district shows, so that one that is cut by the crop is rendered as a whole.
            Some(_) => self.crop.in_squares(DISTRICT, self.size),
            // Samples beyond the crop count in it.
            None if self.splat => {
                self.crop.grown(reach(filter_radius)).intersection(Region::whole(self.size))
            }
            None => self.crop,
        }
    }

    /// What the film holds, for a forecast of its size.
    pub fn extent(&self, recording: Recording, filter_radius: f64) -> Extent {
        let Keep { squares, layers } = self.keep();
        Extent {
            recording,
            splat_radius: self.splat.then_some(filter_radius),
            batches: self.holds_batches(),
            squares,
            layers,
            cost: self.cost,
            signed: self.signed,
            adapts: self.adapts(),
            light_splats: false,
            light_groups: self.light_groups,
        }
    }

    /// What the film holds besides light. Variance by splatting is told from the spread of each pixel's own samples, and blocks end by it as well.
    pub(crate) fn keep(&self) -> Keep {
        let spread = self.error_estimate() == ErrorEstimate::Spread && self.error;
        Keep { squares: self.layers || spread || self.adapts(), layers: self.layers }
    }

    /// The whole of a picture of the given size, with the default pattern on all cores.
    pub fn new(size: [u32; 2]) -> Self {
        Self {
            size,
            crop: Region::whole(size),
            pattern: Pattern::Sobol,
            seed: 0,
            noise: None,
            error: false,
            halves: false,
            guides: Guides::First,
            layers: true,
            signed: false,
            splat: false,
            threads: 0,
            batch: 1024,
            shuffle_tiles: None,
            light_groups: 0,
            cost: false,
            blocks: false,
        }
    }
}
