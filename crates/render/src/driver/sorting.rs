//! Paths sorted into queues.

use crate::integrator::Kind;
use crate::lanes::Rgb;
use crate::material::BsdfKind;
use crate::texture::ShadingPoint;
use crate::world::World;
use straal_accel::Hit;

/// What must be computed where a ray meets a material.
fn kind_of(world: &World, material: u32) -> Kind {
    if world.materials.wants(material).point || world.materials.is_made_of_others(material) {
        return Kind::Varying;
    }
    let reading = world.reading(Rgb::default());
    match world.materials.bsdf(material, &ShadingPoint::NOWHERE, &reading).kind() {
        // What is black in red, green and blue may not be at every wavelength.
        BsdfKind::Black if !world.tables.is_spectral() => Kind::Dark,
        BsdfKind::Black => Kind::Varying,
        kind => Kind::Scattering(kind),
    }
}

/// Sorts the paths of a turn by what must be computed where their rays arrived, and within that by material, so that like is
/// shaded beside like.
pub(super) struct Sorting {
    /// By material: its place when materials are sorted by kind.
    rank: Vec<u32>,
    /// By rank, and for what missed, which comes last.
    kinds: Vec<Kind>,
    /// Where each rank's paths begin in `order`, then where they end.
    ends: Vec<u32>,
    /// Each path's rank.
    keys: Vec<u32>,
    order: Vec<u32>,
}

impl Sorting {
    pub fn new(world: &World) -> Self {
        let count = world.materials.len();
        let kind = |m: &u32| kind_of(world, *m);
        let mut by_kind: Vec<u32> = (0..count as u32).collect();
        by_kind.sort_by_key(kind);
        let mut rank = vec![0; count];
        for (place, &m) in by_kind.iter().enumerate() {
            rank[m as usize] = place as u32;
        }
        let kinds = by_kind.iter().map(kind).chain([Kind::Missed]).collect();
        Self { rank, kinds, ends: Vec::new(), keys: Vec::new(), order: Vec::new() }
    }

    /// Sorts paths by what their rays hit (a counting sort; those of one material stay in order).
    pub fn sort(&mut self, world: &World, hits: &[Hit]) {
        let missed = self.rank.len() as u32;
        self.ends.clear();
        self.ends.resize(self.kinds.len() + 1, 0);
        self.keys.clear();
        for hit in hits {
            let rank = match world.material_hit(hit) {
                // A surface whose material isn't there is black; it may shine.
                Some(material) => self.rank.get(material as usize).copied().unwrap_or(0),
                None => missed,
            };
            self.keys.push(rank);
            self.ends[rank as usize + 1] += 1;
        }
        for rank in 0..self.kinds.len() {
            self.ends[rank + 1] += self.ends[rank];
        }
        self.order.resize(hits.len(), 0);
        for (i, &rank) in self.keys.iter().enumerate() {
            let slot = &mut self.ends[rank as usize];
            self.order[*slot as usize] = i as u32;
            *slot += 1;
        }
    }

    /// The queues that aren't empty.
    pub fn queues(&self) -> impl Iterator<Item = (Kind, &[u32])> {
        let mut rank = 0;
        std::iter::from_fn(move || {
            while rank < self.kinds.len() {
                let kind = self.kinds[rank];
                let start = if rank == 0 { 0 } else { self.ends[rank - 1] };
                while rank < self.kinds.len() && self.kinds[rank] == kind {
                    rank += 1;
                }
                let end = self.ends[rank - 1];
                if end > start {
                    return Some((kind, &self.order[start as usize..end as usize]));
                }
            }
            None
        })
    }
}
