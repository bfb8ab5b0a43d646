//! Ray search: which primitive does a ray hit first, and does it hit any?
//!
//! A [`Scene`] is built once from an [`Input`]: groups of triangle meshes, of the caller's own [`Shapes`], and of
//! instances of other groups. It answers slices of rays with slices of hits. Nothing here knows of rendering.
//!
//! # The hit
//! Every structure, instruction set and batch size gives the same hit to the last bit, because the hit is defined
//! without them:
//! - a ray goes down the levels by [`straal_math::Transform::inverse_ray`], its direction not renormalised, so that
//!   t means the same on every level;
//! - nothing behind the ray's origin counts: an interval begins at 0 or later;
//! - one routine (in `triangle.rs`) computes t, u and v; vector kernels do its very operations in each lane;
//! - a primitive counts only where the ray crosses its own padded box (in `slab.rs`), and its t is never less than the
//!   entry into that box. Boxes further up contain it and are computed by the same monotone arithmetic, so that a
//!   structure that skips what lies strictly beyond the best t can't lose the hit, however badly conditioned;
//! - among equal t, the least (instance chain, geometry, primitive) wins.
//!
//! # Limits
//! All structures give the hit of brute force on any input. That hit is the scene's as long as products of two lengths are finite (coordinates below 1e18), ray parameters are ordinary
//! numbers (1e-37 to 1e37), and directions aren't shorter than 1e-30: boxes are crossed along directions whose coordinates
//! below 1e-37 count as that.
//!
//! # Unsafe code
//! Denied everywhere but in `kernel`, where each module says why it holds.
#![deny(unsafe_code)]

mod analytic;
mod brute;
mod bsp;
mod bvh;
mod bvh2;
mod cells;
mod clip;
mod dropped;
mod entry;
mod grid;
mod hit;
mod input;
mod kd;
mod kernel;
mod lanes;
mod local;
mod mailbox;
mod name;
mod node;
mod octree;
mod partition;
mod prim;
mod query;
mod scene;
mod section;
pub mod sizes;
mod slab;
mod stage;
mod structure;
mod triangle;
mod volumes;

pub use analytic::{Analytic, Patch};
pub use bsp::{BspChoice, BspParams};
pub use bvh::params::{Build, BvhParams};
pub use bvh2::{Bvh2Params, Split};
pub use dropped::{Dropped, DroppedFrom};
pub use grid::GridParams;
pub use hit::{Chain, Cost, Hit, MAX_DEPTH, ShapeHit};
pub use input::{BuildError, Geometry, GeometryKind, Group, Input, Instance, Shapes};
pub use kd::KdParams;
pub use name::UnknownName;
pub use octree::OctreeParams;
pub use query::Stats;
pub use scene::{Flight, Options, Scene};
pub use section::Section;
pub use straal_math::simd::Isa;
pub use structure::Structure;
pub use volumes::{VolumeKind, VolumesParams};
