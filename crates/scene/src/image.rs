//! Pictures as assets of a scene.

/// A picture in linear RGB, row by row from the top, as an environment map or texture is handed to the renderer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Width in pixels, at least 1.
    pub width: usize,
    /// Height in pixels, at least 1.
    pub height: usize,
    /// `width * height` pixels.
    pub pixels: Vec<[f32; 3]>,
}

impl Image {
    /// Whether it has pixels, and as many as it says.
    pub fn is_whole(&self) -> bool {
        !self.pixels.is_empty() && self.width.checked_mul(self.height) == Some(self.pixels.len())
    }

    /// Bytes of its pixels.
    pub fn heap_bytes(&self) -> u64 {
        size_of_val(self.pixels.as_slice()) as u64
    }
}
