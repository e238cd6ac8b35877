//! Regularity: the lattice the lamps lie on, from the autocorrelation of their mask.
//!
//! Where a shift of the mask onto itself is nearly perfect, lamps repeat by it. The two shortest such shifts are the
//! lattice (rectangular, hexagonal or skewed; missing lamps lower the correlation by their share only), and every patch is
//! held to its phase. One repeat alone, or a handful of lamps, is continued by taking the exemplar as the other period:
//! nothing in it says how a design goes on beside itself. Many lamps without any repeat are left free.

pub mod basis;
pub mod border_sites;
pub mod cells;
pub mod centring;
pub mod continuation;
pub mod correlation;
pub mod extent;
pub mod kind_check;
pub mod repeats;

use super::exemplar::Exemplar;
use crate::error::Result;
use crate::image::{Image, pyramid};
use crate::job::Job;
use continuation::Continuation;
use correlation::Autocorrelation;
use glam::DVec2;
use repeats::Repeat;

/// How far below the best a period's correlation may lie: lower ones match lamps of unequal kind. [bench emission:patterns]
const RELATIVE_CORRELATION: f32 = 0.9;
/// Share of the valid pixels that must overlap for a correlation to count. [bench emission:patterns]
const MIN_OVERLAP: f32 = 0.2;
/// Longest side of the image that is correlated. [bench emission:seconds]
const SIDE: usize = 160;
/// Sine of the angle between two shifts below which they are parallel: about 17°. [bench emission:patterns]
const PARALLEL: f64 = 0.3;

/// Finds how the lights of the exemplar repeat, and how well: the lower correlation of its periods, 0 if there are none.
/// From the correlation `least_regularity` on a shift may be a period; at 1 nothing repeats.
pub fn find(exemplar: &Exemplar, least_regularity: f32, job: Job) -> Result<(Continuation, f64)> {
    if least_regularity >= 1.0 {
        return Ok((Continuation::Free, 0.0));
    }
    let correlated = Correlated::new(exemplar, job)?;
    let periods = periods(exemplar, &correlated, least_regularity);
    let goodness = periods.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
    let extent = extent::of(exemplar);
    Ok(match periods[..] {
        [(a, _), (b, _)] => (Continuation::Lattice(basis::refine(exemplar, [a, b], 2)), goodness),
        [(a, _)] => {
            let across = if a.x.abs() > a.y.abs() { DVec2::Y * extent } else { DVec2::X * extent };
            let [period, _] = basis::refine(exemplar, [a, across], 1);
            (Continuation::Row([basis::straight(period), across]), goodness)
        }
        _ if extent::has_few_lamps(exemplar, extent) => {
            let cell = extent::whole_exemplar(exemplar, extent);
            (Continuation::Tile([DVec2::X * cell, DVec2::Y * cell]), 0.0)
        }
        _ => (Continuation::Free, 0.0),
    })
}

/// The autocorrelation of the lights at a reduced size.
struct Correlated {
    correlation: Autocorrelation,
    width: usize,
    height: usize,
    /// Number of valid pixels.
    valid: usize,
    /// Unwarped pixels per pixel.
    to_unwarped: DVec2,
}

impl Correlated {
    fn new(exemplar: &Exemplar, job: Job) -> Result<Self> {
        let working = &exemplar.working;
        let longest = working.width.max(working.height);
        let reduce = |n: usize| (n * SIDE.min(longest)).div_ceil(longest).max(1);
        let (width, height) = (reduce(working.width), reduce(working.height));
        let mut mask = Image::new(working.width, working.height, 2)?;
        for (i, pixel) in mask.data.chunks_exact_mut(2).enumerate().filter(|(i, _)| working.shown[*i]) {
            pixel.copy_from_slice(&[f32::from(working.shown_coverage[i] >= 0.5), 1.0]);
        }
        let mask = pyramid::resize(&mask, width, height, job.part(0.0, 0.2))?;
        let valid: Vec<bool> = mask.data.chunks_exact(2).map(|p| p[1] > 0.5).collect();
        let values: Vec<f32> = mask.data.chunks_exact(2).map(|p| if p[1] > 0.5 { p[0] / p[1] } else { 0.0 }).collect();
        let correlation = Autocorrelation::new(&values, &valid, width, height, job.part(0.2, 1.0))?;
        let to_unwarped = DVec2::new(exemplar.width as f64 / width as f64, exemplar.height as f64 / height as f64);
        Ok(Self { correlation, width, height, valid: valid.iter().filter(|&&v| v).count(), to_unwarped })
    }
}

/// At most two shifts at which the lights fall onto themselves, shortest first, and their correlations.
fn periods(exemplar: &Exemplar, correlated: &Correlated, least_regularity: f32) -> Vec<(DVec2, f64)> {
    let &Correlated { ref correlation, width, height, valid, to_unwarped } = correlated;
    let least = MIN_OVERLAP * valid as f32;
    let unchanging: Vec<DVec2> =
        [DVec2::X, DVec2::Y].into_iter().filter(|&axis| repeats::is_unchanging(correlation, axis, least)).collect();
    let mut periods: Vec<(DVec2, f64)> = unchanging.iter().map(|&axis| (axis, 1.0)).collect();
    let mut found =
        repeats::peaks(correlation, (width, height), (least, least_regularity), unchanging.first().copied());
    repeats::sharpen(&mut found);
    found.iter_mut().for_each(|r| r.shift *= to_unwarped);

    // Keep the shifts nearly as good as the best; take the shortest two that lead from lamps to lamps of their kind.
    let lights = exemplar.components.list.len() as f32 / valid as f32;
    let best = found.iter().map(|r| r.lower_bound(lights * r.overlap)).fold(0.0, f32::max);
    found.retain(|r| r.value >= least_regularity.max(RELATIVE_CORRELATION * best));
    found.sort_by(|a, b| a.shift.length_squared().total_cmp(&b.shift.length_squared()));
    for Repeat { shift, value, .. } in found {
        let parallel = |p: &(DVec2, f64)| p.0.normalize().perp_dot(shift.normalize()).abs() < PARALLEL;
        if periods.len() < 2 && !periods.iter().any(parallel) && kind_check::keeps_kinds(exemplar, shift) {
            periods.push((shift, f64::from(value)));
        }
    }
    periods
}
