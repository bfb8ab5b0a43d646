//! Files that were read before, for who reads the same ones again and again, as for frame after frame of a scene that moves.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use straal_scene::{Bitmap, Image, MeshAsset};

/// What was read before; nothing is kept unless it is made with [`Shelf::new`].
#[derive(Clone, Default)]
pub struct Shelf(Option<Arc<Mutex<BTreeMap<Key, Kept>>>>);

/// A file as it was: where it is, how long it was and when it was changed last; and what was wanted of it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    path: PathBuf,
    length: u64,
    changed: SystemTime,
    wanted: String,
}

/// What came of a file: what was said of it, and the hash of its bytes.
#[derive(Clone)]
pub(super) struct Kept {
    pub thing: Thing,
    pub notes: Vec<String>,
    pub hash: [u8; 32],
}

/// What a file becomes.
#[derive(Clone)]
pub(super) enum Thing {
    Mesh(MeshAsset),
    Image(Arc<Image>),
    Bitmap(Arc<Bitmap>),
}

impl Shelf {
    /// One that keeps what is read by all loads that are given it.
    pub fn new() -> Self {
        Self(Some(Arc::default()))
    }

    /// What a file goes by here; `None` where nothing is kept, or the file can't be told from others.
    pub(super) fn key(&self, path: &Path, wanted: String) -> Option<Key> {
        self.0.as_ref()?;
        let about = path.metadata().ok()?;
        Some(Key {
            path: path.canonicalize().ok()?,
            length: about.len(),
            changed: about.modified().ok()?,
            wanted,
        })
    }

    pub(super) fn get(&self, key: Option<&Key>) -> Option<Kept> {
        let kept = self.0.as_ref()?.lock().unwrap_or_else(PoisonError::into_inner);
        kept.get(key?).cloned()
    }

    pub(super) fn put(&self, key: Option<Key>, kept: Kept) {
        if let (Some(all), Some(key)) = (&self.0, key) {
            all.lock().unwrap_or_else(PoisonError::into_inner).insert(key, kept);
        }
    }
}

impl std::fmt::Debug for Shelf {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if self.0.is_some() { "Shelf" } else { "no shelf" })
    }
}

/// The same where both keep nothing, or are the very same.
impl PartialEq for Shelf {
    fn eq(&self, o: &Self) -> bool {
        match (&self.0, &o.0) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        }
    }
}
