//! What lies around two balls and between them.

use straal_math::{DVec3, ops};

use crate::shape::exact::clamped;

use super::roots::{Roots, quadratic};
use super::zone::ops_max;
use super::{Across, Along, Profile};

/// The surface around a ball at the origin, one at height 1, and all between that shrink or grow evenly on the way. v is the part of
/// the way along it from the pole below to the one above, by length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    radius: [f64; 2],
    /// The sine and cosine of how far the wall leans: balls touch it at heights of `lean` times their radii.
    lean: f64,
    upright: f64,
    /// Lengths of the three parts: from the pole below, the wall, to the pole above.
    lengths: [f64; 3],
    /// Their areas for each radian.
    areas: [f64; 3],
}

/// What a point of the profile lies on.
enum Part {
    Low,
    Wall,
    High,
}

impl Capsule {
    /// By the radii of the balls at heights 0 and 1, which differ by less than 1.
    pub fn new(radius: [f64; 2]) -> Self {
        let [a, b] = radius;
        let lean = a - b;
        let upright = (1.0 - lean * lean).abs().sqrt();
        let low = ops::acos_d(-lean);
        Self {
            radius,
            lean,
            upright,
            lengths: [a * low, upright, b * (std::f64::consts::PI - low)],
            areas: [a * a * (1.0 + lean), 0.5 * (a + b) * upright * upright, b * b * (1.0 - lean)],
        }
    }

    /// Heights between which the wall is.
    fn seams(&self) -> [f64; 2] {
        [self.radius[0] * self.lean, 1.0 + self.radius[1] * self.lean]
    }

    /// The center of the ball that touches the profile at a point.
    fn center(&self, [rho, y]: Across) -> (f64, Part) {
        // Along the wall's normal to the axis.
        let h = y - rho * self.lean / self.upright;
        if h <= 0.0 || h.is_nan() {
            (0.0, Part::Low)
        } else if h < 1.0 {
            (h, Part::Wall)
        } else {
            (1.0, Part::High)
        }
    }

    fn length(&self) -> f64 {
        self.lengths.iter().sum()
    }

    /// On a ball, by how far above its middle.
    fn on_ball(radius: f64, center: f64, up: f64) -> Across {
        let up = clamped(up, -radius, radius);
        [(radius * radius - up * up).abs().sqrt(), center + up]
    }
}

impl Profile for Capsule {
    fn middle(&self) -> f64 {
        0.5
    }

    fn crossings(&self, o: DVec3, d: DVec3, out: &mut Roots) {
        let [low, high] = self.seams();
        let y = |s: f64| o.y + s * d.y;
        // Parts overlap by some rounding, so that nothing slips between them.
        const SEAM: f64 = 1e-12;
        for s in quadratic(1.0, o.dot(d), o.dot(o) - self.radius[0] * self.radius[0]) {
            if y(s) <= low + SEAM {
                out.add(s);
            }
        }
        let above = o - DVec3::Y;
        for s in quadratic(1.0, above.dot(d), above.dot(above) - self.radius[1] * self.radius[1]) {
            if y(s) >= high - SEAM {
                out.add(s);
            }
        }
        // The wall's radius at a height is base + slope y.
        let (base, slope) = (self.radius[0] / self.upright, -self.lean / self.upright);
        let radius = base + slope * o.y;
        let rho = (o.x * o.x + o.z * o.z).sqrt();
        let a = d.x * d.x + d.z * d.z - slope * slope * d.y * d.y;
        let b = o.x * d.x + o.z * d.z - slope * d.y * radius;
        for s in quadratic(a, b, (rho - radius) * (rho + radius)) {
            if y(s) >= low - SEAM && y(s) <= high + SEAM {
                out.add(s);
            }
        }
    }

    fn nearest(&self, p: Across) -> Across {
        let (h, _) = self.center(p);
        let radius = self.radius[0] - self.lean * h;
        let (x, y) = (p[0], p[1] - h);
        let length = (x * x + y * y).sqrt();
        if length > 0.0 { [radius * x / length, h + radius * y / length] } else { [radius, h] }
    }

    fn normal(&self, p: Across) -> Across {
        [p[0], p[1] - self.center(p).0]
    }

    fn v(&self, p: Across) -> f64 {
        let [low, wall, _] = self.lengths;
        let from_below = |radius: f64, up: f64| radius * ops::acos_d(clamped(-up / radius, -1.0, 1.0));
        let [_, b] = self.radius;
        let so_far = match self.center(p) {
            (_, Part::Low) => from_below(self.radius[0], p[1]),
            (h, Part::Wall) => low + wall * h,
            (_, Part::High) => low + wall + from_below(b, p[1] - 1.0) - b * ops::acos_d(-self.lean),
        };
        so_far / self.length()
    }

    fn along(&self, p: Across) -> Along {
        let (h, part) = self.center(p);
        let radius = self.radius[0] - self.lean * h;
        let n = self.normal(p);
        // The normal turned by a quarter, as long as the curve is.
        let step = self.length() / radius;
        let d = [-n[1] * step, n[0] * step];
        Along { d, around: 0.0, dn: if matches!(part, Part::Wall) { [0.0; 2] } else { d } }
    }

    /// Even in area.
    fn at(&self, w: f64) -> (Across, f64) {
        let [low, wall, high] = self.areas;
        let all = low + wall + high;
        let part = w * all;
        let [a, b] = self.radius;
        let p = if part < low {
            Self::on_ball(a, 0.0, part / a - a)
        } else if part < low + wall {
            // Between the circles where the balls touch the wall, even in the radius squared.
            let (p, q) = (a * self.upright, b * self.upright);
            let k = (part - low) / wall;
            let rho = (p * p + k * (q * q - p * p)).abs().sqrt();
            let h = k * (p + q) / (rho + p);
            [rho, a * self.lean + (1.0 - self.lean * self.lean) * h]
        } else {
            Self::on_ball(b, 1.0, b - (all - part) / b)
        };
        (p, all)
    }

    fn weight(&self, _: Across) -> f64 {
        self.areas.iter().sum()
    }

    fn support(&self, a: f64, b: f64) -> f64 {
        let length = (a * a + b * b).sqrt();
        ops_max([self.radius[0] * length, b + self.radius[1] * length])
    }
}
