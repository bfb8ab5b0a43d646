//! Pages as HTML: one file each, with a list of all pages beside it. No script, no font, no address elsewhere.

use super::{CONTENTS, Entry, SOURCE, formula, is_there, leads_elsewhere};
use crate::{Failure, root};
use pulldown_cmark::{
    CodeBlockKind, CowStr, Event, Options, Parser, Tag, TagEnd, TextMergeStream, html::push_html,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

const TITLE: &str = "straal: a renderer that shows its work";
const STYLE: &str = include_str!("style.css");

/// The whole book.
pub struct Book {
    /// File names and what is in them.
    pub pages: Vec<(String, String)>,
    /// Pictures and scenes that pages refer to: where they are, from the pages, and where they go, from the HTML.
    pub files: BTreeSet<(String, String)>,
}

/// A page while it is made.
struct Page {
    body: String,
    /// The names of its headings, for links into it.
    anchors: BTreeSet<String>,
    /// Pages and places in them that it refers to.
    links: Vec<(String, String)>,
    files: BTreeSet<(String, String)>,
}

/// Makes the HTML of all pages; the first of the contents is also `index.html`. A link that leads nowhere is an error.
pub fn book(sources: &BTreeMap<String, String>, contents: &[Entry]) -> Result<Book, Failure> {
    let mut made = BTreeMap::new();
    for (name, text) in sources {
        made.insert(name.as_str(), page(name, text)?);
    }
    let mut out = Book { pages: Vec::new(), files: BTreeSet::new() };
    for (name, page) in &made {
        for (to, anchor) in &page.links {
            let target = made.get(to.as_str()).ok_or_else(|| format!("{name}: there is no page {to}"))?;
            if !anchor.is_empty() && !target.anchors.contains(anchor) {
                return Err(format!("{name}: {to} has no heading #{anchor}").into());
            }
        }
        let html = framed(name, page, sources, contents);
        if contents.iter().find_map(|e| match e {
            Entry::Page { file, .. } => Some(file == name),
            Entry::Part(_) => None,
        }) == Some(true)
        {
            out.pages.push(("index.html".to_owned(), html.clone()));
        }
        out.pages.push((html_name(name), html));
        out.files.extend(page.files.iter().cloned());
    }
    Ok(out)
}

fn html_name(page: &str) -> String {
    page.strip_suffix(".md").unwrap_or(page).to_lowercase() + ".html"
}

/// The body of a page.
fn page(name: &str, text: &str) -> Result<Page, Failure> {
    let mut out =
        Page { body: String::new(), anchors: BTreeSet::new(), links: Vec::new(), files: BTreeSet::new() };
    let source: Vec<Event<'_>> =
        TextMergeStream::new(Parser::new_ext(text, Options::ENABLE_TABLES | Options::ENABLE_STRIKETHROUGH))
            .collect();
    let mut events = Vec::with_capacity(source.len());
    let mut i = 0;
    while i < source.len() {
        match &source[i] {
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(language))) => {
                let (inside, n) = text_until(&source[i + 1..], TagEnd::CodeBlock);
                let html = if &**language == "math" {
                    format!(
                        "<div class=\"formula\">{}</div>\n",
                        formula::mathml(inside.trim(), true).map_err(|e| format!("{name}: {e}"))?
                    )
                } else {
                    format!("<pre><code>{}</code></pre>\n", coloured(language, &inside))
                };
                events.push(Event::Html(html.into()));
                i += n + 1;
            }
            Event::Start(Tag::Heading { level, classes, attrs, .. }) => {
                let (inside, _) = text_until(&source[i + 1..], TagEnd::Heading(*level));
                let id = free_anchor(&inside, &out.anchors);
                out.anchors.insert(id.clone());
                events.push(Event::Start(Tag::Heading {
                    level: *level,
                    id: Some(id.into()),
                    classes: classes.clone(),
                    attrs: attrs.clone(),
                }));
            }
            Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
                let dest_url = followed(name, dest_url, &mut out)?;
                events.push(Event::Start(Tag::Link {
                    link_type: *link_type,
                    dest_url: dest_url.into(),
                    title: title.clone(),
                    id: id.clone(),
                }));
            }
            Event::Start(Tag::Image { dest_url, .. }) => {
                let (alt, _) = text_until(&source[i + 1..], TagEnd::Image);
                if alt.trim().is_empty() {
                    return Err(format!("{name}: {dest_url} has no words for those who can't see it").into());
                }
                followed(name, dest_url, &mut out)?;
                events.push(source[i].clone());
            }
            Event::Start(Tag::Table(_)) => {
                events.push(Event::Html("<div class=\"table\">".into()));
                events.push(source[i].clone());
            }
            Event::End(TagEnd::Table) => {
                events.push(source[i].clone());
                events.push(Event::Html("</div>\n".into()));
            }
            Event::Code(tex) if is_formula(&events, source.get(i + 1)) => {
                if let Some(Event::Text(before)) = events.pop() {
                    events.push(Event::Text(CowStr::from(before[..before.len() - 1].to_owned())));
                }
                let html = formula::mathml(tex, false).map_err(|e| format!("{name}: {e}"))?;
                events.push(Event::InlineHtml(html.into()));
                if let Some(Event::Text(after)) = source.get(i + 1) {
                    events.push(Event::Text(CowStr::from(after[1..].to_owned())));
                }
                i += 1;
            }
            // The marks of generated text.
            Event::Html(html) if html.starts_with("<!--") => {}
            other => events.push(other.clone()),
        }
        i += 1;
    }
    push_html(&mut out.body, events.into_iter());
    Ok(out)
}

/// Whether code stands between dollars, which makes it a formula.
fn is_formula(before: &[Event<'_>], after: Option<&Event<'_>>) -> bool {
    matches!(before.last(), Some(Event::Text(t)) if t.ends_with('$'))
        && matches!(after, Some(Event::Text(t)) if t.starts_with('$'))
}

/// The words up to an end, and how many events it takes to get there.
fn text_until(events: &[Event<'_>], end: TagEnd) -> (String, usize) {
    let mut out = String::new();
    for (n, event) in events.iter().enumerate() {
        match event {
            Event::End(e) if *e == end => return (out, n),
            Event::Text(t) | Event::Code(t) => out += t,
            _ => {}
        }
    }
    (out, events.len())
}

/// The name of a heading, by the rule of code hosts, so that one link works in both places.
fn free_anchor(heading: &str, taken: &BTreeSet<String>) -> String {
    let plain: String = heading
        .to_lowercase()
        .chars()
        .filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c))
        .map(|c| if c == ' ' { '-' } else { c })
        .collect();
    let mut name = plain.clone();
    let mut n = 0;
    while taken.contains(&name) {
        n += 1;
        name = format!("{plain}-{n}");
    }
    name
}

/// Where a link leads in the HTML; what it leads to is noted.
fn followed(page: &str, link: &str, out: &mut Page) -> Result<String, Failure> {
    if leads_elsewhere(link) {
        return Ok(link.to_owned());
    }
    let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
    let hash = if anchor.is_empty() { String::new() } else { format!("#{anchor}") };
    if file.is_empty() || (file.ends_with(".md") && !file.contains('/')) {
        let to = if file.is_empty() { page } else { file };
        out.links.push((to.to_owned(), anchor.to_owned()));
        return Ok(if file.is_empty() { hash } else { html_name(file) + &hash });
    }
    if !is_there(&root().join(SOURCE), file) || root().join(SOURCE).join(file).is_dir() {
        return Err(format!("{page}: there is no file {file}").into());
    }
    let to = file.trim_start_matches("../").to_owned();
    out.files.insert((file.to_owned(), to.clone()));
    Ok(to + &hash)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Code with its comments and keys marked.
fn coloured(language: &str, text: &str) -> String {
    let mut out = String::new();
    for line in text.lines() {
        let comment = match language {
            "yaml" | "sh" | "console" => comment(line),
            _ => line.len(),
        };
        let (code, comment) = line.split_at(comment);
        out += &if language == "yaml" { keys(code) } else { escaped(code) };
        if !comment.is_empty() {
            let _ = write!(out, "<i>{}</i>", escaped(comment));
        }
        out.push('\n');
    }
    out
}

/// Where a comment begins: at a `#` outside of quotes that starts a word.
fn comment(line: &str) -> usize {
    let mut quote = None;
    let mut before = ' ';
    for (i, c) in line.char_indices() {
        match (quote, c) {
            (Some(q), c) if q == c => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '#') if before == ' ' => return i,
            _ => {}
        }
        before = c;
    }
    line.len()
}

/// YAML with its keys, words before a colon, marked.
fn keys(code: &str) -> String {
    let mut out = String::new();
    let mut rest = code;
    while let Some(colon) = rest.find(':') {
        let (before, after) = rest.split_at(colon);
        let start = before.rfind(|c: char| !(c.is_alphanumeric() || "_-./".contains(c))).map_or(0, |i| i + 1);
        let (gap, key) = before.split_at(start);
        out += &escaped(gap);
        let ends = after[1..].is_empty() || after[1..].starts_with(' ');
        let _ = if key.is_empty() || !ends {
            write!(out, "{}:", escaped(key))
        } else {
            write!(out, "<b>{}</b>:", escaped(key))
        };
        rest = &after[1..];
    }
    out + &escaped(rest)
}

/// A whole file: the list of pages, and the page.
fn framed(name: &str, page: &Page, sources: &BTreeMap<String, String>, contents: &[Entry]) -> String {
    let heading = sources[name].lines().find_map(|l| l.strip_prefix("# ")).unwrap_or(TITLE);
    let mut list = String::new();
    for entry in contents {
        let _ = match entry {
            Entry::Part(part) => writeln!(list, "<p>{}</p>", escaped(part)),
            Entry::Page { title, file, depth } => writeln!(
                list,
                "<a href=\"{}\"{}{}>{}</a>",
                html_name(file),
                if *depth > 0 { " class=\"under\"" } else { "" },
                if file == name { " aria-current=\"page\"" } else { "" },
                escaped(title)
            ),
        };
    }
    format!(
        "<!DOCTYPE html>\n<html lang=\"en-GB\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{} · straal</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <input type=\"checkbox\" id=\"menu\"><label for=\"menu\">Contents</label>\n\
         <nav aria-label=\"Contents\">\n<a class=\"title\" href=\"{}\">{TITLE}</a>\n{list}</nav>\n\
         <main>\n{}</main>\n</body>\n</html>\n",
        escaped(heading),
        html_name(CONTENTS),
        page.body
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(text: &str) -> Result<String, String> {
        page("a.md", text).map(|p| p.body).map_err(|e| e.to_string())
    }

    #[test]
    fn formulas_stand_in_lines_and_in_tables() {
        let html =
            body("A $`x_1`$ and `code` for $5.\n\n| a |\n|---|\n| $`x^2`$. |\n\n```math\n\\frac12\n```\n")
                .unwrap();
        assert_eq!(html.matches("<math").count(), 3, "{html}");
        assert!(html.contains("<code>code</code> for $5.") && html.contains("<mfrac>"), "{html}");
        assert!(body("$`\\nonsense`$").unwrap_err().contains("a.md: the formula"));
    }

    #[test]
    fn headings_have_the_names_that_code_hosts_give_them() {
        let html = body("## What `--json` tells, *twice*\n\n## What --json tells twice\n").unwrap();
        assert!(
            html.contains("id=\"what---json-tells-twice\"")
                && html.contains("id=\"what---json-tells-twice-1\""),
            "{html}"
        );
    }

    #[test]
    fn links_lead_to_html_and_wrong_ones_are_errors() {
        let pages = |a: &str| {
            let sources = [("a.md", a), ("b.md", "# B\n\n## Some place\n")];
            let sources = sources.map(|(n, t)| (n.to_owned(), t.to_owned())).into_iter().collect();
            book(&sources, &[]).map(|b| b.pages[0].1.clone()).map_err(|e| e.to_string())
        };
        assert!(pages("[x](b.md#some-place)").unwrap().contains("href=\"b.html#some-place\""));
        assert!(pages("[x](https://e.org/b.md)").unwrap().contains("href=\"https://e.org/b.md\""));
        for (wrong, what) in [
            ("[x](c.md)", "no page c.md"),
            ("[x](b.md#elsewhere)", "no heading #elsewhere"),
            ("![x](images/nothing.png)", "no file images/nothing.png"),
            ("![](images/nothing.png)", "no words"),
        ] {
            let error = pages(wrong).unwrap_err();
            assert!(error.contains(what), "{wrong}: {error}");
        }
    }

    #[test]
    fn yaml_has_its_keys_and_comments_marked() {
        assert_eq!(
            coloured("yaml", "- a: { b: \"#fff <\" } # c: d\n"),
            "- <b>a</b>: { <b>b</b>: \"#fff &lt;\" } <i># c: d</i>\n"
        );
    }
}
