//! Scene queries
//!
//! Traces rays through a scene and finds their nearest hits, with the same code as the renderer. These calls are
//! synchronous: they do their work before they return.

use super::guard::enter;
use super::handle::Owned;
use super::pointer::{bytes, bytes_mut, floats, strided};
use super::scene::luxfer_scene;
use super::status::luxfer_status;
use crate::accel::Ray;
use crate::exec;
use crate::render::World;
use glam::Vec3;

/// No index: stands for no mesh, no triangle, no texture or no material.
pub const LUXFER_NONE: u32 = 0xFFFF_FFFF;

/// A ray. Callers pass arrays of this struct, so its size and fields never change in later versions.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_ray {
    /// Start of the ray, in metres.
    pub origin: [f32; 3],
    /// Direction of the ray; any length but 0. Its length is the unit of distances along the ray.
    pub direction: [f32; 3],
    /// Maximum distance of a hit, in units of the length of direction; may be infinite. Only hits at distances in (0,
    /// t_max) count.
    pub t_max: f32,
}

/// The nearest hit of a ray. Callers pass arrays of this struct, so its size and fields never change in later versions.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_hit {
    /// Distance of the hit in units of the length of the ray's direction; infinite for a miss.
    pub t: f32,
    /// Index of the mesh; LUXFER_NONE for a miss.
    pub mesh: u32,
    /// Index of the triangle in its mesh; LUXFER_NONE for a miss.
    pub triangle: u32,
    /// Barycentric coordinate of the hit for the triangle's second corner; 0 for a miss.
    pub u: f32,
    /// Barycentric coordinate of the hit for the triangle's third corner; 0 for a miss.
    pub v: f32,
}

/// Rays per parallel task.
const BLOCK: usize = 4096;

/// Finds the nearest hits of count rays; the array hits receives count elements. ray_stride and hit_stride are the
/// distances between elements in bytes; 0: sizeof(luxfer_ray), sizeof(luxfer_hit). Rays and hits may be fields of one
/// struct. All surfaces count as opaque and two-sided. Of hits at equal distance, the hit with the lower index of mesh,
/// then of triangle, is returned. Rays whose origin or direction is not finite, or whose direction is 0, hit nothing.
/// The first call after a scene is loaded or changed prepares the scene for tracing, which takes longer. Any thread.
/// LUXFER_INVALID_ARGUMENT if a stride is too small or the scene is not valid: the message names the part that is not
/// valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_intersect(
    scene: *mut luxfer_scene,
    rays: *const luxfer_ray,
    count: usize,
    ray_stride: usize,
    hits: *mut luxfer_hit,
    hit_stride: usize,
) -> luxfer_status {
    enter(scene, |object| {
        if count == 0 {
            return Ok(());
        }
        let (ray_stride, size) = strided::<luxfer_ray>(count, ray_stride, "rays")?;
        let (hit_stride, hits_size) = strided::<luxfer_hit>(count, hit_stride, "hits")?;
        bytes_mut(hits.cast(), hits_size, "hits")?;
        let rays = bytes(rays.cast(), size, "rays")?;
        let world = object.ready_world()?;
        let block = |i: usize| {
            let block = rays.chunks(ray_stride.saturating_mul(BLOCK)).nth(i).unwrap_or_default();
            block.chunks(ray_stride).map(|ray| nearest(&world, &ray[..size_of::<luxfer_ray>()])).collect::<Vec<_>>()
        };
        // For few rays, waking another thread would take longer than tracing them.
        let blocks = if count <= BLOCK {
            vec![block(0)]
        } else {
            let monitor = object.context().monitor();
            object.context().quick.run(|| exec::map(count.div_ceil(BLOCK), monitor.job(), block))?
        };
        // Each hit is written alone, because rays may lie between the hits.
        for (i, hit) in blocks.into_iter().flatten().enumerate() {
            let place = hits.wrapping_byte_add(i * hit_stride);
            bytes_mut(place.cast(), size_of::<luxfer_hit>(), "hits")?.copy_from_slice(bytemuck::cast_slice(&hit));
        }
        Ok(())
    })
}

/// Traces a ray and returns the fields of its nearest hit as 32-bit words, in the order of `luxfer_hit`.
fn nearest(world: &World, ray: &[u8]) -> [u32; 5] {
    let [ox, oy, oz, dx, dy, dz, t_max] = floats(ray);
    // Divide the direction by a power of two near its length. Otherwise the squares of very long or very short
    // directions would overflow or underflow.
    let direction = Vec3::new(dx, dy, dz);
    let unit = f64::from_bits(f64::from(direction.abs().max_element()).to_bits() & f64::INFINITY.to_bits());
    let ray = world.ray(Vec3::new(ox, oy, oz), (direction.as_dvec3() / unit).as_vec3());
    let ray = Ray { t_max: (f64::from(t_max) * unit) as f32, ..ray };
    match world.accel().closest(&ray, |hit| world.is_of_scene(hit.triangle)) {
        Some(hit) => {
            let (mesh, triangle) = world.locate(hit.triangle);
            let t = (f64::from(hit.t) / unit) as f32;
            [t.to_bits(), mesh, triangle, hit.u.to_bits(), hit.v.to_bits()]
        }
        None => [f32::INFINITY.to_bits(), LUXFER_NONE, LUXFER_NONE, 0, 0],
    }
}
