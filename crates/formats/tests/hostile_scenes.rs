//! Scenes that are cut off, damaged, made of noise or made to harm end in a scene or in complaints: quickly, in little
//! memory, and without a panic.

mod common {
    pub mod budget;
}

use std::path::Path;
use std::time::{Duration, Instant};

use common::budget::{Counted, peak};
use straal_formats::{Diagnostics, Loaded, Options, load_bytes};

#[global_allocator]
static ALLOCATOR: Counted = Counted;

/// PCG-XSH-RR (O'Neill 2014), so that every run breaks the same bytes.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u32 {
        let state = self.0;
        self.0 = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let shifted = (((state >> 18) ^ state) >> 27) as u32;
        shifted.rotate_right((state >> 59) as u32)
    }

    fn below(&mut self, n: usize) -> usize {
        self.next() as usize % n
    }
}

/// What reading took.
struct Taken {
    result: Result<Loaded, Diagnostics>,
    bytes: usize,
    time: Duration,
}

fn read(bytes: &[u8]) -> Taken {
    let start = Instant::now();
    let (result, bytes) = peak(|| {
        let result = load_bytes("scene.yaml", bytes, Path::new("tests/data"), &Options::default());
        // What is said is read as well.
        let text = match &result {
            Ok(loaded) => loaded.warnings.to_string(),
            Err(complaints) => {
                assert!(complaints.has_errors());
                complaints.to_string()
            }
        };
        assert!(result.is_ok() || text.contains("error: "), "{text}");
        result
    });
    Taken { result, bytes, time: start.elapsed() }
}

/// Reads what is no longer than a few kilobytes.
fn small(bytes: &[u8]) -> bool {
    let taken = read(bytes);
    let shown = || String::from_utf8_lossy(bytes).into_owned();
    assert!(taken.bytes < 16 << 20, "{} bytes for:\n{}", taken.bytes, shown());
    assert!(taken.time < Duration::from_secs(5), "{:?} for:\n{}", taken.time, shown());
    taken.result.is_ok()
}

/// An error whose text contains `says`, in at most `bytes` bytes.
fn refused(what: &str, text: &str, says: &str, bytes: usize) {
    let taken = read(text.as_bytes());
    let complaints = taken.result.err().unwrap_or_else(|| panic!("{what} was taken"));
    let found = complaints.to_string();
    assert!(found.contains(says), "{what}: {found}");
    assert!(found.len() < 1 << 20, "{what}: {} bytes of complaints", found.len());
    assert!(taken.bytes < bytes, "{what}: {} bytes", taken.bytes);
    assert!(taken.time < Duration::from_secs(20), "{what}: {:?}", taken.time);
}

// One test, since memory is counted for the whole process.
#[test]
fn hostile_scenes_end_in_complaints() {
    let whole = std::fs::read("tests/data/everything.yaml").unwrap();
    assert!(small(&whole), "the scene to break is sound");
    let cases = cut(&whole) + flipped(&whole) + spliced(&whole) + noise();
    assert!(cases > 6000, "only {cases} cases");
    made_to_harm();
}

/// Every length.
fn cut(whole: &[u8]) -> usize {
    let sound = (0..whole.len()).filter(|&end| small(&whole[..end])).count();
    // Cut within the list of lights, or of shapes, it may be a smaller scene.
    assert!(sound < whole.len() / 2, "{sound} of {} beginnings are taken for scenes", whole.len());
    whole.len()
}

fn flipped(whole: &[u8]) -> usize {
    let mut random = Random(1);
    const CASES: usize = 2000;
    for i in 0..CASES {
        let mut bytes = whole.to_vec();
        for _ in 0..1 + i % 4 {
            let at = random.below(bytes.len());
            bytes[at] ^= 1 << random.below(8);
        }
        small(&bytes);
    }
    CASES
}

/// Pieces of itself, and bytes that mean something to YAML, in the wrong places.
fn spliced(whole: &[u8]) -> usize {
    let mut random = Random(2);
    const CASES: usize = 1500;
    let marks = b"[]{},:-*&!|>'\"%@`#?\n\t \0\xff.~<0";
    for _ in 0..CASES {
        let mut bytes = whole.to_vec();
        for _ in 0..1 + random.below(5) {
            let at = random.below(bytes.len());
            if random.below(2) == 0 {
                bytes.insert(at, marks[random.below(marks.len())]);
            } else {
                let from = random.below(whole.len());
                let length = random.below(40);
                let piece =
                    &whole[from..if from + length < whole.len() { from + length } else { whole.len() }];
                let until = at + random.below(bytes.len() - at);
                let until = if until - at > 40 { at + 40 } else { until };
                bytes.splice(at..until, piece.iter().copied());
            }
        }
        small(&bytes);
    }
    CASES
}

/// Bytes, then letters, that mean nothing.
fn noise() -> usize {
    let mut random = Random(3);
    const CASES: usize = 1000;
    let letters = b"ab: -\n  [{}],'\"&*12.e#|>?!%";
    for i in 0..CASES {
        let length = random.below(300);
        let mut byte = || if i % 2 == 0 { random.next() as u8 } else { letters[random.below(letters.len())] };
        let bytes: Vec<u8> = (0..length).map(|_| byte()).collect();
        small(&bytes);
    }
    CASES
}

fn made_to_harm() {
    const MB: usize = 1 << 20;
    let nest = |open: &str, close: &str, n: usize| format!("world: {}{}", open.repeat(n), close.repeat(n));
    refused("deep lists", &nest("[", "]", 10_000), "deep", 64 * MB);
    refused("deep mappings", &nest("{a: ", "}", 10_000), "deep", 64 * MB);
    refused("deep lists that never end", &nest("[", "", 200), "deep", 64 * MB);
    let dashes = format!("world:\n {}", "- ".repeat(10_000));
    refused("deep blocks", &dashes, "deep", 64 * MB);
    let mut steps = String::from("world:\n");
    for level in 0..300 {
        steps += &format!("{}a:\n", " ".repeat(level + 1));
    }
    refused("deep block mappings", &steps, "deep", 64 * MB);
    let groups = |n: usize| {
        let open = "{group: {children: [".repeat(n);
        format!(
            "camera: {{perspective: {{eye: [0, 0, 1], look_at: [0, 0, 0]}}}}\nworld: [{open}sphere{}]",
            "]}}".repeat(n)
        )
    };
    assert!(small(groups(30).as_bytes()), "thirty groups are no harm");
    refused("deep groups", &groups(80), "deep", 64 * MB);

    let mut laughs = String::from("a: &a [0, 0, 0, 0, 0, 0, 0, 0, 0, 0]\n");
    for (name, of) in ('b'..='z').zip('a'..='y') {
        laughs += &format!("{name}: &{name} [{}]\n", vec![format!("*{of}"); 10].join(", "));
    }
    refused("billion laughs", &laughs, "more than 5000000 values", 1024 * MB);
    let words = format!("a: &a {}\nworld: [{}]", "x".repeat(100_000), "*a, ".repeat(100_000));
    refused("a long word many times", &words, "more than 5000000 values", 1024 * MB);

    let many = format!("world: [{}]", "{x: 1}, ".repeat(200_000));
    refused("many errors", &many, "and ", 512 * MB);
    let keys: String = (0..100_000).map(|i| format!("key{i}: 1\n")).collect();
    refused("many keys", &keys, "unknown key", 512 * MB);
    let mut names = String::from("objects:\n");
    for i in 0..20_000 {
        names += &format!("  a{i}: {{ instance: {{ of: a{} }} }}\n", i + 1);
    }
    refused("a long chain of objects", &names, "deeper than 8", 512 * MB);
    let dangling: String = (0..20_000).map(|i| format!("  - instance: {{ of: b{i} }}\n")).collect();
    refused("many names", &format!("{names}world:\n{dangling}"), "no object named", 512 * MB);
    let long = format!("world: [sphere: {{ {}: 1 }}]", "k".repeat(5_000_000));
    refused("a long key", &long, "error", 512 * MB);
    refused("a long line", &format!("world: [{}", " ".repeat(5_000_000)), "YAML", 512 * MB);
    refused("open brackets", &"[".repeat(1_000_000), "error", 512 * MB);
    refused("open quotes", &"'\"".repeat(500_000), "error", 512 * MB);
    refused("question marks", &"? ".repeat(300_000), "error", 512 * MB);
    refused("colons", &": ".repeat(300_000), "error", 512 * MB);
    refused("anchors", &"&a ".repeat(300_000), "error", 512 * MB);
    let device =
        "lights: [environment: { file: /dev/zero }]\nworld: [mesh: { file: /dev/stdin }, mesh: { file: / }]";
    refused("devices", device, "cannot read", 64 * MB);
}
