//! Path tracing with next-event estimation and multiple importance sampling (Kajiya 1986; Veach 1997, chapters 8-10).

use super::hemisphere::Directions;
use super::leaving::{Leaver, Leaving, LookUp};
use super::lighting::{Brought, Illuminate, Lit, Weigh};
use super::numbers::{Numbers, Wanted};
use super::scattering::{Behind, Onward, Roulette, SendOn};
use super::technique::Technique;
use super::vertex::left_on_way;
use super::vertices::{BLOCK, Bits, Few, ROOM, Vertices};
use super::{Arrival, Contribution, Ears, Integrator, Kind, Out, Path, Queue, Start};
use crate::footprint::PackedFootprint;
use crate::lanes::Lanes;
use crate::light::links::{ALL, Class};
use crate::material::Bsdf;
use crate::material::interior::{Boundary, Inside};
use crate::shape::SurfacePoint;
use crate::stopwatch::Phase;
use crate::surface::{Met, Surfaces};
use crate::world::World;
use straal_color::Light;
use straal_math::Ray;
use straal_math::lowdisc::{Purpose, SampleName};
use straal_scene::desc;
use straal_scene::value::Depth;

/// Edges after which roulette is played whatever the settings: a path between perfect mirrors must end.
const PATIENCE: u32 = 1000;

/// Where the names of the numbers begin that draw the second and further directions of a vertex: apart from those of its branches.
const PARTS: u32 = 1 << 16;

/// The path tracer's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathTracer {
    /// Largest number of edges of a path, the camera's included: 1 sees emitters, 2 is direct light.
    pub max_depth: u32,
    /// Paths of this many edges and more may be ended by roulette; of 1000 and more in any case.
    pub roulette_depth: u32,
    /// By which chance they go on.
    pub roulette: Roulette,
    /// How the light that falls on a vertex is found.
    pub technique: Technique,
    /// The most that light counts that came by way of more than one surface; what is beyond is taken away.
    pub clamp: Option<f32>,
    /// How the directions are drawn in which paths go on.
    pub directions: Directions,
}

impl Default for PathTracer {
    fn default() -> Self {
        Self {
            max_depth: u32::MAX,
            roulette_depth: 5,
            roulette: Roulette::Root,
            technique: Technique::Mis,
            clamp: None,
            directions: Directions::Bsdf,
        }
    }
}

impl PathTracer {
    pub(super) const NAME: &'static str = "path";

    /// Of what a scene says.
    pub(super) fn of(said: &desc::Integrator) -> Self {
        let desc::Integrator::Path(path) = said else { return Self::default() };
        let max_depth = match path.max_depth {
            Depth::Unlimited => u32::MAX,
            Depth::Edges(n) => n,
        };
        let roulette = Roulette::of(&path.roulette);
        let technique = Technique::of(&path.technique);
        let clamp = path.clamp.map(|most| most as f32);
        let directions = Directions::of(&path.directions);
        Self { max_depth, roulette_depth: path.roulette_depth, roulette, technique, clamp, directions }
    }
}

/// What a path carries.
#[derive(Clone, Copy, Debug)]
pub struct State<L> {
    /// By what it reads colours.
    lanes: L,
    /// What of a surface its ray stands for; none in a world where nothing asks for it.
    footprint: PackedFootprint,
    /// Share of the light at the ray's end that reaches the film.
    beta: Light,
    /// The previous vertex.
    behind: Behind,
    /// Whether the ray's direction was drawn there from a delta lobe (or is the camera's), which light sampling can't reach.
    delta: bool,
    /// Edges so far, the ray's included.
    depth: u32,
    /// What clear materials it is inside of, in a world where that matters.
    inside: Inside,
    /// By which lamps the previous vertex is lit.
    class: Class,
    /// One over the brightness of the picture about its pixel, where roulette asks for it.
    per_brightness: f32,
}

impl Integrator for PathTracer {
    type State<L: Lanes> = State<L>;
    const LIGHT_GROUPS: bool = true;

    fn facts(&self) -> Vec<(&'static str, String)> {
        let depth = if self.max_depth == u32::MAX { "unlimited".into() } else { self.max_depth.to_string() };
        let mut facts = vec![("max_depth", depth), ("roulette_depth", self.roulette_depth.to_string())];
        if self.technique != Technique::Mis {
            facts.push(("technique", self.technique.name().into()));
        }
        facts.extend(self.clamp.map(|most| ("clamp", most.to_string())));
        if self.roulette != Roulette::Root {
            facts.push(("roulette", format!("{:?}", self.roulette).to_lowercase()));
        }
        if self.directions != Directions::Bsdf {
            facts.push(("directions", self.directions.name().into()));
        }
        facts
    }

    fn limit(&self) -> f32 {
        self.clamp.unwrap_or(f32::INFINITY)
    }

    fn limit_depth(&mut self, edges: u32) {
        self.max_depth = edges;
    }

    fn start<L: Lanes>(&self, start: &Start<'_, L>) -> Option<(Ray, State<L>)> {
        let state = State {
            lanes: start.lanes,
            footprint: start.footprint,
            beta: start.lanes.full(),
            behind: Behind::CAMERA,
            delta: true,
            depth: 1,
            inside: Inside::default(),
            class: ALL,
            per_brightness: self.ears(start.world).map_or(0.0, |ears| ears.per_brightness(start.pixel)),
        };
        start.camera_ray.map(|ray| (ray, state))
    }

    fn step<L: Lanes>(&self, world: &World, queue: &Queue<'_, State<L>>, out: &mut Out<'_, State<L>>) {
        let dimmed = world.materials.interiors().matter().then(|| dimmed(world, queue));
        let queue = &Queue { paths: dimmed.as_deref().unwrap_or(queue.paths), ..*queue };
        let mut scratch = out.scratch.take().unwrap_or_default();
        match queue.kind {
            Kind::Missed => self.miss(world, queue, out),
            Kind::Dark => {
                for paths in queue.order.chunks(BLOCK) {
                    self.meet(world, queue, paths, &mut scratch.surfaces, out);
                }
            }
            Kind::Scattering(_) | Kind::Varying => self.scatter_all(world, queue, &mut scratch, out),
        }
        *out.scratch = Some(scratch);
    }
}

impl PathTracer {
    /// Blocks of vertices: where they lie and what scatters there, then light from lights, then the next ray.
    fn scatter_all<L: Lanes>(
        &self,
        world: &World,
        queue: &Queue<'_, State<L>>,
        scratch: &mut Scratch,
        out: &mut Out<'_, State<L>>,
    ) {
        let Some(&first) = queue.order.first() else { return };
        let first = &queue.paths[first as usize];
        let (mut names, mut lanes) = ([first.name; BLOCK], [first.state.lanes; ROOM]);
        let mut vertices = Vertices::new();
        for paths in queue.order.chunks(BLOCK) {
            out.stopwatch.begin_block();
            // Ahead of the rest: paths lie far apart, and the memory has all of them to fetch at once.
            vertices.begin(paths.len());
            for (i, &path) in paths.iter().enumerate() {
                let path = &queue.paths[path as usize];
                (names[i], lanes[i]) = (path.name, path.state.lanes);
                vertices.bring(i, path.state.beta, path.state.behind.eta_squared(), path.state.depth);
            }
            self.meet(world, queue, paths, &mut scratch.surfaces, out);
            self.arrive(world, queue, (paths, &lanes, &mut *scratch), &mut vertices, out);
            let names = &names[..paths.len()];
            let block = Block { paths, names, lanes: &lanes, vertices: &vertices };
            draw_numbers(queue, block, &mut scratch.numbers);
            out.stopwatch.part(Phase::Shading);
            self.light(world, queue, block, scratch, out);
            out.stopwatch.part(Phase::Lights);
            self.scatter(world, queue, block, scratch, out);
            out.stopwatch.part(Phase::Shading);
        }
        out.stopwatch.lap_of_blocks();
    }

    /// Paths of so many edges don't go on: one edge more would be too many, or would be the last, of use only where there is light to
    /// be met.
    #[inline]
    fn ends(&self, world: &World) -> u32 {
        match self.max_depth {
            u32::MAX => u32::MAX,
            most if world.shows_lights() => most,
            most => most.saturating_sub(1),
        }
    }

    /// Whether a path of so many edges may be ended by chance.
    #[inline(always)]
    fn plays_roulette(&self, depth: u32) -> bool {
        let is_usual = !matches!(self.roulette, Roulette::Off | Roulette::Ears);
        depth >= self.roulette_depth && is_usual || depth >= PATIENCE
    }

    /// What is known of what ways on bring and cost, where paths go by it.
    #[inline(always)]
    fn ears<'w>(&self, world: &'w World) -> Option<&'w Ears> {
        world.ears.as_ref().filter(|_| self.roulette == Roulette::Ears)
    }

    /// The vertices of a block: the surfaces from which paths may go on, and how they scatter.
    #[inline]
    fn arrive<'w, L: Lanes>(
        &self,
        world: &'w World,
        queue: &Queue<'_, State<L>>,
        (paths, lanes, scratch): (&[u32], &[L; ROOM], &mut Scratch),
        vertices: &mut Vertices<'w>,
        out: &mut Out<'_, State<L>>,
    ) {
        if world.links.matter() {
            for (class, &path) in scratch.classes.iter_mut().zip(paths) {
                *class = world.links.class_of(&queue.hits[path as usize]);
            }
        }
        let special = world.materials.interiors().matter() || world.has_ambient_light();
        let (materials, lanes) = (&scratch.surfaces.material[..paths.len()], &lanes[..paths.len()]);
        let is_alike = materials.iter().all(|m| *m == materials[0]) && lanes.iter().all(|l| *l == lanes[0]);
        if is_alike
            && vertices.deepest() < self.max_depth
            && !special
            && !world.materials.choose()
            && !scratch.surfaces.any_at()
        {
            // Read once, since it doesn't differ from vertex to vertex.
            let bsdf = world.bsdf_at(materials[0], None, lanes[0]);
            let is_black = matches!(bsdf, Bsdf::Black(_));
            vertices.read(bsdf);
            if !is_black {
                vertices.set_all();
            }
        } else {
            self.arrive_one_by_one(world, queue, (paths, lanes, special, scratch), vertices, out);
        }
        vertices.send_on(self.ends(world), |depth| self.plays_roulette(depth));
    }

    /// The same where vertices differ in how they scatter, or something else must be known of them.
    fn arrive_one_by_one<'w, L: Lanes>(
        &self,
        world: &'w World,
        queue: &Queue<'_, State<L>>,
        (paths, lanes, special, scratch): (&[u32], &[L], bool, &mut Scratch),
        vertices: &mut Vertices<'w>,
        out: &mut Out<'_, State<L>>,
    ) {
        let Scratch { surfaces, interior, .. } = scratch;
        let mut last = None;
        for (i, (&path, &lanes)) in paths.iter().zip(lanes).enumerate() {
            if vertices.depth(i) >= self.max_depth {
                continue;
            }
            if world.draws_texels {
                surfaces.draw_lots(i, || queue.pattern.d2(&queue.paths[path as usize].name, Purpose::Texel));
            }
            let (mut material, at) = (surfaces.material[i], surfaces.at(i));
            let in_front = surfaces.wo.at(i).z > 0.0;
            if world.materials.choose() {
                let u = queue.pattern.d1(&queue.paths[path as usize].name, Purpose::Material);
                material = world.chosen(material, (at, in_front), lanes, u);
            }
            // Read once where it doesn't differ from vertex to vertex.
            if at.is_some() || special || last != Some((material, lanes)) {
                vertices.read(world.bsdf_at(material, at, lanes));
                last = Some((material, lanes));
            }
            let Some(bsdf) = vertices.bsdf().filter(|bsdf| !matches!(bsdf, Bsdf::Black(_))) else { continue };
            if special {
                interior[i] = world.materials.interiors().number(material);
                let arrival = queue.arrival(path);
                let Some(bsdf) = scatters_specially(world, &arrival, bsdf, (interior[i], in_front), out)
                else {
                    continue;
                };
                vertices.replace(bsdf);
            }
            vertices.set(i);
        }
    }
}

/// All paths of the turn, those of the queue with what the media that their rays went through have left of their light.
#[cold]
fn dimmed<L: Lanes>(world: &World, queue: &Queue<'_, State<L>>) -> Vec<Path<State<L>>> {
    let (mut paths, interiors) = (queue.paths.to_vec(), world.materials.interiors());
    for &path in queue.order {
        let Arrival { ray, hit, .. } = queue.arrival(path);
        let state = &mut paths[path as usize].state;
        if hit.is_hit() && world.is_met_from_inside(ray, hit) {
            // It may have started inside.
            state.inside = state.inside.or(interiors.number(world.material_of(hit)));
        }
        let start = if ray.t_min > 0.0 { ray.t_min } else { 0.0 };
        state.beta *= interiors.left_after(state.inside, hit.t - start, &world.reading(state.lanes));
    }
    paths
}

/// What is left of the light along a shadow ray from surface `i`, which is filled with `interior`: whatever is free for it to arrive lies
/// within one medium, on the side that it comes from.
#[cold]
fn left_of_light<L: Lanes>(
    world: &World,
    state: &State<L>,
    (i, surfaces, interior): (usize, &Surfaces, u16),
    ray: &Ray,
) -> Light {
    let wo = surfaces.wo.at(i).z;
    let crosses = surfaces.frame[2].at(i).dot(ray.d) * wo < 0.0;
    let inside = if crosses { state.inside.crossed(interior, wo > 0.0) } else { state.inside };
    left_on_way(world, ray, inside, state.lanes)
}

/// Adds ambient light; gives what scatters at the boundary of a clear material, which depends on what is on the other side. Nothing where
/// something of a higher priority is on both: the ray goes on.
#[cold]
fn scatters_specially<'w, L: Lanes>(
    world: &World,
    arrival: &Arrival<'_, State<L>>,
    bsdf: &Bsdf<'w>,
    (interior, entering): (u16, bool),
    out: &mut Out<'_, State<L>>,
) -> Option<Bsdf<'w>> {
    let &State { lanes, beta, inside, .. } = &arrival.path.state;
    let mut bsdf = *bsdf;
    if world.materials.interiors().matter() {
        match world.materials.interiors().boundary(inside, interior, entering) {
            Boundary::Real(Some(eta)) => bsdf = bsdf.with_eta(eta),
            Boundary::Real(None) => {}
            Boundary::Ignored(inside) => {
                // The least number beyond the hit: what lies at the very same place is behind it as well.
                let beyond = Ray { t_min: arrival.hit.t.next_up(), ..*arrival.ray };
                out.go_on_as(arrival.path, 0, beyond).inside = inside;
                return None;
            }
        }
    }
    if world.has_ambient_light() {
        for (light, group) in world.ambient_from(arrival.hit, &bsdf, lanes) {
            out.add(
                Contribution::own(arrival.path, beta * light)
                    .of(group)
                    .indirect(arrival.path.state.depth > 1),
            );
        }
    }
    Some(bsdf)
}

impl PathTracer {
    /// Where the rays of a block arrived; adds the light that is emitted there.
    fn meet<L: Lanes>(
        &self,
        world: &World,
        queue: &Queue<'_, State<L>>,
        paths: &[u32],
        surfaces: &mut Surfaces,
        out: &mut Out<'_, State<L>>,
    ) {
        let corner = |path: u32| queue.pattern.d1(&queue.paths[path as usize].name, Purpose::Corner);
        let met = Met { order: paths, rays: queue.rays, hits: queue.hits, corner: &corner };
        surfaces.meet(world, queue.simd, &met, |path| queue.paths[path as usize].state.footprint);
        for i in Bits::of(surfaces.glowing).each() {
            if let Some(emitter) = surfaces.emitter[i] {
                self.meet_light(world, &queue.arrival(paths[i]), (emitter, &surfaces.point(i)), out);
            }
        }
    }

    /// Light from the surroundings, for rays that leave the scene.
    fn miss<L: Lanes>(&self, world: &World, queue: &Queue<'_, State<L>>, out: &mut Out<'_, State<L>>) {
        let Some(&first) = queue.order.first().filter(|_| world.has_environment()) else { return };
        if world.links.matter() || world.links.shadows_matter() || !world.unseen.is_empty() {
            return self.miss_one_by_one(world, queue, out);
        }
        let mut leaving = Leaving::new(queue.paths[first as usize].state.lanes);
        for paths in queue.order.chunks(BLOCK) {
            leaving.clear();
            for &path in paths {
                let Arrival { path, ray, .. } = queue.arrival(path);
                let State { lanes, beta, behind, delta, depth, .. } = path.state;
                let (indirect, sample) = (depth > 2, path.sample);
                leaving.push(&Leaver { ray, beta, behind, delta, indirect, lanes, sample });
            }
            for (emitter, _) in world.environments() {
                let (leaving, technique, sums) = (&leaving, self.technique, &mut *out.sums);
                queue.simd.run(LookUp { world, leaving, emitter, technique, sums });
            }
        }
    }

    /// The same where not all that surrounds the scene lights each surface, or is seen.
    #[cold]
    fn miss_one_by_one<L: Lanes>(
        &self,
        world: &World,
        queue: &Queue<'_, State<L>>,
        out: &mut Out<'_, State<L>>,
    ) {
        for Arrival { path, ray, .. } in queue.arrivals() {
            let State { lanes, beta, behind, delta, class, .. } = path.state;
            let from = &behind.from();
            let shows = |index: u32| {
                world.links.light(class, index) && (path.state.depth > 1 || world.is_seen(index))
            };
            for (index, emitter) in world.environments().filter(|(index, _)| shows(*index)) {
                let (radiance, by_light) = emitter.radiance_pdf_from(from, ray.d, &world.reading(lanes));
                let by_light = || world.lights_of(class).pmf(index, from) * by_light;
                let weight = self.weight(delta, (behind.pdf(), by_light));
                let light = beta * radiance * weight;
                let contribution = Contribution::own(path, light).of(world.light_groups.of(index));
                out.add(contribution.indirect(path.state.depth > 2));
            }
        }
    }

    /// The weight of light that a ray met, beside what light sampling finds: by the densities of both.
    #[inline(always)]
    pub(super) fn weight(&self, delta: bool, (bsdf, by_light): (f32, impl FnOnce() -> f32)) -> f32 {
        if delta { 1.0 } else { self.technique.of_bsdf(bsdf, by_light()) }
    }

    /// Light that a glowing surface emits.
    #[inline]
    fn meet_light<L: Lanes>(
        &self,
        world: &World,
        arrival: &Arrival<'_, State<L>>,
        (emitter, point): (u32, &SurfacePoint),
        out: &mut Out<'_, State<L>>,
    ) {
        let state = &arrival.path.state;
        if !world.links.light(state.class, emitter) {
            return;
        }
        let radiance = world.emitted(emitter, (arrival.ray, arrival.hit), point, state.lanes);
        if radiance.is_black() {
            return;
        }
        let by_light = || world.light_pdf(emitter, (state.class, &state.behind.from()), arrival.hit, point);
        let pdfs = (state.behind.pdf(), by_light);
        let weight = self.weight(state.delta, pdfs);
        let light = state.beta * radiance * weight;
        let contribution = Contribution::own(arrival.path, light).of(world.light_groups.of(emitter));
        out.add(contribution.indirect(state.depth > 2));
    }
}

/// Paths whose vertices are worked on together.
#[derive(Clone, Copy)]
struct Block<'a, 'w, L> {
    /// Their numbers in the driver's turn.
    paths: &'a [u32],
    /// Name their random numbers.
    names: &'a [SampleName],
    /// By what they read colours.
    lanes: &'a [L; ROOM],
    vertices: &'a Vertices<'w>,
}

/// What the paragraphs of a step leave for one another.
#[derive(Default)]
pub(crate) struct Scratch {
    surfaces: Surfaces,
    /// What each surface is filled with, by its number, in a world where that matters.
    interior: [u16; BLOCK],
    /// By which lamps each is lit, in a world where not by all.
    classes: [Class; BLOCK],
    numbers: Numbers,
    lit: Lit,
    brought: Brought,
    onward: Onward,
}

/// The random numbers of a block, those that any of its vertices needs.
fn draw_numbers<L: Lanes>(queue: &Queue<'_, State<L>>, block: Block<'_, '_, L>, numbers: &mut Numbers) {
    let wanted = Wanted {
        light: block.vertices.asks_lights.any(),
        direction: block.vertices.goes_on.any(),
        lobe: block.vertices.chooses_lobe,
        roulette: block.vertices.plays_roulette.any(),
    };
    numbers.draw(queue.simd, queue.pattern, block.names, wanted);
}

impl PathTracer {
    /// Next-event estimation: asks for a shadow ray from each vertex to a point on a light.
    fn light<L: Lanes>(
        &self,
        world: &World,
        queue: &Queue<'_, State<L>>,
        block: Block<'_, '_, L>,
        Scratch { surfaces, interior, classes, numbers, lit, brought, .. }: &mut Scratch,
        out: &mut Out<'_, State<L>>,
    ) {
        let Block { vertices, lanes, .. } = block;
        let simd = queue.simd;
        if !vertices.asks_lights.any() {
            return;
        }
        let classes = world.links.matter().then_some(&*classes);
        simd.run(Illuminate { world, surfaces, vertices, lanes, classes, numbers, out: lit });
        let (technique, directions) = (self.technique, self.directions);
        vertices.by_kind(simd, Weigh { simd, surfaces, vertices, lit, technique, directions, out: brought });
        // List by list, without a look at what room each has: nearly every vertex asks for a ray.
        let asking = Few::of(brought.bright);
        let asking = asking.list();
        if !world.materials.interiors().matter() {
            out.shadow_rays.extend(asking.iter().map(|&i| {
                let i = usize::from(i);
                brought.ray(i, &queue.rays[block.paths[i] as usize])
            }));
            out.shadows.extend(asking.iter().map(|&i| {
                let i = usize::from(i);
                Contribution::own(&queue.paths[block.paths[i] as usize], brought.light(i))
            }));
            if world.links.shadows_matter() {
                let first = out.shadow_rays.len() - asking.len();
                for (ray, &i) in out.shadow_rays[first..].iter_mut().zip(asking) {
                    ray.mask = world.links.mask(lit.emitter(i.into()));
                }
                let first = out.shadows.len() - asking.len();
                for (shadow, &i) in out.shadows[first..].iter_mut().zip(asking) {
                    shadow.target = brought.target(i.into());
                }
            }
            if world.light_groups.matter() {
                let first = out.shadows.len() - asking.len();
                for (shadow, &i) in out.shadows[first..].iter_mut().zip(asking) {
                    shadow.from.group = world.light_groups.of(lit.emitter(i.into()));
                }
            }
            if self.clamp.is_some() {
                let first = out.shadows.len() - asking.len();
                for (shadow, &i) in out.shadows[first..].iter_mut().zip(asking) {
                    let path = &queue.paths[block.paths[usize::from(i)] as usize];
                    shadow.from.is_indirect = path.state.depth > 1;
                }
            }
            return;
        }
        for i in asking.iter().copied().map(usize::from) {
            let path = block.paths[i] as usize;
            let mask = world.links.mask(lit.emitter(i));
            let ray = Ray { mask, ..brought.ray(i, &queue.rays[path]) };
            let left = left_of_light(world, &queue.paths[path].state, (i, surfaces, interior[i]), &ray);
            let group = world.light_groups.of(lit.emitter(i));
            let path = &queue.paths[path];
            let contribution = Contribution::own(path, brought.light(i) * left).of(group);
            let contribution = contribution.indirect(path.state.depth > 1);
            out.shadow(ray, Contribution { target: brought.target(i), ..contribution });
        }
    }

    /// Draws the next directions, or ends paths.
    fn scatter<L: Lanes>(
        &self,
        world: &World,
        queue: &Queue<'_, State<L>>,
        block: Block<'_, '_, L>,
        scratch: &mut Scratch,
        out: &mut Out<'_, State<L>>,
    ) {
        let vertices = block.vertices;
        if !vertices.goes_on.any() {
            return;
        }
        if let Some(ears) = self.ears(world) {
            return self.scatter_by_worth(world, ears, queue, block, scratch, out);
        }
        self.send_on((queue, block), vertices.goes_on, scratch);
        self.go_on(world, (queue, block), (0, None), scratch, out);
    }

    /// The same where paths end, or split, by what they bring for what they cost.
    #[cold]
    fn scatter_by_worth<L: Lanes>(
        &self,
        world: &World,
        ears: &Ears,
        queue: &Queue<'_, State<L>>,
        block: Block<'_, '_, L>,
        scratch: &mut Scratch,
        out: &mut Out<'_, State<L>>,
    ) {
        let Block { paths, names, vertices, .. } = block;
        let (mut counts, mut scales, mut most) = ([0_u32; BLOCK], [1.0_f32; BLOCK], 0);
        for i in vertices.goes_on.each() {
            let State { beta, behind, per_brightness, .. } = queue.paths[paths[i] as usize].state;
            let carried = beta.max_lane() * behind.eta_squared() * per_brightness;
            let rays = ears.rays_from(scratch.surfaces.p.at(i), carried);
            // Whole numbers whose mean it is.
            let u = queue.pattern.d1(&names[i], Purpose::Roulette);
            counts[i] = (rays + u) as u32;
            scales[i] = 1.0 / rays;
            most = counts[i].max(most);
        }
        for branch in 0..most {
            let mut some = Bits::default();
            for i in vertices.goes_on.each() {
                some.set(i, counts[i] > branch);
            }
            if branch > 0 {
                // The first has its vertex's own numbers.
                let mut others = [names[0]; BLOCK];
                for (other, name) in others.iter_mut().zip(names) {
                    *other = name.child(PARTS + branch);
                }
                draw_numbers(queue, Block { names: &others[..names.len()], ..block }, &mut scratch.numbers);
            }
            self.send_on((queue, block), some, scratch);
            self.go_on(world, (queue, block), (branch, Some(&scales)), scratch, out);
        }
    }

    /// Draws directions for some vertices of a block.
    fn send_on<L: Lanes>(
        &self,
        (queue, block): (&Queue<'_, State<L>>, Block<'_, '_, L>),
        goes_on: Bits,
        Scratch { surfaces, numbers, onward, .. }: &mut Scratch,
    ) {
        let (vertices, simd) = (block.vertices, queue.simd);
        let (directions, roulette) = (self.directions, self.roulette);
        let send = SendOn { simd, surfaces, vertices, numbers, goes_on, directions, roulette, out: onward };
        vertices.by_kind(simd, send);
    }

    /// Emits the rays that were drawn, as a branch of their paths, of which each counts so much.
    #[inline]
    fn go_on<L: Lanes>(
        &self,
        world: &World,
        (queue, block): (&Queue<'_, State<L>>, Block<'_, '_, L>),
        (branch, scales): (u32, Option<&[f32; BLOCK]>),
        Scratch { surfaces, interior, classes, numbers, onward, .. }: &mut Scratch,
        out: &mut Out<'_, State<L>>,
    ) {
        let alive = Few::of(onward.alive);
        let alive = alive.list();
        out.rays.extend(alive.iter().map(|&i| {
            let i = usize::from(i);
            onward.ray(i, &queue.rays[block.paths[i] as usize])
        }));
        out.next.extend(alive.iter().map(|&i| {
            let i = usize::from(i);
            let path = &queue.paths[block.paths[i] as usize];
            let name = if branch == 0 { numbers.next(i, &block.names[i]) } else { path.name.child(branch) };
            let beta = onward.beta(i);
            Path {
                name,
                sample: path.sample,
                state: State {
                    beta: scales.map_or(beta, |scales| beta * scales[i]),
                    behind: onward.behind(i),
                    delta: onward.delta(i),
                    depth: path.state.depth + 1,
                    ..path.state
                },
            }
        }));
        let (interiors, links) = (world.materials.interiors(), &world.links);
        if onward.parts_wavelengths() || world.wants_footprints() || interiors.matter() || links.matter() {
            let first = out.next.len() - alive.len();
            for (path, &i) in out.next[first..].iter_mut().zip(alive) {
                let (i, state) = (usize::from(i), &mut path.state);
                if onward.wavelength(i) > 0.0 {
                    // A direction of a single wavelength: the others end here, and their lanes are 0.
                    state.lanes = state.lanes.only(onward.wavelength(i));
                }
                if world.wants_footprints() {
                    let index = block.paths[i] as usize;
                    let arrived = (&queue.rays[index], &queue.hits[index]);
                    state.footprint = world.footprint_beyond(&state.footprint, arrived, &onward.sample(i));
                }
                if interiors.matter() && onward.sample(i).transmitted {
                    state.inside = state.inside.crossed(interior[i], surfaces.wo.at(i).z > 0.0);
                }
                state.class = if links.matter() { classes[i] } else { ALL };
            }
        }
    }
}
