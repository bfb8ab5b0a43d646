//! Loading ahead what a search visits next.

#[cfg(target_arch = "x86_64")]
use crate::bvh::{Block, Child, Node};

/// Nothing is prefetched.
pub(crate) const NOT: u8 = 0;

/// To the first-level cache.
pub(crate) const TO_FIRST: u8 = 1;

/// To the second-level cache, from which the first is filled in time: it keeps track of more lines that are under way
/// (measured on Zen 4, of a node's lines from memory: 5 ns each in place of 8). Where the lines are nearer, the way from
/// there costs more than that gains.
pub(crate) const TO_SECOND: u8 = 2;

/// `Kernel::prefetch` of all x86 kernels.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(super) fn prefetch<const HOW: u8>(nodes: &[Node], blocks: &[Block], child: Child) {
    use std::arch::x86_64::{_MM_HINT_T0, _MM_HINT_T1, _mm_prefetch};
    // Computed, since a branch on the class would be guessed wrongly. For an object or the end, some other place is
    // loaded, which does no harm.
    let leaf = child.leaf();
    let from_nodes = blocks.as_ptr().addr().wrapping_sub(nodes.as_ptr().addr());
    let size = size_of::<Node>() - leaf * (size_of::<Node>() - size_of::<Block>());
    let offset = (from_nodes & 0_usize.wrapping_sub(leaf)).wrapping_add(child.index() * size);
    let start = nodes.as_ptr().cast::<i8>().wrapping_add(offset);
    for line in 0..LINES {
        // A block's last line in place of one more.
        let offset = if line + 1 < LINES { line * 64 } else { size - 64 };
        let at = start.wrapping_add(offset);
        // SAFETY: a prefetch changes nothing, whatever the address. SSE is part of x86-64.
        unsafe {
            match HOW {
                TO_SECOND => _mm_prefetch::<_MM_HINT_T1>(at),
                _ => _mm_prefetch::<_MM_HINT_T0>(at),
            }
        }
    }
}

/// Cache lines of the larger of node and block.
#[cfg(target_arch = "x86_64")]
const LINES: usize = size_of::<Node>() / 64;
