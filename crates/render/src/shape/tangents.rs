//! How texture coordinates lie on a surface about a point.

use straal_math::{Frame, Transform, Vec3};

/// How a point of a surface and its shading normal move with the texture coordinates. Few ask for it (textures, anisotropic
/// materials, the footprints of rays that go on), so it is apart from the point itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangents {
    /// How the point moves with u. Never zero.
    pub dpdu: Vec3,
    /// How the point moves with v.
    pub dpdv: Vec3,
    /// How the unit shading normal turns with u.
    pub dndu: Vec3,
    /// How the unit shading normal turns with v.
    pub dndv: Vec3,
}

impl Tangents {
    /// Those of a flat surface.
    #[inline]
    pub fn flat(dpdu: Vec3, dpdv: Vec3) -> Self {
        Self { dpdu, dpdv, dndu: Vec3::ZERO, dndv: Vec3::ZERO }
    }

    /// Two unit vectors about a normal, for a surface without texture coordinates.
    pub fn about(n: Vec3) -> Self {
        let frame = Frame::from_normal(n);
        Self::flat(frame.s, frame.t)
    }

    /// Those of an instance's object, seen from the world; `n` is the object's unit shading normal.
    pub fn to_world(&self, m: &Transform, n: Vec3) -> Self {
        let long = m.normal(n);
        let turned = |dn: Vec3| unit_change(long, m.normal(dn));
        Self {
            dpdu: m.vector(self.dpdu),
            dpdv: m.vector(self.dpdv),
            dndu: turned(self.dndu),
            dndv: turned(self.dndv),
        }
    }

    /// With the normal on the other side.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self { dndu: -self.dndu, dndv: -self.dndv, ..self }
    }

    /// The texture coordinates by which a point moves that moves by `dp` on the surface: the least squares of
    /// dp = u dpdu + v dpdv. 0 where the tangents are parallel.
    pub fn coordinates(&self, dp: Vec3) -> [f32; 2] {
        let (uu, uv, vv) = (self.dpdu.dot(self.dpdu), self.dpdu.dot(self.dpdv), self.dpdv.dot(self.dpdv));
        let (u, v) = (self.dpdu.dot(dp), self.dpdv.dot(dp));
        let det = uu * vv - uv * uv;
        let duv = [(vv * u - uv * v) / det, (uu * v - uv * u) / det];
        if duv.iter().all(|x| x.is_finite()) { duv } else { [0.0; 2] }
    }

    /// How the shading normal turns where the texture coordinates move by `duv`.
    pub fn turn(&self, duv: [f32; 2]) -> Vec3 {
        self.dndu * duv[0] + self.dndv * duv[1]
    }
}

/// How the unit vector along `v` changes when `v` changes by `dv`.
pub(super) fn unit_change(v: Vec3, dv: Vec3) -> Vec3 {
    let change = (dv - v * (v.dot(dv) / v.length_squared())) / v.length();
    if change.is_finite() { change } else { Vec3::ZERO }
}
