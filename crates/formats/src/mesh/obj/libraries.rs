//! The material libraries of an OBJ file, and which material a name means.

use std::collections::HashMap;

use crate::mesh::lines::{Statement, Warnings, bare};
use crate::mesh::mtl::{self, MtlMaterial};
use crate::read_error::quoted;
use crate::{Limits, ReadError};

/// What loading a library needs.
pub(super) struct Request<'a> {
    pub limits: &'a Limits,
    /// Gives the bytes of a library by its name in the file.
    pub library: &'a mut dyn FnMut(&str) -> Option<Vec<u8>>,
    pub warnings: &'a mut Warnings,
}

/// The libraries that were loaded.
#[derive(Default)]
pub(super) struct Libraries {
    /// What was asked for, and whether it was there.
    asked: HashMap<String, bool>,
    /// Names as the libraries have them.
    materials: Vec<(String, MtlMaterial)>,
    exact: HashMap<String, usize>,
    /// Without quotes and comments; `None` where several materials go by one such name.
    by_bare: HashMap<String, Option<usize>>,
    /// With one kind of slash and one case.
    by_folded: HashMap<String, Option<usize>>,
}

impl Libraries {
    /// No file has as many libraries; a hostile one makes no more look-ups.
    const MOST: usize = 10_000;

    /// Loads what a `mtllib` line names: one file whose name may have spaces in it, or else several.
    pub(super) fn load(&mut self, statement: &Statement, request: &mut Request<'_>) -> Result<(), ReadError> {
        let (whole, line) = (statement.name(), statement.line);
        if self.asked.contains_key(whole) || self.ask(whole, line, request)? {
            return Ok(());
        }
        let bare = bare(whole);
        if bare != whole && self.ask(bare, line, request)? {
            return Ok(());
        }
        for file in files(bare) {
            if self.ask(file, line, request)? {
                continue;
            }
            let words = file.split_ascii_whitespace();
            for word in words {
                if !self.ask(word, line, request)? {
                    request.warnings.once(&format!("mtllib {word}"), || {
                        format!("line {line}: the material library {} was not found", quoted(word.as_bytes()))
                    });
                }
            }
        }
        Ok(())
    }

    /// Whether there is a library of that name, which then is loaded.
    fn ask(&mut self, name: &str, line: usize, request: &mut Request<'_>) -> Result<bool, ReadError> {
        if name.is_empty() {
            return Ok(true);
        }
        if let Some(&is_there) = self.asked.get(name) {
            return Ok(is_there);
        }
        if self.asked.len() >= Self::MOST {
            let most = Self::MOST;
            request.warnings.surely_once("mtllib", || {
                format!("line {line}: after {most} names of material libraries no more are looked for")
            });
            return Ok(true);
        }
        let found = (request.library)(name);
        self.asked.insert(name.to_owned(), found.is_some());
        match found {
            None => Ok(false),
            Some(bytes) => self.add(name, &bytes, line, request).map(|()| true),
        }
    }

    fn add(
        &mut self,
        name: &str,
        bytes: &[u8],
        line: usize,
        request: &mut Request<'_>,
    ) -> Result<(), ReadError> {
        let warnings = &mut *request.warnings;
        // A library that was read under another name comes without bytes.
        if bytes.is_empty() {
            return Ok(());
        }
        let file = mtl::read(bytes, request.limits).map_err(|error| {
            ReadError::line(line, format!("in the material library {}, {error}", quoted(name.as_bytes())))
        })?;
        for warning in file.warnings {
            warnings.once(&format!("{name} {warning}"), || format!("{name}, {warning}"));
        }
        for (material, value) in file.materials {
            if self.exact.contains_key(&material) {
                warnings.once(&format!("newmtl {material}"), || {
                    format!("{name}: the material {} is there already", quoted(material.as_bytes()))
                });
                continue;
            }
            let id = self.materials.len();
            let unless_taken = |known: &mut Option<usize>| *known = None;
            self.by_bare.entry(bare(&material).to_owned()).and_modify(unless_taken).or_insert(Some(id));
            self.by_folded.entry(folded(bare(&material))).and_modify(unless_taken).or_insert(Some(id));
            self.exact.insert(material.clone(), id);
            self.materials.push((material, value));
        }
        Ok(())
    }

    /// The name in [`Self::finish`] of the material that a `usemtl` line means. Looked for is the very name; then the same
    /// without quotes and comments; then one that differs by slashes or case only.
    pub(super) fn meant(&self, name: &str, warnings: &mut Warnings) -> Option<String> {
        let plain = bare(name);
        let exact = || self.exact.get(name).or_else(|| self.exact.get(plain)).copied();
        let by_bare = || self.by_bare.get(plain).copied().flatten();
        if let Some(id) = exact().or_else(by_bare) {
            return Some(self.name(id).to_owned());
        }
        if let Some(id) = self.by_folded.get(&folded(plain)).copied().flatten() {
            let meant = self.name(id);
            warnings.once(&format!("usemtl {plain}"), || {
                let (plain, meant) = (quoted(plain.as_bytes()), quoted(meant.as_bytes()));
                format!("no material library has the material {plain}: {meant} is taken")
            });
            return Some(meant.to_owned());
        }
        if plain.is_empty() {
            return None;
        }
        warnings.once(&format!("usemtl {plain}"), || {
            format!("no material library has the material {}", quoted(plain.as_bytes()))
        });
        Some(plain.to_owned())
    }

    /// A material's name, without quotes and comments unless another goes by that.
    fn name(&self, id: usize) -> &str {
        let name = &self.materials[id].0;
        let plain = bare(name);
        if self.by_bare.get(plain) == Some(&Some(id)) { plain } else { name }
    }

    pub(super) fn finish(self) -> Vec<(String, MtlMaterial)> {
        let names: Vec<String> = (0..self.materials.len()).map(|id| self.name(id).to_owned()).collect();
        names.into_iter().zip(self.materials).map(|(name, (_, material))| (name, material)).collect()
    }
}

/// A name in one case, and with one kind of slash.
fn folded(name: &str) -> String {
    name.replace('\\', "/").to_lowercase()
}

/// The files that a line may name: what stands in quotes, and else words up to one that ends in `.mtl`.
fn files(line: &str) -> Vec<&str> {
    let mut files = Vec::new();
    let mut rest = line.trim_ascii_start();
    while !rest.is_empty() {
        let quoted = rest.strip_prefix('"').and_then(|inside| inside.split_once('"'));
        let (file, more) = quoted.unwrap_or_else(|| rest.split_at(end_of_file(rest)));
        files.push(file.trim_ascii());
        rest = more.trim_ascii_start();
    }
    files
}

/// Where the first word that ends in `.mtl` does.
fn end_of_file(line: &str) -> usize {
    let mut at = 0;
    for word in line.split_inclusive(|c: char| c.is_ascii_whitespace()) {
        at += word.len();
        if word.trim_ascii_end().to_ascii_lowercase().ends_with(".mtl") {
            return at;
        }
    }
    line.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_names_files() {
        assert_eq!(files("a.mtl b.mtl"), ["a.mtl", "b.mtl"]);
        assert_eq!(files("my paints.MTL  b.mtl c"), ["my paints.MTL", "b.mtl", "c"]);
        assert_eq!(files("\"my paints.mtl\" \"b\" c d.mtl"), ["my paints.mtl", "b", "c d.mtl"]);
        assert_eq!(files("\"a"), ["\"a"]);
        assert_eq!(files(""), [""; 0]);
    }
}
