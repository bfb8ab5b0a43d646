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

/// Sorts the paths of a turn.
pub(super) struct Sorting<'a> {
    ranks: &'a Ranks,
    /// Where each rank's paths begin in `order`, then where they end.
    ends: Vec<u32>,
    /// Each path's rank.
    keys: Vec<u32>,
    order: Vec<u32>,
}

impl<'a> Sorting<'a> {
    pub fn new(ranks: &'a Ranks) -> Self {
        Self { ranks, ends: Vec::new(), keys: Vec::new(), order: Vec::new() }
    }

    /// Sorts paths by what their rays hit (a counting sort; those of one material stay in order).
    pub fn sort(&mut self, world: &World, hits: &[Hit]) {
        let ranks = self.ranks.kinds.len();
        self.ends.clear();
        self.ends.resize(ranks + 1, 0);
        self.keys.clear();
        self.keys.extend(hits.iter().map(|hit| self.ranks.of(world, hit)));
        self.order.resize(hits.len(), 0);
        let (ends, order) = (&mut self.ends[..], &mut self.order[..]);
        for &rank in &self.keys {
            ends[rank as usize + 1] += 1;
        }
        for rank in 0..ranks {
            ends[rank + 1] += ends[rank];
        }
        for (i, &rank) in (0..).zip(&self.keys) {
            let slot = &mut ends[rank as usize];
            order[*slot as usize] = i;
            *slot += 1;
        }
    }

    /// The queues that aren't empty.
    pub fn queues(&self) -> impl Iterator<Item = (Kind, &[u32])> {
        let kinds = &self.ranks.kinds;
        let mut rank = 0;
        std::iter::from_fn(move || {
            while rank < kinds.len() {
                let kind = kinds[rank];
                let start = if rank == 0 { 0 } else { self.ends[rank - 1] };
                while rank < kinds.len() && kinds[rank] == kind {
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
