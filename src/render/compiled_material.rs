//! Materials made ready for tracing: what no texture varies is worked out once.

use super::bsdf::Substance;
use crate::scene::Material;
use glam::Vec3;

/// How a material is to be looked at.
#[derive(Clone, Copy, Debug)]
pub struct CompiledMaterial {
    /// What it is made of, where no texture varies it.
    pub substance: Substance,
    /// Whether textures vary what it is made of.
    pub is_textured: bool,
    /// Whether there may be more to it than a diffuse layer.
    pub layered: bool,
    /// Whether a texture bends its normals.
    pub has_normal_map: bool,
    /// Whether parts of it may not be there.
    pub has_alpha: bool,
    /// Whether light may go straight through it, for either reason.
    pub lets_light_through: bool,
}

impl CompiledMaterial {
    /// The same with every question left open.
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

/// glTF 2.0, appendix B.2: from metallic-roughness to layers.
pub fn substance(material: &Material, base: Vec3, metallic: f32, roughness: f32) -> Substance {
    let base = base.clamp(Vec3::ZERO, Vec3::ONE);
    let (metallic, roughness) = (metallic.clamp(0.0, 1.0), roughness.clamp(0.0, 1.0));
    let transmission = material.transmission.clamp(0.0, 1.0);
    let dielectric_f0 = ((material.ior - 1.0) / (material.ior + 1.0)).powi(2);
    // An index of 1 is no interface at all, so it does not reflect at grazing angles either.
    let has_interface = material.ior > 1.0;
    Substance {
        diffuse: base * ((1.0 - metallic) * (1.0 - transmission)),
        f0: Vec3::splat(dielectric_f0).lerp(base, metallic),
        f90: if has_interface { 1.0 } else { metallic },
        roughness,
        transmission: base * ((1.0 - metallic) * transmission),
        dielectric_f0,
    }
}
