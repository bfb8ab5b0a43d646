//! Sums of many pixels into which a sample is splatted, laid out for processors that add several at a time.
//!
//! A sum is one integer, as in [`Fixed`]. Here it is held in three numbers, each with room to spare, so that no carry goes from one
//! to the next while samples are added: `low` and `high` count 2^-62 and 2^-30, and `far`, which only very bright light needs,
//! counts 4. Loops over a row are plain products, shifts and sums of 64 bits, which the compiler makes as wide as the instruction set
//! that it compiles them for.
//!
//! Room: 2^18 samples of each of 33 x 33 pixels are fewer than 2^29 contributions. What one adds is below 2^33 in `low` and 2^34 in
//! `high` and `far`.

use super::fixed::{Bright, Fixed, HEIGHT_SCALE, Row, Usual};

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
const FAR: u64 = 16 << 30;

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

    /// As they are.
    pub(super) fn heights(&self) -> impl Iterator<Item = i64> {
        let by = if self.is_raised { RAISED } else { 0 };
        self.whole().iter().map(move |h| i64::from(*h) - by)
    }

    /// What light of some size brings too much to each column, in units of a height of 1.
    #[inline(always)]
    const fn excess(&self, size: u64) -> u64 {
        if self.is_raised { size } else { 0 }
    }

    #[inline(always)]
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
    #[inline(always)]
    pub(super) fn add_usual(&mut self, columns: &Columns, start: usize, row: Row<Usual>) {
        let (size, is_below) = (row.light.unsigned_abs(), row.light < 0);
        // Below 2^62: a number of 32 bits and one of 30.
        let [upper, lower] = [size >> 30, size & ((1 << 30) - 1)].map(|v| u64::from(v as u32));
        // The product of a height h with light is rounded down: h upper + (h lower >> 30) exactly. Light below 0 is taken off, and
        // its size rounded up. A height that is raised by 1 brings just the light too much.
        let up = if is_below { (1 << 30) - 1 } else { 0 };
        let excess = columns.excess(size);
        let [low, high, _] = self.range(start, columns);
        add_parts(
            [low, high],
            columns.whole(),
            is_below,
            #[inline(always)]
            |w: u64| {
                let v = w * upper + ((w * lower + up) >> 30);
                [(v & MASK) as i64 - (excess & MASK) as i64, (v >> LIMB) as i64 - (excess >> LIMB) as i64]
            },
        );
    }

    /// Adds light of any brightness.
    #[inline(always)]
    pub(super) fn add_bright(&mut self, columns: &Columns, start: usize, row: Row<Bright>) {
        let (size, is_below) = (row.light.unsigned_abs(), row.light < 0);
        let excess = columns.excess(size);
        let [low, high, far] = self.range(start, columns);
        let of = columns.whole();
        if size < FAR {
            // Below 2^34: a number of 18 bits and one of 16. What a height of 1 brings is the light in units of `high`.
            let [upper, lower] = [size >> 16, size & 0xffff].map(|v| u64::from(v as u32));
            add_parts(
                [low, high],
                of,
                is_below,
                #[inline(always)]
                |w: u64| {
                    // 4 h (65536 upper + lower), where each part is below 2^49.
                    let (a, b) = (w * upper, w * lower);
                    [
                        (((a << 18) & MASK) + ((b << 2) & MASK)) as i64,
                        (a >> 14) as i64 + (b >> 30) as i64 - excess as i64,
                    ]
                },
            );
        } else {
            // Up to 2^62: a number of 30 bits, or 2^30, and one of 32.
            let [upper, lower] = [size >> LIMB, size & MASK].map(|v| u64::from(v as u32));
            // What goes to `low` and `high`, and then what goes to `high` and `far`: 4 h lower, and 2^34 h upper.
            add_parts(
                [low, &mut *high],
                of,
                is_below,
                #[inline(always)]
                |w: u64| {
                    let b = w * lower;
                    [((b << 2) & MASK) as i64, (b >> 30) as i64]
                },
            );
            add_parts(
                [high, far],
                of,
                is_below,
                #[inline(always)]
                |w: u64| {
                    let a = w * upper;
                    [
                        ((a << 2) & MASK) as i64 - (excess & MASK) as i64,
                        (a >> 30) as i64 - (excess >> LIMB) as i64,
                    ]
                },
            );
        }
    }

    #[inline(always)]
    fn range(&mut self, start: usize, columns: &Columns) -> [&mut [i64]; 3] {
        let range = start..start + columns.count;
        [&mut self.low[range.clone()], &mut self.high[range.clone()], &mut self.far[range]]
    }
}

/// Adds what each height brings to two sums beside it, or takes it off.
#[inline(always)]
fn add_parts([a, b]: [&mut [i64]; 2], of: &[u32], is_taken_off: bool, parts: impl Fn(u64) -> [i64; 2]) {
    let each = a.iter_mut().zip(b).zip(of);
    if is_taken_off {
        for ((a, b), &w) in each {
            let [x, y] = parts(u64::from(w));
            (*a, *b) = (a.wrapping_sub(x), b.wrapping_sub(y));
        }
    } else {
        for ((a, b), &w) in each {
            let [x, y] = parts(u64::from(w));
            (*a, *b) = (a.wrapping_add(x), b.wrapping_add(y));
        }
    }
}

/// Adds the heights of the columns times that of a row, each product as [`product`] has it.
#[inline(always)]
pub(super) fn add_heights(sums: &mut [i64], columns: &Columns, down: i64) {
    let (size, is_below) = (u64::from(down.unsigned_abs() as u32), down < 0);
    let up = if is_below { (1 << 30) - 1 } else { 0 };
    let excess = columns.excess(size) as i64;
    for (sum, &w) in sums.iter_mut().zip(columns.whole()) {
        let v = ((u64::from(w) * size + up) >> 30) as i64 - excess;
        *sum += if is_below { -v } else { v };
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
            let (mut sums, mut want_sums) = (vec![0; heights.len()], vec![0; heights.len()]);
            for down in [1.0, 0.6, -0.2, -2e-9].map(height) {
                add_heights(&mut sums, &columns, down);
                want_sums.iter_mut().zip(heights).for_each(|(sum, h)| *sum += product(h, down));
            }
            assert_eq!(sums, want_sums);
            let mut again = Plane::new(want.len());
            (0..want.len()).for_each(|i| again.put(i, plane.at(i)));
            assert!((0..want.len()).all(|i| again.at(i) == plane.at(i)));
        }
    }
}
