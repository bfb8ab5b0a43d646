//! Files of other kinds, told by their names and their first bytes.

use crate::yaml;
use straal_scene::is_of_a_scene;

/// What a file with this extension is, if straal knows it and doesn't read it.
pub(crate) fn kind(extension: &str) -> Option<&'static str> {
    Some(match extension {
        "blend" | "blend1" => "a file of Blender",
        "max" | "3ds" | "ma" | "mb" | "c4d" | "hip" | "hipnc" | "skp" | "3dm" | "dwg" | "dxf" => {
            "a file of another program"
        }
        "fbx" | "dae" | "abc" | "x3d" | "wrl" | "vrml" | "lwo" | "lws" => "a scene in another format",
        "off" | "3mf" | "amf" | "ifc" | "serialized" | "bin" => "a mesh in another format",
        "step" | "stp" | "iges" | "igs" => "a CAD model of exact surfaces",
        "las" | "laz" | "e57" | "pcd" | "xyz" | "pts" => "a cloud of points",
        "mtl" => "a library of materials, which belongs to a mesh",
        "png" | "jpg" | "jpeg" | "exr" | "hdr" | "pfm" | "tif" | "tiff" | "tga" | "bmp" | "webp" | "gif"
        | "svg" => "a picture",
        "zip" | "gz" | "tgz" | "tar" | "bz2" | "xz" | "zst" | "7z" | "rar" => "an archive",
        "mp4" | "mov" | "avi" | "mkv" | "webm" => "a film",
        _ => return None,
    })
}

/// Whether a text has one of a scene's keys, in whatever letters, or of those that other programs have in their place; or is another
/// program's scene, which can be said without telling what is in it.
pub(crate) fn looks_like_a_scene(bytes: &[u8]) -> bool {
    const LONGEST: usize = 24;
    let text = String::from_utf8_lossy(bytes);
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let keys = text.match_indices(':').filter_map(|(at, _)| {
        let before = text[..at].trim_end().trim_end_matches(['"', '\'']);
        let start = before
            .rfind(|c: char| !is_word(c))
            .map_or(0, |i| i + before[i..].chars().next().map_or(1, char::len_utf8));
        let begins = before[..start].chars().next_back().is_none_or(|c| "\n\r{,\"' \t\u{feff}".contains(c));
        Some(&before[start..]).filter(|word| begins && !word.is_empty() && word.len() <= LONGEST)
    });
    { keys }.any(is_of_a_scene) || yaml::is_of_another_program(&text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_told_from_other_texts() {
        for text in [
            "camera:\n",
            "\u{feff}world: []",
            "{\"film\": {}}",
            "# a\n\rlights :\n",
            "{accel: bvh, x: 1}",
            "'color' : a",
            "Camera:\n",
            "sensor: {}",
            "LookAt 0 0 5 0 0 0 0 1 0\nWorldBegin\n",
        ] {
            assert!(looks_like_a_scene(text.as_bytes()), "{text}");
        }
        for text in [
            "root:$6$abc:19000:0\n",
            "key: value\n",
            "my_camera: 1",
            "the world is round",
            "world",
            "-----BEGIN KEY-----",
        ] {
            assert!(!looks_like_a_scene(text.as_bytes()), "{text}");
        }
    }
}
