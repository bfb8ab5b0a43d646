//! What a finished render has to tell.

use crate::complaint;
use crate::keeping::Told;
use crate::process;
use crate::quantity::{count, tell_bytes, tell_duration, tell_percent};
use serde_json::{Map, Value as Json, json};
use std::path::PathBuf;
use straal::denoise::Denoised;
use straal::{Job, Outcome, Phase, Times};
use straal_scene::Diagnostics;

/// All that is known about a render that ended and whose pictures are written.
pub struct Report<'a> {
    /// Where the pictures are.
    pub pictures: &'a [PathBuf],
    /// What was rendered.
    pub job: &'a Job,
    /// What came of it.
    pub outcome: &'a Outcome,
    /// Complaints about the scene.
    pub warnings: &'a Diagnostics,
    /// The signal that ended it, if one did.
    pub interrupted: Option<&'static str>,
    /// What was kept besides pictures.
    pub kept: &'a Told,
    /// Since the command began.
    pub seconds: f64,
    /// While rays flew.
    pub render_seconds: f64,
    /// Of the whole process.
    pub cpu_seconds: Option<f64>,
    /// Of the whole process.
    pub peak_memory_bytes: Option<u64>,
}

impl<'a> Report<'a> {
    /// With the costs of the process so far.
    pub fn measured(self) -> Self {
        Self { cpu_seconds: process::cpu_seconds(), peak_memory_bytes: process::peak_memory_bytes(), ..self }
    }

    /// For people.
    pub fn tell(&self) -> String {
        let o = self.outcome;
        let mut text = String::new();
        if let Some(signal) = self.interrupted {
            text += &format!("ended by {signal} with {} per pixel\n", count(o.samples.into(), "sample"));
        }
        if let Some((pixel, sample)) = o.dropped.first {
            text += &format!(
                "warning: {} not numbers or beyond the film's range and left out; the first at pixel {}, {}, \
                 sample {sample}\n",
                if o.dropped.count == 1 {
                    "1 sample was".into()
                } else {
                    format!("{} samples were", o.dropped.count)
                },
                pixel[0],
                pixel[1],
            );
        }
        if let (Some(noise), 1..) = (self.job.settings.noise, o.noisy_blocks) {
            text += &format!(
                "{} of 8 x 8 pixels {} noisier than {}: {}\n",
                count(o.noisy_blocks, "block"),
                if o.noisy_blocks == 1 { "is" } else { "are" },
                tell_percent(noise),
                if o.samples >= straal::MAX_SAMPLES {
                    format!("no pixel can have more than {}", count(straal::MAX_SAMPLES.into(), "sample"))
                } else {
                    format!("no pixel was given more than {}", count(o.samples.into(), "sample"))
                }
            );
        }
        if let Some(share) = o.clamped {
            let share = 100.0 * share;
            text += &format!(
                "clamped: {share:.2} % of the light was taken away, so that the picture is darker than the truth\n"
            );
        }
        if let Some(denoised) = &o.denoised {
            text += &tell_denoised(denoised, self.job.denoised_noise);
        }
        let names: Vec<String> =
            self.pictures.iter().chain(&self.kept.sums).map(|p| p.display().to_string()).collect();
        let mut facts = vec![count(o.samples.into(), "sample"), tell_duration(self.seconds)];
        if self.job.settings.adapts() {
            facts[0] += &format!(" at most, {:.1} on average", self.outcome.mean_samples);
        }
        facts.push(format!("{:.2} Mrays/s", self.mrays_per_second()));
        facts.extend(self.peak_memory_bytes.map(tell_bytes));
        text += &format!("wrote {}: {}\n", names.join(", "), facts.join(", "));
        if let Some(hash) = o.picture.tells("film_hash") {
            text += &format!("film hash {hash}\n");
        }
        text
    }

    /// For scripts.
    pub fn as_json(&self) -> Json {
        let o = self.outcome;
        let names: Vec<String> = self.pictures.iter().map(|p| p.to_string_lossy().into_owned()).collect();
        let crop = self.job.settings.crop;
        let corners = [crop.min, crop.max].concat();
        let million_samples = self.outcome.mean_samples * crop.area() as f64 / 1e6;
        let throughput = self.cpu_seconds.filter(|s| *s > 0.0).map(|s| million_samples / s);
        let first_dropped =
            o.dropped.first.map(|(pixel, sample)| json!({ "pixel": pixel, "sample": sample }));
        json!({
            "pictures": names,
            "film_hash": o.picture.tells("film_hash"),
            "scene_hash": self.job.scene_hash,
            "size": self.job.settings.size,
            "crop": corners,
            "samples": o.samples,
            "mean_samples": self.outcome.mean_samples,
            "passes": o.passes,
            "complete": o.complete,
            "interrupted": self.interrupted.is_some(),
            "signal": self.interrupted,
            "resumed_samples": self.kept.resumed,
            "checkpoint": self.kept.checkpoint.as_deref().map(|p| p.to_string_lossy().into_owned()),
            "checkpoints_written": self.kept.written,
            "sums": self.kept.sums.as_deref().map(|p| p.to_string_lossy().into_owned()),
            "seconds": self.seconds,
            "render_seconds": self.render_seconds,
            "cpu_seconds": self.cpu_seconds,
            "peak_memory_bytes": self.peak_memory_bytes,
            "rays": o.times.rays,
            "shadow_rays": o.times.shadow_rays,
            "mrays_per_second": self.mrays_per_second(),
            "million_samples_per_cpu_second": throughput,
            "threads": o.threads,
            "share_of_time": shares(&o.times),
            "noisy_blocks": o.noisy_blocks,
            "clamped": o.clamped,
            "denoised": o.denoised.as_ref().map(|d| json!({
                "weights": d.weights,
                "guides": d.guides,
                "noise": d.noise(),
                "share": d.weight,
                "fireflies": d.fireflies.map(|f| json!({ "pixels": f.pixels, "share": f.share })),
                "notes": d.notes,
            })),
            "dropped_primitives": self.job.world.dropped.iter().map(|d| d.count).sum::<usize>(),
            "dropped": { "count": o.dropped.count, "first": first_dropped },
            "isa": self.job.isa().name(),
            "structure": self.job.structure().name(),
            "version": straal::VERSION,
            "diagnostics": complaint::as_json(self.warnings),
        })
    }

    fn mrays_per_second(&self) -> f64 {
        let rays = self.outcome.times.rays + self.outcome.times.shadow_rays;
        if self.render_seconds > 0.0 { rays as f64 / self.render_seconds / 1e6 } else { 0.0 }
    }
}

/// What is said of a denoised picture, in lines.
fn tell_denoised(denoised: &Denoised, wanted: Option<f64>) -> String {
    let mut text: String =
        denoised.notes.iter().map(|note| format!("warning: denoising: {note}\n")).collect();
    if let Some(fireflies) = &denoised.fireflies {
        text += &format!("fireflies: {fireflies}\n");
    }
    let by = if denoised.guides.is_empty() { "light alone".to_owned() } else { denoised.guides.join(", ") };
    text += &format!("denoised by {} ({by})", denoised.weights);
    if let (Some(noise), Some(share)) = (denoised.noise(), denoised.weight) {
        let (noise, share) = (100.0 * noise, 100.0 * share);
        text += &format!(
            ", {share:.0} % of it on average; 19 of 20 blocks are within {noise:.2} % of the truth, by its own estimate"
        );
    }
    text += "\n";
    let noisier = wanted.map_or(0, |wanted| denoised.blocks_noisier_than(wanted));
    if let (Some(wanted), true) = (wanted, 20 * noisier > denoised.noise.len() as u64) {
        text += &format!(
            "{} of 8 x 8 pixels are noisier than {}\n",
            count(noisier, "block"),
            tell_percent(wanted)
        );
    }
    text
}

/// The part of each phase in the time of all.
fn shares(times: &Times) -> Json {
    let all: u64 = times.nanoseconds.iter().sum();
    let part = |ns: u64| if all > 0 { ns as f64 / all as f64 } else { 0.0 };
    let each = Phase::ALL.into_iter().zip(times.nanoseconds);
    Json::Object(each.map(|(phase, ns)| (phase.name().to_owned(), json!(part(ns)))).collect::<Map<_, _>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_parts_of_one() {
        let times = Times { nanoseconds: [1, 4, 3, 0, 2], ..Times::default() };
        let want = json!({ "camera": 0.1, "search": 0.4, "shading": 0.3, "lights": 0.0, "film": 0.2 });
        assert_eq!(shares(&times), want);
        assert_eq!(shares(&Times::default())["film"], 0.0);
    }
}
