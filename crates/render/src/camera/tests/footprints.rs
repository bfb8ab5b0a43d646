//! What cameras say of their rays' change from pixel to pixel, against rays of other places on the film.

use super::*;

/// Half of what the film is moved by, in pixels: rays are single precision, and their changes a thousandth of them.
const STEP: f32 = 0.25;

#[test]
fn every_camera_knows_how_its_rays_change() {
    for (name, camera) in every_kind(&slanted()) {
        let mut tried = 0;
        for i in 0..4000_u32 {
            let unit = |k: u32| (f64::from(i.wrapping_mul(k)) / f64::from(u32::MAX)) as f32 * 0.999;
            let pixel = [i % SIZE[0], i / SIZE[0] % SIZE[1] * 5 % SIZE[1]];
            let position = pixel.map(|n| n as f32 + 0.5);
            let lens = [unit(0xc2b2_ae35), unit(0x27d4_eb2f)];
            let at = FilmPoint { pixel, position, lens, time: unit(0x1656_67b1) };
            let told = camera.footprint(&at);
            let Some(here) = camera.ray(&at) else {
                assert_eq!(told, Footprint::NONE, "{name}");
                continue;
            };
            for axis in 0..2 {
                let moved = |by: f32| {
                    let mut position = at.position;
                    position[axis] += by;
                    camera.ray(&FilmPoint { position, ..at })
                };
                let (Some(after), Some(before)) = (moved(STEP), moved(-STEP)) else { continue };
                // Not at the edge of a fisheye that sees all around, where a step from there differs from one to there.
                let (there, back) = (after.d - here.d, here.d - before.d);
                if (there - back).length() > 0.1 * there.length() + 2e-6 {
                    continue;
                }
                tried += 1;
                let (o, d) = (told.o[axis], told.d[axis]);
                let change = |a: Vec3, b: Vec3| (a - b) * (0.5 / STEP);
                let off_o = (change(after.o, before.o) - o).length();
                let off_d = (change(after.d, before.d) - d).length();
                // Two per cent for the change of the change, and what rounding leaves.
                assert!(off_o <= 0.02 * o.length() + 4e-6, "{name}, {at:?}: {o:?} is off by {off_o}");
                assert!(off_d <= 0.02 * d.length() + 2e-6, "{name}, {at:?}: {d:?} is off by {off_d}");
            }
        }
        assert!(tried > 2000, "{name}: {tried}");
    }
}
