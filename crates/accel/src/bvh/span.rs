//! Ranges of primitives while the tree is built.

use crate::{
    analytic::block::Member,
    prim::{Prim, PrimKind},
};
use straal_math::Bounds;

/// A box with a spare lane, which the compiler turns into vector instructions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Box4 {
    pub lo: [f32; 4],
    pub hi: [f32; 4],
}

impl Box4 {
    pub const EMPTY: Self = Self { lo: [f32::INFINITY; 4], hi: [f32::NEG_INFINITY; 4] };

    #[inline(always)]
    pub fn grow(&mut self, lo: &[f32; 4], hi: &[f32; 4]) {
        for i in 0..4 {
            self.lo[i] = if lo[i] < self.lo[i] { lo[i] } else { self.lo[i] };
            self.hi[i] = if hi[i] > self.hi[i] { hi[i] } else { self.hi[i] };
        }
    }

    #[inline(always)]
    pub fn with(mut self, o: &Self) -> Self {
        self.grow(&o.lo, &o.hi);
        self
    }

    /// What both have in common.
    #[inline(always)]
    pub fn intersection(&self, o: &Self) -> Self {
        Self {
            lo: std::array::from_fn(|i| if o.lo[i] > self.lo[i] { o.lo[i] } else { self.lo[i] }),
            hi: std::array::from_fn(|i| if o.hi[i] < self.hi[i] { o.hi[i] } else { self.hi[i] }),
        }
    }

    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        !(self.lo[0] <= self.hi[0] && self.lo[1] <= self.hi[1] && self.lo[2] <= self.hi[2])
    }

    #[inline(always)]
    pub fn extent(&self, axis: usize) -> f32 {
        self.hi[axis] - self.lo[axis]
    }

    /// Of a box that isn't empty.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        let e = |i: usize| self.extent(i);
        e(0) * e(1) + e(1) * e(2) + e(2) * e(0)
    }
}

/// What a leaf that holds a primitive is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Class {
    /// Triangles.
    Triangle,
    /// One object.
    Object,
    /// Shapes.
    Shape,
}

/// A primitive while the tree is built, or the part of a triangle in a box: its box, and as a leaf refers to it.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(super) struct Ref {
    lo: [f32; 3],
    pub id: u32,
    hi: [f32; 3],
    pub class: Class,
}

impl Ref {
    /// Fills places that nothing stands in yet.
    pub const NONE: Self = Self { lo: [0.0; 3], id: u32::MAX, hi: [0.0; 3], class: Class::Triangle };

    pub fn of(p: &Prim) -> Self {
        let (id, class) = match p.kind {
            PrimKind::Triangle(id) => (id, Class::Triangle),
            PrimKind::Object(id) => (id, Class::Object),
        };
        Self { lo: p.bounds.min.to_array(), id, hi: p.bounds.max.to_array(), class }
    }

    /// Of a shape by its number among those that go into the tree.
    pub const fn of_shape(id: u32, m: &Member) -> Self {
        let Bounds { min, max } = m.bounds;
        Self { lo: min.to_array(), id, hi: max.to_array(), class: Class::Shape }
    }

    #[inline(always)]
    pub fn is_triangle(&self) -> bool {
        self.class == Class::Triangle
    }

    /// The same with another box.
    #[inline(always)]
    pub const fn in_box(self, b: &Box4) -> Self {
        Self { lo: [b.lo[0], b.lo[1], b.lo[2]], hi: [b.hi[0], b.hi[1], b.hi[2]], ..self }
    }

    #[inline(always)]
    pub const fn bounds(&self) -> Box4 {
        Box4 { lo: [self.lo[0], self.lo[1], self.lo[2], 0.0], hi: [self.hi[0], self.hi[1], self.hi[2], 0.0] }
    }

    /// Twice the centre.
    #[inline(always)]
    pub fn center(&self, axis: usize) -> f32 {
        self.lo[axis] + self.hi[axis]
    }

    /// The order of centres along an axis, and of primitives where they are equal.
    pub fn along(axis: usize, a: &Self, b: &Self) -> std::cmp::Ordering {
        a.center(axis).total_cmp(&b.center(axis)).then((a.class, a.id).cmp(&(b.class, b.id)))
    }
}

/// A range of primitives with what is known of it.
#[derive(Clone, Copy)]
pub(super) struct Span {
    pub start: usize,
    pub end: usize,
    /// Places behind the end that are its own: so many more references may come from cutting triangles.
    pub room: usize,
    pub bounds: Box4,
    /// Around twice the centres.
    pub centers: Box4,
    /// How many aren't triangles.
    pub objects: usize,
    /// How many of these are shapes that make blocks.
    pub shapes: usize,
    pub depth: u32,
}

impl Span {
    pub const fn empty(start: usize, depth: u32) -> Self {
        Self {
            start,
            end: start,
            room: 0,
            bounds: Box4::EMPTY,
            centers: Box4::EMPTY,
            objects: 0,
            shapes: 0,
            depth,
        }
    }

    #[inline(always)]
    pub fn add(&mut self, r: &Ref) {
        let b = r.bounds();
        let center = std::array::from_fn(|i| b.lo[i] + b.hi[i]);
        self.bounds.grow(&b.lo, &b.hi);
        self.centers.grow(&center, &center);
        self.objects += usize::from(!r.is_triangle());
        self.shapes += usize::from(r.class == Class::Shape);
        self.end += 1;
    }

    pub fn of(refs: &[Ref], start: usize, depth: u32) -> Self {
        let mut out = Self::empty(start, depth);
        refs.iter().for_each(|r| out.add(r));
        out
    }

    /// Of twice the centres along an axis.
    pub fn spread(&self, axis: usize) -> f32 {
        self.centers.extent(axis)
    }

    pub const fn len(&self) -> usize {
        self.end - self.start
    }

    /// With the room behind it.
    pub const fn places(&self) -> std::ops::Range<usize> {
        self.start..self.end + self.room
    }
}
