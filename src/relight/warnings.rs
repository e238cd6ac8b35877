//! Warnings about a solved colour and intensity that may be wrong.

use super::{Constraint, Solution, TargetStatus};
use crate::warning::{Code, Warning};

const CHANNELS: [&str; 3] = ["red", "green", "blue"];

impl Solution {
    /// Returns at most two warnings: that the target is not reached, and that the target's photo is clipped.
    pub fn warnings(&self) -> Vec<Warning> {
        [self.unreachable(), self.clipped()].into_iter().flatten().collect()
    }

    fn unreachable(&self) -> Option<Warning> {
        let missed: Vec<usize> = (0..3).filter(|&c| self.status[c] != TargetStatus::Met).collect();
        let message = || {
            let reasons: Vec<String> =
                missed.iter().map(|&c| format!("{}, {}", CHANNELS[c], explain(self.status[c]))).collect();
            format!("channels do not meet the target: {}", reasons.join("; "))
        };
        let advice = "dim the other lights of the scene, make its surfaces less dark or less saturated, or raise \
                      white_luminance";
        Warning::above(Code::Unreachable, missed.len() as f64, 0.0, message, advice)
    }

    fn clipped(&self) -> Option<Warning> {
        let bounds: Vec<&str> =
            (0..3).filter(|&c| self.constraint[c] == Constraint::AtLeast).map(|c| CHANNELS[c]).collect();
        let message =
            || format!("the photo clips {} where the target is read, so it is at least as bright", bounds.join(", "));
        let advice = "use a photo that is exposed for the lit plane, or an HDR one";
        Warning::above(Code::TargetClipped, bounds.len() as f64, 0.0, message, advice)
    }
}

fn explain(status: TargetStatus) -> &'static str {
    match status {
        TargetStatus::Met => "met",
        TargetStatus::TooBright => "which other lights alone make too bright",
        TargetStatus::TooDim => {
            "which is too dim because the lamps are at their limits or the targets of several planes contradict each other"
        }
        TargetStatus::Dark => "of which no light reaches the target",
    }
}

#[cfg(test)]
#[path = "tests/warnings.rs"]
mod tests;
