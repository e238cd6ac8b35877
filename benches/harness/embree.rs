//! Embree 3 as a contender, if the machine has it. The library is opened at run time, so that the benches do not
//! depend on it.

use glam::Vec3;
use std::ffi::{CStr, c_char, c_int, c_uint, c_void};
use std::sync::atomic::{AtomicIsize, Ordering};

/// `RTCRay` with the layout of `rtcore_ray.h` of Embree 3.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub struct Ray {
    pub origin: [f32; 3],
    pub t_near: f32,
    pub direction: [f32; 3],
    pub time: f32,
    pub t_far: f32,
    pub mask: u32,
    pub id: u32,
    pub flags: u32,
}

/// `RTCRayHit` with the layout of `rtcore_ray.h` of Embree 3.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub struct RayHit {
    pub ray: Ray,
    pub normal: [f32; 3],
    pub u: f32,
    pub v: f32,
    pub triangle: u32,
    pub geometry: u32,
    pub instance: u32,
}

/// `RTCIntersectContext` for one level of instances, as in Debian's build of Embree 3.
#[repr(C)]
struct Context {
    flags: c_int,
    filter: *const c_void,
    instance: c_uint,
}

impl RayHit {
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3, t_max: f32) -> Self {
        Self {
            ray: Ray::new(origin, direction, t_max),
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            triangle: u32::MAX,
            geometry: u32::MAX,
            instance: u32::MAX,
        }
    }
}

impl Ray {
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3, t_max: f32) -> Self {
        Self {
            origin: origin.to_array(),
            t_near: 0.0,
            direction: direction.to_array(),
            time: 0.0,
            t_far: t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
        }
    }
}

type Handle = *mut c_void;

/// The functions of Embree that the benches use; the fields follow their names.
struct Functions {
    new_device: unsafe extern "C" fn(*const c_char) -> Handle,
    release_device: unsafe extern "C" fn(Handle),
    monitor: unsafe extern "C" fn(Handle, extern "C" fn(Handle, isize, bool) -> bool, Handle),
    new_scene: unsafe extern "C" fn(Handle) -> Handle,
    scene_flags: unsafe extern "C" fn(Handle, c_int),
    new_geometry: unsafe extern "C" fn(Handle, c_int) -> Handle,
    new_buffer: unsafe extern "C" fn(Handle, c_int, c_uint, c_int, usize, usize) -> *mut c_void,
    commit_geometry: unsafe extern "C" fn(Handle),
    attach_geometry: unsafe extern "C" fn(Handle, Handle) -> c_uint,
    release_geometry: unsafe extern "C" fn(Handle),
    commit_scene: unsafe extern "C" fn(Handle),
    release_scene: unsafe extern "C" fn(Handle),
    intersect: unsafe extern "C" fn(Handle, *mut Context, *mut RayHit),
    occluded: unsafe extern "C" fn(Handle, *mut Context, *mut Ray),
}

/// The open library, and a device of it.
pub struct Embree {
    functions: Functions,
    device: Handle,
    /// Memory that the device holds in bytes, which Embree updates.
    held: Box<AtomicIsize>,
}

extern "C" fn count(held: Handle, bytes: isize, _: bool) -> bool {
    // SAFETY: `held` is the counter of the device, which outlives it.
    unsafe { &*held.cast::<AtomicIsize>() }.fetch_add(bytes, Ordering::Relaxed);
    true
}

impl Embree {
    /// Opens the library and creates a device that builds scenes with `threads` threads.
    pub fn open(threads: usize) -> Result<Self, String> {
        let functions = load()?;
        let config = std::ffi::CString::new(format!("threads={threads}")).map_err(|e| e.to_string())?;
        // SAFETY: the signatures match the header of Embree 3.
        let device = unsafe { (functions.new_device)(config.as_ptr()) };
        if device.is_null() {
            return Err("rtcNewDevice failed".into());
        }
        let held = Box::new(AtomicIsize::new(0));
        // SAFETY: the counter is boxed and dropped after the device.
        unsafe { (functions.monitor)(device, count, &raw const *held as Handle) };
        Ok(Self { functions, device, held })
    }

    /// Builds a scene of one triangle mesh. The time of this call is the build time of Embree; it includes copying the
    /// mesh.
    pub fn build(&self, positions: &[Vec3], triangles: &[[u32; 3]], robust: bool) -> Scene<'_> {
        const TRIANGLE: c_int = 0;
        const FORMAT_UINT3: c_int = 0x5003;
        const FORMAT_FLOAT3: c_int = 0x9003;
        const ROBUST: c_int = 1 << 2;
        let f = &self.functions;
        let before = self.held.load(Ordering::Relaxed);
        // SAFETY: buffers have the requested sizes (Embree pads the end of vertices itself), and handles are released
        // once.
        let handle = unsafe {
            let scene = (f.new_scene)(self.device);
            (f.scene_flags)(scene, if robust { ROBUST } else { 0 });
            let mesh = (f.new_geometry)(self.device, TRIANGLE);
            let vertices = (f.new_buffer)(mesh, 1, 0, FORMAT_FLOAT3, 12, positions.len());
            vertices.cast::<Vec3>().copy_from_nonoverlapping(positions.as_ptr(), positions.len());
            let indices = (f.new_buffer)(mesh, 0, 0, FORMAT_UINT3, 12, triangles.len());
            indices.cast::<[u32; 3]>().copy_from_nonoverlapping(triangles.as_ptr(), triangles.len());
            (f.commit_geometry)(mesh);
            (f.attach_geometry)(scene, mesh);
            (f.release_geometry)(mesh);
            (f.commit_scene)(scene);
            scene
        };
        let bytes = self.held.load(Ordering::Relaxed) - before;
        Scene { embree: self, handle, bytes: bytes.max(0) as usize }
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: the device was made by `open`, and no scene outlives it.
        unsafe { (self.functions.release_device)(self.device) }
    }
}

pub struct Scene<'a> {
    embree: &'a Embree,
    handle: Handle,
    /// Memory in bytes that stays allocated after building, including Embree's copy of the mesh.
    pub bytes: usize,
}

impl Scene<'_> {
    #[inline(always)]
    pub fn closest(&self, ray: &mut RayHit) {
        let mut context = Context { flags: 0, filter: std::ptr::null(), instance: u32::MAX };
        // SAFETY: the structures are laid out as in the header.
        unsafe { (self.embree.functions.intersect)(self.handle, &mut context, ray) }
    }

    /// Whether the ray hits anything.
    #[inline(always)]
    pub fn occluded(&self, ray: &mut Ray) -> bool {
        let mut context = Context { flags: 0, filter: std::ptr::null(), instance: u32::MAX };
        // SAFETY: as above.
        unsafe { (self.embree.functions.occluded)(self.handle, &mut context, ray) };
        ray.t_far == f32::NEG_INFINITY
    }
}

impl Drop for Scene<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle was made by `build`.
        unsafe { (self.embree.functions.release_scene)(self.handle) }
    }
}

// The fields of `Functions` state the types of the functions.
#[allow(clippy::missing_transmute_annotations)]
fn load() -> Result<Functions, String> {
    const NAMES: [&CStr; 2] = [c"libembree3.so.3", c"libembree3.so"];
    // SAFETY: names are terminated; the library stays open to the end of the process.
    let library = NAMES.iter().map(|n| unsafe { libc::dlopen(n.as_ptr(), libc::RTLD_NOW) }).find(|p| !p.is_null());
    let library = library.ok_or("libembree3.so.3 is not installed (Debian: libembree-dev)")?;
    let symbol = |name: &CStr| {
        // SAFETY: the library is open.
        let address = unsafe { libc::dlsym(library, name.as_ptr()) };
        if address.is_null() { Err(format!("libembree3 has no {}", name.to_string_lossy())) } else { Ok(address) }
    };
    // SAFETY: each type matches the function of this name in the header.
    unsafe {
        use std::mem::transmute as typed;
        Ok(Functions {
            new_device: typed::<Handle, _>(symbol(c"rtcNewDevice")?),
            release_device: typed::<Handle, _>(symbol(c"rtcReleaseDevice")?),
            monitor: typed::<Handle, _>(symbol(c"rtcSetDeviceMemoryMonitorFunction")?),
            new_scene: typed::<Handle, _>(symbol(c"rtcNewScene")?),
            scene_flags: typed::<Handle, _>(symbol(c"rtcSetSceneFlags")?),
            new_geometry: typed::<Handle, _>(symbol(c"rtcNewGeometry")?),
            new_buffer: typed::<Handle, _>(symbol(c"rtcSetNewGeometryBuffer")?),
            commit_geometry: typed::<Handle, _>(symbol(c"rtcCommitGeometry")?),
            attach_geometry: typed::<Handle, _>(symbol(c"rtcAttachGeometry")?),
            release_geometry: typed::<Handle, _>(symbol(c"rtcReleaseGeometry")?),
            commit_scene: typed::<Handle, _>(symbol(c"rtcCommitScene")?),
            release_scene: typed::<Handle, _>(symbol(c"rtcReleaseScene")?),
            intersect: typed::<Handle, _>(symbol(c"rtcIntersect1")?),
            occluded: typed::<Handle, _>(symbol(c"rtcOccluded1")?),
        })
    }
}
