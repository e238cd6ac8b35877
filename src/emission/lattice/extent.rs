//! The extent of the exemplar as a period, for lights that have no period of their own.

use super::copies;
use super::law::Law;
use crate::emission::agreement::statistics;
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::components::Component;
use crate::emission::exemplar::measured_lamp::MAX_PANE_DIFFERENCE;
use crate::emission::exemplar::roles::Role;
use glam::DVec2;

/// Minimum gap between the lamps of adjacent copies of the exemplar, in unwarped pixels. [convention]
const CELL_GAP: f64 = 4.0;

/// An exemplar without a period repeats as a whole if it has fewer lamps than this, so that rows of unlike lamps stay
/// rows. With more lamps, patches are placed without a lattice. Patches also show the lamps that the border cuts, which
/// a repetition leaves out; so the lit share is closer to the lit share of the exemplar. But patches need enough lamps
/// that the border does not cut. [judged on 15 photos]
const FEW_LAMPS: usize = 16;

/// All lamps form one isolated group if the free space around them is large compared with the distances between them.
/// The free space along an axis is the extent of the exemplar minus the extent of the box around all lamps. Along both
/// axes, it must exceed this factor times d, where d is the largest distance from a lamp to its nearest neighbour.
/// [judged on 5 photos]
const GROUP_MARGIN: f64 = 2.5;

/// Width and height of the bounding box of the exemplar's usable pixels, in unwarped pixels.
pub fn of(exemplar: &Exemplar) -> DVec2 {
    let [x0, y0, x1, y1] = exemplar.working.usable_box();
    DVec2::new((x1 - x0) as f64, (y1 - y0) as f64) * exemplar.working.pitch
}

/// The period, along x and along y, with which a luminous ceiling repeats as a whole, in unwarped pixels. If the first
/// and the last column of panes are alike, the last column of a copy is the first one of the next copy
/// ([`to_like_column`]). Otherwise the period is the length of the box around all panes, plus the width of the widest
/// bar between panes. The same holds for rows.
pub fn of_panes(exemplar: &Exemplar) -> DVec2 {
    let panes = || exemplar.components.list.iter();
    let [[width, column], [height, row]] = [spread(panes(), 0, usize::max), spread(panes(), 1, usize::max)];
    // A single column or row of panes has bars along one axis only. The width of these bars then serves for the other
    // axis as well.
    let bar = |own: f64, other: f64| if own > 0.0 { own } else { other };
    DVec2::new(
        to_like_column(exemplar, 0).unwrap_or(width + bar(column, row)),
        to_like_column(exemplar, 1).unwrap_or(height + bar(row, column)),
    )
}

/// The distance along an axis (0 for x, 1 for y) from the first to the last column of panes, in unwarped pixels, if
/// these two columns are equally wide and some column between them has another width. `None` otherwise, and if the
/// first or the last column has no whole pane.
fn to_like_column(exemplar: &Exemplar, axis: usize) -> Option<f64> {
    let columns = intervals(exemplar.components.list.iter(), axis);
    let (&first, &last) = (columns.first()?, columns.last()?);
    let width = |column: [usize; 2]| (column[1] - column[0]) as f64;
    let is_like_first = |column: [usize; 2]| {
        (width(column) - width(first)).abs() <= MAX_PANE_DIFFERENCE * width(column).max(width(first))
    };
    let has_whole = |column: [usize; 2]| {
        let is_in = |lamp: &Component| column[0] <= lamp.min[axis] && lamp.max[axis] < column[1];
        exemplar.components.list.iter().zip(&exemplar.roles).any(|(lamp, role)| role.is_whole() && is_in(lamp))
    };
    let centre = |column: [usize; 2]| (column[0] + column[1]) as f64 / 2.0;
    let takes_its_place = is_like_first(last) && !columns.iter().all(|column| is_like_first(*column));
    (takes_its_place && has_whole(first) && has_whole(last)).then(|| centre(last) - centre(first))
}

/// Returns two lengths along an axis (0 for x, 1 for y), in unwarped pixels: the length of the box around all `lamps`,
/// and the length of a gap between lamps. A gap is an interval of the axis that no lamp reaches into. If there are
/// several, `choose` picks the longest or the shortest one. Without a gap, the length of the gap is 0.
fn spread<'a>(lamps: impl Iterator<Item = &'a Component>, axis: usize, choose: fn(usize, usize) -> usize) -> [f64; 2] {
    let taken = intervals(lamps, axis);
    let gap = taken.windows(2).map(|pair| pair[1][0] - pair[0][1]).reduce(choose);
    let length = taken.last().map_or(0, |last| last[1] - taken[0][0]);
    [length as f64, gap.unwrap_or(0) as f64]
}

/// The intervals of an axis (0 for x, 1 for y) into which lamps reach, in ascending order: the first position of each,
/// and the position after its last one.
fn intervals<'a>(lamps: impl Iterator<Item = &'a Component>, axis: usize) -> Vec<[usize; 2]> {
    let mut spans: Vec<[usize; 2]> = lamps.map(|lamp| [lamp.min[axis], lamp.max[axis] + 1]).collect();
    spans.sort_unstable();
    let mut intervals: Vec<[usize; 2]> = Vec::new();
    for span in spans {
        match intervals.last_mut() {
            Some(last) if span[0] <= last[1] => last[1] = last[1].max(span[1]),
            _ => intervals.push(span),
        }
    }
    intervals
}

/// The period, along x and along y, with which an exemplar repeats if it shows rows of lamps, in unwarped pixels. Along
/// each axis, it is the larger of two lengths:
///
/// - the extent of the exemplar, and
/// - the length of the box around all lamps plus the shortest gap between lamps, if there is a gap.
///
/// Without the second length, two rows at opposite borders of the exemplar would lie side by side in the texture,
/// almost without a gap.
pub fn of_rows(exemplar: &Exemplar) -> DVec2 {
    let spaced = |axis: usize| {
        let [length, gap] = spread(exemplar.components.list.iter(), axis, usize::min);
        if gap > 0.0 { length + gap } else { 0.0 }
    };
    of(exemplar).max(DVec2::new(spaced(0), spaced(1)))
}

/// The law by which the exemplar repeats as a whole, with periods along x and y.
pub fn as_period(exemplar: &Exemplar) -> Law {
    let cell = whole_exemplar(exemplar, of(exemplar));
    Law::Whole([DVec2::X * cell, DVec2::Y * cell])
}

/// Whether there are too few lamps to find a period ([`FEW_LAMPS`]), or all lamps form one isolated group
/// ([`GROUP_MARGIN`]). `extent` is the size of the usable part of the exemplar in unwarped pixels.
pub fn has_few_lamps(exemplar: &Exemplar, extent: DVec2) -> bool {
    exemplar.lamps().count() < FEW_LAMPS || is_group(exemplar, extent)
}

/// The periods along x and along y with which an exemplar repeats as a whole, in unwarped pixels. The texture should
/// have the same lit share as the visible part of the plane. So the area of a repetition is the area of the lights that
/// it copies, divided by the lit share, but at most the area of `extent`. It is smaller than `extent` if some corners
/// of the exemplar are not visible, or if cut lamps are left out. If neither is the case, [`of_rows`] gives the
/// periods. No period is shorter than [`min_cell`], so that the lamps of adjacent repetitions stay apart.
///
/// A single lamp in a photo shows no spacing, so both its periods have the same length. The exceptions: [`min_cell`] is
/// longer along one axis, or does not fit into `extent`.
///
/// Where lamps of adjacent repetitions would lie nearer to each other than lamps in the photo do,
/// [`copies::keep_distances`] changes the periods.
fn whole_exemplar(exemplar: &Exemplar, extent: DVec2) -> DVec2 {
    let lamps = &exemplar.components.list;
    let lit: usize =
        lamps.iter().zip(&exemplar.roles).filter(|(_, role)| **role != Role::Cut).map(|(lamp, _)| lamp.area).sum();
    let share = (lit as f64 / exemplar.lit_share / extent.element_product()).min(1.0);
    let is_framed = exemplar.to_photo.is_some() && exemplar.pieces().count() == 1;
    let min_cell = min_cell(exemplar);
    if share > 1.0 - 1e-6 && !is_framed {
        return copies::keep_distances(exemplar, of_rows(exemplar), min_cell);
    }
    let min_share = min_cell / extent;
    if is_framed && min_share.max_element() <= 1.0 {
        return DVec2::splat((share * extent.element_product()).sqrt()).max(min_share * extent);
    }
    let x = (share / min_share.y.max(share.sqrt())).min(1.0).max(min_share.x);
    let cell = extent * DVec2::new(x, (share / x).min(1.0).max(min_share.y));
    copies::keep_distances(exemplar, cell, min_cell)
}

/// The smallest period, along x and along y, at which the copied lamps of adjacent repetitions stay apart, in unwarped
/// pixels. It is the length of the box around the lamps, plus the shortest gap between lamps, or plus [`CELL_GAP`] if
/// that is larger. Zero without copied lamps.
fn min_cell(exemplar: &Exemplar) -> DVec2 {
    let pieces = || exemplar.pieces().map(|(_, lamp)| lamp);
    let along = |axis: usize| {
        let [length, gap] = spread(pieces(), axis, usize::min);
        if length > 0.0 { length + gap.max(CELL_GAP) } else { 0.0 }
    };
    DVec2::new(along(0), along(1))
}

/// The two corners of the bounding box of lamps: the smallest coordinates and the largest coordinates. Without lamps,
/// these are +∞ and -∞.
fn bounds_of<'a>(lamps: impl Iterator<Item = &'a Component>) -> (DVec2, DVec2) {
    lamps
        .map(Component::bounds)
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), (first, last)| (low.min(first), high.max(last)))
}

/// Whether the lamps lie close together and far from the border ([`GROUP_MARGIN`]). They then count as one object, such
/// as a chandelier.
fn is_group(exemplar: &Exemplar, extent: DVec2) -> bool {
    let lamps = &exemplar.components.list;
    let centres: Vec<DVec2> = lamps.iter().map(|lamp| lamp.centre).collect();
    let farthest = statistics::nearest_distances(&centres).into_iter().fold(0.0, f64::max);
    let (low, high) = bounds_of(lamps.iter());
    farthest.is_finite() && (extent - (high - low)).min_element() > GROUP_MARGIN * farthest
}

/// The period with which a row of lamps repeats as a whole: a vector along `period`, which leads from lamp to lamp. It
/// is as long as the exemplar along the row, including the free space at both ends, rounded to a multiple of `period`.
/// `None` if the exemplar is shorter than half a period, or if the row may continue beyond the view at one of its ends.
/// An end is in view if:
///
/// - the exemplar extends beyond the place where the next lamp would begin, and
/// - the photo, if there is one, shows the place where the centre of the next lamp would lie.
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
    let ends = low - start > gap && end - high > gap && ends_in_view(exemplar, period);
    (ends && times >= 1.0).then(|| period * times)
}

/// Whether the photo shows the two places, one beyond each end of a row, at which the centre of the next lamp would
/// lie. Without a photo, all places count as shown.
fn ends_in_view(exemplar: &Exemplar, period: DVec2) -> bool {
    let is_shown = |p: DVec2| {
        let inside = p.cmpge(DVec2::ZERO).all() && p.x < exemplar.width as f64 && p.y < exemplar.height as f64;
        inside && exemplar.shown[p.y as usize * exemplar.width + p.x as usize]
    };
    let along = |p: &DVec2| period.dot(*p);
    let first = exemplar.lamps().map(|l| l.centre).min_by(|a, b| along(a).total_cmp(&along(b)));
    let last = exemplar.lamps().map(|l| l.centre).max_by(|a, b| along(a).total_cmp(&along(b)));
    let both = first.zip(last).is_some_and(|(first, last)| is_shown(first - period) && is_shown(last + period));
    exemplar.to_photo.is_none() || both
}
