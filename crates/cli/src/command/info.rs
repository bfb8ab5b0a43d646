//! `straal info`

use super::{print, read_bytes};
use crate::args::InfoArgs;
use crate::exit::{Exit, Failure};
use serde_json::{Map, Value as Json, json};
use straal_formats::image::{exr, png};
use straal_formats::{Limits, ReadError};

/// What a picture tells of itself.
struct Story {
    size: [usize; 2],
    layers: Vec<String>,
    facts: Vec<(String, String)>,
}

/// Prints a picture's story.
pub fn run(args: &InfoArgs) -> Result<Exit, Failure> {
    let bytes = read_bytes(&args.picture)?;
    let story =
        read(&bytes).map_err(|e| Failure::input(format!("can't read {}: {e}", args.picture.display())))?;
    if args.json {
        print(&format!("{:#}\n", story.as_json()))?;
    } else {
        print(&story.tell())?;
    }
    Ok(Exit::Fine)
}

fn read(bytes: &[u8]) -> Result<Story, ReadError> {
    if bytes.starts_with(&[0x89, b'P', b'N', b'G']) {
        let told = png::read_metadata(bytes, &Limits::default())?;
        let size = [told.size.0 as usize, told.size.1 as usize];
        return Ok(Story { size, layers: Vec::new(), facts: told.texts });
    }
    if !bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        return Err(ReadError::file("only EXR and PNG pictures tell a story"));
    }
    let picture = exr::read(bytes, &Limits::default())?;
    let layers = picture.layers.iter().map(|layer| {
        let channels: Vec<&str> = layer.channels.iter().map(|c| c.name.as_str()).collect();
        match layer.name.as_str() {
            "" => channels.join(" "),
            name => format!("{name} ({})", channels.join(" ")),
        }
    });
    Ok(Story {
        size: [picture.display_window.width, picture.display_window.height],
        layers: layers.collect(),
        facts: picture.metadata,
    })
}

impl Story {
    fn tell(&self) -> String {
        let mut rows = vec![("picture".to_owned(), format!("{} x {} pixels", self.size[0], self.size[1]))];
        if !self.layers.is_empty() {
            rows.push(("layers".to_owned(), self.layers.join(", ")));
        }
        rows.extend(self.facts.iter().map(|(key, value)| (key.clone(), printable(value))));
        let width = rows.iter().map(|(key, _)| key.chars().count()).fold(0, Ord::max);
        rows.iter().map(|(key, value)| format!("{:<width$}  {value}\n", printable(key))).collect()
    }

    fn as_json(&self) -> Json {
        let facts = self.facts.iter().map(|(key, value)| (key.clone(), json!(value)));
        json!({ "size": self.size, "layers": self.layers, "metadata": Json::Object(facts.collect::<Map<_, _>>()) })
    }
}

/// Text of a file that anybody may have made, as a terminal can show it.
fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stories_are_told_in_columns() {
        let facts = vec![("straal.seed".into(), "7".into()), ("who".into(), "me\x1b[2J".into())];
        let story = Story { size: [4, 3], layers: vec!["B G R".into(), "depth (Z)".into()], facts };
        let want =
            "picture      4 x 3 pixels\nlayers       B G R, depth (Z)\nstraal.seed  7\nwho          me [2J\n";
        assert_eq!(story.tell(), want);
        assert_eq!(story.as_json()["metadata"]["straal.seed"], "7");
    }

    #[test]
    fn other_files_have_none() {
        assert!(
            read(b"hello").is_err() && read(b"").is_err() && read(&[0x89, b'P', b'N', b'G', 13]).is_err()
        );
    }
}
