//! Estimates the camera from the lamps of a photo, if lines do not determine the camera.
//!
//! In fronto-parallel view, lamps of one kind have the same size and form (Chum and Matas, "Planar Affine Rectification
//! from Change of Scale", ACCV 2010), and often lie on a lattice. The search therefore looks for the tilt of their
//! plane for which the lamps agree best in size and form and, if most of them lie on a lattice seen in perspective, fit
//! it best. It assumes that most lamps are as long as they are wide, that oblong lamps of one kind are equally long and
//! parallel, and that lattices are symmetric. A lattice is certain enough to overrule lines: rays of glare and
//! furniture make lines too.
//! ```text
//! mask of lamps ─┬▶ likeness ┐
//!                └▶ lattice ─┴▶ evidence ─▶ tilt of their plane, focal length ─▶ retilt: rotation ─▶ View
//!                                                                        segments ─────────┘
//! ```

mod evidence;
mod lattice;
mod likeness;
mod retilt;
mod search;
#[cfg(test)]
mod tests;
mod tilt;

use super::warnings::MAX_DIRECTION_ERROR;
use super::{View, camera, plane};
use crate::error::Result;
use crate::geometry::FocalSource;
use crate::image::Image;
use crate::job::Job;
use evidence::Evidence;
use lattice::Symmetry;
pub use likeness::BLOOM_UNIT;
use search::TiltEstimate;
use tilt::Tilt;

/// Minimum number of shapes for an estimate: two shapes of one kind give six measurements, for each shape the size and
/// the two components of the stretch. The five unknowns are the normal (two), the focal length, the common size and
/// the bloom. [convention]
const MIN_SHAPES: usize = 2;
/// Minimum number of shapes that may overrule certain lines: nine measurements, more than there are unknowns.
/// [convention]
const MIN_SHAPES_OVER_LINES: usize = 3;
/// A tilt is accepted only if it decreases the cost of the lamps by at least this, compared with the tilt that the
/// lines imply. The cost is on the scale of a chi-square. [bench photos:tune]
const MIN_GAIN: f64 = 15.0;
/// Maximum cost of an accepted tilt: as a share of the cost of the tilt that the lines imply (`MAX_SHARE`), and per
/// shape if there is no lattice (`MAX_COST`; `MAX_CERTAIN_COST` if the lines are certain). These limits reject shapes
/// of several kinds, whose cost is high at every tilt. [bench photos:tune]
const MAX_SHARE: f64 = 0.3;
const MAX_COST: f64 = 1.5;
const MAX_CERTAIN_COST: f64 = 0.5;

impl View {
    /// Corrects the view such that the lamps marked by `lamps`, on the plane marked by `plane`, have equal size and
    /// form and lie on a lattice, if they can, in fronto-parallel view. `None` if the caller gave the focal length, if
    /// there are too few lamps for what the lines tell, if the lamps already agree with the view, or if they contradict
    /// each other.
    pub fn corrected_by_lamps(&self, plane: &Image, lamps: &Image, job: Job) -> Result<Option<View>> {
        let Some((by_lines, error)) = self.tilt_by_lines(plane) else { return Ok(None) };
        let is_certain = error <= MAX_DIRECTION_ERROR;
        let lamps = Evidence::of_mask(lamps, &self.perspective, is_certain)?;
        let min_shapes = if is_certain { MIN_SHAPES_OVER_LINES } else { MIN_SHAPES };
        if lamps.shapes.len() < min_shapes && lamps.lattice.is_none() {
            return Ok(None);
        }
        let found = search::find(&lamps, (by_lines, error), self.expected_focal, job)?;
        let better = found.filter(|found: &TiltEstimate| is_better(&lamps, &found.tilt, (&by_lines, is_certain)));
        Ok(better.map(|found| self.retilted(&found, &lamps, [plane.width, plane.height])))
    }

    /// Returns the tilt of the plane according to the lines, and the standard deviation of the plane's normal in
    /// radians. `None` if the caller gave the focal length, or if there is no plane.
    fn tilt_by_lines(&self, mask: &Image) -> Option<(Tilt, f64)> {
        let camera = &self.perspective;
        if camera.focal_source == FocalSource::Given {
            return None;
        }
        let pixels = plane::marked_pixels(mask).ok()?;
        let normal = plane::choose(self, mask, &pixels, None).ok()?.normal;
        let along = |axis: &usize| camera.axes.col(*axis).dot(normal).abs();
        let axis = (0..3).max_by(|a, b| along(a).total_cmp(&along(b)));
        let error = axis.map_or(camera::FREE_ERROR, |axis| self.vanishing_points[axis].error);
        Some((Tilt { normal, focal: camera.focal }, error))
    }
}

/// Whether the lamps agree if their plane has the tilt `tilt`, and agree clearly less if it has the tilt `than` that
/// the lines imply. If the lamps lie on a lattice, only the lattice counts. To overrule lines that are certain, it must
/// have a right angle or be hexagonal: with a free focal length, most lattices can have one of the rarer symmetries.
fn is_better(lamps: &Evidence, tilt: &Tilt, (than, is_certain): (&Tilt, bool)) -> bool {
    let Some(lattice) = &lamps.lattice else {
        let [cost, before] = [tilt, than].map(|tilt| lamps.cost(tilt));
        let max_cost = if is_certain { MAX_CERTAIN_COST } else { MAX_COST };
        return is_gain(cost, before) && cost < max_cost * lamps.shapes.len() as f64;
    };
    let may_overrule = match lattice.symmetry(tilt) {
        Some(Symmetry::RightAngle | Symmetry::Hexagonal) => true,
        Some(Symmetry::Other) => !is_certain,
        None => false,
    };
    may_overrule && lattice.is_exact(tilt) && is_gain(lattice.cost(tilt), lattice.cost(than))
}

fn is_gain(cost: f64, before: f64) -> bool {
    before - cost > MIN_GAIN && cost < MAX_SHARE * before
}
