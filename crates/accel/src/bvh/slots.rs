//! Which slot of a node each child takes.
//!
//! A slot stands for a corner of the node: bit a of its number is 1 for the greater half along axis a. Children take the
//! slots in whose direction they lie, so that a ray meets them about in the order of (slot xor octant of its direction),
//! and a search needs no sort (Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through
//! Compressed Wide BVHs", section 3.2; they solve the assignment by an auction, here each time the best of all pairs that
//! are left is taken).

use crate::node::WIDTH;

/// The slot of each child, by how far its centre lies from the node's along each axis, in any unit.
pub(super) fn assign(offsets: &[[f32; 3]]) -> [usize; WIDTH] {
    let mut gain = [[0.0; WIDTH]; WIDTH];
    for (gain, [x, y, z]) in gain.iter_mut().zip(offsets) {
        for (slot, gain) in gain.iter_mut().enumerate() {
            let along = |axis: usize, by: f32| if slot >> axis & 1 == 1 { by } else { -by };
            *gain = along(0, *x) + along(1, *y) + along(2, *z);
        }
    }
    let mut slots = [0; WIDTH];
    let (mut placed, mut taken) = (0_u32, 0_u32);
    for _ in offsets.iter().take(WIDTH) {
        let mut best = (f32::NEG_INFINITY, None);
        for (child, gain) in gain.iter().enumerate().take(offsets.len()) {
            if placed >> child & 1 == 1 {
                continue;
            }
            for (slot, &gain) in gain.iter().enumerate() {
                if taken >> slot & 1 == 0 && (gain > best.0 || best.1.is_none()) {
                    best = (gain, Some((child, slot)));
                }
            }
        }
        if let Some((child, slot)) = best.1 {
            slots[child] = slot;
            placed |= 1 << child;
            taken |= 1 << slot;
        }
    }
    slots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_take_their_own_slots() {
        let corner = |slot: usize| std::array::from_fn(|a| if slot >> a & 1 == 1 { 1.0 } else { -1.0 });
        let order = [3, 0, 6, 5, 1, 7, 2, 4];
        assert_eq!(assign(&order.map(corner)), order);
    }

    #[test]
    fn each_child_has_a_slot_of_its_own() {
        for offset in [[0.0; 3], [f32::NAN; 3], [f32::INFINITY; 3], [1.0, 0.0, 0.0]] {
            let mut slots = assign(&[offset; WIDTH]);
            slots.sort_unstable();
            assert_eq!(slots, [0, 1, 2, 3, 4, 5, 6, 7]);
        }
    }
}
