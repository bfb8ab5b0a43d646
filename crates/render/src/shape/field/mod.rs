//! Solids that are told by their distance: signed distance fields, by sphere tracing.
//!
//! A ray goes on by as much as the distance, over the field's Lipschitz bound, says that nothing can be in its way (Hart 1996, "Sphere
//! tracing"), until it has changed its side; where between the last two steps is found by halving. Steps are never shorter than a
//! small part of the whole (`STEPS`), so that rays that graze it end; what is thinner than that may be passed by.
//!
//! Hit coordinates: none (0). Texture coordinates: u turns about the vertical through the middle from +z towards +x, v rises from 0 at
//! the bottom to 1.

use std::sync::Arc;

use straal_math::{Affine, Bounds, DVec3, Ray, Vec3, ops};

use super::exact::{along, outward, rounded, unit_or};
use super::{Form, ShapeHit, SurfacePoint, Tangents};
use distance::{Body, Jet};

pub mod distance;

/// The shortest step is the longest edge of the box over this.
const STEPS: f64 = 65536.0;

/// A solid told by its distance, under an affine map.
#[derive(Clone, Debug)]
pub struct Field {
    map: Affine,
    inverse: Affine,
    body: Arc<Body>,
    low: DVec3,
    high: DVec3,
    /// No distance changes faster.
    steepest: f64,
}

impl Field {
    /// The image of a body under a map; `None` when that is singular, or the body is nowhere or everywhere.
    pub fn new(map: Affine, body: Arc<Body>) -> Option<Self> {
        let inverse = map.inverse()?;
        let (low, high) = body.within(0.0);
        let size = high - low;
        let is_somewhere = size.x >= 0.0 && size.y >= 0.0 && size.z >= 0.0 && size.is_finite();
        // Room for the outside, from which rays come.
        let room = DVec3::splat(1e-3 * size.max_element());
        let steepest = body.steepest();
        let sound = is_somewhere && steepest > 0.0 && steepest.is_finite();
        sound.then_some(Self { map, inverse, body, low: low - room, high: high + room, steepest })
    }

    /// A line in its own space: where it is at t = 0, its direction, and the length of that.
    fn line(&self, ray: &Ray) -> (DVec3, DVec3) {
        (self.inverse.point(ray.o.as_dvec3()), self.inverse.vector(ray.d.as_dvec3()))
    }

    /// Where between two places on a line that are on either side the surface is, to the last bits: the one on the far side.
    fn between(&self, o: DVec3, d: DVec3, [mut near, mut far]: [f64; 2]) -> f64 {
        let is_in = self.body.distance(o + d * near) < 0.0;
        for _ in 0..80 {
            let middle = 0.5 * (near + far);
            if middle <= near || middle >= far {
                break;
            }
            if (self.body.distance(o + d * middle) < 0.0) == is_in { near = middle } else { far = middle }
        }
        far
    }

    fn size(&self) -> f64 {
        let reach = super::exact::size(self.low) + super::exact::size(self.high);
        self.map.rows.iter().map(|[x, y, z, o]| (x.abs() + y.abs() + z.abs()) * reach + o.abs()).sum()
    }

    fn middle(&self) -> DVec3 {
        (self.low + self.high) * 0.5
    }
}

impl Form for Field {
    fn bounds(&self) -> Option<Bounds> {
        let (c, half) = (self.map.point(self.middle()), (self.high - self.low) * 0.5);
        let reach = |i: usize| {
            let [x, y, z, _] = self.map.rows[i];
            x.abs() * half.x + y.abs() * half.y + z.abs() * half.z
        };
        let r = DVec3::new(reach(0), reach(1), reach(2));
        Some(outward(c - r, c + r, self.size()))
    }

    fn intersect(&self, ray: &Ray) -> Option<ShapeHit> {
        /// More steps than any sensible field takes.
        const MOST: usize = 4096;
        let (o, d) = self.line(ray);
        let length = d.length();
        if !(length > 0.0 && length < f64::INFINITY) {
            return None;
        }
        // The part of the ray in the box.
        let (mut s, mut end) = (f64::from(ray.t_min), f64::from(ray.t_max));
        for ((o, d), (low, high)) in o
            .to_array()
            .into_iter()
            .zip(d.to_array())
            .zip(self.low.to_array().into_iter().zip(self.high.to_array()))
        {
            let (a, b) = ((low - o) / d, (high - o) / d);
            let (a, b) = if a < b { (a, b) } else { (b, a) };
            // Along the faces neither is a number, and both decide nothing.
            if d == 0.0 {
                if o < low || o > high {
                    return None;
                }
            } else {
                s = if a > s { a } else { s };
                end = if b < end { b } else { end };
            }
        }
        if !(s <= end && end < f64::INFINITY) {
            return None;
        }
        let shortest = (self.high - self.low).max_element() / STEPS;
        let mut f = self.body.distance(o + d * s);
        let is_in = f < 0.0;
        for _ in 0..MOST {
            let safe = f.abs() / self.steepest;
            let step = if safe > shortest { safe } else { shortest } / length;
            let next = if s + step < end { s + step } else { end };
            f = self.body.distance(o + d * next);
            if f.is_nan() {
                return None;
            }
            if (f < 0.0) != is_in {
                let t = self.between(o, d, [s, next]) as f32;
                return (t >= ray.t_min && t <= ray.t_max).then_some(ShapeHit { t, u: 0.0, v: 0.0 });
            }
            if next >= end {
                return None;
            }
            s = next;
        }
        None
    }

    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let (o, d) = self.line(ray);
        // Before t was rounded.
        let (near, far) = (f64::from(hit.t.next_down()), f64::from(hit.t.next_up()));
        let is_in = |s: f64| self.body.distance(o + d * s) < 0.0;
        let s = if is_in(near) == is_in(far) { f64::from(hit.t) } else { self.between(o, d, [near, far]) };
        let q = o + d * s;
        let (p, p_err) =
            rounded::<f32>(self.map.point(q), self.size() + super::exact::size(along([ray.o, ray.d], hit.t)));
        let n = self.inverse.normal_by_inverse(self.body.value(Jet::of(q)).gradient());
        let n = unit_or(n, DVec3::Y).as_vec3();
        let from = q - self.middle();
        let turn = ops::atan2_d(from.x, from.z) / std::f64::consts::TAU;
        let v = (q.y - self.low.y) / (self.high.y - self.low.y);
        SurfacePoint {
            p,
            p_err,
            ng: n,
            n,
            uv: [(if turn < 0.0 { turn + 1.0 } else { turn }) as f32, v as f32],
        }
    }

    /// What moves one texture coordinate alone, in the surface; how the normal turns is told by a short way along it.
    fn tangents(&self, s: &SurfacePoint) -> Tangents {
        let q = self.inverse.point(s.p.as_dvec3());
        let from = q - self.middle();
        let rr = from.x * from.x + from.z * from.z;
        // The gradients of u and v, seen from the world.
        let u = DVec3::new(from.z, 0.0, -from.x) / (rr * std::f64::consts::TAU);
        let v = DVec3::Y / (self.high.y - self.low.y);
        let (u, v) = (self.inverse.normal_by_inverse(u), self.inverse.normal_by_inverse(v));
        let n = s.ng.as_dvec3();
        let (along_u, along_v) = (v.cross(n), n.cross(u));
        let det = u.dot(along_u);
        let [du, dv] = [along_u, along_v].map(|a| a / det);
        let [dpdu, dpdv] = [du, dv].map(DVec3::as_vec3);
        if !dpdu.is_finite() || !dpdv.is_finite() || dpdu == Vec3::ZERO || dpdv == Vec3::ZERO {
            return Tangents::about(s.n);
        }
        let normal = |q: DVec3| {
            let gradient = self.body.value(Jet::of(q)).gradient();
            unit_or(self.inverse.normal_by_inverse(gradient), n)
        };
        let turn = |d: DVec3| {
            let way = self.inverse.vector(d);
            let step = 1e-4 * (self.high - self.low).max_element() / way.length();
            ((normal(q + way * step) - normal(q - way * step)) / (2.0 * step)).as_vec3()
        };
        Tangents { dpdu, dpdv, dndu: turn(du), dndv: turn(dv) }
    }

    #[cfg(test)]
    fn examples(stand: &super::tests::Setting) -> Vec<super::tests::Example> {
        tests::examples(stand)
    }
}

#[cfg(test)]
mod tests;
