//! The tree of the world.

use straal_math::{Affine, DVec3};

use crate::desc::curves::Curves;
use crate::desc::material::MaterialRef;
use crate::desc::round::{Annulus, Capsule, Cone, Hyperboloid, Paraboloid, Torus};
use crate::desc::shape::{
    Bezier, Bilinear, Cuboid, Cylinder, Disc, HeightField, Plane, Rectangle, Sphere, Surface, Triangle,
    TriangleMesh,
};
use crate::desc::solid::{Combination, DistanceField};
use crate::desc::transform::{Transform, facing};
use crate::describe::describe;
use crate::span::Spanned;
use crate::value::{Link, Matrix, Name};

describe! {
    /// Something in the world.
    pub enum Node some have surface, surface_mut: Surface {
        /// A ball.
        "sphere" => Sphere(Sphere) has surface,
        /// An infinite plane.
        "plane" => Plane(Plane) has surface,
        /// A flat, round plate.
        "disc" => Disc(Disc) has surface,
        /// A flat parallelogram.
        "rectangle" => Rectangle(Rectangle) has surface,
        /// A box along the axes.
        "box" => Box(Cuboid) has surface,
        /// A tube.
        "cylinder" => Cylinder(Cylinder) has surface,
        /// A cone.
        "cone" => Cone(Cone) has surface,
        /// A flat ring.
        "annulus" => Annulus(Annulus) has surface,
        /// A ring of round section.
        "torus" => Torus(Torus) has surface,
        /// A bowl.
        "paraboloid" => Paraboloid(Paraboloid) has surface,
        /// A straight line turned about an axis.
        "hyperboloid" => Hyperboloid(Hyperboloid) has surface,
        /// A tube with round ends.
        "capsule" => Capsule(Capsule) has surface,
        /// One triangle.
        "triangle" => Triangle(Triangle) has surface,
        /// A triangle mesh.
        "mesh" => Mesh(TriangleMesh) has surface,
        /// Bicubic Bezier patches.
        "bezier" => Bezier(Bezier) has surface,
        /// A patch between four corners.
        "bilinear" => Bilinear(Bilinear) has surface,
        /// Heights over a rectangle.
        "height_field" => HeightField(HeightField) has surface,
        /// Long, thin things.
        "curves" => Curves(Curves) has surface,
        /// Where any of several solids is.
        "union" => Union(Combination) has surface,
        /// Where all of several solids are.
        "intersection" => Intersection(Combination) has surface,
        /// Where the first of several solids is and no other.
        "difference" => Difference(Combination) has surface,
        /// A solid told by its distance.
        "distance_field" => DistanceField(DistanceField) has surface,
        /// Several nodes placed together.
        "group" => Group(Group),
        /// One more copy of a named object, which costs next to no memory.
        "instance" => Instance(Instance),
        /// Many copies of a named object, of which each costs less than an `instance`.
        "instances" => Instances(Instances),
    }
}

describe! {
    /// Several nodes placed together.
    pub struct Group {
        /// Places the children; nested groups add up from the inside out.
        transform: Transform = Transform::default(),
        /// A point that its +z is turned towards, after `transform` and about where that puts its origin.
        look_at: Option<Spanned<DVec3>> = None,
        /// Material of children that have none of their own.
        material: Option<MaterialRef> = None,
        /// The nodes.
        children: Vec<Node>,
        /// What the camera's `focus_on` calls it.
        name: Option<Name> = None,
    }
}

describe! {
    /// A copy of a named object.
    pub struct Instance {
        /// Which of the scene's `objects`.
        of: Link<Node>,
        /// Places the copy.
        transform: Transform = Transform::default(),
        /// A point that its +z is turned towards, after `transform` and about where that puts its origin.
        look_at: Option<Spanned<DVec3>> = None,
        /// Material of what has none of its own in the object.
        material: Option<MaterialRef> = None,
        /// What the camera's `focus_on` calls it, besides the name of the object.
        name: Option<Name> = None,
    }
}

describe! {
    /// Copies of a named object.
    pub struct Instances {
        /// Which of the scene's `objects`.
        of: Link<Node>,
        /// Where each copy is: three or four rows of four numbers, as in the step `matrix` of a transform.
        transforms: Vec<Matrix>,
        /// Places all of them, after their own.
        transform: Transform = Transform::default(),
        /// A point that +z of all together is turned towards, after `transform` and about where that puts its origin.
        look_at: Option<Spanned<DVec3>> = None,
        /// Material of what has none of its own in the object.
        material: Option<MaterialRef> = None,
        /// What the camera's `focus_on` calls them, besides the name of the object.
        name: Option<Name> = None,
    }
}

impl Node {
    /// Where the node stands: its transform, and the turn towards what it looks at. `None` when the transform is singular, or when
    /// it stands where it looks.
    pub fn placement(&self) -> Option<Affine> {
        self.placement_by(self.transform())
    }

    /// Where it stands at even times while the shutter is open, if it moves; empty if it stays.
    pub fn motion(&self) -> Vec<Affine> {
        if self.transform().later.is_empty() {
            return Vec::new();
        }
        self.transform().at_times().filter_map(|at| self.placement_by(&at)).collect()
    }

    /// Where it would stand with another transform.
    fn placement_by(&self, transform: &Transform) -> Option<Affine> {
        let local = transform.affine()?;
        let Some(target) = self.look_at() else { return Some(local) };
        let (middle, front) = self.front();
        let inverse = local.inverse()?;
        // A flat shape's front is a normal, which a transform leaves at right angles; what has an inside has an axis.
        let (front, is_normal) = match front {
            Front::Normal(n) => (inverse.normal_by_inverse(n), true),
            Front::Axis => (local.vector(DVec3::Z), false),
        };
        // A normal doesn't tell a mirror image from a turn, and a mirror image of a front is a front.
        let flip = is_normal && self.surface().is_some_and(|s| s.flip);
        let front = if flip { -front } else { front };
        Some(local.then(&facing(local.point(middle), front, target.value)?))
    }

    /// What its front is turned towards.
    pub fn look_at(&self) -> Option<&Spanned<DVec3>> {
        match self {
            Self::Group(g) => g.look_at.as_ref(),
            Self::Instance(i) => i.look_at.as_ref(),
            Self::Instances(i) => i.look_at.as_ref(),
            _ => self.surface().and_then(|s| s.look_at.as_ref()),
        }
    }

    /// Its middle and what is its front, in its own coordinates.
    fn front(&self) -> (DVec3, Front) {
        match self {
            Self::Sphere(s) => (s.center, Front::Axis),
            Self::Plane(s) => (s.point, Front::Normal(s.normal)),
            Self::Disc(s) => (s.center, Front::Normal(s.normal)),
            Self::Rectangle(s) => {
                let [a, b] = s.edges;
                (s.corner + (a + b) * 0.5, Front::Normal(a.cross(b)))
            }
            Self::Box(s) => ((s.min + s.max) * 0.5, Front::Axis),
            Self::Cylinder(s) => ((s.from + s.to) * 0.5, Front::Axis),
            Self::Cone(s) => ((s.from + s.to) * 0.5, Front::Axis),
            Self::Annulus(s) => (s.center, Front::Normal(s.normal)),
            Self::Torus(s) => (s.center, Front::Axis),
            Self::Paraboloid(s) => ((s.from + s.to) * 0.5, Front::Axis),
            Self::Capsule(s) => ((s.from + s.to) * 0.5, Front::Axis),
            Self::Bilinear(s) => {
                let [a, b, c, d] = s.corners;
                ((a + b + c + d) * 0.25, Front::Normal((b + d - a - c).cross(c + d - a - b)))
            }
            Self::Triangle(s) => {
                let [a, b, c] = s.vertices;
                ((a + b + c) / 3.0, Front::Normal((b - a).cross(c - a)))
            }
            _ => (DVec3::ZERO, Front::Axis),
        }
    }
}

/// What of a node is turned towards what it looks at.
enum Front {
    /// A flat shape's.
    Normal(DVec3),
    /// Its +z.
    Axis,
}
