//! Finds the lattice that the lamps lie on, from the autocorrelation of their mask.
//!
//! If a shift maps the mask nearly exactly onto itself, the lamps repeat with that shift. The two shortest such shifts
//! that are not parallel are the periods of the lattice, which may be rectangular, hexagonal or skewed. A missing lamp
//! does not hide a period: if a tenth of the lamps is missing, the correlation falls by about a tenth. The synthesis
//! then shifts patches by lattice vectors only.
//!
//! - If there is only one such shift, the lamps form a row. The second period leads across the row; its length follows
//!   from the extent of the exemplar.
//! - If no shift maps the mask onto itself, and there are only a few lamps or one isolated group of lamps, the exemplar
//!   repeats as a whole. The periods then follow from its width and its height.
//! - If no shift maps the mask onto itself, but there are many lamps, patches are placed without a lattice.

pub mod basis;
pub mod border_sites;
pub mod cells;
pub mod centring;
pub mod copies;
pub mod correlation;
pub mod extent;
pub mod kind_check;
pub mod law;
pub mod neighbours;
pub mod repeats;
pub mod sliding;
pub mod steps;

use super::exemplar::Exemplar;
use crate::error::Result;
use crate::image::{Image, pyramid};
use crate::job::Job;
use correlation::Autocorrelation;
use glam::DVec2;
use law::Law;

/// The correlation at each shift has a lower bound ([`Repeat::lower_bound`](repeats::Repeat::lower_bound)). A shift may
/// be a period only if its correlation is at least this share of the highest lower bound of all shifts. A shift with a
/// lower correlation probably moves lamps onto lamps of another kind. [bench emission:patterns]
const MIN_RELATIVE_CORRELATION: f32 = 0.9;
/// The correlation at a shift counts only if at least this share of the valid pixels overlaps with valid pixels of the
/// shifted image. [bench emission:patterns]
const MIN_OVERLAP: f32 = 0.2;
/// Maximum side of the image that is correlated, in pixels. [bench emission:seconds]
const MAX_SIDE: usize = 160;
/// Two shifts count as parallel if the sine of the angle between them is below this: about 17°.
/// [bench emission:patterns]
const MAX_PARALLEL_SINE: f64 = 0.3;

/// Finds from the autocorrelation how the exemplar's lights continue: on a lattice, in a row, by repetition as a whole,
/// or without a lattice. Also returns the regularity: the lowest correlation at a period, or 0 if there is no period.
/// A shift may be a period only if its correlation is at least `min_regularity`. If `min_regularity` is 1, no period is
/// sought, and the law is `Free`.
pub fn find_law(exemplar: &Exemplar, correlated: &Correlated, min_regularity: f32) -> (Law, f64) {
    if min_regularity >= 1.0 {
        return (Law::Free, 0.0);
    }
    let periods = periods(exemplar, correlated, min_regularity);
    let goodness = periods.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
    let extent = extent::of(exemplar);
    match periods[..] {
        [(a, _), (b, _)] => (lattice(exemplar, [a, b]), goodness),
        [(a, _)] => (row(exemplar, a), goodness),
        _ => (without_period(exemplar, extent), 0.0),
    }
}

/// A lattice with about the given periods, refined by the centres of the lamps. If a vector of the lattice only slides
/// the lights along themselves ([`sliding`]), the lights are lines. The law is then the lattice of lines without ends
/// if the border cuts most of the light, and a row across the lines otherwise.
pub fn lattice(exemplar: &Exemplar, periods: [DVec2; 2]) -> Law {
    let basis = basis::refine(exemplar, periods, 2);
    match sliding::find(exemplar, basis) {
        None => Law::Lattice(basis),
        Some(lines) if exemplar.is_mostly_cut() => Law::Lattice(lines),
        Some([_, period]) => row(exemplar, period),
    }
}

/// A row with the given period. The second period leads across the row, along x or y. It is the extent of the exemplar,
/// or longer if lamps lie at opposite borders, so that these lamps do not touch where copies of the exemplar adjoin
/// ([`extent::of_rows`]). On a luminous ceiling, it is the extent of the panes plus the widest bar, without the dark
/// border around the panes ([`extent::of_panes`]).
pub fn row(exemplar: &Exemplar, period: DVec2) -> Law {
    let extent = match exemplar.is_luminous_ceiling() {
        true => extent::of_panes(exemplar),
        false => extent::of_rows(exemplar),
    };
    let across = if period.x.abs() > period.y.abs() { DVec2::Y * extent } else { DVec2::X * extent };
    let [period, _] = basis::refine(exemplar, [period, across], 1);
    Law::Row([basis::straight(period, law::MAX_SLANT), across])
}

/// The law of lights without a period. An exemplar with few lamps, or with one isolated group of lamps, repeats as a
/// whole; otherwise there is no lattice. `extent` is the size of the usable part of the exemplar in unwarped pixels.
pub fn without_period(exemplar: &Exemplar, extent: DVec2) -> Law {
    if !extent::has_few_lamps(exemplar, extent) {
        return Law::Free;
    }
    extent::as_period(exemplar)
}

/// The autocorrelation of the exemplar's lights, computed at a reduced size.
pub struct Correlated {
    correlation: Autocorrelation,
    width: usize,
    height: usize,
    /// Number of valid pixels of the reduced image.
    valid: usize,
    /// Unwarped pixels per pixel of the reduced image.
    to_unwarped: DVec2,
}

impl Correlated {
    /// Correlates the lights of a part of the exemplar: the working pixels for whose index `is_within` returns true.
    pub fn new(exemplar: &Exemplar, is_within: impl Fn(usize) -> bool, job: Job) -> Result<Self> {
        let working = &exemplar.working;
        let longest = working.width.max(working.height);
        let reduce = |n: usize| (n * MAX_SIDE.min(longest)).div_ceil(longest).max(1);
        let (width, height) = (reduce(working.width), reduce(working.height));
        let mut mask = Image::new(working.width, working.height, 2)?;
        for (i, pixel) in mask.data.chunks_exact_mut(2).enumerate().filter(|(i, _)| working.shown[*i] && is_within(*i))
        {
            pixel.copy_from_slice(&[f32::from(working.shown_coverage[i] >= 0.5), 1.0]);
        }
        let mask = pyramid::resize(&mask, width, height, job.part(0.0, 0.2))?;
        let valid: Vec<bool> = mask.data.chunks_exact(2).map(|p| p[1] > 0.5).collect();
        let values: Vec<f32> = mask.data.chunks_exact(2).map(|p| if p[1] > 0.5 { p[0] / p[1] } else { 0.0 }).collect();
        let correlation = Autocorrelation::new(&values, &valid, width, height, job.part(0.2, 1.0))?;
        let to_unwarped = DVec2::new(exemplar.width as f64 / width as f64, exemplar.height as f64 / height as f64);
        Ok(Self { correlation, width, height, valid: valid.iter().filter(|&&v| v).count(), to_unwarped })
    }

    /// Minimum number of pixels that must overlap at a shift.
    fn min_overlap(&self) -> f32 {
        MIN_OVERLAP * self.valid as f32
    }

    /// The lowest correlation at a period of a lattice or a row. `None` for other laws, and if too few pixels overlap.
    pub fn at_periods(&self, law: Law) -> Option<f32> {
        match law {
            Law::Lattice([a, b]) => Some(self.at(a)?.min(self.at(b)?)),
            Law::Row([period, _]) => self.at(period),
            Law::Copy | Law::Whole(_) | Law::Free => None,
        }
    }

    /// The correlation at a shift that is given in unwarped pixels: the highest correlation at the four neighbouring
    /// shifts by whole pixels of the reduced image. `None` if too few pixels overlap.
    fn at(&self, shift: DVec2) -> Option<f32> {
        let [x, y] = (shift / self.to_unwarped).floor().to_array().map(|v| v as isize);
        let next = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)].into_iter();
        next.filter_map(|(x, y)| self.correlation.at(x, y, self.min_overlap())).reduce(f32::max)
    }
}

/// At most two shifts, in unwarped pixels, that map the pattern of lights onto itself, with their correlations: the
/// shortest shift, and the shortest of the shifts that are not parallel to it.
fn periods(exemplar: &Exemplar, correlated: &Correlated, min_regularity: f32) -> Vec<(DVec2, f64)> {
    let mut periods: Vec<(DVec2, f64)> = Vec::new();
    for (shift, value) in shifts(exemplar, correlated, min_regularity, MIN_RELATIVE_CORRELATION, usize::MAX) {
        if periods.len() < 2 && !periods.iter().any(|p| is_parallel(p.0, shift)) {
            periods.push((shift, value));
        }
    }
    periods
}

/// Whether two shifts count as parallel ([`MAX_PARALLEL_SINE`]).
pub fn is_parallel(a: DVec2, b: DVec2) -> bool {
    a.normalize().perp_dot(b.normalize()).abs() < MAX_PARALLEL_SINE
}

/// The shifts, in unwarped pixels, that map the lights onto themselves, with their correlations. Shorter ones come
/// first; at most `max_count` are returned. Each shift meets these conditions:
///
/// - It moves lamps onto lamps of the same kind.
/// - Its correlation is at least `min_value`.
/// - Its correlation is at least `relative` times the highest [`Repeat::lower_bound`](repeats::Repeat::lower_bound) of
///   all shifts.
///
/// If the lights do not change along the x or y axis, a shift of one unwarped pixel along this axis precedes the other
/// shifts.
pub fn shifts(
    exemplar: &Exemplar,
    correlated: &Correlated,
    min_value: f32,
    relative: f32,
    max_count: usize,
) -> Vec<(DVec2, f64)> {
    let &Correlated { ref correlation, width, height, valid, to_unwarped } = correlated;
    let overlap = correlated.min_overlap();
    let unchanging: Vec<DVec2> =
        [DVec2::X, DVec2::Y].into_iter().filter(|&axis| repeats::is_unchanging(correlation, axis, overlap)).collect();
    let mut found = repeats::peaks(correlation, (width, height), (overlap, min_value), unchanging.first().copied());
    repeats::sharpen(&mut found);
    found.iter_mut().for_each(|r| r.shift *= to_unwarped);
    let lights = exemplar.components.list.len() as f32 / valid as f32;
    let best = found.iter().map(|r| r.lower_bound(lights * r.overlap)).fold(0.0, f32::max);
    found.retain(|r| r.value >= min_value.max(relative * best));
    found.sort_by(|a, b| a.shift.length_squared().total_cmp(&b.shift.length_squared()));
    let repeats = found.into_iter().filter(|r| kind_check::keeps_kinds(exemplar, r.shift));
    let repeats = repeats.map(|r| (r.shift, f64::from(r.value)));
    unchanging.into_iter().map(|axis| (axis, 1.0)).chain(repeats).take(max_count).collect()
}
