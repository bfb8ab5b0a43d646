//! What each directive does.

use std::rc::Rc;

use straal_color::Space;
use straal_math::{Affine, DVec3};
use straal_scene::desc::{Group, Instance, Instances, Node, Transform};
use straal_scene::value::{Link, Matrix};
use straal_scene::{Diagnostic, Span, Spanned, suggest};

use super::params::{Param, Params};
use super::state::{self, Saved, State, Why};
use super::tokens::{Kind, Next, Token, unescaped};
use super::{Object, Reader, Thing};

/// All directives, for 'did you mean'.
const DIRECTIVES: [&str; 39] = [
    "Accelerator",
    "ActiveTransform",
    "AreaLightSource",
    "Attribute",
    "AttributeBegin",
    "AttributeEnd",
    "Camera",
    "ColorSpace",
    "ConcatTransform",
    "CoordSysTransform",
    "CoordinateSystem",
    "Film",
    "Identity",
    "Import",
    "Include",
    "Integrator",
    "LightSource",
    "LookAt",
    "MakeNamedMaterial",
    "MakeNamedMedium",
    "Material",
    "MediumInterface",
    "NamedMaterial",
    "ObjectBegin",
    "ObjectEnd",
    "ObjectInstance",
    "Option",
    "PixelFilter",
    "ReverseOrientation",
    "Rotate",
    "Sampler",
    "Scale",
    "Shape",
    "Texture",
    "Transform",
    "TransformBegin",
    "TransformEnd",
    "Translate",
    "WorldBegin",
];

/// Those that hardly anyone means: of version 3, and of motion.
const BESIDES: [&str; 2] = ["WorldEnd", "TransformTimes"];

/// Those that make or change what is in the world.
const OF_THE_WORLD: [&str; 13] = [
    "AttributeBegin",
    "AttributeEnd",
    "AreaLightSource",
    "LightSource",
    "Material",
    "MakeNamedMaterial",
    "NamedMaterial",
    "ObjectBegin",
    "ObjectEnd",
    "ObjectInstance",
    "ReverseOrientation",
    "Shape",
    "Texture",
];

/// Those that say how the picture is made.
const OF_THE_OPTIONS: [&str; 8] =
    ["Camera", "Film", "PixelFilter", "Sampler", "Integrator", "Accelerator", "TransformTimes", "WorldBegin"];

/// Most states that are put by at a time.
const DEEPEST: usize = 10_000;

impl Reader<'_, '_> {
    /// Reads all of them.
    pub(super) fn directives(&mut self) {
        // Whatever follows a complaint of a directive's own words is passed over up to the next directive.
        let mut lost = false;
        loop {
            let token = match self.tokens.next(self.means.d) {
                Next::End => return,
                Next::EndOfImport => {
                    self.end_of_import();
                    continue;
                }
                Next::Token(token) => token,
            };
            if self.is_done || self.means.d.is_full() && self.means.d.has_errors() {
                return;
            }
            let word = self.tokens.text(token);
            let known = DIRECTIVES.iter().chain(&BESIDES).find(|known| **known == word);
            let Some(word) = known.filter(|_| token.kind == Kind::Word) else {
                if !lost {
                    self.unknown_word(token);
                }
                lost = true;
                continue;
            };
            lost = self.directive(word, token.span).is_none();
        }
    }

    fn unknown_word(&mut self, token: Token) {
        let text = self.tokens.text(token);
        let name = suggest::brief(text);
        let (message, help) = match token.kind {
            Kind::Word => {
                (format!("there is no directive `{name}`"), suggest::did_you_mean(text, DIRECTIVES))
            }
            _ => (format!("expected a directive such as `Shape`, found `{name}`"), None),
        };
        self.d().push(Diagnostic::error(token.span, message).maybe_help(help));
    }

    /// One directive, whose word was read; `None` after a complaint of its words.
    fn directive(&mut self, word: &str, span: Span) -> Option<()> {
        if word != "Shape" {
            self.end_of_curves();
        }
        let just_named = self.just_named.take();
        // Once: where one does, all do.
        if !self.in_world && OF_THE_WORLD.contains(&word) && !std::mem::replace(&mut self.is_early, true) {
            let message = format!("`{word}` comes before `WorldBegin`, where only the picture is told of");
            self.error(span, message);
        }
        if self.in_world && OF_THE_OPTIONS.contains(&word) {
            self.error(span, format!("`{word}` must come before `WorldBegin`"));
        }
        match word {
            "Identity" => self.state.set(&Affine::IDENTITY),
            "Translate" => {
                let [x, y, z] = self.numbers::<3>(span)?;
                self.state.concat(&Affine::translate(DVec3::new(x, y, z)));
            }
            "Scale" => {
                let [x, y, z] = self.numbers::<3>(span)?;
                self.state.concat(&Affine::scale(DVec3::new(x, y, z)));
            }
            "Rotate" => {
                let [angle, x, y, z] = self.numbers::<4>(span)?;
                match Affine::rotate(DVec3::new(x, y, z), angle) {
                    Some(turn) => self.state.concat(&turn),
                    None => {
                        self.error(span, "the axis of `Rotate` has no direction: all three numbers are 0")
                    }
                }
            }
            "LookAt" => {
                let [a, b, c, d, e, f, g, h, i] = self.numbers::<9>(span)?;
                let [eye, target, up] = [[a, b, c], [d, e, f], [g, h, i]].map(DVec3::from_array);
                match state::look_at(eye, target, up) {
                    Some(map) => self.state.concat(&map),
                    None => self.error(
                        span,
                        "`LookAt` has no direction: the eye is where it looks, or `up` is along the view",
                    ),
                }
            }
            "Transform" | "ConcatTransform" => {
                let numbers = self.numbers::<16>(span)?;
                match state::matrix(&numbers) {
                    Some(map) if word == "Transform" => self.state.set(&map),
                    Some(map) => self.state.concat(&map),
                    None => self.error(
                        span,
                        "this matrix is no affine one: its last row, told last of each column, must be 0 0 0 1",
                    ),
                }
            }
            "CoordinateSystem" => {
                let name = self.string(span)?;
                self.systems.insert(name.value, self.state.transforms);
            }
            "CoordSysTransform" => {
                let name = self.string(span)?;
                match self.systems.get(&name.value) {
                    Some(found) => self.state.transforms = *found,
                    None => {
                        let names = self.systems.keys().map(String::as_str);
                        let help = suggest::did_you_mean(&name, names);
                        let message = format!("there is no coordinate system `{}`", suggest::brief(&name));
                        self.d().push(Diagnostic::warning(name.span, message).maybe_help(help));
                    }
                }
            }
            "ActiveTransform" => {
                let token = self.tokens.here(self.means.d)?;
                self.state.active = match self.tokens.text(token) {
                    "All" => [true, true],
                    "StartTime" => [true, false],
                    "EndTime" => [false, true],
                    _ => {
                        self.error(token.span, "expected `All`, `StartTime` or `EndTime`");
                        return None;
                    }
                };
            }
            "TransformTimes" => {
                self.options.transform_times = Some(self.numbers::<2>(span)?);
            }
            "ColorSpace" => {
                let name = self.string(span)?;
                match color_space(&name) {
                    Some(space) => self.state.space = space,
                    None => self.unknown("colour space", &name, &SPACES),
                }
            }
            "Option" => self.option(span)?,
            "ReverseOrientation" => self.state.reversed = !self.state.reversed,
            "AttributeBegin" => self.save(Why::Attributes, span),
            "TransformBegin" => {
                self.warn_once(span, "`TransformBegin` is `AttributeBegin` in pbrt-v4: it is taken as such");
                self.save(Why::Attributes, span);
            }
            "AttributeEnd" | "TransformEnd" => self.restore(Why::Attributes, span),
            "Attribute" => {
                let of = self.string(span)?;
                let params = Params::read(&mut self.tokens, self.state.space, span, self.means.d);
                self.attribute(&of, params);
            }
            "ObjectBegin" => {
                let name = self.string(span)?;
                self.object_begin(name, span);
            }
            "ObjectEnd" => self.object_end(span),
            "ObjectInstance" => {
                let name = self.string(span)?;
                self.object_instance(name, span);
            }
            "MediumInterface" => {
                self.string(span)?;
                if let Some(token) = self.tokens.here(self.means.d)
                    && token.kind != Kind::Text
                {
                    self.tokens.put_back(token);
                }
                self.state.has_media = true;
                self.warn_once(span, "media are left out: they are not supported yet");
            }
            "MakeNamedMedium" => {
                self.string(span)?;
                Params::read(&mut self.tokens, self.state.space, span, self.means.d);
                self.warn_once(span, "media are left out: they are not supported yet");
            }
            "Include" | "Import" => {
                let name = self.string(span)?;
                self.include(name, word == "Import", span);
            }
            "WorldBegin" => self.world_begin(),
            "WorldEnd" => {}
            "NamedMaterial" => {
                let name = self.string(span)?;
                self.named_material(name);
            }
            "Texture" => {
                let (name, of) = (self.string(span)?, self.string(span)?);
                let thing = self.thing(span)?;
                self.texture(name, &of, thing);
            }
            _ => {
                let thing = self.thing(span)?;
                match word {
                    "Camera" => self.camera_said(thing),
                    "Film" => self.options.film = Some(thing),
                    "PixelFilter" => self.options.filter = Some(thing),
                    "Sampler" => self.options.sampler = Some(thing),
                    "Integrator" => self.options.integrator = Some(thing),
                    // What finds hits changes no picture: straal's own is used.
                    "Accelerator" => {}
                    "LightSource" => self.light(thing),
                    "AreaLightSource" => self.area_light(thing),
                    "Material" => self.material(thing, just_named),
                    "MakeNamedMaterial" => self.make_named_material(thing),
                    _ => self.shape(thing),
                }
            }
        }
        Some(())
    }

    /// A kind and its parameters.
    fn thing(&mut self, span: Span) -> Option<Thing> {
        let kind = self.string(span)?;
        let params = Params::read(&mut self.tokens, self.state.space, span, self.means.d);
        Some(Thing { kind, params })
    }

    /// The next string of a directive.
    fn string(&mut self, span: Span) -> Option<Spanned<String>> {
        match self.tokens.here(self.means.d) {
            Some(token) if token.kind == Kind::Text => {
                Some(Spanned::new(unescaped(self.tokens.text(token)), token.span))
            }
            Some(token) => {
                let message = format!(
                    "expected a string in quotes, found `{}`",
                    suggest::brief(self.tokens.text(token))
                );
                self.tokens.put_back(token);
                self.error(token.span, message);
                None
            }
            None => {
                self.error(span, "the file ends within this directive");
                None
            }
        }
    }

    /// The numbers of a directive, in brackets or not.
    fn numbers<const N: usize>(&mut self, span: Span) -> Option<[f64; N]> {
        let mut found = [0.0; N];
        let mut count = 0;
        let mut is_open = false;
        loop {
            let Some(token) = self.tokens.here(self.means.d) else {
                self.error(span, "the file ends within this directive");
                return None;
            };
            match token.kind {
                Kind::Open if count == 0 && !is_open => is_open = true,
                Kind::Close if is_open && count == N => return Some(found),
                _ => {
                    let v = crate::number::double(self.tokens.text(token));
                    let v = v.filter(|v| token.kind == Kind::Word && (*v as f32).is_finite() && count < N);
                    let Some(v) = v else {
                        let wanted = if count < N { "a number" } else { "`]`" };
                        let found = suggest::brief(self.tokens.text(token));
                        let message = format!("expected {wanted}, found `{found}`");
                        self.tokens.put_back(token);
                        self.error(token.span, message);
                        return None;
                    };
                    found[count] = v;
                    count += 1;
                    if count == N && !is_open {
                        return Some(found);
                    }
                }
            }
        }
    }

    fn save(&mut self, why: Why, span: Span) {
        if self.stack.len() >= DEEPEST {
            self.is_done = true;
            return self.error(span, format!("blocks are nested more than {DEEPEST} deep"));
        }
        self.stack.push(Saved { why, span, state: self.state.clone() });
    }

    /// Takes back what was put by last, if it was for that reason.
    fn restore(&mut self, why: Why, span: Span) {
        match self.stack.last() {
            Some(saved) if saved.why == why => {
                if let Some(saved) = self.stack.pop() {
                    self.state = saved.state;
                }
            }
            Some(saved) if saved.why != Why::Import => {
                let open = saved.span;
                let complaint = Diagnostic::error(span, "this ends another block than the one that is open");
                self.d().push(complaint.related(open, "this one is open"));
            }
            _ => self.error(span, "nothing is open that this could end"),
        }
    }

    fn attribute(&mut self, of: &Spanned<String>, params: Params) {
        let attributes = &mut self.state.attributes;
        let list = match of.as_str() {
            "shape" => &mut attributes.shape,
            "light" => &mut attributes.light,
            "material" => &mut attributes.material,
            "medium" => &mut attributes.medium,
            "texture" => &mut attributes.texture,
            _ => {
                return self.unknown(
                    "kind of attributes",
                    of,
                    &["shape", "light", "material", "medium", "texture"],
                );
            }
        };
        // The last that is said comes first.
        let mut all: Vec<Param> = params.into_list();
        all.extend(list.iter().flat_map(|known| known.iter().cloned()));
        all.truncate(super::params::MOST);
        *list = Some(Rc::new(all));
    }

    fn object_begin(&mut self, name: Spanned<String>, span: Span) {
        self.save(Why::Object, span);
        if self.object.is_some() {
            return self.error(span, "an object can't be defined within another");
        }
        if self.scene.objects.get(&name).is_some() {
            self.error(name.span, format!("the object `{}` is defined twice", suggest::brief(&name)));
        }
        self.object = Some(Object { name, nodes: Vec::new() });
    }

    fn object_end(&mut self, span: Span) {
        self.restore(Why::Object, span);
        if let Some(Object { name, nodes }) = self.object.take() {
            let group = Group {
                transform: Transform::default(),
                look_at: None,
                material: None,
                children: nodes,
                name: None,
            };
            self.scene.objects.insert(name, Node::Group(group));
        }
    }

    /// One more copy of an object. All of the same object in the world are kept together, which takes little room for each.
    fn object_instance(&mut self, name: Spanned<String>, span: Span) {
        let Some(map) = self.invertible(span) else { return };
        if self.state.moves() {
            let transform = self.moving(&map, span);
            let of = Link::new(name);
            self.push(Node::Instance(Instance { of, transform, look_at: None, material: None, name: None }));
            return;
        }
        let place = Matrix(map);
        let gathered = self.instances.get(&name.value).copied().filter(|_| self.object.is_none());
        if let Some(Node::Instances(all)) = gathered.and_then(|i| self.scene.world.get_mut(i)) {
            return all.transforms.push(place);
        }
        if self.object.is_none() {
            self.instances.insert(name.value.clone(), self.scene.world.len());
        }
        let all = Instances {
            of: Link::new(name),
            transforms: vec![place],
            transform: Transform::of(Vec::new(), span),
            look_at: None,
            material: None,
            name: None,
        };
        self.push(Node::Instances(all));
    }

    /// The same of what stays where it is when the shutter opens.
    pub(super) fn still(&mut self, span: Span) -> Option<Affine> {
        if self.state.moves() {
            self.warn_once(
                span,
                "lights, curves and textures that move stand where they are when motion begins",
            );
        }
        self.invertible(span)
    }

    /// The current transform, unless there is no way back from it; then it is said.
    pub(super) fn invertible(&mut self, span: Span) -> Option<Affine> {
        let map = *self.state.transform();
        if straal_math::Transform::new(&map).is_none() {
            self.warn(span, "this is left out: its transform is singular or leaves the range of numbers");
            return None;
        }
        Some(map)
    }

    fn option(&mut self, span: Span) -> Option<()> {
        let name = self.string(span)?;
        let value = self.tokens.here(self.means.d)?;
        let text = unescaped(self.tokens.text(value));
        let plain: String = name.chars().filter(|c| !matches!(c, '_' | '-')).collect();
        match plain.to_ascii_lowercase().as_str() {
            "seed" => match text.parse::<i64>() {
                Ok(seed) => self.options.seed = Some(seed.unsigned_abs()),
                Err(_) => self.error(value.span, "expected a whole number"),
            },
            // They change where pbrt computes, or what it writes besides.
            "rendercoordsys" | "msereferenceimage" | "msereferenceout" | "pixelstats" | "wavefront" => {}
            "disablepixeljitter"
            | "disabletexturefiltering"
            | "disablewavelengthjitter"
            | "displacementedgescale"
            | "forcediffuse" => {
                if text != "false" {
                    self.warn(name.span, format!("the option `{}` is passed over", name.value));
                }
            }
            _ => self.unknown(
                "option",
                &name,
                &[
                    "seed",
                    "rendercoordsys",
                    "pixelstats",
                    "wavefront",
                    "disablepixeljitter",
                    "disabletexturefiltering",
                ],
            ),
        }
        Some(())
    }

    fn include(&mut self, name: Spanned<String>, is_import: bool, span: Span) {
        if is_import && !self.in_world {
            self.error(span, "`Import` must come after `WorldBegin`");
        }
        let path = match self.found(&name) {
            Ok(path) => path,
            Err(refusal) => return self.refuse(&name, refusal),
        };
        // As messages call it: beside the file that was asked for.
        let shown = self.means.base.join(&name.value).display().to_string();
        let mut read = None;
        let (limits, ledger) = (self.means.limits, &mut *self.means.ledger);
        let entered = self.tokens.enter(&path, is_import, self.means.d, |_| {
            let size = crate::files::size(&path, limits.max_bytes).or_else(|refusal| {
                // What is empty includes nothing.
                if std::fs::metadata(&path).is_ok_and(|about| about.is_file() && about.len() == 0) {
                    return Ok(0);
                }
                Err(refusal)
            })?;
            if size == 0 {
                return Ok((shown, Vec::new()));
            }
            let what = || format!("reading `{}`", suggest::brief(&name));
            if let Some(shortage) = ledger.refuse(2 * size, what, "meshes in PLY files take less than lists")
            {
                return Err(crate::files::Refusal::new(shortage.to_string()).help(shortage.help()));
            }
            let bytes = crate::files::read_packed(&path, limits.max_bytes)?;
            read = Some((blake3::hash(&bytes).into(), super::tokens::kept(bytes.len())));
            Ok((shown, bytes))
        });
        if let Err(refusal) = entered {
            return self.refuse(&name, refusal);
        }
        if let Some((hash, length)) = read {
            self.text_bytes += length;
            self.files.push((path, name.value, hash));
        }
        if is_import {
            self.save(Why::Import, span);
        }
    }

    /// What an imported file changed of the state ends with it.
    fn end_of_import(&mut self) {
        while let Some(saved) = self.stack.pop() {
            let why = saved.why;
            self.state = saved.state;
            if why == Why::Import {
                return;
            }
            self.error(saved.span, "this block has no end in its file");
            if why == Why::Object {
                self.object = None;
            }
        }
    }

    fn world_begin(&mut self) {
        if self.in_world {
            return;
        }
        self.in_world = true;
        self.picture();
        self.state.transforms = [Affine::IDENTITY; 2];
        self.state.active = [true; 2];
        self.systems.insert("world".to_owned(), self.state.transforms);
    }

    fn camera_said(&mut self, thing: Thing) {
        self.options.camera = Some(thing);
        let State { transforms, .. } = self.state;
        self.camera_stands(transforms);
    }
}

/// The colour spaces that pbrt knows.
const SPACES: [&str; 4] = ["srgb", "dci-p3", "rec2020", "aces2065-1"];

fn color_space(name: &str) -> Option<Space> {
    Some(match name {
        "srgb" => Space::Srgb,
        "dci-p3" => Space::DisplayP3,
        "rec2020" => Space::Rec2020,
        "aces2065-1" => Space::Aces,
        _ => return None,
    })
}
