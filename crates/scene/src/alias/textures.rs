//! Words for textures and how they lie.

use super::Here::{Called, NotYet, Write};
use super::Table;
use super::answers::TYPE;

/// What words are in mappings of these marks.
pub(super) const KEYS: &[Table] = &[
    (
        "image:",
        &[
            ("filename path src map image texture mapkd url uri bitmap", Called("file")),
            ("colorspace colourspace encoding raw srgb gamma", Called("color_space")),
            ("filtertype interpolation magfilter minfilter trilinear", Called("filter")),
            ("wrapmode wrapping extension repeat wraps wrapt clamp tile", Called("wrap")),
            ("maxanisotropy", Called("anisotropy")),
            (
                "uscale vscale udelta vdelta su sv tiling scale offset repeatu repeatv touv uv transform toworld rotation translate",
                Write("`mapping: { uv: { scale: [2, 2], rotate: 0, translate: [0, 0] } }`"),
            ),
            ("invert", Write("`invert: { of: { texture: wood } }`, a texture of its own")),
            (
                "multiplier gain brightness strength intensity",
                Write("`scale: { of: { texture: wood }, by: 2 }`, a texture of its own"),
            ),
        ],
    ),
    (
        "checker:",
        &[
            ("tex1 color0 colour0 odd a inside", Called("first")),
            ("tex2 color2 colour2 even b outside", Called("second")),
            (
                "color1 colour1",
                Write("`first` and `second`: the square next to the origin has the first colour"),
            ),
            (
                "touv uscale vscale scale frequency repeat tiles count size dimension tiling",
                Write("`squares: [8, 8]`, how many there are from 0 to 1"),
            ),
            ("filter aamode antialiased", Called("averaged")),
        ],
    ),
    (
        "mix:",
        &[
            ("tex1 color1 a input1 value1 background bg", Called("first")),
            ("tex2 color2 b input2 value2 foreground fg", Called("second")),
            ("factor fac weight blend t mask", Called("amount")),
        ],
    ),
    (
        "scale:",
        &[
            ("tex texture tex1 input image color value", Called("of")),
            ("scale factor strength multiplier tex2", Called("by")),
        ],
    ),
    (
        "ramp:",
        &[
            ("input fac factor t texture", Called("of")),
            ("colors colours keys elements points", Called("stops")),
        ],
    ),
    ("remap:", &[("input texture value", Called("of")), ("gamma exponent", Called("power"))]),
    ("attribute:", &[("attributename property layer layername", Called("name"))]),
];

/// What other kinds are where one of these may stand.
pub(super) const KINDS: &[Table] = &[
    (
        "invert",
        &[
            (
                "imagemap bitmap imagetexture teximage texteximage picture uvtexture map file imagemaps",
                Called("image"),
            ),
            ("checkerboard checkers checkertexture texchecker checkered", Called("checker")),
            (
                "meshattribute vertexcolor vertexcolors vertexcolour vertexcolours vertexattribute colorattribute hitpointcolor",
                Called("attribute"),
            ),
            ("multiply product mul times", Called("scale")),
            ("blend lerp mixtexture mixrgb mixcolor", Called("mix")),
            ("sum plus", Called("add")),
            ("colorramp colourramp valtorgb band curve colorband", Called("ramp")),
            ("maprange fit clamp brightcontrast", Called("remap")),
            ("inverse complement oneminus subtract", Called("invert")),
            (
                "constant rawconstant solid color colour rgb value uniform spectrum srgb",
                Write("the colour alone, without a texture: `reflectance: [0.8, 0.2, 0.2]`"),
            ),
            (
                "perlin fbm turbulence marble wrinkled windy clouds granite noisetexture noisetex",
                Called("noise"),
            ),
            ("polkadot", Called("dots")),
            ("bilerp", Called("corners")),
            ("directionmix", Called("facing")),
            (
                "wood voronoi worley brick bricks wave waves musgrave cells stripes grid leopard crackle gradient stucci magic volume",
                NotYet("patterns that are computed, but for `checker`, `noise`, `cubes` and `dots`"),
            ),
            ("ptex", NotYet("Ptex")),
            ("uv texcoord position normal", NotYet("textures that show coordinates")),
            ("udim", NotYet("pictures in several tiles")),
            ("type kind texture", TYPE),
        ],
    ),
    (
        "triplanar",
        &[
            ("uvmap texcoords uvmapping2d uvmapping texturecoordinates", Called("uv")),
            ("plane flat planarmapping", Called("planar")),
            ("cylinder cylindricalmapping tube", Called("cylindrical")),
            ("sphere latlong sphericalmapping equirectangular", Called("spherical")),
            ("box cubic cubemap", Called("cube")),
            ("boxprojection trimapping", Called("triplanar")),
            ("projection projector projective", Called("camera")),
            ("type kind", TYPE),
        ],
    ),
];
