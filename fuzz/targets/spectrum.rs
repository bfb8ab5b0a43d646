//! Any bytes as a table of wavelengths and values.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = straal_formats::spd::read(bytes);
});
