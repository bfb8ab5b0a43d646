//! The registry: every BSDF is put through every test of the contract, from every side.

use std::sync::Arc;
use straal_color::Light;
use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_math::{Vec3, ops, warp};

use super::testing::{Example, WHITE, flint, gold, lossless};
use super::*;
use crate::lanes::Carried;
use crate::testing::in_rgb;
use crate::testing::{ChiSquare, SphereGrid};
use crate::texture::{ReadRgb, TextureRef, Value};
use std::collections::BTreeSet;
use straal_color::spectrum::refraction::Glass;

/// Every kind of BSDF in the list.
fn registry() -> Vec<Example> {
    Bsdf::registry()
}

/// Through a prism of 60 degrees by Snell's law with Schott's Sellmeier figures: each wavelength leaves at its angle.
#[test]
fn a_prism_bends_as_snell_says() {
    let sf11 = Glass::named("SF11").unwrap().index();
    for nm in [380.0, 404.656, 435.8, 486.13, 546.07, 587.56, 656.27, 706.5, 780.0] {
        let n = sf11.at(nm);
        // About the angle of least deviation of yellow, where all get through; angles in degrees.
        for incidence in [66.0_f64, 70.0, 75.0] {
            let (sin, cos) = ops::sin_cos_degrees(incidence);
            let inside = sin / n;
            // Within the prism of apex A: the angles at the two faces add up to A.
            let (sin_a, cos_a) = ops::sin_cos_degrees(60.0);
            let at_second = sin_a * (1.0 - inside * inside).sqrt() - cos_a * inside;
            let want = n * at_second;
            let b = flint(Carried::One(nm as f32));
            let wo = Vec3::new(sin as f32, 0.0, cos as f32);
            let first = b.sample(wo, 0.999_999, [0.5; 2], Transport::Radiance).unwrap();
            assert!(first.transmitted && first.delta);
            // The second face is turned by the apex about y; its normal points out of the glass.
            let d = first.wi.as_dvec3();
            let (x, z) = (d.x * cos_a - d.z * sin_a, d.x * sin_a + d.z * cos_a);
            let wo = Vec3::new(x as f32, 0.0, -z.abs() as f32);
            let second = b.sample(wo, 0.999_999, [0.5; 2], Transport::Radiance).unwrap();
            let leaves = f64::from(second.wi.x.abs());
            let angle = |s: f64| ops::atan2_d(s, (1.0 - s * s).sqrt());
            assert!(
                (angle(leaves) - angle(want.abs())).abs() < 1e-4,
                "{nm} nm at {incidence}: {leaves} {want}"
            );
        }
    }
}

/// Four lanes together lose nothing: what is reflected and, four times over, what the first lane lets through.
#[test]
fn parted_lanes_lose_nothing() {
    let b = flint(Carried::Four([450.0, 500.0, 550.0, 650.0]));
    for wo in [Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.3, 0.1, -0.948_683_3), Vec3::new(0.9, 0.0, -0.435_889_9)]
    {
        let (mut reflected, mut passed) = (Light::ZERO, Light::ZERO);
        const N: usize = 1 << 14;
        for i in 0..N {
            let u = (i as f32 + 0.5) / N as f32;
            let Some(s) = b.sample(wo, u, [0.5; 2], Transport::Importance) else { continue };
            assert!(s.transmitted == (s.wavelength > 0.0));
            let sum = if s.transmitted { &mut passed } else { &mut reflected };
            *sum += s.weight * (1.0 / N as f32);
        }
        assert!((reflected[0] + 0.25 * passed[0] - 1.0).abs() < 2e-3, "{wo:?} {reflected:?} {passed:?}");
        assert!(passed.0[1..] == [0.0; 3]);
    }
}

/// In RGB the drawn wavelengths' colours average to white, and red is bent least.
#[test]
fn rainbows_average_to_white() {
    let wo = Vec3::new(0.8, 0.0, 0.6);
    let (mut sum, mut passed) = ([0.0; 3], 0.0);
    const N: usize = 4096;
    let (mut red, mut blue) = (Vec3::ZERO, Vec3::ZERO);
    for i in 0..N {
        let u = (i as f32 + 0.5) / N as f32;
        let s = flint(Carried::All).sample(wo, 0.999, [u, 0.0], Transport::Importance).unwrap();
        assert!(s.transmitted && s.wavelength > 360.0 - 1.0);
        for (c, sum) in sum.iter_mut().enumerate() {
            *sum += f64::from(s.weight[c]);
        }
        passed += 1.0;
        if s.wavelength < 450.0 && s.weight[2] > 2.0 * s.weight[0] {
            blue = s.wi;
        }
        if s.wavelength > 640.0 {
            red = s.wi;
            assert!(s.weight[0] > s.weight[1] && s.weight[0] > s.weight[2]);
        }
    }
    assert!(sum.iter().all(|v| (v / passed - 1.0).abs() < 2e-3), "{sum:?}");
    assert!(red.x.abs() > blue.x.abs() && blue.x != 0.0);
}

/// Mirrors a share of the light (the second parameter) and scatters the rest evenly.
#[derive(Debug)]
struct Varnish;

impl CustomScattering for Varnish {
    fn eval_pdf(&self, [colour, share]: &[Light; 2], pair: Pair, _: Transport) -> (Light, f32) {
        let pdf = warp::cosine_hemisphere_pdf(pair.wi.z * 1.0_f32.copysign(pair.wo.z)) * (1.0 - share[0]);
        (*colour * pdf, pdf)
    }

    fn sample(
        &self,
        [colour, share]: &[Light; 2],
        wo: Vec3,
        u: [f32; 3],
        _: Transport,
    ) -> Option<BsdfSample> {
        let sample = |wi, pdf, delta| BsdfSample {
            wi,
            weight: *colour,
            pdf,
            delta,
            transmitted: false,
            eta: 1.0,
            wavelength: 0.0,
        };
        if u[0] < share[0] {
            return Some(sample(Vec3::new(-wo.x, -wo.y, wo.z), share[0], true));
        }
        let d = warp::cosine_hemisphere([u[1], u[2]]);
        let pdf = warp::cosine_hemisphere_pdf(d.z) * (1.0 - share[0]);
        (d.z > 0.0).then(|| sample(Vec3::new(d.x, d.y, d.z * 1.0_f32.copysign(wo.z)), pdf, false))
    }

    fn is_delta(&self, _: &[Light; 2]) -> bool {
        false
    }

    fn albedo(&self, [colour, _]: &[Light; 2]) -> Light {
        *colour
    }
}

pub(super) fn varnish() -> Example {
    let bsdf = Bsdf::Custom(CustomBsdf { scattering: &Varnish, parameters: [WHITE, Light::rgb([0.25; 3])] });
    Example::new("a user's varnish", bsdf).albedo(1.0)
}

/// A direction by the angle to the normal and the angle about it, in degrees.
fn direction(theta: f64, phi: f64) -> Vec3 {
    let ((s, c), (sp, cp)) = (ops::sin_cos_degrees(theta), ops::sin_cos_degrees(phi));
    Vec3::new((s * cp) as f32, (s * sp) as f32, c as f32)
}

/// Where every BSDF is looked at from.
fn views() -> Vec<Vec3> {
    [(0.0, 0.0), (30.0, 20.0), (60.0, 200.0), (80.0, -75.0), (88.5, 130.0), (140.0, 50.0)]
        .map(|(theta, phi)| direction(theta, phi))
        .to_vec()
}

fn numbers(seed: u64, i: u32) -> [f32; 4] {
    Pattern::Random.d4(&SampleName::new(seed, [0, 0], i), Purpose::Custom)
}

/// `f` with every registered BSDF and view.
fn for_all(mut f: impl FnMut(&Example, Vec3)) {
    for entry in registry() {
        for wo in views() {
            f(&entry, wo);
        }
    }
}

/// Every kind of BSDF in the list is put through the tests below, and every material in its list is read as what it says.
#[test]
fn every_kind_is_registered() {
    let tried: BTreeSet<BsdfKind> = registry().iter().map(|e| e.bsdf.kind()).collect();
    assert_eq!(tried.into_iter().collect::<Vec<_>>(), BsdfKind::ALL);
    for (kind, &of) in BsdfKind::ALL.iter().enumerate() {
        assert_eq!(of as usize, kind);
    }
    for (name, examples) in recipes() {
        assert!(!examples.is_empty(), "{name} has no example");
        for (material, kind) in examples {
            assert_eq!(material.wants(), Wants::default(), "{name} of constants wants nothing");
            let mut materials = Materials::default();
            let index = materials.push(material);
            let bsdf = materials.bsdf(index, &ShadingPoint::NOWHERE, &in_rgb());
            assert_eq!(bsdf.kind(), kind, "{name}: {bsdf:?}");
        }
    }
}

#[test]
fn directions_are_drawn_by_their_density() {
    let tests = registry().len() * views().len();
    for_all(|entry, wo| {
        let mirrored = Vec3::new(-wo.x, -wo.y, wo.z);
        let grid = SphereGrid { axis: mirrored, focus: entry.focus, rings: 20, sectors: 24 };
        let test = ChiSquare { grid, samples: 20_000, seed: 3, tests };
        let outcome = test.run(
            |u| {
                let s = entry.bsdf.sample(wo, u[0], [u[1], u[2]], Transport::Radiance)?;
                (!s.delta).then_some(s.wi)
            },
            |wi| entry.bsdf.pdf(wo, wi, Transport::Radiance),
        );
        if let Err(e) = outcome.verdict() {
            panic!("{}, seen from {wo:?}: {e}", entry.name);
        }
    });
}

#[test]
fn samples_are_what_they_say() {
    for_all(|entry, wo| {
        for i in 0..2000 {
            let u = numbers(11, i);
            for transport in [Transport::Radiance, Transport::Importance] {
                let Some(s) = entry.bsdf.sample(wo, u[0], [u[1], u[2]], transport) else { continue };
                let told = || format!("{}, seen from {wo:?}: {s:?}", entry.name);
                assert!((s.wi.length() - 1.0).abs() < 1e-5, "{}", told());
                assert!(s.weight.is_finite() && s.weight.0.iter().all(|w| *w >= 0.0), "{}", told());
                assert_eq!(s.weight[3], 0.0, "a colour's fourth lane is dead: {}", told());
                assert!(s.pdf > 0.0 && s.pdf < f32::INFINITY, "{}", told());
                assert_eq!(s.transmitted, s.wi.z * wo.z < 0.0, "{}", told());
                assert!(s.transmitted || s.eta == 1.0, "{}", told());
                assert!(!s.delta || s.pdf <= 1.0, "{}", told());
                assert!(s.delta || !entry.bsdf.is_delta(), "{}", told());
                if s.delta {
                    continue;
                }
                // The same pair evaluated: the half-way vector comes back from directions rounded to 2^-24,
                // which a lobe of width alpha feels divided by alpha and by the cosine at grazing angles.
                let (f, pdf) = entry.bsdf.eval_pdf(wo, s.wi, transport);
                let sharpness = f32::from(i16::try_from(entry.focus).unwrap_or(1));
                let tolerance = 2e-5 * sharpness * sharpness * sharpness / wo.z.abs();
                assert!((pdf / s.pdf - 1.0).abs() < tolerance, "pdf {pdf} of {}", told());
                let w = f / pdf;
                assert!((w - s.weight).0.iter().all(|d| d.abs() < 1e-4), "f/pdf {w:?} of {}", told());
            }
        }
    });
}

#[test]
fn scattering_is_reciprocal() {
    for_all(|entry, wo| {
        if wo.z < 0.0 || !entry.is_reciprocal || entry.is_noisy {
            return;
        }
        for i in 0..2000 {
            let u = numbers(12, i);
            let drawn = entry.bsdf.sample(wo, u[0], [u[1], u[2]], Transport::Radiance);
            let even = warp::uniform_hemisphere([u[2], u[3]]);
            for wi in drawn.into_iter().filter(|s| !s.delta).map(|s| s.wi).chain([even]) {
                // A radiance's f is the importance's with the directions exchanged.
                let there = entry.bsdf.eval(wo, wi, Transport::Radiance) / wi.z.abs();
                let back = entry.bsdf.eval(wi, wo, Transport::Importance) / wo.z;
                let largest = ops::max(there.max_lane(), 1e-20);
                let apart = (there - back).map(f32::abs).max_lane() / largest;
                // What two directions on both sides have half-way is known the less, the nearer they are to opposite.
                let tolerance = if wi.z > 0.0 { 1e-4 } else { 1e-3 + 1e-4 / wo.z };
                assert!(apart < tolerance, "{}: {wo:?} {wi:?} {there:?} {back:?}", entry.name);
            }
            if let Some(s) = drawn.filter(|s| s.delta) {
                delta_lobe_leads_back(entry, wo, &s);
            }
        }
    });
}

/// The lobe that leads from `wo` to `s.wi` must lead back, for importance, with the same coefficient but for
/// the compression of radiance.
fn delta_lobe_leads_back(entry: &Example, wo: Vec3, s: &BsdfSample) {
    let back = (0..=8)
        .filter_map(|j| entry.bsdf.sample(s.wi, j as f32 / 8.1, [0.5; 2], Transport::Importance))
        .find(|b| b.delta && b.transmitted == s.transmitted);
    let Some(back) = back else {
        // Lobes of less than a ninth may be missed by the nine numbers.
        assert!(s.pdf < 1.0 / 8.0, "{}: no way back from {s:?}", entry.name);
        return;
    };
    assert!((back.wi - wo).length() < 1e-4 / wo.z, "{}: {back:?} leads elsewhere than {wo:?}", entry.name);
    assert!((back.eta * s.eta - 1.0).abs() < 1e-6);
    let (there, here) = (s.weight * (s.pdf * s.eta * s.eta), back.weight * back.pdf);
    // A mirror that leans sees light and viewer at different angles to the surface.
    let leaning = if s.transmitted { 1.0 } else { (s.wi.z / wo.z).abs() };
    let apart = there - here * leaning;
    assert!(apart.0.iter().all(|d| d.abs() < 1e-4 / wo.z), "{}: {there:?} {here:?}", entry.name);
}

#[test]
fn no_more_comes_out_than_goes_in() {
    const SIDE: u32 = 64;
    for_all(|entry, wo| {
        // The mean weight over an even grid of numbers is the albedo, delta lobes included.
        let mut mean = [0.0_f64; 4];
        let mut spread = 0.0_f64;
        let transport = if entry.of_radiance { Transport::Radiance } else { Transport::Importance };
        for i in 0..SIDE * SIDE {
            let u = [i % SIDE, i / SIDE].map(|k| (k as f32 + 0.5) / SIDE as f32);
            // In another order than the rows of the grid, by the golden ratio, for those that choose among lobes and draw within.
            let lobe = ((i * 2531 % (SIDE * SIDE)) as f32 + 0.5) / (SIDE * SIDE) as f32;
            if let Some(s) = entry.bsdf.sample(wo, lobe, u, transport) {
                // Radiance is compressed where it passes.
                let by = if entry.of_radiance { s.eta * s.eta } else { 1.0 };
                for (m, w) in mean.iter_mut().zip((s.weight * by).0) {
                    *m += f64::from(w) / f64::from(SIDE * SIDE);
                }
                if !s.delta {
                    spread += f64::from(s.weight[0] * by) / f64::from(SIDE * SIDE);
                }
            }
        }
        let seen = facing(wo, !entry.name.contains("one-sided")).is_some();
        // A lobe at the rim is met by few of the grid's numbers.
        let rim = 1e-3 / f64::from(wo.z.abs());
        let whole_within = entry.whole_within.map(|within| if within > rim { within } else { rim });
        let bound = if entry.keeps_energy {
            let gain = if entry.is_noisy { 2e-2 } else { entry.gain };
            1.0 + whole_within.unwrap_or(if spread > 0.0 { gain } else { 3e-5 })
        } else {
            f64::INFINITY
        };
        assert!(mean.iter().all(|m| *m <= bound), "{} from {wo:?}: {mean:?}", entry.name);
        if let Some(albedo) = entry.albedo {
            let want = if seen { albedo } else { 0.0 };
            assert!((mean[0] - want).abs() < 1e-5, "{} from {wo:?}: {mean:?}", entry.name);
        }
        if let Some(within) = whole_within {
            assert!((mean[0] - 1.0).abs() <= within, "{} from {wo:?}: {mean:?}", entry.name);
        }
        // What is evaluated integrates to the same.
        if spread > 0.0 && entry.bsdf.kind() != BsdfKind::Custom && !entry.passes && !entry.is_noisy {
            let grid = SphereGrid {
                axis: Vec3::new(-wo.x, -wo.y, wo.z),
                focus: entry.focus,
                ..SphereGrid::default()
            };
            let f = |wi| f64::from(entry.bsdf.eval(wo, wi, transport)[0]);
            let integral = grid.total(f, 1e-4);
            // Of several lobes, and where much lies at the rim, the grid of numbers is coarser.
            let usual = if entry.bsdf.chooses_lobe() || entry.whole_within.is_some() { 1e-2 } else { 5e-3 };
            let tolerance = if usual > rim { usual } else { rim };
            assert!((integral - spread).abs() < tolerance, "{} from {wo:?}: {integral} {spread}", entry.name);
        }
    });
}

#[test]
fn rough_metal_loses_only_what_would_bounce_twice() {
    // A white furnace: what is missing grows with roughness and is nothing for the smooth.
    let mean = |alpha: f32| {
        let bsdf = Bsdf::RoughConductor(RoughConductor::new(lossless(), alpha));
        let wo = direction(30.0, 0.0);
        let f = |wi| f64::from(bsdf.eval(wo, wi, Transport::Radiance)[0]);
        let grid = SphereGrid { axis: direction(30.0, 180.0), focus: 4, ..SphereGrid::default() };
        grid.total(f, 1e-5)
    };
    let albedos = [0.02, 0.1, 0.3, 0.6, 1.0].map(mean);
    assert!(albedos[0] > 0.999, "{albedos:?}");
    assert!(albedos.windows(2).all(|w| w[1] < w[0]), "{albedos:?}");
    // Mitsuba 3.9.1 draws 200,000 samples of mean 0.3285 of the last.
    assert!((albedos[4] - 0.3285).abs() < 2e-3, "{albedos:?}");
}

#[test]
fn rough_metal_is_that_of_mitsuba() {
    // alpha, angles of wo and wi (from the normal, about it), red, green, blue of f |cos|, pdf: by `roughconductor` of
    // Mitsuba 3.9.1 (`scalar_rgb`, GGX, visible normals).
    type Row = (f32, [f64; 2], [f64; 2], [f32; 3], f32);
    const TABLE: [Row; 9] = [
        (0.05, [0.0, 0.0], [10.0, 0.0], [1.865_369_9, 1.214_977, 1.000_189_9], 1.959_097_9),
        (0.05, [30.0, 20.0], [33.0, 195.0], [14.415_942, 9.390_111, 7.744_458], 15.150_993),
        (0.05, [80.0, -75.0], [82.0, 100.0], [0.193_882_02, 0.153_388_66, 0.143_076_69], 0.210_342_18),
        (0.3, [0.0, 0.0], [10.0, 0.0], [0.725_582_9, 0.472_596_08, 0.389_049_2], 0.762_558_64),
        (0.3, [60.0, 200.0], [55.0, 30.0], [1.040_435_4, 0.685_188_9, 0.578_179_54], 1.146_784_9),
        (0.3, [30.0, 0.0], [70.0, 90.0], [0.028_600_08, 0.018_633_07, 0.015_391_31], 0.034_509_44),
        (1.0, [30.0, 20.0], [33.0, 195.0], [0.074_051_93, 0.048_235_19, 0.039_781_79], 0.085_290_87),
        (1.0, [60.0, 200.0], [55.0, 30.0], [0.073_262_02, 0.048_247_42, 0.040_712_38], 0.106_103_33),
        (1.0, [80.0, -75.0], [82.0, 100.0], [0.031_479_02, 0.024_904_45, 0.023_230_18], 0.135_607),
    ];
    let metal = Metal { reflectance: WHITE, ..gold() };
    for (alpha, [theta_o, phi_o], [theta_i, phi_i], f, pdf) in TABLE {
        let bsdf = Bsdf::RoughConductor(RoughConductor::new(metal, alpha));
        let (wo, wi) = (direction(theta_o, phi_o), direction(theta_i, phi_i));
        let (got, got_pdf) = bsdf.eval_pdf(wo, wi, Transport::Radiance);
        // Theirs is in single precision as well, and divides by alpha.
        let near = |a: f32, b: f32| (a / b - 1.0).abs() < 2e-5;
        let rgb = got.to_rgb();
        assert!((0..3).all(|i| near(rgb[i], f[i])) && near(got_pdf, pdf), "{alpha}: {got:?} {got_pdf}");
    }
}

#[test]
fn glass_compresses_radiance_and_gives_it_back() {
    let bsdf = registry().into_iter().find(|e| e.name == "glass").map(|e| e.bsdf).unwrap();
    for wo in views() {
        let Some(into) = bsdf.sample(wo, 0.999, [0.5; 2], Transport::Radiance).filter(|s| s.transmitted)
        else {
            // Beyond the critical angle inside (41.8 degrees) nothing passes.
            assert!(wo.z < 0.0 && -wo.z < 0.745_36, "{wo:?}");
            continue;
        };
        let eta = if wo.z > 0.0 { 1.5 } else { 1.0 / 1.5 };
        assert!((into.eta - eta).abs() < 1e-6 && (into.weight[0] - 1.0 / (eta * eta)).abs() < 1e-6);
        // Snell's law, in the same plane.
        let sine = |d: Vec3| (d.x * d.x + d.y * d.y).sqrt();
        assert!((sine(wo) - eta * sine(into.wi)).abs() < 1e-6);
        assert!((wo.x * into.wi.y - wo.y * into.wi.x).abs() < 1e-6);
        // On through a parallel face, whose outside looks the other way.
        let next = Vec3::new(-into.wi.x, -into.wi.y, into.wi.z);
        let out = bsdf.sample(next, 0.9999, [0.5; 2], Transport::Radiance).unwrap();
        assert!((into.weight * out.weight - Light::rgb([1.0; 3])).0.iter().all(|d| d.abs() < 1e-5));
        assert!((out.wi - Vec3::new(-wo.x, -wo.y, wo.z)).length() < 1e-4);
    }
}

#[test]
fn backs_look_like_fronts_or_are_black() {
    let is_clear = |e: &&Example| {
        use BsdfKind::{
            Clear, Dielectric, DiffuseTransmission, DispersiveDielectric, RoughDielectric, ThinDielectric,
        };
        let clear =
            [Clear, Dielectric, DiffuseTransmission, DispersiveDielectric, RoughDielectric, ThinDielectric];
        e.passes || clear.contains(&e.bsdf.kind())
    };
    for entry in registry().iter().filter(|e| !is_clear(e)) {
        let turned = |d: Vec3| Vec3::new(d.x, d.y, -d.z);
        let one_sided = entry.name.contains("one-sided");
        for i in 0..200 {
            let u = numbers(13, i);
            let (wo, wi) = (warp::uniform_hemisphere([u[0], u[1]]), warp::uniform_hemisphere([u[2], u[3]]));
            let front = entry.bsdf.eval_pdf(wo, wi, Transport::Radiance);
            let back = entry.bsdf.eval_pdf(turned(wo), turned(wi), Transport::Radiance);
            let drawn = entry.bsdf.sample(wo, u[0], [u[1], u[2]], Transport::Radiance);
            let drawn_back = entry.bsdf.sample(turned(wo), u[0], [u[1], u[2]], Transport::Radiance);
            if one_sided {
                assert!(back == (Light::ZERO, 0.0) && drawn_back.is_none(), "{}", entry.name);
            } else {
                assert_eq!(front, back, "{}", entry.name);
                assert_eq!(drawn.map(|s| BsdfSample { wi: turned(s.wi), ..s }), drawn_back, "{}", entry.name);
            }
            // Nothing passes through what is opaque.
            assert_eq!(entry.bsdf.eval_pdf(wo, turned(wi), Transport::Radiance), (Light::ZERO, 0.0));
        }
    }
}

#[test]
fn extremes_give_nothing_or_finite_numbers() {
    let below_one = 1.0 - f32::EPSILON / 2.0;
    let tiny = 1e-20;
    let odd = [
        Vec3::X,
        Vec3::new(1.0, 0.0, tiny),
        Vec3::new(0.0, 1.0, -tiny),
        Vec3::Z,
        -Vec3::Z,
        Vec3::new(-1.0, 0.0, tiny),
        Vec3::splat(f32::NAN),
        Vec3::ZERO,
    ];
    for entry in registry() {
        for wo in odd {
            for u in [0.0, 0.5, below_one] {
                for v in [0.0, 0.5, below_one] {
                    for w in [0.0, 0.5, below_one] {
                        let drawn = entry.bsdf.sample(wo, u, [v, w], Transport::Radiance);
                        let fine =
                            |s: &BsdfSample| s.wi.is_finite() && s.weight.is_finite() && !s.pdf.is_nan();
                        assert!(
                            !wo.is_finite() || drawn.as_ref().is_none_or(fine),
                            "{}: {drawn:?}",
                            entry.name
                        );
                    }
                }
            }
            for wi in odd {
                let (f, pdf) = entry.bsdf.eval_pdf(wo, wi, Transport::Radiance);
                let known = wo.is_finite() && wi.is_finite();
                assert!(!known || (f.is_finite() && pdf >= 0.0), "{}: {wo:?} {wi:?} {f:?} {pdf}", entry.name);
            }
        }
    }
}

/// A user's material that brings his own scattering on one half of the surface.
#[derive(Debug)]
struct Halves;

impl CustomMaterial for Halves {
    fn bsdf(&self, at: &ShadingPoint, _: &dyn ReadRgb) -> Bsdf<'_> {
        if at.uv[0] < 0.5 {
            Bsdf::Custom(CustomBsdf { scattering: &Varnish, parameters: [Light::ONE; 2] })
        } else {
            Bsdf::Diffuse(Diffuse { reflectance: Light::rgb([at.uv[1]; 3]), two_sided: true })
        }
    }

    fn fingerprint(&self) -> u64 {
        1
    }
}

#[test]
fn materials_are_known_by_their_place() {
    let grey = DiffuseMaterial { reflectance: Light::rgb([0.5; 3]).into(), ..DiffuseMaterial::default() };
    let mut materials = Materials::default();
    materials.push(Material::Diffuse(grey));
    assert!(!materials.vary());
    assert_eq!(materials.push_custom(Arc::new(Halves)), 1);
    materials.push(Material::Custom(7));
    assert!(materials.vary() && materials.wants(1).point && !materials.wants(0).point);
    let at = ShadingPoint::of([0.2, 0.3], Vec3::ZERO);
    let kinds: Vec<BsdfKind> = (0..4).map(|i| materials.bsdf(i, &at, &in_rgb()).kind()).collect();
    assert_eq!(kinds, [BsdfKind::Diffuse, BsdfKind::Custom, BsdfKind::Black, BsdfKind::Black]);
    let other = ShadingPoint { uv: [0.7, 0.3], ..at };
    assert_eq!(materials.bsdf(1, &other, &in_rgb()).albedo(), Light::rgb([0.3; 3]));
    // Small enough to be handed around by value.
    let size = std::mem::size_of::<Bsdf>();
    assert!(size <= 112, "{size} bytes");

    let texture = Value::Texture(TextureRef { id: 0, most: 1.0 });
    materials.replace(1, Material::Diffuse(grey));
    assert!(!materials.vary());
    materials.replace(0, Material::Diffuse(DiffuseMaterial { reflectance: texture, ..grey }));
    assert!(materials.vary() && materials.wants(0).point);
}
