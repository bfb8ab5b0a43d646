//! Rays that leave emitters, against what sampling finds of the same light.

use super::*;
use crate::light::Ball;

/// What falls on a disc, from both of its sides: by rays that leave the light, and by directions to it from points of the disc.
#[test]
fn rays_bring_what_sampling_finds() {
    let ball = Ball { center: Vec3::new(0.1, -0.1, 0.2), radius: 4.0 };
    let all = super::super::registry().into_iter().flat_map(|(_, all)| all);
    let mut told = 0;
    for e in all.filter(sends_rays) {
        // From outside, only the near side of a ball is looked for; nothing here keeps off what its inner side sends.
        // Rays spread, so that they can't bring the same from afar; and through portals alone sampling finds less than there is.
        let is_other = ["sphere, inside", "ellipsoid", "point, the same from afar"].contains(&e.name);
        if is_other || e.name.starts_with("portal") {
            continue;
        }
        let disc = Disc::new(Vec3::new(0.4, 1.9, 0.3), Vec3::new(1.6, 0.0, 0.2), Vec3::new(0.1, 0.3, 1.5));
        let area = Geometry { shapes: vec![Shape::Disc(Box::new(disc))], ..Geometry::default() };
        let mut rng = Rng(5);
        let by_rays = monte_carlo(7, 20_000, |u| {
            let [v, w] = rng.square();
            let Some(emitted) = e.emitter.emit(&e.geometry, &ball, [u[0], u[1], v, w], &in_rgb()) else {
                return 0.0;
            };
            assert!((emitted.d.length() - 1.0).abs() < 1e-5 && emitted.power().is_finite(), "{}", e.name);
            let ray = Ray::new(emitted.from.p, emitted.d);
            if area.intersect(0, &ray).is_some() { f64::from(emitted.power()[1]) } else { 0.0 }
        });
        let by_directions = monte_carlo(8, 20_000, |u| {
            let Some(s) = area.sample_area(0, rng.square()) else { return 0.0 };
            let at = Receiver::anywhere(s.point.p);
            let Some(light) = e.emitter.sample(&e.geometry, &at, u, &in_rgb()) else { return 0.0 };
            let cos = light.wi.dot(s.point.ng).abs();
            f64::from(light.radiance[1] * cos / light.pdf / s.pdf_area)
        });
        let error = (by_rays.1 * by_rays.1 + by_directions.1 * by_directions.1).sqrt();
        assert!(
            (by_rays.0 - by_directions.0).abs() <= 4.5 * error + 1e-4 * by_rays.0,
            "{}: {by_rays:?} {by_directions:?}",
            e.name
        );
        // Some shine away from the disc.
        told += u32::from(by_rays.0 > 0.0 && error < 0.1 * by_rays.0);
    }
    assert!(told >= 8, "{told} say anything");
}

/// The power by which lights are chosen is that of their rays; of a spot, and of a picture that is drawn between its pixels, roughly.
#[test]
fn rays_carry_the_power_that_is_told() {
    let ball = Ball { center: Vec3::ZERO, radius: 1.5 };
    let all = super::super::registry().into_iter().flat_map(|(_, all)| all);
    for e in all.filter(sends_rays) {
        let mut rng = Rng(6);
        let (mean, error) = monte_carlo(9, 10_000, |u| {
            let [v, w] = rng.square();
            let emitted = e.emitter.emit(&e.geometry, &ball, [u[0], u[1], v, w], &in_rgb());
            emitted.map_or(0.0, |e| f64::from(e.power().max_lane()))
        });
        let told = e.emitter.power(&e.geometry, 1.5);
        // Of surroundings behind portals all is told, also what no portal lets in.
        let roughly = if e.emitter.is_delta() || e.name.starts_with("portal") { 0.15 } else { 0.03 };
        assert!((mean - told).abs() < 4.5 * error + roughly * told, "{}: {mean} ± {error}, {told}", e.name);
    }
}

fn sends_rays(e: &Example) -> bool {
    !e.emitter.is_ambient() && !matches!(&e.emitter, Emitter::Point(point) if !point.falls)
}
