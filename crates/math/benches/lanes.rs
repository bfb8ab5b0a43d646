//! What lanes gain: nanoseconds a number and how many times as fast as plain numbers, for each instruction set of this processor:
//! `cargo bench -p straal-math`. Words behind `--` choose lines whose name holds one of them.
//!
//! Sets take turns within a round, and a ratio is the median over the rounds of the ratios within each, so that what else the
//! machine does weighs on all alike.
#![allow(clippy::print_stdout, clippy::disallowed_methods)] // a program that prints, and whose numbers reach no pixel

use std::hint::black_box;
use std::time::Instant;
use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_math::simd::{Float, Isa, Kernel, Simd, Uint};
use straal_math::table::{Table1, Table2};
use straal_math::{Frame, Vec3, ops, warp};

/// Numbers in a run: what is read and written stays in the first-level cache.
const N: usize = 1024;
const RUNS: usize = 8;
const ROUNDS: usize = 301;

/// Three columns that are read and three that are written.
type Columns = [Box<Column>; 3];

/// Registers are read and written within lines of the cache.
#[derive(Clone)]
#[repr(align(64))]
struct Column([f32; N]);

/// A line of the report: its name and what runs it.
type Line = (&'static str, fn(Simd, &Columns, &mut Columns));

macro_rules! line {
    ($name:literal, |$x:tt, $y:tt, $z:tt| $result:expr) => {{
        struct Work<'a>(&'a Columns, &'a mut Columns);
        impl Kernel for Work<'_> {
            type Output = ();
            #[inline(always)]
            fn run<F: Float>(self) {
                let Work(from, to) = self;
                for at in (0..N).step_by(F::WIDTH) {
                    let ($x, $y, $z) =
                        (F::load(&from[0].0[at..]), F::load(&from[1].0[at..]), F::load(&from[2].0[at..]));
                    let result: Vec3<F> = $result;
                    result.x.store(&mut to[0].0[at..]);
                    result.y.store(&mut to[1].0[at..]);
                    result.z.store(&mut to[2].0[at..]);
                }
            }
        }
        let line: Line = ($name, |simd, from, to| simd.run(Work(from, to)));
        line
    }};
}

/// A vertex's name, made of a number's bits as its node.
#[inline(always)]
fn name<F: Float>(node: F) -> SampleName<F> {
    let zero = F::Uint::splat(0);
    SampleName::side_by_side(1, [zero, zero], F::Uint::splat(5)).onward(node.to_bits(), zero)
}

fn lines() -> Vec<Line> {
    use std::sync::OnceLock;
    static LIST: OnceLock<Table1> = OnceLock::new();
    static GRID: OnceLock<Table2> = OnceLock::new();
    fn list() -> &'static Table1 {
        LIST.get_or_init(|| {
            let weights: Vec<f32> = (0..1000).map(|i| 1.0 + (i * i % 97) as f32).collect();
            Table1::new(&weights).unwrap()
        })
    }
    fn grid() -> &'static Table2 {
        GRID.get_or_init(|| {
            let weights: Vec<f32> = (0..512 * 256).map(|i| 1.0 + (i * i % 97) as f32).collect();
            Table2::new(512, 256, &weights).unwrap()
        })
    }
    static RECORDS: OnceLock<Vec<[f32; 4]>> = OnceLock::new();
    fn records() -> &'static [[f32; 4]] {
        RECORDS.get_or_init(|| (0..N as u32).map(|i| [0, 1, 2, 3].map(|k| (4 * i + k) as f32)).collect())
    }
    vec![
        line!("copy", |x, y, z| Vec3::new(x, y, z)),
        line!("sobol d1", |x, y, z| {
            let a = Pattern::Sobol.d1(&name(x), Purpose::Lobe);
            Vec3::new(a, y, z)
        }),
        line!("sobol d2", |x, _, z| {
            let [a, b] = Pattern::Sobol.d2(&name(x), Purpose::Direction);
            Vec3::new(a, b, z)
        }),
        line!("sobol d4", |x, _, _| {
            let [a, b, c, d] = Pattern::Sobol.d4(&name(x), Purpose::Film);
            Vec3::new(a, b, c + d)
        }),
        line!("random d2", |x, _, z| {
            let [a, b] = Pattern::Random.d2(&name(x), Purpose::Direction);
            Vec3::new(a, b, z)
        }),
        line!("sin_cos", |x, _, z| {
            let (s, c) = ops::sin_cos(x);
            Vec3::new(s, c, z)
        }),
        line!("exp", |x, y, z| Vec3::new(ops::exp(x), y, z)),
        line!("ln", |x, y, z| Vec3::new(ops::ln(x), y, z)),
        line!("pow", |x, y, z| Vec3::new(ops::pow(x, y), y, z)),
        line!("acos", |x, y, z| Vec3::new(ops::acos(x), y, z)),
        line!("atan2", |x, y, z| Vec3::new(ops::atan2(x, y), y, z)),
        line!("cosine hemisphere", |x, y, _| warp::cosine_hemisphere([x, y])),
        line!("uniform sphere", |x, y, _| warp::uniform_sphere([x, y])),
        line!("cosine power hemisphere", |x, y, z| warp::cosine_power_hemisphere([x, y], z * 100.0)),
        line!("normalize", |x, y, z| Vec3::new(x, y, z).normalize()),
        line!("frame to_world", |x, y, z| {
            let v = Vec3::new(x, y, z);
            Frame::from_normal(v).to_world(Vec3::new(y, z, x))
        }),
        line!("fused multiply-add", |x, y, z| Vec3::new(x.mul_add(y, z), y.mul_add(z, x), z.mul_add(x, y))),
        line!("diffuse vertex", |x, y, z| {
            // Number, frame, direction and pdf, as a step of a path has them.
            let [u, v, w] = Pattern::Sobol.d3(&name(x), Purpose::Direction);
            let wi = warp::cosine_hemisphere([u, v]);
            let n = Vec3::new(x, y, z).normalize();
            Frame::from_normal(n).to_world(wi) * (warp::cosine_hemisphere_pdf(wi.z) * w)
        }),
        line!("records by rows", |x, _, _| {
            let index = (x * N as f32).to_uint();
            let records = records();
            let [a, b, c, d] = F::from_rows(|i| records[index.lane(i) as usize % N]);
            Vec3::new(a, b, c + d)
        }),
        line!("records by gathers", |x, _, _| {
            let index = (x * N as f32).to_uint() << 2;
            let flat = records().as_flattened();
            let c = F::gather(flat, index | 2) + F::gather(flat, index | 3);
            Vec3::new(F::gather(flat, index), F::gather(flat, index | 1), c)
        }),
        line!("list of 1000", |x, _, _| {
            let c = list().samples(x);
            Vec3::new(F::from_bits(c.index), c.pmf, c.rest)
        }),
        line!("grid of 512 x 256", |x, y, _| {
            let p = grid().samples([x, y]);
            Vec3::new(p.uv[0], p.uv[1], p.pdf)
        }),
    ]
}

/// Seconds for [`RUNS`] runs.
fn time(simd: Simd, work: fn(Simd, &Columns, &mut Columns), from: &Columns, to: &mut Columns) -> f64 {
    let start = Instant::now();
    for _ in 0..RUNS {
        work(simd, black_box(from), to);
        black_box(&mut *to);
    }
    start.elapsed().as_secs_f64()
}

fn median(mut of: Vec<f64>) -> f64 {
    of.sort_by(f64::total_cmp);
    of[of.len() / 2]
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|w| !w.starts_with('-')).collect();
    let from: Columns = [1, 2, 3].map(|purpose| {
        let purpose = Purpose::ALL[purpose];
        let number = |i| Pattern::Random.d1(&SampleName::new(3, [i as u32, 0], 0), purpose);
        Box::new(Column(std::array::from_fn(number)))
    });
    let mut to = from.clone();
    let sets: Vec<Simd> =
        Isa::ALL.into_iter().filter_map(Simd::new).filter(|s| s.width() > 1 || *s == Simd::PLAIN).collect();
    print!("{:24}", "nanoseconds a number");
    sets.iter().for_each(|s| print!("{:>17}", s.isa()));
    println!();
    for (name, work) in lines() {
        if !words.is_empty() && !words.iter().any(|w| name.contains(w.as_str())) {
            continue;
        }
        let rounds: Vec<Vec<f64>> =
            (0..ROUNDS).map(|_| sets.iter().map(|&s| time(s, work, &from, &mut to)).collect()).collect();
        print!("{name:24}");
        for k in 0..sets.len() {
            let each = median(rounds.iter().map(|r| r[k]).collect()) * 1e9 / (N * RUNS) as f64;
            let ratio = median(rounds.iter().map(|r| r[0] / r[k]).collect());
            print!("{each:>9.2} ({ratio:>4.1}x)");
        }
        println!();
    }
}
