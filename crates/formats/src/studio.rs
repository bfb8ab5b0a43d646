//! A studio around a bare mesh: a floor, soft lights, and a camera that frames it, so that any mesh can be looked at.

use straal_math::DVec3;
use straal_scene::MeshAsset;
use straal_scene::desc::{
    Accel, Camera, ColorSettings, Diffuse, Environment, Film, FovAxis, Integrator, Light, Material,
    MaterialRef, Node, Observer, Perspective, Plane, Rectangle, Sampler, Scene, Shading, Spectrum, Step,
    Surface, Tone, Transform, TriangleMesh, Viewpoint,
};
use straal_scene::value::{Color, Factors, Named, Value};

/// Height of the view in degrees, and the tangent of its half.
const FOV: (f64, f64) = (30.0, 0.267_949_192_431_122_7);

/// How much of the picture the mesh may fill.
const FILL: f64 = 0.85;

/// The points of a mesh that are finite.
fn points(asset: &MeshAsset) -> impl Iterator<Item = DVec3> {
    let finite = asset.mesh.positions.iter().filter(|p| p.iter().all(|v| v.is_finite()));
    finite.map(|p| DVec3::from_array(p.map(f64::from)))
}

/// The box around them.
fn bounds(asset: &MeshAsset) -> Option<(DVec3, DVec3)> {
    let grow = |found: Option<(DVec3, DVec3)>, p: DVec3| {
        Some(found.map_or((p, p), |(min, max)| (min.min(p), max.max(p))))
    };
    points(asset).fold(None, grow)
}

/// The scene around a mesh, which goes by `name` in its assets; what is wrong when there is nothing to see.
pub fn around(name: &str, asset: &MeshAsset) -> Result<Scene, String> {
    if asset.mesh.triangles.is_empty() {
        return Err("the mesh is empty: it has no triangles".to_owned());
    }
    let Some((min, max)) = bounds(asset) else {
        return Err("the mesh has no point with finite coordinates".to_owned());
    };
    let center = (min + max) * 0.5;
    let radius = (max - min).length() * 0.5;
    // Lights and camera stand a few radii away, where single precision must still tell points apart.
    let farthest = center.abs().max_element();
    if !(1e-15..1e15).contains(&radius) || farthest > 1e5 * radius {
        return Err(format!(
            "the mesh can't be framed: it is {:e} wide around a middle {farthest:e} from the origin",
            2.0 * radius
        ));
    }
    let film = Film { tone: Tone::Filmic, ..Film::default() };
    let mut materials = Named::default();
    materials.insert("clay".to_owned().into(), diffuse([0.62, 0.48, 0.38]));
    materials.insert("floor".to_owned().into(), diffuse([0.55, 0.55, 0.55]));
    // A file's own materials are shown when it has any.
    let material = asset.materials.is_empty().then(|| named("clay"));
    let mesh = TriangleMesh {
        file: Some(name.to_owned().into()),
        positions: Vec::new(),
        triangles: Vec::new(),
        normals: Vec::new(),
        uvs: Vec::new(),
        shading: Shading::Auto,
        surface: Surface { material, ..Surface::default() },
    };
    let floor = Plane {
        point: DVec3::new(center.x, min.y, center.z),
        normal: DVec3::Y,
        surface: Surface { material: Some(named("floor")), ..Surface::default() },
    };
    let lamp = |towards: DVec3, size: f64, radiance: f64| softbox(center, radius, towards, size, radiance);
    Ok(Scene {
        camera: Camera::Perspective(frame(center, points(asset), film.size)),
        film,
        color: ColorSettings::default(),
        sampler: Sampler::default(),
        integrator: Integrator::default(),
        accel: Accel::default(),
        spectral: false,
        materials,
        objects: Named::default(),
        world: vec![
            Node::Mesh(mesh),
            Node::Plane(floor),
            lamp(DVec3::new(-2.5, 3.5, 3.0), 1.6, 4.5),
            lamp(DVec3::new(4.0, 2.0, 2.0), 1.6, 0.8),
            lamp(DVec3::new(1.0, 3.5, -3.5), 1.2, 4.0),
        ],
        lights: vec![Light::Environment(Environment {
            radiance: Some(Value::Constant(Spectrum::grey(0.2))),
            ..Environment::default()
        })],
    })
}

fn diffuse(reflectance: [f64; 3]) -> Material {
    Material::Diffuse(Diffuse {
        reflectance: Value::Constant(Color(reflectance).into()),
        ..Diffuse::default()
    })
}

fn named(name: &str) -> MaterialRef {
    MaterialRef::Named(name.to_owned().into())
}

/// A square light that faces the middle, seen from there in the direction `towards` in units of the radius.
fn softbox(center: DVec3, radius: f64, towards: DVec3, size: f64, radiance: f64) -> Node {
    let steps = vec![
        Step::Scale(Factors(DVec3::splat(size * radius))),
        Step::LookAt(Viewpoint { eye: center + towards * radius, target: center, up: DVec3::Y }),
    ];
    Node::Rectangle(Rectangle {
        surface: Surface {
            emission: Some(Value::Constant(Spectrum::grey(radiance))),
            // A rectangle faces +z, and what looks at something does so along -z.
            flip: true,
            transform: Transform { steps, ..Transform::default() },
            ..Surface::default()
        },
        ..Rectangle::default()
    })
}

/// A camera to the front, right and above that looks at the middle and has all points in view.
fn frame(center: DVec3, points: impl Iterator<Item = DVec3>, size: [u32; 2]) -> Perspective {
    let w = DVec3::new(0.5, 0.38, 1.0).normalize();
    let u = DVec3::Y.cross(w).normalize();
    let v = w.cross(u);
    let tan_y = FILL * FOV.1;
    let tan_x = tan_y * f64::from(size[0]) / f64::from(size[1]);
    let mut distance = 0.0;
    for p in points.map(|p| p - center) {
        for needed in [p.dot(u).abs() / tan_x, p.dot(v).abs() / tan_y] {
            if p.dot(w) + needed > distance {
                distance = p.dot(w) + needed;
            }
        }
    }
    let observer = Observer { eye: center + w * distance, look_at: center, ..Observer::default() };
    Perspective { fov: Some(FOV.0), fov_axis: FovAxis::Y, observer, ..Perspective::default() }
}
