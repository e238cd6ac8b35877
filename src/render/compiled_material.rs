//! Materials prepared for path tracing: parameters that do not vary with a texture are computed once per material.

use super::bsdf::BsdfParams;
use super::clear_coat::CoatParams;
use super::medium;
use crate::maths;
use crate::scene::Material;
use glam::Vec3;

/// The parameters of a material, and flags that let tracing skip features that the material does not use.
#[derive(Clone, Copy, Debug)]
pub struct CompiledMaterial {
    /// The BSDF parameters of all points of the surface; valid only if `is_textured` is false.
    pub bsdf_params: BsdfParams,
    /// Whether textures or vertex colours vary the parameters.
    pub is_textured: bool,
    /// Whether the material may have layers besides the diffuse one.
    pub layered: bool,
    /// Whether the material has a normal map that changes normals.
    pub has_normal_map: bool,
    /// Whether the opacity may be below 1.
    pub has_alpha: bool,
    /// Whether light may pass straight through the material, because of its opacity or its transmission.
    pub lets_light_through: bool,
    /// Number of the medium inside the bodies of this material; [`medium::AIR`] if the material is not solid glass.
    pub medium: u16,
}

impl CompiledMaterial {
    /// The material of the faces of luminaires, which reflect no light.
    pub const BLACK: Self = Self {
        bsdf_params: BsdfParams {
            diffuse: Vec3::ZERO,
            f0: Vec3::ZERO,
            f90: 0.0,
            roughness: 1.0,
            transmission: Vec3::ZERO,
            dielectric_f0: 0.0,
            dielectric_f90: 0.0,
            coat: CoatParams::NONE,
        },
        is_textured: false,
        layered: false,
        has_normal_map: false,
        has_alpha: false,
        lets_light_through: false,
        medium: medium::AIR,
    };

    /// Returns a copy with all flags set, so that tracing evaluates every shading feature.
    pub fn without_analysis(&self) -> Self {
        Self {
            is_textured: true,
            layered: true,
            has_normal_map: true,
            has_alpha: true,
            lets_light_through: true,
            ..*self
        }
    }
}

/// The values of a material that textures and vertex colours may vary, at one surface point.
#[derive(Clone, Copy, Debug)]
pub struct PointValues {
    /// Base colour.
    pub base: Vec3,
    pub metallic: f32,
    pub roughness: f32,
    /// Strength and colour of the reflections of the dielectric component.
    pub specular: f32,
    pub specular_color: Vec3,
    pub coat: CoatParams,
}

impl PointValues {
    /// Returns the values of a material without its textures.
    pub fn new(material: &Material) -> Self {
        Self {
            base: material.base_color,
            metallic: material.metallic,
            roughness: material.roughness,
            specular: material.specular.strength,
            specular_color: material.specular.color,
            coat: CoatParams { share: material.coat.strength, roughness: material.coat.roughness },
        }
    }
}

/// Converts the values of a material at a surface point to the parameters of the layers (glTF 2.0, appendix B.2,
/// `KHR_materials_specular` and `KHR_materials_clearcoat`).
pub fn bsdf_params(material: &Material, values: &PointValues) -> BsdfParams {
    layers(material, material.transmission, values)
}

fn layers(material: &Material, transmission: f32, values: &PointValues) -> BsdfParams {
    let base = values.base.clamp(Vec3::ZERO, Vec3::ONE);
    let (metallic, roughness) = (values.metallic.clamp(0.0, 1.0), values.roughness.clamp(0.0, 1.0));
    let specular = values.specular.clamp(0.0, 1.0);
    let transmission = transmission.clamp(0.0, 1.0);
    let reflectance = maths::powi((material.ior - 1.0) / (material.ior + 1.0), 2);
    let dielectric_f0 = (values.specular_color * reflectance).clamp(Vec3::ZERO, Vec3::ONE) * specular;
    // A dielectric with an index of refraction of 1 has no interface, so it does not reflect at grazing angles either.
    let has_interface = material.ior > 1.0;
    BsdfParams {
        diffuse: base * ((1.0 - metallic) * (1.0 - transmission)),
        f0: dielectric_f0.lerp(base, metallic),
        f90: if has_interface { specular + (1.0 - specular) * metallic } else { metallic },
        roughness,
        transmission: base * ((1.0 - metallic) * transmission),
        dielectric_f0: dielectric_f0.max_element(),
        dielectric_f90: if has_interface { specular } else { metallic },
        coat: CoatParams { share: values.coat.share.clamp(0.0, 1.0), roughness: values.coat.roughness.clamp(0.0, 1.0) },
    }
}

/// The parameters of a solid body's material at a surface point. The surface consists of tiny patches: some are clear
/// glass, the others are opaque.
#[derive(Clone, Copy, Debug)]
pub struct SolidParams {
    /// Share of the surface that is clear glass.
    pub clear: f32,
    /// Share of the refracted light that passes the surface, per channel.
    pub tint: Vec3,
    pub roughness: f32,
    /// The opaque patches; not meaningful if there are none.
    pub opaque: BsdfParams,
}

/// Converts the metallic-roughness parameters at a point of a solid body's surface. The blend of glTF (appendix B.2,
/// `KHR_materials_transmission`) is linear in the shares of metal, of transmission and of the diffuse base, so a blend
/// of patches is the same.
pub fn solid_params(material: &Material, values: &PointValues) -> SolidParams {
    let metallic = values.metallic.clamp(0.0, 1.0);
    let clear = (1.0 - metallic) * material.transmission.clamp(0.0, 1.0);
    let metallic = if clear < 1.0 { metallic / (1.0 - clear) } else { 0.0 };
    SolidParams {
        clear,
        tint: values.base.clamp(Vec3::ZERO, Vec3::ONE),
        roughness: values.roughness.clamp(0.0, 1.0),
        opaque: layers(material, 0.0, &PointValues { metallic, ..*values }),
    }
}
