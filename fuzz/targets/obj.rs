//! Any bytes as an OBJ mesh; what follows a zero byte is every library of materials that it names.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let cut = bytes.iter().position(|&b| b == 0).unwrap_or(bytes.len());
    let (model, library) = bytes.split_at(cut);
    let _ = straal_formats::mesh::obj::read(model, &straal_formats::Limits::default(), &mut |_| Some(library.to_vec()));
});
