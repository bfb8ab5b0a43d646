//! Shapes that turn about an axis, beside the sphere, the cylinder and the disc.

use straal_math::DVec3;

use crate::desc::check;
use crate::desc::shape::Surface;
use crate::describe::describe;
use crate::limit::Limit;

/// The whole turn.
pub const WHOLE_TURN: [f64; 2] = [0.0, 360.0];

describe! {
    /// A cone that comes to a point, or one that is cut off; its front is outside.
    pub struct Cone [check::cone] {
        /// The middle of its wide end.
        from: DVec3 = DVec3::ZERO,
        /// Its tip, or the middle of its other end.
        to: DVec3 = DVec3::Y,
        /// Its radius at `from`.
        radius: f64 [Limit::POSITIVE] = 1.0,
        /// Its radius at `to`: with 0 it comes to a point.
        top_radius: f64 [Limit::NON_NEGATIVE] = 0.0,
        /// Whether discs close its ends.
        caps: bool = false,
        /// Which part of a turn about its axis there is, in degrees.
        phi: [f64; 2] = WHOLE_TURN,
    } with surface: Surface
}

describe! {
    /// A flat ring; its texture coordinates are the part of a turn, and how far out.
    pub struct Annulus [check::annulus] {
        /// Its middle.
        center: DVec3 = DVec3::ZERO,
        /// Towards its front.
        normal: DVec3 = DVec3::Z,
        /// Its outer radius.
        radius: f64 [Limit::POSITIVE] = 1.0,
        /// Its inner radius: with 0 it is a disc.
        inner_radius: f64 [Limit::NON_NEGATIVE] = 0.5,
        /// Which part of a turn about its normal there is, in degrees.
        phi: [f64; 2] = WHOLE_TURN,
    } with surface: Surface
}

describe! {
    /// A ring of round section; its front is outside.
    pub struct Torus [check::torus] {
        /// Its middle.
        center: DVec3 = DVec3::ZERO,
        /// The axis that it runs around.
        axis: DVec3 = DVec3::Y,
        /// How far the middle of the tube is from the axis.
        radius: f64 [Limit::POSITIVE] = 1.0,
        /// The radius of the tube, less than `radius`.
        tube_radius: f64 [Limit::POSITIVE] = 0.25,
        /// Which part of a turn about its axis there is, in degrees.
        phi: [f64; 2] = WHOLE_TURN,
        /// Which part of a turn about the tube there is, in degrees: 0 is the outer rim, 90 is towards `axis`.
        theta: [f64; 2] = WHOLE_TURN,
    } with surface: Surface
}

describe! {
    /// A bowl: a parabola turned about its axis; its front is outside.
    pub struct Paraboloid [check::paraboloid] {
        /// Its apex.
        from: DVec3 = DVec3::ZERO,
        /// The middle of its rim.
        to: DVec3 = DVec3::Y,
        /// The radius of its rim.
        radius: f64 [Limit::POSITIVE] = 1.0,
        /// How far from the apex it begins, as a part of the way to the rim.
        begin: f64 [Limit { min: 0.0, max: 0.999, open: false }] = 0.0,
        /// Which part of a turn about its axis there is, in degrees.
        phi: [f64; 2] = WHOLE_TURN,
    } with surface: Surface
}

describe! {
    /// A straight line turned about the y-axis: a hyperboloid of one sheet, or a cone, a cylinder or a flat ring where the line
    /// lies so; its front is away from the axis.
    pub struct Hyperboloid [check::hyperboloid] {
        /// The ends of the line.
        line: [DVec3; 2] = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(1.0, 1.0, 0.0)],
        /// Which part of a turn about the y-axis there is, in degrees, from where the line is.
        phi: [f64; 2] = WHOLE_TURN,
    } with surface: Surface
}

describe! {
    /// A tube with round ends, or what lies around a ball that shrinks on its way; its front is outside.
    pub struct Capsule [check::capsule] {
        /// The middle of the ball at one end.
        from: DVec3 = DVec3::ZERO,
        /// The middle of the ball at the other end.
        to: DVec3 = DVec3::Y,
        /// Its radius at `from`.
        radius: f64 [Limit::POSITIVE] = 0.5,
        /// Its radius at `to`, if that is another.
        end_radius: Option<f64> [Limit::POSITIVE] = None,
    } with surface: Surface
}
