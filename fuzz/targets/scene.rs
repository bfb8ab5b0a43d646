//! Any bytes as a scene: it is read, or refused with complaints that can be shown.
#![no_main]

use std::path::Path;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    match straal_formats::load_bytes("scene.yaml", bytes, Path::new("/nonexistent"), &Default::default()) {
        Ok(loaded) => drop(loaded.warnings.to_string()),
        Err(complaints) => assert!(complaints.to_string().contains("error: ")),
    }
});
