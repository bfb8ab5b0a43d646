//! Shapes that are tested many at a time give the bits that they give one by one.

use crate::{
    Analytic, Hit, Isa, Patch, ShapeHit,
    analytic::{
        block::{Blocks, Member},
        octet::{Octets, RAYS},
    },
    kernel::{Chosen, Kernel},
    lanes::ROW,
    local::LocalRay,
    slab,
};
use straal_math::{Affine, Bounds, DVec3, Ray, Vec3};

/// Numbers of all sizes, with zeros and repetitions.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    fn number(&mut self) -> f32 {
        let x = self.below(65536) as f32 / 32768.0 - 1.0;
        match self.below(8) {
            0 => 0.0,
            1 => (x * 4.0).floor() * 0.25,
            2 => x * 30.0,
            3 => x * 1e-6,
            _ => x,
        }
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }

    fn double(&mut self) -> DVec3 {
        self.vector().as_dvec3()
    }

    fn patch(&mut self) -> Patch {
        Patch { origin: self.double(), normal: self.double(), dual: [self.double(), self.double()] }
    }

    fn map(&mut self) -> Affine {
        Affine { rows: std::array::from_fn(|_| std::array::from_fn(|_| f64::from(self.number()))) }
    }

    /// A shape, whose numbers need not make sense, with a box that need not hold it.
    fn member(&mut self, object: u32) -> Member {
        let shape = match self.below(6) {
            0 => Analytic::sphere(self.double(), f64::from(self.number())),
            1 => Analytic::plane(self.double(), self.double()),
            2 => Analytic::parallelogram(&self.patch()),
            3 => Analytic::disc(&self.patch()),
            4 => Analytic::ellipsoid(&self.map()),
            _ => Analytic::cylinder(&self.map()),
        };
        let (a, b) = (self.vector() * 2.0, self.vector() * 2.0);
        let bounds = match self.below(4) {
            0 => Bounds { min: Vec3::splat(f32::NEG_INFINITY), max: Vec3::splat(f32::INFINITY) },
            _ => Bounds { min: a.min(b), max: a.max(b) },
        };
        let mask = [u32::MAX, u32::MAX, 1, 2][self.below(4) as usize];
        Member { object, mask, bounds, shape }
    }

    fn ray(&mut self) -> Ray {
        let mut ray = Ray::new(self.vector(), self.vector());
        ray.t_min =
            [0.0, 0.0, -1.0, 0.25, f32::NAN][if self.below(9) == 0 { 4 } else { self.below(4) as usize }];
        ray.t_max = [f32::INFINITY, 1.0, 3.0][self.below(3) as usize];
        ray.mask = [u32::MAX, u32::MAX, u32::MAX, 2][self.below(4) as usize];
        if self.below(20) == 0 {
            ray.d = Vec3::ZERO;
        }
        if self.below(20) == 0 {
            ray.o.y = f32::INFINITY;
        }
        ray
    }
}

/// Where a ray hits a member in its box, up to a limit.
fn alone(m: &Member, r: &LocalRay, limit: f32) -> Option<ShapeHit> {
    let hit = m.shape.intersect(&r.ray)?;
    let entry = slab::entry(&m.bounds, r)?;
    let t = if entry > hit.t { entry } else { hit.t };
    (t <= limit).then_some(ShapeHit { t, ..hit })
}

fn bits(hit: &ShapeHit) -> [u32; 3] {
    [hit.t, hit.u, hit.v].map(f32::to_bits)
}

fn blocks_are_shapes_one_by_one<K: Kernel>(kernel: K) {
    let mut r = Random(3);
    let mut hits = 0;
    for _ in 0..300 {
        let members: Vec<Member> = (0..1 + r.below(40) as u32).map(|i| r.member(i)).collect();
        // Of one kind each, or mixed.
        let mut blocks = Blocks::of(&members);
        if r.below(2) == 0 {
            blocks = Blocks::EMPTY;
            members.chunks(ROW).for_each(|some| blocks.push(some));
        }
        for _ in 0..20 {
            let limit = [f32::MAX, 2.0, 0.5][r.below(3) as usize];
            let Some(ray) = LocalRay::new(&r.ray()) else { continue };
            let limit = if limit < ray.ray.t_max { limit } else { ray.ray.t_max };
            let mut seen = 0;
            for block in blocks.iter() {
                let found = kernel.meet(&ray, block, limit);
                for lane in 0..ROW {
                    let is_hit = found.hit >> lane & 1 == 1;
                    let Some(&object) = block.head.objects[..block.head.count as usize].get(lane) else {
                        assert!(!is_hit);
                        continue;
                    };
                    seen += 1;
                    let want = alone(&members[object as usize], &ray, limit);
                    assert_eq!(is_hit, want.is_some(), "{:?} {ray:?}", members[object as usize]);
                    if let Some(want) = want {
                        let [t, u, v] = [found.t[lane], found.u[lane], found.v[lane]].map(|x| x as f32);
                        assert_eq!(bits(&ShapeHit { t, u, v }), bits(&want));
                        hits += 1;
                    }
                }
            }
            assert_eq!(seen, members.len());
        }
    }
    assert!(hits > 1000, "{hits} hits: the test says little");
}

fn octets_are_rays_one_by_one<K: Kernel>(kernel: K) {
    let mut r = Random(5);
    let mut hits = 0;
    for _ in 0..200 {
        let mut members: Vec<Member> = (0..1 + r.below(20) as u32).map(|i| r.member(i)).collect();
        // Some twice, for ties.
        let again = members[0];
        members.push(Member { object: members.len() as u32, ..again });
        let blocks = Blocks::of(&members);
        let rays: Vec<Ray> = (0..1 + r.below(RAYS as u64)).map(|_| r.ray()).collect();
        let (mut firsts, mut any) = (Octets::EMPTY, Octets::EMPTY);
        kernel.octets::<false>(&blocks, &rays, &mut firsts);
        kernel.octets::<true>(&blocks, &rays, &mut any);
        for (i, ray) in rays.iter().enumerate() {
            let mut want = Hit::MISS;
            if let Some(local) = LocalRay::new(ray) {
                for m in members.iter().filter(|m| m.mask & ray.mask != 0) {
                    if let Some(ShapeHit { t, u, v }) = alone(m, &local, f32::MAX) {
                        want.offer(&Hit { t, u, v, geometry: 0, primitive: m.object, ..Hit::MISS });
                    }
                }
            }
            let (first, lane) = (&firsts.firsts[i / ROW], i % ROW);
            assert_eq!(first.object(lane), want.is_hit().then_some(want.primitive), "{ray:?}");
            assert_eq!(any.firsts[i / ROW].object(lane).is_some(), want.is_hit());
            if want.is_hit() {
                let got = [first.t[lane], first.u[lane], first.v[lane]].map(|x| (x as f32).to_bits());
                assert_eq!(got, [want.t, want.u, want.v].map(f32::to_bits));
                hits += 1;
            }
        }
    }
    assert!(hits > 1000, "{hits} hits: the test says little");
}

#[test]
fn many_at_a_time_are_one_by_one() {
    fn all<K: Kernel>(kernel: K) {
        blocks_are_shapes_one_by_one(kernel);
        octets_are_rays_one_by_one(kernel);
    }
    for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
        match Chosen::new(isa) {
            Chosen::Scalar(k) => all(k),
            #[cfg(target_arch = "aarch64")]
            Chosen::Neon(k) => all(k),
            #[cfg(target_arch = "x86_64")]
            Chosen::Sse(k) => all(k),
            #[cfg(target_arch = "x86_64")]
            Chosen::Avx2(k) => all(k),
            #[cfg(target_arch = "x86_64")]
            Chosen::Avx512(k) => all(k),
        }
    }
}
