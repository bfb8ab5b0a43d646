//! Words at the top of a scene.

use super::Here::{Called, NotYet, Write};
use super::Table;
use super::answers::{ANIMATION, CAMERA, MEDIA, SIZE, SPP, TEXTURES};

/// What words are in mappings of these marks.
pub(super) const KEYS: &[Table] = &[(
    "world",
    &[
        ("sensor sensors cameras view viewpoint cam", Called("camera")),
        (
            "shape shapes scene geometry geometries meshes mesh nodes node primitives entities surfaces models root graph items things",
            Called("world"),
        ),
        ("bsdf bsdfs material shaders shader mats brdf brdfs", Called("materials")),
        ("light emitter emitters lamps lamp luminaires lightsources lightsource lighting", Called("lights")),
        (
            "background backgroundcolor worldcolor skycolor sky environment envmap hdri infinitelight ambient ambientlight skysphere backdrop",
            Write(
                "`lights: [environment: { radiance: [0.5, 0.7, 1] }]`, or `file: sky.hdr` in place of `radiance`",
            ),
        ),
        ("image output rendersettings picture render settings options", Called("film")),
        ("resolution width height xresolution yresolution size imagesize", SIZE),
        ("filter rfilter pixelfilter", Write("`film: { filter: box }`")),
        ("crop exposure tone gamma bits dither tonemap tonemapping", Write("it stands in `film: { ... }`")),
        ("spp samples pixelsamples samplesperpixel samplecount aa aasamples", SPP),
        ("seed noise", Write("it stands in `sampler: { ... }`")),
        (
            "maxdepth bounces maxbounces depth raydepth maxraydepth path",
            Write("`integrator: { path: { max_depth: 8 } }`"),
        ),
        ("renderer engine surfaceintegrator integrators pathtracer tracer", Called("integrator")),
        ("accelerator bvh acceleration kdtree", Called("accel")),
        ("colorspace colour", Called("color")),
        ("lookat fov eye perspective orthographic fisheye panorama from up target origin pinhole", CAMERA),
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
        ("texture images pigment", TEXTURES),
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
)];
