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
    Camera::Stereo(Stereo::new(cameras, layout, own[0]))
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
        for (s, t) in sum.iter_mut().zip(c.glasses(&at)) {
            *s += t / 64.0;
        }
    }
    assert_eq!(sum, [1.0; 3]);
    let left = FilmPoint { lens: [0.2, 0.5], ..FilmPoint::at([50.0, 50.0]) };
    assert_eq!(c.glasses(&left), [2.0, 0.0, 0.0], "red is the left eye's");
}

/// A way of three poses. From the second to the third at half the pace.
fn way() -> Vec<(f64, Stand)> {
    let start = Stand { eye: DVec3::new(1.0, 2.0, 5.0), look_at: DVec3::ZERO, up: DVec3::Y, roll: 0.0 };
    let turned = Stand {
        eye: DVec3::new(-2.0, 1.0, 4.0),
        look_at: DVec3::new(0.0, 1.0, 0.0),
        up: DVec3::new(0.3, 1.0, 0.0),
        roll: 40.0,
    };
    let end = Stand { eye: DVec3::new(0.0, 1.0, -4.0), roll: -20.0, ..turned };
    vec![(0.0, start), (0.25, turned), (0.75, end)]
}

/// Checks each kind of camera, carried along a way, by the still one that stands where the way is at a moment.
#[track_caller]
fn is_carried(way: &[(f64, Stand)], shutter: [f64; 2], moments: &[(f32, Stand)]) {
    // All kinds at each moment: some take long to make.
    let stills: Vec<_> = moments
        .iter()
        .map(|(time, stand)| {
            let view = View::look_at(stand.eye, stand.look_at, stand.up).unwrap();
            (*time, every_kind(&view.rolled(stand.roll)))
        })
        .collect();
    for (name, own) in every_kind(&View::ORIGIN).into_iter().filter(|(n, _)| *n != "moving") {
        let moving = Camera::Moving(Moving::new(own, way.to_vec(), shutter).unwrap());
        for (time, kinds) in &stills {
            let still = &kinds.iter().find(|(n, _)| *n == name).unwrap().1;
            for position in [[100.5, 50.5], [62.0, 31.0], [130.0, 60.0]] {
                let at = FilmPoint { time: *time, lens: [0.3, 0.8], ..FilmPoint::at(position) };
                let (found, want) = (moving.ray(&at), still.ray(&at));
                let (Some(found), Some(want)) = (found, want) else {
                    assert_eq!(found.is_some(), want.is_some(), "{name}");
                    continue;
                };
                assert!((found.o - want.o).length() < 3e-6, "{name} at {time}: {found:?} {want:?}");
                assert!((found.d - want.d).length() < 3e-6, "{name} at {time}: {found:?} {want:?}");
            }
        }
    }
}

fn mixed(a: Stand, b: Stand, t: f64) -> Stand {
    let mix = |a: DVec3, b: DVec3| a * (1.0 - t) + b * t;
    Stand {
        eye: mix(a.eye, b.eye),
        look_at: mix(a.look_at, b.look_at),
        up: mix(a.up, b.up),
        roll: a.roll * (1.0 - t) + b.roll * t,
    }
}

#[test]
fn a_moving_camera_is_a_still_one_at_every_moment() {
    let [(_, a), (_, b), _] = way()[..] else { panic!("three poses") };
    // The shutter is open in the second half of the way.
    let moments = [0.0_f32, 0.25, 1.0].map(|time| (time, mixed(a, b, 0.5 + 0.5 * f64::from(time))));
    is_carried(&[(0.0, a), (1.0, b)], [0.5, 1.0], &moments);
}

#[test]
fn a_way_of_several_poses_goes_from_each_to_the_next_and_rests_at_the_last() {
    let [(_, a), (_, b), (_, c)] = way()[..] else { panic!("three poses") };
    let moments = [
        (0.0, a),
        (0.125, mixed(a, b, 0.5)),
        (0.25, b),
        (0.375, mixed(b, c, 0.25)),
        (0.75, c),
        (0.875, c),
        (1.0, c),
    ];
    is_carried(&way(), [0.0, 1.0], &moments);
    // A shutter that is open for a part of it.
    is_carried(&way(), [0.125, 0.375], &[(0.0, mixed(a, b, 0.5)), (0.5, b), (1.0, mixed(b, c, 0.25))]);
    let own = || pinhole(&View::ORIGIN);
    for way in [vec![], vec![(0.0, a)], vec![(0.0, a), (0.0, b)], vec![(0.5, a), (0.25, b)]] {
        assert_eq!(Moving::new(own(), way, [0.0, 1.0]), None);
    }
}

#[test]
fn a_moment_without_view_has_no_ray() {
    let stand =
        |z: f64| Stand { eye: DVec3::new(0.0, 0.0, z), look_at: DVec3::ZERO, up: DVec3::Y, roll: 0.0 };
    let own = pinhole(&View::ORIGIN);
    let through =
        Camera::Moving(Moving::new(own, vec![(0.0, stand(1.0)), (1.0, stand(-1.0))], [0.0, 1.0]).unwrap());
    let at = |time| FilmPoint { time, ..FilmPoint::at([100.0, 50.0]) };
    assert!(through.ray(&at(0.25)).is_some() && through.ray(&at(0.75)).is_some());
    assert_eq!(through.ray(&at(0.5)), None);
}
