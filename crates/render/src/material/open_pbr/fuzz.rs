//! Fuzz: a layer of fibres on the surface (Zeltner, Burley and Chiang 2022, "Practical Multiple-Scattering Sheen Using Linearly
//! Transformed Cosines"): a cosine lobe, transformed by a matrix that depends on the roughness and on where it is seen from, and the share
//! that it reflects. The figures are the paper's fit of a volume of fibres that absorb nothing, `crates/render/data/sheen-ltc.txt`.

use std::f32::consts::FRAC_1_PI;
use std::sync::LazyLock;

use straal_math::simd::{Float, Uint};
use straal_math::{Vec3, warp};

/// Nodes of the roughness, and of the cosine.
const SIDE: usize = 32;

static TABLE: LazyLock<Vec<f32>> = LazyLock::new(|| {
    let text = include_str!("../../../data/sheen-ltc.txt");
    let words = text.lines().filter(|l| !l.starts_with('#')).flat_map(str::split_whitespace);
    words.map(|word| word.parse().unwrap_or(0.0)).collect()
});

/// The lobe for one direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fibres<F> {
    /// The two numbers of the inverse transform.
    a: F,
    b: F,
    /// Share of light that is reflected.
    pub reflects: F,
    /// Towards the viewer, along the surface.
    along: [F; 2],
}

/// A place between two nodes, from 0 to 1 over all of them.
#[inline(always)]
fn between<F: Float>(v: F) -> (F::Uint, F) {
    let at = v.max(F::ZERO).min(F::ONE) * (SIDE - 1) as f32;
    let lower = at.floor().min(F::splat((SIDE - 2) as f32));
    (lower.to_uint(), at - lower)
}

/// One of the three figures.
#[inline(always)]
fn figure<F: Float>(roughness: F, cos: F, which: u32) -> F {
    let ((row, down), (column, across)) = (between(roughness), between(cos));
    let table = &TABLE;
    let first = row.wrapping_mul(F::Uint::splat(SIDE as u32)).wrapping_add(column);
    let first = first.wrapping_mul(F::Uint::splat(3)).wrapping_add(F::Uint::splat(which));
    let next = first.wrapping_add(F::Uint::splat(3 * SIDE as u32));
    let three = F::Uint::splat(3);
    let upper =
        F::gather(table, first) * (F::ONE - across) + F::gather(table, first.wrapping_add(three)) * across;
    let lower =
        F::gather(table, next) * (F::ONE - across) + F::gather(table, next.wrapping_add(three)) * across;
    upper * (F::ONE - down) + lower * down
}

/// The share of light at a cosine that fibres reflect.
#[inline(always)]
pub(super) fn reflects<F: Float>(roughness: F, cos: F) -> F {
    figure(roughness, cos, 2)
}

impl<F: Float> Fibres<F> {
    /// None at all.
    pub const NONE: Self = Self { a: F::ONE, b: F::ZERO, reflects: F::ZERO, along: [F::ONE, F::ZERO] };

    #[inline(always)]
    pub fn new(roughness: F, wo: Vec3<F>) -> Self {
        let length = (wo.x * wo.x + wo.y * wo.y).sqrt();
        let is_slanted = length.gt(F::ZERO);
        let by = F::ONE / F::select(is_slanted, length, F::ONE);
        Self {
            a: figure(roughness, wo.z, 0),
            b: figure(roughness, wo.z, 1),
            reflects: figure(roughness, wo.z, 2),
            along: [F::select(is_slanted, wo.x * by, F::ONE), wo.y * by],
        }
    }

    /// The density of a direction above the surface; times [`Self::reflects`] f |cos|.
    #[inline(always)]
    pub fn pdf(&self, wi: Vec3<F>) -> F {
        let [c, s] = self.along;
        let (x, y) = (c * wi.x + s * wi.y, c * wi.y - s * wi.x);
        let v = Vec3::new(self.a * x + self.b * wi.z, self.a * y, wi.z);
        let square = v.length_squared();
        let pdf = self.a * self.a * wi.z * FRAC_1_PI / (square * square);
        F::select(square.gt(F::ZERO), pdf, F::ZERO)
    }

    #[inline(always)]
    pub fn draw(&self, u: [F; 2]) -> Vec3<F> {
        let d = warp::cosine_hemisphere(u);
        let by = F::ONE / self.a.max(F::splat(1e-6));
        let (x, y) = ((d.x - d.z * self.b) * by, d.y * by);
        let [c, s] = self.along;
        Vec3::new(c * x - s * y, s * x + c * y, d.z).normalize()
    }
}
