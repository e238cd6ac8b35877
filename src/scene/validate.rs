//! Checks a scene's indices, lengths and value ranges before anything is built from it.

use super::light::check_light;
use super::{AlphaMode, Camera, Environment, Material, Mesh, PunctualLight, Scene, Texture, TextureRef};
use crate::error::{Error, ErrorKind, Result, check_range};
use crate::image::Image;
use glam::{Mat3, Vec3, Vec4};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::fmt::Display;

/// Largest absolute coordinate of a position, in metres. A product of two coordinates is then at most 1e30. The sum of
/// a million such products still stays below the largest `f32`, 3.4e38. [rounding]
const MAX_COORDINATE: f32 = 1e15;

fn is_place(point: Vec3) -> bool {
    // Comparisons with NaN are false, so NaN is rejected.
    point.abs().cmple(Vec3::splat(MAX_COORDINATE)).all()
}

/// Checks that a position is in range. `what` names the position; it is evaluated only on failure.
pub fn check_place<W: Display>(what: impl FnOnce() -> W, point: Vec3) -> Result<()> {
    if is_place(point) {
        return Ok(());
    }
    let what = what();
    Err(Error::argument(format!(
        "{what} is {point}; coordinates must lie in [-{MAX_COORDINATE:e}, {MAX_COORDINATE:e}]"
    )))
}

/// Largest deviation of a unit vector's length from 1, and of the dot product of two perpendicular unit vectors from
/// 0. [rounding]
const DIRECTION_TOLERANCE: f32 = 1e-3;

impl Scene {
    /// Checks every index, length and range. The error names the first invalid object, its value and the allowed
    /// range.
    pub fn validate(&self) -> Result<()> {
        for (i, texture) in self.textures.iter().enumerate() {
            check_texture(texture).map_err(|e| e.context(format_args!("texture {i} {:?}", texture.name)))?;
        }
        for (i, material) in self.materials.iter().enumerate() {
            self.check_material(material).map_err(|e| e.context(format_args!("material {i} {:?}", material.name)))?;
        }
        for (i, mesh) in self.meshes.iter().enumerate() {
            self.check_mesh(mesh).map_err(|e| e.context(format_args!("mesh {i} {:?}", mesh.name)))?;
        }
        for (i, distribution) in self.distributions.iter().enumerate() {
            distribution.check().map_err(|e| {
                let e = e.context(format_args!("distribution {i} {:?}", distribution.name));
                Error { kind: ErrorKind::InvalidArgument, ..e }
            })?;
        }
        for (i, light) in self.lights.iter().enumerate() {
            self.check_punctual(light).map_err(|e| e.context(format_args!("light {i}")))?;
        }
        for (i, camera) in self.cameras.iter().enumerate() {
            check_camera(camera).map_err(|e| e.context(format_args!("camera {i} {:?}", camera.name)))?;
        }
        self.check_brightness()?;
        match &self.environment {
            Some(Environment::Constant(colour)) => check_light("environment", *colour),
            Some(Environment::Image(image)) => {
                check_image(image).and_then(|()| check_positive(image)).map_err(|e| e.context("environment"))
            }
            None => Ok(()),
        }
    }

    fn check_material(&self, material: &Material) -> Result<()> {
        check_colour("base_color", material.base_color)?;
        check_range("alpha", material.alpha, 0.0, 1.0)?;
        if let AlphaMode::Mask(cutoff) = material.alpha_mode {
            check_range("alpha cutoff", cutoff, 0.0, f32::MAX)?;
        }
        check_range("metallic", material.metallic, 0.0, 1.0)?;
        check_range("roughness", material.roughness, 0.0, 1.0)?;
        check_range("transmission", material.transmission, 0.0, 1.0)?;
        check_range("ior", material.ior, 1.0, f32::MAX)?;
        check_range("specular.strength", material.specular.strength, 0.0, 1.0)?;
        check_range("coat.strength", material.coat.strength, 0.0, 1.0)?;
        check_range("coat.roughness", material.coat.roughness, 0.0, 1.0)?;
        check_light("specular.color", material.specular.color)?;
        check_range("thickness", material.thickness, 0.0, f32::MAX)?;
        check_colour("attenuation_color", material.attenuation_color)?;
        check_range("attenuation_distance", material.attenuation_distance, f32::MIN_POSITIVE, f32::INFINITY)?;
        check_range("normal_scale", material.normal_scale, f32::MIN, f32::MAX)?;
        check_light("emission", material.emission)?;
        self.check_reference("base_color_texture", material.base_color_texture)?;
        self.check_reference("metallic_roughness_texture", material.metallic_roughness_texture)?;
        self.check_reference("normal_texture", material.normal_texture)?;
        self.check_reference("emission_texture", material.emission_texture)?;
        self.check_reference("coat.texture", material.coat.texture)?;
        self.check_reference("coat.roughness_texture", material.coat.roughness_texture)?;
        self.check_reference("specular.texture", material.specular.texture)?;
        self.check_reference("specular.color_texture", material.specular.color_texture)?;
        match material.emission_texture {
            Some(reference) => check_positive(&self.textures[reference.texture].image)
                .map_err(|e| e.context(format_args!("emission_texture {}", reference.texture))),
            None => Ok(()),
        }
    }

    fn check_reference(&self, what: &str, reference: Option<TextureRef>) -> Result<()> {
        let Some(TextureRef { texture, uv_set, transform }) = reference else { return Ok(()) };
        check_index(&format!("{what}.texture"), texture, self.textures.len(), "textures")?;
        check_range(&format!("{what}.uv_set"), uv_set, 0, 1)?;
        if transform.is_finite() && Mat3::row(&transform, 2) == Vec3::Z {
            return Ok(());
        }
        Err(Error::argument(format!("{what}.transform is {transform}; it must be finite with the last row 0 0 1")))
    }

    fn check_punctual(&self, light: &PunctualLight) -> Result<()> {
        match *light {
            PunctualLight::Point { position, intensity } => {
                check_place(|| "position", position)?;
                check_light("intensity", intensity)
            }
            PunctualLight::Spot { position, direction, intensity, inner_angle, outer_angle } => {
                check_place(|| "position", position)?;
                check_unit("direction", direction)?;
                check_light("intensity", intensity)?;
                check_range("outer_angle", outer_angle, 0.0, FRAC_PI_2)?;
                check_range("inner_angle", inner_angle, 0.0, outer_angle).map(|_| ())
            }
            PunctualLight::Directional { direction, illuminance, half_angle } => {
                check_unit("direction", direction)?;
                check_light("illuminance", illuminance)?;
                check_range("half_angle", half_angle, 0.0, FRAC_PI_4).map(|_| ())
            }
            PunctualLight::Luminaire { position, axis, c0, colour, distribution, is_point: _ } => {
                check_place(|| "position", position)?;
                check_unit("axis", axis)?;
                check_unit("c0", c0)?;
                check_right_angle("axis · c0", axis.dot(c0))?;
                check_index("its distribution", distribution, self.distributions.len(), "distributions")?;
                check_light("colour", colour)
            }
        }
    }

    fn check_mesh(&self, mesh: &Mesh) -> Result<()> {
        check_index("its material", mesh.material, self.materials.len(), "materials")?;
        let count = mesh.positions.len();
        let bad = |what: &str, i: usize, value: &dyn std::fmt::Display| {
            Err(Error::argument(format!("the {what} of vertex {i} is {value}; it must be finite")))
        };
        for (i, &position) in mesh.positions.iter().enumerate() {
            check_place(|| format!("the position of vertex {i}"), position)?;
        }
        if let Some(i) = mesh.normals.iter().position(|n| !n.is_finite()) {
            return bad("normal", i, &mesh.normals[i]);
        }
        for uvs in &mesh.uvs {
            if let Some(i) = uvs.iter().position(|uv| !uv.is_finite()) {
                return bad("texture coordinate", i, &uvs[i]);
            }
        }
        let is_share = |colour: &Vec4| colour.cmpge(Vec4::ZERO).all() && colour.cmple(Vec4::ONE).all();
        if let Some(i) = mesh.colours.iter().position(|colour| !is_share(colour)) {
            let colour = mesh.colours[i];
            return Err(Error::argument(format!("the colour of vertex {i} is {colour}; it must lie in [0, 1]")));
        }
        let lengths = [
            ("normals", mesh.normals.len()),
            ("uvs[0]", mesh.uvs[0].len()),
            ("uvs[1]", mesh.uvs[1].len()),
            ("colours", mesh.colours.len()),
        ];
        for (what, len) in lengths {
            if len != 0 && len != count {
                return Err(Error::argument(format!(
                    "it has {len} {what}; there must be {count}, one per position, or none"
                )));
            }
        }
        match mesh.triangles.iter().enumerate().find(|(_, t)| t.iter().any(|&i| i as usize >= count)) {
            Some((i, t)) => Err(Error::argument(format!(
                "triangle {i} is {t:?}; its indices must be below {count}, the vertex count"
            ))),
            None => Ok(()),
        }
    }
}

fn check_right_angle(what: &str, cosine: f32) -> Result<()> {
    if cosine.abs() <= DIRECTION_TOLERANCE {
        return Ok(());
    }
    Err(Error::argument(format!("{what} is {cosine}; they must be at right angles")))
}

fn check_index(what: &str, index: usize, count: usize, list: &str) -> Result<()> {
    if index < count {
        return Ok(());
    }
    Err(Error::argument(format!("{what} is {index}; the scene has {count} {list}")))
}

fn check_image(image: &Image) -> Result<()> {
    let Image { width, height, channels, .. } = *image;
    if !matches!(channels, 1 | 3 | 4) {
        return Err(Error::argument(format!("the image has {channels} channels; it must have 1, 3 or 4")));
    }
    let needed = width.checked_mul(height).and_then(|n| n.checked_mul(channels));
    if width == 0 || height == 0 || needed != Some(image.data.len()) {
        let len = image.data.len();
        return Err(Error::argument(format!("the image is {width} x {height} x {channels} with {len} samples")));
    }
    match image.count_non_finite() {
        0 => Ok(()),
        n => Err(Error::argument(format!("{n} samples of the image are NaN or infinite"))),
    }
}

/// Refuses negative samples in an image of emitted light.
fn check_positive(image: &Image) -> Result<()> {
    match image.data.iter().position(|&v| v < 0.0) {
        Some(i) => {
            Err(Error::argument(format!("sample {i} of the image is {}; light must not be negative", image.data[i])))
        }
        None => Ok(()),
    }
}

fn check_texture(texture: &Texture) -> Result<()> {
    check_image(&texture.image)
}

fn check_colour(what: &str, colour: Vec3) -> Result<()> {
    colour.to_array().into_iter().try_for_each(|v| check_range(what, v, 0.0, 1.0).map(|_| ()))
}

fn check_unit(what: &str, direction: Vec3) -> Result<()> {
    if (direction.length() - 1.0).abs() <= DIRECTION_TOLERANCE {
        return Ok(());
    }
    Err(Error::argument(format!("{what} is {direction}; it must be a unit vector")))
}

fn check_camera(camera: &Camera) -> Result<()> {
    check_place(|| "position", camera.position)?;
    check_unit("forward", camera.forward)?;
    check_unit("up", camera.up)?;
    let cosine = camera.forward.dot(camera.up);
    check_right_angle("forward · up", cosine)?;
    if camera.fov_y > 0.0 && camera.fov_y < PI {
        return Ok(());
    }
    Err(Error::argument(format!("fov_y is {}; it must lie in (0, π) radians", camera.fov_y)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;
    use crate::photometry::Luminaire;
    use glam::Vec2;
    use std::sync::Arc;

    fn scene() -> Scene {
        let image = Image::from_fn(2, 2, |_, _| [0.5, 0.5, 0.5]).unwrap();
        let mesh = Mesh {
            name: "Desk".into(),
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let material = Material { emission_texture: Some(TextureRef::new(0)), ..Material::diffuse("Oak", Vec3::ONE) };
        Scene {
            origin: glam::DVec3::ZERO,
            meshes: vec![mesh],
            materials: vec![material],
            textures: vec![Texture::new("Grain", image)],
            lights: vec![PunctualLight::Directional {
                direction: Vec3::NEG_Y,
                illuminance: Vec3::ONE,
                half_angle: 0.0,
            }],
            distributions: vec![Arc::new(Luminaire::lambertian("Panel", 1.0, [0.0; 3]))],
            environment: Some(Environment::Constant(Vec3::ONE)),
            sun: None,
            cameras: vec![Camera::look_at(Vec3::ONE, Vec3::ZERO, 1.0)],
            unrendered: Vec::new(),
        }
    }

    fn hang_in(light: PunctualLight) -> Scene {
        Scene { lights: vec![light], ..scene() }
    }

    #[test]
    fn each_defect_is_refused_and_its_object_named() {
        assert_eq!(scene().validate(), Ok(()));
        assert_eq!(Scene::default().validate(), Ok(()));
        type Defect = (&'static str, fn(&mut Scene));
        let hang = |axis, c0, distribution| {
            let (position, colour) = (Vec3::ZERO, Vec3::ONE);
            PunctualLight::Luminaire { position, axis, c0, colour, distribution, is_point: false }
        };
        assert_eq!(hang_in(hang(Vec3::NEG_Y, Vec3::X, 0)).validate(), Ok(()));
        for light in [hang(Vec3::NEG_Y, Vec3::X, 1), hang(Vec3::ONE, Vec3::X, 0), hang(Vec3::X, Vec3::X, 0)] {
            assert!(hang_in(light).validate().unwrap_err().message.contains("light 0"));
        }
        let defects: [Defect; 35] = [
            ("vertex 2", |s| s.meshes[0].positions[2].x = -1.1e15),
            ("Desk", |s| s.meshes[0].positions[1].y = f32::NAN),
            ("vertex 1", |s| s.meshes[0].positions[1].y = f32::INFINITY),
            ("Desk", |s| s.meshes[0].triangles[0][2] = 3),
            ("Desk", |s| s.meshes[0].material = 1),
            ("Desk", |s| s.meshes[0].normals = vec![Vec3::Z; 2]),
            ("Desk", |s| s.meshes[0].normals = vec![Vec3::NAN; 3]),
            ("Desk", |s| s.meshes[0].uvs[1] = vec![Vec2::ZERO; 4]),
            ("Desk", |s| s.meshes[0].uvs[0] = vec![Vec2::NAN; 3]),
            ("Desk", |s| s.meshes[0].colours = vec![Vec4::ONE; 2]),
            ("vertex 1", |s| s.meshes[0].colours = vec![Vec4::ONE, Vec4::new(0.0, 1.0, f32::NAN, 1.0), Vec4::ZERO]),
            ("Oak", |s| s.materials[0].base_color.x = 1.5),
            ("Oak", |s| s.materials[0].roughness = -0.1),
            ("Oak", |s| s.materials[0].ior = 0.5),
            ("Oak", |s| s.materials[0].thickness = -1.0),
            ("Oak", |s| s.materials[0].specular.strength = 1.5),
            ("Oak", |s| s.materials[0].coat.strength = f32::NAN),
            ("Oak", |s| s.materials[0].coat.roughness = -0.5),
            ("Oak", |s| s.materials[0].coat.texture = Some(TextureRef::new(1))),
            ("Oak", |s| s.materials[0].specular.color.y = -1.0),
            ("Oak", |s| s.materials[0].specular.color_texture = Some(TextureRef::new(1))),
            ("Oak", |s| s.materials[0].attenuation_color.y = f32::NAN),
            ("Oak", |s| s.materials[0].attenuation_distance = 0.0),
            ("Oak", |s| s.materials[0].emission.z = f32::INFINITY),
            ("Oak", |s| s.materials[0].normal_texture = Some(TextureRef::new(1))),
            ("Oak", |s| s.materials[0].normal_texture = Some(TextureRef { uv_set: 2, ..TextureRef::new(0) })),
            ("Oak", |s| s.textures[0].image.data[3] = -1.0),
            ("Grain", |s| s.textures[0].image.data[3] = f32::NAN),
            ("Grain", |s| s.textures[0].image.width = 3),
            ("Grain", |s| s.textures[0].image = Image::new(1, 1, 2).unwrap()),
            ("light 0", |s| s.lights[0] = PunctualLight::Point { position: Vec3::NAN, intensity: Vec3::ONE }),
            ("Panel", |s| Arc::make_mut(&mut s.distributions[0]).candela[0] = f64::NAN),
            ("environment", |s| s.environment = Some(Environment::Constant(Vec3::NEG_ONE))),
            ("camera 0", |s| s.cameras[0].fov_y = PI),
            ("camera 0", |s| s.cameras[0].up = s.cameras[0].forward),
        ];
        for (i, (name, spoil)) in defects.iter().enumerate() {
            let mut spoilt = scene();
            spoil(&mut spoilt);
            let error = spoilt.validate().unwrap_err();
            assert_eq!(error.kind, ErrorKind::InvalidArgument);
            assert!(error.message.contains(name), "defect {i}: {error}");
        }
    }
}
