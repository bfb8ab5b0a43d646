//! Linear RGB spaces by their primaries and white, with matrices worked out from these.

use crate::adaptation::Adaptation;
use crate::matrix::Matrix3;
use crate::spectrum::{Observer, illuminant};
use crate::xyz::{Chromaticity, White, Xyz};

/// Three primaries and a white: all that a linear RGB space is. The white is R = G = B = 1, with luminance 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbSpace {
    /// Chromaticities of red, green and blue.
    pub primaries: [Chromaticity; 3],
    /// Chromaticity of white.
    pub white: Chromaticity,
}

/// A linear RGB space by name, which a scene may be rendered in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Space {
    /// The primaries of sRGB, which are those of ITU-R BT.709, and D65.
    #[default]
    Srgb,
    /// Display P3: the primaries of SMPTE RP 431-2 with D65.
    DisplayP3,
    /// ITU-R BT.2020, whose primaries are pure spectral colours.
    Rec2020,
    /// ACEScg: the primaries AP1 (Academy S-2014-004), for rendering.
    AcesCg,
    /// ACES2065-1: the primaries AP0 (SMPTE ST 2065-1), which hold every colour that can be seen; for interchange.
    Aces,
}

const fn at(x: f64, y: f64) -> Chromaticity {
    Chromaticity { x, y }
}

impl Space {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Srgb, Self::DisplayP3, Self::Rec2020, Self::AcesCg, Self::Aces];

    /// The name in small letters.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Srgb => "srgb",
            Self::DisplayP3 => "display_p3",
            Self::Rec2020 => "rec2020",
            Self::AcesCg => "acescg",
            Self::Aces => "aces",
        }
    }

    /// The space of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|s| s.name() == name)
    }

    /// The space of these primaries and white, as far as a file in single precision tells them.
    pub fn of(rgb: &RgbSpace) -> Option<Self> {
        Self::ALL.into_iter().find(|space| {
            let own = space.rgb();
            let pairs = own.primaries.into_iter().zip(rgb.primaries).chain([(own.white, rgb.white)]);
            { pairs }.all(|(a, b)| (a.x - b.x).abs() < 2e-5 && (a.y - b.y).abs() < 2e-5)
        })
    }

    /// Its primaries and white.
    pub const fn rgb(self) -> RgbSpace {
        let (primaries, white) = match self {
            Self::Srgb => ([at(0.64, 0.33), at(0.3, 0.6), at(0.15, 0.06)], White::D65),
            Self::DisplayP3 => ([at(0.68, 0.32), at(0.265, 0.69), at(0.15, 0.06)], White::D65),
            Self::Rec2020 => ([at(0.708, 0.292), at(0.17, 0.797), at(0.131, 0.046)], White::D65),
            Self::AcesCg => ([at(0.713, 0.293), at(0.165, 0.83), at(0.128, 0.044)], White::D60),
            Self::Aces => ([at(0.7347, 0.2653), at(0.0, 1.0), at(0.0001, -0.077)], White::D60),
        };
        RgbSpace { primaries, white: white.chromaticity() }
    }

    /// The matrix from this space to another, so that white stays white (Bradford); exactly the identity from a space to
    /// itself.
    pub fn to(self, other: Self) -> Matrix3 {
        if self == other {
            return Matrix3::IDENTITY;
        }
        self.rgb().to(&other.rgb(), Adaptation::Bradford)
    }
}

impl RgbSpace {
    /// CIE XYZ told as RGB, as OpenEXR files of XYZ do: red is X, green Y and blue Z. The white is that of equal energy by
    /// form only: as elsewhere D65 is what looks white, see [`RgbSpace::neutral`].
    pub const XYZ: Self =
        Self { primaries: [at(1.0, 0.0), at(0.0, 1.0), at(0.0, 0.0)], white: at(1.0 / 3.0, 1.0 / 3.0) };

    /// What looks white: R = G = B, or where the numbers are XYZ the tabulated D65.
    pub fn neutral(&self) -> Chromaticity {
        if *self != Self::XYZ {
            return self.white;
        }
        let white = Xyz::new(Observer::Cie1931.light(&illuminant::d65()));
        white.chromaticity().unwrap_or(White::D65.chromaticity())
    }

    /// The space of primaries and a white that a file tells in single precision: the exact one where it is known.
    pub fn recognised(self) -> Self {
        let near = |a: Chromaticity, b: Chromaticity| (a.x - b.x).abs() < 2e-5 && (a.y - b.y).abs() < 2e-5;
        let pairs = self.primaries.into_iter().zip(Self::XYZ.primaries);
        if { pairs }.all(|(a, b)| near(a, b)) {
            return Self::XYZ;
        }
        Space::of(&self).map_or(self, Space::rgb)
    }

    /// White with luminance 1.
    pub fn white_xyz(&self) -> Xyz {
        self.white.with_luminance(1.0)
    }

    /// Whether the primaries span a triangle and there is a white in its plane.
    pub fn is_sound(&self) -> bool {
        self.columns().inverse().is_some() && self.white.y > 0.0
    }

    /// The primaries as columns, each with X + Y + Z = 1.
    fn columns(&self) -> Matrix3 {
        Matrix3(self.primaries.map(|p| [p.x, p.y, 1.0 - p.x - p.y])).transpose()
    }

    /// From linear RGB to XYZ: the primaries as columns, scaled so that their sum is white (SMPTE RP 177). Of a space
    /// that is not sound, the identity.
    pub fn to_xyz(&self) -> Matrix3 {
        let columns = self.columns();
        let Some(back) = columns.inverse().filter(|_| self.white.y > 0.0) else { return Matrix3::IDENTITY };
        columns * Matrix3::diagonal(back.apply(self.white_xyz().to_array()))
    }

    /// From XYZ to linear RGB, the white taken as it is.
    pub fn from_xyz(&self) -> Matrix3 {
        self.to_xyz().inverse().unwrap_or(Matrix3::IDENTITY)
    }

    /// From linear RGB of this space to that of another, so that what is neutral here is there.
    pub fn to(&self, other: &Self, adaptation: Adaptation) -> Matrix3 {
        let neutral = |space: &Self| space.neutral().with_luminance(1.0);
        let adapt = adaptation.matrix(neutral(self), neutral(other));
        other.from_xyz() * adapt * self.to_xyz()
    }

    /// From XYZ seen under `white` to linear RGB of this space, so that `white` of luminance 1 becomes R = G = B = 1.
    pub fn from_xyz_under(&self, white: Chromaticity, adaptation: Adaptation) -> Matrix3 {
        self.from_xyz() * adaptation.matrix(white.with_luminance(1.0), self.white_xyz())
    }

    /// The luminance of red, green and blue; they add up to 1.
    pub fn luminance(&self) -> [f64; 3] {
        self.to_xyz().0[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Matrix3, b: [[f64; 3]; 3], tolerance: f64) {
        for (x, y) in a.0.iter().flatten().zip(b.iter().flatten()) {
            assert!((x - y).abs() < tolerance, "{a:?}\n{b:?}");
        }
    }

    /// IEC 61966-2-1 (four digits), Academy S-2014-004 and ITU-R BT.2020 as published.
    #[test]
    fn matrices_are_those_of_the_standards() {
        let srgb = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]];
        near(Space::Srgb.rgb().from_xyz(), srgb, 5e-4);
        let acescg = [
            [1.641_023_379_7, -0.324_803_294_2, -0.236_424_695_2],
            [-0.663_662_858_7, 1.615_331_591_7, 0.016_756_347_7],
            [0.011_721_894_3, -0.008_284_442_0, 0.988_394_858_5],
        ];
        near(Space::AcesCg.rgb().from_xyz(), acescg, 1e-9);
        let ap0 = [
            [0.952_552_395_9, 0.0, 0.000_093_678_6],
            [0.343_966_449_8, 0.728_166_096_6, -0.072_132_546_4],
            [0.0, 0.0, 1.008_825_184_4],
        ];
        near(Space::Aces.rgb().to_xyz(), ap0, 1e-9);
        let luminance = Space::Rec2020.rgb().luminance();
        for (a, b) in luminance.into_iter().zip([0.2627, 0.678, 0.0593]) {
            assert!((a - b).abs() < 5e-5, "{luminance:?}");
        }
    }

    #[test]
    fn white_is_white_in_every_space_and_all_comes_back() {
        for a in Space::ALL {
            for b in Space::ALL {
                let there = a.to(b);
                for v in there.apply([0.7; 3]) {
                    assert!((v - 0.7).abs() < 1e-14, "{a:?} {b:?}");
                }
                for rgb in [[1.0, 0.0, 0.0], [0.2, 0.5, 0.9], [-0.1, 4.0, 0.3]] {
                    let back = b.to(a).apply(there.apply(rgb));
                    for i in 0..3 {
                        assert!((back[i] - rgb[i]).abs() < 1e-13, "{a:?} {b:?}");
                    }
                }
            }
            assert_eq!(a.to(a), Matrix3::IDENTITY);
            assert_eq!((Space::named(a.name()), Space::of(&a.rgb())), (Some(a), Some(a)));
        }
    }

    /// Larger spaces hold smaller ones: no component of a primary falls below 0.
    #[test]
    fn sizes_of_the_spaces_are_in_order() {
        for (small, large) in
            [(Space::Srgb, Space::DisplayP3), (Space::Srgb, Space::Rec2020), (Space::Srgb, Space::AcesCg)]
        {
            let m = small.to(large);
            assert!(m.0.iter().flatten().all(|v| *v >= 0.0), "{small:?} {large:?} {m:?}");
        }
    }

    #[test]
    fn the_neutral_of_xyz_is_daylight() {
        let xyz = RgbSpace::XYZ;
        near(xyz.to_xyz(), Matrix3::IDENTITY.0, 1e-15);
        let d65 = Observer::Cie1931.light(&illuminant::d65());
        for space in Space::ALL {
            let white = xyz.to(&space.rgb(), Adaptation::Bradford).apply(d65);
            assert!(white.iter().all(|v| (v - 1.0).abs() < 1e-12), "{space:?} {white:?}");
        }
        let told = |c: Chromaticity| at(f64::from(c.x as f32), f64::from(c.y as f32));
        for space in Space::ALL.map(Space::rgb).into_iter().chain([xyz]) {
            let file = RgbSpace { primaries: space.primaries.map(told), white: told(space.white) };
            assert_eq!(file.recognised(), space);
        }
    }

    #[test]
    fn a_space_without_a_triangle_is_known() {
        let flat = RgbSpace { primaries: [at(0.3, 0.3); 3], white: at(0.3, 0.3) };
        assert!(!flat.is_sound());
        assert_eq!(flat.to_xyz(), Matrix3::IDENTITY);
        assert!(Space::ALL.iter().all(|s| s.rgb().is_sound()));
    }
}
