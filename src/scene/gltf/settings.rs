//! Reads the settings of material extensions that the crate `gltf` does not parse.

use crate::error::{Error, Result};
use glam::Vec3;
use gltf::json::material::Material;
use gltf::json::texture;
use serde_json::Value;

/// The settings of one extension of a material.
#[derive(Clone, Copy)]
pub struct ExtensionSettings<'a> {
    name: &'a str,
    /// `None` if the material does not have the extension.
    value: Option<&'a Value>,
}

impl<'a> ExtensionSettings<'a> {
    pub fn new(material: &'a Material, name: &'a str) -> Self {
        Self { name, value: material.extensions.as_ref().and_then(|extensions| extensions.others.get(name)) }
    }

    /// Returns a number; `default` if it is absent.
    pub fn number(&self, key: &str, default: f32) -> Result<f32> {
        let Some(value) = self.get(key) else { return Ok(default) };
        value.as_f64().map(|number| number as f32).ok_or_else(|| self.broken(key, "a number"))
    }

    /// Returns a colour; `default` in all channels if it is absent.
    pub fn colour(&self, key: &str, default: f32) -> Result<Vec3> {
        let Some(value) = self.get(key) else { return Ok(Vec3::splat(default)) };
        let channels = value.as_array().map_or(&[][..], Vec::as_slice);
        let [Some(r), Some(g), Some(b)] = [0, 1, 2].map(|i| channels.get(i).and_then(Value::as_f64)) else {
            return Err(self.broken(key, "three numbers"));
        };
        Ok(Vec3::new(r as f32, g as f32, b as f32))
    }

    /// Returns a reference to a texture; `None` if it is absent.
    pub fn texture(&self, key: &str) -> Result<Option<texture::Info>> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let info = serde_json::from_value(value.clone());
        info.map(Some).map_err(|_| self.broken(key, "a reference to a texture"))
    }

    fn get(&self, key: &str) -> Option<&'a Value> {
        self.value?.get(key)
    }

    fn broken(&self, key: &str, wanted: &str) -> Error {
        Error::format(format!("{key} of {} is not {wanted}", self.name))
    }
}
