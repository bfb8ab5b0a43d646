//! Solids that are made of others: by sets, and by distance.

use straal_math::DVec3;

use crate::desc::check;
use crate::desc::node::Node;
use crate::desc::shape::Surface;
use crate::desc::transform::Transform;
use crate::describe::describe;
use crate::limit::Limit;

describe! {
    /// Solids taken together, by sets (constructive solid geometry). Each is closed: a whole sphere, a box, a cylinder or cone with caps, a
    /// torus, a capsule, a mesh without holes, a distance field, a group of these, which counts as all of them together, or again such a combination. Its surfaces keep
    /// their own materials; this one is for those without.
    pub struct Combination [check::combination] {
        /// The solids.
        of: Vec<Node>,
    } with surface: Surface
}

describe! {
    /// A solid that is told by how far away it is, wherever one stands (a signed distance field).
    pub struct DistanceField [check::distance_field] {
        /// The distance.
        of: Distance,
    } with surface: Surface
}

describe! {
    /// How far away a solid is; below 0 in it.
    pub enum Distance {
        /// From a ball.
        "ball" => Ball(BallDistance),
        /// From a box.
        "box" => Box(BoxDistance),
        /// From a ring of round section about y.
        "ring" => Ring(RingDistance),
        /// From a tube with round ends.
        "capsule" => Capsule(CapsuleDistance),
        /// From a cylinder with flat ends.
        "cylinder" => Cylinder(CylinderDistance),
        /// The least of several.
        "union" => Union(Blend),
        /// The greatest of several: where all of them are.
        "intersection" => Intersection(Blend),
        /// The first without all others.
        "difference" => Difference(Blend),
        /// Another one, moved; it may be turned and scaled evenly.
        "moved" => Moved(Moved),
        /// Another one, thicker by so much all around, its edges rounded.
        "grown" => Grown(Grown),
        /// The skin of another one, so thick to either side.
        "shell" => Shell(Grown),
        /// Another one, with waves all over.
        "ripples" => Ripples(Ripples),
        /// Numbers on a grid, evenly between.
        "grid" => Grid(GridDistance),
    }
}

describe! {
    /// A ball.
    pub struct BallDistance {
        /// Its middle.
        center: DVec3 = DVec3::ZERO,
        /// Its radius.
        radius: f64 [Limit::POSITIVE] = 1.0,
    }
}

describe! {
    /// A box along the axes.
    pub struct BoxDistance [check::box_distance] {
        /// The corner with the smallest coordinates.
        min: DVec3 = DVec3::splat(-1.0),
        /// The corner with the largest coordinates.
        max: DVec3 = DVec3::splat(1.0),
    }
}

describe! {
    /// A ring about y.
    pub struct RingDistance {
        /// Its middle.
        center: DVec3 = DVec3::ZERO,
        /// How far the middle of the tube is from the axis.
        radius: f64 [Limit::POSITIVE] = 1.0,
        /// The radius of the tube.
        tube_radius: f64 [Limit::POSITIVE] = 0.25,
    }
}

describe! {
    /// A tube with round ends.
    pub struct CapsuleDistance {
        /// The middle of the ball at one end.
        from: DVec3 = DVec3::ZERO,
        /// The middle of the ball at the other end.
        to: DVec3 = DVec3::Y,
        /// Its radius.
        radius: f64 [Limit::POSITIVE] = 0.5,
    }
}

describe! {
    /// A cylinder with flat ends.
    pub struct CylinderDistance [check::cylinder_distance] {
        /// The middle of one end.
        from: DVec3 = DVec3::ZERO,
        /// The middle of the other end.
        to: DVec3 = DVec3::Y,
        /// Its radius.
        radius: f64 [Limit::POSITIVE] = 0.5,
    }
}

describe! {
    /// Several together.
    pub struct Blend [check::blend] {
        /// These.
        of: Vec<Distance>,
        /// How wide the seams between them are smoothed over; with 0 they are sharp.
        smooth: f64 [Limit::NON_NEGATIVE] = 0.0,
    }
}

describe! {
    /// Another one, moved.
    pub struct Moved [check::moved] {
        /// This one.
        of: Box<Distance>,
        /// To where; what isn't as long in all directions is refused.
        transform: Transform = Transform::default(),
    }
}

describe! {
    /// Another one with a thickness.
    pub struct Grown {
        /// This one.
        of: Box<Distance>,
        /// So much.
        by: f64 [Limit::POSITIVE] = 0.1,
    }
}

describe! {
    /// Waves all over.
    pub struct Ripples {
        /// This one.
        of: Box<Distance>,
        /// How high waves rise above the middle.
        amplitude: f64 [Limit::POSITIVE] = 0.05,
        /// From one wave to the next.
        wavelength: f64 [Limit::POSITIVE] = 0.5,
    }
}

describe! {
    /// Distances on a grid, at its corners: its first and last points are at `min` and `max`.
    pub struct GridDistance [check::grid_distance] {
        /// The corner with the smallest coordinates.
        min: DVec3 = DVec3::splat(-1.0),
        /// The corner with the largest coordinates.
        max: DVec3 = DVec3::splat(1.0),
        /// How many points there are along x, y and z.
        size: [u32; 3] [Limit::within(2.0, 1024.0)],
        /// The distance at each: x runs first, then y, then z.
        values: Vec<f64>,
    }
}
