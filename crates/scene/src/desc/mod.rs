//! What a scene can say: plain data, as a file or a program says it.

pub mod accel;
pub mod animation;
pub mod camera;
pub(crate) mod check;
pub mod color;
pub mod curves;
pub mod development;
mod keyframes;
mod lamp;
pub mod light;
pub mod material;
pub mod node;
pub mod round;
mod settings;
pub mod shape;
pub mod sky;
pub mod solid;
pub mod spectrum;
pub mod texture;
pub mod transform;

pub use accel::{
    Accel, BinaryBvh, BoundingVolumes, BspTree, Build, KdTree, Octree, PlaneChoice, Split, Structure,
    UniformGrid, VolumeKind, WideBvh,
};
pub use animation::Animation;
pub use camera::{
    Camera, CubeLayout, CubeMap, Fisheye, FisheyeProjection, FovAxis, GaussianProfile, Lens, LensExposure,
    LensProfile, Observer, Orthographic, Panorama, PanoramaRows, Perspective, Realistic, Stereo,
    StereoLayout,
};
pub use check::even_scale;
pub use color::{ColorIn, ColorSettings, WhitePoint, WorkSpace};
pub use curves::{CurveBasis, CurveForm, Curves};
pub use development::{Flag, Gamma, Gamut, HableCurve, ReinhardCurve, Tone};
pub use keyframes::{CameraAt, Keyframe, Keyframes};
pub use lamp::{Lamp, LightGroup, MOST_LIGHT_GROUPS, MOST_LINKED, REST};
pub use light::{
    AmbientLight, Decay, DirectionalLight, Environment, EnvironmentLayout, Falloff, Goniometric, Light,
    PointLight, Portal, Projector, SpotLight,
};
pub use material::*;
pub use node::{Group, Instance, Instances, Node};
pub use round::{Annulus, Capsule, Cone, Hyperboloid, Paraboloid, Torus, WHOLE_TURN};
pub use settings::{
    AmbientOcclusion, BlackmanHarris, Channels, Denoise, DirectLight, Directions, Film, Filter, Gaussian,
    Integrator, LampChoice, Lanczos, LightTracer, Mitchell, OcclusionFalloff, OcclusionWarp, PathTracer,
    Roulette, Sampler, SamplerKind, ShadowZones, SpectralChannels, Technique, Tent, Whitted, ZonesShown,
};
pub use shape::{
    Bezier, BezierPatches, Bilinear, Cuboid, Cylinder, Disc, Gouraud, HeightField, Leaving, LightSampling,
    MeshSource, Patches, Plane, Rectangle, Shading, Smoothing, Sphere, Subdivide, Subdivision, Surface,
    Triangle, TriangleMesh,
};
pub use sky::{Sky, When};
pub use solid::{
    BallDistance, Blend, BoxDistance, CapsuleDistance, Combination, CylinderDistance, Distance,
    DistanceField, GridDistance, Grown, Moved, RingDistance, Ripples,
};
pub use spectrum::{Formula, Index, Interpolation, Measured, Spectrum};
pub use texture::*;
pub use transform::{AxisAngle, Coordinate, Reflection, Rotation, Shear, Step, Transform, Viewpoint, facing};

use crate::describe::describe;
use crate::value::Named;

describe! {
    /// A scene: what there is, what lights it, who looks at it and how it is rendered.
    pub struct Scene {
        /// Who looks.
        camera: Camera,
        /// The picture to make.
        film: Film = Film::default(),
        /// How colours are computed with.
        color: ColorSettings = ColorSettings::default(),
        /// Where the random numbers come from.
        sampler: Sampler = Sampler::default(),
        /// How light is computed.
        integrator: Integrator = Integrator::default(),
        /// How rays are searched.
        accel: Accel = Accel::default(),
        /// Whether light is computed by wavelengths instead of red, green and blue.
        spectral: bool = false,
        /// How a scene that moves is played.
        animation: Animation = Animation::default(),
        /// Textures by name, for `{ texture: NAME }`.
        textures: Named<Texture> = Named::default(),
        /// Materials by name.
        materials: Named<Material> = Named::default(),
        /// Geometry by name, which is seen only where an `instance` puts it.
        objects: Named<Node> = Named::default(),
        /// What there is, as a list of shapes, meshes, groups and instances.
        world: Vec<Node> = Vec::new(),
        /// Lights that are not surfaces.
        lights: Vec<Light> = Vec::new(),
    }
}
