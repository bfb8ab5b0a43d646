//! CIE L*a*b* (1976), its polar form, and the colour difference CIEDE2000.

use crate::xyz::Xyz;
use std::f64::consts::PI;
use straal_math::ops;

/// A colour as lightness L* (0 black, 100 white) and two opponent axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lab {
    /// Lightness.
    pub l: f64,
    /// From green to red.
    pub a: f64,
    /// From blue to yellow.
    pub b: f64,
}

/// The same as lightness, chroma and hue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lch {
    /// Lightness.
    pub l: f64,
    /// Distance from grey.
    pub c: f64,
    /// Angle in degrees from +a towards +b, in [0, 360).
    pub h: f64,
}

/// Where the cube root turns into a line: (6/29)^3 and its cube root (CIE 15:2004).
const BEND: f64 = 6.0 / 29.0;

/// Hues that are opposite count as one side of the break in the formula, and not by the last bit of their angles.
const HALF_TURN: f64 = 180.0 + 1e-9;

fn cube_root(x: f64) -> f64 {
    let y = ops::pow_d(x.abs(), 1.0 / 3.0);
    y.copysign(x)
}

impl Lab {
    /// Of tristimulus values beside those of the white.
    pub fn from_xyz(xyz: Xyz, white: Xyz) -> Self {
        let f = |v: f64, w: f64| {
            let t = v / w;
            if t > BEND * BEND * BEND { cube_root(t) } else { t / (3.0 * BEND * BEND) + 4.0 / 29.0 }
        };
        let (x, y, z) = (f(xyz.x, white.x), f(xyz.y, white.y), f(xyz.z, white.z));
        Self { l: 116.0 * y - 16.0, a: 500.0 * (x - y), b: 200.0 * (y - z) }
    }

    /// As tristimulus values.
    pub fn to_xyz(self, white: Xyz) -> Xyz {
        let f = |t: f64, w: f64| w * if t > BEND { t * t * t } else { 3.0 * BEND * BEND * (t - 4.0 / 29.0) };
        let y = (self.l + 16.0) / 116.0;
        Xyz { x: f(y + self.a / 500.0, white.x), y: f(y, white.y), z: f(y - self.b / 200.0, white.z) }
    }

    /// In polar form; grey has hue 0.
    pub fn to_lch(self) -> Lch {
        let c = (self.a * self.a + self.b * self.b).sqrt();
        Lch { l: self.l, c, h: hue(self.a, self.b) }
    }

    /// The straight distance (CIE 1976).
    pub fn delta_e_76(self, o: Self) -> f64 {
        let (l, a, b) = (self.l - o.l, self.a - o.a, self.b - o.b);
        (l * l + a * a + b * b).sqrt()
    }

    /// CIEDE2000 with all weights 1, after Sharma, Wu and Dalal (2005), whose equation numbers are given. About 1 is
    /// just seen when two fields touch.
    pub fn delta_e_2000(self, o: Self) -> f64 {
        let chroma = |v: &Self| (v.a * v.a + v.b * v.b).sqrt();
        // (2) to (7): a is stretched near grey.
        let stretch = 1.5 - 0.5 * saturation((chroma(&self) + chroma(&o)) / 2.0);
        let polar = |v: &Self| {
            let a = v.a * stretch;
            ((a * a + v.b * v.b).sqrt(), hue(a, v.b))
        };
        let ((c1, h1), (c2, h2)) = (polar(&self), polar(&o));
        // (8) to (11): differences, the hue's the short way round; (12) to (14): means.
        let grey = c1 * c2 == 0.0;
        let dh = match h2 - h1 {
            _ if grey => 0.0,
            d if d > HALF_TURN => d - 360.0,
            d if d < -HALF_TURN => d + 360.0,
            d => d,
        };
        let (dl, dc) = (o.l - self.l, c2 - c1);
        let dhue = 2.0 * (c1 * c2).sqrt() * sin(dh / 2.0);
        let (l, c) = ((self.l + o.l) / 2.0, (c1 + c2) / 2.0);
        let h = match h1 + h2 {
            sum if grey => sum,
            sum if (h1 - h2).abs() <= HALF_TURN => sum / 2.0,
            sum if sum < 360.0 => sum / 2.0 + 180.0,
            sum => sum / 2.0 - 180.0,
        };
        // (15) to (21): weights.
        let t = 1.0 - 0.17 * cos(h - 30.0) + 0.24 * cos(2.0 * h) + 0.32 * cos(3.0 * h + 6.0)
            - 0.2 * cos(4.0 * h - 63.0);
        let turn = (h - 275.0) / 25.0;
        let theta = 30.0 * ops::exp_d(-turn * turn);
        let off = (l - 50.0) * (l - 50.0);
        let sl = 1.0 + 0.015 * off / (20.0 + off).sqrt();
        let (sc, sh) = (1.0 + 0.045 * c, 1.0 + 0.015 * c * t);
        let rt = -sin(2.0 * theta) * 2.0 * saturation(c);
        // (22)
        let (l, c, h) = (dl / sl, dc / sc, dhue / sh);
        (l * l + c * c + h * h + rt * c * h).sqrt()
    }
}

impl Lch {
    /// In opponent axes.
    pub fn to_lab(self) -> Lab {
        Lab { l: self.l, a: self.c * cos(self.h), b: self.c * sin(self.h) }
    }
}

/// sqrt(C^7 / (C^7 + 25^7)), which tells colours from greys.
fn saturation(c: f64) -> f64 {
    let r = c / 25.0;
    let r7 = r * r * r * r * r * r * r;
    if r7.is_finite() { (r7 / (r7 + 1.0)).sqrt() } else { 1.0 }
}

/// The angle of (a, b) in degrees in [0, 360); 0 for grey.
fn hue(a: f64, b: f64) -> f64 {
    if a == 0.0 && b == 0.0 {
        return 0.0;
    }
    let h = ops::atan2_d(b, a) * (180.0 / PI);
    if h < 0.0 { h + 360.0 } else { h }
}

fn sin(degrees: f64) -> f64 {
    ops::sin_cos_degrees(degrees).0
}

fn cos(degrees: f64) -> f64 {
    ops::sin_cos_degrees(degrees).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xyz::White;

    /// The test data of Sharma, Wu and Dalal (2005), table 1: two colours and their difference.
    const PAIRS: [[f64; 7]; 34] = [
        [50.0, 2.6772, -79.7751, 50.0, 0.0, -82.7485, 2.0425],
        [50.0, 3.1571, -77.2803, 50.0, 0.0, -82.7485, 2.8615],
        [50.0, 2.8361, -74.0200, 50.0, 0.0, -82.7485, 3.4412],
        [50.0, -1.3802, -84.2814, 50.0, 0.0, -82.7485, 1.0000],
        [50.0, -1.1848, -84.8006, 50.0, 0.0, -82.7485, 1.0000],
        [50.0, -0.9009, -85.5211, 50.0, 0.0, -82.7485, 1.0000],
        [50.0, 0.0, 0.0, 50.0, -1.0, 2.0, 2.3669],
        [50.0, -1.0, 2.0, 50.0, 0.0, 0.0, 2.3669],
        [50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0009, 7.1792],
        [50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0010, 7.1792],
        [50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0011, 7.2195],
        [50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0012, 7.2195],
        [50.0, -0.0010, 2.4900, 50.0, 0.0009, -2.4900, 4.8045],
        [50.0, -0.0010, 2.4900, 50.0, 0.0010, -2.4900, 4.8045],
        [50.0, -0.0010, 2.4900, 50.0, 0.0011, -2.4900, 4.7461],
        [50.0, 2.5, 0.0, 50.0, 0.0, -2.5, 4.3065],
        [50.0, 2.5, 0.0, 73.0, 25.0, -18.0, 27.1492],
        [50.0, 2.5, 0.0, 61.0, -5.0, 29.0, 22.8977],
        [50.0, 2.5, 0.0, 56.0, -27.0, -3.0, 31.9030],
        [50.0, 2.5, 0.0, 58.0, 24.0, 15.0, 19.4535],
        [50.0, 2.5, 0.0, 50.0, 3.1736, 0.5854, 1.0000],
        [50.0, 2.5, 0.0, 50.0, 3.2972, 0.0, 1.0000],
        [50.0, 2.5, 0.0, 50.0, 1.8634, 0.5757, 1.0000],
        [50.0, 2.5, 0.0, 50.0, 3.2592, 0.3350, 1.0000],
        [60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387, 1.2644],
        [63.0109, -31.0961, -5.8663, 62.8187, -29.7946, -4.0864, 1.2630],
        [61.2901, 3.7196, -5.3901, 61.4292, 2.2480, -4.9620, 1.8731],
        [35.0831, -44.1164, 3.7933, 35.0232, -40.0716, 1.5901, 1.8645],
        [22.7233, 20.0904, -46.6940, 23.0331, 14.9730, -42.5619, 2.0373],
        [36.4612, 47.8580, 18.3852, 36.2715, 50.5065, 21.2231, 1.4146],
        [90.8027, -2.0831, 1.4410, 91.1528, -1.6435, 0.0447, 1.4441],
        [90.9257, -0.5406, -0.9208, 88.6381, -0.8985, -0.7239, 1.5381],
        [6.7747, -0.2908, -2.4247, 5.8714, -0.0985, -2.2286, 0.6377],
        [2.0776, 0.0795, -1.1350, 0.9033, -0.0636, -0.5514, 0.9082],
    ];

    #[test]
    fn differences_are_the_published_ones_both_ways() {
        for [l1, a1, b1, l2, a2, b2, want] in PAIRS {
            let (x, y) = (Lab { l: l1, a: a1, b: b1 }, Lab { l: l2, a: a2, b: b2 });
            let (there, back) = (x.delta_e_2000(y), y.delta_e_2000(x));
            assert!((there - want).abs() <= 5.1e-5, "{x:?} {y:?}: {there}, not {want}");
            assert!((there - back).abs() < 1e-12, "{x:?} {y:?}");
            assert_eq!(x.delta_e_2000(x), 0.0);
        }
    }

    #[test]
    fn there_and_back() {
        let white = White::D50.chromaticity().with_luminance(1.0);
        for i in 0..216_u32 {
            let [x, y, z] = [i % 6, i / 6 % 6, i / 36].map(|v| f64::from(v * v) / 20.0);
            let xyz = Xyz { x, y, z };
            let lab = Lab::from_xyz(xyz, white);
            let back = lab.to_lch().to_lab().to_xyz(white);
            let off = (back + xyz * -1.0).to_array();
            assert!(off.iter().all(|v| v.abs() < 1e-12), "{xyz:?} {back:?}");
        }
    }

    #[test]
    fn white_is_100_black_0_and_greys_have_no_hue() {
        let white = White::D65.chromaticity().with_luminance(1.0);
        let lab = Lab::from_xyz(white * 0.184_186_518_7, white);
        assert!((lab.l - 50.0).abs() < 1e-4 && lab.a.abs() < 1e-12 && lab.b.abs() < 1e-12, "{lab:?}");
        assert!((Lab::from_xyz(white, white).l - 100.0).abs() < 1e-12);
        assert!(Lab::from_xyz(Xyz::default(), white).l.abs() < 1e-12);
    }
}
