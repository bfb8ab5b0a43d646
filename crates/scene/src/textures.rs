//! Textures by name: that each leads somewhere, that none is made of itself, and that none is made of too many.

use crate::decode::Describe;
use crate::desc::{Scene, Spectrum, Texture, TextureOf};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::limit::Limit;
use crate::span::Span;
use crate::suggest;
use crate::value::{LinearRgb, Link, Name};
use crate::visit::Visitor;

/// The most textures that are asked where one is read, each as often as it is asked.
const MOST_PARTS: u64 = 1000;

/// The most textures within one another.
const DEEPEST: u32 = 32;

/// Uses of textures by their names, and how many textures there are besides.
#[derive(Default)]
struct Uses<'a> {
    /// All that are used, and of those that stand for a value what it must be within and whether it is a number.
    named: Vec<&'a Link<Texture>>,
    values: Vec<(&'a Link<Texture>, Limit, bool)>,
    inline: u64,
}

impl<'a> Visitor<'a> for Uses<'a> {
    fn texture(&mut self, texture: &'a TextureOf, limit: Limit, is_number: bool) {
        match texture {
            TextureOf::Named(link) => self.values.push((link, limit, is_number)),
            TextureOf::Inline(_) => self.inline += 1,
        }
    }

    fn texture_name(&mut self, link: &'a Link<Texture>) {
        self.named.push(link);
    }
}

impl<'a> Uses<'a> {
    fn of<T: Describe>(thing: &'a T) -> Self {
        let mut uses = Self::default();
        thing.show(Limit::FINITE, &mut uses);
        uses
    }
}

/// How far the walk over a texture has come.
#[derive(Clone, Copy, PartialEq)]
enum State {
    Unseen,
    Open,
    /// So many textures are asked where it is read, so deep within one another.
    Known(u64, u32),
}

/// Complains of what is wrong with the scene's textures as a whole.
pub(crate) fn validate(scene: &Scene, d: &mut Diagnostics) {
    if scene.textures.is_unreadable() {
        return;
    }
    for (name, _) in scene.textures.iter().filter(|(name, _)| Texture::KINDS.contains(&name.value.as_str())) {
        let message = format!("a texture can't be called `{}`, which is a kind of texture", name.value);
        d.push(Diagnostic::error(name.span, message).help("give it another name"));
    }
    // What is used in each of them, and what is used elsewhere: a scene shows its own textures as well.
    let uses: Vec<Uses<'_>> = scene.textures.iter().map(|(_, texture)| Uses::of(texture)).collect();
    let all = Uses::of(scene);
    for link in all.named.iter().filter(|link| link.to().is_none()) {
        missing(scene, &link.name, d);
    }
    for (link, limit, is_number) in &all.values {
        if let Some(texture) = scene.textures.of(link) {
            fits(texture, &link.name, (*limit, *is_number), d);
        }
    }
    let mut walk = Walk { scene, uses: &uses, states: vec![State::Unseen; uses.len()], d };
    for i in 0..uses.len() {
        walk.texture(i, 0);
    }
    if !walk.d.has_errors() {
        let states = walk.states;
        for link in all.named {
            let (name, known) = (&link.name, link.to().map(|to| states[to.index()]));
            if let Some(State::Known(parts, _)) =
                known.filter(|s| matches!(s, State::Known(parts, _) if *parts > MOST_PARTS))
            {
                let message = format!(
                    "to read the texture `{}` once takes {parts} look-ups, {MOST_PARTS} at the most",
                    suggest::brief(name)
                );
                d.push(Diagnostic::error(name.span, message));
                return;
            }
        }
    }
}

/// Complains of a texture whose colours can't be what it is read for.
fn fits(texture: &Texture, name: &Name, (limit, is_number): (Limit, bool), d: &mut Diagnostics) {
    for colour in texture.colours() {
        let Spectrum::Rgb(LinearRgb(rgb)) = colour else { continue };
        if let Some(v) = rgb.iter().find(|v| !limit.allows(**v)) {
            let message = limit.complaint(&suggest::brief(name), *v);
            d.push(Diagnostic::error(name.span, message));
            return;
        }
        if is_number && (rgb[0] != rgb[1] || rgb[1] != rgb[2]) {
            let message =
                format!("a number is needed here, and the texture `{}` is of colours", suggest::brief(name));
            d.push(Diagnostic::error(name.span, message));
            return;
        }
    }
}

fn missing(scene: &Scene, name: &Name, d: &mut Diagnostics) {
    if name.is_empty() || d.is_full() {
        return;
    }
    const MOST: usize = 1000;
    let names = || scene.textures.iter().map(|(n, _)| n.value.as_str());
    let kinds = Texture::KINDS.iter().copied();
    let help =
        suggest::did_you_mean(name, names().take(MOST).chain(kinds.clone())).unwrap_or_else(|| match names()
            .next()
        {
            None => format!(
                "`textures` has no entries; a texture can also be written here: {}",
                suggest::list(kinds)
            ),
            Some(_) => format!("`textures` has {}", suggest::list(names().take(12))),
        });
    let message = format!("there is no texture named `{}`", suggest::brief(name));
    d.push(Diagnostic::error(name.span, message).help(help));
}

struct Walk<'a> {
    scene: &'a Scene,
    uses: &'a [Uses<'a>],
    states: Vec<State>,
    d: &'a mut Diagnostics,
}

impl Walk<'_> {
    /// How many textures are asked where one is read, and how deep.
    fn texture(&mut self, i: usize, depth: u32) -> (u64, u32) {
        match self.states[i] {
            State::Known(parts, inside) => return (parts, inside),
            State::Open => return (1, 1),
            State::Unseen => {}
        }
        self.states[i] = State::Open;
        let (mut parts, mut inside) = (1 + self.uses[i].inline, 1 + self.uses[i].inline.min(64) as u32);
        for link in &self.uses[i].named {
            let (name, Some(to)) = (&link.name, link.to().map(|to| to.index())) else { continue };
            if self.states[to] == State::Open {
                let message = format!("the texture `{}` is made of itself", suggest::brief(name));
                let complaint = Diagnostic::error(name.span, message);
                let place = self.scene.textures.iter().nth(to).map_or(Span::NONE, |(name, _)| name.span);
                let label = format!("`{}` is defined here", suggest::brief(name));
                self.d.push(complaint.related(place, label));
                continue;
            }
            // Too deep to be followed further, which is told.
            if depth >= DEEPEST {
                let message = format!("textures stand deeper than {DEEPEST} within one another");
                self.d.push(Diagnostic::error(name.span, message));
                break;
            }
            let (more, deeper) = self.texture(to, depth + 1);
            parts = parts.saturating_add(more);
            inside = inside.max(1 + deeper);
        }
        if inside > DEEPEST && depth == 0 && !self.d.has_errors() {
            let name = self.scene.textures.iter().nth(i).map(|(name, _)| name);
            let message = format!("textures stand deeper than {DEEPEST} within one another");
            self.d.push(Diagnostic::error(name.map_or(Span::NONE, |n| n.span), message));
        }
        self.states[i] = State::Known(parts, inside);
        (parts, inside)
    }
}
