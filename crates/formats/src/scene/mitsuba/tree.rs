//! A scene as its files tell it: objects with properties.

use std::path::PathBuf;

use straal_math::Affine;
use straal_scene::{Span, Spanned};

/// What an object is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Class {
    Scene,
    Shape,
    Bsdf,
    Emitter,
    Sensor,
    Film,
    Sampler,
    Filter,
    Integrator,
    /// A texture or a spectrum.
    Texture,
    Medium,
    Volume,
    Phase,
    Subsurface,
}

impl Class {
    /// By the name of its element: that of version 3 first, and older ones.
    pub fn of(tag: &str) -> Option<Self> {
        Some(match tag {
            "scene" => Self::Scene,
            "shape" => Self::Shape,
            "bsdf" => Self::Bsdf,
            "emitter" | "luminaire" => Self::Emitter,
            "sensor" | "camera" => Self::Sensor,
            "film" => Self::Film,
            "sampler" => Self::Sampler,
            "rfilter" => Self::Filter,
            "integrator" => Self::Integrator,
            "texture" => Self::Texture,
            "medium" => Self::Medium,
            "volume" => Self::Volume,
            "phase" => Self::Phase,
            "subsurface" => Self::Subsurface,
            _ => return None,
        })
    }

    /// What messages call one.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Shape => "shape",
            Self::Bsdf => "bsdf",
            Self::Emitter => "emitter",
            Self::Sensor => "sensor",
            Self::Film => "film",
            Self::Sampler => "sampler",
            Self::Filter => "rfilter",
            Self::Integrator => "integrator",
            Self::Texture => "texture",
            Self::Medium => "medium",
            Self::Volume => "volume",
            Self::Phase => "phase",
            Self::Subsurface => "subsurface",
        }
    }
}

/// A spectrum that is told by numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Numbers {
    /// The same at all wavelengths.
    Uniform(f64),
    /// Wavelengths in nm, and the value at each.
    Table(Vec<f64>, Vec<f64>),
    /// In a file of such lines.
    File(String),
    /// Kelvins, and what its radiance is multiplied by.
    BlackBody(f64, f64),
}

/// What a property is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Float(f64),
    Integer(i64),
    Boolean(bool),
    Text(String),
    Vector([f64; 3]),
    Rgb([f64; 3]),
    Spectrum(Numbers),
    Transform(Affine),
    /// Transforms by rising times.
    Motion(Vec<(f64, Affine)>),
    /// An object, by its place in the tree.
    Object(usize),
    /// An object by its name, until references are led.
    Reference(String),
}

/// A property.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Property {
    /// Empty for objects that stand without one.
    pub name: String,
    pub value: Value,
    /// Where its value is.
    pub span: Span,
}

/// An object.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Object {
    pub class: Class,
    /// Which of its class it is, as its `type` says, and where.
    pub plugin: Spanned<String>,
    pub id: Option<String>,
    pub properties: Vec<Property>,
    /// Whether its file is of a version before 2, whose defaults are others.
    pub is_old: bool,
    /// Which of the tree's folders its file lies in.
    pub folder: usize,
}

impl Object {
    /// A property by its name.
    pub fn get(&self, name: &str) -> Option<&Property> {
        self.properties.iter().find(|p| p.name == name)
    }

    /// Whether there is one.
    pub fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    /// The objects in it, with the names by which they stand there.
    pub fn objects(&self) -> impl Iterator<Item = (&Property, usize)> {
        self.properties.iter().filter_map(|p| match p.value {
            Value::Object(i) => Some((p, i)),
            _ => None,
        })
    }
}

/// All of it.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// The scene is the first; what an object is made of comes behind it, or is referred to.
    pub objects: Vec<Object>,
    /// Folders of the files that were read, the scene's own first.
    pub folders: Vec<PathBuf>,
    /// Folders that the scene says its files are in.
    pub paths: Vec<PathBuf>,
    /// What was read besides the scene's own file.
    pub files: Vec<(PathBuf, String, [u8; 32])>,
    /// Bytes of all texts.
    pub text_bytes: u64,
}
