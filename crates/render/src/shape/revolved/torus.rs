//! The torus.

use straal_math::{DVec3, ops};

use super::roots::{Roots, between};
use super::{Across, Along, Profile, TAU, within};

/// A tube about the unit circle in the plane y = 0. v is the part of the turn about the tube, which starts at the outer rim and turns
/// towards +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    tube: f64,
    from: f64,
    sweep: f64,
    is_whole: bool,
}

impl Torus {
    /// By the radius of its tube, from above 0 to below 1, and which part of a turn about it there is, in degrees.
    pub fn new(tube: f64, [from, to]: [f64; 2]) -> Self {
        let is_whole = to - from >= 360.0;
        let sweep = if is_whole { TAU } else { (to - from).to_radians() };
        let from = (from % 360.0).to_radians();
        Self { tube, from, sweep, is_whole }
    }

    /// The part of the turn about the tube, and whether it is there.
    fn part(&self, [rho, y]: Across) -> (f64, bool) {
        let mut angle = (ops::atan2_d(y, rho - 1.0) - self.from) % TAU;
        if angle < 0.0 {
            angle += TAU;
        }
        within(angle, self.sweep)
    }

    fn on(&self, angle: f64) -> Across {
        let (s, c) = ops::sin_cos_d(self.from + angle);
        [1.0 + self.tube * c, self.tube * s]
    }
}

impl Profile for Torus {
    fn middle(&self) -> f64 {
        0.0
    }

    /// Of (|p|² + 1 - a²)² = 4 rho², a quartic in s. What crosses is found by [`between`], however grazing, and sharpened on
    /// (rho - 1)² + y² = a², which doesn't cancel where the tube is thin.
    fn crossings(&self, o: DVec3, d: DVec3, out: &mut Roots) {
        let a = self.tube;
        // The part of the line in the ball about all of it, and between the planes that it touches; a little more.
        let reach = (1.0 + a) * (1.0 + 1e-9);
        let rest = reach * reach - o.dot(o);
        if rest <= 0.0 || rest.is_nan() {
            return;
        }
        // The origin is where the line comes closest, up to rounding.
        let (mut low, mut high) = (-rest.sqrt() * (1.0 + 1e-9), rest.sqrt() * (1.0 + 1e-9));
        let level = a * (1.0 + 1e-9);
        let (p, q) = ((-level - o.y) / d.y, (level - o.y) / d.y);
        let (p, q) = if p < q { (p, q) } else { (q, p) };
        if p.is_finite() && q.is_finite() {
            low = if p > low { p } else { low };
            high = if q < high { q } else { high };
        } else if o.y.abs() > level {
            return;
        }
        let b = o.dot(d);
        let m = o.dot(o) + 1.0 - a * a;
        let [r0, r1, r2] = [o.x * o.x + o.z * o.z, o.x * d.x + o.z * d.z, d.x * d.x + d.z * d.z];
        let root = r0.sqrt();
        let quartic = [
            (m - 2.0 * root) * (m + 2.0 * root),
            4.0 * b * m - 8.0 * r1,
            4.0 * b * b + 2.0 * m - 4.0 * r2,
            4.0 * b,
            1.0,
        ];
        let mut found = Roots::default();
        between(&quartic, low, high, &mut found);
        for mut s in found.iter() {
            for _ in 0..2 {
                let (rho, y) = ((r0 + s * (2.0 * r1 + s * r2)).abs().sqrt(), o.y + s * d.y);
                let f = (rho - 1.0) * (rho - 1.0) + y * y - a * a;
                let slope = 2.0 * ((rho - 1.0) * (r1 + s * r2) / rho + y * d.y);
                let step = f / slope;
                // Where the line all but touches, the quartic's own root stays.
                if step.abs() < 1e-4 * a {
                    s -= step;
                }
            }
            let at = o + d * s;
            if self.is_whole || self.part([(at.x * at.x + at.z * at.z).sqrt(), at.y]).1 {
                out.add(s);
            }
        }
    }

    fn nearest(&self, [rho, y]: Across) -> Across {
        let (x, length) = (rho - 1.0, ((rho - 1.0) * (rho - 1.0) + y * y).sqrt());
        if length == 0.0 || length.is_nan() {
            return self.on(0.0);
        }
        if !self.is_whole
            && let (end, false) = self.part([rho, y])
        {
            return self.on(end);
        }
        [1.0 + self.tube * x / length, self.tube * y / length]
    }

    fn normal(&self, [rho, y]: Across) -> Across {
        [rho - 1.0, y]
    }

    fn v(&self, p: Across) -> f64 {
        self.part(p).0 / self.sweep
    }

    fn along(&self, [rho, y]: Across) -> Along {
        let d = [-y * self.sweep, (rho - 1.0) * self.sweep];
        Along { d, around: 0.0, dn: d }
    }

    fn at(&self, w: f64) -> (Across, f64) {
        let p = self.on(w * self.sweep);
        (p, self.weight(p))
    }

    fn weight(&self, [rho, _]: Across) -> f64 {
        self.tube * self.sweep * rho
    }

    fn support(&self, a: f64, b: f64) -> f64 {
        let best = self.tube * (a * a + b * b).sqrt();
        if self.is_whole || self.part([1.0 + a, b]).1 {
            return a + best;
        }
        super::zone::ops_max([0.0, self.sweep].map(|angle| {
            let [rho, y] = self.on(angle);
            a * rho + b * y
        }))
    }
}
