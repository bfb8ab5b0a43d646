//! Search structures as people name them: from the scene's description, and from one word of a command line.

use straal_accel::{
    self as accel, BspChoice, BspParams, Bvh2Params, BvhParams, GridParams, KdParams, OctreeParams,
    VolumesParams,
};
use straal_formats::yaml;
use straal_scene::decode::{Decoder, Describe, Strictness};
use straal_scene::desc;
use straal_scene::limit::Limit;
use straal_scene::tree::{Datum, Entry, Tree};
use straal_scene::{Diagnostic, Diagnostics, Span, Spanned, suggest};

/// The names of all kinds.
pub const NAMES: &[&str] = desc::Structure::KINDS;

/// Why a text names no search structure.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoStructure(String);

/// The structure that a text names: a kind, and where others than the defaults are wanted, its parameters, such as
/// `bvh:build=fast,compact=true`. Names, limits and defaults are those of the scene language.
///
/// ```
/// let fast = straal::search::parse("bvh:build=fast")?;
/// assert_eq!(fast.name(), "bvh");
/// let error = straal::search::parse("bvh:biuld=fast").unwrap_err();
/// assert_eq!(error.to_string(), "unknown key `biuld` in `bvh`: did you mean `build`?");
/// # Ok::<(), straal::search::NoStructure>(())
/// ```
pub fn parse(text: &str) -> Result<accel::Structure, NoStructure> {
    let mut diagnostics = Diagnostics::default();
    let file = diagnostics.sources.add("", text);
    let end = u32::try_from(text.len()).map_err(|_| NoStructure("this is too long".into()))?;
    let span = Span { file, start: 0, end };
    let tree = tree(text, span).map_err(NoStructure)?;
    let mut d = Decoder::new(diagnostics, Strictness::default());
    let structure = d.under("accel", span, |d| desc::Structure::read(&tree, Limit::FINITE, d));
    if d.diagnostics.has_errors() {
        let told: Vec<String> = d.diagnostics.list.iter().map(tell).collect();
        return Err(NoStructure(told.join("; ")));
    }
    Ok(structure_of(&structure))
}

fn tell(d: &Diagnostic) -> String {
    match &d.help {
        Some(help) => format!("{}: {help}", d.message),
        None => d.message.clone(),
    }
}

/// `kind:key=value,key=value` as a scene would say it. All of it is at `span`.
fn tree(text: &str, span: Span) -> Result<Tree, String> {
    let word = |word: &str| Spanned::new(word.to_owned(), span);
    let Some((kind, rest)) = text.split_once(':') else {
        return Ok(Tree { value: Datum::String(text.to_owned()), span });
    };
    let mut entries: Vec<Entry> = Vec::new();
    if rest.trim().is_empty() {
        return Err("nothing follows the colon: expected key=value, with commas between".into());
    }
    for part in rest.split(',') {
        if part.trim().is_empty() {
            return Err("there is a comma too many: expected key=value, with commas between".into());
        }
        let Some((key, value)) = part.split_once('=') else {
            return Err(format!(
                "`{}` is no parameter: expected key=value, with commas between",
                suggest::brief(part.trim())
            ));
        };
        let (key, value) = (key.trim(), value.trim());
        if entries.iter().any(|e| e.key.value == key) {
            return Err(format!("`{}` is given twice", suggest::brief(key)));
        }
        entries.push(Entry { key: word(key), value: Tree { value: yaml::resolve(value.to_owned()), span } });
    }
    let payload = Tree { value: Datum::Mapping(entries), span };
    let choice = Entry { key: word(kind.trim()), value: payload };
    Ok(Tree { value: Datum::Mapping(vec![choice]), span })
}

/// The structure that a scene describes.
pub fn structure_of(d: &desc::Structure) -> accel::Structure {
    match d {
        desc::Structure::Brute => accel::Structure::Brute,
        desc::Structure::Bvh(p) => {
            let build = match p.build {
                desc::Build::Fast => accel::Build::Fast,
                desc::Build::Default => accel::Build::Default,
                desc::Build::Best => accel::Build::Best,
            };
            accel::Structure::Bvh(BvhParams { build, compact: p.compact })
        }
        desc::Structure::Volumes(p) => {
            let volume = match p.volume {
                desc::VolumeKind::Sphere => accel::VolumeKind::Sphere,
                desc::VolumeKind::Box => accel::VolumeKind::Box,
                desc::VolumeKind::Oriented => accel::VolumeKind::Oriented,
            };
            accel::Structure::Volumes(VolumesParams {
                volume,
                traversal_cost: p.traversal_cost,
                intersection_cost: p.intersection_cost,
            })
        }
        desc::Structure::Bvh2(p) => {
            let split = match p.split {
                desc::Split::Median => accel::Split::Median,
                desc::Split::Middle => accel::Split::Middle,
                desc::Split::Sah => accel::Split::Sah,
                desc::Split::Agglomerative => accel::Split::Agglomerative,
            };
            accel::Structure::Bvh2(Bvh2Params {
                split,
                leaf_size: p.leaf_size,
                traversal_cost: p.traversal_cost,
                intersection_cost: p.intersection_cost,
            })
        }
        desc::Structure::Grid(p) => accel::Structure::Grid(GridParams {
            factor: p.factor,
            mailboxes: p.mailboxes,
            max_cells: p.max_cells,
            traversal_cost: p.traversal_cost,
            intersection_cost: p.intersection_cost,
        }),
        desc::Structure::Kd(p) => accel::Structure::Kd(KdParams {
            traversal_cost: p.traversal_cost,
            intersection_cost: p.intersection_cost,
            empty_bonus: p.empty_bonus,
            max_depth: p.max_depth,
            leaf_size: p.leaf_size,
            clip: p.clip,
            mailboxes: p.mailboxes,
        }),
        desc::Structure::Octree(p) => accel::Structure::Octree(OctreeParams {
            max_depth: p.max_depth,
            leaf_size: p.leaf_size,
            mailboxes: p.mailboxes,
            traversal_cost: p.traversal_cost,
            intersection_cost: p.intersection_cost,
        }),
        desc::Structure::Bsp(p) => accel::Structure::Bsp(BspParams {
            choice: match p.choice {
                desc::PlaneChoice::Even => BspChoice::Even,
                desc::PlaneChoice::Sah => BspChoice::Sah,
            },
            candidates: p.candidates,
            leaf_size: p.leaf_size,
            max_depth: p.max_depth,
            straddle_cost: p.straddle_cost,
            mailboxes: p.mailboxes,
            traversal_cost: p.traversal_cost,
            intersection_cost: p.intersection_cost,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use accel::{Build, Structure};

    #[test]
    fn kinds_have_the_same_names_and_defaults_everywhere() {
        assert_eq!(NAMES.len(), Structure::ALL.len());
        for s in Structure::ALL {
            assert!(NAMES.contains(&s.name()), "{s}");
            assert_eq!(parse(s.name()), Ok(s));
        }
        assert_eq!(structure_of(&desc::Accel::default().structure), Structure::default());
    }

    #[test]
    fn parameters_follow_the_name() {
        let best = Structure::Bvh(BvhParams { build: Build::Best, compact: true });
        assert_eq!(parse("bvh:build=best,compact=true"), Ok(best));
        let grid = GridParams { factor: 4.0, mailboxes: false, ..GridParams::DEFAULT };
        assert_eq!(parse("grid:factor=4,mailboxes=false"), Ok(Structure::Grid(grid)));
        assert_eq!(parse(" bvh : compact = true , build = best "), Ok(best));
        let kd = KdParams { traversal_cost: 1.5, max_depth: 20, ..KdParams::DEFAULT };
        assert_eq!(parse("kd:traversal_cost=1.5,max_depth=20"), Ok(Structure::Kd(kd)));
        let bsp = BspParams { choice: BspChoice::Sah, straddle_cost: 0.0, ..BspParams::DEFAULT };
        assert_eq!(parse("bsp:choice=sah,straddle_cost=0"), Ok(Structure::Bsp(bsp)));
    }

    #[test]
    fn what_is_wrong_is_told_in_the_words_of_the_scene_language() {
        for (text, complaint) in [
            ("bhv", "unknown `bhv` in `accel`: did you mean `bvh`?"),
            (
                "brute:build=fast",
                "`brute` takes nothing, found a mapping of keys to values: write only `brute`",
            ),
            ("bvh:build=quick", "unknown `quick` in `build`: it can be `fast`, `default`, `best`"),
            ("bvh:compact=yes", "`compact` must be `true` or `false`, found the text `yes`: write `true`"),
            ("octree:max_depth=25", "`max_depth` must be from 0 to 24, found 25"),
            ("bvh:compact", "`compact` is no parameter: expected key=value, with commas between"),
            ("bvh:", "nothing follows the colon: expected key=value, with commas between"),
            ("bvh:compact=true,", "there is a comma too many: expected key=value, with commas between"),
            ("bsp:straddle_cost=-1", "`straddle_cost` must be from 0 to 1,000,000, found -1"),
            ("grid:factor=-1", "`factor` must be between 0 and 64, neither included, found -1"),
            ("bvh:compact=true,compact=false", "`compact` is given twice"),
        ] {
            assert_eq!(parse(text).unwrap_err().to_string(), complaint);
        }
        assert!(parse("").unwrap_err().to_string().contains("`bvh`"));
    }
}
