//! Nodes and blocks in one array of cache lines, each named by the number of its first line.
//!
//! So what a ray visits one after the other can lie side by side, and a child's address is its number times 64, whatever it is.

use super::pages::want_large;
use crate::node::{Block, Node};

/// A cache line of a node or a block.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([u32; 16]);

/// The array.
pub(crate) struct Lines(Vec<Line>);

/// Bytes of a line.
pub(crate) const LINE: usize = size_of::<Line>();

/// Lines of a node.
pub(crate) const NODE: usize = size_of::<Node>() / LINE;

/// Lines of a block.
pub(crate) const BLOCK: usize = size_of::<Block>() / LINE;

const _: () = assert!(NODE * LINE == size_of::<Node>() && BLOCK * LINE == size_of::<Block>());
const _: () = assert!(align_of::<Node>() == LINE && align_of::<Block>() == LINE);

impl Lines {
    pub const EMPTY: Self = Self(Vec::new());

    /// Room for so many.
    pub fn with_capacity(lines: usize) -> Self {
        let mut out = Vec::with_capacity(lines);
        want_large(&mut out);
        Self(out)
    }

    /// How many there are.
    pub const fn len(&self) -> usize {
        self.0.len()
    }

    /// Adds a node.
    pub fn push_node(&mut self, node: &Node) {
        let lines = (&raw const *node).cast::<[Line; NODE]>();
        // SAFETY: a node is nothing but four lines of numbers of 32 bits, aligned as they are.
        self.0.extend_from_slice(unsafe { &*lines });
    }

    /// Adds a block.
    pub fn push_block(&mut self, block: &Block) {
        let lines = (&raw const *block).cast::<[Line; BLOCK]>();
        // SAFETY: as with nodes.
        self.0.extend_from_slice(unsafe { &*lines });
    }

    /// Puts a node where another begins.
    pub fn set_node(&mut self, line: usize, node: &Node) {
        let from = (&raw const *node).cast::<[Line; NODE]>();
        // SAFETY: as where one is added.
        self.0[line..line + NODE].copy_from_slice(unsafe { &*from });
    }

    /// Puts a block where another begins.
    pub fn set_block(&mut self, line: usize, block: &Block) {
        let from = (&raw const *block).cast::<[Line; BLOCK]>();
        // SAFETY: as with nodes.
        self.0[line..line + BLOCK].copy_from_slice(unsafe { &*from });
    }

    /// What nodes are read from in a loop.
    #[inline(always)]
    pub const fn nodes(&self) -> Nodes<'_> {
        Nodes { lines: self.0.as_slice(), end: (self.0.len() + 1).saturating_sub(NODE) }
    }

    /// The node that begins at a line.
    #[inline(always)]
    pub fn node(&self, line: usize) -> &Node {
        self.nodes().get(line)
    }

    /// The block that begins at a line.
    #[inline(always)]
    pub fn block(&self, line: usize) -> &Block {
        let lines: *const [Line] = &raw const self.0[line..line + BLOCK];
        // SAFETY: as with nodes.
        unsafe { &*lines.cast::<Block>() }
    }

    /// Where the first line is.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub const fn start(&self) -> *const i8 {
        self.0.as_ptr().cast()
    }
}

/// Nodes of a [`Lines`], with what their numbers are checked against.
///
/// A copy of it, before a loop in which registers are short, spares the way through the tree for each node: 3 to 4 %.
#[derive(Clone, Copy)]
pub(crate) struct Nodes<'a> {
    lines: &'a [Line],
    /// From this line on there is no room for a node.
    end: usize,
}

impl<'a> Nodes<'a> {
    /// The node that begins at a line.
    #[inline(always)]
    pub fn get(self, line: usize) -> &'a Node {
        assert!(line < self.end, "no node at line {line}");
        // SAFETY: there are as many lines from there as a node has, aligned as it is. Any bits make one: numbers of 32 bits.
        unsafe { &*self.lines.as_ptr().add(line).cast::<Node>() }
    }
}
