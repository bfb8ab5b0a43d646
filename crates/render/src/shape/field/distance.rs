//! Distances, with how they change: each is written once, for numbers and for numbers with their gradient.

use std::ops::{Add, Mul, Neg, Sub};

use straal_math::{Affine, DVec3, ops};

/// What distances are computed in.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// One that doesn't change.
    fn constant(x: f64) -> Self;
    /// Its value.
    fn value(self) -> f64;
    /// The square root; of 0 or less, 0 that doesn't change.
    fn root(self) -> Self;
    /// Sine of 2 pi times it.
    fn wave(self) -> Self;

    /// Times a number.
    fn times(self, by: f64) -> Self {
        self * Self::constant(by)
    }

    /// Plus a number.
    fn plus(self, by: f64) -> Self {
        self + Self::constant(by)
    }

    /// The greater of two.
    fn or_more(self, o: Self) -> Self {
        if self.value() > o.value() { self } else { o }
    }

    /// Without its sign.
    fn size(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }
}

impl Number for f64 {
    fn constant(x: f64) -> Self {
        x
    }

    fn value(self) -> f64 {
        self
    }

    fn root(self) -> Self {
        if self > 0.0 { self.sqrt() } else { 0.0 }
    }

    fn wave(self) -> Self {
        ops::sin_cos_d(self * std::f64::consts::TAU).0
    }
}

/// A number and how it changes with the place.
#[derive(Clone, Copy, Debug)]
pub struct Jet {
    value: f64,
    gradient: DVec3,
}

impl Jet {
    /// The coordinates of a place.
    pub fn of(p: DVec3) -> [Self; 3] {
        let one = |value: f64, gradient: DVec3| Self { value, gradient };
        [one(p.x, DVec3::X), one(p.y, DVec3::Y), one(p.z, DVec3::Z)]
    }

    /// How it changes.
    pub fn gradient(self) -> DVec3 {
        self.gradient
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self { value: self.value + o.value, gradient: self.gradient + o.gradient }
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self { value: self.value - o.value, gradient: self.gradient - o.gradient }
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self { value: self.value * o.value, gradient: o.gradient * self.value + self.gradient * o.value }
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, gradient: -self.gradient }
    }
}

impl Number for Jet {
    fn constant(value: f64) -> Self {
        Self { value, gradient: DVec3::ZERO }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn root(self) -> Self {
        let value = self.value.root();
        let gradient = if value > 0.0 { self.gradient * (0.5 / value) } else { DVec3::ZERO };
        Self { value, gradient }
    }

    fn wave(self) -> Self {
        let (s, c) = ops::sin_cos_d(self.value * std::f64::consts::TAU);
        Self { value: s, gradient: self.gradient * (c * std::f64::consts::TAU) }
    }
}

/// How several bodies are taken together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mix {
    /// Where any is.
    Union,
    /// Where all are.
    Intersection,
    /// Where the first is and no other.
    Difference,
}

/// A body that is told by its distance.
#[derive(Clone, Debug)]
pub enum Body {
    /// About a center with a radius.
    Ball(DVec3, f64),
    /// By its middle and half its edges.
    Box(DVec3, DVec3),
    /// About y: middle, radius, radius of the tube.
    Ring(DVec3, [f64; 2]),
    /// Ends and radius.
    Capsule([DVec3; 2], f64),
    /// Ends and radius.
    Cylinder([DVec3; 2], f64),
    /// Several, with seams smoothed over so far.
    Several(Mix, Vec<Body>, f64),
    /// Seen through a map to its own space, and how much larger it is.
    Moved(Box<Body>, Affine, Affine, f64),
    /// Thicker by so much.
    Grown(Box<Body>, f64),
    /// Its skin, so thick to either side.
    Shell(Box<Body>, f64),
    /// Waves of a height and a length.
    Ripples(Box<Body>, [f64; 2]),
    /// Numbers on a grid.
    Grid(Grid),
}

/// Distances at the corners of a grid, and evenly between; nothing is outside of it.
#[derive(Clone, Debug)]
pub struct Grid {
    low: DVec3,
    high: DVec3,
    size: [usize; 3],
    values: Vec<f64>,
    steepest: f64,
}

impl Grid {
    /// By its box, its numbers of points, two at least along each axis, and their values; `None` where these don't fit.
    pub fn new(low: DVec3, high: DVec3, size: [usize; 3], values: Vec<f64>) -> Option<Self> {
        let count = size.iter().try_fold(1_usize, |all, n| all.checked_mul(*n))?;
        if size.iter().any(|n| *n < 2) || count != values.len() {
            return None;
        }
        let mut grid = Self { low, high, size, values, steepest: 0.0 };
        let step = grid.step();
        // Between points it changes no faster along an axis than along the steepest edge.
        let mut most = [0.0_f64; 3];
        let [nx, ny, nz] = size;
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    let here = grid.at([x, y, z]);
                    let ahead = [
                        (x + 1 < nx).then(|| grid.at([x + 1, y, z])),
                        (y + 1 < ny).then(|| grid.at([x, y + 1, z])),
                        (z + 1 < nz).then(|| grid.at([x, y, z + 1])),
                    ];
                    for (most, there) in most.iter_mut().zip(ahead) {
                        let change = there.map_or(0.0, |there| (there - here).abs());
                        *most = if change > *most { change } else { *most };
                    }
                }
            }
        }
        grid.steepest = DVec3::new(most[0] / step.x, most[1] / step.y, most[2] / step.z).length();
        Some(grid)
    }

    fn step(&self) -> DVec3 {
        let [x, y, z] = self.size.map(|n| (n - 1) as f64);
        let size = self.high - self.low;
        DVec3::new(size.x / x, size.y / y, size.z / z)
    }

    fn at(&self, [x, y, z]: [usize; 3]) -> f64 {
        self.values.get((z * self.size[1] + y) * self.size[0] + x).copied().unwrap_or(0.0)
    }

    fn value<N: Number>(&self, p: [N; 3]) -> N {
        let (low, step) = (self.low.to_array(), self.step().to_array());
        let mut cell = [0; 3];
        let mut part = p;
        for k in 0..3 {
            let last = self.size[k] - 1;
            let x = p[k].plus(-low[k]).times(1.0 / step[k]);
            let x = if x.value() < 0.0 {
                N::constant(0.0)
            } else if x.value() > last as f64 {
                N::constant(last as f64)
            } else {
                x
            };
            cell[k] = (x.value() as usize).min(last - 1);
            part[k] = x.plus(-(cell[k] as f64));
        }
        let mix = |a: N, b: N, w: N| a + (b - a) * w;
        let row = |y: usize, z: usize| {
            let at = |x: usize| N::constant(self.at([cell[0] + x, cell[1] + y, cell[2] + z]));
            mix(at(0), at(1), part[0])
        };
        let slice = |z: usize| mix(row(0, z), row(1, z), part[1]);
        let inside = mix(slice(0), slice(1), part[2]);
        inside.or_more(cuboid(p, (self.low + self.high) * 0.5, (self.high - self.low) * 0.5))
    }
}

fn minus<N: Number>(p: [N; 3], c: DVec3) -> [N; 3] {
    let c = c.to_array();
    [p[0].plus(-c[0]), p[1].plus(-c[1]), p[2].plus(-c[2])]
}

fn length<N: Number>(p: &[N]) -> N {
    p.iter().fold(N::constant(0.0), |sum, x| sum + *x * *x).root()
}

fn dot<N: Number>(p: [N; 3], v: DVec3) -> N {
    p[0].times(v.x) + p[1].times(v.y) + p[2].times(v.z)
}

/// Outside, the length of what is beyond in each coordinate; inside, the nearest side.
fn corner<N: Number, const K: usize>(beyond: [N; K]) -> N {
    let zero = N::constant(0.0);
    let outside = length(&beyond.map(|x| x.or_more(zero)));
    if outside.value() > 0.0 {
        return outside;
    }
    beyond.into_iter().fold(N::constant(f64::NEG_INFINITY), |most, x| x.or_more(most))
}

fn cuboid<N: Number>(p: [N; 3], middle: DVec3, half: DVec3) -> N {
    let [x, y, z] = minus(p, middle).map(N::size);
    corner([x.plus(-half.x), y.plus(-half.y), z.plus(-half.z)])
}

/// The lesser of two, less by up to a quarter of `k` where they are nearer than that (a parabola in between).
fn blended<N: Number>(a: N, b: N, k: f64) -> N {
    let lesser = -((-a).or_more(-b));
    let near = (-(a - b).size()).plus(k).or_more(N::constant(0.0));
    if k > 0.0 { lesser - (near * near).times(0.25 / k) } else { lesser }
}

impl Body {
    /// The distance at a place.
    pub fn distance(&self, p: DVec3) -> f64 {
        self.value(p.to_array())
    }

    /// The same, in any numbers.
    pub fn value<N: Number>(&self, p: [N; 3]) -> N {
        match self {
            Self::Ball(c, r) => length(&minus(p, *c)).plus(-r),
            Self::Box(middle, half) => cuboid(p, *middle, *half),
            Self::Ring(c, [radius, tube]) => {
                let [x, y, z] = minus(p, *c);
                length(&[length(&[x, z]).plus(-radius), y]).plus(-tube)
            }
            Self::Capsule([a, b], r) => {
                let (q, way) = (minus(p, *a), *b - *a);
                let part = dot(q, way).times(1.0 / way.dot(way));
                let part = if part.value() < 0.0 {
                    N::constant(0.0)
                } else if part.value() > 1.0 {
                    N::constant(1.0)
                } else {
                    part
                };
                let off = [q[0] - part.times(way.x), q[1] - part.times(way.y), q[2] - part.times(way.z)];
                length(&off).plus(-r)
            }
            Self::Cylinder([a, b], r) => {
                let way = *b - *a;
                let half = 0.5 * way.length();
                let axis = way / (2.0 * half);
                let q = minus(p, (*a + *b) * 0.5);
                let h = dot(q, axis);
                let out = [q[0] - h.times(axis.x), q[1] - h.times(axis.y), q[2] - h.times(axis.z)];
                corner([length(&out).plus(-r), h.size().plus(-half)])
            }
            Self::Several(mix, all, k) => {
                let mut values = all.iter().map(|body| body.value(p));
                let Some(first) = values.next() else { return N::constant(f64::INFINITY) };
                match mix {
                    Mix::Union => values.fold(first, |a, b| blended(a, b, *k)),
                    Mix::Intersection => values.fold(first, |a, b| -blended(-a, -b, *k)),
                    Mix::Difference => values.fold(first, |a, b| -blended(-a, b, *k)),
                }
            }
            Self::Moved(body, _, back, scale) => {
                let row = |i: usize| {
                    let [x, y, z, w] = back.rows[i];
                    dot(p, DVec3::new(x, y, z)).plus(w)
                };
                body.value([row(0), row(1), row(2)]).times(*scale)
            }
            Self::Grown(body, by) => body.value(p).plus(-by),
            Self::Shell(body, by) => body.value(p).size().plus(-by),
            Self::Ripples(body, [height, wave]) => {
                let [x, y, z] = p.map(|x| x.times(1.0 / wave).wave());
                body.value(p) + (x * y * z).times(*height)
            }
            Self::Grid(grid) => grid.value(p),
        }
    }

    /// A box outside of which all distances are above `d`.
    pub fn within(&self, d: f64) -> (DVec3, DVec3) {
        let about = |c: DVec3, r: DVec3| (c - r - DVec3::splat(d), c + r + DVec3::splat(d));
        let around = |[a, b]: [DVec3; 2], r: f64| {
            let r = DVec3::splat(r + d);
            (a.min(b) - r, a.max(b) + r)
        };
        match self {
            Self::Ball(c, r) => about(*c, DVec3::splat(*r)),
            Self::Box(c, half) => about(*c, *half),
            Self::Ring(c, [radius, tube]) => about(*c, DVec3::new(radius + tube, *tube, radius + tube)),
            Self::Capsule(ends, r) | Self::Cylinder(ends, r) => around(*ends, *r),
            Self::Several(mix, all, k) => {
                let seams = 0.25 * k * (all.len().saturating_sub(1)) as f64;
                let mut boxes =
                    all.iter().map(|body| body.within(if *mix == Mix::Union { d + seams } else { d }));
                let nowhere = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
                let Some(first) = boxes.next() else { return nowhere };
                match mix {
                    Mix::Union => boxes.fold(first, |(l, h), (a, b)| (l.min(a), h.max(b))),
                    Mix::Intersection => boxes.fold(first, |(l, h), (a, b)| (l.max(a), h.min(b))),
                    Mix::Difference => first,
                }
            }
            Self::Moved(body, map, _, scale) => {
                let (low, high) = body.within(d / scale);
                let (c, half) = (map.point((low + high) * 0.5), (high - low) * 0.5);
                let reach = |i: usize| {
                    let [x, y, z, _] = map.rows[i];
                    x.abs() * half.x + y.abs() * half.y + z.abs() * half.z
                };
                let r = DVec3::new(reach(0), reach(1), reach(2));
                (c - r, c + r)
            }
            Self::Grown(body, by) | Self::Shell(body, by) => body.within(d + by),
            Self::Ripples(body, [height, _]) => body.within(d + height),
            Self::Grid(grid) => about((grid.low + grid.high) * 0.5, (grid.high - grid.low) * 0.5),
        }
    }

    /// How fast the distance changes at most: its Lipschitz bound.
    pub fn steepest(&self) -> f64 {
        let most = |all: &[Body]| all.iter().map(Self::steepest).fold(0.0, |a, b| if a > b { a } else { b });
        match self {
            Self::Ball(..) | Self::Box(..) | Self::Ring(..) | Self::Capsule(..) | Self::Cylinder(..) => 1.0,
            // What smooths seams is between the two in steepness as well.
            Self::Several(_, all, _) => most(all),
            Self::Moved(body, ..) | Self::Grown(body, _) | Self::Shell(body, _) => body.steepest(),
            // The product of three sines changes no faster than one of them.
            Self::Ripples(body, [height, wave]) => body.steepest() + std::f64::consts::TAU * height / wave,
            Self::Grid(grid) => {
                if grid.steepest > 1.0 {
                    grid.steepest
                } else {
                    1.0
                }
            }
        }
    }
}
