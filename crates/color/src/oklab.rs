//! OKLab: a space in which equal distances look about equally large (Ottosson 2020, "A perceptual color space for image
//! processing").

use straal_math::ops;

/// A colour as lightness L (0 black, 1 white) and two opponent axes, a (green to red) and b (blue to yellow).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oklab {
    /// Lightness.
    pub l: f32,
    /// From green to red.
    pub a: f32,
    /// From blue to yellow.
    pub b: f32,
}

impl Oklab {
    /// Of linear RGB with Rec. 709 primaries.
    pub fn from_linear([r, g, b]: [f32; 3]) -> Self {
        let l = ops::cbrt(0.412_221_46 * r + 0.536_332_55 * g + 0.051_445_995 * b);
        let m = ops::cbrt(0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b);
        let s = ops::cbrt(0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b);
        Self {
            l: 0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
            a: 1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
            b: 0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
        }
    }

    /// As linear RGB; what no screen can show has components outside of [0, 1].
    pub fn to_linear(self) -> [f32; 3] {
        let cube = |x: f32| x * x * x;
        let l = cube(self.l + 0.396_337_78 * self.a + 0.215_803_76 * self.b);
        let m = cube(self.l - 0.105_561_346 * self.a - 0.063_854_17 * self.b);
        let s = cube(self.l - 0.089_484_18 * self.a - 1.291_485_5 * self.b);
        [
            4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
            -1.268_438 * l + 2.609_757_4 * m - 0.341_319_4 * s,
            -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
        ]
    }

    /// How different two colours look.
    pub fn distance(self, o: Self) -> f32 {
        let (l, a, b) = (self.l - o.l, self.a - o.a, self.b - o.b);
        (l * l + a * a + b * b).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_black_and_red_are_where_the_paper_has_them() {
        let near = |x: Oklab, [l, a, b]: [f32; 3]| assert!(x.distance(Oklab { l, a, b }) < 2e-3, "{x:?}");
        near(Oklab::from_linear([1.0; 3]), [1.0, 0.0, 0.0]);
        near(Oklab::from_linear([0.0; 3]), [0.0, 0.0, 0.0]);
        near(Oklab::from_linear([1.0, 0.0, 0.0]), [0.628, 0.225, 0.126]);
    }

    #[test]
    fn there_and_back() {
        for i in 0..64_u32 {
            let rgb = [i % 4, i / 4 % 4, i / 16].map(|v| v as f32 / 3.0);
            let back = Oklab::from_linear(rgb).to_linear();
            for c in 0..3 {
                assert!((rgb[c] - back[c]).abs() < 1e-4, "{rgb:?} {back:?}");
            }
        }
    }
}
