//! Lamps within objects: each is kept once, and shines wherever an instance of its object stands.
//!
//! Such a lamp stands in the space of its object, a *group* of the search structure, and so does all that is known of it: its surface, the table of
//! its triangles, and the tree by which these are chosen. A *copy* is one way from the world down to the group, instance by instance. Copies of a group are
//! numbered as paths through a graph are (Ball and Larus 1996, "Efficient Path Profiling"): each instance has a number, and the sum of those on the way is the
//! copy's. So what a ray hits knows its copy by a few additions, and a copy its way by going back up, with nothing kept for each copy.
//!
//! Light is sampled where the lamp is at rest: the point that is lit is brought there, and a point of the lamp back. What was a direction's density there is
//! another here, by how the map A from there to here spreads solid angles: dω' / dω = |det A⁻¹| / |A⁻¹ ω|³ for a unit vector ω of the world, whatever A
//! stretches or mirrors.

use super::reach::{Lamp, Reach, Receiver};
use crate::shape::SurfacePoint;
use straal_accel::{self as accel, Chain, MAX_DEPTH};
use straal_math::{Transform, Vec3, ops};

/// Which lamps stand where. The first group is the world, whose lamps are no copies.
#[derive(Clone, Debug, Default)]
pub struct Copies {
    /// Groups in which anything shines; none in a world where nothing shines within objects.
    groups: Vec<Group>,
    /// By instance of the search structure: its part of the number of a copy.
    parts: Vec<u32>,
    /// By emitter: its group. Those beyond stand in the world.
    group_of: Vec<u32>,
}

/// A group in which anything shines.
#[derive(Clone, Debug, Default)]
pub(super) struct Group {
    /// The lamps that stand in it, in order.
    pub lamps: Vec<u32>,
    /// Instances in it of groups in which anything shines, in order.
    pub inside: Vec<Inside>,
    /// How many copies of it there are.
    count: u32,
    /// The instances of it, by their parts of a copy's number.
    entrances: Vec<Entrance>,
}

/// An instance of a group in which anything shines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inside {
    /// Its id in the search structure.
    pub instance: u32,
    /// What it is of, by [`Copies::groups`].
    pub group: u32,
}

#[derive(Clone, Copy, Debug)]
struct Entrance {
    /// The first copy that goes through it.
    first: u32,
    instance: u32,
    /// The group that the instance stands in.
    outer: u32,
}

impl Copies {
    /// Of a world's groups, and of each glowing surface the group that it stands in. What comes after these among the emitters stands in the world.
    pub(crate) fn new(groups: &[accel::Group], group_of: &[u32]) -> Self {
        if group_of.iter().all(|group| *group == 0) {
            return Self::default();
        }
        // From the innermost out, each after all that it holds.
        let order = innermost_first(groups);
        let mut shines = vec![false; groups.len()];
        group_of.iter().for_each(|group| shines[*group as usize] = true);
        for &group in &order {
            shines[group] |= groups[group].instances.iter().any(|i| shines[i.group as usize]);
        }
        // The world comes first whether anything shines in it or not.
        shines[0] = true;
        let mut numbers = vec![u32::MAX; groups.len()];
        let mut count = 0;
        for (number, _) in numbers.iter_mut().zip(&shines).filter(|(_, shines)| **shines) {
            *number = count;
            count += 1;
        }
        let mut first_instance = Vec::with_capacity(groups.len());
        let mut instances = 0;
        for group in groups {
            first_instance.push(instances);
            instances += group.instances.len() as u32;
        }

        let mut all = vec![Group::default(); count as usize];
        let mut parts = vec![0; instances as usize];
        all[0].count = 1;
        for &group in order.iter().rev().filter(|group| shines[**group]) {
            let outer = numbers[group];
            for (k, instance) in groups[group].instances.iter().enumerate() {
                let number = numbers[instance.group as usize];
                if number == u32::MAX {
                    continue;
                }
                let id = first_instance[group] + k as u32;
                let copies = all[outer as usize].count;
                let inner = &mut all[number as usize];
                parts[id as usize] = inner.count;
                if copies > 0 {
                    inner.entrances.push(Entrance { first: inner.count, instance: id, outer });
                }
                // Validation has seen that there aren't too many.
                inner.count = inner.count.saturating_add(copies);
                all[outer as usize].inside.push(Inside { instance: id, group: number });
            }
        }
        let group_of: Vec<u32> = group_of.iter().map(|group| numbers[*group as usize]).collect();
        for (lamp, group) in (0..).zip(&group_of) {
            all[*group as usize].lamps.push(lamp);
        }
        for group in &mut all {
            group.inside.shrink_to_fit();
            group.entrances.shrink_to_fit();
        }
        Self { groups: all, parts, group_of }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let of = |g: &Group| {
            g.lamps.capacity() * size_of::<u32>()
                + g.inside.capacity() * size_of::<Inside>()
                + g.entrances.capacity() * size_of::<Entrance>()
        };
        let lists = (self.parts.capacity() + self.group_of.capacity()) * size_of::<u32>();
        lists + self.groups.iter().map(of).sum::<usize>()
    }

    /// Bytes that it takes for each instance of an object in which something shines.
    pub const BYTES: usize = size_of::<u32>() + size_of::<Inside>() + size_of::<Entrance>();

    /// Takes note of all emitters there are: those beyond the glowing surfaces stand in the world.
    pub(crate) fn complete(&mut self, emitters: usize) {
        let known = self.group_of.len();
        if let Some(world) = self.groups.first_mut() {
            world.lamps.extend(known as u32..emitters as u32);
            self.group_of.resize(emitters, 0);
        }
    }

    /// The lamps of a group and the instances in it, in which something shines.
    #[inline]
    pub(super) fn of_group(&self, group: usize) -> (&[u32], &[Inside]) {
        self.groups.get(group).map_or((&[], &[]), |group| (&group.lamps, &group.inside))
    }

    /// Whether nothing shines within objects.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Whether an emitter stands within an object.
    #[inline(always)]
    pub fn has(&self, emitter: u32) -> bool {
        self.group_of.get(emitter as usize).is_some_and(|group| *group != 0)
    }

    /// How often an emitter shines.
    pub fn count(&self, emitter: u32) -> u32 {
        let group = self.group_of.get(emitter as usize).filter(|group| **group != 0);
        group.map_or(1, |group| self.groups[*group as usize].count)
    }

    /// The copy that a ray has hit.
    #[inline]
    pub(crate) fn number(&self, chain: &Chain) -> u32 {
        chain.iter().fold(0, |sum, id| sum.wrapping_add(self.part(id)))
    }

    /// What an instance adds to the number of a copy.
    #[inline(always)]
    pub(super) fn part(&self, instance: u32) -> u32 {
        self.parts.get(instance as usize).copied().unwrap_or(0)
    }

    /// The way from the world to a copy of an emitter.
    pub(crate) fn way(&self, emitter: u32, copy: u32) -> Way {
        let mut ids = [0; MAX_DEPTH];
        let (mut group, mut copy) = (self.group_of.get(emitter as usize).copied().unwrap_or(0), copy);
        let mut first = MAX_DEPTH;
        while group != 0 && first > 0 {
            let entrances = &self.groups[group as usize].entrances;
            let place = entrances.partition_point(|e| e.first <= copy);
            let Some(entrance) = place.checked_sub(1).and_then(|i| entrances.get(i)) else { break };
            first -= 1;
            ids[first] = entrance.instance;
            copy -= entrance.first;
            group = entrance.outer;
        }
        Way { ids, first: first as u32 }
    }

    /// All groups in which anything shines, and their numbers so that each comes after all that it holds.
    pub(super) fn groups(&self) -> (&[Group], Vec<usize>) {
        fn visit(groups: &[Group], at: usize, seen: &mut [bool], order: &mut Vec<usize>) {
            if std::mem::replace(&mut seen[at], true) {
                return;
            }
            for inside in &groups[at].inside {
                visit(groups, inside.group as usize, seen, order);
            }
            order.push(at);
        }
        let mut order = Vec::with_capacity(self.groups.len());
        let mut seen = vec![false; self.groups.len()];
        for at in 0..self.groups.len() {
            visit(&self.groups, at, &mut seen, &mut order);
        }
        (&self.groups, order)
    }
}

/// Groups that the world reaches, each after all that it holds. Validation has seen that they end, at [`MAX_DEPTH`].
fn innermost_first(groups: &[accel::Group]) -> Vec<usize> {
    fn visit(groups: &[accel::Group], at: usize, seen: &mut [bool], order: &mut Vec<usize>) {
        if std::mem::replace(&mut seen[at], true) {
            return;
        }
        for instance in &groups[at].instances {
            visit(groups, instance.group as usize, seen, order);
        }
        order.push(at);
    }
    let mut order = Vec::with_capacity(groups.len());
    visit(groups, 0, &mut vec![false; groups.len()], &mut order);
    order
}

/// Where lamps stand, and what knows the instances.
#[derive(Clone, Copy)]
pub struct Within<'a> {
    /// Which lamps stand in objects.
    pub copies: &'a Copies,
    /// Where these are.
    pub search: Option<&'a accel::Scene>,
}

impl Within<'static> {
    /// All of them in the world itself.
    pub const WORLD: Self = Self {
        copies: &Copies { groups: Vec::new(), parts: Vec::new(), group_of: Vec::new() },
        search: None,
    };
}

impl<'a> Within<'a> {
    /// How an instance stands. What shines doesn't move.
    #[inline]
    pub(super) fn transform(self, instance: u32) -> Transform {
        self.search.and_then(|search| search.transform(instance, 0.0)).unwrap_or(Transform::IDENTITY)
    }

    /// Where a copy of an emitter stands.
    #[inline]
    pub(crate) fn stand(self, emitter: u32, copy: u32) -> Stand<'a> {
        Stand { within: self, way: self.copies.way(emitter, copy) }
    }

    /// Where what a ray hit stands.
    #[inline]
    pub(crate) fn stand_of(self, chain: &Chain) -> Stand<'a> {
        let mut ids = [0; MAX_DEPTH];
        let mut first = MAX_DEPTH;
        for id in chain.iter().rev() {
            first -= 1;
            ids[first] = id;
        }
        Stand { within: self, way: Way { ids, first: first as u32 } }
    }
}

/// Instances from the world down to a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Way {
    /// Their ids, at the end, the innermost last.
    ids: [u32; MAX_DEPTH],
    first: u32,
}

impl Way {
    /// From the outermost on.
    pub(super) fn iter(&self) -> impl DoubleEndedIterator<Item = u32> + '_ {
        self.ids[self.first as usize..].iter().copied()
    }
}

/// The space of a copy.
#[derive(Clone, Copy)]
pub(crate) struct Stand<'a> {
    within: Within<'a>,
    way: Way,
}

impl Stand<'_> {
    /// From the world's inwards.
    #[inline]
    fn transforms(&self) -> impl DoubleEndedIterator<Item = Transform> + '_ {
        self.way.iter().map(|id| self.within.transform(id))
    }

    /// A point that is lit, as the lamp has it.
    #[inline]
    pub fn receiver(&self, at: &Receiver) -> Receiver {
        self.transforms().fold(*at, |at, m| inwards(&at, &m))
    }

    /// What is known of the lamp, as the world has it.
    pub(super) fn reach(&self, reach: Reach) -> Reach {
        match reach {
            Reach::Surface(lamp) => {
                Reach::Surface(self.transforms().rev().fold(lamp, |lamp, m| through(&lamp, &m)))
            }
            // Nothing else stands in objects.
            other => other,
        }
    }

    /// A point of the lamp, as the world has it.
    #[inline]
    pub fn outwards(&self, point: &SurfacePoint) -> SurfacePoint {
        self.transforms().rev().fold(*point, |point, m| point.to_world(&m))
    }

    /// A point of the world as the lamp has it; its error is that of nothing.
    #[inline]
    pub fn inwards(&self, point: &SurfacePoint) -> SurfacePoint {
        let normal = |m: &Transform, n: Vec3| mirrored(m).normal(n).try_normalize().unwrap_or(n);
        self.transforms().fold(*point, |point, m| SurfacePoint {
            p: m.inverse_point(point.p),
            ng: normal(&m, point.ng),
            n: normal(&m, point.n),
            ..point
        })
    }

    /// By how much more solid angle a small cone about the unit vector `wi` of the world has in the lamp's space.
    #[inline]
    pub fn widening(&self, wi: Vec3) -> f32 {
        let start = (wi, 1.0_f32);
        let (_, widening) = self.transforms().fold(start, |(wi, widening), m| {
            let inside = m.inverse_vector(wi);
            let length = inside.length();
            let each = determinant(&m.inverse).abs() / (length * length * length);
            (inside * (1.0 / length), widening * each)
        });
        widening
    }

    /// By how much more area the world has of a small piece of the lamp with this unit normal.
    #[inline]
    pub fn stretch(&self, ng: Vec3) -> f32 {
        let start = (ng, 1.0_f32);
        let (_, stretch) = self.transforms().rev().fold(start, |(ng, stretch), m| {
            let outside = m.normal(ng);
            let length = outside.length();
            (outside * (1.0 / length), stretch * (determinant(&m.forward).abs() * length))
        });
        stretch
    }
}

/// What is lit, from outside of an instance as from within.
#[inline]
pub(super) fn inwards(at: &Receiver, m: &Transform) -> Receiver {
    // The plane that it lies in is the same; light from all around stays so.
    let n = mirrored(m).normal(at.n).try_normalize().unwrap_or(Vec3::ZERO);
    Receiver { p: m.inverse_point(at.p), n }
}

/// The map back.
#[inline(always)]
fn mirrored(m: &Transform) -> Transform {
    Transform { forward: m.inverse, inverse: m.forward }
}

/// Of the linear part of three rows of four.
#[inline]
pub(super) fn determinant(rows: &[[f32; 4]; 3]) -> f32 {
    let [a, b, c] = rows.map(|[x, y, z, _]| Vec3::new(x, y, z).as_dvec3());
    a.dot(b.cross(c)) as f32
}

/// What is known of a lamp, as it is from outside of an instance.
fn through(lamp: &Lamp, m: &Transform) -> Lamp {
    let area = lamp.spread * std::f32::consts::PI;
    // Areas as vectors go by the cofactors of the map.
    let facing = m.normal(lamp.facing * lamp.flatness) * determinant(&m.forward).abs();
    let is_flat = lamp.flatness == 1.0;
    let stretch = if is_flat { facing.length() } else { mean_stretch(m) };
    let flatness = if is_flat { 1.0 } else { ops::min(facing.length() / stretch, 1.0) };
    Lamp {
        center: m.point(lamp.center),
        radius: lamp.radius * largest_stretch(m),
        facing: facing.try_normalize().unwrap_or(Vec3::ZERO),
        flatness,
        both_sides: lamp.both_sides,
        flux: lamp.flux * stretch,
        spread: area * stretch * std::f32::consts::FRAC_1_PI,
    }
}

/// By how much areas grow whose normals lie all around: the root of the mean square, the same in all directions of a map that keeps shapes.
pub(super) fn mean_stretch(m: &Transform) -> f32 {
    let sum: f64 = m.inverse.iter().map(|r| square(&r[..3])).sum();
    (f64::from(determinant(&m.forward)).abs() * (sum / 3.0).sqrt()) as f32
}

/// A bound of how much lengths grow: the root of the largest sum in a row of the map's square.
fn largest_stretch(m: &Transform) -> f32 {
    let square = columns_by_each_other(m);
    let sums = square.map(|row| row.iter().map(|v| v.abs()).sum::<f64>());
    (sums.into_iter().fold(0.0, |a: f64, b| if b > a { b } else { a }).sqrt() * (1.0 + 1e-6)) as f32
}

/// The cosine of the cone about the image of an axis that holds the images of normals, where those lie in a cone of this cosine. With a half
/// angle of a, theirs is b at most, tan(b/2) = k tan(a/2), by the condition k of the map (Wielandt's inequality).
pub(super) fn wider(cos: f32, m: &Transform) -> f32 {
    if cos >= 1.0 || cos <= -1.0 {
        return cos;
    }
    let square = columns_by_each_other(m);
    let size = (square[0][0] + square[1][1] + square[2][2]) / 3.0;
    let off = |i: usize, j: usize| square[i][j] - if i == j { size } else { 0.0 };
    let worst = (0..9).map(|k| off(k / 3, k % 3).abs()).fold(0.0, |a: f64, b| if b > a { b } else { a });
    let condition = if worst < 1e-5 * size {
        1.0 + 1e-4
    } else {
        // Guggenheimer, Edelman and Johnson (1995), "A simple estimate of the condition number of a linear system".
        2.0 * size * size.sqrt() / f64::from(determinant(&m.forward)).abs()
    };
    // (1 - cos) / (1 + cos) is the square of the tangent of half the angle.
    let cos = f64::from(cos);
    let tangent = condition * condition * (1.0 - cos) / (1.0 + cos);
    let wide = (1.0 - tangent) / (1.0 + tangent);
    // A little more, for rounding; what isn't a number is any direction.
    if wide > -1.0 + 1e-5 { (wide - 1e-5) as f32 } else { -1.0 }
}

/// The products of the map's columns.
fn columns_by_each_other(m: &Transform) -> [[f64; 3]; 3] {
    let of = |i: usize, j: usize| m.forward.iter().map(|r| f64::from(r[i]) * f64::from(r[j])).sum();
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| of(i, j)))
}

fn square(v: &[f32]) -> f64 {
    v.iter().map(|v| f64::from(*v) * f64::from(*v)).sum()
}
