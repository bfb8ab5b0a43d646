//! Lists of parameters: `"float radius" [ 2 ]`, and how what reads them asks for one.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use straal_color::Space;
use straal_math::DVec3;
use straal_scene::{Diagnostic, Diagnostics, Span, Spanned, suggest};

use super::tokens::{Kind, Token, Tokens, unescaped};

/// What a parameter's numbers mean, by the first word of its declaration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Float,
    Integer,
    Bool,
    String,
    Texture,
    Rgb,
    /// pbrt-v3's.
    Xyz,
    Spectrum,
    Blackbody,
    Point2,
    Vector2,
    Point3,
    Vector3,
    Normal,
}

/// The types by what pbrt-v4 calls them, and then by what version 3 does.
const TYPES: [(&str, Type); 20] = [
    ("float", Type::Float),
    ("integer", Type::Integer),
    ("bool", Type::Bool),
    ("string", Type::String),
    ("texture", Type::Texture),
    ("rgb", Type::Rgb),
    ("spectrum", Type::Spectrum),
    ("blackbody", Type::Blackbody),
    ("point2", Type::Point2),
    ("vector2", Type::Vector2),
    ("point3", Type::Point3),
    ("vector3", Type::Vector3),
    ("normal", Type::Normal),
    ("normal3", Type::Normal),
    ("color", Type::Rgb),
    ("xyz", Type::Xyz),
    ("point", Type::Point3),
    ("vector", Type::Vector3),
    ("point4", Type::Float),
    ("vector4", Type::Float),
];

/// Most parameters of a thing, or of what is said around things.
pub(super) const MOST: usize = 500;

/// How many of them version 4 has.
const OF_VERSION_4: usize = 13;

/// What a parameter holds.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Values {
    Numbers(Vec<f64>),
    /// What there may be millions of: places and directions.
    Singles(Vec<f32>),
    Integers(Vec<i32>),
    Bools(Vec<bool>),
    Strings(Vec<Spanned<String>>),
}

/// One parameter.
#[derive(Clone, Debug)]
pub(super) struct Param {
    pub kind: Type,
    pub name: Rc<str>,
    /// Where it is declared.
    pub span: Span,
    pub values: Values,
    /// In which linear RGB its colours are.
    pub space: Space,
    /// Whether anything has asked for it.
    used: Cell<bool>,
}

impl Param {
    /// The numbers, if it has such.
    pub fn numbers(&self) -> Option<&[f64]> {
        if let Values::Numbers(v) = &self.values { Some(v) } else { None }
    }

    /// The strings, if it has such.
    pub fn strings(&self) -> Option<&[Spanned<String>]> {
        if let Values::Strings(v) = &self.values { Some(v) } else { None }
    }
}

/// A list of parameters.
#[derive(Clone, Debug, Default)]
pub(super) struct Params {
    own: Vec<Param>,
    /// What an `Attribute` directive says for all of a kind; nobody has to ask for it.
    around: Option<Rc<Vec<Param>>>,
    /// What was asked for.
    asked: RefCell<Vec<&'static str>>,
    /// Where the thing is said that they are of.
    pub span: Span,
}

impl Params {
    /// Reads all that follow.
    pub fn read(tokens: &mut Tokens<'_>, space: Space, span: Span, d: &mut Diagnostics) -> Self {
        let mut own: Vec<Param> = Vec::new();
        let mut is_full = false;
        while let Some(token) = tokens.here(d) {
            if token.kind != Kind::Text {
                tokens.put_back(token);
                break;
            }
            let Some(param) = one(token, tokens, space, d) else { continue };
            if let Some(first) = own.iter().find(|p| p.name == param.name && p.kind == param.kind) {
                let message = format!("`{}` is said twice: the first counts", suggest::brief(&param.name));
                d.push(Diagnostic::warning(param.span, message).related(first.span, "the first is here"));
                continue;
            }
            if own.len() < MOST {
                own.push(param);
            } else if !std::mem::replace(&mut is_full, true) {
                d.push(Diagnostic::error(param.span, format!("there are more than {MOST} parameters")));
            }
        }
        Self { own, span, ..Self::default() }
    }

    /// With what is said around them for all of their kind.
    pub fn within(self, around: &Option<Rc<Vec<Param>>>) -> Self {
        Self { around: around.clone(), ..self }
    }

    /// The parameters themselves.
    pub fn into_list(self) -> Vec<Param> {
        self.own
    }

    fn all(&self) -> impl Iterator<Item = &Param> {
        self.own.iter().chain(self.around.iter().flat_map(|list| list.iter()))
    }

    fn ask(&self, name: &'static str) {
        let mut asked = self.asked.borrow_mut();
        if !asked.contains(&name) {
            asked.push(name);
        }
    }

    /// The first of a name whose type is as wanted.
    pub fn find(&self, name: &'static str, wanted: impl Fn(Type) -> bool) -> Option<&Param> {
        self.ask(name);
        let found = self.all().find(|p| &*p.name == name && wanted(p.kind))?;
        found.used.set(true);
        Some(found)
    }

    /// Whether there is a parameter of that name, of whatever type.
    pub fn has(&self, name: &'static str) -> bool {
        self.ask(name);
        self.all().any(|p| &*p.name == name)
    }

    /// Marks what means nothing here though it does to pbrt.
    pub fn pass_over(&self, names: &[&'static str]) {
        for name in names {
            self.find(name, |_| true);
        }
    }

    /// All numbers of a parameter.
    pub fn floats(&self, name: &'static str) -> Option<&[f64]> {
        self.find(name, |t| t == Type::Float)?.numbers()
    }

    /// One number, or what stands for it.
    pub fn float(&self, name: &'static str, absent: f64) -> f64 {
        self.maybe_float(name).unwrap_or(absent)
    }

    /// One number, if it is said.
    pub fn maybe_float(&self, name: &'static str) -> Option<f64> {
        match &self.find(name, |t| matches!(t, Type::Float | Type::Integer))?.values {
            Values::Numbers(v) => v.first().copied(),
            Values::Integers(v) => v.first().map(|i| f64::from(*i)),
            _ => None,
        }
    }

    /// One whole number, if it is said.
    pub fn maybe_integer(&self, name: &'static str) -> Option<i32> {
        self.integers(name)?.first().copied()
    }

    /// One whole number, or what stands for it.
    pub fn integer(&self, name: &'static str, absent: i32) -> i32 {
        self.maybe_integer(name).unwrap_or(absent)
    }

    /// All whole numbers of a parameter.
    pub fn integers(&self, name: &'static str) -> Option<&[i32]> {
        match &self.find(name, |t| t == Type::Integer)?.values {
            Values::Integers(v) => Some(v),
            _ => None,
        }
    }

    /// Yes or no, or what stands for it.
    pub fn bool(&self, name: &'static str, absent: bool) -> bool {
        let Some(found) = self.find(name, |t| t == Type::Bool) else { return absent };
        if let Values::Bools(v) = &found.values { v.first().copied().unwrap_or(absent) } else { absent }
    }

    /// A word, if it is said.
    pub fn string(&self, name: &'static str) -> Option<&Spanned<String>> {
        self.find(name, |t| t == Type::String)?.strings()?.first()
    }

    /// The name of a texture, if one is said.
    pub fn texture(&self, name: &'static str) -> Option<&Spanned<String>> {
        self.find(name, |t| t == Type::Texture)?.strings()?.first()
    }

    /// Places, directions or normals, so many numbers each.
    pub fn singles(&self, name: &'static str, wanted: &[Type]) -> Option<(&[f32], Span)> {
        let found = self.find(name, |t| wanted.contains(&t))?;
        if let Values::Singles(v) = &found.values { Some((v, found.span)) } else { None }
    }

    /// A place or direction, if it is said.
    pub fn vector(&self, name: &'static str) -> Option<DVec3> {
        let (v, _) = self.singles(name, &[Type::Point3, Type::Vector3, Type::Normal])?;
        let [x, y, z] = v.first_chunk::<3>()?.map(f64::from);
        Some(DVec3::new(x, y, z))
    }

    /// Warns of what nobody has asked for, where pbrt would stop.
    pub fn complain(&self, of: &str, d: &mut Diagnostics) {
        let asked = self.asked.borrow();
        for param in self.own.iter().filter(|p| !p.used.get()) {
            // Of another type than the one that was taken.
            let taken = self.own.iter().any(|p| p.name == param.name && p.used.get());
            let name = suggest::brief(&param.name);
            let (message, help) = if taken {
                (format!("`{name}` is said in two ways: this one is passed over"), None)
            } else if asked.contains(&&*param.name) {
                (format!("`{name}` of {of} is of another type: it is passed over"), None)
            } else {
                // Nobody reads more of them than are kept.
                let help = if d.is_full() {
                    None
                } else {
                    suggest::did_you_mean(&param.name, asked.iter().copied())
                };
                (format!("{of} has no parameter `{name}`: it is passed over"), help)
            };
            d.push(Diagnostic::warning(param.span, message).maybe_help(help));
        }
    }
}

/// One parameter, whose declaration was read; `None` after a complaint.
fn one(token: Token, tokens: &mut Tokens<'_>, space: Space, d: &mut Diagnostics) -> Option<Param> {
    let declared = unescaped(tokens.text(token));
    let mut words = declared.split([' ', '\t']).filter(|w| !w.is_empty());
    let (word, name) = (words.next().unwrap_or(""), words.next().unwrap_or(""));
    let kind = TYPES.iter().position(|(known, _)| *known == word);
    let kind = match kind {
        _ if name.is_empty() => {
            let message = format!("`{}` is no declaration of a parameter", suggest::brief(&declared));
            let help = "it is a type and a name, such as `\"float radius\"`";
            d.push(Diagnostic::error(token.span, message).help(help));
            None
        }
        None => {
            let message = format!("there is no type of parameter `{}`", suggest::brief(word));
            let names = TYPES[..OF_VERSION_4].iter().map(|(known, _)| *known);
            let help = suggest::did_you_mean(word, names.clone())
                .unwrap_or_else(|| format!("types are {}", suggest::list(names)));
            d.push(Diagnostic::error(token.span, message).help(help));
            None
        }
        Some(i) => Some(TYPES[i].1),
    };
    let (name, span) = (Rc::from(name), token.span);
    let values = values(kind.unwrap_or(Type::String), (span, tokens), kind.is_none(), d)?;
    let kind = kind?;
    let param = Param { kind, name, span, values, space, used: Cell::new(false) };
    is_sound(&param, d).then_some(param)
}

/// Complains where numbers aren't finite or don't come in the right number.
fn is_sound(param: &Param, d: &mut Diagnostics) -> bool {
    let name = || suggest::brief(&param.name);
    let (count, finite) = match &param.values {
        Values::Numbers(v) => (v.len(), v.iter().all(|v| (*v as f32).is_finite())),
        Values::Singles(v) => (v.len(), v.iter().all(|v| v.is_finite())),
        Values::Integers(v) => (v.len(), true),
        Values::Bools(v) => (v.len(), true),
        Values::Strings(v) => (v.len(), true),
    };
    // Of meshes, triangles with such corners are left out and counted.
    if !finite && !matches!(param.values, Values::Singles(_)) {
        let message = format!("`{}` has a number that is not finite", name());
        d.push(Diagnostic::error(param.span, message));
        return false;
    }
    let each = match param.kind {
        Type::Rgb | Type::Xyz | Type::Point3 | Type::Vector3 | Type::Normal => 3,
        Type::Point2 | Type::Vector2 => 2,
        Type::Spectrum if param.numbers().is_some() => 2,
        _ => 1,
    };
    if count % each != 0 {
        let message = format!("`{}` has {count} numbers, which is no multiple of {each}", name());
        d.push(Diagnostic::error(param.span, message));
        return false;
    }
    true
}

/// The values of a parameter, with or without brackets. `ignored` ones are of no known type.
fn values(
    kind: Type,
    (span, tokens): (Span, &mut Tokens<'_>),
    ignored: bool,
    d: &mut Diagnostics,
) -> Option<Values> {
    let mut values = match kind {
        Type::Point2 | Type::Vector2 | Type::Point3 | Type::Vector3 | Type::Normal => {
            Values::Singles(Vec::new())
        }
        Type::Integer => Values::Integers(Vec::new()),
        Type::Bool => Values::Bools(Vec::new()),
        Type::String | Type::Texture => Values::Strings(Vec::new()),
        _ => Values::Numbers(Vec::new()),
    };
    let missing = |d: &mut Diagnostics| {
        d.push(Diagnostic::error(span, "the file ends where a parameter's values should be"));
    };
    let Some(first) = tokens.here(d) else {
        missing(d);
        return None;
    };
    let mut sound = true;
    if first.kind != Kind::Open {
        if first.kind == Kind::Close {
            d.push(Diagnostic::error(first.span, "`]` without `[`"));
            return None;
        }
        sound = push(&mut values, first, tokens, ignored, d);
        return sound.then_some(values);
    }
    loop {
        // Long lists are of numbers.
        let rest = match &mut values {
            Values::Numbers(list) => tokens.numbers(|v| list.push(v), d),
            Values::Singles(list) => tokens.numbers(|v| list.push(v as f32), d),
            _ => tokens.here(d),
        };
        let Some(token) = rest else {
            missing(d);
            return None;
        };
        match token.kind {
            Kind::Close => break,
            Kind::Open => {
                d.push(Diagnostic::error(token.span, "`[` within `[`"));
                sound = false;
            }
            // After a complaint the rest is passed over.
            _ if sound => sound = push(&mut values, token, tokens, ignored, d),
            _ => {}
        }
    }
    let empty = match &values {
        Values::Numbers(v) => v.is_empty(),
        Values::Singles(v) => v.is_empty(),
        Values::Integers(v) => v.is_empty(),
        Values::Bools(v) => v.is_empty(),
        Values::Strings(v) => v.is_empty(),
    };
    if sound && empty {
        return None;
    }
    sound.then_some(values)
}

/// Takes one more value; `false` after a complaint.
fn push(values: &mut Values, token: Token, tokens: &Tokens<'_>, ignored: bool, d: &mut Diagnostics) -> bool {
    if ignored {
        return true;
    }
    let text = tokens.text(token);
    let wanted = match values {
        // Spectra go by name as well.
        Values::Numbers(list) if token.kind == Kind::Text && list.is_empty() => {
            *values = Values::Strings(vec![Spanned::new(unescaped(text), token.span)]);
            return true;
        }
        Values::Strings(list) if token.kind == Kind::Text => {
            list.push(Spanned::new(unescaped(text), token.span));
            return true;
        }
        Values::Bools(list) => match text {
            "true" | "false" => {
                list.push(text == "true");
                return true;
            }
            _ => "`true` or `false`",
        },
        Values::Integers(list) if token.kind == Kind::Word => match text.parse::<i32>() {
            Ok(v) => {
                list.push(v);
                return true;
            }
            // As some programs write them: 3.0.
            Err(_) => match crate::number::double(text) {
                Some(v) if v == f64::from(v as i32) => {
                    list.push(v as i32);
                    return true;
                }
                _ => "a whole number of at most 2147483647",
            },
        },
        Values::Numbers(list) if token.kind == Kind::Word => match crate::number::double(text) {
            Some(v) => {
                list.push(v);
                return true;
            }
            None => "a number",
        },
        Values::Singles(list) if token.kind == Kind::Word => match crate::number::double(text) {
            Some(v) => {
                list.push(v as f32);
                return true;
            }
            None => "a number",
        },
        Values::Strings(_) => "a string in quotes",
        _ => "a number",
    };
    let message = format!("expected {wanted}, found `{}`", suggest::brief(text));
    d.push(Diagnostic::error(token.span, message));
    false
}
