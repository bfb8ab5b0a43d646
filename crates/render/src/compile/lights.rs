//! Lights: those of the scene's list, and the surfaces that glow.

use super::build::Glowing;
use crate::light::area::Spread;
use crate::light::links::{Linked, Links, Names};
use crate::light::{
    AmbientLight, AreaLight, Copies, Emitter, Groups, LightTable, LitSurface, Portals, Sides, SunDisc, Within,
};
use crate::paint::Paint;
use crate::shape::Geometry;
use crate::world::Kind;
use straal_accel as accel;
use straal_math::DVec3;
use straal_scene::{Scene, desc};

/// Everything that shines, how to choose among it, and what of it is all around.
pub(super) struct Lights {
    pub emitters: Vec<Emitter>,
    pub table: LightTable,
    pub copies: Copies,
    pub environments: Vec<u32>,
    pub ambient: Vec<(AmbientLight, u32)>,
    pub groups: Groups,
    pub links: Links,
    pub unseen: Vec<u32>,
    /// Those that go by the name of the lamp whose zones of shadow are shown.
    pub of_zones: Vec<u32>,
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
    (glowing, mut copies): (Vec<Glowing>, Copies),
    mut groups: Groups,
    (names, linked): (&Names<'_>, Linked),
) -> Lights {
    let Around { geometry, search, centre } = around;
    let mut emitters = Vec::with_capacity(glowing.len() + scene.lights.len());
    let (mut said, mut unseen, mut of_zones) = (Vec::new(), Vec::new(), Vec::new());
    for g in &glowing {
        of_zones.extend(g.is_of_zones.then_some(emitters.len() as u32));
        unseen.extend((!g.seen).then_some(emitters.len() as u32));
        emitters.push(area(g, geometry));
        groups.belong(emitters.len(), g.light_group);
        said.push(g.said);
    }
    for light in &scene.lights {
        let emitter = Emitter::of(light, paint, centre);
        emitters.push(Portals::around(emitter, light.portals(), paint, centre));
        if let desc::Light::Sky(sky) = light {
            emitters.extend(SunDisc::of_sky(sky, paint));
        }
        if !light.lamp().seen {
            unseen.extend(said.len() as u32..emitters.len() as u32);
        }
        if light.name().is_some_and(|name| scene.lamp_of_zones().is_some_and(|lamp| **lamp == **name)) {
            of_zones.extend(said.len() as u32..emitters.len() as u32);
        }
        let group = groups.number(light.lamp().light_group.as_ref());
        groups.belong(emitters.len(), group);
        said.resize(emitters.len(), names.said(light.lamp()));
    }
    let bounds = search.bounds();
    // Only for the choice of lights: how far parallel light and surroundings reach.
    let radius = if bounds.is_empty() { 1.0 } else { 0.5 * f64::from(bounds.extent().length()) };
    copies.complete(emitters.len());
    let within = Within { copies: &copies, search: Some(search) };
    let table = LightTable::within(&emitters, geometry, radius, within);
    let links = Links::new(&said, linked, (&emitters, geometry, radius), within);
    let environments =
        (0..emitters.len() as u32).filter(|&i| emitters[i as usize].is_environment()).collect();
    let ambient = (0..).zip(&emitters).filter_map(|(i, e)| match e {
        Emitter::Ambient(light) => Some((*light, i)),
        _ => None,
    });
    let ambient = ambient.collect();
    Lights { emitters, table, copies, environments, ambient, groups, links, unseen, of_zones }
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
    let placement = g.placement.map(Box::new);
    Emitter::Area(AreaLight {
        surface,
        spread: Spread::degrees(g.spread),
        radiance: g.radiance,
        opacity: g.opacity,
        below: g.below.clone(),
        sides,
        placement,
    })
}
