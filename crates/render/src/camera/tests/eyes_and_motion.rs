//! Two eyes, and a camera that moves.

use super::*;

const SEPARATION: f64 = 0.3;
const CONVERGENCE: f64 = 4.0;

fn stereo(layout: StereoLayout) -> Camera {
    let own = Stereo::picture(layout, SIZE);
    let eyes = Eyes { separation: SEPARATION, convergence: CONVERGENCE };
    let cameras = [0, 1].map(|i| {
        let (view, window) = eyes.eye(i, &slanted(), &Window::new(0.5, own));
        Camera::Perspective(Perspective::new(&view, &window))
    });
    Camera::Stereo(Box::new(Stereo::new(cameras, layout, own[0])))
}

/// Where the left and the right eye see a point, each on its own whole picture.
fn both(p: DVec3) -> [[f64; 2]; 2] {
    let c = stereo(StereoLayout::Anaglyph);
    [0.25, 0.75].map(|u| seen_through(&c, p, [u, 0.5]))
}

#[test]
fn parallax_follows_distance() {
    let v = slanted();
    for z in [1.5, 4.0, 7.0, 1000.0] {
        let p = v.eye + v.forward * z + v.right * 0.2 - v.up * 0.1;
        let [left, right] = both(p);
        assert!((left[1] - right[1]).abs() < PIXELS, "eyes see things at the same height");
        // In units of the plane at distance 1, of which there are 200 pixels: s (1/z - 1/c). What is near is further right
        // for the left eye.
        let want = 200.0 * SEPARATION * (1.0 / z - 1.0 / CONVERGENCE);
        assert!((left[0] - right[0] - want).abs() < 2.0 * PIXELS, "{z}: {left:?} {right:?} {want}");
    }
}

#[test]
fn halves_are_the_eyes() {
    let whole = |i: usize| {
        let eyes = Eyes { separation: SEPARATION, convergence: CONVERGENCE };
        let (view, window) = eyes.eye(i, &slanted(), &Window::new(0.5, [100, 100]));
        Camera::Perspective(Perspective::new(&view, &window))
    };
    let (parallel, crossed) = (stereo(StereoLayout::Parallel), stereo(StereoLayout::Crossed));
    for at in [[0.5, 0.5], [30.0, 70.0], [99.5, 99.5]] {
        let shifted = [at[0] + 100.0, at[1]];
        assert_eq!(ray(&parallel, at), ray(&whole(0), at));
        assert_eq!(ray(&parallel, shifted), ray(&whole(1), at));
        assert_eq!(ray(&crossed, at), ray(&whole(1), at));
        assert_eq!(ray(&crossed, shifted), ray(&whole(0), at));
    }
    // An odd column at the right belongs to nobody.
    let odd = Stereo::new([whole(0), whole(1)], StereoLayout::Parallel, 99);
    assert_eq!(odd.ray(&FilmPoint::at([198.5, 3.0])), None);
}

#[test]
fn glasses_take_each_colour_once() {
    let c = stereo(StereoLayout::Anaglyph);
    let mut sum = [0.0; 3];
    for i in 0..64_u8 {
        let at = FilmPoint { lens: [(f32::from(i) + 0.5) / 64.0, 0.3], ..FilmPoint::at([50.0, 50.0]) };
        for (s, t) in sum.iter_mut().zip(c.taken(&at)) {
            *s += t / 64.0;
        }
    }
    assert_eq!(sum, [1.0; 3]);
    let left = FilmPoint { lens: [0.2, 0.5], ..FilmPoint::at([50.0, 50.0]) };
    assert_eq!(c.taken(&left), [2.0, 0.0, 0.0], "red is the left eye's");
}

#[test]
fn a_moving_camera_is_a_still_one_at_every_moment() {
    let stands = [
        Stand { eye: DVec3::new(1.0, 2.0, 5.0), look_at: DVec3::ZERO, up: DVec3::Y, roll: 0.0 },
        Stand {
            eye: DVec3::new(-2.0, 1.0, 4.0),
            look_at: DVec3::new(0.0, 1.0, 0.0),
            up: DVec3::new(0.3, 1.0, 0.0),
            roll: 40.0,
        },
    ];
    for (name, own) in every_kind(&View::ORIGIN).into_iter().filter(|(n, _)| *n != "moving") {
        let moving = Camera::Moving(Box::new(Moving::new(own, stands, [0.5, 1.0])));
        for time in [0.0_f32, 0.25, 1.0] {
            // The shutter is open in the second half of the way.
            let t = 0.5 + 0.5 * f64::from(time);
            let mix = |a: DVec3, b: DVec3| a * (1.0 - t) + b * t;
            let [a, b] = stands;
            let view = View::look_at(mix(a.eye, b.eye), mix(a.look_at, b.look_at), mix(a.up, b.up)).unwrap();
            let still = every_kind(&view.rolled(40.0 * t)).into_iter().find(|(n, _)| *n == name).unwrap().1;
            for position in [[100.5, 50.5], [62.0, 31.0], [130.0, 60.0]] {
                let at = FilmPoint { time, lens: [0.3, 0.8], ..FilmPoint::at(position) };
                let (found, want) = (moving.ray(&at), still.ray(&at));
                let (Some(found), Some(want)) = (found, want) else {
                    assert_eq!(found.is_some(), want.is_some(), "{name}");
                    continue;
                };
                assert!((found.o - want.o).length() < 3e-6, "{name}: {found:?} {want:?}");
                assert!((found.d - want.d).length() < 3e-6, "{name}: {found:?} {want:?}");
            }
        }
    }
}

#[test]
fn a_moment_without_view_has_no_ray() {
    let stand =
        |z: f64| Stand { eye: DVec3::new(0.0, 0.0, z), look_at: DVec3::ZERO, up: DVec3::Y, roll: 0.0 };
    let own = pinhole(&View::ORIGIN);
    let through = Camera::Moving(Box::new(Moving::new(own, [stand(1.0), stand(-1.0)], [0.0, 1.0])));
    let at = |time| FilmPoint { time, ..FilmPoint::at([100.0, 50.0]) };
    assert!(through.ray(&at(0.25)).is_some() && through.ray(&at(0.75)).is_some());
    assert_eq!(through.ray(&at(0.5)), None);
}
