//! Measures the statistics of an exemplar's pattern.

use super::statistics::{Pattern, Statistics};
use crate::emission::exemplar::Exemplar;
use crate::image::Image;
use glam::DVec2;

impl Exemplar {
    /// The statistics of the pattern, with lengths in unwarped pixels. Points of the unwarped image for which
    /// `is_left_out` is true are left out. `periods` has the meaning of [`Pattern::periods`].
    pub fn statistics(
        &self,
        unwarped: &Image,
        periods: [Option<f64>; 2],
        is_left_out: impl Fn(DVec2) -> bool,
    ) -> Statistics {
        // Every component that is copied as one piece counts as a lamp.
        let Self { width, height, components, .. } = self;
        let pieces: Vec<bool> = self.roles.iter().map(|role| role.is_piece()).collect();
        // The pattern of a luminous ceiling continues without the dark border around its panes, so measure only inside
        // the bounding box of the panes.
        let [low, high] = if self.is_luminous_ceiling() { self.box_of_lights() } else { [[0, 0], [*width, *height]] };
        let is_inside = |x: usize, y: usize| x >= low[0] && y >= low[1] && x <= high[0] && y <= high[1];
        let colour = |i: usize| {
            let (x, y) = (i % width, i / width);
            let centre = DVec2::new(x as f64, y as f64) + 0.5;
            (self.shown[i] && is_inside(x, y) && !is_left_out(centre)).then(|| unwarped.rgb(x, y))
        };
        Statistics::of(&Pattern { width: *width, height: *height, components, whole: &pieces, periods, colour })
    }
}
