//! Properties of perspective, as the course states them.

use super::*;
use crate::shape::Sphere;
use straal_math::ops;

#[test]
fn perspective_frames_its_field_of_view() {
    let c = pinhole(&view());
    assert!((ray(&c, [100.0, 50.0]).d + Vec3::Z).length() < 1e-6);
    let right = ray(&c, [200.0, 50.0]).d;
    assert!((right.x / -right.z - 0.5).abs() < 1e-6);
    let top = ray(&c, [100.0, 0.0]).d;
    assert!((top.y / -top.z - 0.25).abs() < 1e-6);
}

/// Direction x u + y v - d w with x = s (column - columns / 2 + 1/2) and y = s (rows / 2 - row - 1/2), for a pixel's middle.
#[test]
fn rays_are_the_textbooks() {
    let v = slanted();
    let (s, d) = (0.03, 2.5);
    let c = Camera::Perspective(Perspective::new(&v, &Window::new(0.5 * 200.0 * s / d, SIZE)));
    for (column, row) in [(0, 0), (199, 0), (13, 77), (100, 50)] {
        let x = s * (f64::from(column) - 100.0 + 0.5);
        let y = s * (50.0 - f64::from(row) - 0.5);
        let want = (v.right * x + v.up * y + v.forward * d).normalize().as_vec3();
        let found = ray(&c, [column as f32 + 0.5, row as f32 + 0.5]);
        assert!((found.d - want).length() < 1e-6 && found.o == v.eye.as_vec3());
    }
}

#[test]
fn orthographic_rays_are_parallel_and_as_wide_as_told() {
    let c = Camera::Orthographic(Orthographic::new(&view(), 4.0, SIZE));
    let (a, b) = (ray(&c, [0.0, 50.0]), ray(&c, [200.0, 50.0]));
    assert_eq!(a.d, b.d);
    assert!((b.o - a.o - Vec3::X * 4.0).length() < 1e-6);
}

#[test]
fn size_falls_as_one_over_the_distance() {
    let c = pinhole(&view());
    // A pole one unit high, z in front of the eye.
    let height = |z: f64| {
        let foot = seen(&c, DVec3::new(0.3, -0.4, 4.0 - z));
        let head = seen(&c, DVec3::new(0.3, 0.6, 4.0 - z));
        assert!((foot[0] - head[0]).abs() < PIXELS, "what is upright stays upright");
        foot[1] - head[1]
    };
    // 100 pixels are 0.5 high at distance 1.
    for z in [2.0, 3.0, 5.0, 10.0, 40.0] {
        assert!((height(z) * z - 200.0).abs() < PIXELS * z, "{z}");
    }
    let o = Camera::Orthographic(Orthographic::new(&view(), 4.0, SIZE));
    let size = |z: f64| seen(&o, DVec3::new(0.0, 0.0, z))[1] - seen(&o, DVec3::new(0.0, 0.5, z))[1];
    assert!((size(0.0) - size(-30.0)).abs() < PIXELS, "parallel rays keep sizes");
}

/// How far the middle points are from the line through the first and the last, in pixels.
fn bend(points: &[[f64; 2]]) -> f64 {
    let (a, b) = (points[0], points[points.len() - 1]);
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = (dx * dx + dy * dy).sqrt();
    let off = |p: &[f64; 2]| ((p[0] - a[0]) * dy - (p[1] - a[1]) * dx).abs() / length;
    points.iter().map(off).fold(0.0, |m, o| if o > m { o } else { m })
}

#[test]
fn straight_lines_stay_straight() {
    let v = slanted();
    for (from, to) in [
        (DVec3::new(-1.0, -0.5, 0.0), DVec3::new(1.0, 0.8, -2.0)),
        (DVec3::new(0.5, -0.5, 1.0), DVec3::new(-0.5, 0.5, -30.0)),
    ] {
        let line = |c: &Camera| -> Vec<[f64; 2]> {
            (0..=8).map(|i| seen(c, from + (to - from) * (f64::from(i) / 8.0))).collect()
        };
        assert!(bend(&line(&pinhole(&v))) < PIXELS);
        assert!(bend(&line(&Camera::Orthographic(Orthographic::new(&v, 4.0, SIZE)))) < PIXELS);
    }
    // A fisheye bends what doesn't pass through its middle, so that this test can fail.
    let f = Fisheye::new(&v, (Projection::Equidistant, 180.0), 100.0, SIZE);
    let f = Camera::Fisheye(f);
    let across: Vec<[f64; 2]> =
        (-4..=4).map(|i| seen(&f, v.eye + v.forward + v.up * 0.7 + v.right * (0.4 * f64::from(i)))).collect();
    assert!(bend(&across) > 1.0);
}

/// Direction of a line's picture as an angle.
fn slope(c: &Camera, p: DVec3, d: DVec3) -> f64 {
    let (a, b) = (seen(c, p), seen(c, p + d));
    ops::atan2_d(b[1] - a[1], b[0] - a[0])
}

#[test]
fn lines_parallel_to_the_view_plane_stay_parallel() {
    let v = slanted();
    let c = pinhole(&v);
    let d = v.right * 0.8 + v.up * 0.3;
    let at = |x: f64, y: f64, z: f64| v.eye + v.right * x + v.up * y + v.forward * z;
    let first = slope(&c, at(0.0, 0.0, 3.0), d);
    for p in [at(-0.5, 0.3, 3.0), at(0.4, -0.6, 4.0), at(0.0, 0.2, 9.0)] {
        assert!((slope(&c, p, d) - first).abs() < 2e-4);
    }
    // Those that go away from it don't.
    let away = d + v.forward;
    let off = (slope(&c, at(0.4, -0.6, 4.0), away) - slope(&c, at(-0.5, 0.3, 3.0), away)).abs();
    assert!(off > 0.05, "{off}");
}

#[test]
fn other_parallel_lines_meet_in_a_vanishing_point() {
    let v = slanted();
    let c = pinhole(&v);
    let d = (v.forward + v.right * 0.2 - v.up * 0.1).normalize();
    // The vanishing point is where the ray has the lines' direction.
    let meet = seen(&c, v.eye + d);
    assert!((ray(&c, meet.map(|x| x as f32)).d - d.as_vec3()).length() < 1e-5);
    for side in [DVec3::new(0.5, 0.0, 0.0), DVec3::new(0.0, -0.7, 0.2), DVec3::new(-0.3, 0.4, 0.0)] {
        let mut last = f64::INFINITY;
        for t in [3.0, 10.0, 100.0, 10_000.0] {
            let p = seen(&c, v.eye + side + d * t);
            let off = ((p[0] - meet[0]) * (p[0] - meet[0]) + (p[1] - meet[1]) * (p[1] - meet[1])).sqrt();
            // 200 pixels across are one unit at distance 1.
            assert!(off < 200.0 / t + PIXELS && off < last, "{off} at {t}");
            last = off;
        }
    }
}

#[test]
fn what_is_turned_from_the_view_is_foreshortened() {
    let o = Camera::Orthographic(Orthographic::new(&view(), 4.0, SIZE));
    let c = pinhole(&view());
    for degrees in [0.0, 30.0, 60.0, 85.0] {
        let (s, cos) = ops::sin_cos_degrees(degrees);
        let half = DVec3::new(0.5 * cos, 0.0, 0.5 * s);
        // One unit is 50 pixels.
        let long = seen(&o, half)[0] - seen(&o, -half)[0];
        assert!((long - 50.0 * cos).abs() < PIXELS, "{degrees}");
    }
    // Equal lengths one behind the other become shorter and shorter.
    let at = |i: i32| seen(&c, DVec3::new(0.5, -0.5, f64::from(-i)))[1];
    let steps: Vec<f64> = (0..6).map(|i| at(i) - at(i + 1)).collect();
    assert!(steps.windows(2).all(|w| w[1] > 0.0 && w[1] < w[0]), "{steps:?}");
}

#[test]
fn a_triangle_stays_a_triangle() {
    let v = slanted();
    let c = pinhole(&v);
    let corners = [DVec3::new(-0.8, -0.3, 0.9), DVec3::new(0.9, -0.2, -1.0), DVec3::new(0.0, 0.8, 0.2)];
    let [a, b, d] = corners.map(|p| seen(&c, p));
    let area =
        |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let whole = area(a, b, d);
    assert!(whole.abs() > 100.0);
    for i in 0..=10 {
        for j in 0..=10 - i {
            let (x, y) = (f64::from(i) / 10.0, f64::from(j) / 10.0);
            let p = seen(&c, corners[0] + (corners[1] - corners[0]) * x + (corners[2] - corners[0]) * y);
            // Inside, and on the edges where it was on the edges.
            let shares = [area(a, b, p), area(p, b, d), area(a, p, d)].map(|s| s / whole);
            assert!(shares.iter().all(|s| *s > -1e-4), "{shares:?}");
            let edges = [j == 0, i + j == 10, i == 0];
            for (share, on_edge) in shares.into_iter().zip(edges) {
                assert_eq!(share.abs() < 1e-3, on_edge, "{i} {j} {shares:?}");
            }
        }
    }
}

/// A ball of radius r at distance D, seen at an angle a from the view, covers sin b = r / D. On the view plane its picture is
/// the ellipse that cuts the cone of half-angle b about its middle: half axes sin b cos b / q towards the middle of the
/// picture and sin b / sqrt(q) across, with q = cos² a - sin² b.
#[test]
fn a_sphere_becomes_an_ellipse_of_the_right_axes() {
    let v = view();
    let c = pinhole(&v);
    for (degrees, radius, distance) in [(0.0, 0.5, 4.0), (15.0, 0.6, 4.0), (20.0, 0.3, 5.0)] {
        let (sin_a, cos_a) = ops::sin_cos_degrees(degrees);
        let center = v.eye + (v.forward * cos_a + v.right * sin_a) * distance;
        let ball = Sphere { center: center.as_vec3(), radius: radius as f32 };
        let hit = |x: f64, y: f64| ball.analytic().intersect(&ray(&c, [x as f32, y as f32])).is_some();
        let sin_b = radius / distance;
        let q = cos_a * cos_a - sin_b * sin_b;
        let (along, across) = (sin_b * (1.0 - sin_b * sin_b).sqrt() / q, sin_b / q.sqrt());
        // In pixels, of which there are 200 to a unit.
        let (x0, y0) = (100.0 + 200.0 * sin_a * cos_a / q, 50.0);
        let edge = |dx: f64, dy: f64| {
            let (mut inside, mut outside) = (0.0, 100.0);
            for _ in 0..40 {
                let mid = 0.5 * (inside + outside);
                if hit(x0 + mid * dx, y0 + mid * dy) { inside = mid } else { outside = mid }
            }
            inside
        };
        for (found, want) in [
            (edge(1.0, 0.0), along),
            (edge(-1.0, 0.0), along),
            (edge(0.0, 1.0), across),
            (edge(0.0, -1.0), across),
        ] {
            assert!((found - 200.0 * want).abs() < 5e-3, "{degrees}: {found} {}", 200.0 * want);
        }
        // Between the axes as well: x²/a² + y²/b² = 1.
        let diagonal = edge(0.6, 0.8) / 200.0;
        let one =
            0.36 * diagonal * diagonal / (along * along) + 0.64 * diagonal * diagonal / (across * across);
        assert!((one - 1.0).abs() < 1e-3, "{one}");
        assert!((along > across * 1.01) == (degrees > 0.0));
    }
}

#[test]
fn roll_turns_the_picture_the_other_way() {
    let c = pinhole(&view().rolled(90.0));
    // What is above stands to the left for a camera turned clockwise.
    let [x, y] = seen(&c, DVec3::new(0.0, 0.4, 0.0));
    assert!(near([x, y], [100.0 - 20.0, 50.0], PIXELS), "{x} {y}");
    assert_eq!(view().rolled(0.0), view());
}

#[test]
fn shift_moves_the_picture_and_nothing_else() {
    let v = slanted();
    let plain = pinhole(&v);
    let window = Window::new(0.5, SIZE).shifted([0.25, -0.5]);
    let moved = Camera::Perspective(Perspective::new(&v, &window));
    for p in [DVec3::ZERO, DVec3::new(0.4, 0.3, 1.0)] {
        // A picture moved to the right shows things further left; moved down, further up.
        let ([x, y], found) = (seen(&plain, p), seen(&moved, p));
        assert!(near(found, [x - 50.0, y - 50.0], PIXELS), "{found:?}");
    }
}
