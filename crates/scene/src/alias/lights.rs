//! Words for lights.

use super::Here::{Called, Write};
use super::Table;
use super::answers::{AREA, TYPE};

/// What words are in mappings of these marks.
pub(super) const KEYS: &[Table] = &[
    (
        "turbidity sun_direction",
        &[
            ("direction sundir lightdirection towards", Called("sun_direction")),
            ("albedo groundcolor groundcolour ground", Called("ground_albedo")),
            ("haze haziness", Called("turbidity")),
            ("sunsize sunaperture angle angulardiameter sundisc sundisk", Called("sun_angle")),
            ("sunintensity sunstrength sunmultiplier", Called("sun_scale")),
            ("scale intensity strength multiplier skyintensity", Called("sky_scale")),
            ("complexsun", Called("limb_darkening")),
            (
                "latitude longitude timezone year month day hour minute date time",
                Write(
                    "`when: { latitude: 52, longitude: 4.9, date: [2026, 6, 21], hour: 14.5, utc_offset: 2 }`",
                ),
            ),
            (
                "elevation azimuth suntheta sunphi",
                Write("`sun_direction`, towards the sun: `sun_direction: [1, 2, 1]`"),
            ),
            ("toworld matrix", Called("transform")),
        ],
    ),
    (
        "picture fov",
        &[
            ("from pos location origin", Called("position")),
            ("to target pointat lookto", Called("look_at")),
            ("dir axis", Called("direction")),
            ("texture image file filename map slide irradiance", Called("picture")),
            ("scale power energy strength brightness", Called("intensity")),
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
            ("map gobo mask cookie picture image filename", Called("texture")),
            (
                "ies goniometric",
                Write("a `goniometric` light: `goniometric: { position: ..., file: lamp.ies }`"),
            ),
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
            (
                "ies filename goniometric file",
                Write("a `goniometric` light: `goniometric: { position: ..., file: lamp.ies }`"),
            ),
            ("transform toworld matrix", Called("position")),
            (
                "areaofeffect fadedistance fadepower range quadratic falloff attenuation",
                Write("`decay`: `inverse_square`, as light falls, or `none`"),
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
            ("angulardiameter sunangle aperture size softness diameter width", Called("angle")),
            (
                "rotation rotate transform toworld elevation azimuth",
                Write("`direction`, in which the light travels: `direction: [-1, -2, -1]`"),
            ),
            ("turbidity", Write("a light of its own: `sky: { sun_direction: [1, 2, 1], turbidity: 3 }`")),
        ],
    ),
    (
        "layout",
        &[
            ("filename map mapname image texture hdri path hdr envmap exr src", Called("file")),
            ("l color colour background emission", Called("radiance")),
            ("intensity strength multiplier gain brightness energy power", Called("scale")),
            ("stops ev", Called("exposure")),
            ("filter colorize colourise multiplycolor", Called("tint")),
            ("toworld matrix worldtolight xform", Called("transform")),
            ("rotation angle yaw orientation azimuth rotationz rotationy", Called("rotate")),
            ("mapping projection format", Called("layout")),
            (
                "sundirection turbidity albedo groundalbedo",
                Write("a light of its own: `sky: { sun_direction: [1, 2, 1], turbidity: 3 }`"),
            ),
            ("colors colours ramp", Called("gradient")),
            ("importanceresolution importance", Write("nothing: bright parts are found without asking")),
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
            "infinite env envmap hdri dome background constant environmentlight domelight imageinfinite hdr world infinitelight constantinfinite surroundings",
            Called("environment"),
        ),
        (
            "area arealight rectlight rectangle quad quadlight mesh disk disc sphere diffuse diffusearea meshlight trianglelight spherelight disklight rectarea",
            AREA,
        ),
        ("projection projectionlight slide beamer texturedpoint", Called("projector")),
        ("ies photometric mappoint eulumdat measured", Called("goniometric")),
        ("sunsky skylight sky2 hosekwilkie nishita preetham daylight physicalsky", Called("sky")),
        ("type light emitter", TYPE),
    ],
)];
