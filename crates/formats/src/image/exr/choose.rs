//! Which layer of an EXR is the picture: by what the names mean, not by their order.
//!
//! The format has no rule for it. What has no layer's name is the picture; else the layer that renderers and compositors
//! call so (`Combined` of Blender, `beauty`, `rgba`); else any colours that aren't known to be something else, such as
//! normals or albedo; and only then grey or a lone channel.

/// What the names of a file say.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Names {
    /// Of a layer; empty for the channels that belong to none.
    pub layer: String,
    /// Of its channels.
    pub channels: Vec<String>,
}

/// How the numbers of a picture are told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Red, green and blue.
    Rgb,
    /// X, Y and Z of the CIE.
    Xyz,
    /// Luminance, and how red and blue differ from it.
    Chroma,
    /// Light or reflectance by wavelengths.
    Spectral,
    /// One number for all.
    Grey,
}

/// Where the picture is.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Choice {
    pub kind: Kind,
    pub layer: String,
    /// The channels as they are called in the file: three, or one of grey; none of a spectrum, which has them all.
    pub channels: Vec<String>,
    /// What a person should know of the choice.
    pub note: Option<String>,
}

impl Choice {
    /// The sum of a layer's wavelengths.
    pub(super) fn spectral(layer: &str) -> Self {
        Self { kind: Kind::Spectral, layer: layer.to_owned(), channels: Vec::new(), note: None }
    }
}

/// Last words of a layer's name that say that it is the picture, the best first.
const SURE: [&str; 4] = ["combined", "beauty", "rgba", "rgb"];

/// Words that say so when nothing better is there.
const LIKELY: [&str; 12] = [
    "color",
    "colour",
    "composite",
    "image",
    "picture",
    "final",
    "master",
    "main",
    "default",
    "ci",
    "c",
    "noisy image",
];

/// Last words of layers that are something else than the picture.
const OTHER: [&str; 43] = [
    "n",
    "p",
    "z",
    "uv",
    "st",
    "id",
    "ao",
    "pos",
    "point",
    "normal",
    "normals",
    "depth",
    "mist",
    "index",
    "indexob",
    "indexma",
    "position",
    "vector",
    "motion",
    "velocity",
    "speed",
    "mask",
    "matte",
    "alpha",
    "shadow",
    "samples",
    "cost",
    "time",
    "error",
    "variance",
    "albedo",
    "diffcol",
    "glosscol",
    "transcol",
    "diffuse color",
    "roughness",
    "tangent",
    "ambient occlusion",
    "debug",
    "coverage",
    "opacity",
    "emit",
    "env",
];

/// Parts of names that say the same.
const OTHER_PARTS: [&str; 10] = [
    "albedo",
    "normal",
    "crypto",
    "denois",
    "position",
    "depth",
    "variance",
    "motion",
    "occlusion",
    "stderr",
];

/// How well a layer fits, the least best; layers of the same rank can't be told apart by what they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Unnamed,
    Sure,
    Likely,
    /// Wavelengths, where there isn't even grey without a name.
    Wavelengths,
    Colours,
    Grey,
    /// Wavelengths beside grey.
    WavelengthsToo,
    OtherGrey,
    OtherColours,
    Lone,
    OtherLone,
}

/// The picture of a file with these layers; `spectral` is the layer whose wavelengths can be summed. `None` where nothing
/// can be shown.
pub(super) fn choose(layers: &[Names], spectral: Option<&str>) -> Option<Choice> {
    let unnamed_grey = layers.iter().any(|l| l.layer.is_empty() && has(l, "Y"));
    let mut found: Vec<(Rank, usize, Choice)> = Vec::new();
    for names in layers {
        let (kind, channels) = match shown(names) {
            Some(shown) => shown,
            None => continue,
        };
        let choice = Choice { kind, layer: names.layer.clone(), channels, note: None };
        let (rank, order) = rank(names, kind);
        found.push((rank, order, choice));
    }
    if let Some(layer) = spectral {
        let rank = if unnamed_grey { Rank::WavelengthsToo } else { Rank::Wavelengths };
        let choice = Choice::spectral(layer);
        found.retain(|(_, _, other)| other.layer != layer);
        found.push((rank, 0, choice));
    }
    // The sort is stable: what fits equally well stays in the order of the file.
    found.sort_by_key(|(rank, order, _)| (*rank, *order));
    let best = found.first()?.0;
    let equal: Vec<&Choice> = found.iter().filter(|f| f.0 == best).map(|(_, _, choice)| choice).collect();
    let mut choice = equal[0].clone();
    choice.note = note(best, &equal);
    Some(choice)
}

/// The layer of that name, or the only one whose name ends in it, in any case of letters.
pub(super) fn named(layers: &[Names], wanted: &str) -> Result<Choice, String> {
    let lower = wanted.to_lowercase();
    let ends = |l: &Names| l.layer.to_lowercase().ends_with(&format!(".{lower}"));
    let by = |fits: &dyn Fn(&Names) -> bool| layers.iter().filter(|l| fits(l)).collect::<Vec<_>>();
    let mut found = by(&|l| l.layer == wanted);
    if found.is_empty() {
        found = by(&|l| l.layer.to_lowercase() == lower);
    }
    if found.is_empty() {
        found = by(&ends);
    }
    let all = || list(layers.iter().map(|l| l.layer.as_str()));
    match found.as_slice() {
        [] => Err(format!("it has no layer `{wanted}`, only {}", all())),
        [one] => {
            let (kind, channels) = shown(one).ok_or_else(|| {
                let channels = list(one.channels.iter().map(String::as_str));
                format!("the layer `{}` can't be shown: its channels are {channels}", one.layer)
            })?;
            Ok(Choice { kind, layer: one.layer.clone(), channels, note: None })
        }
        several => {
            let names = list(several.iter().map(|l| l.layer.as_str()));
            Err(format!("several layers could be meant by `{wanted}`: {names}"))
        }
    }
}

/// What a person should know: that others would have done as well, or that it may be no picture at all.
fn note(rank: Rank, equal: &[&Choice]) -> Option<String> {
    let taken = &equal[0].layer;
    if equal.len() > 1 {
        let names = list(equal.iter().map(|c| c.layer.as_str()));
        let name = if taken.is_empty() { "the one without a name".into() } else { format!("`{taken}`") };
        let another = "`straal develop --layer NAME` makes a picture of another";
        return Some(format!(
            "several of its layers could be the picture, {names}: {name} is taken; {another}"
        ));
    }
    match rank {
        Rank::OtherColours => {
            Some(format!("it has no colours but those of the layer `{taken}`, which is taken"))
        }
        Rank::Lone | Rank::OtherLone => {
            let dot = if taken.is_empty() { "" } else { "." };
            let channel = &equal[0].channels[0];
            Some(format!("it has no colours: the channel `{taken}{dot}{channel}` is taken as grey"))
        }
        _ => None,
    }
}

/// Names in a row, at most ten of them.
fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    const MOST: usize = 10;
    let quoted = |n: &str| if n.is_empty() { "the one without a name".into() } else { format!("`{n}`") };
    let mut all: Vec<String> = names.map(quoted).collect();
    if all.len() > MOST {
        let more = all.len() - MOST;
        all.truncate(MOST);
        return format!("{} and {more} more", all.join(", "));
    }
    match all.pop() {
        Some(last) if !all.is_empty() => format!("{} and {last}", all.join(", ")),
        Some(last) => last,
        None => "none".into(),
    }
}

fn has(names: &Names, channel: &str) -> bool {
    names.channels.iter().any(|c| c == channel)
}

/// What of a layer can be shown.
fn shown(names: &Names) -> Option<(Kind, Vec<String>)> {
    let exact =
        |wanted: [&str; 3]| wanted.iter().all(|w| has(names, w)).then(|| wanted.map(str::to_owned).to_vec());
    let any_case = |wanted: [&str; 3]| {
        let find = |w: &str| names.channels.iter().find(|c| c.eq_ignore_ascii_case(w)).cloned();
        wanted.into_iter().map(find).collect::<Option<Vec<_>>>()
    };
    let rgb = exact(["R", "G", "B"]).or_else(|| any_case(["r", "g", "b"]));
    // Nuke writes whole words.
    if let Some(channels) = rgb.or_else(|| any_case(["red", "green", "blue"])) {
        return Some((Kind::Rgb, channels));
    }
    let is_picture = names.layer.is_empty() || word(&names.layer, &SURE).is_some();
    if let Some(channels) = exact(["X", "Y", "Z"]).filter(|_| is_picture) {
        return Some((Kind::Xyz, channels));
    }
    if let Some(channels) = exact(["Y", "RY", "BY"]) {
        return Some((Kind::Chroma, channels));
    }
    let grey = |channel: &str| Some((Kind::Grey, vec![channel.to_owned()]));
    match names.channels.as_slice() {
        // X, Y and Z of a layer are a direction or a place.
        channels if has(names, "Y") && !has(names, "X") && !channels.is_empty() => grey("Y"),
        [one] => grey(one),
        _ => None,
    }
}

/// How well a layer fits that can be shown in this way, and its place among those that fit as well by its words.
fn rank(names: &Names, kind: Kind) -> (Rank, usize) {
    let colours = kind != Kind::Grey;
    let sure = word(&names.layer, &SURE);
    let likely = LIKELY.iter().position(|w| *w == last_word(&names.layer));
    let other = is_other(&names.layer);
    let luminance = has(names, "Y");
    if colours {
        return match (sure, likely) {
            _ if names.layer.is_empty() => (Rank::Unnamed, 0),
            (Some(place), _) => (Rank::Sure, place),
            (_, Some(place)) => (Rank::Likely, place),
            _ if other => (Rank::OtherColours, 0),
            _ => (Rank::Colours, 0),
        };
    }
    match (sure.or(likely.map(|place| place + SURE.len())), luminance) {
        (Some(place), true) => (Rank::Grey, place),
        (_, true) if names.layer.is_empty() => (Rank::Grey, SURE.len() + LIKELY.len()),
        (_, true) if !other => (Rank::OtherGrey, 0),
        (Some(place), false) => (Rank::Lone, place),
        _ if other || is_other(&names.channels[0]) || names.channels[0] == "A" => (Rank::OtherLone, 0),
        _ => (Rank::Lone, SURE.len() + LIKELY.len()),
    }
}

/// The last word of a layer's name in small letters. A view, which stereo pictures name last, doesn't count.
fn last_word(layer: &str) -> String {
    let mut words: Vec<String> = layer.split(['.', ':', '/', '|']).map(|w| w.trim().to_lowercase()).collect();
    if words.len() > 1 && words.last().is_some_and(|w| w == "left" || w == "right") {
        words.pop();
    }
    words.pop().unwrap_or_default()
}

/// Which of the words the name ends in, set off by anything that is no letter or digit.
fn word(layer: &str, words: &[&str]) -> Option<usize> {
    let last = last_word(layer);
    words
        .iter()
        .position(|w| last.strip_suffix(w).is_some_and(|before| !before.ends_with(char::is_alphanumeric)))
}

/// Whether a layer, or a channel of its own, is known to be something else than the picture.
fn is_other(layer: &str) -> bool {
    let last = last_word(layer);
    let bare = last.trim_end_matches(|c: char| c.is_ascii_digit() || c == '_');
    OTHER.contains(&bare) || OTHER_PARTS.iter().any(|part| last.contains(part))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Layers from the full names of channels, in the order of the file.
    fn layers(channels: &str) -> Vec<Names> {
        let mut layers: Vec<Names> = Vec::new();
        for full in channels.split(", ") {
            let (layer, name) = full.rsplit_once('.').unwrap_or(("", full));
            match layers.iter_mut().find(|l| l.layer == layer) {
                Some(known) => known.channels.push(name.into()),
                None => layers.push(Names { layer: layer.into(), channels: vec![name.into()] }),
            }
        }
        layers
    }

    fn taken(channels: &str) -> (String, bool) {
        let choice = choose(&layers(channels), None).unwrap();
        (format!("{}:{}", choice.layer, choice.channels.join("")), choice.note.is_some())
    }

    #[test]
    fn the_picture_is_found_by_its_meaning() {
        for (channels, want, told) in [
            ("Z, beauty.R, beauty.G, beauty.B", "beauty:RGB", false),
            (
                "V.AO.B, V.AO.G, V.AO.R, V.Combined.A, V.Combined.B, V.Combined.G, V.Combined.R, V.Depth.Z",
                "V.Combined:RGB",
                false,
            ),
            (
                "View Layer.Combined.R, View Layer.Combined.G, View Layer.Combined.B, a.R, a.G, a.B",
                "View Layer.Combined:RGB",
                false,
            ),
            ("RGBA.B, RGBA.G, RGBA.R, diffuse.R, diffuse.G, diffuse.B", "RGBA:RGB", false),
            ("a.R, a.G, a.B, my_Beauty.B, my_Beauty.G, my_Beauty.R", "my_Beauty:RGB", false),
            ("notbeauty.R, notbeauty.G, notbeauty.B", "notbeauty:RGB", false),
            (
                "albedo.B, albedo.G, albedo.R, color.B, color.G, color.R, normal.X, normal.Y, normal.Z",
                "color:RGB",
                false,
            ),
            ("a.red, a.green, a.blue, Z", "a:redgreenblue", false),
            ("r, g, b, beauty.R, beauty.G, beauty.B", ":rgb", false),
            ("A, depth.Z, diffuse.R, diffuse.G, diffuse.B", "diffuse:RGB", false),
            ("Y, diffuse.R, diffuse.G, diffuse.B", "diffuse:RGB", false),
            ("Y, albedo.R, albedo.G, albedo.B", ":Y", false),
            ("Y, RY, BY", ":YRYBY", false),
            ("X, Y, Z, albedo.R, albedo.G, albedo.B", ":XYZ", false),
            ("normal.X, normal.Y, normal.Z, beauty.Y", "beauty:Y", false),
            ("albedo.R, albedo.G, albedo.B, depth.Z", "albedo:RGB", true),
            ("diffuse.R, diffuse.G, diffuse.B, specular.R, specular.G, specular.B", "diffuse:RGB", true),
            (
                "A.Combined.R, A.Combined.G, A.Combined.B, B.Combined.R, B.Combined.G, B.Combined.B",
                "A.Combined:RGB",
                true,
            ),
            (
                "V.Combined.left.R, V.Combined.left.G, V.Combined.left.B, V.AO.left.R, V.AO.left.G, V.AO.left.B",
                "V.Combined.left:RGB",
                false,
            ),
            (
                "beauty.R, beauty.G, beauty.B, V.Combined.R, V.Combined.G, V.Combined.B",
                "V.Combined:RGB",
                true,
            ),
            ("Z", ":Z", true),
            ("depth.Z, glow.V", "glow:V", true),
        ] {
            assert_eq!(taken(channels), (want.to_string(), told), "{channels}");
        }
        for nothing in ["normal.X, normal.Y, normal.Z", "A, Z"] {
            assert_eq!(choose(&layers(nothing), None), None, "{nothing}");
        }
    }

    #[test]
    fn ties_name_all_that_could_be_meant() {
        let told = choose(&layers("b.R, b.G, b.B, a.R, a.G, a.B, albedo.R, albedo.G, albedo.B"), None);
        let told = told.unwrap().note.unwrap();
        let want =
            "several of its layers could be the picture, `b` and `a`: `b` is taken; `straal develop --layer";
        assert!(told.starts_with(want), "{told}");
    }

    #[test]
    fn a_layer_can_be_asked_for() {
        let all = layers("R, G, B, V.AO.R, V.AO.G, V.AO.B, V.Depth.Z, V.Normal.X, V.Normal.Y");
        let named = |name: &str| named(&all, name).map(|c| (c.layer, c.kind));
        assert_eq!(named("v.ao"), Ok(("V.AO".into(), Kind::Rgb)));
        assert_eq!(named("depth"), Ok(("V.Depth".into(), Kind::Grey)));
        assert_eq!(named(""), Ok((String::new(), Kind::Rgb)));
        assert!(
            named("fog")
                .unwrap_err()
                .starts_with("it has no layer `fog`, only the one without a name, `V.AO`")
        );
        assert!(named("Normal").unwrap_err().ends_with("can't be shown: its channels are `X` and `Y`"));
    }
}
