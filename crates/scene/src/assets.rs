//! The files a scene names, read.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::desc::Material;
use crate::value::{Color, FileRef};
use crate::{Image, Mesh};
use straal_color::spectrum::Spectrum;

/// What a mesh file's own material of a given name becomes.
#[derive(Clone, Debug, PartialEq)]
pub struct PartMaterial {
    /// What the surface does with light.
    pub material: Material,
    /// Radiance it sends out, if any.
    pub emission: Option<Color>,
}

/// A mesh and the materials that came with it.
#[derive(Clone, Debug, Default)]
pub struct MeshAsset {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// Materials by the names that [`crate::Part::material`] uses. A node's own `material` overrides them.
    pub materials: Arc<BTreeMap<String, PartMaterial>>,
}

/// The files a scene names, each read once, by the name that the scene gives them.
#[derive(Clone, Debug, Default)]
pub struct Assets {
    /// Meshes.
    pub meshes: BTreeMap<String, MeshAsset>,
    /// Pictures.
    pub images: BTreeMap<String, Arc<Image>>,
    /// Spectra.
    pub spectra: BTreeMap<String, Arc<Spectrum>>,
}

impl Assets {
    /// Bytes that all of them take, each once, however many names it goes by.
    pub fn heap_bytes(&self) -> u64 {
        fn once<'a, T: 'a>(all: impl Iterator<Item = &'a Arc<T>>, bytes: impl Fn(&T) -> u64) -> u64 {
            let mut seen = BTreeSet::new();
            all.filter(|thing| seen.insert(Arc::as_ptr(thing))).map(|thing| bytes(thing)).sum()
        }
        once(self.meshes.values().map(|asset| &asset.mesh), Mesh::heap_bytes)
            + once(self.images.values(), Image::heap_bytes)
    }

    /// The mesh of a file; `None` when it was never read.
    pub fn mesh(&self, file: &FileRef) -> Option<&MeshAsset> {
        self.meshes.get(&file.value)
    }

    /// The picture of a file; `None` when it was never read.
    pub fn image(&self, file: &FileRef) -> Option<&Arc<Image>> {
        self.images.get(&file.value)
    }

    /// The spectrum of a file; `None` when it was never read.
    pub fn spectrum(&self, file: &FileRef) -> Option<&Arc<Spectrum>> {
        self.spectra.get(&file.value)
    }
}
