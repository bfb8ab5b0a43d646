//! `straal man`

use super::print;
use crate::args::{CommandLine, ManArgs};
use crate::exit::{Exit, Failure};
use clap::{Command, CommandFactory};
use straal_scene::suggest;

/// Prints a manual page.
pub fn run(args: &ManArgs) -> Result<Exit, Failure> {
    let mut all = CommandLine::command();
    all.build();
    let page = match &args.command {
        None => all,
        Some(name) => {
            let found = all.find_subcommand(name).cloned();
            found.ok_or_else(|| {
                let names: Vec<&str> = all.get_subcommands().map(Command::get_name).collect();
                let near = suggest::did_you_mean(name, names.iter().copied());
                let help = near.unwrap_or_else(|| format!("it has {}", suggest::list(names.iter().copied())));
                Failure::input(format!("straal has no command `{name}`")).help(help)
            })?
        }
    };
    let mut text = Vec::new();
    let made = clap_mangen::Man::new(page).render(&mut text);
    made.map_err(|e| Failure::system(format!("can't make the manual page: {e}")))?;
    print(&String::from_utf8_lossy(&text))?;
    Ok(Exit::Fine)
}
