//! # Relief
//!
//! Normal maps and bump maps: a surface that stays where it is, but is lit as if it were rough.
//!
//! A *normal map* (Cohen et al. 1998; Peercy et al. 1997) has a direction for each point, n = 2 rgb - 1, in the frame of the surface: x along
//! increasing u, y along increasing v, z outwards. So pictures have it for whom green is up, as glTF and OpenGL do; for DirectX green is down. Or it has
//! directions in the thing's own space.
//!
//! A *bump map* (Blinn 1978, "Simulation of Wrinkled Surfaces") has a height h for each point, and its slopes tilt the normal: what would be the surface
//! moves with u by p_u + n (h_u - n.p_u), with v by p_v + n (h_v - n.p_v), and the normal is across both. Slopes are
//! differences over half of what a pixel sees, so that the heights of any texture will do, and those from afar are level.
//!
//! What a tilted normal would do wrong, light from behind and into the surface, is seen to in one place for all shading normals:
//! [`crate::material::shaded`].

use straal_math::{Frame, Vec3, ops};
use straal_scene::desc;

use crate::lanes::{Colour, Rgb, SpectralTables};
use crate::paint::Paint;
use crate::surface::frame_along;
use crate::texture::{OnMesh, Place, Reading, ShadingPoint, Value};
use std::sync::LazyLock;

/// What a surface pretends to be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Relief {
    /// Its normals.
    pub normals: Option<NormalMap>,
    /// Its heights, on top of these.
    pub heights: Option<BumpMap>,
}

/// Normals read off a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// From 0 to 1 what they are from -1 to 1.
    pub texture: Value<Colour>,
    /// Whether they are of the thing's own space; else of the surface's frame.
    pub of_object: bool,
    /// 1, or -1 where green is down.
    pub up: f32,
    /// What their slopes are multiplied by.
    pub strength: f32,
}

/// Heights read off a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumpMap {
    /// In units of `scale`.
    pub texture: Value<f32>,
    /// Metres of the world for 1.
    pub scale: f32,
}

/// Ways between the world and a thing's own space.
pub(crate) struct Ways<N, V> {
    /// A normal, outwards.
    pub normal_to_world: N,
    /// A vector, inwards.
    pub vector_to_object: V,
}

/// By these, numbers are read as they are.
static NO_TABLES: LazyLock<SpectralTables> = LazyLock::new(SpectralTables::default);

impl Relief {
    /// Of what a scene says; `None` where there is none.
    pub(crate) fn of(said: &desc::Relief, paint: &mut Paint<'_>) -> Option<Self> {
        let mut relief = Self::default();
        if let Some(map) = &said.normal_map {
            relief.normals = Some(NormalMap {
                texture: paint.vector(&map.texture),
                of_object: map.space == desc::NormalSpace::Object,
                up: if map.green == desc::GreenAxis::Up { 1.0 } else { -1.0 },
                strength: map.strength as f32,
            });
        }
        if let Some(bump) = &said.bump {
            relief.heights =
                Some(BumpMap { texture: paint.height(&bump.texture), scale: bump.height as f32 });
        }
        (relief != Self::default()).then_some(relief)
    }

    /// The unit normal that is pretended where the surface has `n`.
    pub(crate) fn normal(
        &self,
        n: Vec3,
        at: &ShadingPoint,
        reading: &Reading<'_, Rgb>,
        ways: &Ways<impl Fn(Vec3) -> Vec3, impl Fn(Vec3) -> Vec3>,
    ) -> Vec3 {
        let reading = as_numbers(reading);
        let mut out = n;
        if let Some(map) = &self.normals {
            out = if map.of_object {
                let told = map.told(at, &reading);
                let towards = (ways.normal_to_world)(told).try_normalize().unwrap_or(n);
                (n + (towards - n) * map.strength).try_normalize().unwrap_or(n)
            } else {
                map.about(n, at, &reading)
            };
        }
        if let Some(bump) = &self.heights {
            out = bump.tilted(out, at, &reading, ways);
        }
        out
    }
}

impl NormalMap {
    /// The direction that the texture has, not of unit length.
    fn told(&self, at: &ShadingPoint, reading: &Reading<'_, Rgb>) -> Vec3 {
        let v = reading.eval(&self.texture, at);
        Vec3::new(2.0 * v[0] - 1.0, 2.0 * v[1] - 1.0, 2.0 * v[2] - 1.0)
    }

    /// The unit normal that is told in the frame of a surface whose normal is `n`.
    fn about(&self, n: Vec3, at: &ShadingPoint, reading: &Reading<'_, Rgb>) -> Vec3 {
        let told = self.told(at, reading);
        let Frame { s, t, .. } = frame_along(n, at.along);
        // On the side of growing v: textures may be mirrored.
        let side = if t.dot(at.across) < 0.0 { -1.0 } else { 1.0 };
        let slope = self.strength;
        let found = s * (told.x * slope) + t * (told.y * slope * self.up * side) + n * told.z;
        found.try_normalize().unwrap_or(n)
    }
}

/// The way that a surface is brushed: the direction along which it is rougher, about the one that its points follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brushing {
    /// Red and green from 0 to 1 are the direction along that and across it from -1 to 1.
    pub direction: Option<Value<Colour>>,
    /// By which it is turned further, counter-clockwise.
    pub turn: Turn,
}

/// An angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// The same everywhere, by its cosine and sine.
    Constant([f32; 2]),
    /// In degrees.
    Texture(Value<f32>),
}

impl Brushing {
    /// As the points of the surface have it.
    pub const STRAIGHT: Self = Self { direction: None, turn: Turn::Constant([1.0, 0.0]) };

    pub(crate) fn of(
        direction: Option<&desc::TextureOf>,
        degrees: &desc::Varying<f64>,
        paint: &mut Paint<'_>,
    ) -> Self {
        let turn = match degrees {
            desc::Varying::Constant(degrees) => {
                let (sin, cos) = ops::sin_cos_degrees(*degrees);
                Turn::Constant([cos as f32, sin as f32])
            }
            desc::Varying::Texture(t) => Turn::Texture(paint.height(t)),
        };
        Self { direction: direction.map(|t| paint.vector(t)), turn }
    }

    /// The unit vector at a point, in the frame that scatters.
    pub(crate) fn at<L>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> [f32; 2] {
        let [c, s] = match &self.turn {
            Turn::Constant(turn) => *turn,
            Turn::Texture(degrees) => {
                let (sin, cos) = ops::sin_cos_degrees(f64::from(as_numbers(reading).eval(degrees, at)));
                [cos as f32, sin as f32]
            }
        };
        let [mut x, mut y] = [c, s];
        if let Some(direction) = &self.direction {
            let v = as_numbers(reading).eval(direction, at);
            let [u, v] = [2.0 * v[0] - 1.0, 2.0 * v[1] - 1.0];
            let length = (u * u + v * v).sqrt();
            // A picture without directions turns nothing.
            if length > 1e-3 {
                [x, y] = [(c * u - s * v) / length, (s * u + c * v) / length];
            }
        }
        let side = if at.scatters.t.dot(at.across) < 0.0 { -1.0 } else { 1.0 };
        [x, y * side]
    }
}

/// Which normals a coat has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CoatNormals {
    /// Those of what lies below, with all that its relief pretends.
    Base,
    /// Those of the surface, without a relief.
    Surface,
    /// Those that a map of its own tells.
    Map(NormalMap),
}

impl CoatNormals {
    pub(crate) fn of(said: &desc::CoatNormal, paint: &mut Paint<'_>) -> Self {
        match said {
            desc::CoatNormal::Base => Self::Base,
            desc::CoatNormal::Surface => Self::Surface,
            desc::CoatNormal::Map(map) => Self::Map(NormalMap {
                texture: paint.vector(&map.texture),
                of_object: false,
                up: if map.green == desc::GreenAxis::Up { 1.0 } else { -1.0 },
                strength: map.strength as f32,
            }),
        }
    }

    /// The unit normal in the frame that scatters; `None` where it is the base's.
    pub(crate) fn at<L>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> Option<Vec3> {
        let n = at.frame.n;
        let n = match self {
            Self::Base => return None,
            Self::Surface => n,
            Self::Map(map) => map.about(n, at, &as_numbers(reading)),
        };
        (n != at.scatters.n).then(|| at.scatters.to_local(n))
    }
}

/// Reads numbers as they are, whatever is read besides.
fn as_numbers<'a, L>(reading: &Reading<'a, L>) -> Reading<'a, Rgb> {
    let Reading { textures, meshes, .. } = *reading;
    Reading { tables: &NO_TABLES, lanes: Rgb::default(), textures, meshes }
}

impl BumpMap {
    fn tilted(
        &self,
        n: Vec3,
        at: &ShadingPoint,
        reading: &Reading<'_, Rgb>,
        ways: &Ways<impl Fn(Vec3) -> Vec3, impl Fn(Vec3) -> Vec3>,
    ) -> Vec3 {
        let slope = |k: usize, along: Vec3| {
            /// Where nothing is known of what a pixel sees.
            const LEAST: f32 = 1e-4;
            let step = ops::max(0.25 * (at.duvdx[k].abs() + at.duvdy[k].abs()), LEAST);
            let inside = (ways.vector_to_object)(along);
            let height = |step: f32| {
                let moved = |place: &Place, along: Vec3| Place { p: place.p + along * step, ..*place };
                let mut uv = at.uv;
                uv[k] += step;
                let on_mesh = at.on_mesh.map(|on| {
                    let duv = [0, 1].map(|i| if i == k { step } else { 0.0 });
                    let [du, dv] = reading
                        .meshes
                        .get(on.mesh as usize)
                        .map_or(duv, |mesh| mesh.place_change(on.triangle, duv));
                    OnMesh { place: [on.place[0] + du, on.place[1] + dv], ..on }
                });
                let point = ShadingPoint {
                    uv,
                    on_mesh,
                    world: moved(&at.world, along),
                    object: moved(&at.object, inside),
                    ..*at
                };
                reading.eval(&self.texture, &point)
            };
            (height(step) - height(-step)) * (0.5 * self.scale / step)
        };
        let moved = |along: Vec3, slope: f32| along + n * (slope - n.dot(along));
        let u = moved(at.dpdu, slope(0, at.dpdu));
        let v = moved(at.dpdv, slope(1, at.dpdv));
        let across = u.cross(v);
        let side = if at.dpdu.cross(at.dpdv).dot(n) < 0.0 { -1.0 } else { 1.0 };
        (across * side).try_normalize().filter(|n| n.is_finite()).unwrap_or(n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::{CustomTexture, Texture, TextureKind, TextureRef, Use};
    use std::sync::Arc;

    /// A height that grows by 0.3 with u and by -0.4 with v; or a direction.
    #[derive(Debug)]
    struct Slope(Option<[f32; 3]>);

    impl CustomTexture for Slope {
        fn rgb(&self, at: &ShadingPoint) -> [f32; 3] {
            self.0.unwrap_or([0.3 * at.uv[0] - 0.4 * at.uv[1]; 3])
        }
        fn fingerprint(&self) -> u64 {
            3
        }
    }

    fn normal(relief: &Relief, texture: Slope, at: &ShadingPoint, n: Vec3) -> Vec3 {
        let kind = TextureKind::Custom(Arc::new(texture));
        let textures = [Texture { range: [f32::MIN, f32::MAX], ..Texture::new(kind, Use::Reflectance) }];
        let reading = Reading { textures: &textures, ..crate::testing::in_rgb() };
        // The thing lies on its side.
        let turned = |v: Vec3| Vec3::new(v.z, v.x, v.y);
        relief.normal(n, at, &reading, &Ways { normal_to_world: turned, vector_to_object: |v: Vec3| v })
    }

    const TEXTURE: TextureRef = TextureRef { id: 0, most: 1.0 };

    fn near(a: Vec3, b: Vec3) {
        assert!((a - b).length() < 2e-4, "{a:?}, not {b:?}");
    }

    #[test]
    fn heights_tilt_the_normal_as_a_real_slope_would() {
        let bump = BumpMap { texture: Value::Texture(TEXTURE), scale: 2.0 };
        let relief = Relief { heights: Some(bump), ..Relief::default() };
        let at = ShadingPoint { dpdu: Vec3::X, dpdv: Vec3::Y, ..ShadingPoint::of([0.3, 0.6], Vec3::ZERO) };
        // The plane z = 0.6 x - 0.8 y.
        near(normal(&relief, Slope(None), &at, Vec3::Z), Vec3::new(-0.6, 0.8, 1.0).normalize());
        // From behind the same slopes are the other way; a coordinate that runs twice as fast makes slopes as steep.
        near(normal(&relief, Slope(None), &at, -Vec3::Z), Vec3::new(-0.6, 0.8, -1.0).normalize());
        let fast = ShadingPoint { dpdu: Vec3::X * 0.5, ..at };
        near(normal(&relief, Slope(None), &fast, Vec3::Z), Vec3::new(-1.2, 0.8, 1.0).normalize());
    }

    #[test]
    fn normals_are_of_the_frame_that_was_said() {
        let map = NormalMap { texture: Value::Texture(TEXTURE), of_object: false, up: 1.0, strength: 1.0 };
        let with = |map: NormalMap| Relief { normals: Some(map), ..Relief::default() };
        let at = ShadingPoint { along: Vec3::Y * 3.0, across: -Vec3::X, ..ShadingPoint::NOWHERE };
        let told = Vec3::new(0.6, 0.48, 0.64);
        let rgb = || Slope(Some(told.to_array().map(|v| 0.5 * v + 0.5)));
        near(normal(&with(map), rgb(), &at, Vec3::Z), Vec3::new(-0.48, 0.6, 0.64));
        let directx = NormalMap { up: -1.0, ..map };
        near(normal(&with(directx), rgb(), &at, Vec3::Z), Vec3::new(0.48, 0.6, 0.64));
        // A mirrored texture.
        let mirrored = ShadingPoint { across: Vec3::X, ..at };
        near(normal(&with(map), rgb(), &mirrored, Vec3::Z), Vec3::new(0.48, 0.6, 0.64));
        let flat = NormalMap { strength: 0.0, ..map };
        near(normal(&with(flat), rgb(), &at, Vec3::Z), Vec3::Z);
        let of_object = NormalMap { of_object: true, ..map };
        near(normal(&with(of_object), rgb(), &at, Vec3::Z), Vec3::new(0.64, 0.6, 0.48));
        // A texture without directions leaves the surface as it is.
        near(normal(&with(map), Slope(Some([0.5; 3])), &at, Vec3::Z), Vec3::Z);
    }
}
