//! Writes a scene as a single GLB file.

use super::features::{CLEAR_COAT, IES, IS_POINT, SPECULAR};
use super::material::transform_matrix;
use crate::error::{Error, ErrorKind, Result};
use crate::image::colour::srgb_to_linear;
use crate::image::io::{self, Encoding};
use crate::maths;
use crate::photometry::ies;
use crate::scene::{
    AlphaMode, Camera, ClearCoat, Material, Mesh, PunctualLight, Scene, Specular, TextureRef, Wrap, c90,
};
use glam::{DMat3, DQuat, DVec3, Mat3, Vec2, Vec3};
use serde_json::{Map, Value, json};

/// Enumeration values of accessors and buffer views (glTF 2.0, sections 5.1.3 and 5.11.5).
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Distance of the cameras' near plane in metres. glTF requires one, but path tracers do not use it. [convention]
const NEAR: f32 = 0.01;

/// Encodes a scene as GLB, with one node per mesh, camera and light, and textures as embedded PNG.
///
/// An emission texture brighter than 1 is divided by its peak, and the emission factor is multiplied by that peak. An
/// emission factor above 1 is stored with `KHR_materials_emissive_strength`. PNG has 8 bits per channel. The
/// distributions of luminaires are embedded as IES files (`EXT_lights_ies`). Meshes without triangles and the
/// environment are left out, because glTF cannot represent them.
///
/// Errors: the errors of [`Scene::validate`]; `Unsupported` for a texture transform with shear or a file of more than 4
/// GiB.
pub fn export(scene: &Scene) -> Result<Vec<u8>> {
    scene.validate()?;
    let mut writer = Writer::default();
    for material in &scene.materials {
        let json =
            writer.material(scene, material).map_err(|e| e.context(format_args!("material {:?}", material.name)))?;
        writer.materials.push(json);
    }
    for mesh in scene.meshes.iter().filter(|m| !m.triangles.is_empty()) {
        writer.mesh(mesh)?;
    }
    for camera in &scene.cameras {
        writer.camera(camera);
    }
    for (i, light) in scene.lights.iter().enumerate() {
        writer.light(scene, i, light)?;
    }
    writer.into_glb(scene.origin)
}

/// Identifies an image in the file: the index of its texture, its encoding, and the divisor of its values.
type ImageKey = (usize, Encoding, f32);

#[derive(Default)]
struct Writer {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    images: Vec<Value>,
    image_keys: Vec<ImageKey>,
    textures: Vec<Value>,
    materials: Vec<Value>,
    meshes: Vec<Value>,
    cameras: Vec<Value>,
    lights: Vec<Value>,
    /// The IES files written so far, one per distribution; `profile_keys` holds the indices of these distributions in
    /// the scene.
    profiles: Vec<Value>,
    profile_keys: Vec<usize>,
    nodes: Vec<Value>,
    extensions: Vec<&'static str>,
}

impl Writer {
    fn uses(&mut self, extension: &'static str) {
        if !self.extensions.contains(&extension) {
            self.extensions.push(extension);
        }
    }

    /// Appends bytes, padded to a multiple of 4 for the alignment of accessors, and returns the index of their new
    /// buffer view.
    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> Result<usize> {
        let out_of_memory = |_| Error::new(ErrorKind::OutOfMemory, "could not allocate the GLB file");
        self.binary.try_reserve(bytes.len() + 3).map_err(out_of_memory)?;
        let mut view = json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.binary.extend_from_slice(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.views.push(view);
        Ok(self.views.len() - 1)
    }

    fn accessor<T: bytemuck::NoUninit>(
        &mut self,
        data: &[T],
        kind: &str,
        component: u32,
        bounds: Option<(Vec3, Vec3)>,
    ) -> Result<usize> {
        let target = if component == UNSIGNED_INT { ELEMENT_ARRAY_BUFFER } else { ARRAY_BUFFER };
        let view = self.view(bytemuck::cast_slice(data), Some(target))?;
        let per_element = if component == UNSIGNED_INT { 3 } else { 1 };
        let mut accessor = json!({
            "bufferView": view, "componentType": component, "count": data.len() * per_element, "type": kind
        });
        if let Some((low, high)) = bounds {
            accessor["min"] = json!(low.to_array());
            accessor["max"] = json!(high.to_array());
        }
        self.accessors.push(accessor);
        Ok(self.accessors.len() - 1)
    }

    fn mesh(&mut self, mesh: &Mesh) -> Result<()> {
        let low = mesh.positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = mesh.positions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let mut attributes = Map::new();
        let positions = self.accessor(&mesh.positions, "VEC3", FLOAT, Some((low, high)))?;
        attributes.insert("POSITION".into(), positions.into());
        if !mesh.normals.is_empty() {
            attributes.insert("NORMAL".into(), self.accessor(&mesh.normals, "VEC3", FLOAT, None)?.into());
        }
        // glTF requires sets of texture coordinates to be numbered without gaps: if only the second exists, write
        // zeros as the first.
        let [first, second] = &mesh.uvs;
        if !first.is_empty() {
            attributes.insert("TEXCOORD_0".into(), self.accessor(first, "VEC2", FLOAT, None)?.into());
        } else if !second.is_empty() {
            let zeros = crate::image::try_vec(mesh.positions.len(), Vec2::ZERO)?;
            attributes.insert("TEXCOORD_0".into(), self.accessor(&zeros, "VEC2", FLOAT, None)?.into());
        }
        if !second.is_empty() {
            attributes.insert("TEXCOORD_1".into(), self.accessor(second, "VEC2", FLOAT, None)?.into());
        }
        if !mesh.colours.is_empty() {
            attributes.insert("COLOR_0".into(), self.accessor(&mesh.colours, "VEC4", FLOAT, None)?.into());
        }
        let indices = self.accessor(&mesh.triangles, "SCALAR", UNSIGNED_INT, None)?;
        let primitive = json!({ "attributes": attributes, "indices": indices, "material": mesh.material });
        self.meshes.push(json!({ "name": mesh.name, "primitives": [primitive] }));
        self.nodes.push(json!({ "name": mesh.name, "mesh": self.meshes.len() - 1 }));
        Ok(())
    }

    fn camera(&mut self, camera: &Camera) {
        let perspective = json!({ "yfov": camera.fov_y, "znear": NEAR });
        self.cameras.push(json!({ "name": camera.name, "type": "perspective", "perspective": perspective }));
        let right = camera.forward.cross(camera.up);
        let rotation = rotation([right, camera.up, -camera.forward]);
        self.nodes.push(json!({
            "name": camera.name,
            "camera": self.cameras.len() - 1,
            "translation": camera.position.to_array(),
            "rotation": rotation,
        }));
    }

    fn light(&mut self, scene: &Scene, index: usize, light: &PunctualLight) -> Result<()> {
        let (kind, strength, position, direction) = match *light {
            PunctualLight::Point { position, intensity } => ("point", intensity, position, Vec3::NEG_Z),
            PunctualLight::Spot { position, direction, intensity, .. } => ("spot", intensity, position, direction),
            PunctualLight::Directional { direction, illuminance, .. } => {
                ("directional", illuminance, Vec3::ZERO, direction)
            }
            PunctualLight::Luminaire { position, axis, c0, colour, distribution, is_point } => {
                return self.luminaire(scene, index, [position, axis, c0, colour], distribution, is_point);
            }
        };
        self.uses("KHR_lights_punctual");
        let (colour, intensity) = split_peak(strength);
        let mut json = json!({ "type": kind, "color": colour.to_array(), "intensity": intensity });
        if let PunctualLight::Spot { inner_angle, outer_angle, .. } = *light {
            json["spot"] = json!({ "innerConeAngle": inner_angle, "outerConeAngle": outer_angle });
        }
        self.lights.push(json);
        self.nodes.push(json!({
            "name": format!("Light {index}"),
            "translation": position.to_array(),
            "rotation": single(DQuat::from_rotation_arc(DVec3::NEG_Z, direction.as_dvec3().normalize())),
            "extensions": { "KHR_lights_punctual": { "light": self.lights.len() - 1 } },
        }));
        Ok(())
    }

    /// Writes a luminaire as a node with `EXT_lights_ies`. In the coordinates of the node, the luminaire's axis is -z,
    /// and its direction C = 0 is +x.
    fn luminaire(
        &mut self,
        scene: &Scene,
        index: usize,
        [position, axis, c0, colour]: [Vec3; 4],
        distribution: usize,
        is_point: bool,
    ) -> Result<()> {
        self.uses(IES);
        let profile = match self.profile_keys.iter().position(|k| *k == distribution) {
            Some(known) => known,
            None => {
                let luminaire = &scene.distributions[distribution];
                let view = self.view(ies::write(luminaire)?.as_bytes(), None)?;
                let mime = "application/x-ies-lm-63";
                self.profiles.push(json!({ "name": luminaire.name, "bufferView": view, "mimeType": mime }));
                self.profile_keys.push(distribution);
                self.profiles.len() - 1
            }
        };
        let (colour, multiplier) = split_peak(colour);
        let rotation = rotation([c0, c90(axis, c0), -axis]);
        let mut reference = json!({ "light": profile, "multiplier": multiplier, "color": colour.to_array() });
        if is_point {
            reference["extras"] = json!({ IS_POINT: true });
        }
        self.nodes.push(json!({
            "name": format!("Light {index}"),
            "translation": position.to_array(),
            "rotation": rotation,
            "extensions": { IES: reference },
        }));
        Ok(())
    }

    fn material(&mut self, scene: &Scene, material: &Material) -> Result<Value> {
        let mut pbr = json!({
            "baseColorFactor": material.base_color.extend(material.alpha).to_array(),
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        });
        if let Some(reference) = material.base_color_texture {
            pbr["baseColorTexture"] = self.texture(scene, reference, Encoding::Srgb, 1.0)?;
        }
        if let Some(reference) = material.metallic_roughness_texture {
            pbr["metallicRoughnessTexture"] = self.texture(scene, reference, Encoding::Linear, 1.0)?;
        }
        let mut out = json!({
            "name": material.name, "pbrMetallicRoughness": pbr, "doubleSided": material.double_sided
        });
        match material.alpha_mode {
            AlphaMode::Opaque => {}
            AlphaMode::Mask(cutoff) => {
                out["alphaMode"] = "MASK".into();
                out["alphaCutoff"] = cutoff.into();
            }
            AlphaMode::Blend => out["alphaMode"] = "BLEND".into(),
        }
        if let Some(reference) = material.normal_texture {
            out["normalTexture"] = self.texture(scene, reference, Encoding::Linear, 1.0)?;
            out["normalTexture"]["scale"] = material.normal_scale.into();
        }

        // glTF limits texture values and `emissiveFactor` to 1. Divide the texture by its peak, and multiply the factor
        // by that peak. If the factor then exceeds 1, divide it by its own peak, which becomes the emissive strength.
        let mut extensions = Map::new();
        let mut emission = material.emission;
        if let Some(reference) = material.emission_texture {
            let peak = scene.textures[reference.texture].image.data.iter().copied().fold(1.0, f32::max);
            out["emissiveTexture"] = self.texture(scene, reference, Encoding::Srgb, peak)?;
            emission *= peak;
        }
        let (factor, strength) = if emission.max_element() > 1.0 { split_peak(emission) } else { (emission, 1.0) };
        out["emissiveFactor"] = json!(factor.to_array());
        if strength != 1.0 {
            self.uses("KHR_materials_emissive_strength");
            let value = json!({ "emissiveStrength": strength });
            extensions.insert("KHR_materials_emissive_strength".into(), value);
        }
        self.add_extensions(scene, material, &mut extensions)?;
        if !extensions.is_empty() {
            out["extensions"] = extensions.into();
        }
        Ok(out)
    }

    /// Adds the extensions of a material to its JSON, without the one of its emission.
    fn add_extensions(
        &mut self,
        scene: &Scene,
        material: &Material,
        extensions: &mut Map<String, Value>,
    ) -> Result<()> {
        let mut extend = |name: &'static str, value: Value| {
            self.uses(name);
            extensions.insert(name.into(), value);
        };
        if material.transmission > 0.0 {
            extend("KHR_materials_transmission", json!({ "transmissionFactor": material.transmission }));
        }
        let (colour, distance) = (material.attenuation_color, material.attenuation_distance);
        if material.thickness > 0.0 || colour != Vec3::ONE || distance < f32::INFINITY {
            let mut volume = json!({ "thicknessFactor": material.thickness, "attenuationColor": colour.to_array() });
            // JSON has no infinity, which is the default.
            if distance < f32::INFINITY {
                volume["attenuationDistance"] = distance.into();
            }
            extend("KHR_materials_volume", volume);
        }
        if material.ior != 1.5 {
            extend("KHR_materials_ior", json!({ "ior": material.ior }));
        }
        if material.specular != Specular::default() {
            let value = self.specular(scene, &material.specular)?;
            self.uses(SPECULAR);
            extensions.insert(SPECULAR.into(), value);
        }
        if material.coat != ClearCoat::default() {
            let value = self.coat(scene, material)?;
            self.uses(CLEAR_COAT);
            extensions.insert(CLEAR_COAT.into(), value);
        }
        Ok(())
    }

    fn specular(&mut self, scene: &Scene, specular: &Specular) -> Result<Value> {
        let mut out = json!({ "specularFactor": specular.strength, "specularColorFactor": specular.color.to_array() });
        let textures = [("specularTexture", specular.texture), ("specularColorTexture", specular.color_texture)];
        self.textures_of(scene, &mut out, Encoding::Srgb, &textures)?;
        Ok(out)
    }

    /// Writes a clear coat. It has the normals of the material, as it is rendered.
    fn coat(&mut self, scene: &Scene, material: &Material) -> Result<Value> {
        let coat = &material.coat;
        let mut out = json!({ "clearcoatFactor": coat.strength, "clearcoatRoughnessFactor": coat.roughness });
        let textures = [
            ("clearcoatTexture", coat.texture),
            ("clearcoatRoughnessTexture", coat.roughness_texture),
            ("clearcoatNormalTexture", material.normal_texture),
        ];
        self.textures_of(scene, &mut out, Encoding::Linear, &textures)?;
        if material.normal_texture.is_some() {
            out["clearcoatNormalTexture"]["scale"] = material.normal_scale.into();
        }
        Ok(out)
    }

    /// Adds references to textures to the JSON of a material extension.
    fn textures_of(
        &mut self,
        scene: &Scene,
        out: &mut Value,
        encoding: Encoding,
        textures: &[(&str, Option<TextureRef>)],
    ) -> Result<()> {
        for (key, reference) in textures {
            if let Some(reference) = *reference {
                out[*key] = self.texture(scene, reference, encoding, 1.0)?;
            }
        }
        Ok(())
    }

    /// Writes a reference to a texture whose values are divided by `peak`.
    fn texture(&mut self, scene: &Scene, reference: TextureRef, encoding: Encoding, peak: f32) -> Result<Value> {
        let key = (reference.texture, encoding, peak);
        let index = match self.image_keys.iter().position(|k| *k == key) {
            Some(known) => known,
            None => self.image(scene, key)?,
        };
        let mut info = json!({ "index": index, "texCoord": reference.uv_set });
        if reference.transform != Mat3::IDENTITY {
            self.uses("KHR_texture_transform");
            let (offset, rotation, scale) = decompose(reference.transform)?;
            info["extensions"] = json!({ "KHR_texture_transform": {
                "offset": offset.to_array(), "rotation": rotation, "scale": scale.to_array()
            } });
        }
        Ok(info)
    }

    /// Writes an image with its own texture and sampler. Image, texture and sampler have the same index in their lists.
    fn image(&mut self, scene: &Scene, key: ImageKey) -> Result<usize> {
        let (index, encoding, peak) = key;
        let texture = &scene.textures[index];
        let png = match encoding {
            Encoding::Srgb => io::encode_png(&texture.image, 1.0 / peak)?,
            Encoding::Linear => {
                // The PNG encoder applies the sRGB curve. Apply its inverse first, so that the bytes stay linear.
                let mut image = texture.image.clone();
                let alpha = if image.channels == 4 { 3 } else { usize::MAX };
                let channels = image.channels;
                let colour = image.data.iter_mut().enumerate().filter(|(i, _)| i % channels != alpha);
                colour.for_each(|(_, v)| *v = srgb_to_linear(*v));
                io::encode_png(&image, 1.0)?
            }
        };
        let view = self.view(&png, None)?;
        self.images.push(json!({ "name": texture.name, "bufferView": view, "mimeType": "image/png" }));
        self.image_keys.push(key);
        let [wrap_s, wrap_t] = texture.wrap.map(|wrap| match wrap {
            Wrap::Repeat => 10497,
            Wrap::Clamp => 33071,
            Wrap::Mirror => 33648,
        });
        let number = self.textures.len();
        self.textures.push(json!({ "source": number, "sampler": { "wrapS": wrap_s, "wrapT": wrap_t } }));
        Ok(number)
    }

    fn into_glb(mut self, origin: DVec3) -> Result<Vec<u8>> {
        let samplers: Vec<Value> = self.textures.iter_mut().map(|texture| texture["sampler"].take()).collect();
        for (i, texture) in self.textures.iter_mut().enumerate() {
            texture["sampler"] = i.into();
        }
        let mut root = Map::new();
        root.insert("asset".into(), json!({ "version": "2.0", "generator": "luxfer" }));
        // glTF requires a scene to have nodes, but it allows a file without scenes.
        if !self.nodes.is_empty() {
            let mut nodes: Vec<usize> = (0..self.nodes.len()).collect();
            if origin != DVec3::ZERO {
                // Put all nodes under one node with the origin as its translation. JSON holds that translation in f64,
                // and vertices stay near zero.
                let all = std::mem::take(&mut nodes);
                nodes.push(all.len());
                self.nodes.push(json!({ "name": "Origin", "translation": origin.to_array(), "children": all }));
            }
            root.insert("scene".into(), 0.into());
            root.insert("scenes".into(), json!([{ "nodes": nodes }]));
        }
        let lists = [
            ("nodes", self.nodes),
            ("meshes", self.meshes),
            ("materials", self.materials),
            ("cameras", self.cameras),
            ("textures", self.textures),
            ("samplers", samplers),
            ("images", self.images),
            ("accessors", self.accessors),
            ("bufferViews", self.views),
        ];
        for (name, list) in lists {
            if !list.is_empty() {
                root.insert(name.into(), list.into());
            }
        }
        let lights = [("KHR_lights_punctual", self.lights), (IES, self.profiles)];
        let lights = lights.into_iter().filter(|(_, list)| !list.is_empty());
        let lights: Map<String, Value> = lights.map(|(name, list)| (name.into(), json!({ "lights": list }))).collect();
        if !lights.is_empty() {
            root.insert("extensions".into(), lights.into());
        }
        if !self.extensions.is_empty() {
            root.insert("extensionsUsed".into(), json!(self.extensions));
        }
        if !self.binary.is_empty() {
            root.insert("buffers".into(), json!([{ "byteLength": self.binary.len() }]));
        }
        pack(&Value::Object(root), &self.binary)
    }
}

/// Packs the JSON chunk and the binary chunk into a GLB container (glTF 2.0, section 4.4).
fn pack(root: &Value, binary: &[u8]) -> Result<Vec<u8>> {
    let mut text = root.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let binary_len = if binary.is_empty() { 0 } else { 8 + binary.len() };
    let length = 20 + text.len() + binary_len;
    let length32 = u32::try_from(length).map_err(|_| {
        Error::new(ErrorKind::Unsupported, format!("the scene needs {length} bytes; a GLB file holds at most 4 GiB"))
    })?;
    let mut out = Vec::new();
    let out_of_memory = |_| Error::new(ErrorKind::OutOfMemory, format!("could not allocate {length} bytes"));
    out.try_reserve_exact(length).map_err(out_of_memory)?;
    out.extend_from_slice(b"glTF");
    for word in [2, length32, text.len() as u32] {
        out.extend_from_slice(&word.to_le_bytes());
    }
    out.extend_from_slice(b"JSON");
    out.extend_from_slice(&text);
    if !binary.is_empty() {
        out.extend_from_slice(&(binary.len() as u32).to_le_bytes());
        out.extend_from_slice(b"BIN\0");
        out.extend_from_slice(binary);
    }
    Ok(out)
}

/// Splits a colour into a colour whose largest channel is 1, and the factor by which to multiply that colour. Both are
/// 0 if no channel is positive.
fn split_peak(colour: Vec3) -> (Vec3, f32) {
    let peak = colour.max_element();
    if peak > 0.0 { (colour / peak, peak) } else { (Vec3::ZERO, 0.0) }
}

/// The quaternion of the rotation with the given images of the axes.
fn rotation(axes: [Vec3; 3]) -> [f32; 4] {
    let [x, y, z] = axes.map(Vec3::as_dvec3);
    single(DQuat::from_mat3(&DMat3::from_cols(x, y, z)).normalize())
}

/// Rounds a quaternion. It is computed in `f64`, because glam sums the squares of a `Quat` in another order on ARM.
fn single(rotation: DQuat) -> [f32; 4] {
    rotation.to_array().map(|v| v as f32)
}

/// Decomposes a texture transform into offset, rotation in radians and scale. An error if it has shear.
fn decompose(transform: Mat3) -> Result<(Vec2, f32, Vec2)> {
    let (first, second) = (transform.x_axis.truncate(), transform.y_axis.truncate());
    let rotation = maths::atan2(-first.y, first.x);
    let (s, c) = maths::sin_cos(rotation);
    let scale = Vec2::new(first.length(), second.dot(Vec2::new(s, c)));
    let offset = transform.z_axis.truncate();
    let largest = scale.abs().max_element().max(offset.abs().max_element());
    if transform_matrix(offset, rotation, scale).abs_diff_eq(transform, 1e-4 * largest) {
        return Ok((offset, rotation, scale));
    }
    Err(Error::new(
        ErrorKind::Unsupported,
        format!("the texture transform {transform} has shear, which glTF cannot hold"),
    ))
}
