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
    /// Where they were said.
    pub span: Span,
}

impl PartialEq for Transform {
    fn eq(&self, o: &Self) -> bool {
        self.steps == o.steps
    }
}

impl Transform {
    /// All steps as one map from local to parent coordinates; `None` when a step has no direction or the whole is
    /// singular.
    pub fn affine(&self) -> Option<Affine> {
        let mut all = Affine::IDENTITY;
        for step in &self.steps {
            all = all.then(&step.affine()?);
        }
        all.inverse().is_some().then_some(all)
    }
}

describe! {
    /// One step of a transform.
    pub enum Step {
        /// Moves by a vector.
        "translate" => Translate(DVec3),
        /// Turns about an axis through the origin.
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

describe! {
    /// A turn, counter-clockwise seen from the axis' tip.
    pub struct Rotation {
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
