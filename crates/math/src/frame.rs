//! Orthonormal frames.

use crate::Vec3;

/// A right-handed orthonormal frame: `s` x `t` = `n`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First tangent: local x.
    pub s: Vec3,
    /// Second tangent: local y.
    pub t: Vec3,
    /// Normal: local z.
    pub n: Vec3,
}

impl Frame {
    /// A frame about a unit normal, without branches (Duff et al. 2017, "Building an Orthonormal Basis,
    /// Revisited").
    #[inline]
    pub fn from_normal(n: Vec3) -> Self {
        let sign = 1.0_f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// Components of a world vector along s, t, n.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// The world vector with the given components.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_everywhere() {
        for i in -10..=10 {
            for j in -10..=10 {
                for z in [-1.0_f32, -1e-7, 0.0, 1e-7, 1.0] {
                    let Some(n) = Vec3::new(i as f32, j as f32, z * 7.0).try_normalize() else { continue };
                    let f = Frame::from_normal(n);
                    for (a, b, want) in
                        [(f.s, f.t, 0.0), (f.s, f.n, 0.0), (f.t, f.n, 0.0), (f.s, f.s, 1.0), (f.t, f.t, 1.0)]
                    {
                        assert!((a.dot(b) - want).abs() < 2e-6, "{n:?}");
                    }
                    assert!((f.s.cross(f.t) - f.n).length() < 2e-6);
                }
            }
        }
    }
}
