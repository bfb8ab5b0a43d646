//! From a path to a scene with everything it names.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use straal_scene::decode::{Strictness, write_json};
use straal_scene::desc::{Light, MaterialRef, Node};
use straal_scene::diagnostic::start_of;
use straal_scene::handle::{Handle, Handles};
use straal_scene::memory::{Ledger, Shortage};
use straal_scene::value::{Asset, FileRef};
use straal_scene::{
    Assets, Bitmap, Diagnostic, Diagnostics, FileId, Image, Mesh, MeshAsset, Scene, Span, frames, glow::Glow,
    read_scene, suggest, whole,
};

use crate::files::{self, Finder, Found, Refusal};
use crate::mesh_file::{self, MeshFile, Picture};
use crate::scene::{Foreign, Made, Means, Translated};
use crate::studio::{self, Studio};
use crate::{Limits, ReadError, foreign, image, photometry, spd, yaml};

mod bitmaps;
mod shelf;

pub use shelf::Shelf;
use shelf::{Kept, Thing};

/// How a scene is loaded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Whether unknown keys are only warned of.
    pub lenient: bool,
    /// How much a scene's text may ask for.
    pub text: yaml::Limits,
    /// How much the files it names may ask for.
    pub files: Limits,
    /// Bytes of memory that reading all this may take; no limit when absent.
    pub memory: Option<u64>,
    /// How a bare mesh is shown.
    pub studio: Studio,
    /// The folder that all files must be in which a scene names, and which those name; anywhere when absent. Symbolic links
    /// are followed before this is asked. The scene itself may lie elsewhere, but one in the folder must not be a link out
    /// of it.
    pub root: Option<PathBuf>,
    /// Who is told how far reading has come.
    pub listener: Listener,
    /// The frame of a scene that moves, and part of it; the first is 0.
    pub frame: f64,
    /// What was read before.
    pub shelf: Shelf,
    /// What stands for names that a scene of another program leaves open.
    pub define: BTreeMap<String, String>,
    /// Whether each lamp that has a name is put into a group of lights of that name.
    pub group_lamps: bool,
}

/// Who is told how far the reading of a scene's files has come, from any thread; nobody, unless it is made with [`Listener::new`].
#[derive(Clone, Default)]
pub struct Listener(Option<Arc<dyn Fn(Reading) + Send + Sync>>);

/// How far the reading of files has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// Files that are read.
    pub done: usize,
    /// Files that are known to be needed.
    pub of: usize,
}

impl Listener {
    /// Calls this after each file.
    pub fn new(hear: impl Fn(Reading) + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(hear)))
    }

    fn tell(&self, done: usize, of: usize) {
        if let Some(hear) = &self.0 {
            hear(Reading { done, of });
        }
    }
}

impl std::fmt::Debug for Listener {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if self.0.is_some() { "Listener" } else { "nobody" })
    }
}

/// The same where both are nobody, or the very same.
impl PartialEq for Listener {
    fn eq(&self, o: &Self) -> bool {
        match (&self.0, &o.0) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        }
    }
}

/// A scene without errors, and everything it names.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// What the scene says.
    pub scene: Scene,
    /// The files it names.
    pub assets: Assets,
    /// Warnings, and the texts that they point into.
    pub warnings: Diagnostics,
    /// BLAKE3 of what the scene says and of the bytes of its files: the same for the same scene, however it is
    /// commented, spaced or ordered within a mapping of settings.
    pub hash: [u8; 32],
    /// Bytes of the texts that are kept for messages.
    pub text_bytes: u64,
    /// Bytes that reading took at a time, the program's own among them.
    pub peak_bytes: u64,
    /// Names of the meshes and pictures that aren't in files of their own: they stand in the scene's own file or in a buffer.
    pub held: BTreeSet<String>,
    /// The files that were read, but for the one that the scene is told in; a mesh by itself is one of them.
    pub files: Vec<PathBuf>,
}

/// The largest scene text, in bytes.
const MOST_TEXT: u64 = 1 << 28;

/// Whether a file is taken for a bare mesh, by its name.
pub fn is_mesh(path: &Path) -> bool {
    path.extension().is_some_and(|e| ["ply", "obj", "stl"].iter().any(|known| e.eq_ignore_ascii_case(known)))
}

/// Loads a scene (YAML or JSON), or a bare `.ply`, `.obj` or `.stl` mesh, which gets a studio around it.
///
/// The files that a scene names are looked for in its folder. On failure all complaints are given at once.
pub fn load(path: &Path, options: &Options) -> Result<Loaded, Diagnostics> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if is_mesh(path) {
        return load_mesh(path, options);
    }
    if let Some(kind) = Foreign::of(path) {
        return load_foreign(kind, path, options);
    }
    if let Some(what) = foreign::kind(&extension) {
        let help = "straal reads scenes of its own (.yaml, .json), of glTF, pbrt, Mitsuba and OpenUSD, and meshes (.ply, .obj, .stl)";
        let message = format!("`{}` is {what}: .{extension} files are not supported", path.display());
        return Err(only(Diagnostic::error(Span::NONE, message).help(help)));
    }
    let fail = |refusal: Refusal| cannot_read(path, refusal);
    let place = finder(options)?.named(path).map_err(fail)?;
    let length = files::size(&place, MOST_TEXT).map_err(|r| fail(r.or_similar(&place)))?;
    let what = || format!("reading `{}`", path.display());
    if let Some(shortage) =
        Ledger::new(options.memory).refuse(text_needs(length, &options.text), what, TEXT_HELP)
    {
        return Err(lacking(&shortage));
    }
    let bytes = files::read(&place, MOST_TEXT).map_err(|r| fail(r.or_similar(&place)))?;
    let base = path.parent().unwrap_or(Path::new(""));
    let name = path.display().to_string();
    let loaded = load_bytes(&name, &bytes, base, options);
    if loaded.is_err() && !foreign::looks_like_a_scene(&bytes) {
        // What another file holds may not be for everyone's eyes, and a complaint would quote it.
        let message =
            format!("`{name}` is no scene: none of a scene's keys, such as `camera:` and `world:`, is in it");
        let help = "straal reads scenes in YAML or JSON (.yaml, .json) and meshes (.ply, .obj, .stl)";
        return Err(only(Diagnostic::error(Span::NONE, message).help(help)));
    }
    loaded
}

/// Loads a scene from its text. `name` is how messages call it, `base` the folder of the files that it names.
pub fn load_str(name: &str, text: &str, base: &Path, options: &Options) -> Result<Loaded, Diagnostics> {
    load_bytes(name, text.as_bytes(), base, options)
}

/// Loads a scene of another program.
fn load_foreign(kind: Foreign, path: &Path, options: &Options) -> Result<Loaded, Diagnostics> {
    let fail = |refusal: Refusal| cannot_read(path, refusal);
    let finder = finder(options)?;
    let place = finder.named(path).map_err(fail)?;
    let length = files::size(&place, options.files.max_bytes).map_err(|r| fail(r.or_similar(&place)))?;
    let mut ledger = Ledger::new(options.memory);
    let what = || format!("reading `{}`", path.display());
    if let Some(shortage) = ledger.refuse(length, what, TEXT_HELP) {
        return Err(lacking(&shortage));
    }
    let read = match kind {
        Foreign::Usd => files::read_archive,
        Foreign::Pbrt => files::read_packed,
        Foreign::Gltf | Foreign::Mitsuba => files::read,
    };
    let bytes = read(&place, options.files.max_bytes);
    let bytes = bytes.map_err(|r| fail(r.or_similar(&place)))?;
    ledger.pass(length);
    of_bytes(kind, (path, bytes), (finder, ledger), options)
}

/// Loads a scene of another program from its bytes, as if they were those of a file.
pub fn load_foreign_bytes(
    kind: Foreign,
    path: &Path,
    bytes: Vec<u8>,
    options: &Options,
) -> Result<Loaded, Diagnostics> {
    of_bytes(kind, (path, bytes), (finder(options)?, Ledger::new(options.memory)), options)
}

fn of_bytes(
    kind: Foreign,
    (path, bytes): (&Path, Vec<u8>),
    (mut finder, mut ledger): (Finder, Ledger),
    options: &Options,
) -> Result<Loaded, Diagnostics> {
    let base = path.parent().unwrap_or(Path::new(""));
    let mut d = Diagnostics::default();
    let mut means = Means {
        base,
        limits: &options.files,
        finder: &mut finder,
        ledger: &mut ledger,
        define: &options.define,
        frame: options.frame,
        lenient: options.lenient,
        size: options.studio.size,
        d: &mut d,
    };
    let Some(translated) = kind.translate(&path.display().to_string(), &bytes, &mut means) else {
        d.sort();
        return Err(d);
    };
    let Translated { mut scene, made, files: more, text_bytes } = translated;
    differ(&mut scene, options.frame);
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let mut hashes = BTreeMap::from([(name, blake3::hash(&bytes).into())]);
    drop(bytes);
    let mut files = Vec::new();
    for (file, name, hash) in more {
        files.push(file);
        hashes.insert(name, hash);
    }
    ledger.keep(text_bytes + scene.heap_bytes() + made.assets.heap_bytes());
    let described = Described { scene, made, hashes, files, at: Span::NONE, text_bytes };
    with_files(described, base, (finder, ledger), options, d)
}

/// Loads a scene from its bytes, which should be UTF-8.
pub fn load_bytes(name: &str, bytes: &[u8], base: &Path, options: &Options) -> Result<Loaded, Diagnostics> {
    let mut d = Diagnostics::default();
    let Some((scene, file, tree_bytes)) = describe(name, bytes, options, &mut d) else { return Err(d) };
    // The bytes, and the text that messages quote; while they are read, another copy and the tree of values.
    let length = bytes.len() as u64;
    let mut ledger = Ledger::new(options.memory);
    ledger.keep(2 * length);
    ledger.pass(length + tree_bytes + scene.heap_bytes());
    ledger.keep(scene.heap_bytes());
    let made = Made { handles: handles_of(&scene), ..Made::default() };
    let described = Described {
        scene,
        made,
        hashes: BTreeMap::new(),
        files: Vec::new(),
        at: start_of(file),
        text_bytes: length,
    };
    with_files(described, base, (finder(options)?, ledger), options, d)
}

/// A scene whose files are still to be read.
struct Described {
    scene: Scene,
    /// What it names, and what is there already.
    made: Made,
    /// Those of what was read for it.
    hashes: BTreeMap<String, [u8; 32]>,
    /// What was read for it besides its own file.
    files: Vec<PathBuf>,
    /// Where to point at what is wrong with all of it.
    at: Span,
    text_bytes: u64,
}

/// Reads the files that a scene names, and checks it with them.
fn with_files(
    described: Described,
    base: &Path,
    (mut finder, ledger): (Finder, Ledger),
    options: &Options,
    mut d: Diagnostics,
) -> Result<Loaded, Diagnostics> {
    let Described { mut scene, made: Made { handles, assets }, hashes, mut files, at, text_bytes } =
        described;
    if options.group_lamps {
        group_lamps(&mut scene, at, &mut d);
    }
    let held = held(&scene, &assets);
    let paths = locate(&scene, &assets, base, &options.files, &mut finder, &mut d);
    if d.has_errors() {
        d.sort();
        return Err(d);
    }
    files.extend(paths.values().cloned());
    let attributes = scene.attributes().into_iter().map(|name| name.value.clone()).collect();
    let mut reader = Reader {
        limits: &options.files,
        shelf: options.shelf.clone(),
        finder,
        attributes,
        handles,
        pictures: Vec::new(),
        hashes,
        progress: Progress::new(&options.listener, paths.len()),
        files,
        ledger,
        d: &mut d,
    };
    let assets = reader.assets(&scene, assets, &paths);
    let ledger = reader.ledger;
    let hash = hash(&scene, &reader.hashes);
    let files = reader.files;
    whole::validate(&scene, &assets, &mut d);
    if !d.has_errors() && scene.integrator.needs_light() && !gives_light(&scene, &assets) {
        let help = "add a light under `lights:`, or give a shape an `emission`";
        d.push(Diagnostic::warning(at, "nothing in this scene gives light").help(help));
    }
    d.sort();
    if d.has_errors() {
        return Err(d);
    }
    let peak_bytes = ledger.most();
    Ok(Loaded { scene, assets, warnings: d, hash, held, files, text_bytes, peak_bytes })
}

/// Names of what is there before any file is looked for.
fn held(scene: &Scene, made: &Assets) -> BTreeSet<String> {
    let meshes = scene.mesh_files().into_iter().filter(|a| made.meshes.get(a.handle).is_some());
    let images = scene.image_files().into_iter().filter(|a| made.images.get(a.handle).is_some());
    let bitmaps = scene.bitmap_files().into_iter().filter(|a| made.bitmaps.get(a.handle).is_some());
    let images = images.map(|a| &a.file).chain(bitmaps.map(|a| &a.file));
    let lamps = scene.photometry_files().into_iter();
    let lamps = lamps.filter(|a| made.photometries.get(a.handle).is_some()).map(|a| &a.file);
    meshes.map(|a| &a.file).chain(images).chain(lamps).map(|file| file.value.clone()).collect()
}

/// What makes a mesh take less memory.
const MESH_HELP: &str = "a mesh of fewer triangles takes less";

/// What makes a picture take less memory.
const IMAGE_HELP: &str = "a smaller picture takes less";

/// What makes a scene's text take less memory.
const TEXT_HELP: &str = "meshes in PLY files, and instances of objects, take less than long lists";

/// Bytes that reading a text of some length takes: copies of it, and the tree of its values. It is known better when it is read.
fn text_needs(length: u64, limits: &yaml::Limits) -> u64 {
    /// Of values for each byte of text, as in lists of numbers.
    const VALUES: u64 = 15;
    /// Of a key and its value.
    const ENTRY: u64 = 112;
    let tree = (VALUES * length).min(ENTRY.saturating_mul(limits.nodes as u64));
    3 * length + tree
}

/// A complaint that there is too little memory.
fn lacking(shortage: &Shortage) -> Diagnostics {
    let mut d = only(Diagnostic::error(Span::NONE, shortage.to_string()).help(shortage.help()));
    d.lacks_memory = true;
    d
}

/// Loads what comes without a name, as through a pipe: a scene (YAML or JSON) or a bare mesh, told by how it begins. Files that it
/// names are looked for in the present folder.
pub fn load_stream(name: &str, bytes: &[u8], options: &Options) -> Result<Loaded, Diagnostics> {
    let Some(extension) = mesh_file::kind_of(bytes) else {
        return load_bytes(name, bytes, Path::new(""), options);
    };
    let path = Path::new(name).with_extension(extension);
    let (mut finder, mut handles) = (finder(options)?, Handles::default());
    let means = mesh_file::Means {
        limits: &options.files,
        finder: &mut finder,
        handles: &mut handles,
        wanted: &is_colour,
    };
    let read = mesh_file::read(bytes, &path, means).map_err(|refusal| cannot_read(&path, refusal))?;
    in_studio(&path, read, options, Ledger::new(options.memory))
}

fn only(complaint: Diagnostic) -> Diagnostics {
    let mut d = Diagnostics::default();
    d.push(complaint);
    d
}

/// Why a file that the caller names isn't read.
fn cannot_read(path: &Path, refusal: Refusal) -> Diagnostics {
    let message = format!("cannot read `{}`: {}", path.display(), refusal.problem);
    only(Diagnostic::error(Span::NONE, message).maybe_help(refusal.help))
}

/// What finds files within the root, if there is one.
fn finder(options: &Options) -> Result<Finder, Diagnostics> {
    Finder::new(options.root.as_deref())
        .map_err(|r| only(Diagnostic::error(Span::NONE, r.problem).maybe_help(r.help)))
}

/// What a text says, as far as it can be read.
fn describe(
    name: &str,
    bytes: &[u8],
    options: &Options,
    d: &mut Diagnostics,
) -> Option<(Scene, FileId, u64)> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.len() as u64 > MOST_TEXT {
        d.push(Diagnostic::error(
            Span::NONE,
            format!("`{name}` is too large for a scene: {} bytes", bytes.len()),
        ));
        return None;
    }
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(e) => {
            let at = e.valid_up_to();
            let text = String::from_utf8_lossy(&bytes[..at]);
            // The line is shown up to where it breaks off.
            let file = d.sources.add(name, text);
            let at = u32::try_from(at).unwrap_or(u32::MAX);
            let message = "this is not a text: the file must be UTF-8";
            d.push(Diagnostic::error(Span { file, start: at, end: at }, message));
            return None;
        }
    };
    let file = d.sources.add(name, text);
    let mut tree = yaml::read(file, &options.text, d)?;
    frames::settle(&mut tree, options.frame, d);
    let (mut scene, complaints) =
        read_scene(&tree, std::mem::take(d), Strictness { lenient: options.lenient });
    *d = complaints;
    differ(&mut scene, options.frame);
    Some((scene, file, tree.heap_bytes()))
}

/// Puts lamps into groups by their names.
fn group_lamps(scene: &mut Scene, at: Span, d: &mut Diagnostics) {
    let over = scene.group_lamps();
    if !over.is_empty() {
        let (over, most) = (over.len(), straal_scene::desc::MOST_LIGHT_GROUPS);
        let message = format!(
            "{over} lamps more have names: there may be {most} groups of lights, and these are in the rest"
        );
        d.push(Diagnostic::warning(at, message));
    } else if scene.light_groups().is_empty() {
        d.push(Diagnostic::warning(at, "no lamp has a name: there are no groups of lights"));
    }
}

/// Gives each frame noise of its own: the same in all would look like dirt on the lens. The first has that of a still.
fn differ(scene: &mut Scene, frame: f64) {
    let frame = frame as u64;
    if frame > 0 {
        scene.sampler.seed = scene.sampler.seed.wrapping_add(frame) % (1 << 53);
    }
}

/// Where each file is that the scene names and that isn't `made` yet; complains of all that aren't there.
fn locate(
    scene: &Scene,
    made: &Assets,
    base: &Path,
    limits: &Limits,
    finder: &mut Finder,
    d: &mut Diagnostics,
) -> BTreeMap<String, PathBuf> {
    let mut paths = BTreeMap::new();
    let named = || {
        let meshes = scene.mesh_files().into_iter().filter(|a| made.meshes.get(a.handle).is_none());
        let images = scene.image_files().into_iter().filter(|a| made.images.get(a.handle).is_none());
        let bitmaps = scene.bitmap_files().into_iter().filter(|a| made.bitmaps.get(a.handle).is_none());
        let spectra = scene.spectrum_files().into_iter().filter(|a| made.spectra.get(a.handle).is_none());
        let meshes = meshes.map(|asset| &asset.file);
        let images = images.map(|asset| &asset.file);
        let bitmaps = bitmaps.map(|asset| &asset.file);
        let spectra = spectra.map(|asset| &asset.file);
        let lamps = scene.photometry_files().into_iter();
        let lamps = lamps.filter(|a| made.photometries.get(a.handle).is_none()).map(|asset| &asset.file);
        meshes.chain(images).chain(bitmaps).chain(spectra).chain(lamps)
    };
    for file in named() {
        // What couldn't be read has no name.
        if file.is_empty() || paths.contains_key(&file.value) {
            continue;
        }
        let found = finder.find(base, file).and_then(|found| {
            files::size(&found.path, limits.max_bytes)?;
            Ok(found)
        });
        let path = match found {
            Ok(Found { path, instead }) => {
                if let Some(instead) = instead {
                    let (name, instead) = (suggest::brief(file), suggest::brief(&instead));
                    let message = format!("there is no file `{name}`: `{instead}` is read");
                    d.push(Diagnostic::warning(file.span, message));
                }
                path
            }
            Err(refusal) => {
                let message = format!("cannot read `{}`: {}", suggest::brief(file), refusal.problem);
                let place = base.display().to_string();
                let place = if place.is_empty() { "." } else { &place };
                let looked = format!("files are looked for in the scene's folder, `{place}`");
                let looked = Some(looked).filter(|_| refusal.is_of_the_name());
                d.push(Diagnostic::error(file.span, message).maybe_help(refusal.help.or(looked)));
                base.join(&file.value)
            }
        };
        paths.insert(file.value.clone(), path);
    }
    paths
}

/// Handles of the pictures that a scene's own textures are read off, from which others can go on.
fn handles_of(scene: &Scene) -> Handles {
    let mut known = scene.bitmap_files();
    known.sort_by_key(|asset| asset.handle);
    let mut handles = Handles::default();
    for asset in known {
        handles.of::<Bitmap>(&asset.file.value);
    }
    handles
}

/// Meshes that are shown with the materials of their files somewhere.
fn with_their_own_materials(scene: &Scene) -> BTreeSet<Handle<Mesh>> {
    let mut found = BTreeSet::new();
    scene.visit(|node| {
        if let Node::Mesh(m) = node
            && m.surface.material.is_none()
        {
            found.extend(m.file.as_ref().map(|asset| asset.handle));
        }
    });
    found
}

/// Files that are read, of those that are known to be needed.
struct Progress<'a> {
    listener: &'a Listener,
    done: AtomicUsize,
    of: AtomicUsize,
}

impl<'a> Progress<'a> {
    fn new(listener: &'a Listener, of: usize) -> Self {
        listener.tell(0, of);
        Self { listener, done: AtomicUsize::new(0), of: AtomicUsize::new(of) }
    }

    /// One file is read.
    fn step(&self) {
        let done = 1 + self.done.fetch_add(1, Ordering::Relaxed);
        self.listener.tell(done, self.of.load(Ordering::Relaxed).max(done));
    }

    /// So many more are needed.
    fn more(&self, count: usize) {
        self.of.fetch_add(count, Ordering::Relaxed);
    }
}

/// What comes of a file, and the hash of its bytes; nothing after a complaint.
type Read<T> = Option<(T, [u8; 32])>;

/// Reads the files of a scene, each once.
struct Reader<'a> {
    limits: &'a Limits,
    shelf: Shelf,
    finder: Finder,
    /// What textures read of meshes.
    attributes: BTreeSet<String>,
    /// Handles of the pictures that textures are read off.
    handles: Handles,
    /// Those of them that materials of meshes name, with what the scene calls the mesh.
    pictures: Vec<(FileRef, Picture)>,
    /// How many files are read.
    progress: Progress<'a>,
    /// BLAKE3 of each file, by the name that the scene gives it.
    hashes: BTreeMap<String, [u8; 32]>,
    /// What has been read so far.
    ledger: Ledger,
    /// What is read.
    files: Vec<PathBuf>,
    d: &'a mut Diagnostics,
}

impl Reader<'_> {
    /// Reads them into what is there already.
    fn assets(&mut self, scene: &Scene, mut assets: Assets, paths: &BTreeMap<String, PathBuf>) -> Assets {
        // The same file under two names is read once.
        let mut meshes: BTreeMap<PathBuf, Read<MeshAsset>> = BTreeMap::new();
        let mut images: BTreeMap<PathBuf, Read<Arc<Image>>> = BTreeMap::new();
        let as_they_are = with_their_own_materials(scene);
        for Asset { file, handle } in scene.mesh_files() {
            let Some(path) = paths.get(&file.value) else { continue };
            if assets.meshes.get(*handle).is_some() {
                continue;
            }
            let real = path.canonicalize().unwrap_or_else(|_| path.clone());
            if !meshes.contains_key(&real) {
                let asset = self.mesh((file, as_they_are.contains(handle)), path);
                meshes.insert(real.clone(), asset);
            }
            if let Some(Some((asset, hash))) = meshes.get(&real) {
                assets.meshes.put(*handle, asset.clone());
                self.hashes.insert(file.value.clone(), *hash);
            }
        }
        for Asset { file, handle } in scene.image_files() {
            let Some(path) = paths.get(&file.value) else { continue };
            if assets.images.get(*handle).is_some() {
                continue;
            }
            let real = path.canonicalize().unwrap_or_else(|_| path.clone());
            if !images.contains_key(&real) {
                let image = self.image(file, path);
                images.insert(real.clone(), image);
            }
            if let Some(Some((image, hash))) = images.get(&real) {
                assets.images.put(*handle, image.clone());
                self.hashes.insert(file.value.clone(), *hash);
            }
        }
        self.coordinates(scene, &assets);
        self.bitmaps(scene, paths, &mut assets);
        for Asset { file, handle } in scene.spectrum_files() {
            let Some(path) = paths.get(&file.value) else { continue };
            if assets.spectra.get(*handle).is_some() {
                continue;
            }
            let bytes = match files::read(path, spd::MOST_BYTES) {
                Ok(bytes) => bytes,
                Err(refusal) => {
                    self.refuse(file, refusal);
                    continue;
                }
            };
            match spd::read(&bytes) {
                Ok(spectrum) => {
                    assets.spectra.put(*handle, Arc::new(spectrum));
                    self.hashes.insert(file.value.clone(), blake3::hash(&bytes).into());
                }
                Err(e) => self.fail(file, &e),
            }
        }
        self.lamps(scene, paths, &mut assets);
        assets
    }

    /// What was measured of lamps.
    fn lamps(&mut self, scene: &Scene, paths: &BTreeMap<String, PathBuf>, assets: &mut Assets) {
        for Asset { file, handle } in scene.photometry_files() {
            let Some(path) = paths.get(&file.value) else { continue };
            if assets.photometries.get(*handle).is_some() {
                continue;
            }
            let bytes = match files::read(path, photometry::MOST_BYTES) {
                Ok(bytes) => bytes,
                Err(refusal) => {
                    self.refuse(file, refusal);
                    continue;
                }
            };
            match photometry::read(&bytes) {
                Ok(lamp) => {
                    assets.photometries.put(*handle, Arc::new(lamp));
                    self.hashes.insert(file.value.clone(), blake3::hash(&bytes).into());
                }
                Err(e) => self.fail(file, &e),
            }
        }
    }

    /// Complains of texture coordinates that a mapping wants and meshes don't have.
    fn coordinates(&mut self, scene: &Scene, assets: &Assets) {
        let has = |mesh: &Mesh, name: &str| mesh.attributes.iter().any(|a| a.name == name && a.channels >= 2);
        let mut complaints: Vec<Diagnostic> = Vec::new();
        let wanted = if self.d.has_errors() { Vec::new() } else { scene.coordinates() };
        for name in &wanted {
            if !assets.meshes.iter().any(|asset| has(&asset.mesh, name)) {
                let message = format!("no mesh has the texture coordinates `{}`", suggest::brief(name));
                let help = "PLY files have further sets as `u1` and `v1`, `s1` and `t1` or `texture_u1` and `texture_v1`, called `uv1` here";
                complaints.push(Diagnostic::error(name.span, message).help(help));
            }
        }
        if complaints.is_empty() && !wanted.is_empty() {
            scene.visit(|node| {
                let Node::Mesh(m) = node else { return };
                let material = match &m.surface.material {
                    Some(MaterialRef::Named(link)) => scene.materials.of(link),
                    Some(MaterialRef::Inline(material)) => Some(&**material),
                    None => None,
                };
                let wanted = material.map_or(Vec::new(), |material| scene.coordinates_of(material));
                let file = m.file.as_ref();
                let mesh = file.map(|asset| &*assets.mesh(asset.handle).mesh);
                for name in wanted {
                    if !mesh.is_some_and(|mesh| has(mesh, name)) {
                        let which =
                            file.map_or("a mesh".to_owned(), |f| format!("`{}`", suggest::brief(&f.file)));
                        let message = format!(
                            "{which} hasn't the texture coordinates `{}` that its material asks for",
                            suggest::brief(name)
                        );
                        let place = file.map_or(name.span, |f| f.file.span);
                        complaints.push(Diagnostic::error(place, message));
                    }
                }
            });
        }
        complaints.into_iter().for_each(|complaint| self.d.push(complaint));
    }

    /// A mesh; none after a complaint. The pictures of its materials are wanted where these are.
    fn mesh(&mut self, (file, has_materials): (&FileRef, bool), path: &Path) -> Read<MeshAsset> {
        let of_attributes: Vec<&str> = self.attributes.iter().map(String::as_str).collect();
        let key = self.shelf.key(path, of_attributes.join(" "));
        if let Some(Kept { thing: Thing::Mesh(asset), notes, hash }) = self.shelf.get(key.as_ref()) {
            self.told(file, &notes);
            self.ledger.keep(asset.mesh.heap_bytes());
            return Some((asset, hash));
        }
        // As many bytes as the file has for the mesh that it holds, and the file's own.
        let length = files::size(path, self.limits.max_bytes).unwrap_or(0);
        if self.is_too_much(file, 2 * length, MESH_HELP) {
            return None;
        }
        let wanted = |name: &str| self.attributes.contains(name);
        let means = mesh_file::Means {
            limits: self.limits,
            finder: &mut self.finder,
            handles: &mut self.handles,
            wanted: &wanted,
        };
        match mesh_file::load(path, means) {
            Ok(MeshFile { asset, warnings, hash, libraries, pictures }) => {
                // What other files belong to is read again with them.
                if libraries.is_empty() {
                    let (thing, notes) = (Thing::Mesh(asset.clone()), warnings.clone());
                    self.shelf.put(key, Kept { thing, notes, hash });
                }
                self.files.extend(libraries);
                if has_materials {
                    self.files.extend(pictures.iter().map(|p| p.path.clone()));
                    self.pictures.extend(pictures.into_iter().map(|p| (file.clone(), p)));
                }
                self.told(file, &warnings);
                let own = asset.mesh.heap_bytes();
                self.ledger.pass(length + own);
                self.ledger.keep(own);
                Some((asset, hash))
            }
            Err(refusal) => {
                self.refuse(file, refusal);
                None
            }
        }
    }

    /// Tells what is to be said of a file.
    fn told(&mut self, file: &FileRef, notes: &[String]) {
        for note in notes {
            let message = format!("in `{}`: {note}", suggest::brief(file));
            self.d.push(Diagnostic::warning(file.span, message));
        }
    }

    /// A picture; none after a complaint.
    fn image(&mut self, file: &FileRef, path: &Path) -> Read<Arc<Image>> {
        let key = self.shelf.key(path, "surroundings".to_owned());
        if let Some(Kept { thing: Thing::Image(image), notes, hash }) = self.shelf.get(key.as_ref()) {
            self.told(file, &notes);
            self.ledger.keep(image.heap_bytes());
            return Some((image, hash));
        }
        // What is wrong with a header is told by reading the rest.
        let decoded = image::Header::open(path, self.limits).map_or(0, |header| header.decoded_bytes);
        let length = files::size(path, self.limits.max_bytes).unwrap_or(0);
        if self.is_too_much(file, length.saturating_add(decoded), IMAGE_HELP) {
            return None;
        }
        let bytes = match image::bytes(path, self.limits) {
            Ok(bytes) => bytes,
            Err(refusal) => {
                self.refuse(file, refusal);
                return None;
            }
        };
        match image::surroundings(&bytes, self.limits) {
            Ok((image, notes)) => {
                self.told(file, &notes);
                self.ledger.pass(length.saturating_add(decoded));
                self.ledger.keep(image.heap_bytes());
                let (image, hash) = (Arc::new(image), blake3::hash(&bytes).into());
                self.shelf.put(key, Kept { thing: Thing::Image(image.clone()), notes, hash });
                Some((image, hash))
            }
            Err(e) => {
                self.fail(file, &e);
                None
            }
        }
    }

    /// Whether reading a file takes more memory than there is, which is told then.
    fn is_too_much(&mut self, file: &FileRef, bytes: u64, help: &'static str) -> bool {
        let what = || format!("reading `{}`", suggest::brief(file));
        let Some(shortage) = self.ledger.refuse(bytes, what, help) else { return false };
        self.d.push(Diagnostic::error(file.span, shortage.to_string()).help(shortage.help()));
        self.d.lacks_memory = true;
        true
    }

    fn refuse(&mut self, file: &FileRef, refusal: Refusal) {
        let message = format!("cannot read `{}`: {}", suggest::brief(file), refusal.problem);
        self.d.push(Diagnostic::error(file.span, message).maybe_help(refusal.help));
    }

    fn fail(&mut self, file: &FileRef, e: &ReadError) {
        self.refuse(file, Refusal::new(e.to_string()));
    }
}

/// What the scene says, as JSON that is hashed while it is written, and the bytes of its files in the order of their names.
fn hash(scene: &Scene, files: &BTreeMap<String, [u8; 32]>) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    let mut pieces = BufWriter::with_capacity(1 << 14, &mut hasher);
    // A hasher refuses nothing.
    let _ = write_json(scene, &mut pieces).and_then(|()| pieces.flush());
    drop(pieces);
    for (name, hash) in files {
        hasher.update(&[0]).update(name.as_bytes()).update(&[0]).update(hash);
    }
    hasher.finalize().into()
}

fn gives_light(scene: &Scene, assets: &Assets) -> bool {
    let glow = Glow::of(scene, assets);
    scene.lights.iter().any(|l| !matches!(l, Light::Environment(e) if e.scale == 0.0))
        || scene.world.iter().any(|node| glow.node(node))
}

/// A mesh by itself shows its colours.
fn is_colour(attribute: &str) -> bool {
    attribute == "color"
}

/// A mesh by itself, with a studio around it.
fn load_mesh(path: &Path, options: &Options) -> Result<Loaded, Diagnostics> {
    let fail = |refusal: Refusal| cannot_read(path, refusal);
    let mut finder = finder(options)?;
    let place = finder.named(path).map_err(fail)?;
    let length = files::size(&place, options.files.max_bytes).map_err(|r| fail(r.or_similar(&place)))?;
    let mut ledger = Ledger::new(options.memory);
    let what = || format!("reading `{}`", path.display());
    if let Some(shortage) = ledger.refuse(2 * length, what, MESH_HELP) {
        return Err(lacking(&shortage));
    }
    let mut handles = Handles::default();
    let means = mesh_file::Means {
        limits: &options.files,
        finder: &mut finder,
        handles: &mut handles,
        wanted: &is_colour,
    };
    let read = mesh_file::load(&place, means).map_err(|r| fail(r.or_similar(&place)))?;
    ledger.pass(length + read.asset.mesh.heap_bytes());
    ledger.keep(read.asset.mesh.heap_bytes());
    let loaded = in_studio(path, read, options, ledger)?;
    let files = std::iter::once(path.to_path_buf()).chain(loaded.files).collect();
    Ok(Loaded { files, ..loaded })
}

/// A mesh with a studio around it.
fn in_studio(path: &Path, read: MeshFile, options: &Options, ledger: Ledger) -> Result<Loaded, Diagnostics> {
    let name = path.display().to_string();
    let mut assets = Assets::default();
    let shown = Asset::new(name.clone(), assets.meshes.add(read.asset.clone()));
    let (scene, told) = studio::around(&shown, &read.asset, &options.studio)
        .map_err(|problem| cannot_read(path, Refusal::new(problem)))?;
    let mut warnings = Diagnostics::default();
    let has_materials = !with_their_own_materials(&scene).is_empty();
    let pictures = if has_materials { read.pictures } else { Vec::new() };
    let mut files = read.libraries;
    files.extend(pictures.iter().map(|p| p.path.clone()));
    let mut reader = Reader {
        limits: &options.files,
        shelf: options.shelf.clone(),
        finder: Finder::default(),
        attributes: BTreeSet::new(),
        handles: Handles::default(),
        pictures: pictures.into_iter().map(|p| (name.clone().into(), p)).collect(),
        hashes: BTreeMap::new(),
        progress: Progress::new(&options.listener, 0),
        files,
        ledger,
        d: &mut warnings,
    };
    reader.bitmaps(&scene, &BTreeMap::new(), &mut assets);
    let Reader { mut hashes, files, ledger, .. } = reader;
    told.into_iter().for_each(|d| warnings.push(d));
    for complaint in read.warnings {
        warnings.push(Diagnostic::warning(Span::NONE, format!("in `{name}`: {complaint}")));
    }
    let file_name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    whole::validate(&scene, &assets, &mut warnings);
    if warnings.has_errors() {
        return Err(warnings);
    }
    hashes.insert(file_name, read.hash);
    let hash = hash(&scene, &hashes);
    let (held, peak_bytes) = (BTreeSet::new(), ledger.most());
    Ok(Loaded { scene, assets, warnings, hash, held, files, text_bytes: 0, peak_bytes })
}
