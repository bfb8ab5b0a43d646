//! Values that differ from point to point. This page is the contract; each kind of texture has its file.
//!
//! Every number and colour of a material or light is a [`Value`]: a constant, or what a [`Texture`] has at a point. All are read in
//! one way, [`Reading::eval`], which gives a number, or light as the path's lanes have it:
//!
//! - a picture's pixel has RGB, and whoever reads it knows whether that is a share of light that comes back or light that is sent
//!   out ([`Use`]): by wavelengths these become different spectra;
//! - where it is read is a [`ShadingPoint`]: the place in the world and on the object, texture coordinates and tangents, the
//!   shading frame, and what the pixel sees of all this ([`crate::footprint`]). It is made where a material wants it only;
//! - over a footprint it has the mean of what it has at the points there, so that it doesn't flicker from afar;
//! - it is pure: the same point gives the same bits.
//!
//! To add one: its file, which implements `Pattern` and gives examples to be tested; its line in the list below; its keys in the
//! description.

use crate::lanes::{Colour, Lanes};
use std::fmt;
use std::sync::Arc;
use straal_color::Light;
use straal_math::{Frame, Transform, Vec3, ops};
use straal_scene::desc;

mod attribute;
mod between;
mod checker;
mod corners;
mod cubes;
mod dots;
mod facing;
mod graph;
mod image;
mod list;
mod maker;
mod mapping;
mod noise;
mod perlin;
mod ramp;
mod reading;
mod solid;
#[cfg(test)]
mod tests;

pub use attribute::{Attribute, MeshAttribute};
pub use checker::Checker;
pub use corners::Corners;
pub use cubes::Cubes;
pub use dots::Dots;
pub use facing::Facing;
pub use graph::{Add, Invert, Mix, Remap, Scale};
pub(crate) use image::Meaning;
pub use image::{Channel, ImageTexture, Pyramid, Sampling, Spot};
pub(crate) use maker::Maker;
pub use mapping::{InSpace, Mapping};
pub use noise::Noise;
pub use ramp::{Between, Ramp};
pub(crate) use reading::Readings;
pub use reading::{ReadRgb, Reading};
pub use solid::Solid;

/// A place, and how it moves on the surface from one pixel to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Where.
    pub p: Vec3,
    /// Change from a pixel to its neighbour to the right.
    pub dpdx: Vec3,
    /// Change from a pixel to the one below.
    pub dpdy: Vec3,
}

/// Where a value is looked up: a point of a surface and its neighbourhood.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingPoint {
    /// The place in the world.
    pub world: Place,
    /// The place in the thing's own coordinates, before all transforms of itself, its groups and instances: so that what is carved of wood
    /// turns with its grain.
    pub object: Place,
    /// The unit shading normal in the thing's own coordinates.
    pub object_n: Vec3,
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// Change of the texture coordinates from a pixel to its neighbour to the right.
    pub duvdx: [f32; 2],
    /// Change of the texture coordinates from a pixel to the one below.
    pub duvdy: [f32; 2],
    /// How the point moves with u, in the world.
    pub dpdu: Vec3,
    /// How the point moves with v, in the world.
    pub dpdv: Vec3,
    /// The direction that brushed surfaces and maps of normals follow, in the world: `dpdu`, or the mesh's own tangent.
    pub along: Vec3,
    /// What lies across it, on the side of rising v.
    pub across: Vec3,
    /// About the shading normal; its first tangent follows `along`.
    pub frame: Frame,
    /// The frame in which a material scatters that [wants a tangent](crate::material::Wants): the same, about the normal that a relief pretends.
    pub scatters: Frame,
    /// Where it is on a mesh, if it is on one.
    pub on_mesh: Option<OnMesh>,
    /// Two random numbers in [0, 1) by which textures may take one texel for the mean of many; without them they take the mean.
    pub lot: Option<[f32; 2]>,
}

/// A place on a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnMesh {
    /// Which mesh of the world.
    pub mesh: u32,
    /// Which of its triangles.
    pub triangle: u32,
    /// Barycentric weights of the triangle's vertices 1 and 2.
    pub place: [f32; 2],
}

impl ShadingPoint {
    /// Where constants are looked up.
    pub const NOWHERE: Self = Self::of([0.0; 2], Vec3::ZERO);

    /// Of which no more is known than texture coordinates and a place in the world.
    pub const fn of(uv: [f32; 2], p: Vec3) -> Self {
        let place = Place { p, dpdx: Vec3::ZERO, dpdy: Vec3::ZERO };
        Self {
            world: place,
            object: place,
            object_n: Vec3::Z,
            uv,
            duvdx: [0.0; 2],
            duvdy: [0.0; 2],
            dpdu: Vec3::X,
            dpdv: Vec3::Y,
            along: Vec3::X,
            across: Vec3::Y,
            frame: Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z },
            scatters: Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z },
            on_mesh: None,
            lot: None,
        }
    }
}

/// A normal in a thing's own coordinates, of which `m` leads to others; as it is where it would be lost.
pub(crate) fn own_normal(m: &Transform, n: Vec3) -> Vec3 {
    let own = Vec3::new(m.vector(Vec3::X).dot(n), m.vector(Vec3::Y).dot(n), m.vector(Vec3::Z).dot(n));
    own.try_normalize().unwrap_or(n)
}

/// A number or colour that may differ from point to point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<T> {
    /// The same everywhere.
    Constant(T),
    /// Read off a texture.
    Texture(TextureRef),
}

/// A texture of the world, and the most that it has anywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Its place in the world's list.
    pub id: u32,
    /// Its largest number or channel: 0 only where it is 0 all over.
    pub most: f32,
}

/// What a [`Value`] is of, and what it is read as.
pub trait Readable: Copy {
    /// A number, or light.
    type As;
    /// The largest lane.
    fn most(self) -> f32;
    /// A constant.
    fn read<L: Lanes>(self, reading: &Reading<'_, L>) -> Self::As;
    /// What a texture has at a point.
    fn of_texture<L: Lanes>(texture: &Texture, at: &ShadingPoint, reading: &Reading<'_, L>) -> Self::As;
}

impl Readable for f32 {
    type As = Self;

    #[inline(always)]
    fn most(self) -> f32 {
        self
    }

    #[inline(always)]
    fn read<L: Lanes>(self, _: &Reading<'_, L>) -> f32 {
        self
    }

    fn of_texture<L: Lanes>(texture: &Texture, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        let [least, most] = texture.range;
        ops::clamp(texture.kind.number(at, reading), least, most)
    }
}

impl Readable for Colour {
    type As = Light;

    #[inline(always)]
    fn most(self) -> f32 {
        self.strength
    }

    #[inline(always)]
    fn read<L: Lanes>(self, reading: &Reading<'_, L>) -> Light {
        reading.light(&self)
    }

    fn of_texture<L: Lanes>(texture: &Texture, at: &ShadingPoint, reading: &Reading<'_, L>) -> Light {
        let [least, most] = texture.range;
        Light(texture.kind.light(at, reading, texture.of).0.map(|v| ops::clamp(v, least, most)))
    }
}

impl<T: Readable> Value<T> {
    /// The largest lane that it has anywhere: 0 only where it is 0 all over.
    #[inline(always)]
    pub fn most(&self) -> f32 {
        match self {
            Self::Constant(v) => v.most(),
            Self::Texture(t) => t.most,
        }
    }

    /// Whether it differs from point to point.
    #[inline(always)]
    pub fn varies(&self) -> bool {
        matches!(self, Self::Texture(_))
    }
}

impl<T> From<T> for Value<T> {
    fn from(v: T) -> Self {
        Self::Constant(v)
    }
}

/// A colour in RGB alone.
impl From<Light> for Value<Colour> {
    fn from(v: Light) -> Self {
        Self::Constant(v.into())
    }
}

impl<L: Lanes> Reading<'_, L> {
    /// A number, or light, at a point. `at` may be [`ShadingPoint::NOWHERE`] where nothing [varies](Value::varies).
    #[inline(always)]
    pub fn eval<T: Readable>(&self, value: &Value<T>, at: &ShadingPoint) -> T::As {
        match value {
            Value::Constant(v) => v.read(self),
            Value::Texture(texture) => self.look_up::<T>(texture.id, at),
        }
    }

    /// What a colour is as a number: of a constant one its red, of a texture what it has for a number.
    #[inline]
    pub fn number(&self, value: &Value<Colour>, at: &ShadingPoint) -> f32 {
        match value {
            Value::Constant(colour) => colour.rgb[0],
            Value::Texture(texture) => self.look_up::<f32>(texture.id, at),
        }
    }

    /// Out of the way of constants.
    #[cold]
    #[inline(never)]
    fn look_up<T: Readable>(&self, id: u32, at: &ShadingPoint) -> T::As {
        T::of_texture(&self.textures[id as usize], at, self)
    }
}

/// What a texture's colours are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Shares of the light that arrives, 0 to 1.
    Reflectance,
    /// Light that is sent out.
    Emission,
    /// Numbers by wavelength that are no colours, such as indices of refraction.
    Coefficient,
}

impl Use {
    /// Linear sRGB as light.
    fn read<L: Lanes>(self, rgb: [f32; 3], reading: &Reading<'_, L>) -> Light {
        match self {
            Self::Reflectance => reading.reflectance_of_srgb(rgb),
            Self::Emission => reading.emission_of_srgb(rgb),
            Self::Coefficient => reading.lanes.coefficient_of_rgb(reading.tables, Light::rgb(rgb)),
        }
    }
}

/// A texture of a world.
#[derive(Clone, Debug)]
pub struct Texture {
    /// What it has where.
    pub kind: TextureKind,
    /// What its colours are; unused where it is read as a number.
    pub of: Use,
    /// Between which its numbers and lanes are kept: a picture may have more than a surface can send back.
    pub range: [f32; 2],
}

impl Texture {
    /// Shares of light are kept from 0 to 1, light and numbers above 0.
    pub fn new(kind: TextureKind, of: Use) -> Self {
        let most = if of == Use::Reflectance { 1.0 } else { f32::MAX };
        Self { kind, of, range: [0.0, most] }
    }

    /// Whether it draws texels where it may: see [`ShadingPoint::lot`].
    pub(crate) fn draws(&self) -> bool {
        matches!(&self.kind, TextureKind::Image(image) if image.sampling.draws())
    }
}

list::textures! {
    /// Squares of two colours in turn.
    Checker(Checker),
    /// A picture.
    Image(ImageTexture),
    /// What a mesh has at its vertices or on its faces.
    Attribute(Attribute),
    /// A texture times a number and a colour.
    Scale(Scale),
    /// Between two.
    Mix(Mix),
    /// The sum of two.
    Add(Add),
    /// What is missing to 1.
    Invert(Invert),
    /// From one range to another.
    Remap(Remap),
    /// A colour for each number.
    Ramp(Ramp),
    /// Sums of noises.
    Noise(Noise),
    /// Cubes of two colours in turn.
    Cubes(Cubes),
    /// Discs of one colour on another.
    Dots(Dots),
    /// Between four colours.
    Corners(Corners),
    /// Two colours by the way that a surface faces.
    Facing(Facing),
}

/// What a kind of texture has where, by [the contract](self).
trait Pattern: Sized {
    /// Light at a point, or a share of it; over the point's footprint the mean.
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, of: Use) -> Light;

    /// A number at a point; over the point's footprint the mean.
    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32;

    /// The largest number or lane that it has anywhere.
    fn most(&self) -> f32;

    /// Some for the tests of the contract.
    #[cfg(test)]
    fn examples() -> Vec<Self>;
}

/// A texture that a user of the library brings. It is pure: the same input gives the same bits.
pub trait CustomTexture: fmt::Debug + Send + Sync {
    /// Linear sRGB at a point.
    fn rgb(&self, at: &ShadingPoint) -> [f32; 3];
    /// A number at a point: its red, unless it says otherwise.
    fn number(&self, at: &ShadingPoint) -> f32 {
        self.rgb(at)[0]
    }
    /// A number that differs when the texture does: it goes into the scene's hash.
    fn fingerprint(&self) -> u64;
}
