//! What a pixel shows by way of mirrors and glass, for denoisers.
//!
//! The first hit tells nothing of what is seen in a mirror or through a window: its albedo and normal are those of the pane. So the way of light is followed
//! through delta lobes, by the very numbers by which the path itself goes, to the first surface that scatters. Its albedo counts as far as the way there lets light through. Of nested clear
//! materials the boundaries alone are seen, not which of two that overlap counts.

use crate::film::channel::FirstHit;
use crate::footprint::PackedFootprint;
use crate::lanes::Rgb;
use crate::material::Transport;
use crate::material::shaded::Shaded;
use crate::shape::offset::End;
use crate::world::World;
use straal_accel::Hit;
use straal_color::Light;
use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_math::{Ray, Vec3, ops};

/// Panes and mirrors that are followed; what comes after is as good as unseen.
const MOST: u32 = 16;

/// A camera's ray and its hit.
pub(super) struct Seen<'a> {
    pub world: &'a World,
    pub pattern: Pattern,
    /// The name of its path.
    pub name: SampleName,
    pub ray: Ray,
    pub hit: Hit,
}

impl Seen<'_> {
    /// Albedo and normal of the first surface that scatters, and the distance of the first one. The albedo of what shines and of the surroundings is 1, that of a
    /// way without end 0. `closest` searches a ray.
    pub fn follow(&self, mut closest: impl FnMut(&Ray) -> Hit) -> FirstHit {
        let (world, mut ray, mut hit, mut name) = (self.world, self.ray, self.hit, self.name);
        let mut through = Light::ONE;
        let last = |albedo: Light, normal: Vec3| FirstHit {
            albedo: albedo.to_rgb().map(|v| ops::clamp(v, 0.0, 1.0)),
            normal,
            distance: self.hit.t,
        };
        for _ in 0..MOST {
            if !hit.is_hit() {
                return last(through, Vec3::ZERO);
            }
            let surface = world.surface(&ray, &hit, &PackedFootprint::NONE);
            let n = surface.point.n;
            if surface.emitter.is_some() {
                return last(through, n);
            }
            let (lanes, at) = (Rgb::default(), surface.at.as_ref());
            let mut material = surface.material;
            if world.materials.choose() {
                let u = self.pattern.d1(&name, Purpose::Material);
                material = world.chosen(material, (at, surface.in_front), lanes, u);
            }
            let bsdf = world.bsdf_at(material, at, lanes);
            if !bsdf.is_delta() {
                return last(through * bsdf.albedo(), n);
            }
            let [u, v, u_lobe] = self.pattern.d3(&name, Purpose::Direction);
            let wo = surface.frame.to_local(-ray.d);
            let shaded = Shaded { bsdf, ng: surface.ng };
            let Some(sample) = shaded.sample(wo, u_lobe, [u, v], Transport::Radiance) else { break };
            through *= sample.weight;
            let wi = surface.frame.to_world(sample.wi);
            let end = End { p: surface.point.p, p_err: surface.point.p_err, ng: surface.point.ng };
            ray = Ray { time: ray.time, ..Ray::new(end.leave(wi), wi) };
            name = name.child(0);
            hit = closest(&ray);
            if world.materials.any_may_pass() {
                let u = self.pattern.d1(&name, Purpose::Opacity);
                world.go_past_masks(&ray, &mut hit, u, &mut closest);
            }
        }
        last(Light::ZERO, Vec3::ZERO)
    }
}
