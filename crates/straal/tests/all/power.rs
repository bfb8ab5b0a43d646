//! The statistics of `straal diff` on real renders: equal pictures pass, and small faults are found.

use crate::common;

use straal::compare::{Estimate, Tails, compare};
use straal::{Control, Overrides, Picture};
use straal_math::Ray;
use straal_math::lowdisc::{PatternKind, Purpose};
use straal_render::driver::Render;
use straal_render::integrator::{Integrator, Out, PathTracer, Queue, Start};
use straal_render::lanes::Lanes;
use straal_render::world::World;
use straal_scene::Image;

const REPLICATES: u32 = 16;

fn replicates(scene: &str, side: u32, seed: u64, spp: u32) -> Picture {
    let wish = Overrides {
        size: Some([side, side]),
        spp: Some(spp),
        seed: Some(seed),
        pattern: Some(PatternKind::Random),
        ..Overrides::default()
    };
    let job = common::job(scene, wish);
    job.render_replicates(REPLICATES, &mut Control::to_the_end()).expect("replicates").picture
}

/// The box under another seed, which two tests compare with.
fn another() -> &'static Picture {
    static ANOTHER: std::sync::LazyLock<Picture> = std::sync::LazyLock::new(|| replicates(BOX, 48, 1001, 10));
    &ANOTHER
}

/// A room that needs few samples: one per cent of its light shows among 160 a pixel.
const BOX: &str = "scenes/reference/box-diffuse.yaml";

fn images(p: &Picture) -> (Image, Image) {
    let variance = Image { pixels: p.layers.variance.clone(), ..p.to_image() };
    (p.to_image(), variance)
}

fn differs(a: (&Image, &Image), b: &Picture, tails: Tails) -> bool {
    let (bm, bv) = images(b);
    let dof = f64::from(REPLICATES - 1);
    let a = Estimate { dof, ..Estimate::new(a.0, Some(a.1)) };
    let b = Estimate { dof, ..Estimate::new(&bm, Some(&bv)) };
    let verdict = compare(a, b, tails).expect("equal sizes");
    verdict.differs
}

fn brighter(image: &Image, by: f32) -> Image {
    Image { pixels: image.pixels.iter().map(|p| p.map(|v| v * by)).collect(), ..image.clone() }
}

fn shifted(image: &Image) -> Image {
    let mut out = image.clone();
    for (row, from) in out.pixels.chunks_mut(image.width).zip(image.pixels.chunks(image.width)) {
        row[1..].copy_from_slice(&from[..image.width - 1]);
    }
    out
}

#[test]
fn independent_renders_agree_and_small_faults_show() {
    let (mean, variance) = images(&replicates(BOX, 48, 1, 10));
    let b = another();
    assert!(!differs((&mean, &variance), b, Tails::Light), "independent renders differ");
    assert!(differs((&brighter(&mean, 1.01), &variance), b, Tails::Light), "x 1.01 passes");
    assert!(differs((&shifted(&mean), &shifted(&variance)), b, Tails::Light), "a shift by one pixel passes");
}

#[test]
fn heavy_tails_hide_no_two_percent() {
    let scene = "scenes/glass-and-mirror.yaml";
    let (a, b) = (replicates(scene, 40, 1, 56), replicates(scene, 40, 1001, 56));
    let (mean, variance) = images(&a);
    assert!(!differs((&mean, &variance), &b, Tails::Heavy), "independent renders differ");
    assert!(differs((&brighter(&mean, 1.02), &variance), &b, Tails::Heavy), "x 1.02 passes");
}

/// A path tracer with a bug: one path in ten ends at each bounce, and the survivors aren't told.
struct Forgetful(PathTracer);

impl Integrator for Forgetful {
    type State<L: Lanes> = <PathTracer as Integrator>::State<L>;

    fn start<L: Lanes>(&self, start: &Start<'_, L>) -> Option<(Ray, Self::State<L>)> {
        self.0.start(start)
    }

    fn step<L: Lanes>(
        &self,
        world: &World,
        queue: &Queue<'_, Self::State<L>>,
        out: &mut Out<'_, Self::State<L>>,
    ) {
        let before = out.next.len();
        self.0.step(world, queue, out);
        for i in (before..out.next.len()).rev() {
            if queue.pattern.d1(&out.next[i].name, Purpose::Custom) < 0.1 {
                out.next.swap_remove(i);
                out.rays.swap_remove(i);
            }
        }
    }
}

#[test]
fn a_roulette_weight_left_out_shows() {
    let wish = Overrides { size: Some([48, 48]), pattern: Some(PatternKind::Random), ..Overrides::default() };
    let job = common::job(BOX, wish);
    let mut settings = job.settings.clone();
    let render = |settings| {
        let mut render =
            Render::new(&job.world, Forgetful(job.path_tracer()), settings, None).expect("threads");
        // A tenth of the light a bounce needs few samples to be missed.
        render.advance(REPLICATES * 8);
        render.into_film().layers()
    };
    settings.seed = 77;
    let layers = render(settings);
    let mean = Image { width: layers.width, height: layers.height, pixels: layers.rgb };
    let variance = Image { pixels: layers.variance, ..mean.clone() };
    assert!(differs((&mean, &variance), another(), Tails::Light));
}
