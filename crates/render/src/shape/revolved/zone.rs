//! Part of the sphere.

use straal_math::{DVec3, ops};

use crate::shape::exact::clamped;

use super::roots::{Roots, quadratic};
use super::{Across, Along, Profile};

/// The unit sphere between two heights. v rises from 0 at the lower one, by the angle at the center.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    low: f64,
    high: f64,
    /// The angles of the heights, from the pole below.
    angles: [f64; 2],
}

/// The angle from the pole below at a height.
fn angle(y: f64) -> f64 {
    ops::acos_d(-clamped(y, -1.0, 1.0))
}

impl Zone {
    /// Between two heights; what lies beyond -1 and 1 doesn't count.
    pub fn new([low, high]: [f64; 2]) -> Self {
        let (low, high) = (if low > -1.0 { low } else { -1.0 }, if high < 1.0 { high } else { 1.0 });
        Self { low, high, angles: [angle(low), angle(high)] }
    }

    fn within(&self, y: f64) -> f64 {
        clamped(y, self.low, self.high)
    }

    fn on(y: f64) -> Across {
        [(1.0 - y * y).abs().sqrt(), y]
    }
}

impl Profile for Zone {
    fn middle(&self) -> f64 {
        0.0
    }

    fn crossings(&self, o: DVec3, d: DVec3, out: &mut Roots) {
        for s in quadratic(1.0, o.dot(d), o.dot(o) - 1.0) {
            let y = o.y + s * d.y;
            if y >= self.low && y <= self.high || self.low == -1.0 && y < -1.0 || self.high == 1.0 && y > 1.0
            {
                out.add(s);
            }
        }
    }

    fn nearest(&self, [rho, y]: Across) -> Across {
        let length = (rho * rho + y * y).sqrt();
        let y_on = self.within(y / length);
        if y_on == y / length { [rho / length, y_on] } else { Self::on(y_on) }
    }

    fn normal(&self, p: Across) -> Across {
        p
    }

    fn v(&self, p: Across) -> f64 {
        let [from, to] = self.angles;
        (angle(p[1]) - from) / (to - from)
    }

    fn along(&self, [rho, y]: Across) -> Along {
        let sweep = self.angles[1] - self.angles[0];
        let d = [-y * sweep, rho * sweep];
        Along { d, around: 0.0, dn: d }
    }

    /// Even in height, and so in area (Archimedes).
    fn at(&self, w: f64) -> (Across, f64) {
        (Self::on(self.within(self.low + w * (self.high - self.low))), self.high - self.low)
    }

    fn weight(&self, _: Across) -> f64 {
        self.high - self.low
    }

    fn support(&self, a: f64, b: f64) -> f64 {
        let ends = [self.low, self.high].map(|y| a * Self::on(y)[0] + b * y);
        let length = (a * a + b * b).sqrt();
        let top = b / length;
        if a >= 0.0 && top > self.low && top < self.high { length } else { ops_max(ends) }
    }
}

/// The greater of two.
pub(super) fn ops_max([a, b]: [f64; 2]) -> f64 {
    if a > b { a } else { b }
}
