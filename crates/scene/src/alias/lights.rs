//! Words for lights.

use super::Here::{Called, NotYet, Write};
use super::Table;
use super::answers::{AREA, TYPE};

/// What words are in mappings of these marks.
pub(super) const KEYS: &[Table] = &[
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
            ("texture map ies", NotYet("lamps that shine by a picture or a table")),
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
];

/// What other kinds are where one of these may stand.
pub(super) const KINDS: &[Table] = &[(
    "directional",
    &[
        ("pointlight omni omnilight lightsource bulb", Called("point")),
        (
            "distant distantlight sun sunlight sharpdistant parallel infinitedirectional",
            Called("directional"),
        ),
        ("spotlight cone conelight", Called("spot")),
        (
            "infinite env envmap hdri dome sky skylight background constant environmentlight domelight imageinfinite hdr world infinitelight constantinfinite surroundings",
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
)];
