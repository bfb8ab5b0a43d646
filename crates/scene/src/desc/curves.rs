//! Curves: hair, grass, wires.

use straal_math::DVec3;

use crate::desc::check;
use crate::desc::shape::Surface;
use crate::describe::describe;
use crate::limit::Limit;

describe! {
    /// Long, thin things along curves.
    pub struct Curves [check::curves] {
        /// The points by which the curves are told, one curve after the other.
        points: Vec<DVec3>,
        /// Where among `points` each curve begins; without, all of them are one curve.
        starts: Vec<u32> = Vec::new(),
        /// How a curve follows its points.
        basis: CurveBasis = CurveBasis::BSpline,
        /// How thick they are, as a radius: one number for all, two from the beginning to the end of each, or one for each of `points`.
        radii: Vec<f64> [Limit::NON_NEGATIVE] = vec![0.01],
        /// What is drawn along them.
        form: CurveForm = CurveForm::Round,
        /// For `ribbon`, the direction that it faces: one for each place where two pieces of a curve meet, and for its ends.
        normals: Vec<DVec3> = Vec::new(),
    } with surface: Surface
}

describe! {
    /// How a curve follows its points.
    pub enum CurveBasis {
        /// Straight from point to point, with balls at them.
        "linear" => Linear,
        /// Cubic Bezier pieces, each of which begins where the one before ends: 4 points, and 3 more for each further piece.
        "bezier" => Bezier,
        /// A uniform cubic B-spline, which passes near its points: 4 of them, and 1 more for each further piece.
        "b_spline" => BSpline,
    }
}

describe! {
    /// What is drawn along a curve.
    pub enum CurveForm {
        /// A tube without ends; along straight pieces, with round ones.
        "round" => Round,
        /// A flat band that faces whoever looks: what hair is drawn with where it is thinner than a pixel.
        "flat" => Flat,
        /// A flat band that faces its `normals`.
        "ribbon" => Ribbon,
    }
}

impl CurveBasis {
    /// Points that the first piece takes, and each further one.
    pub const fn points(&self) -> [usize; 2] {
        match self {
            Self::Linear => [2, 1],
            Self::Bezier => [4, 3],
            Self::BSpline => [4, 1],
        }
    }
}

impl Curves {
    /// Which of its points each curve has.
    pub fn runs(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let all = self.points.len();
        let count = if self.starts.is_empty() { 1 } else { self.starts.len() };
        (0..count).map(move |i| {
            let start = self.starts.get(i).map_or(0, |s| *s as usize);
            start..self.starts.get(i + 1).map_or(all, |s| *s as usize)
        })
    }

    /// How many pieces a curve of so many points has; `None` when no number of pieces fits.
    pub fn pieces(&self, points: usize) -> Option<usize> {
        let [first, further] = self.basis.points();
        let rest = points.checked_sub(first)?;
        rest.is_multiple_of(further).then_some(1 + rest / further)
    }
}
