//! Shapes that are formulas, as small meshes with normals and texture coordinates.

use std::sync::Arc;

use straal_math::{DVec3, ops};
use straal_scene::Mesh;
use straal_scene::desc::{Annulus, Bilinear, Cone, Cuboid, Cylinder, Disc, Node, Sphere, Torus, WHOLE_TURN};

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
            _ => None,
        };
        let made = match is_made {
            Some(()) => {
                if !matches!(node, Node::Triangle(_) | Node::Rectangle(_) | Node::Box(_)) {
                    self.tell("round shapes are written as meshes of flat pieces");
                }
                Some(Arc::new(builder.0))
            }
            None => {
                let what = node.kind();
                self.tell(format!(
                    "shapes of the kind `{what}` that aren't whole or have no mesh are left out"
                ));
                None
            }
        };
        self.made.insert(key, made.clone());
        made
    }
}

/// A mesh in the making.
#[derive(Default)]
struct Builder(Mesh);

impl Builder {
    /// A grid of squares over u and v, whose front is where du x dv points.
    fn grid(
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
        let turn = s.phi[1] - s.phi[0];
        let height = |y: f64| {
            let y = y / s.radius;
            let sin = (1.0 - y * y).abs().sqrt();
            ops::atan2_d(y, sin).to_degrees()
        };
        let [low, high] = s.heights.map_or([-90.0, 90.0], |heights| heights.map(height));
        self.grid([AROUND, AROUND / 2], |u, v| {
            let (sin, cos) = ops::sin_cos_degrees(s.phi[0] + turn * u);
            let (y, level) = ops::sin_cos_degrees(low + (high - low) * v);
            let n = DVec3::new(level * sin, y, level * cos);
            Some((s.center + n * s.radius, n))
        })
    }

    fn disc(&mut self, s: &Disc) -> Option<()> {
        self.ring(s.center, s.normal, [0.0, s.radius])
    }

    fn annulus(&mut self, s: &Annulus) -> Option<()> {
        if s.phi != WHOLE_TURN {
            return None;
        }
        self.ring(s.center, s.normal, [s.inner_radius, s.radius])
    }

    /// A flat ring, from the outer rim inwards.
    fn ring(&mut self, middle: DVec3, normal: DVec3, [inner, outer]: [f64; 2]) -> Option<()> {
        let [a, b, n] = frame(normal)?;
        self.grid([AROUND, 1], |u, v| {
            let (sin, cos) = ops::sin_cos_degrees(360.0 * u);
            Some((middle + (a * cos + b * sin) * (outer + (inner - outer) * v), n))
        })
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
        let whole = s.phi == WHOLE_TURN;
        whole.then(|| self.tube([s.from, s.to], [s.radius; 2], s.caps)).flatten()
    }

    fn cone(&mut self, s: &Cone) -> Option<()> {
        let whole = s.phi == WHOLE_TURN;
        whole.then(|| self.tube([s.from, s.to], [s.radius, s.top_radius], s.caps)).flatten()
    }

    /// A tube between two ends of some radius each.
    fn tube(&mut self, [from, to]: [DVec3; 2], [r0, r1]: [f64; 2], has_caps: bool) -> Option<()> {
        let [a, b, w] = frame(to - from)?;
        let length = (to - from).length();
        self.grid([AROUND, 1], |u, v| {
            let (sin, cos) = ops::sin_cos_degrees(360.0 * u);
            let out = a * cos + b * sin;
            Some((from + w * (length * v) + out * (r0 + (r1 - r0) * v), out * length + w * (r0 - r1)))
        })?;
        if has_caps {
            for (middle, normal, radius) in [(from, -w, r0), (to, w, r1)] {
                if radius > 0.0 {
                    self.ring(middle, normal, [0.0, radius])?;
                }
            }
        }
        Some(())
    }

    fn torus(&mut self, s: &Torus) -> Option<()> {
        if [s.phi, s.theta] != [WHOLE_TURN; 2] {
            return None;
        }
        let [a, b, w] = frame(s.axis)?;
        self.grid([AROUND, AROUND / 2], |u, v| {
            let (sin, cos) = ops::sin_cos_degrees(360.0 * u);
            let (up, out) = ops::sin_cos_degrees(360.0 * v);
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

/// Two unit vectors across an axis and the axis itself, right-handed; none where there is no axis.
fn frame(axis: DVec3) -> Option<[DVec3; 3]> {
    let w = axis.try_normalize()?;
    let aside = if w.y.abs() < 0.9 { DVec3::Y } else { DVec3::X };
    let a = aside.cross(w).try_normalize()?;
    Some([a, w.cross(a), w])
}
