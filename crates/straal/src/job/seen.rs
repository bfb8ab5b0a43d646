//! The light that camera rays see themselves: lamps and surroundings.
//!
//! A pixel on a lamp's edge is as bright as its samples have met the lamp, and a network can't know how much of the pixel it really fills: it keeps what the samples say, and
//! smears a hundred times the wall's light over its neighbours. But this part of the light needs no paths. Camera rays alone find it, so that it is
//! taken off the picture, sample by sample the same, and what four times as many camera rays see of it is put in its place
//! (a control variate; Glasserman 2003, "Monte Carlo Methods in Financial Engineering", section 4.1). Where it is even, or samples are many, it is put back as it was.
//!
//! Lamps are put back after the network, which never sees them. Where surroundings shine, they are much of the picture, and no brighter than the rest; measured, the network
//! does better by seeing them.

use super::Job;
use crate::resolve::Error;
use straal_render::driver::Render;
use straal_render::film::{BLOCK, FIRST_CHECK, Film, HalfPictures, Layers};
use straal_render::integrator::{AnyIntegrator, PathTracer};
use straal_render::settings::Settings;

/// Camera rays of a pixel, from which on its own are enough.
const ENOUGH: u32 = 256;

/// By how much neighbours differ where more rays are sent, relative to the brighter one.
const EDGE: f32 = 0.02;

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
    /// What camera rays see of the light in a film of this job's own samples, if its integrator adds that up and its samples can be taken again.
    pub(super) fn seen_light(&self, of: &Film) -> Result<Option<SeenLight>, Error> {
        // The others show lamps in ways of their own, or none.
        let path = match &self.integrator {
            AnyIntegrator::Path(path) => *path,
            AnyIntegrator::Direct(_) => PathTracer::default(),
            _ => return Ok(None),
        };
        if self.settings.splat || self.first > 0 || !self.world.shows_lights() {
            return Ok(None);
        }
        let path = PathTracer { max_depth: 1, ..path };
        let counts = Counts::of(&of.layers(), self.settings.crop.min);
        if counts.most == 0 {
            return Ok(None);
        }
        let plain = Settings { cost: false, ..self.settings.clone() };
        let own = film(self, path, plain.clone(), &counts.capped())?;
        let rgb = own.layers().rgb;
        let halves = own.halves().map_or_else(|| [rgb.clone(), rgb.clone()], |HalfPictures { rgb, .. }| rgb);
        // What has more samples than were taken again has seen it well enough.
        let halves = halves.map(|mut half| {
            for (k, v) in half.iter_mut().enumerate() {
                if counts.at[k] > ENOUGH {
                    *v = rgb[k];
                }
            }
            half
        });
        let ends = counts.further(&rgb);
        let more = if ends.most == 0 {
            rgb.clone()
        } else {
            let lean = Settings { blocks: true, halves: false, error: false, layers: false, ..plain };
            let more = film(self, path, lean, &ends)?;
            let mut more = more.layers().rgb;
            for (k, v) in more.iter_mut().enumerate() {
                if ends.at[k] == 0 {
                    *v = rgb[k];
                }
            }
            more
        };
        Ok(Some(SeenLight { own: rgb, halves, more, is_apart: !self.world.has_environment() }))
    }
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

    /// How many camera rays are sent in all where light that they see has edges; 0 elsewhere.
    fn further(&self, rgb: &[[f32; 3]]) -> Self {
        let differ = |a: &[f32; 3], b: &[f32; 3]| {
            a.iter().zip(b).any(|(a, b)| (a - b).abs() > EDGE * if a > b { *a } else { *b })
        };
        let is_edge = |k: usize| {
            let right = !(k + 1).is_multiple_of(self.width) && differ(&rgb[k], &rgb[k + 1]);
            right || rgb.get(k + self.width).is_some_and(|below| differ(&rgb[k], below))
        };
        let edges: Vec<bool> = (0..rgb.len()).map(is_edge).collect();
        // An edge between two pixels is one of both.
        let touches = |k: usize| {
            let left = !k.is_multiple_of(self.width) && edges[k - 1];
            edges[k] || left || k.checked_sub(self.width).is_some_and(|above| edges[above])
        };
        let wanted = |n: u32| n.saturating_mul(4).next_power_of_two().clamp(2 * FIRST_CHECK, ENOUGH.max(n));
        self.map(|k, n| if n < ENOUGH && touches(k) { wanted(n) } else { 0 }).by_blocks()
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
        assert_eq!(few.further(&rgb).most, 0);
        rgb[5 * 20 + 14] = [1.0, 3.0, 1.0];
        let more = few.further(&rgb);
        for (k, n) in more.at.iter().enumerate() {
            let [x, y] = [k % 20, k / 20];
            assert_eq!(*n, if (12..20).contains(&x) && y >= 4 { 64 } else { 0 }, "{x} {y}");
        }
        assert_eq!(
            (more.near([16, 8]), more.near([0, 0]), more.near([24, 8]), more.near([64, 64])),
            (64, 0, 0, 0)
        );
        // Those that have many need none.
        assert_eq!(counts(vec![256; 180], 20, [4, 4]).further(&rgb).most, 0);
        assert_eq!(counts(vec![100; 180], 20, [4, 4]).further(&rgb).most, 256);
    }
}
