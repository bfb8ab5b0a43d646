//! The command `straal`: what a person touches. It reads the command line, calls the library and tells what came of
//! it; it renders nothing itself.
#![forbid(unsafe_code)]

mod args;
mod command;
mod complaint;
mod exit;
mod interrupt;
mod keeping;
mod out;
mod places;
mod process;
mod progress;
mod quantity;
mod report;
mod settings;

use args::{Command, CommandLine};
use clap::Parser;
use exit::{Exit, Failure};
use interrupt::Interrupt;
use std::panic;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let start = Instant::now();
    panic::set_hook(Box::new(|info| out::say(&bug(&info.to_string()))));
    // Unwinding before the end removes the temporary file of a picture that was being written.
    let exit = panic::catch_unwind(|| run(start)).unwrap_or(Exit::Bug);
    ExitCode::from(exit.code())
}

fn run(start: Instant) -> Exit {
    let line = match CommandLine::try_parse() {
        Ok(line) => line,
        Err(e) => {
            // Help and version are "errors" too, with code 0; nobody is left to tell of a broken pipe.
            let _ = e.print();
            return if e.exit_code() == 0 { Exit::Fine } else { Exit::Input };
        }
    };
    let json = wants_json(&line.command);
    let interrupt = Interrupt::listen();
    let done = match line.command {
        Command::Render(args) => command::render::run(*args, start, &interrupt),
        Command::Merge(args) => command::merge::run(&args, &interrupt),
        Command::Check(args) => command::check::run(&args),
        Command::Accel(args) => command::accel::run(&args, start),
        Command::Sampler(args) => command::sampler::run(&args),
        Command::Schema => command::schema::run(),
        Command::Diff(args) => command::diff::run(&args),
        Command::Info(args) => command::info::run(&args),
        Command::Develop(args) => command::develop::run(&args),
        Command::GammaChart(args) => command::gamma_chart::run(&args),
        Command::Metamer(args) => command::metamer::run(&args),
    };
    done.unwrap_or_else(|failure| tell(&failure, json))
}

fn wants_json(command: &Command) -> bool {
    match command {
        Command::Render(a) => a.json,
        Command::Merge(a) => a.json,
        Command::Check(a) => a.json,
        Command::Accel(a) => a.json,
        Command::Sampler(a) => a.json,
        Command::Diff(a) => a.json,
        Command::Info(a) => a.json,
        Command::Metamer(a) => a.json,
        Command::Schema | Command::Develop(_) | Command::GammaChart(_) => false,
    }
}

fn tell(failure: &Failure, json: bool) -> Exit {
    out::say(&complaint::show_failure(failure, out::has_colours()));
    if json && let Err(e) = out::result(&format!("{:#}\n", complaint::failure_as_json(failure))) {
        out::say(&format!("error: can't write to standard output: {e}\n"));
    }
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
