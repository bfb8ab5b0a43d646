//! The gallery's pictures for the book and the README, rendered larger than they are shown, denoised, and until they are clean.

use crate::{Failure, root, scenes};
use std::time::{Duration, Instant};
use straal::{Control, Job, LoadOptions, Overrides, PatternKind, Picture, Progress, Verdict};
use straal_scene::desc::{Denoise, Integrator};

/// Where they go.
const FOLDER: &str = "book/src/images";

/// The width and height that a picture in the book has room for: a wide one is 960 pixels wide.
const ROOM: [u32; 2] = [960, 720];

/// Pixels that are rendered for three in the book, along both axes: a wide picture is rendered 1280 wide.
const RENDERED: u32 = 4;

/// Error of the pixels that are rendered, relative to their brightness, by the denoiser's own estimate; in the book's it is a quarter less.
const NOISE: f64 = 0.02;

/// Samples that a pixel may get for each that its scene asks for, where noise decides.
const PATIENCE: u32 = 8;

/// Renders the scenes of `scenes/`, or those named. One whose files are not here is skipped, which is said. `--minutes M` among the
/// names: a picture that isn't clean by then is denoised as it is.
pub fn run(words: &[String]) -> Result<bool, Failure> {
    let (names, patience) = match words.iter().position(|w| w == "--minutes") {
        Some(at) => {
            let minutes = words.get(at + 1).and_then(|w| w.parse().ok()).filter(|m| *m > 0.0 && *m < 1e4);
            let minutes: f64 = minutes.ok_or("--minutes takes a number above 0")?;
            ([&words[..at], &words[at + 2..]].concat(), Duration::from_secs_f64(60.0 * minutes))
        }
        None => (words.to_vec(), Duration::MAX),
    };
    for (name, path) in scenes("scenes", &names)? {
        let text = std::fs::read_to_string(&path)?;
        let missing =
            text.lines().filter(|l| !l.starts_with('#')).filter_map(|l| l.split_once("file: ")).map(
                |(_, rest)| {
                    let file = rest.split([',', ' ', '}']).next().unwrap_or(rest);
                    path.with_file_name(file)
                },
            );
        if let Some(file) = missing.into_iter().find(|f| !f.exists()) {
            println!("{name}: skipped, there is no {}", file.display());
            continue;
        }
        let started = Instant::now();
        let mut ends =
            |_: &Progress| if started.elapsed() < patience { Verdict::GoOn } else { Verdict::Stop };
        let loaded = straal::load(&path, &LoadOptions::default())
            .map_err(|_| format!("{name}: the scene is wrong; see `straal check scenes/{name}.yaml`"))?;
        let shown = shown(loaded.scene.film.size);
        // A scene of a pattern, of another pattern than the usual, or of pixels that see one place alone, shows what its very samples do.
        let shows_samples = loaded.scene.integrator == Integrator::SineProduct
            || Job::new(loaded.clone(), Overrides::default())?.settings.pattern.kind() != PatternKind::Sobol
            || loaded.scene.film.splat
            || loaded.scene.film.filter.radius() < 0.5;
        let wish = if shows_samples {
            Overrides { size: Some(shown), ..Overrides::default() }
        } else {
            let spp = Some(loaded.scene.sampler.spp * PATIENCE);
            let size = Some(shown.map(|v| v * RENDERED / 3));
            Overrides { size, spp, noise: Some(NOISE), denoise: Some(Denoise::Best), ..Overrides::default() }
        };
        let job = Job::new(loaded, wish)?;
        let outcome = job.render(&mut Control::new(&mut ends))?;
        let picture = format!("{FOLDER}/{name}.png");
        let size = outcome.picture.size;
        let small = if shows_samples { outcome.picture } else { smaller(outcome.picture, shown) };
        small.save(&root().join(&picture), &job.development())?;
        println!(
            "{picture}: {} x {}, rendered {} x {}, up to {} samples a pixel, {} blocks noisier than {} %, {:.1} s",
            shown[0],
            shown[1],
            size[0],
            size[1],
            outcome.samples,
            outcome.noisy_blocks,
            NOISE * 100.0,
            started.elapsed().as_secs_f64()
        );
    }
    Ok(true)
}

/// The size in the book of a picture that a scene wants in another: as large as there is room for, in multiples of three.
fn shown([width, height]: [u32; 2]) -> [u32; 2] {
    let is_wide = u64::from(width) * u64::from(ROOM[1]) >= u64::from(height) * u64::from(ROOM[0]);
    let (most, of) = if is_wide { (ROOM[0], width) } else { (ROOM[1], height) };
    [width, height].map(|v| {
        let v = (u64::from(v) * u64::from(most) + u64::from(of) / 2) / u64::from(of);
        (v as u32).div_ceil(3) * 3
    })
}

/// The picture with three pixels where there were four, each the mean of the light that falls on it.
fn smaller(mut picture: Picture, to: [u32; 2]) -> Picture {
    let [width, height] = to.map(|v| v as usize);
    let from = picture.layers.width;
    let mut rgb = Vec::with_capacity(width * height);
    for y in 0..height {
        for x in 0..width {
            let mut sum = [0.0f64; 3];
            for (row, by_row) in shares(y) {
                for (column, by_column) in shares(x) {
                    let pixel = picture.layers.rgb[row * from + column];
                    for (sum, v) in sum.iter_mut().zip(pixel) {
                        *sum += by_row * by_column * f64::from(v);
                    }
                }
            }
            rgb.push(sum.map(|v| v as f32));
        }
    }
    picture.layers.rgb = rgb;
    (picture.layers.width, picture.layers.height) = (width, height);
    picture.size = to;
    // The hash is that of the pixels that were rendered.
    picture.metadata.retain(|(key, _)| key != "straal.film_hash");
    picture
}

/// Which pixels of four lie within one of three, and what share of it each has.
fn shares(at: usize) -> [(usize, f64); 2] {
    let first = at / 3 * 4 + at % 3;
    match at % 3 {
        0 => [(first, 0.75), (first + 1, 0.25)],
        1 => [(first, 0.5), (first + 1, 0.5)],
        _ => [(first, 0.25), (first + 1, 0.75)],
    }
}
