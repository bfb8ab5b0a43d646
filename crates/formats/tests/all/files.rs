//! Which files are read, where they are found, and how far.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use straal_formats::files::{self, Finder};
use straal_formats::{Diagnostics, Loaded, Options, load, load_str};
use straal_scene::Severity;
use tempfile::TempDir;

const CAMERA: &str = "camera: { perspective: { eye: [0, 0, 5], look_at: [0, 0, 0] } }\n";
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

/// A folder with these files.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn load_in(folder: &TempDir, name: &str) -> Result<Loaded, Diagnostics> {
    load(&folder.path().join(name), &Options::default())
}

/// What is told, but for notes.
fn said(d: &Diagnostics) -> String {
    d.list.iter().filter(|told| told.severity != Severity::Note).map(|told| d.render(told)).collect()
}

/// What is told of a mesh, errors or warnings.
fn told(folder: &TempDir, name: &str) -> String {
    load_in(folder, name).map_or_else(|d| said(&d), |loaded| said(&loaded.warnings))
}

/// What a scene with this mesh tells, loaded within `root`.
fn told_of(folder: &TempDir, mesh: &str, root: Option<&Path>) -> String {
    let text = format!("{CAMERA}world:\n  - mesh: {{ file: '{mesh}', emission: 1 }}\n");
    let options = Options { root: root.map(Path::to_owned), ..Options::default() };
    match load_str("scene.yaml", &text, folder.path(), &options) {
        Ok(loaded) => loaded.warnings.to_string(),
        Err(complaints) => complaints.to_string(),
    }
}

#[test]
fn material_libraries_are_found_by_names_from_elsewhere() {
    let paints = "newmtl red\nKd 0.8 0.1 0.1\n";
    let found = |line: &str| {
        let obj = format!("mtllib {line}\n{TRIANGLE}usemtl red\nf 1 2 3\n");
        let folder = folder(&[("a.obj", &obj), ("red.mtl", paints), ("mats/my Blue.mtl", paints)]);
        let loaded = load_in(&folder, "a.obj").unwrap_or_else(|e| panic!("{line}: {e}"));
        let asset = loaded.assets.meshes.iter().next().unwrap();
        assert!(asset.materials.contains_key("red"), "{line}: {}", loaded.warnings);
        said(&loaded.warnings)
    };
    for line in [
        "red.mtl",
        r".\red.mtl",
        "\"red.mtl\"",
        "./red.mtl",
        "red.mtl # by hand",
        r"\red.mtl",
        r#"".\red.mtl" # x"#,
        r"mats\my Blue.mtl",
        r#""mats\my Blue.mtl""#,
        "none.mtl mats/my Blue.mtl",
    ] {
        let told = found(line);
        assert!(told.is_empty() || line.starts_with("none"), "{line}: {told}");
    }
    for (line, instead) in [
        ("RED.mtl", "red.mtl"),
        (r"Mats\My blue.MTL", "mats/my Blue.mtl"),
        (r"C:\Users\me\red.mtl", "red.mtl"),
        ("/home/me/models/red.mtl", "red.mtl"),
        (r"..\elsewhere\red.mtl", "red.mtl"),
    ] {
        let told = found(line);
        assert!(told.contains(&format!("'{instead}' is read")), "{line}: {told}");
    }
}

#[test]
fn scenes_too_may_come_from_elsewhere() {
    let text = format!(
        "\u{feff}# by hand\n{CAMERA}world:\n  - mesh: {{ file: a.ply, emission: 1 }}\n  - shpere: {{}}\n"
    );
    for end in ["\r", "\r\n", "\n"] {
        let folder = folder(&[("a.ply", PLY), ("scene.yaml", &text.replace('\n', end))]);
        let told = told(&folder, "scene.yaml");
        assert!(
            told.contains("scene.yaml:5:5: error: unknown") && told.contains("5 |   - shpere: {}\n"),
            "{end:?}: {told}"
        );
    }
}

#[test]
fn of_two_files_that_differ_by_case_none_is_taken() {
    let folder = folder(&[("Red.ply", PLY), ("rEd.ply", PLY), ("one/Blue.ply", PLY)]);
    let is_case_blind = folder.path().join("RED.PLY").exists();
    let two = told_of(&folder, "red.ply", None);
    assert!(is_case_blind || two.contains("there is no such file"), "{two}");
    let one = told_of(&folder, "ONE/blue.ply", None);
    assert!(
        is_case_blind || one.contains("there is no file `ONE/blue.ply`: `one/Blue.ply` is read"),
        "{one}"
    );
    assert_eq!(told_of(&folder, r"one\Blue.ply", None), "");
}

#[test]
fn what_is_something_else_is_told_as_what_it_is() {
    let lfs = "version https://git-lfs.github.com/spec/v1\noid sha256:aa\nsize 12\n";
    let folder = folder(&[
        ("empty.ply", ""),
        ("empty.obj", ""),
        ("empty.yaml", ""),
        ("lfs.ply", lfs),
        ("lfs.obj", lfs),
        ("lfs.yaml", lfs),
        ("a.stl", "solid a\n"),
        ("stl.ply", "solid a\n"),
        ("page.ply", "<!DOCTYPE html>\n"),
        ("a.bin.obj", "a\0b"),
        ("annex.ply", "/annex/objects/SHA\n"),
        ("a.off", "OFF\n"),
        ("a.png", "x"),
        ("noname", "x"),
        ("ply.txt", PLY),
    ]);
    fs::write(folder.path().join("zip.ply"), b"PK\x03\x04").unwrap();
    fs::write(folder.path().join("wide.obj"), b"\xff\xfev\0 \x000\0").unwrap();
    for (name, says) in [
        ("empty.ply", "the file is empty"),
        ("empty.obj", "the file is empty"),
        ("empty.yaml", "the file is empty"),
        ("lfs.ply", "pointer of Git LFS"),
        ("lfs.obj", "git lfs pull"),
        ("lfs.yaml", "pointer of Git LFS"),
        ("annex.ply", "git annex get"),
        ("a.stl", "the mesh is empty"),
        ("stl.ply", "is an STL file"),
        ("page.ply", "a web page"),
        ("zip.ply", "packed by zip"),
        ("wide.obj", "UTF-16"),
        ("a.bin.obj", "is no text"),
        ("a.off", "a mesh in another format"),
        ("a.png", "a picture"),
    ] {
        let text = told(&folder, name);
        assert!(text.contains(says), "{name}: {text}");
    }
    for (name, says) in [
        ("a.off", "a mesh in another format: a mesh must be a .ply, .obj or .stl file, found .off"),
        ("noname", "no extension"),
        ("lfs.ply", "LFS"),
        ("ply.txt", ""),
    ] {
        let text = told_of(&folder, name, None);
        assert!(text.contains(says) && text.is_empty() == says.is_empty(), "{name}: {text}");
    }
}

#[test]
fn nothing_of_a_file_of_another_kind_is_shown() {
    let secret = "root:hunter2:19000:0:99999\nkey: hunter2\n";
    let obj = format!("mtllib shadow.mtl\nmtllib shadow\n{TRIANGLE}f 1 2 3\n");
    let folder = folder(&[
        ("shadow", secret),
        ("shadow.yaml", secret),
        ("shadow.json", secret),
        ("shadow.obj", secret),
        ("shadow.ply", secret),
        ("shadow.mtl", secret),
        ("shadow.spd", secret),
        ("shadow.hdr", secret),
        ("a.obj", &obj),
        ("two.yaml", "hunter2\n---\n{"),
    ]);
    for name in ["shadow", "shadow.yaml", "shadow.json", "shadow.obj", "shadow.ply", "a.obj", "two.yaml"] {
        let text = told(&folder, name);
        assert!(!text.is_empty() && !text.contains("hunter2"), "{name}: {text}");
    }
    for line in [
        "world: [mesh: { file: shadow }]",
        "world: [mesh: { file: shadow.obj }]",
        "lights: [environment: { file: shadow.hdr }]",
        "lights: [environment: { radiance: { file: shadow.spd } }]",
    ] {
        let text = load_str("scene.yaml", &format!("{CAMERA}{line}\n"), folder.path(), &Options::default());
        let text = text.map_or_else(|d| d.to_string(), |l| l.warnings.to_string());
        assert!(text.contains("shadow") && !text.contains("hunter2"), "{line}: {text}");
    }
    // What is a scene is shown with its mistake.
    fs::write(folder.path().join("scene"), "wrold: []\nfilm: { sice: [1, 2] }\n").unwrap();
    assert!(told(&folder, "scene").contains("sice"));
}

#[cfg(unix)]
#[test]
fn what_never_ends_is_not_read() {
    let folder = folder(&[("a.txt", "")]);
    let fifo = folder.path().join("fifo.ply");
    assert!(std::process::Command::new("mkfifo").arg(&fifo).status().unwrap().success());
    let start = Instant::now();
    for path in
        [fifo.to_str().unwrap(), "/dev/zero", "/dev/tty", "/proc/kmsg", "/proc/self/mem", "/proc/kcore"]
    {
        if Path::new(path).exists() {
            let told = files::read(path.as_ref(), 1 << 40).unwrap_err().problem;
            assert!(told.contains("not a plain"), "{path}: {told}");
            let mesh = told_of(&folder, path, None);
            assert!(mesh.contains("cannot read"), "{path}: {mesh}");
        }
    }
    fs::write(folder.path().join("a.obj"), format!("mtllib fifo.ply\nmtllib /dev/zero\n{TRIANGLE}f 1 2 3\n"))
        .unwrap();
    assert!(told(&folder, "a.obj").contains("'fifo.ply' is not read: it is not a plain file"));
    assert!(told(&folder, "fifo.ply").contains("not a plain file"));
    assert!(start.elapsed() < Duration::from_secs(60));
    let large = files::read(&folder.path().join("a.obj"), 5).unwrap_err();
    assert!(large.problem.ends_with("bytes, more than 5"), "{large}");
}

#[test]
fn a_root_confines_what_is_read() {
    let outside = "../secret.ply";
    let obj = format!("mtllib ../secret.mtl\n{TRIANGLE}f 1 2 3\n");
    let folder = folder(&[
        ("secret.ply", PLY),
        ("secret.mtl", "newmtl a\n"),
        ("in/a.ply", PLY),
        ("in/sub/b.ply", PLY),
        ("in/lib.obj", &obj),
    ]);
    let root = folder.path().join("in");
    let inside = |mesh: &str| {
        let text = format!("{CAMERA}world:\n  - mesh: {{ file: '{mesh}', emission: 1 }}\n");
        let options = Options { root: Some(root.clone()), ..Options::default() };
        load_str("scene.yaml", &text, &root, &options)
            .map_or_else(|d| d.to_string(), |l| l.warnings.to_string())
    };
    let (real, absolute) = (root.canonicalize().unwrap(), folder.path().join("secret.ply"));
    for mesh in [
        "a.ply",
        "sub/b.ply",
        "sub/../a.ply",
        "../in/a.ply",
        root.join("a.ply").to_str().unwrap(),
        r"sub\B.ply",
    ] {
        let told = inside(mesh);
        assert!(told.is_empty() || mesh.contains('B') && told.contains("is read"), "{mesh}: {told}");
    }
    // Whether there is such a file is not told.
    for mesh in [
        outside,
        "../nothing.ply",
        absolute.to_str().unwrap(),
        "/etc/passwd",
        "/nothing/at/all.ply",
        "no/../../x.ply",
        r"..\secret.ply",
    ] {
        let told = inside(mesh);
        let says = format!("lies outside of `{}`", real.display());
        assert!(told.contains(&says) && told.contains("--root"), "{mesh}: {told}");
        assert!(!told.contains("did you mean") && !told.contains("no such file"), "{mesh}: {told}");
    }
    let told = inside("lib.obj");
    assert!(told.contains("secret.mtl` lies outside of"), "{told}");
    assert!(inside("no.ply").contains("there is no such file"));
    assert!(
        Finder::new(Some(&folder.path().join("none")))
            .unwrap_err()
            .problem
            .contains("there is no such folder")
    );
    assert!(Finder::new(Some(&absolute)).unwrap_err().problem.contains("it is not a folder"));
}

#[cfg(unix)]
#[test]
fn links_do_not_lead_out_of_a_root() {
    use std::os::unix::fs::symlink;
    let folder = folder(&[("secret.ply", PLY), ("out/a.ply", PLY), ("in/a.ply", PLY), ("in/sub/b.ply", PLY)]);
    let root = folder.path().join("in");
    symlink("../secret.ply", root.join("link.ply")).unwrap();
    symlink("../out", root.join("linked")).unwrap();
    symlink("sub/b.ply", root.join("fine.ply")).unwrap();
    symlink(&root, folder.path().join("alias")).unwrap();
    let scene = format!("{CAMERA}world: [mesh: {{ file: ../in/a.ply, emission: 1 }}]\n");
    fs::write(folder.path().join("out/scene.yaml"), scene).unwrap();
    symlink("../out/scene.yaml", root.join("scene.yaml")).unwrap();
    for root in [root.clone(), folder.path().join("alias")] {
        let load = |path: &Path| {
            let options = Options { root: Some(root.clone()), ..Options::default() };
            load(path, &options).map_or_else(|d| said(&d), |l| said(&l.warnings))
        };
        let inside = |name: &str| load(&root.join(name));
        assert_eq!(inside("fine.ply"), "");
        assert_eq!(inside("a.ply"), "");
        for name in ["link.ply", "linked/a.ply", "scene.yaml"] {
            let told = inside(name);
            assert!(told.contains("lies outside of"), "{name}: {told}");
        }
        let link = |mesh: &str| told_of_in(&root, mesh);
        assert!(
            link("link.ply").contains("lies outside of") && link("linked/a.ply").contains("lies outside of")
        );
        // The scene itself is the caller's choice, unless the folder's own name for it leads out.
        assert_eq!(load(&folder.path().join("out/scene.yaml")), "");
    }
}

#[cfg(unix)]
fn told_of_in(root: &Path, mesh: &str) -> String {
    let text = format!("{CAMERA}world:\n  - mesh: {{ file: '{mesh}', emission: 1 }}\n");
    let options = Options { root: Some(root.to_owned()), ..Options::default() };
    load_str("scene.yaml", &text, root, &options).map_or_else(|d| d.to_string(), |l| l.warnings.to_string())
}
