//! One lane at a time: what every machine has, and what the vector kernels are held against.

use super::{Children, Kernel, Lanes, entry::entry_points};
use crate::{
    local::LocalRay,
    node::{Block, Node, WIDTH},
    triangle,
};
use straal_math::ops;

/// The lesser of two exits by their bits as integers, as all kernels take it: for several processors that is quicker than a
/// comparison of numbers. Of two below 0 it is the greater: both are before any entry. -0 is before all, so that a ray that
/// begins on a plane of a box may enter a box that it doesn't cross.
fn earliest(a: f32, b: f32) -> f32 {
    let (a, b) = (a.to_bits() as i32, b.to_bits() as i32);
    f32::from_bits(if b < a { b } else { a } as u32)
}

/// No vector instructions.
#[derive(Clone, Copy)]
pub(crate) struct Scalar;

impl Kernel for Scalar {
    // Not worth compiling for what no processor with vectors needs: without packets `ao` on a bunny takes 7 % more time, and it has no way to fetch.
    const IN_PACKETS: bool = false;
    const FETCHES: bool = false;

    #[inline(always)]
    fn chosen(self) -> super::Chosen {
        super::Chosen::Scalar(self)
    }

    #[inline(always)]
    fn node(self, r: &LocalRay, node: &Node, limit: f32) -> Children {
        let mut out = Children::NONE;
        let from =
            |axis: usize, side: usize, lane: usize| node.planes[2 * axis + (side & 1)][lane] - r.ray.o[axis];
        for lane in 0..WIDTH {
            let near = |axis: usize| from(axis, usize::from(r.neg[axis]), lane) * r.inv[axis];
            let far = |axis: usize| from(axis, usize::from(!r.neg[axis]), lane) * r.far[axis];
            let enter = ops::max(ops::max(ops::max(near(0), near(1)), near(2)), r.ray.t_min);
            let exit = earliest(earliest(earliest(far(0), far(1)), far(2)), limit);
            if enter <= exit {
                out.keys[lane] = enter.to_bits() & !7 | lane as u32;
                out.mask |= 1 << lane;
            }
        }
        out
    }

    #[inline(always)]
    fn entered(self, r: &LocalRay, node: &Node, limit: f32) -> u32 {
        self.node(r, node, limit).mask
    }

    #[inline(always)]
    fn inside(self, r: &LocalRay, block: &Block) -> u32 {
        (0..block.count())
            .filter(|&lane| triangle::edges(&block.vertices(lane as usize), r).inside())
            .map(|lane| 1 << lane)
            .sum()
    }

    #[inline(always)]
    fn block(self, r: &LocalRay, block: &Block, limit: f32) -> Lanes {
        let mut out = Lanes::NONE;
        for lane in 0..block.count() as usize {
            let edges = triangle::edges(&block.vertices(lane), r);
            let [u, v, w] = edges.e;
            let (least, most) = (ops::min(u, ops::min(v, w)), ops::max(u, ops::max(v, w)));
            let (det, numerator) = (edges.determinant(), edges.numerator(r.shear[2]));
            if !(least >= 0.0 || most <= 0.0) {
                continue;
            }
            if least == 0.0 || most == 0.0 || !edges.is_well_conditioned(det, numerator) {
                out.doubtful |= 1 << lane;
            } else {
                let t = numerator / det;
                if t >= r.ray.t_min && t <= limit {
                    out.hit |= 1 << lane;
                    (out.t[lane], out.det[lane], out.e1[lane], out.e2[lane]) = (t, det, v, w);
                }
            }
        }
        out
    }

    entry_points!();
}
