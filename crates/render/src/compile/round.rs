//! Shapes that turn about an axis, on the walk over the world.

use super::build::{Build, Place};
use super::place::{tangents, unit};
use crate::shape::exact::clamped;
use crate::shape::revolved::{self, Frustum, Revolved, Ring, Zone};
use crate::shape::{Disc, Shape};
use straal_math::{Affine, DVec3};
use straal_scene::desc;

impl<'a> Build<'a> {
    /// A surface of revolution whose own space lies so in the node's.
    fn revolved(
        &mut self,
        surface: &'a desc::Surface,
        place: Place,
        own: Affine,
        (curve, phi): (impl Into<revolved::Curve>, [f64; 2]),
    ) {
        let Some(shape) = Revolved::new(&own.then(&place.transform), curve, phi) else {
            return self.leave_out();
        };
        self.shape(surface, place, Shape::Revolved(Box::new(shape)), surface.flip);
    }

    pub(super) fn part_of_sphere(&mut self, s: &'a desc::Sphere, place: Place) {
        let own = Affine::scale(DVec3::splat(s.radius)).then(&Affine::translate(s.center));
        let heights = s.heights.map_or([-1.0, 1.0], |h| h.map(|y| y / s.radius));
        self.revolved(&s.surface, place, own, (Zone::new(heights), s.phi));
    }

    pub(super) fn part_of_cylinder(&mut self, s: &'a desc::Cylinder, place: Place) {
        let own = standing(s.from, s.to, s.radius);
        self.revolved(&s.surface, place, own, (Frustum::new([1.0, 1.0]), s.phi));
    }

    pub(super) fn cone(&mut self, s: &'a desc::Cone, place: Place) {
        let own = standing(s.from, s.to, s.radius);
        let curve = Frustum::new([1.0, s.top_radius / s.radius]);
        self.revolved(&s.surface, place, own, (curve, s.phi));
        if s.caps {
            let (a, b) = tangents(unit(s.to - s.from));
            self.cap(&s.surface, place, [s.from, b * s.radius, a * s.radius]);
            if s.top_radius > 0.0 {
                self.cap(&s.surface, place, [s.to, a * s.top_radius, b * s.top_radius]);
            }
        }
    }

    /// A disc about a center with two half-axes.
    pub(super) fn cap(&mut self, surface: &'a desc::Surface, place: Place, [center, a, b]: [DVec3; 3]) {
        let m = place.transform;
        let (mut a, mut b) = (m.vector(a), m.vector(b));
        if surface.flip != (m.determinant() < 0.0) {
            (a, b) = (b, a);
        }
        let cap = Disc::new(m.point(center).as_vec3(), a.as_vec3(), b.as_vec3());
        self.shape(surface, place, Shape::Disc(Box::new(cap)), false);
    }

    pub(super) fn annulus(&mut self, s: &'a desc::Annulus, place: Place) {
        let own = about(s.center, unit(s.normal), s.radius);
        self.revolved(&s.surface, place, own, (Ring::new(s.inner_radius / s.radius), s.phi));
    }

    pub(super) fn torus(&mut self, s: &'a desc::Torus, place: Place) {
        let own = about(s.center, unit(s.axis), s.radius);
        let curve = revolved::Torus::new(s.tube_radius / s.radius, s.theta);
        self.revolved(&s.surface, place, own, (curve, s.phi));
    }

    pub(super) fn paraboloid(&mut self, s: &'a desc::Paraboloid, place: Place) {
        let own = standing(s.from, s.to, s.radius);
        self.revolved(&s.surface, place, own, (revolved::Paraboloid::new(s.begin), s.phi));
    }

    pub(super) fn hyperboloid(&mut self, s: &'a desc::Hyperboloid, place: Place) {
        let reach = s.line.iter().fold(0.0, |most: f64, p| if p.length() > most { p.length() } else { most });
        let line = s.line.map(|p| p / reach);
        if let Some(curve) = revolved::Hyperboloid::new(line) {
            return self.revolved(&s.surface, place, Affine::scale(DVec3::splat(reach)), (curve, s.phi));
        }
        // It sweeps a flat ring: from where it is next to the axis to its end that is furthest from it.
        let [a, b] = s.line.map(|p| DVec3::new(p.x, 0.0, p.z));
        let way = b - a;
        let nearest = clamped(-a.dot(way) / way.dot(way), 0.0, 1.0);
        let inner = (a + way * nearest).length();
        let outer = if a.length() > b.length() { a.length() } else { b.length() };
        let own = about(DVec3::new(0.0, s.line[0].y, 0.0), DVec3::Y, outer);
        self.revolved(&s.surface, place, own, (Ring::new(inner / outer), s.phi));
    }

    pub(super) fn capsule(&mut self, s: &'a desc::Capsule, place: Place) {
        let length = (s.to - s.from).length();
        let own = standing(s.from, s.to, length);
        let radii = [s.radius, s.end_radius.unwrap_or(s.radius)].map(|r| r / length);
        self.revolved(&s.surface, place, own, (revolved::Capsule::new(radii), desc::WHOLE_TURN));
    }
}

/// From a space in which a shape stands on the origin along y, 1 high, with a radius of 1.
pub(super) fn standing(from: DVec3, to: DVec3, radius: f64) -> Affine {
    let axis = to - from;
    let (a, b) = tangents(unit(axis));
    columns(b * radius, axis, a * radius, from)
}

/// From a space in which a shape lies about the origin and y, with a radius of 1.
fn about(center: DVec3, axis: DVec3, radius: f64) -> Affine {
    let (a, b) = tangents(axis);
    columns(b * radius, axis * radius, a * radius, center)
}

fn columns(x: DVec3, y: DVec3, z: DVec3, o: DVec3) -> Affine {
    Affine { rows: [[x.x, y.x, z.x, o.x], [x.y, y.y, z.y, o.y], [x.z, y.z, z.z, o.z]] }
}
