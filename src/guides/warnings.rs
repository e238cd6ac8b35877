//! Warnings about the motion between two frames.

use super::motion::Motion;
use crate::warning::{Code, Warning, percent};
use glam::DVec2;

/// Maximum number of objects that a warning names; further objects are only counted.
const MAX_LISTED: usize = 3;

impl Motion {
    pub fn warnings(&self) -> Vec<Warning> {
        self.without_counterpart().into_iter().collect()
    }

    /// Warns if visible objects have no counterpart in the previous frame.
    fn without_counterpart(&self) -> Option<Warning> {
        let largest = self.unmatched.iter().max_by_key(|object| object.pixels)?;
        let pixels: usize = self.unmatched.iter().map(|object| object.pixels).sum();
        let share = pixels as f64 / (self.image.width * self.image.height) as f64;
        let names: Vec<String> = self.unmatched.iter().take(MAX_LISTED).map(|o| format!("{:?}", o.name)).collect();
        let more = self.unmatched.len() - names.len();
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let message = format!(
            "the previous frame has no object of this name and with these triangles: {}{more}; their motion is \
             unknown on {} of the picture",
            names.join(", "),
            percent(share)
        );
        let advice = "give each object one name, and its vertices and triangles one order, in all frames; if the \
                      object is new, no action is needed";
        let [x, y] = largest.place.map(|v| v as f64 + 0.5);
        Some(Warning::new(Code::NoCounterpart, share, 0.0, message, advice).at(Some(DVec2::new(x, y))))
    }
}
