//! How a pyramid is read at a point.
//!
//! A pixel sees a square of the plane of the film, which on the texture is a parallelogram about the point, spanned by the footprint's two
//! vectors a and b. A square of side 1 has the variance 1/12; so the parallelogram has the covariance (a aT + b bT) / 12, whose
//! eigenvalues tell how long and how wide it is. Both filters are made to have that variance, so that pictures are neither
//! blurred nor noisy:
//!
//! - *trilinear* takes the length for both. A level whose texels are w wide, which are means, read between four of them, has the
//!   variance w² / 12 + w² / 6: w is the length over the root of 3, between two levels;
//! - *EWA* (Greene and Heckbert 1986; Heckbert 1989, "Fundamentals of Texture Mapping and Image Warping", 3.4) takes the mean of
//!   all texels within an ellipse about the point, weighed by (1 - r²)², which is near a Gaussian, has an end, and in an
//!   ellipse of radius R the variance R² / 8. It reads the level of which 2 to 4 texels lie across the parallelogram, and takes
//!   the variance of these texels off the ellipse's; so levels fit one another and one is enough;
//! - *stochastic* (Fajardo et al. 2023, "Stochastic Texture Filtering"; Pharr et al. 2024, "Filtering After Shading With Stochastic Texture Filtering")
//!   reads a single texel, drawn by the weights of EWA. What comes of it is right in the mean, and after shading, which isn't the same where shading isn't linear.
//!   A place is drawn in the ellipse, and the texel that it lies in is read: which adds the variance of a texel, so that the ellipse is
//!   smaller by as much. Where nothing is drawn (masks along shadow rays, bumps, lights, colours for a denoiser) it is EWA.

use straal_math::ops;
use straal_scene::bitmap::Texels;
use straal_scene::desc::{TextureFilter, Wrap};

use super::pyramid::{Formatted, Pyramid, by_format};

/// Where a picture is read: its coordinates, 0 to 1 from its left edge and from its lower one, and how they change from pixel to
/// pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Where.
    pub st: [f32; 2],
    /// Change from a pixel to its neighbour to the right.
    pub dx: [f32; 2],
    /// Change from a pixel to the one below.
    pub dy: [f32; 2],
    /// Two numbers in [0, 1) by which a texel is drawn, where one may be.
    pub lot: Option<[f32; 2]>,
}

/// How a pyramid is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    filter: Filter,
    wrap: [Mode; 2],
    /// The most that an ellipse may be longer than wide.
    anisotropy: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Filter {
    Nearest,
    Bilinear,
    Trilinear,
    Ewa,
    Stochastic,
}

/// What is beyond an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    Repeat,
    Mirror,
    Clamp,
    Black,
}

impl Sampling {
    /// As a scene says it.
    pub fn of(filter: &TextureFilter, wrap: &[Wrap; 2], anisotropy: f64) -> Self {
        let mode = |w: &Wrap| match w {
            Wrap::Repeat => Mode::Repeat,
            Wrap::Mirror => Mode::Mirror,
            Wrap::Clamp => Mode::Clamp,
            Wrap::Black => Mode::Black,
        };
        let filter = match filter {
            TextureFilter::Nearest => Filter::Nearest,
            TextureFilter::Bilinear => Filter::Bilinear,
            TextureFilter::Trilinear => Filter::Trilinear,
            TextureFilter::Ewa => Filter::Ewa,
            TextureFilter::Stochastic => Filter::Stochastic,
        };
        Self { filter, wrap: [mode(&wrap[0]), mode(&wrap[1])], anisotropy: anisotropy as f32 }
    }

    /// Whether it reads smaller copies of a picture.
    pub(crate) fn needs_smaller(&self) -> bool {
        matches!(self.filter, Filter::Trilinear | Filter::Ewa | Filter::Stochastic)
    }

    /// Whether it draws texels.
    pub(crate) fn draws(&self) -> bool {
        self.filter == Filter::Stochastic
    }

    /// Linear sRGB and alpha of a pyramid at a spot.
    pub fn look_up(&self, pyramid: &Pyramid, spot: &Spot) -> [f32; 4] {
        let found = by_format(pyramid.format(), LookUp { sampling: self, pyramid, spot });
        pyramid.to_srgb(found)
    }
}

struct LookUp<'a> {
    sampling: &'a Sampling,
    pyramid: &'a Pyramid,
    spot: &'a Spot,
}

impl Formatted for LookUp<'_> {
    type Output = [f32; 4];

    #[inline(always)]
    fn run<const NUMBER: u8, const CHANNELS: usize>(self) -> [f32; 4] {
        let Self { sampling, pyramid, spot } = self;
        let reader = Reader::<NUMBER, CHANNELS> { pyramid, wrap: sampling.wrap };
        // Rows go downwards.
        let at = [start(sampling.wrap[0], spot.st[0]), 1.0 - start(sampling.wrap[1], spot.st[1])];
        match sampling.filter {
            Filter::Nearest => reader.nearest(at),
            Filter::Bilinear => reader.bilinear(pyramid.level(0), at),
            Filter::Trilinear => reader.trilinear(at, &Seen::of(spot, pyramid.size())),
            Filter::Ewa | Filter::Stochastic => {
                let seen = Seen::of(spot, pyramid.size());
                match spot.lot.filter(|_| sampling.filter == Filter::Stochastic) {
                    Some(lot) => reader.drawn(at, &seen, sampling.anisotropy, lot),
                    None => reader.ewa(at, &seen, sampling.anisotropy),
                }
            }
        }
    }
}

/// A coordinate within the first periods of a picture that repeats, and near one that doesn't: what is far away is as what is near,
/// and has the digits to tell texels apart.
#[inline(always)]
fn start(mode: Mode, x: f32) -> f32 {
    let x = if x.is_finite() { x } else { 0.0 };
    match mode {
        Mode::Repeat => x - x.floor(),
        Mode::Mirror => x - 2.0 * (0.5 * x).floor(),
        Mode::Clamp | Mode::Black => ops::clamp(x, -4.0, 4.0),
    }
}

/// The texel in a row of `count` that shows at a place in it, if any does.
#[inline(always)]
fn shown(mode: Mode, i: i32, count: usize) -> Option<usize> {
    let n = count as i32;
    if (0..n).contains(&i) {
        return Some(i as usize);
    }
    match mode {
        Mode::Repeat => Some(i.rem_euclid(n) as usize),
        Mode::Mirror => {
            let i = i.rem_euclid(2 * n);
            Some(if i < n { i } else { 2 * n - 1 - i } as usize)
        }
        Mode::Clamp => Some(if i < 0 { 0 } else { count - 1 }),
        Mode::Black => None,
    }
}

/// What a pixel sees of a picture, in squares of its texels.
struct Seen {
    /// The matrix a aT + b bT: xx, xy, yy.
    matrix: [f32; 3],
    /// Its eigenvalues: squares of length and width.
    length: f32,
    width: f32,
}

/// No pixel sees more texels than this in a row, but for being none the wiser. Its fourth power is a number yet.
const MOST: f32 = 1e9;

impl Seen {
    #[inline(always)]
    fn of(spot: &Spot, [w, h]: [f32; 2]) -> Self {
        // Rows go downwards.
        let [a, b] = [spot.dx, spot.dy].map(|[s, t]| [s * w, -t * h]);
        let sum = |i: usize, j: usize| a[i] * a[j] + b[i] * b[j];
        let (xx, xy, yy) = (sum(0, 0), sum(0, 1), sum(1, 1));
        let trace = xx + yy;
        if trace >= MOST * MOST || trace.is_nan() {
            return Self { matrix: [MOST * MOST, 0.0, MOST * MOST], length: MOST * MOST, width: MOST * MOST };
        }
        let area = a[0] * b[1] - a[1] * b[0];
        let half = 0.5 * trace;
        let root = (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
        let length = half + root;
        // Their product is the square of the area.
        let width = if length > 0.0 { area * area / length } else { 0.0 };
        Self { matrix: [xx, xy, yy], length, width }
    }
}

/// A matrix of squares of texels: within it lies x for which x times its inverse times x is below 1.
#[derive(Clone, Copy)]
struct Ellipse {
    xx: f32,
    xy: f32,
    yy: f32,
}

/// Reads texels of a known format.
struct Reader<'a, const NUMBER: u8, const CHANNELS: usize> {
    pyramid: &'a Pyramid,
    wrap: [Mode; 2],
}

impl<const NUMBER: u8, const CHANNELS: usize> Reader<'_, NUMBER, CHANNELS> {
    #[inline(always)]
    fn texel(&self, level: &Texels, x: usize, y: usize) -> [f32; 4] {
        self.pyramid.texel::<NUMBER, CHANNELS>(level, x, y)
    }

    #[inline(always)]
    fn at(&self, level: &Texels, x: Option<usize>, y: Option<usize>) -> [f32; 4] {
        match (x, y) {
            (Some(x), Some(y)) => self.texel(level, x, y),
            _ => [0.0; 4],
        }
    }

    #[inline(always)]
    fn nearest(&self, [s, t]: [f32; 2]) -> [f32; 4] {
        let level = self.pyramid.level(0);
        self.texel_at(level, [s * level.width() as f32, t * level.height() as f32])
    }

    /// The texel that a place lies in, in texels of its level.
    #[inline(always)]
    fn texel_at(&self, level: &Texels, [x, y]: [f32; 2]) -> [f32; 4] {
        let x = shown(self.wrap[0], x.floor() as i32, level.width());
        let y = shown(self.wrap[1], y.floor() as i32, level.height());
        self.at(level, x, y)
    }

    #[inline(always)]
    fn bilinear(&self, level: &Texels, [s, t]: [f32; 2]) -> [f32; 4] {
        let (w, h) = (level.width(), level.height());
        let place = |x: f32, n: usize| {
            let x = x * n as f32 - 0.5;
            let low = x.floor();
            (low as i32, x - low)
        };
        let ((x, right), (y, down)) = (place(s, w), place(t, h));
        let xs = [shown(self.wrap[0], x, w), shown(self.wrap[0], x + 1, w)];
        let ys = [shown(self.wrap[1], y, h), shown(self.wrap[1], y + 1, h)];
        let [a, b] = ys.map(|y| mixed(self.at(level, xs[0], y), self.at(level, xs[1], y), right));
        mixed(a, b, down)
    }

    #[inline(always)]
    fn trilinear(&self, at: [f32; 2], seen: &Seen) -> [f32; 4] {
        // The square of how wide texels are to be.
        let wanted = seen.length * (1.0 / 3.0);
        if wanted <= 1.0 || wanted.is_nan() {
            return self.bilinear(self.pyramid.level(0), at);
        }
        let low = log2_floor(wanted) / 2;
        let last = self.pyramid.levels() - 1;
        if low >= last {
            return self.bilinear(self.pyramid.level(last), at);
        }
        // Between the levels by width, not by its logarithm: as cheap, and as smooth.
        let step = f32::from_bits((127 - low as u32) << 23);
        let share = wanted.sqrt() * step - 1.0;
        let fine = self.bilinear(self.pyramid.level(low), at);
        let coarse = self.bilinear(self.pyramid.level(low + 1), at);
        mixed(fine, coarse, share)
    }

    /// The level that EWA reads, and its ellipse there; no ellipse where the four texels around will do.
    #[inline(always)]
    fn ellipse(&self, seen: &Seen, anisotropy: f32) -> (&Texels, Option<Ellipse>) {
        let (length, mut width) = (seen.length, seen.width);
        if length <= 1.0 {
            return (self.pyramid.level(0), None);
        }
        let least = length / (anisotropy * anisotropy);
        let fatter = ops::max(least - width, 0.0);
        width += fatter;
        let last = self.pyramid.levels() - 1;
        // 2 to 4 texels across.
        let number = (log2_floor(ops::max(width, 1.0)) / 2).saturating_sub(1);
        if number > last {
            // Several times all of it.
            return (self.pyramid.level(last), None);
        }
        let level = self.pyramid.level(number);
        let size = [level.width() as f32, level.height() as f32];
        let full = self.pyramid.size();
        let [sx, sy] = [size[0] / full[0], size[1] / full[1]];
        let scale = sx * sy;
        // The ellipse's matrix: R² = 8 / 12 (f² - 1) for what sees f texels of means; of the picture itself, whose texels are none,
        // at least 2, so that there are some in it.
        let [xx, xy, yy] = seen.matrix;
        let round = if number == 0 {
            (2.0 / 3.0) * fatter + ops::max(2.0 - (2.0 / 3.0) * width, 0.0)
        } else {
            (2.0 / 3.0) * (fatter * scale - 1.0)
        };
        let mut xx = (2.0 / 3.0) * xx * sx * sx + round;
        let mut yy = (2.0 / 3.0) * yy * sy * sy + round;
        let xy = (2.0 / 3.0) * xy * scale;
        // Sides that are halved to different numbers may leave an ellipse too thin.
        xx = ops::max(xx, 0.5);
        yy = ops::max(yy, 0.5);
        (level, Some(Ellipse { xx, xy, yy }))
    }

    /// A texel, drawn by two numbers with the weights of [`Self::ewa`].
    #[inline(always)]
    fn drawn(&self, at: [f32; 2], seen: &Seen, anisotropy: f32, [u, v]: [f32; 2]) -> [f32; 4] {
        let (level, ellipse) = self.ellipse(seen, anisotropy);
        let centre = [at[0] * level.width() as f32, at[1] * level.height() as f32];
        let Some(Ellipse { xx, xy, yy }) = ellipse else {
            // Between the four around.
            return self.texel_at(level, [centre[0] + (u - 0.5), centre[1] + (v - 0.5)]);
        };
        // Less the variance of drawing a texel by a place in it: 1/12, which is that of an ellipse of R² = 2/3.
        const TEXEL: f32 = 2.0 / 3.0;
        let (xx, yy) = (ops::max(xx - TEXEL, 0.05), ops::max(yy - TEXEL, 0.05));
        let along = xx.sqrt();
        let shear = xy / along;
        let across = ops::max(yy - shear * shear, 0.0).sqrt();
        // The weights (1 - r²)² leave 1 - (1 - r²)³ within r.
        let r = ops::max(1.0 - ops::cbrt(1.0 - u), 0.0).sqrt();
        let (sin, cos) = ops::sin_cos(std::f32::consts::TAU * v);
        let (a, b) = (r * cos, r * sin);
        self.texel_at(level, [centre[0] + along * a, centre[1] + shear * a + across * b])
    }

    #[inline(always)]
    fn ewa(&self, at: [f32; 2], seen: &Seen, anisotropy: f32) -> [f32; 4] {
        let (level, ellipse) = self.ellipse(seen, anisotropy);
        let Some(Ellipse { xx, xy, yy }) = ellipse else { return self.bilinear(level, at) };
        let size = [level.width() as f32, level.height() as f32];
        let det = ops::max(xx * yy - xy * xy, 0.25 * ops::max(xx, yy));
        let inverse = 1.0 / det;
        let (p, q, r) = (yy * inverse, -xy * inverse, xx * inverse);
        let centre = [at[0] * size[0] - 0.5, at[1] * size[1] - 0.5];
        let reach = [xx.sqrt(), yy.sqrt()];
        debug_assert!(reach.iter().all(|r| *r < 1e3), "{reach:?}");
        let first = [0, 1].map(|k| (centre[k] - reach[k]).ceil());
        let end = [0, 1].map(|k| (centre[k] + reach[k]).floor());
        let mut sum = [0.0; 4];
        let mut weights = 0.0;
        let mut y = first[1];
        while y <= end[1] {
            let dy = y - centre[1];
            let row = shown(self.wrap[1], y as i32, level.height());
            let (linear, constant) = (2.0 * q * dy, r * dy * dy);
            let mut x = first[0];
            while x <= end[0] {
                let dx = x - centre[0];
                let rest = 1.0 - (dx * (p * dx + linear) + constant);
                if rest > 0.0 {
                    let weight = rest * rest;
                    let light = self.at(level, shown(self.wrap[0], x as i32, level.width()), row);
                    (0..4).for_each(|c| sum[c] += weight * light[c]);
                    weights += weight;
                }
                x += 1.0;
            }
            y += 1.0;
        }
        if weights > 0.0 { sum.map(|v| v / weights) } else { self.bilinear(level, at) }
    }
}

/// The exponent of a number that is at least 1.
#[inline(always)]
fn log2_floor(x: f32) -> usize {
    ((x.to_bits() >> 23) as usize).saturating_sub(127)
}

#[inline(always)]
fn mixed(a: [f32; 4], b: [f32; 4], share: f32) -> [f32; 4] {
    [0, 1, 2, 3].map(|c| a[c] + (b[c] - a[c]) * share)
}
