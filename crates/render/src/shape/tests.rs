//! Every shape against the contract: a registry of shapes at many scales, each with the equation of its surface.

use straal_math::{Affine, Frame, ops};

use super::*;

/// SplitMix64 (Steele, Lea & Flood 2014): random numbers for tests, from a fixed seed.
pub(crate) struct Rng(pub u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn f(&mut self) -> f32 {
        (self.next() >> 40) as f32 * (1.0 / (1u64 << 24) as f32)
    }

    pub fn square(&mut self) -> [f32; 2] {
        [self.f(), self.f()]
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> Vec3 {
        sampling::sphere(self.square()).as_vec3()
    }

    /// Uniform in [-1, 1]³.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.f(), self.f(), self.f()) * 2.0 - Vec3::ONE
    }
}

/// An equation f(p) = 0 of a surface, as f and its gradient.
type Equation = Box<dyn Fn(DVec3) -> (f64, DVec3)>;

/// Where the shapes under test stand.
pub(crate) struct Setting {
    /// Somewhere in the middle.
    pub center: Vec3,
    /// How large.
    pub scale: f32,
    /// Two directions that aren't parallel.
    pub a: Vec3,
    pub b: Vec3,
    /// Brings shapes of size 1 about the origin there, turned and stretched.
    pub map: Affine,
}

/// A shape with its equation.
pub(crate) struct Example {
    name: &'static str,
    shape: Shape,
    equation: Equation,
}

impl Example {
    pub fn new(name: &'static str, shape: Shape, equation: impl Fn(DVec3) -> (f64, DVec3) + 'static) -> Self {
        Self { name, shape, equation: Box::new(equation) }
    }

    /// One in the plane through `c`.
    pub fn flat(name: &'static str, shape: Shape, c: Vec3, n: DVec3) -> Self {
        let n = n.try_normalize().unwrap();
        Self::new(name, shape, move |p| ((p - c.as_dvec3()).dot(n), n))
    }
}

struct Case {
    name: String,
    geometry: Geometry,
    equation: Equation,
    /// Somewhere near the middle.
    center: Vec3,
    /// Its size.
    reach: f32,
}

/// Every kind of shape in the list, at scales from a millimetre to a hundred kilometres, at the origin and away from it.
fn cases() -> Vec<Case> {
    let mut rng = Rng(1);
    let mut out = vec![];
    for scale in [1e-3_f32, 0.03, 1.0, 50.0, 1e5] {
        for away in [0.0_f32, 3.0, 300.0] {
            let center = rng.cube() * (scale * away);
            let (a, b) = (rng.direction() * scale, rng.direction() * (scale * 0.7));
            let (sin, turn) = (0.3 + rng.f(), rng.direction().as_dvec3());
            let map = Affine::scale(DVec3::new(1.0, f64::from(sin), 0.2) * f64::from(scale))
                .then(&Affine::rotate(turn, 77.0).unwrap())
                .then(&Affine::translate(center.as_dvec3()));
            for (kind, examples) in registry(&Setting { center, scale, a, b, map }) {
                assert!(scale != 1.0 || !examples.is_empty(), "{kind} has no example");
                for Example { name, shape, equation } in examples {
                    // Rust's own name of the variant.
                    assert!(format!("{shape:?}").starts_with(kind), "{name} is no {kind}");
                    let name = format!("{name}, scale {scale}, {away} away");
                    let geometry = Geometry { shapes: vec![shape], ..Geometry::default() };
                    out.push(Case { name, geometry, equation, center, reach: scale });
                }
            }
        }
    }
    out
}

impl Case {
    /// Random rays at the shape, with directions of any length; those that hit.
    fn hits(&self, count: usize) -> Vec<(Ray, ShapeHit, SurfacePoint)> {
        let mut rng = Rng(7);
        let mut out = vec![];
        for _ in 0..count * 40 {
            let far = [0.5, 1.5, 10.0, 1000.0][(rng.f() * 4.0) as usize];
            let o = self.center + rng.direction() * (self.reach * far);
            let d = (self.center + rng.cube() * self.reach - o) * (10.0 * rng.f() + 0.01);
            let ray = Ray::new(o, d);
            if let Some(hit) = self.geometry.intersect(0, &ray) {
                out.push((ray, hit, self.geometry.surface(0, &ray, &hit)));
                if out.len() == count {
                    return out;
                }
            }
        }
        assert!(out.len() > count / 10, "{}: only {} rays hit", self.name, out.len());
        out
    }

    fn is_flat(&self) -> bool {
        match &self.geometry.shapes[0] {
            Shape::Plane(_) | Shape::Disc(_) | Shape::Parallelogram(_) => true,
            Shape::Revolved(s) => s.is_flat(),
            _ => false,
        }
    }

    /// Whether a line may meet it more than twice, or its outside twice.
    fn is_hollow(&self) -> bool {
        matches!(self.geometry.shapes[0], Shape::Revolved(_) | Shape::Bilinear(_) | Shape::Curve(_))
            && !self.is_flat()
    }

    fn is_closed(&self) -> bool {
        matches!(self.geometry.shapes[0], Shape::Sphere(_) | Shape::Ellipsoid(_))
    }

    /// Whether the surface passes through the error box of a point (the 1e-3 covers the gradient's own change).
    fn assert_on_surface(&self, s: &SurfacePoint) {
        let (f, gradient) = (self.equation)(s.p.as_dvec3());
        let bound = gradient.abs().dot(s.p_err.as_dvec3()) * 1.001;
        assert!(f.abs() <= bound, "{}: off by {f:e}, bound {bound:e}, {s:?}", self.name);
        let n = gradient.normalize();
        // The normal is that of the point before rounding; no shape here curves within a thirtieth of its reach.
        let turn = 1e-6 + 30.0 * f64::from(s.p_err.length() / self.reach);
        assert!((n - s.ng.as_dvec3()).length() < turn, "{}: normal {:?} against {n:?}", self.name, s.ng);
        let t = self.geometry.tangents(0, s);
        assert!(t.dpdu.is_finite() && t.dpdu != Vec3::ZERO, "{}: {t:?}", self.name);
        for tangent in [t.dpdu, t.dpdv] {
            let along = tangent.normalize().dot(s.ng).abs();
            assert!(
                along < 1e-5 + 3.0 * turn as f32,
                "{}: {tangent:?} leaves the surface by {along}",
                self.name
            );
        }
    }
}

#[test]
fn points_lie_on_the_surface_within_their_error() {
    for case in cases() {
        for (ray, hit, s) in case.hits(300) {
            case.assert_on_surface(&s);
            // The bound is tight: a few units in the last place of the shape's coordinates.
            let size = case.center.abs().max_element() + 2.0 * case.reach;
            let size = if s.p.abs().max_element() > size { s.p.abs().max_element() } else { size };
            assert!(s.p_err.max_element() <= size * 2.0 * f32::EPSILON, "{}: {s:?}", case.name);
            // And it is where the ray says, up to the rounding of t.
            let slip = (ray.at(hit.t) - s.p).length();
            let way = ray.d.length() * hit.t + ray.o.length();
            let cos = ray.d.normalize().dot(s.ng).abs();
            assert!(slip <= 4.0 * f32::EPSILON * way / cos, "{}: slipped {slip}", case.name);
        }
    }
}

/// From a hit to one close by, point and normal move by what the texture coordinates move, times the tangents.
#[test]
fn tangents_are_the_change_with_texture_coordinates() {
    for case in cases() {
        let mut tried = 0;
        for (ray, _, s) in case.hits(300) {
            // Away from the poles of balls, where u turns quickly, and where single precision tells points and t apart.
            let step = case.reach * 1e-3;
            let near = Ray { o: ray.o + Frame::from_normal(s.ng).s * step, ..ray };
            let Some(hit) = case.geometry.intersect(0, &near) else { continue };
            let other = case.geometry.surface(0, &near, &hit);
            let moved = other.p - s.p;
            let t = case.geometry.tangents(0, &s);
            let duv = [0, 1].map(|k| other.uv[k] - s.uv[k]);
            let rounding = 4.0 * f32::EPSILON * (s.p.length() + case.center.length() + ray.o.length());
            if moved.length() > 3.0 * step
                || duv[1].abs() > 0.5
                || !case.is_flat() && (duv[0].abs() > 1e-3 || case.is_closed() && duv[1].abs() > 1e-3)
                || rounding > 0.02 * step
            {
                continue;
            }
            tried += 1;
            let off = (t.dpdu * duv[0] + t.dpdv * duv[1] - moved).length();
            assert!(off < 0.05 * moved.length() + rounding, "{}: {t:?} {duv:?} {moved:?}", case.name);
            let turned = other.n - s.n;
            let off = (t.turn(duv) - turned).length();
            assert!(off < 0.1 * turned.length() + 1e-4, "{}: {t:?} {duv:?} {turned:?}", case.name);
            // And back: the coordinates of the step.
            let back = t.coordinates(moved);
            let scale =
                t.dpdu.length() * (back[0] - duv[0]).abs() + t.dpdv.length() * (back[1] - duv[1]).abs();
            assert!(scale < 0.2 * moved.length() + 4.0 * rounding, "{}: {back:?} {duv:?}", case.name);
        }
        assert!(tried > 50 || case.center.length() > 50.0 * case.reach, "{}: {tried}", case.name);
    }
}

#[test]
fn sampled_points_lie_on_the_surface_within_their_error() {
    let mut rng = Rng(3);
    for case in cases() {
        for _ in 0..200 {
            if let Some(s) = case.geometry.sample_area(0, rng.square()) {
                case.assert_on_surface(&s.point);
            }
        }
    }
}

#[test]
fn bounds_hold_the_shape() {
    let mut rng = Rng(4);
    for case in cases() {
        let Some(bounds) = case.geometry.bounds(0) else { continue };
        assert!(bounds.is_finite());
        let (mut low, mut high) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
        if case.geometry.area(0).is_none() {
            assert!(case.hits(300).iter().all(|(.., s)| bounds.contains(s.p)), "{}: {bounds:?}", case.name);
            continue;
        }
        for _ in 0..20_000 {
            let p = case.geometry.sample_area(0, rng.square()).unwrap().point.p;
            assert!(bounds.contains(p), "{}: {p:?} outside {bounds:?}", case.name);
            (low, high) = (low.min(p), high.max(p));
        }
        // No more than the sampling leaves open (the corners of a parallelogram are hit worst).
        let slack = (low - bounds.min).max(bounds.max - high).max_element();
        assert!(slack <= 0.03 * bounds.extent().max_element(), "{}: {slack} too large", case.name);
    }
}

#[test]
fn the_nearest_hit_is_found_and_the_interval_respected() {
    let mut rng = Rng(5);
    for case in cases() {
        for _ in 0..300 {
            let Some(target) = case.geometry.sample_area(0, rng.square()) else { break };
            let o = case.center + rng.direction() * (case.reach * 5.0);
            let d = (target.point.p - o) * (0.1 + rng.f());
            let want = (target.point.p - o).length() / d.length();
            let cos = d.normalize().dot(target.point.ng);
            if cos.abs() < 1e-2 {
                continue; // the target's own rounding decides
            }
            let ray = Ray::new(o, d);
            let hit = case.geometry.intersect(0, &ray);
            let rounding = 100.0 * f32::EPSILON * (1.0 + o.length() / case.reach);
            // Near the rim of open shapes the target's rounding decides too.
            let Some(hit) = hit else { continue };
            assert!(hit.t <= want * (1.0 + rounding), "{}: {} beyond {want}", case.name, hit.t);
            if case.is_flat() || cos < 0.0 && case.is_closed() {
                assert!(hit.t >= want * (1.0 - rounding), "{}: {} before {want}", case.name, hit.t);
            }
            for (t_min, t_max) in [(hit.t.next_up(), f32::INFINITY), (0.0, hit.t.next_down())] {
                let again = case.geometry.intersect(0, &Ray { t_min, t_max, ..ray });
                assert!(again.is_none_or(|h| h.t >= t_min && h.t <= t_max && h.t != hit.t), "{}", case.name);
            }
            let exactly = Ray { t_min: hit.t, t_max: hit.t, ..ray };
            assert_eq!(case.geometry.intersect(0, &exactly), Some(hit), "{}", case.name);
        }
    }
}

#[test]
fn most_rays_at_sampled_points_hit() {
    let mut rng = Rng(6);
    for case in cases() {
        let mut missed = 0;
        for _ in 0..500 {
            let Some(target) = case.geometry.sample_area(0, rng.square()) else { break };
            let o = case.center + rng.direction() * (case.reach * 5.0);
            let d = target.point.p - o;
            if d.normalize().dot(target.point.ng).abs() > 0.05 {
                missed += u32::from(case.geometry.intersect(0, &Ray::new(o, d)).is_none());
            }
        }
        // Only targets within rounding of a rim may be missed.
        assert!(missed <= 2, "{}: {missed} of 500 missed", case.name);
    }
}

#[test]
fn rays_that_leave_do_not_hit_what_they_leave() {
    let mut rng = Rng(8);
    for case in cases() {
        for (_, _, s) in case.hits(200) {
            for _ in 0..4 {
                // Lengths and grazing angles of all sizes.
                let tilt = [1.0, 1e-2, 1e-4][(rng.f() * 3.0) as usize];
                let w = rng.direction();
                let along = w - s.ng * (w.dot(s.ng) * (1.0 - tilt));
                let w = along * (0.01 + 10.0 * rng.f());
                let cos = w.normalize().dot(s.ng);
                if cos.abs() < 1e-5 {
                    continue; // the normal's own rounding decides
                }
                let ray = Ray::new(offset_origin(s.p, s.p_err, s.ng, w), w);
                if let Some(hit) = case.geometry.intersect(0, &ray) {
                    // Inside a round shape the far wall is hit, from inside.
                    let there = case.geometry.surface(0, &ray, &hit);
                    let leaves = w.dot(there.ng) > 0.0;
                    if case.is_hollow() && (hit.t * w.length() > 1e-2 * case.reach || leaves == (cos < 0.0)) {
                        continue; // another part of it, from the side that is between
                    }
                    assert!(!case.is_flat() && cos < 0.0 && leaves, "{}: {s:?} {w:?} {hit:?}", case.name);
                }
            }
        }
    }
}

#[test]
fn rays_between_surfaces_see_neither() {
    let mut rng = Rng(9);
    let cases = cases();
    let mut tried = 0;
    let kind = |case: &Case| case.name.split(',').next().map(str::to_owned);
    for (i, a) in cases.iter().enumerate() {
        // The same shape elsewhere.
        let Some(b) = cases[i + 1..].iter().find(|b| kind(b) == kind(a)) else { continue };
        for (one, other) in [(a, a), (a, b), (b, a)] {
            if one.is_hollow() || other.is_hollow() || a.is_flat() && std::ptr::eq(one, other) {
                continue;
            }
            for _ in 0..100 {
                let (Some(s), Some(t)) =
                    (one.geometry.sample_area(0, rng.square()), other.geometry.sample_area(0, rng.square()))
                else {
                    continue;
                };
                let (s, t) = (s.point, t.point);
                let w = t.p - s.p;
                // Seen edge-on, the pushes themselves turn the ray through the surface.
                let edge_on = w.normalize().dot(s.ng).abs() < 1e-2 || w.normalize().dot(t.ng).abs() < 1e-2;
                if edge_on || !w.is_finite() || w == Vec3::ZERO {
                    continue;
                }
                let ray = ray_between(&(&s).into(), &(&t).into());
                // Convex shapes that face each other, and chords of one shape, are in nobody's way.
                let chord = std::ptr::eq(one, other);
                let facing = w.dot(s.ng) > 0.0 && w.dot(t.ng) < 0.0;
                if chord || facing || one.is_flat() {
                    for case in [one, other] {
                        let hit = case.geometry.intersect(0, &ray);
                        assert_eq!(hit, None, "{} to {}: {ray:?} {s:?} {t:?}", one.name, other.name);
                        tried += 1;
                    }
                }
            }
        }
    }
    assert!(tried > 10_000, "{tried}");
}

#[test]
fn rays_that_leave_an_instance_do_not_hit_it_again() {
    let mut rng = Rng(10);
    for i in 0..200 {
        let away = [0.0, 10.0, 1e4][i % 3];
        let m = Affine::scale(DVec3::new(0.3, 2.0, 40.0))
            .then(&Affine::rotate(rng.direction().as_dvec3(), 50.0).unwrap())
            .then(&Affine::translate(rng.cube().as_dvec3() * away));
        let m = Transform::new(&m).unwrap();
        let sphere = Sphere { center: rng.cube() * 3.0, radius: 0.1 + rng.f() };
        for _ in 0..50 {
            let local = sphere.sample_area(rng.square()).point;
            let s = local.to_world(&m);
            let w = rng.direction();
            if w.dot(s.ng) < 1e-3 {
                continue;
            }
            let ray = Ray::new(offset_origin(s.p, s.p_err, s.ng, w), w);
            let hit = sphere.analytic().intersect(&m.inverse_ray(&ray));
            assert_eq!(hit, None, "{s:?} {w:?}");
        }
    }
}

/// Mean of `f` over `n` random points of the unit square, with its standard error.
pub(crate) fn monte_carlo(seed: u64, n: u32, mut f: impl FnMut([f32; 2]) -> f64) -> (f64, f64) {
    let mut rng = Rng(seed);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..n {
        let x = f(rng.square());
        sum += x;
        squares += x * x;
    }
    let n = f64::from(n);
    let mean = sum / n;
    (mean, ((squares / n - mean * mean).abs() / n).sqrt())
}

/// Within five standard errors, or single-precision rounding.
pub(crate) fn assert_agrees(what: &str, (mean, error): (f64, f64), want: f64) {
    let off = (mean - want).abs();
    assert!(off <= 5.0 * error + 3e-6 * want.abs(), "{what}: {mean} ± {error}, expected {want}");
}

#[test]
fn areas_are_what_sampling_integrates_to() {
    for case in cases() {
        let Some(area) = case.geometry.area(0) else { continue };
        let sum = monte_carlo(11, 4000, |u| {
            case.geometry.sample_area(0, u).map_or(0.0, |s| 1.0 / f64::from(s.pdf_area))
        });
        assert_agrees(&case.name, sum, f64::from(area));
    }
}

#[test]
fn a_point_inside_a_closed_shape_sees_it_all_around() {
    // The solid angle, by area: needs the true density of the points, not only the pdf that goes with them.
    for case in cases() {
        if !case.is_closed() {
            continue;
        }
        let (c, _) = (case.center.as_dvec3(), ());
        let p = c + (case.geometry.sample_area(0, [0.3, 0.4]).unwrap().point.p.as_dvec3() - c) * 0.3;
        let sum = monte_carlo(12, 40_000, |u| {
            let s = case.geometry.sample_area(0, u).unwrap();
            let d = s.point.p.as_dvec3() - p;
            d.dot(s.point.ng.as_dvec3()) / (d.length() * d.dot(d) * f64::from(s.pdf_area))
        });
        assert_agrees(&case.name, (sum.0, sum.1 + 1e-4), 4.0 * std::f64::consts::PI);
    }
}

#[test]
fn densities_of_directions_are_those_that_are_sampled() {
    // The integral of min(pdf, K) over all directions is the mean of min(1, K / pdf) over sampled ones: with K no
    // tails (a pdf by area is unbounded where a surface is seen edge-on), and with K large the integral is 1.
    for case in cases() {
        if case.geometry.area(0).is_none() {
            continue;
        }
        let inside = case.center + Vec3::new(0.02, 0.01, 0.03) * case.reach;
        let outside = case.center + Vec3::new(0.8, 1.1, -0.7) * case.reach;
        for p in [inside, outside] {
            for k in [1.0, 20.0] {
                let sampled = monte_carlo(15, 20_000, |u| {
                    let s = case.geometry.sample_from(0, p, u);
                    s.map_or(0.0, |s| if s.pdf > k { f64::from(k / s.pdf) } else { 1.0 })
                });
                let (mean, error) = monte_carlo(13, 40_000, |u| {
                    let mut ray = Ray::new(p, sampling::sphere(u).as_vec3());
                    let mut sum = 0.0;
                    // Every crossing: points are sampled by area on the far side as well.
                    while let Some(hit) = case.geometry.intersect(0, &ray) {
                        let s = case.geometry.surface(0, &ray, &hit);
                        let pdf = case.geometry.pdf_from(0, p, &s);
                        sum += f64::from(if pdf < k { pdf } else { k });
                        if p == outside && case.is_closed() {
                            break; // sampled by solid angle: one density a direction
                        }
                        ray.t_min = hit.t.next_up();
                    }
                    sum * 4.0 * std::f64::consts::PI
                });
                let name = format!("{} from {p:?}, up to {k}", case.name);
                assert_agrees(&name, (mean, error + sampled.1 + 1e-4), sampled.0);
            }
        }
    }
}

#[test]
fn sampled_directions_carry_the_density_that_is_told_of_them() {
    let mut rng = Rng(14);
    for case in cases() {
        for far in [0.05, 1.5, 30.0] {
            let p = case.center + rng.direction() * (case.reach * far);
            for _ in 0..100 {
                let Some(s) = case.geometry.sample_from(0, p, rng.square()) else { continue };
                assert!((s.wi.length() - 1.0).abs() < 1e-6);
                case.assert_on_surface(&s.point);
                let way = s.point.p - p;
                let cos = s.wi.dot(s.point.ng).abs();
                if cos < 0.02 || way.length() < 1e-3 * case.reach {
                    continue; // rounding of the point decides
                }
                // The direction ends at the point, up to that point's rounding.
                let rounding = (s.point.p_err + p.abs() * f32::EPSILON).length() / way.length();
                assert!((way.normalize() - s.wi).length() < 1e-5 + 4.0 * rounding / cos, "{}", case.name);
                let told = case.geometry.pdf_from(0, p, &s.point);
                assert!(
                    (told - s.pdf).abs() <= s.pdf * (1e-4 + 8.0 * rounding / cos),
                    "{}: {told} against {}",
                    case.name,
                    s.pdf
                );
            }
        }
    }
}

#[test]
fn spheroids_have_their_closed_form_area() {
    let pi = std::f64::consts::PI;
    let turn = Affine::rotate(DVec3::new(1.0, 2.0, 3.0), 40.0).unwrap();
    for (a, c) in [(1.0, 3.0), (1.0, 1000.0), (2.0, 0.5), (3.0, 1e-4), (2.0, 2.0), (1e-3, 1e-3)] {
        let map = Affine::scale(DVec3::new(a, a, c)).then(&turn);
        let area = f64::from(Ellipsoid::new(map).unwrap().area());
        let (a, c): (f64, f64) = (a, c);
        let want = if c > a {
            let e = (1.0 - a * a / (c * c)).sqrt();
            2.0 * pi * a * a * (1.0 + c / (a * e) * (0.5 * pi - ops::acos_d(e)))
        } else if c < a {
            let e = (1.0 - c * c / (a * a)).sqrt();
            2.0 * pi * a * a * (1.0 + (1.0 - e * e) / e * 0.5 * ops::ln_d((1.0 + e) / (1.0 - e)))
        } else {
            4.0 * pi * a * a
        };
        assert!((area / want - 1.0).abs() < 1e-6, "a {a}, c {c}: {area}, expected {want}");
    }
}

#[test]
fn round_cylinders_have_their_closed_form_area_and_point_outwards() {
    let (from, to) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 4.0, 5.0));
    let c = Cylinder::between(from, to, 0.25).unwrap();
    assert!((f64::from(c.area()) / (2.0 * std::f64::consts::PI * 0.25 * 3.0) - 1.0).abs() < 1e-6);
    let s = c.sample_area([0.3, 0.5]).point;
    let (p, axis) = (s.p.as_dvec3(), (to - from).normalize());
    let out = p - from - axis * (p - from).dot(axis);
    assert!((out.length() - 0.25).abs() < 1e-6);
    assert!((out.normalize() - s.ng.as_dvec3()).length() < 1e-5);
    assert!(Cylinder::between(from, from, 1.0).is_none());
    assert!(Cylinder::between(from, to, f64::NAN).is_none());
}

#[test]
fn strange_rays_and_shapes_miss() {
    let nan = f32::NAN;
    let shapes = vec![
        Shape::Sphere(Sphere { center: Vec3::splat(nan), radius: 1.0 }),
        Shape::Sphere(Sphere { center: Vec3::ZERO, radius: nan }),
        Shape::Disc(Box::new(Disc::new(Vec3::ZERO, Vec3::X, Vec3::X))),
        Shape::Parallelogram(Box::new(Parallelogram::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO))),
        Shape::Plane(Plane { point: Vec3::ZERO, normal: Vec3::ZERO }),
    ];
    let geometry = Geometry { shapes, ..Geometry::default() };
    for shape in 0..geometry.shapes.len() as u32 {
        assert_eq!(geometry.intersect(shape, &Ray::new(Vec3::new(0.1, 0.2, 5.0), -Vec3::Z)), None);
        assert!(geometry.sample_area(shape, [0.5; 2]).is_none_or(|s| s.pdf_area > 0.0));
    }
    for case in cases() {
        for ray in [
            Ray::new(Vec3::splat(nan), Vec3::X),
            Ray::new(case.center, Vec3::splat(nan)),
            Ray::new(case.center, Vec3::ZERO),
            Ray { t_min: nan, ..Ray::new(case.center, Vec3::X) },
            Ray { t_max: nan, ..Ray::new(case.center, Vec3::X) },
        ] {
            assert_eq!(case.geometry.intersect(0, &ray), None, "{} {ray:?}", case.name);
        }
    }
}
