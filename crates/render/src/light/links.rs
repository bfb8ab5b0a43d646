//! Light linking: lamps that light some things only, which light doesn't do by itself and those who light films do.
//!
//! What a lamp says is a matter of names, and each name that any lamp says is a bit. A surface has the bits of the names that it goes by: those of the nodes
//! that it stands in, and of the instances that show it. Surfaces of the same bits are a *class*, lit by the same lamps, and each class has a choice of light of its own: a lamp that
//! doesn't light it is never picked there, so that its probability is 0 for multiple importance sampling as well.

use super::{Emitter, LightTable, Within};
use crate::shape::Geometry;
use std::collections::BTreeSet;
use straal_accel::{Hit, Input};
use straal_scene::desc;

/// Whom a lamp lights: all but some things, or some only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Receivers {
    /// If any bit is set, things that have one of these.
    pub only: u64,
    /// Of these, things that have none of these.
    pub all_but: u64,
}

impl Receivers {
    fn has(self, bits: u64) -> bool {
        (self.only == 0 || self.only & bits != 0) && self.all_but & bits == 0
    }
}

/// Surfaces that are lit by the same lamps; [`ALL`] are lit by all.
pub(crate) type Class = u16;

/// The class of what every lamp lights: of a world without links, and of the camera.
pub(crate) const ALL: Class = 0;

/// The names that lamps say, a bit each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Names<'a>(Vec<&'a str>);

impl<'a> Names<'a> {
    /// Those of a scene.
    pub fn of(scene: &'a desc::Scene) -> Self {
        Self(scene.linked_names())
    }

    /// Whether there are any.
    pub fn matter(&self) -> bool {
        !self.0.is_empty()
    }

    /// The bits of names that something goes by.
    pub fn bits(&self, goes_by: impl Fn(&str) -> bool) -> u64 {
        (0..64).zip(&self.0).filter(|(_, name)| goes_by(name)).fold(0, |bits, (i, _)| bits | 1 << i)
    }

    /// Whom a lamp lights.
    pub fn receivers(&self, lamp: &desc::Lamp) -> Receivers {
        let bits = |said: &[straal_scene::value::Name]| self.bits(|name| said.iter().any(|n| **n == *name));
        Receivers { only: bits(&lamp.lights_only), all_but: bits(&lamp.lights_all_but) }
    }
}

/// What lights what.
#[derive(Clone, Debug, Default)]
pub(crate) struct Links {
    /// By emitter; empty in a world without links, as is the rest.
    lamps: Vec<Receivers>,
    /// By geometry of the search structure, and by instance.
    geometries: Vec<u64>,
    instances: Vec<u64>,
    /// The bits of each class from 1 on, rising.
    classes: Vec<u64>,
    /// Its choice of light.
    tables: Vec<LightTable>,
}

/// The bits of what stands in a world.
#[derive(Debug, Default)]
pub(crate) struct Linked {
    /// By geometry.
    pub geometries: Vec<u64>,
    /// By group, of its instances.
    pub instances: Vec<Vec<u64>>,
    /// All that a surface may have, rising.
    pub classes: Vec<u64>,
}

impl Linked {
    /// Finds out which bits a surface may have, whichever instances show it.
    pub fn find_classes(&mut self, input: &Input) {
        // Of what is around each group: known a level deeper with each round.
        let mut around = vec![BTreeSet::new(); input.groups.len()];
        if let Some(world) = around.first_mut() {
            world.insert(0_u64);
        }
        for _ in 0..=straal_scene::validate::DEEPEST {
            for ((outer, group), all) in input.groups.iter().enumerate().zip(&self.instances) {
                for (instance, bits) in group.instances.iter().zip(all) {
                    let found: Vec<u64> = around[outer].iter().map(|outside| outside | bits).collect();
                    around[instance.group as usize].extend(found);
                }
            }
        }
        let mut all = BTreeSet::new();
        for (group, outside) in input.groups.iter().zip(&around) {
            for &geometry in &group.geometries {
                let own = self.geometries.get(geometry as usize).copied().unwrap_or(0);
                all.extend(outside.iter().map(|outside| outside | own));
            }
        }
        self.classes = all.into_iter().take(usize::from(u16::MAX)).collect();
    }
}

impl Links {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let numbers = (self.geometries.len() + self.instances.len() + self.classes.len()) * size_of::<u64>();
        let lamps = self.lamps.len() * size_of::<Receivers>();
        numbers + lamps + self.tables.iter().map(LightTable::bytes).sum::<usize>()
    }

    /// Of lamps that say whom they light, by emitter, in a world.
    pub fn new(
        lamps: Vec<Receivers>,
        linked: Linked,
        (emitters, geometry, radius): (&[Emitter], &Geometry, f64),
        within: Within<'_>,
    ) -> Self {
        if lamps.iter().all(|lamp| *lamp == Receivers::default()) {
            return Self::default();
        }
        let table = |&bits: &u64| {
            LightTable::of((emitters, &|i| lamps[i as usize].has(bits)), geometry, radius, within)
        };
        let tables = linked.classes.iter().map(table).collect();
        let Linked { geometries, instances, classes } = linked;
        Self { lamps, geometries, instances: instances.concat(), classes, tables }
    }

    /// Whether there are any.
    #[inline(always)]
    pub fn matter(&self) -> bool {
        !self.lamps.is_empty()
    }

    /// The class of what a ray hit.
    pub fn class_of(&self, hit: &Hit) -> Class {
        if !self.matter() || !hit.is_hit() {
            return ALL;
        }
        let own = self.geometries.get(hit.geometry as usize).copied().unwrap_or(0);
        let all = hit.chain.iter().filter_map(|id| self.instances.get(id as usize));
        let bits = all.fold(own, |bits, more| bits | more);
        self.classes.binary_search(&bits).map_or(ALL, |place| place as Class + 1)
    }

    /// Whether a lamp lights a class.
    #[inline]
    pub fn light(&self, class: Class, emitter: u32) -> bool {
        class == ALL
            || self
                .lamps
                .get(emitter as usize)
                .is_none_or(|lamp| lamp.has(self.classes[usize::from(class) - 1]))
    }

    /// The choice of light of a class, if it isn't that of all.
    #[inline(always)]
    pub fn table(&self, class: Class) -> Option<&LightTable> {
        self.tables.get(usize::from(class.checked_sub(1)?))
    }
}
