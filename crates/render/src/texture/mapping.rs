//! How patterns lie on surfaces.
//!
//! A pattern of the plane is laid on a surface by its own texture coordinates, or by a *mapping* of places in space: onto a plane, a
//! cylinder, a sphere or a cube around the thing, as if it were wrapped in it (Bier and Sloan 1986, "Two-Part Texture Mappings"), through a projector, or
//! along three axes at once. The cylinder, the sphere and the cube stand about the origin, between -1 and 1, upright along y and with the middle of the
//! picture in front, towards +z; the mapping's transform puts them elsewhere.
//!
//! What a pixel sees is mapped with it, by the derivatives of these formulas: so no seam is blurred where angles begin again.

use std::f32::consts::FRAC_1_PI;

use straal_math::{Affine, DVec3, Transform, Vec3, ops};
use straal_scene::desc;

use super::{Place, ShadingPoint, Spot};
use crate::shape::TriangleMesh;

/// How a pattern lies on a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Mapping {
    /// By the texture coordinates as they are.
    Coordinates,
    /// By the texture coordinates times a matrix of two rows; the last number of each is added.
    Plane([[f32; 3]; 2]),
    /// By what a mesh has of two numbers, its number first, times a matrix as well. Where it has none, all is at the origin.
    Attribute(u32, Box<[[f32; 3]; 2]>),
    /// By places in space.
    Space(Box<InSpace>),
}

/// A mapping by places in space.
#[derive(Clone, Debug, PartialEq)]
pub struct InSpace {
    /// Whether the places are those of the world: the pattern stays where it is when the thing moves.
    of_world: bool,
    /// From the mapping's own space.
    transform: Transform,
    /// What is done to the coordinates that come of it, as in [`Mapping::Plane`].
    uv: [[f32; 3]; 2],
    onto: Onto,
}

/// What space is mapped onto.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Onto {
    Plane,
    /// Angle about z and distance from it.
    Disc,
    Cylinder,
    Sphere,
    Cube,
    /// Three planes at once; how quickly one gives way to the other.
    Three(f32),
    /// Through a lens at the origin that looks along -z: half of what it sees at distance 1, across and up.
    Lens([f32; 2]),
}

impl Mapping {
    /// Of what a scene says; `centre` is what of the description's space lies at the world's origin.
    pub(crate) fn of(said: &desc::Mapping, centre: DVec3, attribute: impl FnOnce(&str) -> u32) -> Self {
        let (space, transform, uv, onto) = match said {
            desc::Mapping::Uv(d) => return Self::of_uv(d),
            desc::Mapping::Attribute(d) => {
                return Self::Attribute(attribute(&d.name.0.value), Box::new(matrix(&d.uv)));
            }
            desc::Mapping::Planar(d) => (&d.space, transform(&d.transform), matrix(&d.uv), Onto::Plane),
            desc::Mapping::Polar(d) => (&d.space, transform(&d.transform), matrix(&d.uv), Onto::Disc),
            desc::Mapping::Cylindrical(d) => {
                (&d.space, transform(&d.transform), matrix(&d.uv), Onto::Cylinder)
            }
            desc::Mapping::Spherical(d) => (&d.space, transform(&d.transform), matrix(&d.uv), Onto::Sphere),
            desc::Mapping::Cube(d) => (&d.space, transform(&d.transform), matrix(&d.uv), Onto::Cube),
            desc::Mapping::Triplanar(d) => {
                (&d.space, transform(&d.transform), matrix(&d.uv), Onto::Three(d.sharpness as f32))
            }
            desc::Mapping::Camera(d) => {
                let stands = Affine::look_at(d.eye, d.look_at, d.up).unwrap_or(Affine::IDENTITY);
                let (sin, cos) = ops::sin_cos_degrees(0.5 * d.fov);
                let half = sin / cos;
                let onto = Onto::Lens([half as f32, (half / d.aspect) as f32]);
                (&d.space, stands, matrix(&desc::UvMapping::default()), onto)
            }
        };
        let of_world = *space == desc::MappingSpace::World;
        let all = if of_world { transform.then(&Affine::translate(-centre)) } else { transform };
        let transform = Transform::new(&all).unwrap_or(Transform::IDENTITY);
        Self::Space(Box::new(InSpace { of_world, transform, uv, onto }))
    }

    fn of_uv(d: &desc::UvMapping) -> Self {
        if *d == desc::UvMapping::default() {
            return Self::Coordinates;
        }
        Self::Plane(matrix(d))
    }

    /// What a pattern has at a point, where `pattern` tells it for places of the plane: the mean of several where it is blended.
    #[inline]
    pub fn over<const N: usize>(
        &self,
        at: &ShadingPoint,
        meshes: &[TriangleMesh],
        pattern: impl Fn(&Spot) -> [f32; N],
    ) -> [f32; N] {
        match self {
            Self::Attribute(id, m) => pattern(&moved(m, &by_attribute(*id, at, meshes))),
            Self::Coordinates => pattern(&spot_of(at)),
            Self::Plane(m) => pattern(&moved(m, &spot_of(at))),
            Self::Space(mapping) => mapping.over(at, pattern),
        }
    }
}

/// By two numbers that the mesh has at its vertices.
fn by_attribute(id: u32, at: &ShadingPoint, meshes: &[TriangleMesh]) -> Spot {
    let nowhere = Spot { st: [0.0; 2], dx: [0.0; 2], dy: [0.0; 2], lot: at.lot };
    let Some(on) = &at.on_mesh else { return nowhere };
    let Some(mesh) = meshes.get(on.mesh as usize) else { return nowhere };
    let Some([a, b, c]) = mesh.coordinates(id, on.triangle) else { return nowhere };
    // From corner 0 to the others.
    let [along, across] = [b, c].map(|corner| [corner[0] - a[0], corner[1] - a[1]]);
    let of = |[u, v]: [f32; 2]| [0, 1].map(|k| u * along[k] + v * across[k]);
    let [s, t] = of(on.place);
    let change = |duv| of(mesh.place_change(on.triangle, duv));
    Spot { st: [a[0] + s, a[1] + t], dx: change(at.duvdx), dy: change(at.duvdy), lot: at.lot }
}

/// Scaled, then turned, then moved.
fn matrix(d: &desc::UvMapping) -> [[f32; 3]; 2] {
    let (sin, cos) = ops::sin_cos_degrees(d.rotate);
    let [a, b] = d.scale;
    let [x, y] = d.translate;
    [[cos * a, -sin * b, x], [sin * a, cos * b, y]].map(|row| row.map(|v| v as f32))
}

/// A spot whose coordinates are multiplied by a matrix.
fn moved(m: &[[f32; 3]; 2], spot: &Spot) -> Spot {
    let along = |[u, v]: [f32; 2]| m.map(|row| row[0] * u + row[1] * v);
    let [s, t] = along(spot.st);
    Spot { st: [s + m[0][2], t + m[1][2]], dx: along(spot.dx), dy: along(spot.dy), lot: spot.lot }
}

/// By the texture coordinates.
#[inline(always)]
fn spot_of(at: &ShadingPoint) -> Spot {
    Spot { st: at.uv, dx: at.duvdx, dy: at.duvdy, lot: at.lot }
}

/// Validation has seen that it is none without an inverse.
fn transform(said: &desc::Transform) -> Affine {
    said.affine().unwrap_or(Affine::IDENTITY)
}

impl InSpace {
    fn over<const N: usize>(&self, at: &ShadingPoint, pattern: impl Fn(&Spot) -> [f32; N]) -> [f32; N] {
        let (place, n) = if self.of_world { (&at.world, at.frame.n) } else { (&at.object, at.object_n) };
        let m = &self.transform;
        let own = Place {
            p: m.inverse_point(place.p),
            dpdx: m.inverse_vector(place.dpdx),
            dpdy: m.inverse_vector(place.dpdy),
        };
        let Onto::Three(sharpness) = self.onto else {
            return pattern(&self.spot(&own, self.onto, at.lot));
        };
        // Normals as seen from the mapping's space.
        let to = |axis: Vec3| m.vector(axis).dot(n).abs();
        let weights = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| ops::pow(to(axis), sharpness));
        let sum = weights[0] + weights[1] + weights[2];
        if let Some([u, v]) = at.lot {
            // One of them, by its share; what is left of the number is even again.
            let mut rest = u * sum;
            let last = if weights[2] > 0.0 { 2 } else { usize::from(weights[1] > 0.0) };
            let mut k = 0;
            while k < last && rest >= weights[k] {
                rest -= weights[k];
                k += 1;
            }
            let left = rest / weights[k];
            let left = if left >= 0.0 { ops::min(left, 1.0 - f32::EPSILON) } else { 0.0 };
            return pattern(&self.spot(&turned(&own, k), Onto::Plane, Some([left, v])));
        }
        let mut out = [0.0; N];
        for (k, weight) in weights.into_iter().enumerate() {
            let share = if sum > 0.0 { weight / sum } else { [0.0, 0.0, 1.0][k] };
            // Where one counts for next to nothing it isn't asked.
            if share > 1e-3 {
                let spot = self.spot(&turned(&own, k), Onto::Plane, None);
                let found = pattern(&spot);
                (0..N).for_each(|i| out[i] += share * found[i]);
            }
        }
        let told: f32 =
            weights.iter().map(|w| if sum > 0.0 { w / sum } else { 0.0 }).filter(|s| *s > 1e-3).sum();
        if told > 0.0 { out.map(|v| v / told) } else { out }
    }

    fn spot(&self, at: &Place, onto: Onto, lot: Option<[f32; 2]>) -> Spot {
        let Place { p, dpdx, dpdy } = *at;
        let (st, dx, dy) = match onto {
            Onto::Plane | Onto::Three(_) => {
                let of = |v: Vec3| [v.x, v.y];
                (of(p), of(dpdx), of(dpdy))
            }
            Onto::Disc => {
                let square = p.x * p.x + p.y * p.y;
                let angle = 0.5 * FRAC_1_PI * ops::atan2(p.y, p.x);
                let of = |d: Vec3| {
                    let along = p.x * d.x + p.y * d.y;
                    [0.5 * FRAC_1_PI * (p.x * d.y - p.y * d.x) / square, along / square.sqrt()]
                };
                let around = if angle < 0.0 { angle + 1.0 } else { angle };
                ([around, square.sqrt()], of(dpdx), of(dpdy))
            }
            Onto::Cylinder => {
                let of = |d: Vec3| [around(p, d), 0.5 * d.y];
                ([angle(p), 0.5 + 0.5 * p.y], of(dpdx), of(dpdy))
            }
            Onto::Sphere => {
                let across = (p.x * p.x + p.z * p.z).sqrt();
                let square = across * across + p.y * p.y;
                // From the lower pole to the upper.
                let up = 0.5 + FRAC_1_PI * ops::atan2(p.y, across);
                let of = |d: Vec3| {
                    let out = (p.x * d.x + p.z * d.z) / across;
                    [around(p, d), FRAC_1_PI * (across * d.y - p.y * out) / square]
                };
                ([angle(p), up], of(dpdx), of(dpdy))
            }
            Onto::Cube => {
                // Onto the side that a ray from the middle meets.
                let side = (0..3).fold(2, |most, k| if p[k].abs() > p[most].abs() { k } else { most });
                let sign = if p[side] < 0.0 { -1.0 } else { 1.0 };
                let (s, t, depth) = axes(side, sign);
                let size = depth.dot(p);
                let [x, y] = [s.dot(p), t.dot(p)].map(|v| v / size);
                let of = |d: Vec3| {
                    let deeper = depth.dot(d) / size;
                    [0.5 * (s.dot(d) / size - x * deeper), 0.5 * (t.dot(d) / size - y * deeper)]
                };
                ([0.5 + 0.5 * x, 0.5 + 0.5 * y], of(dpdx), of(dpdy))
            }
            Onto::Lens(half) => {
                let depth = -p.z;
                let [x, y] = [p.x / (depth * half[0]), p.y / (depth * half[1])];
                let of = |d: Vec3| {
                    let deeper = -d.z / depth;
                    [
                        0.5 * (d.x / (depth * half[0]) - x * deeper),
                        0.5 * (d.y / (depth * half[1]) - y * deeper),
                    ]
                };
                if depth > 0.0 {
                    ([0.5 + 0.5 * x, 0.5 + 0.5 * y], of(dpdx), of(dpdy))
                } else {
                    // What is behind lies far outside.
                    ([-1e6, -1e6], [0.0; 2], [0.0; 2])
                }
            }
        };
        let sound = |v: [f32; 2]| v.map(|v| if v.is_finite() { v } else { 1e6 });
        moved(&self.uv, &Spot { st: sound(st), dx: sound(dx), dy: sound(dy), lot })
    }
}

/// Once around y, from the back by way of +x... seen from outside to the right: 0 to 1, one half in front.
fn angle(p: Vec3) -> f32 {
    0.5 + 0.5 * FRAC_1_PI * ops::atan2(p.x, p.z)
}

/// How that changes.
fn around(p: Vec3, d: Vec3) -> f32 {
    0.5 * FRAC_1_PI * (p.z * d.x - p.x * d.z) / (p.x * p.x + p.z * p.z)
}

/// The directions of s, t and outwards on a cube's side, upright where there is an up; on its top and bottom the front is below and above.
fn axes(side: usize, sign: f32) -> (Vec3, Vec3, Vec3) {
    match side {
        0 => (Vec3::Z * -sign, Vec3::Y, Vec3::X * sign),
        1 => (Vec3::X, Vec3::Z * -sign, Vec3::Y * sign),
        _ => (Vec3::X * sign, Vec3::Y, Vec3::Z * sign),
    }
}

/// Places as a plane across an axis has them: s and t in the first two numbers.
fn turned(at: &Place, axis: usize) -> Place {
    let turn = |v: Vec3| match axis {
        0 => Vec3::new(-v.z, v.y, v.x),
        1 => Vec3::new(v.x, -v.z, v.y),
        _ => v,
    };
    Place { p: turn(at.p), dpdx: turn(at.dpdx), dpdy: turn(at.dpdy) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_math::lowdisc::{Pattern, Purpose, SampleName};

    fn in_space(onto: Onto) -> InSpace {
        let turn = Affine::rotate(DVec3::new(1.0, 2.0, 0.5), 40.0).unwrap();
        let all = Affine::scale(DVec3::new(1.0, 1.5, 0.7))
            .then(&turn)
            .then(&Affine::translate(DVec3::new(0.1, 0.2, 0.3)));
        let transform = Transform::new(&all).unwrap();
        InSpace { of_world: false, transform, uv: [[3.0, 0.0, 0.5], [0.0, 2.0, 0.0]], onto }
    }

    fn at(p: Vec3, dpdx: Vec3, dpdy: Vec3) -> ShadingPoint {
        let object = Place { p, dpdx, dpdy };
        ShadingPoint {
            object,
            object_n: Vec3::new(0.2, 0.3, 0.9).normalize(),
            ..ShadingPoint::of([0.0; 2], p)
        }
    }

    fn st(mapping: &InSpace, at: &ShadingPoint) -> [f32; 6] {
        mapping.over(at, |spot| [spot.st[0], spot.st[1], spot.dx[0], spot.dx[1], spot.dy[0], spot.dy[1]])
    }

    /// Footprints are the differences of neighbouring points.
    #[test]
    fn what_a_pixel_sees_is_mapped_with_it() {
        for onto in [
            Onto::Plane,
            Onto::Disc,
            Onto::Cylinder,
            Onto::Sphere,
            Onto::Cube,
            Onto::Three(4.0),
            Onto::Lens([0.5, 0.3]),
        ] {
            let mapping = in_space(onto);
            let mut tried = 0;
            for i in 0..200 {
                let name = SampleName::new(11, [0, 0], i);
                let [a, b, c, d] = Pattern::Random.d4(&name, Purpose::Custom);
                let p = Vec3::new(2.0 * a - 1.0, 2.0 * b - 1.0, 2.0 * c - 1.0);
                let step = 1e-3;
                let (dx, dy) = (Vec3::new(step, 0.0, step * d), Vec3::new(-step * d, step, 0.0));
                let told = st(&mapping, &at(p, dx, dy));
                for (k, dp) in [(2, dx), (4, dy)] {
                    let near = |sign: f32| st(&mapping, &at(p + dp * (0.5 * sign), Vec3::ZERO, Vec3::ZERO));
                    let (after, before) = (near(1.0), near(-1.0));
                    for j in 0..2 {
                        let found = after[j] - before[j];
                        // Steps across a seam, onto another side, behind the lens, or near a pole are no test.
                        if found.abs() > 0.05 {
                            continue;
                        }
                        tried += 1;
                        let off = (found - told[k + j]).abs();
                        assert!(
                            off < 0.05 * found.abs() + 1e-4,
                            "{onto:?} {p:?}: {found}, told {}",
                            told[k + j]
                        );
                    }
                }
            }
            assert!(tried > 300, "{onto:?}: {tried}");
        }
    }

    #[test]
    fn pictures_lie_upright_and_are_not_mirrored() {
        let mapping = |onto| InSpace {
            transform: Transform::new(&Affine::IDENTITY).unwrap(),
            uv: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            ..in_space(onto)
        };
        let place = |onto, p: [f32; 3]| {
            let [s, t, ..] = st(&mapping(onto), &at(Vec3::from_array(p), Vec3::ZERO, Vec3::ZERO));
            [s, t].map(|v| (v * 1000.0 + 0.5).floor() / 1000.0)
        };
        for onto in [Onto::Cylinder, Onto::Sphere, Onto::Cube] {
            // In front is the middle; what is seen to the right of it is further on, what is above higher.
            assert_eq!(place(onto, [0.0, 0.0, 1.0]), [0.5, 0.5], "{onto:?}");
            assert!(
                place(onto, [0.2, 0.0, 1.0])[0] > 0.5 && place(onto, [0.0, 0.2, 1.0])[1] > 0.5,
                "{onto:?}"
            );
        }
        assert_eq!(place(Onto::Sphere, [1.0, 0.0, 0.0]), [0.75, 0.5]);
        assert_eq!(place(Onto::Sphere, [0.0, 1.0, 0.0])[1], 1.0);
        assert_eq!(place(Onto::Cylinder, [-1.0, -1.0, 0.0]), [0.25, 0.0]);
        // The right side, seen from there: to its right lies the back.
        assert!(place(Onto::Cube, [1.0, 0.0, -0.5])[0] > 0.5);
        assert_eq!(place(Onto::Cube, [0.0, 1.0, 1.0 / 3.0]), [0.5, 0.333]);
        assert_eq!(place(Onto::Lens([0.5, 0.25]), [0.5, 0.0, -2.0]), [0.75, 0.5]);
        assert_eq!(place(Onto::Plane, [0.25, 3.5, 9.0]), [0.25, 3.5]);
        assert_eq!(place(Onto::Disc, [0.0, 2.0, 9.0]), [0.25, 2.0]);
        assert_eq!(place(Onto::Disc, [0.0, -0.5, 1.0]), [0.75, 0.5]);
    }

    /// Where both sets of coordinates are linear in the place, one follows from the other, and so do footprints.
    #[test]
    fn another_set_of_coordinates_has_its_own_footprint() {
        use crate::texture::{MeshAttribute, OnMesh};
        use straal_scene::mesh::Per;
        let corners = [[0.1, 0.2], [0.7, 0.3], [0.2, 0.9]];
        let second = |[u, v]: [f32; 2]| [3.0 * u - v + 0.5, 0.5 * u + 2.0 * v - 1.0];
        let linear = |[u, v]: [f32; 2]| [3.0 * u - v, 0.5 * u + 2.0 * v];
        let values = corners.iter().flat_map(|uv| second(*uv)).collect();
        let attribute = MeshAttribute { id: 4, per: Per::Vertex, channels: 2, is_code: false, values };
        let mesh = TriangleMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y].into(),
            indices: vec![[0, 1, 2]].into(),
            uvs: corners.to_vec(),
            attributes: vec![attribute],
            ..TriangleMesh::default()
        };
        let place = [0.3, 0.45];
        let uv = [0, 1].map(|k| {
            corners[0][k]
                + place[0] * (corners[1][k] - corners[0][k])
                + place[1] * (corners[2][k] - corners[0][k])
        });
        let (duvdx, duvdy) = ([0.01, 0.02], [-0.03, 0.005]);
        let on_mesh = Some(OnMesh { mesh: 0, triangle: 0, place });
        let at = ShadingPoint { on_mesh, duvdx, duvdy, ..ShadingPoint::of(uv, Vec3::ZERO) };
        let mapping = Mapping::Attribute(4, Box::new([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
        let got = |meshes: &[TriangleMesh]| {
            mapping.over(&at, meshes, |s| [s.st[0], s.st[1], s.dx[0], s.dx[1], s.dy[0], s.dy[1]])
        };
        let want = [second(uv), linear(duvdx), linear(duvdy)].concat();
        let found = got(std::slice::from_ref(&mesh));
        for (got, want) in found.into_iter().zip(want) {
            assert!((got - want).abs() < 1e-5, "{got}, not {want}");
        }
        assert_eq!(got(&[TriangleMesh { attributes: vec![], ..mesh }]), [0.0; 6]);
    }

    #[test]
    fn a_uv_mapping_scales_then_turns_then_moves() {
        let said = desc::UvMapping { scale: [2.0, 3.0], rotate: 90.0, translate: [10.0, 20.0] };
        let at = ShadingPoint { duvdx: [1.0, 0.0], ..ShadingPoint::of([1.0, 1.0], Vec3::ZERO) };
        let got =
            Mapping::of_uv(&said).over(&at, &[], |spot| [spot.st[0], spot.st[1], spot.dx[0], spot.dx[1]]);
        for (got, want) in got.into_iter().zip([7.0, 22.0, 0.0, 2.0]) {
            assert!((got - want).abs() < 1e-5, "{got} {want}");
        }
    }
}
