//! Pictures put together from files of sums.

use super::{Kept, Stamp, SumsError};
use crate::development::Development;
use crate::picture::Picture;
use crate::resolve::passes;
use std::path::Path;
use straal_color::Space;
use straal_color::spectrum::Bands;
use straal_render::film::Region;
use straal_render::film::{Held, Joined, Span, hash_of};
use straal_scene::memory::{PROGRAM, Shortage};

/// Pictures put together from files of sums.
#[derive(Debug)]
pub struct Merged {
    /// The picture.
    pub picture: Picture,
    /// How the scene wants it developed.
    pub development: Development,
    /// Samples of each pixel.
    pub samples: u32,
    /// What is missing, where that was allowed.
    pub gaps: Vec<String>,
}

/// What is no error when files of sums are put together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Allowed {
    /// That samples are in none of them.
    pub gaps: bool,
    /// How many bytes of memory are taken, if there is a limit.
    pub memory: Option<u64>,
}

/// Puts files of sums together, in whatever order they are given. Samples that several of them have are an error, and so are
/// samples that none has, unless that is allowed.
pub fn merge(mut parts: Vec<Kept>, allowed: Allowed) -> Result<Merged, SumsError> {
    parts.sort_by_key(|p| (p.stamp.span.crop.min[1], p.stamp.span.crop.min[0], p.stamp.span.first));
    let Some(first) = parts.first() else { return Err(SumsError::Parts("no sums to merge".into())) };
    let stamp = first.stamp.clone();
    for part in &parts[1..] {
        let differences = first.stamp.differences(&part.stamp, &["first sample", "crop"]);
        if !differences.is_empty() {
            let [a, b] = [first, part].map(|p| p.path.display().to_string());
            let differences: Vec<String> = differences
                .iter()
                .map(|d| {
                    d.replace(" there and ", &format!(" in {a}, ")).replace(" here", &format!(" in {b}"))
                })
                .collect();
            return Err(SumsError::Parts(format!(
                "{a} and {b} aren't parts of one picture: {}",
                differences.join("; ")
            )));
        }
    }
    if let Some(midway) = parts.iter().find(|p| p.stamp.is_midway && parts.len() > 1) {
        return Err(SumsError::Parts(format!(
            "{} was written in the middle of a pass, so that some pixels have more samples than others: by itself it makes a \
             picture, and `straal render --resume` goes on from it",
            midway.path.display()
        )));
    }
    let (crop, end) = frame(&parts)?;
    let whole = parts.iter().filter_map(|p| p.stamp.whole).max().unwrap_or(end).max(end);
    let missing = missing(&parts, whole);
    if !missing.is_empty() && !allowed.gaps {
        return Err(SumsError::Gaps(missing.join("; ")));
    }
    if stamp.tells("noise").is_some() && parts.iter().any(|p| p.stamp.span.first != 0) {
        return Err(SumsError::Parts("parts of an adaptive render are crops, not runs of samples".into()));
    }
    let region = parts.iter().map(|p| p.stamp.span.region).reduce(cover).unwrap_or(crop);
    check_memory(&stamp, [crop, region], allowed.memory)?;
    let mut joined = Joined::new(stamp.size, [crop, region], &stamp.held, stamp.error);
    let mut groups: Vec<Region> = Vec::new();
    for part in &mut parts {
        let span = part.stamp.span;
        if groups.last() != Some(&span.crop) {
            groups.push(span.crop);
        }
        let group = groups.len() as u32;
        part.sums(|stamp, input| joined.add(&span, group, input, stamp.dropped))?;
    }
    if !missing.is_empty() {
        joined.has_gaps();
    }
    let film = joined.into_film();
    let samples = of_first_crop(&parts);
    let space = stamp.tells("space").and_then(Space::named).unwrap_or_default();
    let space = match stamp.tells("channels") {
        Some("xyz") => straal_color::RgbSpace::XYZ,
        _ => space.rgb(),
    };
    let mut picture = Picture::new(&film, film.layers(), space);
    picture.metadata = stamp.metadata.clone();
    let place = picture.metadata.iter().position(|(k, _)| k == "straal.crop");
    if let Some((_, value)) = place.and_then(|i| picture.metadata.get_mut(i)) {
        *value = format!("{},{},{},{}", crop.min[0], crop.min[1], crop.max[0], crop.max[1]);
    }
    picture.metadata.retain(|(k, _)| k != "straal.first_sample");
    picture.metadata.push(("straal.samples".into(), samples.to_string()));
    picture.metadata.push(("straal.passes".into(), passes(samples).to_string()));
    picture.metadata.push(("straal.film_hash".into(), hash_of(&picture.layers.rgb)));
    Ok(Merged { picture, development: stamp.development, samples, gaps: missing })
}

/// Whether the film and its layers can be held.
fn check_memory(stamp: &Stamp, [crop, region]: [Region; 2], limit: Option<u64>) -> Result<(), SumsError> {
    let Held { costs, bands, guides, light_groups, .. } = &stamp.held;
    // Numbers of a pixel in all layers: of light, its variance and the guides, the error, costs and bands.
    let layers = 3
        + if *guides { 3 + 3 + 3 + 1 + 1 } else { 0 }
        + if stamp.error.is_some() { 3 } else { 0 }
        + if costs.is_some() { 3 } else { 0 }
        + bands.as_ref().map_or(0, Bands::count)
        + 3 * light_groups.len();
    // Records lie aligned in memory, and it is known where each came from.
    let film = (stamp.held.bytes_a_pixel(0) + 16) as u64 * region.area() as u64;
    let needs = PROGRAM + film + 4 * layers as u64 * crop.area() as u64;
    match limit {
        Some(limit) if needs > limit => Err(SumsError::Memory(Shortage {
            what: "the picture that is put together".into(),
            needs,
            most: Some(("the film", film)),
            limit,
            help: "merge fewer crops at a time",
        })),
        _ => Ok(()),
    }
}

/// Samples of each pixel of the first crop; with noise, of those that have the most in any.
fn of_first_crop(parts: &[Kept]) -> u32 {
    let of = |crop: Region| parts.iter().filter(|p| p.stamp.span.crop == crop).map(Kept::samples).sum();
    parts.iter().map(|p| of(p.stamp.span.crop)).max().unwrap_or(0)
}

fn cover(a: Region, b: Region) -> Region {
    let pick = |f: fn(u32, u32) -> u32, a: [u32; 2], b: [u32; 2]| [f(a[0], b[0]), f(a[1], b[1])];
    Region { min: pick(Ord::min, a.min, b.min), max: pick(Ord::max, a.max, b.max) }
}

/// The rectangle that all crops make together, and the greatest end of samples.
fn frame(parts: &[Kept]) -> Result<(Region, u32), SumsError> {
    let mut crops: Vec<(Region, &Path)> = Vec::new();
    for part in parts {
        let (crop, path) = (part.stamp.span.crop, part.path.as_path());
        if crops.iter().any(|(c, _)| *c == crop) {
            continue;
        }
        let twin = crops.iter().find(|(c, _)| {
            let both = c.intersection(crop);
            both.width() > 0 && both.height() > 0
        });
        if let Some((_, other)) = twin {
            let (a, b) = (other.display(), path.display());
            return Err(SumsError::Parts(format!("the crops of {a} and {b} overlap")));
        }
        crops.push((crop, path));
    }
    let all = crops.iter().map(|(c, _)| *c).reduce(cover).unwrap_or(Region::whole([0, 0]));
    let covered: usize = crops.iter().map(|(c, _)| c.area()).sum();
    if covered != all.area() {
        return Err(SumsError::Parts(format!(
            "the crops leave {} pixels between them empty: together they must be a rectangle",
            all.area() - covered
        )));
    }
    let end = parts.iter().map(|p| p.stamp.span.end).max().unwrap_or(0);
    for (i, a) in parts.iter().enumerate() {
        for b in parts[i + 1..].iter().filter(|b| b.stamp.span.crop == a.stamp.span.crop) {
            let [sa, sb] = [a, b].map(|p| p.stamp.span);
            if sa.first.max(sb.first) < sa.end.min(sb.end) {
                return Err(SumsError::Parts(format!(
                    "samples {}..{} are in {} and in {}: no sample may count twice",
                    sa.first.max(sb.first),
                    sa.end.min(sb.end),
                    a.path.display(),
                    b.path.display()
                )));
            }
        }
    }
    Ok((all, end))
}

/// The samples that no part has, crop by crop. The parts are in order.
fn missing(parts: &[Kept], whole: u32) -> Vec<String> {
    let mut told = Vec::new();
    let adapts = parts.iter().any(|p| p.stamp.tells("noise").is_some());
    let mut tell = |range: std::ops::Range<u32>, crop: Region| {
        if !range.is_empty() {
            let [x0, y0] = crop.min;
            let [x1, y1] = crop.max;
            told.push(format!(
                "samples {}..{} of the crop {x0},{y0},{x1},{y1} are in none of the files",
                range.start, range.end
            ));
        }
    };
    let mut at = 0;
    for (i, part) in parts.iter().enumerate() {
        let Span { crop, first, end, .. } = part.stamp.span;
        tell(at..first, crop);
        at = end;
        if parts.get(i + 1).is_none_or(|next| next.stamp.span.crop != crop) {
            // Noise ends crops at other numbers of samples.
            if !adapts {
                tell(at..whole, crop);
            }
            at = 0;
        }
    }
    told
}
