//! `straal info`

use super::{print, read_picture};
use crate::args::InfoArgs;
use crate::exit::{Exit, Failure};
use serde_json::{Map, Value as Json, json};
use straal::picture::film_hash;
use straal::sums;
use straal_color::{RgbSpace, Space};
use straal_formats::ReadError;
use straal_formats::image::exr::{self, Channel, Layer, Window};
use straal_formats::image::{Format, Photo};

/// What a picture tells of itself.
#[derive(Default)]
struct Summary {
    /// Of the whole picture.
    size: [usize; 2],
    /// The part that is there, where it isn't all.
    part: Option<Window>,
    /// What is outside of it.
    rest: &'static str,
    /// What its colours are.
    colours: String,
    /// The layer that is the picture, where that isn't the one without a name.
    picture: Option<String>,
    /// What was guessed, and what couldn't be honoured or is no light.
    notes: Vec<String>,
    layers: Vec<(String, Vec<Range>)>,
    facts: Vec<(String, String)>,
    /// Whether the film hash that is told is that of the pixels.
    hash_is_right: Option<bool>,
}

/// What is known of a channel's numbers.
#[derive(Clone, Debug, PartialEq)]
struct Range {
    name: String,
    /// Least, mean and greatest of those that are finite; `None` when none is.
    finite: Option<[f64; 3]>,
    nans: usize,
    infinities: usize,
}

impl Range {
    fn of(channel: &Channel) -> Self {
        let (mut least, mut sum, mut most, mut count) = (f64::INFINITY, 0.0, f64::NEG_INFINITY, 0_usize);
        for v in channel.samples.iter().filter(|v| v.is_finite()).map(|v| f64::from(*v)) {
            least = if v < least { v } else { least };
            most = if v > most { v } else { most };
            sum += v;
            count += 1;
        }
        let nans = channel.samples.iter().filter(|v| v.is_nan()).count();
        Self {
            name: channel.name.clone(),
            finite: (count > 0).then(|| [least, sum / count as f64, most]),
            nans,
            infinities: channel.samples.len() - count - nans,
        }
    }

    fn tell(&self) -> String {
        let mut text = match self.finite {
            Some([least, mean, most]) => format!("{} .. {}, mean {}", short(least), short(most), short(mean)),
            None => "no number".to_owned(),
        };
        for (count, what) in [(self.nans, "NaN"), (self.infinities, "infinite")] {
            if count > 0 {
                text += &format!(", {count} {what}");
            }
        }
        text
    }

    fn as_json(&self) -> Json {
        let [least, mean, most] = self.finite.map_or([None; 3], |f| f.map(Some));
        json!({
            "name": self.name, "min": least, "mean": mean, "max": most,
            "nan": self.nans, "infinite": self.infinities,
        })
    }
}

/// Six digits, without noughts at the end.
fn short(v: f64) -> String {
    let size = v.abs();
    if v != 0.0 && !(1e-4..1e7).contains(&size) {
        return format!("{v:.4e}");
    }
    let text = format!("{v:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Prints what a picture tells of itself.
pub fn run(args: &InfoArgs) -> Result<Exit, Failure> {
    if sums::is_named(&args.picture) {
        return tell_sums(args);
    }
    let bytes = read_picture(&args.picture)?;
    let metadata =
        read(&bytes).map_err(|e| Failure::input(format!("can't read {}: {e}", args.picture.display())))?;
    if args.json {
        print(&format!("{:#}\n", metadata.as_json()))?;
    } else {
        print(&metadata.tell())?;
    }
    Ok(Exit::Fine)
}

/// The same of a file of sums, once all of it is found to be what was written.
fn tell_sums(args: &InfoArgs) -> Result<Exit, Failure> {
    let failed = |e: sums::SumsError| Failure::input(e.to_string());
    let mut kept = sums::Kept::open(&args.picture).map_err(failed)?;
    kept.verify().map_err(failed)?;
    let stamp = &kept.stamp;
    if args.json {
        let facts = stamp.metadata.iter().map(|(key, value)| (key.clone(), json!(value)));
        let corners = [stamp.span.crop.min, stamp.span.crop.max].concat();
        let told = json!({
            "size": stamp.size,
            "crop": corners,
            "sums_of_samples": [stamp.span.first, stamp.span.end],
            "metadata": Json::Object(facts.collect::<Map<_, _>>()),
        });
        print(&format!("{told:#}\n"))?;
    } else {
        print(&format!("exact sums of a render, for `straal merge` or --resume\n{stamp}"))?;
    }
    Ok(Exit::Fine)
}

fn read(bytes: &[u8]) -> Result<Summary, ReadError> {
    let limits = super::picture_limits();
    if Format::of(bytes)? != Format::Exr {
        let mut photo = Photo::read(bytes, &limits)?;
        photo.notes.extend(faults(&photo));
        return Ok(Summary {
            size: photo.size,
            colours: photo_colours(&photo),
            layers: layers(&[Layer::from_rgb("", &photo.pixels)]),
            facts: photo.metadata,
            notes: photo.notes,
            ..Summary::default()
        });
    }
    let picture = exr::read(bytes, &limits)?;
    let (whole, part) = (picture.display_window, picture.data_window);
    let told = picture.metadata.iter().find(|(key, _)| key == "straal.film_hash");
    let rgb = picture.layer("").and_then(Layer::rgb);
    // A file without a picture in it is told of as well.
    let photo = Photo::of_exr(&picture, None).ok();
    let notes = photo.as_ref().map(|p| p.notes.iter().cloned().chain(faults(p)).collect());
    let is_crop = photo.as_ref().is_some_and(Photo::is_crop);
    Ok(Summary {
        size: [whole.width, whole.height],
        part: (part != whole).then_some(part),
        rest: if is_crop { "the rest was not rendered" } else { "the rest is black" },
        colours: picture_colours(&picture),
        picture: photo.map(|p| p.layer).filter(|layer| !layer.is_empty()),
        layers: layers(&picture.layers),
        hash_is_right: told.zip(rgb).map(|((_, hash), rgb)| *hash == film_hash(&rgb)),
        notes: notes.unwrap_or_else(|| picture.notes.clone()),
        facts: picture.metadata,
    })
}

/// Where numbers are no light.
fn faults(photo: &Photo) -> Vec<String> {
    let faults = photo.faults();
    [faults.nan.told("no number (NaN)", ""), faults.infinite.told("infinite", "")]
        .into_iter()
        .flatten()
        .collect()
}

/// What the numbers of a picture are that is no EXR.
fn photo_colours(photo: &Photo) -> String {
    let own = colours(photo.space.as_ref());
    match &photo.encoding {
        None => own,
        Some(encoding) => {
            let space = if photo.space.is_some() { own } else { "linear RGB of srgb".into() };
            format!("{} bits, {}; numbers are of the light: {space}", encoding.bits, encoding.told)
        }
    }
}

fn layers(all: &[Layer]) -> Vec<(String, Vec<Range>)> {
    all.iter().map(|l| (l.name.clone(), l.channels.iter().map(Range::of).collect())).collect()
}

/// What the numbers of the picture itself are, and what it has by wavelengths.
fn picture_colours(picture: &exr::Layered) -> String {
    let contents = exr::SpectralContents::of(picture);
    let beauty = picture.beauty();
    let summed = beauty.as_ref().ok().filter(|b| picture.layer(&b.layer).is_some_and(exr::is_spectral_layer));
    let own = match &beauty {
        Ok(beauty) => summed.is_none().then(|| colours(beauty.space.as_ref())),
        Err(_) => (contents == exr::SpectralContents::default()).then(|| colours(picture.space.as_ref())),
    };
    let daylight =
        summed.filter(|b| b.layer != exr::SPECTRAL_LAYER).map(|_| ", developed as it looks under D65");
    let at = |what: &str, count: usize| {
        let s = if count == 1 { "" } else { "s" };
        (count > 0).then(|| format!("{what} at {count} wavelength{s}"))
    };
    let layer = beauty.as_ref().ok().and_then(|b| picture.layer(&b.layer));
    let is_chroma = layer.is_some_and(|l| l.channel("RY").is_some() && l.channel("R").is_none());
    [
        own,
        is_chroma.then(|| "told as luminance and chroma (Y, RY, BY)".to_owned()),
        at("radiance", contents.radiance),
        at("reflectance", contents.reflectance).map(|told| told + daylight.unwrap_or_default()),
        contents.polarised.then(|| "polarisation, which straal doesn't read".to_owned()),
        contents.fluorescent.then(|| "fluorescence, which straal doesn't read".to_owned()),
    ]
    .into_iter()
    .flatten()
    .collect::<Vec<_>>()
    .join("; ")
}

fn colours(space: Option<&RgbSpace>) -> String {
    if space == Some(&RgbSpace::XYZ) {
        return "CIE XYZ in place of R, G and B; white is D65".into();
    }
    let Some(space) = space else { return "linear RGB; the file doesn't say of which primaries".into() };
    if let Some(named) = Space::of(space) {
        return format!("linear RGB of {}", named.name());
    }
    let [r, g, b] = space.primaries.map(|p| format!("{:.4}, {:.4}", p.x, p.y));
    format!("linear RGB: red {r}; green {g}; blue {b}; white {:.4}, {:.4}", space.white.x, space.white.y)
}

impl Summary {
    fn tell(&self) -> String {
        let mut rows = vec![("picture".to_owned(), format!("{} x {} pixels", self.size[0], self.size[1]))];
        if let Some(Window { x, y, width, height }) = self.part {
            let rest = self.rest;
            rows.push(("part".to_owned(), format!("{width} x {height} pixels from {x}, {y}; {rest}")));
        }
        rows.push(("colours".to_owned(), self.colours.clone()));
        rows.extend(self.picture.iter().map(|layer| ("shown".to_owned(), format!("the layer {layer}"))));
        rows.extend(self.notes.iter().map(|note| ("note".to_owned(), note.clone())));
        for (layer, channels) in &self.layers {
            for channel in channels {
                let dot = if layer.is_empty() { "" } else { "." };
                rows.push((format!("{layer}{dot}{}", channel.name), channel.tell()));
            }
        }
        rows.extend(self.facts.iter().cloned());
        rows.extend(self.hash_is_right.map(|right| {
            let verdict = if right { "that of these pixels" } else { "NOT that of these pixels" };
            ("the film hash is".to_owned(), verdict.to_owned())
        }));
        let width = rows.iter().map(|(key, _)| key.chars().count()).fold(0, Ord::max);
        rows.iter()
            .map(|(key, value)| format!("{:<width$}  {}\n", printable(key), printable(value)))
            .collect()
    }

    fn as_json(&self) -> Json {
        let facts = self.facts.iter().map(|(key, value)| (key.clone(), json!(value)));
        let layer = |(name, channels): &(String, Vec<Range>)| json!({ "name": name, "channels": channels.iter().map(Range::as_json).collect::<Json>() });
        json!({
            "size": self.size,
            "part": self.part.map(|w| json!([w.x, w.y, w.width, w.height])),
            "colours": self.colours,
            "picture": self.picture.as_deref().unwrap_or_default(),
            "notes": self.notes,
            "layers": self.layers.iter().map(layer).collect::<Json>(),
            "metadata": Json::Object(facts.collect::<Map<_, _>>()),
            "film_hash_is_right": self.hash_is_right,
        })
    }
}

/// Text of a file that anybody may have made, as a terminal can show it.
fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> exr::Layered {
        let mut picture = exr::Layered::of_size(2, 1);
        let rgb = [[0.25, 1.0, 2e-5], [0.75, f32::NAN, f32::INFINITY]];
        picture.layers = vec![Layer::from_rgb("", &rgb)];
        picture.metadata =
            vec![("straal.film_hash".into(), film_hash(&rgb)), ("who".into(), "me\x1b[2J".into())];
        picture
    }

    fn metadata(picture: &exr::Layered) -> Summary {
        let mut bytes = Vec::new();
        exr::write(&mut bytes, picture).unwrap();
        read(&bytes).unwrap()
    }

    #[test]
    fn what_is_by_wavelengths_is_told() {
        let told = |layers: &[&str]| {
            let mut picture = exr::Layered::of_size(1, 1);
            let channel = |nm: &str| exr::Channel { name: nm.into(), samples: vec![0.5] };
            let layer = |name: &&str| Layer {
                name: (*name).to_owned(),
                channels: if name.is_empty() {
                    vec![channel("Y")]
                } else {
                    vec![channel("450,000nm"), channel("600,000nm")]
                },
            };
            picture.layers = layers.iter().map(layer).collect();
            metadata(&picture).colours
        };
        assert_eq!(told(&["S0", "S3"]), "radiance at 2 wavelengths; polarisation, which straal doesn't read");
        assert_eq!(told(&["T"]), "reflectance at 2 wavelengths, developed as it looks under D65");
        assert_eq!(told(&["S0", "T"]), "radiance at 2 wavelengths; reflectance at 2 wavelengths");
        assert_eq!(told(&["T.400,000nm"]), "fluorescence, which straal doesn't read");
        let grey = told(&["", "T"]);
        assert!(grey.starts_with("linear RGB") && grey.ends_with("; reflectance at 2 wavelengths"), "{grey}");
    }

    #[test]
    fn stories_are_told_in_columns() {
        let metadata = metadata(&picture());
        let want = "\
picture           2 x 1 pixels
colours           linear RGB; the file doesn't say of which primaries
note              a number of the pixel 1, 0 is no number (NaN)
note              a number of the pixel 1, 0 is infinite
B                 2.0000e-5 .. 2.0000e-5, mean 2.0000e-5, 1 infinite
G                 1 .. 1, mean 1, 1 NaN
R                 0.25 .. 0.75, mean 0.5
straal.film_hash  ";
        let told = metadata.tell();
        assert!(told.starts_with(want), "{told}");
        assert!(
            told.ends_with("who               me [2J\nthe film hash is  that of these pixels\n"),
            "{told}"
        );
        let json = metadata.as_json();
        assert_eq!(json["layers"][0]["channels"][2]["mean"], 0.5);
        assert_eq!(
            (&json["film_hash_is_right"], &json["metadata"]["who"]),
            (&json!(true), &json!("me\x1b[2J"))
        );
    }

    #[test]
    fn other_pixels_have_another_hash() {
        let mut picture = picture();
        picture.layers[0].channels[0].samples[0] = 0.3;
        picture.data_window.x = 5;
        picture.space = Some(Space::Rec2020.rgb());
        let metadata = metadata(&picture);
        assert_eq!(metadata.hash_is_right, Some(false));
        let told = metadata.tell();
        assert!(told.contains("2 x 1 pixels from 5, 0") && told.contains("linear RGB of rec2020"), "{told}");
    }

    #[test]
    fn other_files_have_none() {
        assert!(
            read(b"hello").is_err() && read(b"").is_err() && read(&[0x89, b'P', b'N', b'G', 13]).is_err()
        );
    }
}
