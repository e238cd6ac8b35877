//! Chooses a camera for a scene that has no camera. The candidates stand near the corners of a given surface, such as
//! the ceiling, on its lit side. The chosen candidate sees farthest, on average over its image.

use super::world::World;
use crate::scene::surface::Surface;
use crate::scene::{Camera, Scene};
use glam::{Vec2, Vec3};

/// Vertical angle of view in radians. [convention]
const FOV_Y: f32 = 0.9;
/// Distances of the candidate cameras from the two sides of the surface that meet at a corner. Each distance is a share
/// of the side across which it is measured: 0.08 of a 10 m long ceiling is 0.8 m. [convention]
const INSETS: [f32; 2] = [0.08, 0.2];
/// Distances of the candidate cameras from the surface, as shares of the depth of the scene below the surface.
/// [convention]
const HEIGHTS: [f32; 2] = [0.35, 0.5];
/// Numbers of columns and rows of rays whose mean length is the score of a camera.
const RAYS: [usize; 2] = [12, 8];

/// Returns the candidate camera whose rays have the largest mean length. A ray ends at its first hit. A length above
/// the diagonal of the surface counts as the diagonal.
pub fn overview_camera(world: &World, surface: &Surface) -> Camera {
    let depth = depth_below(world.scene(), surface);
    let mut best = (f32::NEG_INFINITY, None);
    for corner in 0..4 {
        for inset in INSETS {
            for height in HEIGHTS {
                let camera = candidate(surface, corner, inset, height * depth);
                let score = openness(world, &camera, surface.size.length());
                if score > best.0 {
                    best = (score, Some(camera));
                }
            }
        }
    }
    best.1.unwrap_or_else(|| candidate(surface, 0, INSETS[0], HEIGHTS[0] * depth))
}

/// Returns the largest distance in metres of a vertex from the plane of the surface, on the lit side. If no vertex lies
/// on that side, returns half of the surface's longer side.
fn depth_below(scene: &Scene, surface: &Surface) -> f32 {
    let points = scene.meshes.iter().flat_map(|m| &m.positions);
    let depth = points.map(|p| (*p - surface.origin).dot(surface.normal)).fold(0.0, f32::max);
    if depth > 0.0 { depth } else { surface.size.max_element() / 2.0 }
}

/// A camera `below` metres from the surface, near one of its corners. It looks parallel to the surface, towards the
/// diagonally opposite corner.
fn candidate(surface: &Surface, corner: usize, inset: f32, below: f32) -> Camera {
    let at = |u: f32, v: f32| {
        let on_surface = Vec2::new(u, v) * surface.size;
        surface.origin + surface.u_axis * on_surface.x + surface.v_axis * on_surface.y + surface.normal * below
    };
    let near = |far: bool| if far { 1.0 - inset } else { inset };
    let (u, v) = (near(corner & 1 == 1), near(corner >> 1 == 1));
    let position = at(u, v);
    Camera { name: "Overview".into(), ..Camera::look_at(position, at(1.0 - u, 1.0 - v), FOV_Y) }
}

fn openness(world: &World, camera: &Camera, cap: f32) -> f32 {
    let mut sum = 0.0;
    for i in 0..RAYS[0] * RAYS[1] {
        let x = ((i % RAYS[0]) as f32 + 0.5) / RAYS[0] as f32;
        let y = ((i / RAYS[0]) as f32 + 0.5) / RAYS[1] as f32;
        let direction: Vec3 = camera.direction(x, y, 16.0 / 9.0).normalize();
        let hit = world.accel().closest(&world.ray(camera.position, direction), |_| true);
        // Count a ray that hits nothing as half of `cap`, the maximum length.
        sum += hit.map_or(cap / 2.0, |h| h.t.min(cap));
    }
    sum
}
