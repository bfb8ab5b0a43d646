//! From a binary tree to one of eight children a node.
//!
//! A wide node stands for a binary one and some of those below it, which are opened until there are eight parts. Which ones
//! are opened decides how many nodes a ray visits. Opening the largest each time is quick, but leaves nodes of two or
//! three children at the bottom of the tree, where most nodes are. Of all choices, the one with the least sum of the nodes'
//! areas is found from the leaves up: the least for at most k parts below a node follows from those of its two
//! halves (Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs",
//! section 3.1; leaves are given here, so that only the nodes' areas count).

use super::span::Box4;
use crate::node::{Child, WIDTH};

/// A node of the binary tree. In a list, a node stands before what is below it, and the left half before the right.
#[derive(Clone, Copy)]
pub(super) struct Twig {
    lo: [f32; 3],
    hi: [f32; 3],
    pub what: What,
}

#[derive(Clone, Copy)]
pub(super) enum What {
    Leaf(Child),
    /// A range that has a list of its own, by its number.
    Task(u32),
    /// Two halves: the left is the next in the list, this is the right. [`choose`] fills the shares.
    Fork {
        right: u32,
        shares: Shares,
    },
}

/// By k - 1, how many of k parts are the left half's; 0 where it is best not to open.
pub(super) type Shares = [u8; WIDTH];

/// By k - 1, the least sum of half areas of the nodes where there are at most k parts.
pub(super) type Costs = [f32; WIDTH];

impl Twig {
    pub const fn new(bounds: &Box4, what: What) -> Self {
        let Box4 { lo, hi } = *bounds;
        Self { lo: [lo[0], lo[1], lo[2]], hi: [hi[0], hi[1], hi[2]], what }
    }

    pub const fn bounds(&self) -> Box4 {
        let Self { lo, hi, .. } = *self;
        Box4 { lo: [lo[0], lo[1], lo[2], 0.0], hi: [hi[0], hi[1], hi[2], 0.0] }
    }
}

impl What {
    /// The number of a range that has a list of its own.
    pub const fn task(self) -> Option<usize> {
        match self {
            Self::Task(i) => Some(i as usize),
            _ => None,
        }
    }
}

/// Finds which nodes are best opened, and what the whole costs; `tasks` has what the ranges cost that have lists of their
/// own.
pub(super) fn choose(twigs: &mut [Twig], tasks: &[Costs]) -> Costs {
    // Of the nodes whose other half or parent comes next, the last on top.
    let mut below: Vec<Costs> = Vec::new();
    let take = |below: &mut Vec<Costs>| below.pop().unwrap_or([0.0; WIDTH]);
    for twig in twigs.iter_mut().rev() {
        let half_area = twig.bounds().half_area();
        let costs = match &mut twig.what {
            What::Leaf(_) => [0.0; WIDTH],
            What::Task(i) => tasks[*i as usize],
            What::Fork { shares, .. } => {
                let (left, right) = (take(&mut below), take(&mut below));
                let costs;
                (costs, *shares) = fork(half_area, &left, &right);
                costs
            }
        };
        below.push(costs);
    }
    take(&mut below)
}

fn fork(half_area: f32, left: &Costs, right: &Costs) -> (Costs, Shares) {
    let (mut costs, mut shares) = ([0.0; WIDTH], [0; WIDTH]);
    for k in 2..=WIDTH {
        let (mut least, mut share) = (left[0] + right[k - 2], 1);
        for j in 2..k {
            let cost = left[j - 1] + right[k - j - 1];
            if cost < least {
                (least, share) = (cost, j as u8);
            }
        }
        (costs[k - 1], shares[k - 1]) = (least, share);
    }
    // A node of its own, which is never for nothing.
    let closed = half_area + f32::MIN_POSITIVE + costs[WIDTH - 1];
    costs[0] = closed;
    for k in 2..WIDTH {
        if closed < costs[k - 1] {
            (costs[k - 1], shares[k - 1]) = (closed, 0);
        }
    }
    (costs, shares)
}

/// Calls `part` with each of the at most `k` parts that a node is best opened into, in the list's order, and for one that
/// has a list of its own with how many it may be opened into.
pub(super) fn parts(twigs: &[Twig], at: u32, k: usize, part: &mut impl FnMut(u32, usize)) {
    match twigs[at as usize].what {
        What::Fork { right, shares } if shares[k - 1] > 0 => {
            let share = usize::from(shares[k - 1]);
            parts(twigs, at + 1, share, part);
            parts(twigs, right, k - share, part);
        }
        _ => part(at, k),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tree of `leaves` leaves, cut at random, in boxes of random areas.
    fn random(leaves: u32, state: &mut u32, twigs: &mut Vec<Twig>) {
        let mut draw = || {
            *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *state >> 16
        };
        let mut bounds = Box4 { lo: [0.0; 4], hi: [0.0; 4] };
        bounds.hi = [(1 + draw() % 50) as f32, (1 + draw() % 50) as f32, 0.0, 0.0];
        let at = twigs.len();
        twigs.push(Twig::new(&bounds, What::Leaf(Child::DONE)));
        if leaves > 1 {
            let left = 1 + draw() % (leaves - 1);
            random(left, state, twigs);
            twigs[at].what = What::Fork { right: twigs.len() as u32, shares: [0; WIDTH] };
            random(leaves - left, state, twigs);
        }
    }

    /// Each number of parts that what is below a twig can be opened into, with the least cost: all ways are tried.
    fn ways(twigs: &[Twig], at: u32) -> Vec<(usize, f32)> {
        let What::Fork { right, .. } = twigs[at as usize].what else { return vec![(1, 0.0)] };
        let (left, right) = (ways(twigs, at + 1), ways(twigs, right));
        let mut out: Vec<(usize, f32)> = Vec::new();
        for &(a, cost_a) in &left {
            for &(b, cost_b) in &right {
                out.push((a + b, cost_a + cost_b));
            }
        }
        let open = out.iter().filter(|(n, _)| *n <= WIDTH).map(|w| w.1).fold(f32::INFINITY, least);
        out.push((1, twigs[at as usize].bounds().half_area() + open));
        out
    }

    fn least(a: f32, b: f32) -> f32 {
        if b < a { b } else { a }
    }

    /// The sum of half areas of the nodes that are made.
    fn made(twigs: &[Twig], at: u32) -> f32 {
        if matches!(twigs[at as usize].what, What::Leaf(_)) {
            return 0.0;
        }
        let mut sum = twigs[at as usize].bounds().half_area();
        let mut count = 0;
        parts(twigs, at, WIDTH, &mut |part, _| {
            sum += made(twigs, part);
            count += 1;
        });
        assert!((2..=WIDTH).contains(&count));
        sum
    }

    #[test]
    fn nothing_is_better_than_what_is_chosen() {
        let mut state = 1;
        for round in 0..200 {
            let mut twigs = Vec::new();
            random(2 + round % 13, &mut state, &mut twigs);
            let costs = choose(&mut twigs, &[]);
            let closed = ways(&twigs, 0).into_iter().filter(|w| w.0 == 1).map(|w| w.1);
            assert_eq!(costs[0], closed.fold(f32::INFINITY, least), "round {round}");
            assert_eq!(costs[0], made(&twigs, 0), "round {round}");
        }
    }

    /// As if the right half had a list of its own.
    #[test]
    fn lists_of_their_own_cost_the_same() {
        let (mut state, mut right) = (7, Vec::new());
        random(9, &mut state, &mut right);
        let mut apart = vec![right[0], right[0], right[0]];
        apart[0].what = What::Fork { right: 2, shares: [0; WIDTH] };
        apart[1].what = What::Leaf(Child::DONE);
        apart[2].what = What::Task(0);
        let mut whole = apart[..2].to_vec();
        whole.extend(right.iter().map(|t| match t.what {
            What::Fork { right, shares } => Twig { what: What::Fork { right: right + 2, shares }, ..*t },
            _ => *t,
        }));
        let task = choose(&mut right, &[]);
        assert_eq!(choose(&mut apart, &[task]), choose(&mut whole, &[]));
    }

    /// Of boxes without area, as few nodes as can be.
    #[test]
    fn a_node_is_never_for_nothing() {
        let mut twigs = Vec::new();
        random(8, &mut 3, &mut twigs);
        twigs.iter_mut().for_each(|t| (t.lo, t.hi) = ([0.0; 3], [0.0; 3]));
        choose(&mut twigs, &[]);
        let mut count = 0;
        parts(&twigs, 0, WIDTH, &mut |part, _| {
            assert!(matches!(twigs[part as usize].what, What::Leaf(_)));
            count += 1;
        });
        assert_eq!(count, 8);
    }
}
