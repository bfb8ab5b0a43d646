//! Every lane of every instruction set must give the bits of plain numbers.

mod functions;

use super::*;

/// The sets that this processor has.
fn sets() -> impl Iterator<Item = Simd> {
    Isa::ALL.into_iter().filter_map(Simd::new)
}

/// The bits of a number, those of one NaN for all of them: which it is differs by processor.
#[inline(always)]
fn bits<F: Float>(x: F) -> F::Uint {
    F::Uint::select(x.is_nan(), F::Uint::splat(f32::NAN.to_bits()), x.to_bits())
}

/// The bits of a number in double precision, upper half first.
#[inline(always)]
fn bits_of_double<F: Float>(x: F::Double) -> [F::Uint; 2] {
    let is_number = x.eq(x);
    let halves = [x.to_bits().high(), x.to_bits().low()];
    halves.map(|h| F::Uint::select(is_number, h, F::Uint::splat(u32::MAX)))
}

/// 1 where it is so, else 0.
#[inline(always)]
fn answer<F: Float>(yes: F::Mask) -> F::Uint {
    F::Uint::select(yes, F::Uint::splat(1), F::Uint::splat(0))
}

/// For columns of as many numbers, a block at a time, an expression of one vector of each: an array of `F::Uint`. All sets must
/// give what plain numbers give.
macro_rules! lanes_agree {
    ($columns:expr, |$($x:ident),*| $results:expr) => {{
        struct Work<'a>(&'a [Vec<f32>]);
        impl $crate::simd::Kernel for Work<'_> {
            type Output = Vec<Vec<u32>>;
            #[inline(always)]
            fn run<F: $crate::simd::Float>(self) -> Vec<Vec<u32>> {
                let mut out = Vec::new();
                for at in (0..self.0[0].len()).step_by(F::WIDTH) {
                    let mut columns = self.0.iter().map(|c| F::load(&c[at..]));
                    $(let $x: F = columns.next().unwrap();)*
                    let results = $results;
                    for i in 0..F::WIDTH {
                        out.push(results.iter().map(|r: &F::Uint| r.lane(i)).collect::<Vec<u32>>());
                    }
                }
                out
            }
        }
        let columns: &[Vec<f32>] = &$columns;
        let want = $crate::simd::Simd::PLAIN.run(Work(columns));
        for set in sets() {
            for (i, (got, want)) in set.run(Work(columns)).into_iter().zip(&want).enumerate() {
                let at = columns.iter().map(|c| c[i]).collect::<Vec<_>>();
                let hex = |v: &[u32]| v.iter().map(|x| format!("{x:#x}")).collect::<Vec<_>>();
                assert_eq!(hex(&got), hex(want), "{} at {at:?} ({i})", set.isa());
            }
        }
    }};
}
use lanes_agree;

/// Numbers that are likely to go wrong.
const SPECIAL: [f32; 40] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    1e-45,
    -1e-45,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1.1754942e-38,
    f32::MAX,
    f32::MIN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    -f32::NAN,
    0.99999994,
    1.0000001,
    1.5,
    2.5,
    -2.5,
    -0.99999994,
    8_388_607.5,
    -8_388_607.5,
    16_777_216.0,
    2_147_483_520.0,
    2_147_483_648.0,
    -2_147_483_648.0,
    -2_147_483_904.0,
    4_294_967_040.0,
    4_294_967_296.0,
    1e30,
    -1e30,
    1e-30,
    0.1,
    std::f32::consts::PI,
    -std::f32::consts::FRAC_PI_2,
    1_048_576.0,
    3.0,
];

/// Random bits, the same each time.
fn random_bits(seed: u64) -> impl Iterator<Item = u32> {
    let mut state = seed;
    std::iter::repeat_with(move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 32) as u32
    })
}

/// A whole number of blocks.
fn padded(mut column: Vec<f32>) -> Vec<f32> {
    column.resize(column.len().next_multiple_of(BLOCK), 0.25);
    column
}

/// Columns of all combinations of special numbers, of any bits, and of numbers about 1.
fn columns<const N: usize>() -> [Vec<f32>; N] {
    let pairs = if N > 2 { 400 } else { SPECIAL.len() * SPECIAL.len() };
    let mut random = random_bits(N as u64);
    let mut all: [Vec<f32>; N] = std::array::from_fn(|_| Vec::new());
    for i in 0..if N == 1 { SPECIAL.len() } else { pairs } {
        let mut i = if N > 2 { random.next().unwrap() as usize % SPECIAL.len().pow(N as u32) } else { i };
        for column in &mut all {
            column.push(SPECIAL[i % SPECIAL.len()]);
            i /= SPECIAL.len();
        }
    }
    for column in &mut all {
        column.extend(random.by_ref().take(4000).map(f32::from_bits));
        column.extend(random.by_ref().take(4000).map(|x| x as i32 as f32 / 1e9));
    }
    all.map(padded)
}

#[test]
fn arithmetic_is_that_of_plain_numbers() {
    lanes_agree!(columns::<2>(), |x, y| [
        bits(x + y),
        bits(x - y),
        bits(x * y),
        bits(x / y),
        bits(x.sqrt()),
        bits(-x),
        bits(x.abs()),
        bits(x.copysign(y)),
        bits(x.min(y)),
        bits(x.max(y)),
        bits(x.floor()),
        bits(x.trunc()),
        bits(x * 0.3 + 1.0 - 0.5),
        bits((F::ONE / x) * (F::ZERO - y / 3.0)),
    ]);
}

#[test]
fn a_fused_product_and_sum_is_rounded_once() {
    lanes_agree!(columns::<3>(), |x, a, b| [bits(x.mul_add(a, b))]);
    // Where the sum nearly cancels the product, and where the result is below the normal range.
    let [x, a, tail] = columns::<3>();
    let near = |scale: f32| -> Vec<f32> {
        x.iter().zip(&a).zip(&tail).map(|((x, a), t)| -(x * a) * (1.0 + scale * t)).collect()
    };
    lanes_agree!([x.clone(), a.clone(), near(1e-7)], |x, a, b| [bits(x.mul_add(a, b))]);
    let small = |v: &[f32], by: f32| -> Vec<f32> { v.iter().map(|x| x * by).collect() };
    lanes_agree!([small(&x, 1e-20), small(&a, 1e-20), small(&tail, 1e-39)], |x, a, b| [bits(
        x.mul_add(a, b)
    )]);
    // Ties of the two roundings: (1 + 2^-12)² is 1 + 2^-11 + 2^-24, and the sum has a tail far below.
    let one = 1.0 + 2f32.powi(-12);
    assert_eq!(one.mul_add(one, 0.0), 1.0 + 2f32.powi(-11));
    for tail in [1e-30, 1e-45] {
        assert_eq!(plain::fused(one, one, tail), 1.0 + 2f32.powi(-11) + 2f32.powi(-23));
        assert_eq!(plain::fused(one, one, -tail), 1.0 + 2f32.powi(-11));
        assert_eq!(plain::fused(-one, one, tail), -1.0 - 2f32.powi(-11));
    }
}

#[test]
fn comparisons_choose_as_branches_do() {
    lanes_agree!(columns::<2>(), |x, y| [
        answer::<F>(x.lt(y)),
        answer::<F>(x.le(y)),
        answer::<F>(x.gt(y)),
        answer::<F>(x.ge(y)),
        answer::<F>(x.eq(y)),
        answer::<F>(x.ne(y)),
        answer::<F>(x.is_nan()),
        answer::<F>(x.is_finite()),
        answer::<F>(x.is_sign_negative() & x.eq(x)),
        answer::<F>(x.lt(y) & y.lt(F::ONE)),
        answer::<F>(x.lt(y) | y.lt(F::ONE)),
        answer::<F>(x.lt(y) ^ !y.lt(F::ONE)),
        bits(F::select(x.lt(y), x, y)),
        answer::<F>(F::Mask::from_bits(x.lt(y).to_bits())),
    ]);
}

#[test]
fn conversions_are_those_of_plain_numbers() {
    lanes_agree!(columns::<2>(), |x, y| [
        x.to_uint(),
        x.to_int(),
        bits(F::from_uint(x.to_bits())),
        bits(F::from_int(x.to_bits())),
        bits(F::from_bits(x.to_bits())),
        bits(F::from_double(x.to_double())),
        bits(F::from_double(x.to_double() * y.to_double())),
        bits(F::from_double(x.to_double() / 3.0)),
    ]);
    assert_eq!(
        (Float::to_uint(-1.0_f32), Float::to_uint(f32::NAN), Float::to_int(-1.5_f32)),
        (0, 0, u32::MAX)
    );
}

#[test]
fn whole_numbers_wrap_around() {
    lanes_agree!(columns::<2>(), |x, y| {
        let (x, y) = (x.to_bits(), y.to_bits());
        let table = [3, 1 << 31, 5, 7, u32::MAX, 9, 0, 2];
        [
            x.wrapping_add(y),
            x.wrapping_sub(y),
            x.wrapping_mul(y),
            x & y,
            x | y,
            x ^ y,
            !x,
            (x & 0xff00_ff00) | 3,
            x << 7,
            x >> 9,
            x.shr_signed(9),
            x.shl_each(y & 31),
            x.shr_each(y & 31),
            x.min(y),
            x.max(y),
            x.reverse_bits(),
            F::Uint::reverse_both(x, y)[0],
            F::Uint::reverse_both(x, y)[1],
            answer::<F>(x.eq(y)),
            answer::<F>(x.lt(y)),
            answer::<F>(x.le(y)),
            answer::<F>(x.lt_signed(y)),
            x.look_up(&table),
            x.to_ulong().low(),
            x.to_ulong().high(),
        ]
    });
}

#[test]
fn wide_numbers_wrap_around() {
    lanes_agree!(columns::<3>(), |x, y, z| {
        let wide = |a: F, b: F| a.to_bits().to_ulong() << 32 | b.to_bits().to_ulong();
        let (a, b) = (wide(x, y), wide(y, z));
        let c = F::Ulong::select(x.lt(y), a, b);
        let all = [
            a.wrapping_add(b),
            a.wrapping_sub(b),
            a.wrapping_mul(b),
            a & b,
            a | b,
            a ^ b,
            !a,
            (a & 0xffff_0000_ff00_00ff) | 1 << 40,
            a << 13,
            a >> 37,
            c,
        ];
        let mut out = all.map(|v| v.low()).to_vec();
        out.extend(all.map(|v| v.high()));
        out.push(answer::<F>(a.eq(c)));
        out
    });
}

#[test]
fn double_precision_is_that_of_plain_numbers() {
    lanes_agree!(columns::<2>(), |x, y| {
        // Numbers that single precision hasn't.
        let (a, b) = (x.to_double() / 3.0, y.to_double() * 0.7);
        let all = [
            a + b,
            a - b,
            a * b,
            a / b,
            -a,
            a.sqrt(),
            a.abs(),
            a.copysign(b),
            a.min(b),
            a.max(b),
            F::Double::select(a.lt(b), a, b),
            F::Double::from_bits(a.to_bits()),
            (a + 0.1 - 0.2) * (F::Double::ONE - b),
        ];
        let mut out: Vec<F::Uint> = all.into_iter().flat_map(bits_of_double::<F>).collect();
        let is_number = a.eq(a);
        out.extend([a.lt(b), a.le(b), a.gt(b), a.ge(b), a.eq(b), a.is_finite()].map(answer::<F>));
        out.push(answer::<F>(a.is_sign_negative() & is_number));
        out
    });
}

#[test]
fn lanes_come_from_memory_and_go_back() {
    struct Lanes<'a>(&'a [f32; BLOCK]);
    impl Kernel for Lanes<'_> {
        type Output = usize;
        #[inline(always)]
        fn run<F: Float>(self) -> usize {
            let x = F::load(self.0);
            let mut back = [0.0; BLOCK];
            x.store(&mut back);
            for (i, &back) in back.iter().enumerate().take(F::WIDTH) {
                assert_eq!((x.lane(i), back, x.to_array().as_ref()[i]), (self.0[i], self.0[i], self.0[i]));
            }
            assert!(x.eq(F::from_fn(|i| self.0[i])).all() && x.eq(F::from_array(x.to_array())).all());
            assert!(x.map(|v| 2.0 * v).eq(x + x).all());
            let doubled = F::Double::from_fn(|i| f64::from(self.0[i]));
            assert!(
                doubled.eq(x.to_double()).all()
                    && doubled.lane(F::WIDTH - 1) == doubled.to_array().as_ref()[F::WIDTH - 1]
            );

            let row = |i: usize| [0, 1, 2, 3].map(|k| (10 * i + k) as f32);
            let columns = F::from_rows(row);
            for (k, column) in columns.into_iter().enumerate() {
                assert!(column.eq(F::from_fn(|i| row(i)[k])).all());
            }
            let mut back = Vec::new();
            F::to_rows(columns, |i, numbers| back.push((i, numbers)));
            assert!(back.into_iter().eq((0..F::WIDTH).map(|i| (i, row(i)))));

            // Indices beyond the end.
            let index = F::Uint::from_fn(|i| if i % 3 == 2 { u32::MAX - i as u32 } else { 2 * i as u32 });
            let table = self.0.map(f32::to_bits);
            let (numbers, whole) = (F::gather(self.0, index), F::Uint::gather(&table, index));
            for i in 0..F::WIDTH {
                let want = self.0[(index.lane(i) as usize).min(BLOCK - 1)];
                assert_eq!((numbers.lane(i), whole.lane(i)), (want, want.to_bits()));
            }
            assert!(F::gather(&[], index).eq(F::ZERO).all());
            assert!(F::Uint::gather(&[], index).eq(F::Uint::splat(0)).all());
            assert!(F::gather(&[7.0], index).eq(F::splat(7.0)).all());

            let first = F::Mask::from_bits(1);
            assert!(first.any() && first.lane(0) && first.to_bits() == 1 && (F::WIDTH == 1) == first.all());
            assert!(
                F::Mask::splat(true).all() && !F::Mask::splat(false).any() && !(!F::Mask::splat(true)).any()
            );
            assert_eq!(F::vectorize(|| F::WIDTH), F::WIDTH);
            assert_eq!(BLOCK % F::WIDTH, 0);
            F::WIDTH
        }
    }
    let numbers = std::array::from_fn(|i| 1.5 + i as f32);
    for set in sets() {
        let width = set.run(Lanes(&numbers));
        assert_eq!(width, set.width());
        let want = match set.isa() {
            Isa::Scalar | Isa::Sse => 1,
            Isa::Avx2 | Isa::Neon => 8,
            Isa::Avx512 => 16,
        };
        assert_eq!(width, want, "{}", set.isa());
    }
}

#[test]
fn sets_are_known_by_name() {
    for isa in Isa::ALL {
        assert_eq!(isa.name().parse(), Ok(isa));
    }
    let message = "mmx".parse::<Isa>().unwrap_err().to_string();
    assert!(message.contains("'mmx'") && message.contains("avx512"), "{message}");
    assert!(Isa::detect().is_available());
}
