//! Every texture of the list against the contract.

use super::*;
use crate::testing::in_rgb;
use straal_math::lowdisc::{Pattern as Points, Purpose, SampleName};

fn numbers(i: u32) -> [f32; 4] {
    Points::Sobol.d4(&SampleName::new(3, [0, 0], i), Purpose::Custom)
}

fn at(uv: [f32; 2], duvdx: [f32; 2], duvdy: [f32; 2]) -> ShadingPoint {
    let flat = |[x, y]: [f32; 2]| Vec3::new(x, y, 0.0);
    let place = Place { p: flat(uv), dpdx: flat(duvdx), dpdy: flat(duvdy) };
    ShadingPoint { duvdx, duvdy, world: place, object: place, ..ShadingPoint::of(uv, place.p) }
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

/// Texture coordinates are mixed by the place in space, which is what a rasteriser gets by dividing by the depth, and not by the place on
/// the screen, which is what it gets without.
#[test]
fn texture_coordinates_are_right_in_perspective() {
    use crate::shape::TriangleMesh;
    let corners = [Vec3::new(-1.0, -1.0, -2.0), Vec3::new(1.0, -1.0, -2.0), Vec3::new(0.0, -1.0, -20.0)];
    let uvs = [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]];
    let floor = TriangleMesh {
        positions: corners.into(),
        indices: [[0, 1, 2]].into(),
        uvs: uvs.to_vec(),
        ..TriangleMesh::default()
    };
    let screen = corners.map(|p| [p.x / -p.z, p.y / -p.z]);
    let mut most = 0.0_f32;
    for i in 0..100 {
        let [a, b, ..] = numbers(i);
        let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
        // A place on the screen, by weights there, and the ray through it.
        let weights = [1.0 - a - b, a, b];
        let mixed = |v: [f32; 3]| (0..3).map(|k| weights[k] * v[k]).sum::<f32>();
        let [x, y] = [0, 1].map(|k| mixed(screen.map(|p| p[k])));
        // It meets the floor, y = -1, where its depth is -1 / y; there the weights are those of the point.
        let depth = -1.0 / y;
        let v = (depth - 2.0) / 18.0;
        let u = 0.5 * (x * depth + 1.0 - v);
        let got = floor.surface(0, u, v).uv;
        let over_depth = |k: usize| mixed([0, 1, 2].map(|i| uvs[i][k] / -corners[i].z));
        let right = [0, 1].map(|k| over_depth(k) / mixed(corners.map(|p| 1.0 / -p.z)));
        let naive = [0, 1].map(|k| mixed([0, 1, 2].map(|i| uvs[i][k])));
        for k in 0..2 {
            assert!((got[k] - right[k]).abs() < 1e-4, "{got:?}, not {right:?}");
            most = if (got[k] - naive[k]).abs() > most { (got[k] - naive[k]).abs() } else { most };
        }
    }
    assert!(most > 0.4, "the naive kind is no worse: {most}");
}
