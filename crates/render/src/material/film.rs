//! Thin films: what a layer of some hundred nanometres reflects together with what lies below it, waves added up (Airy's sum; Belcour and
//! Barla 2017, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence", eq. 3).

use std::f32::consts::TAU;

use straal_color::Light;
use straal_math::ops;
use straal_math::simd::{Float, Mask};

/// A film between two media.
#[derive(Clone, Copy, Debug)]
pub(super) struct Film<F> {
    /// How much of it is there.
    pub presence: F,
    /// In nm.
    pub thickness: F,
    pub ior: F,
    /// Index of refraction of the medium before it.
    pub above: F,
}

/// How much of a film of some nm is there: less than 30 nm fade away.
#[inline(always)]
pub(super) fn fades<F: Float>(thickness: F) -> F {
    let t = (thickness * (1.0 / 30.0)).min(F::ONE);
    t * t * (F::splat(3.0) - t * 2.0)
}

/// What the faces of a film reflect of a ray: amplitudes, across and along the plane of incidence.
pub(super) struct Faces<F> {
    /// Of the upper face; from below they are the opposite.
    pub upper: [F; 2],
    /// Cosine of the ray within the film, and the square of its sine, which is 1 or more where no ray gets in.
    pub within: [F; 2],
}

/// A complex number.
#[derive(Clone, Copy)]
pub(super) struct Complex<F>(pub F, pub F);

impl<F: Float> Complex<F> {
    #[inline(always)]
    pub fn times(self, o: Self) -> Self {
        Self(self.0 * o.0 - self.1 * o.1, self.0 * o.1 + self.1 * o.0)
    }

    #[inline(always)]
    pub fn scaled(self, s: F) -> Self {
        Self(self.0 * s, self.1 * s)
    }

    #[inline(always)]
    pub fn square(self) -> F {
        self.0 * self.0 + self.1 * self.1
    }

    #[inline(always)]
    fn over(self, o: Self) -> Self {
        let by = F::ONE / o.square().max(F::splat(1e-18));
        Self((self.0 * o.0 + self.1 * o.1) * by, (self.1 * o.0 - self.0 * o.1) * by)
    }

    /// (a - b) / (a + b).
    #[inline(always)]
    fn against(self, o: Self) -> Self {
        Self(self.0 - o.0, self.1 - o.1).over(Self(self.0 + o.0, self.1 + o.1))
    }

    /// The root whose real part isn't negative.
    #[inline(always)]
    fn root(self) -> Self {
        let length = self.square().sqrt();
        let real = ((length + self.0) * 0.5).max(F::ZERO).sqrt();
        let imaginary = ((length - self.0) * 0.5).max(F::ZERO).sqrt();
        Self(real, imaginary.copysign(self.1))
    }
}

impl<F: Float> Film<F> {
    /// Share of light that comes back from the film on a medium of index `n` + i `k`, where `cos` is that of the direction before the
    /// film, for waves of `nm`.
    #[inline(always)]
    pub fn reflects(&self, cos: F, n: Light<F>, k: Light<F>, nm: Light<F>) -> Light<F> {
        F::vectorize(
            #[inline(always)]
            || self.reflects_here(cos, [n, k, nm]),
        )
    }

    #[inline(always)]
    fn reflects_here(&self, cos: F, [n, k, nm]: [Light<F>; 3]) -> Light<F> {
        let Faces { upper: [s, p], within: [cos_film, sin2_film] } = self.faces(cos);
        let path = self.thickness * self.ior * cos_film * (2.0 * TAU);
        let mut out = Light::splat(F::ONE);
        for lane in 0..4 {
            let (sin, cos) = ops::sin_cos(path / nm.0[lane]);
            let [below_s, below_p] = self.below([cos_film, sin2_film], Complex(n.0[lane], k.0[lane]));
            let wave = Complex(cos, sin);
            out.0[lane] = (sum(s, below_s.times(wave)) + sum(p, below_p.times(wave))) * 0.5;
        }
        Light::select(sin2_film.lt(F::ONE), out, Light::splat(F::ONE))
    }

    /// What its upper face reflects, and the ray within.
    #[inline(always)]
    pub fn faces(&self, cos: F) -> Faces<F> {
        let sin2 = ((F::ONE - cos) * (F::ONE + cos)).max(F::ZERO);
        let ratio = self.above / self.ior;
        let sin2_film = sin2 * ratio * ratio;
        let cos_film = (F::ONE - sin2_film).max(F::ZERO).sqrt();
        let (a, b) = (self.above * cos, self.ior * cos_film);
        let s = (a - b) / (a + b).max(F::splat(1e-9));
        let (a, b) = (self.ior * cos, self.above * cos_film);
        let p = (a - b) / (a + b).max(F::splat(1e-9));
        Faces { upper: [s, p], within: [cos_film, sin2_film] }
    }

    /// Amplitudes at the lower face, across and along the plane of incidence, against an index, for a ray of cosine and squared sine within.
    #[inline(always)]
    pub fn below(&self, [cos, sin2]: [F; 2], eta: Complex<F>) -> [Complex<F>; 2] {
        // Snell's law with complex numbers; of the two roots that by which the wave dies out below.
        let ratio = Complex(self.ior, F::ZERO).over(eta);
        let square = ratio.times(ratio).scaled(sin2);
        let root = Complex(F::ONE - square.0, F::ZERO - square.1).root();
        let grows = eta.times(root).1.lt(F::ZERO);
        let sign = F::select(grows, -F::ONE, F::ONE);
        let root = root.scaled(sign);
        let s = Complex(self.ior * cos, F::ZERO).against(eta.times(root));
        let p = eta.scaled(cos).against(root.scaled(self.ior));
        [s, p]
    }
}

/// The square of r + t z t' / (1 + r z), all bounces between the faces added up; t t' = 1 - r².
#[inline(always)]
fn sum<F: Float>(r: F, z: Complex<F>) -> F {
    let numerator = Complex(r + z.0, z.1);
    let denominator = Complex(F::ONE + r * z.0, r * z.1);
    numerator.square() / denominator.square().max(F::splat(1e-18))
}

/// Index n and k of a metal of reflectance `f0` straight back, with a tint at its edge (Gulbrandsen 2014, "Artist Friendly Metallic
/// Fresnel").
#[inline(always)]
pub(super) fn metal<F: Float>(f0: Light<F>, edge: Light<F>) -> [Light<F>; 2] {
    let r = f0.map(
        #[inline(always)]
        |r| r.max(F::ZERO).min(F::splat(0.99)),
    );
    let n = r.zip(
        edge,
        #[inline(always)]
        |r, g| {
            let root = r.sqrt();
            let most = (F::ONE + root) / (F::ONE - root);
            let least = (F::ONE - r) / (F::ONE + r);
            most * (F::ONE - g) + least * g
        },
    );
    let k = r.zip(
        n,
        #[inline(always)]
        |r, n| {
            let (above, below) = (n + F::ONE, n - F::ONE);
            ((above * above * r - below * below) / (F::ONE - r)).max(F::ZERO).sqrt()
        },
    );
    [n, k]
}

/// Whether any film is there at all.
#[inline(always)]
pub(super) fn is_any<F: Float>(presence: F) -> bool {
    presence.gt(F::ZERO).any()
}
