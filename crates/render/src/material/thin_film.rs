//! # Thin film
//!
//! A layer of some hundred nanometres, whose colours are those of waves that meet: a soap bubble, which hangs in the air, or the oxide or oil on a polished metal, which
//! takes the light that passes. With r the amplitude that the upper face reflects and s exp(i p) that of the lower one, all that bounces between them adds up, for each
//! polarisation, to
//!
//! R = 1 - (1 - r²) (1 - s²) / (1 + q² + 2 q cos(d + p)), where q = r s and d = 4 pi eta t cos / wavelength
//!
//! (Airy's sum; t is the thickness, cos that of the ray within). Of a film in the air 1 - R passes straight on. By wavelengths that is it. Red, green and blue are bands, over which
//! waves of a thick film cancel out: there the fraction is written as its series 1 + 2 sum (-q)^m cos m(d + p), each term averaged over what the band sees of daylight (Belcour and Barla 2017, "A
//! Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence", eq. 8, with tables in place of Gaussians). Colours that the work space doesn't hold are cut off at
//! 0 and 1. Energy is conserved; reciprocity holds.

use std::sync::Arc;

use straal_color::spectrum::{COUNT, FIRST, Observer, illuminant, uplift};
use straal_color::{Light, Space};
use straal_math::{Vec3, ops};
use straal_scene::desc;

use super::film::{Complex, Faces, Film};
use super::relative::RANGE;
use super::{Bsdf, BsdfSample, Recipe, Scatter, Transport, Wants, mirror::reflected};
use crate::lanes::{Carried, Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// A film, and what it lies on.
#[derive(Clone, Debug, PartialEq)]
pub struct ThinFilmMaterial {
    /// In nm.
    pub thickness: Value<f32>,
    /// Index of refraction.
    pub eta: Value<f32>,
    /// Index of refraction of what is around it.
    pub eta_outside: Value<f32>,
    /// Index of refraction of what is below it, and its imaginary part; `None` of a film that hangs in the air.
    pub base: Option<[Value<Colour>; 2]>,
    /// What red, green and blue see of waves, where lanes are these.
    pub bands: Option<Arc<Bands>>,
}

impl Recipe for ThinFilmMaterial {
    type Described = desc::ThinFilm;

    fn is_clear(&self) -> bool {
        self.base.is_none()
    }

    fn of(d: &desc::ThinFilm, paint: &mut Paint<'_>) -> Self {
        let metal = || desc::Conductor {
            metal: d.metal.clone(),
            eta: d.base_eta.clone(),
            k: d.base_k.clone(),
            ..desc::Conductor::default()
        };
        let lies = d.metal.is_some() || d.base_eta.is_some();
        Self {
            thickness: paint.number(&d.thickness),
            eta: paint.number_within(&d.eta, RANGE),
            eta_outside: paint.number_within(&d.eta_outside, RANGE),
            base: lies.then(|| paint.metal(&metal())),
            bands: paint.bands(),
        }
    }

    fn wants(&self) -> Wants {
        let numbers = [&self.thickness, &self.eta, &self.eta_outside];
        let below = self.base.iter().flatten().any(|v| v.varies());
        Wants::point(below || numbers.iter().any(|v| v.varies()))
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let (nm, bands) = match (reading.lanes.carried(), &self.bands) {
            (Carried::All, bands) => (MIDDLES, bands.as_deref()),
            (Carried::One(nm), _) => (reading.lanes.full() * nm, None),
            (Carried::Four(nm), _) => (Light(nm), None),
        };
        let base = self.base.as_ref().map(|base| [&base[0], &base[1]].map(|v| reading.eval(v, at)));
        let eta_outside = reading.eval(&self.eta_outside, at);
        Bsdf::ThinFilm(ThinFilm {
            thickness: reading.eval(&self.thickness, at),
            eta: reading.eval(&self.eta, at),
            eta_outside,
            lies: base.is_some(),
            base: base.unwrap_or([Light::splat(eta_outside), Light::ZERO]),
            nm,
            bands,
        })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let super::Metal { eta, k, .. } = super::testing::gold();
        let of = |base| Self {
            thickness: 400.0.into(),
            eta: 1.33.into(),
            eta_outside: 1.0.into(),
            base,
            bands: None,
        };
        [of(None), of(Some([eta.into(), k.into()]))].map(|m| (m, super::BsdfKind::ThinFilm)).into()
    }
}

/// Wavelengths in nm that stand for red, green and blue where there are no [`Bands`]; the fourth lane carries nothing.
const MIDDLES: Light = Light([610.0, 545.0, 455.0, 0.0]);

/// A film at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinFilm<'w> {
    /// In nm.
    pub thickness: f32,
    /// Index of refraction.
    pub eta: f32,
    /// Index of refraction of what is around it.
    pub eta_outside: f32,
    /// Whether it lies on something; else it hangs in the air.
    pub lies: bool,
    /// Index of refraction of what is below it, and its imaginary part.
    pub base: [Light; 2],
    /// Which waves lanes are, in nm, where they aren't bands; 0 where a lane carries nothing.
    pub nm: Light,
    /// What red, green and blue see of waves.
    pub bands: Option<&'w Bands>,
}

impl ThinFilm<'_> {
    /// 1 in the lanes that carry light.
    fn alive(&self) -> Light {
        self.nm.map(|nm| if nm > 0.0 { 1.0 } else { 0.0 })
    }

    /// Share of light that is reflected at an angle.
    fn reflects(&self, cos: f32) -> Light {
        let film = Film { presence: 1.0, thickness: self.thickness, ior: self.eta, above: self.eta_outside };
        let [n, k] = self.base;
        let share = match self.bands {
            Some(bands) => bands.reflect(&film, cos, [n, k]),
            None => film.reflects(cos, n, k, self.nm),
        };
        let share = share * self.alive();
        share.map(|r| if r > 0.0 { if r < 1.0 { r } else { 1.0 } } else { 0.0 })
    }
}

impl Scatter for ThinFilm<'_> {
    const CHOOSES_LOBE: bool = true;

    fn albedo(&self) -> Light {
        if self.lies { self.reflects(1.0) } else { self.alive() }
    }

    #[inline]
    fn sample(&self, wo: Vec3, u_lobe: f32, _: [f32; 2], _: Transport) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let share = self.reflects(wo.z.abs());
        if self.lies {
            return Some(reflected(wo, share, 1.0));
        }
        let Light([r, g, b, _]) = share;
        let chance = (r + g + b) * (1.0 / 3.0);
        if u_lobe < chance {
            return Some(reflected(wo, share * (1.0 / chance), chance));
        }
        let passes = 1.0 - chance;
        let weight = (self.alive() - share) * (1.0 / passes);
        let through =
            BsdfSample { delta: true, transmitted: true, ..BsdfSample::reflected(-wo, weight, passes) };
        (passes > 0.0).then_some(through)
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, gold};
        let air = [Light::ONE, Light::ZERO];
        let soap = |thickness| ThinFilm::<'static> {
            thickness,
            eta: 1.33,
            eta_outside: 1.0,
            lies: false,
            base: air,
            nm: MIDDLES,
            bands: None,
        };
        let oil = ThinFilm { lies: true, base: [gold().eta, gold().k], ..soap(300.0) };
        vec![
            Example::new("soap", Bsdf::ThinFilm(soap(400.0))).nearly_energy(1e-4),
            Example::new("soap, nearly black", Bsdf::ThinFilm(soap(5.0))).nearly_energy(1e-4),
            Example::new("oil on gold", Bsdf::ThinFilm(oil)),
        ]
    }
}

/// By how much the optical path of two neighbours in a table of [`Bands`] differs, in nm.
const STEP: f32 = 4.0;

/// How many there are: beyond, waves of a band cancel out.
const STEPS: usize = 4096;

/// Cosine and sine of waves by how much longer the way of one than that of another is, averaged over what red, green and blue see of daylight.
#[derive(Clone, Debug, PartialEq)]
pub struct Bands(Vec<[[f32; 2]; 3]>);

impl Bands {
    /// In the colours of a work space.
    pub fn new(space: Space) -> Self {
        let (to_rgb, daylight) = (uplift::rgb_from_xyz(space), illuminant::d65());
        let functions = Observer::Cie1931.functions();
        let mut weights: [[f64; 3]; COUNT] =
            std::array::from_fn(|i| to_rgb.apply(functions[i]).map(|v| v * daylight[i]));
        for c in 0..3 {
            let all: f64 = weights.iter().map(|w| w[c]).sum();
            weights.iter_mut().for_each(|w| w[c] /= all);
        }
        // A wave of each nanometre, turned on step by step.
        let turns: [(f64, f64); COUNT] = std::array::from_fn(|i| {
            ops::sin_cos_d(std::f64::consts::TAU * f64::from(STEP) / (FIRST + i) as f64)
        });
        let mut waves = [(0.0, 1.0); COUNT];
        let table = (0..STEPS).map(|_| {
            let mut sums = [[0.0; 2]; 3];
            for ((wave, turn), weights) in waves.iter_mut().zip(&turns).zip(&weights) {
                let (sin, cos) = *wave;
                for (sum, weight) in sums.iter_mut().zip(weights) {
                    sum[0] += weight * cos;
                    sum[1] += weight * sin;
                }
                *wave = (sin * turn.1 + cos * turn.0, cos * turn.1 - sin * turn.0);
            }
            sums.map(|sum| sum.map(|v| v as f32))
        });
        Self(table.collect())
    }

    /// Cosine and sine of a path in nm, for each band.
    #[inline]
    fn wave(&self, path: f32) -> [[f32; 2]; 3] {
        let at = path * (1.0 / STEP);
        let i = at as usize;
        let (Some(a), Some(b)) = (self.0.get(i), self.0.get(i + 1)) else { return [[0.0; 2]; 3] };
        let t = at - i as f32;
        std::array::from_fn(|c| [0, 1].map(|part| a[c][part] + (b[c][part] - a[c][part]) * t))
    }

    /// Share of light that comes back from a film on what has this index.
    fn reflect(&self, film: &Film<f32>, cos: f32, [n, k]: [Light; 2]) -> Light {
        let Faces { upper, within } = film.faces(cos);
        if within[1] >= 1.0 {
            return Light::ONE;
        }
        let path = 2.0 * film.ior * film.thickness * within[0];
        let waves: [_; TERMS] = std::array::from_fn(|m| self.wave((m + 1) as f32 * path));
        let mut out = Light::ZERO;
        for (c, out) in out.0[..3].iter_mut().enumerate() {
            let lower = film.below(within, Complex(n.0[c], k.0[c]));
            for (r, s) in upper.into_iter().zip(lower) {
                *out += 0.5 * averaged(r, s, |m| waves[m][c]);
            }
        }
        out
    }
}

/// Terms of the series: at an angle at which the last of them counts, nearly all light comes back anyway.
const TERMS: usize = 12;

/// Airy's sum for amplitudes of both faces, averaged over waves whose cosine and sine are told for each multiple of their path.
fn averaged(r: f32, s: Complex<f32>, waves: impl Fn(usize) -> [f32; 2]) -> f32 {
    let (s2, r2) = (s.square(), r * r);
    let q2 = r2 * s2;
    let rest = 1.0 - q2;
    if rest < 1e-6 {
        return 1.0;
    }
    // -q exp(i p), and its powers.
    let turn = s.scaled(-r);
    let (mut power, mut sum) = (turn, 0.5);
    for m in 0..TERMS {
        let [cos, sin] = waves(m);
        sum += power.0 * cos - power.1 * sin;
        power = power.times(turn);
    }
    1.0 - (1.0 - r2) * (1.0 - s2) * 2.0 * sum / rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the reflectance of each nanometre, seen as a surface is seen.
    #[test]
    fn bands_are_the_colours_of_spectra() {
        let bands = Bands::new(Space::Srgb);
        let (to_rgb, daylight) = (uplift::rgb_from_xyz(Space::Srgb), illuminant::d65());
        let bases = [[1.0, 0.0], [0.3, 3.0], [2.9, 3.1], [1.33, 0.0]];
        for thickness in [0.0, 30.0, 120.0, 400.0, 900.0, 2500.0, 8000.0] {
            for cos in [1.0, 0.7, 0.3, 0.1] {
                for [n, k] in bases {
                    let film = Film { presence: 1.0, thickness, ior: 1.4, above: 1.0 };
                    let [n, k] = [n, k].map(Light::splat);
                    let spectrum = std::array::from_fn(|i| {
                        f64::from(film.reflects(cos, n, k, Light::splat((FIRST + i) as f32)).0[0])
                    });
                    let right = to_rgb.apply(Observer::Cie1931.surface(&spectrum, &daylight));
                    let got = bands.reflect(&film, cos, [n, k]);
                    for (got, right) in got.0.into_iter().zip(right) {
                        let off = (f64::from(got) - right).abs();
                        assert!(off < 4e-3, "{thickness} nm, cos {cos}, {n:?}: {got} for {right}");
                    }
                }
            }
        }
    }

    /// A film of no thickness on a metal is the metal; one of a quarter of a wave between whose faces amplitudes are alike sends nothing back.
    #[test]
    fn nothing_and_a_quarter_of_a_wave() {
        let metal = super::super::testing::gold();
        let of = |thickness, eta, base, nm: f32| ThinFilm {
            thickness,
            eta,
            eta_outside: 1.0,
            lies: true,
            base,
            nm: Light([nm; 4]),
            bands: None,
        };
        for cos in [1.0, 0.5, 0.1] {
            let bare = super::super::fresnel::conductor(cos, metal.eta, metal.k);
            let filmed = of(0.0, 1.5, [metal.eta, metal.k], 550.0).reflects(cos);
            for c in 0..3 {
                assert!((bare.0[c] - filmed.0[c]).abs() < 1e-5, "{bare:?} {filmed:?}");
            }
        }
        let glass = [Light::splat(1.5), Light::ZERO];
        let coated = of(550.0 / 4.0 / 1.5f32.sqrt(), 1.5f32.sqrt(), glass, 550.0);
        assert!(coated.reflects(1.0).0[0] < 1e-6);
    }
}
