//! Computes the 4 × 4 source samples (taps) around each pixel of a run, and their filter weights.
//!
//! Where the source is magnified, the weights come from bicubic interpolation (Catmull-Rom). Where it is minified, each
//! sample is weighted by the share of the footprint that the sample covers, row by row, since the footprint is a
//! sheared rectangle. For a footprint of one pixel the two filters differ only by the sharpening terms of the cubic,
//! which fade out as the footprint grows beyond one pixel.

use super::footprint::{Footprints, RUN};
use super::lanes::{MAX_READ, TAPS};
use crate::image::Image;

/// Longest side, in pixels of the pyramid level, of a rectangle that the taps cover at any sub-pixel position:
/// `TAPS - 1`. [convention]
pub const MAX_SIDE: f32 = 3.0;

/// The cubic filter fades out as the footprint of a pixel grows: it has full weight up to `SHARP` and no weight from
/// `SOFT` on. Both are values of [`Footprints::squared_major_axis`], a squared length in square pixels of the source;
/// up to 1, nothing is minified. The bench prints the difference from the exact picture under minification. [bench
/// warp]
const SHARP: f32 = 1.0;
const SOFT: f32 = 1.5;

/// One of the equal parts into which every footprint of a run is divided.
#[derive(Clone, Copy)]
pub struct Part {
    /// Index of the part along x and y (`at`), and the number of parts along x and y (`of`).
    pub at: [usize; 2],
    pub of: [usize; 2],
    /// Number of pixels of the pyramid level in use per source pixel, along a side: 1 on the finest level.
    pub scale: f32,
}

pub struct Taps {
    /// Index of the first of the four rows of taps (`line`), and of the first column of taps in each row (`column`).
    pub line: [i32; RUN],
    pub column: [[i32; RUN]; TAPS],
    /// Index in the image data of the first sample in each row of taps; valid if the row lies inside the image.
    pub start: [[usize; RUN]; TAPS],
    /// The filter weights. Without shear the filter is separable: `down` holds the weights of the rows, and `across`
    /// holds the weights of the columns, which are equal in all rows. If `is_sheared`, `across` holds the weights of
    /// all 16 taps, row by row, and `down` is not used.
    pub down: [[f32; TAPS]; RUN],
    pub across: [[[f32; TAPS]; RUN]; TAPS],
    /// Whether the pixel is visible and all its taps lie inside the source.
    pub is_inside: [bool; RUN],
    pub is_sheared: bool,
    /// Whether the filter includes the sharpening terms of the cubic, so that some weights are negative.
    pub is_sharp: bool,
}

impl Taps {
    pub const EMPTY: Self = Self {
        line: [0; RUN],
        column: [[0; RUN]; TAPS],
        start: [[0; RUN]; TAPS],
        down: [[0.0; TAPS]; RUN],
        across: [[[0.0; TAPS]; RUN]; TAPS],
        is_inside: [false; RUN],
        is_sheared: false,
        is_sharp: false,
    };

    /// Returns the weight of the tap in column `k` of row `j` of pixel `i`.
    pub fn weight(&self, i: usize, j: usize, k: usize) -> f32 {
        if self.is_sheared { self.across[j][i][k] } else { self.down[i][j] * self.across[0][i][k] }
    }
}

/// Length of the overlap between a sample of unit width and an interval of the given length. `offset` is the distance
/// between their centres.
#[inline(always)]
fn overlap(offset: f32, length: f32) -> f32 {
    (0.5 * length + 0.5 - offset.abs()).max(0.0).min(length.min(1.0))
}

/// Difference between the weights of Catmull-Rom and linear interpolation at fraction `t` of the way from the second
/// tap to the third.
#[inline(always)]
fn sharpening(t: f32) -> [f32; TAPS] {
    let u = 1.0 - t;
    let (first, last) = (-0.5 * t * u * u, -0.5 * u * t * t);
    [first, last - 2.0 * first, first - 2.0 * last, last]
}

/// The filter of a run of pixels: bicubic interpolation, the mean over the footprint, or a blend of both.
#[derive(Clone, Copy, PartialEq)]
enum Filter {
    /// Bicubic interpolation (Catmull-Rom), if no footprint of the run is larger than one source pixel.
    Cubic,
    /// The mean over the footprint plus the sharpening terms of the cubic, which fade out as the footprint grows.
    Fading,
    Overlap,
}

/// Computes the weights of the four taps of each pixel, along x or y. `at` is the position of the footprint's centre
/// relative to the second tap, and `length` is the side of the footprint. `sharp` is the weight of the sharpening terms
/// of [`Filter::Fading`].
#[inline(always)]
fn weights(at: &[f32; RUN], length: &[f32; RUN], sharp: &[f32; RUN], filter: Filter, to: &mut [[f32; RUN]; TAPS]) {
    let [first, second, third, fourth] = to;
    let mut put = |i: usize, weights: [f32; TAPS]| [first[i], second[i], third[i], fourth[i]] = weights;
    let shares = |i: usize| {
        let share = 1.0 / length[i];
        [-1.0, 0.0, 1.0, 2.0].map(|k: f32| overlap(k - at[i], length[i]) * share)
    };
    match filter {
        Filter::Cubic => {
            for i in 0..RUN {
                let more = sharpening(at[i]);
                put(i, [more[0], (1.0 - at[i]) + more[1], at[i] + more[2], more[3]]);
            }
        }
        Filter::Fading => {
            for i in 0..RUN {
                let (shares, more) = (shares(i), sharpening(at[i]));
                put(i, [0, 1, 2, 3].map(|k| shares[k] + sharp[i] * more[k]));
            }
        }
        Filter::Overlap => {
            for i in 0..RUN {
                put(i, shares(i));
            }
        }
    }
}

/// Converts a whole `f64` to `i32`. Adds a constant that shifts the number into the low bits of the mantissa: unlike a
/// cast, this vectorises.
#[inline(always)]
fn integer(whole: f64) -> i32 {
    (whole + 1.5 * (1u64 << 52) as f64).to_bits() as i32
}

/// Like [`integer`], in single precision; the value is clamped to ±4 million.
#[inline(always)]
fn integer_of_single(whole: f32) -> i32 {
    /// Adding this constant moves a whole number into the low bits of the mantissa. [rounding]
    const SHIFT: f32 = 12_582_912.0;
    (whole.max(-4e6).min(4e6) + SHIFT).to_bits() as i32 - SHIFT.to_bits() as i32
}

#[inline(always)]
pub fn weigh(footprints: &Footprints, part: &Part, source: &Image, taps: &mut Taps) {
    let share = [0, 1].map(|k| 1.0 / part.of[k] as f32);
    let offset = [0, 1].map(|k| (part.at[k] as f32 + 0.5) * share[k] - 0.5);
    let can_be_sharp = if part.of == [1, 1] && part.scale == 1.0 { 1.0 } else { 0.0 };
    let scale = f64::from(part.scale);
    let (mut width, mut height, mut sharp) = ([0.0; RUN], [0.0; RUN], [0.0; RUN]);
    let (mut left, mut x, mut y) = ([0; RUN], [0.0; RUN], [0.0; RUN]);
    for i in 0..RUN {
        let (w, h) = ((footprints.width[i] * part.scale).max(1.0), (footprints.height[i] * part.scale).max(1.0));
        let (right, below) = (offset[0] * w, offset[1] * h);
        let at_x = footprints.x[i] * scale + f64::from(right + footprints.shear[i] * below) - 0.5;
        let at_y = footprints.y[i] * scale + f64::from(below) - 0.5;
        let (column, line) = (at_x.floor(), at_y.floor());
        (x[i], y[i]) = ((at_x - column) as f32, (at_y - line) as f32);
        (left[i], taps.line[i]) = (integer(column) - 1, integer(line) - 1);
        (width[i], height[i]) = ((w * share[0]).min(MAX_SIDE), (h * share[1]).min(MAX_SIDE));
        sharp[i] = can_be_sharp * ((SOFT - footprints.squared_major_axis[i]) / (SOFT - SHARP)).max(0.0).min(1.0);
    }
    let any = |values: &[f32; RUN]| values.iter().fold(0, |any, v| any | v.to_bits()) != 0;
    let blunt = sharp.map(|s| 1.0 - s);
    let filter = match (any(&sharp), any(&blunt)) {
        (true, false) => Filter::Cubic,
        (true, true) => Filter::Fading,
        (false, _) => Filter::Overlap,
    };
    taps.is_sharp = filter != Filter::Overlap;
    taps.is_sheared = footprints.shear.iter().fold(0, |any, s| any | (s.to_bits() << 1)) != 0;
    let (mut down, mut across) = ([[0.0; RUN]; TAPS], [[0.0; RUN]; TAPS]);
    weights(&y, &height, &sharp, filter, &mut down);
    if !taps.is_sheared {
        side_by_side(|k, i| down[k][i], &mut taps.down);
    }

    let (stride, channels) = (source.row_len() as u32, source.channels as u32);
    for j in 0..TAPS {
        if !taps.is_sheared && j > 0 {
            taps.column[j] = taps.column[0];
            continue;
        }
        let mut along = [0.0; RUN];
        for i in 0..RUN {
            let at = x[i] + footprints.shear[i] * (j as f32 - 1.0 - y[i]);
            let column = at.floor();
            along[i] = at - column;
            taps.column[j][i] = left[i] + integer_of_single(column);
        }
        weights(&along, &width, &sharp, filter, &mut across);
        if taps.is_sheared {
            side_by_side(|k, i| across[k][i] * down[j][i], &mut taps.across[j]);
        } else {
            side_by_side(|k, i| across[k][i], &mut taps.across[j]);
        }
        for i in 0..RUN {
            let (line, column) = ((taps.line[i] + j as i32) as u32, taps.column[j][i] as u32);
            let start = u64::from(line) * u64::from(stride) + u64::from(column) * u64::from(channels);
            taps.start[j][i] = start as usize;
        }
    }
    mark_inside(footprints, source, taps);
}

/// Marks the pixels that are visible and whose taps all lie inside the source (`is_inside`).
#[inline(always)]
fn mark_inside(footprints: &Footprints, source: &Image, taps: &mut Taps) {
    // From row to row, the index of the first column only grows or only shrinks, so checking the first and the last
    // row suffices. A load of three channels reads beyond the fourth pixel; in the last row of the image, these
    // samples must lie inside the data too.
    let last_start = [source.width, source.height].map(|side| side as i32 - TAPS as i32);
    let beyond = if source.channels == 3 { MAX_READ.div_ceil(3) - TAPS } else { 0 } as i32;
    for i in 0..RUN {
        let (a, b, line) = (taps.column[0][i], taps.column[TAPS - 1][i], taps.line[i]);
        let last = last_start[0] - if line == last_start[1] { beyond } else { 0 };
        let is_inside = (a.min(b) >= 0) & (a.max(b) <= last) & (line >= 0) & (line <= last_start[1]);
        taps.is_inside[i] = footprints.is_seen[i] & is_inside;
    }
}

/// Transposes weights stored per tap into four weights per pixel.
#[inline(always)]
fn side_by_side(weight: impl Fn(usize, usize) -> f32, to: &mut [[f32; TAPS]; RUN]) {
    for (i, to) in to.iter_mut().enumerate() {
        *to = [weight(0, i), weight(1, i), weight(2, i), weight(3, i)];
    }
}
