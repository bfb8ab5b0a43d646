//! Integrators.

use straal_scene::desc::{
    AmbientOcclusion, DirectLight, Directions, Integrator, LightTracer, PathTracer, Roulette, Technique,
};
use straal_scene::limit::Limit;
use straal_scene::value::Depth;

use super::translate::Translator;
use super::tree::{Class, Object};

/// What every one may have, here or in older versions, and what says nothing about the picture.
const COMMON: [&str; 8] = [
    "hide_emitters",
    "timeout",
    "block_size",
    "samples_per_pass",
    "strict_normals",
    "max_depth",
    "rr_depth",
    "*",
];

impl<'o> Translator<'o, '_, '_> {
    /// The way light is computed.
    pub fn integrator(&mut self, i: usize) {
        let o: &'o Object = &self.objects[i];
        // It counts where lamps are made.
        self.boolean(o, "hide_emitters");
        match o.plugin.as_str() {
            "path" | "volpath" | "volpathmis" | "volpath_simple" => {
                self.only(o, &COMMON);
                self.path(o);
            }
            "direct" => {
                self.only(
                    o,
                    &[&COMMON[..], &["emitter_samples", "bsdf_samples", "shading_samples"]].concat(),
                );
                let shading = self.count(o, "shading_samples", 1, [1, 4096]);
                let lights = self.count(o, "emitter_samples", shading, [0, 4096]);
                let bsdf = self.count(o, "bsdf_samples", shading, [0, 4096]);
                let technique = match (lights, bsdf) {
                    (0, _) => Technique::Bsdf,
                    (_, 0) => Technique::Lights,
                    _ => Technique::Mis,
                };
                self.scene.integrator = Integrator::Direct(DirectLight {
                    technique,
                    light_samples: lights.max(1),
                    bsdf_samples: bsdf.max(1),
                    directions: Directions::Bsdf,
                });
            }
            "ao" => {
                self.only(o, &[&COMMON[..], &["shading_samples", "ray_length"]].concat());
                let rays = self.count(o, "shading_samples", 1, [1, 4096]);
                let length = self.float(o, "ray_length").filter(|v| *v > 0.0);
                let radius = length.map(|v| self.held(o.plugin.span, "ray_length", v, Limit::POSITIVE));
                self.scene.integrator =
                    Integrator::Ao(AmbientOcclusion { rays, radius, ..AmbientOcclusion::default() });
            }
            "ptracer" => {
                self.only(o, &[&COMMON[..], &["samples_per_pass"]].concat());
                let (max_depth, roulette_depth) = self.depths(o);
                self.scene.integrator =
                    Integrator::Light(LightTracer { max_depth, roulette_depth, roulette: Roulette::Root });
            }
            "aov" | "moment" => {
                self.only(o, &[&COMMON[..], &["aovs"]].concat());
                let what = if o.plugin.as_str() == "aov" {
                    "`aovs` aren't read: an EXR has the layers of straal (albedo, normals, depth and others)"
                } else {
                    "`moment` isn't needed: an EXR tells the error of each pixel"
                };
                self.warn(o.plugin.span, what);
                match self.inside(o, Class::Integrator).first() {
                    Some(&inner) => self.integrator(inner),
                    None => self.path(o),
                }
            }
            "adaptive" | "multichannel" | "irrcache" if self.has_inside(o, Class::Integrator) => {
                self.unsupported(o, "what it does its work with is used alone");
                if let Some(&inner) = self.inside(o, Class::Integrator).first() {
                    self.integrator(inner);
                }
            }
            "volprim_rf_basic" => {
                self.unsupported(o, "the path tracer is used, by which ellipsoids are solid");
                self.path(o);
            }
            _ => {
                self.unsupported(o, "the path tracer is used");
                self.path(o);
            }
        }
    }

    /// How many edges a path may have, and after how many roulette begins.
    fn depths(&mut self, o: &'o Object) -> (Depth, u32) {
        let most = self.integer(o, "max_depth").unwrap_or(-1);
        let max_depth = match most {
            ..0 => Depth::Unlimited,
            0 => {
                self.warn(o.plugin.span, "a `max_depth` of 0 shows nothing: 1 is taken, which shows lamps");
                Depth::Edges(1)
            }
            most => Depth::Edges(u32::try_from(most).unwrap_or(u32::MAX)),
        };
        (max_depth, self.count(o, "rr_depth", 5, [0, u32::MAX]))
    }

    fn path(&mut self, o: &'o Object) {
        let (max_depth, roulette_depth) = self.depths(o);
        self.scene.integrator = Integrator::Path(PathTracer {
            max_depth,
            roulette_depth,
            roulette: Roulette::Root,
            technique: Technique::Mis,
            ..PathTracer::default()
        });
    }
}
