//! A mesh file of any kind that straal reads, with the materials that came with it.

use std::cell::RefCell;
use std::collections::{BTreeMap, HashSet};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use straal_scene::handle::Handles;
use straal_scene::{Mesh, MeshAsset, PartMaterial};

use crate::files::{self, Finder, Refusal};
use crate::{Limits, ReadError, foreign, mesh};

mod material;
mod pictures;

pub use pictures::Picture;
use pictures::Pictures;

/// What a mesh file holds.
#[derive(Clone, Debug, Default)]
pub struct MeshFile {
    /// The mesh and its materials.
    pub asset: MeshAsset,
    /// What was passed over.
    pub warnings: Vec<String>,
    /// BLAKE3 of the file and of the material libraries that it names.
    pub hash: [u8; 32],
    /// The material libraries that were read.
    pub libraries: Vec<PathBuf>,
    /// The pictures that its materials name and that are there, none of which is read.
    pub pictures: Vec<Picture>,
}

/// What reading a mesh takes besides its bytes.
pub struct Means<'a> {
    /// What a file may ask for.
    pub limits: &'a Limits,
    /// What finds material libraries and pictures.
    pub finder: &'a mut Finder,
    /// Where pictures get their handles.
    pub handles: &'a mut Handles,
    /// Whether an attribute of vertices or faces of that name is read.
    pub wanted: &'a dyn Fn(&str) -> bool,
}

/// Reads a mesh file and the material libraries that it names.
pub fn load(path: &Path, means: Means<'_>) -> Result<MeshFile, Refusal> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    // What has another name is looked at before all of it is read.
    if extension == "gz" {
        return load_packed(path, means);
    }
    if extension == "ply"
        && let Some(found) = load_in_passing(path, &means)?
    {
        return Ok(found);
    }
    let bytes = files::read_if(path, means.limits.max_bytes, |head| check(&extension, head))?;
    read(&bytes, path, means)
}

/// Reads a PLY of which never more is in memory than a part besides the mesh; `None` of one that must be there as a whole.
fn load_in_passing(path: &Path, means: &Means<'_>) -> Result<Option<MeshFile>, Refusal> {
    let limits = means.limits;
    let mut opened = files::open_if(path, limits.max_bytes, |head| check("ply", head))?;
    let hasher = RefCell::new(blake3::Hasher::new());
    hasher.borrow_mut().update(&opened.head);
    let mut source = Hashed { rest: &mut opened.rest, hasher: &hasher };
    let found = mesh::ply::read_in_passing((&opened.head, &mut source), opened.size, limits, means.wanted);
    let Some(file) = found.map_err(|e| Refusal::new(e.to_string()))? else { return Ok(None) };
    // What stands behind the mesh belongs to the file as well.
    std::io::copy(&mut source, &mut std::io::sink())
        .map_err(|e| Refusal::new(format!("it can't be read: {e}")))?;
    let asset = MeshAsset { mesh: Arc::new(file.mesh), ..MeshAsset::default() };
    let hash = hasher.borrow().finalize().into();
    Ok(Some(MeshFile { asset, warnings: file.warnings, hash, ..MeshFile::default() }))
}

/// What is read of a file, hashed on its way.
struct Hashed<'a> {
    rest: &'a mut dyn Read,
    hasher: &'a RefCell<blake3::Hasher>,
}

impl Read for Hashed<'_> {
    fn read(&mut self, to: &mut [u8]) -> std::io::Result<usize> {
        let count = self.rest.read(to)?;
        self.hasher.borrow_mut().update(&to[..count]);
        Ok(count)
    }
}

/// Reads a mesh that is packed by gzip, such as `a.ply.gz`.
fn load_packed(path: &Path, means: Means<'_>) -> Result<MeshFile, Refusal> {
    let within = path.with_extension("");
    let extension = within.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let bytes = files::read_packed(path, means.limits.max_bytes)?;
    check(&extension, &bytes)?;
    read(&bytes, path, means)
}

/// The extension of a mesh that has lost its name, by how it begins; `None` when it is no mesh.
pub fn kind_of(bytes: &[u8]) -> Option<&'static str> {
    if mesh::ply::is_ply(bytes) {
        return Some("ply");
    }
    if mesh::stl::is_stl(bytes) {
        return Some("stl");
    }
    const WORDS: [&str; 11] = ["v", "vn", "vt", "f", "o", "g", "s", "l", "mtllib", "usemtl", "vp"];
    const MOST: usize = 4096;
    let start = String::from_utf8_lossy(&bytes[..if bytes.len() < MOST { bytes.len() } else { MOST }]);
    let said = start.lines().map(str::trim).find(|l| !l.is_empty() && !l.starts_with('#'))?;
    let (word, rest) = said.split_once([' ', '\t'])?;
    (WORDS.contains(&word) && !rest.trim_start().starts_with(':')).then_some("obj")
}

/// Reads the bytes of a mesh; the libraries that it names are beside `path`.
pub fn read(bytes: &[u8], path: &Path, means: Means<'_>) -> Result<MeshFile, Refusal> {
    let Means { limits, finder, handles, wanted } = means;
    if mesh::ply::is_ply(bytes) {
        return read_ply(bytes, limits, wanted).map_err(|e| Refusal::new(e.to_string()));
    }
    let is_named_so = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("stl"));
    if is_named_so {
        return read_stl(bytes, limits, wanted).map_err(|e| Refusal::new(e.to_string()));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut shelf = Shelf {
        folder,
        limits,
        finder: &mut *finder,
        read: HashSet::new(),
        libraries: Vec::new(),
        told: Vec::new(),
        refusal: None,
    };
    let mut hasher = blake3::Hasher::new();
    hasher.update(bytes);
    let file = mesh::obj::read_with(bytes, limits, wanted, &mut |name| {
        let library = shelf.library(name)?;
        hasher.update(&library);
        Some(library)
    });
    if let Some(refusal) = shelf.refusal {
        return Err(refusal);
    }
    let file = file.map_err(|e: ReadError| Refusal::new(e.to_string()))?;
    let libraries = shelf.libraries;
    let mut warnings = shelf.told;
    warnings.extend(file.warnings);
    let mut told = material::Told::default();
    let mut materials = BTreeMap::new();
    let mut pictures = Pictures::new(folder, limits, finder, handles);
    let (extent, has_uvs) = (extent(&file.mesh), !file.mesh.uvs.is_empty());
    for (name, m) in &file.materials {
        let maps = pictures.of(name, m, has_uvs);
        let material = material::nearest(m, (&maps, extent), &mut |what| told.add(what, name));
        let emission = material::emission(m, &maps);
        materials.insert(name.clone(), PartMaterial { material, emission });
    }
    if let Some(refusal) = pictures.refusal {
        return Err(refusal);
    }
    warnings.extend(pictures.told);
    warnings.extend(told.finish());
    let asset = MeshAsset { mesh: Arc::new(file.mesh), materials: Arc::new(materials) };
    let pictures = pictures.found;
    Ok(MeshFile { asset, warnings, hash: hasher.finalize().into(), libraries, pictures })
}

/// The longest side of the box around a mesh.
fn extent(mesh: &Mesh) -> f64 {
    let mut longest = 0.0;
    for k in 0..3 {
        let (mut low, mut high) = (f32::MAX, f32::MIN);
        for p in mesh.positions.iter().map(|p| p[k]).filter(|v| v.is_finite()) {
            (low, high) = (if p < low { p } else { low }, if p > high { p } else { high });
        }
        let side = f64::from(high) - f64::from(low);
        longest = if side > longest { side } else { longest };
    }
    longest
}

fn read_ply(bytes: &[u8], limits: &Limits, wanted: &dyn Fn(&str) -> bool) -> Result<MeshFile, ReadError> {
    let file = mesh::ply::read_with(bytes, limits, wanted)?;
    let asset = MeshAsset { mesh: Arc::new(file.mesh), ..MeshAsset::default() };
    let hash = blake3::hash(bytes).into();
    Ok(MeshFile { asset, warnings: file.warnings, hash, ..MeshFile::default() })
}

fn read_stl(bytes: &[u8], limits: &Limits, wanted: &dyn Fn(&str) -> bool) -> Result<MeshFile, ReadError> {
    let file = mesh::stl::read(bytes, limits, wanted)?;
    let asset = MeshAsset { mesh: Arc::new(file.mesh), ..MeshAsset::default() };
    let hash = blake3::hash(bytes).into();
    Ok(MeshFile { asset, warnings: file.warnings, hash, ..MeshFile::default() })
}

/// Whether a file of this extension that begins so can be a mesh.
fn check(extension: &str, head: &[u8]) -> Result<(), Refusal> {
    if mesh::ply::is_ply(head) {
        return Ok(());
    }
    let is_stl = head.starts_with(b"solid ");
    match extension {
        "stl" => Ok(()),
        "ply" if is_stl => {
            Err(Refusal::new("it is named .ply, but is an STL file").help("its name must end in .stl"))
        }
        "ply" => Err(Refusal::new("not a PLY file: it doesn't begin with 'ply'")),
        "obj" if head.contains(&0) => Err(Refusal::new("it is named .obj, but is no text: OBJ meshes are")),
        "obj" => Ok(()),
        "" => Err(Refusal::new("a mesh must be a .ply, .obj or .stl file, and this name has no extension")),
        _ => {
            let what = foreign::kind(extension).map_or(String::new(), |what| format!("it is {what}: "));
            let program = "most programs that show meshes, such as Blender and MeshLab, write one of these";
            Err(Refusal::new(format!("{what}a mesh must be a .ply, .obj or .stl file, found .{extension}"))
                .help(program))
        }
    }
}

/// The largest material library, in bytes.
const MOST_LIBRARY: u64 = 1 << 28;

/// Where the material libraries of a mesh are.
struct Shelf<'a> {
    folder: &'a Path,
    limits: &'a Limits,
    finder: &'a mut Finder,
    /// What was read already, under whatever name.
    read: HashSet<PathBuf>,
    /// Those that were read, as they were found.
    libraries: Vec<PathBuf>,
    told: Vec<String>,
    /// The first that must not be read.
    refusal: Option<Refusal>,
}

impl Shelf<'_> {
    /// The bytes of a library; none of one that was read before or can't be.
    fn library(&mut self, name: &str) -> Option<Vec<u8>> {
        let found = match self.finder.find(self.folder, name) {
            Ok(found) => Ok(Some(found)),
            Err(refusal) if refusal.is_missing() => self.finder.find_beside(self.folder, name).map(|found| {
                found.map(|f| files::Found {
                    instead: f.path.file_name().map(|n| n.to_string_lossy().into_owned()),
                    ..f
                })
            }),
            Err(refusal) => Err(refusal),
        };
        let found = match found {
            Ok(found) => found?,
            Err(refusal) => {
                self.refusal.get_or_insert(refusal);
                return None;
            }
        };
        let real = found.path.canonicalize().unwrap_or_else(|_| found.path.clone());
        if self.read.contains(&real) {
            return Some(Vec::new());
        }
        let shown = crate::read_error::quoted(name.as_bytes());
        match files::read(&found.path, self.limits.max_bytes.min(MOST_LIBRARY)) {
            Ok(bytes) => {
                if let Some(instead) = found.instead {
                    let instead = crate::read_error::quoted(instead.as_bytes());
                    self.tell(format!("there is no material library {shown}: {instead} is read"));
                }
                self.read.insert(real);
                self.libraries.push(found.path);
                Some(bytes)
            }
            // A folder `a` is no reason against the file `a b.mtl`.
            Err(_) if found.path.is_dir() => None,
            Err(refusal) => {
                self.tell(format!("the material library {shown} is not read: {refusal}"));
                self.read.insert(real);
                Some(Vec::new())
            }
        }
    }

    fn tell(&mut self, what: String) {
        const MOST: usize = 50;
        if self.told.len() < MOST {
            self.told.push(what);
        }
    }
}
