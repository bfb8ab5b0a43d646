//! A flat ring.

use straal_math::DVec3;

use super::roots::Roots;
use super::{Across, Along, Profile};

/// In the plane y = 0, from an inner radius to 1; it faces +y. v runs from 0 at the outer rim to 1 at the inner one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    inner: f64,
}

impl Ring {
    /// By its inner radius, from 0 to below 1.
    pub fn new(inner: f64) -> Self {
        Self { inner }
    }
}

impl Profile for Ring {
    fn middle(&self) -> f64 {
        0.0
    }

    fn crossings(&self, o: DVec3, d: DVec3, out: &mut Roots) {
        let s = -o.y / d.y;
        let (x, z) = (o.x + s * d.x, o.z + s * d.z);
        let rr = x * x + z * z;
        if rr <= 1.0 && rr >= self.inner * self.inner {
            out.add(s);
        }
    }

    fn nearest(&self, [rho, _]: Across) -> Across {
        let rho = if rho < 1.0 { rho } else { 1.0 };
        [if rho > self.inner { rho } else { self.inner }, 0.0]
    }

    fn normal(&self, _: Across) -> Across {
        [0.0, 1.0]
    }

    fn v(&self, p: Across) -> f64 {
        (1.0 - p[0]) / (1.0 - self.inner)
    }

    fn along(&self, _: Across) -> Along {
        Along { d: [self.inner - 1.0, 0.0], around: 0.0, dn: [0.0; 2] }
    }

    /// Even in the radius squared, and so in area.
    fn at(&self, w: f64) -> (Across, f64) {
        let rho = (1.0 - w * (1.0 - self.inner * self.inner)).abs().sqrt();
        (self.nearest([rho, 0.0]), self.weight([rho, 0.0]))
    }

    fn weight(&self, _: Across) -> f64 {
        0.5 * (1.0 - self.inner * self.inner)
    }

    fn support(&self, a: f64, _: f64) -> f64 {
        if a > 0.0 { a } else { a * self.inner }
    }
}
