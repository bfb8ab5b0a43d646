//! Filtered pictures of a known function against its convolution by numerical integration.

mod common;

use straal::{Control, Job, LoadOptions, Overrides};
use straal_render::filter::{Filter, Profile, Separable};

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

#[test]
fn pictures_are_the_convolved_function() {
    let separable = |profile, radius| Filter::Separable(Separable::new(profile, radius).expect("a filter"));
    let third = 1.0 / 3.0;
    for (name, filter) in [
        ("box", Filter::Box),
        ("tent", separable(Profile::Tent, 1.0)),
        ("gaussian", separable(Profile::Gaussian { sigma: 0.5 }, 1.5)),
        ("mitchell", separable(Profile::Mitchell { b: third, c: third }, 2.0)),
        ("blackman_harris", separable(Profile::BlackmanHarris, 1.5)),
        ("lanczos", separable(Profile::Lanczos, 3.0)),
    ] {
        let loaded =
            straal::load_str("a test", &scene(name), std::path::Path::new(""), &LoadOptions::default())
                .unwrap_or_else(|e| panic!("{name}: {e}"));
        let job = Job::new(loaded, Overrides::default()).expect("a job");
        let picture = job.render(&mut Control::to_the_end()).expect("a picture").picture;
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
