//! Words for the film, for samples, and for how light is followed.

use super::Here::{Called, NotYet, Write};
use super::Table;
use super::answers::{MEDIA, SPP, TYPE};

/// What words are in mappings of these marks.
pub(super) const KEYS: &[Table] = &[
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
];

/// What other kinds are where one of these may stand.
pub(super) const KINDS: &[Table] = &[
    (
        "sine_product",
        &[
            ("pathtracer pt pathtracing pathcpu cycles pathocl pathnaive unidirectional", Called("path")),
            ("volpath volpathmis volumepath", MEDIA),
            ("directlighting directlight directillumination simplepath", Called("direct")),
            ("ray raytracing raytracer recursive", Called("whitted")),
            ("lightpath lighttracer lighttracing ptracer particletracer", Called("light")),
            (
                "bdpt bidir bidirectional bidircpu mlt pssmlt sppm photonmapper photonmap photon vcm metropolis radiosity",
                NotYet("ways of computing light other than path tracing"),
            ),
            ("ambientocclusion occlusion ambientocclusionintegrator", Called("ao")),
            (
                "aov depth normals",
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
];
