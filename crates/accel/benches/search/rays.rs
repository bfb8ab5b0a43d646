//! The rays with which searches are timed.

use super::{common::Random, scenes::Mesh};
use straal_accel::{Hit, Scene};
use straal_math::{Frame, Ray, Vec3};

/// Rays of one kind.
pub struct Set {
    pub name: &'static str,
    /// Whether any hit will do.
    pub any: bool,
    pub rays: Vec<Ray>,
}

/// Primary rays in tiles of 8 x 8; bounces about the normal by the cosine from where those hit, in that order and
/// shuffled, and on from where they hit; shadow rays to a square light; segments between random points.
pub fn sets(scene: &Scene, mesh: &Mesh) -> Vec<Set> {
    let primary = primary(scene, mesh, 512);
    let b = scene.bounds();
    let size = b.extent().length();
    let light = match mesh.name {
        "room" => Vec3::new(5.0, 3.9, 5.0),
        _ => b.center() + Vec3::new(0.2, 1.0, 0.5) * size,
    };
    let mut r = Random(1);
    let away = primary.iter().map(|r| Ray::new(r.o, -r.d)).collect();
    let first = leave(scene, mesh, &primary, size);
    let bounce: Vec<Ray> = first.iter().map(|&(o, n)| bounce(&mut r, o, n)).collect();
    let shadow = first
        .iter()
        .map(|&(o, _)| {
            let to = light + Vec3::new(r.signed(), 0.0, r.signed()) * (size * 0.05);
            Ray { t_max: 1.0, ..Ray::new(o, to - o) }
        })
        .collect();
    let second = leave(scene, mesh, &bounce, size).iter().map(|&(o, n)| self::bounce(&mut r, o, n)).collect();
    let mut shuffled = bounce.clone();
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, r.below(i + 1));
    }
    let within = |r: &mut Random| {
        let (p, half) = (r.point(), b.extent() * 0.5);
        b.center() + Vec3::new(p.x * half.x, p.y * half.y, p.z * half.z)
    };
    let segments = (0..bounce.len())
        .map(|_| {
            let (p, q) = (within(&mut r), within(&mut r));
            Ray { t_max: 1.0, ..Ray::new(p, q - p) }
        })
        .collect();
    let set = |name, rays| Set { name, any: name == "shadow" || name == "segments", rays };
    vec![
        set("primary", primary),
        set("bounce", bounce),
        set("shuffled", shuffled),
        set("second", second),
        set("shadow", shadow),
        set("segments", segments),
        set("misses", away),
    ]
}

/// The bounces of a picture of `n` x `n` pixels.
pub fn bounces(scene: &Scene, mesh: &Mesh, n: usize) -> Vec<Ray> {
    let mut r = Random(1);
    let first = leave(scene, mesh, &primary(scene, mesh, n), scene.bounds().extent().length());
    first.iter().map(|&(o, n)| bounce(&mut r, o, n)).collect()
}

/// Primary rays of a picture of `n` x `n` pixels.
fn primary(scene: &Scene, mesh: &Mesh, n: usize) -> Vec<Ray> {
    match mesh.name {
        // From a corner of the room.
        "room" => camera(Vec3::new(0.7, 2.2, 0.8), Vec3::new(6.0, 0.8, 6.0), n),
        _ => {
            let b = scene.bounds();
            let (center, size) = (b.center(), b.extent().length());
            camera(center + Vec3::new(0.3, 0.3, 1.0).normalize() * size * 0.9, center, n)
        }
    }
}

fn camera(eye: Vec3, at: Vec3, n: usize) -> Vec<Ray> {
    let view = Frame::from_normal((at - eye).normalize());
    let mut out = Vec::new();
    for tile in 0..(n / 8) * (n / 8) {
        for pixel in 0..64 {
            let x = (tile % (n / 8)) * 8 + pixel % 8;
            let y = (tile / (n / 8)) * 8 + pixel / 8;
            let c = |v: usize| (v as f32 + 0.5) / n as f32 - 0.5;
            out.push(Ray::new(eye, view.to_world(Vec3::new(c(x), c(y), 1.2))));
        }
    }
    out
}

/// Where rays hit, moved off the surface, and the normals towards where they came from.
fn leave(scene: &Scene, mesh: &Mesh, rays: &[Ray], size: f32) -> Vec<(Vec3, Vec3)> {
    let mut hits = vec![Hit::MISS; rays.len()];
    scene.closest(&(), rays, &mut hits);
    let on_surface = |(ray, hit): (&Ray, &Hit)| {
        let [p0, p1, p2] = mesh.indices[hit.primitive as usize].map(|i| mesh.positions[i as usize]);
        let n = (p1 - p0).cross(p2 - p0).normalize();
        let n = if n.dot(ray.d) > 0.0 { -n } else { n };
        (ray.at(hit.t) + n * (size * 1e-5), n)
    };
    rays.iter().zip(&hits).filter(|(_, h)| h.is_hit()).map(on_surface).collect()
}

fn bounce(r: &mut Random, o: Vec3, n: Vec3) -> Ray {
    Ray::new(o, (n + r.direction()).normalize())
}
