//! Memory: what is forecast is what is taken, and more than there may be is refused before it is taken.

use crate::common::Folder;
use std::fmt::Write as _;

const CAMERA: &str = "camera: { perspective: { eye: [0, 1, 6], look_at: [0, 0, 0], fov: 40 } }\n\
                      integrator: { path: { max_depth: 1 } }\nsampler: { spp: 1 }\n";
const SKY: &str = "lights: [environment: { radiance: [1, 1, 1] }]\n";

/// Numbers from 0 to 1 that look random.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1_u64 << 24) as f64
    }

    /// A place in a box in front of the camera.
    fn place(&mut self) -> String {
        let [x, y, z] = [4.0, 2.0, 4.0].map(|side| (self.next() - 0.5) * side);
        format!("[{x:.4}, {y:.4}, {z:.4}]")
    }
}

fn ball() -> String {
    format!("{CAMERA}world: [sphere: {{}}]\n{SKY}")
}

/// A text with so many nodes of the world.
fn many(head: &str, count: usize, node: &str) -> String {
    let mut numbers = Numbers(1);
    let mut text = format!("{CAMERA}film: {{ size: [64, 32] }}\n{head}world:\n");
    for _ in 0..count {
        let _ = writeln!(text, "  - {}", node.replace("PLACE", &numbers.place()));
    }
    text + SKY
}

/// A sheet of 2 x N x N triangles.
fn sheet(n: usize) -> Vec<u8> {
    let mut numbers = Numbers(2);
    let (vertices, faces) = ((n + 1) * (n + 1), 2 * n * n);
    let mut ply = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    for i in 0..vertices {
        let [x, z] = [i % (n + 1), i / (n + 1)].map(|k| (k as f32 / n as f32 - 0.5) * 4.0);
        for v in [x, 0.02 * numbers.next() as f32, z] {
            ply.extend(v.to_le_bytes());
        }
    }
    for k in 0..n * n {
        let a = (k / n * (n + 1) + k % n) as u32;
        let (b, c, d) = (a + 1, a + n as u32 + 1, a + n as u32 + 2);
        for corner in [[a, c, b], [b, c, d]] {
            ply.push(3);
            corner.iter().for_each(|i| ply.extend(i.to_le_bytes()));
        }
    }
    ply
}

/// A grey picture.
fn grey(width: usize, height: usize) -> Vec<u8> {
    let mut pfm = format!("PF\n{width} {height}\n-1.0\n").into_bytes();
    (0..3 * width * height).for_each(|_| pfm.extend(0.5_f32.to_le_bytes()));
    pfm
}

/// Ten scenes whose memory goes to different things; each takes more than 100 MB, so that the program's own counts for little.
#[test]
fn ten_forecasts_are_within_a_tenth() {
    let folder = Folder::new();
    folder.write("ball.yaml", &ball());
    folder.write("spheres.yaml", &many("", 60_000, "sphere: { center: PLACE, radius: 0.01 }"));
    let object =
        "objects: { ball: { group: { children: [sphere: { radius: 0.01 }, disc: { radius: 0.02 }] } } }\n";
    folder
        .write("copies.yaml", &many(object, 60_000, "instance: { of: ball, transform: [translate: PLACE] }"));
    folder.write(
        "pots.yaml",
        &many("", 8, "bezier: { builtin: teapot, resolution: 48, transform: [translate: PLACE] }"),
    );
    folder.write("lights.yaml", &many("", 120_000, "sphere: { center: PLACE, radius: 0.003, emission: 1 }"));
    std::fs::write(folder.path("sheet.ply"), sheet(600)).unwrap();
    folder.write(
        "sheet.yaml",
        &format!("{CAMERA}film: {{ size: [64, 32] }}\nworld: [mesh: {{ file: sheet.ply }}]\n{SKY}"),
    );
    std::fs::write(folder.path("sky.pfm"), grey(2400, 1200)).unwrap();
    let sky = format!(
        "{CAMERA}film: {{ size: [64, 32] }}\nworld: [sphere: {{}}]\nlights: [environment: {{ file: sky.pfm }}]\n"
    );
    folder.write("sky.yaml", &sky);
    let wide = format!(
        "{CAMERA}film: {{ filter: {{ gaussian: {{ radius: 6, sigma: 2 }} }} }}\nworld: [sphere: {{}}]\n{SKY}"
    );
    folder.write("wide.yaml", &wide);
    let scenes = [
        "ball.yaml --size 1600x1000 -o a.png",
        "ball.yaml --size 1000x700 -o a.exr",
        "ball.yaml --size 700x400 --spectral --channels spectral -o a.exr",
        "wide.yaml --size 700x500 --splat -o a.png",
        "spheres.yaml -o a.png",
        "copies.yaml -o a.png",
        "pots.yaml -o a.png",
        "lights.yaml -o a.png",
        "sheet.yaml -o a.png",
        "sky.yaml -o a.exr",
    ];
    let mut off = Vec::new();
    for words in scenes {
        let told = folder.json(&format!("check {words} --threads 2"));
        let forecast = told["memory_bytes"]["total"].as_u64().unwrap();
        let report = folder.json(&format!("render {words} --threads 2"));
        // Elsewhere than on Linux the truth isn't known.
        let Some(truth) = report["peak_memory_bytes"].as_u64() else { continue };
        let ratio = truth as f64 / forecast as f64;
        if !(0.9..=1.1).contains(&ratio) || truth < 100_000_000 {
            off.push(format!(
                "{words}: {truth} bytes, {ratio:.3} times what was said: {}",
                told["memory_bytes"]
            ));
        }
    }
    assert!(off.is_empty(), "{off:#?}");
}

#[test]
fn too_much_is_refused_before_it_is_taken() {
    let folder = Folder::with_scene(&ball());
    folder.write("pots.yaml", &many("", 100, "bezier: { builtin: teapot, resolution: 256 }"));
    folder.write("text.yaml", &format!("# {}\n{}", "x".repeat(60_000_000), ball()));
    for (words, cause) in [
        ("scene.yaml --size 6000x5000 -o a.exr --memory 2G", "--size"),
        ("scene.yaml --size 2000x1000 --memory 100M", "for the film"),
        ("pots.yaml --memory 4G", "`resolution`"),
        ("text.yaml --memory 150M", "reading `text.yaml`"),
    ] {
        for command in ["render", "check"] {
            let run = folder.straal(&format!("{command} {words}"));
            assert_eq!(run.code, Some(3), "{command} {words}: {run:?}");
            assert!(
                run.err.contains(cause) && run.err.contains(" may be used"),
                "{command} {words}: {}",
                run.err
            );
            assert!(run.err.contains("--memory says how much may be used"), "{}", run.err);
        }
    }
    assert_eq!(folder.names(), ["pots.yaml", "scene.yaml", "text.yaml"]);
    // Nothing is tessellated to count.
    let report = folder.straal("check pots.yaml --memory 4G --json").json();
    assert_eq!(
        (report["triangles"].as_u64(), report["fits"].as_bool()),
        (Some(100 * 32 * 256 * 256 * 2), Some(false))
    );
    assert_eq!(folder.straal("render scene.yaml --memory 1G").code, Some(0));
}

#[test]
fn more_threads_than_are_of_use_are_not_started() {
    let folder = Folder::with_scene(&format!("film: {{ size: [32, 16] }}\n{}", ball()));
    let run = folder.straal("render scene.yaml --threads 4096");
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(run.err.contains("note: 4096 threads would only wait for one another"), "{run:?}");
}
