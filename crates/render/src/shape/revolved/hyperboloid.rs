//! A straight line turned about the axis: the hyperboloid of one sheet.

use straal_math::{DVec3, ops};

use crate::shape::exact::clamped;

use super::roots::{Roots, quadratic};
use super::zone::ops_max;
use super::{Across, Along, Profile};

/// The line from one point to another at another height. v is the part of the way; u is told from where the line is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hyperboloid {
    /// Where it begins; its length is at most 1.
    from: DVec3,
    /// To where it ends.
    way: DVec3,
}

impl Hyperboloid {
    /// The line between two points, none further from the origin than 1; `None` where both are at one height.
    pub fn new([from, to]: [DVec3; 2]) -> Option<Self> {
        (from.y != to.y).then_some(Self { from, way: to - from })
    }

    /// The radius squared, and half its change with v.
    fn squared(&self, v: f64) -> [f64; 2] {
        let p = self.line(v);
        [p.x * p.x + p.z * p.z, p.x * self.way.x + p.z * self.way.z]
    }

    fn line(&self, v: f64) -> DVec3 {
        self.from + self.way * v
    }

    /// The part of the way at a height.
    fn part(&self, y: f64) -> f64 {
        clamped((y - self.from.y) / self.way.y, 0.0, 1.0)
    }
}

impl Profile for Hyperboloid {
    fn middle(&self) -> f64 {
        self.from.y + 0.5 * self.way.y
    }

    fn crossings(&self, o: DVec3, d: DVec3, out: &mut Roots) {
        // v along the ray is v0 + s dv, and the line's radius there a square of v.
        let (v0, dv) = ((o.y - self.from.y) / self.way.y, d.y / self.way.y);
        let w2 = self.way.x * self.way.x + self.way.z * self.way.z;
        let [r2, half] = self.squared(v0);
        let a = d.x * d.x + d.z * d.z - w2 * dv * dv;
        let b = o.x * d.x + o.z * d.z - half * dv;
        for s in quadratic(a, b, o.x * o.x + o.z * o.z - r2) {
            if (0.0..=1.0).contains(&(v0 + s * dv)) {
                out.add(s);
            }
        }
    }

    fn nearest(&self, [mut rho, mut y]: Across) -> Across {
        for _ in 0..4 {
            let v = (y - self.from.y) / self.way.y;
            let [r2, half] = self.squared(v);
            let g = [2.0 * rho, -2.0 * half / self.way.y];
            let part = (rho * rho - r2) / (g[0] * g[0] + g[1] * g[1]);
            if part.is_finite() {
                (rho, y) = (rho - g[0] * part, y - g[1] * part);
            }
        }
        let v = self.part(y);
        [self.squared(v)[0].sqrt(), self.from.y + v * self.way.y]
    }

    fn normal(&self, [rho, y]: Across) -> Across {
        [rho, -self.squared(self.part(y))[1] / self.way.y]
    }

    fn v(&self, [_, y]: Across) -> f64 {
        self.part(y)
    }

    fn along(&self, [rho, y]: Across) -> Along {
        let p = self.line(self.part(y));
        let rho = if rho > 1e-9 { rho } else { 1e-9 };
        let dr = (p.x * self.way.x + p.z * self.way.z) / rho;
        // Towards +x at +z.
        let around = (p.z * self.way.x - p.x * self.way.z) / rho;
        let w2 = self.way.x * self.way.x + self.way.z * self.way.z;
        Along { d: [dr, self.way.y], around, dn: [dr, -w2 / self.way.y] }
    }

    fn at(&self, w: f64) -> (Across, f64) {
        let p = [self.squared(w)[0].sqrt(), self.from.y + w * self.way.y];
        (p, self.weight(p))
    }

    fn weight(&self, [_, y]: Across) -> f64 {
        let [r2, half] = self.squared(self.part(y));
        (half * half + r2 * self.way.y * self.way.y).sqrt()
    }

    /// The radius is a convex function of the height.
    fn support(&self, a: f64, b: f64) -> f64 {
        let end = |v: f64| a * self.squared(v)[0].sqrt() + b * (self.from.y + v * self.way.y);
        ops_max([end(0.0), end(1.0)])
    }

    fn turned(&self, q: DVec3) -> f64 {
        let p = self.line(self.part(q.y));
        ops::atan2_d(q.x * p.z - q.z * p.x, q.x * p.x + q.z * p.z)
    }

    fn out(&self, [_, y]: Across, angle: f64) -> DVec3 {
        let p = self.line(self.part(y));
        let (s, c) = ops::sin_cos_d(angle + ops::atan2_d(p.x, p.z));
        DVec3::new(s, 0.0, c)
    }

    /// Each turn of the line is straight: its ends are what is furthest.
    fn twisted_support(&self, v: DVec3, sweep: f64) -> Option<f64> {
        let end = |part: f64| {
            let p = self.line(part);
            let rho = self.squared(part)[0].sqrt();
            rho * super::swept(v, ops::atan2_d(p.x, p.z), sweep) + v.y * p.y
        };
        Some(ops_max([end(0.0), end(1.0)]))
    }
}
