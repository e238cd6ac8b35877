//! An emissive triangle, with the geometry and the texture look-up that sampling its emission needs.

use crate::render::contribution::mean_channel;
use crate::render::facet::{Facet, NONE};
use crate::scene::{Scene, Texture};
use glam::{DVec2, Vec2, Vec3, Vec4};

pub struct Emitter {
    pub mesh: u32,
    /// Index of the triangle within its mesh.
    pub triangle: u32,
    pub id: u32,
    pub corners: [Vec3; 3],
    /// Unit normal of the front side.
    pub normal: Vec3,
    pub area: f32,
    pub double_sided: bool,
    /// Index of the patch of a luminaire that the triangle belongs to; `NONE` for a triangle of a mesh.
    pub(super) patch: u32,
    pub(super) factor: Vec3,
    pub(super) texture: Option<usize>,
    /// Texture coordinates of the corners in the emission texture, after the material's texture transform.
    pub(super) uv: [Vec2; 3],
}

impl Emitter {
    /// Builds the emitter of a triangle of a mesh; `None` if the triangle does not emit or has no area. `id` is the
    /// index of the triangle among all triangles of the scene; `first` holds the id of each mesh's first triangle.
    pub(super) fn new(scene: &Scene, facet: &Facet, id: u32, first: &[u32]) -> Option<Self> {
        let (mesh, triangle) = (facet.mesh, id - first[facet.mesh as usize]);
        let m = &scene.meshes[mesh as usize];
        let material = &scene.materials[m.material];
        if material.emission.max_element() <= 0.0 {
            return None;
        }
        let corners = facet.corners();
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let doubled = (b - a).cross(c - a);
        let area = (doubled.length() / 2.0) as f32;
        if !(area.is_finite() && area > 0.0) {
            return None;
        }
        let mut uv = [Vec2::ZERO; 3];
        if let Some(t) = &material.emission_texture
            && !m.uvs[t.uv_set].is_empty()
        {
            uv = m.triangles[triangle as usize].map(|i| t.transform.transform_point2(m.uvs[t.uv_set][i as usize]));
        }
        Some(Self {
            mesh,
            triangle,
            id,
            corners,
            normal: doubled.normalize().as_vec3(),
            area,
            double_sided: material.double_sided,
            patch: NONE,
            factor: material.emission.max(Vec3::ZERO),
            texture: material.emission_texture.as_ref().map(|t| t.texture),
            uv,
        })
    }

    /// Builds the emitter of a triangle of a luminaire's patch; `None` if the triangle has no area. `mesh` is the index
    /// of the luminaire's mesh, `triangle` the index of the triangle within this mesh, and `id` its index among all
    /// triangles.
    pub(super) fn of_patch(facet: &Facet, [mesh, triangle, id]: [u32; 3], patch: u32) -> Option<Self> {
        let corners = facet.corners();
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let area = ((b - a).cross(c - a).length() / 2.0) as f32;
        let (factor, uv) = (Vec3::ZERO, [Vec2::ZERO; 3]);
        let normal = facet.normal;
        let this =
            Self { mesh, triangle, id, corners, normal, area, double_sided: false, patch, factor, texture: None, uv };
        (area.is_finite() && area > 0.0).then_some(this)
    }

    /// Returns the emission at a point of the triangle, in cd/m² per channel, and the texture coordinates of the
    /// look-up. The result is valid only for triangles of meshes, not for patches of luminaires.
    pub fn emission(&self, scene: &Scene, barycentric: Vec2) -> (Vec3, Vec2) {
        let b = barycentric;
        let uv = self.uv[0] * (1.0 - b.x - b.y) + self.uv[1] * b.x + self.uv[2] * b.y;
        match self.texture {
            None => (self.factor, uv),
            Some(texture) => (self.factor * scene.textures[texture].nearest(uv).truncate().max(Vec3::ZERO), uv),
        }
    }

    /// Returns the emission of a texel of this colour in cd/m², averaged over the channels.
    pub(super) fn emission_of_texel(&self, colour: Vec4) -> f32 {
        mean_channel(self.factor * colour.truncate().max(Vec3::ZERO))
    }

    pub fn point(&self, b: Vec2) -> Vec3 {
        self.corners[0] * (1.0 - b.x - b.y) + self.corners[1] * b.x + self.corners[2] * b.y
    }

    /// Whether the triangle emits from the side that a ray with this direction hits.
    pub fn faces(&self, direction: Vec3) -> bool {
        self.double_sided || self.normal.dot(direction) < 0.0
    }

    /// Returns the corners in texel coordinates of `texture`.
    pub(super) fn texels(&self, texture: &Texture) -> [DVec2; 3] {
        let size = DVec2::new(texture.image.width as f64, texture.image.height as f64);
        self.uv.map(|uv| uv.as_dvec2() * size)
    }
}
