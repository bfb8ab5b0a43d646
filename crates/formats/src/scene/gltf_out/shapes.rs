//! Shapes that are formulas, as small meshes with normals and texture coordinates.

use std::sync::Arc;

use straal_math::{DVec3, ops};
use straal_scene::Mesh;
use straal_scene::desc::{
    Annulus, Bilinear, Capsule, Cone, Cuboid, CurveForm, Cylinder, Disc, Hyperboloid, Node, Paraboloid,
    Plane, Sphere, Torus, WHOLE_TURN,
};

use super::Out;

/// So many flat pieces a whole turn has.
const AROUND: u32 = 64;

impl Out<'_> {
    /// A shape's mesh, the same for each copy of it; none of those that aren't written, which is told.
    pub fn shape(&mut self, node: &Node) -> Option<Arc<Mesh>> {
        let key = std::ptr::from_ref(node) as usize;
        if let Some(known) = self.made.get(&key) {
            return known.clone();
        }
        let mut builder = Builder::default();
        let is_made = match node {
            Node::Sphere(s) => builder.sphere(s),
            Node::Disc(s) => builder.disc(s),
            Node::Annulus(s) => builder.annulus(s),
            Node::Rectangle(s) => builder.patch(s.corner, s.edges),
            Node::Box(s) => builder.cuboid(s),
            Node::Cylinder(s) => builder.cylinder(s),
            Node::Cone(s) => builder.cone(s),
            Node::Torus(s) => builder.torus(s),
            Node::Bilinear(s) => builder.bilinear(s),
            Node::Triangle(s) => builder.triangle(s.vertices),
            Node::Plane(s) => {
                self.tell("planes are written as squares of 2 km about their points");
                builder.plane(s)
            }
            Node::Paraboloid(s) => builder.paraboloid(s),
            Node::Hyperboloid(s) => builder.hyperboloid(s),
            Node::Capsule(s) => builder.capsule(s),
            Node::Bezier(s) => builder.bezier(s),
            Node::HeightField(s) => builder.height_field(s, self.assets),
            Node::Curves(s) => {
                if !matches!(s.form, CurveForm::Round) {
                    self.tell("flat curves and ribbons are written as round ones");
                }
                builder.curves(s)
            }
            _ => None,
        };
        let made = match is_made {
            Some(()) => {
                if !matches!(
                    node,
                    Node::Triangle(_)
                        | Node::Rectangle(_)
                        | Node::Box(_)
                        | Node::Plane(_)
                        | Node::HeightField(_)
                ) {
                    self.tell("round shapes are written as meshes of flat pieces");
                }
                Some(Arc::new(builder.0))
            }
            None => {
                let what = node.kind();
                self.tell(format!("shapes of the kind `{what}` are left out: they have no mesh"));
                None
            }
        };
        self.made.insert(key, made.clone());
        made
    }
}

/// A mesh in the making.
#[derive(Default)]
pub(super) struct Builder(pub Mesh);

impl Builder {
    /// A grid of squares over u and v, whose front is where du x dv points.
    pub fn grid(
        &mut self,
        [across, up]: [u32; 2],
        at: impl Fn(f64, f64) -> Option<(DVec3, DVec3)>,
    ) -> Option<()> {
        let first = self.0.positions.len() as u32;
        for j in 0..=up {
            for i in 0..=across {
                let (u, v) = (f64::from(i) / f64::from(across), f64::from(j) / f64::from(up));
                let (p, n) = at(u, v)?;
                self.0.positions.push(p.to_array().map(|v| v as f32));
                self.0.normals.push(n.try_normalize()?.to_array().map(|v| v as f32));
                self.0.uvs.push([u as f32, v as f32]);
            }
        }
        for j in 0..up {
            for i in 0..across {
                let a = first + j * (across + 1) + i;
                let (b, c, d) = (a + 1, a + across + 2, a + across + 1);
                // At poles and tips two corners are one.
                let place = |i: u32| self.0.positions[i as usize];
                for t in [[a, b, c], [a, c, d]] {
                    let [p, q, r] = t.map(place);
                    if p != q && q != r && r != p {
                        self.0.triangles.push(t);
                    }
                }
            }
        }
        Some(())
    }

    /// A ball: u about y from +z towards +x, v from the lower pole to the upper.
    fn sphere(&mut self, s: &Sphere) -> Option<()> {
        let height = |y: f64| {
            let y = y / s.radius;
            let sin = (1.0 - y * y).abs().sqrt();
            ops::atan2_d(y, sin).to_degrees()
        };
        let [low, high] = s.heights.map_or([-90.0, 90.0], |heights| heights.map(height));
        self.grid([pieces(s.phi), AROUND / 2], |u, v| {
            let (sin, cos) = ops::sin_cos_degrees(between(s.phi, u));
            let (y, level) = ops::sin_cos_degrees(low + (high - low) * v);
            let n = DVec3::new(level * sin, y, level * cos);
            Some((s.center + n * s.radius, n))
        })
    }

    fn disc(&mut self, s: &Disc) -> Option<()> {
        self.ring(s.center, s.normal, [0.0, s.radius])
    }

    fn annulus(&mut self, s: &Annulus) -> Option<()> {
        let [a, b, n] = frame(s.normal)?;
        let (inner, outer) = (s.inner_radius, s.radius);
        self.grid([pieces(s.phi), 1], |u, v| {
            let (sin, cos) = ops::sin_cos_degrees(between(s.phi, u));
            Some((s.center + (a * cos + b * sin) * (outer + (inner - outer) * v), n))
        })?;
        // How far out, which is the other way.
        self.0.uvs.iter_mut().for_each(|uv| uv[1] = 1.0 - uv[1]);
        Some(())
    }

    /// A flat disc, from its rim inwards.
    fn ring(&mut self, middle: DVec3, normal: DVec3, [inner, outer]: [f64; 2]) -> Option<()> {
        let [a, b, n] = frame(normal)?;
        self.grid([AROUND, 1], |u, v| {
            let (sin, cos) = ops::sin_cos_degrees(360.0 * u);
            Some((middle + (a * cos + b * sin) * (outer + (inner - outer) * v), n))
        })
    }

    /// A square of 2 km, whose texture coordinates are metres.
    fn plane(&mut self, s: &Plane) -> Option<()> {
        const HALF: f64 = 1000.0;
        let [a, b, _] = frame(s.normal)?;
        self.patch(s.point - (a + b) * HALF, [a * (2.0 * HALF), b * (2.0 * HALF)])?;
        let metres = |v: f32| (f64::from(2.0 * v - 1.0) * HALF) as f32;
        self.0.uvs.iter_mut().for_each(|uv| *uv = uv.map(metres));
        Some(())
    }

    /// A flat parallelogram.
    fn patch(&mut self, corner: DVec3, [a, b]: [DVec3; 2]) -> Option<()> {
        self.grid([1, 1], |u, v| Some((corner + a * u + b * v, a.cross(b))))
    }

    fn cuboid(&mut self, s: &Cuboid) -> Option<()> {
        let (lo, hi) = (s.min, s.max);
        let d = hi - lo;
        let [x, y, z] = [DVec3::new(d.x, 0.0, 0.0), DVec3::new(0.0, d.y, 0.0), DVec3::new(0.0, 0.0, d.z)];
        // Each face's second edge after its first is counter-clockwise from outside.
        for (corner, edges) in
            [(lo, [z, y]), (lo, [x, z]), (lo, [y, x]), (hi, [-y, -z]), (hi, [-z, -x]), (hi, [-x, -y])]
        {
            self.patch(corner, edges)?;
        }
        Some(())
    }

    fn cylinder(&mut self, s: &Cylinder) -> Option<()> {
        self.tube([s.from, s.to], [s.radius; 2], (s.phi, s.caps))
    }

    fn cone(&mut self, s: &Cone) -> Option<()> {
        self.tube([s.from, s.to], [s.radius, s.top_radius], (s.phi, s.caps))
    }

    /// A tube between two ends of some radius each, or a part of one.
    fn tube(
        &mut self,
        [from, to]: [DVec3; 2],
        [r0, r1]: [f64; 2],
        (phi, has_caps): ([f64; 2], bool),
    ) -> Option<()> {
        let (axis, length) = (to - from, (to - from).length());
        let profile = |v: f64| ([r0 + (r1 - r0) * v, length * v], [length, r0 - r1]);
        self.turned((from, axis), (phi, 1), profile)?;
        if has_caps {
            let w = axis.try_normalize()?;
            for (middle, normal, radius) in [(from, -w, r0), (to, w, r1)] {
                if radius > 0.0 {
                    self.ring(middle, normal, [0.0, radius])?;
                }
            }
        }
        Some(())
    }

    /// A curve turned about an axis: at v from 0 to 1 the distance from the axis and the way along it, and the same of a vector across the curve, outwards.
    fn turned(
        &mut self,
        (from, axis): (DVec3, DVec3),
        (phi, up): ([f64; 2], u32),
        curve: impl Fn(f64) -> ([f64; 2], [f64; 2]),
    ) -> Option<()> {
        let [a, b, w] = frame(axis)?;
        self.grid([pieces(phi), up], |u, v| {
            let (sin, cos) = ops::sin_cos_degrees(between(phi, u));
            let out = a * cos + b * sin;
            let ([away, along], [n_away, n_along]) = curve(v);
            Some((from + out * away + w * along, out * n_away + w * n_along))
        })
    }

    fn paraboloid(&mut self, s: &Paraboloid) -> Option<()> {
        let (axis, height) = (s.to - s.from, (s.to - s.from).length());
        self.turned((s.from, axis), (s.phi, AROUND / 4), |v| {
            // Even steps of the radius.
            let (begin, end) = (s.begin.sqrt(), 1.0);
            let r = begin + (end - begin) * v;
            ([s.radius * r, height * r * r], [2.0 * height * r, -s.radius])
        })
    }

    /// Two balls, and what touches both: the parts of both that the normals of that leave.
    fn capsule(&mut self, s: &Capsule) -> Option<()> {
        let (axis, length) = (s.to - s.from, (s.to - s.from).length());
        let [r0, r1] = [s.radius, s.end_radius.unwrap_or(s.radius)];
        let sin = (r0 - r1) / length;
        // One ball may hold the other.
        let tilt = if sin < -1.0 {
            -90.0
        } else if sin > 1.0 {
            90.0
        } else {
            ops::atan2_d(sin, (1.0 - sin * sin).sqrt()).to_degrees()
        };
        let up = AROUND / 2 + 1;
        self.turned((s.from, axis), (WHOLE_TURN, up), |v| {
            let row = (v * f64::from(up) + 0.5).floor();
            let half = f64::from(AROUND / 4);
            let is_first = row <= half;
            let part = if is_first { row / half } else { (row - half - 1.0) / half };
            let degrees = if is_first { -90.0 + (tilt + 90.0) * part } else { tilt + (90.0 - tilt) * part };
            let (sin, cos) = ops::sin_cos_degrees(degrees);
            let (radius, middle) = if is_first { (r0, 0.0) } else { (r1, length) };
            ([radius * cos, middle + radius * sin], [cos, sin])
        })
    }

    /// A line turned about y, from where it is.
    fn hyperboloid(&mut self, s: &Hyperboloid) -> Option<()> {
        let [p, q] = s.line;
        let way = q - p;
        self.grid([pieces(s.phi), AROUND / 4], |u, v| {
            let (sin, cos) = ops::sin_cos_degrees(between(s.phi, u));
            let turn = |v: DVec3| DVec3::new(v.x * cos + v.z * sin, v.y, v.z * cos - v.x * sin);
            let at = turn(p + way * v);
            let around = DVec3::new(at.z, 0.0, -at.x);
            let n = around.cross(turn(way));
            // Away from the axis; of a flat ring, upwards.
            let out = if way.y == 0.0 { n.y } else { n.x * at.x + n.z * at.z };
            Some((at, if out < 0.0 { -n } else { n }))
        })?;
        // The front of squares is where du x dv points.
        let is_turned = self.0.triangles.first().is_some_and(|t| {
            let [a, b, c] = t.map(|i| double(self.0.positions[i as usize]));
            let n = double(self.0.normals[t[0] as usize]);
            (b - a).cross(c - a).dot(n) < 0.0
        });
        if is_turned {
            self.0.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        Some(())
    }

    fn torus(&mut self, s: &Torus) -> Option<()> {
        let [a, b, w] = frame(s.axis)?;
        self.grid([pieces(s.phi), AROUND / 2], |u, v| {
            let (sin, cos) = ops::sin_cos_degrees(between(s.phi, u));
            let (up, out) = ops::sin_cos_degrees(between(s.theta, v));
            let away = a * cos + b * sin;
            let n = away * out + w * up;
            Some((s.center + away * s.radius + n * s.tube_radius, n))
        })
    }

    fn bilinear(&mut self, s: &Bilinear) -> Option<()> {
        let [a, b, c, d] = s.corners;
        let first = self.0.uvs.len();
        self.grid([AROUND / 4; 2], |u, v| {
            let p = (a * (1.0 - u) + b * u) * (1.0 - v) + (c * (1.0 - u) + d * u) * v;
            let (du, dv) = ((b - a) * (1.0 - v) + (d - c) * v, (c - a) * (1.0 - u) + (d - b) * u);
            Some((p, du.cross(dv)))
        })?;
        for uv in &mut self.0.uvs[first..] {
            let [u, v] = uv.map(f64::from);
            *uv = std::array::from_fn(|i| {
                let [a, b, c, d] = s.uvs.map(|corner| corner[i]);
                ((a * (1.0 - u) + b * u) * (1.0 - v) + (c * (1.0 - u) + d * u) * v) as f32
            });
        }
        Some(())
    }

    fn triangle(&mut self, corners: [DVec3; 3]) -> Option<()> {
        self.0.positions.extend(corners.map(|p| p.to_array().map(|v| v as f32)));
        self.0.triangles.push([0, 1, 2]);
        Some(())
    }
}

/// Flat pieces of a part of a turn.
fn pieces([from, to]: [f64; 2]) -> u32 {
    let count = ((to - from).abs() / 360.0 * f64::from(AROUND)).ceil();
    if count > 1.0 { count as u32 } else { 1 }
}

fn between([from, to]: [f64; 2], share: f64) -> f64 {
    from + (to - from) * share
}

pub(super) fn double(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

/// Two unit vectors across an axis and the axis itself, right-handed, as straal's own shapes have them; none where there is no axis.
pub(super) fn frame(axis: DVec3) -> Option<[DVec3; 3]> {
    let w = axis.try_normalize()?;
    let aside = if w.x.abs() < 0.9 { DVec3::X } else { DVec3::Y };
    let a = (aside - w * w.dot(aside)).try_normalize()?;
    Some([a, w.cross(a), w])
}
