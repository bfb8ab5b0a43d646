//! The opening of a lens, and places drawn in it.

use straal_math::simd::Float;
use straal_math::{ops, warp};

/// The opening of a lens: a shape, and how light is spread over it.
#[derive(Clone, Debug, PartialEq)]
pub struct Iris {
    /// In the scene's units.
    radius: f32,
    opening: Opening,
}

#[derive(Clone, Debug, PartialEq)]
enum Opening {
    Disc,
    /// A bell of this standard deviation, in radii, over the disc.
    Bell(f64),
    /// Corners of a polygon in the unit circle, counter-clockwise; the last is the first.
    Polygon(Box<[[f32; 2]]>),
}

impl Iris {
    /// A disc that light fills evenly.
    pub fn round(radius: f64) -> Self {
        Self { radius: radius as f32, opening: Opening::Disc }
    }

    /// A disc over which light falls off as a Gaussian of standard deviation `sigma` radii.
    pub fn gaussian(radius: f64, sigma: f64) -> Self {
        Self { radius: radius as f32, opening: Opening::Bell(sigma) }
    }

    /// A regular polygon that light fills evenly, with its corners at the radius and the first of them turned by an angle
    /// in degrees from the right, counter-clockwise seen from behind. At least three corners.
    pub fn polygon(radius: f64, corners: u32, degrees: f64) -> Self {
        let n = corners.max(3);
        let corner = |i: u32| {
            let (s, c) = ops::sin_cos_degrees(degrees + 360.0 * f64::from(i) / f64::from(n));
            [c as f32, s as f32]
        };
        let all = (0..n).map(corner).chain([corner(0)]).collect();
        Self { radius: radius as f32, opening: Opening::Polygon(all) }
    }

    /// How far from the axis light may pass.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// A place in the opening, to the right of the axis and above it, for a point of the unit square. None of the maps
    /// tears the square apart, so that what is spread evenly stays so.
    #[inline(always)]
    pub fn sample<F: Float>(&self, u: [F; 2]) -> [F; 2] {
        let [x, y] = match &self.opening {
            Opening::Disc => warp::concentric_disc(u),
            Opening::Bell(sigma) => one_by_one(u, |u| bell(warp::concentric_disc(u), *sigma)),
            Opening::Polygon(corners) => one_by_one(u, |u| polygon(u, corners)),
        };
        [x * self.radius, y * self.radius]
    }
}

/// What `f` gives for each lane's point.
#[inline(always)]
fn one_by_one<F: Float>([u, v]: [F; 2], f: impl Fn([f32; 2]) -> [f32; 2]) -> [F; 2] {
    let [mut x, mut y] = [u.to_array(), v.to_array()];
    for i in 0..F::WIDTH {
        let [a, b] = f([x.as_ref()[i], y.as_ref()[i]]);
        x.as_mut()[i] = a;
        y.as_mut()[i] = b;
    }
    [F::from_array(x), F::from_array(y)]
}

/// Moves a point of the evenly filled disc towards or from the middle so that its density becomes a bell's. The squared
/// radius t of an evenly filled disc is even in [0, 1]; that of a bell cut off at radius 1 is -2 s² ln(1 - t k) with
/// k = 1 - exp(-1 / 2 s²), by inverting its distribution.
fn bell([x, y]: [f32; 2], sigma: f64) -> [f32; 2] {
    let t = f64::from(x) * f64::from(x) + f64::from(y) * f64::from(y);
    let two = 2.0 * sigma * sigma;
    let k = 1.0 - ops::exp_d(-1.0 / two);
    // Near the middle ln(1 - t k) / t has lost its digits, and is -k.
    let stretch = if t > 1e-9 { (-two * ops::ln_d(1.0 - t * k) / t).sqrt() } else { (two * k).sqrt() };
    // A bell much wider than the disc, of which double precision sees no curve, is even.
    let stretch = if k > 1e-9 { stretch } else { 1.0 };
    [(f64::from(x) * stretch) as f32, (f64::from(y) * stretch) as f32]
}

/// Squares about the middle become polygons about it, as in Shirley and Chiu's map they become circles: a ring of the
/// square has the same share of the area as that of the polygon, and the way around it is gone at an even pace.
fn polygon(u: [f32; 2], corners: &[[f32; 2]]) -> [f32; 2] {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    let (ring, turn) = if a.abs() > b.abs() {
        (a.abs(), 0.125 * (b / a) + if a < 0.0 { 0.5 } else { 0.0 })
    } else if b != 0.0 {
        (b.abs(), 0.25 - 0.125 * (a / b) + if b < 0.0 { 0.5 } else { 0.0 })
    } else {
        return [0.0, 0.0];
    };
    let n = corners.len() - 1;
    let along = if turn < 0.0 { turn + 1.0 } else { turn } * n as f32;
    let edge = (along as usize).min(n - 1);
    let (from, to, f) = (corners[edge], corners[edge + 1], along - edge as f32);
    [ring * (from[0] + (to[0] - from[0]) * f), ring * (from[1] + (to[1] - from[1]) * f)]
}
