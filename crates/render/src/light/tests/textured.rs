//! Light of a ball that sends out a texture is the same, whether points of it are drawn or rays hit it by chance.

use super::*;
use crate::texture::{CustomTexture, ShadingPoint, Texture, TextureKind, TextureRef, Use};
use std::sync::Arc;
use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_math::{Transform, warp};

/// Stripes about the ball's own y, brighter on one side, in its own coordinates.
#[derive(Debug)]
struct Stripes;

impl CustomTexture for Stripes {
    fn rgb(&self, at: &ShadingPoint) -> [f32; 3] {
        let p = at.object.p;
        let stripe = if (p.y * 4.0).floor() % 2.0 == 0.0 { 1.0 } else { 0.1 };
        [stripe * (1.5 + p.x), 0.5 + 0.5 * p.z, stripe]
    }
    fn fingerprint(&self) -> u64 {
        9
    }
}

#[test]
fn a_textured_ball_gives_the_same_light_however_it_is_found() {
    let center = Vec3::new(0.3, 1.2, -0.4);
    let placement = turned().then(&Affine::translate(center.as_dvec3()));
    let sphere = Sphere { center, radius: 1.0 };
    let geometry = Geometry { shapes: vec![Shape::Sphere(sphere)], ..Geometry::default() };
    let light = AreaLight {
        surface: LitSurface::Shape(0),
        radiance: Value::Texture(TextureRef { id: 0, most: 3.0 }),
        opacity: None,
        below: None,
        sides: Sides::Front,
        spread: area::Spread::default(),
        placement: Transform::new(&placement).map(Box::new),
    };
    let textures = [Texture::new(TextureKind::Custom(Arc::new(Stripes)), Use::Emission)];
    let reading = crate::texture::Reading { textures: &textures, ..in_rgb() };
    let count = 4096;
    let pair = |i: u32| {
        let [u, v, ..] = Pattern::Sobol.d4(&SampleName::new(5, [0, 0], i), Purpose::Custom);
        [u, v]
    };
    for p in [Vec3::new(0.0, -0.6, 0.5), Vec3::new(2.5, 1.0, 0.0)] {
        let n = (center - p).normalize();
        let (mut drawn, mut met) = ([0.0_f64; 3], [0.0_f64; 3]);
        let add = |sum: &mut [f64; 3], light: Light, by: f32| {
            (0..3).for_each(|c| sum[c] += f64::from(light[c] * by) / f64::from(count));
        };
        let frame = straal_math::Frame::from_normal(n);
        for i in 0..count {
            if let Some(s) = light.sample(&geometry, (&Receiver { p, n }, pair(i)), &reading) {
                add(&mut drawn, s.radiance, s.wi.dot(n) / s.pdf);
            }
            // All directions of the half space, by their cosine: pi times the mean.
            let wi = frame.to_world(warp::cosine_hemisphere(pair(i)));
            let towards = center - p;
            let along = towards.dot(wi);
            let square = 1.0 - (towards.length_squared() - along * along);
            if along > 0.0 && square > 0.0 {
                let q = p + wi * (along - square.sqrt());
                let ng = (q - center).normalize();
                let point = SurfacePoint { p: q, p_err: Vec3::ZERO, ng, n: ng, uv: [0.0; 2] };
                add(&mut met, light.radiance_at(&point, -wi, &reading), std::f32::consts::PI);
            }
        }
        for c in 0..3 {
            let off = (drawn[c] / met[c] - 1.0).abs();
            assert!(off < 0.02 && met[c] > 0.1, "{p:?}: {drawn:?} and {met:?}");
        }
    }
}
