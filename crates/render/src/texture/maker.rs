//! What a texture is made with.

use std::sync::Arc;

use straal_scene::value::Asset;
use straal_scene::{Bitmap, desc};

use super::solid::Solid;
use super::{Mapping, Meaning, Pyramid, Value};
use crate::lanes::Colour;

/// Makes the parts of a texture of what a scene says of it.
pub(crate) trait Maker {
    /// A colour or texture that this one is made of, as it is: what comes of all is kept in range at the end.
    fn part(&mut self, v: &desc::Varying<desc::Spectrum>) -> Value<Colour>;

    /// A share of light that this one is multiplied by.
    fn share(&mut self, v: &desc::Varying<desc::Spectrum>) -> Value<Colour>;

    /// A number that this one is made of.
    fn number(&mut self, v: &desc::Varying<f64>) -> Value<f32>;

    /// The number of what meshes have, by its name.
    fn attribute(&mut self, name: &str) -> u32;

    /// How it lies on a surface.
    fn mapping(&mut self, said: &desc::Mapping) -> Mapping;

    /// Where a pattern of space lies.
    fn solid(&mut self, space: &desc::MappingSpace, transform: &desc::Transform) -> Solid;

    /// A colour, or of what is read as a number, its numbers.
    fn colour(&mut self, s: &desc::Spectrum) -> Colour;

    /// Whether the texture is read as a number.
    fn wants_number(&self) -> bool;

    /// What a picture is read off; made once, however often it is used.
    fn pyramid(&mut self, asset: &Asset<Bitmap>, meaning: &Meaning, has_smaller: bool) -> Arc<Pyramid>;
}
