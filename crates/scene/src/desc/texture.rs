//! Textures, and the values that may be read off them.

use straal_math::DVec3;

use crate::Bitmap;
use crate::decode::Describe;
use crate::desc::check;
use crate::desc::spectrum::Spectrum;
use crate::desc::transform::Transform;
use crate::describe::describe;
use crate::limit::Limit;
use crate::span::Span;
use crate::value::{Asset, Link, Name};
use crate::visit::Visitor;

describe! {
    /// What differs from point to point of a surface.
    pub enum Texture {
        /// Squares of two colours in turn, over the texture coordinates.
        "checker" => Checker(struct Checker {
            /// The colour of the square next to the origin, and of every other.
            first: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.2)),
            /// The colour of the rest.
            second: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.8)),
            /// How many squares there are from 0 to 1, across and up.
            squares: [f64; 2] [Limit::within(1e-6, 1e6)] = [8.0, 8.0],
            /// Whether it is averaged over what a pixel sees; else it is looked up at points.
            averaged: bool = true,
            /// How it lies on the surface.
            mapping: Mapping = Mapping::default(),
        }),
        /// A picture.
        "image" => Image(struct ImageTexture {
            /// The picture: PNG, JPEG, WebP, TGA, BMP, KTX2, EXR, HDR or PFM.
            file: Asset<Bitmap>,
            /// What its numbers mean.
            color_space: TextureSpace = TextureSpace::Auto,
            /// Which of its numbers is taken where one is wanted, such as a roughness.
            channel: TextureChannel = TextureChannel::Luminance,
            /// How it is read between its pixels, and where many of them are seen as one.
            filter: TextureFilter = TextureFilter::Ewa,
            /// The most that a pixel's view of it may be longer than wide before `ewa` blurs it.
            anisotropy: f64 [Limit::within(1.0, 64.0)] = 16.0,
            /// What is beyond its edges: one of these, or a list of two, for left and right and for below and above.
            wrap: Wraps = Wraps([Wrap::Repeat, Wrap::Repeat]),
            /// How it lies on the surface.
            mapping: Mapping = Mapping::default(),
        }),
        /// What a mesh has at its vertices or on its faces, such as colours.
        "attribute" => Attribute(struct AttributeTexture {
            /// Its name: `color`, or the name of a property of the mesh's file.
            name: AttributeName = AttributeName(Name::new("color".to_owned(), Span::NONE)),
            /// Whether vertices or faces have it, where both have something of that name.
            per: AttributePer = AttributePer::Any,
            /// What its numbers mean; `auto` takes codes of bytes for sRGB and other numbers for light, where a colour is wanted.
            color_space: TextureSpace = TextureSpace::Auto,
            /// Which of its numbers is taken where one is wanted.
            channel: TextureChannel = TextureChannel::Luminance,
            /// The colour of surfaces that have no such thing.
            absent: Spectrum [Limit::UNIT] = Spectrum::grey(0.5),
        }),
        /// A texture or colour times a number and a colour.
        "scale" => Scale(struct ScaleTexture {
            /// What is multiplied.
            of: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(1.0)),
            /// The number.
            by: Varying<f64> [Limit::NON_NEGATIVE] = Varying::Constant(1.0),
            /// The colour.
            tint: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
        }),
        /// Something between two textures or colours.
        "mix" => Mix(struct MixTexture {
            /// What there is at an amount of 0.
            first: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.0)),
            /// What there is at an amount of 1.
            second: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(1.0)),
            /// The share of the second.
            amount: Varying<f64> [Limit::UNIT] = Varying::Constant(0.5),
        }),
        /// The sum of two textures or colours.
        "add" => Add(struct AddTexture {
            /// One.
            first: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.0)),
            /// The other.
            second: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.0)),
        }),
        /// What is missing to 1.
        "invert" => Invert(struct InvertTexture {
            /// Of what.
            of: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.0)),
        }),
        /// Each number of a texture or colour, from one range to another.
        "remap" => Remap(struct RemapTexture [check::remap] {
            /// Of what.
            of: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.0)),
            /// The numbers that become the two of `to`; what is beyond them is cut off.
            from: [f64; 2] = [0.0, 1.0],
            /// The two numbers that those of `from` become.
            to: [f64; 2] = [0.0, 1.0],
            /// The share of the way from the first to the second is raised to this power.
            power: f64 [Limit::within(0.01, 100.0)] = 1.0,
        }),
        /// A colour for each number.
        "ramp" => Ramp(struct RampTexture [check::ramp] {
            /// The number.
            of: Varying<f64>,
            /// Numbers that don't fall, and the colour of each.
            stops: Vec<RampStop>,
            /// What lies between two stops.
            interpolation: RampInterpolation = RampInterpolation::Linear,
        }),
        /// Sums of Perlin's noise, each finer and lower than the one before: a number for each place in space.
        "noise" => Noise(struct NoiseTexture {
            /// What is made of it.
            form: NoiseForm = NoiseForm::Fbm,
            /// How many noises there are.
            octaves: u32 [Limit::within(1.0, 16.0)] = 8,
            /// By how much each is lower than the one before.
            roughness: f64 [Limit::UNIT] = 0.5,
            /// Of marble: how far its layers are bent.
            variation: f64 [Limit::within(-1e3, 1e3)] = 0.2,
            /// Whose places they are.
            space: MappingSpace = MappingSpace::Object,
            /// Where it lies; the coarsest features are as large as 1.
            transform: Transform = Transform::default(),
        }),
        /// Cubes of two colours in turn, as if the thing were cut from them.
        "cubes" => Cubes(struct CubesTexture {
            /// The colour of the cube from 0 to 1, and of every other.
            first: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.2)),
            /// The colour of the rest.
            second: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.8)),
            /// Whose places they are.
            space: MappingSpace = MappingSpace::Object,
            /// Where they lie; a cube's side is 1.
            transform: Transform = Transform::default(),
        }),
        /// Discs of one colour on another, in about half of the squares of a grid.
        "dots" => Dots(struct DotsTexture {
            /// The colour of the discs.
            inside: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.2)),
            /// The colour around them.
            outside: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.8)),
            /// How the grid, whose squares are of side 1, lies on the surface.
            mapping: Mapping = Mapping::default(),
        }),
        /// Four colours at the corners of a square, and what lies between them.
        "corners" => Corners(struct CornersTexture {
            /// The colour at u = 0, v = 0.
            v00: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.0)),
            /// The colour at u = 1, v = 0.
            v10: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.0)),
            /// The colour at u = 0, v = 1.
            v01: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(1.0)),
            /// The colour at u = 1, v = 1.
            v11: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(1.0)),
            /// How it lies on the surface.
            mapping: Mapping = Mapping::default(),
        }),
        /// One colour where the surface lies across a direction, another where it lies along it, and what is between.
        "facing" => Facing(struct FacingTexture {
            /// The colour where the normal is along `direction`.
            first: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.8)),
            /// The colour where it is across.
            second: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.2)),
            /// The direction.
            direction: DVec3 = DVec3::Y,
            /// Whose direction it is.
            space: MappingSpace = MappingSpace::World,
        }),
    }
}

describe! {
    /// What is made of noises.
    pub enum NoiseForm {
        /// Their sum, which may be below 0: clouds.
        "fbm" => Fbm,
        /// Their sum without signs: creases.
        "wrinkled" => Wrinkled,
        /// Waves of water, which are higher where the wind is: its octaves and roughness are its own.
        "windy" => Windy,
        /// Layers along y that noise bends, from 0 to 1: for a `ramp`.
        "marble" => Marble,
    }
}

describe! {
    /// What of a mesh has an attribute.
    pub enum AttributePer {
        /// Vertices, and where these have none, faces.
        "any" => Any,
        /// Vertices.
        "vertex" => Vertex,
        /// Faces.
        "face" => Face,
    }
}

describe! {
    /// A colour of a ramp.
    pub struct RampStop {
        /// The number.
        at: f64,
        /// Its colour.
        color: Spectrum [Limit::NON_NEGATIVE],
    }
}

describe! {
    /// What lies between two stops of a ramp.
    pub enum RampInterpolation {
        /// The colour of the lower one.
        "step" => Step,
        /// A straight line from one to the other.
        "linear" => Linear,
        /// A curve from one to the other that is level at both.
        "smooth" => Smooth,
    }
}

describe! {
    /// How a pattern lies on a surface. All but `uv` and `attribute` map places of space: onto things about the origin, from -1 to 1 and upright along y, with the middle
    /// of the picture in front, towards +z; `transform` puts these elsewhere.
    pub enum Mapping {
        /// By the surface's texture coordinates, scaled, then turned, then moved.
        "uv" => Uv(struct UvMapping {
            /// What u and v are multiplied by: 2 shows the pattern twice, in half the size.
            scale: [f64; 2] = [1.0, 1.0],
            /// Degrees, counter-clockwise, about the origin of the texture coordinates.
            rotate: f64 = 0.0,
            /// What is added to u and v.
            translate: [f64; 2] = [0.0, 0.0],
        }),
        /// By other texture coordinates than the surface's own, which the mesh has by name: a further set of a file, such as `uv1`.
        "attribute" => Attribute(struct AttributeMapping {
            /// Their name.
            name: CoordinatesName,
            /// What is done to them.
            uv: UvMapping = UvMapping::default(),
        }),
        /// Along z onto the plane of x and y: a copy for each unit.
        "planar" => Planar(struct PlanarMapping {
            /// Whose places are mapped.
            space: MappingSpace = MappingSpace::Object,
            /// What is done to the coordinates that come of it.
            uv: UvMapping = UvMapping::default(),
            /// Where the plane lies.
            transform: Transform = Transform::default(),
        }),
        /// Around z: u once around it from +x, counter-clockwise, v the distance from it.
        "polar" => Polar(struct PolarMapping {
            /// Whose places are mapped.
            space: MappingSpace = MappingSpace::Object,
            /// What is done to the coordinates that come of it.
            uv: UvMapping = UvMapping::default(),
            /// Where the axis stands.
            transform: Transform = Transform::default(),
        }),
        /// Onto a cylinder around y: once around it, and once from y = -1 to 1.
        "cylindrical" => Cylindrical(struct CylindricalMapping {
            /// Whose places are mapped.
            space: MappingSpace = MappingSpace::Object,
            /// What is done to the coordinates that come of it.
            uv: UvMapping = UvMapping::default(),
            /// Where the cylinder stands.
            transform: Transform = Transform::default(),
        }),
        /// Onto a sphere by longitude and latitude: the poles gather whole rows of a picture in a point.
        "spherical" => Spherical(struct SphericalMapping {
            /// Whose places are mapped.
            space: MappingSpace = MappingSpace::Object,
            /// What is done to the coordinates that come of it.
            uv: UvMapping = UvMapping::default(),
            /// Where the sphere lies.
            transform: Transform = Transform::default(),
        }),
        /// Onto the six sides of a cube, as seen from its middle: the pattern once on each.
        "cube" => Cube(struct CubeMapping {
            /// Whose places are mapped.
            space: MappingSpace = MappingSpace::Object,
            /// What is done to the coordinates that come of it.
            uv: UvMapping = UvMapping::default(),
            /// Where the cube stands.
            transform: Transform = Transform::default(),
        }),
        /// Along x, y and z at once, mixed by where the surface faces: a copy for each unit, without seams and stretched nowhere.
        "triplanar" => Triplanar(struct TriplanarMapping {
            /// Whose places are mapped.
            space: MappingSpace = MappingSpace::Object,
            /// What is done to the coordinates that come of it.
            uv: UvMapping = UvMapping::default(),
            /// How quickly one direction gives way to the next where the surface turns.
            sharpness: f64 [Limit::within(0.1, 100.0)] = 4.0,
            /// Where the axes lie.
            transform: Transform = Transform::default(),
        }),
        /// As if thrown by a projector, which casts no shadows: the pattern once in what it sees.
        "camera" => Camera(struct CameraMapping [check::camera_mapping] {
            /// Whose places are mapped.
            space: MappingSpace = MappingSpace::World,
            /// Where it stands.
            eye: DVec3,
            /// What it looks at.
            look_at: DVec3,
            /// What is up for it.
            up: DVec3 = DVec3::Y,
            /// The angle that it sees from left to right, in degrees.
            fov: f64 [Limit::within(0.1, 179.0)] = 40.0,
            /// Width of what it sees over its height.
            aspect: f64 [Limit::within(0.01, 100.0)] = 1.0,
        }),
    }
}

impl Default for Mapping {
    fn default() -> Self {
        Self::Uv(UvMapping::default())
    }
}

describe! {
    /// Whose places a mapping maps.
    pub enum MappingSpace {
        /// The thing's own, before all transforms of itself, its groups and instances: the pattern stays with it.
        "object" => Object,
        /// The world's: the thing moves through the pattern.
        "world" => World,
    }
}

/// The name of texture coordinates that a mesh has besides its own.
#[derive(Clone, Debug, PartialEq)]
pub struct CoordinatesName(pub Name);

/// The name of what a mesh has at its vertices or on its faces.
#[derive(Clone, Debug, PartialEq)]
pub struct AttributeName(pub Name);

/// A texture of the scene by its name, or one written where it is used.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureOf {
    /// One of the scene's `textures`.
    Named(Link<Texture>),
    /// Written on the spot.
    Inline(Texture),
}

describe! {
    /// What makes a surface be lit as if it were rough. It stays where it is.
    pub struct Relief {
        /// The directions that its normals seem to have.
        normal_map: Option<NormalMap> = None,
        /// How high it seems to be, on top of that.
        bump: Option<Bump> = None,
    }
}

describe! {
    /// Normals read off a texture, whose red, green and blue from 0 to 1 are x, y and z from -1 to 1.
    pub struct NormalMap {
        /// The texture; a picture's numbers are taken as they stand.
        texture: TextureOf,
        /// What x, y and z are.
        space: NormalSpace = NormalSpace::Tangent,
        /// Which way green points.
        green: GreenAxis = GreenAxis::Up,
        /// What the slopes are multiplied by; 0 is flat.
        strength: f64 [Limit::within(-100.0, 100.0)] = 1.0,
    }
}

describe! {
    /// In which axes a normal map tells directions.
    pub enum NormalSpace {
        /// The surface's: x along rising u, y along rising v, z outwards.
        "tangent" => Tangent,
        /// The thing's own, before all transforms.
        "object" => Object,
    }
}

describe! {
    /// Which way green points in a normal map of the surface's axes.
    pub enum GreenAxis {
        /// Along rising v, as for OpenGL, glTF and Blender.
        "up" => Up,
        /// Along falling v, as for DirectX and Unreal.
        "down" => Down,
    }
}

describe! {
    /// Heights read off a texture.
    pub struct Bump {
        /// The texture, read as a number.
        texture: TextureOf,
        /// How high, in metres of the world, it seems to be where the texture is 1; below 0 it is dented.
        height: f64 [Limit::within(-1e6, 1e6)] = 0.01,
    }
}

impl Texture {
    /// The colours that it shows as they are: those that it has itself, but where it makes others of them.
    pub(crate) fn colours(&self) -> Vec<&Spectrum> {
        struct Own<'a> {
            /// How many textures within this one are open.
            inside: u32,
            found: Vec<&'a Spectrum>,
        }
        impl<'a> Visitor<'a> for Own<'a> {
            fn spectrum(&mut self, spectrum: &'a Spectrum, _: Limit) {
                self.found.extend((self.inside == 0).then_some(spectrum));
            }
            fn texture(&mut self, _: &'a TextureOf, _: Limit, _: bool) {
                self.inside += 1;
            }
            fn end_of_texture(&mut self) {
                self.inside -= 1;
            }
        }
        let mut own = Own { inside: 0, found: Vec::new() };
        match self {
            Self::Attribute(_) | Self::Scale(_) | Self::Add(_) | Self::Invert(_) | Self::Remap(_) => {}
            other => other.show(Limit::FINITE, &mut own),
        }
        own.found
    }
}

describe! {
    /// What the numbers of a picture mean. Pictures of floating point (EXR, HDR, PFM) hold light, and only the primaries are asked.
    pub enum TextureSpace {
        /// Where a colour is wanted, what the file says, and sRGB where it says nothing; where a number is wanted, as `raw`.
        "auto" => Auto,
        /// The primaries and the curve of sRGB.
        "srgb" => Srgb,
        /// Light with the primaries of sRGB.
        "linear" => Linear,
        /// No colours but numbers, taken as they stand, 0 to 1.
        "raw" => Raw,
        /// Display P3, with the curve of sRGB.
        "display_p3" => DisplayP3,
        /// Adobe RGB (1998): its primaries and a gamma of 563/256.
        "adobe_rgb" => AdobeRgb,
        /// Light with the primaries of Rec. 2020.
        "rec2020" => Rec2020,
        /// ACEScg: light.
        "acescg" => AcesCg,
        /// ACES2065-1: light.
        "aces" => Aces,
    }
}

describe! {
    /// One number of a texture's four.
    pub enum TextureChannel {
        /// How bright its colour is.
        "luminance" => Luminance,
        /// Red.
        "red" => Red,
        /// Green.
        "green" => Green,
        /// Blue.
        "blue" => Blue,
        /// How much of it is there; 1 where the picture doesn't say.
        "alpha" => Alpha,
    }
}

describe! {
    /// How a picture is read between its pixels, and where many of them are seen as one.
    pub enum TextureFilter {
        /// The pixel that the point lies in, however many are seen.
        "nearest" => Nearest,
        /// Between the four pixels around, however many are seen.
        "bilinear" => Bilinear,
        /// Between the four pixels around, of two smaller copies of the picture: as much as is seen, though as wide as long.
        "trilinear" => Trilinear,
        /// A Gaussian as long and wide as what is seen (elliptical weighted average).
        "ewa" => Ewa,
        /// One pixel of those that `ewa` takes the mean of, drawn anew for each path: quicker than the mean, and noisier.
        "stochastic" => Stochastic,
    }
}

describe! {
    /// What is beyond the edges of a picture.
    pub enum Wrap {
        /// The picture again.
        "repeat" => Repeat,
        /// The picture in a mirror.
        "mirror" => Mirror,
        /// The pixels of its edge.
        "clamp" => Clamp,
        /// Nothing: 0.
        "black" => Black,
    }
}

/// What is beyond the edges of a picture: at the left and right, and below and above.
#[derive(Clone, Debug, PartialEq)]
pub struct Wraps(pub [Wrap; 2]);

/// A number or colour of a surface, which may differ from point to point.
#[derive(Clone, Debug, PartialEq)]
pub enum Varying<T> {
    /// The same everywhere.
    Constant(T),
    /// Read off a texture.
    Texture(Box<TextureOf>),
}

impl<T> From<T> for Varying<T> {
    fn from(v: T) -> Self {
        Self::Constant(v)
    }
}

impl<T> Varying<T> {
    /// The value, if it is the same everywhere.
    pub const fn constant(&self) -> Option<&T> {
        match self {
            Self::Constant(v) => Some(v),
            Self::Texture(_) => None,
        }
    }
}
