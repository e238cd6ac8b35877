//! Estimates the camera from the lamps of a photo, if lines do not determine the camera.
//!
//! In fronto-parallel view, lamps of one kind have the same size and form (Chum and Matas, "Planar Affine
//! Rectification from Change of Scale", ACCV 2010). The search therefore looks for the tilt of their plane for which
//! the lamps agree best in size and form. It assumes that most lamps are as long as they are wide, and that oblong
//! lamps of one kind are equally long and parallel.
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
pub use likeness::BLOOM_UNIT;
use likeness::Shape;
use tilt::{Tilt, TiltEstimate};

/// Minimum number of shapes for an estimate: two shapes of one kind give six measurements, for each shape the size and
/// the two components of the stretch. The five unknowns are the normal (two), the focal length, the common size and
/// the bloom. [convention]
const MIN_SHAPES: usize = 2;
/// A tilt is accepted only if it decreases the cost of the shapes by at least this, compared with the tilt that the
/// lines imply. The cost is on the scale of a chi-square. [bench photos:tune]
const MIN_GAIN: f64 = 15.0;
/// Maximum cost of an accepted tilt: as a share of the cost of the tilt that the lines imply (`MAX_SHARE`), and per
/// shape (`MAX_COST`). These limits reject shapes of several kinds, whose cost is high at every tilt.
/// [bench photos:tune]
const MAX_SHARE: f64 = 0.3;
const MAX_COST: f64 = 1.5;

impl View {
    /// Corrects the view such that the lamps marked by `lamps`, on the plane marked by `plane`, have equal size and
    /// form in fronto-parallel view. `None` if the lines determine the plane's normal well, if the caller gave the
    /// focal length, if there are too few lamps, if the lamps already agree with the view, or if they contradict each
    /// other.
    pub fn with_lamps_alike(&self, plane: &Image, lamps: &Image, job: Job) -> Result<Option<View>> {
        let Some((by_lines, error)) = self.uncertain_tilt(plane) else { return Ok(None) };
        let shapes = likeness::of_mask(lamps, &self.perspective)?;
        if shapes.len() < MIN_SHAPES {
            return Ok(None);
        }
        let found = tilt::find(&shapes, (by_lines, error), self.expected_focal, job)?;
        let better = found.filter(|found| is_better(&shapes, &found.tilt, &by_lines));
        Ok(better.map(|found: TiltEstimate| self.retilted(&found, &shapes, [plane.width, plane.height])))
    }

    /// Returns the tilt of the plane according to the lines, and the standard deviation of the plane's normal in
    /// radians. `None` if the lines determine the normal well, or if the caller gave the focal length.
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

/// Whether the shapes agree in size and form if the plane has the tilt `tilt`, and agree clearly less if it has the
/// tilt `than`.
fn is_better(shapes: &[Shape], tilt: &Tilt, than: &Tilt) -> bool {
    let [cost, before] = [tilt, than].map(|tilt| likeness::cost(shapes, tilt.normal, tilt.focal));
    before - cost > MIN_GAIN && cost < MAX_SHARE * before && cost < MAX_COST * shapes.len() as f64
}
