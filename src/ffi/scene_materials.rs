//! Materials
//!
//! Materials of surfaces, as in glTF 2.0: metallic-roughness with panes, solid glass, alpha cut-outs and emission, and
//! textures that multiply these values. Materials can be read back and replaced; a material keeps its textures when
//! its values change.

use super::guard::enter;
use super::handle::{self, Owned};
use super::image::{Pixels, luxfer_image};
use super::params::{self, Report, Versioned, versioned};
use super::pointer::{Out, bytes, floats, set_optional};
use super::query::LUXFER_NONE;
use super::scene::{colour, luxfer_scene, missing};
use super::scene_parts::{optional_text, push};
use super::status::luxfer_status;
use crate::error::{Error, Result, check_range};
use crate::image::Image;
use crate::scene::{AlphaMode, Material, Scene, Texture, TextureRef, Wrap};
use glam::{Mat3, Vec3};
use std::ffi::c_char;
use std::sync::Arc;

/// How a surface uses its alpha: a LUXFER_ALPHA_ value.
pub type luxfer_alpha_mode = i32;
/// The alpha is ignored: the surface is opaque.
pub const LUXFER_ALPHA_OPAQUE: luxfer_alpha_mode = 0;
/// The surface is opaque where its alpha is at least alpha_cutoff, and absent elsewhere.
pub const LUXFER_ALPHA_MASK: luxfer_alpha_mode = 1;
/// The surface stops a share of the light that is equal to its alpha; the rest of the light passes straight through.
pub const LUXFER_ALPHA_BLEND: luxfer_alpha_mode = 2;

/// A metallic-roughness material, as in glTF 2.0. Fill it with luxfer_material_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_material_params {
    /// sizeof(luxfer_material_params), set by luxfer_material_params_init.
    pub struct_size: u32,
    /// 1, the default: back faces emit as front faces do; 0: only front faces emit. In both cases, back faces reflect
    /// and block light as front faces do.
    pub double_sided: u32,
    /// Name in UTF-8, copied; NULL, the default: no name.
    pub name: *const c_char,
    /// Linear RGB base colour, each channel in [0, 1]; default 0.8.
    pub base_color: [f32; 3],
    /// Share of the surface that is metal, in [0, 1]; default 0.
    pub metallic: f32,
    /// Perceptual roughness in [0, 1], as in glTF; default 1.
    pub roughness: f32,
    /// Emission per channel in cd/m², each in [0, 1e15]; default 0.
    pub emission: [f32; 3],
    /// Share of the light entering the non-metallic part of the surface that passes through, instead of being reflected
    /// diffusely, in [0, 1]; default 0. base_color tints this light. If thickness is 0, it passes straight through, as
    /// through a thin clear pane, and roughness does not blur it.
    pub transmission: f32,
    /// Index of refraction in [1, 4]; default 1.5. With 1, only metal reflects specularly.
    pub ior: f32,
    /// Opacity in [0, 1]; multiplies the alpha of the base colour texture; default 1.
    pub alpha: f32,
    /// Use of alpha: a LUXFER_ALPHA_ value; default LUXFER_ALPHA_OPAQUE.
    pub alpha_mode: luxfer_alpha_mode,
    /// Threshold of alpha for LUXFER_ALPHA_MASK, >= 0; default 0.5.
    pub alpha_cutoff: f32,
    /// Strength of the normal texture: a factor for the x and y of its normals, finite; default 1.
    pub normal_scale: f32,
    /// If above 0, and transmission too, the meshes of this material are the surfaces of solid bodies, which refract
    /// and absorb light: closed meshes whose front sides, from which the triangles wind counter-clockwise, face
    /// outwards. base_color tints the light whenever it passes the surface, and roughness blurs it. If 0, the default,
    /// the meshes are thin panes. The value itself does not matter: the mesh states how thick the body is. In metres,
    /// finite.
    pub thickness: f32,
    /// Share of the light that is left after attenuation_distance inside a solid body, each channel in [0, 1];
    /// default 1.
    pub attenuation_color: [f32; 3],
    /// Distance in metres, > 0; infinite, the default: the body absorbs nothing.
    pub attenuation_distance: f32,
    /// Must be 0.
    pub reserved: u32,
}

const MATERIAL_SIZE: usize = 88 + size_of::<usize>();

versioned!(luxfer_material_params, [MATERIAL_SIZE], {
    Self {
        struct_size: MATERIAL_SIZE as u32,
        double_sided: 1,
        name: std::ptr::null(),
        base_color: [0.8; 3],
        metallic: 0.0,
        roughness: 1.0,
        emission: [0.0; 3],
        transmission: 0.0,
        ior: 1.5,
        alpha: 1.0,
        alpha_mode: LUXFER_ALPHA_OPAQUE,
        alpha_cutoff: 0.5,
        normal_scale: 1.0,
        thickness: 0.0,
        attenuation_color: [1.0; 3],
        attenuation_distance: f32::INFINITY,
        reserved: 0,
    }
});

/// Purpose of a texture in a material: a LUXFER_TEXTURE_ value.
pub type luxfer_texture_role = i32;
/// Base colour: the texture multiplies the material's base colour, and its alpha multiplies the material's alpha.
pub const LUXFER_TEXTURE_BASE_COLOR: luxfer_texture_role = 0;
/// Metallic-roughness: the green channel multiplies the roughness, the blue channel multiplies the metallic value.
pub const LUXFER_TEXTURE_METALLIC_ROUGHNESS: luxfer_texture_role = 1;
/// Normals in tangent space, as in glTF 2.0: a channel value c in [0, 1] stands for 2 c - 1, and green points up in the
/// image (OpenGL convention). Load the map as data (LUXFER_COLOUR_LINEAR), not as sRGB.
pub const LUXFER_TEXTURE_NORMAL: luxfer_texture_role = 2;
/// Emission: the texture multiplies the emission; it is looked up without interpolation.
pub const LUXFER_TEXTURE_EMISSION: luxfer_texture_role = 3;

/// How a texture continues beyond its edges: a LUXFER_WRAP_ value.
pub type luxfer_wrap = i32;
/// The texture repeats.
pub const LUXFER_WRAP_REPEAT: luxfer_wrap = 0;
/// Beyond the edge, the texel at the edge is repeated.
pub const LUXFER_WRAP_CLAMP: luxfer_wrap = 1;
/// The texture repeats, mirrored every second time.
pub const LUXFER_WRAP_MIRROR: luxfer_wrap = 2;

/// The texture that a material uses for one purpose.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_texture_use {
    /// sizeof(luxfer_texture_use), set by the function that fills the struct.
    pub struct_size: u32,
    /// Index of the texture; LUXFER_NONE if the material has no texture for this purpose: the fields below are then 0.
    pub texture: u32,
    /// Set of the mesh's texture coordinates that the material uses for this texture: 0 or 1.
    pub uv_set: u32,
    /// Continuation of the texture along u: a LUXFER_WRAP_ value.
    pub wrap_u: luxfer_wrap,
    /// Continuation of the texture along v: a LUXFER_WRAP_ value.
    pub wrap_v: luxfer_wrap,
    /// Affine map that is applied to the texture coordinates (u, v, 1) before the look-up: two rows of three numbers.
    pub transform: [f32; 6],
}

versioned!(luxfer_texture_use, [44], {
    Self { struct_size: 44, texture: LUXFER_NONE, uv_set: 0, wrap_u: 0, wrap_v: 0, transform: [0.0; 6] }
});

/// Adds a material to a scene; *index, unless NULL, receives its index. params may be NULL for the defaults. Any
/// thread.
/// LUXFER_INVALID_ARGUMENT if a value is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_add_material(
    scene: *mut luxfer_scene,
    params: *const luxfer_material_params,
    index: *mut u32,
) -> luxfer_status {
    enter(scene, |object| {
        let material = described(&params::read(params)?)?;
        let added = object.change(0, |scene| Ok(push(&mut scene.materials, material)))?;
        set_optional(index, added);
        Ok(())
    })
}

/// Replaces the values of a material by params, or by the defaults if params is NULL. The material keeps its textures,
/// and what params do not state (KHR_materials_specular and _clearcoat), and also its name if params->name is NULL. To
/// change single values, read the material first. Any thread.
/// LUXFER_NOT_FOUND if there is no such material; LUXFER_INVALID_ARGUMENT if a value is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_set_material(
    scene: *mut luxfer_scene,
    index: u32,
    params: *const luxfer_material_params,
) -> luxfer_status {
    enter(scene, |object| {
        let params = params::read(params)?;
        let new = described(&params)?;
        object.change(0, |scene| {
            let old = material_mut(scene, index)?;
            *old = Material {
                name: if params.name.is_null() { std::mem::take(&mut old.name) } else { new.name },
                base_color_texture: old.base_color_texture,
                metallic_roughness_texture: old.metallic_roughness_texture,
                normal_texture: old.normal_texture,
                emission_texture: old.emission_texture,
                specular: old.specular,
                coat: old.coat,
                ..new
            };
            Ok(())
        })
    })
}

/// Reads the values of a material; params->name becomes NULL. size is sizeof *params. Any thread.
/// LUXFER_NOT_FOUND if there is no such material.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_material(
    scene: *mut luxfer_scene,
    index: u32,
    params: *mut luxfer_material_params,
    size: usize,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Report::new(params, size)?;
        let scene = object.snapshot();
        let material = material(&scene, index)?;
        let defaults = luxfer_material_params::defaults();
        let (alpha_mode, alpha_cutoff) = match material.alpha_mode {
            AlphaMode::Opaque => (LUXFER_ALPHA_OPAQUE, defaults.alpha_cutoff),
            AlphaMode::Mask(cutoff) => (LUXFER_ALPHA_MASK, cutoff),
            AlphaMode::Blend => (LUXFER_ALPHA_BLEND, defaults.alpha_cutoff),
        };
        out.set(luxfer_material_params {
            double_sided: u32::from(material.double_sided),
            base_color: material.base_color.to_array(),
            metallic: material.metallic,
            roughness: material.roughness,
            emission: material.emission.to_array(),
            transmission: material.transmission,
            ior: material.ior,
            alpha: material.alpha,
            alpha_mode,
            alpha_cutoff,
            normal_scale: material.normal_scale,
            thickness: material.thickness,
            attenuation_color: material.attenuation_color.to_array(),
            attenuation_distance: material.attenuation_distance,
            ..defaults
        });
        Ok(())
    })
}

/// Adds a texture to a scene: an image in linear values with 1, 3 or 4 channels, of which the fourth is alpha. wrap_u
/// and wrap_v are LUXFER_WRAP_ values. The image is copied. *index, unless NULL, receives the texture's index. Any
/// thread.
/// LUXFER_INVALID_ARGUMENT if the image has another number of channels or a value that is not finite;
/// LUXFER_OUT_OF_MEMORY beyond the memory budget.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_add_texture(
    scene: *mut luxfer_scene,
    image: *mut luxfer_image,
    wrap_u: luxfer_wrap,
    wrap_v: luxfer_wrap,
    index: *mut u32,
) -> luxfer_status {
    enter(scene, |object| {
        let image = handle::borrow_in(object.context(), image, "image")?;
        let image = image.image();
        let wrap = [wrapping(wrap_u, "wrap_u")?, wrapping(wrap_v, "wrap_v")?];
        if !matches!(image.channels, 1 | 3 | 4) {
            return Err(Error::argument(format!("the image has {} channels; it must have 1, 3 or 4", image.channels)));
        }
        let bad = image.count_non_finite();
        if bad > 0 {
            return Err(Error::argument(format!("{bad} samples of the image are NaN or infinite; replace them")));
        }
        let bytes = (image.data.len() * size_of::<f32>()) as u64;
        let added = object.change(bytes, |scene| {
            let mut copy = Image::new(image.width, image.height, image.channels)?;
            copy.data.copy_from_slice(&image.data);
            let texture = Texture { wrap, ..Texture::new("", copy) };
            Ok(push(&mut scene.textures, texture))
        })?;
        set_optional(index, added);
        Ok(())
    })
}

/// Sets the texture that a material uses for a purpose. role is a LUXFER_TEXTURE_ value; texture is the index of a
/// texture, or LUXFER_NONE for no texture. uv_set, 0 or 1, chooses the set of the mesh's texture coordinates.
/// transform, two rows of three finite numbers, is applied to (u, v, 1) before the look-up; NULL is the identity. Any
/// thread.
/// LUXFER_NOT_FOUND if there is no such material or texture; LUXFER_INVALID_ARGUMENT for another role or set, or if an
/// emission texture has negative values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_set_material_texture(
    scene: *mut luxfer_scene,
    material: u32,
    role: luxfer_texture_role,
    texture: u32,
    uv_set: u32,
    transform: *const f32,
) -> luxfer_status {
    enter(scene, |object| {
        let [a, b, c, d, e, f] = six_floats(transform)?.unwrap_or([1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let transform = Mat3::from_cols_array(&[a, d, 0.0, b, e, 0.0, c, f, 1.0]);
        if !transform.is_finite() {
            return Err(Error::argument("transform has values that are not finite"));
        }
        check_range("uv_set", uv_set, 0, 1)?;
        object.change(0, |scene| {
            let used = if texture == LUXFER_NONE {
                None
            } else {
                let count = scene.textures.len();
                let found = scene.textures.get(texture as usize).ok_or_else(|| missing("texture", texture, count))?;
                if role == LUXFER_TEXTURE_EMISSION && found.image.data.iter().any(|v| *v < 0.0) {
                    return Err(Error::argument(format!("texture {texture} has negative values; emission must not")));
                }
                Some(TextureRef { texture: texture as usize, uv_set: uv_set as usize, transform })
            };
            *slot(material_mut(scene, material)?, role)? = used;
            Ok(())
        })
    })
}

/// Gets the texture that a material uses for a purpose; role is a LUXFER_TEXTURE_ value. size is sizeof *texture_use.
/// Any thread.
/// LUXFER_NOT_FOUND if there is no such material; LUXFER_INVALID_ARGUMENT for another role.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_material_texture(
    scene: *mut luxfer_scene,
    material_index: u32,
    role: luxfer_texture_role,
    texture_use: *mut luxfer_texture_use,
    size: usize,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Report::new(texture_use, size)?;
        let scene = object.snapshot();
        let used = *slot(&mut material(&scene, material_index)?.clone(), role)?;
        out.set(used.map_or_else(luxfer_texture_use::defaults, |used| to_texture_use(&scene, &used)));
        Ok(())
    })
}

/// Gets a texture as an image in linear values. The caller releases *image. Any thread.
/// LUXFER_NOT_FOUND if there is no such texture.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_texture(
    scene: *mut luxfer_scene,
    index: u32,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    struct TextureOf(Arc<Scene>, usize);
    enter(scene, |object| {
        let out = Out::new(image, "image")?;
        let scene = object.snapshot();
        if index as usize >= scene.textures.len() {
            return Err(missing("texture", index, scene.textures.len()));
        }
        let texture = Arc::new(TextureOf(scene, index as usize));
        out.set(handle::give(Pixels::part(object.context(), texture, |t| &t.0.textures[t.1].image)));
        Ok(())
    })
}

/// Converts the caller's numbers to a material, after checks of their ranges.
fn described(params: &luxfer_material_params) -> Result<Material> {
    for channel in params.base_color {
        check_range("material.base_color", channel, 0.0, 1.0)?;
    }
    for channel in params.attenuation_color {
        check_range("material.attenuation_color", channel, 0.0, 1.0)?;
    }
    check_range("material.reserved", params.reserved, 0, 0)?;
    let cutoff = check_range("material.alpha_cutoff", params.alpha_cutoff, 0.0, f32::MAX)?;
    let alpha_mode = match params.alpha_mode {
        LUXFER_ALPHA_OPAQUE => AlphaMode::Opaque,
        LUXFER_ALPHA_MASK => AlphaMode::Mask(cutoff),
        LUXFER_ALPHA_BLEND => AlphaMode::Blend,
        other => {
            return Err(Error::argument(format!("material.alpha_mode is {other}; it must be a LUXFER_ALPHA_ value")));
        }
    };
    Ok(Material {
        name: optional_text(params.name, "material.name")?,
        base_color: Vec3::from_array(params.base_color),
        metallic: check_range("material.metallic", params.metallic, 0.0, 1.0)?,
        roughness: check_range("material.roughness", params.roughness, 0.0, 1.0)?,
        emission: colour("material.emission", params.emission)?,
        transmission: check_range("material.transmission", params.transmission, 0.0, 1.0)?,
        ior: check_range("material.ior", params.ior, 1.0, 4.0)?,
        double_sided: check_range("material.double_sided", params.double_sided, 0, 1)? == 1,
        alpha: check_range("material.alpha", params.alpha, 0.0, 1.0)?,
        alpha_mode,
        normal_scale: check_range("material.normal_scale", params.normal_scale, f32::MIN, f32::MAX)?,
        thickness: check_range("material.thickness", params.thickness, 0.0, f32::MAX)?,
        attenuation_color: Vec3::from_array(params.attenuation_color),
        attenuation_distance: check_range(
            "material.attenuation_distance",
            params.attenuation_distance,
            f32::MIN_POSITIVE,
            f32::INFINITY,
        )?,
        ..Material::default()
    })
}

fn material(scene: &Scene, index: u32) -> Result<&Material> {
    scene.materials.get(index as usize).ok_or_else(|| missing("material", index, scene.materials.len()))
}

fn material_mut(scene: &mut Scene, index: u32) -> Result<&mut Material> {
    let count = scene.materials.len();
    scene.materials.get_mut(index as usize).ok_or_else(|| missing("material", index, count))
}

/// Returns the field of a material that holds its texture for the purpose `role`, a LUXFER_TEXTURE_ value.
fn slot(material: &mut Material, role: luxfer_texture_role) -> Result<&mut Option<TextureRef>> {
    match role {
        LUXFER_TEXTURE_BASE_COLOR => Ok(&mut material.base_color_texture),
        LUXFER_TEXTURE_METALLIC_ROUGHNESS => Ok(&mut material.metallic_roughness_texture),
        LUXFER_TEXTURE_NORMAL => Ok(&mut material.normal_texture),
        LUXFER_TEXTURE_EMISSION => Ok(&mut material.emission_texture),
        _ => Err(Error::argument(format!("role is {role}; it must be a LUXFER_TEXTURE_ value"))),
    }
}

fn wrapping(wrap: luxfer_wrap, name: &str) -> Result<Wrap> {
    match wrap {
        LUXFER_WRAP_REPEAT => Ok(Wrap::Repeat),
        LUXFER_WRAP_CLAMP => Ok(Wrap::Clamp),
        LUXFER_WRAP_MIRROR => Ok(Wrap::Mirror),
        _ => Err(Error::argument(format!("{name} is {wrap}; it must be a LUXFER_WRAP_ value"))),
    }
}

/// Reads two rows of three floats from the caller's memory; `None` for NULL.
fn six_floats(pointer: *const f32) -> Result<Option<[f32; 6]>> {
    if pointer.is_null() {
        return Ok(None);
    }
    Ok(Some(floats(bytes(pointer.cast(), size_of::<[f32; 6]>(), "transform")?)))
}

/// Returns the `luxfer_texture_use` that describes how a material uses a texture.
fn to_texture_use(scene: &Scene, used: &TextureRef) -> luxfer_texture_use {
    let wrap = scene.textures.get(used.texture).map_or([Wrap::Repeat; 2], |t| t.wrap).map(|wrap| match wrap {
        Wrap::Repeat => LUXFER_WRAP_REPEAT,
        Wrap::Clamp => LUXFER_WRAP_CLAMP,
        Wrap::Mirror => LUXFER_WRAP_MIRROR,
    });
    let [a, b, _, c, d, _, e, f, _] = used.transform.to_cols_array();
    luxfer_texture_use {
        texture: u32::try_from(used.texture).unwrap_or(LUXFER_NONE),
        uv_set: used.uv_set as u32,
        wrap_u: wrap[0],
        wrap_v: wrap[1],
        transform: [a, c, e, b, d, f],
        ..luxfer_texture_use::defaults()
    }
}
