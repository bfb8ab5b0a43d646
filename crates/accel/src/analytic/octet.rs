//! Eight rays side by side against shapes, one shape after the other.
//!
//! Where a group has only a few shapes, walking a tree to them costs more than testing them. With a ray in each lane no lane
//! is idle, however few shapes of a kind there are, and nothing is branched on but whether any of the rays crosses a box.

use super::{
    block::{Blocks, crossing},
    forms::{Lanes, meet},
};
use crate::{
    lanes::{Double, Doubles, Mask, ROW, Single, Singles, Wide},
    local::LEAST,
    slab::EXIT,
};
use straal_math::Ray;
use straal_math::simd::{self as math, Float, Simd};

/// Eight rays, their numbers side by side.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Octet {
    o: [Singles; 3],
    d: [Singles; 3],
    inv: [Singles; 3],
    /// At least 0.
    t_min: Singles,
    /// Finite; below 0 where the ray isn't valid.
    t_max: Singles,
    masks: [u32; ROW],
}

/// The first hit of each of eight rays.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Firsts {
    pub t: Doubles,
    /// Still to be rounded.
    pub u: Doubles,
    pub v: Doubles,
    /// The number of the object that is hit; infinite where none is.
    pub object: Doubles,
}

/// The object of a ray that hits none, after all others.
const NONE: f64 = f64::INFINITY;

/// So many rays at most are searched at once.
pub(crate) const RAYS: usize = ROW * OCTETS;

const OCTETS: usize = 8;

/// Up to [`RAYS`] rays, and their first hits.
pub(crate) struct Octets {
    rays: [Octet; OCTETS],
    /// By octet.
    pub firsts: [Firsts; OCTETS],
}

impl Octets {
    pub const EMPTY: Self = Self { rays: [Octet::EMPTY; OCTETS], firsts: [Firsts::EMPTY; OCTETS] };
}

/// Finds the first hits of up to [`RAYS`] rays, or where `ANY` any hits. All rays are taken before the first is searched, so that
/// what was written number by number has left the processor when it is read as vectors.
#[inline(always)]
pub(crate) fn search<W: Wide, const ANY: bool>(
    w: W,
    simd: Simd,
    few: &Blocks,
    rays: &[Ray],
    out: &mut Octets,
) {
    simd.run(Fill { rays, octets: &mut out.rays });
    for (octet, out) in out.rays.iter_mut().zip(&mut out.firsts).take(rays.len().div_ceil(ROW)) {
        octet.prepare(w);
        octet.search::<W, ANY>(w, few, out);
    }
}

/// Takes rays, as many as there is room for; the last is repeated until its octet is full.
struct Fill<'a> {
    rays: &'a [Ray],
    octets: &'a mut [Octet; OCTETS],
}

impl math::Kernel for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Some(last) = self.rays.len().checked_sub(1) else { return };
        let end = self.rays.len().next_multiple_of(ROW).min(RAYS);
        for first in (0..end).step_by(F::WIDTH) {
            let ray = |i: usize| &self.rays[if first + i < last { first + i } else { last }];
            let [ox, oy, oz, t_min] = F::from_rows(
                #[inline(always)]
                |i| {
                    let r = ray(i);
                    [r.o.x, r.o.y, r.o.z, r.t_min]
                },
            );
            let [dx, dy, dz, t_max] = F::from_rows(
                #[inline(always)]
                |i| {
                    let r = ray(i);
                    [r.d.x, r.d.y, r.d.z, r.t_max]
                },
            );
            // Written out: `map` isn't inlined for sure.
            let columns = [
                ox.to_array(),
                oy.to_array(),
                oz.to_array(),
                dx.to_array(),
                dy.to_array(),
                dz.to_array(),
                t_min.to_array(),
                t_max.to_array(),
            ];
            // A vector is a part of an octet, or one, or two.
            for at in (0..F::WIDTH).step_by(ROW) {
                let octet = &mut self.octets[(first + at) / ROW % OCTETS];
                let lanes = (first + at) % ROW..(first + at) % ROW + F::WIDTH.min(ROW);
                let [ox, oy, oz] = &mut octet.o;
                let [dx, dy, dz] = &mut octet.d;
                let to = [ox, oy, oz, dx, dy, dz, &mut octet.t_min, &mut octet.t_max];
                for (to, from) in to.into_iter().zip(&columns) {
                    to[lanes.clone()].copy_from_slice(&from.as_ref()[at..at + lanes.len()]);
                }
                for lane in lanes {
                    octet.masks[lane] = ray((first + at) / ROW * ROW + lane - first).mask;
                }
            }
        }
    }
}

impl Firsts {
    pub const EMPTY: Self = Self { t: [0.0; ROW], u: [0.0; ROW], v: [0.0; ROW], object: [NONE; ROW] };

    /// The object that a ray hits.
    #[inline(always)]
    pub fn object(&self, ray: usize) -> Option<u32> {
        let object = self.object[ray % ROW];
        (object < NONE).then_some(object as u32)
    }
}

impl Octet {
    pub const EMPTY: Self = Self {
        o: [[0.0; ROW]; 3],
        d: [[0.0; ROW]; 3],
        inv: [[0.0; ROW]; 3],
        t_min: [0.0; ROW],
        t_max: [-1.0; ROW],
        masks: [0; ROW],
    };

    /// What `LocalRay::prepare` finds of a ray: intervals cut, reciprocals of directions, and that rays that aren't valid hit
    /// nothing.
    #[inline(always)]
    pub fn prepare<W: Wide>(&mut self, w: W) {
        let (zero, one, most) = (w.single(0.0), w.single(1.0), w.single(f32::MAX));
        let (least, tiniest) = (w.single(LEAST), w.single(f32::from_bits(1)));
        let mut at = 0;
        while at < ROW {
            let (start, end) = (w.singles(&self.t_min, at), w.singles(&self.t_max, at));
            let (t_min, t_max) = (start.most(zero), end.least(most));
            let mut is_valid = start.at_most(end) & t_min.at_most(t_max);
            // No mask is set yet.
            let mut is_somewhere = one.at_most(zero);
            for axis in 0..3 {
                let (o, d) = (w.singles(&self.o[axis], at), w.singles(&self.d[axis], at));
                let size = d.size();
                is_valid = is_valid & o.size().at_most(most) & size.at_most(most);
                is_somewhere = is_somewhere | tiniest.at_most(size);
                let divisor = least.with_sign(d).or(size.at_most(least), d);
                w.put_singles(one / divisor, &mut self.inv[axis], at);
            }
            w.put_singles(t_min, &mut self.t_min, at);
            w.put_singles(t_max.or(is_valid & is_somewhere, w.single(-1.0)), &mut self.t_max, at);
            at += W::LANES;
        }
    }

    /// Whether each ray's mask shares a bit with those that all shapes have.
    #[inline(always)]
    fn sees_all(&self, all_masks: u32) -> bool {
        self.masks.iter().all(|mask| mask & all_masks != 0)
    }

    /// Finds each ray's first hit among shapes, by (t, object); where `ANY`, any hit.
    #[inline(always)]
    pub fn search<W: Wide, const ANY: bool>(&self, w: W, blocks: &Blocks, out: &mut Firsts) {
        let sees_all = self.sees_all(blocks.all_masks);
        let mut at = 0;
        while at < ROW {
            self.search_lanes::<W, ANY>(w, blocks, sees_all, at, out);
            at += W::LANES;
        }
    }

    #[inline(always)]
    fn search_lanes<W: Wide, const ANY: bool>(
        &self,
        w: W,
        blocks: &Blocks,
        sees_all: bool,
        at: usize,
        out: &mut Firsts,
    ) {
        // Written out: `map` isn't inlined for sure.
        let [ox, oy, oz] = &self.o;
        let [dx, dy, dz] = &self.d;
        let [ix, iy, iz] = &self.inv;
        let o = [w.singles(ox, at), w.singles(oy, at), w.singles(oz, at)];
        let d = [w.singles(dx, at), w.singles(dy, at), w.singles(dz, at)];
        let inv = [w.singles(ix, at), w.singles(iy, at), w.singles(iz, at)];
        let (t_min, t_max) = (w.singles(&self.t_min, at), w.singles(&self.t_max, at));
        let lanes = Lanes {
            o: [w.widened(o[0]), w.widened(o[1]), w.widened(o[2])],
            d: [w.widened(d[0]), w.widened(d[1]), w.widened(d[2])],
            t_min: w.widened(t_min),
            t_max: w.widened(t_max),
        };
        let exit = w.single(EXIT);
        let (mut t, mut u, mut v) = (lanes.t_max, w.double(0.0), w.double(0.0));
        let mut object = w.double(NONE);
        for block in blocks.iter() {
            for lane in 0..block.head.count as usize {
                let plane = |i: usize| w.single(block.head.planes[i][lane % ROW]);
                let (enter, start, is_crossed) = crossing(plane, o, inv, (t_min, t_max, exit));
                let mut is_near = w.wide_mask(is_crossed) & w.widened(start).at_most(t);
                if !sees_all {
                    let seen = self.seen(block.head.masks[lane % ROW]);
                    is_near = is_near & w.double(0.5).at_most(w.doubles(&seen, at));
                }
                if is_near.bits() == 0 {
                    continue;
                }
                let met = meet(block.head.kinds[lane % ROW], |row| w.double(block.number(row, lane)), &lanes);
                let enter = w.widened(enter);
                let later = enter.or(met.t.below(enter), met.t);
                let number = w.double(f64::from(block.head.objects[lane % ROW]));
                let is_first = later.below(t) | (later.equals(t) & number.below(object));
                let is_better = is_near & met.is_hit & is_first;
                object = number.or(is_better, object);
                if ANY {
                    // Nothing is entered before this.
                    t = w.double(-1.0).or(is_better, t);
                } else {
                    (t, u, v) = (later.or(is_better, t), met.u.or(is_better, u), met.v.or(is_better, v));
                }
            }
        }
        w.put_doubles(object, &mut out.object, at);
        if !ANY {
            w.put_doubles(t, &mut out.t, at);
            w.put_doubles(u, &mut out.u, at);
            w.put_doubles(v, &mut out.v, at);
        }
    }

    /// 1 for each ray that can see what has a mask, else 0.
    #[cold]
    fn seen(&self, mask: u32) -> Doubles {
        self.masks.map(|m| f64::from(u8::from(m & mask != 0)))
    }
}
