//! Chromatic adaptation: the colour that looks under one white as another did under its own.

use crate::matrix::Matrix3;
use crate::xyz::Xyz;

/// By which model of the eye's three kinds of cone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Adaptation {
    /// Lam's (1985) sharpened cones, as ICC profiles have them.
    #[default]
    Bradford,
    /// The cones of CIECAM02 (CIE 159:2004).
    Cat02,
    /// Hunt, Pointer and Estevez' cones, scaled as von Kries proposed (1902).
    VonKries,
    /// X, Y and Z scaled by themselves: simple, and wrong for saturated colours.
    XyzScaling,
}

impl Adaptation {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Bradford, Self::Cat02, Self::VonKries, Self::XyzScaling];

    /// The name in small letters.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bradford => "bradford",
            Self::Cat02 => "cat02",
            Self::VonKries => "von_kries",
            Self::XyzScaling => "xyz_scaling",
        }
    }

    /// From XYZ to the answers of the cones.
    pub const fn cones(self) -> Matrix3 {
        match self {
            Self::Bradford => {
                Matrix3([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])
            }
            Self::Cat02 => {
                Matrix3([[0.7328, 0.4296, -0.1624], [-0.7036, 1.6975, 0.0061], [0.003, 0.0136, 0.9834]])
            }
            Self::VonKries => {
                Matrix3([[0.400_24, 0.707_6, -0.080_81], [-0.226_3, 1.165_32, 0.045_7], [0.0, 0.0, 0.918_22]])
            }
            Self::XyzScaling => Matrix3::IDENTITY,
        }
    }

    /// The matrix from XYZ seen under `from` to XYZ seen under `to`; both have the same luminance, and no cone is blind
    /// to either.
    pub fn matrix(self, from: Xyz, to: Xyz) -> Matrix3 {
        if from == to {
            return Matrix3::IDENTITY;
        }
        let cones = self.cones();
        let (a, b) = (cones.apply(from.to_array()), cones.apply(to.to_array()));
        let scale = Matrix3::diagonal([0, 1, 2].map(|i| b[i] / a[i]));
        // The models' own matrices have inverses.
        cones.inverse().map_or(Matrix3::IDENTITY, |back| back * scale * cones)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xyz::White;

    #[test]
    fn white_becomes_white_and_comes_back() {
        let whites = White::ALL.map(|w| w.chromaticity().with_luminance(1.0));
        for model in Adaptation::ALL {
            for from in whites {
                for to in whites {
                    let there = model.matrix(from, to);
                    let seen = there.apply(from.to_array());
                    for (got, want) in seen.into_iter().zip(to.to_array()) {
                        assert!((got - want).abs() < 1e-14, "{model:?}");
                    }
                    let back = model.matrix(to, from) * there;
                    for (got, want) in back.0.iter().flatten().zip(Matrix3::IDENTITY.0.iter().flatten()) {
                        assert!((got - want).abs() < 1e-13, "{model:?}");
                    }
                }
            }
        }
    }

    /// The Bradford matrix from D65 to D50 that ICC's and Lindbloom's pages print, to the digits of their whites.
    #[test]
    fn bradford_from_d65_to_d50_is_the_published_one() {
        let white = |w: White| w.chromaticity().with_luminance(1.0);
        let m = Adaptation::Bradford.matrix(white(White::D65), white(White::D50));
        let want = [
            [1.047_811_2, 0.022_886_6, -0.050_127_0],
            [0.029_542_4, 0.990_484_4, -0.017_049_1],
            [-0.009_234_5, 0.015_043_6, 0.752_131_6],
        ];
        for (a, b) in m.0.iter().flatten().zip(want.iter().flatten()) {
            assert!((a - b).abs() < 2e-4, "{m:?}");
        }
    }
}
