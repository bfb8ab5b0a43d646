//! A parabola turned about its axis.

use straal_math::DVec3;

use crate::shape::exact::clamped;

use super::roots::{Roots, quadratic};
use super::zone::ops_max;
use super::{Across, Along, Profile};

/// rho² = y, from some height to 1. v is the part of the way up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paraboloid {
    begin: f64,
}

impl Paraboloid {
    /// By the height at which it begins, from 0 to below 1.
    pub fn new(begin: f64) -> Self {
        Self { begin }
    }

    fn clamped(&self, y: f64) -> f64 {
        clamped(y, self.begin, 1.0)
    }
}

impl Profile for Paraboloid {
    fn middle(&self) -> f64 {
        0.5
    }

    fn crossings(&self, o: DVec3, d: DVec3, out: &mut Roots) {
        let a = d.x * d.x + d.z * d.z;
        let b = o.x * d.x + o.z * d.z - 0.5 * d.y;
        for s in quadratic(a, b, o.x * o.x + o.z * o.z - o.y) {
            let y = o.y + s * d.y;
            // At the apex rounding may leave a height just below 0.
            if y >= self.begin && y <= 1.0 || self.begin == 0.0 && y < 0.0 {
                out.add(s);
            }
        }
    }

    fn nearest(&self, [mut rho, mut y]: Across) -> Across {
        // Newton's steps along the gradient: each squares the distance.
        for _ in 0..3 {
            let part = (rho * rho - y) / (4.0 * rho * rho + 1.0);
            (rho, y) = (rho - 2.0 * rho * part, y + part);
        }
        // Where it is flat the radius tells the height, and where it is steep the other way round.
        if rho < 0.5 {
            y = rho * rho;
        }
        let on = self.clamped(y);
        if rho < 0.5 && on == y { [rho, y] } else { [on.sqrt(), on] }
    }

    fn normal(&self, [rho, _]: Across) -> Across {
        [2.0 * rho, -1.0]
    }

    fn v(&self, [_, y]: Across) -> f64 {
        (y - self.begin) / (1.0 - self.begin)
    }

    fn along(&self, [rho, _]: Across) -> Along {
        let height = 1.0 - self.begin;
        // At the apex the radius grows infinitely fast with the height.
        let dr = 0.5 * height / if rho > 1e-6 { rho } else { 1e-6 };
        // From the slope, so that it stays in the surface there as well.
        Along { d: [dr, 2.0 * rho * dr], around: 0.0, dn: [2.0 * dr, 0.0] }
    }

    fn at(&self, w: f64) -> (Across, f64) {
        let y = self.clamped(self.begin + w * (1.0 - self.begin));
        let p = [y.sqrt(), y];
        (p, self.weight(p))
    }

    fn weight(&self, [_, y]: Across) -> f64 {
        (1.0 - self.begin) * (y + 0.25).sqrt()
    }

    fn support(&self, a: f64, b: f64) -> f64 {
        let at = |y: f64| a * y.sqrt() + b * y;
        let ends = ops_max([at(self.begin), at(1.0)]);
        if a > 0.0 && b < 0.0 {
            let half = -0.5 * a / b;
            ops_max([ends, at(self.clamped(half * half))])
        } else {
            ends
        }
    }
}
