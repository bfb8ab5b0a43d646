//! Scenes of other programs, which are told by how they begin: one complaint is better than many about YAML that is none.

use straal_scene::{Diagnostic, FileId, Span};

/// The complaint of a text that is another program's.
pub fn program(file: FileId, text: &str) -> Option<Diagnostic> {
    let (at, line) = first_line(text)?;
    let format = format(line, text)?;
    let start = u32::try_from(at).unwrap_or(u32::MAX);
    let end = u32::try_from(at + line.len()).unwrap_or(u32::MAX);
    let span = Span { file, start, end };
    // By its own name it is read.
    let ending = match format {
        "a scene of pbrt" => Some(".pbrt"),
        "a Mitsuba scene" => Some(".xml"),
        "a glTF file" => Some(".gltf"),
        "a USD scene" => Some(".usda"),
        _ => None,
    };
    if let Some(ending) = ending {
        let message = format!("this is {format}, which is read if its name ends in {ending}");
        return Some(Diagnostic::error(span, message));
    }
    let message = format!("this is {format}, which can't be read");
    let help = "straal reads its own scenes (YAML or JSON) and meshes (.ply, .obj, .stl); the book's page 'The scene language' shows how one is \
                written";
    Some(Diagnostic::error(span, message).help(help))
}

/// Whether a text begins as another program's scene does.
pub(crate) fn is_of_another_program(text: &str) -> bool {
    // XML may be anything.
    first_line(text).is_some_and(|(_, line)| format(line, text).is_some_and(|format| format != XML))
}

/// The first line that says something, with where it begins.
fn first_line(text: &str) -> Option<(usize, &str)> {
    const MOST: usize = 200;
    let mut at = 0;
    for line in text.split_inclusive('\n').take(MOST) {
        let said = line.trim();
        if !said.is_empty() && !said.starts_with('#') && !said.starts_with("//")
            || said.starts_with("#version")
            || said.starts_with("#usda")
        {
            return Some((at + line.find(said).unwrap_or(0), said));
        }
        at += line.len();
    }
    None
}

/// What may be a scene.
const XML: &str = "XML";

fn format(line: &str, text: &str) -> Option<&'static str> {
    const PBRT: [&str; 14] = [
        "LookAt",
        "Camera",
        "Film",
        "Sampler",
        "Integrator",
        "WorldBegin",
        "Scale",
        "Translate",
        "Rotate",
        "Transform",
        "ColorSpace",
        "PixelFilter",
        "Accelerator",
        "AttributeBegin",
    ];
    let (word, rest) = line.split_once([' ', '\t']).unwrap_or((line, ""));
    let rest = rest.trim_start();
    if line.starts_with("<scene") || line.starts_with("<?xml") && text.contains("<scene") {
        return Some("a Mitsuba scene");
    }
    if line.starts_with('<') {
        return Some(XML);
    }
    // A directive of pbrt is followed by a name in quotes or numbers, never by a colon.
    if PBRT.contains(&word)
        && (rest.is_empty()
            || rest.starts_with(['"', '[', '-', '.'])
            || rest.starts_with(|c: char| c.is_ascii_digit()))
    {
        return Some("a scene of pbrt");
    }
    if line.starts_with("#version")
        || ["camera", "light_source", "global_settings", "sphere", "#include", "#declare"].contains(&word)
            && rest.starts_with('{')
        || line.starts_with("camera{")
    {
        return Some("a scene of POV-Ray");
    }
    if line.starts_with('{')
        && text.contains("\"asset\"")
        && (text.contains("\"meshes\"") || text.contains("\"nodes\""))
        && text.contains("\"accessors\"")
    {
        return Some("a glTF file");
    }
    if line.starts_with("scene.") && line.contains('=') {
        return Some("a scene of LuxCore");
    }
    line.starts_with("#usda").then_some("a USD scene")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_programs_are_known_by_how_they_begin() {
        for (text, name) in [
            ("# pbrt\nLookAt 0 0 5  0 0 0  0 1 0\n", Some("a scene of pbrt")),
            ("Camera \"perspective\" \"float fov\" 40\n", Some("a scene of pbrt")),
            ("<scene version=\"3.0.0\">\n", Some("a Mitsuba scene")),
            ("// a comment\ncamera { location <0, 1, -4> }\n", Some("a scene of POV-Ray")),
            ("#version 3.7;\n", Some("a scene of POV-Ray")),
            ("{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [], \"accessors\": []}", Some("a glTF file")),
            ("scene.camera.type = \"perspective\"\n", Some("a scene of LuxCore")),
            ("#usda 1.0\ndef Sphere \"S\" {}\n", Some("a USD scene")),
            ("Camera: { perspective: {} }\n", None),
            ("camera: { perspective: {} }\n", None),
            ("Scale: 2\n", None),
            ("{ camera: { perspective: {} } }", None),
            ("", None),
        ] {
            let found = program(FileId(0), text).map(|d| d.message);
            let found = found.as_deref().map(|found| found.split(", which").next().unwrap_or(found));
            let want = name.map(|name| format!("this is {name}"));
            assert_eq!(found, want.as_deref(), "{text}");
        }
    }
}
