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
//! To add one: its file, which implements `Shine` and gives examples to be tested; its line in the list below; its keys in the
//! description. Which emitter is sampled is the choice of a [`LightTable`]. Emitting surfaces stand in the world's own space: shape
//! and mesh ids are those of its [`Geometry`].

use crate::lanes::{Colour, Lanes};
use crate::texture::{Reading, Value};
use straal_color::Light;
use straal_math::{DVec3, Ray, Vec3};
use straal_scene::desc;

use crate::error::CompileError;
use crate::paint::Paint;
use crate::shape::offset::{End, offset_origin, ray_between};
use crate::shape::{Geometry, SurfacePoint};

pub mod ambient;
pub mod area;
pub(crate) mod cube;
pub mod directional;
pub mod environment;
mod facing;
mod list;
pub mod point;
mod reach;
pub mod spot;
pub mod table;

pub use ambient::AmbientLight;
pub use area::{AreaLight, LitSurface, Sides};
pub use directional::DirectionalLight;
pub use environment::{ConstantEnvironment, ImageEnvironment};
pub use point::PointLight;
use reach::Reach;
pub use reach::Receiver;
pub use spot::{Falloff, SpotLight};
pub use table::{LightTable, Pick};

list::emitters! {
    /// A point that shines evenly all around.
    Point(PointLight) of Point,
    /// A point that shines in a cone.
    Spot(SpotLight) of Spot,
    /// Parallel light from infinitely far away.
    Directional(DirectionalLight) of Directional,
    /// A surface.
    Area(AreaLight),
    /// The same radiance from all around.
    Constant(ConstantEnvironment) of Environment,
    /// A picture of all that is around.
    Image(Box<ImageEnvironment>),
    /// The same light for every surface, from nowhere.
    Ambient(AmbientLight) of Ambient,
}

/// How large a kind of light is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Extent {
    /// None: only sampling finds it.
    None,
    /// A surface, which rays hit.
    Surface,
    /// It is all around: rays that hit nothing see it.
    Around,
    /// It comes from nowhere: neither sampling nor rays find it.
    Nowhere,
}

/// What a kind of emitter does, by [the contract](self). What is not said here of some is nothing.
trait Shine {
    /// How large it is.
    const EXTENT: Extent;

    /// See [`Emitter::sample`]: a direction from the place, by two numbers.
    fn sample<L: Lanes>(
        &self,
        geometry: &Geometry,
        from: (&Receiver, [f32; 2]),
        reading: &Reading<'_, L>,
    ) -> Option<LightSample>;

    /// See [`Emitter::radiance_at`].
    #[inline]
    fn radiance_at<L: Lanes>(&self, _hit: &SurfacePoint, _wo: Vec3, _reading: &Reading<'_, L>) -> Light {
        Light::ZERO
    }

    /// See [`Emitter::pdf_at`]: of a point of the surface, on this triangle.
    #[inline]
    fn pdf_at(&self, _geometry: &Geometry, _p: Vec3, _hit: (u32, &SurfacePoint)) -> f32 {
        0.0
    }

    /// See [`Emitter::radiance_pdf_from`].
    #[inline]
    fn radiance_pdf_from<L: Lanes>(&self, _n: Vec3, _wi: Vec3, _reading: &Reading<'_, L>) -> (Light, f32) {
        (Light::ZERO, 0.0)
    }

    /// See [`Emitter::pdf_from`].
    #[inline]
    fn pdf_from(&self, _n: Vec3, _wi: Vec3) -> f32 {
        0.0
    }

    /// See [`Emitter::power`]; `disc` is the area of the scene's, which light from afar falls on.
    fn power(&self, geometry: &Geometry, disc: f64) -> f64;

    /// See [`Emitter::reach`].
    fn reach(&self, geometry: &Geometry) -> Option<Reach>;

    /// Some for the tests of the contract.
    #[cfg(test)]
    fn examples() -> Vec<tests::Example>;
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

/// The strongest lane anywhere, in double precision.
fn strength(value: &Value<Colour>) -> f64 {
    f64::from(value.most())
}

#[cfg(test)]
mod tests;
