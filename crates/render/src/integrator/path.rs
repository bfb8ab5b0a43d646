//! Path tracing with next-event estimation and multiple importance sampling (Kajiya 1986; Veach 1997, chapters 8-10).

use super::numbers::{BLOCK, Numbers, Wanted};
use super::side_by_side::{Onward, Scatter, Vertex, all_diffuse, fill_lanes};
use super::{Arrival, Contribution, Integrator, Kind, Out, Path, Queue, Start};
use crate::footprint::PackedFootprint;
use crate::lanes::Lanes;
use crate::light::Receiver;
use crate::material::interior::{Boundary, Inside};
use crate::material::{Bsdf, BsdfSample, Shaded, Transport};
use crate::shape::offset::End;
use crate::stopwatch::Phase;
use crate::surface::Surface;
use crate::world::World;
use straal_color::Light;
use straal_math::lowdisc::{Purpose, SampleName};
use straal_math::{Ray, Vec3};
use straal_scene::desc;
use straal_scene::value::Depth;

/// Edges after which roulette is played whatever the settings: a path between perfect mirrors must end.
const PATIENCE: u32 = 1000;

/// The path tracer's settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathTracer {
    /// Largest number of edges of a path, the camera's included: 1 sees emitters, 2 is direct light.
    pub max_depth: u32,
    /// Paths of this many edges and more may be ended by roulette; of 1000 and more in any case.
    pub roulette_depth: u32,
}

impl Default for PathTracer {
    fn default() -> Self {
        Self { max_depth: u32::MAX, roulette_depth: 5 }
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
        Self { max_depth, roulette_depth: path.roulette_depth }
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
    /// The previous vertex, as light sampling saw it.
    from: Receiver,
    /// Density by which the ray's direction was drawn there, in solid angle; unused after a delta lobe.
    pdf: f32,
    /// Whether that was a delta lobe (or the camera), which light sampling can't reach.
    delta: bool,
    /// Edges so far, the ray's included.
    depth: u32,
    /// Product of squared relative indices passed: roulette looks at the light's energy, not its radiance.
    eta_squared: f32,
    /// What clear materials it is inside of, in a world where that matters.
    inside: Inside,
}

impl Integrator for PathTracer {
    type State<L: Lanes> = State<L>;

    fn facts(&self) -> Vec<(&'static str, String)> {
        let depth = if self.max_depth == u32::MAX { "unlimited".into() } else { self.max_depth.to_string() };
        vec![("max_depth", depth), ("roulette_depth", self.roulette_depth.to_string())]
    }

    fn limit_depth(&mut self, edges: u32) {
        self.max_depth = edges;
    }

    fn start<L: Lanes>(&self, start: &Start<'_, L>) -> Option<(Ray, State<L>)> {
        let state = State {
            lanes: start.lanes,
            footprint: start.footprint,
            beta: start.lanes.full(),
            from: Receiver { p: Vec3::ZERO, n: Vec3::ZERO },
            pdf: 0.0,
            delta: true,
            depth: 1,
            eta_squared: 1.0,
            inside: Inside::default(),
        };
        start.camera_ray.map(|ray| (ray, state))
    }

    fn step<L: Lanes>(&self, world: &World, queue: &Queue<'_, State<L>>, out: &mut Out<'_, State<L>>) {
        match queue.kind {
            Kind::Missed => queue.arrivals().for_each(|arrival| {
                let dimmed = dimmed(world, &arrival);
                miss(world, &Arrival { path: dimmed.as_ref().unwrap_or(arrival.path), ..arrival }, out);
            }),
            Kind::Dark => queue.arrivals().for_each(|arrival| {
                let dimmed = dimmed(world, &arrival);
                let arrival = Arrival { path: dimmed.as_ref().unwrap_or(arrival.path), ..arrival };
                let surface = world.surface(arrival.ray, arrival.hit, &arrival.path.state.footprint);
                meet_light(world, &arrival, &surface, out);
            }),
            Kind::Scattering(_) | Kind::Varying => self.scatter_all(world, queue, out),
        }
    }
}

impl PathTracer {
    /// Blocks of vertices: where they lie and what scatters there, then light from lights, then the next ray.
    fn scatter_all<L: Lanes>(&self, world: &World, queue: &Queue<'_, State<L>>, out: &mut Out<'_, State<L>>) {
        let mut vertices = Vec::with_capacity(BLOCK);
        let mut scratch = Scratch::default();
        for paths in queue.order.chunks(BLOCK) {
            vertices.clear();
            vertices.extend(paths.iter().filter_map(|&path| self.arrive(world, queue, path, out)));
            draw_numbers(queue, &vertices, &mut scratch.numbers);
            let (count, diffuse) = (vertices.len(), all_diffuse(&vertices));
            fill_lanes(&mut vertices, queue.simd.width());
            let block = Block { vertices: &vertices, count, diffuse };
            out.stopwatch.lap(Phase::Shading);
            for (i, vertex) in block.all().enumerate() {
                light(world, queue, vertex, scratch.numbers.light(i), out);
            }
            out.stopwatch.lap(Phase::Lights);
            scatter(world, queue, block, &mut scratch, out);
            out.stopwatch.lap(Phase::Shading);
        }
    }

    /// Whether a path of so many edges may be ended by chance.
    #[inline(always)]
    fn plays_roulette(&self, depth: u32) -> bool {
        depth >= self.roulette_depth || depth >= PATIENCE
    }

    /// Adds the light emitted where the ray arrives; gives the vertex if the path may go on from there.
    #[inline]
    fn arrive<'w, L: Lanes>(
        &self,
        world: &'w World,
        queue: &Queue<'_, State<L>>,
        path: u32,
        out: &mut Out<'_, State<L>>,
    ) -> Option<Vertex<'w>> {
        let arrival = queue.arrival(path);
        let dimmed = dimmed(world, &arrival);
        let arrival = Arrival { path: dimmed.as_ref().unwrap_or(arrival.path), ..arrival };
        let state = &arrival.path.state;
        let mut surface = world.surface(arrival.ray, arrival.hit, &state.footprint);
        meet_light(world, &arrival, &surface, out);
        if state.depth >= self.max_depth {
            return None;
        }
        let mut bsdf = if world.materials.choose() {
            let u = queue.pattern.d1(&arrival.path.name, Purpose::Material);
            world.chosen_bsdf(&mut surface, state.lanes, u)
        } else {
            world.bsdf(&surface, state.lanes)
        };
        if matches!(bsdf, Bsdf::Black(_)) {
            return None;
        }
        if world.materials.interiors().matter() {
            bsdf = at_boundary(world, &arrival, &surface, bsdf, out)?;
        }
        if world.has_ambient_light() {
            let ambient = world.ambient_from(&bsdf, state.lanes);
            out.add(Contribution::own(arrival.path, state.beta * ambient));
        }
        let wo = surface.frame.to_local(-arrival.ray.d);
        let shaded = Shaded { bsdf, ng: surface.ng };
        Some(Vertex {
            path,
            beta: state.beta,
            eta_squared: state.eta_squared,
            inside: state.inside,
            interior: world.materials.interiors().number(surface.material),
            roulette: self.plays_roulette(state.depth),
            end: End::from(&surface.point),
            frame: surface.frame,
            shaded,
            wo,
        })
    }
}

/// The path with what the medium that its ray went through has left of its light, in a world where there are such.
#[inline(always)]
fn dimmed<L: Lanes>(world: &World, arrival: &Arrival<'_, State<L>>) -> Option<Path<State<L>>> {
    world.materials.interiors().matter().then(|| dimmed_by_medium(world, arrival))
}

#[cold]
fn dimmed_by_medium<L: Lanes>(world: &World, arrival: &Arrival<'_, State<L>>) -> Path<State<L>> {
    let (ray, hit, interiors) = (arrival.ray, arrival.hit, world.materials.interiors());
    let mut path = *arrival.path;
    let mut inside = path.state.inside;
    if let Some(material) = world.material_hit(hit)
        && world.is_met_from_inside(ray, hit)
    {
        inside = inside.or(interiors.number(material));
    }
    let start = if ray.t_min > 0.0 { ray.t_min } else { 0.0 };
    path.state.inside = inside;
    path.state.beta *= interiors.left_after(inside, hit.t - start, &world.reading(path.state.lanes));
    path
}

/// What scatters at the boundary of a clear material, which depends on what is on the other side. Nothing where something of a higher priority is
/// on both: the ray goes on.
#[cold]
fn at_boundary<'w, L: Lanes>(
    world: &World,
    arrival: &Arrival<'_, State<L>>,
    surface: &Surface,
    bsdf: Bsdf<'w>,
    out: &mut Out<'_, State<L>>,
) -> Option<Bsdf<'w>> {
    let interiors = world.materials.interiors();
    let number = interiors.number(surface.material);
    if number == 0 {
        return Some(bsdf);
    }
    let (path, ray) = (arrival.path, arrival.ray);
    let entering = ray.d.dot(surface.frame.n) < 0.0;
    match interiors.boundary(path.state.inside, number, entering) {
        Boundary::Real(eta) => Some(eta.map_or(bsdf, |eta| bsdf.with_eta(eta))),
        Boundary::Ignored(inside) => {
            // The least number beyond the hit: what lies at the very same place is behind it as well.
            let beyond = Ray { t_min: arrival.hit.t.next_up(), ..*ray };
            out.go_on(path, 0, beyond, State { inside, ..path.state });
            None
        }
    }
}

/// Inside of what a path is that leaves a vertex, on the other side if it is transmitted.
fn inside_beyond(vertex: &Vertex<'_>, transmitted: bool) -> Inside {
    if transmitted { vertex.inside.crossed(vertex.interior, vertex.wo.z > 0.0) } else { vertex.inside }
}

/// Light from the surroundings, for a ray that leaves the scene.
#[inline]
fn miss<L: Lanes>(world: &World, arrival: &Arrival<'_, State<L>>, out: &mut Out<'_, State<L>>) {
    let (state, d) = (&arrival.path.state, arrival.ray.d);
    let reading = world.reading(state.lanes);
    for (emitter, environment) in world.environments() {
        let (radiance, weight) = if state.delta {
            (environment.radiance_from(d, &reading), 1.0)
        } else {
            let (radiance, pdf) = environment.radiance_pdf_from(state.from.n, d, &reading);
            (radiance, power_heuristic(state.pdf, world.lights.pmf(emitter, &state.from) * pdf))
        };
        out.add(Contribution::own(arrival.path, state.beta * radiance * weight));
    }
}

/// Light that a surface emits, if it glows.
#[inline]
fn meet_light<L: Lanes>(
    world: &World,
    arrival: &Arrival<'_, State<L>>,
    surface: &Surface,
    out: &mut Out<'_, State<L>>,
) {
    let Some(emitter) = surface.emitter else { return };
    let (state, d) = (&arrival.path.state, arrival.ray.d);
    let radiance =
        world.emitters[emitter as usize].radiance_at(&surface.point, -d, &world.reading(state.lanes));
    if radiance.is_black() {
        return;
    }
    let weight = if state.delta {
        1.0
    } else {
        power_heuristic(state.pdf, world.light_pdf(emitter, &state.from, arrival.hit, surface))
    };
    out.add(Contribution::own(arrival.path, state.beta * radiance * weight));
}

/// Vertices that are worked on together.
#[derive(Clone, Copy)]
struct Block<'a, 'w> {
    /// As many as fill whole vectors, the last of them repeated.
    vertices: &'a [Vertex<'w>],
    /// How many there are.
    count: usize,
    /// Whether all BSDFs are diffuse.
    diffuse: bool,
}

impl<'a, 'w> Block<'a, 'w> {
    /// Each vertex once.
    fn all(&self) -> impl Iterator<Item = &'a Vertex<'w>> + use<'a, 'w> {
        self.vertices[..self.count].iter()
    }
}

/// What the paragraphs of a step leave for one another.
#[derive(Default)]
struct Scratch {
    numbers: Numbers,
    drawn: Vec<Option<BsdfSample>>,
    onward: Onward,
}

/// The random numbers of a block, those that any of its vertices needs.
fn draw_numbers<L: Lanes>(queue: &Queue<'_, State<L>>, vertices: &[Vertex<'_>], numbers: &mut Numbers) {
    let mut names = [SampleName::new(0, [0; 2], 0); BLOCK];
    let mut wanted = Wanted::default();
    for (name, vertex) in names.iter_mut().zip(vertices) {
        *name = queue.paths[vertex.path as usize].name;
        wanted.light |= !vertex.shaded.bsdf.is_delta();
        wanted.lobe |= vertex.shaded.bsdf.chooses_lobe();
        wanted.roulette |= vertex.roulette;
    }
    numbers.draw(queue.simd, queue.pattern, &names[..vertices.len()], wanted);
}

/// Next-event estimation: asks for a shadow ray to a point on a light.
#[inline]
fn light<L: Lanes>(
    world: &World,
    queue: &Queue<'_, State<L>>,
    vertex: &Vertex<'_>,
    [u, v]: [f32; 2],
    out: &mut Out<'_, State<L>>,
) {
    if vertex.shaded.bsdf.is_delta() {
        return;
    }
    let path = &queue.paths[vertex.path as usize];

    // A light, and a point on it by what is left of the number that chose: pairs of numbers are spread better than what is drawn
    // beside them.
    let at = vertex.receiver();
    let Some(pick) = world.lights.pick(u, &at) else { return };
    let Some(light) = world.sample_light(pick.index, &at, [pick.rest, v], path.state.lanes) else {
        return;
    };

    // What it would bring, weighed against the chance that the BSDF finds it.
    let wi = vertex.frame.to_local(light.wi);
    let (value, pdf) = vertex.shaded.eval_pdf(vertex.wo, wi, Transport::Radiance);
    if value.is_black() {
        return;
    }
    let light_pdf = pick.pmf * light.pdf;
    let weight = if light.delta { 1.0 } else { power_heuristic(light_pdf, pdf) };
    let mut contribution = vertex.beta * value * light.radiance * (weight / light_pdf);
    if contribution.is_black() {
        return;
    }
    let ray = &queue.rays[vertex.path as usize];
    let towards = Ray { time: ray.time, mask: ray.mask, ..light.shadow_ray(&vertex.end) };
    if world.materials.interiors().matter() {
        // What is free for the light to arrive lies within one medium.
        let transmitted = wi.z * vertex.wo.z < 0.0;
        let inside = inside_beyond(vertex, transmitted);
        let reading = world.reading(path.state.lanes);
        contribution *= world.materials.interiors().left_after(inside, towards.t_max, &reading);
    }
    out.shadow(towards, Contribution::own(path, contribution));
}

/// Draws the next directions, or ends paths.
fn scatter<L: Lanes>(
    world: &World,
    queue: &Queue<'_, State<L>>,
    block: Block<'_, '_>,
    Scratch { numbers, drawn, onward, .. }: &mut Scratch,
    out: &mut Out<'_, State<L>>,
) {
    drawn.clear();
    if !block.diffuse {
        drawn.extend(block.all().enumerate().map(|(i, vertex)| {
            let [u, v, lobe] = numbers.direction(i);
            vertex.shaded.sample(vertex.wo, lobe, [u, v], Transport::Radiance)
        }));
        drawn.resize(block.vertices.len(), None);
    }
    queue.simd.run(Scatter { vertices: block.vertices, numbers, drawn, out: onward });
    for (i, vertex) in block.all().enumerate() {
        let index = vertex.path as usize;
        let (path, ray) = (&queue.paths[index], &queue.rays[index]);
        let state = &path.state;
        let Some(next) = onward.get(i, ray) else { continue };
        let s = drawn.get(i).copied().flatten().unwrap_or(BsdfSample::REFLECTED);
        let mut footprint = state.footprint;
        if world.materials.vary() {
            let sample = BsdfSample { wi: next.ray.d, pdf: next.pdf, ..s };
            footprint = world.footprint_beyond(&footprint, (ray, &queue.hits[index]), &sample);
        }
        let state = State {
            // A direction of a single wavelength: the others end here, and their lanes are 0.
            lanes: if s.wavelength > 0.0 { state.lanes.only(s.wavelength) } else { state.lanes },
            footprint,
            beta: next.beta,
            from: vertex.receiver(),
            pdf: next.pdf,
            delta: s.delta,
            depth: state.depth + 1,
            eta_squared: next.eta_squared,
            inside: inside_beyond(vertex, s.transmitted),
        };
        out.go_on(path, 0, next.ray, state);
    }
}

/// Power heuristic with exponent 2 for a sample drawn with density `a` that another technique would have drawn
/// with density `b` (Veach 1997, section 9.2.4).
#[inline(always)]
fn power_heuristic(a: f32, b: f32) -> f32 {
    // By the ratio: squares of densities leave the range of single precision.
    let r = b / a;
    1.0 / (1.0 + r * r)
}
