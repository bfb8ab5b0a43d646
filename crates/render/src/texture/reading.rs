//! Lanes with the tables they read by.

use straal_color::Light;

use super::Texture;
use crate::lanes::{Colour, Lanes, SpectralTables};

/// Lanes and the tables they read by.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'w, L> {
    /// The tables.
    pub tables: &'w SpectralTables,
    /// The lanes.
    pub lanes: L,
    /// What values that differ from point to point are read off.
    pub textures: &'w [Texture],
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
