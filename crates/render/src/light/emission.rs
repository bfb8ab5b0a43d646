//! Rays that leave emitters.

use super::{LightSample, Receiver};
use crate::shape::SurfacePoint;
use crate::shape::offset::End;
use straal_color::Light;
use straal_math::{Frame, Vec3, warp};

/// What holds all of a scene that light from afar may fall on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its middle.
    pub center: Vec3,
    /// In m, above 0.
    pub radius: f32,
}

/// A ray that leaves an emitter, and how likely it was.
#[derive(Clone, Copy, Debug)]
pub struct Emitted {
    /// Where it starts.
    pub from: End,
    /// The way the light goes: a unit vector.
    pub d: Vec3,
    /// What goes that way: radiance in W/(m² sr); intensity in W/sr of a light from one point; irradiance across the way in W/m² of light from
    /// one direction.
    pub light: Light,
    /// Cosine of the direction to a surface that shines; 1 where there is none.
    pub cos: f32,
    /// Density of the place in 1/m², across the way where there is no surface; 1 of a single one.
    pub pdf_place: f32,
    /// Density of the direction in 1/sr; 1 of a single one.
    pub pdf_direction: f32,
    /// What a camera may see of the very lamp.
    pub shows: Shows,
}

/// What of an emitter a camera may see.
#[derive(Clone, Copy, Debug)]
pub enum Shows {
    /// Nothing: it has no extent.
    Nothing,
    /// The point where the ray starts.
    Surface {
        /// That point.
        point: SurfacePoint,
        /// The share of it that a mask leaves.
        opacity: f32,
    },
    /// The direction that the ray comes from.
    Around,
}

impl Emitted {
    /// What the ray carries: a sample of the light's power, in W.
    pub fn power(&self) -> Light {
        self.light * (self.cos / (self.pdf_place * self.pdf_direction))
    }
}

/// From a point, in a direction with its density: as much as arrives at distance 1.
pub(super) fn from_point(
    place: Vec3,
    (d, pdf_direction): (Vec3, f32),
    sample: impl FnOnce(&Receiver) -> Option<LightSample>,
) -> Option<Emitted> {
    let at = place + d;
    let light = sample(&Receiver::anywhere(at))?.radiance * (at - place).length_squared();
    let from = End::in_space(place);
    (pdf_direction > 0.0).then_some(Emitted {
        from,
        d,
        light,
        cos: 1.0,
        pdf_place: 1.0,
        pdf_direction,
        shows: Shows::Nothing,
    })
}

/// From beyond the scene: by a direction that was drawn for any point of it, through a disc across that is as wide as the ball.
pub(super) fn from_afar(sample: &LightSample, ball: &Ball, u: [f32; 2]) -> Option<Emitted> {
    if !sample.far {
        return None;
    }
    let [x, y] = warp::concentric_disc(u);
    let frame = Frame::from_normal(sample.wi);
    let p = ball.center + (frame.s * x + frame.t * y + sample.wi) * ball.radius;
    Some(Emitted {
        from: End::in_space(p),
        d: -sample.wi,
        light: sample.radiance,
        cos: 1.0,
        pdf_place: std::f32::consts::FRAC_1_PI / (ball.radius * ball.radius),
        pdf_direction: sample.pdf,
        shows: if sample.delta { Shows::Nothing } else { Shows::Around },
    })
}
