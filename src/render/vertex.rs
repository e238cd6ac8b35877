//! Vertices of light paths: surface points with position, orientation and material.

use super::bsdf::{Bsdf, BsdfParams, Interface};
use super::compiled_material::CompiledMaterial;
use super::facet::{self, Facet, NONE};
use super::ggx::AlbedoTable;
use super::medium::{self, Media};
use super::texture_context::TextureContext;
use super::world::World;
use crate::accel::{Hit, Ray};
use crate::rng;
use glam::{Vec2, Vec3};

pub struct Vertex {
    pub mesh: u32,
    /// Index of the triangle within the mesh.
    pub triangle: u32,
    pub id: u32,
    pub barycentric: Vec2,
    /// Position in world coordinates (relative to the centre of the [`World`]), in metres.
    pub position: Vec3,
    /// Unit geometric normal of the front side.
    pub normal: Vec3,
    /// Distance by which rays start off the surface; it exceeds the rounding error of `position`.
    offset: f32,
}

impl Vertex {
    #[inline]
    pub fn of_hit(world: &World, hit: &Hit) -> Self {
        Self::new(world, hit.triangle, Vec2::new(hit.u, hit.v))
    }

    /// Returns a point on triangle number `id` of the scene.
    #[inline]
    pub fn new(world: &World, id: u32, barycentric: Vec2) -> Self {
        let facet = world.facet(id);
        Self {
            mesh: facet.mesh,
            triangle: id - world.first(facet.mesh),
            id,
            barycentric,
            position: facet.point(barycentric),
            normal: facet.normal,
            offset: facet.offset,
        }
    }

    /// Returns a point in free space, in world coordinates, that faces along a unit normal. The point may happen to
    /// lie in a surface, so its offset is large enough to move rays off that surface.
    pub fn free(world: &World, position: Vec3, normal: Vec3) -> Self {
        let (low, high) = world.accel().bounds();
        let extent = low.abs().max(high.abs()).max_element().min(facet::MAX_FREE_COORDINATE);
        let largest = position.abs().max_element().max(extent);
        let (mesh, triangle, barycentric) = (NONE, NONE, Vec2::ZERO);
        Self { mesh, triangle, id: NONE, barycentric, position, normal, offset: largest * facet::OFFSET }
    }

    /// Returns the point moved off its surface, to the side of `direction` (after Wächter and Binder 2019). The offset
    /// is proportional to the largest coordinate of the triangle, not of the point, since a coordinate near 0 carries
    /// the rounding errors of larger coordinates.
    #[inline]
    pub fn off_surface(&self, direction: Vec3) -> Vec3 {
        self.position + self.normal * self.offset.copysign(self.normal.dot(direction))
    }

    #[inline]
    pub fn ray(&self, direction: Vec3) -> Ray {
        Ray::new(self.off_surface(direction), direction)
    }

    /// Returns the BSDF at this point, which a path meets from direction `wo` among `media`. `seed` returns the seed of
    /// a random decision (see [`Vertex::surface`]).
    #[inline]
    pub fn bsdf<'w>(&self, world: &'w World, media: Media, seed: impl Fn() -> u64, wo: Vec3) -> Bsdf<'w> {
        self.surface(world, media, seed).seen_from(world, wo)
    }

    /// Returns the shading data of the point that do not depend on the direction of the viewer, which is among `media`.
    /// If a solid body's material is partly opaque, a random decision tells whether the point is clear or opaque;
    /// `seed` returns the seed of that decision.
    #[inline]
    pub fn surface<'w>(&self, world: &'w World, media: Media, seed: impl Fn() -> u64) -> Surface<'w> {
        let facet = world.facet(self.id);
        let compiled = world.compiled_material(facet);
        if compiled.medium != medium::AIR {
            return self.surface_of_solid(world, compiled, media, seed());
        }
        // Skip the look-ups of normals and textures if the surface does not need them, as is the case for most
        // surfaces.
        let shading =
            if facet.is_smooth() || compiled.has_normal_map { self.shading_normal(world, facet) } else { self.normal };
        let bsdf_params = if compiled.is_textured {
            TextureContext::new(world.scene(), facet, self.triangle, self.barycentric).bsdf_params(compiled)
        } else {
            compiled.bsdf_params
        };
        let (normals, table) = ([shading, self.normal], world.albedo_table());
        Surface { kind: SurfaceKind::Layers { bsdf_params, layered: compiled.layered }, normals, table }
    }

    #[inline(never)]
    fn surface_of_solid<'w>(
        &self,
        world: &'w World,
        compiled: &CompiledMaterial,
        media: Media,
        seed: u64,
    ) -> Surface<'w> {
        let facet = world.facet(self.id);
        let solid = TextureContext::new(world.scene(), facet, self.triangle, self.barycentric).solid_params();
        let u = (rng::hash(seed, &[u64::from(self.id), CLEAR]) >> 40) as f32 / (1 << 24) as f32;
        let kind = if u < solid.clear {
            SurfaceKind::Boundary { media, medium: compiled.medium, tint: solid.tint, roughness: solid.roughness }
        } else {
            SurfaceKind::Layers { bsdf_params: solid.opaque, layered: true }
        };
        let shading = self.shading_normal(world, facet);
        Surface { kind, normals: [shading, self.normal], table: world.albedo_table() }
    }

    fn shading_normal(&self, world: &World, facet: &Facet) -> Vec3 {
        let context = TextureContext::new(world.scene(), facet, self.triangle, self.barycentric);
        let (mesh, material) = (context.mesh, context.material);
        let mut normal = self.normal;
        if !mesh.normals.is_empty() {
            let [a, b, c] = mesh.triangles[self.triangle as usize].map(|i| mesh.normals[i as usize]);
            let v = self.barycentric;
            let n = (a * (1.0 - v.x - v.y) + b * v.x + c * v.y).normalize_or(normal);
            // Flip a normal that opposes the winding, so that it lies on the front side.
            normal = if n.dot(normal) < 0.0 { -n } else { n };
        }
        let Some(texture) = &material.normal_texture else { return normal };
        let Some((along_u, along_v)) = context.tangents(facet, texture) else { return normal };
        let texel = context.look_up(texture).truncate();
        let n = texel * 2.0 - Vec3::ONE;
        let t = (along_u - normal * normal.dot(along_u)).normalize_or_zero();
        // Orient the bitangent so that it points towards smaller v: green in a normal map points up in the image.
        let b = normal.cross(t);
        let b = if b.dot(along_v) > 0.0 { -b } else { b };
        (t * (n.x * material.normal_scale) + b * (n.y * material.normal_scale) + normal * n.z).normalize_or(normal)
    }
}

/// Number that distinguishes the random decision between clear and opaque from other decisions of a path.
const CLEAR: u64 = 1;

/// The shading data of a surface point that do not depend on the direction of the viewer.
pub struct Surface<'w> {
    kind: SurfaceKind,
    /// Shading normal and geometric normal, both pointing to the front side.
    normals: [Vec3; 2],
    table: Option<&'w AlbedoTable>,
}

enum SurfaceKind {
    Layers {
        bsdf_params: BsdfParams,
        /// Whether the material may have layers besides the diffuse one.
        layered: bool,
    },
    /// A clear point of a solid body's surface; `media` are the media of the viewer, `medium` fills the body.
    Boundary { media: Media, medium: u16, tint: Vec3, roughness: f32 },
}

impl<'w> Surface<'w> {
    /// Returns the BSDF for a viewer in direction `wo`; `world` is the scene of the point.
    #[inline]
    pub fn seen_from(&self, world: &World, wo: Vec3) -> Bsdf<'w> {
        match &self.kind {
            SurfaceKind::Layers { bsdf_params, layered } => {
                Bsdf::new(bsdf_params, *layered, self.normals, wo, self.table)
            }
            &SurfaceKind::Boundary { media, medium, tint, roughness } => {
                let boundary = media.boundary(medium, self.normals[1].dot(wo) > 0.0, world.media());
                Bsdf::boundary(&Interface { boundary, tint, roughness }, self.normals, wo)
            }
        }
    }
}
