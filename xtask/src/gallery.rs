//! The gallery's pictures, small, for the book and the README.

use crate::{Failure, root, scenes};
use std::time::Instant;
use straal::{Control, Job, LoadOptions, Overrides};

/// Where they go.
const FOLDER: &str = "book/src/images";

/// Pixels from left to right.
const WIDTH: u32 = 480;

/// Renders the scenes of `scenes/`, or those named. One whose files are not here is skipped, which is said.
pub fn run(names: &[String]) -> Result<bool, Failure> {
    for (name, path) in scenes("scenes", names)? {
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
        let loaded = straal::load(&path, &LoadOptions::default())
            .map_err(|_| format!("{name}: the scene is wrong; see `straal check scenes/{name}.yaml`"))?;
        let [width, height] = loaded.scene.film.size;
        let size = [WIDTH, (WIDTH * height + width / 2) / width];
        let job = Job::new(loaded, Overrides { size: Some(size), ..Overrides::default() })?;
        let outcome = job.render(&mut Control::to_the_end())?;
        let picture = format!("{FOLDER}/{name}.png");
        outcome.picture.save(&root().join(&picture), &job.look())?;
        println!(
            "{picture}: {} x {}, {} samples a pixel, {:.1} s",
            size[0],
            size[1],
            outcome.samples,
            started.elapsed().as_secs_f64()
        );
    }
    Ok(true)
}
