//! Search structures: drawn from straal's own, built over walls that stand upright on a plan.

use super::Diagram;
use crate::draw::*;
use straal_accel::{
    BspChoice, BspParams, Bvh2Params, Geometry, GeometryKind, GridParams, Group, Input, KdParams,
    OctreeParams, Options, Scene, Section, Split, Structure,
};
use straal_math::{Ray, Vec3, ops};

/// What is drawn here.
pub const ALL: &[Diagram] = &[
    ("tree-of-boxes", tree_of_boxes),
    ("volumes", volumes),
    ("grid", grid),
    ("splits", splits),
    ("cells", cells),
];

/// A wall on the plan, from place to place.
type Wall = [[f32; 2]; 2];

/// The walls of a many-sided tower.
fn tower(at: [f32; 2], radius: f32, sides: u8) -> Vec<Wall> {
    let corner = |i: u8| on_circle(at, radius, 360.0 * f32::from(i) / f32::from(sides) + 10.0);
    (0..sides).map(|i| [corner(i), corner(i + 1)]).collect()
}

/// A few slanted walls and a small dense tower.
fn town() -> Vec<Wall> {
    let mut walls = vec![
        [[0.4, 0.6], [2.6, 1.3]],
        [[1.0, 4.6], [2.4, 6.8]],
        [[3.6, 4.7], [5.2, 5.6]],
        [[4.4, 7.4], [6.6, 7.0]],
        [[6.4, 1.0], [7.8, 0.7]],
        [[10.6, 5.6], [11.6, 7.5]],
    ];
    walls.extend(tower([8.7, 4.0], 0.62, 12));
    walls
}

/// Huge surroundings of a tiny tower.
fn stadium() -> Vec<Wall> {
    let mut walls = vec![
        [[0.2, 0.2], [11.8, 0.4]],
        [[11.8, 0.6], [11.6, 7.8]],
        [[11.4, 7.8], [0.3, 7.7]],
        [[0.2, 7.4], [0.3, 0.4]],
    ];
    walls.extend(tower([7.2, 3.3], 0.3, 14));
    walls
}

/// The walls as triangles, two each, from z = -1 to 1.
fn input(walls: &[Wall]) -> Input {
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    for [a, b] in walls {
        let first = positions.len() as u32;
        positions.extend([(a, -1.0), (b, -1.0), (b, 1.0), (a, 1.0)].map(|([x, y], z)| Vec3::new(*x, *y, z)));
        indices.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    let mesh = GeometryKind::Triangles { positions: positions.into(), indices: indices.into() };
    Input {
        groups: vec![Group { geometries: vec![0], instances: Vec::new() }],
        geometries: vec![Geometry { kind: mesh, mask: u32::MAX }],
        motions: Vec::new(),
    }
}

/// The height at which structures are cut through: not the middle, where an octree has a cut of its own.
const HEIGHT: f64 = 0.13;

fn built(walls: &[Wall], structure: Structure) -> Option<Scene> {
    Scene::build(input(walls), &(), &Options { structure, ..Options::default() }).ok()
}

fn sections(walls: &[Wall], structure: Structure) -> Vec<Section> {
    built(walls, structure).map(|s| s.section(HEIGHT)).unwrap_or_default()
}

/// The plan's part of the sheet.
fn plan(left: f32, top: f32, width: f32) -> Panel {
    Panel { area: [left, top, left + width, top + width * 8.0 / 12.0], world: [0.0, 0.0, 12.0, 8.0] }
}

fn outline(panel: &Panel, s: &Section) -> Vec<At> {
    s.outline.iter().map(|p| panel.at(p.map(|x| x as f32))).collect()
}

fn draw_walls(d: &mut Drawing, panel: &Panel, walls: &[Wall]) {
    for wall in walls {
        d.path(&wall.map(|p| panel.at(p)), INK, 2.2);
    }
}

/// Where a ray on the plan hits first, in parts of its direction.
fn hit(walls: &[Wall], from: [f32; 2], to: [f32; 2]) -> f32 {
    let z = HEIGHT as f32;
    let ray = Ray::new(Vec3::new(from[0], from[1], z), Vec3::new(to[0] - from[0], to[1] - from[1], 0.0));
    built(walls, Structure::Brute).map_or(1.0, |s| s.closest_counted(&(), &ray).0.t)
}

/// Where a ray enters and leaves a convex outline, if it does.
fn crossing(s: &Section, from: [f32; 2], to: [f32; 2]) -> Option<[f64; 2]> {
    let (o, d) = (from.map(f64::from), [0, 1].map(|i| f64::from(to[i] - from[i])));
    let (mut enter, mut exit) = (0.0, f64::INFINITY);
    for (i, a) in s.outline.iter().enumerate() {
        let b = s.outline[(i + 1) % s.outline.len()];
        let normal = [b[1] - a[1], a[0] - b[0]];
        let along = normal[0] * d[0] + normal[1] * d[1];
        let distance = normal[0] * (a[0] - o[0]) + normal[1] * (a[1] - o[1]);
        if along == 0.0 {
            if distance < 0.0 {
                return None;
            }
            continue;
        }
        let t = distance / along;
        if along < 0.0 {
            enter = if t > enter { t } else { enter };
        } else {
            exit = if t < exit { t } else { exit };
        }
    }
    (enter < exit).then_some([enter, exit])
}

/// A ray to where it hits.
fn draw_ray(d: &mut Drawing, panel: &Panel, from: [f32; 2], to: [f32; 2], t: f32) {
    let end = [0, 1].map(|i| from[i] + t * (to[i] - from[i]));
    d.arrow(panel.at(from), panel.at(end), RAY);
    d.dot(panel.at(from), RAY);
}

/// Boxes inside boxes, and those that a ray opens.
fn tree_of_boxes() -> String {
    let mut d = Drawing::new(660, 420);
    let (walls, panel) = (town(), plan(20.0, 16.0, 560.0));
    let (from, to) = ([0.5, 2.9], [8.7, 4.05]);
    let structure = Structure::Bvh2(Bvh2Params { leaf_size: 2, ..Bvh2Params::DEFAULT });
    let t = hit(&walls, from, to);
    let all = sections(&walls, structure);
    let near = |s: &Section| crossing(s, from, to).is_some_and(|[enter, _]| enter <= f64::from(t));
    for s in all.iter().filter(|s| near(s) && s.primitives.is_some()) {
        d.area(&outline(&panel, s), GLOW, "none");
    }
    let colours = [INK, HOT, GREEN, "#8a5a00", FAINT];
    for s in all.iter().filter(|s| s.depth <= 4) {
        let grow = 5.0 - 1.2 * s.depth as f32;
        let points = outline(&panel, s);
        let (x0, y0) = (points[0][0] - grow, points[2][1] - grow);
        let (x1, y1) = (points[1][0] + grow, points[0][1] + grow);
        d.boxed([x0, y0], [x1, y1], "none", colours[s.depth as usize]);
    }
    draw_walls(&mut d, &panel, &walls);
    draw_ray(&mut d, &panel, from, to, t);
    for (i, colour) in colours.into_iter().enumerate() {
        let y = 60.0 + 24.0 * i as f32;
        d.path(&[[590.0, y], [610.0, y]], colour, 2.5);
        d.text([616.0, y + 5.0], &format!("{i}"));
    }
    d.text([590.0, 40.0], "level");
    d.text([20.0, 412.0], "the ray opens the boxes that it crosses, and passes by all others");
    d.finish()
}

/// A ball, a box and an oriented box around the same rod.
fn volumes() -> String {
    let mut d = Drawing::new(700, 260);
    let (along, half, thick) = (28.0_f32, 88.0, 11.0);
    let (sin, cos) = ops::sin_cos(along.to_radians());
    for (i, name) in ["sphere", "box", "oriented"].into_iter().enumerate() {
        let at = [120.0 + 230.0 * i as f32, 118.0];
        let place = |a: f32, b: f32| [at[0] + a * cos - b * sin, at[1] - a * sin - b * cos];
        let rod = |grow: f32| {
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(a, b)| place(a * (half + grow), b * (thick + grow)))
        };
        let (w, h) = (half * cos + thick * sin, half * sin + thick * cos);
        match i {
            0 => d.circle(at, (half * half + thick * thick).sqrt(), "#f4f7fb", RAY),
            1 => d.boxed([at[0] - w, at[1] - h], [at[0] + w, at[1] + h], "#f4f7fb", RAY),
            _ => d.area(&rod(3.0), "#f4f7fb", RAY),
        }
        d.area(&rod(0.0), STUFF, INK);
        let (from, to) = ([at[0] - 105.0, at[1] - 52.0], [at[0] + 70.0, at[1] - 52.0]);
        // The ray misses the rod; the ball's volume is met, the tightest isn't.
        d.arrow([from[0], from[1] + 8.0], [to[0] - 30.0, to[1] + 8.0], if i == 2 { GREEN } else { HOT });
        d.label([at[0], 236.0], name);
    }
    d.finish()
}

/// A ray's walk from cell to cell, and the grid's bad case.
fn grid() -> String {
    let mut d = Drawing::new(720, 290);
    for (left, walls, from, to, name) in [
        (16.0, town(), [0.3, 2.6], [8.7, 4.05], "cells that the ray walks through, in order"),
        (374.0, stadium(), [0.9, 1.2], [7.2, 3.3], "the teapot in a stadium: all of it in a cell or two"),
    ] {
        let panel = plan(left, 16.0, 330.0);
        let all = sections(&walls, Structure::Grid(GridParams { factor: 1.0, ..GridParams::DEFAULT }));
        let t = hit(&walls, from, to);
        let mut walked: Vec<(f64, &Section)> = all
            .iter()
            .filter_map(|s| Some((crossing(s, from, to)?[0], s)))
            .filter(|(enter, _)| *enter < f64::from(t))
            .collect();
        walked.sort_by(|a, b| a.0.total_cmp(&b.0));
        for s in &all {
            d.area(&outline(&panel, s), if s.primitives > Some(0) { "#f1f3f5" } else { "none" }, FAINT);
        }
        for (_, s) in &walked {
            d.area(&outline(&panel, s), GLOW, FAINT);
        }
        draw_walls(&mut d, &panel, &walls);
        draw_ray(&mut d, &panel, from, to, t);
        for (n, (_, s)) in walked.iter().enumerate() {
            let corner = outline(&panel, s)[3];
            d.text([corner[0] + 3.0, corner[1] + 14.0], &format!("{}", n + 1));
        }
        d.label([left + 165.0, 266.0], name);
    }
    d.finish()
}

/// The same walls in the leaves of four binary trees.
fn splits() -> String {
    let mut d = Drawing::new(720, 560);
    let walls = town();
    let all = [
        ("median", Split::Median),
        ("middle", Split::Middle),
        ("sah", Split::Sah),
        ("agglomerative", Split::Agglomerative),
    ];
    for (i, (name, split)) in all.into_iter().enumerate() {
        let (left, top) = (16.0 + 358.0 * (i % 2) as f32, 30.0 + 270.0 * (i / 2) as f32);
        let panel = plan(left, top, 330.0);
        let structure = Structure::Bvh2(Bvh2Params { split, leaf_size: 4, ..Bvh2Params::DEFAULT });
        for s in sections(&walls, structure).iter().filter(|s| s.primitives.is_some()) {
            d.area(&outline(&panel, s), "#e9f2fa", RAY);
        }
        draw_walls(&mut d, &panel, &walls);
        d.text([left, top - 8.0], name);
    }
    d.finish()
}

/// Space cut up by three trees.
fn cells() -> String {
    let mut d = Drawing::new(720, 560);
    let walls = town();
    let all = [
        ("kd", Structure::Kd(KdParams { leaf_size: 2, ..KdParams::DEFAULT })),
        (
            "octree, with leaf_size: 4",
            Structure::Octree(OctreeParams { leaf_size: 4, max_depth: 6, ..OctreeParams::DEFAULT }),
        ),
        ("bsp", Structure::Bsp(BspParams { leaf_size: 2, ..BspParams::DEFAULT })),
        (
            "bsp, with choice: sah",
            Structure::Bsp(BspParams { leaf_size: 2, choice: BspChoice::Sah, ..BspParams::DEFAULT }),
        ),
    ];
    for (i, (name, structure)) in all.into_iter().enumerate() {
        let (left, top) = (16.0 + 358.0 * (i % 2) as f32, 30.0 + 270.0 * (i / 2) as f32);
        let panel = plan(left, top, 330.0);
        let held = |s: &Section| {
            s.outline.iter().all(|p| (-0.01..=12.01).contains(&p[0]) && (-0.01..=8.01).contains(&p[1]))
        };
        for s in sections(&walls, structure).iter() {
            let points: Vec<At> = outline(&panel, s)
                .into_iter()
                .map(|[x, y]| {
                    [ops::clamp(x, panel.area[0], panel.area[2]), ops::clamp(y, panel.area[1], panel.area[3])]
                })
                .collect();
            let empty = s.primitives == Some(0);
            d.area(&points, if empty || !held(s) { "none" } else { "#e9f2fa" }, "#7fa8cc");
        }
        draw_walls(&mut d, &panel, &walls);
        d.text([left, top - 8.0], name);
    }
    d.finish()
}
