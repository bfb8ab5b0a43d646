//! How values are read that have names, so that the help lists them and a wrong one is answered with the nearest.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use std::marker::PhantomData;
use std::str::FromStr;
use straal::Guides;
use straal::denoise::Effort;
use straal::picture::Format;
use straal::search;
use straal_accel::{Build, Isa, Structure};
use straal_color::spectrum::Observer;
use straal_math::lowdisc::PatternKind;
use straal_scene::desc::{Denoise, Integrator};
use straal_study::cost;

/// A parser of names that lists them in the help and, for a wrong one, suggests the nearest.
pub(super) fn named<T: Clone + Send + Sync + 'static>(
    all: Vec<(&'static str, T)>,
) -> impl TypedValueParser<Value = T> {
    let names: Vec<_> = all.iter().map(|(name, _)| *name).collect();
    PossibleValuesParser::new(names).try_map(move |typed| {
        let found = all.iter().find(|(name, _)| *name == typed);
        found.map(|(_, value)| value.clone()).ok_or("no such name")
    })
}

pub(super) fn observer() -> impl TypedValueParser<Value = Observer> {
    named(vec![("2", Observer::Cie1931), ("10", Observer::Cie1964)])
}

pub(super) fn integrator() -> impl TypedValueParser<Value = Integrator> {
    named(Integrator::KINDS.iter().filter_map(|kind| Some((*kind, Integrator::bare(kind)?))).collect())
}

pub(super) fn pattern() -> impl TypedValueParser<Value = PatternKind> {
    named(PatternKind::ALL.map(|k| (k.name(), k)).to_vec())
}

/// Reads what has a name that may be followed by more; the help lists the names.
#[derive(Clone)]
pub(super) struct Listed<T> {
    names: Vec<&'static str>,
    is: PhantomData<fn() -> T>,
}

impl<T> Listed<T> {
    pub(super) fn new<const N: usize>(names: [&'static str; N]) -> Self {
        Self { names: names.to_vec(), is: PhantomData }
    }
}

impl<T: FromStr<Err = straal_color::ParseError> + Clone + Send + Sync + 'static> TypedValueParser
    for Listed<T>
{
    type Value = T;

    fn parse_ref(
        &self,
        command: &clap::Command,
        arg: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<T, clap::Error> {
        // A plain name goes by the list, so that a wrong one is answered with the nearest.
        let is_plain = !value.to_string_lossy().contains(':');
        if is_plain {
            PossibleValuesParser::new(self.names.clone()).parse_ref(command, arg, value)?;
        }
        (|text: &str| text.parse::<T>()).parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.names.iter().map(PossibleValue::new)))
    }
}

/// Reads a search structure with its parameters; the help lists the names.
#[derive(Clone)]
pub(super) struct StructureParser;

impl TypedValueParser for StructureParser {
    type Value = Structure;

    fn parse_ref(
        &self,
        command: &clap::Command,
        arg: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<Structure, clap::Error> {
        search::parse.parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(search::NAMES.iter().map(PossibleValue::new)))
    }
}

pub(super) fn build() -> impl TypedValueParser<Value = Build> {
    named(Build::ALL.map(|b| (b.name(), b)).to_vec())
}

pub(super) fn measure() -> impl TypedValueParser<Value = cost::Measure> {
    named(cost::Measure::ALL.map(|m| (m.name(), m)).to_vec())
}

pub(super) fn picture_format() -> impl TypedValueParser<Value = Format> {
    named(Format::ALL.map(|f| (f.name(), f)).to_vec())
}

pub(super) fn denoise() -> impl TypedValueParser<Value = Denoise> {
    named(vec![("best", Denoise::Best), ("fast", Denoise::Fast), ("off", Denoise::Off)])
}

pub(super) fn guides() -> impl TypedValueParser<Value = Guides> {
    named(Guides::ALL.map(|g| (g.name(), g)).to_vec())
}

pub(super) fn effort() -> impl TypedValueParser<Value = Effort> {
    named(Effort::ALL.map(|e| (e.name(), e)).to_vec())
}

pub(super) fn isa() -> impl TypedValueParser<Value = Isa> {
    named(Isa::ALL.map(|i| (i.name(), i)).to_vec())
}
