//! `straal metamer`

use super::{not_read, print};
use crate::args::MetamerArgs;
use crate::exit::{Exit, Failure};
use crate::places::refuse_inputs;
use serde_json::{Map, Value as Json, json};
use std::io::Write;
use std::path::{Path, PathBuf};
use straal_color::spectrum::refraction::{self, Metal};
use straal_color::spectrum::{Bins, FIRST, Illuminant, Quantity, illuminant, metamer, uplift::Uplift};
use straal_formats::{atomic, files, spd};
use straal_scene::suggest::{did_you_mean, list};
use straal_scene::value::LinearRgb;

/// Below this difference colours match: about what trained eyes can tell apart side by side.
const MATCH: f64 = 1.0;

/// Compares two spectra, or makes a metamer.
pub fn run(args: &MetamerArgs) -> Result<Exit, Failure> {
    let a = surface(&args.a)?;
    let b = match (&args.b, &args.make) {
        (Some(b), _) => surface(b)?,
        (None, Some(path)) => make(&a, args, path)?,
        (None, None) => return Err(Failure::input("a second spectrum, or --make, is needed")),
    };
    let rows: Vec<(&str, f64)> = illuminant::NAMES
        .iter()
        .filter_map(|name| {
            let light = Illuminant::named(name)?.spectrum().bins(Quantity::Emission);
            Some((*name, metamer::difference(&a, &b, &light, args.observer)))
        })
        .collect();
    if args.json {
        let differences: Map<String, Json> =
            rows.iter().map(|(name, d)| ((*name).to_owned(), json!(d))).collect();
        print(&format!("{:#}\n", json!({ "delta_e_2000": differences })))?;
    } else {
        print(&told(&rows))?;
    }
    Ok(Exit::Fine)
}

fn told(rows: &[(&str, f64)]) -> String {
    let mut text = String::from("light  dE 2000\n");
    for (name, difference) in rows {
        let verdict = if *difference < MATCH { "match" } else { "differ" };
        text += &format!("{name:5}  {difference:7.2}  {verdict}\n");
    }
    let matches = rows.iter().filter(|row| row.1 < MATCH).count();
    text += match (matches, rows.len() - matches) {
        (0, _) => "They match under none of these lights.\n",
        (_, 0) => "They match under all of these lights.\n",
        _ => "They are metamers: they match under some of these lights.\n",
    };
    text
}

/// A reflectance by what was typed.
fn surface(typed: &str) -> Result<Bins, Failure> {
    let flat = typed.parse::<f64>().ok().map(LinearRgb::grey);
    if let Some(LinearRgb(rgb)) = flat.or_else(|| LinearRgb::from_hex(typed)) {
        if !rgb.iter().all(|v| (0.0..=1.0).contains(v)) {
            return Err(Failure::input(format!("{typed} is no reflectance: it must be from 0 to 1")));
        }
        return Ok(Uplift::new().fit(rgb).bins());
    }
    let path = Path::new(typed);
    if !path.exists() {
        if let Some([eta, k]) = Metal::named(typed).map(Metal::index) {
            return Ok(refraction::facing(&eta.bins(Quantity::Index), &k.bins(Quantity::Index)));
        }
        if Illuminant::named(typed).is_some() {
            let help = "--under says under which light a metamer is made";
            return Err(Failure::input(format!("{typed} is a light, and surfaces are compared")).help(help));
        }
        let metals: Vec<&str> = Metal::all().map(Metal::name).collect();
        let near = did_you_mean(typed, metals.iter().copied());
        let forms = format!(
            "it is a file, a colour such as '#b0a090', a grey from 0 to 1, or a metal: {}",
            list(metals)
        );
        return Err(Failure::input(format!("there is no spectrum {typed}")).help(near.unwrap_or(forms)));
    }
    let bytes = files::read(path, spd::MOST_BYTES).map_err(|refusal| not_read(path, refusal))?;
    let spectrum = spd::read(&bytes).map_err(|e| Failure::input(format!("can't read {typed}: {e}")))?;
    let bins = spectrum.bins(Quantity::Reflectance);
    if spectrum.peak() > 1.0 {
        let message = format!("{typed} is no reflectance: it reaches {}", spectrum.peak());
        return Err(Failure::input(message)
            .help("of all light that falls on it a surface sends back 1; percents are hundredths"));
    }
    Ok(bins)
}

/// A metamer, which is written to a file as well.
fn make(a: &Bins, args: &MetamerArgs, path: &Path) -> Result<Bins, Failure> {
    if Path::new(&args.a).is_file() {
        refuse_inputs([path], &[PathBuf::from(&args.a)])?;
    }
    let light = Illuminant::named(&args.under)
        .ok_or_else(|| Failure::input(format!("there is no illuminant {}", args.under)))?
        .spectrum()
        .bins(Quantity::Emission);
    let twin = metamer::of(a, &light, args.observer).ok_or_else(|| {
        Failure::input(format!(
            "{} has no metamer: as black or white as it is, there is no room for one",
            args.a
        ))
    })?;
    let mut text = format!(
        "# metamer of {} under {}: wavelength in nm, reflectance\n",
        args.a.escape_debug(),
        args.under
    );
    for (i, v) in twin.iter().enumerate() {
        text += &format!("{} {v:.9}\n", FIRST + i);
    }
    atomic::write(path, |file| file.write_all(text.as_bytes()))
        .map_err(|e| Failure::system(e.to_string()))?;
    Ok(twin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_judged() {
        assert!(told(&[("A", 3.2), ("D65", 0.04)]).contains("They are metamers"));
        assert!(told(&[("A", 3.2)]).ends_with("under none of these lights.\n"));
        assert!(told(&[("A", 0.0)]).ends_with("under all of these lights.\n"));
        assert!(surface("1.5").is_err() && surface("#zzz").is_err() && surface("0.4").is_ok());
        assert!(surface("D65").is_err());
        let told = |typed: &str| {
            surface(typed).err().map(|f| format!("{} {:?}", f.message, f.help)).unwrap_or_default()
        };
        assert!(
            told("glod").contains("no spectrum glod") && told("glod").contains("`gold`"),
            "{}",
            told("glod")
        );
        assert!(told("#12345").contains("'#b0a090'"), "{}", told("#12345"));
        // Silver is a good mirror and nearly colourless, gold has lost its blue.
        let at = |name: &str, nm: usize| surface(name).map_or(0.0, |bins| bins[nm - FIRST]);
        assert!(at("silver", 450) > 0.9 && at("gold", 450) < 0.5 && at("Gold", 700) > 0.9);
    }
}
