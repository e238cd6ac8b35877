//! Measures the lamps of an exemplar, so that a caller can choose the scale of the pattern by their size or spacing.

use super::agreement::statistics;
use super::analysis::Analysis;
use super::compose::layer::outlines;
use super::exemplar::components::Component;
use super::lamps::designs::Designs;
use super::lattice::law::Law;
use super::params::{Input, Params};
use crate::error::Result;
use crate::geometry::robust::weighted_median;
use crate::job::Job;
use glam::DVec2;

/// Measurements of an exemplar, in unwarped pixels.
pub struct Measurements {
    /// Medians of the longer side and of the shorter side over the whole lamps, weighted by their photo pixels. Whole
    /// lamps are lamps that the exemplar shows completely, and lamps that count as whole. 0 without a whole lamp.
    pub lamp_sides: [f64; 2],
    /// Median, over the whole lamps and weighted likewise, of the share of its bounding box that a lamp covers: 1 for
    /// rectangles along the axes, π/4 for discs. 0 without a whole lamp.
    pub lamp_fill: f64,
    /// The shorter period of the lamps' lattice. Without a lattice, the median distance from a whole lamp to the
    /// nearest other whole lamp, or 0 if there are fewer than two whole lamps.
    pub spacing: f64,
    /// Number of columns of the unwarped image that contain at least one usable pixel. A usable pixel is on the plane,
    /// and not magnified beyond [`Params::max_magnification`].
    pub width: f64,
    pub(super) analysis: Analysis,
}

/// Measures an exemplar. Errors: as for [`super::run`].
pub fn measure(input: &Input, params: &Params, job: Job) -> Result<Measurements> {
    params.check()?;
    input.check()?;
    let analysis = Analysis::new(input, params, job)?;
    let exemplar = &analysis.exemplar;
    let spacing = match analysis.law {
        Law::Lattice([a, b]) => a.length().min(b.length()),
        _ => {
            let centres: Vec<DVec2> = exemplar.lamps().map(|lamp| lamp.centre).collect();
            let mut nearest = statistics::nearest_distances(&centres);
            nearest.sort_by(f64::total_cmp);
            nearest.get(nearest.len() / 2).copied().filter(|d| d.is_finite()).unwrap_or(0.0)
        }
    };
    // A design is the size and the outline that all lamps of a kind get. If a lamp will be drawn from a design, take
    // its size from the design.
    let designs = match params.whole_lamps && params.clean_lamps && input.photo.is_some() {
        true => Designs::find(exemplar, &outlines(exemplar, input, job)?),
        false => Designs::default(),
    };
    let whole = exemplar.components.list.iter().enumerate().filter(|(k, _)| exemplar.roles[*k].is_whole());
    let size = |k: usize, lamp: &Component| match designs.of(k) {
        Some((design, _)) => (2.0 * design.half_box(), design.area()),
        None => (DVec2::new(lamp.size()[0] as f64, lamp.size()[1] as f64), lamp.area as f64),
    };
    let sizes: Vec<((DVec2, f64), f64)> = whole.map(|(k, lamp)| (size(k, lamp), exemplar.photo_area[k])).collect();
    let median = |of: fn(DVec2, f64) -> f64| {
        let values = sizes.iter().map(|&((size, area), weight)| (of(size, area), weight));
        weighted_median(values.collect()).unwrap_or(0.0)
    };
    let lamp_sides = [median(|size, _| size.max_element()), median(|size, _| size.min_element())];
    let lamp_fill = median(|size, area| area / size.element_product());
    let columns = (0..exemplar.width).filter(|&x| (0..exemplar.height).any(|y| exemplar.shown[y * exemplar.width + x]));
    Ok(Measurements { lamp_sides, lamp_fill, spacing, width: columns.count() as f64, analysis })
}
