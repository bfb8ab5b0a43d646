//! What closed surfaces of clear materials are filled with, and which of them a path is inside of.
//!
//! - **Absorption** by Beer's law: on a way of length d the share exp(-sigma d) of the light is left. sigma is told as such (`sigma_a`), or as
//!   the colour that is left after a distance: sigma = -ln(colour) / distance.
//! - **Nesting.** Each path keeps a short list of the closed surfaces that it has gone into and not come out of; it is in the medium of the last. A
//!   bubble in glass, a ball in water need nothing else.
//! - **Priorities** (Schmidt and Budge 2002, "Simple Nested Dielectrics in Ray Traced Images"). Glass that holds water can't be drawn as
//!   two surfaces in the very same place: let the water reach into the glass, and give the glass the higher priority. Where both are, only
//!   the glass is. The water's boundary inside of the glass isn't there; and the index of refraction on the other side of a boundary is
//!   that of what really is there, whatever its `eta_outside` says.
//!
//! A path that starts inside of something isn't known to, until it comes out of it.

use straal_color::Light;
use straal_math::ops;
use straal_scene::desc;

use super::Bsdf;
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::Reading;

/// What a clear material is filled with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interior {
    /// How it dims light.
    pub absorption: Absorption,
    /// The highest is there alone.
    pub priority: u32,
    /// Its index of refraction, where that is one number.
    pub eta: Option<f32>,
    /// That of what the scene says is outside of it.
    pub outside: Option<f32>,
}

/// How a medium dims light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Absorption {
    /// Not at all.
    #[default]
    None,
    /// By so much per m.
    Sigma(Colour),
    /// To this colour after a way in m.
    Colour(Colour, f32),
}

/// What is taken for black by a logarithm.
const DARKEST: f32 = 1e-30;

impl Interior {
    /// Of what the scene says; indices of refraction inside and outside, where they are numbers.
    pub(super) fn of(d: &desc::Interior, eta: [Option<f64>; 2], paint: &mut Paint<'_>) -> Self {
        let absorption = match (&d.sigma_a, &d.attenuation_color) {
            (Some(sigma), _) => Absorption::Sigma(paint.coefficient(sigma)),
            (None, Some(colour)) => Absorption::Colour(paint.share(colour), d.attenuation_distance as f32),
            (None, None) => Absorption::None,
        };
        let [eta, outside] = eta.map(|index| index.map(|n| n as f32));
        Self { absorption, priority: d.priority, eta, outside }
    }

    /// What is left of light after a way in m, which may be endless.
    pub fn left_after<L: Lanes>(&self, way: f32, reading: &Reading<'_, L>) -> Light {
        let (sigma, way) = match &self.absorption {
            Absorption::None => return Light::ONE,
            Absorption::Sigma(sigma) => (reading.light(sigma), way),
            Absorption::Colour(colour, distance) => {
                (reading.light(colour).map(|c| -ops::ln(ops::max(c, DARKEST))), way / distance)
            }
        };
        // Nothing absorbs nothing on an endless way as well.
        sigma.map(|s| if s > 0.0 { ops::exp(-(s * way)) } else { 1.0 })
    }
}

/// What all materials of a world are filled with.
#[derive(Clone, Debug, Default)]
pub struct Interiors {
    /// By material: its number, or 0.
    numbers: Vec<u16>,
    /// By number less 1.
    list: Vec<Interior>,
    /// Whether any absorbs light or is above another.
    matter: bool,
    /// Whether priorities differ.
    ranked: bool,
}

/// A boundary that a ray has met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Boundary {
    /// It is inside of something that is alone there: the ray goes on as if it weren't, inside of these.
    Ignored(Inside),
    /// It is one; with the index of refraction of what its normal points away from over that on the other side, if that isn't as
    /// the material says.
    Real(Option<f32>),
}

impl Interiors {
    /// That of a material, which takes the place of what was said of it before.
    pub(super) fn note(&mut self, material: u32, interior: Option<Interior>) {
        let place = material as usize;
        if self.numbers.len() <= place {
            self.numbers.resize(place + 1, 0);
        }
        self.numbers[place] = match interior {
            Some(interior) if self.list.len() < usize::from(u16::MAX) => {
                self.list.push(interior);
                self.matter |= interior.absorption != Absorption::None || interior.priority > 0;
                self.ranked |= interior.priority != self.list[0].priority;
                self.list.len() as u16
            }
            _ => 0,
        };
    }

    /// Whether paths must know what they are inside of.
    #[inline(always)]
    pub fn matter(&self) -> bool {
        self.matter
    }

    /// The number of a material's interior; 0 where it has none.
    #[inline]
    pub fn number(&self, material: u32) -> u16 {
        self.numbers.get(material as usize).copied().unwrap_or(0)
    }

    fn get(&self, number: u16) -> Option<&Interior> {
        self.list.get(usize::from(number).checked_sub(1)?)
    }

    /// The medium that a path is in: of the highest priority, and the last of those.
    fn medium(&self, inside: Inside) -> Option<(u16, &Interior)> {
        let mut found: Option<(u16, &Interior)> = None;
        for number in inside.0 {
            let Some(interior) = self.get(number) else { continue };
            if found.is_none_or(|(_, other)| interior.priority > other.priority) {
                found = Some((number, interior));
            }
        }
        found
    }

    /// What is left of light after a way inside.
    pub fn left_after<L: Lanes>(&self, inside: Inside, way: f32, reading: &Reading<'_, L>) -> Light {
        self.medium(inside).map_or(Light::ONE, |(_, medium)| medium.left_after(way, reading))
    }

    /// What the boundary of interior `number` is, for a path that meets it from outside or from inside.
    pub fn boundary(&self, inside: Inside, number: u16, entering: bool) -> Boundary {
        let (true, Some(own)) = (self.ranked, self.get(number)) else { return Boundary::Real(None) };
        let (without, within) = if entering {
            (inside, inside.crossed(number, true))
        } else {
            // It may have started inside.
            let within = if inside.0.contains(&number) { inside } else { inside.crossed(number, true) };
            (within.crossed(number, false), within)
        };
        if self.medium(within).is_some_and(|(medium, _)| medium != number) {
            return Boundary::Ignored(if entering { within } else { without });
        }
        // Of what has no single index the boundary says itself what is on its sides.
        let outside = self.medium(without).and_then(|(_, medium)| medium.eta).or(own.outside);
        Boundary::Real(own.eta.zip(outside).map(|(eta, outside)| eta / outside))
    }
}

/// Numbers of the interiors that a path is inside of, the last first; the rest is 0. What doesn't fit is forgotten.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inside([u16; 4]);

impl Inside {
    /// After going into an interior, or out of it.
    pub fn crossed(self, number: u16, into: bool) -> Self {
        let [a, b, c, d] = self.0;
        if number == 0 {
            return self;
        }
        if into {
            return Self([number, a, b, c]);
        }
        match self.0.iter().position(|n| *n == number) {
            Some(0) => Self([b, c, d, 0]),
            Some(1) => Self([a, c, d, 0]),
            Some(2) => Self([a, b, d, 0]),
            Some(_) => Self([a, b, c, 0]),
            None => self,
        }
    }

    /// Where it is inside of nothing that is known, but of this.
    pub fn or(self, number: u16) -> Self {
        if self.0[0] == 0 { self.crossed(number, true) } else { self }
    }
}

impl Bsdf<'_> {
    /// The same with another index of refraction on the side of -z over that on the side of z, where it has a single one.
    pub(crate) fn with_eta(mut self, eta: f32) -> Self {
        match &mut self {
            Self::Dielectric(b) => b.eta = eta,
            Self::Clear(b) => b.eta = eta,
            Self::RoughDielectric(b) => b.eta = eta,
            _ => {}
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(eta: f32, priority: u32) -> Interior {
        Interior { absorption: Absorption::None, priority, eta: Some(eta), outside: Some(1.0) }
    }

    /// A boundary of no single index is what it says itself, in whatever it stands, and so is what stands in a medium of none.
    #[test]
    fn what_has_no_index_leaves_boundaries_as_they_say() {
        let mut all = glass_of_water();
        all.note(5, Some(Interior { eta: None, ..of(1.0, 1) }));
        let air = Inside::default();
        assert_eq!(all.boundary(air, 4, true), Boundary::Real(None));
        assert_eq!(all.boundary(air.crossed(1, true), 4, true), Boundary::Real(None));
        // The glass within it, as if it stood in air.
        assert_eq!(all.boundary(air.crossed(4, true), 2, true), Boundary::Real(Some(1.5)));
    }

    /// Water 1 that reaches into a glass 2, in which there is a bubble 3.
    fn glass_of_water() -> Interiors {
        let mut all = Interiors::default();
        all.note(7, Some(of(1.33, 1)));
        all.note(3, Some(of(1.5, 2)));
        all.note(4, Some(of(1.0, 3)));
        all
    }

    #[test]
    fn the_highest_priority_is_there_alone() {
        let all = glass_of_water();
        assert!(all.matter());
        assert_eq!([7, 3, 4, 0, 99].map(|m| all.number(m)), [1, 2, 3, 0, 0]);
        // From air into the glass, over the water's boundary, out of the glass into water.
        let air = Inside::default();
        assert_eq!(all.boundary(air, 2, true), Boundary::Real(Some(1.5)));
        let glass = air.crossed(2, true);
        let both = glass.crossed(1, true);
        assert_eq!(all.boundary(glass, 1, true), Boundary::Ignored(both));
        assert_eq!(all.boundary(both, 2, false), Boundary::Real(Some(1.5 / 1.33)));
        let water = both.crossed(2, false);
        assert_eq!(water, air.crossed(1, true));
        // And all the way back: the water's boundary is met from inside, within the glass.
        assert_eq!(all.boundary(water, 2, true), Boundary::Real(Some(1.5 / 1.33)));
        assert_eq!(all.boundary(water.crossed(2, true), 1, false), Boundary::Ignored(glass));
        // A bubble in the glass, and a path that starts in it.
        assert_eq!(all.boundary(glass, 3, true), Boundary::Real(Some(1.0 / 1.5)));
        assert_eq!(all.boundary(air, 3, false), Boundary::Real(Some(1.0)));
    }

    #[test]
    fn without_priorities_boundaries_are_as_they_say() {
        let mut all = Interiors::default();
        let tinted = Absorption::Colour(Light::rgb([0.5, 0.25, 0.0]).into(), 2.0);
        all.note(0, Some(Interior { absorption: tinted, ..of(1.5, 0) }));
        all.note(1, Some(of(1.0, 0)));
        let glass = Inside::default().crossed(1, true);
        assert_eq!(all.boundary(glass, 2, true), Boundary::Real(None));
        // A bubble in the glass is clear.
        let reading = crate::testing::in_rgb();
        let left = |inside, way| all.left_after(inside, way, &reading).to_rgb();
        let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(near(left(glass, 4.0), [0.25, 0.0625, 0.0]));
        assert_eq!(left(glass.crossed(2, true), 4.0), [1.0; 3]);
        assert_eq!(left(glass, f32::INFINITY), [0.0; 3]);
        assert_eq!(left(glass, 0.0), [1.0; 3]);
        assert_eq!(left(Inside::default(), f32::INFINITY), [1.0; 3]);
        assert_eq!(left(Inside::default().or(1), 2.0), left(glass, 2.0));
    }

    #[test]
    fn a_full_list_forgets_what_is_farthest_out() {
        let mut inside = Inside::default();
        for n in 1..=5 {
            inside = inside.crossed(n, true);
        }
        assert_eq!(inside, Inside([5, 4, 3, 2]));
        assert_eq!(inside.crossed(3, false), Inside([5, 4, 2, 0]));
        assert_eq!(inside.crossed(1, false), inside);
        assert_eq!(inside.crossed(0, true), inside);
    }
}
