//! # Image
//!
//! A picture over the texture coordinates: its lower edge lies at v = 0, its left one at u = 0. Its numbers stay as its file has them and
//! become light when they are read, and it is read together with smaller copies of itself, so that what is far away neither
//! flickers nor costs more than what is near. [`filter`](Sampling) says how.

use std::sync::Arc;

use straal_color::{Light, luminance};
use straal_scene::desc::{self, TextureChannel};

use super::{Maker, Mapping, Pattern, Reading, ShadingPoint, Use};
use crate::lanes::Lanes;
use crate::shape::TriangleMesh;

mod filter;
mod pyramid;

pub use filter::{Sampling, Spot};
pub(crate) use pyramid::Meaning;
pub use pyramid::Pyramid;

/// A picture.
#[derive(Clone, Debug)]
pub struct ImageTexture {
    /// What it is read off.
    pub pyramid: Arc<Pyramid>,
    /// How.
    pub sampling: Sampling,
    /// Which number is taken where one is wanted.
    pub channel: Channel,
    /// How it lies on the surface.
    pub mapping: Mapping,
}

/// One number of a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// How bright it is.
    Luminance,
    /// Red, green, blue or alpha, by its place.
    Number(usize),
}

impl Channel {
    pub(super) fn of(said: &TextureChannel) -> Self {
        match said {
            TextureChannel::Luminance => Self::Luminance,
            TextureChannel::Red => Self::Number(0),
            TextureChannel::Green => Self::Number(1),
            TextureChannel::Blue => Self::Number(2),
            TextureChannel::Alpha => Self::Number(3),
        }
    }
}

impl ImageTexture {
    /// Of what a scene says.
    pub(super) fn of(d: &desc::ImageTexture, make: &mut dyn Maker) -> Self {
        let sampling = Sampling::of(&d.filter, &d.wrap.0, d.anisotropy);
        let channel = Channel::of(&d.channel);
        let meaning = Meaning::of(&d.color_space, make.wants_number());
        let pyramid = make.pyramid(&d.file, &meaning, sampling.needs_smaller());
        Self { pyramid, sampling, channel, mapping: make.mapping(&d.mapping) }
    }

    /// Linear sRGB and alpha.
    #[inline]
    pub fn rgba(&self, at: &ShadingPoint, meshes: &[TriangleMesh]) -> [f32; 4] {
        self.mapping.over(at, meshes, |spot| self.sampling.look_up(&self.pyramid, spot))
    }
}

impl Pattern for ImageTexture {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, of: Use) -> Light {
        let [r, g, b, _] = self.rgba(at, reading.meshes);
        of.read([r, g, b], reading)
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        let rgba = self.rgba(at, reading.meshes);
        match self.channel {
            Channel::Luminance if rgba[0] == rgba[1] && rgba[1] == rgba[2] => rgba[0],
            Channel::Luminance => luminance([rgba[0], rgba[1], rgba[2]]),
            Channel::Number(channel) => rgba[channel],
        }
    }

    fn most(&self) -> f32 {
        let colours = self.pyramid.most();
        if self.channel == Channel::Number(3) && colours < 1.0 { 1.0 } else { colours }
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        tests::examples()
    }
}

#[cfg(test)]
mod tests;
