//! What a step emits.

use super::{Path, Scratch};
use crate::film::{Provenance, SampleSums};
use crate::stopwatch::Stopwatch;
use straal_color::Light;
use straal_math::Ray;

/// Light on its way to the film, and where it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contribution {
    /// Radiance, weighed by all that it takes to be a sample of the picture.
    pub light: Light,
    /// The sample whose path found it.
    pub sample: u32,
    /// What the film asks of it besides.
    pub from: Provenance,
    /// Where it goes.
    pub target: Target,
}

/// Where light goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// To the sample itself.
    Sample,
    /// To the sample itself, so much of it as other rays leave to this one, which find the light where nothing at all is in the way. Where that is something that casts no shadow of
    /// the lamp, none of them does, and all of it counts.
    Shared(f32),
    /// To a place of the film, in pixels of the whole picture, x to the right, y down.
    Film([f32; 2]),
}

impl Contribution {
    /// Light for the path's own sample.
    #[inline(always)]
    pub fn own<S>(path: &Path<S>, light: Light) -> Self {
        Self { light, sample: path.sample, from: Provenance::default(), target: Target::Sample }
    }

    /// The weight beside other rays that find the light where nothing is in the way.
    #[inline(always)]
    pub fn weight(&self) -> f32 {
        match self.target {
            Target::Shared(weight) => weight,
            Target::Sample | Target::Film(_) => 1.0,
        }
    }

    /// Light for a place of the film.
    #[inline(always)]
    pub fn splat<S>(path: &Path<S>, light: Light, at: [f32; 2]) -> Self {
        Self { target: Target::Film(at), ..Self::own(path, light) }
    }

    /// The same, if it is so, by way of more than one surface.
    #[inline(always)]
    pub fn indirect(self, is_indirect: bool) -> Self {
        Self { from: Provenance { is_indirect, ..self.from }, ..self }
    }

    /// The same from a group of lights.
    #[inline(always)]
    pub fn of(self, group: u16) -> Self {
        Self { from: Provenance { group, ..self.from }, ..self }
    }
}

/// Where a step leaves its results. The order in which they come changes no bit of the picture.
pub struct Out<'a, S> {
    /// By sample of the worker.
    pub(crate) sums: &'a mut SampleSums,
    /// Paths that go on: as many as there are `rays`.
    pub next: &'a mut Vec<Path<S>>,
    /// Their rays.
    pub rays: &'a mut Vec<Ray>,
    /// Rays that must be free for light to arrive.
    pub(crate) shadow_rays: &'a mut Vec<Ray>,
    /// As many as `shadow_rays`.
    pub(crate) shadows: &'a mut Vec<Contribution>,
    /// Light for other places than the sample's own.
    pub(crate) splats: &'a mut Vec<Contribution>,
    /// What the path tracer works in, between steps; made by the first.
    pub(crate) scratch: &'a mut Option<Box<Scratch>>,
    /// Tells how long each part took.
    pub stopwatch: &'a mut Stopwatch,
}

impl<S> Out<'_, S> {
    /// Light that has arrived.
    #[inline(always)]
    pub fn add(&mut self, contribution: Contribution) {
        match contribution.target {
            Target::Sample | Target::Shared(_) => {
                self.sums.add(contribution.sample, contribution.from, contribution.light)
            }
            Target::Film(_) => self.splats.push(contribution),
        }
    }

    /// Light that arrives if nothing is in the way of a ray.
    #[inline(always)]
    pub fn shadow(&mut self, ray: Ray, contribution: Contribution) {
        self.shadow_rays.push(ray);
        self.shadows.push(contribution);
    }

    /// A path goes on by one of its branches, numbered from 0, each of which has random numbers of its own.
    #[inline(always)]
    pub fn go_on<T>(&mut self, path: &Path<T>, branch: u32, ray: Ray, state: S) {
        self.next.push(Path { name: path.name.child(branch), sample: path.sample, state });
        self.rays.push(ray);
    }
}

impl<S: Copy> Out<'_, S> {
    /// [`Self::go_on`] with the state that the path has; gives what goes on, to be changed where it lies.
    #[inline]
    pub fn go_on_as(&mut self, path: &Path<S>, branch: u32, ray: Ray) -> &mut S {
        self.go_on(path, branch, ray, path.state);
        let last = self.next.len() - 1;
        &mut self.next[last].state
    }
}
