//! Detects the bars between the panes of a luminous ceiling.
//!
//! The bars of a skylight or of a luminous ceiling run straight along the axes of the unwarped image. Far from the
//! camera they are thinner than a photo pixel, or hidden by the bloom of the panes. Yet, averaged over its whole
//! length, a bar is darker than the panes on both sides. The median over a whole line therefore detects bars that
//! single pixels do not show. Bars beyond the last visible one are predicted from the period of the bars.

use super::foreshortening::LocalMap;
use crate::error::Result;
use crate::geometry::PhotoMap;
use crate::geometry::robust::weighted_median;
use crate::image::{Image, try_vec};
use std::collections::VecDeque;
use std::ops::Range;

/// Maximum width of a bar, as a share of the longer side of the unwarped image. [bench photos:tune]
const MAX_WIDTH: f64 = 0.05;
/// A bar is detected only if its depth, a share of the luminance of the panes ([`Bar`]), is at least this value.
/// [bench photos:tune]
const MIN_DEPTH: f32 = 0.03;
/// A bar is detected only if at least this share of the positions along it has light on both sides of the bar.
/// [bench photos:tune]
const MIN_LENGTH: f64 = 0.1;
/// Number of sections ([`Section`]) along a bar, each of which is tested separately. [convention]
const SECTIONS: usize = 24;
/// Maximum number of consecutive sections ([`Section`]) of a bar that a crossing bar may hide. It suffices for a
/// crossing bar of the maximum width. [convention]
const MAX_HIDDEN_SECTIONS: usize = 2;
/// A dark line that lies alone between two bars is a lead strip inside a pane, and no bar, if two conditions hold. The
/// width of the line is at most `MAX_STRIP_SHARE` of the distance between the two bars. Each bar has a strength
/// ([`BarGroup`]) of at least `MIN_BAR_STRENGTH` times the strength of the line. [bench photos:real]
const MAX_STRIP_SHARE: f64 = 0.03;
const MIN_BAR_STRENGTH: f64 = 1.5;
/// Where the photo is sharp, a section ([`Section`]) shows no bar if its depth is below this share of the whole bar's
/// depth. [bench photos:tune]
const MIN_SECTION_DEPTH: f32 = 0.25;
/// Bars have a period if the distances between neighbouring bars deviate from their mean by at most this share.
/// [bench photos:tune]
const MAX_SPACING_DEVIATION: f64 = 0.12;

/// A plane with lights in the unwarped image, and the map from unwarped pixels into the photo.
pub struct LitPlane<'a> {
    pub unwarped: &'a Image,
    /// Confidence of each pixel that it is light, in `[0, 1]`.
    pub light: &'a Image,
    /// 1 for pixels on the plane, its lamps and their rims, else 0.
    pub valid: &'a Image,
    pub to_photo: Option<PhotoMap>,
}

impl LitPlane<'_> {
    pub fn is_lit(&self, pixel: usize) -> bool {
        self.light.data[pixel] >= super::LIT && self.is_valid(pixel)
    }

    pub fn is_valid(&self, pixel: usize) -> bool {
        self.valid.data[pixel] >= 0.5
    }
}

/// A bar along the columns or the rows of the image: the range of columns or rows that it covers, and its depth.
///
/// The depth of a pixel is the share of the panes' luminance that it lacks ([`Lines`]). The depth of a column (or row)
/// is the median over its pixels. The depth of a bar is the depth of its deepest column, minus the median depth of all
/// columns.
#[derive(Clone, Copy, Debug)]
pub struct Bar {
    pub first: usize,
    pub last: usize,
    pub depth: f32,
}

impl Bar {
    fn centre(&self) -> f64 {
        (self.first + self.last) as f64 / 2.0
    }

    fn width(&self) -> usize {
        self.last + 1 - self.first
    }

    /// The amount of light that the bar hides: its width times its depth.
    fn strength(&self) -> f64 {
        self.width() as f64 * f64::from(self.depth)
    }
}

/// Several bars close to each other, such as the dark edges of a moulding: the range of positions that they cover, and
/// the sum of their strengths.
struct BarGroup {
    first: usize,
    last: usize,
    strength: f64,
}

/// Groups bars, which are in the order of their position, if the gap between two neighbours is at most the width of the
/// wider one.
fn groups(bars: &[Bar]) -> Vec<BarGroup> {
    let is_close = |a: &Bar, b: &Bar| b.first <= a.last + 1 + a.width().max(b.width());
    let group = |bars: &[Bar]| BarGroup {
        first: bars[0].first,
        last: bars[bars.len() - 1].last,
        strength: bars.iter().map(Bar::strength).sum(),
    };
    bars.chunk_by(is_close).map(group).collect()
}

/// Removes single lead strips inside panes from the bars ([`MAX_STRIP_SHARE`]).
fn remove_strips(bars: &mut Vec<Bar>) {
    let groups = groups(bars);
    let is_strip = |around: &[BarGroup]| {
        let [before, strip, after] = around else { return false };
        let width = (strip.last + 1 - strip.first) as f64;
        width <= MAX_STRIP_SHARE * (after.first - before.last) as f64
            && before.strength.min(after.strength) >= MIN_BAR_STRENGTH * strip.strength
    };
    let strips: Vec<&BarGroup> = groups.windows(3).filter(|around| is_strip(around)).map(|around| &around[1]).collect();
    bars.retain(|bar| !strips.iter().any(|strip| (strip.first..=strip.last).contains(&bar.first)));
}

/// View of the plane for detecting the bars of one direction: columns if `is_column`, else rows. A pixel has the
/// position u across the bars and v along them. `across` and `along` are the numbers of these positions. `widest` is
/// the maximum width of a bar in pixels.
pub struct Lines<'a> {
    plane: &'a LitPlane<'a>,
    is_column: bool,
    across: usize,
    along: usize,
    widest: usize,
    /// For each pixel, the share by which it is darker than the light beside it: max(0, 1 - L / min(a, b)). L is its
    /// luminance. a and b are the luminances of the brightest lit pixels within `widest` positions before and after it,
    /// across the bars. NaN if there is no light on one side, or if the pixel is not on the plane.
    depth: Vec<f32>,
}

impl<'a> Lines<'a> {
    pub fn new(plane: &'a LitPlane, luminances: &[f32], is_column: bool) -> Result<Self> {
        let (width, height) = (plane.unwarped.width, plane.unwarped.height);
        let (across, along) = if is_column { (width, height) } else { (height, width) };
        let widest = ((width.max(height) as f64 * MAX_WIDTH) as usize).max(3);
        let depth = try_vec(width * height, f32::NAN)?;
        let mut lines = Self { plane, is_column, across, along, widest, depth };
        let (mut light, mut before, mut after) =
            (try_vec(across, 0f32)?, try_vec(across, 0f32)?, try_vec(across, 0f32)?);
        for v in 0..along {
            for (u, light) in light.iter_mut().enumerate() {
                let i = lines.index(u, v);
                *light = if plane.is_lit(i) { luminances[i] } else { 0.0 };
            }
            brightest_before(light.iter().copied(), widest, before.iter_mut());
            brightest_before(light.iter().rev().copied(), widest, after.iter_mut().rev());
            for u in 0..across {
                let (i, sides) = (lines.index(u, v), before[u].min(after[u]));
                if sides > 0.0 && plane.is_valid(i) {
                    lines.depth[i] = (1.0 - luminances[i] / sides).max(0.0);
                }
            }
        }
        Ok(lines)
    }

    fn index(&self, u: usize, v: usize) -> usize {
        let width = self.plane.unwarped.width;
        if self.is_column { v * width + u } else { u * width + v }
    }

    /// Sharpness of the photo across the bars: photo pixels per unwarped pixel.
    fn sharpness(&self, u: usize, v: usize) -> f64 {
        let i = self.index(u, v);
        let pixel = LocalMap::new(self.plane.to_photo, self.plane.unwarped.centre_of(i)).photo_pixel();
        1.0 / if self.is_column { pixel.x } else { pixel.y }
    }

    /// Median depth of the pixels at position `u` across the bars, in the range `along`, weighted by sharpness up to 1
    /// photo pixel per unwarped pixel. `None` if fewer than `min_known` pixels have light on both sides. Bars that
    /// cross do not change the median, because they cover only a few of these pixels.
    fn median_depth(&self, u: usize, along: Range<usize>, min_known: usize) -> Option<f32> {
        let mut depths: Vec<(f64, f64)> = Vec::new();
        for start in along.clone().step_by(self.section_length()) {
            let end = (start + self.section_length()).min(along.end);
            let sharpness = self.sharpness(u, (start + end) / 2).min(1.0);
            let known = (start..end).map(|v| self.depth[self.index(u, v)]).filter(|depth| depth.is_finite());
            depths.extend(known.map(|depth| (f64::from(depth), sharpness)));
        }
        let depth = if depths.len() < min_known { None } else { weighted_median(depths) };
        depth.map(|depth| depth as f32)
    }

    fn section_length(&self) -> usize {
        self.along.div_ceil(SECTIONS)
    }

    /// Finds the bars that the photo shows, without single lead strips inside panes.
    pub fn bars(&self) -> Vec<Bar> {
        let min_known = (self.along as f64 * MIN_LENGTH) as usize;
        let profile: Vec<Option<f32>> =
            (0..self.across).map(|u| self.median_depth(u, 0..self.along, min_known)).collect();
        let mut known: Vec<f32> = profile.iter().flatten().copied().collect();
        known.sort_by(f32::total_cmp);
        let Some(&level) = known.get(known.len() / 2) else { return Vec::new() };
        let mut excess: Vec<f32> = profile.iter().map(|p| p.map_or(0.0, |p| p - level)).collect();

        // Find the bars, the deepest one first. `excess` is the depth of each position across the bars minus the median
        // depth of all positions. A bar extends from its deepest position to both sides as far as the excess is at
        // least half of the excess at the deepest position.
        let mut bars = Vec::new();
        while let Some((peak, &depth)) =
            excess.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).filter(|(_, d)| **d >= MIN_DEPTH)
        {
            let first = (0..=peak).rev().take_while(|&u| excess[u] >= depth / 2.0).last().unwrap_or(peak);
            let last = (peak..self.across).take_while(|&u| excess[u] >= depth / 2.0).last().unwrap_or(peak);
            bars.push(Bar { first, last, depth });
            // Clear the bar and its flanks, where the excess falls off, so that they are not found as further bars.
            let falls = |a: usize, b: usize| excess[b] <= excess[a] && excess[b] > 0.0;
            let start = (1..=first).rev().take_while(|&u| falls(u, u - 1)).last().map_or(first, |u| u - 1);
            let end = (last..self.across - 1).take_while(|&u| falls(u, u + 1)).last().map_or(last, |u| u + 1);
            excess[start..=end].fill(0.0);
        }
        bars.sort_by_key(|bar| bar.first);
        bars.retain(|bar| bar.last - bar.first < self.widest);
        remove_strips(&mut bars);
        bars
    }

    /// Predicts bars beyond the first and the last one from the period of the found bars. Returns no bars if fewer than
    /// three bars were found, if they have no period, or if the first two are less than 4 pixels apart.
    pub fn beyond(&self, bars: &[Bar]) -> Vec<Bar> {
        let gaps: Vec<f64> = bars.windows(2).map(|pair| pair[1].centre() - pair[0].centre()).collect();
        let Some(&first) = gaps.first().filter(|_| gaps.len() >= 2) else { return Vec::new() };
        let mean = gaps.iter().sum::<f64>() / gaps.len() as f64;
        let depth = bars.iter().map(|bar| bar.depth).fold(f32::INFINITY, f32::min);
        if gaps.iter().any(|gap| (gap - mean).abs() > MAX_SPACING_DEVIATION * mean) || first < 4.0 {
            return Vec::new();
        }
        let shifted = |bar: Bar, shift: f64| {
            let first = bar.first.checked_add_signed(shift.round() as isize)?;
            let last = bar.last.checked_add_signed(shift.round() as isize)?;
            (last < self.across).then_some(Bar { first, last, depth })
        };
        let follow = |bar: Bar, step: f64| (1..).map_while(move |n| shifted(bar, step * f64::from(n)));
        let mut beyond: Vec<Bar> = follow(bars[0], -mean).collect();
        beyond.extend(follow(bars[bars.len() - 1], mean));
        beyond
    }

    /// Divides a bar into sections along its length, and measures the depth and the sharpness of each section.
    pub fn sections(&self, bar: &Bar) -> Vec<Section> {
        let middle = (bar.first + bar.last) / 2;
        let starts = (0..self.along).step_by(self.section_length());
        let alongs = starts.map(|start| start..(start + self.section_length()).min(self.along));
        alongs
            .map(|along| {
                let depths = (bar.first..=bar.last).filter_map(|u| self.median_depth(u, along.clone(), 1));
                let depth = depths.fold(0.0, f32::max);
                let sharpness = self.sharpness(middle, (along.start + along.end) / 2);
                Section { along, depth, sharpness }
            })
            .collect()
    }

    /// Removes a bar from the light mask. Sections that show no bar stay lit if the photo is sharp enough there, that
    /// is, if its sharpness is at least `lowest_sharpness`. Returns whether any lit pixel was removed.
    pub fn cut(&self, bar: &Bar, sections: &[Section], lowest_sharpness: f64, light: &mut Image) -> bool {
        let is_absent = |s: &Section| s.sharpness >= lowest_sharpness && s.depth < MIN_SECTION_DEPTH * bar.depth;
        let absent: Vec<bool> = sections.iter().map(is_absent).collect();
        // Where another bar crosses, this bar seems absent, because the pixels on both sides of it belong to the other
        // bar and are as dark. So a section without a bar is removed as well if the bar shows close by on both sides.
        let is_shown = |from: usize, to: usize| absent[from.min(absent.len())..to.min(absent.len())].contains(&false);
        let crosses = |n: usize| {
            is_shown(n.saturating_sub(MAX_HIDDEN_SECTIONS), n) && is_shown(n + 1, n + 1 + MAX_HIDDEN_SECTIONS)
        };
        let mut is_changed = false;
        for (n, section) in sections.iter().enumerate() {
            if absent[n] && !crosses(n) {
                continue;
            }
            for v in section.along.clone() {
                for u in bar.first..=bar.last {
                    let i = self.index(u, v);
                    is_changed |= light.data[i] >= super::LIT;
                    light.data[i] = 0.0;
                }
            }
        }
        is_changed
    }
}

/// A section of a bar: its positions along the bar, the depth there, and the photo's sharpness across the bar, in photo
/// pixels per unwarped pixel.
pub struct Section {
    along: Range<usize>,
    depth: f32,
    sharpness: f64,
}

/// The lowest sharpness of the sections in which the bar is clearly visible, that is, in which its depth is at least
/// half of the whole bar's depth. Infinite if there is no such section.
pub fn lowest_sharpness(bar: &Bar, sections: &[Section]) -> f64 {
    let evident = sections.iter().filter(|s| s.depth >= bar.depth / 2.0);
    evident.map(|s| s.sharpness).fold(f64::INFINITY, f64::min)
}

/// Writes to `brightest`, for each position of a line of pixels, the maximum of `light` over the `count` positions
/// before it; 0 for the first position.
fn brightest_before<'a>(light: impl Iterator<Item = f32>, count: usize, brightest: impl Iterator<Item = &'a mut f32>) {
    // `window` holds the positions that may still be the brightest one before a later position. The brightest comes
    // first (monotonic queue).
    let mut window: VecDeque<(usize, f32)> = VecDeque::new();
    for (u, (light, brightest)) in light.zip(brightest).enumerate() {
        while window.front().is_some_and(|(first, _)| first + count < u) {
            window.pop_front();
        }
        *brightest = window.front().map_or(0.0, |(_, light)| *light);
        while window.back().is_some_and(|(_, last)| *last <= light) {
            window.pop_back();
        }
        window.push_back((u, light));
    }
}
