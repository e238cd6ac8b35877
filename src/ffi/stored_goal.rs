//! A goal for the powers of lamps, as the host has set it.

use crate::error::Result;
use crate::image::try_collect;
use crate::relight::{Aspect, Constraint, Goal, Quantity, TargetGeometry};
use crate::scene::Scene;
use glam::Vec3;

/// A surface or a grid, and the light that it should have.
#[derive(Clone)]
pub(super) struct StoredGoal {
    pub geometry: StoredGeometry,
    pub quantity: Quantity,
    /// Mean radiance in cd/m² per channel; for illuminance, the value in lux divided by π.
    pub target: Vec3,
    pub aspect: Aspect,
    pub constraint: [Constraint; 3],
    pub weight: f64,
}

#[derive(Clone)]
pub(super) enum StoredGeometry {
    Mesh(u32),
    Grid { origin: Vec3, across: Vec3, down: Vec3, normal: Vec3 },
}

impl StoredGoal {
    /// Returns the indices (mesh, triangle) of each triangle of the goal's surface; empty for a grid.
    pub(super) fn triangles(&self, scene: &Scene) -> Result<Vec<(usize, usize)>> {
        match self.geometry {
            StoredGeometry::Mesh(mesh) => {
                let count = scene.meshes.get(mesh as usize).map_or(0, |m| m.triangles.len());
                try_collect((0..count).map(|t| (mesh as usize, t)))
            }
            StoredGeometry::Grid { .. } => Ok(Vec::new()),
        }
    }

    /// Returns the goal in the form that the solver takes; `triangles` come from [`Self::triangles`].
    pub(super) fn goal<'a>(&self, triangles: &'a [(usize, usize)]) -> Goal<'a> {
        let geometry = match self.geometry {
            StoredGeometry::Mesh(_) => TargetGeometry::Surface(triangles),
            StoredGeometry::Grid { origin, across, down, normal } => {
                TargetGeometry::Grid { origin, across, down, normal }
            }
        };
        let Self { quantity, target, aspect, constraint, weight, .. } = *self;
        Goal { geometry, quantity, target, aspect, constraint, weight }
    }
}
