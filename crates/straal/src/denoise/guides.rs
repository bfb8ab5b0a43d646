//! Layers that tell the network what each pixel shows.

use straal_formats::image::exr::{Layer, Layered};

/// Albedo and normal of each pixel, where they are there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guides {
    /// Share of light that the surface reflects or passes on.
    pub albedo: Option<Vec<[f32; 3]>>,
    /// Normal of the surface.
    pub normal: Option<Vec<[f32; 3]>>,
    /// The layer of the albedo.
    pub albedo_name: String,
    /// The layer of the normals.
    pub normal_name: String,
    /// Pixels whose albedo, and whose normal, is no number.
    pub bad: [usize; 2],
    /// What a person should know of how they were found, each a sentence without a full stop.
    pub notes: Vec<String>,
}

/// What the guides are called in messages.
const WHAT: [&str; 2] = ["albedo", "normals"];

/// What renderers call the albedo, spaces and the like left out, the best first: Blender's is smoothed where the surface is a mirror, for denoisers.
const ALBEDO: [&str; 7] =
    ["denoisingalbedo", "denoisealbedo", "albedo", "diffusealbedo", "basecolor", "basecolour", "alb"];

/// What renderers call the normal.
const NORMAL: [&str; 12] = [
    "denoisingnormal",
    "denoisenormal",
    "normal",
    "normals",
    "shadingnormal",
    "shnormal",
    "avgshadingnormal",
    "normalworld",
    "worldnormal",
    "ns",
    "n",
    "nrm",
];

/// Those of both.
const NAMES: [&[&str]; 2] = [&ALBEDO, &NORMAL];

impl Guides {
    /// The guides of a picture whose light is the layer `light`.
    pub fn of(picture: &Layered, light: &str) -> Self {
        let mut guides = Self::default();
        let pixels = picture.data_window.width * picture.data_window.height;
        for (k, names) in NAMES.into_iter().enumerate() {
            let is_albedo = k == 0;
            let Some(layer) = find(picture, light, names) else { continue };
            let channels = if is_albedo {
                [["R", "G", "B"], ["X", "Y", "Z"]]
            } else {
                [["X", "Y", "Z"], ["R", "G", "B"]]
            };
            match triples(layer, channels).filter(|values| values.len() == pixels) {
                Some(values) => {
                    guides.bad[k] = values.iter().filter(|v| v.iter().any(|v| !v.is_finite())).count();
                    let name = layer.name.clone();
                    if is_albedo {
                        (guides.albedo, guides.albedo_name) = (Some(values), name);
                    } else {
                        (guides.normal, guides.normal_name) = (Some(values), name);
                    }
                }
                None => guides.notes.push(format!(
                    "the layer `{}` should be the {}, but hasn't three channels that say so",
                    layer.name, WHAT[k]
                )),
            }
        }
        guides
    }

    /// The names of the layers that would be taken for albedo and normals.
    pub(crate) fn names(picture: &Layered, light: &str) -> [Option<String>; 2] {
        NAMES.map(|names| find(picture, light, names).map(|layer| layer.name.clone()))
    }

    /// Albedo and normals, where both are there.
    pub(crate) fn both(&self) -> Option<[&[[f32; 3]]; 2]> {
        Some([self.albedo.as_deref()?, self.normal.as_deref()?])
    }

    /// The notes, with that of pixels which are no numbers.
    pub(crate) fn told(&self) -> Vec<String> {
        let mut notes = self.notes.clone();
        for (bad, what) in self.bad.iter().zip(WHAT).filter(|(bad, _)| **bad > 0) {
            let place = if *bad == 1 { "1 pixel".to_owned() } else { format!("{bad} pixels") };
            notes.push(format!("{what} of {place} are no numbers and count as 0"));
        }
        notes
    }
}

/// The layer with the best of these names; of several the one that stands nearest to the layer of light: `View.Albedo` goes with `View.Combined`.
fn find<'a>(picture: &'a Layered, light: &str, names: &[&str]) -> Option<&'a Layer> {
    let group = |name: &str| name.rsplit_once('.').map_or("", |(group, _)| group).to_lowercase();
    let rank = |layer: &Layer| {
        let last = layer.name.rsplit('.').next().unwrap_or_default();
        let plain: String =
            last.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
        let rank = names.iter().position(|name| *name == plain)?;
        Some((group(&layer.name) != group(light), rank))
    };
    { picture.layers.iter() }
        .filter(|layer| layer.name != light)
        .filter_map(|layer| Some((rank(layer)?, layer)))
        .min_by_key(|(rank, _)| *rank)
        .map(|(_, layer)| layer)
}

/// Three channels of one of these sets of names, in any case of letters.
fn triples(layer: &Layer, sets: [[&str; 3]; 2]) -> Option<Vec<[f32; 3]>> {
    let channel = |name: &str| {
        let found = layer.channels.iter().find(|c| c.name.eq_ignore_ascii_case(name));
        found.map(|c| c.samples.as_slice())
    };
    sets.iter().find_map(|names| {
        let [a, b, c] = names.map(channel);
        Some(a?.iter().zip(b?).zip(c?).map(|((&a, &b), &c)| [a, b, c]).collect())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_formats::image::exr::Channel;

    fn picture(layers: &[(&str, [&str; 3])]) -> Layered {
        let mut picture = Layered::of_size(1, 1);
        for (k, (name, channels)) in layers.iter().enumerate() {
            let channel = |name: &str| Channel { name: name.into(), samples: vec![k as f32] };
            let channels = channels.map(channel).to_vec();
            picture.layers.push(Layer { name: (*name).into(), channels });
        }
        picture
    }

    #[test]
    fn layers_of_several_renderers_are_found() {
        let rgb = ["R", "G", "B"];
        let xyz = ["X", "Y", "Z"];
        for (light, albedo, normal, channels) in [
            ("", "albedo", "normal", xyz),
            ("ViewLayer.Combined", "ViewLayer.Denoising Albedo", "ViewLayer.Denoising Normal", xyz),
            ("", "Albedo", "Ns", xyz),
            ("", "albedo", "sh_normal", xyz),
            ("RGB", "ALBEDO", "AVG_SHADING_NORMAL", rgb),
            ("", "denoise_albedo", "N", rgb),
        ] {
            let layers = [(light, rgb), ("depth", xyz), (albedo, rgb), (normal, channels)];
            let guides = Guides::of(&picture(&layers), light);
            assert_eq!(
                (guides.albedo, guides.normal),
                (Some(vec![[2.0; 3]]), Some(vec![[3.0; 3]])),
                "{albedo}"
            );
            assert_eq!((guides.albedo_name.as_str(), guides.normal_name.as_str()), (albedo, normal));
            assert!(guides.notes.is_empty());
        }
    }

    #[test]
    fn the_layer_beside_the_light_is_taken() {
        let rgb = ["R", "G", "B"];
        let layers =
            [("Left.Combined", rgb), ("Left.Albedo", rgb), ("Right.Combined", rgb), ("Right.Albedo", rgb)];
        let picture = picture(&layers);
        assert_eq!(Guides::of(&picture, "Right.Combined").albedo_name, "Right.Albedo");
        assert_eq!(Guides::of(&picture, "Left.Combined").albedo_name, "Left.Albedo");
    }

    #[test]
    fn what_cannot_be_used_is_told() {
        let picture = picture(&[("", ["R", "G", "B"]), ("albedo", ["Y", "u", "v"])]);
        let guides = Guides::of(&picture, "");
        assert_eq!(guides.albedo, None);
        assert!(guides.notes[0].contains("`albedo` should be the albedo"), "{:?}", guides.notes);
    }
}
