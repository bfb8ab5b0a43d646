//! The registry of `math`'s warps to directions: each must meet its density. A new warp gets a line here.

use super::ChiSquare;
use straal_math::{Vec3, warp};

type Sample = fn([f32; 2]) -> Vec3;
type Pdf = fn(Vec3) -> f32;

const WARPS: [(&str, Sample, Pdf); 7] = [
    ("cosine hemisphere", warp::cosine_hemisphere, |d| warp::cosine_hemisphere_pdf(d.z)),
    ("uniform hemisphere", warp::uniform_hemisphere, |d| warp::uniform_hemisphere_pdf(d.z)),
    (
        "cosine to the 7th",
        |u| warp::cosine_power_hemisphere(u, 7.0),
        |d| warp::cosine_power_hemisphere_pdf(d.z, 7.0),
    ),
    (
        "cosine to the 1/2",
        |u| warp::cosine_power_hemisphere(u, 0.5),
        |d| warp::cosine_power_hemisphere_pdf(d.z, 0.5),
    ),
    ("uniform sphere", warp::uniform_sphere, |_| warp::uniform_sphere_pdf()),
    ("wide cone", |u| warp::uniform_cone(u, 0.8), |d| in_cone(d, 0.8)),
    ("narrow cone", |u| warp::uniform_cone(u, 0.004), |d| in_cone(d, 0.004)),
];

fn in_cone(d: Vec3, spread: f32) -> f32 {
    if 1.0 - d.z <= spread { warp::uniform_cone_pdf(spread) } else { 0.0 }
}

#[test]
fn every_warp_to_directions_meets_its_density() {
    let test = ChiSquare { tests: WARPS.len(), ..ChiSquare::default() };
    for (name, sample, pdf) in WARPS {
        let found = test.run(|u| Some(sample([u[0], u[1]])), pdf);
        found.verdict().unwrap_or_else(|e| panic!("{name}: {e}"));
    }
}
