//! Lanes with the tables they read by.

use straal_color::Light;
use straal_math::simd::Float;

use super::{ShadingPoint, Texture, Value};
use crate::lanes::{Colour, Lanes, SpectralTables};
use crate::shape::TriangleMesh;

/// Lanes and the tables they read by.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'w, L> {
    /// The tables.
    pub tables: &'w SpectralTables,
    /// The lanes.
    pub lanes: L,
    /// What values that differ from point to point are read off.
    pub textures: &'w [Texture],
    /// What these read of meshes.
    pub meshes: &'w [TriangleMesh],
}

impl<L: Lanes> Reading<'_, L> {
    /// A colour of the scene.
    #[inline(always)]
    pub fn light(&self, colour: &Colour) -> Light {
        self.lanes.light(self.tables, colour)
    }

    /// A pixel of a picture of radiance.
    #[inline(always)]
    pub fn radiance_of_rgb(&self, rgb: Light) -> Light {
        self.lanes.radiance_of_rgb(self.tables, rgb)
    }

    /// Shares of light of linear sRGB. What the work space doesn't hold is cut off.
    pub fn reflectance_of_srgb(&self, rgb: [f32; 3]) -> Light {
        self.lanes.reflectance_of_rgb(self.tables, self.tables.held(rgb))
    }

    /// Light of linear sRGB. What the work space doesn't hold is cut off.
    pub fn emission_of_srgb(&self, rgb: [f32; 3]) -> Light {
        self.lanes.radiance_of_rgb(self.tables, self.tables.held(rgb))
    }
}

/// How many paths side by side read colours, each by its own lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Readings<'a, L> {
    /// The tables, and what else is the same for all.
    pub tables: &'a SpectralTables,
    /// What values that differ from point to point are read off.
    pub textures: &'a [Texture],
    /// What these read of meshes.
    pub meshes: &'a [TriangleMesh],
    /// By path.
    pub lanes: &'a [L],
}

impl<'a, L: Lanes> Readings<'a, L> {
    /// Of a single path.
    #[inline(always)]
    pub fn one(reading: &'a Reading<'_, L>) -> Self {
        Self {
            tables: reading.tables,
            textures: reading.textures,
            meshes: reading.meshes,
            lanes: std::slice::from_ref(&reading.lanes),
        }
    }

    /// How one of them reads.
    #[inline(always)]
    pub fn of(&self, i: usize) -> Reading<'a, L> {
        Reading { tables: self.tables, lanes: self.lanes[i], textures: self.textures, meshes: self.meshes }
    }

    /// From path `first` on.
    #[inline(always)]
    pub fn from(&self, first: usize) -> Self {
        Self { lanes: &self.lanes[first..], ..*self }
    }

    /// Light at a place that is the same for all.
    #[inline(always)]
    pub fn eval<F: Float>(&self, value: &Value<Colour>, at: &ShadingPoint) -> Light<F> {
        match value {
            Value::Constant(colour) => self.light(colour),
            Value::Texture(_) => Light::from_fn(
                #[inline(always)]
                |i| self.of(i).eval(value, at),
            ),
        }
    }

    /// A colour of the scene.
    #[inline(always)]
    pub fn light<F: Float>(&self, colour: &Colour) -> Light<F> {
        L::lights(self.lanes, self.tables, colour)
    }

    /// Pixels of a picture of radiance.
    #[inline(always)]
    pub fn radiance_of_rgb<F: Float>(&self, rgb: Light<F>) -> Light<F> {
        L::radiances_of_rgb(self.lanes, self.tables, rgb)
    }
}

/// What a material of the library's user reads its colours by.
pub trait ReadRgb {
    /// The reflectance of linear sRGB, from 0 to 1, as light.
    fn reflectance(&self, rgb: [f32; 3]) -> Light;
}

impl<L: Lanes> ReadRgb for Reading<'_, L> {
    fn reflectance(&self, rgb: [f32; 3]) -> Light {
        self.reflectance_of_srgb(rgb)
    }
}
