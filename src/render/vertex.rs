//! A point of a surface that a path has reached: where it is, how it is oriented, and what it is made of there.

use super::bsdf::{Bsdf, Substance};
use super::world::{NONE, World};
use crate::scene::accel::{Hit, Ray};
use crate::scene::{Material, Mesh, TextureRef};
use glam::{Vec2, Vec3};

/// Rounding of an interpolated point: sixteen errors of 2^-24 of its largest coordinate.
const OFFSET: f32 = 1.0 / (1 << 20) as f32;

pub struct Vertex {
    pub mesh: u32,
    /// Index within the mesh, and among all triangles of the scene.
    pub triangle: u32,
    pub id: u32,
    pub barycentric: Vec2,
    pub position: Vec3,
    /// Unit geometric normal of the front face.
    pub normal: Vec3,
    /// Distance that clears the rounding of `position`.
    offset: f32,
}

impl Vertex {
    pub fn of_hit(world: &World, hit: &Hit) -> Self {
        let (mesh, triangle) = world.locate(hit.triangle);
        Self::new(world, mesh, triangle, Vec2::new(hit.u, hit.v))
    }

    pub fn new(world: &World, mesh: u32, triangle: u32, barycentric: Vec2) -> Self {
        let [a, b, c] = world.scene().meshes[mesh as usize].corners(triangle as usize);
        let largest = a.abs().max(b.abs()).max(c.abs()).max_element();
        Self {
            mesh,
            triangle,
            id: world.id(mesh, triangle),
            barycentric,
            position: a * (1.0 - barycentric.x - barycentric.y) + b * barycentric.x + c * barycentric.y,
            normal: geometric_normal([a, b, c]),
            offset: largest * OFFSET,
        }
    }

    /// A point that is on no surface, facing along a unit normal. It clears surfaces it may happen to lie in.
    pub fn free(world: &World, position: Vec3, normal: Vec3) -> Self {
        let (low, high) = world.accel().bounds();
        let largest = position.abs().max(low.abs()).max(high.abs()).max_element();
        let (mesh, triangle, barycentric) = (NONE, NONE, Vec2::ZERO);
        Self { mesh, triangle, id: NONE, barycentric, position, normal, offset: largest * OFFSET }
    }

    /// The point moved off its surface to the side of `direction` (Wächter and Binder 2019, with the scale of the
    /// triangle in place of that of the point: coordinates near 0 carry the errors of larger ones).
    pub fn off_surface(&self, direction: Vec3) -> Vec3 {
        let side = if self.normal.dot(direction) < 0.0 { -self.offset } else { self.offset };
        self.position + self.normal * side
    }

    pub fn ray(&self, direction: Vec3) -> Ray {
        Ray::new(self.off_surface(direction), direction)
    }

    pub fn material<'w>(&self, world: &'w World) -> &'w Material {
        let scene = world.scene();
        &scene.materials[scene.meshes[self.mesh as usize].material]
    }

    /// What scatters light that leaves along `wo`.
    pub fn bsdf<'w>(&self, world: &'w World, wo: Vec3) -> Bsdf<'w> {
        let mesh = &world.scene().meshes[self.mesh as usize];
        let material = self.material(world);
        let substance = substance(world, mesh, material, self.triangle, self.barycentric);
        Bsdf::new(substance, self.shading_normal(world, mesh, material), self.normal, wo, world.albedo_table())
    }

    fn shading_normal(&self, world: &World, mesh: &Mesh, material: &Material) -> Vec3 {
        let mut normal = self.normal;
        if !mesh.normals.is_empty() {
            let [a, b, c] = mesh.triangles[self.triangle as usize].map(|i| mesh.normals[i as usize]);
            let v = self.barycentric;
            let n = (a * (1.0 - v.x - v.y) + b * v.x + c * v.y).normalize_or(normal);
            // Normals that point to the other side than the winding are taken to mean the axis only.
            normal = if n.dot(normal) < 0.0 { -n } else { n };
        }
        let Some(texture) = &material.normal_texture else { return normal };
        let Some((along_u, along_v)) = self.tangents(mesh, texture) else { return normal };
        let texel = look_up(world, mesh, self.triangle, self.barycentric, texture);
        let n = texel * 2.0 - Vec3::ONE;
        let t = (along_u - normal * normal.dot(along_u)).normalize_or_zero();
        // Green points up in the image, which is towards smaller v.
        let b = normal.cross(t);
        let b = if b.dot(along_v) > 0.0 { -b } else { b };
        (t * (n.x * material.normal_scale) + b * (n.y * material.normal_scale) + normal * n.z).normalize_or(normal)
    }

    /// Directions in which u and v grow.
    fn tangents(&self, mesh: &Mesh, texture: &TextureRef) -> Option<(Vec3, Vec3)> {
        let [a, b, c] = mesh.corners(self.triangle as usize);
        let [p, q, r] = corner_uvs(mesh, self.triangle, texture)?;
        let (e, f, d, g) = (b - a, c - a, q - p, r - p);
        let determinant = d.perp_dot(g);
        let (u, v) = ((e * g.y - f * d.y) / determinant, (f * d.x - e * g.x) / determinant);
        (u.is_finite() && v.is_finite()).then_some((u, v))
    }
}

pub fn geometric_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    // In f64: the cross product of the sides of a small triangle far from the origin cancels.
    let [a, b, c] = [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()];
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

fn corner_uvs(mesh: &Mesh, triangle: u32, texture: &TextureRef) -> Option<[Vec2; 3]> {
    let uvs = &mesh.uvs[texture.uv_set];
    (!uvs.is_empty())
        .then(|| mesh.triangles[triangle as usize].map(|i| texture.transform.transform_point2(uvs[i as usize])))
}

fn look_up_rgba(world: &World, mesh: &Mesh, triangle: u32, v: Vec2, texture: &TextureRef) -> glam::Vec4 {
    let [p, q, r] = corner_uvs(mesh, triangle, texture).unwrap_or_default();
    world.scene().textures[texture.texture].sample(p * (1.0 - v.x - v.y) + q * v.x + r * v.y)
}

fn look_up(world: &World, mesh: &Mesh, triangle: u32, barycentric: Vec2, texture: &TextureRef) -> Vec3 {
    look_up_rgba(world, mesh, triangle, barycentric, texture).truncate()
}

/// Share of a surface that is there.
pub fn opacity(world: &World, mesh: &Mesh, material: &Material, triangle: u32, barycentric: Vec2) -> f32 {
    let texture = material.base_color_texture.as_ref();
    material.alpha * texture.map_or(1.0, |t| look_up_rgba(world, mesh, triangle, barycentric, t).w)
}

/// glTF 2.0, appendix B.2: from metallic-roughness to layers.
pub fn substance(world: &World, mesh: &Mesh, material: &Material, triangle: u32, barycentric: Vec2) -> Substance {
    let look_up = |t: &TextureRef| look_up(world, mesh, triangle, barycentric, t);
    let mut base = material.base_color;
    if let Some(texture) = &material.base_color_texture {
        base *= look_up(texture);
    }
    let (mut metallic, mut roughness) = (material.metallic, material.roughness);
    if let Some(texture) = &material.metallic_roughness_texture {
        let texel = look_up(texture);
        (roughness, metallic) = (roughness * texel.y, metallic * texel.z);
    }
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
