//! Any bytes as a PLY mesh.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = straal_formats::mesh::ply::read(bytes, &straal_formats::Limits::default());
});
