//! A light tracer, to prove the doors of an integrator: paths that start at a light, and light for any place of the film.

use std::path::Path;
use straal::{Job, LoadOptions, Overrides};
use straal_accel::Isa;
use straal_color::Light;
use straal_math::lowdisc::Purpose;
use straal_math::{Ray, Vec3, warp};
use straal_render::driver::{Render, RenderError};
use straal_render::film::{Layers, hash_of};
use straal_render::footprint::PackedFootprint;
use straal_render::integrator::{Contribution, Integrator, Origin, Out, PathTracer, Queue, Start};
use straal_render::lanes::Lanes;
use straal_render::material::{Shaded, Transport};
use straal_render::settings::Settings;
use straal_render::shape::offset::{End, ray_between};
use straal_render::world::World;

/// A point light of one intensity above a ball and a table with a wall, seen through a pinhole at the origin that looks along -z.
const SCENE: &str = "\
camera: { perspective: { eye: [0, 0, 0], look_at: [0, 0, -1], fov: 60 } }
film: { size: [48, 32] }
world:
  - rectangle: { corner: [-4, -1, 1], edges: [[8, 0, 0], [0, 0, -8]], material: { diffuse: { reflectance: [0.7, 0.6, 0.5] } } }
  - rectangle: { corner: [-4, -1, -6], edges: [[8, 0, 0], [0, 6, 0]], material: { diffuse: { reflectance: [0.3, 0.5, 0.7] } } }
  - sphere: { center: [-0.4, -0.4, -3], radius: 0.6, material: { diffuse: { reflectance: 0.8 } } }
lights:
  - point: { position: [1, 2.5, -2], intensity: [9, 7, 5] }
";
const LIGHT: Vec3 = Vec3::new(1.0, 2.5, -2.0);
const SIZE: [u32; 2] = [48, 32];

/// Direct and indirect light up to some number of edges, by paths from the light.
struct LightTracer {
    max_depth: u32,
    focal_pixels: f32,
}

impl Integrator for LightTracer {
    type State<L: Lanes> = (Light, u32);
    const ORIGIN: Origin = Origin::Light;
    const SPLATS: bool = true;

    fn start<L: Lanes>(&self, start: &Start<'_, L>) -> Option<(Ray, (Light, u32))> {
        let d = warp::uniform_sphere(start.pattern.d2(&start.name, Purpose::Custom));
        let intensity = start.lanes.radiance_of_rgb(&start.world.tables, Light::rgb([9.0, 7.0, 5.0]));
        let share = 4.0 * std::f32::consts::PI / (SIZE[0] * SIZE[1]) as f32;
        Some((Ray::new(LIGHT, d), (intensity * share, 2)))
    }

    fn step<L: Lanes>(
        &self,
        world: &World,
        queue: &Queue<'_, (Light, u32)>,
        out: &mut Out<'_, (Light, u32)>,
    ) {
        for a in queue.arrivals().filter(|a| a.hit.is_hit()) {
            let (surface, (beta, depth)) =
                (world.surface(a.ray, a.hit, &PackedFootprint::NONE), a.path.state);
            let shaded = Shaded { bsdf: world.bsdf(&surface, L::drawn(&world.tables, 0.0)), ng: surface.ng };
            let (wo, end) = (surface.frame.to_local(-a.ray.d), End::from(&surface.point));

            // To the pinhole, and from there to the film.
            let pinhole = End { p: Vec3::ZERO, p_err: Vec3::ZERO, ng: Vec3::ZERO };
            let (d2, towards) = (end.p.length_squared(), -end.p.normalize());
            let value = shaded.eval_pdf(wo, surface.frame.to_local(towards), Transport::Importance).0;
            if towards.z > 0.0 && !value.is_black() {
                let f = self.focal_pixels;
                let at = [24.0 + f * end.p.x / -end.p.z, 16.0 - f * end.p.y / -end.p.z];
                let density = f * f / (towards.z * towards.z * towards.z * d2);
                out.shadow(
                    ray_between(&end, &pinhole),
                    Contribution::splat(a.path, beta * value * density, at),
                );
            }

            // And on.
            let u = queue.pattern.d2(&a.path.name, Purpose::Direction);
            let drawn = shaded.sample(wo, 0.0, u, Transport::Importance);
            if let Some(s) = drawn.filter(|_| depth < self.max_depth) {
                let d = surface.frame.to_world(s.wi);
                out.go_on(a.path, 0, Ray::new(end.leave(d), d), (beta * s.weight, depth + 1));
            }
        }
    }
}

fn job_of(text: &str, wish: Overrides) -> Job {
    let loaded = straal::load_str("test.yaml", text, Path::new(""), &LoadOptions::default());
    Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), wish).expect("a world")
}

fn tracer(world: &World, max_depth: u32) -> LightTracer {
    LightTracer { max_depth, focal_pixels: world.camera.focal_pixels().expect("a pinhole") as f32 }
}

fn render<I: Integrator>(integrator: I, world: &World, settings: Settings, passes: &[u32]) -> Layers {
    let mut render = Render::new(world, integrator, settings, None).expect("threads");
    passes.iter().for_each(|samples| render.advance(*samples));
    render.into_film().layers()
}

/// By blocks of 8 x 8 pixels and colour: the difference of two means of pictures over its standard error.
fn z_values(a: &[Vec<[f32; 3]>], b: &[Vec<[f32; 3]>]) -> Vec<f64> {
    let blocks = |picture: &Vec<[f32; 3]>| -> Vec<f64> {
        let across = SIZE[0] as usize / 8;
        let mut sums = vec![0.0; 3 * across * (SIZE[1] as usize / 8)];
        for (i, rgb) in picture.iter().enumerate() {
            let (x, y) = (i % SIZE[0] as usize, i / SIZE[0] as usize);
            for c in 0..3 {
                sums[3 * (y / 8 * across + x / 8) + c] += f64::from(rgb[c]);
            }
        }
        sums
    };
    let moments = |pictures: &[Vec<[f32; 3]>]| -> Vec<[f64; 2]> {
        let all: Vec<Vec<f64>> = pictures.iter().map(blocks).collect();
        let n = all.len() as f64;
        let of = |k: usize| {
            let mean = all.iter().map(|p| p[k]).sum::<f64>() / n;
            let spread = all.iter().map(|p| (p[k] - mean) * (p[k] - mean)).sum::<f64>();
            [mean, spread / (n * (n - 1.0))]
        };
        (0..all[0].len()).map(of).collect()
    };
    let z = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]) / (a[1] + b[1]).sqrt();
    moments(a).iter().zip(&moments(b)).map(z).filter(|z| z.is_finite()).collect()
}

/// Light tracing tells no noise: it is told by pictures of other seeds.
#[test]
fn agrees_with_path_tracing() {
    let job = job_of(SCENE, Overrides::default());
    for max_depth in [2, 4] {
        let pictures = |seeds: std::ops::Range<u64>, by_light: bool| -> Vec<Vec<[f32; 3]>> {
            seeds
                .map(|seed| {
                    let settings = Settings { seed, ..job.settings.clone() };
                    if by_light {
                        render(tracer(&job.world, max_depth), &job.world, settings, &[32]).rgb
                    } else {
                        let path = PathTracer { max_depth, ..PathTracer::default() };
                        render(path, &job.world, settings, &[32]).rgb
                    }
                })
                .collect()
        };
        let (mut by_light, by_path) = (pictures(1..13, true), pictures(101..113, false));
        let moments = |by_light: &[Vec<[f32; 3]>]| -> (f64, f64) {
            let z = z_values(by_light, &by_path);
            let square = z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64;
            (square, z.iter().fold(0.0, |worst, z| if z.abs() > worst { z.abs() } else { worst }))
        };
        // Student's t of 22 degrees of freedom has the variance 22 / 20 = 1.1, and the deviation of its square is 1.7. Blocks, and
        // colours of one block, aren't independent: the 24 blocks count.
        let limit = 1.1 + 3.0 * 1.7 / 24.0_f64.sqrt();
        let (square, worst) = moments(&by_light);
        assert!(square < limit && worst < 5.5, "depth {max_depth}: {square} {worst}");
        by_light.iter_mut().flatten().for_each(|rgb| *rgb = rgb.map(|v| 1.05 * v));
        assert!(moments(&by_light).0 > limit, "5 % more light isn't seen");
    }
}

#[test]
fn has_the_same_bits_in_any_order() {
    let job = job_of(SCENE, Overrides::default());
    let hash = |settings: Settings, passes: &[u32]| {
        hash_of(&render(tracer(&job.world, 4), &job.world, settings, passes).rgb)
    };
    let plain = || Settings { threads: 1, ..job.settings.clone() };
    let want = hash(plain(), &[6]);
    assert_eq!(hash(Settings { threads: 7, batch: 7, ..plain() }, &[6]), want);
    assert_eq!(hash(Settings { threads: 2, batch: 1, shuffle_tiles: Some(3), ..plain() }, &[1, 3, 2]), want);
    for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
        let job = job_of(SCENE, Overrides { isa: Some(isa), ..Overrides::default() });
        let layers = render(tracer(&job.world, 4), &job.world, plain(), &[6]);
        assert_eq!(hash_of(&layers.rgb), want, "{isa:?}");
    }
}

#[test]
fn what_does_not_go_with_it_is_refused() {
    let job = job_of(SCENE, Overrides::default());
    for settings in [
        Settings { noise: Some(0.1), ..job.settings.clone() },
        Settings { splat: true, ..job.settings.clone() },
    ] {
        let refused = Render::new(&job.world, tracer(&job.world, 2), settings, None).err();
        assert!(matches!(refused, Some(RenderError::LightSplats(_))));
    }
}
