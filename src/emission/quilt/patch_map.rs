//! The patch map. Each pixel of the texture shows a pixel of the exemplar; the map stores the shift between the two.

use crate::emission::exemplar::working::Working;
use glam::DVec2;
use std::collections::BTreeMap;

/// Shifts are rounded to this many steps per unwarped pixel before they are compared. [rounding]
const SUBPIXELS: f64 = 1e6;

/// The label of a pixel without a patch.
pub const NONE: u32 = u32::MAX;

/// A shift of the exemplar: position in the texture minus position in the exemplar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// The shift in working pixels (at the reduced size of the synthesis), rounded.
    pub working: [i32; 2],
    /// The shift before rounding, in unwarped pixels.
    pub exact: DVec2,
}

/// For each working pixel of the texture (a pixel at the reduced size of the synthesis), the shift of the patch that
/// covers it. A pixel holds a label, the index of the shift in `shifts`, or [`NONE`]. Patches are wide, so a row is
/// stored as runs of equal labels.
#[derive(Clone, Debug, Default)]
pub struct PatchMap {
    pub width: usize,
    pub height: usize,
    pub shifts: Vec<Shift>,
    /// For each run, row by row: the column after its last pixel, and its label.
    runs: Vec<(u32, u32)>,
    /// For each row, the index in `runs` after its last run.
    ends: Vec<usize>,
}

/// A list of distinct shifts; the label of a shift is its index.
#[derive(Default)]
pub struct Shifts {
    pub list: Vec<Shift>,
    labels: BTreeMap<[i64; 2], u32>,
}

impl Shifts {
    /// Returns the label of a shift, and adds the shift if it is new. `exact` is in unwarped pixels; a working pixel
    /// is `pitch` unwarped pixels wide and high.
    pub fn label(&mut self, exact: DVec2, pitch: DVec2) -> u32 {
        let key = (exact * SUBPIXELS).round().to_array().map(|c| c as i64);
        *self.labels.entry(key).or_insert_with(|| {
            let working = (exact / pitch).round();
            self.list.push(Shift { working: [working.x as i32, working.y as i32], exact });
            self.list.len() as u32 - 1
        })
    }
}

impl PatchMap {
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, shifts: Vec::new(), runs: Vec::new(), ends: Vec::new() }
    }

    /// A patch map whose pixels all have the given shift.
    pub fn single(width: usize, height: usize, shift: Shift) -> Self {
        let runs = vec![(width as u32, 0); height];
        Self { width, height, shifts: vec![shift], runs, ends: (1..=height).collect() }
    }

    /// Appends a row of labels: indices into `shifts`, or [`NONE`].
    pub fn push(&mut self, labels: &[u32]) {
        for (x, &label) in labels.iter().enumerate() {
            if labels.get(x + 1) != Some(&label) {
                self.runs.push((x as u32 + 1, label));
            }
        }
        self.ends.push(self.runs.len());
    }

    /// Repeats the patch map over `width` × `height` working pixels. `across` is the period in unwarped pixels, a
    /// vector along x or y; the map repeats along this axis only. Along the other axis, its last column or row is
    /// continued. In the n-th repetition, n `across` is added to every shift. Shifts that become equal get one label. A
    /// working pixel is `pitch` unwarped pixels wide and high.
    pub fn repeated(&self, (width, height): (usize, usize), across: DVec2, pitch: DVec2) -> Self {
        let mut out = Self::new(width, height);
        let mut shifts = Shifts::default();
        let mut relabel = |label: u32, times: usize| match self.shifts.get(label as usize) {
            Some(shift) => shifts.label(shift.exact + across * times as f64, pitch),
            None => NONE,
        };
        let period = across.abs() / pitch;
        // Returns the index of the repetition that contains the column or row `at`, and the corresponding column or row
        // of the original map.
        let place = |at: usize, period: f64, side: usize| {
            let times = if period > 0.0 { (at as f64 / period + 1e-9) as usize } else { 0 };
            (times, (at - (times as f64 * period).round().min(at as f64) as usize).min(side - 1))
        };
        let mut row = vec![NONE; width];
        for y in 0..height {
            let (down, v) = place(y, period.y, self.height);
            let source: Vec<u32> = self.labels(v).collect();
            let mut last = (usize::MAX, NONE, NONE);
            for (x, out_label) in row.iter_mut().enumerate() {
                let (right, u) = place(x, period.x, self.width);
                if (right, source[u]) != (last.0, last.1) {
                    last = (right, source[u], relabel(source[u], down + right));
                }
                *out_label = last.2;
            }
            out.push(&row);
        }
        out.shifts = shifts.list;
        out
    }

    /// The runs of a row, from left to right: the column after the last pixel, and the label.
    pub fn row(&self, y: usize) -> &[(u32, u32)] {
        let start = y.checked_sub(1).map_or(0, |above| self.ends[above]);
        &self.runs[start..self.ends[y]]
    }

    /// The label of every pixel of a row.
    pub fn labels(&self, y: usize) -> impl Iterator<Item = u32> {
        let mut start = 0;
        self.row(y).iter().flat_map(move |&(end, label)| {
            let length = end - std::mem::replace(&mut start, end);
            std::iter::repeat_n(label, length as usize)
        })
    }

    /// The shift of a pixel; `None` if it has no patch.
    pub fn shift(&self, x: usize, y: usize) -> Option<&Shift> {
        let row = self.row(y);
        let run = row.partition_point(|&(end, _)| end as usize <= x);
        self.shifts.get(row.get(run)?.1 as usize)
    }

    /// The index of the exemplar's working pixel that is shown at `(x, y)` by the patch with the given label; `None`
    /// outside the exemplar.
    pub fn source(&self, x: usize, y: usize, label: u32, working: &Working) -> Option<usize> {
        let [dx, dy] = self.shifts.get(label as usize)?.working;
        working.index(x as i32 - dx, y as i32 - dy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn runs_tell_every_pixel() {
        let (width, height) = (37, 12);
        let mut rng = Rng::new(4, &[]);
        let rows: Vec<Vec<u32>> = (0..height)
            .map(|_| (0..width).map(|_| if rng.next_f64() < 0.3 { NONE } else { rng.below(3) as u32 }).collect())
            .collect();
        let mut patch_map = PatchMap::new(width, height);
        patch_map.shifts = (0..3).map(|i| Shift { working: [i, 0], exact: DVec2::X * 2.0 * f64::from(i) }).collect();
        rows.iter().for_each(|row| patch_map.push(row));
        for (y, row) in rows.iter().enumerate() {
            assert_eq!(&patch_map.labels(y).collect::<Vec<_>>(), row);
            for (x, &label) in row.iter().enumerate() {
                assert_eq!(patch_map.shift(x, y), patch_map.shifts.get(label as usize));
            }
        }
        // Repeat the first 7 columns. A working pixel is 2 unwarped pixels wide, so the period is 14 unwarped pixels.
        // The shift grows by 7 working pixels with each repetition.
        let part = PatchMap { width: 7, ..patch_map.clone() };
        let again = part.repeated((30, height), DVec2::X * 14.0, DVec2::splat(2.0));
        for (x, y) in [(0, 0), (6, 3), (7, 3), (29, 11)] {
            let once = patch_map.shift(x % 7, y).map(|s| [s.working[0] + 7 * (x / 7) as i32, s.working[1]]);
            assert_eq!(again.shift(x, y).map(|s| s.working), once, "{x} {y}");
        }
        assert_eq!(PatchMap::single(5, 2, patch_map.shifts[1]).shift(4, 1), Some(&patch_map.shifts[1]));
    }
}
