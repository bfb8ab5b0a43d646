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
//! It also sends rays ([`Emitter::emit`]): a place and a direction, each with its density, so that the light that goes that way over both densities
//! is a sample of its power. What a camera sees of the very lamp is told beside it.
//!
//! To add one: its file, which implements `Shine` and gives examples to be tested; its line in the list below; its keys in the
//! description. Which emitter is sampled is the choice of a [`LightTable`]. Emitting surfaces stand in the world's own space, or in that of an object, and
//! then shine wherever it has instances ([`copies`]): shape and mesh ids are those of the world's [`Geometry`].

use crate::lanes::{Colour, Lanes};
use crate::texture::{Reading, Readings, Value};
use straal_color::Light;
use straal_math::simd::{Float, Mask};
use straal_math::{DVec3, Ray, Vec3, warp};
use straal_scene::desc;

use crate::paint::Paint;
use crate::shape::offset::{End, FAR_END, Raised};
use crate::shape::{Geometry, SurfacePoint};

pub mod ambient;
pub mod area;
mod cells;
pub mod copies;
pub(crate) mod cube;
pub mod directional;
pub mod disc;
mod emission;
pub mod environment;
mod equal_area;
mod facing;
pub mod goniometric;
mod groups;
pub(crate) mod links;
mod list;
pub mod point;
pub mod portals;
pub mod projector;
mod reach;
mod resampled;
pub mod sky;
pub mod spot;
pub mod table;
mod tree;

pub use ambient::AmbientLight;
pub use area::{AreaLight, LitSurface, Sides};
use copies::Stand;
pub use copies::{Copies, Within};
pub use directional::DirectionalLight;
pub use disc::SunDisc;
pub use emission::{Ball, Emitted, Shows};
pub use environment::{ConstantEnvironment, ImageEnvironment};
pub use goniometric::Goniometric;
pub use groups::Groups;
pub use point::PointLight;
pub use portals::Portals;
pub use projector::Projector;
use reach::Reach;
pub use reach::Receiver;
pub use sky::Sky;
pub use spot::{Falloff, SpotLight};
pub use table::{LightTable, Pick};

list::emitters! {
    /// A point that shines evenly all around.
    Point(PointLight) of Point,
    /// A point that shines in a cone.
    Spot(SpotLight) of Spot,
    /// A point that throws a picture.
    Projector(Projector) of Projector,
    /// A point that shines as a lamp was measured.
    Goniometric(Goniometric) of Goniometric,
    /// Parallel light from infinitely far away.
    Directional(DirectionalLight) of Directional,
    /// A disc of the sky.
    Disc(SunDisc),
    /// A surface.
    Area(AreaLight),
    /// The same radiance from all around.
    Constant(ConstantEnvironment) of Environment,
    /// A picture of all that is around.
    Image(Box<ImageEnvironment>),
    /// One of these, of which light comes in through openings only.
    Portals(Box<Portals>),
    /// A clear sky.
    Sky(Sky) of Sky,
    /// The same light for every surface, from nowhere.
    Ambient(AmbientLight) of Ambient,
}

/// A direction of the description; one that single precision doesn't hold the length of as well.
fn unit(direction: DVec3) -> Vec3 {
    let single = direction.as_vec3().try_normalize();
    single.or_else(|| direction.try_normalize().map(DVec3::as_vec3)).unwrap_or(Vec3::Y)
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
    /// So it is, but it shines from one part of the sky as a lamp does.
    Disc,
    /// It comes from nowhere: neither sampling nor rays find it.
    Nowhere,
}

/// What a kind of emitter does, by [the contract](self). What is not said here of some is nothing.
trait Shine {
    /// How large it is.
    const EXTENT: Extent;

    /// [`Emitter::sample`] for many places side by side: a direction from each, by two numbers.
    fn sample_many<F: Float, L: Lanes>(
        &self,
        geometry: &Geometry,
        from: (&Receiver<F>, [F; 2]),
        readings: &Readings<'_, L>,
    ) -> LightSample<F>;

    /// See [`Emitter::sample`]: one lane of [`Self::sample_many`].
    #[inline]
    fn sample<L: Lanes>(
        &self,
        geometry: &Geometry,
        from: (&Receiver, [f32; 2]),
        reading: &Reading<'_, L>,
    ) -> Option<LightSample> {
        self.sample_many(geometry, from, &Readings::one(reading)).of_value()
    }

    /// See [`Emitter::radiance_at`].
    #[inline]
    fn radiance_at<L: Lanes>(&self, _hit: &SurfacePoint, _wo: Vec3, _reading: &Reading<'_, L>) -> Light {
        Light::ZERO
    }

    /// See [`Emitter::pdf_at`]: of a point of the surface, on this triangle.
    #[inline]
    fn pdf_at(&self, _geometry: &Geometry, _at: &Receiver, _hit: (u32, &SurfacePoint)) -> f32 {
        0.0
    }

    /// The first of [`Self::radiance_pdf_from_many`].
    #[inline(always)]
    fn radiance_from_many<F: Float, L: Lanes>(&self, wi: Vec3<F>, readings: &Readings<'_, L>) -> Light<F> {
        let at = Receiver { p: Vec3::splat(F::ZERO), n: Vec3::splat(F::ZERO) };
        self.radiance_pdf_from_many(&at, wi, readings).0
    }

    /// [`Emitter::radiance_pdf_from`] for many directions side by side.
    #[inline(always)]
    fn radiance_pdf_from_many<F: Float, L: Lanes>(
        &self,
        _at: &Receiver<F>,
        _wi: Vec3<F>,
        _readings: &Readings<'_, L>,
    ) -> (Light<F>, F) {
        (Light::splat(F::ZERO), F::ZERO)
    }

    /// See [`Emitter::radiance_pdf_from`]: one lane of the same.
    #[inline]
    fn radiance_pdf_from<L: Lanes>(&self, at: &Receiver, wi: Vec3, reading: &Reading<'_, L>) -> (Light, f32) {
        self.radiance_pdf_from_many(at, wi, &Readings::one(reading))
    }

    /// See [`Emitter::pdf_from`].
    #[inline]
    fn pdf_from(&self, _at: &Receiver, _wi: Vec3) -> f32 {
        0.0
    }

    /// Where all of its light starts from, of a light without extent that isn't infinitely far away.
    fn starts_at(&self) -> Option<Vec3> {
        None
    }

    /// A direction of its light, of one that has a [`Self::starts_at`], and its density by solid angle: all around, unless it says otherwise.
    fn starts_towards(&self, u: [f32; 2]) -> (Vec3, f32) {
        (warp::uniform_sphere(u), warp::uniform_sphere_pdf())
    }

    /// See [`Emitter::emit`]: of lights without extent, and from afar, by what [`Self::sample`] finds.
    fn emit<L: Lanes>(
        &self,
        geometry: &Geometry,
        ball: &Ball,
        u: [f32; 4],
        reading: &Reading<'_, L>,
    ) -> Option<Emitted> {
        match self.starts_at() {
            Some(place) => emission::from_point(place, self.starts_towards([u[2], u[3]]), |from| {
                self.sample(geometry, (from, [u[0], u[1]]), reading)
            }),
            None => {
                let sample =
                    self.sample(geometry, (&Receiver::anywhere(ball.center), [u[0], u[1]]), reading)?;
                emission::from_afar(&sample, ball, [u[2], u[3]])
            }
        }
    }

    /// See [`Emitter::power`]; `disc` is the area of the scene's, which light from afar falls on.
    fn power(&self, geometry: &Geometry, disc: f64) -> f64;

    /// See [`Emitter::reach`].
    fn reach(&self, geometry: &Geometry) -> Option<Reach>;

    /// Some for the tests of the contract.
    #[cfg(test)]
    fn examples() -> Vec<tests::Example>;
}

/// A direction towards an emitter, and what comes from there. Or many side by side, where a density of 0 is a sample of no value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample<F: Float = f32> {
    /// Unit vector from the reference point towards the light.
    pub wi: Vec3<F>,
    /// Radiance along -`wi`, in W/(m² sr); for a delta light irradiance on a surface facing it, in W/m².
    pub radiance: Light<F>,
    /// Density by solid angle at the reference point, positive and finite; 1 for a delta light.
    pub pdf: F,
    /// Whether no ray can hit the light by chance, so that it takes no part in multiple importance sampling.
    pub delta: F::Mask,
    /// Whether the shadow ray ends nowhere: along `wi` for ever.
    pub far: F::Mask,
    /// Where it ends else.
    pub to: End<F>,
}

impl<F: Float> LightSample<F> {
    /// Of no value.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Self::from_afar(Vec3::splat(F::ZERO), Light::splat(F::ZERO), F::ZERO)
    }

    /// From infinitely far away.
    #[inline(always)]
    fn from_afar(wi: Vec3<F>, radiance: Light<F>, pdf: F) -> Self {
        let (no, yes) = (F::Mask::splat(false), F::Mask::splat(true));
        Self { wi, radiance, pdf, delta: no, far: yes, to: End::in_space(Vec3::splat(F::ZERO)) }
    }

    /// Origin, direction and largest t of the ray that must be free for the light to arrive.
    #[inline(always)]
    pub(crate) fn way_from(&self, from: &Raised<F>) -> ([Vec3<F>; 2], F) {
        let [o, d] = from.way_to(&self.to);
        if !self.far.any() {
            return ([o, d], F::splat(FAR_END));
        }
        let o = Vec3::select(self.far, from.leave(self.wi), o);
        let d = Vec3::select(self.far, self.wi, d);
        ([o, d], F::select(self.far, F::splat(f32::INFINITY), F::splat(FAR_END)))
    }

    /// `yes` where the mask says so, `no` elsewhere.
    #[inline(always)]
    pub(crate) fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            wi: Vec3::select(mask, yes.wi, no.wi),
            radiance: Light::select(mask, yes.radiance, no.radiance),
            pdf: F::select(mask, yes.pdf, no.pdf),
            delta: mask & yes.delta | !mask & no.delta,
            far: mask & yes.far | !mask & no.far,
            to: End::select(mask, yes.to, no.to),
        }
    }

    /// The same in all lanes.
    #[inline(always)]
    pub(crate) fn uniform(one: &LightSample) -> Self {
        Self {
            wi: Vec3::uniform(one.wi),
            radiance: Light::uniform(one.radiance),
            pdf: F::splat(one.pdf),
            delta: F::Mask::splat(one.delta),
            far: F::Mask::splat(one.far),
            to: End::uniform(&one.to),
        }
    }

    /// One after the other.
    #[inline(always)]
    fn one_by_one(sample: impl Fn(usize) -> Option<LightSample>) -> Self {
        let mut all = Self::none();
        for i in 0..F::WIDTH {
            if let Some(one) = sample(i) {
                all = Self::select(F::Mask::from_bits(1 << i), Self::uniform(&one), all);
            }
        }
        all
    }

    /// What is left of it where something holds.
    #[inline(always)]
    fn only(self, mask: F::Mask) -> Self {
        Self { pdf: F::select(mask, self.pdf, F::ZERO), ..self }
    }
}

impl LightSample {
    /// `None` for one of no value.
    #[inline(always)]
    fn of_value(self) -> Option<Self> {
        (self.pdf > 0.0).then_some(self)
    }

    /// The ray that must be free for the light to arrive; its time and mask are those of [`Ray::new`].
    #[inline]
    pub fn shadow_ray(&self, from: &End) -> Ray {
        let ([o, d], t_max) = self.way_from(&Raised::from(*from));
        Ray { t_max, ..Ray::new(o, d) }
    }
}

/// The strongest lane anywhere, in double precision.
fn strength(value: &Value<Colour>) -> f64 {
    f64::from(value.most())
}

impl Emitter {
    /// Whether it is a lamp that may be hidden in part, of which points can be drawn.
    pub(crate) fn has_size(&self, geometry: &Geometry) -> bool {
        match self {
            Self::Area(light) => light.has_size(geometry),
            _ => self.is_disc(),
        }
    }

    /// Whether the edge of the unit square gives the rim of the lamp, wherever it is seen from, by [`Emitter::sample`].
    pub(crate) fn has_rim(&self, geometry: &Geometry) -> bool {
        match self {
            Self::Area(light) => light.has_rim(geometry),
            _ => self.is_disc(),
        }
    }

    /// [`Emitter::sample_many`] of the triangles that were picked, where it is a mesh whose triangles are.
    #[inline(always)]
    pub(crate) fn sample_parts<F: Float, L: Lanes>(
        &self,
        geometry: &Geometry,
        (at, u): (&Receiver<F>, [F; 2]),
        part: Option<F::Uint>,
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        match self {
            Self::Area(light) => light.sample_parts(geometry, (at, u), part, readings),
            _ => self.sample_many(geometry, at, u, readings),
        }
    }

    /// [`Emitter::sample`] of a copy, of the triangle that was picked where there is one.
    pub(crate) fn sample_copy<L: Lanes>(
        &self,
        geometry: &Geometry,
        stand: &Stand<'_>,
        from: (&Receiver, [f32; 2]),
        part: Option<u32>,
        reading: &Reading<'_, L>,
    ) -> Option<LightSample> {
        match self {
            Self::Area(light) => light.sample_copy(geometry, stand, from, part, reading),
            _ => None,
        }
    }

    /// [`Emitter::pdf_at`] of a copy, for a point of the world; where `is_picked`, of whose triangle is known that it was picked.
    pub(crate) fn pdf_of_copy(
        &self,
        geometry: &Geometry,
        stand: &Stand<'_>,
        at: &Receiver,
        (primitive, hit): (u32, &SurfacePoint),
        is_picked: bool,
    ) -> f32 {
        let Some(wi) = (hit.p - at.p).try_normalize() else { return 0.0 };
        let (from, own) = (stand.receiver(at), stand.inwards(hit));
        let pdf = if is_picked {
            self.pdf_of_part(geometry, from.p, primitive, &own)
        } else {
            self.pdf_at(geometry, &from, primitive, &own)
        };
        let pdf = pdf * stand.widening(wi);
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    /// [`Emitter::radiance_at`] of a copy, for a point of the world.
    pub(crate) fn radiance_of_copy<L: Lanes>(
        &self,
        stand: &Stand<'_>,
        hit: &SurfacePoint,
        wo: Vec3,
        reading: &Reading<'_, L>,
    ) -> Light {
        match self {
            Self::Area(light) => light.radiance_of(hit, wo, || stand.inwards(hit), reading),
            _ => Light::ZERO,
        }
    }

    /// [`Emitter::emit`] of a copy.
    pub(crate) fn emit_copy<L: Lanes>(
        &self,
        geometry: &Geometry,
        stand: &Stand<'_>,
        u: [f32; 4],
        reading: &Reading<'_, L>,
    ) -> Option<Emitted> {
        match self {
            Self::Area(light) => light.emit_copy(geometry, stand, u, reading),
            _ => None,
        }
    }

    /// [`Emitter::pdf_at`] where the very triangle was picked.
    #[inline]
    pub(crate) fn pdf_of_part(
        &self,
        geometry: &Geometry,
        p: Vec3,
        primitive: u32,
        hit: &SurfacePoint,
    ) -> f32 {
        match self {
            Self::Area(light) => light.pdf_of_part(geometry, p, (primitive, hit)),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests;
