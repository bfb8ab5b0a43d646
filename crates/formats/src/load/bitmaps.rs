//! Pictures that textures are read off: each file is decoded once, several at a time.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use straal_scene::handle::Handle;
use straal_scene::value::{Asset, FileRef};
use straal_scene::{Assets, Bitmap, Scene};

use super::shelf::{Kept, Shelf, Thing};
use super::{IMAGE_HELP, Progress, Reader};
use crate::files::{self, Refusal};
use crate::mesh_file::Picture;
use crate::read_error::quoted;
use crate::{Limits, image};

/// A use of a picture.
struct Use<'a> {
    /// Where the scene names it, or the mesh whose material does.
    file: &'a FileRef,
    /// Its name for the scene's hash.
    called: String,
    handle: Handle<Bitmap>,
    path: &'a PathBuf,
    /// Its name, if it is one of a mesh's.
    of_mesh: Option<String>,
}

/// A file to be decoded.
struct Wanted<'a> {
    /// As the scene names it where it is met first, or the mesh whose material names it.
    file: &'a FileRef,
    /// Its name, if it is one of a mesh's.
    of_mesh: Option<String>,
    path: &'a Path,
    /// Bytes that decoding it takes besides what is kept.
    passing: u64,
}

/// What comes of a file: the picture, notes, and the hash of its bytes.
type Decoded = Result<(Arc<Bitmap>, Vec<String>, [u8; 32]), Refusal>;

impl Reader<'_> {
    /// Reads them all; complains of those that can't be read, in the order of the scene.
    pub(super) fn bitmaps(&mut self, scene: &Scene, paths: &BTreeMap<String, PathBuf>, assets: &mut Assets) {
        let of_scene = scene.bitmap_files().into_iter().filter_map(|Asset { file, handle }| {
            let (called, path) = (file.value.clone(), paths.get(&file.value)?);
            Some(Use { file, called, handle: *handle, path, of_mesh: None })
        });
        // Of meshes, with the names that their materials give them.
        let pictures = std::mem::take(&mut self.pictures);
        let of_meshes = pictures.iter().map(|(mesh, Picture { asset, path })| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let called = format!("{} {name}", mesh.value);
            Use { file: mesh, called, handle: asset.handle, path, of_mesh: Some(name.into_owned()) }
        });
        let mut wanted: Vec<Wanted<'_>> = Vec::new();
        // The same file under two names is read once.
        let mut places: BTreeMap<PathBuf, usize> = BTreeMap::new();
        let mut uses = Vec::new();
        for Use { file, called, handle, path, of_mesh } in of_scene.chain(of_meshes) {
            let real = path.canonicalize().unwrap_or_else(|_| path.clone());
            let place = *places.entry(real).or_insert(wanted.len());
            uses.push((called, handle, place));
            if place < wanted.len() {
                continue;
            }
            // What is wrong with a header is told by reading the rest.
            let header = image::Header::open(path, self.limits);
            let (kept, decoded) = header.map_or((0, 0), |h| (h.bitmap_bytes(), h.decoded_bytes));
            let length = files::size(path, self.limits.max_bytes).unwrap_or(0);
            let passing = length.saturating_add(decoded);
            if self.is_too_much(file, passing.saturating_add(kept), IMAGE_HELP) {
                return;
            }
            self.ledger.keep(kept);
            wanted.push(Wanted { file, of_mesh, path, passing });
        }
        let threads = self.threads(&wanted);
        self.progress.more(pictures.len());
        let decoded = decode(&wanted, threads, (self.limits, &self.shelf, &self.progress));
        for (wanted, decoded) in wanted.iter().zip(&decoded) {
            match decoded {
                Ok((_, notes, _)) => {
                    self.told(wanted.file, notes);
                }
                Err(refusal) => {
                    let problem = match &wanted.of_mesh {
                        Some(name) => format!("its picture {}: {}", quoted(name.as_bytes()), refusal.problem),
                        None => refusal.problem.clone(),
                    };
                    self.refuse(wanted.file, Refusal { problem, help: refusal.help.clone() });
                }
            }
        }
        for (called, handle, place) in uses {
            if let Some(Ok((bitmap, _, hash))) = decoded.get(place) {
                assets.bitmaps.put(handle, bitmap.clone());
                self.hashes.insert(called, *hash);
            }
        }
    }

    /// How many are decoded at a time: one for each processor, fewer where memory is short.
    fn threads(&mut self, wanted: &[Wanted<'_>]) -> usize {
        let mut passing: Vec<u64> = wanted.iter().map(|w| w.passing).collect();
        passing.sort_unstable_by(|a, b| b.cmp(a));
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        let (mut sum, mut threads) = (0_u64, 0);
        for bytes in passing.into_iter().take(processors) {
            let more = sum.saturating_add(bytes);
            if threads > 0 && self.ledger.refuse(more, String::new, IMAGE_HELP).is_some() {
                break;
            }
            (sum, threads) = (more, threads + 1);
        }
        self.ledger.pass(sum);
        threads
    }
}

/// Decodes files in any order; gives them in theirs.
fn decode(
    wanted: &[Wanted<'_>],
    threads: usize,
    (limits, shelf, progress): (&Limits, &Shelf, &Progress<'_>),
) -> Vec<Decoded> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(mine) = wanted.get(i) else { return done };
            done.push((i, one(mine.path, limits, shelf)));
            progress.step();
        }
    };
    let mut decoded: Vec<Option<Decoded>> = wanted.iter().map(|_| None).collect();
    std::thread::scope(|scope| {
        let running: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        for thread in running {
            for (i, result) in thread.join().unwrap_or_default() {
                decoded[i] = Some(result);
            }
        }
    });
    let broken = || Err(Refusal::new("its decoder broke down"));
    decoded.into_iter().map(|result| result.unwrap_or_else(broken)).collect()
}

fn one(path: &Path, limits: &Limits, shelf: &Shelf) -> Decoded {
    let key = shelf.key(path, "texture".to_owned());
    if let Some(Kept { thing: Thing::Bitmap(bitmap), notes, hash }) = shelf.get(key.as_ref()) {
        return Ok((bitmap, notes, hash));
    }
    let bytes = image::bytes(path, limits)?;
    let (bitmap, notes) = image::bitmap(&bytes, limits).map_err(|e| Refusal::new(e.to_string()))?;
    let (bitmap, hash) = (Arc::new(bitmap), blake3::hash(&bytes).into());
    shelf.put(key, Kept { thing: Thing::Bitmap(bitmap.clone()), notes: notes.clone(), hash });
    Ok((bitmap, notes, hash))
}
