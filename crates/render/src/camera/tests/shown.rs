//! Where things are seen, by the cameras that know it.

use super::*;

#[test]
fn a_point_is_shown_where_its_ray_starts() {
    let mut tried = 0;
    for (kind, examples) in registry(&slanted(), SIZE) {
        for (name, camera) in examples {
            if !camera.can_show() {
                assert_eq!(camera.shows(Sought::Point(Vec3::ZERO), [0.5; 2]), None, "{kind}: {name}");
                continue;
            }
            tried += 1;
            for (position, lens, t) in [
                ([30.25, 70.5], [0.2, 0.7], 3.0_f32),
                ([150.0, 20.0], [0.9, 0.4], 7.5),
                ([-4.0, 104.0], [0.5, 0.1], 0.6),
            ] {
                let at = FilmPoint { lens, ..FilmPoint::at(position) };
                let ray = camera.ray(&at).expect("a ray");
                let shown = camera.shows(Sought::Point(ray.at(t)), lens).expect("it is in front");
                let off = (0..2).map(|k| f64::from((shown.position[k] - position[k]).abs()));
                assert!(off.sum::<f64>() < 2.0 * PIXELS, "{name}: {shown:?} {position:?}");
                assert!((shown.o - ray.o).length() < 1e-5 && (shown.d - ray.d).length() < 1e-5, "{name}");
                // What a pixel covers at that distance, across the ray.
                let footprint = camera.footprint(&at);
                let [x, y] = [0, 1].map(|k| footprint.o[k] + footprint.d[k] * t);
                let covers = x.cross(y).dot(ray.d).abs();
                assert!((shown.density * covers - 1.0).abs() < 1e-3, "{name}: {}", shown.density * covers);
                assert_eq!(camera.shows(Sought::Point(ray.at(-t)), lens), None, "{name}");

                let Some(far) = camera.shows(Sought::Direction(ray.d), lens) else {
                    assert!(matches!(camera, Camera::Orthographic(_)), "{name}");
                    continue;
                };
                let off = (0..2).map(|k| f64::from((far.position[k] - position[k]).abs()));
                assert!(off.sum::<f64>() < 2.0 * PIXELS && far.o == shown.o, "{name}: {far:?}");
                let angle = footprint.d[0].cross(footprint.d[1]).dot(ray.d).abs();
                assert!((far.density * angle - 1.0).abs() < 1e-3, "{name}");
                assert_eq!(camera.shows(Sought::Direction(-ray.d), lens), None, "{name}");
            }
        }
    }
    assert!(tried >= 5);
}
