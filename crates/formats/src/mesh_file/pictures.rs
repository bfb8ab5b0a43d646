//! The pictures that the materials of a mesh name: where they are, and what they become as textures.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use straal_scene::Bitmap;
use straal_scene::bitmap::Number;
use straal_scene::desc::{
    ImageTexture, Mapping, NormalMap, RemapTexture, Spectrum, Texture, TextureChannel, TextureFilter,
    TextureOf, TextureSpace, UvMapping, Varying, Wrap, Wraps,
};
use straal_scene::handle::Handles;
use straal_scene::value::Asset;

use crate::files::{Finder, Refusal};
use crate::mesh::mtl::{MtlChannel, MtlMap, MtlMaterial, MtlUse};
use crate::read_error::quoted;
use crate::{Limits, image};

/// A picture that a mesh's materials name.
#[derive(Clone, Debug)]
pub struct Picture {
    /// What materials call it.
    pub asset: Asset<Bitmap>,
    /// Where it is.
    pub path: PathBuf,
}

/// Finds the pictures of a mesh.
pub(super) struct Pictures<'a> {
    pub folder: &'a Path,
    pub limits: &'a Limits,
    pub finder: &'a mut Finder,
    /// Gives what is met first a place among a scene's pictures.
    pub handles: &'a mut Handles,
    /// Those that were found, each once.
    pub found: Vec<Picture>,
    /// By name: which it is and what its first bytes tell; none where it can't be read.
    known: BTreeMap<String, Option<(usize, image::Header)>>,
    /// What is told.
    pub told: Vec<String>,
    /// The first that must not be read.
    pub refusal: Option<Refusal>,
}

/// No more is told of pictures.
const MOST_TOLD: usize = 50;

/// What a material's numbers and colours are read off.
#[derive(Default)]
pub(super) struct Maps {
    textures: BTreeMap<MtlUse, Texture>,
    /// What makes it look rough: normals, or heights and what they are multiplied by.
    pub normals: Option<NormalMap>,
    pub heights: Option<(Texture, f64)>,
}

impl<'a> Pictures<'a> {
    pub fn new(
        folder: &'a Path,
        limits: &'a Limits,
        finder: &'a mut Finder,
        handles: &'a mut Handles,
    ) -> Self {
        let (found, known, told) = (Vec::new(), BTreeMap::new(), Vec::new());
        Self { folder, limits, finder, handles, found, known, told, refusal: None }
    }

    /// Those of a material; nothing where the mesh has no texture coordinates by which they would lie on it.
    pub fn of(&mut self, name: &str, m: &MtlMaterial, has_uvs: bool) -> Maps {
        let mut maps = Maps::default();
        if !has_uvs && !m.maps.is_empty() {
            self.tell(format!(
                "the pictures of {} have no effect, as the mesh has no texture coordinates",
                quoted(name.as_bytes())
            ));
            return maps;
        }
        for (of, map) in &m.maps {
            let Some((i, header)) = self.find(&map.file, name) else { continue };
            let asset = self.found[i].asset.clone();
            let is_grey = header.texel.channels < 3;
            let channel = match map.channel {
                Some(MtlChannel::Red) => TextureChannel::Red,
                Some(MtlChannel::Green) => TextureChannel::Green,
                Some(MtlChannel::Blue) => TextureChannel::Blue,
                Some(MtlChannel::Alpha) => TextureChannel::Alpha,
                // What is cut out is told by alpha where there is one.
                None if *of == MtlUse::Dissolve && header.channels.is_multiple_of(2) => TextureChannel::Alpha,
                Some(MtlChannel::Luminance) | None => TextureChannel::Luminance,
            };
            let texture = texture(asset, map, channel);
            match of {
                MtlUse::Normal => maps.normals = Some(normals(texture)),
                MtlUse::Bump if !is_grey && map.channel.is_none() && self.holds_normals(i) => {
                    maps.normals
                        .get_or_insert(NormalMap { strength: f64::from(map.bump), ..normals(texture) });
                }
                MtlUse::Bump => maps.heights = Some((texture, f64::from(map.bump))),
                _ => {
                    maps.textures.insert(*of, texture);
                }
            }
        }
        maps
    }

    /// Which picture goes by a name, with what its first bytes tell; `None` where it can't be read, which is told.
    fn find(&mut self, name: &str, material: &str) -> Option<(usize, image::Header)> {
        if let Some(known) = self.known.get(name) {
            return *known;
        }
        let found = self.look_for(name).map_err(|problem| {
            let (name, material) = (quoted(name.as_bytes()), quoted(material.as_bytes()));
            self.tell(format!("the picture {name} has no effect ({material}): {problem}"));
        });
        let found = found.ok();
        self.known.insert(name.to_owned(), found);
        found
    }

    fn look_for(&mut self, name: &str) -> Result<(usize, image::Header), String> {
        let found = match self.finder.find(self.folder, name) {
            Err(refusal) if refusal.is_missing() => match self.finder.find_beside(self.folder, name) {
                Ok(Some(found)) => Ok(found),
                Ok(None) => Err(refusal),
                Err(other) => Err(other),
            },
            found => found,
        };
        let found = found.map_err(|refusal| {
            if !refusal.is_missing() {
                self.refusal.get_or_insert(refusal.clone());
            }
            refusal.problem
        })?;
        let header = image::Header::open(&found.path, self.limits).map_err(|e| e.to_string())?;
        if let Some(instead) = &found.instead {
            let (name, instead) = (quoted(name.as_bytes()), quoted(instead.as_bytes()));
            self.tell(format!("there is no picture {name}: {instead} is read"));
        }
        // No scene writes such a name.
        let key = format!("\0{}", found.path.display());
        let handle = self.handles.of::<Bitmap>(&key);
        let known = self.found.iter().position(|p| p.asset.handle == handle);
        let place = known.unwrap_or_else(|| {
            let asset = Asset::new(found.path.display().to_string(), handle);
            self.found.push(Picture { asset, path: found.path });
            self.found.len() - 1
        });
        Ok((place, header))
    }

    /// Whether a picture that is called a bump map holds normals, as many programs write them: bluish all over, and neither red nor green.
    fn holds_normals(&self, picture: usize) -> bool {
        let read = || {
            let bytes = image::bytes(&self.found[picture].path, self.limits).ok()?;
            image::bitmap(&bytes, self.limits).ok()
        };
        let Some((bitmap, _)) = read() else { return false };
        let (w, h) = (bitmap.texels.width(), bitmap.texels.height());
        let most = match bitmap.texels.format().number {
            Number::Byte => 255.0,
            Number::Short => 65_535.0,
            Number::Half | Number::Single => 1.0,
        };
        /// So many are looked at across and down.
        const TRIED: usize = 32;
        let mut sum = [0.0_f64; 3];
        for i in 0..TRIED * TRIED {
            let texel = bitmap.texels.numbers((i % TRIED) * w / TRIED, (i / TRIED) * h / TRIED);
            (0..3).for_each(|c| sum[c] += f64::from(texel[c]) / most / (TRIED * TRIED) as f64);
        }
        let is_level = |v: f64| (0.4..=0.6).contains(&v);
        is_level(sum[0]) && is_level(sum[1]) && sum[2] > 0.7
    }

    fn tell(&mut self, what: String) {
        if self.told.len() < MOST_TOLD {
            self.told.push(what);
        }
    }
}

fn texture(file: Asset<Bitmap>, map: &MtlMap, channel: TextureChannel) -> Texture {
    let wrap = || if map.is_clamped { Wrap::Clamp } else { Wrap::Repeat };
    let two = |v: [f32; 2]| v.map(f64::from);
    let image = Texture::Image(ImageTexture {
        file,
        color_space: TextureSpace::Auto,
        channel,
        filter: TextureFilter::Ewa,
        anisotropy: 16.0,
        wrap: Wraps([wrap(), wrap()]),
        mapping: Mapping::Uv(UvMapping {
            scale: two(map.scale),
            translate: two(map.offset),
            ..UvMapping::default()
        }),
    });
    let [base, gain] = two(map.range);
    if [base, gain] == [0.0, 1.0] {
        return image;
    }
    let of = Varying::Texture(Box::new(TextureOf::Inline(image)));
    Texture::Remap(RemapTexture { of, from: [0.0, 1.0], to: [base, base + gain], power: 1.0 })
}

fn normals(texture: Texture) -> NormalMap {
    NormalMap {
        texture: TextureOf::Inline(texture),
        space: straal_scene::desc::NormalSpace::Tangent,
        green: straal_scene::desc::GreenAxis::Up,
        strength: 1.0,
    }
}

fn varying<T>(texture: Texture) -> Varying<T> {
    Varying::Texture(Box::new(TextureOf::Inline(texture)))
}

impl Maps {
    /// Whether there is a picture for it.
    pub fn has(&self, of: MtlUse) -> bool {
        self.textures.contains_key(&of)
    }

    /// Whether there are none at all.
    pub fn are_none(&self) -> bool {
        self.textures.is_empty() && self.normals.is_none() && self.heights.is_none()
    }

    /// A colour, times that of its picture. Black times a picture would be nothing: then the picture alone counts.
    pub fn colour(&self, of: MtlUse, constant: [f64; 3]) -> Varying<Spectrum> {
        let colour = |c: [f64; 3]| Spectrum::Rgb(straal_scene::value::LinearRgb(c));
        let Some(texture) = self.textures.get(&of) else { return Varying::Constant(colour(constant)) };
        let most = constant.iter().copied().fold(0.0, |a, b| if b > a { b } else { a });
        if most <= 0.0 || constant == [1.0; 3] {
            return varying(texture.clone());
        }
        let (by, tint) = if most > 1.0 { (most, constant.map(|v| v / most)) } else { (1.0, constant) };
        varying(Texture::Scale(straal_scene::desc::ScaleTexture {
            of: varying(texture.clone()),
            by: Varying::Constant(by),
            tint: Varying::Constant(colour(tint)),
        }))
    }

    /// A number, times that of its picture; `absent` where there is neither.
    pub fn number(&self, of: MtlUse, constant: Option<f64>, absent: f64) -> Varying<f64> {
        let Some(texture) = self.textures.get(&of) else {
            return Varying::Constant(constant.unwrap_or(absent));
        };
        match constant.filter(|v| *v > 0.0 && *v != 1.0) {
            None => varying(texture.clone()),
            Some(by) => varying(Texture::Scale(straal_scene::desc::ScaleTexture {
                of: varying(texture.clone()),
                by: Varying::Constant(by),
                tint: Varying::Constant(Spectrum::grey(1.0)),
            })),
        }
    }
}
