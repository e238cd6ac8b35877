//! Straightens lines of light that the border of the photo cuts. Such a line is copied patch by patch or as one piece,
//! with the outline that the photo shows: wavy from the steps between photo pixels, and wider where the line is far
//! away, because bloom adds about the same number of photo pixels everywhere. A straight band replaces it. Lines of one
//! kind get one width, without bloom ([`bloom::common_side`]).
//!
//! Whole lamps need none of this, and cut lines beside whole lines neither: they are drawn from designs
//! ([`super::designs`]).

use super::bloom;
use crate::emission::exemplar::bars::LitPlane;
use crate::emission::exemplar::components::{self, Component, Components};
use crate::emission::exemplar::foreshortening::LocalMap;
use crate::emission::exemplar::roles::{self, Role};
use crate::error::Result;
use crate::geometry::robust::weighted_median;
use crate::image::{Image, try_collect};
use crate::job::Job;
use glam::DVec2;

/// A light is a line if it is at least this many times as long as wide, and parallel to x or y. [convention]
const MIN_ASPECT: f64 = 3.0;
/// A line is straight if the median distance of its edges from the fitted band is at most `MAX_RAGGED` photo pixels, or
/// the share `MAX_RAGGED_SHARE` of its width. Rings, arcs and lights that have grown together are less straight.
/// [bench photos:tune]
const MAX_RAGGED: f64 = 2.0;
const MAX_RAGGED_SHARE: f64 = 0.15;
/// A line is parallel to an axis if its middle moves across by at most this share of its width from end to end.
/// [bench photos:tune]
const MAX_DRIFT: f64 = 0.5;
/// Lines are of one kind if the width of each differs by at most this factor from the width that their common side and
/// common bloom predict. [bench photos:tune]
const MAX_WIDTH_RATIO: f64 = 1.4;

/// Returns the light mask with straight lines. `None` if there is no line that the border cuts.
pub fn straighten(plane: &LitPlane, job: Job) -> Result<Option<Image>> {
    let (width, height) = (plane.light.width, plane.light.height);
    let found = components::find(width, height, |i| plane.is_lit(i))?;
    let shown = try_collect(plane.valid.data.iter().map(|valid| *valid >= 0.5))?;
    let roles = roles::classify(&found, &shown, width, height);
    job.check()?;
    // Where the photo also shows whole lines, the cut ones are drawn like these.
    let is_whole_line = |(lamp, role): (&Component, &Role)| role.is_whole() && is_long(lamp);
    if found.list.iter().zip(&roles).any(is_whole_line) {
        return Ok(None);
    }
    let is_cut = |k: &usize| matches!(roles[*k], Role::Through | Role::Partial);
    let mut lines: Vec<Line> =
        (0..found.list.len()).filter(is_cut).filter_map(|k| Line::of(plane, &found, k)).collect();
    if lines.is_empty() {
        return Ok(None);
    }
    for axis in 0..2 {
        share_width(lines.iter_mut().filter(|line| line.axis == axis).collect());
    }
    let mut light = plane.light.try_clone()?;
    lines.iter().for_each(|line| line.draw(&found, &mut light));
    Ok(Some(light))
}

/// Whether the box around a light is as elongated as a line.
fn is_long(lamp: &Component) -> bool {
    let [x, y] = lamp.size().map(|side| side as f64);
    x.max(y) >= MIN_ASPECT * x.min(y)
}

/// A line of light that is parallel to x (`axis` 0) or y (1).
struct Line {
    component: usize,
    axis: usize,
    /// First and last column of pixels along the axis, inclusive.
    ends: [usize; 2],
    /// First and last row of pixels across the axis that the light reaches, inclusive.
    reach: [usize; 2],
    /// Position of the middle, and width, across the axis in unwarped pixels.
    middle: f64,
    width: f64,
    /// Length of a photo pixel across the axis, in unwarped pixels, at the part of the line with most photo pixels.
    pixel: f64,
}

impl Line {
    /// Fits a band to component `k`. `None` if the component is no straight line parallel to an axis.
    fn of(plane: &LitPlane, found: &Components, k: usize) -> Option<Self> {
        let lamp = &found.list[k];
        let [across_x, across_y] = lamp.size();
        let axis = usize::from(across_y > across_x);
        let columns: Vec<Column> = (lamp.min[axis]..=lamp.max[axis])
            .filter_map(|at| Column::of(plane, found, (k, lamp), (axis, at)))
            .collect();
        let of = |value: fn(&Column) -> f64| weighted_median(columns.iter().map(|c| (value(c), c.weight)).collect());
        let [low, high] = [of(|c| c.low)?, of(|c| c.high)?];
        let (width, length) = (high - low, lamp.size()[axis] as f64);
        // A line whose ends lie at unlike heights is oblique.
        let half = columns.len() / 2;
        let mean =
            |part: &[Column]| part.iter().map(|c| (c.low + c.high) / 2.0).sum::<f64>() / part.len().max(1) as f64;
        let drift = 2.0 * (mean(&columns[half..]) - mean(&columns[..half])).abs();
        let pixel = of(|c| c.pixel)?;
        let ragged = weighted_median(
            columns.iter().map(|c| ((c.low - low).abs().max((c.high - high).abs()), c.weight)).collect(),
        )?;
        let is_line = length >= MIN_ASPECT * width
            && drift <= MAX_DRIFT * width
            && ragged <= (MAX_RAGGED * pixel).max(MAX_RAGGED_SHARE * width);
        is_line.then_some(Self {
            component: k,
            axis,
            ends: [lamp.min[axis], lamp.max[axis]],
            reach: [lamp.min[1 - axis], lamp.max[1 - axis]],
            middle: (low + high) / 2.0,
            width,
            pixel,
        })
    }

    /// Replaces the light's outline in a mask by the band. The ends stay where they are.
    fn draw(&self, found: &Components, light: &mut Image) {
        let [low, high] = [self.middle - self.width / 2.0, self.middle + self.width / 2.0];
        let rows = self.reach[0].min(low.max(0.0) as usize)..=self.reach[1].max(high as usize);
        let side = if self.axis == 0 { light.height } else { light.width };
        for across in rows.filter(|across| *across < side) {
            let own = across as f64;
            let covered = ((own + 1.0).min(high) - own.max(low)).clamp(0.0, 1.0);
            for along in self.ends[0]..=self.ends[1] {
                let [x, y] = if self.axis == 0 { [along, across] } else { [across, along] };
                let i = y * light.width + x;
                if found.labels[i] == 0 || found.labels[i] as usize == self.component + 1 {
                    light.data[i] = covered as f32;
                }
            }
        }
    }
}

/// A column of pixels across a line.
struct Column {
    /// The edges of the light, in unwarped pixels across the line.
    low: f64,
    high: f64,
    /// Number of photo pixels that show an unwarped pixel here.
    weight: f64,
    /// Length of a photo pixel across the line, in unwarped pixels.
    pixel: f64,
}

impl Column {
    /// The light's extent at position `at` along the axis. `None` if the border cuts the light there across the line.
    fn of(
        plane: &LitPlane,
        found: &Components,
        (k, lamp): (usize, &Component),
        (axis, at): (usize, usize),
    ) -> Option<Self> {
        let index = |across: usize| {
            let [x, y] = if axis == 0 { [at, across] } else { [across, at] };
            (x < plane.light.width && y < plane.light.height).then(|| y * plane.light.width + x)
        };
        let is_own = |across: &usize| index(*across).is_some_and(|i| found.labels[i] as usize == k + 1);
        let mut rows = (lamp.min[1 - axis]..=lamp.max[1 - axis]).filter(is_own);
        let first = rows.next()?;
        let last = rows.next_back().unwrap_or(first);
        let is_shown = |across: Option<usize>| across.and_then(index).is_some_and(|i| plane.valid.data[i] >= 0.5);
        if !(is_shown(first.checked_sub(1)) && is_shown(Some(last + 1))) {
            return None;
        }
        let along = at as f64 + 0.5;
        let across = (first + last + 1) as f64 / 2.0;
        let centre = if axis == 0 { DVec2::new(along, across) } else { DVec2::new(across, along) };
        let map = LocalMap::new(plane.to_photo, centre);
        let (weight, pixel) = (map.area(), map.photo_pixel()[1 - axis]);
        (weight.is_finite() && pixel.is_finite()).then_some(Self {
            low: first as f64,
            high: last as f64 + 1.0,
            weight,
            pixel,
        })
    }
}

/// Gives parallel lines one width, without bloom, if they are of one kind.
fn share_width(lines: Vec<&mut Line>) {
    let Some(side) = bloom::common_side(lines.iter().map(|line| (line.width, line.pixel))) else { return };
    let excess = |line: &Line| (line.width - side) / line.pixel;
    let bloom = lines.iter().map(|line| excess(line)).sum::<f64>() / lines.len() as f64;
    let is_alike = |line: &Line| {
        let predicted = (side + bloom * line.pixel).max(f64::MIN_POSITIVE);
        (1.0 / MAX_WIDTH_RATIO..=MAX_WIDTH_RATIO).contains(&(line.width / predicted))
    };
    if lines.iter().all(|line| is_alike(line)) {
        lines.into_iter().for_each(|line| line.width = side);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    fn straightened(light: impl Fn(usize, usize) -> bool) -> Option<Image> {
        let light = Image::from_fn(120, 80, |x, y| [f32::from(light(x, y))]).unwrap();
        let valid = Image::from_fn(120, 80, |_, _| [1.0]).unwrap();
        let unwarped = Image::from_fn(120, 80, |_, _| [0.5; 3]).unwrap();
        let plane = LitPlane { unwarped: &unwarped, light: &light, valid: &valid, to_photo: None };
        straighten(&plane, Monitor::default().job()).unwrap()
    }

    #[test]
    fn a_wavy_line_that_the_border_cuts_becomes_straight_and_keeps_its_visible_end() {
        let wave = |x: usize| x / 5 % 3;
        let light = straightened(|x, y| x < 90 && (20 - wave(x)..32 + wave(x)).contains(&y)).unwrap();
        let column = |x: usize| (0..80).map(|y| light.pixel(x, y)[0]).collect::<Vec<f32>>();
        assert!((1..90).all(|x| column(x) == column(0)), "{:?}", column(0));
        assert_eq!(column(0).iter().sum::<f32>(), 14.0);
        assert!((90..120).all(|x| column(x).iter().all(|v| *v == 0.0)));
    }

    #[test]
    fn oblique_lines_arcs_and_whole_lamps_stay_as_they_are() {
        assert!(straightened(|x, y| (20 + x / 5..30 + x / 5).contains(&y)).is_none());
        let radius = |x: usize, y: usize| (x as f64).hypot(y as f64 - 10.0);
        assert!(straightened(|x, y| (50.0..56.0).contains(&radius(x, y))).is_none());
        assert!(straightened(|x, y| (20..100).contains(&x) && (30..40).contains(&y)).is_none());
    }

    #[test]
    fn lines_of_one_kind_get_one_width_without_bloom_and_others_keep_theirs() {
        let line = |width: f64, pixel: f64| Line {
            component: 0,
            axis: 0,
            ends: [0, 9],
            reach: [0, 9],
            middle: 5.0,
            width,
            pixel,
        };
        // Bloom of 1.5 photo pixels at each edge of lines that are 20 unwarped pixels wide.
        let mut lines = [1.0, 2.0, 4.0, 8.0].map(|pixel| line(20.0 + 3.0 * pixel, pixel));
        share_width(lines.iter_mut().collect());
        assert!(lines.iter().all(|line| (line.width - 20.0).abs() < 1.0), "{:?}", lines.map(|line| line.width));

        let mut lines = [line(20.0, 1.0), line(60.0, 1.0)];
        share_width(lines.iter_mut().collect());
        assert_eq!(lines.map(|line| line.width), [20.0, 60.0]);
    }
}
