//! The names of Mitsuba's plugins, so that what is misspelt is told from what straal lacks.

use super::tree::Class;

/// The plugins of a class: those of version 3, then those that only 0.5 and 0.6 have.
pub(super) fn of(class: Class) -> &'static [&'static str] {
    match class {
        Class::Shape => &[
            "sphere", "cylinder", "disk", "rectangle", "cube", "obj", "ply", "serialized", "shapegroup", "instance",
            "merge", "bsplinecurve", "linearcurve", "sdfgrid", "ellipsoids", "ellipsoidsmesh", "heightfield", "hair",
            "deformable",
        ],
        Class::Bsdf => &[
            "diffuse", "dielectric", "thindielectric", "roughdielectric", "conductor", "roughconductor", "plastic",
            "roughplastic", "pplastic", "principled", "principledthin", "twosided", "mask", "blendbsdf", "bumpmap",
            "normalmap", "null", "measured", "measured_polarized", "hair", "polarizer", "retarder", "circular",
            "roughdiffuse", "phong", "ward", "hk", "difftrans", "coating", "roughcoating", "mixturebsdf", "irawan",
        ],
        Class::Emitter => &[
            "area", "point", "spot", "directional", "constant", "envmap", "projector", "directionalarea", "sunsky",
            "sun", "sky", "timed_sunsky", "collimated",
        ],
        Class::Sensor => &[
            "perspective", "thinlens", "orthographic", "radiancemeter", "irradiancemeter", "distant", "batch",
            "spherical", "telecentric", "perspective_rdist", "fluencemeter",
        ],
        Class::Film => &["hdrfilm", "specfilm", "ldrfilm", "tiledhdrfilm", "mfilm"],
        Class::Sampler => &[
            "independent", "stratified", "multijitter", "orthogonal", "ldsampler", "halton", "hammersley", "sobol",
        ],
        Class::Filter => &["box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"],
        Class::Integrator => &[
            "path", "direct", "volpath", "volpathmis", "aov", "depth", "moment", "ptracer", "stokes", "prb",
            "prb_basic", "prbvolpath", "direct_projective", "prb_projective", "ao", "volpath_simple", "bdpt",
            "photonmapper", "ppm", "sppm", "pssmlt", "mlt", "erpt", "adaptive", "vpl", "irrcache", "multichannel",
            "field",
        ],
        Class::Texture => &[
            "bitmap", "checkerboard", "mesh_attribute", "volume", "uniform", "regular", "irregular", "srgb", "d65",
            "blackbody", "rawconstant", "scale", "gridtexture", "vertexcolors", "wireframe", "curvature",
        ],
        Class::Medium => &["homogeneous", "heterogeneous"],
        Class::Volume => &["constvolume", "gridvolume", "volcache", "hgridvolume"],
        Class::Phase => &["isotropic", "hg", "sggx", "blendphase", "rayleigh", "tabphase", "kkay", "microflake", "mixturephase"],
        Class::Subsurface => &["dipole", "singlescatter"],
        Class::Scene => &["scene"],
    }
}
