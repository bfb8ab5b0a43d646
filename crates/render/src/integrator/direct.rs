//! Direct light: what comes from lights to the first surface, and no further.

use super::hemisphere::Directions;
use super::technique::Technique;
use super::vertex::{Vertex, left_by_medium, left_on_way, nth};
use super::{Arrival, Contribution, Integrator, Out, Queue, Start, Target};
use crate::footprint::PackedFootprint;
use crate::lanes::Lanes;
use crate::light::Receiver;
use crate::light::links::{ALL, Class};
use crate::material::interior::Inside;
use crate::world::World;
use straal_color::Light;
use straal_math::lowdisc::Purpose;
use straal_math::{Ray, Vec3};
use straal_scene::desc;

/// The reflection equation with emitted light alone, by two sums of samples: points on lights and directions of the BSDF, as many of each as one likes
/// for each sample of the pixel (Veach 1997, chapter 9). Mirrors and glass show lights, nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DirectLight {
    /// Which of the two are used.
    pub technique: Technique,
    /// Points on lights.
    pub light_samples: u32,
    /// Directions of the BSDF.
    pub bsdf_samples: u32,
    /// How these are drawn, if not by the BSDF.
    pub directions: Directions,
}

impl DirectLight {
    pub(super) const NAME: &'static str = "direct";

    /// Of what a scene says.
    pub(super) fn of(said: &desc::Integrator) -> Self {
        let said = match said {
            desc::Integrator::Direct(said) => said.clone(),
            _ => desc::DirectLight::default(),
        };
        Self {
            technique: Technique::of(&said.technique),
            light_samples: said.light_samples,
            bsdf_samples: said.bsdf_samples,
            directions: Directions::of(&said.directions),
        }
    }

    /// The weight of light that a ray met.
    fn weight<L>(&self, state: &State<L>, light_pdf: impl FnOnce() -> f32) -> f32 {
        if state.delta {
            return 1.0;
        }
        let [of_bsdf, of_light] = [self.bsdf_samples, self.light_samples].map(|n| n as f32);
        self.technique.of_bsdf(of_bsdf * state.pdf, of_light * light_pdf())
    }
}

/// What a ray carries.
#[derive(Clone, Copy, Debug)]
pub struct State<L> {
    lanes: L,
    footprint: PackedFootprint,
    /// Share of the light at the ray's end that reaches the film.
    beta: Light,
    /// The point that it left, as light sampling saw it.
    from: Receiver,
    /// Density by which its direction was drawn there.
    pdf: f32,
    /// Whether that was a delta lobe or the camera.
    delta: bool,
    /// Whether it comes from the camera.
    first: bool,
    inside: Inside,
    /// By which lamps the point that it left is lit.
    class: Class,
}

impl Integrator for DirectLight {
    type State<L: Lanes> = State<L>;
    const LIGHT_GROUPS: bool = true;

    fn facts(&self) -> Vec<(&'static str, String)> {
        let mut facts = vec![
            ("technique", self.technique.name().into()),
            ("light_samples", self.light_samples.to_string()),
            ("bsdf_samples", self.bsdf_samples.to_string()),
        ];
        if self.directions != Directions::Bsdf {
            facts.push(("directions", self.directions.name().into()));
        }
        facts
    }

    fn start<L: Lanes>(&self, start: &Start<'_, L>) -> Option<(Ray, State<L>)> {
        let state = State {
            lanes: start.lanes,
            footprint: start.footprint,
            beta: start.lanes.full(),
            from: Receiver::anywhere(Vec3::ZERO),
            pdf: 0.0,
            delta: true,
            first: true,
            inside: Inside::default(),
            class: ALL,
        };
        start.camera_ray.map(|ray| (ray, state))
    }

    fn step<L: Lanes>(&self, world: &World, queue: &Queue<'_, State<L>>, out: &mut Out<'_, State<L>>) {
        for arrival in queue.arrivals() {
            self.meet(world, queue, &arrival, out);
        }
    }
}

impl DirectLight {
    /// Light that a ray meets; from where the camera's arrived, rays to lights and by the BSDF.
    fn meet<L: Lanes>(
        &self,
        world: &World,
        queue: &Queue<'_, State<L>>,
        &Arrival { path, ray, hit }: &Arrival<'_, State<L>>,
        out: &mut Out<'_, State<L>>,
    ) {
        let state = &path.state;
        let (left, inside) = left_by_medium(world, (ray, hit), state.inside, state.lanes);
        let (beta, reading) = (state.beta * left, world.reading(state.lanes));
        if !hit.is_hit() {
            let shows =
                |index: u32| world.links.light(state.class, index) && (!state.first || world.is_seen(index));
            for (index, emitter) in world.environments().filter(|(index, _)| shows(*index)) {
                let (radiance, pdf) = emitter.radiance_pdf_from(&state.from, ray.d, &reading);
                let light_pdf = || world.lights_of(state.class).pmf(index, &state.from) * pdf;
                let weight = self.weight(state, light_pdf);
                let light = beta * radiance * weight;
                out.add(Contribution::own(path, light).of(world.light_groups.of(index)));
            }
            return;
        }
        let meets_light = world.geometries[hit.geometry as usize].emitter.is_some();
        if !state.first && !meets_light && !world.materials.interiors().matter() {
            return;
        }
        let draw = |purpose| queue.pattern.d1(&path.name, purpose);
        let mut vertex = Vertex::new(world, (ray, hit), &state.footprint, state.lanes, draw);
        let point = &vertex.surface.point;
        let emitter = vertex.surface.emitter.filter(|emitter| world.links.light(state.class, *emitter));
        if let Some(emitter) = emitter {
            let radiance = world.emitted(emitter, (ray, hit), point, state.lanes);
            let light_pdf = || world.light_pdf(emitter, (state.class, &state.from), hit, point);
            let weight = self.weight(state, light_pdf);
            let light = beta * radiance * weight;
            out.add(Contribution::own(path, light).of(world.light_groups.of(emitter)));
        }
        if vertex.is_black() {
            return;
        }
        // Where something of a higher priority is on both sides nothing is in the way, wherever the ray comes from.
        if let Some(inside) = vertex.meet_boundary(world, inside) {
            let beyond = Ray { t_min: hit.t.next_up(), ..*ray };
            out.go_on(path, 0, beyond, State { beta, inside, ..*state });
            return;
        }
        if !state.first {
            return;
        }
        if world.has_ambient_light() {
            for (light, group) in world.ambient_from(hit, &vertex.shaded.bsdf, state.lanes) {
                out.add(Contribution::own(path, beta * light).of(group));
            }
        }

        let (receiver, class) = (vertex.receiver(), world.links.class_of(hit));
        let lights = world.lights_of(class);
        let [of_bsdf, of_light] = [self.bsdf_samples, self.light_samples].map(|n| n as f32);
        if !vertex.shaded.bsdf.is_delta() {
            for k in 0..self.light_samples {
                let name = nth(queue.pattern, &path.name, k, self.light_samples);
                let [u, v] = queue.pattern.d2(&name, Purpose::LightPoint);
                let Some(pick) = lights.pick(u, &receiver, world.within()) else { continue };
                let Some(light) = world.sample_picked((lights, &pick), &receiver, v, state.lanes) else {
                    continue;
                };
                let (value, pdf) = vertex.scattered_by(self.directions, &light);
                let weight = match light.delta {
                    true => 1.0,
                    false => self.technique.of_light(of_light * light.pdf, of_bsdf * pdf),
                };
                // Where not all casts shadows of the lamp, what is in the way says how much it counts.
                let is_shared = !light.delta && world.links.has_casters(pick.index);
                let (weight, target) =
                    if is_shared { (1.0, Target::Shared(weight)) } else { (weight, Target::Sample) };
                let brought = beta * value * (weight / of_light);
                if !brought.is_black() {
                    let free = vertex.shadow_ray(world, (pick.index, &light), ray);
                    let inside = vertex.towards(world, free.d, inside);
                    let left = left_on_way(world, &free, inside, state.lanes);
                    let group = world.light_groups.of(pick.index);
                    let contribution = Contribution::own(path, brought * left).of(group);
                    out.shadow(free, Contribution { target, ..contribution });
                }
            }
        }
        for k in 0..self.bsdf_samples {
            let name = nth(queue.pattern, &path.name, k, self.bsdf_samples);
            let [u, v, lobe] = queue.pattern.d3(&name, Purpose::Direction);
            let Some(drawn) = vertex.draw_by(self.directions, [lobe, u, v]) else { continue };
            if self.technique == Technique::Lights && !drawn.delta {
                continue;
            }
            let leaves = vertex.leave(drawn.wi, ray);
            let mut next = State {
                beta: beta * drawn.weight * (1.0 / of_bsdf),
                from: receiver,
                pdf: drawn.pdf,
                delta: drawn.delta,
                first: false,
                class,
                inside: vertex.towards(world, leaves.d, inside),
                ..*state
            };
            if drawn.wavelength > 0.0 {
                next.lanes = next.lanes.only(drawn.wavelength);
            }
            if !next.beta.is_black() {
                out.go_on(path, k, leaves, next);
            }
        }
    }
}
