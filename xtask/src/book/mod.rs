//! The book: its generated text and drawings are kept in step, and its pages become HTML that needs no network.
//!
//! The pages are Markdown that reads well as it is on a code host: formulas as `` $`...`$ `` and ```` ```math ````, and what comes from
//! elsewhere (snippets of scenes, tables of figures, the line that leads to the next page) is written between
//! `<!-- ... -->` and `<!-- end -->`, see [`kept`].

mod formula;
mod html;
mod kept;
mod sampling_tables;
mod tables;

use crate::{Failure, diagrams, keys, root};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Where the pages are, from the project's folder.
const SOURCE: &str = "book/src";

/// Where the HTML goes.
const TARGET: &str = "target/book";

/// The page that lists the others.
const CONTENTS: &str = "SUMMARY.md";

/// Writes what is generated, then the HTML.
pub fn run() -> Result<bool, Failure> {
    diagrams::run()?;
    let contents = contents()?;
    for (name, text) in pages()? {
        let new = in_step(&name, &text, &contents)?;
        if new != text {
            fs::write(root().join(SOURCE).join(&name), new)?;
            println!("{SOURCE}/{name}");
        }
    }
    let target = root().join(TARGET);
    fs::create_dir_all(target.join("images"))?;
    let made = html::book(&pages()?, &contents)?;
    for (name, text) in &made.pages {
        fs::write(target.join(name), text)?;
    }
    for (from, to) in &made.files {
        let to = target.join(to);
        fs::create_dir_all(to.parent().unwrap_or(&target))?;
        fs::copy(root().join(SOURCE).join(from), to)?;
    }
    println!("{TARGET}/index.html: {} pages", made.pages.len() - 1);
    Ok(true)
}

/// A page as it should be.
fn in_step(name: &str, text: &str, contents: &[Entry]) -> Result<String, Failure> {
    let generated = (name == keys::FILE).then(keys::text_of_page);
    kept::brought_up(name, generated.as_deref().unwrap_or(text), contents)
}

/// A line of the list of pages.
#[derive(Clone, Debug, PartialEq)]
enum Entry {
    /// A heading over the pages that follow.
    Part(String),
    /// A page: its title, its file, and how deep it stands under others.
    Page { title: String, file: String, depth: usize },
}

/// The list of pages.
fn contents() -> Result<Vec<Entry>, Failure> {
    let text = fs::read_to_string(root().join(SOURCE).join(CONTENTS))?;
    Ok(entries(&text))
}

fn entries(text: &str) -> Vec<Entry> {
    let mut out = Vec::new();
    for line in text.lines() {
        let depth = (line.len() - line.trim_start().len()) / 2;
        let line = line.trim();
        if let Some(part) = line.strip_prefix("## ") {
            out.push(Entry::Part(part.to_owned()));
        } else if let Some((title, file)) =
            line.strip_prefix("- [").and_then(|l| l.strip_suffix(')')).and_then(|l| l.split_once("]("))
        {
            out.push(Entry::Page { title: title.to_owned(), file: file.to_owned(), depth });
        }
    }
    out
}

/// All pages by file name.
fn pages() -> Result<BTreeMap<String, String>, Failure> {
    let mut out = BTreeMap::new();
    for entry in fs::read_dir(root().join(SOURCE))? {
        let path = entry?.path();
        if path.extension().is_some_and(|e| e == "md")
            && let Some(name) = path.file_name().and_then(|n| n.to_str())
        {
            out.insert(name.to_owned(), fs::read_to_string(&path)?);
        }
    }
    Ok(out)
}

/// Whether a link leads out of the project.
fn leads_elsewhere(link: &str) -> bool {
    link.contains("://") || link.starts_with("mailto:")
}

/// Whether a link from a page, without what follows `#`, leads to a file that is there.
fn is_there(from: &Path, link: &str) -> bool {
    link.is_empty() || from.join(link).exists()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulldown_cmark::{Event, Parser, Tag};

    #[test]
    fn what_is_generated_is_in_step() {
        let contents = contents().unwrap();
        for (name, text) in pages().unwrap() {
            let new = in_step(&name, &text, &contents).unwrap();
            assert!(new == text, "{name} is out of date: run `cargo xtask book`");
        }
    }

    #[test]
    fn every_page_becomes_html_and_every_link_leads_somewhere() {
        let made = html::book(&pages().unwrap(), &contents().unwrap()).unwrap();
        assert!(made.pages.len() > 30);
        for (name, page) in &made.pages {
            for wrong in ["{{#", "merror", "$<", "\\(", "<script", "cdn"] {
                assert!(!page.contains(wrong), "{name} has `{wrong}`");
            }
        }
    }

    /// What is shown whole can be pasted into a file and rendered, and scenes that are named are there.
    #[test]
    fn scenes_of_the_pages_are_in_order() {
        let mut seen = 0;
        for (name, text) in pages().unwrap() {
            for fence in text.split("```yaml\n").skip(1).filter_map(|rest| rest.split("```").next()) {
                let whole = ["camera:", "world:"].iter().all(|key| fence.lines().any(|l| l.starts_with(key)));
                // Those of files that aren't here can't be read.
                if whole && !fence.contains("file:") {
                    let folder = root().join("scenes");
                    let loaded = straal::load_str(&name, fence, &folder, &straal::LoadOptions::default());
                    assert!(loaded.is_ok(), "{name}: this scene is wrong:\n{fence}");
                    seen += 1;
                }
            }
            for scene in text.split("scenes/").skip(1).filter_map(|rest| rest.split(".yaml").next()) {
                let is_name = scene.chars().all(|c| c.is_alphanumeric() || "-/".contains(c));
                let there = ["scenes", "tests/scenes"]
                    .iter()
                    .any(|f| root().join(f).join(format!("{scene}.yaml")).exists());
                assert!(!is_name || there, "{name}: there is no scenes/{scene}.yaml");
            }
        }
        assert!(seen > 3, "{seen}");
    }

    #[test]
    fn every_page_is_in_the_contents_once() {
        let contents = contents().unwrap();
        for name in pages().unwrap().keys().filter(|n| *n != CONTENTS) {
            let times = contents.iter().filter(|e| matches!(e, Entry::Page { file, .. } if file == name));
            assert_eq!(times.count(), 1, "{name} in {CONTENTS}");
        }
    }

    /// Front door and house rules are read on a code host.
    #[test]
    fn links_of_the_front_pages_lead_somewhere() {
        for name in ["README.md", "CONTRIBUTING.md", "ARCHITECTURE.md"] {
            let text = fs::read_to_string(root().join(name)).unwrap();
            for event in Parser::new(&text) {
                if let Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) = event {
                    let file = dest_url.split('#').next().unwrap_or_default();
                    assert!(leads_elsewhere(file) || is_there(&root(), file), "{name}: there is no {file}");
                }
            }
        }
    }

    /// Pages end with something to do, but for those that are lists; and those of the course have something to see.
    #[test]
    fn the_course_has_pictures_and_things_to_try() {
        let (pages, contents) = (pages().unwrap(), contents().unwrap());
        for (file, page) in &pages {
            let is_list = [CONTENTS, keys::FILE, "glossary.md"].contains(&file.as_str());
            assert!(is_list || page.contains("\n## Things to try\n"), "{file} says nothing to try");
        }
        let course =
            contents.iter().skip_while(|e| **e != Entry::Part("The course".to_owned())).skip(1).map_while(
                |e| match e {
                    Entry::Page { file, .. } => Some(file),
                    Entry::Part(_) => None,
                },
            );
        let mut seen = 0;
        for file in course {
            let page = &pages[file];
            assert!(page.contains("](images/"), "{file} has nothing to see");
            seen += 1;
        }
        assert!(seen > 20);
    }
}
