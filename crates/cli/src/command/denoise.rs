//! `straal denoise`

use super::{Writing, not_read, print, standard_input};
use crate::args::DenoiseArgs;
use crate::exit::{Exit, Failure};
use crate::out;
use crate::places::{check_pictures, is_stream, refuse_inputs, refuse_twins};
use serde_json::json;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use straal::denoise::{Denoised, Denoising, Network, NoDenoise, NoisyFile, Signal};
use straal_formats::{Limits, files, image};

/// A network, its name, and those that prefilter its guides.
type Own = ((String, Network), [Option<Network>; 2]);

/// The networks of a file or of a folder.
fn own(path: &Path) -> Result<Own, Failure> {
    if !path.is_dir() {
        return Ok((network(path, Signal::Light)?, [None, None]));
    }
    // The best that there is, of those that `cargo xtask weights` writes.
    let find = |names: [&str; 2]| {
        let files = names.map(|name| path.join(format!("{name}.tza")));
        files.into_iter().find(|file| file.exists())
    };
    let light = find(["rt_hdr_calb_cnrm_large", "rt_hdr_calb_cnrm"]);
    let albedo = find(["rt_alb_large", "rt_alb"]);
    let normal = find(["rt_nrm_large", "rt_nrm"]);
    let (Some(light), Some(albedo), Some(normal)) = (light, albedo, normal) else {
        let help = "`cargo xtask weights WHEEL FOLDER` writes them all: rt_hdr_calb_cnrm.tza, rt_alb.tza, rt_nrm.tza and larger ones";
        let message = format!("{} hasn't the weights for light, albedo and normals", path.display());
        return Err(Failure::input(message).help(help));
    };
    let prefilters = [network(&albedo, Signal::Albedo)?.1, network(&normal, Signal::Normal)?.1].map(Some);
    Ok((network(&light, Signal::Light)?, prefilters))
}

/// A network with weights from a file, and its name.
fn network(path: &Path, signal: Signal) -> Result<(String, Network), Failure> {
    // The largest that is published has 8 MB.
    const MOST: u64 = 64 << 20;
    let bytes = files::read(path, MOST).map_err(|refusal| not_read(path, refusal))?;
    let network = Network::from_archive(&bytes, signal);
    let network =
        network.map_err(|e| Failure::input(format!("can't read {} as weights: {e}", path.display())))?;
    let name = path.file_stem().unwrap_or(path.as_os_str());
    Ok((name.to_string_lossy().into_owned(), network))
}

/// What a person should know of the picture and of what was done.
fn tell(args: &DenoiseArgs, picture_file: &NoisyFile, denoised: &Denoised, bad: [Option<String>; 2]) {
    let name = args.picture.display();
    for note in picture_file.notes().iter().chain(&denoised.notes).chain(bad.iter().flatten()) {
        out::say(&format!("warning: {name}: {note}\n"));
    }
    if let Some(fireflies) = &denoised.fireflies {
        out::say(&format!("fireflies: {fireflies}\n"));
    }
}

/// Denoises a picture.
pub fn run(args: &DenoiseArgs) -> Result<Exit, Failure> {
    let stream = check_pictures(&args.output, args.format, args.json)?;
    let outputs = || args.output.iter().map(PathBuf::as_path);
    refuse_twins(outputs())?;
    refuse_inputs(outputs(), std::slice::from_ref(&args.picture))?;
    let name = args.picture.display();
    let limits = super::picture_limits();
    let picture_file = if is_stream(&args.picture) {
        NoisyFile::open(Cursor::new(standard_input()?), &limits)
    } else {
        let opened = image::open(&args.picture, &Limits::default());
        let (file, _) = opened.map_err(|refusal| not_read(&args.picture, refusal))?;
        NoisyFile::open(file, &limits)
    };
    let mut picture_file = picture_file.map_err(|e| Failure::input(format!("can't read {name}: {e}")))?;
    let faults = picture_file.faults();
    let bad = [
        faults.nan.told("no number (NaN)", "black"),
        faults.infinite.told("infinite", "the brightest there can be"),
    ];
    let (network, prefilters) = match args.weights.as_deref().map(own).transpose()? {
        Some((network, prefilters)) => (Some(network), prefilters),
        None => (None, [None, None]),
    };
    let how = Denoising {
        effort: args.effort,
        network,
        prefilters,
        fireflies: args.fireflies,
        threads: args.threads,
        isa: args.isa,
    };
    let denoised = picture_file.denoise(&how).map_err(|e| {
        let failure = match e {
            NoDenoise::Threads(_) => Failure::system(format!("can't denoise {name}: {e}")),
            _ => Failure::input(format!("can't denoise {name}: {e}")),
        };
        match e {
            NoDenoise::Twice(_) => {
                failure.help("start from the noisy picture: in an EXR it is the layer `noisy`")
            }
            _ => failure,
        }
    })?;
    if !args.quiet {
        tell(args, &picture_file, &denoised, bad);
    }
    let development = args.development.over(picture_file.development());
    let mut writing = Writing::default();
    for path in &args.output {
        let done = if is_stream(path) {
            let written = out::picture(|to| picture_file.write(to, stream, &development));
            written.map_err(|e| format!("can't write to standard output: {e}"))
        } else {
            picture_file.save(path, &development).map_err(|e| e.to_string())
        };
        writing.note(path, done);
    }
    writing.end()?;
    if !args.quiet {
        let names: Vec<String> = args.output.iter().map(|p| p.display().to_string()).collect();
        let by =
            if denoised.guides.is_empty() { "light alone".to_owned() } else { denoised.guides.join(", ") };
        out::say(&format!("wrote {}, denoised by {} ({by})\n", names.join(", "), denoised.weights));
    }
    if args.json {
        let names: Vec<_> = args.output.iter().map(|p| p.to_string_lossy()).collect();
        let fireflies = denoised.fireflies.map(|f| json!({ "pixels": f.pixels, "share": f.share }));
        let report = json!({
            "pictures": names,
            "size": picture_file.size(),
            "weights": denoised.weights,
            "guides": denoised.guides,
            "fireflies": fireflies,
            "notes": denoised.notes,
        });
        print(&format!("{report:#}\n"))?;
    }
    Ok(Exit::Fine)
}
