//! From a description to a world: names become indices, trees become flat arrays, shapes move to world space.
//!
//! Groups are dissolved: their transforms are multiplied in double precision into their children. Only an `instance` of
//! a named object stays what it is, one shared copy with a transform, and even that is dissolved where the material around it makes
//! surfaces shine that have none of their own, or has holes.

mod build;
mod camera;
mod doubts;
mod dropped;
mod focus;
mod lights;
mod materials;
mod meshes;
mod place;
mod round;
mod solids;

pub use build::GLOWING_BYTES;

use crate::film::{Recording, Sensor};
use crate::filter::{Filter, Profile, Separable};
use crate::light::Copies;
use crate::material::CustomMaterial;
use crate::shape::CustomShape;
use crate::surface::Alike;
use crate::texture::Texture;
use crate::world::World;
use std::sync::Arc;
use straal_accel::{self as accel, BuildError};
use straal_math::DVec3;
use straal_scene::desc;
use straal_scene::{Assets, Scene};

/// What a program adds to a description.
#[derive(Clone, Debug, Default)]
pub struct Custom {
    /// Shapes that stand in the world, each with a material (by the scene's name for it).
    pub shapes: Vec<(Arc<dyn CustomShape>, String)>,
    /// Materials by name, for `shapes` and for what the description makes of the material it has by that name.
    pub materials: Vec<(String, Arc<dyn CustomMaterial>)>,
}

impl Custom {
    /// The first name of a material that a shape has and nothing goes by.
    pub fn unknown_material(&self, scene: &Scene) -> Option<&str> {
        let is_known = |name: &str| {
            scene.materials.get(name).is_some() || self.materials.iter().any(|(known, _)| known == name)
        };
        self.shapes.iter().map(|(_, name)| name.as_str()).find(|name| !is_known(name))
    }
}

/// What a world is made of.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// What the scene says.
    pub scene: &'a Scene,
    /// The files it names.
    pub assets: &'a Assets,
    /// What a program adds.
    pub custom: &'a Custom,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// How rays are searched.
    pub search: &'a accel::Options,
    /// Whether light is computed by wavelengths.
    pub spectral: bool,
    /// In which numbers the film takes light.
    pub recording: Recording,
    /// How finely curved surfaces are made.
    pub detail: Detail,
}

/// How finely curved surfaces are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// As the scene says.
    #[default]
    Whole,
    /// Coarsely, but for what the camera is focused on: enough to find what is wrong with a scene.
    Draft,
}

/// Makes the world of a description, which can't fail where that has been validated; only the search structure may be refused.
pub fn compile(request: &Request<'_>) -> Result<World, BuildError> {
    compile_after(None, request)
}

/// The same, after a world of which much may have stayed, as after the frame before: search structures of objects that are made of the
/// same triangles are taken over. The world is that of [`compile`].
pub fn compile_after(before: Option<World>, request: &Request<'_>) -> Result<World, BuildError> {
    let mut world = compile_about(before.map(|world| world.accel), request, DVec3::ZERO)?;
    // A program's own shapes stand where they stand.
    if let Some(centre) = doubts::far_away(world.accel.bounds()).filter(|_| request.custom.shapes.is_empty())
    {
        let before = world.accel;
        world = compile_about(Some(before), request, centre)?;
    }
    let mut notes = std::mem::take(&mut world.notes);
    let eye = request.scene.camera.observer().keyframes().first().map_or(DVec3::ZERO, |m| m.eye);
    doubts::depth(world.accel.bounds(), eye - world.centre, &mut notes);
    // Rays from the lamps go through glass.
    if !matches!(request.scene.integrator, desc::Integrator::Light(_)) {
        doubts::lights_behind_glass(&world, request.detail == Detail::Draft, &mut notes);
    }
    world.notes = notes;
    Ok(world)
}

/// The same with a place of the description at the origin.
fn compile_about(
    before: Option<accel::Scene>,
    request: &Request<'_>,
    centre: DVec3,
) -> Result<World, BuildError> {
    let Request { scene, assets, custom, size, search, spectral, recording, detail } = *request;
    let mut build = build::Build::new(scene, assets, custom, (spectral, detail), centre);
    build.world();
    build.custom_shapes(custom);
    let build::Built {
        input,
        geometry,
        mut geometries,
        nodes,
        left_out,
        objects,
        instance_materials,
        top_level,
        named,
        glowing,
        materials,
        placements,
        mut paint,
        light_groups,
        names,
        mut linked,
    } = build.finish();
    if names.matter() {
        linked.find_classes(&input);
    }

    let seen = focus::Seen { input: &input, geometry: &geometry, named: &named };
    let (camera, out_of_focus) = camera::camera(scene, size, &seen, centre);
    let stand_in: Vec<u32> = glowing.iter().map(|g| g.group).collect();
    let copies = Copies::new(&input.groups, &stand_in);
    let accel = accel::Scene::build_after(before, input, &geometry, search)?;
    let dropped = dropped::tell(accel.dropped(), &nodes, &left_out, &objects);
    let lights = lights::gather(
        scene,
        &mut paint,
        lights::Around { geometry: &geometry, search: &accel, centre },
        (glowing, copies),
        light_groups,
        (&names, linked),
    );
    Alike::tell(&mut geometries, &geometry, &materials);
    let sensor = Sensor::new(recording, scene.color.space.space(), &paint.spectra);
    Ok(World {
        camera,
        out_of_focus,
        filter: filter(&scene.film.filter),
        geometry,
        accel,
        materials,
        draws_texels: paint.textures.iter().any(Texture::draws),
        textures: paint.textures,
        tables: paint.spectra,
        sensor,
        emitters: lights.emitters,
        lights: lights.table,
        light_groups: lights.groups,
        links: lights.links,
        lamps_of_zones: lights.of_zones,
        unseen: lights.unseen,
        ears: None,
        copies: lights.copies,
        geometries,
        placements,
        instance_materials,
        top_level,
        environments: lights.environments,
        ambient: lights.ambient,
        centre,
        notes: paint.notes,
        dropped,
    })
}

fn filter(filter: &desc::Filter) -> Filter {
    let (profile, radius) = match filter {
        desc::Filter::Box => return Filter::Box,
        desc::Filter::Tent(f) => (Profile::Tent, f.radius),
        desc::Filter::Gaussian(f) => (Profile::Gaussian { sigma: f.sigma }, f.radius),
        desc::Filter::Mitchell(f) => (Profile::Mitchell { b: f.b, c: f.c }, f.radius),
        desc::Filter::BlackmanHarris(f) => (Profile::BlackmanHarris, f.radius),
        desc::Filter::Lanczos(f) => (Profile::Lanczos, f.radius),
    };
    // Validation has seen that it isn't empty.
    Separable::new(profile, radius).map_or(Filter::Box, Filter::Separable)
}
