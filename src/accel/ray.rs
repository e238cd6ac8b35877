//! Rays and hits of the acceleration structure.

use glam::Vec3;

/// A ray. Distances along it are in units of the length of `direction`, which need not be 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    pub origin: Vec3,
    pub direction: Vec3,
    /// Upper bound of the distance: hits lie in `(0, t_max)`.
    pub t_max: f32,
}

impl Ray {
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_max: f32::INFINITY }
    }

    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub t: f32,
    /// Index into the list of triangles from which the structure was built.
    pub triangle: u32,
    /// Barycentric coordinates of the hit: the weights of corners 1 and 2.
    pub u: f32,
    pub v: f32,
}
