//! Lists the glTF extensions that are read, and finds the features of a file that are not rendered.

use super::glossiness::is_convertible;
use crate::scene::unrendered::{Unrendered, note};
use gltf::json::extensions::material::PbrSpecularGlossiness;
use serde_json::Value;

/// Extension for measured luminaires as IES files.
pub const IES: &str = "EXT_lights_ies";
/// Name of a property in the `extras` of a luminaire. If it is true, the luminaire shines from a point, even if its IES
/// file states a luminous size.
pub const IS_POINT: &str = "isPoint";
/// Extension for many instances of a node's mesh, each with its own transform.
pub const INSTANCING: &str = "EXT_mesh_gpu_instancing";
/// Extension for primitives in Draco's compression.
pub const DRACO: &str = "KHR_draco_mesh_compression";
/// The two names of the extension for buffer views in meshoptimizer's compression.
pub const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
/// Extension for textures in WebP files.
pub const WEBP: &str = "EXT_texture_webp";

/// Extension for the strength and the colour of the reflections of dielectrics.
pub const SPECULAR: &str = "KHR_materials_specular";

/// Extension for a clear layer on top of a material.
pub const CLEAR_COAT: &str = "KHR_materials_clearcoat";

/// Extension for materials of the specular-glossiness workflow.
const GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// Extensions that this importer reads. A file that requires any other extension is refused. Of a material with
/// variants, only the default variant is read.
pub const READ: [&str; 18] = [
    DRACO,
    IES,
    INSTANCING,
    MESHOPT[0],
    MESHOPT[1],
    WEBP,
    GLOSSINESS,
    SPECULAR,
    CLEAR_COAT,
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Extensions that need not be read to get the right picture. (With `MSFT_texture_dds`, the file also contains the
/// image in a format that this importer reads.)
const INVISIBLE: [&str; 4] = ["KHR_animation_pointer", "KHR_xmp", "KHR_xmp_json_ld", "MSFT_texture_dds"];

/// A property of an extension, and the default value with which the extension has no effect.
type Neutral = (&'static str, f64);

/// Material extensions that are not rendered. For each: its name, the missing effect, and the properties that turn the
/// effect off if they have their default values. [convention: glTF extensions]
const MATERIALS: [(&str, &str, &[Neutral]); 5] = [
    ("KHR_materials_anisotropy", "reflections are not stretched", &[("anisotropyStrength", 0.0)]),
    ("KHR_materials_diffuse_transmission", "no light passes diffusely", &[("diffuseTransmissionFactor", 0.0)]),
    ("KHR_materials_dispersion", "all wavelengths are refracted alike", &[("dispersion", 0.0)]),
    ("KHR_materials_iridescence", "thin films have no colours", &[("iridescenceFactor", 0.0)]),
    ("KHR_materials_sheen", "there is no sheen of cloth", &[("sheenColorFactor", 0.0)]),
];

/// Material extensions that are rendered on all materials but solid glass. The columns are the same as in
/// [`MATERIALS`].
const NOT_ON_SOLIDS: [(&str, &str, &[Neutral]); 2] = [
    (
        SPECULAR,
        "reflections of solid glass have their usual strength and colour",
        &[("specularFactor", 1.0), ("specularColorFactor", 1.0)],
    ),
    (CLEAR_COAT, "there is no clear coat on solid glass", &[("clearcoatFactor", 0.0)]),
];

/// The arrays of objects in the JSON, and the word by which a message names one object of each array.
const LISTS: [(&str, &str); 10] = [
    ("materials", "material"),
    ("meshes", "mesh"),
    ("nodes", "node"),
    ("textures", "texture"),
    ("images", "image"),
    ("cameras", "camera"),
    ("scenes", "scene"),
    ("accessors", "accessor"),
    ("bufferViews", "buffer view"),
    ("buffers", "buffer"),
];

/// Lists all features of a file that are not rendered and can be recognised from its JSON.
pub fn unrendered(document: &Value) -> Vec<Unrendered> {
    let mut list = Vec::new();
    for (name, kind) in LISTS {
        for (index, object) in items(document, name) {
            let place = || place(kind, index, object);
            extensions(&mut list, object, &place);
            match name {
                "materials" => {
                    glossiness(&mut list, object, &place);
                    solid(&mut list, object, &place);
                    coat_normals(&mut list, object, &place);
                }
                "meshes" => mesh(&mut list, object, &place),
                "nodes" => weights(&mut list, object, shown(document, object), &place),
                "textures" => texture(&mut list, object, &place),
                "cameras" if object.get("type").and_then(Value::as_str) == Some("orthographic") => {
                    note(&mut list, "orthographic cameras", "they are left out", place);
                }
                _ => {}
            }
        }
    }
    for (index, animation) in items(document, "animations") {
        note(&mut list, "animations", "the scene is shown at rest", || place("animation", index, animation));
    }
    list
}

fn items<'a>(object: &'a Value, list: &str) -> impl Iterator<Item = (usize, &'a Value)> {
    object.get(list).and_then(Value::as_array).into_iter().flatten().enumerate()
}

fn place(kind: &str, index: usize, object: &Value) -> String {
    match object.get("name").and_then(Value::as_str).filter(|name| !name.is_empty()) {
        Some(name) => format!("{kind} {name:?}"),
        None => format!("{kind} {index}"),
    }
}

/// Reports the extensions of an object that are not rendered.
fn extensions(list: &mut Vec<Unrendered>, object: &Value, place: &dyn Fn() -> String) {
    for (name, settings) in object.get("extensions").and_then(Value::as_object).into_iter().flatten() {
        // Skip Basis Universal textures: `texture` reports them if they lack an image in another format.
        if READ.contains(&name.as_str()) || INVISIBLE.contains(&name.as_str()) || name == BASISU {
            continue;
        }
        match MATERIALS.iter().find(|known| known.0 == name) {
            Some((_, _, neutral)) if does_nothing(settings, neutral) => {}
            Some((_, effect, _)) => note(list, name, effect, place),
            None => note(list, name, "the extension is not read", place),
        }
    }
}

/// Whether the properties in `neutral` all have their default values, so that the extension has no effect. False if
/// `neutral` is empty, or if a texture gives the extension an effect.
fn does_nothing(settings: &Value, neutral: &[Neutral]) -> bool {
    let is = |value: &Value, wanted: f64| match value {
        Value::Array(numbers) => numbers.iter().all(|number| number.as_f64() == Some(wanted)),
        value => value.as_f64() == Some(wanted),
    };
    // A texture is multiplied by its factor, which has its default value here. With a default of 0 the texture has no
    // effect; with a default of 1 it has an effect.
    let has_texture = || settings.as_object().is_some_and(|s| s.keys().any(|key| key.ends_with("Texture")));
    let is_factor = neutral.iter().any(|&(_, wanted)| wanted != 0.0);
    !neutral.is_empty()
        && neutral.iter().all(|&(key, wanted)| settings.get(key).is_none_or(|value| is(value, wanted)))
        && !(is_factor && has_texture())
}

/// Reports the extensions of the material of solid glass that are rendered for other materials only.
fn solid(list: &mut Vec<Unrendered>, material: &Value, place: &dyn Fn() -> String) {
    let settings = |name: &str| material.get("extensions").and_then(|extensions| extensions.get(name));
    let factor = |name, key| settings(name).and_then(|settings| settings.get(key)?.as_f64()).unwrap_or(0.0);
    if factor("KHR_materials_volume", "thicknessFactor") > 0.0
        && factor("KHR_materials_transmission", "transmissionFactor") > 0.0
    {
        for (name, effect, neutral) in NOT_ON_SOLIDS {
            if settings(name).is_some_and(|settings| !does_nothing(settings, neutral)) {
                note(list, name, effect, place);
            }
        }
    }
}

/// Reports a clear coat whose normal texture is not that of its material.
fn coat_normals(list: &mut Vec<Unrendered>, material: &Value, place: &dyn Fn() -> String) {
    let Some(coat) = material.get("extensions").and_then(|extensions| extensions.get(CLEAR_COAT)) else { return };
    if !does_nothing(coat, &[("clearcoatFactor", 0.0)])
        && coat.get("clearcoatNormalTexture") != material.get("normalTexture")
    {
        note(list, CLEAR_COAT, "the clear coat has the normals of the material below", place);
    }
}

/// Reports a specular-glossiness material that cannot be converted to metallic-roughness.
fn glossiness(list: &mut Vec<Unrendered>, material: &Value, place: &dyn Fn() -> String) {
    let settings = material.get("extensions").and_then(|e| e.get(GLOSSINESS));
    let settings = settings.and_then(|s| serde_json::from_value::<PbrSpecularGlossiness>(s.clone()).ok());
    if settings.is_some_and(|settings| !is_convertible(&settings)) {
        note(
            list,
            GLOSSINESS,
            "its textures differ in their coordinates; the metallic-roughness values are used",
            place,
        );
    }
}

/// Extension for textures in Basis Universal files, which this importer does not read.
const BASISU: &str = "KHR_texture_basisu";

fn texture(list: &mut Vec<Unrendered>, texture: &Value, place: &dyn Fn() -> String) {
    let has = |name: &str| texture.get("extensions").is_some_and(|e| e.get(name).is_some());
    if texture.get("source").is_none() && has(BASISU) {
        note(list, BASISU, "the texture is left out", place);
    }
}

fn mesh(list: &mut Vec<Unrendered>, mesh: &Value, place: &dyn Fn() -> String) {
    for (_, primitive) in items(mesh, "primitives") {
        // Modes below 4 are points, lines, line loops and line strips.
        if primitive.get("mode").and_then(Value::as_f64).is_some_and(|mode| mode < 4.0) {
            note(list, "points and lines", "they are left out", place);
        }
        extensions(list, primitive, place);
    }
    weights(list, mesh, Some(mesh), place);
}

/// Returns the JSON of the mesh to which a node refers; `None` if the node has no mesh.
fn shown<'a>(document: &'a Value, node: &Value) -> Option<&'a Value> {
    let index = node.get("mesh")?.as_f64()?;
    document.get("meshes")?.get(index as usize)
}

/// Reports morph targets that change colours or texture coordinates and have a weight other than 0. These changes are
/// not rendered: of a morph target, only the displacements of positions and normals are applied.
fn weights(list: &mut Vec<Unrendered>, object: &Value, mesh: Option<&Value>, place: &dyn Fn() -> String) {
    let Some(mesh) = mesh else { return };
    let mixed = |(_, target): (&(usize, &Value), &Value)| {
        let is_seen = |name: &String| name.starts_with("COLOR_") || name.starts_with("TEXCOORD_");
        target.as_object().is_some_and(|target| target.keys().any(is_seen))
    };
    for (_, primitive) in items(mesh, "primitives") {
        let weights = items(object, "weights").collect::<Vec<_>>();
        let targets = items(primitive, "targets").map(|(_, target)| target);
        let mut pairs = weights.iter().zip(targets).filter(|((_, weight), _)| weight.as_f64() != Some(0.0));
        if pairs.any(mixed) {
            note(list, "morph targets of colours or texture coordinates", "only the shape is mixed", place);
        }
    }
}
