//! How much memory a search structure will take.
//!
//! What is known beforehand is how many primitives there are, not where they are. The numbers are those of ordinary
//! meshes (the bunny, the dragon, the cow Spot, teapots), where they hold within a factor of 1.5. Long thin triangles lie
//! in more cells than that, and a small dense object in a huge scene in fewer. Whatever the scene, partitions of space
//! keep to 16 references for each primitive, and grids to `max_cells`.

use straal_accel::{BspChoice, BspParams, Build, Bvh2Params, BvhParams, GridParams, KdParams, Structure};

/// A reference to a primitive.
const REFERENCE: f64 = 4.0;

/// Bytes that a structure takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Needs {
    /// As long as rays are searched.
    pub kept: u64,
    /// Besides, while it is built.
    pub building: u64,
}

/// Bytes of a structure over so many triangles, and shapes and instances.
pub(super) fn needs(structure: &Structure, triangles: u64, objects: u64) -> Needs {
    let n = triangles.saturating_add(objects) as f64;
    let (each, building) = match structure {
        // A number, padded to where it says of what.
        Structure::Brute => (8.0, 0.0),
        Structure::Volumes(_) => (REFERENCE, 0.0),
        Structure::Bvh(p) => {
            // Objects are leaves each by itself, eight to a node, where eight triangles are one.
            let [t, o] = [triangles, objects].map(|count| count as f64);
            let share = |of_triangles: f64, of_objects: f64| {
                if n > 0.0 { (of_triangles * t + of_objects * o) / n } else { 0.0 }
            };
            (share(wide(p), OBJECT), share(wide_building(p), OBJECT_BUILDING))
        }
        Structure::Bvh2(p) => (binary(p), 50.0),
        Structure::Grid(p) => (grid(p, n), 160.0),
        Structure::Kd(p) => (kd(p), 110.0),
        // Primitives lie in eight leaves or so, in fewer if those are larger; a node takes 16 bytes.
        Structure::Octree(p) => (110.0 / (1.0 + 0.06 * above(p.leaf_size, 1)), 90.0),
        Structure::Bsp(p) => (bsp(p), 30.0),
        // What comes later is taken for the costliest.
        _ => (155.0, 150.0),
    };
    Needs { kept: (n * each) as u64, building: (n * (PRIMITIVE + building)) as u64 }
}

/// A shape or instance in the wide tree: its part of a node of 256 bytes.
const OBJECT: f64 = 42.0;

/// The same while the tree is built: a reference, two nodes of the binary tree, and a part of a node once more.
const OBJECT_BUILDING: f64 = 32.0 + 80.0 + 42.0;

/// A primitive's box, from which all structures are built.
const PRIMITIVE: f64 = 32.0;

/// References of 32 bytes; the nodes and blocks of the binary trees that they become, which are still there while they are laid
/// out.
fn wide_building(p: &BvhParams) -> f64 {
    match p.build {
        Build::Fast | Build::Default => 62.0,
        Build::Best => 74.0,
    }
}

/// By how much a leaf's size is above another.
fn above(leaf_size: u32, than: u32) -> f64 {
    f64::from(leaf_size.saturating_sub(than))
}

/// Blocks of eight triangles that share vertices, as those of a mesh do, take 192 bytes, or 44 in a compact tree, and are
/// nearly full; nodes of 256 bytes stand above seven of them. Where triangles are cut there may be a quarter more.
fn wide(p: &BvhParams) -> f64 {
    match (&p.build, p.compact) {
        (Build::Fast, false) => 36.0,
        (Build::Fast, true) => 15.5,
        (Build::Default | Build::Best, false) => 33.0,
        (Build::Default | Build::Best, true) => 13.0,
    }
}

/// Two nodes of 32 bytes for each leaf, which is about half full.
fn binary(p: &Bvh2Params) -> f64 {
    let full = f64::from((p.leaf_size / 2).max(1));
    REFERENCE + 64.0 / full
}

/// Six references, and two nodes of 40 bytes where a kd-tree's take 12; by areas, which cut off empty space, three.
fn bsp(p: &BspParams) -> f64 {
    let full = 1.0 + 0.08 * above(p.leaf_size, 4);
    match p.choice {
        BspChoice::Even => 100.0 / full,
        BspChoice::Sah => 155.0 / full,
    }
}

/// Cells by the textbook's formula. Triangles of a surface lie in a number of them that grows with the factor's square.
fn grid(p: &GridParams, n: f64) -> f64 {
    let most = f64::from(p.max_cells) / if n > 0.0 { n } else { 1.0 };
    let cells = p.factor * p.factor * p.factor;
    // Where there would be too many the factor is halved, which leaves an eighth of the cells.
    let cells = if cells > most { most / 2.0 } else { cells };
    let further = 0.3 * p.factor * p.factor;
    let further = if further > most { most } else { further };
    4.0 * cells + REFERENCE * (1.8 + further)
}

/// Six references and four nodes. Clipped boxes spare references, but make more cuts worth while.
fn kd(p: &KdParams) -> f64 {
    let each = if p.clip { 95.0 } else { 80.0 };
    each / (1.0 + 0.08 * above(p.leaf_size, 1))
}
