//! Tables of figures, worked out anew each time: counts and errors, no times, so that they are the same on every machine.

use super::sampling_tables;
use crate::{Failure, root};
use std::fmt::Write;
use std::sync::Arc;
use straal::{Isa, LoadOptions};
use straal_accel::{
    BspParams, Bvh2Params, Cost, Geometry, GeometryKind, GridParams, Group, Input, KdParams, OctreeParams,
    Options, Scene, Split, Structure,
};
use straal_color::Light;
use straal_math::lowdisc::PatternKind;
use straal_math::{Ray, Vec3, ops};
use straal_render::material::{Bsdf, Form, Glossy, Phong, Scale, Transport};
use straal_study::lab::{self, Contender};
use straal_study::points::{Course, Request, figures};

/// A table by its name; nothing where files that it takes aren't here.
pub fn table(name: &str) -> Result<Option<String>, Failure> {
    let rows = match name {
        "patterns" => patterns(),
        "grid-factors" => grid_factors()?,
        "bvh2-splits" => bvh2_splits()?,
        "structures" => structures()?,
        "lab-counts" => lab_counts()?,
        "highlights" => highlights(),
        "told-errors" => sampling_tables::told_errors()?,
        "splat-bias" => sampling_tables::splat_bias()?,
        _ => return Err("there is no such table".into()),
    };
    let mut out = String::from("\n");
    for (i, row) in rows.iter().enumerate() {
        let _ = writeln!(out, "| {} |", row.join(" | "));
        if i == 0 {
            let _ = writeln!(out, "|{}", "---|".repeat(row.len()));
        }
    }
    out.push('\n');
    Ok(Some(out))
}

/// The heading and the rows.
pub type Rows = Vec<Vec<String>>;

pub fn row<T: ToString>(cells: impl IntoIterator<Item = T>) -> Vec<String> {
    cells.into_iter().map(|c| c.to_string()).collect()
}

/// Two figures, or whole numbers from 10 on; with commas between thousands.
fn number(v: f64) -> String {
    match v {
        v if v >= 9.95 => lab::table::whole(v.round() as u64),
        v => format!("{v:.1}"),
    }
}

/// What `straal sampler` says of 64 points.
fn patterns() -> Rows {
    let course = Course::new();
    let mut out = vec![row(["64 points", "L2-star discrepancy", "RMS error to 3.79", "RMS error to 10.83"])];
    for kind in PatternKind::ALL {
        let f = figures(&Request { kind, count: 64, seed: 0, dimensions: [0, 1] }, &course);
        out.push(row([
            format!("`{}`", kind.name()),
            format!("{:.5}", f.discrepancy),
            format!("{:.5}", f.aliasing[0]),
            format!("{:.5}", f.aliasing[1]),
        ]));
    }
    out
}

/// Of light from a direction, how much a highlight sends back.
fn highlights() -> Rows {
    const ANGLES: [f64; 3] = [0.0, 60.0, 85.0];
    let white = Light::rgb([1.0; 3]);
    let phong = |exponent, blinn, scale| {
        let form = Form { blinn, scale };
        let dark = Light::ZERO;
        Bsdf::Phong(Phong { diffuse: dark, ambient: dark, specular: white, exponent, form, two_sided: true })
    };
    let glossy = |exponent| Bsdf::Glossy(Glossy { reflectance: white, exponent, two_sided: true });
    let mut out = vec![row(["highlight", "e", "from 0 degrees", "from 60 degrees", "from 85 degrees"])];
    for e in [1.0, 10.0, 100.0] {
        for (name, bsdf) in [
            ("Phong, `normalised`", phong(e, false, Scale::Normalised)),
            ("Phong, `textbook`", phong(e, false, Scale::Textbook)),
            ("Phong, `classic`", phong(e, false, Scale::Classic)),
            ("Blinn, `normalised`", phong(e, true, Scale::Normalised)),
            ("Blinn, `textbook`", phong(e, true, Scale::Textbook)),
            ("`glossy`", glossy(e)),
        ] {
            let shares = ANGLES.map(|angle| format!("{:.2}", sent_back(&bsdf, angle)));
            out.push(row([name.to_owned(), format!("{e}")].into_iter().chain(shares)));
        }
    }
    out
}

/// The integral over where light goes, which is that of f |cos| with the two directions exchanged, for light from an angle in degrees.
fn sent_back(bsdf: &Bsdf<'_>, angle: f64) -> f64 {
    const RINGS: u32 = 160;
    let (sin, cos) = ops::sin_cos_degrees(angle);
    let from = Vec3::new(sin as f32, 0.0, cos as f32);
    let mut sum = 0.0;
    for i in 0..RINGS {
        let (s, c) = ops::sin_cos_degrees((f64::from(i) + 0.5) * 90.0 / f64::from(RINGS));
        for j in 0..2 * RINGS {
            let (sp, cp) = ops::sin_cos_degrees((f64::from(j) + 0.5) * 180.0 / f64::from(RINGS));
            let to = Vec3::new((s * cp) as f32, (s * sp) as f32, c as f32);
            // f |cos from| of light that comes from there and goes to `to`.
            let value = f64::from(bsdf.eval(to, from, Transport::Radiance)[0]);
            sum += value / cos * c * s;
        }
    }
    sum * (0.5 * std::f64::consts::PI / f64::from(RINGS)) * (std::f64::consts::PI / f64::from(RINGS))
}

/// Numbers for rays and triangles (Steele et al. 2014, SplitMix64).
struct Random(u64);

impl Random {
    /// In [-1, 1).
    fn signed(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        (z >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn point(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.point();
            if p.length_squared() <= 1.0
                && let Some(d) = p.try_normalize()
            {
                return d;
            }
        }
    }
}

type Triangles = Vec<[Vec3; 3]>;

/// A sphere with bumps: an octahedron whose triangles are cut in four seven times over would be 131,072; this is cut six
/// times, to 32,768.
fn bumpy_sphere() -> Triangles {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let mut out: Triangles = Vec::new();
    for (a, b) in [(x, y), (y, -x), (-x, -y), (-y, x)] {
        out.push([a, b, z]);
        out.push([b, a, -z]);
    }
    for _ in 0..6 {
        out = out
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| (p + q).normalize());
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let bump =
        |p: Vec3| p * (1.0 + 0.05 * ops::sin(12.0 * p.x) * ops::sin(12.0 * p.y) * ops::sin(12.0 * p.z));
    out.iter().map(|t| t.map(bump)).collect()
}

/// The sphere on a floor of 2,048 triangles, a hundred times its size.
fn stadium() -> Triangles {
    let mut out = bumpy_sphere();
    let corner = |i: u16, j: u16| Vec3::new(f32::from(i) * 6.0 - 96.0, -1.1, f32::from(j) * 6.0 - 96.0);
    for i in 0..32 {
        for j in 0..32 {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            out.extend([[a, c, b], [a, d, c]]);
        }
    }
    out
}

/// Long thin triangles in all directions.
fn needles() -> Triangles {
    let mut r = Random(3);
    (0..4000)
        .map(|_| {
            let (at, along) = (r.point(), r.direction() * 0.5);
            [at - along, at + along, at + r.direction() * 0.005]
        })
        .collect()
}

fn input(triangles: &Triangles) -> Input {
    let positions: Arc<[Vec3]> = triangles.iter().flatten().copied().collect();
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Input {
        groups: vec![Group { geometries: vec![0], instances: Vec::new() }],
        geometries: vec![Geometry { kind: GeometryKind::Triangles { positions, indices }, mask: u32::MAX }],
        motions: Vec::new(),
    }
}

/// The structure, and the costs of a mean ray: half of the rays go from a sphere around the object towards a place in it, half start
/// inside of its box.
fn counted(triangles: &Triangles, structure: Structure) -> Result<(Scene, [f64; 3]), Failure> {
    let scene =
        Scene::build(input(triangles), &(), &Options { structure, isa: Isa::Scalar, ..Options::default() })?;
    let mut r = Random(1);
    let rays = 4000;
    let mut sum = [0_u64; 3];
    for i in 0..rays {
        let ray = if i % 2 == 0 {
            let from = r.direction() * 3.0;
            Ray::new(from, r.point() * 0.9 - from)
        } else {
            Ray::new(r.point(), r.direction())
        };
        let Cost { nodes, primitives, duplicates, .. } = scene.closest_counted(&(), &ray).1;
        for (sum, n) in sum.iter_mut().zip([nodes, primitives, duplicates]) {
            *sum += u64::from(n);
        }
    }
    Ok((scene, sum.map(|n| n as f64 / f64::from(rays))))
}

fn grid_factors() -> Result<Rows, Failure> {
    let sphere = bumpy_sphere();
    let mut out = vec![row([
        "`factor`",
        "cells visited",
        "triangles tested",
        "spared by mailboxes",
        "bytes a triangle",
    ])];
    for factor in [1.0, 2.0, 3.0] {
        let (scene, [cells, tested, spared]) =
            counted(&sphere, Structure::Grid(GridParams { factor, ..GridParams::DEFAULT }))?;
        let bytes = scene.memory_bytes() as f64 / sphere.len() as f64;
        out.push(row([format!("{factor}"), number(cells), number(tested), number(spared), number(bytes)]));
    }
    Ok(out)
}

fn bvh2_splits() -> Result<Rows, Failure> {
    let sphere = bumpy_sphere();
    let mut out = vec![row(["`split`", "nodes opened", "triangles tested", "expected cost"])];
    for (name, split) in [
        ("median", Split::Median),
        ("middle", Split::Middle),
        ("sah", Split::Sah),
        ("agglomerative", Split::Agglomerative),
    ] {
        let (scene, [nodes, tested, _]) =
            counted(&sphere, Structure::Bvh2(Bvh2Params { split, ..Bvh2Params::DEFAULT }))?;
        let cost = scene.stats()[0].map_or(0.0, |s| s.sah_cost);
        out.push(row([format!("`{name}`"), number(nodes), number(tested), number(cost)]));
    }
    Ok(out)
}

fn structures() -> Result<Rows, Failure> {
    let all = [
        Structure::Bvh2(Bvh2Params::DEFAULT),
        Structure::Grid(GridParams::DEFAULT),
        Structure::Kd(KdParams::DEFAULT),
        Structure::Octree(OctreeParams::DEFAULT),
        Structure::Bsp(BspParams::DEFAULT),
    ];
    let mut heading = row(["scene", ""]);
    heading.extend(all.map(|s| format!("`{}`", s.name())));
    let mut out = vec![heading];
    for (name, triangles) in [
        ("bumpy sphere", bumpy_sphere()),
        ("the same in a stadium", stadium()),
        ("long thin triangles", needles()),
    ] {
        let name = format!("{name} ({} triangles)", number(triangles.len() as f64));
        let mut rows = [
            row([name.as_str(), "steps"]),
            row(["", "primitives tested"]),
            row(["", "listed, for each triangle"]),
        ];
        for structure in all {
            let (scene, [nodes, tested, _]) = counted(&triangles, structure)?;
            let listed = scene.stats()[0].map_or(0.0, |s| s.references as f64 / triangles.len() as f64);
            for (row, n) in rows.iter_mut().zip([nodes, tested, listed]) {
                row.push(number(n));
            }
        }
        out.extend(rows);
    }
    Ok(out)
}

/// Primitives that a ray of a scene's picture tests, as `straal accel` counts them.
fn lab_counts() -> Result<Rows, Failure> {
    let names = ["bvh", "bvh2", "kd", "octree", "bsp", "grid", "volumes", "brute"];
    let mut heading = row([""]);
    heading.extend(names.map(|n| format!("`{n}`")));
    let mut out = vec![heading];
    for (name, scene) in [
        ("Cornell box", "cornell-box"),
        ("a thousand teapots", "teapots"),
        ("a teapot in a stadium", "stadium"),
    ] {
        let loaded = straal::load(&root().join(format!("scenes/{scene}.yaml")), &LoadOptions::default())
            .map_err(|_| format!("scenes/{scene}.yaml is wrong; see `straal check`"))?;
        let structures: Result<Vec<Contender>, Failure> = names[1..]
            .iter()
            .map(|n| Ok(Contender { name: (*n).to_owned(), structure: n.parse()? }))
            .collect();
        let request = lab::Request {
            structures: Some(structures?),
            rays: 2048,
            // Nothing is timed: only counts are the same on every machine.
            rounds: 0,
            isa: Some(Isa::Scalar),
            ..lab::Request::default()
        };
        let clock: straal::Clock = Arc::new(|| 0);
        let report = lab::run(&loaded, &request, &clock, &mut |_| {})?;
        let mix = report.picture_rays();
        let mut cells = row([format!("{name}, {} primitives", number(report.primitives as f64))]);
        cells.extend(report.rows.iter().map(|r| number(r.mean_tests(&mix, |t| t.primitives))));
        out.push(cells);
    }
    Ok(out)
}
