//! Packages (.usdz): layers and pictures in a ZIP that packs nothing.

use std::ops::Range;
use std::rc::Rc;

/// How ZIP files begin.
pub(super) const MAGIC: &[u8] = b"PK\x03\x04";

/// The files of a package.
#[derive(Debug)]
pub(super) struct Archive {
    pub bytes: Rc<[u8]>,
    /// Names, and where their bytes are, in their order.
    entries: Vec<(String, Range<usize>)>,
}

impl Archive {
    /// Reads the list of its files, from its end.
    pub fn open(bytes: Rc<[u8]>) -> Result<Self, String> {
        const END: &[u8] = b"PK\x05\x06";
        let tail = bytes.len().saturating_sub((1 << 16) + 22);
        let end = memchr::memmem::rfind(&bytes[tail..], END).ok_or("the package has no list of its files")?;
        let end = tail + end;
        let at = |place: usize, count: usize| -> Result<usize, String> {
            let field = place.checked_add(count).and_then(|end| bytes.get(place..end));
            let field = field.ok_or("the package's list of files is damaged")?;
            Ok(field.iter().rev().fold(0, |v, b| v << 8 | usize::from(*b)))
        };
        let count = at(end + 10, 2)?;
        let mut place = at(end + 16, 4)?;
        let mut entries = Vec::new();
        for _ in 0..count {
            if at(place, 4)? != 0x0201_4b50 {
                return Err("the package's list of files is damaged".to_owned());
            }
            let (method, size) = (at(place + 10, 2)?, at(place + 20, 4)?);
            let (name, extra, remark) = (at(place + 28, 2)?, at(place + 30, 2)?, at(place + 32, 2)?);
            let header = at(place + 42, 4)?;
            let name_bytes = bytes.get(place + 46..place + 46 + name);
            let name_bytes = name_bytes.ok_or("the package's list of files is damaged")?;
            let text = String::from_utf8_lossy(name_bytes).into_owned();
            if method != 0 {
                return Err(format!("`{}` is packed in the package", straal_scene::suggest::brief(&text)));
            }
            let start = header + 30 + at(header + 26, 2)? + at(header + 28, 2)?;
            if start + size > bytes.len() {
                return Err("a file of the package lies beyond its end".to_owned());
            }
            entries.push((text, start..start + size));
            place += 46 + name + extra + remark;
        }
        Ok(Self { bytes, entries })
    }

    /// Where a file's bytes are.
    pub fn find(&self, name: &str) -> Option<Range<usize>> {
        self.entries.iter().find(|(entry, _)| entry == name).map(|(_, range)| range.clone())
    }

    /// The layer that the package shows: its first file.
    pub fn first(&self) -> Option<&(String, Range<usize>)> {
        self.entries.first()
    }
}

/// A name as it is in a folder, without `.` and `..`; none where it leads out.
pub(super) fn inside(folder: &str, name: &str) -> Option<String> {
    let mut steps: Vec<&str> = Vec::new();
    for step in folder.split('/').chain(name.split('/')) {
        match step {
            "" | "." => {}
            ".." => drop(steps.pop()?),
            step => steps.push(step),
        }
    }
    Some(steps.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A package of these files.
    fn package(files: &[(&str, &[u8])]) -> Vec<u8> {
        let (mut out, mut list) = (Vec::new(), Vec::new());
        for (name, bytes) in files {
            let header = out.len() as u32;
            let sizes = [(bytes.len() as u32).to_le_bytes(); 2].concat();
            let length = (name.len() as u16).to_le_bytes();
            out.extend(b"PK\x03\x04");
            out.extend([0; 14]);
            out.extend(&sizes);
            out.extend(length);
            out.extend([0; 2]);
            out.extend(name.as_bytes());
            out.extend(*bytes);
            list.extend(b"PK\x01\x02");
            list.extend([0; 16]);
            list.extend(&sizes);
            list.extend(length);
            list.extend([0; 12]);
            list.extend(header.to_le_bytes());
            list.extend(name.as_bytes());
        }
        let start = (out.len() as u32).to_le_bytes();
        let length = (list.len() as u32).to_le_bytes();
        out.extend(list);
        out.extend(b"PK\x05\x06");
        out.extend([0; 4]);
        out.extend([(files.len() as u16).to_le_bytes(); 2].concat());
        out.extend(length);
        out.extend(start);
        out.extend([0; 2]);
        out
    }

    #[test]
    fn files_are_found_in_a_package() {
        let bytes = package(&[("a.usda", b"#usda 1.0"), ("t/b.png", b"xyz")]);
        let archive = Archive::open(bytes.clone().into()).unwrap();
        assert_eq!(archive.first().unwrap().0, "a.usda");
        assert_eq!(&archive.bytes[archive.find("t/b.png").unwrap()], b"xyz");
        assert_eq!(archive.find("b.png"), None);
        for end in 0..bytes.len() {
            let _ = Archive::open(bytes[..end].into());
        }
    }

    #[test]
    fn names_stay_inside() {
        assert_eq!(inside("a/b", "./../c.png").as_deref(), Some("a/c.png"));
        assert_eq!(inside("", "../c.png"), None);
    }
}
