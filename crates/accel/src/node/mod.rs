//! What the wide tree is made of, as kernels read it: nodes of eight boxes, blocks of triangles, and bundles of rays.

pub(crate) mod block;
pub(crate) mod bundle;

pub(crate) use block::{Block, Outline};

use straal_math::{Bounds, Vec3};

/// Boxes in a node, triangles in a block.
pub(crate) const WIDTH: usize = 8;

/// Steps from the root to the deepest leaf, at most.
pub(crate) const MOST_LEVELS: usize = 71;

/// What a search's stack must hold: seven more on each level.
pub(crate) const STACK: usize = 7 * MOST_LEVELS + 1;

/// Eight boxes and what is inside each: four cache lines.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Least x, greatest x, least y, ... of all children. Those of an empty slot can't be crossed.
    pub planes: [[f32; WIDTH]; 6],
    pub children: [Child; WIDTH],
}

impl Node {
    pub const EMPTY: Self = {
        let (least, most) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Self { planes: [least, most, least, most, least, most], children: [Child(0); WIDTH] }
    };
}

impl Node {
    /// Whether a slot has a child.
    pub fn is_used(&self, lane: usize) -> bool {
        self.planes[0][lane] < f32::INFINITY
    }

    /// Gives a child another box.
    pub fn set_bounds(&mut self, lane: usize, b: &Bounds) {
        let (min, max) = (b.min.to_array(), b.max.to_array());
        for axis in 0..3 {
            self.planes[2 * axis][lane] = min[axis];
            self.planes[2 * axis + 1][lane] = max[axis];
        }
    }

    /// The box around all children.
    pub fn whole(&self) -> Bounds {
        (0..WIDTH)
            .filter(|&lane| self.is_used(lane))
            .fold(Bounds::EMPTY, |b, lane| b.union(self.bounds(lane)))
    }

    /// Boxes in it, for counting.
    pub fn count(&self) -> u32 {
        self.planes[0].iter().map(|&x| u32::from(x < f32::INFINITY)).sum()
    }

    /// The box of a child.
    pub fn bounds(&self, lane: usize) -> Bounds {
        let p = |plane: usize| self.planes[plane][lane];
        Bounds { min: Vec3::new(p(0), p(2), p(4)), max: Vec3::new(p(1), p(3), p(5)) }
    }
}

#[cfg(test)]
impl Node {
    /// A node of boxes alone, to test kernels.
    pub fn of_planes(planes: [[f32; WIDTH]; 6]) -> Self {
        Self { planes, ..Self::EMPTY }
    }
}

/// What a box contains: the highest two bits tell the kind, the others are an index: the first line of a node or of a
/// block, but the number of an object or of an outline, or with one more bit that of a block of shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Child(u32);

/// The same, taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChildKind {
    Node(u32),
    Block(u32),
    Object(u32),
    Shapes(u32),
    Done,
}

/// The two highest bits of a child.
pub(crate) mod class {
    pub const NODE: usize = 0;
    pub const DONE: usize = 1;
    pub const BLOCK: usize = 2;
    pub const OBJECT: usize = 3;
}

impl Child {
    const LEAF: u32 = 1 << 31;
    /// Indices are less than this.
    pub const OBJECT: u32 = 1 << 30;
    const SHAPES: u32 = 1 << 29;

    /// The end of a search.
    pub const DONE: Self = Self(Self::OBJECT);

    pub const fn node(i: u32) -> Self {
        Self(i)
    }

    pub const fn block(i: u32) -> Self {
        Self(i | Self::LEAF)
    }

    pub const fn object(i: u32) -> Self {
        Self(i | Self::LEAF | Self::OBJECT)
    }

    pub const fn shapes(i: u32) -> Self {
        Self::object(i | Self::SHAPES)
    }

    /// The block of shapes that it is, if it is one.
    #[inline(always)]
    pub const fn as_shapes(self) -> Option<usize> {
        let of = Self::LEAF | Self::OBJECT | Self::SHAPES;
        if self.0 >= of { Some((self.0 - of) as usize) } else { None }
    }

    /// Whether it is a leaf of any kind: 0 or 1.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub const fn leaf(self) -> usize {
        (self.0 >> 31) as usize
    }

    /// The same, where `nodes`, `blocks` and blocks of `shapes` stand before its own.
    pub const fn moved(self, nodes: u32, blocks: u32, shapes: u32) -> Self {
        match self.kind() {
            ChildKind::Node(i) => Self::node(i + nodes),
            ChildKind::Block(i) => Self::block(i + blocks),
            ChildKind::Shapes(i) => Self::shapes(i + shapes),
            ChildKind::Object(_) | ChildKind::Done => self,
        }
    }

    /// The number in the class.
    #[inline(always)]
    pub const fn index(self) -> usize {
        (self.0 & (Self::OBJECT - 1)) as usize
    }

    /// Whether it is a node.
    #[inline(always)]
    pub const fn is_node(self) -> bool {
        self.0 < Self::OBJECT
    }

    /// Whether it is a block.
    #[inline(always)]
    pub const fn is_block(self) -> bool {
        self.class() == class::BLOCK
    }

    /// One of [`class`].
    #[inline(always)]
    pub const fn class(self) -> usize {
        (self.0 >> 30) as usize
    }

    #[inline(always)]
    pub const fn kind(self) -> ChildKind {
        let i = self.0 & (Self::OBJECT - 1);
        match self.class() {
            class::NODE => ChildKind::Node(i),
            class::BLOCK => ChildKind::Block(i),
            class::OBJECT if i >= Self::SHAPES => ChildKind::Shapes(i - Self::SHAPES),
            class::OBJECT => ChildKind::Object(i),
            _ => ChildKind::Done,
        }
    }
}
