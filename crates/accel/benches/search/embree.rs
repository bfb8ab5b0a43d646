//! Embree, where it is installed: the library is opened when the bench runs, so that nothing depends on it.
//!
//! Constants and layouts are those of Embree 4's public headers (`rtcore_common.h`, `rtcore_ray.h`).

use libloading::Library;
use std::{
    error::Error,
    ffi::{CString, c_char, c_void},
    path::{Path, PathBuf},
    ptr::null_mut,
};
use straal_math::{Ray, Vec3};

/// How carefully Embree builds.
#[derive(Clone, Copy)]
pub enum Quality {
    Low = 0,
    Medium = 1,
    High = 2,
}

type Handle = *mut c_void;

/// The functions that are used.
pub struct Embree {
    new_device: unsafe extern "C" fn(*const c_char) -> Handle,
    release_device: unsafe extern "C" fn(Handle),
    set_monitor:
        unsafe extern "C" fn(Handle, unsafe extern "C" fn(*mut c_void, isize, bool) -> bool, *mut c_void),
    new_geometry: unsafe extern "C" fn(Handle, i32) -> Handle,
    set_buffer: unsafe extern "C" fn(Handle, i32, u32, i32, usize, usize) -> *mut c_void,
    commit_geometry: unsafe extern "C" fn(Handle),
    release_geometry: unsafe extern "C" fn(Handle),
    new_scene: unsafe extern "C" fn(Handle) -> Handle,
    set_quality: unsafe extern "C" fn(Handle, i32),
    attach: unsafe extern "C" fn(Handle, Handle) -> u32,
    commit_scene: unsafe extern "C" fn(Handle),
    release_scene: unsafe extern "C" fn(Handle),
    intersect1: unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void),
    occluded1: unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void),
    intersect8: unsafe extern "C" fn(*const i32, Handle, *mut RayHit8, *mut c_void),
    /// Where the library was found.
    pub path: PathBuf,
    /// Keeps the functions' code loaded.
    _library: Library,
}

#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct RayHit {
    org: [f32; 3],
    tnear: f32,
    dir: [f32; 3],
    time: f32,
    tfar: f32,
    mask: u32,
    id: u32,
    flags: u32,
    ng: [f32; 3],
    uv: [f32; 2],
    prim: u32,
    geom: u32,
    // Room for the instance ids, whose number is a matter of how the library was built.
    inst: [u32; 9],
}

#[repr(C, align(32))]
#[derive(Clone, Copy)]
struct RayHit8 {
    org: [[f32; 8]; 3],
    tnear: [f32; 8],
    dir: [[f32; 8]; 3],
    time: [f32; 8],
    tfar: [f32; 8],
    mask: [u32; 8],
    id: [u32; 8],
    flags: [u32; 8],
    ng: [[f32; 8]; 3],
    uv: [[f32; 8]; 2],
    prim: [u32; 8],
    geom: [u32; 8],
    inst: [[u32; 8]; 8],
}

const TRIANGLES: i32 = 0;
const INDEX: i32 = 0;
const VERTEX: i32 = 1;
const UINT3: i32 = 0x5003;
const FLOAT3: i32 = 0x9003;
const NONE: u32 = u32::MAX;

impl Embree {
    /// The library that `EMBREE_LIB` names, or the system's, or that of the Python package `embreex`.
    pub fn open() -> Result<Self, Box<dyn Error>> {
        let named = std::env::var_os("EMBREE_LIB").map(PathBuf::from);
        let candidates = named.map(|p| vec![p]).unwrap_or_else(|| {
            let mut all = vec![PathBuf::from("libembree4.so.4"), PathBuf::from("libembree4.so")];
            all.extend(from_python());
            all
        });
        let mut last = None;
        for path in candidates {
            match Self::load(&path) {
                Ok(embree) => return Ok(embree),
                Err(e) => last = Some(e),
            }
        }
        Err(last.unwrap_or_else(|| "not found".into()))
    }

    fn load(path: &Path) -> Result<Self, Box<dyn Error>> {
        // SAFETY: the file is what the user calls Embree; the signatures are those of its headers.
        unsafe {
            let library = Library::new(path)?;
            Ok(Self {
                new_device: *library.get(b"rtcNewDevice\0")?,
                release_device: *library.get(b"rtcReleaseDevice\0")?,
                set_monitor: *library.get(b"rtcSetDeviceMemoryMonitorFunction\0")?,
                new_geometry: *library.get(b"rtcNewGeometry\0")?,
                set_buffer: *library.get(b"rtcSetNewGeometryBuffer\0")?,
                commit_geometry: *library.get(b"rtcCommitGeometry\0")?,
                release_geometry: *library.get(b"rtcReleaseGeometry\0")?,
                new_scene: *library.get(b"rtcNewScene\0")?,
                set_quality: *library.get(b"rtcSetSceneBuildQuality\0")?,
                attach: *library.get(b"rtcAttachGeometry\0")?,
                commit_scene: *library.get(b"rtcCommitScene\0")?,
                release_scene: *library.get(b"rtcReleaseScene\0")?,
                intersect1: *library.get(b"rtcIntersect1\0")?,
                occluded1: *library.get(b"rtcOccluded1\0")?,
                intersect8: *library.get(b"rtcIntersect8\0")?,
                path: path.to_owned(),
                _library: library,
            })
        }
    }

    /// Builds a scene of one mesh with one thread; `clock` is read around the build itself.
    pub fn build(
        &self,
        positions: &[Vec3],
        indices: &[[u32; 3]],
        quality: Quality,
        clock: impl Fn() -> f64,
    ) -> Scene<'_> {
        unsafe extern "C" fn count(sum: *mut c_void, bytes: isize, _post: bool) -> bool {
            // SAFETY: `sum` is the counter of the scene, which outlives the device.
            unsafe { *sum.cast::<isize>() += bytes };
            true
        }
        let config = CString::new("threads=1,user_threads=1,set_affinity=0").expect("no NUL inside");
        let mut bytes = Box::new(0_isize);
        // SAFETY: handles come from the functions before; buffers have the sizes that were asked for.
        unsafe {
            let device = (self.new_device)(config.as_ptr());
            let geometry = (self.new_geometry)(device, TRIANGLES);
            let v = (self.set_buffer)(geometry, VERTEX, 0, FLOAT3, 12, positions.len()).cast::<[f32; 3]>();
            for (i, p) in positions.iter().enumerate() {
                v.add(i).write(p.to_array());
            }
            let t = (self.set_buffer)(geometry, INDEX, 0, UINT3, 12, indices.len()).cast::<[u32; 3]>();
            for (i, index) in indices.iter().enumerate() {
                t.add(i).write(*index);
            }
            (self.commit_geometry)(geometry);
            let scene = (self.new_scene)(device);
            (self.set_quality)(scene, quality as i32);
            (self.attach)(scene, geometry);
            (self.release_geometry)(geometry);
            (self.set_monitor)(device, count, (&raw mut *bytes).cast());
            let start = clock();
            (self.commit_scene)(scene);
            let seconds = clock() - start;
            Scene { embree: self, device, scene, bytes, seconds }
        }
    }
}

/// The library inside an installed `embreex`.
fn from_python() -> Option<PathBuf> {
    let find = "import embreex, pathlib; print(*pathlib.Path(embreex.__file__).parents[1].glob('embreex.libs/libembree4*'))";
    let out = std::process::Command::new("python3").args(["-c", find]).output().ok()?;
    let text = String::from_utf8(out.stdout).ok()?;
    text.split_whitespace().next().map(PathBuf::from)
}

/// A built scene.
pub struct Scene<'e> {
    embree: &'e Embree,
    device: Handle,
    scene: Handle,
    /// What the build left allocated.
    bytes: Box<isize>,
    /// What the build took.
    pub seconds: f64,
}

impl Drop for Scene<'_> {
    fn drop(&mut self) {
        // SAFETY: both are alive, and nobody else has them.
        unsafe {
            (self.embree.release_scene)(self.scene);
            (self.embree.release_device)(self.device);
        }
    }
}

fn ray_hit(r: &Ray) -> RayHit {
    RayHit {
        org: r.o.to_array(),
        tnear: r.t_min,
        dir: r.d.to_array(),
        time: 0.0,
        tfar: r.t_max,
        mask: NONE,
        id: 0,
        flags: 0,
        ng: [0.0; 3],
        uv: [0.0; 2],
        prim: NONE,
        geom: NONE,
        inst: [NONE; 9],
    }
}

impl Scene<'_> {
    pub fn bytes(&self) -> isize {
        *self.bytes
    }

    /// Triangle and t of each ray, one at a time.
    pub fn closest(&self, rays: &[Ray], hits: &mut [(u32, f32)]) {
        for (ray, hit) in rays.iter().zip(hits) {
            let mut r = ray_hit(ray);
            // SAFETY: the scene is committed; the ray is laid out and aligned as the library wants it.
            unsafe { (self.embree.intersect1)(self.scene, &raw mut r, null_mut()) };
            *hit = (r.prim, r.tfar);
        }
    }

    /// Whether each ray is blocked, one at a time.
    pub fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        for (ray, blocked) in rays.iter().zip(blocked) {
            let mut r = ray_hit(ray);
            // SAFETY: as above; of the structure, only the ray is used.
            unsafe { (self.embree.occluded1)(self.scene, &raw mut r, null_mut()) };
            *blocked = r.tfar < 0.0;
        }
    }

    /// Triangle and t of each ray, in packets of eight.
    pub fn closest8(&self, rays: &[Ray], hits: &mut [(u32, f32)]) {
        let valid = AlignedMask([-1; 8]);
        for (rays, hits) in rays.chunks_exact(8).zip(hits.chunks_exact_mut(8)) {
            let get = |f: &dyn Fn(&Ray) -> f32| std::array::from_fn(|i| f(&rays[i]));
            let mut r = RayHit8 {
                org: [get(&|r| r.o.x), get(&|r| r.o.y), get(&|r| r.o.z)],
                tnear: get(&|r| r.t_min),
                dir: [get(&|r| r.d.x), get(&|r| r.d.y), get(&|r| r.d.z)],
                time: [0.0; 8],
                tfar: get(&|r| r.t_max),
                mask: [NONE; 8],
                id: [0; 8],
                flags: [0; 8],
                ng: [[0.0; 8]; 3],
                uv: [[0.0; 8]; 2],
                prim: [NONE; 8],
                geom: [NONE; 8],
                inst: [[NONE; 8]; 8],
            };
            // SAFETY: as above.
            unsafe { (self.embree.intersect8)(valid.0.as_ptr(), self.scene, &raw mut r, null_mut()) };
            for (i, hit) in hits.iter_mut().enumerate() {
                *hit = (r.prim[i], r.tfar[i]);
            }
        }
    }
}

#[repr(align(32))]
struct AlignedMask([i32; 8]);
