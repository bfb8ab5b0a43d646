//! What all that shines has in common: lights, and surfaces that glow.

use std::collections::BTreeSet;

use crate::decode::Describe;
use crate::desc::{Integrator, LampChoice, Light, Node, Scene, ShadowZones};
use crate::describe::describe;
use crate::limit::Limit;
use crate::value::Name;
use crate::visit::Visitor;

describe! {
    /// What all that shines has in common.
    pub struct Lamp {
        /// The group of lights that its light is told by: `straal develop --light-group NAME=2` makes it brighter afterwards. What has no group is in `rest`.
        light_group: Option<LightGroup> = None,
        /// Names of what it lights, and nothing else: of nodes (`name`), with all that is in them, and of objects, wherever they stand. All else neither gets its light nor shows it.
        lights_only: Vec<Name> = Vec::new(),
        /// Names of what it doesn't light.
        lights_all_but: Vec<Name> = Vec::new(),
        /// Names of what casts shadows of its light, and nothing else does: its light passes all other things on its way to a surface.
        shadows_only: Vec<Name> = Vec::new(),
        /// Names of what casts no shadows of its light.
        shadows_all_but: Vec<Name> = Vec::new(),
        /// Whether the camera sees what shines. Where not, its rays go past it as if it weren't there, and surroundings are black; it lights as before, and mirrors and glass show it.
        seen: bool = true,
    }
}

/// The group that light counts in whose lamp has none.
pub const REST: &str = "rest";

/// Most groups of lights, besides [`REST`].
pub const MOST_LIGHT_GROUPS: usize = 255;

/// Most names that lamps may say: things that they light or don't, that cast shadows of them or don't.
pub const MOST_LINKED: usize = 64;

/// Most bytes of a group's name: it becomes part of the name of a layer.
const LONGEST: usize = 100;

/// The name of a group of lights.
#[derive(Clone, Debug, PartialEq)]
pub struct LightGroup(pub Name);

impl LightGroup {
    /// Why a group can't be called so, if it can't: a dot ends a layer's name, and the others end one on the command line.
    pub fn complaint(name: &str) -> Option<String> {
        if name.is_empty() {
            return Some("a light group needs a name".into());
        }
        if name.len() > LONGEST {
            return Some(format!(
                "the name of a light group may have {LONGEST} bytes, and this has {}",
                name.len()
            ));
        }
        let bad = name.chars().find(is_bad)?;
        let bad = if bad.is_control() || bad == ' ' { "spaces".to_owned() } else { format!("`{bad}`") };
        Some(format!("the name of a light group may not hold {bad}: layers of a picture are named by it"))
    }

    /// What a group is called that has the name of something else: what no name may hold becomes `_`, and long names are cut.
    fn called_as(name: &str) -> String {
        let mut called = String::new();
        for c in name.chars().map(|c| if is_bad(&c) { '_' } else { c }) {
            if called.len() + c.len_utf8() > LONGEST {
                break;
            }
            called.push(c);
        }
        called
    }
}

/// Whether the name of a group can't hold it.
fn is_bad(c: &char) -> bool {
    c.is_whitespace() || c.is_control() || ['.', ',', '='].contains(c)
}

impl Scene {
    /// Whom each lamp lights: what lights and surfaces say, of the world and of objects.
    fn lamps(&self) -> Vec<&Lamp> {
        let mut lamps: Vec<&Lamp> = self.lights.iter().map(Light::lamp).collect();
        for node in self.objects.iter().map(|(_, object)| object).chain(&self.world) {
            node.visit(&mut |node| lamps.extend(node.surface().map(|surface| &surface.lamp)));
        }
        lamps
    }

    /// The names of what lamps light, or don't, and of what casts shadows of them, or doesn't, and of a lamp whose zones are shown, with their places.
    pub(crate) fn links(&self) -> Vec<&Name> {
        self.lamps()
            .into_iter()
            .flat_map(|lamp| {
                let shadows = lamp.shadows_only.iter().chain(&lamp.shadows_all_but);
                lamp.lights_only.iter().chain(&lamp.lights_all_but).chain(shadows)
            })
            .chain(self.lamp_of_zones())
            .collect()
    }

    /// The name of the lamp whose zones of shadow are shown.
    pub fn lamp_of_zones(&self) -> Option<&Name> {
        match &self.integrator {
            Integrator::Zones(ShadowZones { lamp: LampChoice::Named(name), .. }) => Some(name),
            _ => None,
        }
    }

    /// Whether any lamp doesn't light all.
    pub fn has_linked_lamps(&self) -> bool {
        self.lamps().iter().any(|lamp| !lamp.lights_only.is_empty() || !lamp.lights_all_but.is_empty())
    }

    /// The same in order, each once.
    pub fn linked_names(&self) -> Vec<&str> {
        let names: BTreeSet<&str> = self.links().into_iter().map(|name| name.value.as_str()).collect();
        names.into_iter().collect()
    }

    /// Puts each lamp that has a name and no group into one that is called so: lights, surfaces with an emission of their own, by their name or that of what is around them, and materials that
    /// shine. Of the names that no group may have, letters are replaced. Gives those for which there was no room.
    pub fn group_lamps(&mut self) -> Vec<String> {
        let mut groups = Groups {
            names: self.light_groups().into_iter().map(str::to_owned).collect(),
            over: BTreeSet::new(),
        };
        for light in &mut self.lights {
            if let Some(group) = light.name().cloned() {
                groups.put(&mut light.lamp_mut().light_group, &group);
            }
        }
        for (name, object) in self.objects.entries_mut() {
            groups.put_all(object, Some(name));
        }
        for node in &mut self.world {
            groups.put_all(node, None);
        }
        for (name, material) in self.materials.entries_mut() {
            if material.emission().is_some()
                && let Some(group) = material.light_group_mut()
            {
                groups.put(group, name);
            }
        }
        groups.over.into_iter().collect()
    }

    /// The groups of its lights by name, in order; [`REST`] isn't among them.
    pub fn light_groups(&self) -> Vec<&str> {
        struct Groups<'a>(BTreeSet<&'a str>);
        impl<'a> Visitor<'a> for Groups<'a> {
            fn light_group(&mut self, name: &'a Name) {
                self.0.insert(name);
            }
        }
        let mut groups = Groups(BTreeSet::new());
        self.show(Limit::FINITE, &mut groups);
        groups.0.remove(REST);
        groups.0.into_iter().collect()
    }
}

/// Groups that lamps are put into by their names.
struct Groups {
    /// Those that there are.
    names: BTreeSet<String>,
    /// Those for which there is no room.
    over: BTreeSet<String>,
}

impl Groups {
    /// Says a group where none is said.
    fn put(&mut self, said: &mut Option<LightGroup>, name: &Name) {
        let called = LightGroup::called_as(name);
        if said.is_some() || called.is_empty() {
            return;
        }
        if self.names.len() >= MOST_LIGHT_GROUPS && !self.names.contains(&called) {
            self.over.insert(called);
            return;
        }
        self.names.insert(called.clone());
        *said = Some(LightGroup(Name::new(called, name.span)));
    }

    /// The same for a node and all in it, by its name or that of what is around it.
    fn put_all(&mut self, node: &mut Node, around: Option<&Name>) {
        let own = node.name().cloned();
        let name = own.as_ref().or(around);
        if let (Some(surface), Some(name)) = (node.surface_mut().filter(|s| s.emission.is_some()), name) {
            self.put(&mut surface.lamp.light_group, name);
        }
        for child in node.children_mut() {
            self.put_all(child, name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::LightGroup;

    #[test]
    fn any_name_can_be_made_one_of_a_group() {
        for (name, group) in
            [("Key", "Key"), ("Key light.001", "Key_light_001"), ("a=b,c", "a_b_c"), ("", "")]
        {
            assert_eq!(LightGroup::called_as(name), group);
        }
        let long = LightGroup::called_as(&"ü".repeat(99));
        assert_eq!((long.len(), LightGroup::complaint(&long)), (100, None));
    }

    #[test]
    fn names_are_fit_for_layers() {
        for good in ["key", "Key_2", "fülle", "a-b"] {
            assert_eq!(LightGroup::complaint(good), None, "{good}");
        }
        for bad in ["", "a.b", "a=b", "a,b", "a b", "a\tb", &"x".repeat(101)] {
            assert!(LightGroup::complaint(bad).is_some(), "{bad}");
        }
    }
}
