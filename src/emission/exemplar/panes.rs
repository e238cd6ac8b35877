//! Separates the panes of a luminous ceiling along the bars between them, and fills gaps within each pane.
//!
//! The light mask has two faults. Where bloom covers the bars, it joins neighbouring panes. Near the camera, it cuts
//! panes to pieces along the lead strips inside them (their leading). The detected bars ([`super::bars`]) give the
//! true borders of the panes.

use super::MIN_LUMINOUS_SHARE;
use super::bars::{self, Bar, Lines, LitPlane};
use crate::error::Result;
use crate::image::colour::luminance;
use crate::image::{Image, try_collect};
use crate::job::Job;
use glam::Vec3;
use std::ops::Range;

/// A rectangle between bars counts as a pane if at least this share of it is lit. [bench photos:real]
const MIN_LIT_SHARE: f64 = 0.35;
/// A pixel outside the mask is added to its pane if it has at least this luminance, relative to the pane's median.
/// [bench photos:real]
const MIN_RELATIVE_LUMINANCE: f32 = 0.5;
/// A dark line inside a pane is a lead strip, and is filled, if its width is at most this share of the pane's side.
/// [bench photos:real]
pub const MAX_LEADING_SHARE: f64 = 0.06;

/// Returns the light mask of the panes without the bars between them. `None` if the plane is not a luminous ceiling,
/// or if the mask covers no bar.
pub fn part(plane: &LitPlane, job: Job) -> Result<Option<Image>> {
    let pixels = plane.light.data.len();
    let valid = (0..pixels).filter(|&i| plane.is_valid(i)).count();
    let lit = (0..pixels).filter(|&i| plane.is_lit(i)).count();
    if lit == 0 || (lit as f64) < MIN_LUMINOUS_SHARE * valid as f64 {
        return Ok(None);
    }
    let colours = plane.unwarped.data.chunks_exact(plane.unwarped.channels);
    let luminances = try_collect(colours.map(|c| luminance(Vec3::new(c[0], c[1], c[2])).max(0.0)))?;
    let mut light = plane.light.try_clone()?;
    let (columns, cut_columns) = cut_bars(&Lines::new(plane, &luminances, true)?, &mut light);
    job.check()?;
    let (rows, cut_rows) = cut_bars(&Lines::new(plane, &luminances, false)?, &mut light);
    job.check()?;
    if !(cut_columns || cut_rows) {
        return Ok(None);
    }
    for rows in between(&rows, light.height) {
        for columns in between(&columns, light.width) {
            fill(&PaneCandidate { plane, luminances: &luminances, columns, rows: rows.clone() }, &mut light);
        }
    }
    Ok(Some(light))
}

/// Removes the bars of one direction from the light mask. Returns the bars in the order of their position, and whether
/// any lit pixel was removed.
fn cut_bars(lines: &Lines, light: &mut Image) -> (Vec<Bar>, bool) {
    let mut bars = lines.bars();
    let mut is_changed = false;
    let mut lowest_sharpness = f64::INFINITY;
    for bar in &bars {
        let sections = lines.sections(bar);
        let own = bars::lowest_sharpness(bar, &sections);
        lowest_sharpness = lowest_sharpness.min(own);
        is_changed |= lines.cut(bar, &sections, own, light);
    }
    // Remove the bars that the period predicts, too. A section of a predicted bar stays lit if the photo is sharp
    // enough to show a bar there but shows none. Sharp enough means: as sharp as the least sharp section of a visible
    // bar.
    let beyond = lines.beyond(&bars);
    for bar in &beyond {
        is_changed |= lines.cut(bar, &lines.sections(bar), lowest_sharpness, light);
    }
    bars.extend(beyond);
    bars.sort_by_key(|bar| bar.first);
    (bars, is_changed)
}

/// The ranges of positions (columns or rows) between bars, and between the image border and the outermost bars.
fn between(bars: &[Bar], size: usize) -> Vec<Range<usize>> {
    let starts = std::iter::once(0).chain(bars.iter().map(|bar| bar.last + 1));
    let ends = bars.iter().map(|bar| bar.first).chain(std::iter::once(size));
    starts.zip(ends).filter(|(start, end)| start < end).map(|(start, end)| start..end).collect()
}

/// A rectangle between bars, which may be a pane, given by its columns and rows.
struct PaneCandidate<'a> {
    plane: &'a LitPlane<'a>,
    luminances: &'a [f32],
    columns: Range<usize>,
    rows: Range<usize>,
}

impl PaneCandidate<'_> {
    fn pixels(&self) -> impl Iterator<Item = usize> + '_ {
        let width = self.plane.light.width;
        let all = self.rows.clone().flat_map(move |y| self.columns.clone().map(move |x| y * width + x));
        all.filter(|&i| self.plane.is_valid(i))
    }
}

/// If a rectangle between bars holds enough light, makes it one pane: fills the lead strips in it, and adds bright
/// parts that the mask left out.
fn fill(candidate: &PaneCandidate, light: &mut Image) {
    let lit: Vec<usize> = candidate.pixels().filter(|&i| light.data[i] >= super::LIT).collect();
    if lit.is_empty() || (lit.len() as f64) < MIN_LIT_SHARE * candidate.pixels().count() as f64 {
        return;
    }

    // Fill the lead strips along rows and columns.
    let width = light.width;
    let (columns, rows) = (candidate.columns.clone(), candidate.rows.clone());
    rows.clone().for_each(|y| close(light, (y * width + columns.start, 1, columns.len())));
    columns.clone().for_each(|x| close(light, (rows.start * width + x, width, rows.len())));

    // Add the bright pixels in the bounding box of the pane's lit pixels.
    let range = |of: fn(usize, usize) -> usize| {
        let positions = || lit.iter().map(|&i| of(i, width));
        positions().min().unwrap_or(0)..=positions().max().unwrap_or(0)
    };
    let (left, top) = (range(|i, width| i % width), range(|i, width| i / width));
    let mut luminances: Vec<f32> = lit.iter().map(|&i| candidate.luminances[i]).collect();
    let middle = luminances.len() / 2;
    let min_luminance = MIN_RELATIVE_LUMINANCE * *luminances.select_nth_unstable_by(middle, f32::total_cmp).1;
    let is_bright = |&i: &usize| candidate.luminances[i] >= min_luminance;
    let is_inside = |&i: &usize| left.contains(&(i % width)) && top.contains(&(i / width));
    candidate.pixels().filter(is_bright).filter(is_inside).for_each(|i| light.data[i] = light.data[i].max(1.0));
}

/// Fills the short gaps between lit pixels of a line: a row or a column of a candidate. A gap is short if it takes at
/// most the share [`MAX_LEADING_SHARE`] of the line. `start` is the index of the line's first pixel, `step` the
/// difference to the index of the next pixel, and `count` the number of pixels.
fn close(light: &mut Image, (start, step, count): (usize, usize, usize)) {
    let widest = (count as f64 * MAX_LEADING_SHARE) as usize;
    let mut last = None;
    for n in (0..count).filter(|n| light.data[start + n * step] >= super::LIT).collect::<Vec<_>>() {
        if let Some(last) = last.filter(|last| n - last <= widest + 1) {
            (last + 1..n).for_each(|n| light.data[start + n * step] = 1.0);
        }
        last = Some(n);
    }
}

#[cfg(test)]
mod tests {
    use super::super::components;
    use super::*;
    use crate::geometry::Homography;
    use crate::job::Monitor;

    const SIDE: usize = 240;

    fn is_bar(n: usize) -> bool {
        n % 40 < 5 || n % 40 >= 35
    }

    /// Unwarped image, light mask and validity of a ceiling: panes with sides of 30 pixels and the luminance 1,
    /// separated by bars of 10 pixels whose luminance is `bar(x, y)`. The mask covers panes and bars, but not a margin
    /// of 5 pixels at the border of the image.
    fn ceiling(bar: impl Fn(usize, usize) -> f32) -> [Image; 3] {
        let is_inside = |n: usize| (5..SIDE - 5).contains(&n);
        let colour = |x: usize, y: usize| match is_inside(x) && is_inside(y) {
            true if is_bar(x) || is_bar(y) => [bar(x, y); 3],
            true => [1.0; 3],
            false => [0.1; 3],
        };
        let light = |x: usize, y: usize| [f32::from(is_inside(x) && is_inside(y))];
        let unwarped = Image::from_fn(SIDE, SIDE, colour).unwrap();
        let light = Image::from_fn(SIDE, SIDE, light).unwrap();
        let valid = Image::from_fn(SIDE, SIDE, |_, _| [1.0]).unwrap();
        [unwarped, light, valid]
    }

    fn panes([unwarped, light, valid]: &[Image; 3]) -> Option<Vec<components::Component>> {
        let plane = LitPlane { unwarped, light, valid, to_photo: None };
        let light = part(&plane, Monitor::default().job()).unwrap()?;
        Some(components::find(SIDE, SIDE, |i| light.data[i] >= 0.5).unwrap().list)
    }

    #[test]
    fn joined_panes_are_parted_where_bars_are_hardly_darker() {
        for bar in [0.2, 0.9] {
            let panes = panes(&ceiling(|_, _| bar)).unwrap();
            assert_eq!(panes.len(), 36, "{bar}");
            assert!(panes.iter().all(|pane| pane.size().iter().all(|&side| (28..=32).contains(&side))), "{panes:?}");
        }
    }

    #[test]
    fn bars_that_no_longer_show_go_on_by_their_period() {
        // The bars between the rows of panes are visible only where y < 150. Without a homography, all parts count as
        // equally sharp, so a part that shows no bar has none.
        let fading = |x: usize, y: usize| if y < 150 || is_bar(x) { 0.5 } else { 1.0 };
        assert_eq!(panes(&ceiling(fading)).unwrap().len(), 24);
        // With a homography that makes the lower rows ever less sharp, the period predicts the bars there.
        let [unwarped, light, valid] = ceiling(fading);
        let towards = glam::DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.01, 0.0, 0.0, 1.0]);
        let plane =
            LitPlane { unwarped: &unwarped, light: &light, valid: &valid, to_photo: Some(Homography(towards).into()) };
        let light = part(&plane, Monitor::default().job()).unwrap().unwrap();
        let panes = components::find(SIDE, SIDE, |i| light.data[i] >= 0.5).unwrap().list;
        assert_eq!(panes.len(), 36);
    }

    #[test]
    fn a_pane_keeps_its_leading_and_parts_that_the_mask_left_out() {
        let [unwarped, mut light, valid] = ceiling(|_, _| 0.2);
        let mut leaded = unwarped.try_clone().unwrap();
        for y in 47..73 {
            // A diagonal line of lead, and a corner that the mask left out.
            leaded.pixel_mut(y, y).fill(0.3);
            light.pixel_mut(y, y).fill(0.0);
            (65..73).for_each(|x| light.pixel_mut(x, y.min(55)).fill(0.0));
        }
        let panes = panes(&[leaded, light, valid]).unwrap();
        assert_eq!(panes.len(), 36);
        assert!(panes.iter().all(|pane| pane.area >= 28 * 28), "{panes:?}");
    }

    #[test]
    fn lead_strips_between_wide_bars_are_no_bars() {
        // Panes with sides of 70 pixels, and bars of 10 pixels between them. A strip of `strip` pixels runs along the
        // middle of each row of panes.
        const SIDE: usize = 400;
        let panes_with = |strip: usize| {
            let is_inside = |n: usize| (5..SIDE - 5).contains(&n);
            let is_bar = |n: usize| n % 80 < 5 || n % 80 >= 75;
            let is_strip = |n: usize| (40..40 + strip).contains(&(n % 80));
            let luminance = |x: usize, y: usize| match is_inside(x) && is_inside(y) {
                true if is_bar(x) || is_bar(y) || is_strip(y) => 0.3,
                true => 1.0,
                false => 0.1,
            };
            let unwarped = Image::from_fn(SIDE, SIDE, |x, y| [luminance(x, y); 3]).unwrap();
            let light = Image::from_fn(SIDE, SIDE, |x, y| [f32::from(is_inside(x) && is_inside(y))]).unwrap();
            let valid = Image::from_fn(SIDE, SIDE, |_, _| [1.0]).unwrap();
            let plane = LitPlane { unwarped: &unwarped, light: &light, valid: &valid, to_photo: None };
            let light = part(&plane, Monitor::default().job()).unwrap().unwrap();
            components::find(SIDE, SIDE, |i| light.data[i] >= 0.5).unwrap().list.len()
        };
        // The strips in the first and in the last row of panes lie between a bar and the border, so they are bars.
        assert_eq!(panes_with(2), 5 * 7);
        assert_eq!(panes_with(6), 5 * 10);
    }

    #[test]
    fn lamps_on_a_ceiling_are_no_panes() {
        let is_lamp = |n: usize| n % 60 < 24;
        let lit = |x: usize, y: usize| is_lamp(x) && is_lamp(y);
        let unwarped = Image::from_fn(SIDE, SIDE, |x, y| [if lit(x, y) { 1.0 } else { 0.2 }; 3]).unwrap();
        let light = Image::from_fn(SIDE, SIDE, |x, y| [f32::from(lit(x, y))]).unwrap();
        let valid = Image::from_fn(SIDE, SIDE, |_, _| [1.0]).unwrap();
        assert!(panes(&[unwarped, light, valid]).is_none());
    }
}
