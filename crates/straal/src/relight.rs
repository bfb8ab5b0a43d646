//! Light changed after the fact: a picture that holds the light of each group of lights by itself is the sum of them, and so is what it would have been with other
//! lamps. Nothing is traced again, and nothing is guessed.

use crate::denoise;
use crate::develop::PictureFile;
use std::fmt;
use std::str::FromStr;
use straal_color::spectrum::{Observer, Quantity, thermal};
use straal_color::{Adaptation, Matrix3, RgbSpace, Space, White, srgb};
use straal_formats::image::exr::Layer;
use straal_render::film::CLAMPED;
use straal_scene::desc::REST;
use straal_scene::suggest;

/// What a layer's name begins with that holds a group's light, the group's name being the rest of it, as Blender has it.
const LAYER: &str = "Combined_";

/// The same of other renderers: Arnold's.
const LAYERS: [&str; 2] = [LAYER, "RGBA_"];

/// The key of the metadata that tells how a picture was relit.
const RELIT: &str = "straal.relit";

/// The layer of a group's light, or of what was taken away.
pub(crate) fn layer_of(group: &str) -> String {
    if group == CLAMPED {
        return "clamped".into();
    }
    format!("{LAYER}{group}")
}

/// The group whose light a layer holds, if it holds that.
fn group_of(layer: &str) -> Option<&str> {
    let last = layer.rsplit_once('.').map_or(layer, |(_, last)| last);
    LAYERS.iter().find_map(|start| last.strip_prefix(start)).filter(|name| !name.is_empty())
}

/// What becomes of the light of a group: `key=2`, `fill=off`, `rim=0.5,warm`, `sky=7500K`, `sign=#ff4000`.
#[derive(Clone, Debug, PartialEq)]
pub struct Relight {
    /// The group.
    pub group: String,
    /// What its light is multiplied by.
    pub factor: f64,
    /// The colour of a filter that it goes through.
    pub tint: Option<Tint>,
}

/// The colour of a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tint {
    /// It makes white light that of a black body of so many kelvins, as bright as it was: white is that of 6504 K.
    Kelvin(f64),
    /// It lets so much of red, green and blue pass: a code of sRGB.
    Code(u32),
}

/// Kelvins by name: lamps of a living room, daylight, a sky in the shade.
const NAMED: [(&str, f64); 3] = [("warm", 3000.0), ("neutral", 6504.0), ("cool", 9000.0)];

/// Between these a filter has a colour that a picture can hold.
const KELVINS: [f64; 2] = [1000.0, 40_000.0];

/// The greatest factor.
const MOST: f64 = 1e6;

impl FromStr for Relight {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (group, words) =
            text.split_once('=').ok_or("write the group and what becomes of it, as in key=2 or fill=off")?;
        let (mut factor, mut tint) = (None, None);
        for word in words.split(',').map(str::trim) {
            let twice = match of_word(word)? {
                Word::Factor(v) => factor.replace(v).is_some(),
                Word::Tint(v) => tint.replace(v).is_some(),
            };
            if twice {
                return Err("a group takes one factor and one tint".into());
            }
        }
        Ok(Self { group: group.trim().into(), factor: factor.unwrap_or(1.0), tint })
    }
}

enum Word {
    Factor(f64),
    Tint(Tint),
}

fn of_word(word: &str) -> Result<Word, String> {
    let help = || {
        let names = NAMED.map(|(name, _)| name).join(", ");
        format!(
            "`{word}` is neither a factor such as 2 or 0.5, nor off, nor a tint: {names}, 3000K or #rrggbb"
        )
    };
    if word == "off" {
        return Ok(Word::Factor(0.0));
    }
    if let Some((_, kelvin)) = NAMED.iter().find(|(name, _)| *name == word) {
        return Ok(Word::Tint(Tint::Kelvin(*kelvin)));
    }
    if let Some(code) = word.strip_prefix('#') {
        let is_code = code.len() == 6 && code.bytes().all(|b| b.is_ascii_hexdigit());
        let code = u32::from_str_radix(code, 16).ok().filter(|_| is_code).ok_or_else(help)?;
        return Ok(Word::Tint(Tint::Code(code)));
    }
    if let Some(kelvin) = word.strip_suffix(['K', 'k']) {
        let kelvin: f64 = kelvin.parse().map_err(|_| help())?;
        let [least, most] = KELVINS;
        if !(least..=most).contains(&kelvin) {
            return Err(format!("a tint has from {least} to {most} kelvins, not {kelvin}"));
        }
        return Ok(Word::Tint(Tint::Kelvin(kelvin)));
    }
    let factor: f64 = word.parse().map_err(|_| help())?;
    if !(0.0..=MOST).contains(&factor) {
        return Err(format!("a factor is from 0 to {MOST}, not {word}"));
    }
    Ok(Word::Factor(factor))
}

impl fmt::Display for Relight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.group, self.factor)?;
        match self.tint {
            None => Ok(()),
            Some(Tint::Kelvin(kelvin)) => write!(f, ",{kelvin}K"),
            Some(Tint::Code(code)) => write!(f, ",#{code:06x}"),
        }
    }
}

impl Tint {
    /// What it multiplies red, green and blue of a space by.
    fn factors(self, space: &RgbSpace) -> [f64; 3] {
        let factors = match self {
            Self::Kelvin(kelvin) => {
                // What turns the light of a black body of 6504 K, which is nearly that of D65, into that of another, as bright.
                let (now, white) = (black_body(kelvin, space), black_body(6504.0, space));
                let filter: [f64; 3] = std::array::from_fn(|c| now[c] / white[c]);
                let passed: f64 = filter.iter().zip(space.luminance()).map(|(v, y)| v * y).sum();
                filter.map(|v| v / passed)
            }
            Self::Code(code) => {
                let signal = [code >> 16, code >> 8, code].map(|v| (v & 0xff) as f32 / 255.0);
                let linear = signal.map(|v| f64::from(srgb::decode(v)));
                Space::Srgb.rgb().to(space, Adaptation::Bradford).apply(linear)
            }
        };
        factors.map(|v| if v > 0.0 { v } else { 0.0 })
    }
}

/// The colour of a black body, where the space's white is D65.
fn black_body(kelvin: f64, space: &RgbSpace) -> [f64; 3] {
    let light = thermal::black_body(kelvin).bins(Quantity::Emission);
    let mut xyz = [0.0; 3];
    for (power, functions) in light.iter().zip(Observer::Cie1931.functions()) {
        xyz.iter_mut().zip(functions).for_each(|(sum, v)| *sum += power * v);
    }
    let unit = xyz.map(|v| v / xyz[1]);
    space.from_xyz_under(White::D65.chromaticity(), Adaptation::Bradford).apply(unit)
}

/// Why a picture can't be relit.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoRelight {
    /// It doesn't tell its lights apart.
    #[error(
        "the picture has no layers of groups of lights: those of straal come of lamps with a `light_group`, in an EXR"
    )]
    NoGroups,
    /// It has no such group.
    #[error("the picture has no group of lights `{0}`; {1}")]
    Unknown(String, String),
    /// Its groups and the picture aren't of the same size.
    #[error("the layer `{0}` has no red, green and blue")]
    Layer(String),
}

/// What the colours of a pixel become.
struct Change {
    factors: [f64; 3],
    /// To the numbers that the factors are of, and back, where these aren't the pixel's own.
    by_way_of: Option<[Matrix3; 2]>,
}

impl Change {
    fn of(relight: &Relight, space: &RgbSpace) -> Self {
        // X, Y and Z are no colours of lamps or filters.
        let is_xyz = *space == RgbSpace::XYZ;
        let colours = if is_xyz { Space::Srgb.rgb() } else { *space };
        let ways = || [space.to(&colours, Adaptation::Bradford), colours.to(space, Adaptation::Bradford)];
        let tint = relight.tint.map_or([1.0; 3], |tint| tint.factors(&colours));
        Self {
            factors: tint.map(|v| v * relight.factor),
            by_way_of: (is_xyz && relight.tint.is_some()).then(ways),
        }
    }

    fn apply(&self, pixel: [f32; 3]) -> [f32; 3] {
        let times = |v: [f64; 3]| std::array::from_fn(|c| v[c] * self.factors[c]);
        let pixel = pixel.map(f64::from);
        match &self.by_way_of {
            None => times(pixel),
            Some([there, back]) => back.apply(times(there.apply(pixel))),
        }
        .map(|v| v as f32)
    }
}

impl PictureFile {
    /// The groups of lights whose light it holds apart.
    pub fn light_groups(&self) -> Vec<&str> {
        self.picture.layers.iter().filter_map(|layer| group_of(&layer.name)).collect()
    }

    /// Changes the light of groups of lights, one change after the other: the picture becomes what it would have been with such lamps, and so do
    /// the layers of these groups.
    pub fn relight(&mut self, changes: &[Relight]) -> Result<(), NoRelight> {
        let there = self.light_groups();
        if there.is_empty() {
            return Err(NoRelight::NoGroups);
        }
        if let Some(other) = changes.iter().find(|change| !there.contains(&change.group.as_str())) {
            let near = suggest::did_you_mean(&other.group, there.iter().copied());
            let all = || format!("there are {}", suggest::list(there.iter().copied()));
            return Err(NoRelight::Unknown(other.group.clone(), near.unwrap_or_else(all)));
        }
        // What has no group of its own: a layer of straal, or what the others leave of the picture.
        let is_whole = there.contains(&REST);
        let mut light: Vec<[f64; 3]> = match is_whole {
            true => vec![[0.0; 3]; self.photo.pixels.len()],
            false => self.photo.pixels.iter().map(|pixel| pixel.map(f64::from)).collect(),
        };
        let space = self.space();
        for layer in &mut self.picture.layers {
            let Some(group) = group_of(&layer.name) else { continue };
            let wrong = || NoRelight::Layer(layer.name.clone());
            let old = layer.rgb().filter(|rgb| rgb.len() == light.len()).ok_or_else(wrong)?;
            let mut new = old.clone();
            for change in changes.iter().filter(|change| change.group == group) {
                let change = Change::of(change, &space);
                new.iter_mut().for_each(|pixel| *pixel = change.apply(*pixel));
            }
            for ((sum, old), new) in light.iter_mut().zip(&old).zip(&new) {
                for c in 0..3 {
                    sum[c] += f64::from(new[c]) - if is_whole { 0.0 } else { f64::from(old[c]) };
                }
            }
            if old != new {
                replace_colours(layer, &new);
            }
        }
        let light: Vec<[f32; 3]> = light.into_iter().map(|pixel| pixel.map(|v| v as f32)).collect();
        let are_noisy = self.told(denoise::GROUPS_DENOISED).is_none();
        if are_noisy && self.picture.layer(denoise::NOISY).is_some() {
            let note = "the picture was denoised, and its groups of lights weren't: relit it has their noise (relight first, and denoise what comes of it)";
            self.photo.notes.push(note.into());
        }
        let before = self.photo.pixels.clone();
        self.replace_light(light, &before);
        // What was replaced isn't noise but other light.
        self.picture.layers.retain(|layer| layer.name != denoise::NOISY);
        let told: Vec<String> = changes.iter().map(Relight::to_string).collect();
        let earlier = self.told(RELIT).map(|earlier| earlier.to_owned() + " ").unwrap_or_default();
        self.picture.metadata.retain(|(key, _)| key != RELIT);
        self.picture.metadata.push((RELIT.into(), earlier + &told.join(" ")));
        Ok(())
    }
}

/// Puts colours in place of a layer's.
fn replace_colours(layer: &mut Layer, pixels: &[[f32; 3]]) {
    let new = Layer::from_rgb(&layer.name, pixels);
    layer.channels.retain(|channel| !["R", "G", "B", "Y"].contains(&channel.name.as_str()));
    layer.channels.extend(new.channels);
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_formats::Limits;
    use straal_formats::image::exr::{self, Layered};

    #[test]
    fn what_is_said_is_told_again() {
        for (text, told) in [
            ("key=2", "key=2"),
            ("key=off", "key=0"),
            ("key=warm,0.5", "key=0.5,3000K"),
            (" a_b =5600K", "a_b=1,5600K"),
            ("x=#FF8000", "x=1,#ff8000"),
        ] {
            assert_eq!(text.parse::<Relight>().map(|r| r.to_string()), Ok(told.to_owned()), "{text}");
        }
        for wrong in [
            "key",
            "key=",
            "key=-1",
            "key=1e9",
            "key=1,2",
            "key=3000K,cool",
            "key=hot",
            "key=10K",
            "key=#12345",
            "key=nan",
        ] {
            assert!(wrong.parse::<Relight>().is_err(), "{wrong}");
        }
    }

    /// White stays white at 6504 K, and a filter keeps the luminance.
    #[test]
    fn kelvins_keep_the_brightness() {
        let space = Space::Srgb.rgb();
        let of = |kelvin| Tint::Kelvin(kelvin).factors(&space);
        let luminance =
            |rgb: [f64; 3]| -> f64 { rgb.iter().zip(space.luminance()).map(|(a, b)| a * b).sum() };
        for kelvin in [2000.0, 3000.0, 6504.0, 20_000.0] {
            let y = luminance(of(kelvin));
            assert!((y - 1.0).abs() < 2e-3, "{kelvin}: {y}");
        }
        assert!(of(6504.0).iter().all(|v| (v - 1.0).abs() < 1e-6), "{:?}", of(6504.0));
        let warm = of(3000.0);
        assert!(warm[0] > 1.3 && warm[2] < 0.5, "{warm:?}");
    }

    fn picture(layers: &[(&str, [f32; 3])]) -> PictureFile {
        let mut picture = Layered::of_size(2, 1);
        picture.layers = layers.iter().map(|(name, rgb)| Layer::from_rgb(name, &[*rgb, [0.0; 3]])).collect();
        let mut bytes = Vec::new();
        exr::write(&mut bytes, &picture).expect("memory takes all");
        PictureFile::read(&bytes, &Limits::default()).expect("whole")
    }

    fn relit(picture: &PictureFile, changes: &[&str]) -> Result<[f32; 3], NoRelight> {
        let changes: Vec<Relight> = changes.iter().map(|text| text.parse().expect("a change")).collect();
        let mut picture = picture.clone();
        picture.relight(&changes).map(|()| picture.photo.pixels[0])
    }

    #[test]
    fn groups_are_added_up() {
        let own = picture(&[
            ("", [3.5, 2.0, 1.0]),
            ("Combined_key", [2.0, 1.0, 0.0]),
            ("Combined_fill", [1.0, 1.0, 1.0]),
            ("Combined_rest", [0.5, 0.0, 0.0]),
        ]);
        assert_eq!(relit(&own, &["key=2"]), Ok([5.5, 3.0, 1.0]));
        assert_eq!(relit(&own, &["key=off", "rest=off", "fill=3"]), Ok([3.0, 3.0, 3.0]));
        assert_eq!(relit(&own, &["key=2", "key=0.5"]), Ok([3.5, 2.0, 1.0]));
        assert_eq!(relit(&own, &["fill=#ff0000"]), Ok([3.5, 1.0, 0.0]));
        let unknown = relit(&own, &["kee=2"]).expect_err("no such group").to_string();
        assert!(unknown.contains("`kee`") && unknown.contains("key"), "{unknown}");
        let none = picture(&[("", [1.0; 3])]);
        assert_eq!(relit(&none, &["key=2"]), Err(NoRelight::NoGroups));
    }

    /// Blender's pictures, and Arnold's, have no layer of the rest.
    #[test]
    fn other_renderers_groups_are_known() {
        let blender =
            picture(&[("ViewLayer.Combined", [3.0, 2.0, 1.0]), ("ViewLayer.Combined_key", [2.0, 1.0, 0.5])]);
        assert_eq!(relit(&blender, &["key=off"]), Ok([1.0, 1.0, 0.5]));
        let arnold = picture(&[("", [3.0, 2.0, 1.0]), ("RGBA_key", [2.0, 1.0, 0.5])]);
        assert_eq!(relit(&arnold, &["key=3"]), Ok([7.0, 4.0, 2.0]));
    }

    /// What is written again adds up again.
    #[test]
    fn layers_follow() {
        let mut own = picture(&[("", [3.0; 3]), ("Combined_key", [2.0; 3]), ("Combined_rest", [1.0; 3])]);
        own.relight(&["key=0.25".parse().expect("a change")]).expect("a group");
        let layer = own.picture.layer("Combined_key").and_then(Layer::rgb).expect("the layer");
        assert_eq!((layer[0], own.photo.pixels[0]), ([0.5; 3], [1.5; 3]));
        own.relight(&["rest=off".parse().expect("a change")]).expect("a group");
        assert_eq!(own.photo.pixels[0], [0.5; 3]);
        assert_eq!(own.told(RELIT), Some("key=0.25 rest=0"));
    }
}
