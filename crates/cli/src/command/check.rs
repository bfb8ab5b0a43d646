//! `straal check`

use super::{load, print, refused, warn};
use crate::args::CheckArgs;
use crate::complaint;
use crate::exit::{Exit, Failure};
use crate::out;
use crate::quantity::{count, tell_bytes};
use serde_json::json;
use straal::{CameraFacts as Facts, Job, LoadOptions, Overrides};
use straal_accel::Structure;
use straal_scene::forecast::{Forecast, forecast};

/// Reads a scene and all its files, tells all that is wrong and forecasts memory.
pub fn run(args: &CheckArgs) -> Result<Exit, Failure> {
    let options = LoadOptions { lenient: args.lenient, root: args.root.clone(), ..LoadOptions::default() };
    let loaded = load(&args.scene, &options)?;
    let mut warnings = loaded.warnings.clone();
    let needs = forecast(&loaded.scene, &loaded.assets);
    let structure = straal::search::structure_of(&loaded.scene.accel.structure);
    let (size, spp, noise) = (loaded.scene.film.size, loaded.scene.sampler.spp, loaded.scene.sampler.noise);
    // What only compiling finds out is found out as well; brute force spares the building of search trees.
    let overrides = Overrides { accel: Some(Structure::Brute), ..Overrides::default() };
    let job = Job::new(loaded, overrides).map_err(|e| refused(e, &warnings))?;
    warn(&mut warnings, &job);

    let camera = job.camera();

    out::say(&complaint::show(&warnings, out::has_colours()));
    if args.json {
        let focus = camera.focus.map(|f| {
            let [near, far] = f.sharp;
            // JSON knows no infinity: a depth without end has null.
            json!({ "lens_radius": f.radius, "distance": f.distance, "sharp": [near, far] })
        });
        let report = json!({
            "scene": args.scene.to_string_lossy(),
            "scene_hash": job.scene_hash,
            "size": size,
            "samples": spp,
            "noise": noise,
            "camera": { "kind": camera.kind, "degrees": camera.degrees, "focus": focus },
            "triangles": needs.triangles,
            "visible_primitives": needs.visible,
            "dropped_primitives": job.world.dropped.iter().map(|d| d.count).sum::<usize>(),
            "memory_bytes": {
                "geometry": needs.mesh_bytes,
                "search": needs.search_bytes,
                "images": needs.image_bytes,
                "film": needs.film_bytes,
                "total": needs.total_bytes(),
            },
            "diagnostics": complaint::as_json(&warnings),
        });
        print(&format!("{report:#}\n"))?;
    } else {
        let most = if noise.is_some() { "at most " } else { "" };
        let frame = format!("{} x {} pixels, {most}{}", size[0], size[1], count(spp.into(), "sample"));
        let (camera, table) = (tell_camera(&camera), tell(&needs, &frame, structure.name()));
        print(&format!("{}: in order\n{camera}{table}", args.scene.display()))?;
    }
    Ok(Exit::Fine)
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
    let rows = [
        ("film", needs.film_bytes, frame),
        ("geometry", needs.mesh_bytes, geometry.as_str()),
        ("search", needs.search_bytes, structure),
        ("images", needs.image_bytes, ""),
        ("together", needs.total_bytes(), ""),
    ];
    let mut text = String::from("memory of a render, about:\n");
    for (part, bytes, note) in rows {
        let row = format!("  {part:<9}{:>10}  {note}", tell_bytes(bytes));
        text += row.trim_end();
        text += "\n";
    }
    text
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
            mesh_bytes: 56_000,
            search_bytes: 70_000,
            image_bytes: 0,
            film_bytes: 29_491_200,
        };
        let want = "\
memory of a render, about:
  film        29.5 MB  640 x 360 pixels, 16 samples
  geometry    56.0 kB  1,000 triangles, 5000 shapes in sight
  search      70.0 kB  kd
  images          0 B
  together    29.6 MB
";
        assert_eq!(tell(&needs, "640 x 360 pixels, 16 samples", "kd"), want);
    }
}
