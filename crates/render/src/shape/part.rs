//! Solids taken together, by sets: constructive solid geometry.
//!
//! A [`Solid`] knows for each of its leaves, which are closed, whether a ray is inside: it is where the next crossing leaves. So it goes
//! from crossing to crossing of all leaves and sees where the whole changes from outside to inside, or back (Roth 1982, with states in
//! place of lists of intervals, so that nothing is kept). Each surface of a leaf is a shape of its own in the world, a [`Part`], with
//! its own material: it is there where that surface is the boundary of the whole.

use std::fmt;
use std::sync::Arc;

use straal_accel::{self as accel, Hit};
use straal_math::{Bounds, Ray};

use super::{Form, Geometry, ShapeHit, SurfacePoint, Tangents};

/// Most leaves of a solid: a bit for each.
pub const MOST_LEAVES: usize = straal_scene::whole::MOST_SOLIDS;

/// What of a leaf's geometry is hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// A shape.
    Shape(u32),
    /// A mesh.
    Mesh(u32),
}

/// A closed surface: shapes and meshes that hold a space between them.
pub struct Leaf {
    geometry: Geometry,
    search: accel::Scene,
    /// By geometry of the search.
    faces: Vec<Face>,
}

impl Leaf {
    /// By what it is made of; `input` has one group, which names the faces in their order.
    pub fn new(geometry: Geometry, input: accel::Input, faces: Vec<Face>) -> Result<Self, accel::BuildError> {
        let search = accel::Scene::build(input, &geometry, &accel::Options::default())?;
        Ok(Self { geometry, search, faces })
    }

    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        let mut hits = [Hit::MISS];
        self.search.closest(&self.geometry, std::slice::from_ref(ray), &mut hits);
        let [hit] = hits;
        hit.is_hit().then_some(hit)
    }

    fn surface(&self, ray: &Ray, hit: &Hit) -> Option<SurfacePoint> {
        Some(match self.faces.get(hit.geometry as usize)? {
            Face::Shape(i) => self.geometry.surface(*i, ray, &ShapeHit { t: hit.t, u: hit.u, v: hit.v }),
            Face::Mesh(i) => self.geometry.meshes.get(*i as usize)?.surface(hit.primitive, hit.u, hit.v),
        })
    }
}

/// A step of working out whether a point is in the whole, on a stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Whether it is in a leaf.
    Leaf(u32),
    /// Whether it is in any of the last so many.
    Any(u32),
    /// Whether it is in all of the last so many.
    All(u32),
    /// Whether it is in the first of the last so many and in no other.
    Without(u32),
}

/// Leaves and what is made of them.
pub struct Solid {
    leaves: Vec<Leaf>,
    steps: Vec<Step>,
    /// Leaves of which the outside is inside.
    turned: u64,
}

impl fmt::Debug for Solid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Solid of {} leaves by {:?}", self.leaves.len(), self.steps)
    }
}

impl Solid {
    /// By its leaves, [`MOST_LEAVES`] at most, and the steps that lead to one answer; `None` where they don't.
    pub fn new(leaves: Vec<Leaf>, steps: Vec<Step>) -> Option<Self> {
        if leaves.is_empty() || leaves.len() > MOST_LEAVES {
            return None;
        }
        // What each answer on the stack depends on.
        let mut stack: Vec<u64> = Vec::new();
        let mut turned = 0_u64;
        for step in &steps {
            let count = match *step {
                Step::Leaf(i) => {
                    if i as usize >= leaves.len() {
                        return None;
                    }
                    stack.push(1 << i);
                    continue;
                }
                Step::Any(n) | Step::All(n) | Step::Without(n) => n as usize,
            };
            let first = stack.len().checked_sub(count).filter(|_| count > 0)?;
            let taken = stack.split_off(first);
            if matches!(step, Step::Without(_)) {
                turned ^= taken.iter().skip(1).fold(0, |all, one| all | one);
            }
            stack.push(taken.iter().fold(0, |all, one| all | one));
        }
        (stack.len() == 1).then_some(Self { leaves, steps, turned })
    }

    /// Whether a point is in the whole that is in these leaves.
    fn holds(&self, inside: u64) -> bool {
        // A bit for each answer, the last one lowest. No stack is higher than there are leaves.
        let mut stack = 0_u64;
        for step in &self.steps {
            let low = |n: u32| if n >= 64 { u64::MAX } else { (1 << n) - 1 };
            let (n, answer) = match *step {
                Step::Leaf(i) => (0, inside >> i & 1 != 0),
                Step::Any(n) => (n, stack & low(n) != 0),
                Step::All(n) => (n, stack & low(n) == low(n)),
                Step::Without(n) => (n, stack & low(n) == low(n) & !low(n - 1)),
            };
            stack = if n >= 64 { 0 } else { stack >> n };
            stack = stack << 1 | u64::from(answer);
        }
        stack & 1 != 0
    }

    /// The next crossing of a leaf, and whether it leaves.
    fn next(&self, leaf: usize, ray: &Ray) -> Option<(Hit, bool)> {
        let leaf = &self.leaves[leaf];
        let hit = leaf.nearest(ray)?;
        let leaves = leaf.surface(ray, &hit)?.ng.dot(ray.d) > 0.0;
        Some((hit, leaves))
    }

    /// The first place where the whole begins or ends at a face of a leaf.
    fn boundary(&self, ray: &Ray, leaf: u32, face: u32) -> Option<Hit> {
        /// More crossings than any sensible solid has.
        const MOST: usize = 4096;
        // What a ray is inside of is told by what lies beyond its end as well.
        let mut ahead = Ray { t_max: f32::INFINITY, ..*ray };
        let mut next = [None; MOST_LEAVES];
        let next = &mut next[..self.leaves.len()];
        // The leaf that is asked for first: mostly it isn't met at all.
        next[leaf as usize] = self.next(leaf as usize, &ahead);
        next[leaf as usize].filter(|(hit, _)| hit.t <= ray.t_max)?;
        for (i, slot) in next.iter_mut().enumerate().filter(|(i, _)| *i != leaf as usize) {
            *slot = self.next(i, &ahead);
        }
        let bit = |i: usize, next: &Option<(Hit, bool)>| match next {
            Some((_, true)) => 1 << i,
            _ => 0_u64,
        };
        let mut inside = next.iter().enumerate().fold(0, |all, (i, n)| all | bit(i, n));
        let mut was = self.holds(inside);
        for _ in 0..MOST {
            // Of several at one place, the first leaf.
            let mut first: Option<(usize, Hit)> = None;
            for (i, slot) in next.iter().enumerate() {
                if let Some((hit, _)) = slot
                    && first.is_none_or(|(_, best)| hit.t < best.t)
                {
                    first = Some((i, *hit));
                }
            }
            let (i, hit) = first?;
            // Past the end, or past all that is asked for.
            if hit.t > ray.t_max || next[leaf as usize].is_none() {
                return None;
            }
            ahead.t_min = hit.t.next_up();
            next[i] = self.next(i, &ahead);
            inside = inside & !(1 << i) | bit(i, &next[i]);
            let is = self.holds(inside);
            if is != was && i == leaf as usize && hit.geometry == face {
                return Some(hit);
            }
            was = is;
        }
        None
    }
}

/// A face of one of a solid's leaves, as far as it is the boundary of the whole. It can't be sampled as a light.
///
/// Hit coordinates and texture coordinates: the face's own.
#[derive(Clone, Debug)]
pub struct Part {
    solid: Arc<Solid>,
    leaf: u32,
    face: u32,
    bounds: Bounds,
}

impl Part {
    /// The face of a leaf, by their numbers; `within` holds the whole. `None` where none of it is in there.
    pub fn new(solid: Arc<Solid>, leaf: u32, face: u32, within: Bounds) -> Option<Self> {
        let of = solid.leaves.get(leaf as usize)?;
        let bounds = match of.faces.get(face as usize)? {
            Face::Shape(i) => of.geometry.bounds(*i)?,
            Face::Mesh(i) => {
                Bounds::of_points(of.geometry.meshes.get(*i as usize)?.positions.iter().copied())
            }
        };
        let bounds = bounds.intersection(within);
        (!bounds.is_empty()).then_some(Self { solid, leaf, face, bounds })
    }

    fn leaf(&self) -> &Leaf {
        &self.solid.leaves[self.leaf as usize]
    }

    /// A hit of the leaf where the whole's is.
    fn again(&self, ray: &Ray, t: f32) -> Option<Hit> {
        // A hit is never before its box, to where it may have been put off.
        let t_min = t.next_down().next_down();
        self.leaf().nearest(&Ray { t_min, t_max: t, ..*ray })
    }
}

/// What takes the place of a surface that isn't found again.
fn lost(ray: &Ray, t: f32) -> SurfacePoint {
    let n = (-ray.d).try_normalize().unwrap_or(straal_math::Vec3::Y);
    let p = ray.at(t);
    SurfacePoint { p, p_err: p.abs() * f32::EPSILON, ng: n, n, uv: [0.0; 2] }
}

impl Form for Part {
    fn bounds(&self) -> Option<Bounds> {
        Some(self.bounds)
    }

    fn intersect(&self, ray: &Ray) -> Option<ShapeHit> {
        let hit = self.solid.boundary(ray, self.leaf, self.face)?;
        Some(ShapeHit { t: hit.t, u: hit.u, v: hit.v })
    }

    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let found = self.again(ray, hit.t).and_then(|again| self.leaf().surface(ray, &again));
        let mut s = found.unwrap_or_else(|| lost(ray, hit.t));
        if self.solid.turned >> self.leaf & 1 != 0 {
            (s.ng, s.n) = (-s.ng, -s.n);
        }
        s
    }

    fn tangents(&self, s: &SurfacePoint) -> Tangents {
        let is_turned = self.solid.turned >> self.leaf & 1 != 0;
        let own = if is_turned { SurfacePoint { ng: -s.ng, n: -s.n, ..*s } } else { *s };
        let leaf = self.leaf();
        let tangents = match leaf.faces.get(self.face as usize) {
            Some(Face::Shape(i)) => Some(leaf.geometry.tangents(*i, &own)),
            Some(Face::Mesh(i)) => {
                // The triangle at the point: a short ray through it finds it.
                let reach = own.ng * (16.0 * own.p_err.length());
                let hit = leaf.nearest(&Ray { t_max: 2.0, ..Ray::new(own.p + reach, -reach) });
                let mesh = leaf.geometry.meshes.get(*i as usize);
                hit.zip(mesh).map(|(hit, mesh)| mesh.tangents(hit.primitive, hit.u, hit.v))
            }
            None => None,
        };
        let tangents = tangents.unwrap_or_else(|| Tangents::about(s.n));
        if is_turned { tangents.flipped() } else { tangents }
    }

    #[cfg(test)]
    fn examples(stand: &super::tests::Setting) -> Vec<super::tests::Example> {
        tests::examples(stand)
    }
}

#[cfg(test)]
mod tests;
