//! Ambient occlusion: how much of an even sky a point sees (Zhukov et al. 1998; Landis 2002).

use super::vertex::{Vertex, nth};
use super::{Arrival, Contribution, Integrator, Out, Queue, Start};
use crate::footprint::PackedFootprint;
use crate::lanes::Lanes;
use crate::world::World;
use straal_color::Light;
use straal_math::lowdisc::Purpose;
use straal_math::{Ray, Vec3, ops, warp};
use straal_scene::desc;

/// Shows of each point the share of an even sky that it sees, weighed by the cosine: 1 in the open, 0 in a crack. What is seen of the
/// sky itself is 1. Lights and materials play no part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AmbientOcclusion {
    /// Occluders that are further away don't count, in metres.
    pub radius: f32,
    /// How occluders count by their distance.
    pub falloff: Falloff,
    /// How directions are drawn.
    pub warp: Warp,
    /// Directions for each sample of the pixel.
    pub rays: u32,
}

/// How an occluder counts by its distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// Each alike.
    None,
    /// What passes grows evenly from 0 at the point to 1 at the radius.
    Linear,
    /// By the square of the distance.
    Quadratic,
}

/// How directions of the sky are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Warp {
    /// By the cosine to the normal: each counts alike.
    Cosine,
    /// Evenly over the hemisphere: each counts by its cosine.
    Uniform,
    /// The angle is the root of a random number, each counts alike. It is wrong: none is flatter than one radian.
    Wrong,
}

impl AmbientOcclusion {
    pub(super) const NAME: &'static str = "ao";

    /// Of what a scene says.
    pub(super) fn of(said: &desc::Integrator) -> Self {
        let said = match said {
            desc::Integrator::Ao(said) => said.clone(),
            _ => desc::AmbientOcclusion::default(),
        };
        Self {
            radius: said.radius.map_or(f32::INFINITY, |r| r as f32),
            falloff: match said.falloff {
                desc::OcclusionFalloff::None => Falloff::None,
                desc::OcclusionFalloff::Linear => Falloff::Linear,
                desc::OcclusionFalloff::Quadratic => Falloff::Quadratic,
            },
            warp: match said.directions {
                desc::OcclusionWarp::Cosine => Warp::Cosine,
                desc::OcclusionWarp::Uniform => Warp::Uniform,
                desc::OcclusionWarp::Wrong => Warp::Wrong,
            },
            rays: said.rays,
        }
    }

    /// A direction about z by two numbers, and its weight: the cosine over pi over its density.
    fn draw(&self, u: [f32; 2]) -> (Vec3, f32) {
        match self.warp {
            Warp::Cosine => (warp::cosine_hemisphere(u), 1.0),
            Warp::Uniform => {
                let d = warp::uniform_hemisphere(u);
                (d, 2.0 * d.z)
            }
            Warp::Wrong => {
                let (sin, cos) = ops::sin_cos(u[0].sqrt());
                let (sin_phi, cos_phi) = ops::sin_cos(2.0 * std::f32::consts::PI * u[1]);
                (Vec3::new(sin * cos_phi, sin * sin_phi, cos), 1.0)
            }
        }
    }

    /// The share of light that passes an occluder at a distance.
    fn passes(&self, t: f32) -> f32 {
        let near = t / self.radius;
        match self.falloff {
            Falloff::None => 0.0,
            Falloff::Linear => near,
            Falloff::Quadratic => near * near,
        }
    }
}

/// What a ray is for.
#[derive(Clone, Copy, Debug)]
pub enum State<L> {
    /// It comes from the camera.
    Sees(L),
    /// It asks how far the sky can be seen; the light that there is if it is.
    Asks(Light),
}

impl Integrator for AmbientOcclusion {
    type State<L: Lanes> = State<L>;

    fn facts(&self) -> Vec<(&'static str, String)> {
        vec![
            ("radius", self.radius.to_string()),
            ("falloff", format!("{:?}", self.falloff).to_lowercase()),
            ("directions", format!("{:?}", self.warp).to_lowercase()),
            ("rays", self.rays.to_string()),
        ]
    }

    fn start<L: Lanes>(&self, start: &Start<'_, L>) -> Option<(Ray, State<L>)> {
        start.camera_ray.map(|ray| (ray, State::Sees(start.lanes)))
    }

    fn step<L: Lanes>(&self, world: &World, queue: &Queue<'_, State<L>>, out: &mut Out<'_, State<L>>) {
        for Arrival { path, ray, hit } in queue.arrivals() {
            match path.state {
                State::Asks(light) => {
                    let share = if hit.is_hit() { self.passes(hit.t) } else { 1.0 };
                    out.add(Contribution::own(path, light * share));
                }
                State::Sees(lanes) => {
                    let white = lanes.radiance_of_rgb(&world.tables, Light::rgb([1.0; 3]));
                    if !hit.is_hit() {
                        out.add(Contribution::own(path, white));
                        continue;
                    }
                    let draw = |purpose| queue.pattern.d1(&path.name, purpose);
                    let vertex = Vertex::new(world, (ray, hit), &PackedFootprint::NONE, lanes, draw);
                    for k in 0..self.rays {
                        let name = nth(queue.pattern, &path.name, k, self.rays);
                        let (mut d, weight) = self.draw(queue.pattern.d2(&name, Purpose::Direction));
                        d.z = if vertex.wo.z < 0.0 { -d.z } else { d.z };
                        if !vertex.is_above(d) {
                            continue;
                        }
                        let light = white * (weight / self.rays as f32);
                        let asks = Ray { t_max: self.radius, ..vertex.leave(d, ray) };
                        if self.falloff == Falloff::None {
                            out.shadow(asks, Contribution::own(path, light));
                        } else {
                            out.go_on(path, k, asks, State::Asks(light));
                        }
                    }
                }
            }
        }
    }
}
