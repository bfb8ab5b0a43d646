//! Does a box around an object pay?
//!
//! A box that is tested before an object spares the object's cost for rays that miss the box, and costs its own test for
//! all: with p the share of rays that cross it, it pays when
//!
//! cost_BV + p cost_group < cost_group
//!
//! (Weghorst, Hooper and Greenberg 1984; Suffern 2007, section 22.2). Here p is measured on the recorded rays, and the
//! costs in tests, where a box and a primitive count 1 each, and in time. p cost_group is what the rays that cross the
//! box cost, shared among all: where the object has a tree of its own, they cost more than those that miss it.

use super::Object;
use super::measure::{Bench, ByKind, Tests};
use super::rays::{Kind, RaySet};
use std::hint::black_box;
use straal_accel::{BuildError, Geometry, GeometryKind, Group, Input, Instance, Scene, Structure};
use straal_math::{Bounds, Ray, Transform, ops};
use straal_render::world::World;

/// The inequality for the objects at the top of the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Volumes {
    /// In the order of the scene.
    pub rows: Vec<Weighing>,
    /// Objects that are not in `rows`: those with the fewest primitives.
    pub left_out: usize,
}

/// The inequality for one object.
#[derive(Clone, Debug, PartialEq)]
pub struct Weighing {
    /// Its number and kind.
    pub name: String,
    /// Triangles and shapes in it, instances counted each time.
    pub primitives: u64,
    /// `None` for an object that nothing bounds: no volume holds it.
    pub bounded: Option<Bounded>,
}

/// What was measured of an object that a box holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounded {
    /// p: the share of the picture's rays that cross the box.
    pub crossing: f64,
    /// In tests, each primitive asked by itself.
    pub tests: Inequality,
    /// In nanoseconds, each primitive asked by itself.
    pub time: Inequality,
    /// In nanoseconds, the object searched by a tree of its own.
    pub tree_time: Inequality,
}

/// Both sides of cost_BV + p cost_group < cost_group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inequality {
    /// cost_BV: of the box, for each ray.
    pub volume: f64,
    /// p cost_group: of the object, for the rays that cross the box, shared among all rays.
    pub within: f64,
    /// The same for the rays that don't: what the box spares.
    pub spared: f64,
}

impl Inequality {
    /// cost_group: of the object, for each ray.
    pub fn group(&self) -> f64 {
        self.within + self.spared
    }

    /// The left side.
    pub fn with_volume(&self) -> f64 {
        self.volume + self.within
    }

    /// Whether the box pays.
    pub fn pays(&self) -> bool {
        self.volume < self.spared
    }
}

/// Objects that are weighed at most: those with the most primitives.
const MOST_OBJECTS: usize = 16;

/// Rays of each kind that they are weighed on.
const RAYS: usize = 2048;

pub(crate) fn weigh(bench: &Bench<'_>, input: &Input, objects: &[Object]) -> Volumes {
    let mut chosen: Vec<&Object> = objects.iter().collect();
    chosen.sort_by_key(|o| std::cmp::Reverse(o.primitives));
    chosen.truncate(MOST_OBJECTS);
    let row = |o: &Object| {
        let is_chosen = chosen.iter().any(|c| std::ptr::eq(*c, o));
        is_chosen.then(|| Weighing {
            name: o.name.clone(),
            primitives: o.primitives,
            // What can't be built apart has been built together: there is no error to tell.
            bounded: if o.unbounded { None } else { weigh_one(bench, input, o).ok() },
        })
    };
    let rows: Vec<Weighing> = objects.iter().filter_map(row).collect();
    Volumes { left_out: objects.len() - rows.len(), rows }
}

fn weigh_one(bench: &Bench<'_>, input: &Input, object: &Object) -> Result<Bounded, BuildError> {
    let (input, into) = alone(input, object);
    let one_by_one = bench.build(&input, Structure::Brute)?;
    let tree = bench.build(&input, Structure::default())?;
    let empty = Input { groups: vec![Group::default()], ..Input::default() };
    let nothing = bench.build(&empty, Structure::Brute)?;
    let bounds = one_by_one.bounds();

    // In the object's space, the rays that cross its box and those that don't, and what share of all each are.
    let sides = bench.rays.each_ref().map(|set| {
        let mut set = set.clone();
        if let Some(m) = &into {
            set.rays.iter_mut().for_each(|r| *r = m.inverse_ray(r));
        }
        [set.filtered(|r| crosses(&bounds, r)), set.filtered(|r| !crosses(&bounds, r))]
    });
    let side = |s: usize| sides.each_ref().map(|kind| kind[s].clone());
    let sets = [side(0), side(1)];
    let share = |s: usize| {
        sides.each_ref().map(|kind| {
            let all = kind[0].rays.len() + kind[1].rays.len();
            kind[s].rays.len() as f64 / all.max(1) as f64
        })
    };
    let shares = [share(0), share(1)];
    let weigh =
        |costs: [ByKind<f64>; 2]| [0, 1].map(|s| bench.mean(&[0, 1, 2].map(|k| shares[s][k] * costs[s][k])));

    // One by one costs the more, the larger the object: then fewer rays are asked.
    let some = |rays: usize| {
        sets.each_ref()
            .map(|kinds| kinds.each_ref().map(|set| set.every(set.rays.len().div_ceil(rays).max(1))))
    };
    let tests = |sets: &ByKind<RaySet>| [0, 1, 2].map(|k| tests(bench, &one_by_one, Kind::ALL[k], &sets[k]));
    let pilot = some(16).each_ref().map(tests);
    let dearest = pilot.as_flattened().iter().copied().fold(1.0, |a, b| if b > a { b } else { a });
    let few = some(RAYS.min((bench.most_tests() as f64 / 4.0 / dearest) as usize).max(1));
    let many = some(RAYS);
    // What every search does whatever stands in the scene is no part of the object's cost.
    let time = |scene: &Scene, sets: &ByKind<RaySet>| {
        let [with, without] = bench.race([scene, &nothing], sets);
        [0, 1, 2].map(|k| if with[k] > without[k] { with[k] - without[k] } else { 0.0 })
    };
    let volume = box_nanoseconds(bench, &bounds, &many);
    let inequality = |volume: f64, costs: [ByKind<f64>; 2]| {
        let [within, spared] = weigh(costs);
        Inequality { volume, within, spared }
    };
    Ok(Bounded {
        crossing: bench.mean(&shares[0]),
        tests: inequality(1.0, few.each_ref().map(tests)),
        time: inequality(volume, few.each_ref().map(|sets| time(&one_by_one, sets))),
        tree_time: inequality(volume, many.each_ref().map(|sets| time(&tree, sets))),
    })
}

/// Primitives tested for a mean ray of a set.
fn tests(bench: &Bench<'_>, scene: &Scene, kind: Kind, set: &RaySet) -> f64 {
    let mut sum = Tests::default();
    for ray in &set.rays {
        let cost = match kind {
            Kind::Shadow => scene.occluded_counted(bench.shapes(), ray).1,
            Kind::Primary | Kind::Bounce => scene.closest_counted(bench.shapes(), ray).1,
        };
        sum.add(&cost);
    }
    if sum.rays > 0 { sum.primitives as f64 / sum.rays as f64 } else { 0.0 }
}

/// The object by itself. What is a single instance is looked at in its own space, into which the transform leads, since
/// an instance has a box already.
fn alone(input: &Input, object: &Object) -> (Input, Option<Transform>) {
    let world = &input.groups[0];
    let instances = &world.instances[object.instances.clone()];
    let mut out = input.clone();
    if let ([], [instance]) = (object.geometries.as_slice(), instances) {
        out.groups[0] = input.groups[instance.group as usize].clone();
        return (out, Some(instance.transform));
    }
    out.groups[0] = Group { geometries: object.geometries.clone(), instances: instances.to_vec() };
    (out, None)
}

/// Whether a ray crosses a box within its interval (Kay and Kajiya 1986).
fn crosses(b: &Bounds, r: &Ray) -> bool {
    let (mut enter, mut exit) = (r.t_min, r.t_max);
    for axis in 0..3 {
        let inverse = 1.0 / r.d[axis];
        let (a, z) = ((b.min[axis] - r.o[axis]) * inverse, (b.max[axis] - r.o[axis]) * inverse);
        enter = ops::max(enter, ops::min(a, z));
        exit = ops::min(exit, ops::max(a, z));
    }
    enter <= exit
}

/// Nanoseconds of one box test.
fn box_nanoseconds(bench: &Bench<'_>, bounds: &Bounds, sets: &[ByKind<RaySet>; 2]) -> f64 {
    let mut best = f64::INFINITY;
    let sets = sets.as_flattened();
    let count: usize = sets.iter().map(|s| s.rays.len()).sum();
    for _ in 0..8 {
        let (ns, _) = bench.timed(|| {
            sets.iter().flat_map(|s| &s.rays).filter(|r| crosses(black_box(bounds), black_box(r))).count()
        });
        let each = ns as f64 / count.max(1) as f64;
        if each < best {
            best = each;
        }
    }
    best
}

/// How much stands in each group, instances followed.
pub(crate) struct Sizes<'a> {
    input: &'a Input,
    geometries: Vec<Size>,
    groups: Vec<Size>,
}

/// Of a geometry, a group or an object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Size {
    pub primitives: u64,
    pub unbounded: bool,
}

impl Size {
    fn and(self, o: Self) -> Self {
        Self {
            primitives: self.primitives.saturating_add(o.primitives),
            unbounded: self.unbounded || o.unbounded,
        }
    }
}

impl<'a> Sizes<'a> {
    pub fn of(world: &World, input: &'a Input) -> Self {
        let geometry = |g: &Geometry| match &g.kind {
            GeometryKind::Triangles { indices, .. } => {
                Size { primitives: indices.len() as u64, unbounded: false }
            }
            GeometryKind::Shapes { first, count } => Size {
                primitives: u64::from(*count),
                unbounded: (*first..first + count).any(|s| world.geometry.bounds(s).is_none()),
            },
        };
        let geometries = input.geometries.iter().map(geometry).collect();
        let mut out = Self { input, geometries, groups: vec![Size::default(); input.groups.len()] };
        // A group is known when those inside are; at most so many levels are inside one another.
        for _ in 0..=straal_accel::MAX_DEPTH {
            out.groups = input.groups.iter().map(|g| out.sum(&g.geometries, &g.instances)).collect();
        }
        out
    }

    pub fn sum(&self, geometries: &[u32], instances: &[Instance]) -> Size {
        let direct = geometries.iter().map(|&g| self.geometries[g as usize]);
        let inside = instances.iter().map(|i| self.groups[i.group as usize]);
        direct.chain(inside).fold(Size::default(), Size::and)
    }

    /// Whether a geometry has a box.
    pub fn is_bounded(&self, geometry: u32) -> bool {
        !self.geometries[geometry as usize].unbounded
    }

    /// The same of an instance.
    pub fn is_instance_bounded(&self, instance: &Instance) -> bool {
        !self.groups[instance.group as usize].unbounded
    }

    pub fn input(&self) -> &'a Input {
        self.input
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_math::Vec3;

    #[test]
    fn a_box_pays_when_enough_rays_miss_enough_work() {
        let i =
            |volume, group: f64, p: f64| Inequality { volume, within: p * group, spared: (1.0 - p) * group };
        assert!(i(1.0, 2.0, 0.4).pays() && !i(1.0, 2.0, 0.5).pays());
        assert!(!i(1.0, 1.0, 0.0).pays(), "a box before a single primitive of its own cost never pays");
        assert!(i(1.0, 1000.0, 0.9).pays());
        assert_eq!(i(1.0, 10.0, 0.5).with_volume(), 6.0);
    }

    #[test]
    fn rays_cross_boxes_within_their_interval() {
        let b = Bounds { min: Vec3::ZERO, max: Vec3::splat(1.0) };
        let ray = |o, d| Ray::new(o, d);
        assert!(crosses(&b, &ray(Vec3::new(0.5, 0.5, -3.0), Vec3::Z)));
        assert!(!crosses(&b, &ray(Vec3::new(0.5, 0.5, -3.0), -Vec3::Z)), "behind");
        assert!(!crosses(&b, &ray(Vec3::new(1.5, 0.5, -3.0), Vec3::Z)), "beside");
        assert!(crosses(&b, &ray(Vec3::splat(0.5), Vec3::X)), "from inside");
        let short = Ray { t_max: 2.0, ..ray(Vec3::new(0.5, 0.5, -3.0), Vec3::Z) };
        assert!(!crosses(&b, &short), "ends before");
    }
}
