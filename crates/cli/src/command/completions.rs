//! `straal completions`

use super::print;
use crate::args::{CommandLine, CompletionsArgs};
use crate::exit::{Exit, Failure};
use clap::CommandFactory;

/// Prints what a shell needs to complete the command line.
pub fn run(args: &CompletionsArgs) -> Result<Exit, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut CommandLine::command(), "straal", &mut script);
    print(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Fine)
}
