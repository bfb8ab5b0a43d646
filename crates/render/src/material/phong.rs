//! # Phong
//!
//! The textbook's shading: light that is scattered evenly and a highlight that is painted on. The highlight is a power of a cosine, x^e: with Phong
//! (1975) x is the cosine between where light goes and the mirrored direction of where it comes from, with Blinn (1977) the cosine between the
//! normal and the direction half-way between the two. Three forms of it are in use, with k_s the strength:
//!
//! | form | f | energy is conserved | reciprocity holds |
//! |---|---|---|---|
//! | `normalised` | k_s N x^e | yes, where k_d + k_s is at most 1 | yes |
//! | `textbook` (Suffern 2007, chapter 15) | k_s x^e | no: e = 1 sends back twice the light for k_s = 1 | yes |
//! | `classic` (Phong 1975) | k_s x^e / cos of `wi` | no: without bound at grazing angles | no |
//!
//! N is (e + 2) / 2 pi for Phong's (Lafortune and Willems 1994, "Using the Modified Phong Reflectance Model for Physically Based Rendering") and
//! (e + 2)(e + 4) / (8 pi (2^(-e/2) + e)) for Blinn's: so that of light along the normal the share k_s is sent back, and less of other
//! light. The ambient term k_a is the share of [`crate::light::ambient`] light.

use std::f32::consts::{FRAC_1_PI, PI, TAU};

use straal_color::Light;
use straal_math::simd::Float;
use straal_math::{Frame, Vec3, ops, warp};
use straal_scene::desc;

use super::many::{self, Lobe, These, is_lobe};
use super::{Bsdf, BsdfSample, Recipe, Scatter, Transport, Wants, facing_or_zero};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// An evenly scattering ground with a highlight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhongMaterial {
    /// Share of light that is scattered evenly: k_d c.
    pub reflectance: Value<Colour>,
    /// Share of ambient light that is sent back: k_a c.
    pub ambient: Value<Colour>,
    /// Strength of the highlight: k_s.
    pub specular: Value<Colour>,
    /// Its sharpness: e.
    pub exponent: Value<f32>,
    /// Which.
    pub form: Form,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

/// Which highlight it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// Blinn's, else Phong's.
    pub blinn: bool,
    /// How it is scaled.
    pub scale: Scale,
}

/// How a highlight is scaled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// So that energy is conserved.
    Normalised,
    /// f = k_s x^e.
    Textbook,
    /// f |cos| = k_s x^e.
    Classic,
}

impl Recipe for PhongMaterial {
    type Described = desc::Phong;

    fn of(d: &desc::Phong, paint: &mut Paint<'_>) -> Self {
        let scale = match d.form {
            desc::HighlightForm::Normalised => Scale::Normalised,
            desc::HighlightForm::Textbook => Scale::Textbook,
            desc::HighlightForm::Classic => Scale::Classic,
        };
        Self {
            reflectance: paint.reflectance(&d.reflectance),
            ambient: paint.reflectance(d.ambient.as_ref().unwrap_or(&d.reflectance)),
            specular: paint.reflectance(&d.specular),
            exponent: paint.number(&d.exponent),
            form: Form { blinn: d.highlight == desc::Highlight::Blinn, scale },
            two_sided: d.two_sided,
        }
    }

    fn wants(&self) -> Wants {
        Wants::point(
            self.reflectance.varies()
                || self.ambient.varies()
                || self.specular.varies()
                || self.exponent.varies(),
        )
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        Bsdf::Phong(Phong {
            diffuse: reading.eval(&self.reflectance, at),
            ambient: reading.eval(&self.ambient, at),
            specular: reading.eval(&self.specular, at),
            exponent: ops::clamp(reading.eval(&self.exponent, at), 0.0, 1e5),
            form: self.form,
            two_sided: self.two_sided,
        })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let grey = |v: f32| Light::rgb([v; 3]).into();
        let form = Form { blinn: false, scale: Scale::Normalised };
        let of = Self {
            reflectance: grey(0.5),
            ambient: grey(0.5),
            specular: grey(0.2),
            exponent: 20.0.into(),
            form,
            two_sided: true,
        };
        vec![(of, super::BsdfKind::Phong)]
    }
}

/// Even scattering and a highlight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// Share of light that is scattered evenly.
    pub diffuse: Light,
    /// Share of ambient light that is sent back.
    pub ambient: Light,
    /// Strength of the highlight.
    pub specular: Light,
    /// Its sharpness.
    pub exponent: f32,
    /// Which.
    pub form: Form,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Phong {
    /// x^e of a highlight, and the density with which directions of it are drawn; 0 below the surface. Both directions have z > 0 where it
    /// isn't 0.
    #[inline(always)]
    pub(crate) fn highlight<F: Float>(blinn: F::Mask, exponent: F, wo: Vec3<F>, wi: Vec3<F>) -> [F; 2] {
        let h = wo + wi;
        // Opposite directions have no half-way.
        let length = h.length_squared().sqrt();
        let defined = length.gt(F::splat(1e-12)) & wo.z.gt(F::ZERO) & wi.z.gt(F::ZERO);
        let half = h.z / length;
        let mirrored = wi.z * wo.z - (wi.x * wo.x + wi.y * wo.y);
        let x = F::select(blinn, half, mirrored);
        let lit = defined & x.gt(F::ZERO);
        let power = F::select(lit, ops::pow(F::select(lit, x, F::ONE), exponent), F::ZERO);
        // Blinn's half-way direction is drawn by cos^(e + 1); 4 (wo.h) is the stretch of reflecting it.
        let towards = wo.dot(h) / length;
        let by_half = (exponent + 2.0) * power * half / (towards * 4.0);
        let density = F::select(blinn, by_half, (exponent + 1.0) * power) * (1.0 / TAU);
        [power, F::select(lit, density, F::ZERO)]
    }

    /// A direction of the highlight by that density, from above the surface; where it has z <= 0 there is none.
    #[inline(always)]
    pub(crate) fn draw<F: Float>(blinn: F::Mask, exponent: F, wo: Vec3<F>, u: [F; 2]) -> Vec3<F> {
        let lobe = warp::cosine_power_hemisphere(u, F::select(blinn, exponent + 1.0, exponent));
        let mirrored = Vec3::new(-wo.x, -wo.y, wo.z);
        let about_mirrored = Frame::from_normal(mirrored).to_world(lobe);
        let off_half = lobe * (wo.dot(lobe) * 2.0) - wo;
        let choose = |a: F, b: F| F::select(blinn, a, b);
        Vec3::new(
            choose(off_half.x, about_mirrored.x),
            choose(off_half.y, about_mirrored.y),
            choose(off_half.z, about_mirrored.z),
        )
    }

    /// What x^e is multiplied by in the normalised form, but for k_s.
    #[inline(always)]
    fn norm<F: Float>(blinn: F::Mask, e: F) -> F {
        let of_blinn = (e + 2.0) * (e + 4.0) / ((ops::exp2(e * -0.5) + e) * (8.0 * PI));
        F::select(blinn, of_blinn, (e + 2.0) / TAU)
    }
}

/// A [`Phong`] with what follows from it, or many side by side.
#[derive(Clone, Copy)]
struct Highlight<F: Float> {
    diffuse: Light<F>,
    specular: Light<F>,
    /// What x^e is multiplied by, but for that.
    scale: F,
    exponent: F,
    /// The chance of the highlight.
    chance: F,
    blinn: F::Mask,
    classic: F::Mask,
    two_sided: F::Mask,
}

impl<F: Float> Highlight<F> {
    /// As [`Scatter::eval_pdf`], for directions on the front.
    #[inline(always)]
    fn on_front(&self, wo: Vec3<F>, wi: Vec3<F>) -> (Light<F>, F) {
        let there = wi.z.gt(F::ZERO);
        let even = wi.z * FRAC_1_PI;
        let [power, density] = Phong::highlight(self.blinn, self.exponent, wo, wi);
        let cos = F::select(self.classic, F::ONE, wi.z);
        let value = self.diffuse * even + self.specular * (self.scale * power * cos);
        let pdf = even + self.chance * (density - even);
        (Light::select(there, value, Light::splat(F::ZERO)), F::select(there, pdf, F::ZERO))
    }
}

impl<F: Float> Lobe<F> for Highlight<F> {
    type One = Phong;

    #[inline(always)]
    fn gather(these: impl These<Phong>) -> Self {
        let diffuse: Light<F> = many::light(these, |p: &Phong| p.diffuse);
        let specular: Light<F> = many::light(these, |p: &Phong| p.specular);
        let exponent = many::each(these, |p: &Phong| p.exponent);
        let blinn = many::which::<_, F>(these, |p: &Phong| p.form.blinn);
        let normalised = many::which::<_, F>(these, |p: &Phong| p.form.scale == Scale::Normalised);
        let (d, s) = (diffuse.max_lane(), specular.max_lane());
        Self {
            diffuse,
            specular,
            scale: F::select(normalised, Phong::norm(blinn, exponent), F::ONE),
            exponent,
            chance: F::select(s.gt(F::ZERO), s / (d + s), F::ZERO),
            blinn,
            classic: many::which::<_, F>(these, |p: &Phong| p.form.scale == Scale::Classic),
            two_sided: many::which::<_, F>(these, |p: &Phong| p.two_sided),
        }
    }

    #[inline(always)]
    fn eval_pdf(&self, wo: Vec3<F>, wi: Vec3<F>, _: Transport) -> (Light<F>, F) {
        let side = facing_or_zero(wo, self.two_sided);
        let seen = side.ne(F::ZERO);
        let (wo, wi) = (Vec3::new(wo.x, wo.y, side * wo.z), Vec3::new(wi.x, wi.y, side * wi.z));
        let (value, pdf) = self.on_front(wo, wi);
        (Light::select(seen, value, Light::splat(F::ZERO)), F::select(seen, pdf, F::ZERO))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, u_lobe: F, u: [F; 2], _: Transport) -> (BsdfSample<F>, F::Mask) {
        let side = facing_or_zero(wo, self.two_sided);
        let wo = Vec3::new(wo.x, wo.y, side * wo.z);
        let lit = Phong::draw(self.blinn, self.exponent, wo, u);
        let wi = Vec3::select(u_lobe.lt(self.chance), lit, warp::cosine_hemisphere(u));
        let (value, pdf) = self.on_front(wo, wi);
        let weight = value * (F::ONE / pdf);
        let there = side.ne(F::ZERO) & pdf.gt(F::ZERO) & weight.is_finite();
        (BsdfSample::reflected(Vec3::new(wi.x, wi.y, side * wi.z), weight, pdf), there)
    }
}

impl Scatter for Phong {
    const CHOOSES_LOBE: bool = true;

    is_lobe!(Highlight);

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    fn albedo(&self) -> Light {
        (self.diffuse + self.specular).map(|v| if v < 1.0 { v } else { 1.0 })
    }

    fn ambient(&self) -> Light {
        self.ambient
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::Example;
        let grey = |v: f32| Light::rgb([v; 3]);
        let of = |blinn, scale, exponent, [d, s]: [f32; 2]| Self {
            diffuse: grey(d),
            ambient: grey(d),
            specular: grey(s),
            exponent,
            form: Form { blinn, scale },
            two_sided: true,
        };
        let (phong, blinn) = (false, true);
        let one_sided = Self { two_sided: false, ..of(phong, Scale::Normalised, 5.0, [0.5, 0.5]) };
        vec![
            Example::new("Phong, normalised", Bsdf::Phong(of(phong, Scale::Normalised, 30.0, [0.5, 0.5])))
                .focus(3),
            Example::new("Phong, one-sided", Bsdf::Phong(one_sided)),
            Example::new(
                "Phong's highlight alone, sharp",
                Bsdf::Phong(of(phong, Scale::Normalised, 2000.0, [0.0, 1.0])),
            )
            .focus(6),
            Example::new(
                "Phong's highlight alone, flat",
                Bsdf::Phong(of(phong, Scale::Normalised, 0.0, [0.0, 1.0])),
            ),
            Example::new("Phong, textbook", Bsdf::Phong(of(phong, Scale::Textbook, 3.0, [0.5, 0.5])))
                .gives_energy(),
            Example::new("Phong, classic", Bsdf::Phong(of(phong, Scale::Classic, 20.0, [0.5, 0.5])))
                .focus(3)
                .gives_energy()
                .one_way(),
            Example::new("Blinn, normalised", Bsdf::Phong(of(blinn, Scale::Normalised, 30.0, [0.4, 0.6])))
                .focus(4),
            Example::new(
                "Blinn's highlight alone",
                Bsdf::Phong(of(blinn, Scale::Normalised, 2.0, [0.0, 1.0])),
            )
            .focus(4),
            Example::new("Blinn, textbook", Bsdf::Phong(of(blinn, Scale::Textbook, 10.0, [0.5, 0.5])))
                .focus(4)
                .gives_energy(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::SphereGrid;

    fn of(blinn: bool, scale: Scale, exponent: f32) -> Phong {
        let form = Form { blinn, scale };
        let (diffuse, specular) = (Light::ZERO, Light::rgb([1.0; 3]));
        Phong { diffuse, ambient: diffuse, specular, exponent, form, two_sided: true }
    }

    /// The share of light along the normal that a highlight alone sends back.
    fn sent_back(phong: &Phong, wo: Vec3) -> f64 {
        let f = |wi| f64::from(phong.eval_pdf(wo, wi, Transport::Radiance).0[0]);
        SphereGrid { focus: 3, ..SphereGrid::default() }.total(f, 1e-5)
    }

    #[test]
    fn light_along_the_normal_comes_back_as_the_form_says() {
        for e in [1.0_f32, 10.0, 200.0] {
            for blinn in [false, true] {
                let all = sent_back(&of(blinn, Scale::Normalised, e), Vec3::Z);
                assert!((all - 1.0).abs() < 1e-3, "{e} {blinn}: {all}");
            }
            // The integral of cos^e cos and of cos^e over the hemisphere.
            let (textbook, classic) = (of(false, Scale::Textbook, e), of(false, Scale::Classic, e));
            let (two_pi, e) = (std::f64::consts::TAU, f64::from(e));
            let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 5e-3, "{a} {b}");
            near(sent_back(&textbook, Vec3::Z), two_pi / (e + 2.0));
            near(sent_back(&classic, Vec3::Z), two_pi / (e + 1.0));
        }
    }
}
