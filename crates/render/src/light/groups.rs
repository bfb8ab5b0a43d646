//! Groups of lights, whose light a film can tell apart.

use straal_scene::desc;

/// Which group each emitter belongs to. Group 0 is the rest: emitters without one.
#[derive(Clone, Debug, Default)]
pub struct Groups {
    names: Vec<String>,
    /// By emitter; empty in a world without groups.
    of: Vec<u16>,
}

impl Groups {
    /// The groups that a scene names.
    pub(crate) fn of_scene(scene: &desc::Scene) -> Self {
        let named = scene.light_groups();
        let rest = (!named.is_empty()).then_some(desc::REST);
        Self { names: rest.into_iter().chain(named).map(str::to_owned).collect(), of: Vec::new() }
    }

    /// The number of the group that something is said to belong to.
    pub(crate) fn number(&self, said: Option<&desc::LightGroup>) -> u16 {
        let place = said.and_then(|said| self.names.iter().position(|name| *name == *said.0));
        place.and_then(|place| u16::try_from(place).ok()).unwrap_or(0)
    }

    /// Says which group the emitters belong to, up to so many, of which nothing was said.
    pub(crate) fn belong(&mut self, emitters: usize, group: u16) {
        if !self.names.is_empty() {
            self.of.resize(emitters, group);
        }
    }

    /// Their names, that of the rest first; none in a world without groups.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Whether there are any.
    #[inline(always)]
    pub fn matter(&self) -> bool {
        !self.of.is_empty()
    }

    /// The group of an emitter.
    #[inline(always)]
    pub fn of(&self, emitter: u32) -> u16 {
        self.of.get(emitter as usize).copied().unwrap_or(0)
    }
}
