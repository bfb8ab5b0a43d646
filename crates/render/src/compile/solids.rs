//! Combinations of solids, distance fields, curves and patches, on the walk over the world.

use std::sync::Arc;

use super::build::{Build, Place};
use crate::shape::curve::{Curve, Section, Space};
use crate::shape::field::Field;
use crate::shape::field::distance::{Body, Grid, Mix};
use crate::shape::part::{Face, Leaf, Part, Solid, Step};
use crate::shape::revolved::{self, Revolved};
use crate::shape::{Bilinear, Geometry, Shape};
use crate::world::{GeometryRecord, Kind};
use straal_accel as accel;
use straal_math::{Affine, Bounds, DVec3, Vec3};
use straal_scene::desc::{self, CurveBasis, CurveForm, Distance, Node};

/// The leaves of a combination that were made so far.
#[derive(Default)]
struct Leaves {
    leaves: Vec<Leaf>,
    steps: Vec<Step>,
    /// What each of a leaf's faces is like, by leaf.
    records: Vec<Vec<GeometryRecord>>,
}

impl<'a> Build<'a> {
    pub(super) fn combination(&mut self, node: &'a Node, place: Place) {
        let Some(flip) = node.surface().map(|s| s.flip) else { return };
        let mut all = Leaves::default();
        let Some(within) = self.solid(node, place, &mut all) else { return self.leave_out() };
        let Some(solid) = Solid::new(all.leaves, all.steps) else { return self.leave_out() };
        let solid = Arc::new(solid);
        self.node = Some(node);
        for (leaf, records) in all.records.into_iter().enumerate() {
            for (face, record) in records.into_iter().enumerate() {
                if let Some(part) = Part::new(solid.clone(), leaf as u32, face as u32, within) {
                    let shape = Shape::Part(Box::new(part));
                    let GeometryRecord { material, placement, .. } = record;
                    let own = self.add_shape(shape, place, material, flip);
                    self.geometries.push(GeometryRecord { placement, ..own });
                }
            }
        }
    }

    /// A solid that is part of a combination: adds its leaves, and the steps that tell whether a point is in it; gives a box around it.
    /// `place` is that of the node's own coordinates. `None` where it can't be made.
    fn solid(&mut self, node: &'a Node, place: Place, all: &mut Leaves) -> Option<Bounds> {
        let (of, step): (_, fn(u32) -> Step) = match node {
            Node::Union(c) => (&c.of, Step::Any),
            Node::Intersection(c) => (&c.of, Step::All),
            Node::Difference(c) => (&c.of, Step::Without),
            Node::Group(g) => (&g.children, Step::Any),
            leaf => return self.leaf(leaf, place, all),
        };
        let inside = Place { material: self.materials.of(node.material(), place.material), ..place };
        let mut bounds: Option<Bounds> = None;
        for child in of {
            let transform = child.placement().map_or(inside.transform, |own| own.then(&inside.transform));
            let one = self.solid(child, Place { transform, ..inside }, all)?;
            bounds = Some(match (bounds, node) {
                (None, _) => one,
                (Some(b), Node::Intersection(_)) => b.intersection(one),
                (Some(b), Node::Difference(_)) => b,
                (Some(b), _) => b.union(one),
            });
        }
        all.steps.push(step(of.len() as u32));
        bounds
    }

    /// A solid that isn't made of others: what its node becomes in a world of its own.
    fn leaf(&mut self, node: &'a Node, place: Place, all: &mut Leaves) -> Option<Bounds> {
        let geometry = std::mem::take(&mut self.geometry);
        let input = std::mem::take(&mut self.input);
        let (records, nodes) = (std::mem::take(&mut self.geometries), std::mem::take(&mut self.nodes));
        let (left_out, glowing) = (self.left_out.len(), self.glowing.len());
        let linked = self.linked.geometries.len();
        self.input.groups.push(accel::Group::default());
        self.one_shape(node, Place { group: 0, ..place });
        let geometry = std::mem::replace(&mut self.geometry, geometry);
        let input = std::mem::replace(&mut self.input, input);
        let records = std::mem::replace(&mut self.geometries, records);
        self.nodes = nodes;
        self.linked.geometries.truncate(linked);
        // Nothing in a combination shines.
        self.glowing.truncate(glowing);
        if self.left_out.len() > left_out || records.is_empty() {
            self.left_out.truncate(left_out);
            return None;
        }
        let face = |r: &GeometryRecord| match r.kind {
            Kind::Shapes(i) => Face::Shape(i),
            Kind::Mesh(i) => Face::Mesh(i),
        };
        let faces: Vec<_> = records.iter().map(face).collect();
        let bounds = bounds(&geometry, &faces);
        all.leaves.push(Leaf::new(geometry, input, faces).ok()?);
        all.steps.push(Step::Leaf(all.records.len() as u32));
        all.records.push(records);
        Some(bounds)
    }

    pub(super) fn distance_field(&mut self, s: &'a desc::DistanceField, place: Place) {
        let field = body(&s.of).and_then(|body| Field::new(place.transform, Arc::new(body)));
        let Some(field) = field else { return self.leave_out() };
        self.shape(&s.surface, place, Shape::Field(Box::new(field)), s.surface.flip);
    }

    pub(super) fn bilinear(&mut self, s: &'a desc::Bilinear, place: Place) {
        let m = place.transform;
        // A mirror image has its front where the patch had it.
        let turned = s.surface.flip != (m.determinant() < 0.0);
        let order = if turned { [0, 2, 1, 3] } else { [0, 1, 2, 3] };
        let patch = Bilinear::new(order.map(|i| m.point(s.corners[i])), order.map(|i| s.uvs[i]));
        self.shape(&s.surface, place, Shape::Bilinear(Box::new(patch)), false);
    }

    pub(super) fn curves(&mut self, s: &'a desc::Curves, place: Place) {
        if s.basis == CurveBasis::Linear && s.form == CurveForm::Round {
            return self.round_segments(s, place);
        }
        let Some(space) = Space::new(place.transform) else { return self.leave_out() };
        let space = Arc::new(space);
        let mut normals = s.normals.iter();
        for run in s.runs() {
            let Some(pieces) = s.pieces(run.len()) else { continue };
            let mut before = normals.next().copied();
            for i in 0..pieces {
                let after = normals.next().copied();
                let section = match (&s.form, before, after) {
                    (CurveForm::Round, ..) => Section::Round,
                    (CurveForm::Ribbon, Some(a), Some(b)) => Section::Ribbon([a, b]),
                    _ => Section::Flat,
                };
                before = after;
                let (points, radii) = piece(s, &run, i);
                let along = [i, i + 1].map(|k| k as f64 / pieces as f64);
                let curve = Curve::new(space.clone(), points, radii, along, section);
                self.in_parts(curve.worthwhile_halvings(), curve, s, place);
            }
        }
    }

    fn in_parts(&mut self, halvings: u32, curve: Curve, s: &'a desc::Curves, place: Place) {
        if halvings == 0 {
            return self.shape(&s.surface, place, Shape::Curve(Box::new(curve)), s.surface.flip);
        }
        for half in curve.halves() {
            self.in_parts(halvings - 1, half, s, place);
        }
    }

    /// Straight pieces with balls at their points.
    fn round_segments(&mut self, s: &'a desc::Curves, place: Place) {
        for run in s.runs() {
            for i in run.start..run.end.saturating_sub(1) {
                let (Some(&from), Some(&to)) = (s.points.get(i), s.points.get(i + 1)) else { continue };
                let radii = [radius(s, &run, i), radius(s, &run, i + 1)];
                let length = (to - from).length();
                let shape = if (radii[0] - radii[1]).abs() < length {
                    let own = super::round::standing(from, to, length).then(&place.transform);
                    let curve = revolved::Capsule::new(radii.map(|r| r / length));
                    Revolved::new(&own, curve, desc::WHOLE_TURN)
                } else {
                    // The larger ball holds the other.
                    let (c, r) = if radii[0] > radii[1] { (from, radii[0]) } else { (to, radii[1]) };
                    let own =
                        Affine::scale(DVec3::splat(r)).then(&Affine::translate(c)).then(&place.transform);
                    Revolved::new(&own, revolved::Zone::new([-1.0, 1.0]), desc::WHOLE_TURN)
                };
                let Some(shape) = shape else { continue };
                self.shape(&s.surface, place, Shape::Revolved(Box::new(shape)), s.surface.flip);
            }
        }
    }
}

/// A box around all of a leaf's faces.
fn bounds(geometry: &Geometry, faces: &[Face]) -> Bounds {
    faces.iter().fold(Bounds::EMPTY, |all, face| match face {
        Face::Shape(i) => geometry.bounds(*i).map_or(all, |b| all.union(b)),
        Face::Mesh(i) => geometry.meshes[*i as usize].positions.iter().fold(all, |all, p| all.with_point(*p)),
    })
}

/// A curve's radius at one of its points.
fn radius(s: &desc::Curves, run: &std::ops::Range<usize>, i: usize) -> f64 {
    match s.radii.as_slice() {
        [all] => *all,
        [first, last] if s.points.len() != 2 => {
            let part = (i - run.start) as f64 / (run.len().max(2) - 1) as f64;
            first + (last - first) * part
        }
        each => each.get(i).copied().unwrap_or(0.0),
    }
}

/// A piece of a curve as a cubic Bezier curve, with its radii.
fn piece(s: &desc::Curves, run: &std::ops::Range<usize>, i: usize) -> ([DVec3; 4], [f64; 4]) {
    let point = |k: usize| {
        let p = s.points.get(k).copied().unwrap_or(DVec3::ZERO);
        (p, radius(s, run, k))
    };
    let mix = |parts: &[(usize, f64)]| {
        parts.iter().fold((DVec3::ZERO, 0.0), |(p, r), (k, w)| {
            let (q, radius) = point(*k);
            (p + q * *w, r + radius * w)
        })
    };
    let made = match s.basis {
        CurveBasis::Bezier => [0, 1, 2, 3].map(|k| point(run.start + 3 * i + k)),
        CurveBasis::Linear => {
            let k = run.start + i;
            [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|u| mix(&[(k, 1.0 - u), (k + 1, u)]))
        }
        // Control points of the same piece (by blossoming: the spline's knots are whole numbers).
        CurveBasis::BSpline => {
            let k = run.start + i;
            let (a, b, c) = (1.0 / 6.0, 2.0 / 3.0, 1.0 / 3.0);
            [
                mix(&[(k, a), (k + 1, b), (k + 2, a)]),
                mix(&[(k + 1, b), (k + 2, c)]),
                mix(&[(k + 1, c), (k + 2, b)]),
                mix(&[(k + 1, a), (k + 2, b), (k + 3, a)]),
            ]
        }
    };
    (made.map(|(p, _)| p), made.map(|(_, r)| r))
}

/// What tells a distance. `None` where it can't be made.
fn body(d: &Distance) -> Option<Body> {
    let several = |mix: Mix, b: &desc::Blend| {
        let all = b.of.iter().map(body).collect::<Option<Vec<_>>>()?;
        Some(Body::Several(mix, all, b.smooth))
    };
    Some(match d {
        Distance::Ball(s) => Body::Ball(s.center, s.radius),
        Distance::Box(s) => Body::Box((s.min + s.max) * 0.5, (s.max - s.min) * 0.5),
        Distance::Ring(s) => Body::Ring(s.center, [s.radius, s.tube_radius]),
        Distance::Capsule(s) => Body::Capsule([s.from, s.to], s.radius),
        Distance::Cylinder(s) => Body::Cylinder([s.from, s.to], s.radius),
        Distance::Union(b) => several(Mix::Union, b)?,
        Distance::Intersection(b) => several(Mix::Intersection, b)?,
        Distance::Difference(b) => several(Mix::Difference, b)?,
        Distance::Moved(m) => {
            let map = m.transform.affine()?;
            Body::Moved(Box::new(body(&m.of)?), map, map.inverse()?, desc::even_scale(&map)?)
        }
        Distance::Grown(g) => Body::Grown(Box::new(body(&g.of)?), g.by),
        Distance::Shell(g) => Body::Shell(Box::new(body(&g.of)?), g.by),
        Distance::Ripples(r) => Body::Ripples(Box::new(body(&r.of)?), [r.amplitude, r.wavelength]),
        Distance::Grid(g) => {
            Body::Grid(Grid::new(g.min, g.max, g.size.map(|n| n as usize), g.values.clone())?)
        }
    })
}

/// The vertices of a height field, row by row from -z to +z, as a mesh of triangles that look up.
pub(super) fn height_field(
    [width, depth]: [usize; 2],
    [along, across]: [f64; 2],
    height: impl Fn(usize, usize) -> f64,
) -> crate::shape::TriangleMesh {
    let part = |i: usize, n: usize| i as f64 / (n - 1) as f64;
    let (mut positions, mut uvs, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for j in 0..depth {
        for i in 0..width {
            let (u, v) = (part(i, width), part(j, depth));
            let p = DVec3::new((u - 0.5) * along, height(i, j), (v - 0.5) * across);
            positions.push(p.as_vec3());
            uvs.push([u as f32, 1.0 - v as f32]);
        }
    }
    for j in 0..depth.saturating_sub(1) {
        for i in 0..width.saturating_sub(1) {
            let a = (j * width + i) as u32;
            let (b, c) = (a + 1, a + width as u32);
            indices.extend([[a, c, b], [b, c, c + 1]]);
        }
    }
    let normals: Vec<Vec3> = Vec::new();
    crate::shape::TriangleMesh {
        positions: positions.into(),
        indices: indices.into(),
        normals,
        uvs,
        ..crate::shape::TriangleMesh::default()
    }
}
