//! The parameters of relighting, and the geometry of a target.

use super::sided::Constraint;
use crate::error::{Result, check_range};
use glam::Vec3;

/// The kind of radiance that is measured at the target and compared with the photo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Outgoing diffuse light of the target, its albedo included, as a photo shows it.
    Outgoing,
    /// Incident light, expressed as the radiance of a white target.
    Incident,
}

/// How the light at the many points of a target is fitted to the single target colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// The mean over the points equals the target colour, as in the paper.
    Mean,
    /// The sum over the points of the squared difference from the target colour is minimal, as when gradient descent on
    /// texels has converged (Lipp et al. 2024). Bright points count more: without other light, the solution is dimmer
    /// than with [`Fit::Mean`] by the factor `1 / (1 + CV²)`, where CV is the coefficient of variation of the response
    /// over the target.
    LeastSquares,
}

/// The geometry of a target: where its light is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TargetGeometry<'a> {
    /// A surface, given by its triangles as (mesh, triangle). Light is measured on the side from which the triangles
    /// wind counter-clockwise. Lamps on the surface are excluded.
    Surface(&'a [(usize, usize)]),
    /// A calculation grid in the air: a parallelogram given by a corner and two edges. Light is measured on the side
    /// of `normal`, as the radiance that a white surface there would have: illuminance / π.
    Grid { origin: Vec3, across: Vec3, down: Vec3, normal: Vec3 },
}

/// One of several emitters, with the target that decides its scale together with the targets of the others.
#[derive(Clone, Copy, Debug)]
pub struct EmitterTarget<'a> {
    /// Index of the emitting material to solve for; it differs between the planes.
    pub emitter: usize,
    /// The triangles of the target surface, as for [`super::Input`].
    pub target_triangles: &'a [(usize, usize)],
    /// Mean radiance of the target to achieve, as for [`super::Input`].
    pub target: Vec3,
    /// Whether the target of each channel is exact or a limit.
    pub constraint: [Constraint; 3],
}

/// The parameters of relighting.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub quantity: Quantity,
    /// How the light at the points of the target is fitted. Only [`super::run`] uses `fit` and `constraint`.
    pub fit: Fit,
    /// Whether the target of each channel is exact or a limit; clipped pixels of a photo give lower limits. A channel
    /// with a limit gets the mean scale of the exact channels if this scale satisfies the limit. Otherwise, or if no
    /// exact channel meets its target, it gets the scale that just reaches the limit.
    pub constraint: [Constraint; 3],
    /// Maximum number of paths, in `[1024, 1 << 30]`.
    pub paths: u32,
    /// Stop when the largest relative half-width of the result's 95 % confidence intervals is at most this value, in
    /// `[0, 1]`; with 0, do not stop for this reason.
    pub target_error: f32,
    /// Stop after this many milliseconds; with 0, do not stop for this reason.
    pub time_budget_ms: u32,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            quantity: Quantity::Outgoing,
            fit: Fit::Mean,
            constraint: [Constraint::Exactly; 3],
            paths: 1 << 20,
            target_error: 0.01,
            time_budget_ms: 0,
            seed: 1,
        }
    }
}

impl Params {
    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("paths", self.paths, 1024, 1 << 30)?;
        check_range("target_error", self.target_error, 0.0, 1.0)?;
        Ok(())
    }
}
