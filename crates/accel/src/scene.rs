//! A scene ready to be searched, and how it is put together.

use crate::{
    Isa,
    analytic::block::Member,
    brute::Brute,
    bsp::BspTree,
    bvh::Bvh,
    bvh2::Bvh2,
    dropped::{Dropped, DroppedFrom},
    entry::Asked,
    grid::Grid,
    hit::{Cost, Hit, MAX_DEPTH},
    input::{BuildError, GeometryKind, Group, Input, Instance, Shapes},
    kd::KdTree,
    kernel::Chosen,
    octree::Octree,
    prim::{Prim, PrimKind},
    query::{Built, Stats},
    slab,
    stage::{GroupData, MeshStart, Object, ObjectKind, Stage},
    structure::{Searcher, Structure, each},
    triangle,
    volumes::{Content, Volumes},
};
use straal_math::{Bounds, Ray, Transform, Vec3};

/// How a scene is built and searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The search structure of every group.
    pub structure: Structure,
    /// The instruction set of the kernels.
    pub isa: Isa,
    /// How the rays of a slice are searched.
    pub flight: Flight,
}

impl Default for Options {
    /// The default structure, and the best instruction set that this processor has.
    fn default() -> Self {
        Self { structure: Structure::default(), isa: Isa::detect(), flight: Flight::default() }
    }
}

/// How the rays of a slice are searched. It changes nothing but the speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Flight {
    /// One after the other.
    One,
    /// Many side by side, so that one computes while others wait; those that go the same way as a packet.
    #[default]
    Many,
}

/// Everything that can be hit, ready to be searched. Read-only, and shared between threads.
pub struct Scene {
    stage: Stage<Searcher>,
    /// What stands in each group, by group.
    contents: Vec<Contents>,
    structure: Structure,
    /// Groups whose structures were another scene's.
    taken_over: usize,
    /// Groups whose structures were another scene's, with boxes of their own.
    refitted: usize,
    isa: Isa,
    kernel: Chosen,
    many: bool,
    dropped: Vec<Dropped>,
}

/// What a group was given, without what the scene holds anyway.
struct Contents {
    geometries: Vec<u32>,
    /// Its first instance, in the instances of all groups.
    first_instance: u32,
}

/// A group with its structure.
struct Grouped {
    data: GroupData,
    searcher: Searcher,
    /// What can never be hit in it.
    dropped: Vec<Dropped>,
    /// Whether the structure is another scene's, with boxes of its own.
    is_refitted: bool,
}

impl Scene {
    /// Checks the input and builds the structure of every group that the world needs. Uses the threads of the current
    /// rayon pool; the result doesn't depend on their number.
    pub fn build(input: Input, shapes: &dyn Shapes, options: &Options) -> Result<Self, BuildError> {
        Self::build_after(None, input, shapes, options)
    }

    /// The same, after a scene of which much may have stayed, as after the frame before: where a group of the same number has the same
    /// triangles and nothing else, its structure is taken over; where it has as much as there was, in other places, its tree may be kept with other boxes. What
    /// rays hit is what they hit after [`Self::build`].
    pub fn build_after(
        mut before: Option<Self>,
        input: Input,
        shapes: &dyn Shapes,
        options: &Options,
    ) -> Result<Self, BuildError> {
        before = before.filter(|before| before.structure == options.structure && before.isa == options.isa);
        if !options.isa.is_available() {
            return Err(BuildError::IsaMissing { isa: options.isa });
        }
        check(&input)?;
        let order = children_first(&input.groups)?;
        let Input { groups, geometries, motions } = input;
        let firsts: Vec<u32> =
            groups.iter().scan(0, |n, g| Some(std::mem::replace(n, *n + g.instances.len() as u32))).collect();
        let mut scene = Self {
            stage: Stage {
                masks: geometries.iter().map(|g| g.mask).collect(),
                geometries,
                instances: groups.iter().flat_map(|g| g.instances.iter().copied()).collect(),
                motions,
                searchers: groups.iter().map(|_| Searcher::Bvh(Bvh::EMPTY)).collect(),
                groups: (0..groups.len()).map(GroupData::empty).collect(),
            },
            contents: groups
                .iter()
                .zip(&firsts)
                .map(|(g, &first_instance)| Contents { geometries: g.geometries.clone(), first_instance })
                .collect(),
            structure: options.structure,
            taken_over: 0,
            refitted: 0,
            isa: options.isa,
            kernel: Chosen::new(options.isa),
            many: options.flight == Flight::Many,
            dropped: Vec::new(),
        };
        for g in order {
            let kept = before.as_mut().and_then(|before| before.give(g, &groups[g], &scene.stage));
            scene.taken_over += usize::from(kept.is_some());
            let made = match kept {
                Some(kept) => kept,
                None => {
                    let old = before.as_mut().and_then(|before| before.give_tree(g));
                    scene.build_group(g, &groups[g], firsts[g], shapes, options, old)?
                }
            };
            let Grouped { data, searcher, dropped, is_refitted } = made;
            scene.refitted += usize::from(is_refitted);
            (scene.stage.groups[g], scene.stage.searchers[g]) = (data, searcher);
            scene.dropped.extend(dropped);
        }
        Ok(scene)
    }

    /// Gives the structure of a group away, if all that is in the group of that number are the same triangles.
    fn give(&mut self, g: usize, group: &Group, stage: &Stage<Searcher>) -> Option<Grouped> {
        let own = self.contents.get(g)?;
        let is_built = self.stage.groups[g].is_built;
        let is_same = |&id: &u32| {
            let of = |stage: &Stage<Searcher>| stage.geometries.get(id as usize).cloned();
            matches!((of(&self.stage), of(stage)), (Some(a), Some(b)) if a.mask == b.mask && a.kind.is_same_mesh(&b.kind))
        };
        let ends = self.contents.get(g + 1).map_or(self.stage.instances.len(), |c| c.first_instance as usize);
        let has_instances = own.first_instance as usize != ends || !group.instances.is_empty();
        let is_alike = is_built && !has_instances && own.geometries == group.geometries;
        if !is_alike || !group.geometries.iter().all(is_same) {
            return None;
        }
        let data = std::mem::replace(&mut self.stage.groups[g], GroupData::empty(g));
        let searcher = std::mem::replace(&mut self.stage.searchers[g], Searcher::Bvh(Bvh::EMPTY));
        // The same in each group that it stands in.
        let lost =
            |id: &u32| self.dropped.iter().find(|lost| lost.from == DroppedFrom::Geometry(*id)).copied();
        let dropped = own.geometries.iter().filter_map(lost).collect();
        Some(Grouped { data, searcher, dropped, is_refitted: false })
    }

    /// Gives the tree of a group away, whatever is in it.
    fn give_tree(&mut self, g: usize) -> Option<Bvh> {
        match std::mem::replace(self.stage.searchers.get_mut(g)?, Searcher::Bvh(Bvh::EMPTY)) {
            Searcher::Bvh(bvh) => Some(bvh),
            _ => None,
        }
    }

    /// How many groups have the tree that another scene had, with boxes where things are ([`Self::build_after`]).
    pub fn refitted(&self) -> usize {
        self.refitted
    }

    /// How many groups have the structure that another scene had ([`Self::build_after`]).
    pub fn taken_over(&self) -> usize {
        self.taken_over
    }

    /// What the scene was built from, to build it another way. Meshes are shared, not copied.
    pub fn input(&self) -> Input {
        let first = |group: usize| {
            self.contents.get(group).map_or(self.stage.instances.len(), |c| c.first_instance as usize)
        };
        let group = |(i, c): (usize, &Contents)| Group {
            geometries: c.geometries.clone(),
            instances: self.stage.instances[first(i)..first(i + 1)].to_vec(),
        };
        Input {
            groups: self.contents.iter().enumerate().map(group).collect(),
            geometries: self.stage.geometries.clone(),
            motions: self.stage.motions.clone(),
        }
    }

    /// Around everything bounded in the world; empty when there is nothing.
    pub fn bounds(&self) -> Bounds {
        self.stage.groups[0].bounds
    }

    /// Bytes of the search structures, without the meshes themselves.
    pub fn memory_bytes(&self) -> usize {
        let group = |g: &GroupData| {
            each!(&self.stage.searchers[g.index], s => s.memory_bytes())
                + size_of_val(g.objects.as_slice())
                + size_of_val(g.unbounded.as_slice())
                + size_of_val(g.meshes.as_slice())
        };
        self.stage.groups.iter().map(group).sum::<usize>()
            + size_of_val(self.stage.instances.as_slice())
            + size_of_val(self.stage.masks.as_slice())
    }

    /// What the structures of the groups that the world reaches are made of, by group; `None` for the others.
    pub fn stats(&self) -> Vec<Option<Stats>> {
        let reached =
            |g: &GroupData| g.is_built.then(|| each!(&self.stage.searchers[g.index], s => s.stats()));
        self.stage.groups.iter().map(reached).collect()
    }

    /// The cells (grid, kd-tree, octree, BSP tree) or boxes (binary tree) of the world where the plane at a height z cuts them, for
    /// drawings. Other structures have none.
    pub fn section(&self, z: f64) -> Vec<crate::Section> {
        each!(&self.stage.searchers[0], s => s.section(z))
    }

    /// What was left out because it can never be hit: primitives with a coordinate that isn't finite, triangles without
    /// area, shapes with an empty box. Groups that the world doesn't reach aren't counted; a geometry that stands in several
    /// is there several times.
    pub fn dropped(&self) -> &[Dropped] {
        &self.dropped
    }

    /// The instruction set in use.
    pub fn isa(&self) -> Isa {
        self.isa
    }

    fn asked<'a>(&'a self, shapes: &'a dyn Shapes) -> Asked<'a> {
        Asked { stage: &self.stage, kernel: self.kernel, many: self.many, shapes }
    }

    /// The instance of a chain's id: its place in all groups' instances, one group after the other.
    pub fn instance(&self, id: u32) -> Option<&Instance> {
        self.stage.instances.get(id as usize)
    }

    /// Where the instance of a chain's id is at a time from 0 to 1.
    #[inline]
    pub fn transform(&self, id: u32, time: f32) -> Option<Transform> {
        self.instance(id).map(|instance| self.stage.transform(instance, time))
    }

    /// Whether any instance moves.
    pub fn moves(&self) -> bool {
        !self.stage.motions.is_empty()
    }

    /// The first hit of each ray. Looks at as many rays as there are hits, and the other way round.
    pub fn closest(&self, shapes: &dyn Shapes, rays: &[Ray], hits: &mut [Hit]) {
        self.asked(shapes).closest(rays, hits);
    }

    /// Whether each ray hits anything. Looks at as many rays as there are answers, and the other way round.
    pub fn occluded(&self, shapes: &dyn Shapes, rays: &[Ray], blocked: &mut [bool]) {
        self.asked(shapes).occluded(rays, blocked);
    }

    /// [`Self::closest`] of one ray, with the number of tests it took.
    pub fn closest_counted(&self, shapes: &dyn Shapes, ray: &Ray) -> (Hit, Cost) {
        self.asked(shapes).closest_counted(ray)
    }

    /// [`Self::occluded`] of one ray, with the number of tests it took.
    pub fn occluded_counted(&self, shapes: &dyn Shapes, ray: &Ray) -> (bool, Cost) {
        self.asked(shapes).occluded_counted(ray)
    }

    /// Checks what searches rely on, for tests: every primitive where it can be found.
    pub fn validate(&self) -> Result<(), String> {
        for (i, g) in self.stage.groups.iter().enumerate() {
            let sound = match &self.stage.searchers[i] {
                Searcher::Brute(_) => Ok(()),
                Searcher::Bvh(s) => s.validate(&g.prim_bounds(self), |id| self.stage.vertices(g, id)),
                Searcher::Bvh2(s) => s.validate(&g.prim_bounds(self)),
                Searcher::Grid(s) => s.validate(&g.prim_bounds(self)),
                Searcher::Kd(s) => s.validate(&g.prim_bounds(self)),
                Searcher::Octree(s) => s.validate(&g.prim_bounds(self)),
                Searcher::Bsp(s) => s.validate(&g.prim_bounds(self), |id| self.stage.vertices(g, id)),
                Searcher::Volumes(s) => s.validate(&g.prim_bounds(self), &Meshes { scene: self, group: g }),
            };
            sound.map_err(|e| format!("group {i}: {e}"))?;
        }
        Ok(())
    }

    /// Around an instance, wherever it goes.
    fn bounds_of(&self, inner: &GroupData, instance: &Instance) -> Bounds {
        let all = self.stage.transforms(instance).iter().map(|at| instance_bounds(inner.bounds, at));
        let is_odd = |b: &Bounds| b.is_empty() || !b.is_finite();
        all.clone().find(is_odd).unwrap_or_else(|| all.fold(Bounds::EMPTY, Bounds::union))
    }

    fn build_group(
        &self,
        index: usize,
        group: &Group,
        first_instance: u32,
        shapes: &dyn Shapes,
        options: &Options,
        old: Option<Bvh>,
    ) -> Result<Grouped, BuildError> {
        let mut data = GroupData { is_built: true, ..GroupData::empty(index) };
        let mut prims = Vec::new();
        // What is searched one by one needs no boxes.
        let mut brute = matches!(options.structure, Structure::Brute).then(Brute::default);
        let mut dropped = Vec::new();
        let mut ids = group.geometries.clone();
        ids.sort_unstable();
        ids.dedup();
        // Lists that grow leave holes in memory behind.
        let shapes_of = |id: &u32| match self.stage.geometries[*id as usize].kind {
            GeometryKind::Triangles { .. } => 0,
            GeometryKind::Shapes { count, .. } => count as usize,
        };
        let objects = ids.iter().map(shapes_of).sum::<usize>() + group.instances.len();
        data.objects.reserve_exact(objects);
        let mut triangles = 0_u64;
        for geometry in ids {
            let mut lost = Dropped::none(DroppedFrom::Geometry(geometry));
            match &self.stage.geometries[geometry as usize].kind {
                GeometryKind::Triangles { positions, indices } => {
                    let first = triangles as u32;
                    triangles += indices.len() as u64;
                    if triangles > u64::from(LIMIT) {
                        return Err(BuildError::TooMany { what: "triangles in a group", most: LIMIT });
                    }
                    data.meshes.push(MeshStart { geometry, first });
                    data.all_masks &= self.stage.masks[geometry as usize];
                    if brute.is_none() {
                        prims.reserve(indices.len());
                    }
                    for (i, index) in indices.iter().enumerate() {
                        let v = index.map(|i| positions[i as usize]);
                        if triangle::is_sound(&v) {
                            let (bounds, kind) =
                                (slab::triangle_bounds(&v), PrimKind::Triangle(first + i as u32));
                            match &mut brute {
                                Some(brute) => {
                                    brute.add(kind);
                                    data.bounds = data.bounds.union(bounds);
                                }
                                None => prims.push(Prim { bounds, kind }),
                            }
                        } else {
                            lost.add(v.iter().all(|p| p.is_finite()));
                        }
                    }
                }
                GeometryKind::Shapes { first, count } => {
                    for primitive in 0..*count {
                        let shape = first + primitive;
                        let bounds = shapes.bounds(shape);
                        if let Some(b) = bounds.filter(|b| b.is_empty() || !b.is_finite()) {
                            lost.add(is_without_extent(b));
                            continue;
                        }
                        let kind = ObjectKind::Shape { shape, geometry, primitive };
                        let bounds = bounds.map(slab::padded);
                        data.objects.push(Object { kind, mask: self.stage.masks[geometry as usize], bounds });
                    }
                }
            }
            if lost.count() > 0 {
                dropped.push(lost);
            }
        }
        for (i, instance) in group.instances.iter().enumerate() {
            let inner = &self.stage.groups[instance.group as usize];
            let bounds = if !inner.is_unbounded {
                let b = self.bounds_of(inner, instance);
                if b.is_empty() || !b.is_finite() {
                    if !inner.bounds.is_empty() {
                        let mut lost = Dropped::none(DroppedFrom::Instance { group: instance.group });
                        lost.add(is_without_extent(b));
                        dropped.push(lost);
                    }
                    continue;
                }
                Some(b)
            } else {
                // What is bounded inside still belongs to the bounds of the scene.
                let b = self.bounds_of(inner, instance);
                if b.is_finite() {
                    data.bounds = data.bounds.union(b);
                }
                None
            };
            data.has_large |= inner.is_large;
            let kind = ObjectKind::Instance(first_instance + i as u32);
            data.objects.push(Object { kind, mask: instance.mask, bounds });
        }
        if data.objects.len() > MOST_OBJECTS as usize {
            return Err(BuildError::TooMany { what: "shapes and instances in a group", most: MOST_OBJECTS });
        }
        prims.reserve_exact(data.objects.len());
        let mut members = Vec::new();
        for (i, o) in data.objects.iter().enumerate() {
            let object = i as u32;
            let shape = match (options.structure, o.kind) {
                (Structure::Bvh(_), ObjectKind::Shape { shape, .. }) => shapes.analytic(shape),
                _ => None,
            };
            data.is_unbounded |= o.bounds.is_none();
            if let Some(bounds) = o.bounds {
                data.bounds = data.bounds.union(bounds);
            }
            match (o.bounds, shape) {
                (bounds, Some(shape)) => {
                    let bounds = bounds.unwrap_or(EVERYWHERE);
                    members.push(Member { object, mask: o.mask, bounds, shape });
                }
                (Some(bounds), None) => prims.push(Prim { bounds, kind: PrimKind::Object(object) }),
                (None, None) => data.unbounded.push(object),
            }
        }
        let alone = brute.as_ref().map_or(0, Brute::len);
        data.is_large = data.has_large || alone + prims.len() + members.len() >= LARGE;
        data.bounds = prims.iter().fold(data.bounds, |b, p| b.union(p.bounds));
        let mut is_refitted = false;
        let searcher = match options.structure {
            Structure::Brute => {
                let mut brute = brute.unwrap_or_default();
                prims.iter().for_each(|p| brute.add(p.kind));
                Searcher::Brute(brute)
            }
            Structure::Bvh(params) => {
                let vertices = |id| self.stage.vertices(&data, id);
                let refit = |old: Bvh| old.refitted(&prims, &members, &vertices, |id| data.locate(id));
                let refitted = old.and_then(refit);
                is_refitted = refitted.is_some();
                let build = || Bvh::build(prims, members, &params, vertices, |id| data.locate(id));
                let bvh = refitted.or_else(build);
                Searcher::Bvh(
                    bvh.ok_or(BuildError::TooMany { what: "lines of 64 bytes in a tree", most: LIMIT })?,
                )
            }
            Structure::Bvh2(params) => Searcher::Bvh2(Bvh2::build(&prims, &params)),
            Structure::Grid(params) => Searcher::Grid(Grid::build(&prims, &params)),
            Structure::Kd(params) => {
                Searcher::Kd(KdTree::build(&prims, &params, |id| self.stage.vertices(&data, id)))
            }
            Structure::Octree(params) => Searcher::Octree(Octree::build(&prims, &params)),
            Structure::Bsp(params) => {
                Searcher::Bsp(BspTree::build(&prims, &params, |id| self.stage.vertices(&data, id)))
            }
            Structure::Volumes(params) => {
                let content = Meshes { scene: self, group: &data };
                Searcher::Volumes(Volumes::build(&prims, &params, &content))
            }
        };
        Ok(Grouped { data, searcher, dropped, is_refitted })
    }
}

impl GroupData {
    /// All bounded primitives with their boxes, for `validate`.
    fn prim_bounds(&self, scene: &Scene) -> Vec<Prim> {
        let mut out = Vec::new();
        for m in &self.meshes {
            if let GeometryKind::Triangles { indices, .. } = &scene.stage.geometries[m.geometry as usize].kind
            {
                for id in m.first..m.first + indices.len() as u32 {
                    let v = scene.stage.vertices(self, id);
                    if triangle::is_sound(&v) {
                        out.push(Prim { bounds: slab::triangle_bounds(&v), kind: PrimKind::Triangle(id) });
                    }
                }
            }
        }
        for (i, o) in self.objects.iter().enumerate() {
            if let Some(bounds) = o.bounds {
                out.push(Prim { bounds, kind: PrimKind::Object(i as u32) });
            }
        }
        out
    }
}

/// The triangles of a group.
struct Meshes<'a> {
    scene: &'a Scene,
    group: &'a GroupData,
}

impl Content for Meshes<'_> {
    fn geometry(&self, triangle: u32) -> u32 {
        self.group.locate(triangle).0
    }

    fn vertices(&self, triangle: u32) -> [Vec3; 3] {
        self.scene.stage.vertices(self.group, triangle)
    }
}

/// A search among so many primitives takes longer than setting up a slice of rays for it.
const LARGE: usize = 256;

/// The box of what has none.
const EVERYWHERE: Bounds = Bounds {
    min: Vec3::new(f32::NEG_INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY),
    max: Vec3::new(f32::INFINITY, f32::INFINITY, f32::INFINITY),
};

/// The most objects in a group: three bits of a child of the wide tree are taken.
const MOST_OBJECTS: u32 = LIMIT >> 1;

/// The most primitives of a kind in a group: two bits of a reference are taken.
const LIMIT: u32 = (1 << 30) - 1;

/// The box of an instance in the space it stands in: its corners' images, each padded by the error of the map forward
/// and of the map back that rays take (as large again, seen from the object's side), then as any primitive's.
fn instance_bounds(inner: Bounds, transform: &Transform) -> Bounds {
    if inner.is_empty() {
        return Bounds::EMPTY;
    }
    let mut out = Bounds::EMPTY;
    for corner in inner.corners() {
        let p = transform.point(corner);
        // Carried back and forth once: what rounding of the inverse does to a point on the surface.
        let back = transform.inverse_point(p) - corner;
        let error = transform.point_error(corner, back.abs()) * 2.0;
        out = out.union(Bounds { min: p - error, max: p + error });
    }
    slab::padded(out)
}

/// Whether a box that holds nothing is only that, and has no corner that is no number.
fn is_without_extent(b: Bounds) -> bool {
    b.is_empty() && !b.min.to_array().iter().chain(&b.max.to_array()).any(|v| v.is_nan())
}

/// Checks every index.
fn check(input: &Input) -> Result<(), BuildError> {
    if input.groups.is_empty() {
        return Err(BuildError::NoWorld);
    }
    for (g, group) in input.groups.iter().enumerate() {
        let count = input.geometries.len();
        if let Some(&geometry) = group.geometries.iter().find(|&&x| x as usize >= count) {
            return Err(BuildError::NoSuchGeometry { group: g as u32, geometry, count });
        }
        let count = input.groups.len();
        if let Some(i) = group.instances.iter().find(|i| i.group as usize >= count) {
            return Err(BuildError::NoSuchGroup { group: g as u32, target: i.group, count });
        }
    }
    let instances: usize = input.groups.iter().map(|g| g.instances.len()).sum();
    for (n, what) in
        [(instances, "instances"), (input.groups.len(), "groups"), (input.geometries.len(), "geometries")]
    {
        if n > LIMIT as usize {
            return Err(BuildError::TooMany { what, most: LIMIT });
        }
    }
    for (g, geometry) in input.geometries.iter().enumerate() {
        match &geometry.kind {
            GeometryKind::Triangles { positions, indices } => {
                let count = positions.len();
                let bad = |t: &[u32; 3]| t.iter().copied().find(|&i| i as usize >= count);
                if let Some((t, vertex)) = indices.iter().enumerate().find_map(|(t, x)| Some((t, bad(x)?))) {
                    let (geometry, triangle) = (g as u32, t as u32);
                    return Err(BuildError::NoSuchVertex { geometry, triangle, vertex, count });
                }
            }
            GeometryKind::Shapes { first, count } => {
                if first.checked_add(*count).is_none() || *count > LIMIT {
                    return Err(BuildError::TooMany { what: "shapes", most: LIMIT });
                }
            }
        }
    }
    Ok(())
}

/// The groups that the world reaches, each after those inside it.
fn children_first(groups: &[Group]) -> Result<Vec<usize>, BuildError> {
    #[derive(Clone, Copy, PartialEq)]
    enum Seen {
        No,
        Open,
        /// With the number of levels of instances inside.
        Done(usize),
    }
    let mut seen = vec![Seen::No; groups.len()];
    let mut order = Vec::new();
    // Group and next instance to look at: a stack of our own, since a hostile scene could overflow the program's.
    let mut stack = vec![(0_usize, 0_usize)];
    seen[0] = Seen::Open;
    while let Some((g, next)) = stack.pop() {
        if let Some(instance) = groups[g].instances.get(next) {
            stack.push((g, next + 1));
            let inner = instance.group as usize;
            match seen[inner] {
                Seen::No => {
                    seen[inner] = Seen::Open;
                    stack.push((inner, 0));
                }
                Seen::Open => return Err(BuildError::Cycle { group: inner as u32 }),
                Seen::Done(_) => {}
            }
            continue;
        }
        let level = |i: &Instance| match seen[i.group as usize] {
            Seen::Done(levels) => levels + 1,
            _ => 0,
        };
        let levels = groups[g].instances.iter().map(level).max().unwrap_or(0);
        if levels > MAX_DEPTH {
            return Err(BuildError::TooDeep);
        }
        seen[g] = Seen::Done(levels);
        order.push(g);
    }
    Ok(order)
}
