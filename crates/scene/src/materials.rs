//! Materials by name: that none is made of itself, and none of others too deep.

use crate::desc::{Material, MaterialRef, Scene};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::handle::Handle;
use crate::span::Span;
use crate::suggest;

/// Most materials inside one another.
pub const DEEPEST: usize = 16;

/// What a material is made of.
#[derive(Default)]
struct Parts {
    /// Those that have names, where these stand, and how many materials deep.
    named: Vec<(Handle<Material>, Span, usize)>,
    /// How many materials deep those are that are written within it.
    inside: usize,
}

impl Parts {
    fn of(material: &Material) -> Self {
        let mut found = Self { inside: inside(material), ..Self::default() };
        for part in material.parts() {
            part.names(&mut |link, depth| {
                found.named.extend(link.to().map(|to| (to, link.name.span, depth + 1)));
            });
        }
        found
    }

    /// How deep it is, with all those that have names.
    fn depth(&self, states: &[State]) -> usize {
        let named = self.named.iter().map(|&(to, _, depth)| match states.get(to.index()) {
            Some(State::Known(more)) => depth + more,
            _ => depth,
        });
        named.fold(self.inside, usize::max)
    }
}

/// How many materials deep those are that are written within one.
fn inside(material: &Material) -> usize {
    let each = material.parts().into_iter().map(|part| match part {
        MaterialRef::Named(_) => 1,
        MaterialRef::Inline(part) => 1 + inside(part),
    });
    each.max().unwrap_or(0)
}

/// How far the walk over a material has come.
#[derive(Clone, Copy, PartialEq)]
enum State {
    Unseen,
    Open,
    /// So deep within one another.
    Known(usize),
}

/// Complains of what is wrong with the scene's materials as a whole.
pub(crate) fn validate(scene: &Scene, d: &mut Diagnostics) {
    let all: Vec<Parts> = scene.materials.iter().map(|(_, m)| Parts::of(m)).collect();
    let mut states = vec![State::Unseen; all.len()];
    // Kept on a stack of its own: a scene may chain as many as it likes.
    for root in 0..all.len() {
        if states[root] != State::Unseen {
            continue;
        }
        states[root] = State::Open;
        let mut open = vec![(root, 0)];
        while let Some((material, done)) = open.last_mut() {
            let Some(&(to, span, _)) = all[*material].named.get(*done) else {
                states[*material] = State::Known(all[*material].depth(&states));
                open.pop();
                continue;
            };
            *done += 1;
            match states.get(to.index()) {
                Some(State::Unseen) => {
                    states[to.index()] = State::Open;
                    open.push((to.index(), 0));
                }
                Some(State::Open) => {
                    let name = scene.materials.at(to).map_or("", |(name, _)| &name.value);
                    let message = format!("the material `{}` is made of itself", suggest::brief(name));
                    d.push(Diagnostic::error(span, message));
                }
                _ => {}
            }
        }
    }
    deep(scene, &states, d);
}

/// Complains of the first material that is too deep.
fn deep(scene: &Scene, states: &[State], d: &mut Diagnostics) {
    let message = || format!("materials are made of one another, more than {DEEPEST} deep");
    let is_deep = |state: &State| matches!(state, State::Known(depth) if *depth > DEEPEST);
    if let Some(((name, _), _)) = scene.materials.iter().zip(states).find(|(_, state)| is_deep(state)) {
        d.push(Diagnostic::error(name.span, message()));
        return;
    }
    let mut found = None;
    scene.visit(|node| {
        if let (None, Some(MaterialRef::Inline(material))) = (found, node.material())
            && Parts::of(material).depth(states) > DEEPEST
        {
            found = Some(node.transform().span);
        }
    });
    if let Some(span) = found {
        d.push(Diagnostic::error(span, message()));
    }
}
