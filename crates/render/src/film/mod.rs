//! The film: what every pixel has gathered.
//!
//! Film sums are associative, so that threads, tiles, batches, shards and interruptions can't change a bit
//! (ARCHITECTURE.md, "Same bits"): each sample's numbers are rounded once to fixed point and added as integers.

mod adaptive;
pub mod channel;
mod control;
mod district;
mod error_estimate;
mod fixed;
mod halves;
mod hash;
mod light_sum;
mod many;
mod planes;
mod recording;
mod region;
mod sensor;
mod splat;
mod sums;

pub use adaptive::{BLOCK, DARK, FIRST_CHECK};
pub use channel::{Channel, ChannelLayer};
pub use district::DISTRICT;
pub use error_estimate::ErrorEstimate;
pub use fixed::{MAX_SAMPLES, MAX_VALUE};
pub use halves::Halves as HalfPictures;
pub use hash::hash_of;
pub use light_sum::{LightSum, Provenance, SampleSums};
pub use recording::Recording;
pub use region::Region;
pub use sensor::Sensor;
pub use splat::{Flying, Splats, reach};
pub use sums::{Held, Joined, Span};

use crate::filter::Filter;
use adaptive::Halves;
pub(crate) use adaptive::Sampled;
pub(crate) use adaptive::{named_by, next_check};
use channel::{Plane, Seen};
use control::Control;
use error_estimate::BatchSums;
use fixed::{Fixed, Square};
pub(crate) use many::Many;
use straal_color::spectrum::Bands;
use straal_math::simd::Simd;

/// Side of a tile in pixels. Tiles are aligned to the whole picture, so that a crop renders the same tiles.
pub const TILE: u32 = 16;

/// One sample as the film takes it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample<'a> {
    /// Radiance: linear RGB, or X, Y and Z, see [`Recording`].
    pub rgb: [f32; 3],
    /// What the camera's ray met first, where anybody asks.
    pub seen: Option<&'a Seen>,
    /// Whether the filter gave its light a negative weight.
    pub negative: bool,
}

/// Sums of one pixel that every film holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Pixel {
    value: [Fixed; 3],
    /// Samples taken, the dropped included.
    count: u32,
    /// Samples that were not finite or beyond the film's range: they count as 0.
    dropped: u32,
}

impl Pixel {
    /// The mean of a channel.
    fn mean(&self, channel: usize) -> f64 {
        self.value[channel].to_f64() / f64::from(self.count.max(1))
    }

    /// The variance of a channel's mean, estimated from the samples' spread; 0 for a single sample.
    fn variance(&self, squares: &[Square; 3], channel: usize) -> f64 {
        let count = f64::from(self.count.max(1));
        let mean = self.mean(channel);
        let spread = squares[channel].to_f64() / count - mean * mean;
        if self.count > 1 && spread > 0.0 { spread / (count - 1.0) } else { 0.0 }
    }
}

/// What a film holds of each pixel besides its light: a picture that keeps to colours needs neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Keep {
    /// Squares of light, by which its variance is told.
    pub squares: bool,
    /// All that [`Layers`] has besides colours; with squares.
    pub layers: bool,
}

impl Keep {
    /// All that there is.
    pub const ALL: Self = Self { squares: true, layers: true };
}

/// What one sample adds to a part of the light that the film tells apart: a band of wavelengths, or a colour of a group of lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BandSample {
    /// Which: the bands come first, then three for each group.
    pub band: u16,
    /// Radiance.
    pub value: f32,
}

/// What the searches of one sample cost: all rays of its path, the camera's, the bounces and the shadow rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CostSample {
    /// Nodes opened, or cells entered.
    pub nodes: u64,
    /// Primitives tested.
    pub primitives: u64,
    /// Time spent in search; 0 without a clock.
    pub nanoseconds: u64,
}

/// The part of a film under one tile.
#[derive(Clone, Debug)]
pub struct FilmTile {
    /// Pixels covered, in coordinates of the whole picture.
    pub region: Region,
    pixels: Vec<Pixel>,
    /// Sums of squares by pixel; empty when nothing asks for them.
    squares: Vec<[Square; 3]>,
    /// What else is held of each pixel.
    channels: Vec<Plane>,
    /// Light that paths brought which are not the pixel's own, by pixel; empty where there are no such paths.
    light_splats: Vec<[Fixed; 3]>,
    /// By pixel, as many as there are bands, of wavelengths and of groups of lights; empty when there are none.
    bands: Vec<Fixed>,
    /// What of these is no sample's of the pixel; empty unless there are bands and such light.
    band_splats: Vec<Fixed>,
    /// Where samples count in several pixels.
    splats: Option<Splats>,
    /// The first sample (in order of pixel and index) that was dropped: pixel and sample index.
    first_dropped: Option<([u32; 2], u32)>,
    sampled: Sampled,
    /// Index of the first sample.
    first: u32,
    /// By pixel; empty unless noise is told by batches.
    batch_sums: Vec<BatchSums>,
    /// The same of samples that are not the first of their pixel.
    ends: Vec<BatchSums<Fixed>>,
    /// By pixel; empty unless the filter has negative lobes.
    controls: Vec<Control>,
    /// By pixel and band, what samples of negative weight brought; empty unless there are bands and controls.
    negative_bands: Vec<Fixed>,
    /// By pixel and band, what samples of the second half brought, and those of negative weight among them; empty unless there are bands
    /// and halves.
    second_bands: [Vec<Fixed>; 2],
    /// Size of the samples' weights, see [`Control`].
    weight: f64,
    /// By pixel; empty unless blocks end by themselves.
    halves: Vec<Halves>,
    /// Whether the noise of halves is told by batches.
    by_batches: bool,
}

impl FilmTile {
    fn new(region: Region, keep: Keep) -> Self {
        let of = |kept: bool| if kept { region.area() } else { 0 };
        Self {
            region,
            pixels: vec![Pixel::default(); region.area()],
            squares: vec![Default::default(); of(keep.squares || keep.layers)],
            channels: channel::held(keep.layers, false)
                .map(|(place, channel)| Plane::new(place, channel, region.area()))
                .collect(),
            light_splats: Vec::new(),
            bands: Vec::new(),
            band_splats: Vec::new(),
            splats: None,
            first_dropped: None,
            sampled: Sampled::default(),
            first: 0,
            batch_sums: Vec::new(),
            ends: Vec::new(),
            controls: Vec::new(),
            negative_bands: Vec::new(),
            second_bands: Default::default(),
            weight: 1.0,
            halves: Vec::new(),
            by_batches: false,
        }
    }

    /// Where a pixel of the whole picture stands in the tile.
    #[inline(always)]
    pub(crate) fn index(&self, [x, y]: [u32; 2]) -> usize {
        (y - self.region.min[1]) as usize * self.region.width() as usize + (x - self.region.min[0]) as usize
    }

    /// Adds what one sample of a pixel cost, where the film counts that; the sums of integers don't depend on the order.
    pub fn add_cost(&mut self, pixel: [u32; 2], cost: &CostSample) {
        let k = self.index(pixel);
        self.channels.iter_mut().for_each(|plane| plane.add_cost(k, cost));
    }

    /// Adds light to a pixel that no sample of it has brought, and to three bands from `band` on if it is of a group; false where it
    /// doesn't fit.
    pub(crate) fn add_light_splat(&mut self, pixel: [u32; 2], rgb: [f32; 3], band: Option<usize>) -> bool {
        let k = self.index(pixel);
        let fits = rgb.iter().all(|v| v.abs() < MAX_VALUE);
        if let Some(sums) = self.light_splats.get_mut(k).filter(|_| fits) {
            sums.iter_mut().zip(rgb).for_each(|(sum, v)| sum.add(v));
            if let Some(band) = band {
                let of_each = self.band_splats.len() / self.pixels.len();
                let sums = self.band_splats.iter_mut().skip(k * of_each + band);
                sums.zip(rgb).for_each(|(sum, v)| sum.add(v));
            }
        }
        fits
    }

    /// The sums of samples that count in several pixels, where the film has such.
    pub fn splats(&mut self) -> Option<&mut Splats> {
        self.splats.as_mut()
    }

    /// Makes ready to tell noise by batches.
    fn mark_batches(&mut self) {
        self.batch_sums = vec![BatchSums::default(); self.pixels.len()];
    }

    /// Makes ready for samples that weigh plus or minus `weight`; bands, if any, are held before.
    fn control(&mut self, weight: f64) {
        self.controls = vec![Control::default(); self.pixels.len()];
        self.negative_bands = vec![Fixed::default(); self.bands.len()];
        self.weight = weight;
    }

    /// The sums of a pixel, or of a part of its samples.
    fn sums_of(&self, p: &Pixel, control: Option<&Control>) -> [f64; 3] {
        match control {
            Some(control) => std::array::from_fn(|c| control.sum(p, c, self.weight)),
            None => p.value.map(Fixed::to_f64),
        }
    }

    /// The mean of a channel of pixel `k`.
    fn mean(&self, k: usize, channel: usize) -> f64 {
        let p = &self.pixels[k];
        match self.mean_of_halves(k, channel, false).filter(|_| !self.is_even(k)) {
            Some((mean, _)) => mean,
            None => {
                let splats = self.light_splats.get(k).map_or(0.0, |sums| sums[channel].to_f64());
                (self.sums_of(p, self.controls.get(k))[channel] + splats) / f64::from(p.count.max(1))
            }
        }
    }

    /// The variance of the mean of a channel of pixel `k`, by what the film has to tell it.
    fn variance_of_mean(&self, k: usize, channel: usize) -> f64 {
        if let Some((_, variance)) = self.mean_of_halves(k, channel, self.by_batches) {
            return variance;
        }
        match self.batch_sums.get(k) {
            Some(sums) => {
                let p = &self.pixels[k];
                sums.variance(p.count, p.value[channel].to_f64(), channel)
            }
            None => self.variance_by_spread(k, channel),
        }
    }

    /// The same by the spread of samples; 0 where the film has no squares.
    fn variance_by_spread(&self, k: usize, channel: usize) -> f64 {
        let Some(squares) = self.squares.get(k) else { return 0.0 };
        if let Some((_, variance)) = self.mean_of_halves(k, channel, false).filter(|_| !self.is_even(k)) {
            return variance;
        }
        let p = &self.pixels[k];
        match self.controls.get(k) {
            Some(control) => control.variance((p, squares), channel, self.weight),
            None => p.variance(squares, channel),
        }
    }

    /// The mean of a band of pixel `k`, of `of_each` bands, made as [`Self::mean`] is.
    fn band_mean(&self, k: usize, band: usize, of_each: usize) -> f64 {
        let i = k * of_each + band;
        let p = &self.pixels[k];
        if let Some(mean) = self.band_mean_of_halves(k, i).filter(|_| !self.is_even(k)) {
            return mean;
        }
        let sum = match (self.controls.get(k), self.negative_bands.get(i)) {
            (Some(control), Some(negative)) => control.sum_of(p, [self.bands[i], *negative], self.weight),
            _ => self.bands[i].to_f64(),
        };
        (sum + self.band_splats.get(i).map_or(0.0, |v| v.to_f64())) / f64::from(p.count.max(1))
    }

    /// Adds one sample of a pixel given in coordinates of the whole picture; `bands` is empty unless the film has some. False
    /// where it was dropped. Where noise is told by batches, a pixel's samples come in the order of their indices.
    #[inline(always)]
    pub fn add(&mut self, pixel: [u32; 2], index: u32, sample: &Sample<'_>, bands: &[BandSample]) -> bool {
        let i = self.index(pixel);
        let is_sound = sample.rgb.iter().fold(true, |all, v| all & (v.abs() < MAX_VALUE));
        if !is_sound | !bands.is_empty() | !self.holds_light_alone() {
            return self.add_with_more((i, pixel, index), sample, bands);
        }
        let p = &mut self.pixels[i];
        p.count += 1;
        for (sum, v) in p.value.iter_mut().zip(sample.rgb) {
            sum.add(v);
        }
        true
    }

    /// Whether samples go to nothing but the pixels' light and to bands.
    #[inline(always)]
    pub(crate) fn holds_light_alone(&self) -> bool {
        let Self { squares, channels, batch_sums, ends, controls, halves, .. } = self;
        (squares.len() | channels.len() | batch_sums.len() | ends.len() | controls.len() | halves.len()) == 0
    }

    /// [`Self::add`] of a sample that may be dropped, or to a film that holds more than light.
    #[inline(never)]
    fn add_with_more(
        &mut self,
        (i, pixel, index): (usize, [u32; 2], u32),
        sample: &Sample<'_>,
        bands: &[BandSample],
    ) -> bool {
        let of_each = if bands.is_empty() { 0 } else { self.bands.len() / self.pixels.len() };
        if !self.halves.is_empty() {
            self.note_half(i, index);
        }
        let p = &mut self.pixels[i];
        if let Some(sums) = self.batch_sums.get_mut(i) {
            sums.note(p.count, &p.value);
        } else if let Some(ends) = self.ends.get_mut(i) {
            ends.note(self.first + p.count, &p.value);
        }
        p.count += 1;
        let fits = |v: f32| v.abs() < MAX_VALUE;
        let [red, green, blue] = sample.rgb.map(fits);
        if !(red & green & blue) || !bands.iter().all(|b| fits(b.value)) {
            p.dropped += 1;
            let at = (pixel, index);
            let order = |(p, i): ([u32; 2], u32)| (p[1], p[0], i);
            if self.first_dropped.is_none_or(|first| order(at) < order(first)) {
                self.first_dropped = Some(at);
            }
            return false;
        }
        for c in 0..3 {
            p.value[c].add(sample.rgb[c]);
        }
        if let Some(squares) = self.squares.get_mut(i) {
            for (square, v) in squares.iter_mut().zip(sample.rgb) {
                square.add(v);
            }
        }
        if let Some(seen) = sample.seen {
            self.channels.iter_mut().for_each(|plane| plane.add_seen(i, seen));
        }
        for b in bands {
            self.bands[i * of_each + usize::from(b.band)].add(b.value);
        }
        if let Some(control) = self.controls.get_mut(i).filter(|_| sample.negative) {
            control.add(sample.rgb);
            for b in bands {
                self.negative_bands[i * of_each + usize::from(b.band)].add(b.value);
            }
        }
        if !self.halves.is_empty() {
            self.add_to_half(i, index, (sample.rgb, sample.negative), bands);
        }
        true
    }
}

/// The sums of a picture or of a crop of it.
#[derive(Clone, Debug)]
pub struct Film {
    /// Size of the whole picture in pixels.
    pub size: [u32; 2],
    /// The part of it that is rendered.
    pub crop: Region,
    pub(crate) tiles: Vec<FilmTile>,
    keep: Keep,
    /// By how many pixels two are apart: the mean square of the filter's height, where samples are splatted.
    mean_squares: Vec<f64>,
    /// Whether costs are counted, and whether with their time.
    costs: Costs,
    /// Bands of wavelengths that are held besides RGB.
    bands: Option<Bands>,
    /// Names of the groups of lights whose light is held apart; empty if it isn't.
    groups: Vec<String>,
    /// By what pixels tell their standard error, if they do.
    error: Option<ErrorEstimate>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Costs {
    No,
    Tests,
    TestsAndTime,
}

/// What a film holds beyond colours and guides, for a forecast of its size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// In which numbers it takes light.
    pub recording: Recording,
    /// Radius of the filter in pixels where samples are splatted.
    pub splat_radius: Option<f64>,
    /// Whether noise is told by batches.
    pub batches: bool,
    /// Whether sums of squares are held.
    pub squares: bool,
    /// Whether all layers are held, with squares, or colours alone.
    pub layers: bool,
    /// Whether costs are counted.
    pub cost: bool,
    /// Whether samples are drawn by a filter that has negative lobes.
    pub signed: bool,
    /// Whether blocks end by themselves.
    pub adapts: bool,
    /// Whether light is brought by paths that are no pixel's own.
    pub light_splats: bool,
    /// How many groups of lights are told apart.
    pub light_groups: usize,
}

impl Extent {
    /// How many bands there are, of wavelengths and of groups of lights.
    fn bands(&self) -> usize {
        self.recording.bands().map_or(0, Bands::count) + 3 * self.light_groups
    }
}

/// Samples that a film refused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// How many samples were not finite, or of 2^32 or more.
    pub count: u64,
    /// Where the first was: pixel of the whole picture, sample index.
    pub first: Option<([u32; 2], u32)>,
}

/// A film's layers as numbers, row by row from the top; each as large as the crop, or empty (all but `rgb`) if the film keeps
/// to colours.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// Width of the crop.
    pub width: usize,
    /// Height of the crop.
    pub height: usize,
    /// Mean radiance: linear RGB, or X, Y and Z.
    pub rgb: Vec<[f32; 3]>,
    /// Variance of that mean, estimated from the samples' spread; 0 for a single sample.
    pub variance: Vec<[f32; 3]>,
    /// Standard error of that mean, if the film holds it.
    pub error: Option<ErrorLayer>,
    /// Samples taken.
    pub samples: Vec<u32>,
    /// What else the film holds, in the order of [`channel::CHANNELS`]. No part of the film's hash.
    pub channels: Vec<ChannelLayer>,
    /// Light by wavelengths, if the film holds it. No part of the film's hash.
    pub bands: Option<BandLayers>,
    /// Light by groups of lights, if the film holds it: they add up to `rgb`. And what was taken away, if any may be. No part of the film's hash.
    pub groups: Vec<GroupLayer>,
}

impl Layers {
    /// The share of the light that a limit took away, where there was one.
    pub fn clamped(&self) -> Option<f64> {
        let taken = &self.groups.iter().find(|group| group.name == CLAMPED)?.rgb;
        let sum = |rgb: &[[f32; 3]]| rgb.as_flattened().iter().map(|v| f64::from(*v)).sum::<f64>();
        let (taken, left) = (sum(taken), sum(&self.rgb));
        Some(if taken > 0.0 { taken / (taken + left) } else { 0.0 })
    }

    /// What the film tells of a channel; `None` where it doesn't hold it.
    pub fn channel(&self, channel: &Channel) -> Option<&ChannelLayer> {
        self.channels.iter().find(|layer| layer.channel == channel)
    }
}

/// How far pixels are from what they would be with endless samples.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorLayer {
    /// By what it is told.
    pub estimate: ErrorEstimate,
    /// Standard error of each pixel's mean; 0 for a single sample.
    pub rgb: Vec<[f32; 3]>,
}

/// Mean radiance in bands of wavelengths.
#[derive(Clone, Debug, PartialEq)]
pub struct BandLayers {
    /// Which bands.
    pub bands: Bands,
    /// By band, then by pixel.
    pub planes: Vec<Vec<f32>>,
}

/// What stands in the place of a group's name for light that was taken away by a limit; no group can be called so.
pub const CLAMPED: &str = "=clamped";

/// The light of a group of lights, or what was taken away ([`CLAMPED`]).
#[derive(Clone, Debug, PartialEq)]
pub struct GroupLayer {
    /// The group's name.
    pub name: String,
    /// Mean radiance: linear RGB, or X, Y and Z.
    pub rgb: Vec<[f32; 3]>,
}

impl Film {
    /// An empty film for the part `crop` of a picture.
    pub fn new(size: [u32; 2], crop: Region) -> Self {
        Self::over(size, [crop, crop], Keep::ALL)
    }

    /// The same where more than the crop is rendered: all of `region`, which the crop lies in.
    pub(crate) fn over(size: [u32; 2], [crop, region]: [Region; 2], keep: Keep) -> Self {
        let mut tiles = Vec::new();
        for ty in region.min[1] / TILE..region.max[1].div_ceil(TILE) {
            for tx in region.min[0] / TILE..region.max[0].div_ceil(TILE) {
                let tile = Region {
                    min: [tx * TILE, ty * TILE],
                    max: [tx + 1, ty + 1].map(|v| v.saturating_mul(TILE)),
                };
                let part = tile.intersection(region);
                if part.area() > 0 {
                    tiles.push(FilmTile::new(part, keep));
                }
            }
        }
        Self {
            size,
            crop,
            tiles,
            keep,
            mean_squares: Vec::new(),
            costs: Costs::No,
            bands: None,
            groups: Vec::new(),
            error: None,
        }
    }

    /// Makes room for batches, by which noise is told then.
    pub(crate) fn hold_batches(&mut self) {
        self.tiles.iter_mut().for_each(FilmTile::mark_batches);
    }

    /// Lets layers have the standard error; batches, if it is by these, are held before.
    pub(crate) fn tell_error(&mut self, by: ErrorEstimate) {
        self.error = Some(by);
    }

    /// How many blocks need further samples, of a film that adapts.
    pub fn open_blocks(&self) -> u64 {
        self.tiles.iter().map(|t| u64::from(t.open_blocks())).sum()
    }

    /// Makes room for samples that count in all pixels that a filter reaches from, added by some instruction set; bands, if any, are
    /// held before.
    pub(crate) fn splat(&mut self, filter: &Filter, simd: Simd) {
        let bands = self.bands_of_each();
        self.hold_mean_squares(filter);
        for tile in &mut self.tiles {
            tile.splats = Some(Splats::new(tile.region, self.size, filter, bands, simd));
        }
    }

    /// Makes room for bands of wavelengths, and for the light of groups of lights.
    pub(crate) fn hold_bands(&mut self, bands: Option<Bands>, groups: &[String]) {
        (self.bands, self.groups) = (bands, groups.to_vec());
        let of_each = self.bands_of_each();
        for tile in &mut self.tiles {
            tile.bands = vec![Fixed::default(); tile.region.area() * of_each];
        }
    }

    /// How many bands there are, of wavelengths and of groups of lights.
    fn bands_of_each(&self) -> usize {
        self.bands.as_ref().map_or(0, Bands::count) + 3 * self.groups.len()
    }

    /// Makes ready for a filter's samples of plus or minus some weight; bands, if any, are held before.
    pub(crate) fn control(&mut self, weight: f64) {
        self.tiles.iter_mut().for_each(|tile| tile.control(weight));
    }

    /// Makes room for costs; `timed` says whether they come with their time.
    pub(crate) fn count_costs(&mut self, timed: bool) {
        self.costs = if timed { Costs::TestsAndTime } else { Costs::Tests };
        for tile in &mut self.tiles {
            let pixels = tile.region.area();
            let new = channel::held(false, true).map(|(place, channel)| Plane::new(place, channel, pixels));
            tile.channels.extend(new);
        }
    }

    /// Makes room for light from paths that are no pixel's own; bands, if any, are held before.
    pub(crate) fn hold_light_splats(&mut self) {
        for tile in &mut self.tiles {
            tile.light_splats = vec![Default::default(); tile.region.area()];
            tile.band_splats = vec![Fixed::default(); tile.bands.len()];
        }
    }

    /// Bytes that a film takes for a rendered region of a picture of some size.
    pub fn bytes(of: &Extent, region: Region, size: [u32; 2]) -> u64 {
        let reach = of.splat_radius.map_or(0, splat::reach);
        // Columns, or rows, of all tiles, and of all with their aprons.
        let sides = [0, 1].map(|axis| {
            let mut sums = [0_u64; 3];
            let (mut at, end) = (region.min[axis], region.max[axis].min(size[axis]));
            while at < end {
                let next = (at / TILE + 1).saturating_mul(TILE).min(end);
                let apron = next.saturating_add(reach).min(size[axis]) - at.saturating_sub(reach);
                sums = [sums[0] + u64::from(next - at), sums[1] + u64::from(apron), sums[2] + 1];
                at = next;
            }
            sums
        });
        let [pixels, aprons, tiles] = [0, 1, 2].map(|k| sides[0][k].saturating_mul(sides[1][k]));
        let bands = of.bands();
        let splats = of.splat_radius.map_or(0, |_| aprons.saturating_mul(splat::bytes_a_pixel(bands) as u64));
        // A tile, its place in the order of tiles, and its lock while a pass is made.
        let each = (size_of::<FilmTile>() + 4 + 24) as u64;
        let of_pixels = pixels.saturating_mul(Self::bytes_a_pixel(of) as u64);
        of_pixels.saturating_add(splats).saturating_add(tiles.saturating_mul(each))
    }

    /// Bytes that a pixel's batches take, wherever they are kept.
    pub const BATCH_BYTES: usize = size_of::<BatchSums>();

    /// Bytes that a film takes for each pixel, but for what splatting takes beyond that.
    pub fn bytes_a_pixel(of: &Extent) -> usize {
        let bands = of.bands() * size_of::<Fixed>();
        let held = |is: bool, bytes: usize| if is { bytes } else { 0 };
        size_of::<Pixel>()
            + held(of.squares || of.layers, size_of::<[Square; 3]>())
            + channel::held(of.layers, of.cost).map(|(_, channel)| channel.bytes()).sum::<usize>()
            + held(of.batches && !of.adapts, Self::BATCH_BYTES)
            + held(of.adapts, size_of::<Halves>() + bands)
            + held(of.light_splats, size_of::<[Fixed; 3]>() + bands)
            + held(of.signed, size_of::<Control>() + bands)
            + held(of.signed && of.adapts, bands)
            + bands
    }

    /// Samples that were dropped, and where the first was.
    pub fn dropped(&self) -> Dropped {
        let count = self.tiles.iter().flat_map(|t| &t.pixels).map(|p| u64::from(p.dropped)).sum();
        let first = self.tiles.iter().filter_map(|t| t.first_dropped).min_by_key(|(p, i)| (p[1], p[0], *i));
        Dropped { count, first }
    }

    /// Bytes that [`Layers`] take for each pixel of the crop; `error` and `timed` say whether errors and times of searches are
    /// told.
    pub fn layer_bytes_a_pixel(of: &Extent, [error, timed]: [bool; 2]) -> usize {
        let held = |is: bool, numbers: usize| if is { 4 * numbers } else { 0 };
        let bands = of.bands();
        let channels = channel::held(of.layers, of.cost).filter(|(_, c)| timed || *c != &channel::TIME);
        let numbers: usize = channels.map(|(_, channel)| channel.components.len()).sum();
        // Light, its variance and the number of samples.
        12 + held(of.layers, 3 + 1) + 4 * numbers + held(error, 3) + 4 * bands
    }

    /// The means and variances so far.
    pub fn layers(&self) -> Layers {
        let (w, h) = (self.crop.width() as usize, self.crop.height() as usize);
        let n = w * h;
        let held = if self.keep.layers { n } else { 0 };
        let mut out = Layers {
            width: w,
            height: h,
            rgb: vec![[0.0; 3]; n],
            variance: vec![[0.0; 3]; held],
            error: self.error.map(|estimate| ErrorLayer { estimate, rgb: vec![[0.0; 3]; n] }),
            samples: vec![0; held],
            channels: channel::held(self.keep.layers, self.costs != Costs::No)
                .filter(|(_, c)| self.costs != Costs::Tests || *c != &channel::TIME)
                .map(|(_, channel)| ChannelLayer { channel, values: vec![0.0; n * channel.components.len()] })
                .collect(),
            bands: self.bands.map(|bands| BandLayers { bands, planes: vec![vec![0.0; n]; bands.count()] }),
            groups: { self.groups.iter() }
                .map(|name| GroupLayer { name: name.clone(), rgb: vec![[0.0; 3]; n] })
                .collect(),
        };
        let (count_of_bands, of_each) = (self.bands.as_ref().map_or(0, Bands::count), self.bands_of_each());
        for tile in &self.tiles {
            for (k, p) in tile.pixels.iter().enumerate() {
                let tw = tile.region.width() as usize;
                let pixel = [tile.region.min[0] + (k % tw) as u32, tile.region.min[1] + (k / tw) as u32];
                if !self.crop.contains(pixel) {
                    continue;
                }
                let [x, y] = [0, 1].map(|a| (pixel[a] - self.crop.min[a]) as usize);
                let i = y * w + x;
                let count = f64::from(p.count.max(1));
                for c in 0..3 {
                    out.rgb[i][c] = tile.mean(k, c) as f32;
                    if let Some(error) = &mut out.error {
                        error.rgb[i][c] = (tile.variance_of_mean(k, c) as f32).sqrt();
                    }
                }
                if let Some(variance) = out.variance.get_mut(i) {
                    *variance = std::array::from_fn(|c| tile.variance_by_spread(k, c) as f32);
                    out.samples[i] = p.count;
                }
                for (layer, plane) in out.channels.iter_mut().zip(&tile.channels) {
                    let each = layer.channel.components.len();
                    for (c, value) in layer.values[i * each..(i + 1) * each].iter_mut().enumerate() {
                        *value = (plane.sum(k, c) / count) as f32;
                    }
                }
                if let Some(out) = &mut out.bands {
                    for (band, plane) in out.planes.iter_mut().enumerate() {
                        plane[i] = tile.band_mean(k, band, of_each) as f32;
                    }
                }
                for (group, layer) in out.groups.iter_mut().enumerate() {
                    let first = count_of_bands + 3 * group;
                    layer.rgb[i] = std::array::from_fn(|c| tile.band_mean(k, first + c, of_each) as f32);
                }
            }
        }
        if self.tiles.iter().any(|t| t.splats.is_some()) {
            self.show_splats(&mut out);
        }
        out
    }

    /// Samples of a pixel of the crop, on average.
    pub fn mean_samples(&self) -> f64 {
        let inside = |t: &FilmTile, k: usize| {
            let width = t.region.width() as usize;
            let at = [(k % width) as u32, (k / width) as u32];
            self.crop.contains([t.region.min[0] + at[0], t.region.min[1] + at[1]])
        };
        let counts = self.tiles.iter().flat_map(|t| {
            t.pixels.iter().enumerate().filter(move |(k, _)| inside(t, *k)).map(|(_, p)| u64::from(p.count))
        });
        counts.sum::<u64>() as f64 / self.crop.area().max(1) as f64
    }

    /// A fingerprint of the picture, see [`hash_of`].
    pub fn hash(&self) -> String {
        hash_of(&self.layers().rgb)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole(w: u32, h: u32) -> Region {
        Region { min: [0, 0], max: [w, h] }
    }

    fn grey(v: f32) -> Sample<'static> {
        Sample { rgb: [v; 3], ..Sample::default() }
    }

    #[test]
    fn sums_do_not_depend_on_order() {
        let values: Vec<f32> =
            (0..1000_u32).map(|i| (i * 7919 % 1000) as f32 * 1e-3 + 1e4 * (i % 2) as f32).collect();
        let render = |order: &mut dyn Iterator<Item = f32>| {
            let mut f = Film::new([1, 1], whole(1, 1));
            for (i, v) in order.enumerate() {
                f.tiles[0].add([0, 0], i as u32, &grey(v), &[]);
            }
            f.hash()
        };
        assert_eq!(render(&mut values.iter().copied()), render(&mut values.iter().rev().copied()));
    }

    #[test]
    fn mean_and_variance_of_the_mean() {
        let mut f = Film::new([1, 1], whole(1, 1));
        for (i, v) in [1.0, 2.0, 3.0, 4.0].into_iter().enumerate() {
            f.tiles[0].add([0, 0], i as u32, &grey(v), &[]);
        }
        let l = f.layers();
        assert_eq!(l.rgb[0], [2.5; 3]);
        // Sample variance 5/3, of the mean of four: 5/12.
        assert!((l.variance[0][0] - 5.0 / 12.0).abs() < 1e-7);
        assert_eq!(l.samples[0], 4);
    }

    #[test]
    fn what_is_not_a_number_is_dropped_counted_and_located() {
        let mut f = Film::new([20, 20], whole(20, 20));
        let tile =
            f.tiles.iter().position(|t| t.region.min == [16, 0]).expect("second tile of the first row");
        f.tiles[tile].add([17, 3], 0, &grey(1.0), &[]);
        f.tiles[tile].add([17, 3], 1, &grey(f32::NAN), &[]);
        f.tiles[tile].add([17, 2], 7, &grey(f32::INFINITY), &[]);
        assert_eq!(f.dropped(), Dropped { count: 2, first: Some(([17, 2], 7)) });
        // A dropped sample still counts in N.
        assert_eq!(f.layers().rgb[3 * 20 + 17], [0.5; 3]);
    }

    #[test]
    fn tiles_cover_a_crop_once() {
        let crop = Region { min: [5, 15], max: [40, 33] };
        let f = Film::new([64, 64], crop);
        assert_eq!(f.tiles.iter().map(|t| t.region.area()).sum::<usize>(), crop.area());
    }
}
