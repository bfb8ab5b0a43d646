//! All materials of a world, and which of those that it is made of one is at a point: a mixture, a mask and two faces have no BSDF of
//! their own.

use std::sync::Arc;

use straal_color::Light;
use straal_math::ops;

use super::{Black, Bsdf, Choice, CustomMaterial, Interiors, Material, Recipe, Wants};
use crate::lanes::Lanes;
use crate::relief::Relief;
use crate::texture::{Reading, ShadingPoint, Value};
/// Most materials inside one another.
pub const DEEPEST: usize = straal_scene::materials::DEEPEST;

/// All materials of a world.
#[derive(Clone, Debug, Default)]
pub struct Materials {
    /// What surfaces refer to by index.
    list: Vec<Material>,
    /// What each wants to know of a point.
    wants: Vec<Wants>,
    /// What each seems to be besides.
    reliefs: Vec<Option<Relief>>,
    /// Whether any wants anything.
    vary: bool,
    /// Whether each is made of others.
    made_of: Vec<bool>,
    /// Whether light may pass through each as if nothing were there.
    may_pass: Vec<bool>,
    /// Whether any is made of others.
    any_made_of: bool,
    /// Whether light may pass through any.
    any_may_pass: bool,
    /// What they are filled with.
    interiors: Interiors,
    /// What [`Material::Custom`] refers to.
    custom: Vec<Arc<dyn CustomMaterial>>,
}

impl Materials {
    /// Adds a material; gives its index.
    pub fn push(&mut self, material: Material) -> u32 {
        self.list.push(material);
        self.wants.push(Wants::default());
        self.reliefs.push(None);
        let index = (self.list.len() - 1) as u32;
        self.note(index);
        index
    }

    /// Adds a user's material; gives its index.
    pub fn push_custom(&mut self, material: Arc<dyn CustomMaterial>) -> u32 {
        self.custom.push(material);
        self.push(Material::Custom((self.custom.len() - 1) as u32))
    }

    /// Puts another material in the place of one that is there.
    pub fn replace(&mut self, index: u32, material: Material) {
        self.list[index as usize] = material;
        self.note(index);
    }

    /// Gives a material a relief.
    pub fn pretend(&mut self, index: u32, relief: Relief) {
        self.reliefs[index as usize] = Some(relief);
        self.note(index);
    }

    /// The relief of material `index`.
    pub fn relief(&self, index: u32) -> Option<&Relief> {
        self.reliefs.get(index as usize)?.as_ref()
    }

    fn note(&mut self, index: u32) {
        let mut wants = match &self.list[index as usize] {
            Material::Custom(i) => self.custom.get(*i as usize).map_or(Wants::default(), |m| m.wants()),
            material => material.wants(),
        };
        wants.point |= self.reliefs[index as usize].is_some();
        self.wants[index as usize] = wants;
        self.vary = self.wants.iter().any(|w| w.point);
        let material = &self.list[index as usize];
        self.interiors.note(index, material.interior().copied());
        self.made_of.resize(self.list.len(), false);
        self.may_pass.resize(self.list.len(), false);
        self.made_of[index as usize] = !material.parts().is_empty();
        self.may_pass[index as usize] = material.opacity().is_some();
        self.any_made_of |= self.made_of[index as usize];
        self.any_may_pass |= self.may_pass[index as usize];
    }

    /// When all are there, hands on what is known of parts to what is made of them, up to [`DEEPEST`].
    pub fn settle(&mut self) {
        for round in 0..=DEEPEST {
            let mut settled = true;
            for i in 0..self.list.len() {
                for &part in self.list[i].parts() {
                    let Some(&theirs) = self.wants.get(part as usize) else { continue };
                    let mine = self.wants[i];
                    let both =
                        Wants { point: mine.point | theirs.point, tangent: mine.tangent | theirs.tangent };
                    // One that has none pretends what the first of its parts does that has one.
                    let relief = self.reliefs[i].or(self.reliefs[part as usize]);
                    settled &= relief.is_some() == self.reliefs[i].is_some();
                    self.reliefs[i] = relief;
                    let pass = self.may_pass[i] | self.may_pass[part as usize];
                    settled &= both == mine && pass == self.may_pass[i];
                    (self.wants[i], self.may_pass[i]) = (both, pass);
                }
            }
            if settled && round > 0 {
                break;
            }
        }
        self.vary = self.wants.iter().any(|w| w.point);
        self.any_may_pass = self.may_pass.contains(&true);
    }

    /// Whether material `index` is made of others, one of which it is by chance or by side.
    #[inline]
    pub fn is_made_of_others(&self, index: u32) -> bool {
        self.made_of.get(index as usize).copied().unwrap_or(false)
    }

    /// Whether any is.
    #[inline(always)]
    pub fn choose(&self) -> bool {
        self.any_made_of
    }

    /// Whether light may pass through material `index` as if nothing were there.
    #[inline]
    pub fn may_pass(&self, index: u32) -> bool {
        self.may_pass.get(index as usize).copied().unwrap_or(false)
    }

    /// Whether any is a user's.
    #[inline(always)]
    pub fn any_custom(&self) -> bool {
        !self.custom.is_empty()
    }

    /// Whether it may through any.
    #[inline(always)]
    pub fn any_may_pass(&self) -> bool {
        self.any_may_pass
    }

    /// The opacity of a material that is a mask over one that isn't; `None` where all light meets it. Validation has seen that no mask
    /// is a part of something else where this is asked.
    pub(crate) fn plain_opacity(&self, index: u32) -> Option<Value<f32>> {
        match self.list.get(index as usize) {
            Some(Material::Mask(mask)) => mask.opacity(),
            _ => None,
        }
    }

    /// The share of light that meets material `index`.
    pub fn opacity<L: Lanes>(
        &self,
        index: u32,
        at: &ShadingPoint,
        reading: &Reading<'_, L>,
        in_front: bool,
    ) -> f32 {
        self.opacity_within(index, (at, in_front), reading, DEEPEST)
    }

    fn opacity_within<L: Lanes>(
        &self,
        index: u32,
        (at, in_front): (&ShadingPoint, bool),
        reading: &Reading<'_, L>,
        levels: usize,
    ) -> f32 {
        let Some(material) = self.list.get(index as usize).filter(|_| self.may_pass(index) && levels > 0)
        else {
            return 1.0;
        };
        let own = material.opacity().map_or(1.0, |o| ops::clamp(reading.eval(&o, at), 0.0, 1.0));
        let of = |part| self.opacity_within(part, (at, in_front), reading, levels - 1);
        match material.choice(at, reading, in_front) {
            Choice::Itself => own,
            Choice::One(part) => own * of(part),
            Choice::Two([a, b], weight) => {
                let (a, b) = (of(a), of(b));
                own * (a + ops::clamp(weight, 0.0, 1.0) * (b - a))
            }
        }
    }

    /// The material that `index` is at a point for what meets it: itself, or one of those that it is made of, by a number in [0, 1).
    pub fn chosen<L: Lanes>(
        &self,
        mut index: u32,
        (at, in_front): (&ShadingPoint, bool),
        reading: &Reading<'_, L>,
        mut u: f32,
    ) -> u32 {
        for _ in 0..=DEEPEST {
            let Some(material) = self.list.get(index as usize) else { return index };
            index = match material.choice(at, reading, in_front) {
                Choice::Itself => return index,
                Choice::One(part) => part,
                Choice::Two([a, b], weight) => {
                    let mut second = ops::clamp(weight, 0.0, 1.0);
                    if self.may_pass(index) {
                        // Given that it is met at all.
                        let [of_a, of_b] = [a, b].map(|part| self.opacity(part, at, reading, in_front));
                        let met = second * of_b;
                        let all = met + (1.0 - second) * of_a;
                        second = if all > 0.0 { met / all } else { second };
                    }
                    // What is left of the number is even again.
                    let (part, rest) =
                        if u < second { (b, u / second) } else { (a, (u - second) / (1.0 - second)) };
                    u = ops::clamp(rest, 0.0, 1.0 - f32::EPSILON / 2.0);
                    part
                }
            };
        }
        index
    }

    /// The colour of material `index` at a point, as [`Bsdf::albedo`], of what meets it.
    pub fn albedo<L: Lanes>(
        &self,
        index: u32,
        (at, in_front): (&ShadingPoint, bool),
        reading: &Reading<'_, L>,
    ) -> Light {
        self.albedo_within(index, (at, in_front), reading, DEEPEST)
    }

    fn albedo_within<L: Lanes>(
        &self,
        index: u32,
        (at, in_front): (&ShadingPoint, bool),
        reading: &Reading<'_, L>,
        levels: usize,
    ) -> Light {
        let choice = self.list.get(index as usize).map(|m| m.choice(at, reading, in_front));
        let of = |part| self.albedo_within(part, (at, in_front), reading, levels - 1);
        match choice.filter(|_| levels > 0) {
            Some(Choice::One(part)) => of(part),
            Some(Choice::Two([a, b], weight)) => of(a) * (1.0 - weight) + of(b) * weight,
            Some(Choice::Itself) | None => self.bsdf(index, at, reading).albedo(),
        }
    }

    /// What they are filled with.
    #[inline(always)]
    pub fn interiors(&self) -> &Interiors {
        &self.interiors
    }

    /// How many.
    #[inline]
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Those in the list.
    pub fn iter(&self) -> std::slice::Iter<'_, Material> {
        self.list.iter()
    }

    /// Material `index`.
    pub fn get(&self, index: usize) -> Option<&Material> {
        self.list.get(index)
    }

    /// Whether any differs from point to point.
    #[inline(always)]
    pub fn vary(&self) -> bool {
        self.vary
    }

    /// What material `index` must know of a point.
    pub fn wants(&self, index: u32) -> Wants {
        self.wants.get(index as usize).copied().unwrap_or_default()
    }

    /// How material `index` scatters at a point. Black when there is no such material.
    #[inline]
    pub fn bsdf<'w, L: Lanes>(&'w self, index: u32, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let found = match self.list.get(index as usize) {
            Some(Material::Custom(i)) => self.custom.get(*i as usize).map(|m| m.bsdf(at, reading)),
            Some(material) => material.bsdf(at, reading),
            None => None,
        };
        found.unwrap_or(Bsdf::Black(Black))
    }
}
