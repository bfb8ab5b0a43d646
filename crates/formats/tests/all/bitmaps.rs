//! Pictures of all formats as textures take them: made by another program, each with the pixels that `tests/pictures/README.md` says.

use std::path::{Path, PathBuf};

use crate::common;

use straal_formats::image::{self, Format, Header, Photo};
use straal_formats::{Limits, ReadError};
use straal_scene::Bitmap;
use straal_scene::bitmap::{Number, Response};

const FOLDER: &str = "../../tests/pictures";

/// What the pixels are, and by how much codes may differ.
#[derive(Clone, Copy)]
enum Kind {
    Colours(f32),
    Alpha,
    Grey(f32),
    Palette,
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(FOLDER).join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn read(bytes: &[u8]) -> Result<(Bitmap, Vec<String>), ReadError> {
    image::bitmap(bytes, &Limits::default())
}

const STEPS: [(&str, Format, Kind); 18] = [
    ("steps.png", Format::Png, Kind::Colours(0.0)),
    ("steps.bmp", Format::Bmp, Kind::Colours(0.0)),
    ("steps-565.bmp", Format::Bmp, Kind::Colours(8.0)),
    ("steps-palette.bmp", Format::Bmp, Kind::Palette),
    ("steps-runs.bmp", Format::Bmp, Kind::Palette),
    ("steps-4.bmp", Format::Bmp, Kind::Palette),
    ("steps.tga", Format::Tga, Kind::Colours(0.0)),
    ("steps-runs.tga", Format::Tga, Kind::Colours(0.0)),
    ("steps-alpha.tga", Format::Tga, Kind::Alpha),
    ("steps-grey.tga", Format::Tga, Kind::Grey(0.0)),
    ("steps-palette.tga", Format::Tga, Kind::Palette),
    ("steps.webp", Format::Webp, Kind::Colours(0.0)),
    ("steps-alpha.webp", Format::Webp, Kind::Alpha),
    ("steps-lossy.webp", Format::Webp, Kind::Colours(24.0)),
    ("steps.jpg", Format::Jpeg, Kind::Colours(6.0)),
    ("steps-progressive.jpg", Format::Jpeg, Kind::Colours(6.0)),
    ("steps-cmyk.jpg", Format::Jpeg, Kind::Colours(12.0)),
    ("steps-grey.jpg", Format::Jpeg, Kind::Grey(4.0)),
];

#[test]
fn pictures_of_all_formats_have_their_pixels() {
    for (name, format, kind) in STEPS {
        let bytes = bytes(name);
        let header = image::header(&bytes, &Limits::default()).unwrap();
        assert_eq!((header.format, header.width, header.height), (format, 16, 12), "{name}");
        let (bitmap, notes) = read(&bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
        let texels = &bitmap.texels;
        assert_eq!((texels.width(), texels.height()), (16, 12), "{name}");
        assert!(notes.is_empty(), "{name}: {notes:?}");
        assert!(matches!(bitmap.response, Response::Table(_)) && bitmap.space.is_none(), "{name}");
        assert!(bitmap.heap_bytes() <= header.bitmap_bytes() + 4096, "{name}");
        let (is_grey, most) = match kind {
            Kind::Grey(most) => (true, most),
            Kind::Colours(most) => (false, most),
            Kind::Alpha | Kind::Palette => (false, 0.0),
        };
        assert_eq!(texels.format().channels, if is_grey { 1 } else { 4 }, "{name}");
        for i in 0..192 {
            let (x, y) = (i % 16, i / 16);
            let alpha = if matches!(kind, Kind::Alpha) { 255 - 16 * x } else { 255 };
            let want = match kind {
                Kind::Colours(_) | Kind::Alpha => [16 * x, 20 * y, 8 * (x + y), alpha],
                Kind::Grey(_) => [10 * x + 8 * y, 0, 0, 0],
                Kind::Palette => {
                    let v = 37 * (x + 3 * y) % 16 * 17;
                    [v, v, v, 255]
                }
            };
            let got = texels.numbers(x, y);
            for (got, want) in got.into_iter().zip(want) {
                assert!((got - want as f32).abs() <= most, "{name}: {got} for {want} at {x}, {y}");
            }
        }
        // As light, it is the same picture.
        let photo = Photo::read(&bytes, &Limits::default()).unwrap();
        let first = straal_color::srgb::decode(texels.numbers(3, 2)[0] / 255.0);
        assert!((photo.pixels[2 * 16 + 3][0] - first).abs() < 1e-6, "{name}");
    }
}

#[test]
fn what_a_picture_says_of_its_colours_is_honoured() {
    let (p3, _) = read(&bytes("steps-p3.jpg")).unwrap();
    assert_eq!(p3.space, Some(straal_color::Space::DisplayP3.rgb()));
    let (sixteen, _) = read(&bytes("quarters-16.png")).unwrap();
    assert_eq!(sixteen.texels.format().number, Number::Short);
    assert_eq!(sixteen.texels.numbers(1, 0), [65_535.0, 65_535.0, 0.0, 65_535.0]);
    // Codes of a PNG without a curve are light.
    let linear = [&[[[0_u8, 1, 2]; 4]; 1][0][..]].concat();
    let mut png = Vec::new();
    let encoded = image::png::Encoded {
        width: 2,
        height: 2,
        pixels: image::png::Pixels::Eight(&linear),
        curve: image::png::Curve::Gamma(1.0),
        metadata: &[],
    };
    image::png::write(&mut png, &encoded).unwrap();
    assert_eq!(read(&png).unwrap().0.response, Response::Linear);
}

#[test]
fn damaged_pictures_are_refused_with_a_reason() {
    for (name, ..) in STEPS {
        let whole = bytes(name);
        // All that comes after the pixels may be missing.
        for length in (0..whole.len() * 3 / 4).step_by(3) {
            let cut = &whole[..length];
            let outcome = read(cut);
            assert!(outcome.is_err(), "{name} cut to {length} of {} bytes is read", whole.len());
        }
    }
    let too_short = b"\xff\xd8\xff\xe0 is a beginning of a JPEG".as_slice();
    let no_picture = b"what is this then?\n".as_slice();
    for (bytes, says) in [(too_short, "JPEG"), (no_picture, "not a picture that straal knows: BMP, EXR")] {
        let error = read(bytes).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
    // 2^20 pixels in a row, of which none is there.
    let mut wide = bytes("steps.bmp");
    wide[18..22].copy_from_slice(&(1_i32 << 20).to_le_bytes());
    assert_eq!(read(&wide).unwrap_err().to_string(), "the BMP file is damaged: pixels are missing");
    wide[18..22].copy_from_slice(&0_i32.to_le_bytes());
    assert_eq!(read(&wide).unwrap_err().to_string(), "the picture is empty: 0 x 12 pixels");
}

#[test]
fn the_headers_alone_tell_the_size() {
    for (name, format, _) in STEPS {
        let header = Header::open(&Path::new(FOLDER).join(name), &Limits::default()).unwrap();
        assert_eq!((header.format, header.width, header.height), (format, 16, 12), "{name}");
    }
}

/// The files of a folder that end so, in their order.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == extension));
    files.sort();
    assert!(!files.is_empty(), "{}", folder.display());
    files
}

#[test]
fn png_suite_is_read_as_textures() {
    let Some(shared) = common::shared() else { return };
    let suite = shared.join("scenes/conformance/pngsuite");
    let get = |path: &Path| {
        let bytes = std::fs::read(path).unwrap();
        let (bitmap, _) = read(&bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        // As light, and as a texture, they are the same numbers.
        let header = image::header(&bytes, &Limits::default()).unwrap();
        assert_eq!((bitmap.texels.width(), bitmap.texels.height()), (header.width, header.height));
        assert!(bitmap.texels.heap_bytes() <= header.bitmap_bytes(), "{}", path.display());
        bitmap
    };
    let mut interlaced = 0;
    for path in files(&suite.join("primary"), "png") {
        let bitmap = get(&path);
        // Those whose fourth letter is an i are interlaced, and else the same pictures.
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if let Some(rest) = name.strip_prefix("basi") {
            let plain = get(&path.with_file_name(format!("basn{rest}")));
            assert!(bitmap.texels == plain.texels, "{name}");
            interlaced += 1;
        }
        // Of 3 in the sixth place are pictures with palettes, and the last two digits are the depth.
        let deep = name.ends_with("16.png");
        assert_eq!(bitmap.texels.format().number == Number::Short, deep && !name.contains("3p"), "{name}");
    }
    assert!(interlaced > 10, "{interlaced}");
    for path in files(&suite.join("16bit"), "png") {
        get(&path);
    }
    for path in files(&suite.join("corrupt"), "png") {
        assert!(read(&std::fs::read(&path).unwrap()).is_err(), "{}", path.display());
    }
}

#[test]
fn openexr_test_images_are_read_as_textures() {
    let Some(shared) = common::shared() else { return };
    for path in files(&shared.join("scenes/conformance/openexr-images/TestImages"), "exr") {
        let bytes = std::fs::read(&path).unwrap();
        let (bitmap, _) = read(&bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let header = image::header(&bytes, &Limits::default()).unwrap();
        assert_eq!((bitmap.texels.width(), bitmap.texels.height()), (header.width, header.height));
        for i in 0..header.width * header.height {
            let numbers = bitmap.texels.numbers(i % header.width, i / header.width);
            assert!(numbers.iter().all(|v| v.is_finite()), "{}", path.display());
        }
        // Cut anywhere, it is an error and no panic.
        for part in 1..8 {
            let cut = &bytes[..bytes.len() * part / 8];
            assert!(read(cut).is_err(), "{} cut to {part} eighths", path.display());
        }
    }
}
