//! Loading ahead what a search visits next.

#[cfg(target_arch = "x86_64")]
use super::lines::{BLOCK, LINE, Lines, NODE};
#[cfg(target_arch = "x86_64")]
use crate::node::Child;

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
pub(super) fn prefetch<const HOW: u8>(lines: &Lines, child: Child) {
    use std::arch::x86_64::{_MM_HINT_T0, _MM_HINT_T1, _mm_prefetch};
    let start = lines.start().wrapping_add(child.index() * LINE);
    // Computed, since a branch on the class would be guessed wrongly. For an object or the end, some other place is
    // loaded, which does no harm.
    let last = (NODE - 1) - child.leaf() * (NODE - BLOCK);
    for line in 0..NODE {
        // A block's last line in place of one more.
        let line = if line + 1 < NODE { line } else { last };
        let at = start.wrapping_add(line * LINE);
        // SAFETY: a prefetch changes nothing, whatever the address. SSE is part of x86-64.
        unsafe {
            match HOW {
                TO_SECOND => _mm_prefetch::<_MM_HINT_T1>(at),
                _ => _mm_prefetch::<_MM_HINT_T0>(at),
            }
        }
    }
}
