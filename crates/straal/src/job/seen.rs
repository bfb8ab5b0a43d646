//! What camera rays tell by themselves: the light of lamps and surroundings, and the guides.
//!
//! A pixel on an edge shows as much of either side as its few samples have met of it. A network can't know how much that really is: it keeps what the samples say, and of a lamp it
//! smears a hundred times the wall's light over its neighbours. But this needs no paths. Eight times as many camera rays are sent where there are edges, and nothing is computed
//! along them but what they meet.
//!
//! - Light that they see is taken off the picture, sample by sample the same, and what more rays see of it is put in its place (a control variate; Glasserman 2003,
//!   "Monte Carlo Methods in Financial Engineering", section 4.1). Lamps are put back after the network, which never sees them. Where surroundings shine,
//!   they are much of the picture, and no brighter than the rest; measured, the network does better by seeing them.
//! - Albedo and normals of these rays are as good as without noise, and guide a network that was trained with such guides: it takes edges from them rather than from the light. (Where rays take so long that few
//!   are sent, it would take their noise for edges as well, and the usual network does without it.)
//!
//! Films of these rays are a strip of rows at a time.

use super::Job;
use crate::resolve::Error;
use straal_render::driver::Render;
use straal_render::film::channel::{self, Channel};
use straal_render::film::{BLOCK, FIRST_CHECK, Film, HalfPictures, Layers, Region};
use straal_render::integrator::{AnyIntegrator, PathTracer};
use straal_render::settings::Settings;

/// Camera rays of a pixel, from which on its own are enough.
const ENOUGH: u32 = 256;

/// How many times as many camera rays are sent where there are edges.
const MANY: u32 = 8;

/// The same of a camera whose rays go through glass, surface by surface. These and their footprints take five times as long as a pinhole's, and out of focus nearly all is edges: with
/// eight times as many, a picture of 16 samples waited five times as long for them as for its light.
const FEW: u32 = 2;

/// By how much light of neighbours differs where more rays are sent, relative to the brighter one.
const EDGE: f32 = 0.02;

/// By how much an albedo or a coordinate of a normal differs there. Measured, a fifth of it sends rays to half as many blocks again and changes nothing.
const GUIDE_EDGE: f32 = 0.1;

/// Rows of a strip, a multiple of [`BLOCK`].
const STRIP: u32 = 32 * BLOCK;

/// What camera rays tell of a picture.
pub(crate) struct Seen {
    /// Light, where they may see any.
    pub light: Option<SeenLight>,
    /// Albedo and normals, by more rays where they have edges.
    pub guides: [Vec<[f32; 3]>; 2],
    /// Whether these are so many that the guides are as good as without noise.
    pub is_clean: bool,
}

/// Light that camera rays see, by rows from the top left.
pub(crate) struct SeenLight {
    /// What a picture's own samples have seen of it.
    pub own: Vec<[f32; 3]>,
    /// The same of its two halves.
    pub halves: [Vec<[f32; 3]>; 2],
    /// What there is of it, by more rays where it has edges.
    pub more: Vec<[f32; 3]>,
    /// Whether the network does without it.
    pub is_apart: bool,
}

impl Job {
    /// What camera rays tell of a film of this job's own samples, whose layers these are; nothing where samples aren't a pixel's own, or can't be taken again.
    pub(super) fn seen(&self, layers: &Layers) -> Result<Option<Seen>, Error> {
        if self.settings.splat || self.first > 0 {
            return Ok(None);
        }
        let counts = Counts::of(layers, self.settings.crop.min);
        let guide = |channel: &'static Channel| {
            let values = layers.channel(channel)?.values.as_chunks::<3>().0;
            (values.len() == layers.rgb.len()).then(|| values.to_vec())
        };
        let (Some(albedo), Some(normal)) = (guide(&channel::ALBEDO), guide(&channel::NORMAL)) else {
            return Ok(None);
        };
        if counts.most == 0 {
            return Ok(None);
        }
        let mut guides = [albedo, normal];
        let mut light = self.own_light(&counts)?;
        let mut edges = counts.edges(&guides[0], |a, b| differ(a, b, GUIDE_EDGE));
        let more_edges = counts.edges(&guides[1], |a, b| differ(a, b, GUIDE_EDGE));
        edges.iter_mut().zip(more_edges).for_each(|(edge, more)| *edge |= more);
        if let Some(light) = &light {
            let more = counts.edges(&light.own, differ_in_part);
            edges.iter_mut().zip(more).for_each(|(edge, more)| *edge |= more);
        }
        let is_clean = !self.world.camera.needs().patience;
        let ends = counts.further(&edges, if is_clean { MANY } else { FEW });
        let plain = Settings { blocks: true, halves: false, error: false, layers: true, ..self.lean() };
        let path = self.seeing().unwrap_or(PathTracer { max_depth: 1, ..PathTracer::default() });
        self.strips(path, &plain, &ends, |at, film| {
            let layers = film.layers();
            let take = |to: &mut [[f32; 3]], from: &[[f32; 3]]| {
                let places = ends.at[at.clone()].iter().zip(to[at.clone()].iter_mut().zip(from));
                places.filter(|(n, _)| **n > 0).for_each(|(_, (to, from))| *to = *from);
            };
            for (guide, channel) in guides.iter_mut().zip([&channel::ALBEDO, &channel::NORMAL]) {
                if let Some(layer) = layers.channel(channel) {
                    take(guide, layer.values.as_chunks::<3>().0);
                }
            }
            if let Some(light) = &mut light {
                take(&mut light.more, &layers.rgb);
            }
        })?;
        Ok(Some(Seen { light, guides, is_clean }))
    }

    /// What the samples of a film have seen of the light, if its integrator adds that up.
    fn own_light(&self, counts: &Counts) -> Result<Option<SeenLight>, Error> {
        let Some(path) = self.seeing().filter(|_| self.world.shows_lights()) else { return Ok(None) };
        let nothing = || vec![[0.0; 3]; counts.at.len()];
        let (mut own, mut halves) = (nothing(), [nothing(), nothing()]);
        self.strips(path, &self.lean(), &counts.capped(), |at, film| {
            let rgb = film.layers().rgb;
            let parts =
                film.halves().map_or_else(|| [rgb.clone(), rgb.clone()], |HalfPictures { rgb, .. }| rgb);
            for (half, part) in halves.iter_mut().zip(parts) {
                for (k, v) in part.into_iter().enumerate() {
                    // What has more samples than were taken again has seen it well enough.
                    half[at.start + k] = if counts.at[at.start + k] > ENOUGH { rgb[k] } else { v };
                }
            }
            own[at].copy_from_slice(&rgb);
        })?;
        let more = own.clone();
        Ok(Some(SeenLight { own, halves, more, is_apart: !self.world.has_environment() }))
    }

    /// What adds up the light that camera rays see as the job's integrator does. The others show lamps in ways of their own, or none.
    fn seeing(&self) -> Option<PathTracer> {
        let path = match &self.integrator {
            AnyIntegrator::Path(path) => *path,
            AnyIntegrator::Direct(_) => PathTracer::default(),
            _ => return None,
        };
        Some(PathTracer { max_depth: 1, ..path })
    }

    /// Settings of the job's samples, of which light alone is kept.
    fn lean(&self) -> Settings {
        Settings { cost: false, layers: false, light_groups: 0, ..self.settings.clone() }
    }

    /// Films with so many samples, a strip at a time: `take` is told which pixels they are of.
    fn strips(
        &self,
        path: PathTracer,
        settings: &Settings,
        counts: &Counts,
        mut take: impl FnMut(std::ops::Range<usize>, &Film),
    ) -> Result<(), Error> {
        let Region { min, max } = settings.crop;
        let mut top = min[1];
        while top < max[1] {
            let bottom = (top / STRIP + 1).saturating_mul(STRIP).min(max[1]);
            let pixels = (top - min[1]) as usize * counts.width..(bottom - min[1]) as usize * counts.width;
            let own = counts.rows(pixels.clone(), [min[0], top]);
            if own.most > 0 {
                let crop = Region { min: [min[0], top], max: [max[0], bottom] };
                let settings = Settings { crop, ..settings.clone() };
                take(pixels, &film(self, path, settings, &own)?);
            }
            top = bottom;
        }
        Ok(())
    }
}

/// Whether three numbers differ by more than that.
fn differ(a: &[f32; 3], b: &[f32; 3], by: f32) -> bool {
    a.iter().zip(b).any(|(a, b)| (a - b).abs() > by)
}

/// Whether light differs by a part of it.
fn differ_in_part(a: &[f32; 3], b: &[f32; 3]) -> bool {
    a.iter().zip(b).any(|(a, b)| (a - b).abs() > EDGE * if a > b { *a } else { *b })
}

/// How many samples each pixel of a crop has, or is to have: the same in all of a block, where they differ.
struct Counts {
    at: Vec<u32>,
    width: usize,
    /// The crop's first pixel.
    min: [u32; 2],
    most: u32,
}

impl Counts {
    fn of(layers: &Layers, min: [u32; 2]) -> Self {
        let at = layers.samples.clone();
        Self { most: at.iter().copied().max().unwrap_or(0), at, width: layers.width.max(1), min }
    }

    fn map(&self, f: impl Fn(usize, u32) -> u32) -> Self {
        let at: Vec<u32> = self.at.iter().enumerate().map(|(k, n)| f(k, *n)).collect();
        Self { most: at.iter().copied().max().unwrap_or(0), at, ..*self }
    }

    /// As many, but no more than are enough.
    fn capped(&self) -> Self {
        self.map(|_, n| n.min(ENOUGH))
    }

    /// The numbers of the blocks that the pixels lie in: the most that any of a block has.
    fn by_blocks(&self) -> Self {
        let block = |k: usize| {
            let [x, y] = [k % self.width, k / self.width];
            let at = [0, 1].map(|a| self.min[a] / BLOCK * BLOCK);
            let block = [(self.min[0] + x as u32 - at[0]) / BLOCK, (self.min[1] + y as u32 - at[1]) / BLOCK];
            block[1] as usize * self.width.div_ceil(BLOCK as usize).saturating_add(1) + block[0] as usize
        };
        let mut most = vec![0; self.at.len() + self.width + 1];
        most.resize((0..self.at.len()).map(block).max().unwrap_or(0) + 1, 0);
        for (k, n) in self.at.iter().enumerate() {
            let most = &mut most[block(k)];
            *most = (*most).max(*n);
        }
        self.map(|k, _| most[block(k)])
    }

    /// Some of the rows, the first pixel of which lies there.
    fn rows(&self, pixels: std::ops::Range<usize>, min: [u32; 2]) -> Self {
        let at = self.at[pixels].to_vec();
        Self { most: at.iter().copied().max().unwrap_or(0), at, min, width: self.width }
    }

    /// Pixels that differ from a neighbour.
    fn edges(&self, of: &[[f32; 3]], differ: impl Fn(&[f32; 3], &[f32; 3]) -> bool) -> Vec<bool> {
        let mut edges = vec![false; of.len()];
        for k in 0..of.len() {
            let right = Some(k + 1).filter(|right| !right.is_multiple_of(self.width));
            for other in [right, Some(k + self.width)].into_iter().flatten().filter(|k| *k < of.len()) {
                // An edge between two pixels is one of both.
                if differ(&of[k], &of[other]) {
                    (edges[k], edges[other]) = (true, true);
                }
            }
        }
        edges
    }

    /// How many camera rays are sent in all where there are edges, `many` times as many as there are samples; 0 elsewhere.
    fn further(&self, edges: &[bool], many: u32) -> Self {
        let least = FIRST_CHECK.max(many * FIRST_CHECK / 4);
        let wanted = |n: u32| n.saturating_mul(many).next_power_of_two().clamp(least, ENOUGH.max(n));
        self.map(|k, n| if n < ENOUGH && edges[k] { wanted(n) } else { 0 }).by_blocks()
    }

    /// The number at a pixel of the whole picture.
    fn near(&self, [x, y]: [u32; 2]) -> u32 {
        // A block that the crop cuts is asked for at its first pixel inside.
        let at = [0, 1].map(|a| ([x, y][a].max(self.min[a]) - self.min[a]) as usize);
        if at[0] >= self.width { 0 } else { self.at.get(at[1] * self.width + at[0]).copied().unwrap_or(0) }
    }
}

/// A film of what camera rays see, with so many samples.
fn film(job: &Job, path: PathTracer, settings: Settings, counts: &Counts) -> Result<Film, Error> {
    let mut numbers: Vec<u32> = counts.at.iter().copied().filter(|n| *n > 0).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let mut render = Render::by(&job.world, AnyIntegrator::Path(path), settings, None)?;
    for number in numbers {
        render.end_blocks(|first| counts.near(first) < number);
        render.advance(number - render.samples_done());
    }
    Ok(render.into_film())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(at: Vec<u32>, width: usize, min: [u32; 2]) -> Counts {
        Counts { most: at.iter().copied().max().unwrap_or(0), at, width, min }
    }

    #[test]
    fn blocks_with_edges_get_more() {
        // 20 x 9 pixels from (4, 4) on: columns of blocks begin at 0, 4 and 12, rows at 0 and 4.
        let few = counts(vec![16; 180], 20, [4, 4]);
        let mut rgb = vec![[1.0; 3]; 180];
        assert_eq!(few.further(&few.edges(&rgb, differ_in_part), MANY).most, 0);
        rgb[5 * 20 + 14] = [1.0, 3.0, 1.0];
        let more = few.further(&few.edges(&rgb, differ_in_part), MANY);
        for (k, n) in more.at.iter().enumerate() {
            let [x, y] = [k % 20, k / 20];
            assert_eq!(*n, if (12..20).contains(&x) && y >= 4 { 128 } else { 0 }, "{x} {y}");
        }
        assert_eq!(
            (more.near([16, 8]), more.near([0, 0]), more.near([24, 8]), more.near([64, 64])),
            (128, 0, 0, 0)
        );
        // Those that have many need none.
        assert_eq!(
            counts(vec![256; 180], 20, [4, 4]).further(&few.edges(&rgb, differ_in_part), MANY).most,
            0
        );
        assert_eq!(
            counts(vec![100; 180], 20, [4, 4]).further(&few.edges(&rgb, differ_in_part), MANY).most,
            256
        );
        // A slow camera sends twice as many.
        assert_eq!(few.further(&few.edges(&rgb, differ_in_part), FEW).most, 32);
        assert_eq!(
            counts(vec![200; 180], 20, [4, 4]).further(&few.edges(&rgb, differ_in_part), FEW).most,
            256
        );
    }
}
