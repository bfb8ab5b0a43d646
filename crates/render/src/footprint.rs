//! Footprints: how much of a surface a ray stands for.
//!
//! A picture's pixel is no point, and a texture that is read as if it were one flickers. So a ray carries how its origin and its
//! direction change from pixel to pixel, to the right and downwards: *ray differentials* (Igehy 1999, "Tracing Ray
//! Differentials"). Where the ray meets a surface they become two vectors on it, which span what the pixel sees of it.
//!
//! Why these: a ray cone (Akenine-Möller et al. 2021) is a width and an angle, cheaper still, but as long as wide. Seen at a
//! slant, by way of a round mirror or through glass, what a pixel sees is long and thin, and the length may be ten times the
//! width: a cone is blurred or flickers, a filter that knows both directions (EWA) does neither. Differentials are exact for any
//! number of mirrors and panes, curved ones too, for they know how the normal turns.
//!
//! What they cost: [`PackedFootprint`] is 24 bytes of a path's state, twelve numbers of eight bits' precision, which is a
//! tenth of what any filter can show. The arithmetic is done where a material reads a texture, and where a path goes on in a
//! world of which one does ([`crate::material::Materials::vary`]): all others carry zeros from the camera on.
//!
//! A pixel has many samples, each of which stands for a part of it ([`Footprint::of_sample`]).
//!
//! A *rough* bounce ends what differentials know: neighbouring pixels' paths go where chance sends them. A direction that was
//! drawn with density pdf stands for a solid angle of 1 / pdf; of its square root a part is taken (`ROUGH`) and added, in
//! squares, to what a mirror in the same facet would do. So the footprint of a lobe that is almost a mirror's is almost the
//! mirror's, and after a diffuse bounce it is wide and round.

use crate::material::BsdfSample;
use crate::shape::Tangents;
use straal_math::{Frame, Ray, Vec3, ops};

/// How much of the width of a direction's solid angle its footprint grows by at a rough surface. All of it would take the
/// detail from whatever is seen by way of a rough surface that has many samples; less keeps it and costs a little noise.
const ROUGH: f32 = 0.25;

/// How a ray changes from one pixel to the next: to the right, and downwards. Its direction stays of length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Change of the origin.
    pub o: [Vec3; 2],
    /// Change of the direction.
    pub d: [Vec3; 2],
}

/// A surface on which a ray goes on.
#[derive(Clone, Copy, Debug)]
pub struct Bend<'a> {
    /// How the point moves on it from pixel to pixel, see [`Footprint::on_surface`].
    pub dp: [Vec3; 2],
    /// The unit shading normal.
    pub n: Vec3,
    /// How that turns.
    pub tangents: &'a Tangents,
}

impl Footprint {
    /// That of a ray that is infinitely thin.
    pub const NONE: Self = Self { o: [Vec3::ZERO; 2], d: [Vec3::ZERO; 2] };

    /// How a point moves where the ray meets a surface of normal `ng` at `t`. (Igehy 1999, eq. 10-12.)
    pub fn on_surface(&self, ray: &Ray, t: f32, ng: Vec3) -> [Vec3; 2] {
        [0, 1].map(|k| {
            let across = self.o[k] + self.d[k] * t;
            let on = across - ray.d * (across.dot(ng) / ray.d.dot(ng));
            if on.is_finite() { on } else { Vec3::ZERO }
        })
    }

    /// Of the ray that goes on where one along `d` has met a surface, by a sample of its BSDF whose `wi` is in the world.
    ///
    /// The facet that would reflect or refract `d` to `wi` turns as the shading normal does. With N its normal, e the index of
    /// the side that the ray goes to over that of the side it comes from (1 for a reflection) and D' = D / e - mu N, both cases
    /// are one (Igehy 1999, eq. 13-18).
    pub fn scattered(&self, d: Vec3, bend: &Bend<'_>, sample: &BsdfSample) -> Self {
        let to = sample.wi;
        let inverse = if sample.transmitted { 1.0 / sample.eta } else { 1.0 };
        let bent = d * inverse - to;
        let mut ways = match bent.try_normalize() {
            // Straight through.
            None => self.d,
            Some(facet) => {
                let side = if facet.dot(bend.n) < 0.0 { -1.0 } else { 1.0 };
                let (before, after, mu) = (d.dot(facet), to.dot(facet), bent.length());
                let rate = inverse - inverse * inverse * (before / after);
                [0, 1].map(|k| {
                    let dn = bend.tangents.turn(bend.tangents.coordinates(bend.dp[k])) * side;
                    let dmu = rate * (self.d[k].dot(facet) + d.dot(dn));
                    self.d[k] * inverse - dn * mu - facet * dmu
                })
            }
        };
        if !sample.delta {
            ways = widened(ways, to, ROUGH / sample.pdf.sqrt());
        }
        let next = Self { o: bend.dp, d: ways };
        if next.is_finite() { next } else { Self::NONE }
    }

    /// That of a pixel's sample, by its number from 0: the first stands for the whole pixel, and of n each for one part of n, of which no more
    /// is filtered than lies between it and its neighbours. Were all as wide as the pixel, a texture would be filtered twice: by the samples'
    /// places in the pixel, and by what each of them sees. Widths by number, not by how many there will be, leave a sample the same whatever is
    /// added to it.
    #[inline]
    pub fn of_sample(&self, number: u64) -> Self {
        let share = ops::max(1.0 / ((number + 1) as f32).sqrt(), NARROWEST);
        Self { o: self.o.map(|v| v * share), d: self.d.map(|v| v * share) }
    }

    fn is_finite(&self) -> bool {
        self.o.iter().chain(&self.d).all(|v| v.is_finite())
    }

    /// In few bytes; [`Footprint::NONE`] where it is beyond numbers.
    pub fn packed(&self) -> PackedFootprint {
        let all = self.o.into_iter().chain(self.d).flat_map(Vec3::to_array);
        let mut packed = [0; 12];
        for (short, v) in packed.iter_mut().zip(all) {
            if v.abs() > MOST || v.is_nan() {
                return PackedFootprint::NONE;
            }
            // Rounded to the upper half of a single-precision number.
            *short = ((v.to_bits() + 0x8000) >> 16) as u16;
        }
        PackedFootprint(packed)
    }
}

/// The least part of a pixel's width that a sample stands for: what it blurs is a hundredth of what the pixel does, and textures need no finer copies
/// the more samples there are.
const NARROWEST: f32 = 0.125;

/// What is larger has no footprint: far beyond any scene, and far from where numbers end.
const MOST: f32 = 1e30;

/// Directions around `to` that change by at least `width`: a rough lobe's squares added to those of a mirror.
fn widened(ways: [Vec3; 2], to: Vec3, width: f32) -> [Vec3; 2] {
    let longest = if ways[0].length_squared() > ways[1].length_squared() { ways[0] } else { ways[1] };
    if longest.length_squared() <= width * width {
        // What was known of directions drowns.
        let frame = Frame::from_normal(to);
        return [frame.s * width, frame.t * width];
    }
    ways.map(|way| {
        let square = way.length_squared();
        if square > 0.0 { way * (1.0 + width * width / square).sqrt() } else { way }
    })
}

/// A [`Footprint`] in 24 bytes, each number with eight bits of precision: what a path carries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PackedFootprint([u16; 12]);

impl PackedFootprint {
    /// [`Footprint::NONE`].
    pub const NONE: Self = Self([0; 12]);

    /// What was packed, but for rounding.
    pub fn unpacked(&self) -> Footprint {
        let v = self.0.map(|short| f32::from_bits(u32::from(short) << 16));
        let vec = |i: usize| Vec3::new(v[i], v[i + 1], v[i + 2]);
        Footprint { o: [vec(0), vec(3)], d: [vec(6), vec(9)] }
    }
}

#[cfg(test)]
mod tests;
