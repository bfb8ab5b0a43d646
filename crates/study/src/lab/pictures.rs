//! Where rays are expensive: camera rays through the middles of pixels, by the steps that each takes and the
//! primitives that it tests. A step is a node opened, a cell entered or a volume tested: boxes alone would make structures look
//! cheap that go by planes or cells and test none.

use crate::false_colour::{Chart, Scale};
use straal_accel::Scene;
use straal_render::camera::FilmPoint;
use straal_render::world::World;

/// Cost pictures of several structures on one scale.
#[derive(Clone, Debug)]
pub struct CostPictures {
    /// What all of them share: logarithmic, since structures differ by factors.
    pub scale: Scale,
    /// In the order of the rows.
    pub each: Vec<CostPicture>,
}

/// Where the rays of one structure are expensive.
#[derive(Clone, Debug, PartialEq)]
pub struct CostPicture {
    /// Of the structure.
    pub name: String,
    /// In pixels.
    pub width: usize,
    /// Steps and tests, row by row from the top.
    pub tests: Vec<f32>,
    /// Pixels in a row that share a ray, for structures that would take too long otherwise.
    pub block: usize,
}

/// What the numbers are.
pub const CAPTION: &str = "steps and primitives a camera ray";

/// Width in pixels, unless the picture is high.
const SIDE: u32 = 256;

impl CostPicture {
    /// In colours.
    pub fn chart(&self, scale: Scale) -> Chart {
        Chart::of(&self.tests, self.width, scale)
    }
}

/// One picture for each structure, none of which takes many more than `most_tests`; `film` is the size that the world's
/// camera was made for.
pub(crate) fn draw<'a>(
    world: &World,
    film: [u32; 2],
    most_tests: u64,
    scenes: impl Iterator<Item = (&'a str, &'a Scene)>,
) -> CostPictures {
    let size = size(film);
    let each: Vec<CostPicture> = scenes
        .map(|(name, scene)| {
            // A coarse picture tells what a fine one would take.
            let coarse = tests(world, film, size, (scene, 32));
            let mean = coarse.iter().map(|&t| f64::from(t)).sum::<f64>() / coarse.len().max(1) as f64;
            let pixels = f64::from(size[0]) * f64::from(size[1]);
            let block = ((mean * pixels / most_tests as f64).sqrt().ceil() as u32).clamp(1, 32);
            CostPicture {
                name: name.to_owned(),
                width: size[0] as usize,
                tests: tests(world, film, size, (scene, block)),
                block: block as usize,
            }
        })
        .collect();
    CostPictures { scale: Scale::of_magnitudes(each.iter().flat_map(|p| &p.tests)), each }
}

/// The longer side is [`SIDE`].
fn size([w, h]: [u32; 2]) -> [u32; 2] {
    let long = w.max(h).max(1);
    [w, h].map(|n| (n * SIDE).div_ceil(long).clamp(1, SIDE))
}

/// Steps and tests of a ray for each block of pixels, spread over its pixels.
fn tests(world: &World, film: [u32; 2], [w, h]: [u32; 2], (scene, block): (&Scene, u32)) -> Vec<f32> {
    let scale = [film[0] as f32 / w as f32, film[1] as f32 / h as f32];
    let across = w.div_ceil(block);
    let blocks: Vec<f32> = (0..h.div_ceil(block) * across)
        .map(|i| {
            let middle = |at: u32, most: u32| {
                let (low, high) = (at * block, ((at + 1) * block).min(most));
                (low + high) as f32 * 0.5
            };
            let (x, y) = (middle(i % across, w), middle(i / across, h));
            let at = FilmPoint::at([x * scale[0], y * scale[1]]);
            world.camera.ray(&at).map_or(0.0, |ray| {
                let cost = scene.closest_counted(&world.geometry, &ray).1;
                cost.nodes as f32 + cost.primitives as f32
            })
        })
        .collect();
    let pixel = |i: u32| blocks[((i / w / block) * across + i % w / block) as usize];
    (0..w * h).map(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_keep_their_shape_and_their_bounds() {
        assert_eq!(size([800, 400]), [256, 128]);
        assert_eq!(size([400, 800]), [128, 256]);
        assert_eq!(size([65536, 1]), [256, 1]);
        assert_eq!(size([3, 3]), [256, 256]);
    }
}
