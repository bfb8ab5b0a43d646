//! Pictures that are written come back, pictures of others are read, damaged ones are refused with a reason.

use crate::common;

use std::fs;
use std::path::{Path, PathBuf};

use straal_formats::image::{self, exr, hdr, pfm, png};
use straal_formats::{Limits, Place};
use straal_scene::Image;

fn read(path: &Path) -> Result<Image, straal_formats::ReadError> {
    image::read(&fs::read(path).unwrap(), &Limits::default())
}

fn files(folder: PathBuf, extension: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries.filter(|path| path.extension().is_some_and(|e| e == extension)).collect();
    files.sort();
    assert!(!files.is_empty(), "{}", folder.display());
    files
}

/// A picture with numbers of all magnitudes, the special ones included.
fn test_image(width: usize, height: usize) -> Image {
    let special = [0.0, -0.0, 1e-42, 1e30, -3.5, f32::INFINITY, 65504.0, 0.1];
    let pixels = (0..width * height)
        .map(|i| [i as f32 / 7.0, special[i % special.len()], (i % width) as f32 * 1e-3])
        .collect();
    Image { width, height, pixels }
}

#[test]
fn pfm_comes_back() {
    let image = test_image(5, 3);
    let mut bytes = Vec::new();
    pfm::write(&mut bytes, &image).unwrap();
    assert_eq!(image::read(&bytes, &Limits::default()).unwrap(), image);
    let grey = [b"Pf\r\n2 2\n1.0\n".as_slice(), &[1f32, 2., 3., 4.].map(f32::to_be_bytes).concat()].concat();
    let image = pfm::read(&grey, &Limits::default()).unwrap();
    assert_eq!(image.pixels, [[3.; 3], [4.; 3], [1.; 3], [2.; 3]]);
}

#[test]
fn exr_comes_back_with_layers_windows_and_story() {
    let (width, height) = (19, 37);
    let image = test_image(width, height);
    let depth = exr::Channel { name: "Z".into(), samples: (0..width * height).map(|i| i as f32).collect() };
    let mut picture = exr::Layered {
        display_window: exr::Window { x: 0, y: 0, width: 100, height: 80 },
        data_window: exr::Window { x: 60, y: -20, width, height },
        space: Some(straal_color::Space::AcesCg.rgb()),
        layers: vec![
            exr::Layer::from_rgb("", &image.pixels),
            exr::Layer::from_rgb("albedo", &vec![[0.25, 0.5, 0.75]; width * height]),
            exr::Layer {
                name: "a layer with a name of more than 31 characters".into(),
                channels: vec![depth],
            },
        ],
        metadata: vec![("straal.seed".into(), "7".into()), ("straal.scene".into(), "größe = ½".into())],
        notes: Vec::new(),
    };
    let mut bytes = Vec::new();
    exr::write(&mut bytes, &picture).unwrap();
    let mut again = Vec::new();
    exr::write(&mut again, &picture).unwrap();
    assert_eq!(bytes, again);

    let back = exr::read(&bytes, &Limits::default()).unwrap();
    picture.metadata.sort();
    for layer in &mut picture.layers {
        layer.channels.sort_by(|a, b| a.name.cmp(&b.name));
    }
    picture.layers.sort_by(|a, b| a.channels[0].name.cmp(&b.channels[0].name));
    for layer in &picture.layers {
        assert_eq!(back.layer(&layer.name), Some(layer));
    }
    assert_eq!(back.layers.len(), picture.layers.len());
    assert_eq!(back.metadata, picture.metadata);
    assert_eq!((back.data_window, back.display_window), (picture.data_window, picture.display_window));
    assert_eq!(back.space, picture.space);
    // As an image it has the primaries of sRGB.
    let matrix = straal_color::Space::AcesCg.to(straal_color::Space::Srgb);
    let there: Vec<_> = image.pixels.iter().map(|p| matrix.apply_f32(*p)).collect();
    let part = image::Photo::of_exr(&back, None).unwrap();
    assert_eq!((part.size, part.part), ([100, 80], exr::Window { x: 60, y: -20, width, height }));
    // What lies above the frame isn't in the whole picture.
    let whole = back.to_image().unwrap();
    assert_eq!((whole.width, whole.height), (100, 80));
    assert_eq!(whole.pixels[60..60 + width], there[20 * width..21 * width]);
    assert!(whole.pixels[..60].iter().all(|p| *p == [0.0; 3]));
}

#[test]
fn hdr_comes_back_within_its_precision() {
    let mut image = test_image(19, 7);
    image.pixels[3] = [1e-30, 2e30, 0.5];
    image.pixels[4] = [f32::INFINITY, 1.0, f32::NAN];
    image.pixels[5] = [-1.0, 0.25, 0.0];
    image.pixels[6] = [1e-42; 3];
    let mut bytes = Vec::new();
    hdr::write(&mut bytes, &image).unwrap();
    let back = hdr::read(&bytes, &Limits::default()).unwrap();
    for (i, (a, b)) in image.pixels.iter().zip(&back.pixels).enumerate() {
        let a = a.map(|v| if v > 0.0 { v } else { 0.0 });
        let most = a.into_iter().fold(0.0, |m: f32, v| if v > m { v } else { m });
        for (a, b) in a.into_iter().zip(b) {
            let fine = if most.is_finite() { a - b <= most / 128.0 && *b <= a } else { b.is_finite() };
            assert!(fine || most < 1e-37, "pixel {i}: {a} became {b}");
        }
    }
    assert!(back.pixels[4][0] > 1e37 && back.pixels[6] == [0.0; 3]);
}

#[test]
fn exr_refuses_to_write_what_makes_no_picture() {
    let mut picture = exr::Layered::of_size(2, 2);
    let refused = |picture: &exr::Layered| exr::write(Vec::new(), picture).unwrap_err().to_string();
    assert_eq!(refused(&picture), "the picture is empty");
    picture.layers = vec![exr::Layer::from_rgb("", &[[0.0; 3]; 3])];
    assert_eq!(refused(&picture), "channel R has 3 samples for 2 x 2 pixels");
    picture.layers = vec![exr::Layer::from_rgb("", &[[0.0; 3]; 4]); 2];
    assert_eq!(refused(&picture), "two channels are called B");
    picture.layers.pop();
    picture.metadata = vec![("dataWindow".into(), "all of it".into())];
    assert_eq!(refused(&picture), "two attributes are called dataWindow");
}

#[test]
fn png_is_srgb_with_text() {
    let pixels = [[0, 128, 255], [10, 20, 30], [1, 2, 3], [255, 255, 255], [7, 7, 7], [200, 100, 50]];
    let metadata = [("straal seed".to_string(), "7 größe".to_string())];
    let mut bytes = Vec::new();
    png::write(
        &mut bytes,
        &png::Encoded {
            width: 3,
            height: 2,
            pixels: png::Pixels::Eight(&pixels),
            curve: png::Curve::Srgb,
            metadata: &metadata,
        },
    )
    .unwrap();
    let image = image::read(&bytes, &Limits::default()).unwrap();
    assert_eq!((image.width, image.height), (3, 2));
    assert_eq!(image.pixels[0][0], 0.0);
    assert!((image.pixels[0][1] - 0.215_860_5).abs() < 1e-7);
    assert_eq!(image.pixels[3], [1.0; 3]);
    let holds = |part: &[u8]| bytes.windows(part.len()).any(|window| window == part);
    assert!(holds(b"sRGB") && holds(b"iTXtstraal seed") && holds("7 größe".as_bytes()));

    let told = png::read_metadata(&bytes, &Limits::default()).unwrap();
    assert_eq!((told.size, told.texts.as_slice()), ((3, 2), metadata.as_slice()));
    for cut in 0..bytes.len() {
        // A cut before the pixels is an error, one after them can't be told; neither panics.
        let _ = png::read_metadata(&bytes[..cut], &Limits::default());
    }
    assert!(png::read_metadata(&bytes[..20], &Limits::default()).is_err());
}

/// A 4 x 2 picture of one colour in each of the eight orientations: the red pixel ends up where it belongs.
#[test]
fn hdr_orientations() {
    for (orientation, red) in [
        ("-Y 2 +X 3", (0, 0)),
        ("-Y 2 -X 3", (2, 0)),
        ("+Y 2 +X 3", (0, 1)),
        ("+Y 2 -X 3", (2, 1)),
        ("+X 3 -Y 2", (0, 0)),
        ("-X 3 -Y 2", (2, 0)),
        ("+X 3 +Y 2", (0, 1)),
        ("-X 3 +Y 2", (2, 1)),
    ] {
        let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{orientation}\n").into_bytes();
        bytes.extend([255, 0, 0, 128]);
        bytes.extend([0, 0, 64, 129].repeat(5));
        let image = hdr::read(&bytes, &Limits::default()).unwrap();
        assert_eq!((image.width, image.height), (3, 2));
        for (i, pixel) in image.pixels.iter().enumerate() {
            let expected = if (i % 3, i / 3) == red { [255.0 / 256.0, 0., 0.] } else { [0., 0., 0.5] };
            assert_eq!(*pixel, expected, "{orientation}");
        }
    }
}

#[test]
fn hdr_encodings_and_exposure() {
    let header = |size: &str| {
        format!("#?RGBE\n# made by hand\nEXPOSURE=2\nEXPOSURE= 2.0\nFORMAT=32-bit_rle_rgbe\n\n{size}\n")
            .into_bytes()
    };
    // The old encoding: a pixel, 1 + 1 * 256 times the same, another.
    let mut bytes = header("-Y 1 +X 259");
    bytes.extend([128, 64, 32, 129, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0]);
    let image = hdr::read(&bytes, &Limits::default()).unwrap();
    assert!(image.pixels[..258].iter().all(|pixel| *pixel == [0.25, 0.125, 0.0625]));
    assert_eq!(image.pixels[258], [0.0; 3]);
    // Components apart: runs and single values.
    let mut bytes = header("-Y 1 +X 8");
    bytes.extend([2, 2, 0, 8]);
    bytes.extend([128 + 8, 128]);
    bytes.extend([4, 0, 16, 32, 64, 128 + 4, 64]);
    bytes.extend([128 + 8, 0]);
    bytes.extend([128 + 7, 129, 1, 130]);
    let image = hdr::read(&bytes, &Limits::default()).unwrap();
    assert_eq!(image.pixels[1], [0.25, 1.0 / 32.0, 0.0]);
    assert_eq!(image.pixels[7], [0.5, 0.25, 0.0]);
}

#[test]
fn errors_say_what_and_where() {
    let told = |bytes: &[u8]| image::read(bytes, &Limits::default()).unwrap_err();
    assert_eq!(told(b"").to_string(), "the file is empty");
    assert_eq!(
        told(b"what").to_string(),
        "not a picture that straal knows: BMP, EXR, HDR, JPEG, KTX2, PFM, PNG, TGA and WebP are"
    );
    assert_eq!(told(b"PF\n4 x").to_string(), "byte 5: expected the height, found 'x'");
    assert_eq!(
        told(b"PF\n4000 4000\n-1\n1234").to_string(),
        "byte 16: 4000 x 4000 pixels are promised, but only 4 bytes are there"
    );
    let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n....";
    assert_eq!(
        told(hdr).to_string(),
        "line 2: the format '32-bit_rle_xyze' is not supported, only '32-bit_rle_rgbe'"
    );
    assert_eq!(told(b"#?RADIANCE\n\n-Y 1 +X 2\nabcdef").place, Place::Byte(26));
    let limits = Limits { max_pixels: 10, ..Limits::default() };
    let large = pfm::read(b"PF\n4 4\n-1\n", &limits).unwrap_err();
    assert_eq!(large.to_string(), "the picture is too large: 4 x 4 pixels, the limit is 10 in all");
}

#[test]
fn environment_maps_are_read() {
    let Some(shared) = common::shared() else { return };
    // Means over all numbers, computed by an independent reader of these files in Python.
    for (name, mean) in
        [("studio", 1.881_913_129_3), ("sunset", 0.439_833_865_9), ("venice", 0.740_651_894_8)]
    {
        let image = read(&shared.join("scenes/hdri").join(name).with_extension("hdr")).unwrap();
        assert_eq!((image.width, image.height), (1024, 512));
        let sum: f64 = image.pixels.iter().flatten().map(|&v| f64::from(v)).sum();
        let found = sum / (3 * image.pixels.len()) as f64;
        assert!((found - mean).abs() < 1e-9 * mean, "{name}: {found}");
    }
}

#[test]
fn openexr_test_images_are_read() {
    let Some(shared) = common::shared() else { return };
    for path in files(shared.join("scenes/conformance/openexr-images/TestImages"), "exr") {
        let picture = exr::read(&fs::read(&path).unwrap(), &Limits::default());
        let picture = picture.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let image = picture.to_image().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert_eq!(image.pixels.len(), image.width * image.height);
        if path.ends_with("AllHalfValues.exr") {
            // Every half occurs once: 2046 NaNs and two infinities, and those that are numbers cancel out.
            let red = || image.pixels.iter().map(|pixel| pixel[0]);
            assert_eq!((image.width, image.height), (256, 256));
            assert_eq!(red().filter(|v| v.is_nan()).count(), 2046);
            assert_eq!(red().filter(|v| v.is_infinite()).count(), 2);
            assert_eq!(red().filter(|v| v.is_finite()).map(f64::from).sum::<f64>(), 0.0);
            assert_eq!(
                red().filter(|v| v.is_finite()).fold(0.0, |most: f32, v| if v > most { v } else { most }),
                65504.0
            );
        }
    }
}

#[test]
fn png_suite_is_read_and_its_corrupt_files_are_refused() {
    let Some(shared) = common::shared() else { return };
    let suite = shared.join("scenes/conformance/pngsuite");
    for path in files(suite.join("primary"), "png") {
        let image = read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        // The suite has its own gammas, its check none: codes are compared.
        let without = |path: &Path| {
            let bytes = common::without_chunks(&fs::read(path).unwrap(), &[*b"gAMA", *b"cHRM"]);
            image::read(&bytes, &Limits::default()).unwrap()
        };
        let check = without(&suite.join("primary_check").join(path.file_name().unwrap()));
        assert!(without(&path) == check, "{}", path.display());
        assert_eq!((image.width, image.height), (check.width, check.height));
    }
    for path in files(suite.join("16bit"), "png") {
        let image = read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert_eq!((image.width, image.height), (32, 32));
    }
    for path in files(suite.join("corrupt"), "png") {
        assert!(read(&path).is_err(), "{}", path.display());
    }
}

/// Parts and encodings that the `exr` crate writes, as other programs do.
#[test]
fn exr_parts_of_others() {
    use ::exr::prelude::{
        AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image as Exr, IntegerBounds,
        Layer, LayerAttributes, LineOrder, Vec2, WritableImage,
    };
    let part = |name: &str, channel: &str, x: i32, value: f32, compression| {
        let channel = AnyChannel::new(channel, FlatSamples::F32(vec![value; 4 * 3]));
        let encoding = Encoding { compression, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
        Layer::new(
            Vec2(4, 3),
            LayerAttributes::named(name).with_position(Vec2(x, 0)),
            encoding,
            AnyChannels::sort([channel].into_iter().collect()),
        )
    };
    let write = |layers: Vec<_>| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let window = IntegerBounds::new((0, 0), (8, 3));
        let image = Exr::from_layers(::exr::prelude::ImageAttributes::new(window), layers);
        image.write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    };
    // The second part lies two columns further right: its pixels go where they belong, the rest is zero.
    let zip = Compression::ZIP16;
    let bytes = write(vec![part("beauty", "Y", 0, 0.5, zip), part("depth", "far.Z", 2, 3.0, zip)]);
    let picture = exr::read(&bytes, &Limits::default()).unwrap();
    assert_eq!(picture.data_window, exr::Window::of_size(6, 3));
    assert_eq!(picture.display_window, exr::Window::of_size(8, 3));
    let beauty = [0.5, 0.5, 0.5, 0.5, 0.0, 0.0];
    assert_eq!(picture.layer("beauty").unwrap().channel("Y"), Some(beauty.repeat(3).as_slice()));
    let far = [0.0, 0.0, 3.0, 3.0, 3.0, 3.0].repeat(3);
    assert_eq!(picture.layer("depth.far").unwrap().channel("Z"), Some(far.as_slice()));
    // What is outside of the part is black.
    let whole = [0.5, 0.5, 0.5, 0.5, 0.0, 0.0, 0.0, 0.0].map(|v| [v; 3]).repeat(3);
    assert_eq!(picture.to_image().unwrap().pixels, whole);
    // Of the colours alone no more than their part is read.
    let (read, colours) = exr::read_colours(&bytes, &Limits::default(), None).unwrap();
    assert_eq!((read.layers.len(), read.data_window), (1, exr::Window::of_size(4, 3)));
    assert_eq!((colours.pixels, colours.layer.as_str()), (vec![[0.5; 3]; 12], "beauty"));
    let (_, colours) = exr::read_colours(&bytes, &Limits::default(), Some("far")).unwrap();
    assert_eq!(colours.pixels, vec![[3.0; 3]; 12]);

    let bytes = write(vec![part("beauty", "Y", 0, 0.5, Compression::DWAA(None))]);
    let refused = exr::read(&bytes, &Limits::default()).unwrap_err().to_string();
    assert_eq!(refused, "dwaa compression is not supported: save the file with ZIP or PIZ");
}

#[test]
fn an_exr_whose_space_makes_no_sense_has_none() {
    let srgb = straal_color::Space::Srgb.rgb();
    let at = |x: f64, y: f64| straal_color::Chromaticity { x, y };
    for primaries in [[at(0.3, 0.3); 3], [at(f64::NAN, 0.3), at(0.3, 0.6), at(0.15, 0.06)]] {
        let mut picture = exr::Layered::of_size(1, 1);
        picture.layers = vec![exr::Layer::from_rgb("", &[[0.25, 0.5, 0.75]])];
        picture.space = Some(straal_color::RgbSpace { primaries, ..srgb });
        let mut bytes = Vec::new();
        exr::write(&mut bytes, &picture).unwrap();
        let back = exr::read(&bytes, &Limits::default()).unwrap();
        assert_eq!(back.space, None);
        assert_eq!(back.to_image().unwrap().pixels, [[0.25, 0.5, 0.75]]);
    }
}

/// A size is known before anything is decoded, also from the beginning of a file alone.
#[test]
fn headers_tell_size_and_cost() {
    let image = test_image(19, 7);
    let mut picture = exr::Layered::of_size(19, 7);
    picture.layers = vec![exr::Layer::from_rgb("", &image.pixels)];
    let pixels = vec![[1_u8, 2, 3]; 19 * 7];
    let (mut a, mut b, mut c, mut d) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    exr::write(&mut a, &picture).unwrap();
    hdr::write(&mut b, &image).unwrap();
    pfm::write(&mut c, &image).unwrap();
    let encoded = png::Encoded {
        width: 19,
        height: 7,
        pixels: png::Pixels::Eight(&pixels),
        curve: png::Curve::Srgb,
        metadata: &[],
    };
    png::write(&mut d, &encoded).unwrap();
    for (bytes, format) in
        [(a, image::Format::Exr), (b, image::Format::Hdr), (c, image::Format::Pfm), (d, image::Format::Png)]
    {
        let told = image::header(&bytes, &Limits::default()).unwrap();
        assert_eq!((told.format, told.width, told.height, told.channels), (format, 19, 7, 3));
        assert_eq!(told.kept_bytes(), 12 * 19 * 7);
        assert!(told.decoded_bytes >= told.kept_bytes() && told.decoded_bytes < 4 * told.kept_bytes());
        let tight = Limits { max_decoded: told.decoded_bytes - 1, ..Limits::default() };
        let refused = image::read(&bytes, &tight).unwrap_err().to_string();
        assert!(refused.starts_with("the picture is too large: it would take"), "{refused}");
        assert!((0..bytes.len()).all(|cut| {
            image::header(&bytes[..cut], &Limits::default()).map_or(true, |half| half == told)
        }));
    }
}
