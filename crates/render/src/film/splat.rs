//! Classic splatting: a sample counts in every pixel whose filter reaches it.
//!
//! Each pixel is the sum of its samples' light times the filter's height over the sum of these heights. All sums are
//! integers, so that it doesn't matter in which order tiles and samples come. A tile sums what its own samples bring to it and
//! to an apron of pixels around it; where tiles overlap, their sums are added when the picture is asked for. No thread waits for
//! another.

use super::fixed::{Value, WideSquare};
use super::{BandLayers, BandSample, Film, Layers, Sample, TILE};
use crate::filter::Filter;
use crate::settings::Region;
use straal_color::spectrum::Bands;

/// Sums of one pixel, of light v and heights w.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Splat {
    /// Of w v.
    value: [Value; 3],
    /// Of (w v)².
    square: [WideSquare; 3],
    /// Of w² v.
    cross: [Value; 3],
    /// Of w.
    weight: Value,
    /// Of w².
    weight_square: Value,
}

impl Splat {
    fn add(&mut self, rgb: Option<[f32; 3]>, w: f64) {
        self.weight.add_exact(w);
        self.weight_square.add_exact(w * w);
        for (c, v) in rgb.into_iter().flatten().enumerate() {
            let v = f64::from(v);
            self.value[c].add_exact(w * v);
            self.square[c].add(w * v);
            self.cross[c].add_exact(w * w * v);
        }
    }

    /// How many numbers it is made of.
    pub(super) const NUMBERS: usize = 11;

    /// Every number, in the order in which they are written.
    pub(super) fn visit(&mut self, see: &mut impl FnMut(&mut i128)) {
        self.value.iter_mut().for_each(|v| see(&mut v.0));
        self.square.iter_mut().for_each(|v| see(&mut v.0));
        self.cross.iter_mut().for_each(|v| see(&mut v.0));
        see(&mut self.weight.0);
        see(&mut self.weight_square.0);
    }

    pub(super) fn merge(&mut self, o: &Self) {
        self.weight += o.weight;
        self.weight_square += o.weight_square;
        for c in 0..3 {
            self.value[c] += o.value[c];
            self.square[c] += o.square[c];
            self.cross[c] += o.cross[c];
        }
    }

    /// The mean of a channel and the variance of that mean: of a quotient of sums, by its first-order expansion. Where negative
    /// heights leave no weight, nothing is known, and it is black.
    fn mean_and_variance(&self, channel: usize) -> (f64, f64) {
        let (weight, squares) = (self.weight.to_f64(), self.weight_square.to_f64());
        if weight <= 0.0 || squares <= 0.0 {
            return (0.0, 0.0);
        }
        let mean = self.value[channel].to_f64() / weight;
        let spread =
            self.square[channel].to_f64() - 2.0 * mean * self.cross[channel].to_f64() + mean * mean * squares;
        // As many samples of equal weight would leave as much noise.
        let like = weight * weight / squares;
        let variance = spread / (weight * weight) * like / (like - 1.0);
        (mean, if like > 1.0 && variance > 0.0 { variance } else { 0.0 })
    }
}

/// The sums of a tile and its apron.
#[derive(Clone, Debug)]
pub struct Splats {
    region: Region,
    sums: Vec<Splat>,
    /// By pixel, as many as there are bands, of w v.
    bands: Vec<Value>,
    /// How far a sample's own pixel may be from one that it counts in.
    reach: u32,
}

/// One sample on its way to several pixels.
#[derive(Clone, Copy, Debug)]
pub struct Flying<'a> {
    /// The pixel that it lies in.
    pub pixel: [u32; 2],
    /// Where it lies, from that pixel's centre, in pixels.
    pub offset: [f32; 2],
    /// Its light; `None` where the film dropped it, so that it counts as black.
    pub sample: Option<&'a Sample>,
    /// What it brings to bands of wavelengths.
    pub bands: &'a [BandSample],
}

impl Splats {
    /// For a tile of a picture of some size, and a filter.
    pub(super) fn new(tile: Region, size: [u32; 2], filter: &Filter, bands: usize) -> Self {
        let reach = reach(f64::from(filter.radius()));
        let region = tile.grown(reach).intersection(Region::whole(size));
        let sums = vec![Splat::default(); region.area()];
        Self { region, bands: vec![Value::default(); region.area() * bands], sums, reach }
    }

    /// For sums that were made before, and reach nobody else.
    pub(super) fn alone(tile: Region, bands: usize) -> Self {
        let sums = vec![Splat::default(); tile.area()];
        Self { region: tile, bands: vec![Value::default(); tile.area() * bands], sums, reach: 0 }
    }

    /// How far a sample's own pixel may be from one that it counts in.
    pub(super) const fn reach(&self) -> u32 {
        self.reach
    }

    /// The sums of a pixel and of its bands, if it is within reach.
    pub(super) fn at(&self, pixel: [u32; 2]) -> Option<(&Splat, &[Value])> {
        let of_each = self.bands.len() / self.sums.len();
        let i = self.region.contains(pixel).then(|| index(&self.region, pixel))?;
        Some((&self.sums[i], &self.bands[i * of_each..][..of_each]))
    }

    /// The same to be changed.
    pub(super) fn at_mut(&mut self, pixel: [u32; 2]) -> Option<(&mut Splat, &mut [Value])> {
        let of_each = self.bands.len() / self.sums.len();
        let i = self.region.contains(pixel).then(|| index(&self.region, pixel))?;
        Some((&mut self.sums[i], &mut self.bands[i * of_each..][..of_each]))
    }

    /// Adds a sample to all pixels within reach.
    pub fn add(&mut self, filter: &Filter, flying: &Flying<'_>) {
        let Flying { pixel, offset, sample, bands } = *flying;
        let of_each = self.bands.len() / self.sums.len();
        let around = Region { min: pixel, max: pixel.map(|p| p + 1) }.grown(self.reach);
        let around = around.intersection(self.region);
        for y in around.min[1]..around.max[1] {
            let down = filter.relative_height(from(offset[1], pixel[1], y));
            if down == 0.0 {
                continue;
            }
            for x in around.min[0]..around.max[0] {
                let across = filter.relative_height(from(offset[0], pixel[0], x));
                let w = f64::from(across) * f64::from(down);
                if w == 0.0 {
                    continue;
                }
                let i = index(&self.region, [x, y]);
                self.sums[i].add(sample.map(|s| s.rgb), w);
                if sample.is_some() {
                    for b in bands {
                        self.bands[i * of_each + usize::from(b.band)].add_exact(w * f64::from(b.value));
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

/// Bytes that splatting takes for each pixel besides those of the film, with a number of bands.
pub(super) fn bytes_a_pixel(radius: f64, bands: usize) -> usize {
    let side = (TILE + 2 * reach(radius)) as usize;
    (size_of::<Splat>() + bands * size_of::<Value>()) * side * side / (TILE * TILE) as usize
}

impl Film {
    /// Puts colours by splatting in place of those by each pixel's own samples.
    pub(super) fn show_splats(&self, out: &mut Layers) {
        let mut sums = vec![Splat::default(); self.crop.area()];
        let count = self.bands.as_ref().map_or(0, Bands::count);
        let mut bands = vec![Value::default(); self.crop.area() * count];
        for splats in self.tiles.iter().filter_map(|t| t.splats.as_ref()) {
            let part = splats.region.intersection(self.crop);
            for y in part.min[1]..part.max[1] {
                for x in part.min[0]..part.max[0] {
                    let (own, all) = (index(&splats.region, [x, y]), index(&self.crop, [x, y]));
                    sums[all].merge(&splats.sums[own]);
                    let theirs = &splats.bands[own * count..][..count];
                    for (sum, v) in bands[all * count..].iter_mut().zip(theirs) {
                        *sum += *v;
                    }
                }
            }
        }
        for (i, sum) in sums.iter().enumerate() {
            for c in 0..3 {
                let (mean, variance) = sum.mean_and_variance(c);
                (out.rgb[i][c], out.variance[i][c]) = (mean as f32, variance as f32);
                if let Some(error) = &mut out.error {
                    error.rgb[i][c] = (variance as f32).sqrt();
                }
            }
            if let Some(BandLayers { planes, .. }) = &mut out.bands {
                let weight = sum.weight.to_f64();
                for (plane, v) in planes.iter_mut().zip(&bands[i * count..]) {
                    plane[i] = if weight > 0.0 { (v.to_f64() / weight) as f32 } else { 0.0 };
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::{Profile, Separable};

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
        film.splat(&filter);
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

    #[test]
    fn weighted_means_and_their_variances() {
        let mut sum = Splat::default();
        for v in [1.0, 2.0, 3.0, 4.0] {
            sum.add(Some([v; 3]), 0.5);
        }
        let (mean, variance) = sum.mean_and_variance(1);
        // As of four plain samples: 5/12.
        assert!(mean == 2.5 && (variance - 5.0 / 12.0).abs() < 1e-9, "{mean} {variance}");
        // One that was dropped counts as black.
        sum.add(None, 0.5);
        assert_eq!(sum.mean_and_variance(0).0, 2.0);
        let mut lost = Splat::default();
        lost.add(Some([1.0; 3]), -0.25);
        assert_eq!(lost.mean_and_variance(0), (0.0, 0.0));
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
                let mut splat = Splat::default();
                for pixel in 0..25 * samples {
                    let place = [pixel % 5, pixel / 5 % 5].map(|p| p as f32 - 2.5 + random());
                    let [w, down] = place.map(|x| f64::from(filter.relative_height(x)));
                    splat.add(Some([if place[0] < 0.3 { 1.0 } else { 0.0 }; 3]), w * down);
                }
                let (mean, _) = splat.mean_and_variance(0);
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
