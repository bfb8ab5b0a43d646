//! Every emitter of the registry by the chi-square test.

use super::{Receiver, VIEWS, registry};
use crate::testing::in_rgb;
use crate::testing::{ChiSquare, SphereGrid, sidak};
use straal_math::Vec3;

#[test]
fn directions_have_the_density_that_is_told() {
    let registry = registry();
    let tests = registry.len() * (VIEWS.len() + 1);
    for entry in registry {
        let mut lit = 0;
        // Surroundings look the same from everywhere, but not to every surface.
        let tilted = Vec3::new(0.48, -0.6, 0.64);
        let around = [Vec3::ZERO, tilted].map(|n| Receiver { p: VIEWS[0], n });
        let views = if entry.emitter.is_environment() {
            around.to_vec()
        } else {
            // As everything sees it, and as a surface does on which some of it falls steeply.
            let steep = Receiver { p: VIEWS[0], n: (tilted - VIEWS[0]).normalize() };
            VIEWS.map(Receiver::anywhere).into_iter().chain([steep]).collect()
        };
        for (i, at) in views.iter().enumerate() {
            let p = at.p;
            if i == 1 && lit > 0 && !entry.emitter.is_environment() {
                continue; // for those that only shine downwards
            }
            let sample = |u: [f32; 4]| entry.emitter.sample(&entry.geometry, at, [u[0], u[1]], &in_rgb());
            // Many cells, because the rims of lights cross them, and finer rings where the light is.
            let fine = SphereGrid { rings: 48, sectors: 48, ..SphereGrid::default() };
            let grid = if entry.emitter.is_environment() || p.length() < 1.0 {
                fine
            } else {
                SphereGrid { axis: (-p).normalize(), focus: 4, ..fine }
            };
            // Few enough draws for the quadrature's error at the rims to stay unseen.
            let test = ChiSquare { grid, seed: 100 + i as u64, tests, samples: 10_000 };
            let outcome = test.run(|u| sample(u).map(|s| s.wi), |w| entry.pdf(at, w));
            if outcome.drawn == 0.0 {
                assert!(outcome.integral < 1e-6, "{} from {at:?}: {outcome}", entry.name);
                continue;
            }
            lit += 1;
            // A direction is rounded to 1e-7, which at a round rim misses within a cosine of 1e-3: more often than the
            // verdict of the test allows.
            let fine =
                outcome.p >= sidak(0.01, tests) && outcome.impossible <= 10 && outcome.integral < 1.001;
            assert!(fine, "{} from {at:?}: {outcome}", entry.name);
        }
        assert!(lit > 0, "{} is never lit", entry.name);
    }
}
