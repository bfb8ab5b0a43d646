//! Up to eight shapes, of one kind where those of a kind stand together, with their numbers side by side, and one ray against all
//! of them.

use super::{
    Analytic, Kind, NUMBERS,
    forms::{Lanes, meet},
};
use crate::{
    lanes::{Double, Doubles, Mask, ROW, Single, Singles, Wide},
    local::LocalRay,
    slab::EXIT,
};
use straal_math::Bounds;

/// Of so many shapes of a block or fewer, each is tested by itself: a division of eight numbers takes longer than two of one.
const ALONE: u32 = 2;

/// A shape of a group, to be put in a block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Member {
    /// Its number among the group's objects.
    pub object: u32,
    pub mask: u32,
    /// Padded; infinite where the shape is unbounded.
    pub bounds: Bounds,
    pub shape: Analytic,
}

/// A number of each shape of a block: a cache line.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Row(Doubles);

/// Bytes of a number of each shape.
pub(crate) const ROW_BYTES: usize = size_of::<Row>();

/// What each shape of a block has besides its numbers.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Head {
    /// Least x, greatest x, least y, ... of the shapes' own boxes.
    pub planes: [Singles; 6],
    pub objects: [u32; ROW],
    pub masks: [u32; ROW],
    pub kinds: [Kind; ROW],
    /// Whether all are of one kind.
    is_pure: bool,
    pub count: u32,
    /// Its first row.
    first: u32,
}

/// Blocks of shapes.
#[derive(Default)]
pub(crate) struct Blocks {
    heads: Vec<Head>,
    /// With so many behind the last block's own that each has [`NUMBERS`] from its first on.
    rows: Vec<Row>,
    /// The bits that all masks have.
    pub all_masks: u32,
}

/// A block where it lies.
#[derive(Clone, Copy)]
pub(crate) struct Block<'a> {
    pub head: &'a Head,
    rows: &'a [Row; NUMBERS],
}

/// What a ray meets in a block.
#[derive(Clone, Copy)]
pub(crate) struct Found {
    /// The shapes that are hit, each in its own box, whatever their masks.
    pub hit: u32,
    pub t: Doubles,
    pub u: Doubles,
    pub v: Doubles,
}

impl Blocks {
    pub const EMPTY: Self = Self { heads: Vec::new(), rows: Vec::new(), all_masks: u32::MAX };

    /// Blocks of shapes in any order.
    pub fn of(members: &[Member]) -> Self {
        let mut sorted = members.to_vec();
        sorted.sort_unstable_by_key(|m| (m.shape.kind, m.object));
        let mut out = Self::EMPTY;
        for some in sorted.chunk_by(|a, b| a.shape.kind == b.shape.kind) {
            some.chunks(ROW).for_each(|block| out.push(block));
        }
        out
    }

    /// Adds a block of one shape at least and eight at most.
    pub fn push(&mut self, members: &[Member]) {
        let Some(first) = members.first() else { return };
        self.rows.truncate(self.rows.len().saturating_sub(self.padding()));
        let mut head = Head {
            planes: [[0.0; ROW]; 6],
            objects: [0; ROW],
            masks: [0; ROW],
            kinds: [first.shape.kind; ROW],
            is_pure: members.iter().all(|m| m.shape.kind == first.shape.kind),
            count: members.len() as u32,
            first: self.rows.len() as u32,
        };
        let mut rows = [Row([0.0; ROW]); NUMBERS];
        for lane in 0..ROW {
            // Unused lanes repeat the last.
            let m = members.get(lane).or(members.last()).unwrap_or(first);
            let (min, max) = (m.bounds.min.to_array(), m.bounds.max.to_array());
            for axis in 0..3 {
                head.planes[2 * axis][lane] = min[axis];
                head.planes[2 * axis + 1][lane] = max[axis];
            }
            head.objects[lane] = m.object;
            head.masks[lane] = m.mask;
            head.kinds[lane] = m.shape.kind;
            self.all_masks &= m.mask;
            rows.iter_mut().zip(m.shape.numbers).for_each(|(row, x)| row.0[lane] = x);
        }
        self.heads.push(head);
        self.rows.extend_from_slice(&rows);
    }

    /// Adds the blocks of another list.
    pub fn append(&mut self, other: &Self) {
        if other.is_empty() {
            return;
        }
        self.rows.truncate(self.rows.len().saturating_sub(self.padding()));
        let before = self.rows.len() as u32;
        self.heads.extend(other.heads.iter().map(|head| Head { first: head.first + before, ..*head }));
        self.rows.extend_from_slice(&other.rows);
        self.all_masks &= other.all_masks;
    }

    /// Rows behind those of the last block.
    fn padding(&self) -> usize {
        self.heads
            .last()
            .map_or(0, |head| NUMBERS - if head.is_pure { head.kinds[0].numbers() } else { NUMBERS })
    }

    pub fn len(&self) -> usize {
        self.heads.len()
    }

    pub fn is_empty(&self) -> bool {
        self.heads.is_empty()
    }

    #[inline(always)]
    pub fn get(&self, i: usize) -> Block<'_> {
        static NOTHING: [Row; NUMBERS] = [Row([0.0; ROW]); NUMBERS];
        let head = &self.heads[i];
        let rows = self.rows[head.first as usize..].first_chunk().unwrap_or(&NOTHING);
        Block { head, rows }
    }

    pub fn iter(&self) -> impl Iterator<Item = Block<'_>> {
        (0..self.len()).map(|i| self.get(i))
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.heads.as_slice()) + size_of_val(self.rows.as_slice())
    }
}

/// Where each lane's ray crosses each lane's box: the entry, and whether it does in its interval, as `slab::entry` tells.
#[inline(always)]
pub(crate) fn crossing<S: Single>(
    plane: impl Fn(usize) -> S,
    o: [S; 3],
    inv: [S; 3],
    (t_min, t_max, exit_factor): (S, S, S),
) -> (S, S, S::Mask) {
    let along = |axis: usize| {
        let a = (plane(2 * axis) - o[axis]) * inv[axis];
        let b = (plane(2 * axis + 1) - o[axis]) * inv[axis];
        (a.least(b), a.most(b))
    };
    let ((x, x_out), (y, y_out), (z, z_out)) = (along(0), along(1), along(2));
    let enter = x.most(y).most(z);
    let exit = x_out.least(y_out).least(z_out) * exit_factor;
    let start = enter.most(t_min);
    (enter, start, start.at_most(exit.least(t_max)))
}

impl Block<'_> {
    /// A number of a shape.
    #[inline(always)]
    pub fn number(&self, row: usize, lane: usize) -> f64 {
        self.rows[row].0[lane % ROW]
    }

    /// The lanes that have shapes.
    #[inline(always)]
    pub fn lanes(&self) -> u32 {
        (1 << self.head.count) - 1
    }

    /// The shapes that a ray hits up to `limit`, which is no later than its end.
    #[inline(always)]
    pub fn meet<W: Wide>(&self, w: W, r: &LocalRay, limit: f32) -> Found {
        let mut out = Found { hit: 0, t: [0.0; ROW], u: [0.0; ROW], v: [0.0; ROW] };
        let (o, inv) = (r.ray.o.to_array().map(|x| w.single(x)), r.inv.to_array().map(|x| w.single(x)));
        // No box is entered beyond the limit, which lies in the interval.
        let interval = (w.single(r.ray.t_min), w.single(limit), w.single(EXIT));
        let mut at = 0;
        while at < ROW && at < self.head.count as usize {
            let plane = |i: usize| w.singles(&self.head.planes[i], at);
            let (enter, _, is_crossed) = crossing(plane, o, inv, interval);
            let near = is_crossed.bits() & self.lanes() >> at;
            if near != 0 {
                if self.head.is_pure && near.count_ones() > ALONE {
                    self.meet_lanes(w, r, (enter, w.wide_mask(is_crossed)), (limit, at), &mut out);
                } else {
                    let mut entries = [0.0; ROW];
                    w.put_singles(enter, &mut entries, at);
                    self.meet_each(r, (near << at, &entries), limit, &mut out);
                }
            }
            at += W::LANES;
        }
        out.hit &= self.lanes();
        out
    }

    /// Works out the formula in all lanes from `at` on.
    #[inline(always)]
    fn meet_lanes<W: Wide>(
        &self,
        w: W,
        r: &LocalRay,
        (enter, is_near): (W::Single, <W::Double as Double>::Mask),
        (limit, at): (f32, usize),
        out: &mut Found,
    ) {
        let splat = |x: f32| w.double(f64::from(x));
        let lanes = Lanes {
            o: r.ray.o.to_array().map(splat),
            d: r.ray.d.to_array().map(splat),
            t_min: splat(r.ray.t_min),
            t_max: splat(r.ray.t_max),
        };
        let met = meet(self.head.kinds[0], |row| w.doubles(&self.rows[row].0, at), &lanes);
        let enter = w.widened(enter);
        let t = enter.or(met.t.below(enter), met.t);
        let is_hit = is_near & met.is_hit & t.at_most(splat(limit));
        out.hit |= is_hit.bits() << at;
        w.put_doubles(t, &mut out.t, at);
        w.put_doubles(met.u, &mut out.u, at);
        w.put_doubles(met.v, &mut out.v, at);
    }

    /// Works out the formulas of some lanes one by one.
    #[inline(always)]
    fn meet_each(&self, r: &LocalRay, (mut near, entries): (u32, &Singles), limit: f32, out: &mut Found) {
        let lanes = Lanes {
            o: r.ray.o.to_array().map(f64::from),
            d: r.ray.d.to_array().map(f64::from),
            t_min: f64::from(r.ray.t_min),
            t_max: f64::from(r.ray.t_max),
        };
        while near != 0 {
            let lane = near.trailing_zeros() as usize % ROW;
            near &= near - 1;
            let met = meet(self.head.kinds[lane], |row| self.number(row, lane), &lanes);
            let enter = f64::from(entries[lane]);
            let t = if enter > met.t { enter } else { met.t };
            out.hit |= u32::from(met.is_hit & (t <= f64::from(limit))) << lane;
            (out.t[lane], out.u[lane], out.v[lane]) = (t, met.u, met.v);
        }
    }
}
