//! Cameras by what the course and the photographer know of them.

mod all_around;
mod course;
mod eyes_and_motion;
mod footprints;
mod lens;
mod shown;

use super::*;
use straal_math::{DVec3, Vec3};

/// Pixels of the test pictures.
const SIZE: [u32; 2] = [200, 100];

/// What the film is off by: positions are single precision, and so are the rays by which they are found.
const PIXELS: f64 = 3e-3;

fn view() -> View {
    View::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, DVec3::Y).unwrap()
}

/// One that looks askew.
fn slanted() -> View {
    View::look_at(DVec3::new(2.0, 1.5, 4.0), DVec3::new(-0.3, 0.2, 0.4), DVec3::new(0.1, 1.0, 0.0))
        .unwrap()
        .rolled(20.0)
}

fn pinhole(view: &View) -> Camera {
    Camera::Perspective(Perspective::new(view, &Window::new(0.5, SIZE)))
}

fn ray(camera: &Camera, position: [f32; 2]) -> Ray {
    camera.ray(&FilmPoint::at(position)).expect("a ray")
}

/// Where on the film a point of the world is seen: found by looking at rays only, so that it holds for any camera whose rays
/// change smoothly.
fn seen(camera: &Camera, p: DVec3) -> [f64; 2] {
    seen_through(camera, p, [0.5; 2])
}

/// The same through a given place on the lens. Newton's method on how far the ray passes by.
fn seen_through(camera: &Camera, p: DVec3, lens: [f32; 2]) -> [f64; 2] {
    let off = |x: f64, y: f64| {
        let at = FilmPoint { lens, ..FilmPoint::at([x as f32, y as f32]) };
        let ray = camera.ray(&at).expect("a ray");
        let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
        // The point of the ray nearest to p, seen from p.
        o + d * ((p - o).dot(d) / d.dot(d)) - p
    };
    let [mut x, mut y] = SIZE.map(|n| 0.5 * f64::from(n));
    for _ in 0..20 {
        let here = off(x, y);
        const H: f64 = 0.5;
        let (a, b) =
            ((off(x + H, y) - off(x - H, y)) / (2.0 * H), (off(x, y + H) - off(x, y - H)) / (2.0 * H));
        // Least squares of here + a dx + b dy.
        let (aa, ab, bb, ah, bh) = (a.dot(a), a.dot(b), b.dot(b), a.dot(here), b.dot(here));
        let det = aa * bb - ab * ab;
        x -= (bb * ah - ab * bh) / det;
        y -= (aa * bh - ab * ah) / det;
    }
    assert!(off(x, y).length() < 1e-4 * (1.0 + p.length()), "{p:?} isn't seen");
    [x, y]
}

fn near(a: [f64; 2], b: [f64; 2], tolerance: f64) -> bool {
    (a[0] - b[0]).abs() < tolerance && (a[1] - b[1]).abs() < tolerance
}

/// Every kind of camera in the list, for a picture of [`SIZE`].
fn every_kind(view: &View) -> Vec<(&'static str, Camera)> {
    registry(view, SIZE).into_iter().flat_map(|(_, examples)| examples).collect()
}

#[test]
fn every_kind_is_registered() {
    for (kind, examples) in registry(&slanted(), SIZE) {
        assert!(!examples.is_empty(), "{kind} has no example");
        for (name, camera) in examples {
            // Rust's own name of the variant.
            assert!(format!("{camera:?}").starts_with(kind), "{name} is no {kind}");
            assert!(!camera.facts().kind.is_empty());
        }
    }
}

#[test]
fn every_ray_keeps_the_contract() {
    for (name, camera) in every_kind(&slanted()) {
        let needs = camera.needs();
        let mut count = 0;
        for i in 0..40_000_u32 {
            let unit = |k: u32| (f64::from(i.wrapping_mul(k)) / f64::from(u32::MAX)) as f32 * 0.999;
            let pixel = [i % SIZE[0], i / SIZE[0] % SIZE[1]];
            let position =
                [pixel[0] as f32 + 2.0 * unit(0x9e37_79b9) - 0.5, pixel[1] as f32 + unit(0x85eb_ca6b)];
            let at = FilmPoint {
                pixel,
                position,
                lens: [unit(0xc2b2_ae35), unit(0x27d4_eb2f)],
                time: unit(0x1656_67b1),
            };
            let Some(ray) = camera.ray(&at) else { continue };
            count += 1;
            assert!(ray.is_valid() && (ray.d.length() - 1.0).abs() < 1e-6, "{name}: {ray:?}");
            assert!(ray.time == at.time && ray.t_min == 0.0 && ray.t_max == f32::INFINITY, "{name}");
            // What a camera says it doesn't need makes no difference.
            let other = FilmPoint { lens: if needs.lens { at.lens } else { [0.1, 0.9] }, ..at };
            assert_eq!(camera.ray(&other), Some(ray), "{name}");
            assert!(needs.glasses || camera.glasses(&at) == [1.0; 3], "{name}");
            let later = camera.ray(&FilmPoint { time: 0.5 * at.time, ..at }).expect("the same place");
            if at.time > 0.01 {
                assert_eq!(needs.time, (later.o, later.d) != (ray.o, ray.d), "{name}");
            }
        }
        assert!(count > 10_000, "{name} sees only {count}");
    }
}

/// Every kind sends the same rays side by side as one by one.
#[test]
fn many_rays_are_what_each_is() {
    use straal_math::lowdisc::{Pattern, Purpose, SampleName};
    use straal_math::simd::{Isa, Kernel, Simd};

    struct Rays<'a>(&'a Camera, &'a [FilmPoint]);

    impl Kernel for Rays<'_> {
        type Output = Vec<Option<Ray>>;

        #[inline(always)]
        fn run<F: Float>(self) -> Self::Output {
            let mut rays = Vec::new();
            for points in self.1.chunks(F::WIDTH) {
                let point = |i: usize| points[i.min(points.len() - 1)];
                let at = FilmPoints::<F> {
                    pixel: [0, 1].map(|k| F::Uint::from_fn(|i| point(i).pixel[k])),
                    position: [0, 1].map(|k| F::from_fn(|i| point(i).position[k])),
                    lens: [0, 1].map(|k| F::from_fn(|i| point(i).lens[k])),
                    time: F::from_fn(|i| point(i).time),
                };
                let CameraRays { o, d, seen } = self.0.rays(&at);
                rays.extend((0..points.len()).map(|i| {
                    let ray = Ray { time: at.time.lane(i), ..Ray::new(o.lane(i), d.lane(i)) };
                    seen.lane(i).then_some(ray)
                }));
            }
            rays
        }
    }

    let points: Vec<FilmPoint> = (0..150)
        .map(|i| {
            let name = SampleName::new(3, [i, 0], i);
            let [x, y, u, v] = Pattern::Random.d4(&name, Purpose::Film);
            let position = [x * SIZE[0] as f32, y * SIZE[1] as f32];
            FilmPoint { lens: [u, v], time: u, ..FilmPoint::at(position) }
        })
        .collect();
    for (name, camera) in every_kind(&slanted()) {
        let each: Vec<_> = points.iter().map(|at| camera.ray(at)).collect();
        for simd in Isa::ALL.into_iter().filter_map(Simd::new) {
            assert_eq!(simd.run(Rays(&camera, &points)), each, "{name} {simd:?}");
        }
    }
}
