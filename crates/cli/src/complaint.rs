//! Complaints of scenes as people read them, and as scripts do.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet, normalize_untrusted_str as clean};
use serde_json::{Value as Json, json};
use straal_scene::{Diagnostic, Diagnostics, Severity, Span};

use crate::exit::Failure;
use crate::quantity::count;

/// Lines longer than this, in bytes, come from machines: only a window of them is shown.
const LONGEST_LINE: usize = 1000;

/// All complaints, each with the line it points at, and their number when there are several.
pub fn show(diagnostics: &Diagnostics, colours: bool) -> String {
    let each: Vec<String> = diagnostics.list.iter().map(|d| one(diagnostics, d, colours) + "\n").collect();
    let mut text = each.join("\n");
    let errors = diagnostics.errors() as u64;
    let notes = diagnostics.list.iter().filter(|d| d.severity == Severity::Note).count();
    let warnings = (diagnostics.list.len() + diagnostics.dropped - notes) as u64 - errors;
    if diagnostics.dropped > 0 {
        text += &format!("\n... and {} more\n", diagnostics.dropped);
    }
    if errors + warnings > 1 {
        text += "\n";
        let told: Vec<String> = [(errors, "error"), (warnings, "warning")]
            .into_iter()
            .filter(|(n, _)| *n > 0)
            .map(|(n, noun)| count(n, noun))
            .collect();
        text += &format!("{}\n", told.join(", "));
    }
    text
}

/// A failure without a place in a file.
pub fn show_failure(failure: &Failure, colours: bool) -> String {
    let mut text = failure.diagnostics.as_deref().map_or(String::new(), |d| show(d, colours));
    if !failure.message.is_empty() {
        let mut group = annotate_snippets::Group::with_title(Level::ERROR.primary_title(&failure.message));
        if let Some(help) = &failure.help {
            group = group.element(Level::HELP.message(clean(help)));
        }
        text += &renderer(colours).render(&[group]);
        text += "\n";
    }
    text
}

fn renderer(colours: bool) -> Renderer {
    if colours { Renderer::styled() } else { Renderer::plain() }
}

fn one(all: &Diagnostics, d: &Diagnostic, colours: bool) -> String {
    let spans = || std::iter::once(d.span).chain(d.related.iter().map(|(span, _)| *span));
    if spans().any(|span| line_of(all, span).len() > LONGEST_LINE) {
        return all.render(d).trim_end().to_owned();
    }
    let level = match d.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let mut group = annotate_snippets::Group::with_title(level.primary_title(d.message.as_str()));
    if d.span.is_some() {
        group = group.element(excerpt(all, d.span, AnnotationKind::Primary, &d.label));
    }
    for (span, label) in &d.related {
        if span.is_some() {
            group = group.element(excerpt(all, *span, AnnotationKind::Context, label));
        } else {
            group = group.element(Level::NOTE.message(clean(label)));
        }
    }
    if let Some(help) = &d.help {
        group = group.element(Level::HELP.message(clean(help)));
    }
    renderer(colours).render(&[group])
}

fn line_of(all: &Diagnostics, span: Span) -> &str {
    all.sources.line(span.file, all.sources.position(span).line)
}

/// The line where a span starts, with what of the span is on it underlined.
fn excerpt<'a>(
    all: &'a Diagnostics,
    span: Span,
    kind: AnnotationKind,
    label: &str,
) -> Snippet<'a, annotate_snippets::Annotation<'a>> {
    let at = all.sources.position(span);
    let line = all.sources.line(span.file, at.line);
    let start = line.char_indices().nth(at.column - 1).map_or(line.len(), |(i, _)| i);
    let quoted = all.sources.quote(span).lines().next().map_or(0, str::len);
    let end = line.len().min(start + quoted);
    let mark = kind.span(start..end);
    let mark = if label.is_empty() { mark } else { mark.label(clean(label)) };
    Snippet::source(line).path(all.sources.name(span.file)).line_start(at.line).annotation(mark)
}

/// All complaints as data.
pub fn as_json(diagnostics: &Diagnostics) -> Json {
    diagnostics.list.iter().map(|d| one_as_json(diagnostics, d)).collect()
}

fn one_as_json(all: &Diagnostics, d: &Diagnostic) -> Json {
    let mut object = json!({ "severity": d.severity.to_string(), "message": d.message });
    let place = |span: Span| {
        let at = all.sources.position(span);
        json!({ "file": all.sources.name(span.file), "line": at.line, "column": at.column })
    };
    let mut add = |key: &str, value: Json| {
        if let Json::Object(map) = &mut object {
            map.insert(key.to_owned(), value);
        }
    };
    if d.span.is_some() {
        add("place", place(d.span));
    }
    if !d.label.is_empty() {
        add("label", json!(d.label));
    }
    if let Some(help) = &d.help {
        add("help", json!(help));
    }
    if !d.related.is_empty() {
        let related = d.related.iter().map(|(span, label)| json!({ "place": place(*span), "label": label }));
        add("related", related.collect());
    }
    object
}

/// A failure as data: what `--json` prints instead of a result.
pub fn failure_as_json(failure: &Failure) -> Json {
    let list = failure.diagnostics.as_deref().map_or(json!([]), as_json);
    let message = if failure.message.is_empty() { "the scene can't be used" } else { &failure.message };
    json!({ "error": message, "help": failure.help, "exit_code": failure.exit.code(), "diagnostics": list })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "world:\n  - sphere: { radus: 1 }\n  - sphere: { radius: \"ä\", colour: x }\n";

    fn span(d: &Diagnostics, file: straal_scene::FileId, quote: &str) -> Span {
        let start = d.sources.text(file).find(quote).unwrap() as u32;
        Span { file, start, end: start + quote.len() as u32 }
    }

    fn example() -> Diagnostics {
        let mut d = Diagnostics::default();
        let file = d.sources.add("s.yaml", TEXT);
        let (key, other) = (span(&d, file, "radus"), span(&d, file, "radius"));
        d.push(
            Diagnostic::error(key, "`sphere` has no key `radus`")
                .label("unknown key")
                .related(other, "here it is right")
                .help("did you mean `radius`?"),
        );
        let after_umlaut = span(&d, file, "colour");
        d.push(Diagnostic::warning(after_umlaut, "`colour` is not used"));
        d.push(Diagnostic::error(Span::NONE, "the world is dark").help("add a light"));
        d
    }

    #[test]
    fn all_complaints_are_shown_with_place_line_and_help() {
        let want = "\
error: `sphere` has no key `radus`
 --> s.yaml:2:15
  |
2 |   - sphere: { radus: 1 }
  |               ^^^^^ unknown key
  |
 ::: s.yaml:3:15
  |
3 |   - sphere: { radius: \"ä\", colour: x }
  |               ------ here it is right
  |
  = help: did you mean `radius`?

warning: `colour` is not used
 --> s.yaml:3:28
  |
3 |   - sphere: { radius: \"ä\", colour: x }
  |                            ^^^^^^

error: the world is dark
 |
 = help: add a light

2 errors, 1 warning
";
        assert_eq!(show(&example(), false), want);
    }

    #[test]
    fn colours_only_when_asked_for() {
        assert!(!show(&example(), false).contains('\x1b'));
        assert!(show(&example(), true).contains('\x1b'));
    }

    #[test]
    fn scripts_get_places_too() {
        let json = as_json(&example());
        assert_eq!(json[0]["place"], json!({ "file": "s.yaml", "line": 2, "column": 15 }));
        assert_eq!(json[0]["help"], "did you mean `radius`?");
        assert_eq!(json[0]["related"][0]["place"]["line"], 3);
        assert_eq!(json[1]["severity"], "warning");
        assert_eq!(json[2].get("place"), None);
    }

    #[test]
    fn files_without_line_breaks_are_cut() {
        let mut d = Diagnostics::default();
        let file = d.sources.add("s.json", format!("{}oops{}", " ".repeat(100_000), "x".repeat(100_000)));
        let place = span(&d, file, "oops");
        d.push(Diagnostic::error(place, "what is this"));
        let shown = show(&d, false);
        assert!(shown.len() < 1000 && shown.contains("s.json:1:100001") && shown.contains("oops"), "{shown}");
    }

    #[test]
    fn hostile_text_can_not_drive_the_terminal() {
        let mut d = Diagnostics::default();
        let file = d.sources.add("s.yaml", "a\x1b[31mb: 1\n");
        let place = span(&d, file, "a");
        d.push(
            Diagnostic::error(place, "x\x1b[2J").label("y\x1b[2J").help("z\x1b[2J").related(place, "\x1b[2J"),
        );
        assert!(!show(&d, false).contains('\x1b'));
        assert!(!show_failure(&Failure::input("a\x1b[2J").help("b\x1b[2J"), false).contains('\x1b'));
    }
}
