//! Shapes.

use straal_math::DVec3;

use crate::desc::check;
use crate::desc::lamp::Lamp;
use crate::desc::material::MaterialRef;
use crate::desc::round::WHOLE_TURN;
use crate::desc::spectrum::Spectrum;
use crate::desc::texture::Varying;
use crate::desc::transform::Transform;
use crate::describe::describe;
use crate::limit::Limit;
use crate::span::Spanned;
use crate::value::{Asset, Known, Name};
use crate::{Bitmap, Mesh};

describe! {
    /// What all surfaces share.
    pub struct Surface {
        /// What the surface does with light; without one in any group around it, it is diffuse with reflectance 0.5.
        material: Option<MaterialRef> = None,
        /// Radiance that the front sends out, in W/(m^2 sr).
        emission: Option<Varying<Spectrum>> [Limit::NON_NEGATIVE] = None,
        /// Whether the back glows as well.
        two_sided_emission: bool = false,
        /// The angle of the cone around the normal, in degrees from rim to rim, that its light stays in, as behind a honeycomb: `emission` along the normal, less and
        /// less towards the rim.
        emission_spread: f64 [Limit::within(0.1, 180.0)] = 180.0,
        /// Places the shape.
        transform: Transform = Transform::default(),
        /// A point that the front is turned towards, after `transform` and about the middle of the shape; the front of a shape that
        /// isn't flat is along its +z.
        look_at: Option<Spanned<DVec3>> = None,
        /// Swaps front and back.
        flip: bool = false,
        /// What the camera's `focus_on`, lamps, and groups of lamps by their names call it.
        name: Option<Name> = None,
    } with lamp: Lamp
}

describe! {
    /// A ball.
    pub struct Sphere [check::sphere] {
        /// Its middle.
        center: DVec3 = DVec3::ZERO,
        /// Its radius.
        radius: f64 [Limit::POSITIVE] = 1.0,
        /// From which height to which it is there, both as y from its middle; all of it without.
        heights: Option<[f64; 2]> = None,
        /// Which part of a turn about the y-axis through its middle there is, in degrees from z towards x.
        phi: [f64; 2] = WHOLE_TURN,
    } with surface: Surface
}

describe! {
    /// An infinite plane; it cannot glow.
    pub struct Plane [check::plane] {
        /// Any point on it.
        point: DVec3 = DVec3::ZERO,
        /// Towards its front.
        normal: DVec3 = DVec3::Y,
    } with surface: Surface
}

describe! {
    /// A flat, round plate; without keys the unit disc in the xy-plane that faces +z.
    pub struct Disc [check::disc] {
        /// Its middle.
        center: DVec3 = DVec3::ZERO,
        /// Towards its front.
        normal: DVec3 = DVec3::Z,
        /// Its radius.
        radius: f64 [Limit::POSITIVE] = 1.0,
        /// If it glows: how points on it are drawn.
        light_sampling: LightSampling = LightSampling::Auto,
    } with surface: Surface
}

describe! {
    /// A flat parallelogram; without keys the square from -1 to 1 in the xy-plane that faces +z.
    pub struct Rectangle [check::rectangle] {
        /// One corner.
        corner: DVec3 = DVec3::new(-1.0, -1.0, 0.0),
        /// The two edges from that corner; its front is towards their cross product, first x second.
        edges: [DVec3; 2] = [DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.0)],
        /// If it glows: how points on it are drawn.
        light_sampling: LightSampling = LightSampling::Auto,
    } with surface: Surface
}

describe! {
    /// How points on a lamp are drawn.
    pub enum LightSampling {
        /// As it is seen from near by, and evenly by area from afar.
        "auto" => Auto,
        /// Evenly by area.
        "area" => Area,
        /// Evenly as seen from the point that is lit, where the lamp is seen large: less noise close to it. Not slanted parallelograms and discs that a transform made ellipses.
        "solid_angle" => SolidAngle,
        /// The same, and more of what falls steeply on the surface that is lit. Only rectangles.
        "projected_solid_angle" => ProjectedSolidAngle,
    }
}

describe! {
    /// A box along the axes; without keys from -1 to 1 on each.
    pub struct Cuboid [check::cuboid] {
        /// The corner with the smallest coordinates.
        min: DVec3 = DVec3::splat(-1.0),
        /// The corner with the largest coordinates.
        max: DVec3 = DVec3::splat(1.0),
    } with surface: Surface
}

describe! {
    /// A tube; its front is outside.
    pub struct Cylinder [check::cylinder] {
        /// The middle of one end.
        from: DVec3 = DVec3::ZERO,
        /// The middle of the other end.
        to: DVec3 = DVec3::Y,
        /// Its radius.
        radius: f64 [Limit::POSITIVE] = 1.0,
        /// Whether discs close its ends.
        caps: bool = false,
        /// Which part of a turn about its axis there is, in degrees.
        phi: [f64; 2] = WHOLE_TURN,
    } with surface: Surface
}

describe! {
    /// One triangle, its front where the vertices run counter-clockwise.
    pub struct Triangle [check::triangle] {
        /// Its corners.
        vertices: [DVec3; 3],
        /// If it glows: how points on it are drawn.
        light_sampling: LightSampling = LightSampling::Auto,
    } with surface: Surface
}

describe! {
    /// Which normals a mesh is shaded with.
    pub enum Shading {
        /// The file's normals when it has any, else flat.
        "auto" => Auto,
        /// Each face's own normal.
        "flat" => Flat,
        /// Colours are computed at the vertices and interpolated between them (Gouraud 1971): an exhibit of how it was done.
        "gouraud" => Gouraud(Gouraud),
        /// Normals at the vertices, computed when there are none, are interpolated between them (Phong 1975).
        "smooth" => Smooth(Smoothing),
    }
}

describe! {
    /// Colours at the vertices.
    pub struct Gouraud {
        /// An edge at which the normals of two faces differ by more than this, in degrees, is sharp: no mean is taken over it.
        crease: f64 [Limit::within(0.0, 180.0)] = 180.0,
        /// Whether normals are computed even where there are some already.
        recompute: bool = false,
    }
}

describe! {
    /// Normals at the vertices.
    pub struct Smoothing {
        /// An edge at which the normals of two faces differ by more than this, in degrees, is sharp: no mean is taken over it.
        crease: f64 [Limit::within(0.0, 180.0)] = 180.0,
        /// Whether they are computed even where there are some already.
        recompute: bool = false,
        /// Where rays leave from that go on or look for light.
        rays: Leaving = Leaving::Smooth,
    }
}

describe! {
    /// Where rays leave a mesh that is shaded with normals at its vertices.
    pub enum Leaving {
        /// The smooth surface that the normals tell of, so that shadow begins softly.
        "smooth" => Smooth,
        /// The triangles, as in most renderers: shadow begins in steps.
        "faces" => Faces,
    }
}

describe! {
    /// A triangle mesh from a file, or written out by `positions` and `triangles`.
    pub struct TriangleMesh [check::mesh] {
        /// A PLY, OBJ or STL file.
        file: Option<Asset<Mesh>> = None,
        /// Vertices, in place of a file.
        positions: Vec<DVec3> = Vec::new(),
        /// Three indices into `positions` each, from 0, counter-clockwise seen from the front.
        triangles: Vec<[u32; 3]> = Vec::new(),
        /// A shading normal for each of `positions`.
        normals: Vec<DVec3> = Vec::new(),
        /// Texture coordinates for each of `positions`.
        uvs: Vec<[f64; 2]> = Vec::new(),
        /// For each of `positions` the direction that brushed surfaces and maps of normals follow, as x, y, z, and 1 or -1: which way what is across it goes.
        /// Without them they follow the texture's u.
        tangents: Vec<[f64; 4]> = Vec::new(),
        /// Which normals it is shaded with.
        shading: Shading = Shading::Auto,
        /// Smooths it: its faces, as its file has them, are a control cage.
        subdivide: Option<Subdivide> = None,
        /// If it glows: how points on each of its triangles are drawn.
        light_sampling: LightSampling = LightSampling::Auto,
    } with surface: Surface
}

describe! {
    /// How a control cage becomes a smooth surface.
    pub struct Subdivide {
        /// By which rule.
        scheme: Subdivision = Subdivision::CatmullClark,
        /// How many times each face is divided into four.
        levels: u32 [Limit::within(0.0, 8.0)] = 3,
    }
}

impl Subdivide {
    /// How many triangles a cage becomes whose polygons have so many corners in all, and gave so many triangles.
    pub fn triangles(&self, corners: u64, triangles: u64) -> u64 {
        let power = 1_u64 << (2 * self.levels.min(16));
        match (&self.scheme, self.levels) {
            (_, 0) => triangles,
            (Subdivision::Loop, _) => triangles.saturating_mul(power),
            // Each corner becomes a square of two triangles.
            (Subdivision::CatmullClark, _) => corners.saturating_mul(power / 4).saturating_mul(2),
        }
    }
}

describe! {
    /// Rules of subdivision.
    pub enum Subdivision {
        /// For faces of any number of sides, best of four (Catmull & Clark 1978).
        "catmull_clark" => CatmullClark,
        /// For triangles (Loop 1987); what has more sides is cut into triangles first.
        "loop" => Loop,
    }
}

/// Where a mesh's triangles are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeshSource<'a> {
    /// Beside the description, as those of files are.
    Asset(&'a Asset<Mesh>),
    /// In the description's own lists.
    Inline,
}

impl TriangleMesh {
    /// Where the triangles are.
    pub fn source(&self) -> MeshSource<'_> {
        self.file.as_ref().map_or(MeshSource::Inline, MeshSource::Asset)
    }
}

describe! {
    /// A patch between four corners, straight along its edges and from each edge to the other.
    pub struct Bilinear [check::bilinear] {
        /// The corners at (u, v) = (0, 0), (1, 0), (0, 1) and (1, 1); the front is where du x dv points.
        corners: [DVec3; 4],
        /// Texture coordinates at the corners.
        uvs: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]],
    } with surface: Surface
}

describe! {
    /// Heights over a rectangle, from -x to +x and from +z to -z, y up: a grid of triangles.
    pub struct HeightField [check::height_field] {
        /// A picture: brighter is higher, its numbers as they are in the file; it lies with its top towards -z.
        file: Option<Asset<Bitmap>> = None,
        /// Heights in place of a picture, row by row from -z to +z.
        heights: Vec<Vec<f64>> = Vec::new(),
        /// How long it is along x and z, about the origin.
        size: [f64; 2] [Limit::POSITIVE] = [2.0, 2.0],
        /// The y of height 0 and of height 1, which is a picture's white.
        between: [f64; 2] = [0.0, 1.0],
        /// Which normals it is shaded with; `auto` is smooth.
        shading: Shading = Shading::Auto,
    } with surface: Surface
}

describe! {
    /// Bicubic Bezier patches, built in by name or written out by `points` and `patches`.
    pub struct Bezier [check::bezier] {
        /// The name of built-in patches: `teapot`.
        builtin: Option<Known<Patches>> = None,
        /// Control points, in place of built-in ones.
        points: Vec<DVec3> = Vec::new(),
        /// Sixteen indices into `points` each, from 0, row by row; the front is where du x dv points, u along a row.
        patches: Vec<[u32; 16]> = Vec::new(),
        /// Each patch becomes this many by this many squares of two triangles.
        resolution: u32 [Limit::within(1.0, 256.0)] = 8,
        /// Which normals it is shaded with; `auto` is the patches' own.
        shading: Shading = Shading::Auto,
    } with surface: Surface
}

/// Patches that are built in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patches {
    /// The teapot of Utah.
    Teapot,
}

/// Where a Bezier surface's control points are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BezierPatches {
    /// Built in.
    Builtin(Patches),
    /// In the description's own lists.
    Inline,
}

impl Bezier {
    /// Where the control points are.
    pub fn source(&self) -> BezierPatches {
        self.builtin.as_ref().map_or(BezierPatches::Inline, |known| BezierPatches::Builtin(known.what))
    }
}
