//! What `straal man` takes.

use clap::Args;

pub(super) const MAN_ABOUT: &str = "\
Prints the manual page of straal, or of one of its commands, as man reads it: `straal man | man -l -` shows it, and \
`straal man render > ~/.local/share/man/man1/straal-render.1` keeps it for `man straal-render`.";

/// `straal man`
#[derive(Debug, Args)]
pub struct ManArgs {
    /// The command whose page is printed; that of straal itself when absent
    pub command: Option<String>,
}
