//! Openings through which the light of surroundings comes in (Bitterli, Novák and Jarosz 2015, "Portal-Masked Environment Map Sampling").

use crate::lanes::{Lanes, Rgb};
use crate::texture::{Reading, Readings};
use straal_color::Light;
use straal_math::simd::Float;
use straal_math::{DVec3, Vec3, ops};
use straal_scene::desc;

use super::{Ball, Emitted, Emitter, Extent, LightSample, Reach, Receiver, Shine};
use crate::paint::Paint;
use crate::shape::Geometry;

/// Surroundings that light a room through openings.
///
/// For each opening the surroundings are unrolled so that straight edges along its sides stay straight: directions by their angles from the opening's normal, sideways
/// and upwards. So from any place in the room the opening is a rectangle of that picture, in which directions are drawn by radiance and solid angle from a table of
/// sums. A place that no opening faces draws as if there were none. Light that comes in elsewhere is found by BSDF sampling alone.
#[derive(Clone, Debug)]
pub struct Portals {
    surroundings: Emitter,
    portals: Vec<Portal>,
}

/// An opening.
#[derive(Clone, Debug)]
struct Portal {
    corner: DVec3,
    /// Along its edges, and out of the room: an orthonormal frame.
    axes: [DVec3; 3],
    size: [f64; 2],
    /// Of the cells to the left of a column and above a row the sum of radiance times solid angle; columns + 1 in each of rows + 1 rows.
    sums: Vec<f64>,
}

/// Cells of the unrolled picture along a side: 0.7 degrees each.
const SIDE: usize = 256;

/// Places along a side at which a cell is looked up.
const PLACES: usize = 2;

/// Steps by which a place is found: a cell, and a part of it in the same line.
const STEPS: usize = SIDE.trailing_zeros() as usize;

impl Portal {
    /// `radiance` is that of the surroundings in a direction of the world.
    fn new(corner: DVec3, [a, b]: [DVec3; 2], radiance: impl Fn(DVec3) -> f64) -> Option<Self> {
        let x = a.try_normalize()?;
        // The front faces the room.
        let z = -a.cross(b).try_normalize()?;
        let y = z.cross(x);
        let size = [a.length(), b.dot(y)];
        // Turned over, where the second edge runs the other way.
        let (corner, size) = if size[1] < 0.0 { (corner + b, [size[0], -size[1]]) } else { (corner, size) };
        let axes = [x, y, z];
        let mut sums = vec![0.0; (SIDE + 1) * (SIDE + 1)];
        let part = |i: usize, k: usize| (i as f64 + (k as f64 + 0.5) / PLACES as f64) / SIDE as f64;
        for j in 0..SIDE {
            let mut row = 0.0;
            for i in 0..SIDE {
                for k in 0..PLACES * PLACES {
                    let (w, per_angle) = unrolled([part(i, k % PLACES), part(j, k / PLACES)]);
                    let d = x * w.x + y * w.y + z * w.z;
                    let value = radiance(d) / per_angle;
                    row += if value > 0.0 && value.is_finite() { value } else { 0.0 };
                }
                let at = (j + 1) * (SIDE + 1) + i + 1;
                sums[at] = sums[at - SIDE - 1] + row;
            }
        }
        Some(Self { corner, axes, size, sums })
    }

    /// The rectangle of the unrolled picture that the opening fills from `p`, its least and its greatest corner; `None` from behind.
    fn window(&self, p: DVec3) -> Option<[[f64; 2]; 2]> {
        let [x, y, z] = self.axes;
        let d = self.corner - p;
        let (left, low, far) = (d.dot(x), d.dot(y), d.dot(z));
        if far <= 0.0 {
            return None;
        }
        let place = |along: f64| ops::atan2_d(along, far) * std::f64::consts::FRAC_1_PI + 0.5;
        let least = [place(left), place(low)];
        let most = [place(left + self.size[0]), place(low + self.size[1])];
        (least[0] < most[0] && least[1] < most[1]).then_some([least, most])
    }

    /// The sum of a rectangle, parts of cells by their area.
    fn sum(&self, [[u0, v0], [u1, v1]]: [[f64; 2]; 2]) -> f64 {
        let sum = self.below([u1, v1]) - self.below([u0, v1]) - self.below([u1, v0]) + self.below([u0, v0]);
        if sum > 0.0 { sum } else { 0.0 }
    }

    fn below(&self, uv: [f64; 2]) -> f64 {
        let [(i, s), (j, t)] = uv.map(cell);
        let at = j * (SIDE + 1) + i;
        let row = |at: usize| self.sums[at] * (1.0 - s) + self.sums[at + 1] * s;
        row(at) * (1.0 - t) + row(at + SIDE + 1) * t
    }

    /// A direction of the world through the opening from `p`, by two numbers.
    fn sample(&self, p: DVec3, u: [f32; 2]) -> Option<DVec3> {
        let [least, most] = self.window(p)?;
        let all = self.sum([least, most]);
        if all <= 0.0 {
            return None;
        }
        let column = find(f64::from(u[0]) * all, [least[0], most[0]], |u| self.sum([least, [u, most[1]]]));
        // Within the column of cells that this lies in, which are even.
        let (i, _) = cell(column);
        let strip = |v: f64| [[i as f64 / SIDE as f64, least[1]], [(i + 1) as f64 / SIDE as f64, v]];
        let of_strip = self.sum(strip(most[1]));
        if of_strip <= 0.0 {
            return None;
        }
        let row = find(f64::from(u[1]) * of_strip, [least[1], most[1]], |v| self.sum(strip(v)));
        let (w, _) = unrolled([column, row]);
        let [x, y, z] = self.axes;
        (x * w.x + y * w.y + z * w.z).try_normalize()
    }

    /// The density by solid angle of [`Self::sample`]; `None` where nothing is drawn.
    fn pdf(&self, p: DVec3, wi: DVec3) -> Option<f64> {
        let [least, most] = self.window(p)?;
        let all = self.sum([least, most]);
        if all <= 0.0 {
            return None;
        }
        let [x, y, z] = self.axes;
        let w = DVec3::new(wi.dot(x), wi.dot(y), wi.dot(z));
        if w.z <= 0.0 {
            return Some(0.0);
        }
        let uv = [w.x, w.y].map(|v| ops::atan2_d(v, w.z) * std::f64::consts::FRAC_1_PI + 0.5);
        if (0..2).any(|k| uv[k] < least[k] || uv[k] > most[k]) {
            return Some(0.0);
        }
        let [(i, _), (j, _)] = uv.map(cell);
        let edge = |k: usize| k as f64 / SIDE as f64;
        let of_cell = self.sum([[edge(i), edge(j)], [edge(i + 1), edge(j + 1)]]);
        Some(of_cell * (SIDE * SIDE) as f64 / all * per_angle(w))
    }
}

/// The cell that a place from 0 to 1 lies in, and where.
fn cell(place: f64) -> (usize, f64) {
    let at = place * SIDE as f64;
    let at = if at > 0.0 { at } else { 0.0 };
    let i = (at as usize).min(SIDE - 1);
    let rest = at - i as f64;
    (i, if rest < 1.0 { rest } else { 1.0 })
}

/// Where a sum that grows from 0 over a range reaches a value; it is straight within each cell.
fn find(value: f64, [from, to]: [f64; 2], sum: impl Fn(f64) -> f64) -> f64 {
    // The last edge of cells at which it isn't reached.
    let (mut low, mut high) = (cell(from).0, cell(to).0 + 1);
    let edge = |k: usize| {
        let at = k as f64 / SIDE as f64;
        if at < from {
            from
        } else if at > to {
            to
        } else {
            at
        }
    };
    for _ in 0..=STEPS {
        let middle = usize::midpoint(low, high);
        if middle > low {
            if sum(edge(middle)) <= value { low = middle } else { high = middle }
        }
    }
    let (a, b) = (edge(low), edge(low + 1));
    let (below, above) = (sum(a), sum(b));
    let part = if above > below { (value - below) / (above - below) } else { 0.5 };
    let part = if part > 0.0 { if part < 1.0 { part } else { 1.0 } } else { 0.0 };
    a + (b - a) * part
}

/// The direction in an opening's axes at a place of the unrolled picture, and the density of places by solid angle there.
fn unrolled(uv: [f64; 2]) -> (DVec3, f64) {
    let tangent = |v: f64| {
        let (s, c) = ops::sin_cos_degrees(180.0 * (v - 0.5));
        // At the picture's edge directions lie in the opening's plane.
        s / if c > 1e-9 { c } else { 1e-9 }
    };
    let w = DVec3::new(tangent(uv[0]), tangent(uv[1]), 1.0).normalize();
    (w, per_angle(w))
}

/// d(u v) / dω = (1 / π²) z / ((1 - x²)(1 - y²)) of a unit vector: each angle is atan2 of a side and the depth.
fn per_angle(w: DVec3) -> f64 {
    let around = (w.x * w.x + w.z * w.z) * (w.y * w.y + w.z * w.z);
    w.z / around * (std::f64::consts::FRAC_1_PI * std::f64::consts::FRAC_1_PI)
}

impl Portals {
    /// Surroundings and the openings that a scene says they come in by; the surroundings as they are where there is none.
    pub(crate) fn around(
        surroundings: Emitter,
        said: &[desc::Portal],
        paint: &Paint<'_>,
        centre: DVec3,
    ) -> Emitter {
        let reading =
            Reading { tables: &paint.spectra, lanes: Rgb::default(), textures: &paint.textures, meshes: &[] };
        let radiance = |d: DVec3| f64::from(surroundings.radiance_from(d.as_vec3(), &reading).max_lane());
        let portals: Vec<Portal> =
            said.iter().filter_map(|p| Portal::new(p.corner - centre, p.edges, radiance)).collect();
        if portals.is_empty() {
            return surroundings;
        }
        Emitter::Portals(Box::new(Self { surroundings, portals }))
    }

    /// How many openings a place faces, of which light is drawn.
    fn count(&self, p: DVec3) -> usize {
        self.portals.iter().filter(|portal| portal.window(p).is_some_and(|w| portal.sum(w) > 0.0)).count()
    }

    fn pdf(&self, at: &Receiver, wi: Vec3) -> f32 {
        let p = at.p.as_dvec3();
        let (mut count, mut sum) = (0, 0.0);
        for pdf in self.portals.iter().filter_map(|portal| portal.pdf(p, wi.as_dvec3())) {
            count += 1;
            sum += pdf;
        }
        if count == 0 { self.surroundings.pdf_from(at, wi) } else { (sum / f64::from(count)) as f32 }
    }

    fn sample_one<L: Lanes>(
        &self,
        geometry: &Geometry,
        (at, u): (&Receiver, [f32; 2]),
        reading: &Reading<'_, L>,
    ) -> Option<LightSample> {
        let p = at.p.as_dvec3();
        let count = self.count(p);
        if count == 0 {
            return self.surroundings.sample(geometry, at, u, reading);
        }
        let place = u[0] * count as f32;
        let which = (place as usize).min(count - 1);
        let u = [ops::clamp(place - which as f32, 0.0, 1.0 - f32::EPSILON / 2.0), u[1]];
        let mut open =
            self.portals.iter().filter(|portal| portal.window(p).is_some_and(|w| portal.sum(w) > 0.0));
        let wi = open.nth(which)?.sample(p, u)?.as_vec3().try_normalize()?;
        let (radiance, pdf) = (self.surroundings.radiance_from(wi, reading), self.pdf(at, wi));
        let is_sound = pdf > 0.0 && pdf.is_finite() && !radiance.is_black();
        is_sound.then(|| LightSample::from_afar(wi, radiance, pdf))
    }
}

impl Shine for Box<Portals> {
    const EXTENT: Extent = Extent::Around;

    #[inline(always)]
    fn sample_many<F: Float, L: Lanes>(
        &self,
        geometry: &Geometry,
        (at, u): (&Receiver<F>, [F; 2]),
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        LightSample::one_by_one(
            #[inline(always)]
            |i| {
                let at = Receiver { p: at.p.lane(i), n: at.n.lane(i) };
                self.sample_one(geometry, (&at, [u[0].lane(i), u[1].lane(i)]), &readings.of(i))
            },
        )
    }

    #[inline(always)]
    fn radiance_pdf_from_many<F: Float, L: Lanes>(
        &self,
        at: &Receiver<F>,
        wi: Vec3<F>,
        readings: &Readings<'_, L>,
    ) -> (Light<F>, F) {
        let pdf = F::from_fn(
            #[inline(always)]
            |i| self.pdf(&Receiver { p: at.p.lane(i), n: at.n.lane(i) }, wi.lane(i)),
        );
        (self.radiance_from_many(wi, readings), pdf)
    }

    #[inline(always)]
    fn radiance_from_many<F: Float, L: Lanes>(&self, wi: Vec3<F>, readings: &Readings<'_, L>) -> Light<F> {
        Light::from_fn(
            #[inline(always)]
            |i| self.surroundings.radiance_from(wi.lane(i), &readings.of(i)),
        )
    }

    #[inline]
    fn pdf_from(&self, at: &Receiver, wi: Vec3) -> f32 {
        self.pdf(at, wi)
    }

    /// As the surroundings do: what doesn't come in ends at a wall.
    fn emit<L: Lanes>(
        &self,
        geometry: &Geometry,
        ball: &Ball,
        u: [f32; 4],
        reading: &Reading<'_, L>,
    ) -> Option<Emitted> {
        self.surroundings.emit(geometry, ball, u, reading)
    }

    /// Of what is around, as if it came in everywhere.
    fn power(&self, geometry: &Geometry, disc: f64) -> f64 {
        self.surroundings.power_over(geometry, disc)
    }

    fn reach(&self, geometry: &Geometry) -> Option<Reach> {
        self.surroundings.reach(geometry)
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        use super::tests::{Example, RADIANCE};
        use super::{ConstantEnvironment, ImageEnvironment};
        use straal_math::Affine;
        let picture = super::tests::image(16, 9, |x, y| [0.2 + (x % 5) as f32, (y * x % 7) as f32, 0.1]);
        let image = ImageEnvironment::new(&picture, 1.0, &Affine::IDENTITY).expect("a picture");
        let even = Emitter::Constant(ConstantEnvironment { radiance: RADIANCE.into() });
        let reading = crate::testing::in_rgb();
        // The places of the tests lie before the first, and before or behind the second.
        let corners = [DVec3::new(-3.0, -3.0, -12.0), DVec3::new(-1.0, 5.0, 1.0)];
        let edges = [
            [DVec3::new(6.0, 0.0, 1.0), DVec3::new(0.0, 5.0, 0.0)],
            [DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 0.3, 1.5)],
        ];
        let of = |name, around: Emitter, count: usize| {
            let radiance = |d: DVec3| f64::from(around.radiance_from(d.as_vec3(), &reading).max_lane());
            let portals = (0..count).filter_map(|i| Portal::new(corners[i], edges[i], radiance)).collect();
            Example::alone(name, Emitter::Portals(Box::new(Portals { surroundings: around, portals })))
        };
        vec![of("portal, even", even, 1), of("portals, image", Emitter::Image(Box::new(image)), 2)]
    }
}
