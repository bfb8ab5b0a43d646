//! What turns the name of a sample into numbers.

use super::blue::Order;
use super::halton::Halton;
use super::padded::padded;
use super::set::{Hammersley, Jittered, MultiJittered, NRooks, Regular, Set};
use super::{PatternKind, Purpose, SampleName, mix, sobol, to_unit};
use crate::simd::{Float, Uint, Ulong};

/// How the numbers of one name and purpose lie over the samples of a pixel. All are in [0, 1), strictly below 1, and
/// multiples of 2^-24.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Pattern {
    /// Independent.
    Random,
    /// Padded Sobol, its order shuffled and its digits scrambled after Owen, by hashes (Burley 2020, "Practical
    /// Hash-based Owen Scrambling"). Any 2^k samples from a multiple of 2^k on are stratified in each purpose; a direction and
    /// what is drawn where it leads are spread together, see [`SampleName::place`].
    #[default]
    Sobol,
    /// Sobol's points along a shuffled Morton curve through all pixels (Ahmed and Wonka 2020, "Screen-Space Blue-Noise
    /// Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels").
    BlueSobol(Order),
    /// Padded Halton points of bases 2 and 3, digits scrambled after Owen, shuffled in blocks of 6^k.
    Halton,
    /// The middles of the cells of a grid; a set of another number than columns times rows leaves the last row short.
    Regular(Set),
    /// A point anywhere in each cell of a grid (Cook 1986).
    Jittered(Set),
    /// One point in each row and column of a grid of n x n cells, else at random (Shirley 1991).
    NRooks(Set),
    /// Jittered and n-rooks at once, the places within cells correlated (Kensler 2013, "Correlated Multi-Jittered
    /// Sampling").
    MultiJittered(Set),
    /// i/n turned by a random shift, and the scrambled binary fraction of i (Hammersley 1960).
    Hammersley(Set),
}

impl Pattern {
    /// The pattern for `count` samples of each pixel, from 1 to 2^18. Kinds that don't need to know how many there are
    /// don't look at it.
    pub fn new(kind: PatternKind, count: u32) -> Self {
        let set = Set::new(count);
        match kind {
            PatternKind::Random => Self::Random,
            PatternKind::Sobol => Self::Sobol,
            PatternKind::BlueSobol => Self::BlueSobol(Order::new(count)),
            PatternKind::Halton => Self::Halton,
            PatternKind::Regular => Self::Regular(set),
            PatternKind::Jittered => Self::Jittered(set),
            PatternKind::NRooks => Self::NRooks(set),
            PatternKind::MultiJittered => Self::MultiJittered(set),
            PatternKind::Hammersley => Self::Hammersley(set),
        }
    }

    /// Its name.
    pub const fn kind(&self) -> PatternKind {
        match self {
            Self::Random => PatternKind::Random,
            Self::Sobol => PatternKind::Sobol,
            Self::BlueSobol(_) => PatternKind::BlueSobol,
            Self::Halton => PatternKind::Halton,
            Self::Regular(_) => PatternKind::Regular,
            Self::Jittered(_) => PatternKind::Jittered,
            Self::NRooks(_) => PatternKind::NRooks,
            Self::MultiJittered(_) => PatternKind::MultiJittered,
            Self::Hammersley(_) => PatternKind::Hammersley,
        }
    }

    /// The name at the camera of sample `index` of a pixel of the whole picture.
    #[inline]
    pub fn name(&self, seed: u64, pixel: [u32; 2], index: u32) -> SampleName {
        match self {
            Self::BlueSobol(_) => Order::name(seed, pixel, index),
            _ => SampleName::new(seed, pixel, index),
        }
    }

    /// As [`Pattern::name`], for a pixel and a sample in each lane.
    #[inline(always)]
    pub fn names<F: Float>(&self, seed: u64, pixel: [F::Uint; 2], index: F::Uint) -> SampleName<F> {
        match self {
            Self::BlueSobol(_) => {
                SampleName::from_fn(|i| Order::name(seed, pixel.map(|p| p.lane(i)), index.lane(i)))
            }
            _ => SampleName::side_by_side(seed, pixel, index),
        }
    }

    /// One number.
    #[inline(always)]
    pub fn d1<F: Float>(self, name: &SampleName<F>, purpose: Purpose) -> F {
        let stream = name.stream(purpose);
        match self {
            Self::Random => to_unit(random(stream, name, 0).low()),
            Self::Sobol => to_unit(sobol::d1(stream, name.place_for(purpose))),
            _ => self.lane_by_lane::<F, 1>(name, purpose)[0],
        }
    }

    /// Two numbers, as well spread over the square as the pattern can. With [`Self::Sobol`] a (0,2)-sequence in base 2.
    #[inline(always)]
    pub fn d2<F: Float>(self, name: &SampleName<F>, purpose: Purpose) -> [F; 2] {
        let stream = name.stream(purpose);
        match self {
            Self::Random => {
                let r = random(stream, name, 0);
                [to_unit(r.low()), to_unit(r.high())]
            }
            Self::Sobol => {
                let [a, b] = sobol::d2(stream, name.place_for(purpose));
                [to_unit(a), to_unit(b)]
            }
            _ => self.lane_by_lane(name, purpose),
        }
    }

    /// Three numbers. The first two are those that [`Self::d2`] gives; cheaper than one number and two.
    #[inline(always)]
    pub fn d3<F: Float>(self, name: &SampleName<F>, purpose: Purpose) -> [F; 3] {
        let stream = name.stream(purpose);
        match self {
            Self::Random => {
                let (r, s) = (random(stream, name, 0), random(stream, name, 1));
                [to_unit(r.low()), to_unit(r.high()), to_unit(s.low())]
            }
            Self::Sobol => {
                let [a, b, c] = sobol::d3(stream, name.place_for(purpose));
                [to_unit(a), to_unit(b), to_unit(c)]
            }
            _ => self.lane_by_lane(name, purpose),
        }
    }

    /// Four numbers. The first two are those that [`Self::d2`] gives.
    #[inline(always)]
    pub fn d4<F: Float>(self, name: &SampleName<F>, purpose: Purpose) -> [F; 4] {
        let stream = name.stream(purpose);
        match self {
            Self::Random => {
                let (r, s) = (random(stream, name, 0), random(stream, name, 1));
                [to_unit(r.low()), to_unit(r.high()), to_unit(s.low()), to_unit(s.high())]
            }
            Self::Sobol => {
                let [a, b, c, d] = sobol::d4(stream, name.place_for(purpose));
                [to_unit(a), to_unit(b), to_unit(c), to_unit(d)]
            }
            _ => self.lane_by_lane(name, purpose),
        }
    }

    /// The patterns that are asked for by name only, whose divisions and loops of different lengths don't go side by side.
    #[inline(always)]
    fn lane_by_lane<F: Float, const D: usize>(self, name: &SampleName<F>, purpose: Purpose) -> [F; D] {
        let mut lanes = [F::ZERO.to_array(); D];
        for i in 0..F::WIDTH {
            let numbers: [f32; D] = self.draw(&name.lane(i), purpose);
            for (lanes, number) in lanes.iter_mut().zip(numbers) {
                lanes.as_mut()[i] = number;
            }
        }
        lanes.map(F::from_array)
    }

    /// Out of line, so that the default stays small where it is used.
    #[cold]
    #[inline(never)]
    fn draw<const D: usize>(self, name: &SampleName, purpose: Purpose) -> [f32; D] {
        let stream = name.stream(purpose);
        let bits = match self {
            Self::Random => std::array::from_fn(|d| {
                let bits: u64 = random(stream, name, d as u64 / 2);
                (bits >> (32 * (d % 2))) as u32
            }),
            Self::Sobol => {
                let four = sobol::d4(stream, name.place_for(purpose));
                std::array::from_fn(|d| four[d])
            }
            Self::BlueSobol(order) => padded(&order.at(name), order.stream(name, purpose), name.index()),
            Self::Halton => padded(&Halton, stream, name.index()),
            Self::Regular(set) => padded(&Regular(set), stream, name.index()),
            Self::Jittered(set) => padded(&Jittered(set), stream, name.index()),
            Self::NRooks(set) => padded(&NRooks(set), stream, name.index()),
            Self::MultiJittered(set) => padded(&MultiJittered(set), stream, name.index()),
            Self::Hammersley(set) => padded(&Hammersley(set), stream, name.index()),
        };
        bits.map(to_unit)
    }
}

/// The `k`th 64 bits of a sample from a stream (Steele et al. 2014, "SplitMix": hashes of a Weyl sequence).
#[inline(always)]
fn random<F: Float>(stream: F::Ulong, name: &SampleName<F>, k: u64) -> F::Ulong {
    let counter = name.reversed_index.to_ulong() << 1 | k;
    mix(stream.wrapping_add(counter.wrapping_mul(F::Ulong::splat(0x9e37_79b9_7f4a_7c15))))
}
