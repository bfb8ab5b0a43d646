//! What a finished world can't show rightly, told before anyone waits for the picture.

use crate::film::MAX_VALUE;
use crate::lanes::Rgb;
use crate::light::{Emitter, Receiver};
use crate::material::Material;
use crate::world::World;
use straal_accel::{self as accel, Hit};
use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_math::{Bounds, DVec3, Frame, Ray, Vec3, warp};

/// Lights that are looked at; a scene of thousands has the same fault in each.
const MOST_LIGHTS: usize = 64;

/// Rays that are sent from each.
const RAYS: u32 = 512;

/// Told where glass catches at least this part of a light's rays that meet anything.
const CAUGHT: f64 = 0.5;

/// Lights without size behind glass: shadow rays don't pass through it, and no path can meet a point by chance.
///
/// Of a draft, whose triangles are searched one by one, many get a tree of their own meanwhile.
pub(super) fn lights_behind_glass(world: &World, is_draft: bool, notes: &mut Vec<String>) {
    if !world.materials.iter().any(Material::is_clear) {
        return;
    }
    let mut quick = None;
    for light in world.emitters.iter().filter(|l| l.is_delta()).take(MOST_LIGHTS) {
        let quick = quick.get_or_insert_with(|| quick_search(world, is_draft)).as_ref();
        let rays: Vec<Ray> = (0..RAYS).filter_map(|i| ray_of(world, light, i)).collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        quick.unwrap_or(&world.accel).closest(&world.geometry, &rays, &mut hits);
        let met = hits.iter().filter(|h| h.is_hit()).count();
        let is_glass = |h: &&Hit| {
            h.is_hit() && world.materials.get(world.material_of(h) as usize).is_some_and(Material::is_clear)
        };
        let caught = hits.iter().filter(is_glass).count();
        if met == 0 || (caught as f64) < CAUGHT * met as f64 {
            continue;
        }
        let percent = (100 * caught).div_ceil(met);
        let what = match light {
            Emitter::Point(l) => format!("the point light at {}", told(l.position, world.centre)),
            Emitter::Spot(l) => format!("the spot light at {}", told(l.position(), world.centre)),
            Emitter::Goniometric(l) => {
                format!("the goniometric light at {}", told(l.position(), world.centre))
            }
            Emitter::Projector(l) => format!("the projector at {}", told(l.position(), world.centre)),
            _ => "the directional light".to_owned(),
        };
        notes.push(format!(
            "{what} shines on glass with {percent} % of its light, and light without size doesn't get through glass to where rays from the camera look for \
             it: what lies behind stays dark. The integrator `light` sends rays from the lamp, which do; and so does the light of a lamp that has a size, such as a \
             small sphere with `emission`"
        ));
    }
}

/// A tree for rays among many triangles, where the world has none; the hits are the same.
fn quick_search(world: &World, is_draft: bool) -> Option<accel::Scene> {
    /// Of so many triangles a tree is built in less time than rays of one light take without.
    const MANY: usize = 20_000;
    let triangles: usize = world.geometry.meshes.iter().map(|mesh| mesh.indices.len()).sum();
    if !is_draft || triangles < MANY {
        return None;
    }
    let params = accel::BvhParams { build: accel::Build::Fast, compact: true };
    let options = accel::Options { structure: accel::Structure::Bvh(params), ..accel::Options::default() };
    accel::Scene::build(world.accel.input(), &world.geometry, &options).ok()
}

/// A ray of a light's own, if it shines that way.
fn ray_of(world: &World, light: &Emitter, i: u32) -> Option<Ray> {
    let name = SampleName::new(0, [0, 0], i);
    let u = Pattern::Sobol.d2(&name, Purpose::Custom);
    match light {
        Emitter::Point(l) => Some(Ray::new(l.position, warp::uniform_sphere(u))),
        Emitter::Spot(l) => Some(Ray::new(l.position(), l.direction(u))),
        Emitter::Goniometric(l) => Some(Ray::new(l.position(), l.direction(u))),
        Emitter::Projector(l) => Some(Ray::new(l.position(), l.direction(u))),
        _ => {
            let towards = light
                .sample(
                    &world.geometry,
                    &Receiver::anywhere(Vec3::ZERO),
                    [0.5; 2],
                    &world.reading(Rgb::default()),
                )?
                .wi;
            let bounds = world.accel.bounds();
            let (middle, radius) = if bounds.is_empty() {
                (Vec3::ZERO, 1.0)
            } else {
                (bounds.center(), 0.5 * bounds.extent().length())
            };
            let [x, y] = warp::concentric_disc(u);
            let frame = Frame::from_normal(towards);
            let from = middle + frame.to_world(Vec3::new(x, y, 2.0)) * radius;
            Some(Ray::new(from, -towards))
        }
    }
}

/// A place of the scene, for people.
fn told(p: Vec3, centre: DVec3) -> String {
    let p = p.as_dvec3() + centre;
    format!("[{}, {}, {}]", tidy(p.x), tidy(p.y), tidy(p.z))
}

fn tidy(v: f64) -> f64 {
    (v * 1e3).round() / 1e3
}

/// Distances that the film can't hold.
pub(super) fn depth(bounds: Bounds, eye: DVec3, notes: &mut Vec<String>) {
    if bounds.is_empty() {
        return;
    }
    let far = bounds.corners().map(|c| (c.as_dvec3() - eye).length());
    let far = far.into_iter().fold(0.0, |a: f64, b| if b > a { b } else { a });
    if far > f64::from(MAX_VALUE) {
        notes.push(format!(
            "the scene reaches {far:.2e} m from the camera, but the layer `depth.Z` holds distances up to {MAX_VALUE:.2e} m: what is \
             farther is written as that. Use a larger unit of length, such as the kilometre"
        ));
    }
}

/// Sizes of a scene that lies this many of its own sizes from the origin are known to a ten-thousandth only.
const FAR: f64 = 64.0;

/// The middle, in whole metres, of a scene that is small for its distance from the origin. Numbers of single precision are told
/// by their size, so that rays there would slip through the seams of walls: it is rendered about its own middle.
pub(super) fn far_away(bounds: Bounds) -> Option<DVec3> {
    if bounds.is_empty() || !bounds.is_finite() {
        return None;
    }
    let middle = bounds.center().as_dvec3();
    let size = f64::from(bounds.extent().max_element());
    let away = middle.abs().max_element();
    (away > 1.0 && away > FAR * size)
        .then(|| DVec3::new(middle.x.round(), middle.y.round(), middle.z.round()))
}
