//! `straal sampler`

use super::print;
use crate::args::SamplerArgs;
use crate::exit::{Exit, Failure};
use crate::out;
use crate::places::check_output;
use serde_json::{Value as Json, json};
use std::io::Write;
use std::path::{Path, PathBuf};
use straal::PatternKind;
use straal_formats::atomic;
use straal_study::points::{self, Course, Figures, Request};

/// Tells how evenly the points of one pattern or of all lie, and draws them.
pub fn run(args: &SamplerArgs) -> Result<Exit, Failure> {
    let kinds = args.pattern.map_or(PatternKind::ALL.to_vec(), |kind| vec![kind]);
    let request = |kind| Request { kind, count: args.count, seed: args.seed, dimensions: args.dimensions.0 };
    let picture = match (&args.plot, args.pattern) {
        (None, _) => None,
        (Some(_), None) => {
            let help = "such as `straal sampler sobol --plot`";
            return Err(Failure::input("--plot draws one pattern: name it").help(help));
        }
        (Some(None), Some(kind)) => Some(PathBuf::from(format!("{kind}.svg"))),
        (Some(Some(path)), Some(_)) => Some(path.clone()),
    };
    if let Some(path) =
        picture.as_ref().filter(|p| !p.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg")))
    {
        let name = path.display();
        let problem =
            format!("can't write {name}: points are drawn as SVG, so that the name must end in .svg");
        let help = format!(
            "browsers and most programs for drawing read it: --plot {}",
            path.with_extension("svg").display()
        );
        return Err(Failure::input(problem).help(help));
    }
    if let Some(path) = &picture {
        check_output(path)?;
    }
    let course = Course::new();
    let found: Vec<(PatternKind, Figures)> =
        kinds.into_iter().map(|kind| (kind, points::figures(&request(kind), &course))).collect();
    if let (Some(path), Some((kind, figures))) = (&picture, found.first()) {
        let drawing = points::svg(&request(*kind), args.map.0, figures);
        write(path, &drawing)?;
    }
    if args.json {
        let all: Vec<Json> = found.iter().map(|(kind, f)| as_json(*kind, args.count, f)).collect();
        print(&format!("{:#}\n", json!({ "patterns": all })))?;
    } else {
        print(&tell(args.count, &found))?;
    }
    Ok(Exit::Fine)
}

fn write(path: &Path, drawing: &str) -> Result<(), Failure> {
    atomic::write(path, |file| file.write_all(drawing.as_bytes()))
        .map_err(|e| Failure::system(e.to_string()))?;
    out::say(&format!("wrote {}\n", path.display()));
    Ok(())
}

fn as_json(kind: PatternKind, count: u32, f: &Figures) -> Json {
    json!({
        "sampler": kind.name(),
        "count": count,
        "l2_star_discrepancy": f.discrepancy,
        "l2_star_discrepancy_of_random": f.discrepancy_of_random,
        "radial_power": f.power,
        "aliasing_rms": { "3.79": f.aliasing[0], "10.83": f.aliasing[1] },
    })
}

fn tell(count: u32, found: &[(PatternKind, Figures)]) -> String {
    let mut text = format!(
        "{:16} {:>12} {:>12} {:>12}\n{:16} {:>12} {:>12} {:>12}\n",
        format!("{count} points"),
        "L2-star",
        "RMS error",
        "RMS error",
        "",
        "discrepancy",
        "to 3.79",
        "to 10.83"
    );
    for (kind, f) in found {
        text += &format!(
            "{:16} {:>12.5} {:>12.5} {:>12.5}\n",
            kind.name(),
            f.discrepancy,
            f.aliasing[0],
            f.aliasing[1]
        );
    }
    text + "RMS errors are those of the pixels of a 64 x 64 picture of (1 + sin(x²y²))/2 over [0, 3.79]² and [0, 10.83]²\n"
}
