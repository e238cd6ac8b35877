//! Texture look-ups at a surface point: opacity, BSDF parameters, and tangents for normal maps.

use super::bsdf::BsdfParams;
use super::compiled_material::{self, CompiledMaterial, PointValues, SolidParams};
use super::facet::Facet;
use crate::scene::{Material, Mesh, Scene, TextureRef};
use glam::{Vec2, Vec3, Vec4};

/// A point on a triangle, with the mesh and the material that look-ups need.
pub struct TextureContext<'w> {
    scene: &'w Scene,
    pub mesh: &'w Mesh,
    pub material: &'w Material,
    triangle: u32,
    barycentric: Vec2,
}

impl<'w> TextureContext<'w> {
    /// Describes a point of `facet`; `triangle` is the index of the facet within its mesh.
    pub fn new(scene: &'w Scene, facet: &Facet, triangle: u32, barycentric: Vec2) -> Self {
        let (mesh, material) = (&scene.meshes[facet.mesh as usize], &scene.materials[facet.material()]);
        Self { scene, mesh, material, triangle, barycentric }
    }

    /// Returns the opacity (coverage) of the surface at this point.
    pub fn opacity(&self) -> f32 {
        let texture = self.material.base_color_texture.as_ref();
        self.material.alpha * texture.map_or(1.0, |t| self.look_up(t).w) * self.vertex_colour().w
    }

    /// Returns the BSDF parameters at this point.
    pub fn bsdf_params(&self, compiled: &CompiledMaterial) -> BsdfParams {
        if !compiled.is_textured {
            return compiled.bsdf_params;
        }
        compiled_material::bsdf_params(self.material, &self.values())
    }

    /// Returns the parameters of a solid body's material at this point.
    pub fn solid_params(&self) -> SolidParams {
        compiled_material::solid_params(self.material, &self.values())
    }

    /// Returns the values of the material at this point.
    fn values(&self) -> PointValues {
        let material = self.material;
        let mut values = PointValues::new(material);
        values.base *= self.vertex_colour().truncate();
        if let Some(texture) = &material.base_color_texture {
            values.base *= self.look_up(texture).truncate();
        }
        if let Some(texture) = &material.metallic_roughness_texture {
            let texel = self.look_up(texture);
            values.roughness *= texel.y;
            values.metallic *= texel.z;
        }
        if let Some(texture) = &material.specular.texture {
            values.specular *= self.look_up(texture).w;
        }
        if let Some(texture) = &material.specular.color_texture {
            values.specular_color *= self.look_up(texture).truncate();
        }
        if let Some(texture) = &material.coat.texture {
            values.coat.share *= self.look_up(texture).x;
        }
        if let Some(texture) = &material.coat.roughness_texture {
            values.coat.roughness *= self.look_up(texture).y;
        }
        values
    }

    /// Returns the interpolated vertex colour; 1 if the mesh has no vertex colours.
    fn vertex_colour(&self) -> Vec4 {
        let colours = &self.mesh.colours;
        if colours.is_empty() {
            return Vec4::ONE;
        }
        let [p, q, r] = self.mesh.triangles[self.triangle as usize].map(|i| colours[i as usize]);
        let v = self.barycentric;
        p * (1.0 - v.x - v.y) + q * v.x + r * v.y
    }

    pub fn look_up(&self, texture: &TextureRef) -> Vec4 {
        let uvs = &self.mesh.uvs[texture.uv_set];
        let mut uv = Vec2::ZERO;
        if !uvs.is_empty() {
            let [p, q, r] = self.mesh.triangles[self.triangle as usize].map(|i| uvs[i as usize]);
            let v = self.barycentric;
            uv = texture.transform.transform_point2(p * (1.0 - v.x - v.y) + q * v.x + r * v.y);
        }
        self.scene.textures[texture.texture].sample(uv)
    }

    fn corner_uvs(&self, texture: &TextureRef) -> Option<[Vec2; 3]> {
        let uvs = &self.mesh.uvs[texture.uv_set];
        let corners = || self.mesh.triangles[self.triangle as usize];
        (!uvs.is_empty()).then(|| corners().map(|i| texture.transform.transform_point2(uvs[i as usize])))
    }

    /// Returns the derivatives of the position on the triangle with respect to u and v, not normalised. `None` if the
    /// mesh has no texture coordinates, or if they have no area on this triangle.
    pub fn tangents(&self, facet: &Facet, texture: &TextureRef) -> Option<(Vec3, Vec3)> {
        let [a, b, c] = facet.corners();
        let [p, q, r] = self.corner_uvs(texture)?;
        let (e, f, d, g) = (b - a, c - a, q - p, r - p);
        let determinant = d.perp_dot(g);
        let (u, v) = ((e * g.y - f * d.y) / determinant, (f * d.x - e * g.x) / determinant);
        (u.is_finite() && v.is_finite()).then_some((u, v))
    }
}
