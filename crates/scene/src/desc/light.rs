//! Lights that are not surfaces; a surface glows by its `emission`.

use straal_math::{DVec3, ops};

use crate::desc::check;
use crate::desc::lamp::Lamp;
use crate::desc::sky::Sky;
use crate::desc::spectrum::Spectrum;
use crate::desc::texture::TextureOf;
use crate::desc::transform::Transform;
use crate::describe::describe;
use crate::limit::Limit;
use crate::value::{Asset, Name};
use crate::{Image, Photometry};

describe! {
    /// A light that is not a surface.
    pub enum Light each has lamp: Lamp {
        /// Shines from a point, evenly in all directions.
        "point" => Point(PointLight),
        /// Parallel light from infinitely far away.
        "directional" => Directional(DirectionalLight),
        /// Shines from a point in a cone.
        "spot" => Spot(SpotLight),
        /// Throws a picture, as with a slide.
        "projector" => Projector(Projector),
        /// Shines as a file says that a lamp was measured.
        "goniometric" => Goniometric(Goniometric),
        /// Light from all around, infinitely far away.
        "environment" => Environment(Environment),
        /// Sun and sky of a clear day.
        "sky" => Sky(Sky),
        /// The textbook's ambient light: the same for every surface, from nowhere and in no one's shadow.
        "ambient" => Ambient(AmbientLight),
    }
}

describe! {
    /// Light that every surface sends back its share of (`ambient` of a `phong`, the `reflectance` of a `diffuse` material),
    /// whatever is around it: a stand-in for the light that walls send to one another, for pictures without it.
    pub struct AmbientLight {
        /// Radiance of a surface that sends back all of it, in W/(m^2 sr).
        radiance: Spectrum [Limit::NON_NEGATIVE] = Spectrum::grey(1.0),
        /// What `zones`, and groups of lamps by their names, call it.
        name: Option<Name> = None,
    } with lamp: Lamp
}

describe! {
    /// A point that shines evenly in all directions.
    pub struct PointLight {
        /// Where it is.
        position: DVec3,
        /// Radiant intensity in W/sr.
        intensity: Spectrum [Limit::NON_NEGATIVE] = Spectrum::grey(1.0),
        /// How its light falls with distance.
        decay: Decay = Decay::InverseSquare,
        /// What `zones`, and groups of lamps by their names, call it.
        name: Option<Name> = None,
    } with lamp: Lamp
}

describe! {
    /// How a light falls with distance.
    pub enum Decay {
        /// With its square, as light does.
        "inverse_square" => InverseSquare,
        /// Not at all: as bright everywhere as at a distance of 1, as in many textbooks. Rays from the lamp, of the integrator `light`, spread all the same.
        "none" => None,
    }
}

describe! {
    /// Parallel light, like the sun's, along `direction` or as from `from` to `look_at`.
    pub struct DirectionalLight [check::directional] {
        /// The direction in which the light travels; give this or `from`.
        direction: Option<DVec3> = None,
        /// A point that the light comes from the direction of, as if it stood infinitely far behind; give this or `direction`.
        from: Option<DVec3> = None,
        /// The point that it shines on; the origin when only `from` is given.
        look_at: Option<DVec3> = None,
        /// Irradiance on a surface that faces the light, in W/m^2.
        irradiance: Spectrum [Limit::NON_NEGATIVE] = Spectrum::grey(1.0),
        /// What it takes of the sky from rim to rim, in degrees: 0.53 for the sun. Above 0 it is seen as a disc, and its shadows have soft edges.
        angle: f64 [Limit::within(0.0, 179.0)] = 0.0,
        /// What `zones`, and groups of lamps by their names, call it.
        name: Option<Name> = None,
    } with lamp: Lamp
}

describe! {
    /// A point that shines in a cone, along `direction` or towards `look_at`.
    pub struct SpotLight [check::spot] {
        /// Where it is.
        position: DVec3,
        /// The axis of the cone; give this or `look_at`.
        direction: Option<DVec3> = None,
        /// A point on the axis; give this or `direction`.
        look_at: Option<DVec3> = None,
        /// Radiant intensity on the axis in W/sr.
        intensity: Spectrum [Limit::NON_NEGATIVE] = Spectrum::grey(1.0),
        /// Angle from the axis, in degrees, beyond which there is no light.
        cutoff: f64 [Limit::within(0.001, 180.0)] = 20.0,
        /// Angle from the axis, in degrees, up to which intensity is full; three quarters of `cutoff` when absent.
        beam: Option<f64> [Limit::within(0.0, 180.0)] = None,
        /// How intensity falls from `beam` to `cutoff`.
        falloff: Falloff = Falloff::Linear,
        /// What its light passes through, as a mask in front of a stage lamp: a texture over the square around the cone, upright as seen from the lamp.
        texture: Option<TextureOf> [Limit::UNIT] = None,
        /// What is up for the texture.
        up: DVec3 = DVec3::Y,
        /// What `zones`, and groups of lamps by their names, call it.
        name: Option<Name> = None,
    } with lamp: Lamp
}

describe! {
    /// A point that throws a picture along `direction` or towards `look_at`: on a screen across its axis the picture is as even as it is by itself.
    pub struct Projector [check::projector] {
        /// Where it is.
        position: DVec3,
        /// The axis; give this or `look_at`.
        direction: Option<DVec3> = None,
        /// A point on the axis; give this or `direction`.
        look_at: Option<DVec3> = None,
        /// What is up for the picture.
        up: DVec3 = DVec3::Y,
        /// The picture: a texture, upright as seen from the projector. Nothing is thrown beyond it.
        picture: TextureOf [Limit::NON_NEGATIVE],
        /// Radiant intensity on the axis in W/sr where the picture is 1: a screen at a distance of d receives that by d^2, in W/m^2.
        intensity: f64 [Limit::NON_NEGATIVE] = 1.0,
        /// The angle of the picture from left to right, in degrees.
        fov: f64 [Limit::within(0.1, 179.0)] = 40.0,
        /// Width of the picture over its height; its own, if it is a picture file, when absent.
        aspect: Option<f64> [Limit::within(0.01, 100.0)] = None,
        /// What `zones`, and groups of lamps by their names, call it.
        name: Option<Name> = None,
    } with lamp: Lamp
}

impl Projector {
    /// The axis, not of unit length.
    pub fn axis(&self) -> DVec3 {
        axis(self.position, self.direction, self.look_at)
    }
}

describe! {
    /// A point that shines in each direction as was measured of a lamp, in candela: those over `efficacy` are its W/sr. Its axis is that of the file, which of a lamp
    /// that hangs leads down and of a floodlight forward.
    pub struct Goniometric [check::goniometric] {
        /// Where it is.
        position: DVec3,
        /// An IES (LM-63) or EULUMDAT file.
        file: Asset<Photometry>,
        /// The axis; straight down where neither this nor `look_at` is given.
        direction: Option<DVec3> = None,
        /// A point on the axis, in place of `direction`.
        look_at: Option<DVec3> = None,
        /// About the axis, where the file's plane of 0 degrees lies; of a floodlight its right.
        zero: DVec3 = DVec3::X,
        /// The colour of its light; how bright it is the file says.
        color: Spectrum [Limit::NON_NEGATIVE] = Spectrum::grey(1.0),
        /// Lumens that count as one watt. With 683, those of green light, W/sr are as much of what the eye sees; with that of the lamp's own spectrum they are its radiant intensity.
        efficacy: f64 [Limit::within(1.0, 683.0)] = 683.0,
        /// What its light is multiplied by.
        scale: f64 [Limit::NON_NEGATIVE] = 1.0,
        /// What `zones`, and groups of lamps by their names, call it.
        name: Option<Name> = None,
    } with lamp: Lamp
}

impl Goniometric {
    /// The axis, not of unit length.
    pub fn axis(&self) -> DVec3 {
        if self.direction.is_none() && self.look_at.is_none() {
            return -DVec3::Y;
        }
        axis(self.position, self.direction, self.look_at)
    }
}

/// The axis of a lamp that has one, not of unit length.
fn axis(position: DVec3, direction: Option<DVec3>, look_at: Option<DVec3>) -> DVec3 {
    match (direction, look_at) {
        (Some(d), _) => d,
        (None, Some(p)) => p - position,
        (None, None) => -DVec3::Z,
    }
}

impl DirectionalLight {
    /// The direction in which the light travels, not of unit length.
    pub fn axis(&self) -> DVec3 {
        match (self.direction, self.from) {
            (Some(d), _) => d,
            (None, Some(from)) => self.look_at.unwrap_or(DVec3::ZERO) - from,
            (None, None) => -DVec3::Y,
        }
    }
}

impl SpotLight {
    /// The axis of the cone, not of unit length.
    pub fn axis(&self) -> DVec3 {
        axis(self.position, self.direction, self.look_at)
    }

    /// Angle from the axis, in degrees, up to which intensity is full.
    pub fn full_beam(&self) -> f64 {
        self.beam.unwrap_or(0.75 * self.cutoff)
    }
}

describe! {
    /// How a spot's intensity falls towards the rim of its cone.
    pub enum Falloff {
        /// Linear in the angle.
        "linear" => Linear,
        /// A smooth step (3x^2 - 2x^3) in the cosine of the angle.
        "smooth" => Smooth,
    }
}

describe! {
    /// Light from all around: the same from everywhere, a gradient from above to below, or a picture in latitude and longitude or on the faces of a cube.
    ///
    /// In latitude and longitude the top row of the picture is seen along local +y and its middle column along local -z; what is
    /// right of the middle is seen towards +x. The front of a cube is seen along local -z, and its right towards +x.
    pub struct Environment [check::environment] {
        /// Radiance from everywhere, in W/(m^2 sr); give this, `gradient` or `file`.
        radiance: Option<Spectrum> [Limit::NON_NEGATIVE] = None,
        /// Radiance from straight above, and from there down to straight below in equal steps of angle; between two it is mixed. Give this, `radiance` or `file`.
        gradient: Vec<Spectrum> [Limit::NON_NEGATIVE] = Vec::new(),
        /// A picture whose pixels are radiance; give this, `radiance` or `gradient`.
        file: Option<Asset<Image>> = None,
        /// How the picture is laid out.
        layout: EnvironmentLayout = EnvironmentLayout::LatitudeLongitude,
        /// What the picture or radiance is multiplied by.
        scale: f64 [Limit::NON_NEGATIVE] = 1.0,
        /// By how many stops it is brighter: 1 is twice as bright, -1 half.
        exposure: f64 [Limit::within(-100.0, 100.0)] = 0.0,
        /// A colour that it is multiplied by.
        tint: Spectrum [Limit::NON_NEGATIVE] = Spectrum::grey(1.0),
        /// Whether light sampling nearly leaves what is no brighter than the mean to the rays that surfaces scatter, which find it by themselves: for pictures with small bright lamps.
        compensate: bool = false,
        /// Openings through which its light comes into a room: windows, whose light is found with less noise. Light that comes in elsewhere is then found by BSDF sampling alone.
        portals: Vec<Portal> = Vec::new(),
        /// Turn about the local y axis in degrees, counter-clockwise seen from above, before `transform`.
        rotate: f64 = 0.0,
        /// Where the surroundings' axes lie; only its rotation counts.
        transform: Transform = Transform::default(),
        /// What `zones`, and groups of lamps by their names, call it.
        name: Option<Name> = None,
    } with lamp: Lamp
}

describe! {
    /// How a picture shows all directions.
    pub enum EnvironmentLayout {
        /// By angles: once around from left to right, from straight up to straight down.
        "latitude_longitude" => LatitudeLongitude,
        /// On an unfolded cube, 4 by 3, as the camera `cube_map` lays it out: left, front, right, back in the middle row, up and
        /// down above and below the front.
        "cross" => Cross,
        /// On the faces of a cube in a row: right, left, up, down, back, front.
        "row" => Row,
        /// A square of which equal areas show equal solid angles (Clarberg 2008), as pbrt-v4 has it: local +z in its middle, -z in its corners,
        /// +x in the middle of its right edge, +y in that of its lower one.
        "equal_area" => EqualArea,
    }
}

describe! {
    /// A rectangle through which light comes into a room.
    pub struct Portal [check::portal] {
        /// One corner.
        corner: DVec3,
        /// The two edges from that corner, at right angles; their cross product, first x second, leads into the room.
        edges: [DVec3; 2],
    }
}

impl Light {
    /// What it has in common with all that shines, to be changed.
    pub const fn lamp_mut(&mut self) -> &mut Lamp {
        match self {
            Self::Point(l) => &mut l.lamp,
            Self::Directional(l) => &mut l.lamp,
            Self::Spot(l) => &mut l.lamp,
            Self::Projector(l) => &mut l.lamp,
            Self::Goniometric(l) => &mut l.lamp,
            Self::Environment(l) => &mut l.lamp,
            Self::Sky(l) => &mut l.lamp,
            Self::Ambient(l) => &mut l.lamp,
        }
    }

    /// Its name, if it has one.
    pub const fn name(&self) -> Option<&Name> {
        match self {
            Self::Point(l) => l.name.as_ref(),
            Self::Directional(l) => l.name.as_ref(),
            Self::Spot(l) => l.name.as_ref(),
            Self::Projector(l) => l.name.as_ref(),
            Self::Goniometric(l) => l.name.as_ref(),
            Self::Environment(l) => l.name.as_ref(),
            Self::Sky(l) => l.name.as_ref(),
            Self::Ambient(l) => l.name.as_ref(),
        }
    }

    /// The openings through which its light comes in, where it says any.
    pub fn portals(&self) -> &[Portal] {
        match self {
            Self::Environment(l) => &l.portals,
            Self::Sky(l) => &l.portals,
            _ => &[],
        }
    }
}

impl Environment {
    /// What all of it is multiplied by, but for the tint.
    pub fn factor(&self) -> f64 {
        self.scale * ops::pow_d(2.0, self.exposure)
    }
}

impl EnvironmentLayout {
    /// How many faces of a cube a picture of this layout has across and down, if it has any; a square is one.
    pub const fn faces(&self) -> Option<[usize; 2]> {
        match self {
            Self::LatitudeLongitude => None,
            Self::Cross => Some([4, 3]),
            Self::Row => Some([6, 1]),
            Self::EqualArea => Some([1, 1]),
        }
    }

    /// The side of a face in pixels in a picture of these, if it is made of faces.
    pub fn side(&self, image: &Image) -> Option<usize> {
        let [across, down] = self.faces()?;
        let side = (image.width / across).min(image.height / down);
        // Where there is room for another face, the picture is of another layout.
        let fits = image.is_whole() && side > 0;
        let is_square = *self != Self::EqualArea || image.width == image.height;
        (fits && is_square && image.width / side == across && image.height / side == down).then_some(side)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_fill_their_picture() {
        let side = |layout: EnvironmentLayout, width: usize, height: usize| {
            layout.side(&Image { width, height, pixels: vec![[1.0; 3]; width * height] })
        };
        for (width, height) in [(1024, 512), (3, 3), (0, 0), (64, 300)] {
            assert_eq!(side(EnvironmentLayout::Cross, width, height), None, "{width} x {height}");
        }
        // The camera leaves what is over; a face of one pixel is one.
        assert_eq!(side(EnvironmentLayout::Cross, 43, 31), Some(10));
        assert_eq!(side(EnvironmentLayout::Cross, 4, 3), Some(1));
        assert_eq!(side(EnvironmentLayout::Row, 60, 10), Some(10));
        assert_eq!(side(EnvironmentLayout::LatitudeLongitude, 4, 3), None);
        assert_eq!(side(EnvironmentLayout::EqualArea, 8, 8), Some(8));
        assert_eq!(side(EnvironmentLayout::EqualArea, 9, 8), None);
    }
}
