//! Pieces of curves: round tubes, bands that face whoever looks, and ribbons.
//!
//! A piece is a cubic Bezier curve with a radius that is one as well. A ray is met near where it passes closest: the curve, seen along
//! the ray, is halved as long as its box holds the ray, until its pieces are all but straight (as pbrt does; Nakamaru & Ohno 2002). There the tube
//! itself is met by Newton's method from the cylinder that touches it, so that its outline is as smooth as it is.

use std::sync::Arc;

use straal_math::{Affine, Bounds, DVec3, Ray, ops};

use super::exact::{at, clamped, outward, rounded, unit_or};
use super::sampling;
use super::{Form, ShapeHit, SurfacePoint, Tangents};

/// Where curves stand: shared by all that come of one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Space {
    map: Affine,
    inverse: Affine,
}

impl Space {
    /// By the map to the world; `None` when it is singular.
    pub fn new(map: Affine) -> Option<Self> {
        Some(Self { map, inverse: map.inverse()? })
    }
}

/// What is drawn along a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Section {
    /// A tube, open at its ends.
    Round,
    /// A band across the ray.
    Flat,
    /// A band across these directions, at its beginning and its end.
    Ribbon([DVec3; 2]),
}

/// A piece of a curve.
///
/// Hit coordinates: u along the piece, and from -1 to 1 across it (0 for a tube). Texture coordinates: u along the whole curve; v
/// across it, or about it for a tube.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    space: Arc<Space>,
    points: [DVec3; 4],
    radii: [f64; 4],
    /// The texture coordinate at its ends.
    along: [f64; 2],
    section: Section,
}

/// A curve's point, its first and second change with u.
#[derive(Clone, Copy)]
struct Moving {
    p: DVec3,
    d: DVec3,
    dd: DVec3,
    /// The radius and its change.
    r: f64,
    dr: f64,
}

/// The four weights of a cubic Bezier curve.
fn weights(u: f64) -> [f64; 4] {
    let w = 1.0 - u;
    [w * w * w, 3.0 * u * w * w, 3.0 * u * u * w, u * u * u]
}

fn mixed(points: &[DVec3; 4], by: [f64; 4]) -> DVec3 {
    points[0] * by[0] + points[1] * by[1] + points[2] * by[2] + points[3] * by[3]
}

impl Curve {
    /// A piece by its control points, their radii, and which part of the curve's own u it has.
    pub fn new(
        space: Arc<Space>,
        points: [DVec3; 4],
        radii: [f64; 4],
        along: [f64; 2],
        section: Section,
    ) -> Self {
        Self { space, points, radii, along, section }
    }

    /// The two halves.
    pub fn halves(&self) -> [Self; 2] {
        let radii = self.radii.map(|r| DVec3::new(r, 0.0, 0.0));
        let ([p, q], [r, s]) = (split(&self.points), split(&radii));
        let middle = 0.5 * (self.along[0] + self.along[1]);
        let [before, after] = match self.section {
            Section::Ribbon([a, b]) => {
                let half = turned([a, b], 0.5);
                [Section::Ribbon([a, half]), Section::Ribbon([half, b])]
            }
            other => [other; 2],
        };
        let part = |points, radii: [DVec3; 4], along, section| Self {
            space: self.space.clone(),
            points,
            radii: radii.map(|r| r.x),
            along,
            section,
        };
        [part(p, r, [self.along[0], middle], before), part(q, s, [middle, self.along[1]], after)]
    }

    /// How many times it should be halved for boxes that aren't much wider than it is.
    pub fn worthwhile_halvings(&self) -> u32 {
        let length: f64 = self.points.windows(2).map(|w| (w[1] - w[0]).length()).sum();
        // Straight ones gain by it where they aren't along an axis, and bent ones more.
        match length / (self.widest() * 16.0) {
            x if x > 8.0 => 3,
            x if x > 4.0 => 2,
            x if x > 2.0 => 1,
            _ => 0,
        }
    }

    fn widest(&self) -> f64 {
        self.radii.iter().fold(0.0, |most: f64, r| if *r > most { *r } else { most })
    }

    fn moving(&self, u: f64) -> Moving {
        let w = 1.0 - u;
        let first = [-3.0 * w * w, 3.0 * w * w - 6.0 * u * w, 6.0 * u * w - 3.0 * u * u, 3.0 * u * u];
        let second = [6.0 * w, 6.0 * u - 12.0 * w, 6.0 * w - 12.0 * u, 6.0 * u];
        let of = |by: [f64; 4]| -> f64 { self.radii.iter().zip(by).map(|(r, b)| r * b).sum() };
        let at = weights(u);
        Moving {
            p: mixed(&self.points, at),
            d: mixed(&self.points, first),
            dd: mixed(&self.points, second),
            r: of(at),
            dr: of(first),
        }
    }

    /// How often it is halved until pieces are straight to a twentieth of their width.
    fn depth(&self) -> u32 {
        let [a, b, c, d] = self.points;
        let (p, q) = ((a - b * 2.0 + c).length(), (b - c * 2.0 + d).length());
        let bend = if p > q { p } else { q };
        // Wang's bound: the distance from the chord falls to a quarter with each halving.
        let mut off = 0.75 * bend;
        let mut depth = 0;
        while off > 0.05 * self.widest() && depth < 10 {
            off *= 0.25;
            depth += 1;
        }
        depth
    }

    /// The direction across a ribbon.
    fn across(&self, normals: [DVec3; 2], u: f64, d: DVec3) -> DVec3 {
        unit_or(turned(normals, u).cross(d), DVec3::X)
    }

    /// The point of a tube that is seen from its axis in the direction of `q`: where on the curve, and the direction.
    fn foot(&self, q: DVec3, near: f64) -> (f64, Moving) {
        let mut u = near;
        let mut m = self.moving(u);
        for _ in 0..4 {
            let off = q - m.p;
            let slope = off.dot(m.dd) - m.d.dot(m.d);
            let step = off.dot(m.d) / slope;
            if !step.is_finite() {
                break;
            }
            u = clamped(u - step, 0.0, 1.0);
            m = self.moving(u);
        }
        (u, m)
    }

    /// A direction at right angles to the curve from which turns about it are counted.
    fn zero(&self, d: DVec3) -> DVec3 {
        let chord = self.points[3] - self.points[0];
        let helper = match chord.abs() {
            c if c.x <= c.y && c.x <= c.z => DVec3::X,
            c if c.y <= c.z => DVec3::Y,
            _ => DVec3::Z,
        };
        let d = unit_or(d, DVec3::Y);
        unit_or(helper - d * helper.dot(d), DVec3::X)
    }

    fn size(&self) -> f64 {
        let reach: f64 = self.points.iter().map(|p| super::exact::size(*p)).sum::<f64>() + self.widest();
        self.space.map.rows.iter().map(|[x, y, z, o]| (x.abs() + y.abs() + z.abs()) * reach + o.abs()).sum()
    }

    /// The direction away from a tube's axis at a point on it, and its outward normal.
    fn tube_normal(m: &Moving, out: DVec3) -> DVec3 {
        let speed = m.d.length();
        // Where the curve bends towards `out`, the tube is shorter there.
        out * (speed - m.r * m.dd.dot(out) / speed) - m.d * (m.dr / speed)
    }

    /// The direction of a ray in the curves' space.
    fn looked(&self, ray: &Ray) -> DVec3 {
        unit_or(self.space.inverse.vector(ray.d.as_dvec3()), DVec3::Z)
    }
}

/// A cubic in halves (de Casteljau).
fn split(p: &[DVec3; 4]) -> [[DVec3; 4]; 2] {
    let half = |a: DVec3, b: DVec3| (a + b) * 0.5;
    let (a, b, c) = (half(p[0], p[1]), half(p[1], p[2]), half(p[2], p[3]));
    let (d, e) = (half(a, b), half(b, c));
    let m = half(d, e);
    [[p[0], a, d, m], [m, e, c, p[3]]]
}

/// From one direction to another.
fn turned([a, b]: [DVec3; 2], u: f64) -> DVec3 {
    unit_or(a * (1.0 - u) + b * u, a)
}

/// A piece of a curve that is still to be looked at: seen along the ray, and which part of u it has.
#[derive(Clone, Copy)]
struct Open {
    points: [DVec3; 4],
    u: [f64; 2],
    depth: u32,
}

/// A line in the curves' space, and the frame about it.
struct Line {
    o: DVec3,
    d: DVec3,
    x: DVec3,
    y: DVec3,
}

impl Line {
    /// Across it, and along.
    fn seen(&self, p: DVec3) -> DVec3 {
        let q = p - self.o;
        DVec3::new(q.dot(self.x), q.dot(self.y), q.dot(self.d))
    }
}

impl Curve {
    /// Offers what a line meets of a straight piece: how far along, u, and across.
    fn meet(&self, line: &Line, open: &Open, offer: &mut impl FnMut(f64, f64, f64)) {
        match self.section {
            Section::Round => self.meet_tube(line, open, offer),
            Section::Flat => {
                let (u, c, d) = self.closest(line, open);
                let beyond = -(c.x * d.x + c.y * d.y);
                if u <= 0.0 && beyond < 0.0 || u >= 1.0 && beyond > 0.0 {
                    return;
                }
                let distance = (c.x * c.x + c.y * c.y).sqrt();
                let r = self.moving(u).r;
                if distance <= r && r > 0.0 {
                    let side = d.x * c.y - d.y * c.x;
                    offer(c.z, u, (distance / r).copysign(side));
                }
            }
            Section::Ribbon(normals) => {
                // C + w r B on the line: C and B are parallel, seen along it.
                let g = |u: f64| {
                    let m = self.moving(u);
                    let (c, b) = (line.seen(m.p), line.seen(line.o + self.across(normals, u, m.d)));
                    (c.x * b.y - c.y * b.x, c, b, m.r)
                };
                let [mut low, mut high] = open.u;
                let (first, last) = (g(low).0, g(high).0);
                if (first < 0.0) == (last < 0.0) {
                    return;
                }
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if (g(middle).0 < 0.0) == (first < 0.0) { low = middle } else { high = middle }
                }
                let u = 0.5 * (low + high);
                let (_, c, b, r) = g(u);
                let w = -(c.x * b.x + c.y * b.y) / (r * (b.x * b.x + b.y * b.y));
                if w.abs() <= 1.0 {
                    offer(c.z + w * r * b.z, u, w);
                }
            }
        }
    }

    /// Where in a part of the curve it is closest to a line: u, the point as seen along the line, and its change.
    fn closest(&self, line: &Line, open: &Open) -> (f64, DVec3, DVec3) {
        let [low, high] = open.u;
        let (a, b) = (open.points[0], open.points[3]);
        let way = b - a;
        let part = -(a.x * way.x + a.y * way.y) / (way.x * way.x + way.y * way.y);
        let mut u =
            if part.is_finite() { low + (high - low) * clamped(part, 0.0, 1.0) } else { 0.5 * (low + high) };
        let seen = |u: f64| {
            let m = self.moving(u);
            (line.seen(m.p), line.seen(line.o + m.d), line.seen(line.o + m.dd))
        };
        for _ in 0..3 {
            let (c, d, dd) = seen(u);
            let f = c.x * d.x + c.y * d.y;
            let slope = d.x * d.x + d.y * d.y + c.x * dd.x + c.y * dd.y;
            if slope > 0.0 {
                u = clamped(u - f / slope, low, high);
            }
        }
        let (c, d, _) = seen(u);
        (u, c, d)
    }

    fn meet_tube(&self, line: &Line, open: &Open, offer: &mut impl FnMut(f64, f64, f64)) {
        let (u, c, _) = self.closest(line, open);
        let m = self.moving(u);
        // The cylinder that touches the tube there, from the point of the line next to it.
        let speed = m.d.length();
        let axis = unit_or(m.d, line.d);
        let from = line.o + line.d * c.z - m.p;
        let (o, d) = (from - axis * from.dot(axis), line.d - axis * line.d.dot(axis));
        let (a, b) = (d.dot(d), o.dot(d));
        // Wide enough for a tube that grows, so that none is passed by that is met.
        let r = m.r + 0.1 * self.widest();
        let rest = b * b - a * (o.dot(o) - r * r);
        if rest <= 0.0 || rest.is_nan() {
            return;
        }
        for sign in [-1.0, 1.0] {
            let s = if a > 1e-12 { (-b + sign * rest.sqrt()) / a } else { sign * r };
            let reach = 4.0 * r + (open.u[1] - open.u[0]) * speed;
            let s = clamped(s, -reach, reach);
            let slid = (from + line.d * s).dot(axis) / speed;
            let start = if slid.is_finite() { clamped(u + slid, 0.0, 1.0) } else { u };
            if let Some((s, u)) = self.newton(line, c.z + s, start) {
                offer(s, u, 0.0);
            }
        }
    }

    /// Where a line meets the tube: (p - c) at right angles to the curve, and as long as the radius.
    fn newton(&self, line: &Line, mut s: f64, mut u: f64) -> Option<(f64, f64)> {
        for _ in 0..12 {
            let m = self.moving(u);
            let off = line.o + line.d * s - m.p;
            let (f, g) = (off.dot(m.d), off.dot(off) - m.r * m.r);
            let (fs, fu) = (line.d.dot(m.d), off.dot(m.dd) - m.d.dot(m.d));
            let (gs, gu) = (2.0 * line.d.dot(off), -2.0 * f - 2.0 * m.r * m.dr);
            let det = fs * gu - fu * gs;
            let (ds, du) = ((f * gu - fu * g) / det, (fs * g - f * gs) / det);
            if !(ds.is_finite() && du.is_finite()) {
                return None;
            }
            (s, u) = (s - ds, u - du);
            let speed = m.d.length();
            if du.abs() * speed < 1e-11 * m.r && ds.abs() < 1e-11 * m.r {
                return (0.0..=1.0).contains(&u).then_some((s, u));
            }
            if !(-1.0..=2.0).contains(&u) {
                return None;
            }
        }
        None
    }
}

impl Form for Curve {
    fn bounds(&self) -> Option<Bounds> {
        // The curve lies among its control points, and the tube no further away than its largest radius.
        let [first, rest @ ..] = self.points.map(|p| self.space.map.point(p));
        let (low, high) = rest.iter().fold((first, first), |(l, h), p| (l.min(*p), h.max(*p)));
        let reach = |i: usize| {
            let [x, y, z, _] = self.space.map.rows[i];
            DVec3::new(x, y, z).length() * self.widest()
        };
        let r = DVec3::new(reach(0), reach(1), reach(2));
        Some(outward(low - r, high + r, self.size()))
    }

    fn intersect(&self, ray: &Ray) -> Option<ShapeHit> {
        let (o, d) =
            (self.space.inverse.point(ray.o.as_dvec3()), self.space.inverse.vector(ray.d.as_dvec3()));
        let length = d.length();
        let d = d / length;
        let middle = (self.points[0] + self.points[3]) * 0.5;
        let ahead = (middle - o).dot(d);
        let o = o + d * ahead;
        if !(length > 0.0 && length < f64::INFINITY && o.x.abs() + o.y.abs() + o.z.abs() < f64::INFINITY) {
            return None;
        }
        let (x, y) = sampling::tangents(d);
        let line = Line { o, d, x, y };
        let widest = self.widest();
        let t = |s: f64| ((ahead + s) / length) as f32;
        let mut best: Option<ShapeHit> = None;
        let mut offer = |s: f64, u: f64, across: f64| {
            let t = t(s);
            let is_there = t >= ray.t_min && t <= ray.t_max && t.abs() < f32::INFINITY;
            if is_there && best.is_none_or(|b| t < b.t) {
                best = Some(ShapeHit { t, u: u as f32, v: across as f32 });
            }
        };
        // One half waits at each depth.
        let root = Open { points: self.points.map(|p| line.seen(p)), u: [0.0, 1.0], depth: self.depth() };
        let mut stack = [root; 12];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let open = stack[waiting];
            let [a, b, c, d] = open.points;
            let (low, high) = (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
            let is_near = low.x <= widest && high.x >= -widest && low.y <= widest && high.y >= -widest;
            if !is_near || t(high.z + 2.0 * widest) < ray.t_min || t(low.z - 2.0 * widest) > ray.t_max {
                continue;
            }
            if open.depth == 0 {
                self.meet(&line, &open, &mut offer);
                continue;
            }
            let [p, q] = split(&open.points);
            let (middle, depth) = (0.5 * (open.u[0] + open.u[1]), open.depth - 1);
            for half in [
                Open { points: q, u: [middle, open.u[1]], depth },
                Open { points: p, u: [open.u[0], middle], depth },
            ] {
                if let Some(free) = stack.get_mut(waiting) {
                    *free = half;
                    waiting += 1;
                }
            }
        }
        best
    }

    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let space = &self.space;
        let u = f64::from(hit.u);
        let along = |u: f64| (self.along[0] + u * (self.along[1] - self.along[0])) as f32;
        match self.section {
            Section::Round => {
                let q = space.inverse.point(at(ray, hit.t));
                let (u, m) = self.foot(q, u);
                let axis = unit_or(m.d, DVec3::Y);
                let off = q - m.p;
                let out = unit_or(off - axis * off.dot(axis), self.zero(m.d));
                let (p, p_err) = rounded::<f32>(space.map.point(m.p + out * m.r), self.size());
                let n = space.inverse.normal_by_inverse(Self::tube_normal(&m, out));
                let n = unit_or(n, DVec3::Y).as_vec3();
                let zero = self.zero(m.d);
                let turn = ops::atan2_d(out.dot(axis.cross(zero)), out.dot(zero)) / std::f64::consts::TAU;
                let v = if turn < 0.0 { turn + 1.0 } else { turn };
                SurfacePoint { p, p_err, ng: n, n, uv: [along(u), v as f32] }
            }
            Section::Flat | Section::Ribbon(_) => {
                let m = self.moving(u);
                let (across, is_ribbon) = match self.section {
                    Section::Ribbon(normals) => (self.across(normals, u, m.d), true),
                    _ => (unit_or(self.looked(ray).cross(m.d), DVec3::X), false),
                };
                // For a band across the ray the side was told by the same turn.
                let w = if is_ribbon { f64::from(hit.v) } else { -f64::from(hit.v) };
                let on = m.p + across * (w * m.r);
                let (p, mut p_err) = rounded::<f32>(space.map.point(on), self.size());
                let n = space.inverse.normal_by_inverse(m.d.cross(across));
                let mut n = unit_or(n, DVec3::Y).as_vec3();
                if !is_ribbon {
                    // It turns towards whoever looks, so that another ray may meet it anywhere as far away as it is wide.
                    let wide = space.map.vector(across * (2.0 * m.r)).as_vec3().length();
                    p_err += straal_math::Vec3::splat(wide);
                    if n.dot(ray.d) > 0.0 {
                        n = -n;
                    }
                }
                SurfacePoint { p, p_err, ng: n, n, uv: [along(u), (0.5 + 0.5 * w) as f32] }
            }
        }
    }

    fn tangents(&self, s: &SurfacePoint) -> Tangents {
        let q = self.space.inverse.point(s.p.as_dvec3());
        let length = self.along[1] - self.along[0];
        let near = clamped((f64::from(s.uv[0]) - self.along[0]) / length, 0.0, 1.0);
        let (near, m) = self.foot(q, near);
        let map = |v: DVec3| self.space.map.vector(v).as_vec3();
        let n = s.ng;
        let level = |v: straal_math::Vec3| v - n * n.dot(v);
        let forward = level(map(m.d / length));
        match self.section {
            Section::Round => {
                let axis = unit_or(m.d, DVec3::Y);
                let off = q - m.p;
                let out = unit_or(off - axis * off.dot(axis), self.zero(m.d));
                let turn = axis.cross(out) * std::f64::consts::TAU;
                let normal = |d: DVec3| self.space.inverse.normal_by_inverse(d).as_vec3();
                let dndv = super::tangents::unit_change(normal(out), normal(turn));
                let about =
                    Tangents { dpdv: level(map(turn * m.r)), dndv, ..Tangents::flat(forward, forward) };
                if forward.length_squared() > 0.0 { about } else { Tangents::about(n) }
            }
            Section::Ribbon(normals) if forward.length_squared() > 0.0 => {
                Tangents::flat(forward, map(self.across(normals, near, m.d) * (2.0 * m.r)))
            }
            Section::Flat if forward.length_squared() > 0.0 => {
                // Across the ray, whose direction the normal tells.
                let side = n.cross(forward).try_normalize().unwrap_or(n);
                let across = unit_or(self.space.inverse.vector(side.as_dvec3()), DVec3::X);
                Tangents::flat(forward, map(across * (2.0 * m.r)))
            }
            _ => Tangents::about(n),
        }
    }

    #[cfg(test)]
    fn examples(stand: &super::tests::Setting) -> Vec<super::tests::Example> {
        tests::examples(stand)
    }
}

#[cfg(test)]
mod tests;
