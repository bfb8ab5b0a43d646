//! A part of the picture.

/// A rectangle of pixels, ends exclusive, in coordinates of the whole picture (y down from the top).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// Least column and row.
    pub min: [u32; 2],
    /// One past the greatest column and row.
    pub max: [u32; 2],
}

impl Region {
    /// The whole of a picture.
    pub const fn whole(size: [u32; 2]) -> Self {
        Self { min: [0, 0], max: size }
    }

    /// Columns.
    pub const fn width(&self) -> u32 {
        self.max[0].saturating_sub(self.min[0])
    }

    /// Rows.
    pub const fn height(&self) -> u32 {
        self.max[1].saturating_sub(self.min[1])
    }

    /// Pixels.
    pub const fn area(&self) -> usize {
        self.width() as usize * self.height() as usize
    }

    /// Whether a pixel is part of it.
    pub const fn contains(&self, [x, y]: [u32; 2]) -> bool {
        self.min[0] <= x && x < self.max[0] && self.min[1] <= y && y < self.max[1]
    }

    /// The least region of whole squares of `side` pixels that this one lies in, but for what is beyond a picture of
    /// `size`.
    pub fn in_squares(&self, side: u32, size: [u32; 2]) -> Self {
        let down = |v: u32| v / side * side;
        let up = |v: u32| v.div_ceil(side).saturating_mul(side);
        Self { min: self.min.map(down), max: self.max.map(up) }.intersection(Self::whole(size))
    }

    /// With so many pixels more on every side, but none left of or above the first.
    pub fn grown(&self, by: u32) -> Self {
        Self { min: self.min.map(|v| v.saturating_sub(by)), max: self.max.map(|v| v.saturating_add(by)) }
    }

    /// What both have in common.
    pub fn intersection(&self, o: Self) -> Self {
        let pick = |f: fn(u32, u32) -> u32, a: [u32; 2], b: [u32; 2]| [f(a[0], b[0]), f(a[1], b[1])];
        Self { min: pick(Ord::max, self.min, o.min), max: pick(Ord::min, self.max, o.max) }
    }
}
