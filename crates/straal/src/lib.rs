//! straal, a physically based renderer that shows its work: the library's front door.
//!
//! ```no_run
//! let loaded = straal::load("scene.yaml".as_ref(), &straal::LoadOptions::default())?;
//! let job = straal::Job::new(loaded, straal::Overrides { spp: Some(16), ..Default::default() })?;
//! let outcome = job.render(&mut straal::Control::to_the_end())?;
//! outcome.picture.save("scene.exr".as_ref(), &job.development())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The way of the data: [`load`] reads files into a description, [`Job::new`] compiles it into a world,
//! [`Job::render`] gathers light on a film, and a [`Picture`] is developed and written. The crates below
//! can be used by themselves: `straal_accel` for ray search, `straal_color` for light, `straal_render` for the rest;
//! `straal_study`, beside this crate, explains what they do.
#![forbid(unsafe_code)]

pub mod compare;
pub mod denoise;
pub mod develop;
pub mod development;
pub mod focus;
pub mod forecast;
pub mod job;
pub mod picture;
pub mod relight;
pub mod replicates;
pub mod resolve;
pub mod search;
pub mod sums;
pub mod written;

pub use development::{Bits, Development, Gamma};
pub use forecast::{Forecast, forecast};
pub use job::{Blocks, Control, Job, Outcome, Progress, Snapshot, Verdict};
pub use picture::Picture;
pub use resolve::{Error, Overrides};
pub use straal_accel::{Build, Isa, Structure};
pub use straal_color::{Dither, Exposure, Gamut, Meter, Space, Tone};
pub use straal_formats::load::{
    Listener, Loaded, Options as LoadOptions, Reading, Shelf, is_mesh, load, load_str, load_stream,
};
pub use straal_formats::studio::{self, Studio};
pub use straal_math::lowdisc::PatternKind;
pub use straal_render::camera::{Facts as CameraFacts, Focus as CameraFocus};
pub use straal_render::driver::Pause;
pub use straal_render::film::Region;
pub use straal_render::film::{FIRST_CHECK, MAX_SAMPLES, Recording};
pub use straal_render::settings::Guides;
pub use straal_render::stopwatch::{Clock, Phase, Times};

/// The version of the library, which goes into every picture.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The scene that is rendered when none is named; it needs no other file.
pub const EMBEDDED_SCENE: &str = include_str!("../../../scenes/embedded.yaml");
