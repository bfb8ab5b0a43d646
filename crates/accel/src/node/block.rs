//! The triangles of a leaf.
//!
//! Triangles side by side share vertices: eight of a mesh have nine or ten, where eight apart have 24. A block keeps each
//! vertex once, and which three of them are each triangle's. So it takes three cache lines in place of five, and a search
//! moves each vertex to the ray once; that is done before vertices are handed to triangles, which changes no bit.

use super::WIDTH;
use crate::local::ROW;
use straal_math::Vec3;

/// Vertices of a block.
pub(crate) const VERTICES: usize = 12;

/// Up to eight triangles of up to [`VERTICES`] vertices: three cache lines.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Block {
    /// By axis.
    pub rows: [Row; 3],
}

/// A cache line of a block: an axis' coordinates, and what else there is room for.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Row {
    /// The vertices' coordinates.
    pub places: [f32; VERTICES],
    /// In row i: the number of vertex i of each triangle, four bits for each lane. 0 in unused lanes.
    pub corners: u32,
    /// The triangles' numbers in the group, three by three; the last is the set of used lanes.
    ids: [u32; 3],
}

const _: () = assert!(size_of::<Row>() == ROW as usize);

/// The number of a lane's vertex. They are below [`VERTICES`]; telling so by a comparison is quicker than by a remainder.
#[inline(always)]
const fn corner(corners: u32, lane: usize) -> usize {
    let vertex = (corners >> (4 * lane % 32) & 15) as usize;
    if vertex < VERTICES { vertex } else { 0 }
}

/// Which triangles a block has, and which of its vertices are theirs.
#[derive(Clone, Copy)]
pub(crate) struct Outline {
    /// `u32::MAX` in an unused lane.
    ids: [u32; WIDTH],
    /// As in [`Row`].
    corners: [u32; 3],
}

impl Outline {
    /// Of triangles by their numbers, no more than eight; `None` if they have too many vertices. One triangle hasn't.
    pub fn of(
        triangles: impl Iterator<Item = u32>,
        vertices: impl Fn(u32) -> [Vec3; 3],
    ) -> Option<(Self, Block)> {
        let mut out = Self { ids: [u32::MAX; WIDTH], corners: [0; 3] };
        let mut known = [[0; 3]; VERTICES];
        let mut count = 0;
        for (lane, (to, id)) in out.ids.iter_mut().zip(triangles).enumerate() {
            *to = id;
            for (corners, vertex) in out.corners.iter_mut().zip(vertices(id)) {
                let bits = vertex.to_array().map(f32::to_bits);
                let vertex = match known[..count].iter().position(|&other| other == bits) {
                    Some(vertex) => vertex,
                    None => {
                        *known.get_mut(count)? = bits;
                        count += 1;
                        count - 1
                    }
                };
                *corners |= (vertex as u32) << (4 * lane);
            }
        }
        let mut block = out.empty_block();
        for (i, vertex) in known.iter().enumerate() {
            for (row, &bits) in block.rows.iter_mut().zip(vertex) {
                row.places[i] = f32::from_bits(bits);
            }
        }
        Some((out, block))
    }

    /// The block, its vertices looked up.
    pub fn block(&self, vertices: impl Fn(u32) -> [Vec3; 3]) -> Block {
        let mut out = self.empty_block();
        for (lane, id) in self.ids().enumerate() {
            for (corners, vertex) in self.corners.iter().zip(vertices(id)) {
                for (row, x) in out.rows.iter_mut().zip(vertex.to_array()) {
                    row.places[corner(*corners, lane)] = x;
                }
            }
        }
        out
    }

    /// The triangles' numbers.
    pub fn ids(&self) -> impl Iterator<Item = u32> + '_ {
        self.ids.iter().copied().take_while(|&id| id != u32::MAX)
    }

    /// All but the vertices.
    fn empty_block(&self) -> Block {
        let [a, b, c, d, e, f, g, h] = self.ids;
        let row = |i: usize, ids: [u32; 3]| Row { places: [0.0; VERTICES], corners: self.corners[i], ids };
        let lanes = (1 << self.ids().count()) - 1;
        Block { rows: [row(0, [a, b, c]), row(1, [d, e, f]), row(2, [g, h, lanes])] }
    }
}

impl Block {
    /// The vertices of a lane's triangle.
    #[inline(always)]
    pub fn vertices(&self, lane: usize) -> [Vec3; 3] {
        let [x, y, z] = &self.rows;
        let at = |i: usize| Vec3::new(x.places[i], y.places[i], z.places[i]);
        let corner = |row: &Row| corner(row.corners, lane);
        [at(corner(x)), at(corner(y)), at(corner(z))]
    }

    /// The number of a lane's triangle in the group.
    #[inline(always)]
    pub fn id(&self, lane: usize) -> u32 {
        self.rows[lane / 3 % 3].ids[lane % 3]
    }

    /// The set of lanes that have triangles.
    #[inline(always)]
    pub const fn lanes(&self) -> u32 {
        self.rows[2].ids[2]
    }

    /// Triangles in it.
    pub const fn count(&self) -> u32 {
        self.lanes().count_ones()
    }

    /// The numbers of all triangles.
    pub fn ids(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.count() as usize).map(|lane| self.id(lane))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles of a strip share two vertices with the one before.
    fn strip(id: u32) -> [Vec3; 3] {
        [0, 1, 2].map(|i| Vec3::new((id + i) as f32, f32::from((id + i) as u8 % 2), -0.0))
    }

    /// Triangles that share nothing.
    fn apart(id: u32) -> [Vec3; 3] {
        [0, 1, 2].map(|i| Vec3::splat((3 * id + i) as f32))
    }

    #[test]
    fn a_block_gives_back_its_triangles() {
        assert_eq!(size_of::<Block>(), 192);
        for (count, vertices) in [(8, strip as fn(u32) -> _), (1, strip), (4, apart)] {
            let (outline, block) = Outline::of(5..5 + count, vertices).expect("few vertices");
            assert_eq!(block.count(), count);
            for block in [block, outline.block(vertices)] {
                assert!(block.ids().eq(5..5 + count));
                for (lane, id) in (5..5 + count).enumerate() {
                    let bits = |v: [Vec3; 3]| v.map(|p| p.to_array().map(f32::to_bits));
                    assert_eq!(bits(block.vertices(lane)), bits(vertices(id)));
                }
            }
        }
    }

    #[test]
    fn too_many_vertices_make_no_block() {
        assert!(Outline::of(0..5, apart).is_none());
    }

    #[test]
    fn zeros_keep_their_signs() {
        let zeros = |id: u32| [if id == 0 { Vec3::ZERO } else { -Vec3::ZERO }; 3];
        let (_, block) = Outline::of(0..2, zeros).expect("two vertices");
        assert!(block.vertices(0)[0].x.is_sign_positive() && block.vertices(1)[0].x.is_sign_negative());
    }
}
