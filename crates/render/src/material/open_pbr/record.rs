//! What a material of OpenPBR has at a point, packed: some forty numbers, of which every vertex of a path carries a copy.

use straal_color::Light;
use straal_math::Vec3;
use straal_math::simd::{Float, Mask, Uint};

use super::params::Params;

/// How many numbers of 16 bits there are.
const COUNT: usize = 47;

/// Numbers of 16 bits. Steps are such that numbers of two or three decimals, as people write them, are exact.
///
/// | numbers | what | step | most |
/// |---|---|---|---|
/// | 0..24 | six tints, four lanes each | the square of 1/32768 | 4 |
/// | 24..28 | wavelengths of the lanes, less 300 nm | 1/100 nm | 955 nm |
/// | 28..32 | metalness, specular weight, transmission, subsurface | 1/65000 | 1 |
/// | 32..36 | coat and fuzz weight, film presence, diffuse roughness | 1/65000 | 1 |
/// | 36..39 | roughness, of the coat, of the fuzz | 1/65000 | 1 |
/// | 39..42 | index of refraction, of the coat, of the film | 1/12800 | 5.1 |
/// | 42 | thickness of the film | 1/10 nm | 6553 nm |
/// | 43 | dispersion | 1/20000 | 3.2 |
/// | 44, 45 | anisotropy, of the coat; coat darkening, subsurface anisotropy: 8 bits each | 1/200; the last 1/100 | 1 |
/// | 46 | flags | | |
///
/// Beside these stand two directions, which few materials have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Record {
    numbers: [u16; COUNT],
    /// Two unit vectors' x and y in steps of 1/32000 about 32768: where it is brushed, and the coat's normal. Read where a flag says so.
    vectors: [u16; 4],
}

const UNIT: f32 = 65000.0;
const INDEX: f32 = 12800.0;
const THICKNESS: f32 = 10.0;
const DISPERSION: f32 = 20000.0;
const TINT: f32 = 32768.0;
const NANOMETRE: f32 = 100.0;
const FIRST_NANOMETRE: f32 = 300.0;

/// A wall without thickness.
const THIN: u16 = 1;
/// The back is black.
const ONE_SIDED: u16 = 2;
/// Lanes are red, green and blue, and a dead one.
const RGB: u16 = 4;
/// A refraction has parted lanes.
const PARTED: u16 = 8;
/// Coat and fuzz take away what they reflect on both sides.
const RECIPROCAL: u16 = 16;

/// Brushed in another direction than along the tangent.
const TURNED: u16 = 32;
/// The coat has a normal of its own.
const LEANS: u16 = 64;

/// Steps of a direction's coordinates, and the middle of them.
const DIRECTION: f32 = 32000.0;
const MIDDLE: f32 = 32768.0;

/// To the nearest step; what is beyond ends at the last.
fn steps(v: f32, per_one: f32) -> u16 {
    // `as` takes NaN as 0 and holds what is beyond.
    (v * per_one + 0.5) as u16
}

fn bytes(low: f32, high: f32) -> u16 {
    u16::from((low * 200.0 + 0.5) as u8) | u16::from((high + 0.5) as u8) << 8
}

impl Record {
    pub fn pack(p: &Params<f32>) -> Self {
        let mut out = [0; COUNT];
        let tints = [p.base, p.specular, p.transmission, p.subsurface, p.coat, p.fuzz];
        for (to, v) in out.iter_mut().zip(tints.iter().flat_map(|t| t.0)) {
            *to = steps(if v > 0.0 { v.sqrt() } else { 0.0 }, TINT);
        }
        for (to, nm) in out[24..].iter_mut().zip(p.nm.0) {
            *to = steps(nm - FIRST_NANOMETRE, NANOMETRE);
        }
        let units = [
            p.metalness,
            p.specular_weight,
            p.transmission_weight,
            p.subsurface_weight,
            p.coat_weight,
            p.fuzz_weight,
            p.film_presence,
            p.diffuse_roughness,
            p.roughness,
            p.coat_roughness,
            p.fuzz_roughness,
        ];
        for (to, v) in out[28..].iter_mut().zip(units) {
            *to = steps(if v < 1.0 { v } else { 1.0 }, UNIT);
        }
        for (to, v) in out[39..].iter_mut().zip([p.ior, p.coat_ior, p.film_ior]) {
            *to = steps(v, INDEX);
        }
        out[42] = steps(p.film_thickness, THICKNESS);
        out[43] = steps(p.dispersion, DISPERSION);
        out[44] = bytes(p.anisotropy, p.coat_anisotropy * 200.0);
        out[45] = bytes(p.coat_darkening, (p.subsurface_anisotropy + 1.0) * 100.0);
        let flags = [
            (p.thin, THIN),
            (p.one_sided, ONE_SIDED),
            (p.rgb, RGB),
            (p.parted, PARTED),
            (p.reciprocal, RECIPROCAL),
            (p.turned, TURNED),
            (p.leans, LEANS),
        ];
        out[46] = flags.iter().filter(|(yes, _)| *yes).map(|(_, flag)| flag).sum();
        let step = |v: f32| (v * DIRECTION + MIDDLE + 0.5) as u16;
        let vectors = [p.along[0], p.along[1], p.coat_normal.x, p.coat_normal.y].map(step);
        Self { numbers: out, vectors }
    }

    /// Four pairs of numbers.
    #[inline(always)]
    fn row(&self, first: usize) -> [f32; 4] {
        [self.pair(first), self.pair(first + 2), self.pair(first + 4), self.pair(first + 6)]
    }

    #[inline(always)]
    fn pair(&self, i: usize) -> f32 {
        let high = if i + 1 < COUNT { self.numbers[i + 1] } else { 0 };
        f32::from_bits(u32::from(self.numbers[i]) | u32::from(high) << 16)
    }

    /// As many records as there are lanes, side by side.
    #[inline(always)]
    pub fn unpack<'a, F: Float>(record: impl Fn(usize) -> &'a Self) -> Params<F> {
        let mut n = Numbers { pairs: [F::Uint::splat(0); COUNT.div_ceil(2)] };
        // From records to columns by exchanges between registers.
        for group in 0..6 {
            let [a, b, c, d] = F::from_rows(
                #[inline(always)]
                |i| record(i).row(8 * group),
            );
            n.pairs[4 * group] = a.to_bits();
            n.pairs[4 * group + 1] = b.to_bits();
            n.pairs[4 * group + 2] = c.to_bits();
            n.pairs[4 * group + 3] = d.to_bits();
        }
        let (turned, leans): (F::Mask, F::Mask) = (n.flag(TURNED), n.flag(LEANS));
        let (mut along, mut coat_normal) = ([F::ONE, F::ZERO], Vec3::new(F::ZERO, F::ZERO, F::ONE));
        if (turned | leans).any() {
            let [c, s, x, y] = F::from_rows(
                #[inline(always)]
                |i| record(i).vectors.map(|v| (f32::from(v) - MIDDLE) / DIRECTION),
            );
            let by = F::ONE / (c * c + s * s).sqrt();
            along = [F::select(turned, c * by, F::ONE), F::select(turned, s * by, F::ZERO)];
            let z = (F::ONE - x * x - y * y).max(F::ZERO).sqrt();
            let zero = F::ZERO;
            coat_normal =
                Vec3::new(F::select(leans, x, zero), F::select(leans, y, zero), F::select(leans, z, F::ONE));
        }
        Params {
            along,
            coat_normal,
            turned,
            leans,
            base: n.tint(0),
            specular: n.tint(1),
            transmission: n.tint(2),
            subsurface: n.tint(3),
            coat: n.tint(4),
            fuzz: n.tint(5),
            nm: Light([n.nm(0), n.nm(1), n.nm(2), n.nm(3)]),
            metalness: n.unit(28),
            specular_weight: n.unit(29),
            transmission_weight: n.unit(30),
            subsurface_weight: n.unit(31),
            coat_weight: n.unit(32),
            fuzz_weight: n.unit(33),
            film_presence: n.unit(34),
            diffuse_roughness: n.unit(35),
            roughness: n.unit(36),
            coat_roughness: n.unit(37),
            fuzz_roughness: n.unit(38),
            ior: n.number(39) / F::splat(INDEX),
            coat_ior: n.number(40) / F::splat(INDEX),
            film_ior: n.number(41) / F::splat(INDEX),
            film_thickness: n.number(42) / F::splat(THICKNESS),
            dispersion: n.number(43) / F::splat(DISPERSION),
            anisotropy: n.byte(44, 0) / F::splat(200.0),
            coat_anisotropy: n.byte(44, 8) / F::splat(200.0),
            coat_darkening: n.byte(45, 0) / F::splat(200.0),
            subsurface_anisotropy: (n.byte(45, 8) - F::splat(100.0)) / F::splat(100.0),
            thin: n.flag(THIN),
            one_sided: n.flag(ONE_SIDED),
            rgb: n.flag(RGB),
            parted: n.flag(PARTED),
            reciprocal: n.flag(RECIPROCAL),
        }
    }

    /// Whether light may come through from the other side.
    #[inline]
    pub fn transmits(&self) -> bool {
        // The weight of what is clear, and a thin wall.
        self.numbers[30] > 0 || self.numbers[46] & THIN != 0
    }

    /// One, as plain numbers.
    pub fn one(&self) -> Params<f32> {
        Self::unpack(|_| self)
    }
}

/// The numbers of records side by side, two in each column.
struct Numbers<F: Float> {
    pairs: [F::Uint; COUNT.div_ceil(2)],
}

impl<F: Float> Numbers<F> {
    #[inline(always)]
    fn bits(&self, i: usize) -> F::Uint {
        let pair = self.pairs[i / 2];
        if i.is_multiple_of(2) { pair & 0xffff } else { pair >> 16 }
    }

    #[inline(always)]
    fn number(&self, i: usize) -> F {
        F::from_uint(self.bits(i))
    }

    #[inline(always)]
    fn unit(&self, i: usize) -> F {
        self.number(i) / F::splat(UNIT)
    }

    #[inline(always)]
    fn root(&self, i: usize) -> F {
        let v = self.number(i) * (1.0 / TINT);
        v * v
    }

    #[inline(always)]
    fn tint(&self, i: usize) -> Light<F> {
        Light([self.root(4 * i), self.root(4 * i + 1), self.root(4 * i + 2), self.root(4 * i + 3)])
    }

    #[inline(always)]
    fn nm(&self, lane: usize) -> F {
        self.number(24 + lane) / F::splat(NANOMETRE) + F::splat(FIRST_NANOMETRE)
    }

    #[inline(always)]
    fn byte(&self, i: usize, shift: u32) -> F {
        F::from_uint((self.bits(i) >> shift) & 0xff)
    }

    #[inline(always)]
    fn flag(&self, which: u16) -> F::Mask {
        !(self.bits(46) & u32::from(which)).eq(F::Uint::splat(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_two_decimals_are_kept() {
        let p = Params::<f32> {
            roughness: 0.3,
            ior: 1.55,
            film_thickness: 520.0,
            anisotropy: 0.85,
            coat_darkening: 0.7,
            subsurface_anisotropy: -0.35,
            base: Light([1.0, 0.25, 0.0, 0.0]),
            nm: Light([620.0, 540.5, 450.0, 540.0]),
            thin: true,
            rgb: true,
            ..Params::BLANK
        };
        let back = Record::pack(&p).one();
        let near = |a: f32, b: f32| (a - b).abs() < 1e-6 * b.abs();
        for (got, want) in [
            (back.roughness, 0.3),
            (back.ior, 1.55),
            (back.film_thickness, 520.0),
            (back.anisotropy, 0.85),
            (back.coat_darkening, 0.7),
            (back.subsurface_anisotropy, -0.35),
        ] {
            assert!(near(got, want), "{got}, not {want}");
        }
        assert_eq!(back.base, p.base);
        assert!((0..4).all(|i| near(back.nm.0[i], p.nm.0[i])));
        assert!(back.thin && back.rgb && !back.parted && !back.one_sided);
        // What is beyond ends at the last step, and NaN is nothing.
        let beyond = Params::<f32> { roughness: 7.0, metalness: f32::NAN, ..p };
        let back = Record::pack(&beyond).one();
        assert!(back.roughness == 1.0 && back.metalness <= 1.0);
    }
}
