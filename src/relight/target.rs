//! Samples points of the target uniformly by area, with their reflectance.

use super::params::{Quantity, TargetGeometry};
use crate::error::{Error, Result};
use crate::render::{self, PathSink, SurfacePoint, World};
use crate::scene::{Material, Mesh, Scene};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Steps of a low-discrepancy sequence (Roberts 2018): 1/g and 1/g² of the generalised golden ratio g in two
/// dimensions. [convention]
const KRONECKER: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];

pub(super) enum Sampler<'a> {
    Surface(Surface<'a>),
    Grid { origin: Vec3, across: Vec3, down: Vec3, normal: Vec3 },
}

pub(super) struct Surface<'a> {
    scene: &'a Scene,
    triangles: &'a [(usize, usize)],
    /// Cumulative areas of the triangles.
    cumulative: Vec<f64>,
    quantity: Quantity,
}

/// A target point, and the factor that converts its irradiance to the radiance that is compared with the photo.
pub(super) struct Target {
    at: At,
    pub factor: Vec3,
}

enum At {
    Surface(SurfacePoint),
    Air { position: Vec3, normal: Vec3 },
}

impl Target {
    /// Traces one sample of the irradiance at the point and adds it to a sink.
    pub fn gather<S: PathSink>(&self, world: &World, seed: u64, sample: u32, sink: &mut S) {
        match &self.at {
            At::Surface(point) => render::irradiance(world, point, seed, sample, sink),
            At::Air { position, normal } => {
                render::irradiance_in_air(world, *position, *normal, seed, sample, sink);
            }
        }
    }
}

impl<'a> Sampler<'a> {
    /// Creates the sampler of a target. `scene` provides the reflectance of the target, and the lamps to exclude.
    pub fn new(scene: &'a Scene, geometry: TargetGeometry<'a>, quantity: Quantity) -> Result<Self> {
        match geometry {
            TargetGeometry::Surface(triangles) => Surface::new(scene, triangles, quantity).map(Self::Surface),
            TargetGeometry::Grid { origin, across, down, normal } => {
                let unit = normal.normalize_or_zero();
                if !(origin.is_finite() && across.is_finite() && down.is_finite()) || unit == Vec3::ZERO {
                    return Err(Error::argument(format!(
                        "the target grid's origin is {origin}, its edges are {across} and {down}, its normal is {normal}; \
                         all must be finite and the normal not 0"
                    )));
                }
                Ok(Self::Grid { origin, across, down, normal: unit })
            }
        }
    }

    /// Returns point `index` of the low-discrepancy sequence with offset `shift`. `None` if the point lies on a lamp:
    /// the mean of the photo excludes lamps too.
    pub fn point(&self, index: u32, shift: [f64; 2]) -> Option<Target> {
        let [u, v] = std::array::from_fn(|i| (shift[i] + f64::from(index) * KRONECKER[i]).fract());
        match self {
            Self::Surface(surface) => surface.point(u, v),
            Self::Grid { origin, across, down, normal } => {
                let position = *origin + *across * u as f32 + *down * v as f32;
                Some(Target { at: At::Air { position, normal: *normal }, factor: Vec3::splat(FRAC_1_PI) })
            }
        }
    }
}

impl<'a> Surface<'a> {
    fn new(scene: &'a Scene, triangles: &'a [(usize, usize)], quantity: Quantity) -> Result<Self> {
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

    fn point(&self, u: f64, v: f64) -> Option<Target> {
        // Select a triangle with a probability proportional to its area. Reuse the remainder of the random number for
        // the point in the triangle.
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
        Some(Target { at: At::Surface(point), factor })
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

/// Returns the diffuse albedo. Glossy reflection is neglected: it contributes hardly anything to the mean colour of a
/// ceiling.
fn diffuse_albedo(scene: &Scene, mesh: &Mesh, material: &Material, triangle: usize, barycentric: Vec2) -> Vec3 {
    let look_up = |map: crate::scene::TextureRef| {
        let at = map.transform.transform_point2(uv(mesh, map.uv_set, triangle, barycentric));
        scene.textures[map.texture].sample(at).truncate()
    };
    let base = material.base_color * material.base_color_texture.map_or(Vec3::ONE, look_up);
    let metallic = material.metallic * material.metallic_roughness_texture.map_or(1.0, |map| look_up(map).z);
    base * (1.0 - metallic) * (1.0 - material.transmission)
}
