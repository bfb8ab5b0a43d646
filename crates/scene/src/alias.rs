//! Words that people bring from other programs: pbrt, Mitsuba, Blender, glTF, POV-Ray, LuxCore. For each, what it is called here, how
//! the same is said, or that it can't be said yet. Nobody has to guess why a word is unknown.

use crate::decode::Fields;
use crate::desc::Scene;
use crate::suggest::fold;

/// What a word of another program is here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Here {
    /// It has another name, which takes the same value.
    Called(&'static str),
    /// The same is said in another way: what to write.
    Write(&'static str),
    /// It can't be said: what isn't supported.
    NotYet(&'static str),
}

use Here::{Called, NotYet, Write};

/// One or several words of one meaning, without case, `_` and `-`, with spaces between.
type Rule = (&'static str, Here);

/// What a key is here, of a mapping that is called `owner` and has the keys `known`.
pub fn of_key(word: &str, owner: &str, known: &[&str]) -> Option<Here> {
    let word = fold(word).collect::<String>();
    let fits = |here: &Here| match here {
        Called(key) => known.contains(key),
        _ => true,
    };
    let find = |rules: &'static [Rule]| {
        rules.iter().find(|(words, here)| fits(here) && words.split(' ').any(|w| w == word)).map(|r| r.1)
    };
    let tables = KEYS.iter().filter(|(marks, _)| {
        marks.split(' ').any(|mark| match mark.strip_suffix(':') {
            Some(name) => name == owner,
            None => known.contains(&mark),
        })
    });
    tables.filter_map(|(_, rules)| find(rules)).next().or_else(|| find(ANYWHERE))
}

/// Whether a word is one of a scene's own, in whatever letters, or one that only another renderer has in its place. Words that stand
/// in files of all kinds are none.
pub fn is_of_a_scene(word: &str) -> bool {
    const OTHERS: [&str; 10] = [
        "sensor",
        "sensors",
        "cameras",
        "shapes",
        "bsdf",
        "bsdfs",
        "emitter",
        "emitters",
        "lookat",
        "lightsources",
    ];
    let mut names = Vec::new();
    <Scene as Fields>::names(&mut names);
    names.iter().chain(&OTHERS).any(|name| fold(name).eq(fold(word)))
}

/// What a kind is here, where one of `kinds` is expected.
pub fn of_kind(word: &str, kinds: &[&str]) -> Option<Here> {
    let word = fold(word).collect::<String>();
    let tables = KINDS.iter().filter(|(mark, _)| kinds.contains(mark));
    let mut rules = tables.flat_map(|(_, rules)| rules.iter());
    rules.find(|(words, _)| words.split(' ').any(|w| w == word)).map(|r| r.1)
}

const TEXTURES: Here = NotYet("textures");
const MEDIA: Here = NotYet("fog, smoke and other media");
const ROUGH_GLASS: Here = NotYet("rough glass");
const LAYERED: Here = NotYet("coated and layered materials");
const MASKS: Here = NotYet("masks and transparency");
const BUMPS: Here = NotYet("bump, normal and displacement maps");
const SUBSURFACE: Here = NotYet("light that travels below a surface");
const CSG: Here = NotYet("shapes made by union, intersection and difference");
const HAIR: Here = NotYet("curves and hair");
const ANIMATION: Here = NotYet("animations");
const PLACE: Here = Write("`transform: [translate: [0, 1, 0]]`");
const TURN: Here = Write("`transform: [rotate: { y: 30 }]`");
const SIZE: Here = Write("`film: { size: [640, 360] }` at the top of the scene");
const SPP: Here = Write("`sampler: { spp: 64 }` at the top of the scene");
const GLOW: Here =
    Write("a material doesn't glow: give the shape itself an `emission`, such as `emission: [5, 5, 5]`");
const METAL: Here = Write("a metal is a material of its own, `conductor: { metal: gold, roughness: 0.1 }`");
const GLASS: Here = Write("glass is a material of its own, `dielectric: { eta: 1.5 }`");
const LENS: Here = Write("`lens: { radius: 0.05, focus_distance: 3 }`, or `f_number` in place of `radius`");
const VIEW: Here = Write("a camera stands and looks by `eye`, `look_at` and `up`");
const VERTICAL: Here = Write("`fov: 30, fov_axis: y`, in degrees");
const CAMERA: Here = Write("`camera: { perspective: { eye: [0, 1, 5], look_at: [0, 0, 0], fov: 40 } }`");
const AREA: Here = Write(
    "a shape under `world:` glows by its `emission`, such as `- rectangle: { emission: [5, 5, 5], look_at: [0, 0, 0] }`",
);
const TYPE: Here = Write("the kind is the key itself: `sphere: { ... }`, not `type: sphere`");

/// By marks of the mapping, which are keys that it has, or its name with a colon: what words are in it. The first that fits counts.
const KEYS: &[(&str, &[Rule])] = &[
    // A shape's own keys come before those that all shapes share.
    (
        "sphere: disc:",
        &[
            ("position origin location pos translation translate middle centerpoint", Called("center")),
            ("r size scale", Called("radius")),
            ("diameter", Write("`radius`, half of it")),
        ],
    ),
    (
        "cylinder:",
        &[
            ("p0 point1 start base basepoint bottom", Called("from")),
            ("p1 point2 end cap cappoint top", Called("to")),
            ("r", Called("radius")),
            ("height length zmin zmax h", Write("`from` and `to`, the middles of its ends")),
            ("open closed capped", Called("caps")),
        ],
    ),
    (
        "box:",
        &[
            ("minimum corner1 lower pmin p0 from", Called("min")),
            ("maximum corner2 upper pmax p1 to", Called("max")),
            (
                "center position size dimensions width height depth side length extents halfextents",
                Write("`min` and `max`, two opposite corners: `min: [-1, 0, -1], max: [1, 2, 1]`"),
            ),
        ],
    ),
    (
        "rectangle:",
        &[
            (
                "size width height scale dimensions sizex sizey side",
                Write("`transform: [scale: 0.5]`: without it the rectangle is 2 by 2"),
            ),
            (
                "center position location origin pos",
                Write("`transform: [translate: [0, 3, 0]]`, or `corner` and `edges`"),
            ),
            ("normal direction facing", Write("`look_at`, a point that its front is turned towards")),
            ("target to pointat", Called("look_at")),
            ("vertices points corners", Write("`corner` and the two `edges` from it")),
            ("u v edge1 edge2 p0 p1 p2", Write("`edges: [[2, 0, 0], [0, 0, 2]]`, from `corner`")),
        ],
    ),
    (
        "plane: disc:",
        &[
            ("origin center position location pos", Called("point")),
            ("n direction up", Called("normal")),
            ("distance d offset", Write("`point: [0, 1, 0]`, any point on it")),
            ("size scale width height", Write("a plane is infinite: a `rectangle` has a size")),
        ],
    ),
    (
        "mesh:",
        &[
            ("filename path src source url uri plymesh objfile meshfile plyfile obj ply", Called("file")),
            ("vertices points p verts vertex position coords", Called("positions")),
            ("indices faces tris faceindices vertexindices polygons index", Called("triangles")),
            ("n vertexnormals normal", Called("normals")),
            ("uv st texcoords texcoord texturecoordinates", Called("uvs")),
            (
                "smooth smoothing autosmooth shadesmooth facenormals flatshading",
                Write("`shading: smooth` or `shading: flat`"),
            ),
            ("subdivision subdivisionlevels levels subdiv", NotYet("subdivision surfaces")),
        ],
    ),
    (
        "instance:",
        &[("object ref reference shape id geometry mesh source use target shapegroup", Called("of"))],
    ),
    ("group:", &[("objects shapes nodes items members content contents world", Called("children"))]),
    (
        "bezier:",
        &[
            ("controlpoints vertices", Called("points")),
            ("tessellation segments subdivisions", Called("resolution")),
            ("name preset model", Called("builtin")),
        ],
    ),
    (
        "xyz",
        &[
            ("value color colour rgbvalue srgb", Called("rgb")),
            ("hex html css", Write("'#rrggbb' in quotes, without a mapping")),
            ("hsv hsl hue", Write("'#rrggbb' in quotes, or `lch: [50, 60, 30]`")),
            ("colorspace", Called("space")),
            ("texture image file map filename checker checkerboard bitmap noise", TEXTURES),
        ],
    ),
    (
        "blackbody",
        &[
            ("temperature kelvin t colortemperature", Called("blackbody")),
            ("lambda nm", Called("wavelengths")),
            ("filename path spd", Called("file")),
            ("illuminant preset", Called("name")),
        ],
    ),
    (
        "emission children of",
        &[
            (
                "bsdf bsdfs shader mat materialname materialid namedmaterial surface brdf matname materialslot ref",
                Called("material"),
            ),
            (
                "emitter arealight emissive emissivefactor emissioncolor emissionstrength radiance light le glow l emit selfillumination luminance areaemitter",
                Called("emission"),
            ),
            (
                "power watts energy intensity",
                Write("`emission` is radiance in W/(m^2 sr): power / (pi x area)"),
            ),
            ("twosided doublesided", Called("two_sided_emission")),
            ("flipnormals flipnormal reverseorientation invert inverse inside flipfaces", Called("flip")),
            ("id label", Called("name")),
            ("target pointat aimat facing lookto to", Called("look_at")),
            (
                "color colour albedo basecolor reflectance diffuse kd diffusecolor",
                Write("`material: { diffuse: { reflectance: [0.8, 0.2, 0.2] } }`"),
            ),
            ("pigment finish textured texture normalmap", TEXTURES),
            ("ior eta indexofrefraction", Write("`material: { dielectric: { eta: 1.5 } }`")),
            ("position location translate translation origin center pos at", PLACE),
            (
                "rotate rotation orientation angle euler quaternion rot rotationeuler rotationquaternion rotationaxisangle",
                TURN,
            ),
            ("scale scaling size", Write("`transform: [scale: 2]`")),
            (
                "toworld matrix world localtoworld objecttoworld xform transformation transforms matrixworld objecttransform",
                Called("transform"),
            ),
            (
                "visible hide hidden hiderender castshadows visibility primaryvisibility",
                NotYet("things that some rays don't see"),
            ),
            ("motion velocity animation keyframes", NotYet("things that move")),
            ("segments resolution subdivisions tessellation", Write("nothing: the shape is exact")),
        ],
    ),
    (
        "eye",
        &[
            (
                "from origin position pos location lookfrom eyepoint viewpoint center cameraposition p translation",
                Called("eye"),
            ),
            (
                "to target at lookto lookat lookatpoint interest centerofinterest viewtarget focuspoint aim",
                Called("look_at"),
            ),
            ("lookat", Called("target")),
            ("to at", Called("target")),
            (
                "direction dir forward viewdirection",
                Write("`look_at`, a point that it looks at: `eye` plus the direction"),
            ),
            ("vup upvector sky updirection worldup", Called("up")),
            (
                "angle fieldofview hfov fovx fovdegrees viewangle xfov cameraangle lensangle anglex fovdeg",
                Called("fov"),
            ),
            ("yfov vfov fovy vertfov angley", VERTICAL),
            ("axis", Called("fov_axis")),
            ("focal f lensmm lensfocallength", Called("focal_length")),
            ("sensorwidth filmwidth filmdiag horizontalaperture sensorsize", Called("sensor")),
            (
                "aperture aperturesize apertureradius apertureratio lensradius fstop fnumber dof depthoffield focusdistance focaldistance defocusangle bokeh blades",
                LENS,
            ),
            (
                "toworld matrix transform cameratoworld worldtocamera xform rotate rotation orientation rotationeuler translate quaternion",
                VIEW,
            ),
            (
                "near far nearclip farclip clipstart clipend clippingrange znear zfar clip hither yon",
                Write("nothing: rays see at every distance"),
            ),
            (
                "resolution width height size film aspect aspectratio framaspectratio right frameaspectratio imagesize",
                SIZE,
            ),
            ("sampler spp samples samplecount", SPP),
            ("xmag ymag orthoscale orthographicscale", Write("`height`, that of the view")),
            ("shutteropen shutterclose exposuretime shutterspeed", Write("`shutter: [0, 1]`")),
            ("exposure iso sensitivity", Write("`film: { exposure: 1 }`, in stops, at the top of the scene")),
            ("type kind projection", TYPE),
            ("medium", MEDIA),
            (
                "screenwindow principalpointoffsetx principalpointoffsety shiftx shifty lensshift",
                Write("`shift: [0, 0]`, in widths and heights of the picture"),
            ),
        ],
    ),
    (
        "radius f_number focus_distance",
        &[
            ("fstop fnumber aperture f", Called("f_number")),
            ("distance focaldistance focusdist focus", Called("focus_distance")),
            ("lensradius apertureradius size", Called("radius")),
            ("target focusobject object", Called("focus_on")),
        ],
    ),
    (
        "degrees",
        &[
            ("angle angledegrees value deg theta", Called("degrees")),
            ("v vector direction around about", Called("axis")),
            ("radians rad", Write("`degrees`")),
        ],
    ),
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
            (
                "map texture mapkd basecolortexture image bitmap filename colormap pigment file checker checkerboard pattern",
                TEXTURES,
            ),
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
    (
        "cutoff beam",
        &[
            ("from pos location origin at", Called("position")),
            ("to target pointat at aim lookto lookatpoint", Called("look_at")),
            ("dir axis", Called("direction")),
            (
                "coneangle cutoffangle angle outerconeangle radius outerangle outer halfangle",
                Called("cutoff"),
            ),
            ("spotsize fullangle", Write("`cutoff`, half of that angle, in degrees")),
            ("conedeltaangle", Write("`beam`, `coneangle` less `conedeltaangle`")),
            ("beamwidth innerconeangle inner innerangle hotspot falloffstart", Called("beam")),
            (
                "spotblend blend penumbra penumbraangle tightness softness",
                Write("`beam`, the angle up to which light is full"),
            ),
            (
                "color colour i power energy strength radiance brightness watts emission l",
                Called("intensity"),
            ),
            ("texture map ies", TEXTURES),
        ],
    ),
    (
        "position",
        &[
            ("from pos location origin at center", Called("position")),
            (
                "color colour i power energy strength radiance brightness watts emission l lumens flux",
                Called("intensity"),
            ),
            ("scale multiplier", Write("`intensity` times that")),
            (
                "radius size softsize shadowsoftsize",
                Write(
                    "a ball under `world:` that glows: `- sphere: { radius: 0.1, emission: [50, 50, 50] }`",
                ),
            ),
            (
                "direction lookat to target",
                Write("a `spot` light has a direction: `spot: { position: ..., look_at: ... }`"),
            ),
            ("ies filename goniometric", NotYet("lamps that shine by a measured table")),
            ("transform toworld matrix", Called("position")),
            (
                "areaofeffect fadedistance fadepower decay range quadratic falloff attenuation",
                Write("nothing: light falls with the square of the distance, as it does"),
            ),
        ],
    ),
    (
        "irradiance",
        &[
            ("dir sundirection lightdirection", Called("direction")),
            ("to target pointat lookto", Called("look_at")),
            ("position origin location pos", Called("from")),
            (
                "radiance l color colour strength energy power intensity brightness illuminance emission",
                Called("irradiance"),
            ),
            ("scale multiplier", Write("`irradiance` times that")),
            ("angle angulardiameter sunangle", NotYet("suns with a width")),
            (
                "rotation rotate transform toworld elevation azimuth turbidity",
                Write("`direction`, in which the light travels: `direction: [-1, -2, -1]`"),
            ),
        ],
    ),
    (
        "layout",
        &[
            ("filename map mapname image texture hdri path hdr envmap exr src", Called("file")),
            ("l color colour background emission", Called("radiance")),
            ("intensity strength multiplier gain brightness exposure energy power", Called("scale")),
            ("toworld matrix worldtolight xform", Called("transform")),
            ("rotation angle yaw orientation azimuth rotationz rotationy", Called("rotate")),
            ("mapping projection format", Called("layout")),
            ("sundirection turbidity albedo groundalbedo", NotYet("computed skies")),
            (
                "importanceresolution importance portal",
                Write("nothing: bright parts are found without asking"),
            ),
        ],
    ),
    (
        "size",
        &[
            (
                "resolution res dimensions pixels xresolution yresolution width height imagesize imagewidth imageheight resolutionx resolutiony w h",
                Write("`size: [640, 360]`"),
            ),
            (
                "filename output file outputfile path",
                Write("nothing: `-o picture.png` on the command line says where the picture goes"),
            ),
            (
                "format fileformat pixelformat componentformat",
                Write("nothing: the name after `-o` says the format, such as `-o picture.exr`"),
            ),
            ("rfilter pixelfilter reconstructionfilter filtertype", Called("filter")),
            ("cropwindow region window border cropbox", Called("crop")),
            ("ev stops iso brightness exposurecompensation", Called("exposure")),
            ("tonemap tonemapping tonemapper viewtransform tonecurve", Called("tone")),
            ("gammacorrection displaygamma", Called("gamma")),
            ("bitdepth depth colordepth", Called("bits")),
            ("samples spp samplecount pixelsamples", SPP),
            ("colorspace colourspace", Write("`color: { space: srgb }` at the top of the scene")),
            (
                "background",
                Write("`lights: [environment: { radiance: [0.5, 0.7, 1] }]` at the top of the scene"),
            ),
            ("aspect aspectratio", Write("`size: [640, 360]`, whose pixels are square")),
        ],
    ),
    (
        "spp",
        &[
            (
                "samples samplecount pixelsamples samplesperpixel aasamples sampleperpixel numsamples count n passes nsamples subpixelsamples",
                Called("spp"),
            ),
            ("type pattern name method sampler", Called("kind")),
            ("noisethreshold threshold adaptive adaptivethreshold error maxerror", Called("noise")),
            ("randomseed", Called("seed")),
        ],
    ),
    (
        "max_depth",
        &[
            (
                "bounces maxbounces maxraydepth depth tracedepth maxtracelevel maxpathdepth raydepth",
                Called("max_depth"),
            ),
            ("rrdepth russianroulettedepth rrstart", Called("roulette_depth")),
            (
                "hideemitters rrthreshold regularize lightsampler clamp clampindirect",
                Write("nothing: it can't be changed"),
            ),
            ("samples spp", SPP),
        ],
    ),
    (
        "world",
        &[
            ("sensor sensors cameras view viewpoint cam", Called("camera")),
            (
                "shape shapes scene geometry geometries meshes mesh nodes node primitives entities surfaces models root graph items things",
                Called("world"),
            ),
            ("bsdf bsdfs material shaders shader mats brdf brdfs", Called("materials")),
            (
                "light emitter emitters lamps lamp luminaires lightsources lightsource lighting",
                Called("lights"),
            ),
            (
                "background backgroundcolor worldcolor skycolor sky environment envmap hdri infinitelight ambient ambientlight skysphere backdrop",
                Write(
                    "`lights: [environment: { radiance: [0.5, 0.7, 1] }]`, or `file: sky.hdr` in place of `radiance`",
                ),
            ),
            ("image output rendersettings picture render settings options", Called("film")),
            ("resolution width height xresolution yresolution size imagesize", SIZE),
            ("filter rfilter pixelfilter", Write("`film: { filter: box }`")),
            (
                "crop exposure tone gamma bits dither tonemap tonemapping",
                Write("it stands in `film: { ... }`"),
            ),
            ("spp samples pixelsamples samplesperpixel samplecount aa aasamples", SPP),
            ("seed noise", Write("it stands in `sampler: { ... }`")),
            (
                "maxdepth bounces maxbounces depth raydepth maxraydepth path",
                Write("`integrator: { path: { max_depth: 8 } }`"),
            ),
            ("renderer engine surfaceintegrator integrators pathtracer tracer", Called("integrator")),
            ("accelerator bvh acceleration kdtree", Called("accel")),
            ("colorspace colour", Called("color")),
            (
                "lookat fov eye perspective orthographic fisheye panorama from up target origin pinhole",
                CAMERA,
            ),
            (
                "sphere plane disc rectangle box cylinder triangle instance group bezier",
                Write("shapes are items of the list `world`, such as `- sphere: { radius: 1 }`"),
            ),
            (
                "point spot directional sun arealight area",
                Write(
                    "lamps are items of the list `lights`, such as `- point: { position: [0, 3, 0], intensity: 10 }`",
                ),
            ),
            (
                "diffuse mirror dielectric conductor",
                Write(
                    "materials have names: `materials: { red: { diffuse: { reflectance: [0.8, 0.1, 0.1] } } }`",
                ),
            ),
            ("texture textures images pigment", TEXTURES),
            ("media medium volumes volume fog atmosphere mediums smoke", MEDIA),
            ("animation animations frames keyframes frame time fps", ANIMATION),
            ("include includes import imports extends", NotYet("scenes in several files")),
            (
                "asset assets version globalsettings metadata units scenes extensionsused",
                Write("nothing: a scene has no header"),
            ),
            (
                "default defaults define parameters variables declare",
                Write("variables are not supported yet: `&name` and `*name` of YAML repeat a value"),
            ),
            ("name title description author comment", Write("a comment: `# ...`")),
        ],
    ),
];

/// Words that mean the same wherever they stand.
const ANYWHERE: &[Rule] = &[
    ("type", TYPE),
    ("texture textures checker checkerboard bitmap imagemap noise3d marble wood procedural", TEXTURES),
    ("medium media interior exterior sigmaa sigmas sigmat volume fog mediuminterface", MEDIA),
    ("bump bumpmap normalmap displacement displacementmap", BUMPS),
    ("alpha opacity mask alphamode", MASKS),
    ("subsurface sss", SUBSURFACE),
    ("clearcoat coat sheen", LAYERED),
    ("animation keyframes", ANIMATION),
    ("include import", NotYet("scenes in several files")),
];

/// By a kind that may stand there: what other kinds are.
const KINDS: &[(&str, &[Rule])] = &[
    (
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
            (
                "reflective perfectmirror specular mirrorbsdf specularreflection perfectspecular",
                Called("mirror"),
            ),
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
    ),
    (
        "sphere",
        &[
            ("ball sphereshape uvsphere icosphere ellipsoid", Called("sphere")),
            ("cube cuboid block rectangularcuboid aabb boxshape", Called("box")),
            ("quad rect square parallelogram rectanglelight grid", Called("rectangle")),
            ("disk circle diskshape", Called("disc")),
            ("tri trianglesingle", Called("triangle")),
            (
                "trimesh trianglemesh plymesh obj ply objmesh polygonmesh mesh2 indexedtriangleset mesh3d model serialized stl meshobject import file triangles",
                Called("mesh"),
            ),
            ("tube pipe", Called("cylinder")),
            ("ground floor infiniteplane halfspace groundplane", Called("plane")),
            (
                "xform node collection empty assembly nodes parent locator transform attributebegin object",
                Called("group"),
            ),
            ("use ref reference objectinstance copy clone shapeinstance", Called("instance")),
            ("teapot patch patches bezierpatch bicubicpatch bilinearmesh", Called("bezier")),
            ("arealight rectlight area quadlight", AREA),
            (
                "light pointlight point spot spotlight directional distant environment infinite sun emitter lamp",
                Write("lamps are items of the list `lights`; shapes glow by their `emission`"),
            ),
            ("camera sensor", CAMERA),
            (
                "material bsdf materials",
                Write("materials are entries of the mapping `materials`, and a shape's `material`"),
            ),
            ("type shape", TYPE),
            ("union difference intersection merge csg boolean", CSG),
            ("curve curves hair bsplinecurve linearcurve fur", HAIR),
            (
                "heightfield torus cone volume nurbs sdf sdfgrid blob isosurface julia juliafractal text prism lathe superellipsoid hyperboloid paraboloid loopsubdiv catmullclark subdivision spheresweep metaball sor",
                Write("not supported yet; as a mesh it can be read: `mesh: { file: torus.ply }`"),
            ),
        ],
    ),
    (
        "directional",
        &[
            ("pointlight omni omnilight lightsource bulb", Called("point")),
            (
                "distant distantlight sun sunlight sharpdistant parallel infinitedirectional",
                Called("directional"),
            ),
            ("spotlight cone conelight", Called("spot")),
            (
                "infinite env envmap hdri dome sky skylight background constant ambient environmentlight domelight imageinfinite hdr world infinitelight constantinfinite ambientlight surroundings",
                Called("environment"),
            ),
            (
                "area arealight rectlight rectangle quad quadlight mesh disk disc sphere diffuse diffusearea meshlight trianglelight spherelight disklight rectarea",
                AREA,
            ),
            (
                "goniometric ies projector projection projectionlight photometric texturedpoint mappoint",
                NotYet("lamps that shine by a picture or a table"),
            ),
            ("sunsky sky2 hosekwilkie nishita preetham", NotYet("computed skies")),
            ("type light emitter", TYPE),
        ],
    ),
    (
        "perspective",
        &[
            (
                "pinhole thinlens realistic perspectivecamera projective persp persppinhole camera thinlenscamera perspectivepinhole",
                Called("perspective"),
            ),
            ("ortho orthographiccamera parallel thinlensortho", Called("orthographic")),
            (
                "spherical equirectangular environment panoramic latlong omni omnidirectional equirect environmentcamera latitudelongitude",
                Called("panorama"),
            ),
            ("fisheyelens fisheyeequidistant ultrawideangle", Called("fisheye")),
            ("cube cubecamera", Called("cube_map")),
            ("type sensor", TYPE),
            ("eye lookat from position origin fov to target location angle up", CAMERA),
        ],
    ),
    (
        "sine_product",
        &[
            ("pathtracer pt pathtracing pathcpu cycles pathocl pathnaive unidirectional", Called("path")),
            ("volpath volpathmis volumepath", MEDIA),
            (
                "direct directlighting directlight whitted ray raytracing raytracer simplepath directillumination",
                Write("`path: { max_depth: 2 }`, which is direct light"),
            ),
            (
                "bdpt bidir bidirectional bidircpu mlt pssmlt sppm photonmapper photonmap photon vcm lightpath lighttracer ptracer particletracer metropolis radiosity",
                NotYet("ways of computing light other than path tracing"),
            ),
            (
                "ao ambientocclusion aov depth normals",
                Write(
                    "not supported yet as a picture of its own: an EXR has layers of depth, normals and colours",
                ),
            ),
            ("maxdepth bounces", Write("`path: { max_depth: 8 }`")),
            ("type", TYPE),
        ],
    ),
    (
        "tent",
        &[
            ("triangle bartlett linear", Called("tent")),
            ("sinc lanczossinc windowedsinc", Called("lanczos")),
            ("catmullrom cubic bspline", Write("`mitchell: { b: 0, c: 0.5 }`, which is Catmull and Rom's")),
            ("none nearest", Called("box")),
            ("type", TYPE),
        ],
    ),
    (
        "multi_jittered",
        &[
            ("independent", Called("random")),
            ("stratified", Called("jittered")),
            ("zsobol paddedsobol owen lowdiscrepancy ldsampler qmc", Called("sobol")),
            (
                "pmj02bn pmj pmj02 correlatedmultijittered cmj multijitter orthogonal",
                Called("multi_jittered"),
            ),
            ("bluenoise tabulatedsobol", Called("blue_sobol")),
            ("uniform", Called("regular")),
        ],
    ),
    (
        "khronos_neutral",
        &[
            ("none linear standard raw", Called("clamp")),
            ("uncharted2 hejl uncharted", Called("hable")),
            ("pbrneutral neutral khronos", Called("khronos_neutral")),
            ("acesfilmic acesfitted", Called("aces")),
            ("narkowicz acesapprox", Called("filmic")),
        ],
    ),
    (
        "shear",
        &[
            ("move translation location position offset", Called("translate")),
            ("rotation rotatex rotatey rotatez turn rot", Called("rotate")),
            ("scaling size", Called("scale")),
            ("mirror flip", Called("reflect")),
            ("skew", Called("shear")),
            ("toworld concattransform transform", Called("matrix")),
            ("quaternion", Write("`rotate: { axis: [0, 1, 0], degrees: 30 }`")),
            ("axis degrees angle", Write("`rotate: { axis: y, degrees: 30 }`, or `rotate: { y: 30 }`")),
        ],
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_looked_up_where_it_stands() {
        let glass = ["eta", "eta_outside", "reflectance", "transmittance"];
        assert_eq!(of_key("int_ior", "dielectric", &glass), Some(Called("eta")));
        assert_eq!(of_key("IOR", "dielectric", &glass), Some(Called("eta")));
        assert_eq!(of_key("ior", "diffuse", &["reflectance", "two_sided"]), Some(GLASS));
        assert_eq!(of_key("Kd", "diffuse", &["reflectance", "two_sided"]), Some(Called("reflectance")));
        assert_eq!(of_key("from", "perspective", &["eye", "look_at"]), Some(Called("eye")));
        assert_eq!(of_key("to", "look_at", &["eye", "target", "up"]), Some(Called("target")));
        assert_eq!(of_key("medium", "whatever", &[]), Some(MEDIA));
        assert_eq!(of_key("frobnicate", "diffuse", &["reflectance"]), None);
        assert_eq!(of_kind("distant", &["point", "directional"]), Some(Called("directional")));
        assert_eq!(of_kind("box", &["tent", "box"]), None);
    }

    #[test]
    fn every_kind_that_is_named_exists() {
        use crate::desc::{Camera, Filter, Integrator, Light, Material, Node, SamplerKind, Step, Tone};
        let all = [
            Camera::KINDS,
            Filter::KINDS,
            Integrator::KINDS,
            Light::KINDS,
            Material::KINDS,
            Node::KINDS,
            SamplerKind::KINDS,
            Step::KINDS,
            Tone::KINDS,
        ];
        for (mark, rules) in KINDS {
            let kinds: Vec<_> = all.iter().filter(|k| k.contains(mark)).collect();
            assert_eq!(kinds.len(), 1, "`{mark}` marks one type");
            for (words, here) in *rules {
                assert!(!matches!(here, Called(kind) if !kinds[0].contains(kind)), "{words}: {here:?}");
                for word in words.split(' ') {
                    assert_eq!(fold(word).collect::<String>(), word, "{words}");
                    // What is a kind itself is never looked up.
                    assert!(!kinds[0].contains(&word), "{mark}: `{word}` is a kind");
                }
            }
        }
        for (words, _) in KEYS.iter().flat_map(|(_, rules)| rules.iter()).chain(ANYWHERE) {
            assert!(words.split(' ').all(|w| fold(w).collect::<String>() == w), "{words}");
        }
    }

    /// The kinds and keys in what is to be written are such as are read.
    #[test]
    fn what_is_to_be_written_can_be_read() {
        let schema = crate::schema().to_string();
        let rules = || KEYS.iter().chain(KINDS).flat_map(|(_, rules)| rules.iter()).chain(ANYWHERE);
        for (words, here) in rules() {
            let Write(text) = here else { continue };
            for quoted in text.split('`').skip(1).step_by(2) {
                for word in quoted.split([' ', '{', '}', '[', ']', ',']).filter_map(|w| w.strip_suffix(':')) {
                    let is_key = word.chars().all(|c| c.is_ascii_lowercase() || c == '_') && !word.is_empty();
                    // `type` is what shouldn't be written, and a material is called red.
                    let is_free = ["type", "red"].contains(&word);
                    assert!(
                        !is_key || is_free || schema.contains(&format!("\"{word}\"")),
                        "{words}: `{word}` in {text}"
                    );
                }
            }
        }
    }
}
