//! Points of the target surface, uniform by area, with what each sends back of the light it gathers.

use super::Quantity;
use crate::error::{Error, Result};
use crate::render::SurfacePoint;
use crate::scene::{Material, Mesh, Scene};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// The generalised golden ratio of two dimensions, 1/g and 1/g² (Roberts 2018): a sequence that fills the square evenly.
const KRONECKER: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];

pub(super) struct Sampler<'a> {
    scene: &'a Scene,
    triangles: &'a [(usize, usize)],
    /// Running sums of the triangles' areas.
    cumulative: Vec<f64>,
    quantity: Quantity,
}

/// A point and the factor from its irradiance to what is matched.
pub(super) struct Target {
    pub point: SurfacePoint,
    pub factor: Vec3,
}

impl<'a> Sampler<'a> {
    pub fn new(scene: &'a Scene, triangles: &'a [(usize, usize)], quantity: Quantity) -> Result<Self> {
        let mut cumulative = Vec::with_capacity(triangles.len());
        let mut total = 0.0;
        for &(mesh, triangle) in triangles {
            let valid = scene.meshes.get(mesh).is_some_and(|m| triangle < m.triangles.len());
            if !valid {
                return Err(Error::argument(format!(
                    "target_triangles names triangle {triangle} of mesh {mesh}, which the scene does not have"
                )));
            }
            let [a, b, c] = scene.meshes[mesh].corners(triangle).map(|p| p.as_dvec3());
            total += (b - a).cross(c - a).length() / 2.0;
            cumulative.push(total);
        }
        if !(total > 0.0 && total.is_finite()) {
            return Err(Error::degenerate("the target surface has no area; choose another surface"));
        }
        Ok(Self { scene, triangles, cumulative, quantity })
    }

    /// Point `index` of the sequence that `shift` sets apart; `None` on a lamp, which the photo's mean leaves out too.
    pub fn point(&self, index: u32, shift: [f64; 2]) -> Option<Target> {
        let [u, v] = std::array::from_fn(|i| (shift[i] + f64::from(index) * KRONECKER[i]).fract());

        // Choose a triangle by area and use the rest of the same number within it.
        let total = self.cumulative[self.cumulative.len() - 1];
        let i = self.cumulative.partition_point(|&sum| sum <= u * total).min(self.triangles.len() - 1);
        let before = if i == 0 { 0.0 } else { self.cumulative[i - 1] };
        let rest = ((u * total - before) / (self.cumulative[i] - before)).clamp(0.0, 1.0);
        let root = rest.sqrt();
        let barycentric = Vec2::new((root * (1.0 - v)) as f32, (root * v) as f32);

        let (mesh, triangle) = self.triangles[i];
        let point = SurfacePoint { mesh: mesh as u32, triangle: triangle as u32, barycentric, front: true };
        let mesh = &self.scene.meshes[mesh];
        let material = &self.scene.materials[mesh.material];
        if emits(self.scene, mesh, material, triangle, barycentric) {
            return None;
        }
        let factor = match self.quantity {
            Quantity::Outgoing => diffuse_albedo(self.scene, mesh, material, triangle, barycentric) * FRAC_1_PI,
            Quantity::Incident => Vec3::splat(FRAC_1_PI),
        };
        Some(Target { point, factor })
    }
}

fn uv(mesh: &Mesh, set: usize, triangle: usize, barycentric: Vec2) -> Vec2 {
    let Some(uvs) = mesh.uvs.get(set).filter(|uvs| !uvs.is_empty()) else { return Vec2::ZERO };
    let [a, b, c] = mesh.triangles[triangle].map(|i| uvs[i as usize]);
    a + (b - a) * barycentric.x + (c - a) * barycentric.y
}

fn emits(scene: &Scene, mesh: &Mesh, material: &Material, triangle: usize, barycentric: Vec2) -> bool {
    let Some(map) = material.emission_texture else { return material.emission != Vec3::ZERO };
    let at = map.transform.transform_point2(uv(mesh, map.uv_set, triangle, barycentric));
    scene.textures[map.texture].nearest(at).truncate() * material.emission != Vec3::ZERO
}

/// Share of the irradiance sent back diffusely. Gloss is left out: a ceiling's mean colour hardly contains any.
fn diffuse_albedo(scene: &Scene, mesh: &Mesh, material: &Material, triangle: usize, barycentric: Vec2) -> Vec3 {
    let look_up = |map: crate::scene::TextureRef| {
        let at = map.transform.transform_point2(uv(mesh, map.uv_set, triangle, barycentric));
        scene.textures[map.texture].sample(at).truncate()
    };
    let base = material.base_color * material.base_color_texture.map_or(Vec3::ONE, look_up);
    let metallic = material.metallic * material.metallic_roughness_texture.map_or(1.0, |map| look_up(map).z);
    base * (1.0 - metallic) * (1.0 - material.transmission)
}
