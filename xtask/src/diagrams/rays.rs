//! Rays, cameras, samples, shapes.

use super::Diagram;
use crate::draw::*;
use straal_math::lowdisc::PatternKind;
use straal_math::{Affine, DVec3, Ray, Transform, Vec3, ops, warp};
use straal_study::points::Request;

/// What is drawn here.
pub const ALL: &[Diagram] = &[
    ("ray", ray),
    ("patterns", patterns),
    ("warps", warps),
    ("view-plane", view_plane),
    ("thin-lens", thin_lens),
    ("fisheye-laws", fisheye_laws),
    ("two-eyes", two_eyes),
    ("ray-shapes", ray_shapes),
    ("inverse-ray", inverse_ray),
    ("normals", normals),
];

/// A ray through a pixel meets a ball twice.
fn ray() -> String {
    let mut d = Drawing::new(690, 260);
    let eye = [60.0, 190.0];
    let (centre, radius) = ([480.0, 110.0], 72.0);
    // The film, seen a little from the side.
    let corner = |i: f32, j: f32| [190.0 + 14.0 * i, 62.0 + 32.0 * j + 7.0 * i];
    for k in 0..=4_u8 {
        let k = f32::from(k);
        d.path(&[corner(k, 0.0), corner(k, 4.0)], FAINT, 1.0);
        d.path(&[corner(0.0, k), corner(4.0, k)], FAINT, 1.0);
    }
    let quad =
        |i: f32, j: f32| [corner(i, j), corner(i + 1.0, j), corner(i + 1.0, j + 1.0), corner(i, j + 1.0)];
    d.area(&quad(2.0, 2.0), GLOW, INK);
    let through = [225.0, 159.5];
    d.circle(centre, radius, STUFF, INK);
    let along = [through[0] - eye[0], through[1] - eye[1]];
    let at = |t: f32| [eye[0] + t * along[0], eye[1] + t * along[1]];
    // The quadratic of the page, in the plane of the drawing.
    let a = along[0] * along[0] + along[1] * along[1];
    let b = along[0] * (centre[0] - eye[0]) + along[1] * (centre[1] - eye[1]);
    let c = (centre[0] - eye[0]) * (centre[0] - eye[0]) + (centre[1] - eye[1]) * (centre[1] - eye[1])
        - radius * radius;
    let root = (b * b - a * c).sqrt();
    let (first, second) = ((b - root) / a, (b + root) / a);
    d.path(&[eye, at(first)], RAY, 1.8);
    d.dashes(&[at(first), at(second)], RAY);
    d.arrow(at(second), at(second + 0.45), FAINT);
    d.arrow(eye, at(0.42), RAY);
    d.dot(eye, INK);
    d.label([eye[0], eye[1] + 22.0], "o, the eye");
    d.words([eye[0] + 52.0, eye[1] - 26.0], "d", "middle", RAY);
    d.dot(at(first), HOT);
    d.words([at(first)[0] - 6.0, at(first)[1] - 32.0], "the nearest hit:", "end", HOT);
    d.words([at(first)[0] - 6.0, at(first)[1] - 14.0], "t = (b − √…) / a", "end", HOT);
    d.dot(at(second), FAINT);
    d.words([at(second)[0] + 8.0, at(second)[1] + 20.0], "t = (b + √…) / a", "start", INK);
    d.dot(centre, INK);
    d.text([centre[0] + 8.0, centre[1] + 5.0], "c");
    d.path(&[centre, on_circle(centre, radius, 62.0)], FAINT, 1.2);
    d.text([centre[0] + 26.0, centre[1] - 26.0], "r");
    d.label([222.0, 240.0], "a pixel of the film");
    d.finish()
}

/// The same number of points by six patterns.
fn patterns() -> String {
    let mut d = Drawing::new(690, 480);
    let kinds = ["random", "regular", "jittered", "n_rooks", "multi_jittered", "sobol"];
    for (i, name) in kinds.into_iter().enumerate() {
        let (column, row) = ((i % 3) as f32, (i / 3) as f32);
        let (left, top) = (20.0 + 225.0 * column, 30.0 + 230.0 * row);
        let panel = Panel { area: [left, top, left + 200.0, top + 200.0], world: [0.0, 0.0, 1.0, 1.0] };
        for k in 1..8_u8 {
            let k = f32::from(k) / 8.0;
            d.path(&[panel.at([k, 0.0]), panel.at([k, 1.0])], STUFF, 1.0);
            d.path(&[panel.at([0.0, k]), panel.at([1.0, k])], STUFF, 1.0);
        }
        d.boxed([left, top], [left + 200.0, top + 200.0], "none", FAINT);
        d.text([left, top - 9.0], name);
        let Some(kind) = PatternKind::ALL.into_iter().find(|k| k.name() == name) else { continue };
        let request = Request { kind, count: 64, seed: 0, dimensions: [0, 1] };
        for point in request.points([0, 0]) {
            d.circle(panel.at(point), 2.6, RAY, "none");
        }
    }
    d.finish()
}

/// A net over the square, by straal's maps. Colours tell which cell went where.
fn warps() -> String {
    let mut d = Drawing::new(700, 470);
    let polar = |u: [f32; 2]| {
        let (sin, cos) = ops::sin_cos(std::f32::consts::TAU * u[1]);
        [u[0].sqrt() * cos, u[0].sqrt() * sin]
    };
    // A hemisphere seen obliquely from above.
    let lifted = |[x, y, z]: [f32; 3]| [x, 0.42 * y + 0.88 * z - 0.35];
    let hemisphere = move |u: [f32; 2]| {
        let w = warp::cosine_hemisphere(u);
        lifted([w.x, w.y, w.z])
    };
    let power = move |u: [f32; 2]| {
        let w = warp::cosine_power_hemisphere(u, 20.0);
        lifted([w.x, w.y, w.z])
    };
    let sphere = |u: [f32; 2]| {
        let w = warp::uniform_sphere(u);
        [w.x, w.z]
    };
    let square = |u: [f32; 2]| [2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0];
    type Map<'a> = &'a dyn Fn([f32; 2]) -> [f32; 2];
    let maps: [(&str, Map<'_>); 6] = [
        ("the square", &square),
        ("polar coordinates: torn, and squeezed", &polar),
        ("concentric disc", &warp_disc),
        ("hemisphere, by the cosine", &hemisphere),
        ("hemisphere, by cosine to the 20th", &power),
        ("sphere, from the front", &sphere),
    ];
    for (i, (name, map)) in maps.into_iter().enumerate() {
        let (left, top) = (35.0 + 225.0 * (i % 3) as f32, 36.0 + 225.0 * (i / 3) as f32);
        let panel = Panel { area: [left, top, left + 180.0, top + 180.0], world: [-1.05, -1.05, 1.05, 1.05] };
        d.label([left + 90.0, top - 12.0], name);
        // Only what faces the viewer.
        let above = |w: Vec3| 0.42 * w.z - 0.9 * w.y >= 0.0;
        let seen = |u: [f32; 2]| match i {
            3 => above(warp::cosine_hemisphere(u)),
            4 => above(warp::cosine_power_hemisphere(u, 20.0)),
            5 => warp::uniform_sphere(u).y <= 0.0,
            _ => true,
        };
        let cells = 8_u8;
        let place = |k: u8, steps: u8| f32::from(k) / f32::from(steps) * 0.9999;
        for column in 0..cells {
            for row in 0..cells {
                if (column + row) % 2 == 0 {
                    continue;
                }
                let corner = |a: u8, b: u8| [place(8 * column + a, 8 * cells), place(8 * row + b, 8 * cells)];
                let edge: Vec<[f32; 2]> = (0..8)
                    .map(|k| corner(k, 0))
                    .chain((0..8).map(|k| corner(8, k)))
                    .chain((0..8).map(|k| corner(8 - k, 8)))
                    .chain((0..8).map(|k| corner(0, 8 - k)))
                    .collect();
                if !edge.iter().all(|&u| seen(u)) {
                    continue;
                }
                let colour = match (column < cells / 2, row < cells / 2) {
                    (true, true) => "#8db9e2",
                    (false, true) => "#f0b4a8",
                    (true, false) => "#a8d5b5",
                    (false, false) => "#f2d68a",
                };
                let outline: Vec<At> = edge.iter().map(|&u| panel.at(map(u))).collect();
                d.area(&outline, colour, "none");
            }
        }
        for k in 0..=cells {
            for turned in [false, true] {
                let mut line = Vec::new();
                for s in 0..=64_u8 {
                    let (a, b) = (place(k, cells), place(s, 64));
                    let u = if turned { [b, a] } else { [a, b] };
                    if seen(u) {
                        line.push(panel.at(map(u)));
                    } else if line.len() > 1 {
                        d.path(&std::mem::take(&mut line), INK, 0.6);
                    } else {
                        line.clear();
                    }
                }
                if line.len() > 1 {
                    d.path(&line, INK, 0.6);
                }
            }
        }
    }
    d.finish()
}

fn warp_disc(u: [f32; 2]) -> [f32; 2] {
    warp::concentric_disc(u)
}

/// The frame of a camera and its view plane from the side, and what a wider angle takes in.
fn view_plane() -> String {
    let mut d = Drawing::new(660, 270);
    let eye = [170.0, 130.0];
    let plane = 350.0;
    let far = 600.0;
    let half = 0.26;
    let at = |x: f32, slope: f32| [x, eye[1] - slope * (x - eye[0])];
    d.area(&[eye, at(far, half), at(far, -half)], "#f4f7fb", "none");
    d.path(&[eye, at(far, half)], FAINT, 1.2);
    d.path(&[eye, at(far, -half)], FAINT, 1.2);
    d.dashes(&[eye, at(far + 30.0, 0.0)], FAINT);
    d.path(&[at(plane, half), at(plane, -half)], INK, 2.0);
    for k in 0..=8_u8 {
        let y = at(plane, half)[1] + f32::from(k) / 8.0 * (at(plane, -half)[1] - at(plane, half)[1]);
        d.path(&[[plane - 5.0, y], [plane + 5.0, y]], INK, 1.0);
    }
    d.label([plane + 60.0, 252.0], "view plane, one mark a pixel");
    d.arrow(eye, at(far, 0.16), RAY);
    d.words([470.0, 108.0], "the ray of this pixel", "start", RAY);
    d.dot(at(plane, 0.16), RAY);
    d.arrow(eye, [eye[0], eye[1] - 68.0], GREEN);
    d.words([eye[0] + 8.0, eye[1] - 60.0], "v", "start", GREEN);
    d.arrow(eye, [eye[0] - 68.0, eye[1]], GREEN);
    d.words([eye[0] - 62.0, eye[1] - 9.0], "w", "start", GREEN);
    d.words([eye[0] + 6.0, eye[1] + 22.0], "u comes out of the page", "end", GREEN);
    d.dot(eye, INK);
    d.arc(eye, 112.0, [-14.6, 14.6], INK);
    d.text([eye[0] + 92.0, eye[1] + 18.0], "α");
    d.arrow([260.0, 205.0], [plane, 205.0], INK);
    d.arrow([260.0, 205.0], [eye[0], 205.0], INK);
    d.label([260.0, 222.0], "d");
    d.text([far - 30.0, eye[1] - 8.0], "look_at");
    d.dot([far - 40.0, eye[1]], INK);
    d.finish()
}

/// A thin lens: what is in the plane in focus comes to one point of the film, what is elsewhere to a disc.
fn thin_lens() -> String {
    let mut d = Drawing::new(680, 280);
    let (lens, focus, film, axis) = (260.0, 520.0, 110.0, 130.0);
    let radius = 70.0;
    let image = [film, axis];
    d.dashes(&[[60.0, axis], [650.0, axis]], FAINT);
    let sharp = [focus, axis];
    let near = [410.0, axis];
    for side in [-1.0, -0.5, 0.0, 0.5, 1.0_f32] {
        let through = [lens, axis - side * radius];
        d.path(&[image, through, sharp], RAY, 1.2);
    }
    // A nearer point: rays that come from it through the lens meet behind the film, by the lens' equation.
    let (u, f) = (near[0] - lens, 1.0 / (1.0 / (focus - lens) + 1.0 / (lens - film)));
    let v = 1.0 / (1.0 / f - 1.0 / u);
    let mut spread = [0.0; 2];
    for (k, side) in [-1.0, 1.0_f32].into_iter().enumerate() {
        let through = [lens, axis - side * radius];
        let behind = [lens - v, axis];
        let t = (lens - film) / v;
        let on_film = [film, through[1] + t * (behind[1] - through[1])];
        spread[k] = on_film[1];
        d.path(&[near, through, on_film], HOT, 1.2);
    }
    // The lens as two arcs.
    let side = |sign: f32| {
        (0..=20_u8).map(move |i| {
            let y = (f32::from(i) / 10.0 - 1.0) * radius;
            [lens + sign * 9.0 * (1.0 - y * y / (radius * radius)), axis + y]
        })
    };
    let outline: Vec<At> = side(1.0).chain(side(-1.0).collect::<Vec<_>>().into_iter().rev()).collect();
    d.area(&outline, "#dcecf9", INK);
    d.path(&[[film, axis - 85.0], [film, axis + 85.0]], INK, 2.0);
    d.path(&[[film, spread[0]], [film, spread[1]]], HOT, 5.0);
    d.dashes(&[[focus, axis - 95.0], [focus, axis + 95.0]], INK);
    d.dot(sharp, RAY);
    d.dot(near, HOT);
    d.label([film, 250.0], "film");
    d.label([lens, 250.0], "lens of radius r");
    d.label([focus, 250.0], "plane in focus");
    d.words([near[0] + 14.0, axis + 44.0], "too near", "middle", HOT);
    d.words([film - 10.0, axis + 5.0], "blurred", "end", HOT);
    d.arrow([390.0, 22.0], [focus, 22.0], INK);
    d.arrow([390.0, 22.0], [lens, 22.0], INK);
    d.label([390.0, 16.0], "f");
    d.arrow([335.0, 215.0], [near[0], 215.0], INK);
    d.arrow([335.0, 215.0], [lens, 215.0], INK);
    d.label([335.0, 209.0], "z");
    d.finish()
}

/// The distance, in some unit, by the angle in radians.
type Law = fn(f32) -> f32;

/// Distance from the middle of a fisheye's picture by the angle to the view.
fn fisheye_laws() -> String {
    let mut d = Drawing::new(640, 330);
    let panel = Panel { area: [60.0, 34.0, 440.0, 270.0], world: [0.0, 0.0, 90.0, 1.0] };
    panel.axes(
        &mut d,
        &[0.0, 30.0, 60.0, 90.0],
        &[0.0, 0.5, 1.0],
        ["angle to the view θ, in degrees", "r, from the middle to the edge; fov 180"],
    );
    let radians = |degrees: f32| degrees.to_radians();
    let laws: [(&str, &str, Law); 4] = [
        ("orthographic", FAINT, |t| ops::sin(t)),
        ("equisolid", GREEN, |t| ops::sin(0.5 * t)),
        ("equidistant", RAY, |t| t),
        ("stereographic", HOT, |t| ops::tan(0.5 * t)),
    ];
    for (i, (name, colour, law)) in laws.into_iter().enumerate() {
        let edge = law(radians(90.0));
        d.path(&panel.curve(|x| law(radians(x)) / edge), colour, 2.0);
        let y = 60.0 + 24.0 * i as f32;
        d.path(&[[465.0, y], [495.0, y]], colour, 2.5);
        d.text([503.0, y + 5.0], name);
    }
    d.finish()
}

/// Two eyes from above.
fn two_eyes() -> String {
    let mut d = Drawing::new(660, 300);
    let (left, right, screen) = ([110.0, 110.0], [110.0, 190.0], 360.0);
    let window = [85.0, 215.0];
    for (eye, colour) in [(left, HOT), (right, RAY)] {
        d.area(&[eye, [screen, window[0]], [screen, window[1]]], "none", STUFF);
        d.dot(eye, colour);
    }
    d.path(&[[screen, window[0]], [screen, window[1]]], INK, 3.0);
    d.label([screen, 64.0], "screen, at the convergence c");
    let (near, far) = ([240.0, 160.0], [560.0, 130.0]);
    for point in [near, far] {
        for (eye, colour) in [(left, HOT), (right, RAY)] {
            let t = (screen - eye[0]) / (point[0] - eye[0]);
            let on = [screen, eye[1] + t * (point[1] - eye[1])];
            d.path(&[eye, if t > 1.0 { on } else { point }], colour, 1.3);
            d.circle(on, 3.6, "white", colour);
        }
        d.circle(point, 6.0, GLOW, INK);
    }
    d.words([left[0] - 12.0, left[1] + 5.0], "left eye", "end", HOT);
    d.words([right[0] - 12.0, right[1] + 5.0], "right eye", "end", RAY);
    d.path(&[[60.0, left[1] + 14.0], [60.0, right[1] - 14.0]], INK, 1.0);
    d.words([52.0, 155.0], "s", "end", INK);
    d.label([near[0], near[1] - 14.0], "in front");
    d.label([far[0] + 10.0, far[1] - 14.0], "behind");
    d.label([330.0, 270.0], "where the lines cross the screen is where each eye's picture shows the point");
    d.finish()
}

/// A box as three slabs, and a triangle by its edge functions.
fn ray_shapes() -> String {
    let mut d = Drawing::new(700, 300);
    // Slabs, in two dimensions.
    let ([x0, y0], [x1, y1]) = ([110.0, 90.0], [250.0, 200.0]);
    d.boxed([x0, 40.0], [x1, 250.0], "#eef4fb", "none");
    d.boxed([30.0, y0], [330.0, y1], "#fdf3dc", "none");
    d.boxed([x0, y0], [x1, y1], STUFF, INK);
    let (from, to) = ([40.0, 235.0], [325.0, 65.0]);
    let at = |t: f32| [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])];
    let by_x = [x0, x1].map(|x| (x - from[0]) / (to[0] - from[0]));
    let by_y = [y1, y0].map(|y| (y - from[1]) / (to[1] - from[1]));
    d.arrow(from, to, RAY);
    let (enter, exit) = (ops::max(by_x[0], by_y[0]), ops::min(by_x[1], by_y[1]));
    d.path(&[at(enter), at(exit)], HOT, 3.5);
    for t in by_x.into_iter().chain(by_y) {
        d.circle(at(t), 3.4, "white", RAY);
    }
    d.label([180.0, 32.0], "between two planes in x");
    d.words([262.0, y1 + 18.0], "and in y", "start", INK);
    d.words([180.0, 278.0], "inside where it is inside both", "middle", HOT);
    // The triangle seen along the ray.
    let corners = [[430.0, 230.0], [640.0, 190.0], [520.0, 50.0]];
    let hit = [530.0, 150.0];
    let colours = ["#8db9e2", "#a8d5b5", "#f2d68a"];
    for i in 0..3 {
        d.area(&[corners[i], corners[(i + 1) % 3], hit], colours[i], "none");
    }
    d.area(&corners, "none", INK);
    for (i, name) in ["v0", "v1", "v2"].into_iter().enumerate() {
        let c = corners[i];
        let out = [c[0] + 0.13 * (c[0] - hit[0]), c[1] + 0.13 * (c[1] - hit[1]) + 5.0];
        d.label(out, name);
    }
    d.label([532.0, 196.0], "e2");
    d.label([572.0, 138.0], "e0");
    d.label([494.0, 138.0], "e1");
    d.dot(hit, HOT);
    d.label([535.0, 278.0], "along the ray: three areas of one sign are a hit");
    d.finish()
}

/// A ray and a stretched ball, and the same ray and the round one.
fn inverse_ray() -> String {
    let mut d = Drawing::new(700, 290);
    let stretch = Affine::scale(DVec3::new(1.5, 0.8, 1.0));
    let turned = Affine::rotate(DVec3::new(0.0, 0.0, 1.0), 20.0).map_or(stretch, |turn| stretch.then(&turn));
    let Some(transform) = Transform::new(&turned) else { return String::new() };
    let world = Panel { area: [20.0, 40.0, 340.0, 250.0], world: [-2.4, -1.575, 2.4, 1.575] };
    let object = Panel { area: [390.0, 40.0, 680.0, 250.0], world: [-2.175, -1.575, 2.175, 1.575] };
    let ring = |map: &dyn Fn(Vec3) -> Vec3, panel: &Panel| -> Vec<At> {
        (0..=72_u8)
            .map(|i| {
                let (sin, cos) = ops::sin_cos(f32::from(i).to_radians() * 5.0);
                let p = map(Vec3::new(cos, sin, 0.0));
                panel.at([p.x, p.y])
            })
            .collect()
    };
    d.area(&ring(&|p| transform.point(p), &world), STUFF, INK);
    d.area(&ring(&|p| p, &object), STUFF, INK);
    let ray = Ray::new(Vec3::new(-2.2, -0.3, 0.0), Vec3::new(2.0, 0.35, 0.0));
    let inner = transform.inverse_ray(&ray);
    // The hit with the round ball; t is the same for both rays.
    let (a, b, c) = (inner.d.length_squared(), -inner.d.dot(inner.o), inner.o.length_squared() - 1.0);
    let t = (b - (b * b - a * c).sqrt()) / a;
    for (panel, ray, normal) in [
        (&world, &ray, transform.normal(inner.at(t)).normalize()),
        (&object, &inner, inner.at(t).normalize()),
    ] {
        let at = |t: f32| panel.at([ray.at(t).x, ray.at(t).y]);
        d.path(&[at(0.0), at(t)], RAY, 1.6);
        d.arrow(at(t), at(2.0), FAINT);
        d.arrow(at(0.0), at(0.5), RAY);
        let tip = ray.at(t) + normal * 0.6;
        d.arrow(at(t), panel.at([tip.x, tip.y]), GREEN);
        d.dot(at(t), HOT);
        d.dot(at(0.0), INK);
        d.words([at(t)[0] + 6.0, at(t)[1] + 18.0], &format!("t = {t:.2}"), "start", HOT);
    }
    d.label([180.0, 26.0], "in the world: stretched and turned");
    d.label([535.0, 26.0], "in the ball's own space");
    d.arrow([336.0, 215.0], [390.0, 215.0], INK);
    d.label([363.0, 206.0], "inverse");
    d.label([350.0, 278.0], "the direction keeps its length, so that t is the same number on both sides");
    d.finish()
}

/// A curve made of straight pieces: each with its own normal, and with normals between those of its corners.
fn normals() -> String {
    let mut d = Drawing::new(690, 230);
    for (left, name, smooth) in [
        (20.0, "flat: a normal for each facet", false),
        (360.0, "smooth: normals blend from corner to corner", true),
    ] {
        let middle = [left + 155.0, 330.0];
        let angle = |i: f32| 130.0 - 20.0 * i;
        let corner = |i: f32| on_circle(middle, 210.0, angle(i));
        let points: Vec<At> = (0..=4_u8).map(|i| corner(f32::from(i))).collect();
        let mut ground = points.clone();
        ground.extend([[points[4][0], 205.0], [points[0][0], 205.0]]);
        d.area(&ground, STUFF, "none");
        if smooth {
            let round: Vec<At> =
                (0..=40_u8).map(|i| on_circle(middle, 210.0, angle(f32::from(i) / 10.0))).collect();
            d.dashes(&round, FAINT);
        }
        d.path(&points, INK, 2.0);
        for i in 0..4_u8 {
            for s in [0.1, 0.366, 0.633, 0.9_f32] {
                let i = f32::from(i);
                let (a, b) = (corner(i), corner(i + 1.0));
                let at = [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])];
                let to = on_circle(at, 38.0, if smooth { angle(i + s) } else { angle(i + 0.5) });
                d.arrow(at, to, if smooth { RAY } else { GREEN });
            }
        }
        d.label([left + 155.0, 222.0], name);
    }
    d.finish()
}
