//! Media: what only absorbs and fills clear glass is Beer's law; all else waits for media of straal's own.

use straal_scene::desc::{Interior, Spectrum};

use super::spectrum::For;
use super::translate::Translator;
use super::tree::{Object, Value};

impl<'o> Translator<'o, '_, '_> {
    /// What a medium makes of the inside of clear glass.
    pub fn interior(&mut self, medium: usize) -> Interior {
        let o: &'o Object = &self.objects[medium];
        let is_dark = |name: &str| match o.get(name).map(|p| &p.value) {
            Some(Value::Float(v)) => *v == 0.0,
            Some(Value::Integer(v)) => *v == 0,
            Some(Value::Rgb(rgb)) => rgb.iter().all(|v| *v == 0.0),
            Some(Value::Spectrum(super::tree::Numbers::Uniform(v))) => *v == 0.0,
            _ => false,
        };
        let by_parts = o.has("sigma_a");
        let only_absorbs = if by_parts { !o.has("sigma_s") || is_dark("sigma_s") } else { is_dark("albedo") };
        if o.plugin.as_str() != "homogeneous" || !only_absorbs {
            self.medium_is_left_out(medium, "it scatters, and the glass is clear");
            return Interior::default();
        }
        self.only(
            o,
            &[
                "albedo",
                "sigma_t",
                "sigma_a",
                "sigma_s",
                "scale",
                "sample_emitters",
                "has_spectral_extinction",
                "*",
            ],
        );
        let scale = self.within(o, "scale", 1.0, straal_scene::limit::Limit::NON_NEGATIVE);
        let sigma = self.constant(o, if by_parts { "sigma_a" } else { "sigma_t" }, 1.0, For::Any);
        let sigma_a: Spectrum = self.times(o.plugin.span, sigma, scale);
        Interior { sigma_a: Some(sigma_a), ..Interior::default() }
    }

    /// Tells it of each medium once.
    pub fn medium_is_left_out(&mut self, medium: usize, why: &str) {
        if self.media.insert(medium) {
            let o: &'o Object = &self.objects[medium];
            let message =
                format!("the medium `{}` isn't rendered yet: {why}", straal_scene::suggest::brief(&o.plugin));
            self.warn(o.plugin.span, message);
        }
    }
}
