//! Filtered pictures of a known function against its convolution by numerical integration.

use straal::compare::{Estimate, Tails, compare};
use straal::{Control, Job, LoadOptions, Overrides, PatternKind, Picture};
use straal_render::filter::{Filter, Profile, Separable};
use straal_scene::Image;

const SIZE: usize = 20;
const EXTENT: f64 = 3.0;

fn scene(filter: &str) -> String {
    format!(
        "camera:\n  orthographic: {{ eye: [1.5, 1.5, 1], look_at: [1.5, 1.5, 0], width: {EXTENT} }}\n\
         film: {{ size: [{SIZE}, {SIZE}], filter: {filter} }}\nsampler: {{ spp: 1024 }}\nintegrator: sine_product\n"
    )
}

/// The function at a place of the film, in pixels.
fn at(x: f64, y: f64) -> f64 {
    let scale = EXTENT / SIZE as f64;
    let product = x * scale * (SIZE as f64 - y) * scale;
    0.5 + 0.5 * straal_math::ops::sin_cos_d(product * product).0
}

/// The function about a pixel weighed by the filter.
fn convolved(filter: &Filter, px: usize, py: usize) -> f64 {
    let radius = f64::from(filter.radius());
    let n = 64;
    let offset = |i: usize| ((i as f64 + 0.5) / n as f64 * 2.0 - 1.0) * radius;
    let height = |i: usize| f64::from(filter.height(offset(i) as f32)) * 2.0 * radius / n as f64;
    let mut sum = 0.0;
    for j in 0..n {
        for i in 0..n {
            let value = at(px as f64 + 0.5 + offset(i), py as f64 + 0.5 + offset(j));
            sum += height(i) * height(j) * value;
        }
    }
    sum
}

fn filters() -> Vec<(&'static str, Filter)> {
    let separable = |profile, radius| Filter::Separable(Separable::new(profile, radius).expect("a filter"));
    let third = 1.0 / 3.0;
    vec![
        ("box", Filter::Box),
        ("tent", separable(Profile::Tent, 1.0)),
        ("gaussian", separable(Profile::Gaussian { sigma: 0.5 }, 1.5)),
        ("mitchell", separable(Profile::Mitchell { b: third, c: third }, 2.0)),
        ("blackman_harris", separable(Profile::BlackmanHarris, 1.5)),
        ("lanczos", separable(Profile::Lanczos, 3.0)),
    ]
}

fn job(text: &str, wish: Overrides) -> Job {
    let loaded = straal::load_str("a test", text, std::path::Path::new(""), &LoadOptions::default());
    Job::new(loaded.unwrap_or_else(|e| panic!("{e}")), wish).expect("a job")
}

fn render(text: &str, wish: Overrides) -> Picture {
    job(text, wish).render(&mut Control::to_the_end()).expect("a picture").picture
}

#[test]
fn pictures_are_the_convolved_function() {
    for (name, filter) in filters() {
        let picture = render(&scene(name), Overrides::default());
        let (mut squares, mut total) = (0.0, 0.0);
        for (i, rgb) in picture.layers.rgb.iter().enumerate() {
            let difference = f64::from(rgb[0]) - convolved(&filter, i % SIZE, i / SIZE);
            total += difference / (SIZE * SIZE) as f64;
            squares += difference * difference / (SIZE * SIZE) as f64;
        }
        let error = squares.sqrt();
        // Signed weights jump at the zeros of the profile, so that samples are less even.
        let signed = matches!(name, "mitchell" | "lanczos");
        let (each, mean) = if signed { (0.02, 1e-3) } else { (0.002, 2e-4) };
        assert!(error < each && total.abs() < mean, "{name}: RMS {error}, on average {total}");
    }
}

/// Away from the edges, beyond which there are no samples, splatting converges to the same picture.
#[test]
fn splatted_pictures_are_the_convolved_function() {
    for (name, filter) in filters() {
        let picture = render(&scene(name), Overrides { splat: Some(true), ..Overrides::default() });
        let (mut squares, mut total, mut count) = (0.0, 0.0, 0.0);
        let edge = filter.radius().ceil() as usize;
        for y in edge..SIZE - edge {
            for x in edge..SIZE - edge {
                let difference = f64::from(picture.layers.rgb[y * SIZE + x][0]) - convolved(&filter, x, y);
                total += difference;
                squares += difference * difference;
                count += 1.0;
            }
        }
        let (error, mean) = (f64::sqrt(squares / count), total / count);
        assert!(error < 0.004 && mean.abs() < 5e-4, "{name}: RMS {error}, on average {mean}");
    }
}

/// A scene of edges, highlights and noise, for both ways to filter.
fn edges(filter: &str) -> String {
    format!(
        "camera: {{ perspective: {{ eye: [0, 1, 6], look_at: [0, 0.6, 0], fov: 40 }} }}
film: {{ size: [40, 36], filter: {filter} }}
sampler: {{ spp: 16 }}
world:
  - plane: {{ material: {{ diffuse: {{ reflectance: [0.2, 0.6, 0.3] }} }} }}
  - sphere: {{ center: [-1, 0.8, 0], radius: 0.8, material: {{ conductor: {{ metal: gold, roughness: 0.2 }} }} }}
  - sphere: {{ center: [1, 0.8, 0], radius: 0.8, material: {{ diffuse: {{ reflectance: 0.7 }} }} }}
lights:
  - environment: {{ radiance: 0.5 }}
  - point: {{ position: [2, 4, 3], intensity: 20 }}
"
    )
}

#[test]
fn both_ways_to_filter_agree_within_chance() {
    const INSIDE: [u32; 4] = [4, 4, 36, 32];
    const REPLICATES: u32 = 8;
    let picture = |filter: &str, splat: bool| {
        let wish = Overrides {
            splat: Some(splat),
            crop: Some(INSIDE),
            // A quotient of sums is off by a part that falls with the number of samples.
            spp: Some(64),
            pattern: Some(PatternKind::Random),
            seed: Some(u64::from(splat)),
            ..Overrides::default()
        };
        let job = job(&edges(filter), wish);
        job.render_replicates(REPLICATES, &mut Control::to_the_end()).expect("replicates").picture
    };
    let differ = |a: &Picture, b: &Picture| {
        let image = |p: &Picture| (p.to_image(), Image { pixels: p.layers.variance.clone(), ..p.to_image() });
        let ((am, av), (bm, bv)) = (image(a), image(b));
        let dof = f64::from(REPLICATES - 1);
        let of = |mean, variance| Estimate { dof, ..Estimate::new(mean, Some(variance)) };
        compare(of(&am, &av), of(&bm, &bv), Tails::Light).expect("equal sizes").differs
    };
    for filter in ["gaussian", "lanczos"] {
        assert!(!differ(&picture(filter, false), &picture(filter, true)), "{filter}");
    }
    // The test can fail.
    assert!(differ(&picture("{ gaussian: { radius: 1.5, sigma: 0.4 } }", false), &picture("gaussian", true)));
}

#[test]
fn splats_have_the_same_bits_whatever_the_way() {
    for (filter, spectral) in [("{ tent: { radius: 1 } }", false), ("lanczos", true)] {
        let text = edges(filter);
        let wish = || Overrides {
            splat: Some(true),
            spp: Some(5),
            spectral: Some(spectral),
            ..Overrides::default()
        };
        let whole = render(&text, Overrides { threads: Some(1), ..wish() });
        let other = Overrides { threads: Some(5), batch: Some(7), shuffle_tiles: Some(3), ..wish() };
        assert!(render(&text, other).layers == whole.layers, "{filter}");
        for [x0, y0, x1, y1] in [[0, 0, 17, 16], [15, 9, 33, 36], [20, 20, 21, 21]] {
            let crop = render(&text, Overrides { crop: Some([x0, y0, x1, y1]), ..wish() });
            for y in y0..y1 {
                for x in x0..x1 {
                    let (i, j) = ((y * 40 + x) as usize, ((y - y0) * (x1 - x0) + x - x0) as usize);
                    assert_eq!(crop.layers.rgb[j], whole.layers.rgb[i], "{filter}: {x}, {y}");
                    assert_eq!(crop.layers.variance[j], whole.layers.variance[i], "{filter}: {x}, {y}");
                }
            }
        }
    }
}

/// The variance that a splatted picture tells is that of its replicates, or little more.
#[test]
fn splats_know_their_noise() {
    let wish = Overrides { splat: Some(true), pattern: Some(PatternKind::Random), ..Overrides::default() };
    let job = job(&edges("gaussian"), wish);
    let sum = |p: &Picture| p.layers.variance.as_flattened().iter().map(|v| f64::from(*v)).sum::<f64>();
    let told = sum(&job.render(&mut Control::to_the_end()).expect("a picture").picture);
    let replicates = job.render_replicates(32, &mut Control::to_the_end()).expect("replicates").picture;
    let measured = 32.0 * sum(&replicates);
    // Splatted samples lie evenly in their pixels: what edges tell is somewhat too much (1.15 times over 48 seeds).
    assert!(told > 0.9 * measured && told < 1.25 * measured, "told {told}, measured {measured}");
}

#[test]
fn splats_and_noise_exclude_each_other() {
    let loaded =
        straal::load_str("a test", &edges("tent"), std::path::Path::new(""), &LoadOptions::default());
    let wish = Overrides { splat: Some(true), noise: Some(0.02), ..Overrides::default() };
    let error = Job::new(loaded.expect("a scene"), wish).err().expect("an error").to_string();
    assert!(error.contains("weigh more in their neighbours"), "{error}");
}

/// Surroundings of radiance 1 and nothing else are 1 in every pixel, whatever the filter, the sampler and the number of samples.
#[test]
fn even_light_is_even_whatever_the_filter() {
    let scene = |filter: &str| {
        format!(
            "camera: {{ perspective: {{ eye: [0, 0, 5], look_at: [0, 0, 0] }} }}\n\
             film: {{ size: [16, 16], filter: {{ {filter} }} }}\nworld: []\n\
             lights: [ {{ environment: {{ radiance: 1 }} }} ]\n"
        )
    };
    for filter in ["mitchell: {}", "lanczos: {}", "mitchell: { b: 0, c: 0.5 }", "lanczos: { radius: 2 }"] {
        for (pattern, spp) in [(PatternKind::Sobol, 64), (PatternKind::Random, 48), (PatternKind::Sobol, 3)] {
            for noise in [None, Some(0.02)] {
                let wish =
                    Overrides { pattern: Some(pattern), spp: Some(spp), noise, ..Overrides::default() };
                let layers = render(&scene(filter), wish).layers;
                let off = layers
                    .rgb
                    .iter()
                    .flatten()
                    .map(|v| (v - 1.0).abs())
                    .fold(0.0, |a: f32, b| if b > a { b } else { a });
                assert!(off < 1e-5, "{filter} {pattern} {spp}: {off}");
                assert!(layers.variance.iter().flatten().all(|v| *v < 1e-9), "{filter}");
                // A batch of one sample has nothing to be told by.
                let error = layers.error.expect("the layer `error`");
                assert!(spp < 8 || error.rgb.iter().flatten().all(|v| *v < 1e-4), "{filter}");
            }
        }
    }
}
