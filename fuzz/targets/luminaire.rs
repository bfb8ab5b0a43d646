//! Any bytes as a file of a luminaire, IES or EULUMDAT.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = straal_formats::photometry::read(bytes);
});
