//! The tree of the world.

use crate::desc::material::MaterialRef;
use crate::desc::shape::{Bezier, Cuboid, Cylinder, Disc, Plane, Rectangle, Sphere, Triangle, TriangleMesh};
use crate::desc::transform::Transform;
use crate::describe::describe;
use crate::value::Name;

describe! {
    /// Something in the world.
    pub enum Node {
        /// A ball.
        "sphere" => Sphere(Sphere),
        /// An infinite plane.
        "plane" => Plane(Plane),
        /// A flat, round plate.
        "disc" => Disc(Disc),
        /// A flat parallelogram.
        "rectangle" => Rectangle(Rectangle),
        /// A box along the axes.
        "box" => Box(Cuboid),
        /// A tube.
        "cylinder" => Cylinder(Cylinder),
        /// One triangle.
        "triangle" => Triangle(Triangle),
        /// A triangle mesh.
        "mesh" => Mesh(TriangleMesh),
        /// Bicubic Bezier patches.
        "bezier" => Bezier(Bezier),
        /// Several nodes placed together.
        "group" => Group(Group),
        /// One more copy of a named object, which costs next to no memory.
        "instance" => Instance(Instance),
    }
}

describe! {
    /// Several nodes placed together.
    pub struct Group {
        /// Places the children; nested groups add up from the inside out.
        transform: Transform = Transform::default(),
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
        of: Name,
        /// Places the copy.
        transform: Transform = Transform::default(),
        /// Material of what has none of its own in the object.
        material: Option<MaterialRef> = None,
        /// What the camera's `focus_on` calls it, besides the name of the object.
        name: Option<Name> = None,
    }
}
