//! How the command ends.

use straal_scene::Diagnostics;
use straal_scene::memory::Shortage;

/// What the shell is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All was done.
    Fine = 0,
    /// The pictures differ beyond chance, or hits of search structures differ.
    Differ = 1,
    /// What was typed, or a file that was to be read, is wrong.
    Input = 2,
    /// The result couldn't be written, there is too little memory, or the system refused.
    System = 3,
    /// straal is wrong.
    Bug = 70,
    /// Ctrl-C, as shells count it: 128 + SIGINT. Other signals that ask for an end are answered alike.
    Interrupted = 130,
}

impl Exit {
    /// The number.
    pub const fn code(self) -> u8 {
        self as u8
    }
}

/// The codes as the help tells them.
pub const TABLE: &str = "\
Exit codes:
  0    all was done
  1    `straal diff`: the pictures differ by more than chance; `straal accel`: structures found different hits
  2    the command line, the scene or a file that it names is wrong; nothing was written
  3    a picture couldn't be written, it takes more memory than there is, or the system refused something
  70   straal itself is wrong: please report it
  130  ended by Ctrl-C or a signal: with the picture so far after the first, without a picture after the second";

/// Why a command couldn't do its work.
#[derive(Debug)]
pub struct Failure {
    /// What the shell is told.
    pub exit: Exit,
    /// What the person is told, without a full stop; empty when the diagnostics say it all.
    pub message: String,
    /// What would be right.
    pub help: Option<String>,
    /// What is wrong where in the files.
    pub diagnostics: Option<Box<Diagnostics>>,
}

impl Failure {
    /// What was typed, or a file that was to be read, is wrong.
    pub fn input(message: impl Into<String>) -> Self {
        Self { exit: Exit::Input, message: message.into(), help: None, diagnostics: None }
    }

    /// The result couldn't be written, or the system refused.
    pub fn system(message: impl Into<String>) -> Self {
        Self { exit: Exit::System, ..Self::input(message) }
    }

    /// There is too little memory.
    pub fn memory(shortage: &Shortage) -> Self {
        Self::system(shortage.to_string()).help(shortage.help())
    }

    /// The scene is wrong, or there is too little memory to read it.
    pub fn scene(diagnostics: Diagnostics) -> Self {
        let exit = if diagnostics.lacks_memory { Exit::System } else { Exit::Input };
        Self { exit, diagnostics: Some(Box::new(diagnostics)), ..Self::input("") }
    }

    /// With what would be right.
    pub fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_in_the_table() {
        for exit in [Exit::Fine, Exit::Differ, Exit::Input, Exit::System, Exit::Bug, Exit::Interrupted] {
            let listed =
                TABLE.lines().filter(|l| l.split_whitespace().next() == Some(&exit.code().to_string()));
            assert_eq!(listed.count(), 1, "{exit:?}");
        }
    }
}
