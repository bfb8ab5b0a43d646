//! `straal accel`

use super::{load, print, refused};
use crate::args::AccelArgs;
use crate::complaint;
use crate::exit::{Exit, Failure};
use crate::out;
use crate::places::{check_output, refuse_inputs};
use std::io::Write;
use std::sync::Arc;
use std::time::Instant;
use straal::Clock;
use straal_formats::atomic;
use straal_scene::Diagnostics;
use straal_study::lab::{self, Request};

/// Compares search structures on a scene's rays; the exit says whether their hits differ.
pub fn run(args: &AccelArgs, start: Instant) -> Result<Exit, Failure> {
    let options = args.reading.options();
    let request = Request { memory: options.memory, ..request(args)? };
    let loaded = load(&args.scene, &options)?;
    refuse_inputs(args.html.as_deref(), &loaded.files)?;
    if !args.quiet {
        out::say(&complaint::show(&loaded.warnings, out::has_colours()));
    }
    let clock: Clock = Arc::new(move || u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX));
    let mut say = |what: &str| {
        if !args.quiet {
            out::say(&format!("{what}\n"));
        }
    };
    let report = lab::run(&loaded, &request, &clock, &mut say).map_err(|e| failure(e, &loaded.warnings))?;
    if let Some(path) = &args.html {
        let name = args.scene.file_name().unwrap_or_default().to_string_lossy();
        let page = lab::page::html(&report, &name);
        atomic::write(path, |file| file.write_all(page.as_bytes()))
            .map_err(|e| Failure::system(e.to_string()))?;
        say(&format!("wrote {}", path.display()));
    }
    if args.json {
        print(&format!("{:#}\n", lab::json::report(&report)))?;
    } else {
        print(&lab::text::report(&report))?;
    }
    Ok(if report.hits_equal() { Exit::Fine } else { Exit::Differ })
}

fn request(args: &AccelArgs) -> Result<Request, Failure> {
    if let Some(isa) = args.isa.filter(|isa| !isa.is_available()) {
        return Err(Failure::input(format!("this processor has no {isa}")));
    }
    if let Some(path) = &args.html {
        check_output(path)?;
        refuse_inputs([path.as_path()], std::slice::from_ref(&args.scene))?;
    }
    let structures = args.structures.as_deref().map(lab::parse_structures).transpose();
    Ok(Request {
        structures: structures.map_err(|e| Failure::input(e.to_string()))?,
        size: args.size.map(|s| s.0),
        spp: args.spp,
        rays: args.rays,
        rounds: args.rounds,
        moving: args.moving.clone(),
        pictures: args.html.is_some(),
        isa: args.isa,
        memory: None,
    })
}

fn failure(error: lab::Error, read: &Diagnostics) -> Failure {
    match error {
        lab::Error::Job(e) => refused(e, read),
        lab::Error::NoSuchObject { message, help } => Failure::input(message).help(help),
        lab::Error::Thread(e) => Failure::system(e.to_string()),
        other => Failure::input(other.to_string()),
    }
}
