//! Full-size comparison with the reference pictures, which another renderer made of the same scenes.
//!
//! They lie in the folder `shared` beside the project, or where `STRAAL_SHARED` says, under `reference`: `NAME/mean.exr`, and
//! `NAME/var.exr`, the variance of that mean from 16 seeds.

use crate::{Failure, root, scenes};
use std::path::{Path, PathBuf};
use std::time::Instant;
use straal::compare::{Comparison, Estimate, Tails, compare};
use straal::{Control, Job, LoadOptions, Overrides};
use straal_formats::{Limits, image};
use straal_scene::Image;

/// Independently seeded pictures of each scene, so that its variance is measured.
const REPLICATES: u32 = 16;

/// Samples a pixel in each of a picture of [`PIXELS`], unless its scene says `# judge: 64 samples` or the like; more in a smaller one, so
/// that it is judged as sharply.
const SPP: usize = 16;
const PIXELS: usize = 256 * 256;

/// Renders the scenes of `scenes/reference`, or those named, and compares; whether all agree. A scene may say `# judge: within X0,Y0,X1,Y1`, beyond
/// which the other renderer is wrong, `# judge: without X0,Y0,X1,Y1: reason`, which leaves a part out and is told, or `# judge: told only`, where the two do
/// on purpose what isn't the same; it says why as well.
pub fn run(names: &[String]) -> Result<bool, Failure> {
    let shared = std::env::var_os("STRAAL_SHARED").map_or_else(|| root().join("../shared"), PathBuf::from);
    let folder = shared.join("reference");
    if !folder.exists() {
        println!("skipped: no shared data ({})", folder.display());
        // Where the data must be, its absence is a failure.
        return Ok(std::env::var("CI").ok().as_deref() != Some("true"));
    }
    println!(
        "{:18} {:>8} {:>8} {:>8} {:>10} {:>10} {:>9} {:>9} {:>7}  judged by",
        "scene", "z red", "green", "blue", "relMSE", "median", "pixels >", "blocks >", "seconds"
    );
    let mut all_agree = true;
    for (name, path) in scenes("scenes/reference", names)? {
        let started = Instant::now();
        let text = std::fs::read_to_string(&path)?;
        let heavy = text.lines().any(|l| l == "# judge: heavy tails");
        let said =
            text.lines().find_map(|l| l.strip_prefix("# judge: ")?.strip_suffix(" samples")?.parse().ok());
        let within = text.lines().find_map(|l| part(l.strip_prefix("# judge: within ")?));
        let told_only = text.lines().any(|l| l.starts_with("# judge: told only"));
        let tails = if heavy { Tails::Heavy } else { Tails::Light };
        let mut without = Vec::new();
        for said in text.lines().filter_map(|l| l.strip_prefix("# judge: without ")) {
            let read = || said.split_once(": ").and_then(|(place, why)| Some((part(place)?, why)));
            without.push(read().ok_or_else(|| format!("{name}: not 'without X0,Y0,X1,Y1: reason': {said}"))?);
        }
        let places: Vec<_> = without.iter().map(|(place, _)| *place).collect();
        let judged = Judged { spp: said.unwrap_or(SPP), tails, within, without: &places };
        let found = judge(&path, &folder.join(&name), &judged)?;
        println!(
            "{name:18} {:>8.2} {:>8.2} {:>8.2} {:>10.2e} {:>10.2e} {:>9} {:>9} {:>7.1}  {}{}",
            found.mean_z[0],
            found.mean_z[1],
            found.mean_z[2],
            found.relmse.unwrap_or(found.relmse_biased),
            found.relmse_median,
            found.pixels.beyond,
            found.blocks.beyond,
            started.elapsed().as_secs_f64(),
            if heavy { "mean and blocks" } else { "pixels and blocks" },
            match (found.differs, told_only) {
                (false, _) => "",
                (true, false) => ": DIFFERS",
                (true, true) => ": differs, as the scene says why",
            },
        );
        for ([x0, y0, x1, y1], why) in &without {
            println!("    not judged: columns {x0} to {x1}, rows {y0} to {y1}: {why}");
        }
        if !told_only {
            found.reasons.iter().for_each(|reason| println!("    {reason}"));
        }
        all_agree &= !found.differs || told_only;
    }
    Ok(all_agree)
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

/// Which part of a picture is judged, and how.
struct Judged<'a> {
    spp: usize,
    tails: Tails,
    within: Option<[usize; 4]>,
    /// Parts of that which are left out.
    without: &'a [[usize; 4]],
}

/// Renders a scene and compares it, or a part of it, with the picture in a folder.
fn judge(scene: &Path, reference: &Path, judged: &Judged<'_>) -> Result<Comparison, Failure> {
    let &Judged { spp, tails, within, without } = judged;
    let loaded = straal::load(scene, &LoadOptions::default())
        .map_err(|_| format!("the scene is wrong; see `straal check {}`", scene.display()))?;
    let (their_mean, mut their_variance) =
        (read(&reference.join("mean.exr"))?, read(&reference.join("var.exr"))?);
    let size = [u32::try_from(their_mean.width)?, u32::try_from(their_mean.height)?];
    let spp = u32::try_from(spp.max(spp * PIXELS / their_mean.pixels.len().max(1)))?;
    let job = Job::new(loaded, Overrides { spp: Some(spp), size: Some(size), ..Overrides::default() })?;
    let ours = job.render_replicates(REPLICATES, &mut Control::to_the_end())?.picture.layers;
    let picture = |pixels| Image { width: ours.width, height: ours.height, pixels };
    // A picture without samples of its own has the error alone.
    let error = ours.error.as_ref().filter(|_| ours.variance.is_empty());
    let spread = error.map(|error| error.rgb.iter().map(|e| e.map(|e| e * e)).collect());
    let (mut mean, mut variance) =
        (picture(ours.rgb.clone()), picture(spread.unwrap_or_else(|| ours.variance.clone())));
    for i in 0..their_mean.pixels.len() {
        let (x, y) = (i % their_mean.width, i / their_mean.width);
        if without.iter().any(|[x0, y0, x1, y1]| (x0..x1).contains(&&x) && (y0..y1).contains(&&y)) {
            // As if both were sure of the same.
            mean.pixels[i] = their_mean.pixels[i];
            (variance.pixels[i], their_variance.pixels[i]) = ([0.0; 3], [0.0; 3]);
        }
    }
    let [mean, variance, their_mean, their_variance] =
        [&mean, &variance, &their_mean, &their_variance].map(|image| cut(image, within));
    let a = Estimate { dof: f64::from(REPLICATES - 1), ..Estimate::new(&mean, Some(&variance)) };
    Ok(compare(a, Estimate::new(&their_mean, Some(&their_variance)), tails)?)
}

fn read(path: &Path) -> Result<Image, Failure> {
    let bytes = std::fs::read(path).map_err(|e| format!("can't read {}: {e}", path.display()))?;
    image::read(&bytes, &Limits::default()).map_err(|e| format!("can't read {}: {e}", path.display()).into())
}
