//! Lights: those of the scene's list, and the surfaces that glow.

use super::CompileError;
use super::paint::Paint;
use super::place::Glowing;
use crate::camera::CubeLayout;
use crate::light::cube::latitude_longitude;
use crate::light::spot::Cone;
use crate::light::{
    AreaLight, ConstantEnvironment, DirectionalLight, Emitter, Falloff, ImageEnvironment, LightTable,
    LitSurface, PointLight, Sides, SpotLight,
};
use crate::shape::Geometry;
use crate::world::Kind;
use straal_accel as accel;
use straal_math::{Affine, DVec3};
use straal_scene::desc::{self, Light};
use straal_scene::{Scene, value};

/// Everything that shines, how to choose among it, and what of it is all around.
pub(super) struct Lights {
    pub emitters: Vec<Emitter>,
    pub table: LightTable,
    pub environments: Vec<u32>,
}

/// What lights shine on.
pub(super) struct Around<'a> {
    pub geometry: &'a Geometry,
    pub search: &'a accel::Scene,
    /// What of the description lies at the origin.
    pub centre: DVec3,
}

/// The glowing surfaces come first, so that their indices are those that the walk over the world gave them.
pub(super) fn gather(
    scene: &Scene,
    paint: &mut Paint<'_>,
    around: Around<'_>,
    glowing: Vec<Glowing>,
) -> Result<Lights, CompileError> {
    let Around { geometry, search, centre } = around;
    let mut emitters = Vec::with_capacity(glowing.len() + scene.lights.len());
    for g in &glowing {
        emitters.push(area(g, geometry));
    }
    for light in &scene.lights {
        emitters.push(emitter(light, paint, centre)?);
    }
    let bounds = search.bounds();
    // Only for the choice of lights: how far parallel light and surroundings reach.
    let radius = if bounds.is_empty() { 1.0 } else { 0.5 * f64::from(bounds.extent().length()) };
    let table = LightTable::new(&emitters, geometry, radius);
    let environments =
        (0..emitters.len() as u32).filter(|&i| emitters[i as usize].is_environment()).collect();
    Ok(Lights { emitters, table, environments })
}

fn area(g: &Glowing, geometry: &Geometry) -> Emitter {
    let surface = match g.kind {
        Kind::Mesh(mesh) => LitSurface::mesh(geometry, mesh),
        Kind::Shapes(shape) => LitSurface::Shape(shape),
    };
    let sides = match (g.two_sided, g.flip) {
        (true, _) => Sides::Both,
        (false, true) => Sides::Back,
        (false, false) => Sides::Front,
    };
    Emitter::Area(AreaLight { surface, radiance: g.radiance.into(), sides })
}

fn emitter(light: &Light, paint: &mut Paint<'_>, centre: DVec3) -> Result<Emitter, CompileError> {
    Ok(match light {
        Light::Point(l) => Emitter::Point(PointLight {
            position: (l.position - centre).as_vec3(),
            intensity: paint.emission(l.intensity.get())?.into(),
        }),
        Light::Directional(l) => Emitter::Directional(
            DirectionalLight::new(l.axis().as_vec3(), paint.emission(l.irradiance.get())?)
                .ok_or_else(|| CompileError::new("the direction of a directional light has no length"))?,
        ),
        Light::Spot(l) => {
            let cone = Cone {
                axis: l.axis().as_vec3(),
                beam: l.full_beam(),
                cutoff: l.cutoff,
                falloff: match l.falloff {
                    desc::Falloff::Linear => Falloff::Linear,
                    desc::Falloff::Smooth => Falloff::Smooth,
                },
            };
            let spot =
                SpotLight::new((l.position - centre).as_vec3(), paint.emission(l.intensity.get())?, &cone);
            Emitter::Spot(spot.ok_or_else(|| CompileError::new("the axis of a spot light has no length"))?)
        }
        Light::Environment(l) => environment(l, paint)?,
    })
}

fn environment(l: &desc::Environment, paint: &mut Paint<'_>) -> Result<Emitter, CompileError> {
    let Some(asset) = &l.file else {
        let black = desc::Spectrum::grey(0.0);
        let radiance = l.radiance.as_ref().map_or(&black, value::Value::get);
        let radiance = paint.emission_times(radiance, l.scale)?.into();
        return Ok(Emitter::Constant(ConstantEnvironment { radiance }));
    };
    let (file, image) = (&asset.file, paint.assets().image(asset.handle));
    let cube = match l.layout {
        desc::EnvironmentLayout::LatitudeLongitude => None,
        desc::EnvironmentLayout::Cross => Some(CubeLayout::Cross),
        desc::EnvironmentLayout::Row => Some(CubeLayout::Row),
    };
    let unfolded = cube.map(|layout| latitude_longitude(image, layout)).transpose();
    let unfolded = unfolded.map_err(|message| CompileError::at(message, file.span))?;
    let image = unfolded.as_ref().unwrap_or(image);
    // The scene language has the middle column along -z, the emitter its left edge: half a turn.
    let placed = Affine::rotate(DVec3::Y, 180.0 + l.rotate)
        .zip(l.transform.affine())
        .map(|(turn, own)| turn.then(&own))
        .ok_or_else(|| CompileError::at("this transform is singular", l.transform.span))?;
    let map = ImageEnvironment::new(&paint.surroundings(file, image), l.scale as f32, &placed);
    let map = map
        .ok_or_else(|| CompileError::at(format!("the picture `{}` has no pixels", file.value), file.span))?;
    Ok(Emitter::Image(Box::new(map)))
}
