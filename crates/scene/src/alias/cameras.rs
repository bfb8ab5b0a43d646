//! Words for cameras and their lenses.

use super::Here::{Called, Write};
use super::Table;
use super::answers::{CAMERA, LENS, MEDIA, SIZE, SPP, TYPE, VERTICAL, VIEW};

/// What words are in mappings of these marks.
pub(super) const KEYS: &[Table] = &[
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
];

/// What other kinds are where one of these may stand.
pub(super) const KINDS: &[Table] = &[(
    "perspective",
    &[
        (
            "pinhole thinlens perspectivecamera projective persp persppinhole camera thinlenscamera perspectivepinhole",
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
)];
