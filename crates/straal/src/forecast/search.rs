//! How much memory a search structure will take.
//!
//! What is known beforehand is how many primitives there are, not where they are. The sizes of nodes, blocks and references are
//! those of the search itself; how many of each a primitive has is that of ordinary
//! meshes (the bunny, the dragon, the cow Spot, teapots), where they hold within a factor of 1.5. Long thin triangles lie
//! in more cells than that, and a small dense object in a huge scene in fewer. Whatever the scene, partitions of space
//! keep to 16 references for each primitive, and grids to `max_cells`.

use straal_accel::{
    BspChoice, BspParams, Build, Bvh2Params, BvhParams, GridParams, KdParams, Structure, sizes,
};
use straal_scene::count::Space;

/// Bytes that a structure takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Needs {
    /// As long as rays are searched.
    pub kept: u64,
    /// Besides, while it is built.
    pub building: u64,
}

/// Bytes of a run of triangles: its first and last number, and where their mesh is found.
const RUN: u64 = 20;

/// So many of a part.
fn of(count: f64, bytes: usize) -> f64 {
    count * bytes as f64
}

/// Bytes of a structure over what is in a space.
pub(super) fn needs(structure: &Structure, space: &Space) -> Needs {
    let counts = [space.triangles, space.spheres, space.shapes, space.instances].map(|count| count as f64);
    let n: f64 = counts.iter().sum();
    // What is kept of a primitive; and what is held while the structure is built, by the size of a primitive in the list that it is
    // built from.
    let (each, building) = match structure {
        // Triangles are runs of numbers, and asked for no boxes.
        Structure::Brute => {
            let objects = n - counts[0];
            let bytes = |each: usize| of(objects, each) as u64;
            let runs = if counts[0] > 0.0 { RUN } else { 0 };
            return Needs { kept: bytes(sizes::REFERENCE) + runs, building: bytes(sizes::PRIMITIVE) };
        }
        Structure::Volumes(_) => (of(1.0, sizes::REFERENCE), 0.0),
        Structure::Bvh(p) => {
            let mean = |each: [f64; 4]| {
                let sum: f64 = each.iter().zip(counts).map(|(each, count)| each * count).sum();
                if n > 0.0 { sum / n } else { 0.0 }
            };
            let wide = Wide::of(p);
            let [spheres, shapes] = [sizes::BLOCK_OF_SPHERES, sizes::BLOCK_OF_SHAPES].map(Shapes::of);
            let building = [wide.building(), spheres.building, shapes.building, instance_building()];
            (
                mean([wide.kept(p), spheres.kept, shapes.kept, INSTANCE]),
                // What it is built from takes the place of the list of primitives.
                mean(building) / of(1.0, sizes::PRIMITIVE) - 1.0,
            )
        }
        Structure::Bvh2(p) => (binary(p), 1.6),
        Structure::Grid(p) => (grid(p, n), 5.0),
        Structure::Kd(p) => (kd(p), 3.4),
        // Primitives lie in eight leaves or so, in fewer if those are larger.
        Structure::Octree(p) => {
            let full = 1.0 + 0.06 * above(p.leaf_size, 1);
            ((of(8.0, sizes::REFERENCE) + of(4.9, sizes::OCTREE_NODE)) / full, 2.8)
        }
        Structure::Bsp(p) => (bsp(p), 0.9),
        // What comes later is taken for the costliest.
        _ => (155.0, 5.0),
    };
    Needs { kept: (n * each) as u64, building: (n * of(1.0 + building, sizes::PRIMITIVE)) as u64 }
}

/// How the wide tree holds a shape.
struct Shapes {
    kept: f64,
    building: f64,
}

impl Shapes {
    /// In blocks that take so many bytes. They are nearly full, and so are the nodes above them. While they are laid out there are two
    /// more of each, since lists double as they grow; and a node of the binary tree.
    fn of(block: usize) -> Self {
        let part = of(1.0 / 7.0, block);
        let node = of(1.0 / 49.0, sizes::WIDE_NODE);
        Self { kept: part + node, building: 2.0 * part + of(1.1, sizes::BINARY_NODE) }
    }
}

/// An instance in the wide tree: it is a leaf by itself, and has its part of a node, of which six slots are used.
const INSTANCE: f64 = sizes::WIDE_NODE as f64 / 6.1;

/// The same while the tree is built: a reference, two nodes of the binary tree with what they weigh, and a part of a node once more.
fn instance_building() -> f64 {
    of(1.0, sizes::PRIMITIVE) + of(2.5, sizes::BINARY_NODE) + INSTANCE
}

/// How the wide tree holds triangles.
struct Wide {
    /// Of eight that a block has room for.
    triangles_a_block: f64,
    blocks_a_node: f64,
    /// References while it is built: more than there are triangles where these are cut.
    references: f64,
}

impl Wide {
    fn of(p: &BvhParams) -> Self {
        let (triangles_a_block, blocks_a_node, references) = match p.build {
            Build::Fast => (7.2, 3.8, 0.8),
            Build::Default => (7.4, 4.9, 0.9),
            Build::Best => (7.4, 4.9, 1.3),
        };
        Self { triangles_a_block, blocks_a_node, references }
    }

    /// For each triangle. Blocks of eight that share vertices, as those of a mesh do, are nearly full. Where triangles are cut there
    /// may be a quarter more.
    fn kept(&self, p: &BvhParams) -> f64 {
        let block = if p.compact { sizes::OUTLINE } else { sizes::BLOCK };
        (of(1.0, block) + of(1.0 / self.blocks_a_node, sizes::WIDE_NODE)) / self.triangles_a_block
    }

    /// References, and the nodes and blocks that they become, which are still there while they are laid out.
    fn building(&self) -> f64 {
        of(self.references, sizes::PRIMITIVE) + self.kept(&BvhParams { compact: false, ..BvhParams::DEFAULT })
    }
}

/// By how much a leaf's size is above another.
fn above(leaf_size: u32, than: u32) -> f64 {
    f64::from(leaf_size.saturating_sub(than))
}

/// Two nodes for each leaf, which is about half full.
fn binary(p: &Bvh2Params) -> f64 {
    let full = f64::from((p.leaf_size / 2).max(1));
    of(1.0, sizes::REFERENCE) + of(2.0, sizes::BINARY_NODE) / full
}

/// Six references, and two nodes; by areas, which cut off empty space, three.
fn bsp(p: &BspParams) -> f64 {
    let full = 1.0 + 0.08 * above(p.leaf_size, 4);
    let nodes = match p.choice {
        BspChoice::Even => 1.9,
        BspChoice::Sah => 3.3,
    };
    (of(6.0, sizes::REFERENCE) + of(nodes, sizes::BSP_NODE)) / full
}

/// Cells by the textbook's formula. Triangles of a surface lie in a number of them that grows with the factor's square.
fn grid(p: &GridParams, n: f64) -> f64 {
    let most = f64::from(p.max_cells) / if n > 0.0 { n } else { 1.0 };
    let cells = p.factor * p.factor * p.factor;
    // Where there would be too many the factor is halved, which leaves an eighth of the cells.
    let cells = if cells > most { most / 2.0 } else { cells };
    let further = 0.3 * p.factor * p.factor;
    let further = if further > most { most } else { further };
    of(cells, size_of::<u32>()) + of(1.8 + further, sizes::REFERENCE)
}

/// Clipped boxes spare references, but make more cuts worth while.
fn kd(p: &KdParams) -> f64 {
    let (references, nodes) = if p.clip { (7.4, 5.4) } else { (6.2, 4.6) };
    let full = 1.0 + 0.08 * above(p.leaf_size, 1);
    (of(references, sizes::REFERENCE) + of(nodes, sizes::KD_NODE)) / full
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Figures measured on the bunny, the dragon and teapots.
    #[test]
    fn a_triangle_takes_what_was_measured() {
        let wide = |build, compact| BvhParams { build, compact };
        for (params, kept) in [
            (wide(Build::Fast, false), 36.0),
            (wide(Build::Fast, true), 15.5),
            (wide(Build::Default, false), 33.0),
            (wide(Build::Best, true), 13.0),
        ] {
            let told = needs(&Structure::Bvh(params), &Space { triangles: 1_000_000, ..Space::default() })
                .kept as f64
                / 1e6;
            assert!((told / kept - 1.0_f64).abs() < 0.03, "{params:?}: {told}");
        }
    }
}
