//! An EXR by rows is the EXR as a whole: read, written, and refused.

use crate::common;

use std::io::Cursor;

use ::exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, IntegerBounds, Layer,
    LayerAttributes, LineOrder, Vec2, WritableImage,
};
use straal_formats::Limits;
use straal_formats::image::{Photo, exr};

/// All numbers of a picture, as bits: by layer and channel.
type Numbers = Vec<(String, String, Vec<u32>)>;

fn numbers(picture: &exr::Layered) -> Numbers {
    let of = |layer: &exr::Layer, c: &exr::Channel| {
        (layer.name.clone(), c.name.clone(), c.samples.iter().map(|v| v.to_bits()).collect())
    };
    picture.layers.iter().flat_map(|l| l.channels.iter().map(move |c| of(l, c))).collect()
}

/// Reads a file as a whole and by rows.
fn same_by_rows(bytes: &[u8], what: &str) {
    let limits = Limits::default();
    let whole = exr::read(bytes, &limits).unwrap();
    let mut strips = exr::Strips::open(Cursor::new(bytes), &limits).unwrap();
    let window = whole.data_window;
    assert_eq!((strips.head().data_window, strips.head().space), (window, whole.space), "{what}");
    assert_eq!(strips.head().metadata, whole.metadata, "{what}");
    for step in [1, 7, usize::MAX] {
        let mut all: Numbers = Vec::new();
        for first in (0..window.height).step_by(step) {
            let strip = strips.rows(first..first.saturating_add(step)).unwrap();
            assert_eq!(strip.data_window.height, step.min(window.height - first), "{what}");
            assert_eq!(i64::from(strip.data_window.y), i64::from(window.y) + first as i64, "{what}");
            let new = numbers(&strip);
            if all.is_empty() {
                all = new;
            } else {
                all.iter_mut().zip(new).for_each(|(all, new)| all.2.extend(new.2));
            }
        }
        assert!(all == numbers(&whole), "{what}, {step} rows at a time");
    }
    let photo = Photo::of_strips(&mut strips).unwrap();
    let expected = Photo::of_exr(&whole, None).unwrap();
    let bits = |photo: &Photo| photo.pixels.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert!(bits(&photo) == bits(&expected), "{what}");
    assert_eq!(photo.layer, expected.layer, "{what}");
}

/// A part of the `exr` crate, with a channel whose numbers tell their places.
fn part(
    name: &str,
    channel: &str,
    at: [i32; 2],
    size: [usize; 2],
    encoding: Encoding,
) -> Layer<AnyChannels<FlatSamples>> {
    let [width, height] = size;
    let samples = (0..width * height).map(|k| k as f32 * 0.25 + at[0] as f32).collect();
    let channel = AnyChannel::new(channel, FlatSamples::F32(samples));
    let attributes = LayerAttributes::named(name).with_position(Vec2(at[0], at[1]));
    Layer::new(Vec2(width, height), attributes, encoding, AnyChannels::sort([channel].into_iter().collect()))
}

fn file(layers: Vec<Layer<AnyChannels<FlatSamples>>>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let window = IntegerBounds::new((0, 0), (40, 90));
    Image::from_layers(::exr::prelude::ImageAttributes::new(window), layers)
        .write()
        .to_buffered(&mut bytes)
        .unwrap();
    bytes.into_inner()
}

#[test]
fn chunks_of_all_kinds_are_read_by_rows() {
    let lines = |compression, line_order| Encoding { compression, blocks: Blocks::ScanLines, line_order };
    let tiles = |x, y, compression| Encoding {
        compression,
        blocks: Blocks::Tiles(Vec2(x, y)),
        line_order: LineOrder::Unspecified,
    };
    for (what, encoding) in [
        ("zip", lines(Compression::ZIP16, LineOrder::Increasing)),
        ("zip from below", lines(Compression::ZIP16, LineOrder::Decreasing)),
        ("single lines", lines(Compression::ZIP1, LineOrder::Increasing)),
        ("piz", lines(Compression::PIZ, LineOrder::Increasing)),
        ("plain", lines(Compression::Uncompressed, LineOrder::Increasing)),
        ("tiles", tiles(13, 11, Compression::PIZ)),
        ("tiles larger than the picture", tiles(64, 256, Compression::RLE)),
    ] {
        same_by_rows(&file(vec![part("beauty", "Y", [2, -3], [31, 75], encoding)]), what);
        // Of several parts each has its own window.
        let other = part("depth", "far.Z", [5, 20], [35, 66], tiles(16, 16, Compression::ZIP16));
        same_by_rows(&file(vec![part("beauty", "Y", [2, -3], [31, 75], encoding), other]), what);
    }
}

#[test]
fn openexr_test_images_are_read_by_rows() {
    let Some(shared) = common::shared() else { return };
    for entry in std::fs::read_dir(shared.join("scenes/conformance/openexr-images/TestImages")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "exr") {
            same_by_rows(&std::fs::read(&path).unwrap(), &path.display().to_string());
        }
    }
}

fn layered(height: usize) -> exr::Layered {
    let width = 9;
    let light: Vec<[f32; 3]> =
        (0..width * height).map(|k| [k as f32, 0.5, -1.0 / (1.0 + k as f32)]).collect();
    exr::Layered {
        data_window: exr::Window { x: 3, y: -4, width, height },
        layers: vec![exr::Layer::from_rgb("", &light), exr::Layer::from_rgb("albedo", &light)],
        metadata: vec![("straal.version".into(), "1".into())],
        ..exr::Layered::of_size(50, 60)
    }
}

/// The rows of a picture in memory.
fn cut(picture: &exr::Layered, rows: std::ops::Range<usize>) -> exr::Layered {
    let mut bytes = Cursor::new(Vec::new());
    exr::write(&mut bytes, picture).unwrap();
    exr::Strips::open(bytes, &Limits::default()).unwrap().rows(rows).unwrap()
}

#[test]
fn rows_are_written_as_the_whole_is() {
    for height in [1, 16, 17, 55] {
        let picture = layered(height);
        let mut whole = Vec::new();
        exr::write(&mut whole, &picture).unwrap();
        let mut out = Cursor::new(Vec::new());
        let mut writer = exr::StripWriter::new(&mut out, picture.data_window, &cut(&picture, 0..16)).unwrap();
        for first in (0..height).step_by(16) {
            writer.strip(&cut(&picture, first..height.min(first + 16))).unwrap();
        }
        writer.end().unwrap();
        assert!(out.into_inner() == whole, "{height} rows");
    }
}

#[test]
fn rows_that_are_not_the_next_are_refused() {
    let picture = layered(40);
    let first = cut(&picture, 0..16);
    let new = || exr::StripWriter::new(Cursor::new(Vec::new()), picture.data_window, &first).unwrap();
    let refused = new().strip(&cut(&picture, 0..15)).unwrap_err().to_string();
    assert_eq!(refused, "these aren't the rows that come next");
    let mut other = first.clone();
    other.layers.pop();
    assert_eq!(
        new().strip(&other).unwrap_err().to_string(),
        "these rows have other channels than those before"
    );
    let mut short = new();
    short.strip(&first).unwrap();
    assert_eq!(short.end().unwrap_err().to_string(), "rows are missing");
}

#[test]
fn files_that_are_cut_short_or_damaged_are_refused() {
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let bytes = file(vec![part("beauty", "Y", [0, 0], [20, 40], encoding)]);
    let read = |bytes: &[u8]| {
        let mut strips = exr::Strips::open(Cursor::new(bytes), &Limits::default())?;
        Photo::of_strips(&mut strips).map(|photo| photo.pixels.len())
    };
    assert_eq!(read(&bytes).unwrap(), 800);
    for end in 0..bytes.len() {
        assert!(read(&bytes[..end]).is_err(), "{end} of {} bytes", bytes.len());
    }
    // Any byte may be wrong: the picture is read, or refused, but nothing panics.
    let mut refused = 0;
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0xff;
        refused += usize::from(read(&damaged).is_err());
    }
    assert!(refused > bytes.len() / 4, "{refused}");
}
