//! `straal check`

use super::{print, refused};
use crate::args::CheckArgs;
use crate::complaint;
use crate::exit::{Exit, Failure};
use crate::out;
use crate::quantity::{count, tell_bytes};
use serde_json::json;
use straal::{Job, LoadOptions, Overrides};
use straal_accel::Structure;
use straal_scene::forecast::{Forecast, forecast};

/// Reads a scene and all its files, tells all that is wrong and forecasts memory.
pub fn run(args: &CheckArgs) -> Result<Exit, Failure> {
    let options = LoadOptions { lenient: args.lenient, ..LoadOptions::default() };
    let loaded = straal::load(&args.scene, &options).map_err(Failure::scene)?;
    let warnings = loaded.warnings.clone();
    let needs = forecast(&loaded.scene, &loaded.assets);
    let (size, spp) = (loaded.scene.film.size, loaded.scene.sampler.spp);
    // What only compiling finds out is found out as well; brute force spares the building of search trees.
    let overrides = Overrides { accel: Some(Structure::Brute), ..Overrides::default() };
    let job = Job::new(loaded, overrides).map_err(|e| refused(e, &warnings))?;

    out::say(&complaint::show(&warnings, out::has_colours()));
    if args.json {
        let report = json!({
            "scene": args.scene.to_string_lossy(),
            "scene_hash": job.scene_hash,
            "size": size,
            "samples": spp,
            "triangles": needs.triangles,
            "visible_primitives": needs.visible,
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
        let frame = format!("{} x {} pixels, {}", size[0], size[1], count(spp.into(), "sample"));
        print(&format!("{}: in order\n{}", args.scene.display(), tell(&needs, &frame)))?;
    }
    Ok(Exit::Fine)
}

/// What a render will take, for people.
fn tell(needs: &Forecast, frame: &str) -> String {
    let geometry = match (needs.triangles, needs.visible) {
        (triangles, visible) if visible > triangles => {
            format!("{}, {visible} shapes in sight", count(triangles, "triangle"))
        }
        (triangles, _) => count(triangles, "triangle"),
    };
    let rows = [
        ("film", needs.film_bytes, frame),
        ("geometry", needs.mesh_bytes, geometry.as_str()),
        ("search", needs.search_bytes, ""),
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
  geometry    56.0 kB  1000 triangles, 5000 shapes in sight
  search      70.0 kB
  images          0 B
  together    29.6 MB
";
        assert_eq!(tell(&needs, "640 x 360 pixels, 16 samples"), want);
    }
}
