//! What a file is made of: JSON alone, or the chunks of a .glb; and what URIs say, whether they hold the bytes or name a file.

use std::borrow::Cow;

/// The JSON text of a file, and the bytes that are packed with it.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Container<'a> {
    pub json: &'a [u8],
    pub binary: Option<&'a [u8]>,
}

const MAGIC: &[u8] = b"glTF";
const JSON: u32 = 0x4e4f_534a;
const BINARY: u32 = 0x004e_4942;

impl<'a> Container<'a> {
    /// Takes a file apart.
    pub fn of(bytes: &'a [u8]) -> Result<Self, String> {
        let Some(rest) = bytes.strip_prefix(MAGIC) else {
            let json = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
            return Ok(Self { json, binary: None });
        };
        let [Some(version), Some(length)] = [number(rest, 0), number(rest, 4)] else {
            return Err("the file ends within its header".to_owned());
        };
        if version != 2 {
            return Err(format!("it is a .glb of version {version}, of which only 2 is read"));
        }
        // What follows the length that is told isn't part of it.
        let told = usize::try_from(length).unwrap_or(usize::MAX);
        if told > bytes.len() {
            return Err(format!("the file is cut off: it should have {told} bytes, and has {}", bytes.len()));
        }
        let mut rest = bytes.get(12..told).unwrap_or_default();
        let (mut json, mut binary) = (None, None);
        while let [Some(length), Some(kind)] = [number(rest, 0), number(rest, 4)] {
            let Some(chunk) = usize::try_from(length).ok().and_then(|n| rest.get(8..8usize.checked_add(n)?))
            else {
                return Err("the file is cut off within a chunk".to_owned());
            };
            match kind {
                JSON if json.is_none() => json = Some(chunk),
                BINARY if binary.is_none() => binary = Some(chunk),
                _ => {}
            }
            rest = &rest[8 + chunk.len()..];
        }
        let json = json.ok_or("the file has no JSON in it")?;
        Ok(Self { json, binary })
    }
}

/// Four bytes as a number.
fn number(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at + 4)?;
    Some(u32::from_le_bytes([four[0], four[1], four[2], four[3]]))
}

/// The bytes that a `data:` URI holds; `None` of any other URI.
pub(super) fn data(uri: &str) -> Option<Result<Vec<u8>, &'static str>> {
    let is_data = uri.get(..5).is_some_and(|start| start.eq_ignore_ascii_case("data:"));
    let rest = is_data.then(|| &uri[5..])?;
    let Some((kind, data)) = rest.split_once(',') else { return Some(Err("the data URI has no comma")) };
    if kind.to_ascii_lowercase().ends_with(";base64") {
        return Some(base64(data.as_bytes()).ok_or("the data URI isn't in base64"));
    }
    Some(Ok(percent(data).into_owned()))
}

/// A URI's bytes without percent signs.
fn percent(text: &str) -> Cow<'_, [u8]> {
    let bytes = text.as_bytes();
    if !bytes.contains(&b'%') {
        return Cow::Borrowed(bytes);
    }
    let digit = |i: usize| bytes.get(i).and_then(|b| char::from(*b).to_digit(16));
    let (mut out, mut i) = (Vec::with_capacity(bytes.len()), 0);
    while i < bytes.len() {
        let code = if bytes[i] == b'%' { digit(i + 1).zip(digit(i + 2)) } else { None };
        out.push(code.map_or(bytes[i], |(a, b)| (16 * a + b) as u8));
        i += if code.is_some() { 3 } else { 1 };
    }
    Cow::Owned(out)
}

/// The name of the file that a URI names. It is relative; what other programs read from the net has a scheme.
pub(super) fn file(uri: &str) -> Result<String, String> {
    let scheme = uri.split_once(':').map(|(scheme, _)| scheme);
    // One letter is a drive.
    let is_scheme =
        |s: &str| s.len() > 1 && s.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c));
    if let Some(scheme) = scheme.filter(|s| is_scheme(s)) {
        return Err(format!("files are read from beside the scene, not by `{scheme}:`"));
    }
    String::from_utf8(percent(uri).into_owned()).map_err(|_| "the name of a file must be UTF-8".to_owned())
}

/// Bytes that are written as letters, digits, `+` and `/` (RFC 4648); those of its variant for URLs are taken as well.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut bits, mut held) = (0_u32, 0);
    let mut letters = text.iter().copied().filter(|b| !b.is_ascii_whitespace());
    let mut is_padded = false;
    for letter in letters.by_ref() {
        let six = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' => {
                is_padded = true;
                break;
            }
            _ => return None,
        };
        (bits, held) = (bits << 6 | u32::from(six), held + 6);
        if held >= 8 {
            held -= 8;
            out.push((bits >> held) as u8);
            bits &= (1 << held) - 1;
        }
    }
    let is_whole = held < 6 && (!is_padded || letters.all(|b| b == b'='));
    is_whole.then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A .glb of some chunks.
    pub(super) fn packed(chunks: &[(u32, &[u8])]) -> Vec<u8> {
        let length: usize = 12 + chunks.iter().map(|(_, c)| 8 + c.len()).sum::<usize>();
        let mut out = [MAGIC, &2_u32.to_le_bytes(), &(length as u32).to_le_bytes()].concat();
        for (kind, chunk) in chunks {
            out.extend((chunk.len() as u32).to_le_bytes());
            out.extend(kind.to_le_bytes());
            out.extend(*chunk);
        }
        out
    }

    #[test]
    fn chunks_are_found_and_strange_ones_passed_over() {
        let bytes = packed(&[(JSON, b"{}  "), (7, b"????"), (BINARY, b"1234")]);
        let want = Container { json: b"{}  ", binary: Some(b"1234") };
        assert_eq!(Container::of(&bytes), Ok(want));
        for cut in 4..bytes.len() {
            assert!(Container::of(&bytes[..cut]).is_err(), "{cut}");
        }
        assert_eq!(Container::of(b"\xef\xbb\xbf{}"), Ok(Container { json: b"{}", binary: None }));
        assert!(Container::of(&packed(&[(BINARY, b"1234")])).is_err());
    }

    #[test]
    fn uris_hold_bytes_or_name_files() {
        let held = |uri: &str| data(uri).unwrap().unwrap();
        assert_eq!(held("data:application/octet-stream;base64,AAECA/8="), [0, 1, 2, 3, 255]);
        assert_eq!(held("data:;base64,"), b"");
        assert_eq!(held("data:text/plain,a%20b%2"), b"a b%2");
        for wrong in ["data:;base64,A", "data:;base64,AA=A", "data:;base64,A!==", "data:"] {
            assert!(data(wrong).unwrap().is_err(), "{wrong}");
        }
        assert!(data("a.bin").is_none());
        assert_eq!(file("Box%20With%20Spaces.bin").unwrap(), "Box With Spaces.bin");
        assert_eq!(file("sub/Größe.png").unwrap(), "sub/Größe.png");
        assert!(file("https://example.org/a.bin").is_err() && file("a%ff").is_err());
    }
}
