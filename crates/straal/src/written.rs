//! A scene written out, with all that a command line says otherwise in it, so that it gives the same bits by itself.

use std::path::{Component, Path, PathBuf};

use serde_json::Value as Json;
use straal_color::Tone;
use straal_formats::load::Loaded;
use straal_formats::yaml;
use straal_math::lowdisc::PatternKind;
use straal_render::film::Recording;
use straal_scene::decode::Describe;
use straal_scene::desc;
use straal_scene::value::Depth;

use crate::development::{Development, Gamma};
use crate::resolve::{Error, Overrides};
use crate::{Dither, Gamut};

/// Whole numbers up to here are exact in a scene's text.
const EXACT: u64 = 1 << 53;

/// The scene that by itself gives the film that `wish` gives with the loaded one, developed by `development`. What changes the speed
/// only is left out of `wish`.
pub fn scene(loaded: &Loaded, wish: &Overrides, development: &Development) -> Result<desc::Scene, Error> {
    let mut scene = loaded.scene.clone();
    apply(&mut scene, wish)?;
    develop_as(&mut scene.film, development);
    Ok(scene)
}

/// The text of a scene as YAML that is kept in `folder`. `base` is the folder that the scene's files are named from.
pub fn text(scene: &desc::Scene, base: &Path, folder: &Path) -> String {
    let mut tree = scene.write();
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let folder = here.canonicalize().unwrap_or_else(|_| folder.to_owned());
    rebase(&mut tree, base, &folder);
    yaml::write(&tree)
}

/// What wins over the scene.
fn apply(scene: &mut desc::Scene, wish: &Overrides) -> Result<(), Error> {
    let (film, sampler) = (&mut scene.film, &mut scene.sampler);
    if let Some(size) = wish.size {
        // A crop is of the scene's own size.
        (film.size, film.crop) = (size, None);
    }
    film.crop = wish.crop.or(film.crop);
    film.splat = wish.splat.unwrap_or(film.splat);
    film.denoise = wish.denoise.clone().unwrap_or(film.denoise.clone());
    if let Some(recording) = wish.recording {
        film.channels = channels(recording);
    }
    sampler.spp = wish.spp.unwrap_or(sampler.spp);
    sampler.noise = wish.noise.or(sampler.noise);
    sampler.kind = wish.pattern.map_or_else(|| sampler.kind.clone(), kind);
    if let Some(seed) = wish.seed {
        if seed > EXACT {
            return Err(Error::Request(format!(
                "the seed {seed} can't be written into a scene, where numbers are exact up to {EXACT}"
            )));
        }
        sampler.seed = seed;
    }
    scene.spectral = wish.spectral.unwrap_or(scene.spectral);
    if let Some(integrator) = &wish.integrator {
        scene.integrator = integrator.clone();
    }
    match (wish.max_depth, &mut scene.integrator) {
        (Some(depth), desc::Integrator::Path(path)) => path.max_depth = Depth::Edges(depth),
        (Some(depth), desc::Integrator::Light(light)) => light.max_depth = Depth::Edges(depth),
        (Some(depth), desc::Integrator::Whitted(whitted)) => whitted.max_depth = depth,
        _ => {}
    }
    Ok(())
}

fn develop_as(film: &mut desc::Film, development: &Development) {
    film.exposure = development.exposure;
    film.tone = match development.tone {
        Tone::Clamp => desc::Tone::Clamp,
        Tone::ScaleToMaximum => desc::Tone::MaxToOne,
        Tone::Reinhard { white } => {
            let white = white.is_finite().then_some(f64::from(white));
            desc::Tone::Reinhard(desc::ReinhardCurve { white })
        }
        Tone::Hable { white } => desc::Tone::Hable(desc::HableCurve { white: shortest(white) }),
        Tone::Filmic => desc::Tone::Filmic,
        Tone::Aces => desc::Tone::Aces,
        Tone::Agx => desc::Tone::Agx,
        Tone::KhronosNeutral => desc::Tone::KhronosNeutral,
    };
    film.gamut = match development.gamut {
        Gamut::Clip => desc::Gamut::Clip,
        Gamut::Desaturate => desc::Gamut::Desaturate,
        Gamut::Flag(color) => {
            let color = straal_scene::value::LinearRgb(color.map(shortest));
            desc::Gamut::Flag(desc::Flag { color })
        }
    };
    film.gamma = match development.gamma {
        Gamma::Srgb => desc::Gamma::Srgb,
        Gamma::Power(gamma) => desc::Gamma::Power(shortest(gamma)),
    };
    film.bits = development.bits.number();
    film.dither = development.dither == Dither::On;
}

/// The number with the fewest digits that is the same in single precision.
fn shortest(v: f32) -> f64 {
    v.to_string().parse().unwrap_or(f64::from(v))
}

fn channels(recording: Recording) -> desc::Channels {
    match recording {
        Recording::Rgb => desc::Channels::Rgb,
        Recording::Xyz => desc::Channels::Xyz,
        Recording::Spectral(bands) => {
            let [from, to] = bands.ends();
            desc::Channels::Spectral(desc::SpectralChannels { bands: bands.count() as u32, from, to })
        }
    }
}

fn kind(pattern: PatternKind) -> desc::SamplerKind {
    match pattern {
        PatternKind::Sobol => desc::SamplerKind::Sobol,
        PatternKind::BlueSobol => desc::SamplerKind::BlueSobol,
        PatternKind::Halton => desc::SamplerKind::Halton,
        PatternKind::Hammersley => desc::SamplerKind::Hammersley,
        PatternKind::MultiJittered => desc::SamplerKind::MultiJittered,
        PatternKind::NRooks => desc::SamplerKind::NRooks,
        PatternKind::Jittered => desc::SamplerKind::Jittered,
        PatternKind::Regular => desc::SamplerKind::Regular,
        PatternKind::Random => desc::SamplerKind::Random,
    }
}

/// Files go by the key `file` wherever they are named; each is named as it is seen from another folder.
fn rebase(tree: &mut Json, base: &Path, folder: &Path) {
    match tree {
        Json::Object(map) => {
            for (key, value) in map {
                match value {
                    Json::String(file) if key == "file" => *file = seen_from(folder, &base.join(&*file)),
                    other => rebase(other, base, folder),
                }
            }
        }
        Json::Array(list) => list.iter_mut().for_each(|value| rebase(value, base, folder)),
        _ => {}
    }
}

/// How a file is reached from a folder: upwards to what their paths share, and down again. Where they share nothing, its full
/// path.
fn seen_from(folder: &Path, file: &Path) -> String {
    let file = file.canonicalize().unwrap_or_else(|_| file.to_owned());
    let shared = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    let is_apart = folder.components().take(shared).all(|c| !matches!(c, Component::Normal(_)));
    if is_apart {
        return file.display().to_string();
    }
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    let path: PathBuf = up.chain(file.components().skip(shared)).collect();
    path.components().map(|c| c.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_from_the_new_folder() {
        let seen = |folder: &str, file: &str| seen_from(Path::new(folder), Path::new(file));
        assert_eq!(seen("/no/such/a/b", "/no/such/a/m.ply"), "../m.ply");
        assert_eq!(seen("/no/such", "/no/such/a/m.ply"), "a/m.ply");
        assert_eq!(seen("/no/such", "/other/m.ply"), "/other/m.ply");
    }

    #[test]
    fn every_look_is_written_and_read_back() {
        for (tone, gamma) in Tone::ALL.into_iter().zip([Gamma::Srgb, Gamma::Power(2.2)].into_iter().cycle()) {
            let gamut = Gamut::Flag([1.0, 0.1, 0.0]);
            let development =
                Development { tone, gamma, gamut, dither: Dither::On, ..Development::default() };
            let mut film = desc::Film::default();
            develop_as(&mut film, &development);
            assert_eq!(Development::of(&film), development);
        }
        assert_eq!(shortest(2.2), 2.2);
    }

    #[test]
    fn every_pattern_has_its_name() {
        for pattern in PatternKind::ALL {
            assert_eq!(kind(pattern).kind(), pattern.name());
        }
    }
}
