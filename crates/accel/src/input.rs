//! What a scene is built from.

use crate::{analytic::Analytic, hit::ShapeHit};
use std::sync::Arc;
use straal_math::{Bounds, Motion, Ray, Transform, Vec3};

/// Everything that can be hit. `groups[0]` is the world.
#[derive(Clone, Debug, Default)]
pub struct Input {
    /// Spaces in which geometries and instances stand.
    pub groups: Vec<Group>,
    /// What the groups refer to.
    pub geometries: Vec<Geometry>,
    /// How instances move that do.
    pub motions: Vec<Motion>,
}

/// What stands in one space.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// Indices into [`Input::geometries`]; naming one twice has no effect.
    pub geometries: Vec<u32>,
    /// Other groups, moved into this space.
    pub instances: Vec<Instance>,
}

/// A group placed in another.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index into [`Input::groups`].
    pub group: u32,
    /// From the group's space to that of the group that the instance stands in; of one that moves, at time 0.
    pub transform: Transform,
    /// How it moves, as an index into [`Input::motions`].
    pub motion: Option<u32>,
    /// A ray sees the instance when its mask shares a bit with this.
    pub mask: u32,
}

/// A mesh or a run of shapes.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// What it is made of.
    pub kind: GeometryKind,
    /// A ray sees the geometry when its mask shares a bit with this.
    pub mask: u32,
}

/// What a geometry is made of.
#[derive(Clone, Debug)]
pub enum GeometryKind {
    /// An indexed triangle mesh.
    Triangles {
        /// Vertices.
        positions: Arc<[Vec3]>,
        /// Three vertices for each triangle.
        indices: Arc<[[u32; 3]]>,
    },
    /// Shapes `first .. first + count` of the caller's [`Shapes`].
    Shapes {
        /// The first shape.
        first: u32,
        /// How many.
        count: u32,
    },
}

impl GeometryKind {
    /// Whether both are meshes of the same triangles, to the bit.
    pub(crate) fn is_same_mesh(&self, o: &Self) -> bool {
        let (
            Self::Triangles { positions: p, indices: i },
            Self::Triangles { positions: other_p, indices: other_i },
        ) = (self, o)
        else {
            return false;
        };
        let bits = |p: &Vec3| [p.x, p.y, p.z].map(f32::to_bits);
        let same_places =
            || p.len() == other_p.len() && p.iter().zip(&**other_p).all(|(a, b)| bits(a) == bits(b));
        (Arc::ptr_eq(i, other_i) || i == other_i) && (Arc::ptr_eq(p, other_p) || same_places())
    }
}

/// The caller's own primitives. All functions are pure: same input, same bits.
pub trait Shapes: Sync {
    /// A box around the shape in its group's space; `None` when it is unbounded, like a plane: such shapes are tested
    /// against every ray.
    fn bounds(&self, shape: u32) -> Option<Bounds>;

    /// The hit with the least t in [`t_min`, `t_max`] of the ray, which is given in the group's space. Its end may be where
    /// something nearer was found already.
    fn intersect(&self, shape: u32, ray: &Ray) -> Option<ShapeHit>;

    /// The formula that the shape is, if it is one: it is then tested many at a time, and [`Self::intersect`] gives the same
    /// bits by [`Analytic::intersect`].
    fn analytic(&self, _shape: u32) -> Option<Analytic> {
        None
    }
}

/// No shapes at all, for scenes of triangles only.
impl Shapes for () {
    fn bounds(&self, _shape: u32) -> Option<Bounds> {
        Some(Bounds::EMPTY)
    }

    fn intersect(&self, _shape: u32, _ray: &Ray) -> Option<ShapeHit> {
        None
    }
}

/// Why a scene can't be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// [`Input::groups`] is empty.
    #[error("there is no group, and so no world")]
    NoWorld,
    /// A group names a geometry that isn't there.
    #[error("group {group} names geometry {geometry}, but there are {count}")]
    NoSuchGeometry {
        /// The group.
        group: u32,
        /// What it names.
        geometry: u32,
        /// How many geometries there are.
        count: usize,
    },
    /// An instance names a group that isn't there.
    #[error("group {group} has an instance of group {target}, but there are {count}")]
    NoSuchGroup {
        /// The group that the instance stands in.
        group: u32,
        /// What it names.
        target: u32,
        /// How many groups there are.
        count: usize,
    },
    /// A triangle names a vertex that isn't there.
    #[error("triangle {triangle} of geometry {geometry} names vertex {vertex}, but there are {count}")]
    NoSuchVertex {
        /// The geometry.
        geometry: u32,
        /// The triangle.
        triangle: u32,
        /// What it names.
        vertex: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// A group contains itself.
    #[error("group {group} contains itself")]
    Cycle {
        /// One group of the cycle.
        group: u32,
    },
    /// Instances nested deeper than [`crate::MAX_DEPTH`].
    #[error("instances are nested deeper than {} levels", crate::MAX_DEPTH)]
    TooDeep,
    /// More of something than can be numbered.
    #[error("too many {what}: at most {most} are supported")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many there may be.
        most: u32,
    },
    /// The processor lacks the instruction set that was asked for.
    #[error("this processor lacks the instruction set {isa}")]
    IsaMissing {
        /// What was asked for.
        isa: crate::Isa,
    },
}
