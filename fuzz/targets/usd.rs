//! Any bytes as a stage of USD, as text, binary or packed: it is read, or refused with complaints that can be shown.
#![no_main]

use std::path::Path;

use straal_formats::scene::Foreign;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("/nonexistent/scene.usd");
    match straal_formats::load_foreign_bytes(Foreign::Usd, path, bytes.to_vec(), &Default::default()) {
        Ok(loaded) => drop(loaded.warnings.to_string()),
        Err(complaints) => assert!(complaints.to_string().contains("error: ")),
    }
});
