//! Finished samples side by side, on their way to the pixels of a tile.
//!
//! For a film that holds nothing but light. What comes to a pixel is what its samples bring one by one ([`FilmTile::add`]), to the last bit:
//! each is rounded to single precision and to units of 2^-62, and what is added are integers.

use super::light_sum::{HIGH, LOW, LOW_BITS, LightSum, ROUND};
use super::{FilmTile, MAX_VALUE};
use straal_math::simd::{self, Double, Float, Mask, Ulong};

/// Samples that are taken together.
const MANY: usize = 2 * simd::BLOCK;

/// An integer of each sample.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Integers([u64; MANY]);

/// Samples, number by number.
pub(crate) struct Many {
    count: usize,
    /// By channel, in two integers as [`LightSum`] has them: the samples' light, then what the film adds.
    high: [Integers; 3],
    low: [Integers; 3],
    /// What the filter multiplies their light by.
    weight: [f32; MANY],
    /// Where their pixels stand in the tile.
    pixel: [u32; MANY],
    /// A bit for each whose numbers are so usual that it can be added; the others are left to [`FilmTile::add`].
    usual: u32,
}

impl Many {
    /// None.
    pub const fn new() -> Self {
        let none = Integers([0; MANY]);
        Self { count: 0, high: [none; 3], low: [none; 3], weight: [0.0; MANY], pixel: [0; MANY], usual: 0 }
    }

    /// Takes none of those that it had.
    pub const fn clear(&mut self) {
        self.count = 0;
    }

    /// Whether there is no room for another.
    pub const fn is_full(&self) -> bool {
        self.count == MANY
    }

    /// Takes a sample's red, green and blue.
    #[inline(always)]
    pub fn push(&mut self, sum: &LightSum, weight: f32, pixel: usize) {
        let i = self.count % MANY;
        self.count = i + 1;
        for c in 0..3 {
            (self.high[c].0[i], self.low[c].0[i]) = (sum.high[c] as u64, sum.low[c] as u64);
        }
        (self.weight[i], self.pixel[i]) = (weight, pixel as u32);
    }

    /// A bit for each that [`FilmTile::add_many`] leaves over.
    #[inline(always)]
    pub const fn unusual(&self) -> u32 {
        !self.usual & (((1_u64 << self.count) - 1) as u32)
    }

    /// From the samples' sums to what the film adds.
    #[inline(always)]
    pub fn round<F: Float>(&mut self) {
        self.usual = 0;
        for first in (0..self.count).step_by(F::WIDTH) {
            let mut usual = F::Mask::splat(true);
            let mut units = [(F::Ulong::splat(0), F::Ulong::splat(0)); 3];
            // Written out: iterators over vectors aren't inlined for sure.
            let mut c = 0;
            while c < 3 {
                let (high, low) = (self.high[c].load::<F>(first), self.low[c].load::<F>(first));
                let (light, is_small) = single::<F>(high, low);
                let v = light * F::load(&self.weight[first..]);
                usual = usual & is_small & v.abs().lt(F::splat(MAX_VALUE));
                units[c] = integers::<F>(v);
                c += 1;
            }
            let zero = F::Ulong::splat(0);
            c = 0;
            while c < 3 {
                let (high, low) = units[c];
                self.high[c].store::<F>(first, F::Ulong::select(usual, high, zero));
                self.low[c].store::<F>(first, F::Ulong::select(usual, low, zero));
                c += 1;
            }
            self.usual |= usual.to_bits() << first;
        }
    }
}

impl Integers {
    #[inline(always)]
    fn load<F: Float>(&self, first: usize) -> F::Ulong {
        let mut lanes = F::Ulong::splat(0).to_array();
        lanes.as_mut().copy_from_slice(&self.0[first..first + F::WIDTH]);
        F::Ulong::from_array(lanes)
    }

    #[inline(always)]
    fn store<F: Float>(&mut self, first: usize, x: F::Ulong) {
        self.0[first..first + F::WIDTH].copy_from_slice(x.to_array().as_ref());
    }
}

/// [`LightSum::light`] of one lane, and whether both numbers are small enough for it.
#[inline(always)]
fn single<F: Float>(high: F::Ulong, low: F::Ulong) -> (F, F::Mask) {
    let half = F::Ulong::splat(1 << 51);
    let large = (high.wrapping_add(half) | low.wrapping_add(half)) >> 52;
    let double = |v: F::Ulong| F::Double::from_bits(v.wrapping_add(F::Ulong::splat(ROUND.to_bits()))) - ROUND;
    let sum = (double(high) + double(low) * (1.0 / LOW)) * (1.0 / HIGH);
    (F::from_double(sum), large.eq(F::Ulong::splat(0)))
}

/// Numbers in units of 2^-14, and what is left in units of 2^-62, rounded to the nearest, halves away from 0.
#[inline(always)]
fn integers<F: Float>(v: F) -> (F::Ulong, F::Ulong) {
    let units = v.to_double() * HIGH;
    let whole = units + ROUND;
    let rest = (units - (whole - ROUND)) * LOW;
    let near = rest + ROUND;
    // A half was rounded to the even. There is none but in numbers so small that the rest is all of them.
    let off = rest - (near - ROUND);
    let half = F::Double::splat(0.5).copysign(rest);
    let near = near + F::Double::select(off.eq(half), half + half, F::Double::ZERO);
    let integer = |rounded: F::Double| rounded.to_bits().wrapping_sub(F::Ulong::splat(ROUND.to_bits()));
    (integer(whole), integer(near))
}

impl FilmTile {
    /// Adds the samples that are usual to their pixels, those of one pixel together; to a tile that [holds light
    /// alone](Self::holds_light_alone).
    #[inline(always)]
    pub(crate) fn add_many(&mut self, many: &Many) {
        let mut i = 0;
        while i < many.count {
            let pixel = many.pixel[i];
            let (mut count, mut high, mut low) = (0, [0_u64; 3], [0_u64; 3]);
            while i < many.count && many.pixel[i] == pixel {
                for c in 0..3 {
                    high[c] = high[c].wrapping_add(many.high[c].0[i]);
                    low[c] = low[c].wrapping_add(many.low[c].0[i]);
                }
                count += many.usual >> i & 1;
                i += 1;
            }
            if let Some(p) = self.pixels.get_mut(pixel as usize) {
                p.count += count;
                for (c, sum) in p.value.iter_mut().enumerate() {
                    sum.0 += (i128::from(high[c] as i64) << LOW_BITS) + i128::from(low[c] as i64);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Keep, Region, Sample};
    use super::*;
    use straal_color::Light;
    use straal_math::simd::{Isa, Kernel, Simd};

    struct Take<'a>(&'a mut Many);

    impl Kernel for Take<'_> {
        type Output = ();
        #[inline(always)]
        fn run<F: Float>(self) {
            self.0.round::<F>();
        }
    }

    /// Bright, faint and odd numbers, and those at which something is rounded, alone and added.
    #[test]
    fn many_samples_are_samples_one_by_one() {
        let tie = 1.0 / (1_u64 << 62) as f32;
        let numbers = [
            0.0,
            0.3,
            -0.3,
            1.0,
            2.0,
            17.5,
            1e-9,
            1e-12,
            1e-30,
            4e9,
            -4e9,
            5e9,
            f32::NAN,
            0.5 * tie,
            1.5 * tie,
            2.5 * tie,
            -0.5 * tie,
            -1.5 * tie,
            -2.5 * tie,
            0.75 * tie,
            3.1e-13,
            1e-40,
            0.1,
        ];
        let region = Region { min: [0, 0], max: [8, 1] };
        for simd in Isa::ALL.into_iter().filter_map(Simd::new) {
            let [mut together, mut alone] =
                [0, 1].map(|_| FilmTile::new(region, Keep { squares: false, layers: false }));
            let mut many = Many::new();
            for round in 0..200_usize {
                many.clear();
                let mut samples = Vec::new();
                for i in 0..1 + round % MANY {
                    let number = |k: usize| numbers[(round * 7 + i * k) % numbers.len()];
                    let mut sum = LightSum::default();
                    sum.add(Light::rgb([number(1), number(3), number(5)]));
                    if i % 3 == 0 {
                        sum.add(Light::rgb([0.25, number(2), 1e-3]));
                    }
                    let weight = if i % 5 == 0 { -0.7 } else { 1.0 };
                    let pixel = (i / 3 % 8) as u32;
                    many.push(&sum, weight, pixel as usize);
                    samples.push((pixel, sum.light().to_rgb().map(|v| v * weight)));
                }
                simd.run(Take(&mut many));
                together.add_many(&many);
                let unusual = many.unusual();
                for &(pixel, rgb) in
                    (0..).zip(&samples).filter(|(i, _)| unusual >> i & 1 == 1).map(|(_, s)| s)
                {
                    together.add([pixel, 0], round as u32, &Sample { rgb, ..Sample::default() }, &[]);
                }
                assert!((unusual.count_ones() as usize) < samples.len() || samples.len() < 8, "{round}");
                for (pixel, rgb) in samples {
                    alone.add([pixel, 0], round as u32, &Sample { rgb, ..Sample::default() }, &[]);
                }
                assert_eq!(together.pixels, alone.pixels, "{:?} {round}", simd.isa());
            }
        }
    }
}
