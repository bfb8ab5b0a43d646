//! How light becomes a picture for the screen.

use serde_json::{Value as Json, json};
use straal_color::{Exposure, Meter};

use crate::decode::{Decoder, Describe};
use crate::describe::describe;
use crate::limit::Limit;
use crate::schema::{self, Definitions};
use crate::tree::{Datum, Tree};
use crate::value::LinearRgb;
use crate::writer::Writer;

describe! {
    /// Tone curve of pictures for the screen.
    pub enum Tone {
        /// What is brighter than white is out of gamut.
        "clamp" => Clamp,
        /// A colour with a component above 1 is divided by the largest, so that its hue stays.
        "max_to_one" => MaxToOne,
        /// Reinhard's curve on luminance.
        "reinhard" => Reinhard(ReinhardCurve),
        /// Hable's filmic curve, channel by channel.
        "hable" => Hable(HableCurve),
        /// Narkowicz's fit of the ACES curve, channel by channel: a soft toe and shoulder.
        "filmic" => Filmic,
        /// Hill's fit of the ACES transforms: what is brighter turns towards white.
        "aces" => Aces,
        /// AgX: the logarithm of light through a sigmoid; saturated colours turn white gracefully.
        "agx" => Agx,
        /// Khronos' PBR Neutral: colours up to 0.8 as they are, what is brighter compressed.
        "khronos_neutral" => KhronosNeutral,
    }
}

describe! {
    /// Reinhard's curve.
    pub struct ReinhardCurve {
        /// The luminance that becomes white; without it only infinite light does.
        white: Option<f64> [Limit::within(0.01, 1e6)] = None,
    }
}

describe! {
    /// Hable's curve.
    pub struct HableCurve {
        /// What becomes white.
        white: f64 [Limit::within(0.01, 1e6)] = 5.6,
    }
}

impl Tone {
    /// What the name stands for.
    pub fn curve(&self) -> straal_color::Tone {
        use straal_color::Tone as Curve;
        match self {
            Self::Clamp => Curve::Clamp,
            Self::MaxToOne => Curve::ScaleToMaximum,
            Self::Reinhard(c) => Curve::Reinhard { white: c.white.map_or(f32::INFINITY, |w| w as f32) },
            Self::Hable(c) => Curve::Hable { white: c.white as f32 },
            Self::Filmic => Curve::Filmic,
            Self::Aces => Curve::Aces,
            Self::Agx => Curve::Agx,
            Self::KhronosNeutral => Curve::KhronosNeutral,
        }
    }
}

describe! {
    /// What becomes of colours that the screen can't show.
    pub enum Gamut {
        /// Each component goes to the nearer end by itself.
        "clip" => Clip,
        /// The colour moves towards the grey of its own luminance until the screen can show it.
        "desaturate" => Desaturate,
        /// It is shown in one colour.
        "flag" => Flag(Flag),
    }
}

describe! {
    /// The colour of what the screen can't show.
    pub struct Flag {
        /// Red unless said otherwise.
        color: LinearRgb [Limit::UNIT] = LinearRgb([1.0, 0.0, 0.0]),
    }
}

impl Gamut {
    /// What the name stands for.
    pub fn way(&self) -> straal_color::Gamut {
        match self {
            Self::Clip => straal_color::Gamut::Clip,
            Self::Desaturate => straal_color::Gamut::Desaturate,
            Self::Flag(f) => straal_color::Gamut::Flag(f.color.0.map(|v| v as f32)),
        }
    }
}

/// How light becomes a signal for the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gamma {
    /// By the curve of sRGB.
    Srgb,
    /// By a power: the signal is the root of light.
    Power(f64),
}

/// Powers that make sense.
const POWERS: Limit = Limit::within(0.1, 10.0);

impl Describe for Gamma {
    fn read(tree: &Tree, _: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::String(s) if s == "srgb" => Self::Srgb,
            Datum::Number(_) => Self::Power(f64::read(tree, POWERS, d)),
            _ => {
                d.expected("`srgb` or a number", tree);
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        Self::Srgb
    }
    fn write_to(&self, out: &mut dyn Writer) {
        match self {
            Self::Srgb => out.text("srgb"),
            Self::Power(gamma) => gamma.write_to(out),
        }
    }
    fn schema(_: Limit, _: &mut Definitions) -> Json {
        json!({ "anyOf": [{ "const": "srgb" }, schema::number("number", POWERS)] })
    }
}

impl Describe for Exposure {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::Number(_) => Self::stops(f64::read(tree, limit, d) as f32),
            Datum::String(text) if text.parse::<Self>().is_ok() => text.parse().unwrap_or_default(),
            _ => {
                d.expected("stops, `auto` or `highlights`, perhaps with stops as in `auto+1.5`", tree);
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        Self::default()
    }
    fn write_to(&self, out: &mut dyn Writer) {
        match self.meter {
            Meter::Off => f64::from(self.stops).write_to(out),
            Meter::Average | Meter::Highlights => out.text(&self.to_string()),
        }
    }
    fn schema(limit: Limit, _: &mut Definitions) -> Json {
        let metered = json!({ "type": "string", "pattern": "^(auto|highlights)([+-][0-9.]+)?$" });
        json!({ "anyOf": [schema::number("number", limit), metered] })
    }
}
