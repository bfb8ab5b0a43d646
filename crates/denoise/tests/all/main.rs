//! What a user of the crate can rely on.

mod original;
mod same_bits;

use straal_denoise::Picture;
use straal_math::Vec3;

/// A picture made of whole numbers, so that everybody makes the same.
pub(crate) struct Sample {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) color: Vec<[f32; 3]>,
    pub(crate) albedo: Vec<[f32; 3]>,
    pub(crate) normal: Vec<[f32; 3]>,
}

impl Sample {
    /// Noise on tiles that grow brighter to the right.
    pub(crate) fn new(width: usize, height: usize) -> Self {
        let mut sample = Self { width, height, color: vec![], albedo: vec![], normal: vec![] };
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let tile = ((x / 8 + y / 8) % 2) as f32;
            let albedo = [0.0, 1.0, 2.0].map(|c| 0.25 + 0.25 * tile + 0.125 * c);
            let light = 4.0 * (x as f32 + 1.0) / width as f32;
            sample.color.push(std::array::from_fn(|c| {
                let n = random(x as u32, y as u32, c as u32);
                albedo[c] * light * n * n * 3.0
            }));
            sample.albedo.push(albedo);
            let normal = Vec3::new(x as f32 / 64.0 - 0.5, y as f32 / 64.0 - 0.5, 0.75);
            sample.normal.push(normal.to_array());
        }
        sample
    }

    pub(crate) fn picture(&self, guides: bool) -> Picture<'_> {
        Picture {
            width: self.width,
            height: self.height,
            color: &self.color,
            albedo: guides.then_some(&self.albedo),
            normal: guides.then_some(&self.normal),
        }
    }
}

/// A number of [0, 1) that looks like chance.
fn random(x: u32, y: u32, k: u32) -> f32 {
    let v = x
        .wrapping_mul(374_761_393)
        .wrapping_add(y.wrapping_mul(668_265_263))
        .wrapping_add(k.wrapping_mul(2_246_822_519));
    let v = (v ^ v >> 13).wrapping_mul(1_274_126_177);
    ((v ^ v >> 16) >> 8) as f32 / (1 << 24) as f32
}
