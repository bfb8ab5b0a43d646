//! Scenes of Mitsuba: version 3, and what is left of 0.5 and 0.6 in the same words.
//!
//! A scene is a tree of *objects* (shapes, BSDFs, lights...), each of a *plugin* with properties by name. [`xml`] makes that tree of
//! one or several files: it includes, puts values for `$names`, gives old names their present form and leads references. Then the objects are
//! translated, kind by kind, as `translate.rs` and the files beside it have it; `../../../../book/src/mitsuba.md` tells what becomes of what.
//!
//! Conventions that differ are settled where they are met: uv of shapes and pictures in `uv.rs`, the sensor's axes in `sensor.rs`, surroundings in
//! `emitter.rs`, one-sided BSDFs in `bsdf.rs`.

mod bsdf;
mod curve;
mod distance;
mod ellipsoids;
mod emitter;
mod heights;
mod integrator;
mod kinds;
mod medium;
mod search;
mod sensor;
mod serialized;
mod shape;
mod spectrum;
mod texture;
mod transform;
mod translate;
mod tree;
mod uv;
mod xml;

#[cfg(test)]
mod tests;

use super::{Means, Translated};

/// Reads one.
pub(super) fn read(name: &str, bytes: &[u8], means: &mut Means<'_>) -> Option<Translated> {
    let tree = xml::read(name, bytes, means)?;
    translate::translate(tree, means)
}
