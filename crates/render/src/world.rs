//! The world: a scene ready for rays. Flat arrays and indices, read-only while rays fly.

use crate::camera::{Camera, OutOfFocus};
use crate::film::Sensor;
use crate::filter::Filter;
use crate::footprint::{Bend, PackedFootprint};
use crate::integrator::{AnyIntegrator, Ears, Roulette};
use crate::lanes::{Lanes, Rgb, SpectralTables};
use crate::light::links::{Class, Links};
use crate::light::table::Picks;
use crate::light::{
    AmbientLight, AreaLight, Ball, Copies, Emitted, Emitter, Groups, LightSample, LightTable, LitSurface,
    Pick, Receiver, Within,
};
use crate::material::shaded::shading_normal;
use crate::material::{Bsdf, BsdfSample, Material, Materials};
use crate::probe::AskedShadows;
use crate::relief::Ways;
use crate::shape::{Geometry, Shape, ShapeHit, SurfacePoint, Tangents, TriangleMesh};
use crate::surface::{Alike, Surface, frame_along};
use crate::texture::{OnMesh, Place, Reading, Readings, ShadingPoint, Texture, own_normal};
use std::ops::Range;
use straal_accel as accel;
use straal_accel::Hit;
use straal_color::Light;
use straal_math::simd::{Float, Mask, Simd, Uint};
use straal_math::table::Table1;
use straal_math::{DVec3, Frame, Ray, Transform, Vec3, ops};
use straal_scene::Span;

/// No material of its own: the innermost instance that has one gives it.
pub(crate) const INHERIT: u32 = u32::MAX;

/// The thing's own coordinates are those of its group, or nobody asks for them.
pub(crate) const UNPLACED: u32 = u32::MAX;

/// Masks that a ray is led through; what lies behind more of them isn't seen.
const MOST_MASKS: usize = 1 << 16;

/// What a geometry of the search structure is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// Index into [`Geometry::meshes`].
    Mesh(u32),
    /// First index into [`Geometry::shapes`].
    Shapes(u32),
}

/// What shading must know of a geometry of the search structure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GeometryRecord {
    pub kind: Kind,
    /// Index into the world's materials, or [`INHERIT`].
    pub material: u32,
    /// Index into [`World::emitters`].
    pub emitter: Option<u32>,
    /// Whether what it emits differs from point to point.
    pub emission_varies: bool,
    /// Front and back are swapped.
    pub flip: bool,
    /// Light is scattered at the corners of triangles, and colours lie between.
    pub colours_at_corners: bool,
    /// Index into [`World::placements`], or [`UNPLACED`].
    pub placement: u32,
    /// With which others its surfaces may be computed, where it stands in the world itself.
    pub alike: Alike,
}

/// Bytes that a mesh, or a run of shapes, takes among what search and shading know of all.
pub const GEOMETRY_BYTES: usize = size_of::<accel::Geometry>() + size_of::<GeometryRecord>() + RANK_BYTES;

/// And for the order in which a render works on surfaces.
const RANK_BYTES: usize = size_of::<u32>();

/// What a node at the top of the world became: ranges of what stands in the world's own group
/// (`accel::Input::groups[0]`).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TopLevel {
    /// Of the group's geometries.
    pub geometries: Range<usize>,
    /// Of the group's instances.
    pub instances: Range<usize>,
}

/// A scene ready for rays.
pub struct World {
    /// Who looks.
    pub camera: Camera,
    /// Why the camera is focused on what it looks at, where it should be on something by name.
    pub out_of_focus: Option<OutOfFocus>,
    /// How samples lie around a pixel.
    pub filter: Filter,
    /// All surfaces.
    pub geometry: Geometry,
    /// What finds them.
    pub accel: accel::Scene,
    /// Materials; the first is that of surfaces without one.
    pub materials: Materials,
    /// What their values are read off.
    pub textures: Vec<Texture>,
    /// Whether any of these draws texels: then vertices need numbers for it.
    pub draws_texels: bool,
    /// Spectra of the colours, when light is computed by wavelengths.
    pub tables: SpectralTables,
    /// What the film sees of light.
    pub sensor: Sensor,
    /// All that emits light.
    pub emitters: Vec<Emitter>,
    /// Which emitter to sample.
    pub lights: LightTable,
    /// Which of them belong together.
    pub light_groups: Groups,
    /// What lights what, where that isn't all.
    pub(crate) links: Links,
    /// The emitters that go by the name of the lamp whose zones of shadow are shown.
    pub(crate) lamps_of_zones: Vec<u32>,
    /// Emitters that the camera doesn't see, by rising index.
    pub(crate) unseen: Vec<u32>,
    /// What ways on from its surfaces bring and cost, where an integrator asks for it: see [`World::learn`].
    pub(crate) ears: Option<Ears>,
    /// Which emitters stand in objects, and shine wherever these do.
    pub copies: Copies,
    /// By geometry of the search structure.
    pub(crate) geometries: Vec<GeometryRecord>,
    /// Where things' own coordinates lie in those of their groups.
    pub(crate) placements: Vec<Transform>,
    /// By instance of the search structure: a material for what has none inside, or [`INHERIT`].
    pub(crate) instance_materials: Vec<u32>,
    /// What each node at the top of the description's world (`Scene::top_level`) became, in its order; a program's own shapes come after.
    pub top_level: Vec<TopLevel>,
    /// Emitters that surround the scene.
    pub(crate) environments: Vec<u32>,
    /// What surfaces send back their share of wherever they are, and which emitter it is.
    pub(crate) ambient: Vec<(AmbientLight, u32)>,
    /// What of the description's space lies at the world's origin: other than 0 for scenes that lie far from theirs.
    pub centre: DVec3,
    /// What its author should know of how the description was understood.
    pub notes: Vec<String>,
    /// What can never be hit and was left out.
    pub dropped: Vec<Dropped>,
}

/// The bit of what the camera sees, in the masks of rays and surfaces.
pub(crate) const CAMERA: u32 = 1;

/// Something of the description that can never be hit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dropped {
    /// How many triangles, shapes or instances.
    pub count: usize,
    /// What and why, as a sentence without a full stop.
    pub message: String,
    /// Where the description says it, as far as that is known.
    pub span: Span,
}

/// The share of light that passes along a ray towards a lamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Passing {
    /// Of that lamp: past what casts no shadow of it.
    pub of_lamp: f32,
    /// Past everything that is in the way, as rays that scatter find it; no more than of the lamp.
    pub all: f32,
}

impl Passing {
    /// Nothing is in the way.
    pub const ALL: Self = Self { of_lamp: 1.0, all: 1.0 };
    /// Nothing passes.
    pub const NONE: Self = Self { of_lamp: 0.0, all: 0.0 };

    /// What counts of a point on the lamp: by its weight beside rays that scatter, but whole where these can't come.
    #[inline]
    pub fn counts(self, weight: f32) -> f32 {
        (self.of_lamp - self.all) + self.all * weight
    }
}

impl World {
    /// By which instruction set shading works: the one that search was told to.
    pub fn simd(&self) -> Simd {
        Simd::new(self.accel.isa()).unwrap_or(Simd::PLAIN)
    }

    /// Learns what an integrator must know of it besides, for a picture of that size: by paths of its own, the same whatever the picture's seed and samples.
    pub fn learn(&mut self, integrator: &AnyIntegrator, size: [u32; 2]) {
        self.ears = match integrator {
            AnyIntegrator::Path(path) if path.roulette == Roulette::Ears => {
                Some(Ears::learn(self, path, size))
            }
            _ => None,
        };
    }

    /// Puts another material in the place of one that is there.
    pub fn replace_material(&mut self, index: u32, material: Material) {
        self.materials.replace(index, material);
        Alike::tell(&mut self.geometries, &self.geometry, &self.materials);
    }

    /// What each ray hits first.
    pub fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.accel.closest(&self.geometry, rays, hits);
    }

    /// A ball that holds all that has bounds.
    pub fn ball(&self) -> Ball {
        let bounds = self.accel.bounds();
        if bounds.is_empty() {
            return Ball { center: Vec3::ZERO, radius: 1.0 };
        }
        // A little more, for rounding.
        let radius = 0.501 * bounds.extent().length();
        Ball { center: bounds.center(), radius: if radius > 0.0 { radius } else { 1.0 } }
    }

    /// The share of light that passes along each ray, in four lanes: all or nothing, since every material stops a
    /// shadow ray, glass as well (its light is found by paths that go through it); but masks let a part of it through, and what casts no shadow
    /// of the lamp all of it. Where there are none, whether rays are blocked says all, and `out` is left empty.
    pub fn transmittance(
        &self,
        AskedShadows { shadows, rays }: &AskedShadows<'_>,
        blocked: &mut Vec<bool>,
        out: &mut Vec<Light>,
    ) {
        blocked.clear();
        blocked.resize(rays.len(), false);
        self.accel.occluded(&self.geometry, rays, blocked);
        out.clear();
        if self.any_may_pass() {
            out.extend(blocked.iter().zip(*shadows).zip(*rays).map(|((&blocked, shadow), ray)| {
                let passing = match blocked {
                    true => self.past_masks(ray, |ray| self.closest_of(ray)),
                    false => Passing::ALL,
                };
                Light::splat(passing.counts(shadow.weight()))
            }));
        }
    }

    /// Whether a shadow ray may go on behind what it meets.
    #[inline]
    pub(crate) fn any_may_pass(&self) -> bool {
        self.materials.any_may_pass() || self.links.shadows_matter()
    }

    /// What a single ray hits first.
    pub(crate) fn closest_of(&self, ray: &Ray) -> Hit {
        let mut hit = [Hit::MISS];
        self.closest(std::slice::from_ref(ray), &mut hit);
        hit[0]
    }

    /// The share of light that passes along a single ray, as [`Self::transmittance`] has it.
    pub(crate) fn passes(&self, ray: &Ray) -> Passing {
        let mut blocked = [false];
        self.accel.occluded(&self.geometry, std::slice::from_ref(ray), &mut blocked);
        match blocked {
            [false] => Passing::ALL,
            [true] if self.any_may_pass() => self.past_masks(ray, |ray| self.closest_of(ray)),
            [true] => Passing::NONE,
        }
    }

    /// The share of light that passes along a shadow ray that meets something, if all that it meets are masks or cast no shadow of its lamp.
    #[cold]
    pub(crate) fn past_masks(&self, ray: &Ray, mut closest: impl FnMut(&Ray) -> Hit) -> Passing {
        let (mut ray, mut passing) = (*ray, Passing::ALL);
        for _ in 0..MOST_MASKS {
            let hit = closest(&ray);
            if !hit.is_hit() {
                return passing;
            }
            let passes = 1.0 - self.opacity(&ray, &hit);
            passing.all *= passes;
            if self.links.cast(&ray, &hit) {
                passing.of_lamp *= passes;
            }
            if passing.of_lamp <= 0.0 {
                break;
            }
            ray.t_min = hit.t.next_up();
        }
        Passing::NONE
    }

    /// Leads a ray past masks, with what it hit first, as far as a number in [0, 1) says: to where less than that share of light is left.
    #[cold]
    pub(crate) fn go_past_masks(
        &self,
        ray: &Ray,
        hit: &mut Hit,
        u: f32,
        mut closest: impl FnMut(&Ray) -> Hit,
    ) {
        let (mut ray, mut left) = (*ray, 1.0);
        for _ in 0..MOST_MASKS {
            if !hit.is_hit() {
                return;
            }
            left *= 1.0 - self.opacity(&ray, hit);
            if u >= left {
                return;
            }
            // The same ray from just beyond, so that distances are those from where it started.
            ray.t_min = hit.t.next_up();
            *hit = closest(&ray);
        }
    }

    /// Whether what a ray hit may let it pass.
    #[inline]
    pub(crate) fn meets_mask(&self, hit: &Hit) -> bool {
        hit.is_hit() && self.materials.may_pass(self.material_of(hit))
    }

    /// The share of light that meets what a ray hit, the rest passes through.
    fn opacity(&self, ray: &Ray, hit: &Hit) -> f32 {
        let material = self.material_of(hit);
        if !self.materials.may_pass(material) {
            return 1.0;
        }
        let surface = self.surface(ray, hit, &PackedFootprint::NONE);
        let at = surface.at.as_ref().unwrap_or(&ShadingPoint::NOWHERE);
        self.materials.opacity(material, at, &self.reading(Rgb::default()), surface.in_front)
    }

    /// The surface at a hit of this very ray, and what a pixel sees of it by the ray's footprint.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &Hit, footprint: &PackedFootprint) -> Surface {
        let geometry = &self.geometries[hit.geometry as usize];
        let point = self.surface_point(ray, hit);
        let (n, ng) = shading_normal(point.n, point.ng, -ray.d);
        let frame = Frame::from_normal(n);
        let ng = ng.map(|ng| frame.to_local(ng));
        let in_front = ray.d.dot(frame.n) < 0.0;
        let (material, emitter) = (self.material_of(hit), geometry.emitter);
        let bulge = self.bulge(geometry, ray, hit);
        let mut surface =
            Surface { point, frame, ng, bulge, smooth: None, in_front, material, emitter, at: None };
        if self.materials.vary() {
            self.look_closely(&mut surface, (ray, hit), footprint);
        }
        surface
    }

    /// What of a point only some materials want.
    #[cold]
    fn look_closely(&self, surface: &mut Surface, (ray, hit): (&Ray, &Hit), footprint: &PackedFootprint) {
        let wants = self.materials.wants(surface.material);
        if !wants.point {
            return;
        }
        let point = &surface.point;
        let (tangents, local) = self.tangents(ray, hit);
        let dp = footprint.unpacked().on_surface(ray, hit.t, point.ng);
        let [duvdx, duvdy] = dp.map(|dp| tangents.coordinates(dp));
        let transforms = || hit.chain.iter().filter_map(|id| self.accel.transform(id, ray.time));
        // From its group's coordinates to its own.
        let placement = self.placements.get(self.geometries[hit.geometry as usize].placement as usize);
        let [dpdx, dpdy] = dp.map(|dp| {
            let in_group = transforms().fold(dp, |v, m| m.inverse_vector(v));
            placement.map_or(in_group, |m| m.inverse_vector(in_group))
        });
        let (p, object_n) =
            placement.map_or((local.p, local.n), |m| (m.inverse_point(local.p), own_normal(m, local.n)));
        let [along, across] = self.brushed(ray, hit).unwrap_or([tangents.dpdu, tangents.dpdv]);
        let frame = frame_along(surface.frame.n, along);
        if wants.tangent {
            let ng = surface.ng.map(|ng| frame.to_local(surface.frame.to_world(ng)));
            (surface.frame, surface.ng) = (frame, ng);
        }
        let mut at = ShadingPoint {
            world: Place { p: surface.point.p, dpdx: dp[0], dpdy: dp[1] },
            object: Place { p, dpdx, dpdy },
            object_n,
            uv: surface.point.uv,
            duvdx,
            duvdy,
            dpdu: tangents.dpdu,
            dpdv: tangents.dpdv,
            along,
            across,
            frame,
            scatters: frame,
            on_mesh: match self.geometries[hit.geometry as usize].kind {
                Kind::Mesh(mesh) => Some(OnMesh { mesh, triangle: hit.primitive, place: [hit.u, hit.v] }),
                Kind::Shapes(_) => None,
            },
            lot: None,
        };
        if let Some(relief) = self.materials.relief(surface.material) {
            let ways = Ways {
                normal_to_world: |n: Vec3| {
                    let in_group = placement.map_or(n, |m| m.normal(n));
                    transforms().rev().fold(in_group, |n, m| m.normal(n))
                },
                vector_to_object: |v: Vec3| {
                    let in_group = transforms().fold(v, |v, m| m.inverse_vector(v));
                    placement.map_or(in_group, |m| m.inverse_vector(in_group))
                },
            };
            let n = relief.normal(point.n, &at, &self.reading(Rgb::default()), &ways);
            let (n, ng) = shading_normal(n, point.ng, -ray.d);
            let frame = if wants.tangent { frame_along(n, along) } else { Frame::from_normal(n) };
            at.scatters = frame;
            surface.smooth = Some(frame.to_local(surface.frame.n));
            (surface.frame, surface.ng) = (frame, ng.map(|ng| frame.to_local(ng)));
        }
        surface.at = Some(at);
    }

    /// How far above a hit the surface lies that shading normals tell of.
    #[inline]
    fn bulge(&self, geometry: &GeometryRecord, ray: &Ray, hit: &Hit) -> Vec3 {
        let Kind::Mesh(mesh) = geometry.kind else { return Vec3::ZERO };
        let mesh = &self.geometry.meshes[mesh as usize];
        let transforms = || hit.chain.iter().filter_map(|id| self.accel.transform(id, ray.time));
        let d = transforms().fold(ray.d, |d, m| m.inverse_vector(d));
        let bulge = mesh.bulge(hit.primitive, [hit.u, hit.v], d);
        transforms().rev().fold(bulge, |v, m| m.vector(v))
    }

    /// The surface at a corner of the triangle that a ray met, and in what direction it is seen there. Which corner a number in [0, 1) says, by
    /// their weights, so that the mean is between their colours as Gouraud's (1971, "Continuous Shading of Curved Surfaces").
    #[cold]
    pub fn surface_at_corner(
        &self,
        ray: &Ray,
        hit: &Hit,
        footprint: &PackedFootprint,
        which: f32,
    ) -> (Surface, Vec3) {
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(u, v)| Hit { u, v, ..*hit });
        let at = if which < hit.u {
            1
        } else if which < hit.u + hit.v {
            2
        } else {
            0
        };
        let mut surface = self.surface(ray, &corners[at], footprint);
        let (p, face) = (surface.point.p, surface.point.ng);
        // The faces that meet at the corner are as large as this one.
        let edges = corners.map(|c| (self.surface_point(ray, &c).p - p).abs().max_element());
        let far = edges.into_iter().fold(0.0, ops::max);
        surface.point.p_err += Vec3::splat(far * (8.0 * f32::EPSILON));
        // The corner lies on the surface that its normal tells of, and is lit whoever sees it.
        let n = if surface.smooth.is_some() { surface.frame.n } else { surface.point.n };
        let tangent = surface.at.as_ref().filter(|_| self.materials.wants(surface.material).tangent);
        surface.frame = tangent.map_or(Frame::from_normal(n), |at| frame_along(n, at.along));
        if let Some(at) = &mut surface.at {
            at.scatters = surface.frame;
        }
        (surface.point.ng, surface.point.n) = (n, n);
        (surface.ng, surface.smooth, surface.bulge) = (None, None, Vec3::ZERO);
        let face = if face.dot(n) < 0.0 { -face } else { face };
        let side = if ray.d.dot(face) > 0.0 { -1.0 } else { 1.0 };
        let towards = (ray.o - p).try_normalize().unwrap_or(-ray.d);
        /// The least cosine at which it is seen.
        const LEAST: f32 = 0.01;
        let lack = LEAST - side * towards.dot(n);
        let towards = if lack > 0.0 { towards + n * (side * lack) } else { towards };
        surface.in_front = side > 0.0;
        (surface, -towards.try_normalize().unwrap_or(n * side))
    }

    /// How a hit point moves with its texture coordinates, and the point in the coordinates of its group.
    fn tangents(&self, ray: &Ray, hit: &Hit) -> (Tangents, SurfacePoint) {
        let geometry = &self.geometries[hit.geometry as usize];
        let transforms = || hit.chain.iter().filter_map(|id| self.accel.transform(id, ray.time));
        let local = transforms().fold(*ray, |r, m| m.inverse_ray(&r));
        let point = self.local_surface(geometry, &local, hit);
        let own = match geometry.kind {
            Kind::Mesh(mesh) => self.geometry.meshes[mesh as usize].tangents(hit.primitive, hit.u, hit.v),
            Kind::Shapes(first) => self.geometry.tangents(first + hit.primitive, &point),
        };
        let outwards = transforms().rev().fold((own, point.n), |(tangents, n), m| {
            (tangents.to_world(&m, n), m.normal(n).try_normalize().unwrap_or(n))
        });
        let tangents = if geometry.flip { outwards.0.flipped() } else { outwards.0 };
        (tangents, point)
    }

    /// The direction that a mesh has at a hit for brushed surfaces and maps of normals, and what lies across it, in the world; `None` where
    /// it has none of its own.
    fn brushed(&self, ray: &Ray, hit: &Hit) -> Option<[Vec3; 2]> {
        let geometry = &self.geometries[hit.geometry as usize];
        let Kind::Mesh(mesh) = geometry.kind else { return None };
        let own = self.geometry.meshes[mesh as usize].own_tangent(hit.primitive, [hit.u, hit.v])?;
        let transforms = hit.chain.iter().filter_map(|id| self.accel.transform(id, ray.time));
        Some(transforms.rev().fold(own, |own, m| own.map(|v| m.vector(v))))
    }

    /// The footprint of the ray that goes on from a hit in the direction of a sample whose `wi` is in the world.
    /// Asked only where [`Self::wants_footprints`].
    #[cold]
    pub fn footprint_beyond(
        &self,
        footprint: &PackedFootprint,
        (ray, hit): (&Ray, &Hit),
        sample: &BsdfSample,
    ) -> PackedFootprint {
        let surface = self.surface_point(ray, hit);
        let (tangents, _) = self.tangents(ray, hit);
        let arriving = footprint.unpacked();
        let dp = arriving.on_surface(ray, hit.t, surface.ng);
        let bend = Bend { dp, n: surface.n, tangents: &tangents };
        arriving.scattered(ray.d, &bend, sample).packed()
    }

    #[inline]
    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let geometry = &self.geometries[hit.geometry as usize];
        let mut point = if hit.chain.is_empty() {
            self.local_surface(geometry, ray, hit)
        } else {
            self.instanced_surface(geometry, ray, hit)
        };
        if geometry.flip {
            // The geometric normal stays: lights are sampled by it, and their lit side was chosen by it.
            point.n = -point.n;
        }
        point
    }

    #[inline]
    fn local_surface(&self, geometry: &GeometryRecord, ray: &Ray, hit: &Hit) -> SurfacePoint {
        match geometry.kind {
            Kind::Mesh(mesh) => self.geometry.meshes[mesh as usize].surface(hit.primitive, hit.u, hit.v),
            Kind::Shapes(first) => {
                let h = ShapeHit { t: hit.t, u: hit.u, v: hit.v };
                self.geometry.surface(first + hit.primitive, ray, &h)
            }
        }
    }

    /// Into the object and back out, level by level.
    #[cold]
    fn instanced_surface(&self, geometry: &GeometryRecord, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let transforms = || hit.chain.iter().filter_map(|id| self.accel.transform(id, ray.time));
        let local = transforms().fold(*ray, |r, m| m.inverse_ray(&r));
        let point = self.local_surface(geometry, &local, hit);
        transforms().rev().fold(point, |p, m| p.to_world(&m))
    }

    /// The material at a hit.
    #[inline]
    pub(crate) fn material_of(&self, hit: &Hit) -> u32 {
        let own = self.geometries[hit.geometry as usize].material;
        if own != INHERIT {
            return own;
        }
        let inherited = hit.chain.iter().rev().map(|id| self.instance_materials[id as usize]);
        inherited.into_iter().find(|&m| m != INHERIT).unwrap_or(0)
    }

    /// How light scatters there.
    #[inline]
    pub fn bsdf<L: Lanes>(&self, surface: &Surface, lanes: L) -> Bsdf<'_> {
        self.bsdf_at(surface.material, surface.at.as_ref(), lanes)
    }

    /// How a material scatters at a point, which is told where the material [wants](crate::material::Wants) it.
    #[inline]
    pub fn bsdf_at<L: Lanes>(&self, material: u32, at: Option<&ShadingPoint>, lanes: L) -> Bsdf<'_> {
        let at = at.unwrap_or(&ShadingPoint::NOWHERE);
        self.materials.bsdf(material, at, &self.reading(lanes))
    }

    /// Which of the materials that a material is made of it is at a point, seen from the side that the normal points to or from the
    /// other, by a number in [0, 1).
    #[cold]
    pub fn chosen<L: Lanes>(
        &self,
        material: u32,
        (at, in_front): (Option<&ShadingPoint>, bool),
        lanes: L,
        u: f32,
    ) -> u32 {
        let at = at.unwrap_or(&ShadingPoint::NOWHERE);
        self.materials.chosen(material, (at, in_front), &self.reading(lanes), u)
    }

    /// The colour of a surface, in the work space whatever the lanes, as [`Bsdf::albedo`] of red, green and blue.
    pub(crate) fn albedo(&self, surface: &Surface) -> [f32; 3] {
        let at = surface.at.as_ref().unwrap_or(&ShadingPoint::NOWHERE);
        let reading = self.reading(Rgb::default());
        self.materials.albedo(surface.material, (at, surface.in_front), &reading).to_rgb()
    }

    /// How a path reads colours.
    #[inline(always)]
    pub fn reading<L: Lanes>(&self, lanes: L) -> Reading<'_, L> {
        Reading { tables: &self.tables, lanes, textures: &self.textures, meshes: &self.geometry.meshes }
    }

    /// How many paths side by side read colours.
    #[inline(always)]
    pub(crate) fn readings<'a, L: Lanes>(&'a self, lanes: &'a [L]) -> Readings<'a, L> {
        Readings { tables: &self.tables, lanes, textures: &self.textures, meshes: &self.geometry.meshes }
    }

    /// Whether a ray meets a surface from the side that its normal points away from.
    #[cold]
    pub(crate) fn is_met_from_inside(&self, ray: &Ray, hit: &Hit) -> bool {
        let point = self.surface_point(ray, hit);
        let outwards = if point.n.dot(point.ng) < 0.0 { -point.ng } else { point.ng };
        ray.d.dot(outwards) > 0.0
    }

    /// Whether paths carry what of a surface their rays stand for: where a material reads a texture, or is a user's that reads
    /// points. Brushed metal alone reads points for their tangents, and no more.
    #[inline(always)]
    pub fn wants_footprints(&self) -> bool {
        self.materials.vary() && (!self.textures.is_empty() || self.materials.any_custom())
    }

    /// Whether a ray may meet any light: one that glows or surrounds the scene.
    pub fn shows_lights(&self) -> bool {
        // Nearly always the first tells.
        self.emitters.iter().any(|emitter| !emitter.is_delta() && !emitter.is_ambient())
    }

    /// Whether anything surrounds the scene that shines.
    #[inline(always)]
    pub fn has_environment(&self) -> bool {
        !self.environments.is_empty()
    }

    /// What camera rays see: where there are lamps that the camera doesn't see, surfaces without these.
    pub fn camera_mask(&self) -> u32 {
        if self.unseen.is_empty() { u32::MAX } else { CAMERA }
    }

    /// Whether the camera sees an emitter.
    pub fn is_seen(&self, emitter: u32) -> bool {
        self.unseen.is_empty() || self.unseen.binary_search(&emitter).is_err()
    }

    /// Emitters that surround the scene, with their indices.
    #[inline]
    pub fn environments(&self) -> impl Iterator<Item = (u32, &Emitter)> {
        self.environments.iter().map(|&i| (i, &self.emitters[i as usize]))
    }

    /// Whether there is light from nowhere.
    #[inline(always)]
    pub fn has_ambient_light(&self) -> bool {
        !self.ambient.is_empty()
    }

    /// What a point of what a ray hit sends out of each ambient light, in all directions, and that light's group.
    #[cold]
    pub(crate) fn ambient_from<L: Lanes>(
        &self,
        hit: &Hit,
        bsdf: &Bsdf<'_>,
        lanes: L,
    ) -> impl Iterator<Item = (Light, u16)> {
        let (share, reading, class) = (bsdf.ambient(), self.reading(lanes), self.links.class_of(hit));
        let radiance = move |l: &AmbientLight| reading.eval(&l.radiance, &ShadingPoint::NOWHERE);
        let lit = self.ambient.iter().filter(move |(_, emitter)| self.links.light(class, *emitter));
        lit.map(move |(light, emitter)| (share * radiance(light), self.light_groups.of(*emitter)))
    }

    /// The choice of light for surfaces of a class.
    #[inline(always)]
    pub(crate) fn lights_of(&self, class: Class) -> &LightTable {
        self.links.table(class).unwrap_or(&self.lights)
    }

    /// Where lamps stand.
    #[inline(always)]
    pub fn within(&self) -> Within<'_> {
        Within { copies: &self.copies, search: Some(&self.accel) }
    }

    /// Picks a light for a point by `u` in [0, 1).
    #[inline]
    pub fn pick_light(&self, u: f32, at: &Receiver) -> Option<Pick> {
        self.lights.pick(u, at, self.within())
    }

    /// A point on a light or a direction towards it; of one that stands in an object on one of its copies.
    #[inline]
    pub fn sample_light<L: Lanes>(
        &self,
        (emitter, copy): (u32, u32),
        at: &Receiver,
        u: [f32; 2],
        lanes: L,
    ) -> Option<LightSample> {
        let (light, reading) = (&self.emitters[emitter as usize], self.reading(lanes));
        if self.copies.has(emitter) {
            let stand = self.within().stand(emitter, copy);
            return light.sample_copy(&self.geometry, &stand, (at, u), None, &reading);
        }
        light.sample(&self.geometry, at, u, &reading)
    }

    /// The radiance that the emitting surface sends out which a ray hit.
    #[inline]
    pub fn emitted<L: Lanes>(
        &self,
        emitter: u32,
        (ray, hit): (&Ray, &Hit),
        point: &SurfacePoint,
        lanes: L,
    ) -> Light {
        let (light, reading) = (&self.emitters[emitter as usize], self.reading(lanes));
        if hit.chain.is_empty() {
            return light.radiance_at(point, -ray.d, &reading);
        }
        light.radiance_of_copy(&self.within().stand_of(&hit.chain), point, -ray.d, &reading)
    }

    /// The radiance that a point of a picked emitting surface sends out.
    pub(crate) fn emitted_by<L: Lanes>(
        &self,
        pick: &Pick,
        point: &SurfacePoint,
        wo: Vec3,
        lanes: L,
    ) -> Light {
        let (light, reading) = (&self.emitters[pick.index as usize], self.reading(lanes));
        if self.copies.has(pick.index) {
            return light.radiance_of_copy(&self.within().stand(pick.index, pick.copy), point, wo, &reading);
        }
        light.radiance_at(point, wo, &reading)
    }

    /// A ray that leaves what was picked.
    pub(crate) fn emit<L: Lanes>(&self, pick: &Pick, u: [f32; 4], lanes: L) -> Option<Emitted> {
        let (light, reading) = (&self.emitters[pick.index as usize], self.reading(lanes));
        if self.copies.has(pick.index) {
            let stand = self.within().stand(pick.index, pick.copy);
            return light.emit_copy(&self.geometry, &stand, u, &reading);
        }
        light.emit(&self.geometry, &self.ball(), u, &reading)
    }

    /// A sample of a copy that was picked.
    #[cold]
    fn sample_copy<L: Lanes>(
        &self,
        (lights, pick): (&LightTable, &Pick),
        at: &Receiver,
        v: f32,
        reading: &Reading<'_, L>,
    ) -> LightSample {
        let stand = self.within().stand(pick.index, pick.copy);
        let part = lights.splits(pick.index).then_some(pick.part);
        let light = &self.emitters[pick.index as usize];
        let sample = light.sample_copy(&self.geometry, &stand, (at, [pick.rest, v]), part, reading);
        sample.unwrap_or_else(LightSample::none)
    }

    /// [`Self::sample_light`] of what was picked, by what is left of the number that picked it and another; the density is that of both.
    #[inline]
    pub fn sample_picked<L: Lanes>(
        &self,
        (lights, pick): (&LightTable, &Pick),
        at: &Receiver,
        v: f32,
        lanes: L,
    ) -> Option<LightSample> {
        let reading = self.reading(lanes);
        let sample = if self.copies.has(pick.index) {
            self.sample_copy((lights, pick), at, v, &reading)
        } else {
            let part = lights.splits(pick.index).then_some(pick.part);
            let light = &self.emitters[pick.index as usize];
            let readings = Readings::one(&reading);
            light.sample_parts::<f32, L>(&self.geometry, (at, [pick.rest, v]), part, &readings)
        };
        let pdf = sample.pdf * pick.pmf;
        (pdf > 0.0).then_some(LightSample { pdf, ..sample })
    }

    /// [`Self::sample_light`] at many points side by side, of each the emitter that was picked there.
    #[inline(always)]
    pub(crate) fn sample_lights<F: Float, L: Lanes>(
        &self,
        (lights, picked): (&LightTable, &Picks<F>),
        at: &Receiver<F>,
        v: F,
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        let u = [picked.rest, v];
        let mut all = LightSample::none();
        let mut left = picked.pmf.gt(F::ZERO);
        while left.any() {
            let first = left.to_bits().trailing_zeros() as usize;
            let emitter = picked.index.lane(first);
            if self.copies.has(emitter) {
                // Hardly two paths pick the same copy.
                let pick = Pick {
                    index: emitter,
                    pmf: picked.pmf.lane(first),
                    rest: picked.rest.lane(first),
                    part: picked.part.lane(first),
                    copy: picked.copy.lane(first),
                };
                let at = Receiver { p: at.p.lane(first), n: at.n.lane(first) };
                let one = self.sample_copy((lights, &pick), &at, v.lane(first), &readings.of(first));
                let this = F::Mask::from_bits(1 << first);
                all = LightSample::select(this, LightSample::uniform(&one), all);
                left = left & !this;
                continue;
            }
            let these = left & picked.index.eq(F::Uint::splat(emitter));
            let light = &self.emitters[emitter as usize];
            let splits = lights.splits(emitter);
            let sample = if F::WIDTH > 1 && these.to_bits().is_power_of_two() {
                // By itself: of many lights each is picked by few.
                let at = Receiver { p: at.p.lane(first), n: at.n.lane(first) };
                let u = [u[0].lane(first), u[1].lane(first)];
                let part = splits.then(|| picked.part.lane(first));
                // In a function of its own, as what follows: compiled in one piece with all who call it, sampling takes a minute.
                let one = F::vectorize(
                    #[inline(always)]
                    || light.sample_parts::<f32, L>(&self.geometry, (&at, u), part, &readings.from(first)),
                );
                LightSample::uniform(&one)
            } else {
                F::vectorize(
                    #[inline(always)]
                    || light.sample_parts(&self.geometry, (at, u), splits.then_some(picked.part), readings),
                )
            };
            all = LightSample::select(these, sample, all);
            left = left & !these;
        }
        all
    }

    /// The density with which light sampling at a point, its choice of light included, would have found the emitting
    /// surface that a ray hit.
    #[inline]
    pub(crate) fn light_pdf(
        &self,
        emitter: u32,
        (class, from): (Class, &Receiver),
        hit: &Hit,
        point: &SurfacePoint,
    ) -> f32 {
        let (light, lights) = (&self.emitters[emitter as usize], self.lights_of(class));
        if !hit.chain.is_empty() {
            return self.copy_pdf(emitter, (lights, from), hit, point);
        }
        if lights.splits(emitter) {
            let pdf = light.pdf_of_part(&self.geometry, from.p, hit.primitive, point);
            let pmf = || lights.pmf_of_part(emitter, hit.primitive, from);
            return if pdf > 0.0 { pmf() * pdf } else { 0.0 };
        }
        let pdf = light.pdf_at(&self.geometry, from, hit.primitive, point);
        if pdf > 0.0 { lights.pmf(emitter, from) * pdf } else { 0.0 }
    }

    /// The same of what stands in an object.
    #[cold]
    fn copy_pdf(
        &self,
        emitter: u32,
        (lights, from): (&LightTable, &Receiver),
        hit: &Hit,
        point: &SurfacePoint,
    ) -> f32 {
        let (light, within) = (&self.emitters[emitter as usize], self.within());
        let stand = within.stand_of(&hit.chain);
        let splits = lights.splits(emitter);
        let pdf = light.pdf_of_copy(&self.geometry, &stand, from, (hit.primitive, point), splits);
        if pdf <= 0.0 {
            return 0.0;
        }
        let copy = self.copies.number(&hit.chain);
        lights.pmf_of_copy([emitter, copy, hit.primitive], from, within) * pdf
    }

    /// Bytes held by what shines, and by what chooses among it.
    pub fn light_bytes(&self) -> usize {
        let triangles = |e: &Emitter| match e {
            Emitter::Area(AreaLight { surface: LitSurface::Mesh { triangles, .. }, .. }) => {
                triangles.as_ref().map_or(0, |table| table.len() * Table1::BYTES)
            }
            _ => 0,
        };
        let emitters = self.emitters.iter().map(|e| size_of::<Emitter>() + triangles(e)).sum::<usize>();
        emitters + self.lights.bytes() + self.links.bytes() + self.copies.bytes()
    }

    /// Bytes held by what grows with the scene: surfaces and their search structure.
    pub fn memory_bytes(&self) -> usize {
        let vertex =
            |m: &TriangleMesh| m.normals.len() * size_of::<Vec3>() + m.uvs.len() * size_of::<[f32; 2]>();
        let meshes: usize = self.geometry.meshes.iter().map(vertex).sum();
        self.accel.memory_bytes() + meshes + self.geometry.shapes.len() * size_of::<Shape>()
    }
}
