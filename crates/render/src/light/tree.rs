//! Many lights as a tree (Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting"; Pharr, Jakob and Humphreys 2023,
//! section 12.6.3).
//!
//! Lamps that stand near each other and shine the same way lie below one node, which knows a ball that holds them, a cone that holds their normals, how far
//! from these they shine, and how strongly. So a point can tell of a whole street roughly what it may bring, and picks a lamp by going down, at each
//! node to the child that brings more, with that probability. That takes as many steps as the tree is deep, and every lamp that may bring
//! anything is picked with some probability.
//!
//! A mesh that shines is as many lamps as it has triangles: of a large one, those near a point are the ones that light it.
//!
//! Lamps of an object are a tree of their own in the object's space, and each instance is one part of the tree of the space that it stands in. So all that a point is told
//! there holds in the object's space as well: which side of a plane something lies on is the same whatever maps one to the other, and that is all that tells
//! whether nothing arrives.

use super::copies::{Inside, determinant, mean_stretch, wider};
use super::reach::{Lamp, Reach, Receiver};
use super::{AreaLight, Emitter, LitSurface, Sides, strength};
use crate::shape::Geometry;
use straal_math::simd::{Float, Mask, Uint};
use straal_math::{Bounds, Transform, Vec3, ops};

/// Where a leaf says which part it is, in place of where its children are.
const LEAF: u32 = 1 << 31;

/// Says of a part that it is the whole of its emitter.
pub(super) const WHOLE: u32 = u32::MAX;

/// No way leads there: the part is dark.
const NO_WAY: u64 = u64::MAX;

/// Deeper than this, halves have the same number of lamps, whatever they are like: with 2^26 of them ways fit in 64 bits.
const DEEPEST_SPLIT: u32 = 32;

/// Places along an axis between which a node may be split.
const BINS: usize = 12;

/// Lamps as a tree.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// As three rows: middle and radius; axis and cosine of how far from it normals lie; strength, and cosine of how far from the
    /// normals they shine. Two children lie side by side.
    nodes: Vec<[[f32; 4]; 3]>,
    /// By node: the first of its children, or [`LEAF`] with the number of its part.
    links: Vec<u32>,
    /// By part: its emitter, and which triangle of it, or [`WHOLE`]. Then instances, each with the number of what it is of.
    parts: Vec<[u32; 2]>,
    /// By part, the way there from the root: from the lowest bit on, 1 where it goes to the second child.
    ways: Vec<u64>,
    /// By emitter, its first part; one more at the end, which is the first instance.
    firsts: Vec<u32>,
    /// The emitters, in order, if they aren't all.
    members: Vec<u32>,
    /// All of them.
    whole: Cluster,
}

/// An instance in which something shines, and what.
pub(super) struct Held {
    pub inside: Inside,
    /// In the space that it stands in.
    pub cluster: Option<Cluster>,
}

/// A part that was picked, or many side by side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Picked<F: Float> {
    pub emitter: F::Uint,
    /// Which triangle, or [`WHOLE`].
    pub part: F::Uint,
    /// Whether these are an instance and what it is of.
    pub inside: F::Mask,
    /// 0 where nothing brings anything.
    pub pmf: F,
    /// What is left of the number that picked it.
    pub rest: F,
}

/// What is known of some lamps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    bounds: Bounds,
    /// Of unit length; of no meaning where normals lie all around.
    axis: Vec3,
    /// Cosine of the angle about the axis within which normals lie.
    cos_normals: f32,
    /// Cosine of the angle to a normal beyond which nothing shines.
    cos_reach: f32,
    /// What arrives at distance 1 before them, if all stood there.
    strength: f32,
}

impl Cluster {
    fn of_lamp(lamp: &Lamp) -> Self {
        let flat = lamp.flatness > 0.999 && !lamp.both_sides;
        let seen = match (lamp.flatness > 0.999, lamp.both_sides) {
            (true, _) => 1.0,
            (false, false) => 0.25,
            (false, true) => 0.5,
        };
        // The ball around its box, as a box.
        let half = Vec3::splat(lamp.radius / 3.0_f32.sqrt());
        Self {
            bounds: Bounds::of_points([lamp.center - half, lamp.center + half]),
            axis: if flat { lamp.facing } else { Vec3::Z },
            cos_normals: if flat { 1.0 } else { -1.0 },
            cos_reach: 0.0,
            strength: lamp.flux * seen,
        }
    }

    fn of_point(position: Vec3, strength: f32) -> Self {
        let bounds = Bounds::of_points([position]);
        Self { bounds, axis: Vec3::Z, cos_normals: -1.0, cos_reach: 0.0, strength }
    }

    /// Of what is known of a light; `None` for one from afar, and one that doesn't fall with the distance.
    fn of_reach(reach: &Reach) -> Option<Self> {
        match reach {
            Reach::Point { position, intensity, falls } => {
                falls.then(|| Self::of_point(*position, *intensity))
            }
            Reach::Projector { projector, intensity } => {
                Some(Self::of_point(projector.position(), *intensity))
            }
            Reach::Measured { lamp, intensity } => Some(Self::of_point(lamp.position(), *intensity)),
            Reach::Spot { spot, intensity } => {
                let whole = Self::of_point(spot.position(), *intensity);
                let (axis, cos_reach) = spot.cone();
                // Beyond a right angle to its axis nothing is gained.
                let cone = Self { axis, cos_normals: 1.0, cos_reach, ..whole };
                Some(if cos_reach > 0.0 { cone } else { whole })
            }
            Reach::Surface(lamp) => Some(Self::of_lamp(lamp)),
            Reach::Parallel { .. } | Reach::Around(_) => None,
        }
    }

    /// As it is from outside of an instance.
    pub fn through(&self, m: &Transform) -> Self {
        let b = &self.bounds;
        let corner = |i: u32| {
            let of = |axis: usize| if i >> axis & 1 == 0 { b.min[axis] } else { b.max[axis] };
            m.point(Vec3::new(of(0), of(1), of(2)))
        };
        let normal = m.normal(self.axis);
        let cos_normals = wider(self.cos_normals, m);
        // By so much what faces along the axis grows; else in the mean.
        let along = determinant(&m.forward).abs() * normal.length();
        let stretch = if self.cos_normals > 0.9 { along } else { mean_stretch(m) };
        let (axis, cos_normals) = normal.try_normalize().map_or((Vec3::Z, -1.0), |axis| (axis, cos_normals));
        // Lamps within objects shine as far as their horizon.
        Self {
            bounds: Bounds::of_points((0..8).map(corner)),
            axis,
            cos_normals,
            strength: self.strength * stretch,
            ..*self
        }
    }

    /// Both together.
    fn union(self, o: Self) -> Self {
        let (axis, cos_normals) = joined((self.axis, self.cos_normals), (o.axis, o.cos_normals));
        Self {
            bounds: self.bounds.union(o.bounds),
            axis,
            cos_normals,
            cos_reach: ops::min(self.cos_reach, o.cos_reach),
            strength: self.strength + o.strength,
        }
    }

    /// What a node costs that holds it: strength times how widely it shines, times how large it is (the paper's equation 4).
    fn cost(&self) -> f32 {
        let normals = ops::acos(self.cos_normals);
        let reach = ops::acos(self.cos_reach);
        let all = ops::min(normals + reach, std::f32::consts::PI);
        let (sin, cos) = ops::sin_cos(normals);
        let wide = 2.0 * std::f32::consts::PI * (1.0 - cos)
            + std::f32::consts::FRAC_PI_2
                * (2.0 * all * sin - ops::cos(normals - 2.0 * all) - 2.0 * normals * sin + cos);
        // A line or a point has no area, but a length.
        let size = self.bounds.half_area() + self.bounds.extent().length_squared() * 1e-3;
        self.strength * wide * size
    }

    fn rows(&self) -> [[f32; 4]; 3] {
        let (center, radius) = (self.bounds.center(), 0.5 * self.bounds.extent().length());
        let (axis, wide) = (self.axis, self.cos_normals);
        [
            [center.x, center.y, center.z, radius],
            [axis.x, axis.y, axis.z, wide],
            [self.strength, self.cos_reach, 0.0, 0.0],
        ]
    }
}

/// The least cone about two, each an axis and the cosine of an angle.
fn joined((a, cos_a): (Vec3, f32), (b, cos_b): (Vec3, f32)) -> (Vec3, f32) {
    let all = (Vec3::Z, -1.0);
    if cos_a <= -1.0 || cos_b <= -1.0 {
        return all;
    }
    let (wide_a, wide_b) = (ops::acos(cos_a), ops::acos(cos_b));
    let between = ops::atan2(a.cross(b).length(), a.dot(b));
    if between + wide_b <= wide_a {
        return (a, cos_a);
    }
    if between + wide_a <= wide_b {
        return (b, cos_b);
    }
    // A little more, for rounding.
    let wide = 0.5 * (wide_a + between + wide_b) + 1e-4;
    let across = b - a * a.dot(b);
    let (Some(across), true) = (across.try_normalize(), wide < std::f32::consts::PI) else { return all };
    let (sin, cos) = ops::sin_cos(wide - wide_a);
    (a * cos + across * sin, ops::cos(wide))
}

/// A part, and what is known of it.
struct Known {
    part: u32,
    cluster: Cluster,
}

impl Tree {
    /// Bytes that it takes for each part: two nodes, the part and the way there; and for each emitter.
    pub const BYTES: usize = 2 * (size_of::<[[f32; 4]; 3]>() + size_of::<u32>())
        + size_of::<[u32; 2]>()
        + size_of::<u64>()
        + size_of::<u32>();

    /// Bytes that it takes besides, for each part, while it is made.
    pub const MAKING_BYTES: usize = size_of::<Known>();

    /// Of those among some lights that have a place and are wanted, and of instances in which something shines; those from afar have no part of it. `None`
    /// where there are none.
    pub fn new(
        (emitters, geometry): (&[Emitter], &Geometry),
        members: &[u32],
        inside: &[Held],
        is_one: &dyn Fn(u32) -> bool,
    ) -> Option<Self> {
        // Lists that grow leave holes in memory behind.
        let parts_of = |index: &u32| {
            mesh_of(&emitters[*index as usize])
                .map_or(1, |(_, mesh)| geometry.meshes[mesh as usize].indices.len())
        };
        let count = members.iter().map(parts_of).sum::<usize>() + inside.len();
        let (mut parts, mut known) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut firsts = Vec::with_capacity(members.len() + 1);
        let mut add = |[index, part]: [u32; 2], cluster: Option<Cluster>| {
            let number = parts.len() as u32;
            parts.push([index, part]);
            let shines = |c: &Cluster| c.strength > 0.0 && c.strength.is_finite() && c.bounds.is_finite();
            if let Some(cluster) = cluster.filter(shines) {
                known.push(Known { part: number, cluster });
            }
            number + 1
        };
        let mut end = 0;
        for &index in members {
            let emitter = &emitters[index as usize];
            let is_one = is_one(index);
            firsts.push(end);
            match mesh_of(emitter) {
                Some((light, mesh)) => {
                    let radiance = strength(&light.radiance) as f32;
                    for triangle in 0..geometry.meshes[mesh as usize].indices.len() as u32 {
                        let cluster = triangle_of(light, radiance, geometry, (mesh, triangle));
                        end = add([index, triangle], cluster.filter(|_| is_one));
                    }
                }
                None => {
                    let reach = emitter.reach(geometry);
                    end = add([index, WHOLE], reach.as_ref().and_then(Cluster::of_reach).filter(|_| is_one));
                }
            }
        }
        firsts.push(end);
        for held in inside {
            add([held.inside.instance, held.inside.group], held.cluster);
        }
        if known.is_empty() || parts.len() as u64 >= u64::from(LEAF) {
            return None;
        }
        let ways = vec![NO_WAY; parts.len()];
        let whole = together(&known);
        let is_all = members.len() == emitters.len();
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * known.len()),
            links: Vec::with_capacity(2 * known.len()),
            parts,
            ways,
            firsts,
            members: if is_all { Vec::new() } else { members.to_vec() },
            whole,
        };
        tree.nodes.push(whole.rows());
        tree.links.push(0);
        tree.grow(&mut known);
        Some(tree)
    }

    /// What is known of all of them.
    pub fn whole(&self) -> Cluster {
        self.whole
    }

    /// Makes all nodes below the root.
    fn grow(&mut self, known: &mut [Known]) {
        // The node, its lamps, the way there and how deep it lies.
        let mut todo = vec![(0_usize, 0..known.len(), 0_u64, 0_u32)];
        while let Some((node, range, way, depth)) = todo.pop() {
            let lamps = &mut known[range.clone()];
            if let [only] = lamps {
                self.links[node] = LEAF | only.part;
                self.ways[only.part as usize] = way;
                continue;
            }
            let middle = split(lamps, depth);
            let first = self.nodes.len();
            self.links[node] = first as u32;
            let (left, right) = lamps.split_at(middle);
            for half in [left, right] {
                self.nodes.push(together(half).rows());
                self.links.push(0);
            }
            let middle = range.start + middle;
            todo.push((first, range.start..middle, way, depth + 1));
            todo.push((first + 1, middle..range.end, way | 1 << depth, depth + 1));
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<[[f32; 4]; 3]>()
            + self.links.capacity() * size_of::<u32>()
            + self.parts.capacity() * size_of::<[u32; 2]>()
            + self.ways.capacity() * size_of::<u64>()
            + (self.firsts.capacity() + self.members.capacity()) * size_of::<u32>()
    }

    /// Roughly what all of them bring.
    #[inline(always)]
    pub fn estimate<F: Float>(&self, at: &Receiver<F>) -> F {
        let rows = &self.nodes[0];
        importance(
            rows.map(
                #[inline(always)]
                |row| row.map(F::splat),
            ),
            at,
            at.is_anywhere(),
        )
    }

    /// Goes down by `u` in [0, 1).
    #[inline(always)]
    pub fn picks<F: Float>(&self, u: F, at: &Receiver<F>) -> Picked<F> {
        let everywhere = at.is_anywhere();
        let one = F::Uint::splat(1);
        let mut node = F::Uint::splat(0);
        let (mut pmf, mut rest) = (F::ONE, u);
        loop {
            let link = F::Uint::gather(&self.links, node);
            let is_leaf = F::Uint::splat(LEAF - 1).lt(link);
            let goes = !is_leaf & pmf.gt(F::ZERO);
            if !goes.any() {
                // What is no leaf has no part.
                let part =
                    F::Uint::select(is_leaf, link.wrapping_sub(F::Uint::splat(LEAF)), F::Uint::splat(0));
                let of = |k: usize| {
                    F::Uint::from_fn(
                        #[inline(always)]
                        |i| self.parts[part.lane(i) as usize][k],
                    )
                };
                let pmf = F::select(is_leaf, pmf, F::ZERO);
                // In the middle of those numbers that picked it: there are 2^24 in all.
                let step = F::splat(0.5 / 16_777_216.0) / pmf;
                let rest = (rest + step).min(F::splat(1.0 - f32::EPSILON / 2.0));
                let inside = !part.lt(F::Uint::splat(self.first_instance()));
                return Picked { emitter: of(0), part: of(1), inside, pmf, rest };
            }
            // Where it goes no further, anything will do.
            let first = F::Uint::select(goes, link, F::Uint::splat(0));
            let second = F::Uint::select(goes, first.wrapping_add(one), F::Uint::splat(0));
            let share = self.share([first, second], at, everywhere);
            let to_first = rest.lt(share);
            let chance = F::select(to_first, share, F::ONE - share);
            let left = F::select(to_first, rest, rest - share) / chance;
            let chosen = F::Uint::select(to_first, first, second);
            node = F::Uint::select(goes, chosen, node);
            rest = F::select(goes, left.min(F::splat(1.0 - f32::EPSILON / 2.0)), rest);
            // Where neither brings anything the share is no number.
            let sound = chance.gt(F::ZERO);
            pmf = F::select(goes, F::select(sound, pmf * chance, F::ZERO), pmf);
        }
    }

    /// The probability with which [`Self::picks`] picks a part of an emitter: a triangle, or [`WHOLE`].
    #[inline(always)]
    pub fn pmfs<F: Float>(&self, emitter: u32, part: u32, at: &Receiver<F>) -> F {
        let Some(place) = self.place_of(emitter) else { return F::ZERO };
        let first = self.firsts[place];
        // One that has no parts is no light.
        let Some(&[_, first_part]) = self.parts.get(first as usize) else { return F::ZERO };
        let number = if part == WHOLE || first_part == WHOLE { first } else { first + part };
        self.pmfs_of(number, at)
    }

    /// The probability with which an instance is picked, and what it is of.
    pub fn pmf_of_instance(&self, instance: u32, at: &Receiver) -> Option<(f32, u32)> {
        let first = self.first_instance() as usize;
        let place = self.parts[first..].binary_search_by_key(&instance, |part| part[0]).ok()?;
        let number = first + place;
        Some((self.pmfs_of(number as u32, at), self.parts[number][1]))
    }

    /// The first part that is an instance.
    #[inline(always)]
    fn first_instance(&self) -> u32 {
        self.firsts.last().copied().unwrap_or(0)
    }

    /// Where an emitter stands among its own.
    #[inline(always)]
    fn place_of(&self, emitter: u32) -> Option<usize> {
        if self.members.is_empty() {
            return Some(emitter as usize).filter(|place| place + 1 < self.firsts.len());
        }
        self.members.binary_search(&emitter).ok()
    }

    /// The same of a part by its number.
    #[inline(always)]
    fn pmfs_of<F: Float>(&self, number: u32, at: &Receiver<F>) -> F {
        let mut way = self.ways[number as usize];
        if way == NO_WAY {
            return F::ZERO;
        }
        let everywhere = at.is_anywhere();
        let (mut pmf, mut node) = (F::ONE, 0);
        while self.links[node] & LEAF == 0 {
            let first = self.links[node];
            let share = self.share([F::Uint::splat(first), F::Uint::splat(first + 1)], at, everywhere);
            let second = way & 1 == 1;
            let chance = if second { F::ONE - share } else { share };
            pmf = F::select(chance.gt(F::ZERO), pmf * chance, F::ZERO);
            node = (first + u32::from(second)) as usize;
            way >>= 1;
        }
        pmf
    }

    /// Whether an emitter is so many lamps as it has triangles.
    pub fn splits(&self, emitter: u32) -> bool {
        self.place_of(emitter).is_some_and(|place| self.parts[self.firsts[place] as usize][1] != WHOLE)
    }

    /// The part of the light of two nodes that comes from the first.
    #[inline(always)]
    fn share<F: Float>(&self, nodes: [F::Uint; 2], at: &Receiver<F>, everywhere: F::Mask) -> F {
        let [a, b] = nodes.map(
            #[inline(always)]
            |node| {
                let row = |k: usize| {
                    F::from_rows(
                        #[inline(always)]
                        |i| self.nodes[node.lane(i) as usize][k],
                    )
                };
                importance([row(0), row(1), row(2)], at, everywhere)
            },
        );
        a / (a + b)
    }
}

/// What lamps of a node may bring to a point (the paper's equation 3): as if they stood together at its middle, turned towards the point as
/// far as any of them may be, and as high above its horizon as any may stand. 0 only where none of them brings anything.
#[inline(always)]
fn importance<F: Float>(
    [[x, y, z, radius], [ax, ay, az, cos_normals], [strength, cos_reach, _, _]]: [[F; 4]; 3],
    at: &Receiver<F>,
    everywhere: F::Mask,
) -> F {
    let way = Vec3::new(x, y, z) - at.p;
    let (d2, r2) = (way.length_squared(), radius * radius);
    let per_distance = F::ONE / d2.sqrt();
    // Within the ball anything may be in any direction.
    let within = d2.le(r2);
    let sin_ball = (radius * per_distance).min(F::ONE);
    let cos_ball = (F::ONE - sin_ball * sin_ball).max(F::ZERO).sqrt();
    let sine = |cos: F| (F::ONE - cos * cos).max(F::ZERO).sqrt();
    // Angles a - b, and 0 where b is larger.
    let less = |[cos_a, sin_a]: [F; 2], [cos_b, sin_b]: [F; 2]| {
        let smaller = cos_a.gt(cos_b);
        let cos = F::select(smaller, F::ONE, cos_a * cos_b + sin_a * sin_b);
        [cos, F::select(smaller, F::ZERO, sin_a * cos_b - cos_a * sin_b)]
    };
    let cos_axis = (Vec3::new(ax, ay, az).dot(way) * -per_distance).max(F::splat(-1.0)).min(F::ONE);
    let beyond = less([cos_axis, sine(cos_axis)], [cos_normals, sine(cos_normals)]);
    let [cos, _] = less(beyond, [cos_ball, sin_ball]);
    let cos = F::select(within, F::ONE, cos);
    let cos_n = (way.dot(at.n) * per_distance).max(F::splat(-1.0)).min(F::ONE);
    let [above, _] = less([cos_n, sine(cos_n)], [cos_ball, sin_ball]);
    let above = F::select(within | everywhere, F::ONE, above.max(F::ZERO));
    let brings = strength * cos * above / d2.max(r2);
    // On a light of no size anything is infinite.
    F::select(cos.gt(cos_reach) & above.gt(F::ZERO), brings.min(F::splat(1e30)), F::ZERO)
}

/// The mesh of an emitter that is one.
fn mesh_of(emitter: &Emitter) -> Option<(&AreaLight, u32)> {
    match emitter {
        Emitter::Area(light) => match light.surface {
            LitSurface::Mesh { mesh, triangles: Some(_), .. } => Some((light, mesh)),
            _ => None,
        },
        _ => None,
    }
}

fn triangle_of(
    light: &AreaLight,
    radiance: f32,
    geometry: &Geometry,
    (mesh, triangle): (u32, u32),
) -> Option<Cluster> {
    let m = &geometry.meshes[mesh as usize];
    let [a, b, c] = m.corners(triangle);
    let n = (b - a).cross(c - a).try_normalize()?;
    let n = if m.flip { -n } else { n };
    let both = light.sides == Sides::Both;
    Some(Cluster {
        bounds: Bounds::of_points([a, b, c]),
        axis: if light.sides == Sides::Back { -n } else { n },
        cos_normals: if both { -1.0 } else { 1.0 },
        cos_reach: 0.0,
        strength: radiance * m.triangle_area(triangle) as f32,
    })
}

fn together(lamps: &[Known]) -> Cluster {
    let all = |half: &[Known]| half[1..].iter().fold(half[0].cluster, |sum, k| sum.union(k.cluster));
    all(lamps)
}

/// Puts lamps in an order and tells where to cut it: at the place, of a few along each axis, that makes both halves cheapest.
fn split(lamps: &mut [Known], depth: u32) -> usize {
    let middle = |k: &Known| k.cluster.bounds.center();
    let centers = Bounds::of_points(lamps.iter().map(middle));
    let extent = centers.extent();
    let widest = extent.max_axis();
    let mut best: Option<(f32, usize, usize)> = None;
    if depth < DEEPEST_SPLIT && lamps.len() > 2 {
        for axis in 0..3 {
            if extent[axis] <= 0.0 || !extent[axis].is_finite() {
                continue;
            }
            let bin_of = |k: &Known| bin(middle(k)[axis], centers.min[axis], extent[axis]);
            let mut bins: [Option<Cluster>; BINS] = [None; BINS];
            for lamp in lamps.iter() {
                let slot = &mut bins[bin_of(lamp)];
                *slot = Some(slot.map_or(lamp.cluster, |c| c.union(lamp.cluster)));
            }
            let join = |a: Option<Cluster>, b: Option<Cluster>| match (a, b) {
                (Some(a), Some(b)) => Some(a.union(b)),
                (one, None) | (None, one) => one,
            };
            let mut after = [None; BINS];
            let mut sum = None;
            for k in (0..BINS).rev() {
                sum = join(sum, bins[k]);
                after[k] = sum;
            }
            // A cut along a short side is a bad one, all else alike.
            let long = extent[widest] / extent[axis];
            let mut before = None;
            for cut in 1..BINS {
                before = join(before, bins[cut - 1]);
                let (Some(a), Some(b)) = (before, after[cut]) else { continue };
                let cost = long * (a.cost() + b.cost());
                if cost.is_finite() && best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, axis, cut));
                }
            }
        }
    }
    let half = lamps.len() / 2;
    let Some((_, axis, cut)) = best else {
        lamps.sort_unstable_by(|a, b| {
            middle(a)[widest].total_cmp(&middle(b)[widest]).then(a.part.cmp(&b.part))
        });
        return half;
    };
    let is_first = |k: &Known| bin(middle(k)[axis], centers.min[axis], extent[axis]) < cut;
    lamps.sort_unstable_by_key(|k| (!is_first(k), k.part));
    let count = lamps.iter().filter(|k| is_first(k)).count();
    if count == 0 || count == lamps.len() { half } else { count }
}

fn bin(at: f32, from: f32, extent: f32) -> usize {
    (((at - from) / extent * BINS as f32) as usize).min(BINS - 1)
}
