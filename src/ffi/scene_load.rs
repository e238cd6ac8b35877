//! Scene files
//!
//! Loads glTF 2.0 files. luxfer_get_warnings and luxfer_scene_get_requirements_text name the features of a file that
//! are not rendered.

use super::context::luxfer_context;
use super::guard::enter;
use super::handle::{self, Owned};
use super::params::{self, versioned};
use super::pointer::{Out, bytes, text};
use super::scene::{SceneObject, luxfer_scene};
use super::status::luxfer_status;
use crate::error::{Error, Result};
use crate::scene::gltf;
use std::ffi::{c_char, c_void};
use std::ops::RangeInclusive;
use std::path::Path;

/// From where a luminaire shines: a LUXFER_LUMINAIRE_ value.
pub type luxfer_luminaire_shape = i32;
/// A luminaire shines from the faces of its luminous opening, with the size that its file states: a rectangle, a disc,
/// a box, a cylinder or an ellipsoid. In each direction, all points of the faces have equal luminance: the intensity
/// divided by the projected area of the faces. The light is therefore right at any distance, and renderings show the
/// faces. A luminaire whose file states no size, or a size below 1 mm², shines from a point.
pub const LUXFER_LUMINAIRE_FACES: luxfer_luminaire_shape = 0;
/// A luminaire shines from its position as from a point, and is invisible in renderings. The light is right only at
/// distances of at least five times its size.
pub const LUXFER_LUMINAIRE_POINT: luxfer_luminaire_shape = 1;

/// Whether a shape is a point. `what` names the parameter in the error.
pub(super) fn is_point(what: &str, shape: luxfer_luminaire_shape) -> Result<bool> {
    match shape {
        LUXFER_LUMINAIRE_FACES => Ok(false),
        LUXFER_LUMINAIRE_POINT => Ok(true),
        _ => Err(Error::argument(format!("{what} is {shape}; it must be a LUXFER_LUMINAIRE_ value"))),
    }
}

/// Settings for loading a scene file. Fill them with luxfer_scene_load_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_scene_load_params {
    /// sizeof(luxfer_scene_load_params), set by luxfer_scene_load_params_init.
    pub struct_size: u32,
    /// 1: also read files outside the folder of the scene file if the scene file names them by .. or by an absolute
    /// path; 0, the default: such a name gives LUXFER_UNSUPPORTED. Set it only for scene files that you trust. Only
    /// files are read, never devices or addresses on a network.
    pub allow_external_files: u32,
    /// Length in metres of a unit of the file, in [1e-6, 1e6]; default 1, as glTF defines; 0.001 for a file in
    /// millimetres. It scales positions, but not intensities and luminances.
    pub unit: f64,
    /// 0, the default: if a scene lies far from the origin of its file, as on a national grid, its positions are made
    /// relative to an origin near the scene, which luxfer_scene_get_origin gives. 1: positions stay relative to the
    /// origin of the file; in a scene far from that origin, the rounding of coordinates to floats visibly moves
    /// vertices.
    pub keep_origin: u32,
    /// From where the luminaires of the file (EXT_lights_ies) shine: a LUXFER_LUMINAIRE_ value; default
    /// LUXFER_LUMINAIRE_FACES.
    pub luminaire_shape: luxfer_luminaire_shape,
}

const SIZE: usize = 24;

/// Range of the length of a file's unit, in metres: a micrometre to a thousand kilometres. [convention]
const UNITS: RangeInclusive<f64> = 1e-6..=1e6;

versioned!(luxfer_scene_load_params, [SIZE], {
    Self {
        struct_size: SIZE as u32,
        allow_external_files: 0,
        unit: 1.0,
        keep_origin: 0,
        luminaire_shape: LUXFER_LUMINAIRE_FACES,
    }
});

impl luxfer_scene_load_params {
    fn options(self, budget: &dyn gltf::Budget) -> Result<gltf::Options<'_>> {
        crate::error::check_range("allow_external_files", self.allow_external_files, 0, 1)?;
        crate::error::check_range("keep_origin", self.keep_origin, 0, 1)?;
        let point_luminaires = is_point("luminaire_shape", self.luminaire_shape)?;
        if !UNITS.contains(&self.unit) {
            let (low, high) = (UNITS.start(), UNITS.end());
            return Err(Error::argument(format!("unit is {}; it must lie in [{low}, {high}] metres", self.unit)));
        }
        let (is_open, keep_origin) = (self.allow_external_files == 1, self.keep_origin == 1);
        Ok(gltf::Options { budget, unit: self.unit, is_open, keep_origin, point_luminaires })
    }
}

/// Loads a scene from a glTF 2.0 file: .glb, or .gltf with the files that it names. These files must lie in its folder
/// or below, unless allow_external_files is 1. path is UTF-8. params may be NULL for the defaults. The caller releases
/// *scene. Any thread.
/// LUXFER_IO if a file cannot be read, LUXFER_FORMAT if a file is damaged or refers to something that does not exist,
/// LUXFER_UNSUPPORTED for another version of glTF, for a required extension that this library does not know and for a
/// file outside the folder, LUXFER_OUT_OF_MEMORY beyond the memory budget, LUXFER_INVALID_ARGUMENT if a setting is out
/// of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_load(
    context: *mut luxfer_context,
    path: *const c_char,
    params: *const luxfer_scene_load_params,
    scene: *mut *mut luxfer_scene,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(scene, "scene")?;
        let path = Path::new(text(path, "path")?);
        let params = params::read(params)?;
        let read = |budget: &dyn gltf::Budget| gltf::load(path, params.options(budget)?);
        out.set(handle::give(SceneObject::read(object.context(), read)?));
        Ok(())
    })
}

/// Loads a scene from a GLB or glTF file in memory, which has size bytes and starts at data. If this file names other
/// files, they are read from the folder base_path (UTF-8); if base_path is NULL, the file must not name other files.
/// Settings, ownership, threads and errors are as for luxfer_scene_load.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_load_memory(
    context: *mut luxfer_context,
    data: *const c_void,
    size: usize,
    base_path: *const c_char,
    params: *const luxfer_scene_load_params,
    scene: *mut *mut luxfer_scene,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(scene, "scene")?;
        let bytes = bytes(data.cast(), size, "data")?;
        let base = if base_path.is_null() { None } else { Some(Path::new(text(base_path, "base_path")?)) };
        let params = params::read(params)?;
        let read = |budget: &dyn gltf::Budget| gltf::import(bytes, base, params.options(budget)?);
        out.set(handle::give(SceneObject::read(object.context(), read)?));
        Ok(())
    })
}

/// Gets the origin of a scene's positions in the coordinates of its file, x, y and z in metres. It is 0 for scenes
/// near the origin, for scenes that were created by luxfer_scene_create, and with keep_origin = 1. The library takes
/// and gives all positions relative to this origin: vertices, cameras, lights, rays and calculation grids. To convert
/// a position in the coordinates of the file, subtract the origin from it in doubles. An exported file has the
/// coordinates of the loaded file. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_origin(
    scene: *mut luxfer_scene,
    x: *mut f64,
    y: *mut f64,
    z: *mut f64,
) -> luxfer_status {
    enter(scene, |object| {
        let [x, y, z] = [Out::new(x, "x")?, Out::new(y, "y")?, Out::new(z, "z")?];
        let origin = object.snapshot().origin;
        x.set(origin.x);
        y.set(origin.y);
        z.set(origin.z);
        Ok(())
    })
}
