//! Target surfaces: a planar patch chosen by name, and emission laid onto it.

use super::Scene;
use crate::error::Result;
use crate::image::Image;
use glam::{Vec2, Vec3};

/// A planar patch of the scene with a frame of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// (mesh, triangle) of every triangle of the patch.
    pub triangles: Vec<(usize, usize)>,
    /// Corner of the bounding rectangle where u = v = 0.
    pub origin: Vec3,
    /// Unit directions of u and v; `u × v` points out of the lit side... away from the room.
    pub u_axis: Vec3,
    pub v_axis: Vec3,
    /// Unit normal into the room: the side that will emit.
    pub normal: Vec3,
    /// Extent along u and v in metres.
    pub size: Vec2,
    /// Area of the triangles in m².
    pub area: f32,
}

/// Finds the planar patch of the object or material of that name which faces the room.
pub fn find(_scene: &Scene, _name: &str) -> Result<Surface> {
    todo!()
}

/// Where the emission went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Index of the mesh that now holds the patch.
    pub mesh: usize,
    /// Index of its material; its `emission` scales the texture.
    pub material: usize,
}

/// Lays an emissive texture over the bounding rectangle of a surface: the patch becomes a mesh of its own with a second
/// set of texture coordinates and a copy of its material that emits `strength × texture` (cd/m²).
pub fn place(_scene: &mut Scene, _surface: &Surface, _texture: Image, _strength: Vec3) -> Result<Placed> {
    todo!()
}
