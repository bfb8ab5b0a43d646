//! What stands in a scene, as searches see it: groups of triangles and objects, without the structures over them.

use crate::input::{Geometry, GeometryKind, Instance};
use straal_math::{Bounds, Motion, Ray, Transform, Vec3};

/// Everything, with a structure of type `S` over each group.
pub(crate) struct Stage<S> {
    pub geometries: Vec<Geometry>,
    pub masks: Vec<u32>,
    /// Those of all groups, one group after the other.
    pub instances: Vec<Instance>,
    pub motions: Vec<Motion>,
    pub groups: Vec<GroupData>,
    /// By group.
    pub searchers: Vec<S>,
}

/// One group as it is searched.
pub(crate) struct GroupData {
    /// Its place among all groups.
    pub index: usize,
    /// The group's meshes, by geometry; a triangle's number in the group counts over them.
    pub meshes: Vec<MeshStart>,
    pub objects: Vec<Object>,
    /// Objects without a box that the structure doesn't test.
    pub unbounded: Vec<u32>,
    /// Whether rays that enter it in an instance are searched together: it has so much in it that this pays.
    pub is_large: bool,
    /// Whether an instance of such a group is among the objects.
    pub has_large: bool,
    /// Whether anything has no box.
    pub is_unbounded: bool,
    /// The bits that the masks of all its meshes have.
    pub all_masks: u32,
    /// Around all that is bounded.
    pub bounds: Bounds,
    /// Whether the world reaches it.
    pub is_built: bool,
}

/// Where a mesh' triangles start among the group's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshStart {
    pub geometry: u32,
    pub first: u32,
}

/// A shape or an instance in a group.
pub(crate) struct Object {
    pub kind: ObjectKind,
    pub mask: u32,
    /// Padded; `None` when there is none.
    pub bounds: Option<Bounds>,
}

#[derive(Clone, Copy)]
pub(crate) enum ObjectKind {
    Shape { shape: u32, geometry: u32, primitive: u32 },
    Instance(u32),
}

impl GroupData {
    pub const fn empty(index: usize) -> Self {
        Self {
            index,
            meshes: Vec::new(),
            objects: Vec::new(),
            unbounded: Vec::new(),
            is_large: false,
            has_large: false,
            is_unbounded: false,
            all_masks: u32::MAX,
            bounds: Bounds::EMPTY,
            is_built: false,
        }
    }

    /// The longest edge of the box around all that is bounded.
    pub fn extent(&self) -> f32 {
        self.bounds.extent().max_element()
    }

    /// Geometry and primitive of a shape, by its number among the objects.
    #[inline(always)]
    pub fn shape(&self, object: u32) -> (u32, u32) {
        match self.objects[object as usize].kind {
            ObjectKind::Shape { geometry, primitive, .. } => (geometry, primitive),
            ObjectKind::Instance(_) => (u32::MAX, u32::MAX),
        }
    }

    /// Geometry and triangle index of the group's n-th triangle.
    #[inline(always)]
    pub fn locate(&self, id: u32) -> (u32, u32) {
        let mut i = 0;
        if self.meshes.len() > 1 {
            i = self.meshes.partition_point(|m| m.first <= id) - 1;
        }
        (self.meshes[i].geometry, id - self.meshes[i].first)
    }
}

impl<S> Stage<S> {
    /// A ray in an instance's own space.
    #[inline(always)]
    pub fn inverse_ray(&self, instance: &Instance, ray: &Ray) -> Ray {
        match instance.motion {
            None => instance.transform.inverse_ray(ray),
            Some(_) => self.transform(instance, ray.time).inverse_ray(ray),
        }
    }

    /// Where an instance is at a time from 0 to 1.
    pub fn transform(&self, instance: &Instance, time: f32) -> Transform {
        let motion = instance.motion.and_then(|motion| self.motions.get(motion as usize));
        motion.map_or(instance.transform, |motion| motion.at(time))
    }

    /// All the places where an instance is: between them it goes along straight lines.
    pub fn transforms<'a>(&'a self, instance: &'a Instance) -> &'a [Transform] {
        let motion = instance.motion.and_then(|motion| self.motions.get(motion as usize));
        motion.map_or(std::slice::from_ref(&instance.transform), Motion::transforms)
    }

    #[inline(always)]
    pub fn geometry_mask(&self, geometry: u32) -> u32 {
        self.masks[geometry as usize]
    }

    /// The vertices of a group's n-th triangle.
    #[inline(always)]
    pub fn vertices(&self, group: &GroupData, id: u32) -> [Vec3; 3] {
        let (geometry, triangle) = group.locate(id);
        match &self.geometries[geometry as usize].kind {
            GeometryKind::Triangles { positions, indices } => {
                indices[triangle as usize].map(|i| positions[i as usize])
            }
            GeometryKind::Shapes { .. } => [Vec3::ZERO; 3],
        }
    }
}
