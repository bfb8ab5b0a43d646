//! BSDFs side by side: what is computed for 8 or 16 vertices at once ([`straal_math::simd`]).
//!
//! A kind whose arithmetic is written for any number of lanes is a [`Lobe`]: a struct of numbers side by side, of which one lane is
//! the BSDF itself. Any other kind is asked lane by lane.

use super::{Bsdf, BsdfSample, Scatter, Transport};
use straal_color::Light;
use straal_math::Vec3;
use straal_math::simd::{BLOCK, Float, Mask};

/// BSDFs of a kind, one for each lane.
pub(crate) trait These<K>: Copy {
    /// That of a lane.
    fn of(&self, lane: usize) -> &K;

    /// The one that all of the first so many lanes have, if that is known.
    fn common(&self, width: usize) -> Option<&K>;
}

/// The same for all lanes.
impl<K> These<K> for &K {
    #[inline(always)]
    fn of(&self, _: usize) -> &K {
        self
    }

    #[inline(always)]
    fn common(&self, _: usize) -> Option<&K> {
        Some(self)
    }
}

/// Out of a list of BSDFs those that each lane has, which all are of the kind `K`.
pub(crate) struct Among<'a, 'w, K> {
    bsdfs: &'a [Bsdf<'w>],
    which: &'a [u8],
    else_: &'a K,
}

impl<K> Clone for Among<'_, '_, K> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<K> Copy for Among<'_, '_, K> {}

impl<'a, 'w, K: OfKind<'w>> Among<'a, 'w, K> {
    /// With one that stands for those that aren't of the kind; `None` where that isn't either.
    #[inline(always)]
    pub fn new(bsdfs: &'a [Bsdf<'w>], which: &'a [u8], else_: &'a Bsdf<'w>) -> Option<Self> {
        Some(Self { bsdfs, which, else_: K::of(else_)? })
    }
}

impl<'w, K: OfKind<'w>> These<K> for Among<'_, 'w, K> {
    #[inline(always)]
    fn of(&self, lane: usize) -> &K {
        K::of(&self.bsdfs[usize::from(self.which[lane])]).unwrap_or(self.else_)
    }

    #[inline(always)]
    fn common(&self, width: usize) -> Option<&K> {
        let (first, rest) = self.which[..width].split_first()?;
        // Without an end before the last: many are compared at once.
        let differs = rest.iter().fold(0, |differs, which| differs | (which ^ first));
        (differs == 0).then(|| self.of(0))
    }
}

/// A kind of BSDF: what a [`Bsdf`] is one of.
pub(crate) trait OfKind<'w>: Scatter {
    /// Whether every BSDF is.
    const IS_ANY: bool = false;

    /// The BSDF, if it is of this kind.
    fn of<'a>(bsdf: &'a Bsdf<'w>) -> Option<&'a Self>;
}

/// Who works with BSDFs of any kind, compiled for each.
pub(crate) trait WithKind<'w> {
    /// Works with those of this one.
    fn with<K: OfKind<'w>>(self);
}

/// Any kind: blocks in which several kinds meet, or one that is asked lane by lane.
impl<'w> OfKind<'w> for Bsdf<'w> {
    const IS_ANY: bool = true;

    #[inline(always)]
    fn of(bsdf: &Self) -> Option<&Self> {
        Some(bsdf)
    }
}

/// A BSDF by [the contract](super), or many of its kind side by side.
pub(crate) trait Lobe<F: Float>: Copy {
    /// One of them: this very type with a single lane.
    type One;

    /// Brings their numbers side by side.
    fn gather(these: impl These<Self::One>) -> Self;

    /// See [`Bsdf::eval_pdf`]: nothing where there are delta lobes alone.
    #[inline(always)]
    fn eval_pdf(&self, _wo: Vec3<F>, _wi: Vec3<F>, _transport: Transport) -> (Light<F>, F) {
        (Light::splat(F::ZERO), F::ZERO)
    }

    /// See [`Bsdf::sample`]; and in which lanes there is a sample of value.
    fn sample(&self, wo: Vec3<F>, u_lobe: F, u: [F; 2], transport: Transport) -> (BsdfSample<F>, F::Mask);
}

/// In an `impl Scatter`: that the kind is a [`Lobe`], whose functions serve one and many.
macro_rules! is_lobe {
    ($Lobe:ident) => {
        const SIDE_BY_SIDE: bool = true;

        #[inline]
        fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: $crate::material::Transport) -> (Light, f32) {
            use $crate::material::many::Lobe;
            Lobe::eval_pdf(&$Lobe::<f32>::gather(self), wo, wi, transport)
        }

        #[inline]
        fn sample(
            &self,
            wo: Vec3,
            u_lobe: f32,
            u: [f32; 2],
            transport: $crate::material::Transport,
        ) -> Option<$crate::material::BsdfSample> {
            use $crate::material::many::Lobe;
            let lobe = $Lobe::<f32>::gather(self);
            let (sample, there) = Lobe::sample(&lobe, wo, u_lobe, u, transport);
            there.then_some(sample)
        }

        #[inline(always)]
        fn eval_pdf_many<F: Float>(
            these: impl $crate::material::many::These<Self>,
            [wo, wi]: [Vec3<F>; 2],
            transport: $crate::material::Transport,
        ) -> (Light<F>, F) {
            use $crate::material::many::Lobe;
            $Lobe::<F>::gather(these).eval_pdf(wo, wi, transport)
        }

        #[inline(always)]
        fn sample_many<F: Float>(
            these: impl $crate::material::many::These<Self>,
            wo: Vec3<F>,
            [u_lobe, u, v]: [F; 3],
            transport: $crate::material::Transport,
        ) -> ($crate::material::BsdfSample<F>, F::Mask) {
            use $crate::material::many::Lobe;
            $Lobe::<F>::gather(these).sample(wo, u_lobe, [u, v], transport)
        }
    };
}
pub(super) use is_lobe;

/// [`Scatter::eval_pdf`], lane by lane.
#[inline(always)]
pub(super) fn eval_pdf_one_by_one<K: Scatter, F: Float>(
    these: impl These<K>,
    [wo, wi]: [Vec3<F>; 2],
    transport: Transport,
) -> (Light<F>, F) {
    let mut all = [(Light::ZERO, 0.0); BLOCK];
    for (i, one) in all.iter_mut().enumerate().take(F::WIDTH) {
        *one = these.of(i).eval_pdf(wo.lane(i), wi.lane(i), transport);
    }
    let value = Light::from_fn(
        #[inline(always)]
        |i| all[i].0,
    );
    let pdf = F::from_fn(
        #[inline(always)]
        |i| all[i].1,
    );
    (value, pdf)
}

/// [`Scatter::sample`], lane by lane.
#[inline(always)]
pub(super) fn sample_one_by_one<K: Scatter, F: Float>(
    these: impl These<K>,
    wo: Vec3<F>,
    [u_lobe, u, v]: [F; 3],
    transport: Transport,
) -> (BsdfSample<F>, F::Mask) {
    let mut all = [BsdfSample::REFLECTED; BLOCK];
    let mut there = 0;
    for (i, one) in all.iter_mut().enumerate().take(F::WIDTH) {
        let drawn = these.of(i).sample(wo.lane(i), u_lobe.lane(i), [u.lane(i), v.lane(i)], transport);
        if let Some(drawn) = drawn {
            *one = drawn;
            there |= 1 << i;
        }
    }
    let number = Numbers(&all);
    let sample = BsdfSample {
        wi: Vec3::from_fn(
            #[inline(always)]
            |i| all[i].wi,
        ),
        weight: Light::from_fn(
            #[inline(always)]
            |i| all[i].weight,
        ),
        pdf: number.each(|s| s.pdf),
        delta: number.mask::<F>(|s| s.delta),
        transmitted: number.mask::<F>(|s| s.transmitted),
        eta: number.each(|s| s.eta),
        wavelength: number.each(|s| s.wavelength),
    };
    (sample, F::Mask::from_bits(there))
}

/// Samples of which one number after the other is taken.
struct Numbers<'a>(&'a [BsdfSample; BLOCK]);

impl Numbers<'_> {
    #[inline(always)]
    fn each<F: Float>(&self, f: fn(&BsdfSample) -> f32) -> F {
        F::from_fn(
            #[inline(always)]
            |i| f(&self.0[i]),
        )
    }

    #[inline(always)]
    fn mask<F: Float>(&self, f: fn(&BsdfSample) -> bool) -> F::Mask {
        let mut bits = 0;
        for (i, sample) in self.0.iter().enumerate().take(F::WIDTH) {
            bits |= u32::from(f(sample)) << i;
        }
        F::Mask::from_bits(bits)
    }
}

/// A number of each of these.
#[inline(always)]
pub(crate) fn each<K, F: Float>(these: impl These<K>, f: impl Fn(&K) -> f32) -> F {
    if let Some(one) = these.common(F::WIDTH) {
        return F::splat(f(one));
    }
    F::from_fn(
        #[inline(always)]
        |i| f(these.of(i)),
    )
}

/// Yes or no of each of these.
#[inline(always)]
pub(crate) fn which<K, F: Float>(these: impl These<K>, f: impl Fn(&K) -> bool) -> F::Mask {
    if let Some(one) = these.common(F::WIDTH) {
        return F::Mask::splat(f(one));
    }
    let mut bits = 0;
    for i in 0..F::WIDTH {
        bits |= u32::from(f(these.of(i))) << i;
    }
    F::Mask::from_bits(bits)
}

/// Light of each of these.
#[inline(always)]
pub(crate) fn light<K, F: Float>(these: impl These<K>, f: impl Fn(&K) -> Light) -> Light<F> {
    if let Some(one) = these.common(F::WIDTH) {
        return Light::uniform(f(one));
    }
    Light::from_fn(
        #[inline(always)]
        |i| f(these.of(i)),
    )
}
