//! From any bytes to a picture of 4 x 4 pixels, where they are a scene: it is compiled and rendered without a panic, and
//! every pixel is a number.
#![no_main]

use std::path::Path;
use straal::{Control, Job, Overrides};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(loaded) = straal_formats::load_bytes("scene.yaml", bytes, Path::new("/nonexistent"), &Default::default()) else {
        return;
    };
    let wish = Overrides {
        size: Some([4, 4]),
        spp: Some(1),
        max_depth: Some(8),
        threads: Some(1),
        ..Overrides::default()
    };
    let Ok(job) = Job::new(loaded, wish) else { return };
    let Ok(outcome) = job.render(&mut Control::to_the_end()) else { return };
    assert!(outcome.picture.layers.rgb.iter().flatten().all(|v| v.is_finite()), "a pixel is not a number");
});
