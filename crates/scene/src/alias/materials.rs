//! Words for materials.

use super::Here::{Called, NotYet, Write};
use super::Table;
use super::answers::{
    BUMPS, CHECKER, GLASS, GLOW, HAIR, LAYERED, MASKS, MEDIA, METAL, ROUGH_GLASS, SUBSURFACE, TEXTURES, TYPE,
};

/// What words are in mappings of these marks.
pub(super) const KEYS: &[Table] = &[
    (
        "dielectric:",
        &[("roughness alpha distribution uroughness vroughness alphau alphav roughnessfactor", ROUGH_GLASS)],
    ),
    (
        "diffuse:",
        &[(
            "roughness alpha distribution uroughness vroughness roughnessfactor",
            NotYet("rough diffuse surfaces"),
        )],
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
            ("material metalname type name preset", Called("metal")),
            ("alpha alphau alphav uroughness vroughness roughnessfactor alphax alphay", Called("roughness")),
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
            ("specular ks specularweight specularfactor", NotYet("glossy surfaces over a diffuse base")),
            ("sigma", NotYet("rough diffuse surfaces")),
            (
                "emission emissive emissivefactor emissionstrength emissioncolor ke emissionweight ambient le radiance",
                GLOW,
            ),
            (
                "clearcoat coat coatweight coatroughness sheen sheenweight sheenroughness clearcoatroughness fuzz thinfilm flatness",
                LAYERED,
            ),
            ("subsurface subsurfaceweight subsurfaceradius sss scatter scattering mfp", SUBSURFACE),
            ("anisotropy anisotropic spectrans", NotYet("anisotropic materials")),
            ("opacity alphamode alphacutoff opacitymask cutout dissolve d tr", MASKS),
            ("bump bumpmap normalmap normal normaltexture displacement bumpscale", BUMPS),
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
            ("thin thinwalled", NotYet("thin glass without an inside")),
        ],
    ),
];

/// What other kinds are where one of these may stand.
pub(super) const KINDS: &[Table] = &[(
    "diffuse",
    &[
        ("matte lambert lambertian diffusebsdf bsdfdiffuse lambertmaterial", Called("diffuse")),
        (
            "glass refractive transparent glassbsdf water smoothdielectric bsdfglass refractionbsdf refraction",
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
        ("thindielectric thinglass archglass", NotYet("thin glass without an inside")),
        ("roughdiffuse orennayar rough velvet cloth", NotYet("rough diffuse surfaces and cloth")),
        (
            "glossy glossybsdf anisotropic ward phong blinnphong modifiedphong roughplastic plastic substrate uber glossycoating glossytranslucent shiny",
            NotYet("glossy surfaces over a diffuse base"),
        ),
        (
            "principled principledbsdf disney openpbr standardsurface openpbrsurface pbr coateddiffuse coatedconductor layered clearcoat carpaint pbrmetallicroughness uberv2 toon",
            LAYERED,
        ),
        (
            "subsurface subsurfacescattering translucent translucentbsdf kdsubsurface measured normalizedsubsurface mattetranslucent",
            SUBSURFACE,
        ),
        ("hair hairbsdf principledhair", HAIR),
        (
            "mix mixbsdf blend blendbsdf blendmaterial mixmaterial add addshader",
            NotYet("mixtures of materials"),
        ),
        ("mask null interface transparentbsdf none alpha opacity", MASKS),
        ("bumpmap normalmap bump", BUMPS),
        ("twosided", Write("`two_sided: true` in the material; it is so without being said")),
        ("emission emissive emitter light area arealight emissionbsdf diffuselight", GLOW),
        (
            "color colour rgb texture pigment bitmap image checker checkerboard",
            Write("`diffuse: { reflectance: [0.8, 0.2, 0.2] }`"),
        ),
        ("reflectance albedo kd basecolor", Write("`diffuse: { reflectance: [0.8, 0.2, 0.2] }`")),
        ("bsdf material shader type", TYPE),
    ],
)];
