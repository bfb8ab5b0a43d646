//! A BSDF on a surface whose shading normal is not its geometric one.
//!
//! Meshes of few triangles look round because light is reckoned about a *shading normal*, interpolated between the corners,
//! while rays meet the flat triangle. Where the two normals differ a BSDF, which knows of the shading normal alone, takes light
//! from behind the surface, and sends some into it. Both are false; cut off without more ado, they leave black slivers where a
//! ball turns away.
//!
//! What is done about it has one principle: **the surface is what can be made of its normals, as far as that lies above the triangles.**
//!
//! Where the normals at a triangle's corners tell of a surface that bulges out of it ([`crate::shape::TriangleMesh::bulge`]), that surface is taken: light is
//! scattered about its normal, above *its* horizon, and rays near the triangle's horizon start from up there ([`crate::shape::offset::Raised`]). So a
//! coarse ball has the shadow of a ball, without steps, and nothing is lost. Nothing leaks either: rays start in front of the triangle, and what they
//! meet is in their way, the triangle itself included.
//!
//! Where they tell of none (they all lean one way, the surface is hollow, light goes through it, or a map pretends a relief), the geometric
//! normal, or the smooth surface's below a relief, says what is in front: what is reflected stays on the side that it came from, what is
//! transmitted leaves on the other:
//!
//! - of a diffuse lobe the part above the surface is taken. What lies below, (1 - n.ng) / 2 of it, is lost, as it is in other
//!   renderers, where it ends within a closed mesh;
//! - every other lobe is mirrored by the surface where it dips below: to a direction comes what the BSDF has for it and for
//!   its mirror image, so that nothing is lost. A reflection that would end in the surface is continued above it, as off a flat mirror (after the
//!   second bounce of Schüssler et al. 2017, "Microfacet-based Normal Mapping for Robust Monte Carlo Path Tracing").
//!
//! And a shading normal that is seen from behind while the surface is seen from the front is bent, see [`shading_normal`].

use super::many::{self, These};
use super::{Bsdf, BsdfSample, Scatter, Transport};
use straal_color::Light;
use straal_math::Vec3;
use straal_math::simd::{Float, Mask};

/// A BSDF with the normals that it is used with. Directions are those of [`Bsdf`], about the shading normal.
#[derive(Clone, Copy, Debug)]
pub struct Shaded<'w> {
    /// What it does about the shading normal.
    pub bsdf: Bsdf<'w>,
    /// The unit normal of what says what is in front, on the shading normal's side: the triangle's, or that of the surface that bulges out of
    /// it; `None` where it is the shading normal.
    pub ng: Option<Vec3>,
}

/// A shading normal is bent where its cosine to the viewer is less than this part of the geometric normal's.
const LEAST: f32 = 0.5;

/// The shading normal for a viewer in the direction `wo`, and the geometric one on its side, where that differs.
///
/// The shading normal `n` says which side of the surface is outside, the geometric `ng` on which side the viewer is. Bent
/// towards the geometric one, just enough, is a shading normal that the viewer would see at a much flatter angle, or from behind: the
/// result doesn't jump.
#[inline]
pub fn shading_normal(n: Vec3, ng: Vec3, wo: Vec3) -> (Vec3, Option<Vec3>) {
    let (n, ng) = shading_normals(n, ng, wo);
    (n, (ng != Vec3::ZERO).then_some(ng))
}

/// [`shading_normal`], one or many side by side. The geometric normal is zero where it is the shading normal.
#[inline(always)]
pub fn shading_normals<F: Float>(n: Vec3<F>, ng: Vec3<F>, wo: Vec3<F>) -> (Vec3<F>, Vec3<F>) {
    let none = Vec3::splat(F::ZERO);
    let is_flat = same(n, ng) | same(n, -ng);
    if is_flat.all() {
        return (n, none);
    }
    let ng = Vec3::select(n.dot(ng).lt(F::ZERO), -ng, ng);
    let seen = wo.dot(ng);
    let lack = F::splat(LEAST) - wo.dot(n) / seen;
    // Seen edge-on the quotient may be anything.
    let bends = (lack.gt(F::ZERO) | lack.is_nan()) & !is_flat;
    let mut seen_n = n;
    if bends.any() {
        // By so much more its length grows that the part is LEAST / (1 + LEAST) at the least.
        let (bent, there) = (n + ng * (lack * (1.0 + LEAST))).normalize_checked();
        seen_n = Vec3::select(bends, Vec3::select(there, bent, ng), n);
    }
    (seen_n, Vec3::select(is_flat, none, ng))
}

#[inline(always)]
fn same<F: Float>(a: Vec3<F>, b: Vec3<F>) -> F::Mask {
    a.x.eq(b.x) & a.y.eq(b.y) & a.z.eq(b.z)
}

impl Shaded<'_> {
    /// [`Bsdf::eval_pdf`] with no light through an opaque surface.
    #[inline]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Light, f32) {
        eval_pdf_many(&self.bsdf, self.ng.unwrap_or(Vec3::ZERO), [wo, wi], transport)
    }

    /// [`Bsdf::sample`], in accordance with [`Self::eval_pdf`].
    #[inline]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        let u = [u_lobe, u[0], u[1]];
        let (sample, there) = sample_many(&self.bsdf, self.ng.unwrap_or(Vec3::ZERO), (wo, u), transport);
        there.then_some(sample)
    }
}

/// [`Shaded::eval_pdf`] of many side by side. `ng` are zero where the geometric normals are the shading normals.
#[inline(always)]
pub(crate) fn eval_pdf_many<K: Scatter, F: Float>(
    these: impl These<K>,
    ng: Vec3<F>,
    [wo, wi]: [Vec3<F>; 2],
    transport: Transport,
) -> (Light<F>, F) {
    let (value, pdf) = K::eval_pdf_many(these, [wo, wi], transport);
    let leans = leans(ng);
    if !leans.any() {
        return (value, pdf);
    }
    let kept = !leans | goes_on(ng, wo, wi);
    let (value, pdf) = (Light::select(kept, value, Light::splat(F::ZERO)), F::select(kept, pdf, F::ZERO));
    let image = mirrored(wi, ng);
    let mirrors = leans & !loses_below::<K, F>(these) & !goes_on(ng, wo, image);
    if !mirrors.any() {
        return (value, pdf);
    }
    let (v, p) = K::eval_pdf_many(these, [wo, image], transport);
    (Light::select(mirrors, value + v, value), F::select(mirrors, pdf + p, pdf))
}

/// [`Shaded::sample`] of many side by side, by a direction and three numbers, the first of which chooses a lobe; and which of
/// them are of value. `ng` as in [`eval_pdf_many`].
#[inline(always)]
pub(crate) fn sample_many<K: Scatter, F: Float>(
    these: impl These<K>,
    ng: Vec3<F>,
    (wo, u): (Vec3<F>, [F; 3]),
    transport: Transport,
) -> (BsdfSample<F>, F::Mask) {
    let (drawn, there) = K::sample_many(these, wo, u, transport);
    let leans = leans(ng);
    if !leans.any() {
        return (drawn, there);
    }
    let kept = !leans | goes_on(ng, wo, drawn.wi);
    let loses = loses_below::<K, F>(these);
    let there = there & (kept | !loses);
    let image = mirrored(drawn.wi, ng);
    let wi = Vec3::select(kept, drawn.wi, image);
    // The direction may have been drawn in either of two ways.
    let either = leans & there & !loses & !drawn.delta & !(kept & goes_on(ng, wo, image));
    if !either.any() {
        return (BsdfSample { wi, ..drawn }, there);
    }
    let (value, pdf) = eval_pdf_many(these, ng, [wo, wi], transport);
    let weight = value * (F::ONE / pdf);
    let sound = !either | (pdf.gt(F::ZERO) & weight.is_finite());
    let weight = Light::select(either, weight, drawn.weight);
    (BsdfSample { wi, weight, pdf: F::select(either, pdf, drawn.pdf), ..drawn }, there & sound)
}

/// Where the geometric normal isn't the shading normal.
#[inline(always)]
fn leans<F: Float>(ng: Vec3<F>) -> F::Mask {
    ng.x.ne(F::ZERO) | ng.y.ne(F::ZERO) | ng.z.ne(F::ZERO)
}

#[inline(always)]
fn loses_below<K: Scatter, F: Float>(these: impl These<K>) -> F::Mask {
    many::which::<K, F>(these, |k: &K| k.loses_below())
}

/// Whether a direction that is reflected by the shading normal is reflected by the surface as well, or transmitted by both. (A
/// normal of zero, which nothing lies before, has all reflected.)
#[inline(always)]
pub(crate) fn goes_on<F: Float>(ng: Vec3<F>, wo: Vec3<F>, wi: Vec3<F>) -> F::Mask {
    let transmitted = wi.z.gt(F::ZERO) ^ wo.z.gt(F::ZERO);
    let passes = wi.dot(ng).gt(F::ZERO) ^ wo.dot(ng).gt(F::ZERO);
    !(transmitted ^ passes)
}

/// By a plane mirror on the surface.
#[inline(always)]
fn mirrored<F: Float>(w: Vec3<F>, ng: Vec3<F>) -> Vec3<F> {
    w - ng * (w.dot(ng) * 2.0)
}

#[cfg(test)]
mod tests {
    use super::super::many::{Among, OfKind, WithKind};
    use super::super::{Dielectric, Diffuse, Metal, Mirror, RoughConductor};
    use super::*;
    use crate::testing::{ChiSquare, SphereGrid};
    use straal_math::lowdisc::{Pattern, Purpose, SampleName};
    use straal_math::simd::{BLOCK, Isa, Kernel, Simd};
    use straal_math::{ops, warp};

    const WHITE: Light = Light([1.0, 1.0, 1.0, 0.0]);

    fn opaque() -> Vec<Bsdf<'static>> {
        let lossless = Metal { eta: Light::ZERO, k: Light::ZERO, reflectance: WHITE };
        vec![
            Bsdf::Diffuse(Diffuse { reflectance: WHITE, two_sided: true }),
            Bsdf::RoughConductor(RoughConductor::new(lossless, 0.3)),
            Bsdf::RoughConductor(RoughConductor::new(lossless, 1.0)),
            Bsdf::Mirror(Mirror { reflectance: WHITE, two_sided: true }),
        ]
    }

    /// `f` with surfaces whose normals differ by some degrees, seen from many sides of both.
    fn for_all(mut f: impl FnMut(Shaded<'_>, Vec3)) {
        for bsdf in opaque() {
            for lean in [10.0, 37.0, 53.0, 85.0] {
                let (sin, cos) = ops::sin_cos_degrees(lean);
                let ng = Vec3::new(sin as f32, 0.0, cos as f32);
                for (theta, phi) in
                    [(0.0, 0.0), (50.0, 180.0), (80.0, 90.0), (75.0, 10.0), (75.0, 170.0), (130.0, 20.0)]
                {
                    let ((s, c), (sp, cp)) = (ops::sin_cos_degrees(theta), ops::sin_cos_degrees(phi));
                    let away = Vec3::new((s * cp) as f32, (s * sp) as f32, c as f32);
                    // About the bent normal.
                    let (n, ng) = shading_normal(Vec3::Z, ng, away);
                    let frame = straal_math::Frame::from_normal(n);
                    f(Shaded { bsdf, ng: ng.map(|ng| frame.to_local(ng)) }, frame.to_local(away));
                }
            }
        }
    }

    fn numbers(i: u32) -> [f32; 4] {
        Pattern::Random.d4(&SampleName::new(5, [0, 0], i), Purpose::Custom)
    }

    #[test]
    fn directions_are_drawn_by_their_density() {
        for_all(|shaded, wo| {
            if shaded.bsdf.is_delta() {
                return;
            }
            let grid = SphereGrid { axis: shaded.ng.unwrap(), focus: 1, rings: 20, sectors: 24 };
            let outcome = ChiSquare { grid, samples: 20_000, seed: 4, tests: 72 }.run(
                |u| Some(shaded.sample(wo, u[0], [u[1], u[2]], Transport::Radiance)?.wi),
                |wi| shaded.eval_pdf(wo, wi, Transport::Radiance).1,
            );
            if let Err(e) = outcome.verdict() {
                panic!("{shaded:?}, seen from {wo:?}: {e}");
            }
        });
    }

    #[test]
    fn no_light_goes_through() {
        for_all(|shaded, wo| {
            let ng = shaded.ng.unwrap();
            let front = wo.dot(ng) > 0.0;
            for i in 0..2000 {
                let u = numbers(i);
                let wi = warp::uniform_sphere([u[0], u[1]]);
                let (value, pdf) = shaded.eval_pdf(wo, wi, Transport::Radiance);
                assert!(
                    (wi.dot(ng) > 0.0) == front || (value.is_black() && pdf == 0.0),
                    "{shaded:?} {wo:?} {wi:?}"
                );
                let Some(s) = shaded.sample(wo, u[0], [u[1], u[2]], Transport::Radiance) else { continue };
                assert!(
                    (s.wi.dot(ng) > 0.0) == front && (s.wi.length() - 1.0).abs() < 1e-5,
                    "{shaded:?} {s:?}"
                );
                if !s.delta {
                    let (value, pdf) = shaded.eval_pdf(wo, s.wi, Transport::Radiance);
                    assert!((pdf / s.pdf - 1.0).abs() < 1e-3, "{shaded:?} {s:?} {pdf}");
                    assert!((value / pdf - s.weight).max_lane().abs() < 1e-3, "{shaded:?} {s:?}");
                }
            }
        });
    }

    /// In a white furnace, what a BSDF sends back it sends back whatever the geometric normal; a diffuse one, the part of it above
    /// the surface.
    #[test]
    fn nothing_gets_lost_but_what_diffuse_surfaces_send_into_themselves() {
        for_all(|shaded, wo| {
            let n = 20_000_u32;
            let alone = Shaded { ng: None, ..shaded };
            let mean = |of: &Shaded<'_>, first: u32| {
                let (mut sum, mut squares) = (0.0, 0.0);
                for i in 0..n {
                    let u = numbers(first + i);
                    let drawn = of.sample(wo, u[0], [u[1], u[2]], Transport::Radiance);
                    let weight = drawn.map_or(0.0, |s| f64::from(s.weight[0]));
                    sum += weight;
                    squares += weight * weight;
                }
                let mean = sum / f64::from(n);
                (mean, (squares / f64::from(n) - mean * mean) / f64::from(n))
            };
            let (with, without) = (mean(&shaded, 0), mean(&alone, n));
            let error = (with.1 + without.1).abs().sqrt() + 1e-6;
            // Of a cosine lobe about z, what lies on the side of a unit vector with z >= 0.
            let above = match shaded.bsdf {
                Bsdf::Diffuse(_) => 0.5 * (1.0 + f64::from(shaded.ng.unwrap().z)),
                _ => 1.0,
            };
            assert!(
                (with.0 - above * without.0).abs() < 4.5 * error,
                "{shaded:?}, seen from {wo:?}: {with:?} {without:?}"
            );
        });
    }

    #[test]
    fn glass_stays_glass() {
        let bsdf = Bsdf::Dielectric(Dielectric { eta: 1.5, reflectance: WHITE, transmittance: WHITE });
        let ng = Vec3::new(0.6, 0.0, 0.8);
        let shaded = Shaded { bsdf, ng: Some(ng) };
        for i in 0..2000 {
            let u = numbers(i);
            let wo = warp::uniform_sphere([u[0], u[1]]);
            if (wo.z > 0.0) != (wo.dot(ng) > 0.0) {
                continue;
            }
            let s = shaded.sample(wo, u[2], [u[3]; 2], Transport::Radiance).unwrap();
            assert_eq!(s.transmitted, (s.wi.dot(ng) > 0.0) != (wo.dot(ng) > 0.0), "{wo:?} {s:?}");
        }
    }

    #[test]
    fn shading_normals_face_whoever_sees_the_surface() {
        let ng = Vec3::new(0.6, 0.0, 0.8);
        for i in 0..5000 {
            let u = numbers(i);
            let wo = warp::uniform_sphere([u[0], u[1]]);
            let (n, turned) = shading_normal(Vec3::Z, ng, wo);
            assert_eq!(turned, Some(ng));
            let (seen, face) = (wo.dot(ng), wo.dot(n));
            assert!(face * seen >= 0.0 && (face / seen > 0.33 || seen.abs() < 1e-3), "{wo:?}: {n:?}");
            assert!(n.dot(ng) >= 0.8 - 1e-6 && (n.length() - 1.0).abs() < 1e-6);
            if wo.z / seen > LEAST {
                assert_eq!(n, Vec3::Z);
            }
            // Flipped normals are as good, and flat surfaces stay as they are.
            assert_eq!(shading_normal(Vec3::Z, -ng, wo), (n, Some(ng)));
            assert_eq!(shading_normal(ng, ng, wo), (ng, None));
        }
        // It doesn't jump, from one edge of the surface's front to the other.
        let mut last = None;
        for i in 0..=20_000 {
            let (s, c) = ops::sin_cos_degrees(f64::from(i) * 179.9 / 20_000.0 - 36.8);
            let (n, _) = shading_normal(Vec3::Z, ng, Vec3::new(c as f32, 0.1, s as f32).normalize());
            let step = last.map_or(0.0, |l: Vec3| (n - l).length());
            assert!(step < 0.02, "{i}: {n:?}");
            last = Some(n);
        }
    }

    /// BSDFs of one kind, or of several that meet in a block.
    struct Many<'a, K> {
        bsdfs: &'a [Bsdf<'static>; BLOCK],
        /// Of each lane, the number of its BSDF.
        which: [u8; BLOCK],
        kind: std::marker::PhantomData<K>,
        seed: u32,
    }

    type Told = ((Light, f32), Option<BsdfSample>);

    impl<K: OfKind<'static>> Kernel for Many<'_, K> {
        type Output = Vec<Told>;

        #[inline(always)]
        fn run<F: Float>(self) -> Vec<Told> {
            let mut all = vec![];
            for first in (0..BLOCK).step_by(F::WIDTH) {
                let these =
                    Among::<K>::new(self.bsdfs, &self.which[first..], &self.bsdfs[0]).expect("of the kind");
                let point = |i: usize| point(self.seed, first + i);
                let ng = Vec3::from_fn(|i| point(i).0.unwrap_or(Vec3::ZERO));
                let (wo, wi) = (Vec3::from_fn(|i| point(i).1), Vec3::from_fn(|i| point(i).2));
                let u = [0, 1, 2].map(|k| F::from_fn(|i| point(i).3[k]));
                let (value, pdf) = eval_pdf_many(these, ng, [wo, wi], Transport::Radiance);
                let (s, there) = sample_many(these, ng, (wo, u), Transport::Radiance);
                let (mut values, mut weights) = ([Light::ZERO; BLOCK], [Light::ZERO; BLOCK]);
                value.for_each(|i, v| values[i] = v);
                s.weight.for_each(|i, v| weights[i] = v);
                for i in 0..F::WIDTH {
                    let sample = BsdfSample {
                        wi: s.wi.lane(i),
                        weight: weights[i],
                        pdf: s.pdf.lane(i),
                        delta: s.delta.lane(i),
                        transmitted: s.transmitted.lane(i),
                        eta: s.eta.lane(i),
                        wavelength: s.wavelength.lane(i),
                    };
                    all.push(((values[i], pdf.lane(i)), there.lane(i).then_some(sample)));
                }
            }
            all
        }
    }

    /// A geometric normal, two directions and three numbers.
    fn point(seed: u32, i: usize) -> (Option<Vec3>, Vec3, Vec3, [f32; 3]) {
        let u: [[f32; 4]; 2] = [0, 1]
            .map(|k| Pattern::Random.d4(&SampleName::new(seed.into(), [i as u32, 0], k), Purpose::Custom));
        let ng = (Vec3::Z * 1.2 + warp::uniform_sphere([u[0][0], u[0][1]])).normalize();
        let wo = warp::uniform_sphere([u[0][2], u[0][3]]);
        let wi = warp::uniform_sphere([u[1][0], u[1][1]]);
        ((!i.is_multiple_of(3)).then_some(ng), wo, wi, [u[1][2], u[1][3], u[1][0]])
    }

    /// One after the other, and side by side by every instruction set.
    fn agree<K: OfKind<'static>>(bsdfs: &[Bsdf<'static>; BLOCK], seed: u32) {
        let all_alike = [3; BLOCK];
        let each_its_own = std::array::from_fn(|i| i as u8);
        for (simd, which) in Isa::ALL
            .into_iter()
            .filter_map(Simd::new)
            .flat_map(|simd| [(simd, each_its_own), (simd, all_alike)])
        {
            let many = Many::<K> { bsdfs, which, kind: std::marker::PhantomData, seed };
            for (i, told) in simd.run(many).into_iter().enumerate() {
                let (ng, wo, wi, u) = point(seed, i);
                let one = Shaded { bsdf: bsdfs[usize::from(which[i])], ng };
                let want = (
                    one.eval_pdf(wo, wi, Transport::Radiance),
                    one.sample(wo, u[0], [u[1], u[2]], Transport::Radiance),
                );
                assert_eq!(told, want, "{one:?} {simd:?}");
            }
        }
    }

    #[test]
    fn bsdfs_side_by_side_do_what_each_does_alone() {
        struct Agree<'a>(&'a [Bsdf<'static>; BLOCK], u32);
        impl WithKind<'static> for Agree<'_> {
            fn with<K: OfKind<'static>>(self) {
                agree::<K>(self.0, self.1);
            }
        }
        let all: Vec<Bsdf<'static>> = Bsdf::registry().iter().map(|e| e.bsdf).collect();
        for (k, bsdf) in all.iter().enumerate() {
            // Those of its kind in turn.
            let same: Vec<_> = all.iter().filter(|b| b.kind() == bsdf.kind()).collect();
            bsdf.kind().hand_to(Agree(&std::array::from_fn(|i| *same[(i + k) % same.len()]), k as u32));
        }
        for seed in 0..8 {
            agree::<Bsdf<'static>>(
                &std::array::from_fn(|i| all[(i * 5 + seed) % all.len()]),
                99 + seed as u32,
            );
        }
    }
}
