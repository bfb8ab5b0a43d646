//! Words for shapes, for what all surfaces share, and for where things stand.

use super::Here::{Called, NotYet, Write};
use super::Table;
use super::answers::{AREA, CAMERA, CSG, PLACE, TEXTURES, TURN, TYPE};

/// What words are in mappings of these marks.
pub(super) const KEYS: &[Table] = &[
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
        "cone: paraboloid: capsule:",
        &[
            ("p0 point1 start base basepoint bottom apex", Called("from")),
            ("p1 point2 end cap cappoint top tip", Called("to")),
            ("r baseradius radius0", Called("radius")),
            (
                "capradius radius1 r1 radiustop",
                Write("`top_radius` of a `cone`, `end_radius` of a `capsule`"),
            ),
            ("height length zmin zmax h", Write("`from` and `to`, the middles of its ends")),
            ("phimax thetamax sweep", Write("`phi: [0, 180]`, in degrees")),
            ("open closed capped", Called("caps")),
        ],
    ),
    (
        "torus:",
        &[
            ("position origin location pos middle", Called("center")),
            ("majorradius major r ringradius outerradius", Called("radius")),
            ("minorradius minor tube thickness innerradius crosssection", Called("tube_radius")),
            ("normal direction", Called("axis")),
            ("phimax", Write("`phi: [0, 180]`, in degrees")),
        ],
    ),
    (
        "annulus:",
        &[
            ("position origin location pos middle", Called("center")),
            ("outerradius r", Called("radius")),
            ("innerradius hole holeradius", Called("inner_radius")),
            ("direction axis", Called("normal")),
            ("phimax", Write("`phi: [0, 180]`, in degrees")),
        ],
    ),
    (
        "curves:",
        &[
            ("controlpoints p vertices positions cv", Called("points")),
            ("radius width widths width0 width1 thickness", Write("`radii`: half of how wide they are")),
            ("type curvetype", Called("form")),
            ("n", Called("normals")),
            ("degree", Write("`basis: bezier`, `b_spline` or `linear`")),
        ],
    ),
    ("union: intersection: difference:", &[("children objects shapes solids members a b", Called("of"))]),
    (
        "height_field:",
        &[
            ("filename path src image map texture", Called("file")),
            ("data values pz", Called("heights")),
            ("scale height amplitude", Write("`between: [0, 0.5]`, the y of height 0 and of height 1")),
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
                Write("`shading: smooth`, `flat` or `gouraud`"),
            ),
            (
                "subdivision subdivisionlevels levels subdiv subdivisionsurface",
                Write("`subdivide: { scheme: catmull_clark, levels: 3 }`"),
            ),
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
        "degrees",
        &[
            ("angle angledegrees value deg theta", Called("degrees")),
            ("v vector direction around about", Called("axis")),
            ("radians rad", Write("`degrees`")),
        ],
    ),
];

/// What other kinds are where one of these may stand.
pub(super) const KINDS: &[Table] = &[
    (
        "sphere",
        &[
            ("ball sphereshape uvsphere icosphere ellipsoid", Called("sphere")),
            ("ring washer diskwithhole", Called("annulus")),
            ("donut doughnut", Called("torus")),
            ("spherocylinder pill sphylinder roundcone spheresweep", Called("capsule")),
            ("truncatedcone frustum", Called("cone")),
            ("hyperbola onesheethyperboloid", Called("hyperboloid")),
            ("parabola bowl", Called("paraboloid")),
            ("bilinearpatch", Called("bilinear")),
            ("heightfield terrain heightmap displacementgrid", Called("height_field")),
            ("curve hair bsplinecurve linearcurve fur strands spline", Called("curves")),
            ("merge add unionall", Called("union")),
            ("intersect and", Called("intersection")),
            ("subtract minus differenceof", Called("difference")),
            ("sdf sdfgrid signeddistance isosurface metaball blob", Called("distance_field")),
            (
                "loopsubdiv catmullclark subdivision",
                Write("`mesh` with `subdivide: { scheme: loop, levels: 3 }`"),
            ),
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
            ("csg boolean", CSG),
            (
                "volume nurbs julia juliafractal text prism lathe superellipsoid sor",
                Write("not supported yet; as a mesh it can be read: `mesh: { file: lathe.ply }`"),
            ),
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
