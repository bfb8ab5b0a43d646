//! Sampling patterns as points of a square: how evenly they lie, and a picture of it.

mod figures;
mod plot;

pub use figures::{Course, Figures, figures, star_discrepancy};
pub use plot::svg;

use straal_math::lowdisc::{Pattern, PatternKind, Purpose};
use straal_math::{ops, warp};

/// Most points that figures are worked out for: the time grows with their square.
pub const MOST: u32 = 8192;

/// Which points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// The pattern.
    pub kind: PatternKind,
    /// How many, from 1 to [`MOST`].
    pub count: u32,
    /// Seed of the pattern.
    pub seed: u64,
    /// Which two of the four numbers that a sample may draw at once.
    pub dimensions: [usize; 2],
}

impl Request {
    /// The points of one pixel.
    pub fn points(&self, pixel: [u32; 2]) -> Vec<[f32; 2]> {
        let pattern = Pattern::new(self.kind, self.count);
        let point = |i| {
            let four = pattern.d4(&pattern.name(self.seed, pixel, i), Purpose::Film);
            self.dimensions.map(|d| four[d])
        };
        (0..self.count).map(point).collect()
    }
}

/// What the square is mapped to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Map {
    /// Itself.
    #[default]
    Square,
    /// A disc, concentrically.
    Disc,
    /// A hemisphere in proportion to a power of the cosine, seen from its pole.
    Hemisphere(f32),
    /// A sphere, its halves unfolded side by side in the ring around the near one (equal areas, Lambert 1772).
    Sphere,
    /// A triangle.
    Triangle,
    /// A cone of directions of this many degrees about its axis, seen along it.
    Cone(f32),
}

impl Map {
    /// Where a point of the unit square is drawn, in the unit square.
    pub fn place(&self, u: [f32; 2]) -> [f64; 2] {
        let round = |[x, y]: [f32; 2]| [x, y].map(|v| 0.5 + 0.5 * f64::from(v));
        match *self {
            Self::Square => u.map(f64::from),
            Self::Disc => round(warp::concentric_disc(u)),
            Self::Hemisphere(exponent) => {
                let d = warp::cosine_power_hemisphere(u, exponent);
                round([d.x, d.y])
            }
            Self::Sphere => {
                let d = warp::uniform_sphere(u);
                // The radius is 1 at the far pole.
                let scale = (1.0 / ops::max(2.0 * (1.0 + d.z), 1e-12)).sqrt();
                round([d.x * scale, d.y * scale])
            }
            Self::Triangle => warp::uniform_triangle(u).map(f64::from),
            Self::Cone(degrees) => {
                let (sin, cos) = ops::sin_cos_degrees(f64::from(degrees));
                let d = warp::uniform_cone(u, (1.0 - cos) as f32);
                let widest = if degrees < 90.0 { sin as f32 } else { 1.0 };
                round([d.x / widest, d.y / widest])
            }
        }
    }
}
