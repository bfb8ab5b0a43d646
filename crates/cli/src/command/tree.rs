//! `straal tree`

use super::{load, print};
use crate::args::TreeArgs;
use crate::complaint;
use crate::exit::{Exit, Failure};
use crate::out;
use straal_study::tree::{Show, tree};

/// Prints what stands in a scene, and where.
pub fn run(args: &TreeArgs) -> Result<Exit, Failure> {
    let loaded = load(&args.scene, &args.reading.options())?;
    out::say(&complaint::show(&loaded.warnings, out::has_colours()));
    print(&tree(&loaded.scene, Show { matrices: args.matrices, points: args.points }))?;
    Ok(Exit::Fine)
}
