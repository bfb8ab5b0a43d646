//! Replicates: the same picture from independent seeds, so that its variance is measured and not modelled.

use crate::job::{Control, Job, Outcome};
use crate::picture::Picture;
use crate::resolve::Error;
use straal_color::spectrum::Bands;
use straal_render::film::channel;
use straal_render::film::{
    BandLayers, Channel, ChannelLayer, Dropped, ErrorEstimate, ErrorLayer, GroupLayer, Layers,
};
use straal_render::settings::Settings;
use straal_render::stopwatch::Times;

/// Distance of the replicates' seeds: odd, and far from what people type.
const SEED_STEP: u64 = 0x9e37_79b9_7f4a_7c15;

impl Job {
    /// Renders `replicates` independently seeded sets of the job's samples; the picture is their mean, its variance
    /// layer the variance *of that mean*, estimated from their spread with `replicates` - 1 degrees of freedom, and its error layer the root of that.
    ///
    /// The first replicate is the picture that [`Job::render`] gives. A render that is stopped keeps its whole
    /// replicates only; with fewer than two there is no variance, and it is 0.
    pub fn render_replicates(&self, replicates: u32, control: &mut Control<'_>) -> Result<Outcome, Error> {
        if self.first > 0 || control.resume.is_some() || control.keep.is_some() {
            return Err(Error::Request(
                "replicates are sets of samples from the first on, whose means are put together: their sums can't be kept or \
                 taken up again"
                    .into(),
            ));
        }
        let pixels = self.settings.crop.area() as u64;
        self.check_room(pixels.saturating_mul(Sums::bytes_a_pixel(&self.settings)))?;
        let mut progress = self.progress();
        progress.of = u64::from(self.spp) * u64::from(replicates);
        let mut sums: Option<Sums> = None;
        let (mut times, mut passes, mut threads, mut dropped) = (Times::default(), 0, 0, Dropped::default());
        let (mut whole, mut noisy_blocks, mut mean_samples) = (0, 0, 0.0);
        let mut partial = None;
        for r in 0..replicates {
            let seed = self.settings.seed.wrapping_add(u64::from(r).wrapping_mul(SEED_STEP));
            let run = self.film(seed, self.spp, control, &mut progress)?;
            passes += run.passes;
            threads = run.threads;
            times += run.times;
            noisy_blocks += self.noisy_blocks(&run.film);
            let d = run.film.dropped();
            dropped = Dropped { count: dropped.count + d.count, first: dropped.first.or(d.first) };
            let layers = run.film.layers();
            if !run.complete {
                if whole == 0 {
                    mean_samples = run.film.mean_samples();
                    partial = Some((Picture::new(&run.film, layers, self.film_space()), run.samples));
                }
                break;
            }
            whole += 1;
            mean_samples += run.film.mean_samples();
            sums.get_or_insert_with(|| {
                let sums = Sums::new(Picture::new(&run.film, Layers::default(), self.film_space()));
                Sums { tells_error: self.integrator.splats(), ..sums }
            })
            .add(&layers);
        }
        let (mut picture, samples) = match (sums, partial) {
            (Some(sums), _) => (sums.picture(whole), self.spp.saturating_mul(whole)),
            (None, Some(partial)) => partial,
            (None, None) => return Err(Error::Request("0 replicates: there must be at least 1".into())),
        };
        picture.metadata = self.metadata(samples);
        picture.metadata.push(("straal.replicates".into(), whole.to_string()));
        picture.metadata.push(("straal.passes".into(), passes.to_string()));
        picture.metadata.push(("straal.film_hash".into(), straal_render::film::hash_of(&picture.layers.rgb)));
        let complete = whole == replicates;
        let clamped = picture.layers.clamped();
        Ok(Outcome {
            clamped,
            picture,
            samples,
            mean_samples,
            passes,
            complete,
            noisy_blocks,
            denoised: None,
            times,
            threads,
            dropped,
        })
    }
}

/// Sums over replicates in double precision, in the order of the replicates.
struct Sums {
    frame: Picture,
    rgb: Vec<[f64; 3]>,
    /// Sum of squared differences from the mean so far (Welford 1962): small variances of bright pixels survive.
    spread: Vec<[f64; 3]>,
    samples: Vec<u32>,
    /// Whatever else films hold.
    channels: Vec<(&'static Channel, Vec<f64>)>,
    tells_error: bool,
    /// Light by wavelengths.
    bands: Option<(Bands, Vec<Vec<f64>>)>,
    /// Light by groups of lights.
    groups: Vec<(String, Vec<[f64; 3]>)>,
    count: f64,
}

impl Sums {
    /// Bytes that they take for each pixel.
    fn bytes_a_pixel(of: &Settings) -> u64 {
        let colours = size_of::<[f64; 3]>();
        let spread = if of.layers || of.error { colours } else { 0 };
        let samples = if of.layers { size_of::<u32>() } else { 0 };
        let numbers: usize = channel::held(of.layers, of.cost).map(|(_, c)| c.components.len()).sum();
        (colours * (2 + of.light_groups) + spread + samples + numbers * size_of::<f64>()) as u64
    }

    fn new(frame: Picture) -> Self {
        let n = frame.crop.area();
        Self {
            frame,
            rgb: vec![[0.0; 3]; n],
            spread: Vec::new(),
            samples: Vec::new(),
            channels: Vec::new(),
            tells_error: false,
            bands: None,
            groups: Vec::new(),
            count: 0.0,
        }
    }

    fn add(&mut self, l: &Layers) {
        self.count += 1.0;
        // What single pictures can't tell, several do.
        self.tells_error |= l.error.is_some();
        if self.channels.is_empty() {
            self.channels = l.channels.iter().map(|l| (l.channel, vec![0.0; l.values.len()])).collect();
        }
        for ((_, sums), layer) in self.channels.iter_mut().zip(&l.channels) {
            sums.iter_mut().zip(&layer.values).for_each(|(sum, v)| *sum += f64::from(*v));
        }
        if let Some(BandLayers { bands, planes }) = &l.bands {
            let nothing = || (*bands, planes.iter().map(|plane| vec![0.0; plane.len()]).collect());
            let (_, sums) = self.bands.get_or_insert_with(nothing);
            for (sum, v) in sums.iter_mut().flatten().zip(planes.iter().flatten()) {
                *sum += f64::from(*v);
            }
        }
        if self.groups.is_empty() {
            let nothing = |group: &GroupLayer| (group.name.clone(), vec![[0.0; 3]; group.rgb.len()]);
            self.groups = l.groups.iter().map(nothing).collect();
        }
        for ((_, sums), group) in self.groups.iter_mut().zip(&l.groups) {
            let all = sums.as_flattened_mut().iter_mut().zip(group.rgb.as_flattened());
            all.for_each(|(sum, v)| *sum += f64::from(*v));
        }
        // A picture that keeps to colours has none of the other layers.
        let held = l.samples.len();
        let spreads = if self.tells_error { self.rgb.len() } else { held };
        self.spread.resize(spreads, [0.0; 3]);
        self.samples.resize(held, 0);
        for i in 0..self.rgb.len() {
            for c in 0..3 {
                let v = f64::from(l.rgb[i][c]);
                let before = v - self.rgb[i][c];
                self.rgb[i][c] += before / self.count;
                if let Some(spread) = self.spread.get_mut(i) {
                    spread[c] += before * (v - self.rgb[i][c]);
                }
            }
        }
        self.samples.iter_mut().zip(&l.samples).for_each(|(sum, n)| *sum += n);
    }

    fn picture(self, replicates: u32) -> Picture {
        let n = f64::from(replicates);
        let round = |v: &[f64; 3]| v.map(|x| x as f32);
        let mean = |sums: Vec<f64>| sums.into_iter().map(|v| (v / n) as f32).collect();
        let of_mean = |v: &[f64; 3]| {
            if replicates < 2 { [0.0; 3] } else { v.map(|x| (x / (n * (n - 1.0))) as f32) }
        };
        let mut variance: Vec<[f32; 3]> = self.spread.iter().map(of_mean).collect();
        let error = || ErrorLayer {
            estimate: ErrorEstimate::Replicates,
            rgb: variance.iter().map(|v| v.map(f32::sqrt)).collect(),
        };
        let error = self.tells_error.then(error);
        if self.samples.is_empty() {
            variance.clear();
        }
        let layers = Layers {
            width: self.frame.crop.width() as usize,
            height: self.frame.crop.height() as usize,
            rgb: self.rgb.iter().map(round).collect(),
            error,
            variance,
            samples: self.samples,
            channels: { self.channels.into_iter() }
                .map(|(channel, sums)| ChannelLayer { channel, values: mean(sums) })
                .collect(),
            bands: self
                .bands
                .map(|(bands, sums)| BandLayers { bands, planes: sums.into_iter().map(mean).collect() }),
            groups: { self.groups.into_iter() }
                .map(|(name, sums)| {
                    let mean = |v: [f64; 3]| v.map(|x| (x / n) as f32);
                    GroupLayer { name, rgb: sums.into_iter().map(mean).collect() }
                })
                .collect(),
        };
        Picture { layers, ..self.frame }
    }
}
