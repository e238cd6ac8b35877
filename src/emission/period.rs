//! Regularity: the lattice the lamps lie on, from the autocorrelation of their mask.
//!
//! Where a shift of the mask onto itself is nearly perfect, lamps repeat by it. The two shortest such shifts are the
//! lattice (rectangular, hexagonal or skewed; missing lamps lower the correlation by their share only), and every patch is
//! held to its phase. One repeat alone, or a handful of lamps, is continued by taking the exemplar as the other period:
//! nothing in it says how a design goes on beside itself. Many lamps without any repeat are left free.

use super::components::Component;
use super::correlation::Autocorrelation;
use super::exemplar::Exemplar;
use super::statistics;
use crate::error::{Error, Result};
use crate::image::{Image, pyramid};
use crate::job::Job;
use glam::{DMat2, DVec2};

/// How far below the best a period's correlation may lie: lower ones match lamps of unequal kind.
const RELATIVE_CORRELATION: f32 = 0.9;
/// Standard errors by which the best may be the best by chance, as one of the many shifts that compare few lamps.
const CHANCE: f32 = 2.0;
/// Correlation at all shifts along an axis from which the pattern does not change along it.
const UNCHANGING: f32 = 0.95;
/// Share of the valid pixels that must overlap for a correlation to count.
const LEAST_OVERLAP: f32 = 0.2;
/// Longest side of the image that is correlated.
const SIDE: usize = 160;
/// Shifts beside a period, in pixels of that image, over which its correlation must fall by so much: where it does not, nothing that
/// repeats is in sight, only what goes on along the shift.
const FLAT: (isize, f32) = (8, 0.02);
/// Slant of a row of lamps that is taken for none.
const MOST_SLANT: f64 = 0.04;
/// Fewer lamps than this show no law of their own: the exemplar repeats as a whole.
const FEW_LAMPS: usize = 6;

/// Room around lamps from which they are a group by themselves, both sides together, in the longest distance from one of them to
/// the nearest other.
const GROUP_MARGIN: f64 = 2.5;

/// By how much, relatively, both sides of lamps of a kind may differ, and the share of lamps that a period may lead to others.
const KIND: f64 = 0.33;
const MOST_UNLIKE: f64 = 0.4;
/// Unwarped pixels between the lamps of one cell and those of the next, where cells are as small as they can be.
const CELL_GAP: f64 = 4.0;

/// How the texture goes on beyond the exemplar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Continuation {
    /// The texture is a part of the exemplar.
    Copy,
    /// Two periods were found in the lights, in unwarped pixels.
    Lattice([DVec2; 2]),
    /// One period was found (the first); the extent of the exemplar serves as the second.
    Row([DVec2; 2]),
    /// Too few lights to have a law: the extent of the exemplar serves as both periods.
    Tile([DVec2; 2]),
    /// Many lights without a period: patches go anywhere.
    Free,
}

impl Continuation {
    /// The lattice on which patches must stay, if any.
    pub fn lattice(&self) -> Option<[DVec2; 2]> {
        match *self {
            Self::Lattice(basis) | Self::Row(basis) | Self::Tile(basis) => Some(basis),
            Self::Copy | Self::Free => None,
        }
    }

    /// The same with its lattice stretched so that a whole number of periods, one at least, fits a size.
    ///
    /// Errors: `Degenerate` where that leaves no lattice.
    pub fn fitted(self, size: DVec2) -> Result<Self> {
        let fit = |[a, b]: [DVec2; 2]| {
            // Steps along both periods to the far ends of the two sides.
            let inverse = DMat2::from_cols(a, b).inverse();
            let steps = |side: DVec2| (inverse * side).round();
            let whole = DMat2::from_cols(steps(DVec2::X * size.x), steps(DVec2::Y * size.y)).inverse();
            let basis = DMat2::from_diagonal(size) * whole;
            match basis.is_finite() {
                true => Ok([basis.x_axis, basis.y_axis]),
                false => Err(Error::degenerate(format!(
                    "a texture of {} x {} unwarped pixels is less than a period of its lights and cannot repeat: enlarge it",
                    size.x, size.y
                ))),
            }
        };
        Ok(match self {
            Self::Lattice(basis) => Self::Lattice(fit(basis)?),
            Self::Row(basis) => Self::Row(fit(basis)?),
            Self::Tile(basis) => Self::Tile(fit(basis)?),
            Self::Copy | Self::Free => self,
        })
    }

    /// The period along x and along y, in unwarped pixels, where the lattice has one there; that of a copy is infinite.
    pub fn periods(&self) -> [Option<f64>; 2] {
        if *self == Self::Copy {
            return [Some(f64::INFINITY); 2];
        }
        let along = |axis: DVec2| {
            let is_along = |v: &DVec2| v.perp_dot(axis).abs() < MOST_SLANT * v.length();
            self.lattice().and_then(|basis| basis.into_iter().find(is_along)).map(|v| v.length())
        };
        [along(DVec2::X), along(DVec2::Y)]
    }
}

/// A shift at which lights fall onto lights.
struct Repeat {
    shift: DVec2,
    /// The correlation there, and the number of pixels that are compared.
    value: f32,
    overlap: f32,
}

impl Repeat {
    /// The correlation less what chance may have added to it, where so many lights are compared.
    fn surely(&self, lights: f32) -> f32 {
        self.value - CHANCE * (1.0 - self.value.powi(2)) / (lights - 1.0).max(1.0).sqrt()
    }
}

/// Finds how the lights of the exemplar repeat, and how well: the lower correlation of its periods, 0 if there are none.
/// From the correlation `least_regularity` on a shift may be a period; at 1 nothing repeats.
pub fn find(exemplar: &Exemplar, least_regularity: f32, job: Job) -> Result<(Continuation, f64)> {
    if least_regularity >= 1.0 {
        return Ok((Continuation::Free, 0.0));
    }
    let working = &exemplar.working;
    let bounds = working.usable_box();
    let extent = DVec2::new((bounds[2] - bounds[0]) as f64, (bounds[3] - bounds[1]) as f64) * working.pitch;

    // The lights at the size that is correlated.
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
    let least = LEAST_OVERLAP * valid.iter().filter(|&&v| v).count() as f32;
    let to_unwarped = DVec2::new(exemplar.width as f64 / width as f64, exemplar.height as f64 / height as f64);

    // Shifts at which the lights fall onto themselves, shortest first.
    let unchanging: Vec<DVec2> =
        [DVec2::X, DVec2::Y].into_iter().filter(|&axis| is_unchanging(&correlation, axis, least)).collect();
    let mut periods: Vec<(DVec2, f64)> = unchanging.iter().map(|&axis| (axis, 1.0)).collect();
    let mut repeats = peaks(&correlation, width, height, least, least_regularity, unchanging.first().copied());
    sharpen(&mut repeats);
    repeats.iter_mut().for_each(|r| r.shift *= to_unwarped);
    let lights = exemplar.components.list.len() as f32 / valid.iter().filter(|&&v| v).count() as f32;
    let best = repeats.iter().map(|r| r.surely(lights * r.overlap)).fold(0.0, f32::max);
    repeats.retain(|r| r.value >= least_regularity.max(RELATIVE_CORRELATION * best));
    repeats.sort_by(|a, b| a.shift.length_squared().total_cmp(&b.shift.length_squared()));
    for Repeat { shift, value, .. } in repeats {
        let parallel = |p: &(DVec2, f64)| p.0.normalize().perp_dot(shift.normalize()).abs() < 0.3;
        if periods.len() < 2 && !periods.iter().any(parallel) && keeps_kinds(exemplar, shift) {
            periods.push((shift, f64::from(value)));
        }
    }
    let goodness = periods.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);

    let few = exemplar.lamps().count() < FEW_LAMPS || is_group(exemplar, extent);
    Ok(match periods[..] {
        [(a, _), (b, _)] => (Continuation::Lattice(refine(exemplar, [a, b], 2)), goodness),
        [(a, _)] => {
            let across = if a.x.abs() > a.y.abs() { DVec2::Y * extent } else { DVec2::X * extent };
            let [period, _] = refine(exemplar, [a, across], 1);
            (Continuation::Row([straight(period), across]), goodness)
        }
        _ if few => {
            let cell = whole_exemplar(exemplar, extent);
            (Continuation::Tile([DVec2::X * cell, DVec2::Y * cell]), 0.0)
        }
        _ => (Continuation::Free, 0.0),
    })
}

/// The sides at which an exemplar repeats as a whole, so that light covers the share of the plane that it covers of what is shown:
/// less than its extent where that has dark corners that the photo does not show, or lamps cut off that are left out.
fn whole_exemplar(exemplar: &Exemplar, extent: DVec2) -> DVec2 {
    let lamps = &exemplar.components.list;
    let lit: usize = lamps.iter().zip(&exemplar.cut).filter(|(_, cut)| !**cut).map(|(lamp, _)| lamp.area).sum();
    let share = (lit as f64 / exemplar.lit_share / extent.element_product()).min(1.0);
    if share > 1.0 - 1e-6 {
        return extent;
    }
    // Lamps of one cell keep clear of those of the next.
    let point = |p: [usize; 2]| DVec2::new(p[0] as f64, p[1] as f64);
    let (low, high) = exemplar.pieces().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), (_, lamp)| {
        (low.min(point(lamp.min)), high.max(point(lamp.max) + 1.0))
    });
    let least = if low.x <= high.x { (high - low + CELL_GAP) / extent } else { DVec2::ZERO };
    let x = (share / least.y.max(share.sqrt())).max(least.x).min(1.0);
    extent * DVec2::new(x, (share / x).max(least.y).min(1.0))
}

/// The period at which a row that ends is repeated along itself: as many of its own as the exemplar shows, with the room at both
/// ends. `None` where it may go on beyond the exemplar: another lamp would find no room at one of the ends.
pub fn repeat_of_row(exemplar: &Exemplar, period: DVec2) -> Option<DVec2> {
    let axis = period.normalize();
    let working = &exemplar.working;
    let bounds = working.usable_box();
    let along = |x: usize, y: usize| axis.dot(DVec2::new(x as f64, y as f64));
    let span = |[x0, y0, x1, y1]: [usize; 4]| {
        let corners = [along(x0, y0), along(x1, y0), along(x0, y1), along(x1, y1)];
        (
            corners.iter().copied().fold(f64::INFINITY, f64::min),
            corners.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        )
    };
    let lamps = exemplar.components.list.iter().map(|l| span([l.min[0], l.min[1], l.max[0] + 1, l.max[1] + 1]));
    let (low, high) = lamps.clone().fold((f64::INFINITY, f64::NEG_INFINITY), |s, l| (s.0.min(l.0), s.1.max(l.1)));
    let longest = lamps.map(|(low, high)| high - low).fold(0.0, f64::max);
    let pixels = |n: usize, pitch: f64| (n as f64 * pitch).round() as usize;
    let [x0, y0, x1, y1] = bounds;
    let (pitch_x, pitch_y) = (working.pitch.x, working.pitch.y);
    let (start, end) = span([pixels(x0, pitch_x), pixels(y0, pitch_y), pixels(x1, pitch_x), pixels(y1, pitch_y)]);
    let gap = period.length() - longest;
    let times = ((end - start) / period.length()).round();
    (low - start > gap && end - high > gap && times >= 1.0).then(|| period * times)
}

/// Whether a shift leads from lamps to lamps of their kind, where it leads to any: light correlates with itself where a row of narrow
/// panes falls onto one of wide ones, but that is no period.
fn keeps_kinds(exemplar: &Exemplar, shift: DVec2) -> bool {
    const MOST: usize = 200;
    let all: Vec<_> = exemplar.lamps().collect();
    let size = |lamp: &Component| DVec2::new(lamp.size()[0] as f64, lamp.size()[1] as f64);
    let (mut like, mut unlike) = (0, 0);
    for lamp in all.iter().step_by(all.len().div_ceil(MOST).max(1)) {
        let at = lamp.centre + shift;
        let is_hit = |other: &&&Component| {
            let reach = (size(other) + size(lamp)) / 4.0;
            (other.centre - at).abs().cmple(reach).all()
        };
        if let Some(other) = all.iter().find(is_hit) {
            let (a, b) = (size(lamp), size(other));
            let is_like = (a.max(b) - a.min(b)).cmple((KIND * a.max(b)).max(DVec2::splat(2.0))).all();
            if is_like { like += 1 } else { unlike += 1 }
        }
    }
    f64::from(unlike) <= MOST_UNLIKE * f64::from(like + unlike)
}

/// Whether the lamps keep together, far from the sides of what is shown along both axes: they are one thing, as a chandelier is.
fn is_group(exemplar: &Exemplar, extent: DVec2) -> bool {
    let lamps = &exemplar.components.list;
    let centres: Vec<DVec2> = lamps.iter().map(|lamp| lamp.centre).collect();
    let farthest = statistics::nearest_distances(&centres).into_iter().fold(0.0, f64::max);
    let point = |p: [usize; 2]| DVec2::new(p[0] as f64, p[1] as f64);
    let low = lamps.iter().map(|lamp| point(lamp.min)).fold(DVec2::INFINITY, DVec2::min);
    let high = lamps.iter().map(|lamp| point(lamp.max) + 1.0).fold(DVec2::NEG_INFINITY, DVec2::max);
    farthest.is_finite() && (extent - (high - low)).min_element() > GROUP_MARGIN * farthest
}

/// Whether the lights stay the same under any shift along an axis, up to half of the image.
fn is_unchanging(correlation: &Autocorrelation, axis: DVec2, least: f32) -> bool {
    let (dx, dy) = (axis.x as isize, axis.y as isize);
    let values: Vec<f32> = (1..).map_while(|i| correlation.at(dx * i, dy * i, 2.5 * least)).collect();
    !values.is_empty() && values.iter().all(|&v| v >= UNCHANGING)
}

/// Local maxima of the correlation in the half-plane of shifts, to a fraction of a pixel. Along a direction in which nothing
/// changes they are ridges: there only the shifts across it are looked at.
fn peaks(
    correlation: &Autocorrelation,
    width: usize,
    height: usize,
    least: f32,
    least_value: f32,
    unchanging: Option<DVec2>,
) -> Vec<Repeat> {
    let (w, h) = (width as isize, height as isize);
    let mut found = Vec::new();
    for y in 0..h {
        for x in (1 - w)..w {
            let off_axis = unchanging.is_some_and(|u| u.dot(DVec2::new(x as f64, y as f64)) != 0.0);
            if (y == 0 && x <= 0) || off_axis {
                continue;
            }
            let Some(value) = correlation.at(x, y, least).filter(|&v| v >= least_value) else { continue };
            let at = |dx: isize, dy: isize| match unchanging {
                Some(u) if u.dot(DVec2::new(dx as f64, dy as f64)) != 0.0 => -1.0,
                _ => correlation.at(x + dx, y + dy, 1.0).unwrap_or(-1.0),
            };
            let ring = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
            // Of equal neighbours the first in reading order is the peak.
            let is_peak = ring.iter().enumerate().all(|(i, &(dx, dy))| {
                let other = at(dx, dy);
                if i < 4 { value > other } else { value >= other }
            });
            let (ux, uy) = if x.abs() > y { (1, 0) } else { (0, 1) };
            let is_flat = [-1, 1].into_iter().any(|side| {
                (1..=FLAT.0).all(|k| {
                    correlation.at(x + side * k * ux, y + side * k * uy, 1.0).is_some_and(|v| v > value - FLAT.1)
                })
            });
            if is_peak && !is_flat {
                // The vertex of the parabola through three values: where it is, and how far it rises above the middle one.
                let vertex = |low: f32, high: f32| {
                    let (slope, curvature) = (high - low, low + high - 2.0 * value);
                    if curvature > -1e-6 {
                        return (0.0, 0.0);
                    }
                    (-0.5 * slope / curvature, -0.125 * slope * slope / curvature)
                };
                let (right, rise_x) = vertex(at(-1, 0), at(1, 0));
                let (down, rise_y) = vertex(at(0, -1), at(0, 1));
                let shift = DVec2::new(x as f64 + f64::from(right), y as f64 + f64::from(down));
                let value = (value + rise_x + rise_y).min(1.0);
                found.push(Repeat { shift, value, overlap: correlation.overlap(x, y) });
            }
        }
    }
    found
}

/// Measures every shift again by the farthest peak that is a multiple of it: an error there counts by its fraction only.
fn sharpen(peaks: &mut [Repeat]) {
    let all: Vec<DVec2> = peaks.iter().map(|p| p.shift).collect();
    for Repeat { shift, .. } in peaks {
        for times in 2.. {
            let expected = *shift * f64::from(times);
            let nearest =
                all.iter().min_by(|p, q| p.distance_squared(expected).total_cmp(&q.distance_squared(expected)));
            match nearest.filter(|p| p.distance(expected) < 1.0) {
                Some(peak) => *shift = *peak / f64::from(times),
                None => break,
            }
        }
    }
}

/// A period that all but follows an axis follows it: a row of few lamps cannot tell a slant of a few % from their own disorder,
/// but carried on for long it would leave the plane's axes, along which the photo was unwarped.
fn straight(period: DVec2) -> DVec2 {
    match () {
        _ if period.x.abs() < MOST_SLANT * period.y.abs() => DVec2::new(0.0, period.length().copysign(period.y)),
        _ if period.y.abs() < MOST_SLANT * period.x.abs() => DVec2::new(period.length().copysign(period.x), 0.0),
        _ => period,
    }
}

/// Fits the first `count` basis vectors to the centres of like lamps: every pair whose difference is near `i a + j b`
/// votes for both vectors by least squares, near pairs first, so that the long ones are counted by an exact ruler. Its vote weighs
/// as much as the smaller of both is large: crumbs are alike everywhere.
fn refine(exemplar: &Exemplar, basis: [DVec2; 2], count: usize) -> [DVec2; 2] {
    const MOST: usize = 400;
    let all: Vec<_> = exemplar.lamps().collect();
    let lamps: Vec<_> = all.iter().step_by(all.len().div_ceil(MOST).max(1)).collect();
    let mut basis = basis;
    for reach in [1.5, 3.5, f64::INFINITY] {
        let inverse = DMat2::from_cols(basis[0], basis[1]).inverse();
        if !inverse.is_finite() {
            break;
        }
        // Normal equations of difference = [a b] (i, j).
        let (mut gram, mut sums) = (DMat2::ZERO, DMat2::ZERO);
        let mut votes = 0;
        for (n, p) in lamps.iter().enumerate() {
            for q in &lamps[n + 1..] {
                let alike = (0..2).all(|k| p.size()[k].abs_diff(q.size()[k]) <= 2 + p.size()[k] / 8);
                let difference = q.centre - p.centre;
                let cell = inverse * difference;
                let step = DVec2::new(cell.x.round(), if count == 2 { cell.y.round() } else { 0.0 });
                let off = (difference - basis[0] * step.x - basis[1] * step.y).length();
                let near = step.x.abs().max(step.y.abs()) <= reach;
                if alike && near && step != DVec2::ZERO && off < 0.12 * basis[0].length() {
                    let weight = p.area.min(q.area) as f64;
                    gram += DMat2::from_cols(step * step.x, step * step.y) * weight;
                    sums += DMat2::from_cols(difference * step.x, difference * step.y) * weight;
                    votes += 1;
                }
            }
        }
        if votes == 0 {
            continue;
        }
        if count == 1 {
            basis[0] = sums.x_axis / gram.x_axis.x;
        } else if gram.determinant() > 1e-6 * gram.x_axis.x * gram.y_axis.y {
            let fitted = sums * gram.inverse();
            basis = [fitted.x_axis, fitted.y_axis];
        }
    }
    basis
}
