//! CIE XYZ, chromaticities, and the whites that colours are told by.

use std::ops::{Add, AddAssign, Mul};

/// CIE 1931 tristimulus values. A perfect white reflector has Y = 1 unless a function says otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Xyz {
    /// Roughly red.
    pub x: f64,
    /// Luminance.
    pub y: f64,
    /// Roughly blue.
    pub z: f64,
}

/// Where a colour lies when its brightness is left out: x = X / (X + Y + Z), y = Y / (X + Y + Z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chromaticity {
    /// Share of X.
    pub x: f64,
    /// Share of Y.
    pub y: f64,
}

/// A colour as chromaticity and luminance (CIE xyY).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct XyY {
    /// Chromaticity.
    pub at: Chromaticity,
    /// Luminance Y.
    pub luminance: f64,
}

/// A white by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum White {
    /// Tungsten of 2856 K.
    A,
    /// Horizon daylight, the white of print.
    D50,
    /// Mid-morning daylight.
    D55,
    /// The white of ACES, near a daylight of 6000 K.
    D60,
    /// Noon daylight, the white of screens.
    #[default]
    D65,
    /// Equal energy.
    E,
}

impl White {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::A, Self::D50, Self::D55, Self::D60, Self::D65, Self::E];

    /// The name in small letters.
    pub const fn name(self) -> &'static str {
        match self {
            Self::A => "a",
            Self::D50 => "d50",
            Self::D55 => "d55",
            Self::D60 => "d60",
            Self::D65 => "d65",
            Self::E => "e",
        }
    }

    /// The chromaticity as the standards that use it write it: CIE 15:2004 to five digits for A, D50 and D55, SMPTE
    /// ST 2065-1 for D60, ITU-R BT.709 for D65.
    pub const fn chromaticity(self) -> Chromaticity {
        let (x, y) = match self {
            Self::A => (0.447_57, 0.407_45),
            Self::D50 => (0.345_67, 0.358_5),
            Self::D55 => (0.332_42, 0.347_43),
            Self::D60 => (0.321_68, 0.337_67),
            Self::D65 => (0.312_7, 0.329),
            Self::E => (1.0 / 3.0, 1.0 / 3.0),
        };
        Chromaticity { x, y }
    }
}

impl Xyz {
    /// From an array in the order X, Y, Z.
    pub const fn new([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }

    /// In the order X, Y, Z.
    pub const fn to_array(self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }

    /// Where the colour lies; `None` for what has no direction, such as black.
    pub fn chromaticity(self) -> Option<Chromaticity> {
        let sum = self.x + self.y + self.z;
        (sum != 0.0 && sum.is_finite()).then(|| Chromaticity { x: self.x / sum, y: self.y / sum })
    }

    /// As chromaticity and luminance; black, which has no chromaticity, gets that of `white`.
    pub fn to_xyy(self, white: Chromaticity) -> XyY {
        XyY { at: self.chromaticity().unwrap_or(white), luminance: self.y }
    }
}

impl Chromaticity {
    /// The colour of that chromaticity and luminance. y is not 0.
    pub fn with_luminance(self, luminance: f64) -> Xyz {
        let sum = luminance / self.y;
        Xyz { x: self.x * sum, y: luminance, z: (1.0 - self.x - self.y) * sum }
    }
}

impl XyY {
    /// As tristimulus values. y is not 0.
    pub fn to_xyz(self) -> Xyz {
        self.at.with_luminance(self.luminance)
    }
}

impl Add for Xyz {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}
impl AddAssign for Xyz {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl Mul<f64> for Xyz {
    type Output = Self;
    fn mul(self, s: f64) -> Self {
        Self { x: self.x * s, y: self.y * s, z: self.z * s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let white = White::D65.chromaticity();
        for xyz in [[0.2, 0.3, 0.4], [3.0, 0.01, 2.0], [-0.1, 0.5, 0.1]].map(Xyz::new) {
            let back = xyz.to_xyy(white).to_xyz();
            let off = (back + xyz * -1.0).to_array();
            assert!(off.iter().all(|v| v.abs() < 1e-15), "{xyz:?} {back:?}");
        }
        assert_eq!(Xyz::default().to_xyy(white).at, white);
        assert_eq!(Xyz::default().chromaticity(), None);
    }

    #[test]
    fn whites_are_near_the_black_body_and_e_is_in_the_middle() {
        for white in White::ALL {
            let Chromaticity { x, y } = white.chromaticity();
            assert!(x > 0.3 && x < 0.45 && y > 0.32 && y < 0.41, "{}", white.name());
        }
        let e = White::E.chromaticity().with_luminance(1.0);
        assert!(e.to_array().iter().all(|v| (v - 1.0).abs() < 1e-15));
    }
}
