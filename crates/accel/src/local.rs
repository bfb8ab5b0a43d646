//! A ray in the space of one group, with what every test there needs.

use straal_math::{Ray, Vec3};

/// A valid ray in a group's space. Computed once a level; scalar code and vector kernels read the same numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalRay {
    /// The ray with its interval cut to finite numbers, so that a hit never lies at infinity.
    pub ray: Ray,
    /// 1 / d, kept finite so that 0 times it is never NaN.
    pub inv: Vec3,
    /// 1 where `inv` is negative, else 0: which of a box' two planes on each axis comes first.
    pub neg: [u8; 3],
    /// The axes x, y, z of the sheared space of `triangle.rs`.
    pub axes: [u8; 3],
    /// The origin along `axes`.
    pub origin: [f32; 3],
    /// Shear and scale: d[x] / d[z], d[y] / d[z], 1 / d[z].
    pub shear: [f32; 3],
}

/// A direction's coordinate below this counts as this when box planes are crossed: the reciprocal stays finite.
const LEAST: f32 = 1e-37;

impl LocalRay {
    /// `None` when the ray misses everything because it isn't valid.
    #[inline]
    pub fn new(r: &Ray) -> Option<Self> {
        if !r.is_valid() {
            return None;
        }
        let t_min = if r.t_min < f32::MIN { f32::MIN } else { r.t_min };
        let t_max = if r.t_max > f32::MAX { f32::MAX } else { r.t_max };
        if t_min > t_max {
            return None;
        }
        let reciprocal = |d: f32| 1.0 / if d.abs() > LEAST { d } else { LEAST.copysign(d) };
        let inv = Vec3::new(reciprocal(r.d.x), reciprocal(r.d.y), reciprocal(r.d.z));
        // The dominant axis becomes z; a negative one swaps the others, so that the winding stays. Without branches,
        // which would be mispredicted for every other ray.
        let (o, d) = (r.o.to_array(), r.d.to_array());
        let (ax, ay, az) = (d[0].abs(), d[1].abs(), d[2].abs());
        let over_x = usize::from(ay > ax) | (usize::from(az > ax && az > ay) << 1);
        let z = if over_x > 2 { 2 } else { over_x };
        let back = usize::from(d[z] < 0.0);
        let (x, y) = (NEXT[z + back], NEXT[z + 1 - back]);
        let scale = 1.0 / d[z];
        Some(Self {
            ray: Ray { t_min, t_max, ..*r },
            inv,
            neg: [u8::from(inv.x < 0.0), u8::from(inv.y < 0.0), u8::from(inv.z < 0.0)],
            axes: [x as u8, y as u8, z as u8],
            origin: [o[x], o[y], o[z]],
            shear: [d[x] * scale, d[y] * scale, scale],
        })
    }
}

/// The axis after, in a circle: after axis z come x = `NEXT[z]` and y = `NEXT[z + 1]`.
const NEXT: [usize; 4] = [1, 2, 0, 1];
