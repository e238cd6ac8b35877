//! Path contributions: the light they come from, and the sink that receives them.

use glam::{Vec2, Vec3};

/// The light that a path contribution comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSource {
    /// An emissive triangle; `uv` are the coordinates of the look-up in its emission texture.
    Surface {
        mesh: u32,
        triangle: u32,
        uv: Vec2,
    },
    /// Index of a punctual light of the scene.
    Punctual(u32),
    Environment,
}

/// Receives the contributions of a path; the sum of their products `importance * emission` is the estimate.
pub trait PathSink {
    /// `importance` is every factor but the emission: throughput × mis_weight / pdf.
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3);
}
