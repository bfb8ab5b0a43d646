//! Placing things: steps that are applied in reading order.

use straal_math::{Affine, DVec3};

use crate::desc::check;
use crate::describe::describe;
use crate::span::Span;
use crate::value::{Axis, Factors, Matrix};

/// A list of steps, the first applied first.
#[derive(Clone, Debug, Default)]
pub struct Transform {
    /// The steps in reading order.
    pub steps: Vec<Step>,
    /// The steps at later times while the shutter is open, evenly apart, the last at time 1; `steps` are those at time 0. Empty for what stays.
    pub later: Vec<Vec<Step>>,
    /// Where they were said.
    pub span: Span,
}

impl PartialEq for Transform {
    fn eq(&self, o: &Self) -> bool {
        self.steps == o.steps && self.later == o.later
    }
}

impl Transform {
    /// All steps as one map from local to parent coordinates; `None` when a step has no direction or the whole is
    /// singular.
    pub fn affine(&self) -> Option<Affine> {
        together(&self.steps)
    }

    /// By these steps alone.
    pub fn of(steps: Vec<Step>, span: Span) -> Self {
        Self { steps, later: Vec::new(), span }
    }

    /// What it is at each of its times, from 0 to 1; only itself if it stays.
    pub fn at_times(&self) -> impl Iterator<Item = Self> + '_ {
        std::iter::once(&self.steps).chain(&self.later).map(|steps| Self::of(steps.clone(), self.span))
    }
}

/// Steps as one map, if it has an inverse.
fn together(steps: &[Step]) -> Option<Affine> {
    let mut all = Affine::IDENTITY;
    for step in steps {
        all = all.then(&step.affine()?);
    }
    all.inverse().is_some().then_some(all)
}

/// The turn about `pivot` that brings the direction `front` to `target`, first about the vertical and then up or down, so that what
/// stands upright stays so; `None` when there is no direction.
pub fn facing(pivot: DVec3, front: DVec3, target: DVec3) -> Option<Affine> {
    let (front, wanted) = (front.try_normalize()?, (target - pivot).try_normalize()?);
    let level = |v: DVec3| DVec3::new(v.x, 0.0, v.z).try_normalize();
    let yaw = match (level(front), level(wanted)) {
        (Some(a), Some(b)) => turn(DVec3::Y, a.dot(b), DVec3::Y.dot(a.cross(b))),
        // Straight up or down has no place around the vertical.
        _ => Affine::IDENTITY,
    };
    let front = yaw.vector(front);
    let hinge = level(front).or_else(|| level(wanted)).map_or(DVec3::X, |level| DVec3::Y.cross(level));
    let pitch = turn(hinge, front.dot(wanted), hinge.dot(front.cross(wanted)));
    let around = Affine::translate(-pivot).then(&yaw).then(&pitch);
    Some(around.then(&Affine::translate(pivot)))
}

/// The turn about a unit vector by the angle of that cosine and sine (Rodrigues).
fn turn(axis: DVec3, cos: f64, sin: f64) -> Affine {
    // The two come from rounded unit vectors: together they must be one.
    let length = (cos * cos + sin * sin).sqrt();
    let (c, s) = if length > 0.0 { (cos / length, sin / length) } else { (1.0, 0.0) };
    let DVec3 { x, y, z } = axis;
    let t = 1.0 - c;
    Affine {
        rows: [
            [t * x * x + c, t * x * y - s * z, t * x * z + s * y, 0.0],
            [t * x * y + s * z, t * y * y + c, t * y * z - s * x, 0.0],
            [t * x * z - s * y, t * y * z + s * x, t * z * z + c, 0.0],
        ],
    }
}

describe! {
    /// One step of a transform.
    pub enum Step {
        /// Moves by a vector.
        "translate" => Translate(DVec3),
        /// Turns about an axis through the origin, as in `rotate: { y: 30 }`.
        "rotate" => Rotate(Rotation),
        /// Scales about the origin: one factor, or one for each axis.
        "scale" => Scale(Factors),
        /// Slants one coordinate along another.
        "shear" => Shear(Shear),
        /// Mirrors in a plane.
        "reflect" => Reflect(Reflection),
        /// Puts the origin at `eye`, local -z towards `target` and local y as near to `up` as it can be.
        "look_at" => LookAt(Viewpoint),
        /// Three or four rows of four numbers; the fourth column moves, a fourth row must be `[0, 0, 0, 1]`.
        "matrix" => Matrix(Matrix),
    }
}

impl Step {
    /// The step as a map; `None` when it has no direction.
    pub fn affine(&self) -> Option<Affine> {
        match self {
            Self::Translate(v) => Some(Affine::translate(*v)),
            Self::Rotate(r) => Affine::rotate(r.axis.0, r.degrees),
            Self::Scale(f) => Some(Affine::scale(f.0)),
            Self::Shear(s) => {
                let mut m = Affine::IDENTITY;
                m.rows[s.axis.index()][s.by.index()] += s.factor;
                Some(m)
            }
            Self::Reflect(r) => {
                let n = r.normal.0.try_normalize()?;
                let d = 2.0 * n.dot(r.point);
                let n = n.to_array();
                let cell = |i: usize, j: usize| {
                    if j == 3 { d * n[i] } else { f64::from(u8::from(i == j)) - 2.0 * n[i] * n[j] }
                };
                Some(Affine { rows: std::array::from_fn(|i| std::array::from_fn(|j| cell(i, j))) })
            }
            Self::LookAt(v) => Affine::look_at(v.eye, v.target, v.up),
            Self::Matrix(m) => Some(m.0),
        }
    }
}

/// A turn, counter-clockwise seen from the axis' tip.
#[derive(Clone, Debug, PartialEq)]
pub struct Rotation {
    /// What it turns about.
    pub axis: Axis,
    /// The angle in degrees.
    pub degrees: f64,
}

describe! {
    /// A turn about any axis, counter-clockwise seen from its tip.
    pub struct AxisAngle {
        /// `x`, `y`, `z` or a vector.
        axis: Axis,
        /// The angle in degrees.
        degrees: f64,
    }
}

describe! {
    /// Adds `factor` times the coordinate `by` to the coordinate `axis`.
    pub struct Shear {
        /// The coordinate that changes.
        axis: Coordinate,
        /// The coordinate it changes with.
        by: Coordinate,
        /// How much.
        factor: f64,
    }
}

describe! {
    /// A mirror image in the plane through `point` across `normal`.
    pub struct Reflection {
        /// `x`, `y`, `z` or a vector across the plane.
        normal: Axis,
        /// A point of the plane.
        point: DVec3 = DVec3::ZERO,
    }
}

describe! {
    /// A frame that looks at something.
    pub struct Viewpoint [check::viewpoint] {
        /// Where the origin goes.
        eye: DVec3,
        /// Where local -z points to.
        target: DVec3,
        /// Where local y points to, as far as the view allows.
        up: DVec3 = DVec3::Y,
    }
}

describe! {
    /// One of the three coordinates.
    pub enum Coordinate {
        /// The first.
        "x" => X,
        /// The second.
        "y" => Y,
        /// The third.
        "z" => Z,
    }
}

impl Coordinate {
    /// 0, 1 or 2.
    pub fn index(&self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_faces_something_faces_it_and_stands_upright() {
        let pivot = DVec3::new(1.0, 2.0, 3.0);
        for front in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::Y, -DVec3::Y, DVec3::new(0.3, -0.8, 0.1)] {
            for way in [DVec3::Z, -DVec3::Z, DVec3::Y, -DVec3::Y, DVec3::new(3.0, -1.0, -2.0)] {
                let turned = facing(pivot, front, pivot + way * 2.5).unwrap();
                let found = turned.vector(front.try_normalize().unwrap());
                assert!(
                    (found - way.try_normalize().unwrap()).length() < 1e-12,
                    "{front:?} to {way:?}: {found:?}"
                );
                assert!(
                    (turned.point(pivot) - pivot).length() < 1e-12
                        && (turned.determinant() - 1.0).abs() < 1e-12
                );
            }
        }
        // What looks level at something level keeps its head up.
        let up = facing(DVec3::ZERO, DVec3::Z, DVec3::new(1.0, 0.0, -2.0)).unwrap().vector(DVec3::Y);
        assert!((up - DVec3::Y).length() < 1e-12);
        // What looks up at something leans back, not to a side.
        let side = facing(DVec3::ZERO, DVec3::Z, DVec3::new(1.0, 4.0, -2.0)).unwrap().vector(DVec3::X);
        assert!(side.y.abs() < 1e-12, "{side:?}");
        assert!(facing(pivot, DVec3::Z, pivot).is_none());
    }
}
