//! Rays and hits.

use glam::Vec3;

/// A half-line; distances are in units of `direction`, which need not have unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    pub origin: Vec3,
    pub direction: Vec3,
    /// Hits lie at distances in `(0, t_max)`.
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
    /// Index into the list of triangles the structure was built from.
    pub triangle: u32,
    /// Barycentric coordinates of corners 1 and 2.
    pub u: f32,
    pub v: f32,
}
