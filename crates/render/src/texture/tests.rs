//! Every texture of the list against the contract.

use super::*;
use crate::testing::in_rgb;
use straal_math::lowdisc::{Pattern as Points, Purpose, SampleName};

fn numbers(i: u32) -> [f32; 4] {
    Points::Sobol.d4(&SampleName::new(3, [0, 0], i), Purpose::Custom)
}

fn at(uv: [f32; 2], duvdx: [f32; 2], duvdy: [f32; 2]) -> ShadingPoint {
    ShadingPoint { duvdx, duvdy, ..ShadingPoint::of(uv, Vec3::new(uv[0], uv[1], 0.0)) }
}

#[test]
fn every_kind_is_registered() {
    for (name, examples) in registry() {
        assert!(!examples.is_empty(), "{name} has no example");
        for texture in examples {
            // Rust's own name of the variant.
            assert!(format!("{texture:?}").starts_with(name), "{texture:?} is no {name}");
        }
    }
}

/// What it says is its most is, numbers are numbers, and the same point gives the same.
#[test]
fn values_are_within_what_is_said() {
    for texture in registry().into_iter().flat_map(|(_, all)| all) {
        for i in 0..2000 {
            let [u, v, du, dv] = numbers(i);
            let point = at([8.0 * u - 4.0, 8.0 * v - 4.0], [du * du, 0.1 * dv], [0.0, dv * dv]);
            let light = texture.light(&point, &in_rgb(), Use::Reflectance);
            assert!(
                light.is_finite() && light.max_lane() <= texture.most() * 1.000_01,
                "{texture:?} {light:?}"
            );
            assert!(light.0.iter().all(|v| *v >= 0.0), "{texture:?} {light:?}");
            assert!(texture.number(&point, &in_rgb()).is_finite());
            assert_eq!(texture.light(&point, &in_rgb(), Use::Reflectance), light);
        }
    }
}

/// Over a footprint along the axes it has the mean of what it has at the points there.
#[test]
fn a_footprint_sees_the_mean() {
    const N: u32 = 4096;
    for texture in registry().into_iter().flat_map(|(_, all)| all) {
        for (width, height) in [(0.05, 0.02), (0.3, 0.7), (5.0, 3.0)] {
            for i in 0..20 {
                let [u, v, ..] = numbers(i);
                let uv = [4.0 * u - 2.0, 4.0 * v - 2.0];
                let told = texture.light(&at(uv, [width, 0.0], [0.0, height]), &in_rgb(), Use::Reflectance);
                let mut sum = [0.0_f64; 3];
                for k in 0..N {
                    let [x, y, ..] = numbers(1000 + k);
                    let point =
                        at([uv[0] + (x - 0.5) * width, uv[1] + (y - 0.5) * height], [0.0; 2], [0.0; 2]);
                    let light = texture.light(&point, &in_rgb(), Use::Reflectance);
                    (0..3).for_each(|c| sum[c] += f64::from(light[c]));
                }
                for c in 0..3 {
                    let mean = sum[c] / f64::from(N);
                    assert!(
                        (mean - f64::from(told[c])).abs() < 0.02 * f64::from(texture.most()),
                        "{texture:?} over {width} x {height} at {uv:?}: {told:?}, in the mean {mean}"
                    );
                }
            }
        }
    }
}
