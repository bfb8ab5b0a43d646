//! The book's pictures of one scene in several ways: under each tone curve, with the curves themselves; blurred by depth; filtered in two ways;
//! by each integrator, and by each for the same time; by shadow rays or samples; noisy, denoised and true; with other lamps.

use crate::{Failure, root};
use std::fmt::Write;
use std::time::{Duration, Instant};
use straal::develop::PictureFile;
use straal::focus::{Blur, Lens};
use straal::relight::Relight;
use straal::{Control, Development, Job, LoadOptions, Overrides, Progress, Verdict};
use straal_color::{Tone, srgb};
use straal_math::ops;
use straal_scene::desc::{
    AmbientOcclusion, Camera, Denoise, DirectLight, Directions, Filter, Gaussian, Integrator, PathTracer,
    Technique, Whitted,
};

const FOLDER: &str = "book/src/images";
const SCENE: &str = "scenes/bright-colours.yaml";
const SIZE: [u32; 2] = [320, 180];

/// The scene that is blurred as its own lens would.
const BLURRED: &str = "scenes/depth-of-field.yaml";

/// The scene that shows the two ways to filter.
const FILTERED: &str = "scenes/lights.yaml";

/// The scene that shows the integrators, the size in which it does, and each with its samples a pixel.
const WAYS: &str = "scenes/ways-of-light.yaml";
const WAYS_SIZE: [u32; 2] = [480, 270];
const EPSILONS: [(&str, f64); 2] = [("epsilon-small", 1e-7), ("epsilon-large", 0.1)];
const INTEGRATORS: [(&str, u32); 5] =
    [("whitted", 64), ("ao", 256), ("direct", 256), ("light", 1024), ("path", 256)];

/// Of the same scene a hundred shadow rays for each pixel in two ways: samples, and rays of each.
const RAYS_SIZE: [u32; 2] = [320, 180];
const RAYS: [(&str, u32, u32); 2] = [("rays-100", 1, 100), ("samples-100", 100, 1)];

/// And direct light as a sum over the hemisphere, and over the lamp.
const FORMS: [(&str, Technique, Directions); 2] = [
    ("form-hemisphere", Technique::Bsdf, Directions::Uniform),
    ("form-area", Technique::Lights, Directions::Bsdf),
];

/// And the ladder of integrators: each for so many seconds of one thread, and the truth with so many samples.
const LADDER_SIZE: [u32; 2] = [240, 135];
const LADDER_SECONDS: f64 = 2.0;
const LADDER_TRUTH: u32 = 1024;

/// The scene that is denoised, the size in which it is, and each of its pictures: samples, and what becomes of them.
const DENOISED: &str = "scenes/glass-and-mirror.yaml";
const DENOISED_SIZE: [u32; 2] = [320, 180];
const DENOISINGS: [(&str, u32, Denoise); 3] =
    [("noisy", 16, Denoise::Off), ("clean", 16, Denoise::Best), ("truth", 512, Denoise::Off)];

/// The scene that is relit, in that size, and each of its pictures: what becomes of its groups of lights.
const RELIT: &str = "scenes/lights.yaml";
const RELIT_SIZE: [u32; 2] = [480, 270];
const RELIGHTINGS: [(&str, &[&str]); 3] = [
    ("plain", &[]),
    ("dusk", &["sun=off", "sky=0.3,cool", "ball=2"]),
    ("stage", &["stage=#ff4020", "bulb=off", "strip=3,warm"]),
];

/// Makes the pictures of one kind.
type Make = fn() -> Result<(), Failure>;

/// Makes the pictures, or those of some kinds.
pub fn run(names: &[String]) -> Result<bool, Failure> {
    let kinds: [(&str, Make); 8] = [
        ("tones", tones),
        ("blur", blurred),
        ("filters", filtered),
        ("integrators", by_each_integrator),
        ("rays", by_rays_and_samples),
        ("ladder", ladder),
        ("denoising", denoised),
        ("relighting", relit),
    ];
    if let Some(other) = names.iter().find(|name| !kinds.iter().any(|(kind, _)| kind == name)) {
        return Err(format!(
            "there are no pictures of `{other}`, only of {}",
            kinds.map(|(kind, _)| kind).join(", ")
        )
        .into());
    }
    for (kind, make) in kinds {
        if names.is_empty() || names.iter().any(|name| name == kind) {
            make()?;
        }
    }
    Ok(true)
}

/// One render, and what it would have been with other lamps.
fn relit() -> Result<(), Failure> {
    let loaded = straal::load(&root().join(RELIT), &LoadOptions::default())
        .map_err(|_| format!("the scene is wrong; see `straal check {RELIT}`"))?;
    let job = Job::new(loaded, Overrides { size: Some(RELIT_SIZE), ..Overrides::default() })?;
    let picture = job.render(&mut Control::to_the_end())?.picture;
    for (name, changes) in RELIGHTINGS {
        let mut picture_file = PictureFile::from(&picture);
        let changes = changes.iter().map(|change| change.parse()).collect::<Result<Vec<Relight>, _>>()?;
        picture_file.relight(&changes)?;
        let file = format!("{FOLDER}/relight-{name}.png");
        picture_file.save(&root().join(&file), &job.development())?;
        println!("{file}");
    }
    Ok(())
}

/// Renders the scene once and develops it by every curve; draws the curves.
fn tones() -> Result<(), Failure> {
    let loaded = straal::load(&root().join(SCENE), &LoadOptions::default())
        .map_err(|_| format!("the scene is wrong; see `straal check {SCENE}`"))?;
    let job = Job::new(loaded, Overrides { size: Some(SIZE), ..Overrides::default() })?;
    let picture = job.render(&mut Control::to_the_end())?.picture;
    for tone in Tone::ALL {
        let file = format!("{FOLDER}/tone-{}.png", tone.name().replace('_', "-"));
        picture.save(&root().join(&file), &Development { tone, ..job.development() })?;
        println!("{file}");
    }
    let file = format!("{FOLDER}/tone-curves.svg");
    std::fs::write(root().join(&file), curves())?;
    println!("{file}");
    Ok(())
}

/// One room by each integrator, and by the textbook's with rays that start too near and too far.
fn by_each_integrator() -> Result<(), Failure> {
    let loaded = straal::load(&root().join(WAYS), &LoadOptions::default())
        .map_err(|_| format!("the scene is wrong; see `straal check {WAYS}`"))?;
    let usual = INTEGRATORS.map(|(name, spp)| {
        let integrator = match Integrator::bare(name) {
            // In a closed room every ray ends at a wall.
            Some(Integrator::Ao(ao)) => Some(Integrator::Ao(AmbientOcclusion { radius: Some(1.0), ..ao })),
            other => other,
        };
        (name, spp, integrator)
    });
    let false_starts = EPSILONS.map(|(name, epsilon)| {
        let integrator = Integrator::Whitted(Whitted { epsilon: Some(epsilon), ..Whitted::default() });
        (name, 64, Some(integrator))
    });
    for (name, spp, integrator) in usual.into_iter().chain(false_starts) {
        // Light that the balls gather takes long to become clean.
        let denoise = (name == "path").then_some(Denoise::Best);
        let wish =
            Overrides { size: Some(WAYS_SIZE), spp: Some(spp), integrator, denoise, ..Overrides::default() };
        let job = Job::new(loaded.clone(), wish)?;
        let picture = job.render(&mut Control::to_the_end())?.picture;
        let file = format!("{FOLDER}/ways-{name}.png");
        picture.save(&root().join(&file), &job.development())?;
        println!("{file}");
    }
    Ok(())
}

/// Renders a job to a picture of the book.
fn draw(job: &Job, file: &str) -> Result<(), Failure> {
    let picture = job.render(&mut Control::to_the_end())?.picture;
    picture.save(&root().join(file), &job.development())?;
    println!("{file}");
    Ok(())
}

/// A hundred shadow rays of one sample of the pixel, and one of a hundred; the two forms of direct light.
fn by_rays_and_samples() -> Result<(), Failure> {
    let loaded = straal::load(&root().join(WAYS), &LoadOptions::default())
        .map_err(|_| format!("the scene is wrong; see `straal check {WAYS}`"))?;
    let by_rays = RAYS.map(|(name, spp, light_samples)| {
        (name, spp, DirectLight { technique: Technique::Lights, light_samples, ..DirectLight::default() })
    });
    let by_form = FORMS.map(|(name, technique, directions)| {
        (name, 16, DirectLight { technique, directions, ..DirectLight::default() })
    });
    for (name, spp, integrator) in by_rays.into_iter().chain(by_form) {
        let integrator = Integrator::Direct(integrator);
        let (size, spp, integrator) = (Some(RAYS_SIZE), Some(spp), Some(integrator));
        let job = Job::new(loaded.clone(), Overrides { size, spp, integrator, ..Overrides::default() })?;
        draw(&job, &format!("{FOLDER}/{name}.png"))?;
    }
    Ok(())
}

/// Each step from the textbook's ray tracer to all light, for the same time; how far it is from the truth is printed, for the captions.
fn ladder() -> Result<(), Failure> {
    let loaded = straal::load(&root().join(WAYS), &LoadOptions::default())
        .map_err(|_| format!("the scene is wrong; see `straal check {WAYS}`"))?;
    let path = |technique| Integrator::Path(PathTracer { technique, ..PathTracer::default() });
    let job = |integrator, spp, seed| {
        let (size, spp, seed) = (Some(LADDER_SIZE), Some(spp), Some(seed));
        let (integrator, threads) = (Some(integrator), Some(1));
        Job::new(loaded.clone(), Overrides { size, spp, seed, integrator, threads, ..Overrides::default() })
    };
    let truth = job(path(Technique::Mis), LADDER_TRUTH, 1)?.render(&mut Control::to_the_end())?.picture;
    let truth = &truth.layers.rgb;
    let rungs = [
        ("whitted", Integrator::Whitted(Whitted::default())),
        ("ao", Integrator::Ao(AmbientOcclusion { radius: Some(1.0), ..AmbientOcclusion::default() })),
        ("direct", Integrator::Direct(DirectLight::default())),
        ("path-bsdf", path(Technique::Bsdf)),
        ("path-lights", path(Technique::Lights)),
        ("path-mis", path(Technique::Mis)),
        ("light", Integrator::bare("light").ok_or("there is no integrator `light`")?),
    ];
    for (name, integrator) in rungs {
        let job = job(integrator, 1 << 17, 0)?;
        let start = Instant::now();
        let time = Duration::from_secs_f64(LADDER_SECONDS);
        let mut ends = |_: &Progress| if start.elapsed() < time { Verdict::GoOn } else { Verdict::Stop };
        let outcome = job.render(&mut Control::new(&mut ends))?;
        let shown = outcome.picture.layers.rgb.iter().flatten();
        let off: f64 = shown.zip(truth.iter().flatten()).map(|(a, b)| f64::from((a - b).abs())).sum();
        let all: f64 = truth.iter().flatten().map(|v| f64::from(*v)).sum();
        let file = format!("{FOLDER}/ladder-{name}.png");
        outcome.picture.save(&root().join(&file), &job.development())?;
        println!(
            "{file}: {} samples a pixel, {:.1} % off the truth on average",
            outcome.samples,
            100.0 * off / all
        );
    }
    Ok(())
}

/// Few samples, what the denoiser makes of them, and the truth.
fn denoised() -> Result<(), Failure> {
    let loaded = straal::load(&root().join(DENOISED), &LoadOptions::default())
        .map_err(|_| format!("the scene is wrong; see `straal check {DENOISED}`"))?;
    for (name, spp, denoise) in DENOISINGS {
        let (size, spp, denoise) = (Some(DENOISED_SIZE), Some(spp), Some(denoise));
        let job = Job::new(loaded.clone(), Overrides { size, spp, denoise, ..Overrides::default() })?;
        draw(&job, &format!("{FOLDER}/denoise-{name}.png"))?;
    }
    Ok(())
}

/// The same few samples, each in one pixel and in all that the filter reaches from.
fn filtered() -> Result<(), Failure> {
    let mut loaded = straal::load(&root().join(FILTERED), &LoadOptions::default())
        .map_err(|_| format!("the scene is wrong; see `straal check {FILTERED}`"))?;
    loaded.scene.film.filter = Filter::Gaussian(Gaussian::default());
    for (name, splat) in [("drawn", false), ("splatted", true)] {
        let (size, spp, splat) = (Some(SIZE), Some(4), Some(splat));
        let job = Job::new(loaded.clone(), Overrides { size, spp, splat, ..Overrides::default() })?;
        draw(&job, &format!("{FOLDER}/filter-{name}.png"))?;
    }
    Ok(())
}

/// A scene seen through a pinhole, blurred by its depth as much as its lens blurs it: to be shown beside what the lens sees.
fn blurred() -> Result<(), Failure> {
    let mut loaded = straal::load(&root().join(BLURRED), &LoadOptions::default())
        .map_err(|_| format!("the scene is wrong; see `straal check {BLURRED}`"))?;
    let seen = Job::new(loaded.clone(), Overrides::default())?.camera().focus.ok_or("there is no lens")?;
    if let Camera::Perspective(camera) = &mut loaded.scene.camera {
        camera.lens = None;
    }
    let job = Job::new(loaded, Overrides::default())?;
    let mut picture_file = PictureFile::from(&job.render(&mut Control::to_the_end())?.picture);
    let focal_pixels = picture_file.focal_pixels().ok_or("the camera doesn't magnify")?;
    let lens = Lens { focus: seen.distance, radius: seen.radius };
    picture_file.blur(&Blur { lens, focal_pixels })?;
    let file = format!("{FOLDER}/blur-by-depth.png");
    picture_file.save(&root().join(&file), &job.development())?;
    println!("{file}");
    Ok(())
}

/// Stops around middle grey, 0.18, across; the signal of an sRGB screen up.
const STOPS: [f32; 2] = [-8.0, 7.0];
const PLOT: [f32; 4] = [50.0, 15.0, 520.0, 300.0];

/// The curves that change greys; max-to-one is the clamp there.
fn curves() -> String {
    let [left, top, width, height] = PLOT;
    let x = |stops: f32| left + (stops - STOPS[0]) / (STOPS[1] - STOPS[0]) * width;
    let y = |signal: f32| top + (1.0 - signal) * height;
    let mut out = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 760 370\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"760\" height=\"370\" fill=\"white\"/>\n",
    );
    for stops in (STOPS[0] as i32..=STOPS[1] as i32).step_by(2) {
        let x = x(stops as f32);
        let _ = writeln!(
            out,
            "<path d=\"M{x:.1} {top}V{}\" stroke=\"#ddd\"/>\n<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{stops}</text>",
            top + height,
            top + height + 17.0
        );
    }
    for tenths in (0..=10_u8).step_by(2) {
        let v = f32::from(tenths) / 10.0;
        let y = y(v);
        let _ = writeln!(
            out,
            "<path d=\"M{left} {y:.1}H{}\" stroke=\"#ddd\"/>\n<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{v}</text>",
            left + width,
            left - 6.0,
            y + 4.0
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">light in stops from middle grey</text>",
        left + 0.5 * width,
        top + height + 38.0
    );
    let drawn = Tone::ALL.into_iter().filter(|t| *t != Tone::ScaleToMaximum);
    let colours = ["#444444", "#1f77b4", "#2ca02c", "#ff7f0e", "#d62728", "#9467bd", "#17a2b8"];
    for (i, (tone, colour)) in drawn.zip(colours).enumerate() {
        let points = (0..=150_u8).map(|k| {
            let stops = STOPS[0] + (STOPS[1] - STOPS[0]) * f32::from(k) / 150.0;
            let shown = tone.apply([0.18 * ops::exp2(stops); 3])[1];
            format!("{:.1},{:.1}", x(stops), y(srgb::encode(shown)))
        });
        let points: Vec<String> = points.collect();
        let (key_x, key_y) = (left + width + 20.0, top + 20.0 + 22.0 * i as f32);
        let _ = writeln!(
            out,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>\n\
             <path d=\"M{key_x} {key_y}h24\" stroke=\"{colour}\" stroke-width=\"2\"/>\n\
             <text x=\"{}\" y=\"{}\">{}</text>",
            points.join(" "),
            key_x + 32.0,
            key_y + 4.0,
            tone.name()
        );
    }
    out + "</svg>\n"
}
