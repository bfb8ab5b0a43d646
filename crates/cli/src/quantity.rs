//! Quantities as they are typed on the command line, and as people read them.

use std::str::FromStr;
use std::time::Duration;
use straal::Recording;
use straal::studio::Background;
use straal_scene::desc::SpectralChannels;
use straal_scene::value::LinearRgb;
use straal_study::points::Map;

/// Width and height in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub [u32; 2]);

/// Left, top, right and bottom in pixels, the last two exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop(pub [u32; 4]);

/// An angle between two faces in degrees.
pub fn crease(typed: &str) -> Result<f64, String> {
    let degrees = typed.trim().trim_end_matches('°').parse::<f64>().ok();
    degrees.filter(|d| (0.0..=180.0).contains(d)).ok_or_else(|| "write degrees from 0 to 180".to_owned())
}

/// `studio`, `none`, a colour in hexadecimal or one of the names that need no table.
pub fn background(typed: &str) -> Result<Background, String> {
    let paper = |grey: f64| Ok(Background::Paper(LinearRgb::grey(grey)));
    match typed.trim().to_ascii_lowercase().as_str() {
        "studio" => Ok(Background::Sweep),
        "none" | "transparent" => Ok(Background::Nothing),
        // The whitest and blackest papers there are.
        "white" => paper(0.95),
        "grey" | "gray" => paper(0.25),
        "black" => paper(0.02),
        other => LinearRgb::from_hex(other).map(Background::Paper).ok_or_else(|| {
            "write studio, none, white, grey, black or a colour in hexadecimal in quotes, such as '#4060a0'".to_owned()
        }),
    }
}

/// The longest time that can be asked for: a year, far inside of what clocks can count.
const LONGEST: f64 = 365.0 * 86400.0;

/// A time such as `90s`, `1.5h`, `1h30m` or `500ms`.
pub fn duration(typed: &str) -> Result<Duration, String> {
    const HINT: &str = "write a number with a unit: 500ms, 90s, 2m, 1h30m";
    let mut seconds = 0.0;
    let mut rest = typed.trim();
    if rest.is_empty() {
        return Err(HINT.into());
    }
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let (number, tail) = rest.split_at(digits);
        let letters = tail.find(|c: char| !c.is_alphabetic()).unwrap_or(tail.len());
        let (unit, tail) = tail.split_at(letters);
        let number: f64 = number.parse().map_err(|_| HINT.to_string())?;
        seconds += number
            * match unit {
                "ms" => 1e-3,
                "s" => 1.0,
                "m" | "min" => 60.0,
                "h" => 3600.0,
                "" => {
                    return Err(format!(
                        "{typed} of what? write {typed}s for seconds or {typed}m for minutes"
                    ));
                }
                _ => return Err(format!("unknown unit `{unit}`; {HINT}")),
            };
        rest = tail.trim_start();
    }
    if seconds > LONGEST {
        return Err("longer than a year".into());
    }
    if seconds <= 0.0 {
        return Err("no time at all".into());
    }
    Ok(Duration::from_secs_f64(seconds))
}

/// In which numbers a film takes light: `rgb`, `xyz`, `spectral`, `spectral:40` or `spectral:40:400:700`.
pub fn recording(typed: &str) -> Result<Recording, String> {
    let mut parts = typed.split(':');
    let kind = parts.next().unwrap_or_default();
    let numbers: Vec<&str> = parts.collect();
    match (kind, numbers.as_slice()) {
        ("rgb", []) => Ok(Recording::Rgb),
        ("xyz", []) => Ok(Recording::Xyz),
        ("spectral", [] | [_] | [_, _, _]) => {
            const HINT: &str = "write spectral:BANDS or spectral:BANDS:FROM:TO, at least 2 bands of 1 nm or more within 360 to \
                                830 nm";
            let mut bands = SpectralChannels::default();
            if let [count, range @ ..] = numbers.as_slice() {
                bands.bands = count.parse().map_err(|_| HINT)?;
                if let [from, to] = range {
                    bands.from = from.parse().map_err(|_| HINT)?;
                    bands.to = to.parse().map_err(|_| HINT)?;
                }
            }
            bands.bands().map(Recording::Spectral).ok_or_else(|| HINT.into())
        }
        _ => Err("expected rgb, xyz, spectral, or spectral:BANDS".into()),
    }
}

/// Two of the numbers of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimensions(pub [usize; 2]);

/// Two different numbers from 0 to 3 such as `0,1`.
pub fn dimensions(typed: &str) -> Result<Dimensions, String> {
    let numbers: Option<Vec<usize>> = typed.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y]) if x < 4 && y < 4 && x != y => Ok(Dimensions([x, y])),
        _ => Err("write two different numbers from 0 to 3, such as 0,1".into()),
    }
}

/// What points of the unit square are mapped to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape(pub Map);

/// A shape such as `disc`, `hemisphere:e=10` or `cone:degrees=20`.
pub fn shape(typed: &str) -> Result<Shape, String> {
    let (name, parameter) = typed.split_once(':').map_or((typed, None), |(n, p)| (n, Some(p)));
    let number = |key: &str, absent: f32, most: f32| match parameter {
        None => Ok(absent),
        Some(p) => p
            .strip_prefix(key)
            .and_then(|p| p.strip_prefix('='))
            .and_then(|p| p.parse::<f32>().ok())
            .filter(|v| (0.0..=most).contains(v))
            .ok_or_else(|| format!("write {name}:{key}=NUMBER, the number from 0 to {most}")),
    };
    let map = match name {
        "hemisphere" => Map::Hemisphere(number("e", 1.0, 1e4)?),
        "cone" => match number("degrees", 30.0, 180.0)? {
            0.0 => return Err("a cone of 0 degrees holds no directions".into()),
            degrees => Map::Cone(degrees),
        },
        _ if parameter.is_some() => return Err(format!("{name} has no parameters")),
        "square" => Map::Square,
        "disc" => Map::Disc,
        "sphere" => Map::Sphere,
        "triangle" => Map::Triangle,
        _ => return Err("it is one of square, disc, hemisphere, sphere, triangle, cone".into()),
    };
    Ok(Shape(map))
}

/// A part of one such as `2%` or `0.02`.
pub fn noise(typed: &str) -> Result<f64, String> {
    let (number, unit) = typed.trim().strip_suffix('%').map_or((typed.trim(), 1.0), |n| (n.trim(), 0.01));
    match number.parse::<f64>().map(|n| n * unit) {
        Ok(part) if part > 0.0 && part < 1.0 => Ok(part),
        _ => Err("write a relative error above 0 and below 100%, such as 2% or 0.02".into()),
    }
}

/// A size such as `640x360`.
pub fn size(typed: &str) -> Result<Size, String> {
    let numbers: Option<Vec<u32>> = typed.split(['x', 'X', '×']).map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[width, height]) if width > 0 && height > 0 => Ok(Size([width, height])),
        _ => Err("write width and height in pixels, such as 640x360".into()),
    }
}

/// A crop such as `100,50,200,120`.
pub fn crop(typed: &str) -> Result<Crop, String> {
    let numbers: Option<Vec<u32>> = typed.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok(Crop([x0, y0, x1, y1])),
        Some(&[_, _, _, _]) => Err("empty: left must be less than right, and top less than bottom".into()),
        _ => Err("write left,top,right,bottom in pixels, such as 100,50,200,120".into()),
    }
}

/// Samples of each pixel: the first, and one past the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples(pub [u32; 2]);

/// Samples such as `64..128`.
pub fn samples(typed: &str) -> Result<Samples, String> {
    let numbers =
        typed.split_once("..").and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    match numbers {
        Some([first, end]) if first < end => Ok(Samples([first, end])),
        Some(_) => Err("none: the first must be less than the end, which isn't one of them".into()),
        // What other renderers call the number of samples.
        None if typed.trim().parse::<u64>().is_ok() => Err(format!(
            "samples per pixel are `--spp {}`; this is for a part of them, such as 64..128",
            typed.trim()
        )),
        None => Err("write the first, from 0, and one past the last, such as 64..128".into()),
    }
}

/// Frames of a scene that moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frames {
    /// As many as the scene has.
    All,
    /// From one up to another, which isn't one of them.
    Some([u32; 2]),
}

/// Frames such as `0..48`, or `all`.
pub fn frames(typed: &str) -> Result<Frames, String> {
    if typed.eq_ignore_ascii_case("all") {
        return Ok(Frames::All);
    }
    let numbers =
        typed.split_once("..").and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    match numbers {
        Some([first, end]) if first < end => Ok(Frames::Some([first, end])),
        Some(_) => Err("none: the first must be less than the end, which isn't one of them".into()),
        None if typed.trim().parse::<f64>().is_ok() => {
            Err(format!("a single frame is `--frame {}`; this is for several, such as 0..48", typed.trim()))
        }
        None => Err("write the first, and one past the last, such as 0..48; or all".into()),
    }
}

/// A frame of a scene that moves; what lies between two is one as well.
pub fn frame(typed: &str) -> Result<f64, String> {
    match typed.trim().parse::<f64>() {
        Ok(frame) if (0.0..=MOST_FRAME).contains(&frame) => Ok(frame),
        _ if typed.contains("..") => Err(format!("several frames are `--frames {typed}`")),
        _ => Err(format!("a frame is a number from 0 to {MOST_FRAME}")),
    }
}

/// The last frame that can be asked for.
const MOST_FRAME: f64 = 1e9;

/// How often something is done, if at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Every(pub Option<Duration>);

/// A time such as `60s`, or `off`.
pub fn checkpoint(typed: &str) -> Result<Every, String> {
    if typed.eq_ignore_ascii_case("off") {
        return Ok(Every(None));
    }
    duration(typed).map(|time| Every(Some(time))).map_err(|e| format!("{e}; or off"))
}

/// Degrees from edge to edge.
pub fn field_of_view(typed: &str) -> Result<f64, String> {
    let degrees = typed.parse().ok().filter(|v: &f64| *v > 0.0 && *v < 180.0);
    degrees.ok_or_else(|| "expected degrees between 0 and 180".to_owned())
}

/// Samples per pixel.
pub fn spp(typed: &str) -> Result<u32, String> {
    within(typed, 1, straal::MAX_SAMPLES)
}

/// A number of independent sets of samples.
pub fn replicates(typed: &str) -> Result<u32, String> {
    within(typed, 2, 10_000)
}

/// A number of edges of a path.
pub fn depth(typed: &str) -> Result<u32, String> {
    at_least_one(typed)
}

/// The seed of random numbers.
pub fn seed(typed: &str) -> Result<u64, String> {
    typed.parse().map_err(|_| "write a whole number, 0 or greater, of at most 19 digits".to_owned())
}

/// The most that light may bring.
pub fn clamp(typed: &str) -> Result<f64, String> {
    let wrong = || "write a number above 0 and up to 1000000, such as 10".to_owned();
    typed.parse().ok().filter(|v| *v > 0.0 && *v <= 1e6).ok_or_else(wrong)
}

/// How many times brighter than what is around it a pixel is a firefly.
pub fn fireflies(typed: &str) -> Result<f32, String> {
    let wrong = || "write a number from 1 to 1000000, such as 10".to_owned();
    typed.parse().ok().filter(|v| (1.0..=1e6).contains(v)).ok_or_else(wrong)
}

/// A number of threads.
pub fn threads(typed: &str) -> Result<usize, String> {
    within(typed, 1, 4096)
}

/// A number of paths in a batch.
pub fn batch(typed: &str) -> Result<usize, String> {
    within(typed, 1, 1 << 20)
}

/// Samples per pixel of a picture whose rays are recorded.
pub fn recorded_spp(typed: &str) -> Result<u32, String> {
    within(typed, 1, 1024)
}

/// A number of rays of each kind.
pub fn rays(typed: &str) -> Result<usize, String> {
    within(typed, 1, 1 << 21)
}

/// A number of rounds of timing.
pub fn rounds(typed: &str) -> Result<u32, String> {
    within(typed, 1, 1000)
}

/// A number of points of a pattern.
pub fn points(typed: &str) -> Result<u32, String> {
    within(typed, 1, straal_study::points::MOST)
}

fn within<T>(typed: &str, least: T, most: T) -> Result<T, String>
where
    T: FromStr + PartialOrd + TryInto<u64> + Copy,
{
    let told = |n: T| n.try_into().map_or(String::new(), grouped);
    match typed.parse() {
        Ok(n) if (least..=most).contains(&n) => Ok(n),
        _ => Err(format!("write a whole number from {} to {}", told(least), told(most))),
    }
}

/// A number whose only upper limit is that of the machine, which nobody means.
fn at_least_one(typed: &str) -> Result<u32, String> {
    let n = typed.parse().ok().filter(|n| *n > 0);
    n.ok_or_else(|| "write a whole number, 1 or greater".to_owned())
}

/// A whole number as people write it: 16,384.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut told = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            told.push(',');
        }
        told.push(digit);
    }
    told
}

/// A time as people read it: `4.2 s`, `3 min 20 s`, `1 h 02 min`.
pub fn tell_duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..10 => format!("{seconds:.1} s"),
        10..60 => format!("{whole} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole / 60 % 60),
    }
}

/// A part of one in percent, to six digits: 0.07 is 7 %, not 7.000000000000001 %.
pub fn tell_percent(part: f64) -> String {
    let text = format!("{:.6}", 100.0 * part);
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "0" { format!("{:.0e} %", 100.0 * part) } else { format!("{text} %") }
}

pub use straal_scene::memory::tell_bytes;

/// An amount of memory such as `8G`, `512M`, `1.5GB` or `800MiB`: letters stand for powers of 1000, with an i for powers of 1024.
pub fn memory(typed: &str) -> Result<u64, String> {
    const HINT: &str = "write a number with a unit: 512M, 8G, 1.5GB or 16GiB";
    let typed = typed.trim();
    let digits = typed.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(typed.len());
    let (number, unit) = typed.split_at(digits);
    let number: f64 = number.parse().map_err(|_| HINT.to_owned())?;
    let unit = unit.trim().to_ascii_lowercase();
    let (letter, base) = match unit.strip_suffix("ib") {
        Some(letter) => (letter, 1024.0_f64),
        None => (unit.strip_suffix('b').unwrap_or(&unit), 1000.0),
    };
    let factor = match letter {
        "" if unit == "b" => 1.0,
        "" => return Err(format!("{typed} of what? {HINT}")),
        "k" => base,
        "m" => base * base,
        "g" => base * base * base,
        "t" => base * base * base * base,
        _ => return Err(format!("unknown unit `{unit}`; {HINT}")),
    };
    let bytes = number * factor;
    if (1e6..1e18).contains(&bytes) { Ok(bytes as u64) } else { Err("it must be from 1M to 1000000T".into()) }
}

/// A number with its noun: `1 sample`, `3 samples`.
pub fn count(n: u64, noun: &str) -> String {
    format!("{} {noun}{}", grouped(n), if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_read() {
        for (typed, milliseconds) in [
            ("90s", 90_000),
            ("2m", 120_000),
            ("2min", 120_000),
            ("1h", 3_600_000),
            ("500ms", 500),
            ("1h30m", 5_400_000),
            ("1.5h", 5_400_000),
            ("1m 30s", 90_000),
            (".5s", 500),
        ] {
            assert_eq!(duration(typed), Ok(Duration::from_millis(milliseconds)), "{typed}");
        }
        for typed in
            ["", "s", "90", "-3s", "3 days", "1h30", "0s", "1..2s", "9999999999h", "1e3s", "∞s", "nans"]
        {
            assert!(duration(typed).is_err(), "{typed}");
        }
    }

    #[test]
    fn samples_and_intervals_are_read() {
        assert_eq!(samples("64..128"), Ok(Samples([64, 128])));
        for typed in ["", "64", "64..", "..64", "64..64", "9..3", "-1..3", "1..2..3", "0..99999999999"] {
            assert!(samples(typed).is_err(), "{typed}");
        }
        assert_eq!(checkpoint("Off"), Ok(Every(None)));
        assert_eq!(checkpoint("2m"), Ok(Every(Some(Duration::from_secs(120)))));
        assert!(checkpoint("often").is_err_and(|e| e.ends_with("; or off")));
    }

    #[test]
    fn sizes_and_crops_are_read() {
        assert_eq!(size("640x360"), Ok(Size([640, 360])));
        for typed in ["", "640", "640x", "0x3", "640x360x2", "-1x2", "1.5x2"] {
            assert!(size(typed).is_err(), "{typed}");
        }
        assert_eq!(crop("1, 2,30,40"), Ok(Crop([1, 2, 30, 40])));
        for typed in ["", "1,2,3", "1,2,1,4", "3,2,1,4", "1,2,3,4,5", "-1,2,3,4"] {
            assert!(crop(typed).is_err(), "{typed}");
        }
    }

    #[test]
    fn memory_has_units() {
        for (typed, bytes) in
            [("8G", 8e9), ("512M", 512e6), ("1.5 GB", 1.5e9), ("16GiB", 17_179_869_184.0), ("2t", 2e12)]
        {
            assert_eq!(memory(typed), Ok(bytes as u64), "{typed}");
        }
        for typed in ["8", "", "G", "8X", "-8G", "1k", "nan", "9999999999T"] {
            assert!(memory(typed).is_err(), "{typed}");
        }
    }

    #[test]
    fn numbers_have_bounds() {
        assert_eq!(field_of_view("39.5"), Ok(39.5));
        assert!(["nan", "0", "180", "-3", "wide"].iter().all(|typed| field_of_view(typed).is_err()));
        assert_eq!((threads("1"), batch("1024")), (Ok(1), Ok(1024)));
        assert!(threads("0").is_err() && threads("5000").is_err() && batch("0").is_err());
        assert_eq!(spp("300000"), Err("write a whole number from 1 to 262,144".into()));
        assert_eq!(
            (depth("0"), seed("-1").is_err()),
            (Err("write a whole number, 1 or greater".into()), true)
        );
    }

    #[test]
    fn quantities_are_told() {
        let told: Vec<_> = [0.04, 9.4, 9.6, 59.4, 59.7, 200.0, 3725.0].map(tell_duration).into();
        assert_eq!(told, ["0.0 s", "9.4 s", "10 s", "59 s", "1 min 00 s", "3 min 20 s", "1 h 02 min"]);
        assert_eq!(
            [999, 1500, 2_000_000, 3_210_000_000].map(tell_bytes),
            ["999 B", "1.5 kB", "2.0 MB", "3.21 GB"]
        );
        assert_eq!([0.07, 0.005, 1e-15].map(tell_percent), ["7 %", "0.5 %", "1e-13 %"]);
        assert_eq!((count(1, "sample"), count(0, "sample")), ("1 sample".into(), "0 samples".into()));
        assert_eq!(count(16_384, "sample"), "16,384 samples");
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
    }
}
