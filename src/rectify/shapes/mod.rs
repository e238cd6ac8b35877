//! The camera from lamps that are alike, where the lines of a photo do not determine it. Seen straight on, shapes of one
//! kind have one size and one form (Chum and Matas, "Planar Affine Rectification from Change of Scale", ACCV 2010). Most
//! lamps are as long as they are wide. Oblong lamps of one kind are equally long, and parallel.
//!
//! ```text
//! mask of lamps ─▶ likeness ─▶ tilt of their plane, focal length ─▶ retilt: rotation about the normal ─▶ View
//!                                                    segments ─────────┘
//! ```

mod likeness;
mod retilt;
#[cfg(test)]
mod tests;
mod tilt;

use super::warnings::MAX_DIRECTION_ERROR;
use super::{View, camera, plane};
use crate::error::Result;
use crate::geometry::FocalSource;
use crate::image::Image;
use crate::job::Job;
use likeness::Shape;
use tilt::{Found, Tilt};

/// Minimum number of shapes: two of one kind have six figures for the five unknowns [convention].
const MIN_SHAPES: usize = 2;
/// Minimum gain of cost, as of a chi-square, over the view by lines [bench photos:tune].
const MIN_GAIN: f64 = 15.0;
/// Maximum cost as a share of that by lines, and per shape: shapes of several kinds agree with no tilt
/// [bench photos:tune].
const MAX_SHARE: f64 = 0.3;
const MAX_COST: f64 = 1.5;

impl View {
    /// The view in which the lamps of the second mask, on the plane of the first, are alike; `None` where the lines
    /// determine the view, and where the lamps agree with it or contradict each other.
    pub fn with_lamps_alike(&self, plane: &Image, lamps: &Image, job: Job) -> Result<Option<View>> {
        let Some((by_lines, error)) = self.uncertain_tilt(plane) else { return Ok(None) };
        let shapes = likeness::of_mask(lamps, self.perspective.principal)?;
        if shapes.len() < MIN_SHAPES {
            return Ok(None);
        }
        let found = tilt::find(&shapes, (by_lines, error), self.expected_focal, job)?;
        let better = found.filter(|found| is_better(&shapes, &found.tilt, &by_lines));
        Ok(better.map(|found: Found| self.retilted(&found, &shapes, [plane.width, plane.height])))
    }

    /// The tilt of a plane by the lines, and the standard deviation of its normal in radians; `None` where the lines or
    /// the caller determine it.
    fn uncertain_tilt(&self, mask: &Image) -> Option<(Tilt, f64)> {
        let camera = &self.perspective;
        if camera.focal_source == FocalSource::Given {
            return None;
        }
        let pixels = plane::marked_pixels(mask).ok()?;
        let normal = plane::choose(self, mask, &pixels, None).ok()?.normal;
        let along = |axis: &usize| camera.axes.col(*axis).dot(normal).abs();
        let axis = (0..3).max_by(|a, b| along(a).total_cmp(&along(b)));
        let error = axis.map_or(camera::FREE_ERROR, |axis| self.vanishing_points[axis].error);
        (error > MAX_DIRECTION_ERROR).then_some((Tilt { normal, focal: camera.focal }, error))
    }
}

/// Whether the shapes are alike by one tilt, and are not by the other.
fn is_better(shapes: &[Shape], tilt: &Tilt, than: &Tilt) -> bool {
    let [cost, before] = [tilt, than].map(|tilt| likeness::cost(shapes, tilt.normal, tilt.focal));
    before - cost > MIN_GAIN && cost < MAX_SHARE * before && cost < MAX_COST * shapes.len() as f64
}
