//! Words for materials.

use super::Here::{Called, NotYet, Write};
use super::Table;
use super::answers::{
    BUMPS, CHECKER, GLASS, GLOW, HAIR, LAYERED, MASKS, MEDIA, METAL, ROUGH_GLASS, SUBSURFACE, TEXTURES, TYPE,
};

/// What words are in mappings of these marks.
pub(super) const KEYS: &[Table] = &[
    ("diffuse:", &[("sigma alpha roughnessfactor", Called("roughness"))]),
    (
        "phong:",
        &[
            ("kd diffuse diffusereflectance rd basecolor color colour", Called("reflectance")),
            ("ka", Called("ambient")),
            ("ks specularreflectance speccolor", Called("specular")),
            ("shininess n ns phongexponent phongsize e glossiness", Called("exponent")),
        ],
    ),
    ("glossy:", &[("kr", Called("reflectance")), ("shininess n ns e", Called("exponent"))]),
    (
        "plastic:",
        &[
            ("specularreflectance ks", Called("specular")),
            ("kd diffusereflectance diffuse color colour", Called("reflectance")),
            ("alpha", Called("roughness")),
        ],
    ),
    ("mask:", &[("alpha amount cutout", Called("opacity")), ("bsdf nested base", Called("material"))]),
    (
        "mix:",
        &[
            ("amount factor fac", Called("weight")),
            ("a material1 bsdf0", Called("first")),
            ("b material2 bsdf1", Called("second")),
        ],
    ),
    (
        "mirror:",
        &[(
            "roughness alpha distribution uroughness vroughness roughnessfactor",
            Write("`conductor: { metal: silver, roughness: 0.1 }`"),
        )],
    ),
    (
        "reflectance",
        &[
            ("glossiness smoothness", Write("`roughness` of a `conductor`: 1 less that number")),
            (
                "kr kd color colour albedo basecolor basecolorfactor diffusecolor diffusereflectance diffuse tint specularreflectance reflectivity rd kdiffuse diff basecolour reflectioncolor paint",
                Called("reflectance"),
            ),
            ("ks specularcolor specular r0 f0", Called("reflectance")),
            (
                "ior intior eta indexofrefraction refractiveindex n interiorior index refraction",
                Called("eta"),
            ),
            ("extior outerior exteriorior etaext exteta", Called("eta_outside")),
            (
                "kt transmission transmissioncolor speculartransmittance transmittancecolor filter attenuationcolor",
                Called("transmittance"),
            ),
            ("absorption extinction kappa kcoefficient", Called("k")),
            ("sigmaa absorptioncoefficient", Called("sigma_a")),
            ("attenuationcolour absorptioncolor transmissioncolor", Called("attenuation_color")),
            ("transmissiondepth atdistance absorptiondistance", Called("attenuation_distance")),
            ("material metalname type name preset", Called("metal")),
            ("vroughness alphav alphay", Called("roughness_v")),
            ("alpha alphau uroughness roughnessfactor alphax", Called("roughness")),
            ("type microfacet", Called("distribution")),
            (
                "shininess exponent phongexponent phongsize ns",
                Write("`conductor: { roughness: 0.1 }`: the exponent n is about 2 / roughness^2 - 2"),
            ),
            ("backface", Called("two_sided")),
            ("doublesided backfaceculling", Called("two_sided")),
            (
                "ior eta indexofrefraction intior n transmission transmissionweight transmissionfactor refractive",
                GLASS,
            ),
            ("metallic metalness metallicfactor metal metalnes k", METAL),
            (
                "specular ks specularweight specularfactor",
                Write("`plastic: { reflectance: 0.5 }`, or `phong: { specular: 0.2 }` as in textbooks"),
            ),
            ("sigma", Write("`diffuse: { roughness: 0.5 }`")),
            (
                "emission emissive emissivefactor emissionstrength emissioncolor ke emissionweight ambient le radiance",
                GLOW,
            ),
            (
                "clearcoat coat coatweight coatroughness sheen sheenweight sheenroughness clearcoatroughness fuzz thinfilm flatness",
                LAYERED,
            ),
            ("subsurface subsurfaceweight subsurfaceradius sss scatter scattering mfp", SUBSURFACE),
            (
                "anisotropy anisotropic",
                Write("`conductor: { roughness: 0.3, roughness_v: 0.05 }`, along the texture's u and v"),
            ),
            ("opacity alphamode alphacutoff opacitymask cutout dissolve d tr", MASKS),
            ("bumpmap bumptexture", Called("bump")),
            ("normalmap normal normaltexture", Called("normal_map")),
            ("bumpscale normalscale", BUMPS),
            ("displacement displacementmap", NotYet("displacement maps")),
            ("map texture mapkd basecolortexture image bitmap filename colormap pigment file", TEXTURES),
            ("checker checkerboard pattern", CHECKER),
            (
                "interior exterior medium insidemedium volume sigmaa sigmas absorptioncolor attenuationdistance fog mediuminterface",
                MEDIA,
            ),
            (
                "dispersion abbe cauchyb abbenumber",
                Write("`eta: SF11`, the name of a glass, or `eta: { cauchy: [1.5, 0.004] }`"),
            ),
            ("type kind bsdf", TYPE),
            ("thin thinwalled", Write("`thin_dielectric: { eta: 1.5 }`")),
        ],
    ),
];

/// What other kinds are where one of these may stand.
pub(super) const KINDS: &[Table] = &[(
    "diffuse",
    &[
        ("matte lambert lambertian diffusebsdf bsdfdiffuse lambertmaterial", Called("diffuse")),
        (
            "glass refractive glassbsdf water smoothdielectric bsdfglass refractionbsdf refraction",
            Called("dielectric"),
        ),
        (
            "metal roughconductor smoothconductor metallic conductorbsdf roughmetal metalbsdf",
            Called("conductor"),
        ),
        ("reflective perfectmirror specular mirrorbsdf specularreflection perfectspecular", Called("mirror")),
        (
            "gold silver copper aluminium aluminum iron chrome brass titanium platinum",
            Write("`conductor: { metal: gold }`, with the name of the metal"),
        ),
        ("roughdielectric roughglass frostedglass", ROUGH_GLASS),
        ("thinglass archglass", Called("thin_dielectric")),
        ("soap bubble soapbubble film oil iridescence iridescent oxide", Called("thin_film")),
        ("roughdiffuse orennayar rough", Write("`diffuse: { roughness: 0.5 }`")),
        ("velvet cloth fabric sheenbsdf charlie", Called("sheen")),
        ("blinn blinnphong", Write("`phong: { highlight: blinn }`")),
        ("modifiedphong", Called("phong")),
        ("difftrans diffusetransmit paper", Called("diffuse_transmission")),
        ("roughplastic substrate uber glossycoating glossytranslucent shiny glossybsdf", Called("plastic")),
        ("coateddiffuse", Called("coated_diffuse")),
        ("coatedconductor", Called("coated_conductor")),
        ("anisotropic ward", Write("`conductor: { roughness: 0.3, roughness_v: 0.05 }`")),
        ("openpbr standardsurface openpbrsurface pbr layered clearcoat carpaint uberv2", Called("open_pbr")),
        ("principledbsdf disney disneybsdf", Called("principled")),
        ("pbrmetallicroughness metallicroughness gltfpbr gltfmaterial", Called("gltf")),
        (
            "subsurface subsurfacescattering translucent translucentbsdf kdsubsurface normalizedsubsurface mattetranslucent hk",
            SUBSURFACE,
        ),
        ("hair hairbsdf principledhair", HAIR),
        ("measured merl fourier irawan rgl measuredbsdf", NotYet("materials measured in a laboratory")),
        ("toon toonbsdf cel", NotYet("drawn looks")),
        ("coating roughcoating dielectriccoating", LAYERED),
        ("principledthin thinprincipled", Write("`principled: { two_sided: true }`, which has a thickness")),
        ("mixbsdf blend blendbsdf blendmaterial mixmaterial", Called("mix")),
        ("alpha opacity cutout transparentbsdf", Called("mask")),
        ("null interface none", MEDIA),
        ("bumpmap normalmap bump", BUMPS),
        (
            "twosided",
            Write(
                "`two_sided: true` in the material; it is so without being said. `two_faces: { front: a, back: b }` has one for each side",
            ),
        ),
        ("emission emissive emitter light area arealight emissionbsdf diffuselight", GLOW),
        (
            "color colour rgb texture pigment bitmap image checker checkerboard",
            Write("`diffuse: { reflectance: [0.8, 0.2, 0.2] }`"),
        ),
        ("reflectance albedo kd basecolor", Write("`diffuse: { reflectance: [0.8, 0.2, 0.2] }`")),
        ("bsdf material shader type", TYPE),
    ],
)];
