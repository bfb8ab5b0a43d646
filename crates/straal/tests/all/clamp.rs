//! Light that is limited, and what that takes away.

use std::path::Path;
use straal::{Control, Job, LoadOptions, Outcome, Overrides};

/// A small bright lamp that is seen by way of a gold ball, by chance alone, and by itself.
const SCENE: &str = "\
camera: { perspective: { eye: [0, 1.5, 5], look_at: [0, 0.8, 0], fov: 50 } }
film: { size: [24, 24] }
sampler: { spp: 16 }
world:
  - rectangle: { corner: [-6, 0, 6], edges: [[12, 0, 0], [0, 0, -12]] }
  - sphere: { center: [-0.8, 0.6, 0], radius: 0.6, material: { conductor: { metal: gold } } }
  - sphere: { center: [0, 2, 0], radius: 0.15, emission: 200, light_group: lamp }
lights:
  - environment: { radiance: 0.2 }
";

fn render(wish: Overrides) -> Outcome {
    let loaded = straal::load_str("test.yaml", SCENE, Path::new(""), &LoadOptions::default());
    let job = Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), wish).expect("a job");
    job.render(&mut Control::to_the_end()).expect("a picture")
}

fn clamped(most: f64) -> Overrides {
    Overrides { clamp: Some(most), ..Overrides::default() }
}

/// What is left and what was taken make the picture without a limit, pixel by pixel; the groups make what is left.
#[test]
fn what_is_taken_is_told() {
    let (free, limited) = (render(Overrides::default()), render(clamped(1.0)));
    assert_eq!(free.clamped, None);
    let share = limited.clamped.expect("a share");
    let [free, left] = [&free.picture.layers, &limited.picture.layers];
    let taken = &left.groups.last().expect("a layer").rgb;
    let mut sums = [0.0; 2];
    for (i, want) in free.rgb.iter().enumerate() {
        for (c, &want) in want.iter().enumerate() {
            let all = f64::from(left.rgb[i][c]) + f64::from(taken[i][c]);
            assert!((all - f64::from(want)).abs() < 2e-6 * all, "pixel {i}: {all}, not {want}");
            let groups: f64 = left.groups[..2].iter().map(|g| f64::from(g.rgb[i][c])).sum();
            assert!((groups - f64::from(left.rgb[i][c])).abs() < 2e-6 * groups, "pixel {i}: {groups}");
            sums[0] += all;
            sums[1] += f64::from(taken[i][c]);
        }
    }
    assert!((share - sums[1] / sums[0]).abs() < 1e-6 && share > 0.005, "{share}");
    // A lamp that is seen keeps its light, whatever the limit.
    let most = left.rgb.as_flattened().iter().fold(0.0_f32, |m, v| if *v > m { *v } else { m });
    assert!(most > 100.0, "{most}");
}

/// A limit that nothing reaches changes no bit, and neither do threads where one is reached.
#[test]
fn bits_stay() {
    let picture = |wish: Overrides| {
        let outcome = render(wish);
        (outcome.picture.layers.rgb, outcome.clamped)
    };
    let (free, _) = picture(Overrides::default());
    assert_eq!(picture(clamped(1e9)), (free, Some(0.0)));
    let plain = picture(clamped(1.0));
    assert_eq!(picture(Overrides { threads: Some(3), batch: Some(7), ..clamped(1.0) }), plain);
    // Colours alone are kept, and the share is told all the same.
    assert_eq!(picture(Overrides { layers: Some(false), ..clamped(1.0) }), plain);
}

/// An integrator without a limit says so.
#[test]
fn of_path_alone() {
    let loaded = straal::load_str("test.yaml", SCENE, Path::new(""), &LoadOptions::default());
    let integrator = straal_scene::desc::Integrator::bare("whitted");
    let refused =
        Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), Overrides { integrator, ..clamped(1.0) });
    assert!(refused.err().is_some_and(|e| e.to_string().contains("`whitted` has no `clamp`")));
}
