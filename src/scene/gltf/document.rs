//! Parses the JSON of a glTF file: checks its version, and adapts it to the crate `gltf`, which is stricter than glTF
//! in places.

use super::features;
use crate::error::{Error, ErrorKind, Result};
use crate::image::try_collect;
use crate::scene::unrendered::Unrendered;
use glam::DVec3;
use gltf::json::Root;
use serde_json::{Map, Number, Value, json};

/// Largest integer up to which `f64` represents every integer exactly: 2^53. [rounding]
const MAX_INTEGER: f64 = 9_007_199_254_740_992.0;

/// The JSON of a file as the crate `gltf` represents it, and information that this representation lacks.
pub struct Document {
    pub root: Root,
    /// The features that are not rendered.
    pub unrendered: Vec<Unrendered>,
    /// The translation of each node in f64; the crate `gltf` rounds translations to f32.
    pub translations: Vec<DVec3>,
}

/// Parses the JSON of a glTF file.
pub fn parse(json: &[u8]) -> Result<Document> {
    let broken = |e: serde_json::Error| Error::format(format!("not a glTF file, or its JSON is broken: {e}"));
    let mut document: Value = serde_json::from_slice(json).map_err(broken)?;
    check_version(&document)?;
    let unrendered = features::unrendered(&document);
    let translations = translations(&document)?;
    tidy(&mut document);
    if let Value::Object(root) = &mut document {
        complete(root);
    }
    Ok(Document { root: serde_json::from_value(document).map_err(broken)?, unrendered, translations })
}

/// Returns the translation of each node, which is the last column of the node's matrix if the node has a matrix.
fn translations(document: &Value) -> Result<Vec<DVec3>> {
    let nodes = document.get("nodes").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let number = |list: Option<&Value>, at: usize| list.and_then(|list| list.get(at)?.as_f64()).unwrap_or(0.0);
    let column = |node: &Value| {
        let (matrix, translation) = (node.get("matrix"), node.get("translation"));
        DVec3::from_array(std::array::from_fn(|axis| match matrix {
            Some(_) => number(matrix, 12 + axis),
            None => number(translation, axis),
        }))
    };
    try_collect(nodes.iter().map(column))
}

/// Refuses files whose version is not 2.x, and files that require a version above 2.0.
fn check_version(document: &Value) -> Result<()> {
    let asset = document.get("asset");
    let stated = |key: &str| -> Result<Option<(&str, [u32; 2])>> {
        let Some(text) = asset.and_then(|asset| asset.get(key)).and_then(Value::as_str) else { return Ok(None) };
        let numbers = text.split_once('.').and_then(|(major, minor)| Some([major.parse().ok()?, minor.parse().ok()?]));
        let broken = || Error::format(format!("asset.{key} is {text:?}; it must be two numbers, such as \"2.0\""));
        numbers.map(|numbers| Some((text, numbers))).ok_or_else(broken)
    };
    let unsupported = |key: &str, text: &str| {
        let message = format!("asset.{key} is {text:?}; only glTF 2.0 is read");
        Err(Error::new(ErrorKind::Unsupported, message))
    };
    match (stated("minVersion")?, stated("version")?) {
        (Some((text, min_version)), _) if min_version > [2, 0] => unsupported("minVersion", text),
        (_, Some((text, [major, _]))) if major != 2 => unsupported("version", text),
        _ => Ok(()),
    }
}

/// Changes JSON that the crate `gltf` would not parse, in a value and all values below it:
///
/// - `extras` are removed, because they may have any type. The one property of `extras` that the importer uses,
///   [`features::IS_POINT`], becomes a property of the object itself.
/// - Whole numbers that are written as floats, such as `3.0`, become integers.
fn tidy(value: &mut Value) {
    match value {
        Value::Object(members) => {
            let extras = members.remove("extras");
            if extras.is_some_and(|extras| extras.get(features::IS_POINT) == Some(&Value::Bool(true))) {
                members.insert(features::IS_POINT.into(), Value::Bool(true));
            }
            members.values_mut().for_each(tidy);
        }
        Value::Array(items) => items.iter_mut().for_each(tidy),
        Value::Number(number) => {
            let float = number.as_f64().filter(|v| number.is_f64() && v.fract() == 0.0 && v.abs() <= MAX_INTEGER);
            if let Some(whole) = float {
                *number = Number::from(whole as i64);
            }
        }
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

/// Adds members that a glTF file may omit but that the crate `gltf` requires. Removes the animations: the importer does
/// not read them, and their targets may lack members that the crate requires.
fn complete(root: &mut Map<String, Value>) {
    root.remove("animations");
    for scene in objects(root, "scenes") {
        scene.entry("nodes").or_insert_with(|| json!([]));
    }
    for texture in objects(root, "textures") {
        // Use the WebP image; the ordinary source is a fallback for readers without WebP.
        let source = texture.get("extensions").and_then(|e| e.get(features::WEBP)?.get("source").cloned());
        if let Some(source) = source {
            texture.insert("source".into(), source);
        }
    }
}

/// Iterates over the objects in the array `list` of the JSON.
fn objects<'a>(root: &'a mut Map<String, Value>, list: &str) -> impl Iterator<Item = &'a mut Map<String, Value>> {
    let list = root.get_mut(list).and_then(Value::as_array_mut);
    list.into_iter().flatten().filter_map(Value::as_object_mut)
}
