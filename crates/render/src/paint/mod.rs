//! Colours and spectra of the description as what paths read: numbers in the work space, and spectra of each nanometre.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use straal_color::spectrum::{
    Bins, COUNT, Observer, Quantity, TabulatedSpectrum, illuminant, metal, refraction::Metal, uplift,
};
use straal_color::{Light, Matrix3, Space};
use straal_math::{DVec3, ops};
use straal_scene::decode::Describe;
use straal_scene::desc;
use straal_scene::value::{self, LinearRgb};
use straal_scene::{Assets, Bitmap, Handle, Image, Mesh, Photometry, Scene};

use crate::lanes::{Colour, Eta, EtaTable, SpectralTables, table_of};
use crate::light::goniometric::Distribution;
use crate::material::{Bands, Relative};
use crate::texture::{
    Maker, Mapping, Meaning, MeshAttribute, Pyramid, Solid, Texture, TextureKind, TextureRef, Use, Value,
};

/// Turns what the scene says of colours into what paths read, in the scene's work space or by wavelengths.
pub(crate) struct Paint<'a> {
    scene: &'a Scene,
    assets: &'a Assets,
    space: Space,
    /// `None` where linear sRGB is the work space itself.
    to_work: Option<Matrix3>,
    /// `None` in RGB.
    uplift: Option<uplift::Uplift>,
    /// Tables of RGB colours that were met, by their use and their bits.
    known: BTreeMap<(Quantity, [u64; 3]), u32>,
    /// Tables of measured spectra, by their bits.
    tables: BTreeMap<Vec<u32>, u32>,
    /// Colours of measured spectra, by their use and what the scene says of them: to make one takes half a millisecond.
    measured: BTreeMap<(Quantity, Content), Colour>,
    /// Indices of refraction of metals.
    metals: BTreeMap<Metal, [Colour; 2]>,
    /// What red, green and blue see of waves, if a film was met.
    bands: Option<Arc<Bands>>,
    /// Filled as colours are met.
    pub spectra: SpectralTables,
    /// Filled as textures are met.
    pub textures: Vec<Texture>,
    /// Textures of the scene that were made, and what for.
    named: BTreeMap<(Handle<desc::Texture>, Wanted, bool), TextureRef>,
    /// What of the description's space lies at the world's origin.
    centre: DVec3,
    /// Numbers of what meshes have at vertices or on faces, by name.
    attributes: BTreeMap<String, u32>,
    /// Distributions of measured lamps that were made.
    lamps: Vec<(Handle<Photometry>, Arc<Distribution>)>,
    /// Pyramids that were made: of which picture, as what, and whether with smaller copies.
    pyramids: Vec<(Handle<Bitmap>, Meaning, bool, Arc<Pyramid>)>,
    /// What is worth telling of them.
    pub notes: Vec<String>,
}

/// What a texture is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Wanted {
    Colour(Quantity),
    Number,
    /// A number between two, by their bits.
    Within([u32; 2]),
}

/// What makes the parts of a texture of what it is wanted for.
struct PartsOf<'p, 'a> {
    paint: &'p mut Paint<'a>,
    of: Wanted,
}

impl Maker for PartsOf<'_, '_> {
    fn part(&mut self, v: &desc::Varying<desc::Spectrum>) -> Value<Colour> {
        match v {
            desc::Varying::Constant(s) => self.colour(s).into(),
            desc::Varying::Texture(t) => self.paint.texture(t, self.of, true),
        }
    }

    fn share(&mut self, v: &desc::Varying<desc::Spectrum>) -> Value<Colour> {
        self.paint.reflectance(v)
    }

    fn number(&mut self, v: &desc::Varying<f64>) -> Value<f32> {
        match v {
            desc::Varying::Constant(v) => (*v as f32).into(),
            desc::Varying::Texture(t) => self.paint.texture(t, Wanted::Number, true),
        }
    }

    fn attribute(&mut self, name: &str) -> u32 {
        self.paint.attribute(name)
    }

    fn mapping(&mut self, said: &desc::Mapping) -> Mapping {
        let centre = self.paint.centre;
        Mapping::of(said, centre, |name| self.paint.attribute(name))
    }

    fn solid(&mut self, space: &desc::MappingSpace, transform: &desc::Transform) -> Solid {
        Solid::of(space, transform, self.paint.centre)
    }

    fn colour(&mut self, s: &desc::Spectrum) -> Colour {
        let of = if let Wanted::Colour(quantity) = self.of { quantity } else { Quantity::Reflectance };
        self.paint.colour(s, of)
    }

    fn wants_number(&self) -> bool {
        matches!(self.of, Wanted::Number | Wanted::Within(_) | Wanted::Colour(Quantity::Index))
    }

    fn pyramid(
        &mut self,
        asset: &value::Asset<Bitmap>,
        meaning: &Meaning,
        has_smaller: bool,
    ) -> Arc<Pyramid> {
        let made = &mut self.paint.pyramids;
        let known = made.iter().find(|(of, as_what, smaller, _)| {
            (*of, as_what, *smaller) == (asset.handle, meaning, has_smaller)
        });
        if let Some((.., pyramid)) = known {
            return pyramid.clone();
        }
        let bitmap = self.paint.assets.bitmap(asset.handle);
        let pyramid = Arc::new(Pyramid::new(bitmap.clone(), meaning, has_smaller));
        made.push((asset.handle, meaning.clone(), has_smaller, pyramid.clone()));
        pyramid
    }
}

/// All that tells a measured spectrum from others: its name and file, and the bits of its numbers.
type Content = (Option<String>, Option<Handle<TabulatedSpectrum>>, Option<bool>, Vec<u64>);

fn content(m: &desc::Measured) -> Content {
    let absent = f64::NAN;
    let one = [m.blackbody.unwrap_or(absent), m.daylight.unwrap_or(absent), m.scale];
    let numbers = one.iter().chain(&m.wavelengths).chain(&m.values).map(|v| v.to_bits());
    let is_smooth = m.interpolation.as_ref().map(|i| *i == desc::Interpolation::Smooth);
    let name = m.name.as_ref().map(|known| known.name.value.clone());
    (name, m.file.as_ref().map(|asset| asset.handle), is_smooth, numbers.collect())
}

/// So many pixels are tried whether they are of a colour that light can have.
const MOST_TRIED: usize = 4096;

/// A pixel's channel is off by more than this part of the strongest where no light has its colour.
const OFF: f32 = 0.01;

/// Nobody reads more.
const MOST_NOTES: usize = 20;

impl<'a> Paint<'a> {
    pub fn new(scene: &'a Scene, assets: &'a Assets, (spectral, centre): (bool, DVec3)) -> Self {
        let space = scene.color.space.space();
        let uplift = spectral.then(uplift::Uplift::new);
        let to_work = (space != Space::Srgb).then(|| Space::Srgb.to(space));
        let spectra = if spectral { SpectralTables::spectral() } else { SpectralTables::in_rgb(to_work) };
        Self {
            scene,
            assets,
            space,
            to_work,
            uplift,
            known: BTreeMap::new(),
            tables: BTreeMap::new(),
            measured: BTreeMap::new(),
            metals: BTreeMap::new(),
            bands: None,
            spectra,
            textures: Vec::new(),
            named: BTreeMap::new(),
            centre,
            attributes: BTreeMap::new(),
            lamps: Vec::new(),
            pyramids: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// The assets.
    pub const fn assets(&self) -> &'a Assets {
        self.assets
    }

    /// Share of light that comes back.
    pub fn reflectance(&mut self, v: &desc::Varying<desc::Spectrum>) -> Value<Colour> {
        self.value(v, Quantity::Reflectance)
    }

    /// Light that is sent out.
    pub fn emission(&mut self, v: &desc::Varying<desc::Spectrum>) -> Value<Colour> {
        self.value(v, Quantity::Emission)
    }

    /// The number of what meshes have, by its name.
    fn attribute(&mut self, name: &str) -> u32 {
        let next = self.attributes.len() as u32;
        *self.attributes.entry(name.to_owned()).or_insert(next)
    }

    /// What a mesh has that a texture may read: all of it, as materials of its parts may be met later.
    pub fn attributes(&mut self, mesh: &Mesh) -> Vec<MeshAttribute> {
        let all = mesh.attributes.iter();
        all.map(|a| MeshAttribute {
            id: self.attribute(&a.name),
            per: a.per,
            channels: a.channels,
            is_code: a.is_code,
            values: a.values.clone(),
        })
        .collect()
    }

    /// Three numbers as they stand.
    pub fn vector(&mut self, t: &desc::TextureOf) -> Value<Colour> {
        self.texture(t, Wanted::Number, true)
    }

    /// A number that may be anything.
    pub fn height(&mut self, t: &desc::TextureOf) -> Value<f32> {
        self.texture(t, Wanted::Number, true)
    }

    /// How many pixels the picture has across and down that a texture is, if it is one.
    pub fn size_of(&self, said: &desc::TextureOf) -> Option<[usize; 2]> {
        let texture = match said {
            desc::TextureOf::Inline(texture) => texture,
            desc::TextureOf::Named(link) => self.scene.textures.of(link)?,
        };
        let desc::Texture::Image(image) = texture else { return None };
        let bitmap = self.assets.bitmap(image.file.handle);
        Some([bitmap.texels.width(), bitmap.texels.height()])
    }

    /// Light that is sent out by something that has no surface.
    pub fn light(&mut self, s: &desc::Spectrum) -> Value<Colour> {
        self.colour(s, Quantity::Emission).into()
    }

    /// Share of light that is the same everywhere.
    pub fn share(&mut self, s: &desc::Spectrum) -> Colour {
        self.colour(s, Quantity::Reflectance)
    }

    /// A number for each wavelength that is no colour, such as absorption per m.
    pub fn coefficient(&mut self, s: &desc::Spectrum) -> Colour {
        self.colour(s, Quantity::Index)
    }

    fn value(&mut self, v: &desc::Varying<desc::Spectrum>, of: Quantity) -> Value<Colour> {
        match v {
            desc::Varying::Constant(s) => self.colour(s, of).into(),
            desc::Varying::Texture(t) => self.texture(t, Wanted::Colour(of), false),
        }
    }

    /// A texture; `is_part` is whether it is only a part of another, so that it isn't kept in range.
    fn texture<T>(&mut self, said: &desc::TextureOf, of: Wanted, is_part: bool) -> Value<T> {
        let blank = desc::Texture::blank();
        let (named, said) = match said {
            desc::TextureOf::Inline(said) => (None, said),
            // A scene without errors leads everywhere.
            desc::TextureOf::Named(link) => (link.to(), self.scene.textures.of(link).unwrap_or(&blank)),
        };
        if let Some(known) = named.and_then(|named| self.named.get(&(named, of, is_part))) {
            return Value::Texture(*known);
        }
        if of == Wanted::Colour(Quantity::Index) && self.uplift.is_some() {
            self.spectra.prepare_coefficients(index_parts);
        }
        let kind = TextureKind::of(said, &mut PartsOf { paint: self, of });
        let most = kind.most();
        let texture = match of {
            Wanted::Colour(Quantity::Emission) => Texture::new(kind, Use::Emission),
            Wanted::Colour(Quantity::Index) => Texture::new(kind, Use::Coefficient),
            Wanted::Within(range) => {
                Texture { range: range.map(f32::from_bits), ..Texture::new(kind, Use::Reflectance) }
            }
            Wanted::Colour(_) => Texture::new(kind, Use::Reflectance),
            Wanted::Number => Texture { range: [0.0, f32::MAX], ..Texture::new(kind, Use::Reflectance) },
        };
        let range = if is_part { [f32::MIN, f32::MAX] } else { texture.range };
        self.textures.push(Texture { range, ..texture });
        let made = TextureRef { id: (self.textures.len() - 1) as u32, most };
        self.named.extend(named.map(|named| ((named, of, is_part), made)));
        Value::Texture(made)
    }

    /// A number that is kept between two, whatever a picture has.
    pub fn number_within(&mut self, v: &desc::Varying<f64>, [least, most]: [f32; 2]) -> Value<f32> {
        match v {
            desc::Varying::Constant(v) => (*v as f32).into(),
            desc::Varying::Texture(t) => {
                self.texture(t, Wanted::Within([least, most].map(f32::to_bits)), false)
            }
        }
    }

    /// A number.
    pub fn number(&mut self, v: &desc::Varying<f64>) -> Value<f32> {
        match v {
            desc::Varying::Constant(v) => (*v as f32).into(),
            desc::Varying::Texture(t) => self.texture(t, Wanted::Number, false),
        }
    }

    /// Light that is sent out, times a factor.
    pub fn emission_times(&mut self, s: &desc::Spectrum, factor: f64) -> Colour {
        let colour = self.colour(s, Quantity::Emission);
        if factor == 1.0 {
            return colour;
        }
        let by = factor as f32;
        let spectrum = if self.uplift.is_some() { self.spectra.add_scaled(colour.spectrum, by) } else { 0 };
        Colour { rgb: colour.rgb * by, strength: colour.strength * by, spectrum }
    }

    /// Light of a colour as the pixel of a picture of radiance has it: see [`Self::surroundings`].
    pub fn as_pixel(&mut self, s: &desc::Spectrum) -> [f32; 3] {
        match s {
            desc::Spectrum::Rgb(LinearRgb(rgb)) if self.uplift.is_some() => rgb.map(|v| v as f32),
            _ => self.colour(s, Quantity::Emission).rgb.to_rgb(),
        }
    }

    /// What a picture's channels are multiplied by to be tinted.
    pub fn tint(&mut self, s: &desc::Spectrum) -> [f64; 3] {
        self.as_pixel(s).map(f64::from)
    }

    /// The share of light that comes back, in linear sRGB as near as the work space tells it.
    pub fn albedo(&mut self, s: &desc::Spectrum) -> [f64; 3] {
        match s {
            desc::Spectrum::Rgb(LinearRgb(rgb)) => *rgb,
            desc::Spectrum::Measured(_) => self.colour(s, Quantity::Reflectance).rgb.to_rgb().map(f64::from),
        }
    }

    /// What was measured of a lamp, once for all lamps of a file.
    pub fn distribution(&mut self, file: &value::Asset<Photometry>) -> Arc<Distribution> {
        if let Some((_, known)) = self.lamps.iter().find(|(of, _)| *of == file.handle) {
            return known.clone();
        }
        let made = Arc::new(Distribution::new(self.assets.photometry(file.handle)));
        self.lamps.push((file.handle, made.clone()));
        made
    }

    /// A colour so bright that its luminance is a number.
    pub fn of_luminance(&mut self, s: &desc::Spectrum, luminance: f64) -> Colour {
        let colour = self.colour(s, Quantity::Emission);
        let weights = self.space.rgb().luminance();
        let own: f64 = colour.rgb.to_rgb().iter().zip(weights).map(|(v, w)| f64::from(*v) * w).sum();
        self.emission_times(s, if own > 0.0 { luminance / own } else { 0.0 })
    }

    /// Light of a measured spectrum that is sent out.
    pub fn emitted(&mut self, spectrum: &TabulatedSpectrum, what: &str) -> Colour {
        self.measured(spectrum, (Quantity::Emission, what))
    }

    /// From linear sRGB to the space in which pixels of radiance are read, where that is another.
    pub fn pixels_to_work(&self) -> Option<Matrix3> {
        self.to_work.filter(|_| self.uplift.is_none())
    }

    /// A picture of radiance: in the work space, each channel 0 or more; or in linear sRGB, any channels, where its pixels
    /// become spectra. Colours that are lost are told.
    pub fn surroundings<'i>(&mut self, file: &value::FileRef, image: &'i Image) -> Cow<'i, Image> {
        let spectral = self.uplift.is_some();
        // Where wavelengths end.
        let to_edge = spectral.then(|| Space::Srgb.to(Space::AcesCg)).or(self.to_work);
        let held = |p: &[f32; 3]| to_edge.map_or(*p, |m| m.apply_f32(*p));
        let mut near_primaries = 0;
        let mut beyond = |p: &[f32; 3]| {
            let q = held(p);
            let most = q.iter().copied().fold(0.0, ops::max);
            // Of the edge itself, only what is next to a primary is no light.
            let pure = spectral && most > 0.0 && q.iter().filter(|v| **v < 0.1 * most).count() == 2;
            near_primaries += usize::from(pure);
            let got =
                if pure && near_primaries <= MOST_TRIED { self.spectra.colour_of_pixel(*p) } else { None };
            got.is_some_and(|got| {
                let got = held(&got.map(|v| v as f32));
                (0..3).any(|c| (got[c] - q[c]).abs() > OFF * most)
            })
        };
        let lost = image.pixels.iter().filter(|p| is_lost(held(p).map(f64::from)) || beyond(p)).count();
        if lost > 0 {
            let (name, all) = (&file.value, image.pixels.len());
            let what = if spectral {
                "are more colourful than light can be".to_string()
            } else {
                format!("are of colours that the work space `{}` doesn't hold", self.space.name())
            };
            let told = format!("{lost} of the {all} pixels of `{name}` {what}: {}", self.clipped());
            note(&mut self.notes, told);
        }
        let is_fit = |p: &[f32; 3]| p.iter().all(|v| *v >= 0.0);
        if spectral || (self.to_work.is_none() && image.pixels.iter().all(is_fit)) {
            return Cow::Borrowed(image);
        }
        let fit = |p: &[f32; 3]| held(p).map(|v| if v > 0.0 { v } else { 0.0 });
        Cow::Owned(Image { pixels: image.pixels.iter().map(fit).collect(), ..*image })
    }

    /// What becomes of colours that are lost, and what helps.
    fn clipped(&self) -> &'static str {
        match (self.uplift.is_some(), self.space) {
            (true, _) => "the nearest are taken",
            (false, Space::Aces) => "what is below 0 is taken as 0",
            (false, Space::AcesCg) => {
                "what is below 0 is taken as 0; `color: { space: aces }` holds more, `spectral: true` all"
            }
            (false, _) => {
                "what is below 0 is taken as 0; `color: { space: acescg }` holds more, `spectral: true` all"
            }
        }
    }

    fn colour(&mut self, s: &desc::Spectrum, of: Quantity) -> Colour {
        match s {
            desc::Spectrum::Rgb(color) => self.rgb(*color, of),
            desc::Spectrum::Measured(m) => {
                let key = (of, content(m));
                if let Some(known) = self.measured.get(&key) {
                    return *known;
                }
                let name = match (&m.file, &m.name) {
                    (Some(asset), _) => Some(&asset.file.value),
                    (None, named) => named.as_ref().map(|known| &known.name.value),
                };
                let what = name.map_or("a spectrum".to_owned(), |name| format!("the spectrum `{name}`"));
                let colour = self.measured(&m.spectrum(self.assets), (of, &what));
                self.measured.insert(key, colour);
                colour
            }
        }
    }

    /// What is a hair below 0 by rounding is 0. Indices of refraction are no colours: they are those of red, green and
    /// blue in any space.
    fn rgb(&mut self, color: LinearRgb, of: Quantity) -> Colour {
        let rgb = match self.to_work {
            Some(m) if of != Quantity::Index => m.apply(color.0),
            _ => color.0,
        };
        let rgb = Light::rgb(rgb.map(|v| if v < 0.0 { 0.0 } else { v as f32 }));
        let mut colour = Colour::from(rgb);
        let Some(uplift) = &self.uplift else { return colour };
        if color.0 == [0.0; 3] {
            return colour;
        }
        let key = (of, color.0.map(f64::to_bits));
        let known = self.known.get(&key).copied();
        colour.spectrum = known.unwrap_or_else(|| {
            let Lifted { table, nearest } = lift(uplift, color, of);
            if let Some(nearest) = nearest {
                note(&mut self.notes, beyond(color, nearest, of));
            }
            let id = self.spectra.add(table);
            self.known.insert(key, id);
            id
        });
        colour
    }

    /// The colour of a spectrum of some use, which `what` calls by name.
    fn measured(&mut self, spectrum: &TabulatedSpectrum, (of, what): (Quantity, &str)) -> Colour {
        let bins = spectrum.means(of);
        let matrix = uplift::rgb_from_xyz(self.space);
        let rgb = match of {
            Quantity::Reflectance => matrix.apply(Observer::Cie1931.surface(&bins, &illuminant::d65())),
            Quantity::Emission | Quantity::Index => matrix.apply(Observer::Cie1931.light(&bins)),
        };
        self.tell_if_lost(rgb, what);
        let most = if of == Quantity::Reflectance { 1.0 } else { f64::MAX };
        let held = |v: f64| if v > 0.0 { if v < most { v } else { most } } else { 0.0 };
        let mut colour = Colour::from(Light::rgb(rgb.map(|v| held(v) as f32)));
        if self.uplift.is_some() && bins.iter().any(|v| *v > 0.0) {
            colour.spectrum = self.table(table_of(spectrum, of));
            if colour.strength == 0.0 {
                colour.strength = (bins.iter().sum::<f64>() / COUNT as f64) as f32;
            }
        }
        colour
    }

    /// Where a table is, which is added unless it is there.
    fn table(&mut self, table: [f32; COUNT]) -> u32 {
        let spectra = &mut self.spectra;
        let bits = table.iter().map(|v| v.to_bits()).collect();
        *self.tables.entry(bits).or_insert_with(|| spectra.add(table))
    }

    /// In RGB, says which colour the work space doesn't hold.
    fn tell_if_lost(&mut self, rgb: [f64; 3], what: &str) {
        if self.uplift.is_none() && is_lost(rgb) {
            let (space, rgb) = (self.space.name(), told(rgb));
            let help = self.clipped();
            let told =
                format!("{what} has the colour {rgb}, which the work space `{space}` doesn't hold: {help}");
            note(&mut self.notes, told);
        }
    }

    /// The index of refraction of something clear over that around it. Where it depends on the wavelength, in RGB its light must be parted.
    pub fn index_of_refraction(
        &mut self,
        inside: &desc::Varying<desc::Index>,
        outside: &desc::Varying<desc::Index>,
    ) -> (Eta, Relative) {
        // What differs from point to point is a factor to the rest.
        let one = desc::Index::Constant(1.0);
        let same = |v: &'_ desc::Varying<desc::Index>| v.constant().cloned().unwrap_or(one.clone());
        let eta = self.index_by_wavelength(&same(inside), &same(outside));
        let varies = |v: &desc::Varying<desc::Index>| match v {
            desc::Varying::Constant(_) => desc::Varying::Constant(1.0),
            desc::Varying::Texture(t) => desc::Varying::Texture(t.clone()),
        };
        (eta, Relative::of(&varies(inside), &varies(outside), self))
    }

    fn index_by_wavelength(&mut self, inside: &desc::Index, outside: &desc::Index) -> Eta {
        if let (desc::Index::Constant(inside), desc::Index::Constant(outside)) = (inside, outside) {
            return Eta::Constant(*inside as f32 / *outside as f32);
        }
        let (inside, outside) = (inside.index(), outside.index());
        let eta = EtaTable::new(&inside, &outside);
        if !eta.disperses() {
            return Eta::Constant(eta.middle);
        }
        if self.uplift.is_none() {
            self.spectra.prepare_dispersion(self.space);
        }
        Eta::Table(eta)
    }

    /// Real and imaginary part of a metal's index of refraction.
    pub fn metal(&mut self, d: &desc::Conductor) -> [Value<Colour>; 2] {
        if let (Some(eta), Some(k)) = (&d.eta, &d.k)
            && (eta.constant().is_none() || k.constant().is_none())
        {
            return [eta, k].map(|part| self.value(part, Quantity::Index));
        }
        self.same_metal(d).map(Value::Constant)
    }

    /// The same of a metal that is the same everywhere.
    fn same_metal(&mut self, d: &desc::Conductor) -> [Colour; 2] {
        // A conductor without errors says one of the two.
        let same =
            |v: &'_ Option<desc::Varying<desc::Spectrum>>| v.as_ref().and_then(|v| v.constant()).cloned();
        let (Some(eta), Some(k)) = (same(&d.eta), same(&d.k)) else {
            let metal = d.metal.as_ref().map_or_else(Metal::default, |known| known.what);
            if let Some(known) = self.metals.get(&metal) {
                return *known;
            }
            let found = self.index(&metal.index().map(|s| s.means(Quantity::Index)), metal.name());
            self.metals.insert(metal, found);
            return found;
        };
        let parts = [&eta, &k];
        if let [desc::Spectrum::Rgb(eta), desc::Spectrum::Rgb(k)] = parts {
            return [self.rgb(*eta, Quantity::Index), self.rgb(*k, Quantity::Index)];
        }
        let mut bins = [[0.0; COUNT]; 2];
        for (bins, part) in bins.iter_mut().zip(parts) {
            *bins = match part {
                desc::Spectrum::Rgb(LinearRgb(rgb)) => index_between(*rgb),
                desc::Spectrum::Measured(m) => m.spectrum(self.assets).means(Quantity::Index),
            };
        }
        self.index(&bins, "a metal")
    }

    /// What red, green and blue see of waves that meet; none by wavelengths.
    pub fn bands(&mut self) -> Option<Arc<Bands>> {
        if self.bands.is_none() && self.uplift.is_none() {
            self.bands = Some(Arc::new(Bands::new(self.space)));
        }
        self.bands.clone()
    }

    /// An index of refraction by wavelength, and in RGB the one that looks like it.
    fn index(&mut self, [eta, k]: &[Bins; 2], what: &str) -> [Colour; 2] {
        let fit = metal::in_rgb(eta, k, self.space);
        self.tell_if_lost(fit.facing, what);
        let mut colours = [fit.eta, fit.k].map(|rgb| Colour::from(Light::rgb(rgb.map(|v| v as f32))));
        if self.uplift.is_some() {
            for (colour, bins) in colours.iter_mut().zip([eta, k]) {
                colour.spectrum = self.table(bins.map(|v| v as f32));
            }
        }
        colours
    }
}

fn note(notes: &mut Vec<String>, note: String) {
    if notes.len() < MOST_NOTES {
        notes.push(note);
    }
}

/// Whether a colour has a channel below 0 by more than rounding.
fn is_lost(rgb: [f64; 3]) -> bool {
    let most = rgb.iter().copied().fold(0.0, |a: f64, b| if b > a { b } else { a });
    most > 0.0 && rgb.iter().any(|v| *v < -1e-3 * most)
}

/// Three numbers, for people.
fn told(rgb: [f64; 3]) -> String {
    format!("[{}]", rgb.map(|v| format!("{v:.3}")).join(", "))
}

/// The spectrum of an RGB colour.
struct Lifted {
    table: [f32; COUNT],
    /// The linear sRGB that it has, where no spectrum has the colour itself.
    nearest: Option<[f64; 3]>,
}

/// What is said of a colour that nothing has.
fn beyond(LinearRgb(rgb): LinearRgb, nearest: [f64; 3], of: Quantity) -> String {
    let (what, why) = match of {
        Quantity::Emission => ("light", "is of a colour that no light has"),
        Quantity::Reflectance | Quantity::Index => (
            "a surface",
            "is more colourful than one can be without sending back more light than falls on it",
        ),
    };
    let (rgb, nearest) = (told(rgb), told(nearest));
    format!("{what} of linear sRGB {rgb} {why}: by wavelengths it becomes {nearest}")
}

fn lift(uplift: &uplift::Uplift, LinearRgb(rgb): LinearRgb, of: Quantity) -> Lifted {
    let exact = |table| Lifted { table, nearest: None };
    match of {
        Quantity::Reflectance => match uplift.reach(rgb) {
            Ok(smooth) => exact(smooth.bins().map(|v| v as f32)),
            Err(smooth) => {
                let bins = smooth.bins();
                Lifted { table: bins.map(|v| v as f32), nearest: Some(uplift.rgb_of_reflectance(&bins)) }
            }
        },
        Quantity::Emission => {
            let found = uplift.reach_light(rgb);
            let (smooth, scale) = found.unwrap_or_else(|nearest| nearest);
            let bins = smooth.bins();
            let table = std::array::from_fn(|i| (bins[i] * scale * uplift.white()[i]) as f32);
            let nearest = || uplift.rgb_of_reflectance(&bins).map(|v| v * scale);
            Lifted { table, nearest: found.is_err().then(nearest) }
        }
        Quantity::Index => exact(index_between(rgb).map(|v| v as f32)),
    }
}

/// By nanometre, how much those of red, green and blue count in [`index_between`].
fn index_parts() -> Vec<[f32; 3]> {
    let parts = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(index_between);
    (0..COUNT).map(|i| parts.each_ref().map(|part| part[i] as f32)).collect()
}

/// An index of refraction of which red, green and blue are known: each where it sees most of the light, and between them what
/// lies between.
fn index_between(rgb: [f64; 3]) -> Bins {
    let parts = uplift::positive_parts(Space::Srgb);
    let mut last = (rgb[0] + rgb[1] + rgb[2]) / 3.0;
    std::array::from_fn(|i| {
        let sum: f64 = parts.iter().map(|p| p[i]).sum();
        if sum > 0.0 {
            last = (0..3).map(|c| rgb[c] * parts[c][i]).sum::<f64>() / sum;
        }
        last
    })
}
