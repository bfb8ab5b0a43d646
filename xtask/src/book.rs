//! The book's pages against the files they refer to.
#![cfg(test)]

use crate::root;
use std::fs;
use std::path::{Path, PathBuf};

fn pages() -> Vec<(PathBuf, String)> {
    let folder = root().join("book/src");
    let mut all: Vec<(PathBuf, String)> = fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "md"))
        .map(|p| (p.clone(), fs::read_to_string(&p).unwrap()))
        .collect();
    all.sort();
    all
}

/// What stands between `open` and the next `close`, each time.
fn between<'a>(text: &'a str, open: &'a str, close: &'a str) -> impl Iterator<Item = &'a str> {
    text.split(open).skip(1).filter_map(move |rest| rest.split(close).next())
}

/// The lines of an anchor, as mdBook cuts them out.
fn has_anchor(text: &str, anchor: &str) -> bool {
    let starts = text.lines().position(|l| l.trim() == format!("# ANCHOR: {anchor}"));
    let ends = text.lines().position(|l| l.trim() == format!("# ANCHOR_END: {anchor}"));
    matches!((starts, ends), (Some(s), Some(e)) if s + 1 < e)
}

#[test]
fn every_snippet_is_in_its_file() {
    let mut seen = 0;
    for (page, text) in pages() {
        for include in between(&text, "{{#include ", "}}") {
            let (file, anchor) = include.split_once(':').map_or((include, None), |(f, a)| (f, Some(a)));
            let path = page.parent().unwrap().join(file);
            let included =
                fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {include}: {e}", page.display()));
            if let Some(anchor) = anchor {
                assert!(has_anchor(&included, anchor), "{}: no anchor {anchor} in {file}", page.display());
            }
            seen += 1;
        }
    }
    assert!(seen > 10);
}

#[test]
fn every_picture_and_page_is_there() {
    let mut all = pages();
    let readme = root().join("README.md");
    all.push((readme.clone(), fs::read_to_string(&readme).unwrap()));
    for (page, text) in all {
        for link in between(&text, "](", ")") {
            let link = link.split('#').next().unwrap_or(link);
            let elsewhere = link.is_empty() || link.contains("://");
            let path = page.parent().unwrap_or(Path::new("")).join(link);
            assert!(elsewhere || path.exists(), "{}: there is no {link}", page.display());
        }
    }
}

#[test]
fn every_page_is_in_the_summary() {
    let summary = fs::read_to_string(root().join("book/src/SUMMARY.md")).unwrap();
    for (page, _) in pages() {
        let name = page.file_name().unwrap().to_str().unwrap().to_owned();
        // One is the summary itself, the other a part of a page.
        if name != "SUMMARY.md" && name != "keys.md" {
            assert!(summary.contains(&format!("({name})")), "{name} is not in SUMMARY.md");
        }
    }
}
