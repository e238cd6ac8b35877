//! Relighting: colour and intensity of the emission, solved against the photo through light transport (Lipp et al., §7).

use crate::error::Result;
use crate::job::Job;
use crate::render::World;
use glam::{DVec3, Vec3};

/// What should match the photo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Colour of the light the target surface sends back (its albedo included): what a photo shows of it.
    Outgoing,
    /// Colour of the light that arrives at it.
    Incident,
}

#[derive(Clone)]
pub struct Input<'a> {
    /// The scene with the emission in place, at the strength the solution will multiply.
    pub world: &'a World,
    /// Material index of the emission to solve for.
    pub emitter: usize,
    /// Triangles (mesh, triangle) whose mean colour is to match: those of the target surface.
    pub target_triangles: &'a [(usize, usize)],
    /// Luminance per channel the target should have, in cd/m² (outgoing) or lux/π (incident).
    pub target: Vec3,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub quantity: Quantity,
    /// Paths in all; split into independent batches for the interval. In `[1024, 1 << 30]`.
    pub paths: u32,
    /// Stop when the half-width of the 95 % interval is below this share of the answer; 0 = never.
    pub target_error: f32,
    /// Stop after this many milliseconds; 0 = never.
    pub time_budget_ms: u32,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self { quantity: Quantity::Outgoing, paths: 1 << 18, target_error: 0.01, time_budget_ms: 0, seed: 1 }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// What to multiply the emission with, per channel.
    pub scale: DVec3,
    /// Half-widths of the 95 % confidence intervals of `scale`.
    pub half_width: DVec3,
    /// Mean response of the target to the emission at scale 1, and to all other light.
    pub response: DVec3,
    pub background: DVec3,
    /// Paths traced.
    pub paths: u32,
}

pub fn run(_input: &Input, _params: &Params, _job: Job) -> Result<Solution> {
    todo!()
}
