//! Any bytes as a library of MTL materials.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = straal_formats::mesh::mtl::read(bytes, &straal_formats::Limits::default());
});
