//! Noise: numbers that differ from place to place, smoothly and without a pattern (Perlin 1985, "An Image Synthesizer"; 2002, "Improving Noise").
//!
//! At each point with whole coordinates it is 0 and has a slope, which the coordinates choose by Perlin's order of the numbers to 255; between them the
//! slopes are mixed. Which slopes there are is pbrt-v4's: its pictures come out the same.

use straal_math::{Vec3, ops};

/// Perlin's order.
const ORDER: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69, 142, 8, 99,
    37, 240, 21, 10, 23, 190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32,
    57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175, 74, 165, 71, 134, 139, 48, 27,
    166, 77, 146, 158, 231, 83, 111, 229, 122, 60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244,
    102, 143, 54, 65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169, 200, 196, 135, 130,
    116, 188, 159, 86, 164, 100, 109, 198, 173, 186, 3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38, 147,
    118, 126, 255, 82, 85, 212, 207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213, 119,
    248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9, 129, 22, 39, 253, 19, 98, 108, 110,
    79, 113, 224, 232, 178, 185, 112, 104, 218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179,
    162, 241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157, 184, 84, 204, 176,
    115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93, 222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78,
    66, 215, 61, 156, 180,
];

/// Between -1 and 1, of features as large as 1; again after 256.
pub(super) fn noise(p: Vec3) -> f32 {
    let cell = [p.x, p.y, p.z].map(f32::floor);
    let [dx, dy, dz] = [p.x - cell[0], p.y - cell[1], p.z - cell[2]];
    // Of what is no number or beyond all whole ones, 0.
    let [x, y, z] = cell.map(|v| (v.rem_euclid(256.0) as i32) as u8);
    if !(dx + dy + dz).is_finite() {
        return 0.0;
    }
    let at = |i: u8, j: u8, k: u8| {
        let along = [dx - f32::from(i), dy - f32::from(j), dz - f32::from(k)];
        slope([x.wrapping_add(i), y.wrapping_add(j), z.wrapping_add(k)], along)
    };
    let mix = |t: f32, a: f32, b: f32| a + t * (b - a);
    let [u, v, w] = [dx, dy, dz].map(eased);
    let across = |j: u8, k: u8| mix(u, at(0, j, k), at(1, j, k));
    mix(w, mix(v, across(0, 0), across(1, 0)), mix(v, across(0, 1), across(1, 1)))
}

/// From 0 to 1 with slopes and bends of 0 at both ends.
fn eased(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// The slope of a point, times the way from it.
fn slope([x, y, z]: [u8; 3], [dx, dy, dz]: [f32; 3]) -> f32 {
    let next = |before: u8, v: u8| ORDER[usize::from(before.wrapping_add(v))];
    let which = next(next(next(0, x), y), z) & 15;
    let is_flat = matches!(which, 12 | 13);
    let u = if which < 8 || is_flat { dx } else { dy };
    let v = if which < 4 || is_flat { dy } else { dz };
    let signed = |v: f32, bit: u8| if which & bit == 0 { v } else { -v };
    signed(u, 1) + signed(v, 2)
}

/// What of a sum of octaves is seen.
pub(super) struct Octaves {
    /// How many there are.
    pub most: u32,
    /// By how much each is lower than the one before.
    pub roughness: f32,
    /// The longer side of what a pixel sees, squared.
    pub seen: f32,
}

/// Each octave's features are about half of those before.
const FINER: f32 = 1.99;

/// What is left of an octave, in the mean, where it can't be seen: the mean of what noise is without its sign.
const MEAN: f32 = 0.2;

impl Octaves {
    /// How many octaves are larger than a pixel, and how much of the next one is shown, so that none springs up.
    fn visible(&self) -> (u32, f32) {
        let most = self.most as f32;
        let n = if self.seen > 0.0 { ops::clamp(-1.0 - 0.5 * ops::log2(self.seen), 0.0, most) } else { most };
        let t = ops::clamp((n - n.floor() - 0.3) / 0.4, 0.0, 1.0);
        (n as u32, t * t * (3.0 - 2.0 * t))
    }

    /// A sum of noises, each finer and lower than the one before (fractional Brownian motion).
    pub fn sum(&self, p: Vec3) -> f32 {
        let (whole, next) = self.visible();
        let (mut sum, mut finer, mut high) = (0.0, 1.0, 1.0);
        for _ in 0..whole {
            sum += high * noise(p * finer);
            finer *= FINER;
            high *= self.roughness;
        }
        if next > 0.0 { sum + high * next * noise(p * finer) } else { sum }
    }

    /// The same without signs: with creases where a noise goes through 0.
    pub fn creased(&self, p: Vec3) -> f32 {
        let (whole, next) = self.visible();
        let (mut sum, mut finer, mut high) = (0.0, 1.0, 1.0);
        for _ in 0..whole {
            sum += high * noise(p * finer).abs();
            finer *= FINER;
            high *= self.roughness;
        }
        sum += high * (MEAN + next * (noise(p * finer).abs() - MEAN));
        // pbrt counts the mean of the octave that comes and goes once more.
        for _ in whole..self.most {
            sum += high * MEAN;
            high *= self.roughness;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the same formulas give it in double precision elsewhere.
    #[test]
    fn it_is_perlins() {
        for (p, want) in [
            ([0.5, 0.5, 0.5], -0.125),
            ([157.0 / 50.0, 42.0, 7.0], 0.13692),
            ([-1.25, 2.75, 0.1], 0.00204),
            ([255.5, -0.3, 300.9], -0.444104),
        ] {
            let got = noise(Vec3::from_array(p));
            assert!((got - want).abs() < 1e-4, "{p:?}: {got}, not {want}");
        }
        let p = Vec3::new(0.3, -1.7, 2.2);
        let octaves = Octaves { most: 6, roughness: 0.5, seen: 0.0 };
        assert!((octaves.sum(p) - -0.210018).abs() < 1e-3, "{}", octaves.sum(p));
        assert!((octaves.creased(p) - 0.24154).abs() < 1e-3, "{}", octaves.creased(p));
    }

    #[test]
    fn it_is_nothing_at_whole_numbers_and_smooth_between() {
        for i in -5..5_i8 {
            let p = Vec3::new(f32::from(i), f32::from(3 * i), -f32::from(i));
            assert_eq!(noise(p), 0.0);
            let along = Vec3::new(0.3, 0.4, 0.5);
            for k in 0..40_u8 {
                let here = p + along * (f32::from(k) * 0.1);
                let step = noise(here + along * 1e-3) - noise(here);
                assert!(noise(here).abs() <= 1.0 && step.abs() < 5e-3, "{here:?}: {step}");
            }
        }
        for odd in [f32::NAN, f32::INFINITY, 3e38] {
            assert!(noise(Vec3::new(odd, 0.5, 0.5)).is_finite());
        }
    }

    #[test]
    fn what_is_finer_than_a_pixel_is_left_out() {
        let p = Vec3::new(0.3, -1.7, 2.2);
        let of = |most, size: f32| Octaves { most, roughness: 0.5, seen: size * size };
        // A pixel of 1/32 sees four octaves.
        assert_eq!(of(8, 1.0 / 32.0).sum(p), of(4, 0.0).sum(p));
        assert_eq!(of(8, 2.0).sum(p), 0.0);
        assert!((of(8, 2.0).creased(p) - 0.2 * (1.0 + 2.0 * (1.0 - 1.0 / 256.0))).abs() < 1e-5);
    }
}
