//! Contributions of light paths: which light a contribution comes from, how bright it is, and the trait that receives
//! contributions.

use glam::{Vec2, Vec3};

/// The light from which a path contribution comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSource {
    /// An emissive triangle; `uv` are the texture coordinates at which its emission texture was looked up.
    Surface {
        mesh: u32,
        triangle: u32,
        uv: Vec2,
    },
    /// A punctual light, by its index in the scene.
    Punctual(u32),
    Environment,
}

/// Receives the contributions of a path. The sum of `importance * emission` over all contributions estimates the
/// radiance, or the irradiance if the path starts at a receiver.
pub trait PathSink {
    /// Adds a contribution. `importance` is the product of all factors except the emission: throughput × mis_weight /
    /// pdf.
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3);
}

/// Returns the mean of the channels. Light sampling uses this value as brightness, since it is positive wherever any
/// channel is positive.
pub fn mean_channel(v: Vec3) -> f32 {
    v.element_sum() / 3.0
}
