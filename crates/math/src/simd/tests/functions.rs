//! The crate's functions over lanes.

use super::*;
use crate::lowdisc::{Pattern, PatternKind, Purpose, SampleName};
use crate::table::{Table1, Table2};
use crate::{Affine, DVec3, Frame, Transform, Vec3, ops, warp};

/// Numbers of all sizes, and those about a circle.
fn everywhere() -> Vec<f32> {
    let mut all = SPECIAL.to_vec();
    all.extend((0..=u32::MAX).step_by(300_007).map(f32::from_bits));
    all.extend((0..=4000).map(|i| -8.0 + i as f32 * 0.004));
    padded(all)
}

/// Numbers that a random number can be, in columns.
fn units<const N: usize>() -> [Vec<f32>; N] {
    const LAST: f32 = 1.0 - f32::EPSILON / 2.0;
    let mut random = random_bits(77);
    let special = [0.0, 0.5, LAST, 0.25, 0.5 + f32::EPSILON, 0.50000006, 1e-7, 0.75];
    let mut all: [Vec<f32>; N] = std::array::from_fn(|_| Vec::new());
    for i in 0..special.len().pow(2) {
        for (k, column) in all.iter_mut().enumerate() {
            column.push(special[(i >> (3 * (k % 2))) % special.len()]);
        }
    }
    for column in &mut all {
        column.extend(random.by_ref().take(6000).map(|b| (b >> 8) as f32 / 16_777_216.0));
    }
    all.map(padded)
}

#[test]
fn functions_of_one_number() {
    lanes_agree!([everywhere()], |x| [
        bits(ops::sin(x)),
        bits(ops::cos(x)),
        bits(ops::tan(x)),
        bits(ops::sin_cos(x).0),
        bits(ops::sin_cos(x).1),
        bits(ops::sin_cos_eighth(x).0),
        bits(ops::sin_cos_eighth(x).1),
        bits(ops::asin(x)),
        bits(ops::acos(x)),
        bits(ops::atan(x)),
        bits(ops::exp(x)),
        bits(ops::exp2(x)),
        bits(ops::ln(x)),
        bits(ops::log2(x)),
        bits(ops::log10(x)),
        bits(ops::cbrt(x)),
        bits(ops::sinh(x)),
        bits(ops::cosh(x)),
        bits(ops::tanh(x)),
        bits(ops::powi(x, 5)),
        bits(ops::powi(x, -3)),
    ]);
}

#[test]
fn functions_of_two_and_three_numbers() {
    lanes_agree!(columns::<2>(), |x, y| [
        bits(ops::pow(x, y)),
        bits(ops::atan2(x, y)),
        bits(ops::hypot(x, y)),
        bits(ops::min(x, y)),
        bits(ops::max(x, y)),
    ]);
    lanes_agree!(columns::<3>(), |x, y, z| [bits(ops::clamp(x, y, z)), bits(ops::mul_add(x, y, z))]);
}

/// The bits of a vector.
#[inline(always)]
fn three<F: Float>(v: Vec3<F>) -> [F::Uint; 3] {
    v.to_array().map(bits)
}

#[test]
fn warps() {
    lanes_agree!(units::<4>(), |u, v, p, q| {
        let square = [u, v];
        let exponent = p * q * 1000.0;
        let spread = p * q * 2.0 + 1e-7;
        let mut out = Vec::new();
        for direction in [
            warp::cosine_hemisphere(square),
            warp::uniform_hemisphere(square),
            warp::uniform_sphere(square),
            warp::cosine_power_hemisphere(square, exponent),
            warp::uniform_cone(square, spread),
        ] {
            out.extend(three(direction));
        }
        for point in
            [warp::concentric_disc(square), warp::uniform_triangle(square), warp::uniform_ring(square, p, q)]
        {
            out.extend(point.map(bits));
        }
        let cosine = u * 2.0 - 1.0;
        out.extend([
            bits(warp::cosine_hemisphere_pdf(cosine)),
            bits(warp::uniform_hemisphere_pdf(cosine)),
            bits(warp::cosine_power_hemisphere_pdf(cosine, exponent)),
            bits(warp::uniform_cone_pdf(spread)),
        ]);
        out
    });
}

#[test]
fn vectors_frames_and_transforms() {
    /// A map that turns, stretches and moves.
    fn map() -> Transform {
        let turned = Affine::rotate(DVec3::new(1.0, 2.0, -0.5), 40.0).unwrap();
        let stretched = turned.then(&Affine::scale(DVec3::new(2.0, 0.3, 1.0)));
        Transform::new(&stretched.then(&Affine::translate(DVec3::new(4.0, -5.0, 0.1)))).unwrap()
    }
    let numbers = |seed| -> Vec<f32> {
        let random = random_bits(seed).take(4000).map(|x| x as i32 as f32 / 2e9);
        padded(SPECIAL.into_iter().chain(random).collect())
    };
    lanes_agree!([1, 2, 3, 4, 5, 6].map(numbers), |a, b, c, d, e, f| {
        let map = map();
        let (v, w) = (Vec3::new(a, b, c), Vec3::new(d, e, f));
        let frame = Frame::from_normal(v.normalize());
        let mut out = Vec::new();
        for vector in [
            v + w,
            v - w,
            v * d,
            v / d,
            -v,
            v.cross(w),
            v.min(w),
            v.max(w),
            v.abs(),
            v.normalize(),
            v.normalize_checked().0,
            Vec3::select(a.lt(b), v, w),
            frame.s,
            frame.t,
            frame.to_local(w),
            frame.to_world(w),
            map.point(v),
            map.vector(v),
            map.normal(v),
            map.inverse_point(v),
            map.inverse_vector(v),
            map.point_error(v, w.abs()),
            Vec3::from_double(v.to_double().cross(w.to_double()).normalize()),
        ] {
            out.extend(three(vector));
        }
        out.extend([v.dot(w), v.length(), v.length_squared(), v.max_element(), v.min_element()].map(bits));
        out.push(answer::<F>(v.is_finite()));
        out.push(answer::<F>(v.normalize_checked().1));
        out
    });
}

#[test]
fn lanes_of_vectors_come_and_go() {
    struct Lanes;
    impl Kernel for Lanes {
        type Output = ();
        #[inline(always)]
        fn run<F: Float>(self) {
            let one = |i: usize| Vec3::new(i as f32, 2.0 - i as f32, 0.5).normalize();
            let all = Vec3::<F>::from_fn(one);
            let frames = Frame::<F>::from_fn(|i| Frame::from_normal(one(i)));
            let name = |i: usize| SampleName::new(3, [i as u32, 7], 9).child(i as u32);
            let names = SampleName::<F>::from_fn(name);
            for i in 0..F::WIDTH {
                assert_eq!((all.lane(i), names.lane(i)), (one(i), name(i)));
                let frame = Frame::from_normal(one(i));
                assert_eq!(
                    (frames.s.lane(i), frames.t.lane(i), frames.n.lane(i)),
                    (frame.s, frame.t, frame.n)
                );
                assert_eq!(Vec3::<F>::uniform(Vec3::X).lane(i), Vec3::X);
            }
        }
    }
    sets().for_each(|set| set.run(Lanes));
}

#[test]
fn patterns() {
    for kind in PatternKind::ALL {
        struct Draws(Pattern);
        impl Kernel for Draws {
            type Output = Vec<[u32; 10]>;
            #[inline(always)]
            fn run<F: Float>(self) -> Self::Output {
                let mut out = Vec::new();
                for at in (0..1024).step_by(F::WIDTH) {
                    let i = F::Uint::from_fn(|lane| (at + lane) as u32);
                    // Pixels and indices, large ones as well, and nodes of all depths.
                    let pixel = [i.wrapping_mul(F::Uint::splat(0x9e37)), i >> 3];
                    let index = F::Uint::select((i & 1).eq(F::Uint::splat(0)), i, i << 20);
                    let mut name = self.0.names::<F>(0xfedc_ba98_7654_3210, pixel, index);
                    assert!(name.index().eq(index).all());
                    for branch in 0..at as u32 / 256 {
                        name = name.child(branch);
                    }
                    let [a] = [self.0.d1(&name, Purpose::Lobe)];
                    let [b, c] = self.0.d2(&name, Purpose::Direction);
                    let [d, e, f] = self.0.d3(&name, Purpose::LightPoint);
                    let [g, h, k, l] = self.0.d4(&name, Purpose::Film);
                    let numbers = [a, b, c, d, e, f, g, h, k, l];
                    out.extend((0..F::WIDTH).map(|lane| numbers.map(|x| x.lane(lane).to_bits())));
                }
                out
            }
        }
        let pattern = Pattern::new(kind, 48);
        let want = Simd::PLAIN.run(Draws(pattern));
        for set in sets() {
            assert!(set.run(Draws(pattern)) == want, "{kind}, {}", set.isa());
        }
        // And that is what the one name gives.
        let name = pattern.name(0xfedc_ba98_7654_3210, [0x9e37 * 3, 0], 3 << 20);
        assert_eq!(pattern.d1(&name, Purpose::Lobe).to_bits(), want[3][0]);
    }
}

#[test]
fn tables() {
    let weights: Vec<f32> =
        (0..997).map(|i| if i % 5 == 3 { 0.0 } else { 1.0 + (i * i % 89) as f32 }).collect();
    struct Lookups<'a>(&'a Table1, &'a Table2, &'a [Vec<f32>; 2]);
    impl Kernel for Lookups<'_> {
        type Output = Vec<[u32; 10]>;
        #[inline(always)]
        fn run<F: Float>(self) -> Self::Output {
            let Lookups(list, grid, u) = self;
            let mut out = Vec::new();
            for at in (0..u[0].len()).step_by(F::WIDTH) {
                let u = [F::load(&u[0][at..]), F::load(&u[1][at..])];
                let (one, two) = (list.samples(u[0]), grid.samples(u));
                let results = [
                    one.index,
                    bits(one.pmf),
                    bits(one.rest),
                    bits(list.pmfs::<F>(one.index.wrapping_add(F::Uint::splat(400)))),
                    two.texel[0],
                    two.texel[1],
                    bits(two.uv[0]),
                    bits(two.uv[1]),
                    bits(two.pdf),
                    bits(grid.pdf([u[1] * 1.2 - 0.1, u[0] * 1.2 - 0.1])),
                ];
                out.extend((0..F::WIDTH).map(|lane| results.map(|x| x.lane(lane))));
            }
            out
        }
    }
    let (list, grid) = (Table1::new(&weights).unwrap(), Table2::new(37, 26, &weights[..37 * 26]).unwrap());
    let mut u = units::<2>();
    for column in &mut u {
        column.extend([f32::NAN, -1.0, 1.0, 2.0, f32::INFINITY, f32::NEG_INFINITY, -0.0, 0.5]);
        *column = padded(std::mem::take(column));
    }
    let want = Simd::PLAIN.run(Lookups(&list, &grid, &u));
    for set in sets() {
        assert!(set.run(Lookups(&list, &grid, &u)) == want, "{}", set.isa());
    }
    for (i, want) in want.iter().enumerate() {
        let (one, two) = (list.sample(u[0][i]), grid.sample([u[0][i], u[1][i]]));
        assert_eq!((one.index as u32, one.rest.to_bits()), (want[0], want[2]));
        assert_eq!((two.texel.map(|t| t as u32), two.pdf), ([want[4], want[5]], grid.texel_pdf(two.texel)));
    }
}
