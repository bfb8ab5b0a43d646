//! Classic splatting: a sample counts in every pixel whose filter reaches it.
//!
//! Each pixel is the sum of its samples' light times the filter's height over the sum of these heights. All sums are
//! integers, so that it doesn't matter in which order tiles and samples come. A tile sums what its own samples bring to it and
//! to an apron of pixels around it; where tiles overlap, their sums are added when the picture is asked for. No thread waits for
//! another.
//!
//! A wide filter reaches a thousand pixels from each sample, so that little may be done for each: heights become integers once
//! for each row and column, and light once for each row; what is left is a product and a sum for each number of a pixel
//! ([`super::planes`]). Variance is told when the picture is asked for, from the spread of each pixel's own samples and the squares of
//! heights that they have on average.

use super::fixed::{Down, Fixed, HEIGHT_SCALE, height};
use super::planes::{Columns, MAX_AROUND, MAX_REACH, Plane, add_heights, product};
use super::{BandLayers, BandSample, Film, FilmTile, Layers, Sample};
use crate::film::Region;
use crate::filter::Filter;
use straal_color::spectrum::Bands;
use straal_math::simd::{Float, Kernel, Simd};

/// Sums of one pixel, of light v and heights w.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Splat {
    /// Of w v.
    value: [Fixed; 3],
    /// Of w, in units of 2^-30: 2^18 samples of each of 33 x 33 pixels stay below 2^59.
    weight: i64,
}

impl Splat {
    /// Numbers of 128 bits that it is made of, and those of 64.
    pub(super) const NUMBERS: [usize; 2] = [3, 1];

    /// Every number of 128 bits, in the order in which they are written; the weight comes after them.
    pub(super) fn values(&mut self) -> impl Iterator<Item = &mut i128> {
        self.value.iter_mut().map(|v| &mut v.0)
    }

    /// The sum of heights.
    pub(super) fn weights(&mut self) -> &mut i64 {
        &mut self.weight
    }

    pub(super) fn merge(&mut self, o: &Self) {
        self.weight += o.weight;
        for (sum, other) in self.value.iter_mut().zip(o.value) {
            *sum += other;
        }
    }

    fn weight(&self) -> f64 {
        self.weight as f64 / HEIGHT_SCALE
    }

    /// The mean of a channel. Where negative heights leave no weight, nothing is known, and it is black.
    fn mean(&self, channel: usize) -> f64 {
        if self.weight > 0 { self.value[channel].to_f64() / self.weight() } else { 0.0 }
    }
}

/// The sums of a tile and its apron.
#[derive(Clone, Debug)]
pub struct Splats {
    region: Region,
    /// Of w v, by channel.
    light: [Plane; 3],
    /// Of w, as [`Splat`] has it.
    weights: Vec<i64>,
    /// By pixel, as many as there are bands, of w v.
    bands: Vec<Fixed>,
    /// Samples that are to be added: together, a row of pixels at a time, which stays in the nearest cache.
    waiting: Vec<Waiting>,
    /// How far a sample's own pixel may be from one that it counts in.
    reach: u32,
    /// By which instruction set samples are added.
    simd: Simd,
}

/// Samples that wait for one another, where the filter is so wide that a sample's pixels don't fit the nearest cache.
const TOGETHER: usize = 8;
const WIDE: u32 = 4;

/// A sample's heights and light.
#[derive(Clone, Debug)]
struct Waiting {
    /// Column and row, of the sums' region, of the first pixel that it counts in.
    from: [usize; 2],
    columns: Columns,
    down: [i32; MAX_AROUND],
    rows: usize,
    /// `None` where it counts as black.
    rgb: Option<[f32; 3]>,
}

impl Waiting {
    /// The height of a row, where it counts there.
    fn down(&self, row: usize) -> Option<i64> {
        let down = *self.down[..self.rows].get(row.checked_sub(self.from[1])?)?;
        (down != 0).then_some(i64::from(down))
    }

    /// Adds what it brings to a pixel.
    fn add_to(&self, [x, y]: [usize; 2], sum: &mut Splat) {
        let (Some(down), Some(column)) = (self.down(y), x.checked_sub(self.from[0])) else { return };
        let Some(across) = self.columns.heights().nth(column) else { return };
        sum.weight += product(across, down);
        if let Some(rgb) = &self.rgb {
            for (c, v) in sum.value.iter_mut().enumerate() {
                *v += match Down::new(rgb, down) {
                    Down::Bright(rows) => rows.row(c).at(across),
                    Down::Usual(rows) => rows.row(c).at(across),
                };
            }
        }
    }
}

/// One sample on its way to several pixels.
#[derive(Clone, Copy, Debug)]
pub struct Flying<'a> {
    /// The pixel that it lies in.
    pub pixel: [u32; 2],
    /// Where it lies, from that pixel's centre, in pixels.
    pub offset: [f32; 2],
    /// Its light; `None` where the film dropped it, so that it counts as black.
    pub sample: Option<&'a Sample<'a>>,
    /// What it brings to bands of wavelengths.
    pub bands: &'a [BandSample],
}

impl Splats {
    /// For a tile of a picture of some size, and a filter.
    pub(super) fn new(tile: Region, size: [u32; 2], filter: &Filter, bands: usize, simd: Simd) -> Self {
        let reach = reach(f64::from(filter.radius())).min(MAX_REACH);
        Self { reach, simd, ..Self::alone(tile.grown(reach).intersection(Region::whole(size)), bands) }
    }

    /// For sums that were made before, and reach nobody else.
    pub(super) fn alone(tile: Region, bands: usize) -> Self {
        let pixels = tile.area();
        Self {
            region: tile,
            light: std::array::from_fn(|_| Plane::new(pixels)),
            weights: vec![0; pixels],
            bands: vec![Fixed::default(); pixels * bands],
            waiting: Vec::new(),
            reach: 0,
            simd: Simd::PLAIN,
        }
    }

    /// How far a sample's own pixel may be from one that it counts in.
    pub(super) const fn reach(&self) -> u32 {
        self.reach
    }

    /// The sums of a pixel and of its bands, if it is within reach.
    pub(super) fn at(&self, pixel: [u32; 2]) -> Option<(Splat, &[Fixed])> {
        let of_each = self.bands.len() / self.weights.len();
        let i = self.region.contains(pixel).then(|| index(&self.region, pixel))?;
        Some((self.sum(i), &self.bands[i * of_each..][..of_each]))
    }

    /// Puts other sums in place of a pixel's, if it is within reach.
    pub(super) fn put(&mut self, pixel: [u32; 2], splat: &Splat, bands: &[Fixed]) {
        if self.region.contains(pixel) {
            self.settle();
            let i = index(&self.region, pixel);
            self.light.iter_mut().zip(splat.value).for_each(|(plane, v)| plane.put(i, v));
            self.weights[i] = splat.weight;
            self.bands[i * bands.len()..][..bands.len()].copy_from_slice(bands);
        }
    }

    fn sum(&self, i: usize) -> Splat {
        let mut sum = Splat { value: std::array::from_fn(|c| self.light[c].at(i)), weight: self.weights[i] };
        let width = self.region.width() as usize;
        self.waiting.iter().for_each(|w| w.add_to([i % width, i / width], &mut sum));
        sum
    }

    /// Adds a sample to all pixels within reach.
    pub fn add(&mut self, filter: &Filter, flying: &Flying<'_>) {
        let Flying { pixel, offset, sample, bands } = *flying;
        let around = Region { min: pixel, max: pixel.map(|p| p + 1) }.grown(self.reach);
        let around = around.intersection(self.region);
        // Heights of the columns and of the rows that it counts in.
        let (mut across, mut down) = ([0; MAX_AROUND], [0; MAX_AROUND]);
        let heights = |out: &mut [i64], axis: usize| {
            for (h, other) in out.iter_mut().zip(around.min[axis]..around.max[axis]) {
                *h = height(filter.relative_height(from(offset[axis], pixel[axis], other)));
            }
        };
        heights(&mut across, 0);
        heights(&mut down, 1);
        // A bell is 0 long before it ends.
        let across = &across[..around.width() as usize];
        let first = across.iter().position(|h| *h != 0).unwrap_or(across.len());
        let across = &across[first..across.iter().rposition(|h| *h != 0).map_or(first, |last| last + 1)];
        let from = [0, 1].map(|axis| (around.min[axis] - self.region.min[axis]) as usize);
        let from = [from[0] + first, from[1]];
        let rows = around.height() as usize;
        if sample.is_some() && !bands.is_empty() {
            for (row, &down) in (from[1]..).zip(&down[..rows]).filter(|(_, down)| **down != 0) {
                self.add_bands(row * self.region.width() as usize + from[0], across, down, bands);
            }
        }
        let waiting = Waiting {
            from,
            columns: Columns::new(across),
            // Heights lie in [-1, 1].
            down: down.map(|h| h as i32),
            rows,
            rgb: sample.map(|s| s.rgb),
        };
        if self.reach < WIDE {
            return self.add_all(std::slice::from_ref(&waiting));
        }
        if self.waiting.capacity() == 0 {
            self.waiting.reserve_exact(TOGETHER);
        }
        self.waiting.push(waiting);
        if self.waiting.len() == TOGETHER {
            self.settle();
        }
    }

    /// Adds the samples that wait.
    fn settle(&mut self) {
        let mut waiting = std::mem::take(&mut self.waiting);
        self.add_all(&waiting);
        waiting.clear();
        self.waiting = waiting;
    }

    fn add_all(&mut self, samples: &[Waiting]) {
        let width = self.region.width() as usize;
        self.simd.run(Together { samples, width, light: &mut self.light, weights: &mut self.weights });
    }

    fn add_bands(&mut self, start: usize, across: &[i64], down: i64, bands: &[BandSample]) {
        let of_each = self.bands.len() / self.weights.len();
        for b in bands {
            let sums = self.bands[start * of_each + usize::from(b.band)..].iter_mut().step_by(of_each);
            match Down::new(&[b.value], down) {
                Down::Bright(rows) => sums.zip(across).for_each(|(sum, &w)| *sum += rows.row(0).at(w)),
                Down::Usual(rows) => sums.zip(across).for_each(|(sum, &w)| *sum += rows.row(0).at(w)),
            }
        }
    }
}

/// Samples on their way to the sums, a row of pixels at a time. It is integers all through, the same by every instruction set.
struct Together<'a> {
    samples: &'a [Waiting],
    /// Pixels of a row of the sums' region.
    width: usize,
    light: &'a mut [Plane; 3],
    weights: &'a mut [i64],
}

impl Kernel for Together<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let first = self.samples.iter().map(|w| w.from[1]).min().unwrap_or(0);
        let end = self.samples.iter().map(|w| w.from[1] + w.rows).max().unwrap_or(0);
        for row in first..end {
            for w in self.samples {
                let Some(down) = w.down(row) else { continue };
                let start = row * self.width + w.from[0];
                add_heights(&mut self.weights[start..], &w.columns, down);
                let Some(rgb) = &w.rgb else { continue };
                match Down::new(rgb, down) {
                    Down::Bright(rows) => {
                        for (c, plane) in self.light.iter_mut().enumerate() {
                            plane.add_bright(&w.columns, start, rows.row(c));
                        }
                    }
                    Down::Usual(rows) => {
                        for (c, plane) in self.light.iter_mut().enumerate() {
                            plane.add_usual(&w.columns, start, rows.row(c));
                        }
                    }
                }
            }
        }
    }
}

/// How far a sample lies from the centre of a pixel, if it lies `offset` from that of its own. By whole pixels first: it
/// comes out the same all over the picture.
fn from(offset: f32, own: u32, other: u32) -> f32 {
    offset + (f64::from(own) - f64::from(other)) as f32
}

fn index(region: &Region, [x, y]: [u32; 2]) -> usize {
    (y - region.min[1]) as usize * region.width() as usize + (x - region.min[0]) as usize
}

/// How many pixels away, at most, a sample's own pixel is from one within whose filter, of some radius in pixels, it lies.
pub fn reach(radius: f64) -> u32 {
    ((radius + 0.5).ceil() as u32).saturating_sub(1)
}

/// Bytes that splatting takes for each pixel of tiles and their aprons, with a number of bands.
pub(super) fn bytes_a_pixel(bands: usize) -> usize {
    3 * Plane::BYTES + size_of::<i64>() + bands * size_of::<Fixed>()
}

/// By how many pixels two are apart, from 0: the mean of the square of the height that one of them gives to a sample that may lie
/// anywhere in the other.
fn mean_squares(filter: &Filter, reach: u32) -> Vec<f64> {
    const STEPS: u32 = 256;
    let square = |apart: u32, i: u32| {
        let offset = (f64::from(i) + 0.5) / f64::from(STEPS) - 0.5;
        let h = f64::from(filter.relative_height((offset + f64::from(apart)) as f32));
        h * h / f64::from(STEPS)
    };
    (0..=reach).map(|apart| (0..STEPS).map(|i| square(apart, i)).sum()).collect()
}

/// Numbers of samples, and sums of their light and of its squares, each times the mean square of a height.
type Spread = [f64; 7];

impl Film {
    /// Puts colours by splatting in place of those by each pixel's own samples.
    pub(super) fn show_splats(&self, out: &mut Layers) {
        for tile in &self.tiles {
            let part = tile.region.intersection(self.crop);
            if part.area() > 0 && part.width() > 0 {
                self.show_part(part, out);
            }
        }
    }

    /// The same for the part of the crop under one tile.
    fn show_part(&self, part: Region, out: &mut Layers) {
        let (count, wavelengths) = (self.bands_of_each(), self.bands.as_ref().map_or(0, Bands::count));
        let mut sums = vec![Splat::default(); part.area()];
        let mut bands = vec![Fixed::default(); part.area() * count];
        for tile in self.tiles_around(part, MAX_REACH) {
            let Some(splats) = &tile.splats else { continue };
            let common = splats.region.intersection(part);
            for y in common.min[1]..common.max[1] {
                for x in common.min[0]..common.max[0] {
                    let (theirs, own) = (index(&splats.region, [x, y]), index(&part, [x, y]));
                    sums[own].merge(&splats.sum(theirs));
                    let theirs = &splats.bands[theirs * count..][..count];
                    for (sum, v) in bands[own * count..].iter_mut().zip(theirs) {
                        *sum += *v;
                    }
                }
            }
        }
        let spreads = (self.keep.layers || self.error.is_some()).then(|| self.spreads(part));
        for (k, sum) in sums.iter().enumerate() {
            let width = part.width() as usize;
            let at = [part.min[0] + (k % width) as u32, part.min[1] + (k / width) as u32];
            let i = index(&self.crop, at);
            for c in 0..3 {
                out.rgb[i][c] = sum.mean(c) as f32;
                let variance = spreads.as_ref().map_or(0.0, |spreads| variance(sum, &spreads[k], c)) as f32;
                if let Some(v) = out.variance.get_mut(i) {
                    v[c] = variance;
                }
                if let Some(error) = &mut out.error {
                    error.rgb[i][c] = variance.sqrt();
                }
            }
            let weight = sum.weight();
            let mean = |v: &Fixed| if weight > 0.0 { (v.to_f64() / weight) as f32 } else { 0.0 };
            let bands = &bands[k * count..][..count];
            if let Some(BandLayers { planes, .. }) = &mut out.bands {
                planes.iter_mut().zip(bands).for_each(|(plane, v)| plane[i] = mean(v));
            }
            for (layer, rgb) in out.groups.iter_mut().zip(bands[wavelengths..].chunks_exact(3)) {
                layer.rgb[i] = std::array::from_fn(|c| mean(&rgb[c]));
            }
        }
    }

    /// Tiles that reach a part of the picture, if they reach so many pixels beyond their own.
    fn tiles_around(&self, part: Region, reach: u32) -> impl Iterator<Item = &FilmTile> {
        let near = part.grown(reach);
        // Tiles come row by row, so that those beyond are left without being looked at.
        let first = self.tiles.partition_point(|t| t.region.max[1] <= near.min[1]);
        let rows = self.tiles[first..].iter().take_while(move |t| t.region.min[1] < near.max[1]);
        rows.filter(move |t| t.region.min[0] < near.max[0] && t.region.max[0] > near.min[0])
    }

    /// What tells the variance of each pixel of a part: sums over the pixels whose samples count there, across and then down.
    fn spreads(&self, part: Region) -> Vec<Spread> {
        let squares = &self.mean_squares;
        let reach = squares.len().saturating_sub(1) as u32;
        let near = part.grown(reach).intersection(Region::whole(self.size));
        let mut own = vec![Spread::default(); near.area()];
        for tile in self.tiles_around(part, reach) {
            let common = tile.region.intersection(near);
            for y in common.min[1]..common.max[1] {
                for x in common.min[0]..common.max[0] {
                    own[index(&near, [x, y])] = tile.spread(index(&tile.region, [x, y]));
                }
            }
        }
        let weighed = |get: &dyn Fn(u32) -> Spread, at: u32, range: [u32; 2]| {
            let mut sum = Spread::default();
            for other in at.saturating_sub(reach).max(range[0])..(at + reach + 1).min(range[1]) {
                let by = squares[at.abs_diff(other) as usize];
                sum.iter_mut().zip(get(other)).for_each(|(sum, v)| *sum += by * v);
            }
            sum
        };
        let wide = Region { min: [part.min[0], near.min[1]], max: [part.max[0], near.max[1]] };
        let mut across = Vec::with_capacity(wide.area());
        for y in wide.min[1]..wide.max[1] {
            for x in wide.min[0]..wide.max[0] {
                across.push(weighed(&|x| own[index(&near, [x, y])], x, [near.min[0], near.max[0]]));
            }
        }
        let mut out = Vec::with_capacity(part.area());
        for y in part.min[1]..part.max[1] {
            for x in part.min[0]..part.max[0] {
                out.push(weighed(&|y| across[index(&wide, [x, y])], y, [near.min[1], near.max[1]]));
            }
        }
        out
    }

    /// Makes ready to tell variance by splatting.
    pub(super) fn hold_mean_squares(&mut self, filter: &Filter) {
        self.mean_squares = mean_squares(filter, reach(f64::from(filter.radius())).min(MAX_REACH));
    }
}

impl FilmTile {
    /// Number, light and squares of a pixel's own samples.
    fn spread(&self, k: usize) -> Spread {
        let p = &self.pixels[k];
        let squares = self.squares.get(k).copied().unwrap_or_default();
        let [r, g, b] = p.value.map(Fixed::to_f64);
        let [rr, gg, bb] = squares.map(|s| s.to_f64());
        [f64::from(p.count), r, g, b, rr, gg, bb]
    }
}

/// The variance of the mean of a channel: of a quotient of sums, by its first-order expansion.
fn variance(sum: &Splat, spread: &Spread, channel: usize) -> f64 {
    let (weight, squares) = (sum.weight(), spread[0]);
    if weight <= 0.0 || squares <= 0.0 {
        return 0.0;
    }
    let mean = sum.mean(channel);
    let spread = spread[4 + channel] - 2.0 * mean * spread[1 + channel] + mean * mean * squares;
    // As many samples of equal weight would leave as much noise.
    let like = weight * weight / squares;
    let variance = spread / (weight * weight) * like / (like - 1.0);
    if like > 1.0 && variance > 0.0 { variance } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::{Profile, Separable};
    use straal_math::simd::Isa;

    #[test]
    fn reach_is_the_least_that_misses_no_pixel() {
        for (radius, want) in
            [(0.5, 0), (0.51, 1), (1.0, 1), (1.5, 1), (1.6, 2), (2.0, 2), (16.0, 16), (1e-3, 0)]
        {
            assert_eq!(reach(radius), want, "{radius}");
        }
    }

    #[test]
    fn a_sample_counts_in_the_pixels_that_reach_it() {
        let filter = Filter::Separable(Separable::new(Profile::Tent, 1.0).expect("a filter"));
        let mut film = Film::new([40, 20], Region::whole([40, 20]));
        film.splat(&filter, Simd::best());
        let tile = film.tiles.iter_mut().find(|t| t.region.min == [16, 0]).expect("a tile");
        let sample = Sample { rgb: [1.0, 2.0, 4.0], ..Sample::default() };
        // A quarter of a pixel left of the middle of the tile's first column: half-way into the tile beside.
        let flying = Flying { pixel: [16, 5], offset: [-0.25, 0.0], sample: Some(&sample), bands: &[] };
        if let Some(splats) = &mut tile.splats {
            splats.add(&filter, &flying);
        }
        let layers = film.layers();
        let seen = |x: usize, y: usize| layers.rgb[y * 40 + x];
        // A single sample is the mean of whoever sees it.
        assert_eq!((seen(15, 5), seen(16, 5)), ([1.0, 2.0, 4.0], [1.0, 2.0, 4.0]));
        assert_eq!((seen(17, 5), seen(16, 4)), ([0.0; 3], [0.0; 3]));
    }

    /// Light of any size, above 0 or below, by a filter with negative lobes: sums that instruction sets add side by side are those of
    /// plain numbers.
    #[test]
    fn instruction_sets_have_the_same_sums() {
        let filter = Filter::Separable(Separable::new(Profile::Lanczos, 6.0).expect("a filter"));
        let sums = |simd: Simd| {
            let mut film = Film::new([16, 16], Region::whole([16, 16]));
            film.splat(&filter, simd);
            let splats = film.tiles[0].splats.as_mut().expect("sums");
            for i in 0..40_u32 {
                let v = [1e-7, 0.3, -0.4, 5.0, -7.0, 3e3, -4e9][i as usize % 7];
                let sample = Sample { rgb: [v, 0.5 * v, 0.0], ..Sample::default() };
                let flying = Flying {
                    pixel: [i * 5 % 16, i * 3 % 16],
                    offset: [i as f32 / 40.0 - 0.5, 0.3],
                    sample: (i != 9).then_some(&sample),
                    bands: &[],
                };
                splats.add(&filter, &flying);
            }
            (0..256).map(|i| splats.sum(i)).collect::<Vec<_>>()
        };
        let want = sums(Simd::PLAIN);
        for simd in Isa::ALL.into_iter().filter_map(Simd::new) {
            assert_eq!(sums(simd), want, "{}", simd.isa());
        }
    }

    /// The sums of one pixel.
    struct One(Splats);

    impl One {
        fn new() -> Self {
            Self(Splats::alone(Region::whole([1, 1]), 0))
        }

        /// Adds light of one grey at a height, or a sample that was dropped.
        fn add(&mut self, v: Option<f32>, w: f32) {
            let height = height(w);
            let columns = Columns::new(&[height]);
            self.0.weights[0] += height;
            for plane in &mut self.0.light {
                match v.map(|v| Down::new(&[v], super::height(1.0))) {
                    Some(Down::Bright(rows)) => plane.add_bright(&columns, 0, rows.row(0)),
                    Some(Down::Usual(rows)) => plane.add_usual(&columns, 0, rows.row(0)),
                    None => {}
                }
            }
        }

        fn sum(&self) -> Splat {
            self.0.sum(0)
        }
    }

    #[test]
    fn weighted_means_and_their_variances() {
        let mut one = One::new();
        for v in [0.25, 2.0, 3.0, 4.75] {
            one.add(Some(v), 0.5);
        }
        let sum = one.sum();
        assert_eq!(sum.mean(1), 2.5);
        // As of four plain samples.
        let squares = [0.25_f64, 2.0, 3.0, 4.75].map(|v| v * v).iter().sum::<f64>();
        let spread = [1.0, 2.5, 2.5, 2.5, squares / 4.0, squares / 4.0, squares / 4.0];
        let want = (squares - 4.0 * 6.25) / 12.0;
        assert!((variance(&sum, &spread, 1) - want).abs() < 1e-9);
        // One that was dropped counts as black.
        one.add(None, 0.5);
        assert_eq!(one.sum().mean(0), 2.0);
        let mut lost = One::new();
        lost.add(Some(1.0), -0.25);
        let lost = lost.sum();
        assert_eq!((lost.mean(0), variance(&lost, &spread, 0)), (0.0, 0.0));
    }

    /// Light is held to as many digits as it has, bright or dark.
    #[test]
    fn dark_and_bright_light_is_kept() {
        for v in [1e-12_f32, 3e-7, 0.1, 0.999_999_94, 1.0, 7.3, 4.2e9, -5e-5, -2e3] {
            let mut sum = One::new();
            for w in [1.0, 0.3, 1e-3] {
                sum.add(Some(v), w);
            }
            let sum = sum.sum();
            let off = (sum.mean(0) / f64::from(v) - 1.0).abs();
            assert!(off < 2e-6, "{v}: {}, off by {off}", sum.mean(0));
        }
    }

    /// At an edge between black and white 0.3 pixels right of the middle, Mitchell's quotient is too dark by 0.0062 with one
    /// independent sample a pixel, and by a quarter of it or less with four: what the book's table of root mean squares is made of.
    #[test]
    fn the_quotient_is_off_by_what_the_book_says() {
        let profile = Profile::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 };
        let filter = Filter::Separable(Separable::new(profile, 2.0).expect("a filter"));
        // The part of the filter left of the edge, by the midpoint rule.
        let heights = |end: f32| -> f64 {
            let middles = (0..4000).map(|i| (i as f32 + 0.5) / 1000.0 - 2.0).filter(|x| *x < end);
            middles.map(|x| f64::from(filter.relative_height(x))).sum()
        };
        let truth = heights(0.3) / heights(2.0);
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1_u64 << 24) as f32
        };
        let mut bias = |samples: u32, trials: u32| {
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..trials {
                let mut splat = One::new();
                for pixel in 0..25 * samples {
                    let place = [pixel % 5, pixel / 5 % 5].map(|p| p as f32 - 2.5 + random());
                    let [w, down] = place.map(|x| filter.relative_height(x));
                    splat.add(Some(if place[0] < 0.3 { 1.0 } else { 0.0 }), w * down);
                }
                let mean = splat.sum().mean(0);
                sum += mean;
                squares += mean * mean;
            }
            let n = f64::from(trials);
            (sum / n - truth, ((squares / n - sum * sum / (n * n)) / n).sqrt())
        };
        let (one, four) = (bias(1, 100_000), bias(4, 25_000));
        assert!((one.0 + 0.0062).abs() < 3.5 * one.1 && one.1 < 0.0012, "{one:?}");
        assert!((four.0 + 0.0012).abs() < 3.5 * four.1 && four.1 < 0.0012, "{four:?}");
    }
}
