//! The tables of the page on sampling: how good the told error is, and how far off the quotient of splatted sums.

use super::tables::{Rows, row};
use crate::{Failure, root};
use straal::{Control, Job, LoadOptions, Overrides, PatternKind, Picture};
use straal_render::film::reach;
use straal_render::filter::{Filter, Profile, Separable};

/// Root mean squares of errors, over pixels and channels.
#[derive(Default)]
struct Errors {
    /// As pictures of different seeds differ.
    truth: f64,
    /// By the layer `error`.
    told: f64,
    /// By the spread of samples.
    spread: f64,
}

/// The error that the layer tells over the true one.
pub fn told_errors() -> Result<Rows, Failure> {
    let mut out =
        vec![row(["", "`random`, by spread", "`sobol`, by batches", "`sobol`, if it were by spread"])];
    for (name, scene) in [
        ("the spheres of `straal render` without a scene", "scenes/embedded.yaml"),
        ("the box with two spheres", "scenes/reference/box-diffuse.yaml"),
    ] {
        let [random, sobol] = [errors(scene, PatternKind::Random)?, errors(scene, PatternKind::Sobol)?];
        let ratios = [random.told / random.truth, sobol.told / sobol.truth, sobol.spread / sobol.truth];
        out.push(row([name.to_owned()].into_iter().chain(ratios.map(|r| format!("{r:.1}")))));
    }
    Ok(out)
}

fn errors(scene: &str, pattern: PatternKind) -> Result<Errors, Failure> {
    const SEEDS: u64 = 12;
    let wish = |seed| Overrides {
        size: Some([24, 24]),
        spp: Some(64),
        pattern: Some(pattern),
        seed: Some(seed),
        ..Overrides::default()
    };
    let mut runs: Vec<Picture> = Vec::new();
    for seed in 0..SEEDS {
        let loaded = straal::load(&root().join(scene), &LoadOptions::default())
            .map_err(|_| format!("{scene} is wrong; see `straal check`"))?;
        runs.push(Job::new(loaded, wish(seed))?.render(&mut Control::to_the_end())?.picture);
    }
    let n = SEEDS as f64;
    let mut sums = Errors::default();
    for i in 0..runs[0].layers.rgb.len() {
        for c in 0..3 {
            let mean = |of: &dyn Fn(&Picture) -> f32| runs.iter().map(|p| f64::from(of(p))).sum::<f64>() / n;
            let first = mean(&|p| p.layers.rgb[i][c]);
            let spread = |p: &Picture| f64::from(p.layers.rgb[i][c]) - first;
            sums.truth += runs.iter().map(|p| spread(p) * spread(p)).sum::<f64>() / (n - 1.0);
            sums.spread += mean(&|p| p.layers.variance[i][c]);
            sums.told += mean(&|p| p.layers.error.as_ref().map_or(0.0, |e| e.rgb[i][c] * e.rgb[i][c]));
        }
    }
    Ok(Errors { truth: sums.truth.sqrt(), told: sums.told.sqrt(), spread: sums.spread.sqrt() })
}

/// Bias and noise of the quotient of two sums, at an edge between black and white in the middle pixel.
pub fn splat_bias() -> Result<Rows, Failure> {
    let filters = [
        ("Gaussian: bias, noise", Profile::Gaussian { sigma: 0.5 }, 1.5),
        ("Mitchell", Profile::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }, 2.0),
        ("Lanczos", Profile::Lanczos, 3.0),
    ];
    let mut heading = row(["samples a pixel"]);
    let mut first = Vec::new();
    for (name, profile, radius) in filters {
        heading.push(name.to_owned());
        first.push(of_one_sample(&Filter::Separable(Separable::new(profile, radius).ok_or("no filter")?)));
    }
    let mut out = vec![heading];
    for samples in [4, 16, 64] {
        let n = f64::from(samples);
        let cells = first.iter().map(|[bias, noise]| format!("{:.5}, {:.2}", bias / n, noise / n.sqrt()));
        out.push([samples.to_string()].into_iter().chain(cells).collect());
    }
    Ok(out)
}

/// Root mean squares over places of the edge, of one sample a pixel: the bias, which falls as the number of samples rises, and the standard
/// deviation, which falls as its root does. Both by the first terms of the quotient's expansion in its sums' moments; each pixel's samples lie anywhere
/// in it and are independent.
fn of_one_sample(filter: &Filter) -> [f64; 2] {
    const STEPS: u32 = 256;
    const EDGES: u32 = 64;
    let reach = reach(f64::from(filter.radius())) as i32;
    // Places across a pixel, from its centre.
    let places = |n: u32| (0..n).map(move |i| (f64::from(i) + 0.5) / f64::from(n) - 0.5);
    // Of the places left of an edge, in a column of pixels: means of the height and of its square.
    let moments = |column: i32, edge: f64| {
        let (mut first, mut second) = (0.0, 0.0);
        for x in places(STEPS).map(|x| x + f64::from(column)).filter(|x| *x < edge) {
            let h = f64::from(filter.relative_height(x as f32));
            first += h / f64::from(STEPS);
            second += h * h / f64::from(STEPS);
        }
        [first, second]
    };
    let columns: Vec<i32> = (-reach..=reach).collect();
    let whole: Vec<[f64; 2]> = columns.iter().map(|c| moments(*c, f64::INFINITY)).collect();
    let sum = |of: &dyn Fn(usize) -> f64| (0..columns.len()).map(of).sum::<f64>();
    let [height, squares, squared] =
        [sum(&|i| whole[i][0]), sum(&|i| whole[i][1]), sum(&|i| whole[i][0] * whole[i][0])];
    let weight = height * height;
    let (mut bias, mut noise) = (0.0, 0.0);
    for edge in places(EDGES) {
        let left: Vec<[f64; 2]> = columns.iter().map(|c| moments(*c, edge)).collect();
        let mean = sum(&|i| left[i][0]) / height;
        // (Co)variances of the sum of heights and of that of light.
        let of_heights = squares * squares - squared * squared;
        let of_both = sum(&|i| left[i][1]) * squares - sum(&|i| left[i][0] * whole[i][0]) * squared;
        let of_light = sum(&|i| left[i][1]) * squares - sum(&|i| left[i][0] * left[i][0]) * squared;
        let off = (mean * of_heights - of_both) / (weight * weight);
        bias += off * off / f64::from(EDGES);
        noise += (of_light - 2.0 * mean * of_both + mean * mean * of_heights)
            / (weight * weight)
            / f64::from(EDGES);
    }
    [bias.sqrt(), noise.sqrt()]
}
