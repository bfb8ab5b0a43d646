//! Numbers and colours of materials and lights.

use straal_math::Vec3;

/// Where a value is looked up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TexturePoint {
    /// Surface coordinates.
    pub uv: [f32; 2],
    /// Place in the world.
    pub p: Vec3,
}

/// A number or colour that may differ from point to point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<T> {
    /// The same everywhere.
    Constant(T),
}

impl<T: Copy> Value<T> {
    /// The value at a point.
    #[inline(always)]
    pub fn eval(&self, _at: &TexturePoint) -> T {
        match self {
            Self::Constant(v) => *v,
        }
    }
}

impl<T> From<T> for Value<T> {
    fn from(v: T) -> Self {
        Self::Constant(v)
    }
}

/// A colour in RGB alone.
impl From<straal_color::Light> for Value<crate::lanes::Colour> {
    fn from(v: straal_color::Light) -> Self {
        Self::Constant(v.into())
    }
}
