//! What files say of their colours is honoured, or it is told that it isn't.

use crate::common::with_chunks;

use straal_color::{Adaptation, RgbSpace, Space};
use straal_formats::Limits;
use straal_formats::image::{self, Photo, exr, hdr, png};
use straal_math::ops::pow_d;

fn near(found: [f32; 3], wanted: [f64; 3], tolerance: f64) {
    let fits = found.iter().zip(wanted).all(|(f, w)| (f64::from(*f) - w).abs() < tolerance);
    assert!(fits, "{found:?}, not {wanted:?}");
}

fn photo(bytes: &[u8]) -> Photo {
    Photo::read(bytes, &Limits::default()).unwrap()
}

fn light(bytes: &[u8]) -> [f32; 3] {
    image::read(bytes, &Limits::default()).unwrap().pixels[0]
}

/// One pixel of 16 bits without a word about its curve.
fn bare_png(codes: [u16; 3]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let pixels = [codes];
    let encoded = png::Encoded {
        width: 1,
        height: 1,
        pixels: png::Pixels::Sixteen(&pixels),
        curve: png::Curve::Srgb,
        metadata: &[],
    };
    png::write(&mut bytes, &encoded).unwrap();
    with_chunks(&bytes, &[(*b"sRGB", Vec::new())])
}

fn gama(value: u32) -> ([u8; 4], Vec<u8>) {
    (*b"gAMA", value.to_be_bytes().to_vec())
}

fn chrm(space: &RgbSpace) -> ([u8; 4], Vec<u8>) {
    let [r, g, b] = space.primaries;
    let all = [space.white, r, g, b].map(|c| [c.x, c.y].map(|v| ((v * 1e5).round() as u32).to_be_bytes()));
    (*b"cHRM", all.as_flattened().concat())
}

#[test]
fn a_png_is_encoded_as_its_chunks_say() {
    let bare = bare_png([13_107, 26_214, 52_428]);
    let srgb = [0.033_104_8, 0.132_868_3, 0.603_827_3];
    near(light(&bare), srgb, 1e-6);
    // A gamma of 1: codes are light.
    let plain = with_chunks(&bare, &[gama(100_000)]);
    assert_eq!(light(&plain), [0.2, 0.4, 0.8]);
    let old = with_chunks(&bare, &[gama(45_455)]);
    near(light(&old), [0.2_f64, 0.4, 0.8].map(|v| pow_d(v, 2.2)), 1e-5);
    // What sRGB says counts before gAMA and cHRM, and cICP before all.
    let p3 = Space::DisplayP3.rgb();
    let all = [(*b"sRGB", vec![0]), gama(100_000), chrm(&p3)];
    near(light(&with_chunks(&bare, &all)), srgb, 1e-6);
    let video = |points: [u8; 4]| (*b"cICP", points.to_vec());
    let wide = with_chunks(&bare, &[video([12, 8, 0, 1]), (*b"sRGB", vec![0]), gama(45_455)]);
    let want = p3.to(&Space::Srgb.rgb(), Adaptation::Bradford).apply([0.2, 0.4, 0.8]);
    near(light(&wide), want, 1e-6);
    assert_eq!((photo(&wide).space, photo(&wide).pixels[0]), (Some(p3), [0.2, 0.4, 0.8]));
    let wide = with_chunks(&bare, &[gama(100_000), chrm(&p3)]);
    near(light(&wide), want, 1e-6);
    assert!(photo(&wide).notes.is_empty());
    // Black and white of video.
    let narrow = with_chunks(&bare_png([4096, 60_160, 32_128]), &[video([1, 8, 0, 0])]);
    near(light(&narrow), [0.0, 1.0, 0.5], 1e-5);
    // 58 % of a PQ signal is 203 cd/m2.
    let bright = with_chunks(&bare_png([38_052, 65_535, 0]), &[video([1, 16, 0, 1])]);
    near(light(&bright), [1.0, 10_000.0 / 203.0, 0.0], 1e-3);
}

#[test]
fn what_of_a_png_cannot_be_honoured_is_told() {
    let bare = bare_png([13_107, 26_214, 52_428]);
    let flat = RgbSpace { primaries: [Space::Srgb.rgb().white; 3], white: Space::Srgb.rgb().white };
    for (chunks, told) in [
        (vec![(*b"cICP", vec![2, 2, 0, 1])], "its cICP is not honoured: the curve 2"),
        (vec![(*b"iCCP", b"name\0\0rubbish".to_vec())], "its ICC profile is not honoured: it is damaged"),
        (vec![gama(3)], "its gAMA makes no sense"),
        (vec![chrm(&flat)], "its cHRM makes no sense"),
    ] {
        let photo = photo(&with_chunks(&bare, &chunks));
        assert!(photo.notes.iter().any(|n| n.starts_with(told)), "{:?}", photo.notes);
        near(photo.pixels[0], [0.033_104_8, 0.132_868_3, 0.603_827_3], 1e-6);
    }
}

/// A matrix and curves, whose columns are seen under D50.
#[test]
fn a_png_is_of_the_colours_of_its_icc_profile() {
    let mut profile = vec![0; 128];
    profile[16..24].copy_from_slice(b"RGB XYZ ");
    profile.extend(6_u32.to_be_bytes());
    // Columns of Adobe RGB (1998), and a gamma of 563/256.
    let columns: [[u32; 3]; 3] =
        [[0x9c18, 0x4fa5, 0x04fc], [0x348d, 0xa02c, 0x0f95], [0x2631, 0x102f, 0xbe9c]];
    let data = 132 + 72;
    for (k, name) in [b"rXYZ", b"gXYZ", b"bXYZ"].into_iter().enumerate() {
        profile
            .extend([name.as_slice(), &(data + 20 * k as u32).to_be_bytes(), &20_u32.to_be_bytes()].concat());
    }
    for name in [b"rTRC", b"gTRC", b"bTRC"] {
        profile.extend([name.as_slice(), &(data + 60).to_be_bytes(), &14_u32.to_be_bytes()].concat());
    }
    for column in columns {
        profile.extend(b"XYZ \0\0\0\0");
        profile.extend(column.map(u32::to_be_bytes).concat());
    }
    profile.extend(b"curv\0\0\0\0\0\0\0\x01\x02\x33");
    // Deflate without compression.
    let length = profile.len() as u16;
    let (mut a, mut b) = (1_u32, 0_u32);
    for byte in &profile {
        a = (a + u32::from(*byte)) % 65_521;
        b = (b + a) % 65_521;
    }
    let mut chunk = b"Adobe RGB\0\0\x78\x01\x01".to_vec();
    chunk.extend([length.to_le_bytes(), (!length).to_le_bytes()].concat());
    chunk.extend(&profile);
    chunk.extend((b << 16 | a).to_be_bytes());
    let bytes = with_chunks(&bare_png([0, 65_535, 0]), &[(*b"iCCP", chunk), gama(100_000)]);
    let photo = photo(&bytes);
    assert_eq!((photo.notes.len(), photo.pixels[0]), (0, [0.0, 1.0, 0.0]));
    // Its green has the place 0.21, 0.71 under D65.
    let space = photo.space.unwrap();
    assert!(
        (space.primaries[1].x - 0.21).abs() < 1e-3 && (space.primaries[1].y - 0.71).abs() < 1e-3,
        "{space:?}"
    );
    near(light(&bytes), [-0.398_3, 1.0, -0.042_9], 2e-3);
}

#[test]
fn a_png_of_straal_comes_back_as_it_was() {
    for curve in [png::Curve::Gamma(1.0), png::Curve::Gamma(2.2), png::Curve::Srgb, png::Curve::Gamma(0.5)] {
        let mut bytes = Vec::new();
        let pixels = [[13_107, 26_214, 52_428]];
        let encoded =
            png::Encoded { width: 1, height: 1, pixels: png::Pixels::Sixteen(&pixels), curve, metadata: &[] };
        png::write(&mut bytes, &encoded).unwrap();
        let photo = photo(&bytes);
        let gamma = match curve {
            png::Curve::Gamma(gamma) => f64::from(gamma),
            png::Curve::Srgb => {
                near(photo.pixels[0], [0.033_104_8, 0.132_868_3, 0.603_827_3], 1e-6);
                continue;
            }
        };
        near(photo.pixels[0], [0.2_f64, 0.4, 0.8].map(|v| pow_d(v, gamma)), 1e-5);
        let Some(png::Curve::Gamma(told)) = photo.encoding.unwrap().curve else { panic!() };
        assert!((f64::from(told) - gamma).abs() < 1e-4 * gamma);
    }
}

fn radiance(lines: &str) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\n{lines}FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n").into_bytes();
    bytes.extend([128, 64, 32, 129]);
    bytes
}

#[test]
fn an_hdr_has_the_primaries_and_corrections_that_it_says() {
    assert_eq!(light(&radiance("")), [1.0, 0.5, 0.25]);
    // ProPhoto's, whose white is D50.
    let pro_photo = "PRIMARIES=0.734699 0.265301 0.159597 0.840403 0.036598 0.000105 0.345704 0.35854\n";
    near(light(&radiance(pro_photo)), [1.594, 0.386, 0.205], 1e-3);
    let srgb = "PRIMARIES= 0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\n";
    assert_eq!(light(&radiance(srgb)), [1.0, 0.5, 0.25]);
    let corrected = "COLORCORR=2 1 0.5\nEXPOSURE=2\nCOLORCORR= 1 0.5 1\n";
    assert_eq!(light(&radiance(corrected)), [0.25, 0.5, 0.25]);
    for (line, told) in [
        ("PRIMARIES=1 2 3\n", "line 2: expected x and y of red, green, blue and white, found '1 2 3'"),
        ("COLORCORR=1 0 1\n", "line 2: expected three factors of red, green and blue, found '1 0 1'"),
        ("COLORCORR=1e300 1 1\nEXPOSURE=1e300\n", "the exposures and corrections multiply to no number"),
    ] {
        assert_eq!(hdr::read(&radiance(line), &Limits::default()).unwrap_err().to_string(), told);
    }
    // Noughts are what programs write that know none.
    assert!(photo(&radiance("PRIMARIES=0 0 0 0 0 0 0 0\n")).notes.is_empty());
    let odd = photo(&radiance("PRIMARIES=1 1 1 1 1 1 1 1\nGAMMA=2.2\n"));
    assert_eq!((odd.space, odd.notes.len()), (None, 2), "{:?}", odd.notes);
}

#[test]
fn luminance_and_chroma_become_colours() {
    let mut picture = exr::Layered::of_size(1, 1);
    for (space, weights) in
        [(None, [0.212_639, 0.715_169, 0.072_192]), (Some(Space::Rec2020), [0.2627, 0.678, 0.0593])]
    {
        let y: f64 = [1.0, 2.0, 3.0].iter().zip(weights).map(|(c, w)| c * w).sum();
        let channel = |(name, v): (&str, f64)| exr::Channel { name: name.into(), samples: vec![v as f32] };
        let channels = [("Y", y), ("RY", 1.0 / y - 1.0), ("BY", 3.0 / y - 1.0)].map(channel);
        picture.layers = vec![exr::Layer { name: String::new(), channels: channels.into() }];
        picture.space = space.map(Space::rgb);
        let mut bytes = Vec::new();
        exr::write(&mut bytes, &picture).unwrap();
        near(photo(&bytes).pixels[0], [1.0, 2.0, 3.0], 1e-3);
    }
}
