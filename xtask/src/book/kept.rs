//! Text of the pages that is kept in step with what it comes from.
//!
//! ```text
//! <!-- from scenes/lights.yaml:area -->     a part of a file of the project, or all of it
//! <!-- table grid-factors -->               figures that the program works out, see `tables`
//! <!-- way -->                              the line that leads to the pages before and after
//! ...
//! <!-- end -->
//! ```
//! A code host shows what is between, and not the marks.

use super::{CONTENTS, Entry, tables};
use crate::{Failure, root};

const END: &str = "<!-- end -->";

/// A page with all its marked text as it should be.
pub fn brought_up(name: &str, text: &str, contents: &[Entry]) -> Result<String, Failure> {
    let mut out = String::with_capacity(text.len());
    let mut lines = text.lines();
    let mut led = false;
    while let Some(line) = lines.next() {
        out += line;
        out.push('\n');
        if line.contains("{{#include") {
            return Err(
                format!("{name}: write `<!-- from FILE:ANCHOR -->` and `{END}` in place of {line}").into()
            );
        }
        if line.contains("\\\\(") || line.contains("\\\\[") {
            return Err(format!("{name}: write formulas as $`...`$ or ```math: {line}").into());
        }
        let Some(mark) = line.strip_prefix("<!-- ").and_then(|l| l.strip_suffix(" -->")) else { continue };
        let (word, rest) = mark.split_once(' ').unwrap_or((mark, ""));
        let old = |lines: &mut std::str::Lines<'_>| {
            let mut old = String::new();
            for line in lines {
                if line == END {
                    return Ok(old);
                }
                old += line;
                old.push('\n');
            }
            Err(format!("{name}: `<!-- {mark} -->` has no `{END}`"))
        };
        match word {
            "from" => {
                old(&mut lines)?;
                out += &snippet(name, rest)?;
            }
            "table" => {
                let old = old(&mut lines)?;
                match tables::table(rest).map_err(|e| format!("{name}: {rest}: {e}"))? {
                    Some(table) => out += &table,
                    None => out += &old,
                }
            }
            "way" => {
                old(&mut lines)?;
                out += &way(name, contents);
                led = true;
            }
            _ => continue,
        }
        out += END;
        out.push('\n');
    }
    if !led && name != CONTENTS {
        out += &format!("\n<!-- way -->\n{}{END}\n", way(name, contents));
    }
    Ok(out)
}

/// A part of a file of the project, in a fence.
fn snippet(page: &str, of: &str) -> Result<String, Failure> {
    let (file, anchor) = of.split_once(':').map_or((of, None), |(f, a)| (f, Some(a)));
    let text = std::fs::read_to_string(root().join(file)).map_err(|e| format!("{page}: {file}: {e}"))?;
    let part = match anchor {
        Some(anchor) => between_anchors(&text, anchor).ok_or_else(|| {
            format!("{page}: there is no `# ANCHOR: {anchor}` ... `# ANCHOR_END: {anchor}` in {file}")
        })?,
        None => text.lines().filter(|l| !l.trim().starts_with("# ANCHOR")).collect(),
    };
    let language = file.rsplit('.').next().unwrap_or_default();
    let indent = |l: &&str| l.len() - l.trim_start().len();
    let common = part.iter().filter(|l| !l.trim().is_empty()).map(indent).min().unwrap_or(0);
    let part: Vec<&str> = part.iter().map(|l| l.get(common..).unwrap_or_default()).collect();
    Ok(format!("```{language}\n{}\n```\n", part.join("\n").trim_end()))
}

fn between_anchors<'a>(text: &'a str, anchor: &str) -> Option<Vec<&'a str>> {
    let (start, end) = (format!("# ANCHOR: {anchor}"), format!("# ANCHOR_END: {anchor}"));
    let mut lines = text.lines().skip_while(|l| l.trim() != start).skip(1);
    let mut part = Vec::new();
    loop {
        match lines.next()? {
            line if line.trim() == end => break,
            line if line.trim().starts_with("# ANCHOR") => {}
            line => part.push(line),
        }
    }
    (!part.is_empty()).then_some(part)
}

/// The line that leads to the pages before and after.
fn way(name: &str, contents: &[Entry]) -> String {
    let pages: Vec<(&str, &str)> = contents
        .iter()
        .filter_map(|e| match e {
            Entry::Page { title, file, .. } => Some((title.as_str(), file.as_str())),
            Entry::Part(_) => None,
        })
        .collect();
    let at = pages.iter().position(|(_, file)| *file == name);
    let beside = |step: isize| at.and_then(|i| pages.get(i.checked_add_signed(step)?));
    let mut links = Vec::new();
    if let Some((title, file)) = beside(-1) {
        links.push(format!("Before: [{title}]({file})"));
    }
    links.push(format!("[Contents]({CONTENTS})"));
    if let Some((title, file)) = beside(1) {
        links.push(format!("Next: [{title}]({file})"));
    }
    format!("\n---\n\n{}\n", links.join(" · "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_are_cut_out_and_inner_ones_left_out() {
        let text = "a\n# ANCHOR: x\nb\n  # ANCHOR: y\n  c\n  # ANCHOR_END: y\n# ANCHOR_END: x\nd\n";
        assert_eq!(between_anchors(text, "x").unwrap(), ["b", "  c"]);
        assert_eq!(between_anchors(text, "y").unwrap(), ["  c"]);
        assert!(between_anchors(text, "z").is_none());
        assert!(between_anchors("# ANCHOR: x\nb\n", "x").is_none());
    }

    #[test]
    fn old_ways_and_open_marks_are_refused() {
        for wrong in [
            "{{#include a.yaml}}\n",
            "a \\\\(x\\\\)\n",
            "<!-- way -->\n",
            "<!-- from nothing.yaml -->\n<!-- end -->\n",
        ] {
            assert!(brought_up("a.md", wrong, &[]).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_page_leads_to_its_neighbours() {
        let page = |n: &str| Entry::Page { title: n.to_uppercase(), file: format!("{n}.md"), depth: 0 };
        let contents = [page("a"), Entry::Part("p".to_owned()), page("b"), page("c")];
        let text = brought_up("b.md", "# B\n", &contents).unwrap();
        assert!(text.contains("Before: [A](a.md) · [Contents](SUMMARY.md) · Next: [C](c.md)"), "{text}");
        assert_eq!(brought_up("b.md", &text, &contents).unwrap(), text);
    }
}
