//! The light of one sample while it is gathered.

use super::MAX_VALUE;
use straal_color::Light;

/// A sum of contributions, each rounded once to fixed point and added as integers, so that their order changes no bit.
///
/// Units are those of the film, 2^-62: a contribution of 2^-39 or more is held exactly, a smaller one is rounded to the nearest, halves to
/// the even. One that isn't finite, or of 2^32 or more, spoils the sum, whose sample is dropped then; so does a sum of 2^47 or more,
/// which the film couldn't take.
///
/// Each lane is two integers, of units of 2^-14 and of 2^-62, so that the arithmetic is that of double precision and of 64 bits, which
/// processors do for several lanes at once. As long as a line of the cache.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct LightSum {
    pub(super) high: [i64; 4],
    pub(super) low: [i64; 4],
}

/// A high number's unit is the inverse of this, and so many low ones make one high one.
pub(super) const HIGH: f64 = (1_u64 << 14) as f64;
pub(super) const LOW_BITS: u32 = 48;
pub(super) const LOW: f64 = (1_u64 << LOW_BITS) as f64;

/// A number of less than 2^51 that this is added to is rounded to an integer, which then stands in the last bits.
pub(super) const ROUND: f64 = (3_u64 << 51) as f64;

/// So much in the first lane tells that it is spoiled, whatever is added once.
const SPOILED: i64 = 3 << 61;

/// Whether adding to it once more could overflow: it isn't within ±2^62.
#[inline(always)]
const fn is_full(sum: i64) -> i64 {
    sum ^ (sum << 1)
}

impl LightSum {
    /// Adds a contribution.
    #[inline(always)]
    pub fn add(&mut self, light: Light) {
        let (mut high, mut low, mut full, mut is_sound) = (self.high, self.low, 0, true);
        for v in light.0 {
            is_sound &= v.abs() < MAX_VALUE;
        }
        for (i, v) in light.0.into_iter().enumerate() {
            let units = f64::from(v) * HIGH;
            let whole = units + ROUND;
            // What is left is exact, and at most half a unit.
            let rest = (units - (whole - ROUND)) * LOW + ROUND;
            let integer = |rounded: f64| rounded.to_bits().wrapping_sub(ROUND.to_bits()) as i64;
            high[i] = high[i].wrapping_add(integer(whole));
            low[i] = low[i].wrapping_add(integer(rest));
            full |= is_full(high[i]) | is_full(low[i]);
        }
        if is_sound & (full >= 0) {
            (self.high, self.low) = (high, low);
        } else {
            self.add_unusual((high, low), is_sound);
        }
    }

    /// What an addition gave, where one of the numbers is nearly full or is none.
    #[cold]
    #[inline(never)]
    fn add_unusual(&mut self, (high, low): ([i64; 4], [i64; 4]), is_sound: bool) {
        if !is_sound {
            return self.spoil();
        }
        (self.high, self.low) = (high, low);
        for i in 0..4 {
            (self.high[i], self.low[i]) = self.carried(i);
        }
        if self.high.iter().any(|&sum| is_full(sum) < 0) {
            self.spoil();
        }
    }

    /// Makes the sample one that is dropped.
    #[cold]
    pub fn spoil(&mut self) {
        self.high[0] = SPOILED;
    }

    /// A lane, with as much in high units as possible.
    #[inline(always)]
    const fn carried(&self, i: usize) -> (i64, i64) {
        let carry = (self.low[i] + (1 << (LOW_BITS - 1))) >> LOW_BITS;
        (self.high[i].wrapping_add(carry), self.low[i] - (carry << LOW_BITS))
    }

    /// The sum, rounded to single precision; not a number where it is spoiled.
    #[inline(always)]
    pub fn light(&self) -> Light {
        // Nearly always both numbers are so small that they become doubles as they became integers.
        const HALF: i64 = 1 << 51;
        let (mut sum, mut large) = ([0.0; 4], 0);
        for (i, sum) in sum.iter_mut().enumerate() {
            let (high, low) = (self.high[i], self.low[i]);
            large |= (high.wrapping_add(HALF) as u64 | low.wrapping_add(HALF) as u64) >> 52;
            let double = |v: i64| f64::from_bits((v as u64).wrapping_add(ROUND.to_bits())) - ROUND;
            *sum = rounded(double(high), double(low));
        }
        if large == 0 { Light(sum) } else { self.large() }
    }

    /// The same, however large the numbers.
    #[cold]
    #[inline(never)]
    fn large(&self) -> Light {
        if is_full(self.high[0]) < 0 {
            return Light([f32::NAN; 4]);
        }
        Light([0, 1, 2, 3].map(|i| {
            let (high, low) = self.carried(i);
            rounded(high as f64, low as f64)
        }))
    }
}

/// The light of samples under way, each at a place: all of it, and parts of it where these are told apart.
#[derive(Clone, Debug)]
pub struct SampleSums {
    all: Vec<LightSum>,
    /// By place, the light of each group of lights, and what was taken away.
    parts: Vec<LightSum>,
    groups: usize,
    /// How many parts there are.
    of_each: usize,
    /// The most that light may bring that is limited.
    limit: f32,
}

/// What a film asks of light besides how much it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Which group of lights it comes from, see [`crate::light::Groups`].
    pub group: u16,
    /// Whether it came by way of more than one surface, so that it may be limited.
    pub is_indirect: bool,
}

impl SampleSums {
    /// Room for so many samples, whose light is told apart by so many groups (by none, if that is 0) and limited, if that is finite.
    pub fn new(room: usize, groups: usize, limit: f32) -> Self {
        let sums = |count: usize| vec![LightSum::default(); count];
        let of_each = groups + usize::from(limit.is_finite());
        Self { all: sums(room), parts: sums(room * of_each), groups, of_each, limit }
    }

    /// Bytes that it takes for each sample.
    pub const fn bytes(groups: usize) -> usize {
        size_of::<LightSum>() * (1 + groups)
    }

    /// Begins the sample of a place.
    pub fn clear(&mut self, place: usize) {
        self.all[place] = LightSum::default();
        self.parts[place * self.of_each..][..self.of_each].fill(LightSum::default());
    }

    /// Adds a contribution.
    #[inline(always)]
    pub fn add(&mut self, place: u32, from: Provenance, light: Light) {
        if self.of_each == 0 {
            self.all[place as usize].add(light);
        } else {
            self.add_parts(place as usize, from, light);
        }
    }

    #[inline(never)]
    fn add_parts(&mut self, place: usize, from: Provenance, mut light: Light) {
        let parts = &mut self.parts[place * self.of_each..][..self.of_each];
        let most = light.max_lane();
        if from.is_indirect && most > self.limit {
            let kept = light * (self.limit / most);
            if let Some(taken) = parts.last_mut() {
                taken.add(light - kept);
            }
            light = kept;
        }
        self.all[place].add(light);
        if self.groups > 0 {
            parts[usize::from(from.group)].add(light);
        }
    }

    /// Makes the sample one that is dropped.
    #[cold]
    pub fn spoil(&mut self, place: usize) {
        self.all[place].spoil();
    }

    /// Whether there is nothing but all light of each sample.
    #[inline(always)]
    pub const fn are_whole(&self) -> bool {
        self.of_each == 0
    }

    /// All light of a sample as it is gathered.
    #[inline(always)]
    pub fn sum(&self, place: usize) -> &LightSum {
        &self.all[place]
    }

    /// All light of a sample.
    #[inline(always)]
    pub fn light(&self, place: usize) -> Light {
        self.all[place].light()
    }

    /// The parts of it: by group, and what was taken away.
    pub fn parts(&self, place: usize) -> impl Iterator<Item = Light> {
        self.parts[place * self.of_each..][..self.of_each].iter().map(LightSum::light)
    }
}

/// The sum of both numbers, which are exact in double precision as far as the film takes light, so that it is rounded once there.
#[inline(always)]
fn rounded(high: f64, low: f64) -> f32 {
    ((high + low * (1.0 / LOW)) * (1.0 / HIGH)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_changes_nothing() {
        let parts: Vec<Light> = (0..500_u32)
            .map(|i| Light([1e-6, 0.3, 17.0, 1e6].map(|s| s * (i * 7919 % 500) as f32)))
            .collect();
        let sum = |order: &mut dyn Iterator<Item = &Light>| {
            let mut sum = LightSum::default();
            order.for_each(|v| sum.add(*v));
            sum
        };
        assert_eq!(sum(&mut parts.iter()), sum(&mut parts.iter().rev()));
        let total: f64 = (0..500).map(|i| f64::from(0.3_f32 * i as f32)).sum();
        assert_eq!(sum(&mut parts.iter()).light().0[1], total as f32);
    }

    #[test]
    fn one_number_that_is_none_spoils_it() {
        for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY, MAX_VALUE] {
            let mut sum = LightSum::default();
            sum.add(Light([1.0; 4]));
            sum.add(Light([0.0, bad, 0.0, 0.0]));
            sum.add(Light([1.0; 4]));
            sum.add(Light([-MAX_VALUE.next_down(); 4]));
            assert!(sum.light().0[0].is_nan(), "{bad}");
        }
    }

    /// Many contributions, bright and faint, give what integers of 128 bits give.
    #[test]
    fn nothing_is_lost_by_carrying() {
        let mut sum = LightSum::default();
        let mut exact = [0_i128; 4];
        for i in 0..300_000_u32 {
            let v = (i.wrapping_mul(2_654_435_761) >> 8) as f32;
            let light = Light([0.4 / 16384.0, v * 1e-9, -v * 1e-4, 2047.0 / 32768.0 - v * 1e-12]);
            sum.add(light);
            for (exact, v) in exact.iter_mut().zip(light.0) {
                *exact += (f64::from(v) * (1_u64 << 62) as f64).round_ties_even() as i128;
            }
        }
        let want = exact.map(|v| (v as f64 / (1_u64 << 62) as f64) as f32);
        assert_eq!(sum.light().0, want);
    }

    #[test]
    fn too_much_spoils_it() {
        let mut sum = LightSum::default();
        for _ in 0..(1 << 17) {
            sum.add(Light([0.0, MAX_VALUE.next_down(), 0.0, 0.0]));
        }
        assert!(sum.light().0[0].is_nan());
        (0..(1 << 17)).for_each(|_| sum.add(Light([-1e9, -1e9, 0.0, 0.0])));
        assert!(sum.light().0[0].is_nan(), "it stays so");
    }

    #[test]
    fn faint_light_is_held() {
        let mut sum = LightSum::default();
        let faint = 1.0 / (1_u64 << 39) as f32;
        (0..3).for_each(|_| sum.add(Light([faint; 4])));
        assert_eq!(sum.light().0[0], 3.0 * faint);
    }
}
