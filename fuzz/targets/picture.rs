//! Any bytes as a picture: of all formats, told by how they begin.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    // A small file may ask for a large picture, which is no fault: here it may not.
    let limits = straal_formats::Limits { max_pixels: 1 << 20, max_samples: 1 << 22, ..Default::default() };
    let _ = straal_formats::image::header(bytes, &limits);
    let _ = straal_formats::image::surroundings(bytes, &limits);
    let _ = straal_formats::image::bitmap(bytes, &limits);
    let _ = straal_formats::image::png::read_metadata(bytes, &limits);
    if let Ok(picture) = straal_formats::image::exr::read(bytes, &limits) {
        let _ = picture.beauty();
    }
    if let Ok(mut strips) = straal_formats::image::exr::Strips::open(std::io::Cursor::new(bytes), &limits) {
        let _ = strips.rows(0..16);
        let _ = straal_formats::image::Photo::of_strips(&mut strips);
    }
});
