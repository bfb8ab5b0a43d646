//! Files that are cut off, damaged or made up: a reader answers with a result, in little memory and time.
//!
//! Every sample is a small valid file. It is cut at every length, bits are flipped, numbers are overwritten with
//! the extremes that sizes and offsets are attacked with, and noise follows a right beginning. A case fails when
//! the reader panics, holds more than 64 MiB at once, or takes more than a few seconds.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use straal_formats::Limits;
use straal_formats::image::{self, exr, hdr, pfm, png};
use straal_formats::mesh::{mtl, obj, ply};
use straal_scene::Image;

const MEMORY: usize = 64 << 20;
/// Far more than any case takes, as the machine may be busy; a loop that never ends is still found.
const TIME: Duration = Duration::from_secs(10);

/// The system's allocator, with count of what this thread holds and has held at most.
struct Counting;

thread_local! {
    static HELD: Cell<usize> = const { Cell::new(0) };
    static MOST: Cell<usize> = const { Cell::new(0) };
}

impl Counting {
    fn add(size: usize) {
        let held = HELD.get().wrapping_add(size);
        HELD.set(held);
        if held < usize::MAX / 2 && held > MOST.get() {
            MOST.set(held);
        }
    }
}

// SAFETY: every call is handed to the system's allocator as it is; counting doesn't allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        Self::add(layout.size());
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        Self::add(layout.size());
        // SAFETY: the caller keeps the contract of `alloc_zeroed`.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.set(HELD.get().wrapping_sub(layout.size()));
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Random numbers from a fixed seed: SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
}

/// Reads one damaged file under the budgets.
fn attempt<T, E>(name: &str, case: &str, file: &[u8], read: &impl Fn(&[u8]) -> Result<T, E>) {
    let before = HELD.get();
    MOST.set(before);
    let start = Instant::now();
    let outcome = catch_unwind(AssertUnwindSafe(|| drop(read(file))));
    let (held, took) = (MOST.get() - before, start.elapsed());
    let shown = String::from_utf8_lossy(&file[..file.len().min(300)]).into_owned();
    assert!(outcome.is_ok(), "{name}, {case}: the reader panicked at {file:?}\n{shown}");
    assert!(held <= MEMORY, "{name}, {case}: {held} bytes were held for a file of {}\n{shown}", file.len());
    assert!(took <= TIME, "{name}, {case}: it took {took:?}\n{shown}");
}

/// Storms a reader with damaged copies of a file that it can read, and tells how many they were.
fn storm<T, E: std::fmt::Display>(name: &str, sample: &[u8], read: impl Fn(&[u8]) -> Result<T, E>) -> usize {
    if let Err(error) = read(sample) {
        panic!("{name}: the sample itself is refused: {error}");
    }
    let mut random =
        Random(name.bytes().fold(7, |seed, byte| seed.wrapping_mul(31).wrapping_add(u64::from(byte))));
    let mut cases = 0;
    let mut attempt = |case: &str, file: &[u8]| {
        attempt(name, case, file, &read);
        cases += 1;
    };
    for length in 0..sample.len() {
        attempt("cut", &sample[..length]);
    }
    for _ in 0..400 {
        let mut file = sample.to_vec();
        for _ in 0..1 + random.below(4) {
            let at = random.below(file.len());
            file[at] ^= 1 << random.below(8);
        }
        attempt("bits flipped", &file);
    }
    for _ in 0..400 {
        let mut file = sample.to_vec();
        let extremes =
            [[0; 4], [255; 4], [255, 255, 255, 127], [127, 255, 255, 255], [0, 0, 0, 128], [0, 0, 1, 0]];
        let extreme = extremes[random.below(extremes.len())];
        let at = random.below(file.len());
        let count = (1 + random.below(4)).min(file.len() - at);
        file[at..at + count].copy_from_slice(&extreme[..count]);
        attempt("numbers overwritten", &file);
    }
    for _ in 0..200 {
        let mut file = sample.to_vec();
        let (a, b) = (random.below(file.len()), random.below(file.len()));
        if random.below(2) == 0 {
            file.drain(a.min(b)..a.max(b));
        } else {
            let piece = file[a.min(b)..a.max(b)].to_vec();
            file.splice(a..a, piece);
        }
        attempt("pieces moved", &file);
    }
    // Digits where text has digits: sizes that no file can hold.
    for _ in 0..200 {
        let mut file = sample.to_vec();
        let digits: Vec<usize> = (0..file.len()).filter(|&i| file[i].is_ascii_digit()).collect();
        if !digits.is_empty() {
            let at = digits[random.below(digits.len())];
            let numbers: [&[u8]; 6] =
                [b"99999999999999999999", b"4294967295", b"2147483648", b"-1", b"65536", b"1e999"];
            file.splice(at..=at, numbers[random.below(numbers.len())].iter().copied());
        }
        attempt("digits replaced", &file);
    }
    for _ in 0..200 {
        let mut file = sample[..random.below(sample.len().min(64))].to_vec();
        let noise = random.below(2000);
        file.extend((0..noise).map(|_| random.next() as u8));
        attempt("noise", &file);
    }
    cases
}

fn ply_header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment c\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar a\nproperty list uchar short b\nelement face 2\nproperty list uchar int vertex_indices\n\
         element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    )
}

fn ply_binary(format: &str, big: bool) -> Vec<u8> {
    let mut file = ply_header(format).into_bytes();
    let mut put = |bytes: &[u8]| {
        if big {
            file.extend(bytes.iter().rev());
        } else {
            file.extend(bytes);
        }
    };
    for p in [[0f32, 0., 0.], [2., 1., 0.], [0., 2., 0.], [0.5, 1., 0.], [1., 1., 1.], [3., 3., 3.]] {
        p.iter().for_each(|v| put(&v.to_le_bytes()));
        put(&[7]);
        put(&[1]);
        put(&300i16.to_le_bytes());
    }
    for face in [[0, 1, 2].as_slice(), &[0, 1, 2, 3]] {
        put(&[face.len() as u8]);
        face.iter().for_each(|v: &i32| put(&v.to_le_bytes()));
    }
    [5i32, 0, 1, 2, -1, 4].iter().for_each(|v| put(&v.to_le_bytes()));
    file
}

#[test]
fn meshes() {
    let limits = Limits::default();
    let read_ply = |bytes: &[u8]| ply::read(bytes, &limits);
    let ascii = ply_header("ascii")
        + "0 0 0 7 1 300\n2 1 0 7 0\n0 2 0 7 2 -1 2\n.5 1 0 7 0\n1 1 1 7 0\n3 3 3 7 0\n3 0 1 2\n4 0 1 2 3\n5 0 1 2 -1 4\n";
    let paints = b"newmtl red\nKd 1 .5 0\nKe 1 1 1\nNs 10\nd -halo .5\nillum 2\nmap_Kd -s 1 1 a.png\nnewmtl two\nTr .1\n";
    let model = b"mtllib a.mtl\no one\nv 0 0 0\nv 2 1 0 1\nv 0 2 0\nv .5 1e0 0\nvt 0 0\nvt 1 1\nvn 0 0 1\nusemtl red\n\
        f 1/1/1 2/2/1 3/1/1 4\ng two\nusemtl blue\nf -4//-1 -3//-1 \\\n -2//-1\ns 1\nl 1 2\n";
    let cases = storm("ply, ascii", ascii.as_bytes(), read_ply)
        + storm("ply, little", &ply_binary("binary_little_endian", false), read_ply)
        + storm("ply, big", &ply_binary("binary_big_endian", true), read_ply)
        + storm("obj", model, |bytes| obj::read(bytes, &limits, &mut |_| Some(paints.to_vec())))
        + storm("mtl", paints, |bytes| mtl::read(bytes, &limits));
    assert!(cases > 6000, "{cases}");
}

/// A small picture with runs and noise in it.
fn picture(width: usize, height: usize) -> Image {
    let mut random = Random(5);
    let pixels = (0..width * height)
        .map(|i| {
            if i % width < width / 2 {
                [0.5, 0.25, 2.0]
            } else {
                [0; 3].map(|_| random.below(1000) as f32 / 256.0)
            }
        })
        .collect();
    Image { width, height, pixels }
}

#[test]
fn pictures() {
    let limits = Limits::default();
    let image = picture(12, 5);
    let mut float_map = Vec::new();
    pfm::write(&mut float_map, &image).unwrap();
    let pixels: Vec<[u8; 3]> = image.pixels.iter().map(|p| p.map(|v| (v * 60.0) as u8)).collect();
    let metadata = [("Software".to_string(), "straal".to_string())];
    let mut encoded = Vec::new();
    png::write(
        &mut encoded,
        &png::Encoded {
            width: 12,
            height: 5,
            pixels: png::Pixels::Eight(&pixels),
            curve: png::Curve::Srgb,
            metadata: &metadata,
        },
    )
    .unwrap();
    let mut radiance = b"#?RADIANCE\nEXPOSURE=1.5\nCOLORCORR=1 0.9 1\nPRIMARIES=0.7 0.3 0.2 0.7 0.1 0.1 0.31 0.33\nFORMAT=32-bit_rle_rgbe\n\n-Y 3 +X 12\n".to_vec();
    for component in 0..4 {
        if component == 0 {
            radiance.extend([2, 2, 0, 12]);
        }
        radiance.extend([128 + 6, 40 + component, 6, 1, 2, 3, 4, 5, 129]);
    }
    radiance.extend([9, 8, 7, 129, 1, 1, 1, 11]);
    radiance.extend([10, 20, 30, 128].repeat(12));
    let read = |bytes: &[u8]| image::read(bytes, &limits);
    let cases = storm("pfm", &float_map, |bytes| pfm::read(bytes, &limits))
        + storm("hdr", &radiance, |bytes| hdr::read(bytes, &limits))
        + storm("png", &encoded, |bytes| png::read(bytes, &limits))
        + storm("any picture", &radiance, read);
    assert!(cases > 5000, "{cases}");
}

/// Pictures that other programs made, as textures take them.
#[test]
fn pictures_of_codes() {
    let limits = Limits { max_pixels: 1 << 20, ..Limits::default() };
    let mut cases = 0;
    for name in [
        "steps-runs.tga",
        "steps-runs.bmp",
        "steps-alpha.webp",
        "steps-lossy.webp",
        "steps-progressive.jpg",
        "steps-cmyk.jpg",
    ] {
        let sample = std::fs::read(format!("../../tests/pictures/{name}")).unwrap();
        cases += storm(name, &sample, |bytes| image::bitmap(bytes, &limits));
    }
    assert!(cases > 6000, "{cases}");
}

/// The same picture in every way that the `exr` crate can write it, besides our own.
#[test]
fn openexr() {
    use ::exr::prelude::{
        AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image as Exr, Layer,
        LayerAttributes, LineOrder, Vec2, WritableImage, f16,
    };
    let limits = Limits::default();
    let read = |bytes: &[u8]| exr::read(bytes, &limits);
    let image = picture(20, 18);
    let mut own = exr::Layered::of_size(20, 18);
    own.layers.push(exr::Layer::from_rgb("", &image.pixels));
    own.metadata.push(("straal.version".into(), "0.1".into()));
    let mut bytes = Vec::new();
    exr::write(&mut bytes, &own).unwrap();
    let mut cases = storm("exr, own", &bytes, read);
    for (compression, blocks) in [
        (Compression::Uncompressed, Blocks::Tiles(Vec2(16, 16))),
        (Compression::RLE, Blocks::ScanLines),
        (Compression::ZIP1, Blocks::ScanLines),
        (Compression::ZIP16, Blocks::Tiles(Vec2(8, 8))),
        (Compression::PIZ, Blocks::ScanLines),
        (Compression::PXR24, Blocks::ScanLines),
        (Compression::PIZ, Blocks::Tiles(Vec2(16, 16))),
    ] {
        let red: Vec<f32> = image.pixels.iter().map(|pixel| pixel[0]).collect();
        let green = image.pixels.iter().map(|pixel| f16::from_f32(pixel[1])).collect();
        let ids = (0..360).collect();
        let channels = AnyChannels::sort(
            [
                AnyChannel::new("R", FlatSamples::F32(red)),
                AnyChannel::new("G", FlatSamples::F16(green)),
                AnyChannel::new("id", FlatSamples::U32(ids)),
            ]
            .into_iter()
            .collect(),
        );
        let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
        let layer = Layer::new(Vec2(20, 18), LayerAttributes::named("beauty"), encoding, channels);
        let mut bytes = std::io::Cursor::new(Vec::new());
        Exr::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
        cases += storm(&format!("exr, {compression}"), &bytes.into_inner(), read);
    }
    assert!(cases > 15_000, "{cases}");
}
