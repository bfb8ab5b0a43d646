//! What a search returns, and the order among equals.

/// How deep instances may be nested.
pub const MAX_DEPTH: usize = 8;

/// The instances that a hit lies in, outermost first; empty for what stands in the world itself.
///
/// Chains are ordered lexicographically, a chain before its own extensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Chain {
    /// Instance id + 1, so that 0, the end, comes before every id.
    ids: [u32; MAX_DEPTH],
}

impl Chain {
    /// No instance at all.
    pub const EMPTY: Self = Self { ids: [0; MAX_DEPTH] };

    /// After every chain that occurs.
    const LAST: Self = Self { ids: [u32::MAX; MAX_DEPTH] };

    /// Number of instances, at most [`MAX_DEPTH`].
    #[inline]
    pub fn len(&self) -> usize {
        self.ids.iter().take_while(|&&id| id != 0).count()
    }

    /// Whether the hit stands in the world itself.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.ids[0] == 0
    }

    /// The instance ids, outermost first; see `Scene::instance`.
    #[inline]
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = u32> + '_ {
        self.ids[..self.len()].iter().map(|id| id - 1)
    }

    /// This chain in one more instance around it. A build refuses scenes in which there is no room left.
    #[inline]
    pub fn inside(&self, id: u32) -> Self {
        let mut out = *self;
        out.ids.copy_within(..MAX_DEPTH - 1, 1);
        out.ids[0] = id + 1;
        out
    }

    /// This chain with one more instance inside. A build refuses scenes in which there is no room left.
    #[inline]
    pub(crate) fn with(&self, id: u32) -> Self {
        let mut out = *self;
        if let Some(slot) = out.ids.iter_mut().find(|id| **id == 0) {
            *slot = id + 1;
        }
        out
    }
}

/// What a ray hits first, or a miss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter; infinite for a miss.
    pub t: f32,
    /// For a triangle the barycentric weight of vertex 1, for a shape what it returned.
    pub u: f32,
    /// For a triangle the barycentric weight of vertex 2, for a shape what it returned.
    pub v: f32,
    /// Index into `Input::geometries`; `u32::MAX` for a miss.
    pub geometry: u32,
    /// Triangle index in the mesh, or the shape's offset within its geometry; `u32::MAX` for a miss.
    pub primitive: u32,
    /// The instances the primitive lies in.
    pub chain: Chain,
}

impl Hit {
    /// No hit.
    pub const MISS: Self = Self {
        t: f32::INFINITY,
        u: 0.0,
        v: 0.0,
        geometry: u32::MAX,
        primitive: u32::MAX,
        chain: Chain::EMPTY,
    };

    /// Whether anything was hit.
    #[inline]
    pub fn is_hit(&self) -> bool {
        self.geometry != u32::MAX
    }

    /// The start of a search for hits at `limit` or nearer: no hit yet, and last among equals.
    #[inline(always)]
    pub(crate) fn limit(limit: f32) -> Self {
        Self { t: limit, chain: Chain::LAST, ..Self::MISS }
    }

    /// What the caller gets when the search is over.
    #[inline(always)]
    pub(crate) fn finished(self) -> Self {
        if self.is_hit() { self } else { Self::MISS }
    }

    /// Takes the candidate if it comes before this one.
    #[inline(always)]
    pub(crate) fn offer(&mut self, c: &Hit) {
        if c.t < self.t || (c.t == self.t && c.rank() < self.rank()) {
            *self = *c;
        }
    }

    /// Whether what lies in a chain and is named by (geometry, primitive) comes before this at the same t.
    #[inline]
    pub(crate) fn comes_after(&self, chain: &Chain, (geometry, primitive): (u32, u32)) -> bool {
        (*chain, geometry, primitive) < self.rank()
    }

    #[inline]
    fn rank(&self) -> (Chain, u32, u32) {
        (self.chain, self.geometry, self.primitive)
    }
}

/// Where a ray hits a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeHit {
    /// Ray parameter.
    pub t: f32,
    /// First surface parameter; handed through to [`crate::Hit::u`].
    pub u: f32,
    /// Second surface parameter; handed through to [`crate::Hit::v`].
    pub v: f32,
}

/// What a search cost: the number of tests made for one ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Nodes opened or cells entered.
    pub nodes: u32,
    /// Boxes tested, of nodes' children and of single primitives; a node of the wide tree tests up to eight at once.
    pub boxes: u32,
    /// Blocks of up to eight triangles or shapes tested.
    pub blocks: u32,
    /// Triangles, shapes and instances tested.
    pub primitives: u32,
    /// Tests of a primitive that a mailbox found done already.
    pub duplicates: u32,
}
