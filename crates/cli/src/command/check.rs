//! `straal check`

use super::{load, print, refused, warn};
use crate::args::CheckArgs;
use crate::complaint;
use crate::exit::{Exit, Failure};
use crate::out;
use crate::quantity::{count, tell_bytes};
use crate::settings;
use serde_json::{Value as Json, json};
use straal::{CameraFacts as Facts, Forecast, Job, Overrides};

/// Reads a scene and all its files, tells all that is wrong and forecasts memory.
pub fn run(args: &CheckArgs) -> Result<Exit, Failure> {
    let options = args.reading.options();
    let memory = options.memory;
    let wish = overrides(args)?;
    let loaded = load(&args.scene, &options)?;
    let mut warnings = loaded.warnings.clone();
    let needs = straal::forecast(&loaded, &wish).map_err(|e| refused(e, &warnings))?;
    let shortage = needs.refuse(memory);
    // What only compiling finds out is found out as well, but not of a scene that the machine can't hold.
    let job = match shortage {
        Some(_) => None,
        None => Some(Job::draft(&loaded, wish.clone()).map_err(|e| refused(e, &warnings))?),
    };
    if let Some(job) = &job {
        warn(&mut warnings, job);
    }
    out::say(&complaint::show(&warnings, out::has_colours()));

    let scene = &loaded.scene;
    let size = wish.size.unwrap_or(scene.film.size);
    let (spp, noise) = (scene.sampler.spp, wish.noise.or(scene.sampler.noise));
    let structure = wish.accel.unwrap_or_else(|| straal::search::structure_of(&scene.accel.structure));
    if args.json {
        let report = json!({
            "scene": args.scene.to_string_lossy(),
            "scene_hash": job.as_ref().map(|job| &job.scene_hash),
            "size": size,
            "samples": spp,
            "noise": noise,
            "camera": job.as_ref().map(|job| camera_as_json(&job.camera())),
            "triangles": needs.triangles,
            "visible_primitives": needs.visible,
            "dropped_primitives": job.as_ref().map(|job| job.world.dropped.iter().map(|d| d.count).sum::<usize>()),
            "memory_bytes": memory_as_json(&needs),
            "memory_limit_bytes": memory,
            "fits": shortage.is_none(),
            "diagnostics": complaint::as_json(&warnings),
        });
        print(&format!("{report:#}\n"))?;
    } else {
        let most = if noise.is_some() { "at most " } else { "" };
        let frame = format!("{} x {} pixels, {most}{}", size[0], size[1], count(spp.into(), "sample"));
        let camera = job.as_ref().map(|job| tell_camera(&job.camera())).unwrap_or_default();
        let state = if job.is_some() { "in order" } else { "too large for this machine" };
        let table = tell(&needs, &frame, structure.name());
        print(&format!("{}: {state}\n{camera}{table}", args.scene.display()))?;
    }
    let Some(shortage) = shortage else { return Ok(Exit::Fine) };
    let failure = Failure::memory(&shortage);
    out::say(&complaint::show_failure(&failure, out::has_colours()));
    Ok(failure.exit)
}

/// What the render that is forecast is asked for.
fn overrides(args: &CheckArgs) -> Result<Overrides, Failure> {
    let has_exr = settings::has_exr(&args.output)?;
    Ok(Overrides {
        size: args.size.map(|s| s.0),
        crop: args.crop.map(|c| c.0),
        noise: args.noise,
        pattern: args.sampler,
        spectral: args.spectral.then_some(true),
        recording: args.channels,
        error: Some(has_exr),
        layers: Some(has_exr),
        splat: args.splat.then_some(true),
        threads: Some(settings::threads(args.threads).0),
        accel: args.accel,
        build: args.build,
        batch: args.batch,
        cost: args.cost.then_some(true),
        ..Overrides::default()
    })
}

fn camera_as_json(camera: &Facts) -> Json {
    let focus = camera.focus.map(|f| {
        let [near, far] = f.sharp;
        // JSON knows no infinity: a depth without end has null.
        json!({ "lens_radius": f.radius, "distance": f.distance, "sharp": [near, far] })
    });
    json!({ "kind": camera.kind, "degrees": camera.degrees, "focus": focus })
}

fn memory_as_json(needs: &Forecast) -> Json {
    json!({
        "program": needs.program,
        "scene": needs.scene,
        "geometry": needs.geometry,
        "search": needs.search,
        "building": needs.building,
        "lights": needs.lights,
        "images": needs.images,
        "textures": needs.textures,
        "film": needs.film,
        "layers": needs.layers,
        "threads": needs.threads,
        "total": needs.peak,
    })
}

/// What follows from the camera's settings, for people.
fn tell_camera(facts: &Facts) -> String {
    let mut text = format!("camera: {}", facts.kind);
    if let Some([across, up]) = facts.degrees {
        text += &format!(", {} x {} degrees", short(across), short(up));
    }
    if let Some(f) = facts.focus {
        let far = if f.sharp[1].is_finite() { format!("to {}", short(f.sharp[1])) } else { "on".to_owned() };
        let (radius, distance, near) = (short(f.radius), short(f.distance), short(f.sharp[0]));
        text +=
            &format!(", lens of radius {radius} in focus at {distance}, sharp to a pixel from {near} {far}");
    }
    text + "\n"
}

/// A number above 0 with four significant digits, or as many as stand before the point.
fn short(v: f64) -> String {
    let (mut places, mut rest) = (3_usize, v);
    while rest >= 10.0 && places > 0 {
        (places, rest) = (places - 1, rest / 10.0);
    }
    while rest > 0.0 && rest < 1.0 && places < 15 {
        (places, rest) = (places + 1, rest * 10.0);
    }
    let text = format!("{v:.places$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// What a render will take, for people.
fn tell(needs: &Forecast, frame: &str, structure: &str) -> String {
    let geometry = match (needs.triangles, needs.visible) {
        (triangles, visible) if visible > triangles => {
            format!("{}, {visible} shapes in sight", count(triangles, "triangle"))
        }
        (triangles, _) => count(triangles, "triangle"),
    };
    let of_threads = "and the program itself".to_owned();
    let rows = [
        ("film", needs.film + needs.layers, frame),
        ("geometry", needs.geometry, geometry.as_str()),
        ("search", needs.search, structure),
        ("lights", needs.lights, ""),
        ("images", needs.images, ""),
        ("textures", needs.textures, "with their smaller copies"),
        ("scene", needs.scene, "its text"),
        ("threads", needs.threads + needs.program, of_threads.as_str()),
    ];
    let mut text = String::from("memory of a render, about:\n");
    for (part, bytes, note) in rows.into_iter().filter(|row| row.1 > 0) {
        text += &line(part, bytes, note);
    }
    text + &line("at most", needs.peak, "at a time, building and reading included")
}

fn line(part: &str, bytes: u64, note: &str) -> String {
    let row = format!("  {part:<9}{:>10}  {note}", tell_bytes(bytes));
    format!("{}\n", row.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_tells_what_follows() {
        use straal::CameraFocus as Focus;
        let focus = Focus { radius: 0.15, distance: 6.0, sharp: [5.932_04, f64::INFINITY] };
        let facts = Facts { kind: "thin lens", degrees: Some([40.0, 20.630_7]), focus: Some(focus) };
        let want = "camera: thin lens, 40 x 20.63 degrees, lens of radius 0.15 in focus at 6, sharp to a pixel from 5.932 on\n";
        assert_eq!(tell_camera(&facts), want);
        assert_eq!(tell_camera(&Facts { kind: "fisheye", degrees: None, focus: None }), "camera: fisheye\n");
        assert_eq!([short(0.000_123_456), short(123_456.0), short(0.0)], ["0.0001235", "123456", "0"]);
    }

    #[test]
    fn the_forecast_is_a_table() {
        let needs = Forecast {
            triangles: 1000,
            vertices: 500,
            visible: 5000,
            geometry: 56_000,
            search: 70_000,
            film: 20_000_000,
            layers: 9_491_200,
            threads: 1_000_000,
            program: 14_000_000,
            peak: 45_000_000,
            ..Forecast::default()
        };
        let want = "\
memory of a render, about:
  film        29.5 MB  640 x 360 pixels, 16 samples
  geometry    56.0 kB  1,000 triangles, 5000 shapes in sight
  search      70.0 kB  kd
  threads     15.0 MB  and the program itself
  at most     45.0 MB  at a time, building and reading included
";
        assert_eq!(tell(&needs, "640 x 360 pixels, 16 samples", "kd"), want);
    }
}
