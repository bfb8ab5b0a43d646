//! The vertices of a block of paths, number by number, as they are worked on side by side ([`straal_math::simd`]).

use crate::light::Receiver;
use crate::material::many::{Among, OfKind, WithKind};
use crate::material::{Black, Bsdf, BsdfKind};
use crate::shape::offset::{End, Raised};
use crate::surface::{Column, Surfaces};
use straal_color::Light;
use straal_math::simd::{self, Float, Mask, Simd};
use straal_math::{Frame, Ray, Vec3};

pub(super) use crate::surface::BLOCK;

/// A block, and what vectors that begin in it reach of beyond.
pub(super) const ROOM: usize = BLOCK + simd::BLOCK;

/// Yes or no for each vertex of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bits(u64);

impl Bits {
    /// Says what vertex `i` is, which wasn't a yes.
    #[inline(always)]
    pub fn set(&mut self, i: usize, yes: bool) {
        self.0 |= u64::from(yes) << i;
    }

    /// By bits, the lowest the first vertex's.
    #[inline(always)]
    pub const fn of(bits: u64) -> Self {
        Self(bits)
    }

    /// A yes for so many.
    #[inline(always)]
    pub const fn first(count: usize) -> Self {
        Self((1 << count) - 1)
    }

    /// Whether any is a yes.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.0 != 0
    }

    /// That of vertex `i`.
    #[inline(always)]
    pub fn at(self, i: usize) -> bool {
        self.0 >> i & 1 == 1
    }

    /// Those from vertex `first` on.
    #[inline(always)]
    pub fn load<F: Float>(self, first: usize) -> F::Mask {
        F::Mask::from_bits((self.0 >> first) as u32)
    }

    /// Says what those from vertex `first` on are, of which none was a yes.
    #[inline(always)]
    pub fn store<M: Mask>(&mut self, first: usize, mask: M) {
        self.0 |= u64::from(mask.to_bits()) << first;
    }

    /// The numbers of those that are a yes.
    #[inline(always)]
    pub fn each(self) -> impl Iterator<Item = usize> {
        let mut left = self.0;
        std::iter::from_fn(move || {
            let i = left.trailing_zeros() as usize;
            left &= left.wrapping_sub(1);
            (i < 64).then_some(i)
        })
    }
}

/// The numbers of some vertices of a block, in order.
pub(super) struct Few {
    numbers: [u8; BLOCK],
    count: usize,
}

impl Few {
    /// Those that have a bit.
    #[inline(always)]
    pub fn of(bits: Bits) -> Self {
        let mut few = Self { numbers: [0; BLOCK], count: 0 };
        for (number, i) in few.numbers.iter_mut().zip(bits.each()) {
            *number = i as u8;
            few.count += 1;
        }
        few
    }

    /// The numbers.
    #[inline(always)]
    pub fn list(&self) -> &[u8] {
        &self.numbers[..self.count]
    }
}

/// Light for each vertex.
#[derive(Clone, Copy, Default)]
pub(super) struct Lights([Column; 4]);

impl Lights {
    #[inline(always)]
    pub fn load<F: Float>(&self, first: usize) -> Light<F> {
        let [a, b, c, d] = &self.0;
        Light([a.load(first), b.load(first), c.load(first), d.load(first)])
    }

    #[inline(always)]
    pub fn store<F: Float>(&mut self, first: usize, light: Light<F>) {
        for (column, v) in self.0.iter_mut().zip(light.0) {
            column.store(first, v);
        }
    }
}

/// The vertices of a block that scatter light. What isn't computed of them yet stands in their [`Surfaces`].
pub(super) struct Vertices<'w> {
    /// How many surfaces there are in the block.
    pub count: usize,
    /// Those from which paths may go on; of the others nothing is known.
    pub alive: Bits,
    /// Those at which lights are sampled: that have more than delta lobes.
    pub asks_lights: Bits,
    /// Those whose path may be ended by chance.
    pub plays_roulette: Bits,
    /// Those from which paths go on.
    pub goes_on: Bits,
    /// Those to which light may come from all around, and not from the side that is seen alone.
    pub is_open: Bits,
    /// Whether any chooses between lobes.
    pub chooses_lobe: bool,
    /// Share of the light at each that reaches the film.
    beta: [Light; ROOM],
    /// Product of squared relative indices passed.
    pub eta_squared: Column,
    /// Edges of the paths so far.
    depth: [u32; BLOCK],
    /// The most of these.
    deepest: u32,
    /// How they scatter: each once that several have alike.
    bsdfs: [Bsdf<'w>; BLOCK],
    /// How many of those there are.
    read: usize,
    /// By vertex, the number of its BSDF.
    which: [u8; ROOM],
    /// Of the last BSDF.
    traits: Traits,
    kind: Option<BsdfKind>,
    is_mixed: bool,
}

/// What a block asks of a BSDF.
struct Traits {
    kind: BsdfKind,
    asks_lights: bool,
    is_open: bool,
    chooses_lobe: bool,
}

impl Traits {
    fn of(bsdf: &Bsdf<'_>) -> Self {
        Self {
            kind: bsdf.kind(),
            asks_lights: !bsdf.is_delta(),
            is_open: bsdf.kind() == BsdfKind::Custom || bsdf.transmits(),
            chooses_lobe: bsdf.chooses_lobe(),
        }
    }
}

impl<'w> Vertices<'w> {
    /// None yet.
    pub fn new() -> Self {
        Self {
            count: 0,
            alive: Bits::default(),
            asks_lights: Bits::default(),
            plays_roulette: Bits::default(),
            goes_on: Bits::default(),
            is_open: Bits::default(),
            chooses_lobe: false,
            beta: [Light::ZERO; ROOM],
            eta_squared: Column::default(),
            depth: [0; BLOCK],
            deepest: 0,
            bsdfs: [Bsdf::Black(Black); BLOCK],
            read: 0,
            which: [0; ROOM],
            traits: Traits::of(&Bsdf::Black(Black)),
            kind: None,
            is_mixed: false,
        }
    }

    /// Begins a block of so many surfaces.
    #[inline]
    pub fn begin(&mut self, count: usize) {
        self.count = count;
        for bits in [&mut self.alive, &mut self.asks_lights, &mut self.plays_roulette] {
            *bits = Bits::default();
        }
        (self.goes_on, self.is_open) = Default::default();
        (self.chooses_lobe, self.kind, self.is_mixed) = (false, None, false);
        (self.read, self.which) = (0, [0; ROOM]);
        self.deepest = 0;
    }

    /// What the path of surface `i` brings to it, of so many edges.
    #[inline(always)]
    pub fn bring(&mut self, i: usize, beta: Light, eta_squared: f32, depth: u32) {
        self.beta[i] = beta;
        self.eta_squared.set(i, eta_squared);
        self.depth[i] = depth;
        self.deepest = if depth > self.deepest { depth } else { self.deepest };
    }

    /// The most edges that a path has.
    #[inline(always)]
    pub fn deepest(&self) -> u32 {
        self.deepest
    }

    /// Edges of the path of surface `i`.
    #[inline(always)]
    pub fn depth(&self, i: usize) -> u32 {
        self.depth[i]
    }

    /// From vertex `first` on, the share of the light that reaches the film.
    #[inline(always)]
    pub fn beta<F: Float>(&self, first: usize) -> Light<F> {
        Light::from_fn(
            #[inline(always)]
            |i| self.beta[first + i],
        )
    }

    /// Takes a BSDF, for the vertices that are set until the next one. There is one for each surface at most.
    #[inline]
    pub fn read(&mut self, bsdf: Bsdf<'w>) {
        self.traits = Traits::of(&bsdf);
        if let Some(place) = self.bsdfs.get_mut(self.read) {
            *place = bsdf;
            self.read += 1;
        }
    }

    /// Takes another in place of the last one, which no vertex has.
    pub fn replace(&mut self, bsdf: Bsdf<'w>) {
        self.read = self.read.saturating_sub(1);
        self.read(bsdf);
    }

    /// The last one.
    #[inline(always)]
    pub fn bsdf(&self) -> Option<&Bsdf<'w>> {
        self.bsdfs.get(self.read.checked_sub(1)?)
    }

    /// At surface `i` light is scattered, by the last BSDF.
    #[inline(always)]
    pub fn set(&mut self, i: usize) {
        let &Traits { kind, asks_lights, is_open, chooses_lobe } = &self.traits;
        self.is_mixed |= *self.kind.get_or_insert(kind) != kind;
        self.alive.set(i, true);
        self.asks_lights.set(i, asks_lights);
        self.is_open.set(i, is_open);
        self.chooses_lobe |= chooses_lobe;
        self.which[i] = self.read.saturating_sub(1) as u8;
    }

    /// At all surfaces it is, by the only BSDF.
    #[inline(always)]
    pub fn set_all(&mut self) {
        let &Traits { kind, asks_lights, is_open, chooses_lobe } = &self.traits;
        let all = Bits::first(self.count);
        (self.kind, self.alive, self.chooses_lobe) = (Some(kind), all, chooses_lobe);
        self.asks_lights = if asks_lights { all } else { Bits::default() };
        self.is_open = if is_open { all } else { Bits::default() };
    }

    /// Says from which of the vertices paths go on, those of fewer edges than `end`, and which of them may be ended by chance.
    #[inline]
    pub fn send_on(&mut self, end: u32, plays_roulette: impl Fn(u32) -> bool) {
        if self.deepest < end {
            self.goes_on = self.alive;
        } else {
            self.alive.each().for_each(|i| self.goes_on.set(i, self.depth[i] < end));
        }
        if plays_roulette(self.deepest) {
            self.alive.each().for_each(|i| self.plays_roulette.set(i, plays_roulette(self.depth[i])));
        }
    }

    /// Hands the kind of their BSDFs to who works with any by an instruction set. What has a single lane takes all as of any kind: it
    /// would gain nothing, and everybody who builds straal would compile it.
    #[inline]
    pub fn by_kind(&self, simd: Simd, worker: impl WithKind<'w>) {
        match self.kind {
            Some(kind) if !self.is_mixed && simd.width() > 1 => kind.hand_to(worker),
            _ => worker.with::<Bsdf<'w>>(),
        }
    }

    /// Their BSDFs, as they stand in the lanes of vectors from vertex `first` on.
    #[inline(always)]
    pub fn bsdfs<K: OfKind<'w>>(&self, first: usize) -> Option<Among<'_, 'w, K>> {
        let alive = self.alive.each().next()?;
        let some = self.bsdfs.get(usize::from(self.which[alive]))?;
        Among::new(&self.bsdfs, &self.which[first..], some)
    }

    /// Where light arrives from vertex `first` on: on the side that is seen, where it can't come through.
    #[inline(always)]
    pub fn receivers<F: Float>(&self, surfaces: &Surfaces, first: usize) -> Receiver<F> {
        let (n, wo) = (surfaces.frame[2].load(first), surfaces.wo.load::<F>(first));
        let n = Vec3::select(wo.z.lt(F::ZERO), -n, n);
        let n = Vec3::select(self.is_open.load::<F>(first), Vec3::splat(F::ZERO), n);
        Receiver { p: surfaces.p.load(first), n }
    }
}

/// The points from surface `first` on, with their errors and geometric normals.
#[inline(always)]
pub(super) fn ends<F: Float>(surfaces: &Surfaces, first: usize) -> End<F> {
    End { p: surfaces.p.load(first), p_err: surfaces.p_err.load(first), ng: surfaces.ng.load(first) }
}

/// Where light arrives that scatters at vertices side by side, and where rays leave.
pub(super) struct Standing<F: Float> {
    /// The points.
    pub from: Raised<F>,
    /// In their frames, the normals that say what is in front; zero where they are the shading normals.
    pub leaning: Vec3<F>,
}

impl Vertices<'_> {
    /// That from surface `first` on. What light doesn't pass is as smooth as its shading normals say.
    #[inline(always)]
    pub fn standing<F: Float>(&self, surfaces: &Surfaces, first: usize) -> Standing<F> {
        let (end, leaning) = (ends(surfaces, first), surfaces.leaning.load(first));
        if surfaces.raised == 0 {
            return Standing { from: Raised::from(end), leaning };
        }
        let is = F::Mask::from_bits((surfaces.raised >> first) as u32)
            & self.asks_lights.load::<F>(first)
            & !self.is_open.load::<F>(first);
        let leaning = Vec3::select(is, surfaces.smooth.load(first), leaning);
        Standing { from: Raised { end, bulge: surfaces.bulge.load(first), is }, leaning }
    }
}

/// Their frames.
#[inline(always)]
pub(super) fn frames<F: Float>(surfaces: &Surfaces, first: usize) -> Frame<F> {
    let [s, t, n] = &surfaces.frame;
    Frame { s: s.load(first), t: t.load(first), n: n.load(first) }
}

/// A vector and a number of each vertex.
pub(super) type Row = [f32; 4];

/// The ray of rows that hold origin and least t, direction and largest t; its time is that of `like`. It sees
/// what the camera doesn't.
#[inline(always)]
pub(super) fn ray([o, d]: &[Row; 2], like: &Ray) -> Ray {
    Ray { o: vector(o), t_min: o[3], d: vector(d), t_max: d[3], time: like.time, mask: u32::MAX }
}

/// The vector of a row.
#[inline(always)]
pub(super) fn vector(row: &Row) -> Vec3 {
    Vec3::new(row[0], row[1], row[2])
}
