//! Surfaces of revolution: a curve turned about the y-axis, by the whole turn or a part of it, under an affine map.
//!
//! The curve (`Profile`, a file each) lies in the half-plane of distance rho from the axis and height y. What they share is here:
//! the part of a turn, the map, areas, densities. Hits are solved in double precision near the shape: the ray's origin is moved to
//! where it comes closest to the middle, so that nothing cancels however far it set out.
//!
//! Hit coordinates: none (0). Texture coordinates: u is the part of the sweep, which turns about +y from +z towards +x; v is the
//! profile's.

use straal_math::{Affine, Bounds, DVec3, Ray, ops};

use super::exact::{at, outward, rounded, unit_or};
use super::tangents::unit_change;
use super::{AreaSample, Form, ShapeHit, SurfacePoint, Tangents};
use roots::Roots;

pub mod capsule;
pub mod frustum;
pub mod hyperboloid;
pub mod paraboloid;
pub mod ring;
pub(crate) mod roots;
pub mod torus;
pub mod zone;

pub use capsule::Capsule;
pub use frustum::Frustum;
pub use hyperboloid::Hyperboloid;
pub use paraboloid::Paraboloid;
pub use ring::Ring;
pub use torus::Torus;
pub use zone::Zone;

const TAU: f64 = std::f64::consts::TAU;

/// A point of a profile, or a direction in its half-plane: from the axis, and up.
pub(crate) type Across = [f64; 2];

/// How a profile's point and normal move with v.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Along {
    /// From the axis and up.
    pub d: Across,
    /// About the axis, as a length.
    pub around: f64,
    /// The change of [`Profile::normal`].
    pub dn: Across,
}

/// A curve in a half-plane, as surfaces of revolution know it.
pub(crate) trait Profile {
    /// The height of the middle.
    fn middle(&self) -> f64;

    /// Where a line o + s d, d of length 1, meets the surface of the whole turn: all s, in ascending order.
    fn crossings(&self, o: DVec3, d: DVec3, out: &mut Roots);

    /// The point of the curve next to one that is close by.
    fn nearest(&self, near: Across) -> Across;

    /// A normal of any length at a point, outwards.
    fn normal(&self, p: Across) -> Across;

    /// The texture coordinate of a point.
    fn v(&self, p: Across) -> f64;

    /// How the point moves with that.
    fn along(&self, p: Across) -> Along;

    /// A point for each w in [0, 1]: where, and area about the axis for each radian and w.
    fn at(&self, w: f64) -> (Across, f64);

    /// That area at a point.
    fn weight(&self, p: Across) -> f64;

    /// The greatest of a rho + b y on the curve, or a little more; `a` may be negative.
    fn support(&self, a: f64, b: f64) -> f64;

    /// By how much a point is turned about the axis.
    fn turned(&self, q: DVec3) -> f64 {
        ops::atan2_d(q.x, q.z)
    }

    /// The directions away from the axis of points that are turned by so much at one height.
    fn out(&self, _p: Across, angle: f64) -> DVec3 {
        let (s, c) = ops::sin_cos_d(angle);
        DVec3::new(s, 0.0, c)
    }

    /// The greatest coordinate along a direction of what the curve sweeps, for a curve that is turned by different angles at different
    /// heights.
    fn twisted_support(&self, _v: DVec3, _sweep: f64) -> Option<f64> {
        None
    }
}

macro_rules! curves {
    ($( $(#[doc = $doc:literal])+ $Kind:ident, )+) => {
        /// A curve that can be turned about the axis.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Curve {
            $( $(#[doc = $doc])+ $Kind($Kind), )+
        }

        impl Curve {
            #[inline]
            fn profile(&self) -> &dyn Profile {
                match self {
                    $( Self::$Kind(curve) => curve, )+
                }
            }
        }

        $( impl From<$Kind> for Curve {
            fn from(curve: $Kind) -> Self {
                Self::$Kind(curve)
            }
        } )+
    };
}

curves! {
    /// Part of the unit sphere.
    Zone,
    /// The wall of a cone, or of a cylinder.
    Frustum,
    /// A flat ring.
    Ring,
    /// A bowl.
    Paraboloid,
    /// A straight line that may be askew.
    Hyperboloid,
    /// A ring of round section.
    Torus,
    /// Around two balls.
    Capsule,
}

/// A curve that is turned about the y-axis, under an affine map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Revolved {
    /// With u = 0 along +z.
    map: Affine,
    inverse: Affine,
    curve: Curve,
    /// Radians of the turn that there are.
    sweep: f64,
    is_whole: bool,
}

impl Revolved {
    /// The image under `map` of the part of a turn between two angles in degrees; `None` when the map is singular, or too large or
    /// small for numbers.
    pub fn new(map: &Affine, curve: impl Into<Curve>, [from, to]: [f64; 2]) -> Option<Self> {
        let map = match Affine::rotate(DVec3::Y, from) {
            Some(turn) if from != 0.0 => turn.then(map),
            _ => *map,
        };
        let inverse = map.inverse()?;
        let is_whole = to - from >= 360.0;
        let sweep = if is_whole { TAU } else { (to - from).to_radians() };
        (sweep > 0.0).then_some(Self { map, inverse, curve: curve.into(), sweep, is_whole })
    }

    /// Whether it lies in a plane.
    pub fn is_flat(&self) -> bool {
        matches!(self.curve, Curve::Ring(_))
    }

    /// How far a point is turned, in the sweep: beyond its ends, the nearer of them.
    fn swept(&self, q: DVec3) -> f64 {
        within(self.curve.profile().turned(q), self.sweep).0
    }

    /// The point of the surface next to a point of its own space that is close by.
    fn towards(&self, q: DVec3) -> SurfacePoint {
        let profile = self.curve.profile();
        let out = unit_or(DVec3::new(q.x, 0.0, q.z), DVec3::Z);
        let p = profile.nearest([out.dot(q), q.y]);
        let on = DVec3::new(out.x * p[0], p[1], out.z * p[0]);
        self.placed(p, on, out, self.swept(on))
    }

    /// A point of the surface: on the curve, in its own space, the direction away from the axis, and how far it is turned.
    fn placed(&self, across: Across, on: DVec3, out: DVec3, turned: f64) -> SurfacePoint {
        let profile = self.curve.profile();
        let (p, p_err) = rounded::<f32>(self.map.point(on), self.size());
        let n = unit_or(self.inverse.normal_by_inverse(upright(profile.normal(across), out)), DVec3::Y);
        let uv = [(turned / self.sweep) as f32, profile.v(across) as f32];
        SurfacePoint { p, p_err, ng: n.as_vec3(), n: n.as_vec3(), uv }
    }

    /// The curve's own point at one of the surface, and the direction away from the axis.
    fn back(&self, s: &SurfacePoint) -> (Across, DVec3) {
        let q = self.inverse.point(s.p.as_dvec3());
        let out = unit_or(DVec3::new(q.x, 0.0, q.z), DVec3::Z);
        (self.curve.profile().nearest([out.dot(q), q.y]), out)
    }

    /// The density of points by area that are even in w and in the turn.
    fn density(&self, across: Across, out: DVec3, weight: f64) -> f32 {
        (1.0 / (self.sweep * weight * self.stretch(across, out))) as f32
    }

    /// How much larger the image of a piece of surface is.
    fn stretch(&self, across: Across, out: DVec3) -> f64 {
        let n = unit_or(upright(self.curve.profile().normal(across), out), DVec3::Y);
        self.map.determinant().abs() * self.inverse.normal_by_inverse(n).length()
    }

    /// No number behind a point is larger than this.
    fn size(&self) -> f64 {
        4.0 * self.map.rows.iter().flatten().map(|x| x.abs()).sum::<f64>()
    }

    /// The greatest coordinate along a direction of its own space.
    fn support(&self, v: DVec3) -> f64 {
        let profile = self.curve.profile();
        profile
            .twisted_support(v, self.sweep)
            .unwrap_or_else(|| profile.support(swept(v, 0.0, self.sweep), v.y))
    }
}

/// The greatest part of a direction that is away from the axis, of all in a sweep that begins at an angle.
fn swept(v: DVec3, from: f64, sweep: f64) -> f64 {
    let (end, is_there) = within((ops::atan2_d(v.x, v.z) - from) % TAU, sweep);
    if is_there {
        return (v.x * v.x + v.z * v.z).sqrt();
    }
    // Else the nearer end has the greater one.
    let (s, c) = ops::sin_cos_d(from + end);
    v.x * s + v.z * c
}

/// A direction of the half-plane that points away from the axis along `out`.
fn upright([rho, y]: Across, out: DVec3) -> DVec3 {
    DVec3::new(out.x * rho, y, out.z * rho)
}

/// An angle within a sweep from 0 on, and whether it is there; else the nearer end.
fn within(angle: f64, sweep: f64) -> (f64, bool) {
    let angle = if angle < 0.0 { angle + TAU } else { angle };
    if angle <= sweep {
        (angle, true)
    } else if angle - sweep < TAU - angle {
        (sweep, false)
    } else {
        (0.0, false)
    }
}

impl Form for Revolved {
    fn bounds(&self) -> Option<Bounds> {
        let row = |i: usize| {
            let [x, y, z, w] = self.map.rows[i];
            let v = DVec3::new(x, y, z);
            (w - self.support(-v), w + self.support(v))
        };
        let (x, y, z) = (row(0), row(1), row(2));
        Some(outward(DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1), self.size()))
    }

    fn intersect(&self, ray: &Ray) -> Option<ShapeHit> {
        let profile = self.curve.profile();
        let (o, d) = (self.inverse.point(ray.o.as_dvec3()), self.inverse.vector(ray.d.as_dvec3()));
        let length = d.length();
        let d = d / length;
        let closest = (DVec3::new(0.0, profile.middle(), 0.0) - o).dot(d);
        let o = o + d * closest;
        // Written so that NaN fails.
        if !(length > 0.0 && length < f64::INFINITY && o.x.abs() + o.y.abs() + o.z.abs() < f64::INFINITY) {
            return None;
        }
        let mut roots = Roots::default();
        profile.crossings(o, d, &mut roots);
        let t = |s: f64| ((closest + s) / length) as f32;
        let is_there = |s: f64| self.is_whole || within(profile.turned(o + d * s), self.sweep).1;
        let mut found = roots.iter().map(|s| (s, t(s)));
        let (_, t) = found
            .find(|&(s, t)| t >= ray.t_min && t <= ray.t_max && t.abs() < f32::INFINITY && is_there(s))?;
        Some(ShapeHit { t, u: 0.0, v: 0.0 })
    }

    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.towards(self.inverse.point(at(ray, hit.t)))
    }

    fn tangents(&self, s: &SurfacePoint) -> Tangents {
        let profile = self.curve.profile();
        let (p, out) = self.back(s);
        let around = DVec3::new(out.z, 0.0, -out.x);
        let Along { d, around: twist, dn } = profile.along(p);
        let n = profile.normal(p);
        // At a pole, where u has no meaning, any.
        let rho = if p[0] > 0.0 { p[0] } else { 1.0 };
        let turn = around * (rho * self.sweep);
        let rise = upright(d, out) + around * twist;
        let normal = |d: DVec3| self.inverse.normal_by_inverse(d).as_vec3();
        let long = normal(upright(n, out));
        // The direction away from the axis turns with what moves about it.
        let dndu = around * (n[0] * self.sweep);
        let dndv = upright(dn, out) + around * (n[0] * twist / rho);
        Tangents {
            dpdu: self.map.vector(turn).as_vec3(),
            dpdv: self.map.vector(rise).as_vec3(),
            dndu: unit_change(long, normal(dndu)),
            dndv: unit_change(long, normal(dndv)),
        }
    }

    /// The integral of the map's stretch over the curve and the turn, by Gauss and Legendre.
    fn area(&self) -> Option<f32> {
        let profile = self.curve.profile();
        let mut sum = 0.0;
        for (w, part) in gauss::<8>() {
            let (p, weight) = profile.at(w);
            for (turn, share) in gauss::<16>() {
                sum += part * share * weight * self.stretch(p, profile.out(p, turn * self.sweep));
            }
        }
        Some((sum * self.sweep) as f32)
    }

    fn sample_area(&self, u: [f32; 2]) -> Option<AreaSample> {
        let profile = self.curve.profile();
        let turned = f64::from(u[0]) * self.sweep;
        let (p, weight) = profile.at(f64::from(u[1]));
        let out = profile.out(p, turned);
        let point = self.placed(p, DVec3::new(out.x * p[0], p[1], out.z * p[0]), out, turned);
        Some(AreaSample { point, pdf_area: self.density(p, out, weight) })
    }

    fn pdf_area(&self, s: &SurfacePoint) -> f32 {
        let (p, out) = self.back(s);
        self.density(p, out, self.curve.profile().weight(p))
    }

    #[cfg(test)]
    fn examples(stand: &super::tests::Setting) -> Vec<super::tests::Example> {
        tests::examples(stand)
    }
}

/// Points in [0, 1] and their weights: five of Gauss and Legendre in each of N parts.
pub(super) fn gauss<const N: usize>() -> impl Iterator<Item = (f64, f64)> {
    // Abramowitz & Stegun 1964, table 25.4.
    const NODES: [(f64, f64); 5] = [
        (-0.906_179_845_938_664, 0.236_926_885_056_189),
        (-0.538_469_310_105_683, 0.478_628_670_499_366),
        (0.0, 0.568_888_888_888_889),
        (0.538_469_310_105_683, 0.478_628_670_499_366),
        (0.906_179_845_938_664, 0.236_926_885_056_189),
    ];
    let n = N as f64;
    (0..N).flat_map(move |i| NODES.map(|(x, w)| ((i as f64 + 0.5 + 0.5 * x) / n, 0.5 * w / n)))
}

#[cfg(test)]
mod tests;
