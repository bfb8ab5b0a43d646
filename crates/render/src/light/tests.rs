//! Every emitter against the contract, by being in [`registry`]; and closed forms.

use std::f64::consts::PI;

use straal_math::{Affine, DVec3, ops};
use straal_scene::Image;

use super::spot::Cone;
use super::*;
use crate::shape::tests::{Rng, assert_agrees, monte_carlo};
use crate::shape::{Disc, Parallelogram, Shape, Sphere, TriangleMesh};
use crate::testing::in_rgb;

mod copies;
mod density;
mod emitted;
mod many;
mod side_by_side;
mod textured;

pub(super) const RADIANCE: Light = Light::rgb([2.0, 3.0, 0.5]);

/// An emitter with what it stands on.
pub(super) struct Example {
    name: &'static str,
    geometry: Geometry,
    emitter: Emitter,
}

pub(super) fn shape(name: &'static str, shape: Shape, sides: Sides) -> Example {
    let geometry = Geometry { shapes: vec![shape], ..Geometry::default() };
    let surface = LitSurface::Shape(0);
    Example {
        name,
        geometry,
        emitter: Emitter::Area(AreaLight {
            surface,
            radiance: RADIANCE.into(),
            opacity: None,
            below: None,
            sides,
            spread: area::Spread::default(),
            placement: None,
        }),
    }
}

pub(super) fn mesh(name: &'static str, mesh: TriangleMesh, sides: Sides) -> Example {
    let geometry = Geometry { meshes: vec![mesh], ..Geometry::default() };
    let surface = LitSurface::mesh(&geometry, 0);
    Example {
        name,
        geometry,
        emitter: Emitter::Area(AreaLight {
            surface,
            radiance: RADIANCE.into(),
            opacity: None,
            below: None,
            sides,
            spread: area::Spread::default(),
            placement: None,
        }),
    }
}

/// The same with its light in a cone of some degrees.
pub(super) fn narrowed(name: &'static str, mut example: Example, degrees: f64) -> Example {
    if let Emitter::Area(light) = &mut example.emitter {
        light.spread = area::Spread::degrees(degrees);
    }
    Example { name, ..example }
}

pub(super) fn image(width: usize, height: usize, f: impl Fn(usize, usize) -> [f32; 3]) -> Image {
    let pixels = (0..width * height).map(|i| f(i % width, i / width)).collect();
    Image { width, height, pixels }
}

pub(super) fn surroundings(name: &'static str, image: &Image, to_world: &Affine) -> Example {
    let environment = ImageEnvironment::new(image, 0.5, to_world).unwrap();
    Example { name, geometry: Geometry::default(), emitter: Emitter::Image(Box::new(environment)) }
}

pub(super) fn turned() -> Affine {
    Affine::rotate(DVec3::new(1.0, 2.0, -1.0), 70.0).unwrap()
}

/// Everything in the list that can be sampled and has an extent. All stand within 2 of the origin and are lit towards some of
/// [`VIEWS`].
fn registry() -> Vec<Example> {
    super::registry()
        .into_iter()
        .flat_map(|(_, all)| all)
        .filter(|e| !e.emitter.is_delta() && !e.emitter.is_ambient())
        .collect()
}

#[test]
fn every_kind_is_registered() {
    for (name, examples) in super::registry() {
        assert!(!examples.is_empty(), "{name} has no example");
        for e in &examples {
            // Rust's own name of the variant.
            assert!(format!("{:?}", e.emitter).starts_with(name), "{} is no {name}", e.name);
            assert!((e.emitter.power(&e.geometry, 1.0) > 0.0) != e.emitter.is_ambient(), "{}", e.name);
        }
    }
}

/// A light without extent has one direction, which no ray finds, and is picked where it shines.
#[test]
fn lights_without_extent_keep_the_contract() {
    let all = super::registry().into_iter().flat_map(|(_, all)| all);
    for e in all.filter(|e| e.emitter.is_delta()) {
        let mut seen = 0;
        for p in VIEWS {
            assert_eq!(
                (e.emitter.pdf_from(&Receiver::anywhere(Vec3::ZERO), Vec3::Y), e.emitter.is_environment()),
                (0.0, false),
                "{}",
                e.name
            );
            assert_eq!(e.emitter.radiance_from(Vec3::Y, &in_rgb()), Light::ZERO, "{}", e.name);
            let Some(s) = e.emitter.sample(&e.geometry, &Receiver::anywhere(p), [0.3, 0.6], &in_rgb()) else {
                continue;
            };
            seen += 1;
            assert!(s.delta && s.pdf == 1.0 && (s.wi.length() - 1.0).abs() < 1e-6, "{}", e.name);
            assert!(s.radiance.is_finite() && !s.radiance.is_black(), "{}", e.name);
            assert_eq!(
                e.emitter.sample(&e.geometry, &Receiver::anywhere(p), [0.9, 0.1], &in_rgb()),
                Some(s),
                "{}",
                e.name
            );
            let table = LightTable::new(std::slice::from_ref(&e.emitter), &e.geometry, 1.0);
            assert!(table.pmf(0, &Receiver { p, n: Vec3::ZERO }) > 0.0, "{}", e.name);
            let reach = e.emitter.reach(&e.geometry).map(|r| r.estimate(&Receiver { p, n: s.wi }));
            let irradiance = s.radiance.max_lane();
            assert!((reach.expect("it is sampled") / irradiance - 1.0).abs() < 1e-4, "{}", e.name);
        }
        assert!(seen > 0, "{} lights nothing", e.name);
    }
}

const VIEWS: [Vec3; 4] = [
    Vec3::new(0.3, 2.0, 0.5),
    Vec3::new(-1.2, -1.9, 0.8),
    Vec3::new(9.0, 7.0, -8.0),
    Vec3::new(0.12, 0.25, 0.2),
];

impl Example {
    /// A light that isn't a surface.
    pub fn alone(name: &'static str, emitter: Emitter) -> Self {
        Self { name, geometry: Geometry::default(), emitter }
    }

    /// All points of the surface on a half-line, nearest first, with their triangle.
    fn crossings(&self, p: Vec3, w: Vec3) -> Vec<(u32, SurfacePoint)> {
        let mut out = vec![];
        if !self.geometry.shapes.is_empty() {
            let mut ray = Ray::new(p, w);
            while let Some(hit) = self.geometry.intersect(0, &ray) {
                out.push((0, self.geometry.surface(0, &ray, &hit)));
                ray.t_min = hit.t.next_up();
            }
        }
        for mesh in &self.geometry.meshes {
            let (o, d) = (p.as_dvec3(), w.as_dvec3());
            for i in 0..mesh.indices.len() as u32 {
                // Cramer's rule (Möller & Trumbore 1997).
                let [a, b, c] = mesh.corners(i).map(Vec3::as_dvec3);
                let (e1, e2, r) = (b - a, c - a, o - a);
                let scale = 1.0 / d.cross(e2).dot(e1);
                let (u, v) = (d.cross(e2).dot(r) * scale, r.cross(e1).dot(d) * scale);
                if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && r.cross(e1).dot(e2) * scale > 0.0 {
                    out.push((i, mesh.surface(i, u as f32, v as f32)));
                }
            }
            out.sort_by(|a, b| (a.1.p - p).length().total_cmp(&(b.1.p - p).length()));
        }
        out
    }

    /// The density of a direction: of the environment, or of every point of the surface that way. Round shapes seen
    /// from outside are sampled by direction: they have one density a direction, not one a point.
    fn pdf(&self, at: &Receiver, w: Vec3) -> f32 {
        let p = at.p;
        let crossings = self.crossings(p, w);
        let round = matches!(self.geometry.shapes.first(), Some(Shape::Sphere(_) | Shape::Ellipsoid(_)));
        let inside = crossings.first().is_some_and(|(_, s)| s.ng.dot(w) > 0.0);
        let points = if round && !inside && !crossings.is_empty() { &crossings[..1] } else { &crossings };
        let of = |(i, s): &(u32, SurfacePoint)| self.emitter.pdf_at(&self.geometry, at, *i, s);
        self.emitter.pdf_from(at, w) + points.iter().map(of).sum::<f32>()
    }
}

#[test]
fn what_is_sampled_is_what_is_hit() {
    let mut rng = Rng(31);
    for entry in registry() {
        for p in VIEWS {
            for i in 0..500 {
                let n = if i % 2 == 0 { Vec3::ZERO } else { rng.direction() };
                let Some(s) =
                    entry.emitter.sample(&entry.geometry, &Receiver { p, n }, rng.square(), &in_rgb())
                else {
                    continue;
                };
                assert!((s.wi.length() - 1.0).abs() < 1e-6 && !s.delta && s.pdf > 0.0, "{}", entry.name);
                match (s.far, s.to) {
                    (true, _) => {
                        let (radiance, pdf) = (
                            entry.emitter.radiance_from(s.wi, &in_rgb()),
                            entry.emitter.pdf_from(&Receiver { p, n }, s.wi),
                        );
                        assert_eq!(
                            entry.emitter.radiance_pdf_from(&Receiver { p, n }, s.wi, &in_rgb()),
                            (radiance, pdf)
                        );
                        let off = (radiance - s.radiance).map(f32::abs).max_lane();
                        // A direction's rounding, 1e-7, times the steepest slope between pixels, 250 a radian.
                        assert!(off < 1e-4, "{}: {radiance:?} against {s:?}", entry.name);
                        // On the border of two cells rounding decides which.
                        let crossed = pdf != s.pdf;
                        assert!(!crossed || rng.f() < 0.9, "{}: {pdf} against {s:?}", entry.name);
                    }
                    (false, end) => {
                        let at = SurfacePoint { p: end.p, p_err: end.p_err, ng: end.ng, ..blank() };
                        assert_eq!(
                            entry.emitter.radiance_at(&at, -s.wi, &in_rgb()),
                            s.radiance,
                            "{}",
                            entry.name
                        );
                        let to = (end.p - p).normalize();
                        assert!((to - s.wi).length() < 1e-5, "{}", entry.name);
                    }
                }
            }
        }
    }
}

fn blank() -> SurfacePoint {
    SurfacePoint { p: Vec3::ZERO, p_err: Vec3::ZERO, ng: Vec3::Z, n: Vec3::Z, uv: [0.0; 2] }
}

/// Irradiance (first lane) at `p` on a surface facing `n`, with nothing in the way.
fn irradiance(entry: &Example, p: Vec3, n: Vec3) -> (f64, f64) {
    monte_carlo(41, 100_000, |u| {
        entry.emitter.sample(&entry.geometry, &Receiver { p, n }, u, &in_rgb()).map_or(0.0, |s| {
            let cos = s.wi.dot(n);
            if cos > 0.0 { f64::from(s.radiance[0] * cos / s.pdf) } else { 0.0 }
        })
    })
}

#[test]
fn a_rectangle_gives_its_form_factor() {
    // A small surface below a corner of a parallel rectangle, a and b its edges over the distance (Howell, "A Catalog
    // of Radiation Heat Transfer Configuration Factors", B-3).
    let (w, l, h) = (1.2, 0.7, 0.9);
    let (a, b): (f64, f64) = (w / h, l / h);
    let term = |a: f64, b: f64| {
        let r = (1.0 + a * a).sqrt();
        a / r * ops::atan2_d(b, r)
    };
    let factor = (term(a, b) + term(b, a)) / (2.0 * PI);
    let corner = Vec3::new(0.0, h as f32, 0.0);
    let (a, b) = (Vec3::X * w as f32, Vec3::Z * l as f32);
    let down = Shape::Parallelogram(Box::new(Parallelogram::new(corner, a, b)));
    let quad = TriangleMesh {
        positions: [corner, corner + a, corner + a + b, corner + b].into(),
        indices: [[0, 1, 2], [0, 2, 3]].into(),
        normals: vec![],
        uvs: vec![],
        ..TriangleMesh::default()
    };
    for entry in [shape("rectangle", down, Sides::Front), mesh("quad", quad, Sides::Front)] {
        let want = PI * f64::from(RADIANCE[0]) * factor;
        assert_agrees(entry.name, irradiance(&entry, Vec3::ZERO, Vec3::Y), want);
        // Its other side is dark.
        assert_eq!(irradiance(&entry, Vec3::Y * 2.0, -Vec3::Y).0, 0.0);
    }
}

#[test]
fn spheres_and_discs_give_their_closed_form_irradiance() {
    let l = PI * f64::from(RADIANCE[0]);
    for (radius, height) in [(0.5, 2.0), (1.0, 1.001), (0.01, 100.0), (1.0, 1e4)] {
        let center = Vec3::Y * height;
        let entry = shape("sphere", Shape::Sphere(Sphere { center, radius }), Sides::Front);
        let ratio = f64::from(radius) / f64::from(height);
        assert_agrees("sphere", irradiance(&entry, Vec3::ZERO, Vec3::Y), l * ratio * ratio);
        let disc = Disc::new(center, Vec3::X * radius, Vec3::Z * radius);
        let entry = shape("disc", Shape::Disc(Box::new(disc)), Sides::Front);
        assert_agrees(
            "disc",
            irradiance(&entry, Vec3::ZERO, Vec3::Y),
            l * ratio * ratio / (1.0 + ratio * ratio),
        );
    }
    // Inside a sphere that shines inwards all directions are lit.
    let around = Shape::Sphere(Sphere { center: Vec3::ONE, radius: 3.0 });
    let entry = shape("around", around, Sides::Back);
    assert_agrees("around", irradiance(&entry, Vec3::ZERO, Vec3::X), l);
}

#[test]
fn an_even_environment_gives_pi_times_its_radiance() {
    let even = image(8, 4, |_, _| [4.0, 6.0, 1.0]); // halved by the scale
    let constant = Emitter::Constant(ConstantEnvironment { radiance: RADIANCE.into() });
    let constant = Example { name: "constant", geometry: Geometry::default(), emitter: constant };
    for entry in [constant, surroundings("even image", &even, &Affine::IDENTITY)] {
        let want = PI * f64::from(RADIANCE[0]);
        for n in [Vec3::Y, -Vec3::X] {
            assert_agrees(entry.name, irradiance(&entry, Vec3::ZERO, n), want);
        }
        assert!((entry.emitter.power(&entry.geometry, 2.0) / (16.0 * PI * PI * 3.0) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn pictures_lie_as_in_mitsuba() {
    let (w, h) = (8, 5);
    let picture = image(w, h, |x, y| [x as f32, y as f32, 1.0]);
    let e = ImageEnvironment::new(&picture, 1.0, &Affine::IDENTITY).unwrap();
    let near = |d: Vec3, want: [f32; 3]| {
        let got = e.radiance(d.normalize(), &in_rgb()).to_rgb();
        let off = (0..3).map(|i| (got[i] - want[i]).abs()).fold(0.0, |a: f32, b| if b > a { b } else { a });
        assert!(off < 1e-5, "{d:?}: {got:?}, expected {want:?}");
    };
    // The horizon is the middle row; the axes fall between two columns.
    near(Vec3::X, [1.5, 2.0, 1.0]);
    near(Vec3::Z, [3.5, 2.0, 1.0]);
    near(-Vec3::X, [5.5, 2.0, 1.0]);
    near(-Vec3::Z, [3.5, 2.0, 1.0]); // between the last and the first
    near(Vec3::new(1.0, 1.0, 0.0), [1.5, 1.0, 1.0]);
    assert!((e.radiance(Vec3::Y, &in_rgb())[1], e.radiance(-Vec3::Y, &in_rgb())[1]) == (0.0, 4.0));
    // Turned about +y by 90 degrees, what was along +z is along +x.
    let turned = ImageEnvironment::new(&picture, 1.0, &Affine::rotate(DVec3::Y, 90.0).unwrap()).unwrap();
    assert!((turned.radiance(Vec3::X, &in_rgb())[0] - 3.5).abs() < 1e-4);
}

#[test]
fn strange_pictures_are_refused_or_read_as_black() {
    let new = |i: &Image| ImageEnvironment::new(i, 1.0, &Affine::IDENTITY);
    assert!(new(&Image::default()).is_none());
    assert!(new(&Image { width: 3, height: 2, pixels: vec![[1.0; 3]; 5] }).is_none());
    assert!(new(&Image { width: usize::MAX, height: 2, pixels: vec![[1.0; 3]; 5] }).is_none());
    let odd = image(4, 3, |x, _| [f32::NAN, -1.0, if x == 2 { f32::NEG_INFINITY } else { 0.0 }]);
    let e = new(&odd).unwrap();
    assert_eq!(e.radiance(Vec3::X, &in_rgb()), Light::ZERO);
    assert_eq!(
        (e.sample(Vec3::ZERO, [0.5; 2], &in_rgb()), e.pdf(Vec3::ZERO, Vec3::X), e.power(1.0)),
        (None, 0.0, 0.0)
    );
    let even = image(4, 3, |_, _| [1.0; 3]);
    assert!(ImageEnvironment::new(&even, 1.0, &Affine::scale(DVec3::ZERO)).is_none());
}

#[test]
fn delta_lights_give_their_irradiance() {
    let intensity = Light::rgb([8.0, 4.0, 2.0]);
    let geometry = Geometry::default();
    let position = Vec3::new(0.0, 2.0, 0.0);
    let at = |e: &Emitter, p: Vec3| {
        let s = e.sample(&geometry, &Receiver::anywhere(p), [0.3, 0.7], &in_rgb());
        assert!(s.is_none_or(|s| s.delta && s.pdf == 1.0 && (s.wi.length() - 1.0).abs() < 1e-6));
        assert_eq!(
            (e.pdf_from(&Receiver::anywhere(Vec3::ZERO), Vec3::Y), e.radiance_from(Vec3::Y, &in_rgb())),
            (0.0, Light::ZERO)
        );
        s.map_or(0.0, |s| s.radiance[0])
    };
    let point = Emitter::Point(PointLight { position, intensity: intensity.into(), falls: true });
    assert_eq!(at(&point, Vec3::ZERO), 2.0);
    assert_eq!(at(&point, Vec3::new(0.0, -2.0, 0.0)), 0.5);
    assert_eq!(at(&point, position), 0.0);

    let cone = Cone { axis: -Vec3::Y * 3.0, beam: 15.0, cutoff: 20.0, falloff: Falloff::Linear };
    let below = |degrees: f64, cone: &Cone| {
        let (s, c) = ops::sin_cos_degrees(degrees);
        let p = position + Vec3::new(s as f32, -c as f32, 0.0) * 2.0;
        at(&Emitter::Spot(SpotLight::new(position, intensity, cone).unwrap()), p)
    };
    let smooth = Cone { falloff: Falloff::Smooth, ..cone };
    let wide = Cone { beam: 50.0, ..cone };
    let cos = |d: f64| ops::sin_cos_degrees(d).1;
    let x = (cos(17.0) - cos(20.0)) / (cos(15.0) - cos(20.0));
    for (cone, degrees, share) in [
        (&cone, 0.0, 1.0),
        (&cone, 14.9, 1.0),
        (&cone, 16.0, 0.8),
        (&cone, 19.0, 0.2),
        (&cone, 20.1, 0.0),
        (&cone, 180.0, 0.0),
        (&smooth, 17.0, x * x * (3.0 - 2.0 * x)),
        (&smooth, 14.9, 1.0),
        (&wide, 19.9, 1.0),
        (&wide, 20.1, 0.0),
    ] {
        let got = f64::from(below(degrees, cone));
        assert!((got - 2.0 * share).abs() < 1e-5, "{cone:?} at {degrees}: {got}");
    }
    let sun = Emitter::Directional(DirectionalLight::new(Vec3::new(0.0, -3.0, 0.0), intensity).unwrap());
    assert_eq!((at(&sun, Vec3::ZERO), at(&sun, Vec3::X * 1e9)), (8.0, 8.0));
    assert_eq!(
        sun.sample(&geometry, &Receiver::anywhere(Vec3::ZERO), [0.0; 2], &in_rgb()).map(|s| s.wi),
        Some(Vec3::Y)
    );
    assert!(DirectionalLight::new(Vec3::ZERO, intensity).is_none());
}

#[test]
fn power_is_what_leaves_in_all_directions() {
    // The flux through a large sphere around: irradiance on it times its area, by sampling from its points.
    let around = 40.0_f32;
    for entry in registry() {
        if entry.emitter.is_environment() || entry.name == "sphere, inside" {
            continue;
        }
        let convex = !entry.name.starts_with("cylinder");
        let mut rng = Rng(51);
        let flux = monte_carlo(52, 30_000, |u| {
            let p = rng.direction() * around;
            entry.emitter.sample(&entry.geometry, &Receiver::anywhere(p), u, &in_rgb()).map_or(0.0, |s| {
                let cos = s.wi.dot(-p.normalize());
                // The far side of a closed shape that shines on both is hidden.
                let front = match (s.far, s.to) {
                    (false, end) => {
                        entry.crossings(p, s.wi).first().is_none_or(|(_, c)| (c.p - end.p).length() < 1e-3)
                    }
                    (true, _) => true,
                };
                if front || !convex { f64::from(s.radiance.max_lane() * cos / s.pdf) } else { 0.0 }
            }) * 4.0
                * PI
                * f64::from(around * around)
        });
        let mut power = entry.emitter.power(&entry.geometry, 1.0);
        if entry.name == "ellipsoid" || entry.name == "cuboid, both" {
            power *= 0.5; // what shines inwards stays inside
        }
        assert_agrees(entry.name, flux, power);
    }
    let spot = |cutoff| {
        let cone = Cone { axis: Vec3::X, beam: cutoff, cutoff, falloff: Falloff::Linear };
        Emitter::Spot(SpotLight::new(Vec3::ZERO, RADIANCE, &cone).unwrap()).power(&Geometry::default(), 1.0)
    };
    let point = Emitter::Point(PointLight { position: Vec3::ZERO, intensity: RADIANCE.into(), falls: true });
    let point = point.power(&Geometry::default(), 1.0);
    assert!((spot(180.0) / point - 1.0).abs() < 1e-6 && (spot(90.0) / point - 0.5).abs() < 1e-6);
}

#[test]
fn black_lights_are_never_sampled() {
    for mut entry in registry() {
        match &mut entry.emitter {
            Emitter::Area(l) => l.radiance = Light::ZERO.into(),
            Emitter::Constant(l) => l.radiance = Light::ZERO.into(),
            _ => continue,
        }
        assert_eq!(entry.emitter.power(&entry.geometry, 1.0), 0.0);
        let table = LightTable::new(std::slice::from_ref(&entry.emitter), &entry.geometry, 1.0);
        let at = Receiver { p: VIEWS[0], n: Vec3::ZERO };
        assert_eq!((table.pick(0.5, &at, Within::WORLD), table.pmf(0, &at)), (None, 0.0));
        for p in VIEWS {
            assert_eq!(
                entry.emitter.sample(&entry.geometry, &Receiver::anywhere(p), [0.4, 0.6], &in_rgb()),
                None,
                "{}",
                entry.name
            );
            assert_eq!(entry.pdf(&Receiver::anywhere(p), (-p).normalize()), 0.0, "{}", entry.name);
        }
    }
}

#[test]
fn shadow_rays_end_before_the_light_and_start_off_the_surface() {
    let mut rng = Rng(61);
    let receiver = Sphere { center: Vec3::ZERO, radius: 0.05 };
    for entry in registry() {
        for p in VIEWS {
            for _ in 0..300 {
                let from = Sphere { center: p, ..receiver }.sample_area(rng.square()).point;
                let Some(s) = entry.emitter.sample(
                    &entry.geometry,
                    &Receiver::anywhere(from.p),
                    rng.square(),
                    &in_rgb(),
                ) else {
                    continue;
                };
                if s.wi.dot(from.ng) < 0.01 {
                    continue;
                }
                let ray = s.shadow_ray(&(&from).into());
                assert!((ray.d.normalize() - s.wi).length() < 1e-4);
                assert_eq!(
                    Sphere { center: p, ..receiver }.analytic().intersect(&ray),
                    None,
                    "{}",
                    entry.name
                );
                match (s.far, s.to) {
                    (true, _) => assert_eq!(ray.t_max, f32::INFINITY),
                    (false, end) => {
                        assert!(ray.t_max < 1.0 && ray.t_max > 0.99999);
                        assert!((ray.at(ray.t_max) - end.p).length() < 1e-4);
                        let flat = entry.name.starts_with("disc") || entry.name.starts_with("para");
                        if flat && end.ng.dot(s.wi).abs() > 0.01 {
                            assert_eq!(entry.geometry.intersect(0, &ray), None, "{}", entry.name);
                        }
                    }
                }
            }
        }
    }
}

fn whole(index: u32, pmf: f32, rest: f32) -> Pick {
    Pick { index, pmf, rest, part: u32::MAX, copy: 0 }
}

#[test]
fn black_lights_are_never_picked() {
    let at = |i: f32| {
        Emitter::Point(PointLight { position: Vec3::ZERO, intensity: Light::rgb([i; 3]).into(), falls: true })
    };
    let geometry = Geometry::default();
    assert_eq!(
        LightTable::new(&[], &geometry, 1.0).pick(0.0, &Receiver::anywhere(Vec3::ONE), Within::WORLD),
        None
    );
    let one = LightTable::new(&[at(0.0), at(3.0), at(f32::NAN)], &geometry, 1.0);
    assert_eq!(
        one.pick(0.3, &Receiver { p: Vec3::ONE, n: Vec3::X }, Within::WORLD),
        Some(whole(1, 1.0, 0.3))
    );
}

#[test]
fn few_lights_are_picked_by_what_they_bring() {
    let point = |position, i: f32| {
        Emitter::Point(PointLight { position, intensity: Light::rgb([i; 3]).into(), falls: true })
    };
    let sun = DirectionalLight::new(-Vec3::Z, Light::rgb([1.0; 3])).unwrap();
    let sky = ConstantEnvironment { radiance: Light::rgb([0.5; 3]).into() };
    let emitters = [
        point(Vec3::new(0.0, 0.0, 2.0), 4.0),
        point(Vec3::new(0.0, 0.0, -2.0), 4.0),
        Emitter::Directional(sun),
        Emitter::Constant(sky),
    ];
    let geometry = Geometry::default();
    let table = LightTable::new(&emitters, &geometry, 10.0);
    for n in [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(0.6, 0.0, 0.8), Vec3::ZERO] {
        for p in [Vec3::ZERO, Vec3::new(1.0, 2.0, 0.5), Vec3::new(0.0, 0.0, 1.9)] {
            let at = Receiver { p, n };
            let cos = |d: Vec3| if n == Vec3::ZERO { 1.0 } else { ops::max(d.normalize().dot(n), 0.0) };
            let from = |q: Vec3| 4.0 * cos(q - p) / (q - p).length_squared();
            let around = if n == Vec3::ZERO { 4.0 } else { 1.0 };
            let brought = [
                from(Vec3::new(0.0, 0.0, 2.0)),
                from(Vec3::new(0.0, 0.0, -2.0)),
                cos(Vec3::Z),
                // Scattered rays find most of what comes from all around.
                0.1 * 0.5 * around * std::f32::consts::PI,
            ];
            let total: f32 = brought.iter().sum();
            let lit = brought.iter().filter(|v| **v > 0.0).count() as f32;
            let mut first = 0.0;
            for (i, brought) in brought.into_iter().enumerate() {
                let pmf = table.pmf(i as u32, &at);
                let want = if brought > 0.0 { (1.0 + (16.0 - lit) * brought / total) / 16.0 } else { 0.0 };
                assert!(
                    (pmf - want).abs() <= 1.0 / 16.0 && (pmf > 0.0) == (want > 0.0),
                    "{i} {at:?}: {pmf} {want}"
                );
                assert_eq!((pmf * 16.0).fract(), 0.0);
                // The same probability is drawn, and what is left of the number is even again.
                for k in 0..5 {
                    let rest = k as f32 / 8.0;
                    if pmf > 0.0 {
                        assert_eq!(
                            table.pick(first + rest * pmf, &at, Within::WORLD),
                            Some(whole(i as u32, pmf, rest))
                        );
                    }
                }
                first += pmf;
            }
            assert_eq!(first, 1.0);
        }
    }
    // Where nothing shines there is nothing to pick.
    let below = LightTable::new(&[emitters[0].clone(), emitters[2].clone()], &geometry, 1.0);
    assert_eq!(below.pick(0.3, &Receiver { p: Vec3::ZERO, n: -Vec3::Z }, Within::WORLD), None);
}

/// What is never picked never shines there, and no light that brings most of it is forgotten.
#[test]
fn estimates_are_near_what_lights_bring() {
    let mut rng = Rng(72);
    for entry in registry() {
        let Some(reach) = entry.emitter.reach(&entry.geometry) else { continue };
        for p in VIEWS {
            for n in [Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z, (-p).try_normalize().unwrap_or(Vec3::X)]
            {
                let rounds = 2000;
                let mut sum = 0.0;
                for _ in 0..rounds {
                    let at = Receiver { p, n };
                    if let Some(s) = entry.emitter.sample(&entry.geometry, &at, rng.square(), &in_rgb()) {
                        sum += s.radiance.max_lane() * ops::max(s.wi.dot(n), 0.0) / s.pdf;
                    }
                }
                let brought = sum / rounds as f32;
                let estimate = reach.estimate(&Receiver { p, n });
                assert!(brought == 0.0 || estimate > 0.0, "{} at {p:?}, {n:?}: {brought}", entry.name);
                let whole = reach.estimate(&Receiver { p, n: Vec3::ZERO });
                assert!(brought <= 8.0 * whole, "{} at {p:?}: {brought} {whole}", entry.name);
            }
        }
    }
}
