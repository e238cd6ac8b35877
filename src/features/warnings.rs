//! Warnings about features whose depth may be wrong.

use super::{DepthSource, Features};
use crate::warning::{Code, Warning, percent};

/// A box room with a confidence (`Layout::trust`) below this raises a warning. [judged on 38 photos]
const MIN_LAYOUT_TRUST: f64 = 0.2;

impl Features {
    /// Returns warnings about the depth. A depth map, or the depth of a caller's network, gives no warning. The neutral
    /// prior always gives one.
    pub fn warnings(&self) -> Vec<Warning> {
        let advice =
            "give a depth map or a network that estimates one, or paint a stroke on each wall and on the floor";
        let warning = match self.depth_source {
            DepthSource::Caller | DepthSource::Network => None,
            DepthSource::Layout => {
                let trust = self.layout.map_or(0.0, |layout| layout.trust);
                let message =
                    || format!("the room was laid out from its lines with a trust of {} only", percent(trust));
                Warning::below(Code::LayoutUncertain, trust, MIN_LAYOUT_TRUST, message, advice)
            }
            DepthSource::Neutral => {
                let message = "nothing is known of the depth of the photo, neither a map nor its lines".to_string();
                Some(Warning::new(Code::LayoutUncertain, 0.0, MIN_LAYOUT_TRUST, message, advice))
            }
        };
        warning.into_iter().collect()
    }
}

#[cfg(test)]
#[path = "tests/warnings.rs"]
mod tests;
