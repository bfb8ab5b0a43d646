//! The command `straal`: what a person touches. It reads the command line, calls the library and tells what came of
//! it; it renders nothing itself.
#![forbid(unsafe_code)]

mod args;
mod command;
mod complaint;
mod exit;
mod interrupt;
mod keeping;
mod machine;
mod out;
mod places;
mod process;
mod progress;
mod quantity;
mod report;
mod settings;

use args::{Command, CommandLine};
use clap::Parser;
use clap::error::ErrorKind;
use exit::{Exit, Failure};
use interrupt::Interrupt;
use std::ffi::OsString;
use std::panic;
use std::process::ExitCode;
use std::time::Instant;
use straal_formats::atomic;

fn main() -> ExitCode {
    let start = Instant::now();
    panic::set_hook(Box::new(|info| end_by_bug(&info.to_string())));
    ExitCode::from(run(start).code())
}

/// Tells of a panic and ends the command, whichever thread it is on: without the file of a picture that was being written.
fn end_by_bug(panic: &str) -> ! {
    let told = bug(panic);
    out::say(&told);
    out::last_words(|| {
        complaint::failure_as_json(&Failure { exit: Exit::Bug, ..Failure::input(told.trim_end()) })
    });
    atomic::abandon();
    std::process::exit(Exit::Bug.code().into())
}

fn run(start: Instant) -> Exit {
    let words: Vec<OsString> = std::env::args_os().collect();
    let json = words.iter().take_while(|w| *w != "--").any(|w| w == "--json");
    out::answers_in_json(json);
    let line = match CommandLine::try_parse_from(&words) {
        Ok(line) => line,
        // Help and version are "errors" too; nobody is left to tell of a broken pipe.
        Err(e) if e.exit_code() == 0 || e.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = e.print();
            return if e.exit_code() == 0 { Exit::Fine } else { Exit::Input };
        }
        Err(e) => return tell(&args::failure(&e, &words)),
    };
    let interrupt = Interrupt::listen();
    let done = match line.command {
        Command::Render(args) => command::render::run(*args, start, &interrupt),
        Command::Merge(args) => command::merge::run(&args, &interrupt),
        Command::Check(args) => command::check::run(&args),
        Command::Convert(args) => command::convert::run(&args),
        Command::Tree(args) => command::tree::run(&args),
        Command::Accel(args) => command::accel::run(&args, start),
        Command::Sampler(args) => command::sampler::run(&args),
        Command::Schema => command::schema::run(),
        Command::Diff(args) => command::diff::run(&args),
        Command::Info(args) => command::info::run(&args),
        Command::Develop(args) => command::develop::run(&args),
        Command::Denoise(args) => command::denoise::run(&args),
        Command::GammaChart(args) => command::gamma_chart::run(&args),
        Command::Metamer(args) => command::metamer::run(&args),
        Command::Completions(args) => command::completions::run(&args),
        Command::Man(args) => command::man::run(&args),
    };
    done.unwrap_or_else(|failure| tell(&failure))
}

fn tell(failure: &Failure) -> Exit {
    out::say(&complaint::show_failure(failure, out::has_colours()));
    out::last_words(|| complaint::failure_as_json(failure));
    failure.exit
}

/// What is said when straal itself is wrong.
fn bug(what: &str) -> String {
    format!(
        "straal {} has a bug; no picture was written.\n{what}\nPlease report this with the command and the scene.\n",
        straal::VERSION
    )
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_bug_is_told_as_one() {
        let told = super::bug("panicked at x.rs:1:2:\nindex out of bounds");
        assert!(told.contains("has a bug") && told.contains("x.rs:1:2") && told.contains(straal::VERSION));
    }
}
