//! Thin lenses: what is sharp, how unsharp the rest is, and how the opening is filled.

use super::*;
use crate::testing::{chi_square_p, sidak};
use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_math::ops;

const FOCUS: f64 = 3.0;
const RADIUS: f64 = 0.2;

fn lens(iris: Iris) -> Camera {
    Camera::ThinLens(ThinLens::new(&slanted(), &Window::new(0.5, SIZE), iris, FOCUS))
}

/// Places in the unit square whose places on a round lens are the rim's; the last is the middle.
const RIM: [[f32; 2]; 5] = [[0.0, 0.5], [1.0, 0.5], [0.5, 0.0], [0.5, 1.0], [0.5, 0.5]];

#[test]
fn what_is_in_focus_is_sharp() {
    let v = slanted();
    let c = lens(Iris::round(RADIUS));
    for (x, y) in [(0.0, 0.0), (0.7, 0.2), (-1.0, -0.5)] {
        let p = v.eye + v.forward * FOCUS + v.right * x + v.up * y;
        let plain = seen(&pinhole(&v), p);
        for u in RIM {
            assert!(near(seen_through(&c, p, u), plain, PIXELS), "{u:?}");
        }
    }
}

/// A point at distance z is spread over a circle of radius r |z - f| / z in the plane in focus.
#[test]
fn the_circle_of_confusion_is_that_of_the_formula() {
    let v = slanted();
    let c = lens(Iris::round(RADIUS));
    for z in [1.0, 2.0, 2.9, 3.2, 6.0, 100.0] {
        let p = v.eye + v.forward * z + v.right * (0.05 * z);
        let middle = seen_through(&c, p, RIM[4]);
        assert!(near(middle, seen(&pinhole(&v), p), PIXELS));
        // One unit in the plane in focus is 200 pixels over its distance.
        let want = RADIUS * (z - FOCUS).abs() / z * 200.0 / FOCUS;
        for u in &RIM[..4] {
            let [x, y] = seen_through(&c, p, *u);
            let (dx, dy) = (x - middle[0], y - middle[1]);
            let found = (dx * dx + dy * dy).sqrt();
            assert!((found - want).abs() < 2.0 * PIXELS, "{z}: {found} {want}");
        }
    }
}

#[test]
fn facts_agree_with_the_circle_of_confusion() {
    let facts = lens(Iris::round(RADIUS)).facts();
    let focus = facts.focus.unwrap();
    let spread = |z: f64| 2.0 * RADIUS * (z - FOCUS).abs() / z * 200.0 / FOCUS;
    assert!(focus.sharp[0] < FOCUS && focus.sharp[1] > FOCUS);
    assert!(focus.sharp.iter().all(|z| (spread(*z) - 1.0).abs() < 1e-5), "{focus:?}");
    let [w, h] = facts.degrees.unwrap();
    assert!((w - 53.130_102).abs() < 1e-4 && (h - 28.072_487).abs() < 1e-4);
    let tiny = lens(Iris::round(1e-3)).facts().focus.unwrap();
    assert_eq!(tiny.sharp[1], f64::INFINITY);
}

/// Pearson's test of counts against shares, to be judged with others.
fn agrees(counts: &[u32], shares: &[f64], tests: usize) {
    let n: f64 = counts.iter().map(|&c| f64::from(c)).sum();
    let total: f64 = shares.iter().sum();
    let mut statistic = 0.0;
    let mut cells = 0;
    for (&count, share) in counts.iter().zip(shares) {
        let expected = n * share / total;
        if expected < 5.0 {
            assert!(f64::from(count) < 40.0);
            continue;
        }
        cells += 1;
        statistic += (f64::from(count) - expected) * (f64::from(count) - expected) / expected;
    }
    let p = chi_square_p(statistic, cells - 1);
    assert!(p > sidak(0.01, tests), "p {p}: {statistic} with {cells} cells");
}

fn draws(iris: &Iris) -> impl Iterator<Item = [f64; 2]> {
    (0..200_000).map(|i| {
        let [_, _, u, v] = Pattern::Random.d4(&SampleName::new(3, [0, 0], i), Purpose::Film);
        iris.sample([u, v]).map(f64::from)
    })
}

/// Rings of equal area and sectors.
const RINGS: usize = 12;
const SECTORS: usize = 16;

fn polar(iris: &Iris, radius: f64) -> Vec<u32> {
    let mut counts = vec![0; RINGS * SECTORS];
    for [x, y] in draws(iris) {
        let t = (x * x + y * y) / (radius * radius);
        assert!(t <= 1.0 + 1e-6, "outside of the lens");
        let turn = ops::atan2_d(y, x) / std::f64::consts::TAU + 0.5;
        let ring = ((t * RINGS as f64) as usize).min(RINGS - 1);
        counts[ring * SECTORS + ((turn * SECTORS as f64) as usize).min(SECTORS - 1)] += 1;
    }
    counts
}

#[test]
fn lenses_are_filled_as_told() {
    agrees(&polar(&Iris::round(0.2), 0.2), &[1.0; RINGS * SECTORS], 4);
    // A bell over the squared radius t, in radii, is exp(-t / 2 s²); the last is as good as even.
    for sigma in [0.3, 0.8, 10.0] {
        let below = |t: f64| 1.0 - ops::exp_d(-t / (2.0 * sigma * sigma));
        let ring = |i: usize| below((i + 1) as f64 / RINGS as f64) - below(i as f64 / RINGS as f64);
        let shares: Vec<f64> = (0..RINGS * SECTORS).map(|k| ring(k / SECTORS)).collect();
        agrees(&polar(&Iris::gaussian(0.2, sigma), 0.2), &shares, 4);
    }
}

#[test]
fn polygons_are_filled_evenly() {
    const CELLS: usize = 14;
    const FINE: usize = 40;
    for (blades, degrees) in [(3, 0.0), (5, 17.0), (6, 30.0), (9, 0.0)] {
        let corners: Vec<[f64; 2]> = (0..blades)
            .map(|i| ops::sin_cos_degrees(degrees + 360.0 * f64::from(i) / f64::from(blades)))
            .map(|(s, c)| [c, s])
            .collect();
        let inside = |p: [f64; 2]| {
            (0..corners.len()).all(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
                (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > -1e-6
            })
        };
        let mut counts = vec![0; CELLS * CELLS];
        for [x, y] in draws(&Iris::polygon(1.0, blades, degrees)) {
            assert!(inside([x, y]), "{blades}: {x} {y}");
            let cell = |v: f64| ((0.5 * (v + 1.0) * CELLS as f64) as usize).min(CELLS - 1);
            counts[cell(y) * CELLS + cell(x)] += 1;
        }
        // Areas of cells within the polygon, counted on a fine grid; cells that its edge cuts are left out, where the
        // grid is too coarse.
        let mut shares = vec![0.0; CELLS * CELLS];
        let fine =
            |cell: usize, k: usize| 2.0 * (cell as f64 + (k as f64 + 0.5) / FINE as f64) / CELLS as f64 - 1.0;
        for (i, share) in shares.iter_mut().enumerate() {
            let grid = (0..FINE * FINE).map(|k| [fine(i % CELLS, k % FINE), fine(i / CELLS, k / FINE)]);
            let part = grid.filter(|p| inside(*p)).count();
            *share = part as f64 / (FINE * FINE) as f64;
        }
        let whole: Vec<usize> = (0..shares.len()).filter(|&i| shares[i] == 1.0).collect();
        assert!(whole.len() > 20);
        agrees(&whole.iter().map(|&i| counts[i]).collect::<Vec<_>>(), &vec![1.0; whole.len()], 4);
        // And the share of all that they have is theirs by area.
        let area = 0.5 * f64::from(blades) * ops::sin_cos_degrees(360.0 / f64::from(blades)).0;
        let want = whole.len() as f64 * 4.0 / (CELLS * CELLS) as f64 / area;
        let found = whole.iter().map(|&i| f64::from(counts[i])).sum::<f64>() / 200_000.0;
        let error = (want * (1.0 - want) / 200_000.0).sqrt();
        assert!((found - want).abs() < 4.5 * error, "{blades}: {found} {want}");
    }
}

/// Neighbours in the square are neighbours on the lens, everywhere: strata are not torn apart.
#[test]
fn no_map_tears_the_square() {
    const N: usize = 256;
    for iris in [
        Iris::round(1.0),
        Iris::gaussian(1.0, 0.5),
        Iris::polygon(1.0, 3, 0.0),
        Iris::polygon(1.0, 6, 20.0),
        Iris::polygon(1.0, 64, 0.0),
    ] {
        let at = |i: usize, j: usize| iris.sample([i as f32 / N as f32, j as f32 / N as f32]);
        for i in 0..N {
            for j in 0..N {
                let [x, y] = at(i, j);
                for [p, q] in [at(i + 1, j), at(i, j + 1)] {
                    let step = ops::hypot(p - x, q - y) * N as f32;
                    // The square's side is 1, the opening's width 2; a bell is stretched at its rim. A tear would be
                    // hundreds of steps wide.
                    assert!(step < 8.0, "{iris:?} at {i} {j}: {step}");
                }
            }
        }
    }
}
