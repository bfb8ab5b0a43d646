//! A program's own shapes and materials give the very picture of the built-in ones that they imitate.

use std::path::Path;
use std::sync::Arc;
use straal::{Control, Job, LoadOptions, Overrides};
use straal_math::{Bounds, Ray, Vec3};
use straal_render::compile::Custom;
use straal_render::material::{Bsdf, CustomMaterial, Diffuse};
use straal_render::shape::{CustomShape, ShapeHit, Sphere, SurfacePoint};
use straal_render::texture::{ReadRgb, ShadingPoint};

#[derive(Debug)]
struct Ball(Sphere);

impl CustomShape for Ball {
    fn bounds(&self) -> Option<Bounds> {
        Some(self.0.bounds())
    }

    fn intersect(&self, ray: &Ray) -> Option<ShapeHit> {
        self.0.analytic().intersect(ray)
    }

    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.0.surface(ray, hit)
    }

    fn fingerprint(&self) -> u64 {
        7
    }
}

#[derive(Debug)]
struct Paint;

impl CustomMaterial for Paint {
    fn bsdf(&self, _at: &ShadingPoint, read: &dyn ReadRgb) -> Bsdf<'_> {
        Bsdf::Diffuse(Diffuse { reflectance: read.reflectance([0.8, 0.4, 0.2]), two_sided: true })
    }

    fn fingerprint(&self) -> u64 {
        9
    }
}

fn scene(paint: &str, more: &str) -> String {
    format!(
        "camera: {{ perspective: {{ eye: [0, 1, 6], look_at: [0, 0.5, 0], fov: 40 }} }}
film: {{ size: [48, 32] }}
sampler: {{ spp: 4 }}
materials: {{ paint: {{ diffuse: {{ reflectance: {paint} }} }} }}
world:
  - plane: {{ }}
  - sphere: {{ center: [-1, 1, 0], radius: 1, material: paint }}
{more}lights:
  - environment: {{ radiance: 1 }}
"
    )
}

fn picture(text: &str, custom: &Custom) -> (String, String) {
    let loaded = straal::load_str("test.yaml", text, Path::new(""), &LoadOptions::default());
    let loaded = loaded.unwrap_or_else(|d| panic!("{d}"));
    let job = Job::with_custom(loaded, Overrides::default(), custom).expect("a world");
    let outcome = job.render(&mut Control::to_the_end()).expect("a picture");
    (outcome.picture.tells("film_hash").expect("a hash").to_owned(), job.scene_hash)
}

#[test]
fn imitations_have_the_same_bits_and_a_hash_of_their_own() {
    let plain =
        scene("[0.8, 0.4, 0.2]", "  - sphere: { center: [1.2, 0.8, 0.5], radius: 0.8, material: paint }\n");
    let ball = Ball(Sphere { center: Vec3::new(1.2, 0.8, 0.5), radius: 0.8 });
    let custom = Custom {
        shapes: vec![(Arc::new(ball), "paint".to_owned())],
        materials: vec![("paint".to_owned(), Arc::new(Paint))],
    };
    let (film, hash) = picture(&plain, &Custom::default());
    let (own_film, own_hash) = picture(&scene("0.1", ""), &custom);
    assert_eq!(film, own_film);
    assert_ne!(hash, own_hash);
    assert!(own_hash.ends_with("-0000000000000007-0000000000000009"));
}
