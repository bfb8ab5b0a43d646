//! What a world takes, by the numbers of things in it: for forecasts, before any of it is made.

use crate::light::Emitter;
use crate::shape::{Shape, TriangleMesh};
use crate::world::Look;
use straal_accel as accel;
use straal_scene::forecast::Tally;

/// Bytes that a world takes, besides its search structures' trees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Surfaces, instances, and what search and shading know of each.
    pub geometry: u64,
    /// Emitters, and how to choose among them and on them.
    pub lights: u64,
    /// What is taken besides while all this is made.
    pub making: u64,
}

/// What the allocator takes beside each piece.
const PIECE: usize = 16;

/// What a structure knows of a shape or instance: kind, mask and box.
const OBJECT: usize = 48;

/// A shape apart from the list: four times three numbers and more, in double precision.
const LARGE_SHAPE: usize = 160;

/// A surface that glows, between the walk over the scene and its emitter, the weights that it is chosen by, and what lists that grow
/// leave behind: measured on 100,000 and 279,936 lights.
const GLOWING: usize = 140;

/// Per vertex, of which there is one for two faces: edges, corners, their sets and their means.
const SMOOTHED: usize = 160;

/// What a tally takes.
pub fn cost(t: &Tally) -> Cost {
    let of = |count: u64, each: usize| count.saturating_mul(each as u64);
    let sum = |parts: &[u64]| parts.iter().fold(0, |sum: u64, v| sum.saturating_add(*v));
    // A geometry's mask stands in two lists; its number in its group's, and in another while that is built.
    let geometry = size_of::<accel::Geometry>() + size_of::<Look>() + 4 + 4;
    // Positions and indices are pieces of their own, as are normals and texture coordinates.
    let mesh = size_of::<TriangleMesh>() + geometry + 8 + 4 * PIECE + 2 * 16;
    Cost {
        geometry: sum(&[
            t.vertex_bytes,
            of(t.triangles, 12),
            of(t.meshes, mesh),
            of(t.shapes, size_of::<Shape>() + geometry + OBJECT),
            of(t.large_shapes, LARGE_SHAPE + PIECE),
            of(t.instances, size_of::<accel::Instance>() + 4 + OBJECT),
        ]),
        // Two tables of whole numbers choose an emitter, and a triangle.
        lights: sum(&[of(t.lights, size_of::<Emitter>() + 8), of(t.lit_triangles, 8)]),
        making: sum(&[
            of(t.shapes.saturating_add(t.meshes), 4),
            of(t.instances, size_of::<accel::Instance>() + 4),
            of(t.lights, GLOWING),
            of(t.smoothed, SMOOTHED),
        ]),
    }
}
