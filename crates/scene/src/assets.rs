//! The files a scene names, read.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, LazyLock};

use crate::desc::{Material, Spectrum, Varying};
use crate::handle::{Handle, Store};
use crate::{Bitmap, Image, Mesh, Photometry};
use straal_color::spectrum::TabulatedSpectrum;

/// What a mesh file's own material of a given name becomes.
#[derive(Clone, Debug, PartialEq)]
pub struct PartMaterial {
    /// What the surface does with light.
    pub material: Material,
    /// Radiance it sends out, if any.
    pub emission: Option<Varying<Spectrum>>,
}

/// A mesh and the materials that came with it.
#[derive(Clone, Debug, Default)]
pub struct MeshAsset {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// Materials by the names that [`crate::Part::material`] uses. A node's own `material` overrides them.
    pub materials: Arc<BTreeMap<String, PartMaterial>>,
}

/// What stands beside a description: meshes, pictures and spectra by their handles.
#[derive(Clone, Debug, Default)]
pub struct Assets {
    /// Meshes.
    pub meshes: Store<Mesh, MeshAsset>,
    /// Pictures.
    pub images: Store<Image, Arc<Image>>,
    /// Pictures that textures are read off.
    pub bitmaps: Store<Bitmap, Arc<Bitmap>>,
    /// Spectra.
    pub spectra: Store<TabulatedSpectrum, Arc<TabulatedSpectrum>>,
    /// What was measured of lamps.
    pub photometries: Store<Photometry, Arc<Photometry>>,
}

static NO_MESH: LazyLock<MeshAsset> = LazyLock::new(MeshAsset::default);

static NO_IMAGE: LazyLock<Arc<Image>> =
    LazyLock::new(|| Arc::new(Image { width: 1, height: 1, pixels: vec![[0.0; 3]] }));

static NO_BITMAP: LazyLock<Arc<Bitmap>> = LazyLock::new(|| Arc::new(Bitmap::black()));

static NO_PHOTOMETRY: LazyLock<Arc<Photometry>> = LazyLock::new(Arc::default);

static NO_SPECTRUM: LazyLock<Arc<TabulatedSpectrum>> = LazyLock::new(Arc::default);

impl Assets {
    /// Bytes that all of them take, each once, however many names it goes by.
    pub fn heap_bytes(&self) -> u64 {
        fn once<'a, T: 'a>(all: impl Iterator<Item = &'a Arc<T>>, bytes: impl Fn(&T) -> u64) -> u64 {
            let mut seen = BTreeSet::new();
            all.filter(|thing| seen.insert(Arc::as_ptr(thing))).map(|thing| bytes(thing)).sum()
        }
        once(self.meshes.iter().map(|asset| &asset.mesh), Mesh::heap_bytes)
            + once(self.images.iter(), Image::heap_bytes)
            + once(self.bitmaps.iter(), Bitmap::heap_bytes)
            + once(self.photometries.iter(), Photometry::heap_bytes)
    }

    /// A mesh; an empty one where it was never read, which whoever reads has complained of.
    pub fn mesh(&self, mesh: Handle<Mesh>) -> &MeshAsset {
        self.meshes.get(mesh).unwrap_or(&NO_MESH)
    }

    /// A picture; a black one where it was never read, which whoever reads has complained of.
    pub fn image(&self, image: Handle<Image>) -> &Arc<Image> {
        self.images.get(image).unwrap_or(&NO_IMAGE)
    }

    /// A picture that a texture is read off; a black one where it was never read, which whoever reads has complained of.
    pub fn bitmap(&self, bitmap: Handle<Bitmap>) -> &Arc<Bitmap> {
        self.bitmaps.get(bitmap).unwrap_or(&NO_BITMAP)
    }

    /// What was measured of a lamp; nothing where it was never read, which whoever reads has complained of.
    pub fn photometry(&self, lamp: Handle<Photometry>) -> &Arc<Photometry> {
        self.photometries.get(lamp).unwrap_or(&NO_PHOTOMETRY)
    }

    /// A spectrum; 1 at all wavelengths where it was never read, which whoever reads has complained of.
    pub fn spectrum(&self, spectrum: Handle<TabulatedSpectrum>) -> &Arc<TabulatedSpectrum> {
        self.spectra.get(spectrum).unwrap_or(&NO_SPECTRUM)
    }
}
