//! From a description to a world: names become indices, trees become flat arrays, shapes move to world space.
//!
//! Groups are dissolved: their transforms are multiplied in double precision into their children. Only an `instance` of
//! a named object stays what it is, one shared copy with a transform, and even that is dissolved when the object
//! glows, so that every light stands in world space.

mod camera;
mod focus;
mod lights;
mod look;
mod place;

use crate::filter::{Filter, Gaussian};
use crate::material::CustomMaterial;
use crate::shape::CustomShape;
use crate::world::World;
use std::sync::Arc;
use straal_accel as accel;
use straal_scene::desc;
use straal_scene::span::Span;
use straal_scene::{Assets, Scene};

/// Why a description has no world. Validation finds nearly all of this earlier, with better words.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct CompileError {
    /// What is wrong.
    pub message: String,
    /// Where the description says it, as far as that is known.
    pub span: Span,
}

impl CompileError {
    fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), span: Span::NONE }
    }

    fn at(message: impl Into<String>, span: Span) -> Self {
        Self { message: message.into(), span }
    }
}

/// What a program adds to a description.
#[derive(Clone, Debug, Default)]
pub struct Custom {
    /// Shapes that stand in the world, each with a material (by the scene's name for it).
    pub shapes: Vec<(Arc<dyn CustomShape>, String)>,
    /// Materials by name, for `shapes` and for what the description makes of the material it has by that name.
    pub materials: Vec<(String, Arc<dyn CustomMaterial>)>,
}

/// Makes the world of a description for a picture of `size` pixels.
pub fn compile(
    scene: &Scene,
    assets: &Assets,
    custom: &Custom,
    size: [u32; 2],
    search: &accel::Options,
) -> Result<World, CompileError> {
    let mut build = place::Build::new(scene, assets, custom)?;
    build.world()?;
    build.custom_shapes(custom)?;
    let place::Built { input, geometry, looks, instance_materials, top_level, named, glowing, materials } =
        build.finish();

    let seen = focus::Seen { input: &input, geometry: &geometry, named: &named };
    let camera = camera::camera(scene, size, &seen)?;
    let accel =
        accel::Scene::build(input, &geometry, search).map_err(|e| CompileError::new(e.to_string()))?;
    let lights = lights::gather(scene, assets, &geometry, glowing, &accel)?;
    Ok(World {
        camera,
        filter: filter(&scene.film.filter)?,
        geometry,
        accel,
        materials,
        emitters: lights.emitters,
        lights: lights.table,
        looks,
        instance_materials,
        top_level,
        environments: lights.environments,
    })
}

fn filter(filter: &desc::Filter) -> Result<Filter, CompileError> {
    match filter {
        desc::Filter::Box => Ok(Filter::Box),
        desc::Filter::Gaussian(g) => Gaussian::new(g.radius, g.sigma)
            .map(Filter::Gaussian)
            .ok_or_else(|| CompileError::new("the Gaussian filter is empty: its `sigma` is too small")),
    }
}
