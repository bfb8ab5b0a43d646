//! The course's test of aliasing: no light at all, but a function whose waves get ever finer.

use super::{Contribution, Integrator, Out, Queue, Start};
use crate::lanes::Lanes;
use crate::world::World;
use straal_color::Light;
use straal_math::{Ray, ops};
use straal_scene::desc;

/// Brings (1 + sin(x²y²)) / 2 of the point where a ray meets the plane z = 0, and nothing where it meets none. An
/// orthographic camera along z shows the function itself, so that every sampler and filter is seen at work by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SineProduct;

impl SineProduct {
    pub(super) const NAME: &'static str = "sine_product";

    /// Of what a scene says.
    pub(super) fn of(_: &desc::Integrator) -> Self {
        Self
    }
}

impl Integrator for SineProduct {
    type State<L: Lanes> = L;

    fn start<L: Lanes>(&self, start: &Start<'_, L>) -> Option<(Ray, L)> {
        start.camera_ray.map(|ray| (ray, start.lanes))
    }

    fn step<L: Lanes>(&self, world: &World, queue: &Queue<'_, L>, out: &mut Out<'_, L>) {
        for arrival in queue.arrivals() {
            // In double precision: the phase is large.
            let (o, d) = (arrival.ray.o.as_dvec3(), arrival.ray.d.as_dvec3());
            let p = o - d * (o.z / d.z);
            let xy = p.x * p.y;
            if xy.is_finite() {
                let value = (0.5 + 0.5 * ops::sin_cos_d(xy * xy).0) as f32;
                let lanes = arrival.path.state;
                let light = lanes.radiance_of_rgb(&world.tables, Light::rgb([value; 3]));
                out.add(Contribution::own(arrival.path, light));
            }
        }
    }
}
