//! Contract of loading scene files at the C boundary: settings, and warnings about the file.

use crate::host::{context, made, message};
use luxfer::ffi::*;
use std::ffi::{CStr, CString, c_char};
use std::path::PathBuf;
use std::ptr::{null, null_mut};

/// A glTF file with one triangle, `height` units high, whose material is anisotropic; and the content of its buffer,
/// which the file expects at `uri`.
fn gltf(height: f32, uri: &str) -> (String, Vec<u8>) {
    let numbers = [0.0, 0.0, 0.0, height, 0.0, 0.0, 0.0, height, 0.0];
    let bytes = numbers.iter().flat_map(|v: &f32| v.to_le_bytes()).collect();
    let file = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "materials":[{{"name":"Paint","extensions":{{"KHR_materials_anisotropy":{{"anisotropyStrength":1}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "buffers":[{{"uri":"{uri}","byteLength":36}}],"bufferViews":[{{"buffer":0,"byteLength":36}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}]}}"#
    );
    (file, bytes)
}

/// A temporary folder with the file of `gltf` in a subfolder, and its buffer at the path that the file states.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, height: f32, uri: &str) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
        let (file, bytes) = gltf(height, uri);
        std::fs::create_dir_all(folder.join("scene")).unwrap();
        std::fs::write(folder.join("scene/room.gltf"), file).unwrap();
        std::fs::write(folder.join("scene").join(uri), bytes).unwrap();
        Self(folder)
    }

    fn file(&self) -> CString {
        CString::new(self.0.join("scene/room.gltf").to_str().unwrap()).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn params() -> luxfer_scene_load_params {
    let mut params = luxfer_scene_load_params {
        struct_size: 0,
        allow_external_files: 7,
        unit: 7.0,
        keep_origin: 7,
        luminaire_shape: 7,
    };
    assert_eq!(
        unsafe { luxfer_init(LUXFER_STRUCT_SCENE_LOAD_PARAMS, (&raw mut params).cast(), size_of_val(&params)) },
        LUXFER_OK
    );
    assert_eq!((params.allow_external_files, params.unit), (0, 1.0));
    params
}

/// Code and severity of each warning of a scene, and its message and advice as one text.
fn warnings(scene: *mut luxfer_scene) -> Vec<(luxfer_warning_code, f64, String)> {
    let list = made(|out| unsafe { luxfer_get_warnings(scene.cast(), out) });
    let mut count = 0;
    assert_eq!(unsafe { luxfer_warnings_get_count(list, &mut count) }, LUXFER_OK);
    let read = |index| {
        let mut warning = unsafe { std::mem::zeroed::<luxfer_warning>() };
        assert_eq!(unsafe { luxfer_warnings_get(list, index, &mut warning, size_of_val(&warning)) }, LUXFER_OK);
        assert_eq!((warning.stage, warning.has_place), (LUXFER_STAGE_SCENE, 0));
        let [message, advice] =
            [warning.message, warning.advice].map(|text| unsafe { CStr::from_ptr(text) }.to_str().unwrap());
        let words = format!("{message}: {advice}");
        (warning.code, warning.severity, words)
    };
    let found = (0..count).map(read).collect();
    assert_eq!(unsafe { luxfer_release(list.cast()) }, LUXFER_OK);
    found
}

#[test]
fn a_scene_in_another_unit_is_noticed_and_can_be_scaled() {
    let (context, folder) = (context(1), Folder::new("unit", 2700.0, "room.bin"));
    let file = folder.file();
    let scene = made(|out| unsafe { luxfer_scene_load(context, file.as_ptr(), null(), out) });
    let found = warnings(scene);
    assert_eq!(
        found.iter().map(|w| w.0).collect::<Vec<_>>(),
        [LUXFER_WARNING_IMPLAUSIBLE_SIZE, LUXFER_WARNING_NOT_RENDERED]
    );
    assert_eq!(found[0].1, 2700.0);
    assert!(found[0].2.contains("millimetre") && found[0].2.contains("unit = 0.001"), "{}", found[0].2);
    assert!(found[1].2.contains("KHR_materials_anisotropy") && found[1].2.contains("\"Paint\""), "{}", found[1].2);
    unsafe { assert_eq!(luxfer_release(scene.cast()), LUXFER_OK) };

    let params = luxfer_scene_load_params { unit: 0.001, ..params() };
    let scene = made(|out| unsafe { luxfer_scene_load(context, file.as_ptr(), &params, out) });
    assert_eq!(warnings(scene).iter().map(|w| w.0).collect::<Vec<_>>(), [LUXFER_WARNING_NOT_RENDERED]);
    let (mut positions, mut text) = ([0.0f32; 9], [0 as c_char; 4096]);
    unsafe {
        let status = luxfer_scene_read_vertices(scene, 0, LUXFER_VERTEX_POSITION, positions.as_mut_ptr(), 3);
        assert_eq!((status, positions[3]), (LUXFER_OK, 2.7));
        let status = luxfer_scene_get_requirements_text(scene, text.as_mut_ptr(), text.len(), null_mut());
        assert_eq!(status, LUXFER_OK, "{}", message(context));
        let text = CStr::from_ptr(text.as_ptr()).to_str().unwrap();
        assert!(text.lines().any(|l| l.starts_with("KHR_materials_anisotropy: not rendered")), "{text}");
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn files_outside_the_folder_are_read_only_with_leave() {
    let (context, folder) = (context(1), Folder::new("outside", 2.7, "../room.bin"));
    let file = folder.file();
    let mut scene = null_mut();
    unsafe {
        assert_eq!(luxfer_scene_load(context, file.as_ptr(), null(), &mut scene), LUXFER_UNSUPPORTED);
        assert!(message(context).contains("luxfer_scene_load_params.allow_external_files"), "{}", message(context));
        let open = luxfer_scene_load_params { allow_external_files: 1, ..params() };
        assert_eq!(luxfer_scene_load(context, file.as_ptr(), &open, &mut scene), LUXFER_OK);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        // Load from memory too, with the folder as base.
        let bytes = std::fs::read(folder.0.join("scene/room.gltf")).unwrap();
        let base = CString::new(folder.0.join("scene").to_str().unwrap()).unwrap();
        let mut load = |params: *const luxfer_scene_load_params| {
            let (data, base) = (bytes.as_ptr().cast(), base.as_ptr());
            luxfer_scene_load_memory(context, data, bytes.len(), base, params, &mut scene)
        };
        assert_eq!(load(null()), LUXFER_UNSUPPORTED);
        assert_eq!(load(&open), LUXFER_OK);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let (context, folder) = (context(1), Folder::new("range", 2.7, "room.bin"));
    let (file, mut scene) = (folder.file(), null_mut());
    let mut load = |params| unsafe { luxfer_scene_load(context, file.as_ptr(), &params, &mut scene) };
    for unit in [0.0, -1.0, 1e-7, 1e7, f64::INFINITY, f64::NAN] {
        assert_eq!(load(luxfer_scene_load_params { unit, ..params() }), LUXFER_INVALID_ARGUMENT, "{unit}");
        assert!(message(context).contains("unit is"), "{}", message(context));
    }
    assert_eq!(load(luxfer_scene_load_params { allow_external_files: 2, ..params() }), LUXFER_INVALID_ARGUMENT);
    assert_eq!(load(luxfer_scene_load_params { struct_size: 3, ..params() }), LUXFER_INVALID_ARGUMENT);
    assert!(scene.is_null());
    assert_eq!(unsafe { luxfer_release(context.cast()) }, LUXFER_OK);
}

#[test]
fn a_scene_on_a_national_grid_has_an_origin_of_its_own() {
    let context = context(1);
    // A triangle 300 km east and 5,000 km south of the origin.
    let file = br#"{ "asset": { "version": "2.0" }, "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "translation": [300000.125, 0, -5000000.5] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "buffers": [{ "byteLength": 40, "uri":
            "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAA==" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }, { "buffer": 0, "byteOffset": 36, "byteLength": 4 }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR" }] }"#;
    let load = |params: &luxfer_scene_load_params| {
        made(|out| unsafe { luxfer_scene_load_memory(context, file.as_ptr().cast(), file.len(), null(), params, out) })
    };
    let read = |scene: *mut luxfer_scene| {
        let (mut at, mut positions) = ([9.0f64; 3], [0.0f32; 9]);
        unsafe {
            let [x, y, z] = &mut at;
            assert_eq!(luxfer_scene_get_origin(scene, x, y, z), LUXFER_OK);
            assert_eq!(luxfer_scene_get_origin(scene, null_mut(), y, z), LUXFER_INVALID_ARGUMENT);
            assert_eq!(
                luxfer_scene_read_vertices(scene, 0, LUXFER_VERTEX_POSITION, positions.as_mut_ptr(), 3),
                LUXFER_OK
            );
        }
        let codes: Vec<_> = warnings(scene).iter().map(|w| w.0).collect();
        unsafe { assert_eq!(luxfer_release(scene.cast()), LUXFER_OK) };
        (at, positions, codes)
    };
    let (at, positions, codes) = read(load(&params()));
    assert_eq!(codes, [LUXFER_WARNING_FAR_FROM_ORIGIN]);
    assert_eq!(at.map(|v| v % 256.0), [0.0; 3]);
    assert_eq!(at[0] + f64::from(positions[3]), 300_001.125);
    assert_eq!(at[2] + f64::from(positions[2]), -5_000_000.5);
    let (at, positions, codes) = read(load(&luxfer_scene_load_params { keep_origin: 1, ..params() }));
    assert_eq!((at, positions[3], codes), ([0.0; 3], 300_001.13, vec![LUXFER_WARNING_FAR_FROM_ORIGIN]));
    let mut scene = null_mut();
    let wrong = luxfer_scene_load_params { keep_origin: 2, ..params() };
    unsafe {
        let status = luxfer_scene_load_memory(context, file.as_ptr().cast(), file.len(), null(), &wrong, &mut scene);
        assert_eq!(status, LUXFER_INVALID_ARGUMENT);
        assert!(message(context).contains("keep_origin is 2"), "{}", message(context));
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}
