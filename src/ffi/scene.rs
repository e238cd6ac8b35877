//! Scene
//!
//! A scene holds meshes, materials, textures, lights and cameras. Coordinates are in metres, right-handed, Y up, in
//! world space. Emission is in cd/m²; punctual lights are in candela and lux, as in glTF 2.0. A job works on the scene
//! as it was at the start of the job. Calls that change a scene wait for each other; a call that fails leaves the scene
//! unchanged.
//!
//! Most limits are checked by the calls that set the values, but some depend on several calls. In a valid scene, all
//! light is at most 1e15: each emission times each texel of its emission texture, each texel of the environment, each
//! intensity, and the luminance of the faces of each luminaire. Calls and jobs that trace a scene which is not valid,
//! export it or list its candidates for the ceiling end with LUXFER_INVALID_ARGUMENT; the message names the object.

use super::context::{Charge, Context, luxfer_context};
use super::guard::{enter, lock};
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::params::{Report, Versioned, versioned};
use super::pointer::{Out, bytes, floats, set_optional, text};
use super::status::luxfer_status;
use crate::error::{Error, ErrorKind, Result};
use crate::image::io;
use crate::job::{Job, Monitor};
use crate::quiet;
use crate::render::World;
use crate::scene::{Environment, Scene, check_light, gltf, surface};
use glam::Vec3;
use std::cell::RefCell;
use std::ffi::{c_char, c_void};
use std::path::Path;
use std::sync::{Arc, Mutex};

/// A scene. See luxfer_scene_load and luxfer_scene_create.
pub struct luxfer_scene {
    _opaque: [u8; 0],
}

/// A function of the caller that receives an exported file in parts. The argument data points to the next part, size
/// is the part's length in bytes, and user is the pointer that the caller passed to the export. The export calls the
/// function one or more times, in the order of the bytes, on the calling thread and with no lock held. Return 0 to
/// continue, any other value to stop: the export then returns LUXFER_IO. The function must not throw an exception or
/// leave by longjmp.
pub type luxfer_write_fn = Option<unsafe extern "C" fn(user: *mut c_void, data: *const c_void, size: usize) -> i32>;

/// Number of objects of each kind in a scene.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_scene_counts {
    /// sizeof(luxfer_scene_counts), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of meshes. Their indices are 0 to meshes - 1; the objects that the fields below count are numbered in
    /// this way too.
    pub meshes: u32,
    /// Number of materials.
    pub materials: u32,
    /// Number of textures.
    pub textures: u32,
    /// Number of punctual lights: points, spots, directional lights and luminaires.
    pub lights: u32,
    /// Number of cameras.
    pub cameras: u32,
    /// Number of triangles in all meshes.
    pub triangles: u64,
}

versioned!(luxfer_scene_counts, [32], {
    Self { struct_size: 32, meshes: 0, materials: 0, textures: 0, lights: 0, cameras: 0, triangles: 0 }
});

/// A planar surface of a scene: triangles in one plane, and their bounding rectangle. Seen from the room, u runs to the
/// right and v runs down, as in an image.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_surface {
    /// sizeof(luxfer_surface), set by the function that fills the struct.
    pub struct_size: u32,
    /// Reserved; always 0.
    pub reserved: u32,
    /// Number of triangles in the plane.
    pub triangles: u64,
    /// Corner of the bounding rectangle where u = v = 0, in metres.
    pub origin: [f32; 3],
    /// Unit vector of u, along the first side of the rectangle.
    pub u_axis: [f32; 3],
    /// Unit vector of v, along the second side of the rectangle.
    pub v_axis: [f32; 3],
    /// Unit normal on the side that will emit; it points into the room.
    pub normal: [f32; 3],
    /// Lengths of the rectangle's sides along u and v, in metres.
    pub size: [f32; 2],
    /// Area of the triangles in m².
    pub area: f32,
    /// Area in m² of the other triangles of the object or material whose planes are inclined to this plane by 5 to 75
    /// degrees, such as the sides of a vault; they receive no emission.
    pub sloped_area: f32,
}

versioned!(luxfer_surface, [80], {
    Self {
        struct_size: 80,
        reserved: 0,
        triangles: 0,
        origin: [0.0; 3],
        u_axis: [0.0; 3],
        v_axis: [0.0; 3],
        normal: [0.0; 3],
        size: [0.0; 2],
        area: 0.0,
        sloped_area: 0.0,
    }
});

/// The object behind a `luxfer_scene` handle.
pub(super) struct SceneObject {
    context: Arc<Context>,
    state: Mutex<SceneState>,
}

struct SceneState {
    scene: Arc<Scene>,
    /// The scene prepared for tracing; `None` if no call has prepared it since the last change.
    world: Option<Arc<World>>,
    charges: Vec<Charge>,
    /// The charge for the environment, which a later environment replaces.
    environment: Option<Charge>,
}

impl SceneState {
    fn new(scene: Arc<Scene>, charges: Vec<Charge>) -> Self {
        Self { scene, world: None, charges, environment: None }
    }

    /// Returns the scene for a change.
    fn changed(&mut self) -> &mut Scene {
        // Drop the world, which shares the scene: otherwise the change would copy the scene.
        self.world = None;
        Arc::make_mut(&mut self.scene)
    }
}

impl Owned for SceneObject {
    fn context(&self) -> &Arc<Context> {
        &self.context
    }
}

impl Handle for luxfer_scene {
    type Object = SceneObject;
    const TAG: u64 = tag(b"lux.scen");
    const NAME: &'static str = "luxfer_scene";
}

impl SceneObject {
    /// Creates the object of a scene and counts the size of the scene in the memory budget.
    pub(super) fn new(context: &Arc<Context>, scene: Arc<Scene>) -> Result<Arc<Self>> {
        let charges = vec![context.charge(cost(&scene))?];
        Ok(Arc::new(Self { context: context.clone(), state: Mutex::new(SceneState::new(scene, charges)) }))
    }

    /// Reads a scene from a file. Each part of the scene is counted in the memory budget before its memory is
    /// allocated.
    pub(super) fn read(
        context: &Arc<Context>,
        read: impl FnOnce(&dyn gltf::Budget) -> Result<Scene>,
    ) -> Result<Arc<Self>> {
        let charges = Charges { context, monitor: context.monitor(), kept: RefCell::default() };
        let scene = Arc::new(read(&charges)?);
        let state = SceneState::new(scene, charges.kept.into_inner());
        Ok(Arc::new(Self { context: context.clone(), state: Mutex::new(state) }))
    }

    /// Creates the object of a scene that a stage has made; its size is not counted in the memory budget.
    pub(super) fn of_result(context: &Arc<Context>, scene: Arc<Scene>) -> Arc<Self> {
        let state = SceneState::new(scene, Vec::new());
        Arc::new(Self { context: context.clone(), state: Mutex::new(state) })
    }

    /// Returns the scene as it is now; later changes work on a copy.
    pub(super) fn snapshot(&self) -> Arc<Scene> {
        lock(&self.state).scene.clone()
    }

    /// Changes the scene and charges `bytes` to the memory budget. If `change` fails, it must leave the scene
    /// unchanged.
    pub(super) fn change<T>(&self, bytes: u64, change: impl FnOnce(&mut Scene) -> Result<T>) -> Result<T> {
        let charge = self.context.charge(bytes)?;
        let state = &mut *lock(&self.state);
        let result = change(state.changed())?;
        if bytes > 0 {
            state.charges.push(charge);
        }
        Ok(result)
    }

    /// Changes the scene and its environment. The charge of the new environment replaces that of the environment
    /// before.
    pub(super) fn change_environment<T>(&self, charge: Charge, change: impl FnOnce(&mut Scene) -> T) -> T {
        let state = &mut *lock(&self.state);
        let result = change(state.changed());
        state.environment = Some(charge);
        result
    }

    /// Returns the prepared form of `scene` if an earlier call has prepared it for tracing.
    fn kept_world(&self, scene: &Arc<Scene>) -> Option<Arc<World>> {
        lock(&self.state).world.clone().filter(|world| Arc::ptr_eq(world.scene(), scene))
    }

    /// Returns the current scene prepared for tracing, for calls that trace before they return.
    pub(super) fn ready_world(&self) -> Result<Arc<World>> {
        let scene = self.snapshot();
        match self.kept_world(&scene) {
            Some(world) => Ok(world),
            None => {
                let monitor = self.context.monitor();
                self.context.quick.run(|| self.world(&scene, monitor.job()))
            }
        }
    }

    /// Prepares `scene` for tracing. The result is kept until the scene changes.
    pub(super) fn world(&self, scene: &Arc<Scene>, job: Job) -> Result<Arc<World>> {
        if let Some(world) = self.kept_world(scene) {
            job.report(1.0);
            return Ok(world);
        }
        // Build without the lock: building takes long, and other calls should not wait for it.
        let world = Arc::new(World::build(scene.clone(), job)?);
        let state = &mut *lock(&self.state);
        if Arc::ptr_eq(&state.scene, scene) {
            state.world = Some(world.clone());
        }
        Ok(world)
    }
}

/// Charges the parts of a scene to the memory budget of a context while the scene is read from a file.
struct Charges<'a> {
    context: &'a Arc<Context>,
    monitor: Arc<Monitor>,
    kept: RefCell<Vec<Charge>>,
}

impl gltf::Budget for Charges<'_> {
    fn keep(&self, bytes: u64) -> Result<()> {
        self.monitor.job().check()?;
        self.kept.borrow_mut().push(self.context.charge(bytes)?);
        Ok(())
    }

    fn lend(&self, bytes: u64, work: &mut dyn FnMut() -> Result<()>) -> Result<()> {
        self.monitor.job().check()?;
        let _lent = self.context.charge(bytes)?;
        work()
    }
}

/// Memory of a scene's meshes and textures in bytes.
fn cost(scene: &Scene) -> u64 {
    let textures = scene.textures.iter().map(|t| (t.image.data.len() * size_of::<f32>()) as u64);
    scene.meshes.iter().map(|mesh| mesh.bytes() as u64).chain(textures).sum()
}

/// Creates an empty scene. The caller releases *scene. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_create(
    context: *mut luxfer_context,
    scene: *mut *mut luxfer_scene,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(scene, "scene")?;
        out.set(handle::give(SceneObject::new(object.context(), Arc::default())?));
        Ok(())
    })
}

/// Saves a scene as a GLB file that contains all textures, as PNG with 8 bits per channel; path is UTF-8 and ends in
/// .glb. The environment and meshes without triangles are left out. An existing file is replaced only once the new one
/// is complete. Any thread.
/// LUXFER_INVALID_ARGUMENT for another ending, or if the scene is not valid; LUXFER_UNSUPPORTED if a texture transform
/// has shear, or the file would exceed 4 GiB; LUXFER_IO if the file cannot be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_export(scene: *mut luxfer_scene, path: *const c_char) -> luxfer_status {
    enter(scene, |object| {
        let path = Path::new(text(path, "path")?);
        if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb")) {
            return Err(Error::argument(format!("path is {}; it must end in .glb", path.display())));
        }
        io::Target::new(path)?.write(&gltf::export(&object.snapshot())?)
    })
}

/// Writes the GLB file of luxfer_scene_export without a path: write, a function of the caller, receives the bytes of
/// the file, and the pointer user. Any thread.
/// LUXFER_IO if the function returns anything but 0; LUXFER_INVALID_ARGUMENT and LUXFER_UNSUPPORTED as for
/// luxfer_scene_export.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_export_memory(
    scene: *mut luxfer_scene,
    write: luxfer_write_fn,
    user: *mut c_void,
) -> luxfer_status {
    enter(scene, |object| {
        let write =
            write.ok_or_else(|| Error::argument("write is NULL; it must be a function that takes the bytes"))?;
        let bytes = gltf::export(&object.snapshot())?;
        // SAFETY: the caller's function, with the caller's pointer.
        let answer = quiet::outside(|| unsafe { write(user, bytes.as_ptr().cast(), bytes.len()) });
        if answer != 0 {
            return Err(Error::new(ErrorKind::Io, format!("the caller's write function returned {answer}")));
        }
        Ok(())
    })
}

/// Gets the number of objects of each kind in a scene. size is sizeof *counts. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_counts(
    scene: *mut luxfer_scene,
    counts: *mut luxfer_scene_counts,
    size: usize,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Report::new(counts, size)?;
        let scene = object.snapshot();
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        out.set(luxfer_scene_counts {
            meshes: count(scene.meshes.len()),
            materials: count(scene.materials.len()),
            textures: count(scene.textures.len()),
            lights: count(scene.lights.len()),
            cameras: count(scene.cameras.len()),
            triangles: scene.meshes.iter().map(|m| m.triangles.len() as u64).sum(),
            ..luxfer_scene_counts::defaults()
        });
        Ok(())
    })
}

/// Sets the environment, which emits light from all directions, and replaces an earlier environment. If image is NULL,
/// the radiance of the environment is rgb in cd/m², each channel in [0, 1e15], from every direction. Otherwise the
/// radiance is an equirectangular image in linear values, multiplied by rgb. An image with 3 or more channels starts
/// with red, green and blue; of an image with 1 or 2 channels, the first channel is taken as grey. A product above 1e15
/// makes the scene not valid. The centre of the image is towards -z, its top towards +y, the centre of its right half
/// towards +x. Light samples of the renderer are drawn in proportion to the brightness of the image. The image is
/// copied. Any thread.
/// LUXFER_INVALID_ARGUMENT if a value of the image is negative or not finite; LUXFER_OUT_OF_MEMORY beyond the memory
/// budget.
/// cbindgen:ptrs-as-arrays=[[rgb; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_set_environment(
    scene: *mut luxfer_scene,
    image: *mut luxfer_image,
    rgb: *const f32,
) -> luxfer_status {
    enter(scene, |object| {
        let strength = read_colour(rgb)?;
        let Some(image) = Pixels::optional(&object.context, image, "image")? else {
            let charge = object.context.charge(0)?;
            object.change_environment(charge, |scene| scene.environment = Some(Environment::Constant(strength)));
            return Ok(());
        };
        if let Some(v) = image.image().data.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
            return Err(Error::argument(format!("a sample of the image is {v}; it must be finite and not negative")));
        }
        let mut image = image.image().to_rgb()?;
        for pixel in image.data.chunks_exact_mut(3) {
            (Vec3::from_slice(pixel) * strength).write_to_slice(pixel);
        }
        if image.count_non_finite() > 0 {
            return Err(Error::argument("the image times its factors is not finite; lower them"));
        }
        let bytes = (image.data.len() * size_of::<f32>()) as u64;
        let charge = object.context.charge(bytes)?;
        object.change_environment(charge, |scene| scene.environment = Some(Environment::Image(image)));
        Ok(())
    })
}

/// Finds a planar surface among the triangles of an object or material: of the planes in which these triangles lie, the
/// plane from which most of the room is visible. name is the name of the object or material, in UTF-8. The call looks
/// first for an equal name, then for a name that differs only in upper and lower case, then for a name that contains
/// name in any case, if there is exactly one. Each step looks at the objects first, then at the materials. size is
/// sizeof *found. Any thread.
/// LUXFER_NOT_FOUND if no name fits, or if name is only a part of several names: the message lists names that exist;
/// LUXFER_DEGENERATE if there is no planar surface.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_find_surface(
    scene: *mut luxfer_scene,
    name: *const c_char,
    found: *mut luxfer_surface,
    size: usize,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Report::new(found, size)?;
        let surface = surface::find(&object.snapshot(), text(name, "name")?)?;
        out.set(luxfer_surface {
            triangles: surface.triangles.len() as u64,
            origin: surface.origin.to_array(),
            u_axis: surface.u_axis.to_array(),
            v_axis: surface.v_axis.to_array(),
            normal: surface.normal.to_array(),
            size: surface.size.to_array(),
            area: surface.area,
            sloped_area: surface.sloped_area,
            ..luxfer_surface::defaults()
        });
        Ok(())
    })
}

/// Maps an emissive texture (linear, 1 or 3 channels) onto the bounding rectangle of the surface that
/// luxfer_scene_find_surface finds for name. The surface becomes a separate mesh with a copy of its material. On the
/// side towards the room, this copy emits the texture times rgb, in cd/m². The values of the texture are >= 0 and
/// finite, the channels of rgb are in [0, 1e15]; a product above 1e15 makes the scene not valid. *mesh and *material
/// receive the indices of the new mesh and material; each pointer may be NULL. Any thread.
/// Errors: as for luxfer_scene_find_surface; LUXFER_INVALID_ARGUMENT if a value is negative or not finite;
/// LUXFER_OUT_OF_MEMORY if the memory budget would be exceeded.
/// cbindgen:ptrs-as-arrays=[[rgb; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_place_emission(
    scene: *mut luxfer_scene,
    name: *const c_char,
    texture: *mut luxfer_image,
    rgb: *const f32,
    mesh: *mut u32,
    material: *mut u32,
) -> luxfer_status {
    enter(scene, |object| {
        let name = text(name, "name")?;
        let texture = handle::borrow_in(&object.context, texture, "texture")?;
        let strength = read_colour(rgb)?;
        let texture = texture.image().to_rgb()?;
        let bytes = (texture.data.len() * size_of::<f32>()) as u64;
        let placed = object.change(bytes, |scene| {
            let surface = surface::find(scene, name)?;
            surface::place(scene, &surface, texture, strength)
        })?;
        set_optional(mesh, placed.mesh as u32);
        set_optional(material, placed.material as u32);
        Ok(())
    })
}

/// Makes a colour of light from three channels; an error if a channel is out of range.
pub(super) fn colour(name: &str, channels: [f32; 3]) -> Result<Vec3> {
    let colour = Vec3::from_array(channels);
    check_light(name, colour)?;
    Ok(colour)
}

/// Reads the argument `rgb` of a call, a colour of light.
pub(super) fn read_colour(rgb: *const f32) -> Result<Vec3> {
    colour("rgb", floats(bytes(rgb.cast(), size_of::<[f32; 3]>(), "rgb")?))
}

/// The error for an index that is beyond the end of a list of `count` items.
pub(super) fn missing(what: &str, index: u32, count: usize) -> Error {
    Error::new(ErrorKind::NotFound, format!("there is no {what} {index}; there are {count}"))
}
