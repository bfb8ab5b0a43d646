//! The meshes on which searches are timed.

use super::common::{Random, icosphere};
use std::path::PathBuf;
use straal_math::Vec3;

/// A mesh with a name.
pub struct Mesh {
    pub name: &'static str,
    pub positions: Vec<Vec3>,
    pub indices: Vec<[u32; 3]>,
}

/// The Stanford bunny of the shared data, if it is there.
pub fn bunny() -> Option<Mesh> {
    let shared = std::env::var_os("STRAAL_SHARED").map(PathBuf::from);
    let shared = shared.unwrap_or_else(|| concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared").into());
    let text = std::fs::read_to_string(shared.join("scenes/meshes/stanford-bunny/bun_zipper.ply")).ok()?;
    let (positions, indices) = read_ply(&text);
    Some(Mesh { name: "bunny", positions, indices })
}

/// An icosphere of 20 * 4^levels triangles with bumps of three sizes.
pub fn sphere(name: &'static str, levels: u32) -> Mesh {
    let (p, i) = icosphere(levels);
    let bump = |p: Vec3| 1.0 + 0.1 * (p.x * 9.0).sin() * (p.y * 11.0).sin() + 0.01 * (p.z * 90.0).sin();
    Mesh { name, positions: p.iter().map(|&p| p * bump(p)).collect(), indices: i.to_vec() }
}

/// A room of 1.5 million triangles: walls of long thin boards, thin slanting beams all over, and on the floor small
/// dense balls. Boxes around long slanting triangles are nearly empty and overlap: the hard case of a tree of boxes.
pub fn room() -> Mesh {
    let mut out = Mesh { name: "room", positions: Vec::new(), indices: Vec::new() };
    let mut r = Random(77);
    let (w, h) = (10.0, 4.0);
    let boards = 12_000;
    for i in 0..boards {
        let (a, b) = (i as f32 / boards as f32 * w, (i + 1) as f32 / boards as f32 * w);
        let quad = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        out.quad([quad(a, 0.0, 0.0), quad(b, 0.0, 0.0), quad(b, 0.0, w), quad(a, 0.0, w)]);
        out.quad([quad(a, h, 0.0), quad(a, h, w), quad(b, h, w), quad(b, h, 0.0)]);
        out.quad([quad(a, 0.0, 0.0), quad(a, h, 0.0), quad(b, h, 0.0), quad(b, 0.0, 0.0)]);
        out.quad([quad(a, 0.0, w), quad(b, 0.0, w), quad(b, h, w), quad(a, h, w)]);
        out.quad([quad(0.0, 0.0, a), quad(0.0, 0.0, b), quad(0.0, h, b), quad(0.0, h, a)]);
        out.quad([quad(w, 0.0, a), quad(w, h, a), quad(w, h, b), quad(w, 0.0, b)]);
    }
    let inside = |r: &mut Random| {
        let p = r.point() * 0.5 + Vec3::splat(0.5);
        Vec3::new(p.x * w, p.y * h, p.z * w)
    };
    for _ in 0..600 {
        let (a, along) = (inside(&mut r), r.direction() * 1.5);
        let side = along.cross(r.direction()).normalize() * 0.003;
        let up = along.cross(side).normalize() * 0.003;
        let corner = |s: f32, t: f32| a + side * s + up * t;
        let c = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        for i in 0..4 {
            let (p, q) = (c[i], c[(i + 1) % 4]);
            out.quad([p, q, q + along, p + along]);
        }
    }
    let (p, t) = icosphere(6);
    for i in 0..16 {
        let radius = 0.2 + 0.1 * (i % 3) as f32;
        let at = Vec3::new(1.0 + 2.4 * (i % 4) as f32, radius, 1.0 + 2.4 * (i / 4) as f32);
        let first = out.positions.len() as u32;
        out.positions.extend(p.iter().map(|&p| at + p * radius * (1.0 + 0.05 * (p.x * 30.0).sin())));
        out.indices.extend(t.iter().map(|t| t.map(|i| i + first)));
    }
    out
}

impl Mesh {
    /// With each triangle cut in two.
    pub fn halved(mut self) -> Self {
        for i in 0..self.indices.len() {
            let [a, b, c] = self.indices[i];
            let middle = self.positions.len() as u32;
            self.positions.push((self.positions[a as usize] + self.positions[b as usize]) * 0.5);
            self.indices[i] = [a, middle, c];
            self.indices.push([middle, b, c]);
        }
        self
    }

    fn quad(&mut self, p: [Vec3; 4]) {
        let i = self.positions.len() as u32;
        self.positions.extend(p);
        self.indices.extend([[i, i + 1, i + 2], [i, i + 2, i + 3]]);
    }
}

/// The least that reads the Stanford meshes.
fn read_ply(text: &str) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let count = |what: &str| {
        let line = text.lines().find_map(|l| l.strip_prefix(what)).expect("a count");
        line.trim().parse::<usize>().expect("a number")
    };
    let (vertices, faces) = (count("element vertex "), count("element face "));
    let mut lines = text.lines().skip_while(|l| *l != "end_header").skip(1);
    let mut rows = |n: usize| lines.by_ref().take(n).map(|l| l.split_whitespace()).collect::<Vec<_>>();
    let positions = rows(vertices)
        .into_iter()
        .map(|mut w| {
            let mut c = || w.next().and_then(|s| s.parse().ok()).expect("a coordinate");
            Vec3::new(c(), c(), c())
        })
        .collect();
    let indices = rows(faces)
        .into_iter()
        .map(|w| {
            let mut w = w.skip(1);
            std::array::from_fn(|_| w.next().and_then(|s| s.parse().ok()).expect("an index"))
        })
        .collect();
    (positions, indices)
}
