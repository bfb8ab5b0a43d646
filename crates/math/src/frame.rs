//! Orthonormal frames.

use crate::{Vec3, simd::Float};

/// A right-handed orthonormal frame: `s` x `t` = `n`. Of plain vectors, or of many side by side ([`crate::simd`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<F = f32> {
    /// First tangent: local x.
    pub s: Vec3<F>,
    /// Second tangent: local y.
    pub t: Vec3<F>,
    /// Normal: local z.
    pub n: Vec3<F>,
}

impl<F: Float> Frame<F> {
    /// A frame about a unit normal, without branches (Duff et al. 2017, "Building an Orthonormal Basis,
    /// Revisited").
    #[inline(always)]
    pub fn from_normal(n: Vec3<F>) -> Self {
        let sign = F::ONE.copysign(n.z);
        let a = F::splat(-1.0) / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: Vec3::new(F::ONE + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// Components of a world vector along s, t, n.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3<F>) -> Vec3<F> {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// The world vector with the given components.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3<F>) -> Vec3<F> {
        self.s * v.x + self.t * v.y + self.n * v.z
    }

    /// What `f` gives for each lane.
    #[inline(always)]
    pub fn from_fn(mut f: impl FnMut(usize) -> Frame) -> Self {
        let mut lanes = [F::ZERO.to_array(); 9];
        for i in 0..F::WIDTH {
            let Frame { s, t, n } = f(i);
            for (lane, v) in lanes.iter_mut().zip([s.x, s.y, s.z, t.x, t.y, t.z, n.x, n.y, n.z]) {
                lane.as_mut()[i] = v;
            }
        }
        let [s, t, n] = [0, 3, 6].map(|k: usize| [lanes[k], lanes[k + 1], lanes[k + 2]]);
        Self { s: side_by_side(s), t: side_by_side(t), n: side_by_side(n) }
    }
}

/// A vector in each lane.
#[inline(always)]
fn side_by_side<F: Float>([x, y, z]: [F::Array; 3]) -> Vec3<F> {
    Vec3::new(F::from_array(x), F::from_array(y), F::from_array(z))
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
