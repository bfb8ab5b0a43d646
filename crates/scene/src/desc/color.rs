//! Colours by name of a space, and the space that a scene is rendered in.

use straal_color::{Adaptation, Chromaticity, Lab, Lch, Space, White, Xyz};

use crate::desc::check;
use crate::describe::describe;
use crate::limit::Limit;
use crate::value::LinearRgb;

describe! {
    /// How colours are computed with.
    pub struct ColorSettings {
        /// The linear RGB space that light is computed in, and that EXR pictures are written in.
        space: WorkSpace = WorkSpace::Srgb,
    }
}

describe! {
    /// A linear RGB space.
    pub enum WorkSpace {
        /// The primaries of sRGB, which are those of Rec. 709, and D65.
        "srgb" => Srgb,
        /// Display P3: the screens of phones and laptops; D65.
        "display_p3" => DisplayP3,
        /// Rec. 2020: primaries that are pure spectral colours; D65.
        "rec2020" => Rec2020,
        /// ACEScg: the primaries AP1, made for rendering; the white of ACES.
        "acescg" => AcesCg,
        /// ACES2065-1: the primaries AP0, which hold every colour that can be seen; the white of ACES.
        "aces" => Aces,
    }
}

impl WorkSpace {
    /// What the name stands for.
    pub const fn space(&self) -> Space {
        match self {
            Self::Srgb => Space::Srgb,
            Self::DisplayP3 => Space::DisplayP3,
            Self::Rec2020 => Space::Rec2020,
            Self::AcesCg => Space::AcesCg,
            Self::Aces => Space::Aces,
        }
    }
}

describe! {
    /// The white that a colour is told under; it becomes the white of the scene.
    pub enum WhitePoint {
        /// Tungsten of 2856 K.
        "a" => A,
        /// Horizon daylight, the white of print.
        "d50" => D50,
        /// Mid-morning daylight.
        "d55" => D55,
        /// The white of ACES.
        "d60" => D60,
        /// Noon daylight, the white of screens.
        "d65" => D65,
        /// Equal energy.
        "e" => E,
    }
}

impl WhitePoint {
    /// What the name stands for.
    pub const fn white(&self) -> White {
        match self {
            Self::A => White::A,
            Self::D50 => White::D50,
            Self::D55 => White::D55,
            Self::D60 => White::D60,
            Self::D65 => White::D65,
            Self::E => White::E,
        }
    }
}

describe! {
    /// A colour in another form than linear sRGB: one of `rgb`, `xyz`, `xyy`, `lab` and `lch`.
    pub struct ColorIn [check::color_in] {
        /// Linear red, green and blue of `space`.
        rgb: Option<[f64; 3]> = None,
        /// The space of `rgb`; sRGB when absent.
        space: Option<WorkSpace> = None,
        /// CIE 1931 X, Y and Z, where white has Y = 1.
        xyz: Option<[f64; 3]> = None,
        /// CIE chromaticity x, y and luminance Y, where white has Y = 1.
        xyy: Option<[f64; 3]> = None,
        /// CIE L* from 0 to 100, a* and b*.
        lab: Option<[f64; 3]> [Limit::within(-1000.0, 1000.0)] = None,
        /// CIE L* from 0 to 100, chroma C* and hue h in degrees.
        lch: Option<[f64; 3]> [Limit::within(-1000.0, 1000.0)] = None,
        /// The white under which `xyz`, `xyy`, `lab` or `lch` is told; D65 when absent.
        white: Option<WhitePoint> = None,
    }
}

impl ColorIn {
    /// The forms that are given, by key.
    pub(crate) fn forms(&self) -> Vec<&'static str> {
        let all = [
            ("rgb", &self.rgb),
            ("xyz", &self.xyz),
            ("xyy", &self.xyy),
            ("lab", &self.lab),
            ("lch", &self.lch),
        ];
        all.into_iter().filter(|(_, form)| form.is_some()).map(|(key, _)| key).collect()
    }

    /// The colour in linear sRGB; components are below 0 where sRGB does not hold it.
    pub fn color(&self) -> LinearRgb {
        if let Some(rgb) = self.rgb {
            let space = self.space.as_ref().map_or(Space::Srgb, WorkSpace::space);
            return LinearRgb(space.to(Space::Srgb).apply(rgb));
        }
        let white = self.white.as_ref().map_or(White::D65, WhitePoint::white).chromaticity();
        let full = white.with_luminance(1.0);
        let xyz = if let Some([x, y, luminance]) = self.xyy {
            Chromaticity { x, y }.with_luminance(luminance)
        } else if let Some([l, a, b]) = self.lab {
            Lab { l, a, b }.to_xyz(full)
        } else if let Some([l, c, h]) = self.lch {
            Lch { l, c, h }.to_lab().to_xyz(full)
        } else {
            Xyz::new(self.xyz.unwrap_or_default())
        };
        LinearRgb(Space::Srgb.rgb().from_xyz_under(white, Adaptation::Bradford).apply(xyz.to_array()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOTHING: ColorIn =
        ColorIn { rgb: None, space: None, xyz: None, xyy: None, lab: None, lch: None, white: None };

    #[test]
    fn white_is_white_in_every_form() {
        let Chromaticity { x, y } = White::D50.chromaticity();
        let white = Some(WhitePoint::D50);
        for form in [
            ColorIn { rgb: Some([1.0; 3]), space: Some(WorkSpace::AcesCg), ..NOTHING },
            ColorIn { xyy: Some([x, y, 1.0]), white: white.clone(), ..NOTHING },
            ColorIn { lab: Some([100.0, 0.0, 0.0]), white: white.clone(), ..NOTHING },
            ColorIn { lch: Some([100.0, 0.0, 123.0]), white, ..NOTHING },
        ] {
            let LinearRgb(rgb) = form.color();
            assert!(rgb.iter().all(|v| (v - 1.0).abs() < 1e-12), "{form:?} {rgb:?}");
        }
    }

    #[test]
    fn the_red_of_a_wider_space_is_beyond_srgb() {
        let red = ColorIn { rgb: Some([1.0, 0.0, 0.0]), space: Some(WorkSpace::Rec2020), ..NOTHING };
        let LinearRgb([r, g, b]) = red.color();
        // ITU-R BT.2087, the matrix from BT.2020 to BT.709.
        assert!((r - 1.6605).abs() < 1e-4 && (g + 0.1246).abs() < 1e-4 && (b + 0.0182).abs() < 1e-4);
    }
}
