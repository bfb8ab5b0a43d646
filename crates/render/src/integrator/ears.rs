//! Roulette and splitting by what a path's continuation brings for what it costs (Rath and others 2022, "EARS: Efficiency-Aware Russian Roulette and Splitting").
//!
//! A path arrives at a vertex with a share T of its light that reaches the film, in parts of the pixel's brightness. How many rays go on from there is
//!
//! ```text
//! s = T sqrt(V / C) sqrt(C' / V')
//! ```
//!
//! with V the variance of what one of them brings back and C the rays that this costs; V' is the mean variance of a sample, in parts of its pixel's brightness
//! squared, and C' its mean cost. Where s would be below 1, the second moment stands in place of the variance: a path that is ended brings 0. Where the one is below
//! 1 and the other above, one ray goes on.
//!
//! The paper learns these numbers while it renders, and goes back and forth between them and the rule. Here they are learnt once, before the
//! render, by paths of their own that are ended by the root of what they carry, and are frozen then: in cells of a coarse grid over the scene, each with something of
//! its surroundings where few paths came by. They depend on the world, the integrator and the size of the picture alone, not on seed, samples or threads, so that a
//! picture's bits stay what they are, and no sample depends on what another found: whatever they say, the mean is right.

use super::PathTracer;
use super::vertex::Vertex;
use crate::camera::FilmPoint;
use crate::footprint::PackedFootprint;
use crate::lanes::{Lanes, Rgb, Wavelengths};
use crate::light::Receiver;
use crate::light::links::ALL;
use crate::world::World;
use rayon::prelude::*;
use straal_color::Light;
use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_math::{Vec3, ops};

/// Cells along each axis of the scene, and of those whose surroundings are looked at together.
const SIDE: usize = 16;
const COARSE: usize = 4;

/// About so many blocks of the picture are looked at, each by so many pixels of two samples.
const BLOCKS: u32 = 1024;
const PIXELS: u32 = 8;

/// What all that surrounds a cell counts, in paths of its own.
const PRIOR: f64 = 16.0;

/// Paths of so many edges end.
const LONGEST: u32 = 64;

/// What a path finds counts no more than so many times the mean, and a pixel's variance no more than so many times its brightness squared: a single bright dot
/// would decide about everything else.
const OUTLIER: f64 = 50.0;

/// The least and the most that the rule may ask for, as in the paper.
const LEAST: f32 = 0.05;
const MOST: f32 = 20.0;

/// Seed of the paths that look around: those of no picture.
const SEED: u64 = 0xea25_0000_0000_2022;

/// What is known of the scene, for the rule.
#[derive(Clone, Debug)]
pub struct Ears {
    /// The grid's first corner, and cells a metre.
    corner: Vec3,
    scale: Vec3,
    cells: Vec<Cell>,
    /// Brightness of the picture, block by block, and pixels along a block.
    blocks: Vec<f32>,
    across: u32,
    step: u32,
}

/// By what the share that a path carries is multiplied in a cell.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    to_split: f32,
    to_end: f32,
}

/// What came of one way on from a vertex.
#[derive(Clone, Copy)]
struct Found {
    cell: u32,
    light: f32,
    rays: f32,
}

/// What came of a path.
#[derive(Clone, Copy, Default)]
struct Whole {
    light: f32,
    rays: f32,
}

/// Sums over ways on.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    light: f64,
    square: f64,
    rays: f64,
}

impl Sums {
    fn add(&mut self, light: f64, rays: f64) {
        self.count += 1.0;
        self.light += light;
        self.square += light * light;
        self.rays += rays;
    }

    fn join(&mut self, o: &Self) {
        self.count += o.count;
        self.light += o.light;
        self.square += o.square;
        self.rays += o.rays;
    }

    /// Means, in which something else counts as some of its own.
    fn means(&self, prior: [f64; 3]) -> [f64; 3] {
        let all = self.count + PRIOR;
        let own = [self.light, self.square, self.rays];
        std::array::from_fn(|k| (own[k] + PRIOR * prior[k]) / all)
    }
}

impl Ears {
    /// Looks around in a world, for a picture of that size.
    pub(crate) fn learn(world: &World, path: &PathTracer, size: [u32; 2]) -> Self {
        if world.tables.is_spectral() {
            Self::learn_by::<Wavelengths>(world, path, size)
        } else {
            Self::learn_by::<Rgb>(world, path, size)
        }
    }

    fn learn_by<L: Lanes>(world: &World, path: &PathTracer, size: [u32; 2]) -> Self {
        let bounds = world.accel.bounds();
        let (corner, extent) = if bounds.is_empty() || !bounds.is_finite() {
            (Vec3::splat(-1.0), Vec3::splat(2.0))
        } else {
            (bounds.min, bounds.extent())
        };
        let scale = |length: f32| if length > 0.0 { SIDE as f32 / length } else { 0.0 };
        let scale = Vec3::new(scale(extent.x), scale(extent.y), scale(extent.z));
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let step = (1..=u32::MAX).find(|s| pixels / (u64::from(*s) * u64::from(*s)) <= u64::from(BLOCKS));
        let step = step.unwrap_or(1);
        let [across, down] = size.map(|v| v.div_ceil(step).max(1));
        let mut ears = Self { corner, scale, cells: Vec::new(), blocks: Vec::new(), across, step };

        // Each row by itself, and all of them put together in order: whichever threads took them.
        let rows: Vec<(Vec<Whole>, Vec<Found>)> = (0..down)
            .into_par_iter()
            .map(|y| {
                let (mut wholes, mut found) = (Vec::new(), Vec::new());
                for x in 0..across {
                    for k in 0..PIXELS {
                        let place = Pattern::Sobol.d2(&SampleName::new(SEED, [x, y], k), Purpose::Custom);
                        let within = |block: u32, u: f32, size: u32| {
                            (block * step + (u * step as f32) as u32).min(size.saturating_sub(1))
                        };
                        let pixel = [within(x, place[0], size[0]), within(y, place[1], size[1])];
                        for half in 0..2 {
                            wholes.push(ears.look::<L>(world, path, (pixel, 2 * k + half), &mut found));
                        }
                    }
                }
                (wholes, found)
            })
            .collect();
        let wholes: Vec<Whole> = rows.iter().flat_map(|(wholes, _)| wholes).copied().collect();
        let worth = ears.see_picture(&wholes);
        ears.see_scene(rows.iter().flat_map(|(_, found)| found), worth);
        ears
    }

    /// The picture's brightness, block by block; gives the root of its cost over its variance.
    fn see_picture(&mut self, wholes: &[Whole]) -> f64 {
        let per_block = 2 * PIXELS as usize;
        let means: Vec<f64> = wholes
            .chunks(per_block)
            .map(|all| all.iter().map(|w| f64::from(w.light)).sum::<f64>() / per_block as f64)
            .collect();
        let mean = means.iter().sum::<f64>() / means.len().max(1) as f64;
        let [across, down] = [self.across as usize, means.len() / self.across.max(1) as usize];
        // With the neighbours, and not as dark as to ask for all there is.
        let smooth = |i: usize| {
            let (x, y) = (i % across, i / across);
            let (columns, rows) =
                (x.saturating_sub(1)..(x + 2).min(across), y.saturating_sub(1)..(y + 2).min(down));
            let all = rows.flat_map(|y| columns.clone().map(move |x| y * across + x));
            let (sum, count) = all.fold((0.0, 0.0), |(sum, count), i| (sum + means[i], count + 1.0));
            sum / count + 0.05 * mean
        };
        self.blocks = (0..means.len()).map(|i| smooth(i) as f32).collect();
        let mut variance = 0.0;
        for (i, all) in wholes.chunks(per_block).enumerate() {
            let square = f64::from(self.blocks[i]) * f64::from(self.blocks[i]);
            let of_block: f64 = all
                .chunks(2)
                .map(|two| match two {
                    [a, b] => {
                        0.5 * (f64::from(a.light) - f64::from(b.light))
                            * (f64::from(a.light) - f64::from(b.light))
                    }
                    _ => 0.0,
                })
                .sum();
            let relative = of_block / f64::from(PIXELS) / square;
            // What isn't a number, of a picture that is black, asks for nothing.
            variance += if relative < OUTLIER { relative } else { OUTLIER };
        }
        let rays: f64 = wholes.iter().map(|w| f64::from(w.rays)).sum();
        let (variance, cost) = (variance / means.len().max(1) as f64, rays / wholes.len().max(1) as f64);
        (cost / if variance > 1e-6 { variance } else { 1e-6 }).sqrt()
    }

    /// What ways on bring and cost, cell by cell.
    fn see_scene<'a>(&mut self, found: impl Iterator<Item = &'a Found> + Clone, worth: f64) {
        let (sum, count) = found.clone().fold((0.0, 0.0), |(s, n), f| (s + f64::from(f.light), n + 1.0));
        let most = if sum > 0.0 { OUTLIER * sum / count } else { 0.0 };
        let mut fine = vec![Sums::default(); SIDE * SIDE * SIDE];
        for f in found {
            let light = f64::from(f.light);
            fine[f.cell as usize].add(if light < most { light } else { most }, f64::from(f.rays));
        }
        let parent = |cell: usize| {
            let part = SIDE / COARSE;
            let [x, y, z] = [cell % SIDE, cell / SIDE % SIDE, cell / (SIDE * SIDE)].map(|v| v / part);
            (z * COARSE + y) * COARSE + x
        };
        let (mut coarse, mut all) = (vec![Sums::default(); COARSE * COARSE * COARSE], Sums::default());
        for (i, sums) in fine.iter().enumerate() {
            coarse[parent(i)].join(sums);
            all.join(sums);
        }
        let of_all = if all.count > 0.0 {
            [all.light, all.square, all.rays].map(|v| v / all.count)
        } else {
            [0.0, 0.0, 1.0]
        };
        let coarse: Vec<[f64; 3]> = coarse.iter().map(|sums| sums.means(of_all)).collect();
        let cell = |(i, sums): (usize, &Sums)| {
            let [light, square, rays] = sums.means(coarse[parent(i)]);
            let variance = square - light * light;
            let cost = if rays > 1.0 { rays } else { 1.0 };
            let of = |moment: f64| (worth * (if moment > 0.0 { moment } else { 0.0 } / cost).sqrt()) as f32;
            Cell { to_split: of(variance), to_end: of(square) }
        };
        self.cells = fine.iter().enumerate().map(cell).collect();
    }

    /// One over the brightness of the picture about a pixel.
    pub(super) fn per_brightness(&self, pixel: [u32; 2]) -> f32 {
        let [x, y] = pixel.map(|v| v / self.step);
        let brightness = self.blocks.get((y * self.across + x) as usize).copied().unwrap_or(0.0);
        if brightness > 0.0 { 1.0 / brightness } else { 0.0 }
    }

    /// How many rays shall go on from a vertex, on average; `carried` in parts of the pixel's brightness.
    pub(super) fn rays_from(&self, p: Vec3, carried: f32) -> f32 {
        let Cell { to_split, to_end } = self.cells.get(self.cell(p) as usize).copied().unwrap_or_default();
        let (split, stay) = (carried * to_split, carried * to_end);
        if split > 1.0 {
            ops::min(split, MOST)
        } else if stay < 1.0 {
            ops::max(stay, LEAST)
        } else {
            1.0
        }
    }

    fn cell(&self, p: Vec3) -> u32 {
        let r = p - self.corner;
        // What is below 0, or no number, becomes 0.
        let [x, y, z] =
            [r.x * self.scale.x, r.y * self.scale.y, r.z * self.scale.z].map(|v| (v as usize).min(SIDE - 1));
        ((z * SIDE + y) * SIDE + x) as u32
    }

    /// Follows one path, and tells what came of each way on.
    fn look<L: Lanes>(
        &self,
        world: &World,
        path: &PathTracer,
        (pixel, index): ([u32; 2], u32),
        found: &mut Vec<Found>,
    ) -> Whole {
        let pattern = Pattern::Sobol;
        let mut name = pattern.name(SEED, pixel, index);
        let [x, y, u, v] = pattern.d4(&name, Purpose::Film);
        let position = [pixel[0] as f32 + x, pixel[1] as f32 + y];
        let at = FilmPoint { pixel, position, lens: [u, v], time: pattern.d1(&name, Purpose::Time) };
        let drawn = if L::DRAWN { pattern.d1(&name, Purpose::Wavelength) } else { 0.0 };
        let mut lanes = L::drawn(&world.tables, drawn);
        let Some(mut ray) = world.camera.ray(&at) else { return Whole::default() };
        ray.mask = world.camera_mask();
        let mut beta = lanes.full();
        let (mut from, mut pdf, mut delta, mut class) = (Receiver::anywhere(Vec3::ZERO), 0.0, true, ALL);
        let (mut whole, first) = (Whole::default(), found.len());
        // By way on from a vertex: what it carried there, and rays before.
        let mut ways: Vec<(f32, f32)> = Vec::new();
        for depth in 1..=path.max_depth.min(LONGEST) {
            let mut gain = |whole: &mut Whole, light: Light| {
                let light = light.max_lane();
                let is_light = light > 0.0 && light.is_finite();
                if !is_light {
                    return;
                }
                whole.light += light;
                for (way, found) in ways.iter().zip(&mut found[first..]) {
                    found.light += light / way.0;
                }
            };
            whole.rays += 1.0;
            let mut hit = world.closest_of(&ray);
            if world.meets_mask(&hit) {
                let u = pattern.d1(&name, Purpose::Opacity);
                world.go_past_masks(&ray, &mut hit, u, |ray| world.closest_of(ray));
            }
            let reading = world.reading(lanes);
            if !hit.is_hit() {
                for (i, emitter) in world.environments().filter(|(i, _)| world.links.light(class, *i)) {
                    let (radiance, by_light) = emitter.radiance_pdf_from(&from, ray.d, &reading);
                    let by_light = || world.lights_of(class).pmf(i, &from) * by_light;
                    let weight = path.weight(delta, (pdf, by_light));
                    gain(&mut whole, beta * radiance * weight);
                }
                break;
            }
            let draw = |purpose| pattern.d1(&name, purpose);
            let vertex = Vertex::new(world, (&ray, &hit), &PackedFootprint::NONE, lanes, draw);
            let point = &vertex.surface.point;
            if let Some(emitter) = vertex.surface.emitter.filter(|e| world.links.light(class, *e)) {
                let radiance = world.emitted(emitter, (&ray, &hit), point, lanes);
                let by_light = || world.light_pdf(emitter, (class, &from), &hit, point);
                let weight = path.weight(delta, (pdf, by_light));
                gain(&mut whole, beta * radiance * weight);
            }
            if vertex.is_black() || depth == path.max_depth {
                break;
            }
            class = world.links.class_of(&hit);
            let receiver = vertex.receiver();
            if !vertex.shaded.bsdf.is_delta() {
                let lights = world.lights_of(class);
                let [u, v] = pattern.d2(&name, Purpose::LightPoint);
                let light = { lights.pick(u, &receiver, world.within()) }.and_then(|pick| {
                    Some((pick.index, world.sample_picked((lights, &pick), &receiver, v, lanes)?))
                });
                if let Some((emitter, light)) = light {
                    let (value, by_bsdf) = vertex.scattered(&light);
                    let weight = if light.delta { 1.0 } else { path.technique.of_light(light.pdf, by_bsdf) };
                    let brought = beta * value;
                    if !brought.is_black() {
                        whole.rays += 1.0;
                        let free = world.passes(&vertex.shadow_ray(world, (emitter, &light), &ray));
                        gain(&mut whole, brought * free.counts(weight));
                    }
                }
            }
            let [u, v, lobe] = pattern.d3(&name, Purpose::Direction);
            let Some(on) = vertex.draw([lobe, u, v]) else { break };
            let carried = beta.max_lane();
            let is_carried = carried > 0.0 && carried.is_finite();
            if !is_carried {
                break;
            }
            ways.push((carried, whole.rays));
            found.push(Found { cell: self.cell(point.p), light: 0.0, rays: 0.0 });
            beta *= on.weight;
            if on.wavelength > 0.0 {
                lanes = lanes.only(on.wavelength);
            }
            if depth >= path.roulette_depth {
                let survive = ops::min(beta.max_lane().sqrt(), 0.95);
                if pattern.d1(&name, Purpose::Roulette) >= survive {
                    break;
                }
                beta *= 1.0 / survive;
            }
            if beta.is_black() {
                break;
            }
            ray = vertex.leave(on.wi, &ray);
            (from, pdf, delta, name) = (receiver, on.pdf, on.delta, name.child(0));
        }
        for (way, found) in ways.iter().zip(&mut found[first..]) {
            found.rays = whole.rays - way.1;
        }
        whole
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ears(cells: Cell) -> Ears {
        Ears {
            corner: Vec3::ZERO,
            scale: Vec3::ONE,
            cells: vec![cells; SIDE * SIDE * SIDE],
            blocks: vec![4.0, 0.0],
            across: 2,
            step: 8,
        }
    }

    #[test]
    fn the_rule_splits_by_variance_and_ends_by_the_second_moment() {
        let ears = ears(Cell { to_split: 0.5, to_end: 2.0 });
        let asked = |carried| ears.rays_from(Vec3::splat(3.0), carried);
        assert_eq!([asked(4.0), asked(1.0), asked(0.25), asked(0.0)], [2.0, 1.0, 0.5, LEAST]);
        assert_eq!([asked(1e9), asked(f32::NAN)], [MOST, 1.0]);
        // A place beyond the grid counts as its rim.
        for p in [Vec3::splat(-1e30), Vec3::splat(f32::INFINITY), Vec3::splat(f32::NAN)] {
            assert_eq!(ears.rays_from(p, 4.0), 2.0);
        }
    }

    #[test]
    fn pixels_are_as_bright_as_their_block() {
        let ears = ears(Cell::default());
        assert_eq!([[0, 0], [7, 7], [8, 0], [0, 99]].map(|p| ears.per_brightness(p)), [0.25, 0.25, 0.0, 0.0]);
    }

    /// Of a picture of the same light everywhere and one ray a path nothing is asked; of a cell whose ways on differ more is.
    #[test]
    fn what_differs_is_split() {
        let mut ears = ears(Cell::default());
        let flat = Whole { light: 2.0, rays: 4.0 };
        let (bright, dark) = (Whole { light: 3.0, ..flat }, Whole { light: 1.0, ..flat });
        let wholes: Vec<Whole> = (0..32).map(|i| if i % 2 == 0 { bright } else { dark }).collect();
        let worth = ears.see_picture(&wholes);
        // Variance 2 of a brightness of 2, and 1.05 of it counts: 4 rays over 2 / 2.1².
        assert!((worth - (4.0 / (2.0 / (2.1 * 2.1_f64))).sqrt()).abs() < 1e-3, "{worth}");
        let even = (0..4000).map(|_| Found { cell: 0, light: 1.0, rays: 2.0 });
        let uneven =
            (0..4000).map(|i| Found { cell: 1, light: if i % 2 == 0 { 2.0 } else { 0.0 }, rays: 2.0 });
        let found: Vec<Found> = even.chain(uneven).collect();
        ears.see_scene(found.iter(), worth);
        let [a, b] = [ears.cells[0], ears.cells[1]];
        assert!(b.to_split > 5.0 * a.to_split && b.to_end > a.to_end, "{a:?} {b:?}");
        assert!((f64::from(a.to_end) - worth * 0.5_f64.sqrt()).abs() < 0.02 * worth, "{a:?}");
        assert!((f64::from(b.to_split) - worth * 0.5_f64.sqrt()).abs() < 0.02 * worth, "{b:?}");
    }
}
