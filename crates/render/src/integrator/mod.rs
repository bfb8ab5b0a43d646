//! Integrators: how light is gathered along rays.
//!
//! An integrator is a *step*. The driver owns the loop: it starts a wave of paths at the camera, finds what their
//! rays hit, and hands paths and hits to [`Integrator::step`], which adds the light met there, asks for shadow rays
//! with what each would bring, and turns every path's ray into the next one or ends the path. A wave of one path
//! gives the same bits as a wave of a thousand: a step reads nothing of its neighbours.

mod path;
mod sine_product;

pub use path::PathTracer;
pub use sine_product::SineProduct;

use crate::film::Sample;
use crate::footprint::PackedFootprint;
use crate::lanes::Lanes;
use crate::stopwatch::Stopwatch;
use crate::world::World;
use straal_accel::Hit;
use straal_color::Light;
use straal_math::Ray;
use straal_math::lowdisc::{Pattern, SampleName};

/// A way of gathering light.
pub trait Integrator: Sync {
    /// What a path carries from one vertex to the next, besides its ray.
    type State<L: Lanes>: Copy + Send;

    /// The state of a path that leaves the camera; its footprint is none in a world where nothing asks for it.
    fn start<L: Lanes>(&self, lanes: L, footprint: PackedFootprint) -> Self::State<L>;

    /// One bounce of every path of a wave.
    fn step<L: Lanes>(&self, world: &World, wave: &mut Wave<'_, Self::State<L>>);
}

/// A path in flight.
#[derive(Clone, Copy, Debug)]
pub struct Path<S> {
    /// Names the random numbers of its present node.
    pub name: SampleName,
    /// Which of the wave's samples it belongs to.
    pub sample: u32,
    /// Whether it goes on; a path that doesn't is taken from the wave after the step.
    pub alive: bool,
    /// The integrator's own.
    pub state: S,
}

/// A ray towards a light, and what it brings if nothing is in the way.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRay {
    /// Contribution to the sample, visibility left out.
    pub light: Light,
    /// Which of the wave's samples it belongs to.
    pub sample: u32,
}

/// The paths of one step, what their rays hit, and where the step leaves its results.
pub struct Wave<'a, S> {
    /// Source of random numbers.
    pub pattern: Pattern,
    /// The paths.
    pub paths: &'a mut [Path<S>],
    /// Each path's ray: what was traced, then the next one.
    pub rays: &'a mut [Ray],
    /// What each ray hit.
    pub hits: &'a [Hit],
    /// Indices of the paths, grouped by material so that like is shaded beside like.
    pub order: &'a [u32],
    /// The wave's samples: a step adds light and fills the guides at the first vertex.
    pub samples: &'a mut [Pending],
    /// Shadow rays asked for, and what they bring; at most one a path in each step.
    pub shadow_rays: &'a mut Vec<Ray>,
    /// As many as `shadow_rays`.
    pub shadows: &'a mut Vec<ShadowRay>,
    /// Tells how long each part took.
    pub stopwatch: &'a mut Stopwatch,
}

/// A sample whose light is still being gathered.
#[derive(Clone, Copy, Debug)]
pub struct Pending {
    /// Radiance so far.
    pub light: Light,
    /// Guides of the first vertex; its `rgb` is filled when the sample is done.
    pub guides: Sample,
    /// How much of red, green and blue the film takes, see [`crate::camera::Camera::taken`].
    pub taken: [f32; 3],
}

impl Default for Pending {
    fn default() -> Self {
        Self { light: Light::default(), guides: Sample::default(), taken: [1.0; 3] }
    }
}
