use super::*;
use crate::simd::{Isa, Kernel, Simd};

/// Points of grids by their numbers, with what densities are told of them.
struct Draws<'a>(&'a Tables2, &'a [u32], &'a [[f32; 2]]);

impl Kernel for Draws<'_> {
    type Output = Vec<(Point2, f32, [usize; 2])>;

    #[inline(always)]
    fn run<F: Float>(self) -> Self::Output {
        let mut all = vec![];
        for first in (0..self.1.len()).step_by(F::WIDTH) {
            let grid = F::Uint::load(&self.1[first..]);
            let u = [0, 1].map(|k| F::from_fn(|i| self.2[first + i][k]));
            let (points, size) = self.0.samples(grid, u);
            let (told, same_size): (F, _) = self.0.texel_pdfs(grid, points.texel);
            for i in 0..F::WIDTH {
                let point = Point2 {
                    uv: points.uv.map(|v| v.lane(i)),
                    texel: points.texel.map(|v| v.lane(i) as usize),
                    pdf: points.pdf.lane(i),
                };
                let size = size.map(|n| n.lane(i) as usize);
                assert_eq!(size, same_size.map(|n| n.lane(i) as usize));
                all.push((point, told.lane(i), size));
            }
        }
        all
    }
}

#[test]
fn several_grids_are_drawn_from_as_each_alone() {
    let grids: Vec<Table2> = [[1, 1], [3, 5], [32, 16], [31, 2], [1, 9]]
        .into_iter()
        .map(|[w, h]| {
            let weight = |i: usize| if i % 7 == 3 { 0.0 } else { (i % 5) as f32 + 0.1 };
            Table2::new(w, h, &(0..w * h).map(weight).collect::<Vec<_>>()).unwrap()
        })
        .collect();
    let mut all = Tables2::with_room(700);
    grids.iter().for_each(|grid| all.push(grid).unwrap());
    let asked: Vec<u32> = (0..320).map(|i| i % 5).collect();
    let u: Vec<[f32; 2]> =
        (0..320).map(|i| [(i * 37 % 320) as f32 / 320.0, (i * 91 % 320) as f32 / 320.0]).collect();
    for simd in Isa::ALL.into_iter().filter_map(Simd::new) {
        for (i, (point, told, size)) in simd.run(Draws(&all, &asked, &u)).into_iter().enumerate() {
            let grid = &grids[asked[i] as usize];
            assert_eq!((point, size), (grid.sample(u[i]), grid.size()), "{simd:?}");
            assert_eq!(told, grid.texel_pdf(point.texel), "{simd:?}");
        }
    }
}

#[test]
fn probabilities_are_what_is_drawn() {
    let weights = [0.0, 3.0, 0.0, 1e-30, 5.0, f32::NAN, 0.5, -2.0, f32::INFINITY, 0.0];
    let table = Table1::new(&weights).unwrap();
    let mut steps = [0_u32; 10];
    for k in 0..STEPS {
        let c = table.sample(k as f32 * STEP);
        steps[c.index] += 1;
        assert!((0.0..1.0).contains(&c.rest));
    }
    for (i, &w) in weights.iter().enumerate() {
        assert_eq!(table.pmf(i), steps[i] as f32 * STEP);
        assert_eq!(counted(w) > 0.0, steps[i] > 0);
        assert!((f64::from(table.pmf(i)) - counted(w) / 8.5).abs() < 3e-7);
    }
    assert_eq!(table.pmf(10), 0.0);
}

#[test]
fn what_is_left_is_even_again() {
    let table = Table1::new(&[1.0, 2.0, 5.0]).unwrap();
    let n = 1 << 16;
    let mut sums = [0.0; 3];
    for k in 0..n {
        let u = (k as f32 + 0.5) / n as f32;
        let c = table.sample(u);
        sums[c.index] += f64::from(c.rest);
        assert!((table.invert(c.index, c.rest) - u).abs() < 2.0 * STEP);
    }
    for (i, sum) in sums.iter().enumerate() {
        let mean = sum / (f64::from(n) * f64::from(table.pmf(i)));
        assert!((mean - 0.5).abs() < 1e-3, "{mean}");
    }
}

#[test]
fn nothing_to_choose_is_no_table() {
    assert_eq!(Table1::new(&[]), None);
    assert_eq!(Table1::new(&[0.0, -1.0, f32::NAN, f32::INFINITY]), None);
    assert_eq!(Table2::new(0, 0, &[]), None);
    assert_eq!(Table2::new(2, 2, &[1.0; 3]), None);
    assert_eq!(Table2::new(usize::MAX, 2, &[1.0; 3]), None);
    assert_eq!(Table2::new(2, 2, &[0.0; 4]), None);
    assert!(Table1::new(&[1.0; 1]).is_some_and(|t| t.sample(0.7).pmf == 1.0 && !t.is_empty()));
}

#[test]
fn long_lists_keep_every_weight() {
    let n = 100_003;
    let weights: Vec<f32> = (0..n).map(|i| if i == 777 { 1e20 } else { 1.0 / (1.0 + i as f32) }).collect();
    let table = Table1::new(&weights).unwrap();
    assert_eq!(table.len(), n);
    let sum: f64 = (0..n).map(|i| f64::from(table.pmf(i))).sum();
    assert_eq!(sum, 1.0);
    for i in 0..n {
        assert!(table.pmf(i) >= STEP);
        assert_eq!(table.sample(table.invert(i, 0.0)).index, i);
    }
    // Numbers beyond their range choose an end instead of reading past it.
    assert_eq!(table.sample(1.5).index, n - 1);
    assert_eq!(table.sample(f32::NAN).index, 0);
}

#[test]
fn grids_draw_by_their_density() {
    let (w, h) = (37, 19);
    let weights: Vec<f32> = (0..w * h)
        .map(|i| match (i % w, i / w) {
            (_, 4) | (3, _) => 0.0,
            (20, 10) => 1e6,
            (x, y) => 1e-35 * (1 + x * y) as f32,
        })
        .collect();
    let table = Table2::new(w, h, &weights).unwrap();
    assert_eq!(table.size(), [w, h]);
    let mut integral = 0.0;
    for y in 0..h {
        for x in 0..w {
            let pdf = table.texel_pdf([x, y]);
            assert_eq!(pdf > 0.0, weights[y * w + x] > 0.0);
            let centre = [(x as f32 + 0.5) / w as f32, (y as f32 + 0.5) / h as f32];
            assert_eq!(table.pdf(centre), pdf);
            integral += f64::from(pdf) / (w * h) as f64;
            assert_eq!(table.invert(centre).is_some(), pdf > 0.0);
        }
    }
    assert!((integral - 1.0).abs() < 1e-6);
    for k in 0..200_000_u32 {
        let u = [0.754_877_7, 0.569_840_3].map(|a: f64| ((f64::from(k) * a).fract() as f32).min(BELOW_ONE));
        let p = table.sample(u);
        assert!(p.pdf > 0.0 && p.pdf == table.pdf(p.uv) && p.pdf == table.texel_pdf(p.texel));
        let back = table.invert(p.uv).unwrap();
        let cell = [20.5 / w as f32, 10.5 / h as f32];
        let tolerance = if p.pdf == table.pdf(cell) { 1e-4 } else { 1.0 };
        assert!((back[0] - u[0]).abs() < tolerance && (back[1] - u[1]).abs() < tolerance);
    }
    assert_eq!(table.pdf([1.0, 0.5]), 0.0);
    assert_eq!(table.pdf([f32::NAN, 0.5]), 0.0);
}

#[test]
fn even_grids_give_points_back() {
    let table = Table2::new(16, 8, &[2.0; 128]).unwrap();
    for u in [[0.0, 0.0], [0.3, 0.7], [BELOW_ONE, BELOW_ONE]] {
        let p = table.sample(u);
        assert!((p.uv[0] - u[0]).abs() < 1e-6 && (p.uv[1] - u[1]).abs() < 1e-6);
        assert!((p.pdf - 1.0).abs() < 1e-5);
    }
}
