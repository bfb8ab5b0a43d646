//! Files of other kinds, told by their names and their first bytes.

/// What a file with this extension is, if straal knows it and doesn't read it.
pub(crate) fn kind(extension: &str) -> Option<&'static str> {
    Some(match extension {
        "pbrt" => "a scene of pbrt",
        "xml" => "perhaps a scene of Mitsuba",
        "gltf" | "glb" => "a scene in glTF",
        "usd" | "usda" | "usdc" | "usdz" => "a scene in USD",
        "blend" | "blend1" => "a file of Blender",
        "max" | "3ds" | "ma" | "mb" | "c4d" | "hip" | "hipnc" | "skp" | "3dm" | "dwg" | "dxf" => {
            "a file of another program"
        }
        "fbx" | "dae" | "abc" | "x3d" | "wrl" | "vrml" | "lwo" | "lws" => "a scene in another format",
        "stl" | "off" | "3mf" | "amf" | "ifc" | "serialized" | "bin" => "a mesh in another format",
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

/// Whether one of a scene's keys is in a text, as a key.
pub(crate) fn looks_like_a_scene(bytes: &[u8]) -> bool {
    const KEYS: [&str; 10] = [
        "camera",
        "film",
        "color",
        "sampler",
        "integrator",
        "accel",
        "materials",
        "objects",
        "world",
        "lights",
    ];
    let is_key = |key: &str| {
        memchr::memmem::find_iter(bytes, key.as_bytes()).any(|at| {
            let begins = bytes[..at].last().is_none_or(|b| b"\n\r{,\"' \t\xbf".contains(b));
            let behind = bytes[at + key.len()..].trim_ascii_start();
            let behind = behind.strip_prefix(b"\"").or_else(|| behind.strip_prefix(b"'")).unwrap_or(behind);
            begins && behind.trim_ascii_start().first() == Some(&b':')
        })
    };
    KEYS.iter().any(|key| is_key(key))
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
