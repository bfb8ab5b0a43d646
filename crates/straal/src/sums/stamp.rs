//! The header of a file of sums: what it tells of the render that it comes from.

use crate::development::Development;
use crate::resolve::MAX_PIXELS;
use straal_color::spectrum::Bands;
use straal_render::film::Region;
use straal_render::film::{CLAMPED, ErrorEstimate, Held, MAX_SAMPLES, Span};
use straal_scene::desc::{LightGroup, MOST_LIGHT_GROUPS};

/// What a file of sums tells of the render that it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Stamp {
    /// What pictures of that render tell of themselves, but for what came of it.
    pub metadata: Vec<(String, String)>,
    /// What else decides the bits of its sums.
    pub also: Vec<(String, String)>,
    /// How the scene wants its picture developed.
    pub development: Development,
    /// Size of the whole picture.
    pub size: [u32; 2],
    /// Which samples, and of which part of the picture.
    pub span: Span,
    /// Samples of each pixel in all, where that was said.
    pub whole: Option<u32>,
    /// By what noise is told, if it is.
    pub error: Option<ErrorEstimate>,
    /// What there is of each pixel.
    pub held: Held,
    /// Whether some tiles have more samples than the span says: it was written in the middle of a pass.
    pub is_midway: bool,
    /// The first sample that was dropped: pixel and index.
    pub dropped: Option<([u32; 2], u32)>,
}

impl std::fmt::Display for Stamp {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (kind, list) in [("story", &self.metadata), ("also", &self.also)] {
            for (key, value) in list {
                writeln!(f, "{kind} {key} {}", value.replace('\n', " "))?;
            }
        }
        let region = |r: Region| format!("{} {} {} {}", r.min[0], r.min[1], r.max[0], r.max[1]);
        writeln!(f, "look {}", self.development)?;
        writeln!(f, "size {} {}", self.size[0], self.size[1])?;
        writeln!(f, "crop {}", region(self.span.crop))?;
        writeln!(f, "region {}", region(self.span.region))?;
        writeln!(f, "samples {} {}", self.span.first, self.span.end)?;
        if let Some(whole) = self.whole {
            writeln!(f, "whole {whole}")?;
        }
        if let Some(error) = self.error {
            writeln!(f, "error {}", error.name())?;
        }
        if let Some(timed) = self.held.costs {
            writeln!(f, "costs {}", if timed { "tests_and_time" } else { "tests" })?;
        }
        if let Some(bands) = self.held.bands {
            let [from, to] = bands.ends();
            writeln!(f, "bands {from} {to} {}", bands.count())?;
        }
        if !self.held.light_groups.is_empty() {
            writeln!(f, "light_groups {}", self.held.light_groups.join(" "))?;
        }
        if !self.held.mean_squares.is_empty() {
            let numbers: Vec<String> = self.held.mean_squares.iter().map(f64::to_string).collect();
            writeln!(f, "mean_squares {}", numbers.join(" "))?;
        }
        if let Some(weight) = self.held.weight {
            writeln!(f, "weight {weight}")?;
        }
        let held = &self.held;
        for (key, is_held) in [
            ("splats", held.splats),
            ("batches", held.batches),
            ("squares", held.squares),
            ("guides", held.guides),
            ("light_splats", held.light_splats),
            ("halves", held.halves),
            ("midway", self.is_midway),
        ] {
            if is_held {
                writeln!(f, "{key} yes")?;
            }
        }
        if let Some(([x, y], index)) = self.dropped {
            writeln!(f, "dropped {x} {y} {index}")?;
        }
        writeln!(f, "record {}", self.held.names(self.span.first))
    }
}

impl Stamp {
    /// What a header says; `None` where it isn't one that this version writes.
    pub(super) fn read(text: &str) -> Option<Self> {
        let [mut metadata, mut also] = [Vec::new(), Vec::new()];
        let mut facts = Vec::new();
        for line in text.lines() {
            let (key, value) = line.split_once(' ')?;
            let list = match key {
                "story" => &mut metadata,
                "also" => &mut also,
                _ => {
                    facts.push((key, value));
                    continue;
                }
            };
            let (key, value) = value.split_once(' ')?;
            list.push((key.to_owned(), value.to_owned()));
        }
        let fact = |wanted: &str| facts.iter().find(|(key, _)| *key == wanted).map(|(_, value)| *value);
        // A fact that is there and can't be read is an error; one that isn't there may be none.
        let numbers = |key: &str| -> Option<Option<Vec<u32>>> {
            let Some(value) = fact(key) else { return Some(None) };
            value.split(' ').map(|n| n.parse().ok()).collect::<Option<Vec<u32>>>().map(Some)
        };
        let region = |key: &str| match numbers(key)?.as_deref() {
            Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Some(Region { min: [x0, y0], max: [x1, y1] }),
            _ => None,
        };
        let &[width, height] = numbers("size")??.as_slice() else { return None };
        let &[first, end] = numbers("samples")??.as_slice() else { return None };
        let span = Span { crop: region("crop")?, region: region("region")?, first, end };
        let inside = |a: Region, b: Region| a.intersection(b) == a;
        let whole_picture = Region::whole([width, height]);
        let is_sound = inside(span.crop, span.region)
            && inside(span.region, whole_picture)
            && first <= end
            && end <= MAX_SAMPLES
            && span.region.area() <= MAX_PIXELS;
        let bands = match fact("bands") {
            None => None,
            Some(value) => match *value.split(' ').collect::<Vec<_>>() {
                [from, to, count] => {
                    Some(Bands::new(from.parse().ok()?, to.parse().ok()?, count.parse().ok()?)?)
                }
                _ => return None,
            },
        };
        let light_groups: Vec<String> =
            fact("light_groups").map_or_else(Vec::new, |names| names.split(' ').map(str::to_owned).collect());
        if light_groups.len() > MOST_LIGHT_GROUPS + 2
            || light_groups.iter().any(|name| name != CLAMPED && LightGroup::complaint(name).is_some())
        {
            return None;
        }
        let mean_squares: Vec<f64> = match fact("mean_squares") {
            None => Vec::new(),
            Some(value) => value.split(' ').map(|n| n.parse().ok()).collect::<Option<_>>()?,
        };
        // Filters reach 16 pixels at most.
        if mean_squares.len() > 17 || mean_squares.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let held = Held {
            costs: fact("costs").map(|c| c == "tests_and_time"),
            bands,
            light_groups,
            splats: fact("splats").is_some(),
            batches: fact("batches").is_some(),
            squares: fact("squares").is_some(),
            guides: fact("guides").is_some(),
            light_splats: fact("light_splats").is_some(),
            weight: match fact("weight") {
                None => None,
                Some(value) => Some(value.parse().ok().filter(|w: &f64| w.is_finite() && *w >= 1.0)?),
            },
            halves: fact("halves").is_some(),
            mean_squares,
        };
        let error = match fact("error") {
            None => None,
            Some(name) => {
                Some([ErrorEstimate::Spread, ErrorEstimate::Batches].into_iter().find(|e| e.name() == name)?)
            }
        };
        let whole = match numbers("whole")?.as_deref() {
            None => None,
            Some(&[whole]) => Some(whole),
            Some(_) => return None,
        };
        let dropped = match numbers("dropped")?.as_deref() {
            None => None,
            Some(&[x, y, index]) => Some(([x, y], index)),
            Some(_) => return None,
        };
        let development = fact("look")?.parse().ok()?;
        let is_midway = fact("midway").is_some();
        let stamp = Self {
            metadata,
            also,
            development,
            size: [width, height],
            span,
            whole,
            error,
            held,
            is_midway,
            dropped,
        };
        (is_sound && fact("record") == Some(stamp.held.names(first).as_str())).then_some(stamp)
    }

    /// What a key of the metadata says.
    pub(super) fn tells(&self, key: &str) -> Option<&str> {
        self.metadata.iter().find(|(k, _)| k.strip_prefix("straal.") == Some(key)).map(|(_, v)| v.as_str())
    }

    /// In what two renders differ that must be alike: each as 'seed 1 there and 2 here'. `except` needn't.
    pub(crate) fn differences(&self, other: &Self, except: &[&str]) -> Vec<String> {
        let of = |stamp: &Self| -> Vec<(String, String)> {
            let short = |k: &str| k.strip_prefix("straal.").unwrap_or(k).replace('_', " ");
            let all = stamp.metadata.iter().chain(&stamp.also).map(|(k, v)| (short(k), v.clone()));
            all.filter(|(k, _)| !except.contains(&k.as_str())).collect()
        };
        let (there, here) = (of(self), of(other));
        let find = |list: &[(String, String)], key: &str| {
            list.iter().find(|(k, _)| k == key).map_or("none".to_owned(), |(_, v)| v.clone())
        };
        let mut keys: Vec<&String> = there.iter().chain(&here).map(|(k, _)| k).collect();
        keys.dedup();
        let mut told = Vec::new();
        for key in keys {
            let (a, b) = (find(&there, key), find(&here, key));
            let line = format!("{key} {a} there and {b} here");
            if a != b && !told.contains(&line) {
                told.push(line);
            }
        }
        if told.is_empty() && self.held != other.held {
            told.push("other layers there than here".into());
        }
        told
    }
}
