//! Cameras.

use straal_math::{DVec3, ops};

use crate::desc::check;
use crate::desc::keyframes::{CameraAt, Keyframes};
use crate::describe::describe;
use crate::limit::Limit;
use crate::span::Span;
use crate::value::Name;

describe! {
    /// Who looks.
    pub enum Camera each has observer: Observer {
        /// A pinhole or, with a `lens`, a thin lens: what is far is small.
        "perspective" => Perspective(Perspective),
        /// Parallel rays: size does not depend on distance.
        "orthographic" => Orthographic(Orthographic),
        /// A circular picture of up to all directions.
        "fisheye" => Fisheye(Fisheye),
        /// Through a lens of glass, surface by surface.
        "realistic" => Realistic(Realistic),
        /// All directions by longitude and latitude, as pictures of surroundings are kept.
        "panorama" => Panorama(Panorama),
        /// All directions on the six faces of a cube.
        "cube_map" => CubeMap(CubeMap),
    }
}

impl Camera {
    /// Why no picture of so many pixels can be made by it, if so; `film` is the size that the scene gives its picture.
    pub fn misfit(&self, film: [u32; 2], size: [u32; 2]) -> Option<String> {
        match self {
            Self::Perspective(c) => c.misfit(film, size),
            Self::CubeMap(c) => {
                let ([columns, rows], [w, h]) = (c.layout.faces(), size);
                (w < columns || h < rows).then(|| {
                    format!("a picture of {w} x {h} pixels has no room for {columns} x {rows} faces")
                })
            }
            _ => None,
        }
    }

    /// Whether each eye is seen through a filter of its own, in red, green and blue.
    pub fn is_anaglyph(&self) -> bool {
        let stereo = if let Self::Perspective(c) = self { c.stereo.as_ref() } else { None };
        stereo.is_some_and(|s| matches!(s.layout, StereoLayout::Anaglyph))
    }

    /// What it is to be focused on, if that is said by name.
    pub fn focus_on(&self) -> Option<&Name> {
        match self {
            Self::Perspective(Perspective { lens: Some(lens), .. }) => lens.focus_on.as_ref(),
            _ => None,
        }
    }
}

describe! {
    /// Where a camera stands and looks, and how it moves.
    pub struct Observer {
        /// Where the camera stands.
        eye: DVec3,
        /// The point in the middle of the picture.
        look_at: DVec3,
        /// The direction that is up in the picture, as far as the view allows.
        up: DVec3 = DVec3::Y,
        /// Turns the camera about its view, in degrees, clockwise for who stands behind it.
        roll: f64 = 0.0,
        /// Whether the picture is mirrored, left for right: what programs show whose axes are left-handed.
        mirror: bool = false,
        /// Where the camera is at time 1, if it moves, or a list of where it is at several times; at time 0 it is where the
        /// other keys say.
        moving_to: Option<Keyframes> = None,
        /// When the shutter opens and closes, between the times 0 and 1 of `moving_to`.
        shutter: [f64; 2] [Limit::UNIT] = [0.0, 1.0],
    }
}

/// What a program changes parts of: five units from the origin, which it looks at along -z. A file must say `eye` and
/// `look_at`.
impl Default for Observer {
    fn default() -> Self {
        Self {
            eye: DVec3::new(0.0, 0.0, 5.0),
            look_at: DVec3::ZERO,
            up: DVec3::Y,
            roll: 0.0,
            mirror: false,
            moving_to: None,
            shutter: [0.0, 1.0],
        }
    }
}

impl Observer {
    /// Distance from the eye to what is in the middle of the picture, at time 0.
    pub fn distance(&self) -> f64 {
        (self.look_at - self.eye).length()
    }

    /// Where it is at time 0 and then at each keyframe. What a keyframe leaves out stays as it was.
    pub fn keyframes(&self) -> Vec<CameraAt> {
        let Self { eye, look_at, up, roll, .. } = *self;
        let mut last = CameraAt { time: 0.0, eye, look_at, up, roll, span: Span::NONE };
        let mut keyframes = vec![last];
        let told = self.moving_to.iter().flat_map(|k| k.keyframes.iter().zip(k.times()));
        for (keyframe, time) in told {
            last = CameraAt {
                time,
                eye: keyframe.eye.unwrap_or(last.eye),
                look_at: keyframe.look_at.unwrap_or(last.look_at),
                up: keyframe.up.unwrap_or(last.up),
                roll: keyframe.roll.unwrap_or(last.roll),
                span: keyframe.span,
            };
            keyframes.push(last);
        }
        keyframes
    }
}

describe! {
    /// A pinhole camera, or with a `lens` one that is sharp at one distance only. Its angle is told by `fov`, by
    /// `focal_length` and `sensor`, or by `view_distance` and `pixel_size`; without any of them it is 40 degrees.
    pub struct Perspective [check::perspective] {
        /// Field of view in degrees, from edge to edge along `fov_axis`.
        fov: Option<f64> [Limit::between(0.0, 180.0)] = None,
        /// Which extent of the picture `fov` or `sensor` spans.
        fov_axis: FovAxis = FovAxis::X,
        /// Focal length in millimetres, in place of `fov`.
        focal_length: Option<f64> [Limit::POSITIVE] = None,
        /// Extent of the sensor along `fov_axis` in millimetres; 36 is the width of 35 mm film.
        sensor: f64 [Limit::POSITIVE] = FULL_FRAME,
        /// Distance of the view plane from the eye, in place of `fov` and together with `pixel_size`.
        view_distance: Option<f64> [Limit::POSITIVE] = None,
        /// Side of a pixel of the scene's `film` on the view plane, in the unit of `view_distance`.
        pixel_size: Option<f64> [Limit::POSITIVE] = None,
        /// How many times larger everything is than without it.
        zoom: f64 [Limit::POSITIVE] = 1.0,
        /// Moves the picture to the right and up on the view plane, in widths and heights of the picture.
        shift: [f64; 2] [Limit::within(-100.0, 100.0)] = [0.0, 0.0],
        /// A lens with a diameter; without it everything is sharp.
        lens: Option<Lens> = None,
        /// Two eyes in place of one.
        stereo: Option<Stereo> = None,
    }
    with observer: Observer
}

/// Width of 35 mm film in millimetres.
const FULL_FRAME: f64 = 36.0;

/// What lies on the view plane, beyond which single precision has no room for rays.
const PLANE: std::ops::Range<f64> = 1e-12..1e12;

impl Perspective {
    /// See [`Camera::misfit`].
    fn misfit(&self, film: [u32; 2], size: [u32; 2]) -> Option<String> {
        let layout = self.stereo.as_ref().map(|pair| &pair.layout);
        let [film, size] = [film, size].map(|whole| layout.map_or(whole, |layout| layout.of_one_eye(whole)));
        if size[0] == 0 {
            return Some("a picture one pixel wide has no room for two eyes".to_owned());
        }
        let [w, h] = size.map(f64::from);
        let tan = self.tan_x(film, size);
        let tans = [tan, tan * h / w];
        let aside = self.stereo.as_ref().map_or(0.0, |pair| {
            0.5 * pair.separation / pair.convergence.unwrap_or_else(|| self.observer.distance())
        });
        let reach = [0, 1].map(|i| 2.0 * tans[i] * self.shift[i].abs() + [aside, 0.0][i]);
        if !tans.iter().all(|tan| PLANE.contains(tan)) || !reach.iter().all(|v| *v < PLANE.end) {
            return Some(format!(
                "the camera's angle is beyond the range of numbers: its half has a tangent of {tan:e}"
            ));
        }
        let radius = self.lens.as_ref().map_or(0.0, |lens| self.lens_radius(lens, film, size));
        (!(radius as f32).is_finite()).then(|| "the camera's lens is too wide for numbers".to_owned())
    }

    /// Tangent of half the angle across the picture's width. `film` is the size that the scene gives its picture, in whose
    /// pixels the view plane is measured, `size` that of the picture to make.
    pub fn tan_x(&self, film: [u32; 2], size: [u32; 2]) -> f64 {
        let [width, height] = size.map(f64::from);
        let tan = match (self.focal_length, self.view_distance, self.pixel_size) {
            (_, Some(distance), Some(pixel)) => {
                return 0.5 * f64::from(film[0]) * pixel / (distance * self.zoom);
            }
            (Some(focal_length), ..) => 0.5 * self.sensor / focal_length,
            _ => {
                let (sin, cos) = ops::sin_cos_degrees(0.5 * self.fov.unwrap_or(40.0));
                sin / cos
            }
        };
        tan * width / self.fov_axis.extent([width, height]) / self.zoom
    }

    /// The lens's radius in the scene's units (metres) for a picture of that size: half of focal length over f-number,
    /// where that is how it is told.
    pub fn lens_radius(&self, lens: &Lens, film: [u32; 2], size: [u32; 2]) -> f64 {
        let Some(f_number) = lens.f_number else { return lens.radius.unwrap_or(0.0) };
        let focal_length = self.focal_length.unwrap_or_else(|| {
            let [width, height] = size.map(f64::from);
            let along = self.fov_axis.extent([width, height]) / width;
            0.5 * self.sensor / (self.tan_x(film, size) * along)
        });
        0.5e-3 * focal_length / f_number
    }
}

describe! {
    /// A thin lens in front of the film. `radius` or `f_number` says how wide it is open.
    pub struct Lens [check::lens] {
        /// Radius of the opening, in the unit of the scene.
        radius: Option<f64> [Limit::POSITIVE] = None,
        /// Focal length over diameter, the photographer's measure, with the scene in metres; the focal length is that of
        /// `focal_length`, or the one that gives the camera's angle with its `sensor`.
        f_number: Option<f64> [Limit::POSITIVE] = None,
        /// Distance along the view to the plane that is sharp; that of `look_at` when nothing else is said.
        focus_distance: Option<f64> [Limit::POSITIVE] = None,
        /// Name of what is to be sharp, in place of `focus_distance`: a node's `name`, or an object of which there is an
        /// instance in the world. Its middle is looked for, the nearest if it is there several times.
        focus_on: Option<Name> = None,
        /// How light is spread over the opening.
        profile: LensProfile = LensProfile::Uniform,
        /// Number of blades of the iris, which make the opening a polygon; round without it.
        blades: Option<u32> [Limit::within(3.0, 64.0)] = None,
        /// Turns the iris, in degrees, counter-clockwise as seen from behind.
        rotation: f64 = 0.0,
    }
}

describe! {
    /// How light is spread over the opening of a lens.
    pub enum LensProfile {
        /// Evenly: what is out of focus has an edge.
        "uniform" => Uniform,
        /// Less and less towards the rim: what is out of focus is soft.
        "gaussian" => Gaussian(GaussianProfile),
    }
}

describe! {
    /// A bell over the opening of a lens, cut off at its rim.
    pub struct GaussianProfile {
        /// Standard deviation, in radii of the lens.
        sigma: f64 [Limit { min: 0.0, max: 16.0, open: true }] = 0.5,
    }
}

describe! {
    /// A pair of eyes beside one another, with parallel views.
    pub struct Stereo {
        /// Distance between the eyes, in the unit of the scene.
        separation: f64 [Limit::POSITIVE] = 0.065,
        /// Distance of what both eyes see at the same place of the picture: it appears at the depth of the screen. That of
        /// `look_at` when it is not said.
        convergence: Option<f64> [Limit::POSITIVE] = None,
        /// How the two pictures become one.
        layout: StereoLayout = StereoLayout::Parallel,
    }
}

describe! {
    /// How the pictures of two eyes become one.
    pub enum StereoLayout {
        /// The left eye's in the left half, the right eye's in the right half.
        "parallel" => Parallel,
        /// The right eye's in the left half, the left eye's in the right half: for looking with crossed eyes.
        "crossed" => Crossed,
        /// Red from the left eye, green and blue from the right, for red and cyan glasses.
        "anaglyph" => Anaglyph,
        /// The left eye's only.
        "left" => Left,
        /// The right eye's only.
        "right" => Right,
    }
}

describe! {
    /// A camera with parallel rays.
    pub struct Orthographic [check::orthographic] {
        /// Full width of the picture in world units; the height follows from the film's size.
        width: f64 [Limit::POSITIVE] = 2.0,
    }
    with observer: Observer
}

describe! {
    /// A camera whose picture is a circle, around which it is black.
    pub struct Fisheye [check::fisheye] {
        /// Angle across the circle in degrees; 360 sees everything.
        fov: f64 [Limit::within(0.001, 360.0)] = 180.0,
        /// Which extent of the picture the circle spans.
        fov_axis: FovAxis = FovAxis::Smaller,
        /// How the distance from the middle follows from the angle to the view.
        projection: FisheyeProjection = FisheyeProjection::Equidistant,
    }
    with observer: Observer
}

describe! {
    /// How in a fisheye's picture the distance r from the middle follows from the angle a to the view.
    pub enum FisheyeProjection {
        /// r as a: equal angles are equally long.
        "equidistant" => Equidistant,
        /// r as sin(a/2): equal solid angles have equal areas.
        "equisolid" => Equisolid,
        /// r as sin(a): what is seen of a hemisphere from far away; up to 180 degrees.
        "orthographic" => Orthographic,
        /// r as tan(a/2): small circles stay circles; below 360 degrees.
        "stereographic" => Stereographic,
    }
}

describe! {
    /// A camera whose rays are followed through a lens of glass: what it distorts, blurs and darkens is what such a lens does.
    pub struct Realistic [check::realistic] {
        /// The lens, surface by surface from the front, each as four numbers: its radius of curvature (above 0 where it bulges forwards, 0 for the stop), the way to the
        /// next surface (that from the last to the film follows from `focus_distance`), the index of refraction behind it, and its diameter; lengths in millimetres.
        elements: Vec<[f64; 4]>,
        /// Diameter of the stop in millimetres, if it isn't wide open.
        aperture: Option<f64> [Limit::POSITIVE] = None,
        /// The film's diagonal in millimetres.
        film_diagonal: f64 [Limit::POSITIVE] = 35.0,
        /// Distance from the film to what is sharp, in metres.
        focus_distance: f64 [Limit::POSITIVE] = 10.0,
        /// What a pixel's number is.
        exposure: LensExposure = LensExposure::Even,
    }
    with observer: Observer
}

describe! {
    /// What the number of a pixel behind a lens of glass is.
    pub enum LensExposure {
        /// The radiance that arrives in the middle of the picture; less towards its edges, as the lens has it.
        "even" => Even,
        /// The light that falls on the film there: radiance times the solid angle of the lens' opening, as seen from there.
        "film" => Film,
    }
}

impl Realistic {
    /// The last surface's distance from the film in millimetres by which things at `focus_distance` are sharp, by Gaussian optics; `None` where there is none.
    pub fn back_focus(&self) -> Option<f64> {
        let far = 1e3 * self.focus_distance;
        let inside: f64 = self.elements.iter().rev().skip(1).map(|e| e[1]).sum();
        let mut back = 0.0;
        // The lens is next to nothing as against the distance, by which this comes to rest at once.
        for _ in 0..64 {
            back = self.image_of(far - inside - back)?;
        }
        let is_sound = back > 0.0 && inside + back < far && back < 1e5;
        is_sound.then_some(back)
    }

    /// How far behind the last surface a point on the axis is sharp that is so far in front of the first.
    fn image_of(&self, far: f64) -> Option<f64> {
        // A ray that leaves the point: height and slope times index.
        let (mut y, mut slope, mut before) = (1.0, 1.0 / far, 1.0);
        let last = self.elements.len().checked_sub(1)?;
        for (i, [radius, thickness, index, _]) in self.elements.iter().enumerate() {
            if *radius != 0.0 {
                let behind = if *index > 0.0 { *index } else { 1.0 };
                slope -= (behind - before) / radius * y;
                before = behind;
            }
            if i < last {
                y += slope / before * thickness;
            }
        }
        let back = -y * before / slope;
        back.is_finite().then_some(back)
    }
}

describe! {
    /// A camera that sees all around: from left to right by longitude, from top to bottom by latitude.
    pub struct Panorama [check::panorama] {
        /// Longitudes of the left and the right edge in degrees; `look_at` is at 0, to the right of it is above 0.
        longitude: [f64; 2] [Limit::within(-360.0, 360.0)] = [-180.0, 180.0],
        /// Latitudes of the lower and the upper end in degrees; `look_at` is at 0, straight up at 90.
        latitude: [f64; 2] [Limit::within(-90.0, 90.0)] = [-90.0, 90.0],
        /// Where in the picture the ends of `latitude` are.
        rows: PanoramaRows = PanoramaRows::Even,
    }
    with observer: Observer
}

describe! {
    /// Where in a panorama the ends of its latitudes are.
    pub enum PanoramaRows {
        /// At the upper and lower edge: each row sees its part.
        "even" => Even,
        /// In the middle of the first and the last row, as `environment` reads pictures.
        "centered" => Centered,
    }
}

describe! {
    /// A camera that sees all around, on the six faces of a cube, each as large as the picture has room for.
    pub struct CubeMap [check::cube_map] {
        /// Where in the picture the faces are.
        layout: CubeLayout = CubeLayout::Cross,
    }
    with observer: Observer
}

describe! {
    /// Where in the picture the faces of a cube are.
    pub enum CubeLayout {
        /// Unfolded, 4 by 3: left, front, right, back in the middle row, up and down above and below the front.
        "cross" => Cross,
        /// One row of 6: right, left, up, down, back, front, which are +x, -x, +y, -y, +z, -z of a camera that looks along -z.
        "row" => Row,
    }
}

describe! {
    /// Which extent of the picture an angle spans.
    pub enum FovAxis {
        /// The width.
        "x" => X,
        /// The height.
        "y" => Y,
        /// The smaller of width and height.
        "smaller" => Smaller,
        /// The larger of width and height.
        "larger" => Larger,
        /// From corner to corner.
        "diagonal" => Diagonal,
    }
}

impl FovAxis {
    /// That extent of a picture of some width and height.
    pub fn extent(&self, [width, height]: [f64; 2]) -> f64 {
        match self {
            Self::X => width,
            Self::Y => height,
            Self::Smaller => {
                if width < height {
                    width
                } else {
                    height
                }
            }
            Self::Larger => {
                if width > height {
                    width
                } else {
                    height
                }
            }
            Self::Diagonal => (width * width + height * height).sqrt(),
        }
    }
}

impl StereoLayout {
    /// Size of the picture of each eye in one of `size`; what is left over beside two halves stays black.
    pub const fn of_one_eye(&self, size: [u32; 2]) -> [u32; 2] {
        match self {
            Self::Parallel | Self::Crossed => [size[0] / 2, size[1]],
            // One eye by itself has the whole picture, as each has in an anaglyph.
            Self::Anaglyph | Self::Left | Self::Right => size,
        }
    }
}

impl CubeLayout {
    /// Faces across and down.
    pub const fn faces(&self) -> [u32; 2] {
        match self {
            Self::Cross => [4, 3],
            Self::Row => [6, 1],
        }
    }
}
