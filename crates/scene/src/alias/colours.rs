//! Words for colours and spectra.

use super::Here::{Called, Write};
use super::Table;
use super::answers::{CHECKER, TEXTURES};

/// What words are in mappings of these marks.
pub(super) const KEYS: &[Table] = &[
    (
        "xyz",
        &[
            ("value color colour rgbvalue srgb", Called("rgb")),
            ("hex html css", Write("'#rrggbb' in quotes, without a mapping")),
            ("hsv hsl hue", Write("'#rrggbb' in quotes, or `lch: [50, 60, 30]`")),
            ("colorspace", Called("space")),
            ("texture image file map filename bitmap noise", TEXTURES),
            ("checker checkerboard", CHECKER),
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
];
