//! The light of one sample while it is gathered.

use super::fixed::Fixed;
use straal_color::Light;

/// A sum of contributions, each rounded once to fixed point and added as integers, so that their order changes no bit.
///
/// Units are those of the film, 2^-62: a contribution of 2^-39 or more is held exactly. One that isn't finite, or of 2^32 or
/// more, spoils the sum, whose sample is dropped then.
///
/// As long as a line of the cache. That it is spoiled is told by its first lane, which is far beyond what 2^30 contributions bring then.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct LightSum {
    lanes: [Fixed; 4],
}

const SPOILED: i128 = 1 << 126;

impl LightSum {
    /// Adds a contribution.
    #[inline(always)]
    pub fn add(&mut self, light: Light) {
        let mut is_sound = true;
        for (sum, v) in self.lanes.iter_mut().zip(light.0) {
            is_sound &= sum.add_sound(v);
        }
        if !is_sound {
            self.spoil();
        }
    }

    /// Makes the sample one that is dropped.
    #[cold]
    pub fn spoil(&mut self) {
        self.lanes[0] = Fixed(SPOILED);
    }

    /// The sum, rounded to single precision; not a number where it is spoiled.
    #[inline]
    pub fn light(&self) -> Light {
        let [a, b, c, d] = &self.lanes;
        let sum = [a.to_f64() as f32, b.to_f64() as f32, c.to_f64() as f32, d.to_f64() as f32];
        Light(if a.0 > SPOILED / 2 { [f32::NAN; 4] } else { sum })
    }
}

#[cfg(test)]
mod tests {
    use super::super::MAX_VALUE;
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

    #[test]
    fn faint_light_is_held() {
        let mut sum = LightSum::default();
        let faint = 1.0 / (1_u64 << 39) as f32;
        (0..3).for_each(|_| sum.add(Light([faint; 4])));
        assert_eq!(sum.light().0[0], 3.0 * faint);
    }
}
