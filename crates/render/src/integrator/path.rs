//! Path tracing with next-event estimation and multiple importance sampling (Kajiya 1986; Veach 1997, chapters 8-10).

use super::numbers::{BLOCK, Numbers, Wanted};
use super::{Arrival, Contribution, Integrator, Kind, Out, Queue, Start};
use crate::footprint::PackedFootprint;
use crate::lanes::Lanes;
use crate::light::Receiver;
use crate::material::{Bsdf, BsdfSample, Shaded, Transport};
use crate::shape::offset::End;
use crate::stopwatch::Phase;
use crate::surface::Surface;
use crate::world::World;
use straal_color::Light;
use straal_math::lowdisc::SampleName;
use straal_math::{Frame, Ray, Vec3, ops};
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
}

/// A path's vertex on a surface where scattering is computed.
#[derive(Clone, Copy)]
struct Vertex<'w> {
    /// The path's number in the driver's turn.
    path: u32,
    /// The point, its error and geometric normal.
    end: End,
    /// About the shading normal.
    frame: Frame,
    shaded: Shaded<'w>,
    /// Direction back along the path, in the frame.
    wo: Vec3,
}

impl Vertex<'_> {
    /// Where light arrives: on the side that is seen, where it can't come through.
    #[inline]
    fn receiver(&self) -> Receiver {
        let n = match self.shaded.bsdf {
            Bsdf::Custom(_) => Vec3::ZERO,
            _ if self.wo.z < 0.0 => -self.frame.n,
            _ => self.frame.n,
        };
        Receiver { p: self.end.p, n }
    }
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
        };
        start.camera_ray.map(|ray| (ray, state))
    }

    fn step<L: Lanes>(&self, world: &World, queue: &Queue<'_, State<L>>, out: &mut Out<'_, State<L>>) {
        match queue.kind {
            Kind::Missed => queue.arrivals().for_each(|arrival| miss(world, &arrival, out)),
            Kind::Dark => queue.arrivals().for_each(|arrival| {
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
        let mut vertices: [Option<Vertex<'_>>; BLOCK] = [None; BLOCK];
        let mut numbers = Numbers::default();
        for block in queue.order.chunks(BLOCK) {
            let vertices = &mut vertices[..block.len()];
            for (slot, &path) in vertices.iter_mut().zip(block) {
                *slot = self.arrive(world, queue, path, out);
            }
            self.draw(queue, vertices, &mut numbers);
            out.stopwatch.lap(Phase::Shading);
            for (i, vertex) in vertices.iter().enumerate() {
                if let Some(vertex) = vertex {
                    light(world, queue, vertex, numbers.light(i), out);
                }
            }
            out.stopwatch.lap(Phase::Lights);
            for (i, vertex) in vertices.iter().enumerate() {
                if let Some(vertex) = vertex {
                    self.scatter(world, queue, vertex, (numbers.direction(i), numbers.roulette(i)), out);
                }
            }
            out.stopwatch.lap(Phase::Shading);
        }
    }

    /// The random numbers of a block, those that any of its vertices needs.
    #[inline]
    fn draw<L: Lanes>(
        &self,
        queue: &Queue<'_, State<L>>,
        vertices: &[Option<Vertex<'_>>],
        numbers: &mut Numbers,
    ) {
        let mut names = [SampleName::new(0, [0; 2], 0); BLOCK];
        let mut wanted = Wanted::default();
        for (name, vertex) in names.iter_mut().zip(vertices) {
            let Some(vertex) = vertex else { continue };
            let path = &queue.paths[vertex.path as usize];
            *name = path.name;
            wanted.light |= !vertex.shaded.bsdf.is_delta();
            wanted.lobe |= vertex.shaded.bsdf.chooses_lobe();
            wanted.roulette |= self.plays_roulette(path.state.depth);
        }
        numbers.draw(queue.simd, queue.pattern, &names[..vertices.len()], wanted);
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
        let state = &arrival.path.state;
        let surface = world.surface(arrival.ray, arrival.hit, &state.footprint);
        meet_light(world, &arrival, &surface, out);
        if state.depth >= self.max_depth {
            return None;
        }
        let bsdf = world.bsdf(&surface, state.lanes);
        if matches!(bsdf, Bsdf::Black(_)) {
            return None;
        }
        let wo = surface.frame.to_local(-arrival.ray.d);
        let shaded = Shaded { bsdf, ng: surface.ng };
        Some(Vertex { path, end: End::from(&surface.point), frame: surface.frame, shaded, wo })
    }

    /// Draws the next direction, or ends the path.
    #[inline]
    fn scatter<L: Lanes>(
        &self,
        world: &World,
        queue: &Queue<'_, State<L>>,
        vertex: &Vertex<'_>,
        ([u, v, lobe], roulette): ([f32; 3], f32),
        out: &mut Out<'_, State<L>>,
    ) {
        let path = &queue.paths[vertex.path as usize];
        let state = &path.state;
        let Some(s) = vertex.shaded.sample(vertex.wo, lobe, [u, v], Transport::Radiance) else { return };
        let mut beta = state.beta * s.weight;
        let eta_squared = state.eta_squared * s.eta * s.eta;

        // Roulette: paths that carry little end with a chance that keeps the mean. They go on by the root of what they carry: by
        // the whole, survivors would be multiplied by so much that the noise costs more than the time saved (in `box-diffuse`
        // 12 % less variance for 3 % more time). Rath et al. 2022, "EARS: Efficiency-Aware Russian Roulette and Splitting", whose
        // optimum is a root as well.
        if self.plays_roulette(state.depth) {
            let survive = ops::min((beta.max_lane() * eta_squared).sqrt(), 0.95);
            if roulette >= survive {
                return;
            }
            beta *= 1.0 / survive;
        }
        if beta.is_black() {
            return;
        }

        let wi = vertex.frame.to_world(s.wi);
        let ray = &queue.rays[vertex.path as usize];
        let mut footprint = state.footprint;
        if world.materials.vary() {
            let hit = &queue.hits[vertex.path as usize];
            footprint = world.footprint_beyond(&footprint, (ray, hit), &BsdfSample { wi, ..s });
        }
        let next = Ray { o: vertex.end.leave(wi), t_min: 0.0, d: wi, t_max: f32::INFINITY, ..*ray };
        let state = State {
            // A direction of a single wavelength: the others end here, and their lanes are 0.
            lanes: if s.wavelength > 0.0 { state.lanes.only(s.wavelength) } else { state.lanes },
            footprint,
            beta,
            from: vertex.receiver(),
            pdf: s.pdf,
            delta: s.delta,
            depth: state.depth + 1,
            eta_squared,
        };
        out.go_on(path, 0, next, state);
    }
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
    let contribution = path.state.beta * value * light.radiance * (weight / light_pdf);
    if contribution.is_black() {
        return;
    }
    let ray = &queue.rays[vertex.path as usize];
    let towards = Ray { time: ray.time, mask: ray.mask, ..light.shadow_ray(&vertex.end) };
    out.shadow(towards, Contribution::own(path, contribution));
}

/// Power heuristic with exponent 2 for a sample drawn with density `a` that another technique would have drawn
/// with density `b` (Veach 1997, section 9.2.4).
#[inline(always)]
fn power_heuristic(a: f32, b: f32) -> f32 {
    // By the ratio: squares of densities leave the range of single precision.
    let r = b / a;
    1.0 / (1.0 + r * r)
}
