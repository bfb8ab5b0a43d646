//! Light tracing: rays from lamps (Arvo 1986, "Backward Ray Tracing"; Veach 1997, chapters 4, 5 and 8).
//!
//! Paths start on lamps, and wherever they arrive their light is also sent straight to the camera, to the pixel that shows the place. So what is hard to find
//! from the camera, as the bright spot below a glass ball, is easy: light goes there by itself. What can't be found is what the camera sees by
//! way of a mirror or through smooth glass: of all directions from there a single one leads to the camera.
//!
//! The light that a surface sends to the camera is what the path tracer would find there: its BSDF is asked with the camera as the viewer and the lamp as
//! the light, about the shading normal that this viewer sees. A ray brings its light to the triangle, so that by how much it is spread goes by the geometric
//! normal. With that, both are one integral, shading normals and indices of refraction included (Veach 1997, section 5.3, has the same as a
//! correction of an adjoint BSDF). Where a smooth surface bulges out of its triangles, light that comes from below a triangle's horizon finds no way to it, as it
//! does from the camera.

use super::scattering::Roulette;
use super::vertex::{Vertex, left_by_medium, left_on_way};
use super::{Arrival, Contribution, Integrator, Origin, Out, Path, Queue, Start};
use crate::camera::{FilmPoint, Shown, Sought};
use crate::footprint::PackedFootprint;
use crate::lanes::Lanes;
use crate::light::{Emitted, Emitter, LitSurface, Pick, Shows};
use crate::material::Transport;
use crate::material::interior::Inside;
use crate::shape::offset::End;
use crate::world::World;
use straal_accel::Hit;
use straal_color::Light;
use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_math::{Ray, Vec3, ops};
use straal_scene::desc;
use straal_scene::value::Depth;

/// Edges after which roulette is played whatever the settings: a path between perfect mirrors must end.
const PATIENCE: u32 = 1000;

/// The light tracer's settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightTracer {
    /// Largest number of edges of a path, the camera's included: 1 sees emitters, 2 is direct light.
    pub max_depth: u32,
    /// Paths of this many edges and more may be ended by roulette; of 1000 and more in any case.
    pub roulette_depth: u32,
    /// By which chance they go on.
    pub roulette: Roulette,
}

impl LightTracer {
    pub(super) const NAME: &'static str = "light";

    /// Of what a scene says.
    pub(super) fn of(said: &desc::Integrator) -> Self {
        let said = match said {
            desc::Integrator::Light(said) => said.clone(),
            _ => desc::LightTracer::default(),
        };
        let max_depth = match said.max_depth {
            Depth::Unlimited => u32::MAX,
            Depth::Edges(n) => n,
        };
        Self { max_depth, roulette_depth: said.roulette_depth, roulette: Roulette::of(&said.roulette) }
    }

    /// The chance by which a path goes on that carries such a part of its light.
    fn chance(&self, carried: f32, depth: u32) -> f32 {
        let plays = depth >= self.roulette_depth && self.roulette != Roulette::Off || depth >= PATIENCE;
        match self.roulette {
            _ if !plays => 1.0,
            Roulette::Throughput => ops::min(carried, 0.95),
            Roulette::Root | Roulette::Off | Roulette::Ears => ops::min(carried.sqrt(), 0.95),
        }
    }
}

/// What a ray carries.
#[derive(Clone, Copy, Debug)]
pub struct State<L> {
    lanes: L,
    /// A sample of the light that goes this way, in W, over the number of paths of a pass.
    beta: Light,
    /// The most of it that there was at the lamp.
    start: f32,
    /// Edges of the path so far, the ray's included; the camera's comes to them.
    depth: u32,
    /// The lamp.
    emitter: u32,
    /// Whether it comes straight from the lamp, which hasn't been shown yet.
    first: bool,
    inside: Inside,
}

impl Integrator for LightTracer {
    type State<L: Lanes> = State<L>;
    const ORIGIN: Origin = Origin::Light;
    const SPLATS: bool = true;
    const LIGHT_GROUPS: bool = true;

    fn facts(&self) -> Vec<(&'static str, String)> {
        let depth = if self.max_depth == u32::MAX { "unlimited".into() } else { self.max_depth.to_string() };
        let mut facts = vec![("max_depth", depth), ("roulette_depth", self.roulette_depth.to_string())];
        if self.roulette != Roulette::Root {
            facts.push(("roulette", format!("{:?}", self.roulette).to_lowercase()));
        }
        facts
    }

    fn misfit(&self, world: &World) -> Option<String> {
        if !world.camera.can_show() {
            return Some(format!(
                "rays from lamps (`integrator: light`) find their place in the picture through a pinhole, a thin lens or an orthographic camera that stands \
                 still, not through this one ({}); `path` has no such limit",
                world.camera.facts().kind
            ));
        }
        if world.has_ambient_light() {
            return Some(
                "ambient light comes from nowhere, so that no rays from lamps (`integrator: light`) can bring it; `path` has it".into(),
            );
        }
        if world.links.shadows_matter() {
            return Some(
                "rays from lamps (`integrator: light`) end at what they meet first, whether it casts shadows of that lamp (`shadows_only`, `shadows_all_but`) or not; \
                 `path` lets light pass"
                    .into(),
            );
        }
        let geometry = &world.geometry;
        let endless = |shape: u32| geometry.bounds(shape).is_none();
        let glows_unsampled = |e: &Emitter| match e {
            Emitter::Area(area) => {
                matches!(area.surface, LitSurface::Shape(shape) if geometry.area(shape).is_none())
            }
            _ => false,
        };
        if world.emitters.iter().any(glows_unsampled) {
            return Some(
                "no rays (`integrator: light`) can be sent from a surface without an end, or a program's own shape, that shines; `path` sees it".into(),
            );
        }
        if world.emitters.iter().any(|e| matches!(e, Emitter::Point(point) if !point.falls)) {
            return Some(
                "a light that doesn't fall with the distance isn't made of rays (`integrator: light`), which spread; `path` takes it as it is".into(),
            );
        }
        let from_afar = world.emitters.iter().any(Emitter::is_from_afar);
        if from_afar && (0..geometry.shapes.len() as u32).any(endless) {
            return Some(
                "light from afar can't be sent (`integrator: light`) to all of a surface without an end: a rectangle in place of a plane has one, and `path` \
                 needs none"
                    .into(),
            );
        }
        None
    }

    fn limit_depth(&mut self, edges: u32) {
        self.max_depth = edges;
    }

    fn start<L: Lanes>(&self, start: &Start<'_, L>) -> Option<(Ray, State<L>)> {
        let (world, lanes) = (start.world, start.lanes);
        let (Pick { index, pmf, .. }, emitted) = leave(world, start.pattern, &start.name, lanes)?;
        let paths = start.size[0] as f32 * start.size[1] as f32;
        let beta = lanes.full() * emitted.power() * (1.0 / (pmf * paths));
        let (start_light, inside) = (beta.max_lane(), Inside::default());
        let state = State { lanes, beta, start: start_light, depth: 1, emitter: index, first: true, inside };
        let ray = Ray::new(emitted.from.leave(emitted.d), emitted.d);
        Some((Ray { time: moment(world, start.pattern, &start.name), ..ray }, state))
    }

    fn step<L: Lanes>(&self, world: &World, queue: &Queue<'_, State<L>>, out: &mut Out<'_, State<L>>) {
        for arrival in queue.arrivals() {
            let state = &arrival.path.state;
            if state.first {
                show_lamp(world, queue, arrival.path, out);
            }
            // What a lamp doesn't light, it doesn't light by way of.
            let is_lit =
                state.depth > 1 || world.links.light(world.links.class_of(arrival.hit), state.emitter);
            if arrival.hit.is_hit() && state.depth < self.max_depth && !state.beta.is_black() && is_lit {
                self.arrive(world, queue, &arrival, out);
            }
        }
    }
}

/// The ray with which a path leaves a lamp, and which.
fn leave<L: Lanes>(world: &World, pattern: Pattern, name: &SampleName, lanes: L) -> Option<(Pick, Emitted)> {
    let pick = world.lights.pick_by_power(pattern.d1(name, Purpose::LightChoice), world.within())?;
    let emitted = world.emit(&pick, pattern.d4(name, Purpose::LightPoint), lanes)?;
    Some((pick, emitted))
}

/// When it leaves, from 0 to 1 over the shutter, in a world where that makes a difference.
fn moment(world: &World, pattern: Pattern, name: &SampleName) -> f32 {
    if world.accel.moves() { pattern.d1(name, Purpose::Time) } else { 0.0 }
}

/// Shows the camera the very point of the lamp from which a path set out.
fn show_lamp<L: Lanes>(
    world: &World,
    queue: &Queue<'_, State<L>>,
    path: &Path<State<L>>,
    out: &mut Out<'_, State<L>>,
) {
    let lanes = path.state.lanes;
    // As numbers are pure functions of their names, it is the same again.
    let Some((pick, emitted)) = leave(world, queue.pattern, &path.name, lanes) else { return };
    let [_, _, u, v] = queue.pattern.d4(&path.name, Purpose::Film);
    if !world.is_seen(path.state.emitter) {
        return;
    }
    let sought = match emitted.shows {
        Shows::Nothing => return,
        Shows::Surface { point, .. } => Sought::Point(point.p),
        Shows::Around => Sought::Direction(-emitted.d),
    };
    let Some(shown) = world.camera.shows(sought, [u, v]).filter(|s| is_in_picture(world, queue, s)) else {
        return;
    };
    // All paths of the pass share what the lamp sends; so does each what is seen of it.
    let paths = queue.size[0] as f32 * queue.size[1] as f32;
    let each = shown.density / (pick.pmf * paths);
    let (light, way) = match emitted.shows {
        Shows::Surface { point, opacity } => {
            let light = world.emitted_by(&pick, &point, -shown.d, lanes);
            let cos = point.ng.dot(shown.d).abs();
            (light * (opacity * cos * each / emitted.pdf_place), way_to_camera(&emitted.from, &shown))
        }
        _ => (emitted.light * (each / emitted.pdf_direction), Ray::new(shown.o, shown.d)),
    };
    let way = Ray { time: moment(world, queue.pattern, &path.name), mask: world.camera_mask(), ..way };
    let light = lanes.full() * light * left_on_way(world, &way, Inside::default(), lanes);
    if !light.is_black() {
        out.shadow(
            way,
            Contribution::splat(path, light, shown.position).of(world.light_groups.of(path.state.emitter)),
        );
    }
}

/// Whether what is shown lies where a filter brings it into the picture.
fn is_in_picture<S>(world: &World, queue: &Queue<'_, S>, shown: &Shown) -> bool {
    let margin = world.filter.radius() + 0.5;
    (0..2).all(|k| shown.position[k] > -margin && shown.position[k] < queue.size[k] as f32 + margin)
}

/// The ray that must be free for light to arrive at the camera.
fn way_to_camera(from: &End, shown: &Shown) -> Ray {
    crate::shape::ray_between(from, &End::in_space(shown.o))
}

/// What arrived at a vertex.
struct Here<'a, 'w, L> {
    world: &'w World,
    pattern: Pattern,
    path: &'a Path<State<L>>,
    ray: &'a Ray,
    hit: &'a Hit,
    /// As the lamp's side sees it.
    vertex: Vertex<'w>,
    beta: Light,
    /// What the ray was inside of.
    inside: Inside,
}

impl LightTracer {
    /// A surface that light falls on: what of it the camera sees, and where it goes on.
    fn arrive<L: Lanes>(
        &self,
        world: &World,
        queue: &Queue<'_, State<L>>,
        &Arrival { path, ray, hit }: &Arrival<'_, State<L>>,
        out: &mut Out<'_, State<L>>,
    ) {
        let (state, pattern) = (&path.state, queue.pattern);
        let (left, inside) = left_by_medium(world, (ray, hit), state.inside, state.lanes);
        let beta = state.beta * left;
        let surface = world.surface(ray, hit, &PackedFootprint::NONE);
        let mut vertex =
            Vertex::on(world, surface, ray.d, state.lanes, |purpose| pattern.d1(&path.name, purpose));
        if vertex.is_black() {
            return;
        }
        if let Some(inside) = vertex.meet_boundary(world, inside) {
            let beyond = Ray { t_min: hit.t.next_up(), ..*ray };
            out.go_on(path, 0, beyond, State { beta, inside, first: false, ..*state });
            return;
        }
        let here = Here { world, pattern, path, ray, hit, vertex, beta, inside };
        here.show(queue, out);
        if state.depth + 1 < self.max_depth {
            self.go_on(&here, out);
        }
    }

    /// Draws where the light goes.
    fn go_on<L: Lanes>(&self, here: &Here<'_, '_, L>, out: &mut Out<'_, State<L>>) {
        let &Here { world, pattern, path, ray, ref vertex, beta, inside, .. } = here;
        let state = &path.state;
        let [u, v, lobe] = pattern.d3(&path.name, Purpose::Direction);
        let Some(drawn) = vertex.shaded.sample(vertex.wo, lobe, [u, v], Transport::Importance) else {
            return;
        };
        let leaves = vertex.leave(drawn.wi, ray);
        let inside = vertex.towards(world, leaves.d, inside);
        let spread = here.spread(leaves.d);
        let share = if drawn.delta {
            // The same but for cosines to the shading normal, which the weight has of one side only.
            drawn.weight * (spread * vertex.wo.z.abs() / drawn.wi.z.abs())
        } else {
            here.towards(leaves.d, here.hit.t, &PackedFootprint::NONE, inside) * (spread / drawn.pdf)
        };
        let mut beta = beta * share;
        let chance = self.chance(beta.max_lane() / state.start, state.depth + 1);
        if beta.is_black() || !beta.is_finite() || pattern.d1(&path.name, Purpose::Roulette) >= chance {
            return;
        }
        beta *= 1.0 / chance;
        let mut lanes = state.lanes;
        if drawn.wavelength > 0.0 {
            lanes = lanes.only(drawn.wavelength);
        }
        let state = State { lanes, beta, depth: state.depth + 1, first: false, inside, ..*state };
        out.go_on(path, 0, leaves, state);
    }
}

impl<L: Lanes> Here<'_, '_, L> {
    /// Shows it to the camera.
    fn show(&self, queue: &Queue<'_, State<L>>, out: &mut Out<'_, State<L>>) {
        let &Self { world, pattern, path, ray, ref vertex, beta, inside, .. } = self;
        if vertex.shaded.bsdf.is_delta() {
            return;
        }
        let point = &vertex.surface.point;
        let [u, v, _, _] = pattern.d4(&path.name, Purpose::Film);
        let shown = world.camera.shows(Sought::Point(point.p), [u, v]);
        let Some(shown) = shown.filter(|s| is_in_picture(world, queue, s)) else { return };
        let way = way_to_camera(&point.into(), &shown);
        let (distance, inside) = ((point.p - shown.o).length(), vertex.towards(world, way.d, inside));
        let footprint = if world.wants_footprints() {
            let pixel = shown.position.map(|v| if v > 0.0 { v as u32 } else { 0 });
            let at = FilmPoint { pixel, position: shown.position, lens: [u, v], time: ray.time };
            world.camera.footprint(&at).packed()
        } else {
            PackedFootprint::NONE
        };
        let sent = self.towards(-shown.d, distance, &footprint, inside);
        let light = beta * sent * (self.spread(-shown.d) * shown.density);
        if light.is_black() {
            return;
        }
        let light = light * left_on_way(world, &way, inside, path.state.lanes);
        let way = Ray { time: ray.time, mask: world.camera_mask(), ..way };
        out.shadow(
            way,
            Contribution::splat(path, light, shown.position).of(world.light_groups.of(path.state.emitter)),
        );
    }

    /// Light per area across the way to a viewer, of light per area across the way from the lamp: the quotient of the geometric cosines.
    fn spread(&self, towards: Vec3) -> f32 {
        let ng = self.vertex.surface.point.ng;
        let arrives = ng.dot(self.ray.d).abs();
        if arrives > 0.0 { ng.dot(towards).abs() / arrives } else { 0.0 }
    }

    /// The value of the BSDF, times the cosine of the light's direction, for light that comes along the ray and goes towards a viewer at some distance: what a path
    /// tracer has there that came from the viewer. Light passes by what is `inside` on the viewer's side.
    fn towards(&self, viewer: Vec3, distance: f32, footprint: &PackedFootprint, inside: Inside) -> Light {
        let &Self { world, pattern, path, ray, hit, ref vertex, .. } = self;
        let surface = &vertex.surface;
        let alike = surface.ng.is_none() && surface.smooth.is_none() && !world.materials.choose();
        if alike && !world.materials.interiors().matter() && !world.wants_footprints() {
            let wo = surface.frame.to_local(viewer);
            return vertex.shaded.eval_pdf(wo, vertex.wo, Transport::Radiance).0;
        }
        let (p, d) = (surface.point.p, -viewer);
        let sees = Ray { o: p - d * distance, d, t_min: 0.0, t_max: f32::INFINITY, ..*ray };
        let seen = world.surface(&sees, &Hit { t: distance, ..*hit }, footprint);
        let draw = |purpose| pattern.d1(&path.name, purpose);
        let mut seen = Vertex::on(world, seen, d, path.state.lanes, draw);
        if seen.meet_boundary(world, inside).is_some() {
            return Light::ZERO;
        }
        let wi = seen.surface.frame.to_local(-ray.d);
        seen.shaded.eval_pdf(seen.wo, wi, Transport::Radiance).0
    }
}
