//! The wall of a cone, whole or cut off; or of a cylinder.

use straal_math::DVec3;

use crate::shape::exact::clamped;

use super::roots::{Roots, quadratic};
use super::zone::ops_max;
use super::{Across, Along, Profile};

/// From one radius at height 0 to another at height 1; one of them may be 0. v is the height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// At height 0.
    base: f64,
    /// What is added on the way to height 1.
    slope: f64,
}

impl Frustum {
    /// By its radii at heights 0 and 1.
    pub fn new([base, top]: [f64; 2]) -> Self {
        Self { base, slope: top - base }
    }

    fn top(&self) -> f64 {
        self.base + self.slope
    }
}

impl Profile for Frustum {
    fn middle(&self) -> f64 {
        0.5
    }

    fn crossings(&self, o: DVec3, d: DVec3, out: &mut Roots) {
        let k = self.slope;
        let radius = self.base + k * o.y;
        let rho = (o.x * o.x + o.z * o.z).sqrt();
        let a = d.x * d.x + d.z * d.z - k * k * d.y * d.y;
        let b = o.x * d.x + o.z * d.z - k * d.y * radius;
        for s in quadratic(a, b, (rho - radius) * (rho + radius)) {
            let y = o.y + s * d.y;
            if (0.0..=1.0).contains(&y) {
                out.add(s);
            }
        }
    }

    fn nearest(&self, [rho, y]: Across) -> Across {
        let k = self.slope;
        let t = ((rho - self.base) * k + y) / (k * k + 1.0);
        let t = clamped(t, 0.0, 1.0);
        [self.base + k * t, t]
    }

    fn normal(&self, _: Across) -> Across {
        [1.0, -self.slope]
    }

    fn v(&self, p: Across) -> f64 {
        p[1]
    }

    fn along(&self, _: Across) -> Along {
        Along { d: [self.slope, 1.0], around: 0.0, dn: [0.0; 2] }
    }

    /// Even in the radius squared, and so in area.
    fn at(&self, w: f64) -> (Across, f64) {
        let (a, b) = (self.base, self.top());
        let rho = (a * a + w * (b * b - a * a)).abs().sqrt();
        // (rho - a) / slope, without its difference.
        let sum = rho + a;
        let y = if sum > 0.0 { w * (a + b) / sum } else { 0.0 };
        ([rho, if y > 1.0 { 1.0 } else { y }], self.weight([rho, y]))
    }

    fn weight(&self, _: Across) -> f64 {
        0.5 * (self.base + self.top()) * (1.0 + self.slope * self.slope).sqrt()
    }

    fn support(&self, a: f64, b: f64) -> f64 {
        ops_max([a * self.base, a * self.top() + b])
    }
}
