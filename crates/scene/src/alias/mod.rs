//! Words that people bring from other programs: pbrt, Mitsuba, Blender, glTF, POV-Ray, LuxCore. For each, what it is called here, how
//! the same is said, or that it can't be said yet. Nobody has to guess why a word is unknown.

mod answers;
mod cameras;
mod colours;
mod lights;
mod materials;
mod pictures;
mod scene;
mod shapes;
mod textures;

use crate::suggest::fold;
use answers::{ANIMATION, BUMPS, CHECKER, LAYERED, MASKS, MEDIA, SUBSURFACE, TEXTURES, TYPE};

/// What a word of another program is here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Here {
    /// It has another name, which takes the same value.
    Called(&'static str),
    /// The same is said in another way: what to write.
    Write(&'static str),
    /// It can't be said: what isn't supported.
    NotYet(&'static str),
}

use Here::{Called, NotYet};

/// One or several words of one meaning, without case, `_` and `-`, with spaces between.
type Rule = (&'static str, Here);

/// Where rules hold, and these. Of keys they hold in a mapping by its marks, which are keys that it has, or its name with a colon; of kinds
/// where the one that is named may stand.
type Table = (&'static str, &'static [Rule]);

/// What a key is here, of a mapping that is called `owner` and has the keys `known`.
pub fn of_key(word: &str, owner: &str, known: &[&str]) -> Option<Here> {
    let word = fold(word).collect::<String>();
    let fits = |here: &Here| match here {
        Called(key) => known.contains(key),
        _ => true,
    };
    let find = |rules: &'static [Rule]| {
        rules.iter().find(|(words, here)| fits(here) && words.split(' ').any(|w| w == word)).map(|r| r.1)
    };
    let tables = KEYS.iter().copied().flatten().filter(|(marks, _)| {
        marks.split(' ').any(|mark| match mark.strip_suffix(':') {
            Some(name) => name == owner,
            None => known.contains(&mark),
        })
    });
    tables.filter_map(|(_, rules)| find(rules)).next().or_else(|| find(ANYWHERE))
}

/// What a kind is here, where one of `kinds` is expected.
pub fn of_kind(word: &str, kinds: &[&str]) -> Option<Here> {
    let word = fold(word).collect::<String>();
    let tables = KINDS.iter().copied().flatten().filter(|(mark, _)| kinds.contains(mark));
    let mut rules = tables.flat_map(|(_, rules)| rules.iter());
    rules.find(|(words, _)| words.split(' ').any(|w| w == word)).map(|r| r.1)
}

/// What words are in which mapping. The first that fits counts.
const KEYS: [&[Table]; 8] = [
    shapes::KEYS,
    colours::KEYS,
    cameras::KEYS,
    materials::KEYS,
    textures::KEYS,
    lights::KEYS,
    pictures::KEYS,
    scene::KEYS,
];

/// What other kinds are.
const KINDS: [&[Table]; 6] =
    [materials::KINDS, textures::KINDS, shapes::KINDS, lights::KINDS, cameras::KINDS, pictures::KINDS];

/// Words that mean the same wherever they stand.
const ANYWHERE: &[Rule] = &[
    ("type", TYPE),
    ("texture textures bitmap imagemap noise3d marble wood procedural", TEXTURES),
    ("checker checkerboard", CHECKER),
    ("medium media interior exterior sigmaa sigmas sigmat volume fog mediuminterface", MEDIA),
    ("bump bumpmap normalmap", BUMPS),
    ("displacement displacementmap", NotYet("displacement maps")),
    ("alpha opacity mask alphamode", MASKS),
    ("subsurface sss", SUBSURFACE),
    ("clearcoat coat sheen", LAYERED),
    ("animation keyframes", ANIMATION),
    ("include import", NotYet("scenes in several files")),
];

#[cfg(test)]
mod tests {
    use super::*;
    use Here::Write;
    use answers::GLASS;

    #[test]
    fn a_word_is_looked_up_where_it_stands() {
        let glass = ["eta", "eta_outside", "reflectance", "transmittance"];
        assert_eq!(of_key("int_ior", "dielectric", &glass), Some(Called("eta")));
        assert_eq!(of_key("IOR", "dielectric", &glass), Some(Called("eta")));
        assert_eq!(of_key("ior", "diffuse", &["reflectance", "two_sided"]), Some(GLASS));
        assert_eq!(of_key("Kd", "diffuse", &["reflectance", "two_sided"]), Some(Called("reflectance")));
        assert_eq!(of_key("from", "perspective", &["eye", "look_at"]), Some(Called("eye")));
        assert_eq!(of_key("to", "look_at", &["eye", "target", "up"]), Some(Called("target")));
        assert_eq!(of_key("medium", "whatever", &[]), Some(MEDIA));
        assert_eq!(of_key("frobnicate", "diffuse", &["reflectance"]), None);
        assert_eq!(of_kind("distant", &["point", "directional"]), Some(Called("directional")));
        assert_eq!(of_kind("box", &["tent", "box"]), None);
    }

    #[test]
    fn every_kind_that_is_named_exists() {
        use crate::desc::{
            Camera, Filter, Integrator, Light, Mapping, Material, Node, SamplerKind, Step, Texture, Tone,
        };
        let all = [
            Camera::KINDS,
            Filter::KINDS,
            Integrator::KINDS,
            Light::KINDS,
            Material::KINDS,
            Node::KINDS,
            SamplerKind::KINDS,
            Step::KINDS,
            Texture::KINDS,
            Mapping::KINDS,
            Tone::KINDS,
        ];
        for (mark, rules) in KINDS.iter().copied().flatten() {
            let kinds: Vec<_> = all.iter().filter(|k| k.contains(mark)).collect();
            assert_eq!(kinds.len(), 1, "`{mark}` marks one type");
            for (words, here) in *rules {
                assert!(!matches!(here, Called(kind) if !kinds[0].contains(kind)), "{words}: {here:?}");
                for word in words.split(' ') {
                    assert_eq!(fold(word).collect::<String>(), word, "{words}");
                    // What is a kind itself is never looked up.
                    assert!(!kinds[0].contains(&word), "{mark}: `{word}` is a kind");
                }
            }
        }
        for (words, _) in KEYS.iter().copied().flatten().flat_map(|(_, rules)| rules.iter()).chain(ANYWHERE) {
            assert!(words.split(' ').all(|w| fold(w).collect::<String>() == w), "{words}");
        }
    }

    /// The kinds and keys in what is to be written are such as are read.
    #[test]
    fn what_is_to_be_written_can_be_read() {
        let schema = crate::schema().to_string();
        let rules = || {
            KEYS.iter().chain(&KINDS).copied().flatten().flat_map(|(_, rules)| rules.iter()).chain(ANYWHERE)
        };
        for (words, here) in rules() {
            let Write(text) = here else { continue };
            for quoted in text.split('`').skip(1).step_by(2) {
                for word in quoted.split([' ', '{', '}', '[', ']', ',']).filter_map(|w| w.strip_suffix(':')) {
                    let is_key = word.chars().all(|c| c.is_ascii_lowercase() || c == '_') && !word.is_empty();
                    // `type` is what shouldn't be written, and a material is called red.
                    let is_free = ["type", "red"].contains(&word);
                    assert!(
                        !is_key || is_free || schema.contains(&format!("\"{word}\"")),
                        "{words}: `{word}` in {text}"
                    );
                }
            }
        }
    }
}
