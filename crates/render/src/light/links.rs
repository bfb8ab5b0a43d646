//! Light linking: lamps that light some things only, or of which only some things cast shadows, which light doesn't do by itself and those who light films do.
//!
//! What a lamp says is a matter of names, and each name that any lamp says is a bit. A surface has the bits of the names that it goes by: those of the nodes
//! that it stands in, and of the instances that show it. Surfaces of the same bits are a *class*, lit by the same lamps, and each class has a choice of light of its own: a lamp that
//! doesn't light it is never picked there, so that its probability is 0 for multiple importance sampling as well.
//!
//! What casts no shadow of a lamp is passed by rays towards that lamp. No direction of a BSDF can do that, which ends at what it meets first. So each ray towards such a lamp tells what passes of the
//! lamp's light and what would past everything: of the second BSDFs find their share by multiple importance sampling, and the rest is left to points on the lamp. Mirrors and glass show the lamp where nothing is in the way.

use super::{Emitter, LightTable, Within};
use crate::shape::Geometry;
use std::collections::BTreeSet;
use straal_accel::{Hit, Input};
use straal_math::Ray;
use straal_scene::desc;

/// Which things: all but some, or some only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Which {
    /// If any bit is set, things that have one of these.
    pub only: u64,
    /// Of these, things that have none of these.
    pub all_but: u64,
}

impl Which {
    fn has(self, bits: u64) -> bool {
        (self.only == 0 || self.only & bits != 0) && self.all_but & bits == 0
    }
}

/// Surfaces that are lit by the same lamps; [`ALL`] are lit by all.
pub(crate) type Class = u16;

/// The class of what every lamp lights: of a world without links, and of the camera.
pub(crate) const ALL: Class = 0;

/// What a lamp says of other things.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Said {
    /// Whom it lights.
    pub receivers: Which,
    /// Who casts shadows of it.
    pub casters: Which,
}

/// The mask of a ray by all of whose lamp's light everything casts shadows, and of rays towards nothing in particular.
const CAST_BY_ALL: u32 = u32::MAX;

/// A bit that masks of other lamps have, beside the lamp's number. All surfaces have it, those that the camera doesn't see as well, so that the rest is free.
const LAMP: u32 = 1 << 31;

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

    /// What a lamp says of those.
    pub fn said(&self, lamp: &desc::Lamp) -> Said {
        let bits = |said: &[straal_scene::value::Name]| self.bits(|name| said.iter().any(|n| **n == *name));
        Said {
            receivers: Which { only: bits(&lamp.lights_only), all_but: bits(&lamp.lights_all_but) },
            casters: Which { only: bits(&lamp.shadows_only), all_but: bits(&lamp.shadows_all_but) },
        }
    }
}

/// What lights what.
#[derive(Clone, Debug, Default)]
pub(crate) struct Links {
    /// Whom each emitter lights; empty where all light all.
    lamps: Vec<Which>,
    /// Who casts shadows of each emitter; empty where everything does of all.
    casters: Vec<Which>,
    /// By which rays towards an emitter know it, see [`LAMP`]; as many.
    masks: Vec<u32>,
    /// By geometry of the search structure, and by instance.
    geometries: Vec<u64>,
    instances: Vec<u64>,
    /// The bits of each class from 1 on, rising.
    classes: Vec<u64>,
    /// Its choice of light; none where all lamps light all.
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
        let lamps = (self.lamps.len() + self.casters.len()) * size_of::<Which>() + size_of_val(&*self.masks);
        numbers + lamps + self.tables.iter().map(LightTable::bytes).sum::<usize>()
    }

    /// Of what lamps say, by emitter, in a world.
    pub fn new(
        said: &[Said],
        linked: Linked,
        (emitters, geometry, radius): (&[Emitter], &Geometry, f64),
        within: Within<'_>,
    ) -> Self {
        // Light of a surface of which no points can be drawn is found by the BSDF's rays alone.
        let casters = |(said, emitter): (&Said, &Emitter)| match emitter {
            Emitter::Area(lamp) if !lamp.has_size(geometry) => Which::default(),
            _ => said.casters,
        };
        let lamps = { said.iter().map(|said| said.receivers) }.collect();
        let casters: Vec<Which> = said.iter().zip(emitters).map(casters).collect();
        let [lamps, casters] = [lamps, casters].map(|all: Vec<Which>| {
            if all.iter().all(|which| *which == Which::default()) { Vec::new() } else { all }
        });
        if lamps.is_empty() && casters.is_empty() {
            return Self::default();
        }
        let mask = |(i, which): (u32, &Which)| {
            // A world has fewer emitters than that.
            if *which == Which::default() || i >= LAMP - 1 { CAST_BY_ALL } else { LAMP | i }
        };
        let masks = (0..).zip(&casters).map(mask).collect();
        let Linked { geometries, instances, classes } = linked;
        let tables = if lamps.is_empty() {
            Vec::new()
        } else {
            let table = |&bits: &u64| {
                LightTable::of((emitters, &|i| lamps[i as usize].has(bits)), geometry, radius, within)
            };
            classes.iter().map(table).collect()
        };
        Self { lamps, casters, masks, geometries, instances: instances.concat(), classes, tables }
    }

    /// Whether any lamp doesn't light all.
    #[inline(always)]
    pub fn matter(&self) -> bool {
        !self.lamps.is_empty()
    }

    /// Whether there is a lamp of which not everything casts shadows.
    #[inline(always)]
    pub fn shadows_matter(&self) -> bool {
        !self.masks.is_empty()
    }

    /// Whether not everything casts shadows of a lamp, so that rays of BSDFs find a part of its light only.
    #[inline(always)]
    pub fn has_casters(&self, emitter: u32) -> bool {
        self.mask(emitter) != CAST_BY_ALL
    }

    /// The mask of rays towards a lamp.
    #[inline(always)]
    pub fn mask(&self, emitter: u32) -> u32 {
        self.masks.get(emitter as usize).copied().unwrap_or(CAST_BY_ALL)
    }

    /// Whether what a ray towards a lamp met casts a shadow of it.
    pub fn cast(&self, ray: &Ray, hit: &Hit) -> bool {
        let has_lamp = ray.mask != CAST_BY_ALL && ray.mask & LAMP != 0;
        let lamp = if has_lamp { self.casters.get((ray.mask & !LAMP) as usize) } else { None };
        lamp.is_none_or(|which| which.has(self.bits_of(hit)))
    }

    /// The bits of what a ray hit.
    fn bits_of(&self, hit: &Hit) -> u64 {
        let own = self.geometries.get(hit.geometry as usize).copied().unwrap_or(0);
        let all = hit.chain.iter().filter_map(|id| self.instances.get(id as usize));
        all.fold(own, |bits, more| bits | more)
    }

    /// The class of what a ray hit.
    pub fn class_of(&self, hit: &Hit) -> Class {
        if !self.matter() || !hit.is_hit() {
            return ALL;
        }
        self.classes.binary_search(&self.bits_of(hit)).map_or(ALL, |place| place as Class + 1)
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
