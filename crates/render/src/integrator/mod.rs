//! Integrators: how light is gathered along rays.
//!
//! An integrator is a *step*. The driver owns the loop: it starts paths, finds what their rays hit, and sorts them into
//! [queues](Queue) by what has to be computed there. [`Integrator::step`] takes one queue and [emits](Out): the light that was
//! met, rays that go on, shadow rays with what each would bring, light for other places of the film. It reads nothing of a path's
//! neighbours, and light is summed as integers, so that a pool of one path gives the same bits as a pool of a thousand.
//!
//! To add an integrator, write its file: a state, where its paths start, and a step; its line in the list below; its keys in the
//! description.

mod ambient_occlusion;
mod direct;
mod ears;
mod hemisphere;
mod leaving;
mod light_tracing;
mod lighting;
mod list;
mod numbers;
mod out;
mod path;
mod queue;
mod scattering;
mod sine_product;
mod technique;
mod vertex;
mod vertices;
mod whitted;
mod zones;

pub use ambient_occlusion::{AmbientOcclusion, Falloff, Warp};
pub use direct::DirectLight;
pub use ears::Ears;
pub use hemisphere::Directions;
pub use light_tracing::LightTracer;
pub use out::{Contribution, Out, Target};
pub use path::PathTracer;
pub(crate) use path::Scratch;
pub use queue::{Arrival, Kind, Queue};
pub use scattering::Roulette;
pub use sine_product::SineProduct;
pub use technique::Technique;
pub use whitted::Whitted;
pub use zones::{ShadowZones, Shown};

use crate::footprint::PackedFootprint;
use crate::lanes::Lanes;
use crate::world::World;
use straal_math::Ray;
use straal_math::lowdisc::{Pattern, SampleName};
use straal_scene::desc;

list::integrators! {
    /// Path tracing with next-event estimation.
    Path(PathTracer),
    /// Direct light alone.
    Direct(DirectLight),
    /// How much of an even sky is seen.
    Ao(AmbientOcclusion),
    /// Rays from lamps.
    Light(LightTracer),
    /// The textbook's recursive ray tracer.
    Whitted(Whitted),
    /// A function in place of light.
    SineProduct(SineProduct),
    /// The zones of a lamp's shadow.
    Zones(ShadowZones),
}

/// Who works with any integrator, compiled for each.
pub trait WithIntegrator {
    /// What comes of it.
    type Out;

    /// Works with this one.
    fn with<I: Integrator + 'static>(self, integrator: I) -> Self::Out;
}

/// A way of gathering light.
pub trait Integrator: Sync {
    /// What a path carries from one vertex to the next, besides its ray.
    type State<L: Lanes>: Copy + Send;

    /// Where its paths start.
    const ORIGIN: Origin = Origin::Camera;

    /// Whether it brings light to other places of the film than a sample's own ([`Contribution::splat`]). The film has room for
    /// that then, and tells no noise of it.
    const SPLATS: bool = false;

    /// Whether it says of all light from which group of lights it comes ([`Contribution::of`]).
    const LIGHT_GROUPS: bool = false;

    /// The first ray of a sample's path, and what it carries; `None` for a sample that brings nothing.
    fn start<L: Lanes>(&self, start: &Start<'_, L>) -> Option<(Ray, Self::State<L>)>;

    /// What a picture tells of it: names and values. Nothing, unless it says otherwise.
    fn facts(&self) -> Vec<(&'static str, String)> {
        Vec::new()
    }

    /// Why it can't make a picture of a world, if so: a sentence without a full stop.
    fn misfit(&self, _world: &World) -> Option<String> {
        None
    }

    /// The most that a contribution counts that came by way of more than one surface ([`Contribution::indirect`]).
    fn limit(&self) -> f32 {
        f32::INFINITY
    }

    /// Lets paths have at most so many edges, the camera's included, if that means anything to it.
    fn limit_depth(&mut self, _edges: u32) {}

    /// What the paths of one queue have met.
    fn step<L: Lanes>(
        &self,
        world: &World,
        queue: &Queue<'_, Self::State<L>>,
        out: &mut Out<'_, Self::State<L>>,
    );
}

/// Where the paths of an integrator start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// At the camera: the first ray is [`Start::camera_ray`], and a path brings light to its own pixel.
    Camera,
    /// At lights: a path brings light to any place of the film. There are as many of them in a pass as the whole
    /// picture has pixels, and the film divides by the number of passes.
    Light,
}

/// What a path starts from.
#[derive(Clone, Copy)]
pub struct Start<'a, L> {
    /// The scene.
    pub world: &'a World,
    /// Width and height of the whole picture in pixels.
    pub size: [u32; 2],
    /// The sample's pixel.
    pub pixel: [u32; 2],
    /// Source of random numbers.
    pub pattern: Pattern,
    /// Names the random numbers of the path's first node.
    pub name: SampleName,
    /// By what it reads colours.
    pub lanes: L,
    /// What the camera sees by this sample; `None` where that is nothing, and for paths from lights.
    pub camera_ray: Option<Ray>,
    /// What of a surface that ray stands for; none in a world where nothing asks for it.
    pub footprint: PackedFootprint,
}

/// A path in flight.
#[derive(Clone, Copy, Debug)]
pub struct Path<S> {
    /// Names the random numbers of its present node.
    pub name: SampleName,
    /// Which of the worker's samples it belongs to.
    pub sample: u32,
    /// The integrator's own.
    pub state: S,
}
