//! Full-size comparison with the reference pictures, which another renderer made of the same scenes.
//!
//! They lie in the folder `shared` beside the project, or where `STRAAL_SHARED` says, under `reference`: `NAME/scene.xml`, the scene as that
//! renderer has it, which is read here; `NAME/mean.exr`, and `NAME/var.exr`, the variance of that mean from 16 seeds. What is particular in judging one stands
//! in `scenes/reference/judging.txt`.

use crate::{Failure, root};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;
use straal::compare::{Comparison, Estimate, Tails, compare};
use straal::{Control, Job, LoadOptions, Overrides};
use straal_formats::{Limits, image};
use straal_scene::Image;

/// Independently seeded pictures of each scene, so that its variance is measured.
const REPLICATES: u32 = 16;

/// Samples a pixel in each of a picture of [`PIXELS`], unless something else is said of its scene; more in a smaller one, so that it is judged as
/// sharply.
const SPP: usize = 16;
const PIXELS: usize = 256 * 256;

/// Renders the reference scenes, or those named, and compares; whether all agree.
pub fn run(names: &[String]) -> Result<bool, Failure> {
    let shared = std::env::var_os("STRAAL_SHARED").map_or_else(|| root().join("../shared"), PathBuf::from);
    let folder = shared.join("reference");
    if !folder.exists() {
        println!("skipped: no shared data ({})", folder.display());
        // Where the data must be, its absence is a failure.
        return Ok(std::env::var("CI").ok().as_deref() != Some("true"));
    }
    let sayings = sayings(&std::fs::read_to_string(root().join(SAYINGS))?)?;
    println!(
        "{:18} {:>8} {:>8} {:>8} {:>8} {:>10} {:>10} {:>9} {:>9} {:>7}  judged by",
        "scene", "mean %", "z red", "green", "blue", "relMSE", "median", "pixels >", "blocks >", "seconds"
    );
    let mut all_agree = true;
    for (name, scene) in listed(&folder, names)? {
        let started = Instant::now();
        let saying = sayings.get(&name).cloned().unwrap_or_default();
        if let Some(why) = &saying.not_yet {
            println!("{name:18} not judged: {why}");
            continue;
        }
        let beside = scene.parent().unwrap_or(Path::new(""));
        let rendered = match &saying.instead {
            Some((file, _)) => root().join(OWN).join(file),
            None => scene.clone(),
        };
        let (found, off) = judge(&rendered, beside, &saying)?;
        let told_only = saying.told_only.is_some();
        println!(
            "{name:18} {:>8.2} {:>8.2} {:>8.2} {:>8.2} {:>10.2e} {:>10.2e} {:>9} {:>9} {:>7.1}  {}{}",
            100.0 * off,
            found.mean_z[0],
            found.mean_z[1],
            found.mean_z[2],
            found.relmse.unwrap_or(found.relmse_biased),
            found.relmse_median,
            found.pixels.beyond,
            found.blocks.beyond,
            started.elapsed().as_secs_f64(),
            if saying.is_heavy { "mean and blocks" } else { "pixels and blocks" },
            match (found.differs, told_only) {
                (false, _) => "",
                (true, false) => ": DIFFERS",
                (true, true) => ": differs, on purpose",
            },
        );
        if let Some((file, why)) = &saying.instead {
            println!("    rendered: {file}: {why}");
        }
        for ([x0, y0, x1, y1], why) in &saying.without {
            println!("    not judged: columns {x0} to {x1}, rows {y0} to {y1}: {why}");
        }
        if let Some(why) = saying.told_only.as_ref().filter(|_| found.differs) {
            println!("    {why}");
        } else {
            found.reasons.iter().for_each(|reason| println!("    {reason}"));
        }
        let near = told_only || off.abs() <= MOST_OFF;
        if !near {
            println!("    the means of the pictures are {:.1} % apart", 100.0 * off);
        }
        all_agree &= told_only || !found.differs && near;
    }
    Ok(all_agree)
}

/// Where scenes of straal's own are, in place of others.
const OWN: &str = "scenes/reference";

/// Where the sayings are.
const SAYINGS: &str = "scenes/reference/judging.txt";

/// How far the means of two pictures may be apart.
const MOST_OFF: f64 = 0.02;

/// What is particular in judging a scene.
#[derive(Clone, Default)]
struct Saying {
    is_heavy: bool,
    spp: Option<usize>,
    within: Option<[usize; 4]>,
    /// Parts that are left out, each with the reason.
    without: Vec<([usize; 4], String)>,
    /// Why the two differ on purpose.
    told_only: Option<String>,
    /// A scene of [`OWN`] that is rendered in place of it, and why.
    instead: Option<(String, String)>,
    /// Why it isn't rendered.
    not_yet: Option<String>,
    spectral: bool,
}

/// Of lines `NAME: WHAT`, or `NAME: WHAT: REASON`.
fn sayings(text: &str) -> Result<BTreeMap<String, Saying>, Failure> {
    let mut all: BTreeMap<String, Saying> = BTreeMap::new();
    for line in text.lines().filter(|l| !l.trim().is_empty() && !l.starts_with('#')) {
        let wrong = || format!("{SAYINGS}: not understood: {line}");
        let (name, said) = line.split_once(": ").ok_or_else(wrong)?;
        let saying = all.entry(name.to_owned()).or_default();
        let (what, why) = said.split_once(": ").unwrap_or((said, ""));
        match what.split_once(' ') {
            Some(("heavy", "tails")) => saying.is_heavy = true,
            Some((n, "samples")) => saying.spp = Some(n.parse()?),
            Some(("within", place)) => saying.within = Some(part(place).ok_or_else(wrong)?),
            Some(("without", place)) if !why.is_empty() => {
                saying.without.push((part(place).ok_or_else(wrong)?, why.to_owned()));
            }
            Some(("told", "only")) if !why.is_empty() => saying.told_only = Some(why.to_owned()),
            Some(("instead", file)) if !why.is_empty() => {
                saying.instead = Some((file.to_owned(), why.to_owned()))
            }
            Some(("not", "yet")) if !why.is_empty() => saying.not_yet = Some(why.to_owned()),
            None if what == "spectral" => saying.spectral = true,
            _ => return Err(wrong().into()),
        }
    }
    Ok(all)
}

/// The scenes there are, or those named: that of each folder, and further ones of the same picture as `NAME-WAY`.
fn listed(folder: &Path, names: &[String]) -> Result<Vec<(String, PathBuf)>, Failure> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let Ok(name) = entry.file_name().into_string() else { continue };
        for file in std::fs::read_dir(entry.path()).into_iter().flatten() {
            let path = file?.path();
            let file = path.file_name().and_then(|f| f.to_str()).unwrap_or_default();
            if let Some(way) = file.strip_prefix("scene").and_then(|f| f.strip_suffix(".xml")) {
                all.push((format!("{name}{way}"), path));
            }
        }
    }
    all.sort();
    if let Some(unknown) = names.iter().find(|name| all.iter().all(|(known, _)| known != *name)) {
        return Err(format!("there is no reference scene `{unknown}`").into());
    }
    all.retain(|(name, _)| names.is_empty() || names.contains(name));
    Ok(all)
}

/// A part of the picture, `X0,Y0,X1,Y1`, the ends exclusive.
fn part(text: &str) -> Option<[usize; 4]> {
    let numbers: Vec<usize> = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
    numbers.try_into().ok()
}

fn cut(image: &Image, within: Option<[usize; 4]>) -> Image {
    let [x0, y0, x1, y1] = within.unwrap_or([0, 0, usize::MAX, usize::MAX]);
    let (x1, y1) = (x1.min(image.width), y1.min(image.height));
    let rows = (y0.min(y1)..y1).map(|y| y * image.width);
    let pixels = rows.flat_map(|row| image.pixels[row + x0.min(x1)..row + x1].iter().copied()).collect();
    Image { width: x1.saturating_sub(x0), height: y1.saturating_sub(y0), pixels }
}

/// Renders a scene and compares it, or a part of it, with the picture in a folder; by how much the means of the two are apart.
fn judge(scene: &Path, reference: &Path, saying: &Saying) -> Result<(Comparison, f64), Failure> {
    let loaded = straal::load(scene, &LoadOptions::default())
        .map_err(|_| format!("the scene is wrong; see `straal check {}`", scene.display()))?;
    let (their_mean, mut their_variance) =
        (read(&reference.join("mean.exr"))?, read(&reference.join("var.exr"))?);
    let size = [u32::try_from(their_mean.width)?, u32::try_from(their_mean.height)?];
    let spp = saying.spp.unwrap_or(SPP);
    let spp = u32::try_from(spp.max(spp * PIXELS / their_mean.pixels.len().max(1)))?;
    let spectral = saying.spectral.then_some(true);
    let job =
        Job::new(loaded, Overrides { spp: Some(spp), size: Some(size), spectral, ..Overrides::default() })?;
    let ours = job.render_replicates(REPLICATES, &mut Control::to_the_end())?.picture.layers;
    let picture = |pixels| Image { width: ours.width, height: ours.height, pixels };
    // A picture without samples of its own has the error alone.
    let error = ours.error.as_ref().filter(|_| ours.variance.is_empty());
    let spread = error.map(|error| error.rgb.iter().map(|e| e.map(|e| e * e)).collect());
    let (mut mean, mut variance) =
        (picture(ours.rgb.clone()), picture(spread.unwrap_or_else(|| ours.variance.clone())));
    for i in 0..their_mean.pixels.len() {
        let (x, y) = (i % their_mean.width, i / their_mean.width);
        if saying.without.iter().any(|([x0, y0, x1, y1], _)| (x0..x1).contains(&&x) && (y0..y1).contains(&&y))
        {
            // As if both were sure of the same.
            mean.pixels[i] = their_mean.pixels[i];
            (variance.pixels[i], their_variance.pixels[i]) = ([0.0; 3], [0.0; 3]);
        }
    }
    let [mean, variance, their_mean, their_variance] =
        [&mean, &variance, &their_mean, &their_variance].map(|image| cut(image, saying.within));
    let a = Estimate { dof: f64::from(REPLICATES - 1), ..Estimate::new(&mean, Some(&variance)) };
    let tails = if saying.is_heavy { Tails::Heavy } else { Tails::Light };
    let found = compare(a, Estimate::new(&their_mean, Some(&their_variance)), tails)?;
    Ok((found, sum(&mean) / sum(&their_mean) - 1.0))
}

/// All numbers of a picture.
fn sum(image: &Image) -> f64 {
    image.pixels.as_flattened().iter().map(|v| f64::from(*v)).sum()
}

fn read(path: &Path) -> Result<Image, Failure> {
    let bytes = std::fs::read(path).map_err(|e| format!("can't read {}: {e}", path.display()))?;
    image::read(&bytes, &Limits::default()).map_err(|e| format!("can't read {}: {e}", path.display()).into())
}
