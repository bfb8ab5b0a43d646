//! The textbook's recursive ray tracer (Whitted 1980, "An Improved Illumination Model for Shaded Display"; Suffern 2007, chapters 24, 27 and 28).
//!
//! At each surface light arrives straight from every lamp, as a highlight and as what is scattered evenly; mirrors and glass send
//! rays on, glass two. Nothing is drawn by chance, so that one sample a pixel has no noise. What isn't there is what the
//! rendering equation has beyond: light that comes by way of other surfaces, soft shadows, blurred reflections.

use super::vertex::{Vertex, left_by_medium, left_on_way};
use super::{Arrival, Contribution, Integrator, Out, Queue, Start};
use crate::footprint::PackedFootprint;
use crate::lanes::{Carried, Lanes};
use crate::light::Emitter;
use crate::light::links::{ALL, Class};
use crate::material::BsdfSample;
use crate::material::interior::Inside;
use crate::world::World;
use straal_accel::Hit;
use straal_color::Light;
use straal_math::{Ray, ops};
use straal_scene::desc;

/// The largest number that a pattern gives.
const LAST: f32 = 1.0 - f32::EPSILON / 2.0;

/// What is worth less to the film isn't followed, whatever is said: between perfect mirrors rays must end.
const LEAST: f32 = 1e-6;

/// The recursive ray tracer's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whitted {
    /// Largest number of edges of a path, the camera's included; beyond is black.
    pub max_depth: u32,
    /// Rays that would bring less than this share of the light at their end aren't followed.
    pub min_weight: f32,
    /// Whether what is between a lamp and a surface keeps its light off.
    pub shadows: bool,
    /// Whether mirrors, and the surface of glass, send rays on.
    pub reflections: bool,
    /// Whether glass lets rays through.
    pub refractions: bool,
    /// Into how many rays glass with dispersion splits white light.
    pub dispersion_rays: u32,
    /// Rays start at this distance from where they leave, in metres, rather than just outside of what rounding may have moved.
    pub epsilon: Option<f32>,
}

impl Whitted {
    pub(super) const NAME: &'static str = "whitted";

    /// Of what a scene says.
    pub(super) fn of(said: &desc::Integrator) -> Self {
        let said = match said {
            desc::Integrator::Whitted(said) => said.clone(),
            _ => desc::Whitted::default(),
        };
        Self {
            max_depth: said.max_depth,
            min_weight: said.min_weight as f32,
            shadows: said.shadows,
            reflections: said.reflections,
            refractions: said.refractions,
            dispersion_rays: said.dispersion_rays,
            epsilon: said.epsilon.map(|e| e as f32),
        }
    }

    /// A ray that leaves a surface at `p`, as the textbook has it where that is asked for.
    fn leaving(&self, vertex: &Vertex<'_>, ray: Ray) -> Ray {
        match self.epsilon {
            None => ray,
            // By the length of the direction: a shadow ray's is the way to the lamp.
            Some(epsilon) => Ray { o: vertex.surface.point.p, t_min: epsilon / ray.d.length(), ..ray },
        }
    }
}

/// What a ray carries.
#[derive(Clone, Copy, Debug)]
pub struct State<L> {
    lanes: L,
    footprint: PackedFootprint,
    /// Share of the light at the ray's end that reaches the film.
    beta: Light,
    /// Edges so far, the ray's included.
    depth: u32,
    inside: Inside,
    /// By which lamps the surface is lit that it left.
    class: Class,
}

impl Integrator for Whitted {
    type State<L: Lanes> = State<L>;
    const LIGHT_GROUPS: bool = true;

    fn facts(&self) -> Vec<(&'static str, String)> {
        let mut facts = vec![
            ("max_depth", self.max_depth.to_string()),
            ("min_weight", self.min_weight.to_string()),
            ("shadows", self.shadows.to_string()),
            ("reflections", self.reflections.to_string()),
            ("refractions", self.refractions.to_string()),
            ("dispersion_rays", self.dispersion_rays.to_string()),
        ];
        facts.extend(self.epsilon.map(|epsilon| ("epsilon", epsilon.to_string())));
        facts
    }

    fn limit_depth(&mut self, edges: u32) {
        self.max_depth = edges;
    }

    fn start<L: Lanes>(&self, start: &Start<'_, L>) -> Option<(Ray, State<L>)> {
        let (lanes, footprint) = (start.lanes, start.footprint);
        let state =
            State { lanes, footprint, beta: lanes.full(), depth: 1, inside: Inside::default(), class: ALL };
        start.camera_ray.map(|ray| (ray, state))
    }

    fn step<L: Lanes>(&self, world: &World, queue: &Queue<'_, State<L>>, out: &mut Out<'_, State<L>>) {
        for arrival in queue.arrivals() {
            self.shade(world, queue, &arrival, out);
        }
    }
}

impl Whitted {
    /// What a ray met: light, a surface that lamps light, a mirror or glass.
    fn shade<L: Lanes>(
        &self,
        world: &World,
        queue: &Queue<'_, State<L>>,
        &Arrival { path, ray, hit }: &Arrival<'_, State<L>>,
        out: &mut Out<'_, State<L>>,
    ) {
        let state = &path.state;
        let (left, inside) = left_by_medium(world, (ray, hit), state.inside, state.lanes);
        let beta = state.beta * left;
        let reading = world.reading(state.lanes);
        if !hit.is_hit() {
            // Seen, but it lights nothing.
            let shows = |index: u32| {
                world.links.light(state.class, index) && (state.depth > 1 || world.is_seen(index))
            };
            for (index, background) in world.environments().filter(|(index, _)| shows(*index)) {
                let light = beta * background.radiance_from(ray.d, &reading);
                out.add(Contribution::own(path, light).of(world.light_groups.of(index)));
            }
            return;
        }
        let draw = |purpose| queue.pattern.d1(&path.name, purpose);
        let mut vertex = Vertex::new(world, (ray, hit), &state.footprint, state.lanes, draw);
        let emitter = vertex.surface.emitter.filter(|emitter| world.links.light(state.class, *emitter));
        if let Some(emitter) = emitter {
            let shines = world.emitted(emitter, (ray, hit), &vertex.surface.point, state.lanes);
            out.add(Contribution::own(path, beta * shines).of(world.light_groups.of(emitter)));
        }
        if vertex.is_black() {
            return;
        }
        if let Some(inside) = vertex.meet_boundary(world, inside) {
            let beyond = Ray { t_min: hit.t.next_up(), ..*ray };
            out.go_on(path, 0, beyond, State { beta, inside, ..*state });
            return;
        }
        let here = Here { ray, hit, vertex: &vertex, beta, inside, class: world.links.class_of(hit) };
        self.light(world, path, &here, out);
        if state.depth < self.max_depth {
            self.send_on(world, path, &here, out);
        }
    }

    /// Light from each lamp: from all of its middle.
    fn light<L: Lanes>(
        &self,
        world: &World,
        path: &super::Path<State<L>>,
        &Here { ray, hit, vertex, beta, inside, class }: &Here<'_, '_>,
        out: &mut Out<'_, State<L>>,
    ) {
        let lanes = path.state.lanes;
        if world.has_ambient_light() {
            for (light, group) in world.ambient_from(hit, &vertex.shaded.bsdf, lanes) {
                out.add(Contribution::own(path, beta * light).of(group));
            }
        }
        if vertex.shaded.bsdf.is_delta() {
            return;
        }
        let receiver = vertex.receiver();
        let is_asked = |index: u32, emitter: &Emitter| {
            let is_around = emitter.is_environment() && !emitter.is_disc() || emitter.is_ambient();
            !is_around && world.links.light(class, index)
        };
        let lamps = (0..).zip(&world.emitters).filter(|(index, emitter)| is_asked(*index, emitter));
        for lamp in lamps.flat_map(|(index, _)| (0..world.copies.count(index)).map(move |copy| (index, copy)))
        {
            let Some(light) = world.sample_light(lamp, &receiver, [0.5; 2], lanes) else { continue };
            let brought = beta * vertex.scattered(&light).0;
            if brought.is_black() {
                continue;
            }
            let way = self.leaving(vertex, vertex.shadow_ray(world, (lamp.0, &light), ray));
            let brought = brought * left_on_way(world, &way, vertex.towards(world, way.d, inside), lanes);
            let contribution = Contribution::own(path, brought).of(world.light_groups.of(lamp.0));
            if self.shadows {
                out.shadow(way, contribution);
            } else {
                out.add(contribution);
            }
        }
    }

    /// A ray for each delta lobe.
    fn send_on<L: Lanes>(
        &self,
        world: &World,
        path: &super::Path<State<L>>,
        here: &Here<'_, '_>,
        out: &mut Out<'_, State<L>>,
    ) {
        let &Here { ray, vertex, beta, inside, class, .. } = here;
        let mut branch = 0;
        for way in delta_lobes(vertex, 0.5).into_iter().flatten() {
            if !(if way.transmitted { self.refractions } else { self.reflections }) {
                continue;
            }
            let splits = way.wavelength > 0.0 && path.state.lanes.carried() == Carried::All;
            let count = if splits { self.dispersion_rays } else { 1 };
            for k in 0..count {
                let way = if splits {
                    // Of the lobes at this wavelength the last is what passes; beyond its critical angle there is none.
                    let u = (k as f32 + 0.5) / count as f32;
                    let Some(way) = delta_lobes(vertex, u)[1].filter(|s| s.transmitted) else { continue };
                    way
                } else {
                    way
                };
                // Divided by the chance with which the lobe would have been drawn.
                let beta = beta * way.weight * (way.pdf / count as f32);
                let energy = beta.max_lane() * if way.transmitted { way.eta * way.eta } else { 1.0 };
                if energy.is_nan() || energy < ops::max(self.min_weight, LEAST) {
                    continue;
                }
                let leaves = vertex.leave(way.wi, ray);
                let mut state = State {
                    beta,
                    depth: path.state.depth + 1,
                    inside: vertex.towards(world, leaves.d, inside),
                    class,
                    ..path.state
                };
                if way.wavelength > 0.0 {
                    state.lanes = state.lanes.only(way.wavelength);
                }
                out.go_on(path, branch, self.leaving(vertex, leaves), state);
                branch += 1;
            }
        }
    }
}

/// Where a ray arrived, with what it carries.
struct Here<'a, 'w> {
    ray: &'a Ray,
    hit: &'a Hit,
    vertex: &'a Vertex<'w>,
    beta: Light,
    inside: Inside,
    /// By which lamps the surface is lit.
    class: Class,
}

/// The directions that light comes from as from a mirror or through glass: at most two, by the smallest and the largest number that chooses a
/// lobe. `u` draws a wavelength where glass parts them.
fn delta_lobes(vertex: &Vertex<'_>, u: f32) -> [Option<BsdfSample>; 2] {
    let [first, last] = [0.0, LAST].map(|lobe| vertex.draw([lobe, u, 0.5]).filter(|s| s.delta));
    match (&first, &last) {
        (Some(a), Some(b)) if a.transmitted == b.transmitted => [None, last],
        _ => [first, last],
    }
}
