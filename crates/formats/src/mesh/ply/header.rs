//! The header of a PLY file: lines that declare what the rest holds.

use crate::ReadError;
use crate::read_error::quoted;

/// What the header declares.
pub(in crate::mesh) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Bytes and lines up to and with `end_header`.
    pub length: usize,
    pub lines: usize,
}

#[derive(Clone, Copy)]
pub(in crate::mesh) enum Encoding {
    Ascii,
    Little,
    Big,
}

pub(in crate::mesh) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
    /// The header's line that declares it.
    pub line: usize,
    /// Line and name of the first property type whose width isn't known.
    pub unknown: Option<(usize, String)>,
}

pub(in crate::mesh) struct Property {
    pub name: String,
    pub kind: Kind,
}

#[derive(Clone, Copy)]
pub(in crate::mesh) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Clone, Copy, PartialEq)]
pub(in crate::mesh) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
    /// Of so many bytes, which can only be passed over; 0 when it isn't known how many.
    Other(u8),
}

/// Where the line `ply` begins: after a byte order mark and white space, which editors and scripts leave in front.
pub(in crate::mesh) fn start(bytes: &[u8]) -> usize {
    let rest = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    bytes.len() - rest.trim_ascii_start().len()
}

/// How many lines end in a piece of text that doesn't end between a carriage return and its line feed.
pub(in crate::mesh) fn line_ends(text: &[u8]) -> usize {
    let mut count = 0;
    let mut last = 0;
    for &byte in text {
        count += usize::from(byte == b'\r' || byte == b'\n' && last != b'\r');
        last = byte;
    }
    count
}

impl Element {
    pub(in crate::mesh) fn holds_faces(&self) -> bool {
        self.name == "face" || self.name == "tristrips"
    }

    /// Whether its records have a colour.
    pub(in crate::mesh) fn has_colours(&self) -> bool {
        let has = |name: &str| self.properties.iter().any(|p| p.name == name);
        has("red") || has("diffuse_red") || has("r") && has("g") && has("b")
    }
}

impl Header {
    pub(in crate::mesh) fn parse(bytes: &[u8]) -> Result<Self, ReadError> {
        if !super::is_ply(bytes) {
            return Err(ReadError::file("not a PLY file: it doesn't begin with 'ply'"));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut at = start(bytes);
        let first = line_ends(&bytes[..at]) + 1;
        let mut line = first - 1;
        // Binary numbers may begin with the byte of a line feed: after lines that end in a carriage return alone, that
        // belongs to them.
        let mut returns_only = true;
        loop {
            if at >= bytes.len() {
                return Err(ReadError::line(line + 1, "the header has no 'end_header'"));
            }
            let length = memchr::memchr2(b'\n', b'\r', &bytes[at..]).unwrap_or(bytes.len() - at);
            line += 1;
            let text = String::from_utf8_lossy(bytes[at..at + length].trim_ascii());
            let words: Vec<&str> = text.split_ascii_whitespace().take(6).collect();
            let is_end = matches!(words.as_slice(), ["end_header"]);
            let end = match &bytes[at + length..] {
                [] => 0,
                [b'\r', b'\n', ..] if !(is_end && returns_only) => 2,
                _ => 1,
            };
            returns_only &= end == 1 && bytes[at + length] == b'\r';
            at += length + end;
            match words.as_slice() {
                ["ply"] if line == first => {}
                [] | ["comment" | "obj_info", ..] => {}
                ["format", name, ..] => {
                    encoding = Some(match *name {
                        "ascii" => Encoding::Ascii,
                        "binary_little_endian" => Encoding::Little,
                        "binary_big_endian" => Encoding::Big,
                        _ => {
                            let name = quoted(name.as_bytes());
                            return Err(ReadError::line(line, format!("unknown format {name}")));
                        }
                    });
                }
                ["element", name, count] => {
                    let count = count.parse().map_err(|_| {
                        let count = quoted(count.as_bytes());
                        ReadError::line(line, format!("expected a number of elements, found {count}"))
                    })?;
                    let name = (*name).to_string();
                    elements.push(Element { name, count, properties: Vec::new(), line, unknown: None });
                }
                ["property", rest @ ..] => {
                    let Some(element) = elements.last_mut() else {
                        return Err(ReadError::line(line, "a property before the first element"));
                    };
                    element.add(rest, line)?;
                }
                ["end_header"] => break,
                _ => {
                    let text = quoted(text.as_bytes());
                    return Err(ReadError::line(line, format!("unknown header line {text}")));
                }
            }
        }
        let Some(encoding) = encoding else {
            return Err(ReadError::file("the header has no 'format' line"));
        };
        Ok(Self { encoding, elements, length: at, lines: line })
    }
}

impl Element {
    fn add(&mut self, words: &[&str], line: usize) -> Result<(), ReadError> {
        let mut scalar = |word: &str| {
            let scalar = Scalar::named(word);
            if scalar == Scalar::Other(0) && self.unknown.is_none() {
                self.unknown = Some((line, word.to_owned()));
            }
            scalar
        };
        let (name, kind) = match words {
            ["list", count, item, name] => {
                let (count, item) = (scalar(count), scalar(item));
                if matches!(count, Scalar::F32 | Scalar::F64) {
                    return Err(ReadError::line(line, "a list's length must be of an integer type"));
                }
                (name, Kind::List { count, item })
            }
            [kind, name] => (name, Kind::Scalar(scalar(kind))),
            _ => {
                return Err(ReadError::line(
                    line,
                    "expected 'property TYPE NAME' or 'property list COUNT_TYPE ITEM_TYPE NAME'",
                ));
            }
        };
        self.properties.push(Property { name: (*name).to_string(), kind });
        Ok(())
    }
}

impl Scalar {
    fn named(name: &str) -> Self {
        match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "int64" | "longlong" => Self::I64,
            "uint64" | "ulonglong" => Self::U64,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            "bool" => Self::Other(1),
            "half" | "float16" => Self::Other(2),
            "int128" | "uint128" | "float128" => Self::Other(16),
            // `long` is as wide as the machine that wrote it likes.
            _ => Self::Other(0),
        }
    }

    pub(in crate::mesh) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
            Self::Other(bytes) => bytes.into(),
        }
    }
}
