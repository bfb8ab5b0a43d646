//! Sums of many pixels into which a sample is splatted, laid out for processors that add several at a time.
//!
//! A sum is one integer, as in [`Fixed`]. Here it is held in three numbers, each with room to spare, so that no carry goes from one
//! to the next while samples are added: `low` and `high` count 2^-62 and 2^-30, and `far`, which only very bright light needs,
//! counts 4. Loops over a row are plain products, shifts and sums of 64 bits, which the compiler makes wide by itself.
//!
//! Room: 2^18 samples of each of 33 x 33 pixels are fewer than 2^29 contributions. What one adds is below 2^33 in `low` and 2^34 in
//! `high` and `far`.

use super::fixed::{Across, Bright, Fixed, HEIGHT_SCALE, Row, Usual};

/// The farthest that a pixel may be from a sample's own: filters are up to 16 pixels wide to either side.
pub(super) const MAX_REACH: u32 = 16;

/// Rows or columns that a sample may count in.
pub(super) const MAX_AROUND: usize = 2 * MAX_REACH as usize + 1;

/// Bits of a sum that `low` and `high` take.
const LIMB: u32 = 32;
const MASK: u64 = (1 << LIMB) - 1;

/// What heights are raised by, so that none is below 0.
const RAISED: i64 = HEIGHT_SCALE as i64;

/// Light of a row up to which `high` has room: 16, in units of 2^-30.
const FAR: i64 = 16 << 30;

/// The product of two heights, as one: rounded down.
#[inline(always)]
pub(super) const fn product(a: i64, b: i64) -> i64 {
    (a * b) >> 30
}

/// The heights of the columns that a sample counts in.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    /// Raised by 1 if any is below 0.
    raised: [u32; MAX_AROUND],
    is_raised: bool,
    count: usize,
}

impl Columns {
    pub(super) fn new(of: &[i64]) -> Self {
        let is_raised = of.iter().any(|h| *h < 0);
        let mut raised = [0; MAX_AROUND];
        for (raised, h) in raised.iter_mut().zip(of) {
            // Heights lie in [-1, 1], so that none leaves the range.
            *raised = if is_raised { h + RAISED } else { *h } as u32;
        }
        Self { raised, is_raised, count: of.len() }
    }

    /// How many there are.
    pub(super) const fn count(&self) -> usize {
        self.count
    }

    /// As they are.
    pub(super) fn heights(&self) -> impl Iterator<Item = i64> {
        let by = if self.is_raised { RAISED } else { 0 };
        self.whole().iter().map(move |h| i64::from(*h) - by)
    }

    fn whole(&self) -> &[u32] {
        &self.raised[..self.count]
    }
}

/// Sums of one channel.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    low: Vec<i64>,
    high: Vec<i64>,
    far: Vec<i64>,
}

impl Plane {
    /// Bytes that a pixel takes.
    pub(super) const BYTES: usize = 3 * size_of::<i64>();

    pub(super) fn new(pixels: usize) -> Self {
        Self { low: vec![0; pixels], high: vec![0; pixels], far: vec![0; pixels] }
    }

    pub(super) fn at(&self, i: usize) -> Fixed {
        let [low, high, far] = [self.low[i], self.high[i], self.far[i]].map(i128::from);
        Fixed(low + (high << LIMB) + (far << (2 * LIMB)))
    }

    pub(super) fn put(&mut self, i: usize, Fixed(v): Fixed) {
        self.low[i] = (v as u64 & MASK) as i64;
        self.high[i] = ((v >> LIMB) as u64 & MASK) as i64;
        // A sum is below 2^122.
        self.far[i] = (v >> (2 * LIMB)) as i64;
    }

    /// Adds light below 1 to the columns from `start` on.
    pub(super) fn add_usual(&mut self, columns: &Columns, start: usize, row: Row<Usual>) {
        let light = row.light;
        if light < 0 {
            return self.add_any(columns, start, row);
        }
        // Below 2^62: a number of 32 bits and one of 30.
        let [upper, lower] = [light >> 30, light & ((1 << 30) - 1)].map(|v| u64::from(v as u32));
        // The product of a height h with light is rounded down: h upper + (h lower >> 30) exactly. One that is raised by 1 brings
        // just the light too much.
        let excess = if columns.is_raised { light as u64 } else { 0 };
        let (low, high) = self.range(start, columns);
        for ((low, high), &w) in low.iter_mut().zip(high).zip(columns.whole()) {
            let w = u64::from(w);
            let v = w * upper + ((w * lower) >> 30);
            *low = low.wrapping_add((v & MASK) as i64 - (excess & MASK) as i64);
            *high = high.wrapping_add((v >> LIMB) as i64 - (excess >> LIMB) as i64);
        }
    }

    /// Adds light of any brightness.
    pub(super) fn add_bright(&mut self, columns: &Columns, start: usize, row: Row<Bright>) {
        let light = row.light;
        if !(0..FAR).contains(&light) {
            return self.add_any(columns, start, row);
        }
        // Below 2^34: a number of 18 bits and one of 16. What a height of 1 brings is the light in units of `high`.
        let [upper, lower] = [(light >> 16) as u64, light as u64 & 0xffff];
        let excess = if columns.is_raised { light } else { 0 };
        let (low, high) = self.range(start, columns);
        for ((low, high), &w) in low.iter_mut().zip(high).zip(columns.whole()) {
            let w = u64::from(w);
            // 4 h (65536 upper + lower), where each part is below 2^49.
            let (a, b) = (w * upper, w * lower);
            *low = low.wrapping_add((((a << 18) & MASK) + ((b << 2) & MASK)) as i64);
            *high = high.wrapping_add((a >> 14) as i64 + (b >> 30) as i64 - excess);
        }
    }

    /// The same sums, one by one: of light that is very bright, or below 0.
    fn add_any<A: Across>(&mut self, columns: &Columns, start: usize, row: Row<A>) {
        for (i, w) in (start..).zip(columns.heights()) {
            let Fixed(v) = row.at(w);
            self.low[i] += (v as u64 & MASK) as i64;
            self.high[i] += ((v >> LIMB) as u64 & MASK) as i64;
            self.far[i] += (v >> (2 * LIMB)) as i64;
        }
    }

    fn range(&mut self, start: usize, columns: &Columns) -> (&mut [i64], &mut [i64]) {
        let range = start..start + columns.count;
        (&mut self.low[range.clone()], &mut self.high[range])
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixed::{Down, height};
    use super::*;

    /// Of light dark, bright and very bright, positive and negative, with heights of either sign: every sum is that of whole products.
    #[test]
    fn sums_are_those_of_whole_products() {
        let lights =
            [1e-12_f32, 3e-7, 0.1, 0.999_999_94, 1.0, 7.3, 15.99, 16.0, 4.2e9, -5e-5, -0.7, -2e3, 0.0];
        for heights in [[1.0_f32, 0.3, 1e-3, 0.0, 0.77], [1.0, -0.3, -1e-3, -1.0, 0.5]] {
            let heights = heights.map(height);
            let columns = Columns::new(&heights);
            let mut plane = Plane::new(heights.len() + 2);
            let mut want = vec![0_i128; heights.len() + 2];
            for down in [1.0, 0.6, -0.2, 2e-9] {
                for light in lights {
                    let add = |want: &mut [i128], at: &dyn Fn(i64) -> Fixed| {
                        want[1..].iter_mut().zip(heights).for_each(|(sum, w)| *sum += at(w).0);
                    };
                    match Down::new(&[light], height(down)) {
                        Down::Usual(rows) => {
                            plane.add_usual(&columns, 1, rows.row(0));
                            add(&mut want, &|w| rows.row(0).at(w));
                        }
                        Down::Bright(rows) => {
                            plane.add_bright(&columns, 1, rows.row(0));
                            add(&mut want, &|w| rows.row(0).at(w));
                        }
                    }
                }
            }
            let got: Vec<i128> = (0..want.len()).map(|i| plane.at(i).0).collect();
            assert_eq!(got, want);
            let mut again = Plane::new(want.len());
            (0..want.len()).for_each(|i| again.put(i, plane.at(i)));
            assert!((0..want.len()).all(|i| again.at(i) == plane.at(i)));
        }
    }
}
