//! The solution of relighting: the scale of the emission.

use super::sided::Constraint;
use glam::DVec3;

/// Whether the target is met in one colour channel, and if not, why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TargetStatus {
    /// The target is met.
    Met,
    /// The target is exceeded: other lights alone exceed it, so the emission is off in this channel, or several goals
    /// contradict each other.
    TooBright,
    /// The lamps are too dim even at their upper bounds, or the goals contradict each other.
    TooDim,
    /// No measurable light of this channel reaches the target, so the channel cannot be solved. It gets the mean
    /// scale of the solved channels.
    Dark,
}

/// The scale of the emission with its confidence interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Multiplier of the emission per channel, ≥ 0.
    pub scale: DVec3,
    /// Half-widths of the 95 % confidence intervals of `scale`.
    pub half_width: DVec3,
    pub status: [TargetStatus; 3],
    /// Whether the target of each channel was exact or a limit.
    pub constraint: [Constraint; 3],
    /// Mean radiance of the target under the unscaled emission, in cd/m².
    pub response: DVec3,
    /// Mean radiance of the target under all other light, in cd/m².
    pub background: DVec3,
    /// Colour error of the target: with a probability of 95 %, the CIEDE2000 difference from the true colour is below
    /// this value. The exposure for this comparison shows the target as a middle grey.
    pub delta_e: f64,
    /// Number of paths traced.
    pub paths: u32,
}

impl Solution {
    /// The largest relative half-width among the channels that met their target; 0 without such channels.
    pub fn error(&self) -> f64 {
        (0..3)
            .filter(|&c| self.status[c] == TargetStatus::Met && self.scale[c] > 0.0)
            .map(|c| self.half_width[c] / self.scale[c])
            .fold(0.0, f64::max)
    }
}
