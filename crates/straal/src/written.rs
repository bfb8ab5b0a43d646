//! A scene written out, with all that a command line says otherwise in it, so that it gives the same bits by itself.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use serde_json::Value as Json;
use straal_color::Tone;
use straal_formats::image::{pfm, png};
use straal_formats::load::Loaded;
use straal_formats::mesh::ply;
use straal_formats::photometry;
use straal_formats::yaml;
use straal_math::lowdisc::PatternKind;
use straal_render::film::Recording;
use straal_scene::bitmap::Number;
use straal_scene::decode::Describe;
use straal_scene::desc;
use straal_scene::value::Depth;
use straal_scene::{Bitmap, Image, Mesh, Photometry};

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
    rebase(&mut tree, base, &folder, &BTreeMap::new());
    yaml::write(&tree)
}

/// A scene of any format as one in the scene language, with what it holds itself in files of its own.
#[derive(Debug)]
pub struct Converted {
    /// The text of the scene.
    pub text: String,
    /// Meshes and pictures that stood in the scene's own file: the name of each, as the text has it, and what it is.
    pub pieces: Vec<(String, Piece)>,
}

/// What was held by a scene's own file.
#[derive(Clone, Debug)]
pub enum Piece {
    /// A mesh, to be written as PLY.
    Mesh(Arc<Mesh>),
    /// A picture that textures are read off: PNG, or EXR where it is light.
    Bitmap(Arc<Bitmap>),
    /// A picture of surroundings: PFM.
    Image(Arc<Image>),
    /// A lamp's intensities: IES.
    Lamp(Arc<Photometry>),
}

impl Piece {
    /// Writes it.
    pub fn write<W: Write>(&self, mut out: W) -> io::Result<()> {
        match self {
            Self::Mesh(mesh) => ply::write(out, mesh),
            Self::Image(image) => pfm::write(out, image),
            Self::Lamp(lamp) => photometry::write(out, lamp),
            Self::Bitmap(bitmap) => match png::write_codes(&mut out, bitmap) {
                Some(done) => done,
                None => {
                    let texels = &bitmap.texels;
                    let (width, height) = (texels.width(), texels.height());
                    let is_grey = texels.format().channels < 3;
                    let at = |i: usize| {
                        let [r, g, b, _] = texels.numbers(i % width, i / width);
                        if is_grey { [r; 3] } else { [r, g, b] }
                    };
                    let pixels = (0..width * height).map(at).collect();
                    pfm::write(out, &Image { width, height, pixels })
                }
            },
        }
    }

    fn extension(&self) -> &'static str {
        match self {
            Self::Mesh(_) => "ply",
            Self::Image(_) => "pfm",
            Self::Lamp(_) => "ies",
            Self::Bitmap(bitmap) => match bitmap.texels.format().number {
                Number::Byte | Number::Short => "png",
                Number::Half | Number::Single => "pfm",
            },
        }
    }
}

/// A loaded scene as a text that is kept in `folder`, and what goes into files of the folder `beside` in there. `base` is the folder that the
/// scene's files are named from.
pub fn converted(loaded: &Loaded, base: &Path, folder: &Path, beside: &str) -> Converted {
    let (scene, assets, held) = (&loaded.scene, &loaded.assets, &loaded.held);
    let mut found: BTreeMap<String, Piece> = BTreeMap::new();
    let is_held = |file: &str| held.contains(file);
    for asset in scene.mesh_files().into_iter().filter(|a| is_held(&a.file)) {
        found.insert(asset.file.value.clone(), Piece::Mesh(assets.mesh(asset.handle).mesh.clone()));
    }
    for asset in scene.image_files().into_iter().filter(|a| is_held(&a.file)) {
        found.insert(asset.file.value.clone(), Piece::Image(assets.image(asset.handle).clone()));
    }
    for asset in scene.bitmap_files().into_iter().filter(|a| is_held(&a.file)) {
        found.insert(asset.file.value.clone(), Piece::Bitmap(assets.bitmap(asset.handle).clone()));
    }
    for asset in scene.photometry_files().into_iter().filter(|a| is_held(&a.file)) {
        found.insert(asset.file.value.clone(), Piece::Lamp(assets.photometry(asset.handle).clone()));
    }
    let (mut names, mut pieces) = (BTreeMap::new(), Vec::new());
    let mut taken = BTreeSet::new();
    for (name, piece) in found {
        let plain = plain(&name);
        let mut file = format!("{beside}/{plain}.{}", piece.extension());
        let mut count = 1;
        while !taken.insert(file.to_lowercase()) {
            count += 1;
            file = format!("{beside}/{plain}-{count}.{}", piece.extension());
        }
        names.insert(name, file.clone());
        pieces.push((file, piece));
    }
    let mut tree = scene.write();
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let folder = here.canonicalize().unwrap_or_else(|_| folder.to_owned());
    rebase(&mut tree, base, &folder, &names);
    Converted { text: yaml::write(&tree), pieces }
}

/// What is behind the last `#` of a name, of letters that every system has in file names.
fn plain(name: &str) -> String {
    const MOST: usize = 80;
    let name = name.rsplit('#').next().unwrap_or(name);
    let mut out = String::new();
    for c in name.chars().take(MOST) {
        let c = if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '-' };
        if !(c == '-' && (out.is_empty() || out.ends_with('-'))) {
            out.push(c);
        }
    }
    let out = out.trim_end_matches('-');
    if out.is_empty() { "piece".to_owned() } else { out.to_owned() }
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

/// Files go by the key `file` wherever they are named; each is named as it is seen from another folder, or by its new name.
fn rebase(tree: &mut Json, base: &Path, folder: &Path, names: &BTreeMap<String, String>) {
    match tree {
        Json::Object(map) => {
            for (key, value) in map {
                match value {
                    Json::String(file) if key == "file" => {
                        *file = match names.get(file) {
                            Some(name) => name.clone(),
                            None => seen_from(folder, &base.join(&*file)),
                        };
                    }
                    other => rebase(other, base, folder, names),
                }
            }
        }
        Json::Array(list) => list.iter_mut().for_each(|value| rebase(value, base, folder, names)),
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
    fn pieces_have_plain_names() {
        assert_eq!(plain("Box.glb#meshes[0].primitives[1]"), "meshes-0-primitives-1");
        assert_eq!(
            [plain("a.glb#images[2] ../Größe "), plain("#"), plain("x/..")],
            ["images-2-Gr-e", "piece", "x"]
        );
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
