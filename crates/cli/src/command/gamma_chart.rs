//! `straal gamma-chart`

use super::print;
use crate::args::GammaChartArgs;
use crate::exit::{Exit, Failure};
use crate::out;
use crate::places::check_output;
use serde_json::json;
use straal::picture::Format;
use straal_study::{SaveError, gamma_chart};

/// Writes the chart.
pub fn run(args: &GammaChartArgs) -> Result<Exit, Failure> {
    let path = &args.output;
    if !matches!(Format::of(path), Ok(Format::Png)) {
        let message =
            format!("can't write {}: the chart is a PNG, so that the name must end in .png", path.display());
        return Err(Failure::input(message));
    }
    check_output(path)?;
    let saved: Result<(), SaveError> = gamma_chart::chart().save(path, &[]);
    saved.map_err(|e| Failure::system(e.to_string()))?;
    out::say(&format!("wrote {}\n", path.display()));
    if args.json {
        print(&format!("{:#}\n", json!({ "pictures": [path.to_string_lossy()] })))?;
    }
    Ok(Exit::Fine)
}
