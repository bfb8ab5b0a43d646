//! Any bytes as an STL mesh.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = straal_formats::mesh::stl::read(bytes, &straal_formats::Limits::default(), &|_| true);
});
