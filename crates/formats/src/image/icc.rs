//! ICC profiles that are a matrix and three curves, as those of screens and cameras are (ICC.1:2022).

use straal_color::{Adaptation, Chromaticity, Matrix3, RgbSpace, Space, White};

/// How a signal becomes light.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Response {
    Srgb,
    /// Light is the signal to this power.
    Power(f64),
    /// A line near black, then a power of 0.45, as cameras of video have it.
    Video {
        a: f64,
        slope: f64,
    },
    /// A logarithm of so many decades.
    Log(f64),
    /// SMPTE ST 2084.
    Pq,
    /// Hybrid log-gamma.
    Hlg,
    /// SMPTE ST 428-1.
    Cinema,
    /// Light at equal steps of the signal, at least two.
    Table(Vec<u16>),
    /// `(a v + b)^g + e` from `d` on, below it `c v + f`: the numbers g, a to f.
    Parametric([f64; 7]),
}

/// What a profile says.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Profile {
    /// Of red, green and blue, or one of grey.
    pub responses: Vec<Response>,
    /// None of a profile of grey.
    pub space: Option<RgbSpace>,
}

const DAMAGED: &str = "it is damaged";

impl Profile {
    /// Reads a profile; the error is why it can't be honoured.
    pub fn read(bytes: &[u8]) -> Result<Self, &'static str> {
        match bytes.get(16..20).ok_or(DAMAGED)? {
            b"GRAY" => Ok(Self { responses: vec![curve(tag(bytes, b"kTRC")?)?], space: None }),
            b"RGB " => {
                let [r, g, b] = [b"rXYZ", b"gXYZ", b"bXYZ"].map(|name| xyz(tag(bytes, name)?));
                let columns = Matrix3([r?, g?, b?]).transpose();
                let [r, g, b] = [b"rTRC", b"gTRC", b"bTRC"].map(|name| curve(tag(bytes, name)?));
                Ok(Self { responses: vec![r?, g?, b?], space: Some(space(&columns)?) })
            }
            _ => Err("it is not of RGB or grey"),
        }
    }
}

/// Primaries under D65 from the columns of a profile, which are seen under D50. Profiles are rounded: a space that is known by name is
/// meant where it is nearly that.
fn space(columns: &Matrix3) -> Result<RgbSpace, &'static str> {
    let white = |w: White| w.chromaticity().with_luminance(1.0);
    let under_d65 = Adaptation::Bradford.matrix(white(White::D50), white(White::D65)) * *columns;
    let at = |[x, y, z]: [f64; 3]| {
        let sum = x + y + z;
        (sum > 0.0).then(|| Chromaticity { x: x / sum, y: y / sum })
    };
    let unit = |k: usize| under_d65.apply([0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 }));
    let [Some(r), Some(g), Some(b), Some(white)] =
        [at(unit(0)), at(unit(1)), at(unit(2)), at(under_d65.apply([1.0; 3]))]
    else {
        return Err("its colours make no sense");
    };
    let told = RgbSpace { primaries: [r, g, b], white };
    let near = |space: &RgbSpace| {
        let pairs = space.primaries.into_iter().zip(told.primaries).chain([(space.white, white)]);
        { pairs }.all(|(a, b)| (a.x - b.x).abs() < 2e-3 && (a.y - b.y).abs() < 2e-3)
    };
    let known = [Space::Srgb, Space::DisplayP3, Space::Rec2020].map(Space::rgb);
    let space = known.into_iter().find(near).unwrap_or(told);
    if space.is_sound() { Ok(space) } else { Err("its colours make no sense") }
}

/// The bytes of a tag.
fn tag<'a>(bytes: &'a [u8], name: &[u8; 4]) -> Result<&'a [u8], &'static str> {
    let count = number(bytes, 128)?;
    let entries = bytes.get(132..).ok_or(DAMAGED)?.as_chunks::<12>().0;
    let entries = entries.get(..count.min(entries.len())).unwrap_or_default();
    let entry = entries.iter().find(|e| e[..4] == *name).ok_or("it is not a matrix and curves")?;
    let (start, length) = (number(entry, 4)?, number(entry, 8)?);
    start.checked_add(length).and_then(|end| bytes.get(start..end)).ok_or(DAMAGED)
}

fn number(bytes: &[u8], at: usize) -> Result<usize, &'static str> {
    let bytes = bytes.get(at..).and_then(|b| b.first_chunk::<4>()).ok_or(DAMAGED)?;
    usize::try_from(u32::from_be_bytes(*bytes)).map_err(|_| DAMAGED)
}

/// A number in sixteenths of 2^-12, as profiles have them.
fn fixed(bytes: &[u8], at: usize) -> Result<f64, &'static str> {
    let bytes = bytes.get(at..).and_then(|b| b.first_chunk::<4>()).ok_or(DAMAGED)?;
    Ok(f64::from(i32::from_be_bytes(*bytes)) / 65_536.0)
}

fn xyz(tag: &[u8]) -> Result<[f64; 3], &'static str> {
    Ok([fixed(tag, 8)?, fixed(tag, 12)?, fixed(tag, 16)?])
}

fn curve(tag: &[u8]) -> Result<Response, &'static str> {
    let sound =
        |gamma: f64| if (0.05..=20.0).contains(&gamma) { Ok(gamma) } else { Err("its curve makes no sense") };
    match tag.get(..4).ok_or(DAMAGED)? {
        b"curv" => {
            let count = number(tag, 8)?;
            let entries = tag.get(12..).ok_or(DAMAGED)?.as_chunks::<2>().0;
            let entries = entries.get(..count).ok_or(DAMAGED)?;
            match entries {
                [] => Ok(Response::Power(1.0)),
                [one] => Ok(Response::Power(sound(f64::from(u16::from_be_bytes(*one)) / 256.0)?)),
                several => Ok(Response::Table(several.iter().map(|e| u16::from_be_bytes(*e)).collect())),
            }
        }
        b"para" => {
            let kind = tag.get(8..10).and_then(|b| b.first_chunk::<2>()).ok_or(DAMAGED)?;
            let v = |i: usize| fixed(tag, 12 + 4 * i);
            let numbers = match u16::from_be_bytes(*kind) {
                0 => [v(0)?, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
                1 | 2 if v(1)? == 0.0 => return Err("its curve makes no sense"),
                1 => [v(0)?, v(1)?, v(2)?, 0.0, -v(2)? / v(1)?, 0.0, 0.0],
                2 => [v(0)?, v(1)?, v(2)?, 0.0, -v(2)? / v(1)?, v(3)?, v(3)?],
                3 => [v(0)?, v(1)?, v(2)?, v(3)?, v(4)?, 0.0, 0.0],
                4 => [v(0)?, v(1)?, v(2)?, v(3)?, v(4)?, v(5)?, v(6)?],
                _ => return Err("its curve is of a kind that straal doesn't know"),
            };
            sound(numbers[0])?;
            Ok(Response::Parametric(numbers))
        }
        _ => Err("its curve is of a kind that straal doesn't know"),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A profile with these columns, all of them with the same curve.
    pub fn profile(columns: [[f64; 3]; 3], curve: &[u8]) -> Vec<u8> {
        let mut data = Vec::new();
        let mut tags: Vec<([u8; 4], usize, usize)> = Vec::new();
        let start = 132 + 12 * 6;
        for (name, column) in [*b"rXYZ", *b"gXYZ", *b"bXYZ"].into_iter().zip(columns) {
            let value = column.map(|v| ((v * 65_536.0 + 0.5).floor() as i32).to_be_bytes()).concat();
            tags.push((name, start + data.len(), 20));
            data.extend([b"XYZ \0\0\0\0".as_slice(), &value].concat());
        }
        for name in [*b"rTRC", *b"gTRC", *b"bTRC"] {
            tags.push((name, start + data.len(), curve.len()));
        }
        data.extend(curve);
        let mut bytes = vec![0; 128];
        bytes[16..20].copy_from_slice(b"RGB ");
        bytes[20..24].copy_from_slice(b"XYZ ");
        bytes.extend(6u32.to_be_bytes());
        for (name, start, length) in tags {
            bytes.extend(name);
            bytes.extend((start as u32).to_be_bytes());
            bytes.extend((length as u32).to_be_bytes());
        }
        [bytes, data].concat()
    }

    /// The columns of Display P3 as its profile prints them.
    pub const P3: [[f64; 3]; 3] =
        [[0.515_12, 0.241_2, -0.001_05], [0.291_98, 0.692_25, 0.041_89], [0.157_1, 0.066_57, 0.784_07]];

    #[test]
    fn a_matrix_and_curves_are_read() {
        let gamma = [b"curv\0\0\0\0\0\0\0\x01".as_slice(), &[2, 0x33]].concat();
        let read = Profile::read(&profile(P3, &gamma)).unwrap();
        assert_eq!(read.space, Some(Space::DisplayP3.rgb()));
        assert_eq!(read.responses[2], Response::Power(563.0 / 256.0));
        let table = [b"curv\0\0\0\0\0\0\0\x02".as_slice(), &[0, 0, 255, 255]].concat();
        assert_eq!(
            Profile::read(&profile(P3, &table)).unwrap().responses[0],
            Response::Table(vec![0, 65_535])
        );
        let parametric = [b"para\0\0\0\0\0\0\0\0".as_slice(), &[0, 2, 0, 0]].concat();
        let read = Profile::read(&profile(P3, &parametric)).unwrap();
        assert_eq!(read.responses[0], Response::Parametric([2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
    }

    #[test]
    fn what_is_wrong_with_a_profile_is_told() {
        let linear = b"curv\0\0\0\0\0\0\0\0".as_slice();
        let whole = profile(P3, linear);
        assert!(Profile::read(&whole).is_ok());
        for cut in 0..whole.len() {
            assert!(Profile::read(&whole[..cut]).is_err(), "{cut}");
        }
        for (at, bytes) in [(16, b"CMYK"), (132, b"aXYZ"), (136, b"\xff\xff\xff\xff"), (128, b"\0\0\0\0")] {
            let mut wrong = whole.clone();
            wrong[at..at + 4].copy_from_slice(bytes);
            assert!(Profile::read(&wrong).is_err(), "{at}");
        }
        assert!(Profile::read(&profile([[0.0; 3]; 3], linear)).is_err());
        assert!(Profile::read(&profile([P3[0]; 3], linear)).is_err());
    }
}
