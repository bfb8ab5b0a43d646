//! A studio around a bare mesh: a sweep of paper, a key light, a fill, a rim light, and a camera that frames it, so that any
//! mesh can be looked at.
//!
//! The mesh is brought to the studio, not the studio to the mesh: it is turned upright, stood on the floor at the origin and scaled
//! so that the ball around it has a radius of 1. So the lights are the same for a mesh of a micrometre and one of a light
//! year, and the numbers of the scene can be read and changed by hand.

mod frame;
mod up;

use straal_math::{Affine, DVec3};
use straal_scene::desc::{
    AttributeTexture, Bezier, Camera, Conductor, Dielectric, Diffuse, Environment, Film, Group, Light,
    Material, MaterialRef, Node, Perspective, Rectangle, Rotation, Sampler, Scene, Shading, Smoothing,
    Spectrum, Step, Surface, Texture, TextureOf, Transform, TriangleMesh, Varying, Viewpoint,
};
use straal_scene::value::{Asset, Axis, Factors, Known, LinearRgb, Link, Named};
use straal_scene::{Diagnostic, Mesh, MeshAsset, Span};

pub use frame::Side;
pub use up::Up;

/// How a bare mesh is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Studio {
    /// Which of the mesh's axes points up; guessed when absent.
    pub up: Option<Up>,
    /// From where it is seen.
    pub view: Side,
    /// What it is made of; of its file's own materials, and clay where it has none, when absent.
    pub finish: Option<Finish>,
    /// The angle between two faces, in degrees, beyond which the edge between them is sharp. When absent a file's own normals
    /// are taken, and where it has none they are computed with an angle of [`CREASE`].
    pub smooth: Option<f64>,
    /// What is behind it.
    pub background: Background,
    /// Width and height of the picture; [`SIZE`] when absent.
    pub size: Option<[u32; 2]>,
}

/// The angle in degrees beyond which an edge is sharp, where none is said: a ball of 9 sides or more is round, and the edges of
/// a hexagonal nut are seen.
pub const CREASE: f64 = 40.0;

/// Width and height of the picture, where none is said.
pub const SIZE: [u32; 2] = [800, 450];

/// What a mesh is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// Warm, matt clay.
    Clay,
    /// White plaster.
    White,
    /// Brushed steel.
    Metal,
    /// Polished gold.
    Gold,
    /// Clear glass.
    Glass,
}

impl Finish {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Clay, Self::White, Self::Metal, Self::Gold, Self::Glass];

    /// The name as it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clay => "clay",
            Self::White => "white",
            Self::Metal => "metal",
            Self::Gold => "gold",
            Self::Glass => "glass",
        }
    }

    fn material(self) -> Material {
        let metal = |metal: &str, roughness: f64| {
            Material::Conductor(Conductor {
                metal: Known::new(metal.to_owned()),
                roughness: Varying::Constant(roughness),
                ..Conductor::default()
            })
        };
        match self {
            Self::Clay => diffuse(LinearRgb([0.56, 0.43, 0.34])),
            Self::White => diffuse(LinearRgb([0.78, 0.77, 0.75])),
            Self::Metal => metal("chromium", 0.2),
            Self::Gold => metal("gold", 0.12),
            Self::Glass => Material::Dielectric(Dielectric::default()),
        }
    }
}

/// What is behind a mesh, and under it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Background {
    /// A sweep of light grey paper: floor and wall without an edge between them.
    #[default]
    Sweep,
    /// A sweep of paper that reflects such a share of light.
    Paper(LinearRgb),
    /// Nothing: no floor, and black behind the mesh, so that an EXR can be laid over another picture.
    Nothing,
}

/// What the paper of the sweep reflects.
const PAPER: f64 = 0.62;

/// The scene around a mesh, which goes by `shown`, and what was guessed; what is wrong when there is nothing to see.
pub fn around(
    shown: &Asset<Mesh>,
    asset: &MeshAsset,
    wish: &Studio,
) -> Result<(Scene, Vec<Diagnostic>), String> {
    let name = shown.file.value.as_str();
    let mut told = Vec::new();
    if asset.mesh.triangles.is_empty() {
        return Err("the mesh is empty: it has no triangles".to_owned());
    }
    let (up, reason) = wish.up.map_or_else(|| up::guess(asset), |up| (up, ""));
    if wish.up.is_none() {
        let other = if up == Up::Y { "z" } else { "y" };
        let message = format!("`{name}`: {up} is taken to be up, which is a guess{reason}");
        told.push(
            Diagnostic::note(Span::NONE, message).help(format!("`--up {other}` if it lies on its side")),
        );
    }
    let Some((min, max)) = bounds(asset) else {
        return Err("the mesh has no triangle with finite coordinates".to_owned());
    };
    let (center, radius) = ((min + max) * 0.5, (max - min).length() * 0.5);
    if radius == 0.0 {
        return Err("the mesh can't be seen: all its points are in one place".to_owned());
    }
    let farthest = center.abs().max_element();
    if farthest > COARSE * radius {
        let message = format!(
            "`{name}` is {:.1e} wide around a middle {farthest:.1e} from the origin: single precision, in which meshes are kept, \
             has steps of {:.0e} there, so that details are lost",
            2.0 * radius,
            farthest * f64::from(f32::EPSILON)
        );
        let help = "move it to the origin in the program that it comes from";
        told.push(Diagnostic::warning(Span::NONE, message).help(help));
    }
    let steps = placed(center, (max - min) * 0.5, radius, up);
    let Some(place) = steps.iter().map(Step::affine).try_fold(Affine::IDENTITY, |all, s| Some(all.then(&s?)))
    else {
        return Err("the mesh can't be scaled to the studio".to_owned());
    };

    let size = wish.size.unwrap_or(SIZE);
    let mut materials = Named::default();
    let finish = wish.finish.unwrap_or(Finish::Clay);
    let is_painted = wish.finish.is_none() && has_colours(asset);
    let (kind, material) =
        if is_painted { ("painted", painted()) } else { (finish.name(), finish.material()) };
    materials.insert(kind.to_owned().into(), material);
    let named = |name: &str| Some(MaterialRef::Named(Link::new(name.to_owned())));
    // A file's own materials are shown when it has any, unless one is asked for; parts without one are clay.
    let has_own = wish.finish.is_none() && !asset.materials.is_empty();
    if has_own && has_colours(asset) {
        let message =
            format!("the colours of its vertices in `{name}` are not shown, since it has materials");
        let help = "a scene's `reflectance: { texture: attribute }` shows them";
        told.push(Diagnostic::warning(Span::NONE, message).help(help));
    }
    let shading = match wish.smooth {
        Some(crease) => Smoothing { crease, recompute: true, ..Smoothing::default() },
        None => Smoothing { crease: CREASE, ..Smoothing::default() },
    };
    let mesh = Node::Mesh(TriangleMesh {
        file: Some(shown.clone()),
        shading: Shading::Smooth(shading),
        surface: Surface {
            material: if has_own { None } else { named(kind) },
            transform: Transform { steps, ..Transform::default() },
            ..Surface::default()
        },
        ..TriangleMesh::default()
    });
    let mesh = if has_own {
        let material = named(kind);
        Node::Group(Group {
            material,
            children: vec![mesh],
            transform: Transform::default(),
            look_at: None,
            name: None,
        })
    } else {
        mesh
    };

    // What stands around the mesh is turned with the camera, so that it is lit alike from wherever it is seen.
    let mut set = lamps();
    if wish.background == Background::Nothing {
        // In place of the sky, which would be seen behind the mesh.
        set.push(lamp(DVec3::new(0.0, 5.0, 16.0), [14.0, 14.0], 0.4));
    } else {
        let color = match wish.background {
            Background::Paper(color) => color,
            _ => LinearRgb::grey(PAPER),
        };
        materials.insert("paper".to_owned().into(), diffuse(color));
        set.splice(0..0, sweep());
    }
    let turn = Step::Rotate(Rotation { axis: Axis(DVec3::Y), degrees: wish.view.azimuth() });
    let set = Node::Group(Group {
        transform: Transform { steps: vec![turn], ..Transform::default() },
        material: named("paper").filter(|_| wish.background != Background::Nothing),
        children: set,
        look_at: None,
        name: None,
    });
    let sky =
        Light::Environment(Environment { radiance: Some(Spectrum::grey(SKY)), ..Environment::default() });
    let points = points(asset).map(|p| place.point(p));
    let mut scene = Scene {
        film: Film { size, ..Film::default() },
        sampler: Sampler { spp: 64, ..Sampler::default() },
        materials,
        world: vec![mesh, set],
        lights: if wish.background == Background::Nothing { Vec::new() } else { vec![sky] },
        ..Scene::seen_by(frame::camera(points, wish.view, size))
    };
    scene.link();
    Ok((scene, told))
}

/// A camera that shows all of some points, wherever they are and however far apart.
pub(crate) fn fitting(points: &[DVec3], view: Side, size: [u32; 2]) -> Camera {
    let grow = |found: Option<(DVec3, DVec3)>, p: &DVec3| {
        Some(found.map_or((*p, *p), |(min, max)| (min.min(*p), max.max(*p))))
    };
    let (min, max) = points.iter().fold(None, grow).unwrap_or((DVec3::ZERO, DVec3::ZERO));
    let (centre, radius) = ((min + max) * 0.5, (max - min).length() * 0.5);
    let radius = if radius > 0.0 { radius } else { 1.0 };
    let mut camera = frame::camera(points.iter().map(|p| (*p - centre) * (1.0 / radius)), view, size);
    if let Camera::Perspective(Perspective { observer, .. }) = &mut camera {
        observer.eye = centre + observer.eye * radius;
        observer.look_at = centre + observer.look_at * radius;
    }
    camera
}

/// How many times farther from the origin than it is large a mesh may be before single precision shows.
const COARSE: f64 = 2e4;

/// Radiance of what is beyond the sweep.
const SKY: f64 = 0.14;

/// The points of a mesh's triangles, without those of triangles that aren't finite.
fn points(asset: &MeshAsset) -> impl Iterator<Item = DVec3> {
    let mesh = &asset.mesh;
    let corners = |t: &[u32; 3]| t.map(|i| mesh.positions.get(i as usize).copied().unwrap_or([f32::NAN; 3]));
    let finite = mesh.triangles.iter().map(corners).filter(|t| t.iter().flatten().all(|v| v.is_finite()));
    finite.flatten().map(|p| DVec3::from_array(p.map(f64::from)))
}

/// The box around them.
fn bounds(asset: &MeshAsset) -> Option<(DVec3, DVec3)> {
    let grow = |found: Option<(DVec3, DVec3)>, p: DVec3| {
        Some(found.map_or((p, p), |(min, max)| (min.min(p), max.max(p))))
    };
    points(asset).fold(None, grow)
}

/// The steps that stand a mesh on the floor at the origin, upright and of radius 1.
fn placed(center: DVec3, half: DVec3, radius: f64, up: Up) -> Vec<Step> {
    let foot = center - up.axis() * up.axis().abs().dot(half);
    let mut steps = vec![Step::Translate(DVec3::ZERO - foot)];
    if let Some((axis, degrees)) = up.turn() {
        steps.push(Step::Rotate(Rotation { axis: Axis(axis), degrees }));
    }
    steps.push(Step::Scale(Factors(DVec3::splat(1.0 / radius))));
    steps
}

/// Whether its vertices or faces have colours.
fn has_colours(asset: &MeshAsset) -> bool {
    asset.mesh.attributes.iter().any(|a| a.name == "color")
}

/// Of these colours.
fn painted() -> Material {
    let colours = Texture::Attribute(AttributeTexture::default());
    let reflectance = Varying::Texture(Box::new(TextureOf::Inline(colours)));
    Material::Diffuse(Diffuse { reflectance, ..Diffuse::default() })
}

fn diffuse(color: LinearRgb) -> Material {
    Material::Diffuse(Diffuse { reflectance: Varying::Constant(color.into()), ..Diffuse::default() })
}

/// A floor that turns up into a wall in a quarter of a circle. It lies a little below the mesh, so that a sheet on the floor is seen.
fn sweep() -> [Node; 3] {
    /// Half its width, where the floor begins to turn up, how large the bend is, and the height of the wall.
    const WIDTH: f64 = 40.0;
    const START: f64 = -4.0;
    const BEND: f64 = 5.0;
    const HEIGHT: f64 = 30.0;
    const LEVEL: f64 = -0.002;
    /// Where a cubic has its inner points to come nearest to a quarter of a circle.
    const INNER: f64 = 0.5523;
    let flat = |corner: DVec3, edges: [DVec3; 2]| {
        Node::Rectangle(Rectangle { corner, edges, ..Rectangle::default() })
    };
    let profile = [[0.0, 0.0], [0.0, INNER], [1.0 - INNER, 1.0], [1.0, 1.0]];
    let across = [-WIDTH, -WIDTH / 4.0, WIDTH / 4.0, WIDTH];
    let point = |[up, back]: [f64; 2]| across.map(|x| DVec3::new(x, LEVEL + up * BEND, START - back * BEND));
    let bend = Bezier {
        points: profile.into_iter().flat_map(point).collect(),
        patches: vec![std::array::from_fn(|i| i as u32)],
        resolution: 48,
        ..Bezier::default()
    };
    let width = DVec3::X * (2.0 * WIDTH);
    [
        flat(DVec3::new(-WIDTH, LEVEL, WIDTH), [width, DVec3::Z * (START - WIDTH)]),
        Node::Bezier(bend),
        flat(DVec3::new(-WIDTH, LEVEL + BEND, START - BEND), [width, DVec3::Y * HEIGHT]),
    ]
}

/// The key light to the left, a weak fill to the right, a rim light behind, and a strip above that lights the wall; seen from the
/// camera.
fn lamps() -> Vec<Node> {
    let wall =
        Viewpoint { eye: DVec3::new(0.0, 6.5, -3.0), target: DVec3::new(0.0, 1.5, -9.0), up: DVec3::Y };
    vec![
        lamp(DVec3::new(-3.8, 4.4, 2.4), [1.6, 1.6], 9.5),
        lamp(DVec3::new(4.8, 2.2, 2.8), [1.4, 2.2], 0.6),
        lamp(DVec3::new(2.2, 4.0, -3.4), [1.8, 0.7], 11.0),
        softbox(wall, [5.0, 0.5], 7.0),
    ]
}

/// A lamp that faces the mesh.
fn lamp(eye: DVec3, size: [f64; 2], radiance: f64) -> Node {
    softbox(Viewpoint { eye, target: DVec3::new(0.0, 0.6, 0.0), up: DVec3::Y }, size, radiance)
}

/// A black box whose front glows; of half the width and half the height given.
fn softbox(place: Viewpoint, [width, height]: [f64; 2], radiance: f64) -> Node {
    let steps = vec![Step::Scale(Factors(DVec3::new(width, height, 1.0))), Step::LookAt(place)];
    Node::Rectangle(Rectangle {
        surface: Surface {
            material: Some(MaterialRef::Inline(Box::new(diffuse(LinearRgb::grey(0.0))))),
            emission: Some(Varying::Constant(Spectrum::grey(radiance))),
            // A rectangle faces +z, and what looks at something does so along -z.
            flip: true,
            transform: Transform { steps, ..Transform::default() },
            ..Surface::default()
        },
        ..Rectangle::default()
    })
}
