//! The luminous intensity of a measured luminaire by directions of the scene.

use crate::maths;
use crate::photometry::Luminaire;
use crate::scene::c90;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// A measured luminous intensity distribution with the axes of the luminaire.
pub struct Measured {
    /// Unit directions in the scene: of C = 0°, of C = 90° and of the luminaire's axis (γ = 0°).
    frame: [Vec3; 3],
    luminaire: Arc<Luminaire>,
}

impl Measured {
    pub fn new(axis: Vec3, c0: Vec3, luminaire: Arc<Luminaire>) -> Self {
        Self { frame: [c0, c90(axis, c0), axis], luminaire }
    }

    /// Converts a direction of the scene to the coordinates of the luminaire: along C = 0, C = 90 and the axis.
    pub fn local(&self, direction: Vec3) -> DVec3 {
        DVec3::from_array(self.frame.map(|axis| f64::from(direction.dot(axis))))
    }

    /// Returns the intensity in candela in a direction of any length, in the coordinates of the luminaire.
    pub fn candela(&self, local: DVec3) -> f64 {
        let gamma = maths::atan2(maths::hypot(local.x, local.y), local.z);
        self.luminaire.intensity(maths::atan2(local.y, local.x).to_degrees(), gamma.to_degrees())
    }
}
