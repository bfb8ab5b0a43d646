//! The CIE's standard observers: from spectra to colours.

use std::sync::LazyLock;

use super::{Bins, COUNT, FIRST, rows};

/// Whose eyes see: the mean of people who looked at a field of so many degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Observer {
    /// 2 degrees, 1931: the one meant where none is named.
    #[default]
    Cie1931,
    /// 10 degrees, 1964: nearer to how large surfaces look.
    Cie1964,
}

/// x, y and z of an observer, each nanometre.
type Functions = [[f64; 3]; COUNT];

/// Both observers: constants, read once from their table.
static TABLES: LazyLock<[Functions; 2]> = LazyLock::new(|| {
    let mut both = [[[0.0; 3]; COUNT]; 2];
    for row in rows(include_str!("../../data/observers.txt")) {
        let number = |i: usize| row.get(i).copied().flatten().unwrap_or(0.0);
        let Some(bin) = (number(0) as usize).checked_sub(FIRST).filter(|&b| b < COUNT) else { continue };
        both[0][bin] = [number(1), number(2), number(3)];
        both[1][bin] = [number(4), number(5), number(6)];
    }
    both
});

impl Observer {
    /// The colour-matching functions x, y and z at each nanometre.
    pub fn functions(self) -> &'static [[f64; 3]; COUNT] {
        match self {
            Self::Cie1931 => &TABLES[0],
            Self::Cie1964 => &TABLES[1],
        }
    }

    /// X, Y and Z of light, in units in which light of 1 at all wavelengths has Y = 1.
    pub fn light(self, light: &Bins) -> [f64; 3] {
        self.sum(light, |_| 1.0)
    }

    /// X, Y and Z of a surface of some reflectance under a light; a perfect reflector has Y = 1.
    pub fn surface(self, reflectance: &Bins, light: &Bins) -> [f64; 3] {
        let [_, white, _] = self.light(light);
        self.sum(reflectance, |i| light[i]).map(|v| v / white)
    }

    fn sum(self, bins: &Bins, weight: impl Fn(usize) -> f64) -> [f64; 3] {
        let (mut sum, mut unit) = ([0.0; 3], 0.0);
        for (i, xyz) in self.functions().iter().enumerate() {
            let value = bins[i] * weight(i);
            unit += xyz[1];
            for c in 0..3 {
                sum[c] += xyz[c] * value;
            }
        }
        sum.map(|v| v / unit)
    }
}
