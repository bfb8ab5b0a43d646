//! Each vector kernel gives the scalar kernel's bits, but where a box is left just when it is entered: kernels round the exits
//! of nodes apart, which `local::NODE_EXIT` allows for.

use super::*;
use crate::{
    local::NODE_EXIT,
    node::{block::Outline, bundle::PACKET},
    triangle,
};
use straal_math::{Vec3, ops};

/// Numbers of all sizes, with zeros and repetitions.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn number(&mut self) -> f32 {
        let x = (self.bits() % 65536) as f32 / 32768.0 - 1.0;
        match self.bits() % 8 {
            0 => 0.0,
            1 => (x * 4.0).floor() * 0.25,
            2 => x * 1e4,
            3 => x * 1e-6,
            _ => x,
        }
    }

    fn ray(&mut self) -> Option<LocalRay> {
        let o = Vec3::new(self.number(), self.number(), self.number());
        let mut ray = Ray::new(o, Vec3::new(self.number(), self.number(), self.number()));
        ray.t_min = [0.0, 0.0, -1.0, 0.25][self.bits() as usize % 4];
        LocalRay::new(&ray)
    }
}

/// What a kernel's steps leave on the stack, from the top: in the order of the octant; nearest first, with the others
/// sorted since their order is the kernel's own; and any, likewise sorted.
fn steps<K: Kernel>(kernel: K, ray: &LocalRay, node: &Node, limit: f32) -> [Vec<Child>; 3] {
    fn rest<const N: usize>(mut stack: Descent<N>) -> Vec<Child> {
        std::iter::from_fn(|| Some(stack.pop()).filter(|c| *c != Child::DONE)).collect()
    }
    let sorted = |mut v: Vec<Child>, from: usize| {
        v[from..].sort_by_key(|c| c.index());
        v
    };
    let mut stack = Descent::<24>::new();
    let mut octant: Vec<Child> = kernel.step(ray, node, limit, &mut stack).into_iter().collect();
    octant.extend(rest(stack));
    let mut stack = Descent::<24>::new();
    let mut nearest: Vec<Child> = kernel.nearest(ray, node, limit, &mut stack).into_iter().collect();
    nearest.extend(rest(stack));
    let mut stack = Descent::<24>::new();
    let mut any: Vec<Child> = kernel.any(ray, node, limit, &mut stack).into_iter().collect();
    any.extend(rest(stack));
    let mut stack = Descent::<24>::new();
    let mut step_any: Vec<Child> = kernel.step_any(ray, node, limit, &mut stack).into_iter().collect();
    step_any.extend(rest(stack));
    let step_any = sorted(step_any, 0);
    let any = sorted(any, 0);
    assert!(any == step_any || any.is_empty() && step_any == [Child::DONE]);
    let from = nearest.len().min(1);
    [octant, sorted(nearest, from), any]
}

/// A step that finds no room for eight more does nothing.
fn leaves_a_full_stack<K: Kernel>(kernel: K, ray: &LocalRay, node: &Node, limit: f32) {
    let mut stack = Descent::<24>::new();
    (0..16).for_each(|i| stack.push(i, Child::node(i)));
    assert_eq!(kernel.step(ray, node, limit, &mut stack), None);
    assert_eq!(kernel.step_any(ray, node, limit, &mut stack), None);
    (0..16).rev().for_each(|i| assert_eq!(stack.pop(), Child::node(i)));
    assert_eq!(stack.pop(), Child::DONE);
}

/// Whether a rounding of exits decides which boxes are entered.
fn is_close(r: &LocalRay, node: &Node) -> bool {
    (0..8).any(|lane| {
        let crossed = |axis: usize, far: u8| {
            let side = usize::from((r.neg[axis] ^ far) & 1);
            (node.planes[2 * axis + side][lane] - r.ray.o[axis]) * r.inv[axis]
        };
        let enter = (0..3).map(|axis| crossed(axis, 0)).fold(r.ray.t_min, ops::max);
        let exit = (0..3).map(|axis| crossed(axis, 255)).fold(f32::INFINITY, ops::min) * NODE_EXIT;
        exit.is_finite() && exit != 0.0 && (enter - exit).abs() <= 4.0 * f32::EPSILON * exit.abs()
    })
}

/// Rays that might be a packet.
fn bundle(r: &mut Random) -> Bundle {
    let mut out = Bundle::EMPTY;
    let mut some = LocalRay::IDLE;
    let signs = Vec3::new(r.number(), r.number(), r.number());
    let mut ray = 0;
    while ray < PACKET {
        let d = [0, 1, 2].map(|axis| r.number().abs().copysign(signs[axis]));
        let mut from = Ray::new(Vec3::new(r.number(), r.number(), r.number()), Vec3::from_array(d));
        from.t_min = r.number().abs();
        if let Some(local) = LocalRay::new(&from) {
            out.set(ray, &local, [f32::MAX, -1.0, 2.0][r.bits() as usize % 3]);
            some = local;
            ray += 1;
        }
    }
    out.bound(&some);
    out
}

/// Triangles of up to twelve vertices, which some share; not all lanes are used.
fn block(r: &mut Random) -> Block {
    let count = 1 + r.bits() as u32 % 8;
    let vertices: [Vec3; 12] = std::array::from_fn(|_| Vec3::new(r.number(), r.number(), r.number()));
    let corners: [[usize; 3]; 8] = std::array::from_fn(|_| std::array::from_fn(|_| r.bits() as usize % 12));
    let vertices = |id: u32| corners[id as usize].map(|corner| vertices[corner]);
    Outline::of(0..count, vertices).map_or_else(|| unreachable!("twelve vertices"), |(_, block)| block)
}

/// Returns how many hits were told to lie in their own boxes for certain.
fn same_as_scalar<K: Kernel>(kernel: K) -> u32 {
    let mut r = Random(11);
    let (mut entered, mut hit, mut zero, mut boxes, mut boxed, mut close) = (0, 0, 0, 0, 0, 0);
    let mut packet = bundle(&mut r);
    let mut entering = 0;
    for turn in 0..20_000 {
        if turn % 20 == 0 {
            packet = bundle(&mut r);
        }
        let mut planes = [[0.0; 8]; 6];
        for axis in planes.chunks_mut(2) {
            let (low, high) = axis.split_at_mut(1);
            for (lane, (low, high)) in low[0].iter_mut().zip(&mut high[0]).enumerate() {
                let (a, b) = (r.number(), r.number());
                // Some slots are empty.
                (*low, *high) = match lane >= 6 && r.bits().is_multiple_of(2) {
                    true => (f32::INFINITY, f32::NEG_INFINITY),
                    false => (if a < b { a } else { b }, if a < b { b } else { a }),
                };
            }
        }
        let node =
            Node { children: std::array::from_fn(|i| Child::node(i as u32)), ..Node::of_planes(planes) };
        let block = block(&mut r);
        let Some(ray) = r.ray() else { continue };
        let limit = [f32::MAX, 1.0, 3.0][r.bits() as usize % 3];

        let bits = |(mask, entries): (u32, [f32; 8])| (mask, entries.map(f32::to_bits));
        assert_eq!(bits(kernel.entries(&packet, &node, limit)), bits(packet.entries(&node, limit)));
        let slot = turn % 8;
        assert_eq!(kernel.entering(&packet, &node, slot), packet.entering(&node, slot));
        entering += packet.entering(&node, slot).count_ones();

        let (want, got) = (scalar::Scalar.node(&ray, &node, limit), kernel.node(&ray, &node, limit));
        let want_children = want.mask;
        assert_eq!(got.mask, want.mask);
        let (want_lanes, got_lanes) =
            (scalar::Scalar.block(&ray, &block, limit), kernel.block(&ray, &block, limit));
        assert_eq!(got_lanes.hit, want_lanes.hit);
        assert_eq!(got_lanes.doubtful & want_lanes.doubtful, want_lanes.doubtful);
        // Lanes with a zero may be doubted as well although they are missed for certain.
        for lane in (0..8).filter(|lane| (got_lanes.doubtful & !want_lanes.doubtful) >> lane & 1 == 1) {
            let edges = triangle::edges(&block.vertices(lane), &ray);
            assert!(edges.e.contains(&0.0) && !edges.inside());
        }
        assert_eq!((got_lanes.hit | got_lanes.doubtful) & !kernel.inside(&ray, &block), 0);
        for lane in 0..8 {
            if want.mask >> lane & 1 == 1 {
                assert_eq!(got.keys[lane], want.keys[lane]);
            }
            if want_lanes.hit >> lane & 1 == 1 {
                let bits = |l: &Lanes| [l.t, l.det, l.e1, l.e2].map(|x| x[lane].to_bits());
                assert_eq!(bits(&got_lanes), bits(&want_lanes));
            }
        }
        let mut prepared = LocalRay::IDLE;
        assert!(kernel.prepare(&ray.ray, &mut prepared));
        assert_eq!(prepared, ray);
        for lane in 0..block.count() as usize {
            let (got, want) =
                (kernel.own_box(&ray, &block, lane), scalar::Scalar.own_box(&ray, &block, lane));
            assert_eq!(got, want);
            boxes += u32::from(want.is_some());
            if (got_lanes.hit & got_lanes.boxed) >> lane & 1 == 1 {
                // A box told for certain is crossed, and entered no later than the hit.
                assert!(want.is_some_and(|entry| entry <= got_lanes.t[lane]));
                boxed += 1;
            }
        }
        leaves_a_full_stack(kernel, &ray, &node, limit);
        if is_close(&ray, &node) {
            close += 1;
        } else {
            let want = steps(scalar::Scalar, &ray, &node, limit);
            assert_eq!(steps(kernel, &ray, &node, limit), want);
        }
        entered += want_children.count_ones();
        hit += want_lanes.hit.count_ones();
        zero += want_lanes.doubtful.count_ones();
    }
    assert!(
        entered > 2000 && entering > 2000 && hit > 500 && zero > 100 && boxes > 500 && close < 200,
        "{entered} {entering} {hit} {zero} {boxes}: too few, or {close}: too many"
    );
    boxed
}

#[test]
#[cfg(target_arch = "x86_64")]
fn sse_is_scalar() {
    if let Some(kernel) = sse::Sse::new() {
        assert!(same_as_scalar(kernel) > 100);
    }
}

#[test]
#[cfg(target_arch = "x86_64")]
fn avx2_is_scalar() {
    if let Some(kernel) = avx2::Avx2::new() {
        assert!(same_as_scalar(kernel) > 100);
    }
}

#[test]
#[cfg(target_arch = "x86_64")]
fn avx512_is_scalar() {
    if let Some(kernel) = avx512::Avx512::new() {
        assert!(same_as_scalar(kernel) > 100);
    }
}

#[test]
#[cfg(target_arch = "aarch64")]
fn neon_is_scalar() {
    if let Some(kernel) = neon::Neon::new() {
        assert!(same_as_scalar(kernel) > 100);
    }
}
