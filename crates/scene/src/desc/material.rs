//! Materials.

use straal_color::spectrum::refraction::Metal;

use crate::decode::Describe;
use crate::desc::check;
use crate::desc::lamp::LightGroup;
use crate::desc::spectrum::{Index, Spectrum};
use crate::desc::texture::{GreenAxis, Relief, TextureOf, Varying};
use crate::describe::describe;
use crate::limit::Limit;
use crate::value::{Known, LinearRgb, Link};
use crate::visit::Visitor;

describe! {
    /// What a surface does with light.
    pub enum Material each with relief: Relief {
        /// Scatters light evenly (Lambert), or as a rough surface of such facets does.
        "diffuse" => Diffuse(struct Diffuse {
            /// Share of light that is reflected.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.5)),
            /// How rough it is: 0 is Lambert's, the roughest, like the moon or plaster, is as bright at its rim as in its middle.
            roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// What a rough surface does.
            model: RoughDiffuse = RoughDiffuse::Eon,
            /// Whether the back looks like the front; else it is black.
            two_sided: bool = true,
        }),
        /// A perfect mirror.
        "mirror" => Mirror(struct Mirror {
            /// Share of light that is reflected; with `fresnel: schlick`, straight on.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// How the share grows towards grazing angles.
            fresnel: MirrorFresnel = MirrorFresnel::Constant,
            /// Whether the back looks like the front; else it is black.
            two_sided: bool = true,
        }),
        /// Smooth glass, water and the like: a boundary between two transparent media; normals point to the outside.
        "dielectric" => Dielectric(struct Dielectric [check::dielectric] {
            /// Index of refraction inside: a number, the name of a glass such as `BK7`, a formula, or a texture of numbers.
            eta: Varying<Index> [Limit::within(0.1, 10.0)] = Varying::Constant(Index::Constant(1.5)),
            /// Index of refraction outside.
            eta_outside: Varying<Index> [Limit::within(0.1, 10.0)] = Varying::Constant(Index::Constant(1.0)),
            /// Tint of what is reflected; physical is 1.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// Tint of what passes; physical is 1.
            transmittance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// How the share that is reflected is found.
            fresnel: Fresnel = Fresnel::Exact,
            /// Alpha of the microfacets: 0 is smooth. With `roughness_v`, along the texture's u.
            roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Alpha of the microfacets along the texture's v, if it is another than along u.
            roughness_v: Option<Varying<f64>> [Limit::UNIT] = None,
            /// How the facets are spread.
            distribution: Distribution = Distribution::Ggx,
            /// Whether light that bounces between facets more than once is put back instead of being lost (Turquin 2019).
            multiple_bounces: bool = false,
        } with interior: Interior),
        /// Metal, polished or rough, by name or by its complex index of refraction `eta` + i `k`, relative to air.
        "conductor" => Conductor(struct Conductor [check::conductor] {
            /// A metal whose index was measured, such as `gold`; give this or `eta` and `k`.
            metal: Option<Known<Metal>> = None,
            /// Real part of the index of refraction.
            eta: Option<Varying<Spectrum>> [Limit::NON_NEGATIVE] = None,
            /// Imaginary part of the index of refraction: absorption.
            k: Option<Varying<Spectrum>> [Limit::NON_NEGATIVE] = None,
            /// Alpha of the microfacets: 0 is a polished mirror. With `roughness_v`, along the texture's u.
            roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Alpha of the microfacets along the texture's v, if it is another than along u: brushed metal.
            roughness_v: Option<Varying<f64>> [Limit::UNIT] = None,
            /// How the facets are spread.
            distribution: Distribution = Distribution::Ggx,
            /// Whether light that bounces between facets more than once is put back instead of being lost (Turquin 2019).
            multiple_bounces: bool = false,
            /// Tint of what is reflected; physical is 1.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// Whether the back looks like the front; else it is black.
            two_sided: bool = true,
        }),
        /// The uber material of the OpenPBR specification (1.1), with its names: a base of metal, glass and what is diffuse under a
        /// glossy surface; on it a thin film, a coat and fuzz.
        "open_pbr" => OpenPbr(struct OpenPbr {
            /// Factor to `base_color`.
            base_weight: Varying<f64> [Limit::UNIT] = Varying::Constant(1.0),
            /// Colour of what is diffuse, and of metal seen straight on.
            base_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.8)),
            /// Roughness of what is diffuse (EON): 0 is Lambert.
            base_diffuse_roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Which part of the base is metal.
            base_metalness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Factor to what the surface of glass and of what is diffuse reflects straight on, and to all that metal reflects.
            specular_weight: Varying<f64> [Limit::NON_NEGATIVE] = Varying::Constant(1.0),
            /// Tint of the glossy reflection; of metal, at 82 degrees.
            specular_color: Varying<Spectrum> [Limit::within(0.0, 3.9)] = Varying::Constant(Spectrum::grey(1.0)),
            /// Roughness of the surface, the root of GGX's alpha; 0 is polished.
            specular_roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.3),
            /// How much smoother it is across the texture's u than along it.
            specular_roughness_anisotropy: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Index of refraction of the base.
            specular_ior: Varying<f64> [Limit::within(0.1, 5.0)] = Varying::Constant(1.5),
            /// Which part of what isn't metal is clear.
            transmission_weight: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// What is left of light at each crossing of the surface or, with a depth, after that way.
            transmission_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// The way in metres after which light has `transmission_color`; 0 for a tint at the surface.
            transmission_depth: Varying<f64> [Limit::NON_NEGATIVE] = Varying::Constant(0.0),
            /// How much of that is scattered within `transmission_depth`, rather than absorbed: kept for media, which are to come; until then it is absorbed.
            transmission_scatter: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.0)),
            /// Mean cosine of that scattering: kept for media.
            transmission_scatter_anisotropy: Varying<f64> [Limit::within(-1.0, 1.0)] = Varying::Constant(0.0),
            /// How much of the dispersion of `transmission_dispersion_abbe_number` there is.
            transmission_dispersion_scale: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Abbe's number: the less, the more colours part.
            transmission_dispersion_abbe_number: Varying<f64> [Limit::within(6.2, 1e6)] = Varying::Constant(20.0),
            /// Which part of what is neither metal nor clear scatters beneath its surface: diffuse in `subsurface_color`, until there are media.
            subsurface_weight: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Colour that what scatters beneath the surface has as a whole.
            subsurface_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.8)),
            /// Mean way between two scatterings, in metres: kept for media.
            subsurface_radius: Varying<f64> [Limit::NON_NEGATIVE] = Varying::Constant(1.0),
            /// Factor to `subsurface_radius` by colour: kept for media.
            subsurface_radius_scale: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::Rgb(LinearRgb([1.0, 0.5, 0.25]))),
            /// Of a thin wall: which part passes, from -1 for none to 1 for all.
            subsurface_scatter_anisotropy: Varying<f64> [Limit::within(-1.0, 1.0)] = Varying::Constant(0.0),
            /// How much of the coat there is.
            coat_weight: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// What the coat leaves of light that crosses it twice, straight.
            coat_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// Roughness of the coat; what lies below looks rougher as well.
            coat_roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// As that of the base.
            coat_roughness_anisotropy: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Index of refraction of the coat.
            coat_ior: Varying<f64> [Limit::within(0.1, 5.0)] = Varying::Constant(1.6),
            /// How much darker what lies below is by light that the coat reflects back to it.
            coat_darkening: Varying<f64> [Limit::UNIT] = Varying::Constant(1.0),
            /// How much fuzz there is.
            fuzz_weight: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Tint of what the fuzz reflects.
            fuzz_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// How much the fibres stand in all directions; 0 is none.
            fuzz_roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.5),
            /// How much of a thin film there is on the base.
            thin_film_weight: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Thickness of the film in micrometres.
            thin_film_thickness: Varying<f64> [Limit::within(0.0, 6.5)] = Varying::Constant(0.5),
            /// Index of refraction of the film.
            thin_film_ior: Varying<f64> [Limit::within(0.1, 5.0)] = Varying::Constant(1.4),
            /// How strongly it shines: what `emission_color` is multiplied by, before coat and fuzz dim it. A surface's own `emission` counts rather
            /// than this.
            emission_luminance: Varying<f64> [Limit::NON_NEGATIVE] = Varying::Constant(0.0),
            /// The colour in which it shines.
            emission_color: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(1.0)),
            /// The share of light that meets the surface; the rest passes straight through as if nothing were there, shadow rays as well.
            geometry_opacity: Varying<f64> [Limit::UNIT] = Varying::Constant(1.0),
            /// Whether the surface is a wall without thickness, such as a pane or a leaf: light goes straight on.
            geometry_thin_walled: bool = false,
            /// Which normals the coat has.
            geometry_coat_normal: CoatNormal = CoatNormal::Base,
            /// A texture whose red and green from 0 to 1 are, from -1 to 1, the direction along which base and coat are rougher: along the texture's u and v.
            geometry_tangent: Option<TextureOf> = None,
            /// Degrees by which that direction, or u, is turned further, counter-clockwise.
            geometry_tangent_rotation: Varying<f64> = Varying::Constant(0.0),
            /// Whether coat and fuzz take what they reflect from the light on its way in *and* out: the same from both ends, and darker.
            reciprocal: bool = false,
            /// Whether the back of what is opaque looks like the front; else it is black.
            two_sided: bool = true,
            /// The group of lights that its light is told by, of surfaces that don't say it.
            light_group: Option<LightGroup> = None,
        }),
        /// The material of glTF, metallic and rough, with its ratified extensions, as layers of `open_pbr`. Its names are glTF's, without the word
        /// `factor`.
        "gltf" => Gltf(struct Gltf {
            /// Colour of what is diffuse, and of metal.
            base_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// Which part is metal.
            metallic: Varying<f64> [Limit::UNIT] = Varying::Constant(1.0),
            /// The root of GGX's alpha.
            roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(1.0),
            /// Radiance that it sends out.
            emissive: Varying<Spectrum> [Limit::NON_NEGATIVE] = Varying::Constant(Spectrum::grey(0.0)),
            /// What that is multiplied by (`KHR_materials_emissive_strength`).
            emissive_strength: Varying<f64> [Limit::NON_NEGATIVE] = Varying::Constant(1.0),
            /// The share of light that meets the surface; the rest passes straight through.
            alpha: Varying<f64> [Limit::UNIT] = Varying::Constant(1.0),
            /// Index of refraction (`KHR_materials_ior`).
            ior: Varying<f64> [Limit::within(1.0, 5.0)] = Varying::Constant(1.5),
            /// Strength of what the surface of what isn't metal reflects (`KHR_materials_specular`).
            specular: Varying<f64> [Limit::UNIT] = Varying::Constant(1.0),
            /// Colour of that, straight on.
            specular_color: Varying<Spectrum> [Limit::within(0.0, 3.9)] = Varying::Constant(Spectrum::grey(1.0)),
            /// How much of a clear coat (`KHR_materials_clearcoat`).
            clearcoat: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Roughness of the coat.
            clearcoat_roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Which normals the coat has.
            clearcoat_normal: CoatNormal = CoatNormal::Base,
            /// Colour and strength of sheen (`KHR_materials_sheen`).
            sheen_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.0)),
            /// Roughness of the sheen.
            sheen_roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Which part of what isn't metal lets light through (`KHR_materials_transmission`).
            transmission: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Whether there is an inside, in which light is bent and absorbed (`KHR_materials_volume` with a thickness above 0); else it is a thin wall.
            volume: bool = false,
            /// What is left of light after `attenuation_distance`: of what lies behind the surface, and so no texture, nor is the distance.
            attenuation_color: Spectrum [Limit::UNIT] = Spectrum::grey(1.0),
            /// The way in metres after which it is left; endless if not told.
            attenuation_distance: Option<f64> [Limit::POSITIVE] = None,
            /// How strongly colours part: 20 over Abbe's number (`KHR_materials_dispersion`).
            dispersion: Varying<f64> [Limit::within(0.0, 3.2)] = Varying::Constant(0.0),
            /// How much of a thin film (`KHR_materials_iridescence`).
            iridescence: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Index of refraction of the film.
            iridescence_ior: Varying<f64> [Limit::within(1.0, 5.0)] = Varying::Constant(1.3),
            /// Thickness of the film in nanometres.
            iridescence_thickness: Varying<f64> [Limit::within(0.0, 6500.0)] = Varying::Constant(400.0),
            /// How much rougher it is along the texture's u (`KHR_materials_anisotropy`).
            anisotropy: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// A texture whose red and green from 0 to 1 are, from -1 to 1, the direction along which it is rougher: along the texture's u and v.
            anisotropy_direction: Option<TextureOf> = None,
            /// Degrees by which that direction, or u, is turned further, counter-clockwise.
            anisotropy_rotation: Varying<f64> = Varying::Constant(0.0),
            /// Which part of what is diffuse goes through, where it is a thin wall (`KHR_materials_diffuse_transmission`).
            diffuse_transmission: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// The colour of what goes through so.
            diffuse_transmission_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// Whether the back looks like the front; else it is black.
            double_sided: bool = true,
            /// The group of lights that its light is told by, of surfaces that don't say it.
            light_group: Option<LightGroup> = None,
        }),
        /// Disney's BSDF as Mitsuba 3 has it, exactly.
        "principled" => Principled(struct Principled [check::principled] {
            /// Colour of what is diffuse and of metal; its root is the tint of glass.
            base_color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.5)),
            /// Roughness: the root of GGX's alpha.
            roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.5),
            /// How much smoother it is across the texture's u than along it.
            anisotropic: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Which part is metal.
            metallic: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Which part of the rest is glass.
            spec_trans: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Index of refraction inside over that outside; give this or `specular`.
            eta: Option<Varying<f64>> [Limit::within(0.1, 10.0)] = None,
            /// What is reflected straight on, in 8 hundredths: another way to tell the index; 0.5 where neither is given.
            specular: Option<Varying<f64>> [Limit::UNIT] = None,
            /// How much of the base's colour the glossy reflection has.
            spec_tint: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// How much sheen.
            sheen: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// How much of the base's colour the sheen has.
            sheen_tint: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// How much of the diffuse part is flattened, as if light scattered beneath.
            flatness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// How much of a clear coat.
            clearcoat: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// How smooth the clear coat is.
            clearcoat_gloss: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// Whether the back of what is opaque looks like the front; else it is black, as in Mitsuba.
            two_sided: bool = true,
        }),
        /// A pane of clear material without an inside: light goes straight on, and what bounces between its faces is counted.
        "thin_dielectric" => ThinDielectric(struct ThinDielectric {
            /// Index of refraction of the pane.
            eta: Varying<f64> [Limit::within(0.1, 10.0)] = Varying::Constant(1.5),
            /// Index of refraction outside.
            eta_outside: Varying<f64> [Limit::within(0.1, 10.0)] = Varying::Constant(1.0),
            /// Tint of what is reflected; physical is 1.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// Tint of what passes; physical is 1.
            transmittance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
        }),
        /// A film of some hundred nanometres, in which waves of light meet: a soap bubble, or the colours of oil and oxide on a polished metal.
        "thin_film" => ThinFilm(struct ThinFilm [check::thin_film] {
            /// Thickness in nanometres.
            thickness: Varying<f64> [Limit::within(0.0, 20000.0)] = Varying::Constant(400.0),
            /// Index of refraction of the film.
            eta: Varying<f64> [Limit::within(1.0, 10.0)] = Varying::Constant(1.33),
            /// Index of refraction of what is around it.
            eta_outside: Varying<f64> [Limit::within(0.1, 10.0)] = Varying::Constant(1.0),
            /// The metal below, such as `gold`; give this or `base_eta` and `base_k`, or none of them for a film that hangs in the air.
            metal: Option<Known<Metal>> = None,
            /// Real part of the index of refraction of what lies below, which takes all light that passes.
            base_eta: Option<Varying<Spectrum>> [Limit::NON_NEGATIVE] = None,
            /// Imaginary part of that index: absorption.
            base_k: Option<Varying<Spectrum>> [Limit::NON_NEGATIVE] = None,
        }),
        /// Scatters light evenly on both sides, as paper, leaves and lampshades do.
        "diffuse_transmission" => DiffuseTransmission(struct DiffuseTransmission [check::diffuse_transmission] {
            /// Share of light that is sent back.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.25)),
            /// Share of light that goes through.
            transmittance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.25)),
        }),
        /// Plastic, glazed pottery, varnished wood: an evenly scattering ground below a clear boundary, smooth or rough (as Mitsuba's
        /// `plastic` and `roughplastic`).
        "plastic" => Plastic(struct Plastic {
            /// Share of light that the ground reflects.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.5)),
            /// Index of refraction of what covers it.
            eta: Varying<f64> [Limit::within(1.0001, 10.0)] = Varying::Constant(1.5),
            /// Index of refraction outside.
            eta_outside: Varying<f64> [Limit::within(0.1, 10.0)] = Varying::Constant(1.0),
            /// Alpha of the boundary's microfacets: 0 is smooth.
            roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
            /// How the facets are spread.
            distribution: Distribution = Distribution::Ggx,
            /// Tint of what the boundary reflects; physical is 1.
            specular: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(1.0)),
            /// Whether light that is sent back to the ground from within is coloured by it each time, as it is in truth; else as if the ground were
            /// white for it.
            nonlinear: bool = false,
            /// Whether the back looks like the front; else it is black.
            two_sided: bool = true,
        }),
        /// A clear coat over a ground that scatters evenly, as pbrt's `coateddiffuse`: light is followed through it step by step.
        "coated_diffuse" => CoatedDiffuse(struct CoatedDiffuse {
            /// Share of light that the ground reflects.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.5)),
        } with coat: Coat),
        /// A clear coat over metal, as pbrt's `coatedconductor`.
        "coated_conductor" => CoatedConductor(struct CoatedConductor [check::coated_conductor] {
            /// A metal whose index was measured, such as `gold`; give this or `eta` and `k`.
            metal: Option<Known<Metal>> = None,
            /// Real part of the metal's index of refraction, relative to air.
            eta: Option<Varying<Spectrum>> [Limit::NON_NEGATIVE] = None,
            /// Imaginary part of the metal's index of refraction: absorption.
            k: Option<Varying<Spectrum>> [Limit::NON_NEGATIVE] = None,
            /// GGX alpha of the metal's facets: 0 is polished.
            roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
        } with coat: Coat),
        /// Cloth: an evenly scattering ground, and fibres that light up at grazing angles (Estevez and Kulla 2017).
        "sheen" => Sheen(struct Sheen {
            /// Share of light that the ground reflects.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.3)),
            /// Colour of the sheen.
            color: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.5)),
            /// How far the sheen reaches from the rim.
            roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.4),
            /// Whether the back looks like the front; else it is black.
            two_sided: bool = true,
        }),
        /// Two materials at the same place, each with a share.
        "mix" => Mix(struct Mix {
            /// What has the rest.
            first: Box<MaterialRef>,
            /// What has the share `weight`.
            second: Box<MaterialRef>,
            /// Share of `second`.
            weight: Varying<f64> [Limit::UNIT] = Varying::Constant(0.5),
        }),
        /// A material with holes: light passes where it isn't opaque, shadow rays as well.
        "mask" => Mask(struct Mask {
            /// What there is.
            material: Box<MaterialRef>,
            /// The share of light that meets it; the rest passes straight through.
            opacity: Varying<f64> [Limit::UNIT] = Varying::Constant(0.5),
        }),
        /// One material on the side that the normal points to, another on the other.
        "two_faces" => TwoFaces(struct TwoFaces {
            /// On the side that the normal points to.
            front: Box<MaterialRef>,
            /// On the other side.
            back: Box<MaterialRef>,
        }),
        /// The textbook's shading: evenly scattered light, a highlight after Phong or Blinn, and a share of the ambient light.
        "phong" => Phong(struct Phong {
            /// Share of light that is scattered evenly: the textbook's k_d times the colour.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.5)),
            /// Share of `ambient` light that is sent back, the textbook's k_a times the colour; as `reflectance` if not told.
            ambient: Option<Varying<Spectrum>> [Limit::UNIT] = None,
            /// Strength of the highlight: the textbook's k_s.
            specular: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.2)),
            /// How sharp the highlight is: the textbook's e.
            exponent: Varying<f64> [Limit::within(0.0, 1e5)] = Varying::Constant(50.0),
            /// Which cosine is raised to that power.
            highlight: Highlight = Highlight::Phong,
            /// What the power is multiplied by.
            form: HighlightForm = HighlightForm::Normalised,
            /// Whether the back looks like the front; else it is black.
            two_sided: bool = true,
        }),
        /// A blurred mirror: light from around the mirrored direction, by a power of the cosine to it.
        "glossy" => Glossy(struct Glossy {
            /// Share of light that is reflected: the textbook's k_r times the colour.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.8)),
            /// How sharp the image is: the textbook's e.
            exponent: Varying<f64> [Limit::within(0.0, 1e5)] = Varying::Constant(100.0),
            /// Whether the back looks like the front; else it is black.
            two_sided: bool = true,
        }),
        /// The textbook's simple transparency: bends light as `dielectric` does, but reflects the same share at every angle.
        "transparent" => Transparent(struct Transparent [check::transparent] {
            /// Index of refraction inside.
            eta: Varying<f64> [Limit::within(0.1, 10.0)] = Varying::Constant(1.5),
            /// Index of refraction outside.
            eta_outside: Varying<f64> [Limit::within(0.1, 10.0)] = Varying::Constant(1.0),
            /// Share of light that is reflected: the textbook's k_r.
            reflectance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.1)),
            /// Share of light that passes: the textbook's k_t.
            transmittance: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.9)),
        } with interior: Interior),
    }
}

describe! {
    /// What a clear material is filled with, which dims light on its way through: what lies behind the surface, and so none of it is a texture.
    pub struct Interior {
        /// What is left of light after `attenuation_distance` (Beer's law); give this or `sigma_a`.
        attenuation_color: Option<Spectrum> [Limit::UNIT] = None,
        /// The way after which `attenuation_color` is left, in m.
        attenuation_distance: f64 [Limit::POSITIVE] = 1.0,
        /// Absorption per m; give this or `attenuation_color`.
        sigma_a: Option<Spectrum> [Limit::NON_NEGATIVE] = None,
        /// Where closed surfaces overlap, the material of the highest priority is there alone; where the numbers are alike,
        /// the one inside the other. Above 0 it needs indices of refraction that aren't textures.
        priority: u32 [Limit::within(0.0, 1000.0)] = 0,
    }
}

describe! {
    /// A clear coat and the layer below its boundary.
    pub struct Coat {
        /// Index of refraction of the coat over that outside.
        coat_eta: Varying<f64> [Limit::within(1.0001, 10.0)] = Varying::Constant(1.5),
        /// GGX alpha of the coat's boundary: 0 is smooth.
        coat_roughness: Varying<f64> [Limit::UNIT] = Varying::Constant(0.0),
        /// Optical depth of the layer between the boundary and the ground: light that crosses it straight on is dimmed to exp(-thickness), unless
        /// it is scattered.
        thickness: Varying<f64> [Limit::within(1e-6, 1e3)] = Varying::Constant(0.01),
        /// Share of what the layer stops that it scatters; the rest is absorbed.
        albedo: Varying<Spectrum> [Limit::UNIT] = Varying::Constant(Spectrum::grey(0.0)),
        /// Mean cosine of what is scattered there: above 0 forwards, below 0 backwards (Henyey and Greenstein).
        g: Varying<f64> [Limit::within(-0.99, 0.99)] = Varying::Constant(0.0),
        /// Most boundaries and events in the layer that light is followed to.
        max_depth: u32 [Limit::within(1.0, 1000.0)] = 10,
        /// Whether the back looks like the front; else it is black.
        two_sided: bool = true,
    }
}

describe! {
    /// What a rough diffuse surface does.
    pub enum RoughDiffuse {
        /// Facets that scatter evenly and light one another (Portsmouth, Kutz and Hill 2024): energy is conserved.
        "eon" => Eon,
        /// Facets that scatter evenly (Oren and Nayar 1994, the qualitative model), by a `roughness` in radians; what bounces between them
        /// is lost.
        "oren_nayar" => OrenNayar,
    }
}

describe! {
    /// How microfacets are spread.
    pub enum Distribution {
        /// After Trowbridge and Reitz (1975), with long tails.
        "ggx" => Ggx,
        /// After Beckmann (1963): slopes spread by a bell curve.
        "beckmann" => Beckmann,
    }
}

describe! {
    /// How the share is found that a boundary between clear materials reflects.
    pub enum Fresnel {
        /// By Fresnel's equations.
        "exact" => Exact,
        /// By Schlick's approximation of 1994: R + (1 - R) (1 - cos)^5 with the R of light that arrives straight on.
        "schlick" => Schlick,
    }
}

describe! {
    /// How the share that a mirror reflects depends on the angle.
    pub enum MirrorFresnel {
        /// Not at all.
        "constant" => Constant,
        /// By Schlick's approximation of 1994: R + (1 - R) (1 - cos)^5.
        "schlick" => Schlick,
    }
}

describe! {
    /// Whose highlight it is.
    pub enum Highlight {
        /// Phong's (1975): of the angle between the mirrored direction and where light goes.
        "phong" => Phong,
        /// Blinn's (1977): of the angle between the normal and the direction half-way between the two of light.
        "blinn" => Blinn,
    }
}

describe! {
    /// How a highlight is scaled.
    pub enum HighlightForm {
        /// So that it sends back `specular` of the light at most, and the same when its directions are exchanged.
        "normalised" => Normalised,
        /// f = k_s cos^e as in textbooks that multiply it by the cosine at the surface, such as Suffern's (2007). It may send back more
        /// light than arrives.
        "textbook" => Textbook,
        /// As Phong wrote it in 1975, k_s cos^e of the light, whatever the cosine at the surface: neither bounded nor the same
        /// when its directions are exchanged.
        "classic" => Classic,
    }
}

impl Material {
    /// The light that it sends out by itself, if it does.
    pub fn emission(&self) -> Option<&Varying<Spectrum>> {
        let found = match self {
            Self::OpenPbr(m) if m.emission_luminance != Varying::Constant(0.0) => &m.emission_color,
            Self::Gltf(m) if m.emissive_strength != Varying::Constant(0.0) => &m.emissive,
            _ => return None,
        };
        (*found != Varying::Constant(Spectrum::grey(0.0))).then_some(found)
    }

    /// The group of lights that its own light belongs to, if it says one.
    pub const fn light_group(&self) -> Option<&LightGroup> {
        match self {
            Self::OpenPbr(m) => m.light_group.as_ref(),
            Self::Gltf(m) => m.light_group.as_ref(),
            _ => None,
        }
    }

    /// The same, to be changed, of the kinds that can say one.
    pub(crate) const fn light_group_mut(&mut self) -> Option<&mut Option<LightGroup>> {
        match self {
            Self::OpenPbr(m) => Some(&mut m.light_group),
            Self::Gltf(m) => Some(&mut m.light_group),
            _ => None,
        }
    }

    /// Whether it shines by itself.
    pub fn shines(&self) -> bool {
        self.emission().is_some()
    }

    /// Whether it is there for a part of what meets it only, where the rest passes straight through.
    pub fn has_holes(&self) -> bool {
        let all = Varying::Constant(1.0);
        match self {
            Self::Mask(m) => m.opacity != all,
            Self::OpenPbr(m) => m.geometry_opacity != all,
            Self::Gltf(m) => m.alpha != all,
            _ => false,
        }
    }
}

/// A material given by name or on the spot.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialRef {
    /// One of the scene's `materials`.
    Named(Link<Material>),
    /// Written where it is used.
    Inline(Box<Material>),
}

impl Material {
    /// The materials that it is made of, in the order of its keys.
    pub fn parts(&self) -> Vec<&MaterialRef> {
        struct Parts<'a>(Vec<&'a MaterialRef>);
        impl<'a> Visitor<'a> for Parts<'a> {
            fn material(&mut self, part: &'a MaterialRef) -> bool {
                self.0.push(part);
                false
            }
        }
        let mut parts = Parts(Vec::new());
        self.show(Limit::FINITE, &mut parts);
        parts.0
    }
}

impl MaterialRef {
    /// Calls `f` with every name in it, and how many materials deep it stands.
    pub(crate) fn names<'a>(&'a self, f: &mut impl FnMut(&'a Link<Material>, usize)) {
        self.names_from(0, f);
    }

    fn names_from<'a>(&'a self, depth: usize, f: &mut impl FnMut(&'a Link<Material>, usize)) {
        match self {
            Self::Named(link) => f(link, depth),
            Self::Inline(material) => {
                material.parts().into_iter().for_each(|part| part.names_from(depth + 1, f));
            }
        }
    }
}

describe! {
    /// Which normals a coat has.
    pub enum CoatNormal {
        /// Those of what lies below, with its relief.
        "base" => Base,
        /// Those of the surface: a coat that is smooth over what isn't.
        "surface" => Surface,
        /// Those that a map of its own tells, in the surface's axes.
        "map" => Map(CoatMap),
    }
}

describe! {
    /// The normals of a coat.
    pub struct CoatMap {
        /// The texture, whose red, green and blue from 0 to 1 are x, y and z from -1 to 1; a picture's numbers are taken as they stand.
        texture: TextureOf,
        /// Which way green points.
        green: GreenAxis = GreenAxis::Up,
        /// What the slopes are multiplied by; 0 is flat.
        strength: f64 [Limit::within(-100.0, 100.0)] = 1.0,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::Value as Json;

    /// All that is a number or a colour of a surface may be read off a texture.
    #[test]
    fn numbers_and_colours_may_differ_from_point_to_point() {
        /// What isn't of the surface but of what lies behind it, and how far light is followed.
        const NONE: [&str; 5] =
            ["attenuation_color", "attenuation_distance", "sigma_a", "priority", "max_depth"];
        let schema = crate::document::schema();
        let defs = &schema["$defs"];
        let kinds = defs["Material"]["oneOf"].as_array().expect("kinds");
        let mut met = 0;
        for (kind, said) in kinds.iter().filter_map(|k| k["properties"].as_object()).flatten() {
            let said = said.to_string();
            let name = said.split("#/$defs/").nth(1).and_then(|rest| rest.split('"').next()).expect("a type");
            for (key, what) in defs[name]["properties"].as_object().into_iter().flatten() {
                let what = without_docs(what).to_string();
                let is_number = what.contains("\"number\"") || what.contains("\"integer\"");
                let varies = what.contains("#/$defs/Textured");
                assert!(!is_number || varies || NONE.contains(&key.as_str()), "{kind}.{key}: {what}");
                met += usize::from(is_number && varies);
            }
        }
        assert!(met > 130, "{met}");
    }

    fn without_docs(what: &Json) -> Json {
        let mut what = what.clone();
        if let Json::Object(map) = &mut what {
            map.remove("description");
            map.remove("default");
        }
        what
    }
}
