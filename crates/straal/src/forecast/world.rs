//! What a world takes, by the numbers of things in it.

use straal_accel as accel;
use straal_math::Vec3;
use straal_render::compile::GLOWING_BYTES;
use straal_render::light::{Copies, Emitter, LightTable};
use straal_render::shape::{
    Curve, Cylinder, Disc, Parallelogram, Revolved, SMOOTHING_BYTES, Shape, TriangleMesh,
};
use straal_render::world::GEOMETRY_BYTES;
use straal_scene::count::Tally;
use straal_scene::desc::Scene;

/// Bytes that a world takes, besides its search structures' trees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Cost {
    /// Surfaces, instances, and what search and shading know of each.
    pub geometry: u64,
    /// Emitters, and how to choose among them and on them.
    pub lights: u64,
    /// What is taken besides while all this is made.
    pub making: u64,
}

/// What the allocator takes beside each piece.
const PIECE: usize = 16;

/// Beside what is shared stands how often it is.
const COUNTS: usize = 2 * size_of::<usize>();

/// What lists that grow leave behind for each surface that glows: measured on 248,832 lights.
const HOLES: usize = 224;

/// Choices of light that a world has at most: one of all lamps, and one for each thing that goes by the name of what some lamps light alone.
pub(super) fn choices(scene: &Scene) -> u64 {
    let names = scene.linked_names();
    let mut things = 0;
    if scene.has_linked_lamps() {
        scene.visit(|node| things += u64::from(names.iter().any(|name| node.goes_by(name))));
    }
    // Of so few names there are no more kinds of things.
    1 + things.min((1_u64 << names.len().min(16)) - 1)
}

/// What a tally takes; so often the choice of light is kept.
pub(super) fn cost(t: &Tally, choices: u64) -> Cost {
    let of = |count: u64, each: usize| count.saturating_mul(each as u64);
    let sum = |parts: &[u64]| parts.iter().fold(0, |sum: u64, v| sum.saturating_add(*v));
    // Its number stands in its group, and in another list while that is built.
    let geometry = GEOMETRY_BYTES + 2 * size_of::<u32>();
    // Positions and indices are pieces of their own, as are normals and texture coordinates; a mask for each level of lists.
    let mesh = size_of::<TriangleMesh>() + geometry + 2 * size_of::<u32>() + 4 * PIECE + 2 * COUNTS;
    let shape = size_of::<Shape>() + geometry + accel::sizes::OBJECT;
    let instance = size_of::<accel::Instance>() + size_of::<u32>();
    Cost {
        geometry: sum(&[
            of(t.vertices, size_of::<Vec3>()),
            of(t.normals, size_of::<Vec3>()),
            of(t.uvs, size_of::<[f32; 2]>()),
            of(t.triangles, size_of::<[u32; 3]>()),
            of(t.meshes, mesh),
            of(t.shapes, shape),
            of(t.discs, size_of::<Disc>() + PIECE),
            of(t.rectangles, size_of::<Parallelogram>() + PIECE),
            of(t.cylinders, size_of::<Cylinder>() + PIECE),
            of(t.revolved, size_of::<Revolved>() + PIECE),
            of(t.curves, size_of::<Curve>() + PIECE),
            of(t.instances, instance + accel::sizes::OBJECT),
        ]),
        lights: sum(&[
            of(t.lights, size_of::<Emitter>()),
            of(t.lit_instances, Copies::BYTES),
            of(sum(&[t.lights, t.lit_triangles, t.lit_instances]), LightTable::BYTES).saturating_mul(choices),
        ]),
        making: sum(&[
            of(t.shapes.saturating_add(t.meshes), size_of::<u32>()),
            of(t.instances, instance),
            of(t.lights, GLOWING_BYTES + HOLES),
            of(t.lit_instances, LightTable::MAKING_BYTES),
            of(t.smoothed, SMOOTHING_BYTES),
        ]),
    }
}
