//! # glTF
//!
//! The material of glTF 2.0, metallic and rough, with the extensions that Khronos has ratified for it: index of refraction, specular, clearcoat,
//! sheen, transmission, volume, iridescence, anisotropy, dispersion (`KHR_materials_*`). glTF leaves the model to the renderer, within bounds; here it
//! is read as the layers of [`super::open_pbr`], with these differences from the formulas of the specification's appendix B:
//!
//! | glTF | here |
//! |---|---|
//! | metal: Schlick from the base's colour, alpha = roughness² | exact |
//! | dielectric: Schlick from the index | exact Fresnel of the index; `specular` scales what is reflected straight on, not along the surface |
//! | diffuse: Lambert, times 1 - Fresnel of the half-way vector | Lambert, times what the glossy surface lets through: white loses nothing |
//! | light that bounces between facets is lost, shadowing is height-correlated | it is given back, shadowing is of both directions independently |
//! | `specular`, `specular_color` don't act on metal | they do, where `metallic` is above 0 and they aren't 1 |
//! | clearcoat: a lobe of index 1.5, the base dimmed by 1 - Fresnel | a coat of that index, without absorption and darkening; it makes the base look rougher |
//! | sheen: Charlie's distribution, the base dimmed by its albedo | fibres of Zeltner et al. 2022, the base dimmed by what they reflect |
//! | transmission without volume: thin, tinted by the base's colour | the same as a thin wall |
//! | transmission with volume: refracted, absorbed by colour and distance | the same |
//! | iridescence by Belcour and Barla in RGB | Airy's sum at 620, 540 and 450 nm, or at the path's wavelengths |
//! | anisotropy: alpha towards 1 along the tangent by strength² | exact, in steps of half a percent, with its rotation and a texture's directions |
//! | the clearcoat's own normals | the same; where they tell of what is below the surface, light is lost |
//! | diffuse transmission | the same for a thin wall; inside a volume it sends light back, as there are no media |
//! | emission, below the clearcoat | the same |
//! | double-sided or culled | both sides, or black from behind |

use straal_color::Light;
use straal_math::Vec3;
use straal_scene::desc;

use super::interior::Absorption;
use super::open_pbr::{OpenPbr, Params, film_presence, nanometres};
use super::{Bsdf, Emission, Interior, Recipe, Wants};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::relief::{Brushing, CoatNormals};
use crate::texture::{Reading, ShadingPoint, Value};

/// glTF's parameters.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // glTF's names tell what they are
pub struct GltfMaterial {
    pub base_color: Value<Colour>,
    pub metallic: Value<f32>,
    pub roughness: Value<f32>,
    /// Radiance that it sends out.
    pub emissive: Value<Colour>,
    /// What that is multiplied by.
    pub emissive_strength: Value<f32>,
    pub alpha: Value<f32>,
    pub ior: Value<f32>,
    pub specular: Value<f32>,
    pub specular_color: Value<Colour>,
    pub clearcoat: Value<f32>,
    pub clearcoat_roughness: Value<f32>,
    pub sheen_color: Value<Colour>,
    pub sheen_roughness: Value<f32>,
    pub transmission: Value<f32>,
    /// What dims light within, where there is an inside.
    pub filling: Option<Interior>,
    pub iridescence: Value<f32>,
    pub iridescence_ior: Value<f32>,
    /// In nm.
    pub iridescence_thickness: Value<f32>,
    pub anisotropy: Value<f32>,
    /// Along which it is rougher.
    pub brushing: Brushing,
    pub clearcoat_normal: CoatNormals,
    /// 20 over Abbe's number.
    pub dispersion: Value<f32>,
    pub diffuse_transmission: Value<f32>,
    pub diffuse_transmission_color: Value<Colour>,
    /// Whether the back looks like the front; else it is black.
    pub double_sided: bool,
}

impl Recipe for GltfMaterial {
    type Described = desc::Gltf;

    fn of(d: &desc::Gltf, paint: &mut Paint<'_>) -> Self {
        let transmission = paint.number(&d.transmission);
        let absorption = match &d.attenuation_distance {
            Some(distance) => Absorption::Colour(paint.share(&d.attenuation_color), *distance as f32),
            None => Absorption::None,
        };
        let ior = paint.number_within(&d.ior, [1.0, 5.0]);
        let eta = d.ior.constant().map(|v| *v as f32);
        let has_inside = transmission.most() > 0.0 && d.volume;
        Self {
            base_color: paint.reflectance(&d.base_color),
            metallic: paint.number(&d.metallic),
            roughness: paint.number(&d.roughness),
            emissive: paint.emission(&d.emissive),
            emissive_strength: paint.number(&d.emissive_strength),
            alpha: paint.number(&d.alpha),
            ior,
            specular: paint.number(&d.specular),
            specular_color: paint.reflectance(&d.specular_color),
            clearcoat: paint.number(&d.clearcoat),
            clearcoat_roughness: paint.number(&d.clearcoat_roughness),
            sheen_color: paint.reflectance(&d.sheen_color),
            sheen_roughness: paint.number(&d.sheen_roughness),
            transmission,
            filling: has_inside.then_some(Interior { absorption, priority: 0, eta, outside: Some(1.0) }),
            iridescence: paint.number(&d.iridescence),
            iridescence_ior: paint.number_within(&d.iridescence_ior, [1.0, 5.0]),
            iridescence_thickness: paint.number(&d.iridescence_thickness),
            anisotropy: paint.number(&d.anisotropy),
            brushing: Brushing::of(d.anisotropy_direction.as_ref(), &d.anisotropy_rotation, paint),
            clearcoat_normal: CoatNormals::of(&d.clearcoat_normal, paint),
            dispersion: paint.number_within(&d.dispersion, [0.0, 3.2]),
            diffuse_transmission: paint.number(&d.diffuse_transmission),
            diffuse_transmission_color: paint.reflectance(&d.diffuse_transmission_color),
            double_sided: d.double_sided,
        }
    }

    fn interior(&self) -> Option<&Interior> {
        self.filling.as_ref()
    }

    fn opacity(&self) -> Option<Value<f32>> {
        (self.alpha != Value::Constant(1.0)).then_some(self.alpha)
    }

    fn wants(&self) -> Wants {
        let numbers = [
            &self.metallic,
            &self.roughness,
            &self.alpha,
            &self.specular,
            &self.clearcoat,
            &self.clearcoat_roughness,
            &self.sheen_roughness,
            &self.transmission,
            &self.iridescence,
            &self.iridescence_thickness,
            &self.anisotropy,
            &self.diffuse_transmission,
            &self.ior,
            &self.iridescence_ior,
            &self.dispersion,
        ];
        let colours =
            [&self.base_color, &self.specular_color, &self.sheen_color, &self.diffuse_transmission_color];
        let varies = numbers.iter().any(|v| v.varies()) || colours.iter().any(|v| v.varies());
        let tangent = self.anisotropy.most() > 0.0 || self.leans();
        Wants { point: varies || tangent, tangent }
    }

    fn emission(&self) -> Option<Emission> {
        let most = self.emissive_strength.most();
        let shines = most > 0.0 && self.emissive.most() > 0.0;
        shines.then_some(Emission { radiance: self.emissive, most, both_sides: false })
    }

    fn lets_out<L: Lanes>(&self, cos: f32, at: &ShadingPoint, reading: &Reading<'_, L>) -> Light {
        self.layers(at, reading).lets_out(cos) * reading.eval(&self.emissive_strength, at)
    }

    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        Bsdf::OpenPbr(self.layers(at, reading))
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let (zero, one) = (|| Value::from(0.0), || Value::from(1.0));
        vec![(
            Self {
                base_color: Light::rgb([1.0; 3]).into(),
                metallic: one(),
                roughness: one(),
                emissive: Light::ZERO.into(),
                emissive_strength: one(),
                alpha: one(),
                ior: 1.5.into(),
                specular: one(),
                specular_color: Light::rgb([1.0; 3]).into(),
                clearcoat: zero(),
                clearcoat_roughness: zero(),
                sheen_color: Light::ZERO.into(),
                sheen_roughness: zero(),
                transmission: zero(),
                filling: None,
                iridescence: zero(),
                iridescence_ior: 1.3.into(),
                iridescence_thickness: 400.0.into(),
                anisotropy: zero(),
                brushing: Brushing::STRAIGHT,
                clearcoat_normal: CoatNormals::Base,
                dispersion: zero(),
                diffuse_transmission: zero(),
                diffuse_transmission_color: Light::rgb([1.0; 3]).into(),
                double_sided: true,
            },
            super::BsdfKind::OpenPbr,
        )]
    }
}

impl GltfMaterial {
    /// Whether the coat has a normal of its own.
    fn leans(&self) -> bool {
        self.clearcoat.most() > 0.0 && self.clearcoat_normal != CoatNormals::Base
    }

    fn layers<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> OpenPbr {
        let number = |v: &Value<f32>| reading.eval(v, at);
        let base = reading.eval(&self.base_color, at);
        let sheen = reading.eval(&self.sheen_color, at);
        let sheen_weight = sheen.max_lane();
        let thickness = number(&self.iridescence_thickness);
        let (nm, parted) = nanometres(reading.lanes);
        let [roughness, anisotropy] = stretched(number(&self.roughness), number(&self.anisotropy));
        let diffuse = number(&self.diffuse_transmission);
        let full = reading.lanes.full();
        let params = Params {
            along: [1.0, 0.0],
            coat_normal: Vec3::Z,
            turned: false,
            leans: false,
            base,
            specular: reading.eval(&self.specular_color, at),
            transmission: base,
            subsurface: if diffuse > 0.0 { reading.eval(&self.diffuse_transmission_color, at) } else { full },
            coat: full,
            fuzz: if sheen_weight > 0.0 { sheen * (1.0 / sheen_weight) } else { Light::ZERO },
            nm,
            metalness: number(&self.metallic),
            specular_weight: number(&self.specular),
            transmission_weight: number(&self.transmission),
            subsurface_weight: diffuse,
            coat_weight: number(&self.clearcoat),
            fuzz_weight: sheen_weight,
            film_presence: film_presence(number(&self.iridescence), thickness),
            diffuse_roughness: 0.0,
            roughness,
            coat_roughness: number(&self.clearcoat_roughness),
            fuzz_roughness: number(&self.sheen_roughness),
            ior: number(&self.ior),
            coat_ior: 1.5,
            film_ior: number(&self.iridescence_ior),
            film_thickness: thickness,
            dispersion: number(&self.dispersion),
            anisotropy,
            coat_anisotropy: 0.0,
            coat_darkening: 0.0,
            // All of it goes through.
            subsurface_anisotropy: 1.0,
            thin: self.filling.is_none(),
            one_sided: !self.double_sided,
            rgb: reading.lanes.bins().is_none(),
            parted,
            reciprocal: false,
        };
        let brushing = if anisotropy > 0.0 { self.brushing.at(at, reading) } else { [1.0, 0.0] };
        OpenPbr::new(&params.turned_to(brushing, self.clearcoat_normal.at(at, reading)))
    }
}

/// Roughness and anisotropy of OpenPBR for glTF's: alpha = roughness² across the tangent, and towards 1 along it by the square of the strength.
fn stretched(roughness: f32, strength: f32) -> [f32; 2] {
    if strength == 0.0 {
        return [roughness, 0.0];
    }
    let across = roughness * roughness;
    let along = across + (1.0 - across) * strength * strength;
    let mean = (0.5 * (along * along + across * across)).sqrt();
    [mean.sqrt(), 1.0 - across / along]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// OpenPBR's: alpha sqrt(2 / (1 + b²)) along and b times that across, for b = 1 - anisotropy.
    #[test]
    fn anisotropy_is_gltfs() {
        for (roughness, strength) in [(0.3_f32, 0.5_f32), (0.7, 1.0), (0.5, 0.1)] {
            let [mean, anisotropy] = stretched(roughness, strength);
            let b = 1.0 - anisotropy;
            let along = mean * mean * (2.0 / (1.0 + b * b)).sqrt();
            let across = roughness * roughness;
            let want = across + (1.0 - across) * strength * strength;
            assert!((along - want).abs() < 1e-5 && (along * b - across).abs() < 1e-5, "{along} {want}");
        }
    }
}
