//! A vertex by itself: for integrators whose step takes one path after the other.

use super::hemisphere::Directions;
use crate::footprint::PackedFootprint;
use crate::lanes::Lanes;
use crate::light::{LightSample, Receiver};
use crate::material::interior::{Boundary, Inside};
use crate::material::{Bsdf, BsdfSample, Shaded, shaded};
use crate::shape::offset::{End, Raised};
use crate::surface::Surface;
use crate::world::World;
use straal_accel::Hit;
use straal_color::Light;
use straal_math::lowdisc::{Pattern, PatternKind, Purpose, SampleName};
use straal_math::{Ray, Vec3};

/// Where a path arrived: the surface, and how it scatters.
pub(super) struct Vertex<'w> {
    pub surface: Surface,
    pub shaded: Shaded<'w>,
    /// Towards where the ray came from, about the shading normal.
    pub wo: Vec3,
    /// Where rays leave from.
    from: Raised,
}

impl<'w> Vertex<'w> {
    /// Where a ray hit. `draw` gives the numbers that say which it is of the materials that one is made of, and which corner of a triangle lends
    /// its colour.
    pub fn new<L: Lanes>(
        world: &'w World,
        (ray, hit): (&Ray, &Hit),
        footprint: &PackedFootprint,
        lanes: L,
        draw: impl Fn(Purpose) -> f32,
    ) -> Self {
        let (surface, d) = if world.geometries[hit.geometry as usize].colours_at_corners {
            world.surface_at_corner(ray, hit, footprint, draw(Purpose::Corner))
        } else {
            (world.surface(ray, hit, footprint), ray.d)
        };
        Self::on(world, surface, d, lanes, draw)
    }

    /// On a surface that a ray met which goes in the direction `d`.
    pub fn on<L: Lanes>(
        world: &'w World,
        mut surface: Surface,
        d: Vec3,
        lanes: L,
        draw: impl Fn(Purpose) -> f32,
    ) -> Self {
        let wo = surface.frame.to_local(-d);
        if world.materials.choose() {
            let u = draw(Purpose::Material);
            surface.material = world.chosen(surface.material, (surface.at.as_ref(), wo.z > 0.0), lanes, u);
        }
        let mut shaded = Shaded { bsdf: world.bsdf(&surface, lanes), ng: surface.ng };
        let mut from = Raised::from(End::from(&surface.point));
        // What light doesn't pass is as smooth as its shading normals say.
        if surface.bulge != Vec3::ZERO && !shaded.bsdf.is_delta() && !is_open(&shaded.bsdf) {
            (from.bulge, from.is) = (surface.bulge, true);
            shaded.ng = surface.smooth;
        }
        Self { surface, shaded, wo, from }
    }

    /// Whether nothing is scattered.
    pub fn is_black(&self) -> bool {
        matches!(self.shaded.bsdf, Bsdf::Black(_))
    }

    /// What light sampling sees of it: where light comes through from behind, light from all around counts alike.
    pub fn receiver(&self) -> Receiver {
        let n = if self.wo.z < 0.0 { -self.surface.frame.n } else { self.surface.frame.n };
        Receiver { p: self.surface.point.p, n: if is_open(&self.shaded.bsdf) { Vec3::ZERO } else { n } }
    }

    /// What light sampling found, as it is scattered towards where the ray came from, over its density; and the density with which the
    /// BSDF draws that direction.
    pub fn scattered(&self, light: &LightSample) -> (Light, f32) {
        self.scattered_by(Directions::Bsdf, light)
    }

    /// The same where directions are drawn otherwise.
    pub fn scattered_by(&self, directions: Directions, light: &LightSample) -> (Light, f32) {
        let ways = [self.wo, self.surface.frame.to_local(light.wi)];
        let (bsdf, ng) = (&self.shaded.bsdf, self.shaded.ng.unwrap_or(Vec3::ZERO));
        let (value, pdf) = directions.eval_pdf_many::<Bsdf<'_>, f32>(bsdf, ng, ways, is_open(bsdf));
        (value * light.radiance * (1.0 / light.pdf), pdf)
    }

    /// A direction of the BSDF by three numbers, the first of which chooses a lobe.
    pub fn draw(&self, u: [f32; 3]) -> Option<BsdfSample> {
        self.draw_by(Directions::Bsdf, u)
    }

    /// The same where directions are drawn otherwise.
    pub fn draw_by(&self, directions: Directions, u: [f32; 3]) -> Option<BsdfSample> {
        let (bsdf, ng) = (&self.shaded.bsdf, self.shaded.ng.unwrap_or(Vec3::ZERO));
        let (sample, there) = directions.sample_many::<Bsdf<'_>, f32>(bsdf, ng, (self.wo, u), is_open(bsdf));
        there.then_some(sample)
    }

    /// The ray in a direction about the shading normal; its time is that of `like`.
    pub fn leave(&self, wi: Vec3, like: &Ray) -> Ray {
        let d = self.surface.frame.to_world(wi);
        Ray { time: like.time, ..Ray::new(self.from.leave(d), d) }
    }

    /// Whether a direction about the shading normal leaves the surface on the side that is seen.
    pub fn is_above(&self, wi: Vec3) -> bool {
        wi.z * self.wo.z > 0.0 && self.shaded.ng.is_none_or(|ng| shaded::goes_on(ng, self.wo, wi))
    }

    /// The ray that must be free for the light of a sample of an emitter to arrive; its time is that of `like`.
    pub fn shadow_ray(&self, world: &World, (emitter, light): (u32, &LightSample), like: &Ray) -> Ray {
        let ([o, d], t_max) = light.way_from(&self.from);
        Ray { t_max, time: like.time, mask: world.links.mask(emitter), ..Ray::new(o, d) }
    }

    /// What a path is inside of that goes on in a direction of the world, where it was inside of something before.
    pub fn towards(&self, world: &World, d: Vec3, inside: Inside) -> Inside {
        if self.surface.frame.n.dot(d) * self.wo.z >= 0.0 {
            return inside;
        }
        inside.crossed(world.materials.interiors().number(self.surface.material), self.wo.z > 0.0)
    }

    /// Takes for the BSDF what depends on what is on the other side of a clear material. `Some` where something of a higher priority is on both
    /// sides, so that the ray goes on as if nothing were there: what the path is inside of then.
    pub fn meet_boundary(&mut self, world: &World, inside: Inside) -> Option<Inside> {
        let interiors = world.materials.interiors();
        if !interiors.matter() {
            return None;
        }
        match interiors.boundary(inside, interiors.number(self.surface.material), self.wo.z > 0.0) {
            Boundary::Real(Some(eta)) => self.shaded.bsdf = self.shaded.bsdf.with_eta(eta),
            Boundary::Real(None) => {}
            Boundary::Ignored(inside) => return Some(inside),
        }
        None
    }
}

/// Whether light may come through from behind by what isn't delta.
fn is_open(bsdf: &Bsdf<'_>) -> bool {
    matches!(bsdf, Bsdf::Custom(_)) || bsdf.transmits()
}

/// What the medium that a ray went through has left of its light, and what it was inside of: it may have started there.
pub(super) fn left_by_medium<L: Lanes>(
    world: &World,
    (ray, hit): (&Ray, &Hit),
    inside: Inside,
    lanes: L,
) -> (Light, Inside) {
    let interiors = world.materials.interiors();
    if !interiors.matter() {
        return (Light::ONE, inside);
    }
    let from_inside = hit.is_hit() && world.is_met_from_inside(ray, hit);
    let inside = if from_inside { inside.or(interiors.number(world.material_of(hit))) } else { inside };
    let start = if ray.t_min > 0.0 { ray.t_min } else { 0.0 };
    (interiors.left_after(inside, hit.t - start, &world.reading(lanes)), inside)
}

/// What is left of light along a shadow ray within one medium: whatever is free for it to arrive goes through no other.
pub(super) fn left_on_way<L: Lanes>(world: &World, ray: &Ray, inside: Inside, lanes: L) -> Light {
    let interiors = world.materials.interiors();
    if !interiors.matter() {
        return Light::ONE;
    }
    // Rays to a point on a light are as long as the way there.
    interiors.left_after(inside, ray.t_max * ray.d.length(), &world.reading(lanes))
}

/// The name of set `k` of the random numbers of one vertex, of which there are `count`.
///
/// Of patterns without an end each sample of the pixel takes as many points of the same pattern as there are sets, so that all sets of all samples of the
/// pixel are spread as well as so many samples would be.
pub(super) fn nth(pattern: Pattern, name: &SampleName, k: u32, count: u32) -> SampleName {
    match pattern.kind() {
        PatternKind::Sobol | PatternKind::Halton | PatternKind::Random => {
            name.at_index(name.index().wrapping_mul(count).wrapping_add(k))
        }
        // These know how many samples there are; vertices of their own then.
        _ if count > 1 => name.child(k.wrapping_add(1)),
        _ => *name,
    }
}
