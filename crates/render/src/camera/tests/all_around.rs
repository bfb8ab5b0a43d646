//! Cameras that see more than a plane could hold.

use super::*;
use crate::light::ImageEnvironment;
use straal_math::{Affine, ops};
use straal_scene::Image;

/// Angle to the view in degrees, exact near 0 and 180 too.
fn angle(ray: &Ray, view: &View) -> f64 {
    let d = ray.d.as_dvec3();
    ops::atan2_d(d.cross(view.forward).length(), d.dot(view.forward)).to_degrees()
}

fn fisheye(projection: Projection, degrees: f64) -> Camera {
    Camera::Fisheye(Fisheye::new(&slanted(), (projection, degrees), 100.0, SIZE))
}

#[test]
fn fisheyes_have_their_projections() {
    let v = slanted();
    let half = |a: f64| ops::sin_cos_degrees(0.5 * a);
    for (projection, full) in [
        (Projection::Equidistant, 220.0),
        (Projection::Equidistant, 360.0),
        (Projection::Equisolid, 360.0),
        (Projection::Orthographic, 180.0),
        (Projection::Stereographic, 250.0),
    ] {
        let c = fisheye(projection, full);
        let law = |a: f64| match projection {
            Projection::Equidistant => a,
            Projection::Equisolid => half(a).0,
            Projection::Orthographic => ops::sin_cos_degrees(a).0,
            Projection::Stereographic => half(a).0 / half(a).1,
        };
        for (r, turn) in [(0.0, 0.0), (0.1, 10.0), (0.5, 100.0), (0.8, 250.0), (0.999, 300.0)] {
            let (s, cos) = ops::sin_cos_degrees(turn);
            let found = ray(&c, [(100.0 + 50.0 * r * cos) as f32, (50.0 - 50.0 * r * s) as f32]);
            let a = angle(&found, &v);
            assert!((law(a) - r * law(0.5 * full)).abs() < 1e-4 * law(0.5 * full), "{projection:?} {r}: {a}");
            // To the side where it is in the picture.
            if r > 0.0 && a < 179.0 {
                let (x, y) = (found.d.as_dvec3().dot(v.right), found.d.as_dvec3().dot(v.up));
                assert!((ops::atan2_d(y * cos - x * s, x * cos + y * s)).abs() < 1e-4, "{projection:?} {r}");
            }
        }
        // Around the circle nothing is seen.
        assert_eq!(c.ray(&FilmPoint::at([151.0, 50.0])), None);
        assert_eq!(c.ray(&FilmPoint::at([1.0, 1.0])), None);
        assert!(c.ray(&FilmPoint::at([100.0, 0.5])).is_some());
    }
}

/// Solid angle of a small square of the film, by the vectors to its corners.
fn solid_angle(c: &Camera, [x, y]: [f32; 2], side: f32) -> f64 {
    let d = |i: f32, j: f32| {
        let at = FilmPoint {
            position: [x + i * side, y + j * side],
            ..FilmPoint::at([x + 0.5 * side, y + 0.5 * side])
        };
        c.ray(&at).expect("a ray").d.as_dvec3()
    };
    let (a, b, p, q) = (d(0.0, 0.0), d(1.0, 0.0), d(0.0, 1.0), d(1.0, 1.0));
    // Half the cross product of the diagonals is the flat quadrilateral's area.
    0.5 * (q - a).cross(p - b).length()
}

#[test]
fn an_equisolid_fisheye_gives_equal_areas_to_equal_solid_angles() {
    let c = fisheye(Projection::Equisolid, 300.0);
    let whole = std::f64::consts::PI * 50.0 * 50.0;
    // The share of the sphere within 150 degrees: 2 pi (1 - cos 150°).
    let want = std::f64::consts::TAU * (1.0 - ops::sin_cos_degrees(150.0).1) / whole;
    for at in [[100.0, 50.0], [120.0, 50.0], [80.0, 70.0], [100.0, 8.0]] {
        let found = solid_angle(&c, at, 1.0);
        assert!((found / want - 1.0).abs() < 5e-3, "{at:?}: {found} {want}");
    }
}

#[test]
fn panoramas_and_cubes_see_everything_once() {
    let sphere = 4.0 * std::f64::consts::PI;
    let p = Panorama::new(&slanted(), [-180.0, 180.0], ([-90.0, 90.0], Rows::Even), SIZE);
    let p = Camera::Panorama(p);
    let pixels = |c: &Camera| -> f64 {
        let all = (0..SIZE[0] * SIZE[1]).map(|i| [(i % SIZE[0]) as f32, (i / SIZE[0]) as f32]);
        all.filter(|at| c.ray(&FilmPoint::at([at[0] + 0.5, at[1] + 0.5])).is_some())
            .map(|at| solid_angle(c, at, 1.0))
            .sum()
    };
    // Flat pixels are smaller than round ones by the square of their angle.
    assert!((pixels(&p) / sphere - 1.0).abs() < 1e-3);
    for layout in [CubeLayout::Cross, CubeLayout::Row] {
        let c = Camera::CubeMap(CubeMap::new(&slanted(), layout, SIZE));
        assert!((pixels(&c) / sphere - 1.0).abs() < 1e-3, "{layout:?} {}", pixels(&c) / sphere);
    }
}

#[test]
fn panorama_has_its_angles() {
    let v = slanted();
    let c = Panorama::new(&v, [-30.0, 60.0], ([-20.0, 40.0], Rows::Even), SIZE);
    let c = Camera::Panorama(c);
    let want = |l: f64, b: f64| {
        let ((sl, cl), (sb, cb)) = (ops::sin_cos_degrees(l), ops::sin_cos_degrees(b));
        (v.right * (sl * cb) + v.forward * (cl * cb) + v.up * sb).as_vec3()
    };
    for (at, l, b) in [
        ([0.0, 0.0], -30.0, 40.0),
        ([200.0, 100.0], 60.0, -20.0),
        ([50.0, 75.0], -7.5, -5.0),
        ([100.0, 50.0], 15.0, 10.0),
    ] {
        assert!((ray(&c, at).d - want(l, b)).length() < 1e-6, "{at:?}");
    }
}

/// The camera that makes surroundings and the light that reads them mean the same by every pixel.
#[test]
fn surroundings_are_read_as_they_were_seen() {
    let (width, height) = (24, 13);
    let pixels: Vec<[f32; 3]> = (0..width * height)
        .map(|i| [(i * 37 % 101) as f32, (i * 53 % 97) as f32, (i * 71 % 89) as f32].map(|v| v / 50.0 + 0.1))
        .collect();
    let image = Image { width, height, pixels };
    // A scene's environment has its middle along -z, the emitter its left edge.
    let placed = Affine::rotate(DVec3::Y, 180.0).unwrap();
    let light = ImageEnvironment::new(&image, 1.0, &placed).unwrap();
    let c = Panorama::new(
        &View::ORIGIN,
        [-180.0, 180.0],
        ([-90.0, 90.0], Rows::Centered),
        [width as u32, height as u32],
    );
    let c = Camera::Panorama(c);
    for i in 0..width * height {
        // The first and the last row are the poles, where one direction is all columns.
        let (x, y) = (i % width, i / width);
        if y == 0 || y == height - 1 {
            let d = ray(&c, [x as f32 + 0.5, y as f32 + 0.5]).d;
            assert!((d.y.abs() - 1.0).abs() < 1e-6);
            continue;
        }
        let d = ray(&c, [x as f32 + 0.5, y as f32 + 0.5]).d;
        let found = light.radiance(d, &crate::testing::in_rgb()).to_rgb();
        for (found, want) in found.into_iter().zip(image.pixels[i]) {
            assert!((found - want).abs() < 1e-4, "pixel {x} {y}: {found} {want}");
        }
    }
}

#[test]
fn cube_faces_are_where_they_are_told() {
    let v = slanted();
    let size = [80, 60];
    let cross = Camera::CubeMap(CubeMap::new(&v, CubeLayout::Cross, size));
    let row = Camera::CubeMap(CubeMap::new(&v, CubeLayout::Row, [120, 21]));
    let middles = [
        (v.right, [50.0, 30.0], 0.0),
        (-v.right, [10.0, 30.0], 1.0),
        (v.up, [30.0, 10.0], 2.0),
        (-v.up, [30.0, 50.0], 3.0),
        (-v.forward, [70.0, 30.0], 4.0),
        (v.forward, [30.0, 30.0], 5.0),
    ];
    for (d, at, column) in middles {
        assert!((ray(&cross, at).d - d.as_vec3()).length() < 1e-6);
        assert!((ray(&row, [20.0 * column + 10.0, 10.0]).d - d.as_vec3()).length() < 1e-6);
    }
    // Unfolded faces join along the edges where they touch: nothing jumps there.
    let joins = [
        ([20.0, 33.0], [-1e-3, 0.0]),
        ([40.0, 33.0], [1e-3, 0.0]),
        ([60.0, 33.0], [1e-3, 0.0]),
        ([33.0, 20.0], [0.0, 1e-3]),
        ([33.0, 40.0], [0.0, 1e-3]),
    ];
    for ([x, y], [dx, dy]) in joins {
        let (a, b) = (ray(&cross, [x - dx, y - dy]).d, ray(&cross, [x + dx, y + dy]).d);
        assert!((a - b).length() < 1e-3, "{x} {y}");
    }
    // No face in the corners, nor below a row that leaves room.
    assert_eq!(cross.ray(&FilmPoint::at([5.0, 5.0])), None);
    assert_eq!(cross.ray(&FilmPoint::at([70.0, 50.0])), None);
    assert_eq!(row.ray(&FilmPoint::at([5.0, 20.5])), None);
    // A place beyond a face's edge still belongs to the face of its pixel.
    let beyond = FilmPoint { position: [40.5, 10.0], ..FilmPoint::at([39.5, 10.0]) };
    assert!(cross.ray(&beyond).is_some(), "a filter reaches where there is no face");
}
