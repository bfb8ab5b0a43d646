//! Paths sorted into queues.

use crate::integrator::Kind;
use crate::lanes::Rgb;
use crate::material::BsdfKind;
use crate::surface::Alike;
use crate::texture::ShadingPoint;
use crate::world::{GeometryRecord, INHERIT, World};
use std::collections::BTreeSet;
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

/// In which order what rays meet is worked on: by what must be computed, then by material and by what
/// surfaces are alike in, so that like is shaded beside like.
pub(super) struct Ranks {
    /// By geometry, and last for what missed; [`INHERIT`] where instances give the material.
    of_geometry: Vec<u32>,
    /// By material, of what has it from an instance.
    inherited: Vec<u32>,
    /// By rank, and for what missed, which comes last.
    kinds: Vec<Kind>,
}

impl Ranks {
    pub fn new(world: &World) -> Self {
        let materials = 0..world.materials.len() as u32;
        let kinds: Vec<Kind> = materials.clone().map(|m| kind_of(world, m)).collect();
        // A surface whose material isn't there is black; it may shine.
        let key = |material: u32, alike| {
            let kind = kinds.get(material as usize).copied().unwrap_or(Kind::Varying);
            (kind, material, alike)
        };
        let own = |geometry: &GeometryRecord| {
            (geometry.material != INHERIT).then(|| key(geometry.material, geometry.alike))
        };
        let inherited = |material| key(material, Alike::Apart);
        let all: BTreeSet<_> =
            world.geometries.iter().filter_map(own).chain(materials.clone().map(inherited)).collect();
        let all: Vec<_> = all.into_iter().collect();
        let rank = |key| all.binary_search(&key).map_or(0, |rank| rank as u32);
        Self {
            of_geometry: world
                .geometries
                .iter()
                .map(|geometry| own(geometry).map_or(INHERIT, rank))
                .chain([all.len() as u32])
                .collect(),
            inherited: materials.map(|material| rank(inherited(material))).collect(),
            kinds: all.iter().map(|&(kind, ..)| kind).chain([Kind::Missed]).collect(),
        }
    }

    /// Whether a ray hit or missed is as good as chance: that isn't branched on.
    #[inline]
    fn of(&self, world: &World, hit: &Hit) -> u32 {
        let missed = self.of_geometry.len() - 1;
        let geometry = hit.geometry as usize;
        match self.of_geometry[if geometry < missed { geometry } else { missed }] {
            INHERIT => self.inherited.get(world.material_of(hit) as usize).copied().unwrap_or(0),
            rank => rank,
        }
    }
}

/// Into so many parts paths are cut that are counted and put in order side by side: where there are few ranks, each count would wait for that of the path before.
const PARTS: usize = 4;

/// Where there are more ranks, neighbours seldom have the same.
const FEW: usize = 64;

/// Takes keys part by part, one of each part after the other; the last part has what is beyond so many for each. Gives a key's index, and the place of its rank and part.
#[inline(always)]
fn each_in_parts(keys: &[u32], length: usize, parts: usize, mut take: impl FnMut(usize, usize)) {
    if parts == PARTS {
        for k in 0..length {
            for part in 0..PARTS {
                let i = part * length + k;
                take(i, keys[i] as usize * PARTS + part);
            }
        }
    }
    for (i, &key) in keys.iter().enumerate().skip(length * parts) {
        take(i, key as usize * parts + parts - 1);
    }
}

/// Sorts the paths of a turn.
pub(super) struct Sorting<'a> {
    ranks: &'a Ranks,
    /// Into how many parts paths are cut.
    parts: usize,
    /// Where the paths of each rank, and of each part in it, begin in `order`, then where they end.
    ends: Vec<u32>,
    /// Each path's rank.
    keys: Vec<u32>,
    order: Vec<u32>,
}

impl<'a> Sorting<'a> {
    pub fn new(ranks: &'a Ranks) -> Self {
        Self { ranks, parts: 1, ends: Vec::new(), keys: Vec::new(), order: Vec::new() }
    }

    /// Sorts paths by what their rays hit (a counting sort; those of one material stay in order).
    pub fn sort(&mut self, world: &World, hits: &[Hit]) {
        self.keys.clear();
        self.keys.extend(hits.iter().map(|hit| self.ranks.of(world, hit)));
        self.sort_keys();
    }

    /// The same by the ranks themselves.
    fn sort_keys(&mut self) {
        let (ranks, count) = (self.ranks.kinds.len(), self.keys.len());
        self.parts = if ranks <= FEW { PARTS } else { 1 };
        self.ends.clear();
        self.ends.resize(ranks * self.parts + 1, 0);
        self.order.resize(count, 0);
        let Self { ends, order, keys, parts, .. } = self;
        let (parts, length) = (*parts, if *parts > 1 { count / *parts } else { 0 });
        each_in_parts(keys, length, parts, |_, slot| ends[slot + 1] += 1);
        for slot in 0..ranks * parts {
            ends[slot + 1] += ends[slot];
        }
        each_in_parts(keys, length, parts, |i, slot| {
            let to = &mut ends[slot];
            order[*to as usize] = i as u32;
            *to += 1;
        });
    }

    /// The queues that aren't empty.
    pub fn queues(&self) -> impl Iterator<Item = (Kind, &[u32])> {
        let kinds = &self.ranks.kinds;
        let mut rank = 0;
        std::iter::from_fn(move || {
            while rank < kinds.len() {
                let kind = kinds[rank];
                let start = if rank == 0 { 0 } else { self.ends[rank * self.parts - 1] };
                while rank < kinds.len() && kinds[rank] == kind {
                    rank += 1;
                }
                let end = self.ends[rank * self.parts - 1];
                if end > start {
                    return Some((kind, &self.order[start as usize..end as usize]));
                }
            }
            None
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{FEW, Ranks, Sorting};
    use crate::integrator::Kind;
    use crate::material::BsdfKind;

    #[test]
    fn paths_stay_in_order_within_their_rank() {
        for ranks in [1, 3, FEW, FEW + 1] {
            // Every second rank is of another kind than the one before.
            let kind =
                |rank: usize| if rank % 4 < 2 { Kind::Dark } else { Kind::Scattering(BsdfKind::Diffuse) };
            let kinds = (0..ranks).map(kind).collect();
            let of = Ranks { of_geometry: Vec::new(), inherited: Vec::new(), kinds };
            let mut sorting = Sorting::new(&of);
            for count in [0, 1, 3, 4, 7, 1000] {
                sorting.keys = (0..count).map(|i: u32| i.wrapping_mul(2_654_435_761) >> 7).collect();
                sorting.keys.iter_mut().for_each(|key| *key %= ranks as u32);
                sorting.sort_keys();
                let mut wanted: Vec<u32> = (0..count).collect();
                wanted.sort_by_key(|&i| sorting.keys[i as usize]);
                assert_eq!(sorting.order, wanted, "{ranks} ranks, {count} paths");
                let queues: Vec<_> = sorting.queues().collect();
                assert_eq!(
                    queues.iter().flat_map(|(_, order)| order.iter().copied()).collect::<Vec<_>>(),
                    wanted
                );
                for (kind_of_queue, order) in queues {
                    assert!(order.iter().all(|&i| kind(sorting.keys[i as usize] as usize) == kind_of_queue));
                }
            }
        }
    }
}
