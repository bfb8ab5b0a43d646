//! Scenes of other programs, read into straal's own description.
//!
//! A reader gets the bytes of the file that was asked for and what it may do (`Means`), and gives back a description and what
//! it made itself (`Translated`): meshes and pictures that stand in its text or in a buffer. What the scene names as files
//! of its own (PLY, PNG, spectra) it only names, with the handles that `Made` gives; these are found and read as those of any scene. A
//! reader says what it leaves out or approximates, by name and place, and never guesses silently.

mod gltf;
pub mod gltf_out;
mod mitsuba;
mod motion;
mod pbrt;
mod usd;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use straal_scene::handle::{Handles, Kind};
use straal_scene::memory::Ledger;
use straal_scene::value::{Asset, FileRef};
use straal_scene::{Assets, Bitmap, Diagnostics, Image, Mesh, MeshAsset, Photometry, Scene, validate};

use crate::Limits;
use crate::files::Finder;

/// Whose scene a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Foreign {
    /// glTF 2.0, as text or packed.
    Gltf,
    /// pbrt-v4's.
    Pbrt,
    /// Mitsuba's, of any version.
    Mitsuba,
    /// OpenUSD's, as text, binary or packed.
    Usd,
}

impl Foreign {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Gltf, Self::Pbrt, Self::Mitsuba, Self::Usd];

    /// By a file's name.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?;
        if extension.eq_ignore_ascii_case("gz") {
            return Self::of(Path::new(path.file_stem()?)).filter(|kind| *kind == Self::Pbrt);
        }
        Self::ALL.into_iter().find(|kind| kind.extensions().iter().any(|e| e.eq_ignore_ascii_case(extension)))
    }

    /// How its files' names end.
    pub const fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Gltf => &["gltf", "glb"],
            Self::Pbrt => &["pbrt"],
            Self::Mitsuba => &["xml"],
            Self::Usd => &["usd", "usda", "usdc", "usdz"],
        }
    }

    /// Reads one; none after a complaint that leaves nothing to look at.
    fn read(self, name: &str, bytes: &[u8], means: &mut Means<'_>) -> Option<Translated> {
        match self {
            Self::Gltf => gltf::read(name, bytes, means),
            Self::Pbrt => pbrt::read(name, bytes, means),
            Self::Mitsuba => mitsuba::read(name, bytes, means),
            Self::Usd => usd::read(name, bytes, means),
        }
    }

    /// Reads one, and checks it as a whole.
    pub(crate) fn translate(self, name: &str, bytes: &[u8], means: &mut Means<'_>) -> Option<Translated> {
        let mut translated = self.read(name, bytes, means)?;
        translated.scene.link();
        validate::validate(&translated.scene, means.d);
        Some(translated)
    }
}

/// What a reader of a scene may use.
pub(crate) struct Means<'a> {
    /// The folder of the file, from which its names of files go.
    pub base: &'a Path,
    /// How much its files may ask for.
    pub limits: &'a Limits,
    /// Finds what it includes.
    pub finder: &'a mut Finder,
    /// What it takes of memory.
    pub ledger: &'a mut Ledger,
    /// What was said besides for names in it, as by `-D`.
    pub define: &'a BTreeMap<String, String>,
    /// The frame of a scene that moves.
    pub frame: f64,
    /// Whether what is unknown is only warned of.
    pub lenient: bool,
    /// Width and height of a picture by a camera that shows all, where the file has none.
    pub size: Option<[u32; 2]>,
    /// What is complained of. Texts that are read go to its sources first, so that complaints can point into them.
    pub d: &'a mut Diagnostics,
}

impl Means<'_> {
    /// The same for a read beside it, at a frame: what that complains of and what memory it takes stay with who asks.
    pub fn beside<'b>(&'b mut self, frame: f64, ledger: &'b mut Ledger, d: &'b mut Diagnostics) -> Means<'b> {
        let Self { base, limits, finder, define, lenient, size, .. } = self;
        Means { base, limits, finder, ledger, define, frame, lenient: *lenient, size: *size, d }
    }
}

/// A scene as straal says it, not yet linked or checked as a whole.
pub(crate) struct Translated {
    /// What it says.
    pub scene: Scene,
    /// What it names or holds.
    pub made: Made,
    /// What was read besides the file itself, and the BLAKE3 of each by the name that the scene gives it.
    pub files: Vec<(PathBuf, String, [u8; 32])>,
    /// Bytes of texts that are kept for messages.
    pub text_bytes: u64,
}

/// Handles of all that a scene names, and the meshes and pictures that its own files hold.
#[derive(Default)]
pub(crate) struct Made {
    /// By name.
    pub handles: Handles,
    /// What was made already.
    pub assets: Assets,
}

impl Made {
    /// A mesh, a picture or a spectrum that is in a file of its own, which is looked for and read later.
    pub fn in_file<T: Kind>(&mut self, file: impl Into<FileRef>) -> Asset<T> {
        let file = file.into();
        let handle = self.handles.of(&file.value);
        Asset { file, handle }
    }

    /// A mesh that the scene holds, under a name that no file has.
    pub fn mesh(&mut self, name: impl Into<FileRef>, mesh: MeshAsset) -> Asset<Mesh> {
        let asset = self.in_file(name);
        self.assets.meshes.put(asset.handle, mesh);
        asset
    }

    /// A picture that the scene holds, for textures.
    pub fn bitmap(&mut self, name: impl Into<FileRef>, bitmap: Arc<Bitmap>) -> Asset<Bitmap> {
        let asset = self.in_file(name);
        self.assets.bitmaps.put(asset.handle, bitmap);
        asset
    }

    /// What the scene tells of a lamp's directions.
    pub fn photometry(&mut self, name: impl Into<FileRef>, lamp: Arc<Photometry>) -> Asset<Photometry> {
        let asset = self.in_file(name);
        self.assets.photometries.put(asset.handle, lamp);
        asset
    }

    /// A picture that the scene holds, for surroundings.
    pub fn image(&mut self, name: impl Into<FileRef>, image: Arc<Image>) -> Asset<Image> {
        let asset = self.in_file(name);
        self.assets.images.put(asset.handle, image);
        asset
    }
}
