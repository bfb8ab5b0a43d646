//! Bounding volumes: each object in a simple shape that is tested before it (Whitted 1980, "An Improved Illumination Model
//! for Shaded Display"; Weghorst, Hooper and Greenberg 1984, "Improved Computational Methods for Ray Tracing").
//!
//! The first step from brute force to a hierarchy. An object is a mesh with all of its triangles, a shape, or an instance.
//! Its volume pays off where
//!
//! cost of the volume's test + p × cost of the object's test < cost of the object's test,
//!
//! with p the share of rays that meet the volume. So it does for meshes that few rays meet; around one triangle it costs more
//! than it spares. Tighter volumes have a lower p and a dearer test. All volumes are still tested against every ray, in the
//! order of the scene.
//!
//! # Why no hit is lost
//! A box is tested by `slab::entry`, which never rejects a box around one that it accepts. The other volumes are tested in
//! double precision against the line of the ray, and grown by a margin (`line.rs`) for what single precision does elsewhere:
//! a hit of a triangle lies, up to rounding, on the triangle, so that the line passes within the margin of it; a shape or
//! an instance counts only if the ray passes its box. That a volume lies between the ray's ends is decided by its extent
//! along the ray's dominant axis, which holds that of the boxes inside; all of these bound the t of a hit.

mod line;
mod oriented;
mod principal;
mod sphere;
mod validate;

use crate::{
    hit::Hit,
    partition::{self, chance},
    prim::{Packed, Prim, PrimKind},
    query::{Built, Descend, Place, Query, Search, Stats},
    slab,
};
use line::Line;
use oriented::Oriented;
use sphere::Sphere;
use straal_math::{Bounds, DVec3, Vec3};

/// What is put around objects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumesParams {
    /// The kind of volume.
    pub volume: VolumeKind,
    /// Cost of the test of a volume.
    pub traversal_cost: f64,
    /// Cost of the test of a primitive, in the same unit.
    pub intersection_cost: f64,
}

impl VolumesParams {
    /// Boxes along the axes.
    pub const DEFAULT: Self = Self { volume: VolumeKind::Box, traversal_cost: 0.5, intersection_cost: 1.0 };
}

impl Default for VolumesParams {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A kind of bounding volume.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum VolumeKind {
    /// A sphere.
    Sphere,
    /// A box along the axes.
    #[default]
    Box,
    /// A box along the principal axes of the object's vertices, unless one along the scene's axes is smaller.
    Oriented,
}

/// One of them.
enum Volume {
    Sphere(Sphere),
    Box(Bounds),
    Oriented(Box<Oriented>),
}

/// An object: primitives that have a volume in common.
struct Guarded {
    volume: Volume,
    first: u32,
    count: u32,
}

/// A group's objects.
pub(crate) struct Volumes {
    params: VolumesParams,
    objects: Vec<Guarded>,
    /// Those of an object side by side.
    prims: Vec<Packed>,
    /// Around everything.
    bounds: Bounds,
}

/// What the primitives of a group are made of.
pub(crate) trait Content {
    /// Which geometry a triangle of the group belongs to.
    fn geometry(&self, triangle: u32) -> u32;

    fn vertices(&self, triangle: u32) -> [Vec3; 3];
}

impl Volumes {
    /// `prims` has the triangles of a geometry side by side.
    pub fn build(prims: &[Prim], params: &VolumesParams, content: &impl Content) -> Self {
        let same_object = |a: &Prim, b: &Prim| match (a.kind, b.kind) {
            (PrimKind::Triangle(a), PrimKind::Triangle(b)) => content.geometry(a) == content.geometry(b),
            _ => false,
        };
        let mut first = 0;
        let objects = prims
            .chunk_by(same_object)
            .map(|members| {
                let count = members.len() as u32;
                let volume = Volume::around(members, params.volume, content);
                first += count;
                Guarded { volume, first: first - count, count }
            })
            .collect();
        Self {
            params: *params,
            objects,
            prims: prims.iter().map(|p| p.kind.packed()).collect(),
            bounds: prims.iter().fold(Bounds::EMPTY, |b, p| b.union(p.bounds)),
        }
    }

    #[inline(always)]
    fn prims(&self, object: &Guarded) -> &[Packed] {
        &self.prims[object.first as usize..(object.first + object.count) as usize]
    }
}

impl Volume {
    fn around(members: &[Prim], kind: VolumeKind, content: &impl Content) -> Self {
        let bounds = members.iter().fold(Bounds::EMPTY, |b, p| b.union(p.bounds));
        // Of each primitive, the points whose hull its hits lie on.
        let each_point = |visit: &mut dyn FnMut(DVec3)| {
            for prim in members {
                match prim.kind {
                    PrimKind::Triangle(id) => content.vertices(id).iter().for_each(|v| visit(v.as_dvec3())),
                    PrimKind::Object(_) => prim.bounds.corners().iter().for_each(|v| visit(v.as_dvec3())),
                }
            }
        };
        match kind {
            VolumeKind::Sphere => Self::Sphere(Sphere::around(&bounds, &each_point)),
            VolumeKind::Box => Self::Box(bounds),
            VolumeKind::Oriented => Self::Oriented(Box::new(Oriented::around(&bounds, &each_point))),
        }
    }

    /// Whether something inside could be hit at `limit` or before.
    #[inline(always)]
    fn meets(&self, at: &Place<'_>, line: &Line, limit: f32) -> bool {
        match self {
            Self::Sphere(sphere) => sphere.meets(line, limit),
            Self::Box(bounds) => slab::entry(bounds, at.ray).is_some_and(|entry| entry <= limit),
            Self::Oriented(oriented) => oriented.meets(line, limit),
        }
    }

    /// Half the surface.
    fn half_area(&self) -> f64 {
        match self {
            Self::Sphere(sphere) => sphere.half_area(),
            Self::Box(bounds) => partition::half_area(bounds),
            Self::Oriented(oriented) => oriented.half_area(),
        }
    }
}

/// Gives all points of an object to a function.
type EachPoint<'a> = dyn Fn(&mut dyn FnMut(DVec3)) + 'a;

/// Half the surface of a box with these edges.
fn half_area(e: DVec3) -> f64 {
    e.x * e.y + e.y * e.z + e.z * e.x
}

/// By how much a volume around points is grown so that it also holds, along each axis, the padded boxes of triangles
/// between them (`slab::padded`): these grow by parts of their extent and of their coordinates.
fn padding(bounds: &Bounds) -> f64 {
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    16.0 * f64::from(f32::EPSILON) * (f64::from(farthest) + f64::from(bounds.extent().max_element()))
}

impl Search for Volumes {
    #[inline(always)]
    fn closest<K: Descend, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    ) {
        let line = Line::new(at.ray);
        for object in &self.objects {
            q.count_node(1);
            if object.volume.meets(at, &line, best.t) {
                for prim in self.prims(object) {
                    q.prim_closest(at, prim.kind(), best);
                }
            }
        }
    }

    #[inline(always)]
    fn occluded<K: Descend, const COUNT: bool>(&self, q: &mut Query<'_, K, COUNT>, at: &Place<'_>) -> bool {
        let line = Line::new(at.ray);
        self.objects.iter().any(|object| {
            q.count_node(1);
            object.volume.meets(at, &line, at.ray.ray.t_max)
                && self.prims(object).iter().any(|prim| q.prim_occluded(at, prim.kind()))
        })
    }
}

impl Built for Volumes {
    fn memory_bytes(&self) -> usize {
        let apart = match self.params.volume {
            VolumeKind::Oriented => size_of::<Oriented>() * self.objects.len(),
            VolumeKind::Sphere | VolumeKind::Box => 0,
        };
        size_of_val(self.objects.as_slice()) + size_of_val(self.prims.as_slice()) + apart
    }

    fn stats(&self) -> Stats {
        let test = self.params.traversal_cost / self.params.intersection_cost;
        let whole = partition::half_area(&self.bounds);
        let cost = |object: &Guarded| {
            let part = chance(object.volume.half_area(), whole);
            // A volume can stick out of the box around everything.
            let chance = if part < 1.0 { part } else { 1.0 };
            test + chance * f64::from(object.count)
        };
        Stats {
            nodes: 0,
            leaves: self.objects.len(),
            references: self.prims.len(),
            depth: u32::from(!self.objects.is_empty()),
            sah_cost: self.objects.iter().map(cost).sum(),
        }
    }
}
