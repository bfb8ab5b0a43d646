//! Emitters: what shines. This page is the contract; each kind has its file.
//!
//! An emitter is met in two ways, and the two agree:
//!
//! - *sampled* ([`Emitter::sample`]) from a reference point, which may tell which way its surface faces: a unit direction `wi` towards it, what arrives from there if
//!   nothing is in the way, and the density by solid angle with which `wi` was drawn. A light without extent (`delta`) has
//!   one direction only; its density counts as 1, and its `radiance` is the irradiance that a surface facing it
//!   receives. Either way a surface reflects f |cos| `radiance` / `pdf` of it. `None` is a sample of no value: the light
//!   is black, turned away, or out of reach;
//! - *hit* by a ray: a surface with [`Emitter::radiance_at`] and [`Emitter::pdf_at`], the surroundings of everything with
//!   [`Emitter::radiance_from`] and [`Emitter::pdf_from`]. The pdf is that with which `sample` at the
//!   same reference point would have found the same direction, and 0 where it never would.
//!
//! Which emitter is sampled is the choice of a [`LightTable`]. Emitting surfaces stand in the world's own space: shape
//! and mesh ids are those of its [`Geometry`].

use crate::lanes::{Colour, Lanes, Reading};
use straal_color::Light;
use straal_math::{Ray, Vec3};

use crate::shape::offset::{End, offset_origin, ray_between};
use crate::shape::{Geometry, SurfacePoint};

pub mod area;
pub(crate) mod cube;
pub mod directional;
pub mod environment;
mod facing;
pub mod point;
mod reach;
pub mod spot;
pub mod table;

pub use area::{AreaLight, LitSurface, Sides};
pub use directional::DirectionalLight;
pub use environment::{ConstantEnvironment, ImageEnvironment};
pub use point::PointLight;
pub use reach::Receiver;
pub use spot::{Falloff, SpotLight};
pub use table::{LightTable, Pick};

/// One thing that shines. (`Light` is the four numbers that it sends.)
#[derive(Clone, Debug)]
pub enum Emitter {
    /// A point that shines evenly all around.
    Point(PointLight),
    /// A point that shines in a cone.
    Spot(SpotLight),
    /// Parallel light from infinitely far away.
    Directional(DirectionalLight),
    /// A surface.
    Area(AreaLight),
    /// The same radiance from all around.
    Constant(ConstantEnvironment),
    /// A picture of all that is around.
    Image(Box<ImageEnvironment>),
}

/// A direction towards an emitter, and what comes from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit vector from the reference point towards the light.
    pub wi: Vec3,
    /// Radiance along -`wi`, in W/(m² sr); for a delta light irradiance on a surface facing it, in W/m².
    pub radiance: Light,
    /// Density by solid angle at the reference point, positive and finite; 1 for a delta light.
    pub pdf: f32,
    /// Whether no ray can hit the light by chance, so that it takes no part in multiple importance sampling.
    pub delta: bool,
    /// Where the shadow ray must go.
    pub target: Target,
}

/// Where a shadow ray ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// At a point.
    Point(End),
    /// Nowhere: along `wi` for ever.
    Direction,
}

impl LightSample {
    /// The ray that must be free for the light to arrive; its time and mask are those of [`Ray::new`].
    #[inline]
    pub fn shadow_ray(&self, from: &End) -> Ray {
        match &self.target {
            Target::Point(to) => ray_between(from, to),
            Target::Direction => Ray::new(offset_origin(from.p, from.p_err, from.ng, self.wi), self.wi),
        }
    }
}

impl Emitter {
    /// A direction from a place towards the light; `u` uniform in the unit square. Surroundings leave out what is behind the surface.
    #[inline]
    pub fn sample<L: Lanes>(
        &self,
        geometry: &Geometry,
        at: &Receiver,
        u: [f32; 2],
        reading: &Reading<'_, L>,
    ) -> Option<LightSample> {
        let p = at.p;
        match self {
            Self::Point(l) => l.sample(p, reading),
            Self::Spot(l) => l.sample(p, reading),
            Self::Directional(l) => l.sample(reading),
            Self::Area(l) => l.sample(geometry, p, u, reading),
            Self::Constant(l) => l.sample(at.n, u, reading),
            Self::Image(l) => l.sample(at.n, u, reading),
        }
    }

    /// The radiance that a point of an emitting surface sends in the unit direction `wo`; 0 for all other lights.
    #[inline]
    pub fn radiance_at<L: Lanes>(&self, hit: &SurfacePoint, wo: Vec3, reading: &Reading<'_, L>) -> Light {
        match self {
            Self::Area(l) => l.radiance(hit, wo, reading),
            _ => Light::ZERO,
        }
    }

    /// The density by solid angle with which [`Emitter::sample`] at `p` gives the direction to `hit`, a point of this
    /// emitting surface (on triangle `primitive`, when that is a mesh); 0 for all other lights.
    #[inline]
    pub fn pdf_at(&self, geometry: &Geometry, p: Vec3, primitive: u32, hit: &SurfacePoint) -> f32 {
        match self {
            Self::Area(l) => l.pdf(geometry, p, primitive, hit),
            _ => 0.0,
        }
    }

    /// The radiance that arrives from the unit direction `wi`, from beyond everything; 0 but for environments.
    #[inline]
    pub fn radiance_from<L: Lanes>(&self, wi: Vec3, reading: &Reading<'_, L>) -> Light {
        match self {
            Self::Constant(l) => l.light(reading),
            Self::Image(l) => l.radiance(wi, reading),
            _ => Light::ZERO,
        }
    }

    /// The density by solid angle with which [`Emitter::sample`] gives `wi` to a surface of normal `n`, zero where it isn't known; 0 but
    /// for environments.
    #[inline]
    pub fn pdf_from(&self, n: Vec3, wi: Vec3) -> f32 {
        match self {
            Self::Constant(l) => l.pdf(n, wi),
            Self::Image(l) => l.pdf(n, wi),
            _ => 0.0,
        }
    }

    /// [`Emitter::radiance_from`] and [`Emitter::pdf_from`] at once.
    #[inline]
    pub fn radiance_pdf_from<L: Lanes>(&self, n: Vec3, wi: Vec3, reading: &Reading<'_, L>) -> (Light, f32) {
        match self {
            Self::Image(l) => l.radiance_pdf(n, wi, reading),
            _ => (self.radiance_from(wi, reading), self.pdf_from(n, wi)),
        }
    }

    /// Whether the light is all around: what a ray that hits nothing sees.
    pub fn is_environment(&self) -> bool {
        matches!(self, Self::Constant(_) | Self::Image(_))
    }

    /// Whether the light has no extent, so that only sampling finds it.
    pub fn is_delta(&self) -> bool {
        matches!(self, Self::Point(_) | Self::Spot(_) | Self::Directional(_))
    }

    /// An estimate of the power in W that the light sends into a scene of the given radius, by its strongest lane. 0
    /// for a light that can't be sampled.
    pub fn power(&self, geometry: &Geometry, scene_radius: f64) -> f64 {
        let disc = std::f64::consts::PI * scene_radius * scene_radius;
        match self {
            Self::Point(l) => l.power(),
            Self::Spot(l) => l.power(),
            Self::Directional(l) => l.power(disc),
            Self::Area(l) => l.power(geometry),
            Self::Constant(l) => l.power(disc),
            Self::Image(l) => l.power(disc),
        }
    }
}

/// The strongest lane, in double precision.
fn strength(colour: Colour) -> f64 {
    f64::from(colour.strength)
}

#[cfg(test)]
mod tests;
